#include "tools/sh_options.h"

#include "tools/cache_option.h"

namespace welkin::tool {

CLI::Option* add_format_options(CLI::App& command, ShOptions& options) {
  CLI::Option* format = add_choice<ShFormat>(
      command, "--format", options.format,
      {{"table", ShFormat::table}, {"json", ShFormat::json}, {"text", ShFormat::text}, {"c", ShFormat::c_header}},
      "A table for a person (default), JSON, a line a coefficient, a C header");
  command
      .add_flag_callback(
          "--json", [&options] { options.format = ShFormat::json; }, "The same as --format json")
      ->excludes(format);
  return format;
}

void add_bands_option(CLI::App& command, ShOptions& options) {
  command.add_option("--bands", options.projection.bands, "Bands, 1 (ambient colour only) to 16; default 3")
      ->check(CLI::Range(1, kMaximumBands).description(""))
      ->type_name("N");
}

void add_window_options(CLI::App& command, ShOptions& options) {
  add_choice<Window>(command, "--window", options.window,
                     {{name(Window::none), Window::none},
                      {name(Window::hanning), Window::hanning},
                      {name(Window::lanczos), Window::lanczos},
                      {name(Window::least), Window::least}},
                     "Damp the higher bands against ringing; least: no more than keeps irradiance from going below 0");
  command
      .add_option("--window-width", options.window_width,
                  "Width of a hanning or lanczos window in bands; default: the number of bands")
      ->check(finite_and_positive())
      ->type_name("W");
}

namespace {

constexpr int kLargestTargetSize = 16384;

void add_projection_options(CLI::App& command, ShOptions& options) {
  add_bands_option(command, options);
  add_choice<Quadrature>(command, "--quadrature", options.projection.quadrature,
                         {{"exact", Quadrature::exact}, {"midpoint", Quadrature::midpoint}},
                         "exact (default) integrates over each texel's area; midpoint takes its centre, as Babylon.js");
  command
      .add_option("--target-size", options.projection.target_size,
                  "Reduce the environment to cubemap faces of N x N texels first (a lat-long to 4N x 2N): less exact, "
                  "for comparison with engines that do so; 0, the default: no")
      ->check(CLI::Range(0, kLargestTargetSize).description(""))
      ->type_name("N");
}

void add_light_options(CLI::App& command, ShOptions& options) {
  add_window_options(command, options);
  // The sun is looked for in radiance, before pixels are decoded.
  add_sun_options(command, options.sun)->excludes(command.get_option("--gamma"));
  command.add_flag("--irradiance-error", options.irradiance_error,
                   "Compare the irradiance of 1 to N bands with direct cosine integration (takes seconds)");
}

}  // namespace

void add_sh_options(CLI::App& command, ShOptions& options) {
  CLI::Option* input =
      command
          .add_option("INPUT", options.input,
                      "An OpenEXR, Radiance .hdr, PFM or PNG file, or one of six (or their directory); without it, a "
                      "built-in sky")
          ->type_name("");
  add_format_options(command, options);
  add_turn_options(command, options.turn);
  add_projection_options(command, options);
  add_pixel_options(command, options.projection, options.clamp);
  add_light_options(command, options);
  add_read_options(command, options.common, input);
  add_threads_option(command, options.common);
  add_cache_option(command, options.common);
}

}  // namespace welkin::tool
