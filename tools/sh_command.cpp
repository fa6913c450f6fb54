// `welkin sh`: an environment's spherical harmonics.
#include "tools/sh_command.h"

#include <cstdint>
#include <memory>
#include <utility>

#include "embedded_texts.h"
#include "platform/text.h"
#include "tools/commands.h"
#include "tools/terminal.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/result_cache.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {
namespace {

constexpr int kLargestTargetSize = 16384;

void add_projection_options(Options& table, ShOptions& options) {
  add_bands_option(table, options);
  table.push_back(choice<Quadrature>(
      "--quadrature", options.projection.quadrature, {{"exact", Quadrature::exact}, {"midpoint", Quadrature::midpoint}},
      "exact (default) integrates over each texel's area; midpoint takes its centre, as Babylon.js"));
  add_option(table, "--target-size", &options.target_size, "N",
             "Reduce the environment to cubemap faces of N x N texels first (a lat-long to 4N x 2N): less exact, for "
             "comparison with engines that do so; 0, the default: no",
             {.bounds = whole_between(0, kLargestTargetSize)});
}

void add_sh_options(Options& table, ShOptions& options) {
  constexpr const char* kInput = "INPUT";
  add_input_options(table, options.input, options.sky);
  add_format_options(table, options);
  in_group(table, "Input and output");
  add_orientation_options(table, options.orientation);
  add_projection_options(table, options);
  add_pixel_options(table, options.projection.pixels, options.clamp);
  add_window_options(table, options);
  in_group(table, "Harmonics");
  add_sun_options(table, options.sun, {"--gamma"});  // the search needs radiance, before pixels are decoded
  add_option(table, "--irradiance-error", &options.irradiance_error, "",
             "Compare the irradiance of 1 to N bands with direct cosine integration (takes seconds)",
             {.group = "Harmonics"});
  add_read_options(table, options.common, kInput);
  add_threads_option(table, options.common);
  add_cache_option(table, options.common);
}

constexpr double kComputed = 0.8;  // of the progress, if the sky is computed first

// Returns the value with which `project` would replace an infinity.
float infinity_of(const PixelPolicy& pixels) { return pixels.clamp ? pixels.clamp->maximum : kForInfinity; }

// Extracts the sun, if selected, and projects the remaining light; measures the irradiance's error in between.
void project_pixels(Pixels& pixels, const ShOptions& options, const Control& control, ShReport& report) {
  std::uint64_t infinities = 0;
  if (options.sun.take_out) {
    // A sun that overflowed would be missed.
    if (options.projection.pixels.infinity == NonFinitePolicy::replace) {
      infinities = replace_infinities(pixels, infinity_of(options.projection.pixels));
    }
    report.sun = extract_sun(pixels, options.sun.options);
  }
  begin_stage("project");
  with_cache(options.common, report.source.notes, [&](ResultCache* cache) {
    report.projection = cache != nullptr ? cache->project(pixels.view(), options.projection, {}, control)
                                         : project(pixels.view(), options.projection, control);
  });
  report.projection.diagnostics.infinities_replaced += infinities;
  if (options.irradiance_error) {
    begin_stage("irradiance");
    constexpr int kNormals = 500;
    const SphericalHarmonics windowed =
        apply_window(report.projection.radiance, options.window, options.window_width).radiance;
    report.irradiance_errors = irradiance_errors(pixels.view(), windowed, kNormals, options.projection.pixels, control);
  }
}

// Throws if the environment, held twice while it is copied, would exceed the memory limit.
void require_memory_twice(const EnvironmentInfo& info, const ReadOptions& read) {
  const bool is_cross = info.layout == Layout::horizontal_cross || info.layout == Layout::vertical_cross;
  const std::uint64_t texels = static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height);
  const std::uint64_t bytes = 2 * 12 * (is_cross ? texels / 2 : texels);
  if (bytes <= read.memory_limit_bytes) return;
  throw Error(ErrorCode::limit_exceeded,
              platform::utf8(info.path) + ": " + std::to_string(info.width) + " x " + std::to_string(info.height) +
                  " texels, held twice for --extract-sun and --irradiance-error, take " + std::to_string(bytes) +
                  " bytes, above the limit of " + std::to_string(read.memory_limit_bytes) +
                  "; raise --memory-limit, leave those options out, or reduce the image");
}

bool is_cubemap(const EnvironmentInfo& info) { return info.layout != Layout::lat_long; }

// Adds source, projection and sun to the report. Returns whether the source was a cubemap.
bool project_source(const ShOptions& options, const Control& control, ShReport& report) {
  const bool in_memory = options.sun.take_out || options.irradiance_error;
  if (!options.input) {
    begin_stage("sky");
    ComputedImage sky = built_in_sky(part_of(control, 0.0, kComputed));
    Pixels pixels{std::move(sky.image)};
    report.source = sky.source;
    report.sky = sky.sky;
    project_pixels(pixels, options, part_of(control, kComputed, 1.0), report);
    return false;
  }
  const ReadOptions& read = options.common.read;
  const FileInput input = input_of(*options.input, read);
  if (in_memory) {
    require_memory_twice(inspect_environment(input, read), read);
    begin_stage("read");
    Environment environment = read_environment(input, read);
    report.source = source_of(*options.input, environment.info);
    Pixels pixels{std::move(environment)};
    project_pixels(pixels, options, control, report);
    return pixels.is_cubemap();
  }
  begin_stage("read and project");
  const EnvironmentInfo info = inspect_environment(input, read);
  report.source = source_of(*options.input, info);
  with_cache(options.common, report.source.notes, [&](ResultCache* cache) {
    const bool keeps = cache != nullptr && !is_stream(*options.input);  // the cache identifies files by their paths
    report.projection = keeps
                            ? cache->project_file(platform::path_of(*options.input), read, options.projection, control)
                            : project_file(input, read, options.projection, control);
  });
  return is_cubemap(info);
}

/// Reads, projects, rotates and windows. Throws the library's errors.
ShReport measure_sh(const ShOptions& options, const Control& control) {
  ShReport report;
  report.options = options.projection;
  report.sun_wanted = options.sun.take_out;
  const bool is_of_cubemap = project_source(options, control, report);
  complete(report, options, is_of_cubemap);
  return report;
}

void run(ShOptions options) {
  options.clamp.apply(options.projection.pixels);
  if (options.target_size > 0) options.projection.target_size = options.target_size;
  print_result(
      with_bar(options.common, [&](const Control& control) { return options.format(measure_sh(options, control)); }));
}

}  // namespace

void add_format_options(Options& table, ShOptions& options) {
  constexpr const char* kFormat = "--format";
  table.push_back(choice<ShFormat>(kFormat, options.format,
                                   {{"table", sh_table},
                                    {"json", sh_json},
                                    {"text", sh_text},
                                    {"c", sh_c_header},
                                    {"glsl", sh_glsl},
                                    {"cs", sh_c_sharp}},
                                   "A readable table, JSON, a line per coefficient, a C header, a GLSL function in "
                                   "the axes of --for, or C# for --for unity; default table"));
  add_option(table, "--json", OnFlag([&options] { options.format = sh_json; }), "", "The same as --format json",
             {.excludes = {kFormat}});
}

void add_bands_option(Options& table, ShOptions& options) {
  add_option(table, "--bands", &options.projection.bands, "N", "Bands, 1 (ambient colour only) to 16; default 3",
             {.bounds = whole_between(1, kMaximumBands)});
}

void add_window_options(Options& table, ShOptions& options) {
  table.push_back(choice<Window>("--window", options.window,
                                 by_name({Window::none, Window::hanning, Window::lanczos, Window::min_laplacian}),
                                 "Damp the higher bands against ringing; default none; min-laplacian damps only as "
                                 "much as keeps irradiance from going below 0"));
  add_option(table, "--window-width", &options.window_width, "W",
             "Width of a hanning or lanczos window in bands; default: the number of bands",
             {.bounds = finite_and_positive()});
}

const char* quadrature_name(const ShReport& report) noexcept {
  if (report.sky && report.sky->quadrature) return name(report.sky->quadrature->quadrature);
  return report.options.quadrature == Quadrature::exact ? "exact" : "midpoint";
}

void complete(ShReport& report, const ShOptions& options, bool is_of_cubemap) {
  report.window = options.window;
  report.engine = options.orientation.to;
  report.axes = axes_text(options.orientation);
  report.threads = thread_count(options.common);
  SphericalHarmonics& radiance = report.projection.radiance;
  if (const glm::dmat3 matrix = light_rotation(options.orientation, is_of_cubemap); matrix != glm::dmat3(1.0)) {
    radiance = rotate(radiance, matrix);
    if (report.sun) report.sun->direction = matrix * report.sun->direction;
  }
  report.dominant = dominant_light(radiance);  // of the light itself: a window damps the bands that determine it
  report.windowed = apply_window(radiance, options.window, options.window_width);
  radiance = report.windowed.radiance;
  report.irradiance = irradiance_from_radiance(radiance);
  report.polynomial = babylon_polynomial(radiance);
  if (has_engine_light(report.engine)) report.engine_light = engine_light_unrotated(radiance, report.engine);
}

Command sh_command() {
  const auto options = std::make_shared<ShOptions>();
  Command command{"sh", "Project an environment to spherical harmonics", embedded_text("help/sh.txt")};
  add_sh_options(command.options, *options);
  command.everyday = {"INPUT",         "--sky",    "--json",  "--format",  "--for",   "--yaw",  "--bands",
                      "--extract-sun", "--window", "--clamp", "--threads", "--cache", "--quiet"};
  command.run = [options, name = command.name](const Given& /*given*/) {
    require_input(name, options->input, options->sky);
    run(*options);
  };
  return command;
}

}  // namespace welkin::tool
