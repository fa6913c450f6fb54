
#include "tools/batch_folder.h"

using namespace welkin;
using namespace welkin::test;

// `welkin batch run`, `status` and `merge`: results are those of single bakes, whole, made once, checked byte by byte.
// Failures are reported and stop nothing else.

namespace {

/// Changes a byte in the middle.
void damage(const std::filesystem::path& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  REQUIRE(file.good());
  const auto middle = static_cast<std::streamoff>(std::filesystem::file_size(path) / 2);
  file.seekg(middle);
  const auto byte = static_cast<char>(file.get());
  file.seekp(middle);
  file.put(static_cast<char>(byte ^ 1));
}

}  // namespace

TEST_CASE("A batch's results are those of single bakes", "[command][batch]") {
  const Batch batch(3);
  CHECK(batch.run_well("run").at("computed") == 3);
  const nlohmann::json index = batch.merged();
  REQUIRE(index.at("jobs").size() == 3);
  bake_into(batch.path() / "single", quoted(batch.input() / "image101.pfm") + kFewFiles);
  const std::filesystem::path result = batch.path() / "index" / index.at("jobs")[1].at("result");
  CHECK(index.at("jobs")[1].at("name") == "image101");
  for (const char* name : {"background.ktx2", "specular.ktx2", "irradiance.ktx2"}) {
    INFO(name);
    CHECK(file_text(result / name) == file_text(batch.path() / "single" / name));
  }
  // Nothing in them depends on where and when they were made.
  const nlohmann::json manifest = manifest_of(result);
  CHECK(!manifest.contains("times"));
  CHECK(manifest.at("source").at("path") == "environment");
  for (const auto& [name, text] : batch.all_files()) {
    INFO(name);
    CHECK(!contains(text, "image10"));
  }
}

TEST_CASE("What is there is not computed again", "[command][batch]") {
  const Batch batch(4);
  CHECK(batch.run_well("run", "--threads 2").at("computed") == 4);
  const auto files = batch.all_files();
  const nlohmann::json again = batch.run_well("run");
  CHECK(again.at("computed") == 0);
  CHECK(again.at("present") == 4);
  CHECK(batch.all_files() == files);
  // Another image by the same name, and other options.
  write_image(batch.input() / "image100.pfm", 50);
  CHECK(batch.run_well("run").at("computed") == 1);
  batch.plan(quoted(batch.input()) + kFewFiles + "--yaw 90");
  CHECK(batch.run_well("run").at("computed") == 4);
  CHECK(batch.result_names().size() == 8);
}

TEST_CASE("A cache has what was baked of the same bytes, by whatever name", "[command][batch]") {
  const Batch batch(2);
  const std::string cache = "--cache " + quoted(batch.path() / "cache");
  batch.run_well("run", cache);
  const auto files = batch.all_files();
  std::filesystem::remove_all(batch.results());
  const auto entries = names_in(batch.path() / "cache").size();
  CHECK(batch.run_well("run", cache).at("computed") == 2);
  CHECK(batch.all_files() == files);
  std::filesystem::rename(batch.input() / "image100.pfm", batch.input() / "renamed.pfm");
  batch.plan(quoted(batch.input()) + kFewFiles);
  CHECK(batch.run_well("run", cache).at("computed") == 1);
  CHECK(names_in(batch.path() / "cache").size() == entries);
}

TEST_CASE("An input that fails is told, and stops no other", "[command][batch]") {
  const Batch batch(3);
  write_image(batch.input() / "gone.pfm", 50);
  batch.plan(quoted(batch.input()) + kFewFiles);
  std::filesystem::remove(batch.input() / "gone.pfm");
  const auto bytes = std::filesystem::file_size(batch.input() / "image101.pfm");
  std::filesystem::resize_file(batch.input() / "image101.pfm", bytes - 10);
  const CommandResult result = batch.run("run");
  CHECK(result.exit_code == 1);
  CHECK(contains(result.output, "2 computed, 0 present, 2 failed"));
  CHECK(contains(result.errors, "image101"));
  std::multiset<std::string> codes;
  for (const auto& [name, record] : batch.records()) {
    INFO(record);
    CHECK(record.at("state") == (record.contains("error") ? "failed" : "computed"));
    codes.insert(record.value("error_code", ""));
  }
  CHECK(codes == std::multiset<std::string>{"", "", "corrupt_file", "file_access"});
  const nlohmann::json status = batch.run_well("status", "", 1);
  CHECK(status.at("done") == 2);
  CHECK(status.at("failed") == 2);
  CHECK(status.at("left") == 0);
  const CommandResult merge = batch.run("merge", "-o " + quoted(batch.path() / "index"));
  CHECK(merge.exit_code == 1);
  CHECK(contains(merge.errors, "gone"));
  CHECK(contains(merge.errors, "image101"));
  CHECK(!std::filesystem::exists(batch.path() / "index"));
  // Once the input is repaired, the job succeeds and the failure is dropped.
  write_image(batch.input() / "gone.pfm", 50);
  write_image(batch.input() / "image101.pfm", 1);
  CHECK(batch.run_well("run").at("computed") == 2);
  CHECK(batch.run_well("status").at("done") == 4);
}

TEST_CASE("A truncated result is not counted as done, and made anew", "[command][batch][slow]") {
  const Batch batch(2);
  batch.run_well("run");
  const auto files = batch.all_files();
  const std::filesystem::path result = batch.results() / batch.result_names().front();
  SECTION("cut") { std::filesystem::resize_file(result / "specular.ktx2", 100); }
  SECTION("without a file") { std::filesystem::remove(result / "sh.h"); }
  SECTION("without its list") { std::filesystem::remove(result / "result.json"); }
  SECTION("with half a list") { std::filesystem::resize_file(result / "result.json", 40); }
  SECTION("with a list that is none") { std::ofstream(result / "result.json") << "{}"; }
  const nlohmann::json status = batch.run_well("status");
  CHECK(status.at("done") == 1);
  CHECK(status.at("left") == 1);
  CHECK(batch.run("merge", "-o " + quoted(batch.path() / "index")).exit_code == 1);
  const nlohmann::json again = batch.run_well("run");
  CHECK(again.at("computed") == 1);
  CHECK(again.at("present") == 1);
  CHECK(batch.all_files() == files);
}

TEST_CASE("Merging looks at every byte", "[command][batch][slow]") {
  const Batch batch(3);
  batch.run_well("run");
  batch.merged();
  const std::filesystem::path result = batch.results() / batch.result_names()[1];
  const std::string merge = "-o " + quoted(batch.path() / "index2");
  for (const char* name : {"irradiance.ktx2", "manifest.json", "sh.json"}) {
    damage(result / name);
    const CommandResult damaged = batch.run("merge", merge);
    INFO(damaged.errors);
    CHECK(damaged.exit_code == 1);
    CHECK(contains(damaged.errors, name));
    CHECK(contains(damaged.errors, "1 result of 3"));
    damage(result / name);  // damages the same byte again, which restores it
  }
  CHECK(batch.run("merge", merge).exit_code == 0);
  // A list that names files elsewhere is refused.
  nlohmann::json list = json_of(file_text(result / "result.json"));
  list["files"][0]["name"] = "../x";
  std::ofstream(result / "result.json") << list;
  CHECK(batch.run("merge", merge).exit_code == 1);
  std::filesystem::remove_all(result);
  const CommandResult missing = batch.run("merge", merge);
  CHECK(missing.exit_code == 1);
  CHECK(contains(missing.errors, "missing result " + result.filename().string()));
}

TEST_CASE("The index has a page of previews", "[command][batch][posix]") {
  const Batch batch(1, " --size 8 --irradiance 4 --no-brdf --preview-size 8 ");
  std::filesystem::rename(batch.input() / "image100.pfm", batch.input() / "a<b>&\"%.pfm");
  batch.plan(quoted(batch.input()) + " --size 8 --irradiance 4 --no-brdf --preview-size 8 ");
  batch.run_well("run");
  batch.merged();
  const std::string page = file_text(batch.path() / "index" / "index.html");
  CHECK(contains(page, R"("name":"a\u003cb>&\"%")"));  // what ends a script must not stand in it
  CHECK(contains(page, R"("layout":"lat-long")"));
  CHECK(contains(page, R"("name":"preview_spheres.png")"));
  CHECK(contains(page, R"("result":"../jobs.results/)" + batch.result_names().front() + '"'));
  CHECK(!contains(page, "http"));
}

TEST_CASE("Status says what is done, left and failed, of a shard or all", "[command][batch]") {
  const Batch batch(5);
  nlohmann::json status = batch.run_well("status");
  CHECK(status.at("left") == 5);
  CHECK(status.at("seconds_left").get<double>() > 0.0);
  batch.run_well("run", "--shard 1/2");
  status = batch.run_well("status");
  const int done = status.at("done");
  CHECK((done == 2 || done == 3));
  CHECK(status.at("left") == 5 - done);
  CHECK(batch.run_well("status", "--shard 1/2").at("left") == 0);
  CHECK(batch.run_well("status", "--shard 2/2").at("done") == 0);
  CHECK(batch.run_well("status", "--shard 2/2").at("left") == 5 - done);
  batch.run_well("run", "--shard 2/2");
  CHECK(batch.run_well("status").at("done") == 5);
  std::filesystem::remove_all(batch.results() / batch.result_names().front());
  CHECK(batch.run_well("status").at("done") == 4);
}

TEST_CASE("Results are computed once more, on another shard, and compared", "[command][batch][slow]") {
  const Batch batch(8);
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    batch.run_well("run", std::string("--shard ") + shard);
  }
  std::size_t verified = 0;
  for (const char* shard : {"1", "2", "3"}) {
    const std::string of = std::string("--shard ") + shard + "/3";
    verified += batch.run_well("run", of + " --verify 1").at("verified").get<std::size_t>();
    CHECK(batch.run_well("run", of + " --verify 0").at("verified") == 0);
  }
  CHECK(verified == 8);
  // Half of them, the same half each time.
  const auto half = [&] { return batch.run_well("run", "--verify 0.5").at("verified").get<int>(); };
  const int some = half();
  CHECK((some > 0 && some < 8));
  CHECK(half() == some);

  const std::filesystem::path result = batch.results() / batch.result_names()[2];
  SECTION("bytes that changed since") { damage(result / "specular.ktx2"); }
  SECTION("bytes that were wrong from the beginning") {
    nlohmann::json list = json_of(file_text(result / "result.json"));
    const Batch wrong(1, std::string(kFewFiles) + "--yaw 180");
    wrong.run_well("run");
    const std::filesystem::path other = wrong.results() / wrong.result_names().front();
    std::filesystem::remove_all(result);
    std::filesystem::copy(other, result);
    nlohmann::json copied = nlohmann::json::parse(file_text(result / "result.json"));
    copied["key"] = list.at("key");
    std::ofstream(result / "result.json") << copied;
  }
  const CommandResult told = batch.run("run", "--verify 1 --json");
  CHECK(told.exit_code == 1);
  CHECK(contains(told.errors, "specular.ktx2"));
  const nlohmann::json outcome = nlohmann::json::parse(told.output);
  CHECK(outcome.at("differs") == 1);
  CHECK(outcome.at("verified") == 7);
  CHECK(batch.run("status").exit_code == 1);
  CHECK(batch.run_well("run").at("computed") == 1);  // the damaged result again
  CHECK(batch.run("status").exit_code == 0);
}

TEST_CASE("Bakes that run at the same time stay below the memory that they may take", "[command][batch][slow]") {
  const Batch batch;
  for (int i = 0; i < 8; ++i) write_image(batch.input() / (std::to_string(i) + ".pfm"), i, i < 6 ? 512 : 64);
  const nlohmann::json plan = batch.plan(quoted(batch.input()) + " --size 64 --irradiance 4 --no-brdf --no-previews");
  std::uint64_t largest = 0;
  for (const auto& job : plan.at("jobs")) largest = std::max(largest, job.at("memory").get<std::uint64_t>());
  // Memory for one job, which gets all threads, and for three jobs with one thread each.
  for (const std::uint64_t limit : {largest + largest / 4, 3 * largest + largest / 4}) {
    std::filesystem::remove_all(batch.results());
    CHECK(batch.run_well("run", "--threads 4 --memory " + std::to_string(limit)).at("computed") == 8);
    const std::uint64_t most = limit / largest;  // large jobs that may overlap
    const auto records = batch.records();
    for (const auto& [name, one] : records) {
      std::size_t large = 0;
      for (const auto& [other, record] : records) {
        const double start = record.at("start");
        const bool overlaps = start <= one.at("start") && one.at("start") < start + record.at("seconds").get<double>();
        const nlohmann::json manifest = manifest_of(batch.results() / other);
        if (overlaps && manifest.at("source").at("width") == 512) ++large;
      }
      CHECK(large <= most);
    }
  }
  // Every job that exceeds the limit by itself fails.
  std::filesystem::remove_all(batch.results());
  const nlohmann::json outcome = batch.run_well("run", "--memory 2MiB", 1);
  CHECK(outcome.at("failed") == 8);
  const nlohmann::json record = batch.records().begin()->second;
  CHECK(record.at("error_code") == "limit_exceeded");
  CHECK(contains(record.at("error").get<std::string>(), "raise --memory to"));  // and no --memory-limit
}
