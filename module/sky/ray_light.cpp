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
constexpr double kNegligible = 3e-4;       ///< fraction of a panel's scattering that is credited to the other matter
constexpr double kUnseen = 1e-9;           ///< fraction of a ray's aerosol that is left out
constexpr double kThinPanel = 2.5;         ///< scale heights that a sample may stand for...
constexpr double kThinStep = 1.3;          ///< ... or steps of a source's heights
constexpr std::size_t kMaxSunNodes = 256;  ///< of a row of sunlight
constexpr int kGlowNodes = 1025;
constexpr double kGlowDepth = 0.5;  ///< of aerosol, typical of a glow
constexpr double kEvenGlow = 0.03;  ///< fraction of it that is the same from everywhere

std::size_t padded(std::size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }

/// Returns the position of an angle of that cosine among nodes evenly spaced from 0 to pi: 180 degrees are n - 1 steps.
/// atan2 of sine and cosine keeps digits near 0 and 180 degrees, where arccos loses half of them.
double angle_position(double cosine, int nodes) noexcept {
  const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
  return 2.0 * math::turns_of(sine, cosine) * (nodes - 1);
}

/// Scattering of consecutive nodes of a ray.
struct ScatteredWeights {
  double distance = 0.0;
  double whole = 0.0;
  double shares[2]{};      ///< of molecules and aerosol
  double weights[2][3]{};  ///< of molecules and aerosol, at each wavelength
};

ScatteredWeights weights_of(const RayNode* nodes, std::size_t count, const WavelengthGroup& group) noexcept {
  ScatteredWeights sum;
  // With weights w_k = length x transmittance x what scatters there, Sum w_k (a + b s_k) = W (a + b s_m) with W = Sum
  // w_k and s_m = Sum w_k s_k / W: one sample at the centroid s_m is exact for light that is linear along the panel.
  // The centroid is that of all channels and both kinds of matter together, since a sample costs a lookup of both.
  double moment = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const RayNode& node = nodes[k];
    double here = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double seen = node.weight * node.transmittance[c];
      const double rayleigh = seen * node.density[kRayleigh] * group.rayleigh[c];
      const double aerosol = seen * node.density[kAerosol] * group.aerosol[c];
      sum.weights[kRayleigh][c] += rayleigh;
      sum.weights[kAerosol][c] += aerosol;
      sum.shares[kRayleigh] += rayleigh;
      sum.shares[kAerosol] += aerosol;
      here += rayleigh + aerosol;
    }
    sum.whole += here;
    moment += here * node.distance;
  }
  sum.distance = sum.whole > 0.0 ? moment / sum.whole : 0.0;
  return sum;
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
          .zenith = static_cast<float>(terms.zenith),
          .nodes = nodes};
}

double source_altitude(const TableMapping& mapping, const SourceShape& shape, std::size_t node) noexcept {
  return mapping.altitude(unbent(static_cast<double>(node) / (shape.heights - 1), shape.height_bend));
}

double source_height(const SourceShape& shape, double height_coordinate) noexcept {
  return bent(height_coordinate, shape.height_bend) * (shape.heights - 1);
}

WavelengthGroup wavelength_group(const AirModel& air, std::size_t group, std::span<const double> forward) {
  WavelengthGroup wavelengths;
  const std::size_t last = air.atmosphere().wavelengths_nm.size() - 1;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t wavelength = std::min(last, 3 * group + c);
    wavelengths.extinctions[c] = air.extinctions(wavelength);
    wavelengths.rayleigh[c] = air.scattering(kRayleigh, wavelength);
    wavelengths.aerosol_once[c] = air.scattering(kAerosol, wavelength);
    // Delta-M (Wiscombe 1977): with P = f 2 delta(1 - cos) + (1 - f) P', the part f of scattering leaves the direction
    // as it is and drops out of the transport equation on both sides: beta_s' = (1 - f) beta_s, beta_e' = beta_e - f
    // beta_s, with the phase function P' (`phase_spectrum`). The first order keeps all of beta_s with the whole
    // P (`aerosol_once`), but under the transmittance of beta_e' (Nakajima and Tanaka 1988, TMS).
    const double straight = forward.empty() ? 0.0 : forward[wavelength];
    wavelengths.aerosol[c] = (1.0 - straight) * wavelengths.aerosol_once[c];
    wavelengths.extinctions[c][kAerosol] -= straight * wavelengths.aerosol_once[c];
    wavelengths.asymmetry[c] = aerosol_asymmetry(air.atmosphere(), wavelength);
    wavelengths.albedo[c] = air.albedo(wavelength);
    wavelengths.solar[c] = air.atmosphere().solar_irradiance[wavelength];
  }
  return wavelengths;
}

// Light deflected n times by a lobe of moments chi has the moments chi^n (each convolution multiplies them). Under a
// depth t, light deflected n times is in proportion to t^n / n!. Light that arrives after n >= 1 deflections and is
// deflected once more has
//   chi Sum_(n >= 1) (t chi)^n / n! / Sum_(n >= 1) t^n / n! = chi (exp(t chi) - 1) / (exp(t) - 1),
// which is 1 for chi = 1: the whole of it integrates to 1. t is taken as `kGlowDepth` for all air. Light that arrives
// by way of the ground or by large deflections is about uniform, and is added as `kEvenGlow`. Sources are divided by
// the glow at their nodes and multiplied by it in lookups: its error cancels at nodes, and between them costs only
// resolution.
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
  const Between position = between(angle_position(cosine, kGlowNodes), kGlowNodes);
  const double low = values[position.node];
  return low + position.part * (values[position.node + 1] - low);
}

void ScatteringSource::set_steps() {
  const auto suns = static_cast<std::size_t>(shape.suns);
  steps.assign(static_cast<std::size_t>(shape.heights) * shape.sun_steps(), 0.0F);
  for (std::size_t h = 0; h < static_cast<std::size_t>(shape.heights); ++h) {
    std::vector<double> nodes(brightness.begin() + static_cast<std::ptrdiff_t>(h * suns),
                              brightness.begin() + static_cast<std::ptrdiff_t>((h + 1) * suns));
    limit_decay(nodes);
    const std::vector<float> fine = resample_log_cubic(nodes);
    std::copy(fine.begin(), fine.end(), steps.begin() + static_cast<std::ptrdiff_t>(h * shape.sun_steps()));
  }
}

RayLight::RayLight(const AirModel& air, const SourceShape& shape, std::size_t count)
    : count_(count),
      padded_(padded(count)),
      nodes_(air),
      zenith_cosine_(padded_),
      angle_cosine_(padded_),
      row_(padded_),
      row_fraction_(padded_),
      sums_(12 * padded_),
      scratch_(std::max(4 * shape.image() + shape.sun_steps() + 16 * static_cast<std::size_t>(shape.suns),
                        8 * kMaxSunNodes)) {
  panels_.reserve(kMaxRayNodes);
  for (std::size_t i = 0; i < padded_; ++i) set_sun(i, 1.0, 1.0);
}

SkySuns RayLight::suns() const noexcept {
  return {zenith_cosine_.data(), angle_cosine_.data(), row_.data(), row_fraction_.data(), static_cast<int>(padded_)};
}

void RayLight::place(const AirModel& air, const Ray& ray, const WavelengthGroup& group) noexcept {
  ray_ = ray;
  nodes_.place(air, ray, group.extinctions);
}

// Along a stretch of length ds about a sample, the zenith cosine of the sun, mu_s' = (r mu_s + s nu) / r', changes by
//   d mu_s' / ds = nu / r' - mu_s' (dr' / ds) / r' = (nu - mu' mu_s') / r',   since dr' / ds = mu' (`view_cosine`),
// and the cosine of the horizon by half of its difference between both ends of the stretch. t, the disc's rise
// (sky_kernels.h), has slope `disc_slope` in mu_s' - horizon, so that over half of the stretch, 0.5 `weight`, it
// changes by
//   w = turning (nu - mu' mu_s') - sinking.
// The visible share is averaged from t - w to t + w: a sample of a long panel would otherwise be lit or dark as a
// whole, and the shadow's edge would move in steps from node to node. (The weight of a Gauss node stands for its part
// of the panel.)
const float* RayLight::sunlight(const SolverKernels& kernels, const AirModel& air, const Sunlight& light) noexcept {
  std::fill_n(sums_.data(), 8 * padded_, 0.0F);
  const double radius = air.bottom_radius() + ray_.altitude;
  double all_aerosol = 0.0;
  for (std::size_t n = 0; n < nodes_.size(); ++n) all_aerosol += nodes_[n].weight * nodes_[n].density[kAerosol];
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const RayNode& node = nodes_[n];
    const double here = air.bottom_radius() + node.altitude;
    SunlitSample sample{};
    light.at(node.altitude, sample);
    // mu_s' = (r mu_s + s nu) / r', where the lanes differ in mu_s and nu alone: both ratios are the sample's.
    sample.start_ratio = static_cast<float>(radius / here);
    sample.distance_ratio = static_cast<float>(node.distance / here);
    const double view_cosine = std::clamp((radius * ray_.zenith_cosine + node.distance) / here, -1.0, 1.0);
    const double from = altitude_along(air.bottom_radius(), node.altitude, view_cosine, -0.5 * node.weight);
    const double to = altitude_along(air.bottom_radius(), node.altitude, view_cosine, 0.5 * node.weight);
    const auto slope = static_cast<double>(sample.disc_slope);
    sample.view_cosine = static_cast<float>(view_cosine);
    sample.turning = static_cast<float>(0.5 * slope * node.weight / here);
    sample.sinking = static_cast<float>(0.5 * slope *
                                        (horizon_cosine(air.bottom_radius(), std::max(0.0, to)) -
                                         horizon_cosine(air.bottom_radius(), std::max(0.0, from))));
    const double aerosol = node.weight * node.density[kAerosol];
    for (std::size_t c = 0; c < 3; ++c) {
      sample.rayleigh[c] = static_cast<float>(node.weight * node.density[kRayleigh] * node.transmittance[c]);
      sample.aerosol[c] = static_cast<float>(aerosol * node.transmittance[c]);
    }
    sample.with_aerosol = aerosol > kUnseen * all_aerosol;
    kernels.add_sunlight(sample, light.nodes(), suns(), scratch_.data(), sums_.data());
  }
  return sums_.data();
}

void RayLight::multiply_glow(const Glow& glow, float* light) const noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    for (std::size_t c = 0; c < 3; ++c) light[4 * i + c] *= static_cast<float>(glow.at(c, angle_cosine(i)));
  }
}

// Returns how many of a panel's four nodes one sample stands for: all four if they lie no further apart than
// `kThinPanel` scale heights, or no further than `kThinStep` of the nodes between which the source is interpolated in
// height; else two, else one. A linear source is exact at the centroid (`weights_of`), and interpolated sources are
// linear between heights. A panel may cross all of a thin shell, in whose middle there is more light than on the
// average: there two at most.
std::size_t RayLight::nodes_of_panel(const AirModel& air, const SourceShape& shape, const TableMapping& mapping,
                                     std::size_t first) const noexcept {
  std::size_t count = mapping.thin() ? 2 : kPanelNodes;
  const auto apart = [&](std::size_t a, std::size_t b) {
    const double low = std::min(nodes_[a].altitude, nodes_[b].altitude);
    const double high = std::max(nodes_[a].altitude, nodes_[b].altitude);
    if (high - low <= kThinPanel * air.scale_height()) return false;
    return source_height(shape, mapping.height_coordinate(high)) -
               source_height(shape, mapping.height_coordinate(low)) >
           kThinStep;
  };
  if (count == kPanelNodes && apart(first, first + 3)) count = 2;
  if (count == 2 && (apart(first, first + 1) || apart(first + 2, first + 3))) count = 1;
  return count;
}

std::span<const ScatteringPanel> RayLight::panels(const AirModel& air, const WavelengthGroup& group,
                                                  const SourceShape& shape, const TableMapping& mapping) noexcept {
  panels_.clear();
  const double radius = air.bottom_radius() + ray_.altitude;
  for (std::size_t panel = 0; panel < nodes_.size(); panel += kPanelNodes) {
    const std::size_t count = nodes_of_panel(air, shape, mapping, panel);
    for (std::size_t n = panel; n < panel + kPanelNodes; n += count) {
      const ScatteredWeights sum = weights_of(&nodes_[n], count, group);
      if (!(sum.whole > 0.0)) continue;
      const double altitude = std::clamp(
          altitude_along(air.bottom_radius(), ray_.altitude, ray_.zenith_cosine, sum.distance), 0.0, air.thickness());
      const double here = air.bottom_radius() + altitude;
      const double zenith_cosine = std::clamp((radius * ray_.zenith_cosine + sum.distance) / here, -1.0, 1.0);
      const Between height = between(source_height(shape, mapping.height_coordinate(altitude)), shape.heights);
      const Between zenith = between(angle_position(zenith_cosine, shape.zeniths), shape.zeniths);
      ScatteringPanel& to = panels_.emplace_back();
      to.start_ratio = static_cast<float>(radius / here);
      to.distance_ratio = static_cast<float>(sum.distance / here);
      to.view_cosine = static_cast<float>(zenith_cosine);
      to.height = static_cast<std::int32_t>(height.node);
      to.height_fraction = static_cast<float>(height.part);
      to.zenith = static_cast<std::int32_t>(zenith.node);
      to.zenith_fraction = static_cast<float>(zenith.part);
      // what is left of the one that hardly scatters is the other's, so that no light is lost
      for (std::size_t matter = 0; matter < 2; ++matter)
        to.scatters[matter] = sum.shares[matter] > kNegligible * sum.whole;
      for (std::size_t matter = 0; matter < 2; ++matter) {
        for (std::size_t c = 0; c < 3; ++c) {
          const double others = to.scatters[1 - matter] ? 0.0 : sum.weights[1 - matter][c];
          to.weights[matter][c] = to.scatters[matter] ? static_cast<float>(sum.weights[matter][c] + others) : 0.0F;
        }
      }
    }
  }
  return panels_;
}

namespace {

SourceSample sample_of(const ScatteringPanel& panel, const ScatteringSource& source) noexcept {
  const auto height = static_cast<std::size_t>(panel.height);
  SourceSample sample{};
  sample.start_ratio = panel.start_ratio;
  sample.distance_ratio = panel.distance_ratio;
  sample.view_cosine = panel.view_cosine;
  // Linear in height. Brightness is mixed with the same shares, so that at a node of suns the source is the mix of both
  // heights'.
  const float shares[2] = {1.0F - panel.height_fraction, panel.height_fraction};
  for (std::size_t k = 0; k < 2; ++k) {
    sample.steps[k] = source.steps.data() + (height + k) * source.shape.sun_steps();
    sample.step_weights[k] = shares[k];
  }
  return sample;
}

void add_molecules(const ScatteringPanel& panel, const ScatteringSource& source, SourceSample& sample) noexcept {
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t height = static_cast<std::size_t>(panel.height) + k;
    sample.molecules[k] = source.rayleigh.data() + height * source.shape.molecule_row();
    for (std::size_t c = 0; c < 3; ++c) {
      sample.molecule_weights[k][c] = sample.step_weights[k] * panel.weights[kRayleigh][c];
    }
  }
}

void add_images(const ScatteringPanel& panel, const ScatteringSource& source, SourceSample& sample) noexcept {
  const auto zeniths = static_cast<std::size_t>(source.shape.zeniths);
  const float shares[2] = {1.0F - panel.zenith_fraction, panel.zenith_fraction};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t row =
        (static_cast<std::size_t>(panel.height) + k / 2) * zeniths + static_cast<std::size_t>(panel.zenith) + k % 2;
    sample.images[k] = source.aerosol.data() + row * 4 * source.shape.image();
    for (std::size_t c = 0; c < 3; ++c) {
      sample.weights[k][c] = sample.step_weights[k / 2] * shares[k % 2] * panel.weights[kAerosol][c];
    }
  }
  sample.count = 4;
}

}  // namespace

RayLight::Scattered RayLight::scattered(const SolverKernels& kernels, std::span<const ScatteringPanel> panels,
                                        const ScatteringSource& source, const SunAxis& axis) noexcept {
  const auto aerosol = [](const ScatteringPanel& panel) { return panel.scatters[kAerosol]; };
  if (std::any_of(panels.begin(), panels.end(), aerosol)) {
    kernels.place_angles(angle_cosine_.data(), static_cast<int>(padded_), source.shape.angles, source.shape.suns,
                         row_.data(), row_fraction_.data());
  }
  const bool apart = source.glow.any();
  const auto size = static_cast<int>(source.shape.image());
  const auto add = [&](bool molecules, bool images, float* sums) {
    std::fill_n(sums, 8 * padded_, 0.0F);
    for (const ScatteringPanel& panel : panels) {
      SourceSample sample = sample_of(panel, source);
      if (molecules && panel.scatters[kRayleigh]) add_molecules(panel, source, sample);
      if (images && panel.scatters[kAerosol]) add_images(panel, source, sample);
      kernels.add_source(sample, axis, size, suns(), scratch_.data(), sums);
    }
    fold_pairs(sums);
  };
  add(true, !apart, sums_.data());
  if (!apart) return {sums_.data(), nullptr};
  float* const aerosols = sums_.data() + 4 * padded_;
  add(false, true, aerosols);
  multiply_glow(source.glow, aerosols);
  return {sums_.data(), aerosols};
}

// [padded][2][4] to [padded][4]: the shares of the nearer and the farther node of suns are added up only here
// (`add_source`).
void RayLight::fold_pairs(float* sums) const noexcept {
  for (std::size_t i = 0; i < padded_; ++i) {
    for (std::size_t c = 0; c < 4; ++c) sums[4 * i + c] = sums[8 * i + c] + sums[8 * i + 4 + c];
  }
}

}  // namespace welkin::sky
