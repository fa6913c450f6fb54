// What a computed sky was made of, for those who read of it.
#pragma once

#include <optional>
#include <string>

#include "tools/json_text.h"
#include "welkin/atmosphere.h"
#include "welkin/sky_harmonics.h"
#include "welkin/sky_tables.h"

namespace welkin::tool {

struct SkyReport {
  Atmosphere atmosphere;
  double sun_elevation_degrees = 0.0;
  double sun_azimuth_degrees = 0.0;  ///< in Welkin's axes
  double altitude_m = 0.0;
  bool ground = true;
  SkyTableOptions tables;
  std::uint64_t table_bytes = 0;
  int orders = 0;
  double last_change = 0.0;
  glm::dvec3 sky_irradiance{};                    ///< on horizontal ground facing up, without the direct sun
  std::optional<SkyHarmonicsOptions> quadrature;  ///< of the harmonics; none: they are of a picture
  int directions = 0;                             ///< that it looks along
};

/// "W/m2/sr/nm at 680, 550, 440 nm" or "cd/m2, linear sRGB".
[[nodiscard]] std::string sky_unit(const SkyReport& report);

[[nodiscard]] Json sky_json(const SkyReport& report);
/// Some lines for a person.
[[nodiscard]] std::string sky_lines(const SkyReport& report);

}  // namespace welkin::tool
