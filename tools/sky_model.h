// From the command line's words about a sky to one that can be looked at.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/computed_picture.h"
#include "tools/sky_atmosphere.h"
#include "tools/sky_report.h"
#include "welkin/control.h"
#include "welkin/sky_view.h"

namespace welkin::tool {

struct SkyParameters {
  AtmosphereChoice atmosphere;
  double sun_elevation_degrees = 40.0;
  double sun_azimuth_degrees = 0.0;
  double altitude_m = 0.0;
  SkyViewOptions view;
  SkyTableOptions tables;
  std::optional<std::string> tables_file;
};

struct Sky {
  SkyView view;
  glm::dvec3 sun{};  ///< unit, towards it, in Welkin's axes
  SkyReport report;
  std::vector<PassRecord> passes;
};

/// Throws what choosing the atmosphere, making, loading and saving tables, and `SkyView` throw.
[[nodiscard]] Sky make_sky(const SkyParameters& parameters, const Control& control);

/// A lat-long twice as wide as `height`, its sun inside or apart.
[[nodiscard]] ComputedPicture sky_picture(const Sky& sky, int height, bool sun_disc, const Control& control);

/// The environment of a command to which no file is given: Earth's sky in W/m2/sr/nm at 680, 550, 440 nm, the sun in it
/// 40 degrees up, 25 from +z towards +x. In these units all but the sun's disc lies below 1 and the disc below 65504,
/// the largest half: in cd/m2 a bundle's half floats would clip the sun and the .env's RGBD the sky itself.
[[nodiscard]] ComputedPicture built_in_sky(const Control& control);

}  // namespace welkin::tool
