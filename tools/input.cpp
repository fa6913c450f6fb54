#include "tools/input.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <glm/matrix.hpp>
#include <system_error>

#include "platform/text.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"
#include "welkin/result_cache.h"

namespace welkin::tool {
namespace {

constexpr int kMaximumThreads = 1024;
constexpr int kMaximumLevel = 30;
constexpr const char* kStandardInput = "standard input";

void add_clamp_options(Options& table, ClampChoice& choice) {
  const auto set_maximum = [&choice](float maximum) {
    choice.clamp.maximum = maximum;
    choice.clamps = true;
  };
  const auto preserve_colour = [&choice] {
    choice.clamp.preserve_colour = true;
    choice.clamps = true;
  };
  add_option(table, "--clamp", On<float>(set_maximum), "V",
             "Clamp radiance to 0 to V; default no limit. The removed light is reported",
             {.bounds = finite_and_positive()});
  add_option(table, "--preserve-clamped", OnFlag(preserve_colour), "",
             "Clamp by scaling red, green and blue together; without --clamp at 4096, Babylon.js's limit");
}

}  // namespace

void add_json_option(Options& table, CommonOptions& options) {
  add_option(table, "--json", &options.json, "", "JSON on standard output instead of a table");
}

void add_threads_option(Options& table, CommonOptions& options) {
  add_option(table, "--threads", &options.threads, "N",
             "Number of threads; default 0: all that this process may use. Results do not depend on it",
             {.bounds = whole_between(0, kMaximumThreads)});
  in_group(table, kRunningGroup);
}

void add_memory_limit_option(Options& table, CommonOptions& options) {
  add_option(table, "--memory-limit", ByteCount{&options.read.memory_limit_bytes}, "SIZE",
             "Memory limit for pixels, such as 512MiB or 2GB (default 8GiB), checked before the work "
             "begins",
             {.group = kRunningGroup});
}

std::string input_text(bool six) {
  return std::string(
             "An OpenEXR, Radiance .hdr, PFM, PNG, JPEG (with a gain map), KTX2, DDS or Babylon.js .env file; ") +
         (six ? "of six files, one of them or their folder; " : "") + "- for standard input";
}

void add_input_options(Options& table, std::optional<std::string>& input, bool& sky) {
  constexpr const char* kInput = "INPUT";
  add_option(table, kInput, &input, "", input_text(true));
  add_option(table, "--sky", &sky, "", "Use the built-in computed sky instead of a file", {.excludes = {kInput}});
}

bool is_stream(const std::string& named) {
  std::error_code unknown;
  return is_standard_stream(named) || std::filesystem::is_fifo(platform::path_of(named), unknown);
}

std::string default_output_name(const std::optional<std::string>& input) {
  if (!input) return "sky";
  std::error_code unknown;
  const std::filesystem::path path = std::filesystem::absolute(platform::path_of(*input), unknown).lexically_normal();
  const std::filesystem::path last = path.has_filename() ? path : path.parent_path();
  const bool is_folder = std::filesystem::is_directory(last, unknown);
  const std::filesystem::path name = is_folder ? last.filename() : last.stem();
  if (is_stream(*input) || name.empty()) {
    throw Error(ErrorCode::invalid_argument, printable(*input) + ": gives the result no name; pass -o with a name");
  }
  return platform::utf8(name);
}

void require_own_folder(const std::filesystem::path& folder, const std::string& table, const std::string& command) {
  std::error_code unknown;
  if (!std::filesystem::exists(std::filesystem::symlink_status(folder, unknown))) return;
  const bool is_folder = std::filesystem::is_directory(folder, unknown);
  if (is_folder && std::filesystem::is_empty(folder, unknown) && !unknown) return;
  for (const std::string& list : {table, "unfinished_" + table}) {
    if (is_folder && begins_with(folder / list, "\"welkin\":")) return;
  }
  const std::string name = platform::utf8(folder);
  throw Error(ErrorCode::file_access, name + ": is there and was not written by 'welkin " + command +
                                          "'; pass another folder to -o" +
                                          (is_folder ? ", or this one, where other files are kept" : ""));
}

FileInput input_of(const std::string& named, const ReadOptions& read) {
  if (!is_stream(named)) return platform::path_of(named);
  // A command has only one input.
  static const std::vector<std::byte> bytes =
      read_to_end(is_standard_stream(named) ? std::nullopt : std::optional(named), read.memory_limit_bytes);
  return {bytes, is_standard_stream(named) ? kStandardInput : named};
}

void require_input(const std::string& command, const std::optional<std::string>& input, bool sky) {
  if (sky || (input && !input->empty())) return;
  const std::string found = input ? "INPUT is empty; is a shell variable not set?" : "INPUT is missing";
  throw Error(ErrorCode::invalid_argument, command + ": " + found + "\nName a file ('welkin " + command +
                                               " city.hdr'), or use the built-in sky: --sky.");
}

void add_cache_option(Options& table, CommonOptions& options) {
  add_option(table, "--cache", On<std::string>([&options](const std::string& folder) {
               if (folder.empty()) throw BadValue{"--cache", "is empty; is a shell variable not set?"};
               options.cache = folder;
             }),
             "DIR", "A folder in which results are cached by the contents of their inputs, created if necessary",
             {.group = kRunningGroup});
}

std::vector<std::pair<std::string, Layout>> layout_choices() {
  return by_name({Layout::automatic, Layout::lat_long, Layout::vertical_strip, Layout::horizontal_strip,
                  Layout::horizontal_cross, Layout::vertical_cross, Layout::six_files});
}

void add_read_options(Options& table, CommonOptions& options, const std::string& input,
                      const std::string& layout_option) {
  const std::size_t before = table.size();
  table.push_back(
      choice<Layout>(layout_option, options.read.layout, layout_choices(),
                     "Layout of the sphere in the image; default automatic, from its header, shape or name"));
  add_option(table, "--part", &options.read.part, "NAME",
             "The part of an OpenEXR file with several parts, by name or by number from 0");
  add_option(table, "--layer", &options.read.layer, "NAME",
             "The layer of an OpenEXR file with layers (env.R, env.G, ...)");
  add_option(table, "--level", &options.read.level, "N",
             "The level of a file with a mip chain, of which 0 is full size; default 0",
             {.bounds = whole_between(0, kMaximumLevel)});
  add_option(table, "--element", &options.read.element, "N",
             "Index of a cubemap or image in a KTX2, KTX or DDS array; default 0", {.bounds = whole_between(0, 65535)});
  table.push_back(
      choice<Transfer>("--transfer", options.read.transfer,
                       {{"automatic", Transfer::automatic}, {"srgb", Transfer::srgb}, {"linear", Transfer::linear}},
                       "Encoding of values in a PNG; default sRGB, or linear where the file states a gamma of 1"));
  table.push_back(choice<Primaries>(
      "--primaries", options.read.primaries, {{"rec709", Primaries::rec709}, {"as-stored", Primaries::as_stored}},
      "Treatment of colours with other primaries than Rec. 709; default rec709, which converts "
      "them"));
  add_memory_limit_option(table, options);
  in_group(table, "How the input is read");
  if (input.empty()) return;
  for (std::size_t i = before; i < table.size(); ++i) table[i].needs.push_back(input);
}

std::string with_bar(const CommonOptions& options, const std::function<std::string(const Control& control)>& work) {
  std::string text;
  run_with_threads(options.threads, [&] {
    ProgressBar bar;
    text = work(bar.control());
  });
  return text;
}

void with_cache(const CommonOptions& options, std::vector<std::string>& notes,
                const std::function<void(ResultCache* cache)>& work) {
  if (options.cache.empty()) {
    work(nullptr);
    return;
  }
  ResultCache cache({.folder = platform::path_of(options.cache), .memory_bytes = 0});
  work(&cache);
  const CacheStatistics statistics = cache.statistics();
  if (statistics.damaged > 0)
    notes.push_back("the cache: " + counted(statistics.damaged, "damaged result") + " computed again");
  if (statistics.write_failures > 0)
    notes.push_back("the cache could not keep all results: " + statistics.last_failure);
}

int thread_count(const CommonOptions& options) { return options.threads > 0 ? options.threads : available_threads(); }

void add_pixel_options(Options& table, PixelPolicy& pixels, ClampChoice& clamp) {
  add_clamp_options(table, clamp);
  add_option(table, "--gamma", &pixels.gamma, "",
             "The pixels are gamma encoded: clamp them to 0 to 1 and raise them to 2.2 first");
  table.push_back(choice<NonFinitePolicy>("--nan", pixels.nan,
                                          {{"replace", NonFinitePolicy::replace}, {"reject", NonFinitePolicy::reject}},
                                          "Replace NaN by 0 (default), or fail and name the texel"));
  table.push_back(choice<NonFinitePolicy>(
      "--infinity", pixels.infinity, {{"replace", NonFinitePolicy::replace}, {"reject", NonFinitePolicy::reject}},
      "Replace infinities by the clamp's V or 65504 (default), or fail and name the texel"));
  table.push_back(choice<NegativePolicy>(
      "--negative", pixels.negative,
      {{"keep", NegativePolicy::keep}, {"replace", NegativePolicy::replace}, {"reject", NegativePolicy::reject}},
      "Keep negative values (default), replace them by 0, or fail and name the texel"));
  in_group(table, "Pixel values");
}

Source source_of(const std::string& named, const EnvironmentInfo& info) {
  const std::string path = is_standard_stream(named) ? kStandardInput : named;
  std::string detail = info.channels.empty() ? "" : std::string(name(info.channels.front().type)) + ", ";
  if (info.compression != "none") detail += info.compression + ", ";
  return {path,      name(info.layout), info.width, info.height, info.format_description(), detail + info.layout_reason,
          info.notes};
}

std::span<float> values_of(const Environment& environment) {
  const auto face = static_cast<std::size_t>(environment.face_size());
  const std::size_t texels =
      face > 0 ? 6 * face * face
               : static_cast<std::size_t>(environment.info.width) * static_cast<std::size_t>(environment.info.height);
  return {environment.pixels.get(), 3 * texels};
}

EnvironmentView Pixels::view() const {
  return std::visit([](const auto& one) { return EnvironmentView(one.view()); }, image);
}

std::span<float> Pixels::values() {
  if (auto* const lat_long = std::get_if<LatLongImage>(&image)) return lat_long->pixels;
  if (auto* const cubemap = std::get_if<Cubemap>(&image)) return cubemap->pixels();
  return values_of(std::get<Environment>(image));
}

std::uint64_t replace_infinities(Pixels& pixels, float largest) {
  std::uint64_t replaced = 0;
  for (float& value : pixels.values()) {
    if (!std::isinf(value)) continue;
    value = value > 0.0F ? largest : 0.0F;
    ++replaced;
  }
  return replaced;
}

std::optional<Sun> extract_sun(Pixels& pixels, const SunOptions& options) {
  if (const auto* const file = std::get_if<Environment>(&pixels.image)) {
    const std::span<const float> values = values_of(*file);
    if (pixels.is_cubemap()) {
      pixels.image = Cubemap(file->face_size(), values);
    } else {
      pixels.image = LatLongImage{file->info.width, file->info.height, {values.begin(), values.end()}};
    }
  }
  if (auto* const cubemap = std::get_if<Cubemap>(&pixels.image)) return welkin::extract_sun(*cubemap, options);
  return welkin::extract_sun(std::get<LatLongImage>(pixels.image), options);
}

void add_sun_options(Options& table, SunChoice& choice, const std::vector<std::string>& excludes) {
  constexpr const char* kTakeOut = "--extract-sun";
  add_option(table, kTakeOut, &choice.take_out, "",
             "Extract the sun from the environment and report it as a directional light", {.excludes = excludes});
  const auto add = [&](const char* name, double& value, double low, double high, const char* type, const char* text) {
    add_option(table, name, &value, type, text, {.bounds = number_between(low, high), .needs = {kTakeOut}});
  };
  add("--sun-threshold", choice.options.relative_threshold, 1e-9, 1.0, "SHARE",
      "Luminance, relative to the brightest texel, from which texels belong to the sun; default 0.02");
  add("--sun-radius", choice.options.maximum_radius_degrees, 0.0, 90.0, "DEGREES",
      "Maximum radius of a sun; default 3");
  add("--sun-contrast", choice.options.minimum_contrast, 1.0, 1e300, "TIMES",
      "Minimum luminance of a sun relative to the mean; default 20");
  add("--sun-share", choice.options.minimum_share, 0.0, 1.0, "SHARE",
      "Minimum fraction of the light in a sun; default 0.01");
  in_group(table, "The sun as a light of its own");
}

std::string sun_text(const std::optional<Sun>& sun, bool z_is_up) {
  if (!sun) return "Sun: none found; nothing was extracted\n";
  const bool was_in_pixels = sun->texels > 0;
  return std::string(was_in_pixels ? "Sun, extracted" : "Sun, not in the pixels") + "\n  towards     " +
         direction_text(sun->direction, z_is_up) + "\n  irradiance  " + significant(sun->irradiance) +
         "  on a surface facing it\n  radiance    " + significant(sun->radiance) + "  its mean\n  extent      " +
         significant(sun->solid_angle) + " sr" +
         (was_in_pixels ? " (" + counted(sun->texels, "texel") + " changed)" : "") + ", a disc of " +
         significant(sun->angular_radius_degrees, 3) + " degrees radius\n";
}

namespace {

std::vector<std::pair<std::string, Engine>> engine_words() {
  std::vector<std::pair<std::string, Engine>> words;
  for (const Convention& each : conventions()) words.emplace_back(each.name, each.engine);
  return words;
}

// Rounds entries that are whole but for rounding: a quaternion of 90 degrees is then exact.
glm::dmat3 tidied(glm::dmat3 matrix) {
  constexpr double kRounding = 1e-15;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const double whole = std::round(matrix[column][row]);
      if (std::abs(matrix[column][row] - whole) < kRounding) matrix[column][row] = whole;
    }
  }
  return matrix;
}

glm::dmat3 faces_matrix(const Convention& engine) {
  if (!engine.faces_from_engine) {
    throw Error(ErrorCode::invalid_argument,
                std::string(engine.title) + " has no cube faces of its own; use a lat-long, or another convention");
  }
  return *engine.faces_from_engine;
}

// Returns the matrix from Welkin's axes to an image in the engine's convention. A lat-long is the same image for all
// engines: they differ in which of their axes its centre is, which is from_welkin. Cube faces are named after the
// engine's axes.
glm::dmat3 into_image(Engine engine, bool cubemap) {
  const Convention& of = convention(engine);
  return cubemap ? faces_matrix(of) * of.from_welkin : glm::dmat3(1.0);
}

// Returns the rotation between the file's and the result's directions, in Welkin's axes.
glm::dmat3 turn_in_welkin(const OrientationOptions& options, bool source_is_cubemap) {
  // The matrix is orthogonal: its transpose is its inverse.
  glm::dmat3 rotation = glm::transpose(into_image(options.from, source_is_cubemap));
  if (options.mirror) rotation = glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1) * rotation;
  return rotation_about_y(options.yaw_degrees) * glm::mat3_cast(options.rotation) * rotation;
}

void set_rotation(OrientationOptions& options, const std::vector<double>& values) {
  const glm::dquat quaternion(values[3], values[0], values[1], values[2]);
  const double length = glm::length(quaternion);
  if (!std::isfinite(length) || length == 0.0) {
    throw BadValue{"--rotation", "is not a rotation; pass a quaternion x,y,z,w of finite length above 0"};
  }
  options.rotation = quaternion / length;
}

}  // namespace

void add_engine_option(Options& table, OrientationOptions& options) {
  table.push_back(
      choice<Engine>("--for", options.to, engine_words(),
                     "Whose axes the result is in, so that the surroundings look the same there; default welkin"));
}

void add_orientation_options(Options& table, OrientationOptions& options) {
  table.push_back(choice<Engine>(
      "--from", options.from, engine_words(),
      "Whose axes the file's cube faces are named after; default welkin. (A lat-long is the same image for all)"));
  add_engine_option(table, options);
  add_option(table, "--yaw", &options.yaw_degrees, "DEGREES",
             "Rotate the environment about the vertical by DEGREES, counter-clockwise from above; default 0; 90 moves "
             "what was at +z to +x",
             {.bounds = number_between(-1e6, 1e6)});
  add_option(table, "--mirror", &options.mirror, "", "Mirror the environment left to right (x changes its sign)");
  const auto rotate = [&options](const std::vector<double>& values) { set_rotation(options, values); };
  add_option(table, "--rotation", On<std::vector<double>>(rotate), "X,Y,Z,W",
             "Rotate the environment by the quaternion X,Y,Z,W, before --yaw",
             {.list = List::commas_or_spaces, .count = 4});
  in_group(table, "Orientation");
}

glm::dmat3 light_rotation(const OrientationOptions& options, bool source_is_cubemap) {
  return tidied(convention(options.to).from_welkin * turn_in_welkin(options, source_is_cubemap));
}

glm::dmat3 image_rotation(const OrientationOptions& options, bool source_is_cubemap, bool result_is_cubemap) {
  return tidied(into_image(options.to, result_is_cubemap) * turn_in_welkin(options, source_is_cubemap));
}

std::string axes_text(const OrientationOptions& options) {
  const Convention& engine = convention(options.to);
  return std::string(engine.title) + "'s: " + engine.axes;
}

glm::dmat3 faces_of(Engine engine) {
  OrientationOptions options;
  options.to = engine;
  return image_rotation(options, false, true);
}

Cubemap rotate(const Cubemap& chain, const glm::dmat3& symmetry, const Control& control) {
  if (chain.levels() == 0) return {};
  const Control quiet{control.stop, {}};
  Cubemap result(chain.size(), chain.levels());
  for (int level = 0; level < chain.levels(); ++level) {
    const Cubemap image = to_cubemap(chain.view(level), chain.level_size(level), symmetry, ResampleFilter::area, quiet);
    std::ranges::copy(image.pixels(), result.face(level, 0));
  }
  return result;
}

}  // namespace welkin::tool
