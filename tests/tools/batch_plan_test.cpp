
#include "places.h"
#include "support/trials.h"
#include "tools/batch_folder.h"

using namespace welkin;
using namespace welkin::test;

// `welkin batch plan`: what inputs stand for, options of each, costs; shards follow from the plan alone; a damaged plan
// is an error and nothing else.

namespace {

std::vector<std::string> names_of_jobs(const nlohmann::json& plan) {
  std::vector<std::string> names;
  for (const auto& job : plan.at("jobs")) names.push_back(job.at("name"));
  return names;
}

/// A plan whose inputs are not there, so that a run of it is a list of its jobs.
void write_made_up_plan(const Batch& batch, const std::vector<double>& seconds) {
  nlohmann::json plan = {{"schema", "welkin batch jobs"}, {"version", 1}, {"jobs", nlohmann::json::array()}};
  for (const double each : seconds) {
    plan["jobs"].push_back({{"name", std::to_string(plan["jobs"].size())},
                            {"input", std::to_string(plan["jobs"].size()) + ".hdr"},
                            {"options", nlohmann::json::array()},
                            {"seconds", each}});
  }
  std::ofstream(batch.jobs()) << plan;
}

/// The jobs of each shard, by the results that fail.
std::vector<std::vector<std::size_t>> cut_of(const Batch& batch, int shards) {
  std::vector<std::vector<std::size_t>> cut;
  for (int shard = 1; shard <= shards; ++shard) {
    const std::string part = "--shard " + std::to_string(shard) + '/' + std::to_string(shards);
    static_cast<void>(batch.run("run", "--threads 1 " + part));
    auto& jobs = cut.emplace_back();
    const nlohmann::json status = batch.run_well("status", part, 1);
    for (const auto& trouble : status.at("troubles")) {
      jobs.push_back(std::stoul(trouble.at("name").get<std::string>()));
    }
    std::ranges::sort(jobs);
  }
  return cut;
}

}  // namespace

TEST_CASE("A batch takes files, folders and patterns", "[command][batch]") {
  const Batch batch;
  for (const char* folder : {"in/a/deep", "in/.hidden", "in/made"}) {
    std::filesystem::create_directories(batch.path() / folder);
  }
  for (const char* name : {"b.pfm", "a/one.PFM", "a/deep/two.pfm", ".hidden/three.pfm", "made/four.pfm", "a/c.pfm"}) {
    write_image(batch.input() / name, 1);
  }
  std::ofstream(batch.input() / "a" / "notes.txt") << "no image";
  std::ofstream(batch.input() / "made" / "manifest.json") << R"({"welkin": "0.1.0"})";
  std::ofstream(batch.input() / "a" / "manifest.json") << "{}";  // of another program

  using Names = std::vector<std::string>;
  CHECK(names_of_jobs(batch.plan(quoted(batch.input()) + kFewFiles)) == Names{"a/c", "a/deep/two", "a/one", "b"});
  CHECK(names_of_jobs(batch.plan(quoted(batch.input() / "*.pfm") + kFewFiles)) == Names{"b"});
  CHECK(names_of_jobs(batch.plan(quoted(batch.input() / "**" / "?.pfm") + kFewFiles)) == Names{"c", "b"});
  CHECK(names_of_jobs(batch.plan(quoted(batch.input() / "a" / "*" / "t*o.pfm") + kFewFiles)) == Names{"two"});
  // A file that is named is taken as it is, and two may have one name.
  const nlohmann::json plan =
      batch.plan(quoted(batch.input() / "b.pfm") + ' ' + quoted(batch.input() / "b.pfm") + kFewFiles);
  CHECK(names_of_jobs(plan) == Names{"b", "b-2"});
  CHECK(plan.at("jobs")[0].at("input") == "in/b.pfm");
  CHECK(plan.at("jobs")[0].at("size") == std::filesystem::file_size(batch.input() / "b.pfm"));
  CHECK(plan.at("jobs")[0].at("options") ==
        nlohmann::json({"--size", "8", "--mips", "2", "--irradiance", "4", "--no-brdf", "--no-previews"}));
  const double seconds = plan.at("jobs")[0].at("seconds");
  CHECK((seconds > 0.0 && seconds < 1.0));
  CHECK(plan.at("totals").at("seconds").get<double>() == Approx(2.0 * seconds));
}

TEST_CASE("An input that is named and cannot be read is an error, and there is no plan", "[command][batch]") {
  const Batch batch;
  write_image(batch.input() / "a.pfm", 1);
  std::ofstream(batch.input() / "notes.txt") << "no image";
  for (const char* name : {"gone.hdr", "gone/", "notes.txt"}) {
    INFO(name);
    const std::string inputs = quoted(batch.input() / "a.pfm") + ' ' + quoted(batch.input() / name);
    const CommandResult result = run_welkin("batch plan " + inputs + kFewFiles + "-o " + quoted(batch.jobs()));
    CHECK(result.exit_code == 1);
    CHECK(contains(result.errors, name));
    CHECK(!contains(result.errors, "a.pfm"));
    CHECK(!std::filesystem::exists(batch.jobs()));
  }
}

TEST_CASE("An input of a list or a folder that cannot be read is told, and stays in the plan", "[command][batch]") {
  const Batch batch;
  write_image(batch.input() / "a.pfm", 1);
  std::ofstream(batch.input() / "b.hdr") << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";
  std::ofstream(batch.path() / "list.jsonl") << R"({"input": "elsewhere/gone.hdr"})";
  const std::string inputs = quoted(batch.input()) + " --list " + quoted(batch.path() / "list.jsonl");
  const CommandResult result = run_welkin("batch plan " + inputs + kFewFiles + "-o " + quoted(batch.jobs()));
  CHECK(result.exit_code == 0);
  CHECK(contains(result.output, "error: "));
  CHECK(contains(result.output, "gone.hdr"));
  CHECK(contains(result.output, "b.hdr"));
  const nlohmann::json plan = json_of(file_text(batch.jobs()));
  REQUIRE(plan.at("jobs").size() == 3);
  CHECK(!plan.at("jobs")[0].contains("error"));
  CHECK(contains(plan.at("jobs")[1].at("error").get<std::string>(), "b.hdr"));
  CHECK(contains(plan.at("jobs")[2].at("error").get<std::string>(), "gone.hdr"));
  CHECK(plan.at("totals").at("errors") == 2);
}

TEST_CASE("A list is read to its end, or there is no plan", "[command][batch]") {
  const Batch batch(1);
  std::filesystem::remove(batch.jobs());
  const std::filesystem::path list = batch.path() / "list.jsonl";
  const auto failure = [&](const std::filesystem::path& named) {
    const CommandResult result = run_welkin("batch plan --list " + quoted(named) + " -o " + quoted(batch.jobs()));
    CHECK(result.exit_code == 1);
    CHECK(!std::filesystem::exists(batch.jobs()));
    return result.errors;
  };
  {
    std::ofstream stream(list);
    stream << R"({"input": "in/image100.pfm"})" << '\n' << std::string((1U << 20U) + 1, 'x');
  }
  CHECK(contains(failure(list), "list.jsonl: line 2: is longer than a megabyte"));
  CHECK(contains(failure(batch.path() / "nothing.jsonl"), "nothing.jsonl: cannot be read"));
  CHECK(contains(failure(batch.path()), "neither a regular file nor a pipe"));
}

TEST_CASE("Six faces in a folder are one job", "[command][batch]") {
  const Batch batch;
  for (const char* face : {"px", "nx", "py", "ny", "pz", "nz"}) {
    write_pfm(batch.input() / ("room_" + std::string(face) + ".pfm"), 8, 8, grey_image(8, 8, 1.0F));
  }
  write_image(batch.input() / "sky.pfm", 1);
  const nlohmann::json plan = batch.plan(quoted(batch.input()) + kFewFiles);
  REQUIRE(plan.at("jobs").size() == 2);
  CHECK(batch.run_well("run").at("computed") == 2);
}

TEST_CASE("A list's lines have names and options of their own", "[command][batch]") {
  const Batch batch;
  write_image(batch.input() / "a.pfm", 1);
  std::ofstream(batch.input() / "needs.json") << R"({"glossy": null})";
  const std::filesystem::path list = batch.input() / "list.jsonl";
  std::ofstream(list) << R"({"input": "a.pfm", "name": "small"})"
                      << "\n\n"
                      << R"({"input": "a.pfm", "name": "large", "options": ["--size", "16"]})" << '\n'
                      << R"({"input": "a.pfm", "name": "matte", "options": ["--needs=needs.json"]})" << '\n';
  const nlohmann::json plan = batch.plan("--list " + quoted(list) + kFewFiles);
  CHECK(names_of_jobs(plan) == std::vector<std::string>{"small", "large", "matte"});
  CHECK(plan.at("jobs")[2].at("options").back() == "in/needs.json");
  // From anywhere else: what the plan names lies where the plan does.
  const std::filesystem::path here = std::filesystem::current_path();
  std::filesystem::current_path(here.root_path());
  const CommandResult run = run_program(WELKIN_COMMAND, "batch run " + quoted(batch.jobs()) + " --json");
  std::filesystem::current_path(here);
  INFO(run.errors);
  REQUIRE(run.exit_code == 0);
  const nlohmann::json index = batch.merged();
  const auto folder = [&](int job) { return batch.path() / "index" / index.at("jobs")[job].at("result"); };
  CHECK(file_of(manifest_of(folder(0)), "specular.ktx2").at("size") == 8);
  CHECK(file_of(manifest_of(folder(1)), "specular.ktx2").at("size") == 16);
  CHECK(!std::filesystem::exists(folder(2) / "specular.ktx2"));

  for (const char* line : {R"({"input": "a.pfm", "options": ["--sizes", "16"]})", R"({"input": "a.pfm", "colour": 1})",
                           R"({"name": "nothing"})", R"({"input": "a.pfm", "options": ["-o", "x"]})", "{", "[]"}) {
    std::ofstream(list) << R"({"input": "a.pfm"})" << '\n' << line << '\n';
    INFO(line);
    const CommandResult result = run_welkin("batch plan --list " + quoted(list) + " -o " + quoted(batch.jobs()));
    CHECK(result.exit_code == 2);
  }
}

TEST_CASE("A batch writes over nothing that is not its own", "[command][batch]") {
  const Batch batch(2);
  const std::filesystem::path image = batch.input() / "image100.pfm";
  const std::string bytes = file_text(image);
  CHECK(run_welkin("batch plan " + quoted(image) + " -o " + quoted(image)).exit_code == 1);
  CHECK(file_text(image) == bytes);
  CHECK(run_welkin("batch plan " + quoted(batch.input()) + " -o " + quoted(batch.path() / "no" / "x.json")).exit_code ==
        1);
  batch.plan(quoted(batch.input()) + kFewFiles);  // over the plan that is there
  batch.run_well("run");
  const std::filesystem::path site = batch.path() / "site";
  for (const char* name : {"index.html", "index.json"}) {
    std::filesystem::remove_all(site);
    std::filesystem::create_directories(site);
    std::ofstream(site / name) << "mine";
    const CommandResult merged = batch.run("merge", "-o " + quoted(site));
    CHECK(merged.exit_code == 1);
    CHECK(contains(merged.errors, name));
    CHECK(file_text(site / name) == "mine");
  }
  std::filesystem::remove_all(site);
  batch.run_well("merge", "-o " + quoted(site));
  batch.run_well("merge", "-o " + quoted(site));  // over its own
}

TEST_CASE("Patterns find images, and none that a bake has made", "[command][batch]") {
  const Batch batch(3);
  std::ofstream(batch.input() / "notes.txt") << "none";
  bake_into(batch.input() / "baked", quoted(batch.input() / "image100.pfm") + kFewFiles);
  for (const char* pattern : {"in/**/*", "in/*"}) {
    CAPTURE(pattern);
    CHECK(batch.plan(quoted(batch.path() / pattern)).at("jobs").size() == 3);
  }
}

TEST_CASE("Shards are cut by predicted cost, the same by everyone", "[command][batch][slow]") {
  std::mt19937 random(20);  // NOLINT: the same numbers each time
  const Batch batch;
  std::vector<double> seconds(120);
  for (double& each : seconds) each = std::exp(std::uniform_real_distribution<>(-3.0, 3.0)(random));
  for (std::size_t i = 0; i < 20; ++i) seconds[i] = 0.25;  // and some alike
  write_made_up_plan(batch, seconds);
  constexpr int kShards = 7;
  const auto cut = cut_of(batch, kShards);
  std::vector<std::size_t> all;
  double largest = 0.0;
  double minimum = 1e9;
  for (const auto& shard : cut) {
    double load = 0.0;
    for (const std::size_t job : shard) load += seconds[job];
    largest = std::max(largest, load);
    minimum = std::min(minimum, load);
    all.insert(all.end(), shard.begin(), shard.end());
  }
  std::ranges::sort(all);
  std::vector<std::size_t> each(seconds.size());
  std::iota(each.begin(), each.end(), std::size_t{0});
  CHECK(all == each);
  CHECK(largest <= 1.05 * minimum);
  // Another process, another order of runs.
  std::filesystem::remove_all(batch.results());
  CHECK(cut_of(batch, kShards) == cut);
}

TEST_CASE("A damaged plan is an error that names it", "[command][batch][slow]") {
  const Batch batch(2);
  const std::string text = file_text(batch.jobs());
  const auto run = [&](const std::string& damaged) {
    std::ofstream(batch.jobs()) << damaged;
    for (const char* action : {"status", "run"}) {
      const CommandResult result = batch.run(action);
      INFO(action << " of " << damaged << "\nsays " << result.errors);
      CHECK((result.exit_code == 0 || result.exit_code == 1));
      if (result.exit_code == 1) CHECK(result.errors.starts_with("welkin: "));
    }
  };
  for (std::size_t length = 0; length < text.size(); length += 97) run(text.substr(0, length));
  const nlohmann::json plan = json_of(text);
  const std::array<nlohmann::json, 7> values = {
      nullptr, -1, 1e300, "../../x", nlohmann::json::array({"--no-such"}), true, nlohmann::json::object()};
  for (const char* pointer :
       {"/schema", "/version", "/jobs", "/jobs/0", "/jobs/0/name", "/jobs/0/input", "/jobs/0/options",
        "/jobs/0/options/0", "/jobs/0/seconds", "/jobs/0/size", "/jobs/0/memory", "/totals"}) {
    for (std::size_t k = 0; k < values.size(); k += static_cast<std::size_t>(stride(2))) {
      nlohmann::json damaged = plan;
      damaged[nlohmann::json::json_pointer(pointer)] = values.at(k);
      run(damaged.dump());
    }
  }
  for (const char* pointer : {"/schema", "/version", "/jobs/0/name", "/jobs/0/seconds"}) {
    nlohmann::json damaged = plan;
    damaged[nlohmann::json::json_pointer(pointer)] = nullptr;
    std::ofstream(batch.jobs()) << damaged;
    INFO(pointer);
    const CommandResult result = batch.run("run");
    CHECK(result.exit_code == 1);
    CHECK(contains(result.errors, "jobs.json"));
  }
  nlohmann::json twice = plan;
  twice["jobs"][1]["name"] = twice["jobs"][0]["name"];
  std::ofstream(batch.jobs()) << twice;
  CHECK(batch.run("run").exit_code == 1);
}
