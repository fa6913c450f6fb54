#include "perf.h"
#include "tools/previews.h"
#include "welkin/bake.h"
#include "welkin/environment_file.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::perf {
namespace {

std::string quoted(const std::filesystem::path& path) { return '"' + path.string() + '"'; }

void run(const std::string& arguments) {
  const std::string line = quoted(WELKIN_COMMAND) + ' ' + arguments;
  // NOLINTNEXTLINE(concurrency-mt-unsafe, cert-env33-c): a shell as a person has it, and one at a time
  if (std::system(line.c_str()) != 0) throw std::runtime_error("failed: " + line);
}

std::filesystem::path folder(const std::string& name) {
  return scratch_file(name, [](const auto& path) { std::filesystem::create_directory(path); });
}

}  // namespace

void add_command(const std::vector<int>& thread_counts) {
  constexpr double kTexels = 1024.0 * 512.0;
  for (const char* const size : {"256", "512"}) {
    for (const int threads : thread_counts) {
      for (const bool again : {false, true}) {
        add_benchmark(
            "Command", again ? "bake-again" : "bake", size, threads, kTexels, 0.0, [=]() -> std::function<void()> {
              const std::filesystem::path picture = scratch_file(
                  "command.hdr", [](const auto& path) { (void)write_environment(path, sky_picture().view()); });
              std::string arguments = "bake " + quoted(picture) + " --quiet --size " + size + " --threads " +
                                      std::to_string(threads) + " -o " + quoted(folder("command"));
              if (again) {
                arguments += " --cache " + quoted(folder("command-cache"));
                run(arguments);
              }
              return [arguments] { run(arguments); };
            });
      }
    }
  }
}

namespace {

BakeOptions all_that_previews_show() {
  BakeOptions options;
  options.specular = PrefilterOptions{};
  options.irradiance = IrradianceOptions{};
  options.brdf = BrdfTableOptions{};
  return options;
}

}  // namespace

void add_previews(const std::vector<int>& thread_counts) {
  constexpr double kPixels = 1792.0 * 640.0 + 1024.0 * 512.0 + 1000.0 * 350.0;
  for (const int threads : thread_counts) {
    add_benchmark("Previews", "spheres-256", "256", threads, kPixels, 0.0, []() -> std::function<void()> {
      const auto folder = scratch_file("previews", [](const auto& path) { std::filesystem::create_directory(path); });
      auto light = std::make_shared<BakeResult>(bake(sky_picture().view(), all_that_previews_show()));
      return [light, folder] {
        const tool::PreviewOptions options{tool::ToneMap{exposure_of(light->background->view(3))}};
        benchmark::DoNotOptimize(tool::write_previews(*light, options, folder));
      };
    });
  }
}

}  // namespace welkin::perf
