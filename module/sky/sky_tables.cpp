#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "jobs/stopwatch.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "sky/air.h"
#include "sky/aureole.h"
#include "sky/ray_light.h"
#include "sky/ray_nodes.h"
#include "sky/scattering_solver.h"
#include "sky/sky_geometry.h"
#include "sky/spectrum.h"
#include "sky/table_mapping.h"
#include "sky/table_sizes.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin {
namespace {

constexpr double kNotedDoubt = 5e-3;  ///< doubt of further orders that is reported, as a fraction of all light

using sky::AirModel;
using sky::PerConstituent;
using sky::Ray;
using sky::TableMapping;
using sky::WavelengthGroup;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Node k of n, from 0 to 1.
double coordinate(std::size_t k, int nodes) { return static_cast<double>(k) / (nodes - 1); }

/// Rounds to a float of a table: nothing negative, nothing that is not finite.
float stored(double value) {
  if (!(value > 0.0)) return 0.0F;
  return static_cast<float>(std::min(value, static_cast<double>(std::numeric_limits<float>::max())));
}

/// How three wavelengths become the tables' channels: as they are, or folded to colours.
struct Fold {
  double weights[3][3];  ///< [channel][wavelength]
};

// Channel c of the tables is Sum_k weights[c][k] light_k over the wavelengths of all groups. Wavelengths do not mix,
// and colours are linear in the spectrum: each group of three is solved by itself and added to the colours. In a group
// that lacks wavelengths the last one is computed again (`wavelength_group`), with weights of 0.
Fold fold_of(const std::vector<glm::dvec3>& weights, std::size_t group) {
  Fold fold{};
  for (std::size_t k = 0; k < 3 && 3 * group + k < weights.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) fold.weights[c][k] = weights[3 * group + k][static_cast<glm::length_t>(c)];
  }
  return fold;
}

/// One computation of tables.
class Precomputation {
 public:
  Precomputation(const Atmosphere& atmosphere, const SkyTableOptions& options, const Control& control)
      : options_(options),
        air_(atmosphere),
        mapping_(sky::mapping_of(atmosphere, options)),
        control_(control),
        spectral_(options.colour == SkyColour::spectral),
        weights_(sky::channel_weights(atmosphere, options.colour)),
        groups_((weights_.size() + 2) / 3),
        source_shape_(sky::source_shape(options, air_, mapping_)),
        colours_(atmosphere, options.colour),
        aureole_(atmosphere, colours_.asymmetries(), options) {
    for (std::size_t k = 0; k < index(options.sun_zeniths); ++k) {
      suns_.push_back(mapping_.sun_zenith_cosine(coordinate(k, options.sun_zeniths)));
    }
    for (int h = 0; aureole_.glows() && h < options.heights; ++h) {
      const double altitude = mapping_.altitude(coordinate(index(h), options.heights));
      glow_depths_.push_back(
          sky::aureole_depths(atmosphere, options, colours_, mapping_, altitude, options.sun_zeniths));
    }
    result_.atmosphere = atmosphere;
    result_.options = options;
  }

  /// Transmittance, and all else between tables.
  SkyTables between(std::span<const SkyTables> tables, std::span<const double> weights) {
    transmittance();
    mix(tables, weights, &SkyTables::scattering);
    mix(tables, weights, &SkyTables::single_mie);
    mix(tables, weights, &SkyTables::irradiance);
    for (const SkyTables& table : tables) {
      result_.orders = std::max(result_.orders, table.orders);
      result_.last_change = std::max(result_.last_change, table.last_change);
    }
    return std::move(result_);
  }

  SkyTables run() {
    transmittance();
    timed("sun paths", "lengths to the sun, of no wavelength", [&] {
      paths_ = std::make_unique<sky::SunPaths>(air_, mapping_, sky::sun_path_size(options_, air_, mapping_),
                                               part(0.02, 0.06));
    });
    const std::size_t texels = sky::scattering_texels(options_);
    result_.scattering.assign(4 * texels, 0.0F);
    result_.single_mie.assign(sky::single_mie_floats(result_.atmosphere, options_), 0.0F);
    irradiance_.assign(sky::irradiance_floats(options_), 0.0);
    for (std::size_t group = 0; group < groups_; ++group) {
      const double share = 0.94 / static_cast<double>(groups_);
      const double from = 0.06 + share * static_cast<double>(group);
      compute(group, from, group + 1 == groups_ ? 1.0 : from + share);
    }
    if (!spectral_) clip();
    result_.irradiance.resize(irradiance_.size());
    std::transform(irradiance_.begin(), irradiance_.end(), result_.irradiance.begin(), stored);
    return std::move(result_);
  }

 private:
  [[nodiscard]] Control part(double from, double to) const { return jobs::part_of(control_, from, to); }

  template <class Work>
  void timed(const char* name, const std::string& reason, const Work& work) {
    const jobs::Stopwatch watch;
    work();
    result_.passes.push_back({name, PassAction::run, reason, watch.milliseconds()});
  }

  void mix(std::span<const SkyTables> tables, std::span<const double> weights, std::vector<float> SkyTables::*floats);
  void transmittance();
  void compute(std::size_t group, double from, double to);
  void scatter(const WavelengthGroup& group, const Fold& fold, const sky::Sunlight& light,
               const sky::SourceSolver& solver, const Control& control);
  void scatter_ray(const WavelengthGroup& group, const Fold& fold, const sky::Sunlight& light,
                   const sky::SourceSolver& solver, std::size_t ray, sky::RayLight& worker);
  void store(const WavelengthGroup& group, const Fold& fold, const float* once, const sky::RayLight::Scattered* often,
             std::size_t texel, std::size_t i, double nu);
  [[nodiscard]] double glow_factor(std::size_t texel, std::size_t channel, double nu, bool once) const;
  void add_irradiance(const Fold& fold, const sky::SourceSolver& solver);
  void add_straight_light(const WavelengthGroup& scaled, const WavelengthGroup& whole, const Fold& fold);
  void clip();

  SkyTableOptions options_;
  AirModel air_;
  TableMapping mapping_;
  const Control& control_;
  bool spectral_;                    ///< three wavelengths as they are
  std::vector<glm::dvec3> weights_;  ///< of the wavelengths in the channels
  std::size_t groups_;               ///< of three wavelengths
  std::vector<double> suns_;         ///< zenith cosines of the table's
  sky::SourceShape source_shape_;
  sky::ColourFold colours_;
  sky::Aureole aureole_;
  std::vector<std::vector<std::array<double, 3>>> glow_depths_;  ///< [heights][suns]; empty: no glow
  std::unique_ptr<sky::SunPaths> paths_;
  std::vector<double> irradiance_;
  SkyTables result_;
};

// Light over a ground of albedo A is a series in A: what the ground has reflected n times is A^n times a term that
// falls with n as light is lost to space. A polynomial through tables at n albedos is exact to A^(n - 1).
void Precomputation::mix(std::span<const SkyTables> tables, std::span<const double> weights,
                         std::vector<float> SkyTables::*floats) {
  constexpr std::size_t kTile = 16'384;
  std::vector<float>& mixed = result_.*floats;
  mixed.resize((tables.front().*floats).size());
  jobs::run_tiles((mixed.size() + kTile - 1) / kTile, jobs::Placement::arena,
                  jobs::worker_count(jobs::Placement::arena), {}, [&](std::size_t tile, std::size_t) {
                    for (std::size_t i = tile * kTile; i < std::min(mixed.size(), (tile + 1) * kTile); ++i) {
                      double sum = 0.0;
                      for (std::size_t k = 0; k < tables.size(); ++k) {
                        sum += weights[k] * static_cast<double>((tables[k].*floats)[i]);
                      }
                      mixed[i] = stored(sum);
                    }
                  });
}

void Precomputation::transmittance() {
  const std::size_t zeniths = index(options_.transmittance_zeniths);
  result_.transmittance.resize(sky::transmittance_floats(options_));
  const auto texel = [&](const PerConstituent& lengths, float* rgb) {
    std::array<double, sky::kMaxWavelengths> through{};
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      through[i] = math::exponential(-sky::optical_depth(air_.extinctions(i), lengths));
    }
    // A colour's transmittance is Sum_i w_i S_i T_i / Sum_i w_i S_i, S the sun's spectrum: sunlight times it is the
    // colour of what arrives. Some weights of sRGB are negative, so that the quotient may leave [0, 1] and is held to
    // it.
    const glm::dvec3 seen = spectral_ ? glm::dvec3(through[0], through[1], through[2])
                                      : colours_.share(std::span(through).first(weights_.size()));
    for (glm::length_t c = 0; c < 3; ++c) rgb[c] = stored(std::min(seen[c], 1.0));
  };
  timed("transmittance", "along every ray to the top", [&] {
    std::vector<Ray> rays;
    for (std::size_t h = 0; h < index(options_.transmittance_heights); ++h) {
      const double altitude = mapping_.altitude(coordinate(h, options_.transmittance_heights));
      for (std::size_t k = 0; k < zeniths; ++k) {
        rays.push_back(mapping_.transmittance_ray(altitude, coordinate(k, options_.transmittance_zeniths)));
      }
    }
    const auto lengths = sky::lengths_of(air_, std::move(rays), part(0.0, 0.02));
    jobs::run_tiles(index(options_.transmittance_heights), jobs::Placement::arena,
                    jobs::worker_count(jobs::Placement::arena), {}, [&](std::size_t tile, std::size_t) {
                      for (std::size_t k = tile * zeniths; k < (tile + 1) * zeniths; ++k) {
                        texel(lengths->amounts[k], result_.transmittance.data() + 3 * k);
                      }
                    });
  });
}

void Precomputation::compute(std::size_t group, double from, double to) {
  const std::vector<double> forward = sky::forward_shares(air_.atmosphere(), options_.orders);
  const WavelengthGroup wavelengths = sky::wavelength_group(air_, group, forward);
  const Fold fold = fold_of(weights_, group);
  const sky::Sunlight light(air_, *paths_, wavelengths.extinctions);
  const double middle = from + 0.5 * (to - from);
  sky::SourceSolver solver(air_, mapping_, light, wavelengths, source_shape_);
  timed("orders", "what each order of scattering leaves for the next, and what reaches the ground", [&] {
    solver.solve({.orders = options_.orders,
                  .convergence_threshold = options_.convergence_threshold,
                  .rest = !options_.truncate_orders},
                 part(from, middle));
  });
  if (solver.doubt() > kNotedDoubt) {
    result_.passes.back().reason += "; what further orders add may be wrong by " +
                                    std::to_string(std::lround(100.0 * solver.doubt())) +
                                    " % of all light: compute more orders";
  }
  timed("scattering", "along every ray of the table", [&] {
    scatter(wavelengths, fold, light, solver, part(middle, to));
    add_irradiance(fold, solver);
    if (*std::max_element(forward.begin(), forward.end()) > 0.0) {
      add_straight_light(wavelengths, sky::wavelength_group(air_, group, {}), fold);
    }
  });
  result_.orders = std::max(result_.orders, solver.orders());
  result_.last_change = std::max(result_.last_change, solver.last_change());
}

void Precomputation::scatter(const WavelengthGroup& group, const Fold& fold, const sky::Sunlight& light,
                             const sky::SourceSolver& solver, const Control& control) {
  const std::size_t workers = jobs::worker_count(jobs::Placement::arena);
  const std::size_t count = index(sky::angles_of(options_)) * index(options_.sun_zeniths);
  std::vector<sky::RayLight> scratch;
  for (std::size_t i = 0; i < workers; ++i) scratch.emplace_back(air_, source_shape_, count);
  // Rays of about one zenith angle see the same images of the source: one after the other they find them in the
  // cache.
  const std::size_t heights = index(options_.heights);
  const std::size_t views = index(options_.view_zeniths);
  jobs::run_tiles(heights * views, jobs::Placement::arena, workers, control, [&](std::size_t tile, std::size_t worker) {
    const std::size_t ray = tile % heights * views + tile / heights;
    scatter_ray(group, fold, light, solver, ray, scratch[worker]);
  });
}

// Compact tables have no azimuth: theirs is that at right angles to the sun's.
// cos(azimuth) = 0 there, so that nu = mu mu_s.
void Precomputation::scatter_ray(const WavelengthGroup& group, const Fold& fold, const sky::Sunlight& light,
                                 const sky::SourceSolver& solver, std::size_t ray, sky::RayLight& worker) {
  const int angles = sky::angles_of(options_);
  const std::size_t suns = index(options_.sun_zeniths);
  const double altitude = mapping_.altitude(coordinate(ray / index(options_.view_zeniths), options_.heights));
  const Ray view =
      mapping_.view_ray(altitude, static_cast<double>(ray % index(options_.view_zeniths)), options_.view_zeniths);
  for (std::size_t k = 0; k < suns; ++k) {
    const double sun = suns_[k];
    for (int a = 0; a < angles; ++a) {
      const double nu = angles > 1 ? mapping_.angle_cosine(view.zenith_cosine, sun, coordinate(index(a), angles))
                                   : view.zenith_cosine * sun;
      worker.set_sun(index(a) * suns + k, sun, nu);
    }
  }
  worker.place(air_, view, group);
  const sky::SolverKernels& kernels = sky::solver_kernels();
  // the sums of one are overwritten by those of the other: sunlight first, and stored
  const float* sums = worker.sunlight(kernels, air_, light);
  for (std::size_t i = 0; i < worker.count(); ++i) {
    store(group, fold, sums, nullptr, ray * worker.count() + i, i, worker.angle_cosine(i));
  }
  if (!solver.any()) return;
  const sky::RayLight::Scattered often = worker.scattered(kernels, worker.panels(air_, group, source_shape_, mapping_),
                                                          solver.source(), sky::sun_axis(mapping_, source_shape_.suns));
  for (std::size_t i = 0; i < worker.count(); ++i) {
    store(group, fold, nullptr, &often, ray * worker.count() + i, i, worker.angle_cosine(i));
  }
}

void Precomputation::store(const WavelengthGroup& group, const Fold& fold, const float* once,
                           const sky::RayLight::Scattered* often, std::size_t texel, std::size_t i, double nu) {
  // Lookups multiply rgb by Rayleigh's phase function and the aerosol's by its own. Sunlight that was scattered once is
  // stored without them: solar irradiance x coefficient x the integral of `RayLight::sunlight`, metres. Radiance of
  // further orders is divided by Rayleigh's, which is nowhere below 3 / (16 pi), and so comes back as it was at a node.
  double rayleigh[3];
  double mie[3]{};
  const bool glows = !glow_depths_.empty();
  for (std::size_t k = 0; k < 3; ++k) {
    if (once != nullptr) {
      rayleigh[k] = group.solar[k] * group.rayleigh[k] * static_cast<double>(once[8 * i + k]);
      mie[k] = group.solar[k] * group.aerosol_once[k] * static_cast<double>(once[8 * i + 4 + k]);
    } else {
      const auto aerosol = often->aerosol != nullptr ? static_cast<double>(often->aerosol[4 * i + k]) : 0.0;
      rayleigh[k] = (static_cast<double>(often->light[4 * i + k]) + (glows ? 0.0 : aerosol)) / sky::rayleigh_phase(nu);
      if (glows) mie[k] = aerosol;
    }
  }
  float* const rgba = result_.scattering.data() + 4 * texel;
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0.0;
    double mie_sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      sum += fold.weights[c][k] * rayleigh[k];
      mie_sum += fold.weights[c][k] * mie[k];
    }
    // folded colours may be negative until all wavelengths are in
    rgba[c] = spectral_ ? stored(static_cast<double>(rgba[c]) + sum) : rgba[c] + static_cast<float>(sum);
    if (once == nullptr && !glows) continue;
    if (glows) mie_sum *= glow_factor(texel, c, nu, once != nullptr);
    const float mie_value = spectral_ ? stored(mie_sum) : static_cast<float>(mie_sum);
    if (c == 0) rgba[3] += mie_value;
    if (!result_.single_mie.empty()) result_.single_mie[4 * texel + c] += mie_value;
  }
}

// Factor that makes the aerosol's light relative to the glow: light without its phase function, or radiance.
// Tables of a glow are looked up as stored x P x (S / P), P the phase function and S the glow (`factors.glow` is S / P,
// `factors.once` is (P + D) / P). Single scattering m is to be seen as m (P + D): stored = m `once` / `glow`. A
// radiance L is to be seen as it is: stored = L / (`glow` P).
double Precomputation::glow_factor(std::size_t texel, std::size_t channel, double nu, bool once) const {
  const std::size_t suns = index(options_.sun_zeniths);
  const std::size_t height = texel / (suns * index(options_.sun_angles) * index(options_.view_zeniths));
  const sky::Aureole::Factors factors = aureole_.factors(channel, nu, glow_depths_[height][texel % suns][channel]);
  if (once) return factors.once / factors.glow;
  const double g = colours_.asymmetries()[channel];
  return 1.0 / (factors.glow * sky::aerosol_phase(air_.atmosphere().aerosol_phase, g, nu));
}

// Between the solver's heights: cubic; between its suns: as light falls.
// In steps of `kSunSteps` per node the logarithm's cubic is followed by straight lines to 1.3e-4 (sky_geometry.h);
// the two nearest steps are read for each of the table's suns.
void Precomputation::add_irradiance(const Fold& fold, const sky::SourceSolver& solver) {
  const sky::SourceShape& shape = source_shape_;
  const std::size_t suns = index(options_.irradiance_sun_zeniths);
  const int steps = (shape.suns - 1) * sky::kSunSteps;
  std::vector<std::vector<float>> curves;
  for (std::size_t row = 0; row < 3 * index(shape.heights); ++row) {
    curves.push_back(
        sky::resample_log_cubic(std::span(solver.irradiance()).subspan(row * index(shape.suns), index(shape.suns))));
  }
  std::vector<double> positions;
  for (std::size_t s = 0; s < suns; ++s) {
    const double cosine = mapping_.sun_zenith_cosine(coordinate(s, options_.irradiance_sun_zeniths));
    positions.push_back(mapping_.smooth_sun_coordinate(cosine) * steps);
  }
  for (std::size_t h = 0; h < index(options_.irradiance_heights); ++h) {
    const sky::Cubic height =
        sky::cubic_at(sky::source_height(shape, coordinate(h, options_.irradiance_heights)), shape.heights);
    for (std::size_t s = 0; s < suns; ++s) {
      const double sun = positions[s];
      const std::size_t left = std::min(static_cast<std::size_t>(sun), index(steps - 1));
      double irradiance[3]{};
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < 4; ++i) {
          const std::vector<float>& curve = curves[(index(height.first) + i) * 3 + c];
          const auto low = static_cast<double>(curve[left]);
          const auto high = static_cast<double>(curve[left + 1]);
          irradiance[c] += height.weights[i] * (low + (sun - static_cast<double>(left)) * (high - low));
        }
        irradiance[c] = std::max(0.0, irradiance[c]);
      }
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t k = 0; k < 3; ++k) {
          irradiance_[3 * (h * suns + s) + c] += fold.weights[c][k] * irradiance[k];
        }
      }
    }
  }
}

// Sunlight that the aerosol turns by so little that the solver counts it as direct: on the ground it is the sky's.
// Delta-M's direct light is attenuated by the scaled depth tau' = tau - f tau_s and holds what the peak of the lobe
// sends on. Sunlight on the ground is tabulated with the whole depth tau, so that mu_s solar (exp(-tau') - exp(-tau))
// on level ground is in neither.
void Precomputation::add_straight_light(const WavelengthGroup& scaled, const WavelengthGroup& whole, const Fold& fold) {
  sky::RayPanels panels(air_);
  for (std::size_t h = 0; h < index(options_.irradiance_heights); ++h) {
    const double altitude = mapping_.altitude(coordinate(h, options_.irradiance_heights));
    for (std::size_t s = 0; s < index(options_.irradiance_sun_zeniths); ++s) {
      const double cosine = mapping_.sun_zenith_cosine(coordinate(s, options_.irradiance_sun_zeniths));
      if (!(cosine > 0.0)) continue;
      const double length = sky::distance_to_top(air_.bottom_radius(), air_.thickness(), altitude, cosine);
      const PerConstituent lengths = sky::lengths_along(air_, {altitude, cosine, false, length}, panels);
      const double level = cosine * sky::SettingSun(air_.atmosphere(), altitude).visible_share(cosine);
      for (std::size_t k = 0; k < 3; ++k) {
        const double straight = math::exponential(-sky::optical_depth(scaled.extinctions[k], lengths)) -
                                math::exponential(-sky::optical_depth(whole.extinctions[k], lengths));
        for (std::size_t c = 0; c < 3; ++c) {
          irradiance_[3 * (h * index(options_.irradiance_sun_zeniths) + s) + c] +=
              fold.weights[c][k] * level * scaled.solar[k] * straight;
        }
      }
    }
  }
}

// Colours that no light of linear sRGB makes become the nearest that it does.
void Precomputation::clip() {
  for (float& value : result_.scattering) value = stored(static_cast<double>(value));
  for (float& value : result_.single_mie) value = stored(static_cast<double>(value));
}

/// Returns the weights at `position` of the polynomial through values at `positions` (Lagrange):
/// w_k = Prod_(i != k) (x - x_i) / (x_k - x_i). Equal positions divide by 0, which the test below finds.
std::vector<double> polynomial_weights(std::span<const double> positions, double position) {
  std::vector<double> weights;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    double weight = 1.0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (i != k) weight *= (position - positions[i]) / (positions[k] - positions[i]);
    }
    if (!std::isfinite(weight)) {
      throw Error(ErrorCode::invalid_argument, "places of tables must be finite, and no two of them the same");
    }
    weights.push_back(weight);
  }
  return weights;
}

}  // namespace

SkyTables precompute_sky(const Atmosphere& atmosphere, const SkyTableOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;                      // for what is computed outside of tiles
  const std::uint64_t bytes = sky::sky_table_bytes(atmosphere, options);  // checks both
  if (bytes > options.memory_limit_bytes) {
    throw Error(ErrorCode::limit_exceeded, "the sky tables need " + std::to_string(bytes) + " bytes, the limit is " +
                                               std::to_string(options.memory_limit_bytes) +
                                               ": use smaller tables or raise memory_limit_bytes");
  }
  jobs::throw_if_cancelled(control);
  static_cast<void>(sky::solver_kernels());  // a process's first choice of them allocates: not inside a tile
  return Precomputation(atmosphere, options, control).run();
}

SkyTables interpolate_sky(const Atmosphere& atmosphere, std::span<const SkyTables> tables,
                          std::span<const double> positions, double position, const Control& control) {
  const platform::FloatingPointScope floating_point;
  if (tables.empty() || positions.size() != tables.size()) {
    throw Error(ErrorCode::invalid_argument, "interpolate_sky got " + std::to_string(tables.size()) + " tables and " +
                                                 std::to_string(positions.size()) +
                                                 " places; pass a place for each table");
  }
  const SkyTableOptions& options = tables.front().options;
  static_cast<void>(sky::sky_table_bytes(atmosphere, options));  // checks both
  for (const SkyTables& table : tables) {
    const Atmosphere& air = table.atmosphere;
    if (!(table.options == options) || air.bottom_radius_m != atmosphere.bottom_radius_m ||
        air.top_radius_m != atmosphere.top_radius_m || air.wavelengths_nm != atmosphere.wavelengths_nm ||
        table.single_mie.size() != sky::single_mie_floats(atmosphere, options)) {
      throw Error(ErrorCode::invalid_argument,
                  "interpolate_sky needs tables with the same options, and of atmospheres with the same radii, "
                  "wavelengths and constituents");
    }
  }
  const std::vector<double> weights = polynomial_weights(positions, position);
  jobs::throw_if_cancelled(control);
  return Precomputation(atmosphere, options, control).between(tables, weights);
}

}  // namespace welkin
