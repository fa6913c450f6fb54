#include "sky/sky_slice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "sky/cubic.h"
#include "sky/direct_sun.h"
#include "sky/ground_light.h"
#include "sky/phase_functions.h"
#include "sky/sky_geometry.h"
#include "sky/slice_rows.h"

namespace welkin::sky {
namespace {

Taps taps_at(double position, int count) noexcept {
  const Cubic cubic = cubic_at(position, count);
  Taps taps{cubic.first, {}};
  for (int i = 0; i < 4; ++i) taps.weights[i] = static_cast<float>(cubic.weights[i]);
  return taps;
}

double inverse_or_0(double value) noexcept { return value > 0.0 ? 1.0 / value : 0.0; }

}  // namespace

SkySlice::SkySlice(std::shared_ptr<const SkyTables> tables, double altitude_m, const SkyViewOptions& options)
    : tables_(std::move(tables)),
      altitude_(altitude_m),
      outside_(altitude_m > tables_->atmosphere.top_radius_m - tables_->atmosphere.bottom_radius_m),
      mapping_(mapping_of(*tables_)),
      inside_(outside_ ? mapping_.thickness() : altitude_m),
      fold_(tables_->atmosphere, tables_->options.colour) {
  const SliceShape shape = slice_shape(tables_->options);
  views_ = shape.views;
  azimuths_ = shape.azimuths;
  suns_ = shape.suns;
  values_ = slice_rows(*tables_, mapping_, fold_, inside_);
  ground_ = ground_radiances(*tables_, mapping_, fold_);
  if (options.ground) reach_ = ground_reach(*tables_, mapping_, fold_, inside_, views_ / 2);
}

ViewPlace SkySlice::view_place(double mu) const noexcept {
  const double bottom = mapping_.bottom_radius();
  const int half = views_ / 2;
  ViewPlace place;
  place.ground = meets_ground(bottom, inside_, mu);
  const double position = mapping_.view_position(inside_, mu, place.ground, views_);
  place.taps = taps_at(place.ground ? position : position - half, half);
  if (place.ground) {
    place.distance = distance_to_ground(bottom, inside_, mu);
    for (std::size_t c = 0; c < 3 && !reach_.empty(); ++c) {
      float sum = 0.0F;
      for (int i = 0; i < 4; ++i) {
        sum += place.taps.weights[i] * reach_[static_cast<std::size_t>(4 * (place.taps.first + i)) + c];
      }
      place.transmittance[c] = std::clamp(sum, 0.0F, 1.0F);
    }
  } else {
    place.taps.first += half;
  }
  return place;
}

Taps SkySlice::azimuth_taps(double cosine) const noexcept {
  return taps_at(0.5 * (std::clamp(cosine, -1.0, 1.0) + 1.0) * (azimuths_ - 1), azimuths_);
}

SunPlace SkySlice::sun_place(double mu_s) const noexcept {
  return {taps_at(mapping_.sun_coordinate(mu_s) * (suns_ - 1), suns_), static_cast<float>(sun_fade(*tables_, mu_s))};
}

double SkySlice::aerosol_phase(double nu) const noexcept {
  const Atmosphere& air = tables_->atmosphere;
  return sky::aerosol_phase(air.aerosol_phase, air.aerosol_asymmetry, nu);
}

glm::dvec3 SkySlice::ground_radiance(double mu_s) const noexcept {
  const double clamped = std::clamp(mu_s, -1.0, 1.0);
  const double root = clamped < 0.0 ? -std::sqrt(-clamped) : std::sqrt(clamped);
  const double position = 0.5 * (root + 1.0) * (kGroundNodes - 1);
  const int node = std::min(static_cast<int>(position), kGroundNodes - 2);
  const double t = position - node;
  const float* const here = ground_.data() + 4 * node;
  glm::dvec3 rgb;
  for (int c = 0; c < 3; ++c) rgb[c] = (1.0 - t) * static_cast<double>(here[c]) + t * static_cast<double>(here[4 + c]);
  return rgb;
}

void SkySlice::view_rows(const Taps& view, float* rows) const noexcept {
  const std::size_t count =
      std::size_t{kSliceRow} * static_cast<std::size_t>(azimuths_) * static_cast<std::size_t>(suns_);
  std::fill_n(rows, count, 0.0F);
  for (int i = 0; i < 4; ++i) {
    const float* const from = values_.data() + static_cast<std::size_t>(view.first + i) * count;
    for (std::size_t k = 0; k < count; ++k) rows[k] += view.weights[i] * from[k];
  }
}

simd::SkyRun SkySlice::run(const glm::dvec3& sun) const noexcept {
  const double bottom = mapping_.bottom_radius();
  const double thickness = mapping_.thickness();
  const double rho = tangent_distance(bottom, inside_);
  const double longest = rho + mapping_.top_tangent();
  const double shortest = thickness - inside_;
  const int half = views_ / 2;
  const Atmosphere& air = tables_->atmosphere;
  const double g = air.aerosol_asymmetry;
  simd::SkyRun run{};
  run.bottom = bottom;
  run.radius = bottom + inside_;
  run.altitude = inside_;
  run.rho_squared = inside_ * (2.0 * bottom + inside_);
  run.shell = std::max(0.0, shortest * (2.0 * bottom + thickness + inside_));
  run.shortest = shortest;
  run.to_sky = (half - 1) * inverse_or_0(longest - shortest);
  run.to_ground = (half - 1) * inverse_or_0(rho - inside_);
  run.outside = outside_;
  run.viewer_radius = bottom + altitude_;
  for (int i = 0; i < 3; ++i) run.sun[i] = sun[i];
  run.sun_zenith = std::clamp(sun.y, -1.0, 1.0);
  run.sun_sine = std::sqrt(sun.x * sun.x + sun.z * sun.z);
  run.sun_tangent_squared = mapping_.sun_tangent() * mapping_.sun_tangent();
  run.sun_thickness = mapping_.sun_thickness();
  run.sun_scale = 1.0 / (mapping_.sun_tangent() - mapping_.sun_thickness());
  run.lowest_zenith = lowest_sun_sine(*tables_);
  run.lowest_sun =
      std::max(0.0, distance_to_top(bottom, run.sun_thickness, 0.0, run.lowest_zenith) - run.sun_thickness) *
      run.sun_scale;
  const SunPlace place = sun_place(run.sun_zenith);
  run.sun_taps.first = place.taps.first;
  run.sun_taps.between =
      std::clamp(static_cast<int>(mapping_.sun_coordinate(run.sun_zenith) * (suns_ - 1)) - place.taps.first, 0, 2);
  std::copy_n(place.taps.weights, 4, run.sun_taps.weights);
  run.fade = place.fade;
  run.half = half;
  run.azimuths = azimuths_;
  run.suns = suns_;
  run.rows = values_.data();
  run.henyey_greenstein = air.aerosol_phase == AerosolPhase::henyey_greenstein;
  run.asymmetry = g;
  run.aerosol_scale = run.henyey_greenstein ? (1.0 - g) * (1.0 + g) / (4.0 * std::numbers::pi)
                                            : 3.0 / (8.0 * std::numbers::pi) * (1.0 - g) * (1.0 + g) / (2.0 + g * g);
  run.reach = reach_.empty() ? nullptr : reach_.data();
  run.ground = ground_.data();
  run.grounds = kGroundNodes;
  return run;
}

}  // namespace welkin::sky
