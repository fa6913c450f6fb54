
#include "places.h"
#include "tools/batch_folder.h"

using namespace welkin;
using namespace welkin::test;

// Batches that are killed, stopped, or run twice at the same time.

namespace {

/// A script in which `run` is the batch's run, quietly.
CommandResult shell(const Batch& batch, const std::string& script) {
  return run_script("jobs=" + quoted(batch.jobs()) + "\nresults=" + quoted(batch.results()) +
                    "\nrun() { exec '" WELKIN_COMMAND
                    "' batch run \"$jobs\" -q \"$@\"; }\n"
                    "count() { ls \"$results\" 2>/dev/null | grep -c '^[0-9a-f]\\{32\\}$'; }\n" +
                    script);
}

/// All results that are there are whole; what a killed process was at is none.
std::size_t whole_results(const Batch& batch, std::size_t at_work = 0) {
  std::size_t whole = 0;
  for (const std::string& name : batch.result_names()) {
    if (name.ends_with(".work") && at_work-- > 0) continue;
    const std::filesystem::path folder = batch.results() / name;
    const nlohmann::json list = json_of(file_text(folder / "result.json"));
    ++whole;
    CHECK(list.at("files").size() + 1 == names_in(folder).size());
    for (const auto& file : list.at("files")) {
      CHECK(std::filesystem::file_size(folder / file.at("name")) == file.at("bytes"));
    }
  }
  return whole;
}

/// Begins a run, and waits until twenty results are there.
const std::string kRunToTwenty = "run & child=$!\nwhile [ $(count) -lt 20 ]; do kill -0 $child || exit 9; done\n";

constexpr int kJobs = 200;  // over half a second of work: time enough for the shell to stop it before its end

}  // namespace

TEST_CASE("A batch that is killed goes on where it was", "[command][batch][slow]") {
  const Batch batch(kJobs);
  const CommandResult killed = shell(batch, kRunToTwenty + "kill -KILL $child; wait $child; echo $?");
  INFO(killed.errors);
  REQUIRE(killed.exit_code == 0);
  REQUIRE(killed.output == "137\n");
  const std::size_t there = whole_results(batch, kJobs);
  REQUIRE((there >= 20 && there < kJobs));
  const nlohmann::json rest = batch.run_well("run");
  CHECK(rest.at("present") == there);
  CHECK(rest.at("computed") == kJobs - there);
  CHECK(whole_results(batch) == kJobs);  // and what was at work is gone
  // Killed after a result had its name.
  std::filesystem::create_directories(batch.results() / (batch.result_names().front() + ".work") / "files");
  batch.run_well("run");
  CHECK(whole_results(batch) == kJobs);
  const Batch other(kJobs);
  other.run_well("run");
  CHECK(batch.merged() == other.merged());
}

TEST_CASE("A batch that is told to stop does so, and leaves nothing half done", "[command][batch][slow]") {
  const Batch batch(kJobs);
  const CommandResult stopped = shell(batch, kRunToTwenty + "kill -TERM $child; wait $child; echo $?");
  INFO(stopped.errors);
  REQUIRE(stopped.output == "143\n");
  CHECK(contains(stopped.errors, "welkin: stopped"));
  const std::size_t there = whole_results(batch);
  REQUIRE(there < kJobs);
  for (const auto& [name, record] : batch.records()) CHECK(record.at("state") == "computed");
  CHECK(batch.run_well("status").at("done") == there);
  CHECK(batch.run_well("run").at("present") == there);
}

TEST_CASE("A folder of results that is full is no job's failure", "[command][batch]") {
  const Batch batch(3);
  // A limit on the size of files stands for a full disk.
  const CommandResult full = shell(batch, "ulimit -f 2; run --json");
  INFO(full.errors);
  CHECK(full.exit_code != 0);  // 128 more than SIGXFSZ
  CHECK(batch.result_names().empty());
  CHECK(batch.run_well("run").at("computed") == 3);
}

TEST_CASE("Two runs at once share the work", "[command][batch][slow]") {
  constexpr int kShared = 60;
  const Batch batch(kShared);
  const CommandResult both = shell(batch,
                                   "(run --threads 1 --json) & one=$!\n(run --threads 2 --json) & other=$!\n"
                                   "wait $one; a=$?; wait $other; echo $a $?");
  INFO(both.errors);
  CHECK(contains(both.output, "0 0\n"));
  CHECK(both.errors.empty());
  // Each job was computed by one of them, and found by the other.
  int computed = 0;
  constexpr std::string_view kCount = "\"computed\": ";
  for (std::size_t at = 0; (at = both.output.find(kCount, at)) != std::string::npos; ++at) {
    computed += std::stoi(both.output.substr(at + kCount.size()));
  }
  CHECK(computed == kShared);
  CHECK(whole_results(batch) == kShared);
  const Batch other(kShared);
  other.run_well("run");
  CHECK(batch.merged() == other.merged());
}
