#include "tools/testmap_command.h"

#include <cstdint>
#include <memory>
#include <string>

#include "tools/help_text.h"
#include "tools/options.h"
#include "tools/output.h"
#include "tools/progress_bar.h"
#include "tools/write_output.h"
#include "welkin/error.h"
#include "welkin/test_map.h"

namespace welkin::tool {
namespace {

constexpr int kFaceSize = 512;
constexpr int kLatLongWidth = 2048;

struct TestmapOptions {
  CommonOptions common;
  OutputOptions output;
};

void require_memory(const TestmapOptions& options, std::uint64_t texels) {
  constexpr std::uint64_t kTexelBytes = 12;
  const std::uint64_t limit = options.common.read.memory_limit_bytes;
  if (texels * kTexelBytes <= limit) return;
  throw Error(ErrorCode::limit_exceeded, options.output.path + ": takes " + std::to_string(texels * kTexelBytes) +
                                             " bytes at that size, above the limit of " + std::to_string(limit) +
                                             "; ask for a smaller --size or raise --memory-limit");
}

// Drawing is most of the work.
std::string draw_and_write(const TestmapOptions& options) {
  constexpr double kDrawn = 0.9;
  const OutputOptions& output = options.output;
  const bool cubemap = wants_cubemap(output, false);
  check_write_options(output.path, output.write, cubemap);
  const auto square = [](int edge) { return static_cast<std::uint64_t>(edge) * static_cast<std::uint64_t>(edge); };
  ProgressBar bar;
  const Control control = bar.control();
  const Control drawing = part_of(control, 0.0, kDrawn);
  const Control writing = part_of(control, kDrawn, 1.0);
  if (cubemap) {
    const int size = output.size > 0 ? output.size : kFaceSize;
    require_memory(options, 6 * square(size));
    return write_output(output, test_map_cubemap(size, drawing).view(), writing);
  }
  const int width = output.size > 0 ? output.size : kLatLongWidth;
  require_memory(options, square(width) / 2);
  return write_output(output, test_map_lat_long(width, lat_long_height(width), drawing).view(), writing);
}

void run(const TestmapOptions& options) {
  std::string text;
  run_with_threads(options.common.threads, [&] { text = draw_and_write(options); });
  print_result(text);
}

}  // namespace

void add_testmap_command(CLI::App& program) {
  const auto options = std::make_shared<TestmapOptions>();
  CLI::App& command = *program.add_subcommand("testmap", "Make an environment that shows how it is turned");
  command.footer(std::string(kTestmapFooter));
  command.add_option("-o,--output", options->output.path, "The file to write: .exr, .hdr, .pfm or .png")
      ->required()
      ->type_name("OUT");
  add_output_options(command, options->output);
  add_memory_limit_option(command, options->common);
  add_threads_option(command, options->common);
  command.callback([options] { run(*options); });
}

}  // namespace welkin::tool
