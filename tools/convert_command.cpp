#include "tools/convert_command.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "tools/help_text.h"
#include "tools/options.h"
#include "tools/output.h"
#include "tools/pixels.h"
#include "tools/progress_bar.h"
#include "tools/sun_options.h"
#include "tools/turn_options.h"
#include "tools/write_output.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"
#include "welkin/resampling.h"

namespace welkin::tool {
namespace {

// Shares of the progress bar.
constexpr double kRead = 0.3;
constexpr double kResampled = 0.7;

struct ConvertOptions {
  CommonOptions common;
  std::string input;
  OutputOptions output;
  TurnOptions turn;
  SunChoice sun;
};

/// The source is still held while the result, of so many texels, is made from it.
void require_memory(const ConvertOptions& options, const Environment& source, std::uint64_t texels) {
  constexpr std::uint64_t kTexelBytes = 12;
  const auto face = static_cast<std::uint64_t>(source.face_size());
  const std::uint64_t held = kTexelBytes * (face > 0 ? 6 * face * face
                                                     : static_cast<std::uint64_t>(source.info.width) *
                                                           static_cast<std::uint64_t>(source.info.height));
  const std::uint64_t bytes = kTexelBytes * texels;
  const std::uint64_t limit = options.common.read.memory_limit_bytes;
  if (held + bytes <= limit) return;
  throw Error(ErrorCode::limit_exceeded,
              options.output.path + ": takes " + std::to_string(bytes) + " bytes at that size beside the " +
                  std::to_string(held) + " of the picture that is read, above the limit of " + std::to_string(limit) +
                  "; ask for a smaller --size or raise --memory-limit");
}

/// Nothing is resampled, or moved, unless something asks for it.
std::string write_cubemap(const ConvertOptions& options, const Environment& source, const Control& control) {
  const int face = source.face_size();
  const glm::dmat3 turn = turn_of_picture(options.turn, face > 0, true);
  const int size = options.output.size > 0 ? options.output.size : face > 0 ? face : (source.info.width + 3) / 4;
  const Control last = part_of(control, kResampled, 1.0);
  if (face == size && turn == glm::dmat3(1.0)) return write_output(options.output, source.cubemap(), last);
  require_memory(options, source,
                 std::uint64_t{6} * static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size));
  const Control middle = part_of(control, kRead, kResampled);
  const CubemapImage result =
      face > 0 ? to_cubemap(source.cubemap(), size, turn, middle) : to_cubemap(source.lat_long(), size, turn, middle);
  return write_output(options.output, result.view(), last);
}

std::string write_lat_long(const ConvertOptions& options, const Environment& source, const Control& control) {
  const int face = source.face_size();
  const glm::dmat3 turn = turn_of_picture(options.turn, face > 0, false);
  const int size = options.output.size;
  const int width = size > 0 ? size : face > 0 ? 4 * face : source.info.width;
  const int height = size > 0 || face > 0 ? lat_long_height(width) : source.info.height;
  const Control last = part_of(control, kResampled, 1.0);
  const bool same_shape = face == 0 && width == source.info.width && height == source.info.height;
  if (same_shape && turn == glm::dmat3(1.0)) return write_output(options.output, source.lat_long(), last);
  require_memory(options, source, static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height));
  const Control middle = part_of(control, kRead, kResampled);
  const LatLongImage result = face > 0 ? to_lat_long(source.cubemap(), width, height, turn, middle)
                                       : to_lat_long(source.lat_long(), width, height, turn, middle);
  return write_output(options.output, result.view(), last);
}

std::string convert(const ConvertOptions& options) {
  ProgressBar bar;
  const Control control = bar.control();
  const bool reads_cubemap = inspect_environment(options.input, options.common.read).layout != Layout::lat_long;
  check_write_options(options.output.path, options.output.write, wants_cubemap(options.output, reads_cubemap));
  Environment source = read_environment(options.input, options.common.read, part_of(control, 0.0, kRead));
  const bool is_cubemap = source.face_size() > 0;
  std::optional<Sun> sun;
  if (options.sun.take_out) {
    sun = take_out_sun(source, options.sun.options);
    if (sun) sun->direction = turn_of_light(options.turn, is_cubemap) * sun->direction;
  }
  const std::string written = wants_cubemap(options.output, is_cubemap) ? write_cubemap(options, source, control)
                                                                        : write_lat_long(options, source, control);
  return written + (options.sun.take_out ? sun_text(sun, convention(options.turn.to).from_welkin[1].z > 0.5) : "");
}

void run(const ConvertOptions& options) {
  std::string text;
  run_with_threads(options.common.threads, [&] { text = convert(options); });
  print_result(text);
}

}  // namespace

void add_convert_command(CLI::App& program) {
  const auto options = std::make_shared<ConvertOptions>();
  CLI::App& command = *program.add_subcommand("convert", "Write an environment in another format, layout or size");
  command.footer(std::string(kConvertFooter));
  CLI::Option* input =
      command.add_option("IN", options->input, "An OpenEXR, Radiance, PFM or PNG file")->required()->type_name("");
  command.add_option("OUT", options->output.path, "The file to write: .exr, .hdr, .pfm or .png")
      ->required()
      ->type_name("");
  add_output_options(command, options->output);
  add_turn_options(command, options->turn);
  add_sun_options(command, options->sun);
  add_read_options(command, options->common, input, "--in-layout");
  add_threads_option(command, options->common);
  command.callback([options] { run(*options); });
}

}  // namespace welkin::tool
