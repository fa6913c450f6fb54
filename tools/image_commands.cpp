// The commands that write images: `welkin convert`, an environment in another format, layout, size or orientation;
// `welkin testmap`, one that shows its orientation; and `welkin sample`, a room to try the others with.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "embedded_texts.h"
#include "files/write_environment.h"
#include "platform/text.h"
#include "tools/commands.h"
#include "tools/input.h"
#include "tools/preview_light.h"
#include "tools/terminal.h"
#include "tools/test_map.h"
#include "tools/text.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {
namespace {

// Helpers that these commands share.

struct OutputOptions {
  std::string path;            ///< "-": standard output
  std::string format = "exr";  ///< of standard output, whose name does not determine it
  WriteOptions write;
  int size = 0;                 ///< of a cube: a face's edge; of a lat-long: its width; 0: that of the input
  const char* if_clamped = "";  ///< end of the note about clamped values
};

/// Returns a lat-long's height for its width: half, rounded up.
constexpr int lat_long_height(int width) noexcept { return (width + 1) / 2; }

constexpr int kLargestWidth = 65536;

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

std::string described(const WriteReport& report, const std::string& what, const std::string& if_clamped) {
  std::string text;
  for (const auto& file : report.files) text += printable(platform::utf8(file)) + ": " + what + '\n';
  if (report.values_clamped > 0) {
    text +=
        "note: " + counted(report.values_clamped, "value") + " beyond the format's range, clamped" + if_clamped + '\n';
  }
  return text;
}

/// Adds --layout, --size, --type and --format.
void add_output_options(Options& table, OutputOptions& options) {
  table.push_back(choice<Layout>(
      "--layout", options.write.layout, layout_choices(),
      "Layout of the sphere in OUT; default automatic: a lat-long stays one, and a cubemap becomes a vertical strip"));
  add_option(table, "--size", &options.size, "N", "Texels per edge of a cubemap, or width of a lat-long",
             {.bounds = whole_between(1, kLargestWidth)});
  table.push_back(choice<SampleType>(
      "--type", options.write.type,
      {{"half", SampleType::half},
       {"float", SampleType::float32},
       {"8bit", SampleType::uint8},
       {"16bit", SampleType::uint16}},
      "Type of values in OUT: .exr half or float, .pfm float, .png 8bit or 16bit; default half, 8bit "
      "for .png"));
  table.push_back(choice<std::string>("--format", options.format,
                                      {{"exr", "exr"}, {"hdr", "hdr"}, {"pfm", "pfm"}, {"png", "png"}},
                                      "The format of OUT where that is -; default exr"));
}

/// Returns whether the options select a cubemap; by default the output has the input's kind.
bool wants_cubemap(const OutputOptions& options, bool have_cubemap) noexcept {
  const Layout layout = options.write.layout;
  return layout == Layout::automatic ? have_cubemap : layout != Layout::lat_long;
}

/// Returns a name whose extension gives the format, as the library expects it.
std::string name_of_output(const OutputOptions& options) {
  return is_standard_stream(options.path) ? "standard output." + options.format : options.path;
}

void check_output(const OutputOptions& options, bool cubemap) {
  check_write_options(platform::path_of(name_of_output(options)), options.write, cubemap);
  if (is_standard_stream(options.path) && options.write.layout == Layout::six_files) {
    throw Error(ErrorCode::invalid_argument, "standard output is one file, and --layout six-files makes six; name OUT");
  }
}

/// Returns words for the content of a file of the image.
std::string words_of(const EnvironmentView& image, Layout layout) {
  if (image.kind() == EnvironmentKind::lat_long) {
    const LatLongView whole = image.lat_long();
    return std::string(name(Layout::lat_long)) + ", " + size_text(whole.width, whole.height);
  }
  const std::string face = size_text(image.cubemap().size, image.cubemap().size);
  if (layout == Layout::six_files) return "one face of six, " + face;
  return std::string(name(layout == Layout::automatic ? Layout::vertical_strip : layout)) + ", faces of " + face;
}

/// Writes the image. Returns a description: one line per file, and a note about clamped values; nothing for standard
/// output, which gets the bytes.
std::string write_output(const OutputOptions& options, const EnvironmentView& image, const Control& control) {
  begin_stage("write");
  if (!is_standard_stream(options.path)) {
    const WriteReport report = write_environment(platform::path_of(options.path), image, options.write, control);
    return described(report, words_of(image, options.write.layout), options.if_clamped);
  }
  std::vector<std::byte> bytes;
  write_environment({bytes, name_of_output(options)}, image, options.write, control);
  print_result({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return "";
}

/// Throws `Error` (limit_exceeded) if that many texels exceed the memory limit in addition to the `held` of the input.
void require_memory(const CommonOptions& common, const OutputOptions& output, std::uint64_t texels,
                    std::uint64_t held = 0) {
  constexpr std::uint64_t kTexelBytes = 12;
  const std::uint64_t bytes = kTexelBytes * texels;
  const std::uint64_t limit = common.read.memory_limit_bytes;
  if (kTexelBytes * held + bytes <= limit) return;
  const std::string input =
      held > 0 ? " in addition to the " + std::to_string(kTexelBytes * held) + " of the input" : "";
  throw Error(ErrorCode::limit_exceeded, output.path + ": takes " + std::to_string(bytes) + " bytes at that size" +
                                             input + ", above the limit of " + std::to_string(limit) +
                                             "; pass a smaller --size or raise --memory-limit");
}

/// Does the work and prints its summary: on standard error if standard output gets the image.
void run_writing(const CommonOptions& common, const OutputOptions& output,
                 const std::function<std::string(const Control& control)>& work) {
  const std::string text = with_bar(common, work);
  if (!is_standard_stream(output.path)) {
    print_summary(text);
  } else if (verbosity() != Verbosity::quiet) {
    std::cerr << text << std::flush;
  }
}

std::uint64_t square(int edge) { return static_cast<std::uint64_t>(edge) * static_cast<std::uint64_t>(edge); }

// `welkin convert`.

// Fractions of the progress bar.
constexpr double kRead = 0.3;
constexpr double kResampled = 0.7;

struct ConvertOptions {
  CommonOptions common;
  std::string input;
  OutputOptions output;
  OrientationOptions orientation;
  SunChoice sun;
  bool tone_map = false;
  std::optional<double> exposure_stops;  ///< none: derived from the image
};

/// Tone maps radiance to [0, 1] if the options select that.
void tone_map(const ConvertOptions& options, Pixels& image) {
  constexpr int kEnough = 32;  // as for the previews
  if (!options.tone_map) return;
  begin_stage("tone map");
  const std::optional<double>& stops = options.exposure_stops;
  const ToneMap shown{stops ? std::exp2(*stops) : exposure_of(to_cubemap(image.view(), kEnough).view())};
  const std::span<float> rgb = image.values();
  for (std::size_t i = 0; i + 2 < rgb.size(); i += 3) {
    const glm::vec3 light = shown(glm::vec3(rgb[i], rgb[i + 1], rgb[i + 2]));
    for (int c = 0; c < 3; ++c) rgb[i + static_cast<std::size_t>(c)] = light[c];
  }
}

/// Resamples or moves texels only if an option requires it.
std::string write_converted(const ConvertOptions& options, Pixels& source, const Control& control) {
  const SourceShape from = shape_of(source.view());
  const bool cubemap = wants_cubemap(options.output, from.cubemap);
  const glm::dmat3 rotation = image_rotation(options.orientation, from.cubemap, cubemap);
  const int asked = options.output.size;
  const int size = asked > 0 ? asked : from.cubemap ? from.columns : (from.columns + 3) / 4;  // of a cubemap
  const int width = asked > 0 ? asked : from.cubemap ? 4 * from.columns : from.columns;       // of a lat-long
  const int height = asked > 0 || from.cubemap ? lat_long_height(width) : from.rows;
  const bool same_shape =
      cubemap == from.cubemap && (cubemap ? size == from.columns : width == from.columns && height == from.rows);
  const Control last = part_of(control, kResampled, 1.0);
  if (same_shape && rotation == glm::dmat3(1.0)) {
    tone_map(options, source);
    return write_output(options.output, source.view(), last);
  }
  const std::uint64_t texels =
      cubemap ? 6 * square(size) : static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  require_memory(options.common, options.output, texels, from.texels());
  const Control middle = part_of(control, kRead, kResampled);
  begin_stage("resample");
  Pixels result;
  if (cubemap) {
    result.image = to_cubemap(source.view(), size, rotation, ResampleFilter::area, middle);
  } else {
    result.image = to_lat_long(source.view(), width, height, rotation, ResampleFilter::bilinear, middle);
  }
  tone_map(options, result);
  return write_output(options.output, result.view(), last);
}

/// Throws `Error` (file_access) if OUT is also read: any of six files or of those in a folder.
void check_input_is_kept(const ConvertOptions& options, const EnvironmentInfo& input) {
  if (is_standard_stream(options.input) || is_standard_stream(options.output.path)) return;
  std::vector<std::filesystem::path> read{platform::path_of(options.input)};
  if (input.layout == Layout::six_files) read.assign(input.faces.begin(), input.faces.end());
  for (const auto& written :
       files::files_to_write(platform::path_of(options.output.path), options.output.write.layout)) {
    for (const auto& file : read) require_kept(file, written, "the conversion", "give OUT another name");
  }
}

std::string convert(const ConvertOptions& options, const Control& control) {
  const FileInput input = input_of(options.input, options.common.read);
  const EnvironmentInfo info = inspect_environment(input, options.common.read);
  check_output(options.output, wants_cubemap(options.output, info.layout != Layout::lat_long));
  check_input_is_kept(options, info);
  begin_stage("read");
  Pixels source{read_environment(input, options.common.read, part_of(control, 0.0, kRead))};
  std::optional<Sun> sun;
  if (options.sun.take_out) {
    replace_infinities(source);
    sun = extract_sun(source, options.sun.options);
    if (sun) sun->direction = light_rotation(options.orientation, source.is_cubemap()) * sun->direction;
  }
  return write_converted(options, source, control) +
         (options.sun.take_out ? sun_text(sun, convention(options.orientation.to).from_welkin[1].z > 0.5) : "");
}

void run_convert(ConvertOptions& options) {
  const std::string out = name_of_output(options.output);
  const bool png = same_word(platform::utf8(platform::path_of(out).extension()), ".png");
  if (options.tone_map && !png) {
    throw Error(ErrorCode::invalid_argument,
                out + ": --tone-map is for .png; leave it out for formats that hold radiance");
  }
  if (png && !options.tone_map) options.output.if_clamped = "; --tone-map makes an image for viewing";
  run_writing(options.common, options.output, [&](const Control& control) { return convert(options, control); });
}

// `welkin testmap` and `welkin sample`.

constexpr int kFaceSize = 512;
constexpr int kLatLongWidth = 2048;

struct DrawingOptions {
  CommonOptions common;
  OutputOptions output;
  OrientationOptions orientation;  ///< of the test map; only `to` is used
};

constexpr double kDrawn = 0.9;  // fraction of the progress bar; writing has the rest

/// Returns an engine's axes. The surroundings are the same for every engine, but their directions have other names and
/// other positions in a cubemap.
TestMapAxes axes_of(Engine engine, bool cubemap) {
  TestMapAxes axes{convention(engine).from_welkin};
  if (cubemap) axes.places = faces_of(engine);
  return axes;
}

/// Draws and writes an image. `draw` returns an image of the given size: a cubemap's edge or a lat-long's width.
template <class Draw>
std::string draw_and_write(const CommonOptions& common, const OutputOptions& output, bool cubemap, int size,
                           const Control& control, const Draw& draw) {
  check_output(output, cubemap);
  begin_stage("draw");
  require_memory(common, output, cubemap ? 6 * square(size) : square(size) / 2);
  return write_output(output, draw(part_of(control, 0.0, kDrawn)).view(), part_of(control, kDrawn, 1.0));
}

std::string draw_testmap(const DrawingOptions& options, const Control& control) {
  const OutputOptions& output = options.output;
  const bool cubemap = wants_cubemap(output, false);
  const int size = output.size > 0 ? output.size : cubemap ? kFaceSize : kLatLongWidth;
  const TestMapAxes axes = axes_of(options.orientation.to, cubemap);
  if (cubemap) {
    return draw_and_write(options.common, output, true, size, control,
                          [&](const Control& drawing) { return test_map_cubemap(size, drawing, axes); });
  }
  return draw_and_write(options.common, output, false, size, control, [&](const Control& drawing) {
    return test_map_lat_long(size, lat_long_height(size), drawing, axes);
  });
}

/// Returns the name. Throws `Error` (file_access) if a file of that name exists.
std::string new_file(const std::string& name) {
  std::error_code unknown;
  if (!std::filesystem::exists(std::filesystem::symlink_status(name, unknown))) return name;
  throw Error(ErrorCode::file_access, name + ": is there already; '-o " + name + "' replaces it, or name another file");
}

std::string draw_sample(const DrawingOptions& options, const Control& control) {
  constexpr int kWidth = 1024;
  const int width = options.output.size > 0 ? options.output.size : kWidth;
  return draw_and_write(options.common, options.output, false, width, control,
                        [&](const Control& drawing) { return sample_room(width, lat_long_height(width), drawing); });
}

}  // namespace

Command convert_command() {
  const auto options = std::make_shared<ConvertOptions>();
  Command command{"convert", "Write an environment in another format, layout or size",
                  embedded_text("help/convert.txt")};
  Options& table = command.options;
  add_option(table, "IN", &options->input, "", input_text(false), {.required = true});
  add_option(table, "OUT", &options->output.path, "",
             "The file to write: .exr, .hdr, .pfm or .png; - for standard output", {.required = true});
  add_output_options(table, options->output);
  option(table, "--size").text += "; default as large as IN";
  add_option(table, "--tone-map", &options->tone_map, "",
             "Make a .png to look at, as the previews of 'welkin bake' are; without it a .png holds the values from 0 "
             "to 1 and cuts off the rest");
  add_option(table, "--exposure", &options->exposure_stops, "EV",
             "Exposure of --tone-map in stops, radiance times 2^EV; default: as 'welkin bake' exposes "
             "its previews",
             {.bounds = number_between(-60.0, 60.0), .needs = {"--tone-map"}});
  in_group(table, "Input and output");
  add_orientation_options(table, options->orientation);
  add_sun_options(table, options->sun);
  add_read_options(table, options->common, "", "--in-layout");
  add_threads_option(table, options->common);
  command.everyday = {"IN",    "OUT",      "--layout",      "--size",      "--type",    "--tone-map", "--for",
                      "--yaw", "--mirror", "--extract-sun", "--in-layout", "--threads", "--quiet"};
  command.run = [options](const Given& /*given*/) { run_convert(*options); };
  return command;
}

Command testmap_command() {
  const auto options = std::make_shared<DrawingOptions>();
  Command command{"testmap", "Make an environment that shows its orientation", embedded_text("help/testmap.txt")};
  Options& table = command.options;
  add_option(table, "-o,--output", &options->output.path, "OUT",
             "The file to write: .exr, .hdr, .pfm or .png, - for standard output; default testmap.exr, here, unless a "
             "file of that name is there");
  add_output_options(table, options->output);
  option(table, "--size").text += "; default 512, or 2048 for a lat-long";
  add_engine_option(table, options->orientation);
  option(table, "--for").text =
      "Whose axes are written on the map; default welkin; a cubemap's faces are where that engine looks for them";
  in_group(table, "Output");
  add_memory_limit_option(table, options->common);
  add_threads_option(table, options->common);
  command.run = [options](const Given& given) {
    if (!given("--output")) options->output.path = new_file("testmap.exr");
    run_writing(options->common, options->output,
                [&](const Control& control) { return draw_testmap(*options, control); });
  };
  return command;
}

Command sample_command() {
  const auto options = std::make_shared<DrawingOptions>();
  Command command{"sample", "Make an environment to try the other commands with", embedded_text("help/sample.txt")};
  Options& table = command.options;
  add_option(table, "-o,--output", &options->output.path, "OUT",
             "The file to write: .exr, .hdr, .pfm or .png; - for standard output, as .exr", {.required = true});
  add_option(table, "--size", &options->output.size, "N", "Width in texels, twice the height; default 1024",
             {.bounds = whole_between(1, kLargestWidth)});
  in_group(table, "Output");
  add_memory_limit_option(table, options->common);
  add_threads_option(table, options->common);
  command.run = [options](const Given& /*given*/) {
    run_writing(options->common, options->output,
                [&](const Control& control) { return draw_sample(*options, control); });
  };
  return command;
}

}  // namespace welkin::tool
