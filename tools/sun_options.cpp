#include "tools/sun_options.h"

#include "tools/direction_text.h"
#include "tools/number_text.h"

namespace welkin::tool {

CLI::Option* add_sun_options(CLI::App& command, SunChoice& choice) {
  CLI::Option* take_out = command.add_flag("--take-out-sun", choice.take_out,
                                           "Take the sun out of the environment and report it as a directional light");
  const auto add = [&](const char* name, double& value, const CLI::Range& range, const char* type, const char* text) {
    command.add_option(name, value, text)->check(CLI::Range(range).description(""))->type_name(type)->needs(take_out);
  };
  add("--sun-threshold", choice.options.relative_threshold, CLI::Range(1e-9, 1.0), "SHARE",
      "What has this share of the brightest luminance belongs to the sun; default 0.02");
  add("--sun-radius", choice.options.maximum_radius_degrees, CLI::Range(0.0, 90.0), "DEGREES",
      "What is larger than this is no sun; default 3");
  add("--sun-contrast", choice.options.minimum_contrast, CLI::Range(1.0, 1e300), "TIMES",
      "What is less than so many times as bright as the mean is no sun; default 20");
  add("--sun-share", choice.options.minimum_share, CLI::Range(0.0, 1.0), "SHARE",
      "What has less of the light than this is no sun; default 0.01");
  return take_out;
}

std::string sun_text(const std::optional<Sun>& sun, bool z_is_up) {
  if (!sun) return "Sun: none found; nothing was taken out\n";
  const bool was_in_pixels = sun->texels > 0;
  return std::string(was_in_pixels ? "Sun, taken out" : "Sun, apart") + "\n  towards     " +
         direction_text(sun->direction, z_is_up) + "\n  irradiance  " + significant(sun->irradiance) +
         "  on a surface that faces it\n  radiance    " + significant(sun->radiance) + "  its mean\n  extent      " +
         significant(sun->solid_angle) + " sr" +
         (was_in_pixels ? " (" + counted(sun->texels, "texel") + " changed)" : "") + ", a disc of " +
         significant(sun->angular_radius_degrees, 3) + " degrees radius\n";
}

}  // namespace welkin::tool
