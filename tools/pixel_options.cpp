#include "tools/pixel_options.h"

#include <cmath>

#include "tools/options.h"

namespace welkin::tool {

CLI::Validator finite_and_positive() {
  return {[](const std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0.0;
            return good ? std::string() : text + " is not a finite number above 0";
          },
          ""};
}

namespace {

void add_clamp_options(CLI::App& command, ClampChoice& choice) {
  command
      .add_option_function<float>(
          "--clamp",
          [&choice](float maximum) {
            choice.clamp.maximum = maximum;
            choice.clamps = true;
          },
          "Cut radiance off above V; off by default. What it takes away is reported")
      ->check(finite_and_positive())
      ->type_name("V");
  command.add_flag_callback(
      "--preserve-clamped",
      [&choice] {
        choice.clamp.preserve_colour = true;
        choice.clamps = true;
      },
      "Clamp by scaling red, green and blue together; without --clamp at 4096, Babylon.js's limit");
}

}  // namespace

void add_pixel_options(CLI::App& command, ProjectionOptions& options, ClampChoice& clamp) {
  add_clamp_options(command, clamp);
  command.add_flag("--gamma", options.gamma,
                   "The pixels are gamma encoded: clamp them to 0 to 1 and raise them to 2.2 first");
  add_choice<NonFinitePolicy>(command, "--nan", options.nan,
                              {{"replace", NonFinitePolicy::replace}, {"reject", NonFinitePolicy::reject}},
                              "NaN becomes 0 (default), or ends the command and is named");
  add_choice<NonFinitePolicy>(command, "--infinity", options.infinity,
                              {{"replace", NonFinitePolicy::replace}, {"reject", NonFinitePolicy::reject}},
                              "Infinity becomes the clamp's V or 65504 (default), or ends the command and is named");
  add_choice<NegativePolicy>(
      command, "--negative", options.negative,
      {{"keep", NegativePolicy::keep}, {"replace", NegativePolicy::replace}, {"reject", NegativePolicy::reject}},
      "Negative values are taken as they are (default), become 0, or end the command and are named");
}

}  // namespace welkin::tool
