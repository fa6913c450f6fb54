#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>
#include <utility>

#include "math/direction.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "projection/projection_kernels.h"
#include "sky/sky_geometry.h"
#include "sky/sky_kernels.h"
#include "sky/sky_slice.h"
#include "sky/sunlight.h"
#include "sky/table_sizes.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin {
namespace {

constexpr int kChunk = 64;  // directions

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorCode::invalid_argument, "sky view: " + message);
}

void check_size(const char* name, std::uint64_t found, std::uint64_t expected) {
  if (found == expected) return;
  refuse("the table " + std::string(name) + " holds " + std::to_string(found) + " floats where its options say " +
         std::to_string(expected) + "; use tables from precompute_sky or load_sky_tables");
}

/// Tables may be filled by hand; nothing may be read past their ends.
void check_tables(const SkyTables& tables) {
  static_cast<void>(sky::sky_table_bytes(tables.atmosphere, tables.options));  // checks both
  const std::uint64_t scattering = 4 * sky::scattering_texels(tables.options);
  check_size("scattering", tables.scattering.size(), scattering);
  check_size("single_mie", tables.single_mie.size(), sky::single_mie_floats(tables.atmosphere, tables.options));
  check_size("transmittance", tables.transmittance.size(), sky::transmittance_floats(tables.options));
  check_size("irradiance", tables.irradiance.size(), sky::irradiance_floats(tables.options));
}

const std::shared_ptr<const SkyTables>& checked(const std::shared_ptr<const SkyTables>& tables, double altitude_m) {
  if (!tables) refuse("tables is null; pass those of precompute_sky or load_sky_tables");
  sky::check_altitude(altitude_m);
  check_tables(*tables);
  return tables;
}

}  // namespace

struct SkyView::Slice {
  sky::SkySlice slice;
};

SkyView::SkyView(std::shared_ptr<const SkyTables> tables, double altitude_m, const SkyViewOptions& options)
    : slice_([&] {
        const platform::FloatingPointScope floating_point;
        return std::make_shared<const Slice>(Slice{sky::SkySlice(checked(tables, altitude_m), altitude_m, options)});
      }()) {}

const sky::SkySlice& SkyViewAccess::slice(const SkyView& view) noexcept { return view.slice_->slice; }

const std::shared_ptr<const SkyTables>& SkyView::tables() const noexcept { return slice_->slice.tables(); }
double SkyView::altitude_m() const noexcept { return slice_->slice.altitude(); }

glm::dvec3 SkyView::radiance(const glm::dvec3& direction, const glm::dvec3& sun) const {
  const platform::FloatingPointScope floating_point;
  const sky::SkyRun run = slice_->slice.run(sky::sun_unit(sun));
  const glm::dvec3 towards = math::moderate_direction(direction, "direction");
  const double xyz[3] = {towards.x, towards.y, towards.z};
  float rgb[3];
  sky::view_kernels().radiance(run, xyz, 1, rgb);
  return {rgb[0], rgb[1], rgb[2]};
}

void SkyView::radiance(std::span<const glm::vec3> directions, const glm::dvec3& sun, std::span<glm::vec3> rgb) const {
  if (rgb.size() < directions.size()) {
    refuse("rgb has " + std::to_string(rgb.size()) + " elements for " + std::to_string(directions.size()) +
           " directions");
  }
  const sky::ViewKernels& kernels = sky::view_kernels();
  const platform::FloatingPointScope floating_point;
  sky::SkyRun run = slice_->slice.run(sky::sun_unit(sun));
  // Reducing the slice to the sun pays from some directions on; of large tables it would not fit on the stack.
  constexpr std::size_t floats = 16384;
  alignas(64) float of_sun[floats];
  const std::size_t rows = 2 * static_cast<std::size_t>(run.half) * static_cast<std::size_t>(run.azimuths);
  if (!run.outside && rows * sky::kSkyRow <= floats && 6 * directions.size() > rows) {
    kernels.reduce(run, of_sun);
    run.of_sun = of_sun;
  }
  double xyz[3 * kChunk];
  float out[3 * kChunk];
  for (std::size_t first = 0; first < directions.size(); first += kChunk) {
    const std::size_t count = std::min<std::size_t>(kChunk, directions.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const glm::dvec3 towards = math::moderate_direction(glm::dvec3(directions[first + i]), "direction");
      for (int c = 0; c < 3; ++c) xyz[3 * i + static_cast<std::size_t>(c)] = towards[c];
    }
    kernels.radiance(run, xyz, static_cast<int>(count), out);
    for (std::size_t i = 0; i < count; ++i) rgb[first + i] = {out[3 * i], out[3 * i + 1], out[3 * i + 2]};
  }
}

Sun SkyView::sun_light(const glm::dvec3& sun) const {
  const platform::FloatingPointScope floating_point;
  const sky::SkySlice& slice = slice_->slice;
  const double half_turns = tables()->atmosphere.sun_angular_radius_degrees / 720.0;
  const double sine = math::sine_cosine_of_turns(half_turns).sine;
  Sun light;
  light.direction = sky::sun_unit(sun);
  light.irradiance =
      slice.fold().sunlight() * sky::sun_share(*tables(), slice.mapping(), altitude_m(), light.direction.y);
  // 2 pi (1 - cos a) = 4 pi sin^2(a / 2), which keeps its digits for a small disc.
  light.solid_angle = 4.0 * std::numbers::pi * sine * sine;
  if (light.solid_angle > sky::kPoint) light.radiance = light.irradiance / light.solid_angle;
  light.angular_radius_degrees = tables()->atmosphere.sun_angular_radius_degrees;
  return light;
}

glm::dvec3 SkyView::irradiance(const glm::dvec3& sun) const {
  const platform::FloatingPointScope floating_point;
  const sky::SkySlice& slice = slice_->slice;
  const double mu_s = sky::sun_unit(sun).y;
  if (slice.outside()) return {};
  return sky::sky_irradiance(*tables(), slice.mapping(), altitude_m(), mu_s) + slice.night().irradiance();
}

}  // namespace welkin
