#include "sky/ray_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "math/elementary.h"
#include "sky/sky_geometry.h"

namespace welkin::sky {
namespace {

constexpr std::size_t kLanes = simd::kLanes;
constexpr double kNegligible = 1e-7;        ///< share of what a panel scatters that is left out
constexpr std::size_t kMostSunNodes = 256;  ///< of a row of sunlight
constexpr int kGlowNodes = 1025;
constexpr double kGlowDepth = 0.5;  ///< of aerosol, that a glow is typical of
constexpr double kEvenGlow = 0.03;  ///< share of it that is the same from everywhere

std::size_t padded(std::size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }

/// Place of an angle of that cosine among nodes evenly from 0 to pi.
double place_of_angle(double cosine, int nodes) noexcept {
  const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
  return 2.0 * math::turns_of(sine, cosine) * (nodes - 1);
}

struct Between {
  int node;
  double fraction;
};

Between between(double position, int nodes) noexcept {
  const double inside = std::clamp(position, 0.0, static_cast<double>(nodes - 1));
  const int node = std::min(static_cast<int>(inside), nodes - 2);
  return {node, inside - node};
}

/// What a panel sends on of light that is nearly the same all over it: one sample in the middle of what scatters, which
/// is exact for sources that vary linearly along the panel.
struct ScatteringPanel {
  double distance = 0.0;
  double whole = 0.0;
  double shares[2]{};      ///< of molecules and aerosol
  double weights[2][3]{};  ///< likewise, at each wavelength
};

ScatteringPanel scattering_of(const RayNode* nodes, std::size_t count, const WavelengthGroup& group,
                              bool with_aerosol) noexcept {
  ScatteringPanel panel;
  double moment = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const RayNode& node = nodes[k];
    double here = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double seen = node.weight * node.transmittance[c];
      const double rayleigh = seen * node.density[kRayleigh] * group.rayleigh[c];
      const double aerosol = with_aerosol ? seen * node.density[kAerosol] * group.aerosol[c] : 0.0;
      panel.weights[kRayleigh][c] += rayleigh;
      panel.weights[kAerosol][c] += aerosol;
      panel.shares[kRayleigh] += rayleigh;
      panel.shares[kAerosol] += aerosol;
      here += rayleigh + aerosol;
    }
    panel.whole += here;
    moment += here * node.distance;
  }
  panel.distance = panel.whole > 0.0 ? moment / panel.whole : 0.0;
  return panel;
}

}  // namespace

SunAxis sun_axis(const TableMapping& mapping, int nodes) noexcept {
  const double tangent = mapping.sun_tangent() / mapping.bottom_radius();
  const double shortest = mapping.sun_thickness() / mapping.bottom_radius();
  const SunTerms& terms = mapping.smooth_sun_terms();
  return {.reach = static_cast<float>(tangent * tangent),
          .shortest = static_cast<float>(shortest),
          .scale = static_cast<float>(1.0 / (tangent - shortest)),
          .inverse_lowest = static_cast<float>(1.0 / mapping.lowest_sun()),
          .bend = static_cast<float>(terms.bend),
          .path = static_cast<float>(terms.path),
          .level = static_cast<float>(terms.level),
          .lowest = static_cast<float>(terms.lowest),
          .nodes = nodes};
}

double source_altitude(const TableMapping& mapping, const SourceShape& shape, std::size_t node) noexcept {
  return mapping.altitude(unbent(static_cast<double>(node) / (shape.heights - 1), shape.height_bend));
}

double source_height(const SourceShape& shape, double height_coordinate) noexcept {
  return bent(height_coordinate, shape.height_bend) * (shape.heights - 1);
}

WavelengthGroup wavelength_group(const Air& air, std::size_t group, std::span<const double> forward) {
  WavelengthGroup wavelengths;
  const std::size_t last = air.atmosphere().wavelengths_nm.size() - 1;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t wavelength = std::min(last, 3 * group + c);
    for (std::size_t i = 0; i < air.constituents(); ++i) {
      wavelengths.extinctions[c][i] = air.extinction(i, wavelength);
    }
    wavelengths.rayleigh[c] = air.scattering(kRayleigh, wavelength);
    wavelengths.aerosol_once[c] = air.scattering(kAerosol, wavelength);
    const double straight = forward.empty() ? 0.0 : forward[wavelength];
    wavelengths.aerosol[c] = (1.0 - straight) * wavelengths.aerosol_once[c];
    wavelengths.extinctions[c][kAerosol] -= straight * wavelengths.aerosol_once[c];
    wavelengths.asymmetry[c] = aerosol_asymmetry(air.atmosphere(), wavelength);
    wavelengths.albedo[c] = air.albedo(wavelength);
    wavelengths.solar[c] = air.atmosphere().solar_irradiance[wavelength];
  }
  return wavelengths;
}

// Light that was turned twice, three times and so on by a lobe of moments chi has chi^2, chi^3, and, some depth of air
// taken for all, the sum of these that is below. What has come round by the ground or by large turns is about even.
Glow::Glow(const std::vector<PhaseSpectrum>& spectra) {
  for (const PhaseSpectrum& spectrum : spectra) {
    std::vector<double> moments(spectrum.aerosol.size());
    for (std::size_t l = 0; l < moments.size(); ++l) {
      const double chi = spectrum.aerosol[l];
      moments[l] = chi * (math::exponential(kGlowDepth * chi) - 1.0) / (math::exponential(kGlowDepth) - 1.0);
    }
    std::vector<double> values(kGlowNodes);
    for (std::size_t k = 0; k < kGlowNodes; ++k) {
      const double cosine = math::sine_cosine_of_turns(0.5 * static_cast<double>(k) / (kGlowNodes - 1)).cosine;
      values[k] = kEvenGlow / (4.0 * std::numbers::pi) + phase_of(moments, cosine);
    }
    values_.push_back(std::move(values));
  }
}

double Glow::at(std::size_t channel, double cosine) const noexcept {
  const std::vector<double>& values = values_[values_.size() > 1 ? channel : 0];
  const Between place = between(place_of_angle(cosine, kGlowNodes), kGlowNodes);
  const double low = values[static_cast<std::size_t>(place.node)];
  return low + place.fraction * (values[static_cast<std::size_t>(place.node) + 1] - low);
}

void ScatteringSource::set_steps() {
  const auto suns = static_cast<std::size_t>(shape.suns);
  steps.assign(static_cast<std::size_t>(shape.heights) * shape.sun_steps(), 0.0F);
  for (std::size_t h = 0; h < static_cast<std::size_t>(shape.heights); ++h) {
    std::vector<double> nodes(brightness.begin() + static_cast<std::ptrdiff_t>(h * suns),
                              brightness.begin() + static_cast<std::ptrdiff_t>((h + 1) * suns));
    limit_falls(nodes);
    const std::vector<float> fine = fine_steps(nodes);
    std::copy(fine.begin(), fine.end(), steps.begin() + static_cast<std::ptrdiff_t>(h * shape.sun_steps()));
  }
}

RayLight::RayLight(const Air& air, const SourceShape& shape, std::size_t count)
    : count_(count),
      padded_(padded(count)),
      nodes_(air),
      zenith_cosine_(padded_),
      angle_cosine_(padded_),
      row_(padded_),
      row_fraction_(padded_),
      sums_(8 * padded_),
      scratch_(std::max(4 * shape.picture() + shape.sun_steps() + 4 * static_cast<std::size_t>(shape.suns),
                        4 * kMostSunNodes)) {
  for (std::size_t i = 0; i < padded_; ++i) set_sun(i, 1.0, 1.0);
}

SkySuns RayLight::suns() const noexcept {
  return {zenith_cosine_.data(), angle_cosine_.data(), row_.data(), row_fraction_.data(), static_cast<int>(padded_)};
}

void RayLight::place(const Air& air, const Ray& ray, const WavelengthGroup& group, double coarseness) noexcept {
  ray_ = ray;
  nodes_.place(air, ray, group.extinctions, coarseness);
}

const float* RayLight::sunlight(const SolverKernels& kernels, const Air& air, const Sunlight& light) noexcept {
  std::fill_n(sums_.data(), 8 * padded_, 0.0F);
  const double radius = air.bottom_radius() + ray_.altitude;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const RayNode& node = nodes_[n];
    const double here = air.bottom_radius() + node.altitude;
    SunlitSample sample{};
    light.at(node.altitude, sample);
    sample.start_ratio = static_cast<float>(radius / here);
    sample.distance_ratio = static_cast<float>(node.distance / here);
    for (std::size_t c = 0; c < 3; ++c) sample.transmittance[c] = static_cast<float>(node.transmittance[c]);
    const double view_cosine = std::clamp((radius * ray_.zenith_cosine + node.distance) / here, -1.0, 1.0);
    const double from = altitude_along(air.bottom_radius(), node.altitude, view_cosine, -0.5 * node.weight);
    const double to = altitude_along(air.bottom_radius(), node.altitude, view_cosine, 0.5 * node.weight);
    const auto slope = static_cast<double>(sample.disc_slope);
    sample.view_cosine = static_cast<float>(view_cosine);
    sample.turning = static_cast<float>(0.5 * slope * node.weight / here);
    sample.sinking = static_cast<float>(0.5 * slope *
                                        (horizon_cosine(air.bottom_radius(), std::max(0.0, to)) -
                                         horizon_cosine(air.bottom_radius(), std::max(0.0, from))));
    sample.rayleigh = static_cast<float>(node.weight * node.density[kRayleigh]);
    sample.aerosol = static_cast<float>(node.weight * node.density[kAerosol]);
    kernels.add_sunlight(sample, light.nodes(), suns(), scratch_.data(), sums_.data());
  }
  return sums_.data();
}

void RayLight::multiply_glow(const Glow& glow, float* light) const noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    for (std::size_t c = 0; c < 3; ++c) light[4 * i + c] *= static_cast<float>(glow.at(c, angle_cosine(i)));
  }
}

RayLight::Scattered RayLight::scattered(const SolverKernels& kernels, const Air& air, const WavelengthGroup& group,
                                        const ScatteringSource& source, const TableMapping& mapping) noexcept {
  const SourceShape& shape = source.shape;
  const std::size_t picture = 4 * shape.picture();
  for (std::size_t i = 0; i < padded_; ++i) {
    const Between angle = between(place_of_angle(this->angle_cosine(i), shape.angles), shape.angles);
    row_.data()[i] = angle.node * shape.suns;
    row_fraction_.data()[i] = static_cast<float>(angle.fraction);
  }
  const bool apart = source.glow.any();
  std::fill_n(sums_.data(), (apart ? 8 : 4) * padded_, 0.0F);
  const SunAxis axis = sun_axis(mapping, shape.suns);
  const double radius = air.bottom_radius() + ray_.altitude;
  const bool with_aerosol = !source.aerosol.empty();
  // A panel may cross all of a thin shell, in whose middle there is more light than on the average.
  const std::size_t nodes_a_sample = mapping.thin() ? 2 : kPanelNodes;
  for (std::size_t n = 0; n < nodes_.size(); n += nodes_a_sample) {
    const ScatteringPanel panel = scattering_of(&nodes_[n], nodes_a_sample, group, with_aerosol);
    if (!(panel.whole > 0.0)) continue;
    const double altitude = std::clamp(
        altitude_along(air.bottom_radius(), ray_.altitude, ray_.zenith_cosine, panel.distance), 0.0, air.thickness());
    const double here = air.bottom_radius() + altitude;
    const double zenith_cosine = std::clamp((radius * ray_.zenith_cosine + panel.distance) / here, -1.0, 1.0);
    const Between height = between(source_height(shape, mapping.height_coordinate(altitude)), shape.heights);
    const Between zenith = between(place_of_angle(zenith_cosine, shape.zeniths), shape.zeniths);
    SourceSample samples[2]{};  // of both kinds of matter, or of molecules and of the aerosol
    SourceSample& sample = samples[0];
    sample.start_ratio = static_cast<float>(radius / here);
    sample.distance_ratio = static_cast<float>(panel.distance / here);
    for (std::size_t k = 0; k < 4; ++k) {
      const bool upper = k >= 2;
      const bool next = k % 2 == 1;
      const double share =
          (upper ? height.fraction : 1.0 - height.fraction) * (next ? zenith.fraction : 1.0 - zenith.fraction);
      const auto row =
          static_cast<std::size_t>(height.node + (upper ? 1 : 0)) * static_cast<std::size_t>(shape.zeniths) +
          static_cast<std::size_t>(zenith.node + (next ? 1 : 0));
      for (std::size_t matter = 0; matter < 2; ++matter) {
        if (!(panel.shares[matter] > kNegligible * panel.whole)) continue;  // nothing at all too
        const std::vector<float>& values = matter == kRayleigh ? source.rayleigh : source.aerosol;
        SourceSample& to = samples[apart ? matter : 0];
        to.pictures[to.count] = values.data() + row * picture;
        for (std::size_t c = 0; c < 3; ++c) {
          to.weights[to.count][c] = static_cast<float>(share * panel.weights[matter][c]);
        }
        ++to.count;
      }
    }
    for (std::size_t matter = 0; matter < (apart ? 2 : 1); ++matter) {
      SourceSample& one = samples[matter];
      if (apart && one.count == 0) continue;
      one.start_ratio = sample.start_ratio;
      one.distance_ratio = sample.distance_ratio;
      for (std::size_t k = 0; k < 2; ++k) {
        one.steps[k] = source.steps.data() + (static_cast<std::size_t>(height.node) + k) * shape.sun_steps();
        one.step_weights[k] = static_cast<float>(k == 0 ? 1.0 - height.fraction : height.fraction);
      }
      kernels.add_source(one, axis, static_cast<int>(shape.picture()), shape.suns, suns(), scratch_.data(),
                         sums_.data() + matter * 4 * padded_);
    }
  }
  if (!apart) return {sums_.data(), nullptr};
  multiply_glow(source.glow, sums_.data() + 4 * padded_);
  return {sums_.data(), sums_.data() + 4 * padded_};
}

}  // namespace welkin::sky
