// Runs `welkin sky` with tables that are quickly made.
#pragma once

#include "support/catch.h"
#include "tools/command.h"
#include "welkin/image.h"
#include "welkin/sky.h"

namespace welkin::test {

inline const std::string kSmallSky = "--table-size 4,16,8,4 --orders 2 ";

inline SkyTableOptions small_sky_options() {
  return {.heights = 4, .view_zeniths = 16, .sun_zeniths = 8, .sun_angles = 4, .orders = 2};
}

inline std::shared_ptr<const SkyTables> small_sky(const Atmosphere& atmosphere = earth()) {
  return std::make_shared<const SkyTables>(precompute_sky(atmosphere, small_sky_options()));
}

/// Runs `welkin sky --json` with small tables and more arguments, requires success and silence; the JSON.
inline nlohmann::json sky_json(const std::string& arguments, const std::string& environment = "") {
  return json_printed_by("sky --json " + kSmallSky + arguments, environment);
}

inline std::string sky_failure(const std::string& arguments, int exit_code) {
  return failure("sky " + arguments, exit_code);
}

inline glm::dvec3 rgb_of(const nlohmann::json& value) {
  REQUIRE(value.is_array());
  REQUIRE(value.size() == 3);
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

/// What the command bakes and projects where no file is named, as the library makes it.
inline LatLongImage built_in_sky() {
  SkyTableOptions options{.heights = 8, .view_zeniths = 64, .sun_zeniths = 16};
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(earth(), options)), 0.0);
  return sky_lat_long(view, sun_direction(40.0, 25.0), 512, {.sun_disc = true});
}

}  // namespace welkin::test
