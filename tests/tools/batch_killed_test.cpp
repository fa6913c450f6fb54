
#include "places.h"
#include "tools/batch_folder.h"

using namespace welkin;
using namespace welkin::test;

// Batches that are killed, stopped, or run twice at the same time.

namespace {

/// A script in which `run` is the batch's run, quietly.
CommandResult shell(const Batch& batch, const std::string& script) {
  const std::filesystem::path file = batch.path() / "script.sh";
  std::ofstream(file) << "jobs='" << batch.jobs().string() << "'\nresults='" << batch.results().string()
                      << "'\nrun() { exec '" << WELKIN_COMMAND << "' batch run \"$jobs\" -q \"$@\"; }\n"
                      << "count() { ls \"$results\" 2>/dev/null | grep -c '^[0-9a-f]\\{32\\}$'; }\n"
                      << script;
  return run_program("/bin/sh", quoted(file));
}

/// All results that are there are whole; the others are none.
std::size_t whole_results(const Batch& batch) {
  for (const std::string& name : batch.result_names()) {
    const std::filesystem::path folder = batch.results() / name;
    const nlohmann::json list = json_of(file_text(folder / "result.json"));
    CHECK(list.at("files").size() + 1 == names_in(folder).size());
    for (const auto& file : list.at("files")) {
      CHECK(std::filesystem::file_size(folder / file.at("name")) == file.at("bytes"));
    }
  }
  return batch.result_names().size();
}

/// Begins a run, and waits until twenty results are there.
const std::string kRunToTwenty = "run & child=$!\nwhile [ $(count) -lt 20 ]; do kill -0 $child || exit 9; done\n";

constexpr int kJobs = 300;  // a second of work: time enough for the shell to stop it before its end

}  // namespace

TEST_CASE("A batch that is killed goes on where it was", "[command][batch][slow]") {
  const Batch batch(kJobs);
  const CommandResult killed = shell(batch, kRunToTwenty + "kill -KILL $child; wait $child; echo $?");
  INFO(killed.errors);
  REQUIRE(killed.exit_code == 0);
  REQUIRE(killed.output == "137\n");
  const std::size_t there = whole_results(batch);
  REQUIRE((there >= 20 && there < kJobs));
  const nlohmann::json rest = batch.run_well("run");
  CHECK(rest.at("present") == there);
  CHECK(rest.at("computed") == kJobs - there);
  CHECK(names_in(batch.results() / "partial").empty());  // nor is there what was at work
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
  CHECK(names_in(batch.results() / "partial").empty());
  const std::size_t there = whole_results(batch);
  REQUIRE(there < kJobs);
  // All that was done is in the report, and nothing of what was not.
  CHECK(batch.report().size() == there);
  for (const auto& record : batch.report()) CHECK(record.at("state") == "computed");
  CHECK(batch.run_well("status").at("done") == there);
  CHECK(batch.run_well("run").at("present") == there);
}

TEST_CASE("A folder of results that is full is no job's failure", "[command][batch]") {
  const Batch batch(3);
  // A limit on the size of files stands for a full disk.
  const CommandResult full = shell(batch, "ulimit -f 2; run --json");
  INFO(full.errors);
  CHECK(full.exit_code != 0);  // 128 more than SIGXFSZ
  CHECK(contains(full.errors, "jobs.results: cannot be written to"));
  CHECK(batch.report().empty());
  CHECK(batch.result_names().empty());
  CHECK(names_in(batch.results() / "partial").empty());
  CHECK(batch.run_well("run").at("computed") == 3);
}

TEST_CASE("What dead processes left is removed, but not that of a machine with a similar name", "[command][batch]") {
  const Batch batch(1);
  const std::filesystem::path partial = batch.results() / "partial";
  for (const char* name : {"node_2d12-999999999-0", "node12-999999999-0", "node_2d12-1-999999999-0"}) {
    std::filesystem::create_directories(partial / name);
  }
  const CommandResult renamed =
      shell(batch,
            "unshare --uts true 2>/dev/null || { echo no names; exit; }\n"
            "unshare --uts sh -c 'hostname node-12 && exec \"$@\"' sh '" WELKIN_COMMAND "' batch run \"$jobs\" -q\n");
  INFO(renamed.errors);
  if (renamed.output == "no names\n") {
    WARN("this machine gives no other host names");
    return;
  }
  REQUIRE(renamed.exit_code == 0);
  CHECK(names_in(partial) == std::vector<std::string>{"node12-999999999-0", "node_2d12-1-999999999-0"});
}

TEST_CASE("Two runs at once share the work", "[command][batch][slow]") {
  const Batch batch(kJobs);
  const CommandResult both = shell(batch,
                                   "(run --threads 1) & one=$!\n(run --threads 2) & other=$!\n"
                                   "wait $one; a=$?; wait $other; echo $a $?");
  INFO(both.errors);
  CHECK(both.output == "0 0\n");
  CHECK(both.errors.empty());
  CHECK(whole_results(batch) == kJobs);
  CHECK(names_in(batch.results() / "partial").empty());
  // Both reported: each job was computed by one of them, and found by the other.
  std::size_t computed = 0;
  for (const auto& record : batch.report()) computed += record.at("state") == "computed" ? 1 : 0;
  CHECK(computed == kJobs);
  const Batch other(kJobs);
  other.run_well("run");
  CHECK(batch.merged() == other.merged());
}
