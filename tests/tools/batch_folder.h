// Batches for the tests of `welkin batch`: small images, plans and results.
#pragma once

#include "support/catch.h"
#include "tools/command.h"

namespace welkin::test {

inline constexpr const char* kFewFiles = " --size 8 --mips 2 --irradiance 4 --no-brdf --no-previews ";

/// Writes an image that is different for every `number`.
inline void write_image(const std::filesystem::path& path, int number, int width = 16) {
  std::vector<float> rgb = grey_image(width, width / 2, 0.5F);
  for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] += 0.25F * static_cast<float>((i * 7 + i / 5) % 3);
  rgb[0] = 1.0F + static_cast<float>(number);
  write_pfm(path, width, width / 2, rgb);
}

/// A folder with a batch: images, jobs.json, jobs.results.
class Batch {
 public:
  explicit Batch(int images = 0, const std::string& options = kFewFiles) {
    std::filesystem::create_directories(input());
    for (int i = 0; i < images; ++i) write_image(input() / ("image" + std::to_string(100 + i) + ".pfm"), i);
    if (images > 0) plan(quoted(input()) + options);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
  [[nodiscard]] std::filesystem::path input() const { return path() / "in"; }
  [[nodiscard]] std::filesystem::path jobs() const { return path() / "jobs.json"; }
  [[nodiscard]] std::filesystem::path results() const { return path() / "jobs.results"; }

  /// Runs `welkin batch ACTION jobs.json ...`.
  [[nodiscard]] CommandResult run(const std::string& action, const std::string& more = "") const {
    return run_welkin("batch " + action + ' ' + quoted(jobs()) + ' ' + more);
  }
  /// Requires success; the JSON that it prints.
  nlohmann::json run_well(const std::string& action, const std::string& more = "", int exit_code = 0) const {
    const CommandResult result = run(action, "--json " + more);
    INFO("welkin batch " << action << ' ' << more << "\nstandard error: " << result.errors);
    REQUIRE(result.exit_code == exit_code);
    return json_of(result.output);
  }
  nlohmann::json plan(const std::string& arguments) const {
    const CommandResult result = run_welkin("batch plan " + arguments + " -o " + quoted(jobs()));
    INFO(result.errors);
    REQUIRE(result.exit_code == 0);
    return json_of(file_text(jobs()));
  }
  nlohmann::json merged() const {
    run_well("merge", "-o " + quoted(path() / "index"));
    return json_of(file_text(path() / "index" / "index.json"));
  }
  /// The folders of results, by their names.
  [[nodiscard]] std::vector<std::string> result_names() const { return names_in(results()); }
  /// All result.json, by the folders' names.
  [[nodiscard]] std::map<std::string, nlohmann::json> records() const {
    std::map<std::string, nlohmann::json> found;
    for (const std::string& name : result_names()) {
      found[name] = json_of(file_text(results() / name / "result.json"));
    }
    return found;
  }
  /// The files of all results with their bytes, less result.json, which says when they were made.
  [[nodiscard]] std::map<std::string, std::string> all_files() const {
    std::map<std::string, std::string> files;
    for (const std::string& result : result_names()) {
      for (const std::string& name : names_in(results() / result)) {
        if (name != "result.json") files[result + '/' + name] = file_text(results() / result / name);
      }
    }
    return files;
  }

 private:
  TemporaryDirectory folder_;
};

}  // namespace welkin::test
