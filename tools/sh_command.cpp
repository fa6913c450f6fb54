#include "tools/sh_command.h"

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "tools/help_text.h"
#include "tools/options.h"
#include "tools/output.h"
#include "tools/progress_bar.h"
#include "tools/sh_report.h"
#include "welkin/analytic_sky.h"
#include "welkin/control.h"
#include "welkin/environment_file.h"

namespace welkin::tool {
namespace {

constexpr int kLargestTargetSize = 16384;

struct ShOptions {
  CommonOptions common;
  std::optional<std::string> input;  ///< none: the built-in sky
  ProjectionOptions projection;
  RadianceClamp clamp;
  bool clamps = false;
};

void add_projection_options(CLI::App& command, ShOptions& options) {
  command.add_option("--bands", options.projection.bands, "Bands, 1 (ambient colour only) to 16; default 3")
      ->check(CLI::Range(1, kMaximumBands).description(""))
      ->type_name("N");
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

void add_pixel_options(CLI::App& command, ShOptions& options) {
  const CLI::Validator positive(
      [](const std::string& text) {
        float value = 0.0F;
        const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0.0F;
        return good ? std::string() : text + " is not a finite number above 0";
      },
      "");
  command
      .add_option_function<float>(
          "--clamp",
          [&options](float maximum) {
            options.clamp.maximum = maximum;
            options.clamps = true;
          },
          "Cut radiance off above V; off by default. What it takes away is reported")
      ->check(positive)
      ->type_name("V");
  command.add_flag_callback(
      "--preserve-clamped",
      [&options] {
        options.clamp.preserve_colour = true;
        options.clamps = true;
      },
      "Clamp by scaling red, green and blue together; without --clamp at 4096, Babylon.js's limit");
  command.add_flag("--gamma", options.projection.gamma,
                   "The pixels are gamma encoded: clamp them to 0 to 1 and raise them to 2.2 first");
  add_choice<NonFinitePolicy>(command, "--nan", options.projection.nan,
                              {{"replace", NonFinitePolicy::replace}, {"reject", NonFinitePolicy::reject}},
                              "NaN becomes 0 (default), or ends the command and is named");
  add_choice<NonFinitePolicy>(command, "--infinity", options.projection.infinity,
                              {{"replace", NonFinitePolicy::replace}, {"reject", NonFinitePolicy::reject}},
                              "Infinity becomes the clamp's V or 65504 (default), or ends the command and is named");
  add_choice<NegativePolicy>(
      command, "--negative", options.projection.negative,
      {{"keep", NegativePolicy::keep}, {"replace", NegativePolicy::replace}, {"reject", NegativePolicy::reject}},
      "Negative values are taken as they are (default), become 0, or end the command and are named");
}

std::string file_detail(const EnvironmentInfo& info) {
  std::string detail = info.channels.empty() ? "" : info.channels.front().type + ", ";
  if (info.compression != "none") detail += info.compression + ", ";
  return detail + info.layout_reason;
}

ShReport project_input(const std::string& path, const ShOptions& options, const Control& control) {
  const EnvironmentInfo info = inspect_environment(path, options.common.read);
  Source source{path, name(info.layout), info.width, info.height, info.format, file_detail(info)};
  Projection projection = project_file(path, options.common.read, options.projection, control);
  return {std::move(source), options.projection, std::move(projection), SphericalHarmonics(), {}, 1};
}

ShReport project_built_in_sky(const ShOptions& options, const Control& control) {
  const LatLongImage sky = analytic_sky();
  Source source{"built-in sky", name(Layout::lat_long), sky.width, sky.height, "computed", "no input file was named"};
  return {std::move(source),
          options.projection,
          project(sky.view(), options.projection, control),
          SphericalHarmonics(),
          {},
          1};
}

ShReport make_report(const ShOptions& options) {
  ProgressBar bar;
  const Control control = bar.control();
  ShReport report =
      options.input ? project_input(*options.input, options, control) : project_built_in_sky(options, control);
  report.irradiance = irradiance_from_radiance(report.projection.radiance);
  report.polynomial = babylon_polynomial(report.projection.radiance);
  report.threads = thread_count(options.common);
  return report;
}

void run(ShOptions options) {
  if (options.clamps) options.projection.clamp = options.clamp;
  std::string text;
  run_with_threads(options.common.threads, [&] {
    const ShReport report = make_report(options);
    text = options.common.json ? sh_json(report) : sh_table(report);
  });
  print_result(text);
}

}  // namespace

const char* quadrature_name(Quadrature quadrature) noexcept {
  return quadrature == Quadrature::exact ? "exact" : "midpoint";
}

void add_sh_command(CLI::App& program) {
  const auto options = std::make_shared<ShOptions>();
  CLI::App& command = *program.add_subcommand("sh", "Project an environment to spherical harmonics");
  command.footer(std::string(kShFooter));
  CLI::Option* input =
      command.add_option("INPUT", options->input, "An OpenEXR or PFM file; without it, a built-in sky")->type_name("");
  add_json_option(command, options->common);
  add_projection_options(command, *options);
  add_pixel_options(command, *options);
  add_read_options(command, options->common, input);
  add_threads_option(command, options->common);
  command.callback([options] { run(*options); });
}

}  // namespace welkin::tool
