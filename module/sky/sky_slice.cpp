#include "sky/sky_slice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "math/elementary.h"
#include "math/quadrature.h"
#include "sky/air.h"
#include "sky/ray_nodes.h"
#include "sky/sky_geometry.h"
#include "sky/sky_kernels.h"
#include "sky/sunlight.h"
#include "sky/table_sizes.h"

namespace welkin::sky {
namespace {

CubicTaps taps_at(double position, int count) noexcept {
  const Cubic cubic = cubic_at(position, count);
  CubicTaps taps{cubic.first, std::clamp(static_cast<int>(position) - cubic.first, 0, 2), {}};
  for (int i = 0; i < 4; ++i) taps.weights[i] = static_cast<float>(cubic.weights[i]);
  return taps;
}

/// Inverts the length of an interval; 0 for one that is empty, on the ground or at the top: positions there are all 0.
double inverse_or_0(double value) noexcept { return value > 0.0 ? 1.0 / value : 0.0; }

}  // namespace

SkySlice::SkySlice(std::shared_ptr<const SkyTables> tables, double altitude_m, const SkyViewOptions& options)
    : tables_(std::move(tables)),
      altitude_(altitude_m),
      outside_(altitude_m > tables_->atmosphere.top_radius_m - tables_->atmosphere.bottom_radius_m),
      mapping_(mapping_of(*tables_)),
      inside_(outside_ ? mapping_.thickness() : altitude_m),
      fold_(tables_->atmosphere, tables_->options.colour),
      aureole_(tables_->atmosphere, fold_.asymmetries(), tables_->options),
      night_(*tables_, inside_) {
  const SliceShape shape = slice_shape(tables_->options);
  views_ = shape.views;
  azimuths_ = shape.azimuths;
  suns_ = shape.suns;
  values_ = slice_rows(*tables_, mapping_, fold_, inside_);
  set_brightness();
  if (aureole_.any() && !outside_) {
    aureole_depths_ = sky::aureole_depths(tables_->atmosphere, tables_->options, fold_, mapping_, inside_, suns_);
  }
  ground_ = ground_radiances(*tables_, mapping_, fold_);
  if (options.ground) reach_ = ground_reach(*tables_, mapping_, fold_, inside_, views_ / 2);
}

ViewLookup SkySlice::view_lookup(double mu) const noexcept {
  const double bottom = mapping_.bottom_radius();
  const int half = views_ / 2;
  ViewLookup point;
  point.ground = meets_ground(bottom, inside_, mu);
  const double position = mapping_.view_position(inside_, mu, point.ground, views_);
  // Either half of the nodes is an axis of its own: no cubic reads across the horizon, where radiance jumps.
  point.taps = taps_at(point.ground ? position : position - half, half);
  if (point.ground) {
    point.distance = distance_to_ground(bottom, inside_, mu);
    for (std::size_t c = 0; c < 3 && !reach_.empty(); ++c) {
      float sum = 0.0F;
      for (int i = 0; i < 4; ++i) {
        sum += point.taps.weights[i] * reach_[static_cast<std::size_t>(4 * (point.taps.first + i)) + c];
      }
      point.transmittance[c] = std::clamp(sum, 0.0F, 1.0F);
    }
  } else {
    point.taps.first += half;
  }
  return point;
}

CubicTaps SkySlice::azimuth_taps(double cosine, double mu_s) const noexcept {
  return taps_at(mapping_.azimuth_coordinate(cosine, mu_s) * (azimuths_ - 1), azimuths_);
}

void SkySlice::azimuth_taps(std::span<const double> cosines, double mu_s, CubicTaps* taps) const noexcept {
  // The bend q belongs to the sun: it is computed once for all azimuths. Weights are those of `cubic_at`, multiplied
  // out.
  const double bend = mapping_.azimuth_bend(mu_s);
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    const double position = TableMapping::bent_azimuth(cosines[i], bend) * (azimuths_ - 1);
    const int node = static_cast<int>(position);
    const int first = std::clamp(node - 1, 0, azimuths_ - 4);
    const auto x0 = static_cast<float>(position - first);
    const float x1 = x0 - 1.0F;
    const float x2 = x0 - 2.0F;
    const float x3 = x0 - 3.0F;
    taps[i].first = first;
    taps[i].between = std::clamp(node - first, 0, 2);
    taps[i].weights[0] = x1 * (x2 * x3) * (-1.0F / 6.0F);
    taps[i].weights[1] = x0 * (x2 * x3) * 0.5F;
    taps[i].weights[2] = (x0 * x1) * x3 * -0.5F;
    taps[i].weights[3] = (x0 * x1) * x2 * (1.0F / 6.0F);
  }
}

// The mean over views is all that a ratio between suns needs; its scale is divided out again (sky_geometry.h).
void SkySlice::set_brightness() {
  const auto suns = static_cast<std::size_t>(suns_);
  std::vector<double> sums(suns);
  for (std::size_t i = 0; i < values_.size(); ++i) sums[i / kSkyRow % suns] += static_cast<double>(values_[i]);
  limit_decay(sums);
  brightness_ = resample_log_cubic(sums);
}

std::array<double, 3> SkySlice::aureole_depths(double mu_s) const noexcept {
  if (aureole_depths_.empty()) return {};
  const auto [node, part] = between(mapping_.sun_coordinate(mu_s) * (suns_ - 1), suns_);
  std::array<double, 3> depths{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double low = aureole_depths_[node][c];
    depths[c] = low + part * (aureole_depths_[node + 1][c] - low);
  }
  return depths;
}

SunLookup SkySlice::sun_lookup(double mu_s) const noexcept {
  const double position = mapping_.sun_coordinate(mu_s) * (suns_ - 1);
  SunLookup point{.taps = {taps_at(position, suns_), {}}, .fade = static_cast<float>(sun_fade(*tables_, mu_s))};
  CubicTaps& cubic = point.taps.cubic;
  const int step = std::min(static_cast<int>(position * kSunSteps), (suns_ - 1) * kSunSteps - 1);
  const float* const near = brightness_.data() + step;
  const auto part = static_cast<float>(position * kSunSteps - step);
  const float brightness = near[0] + part * (near[1] - near[0]);
  float ratios[4];
  for (int i = 0; i < 4; ++i) {
    const float node = brightness_[static_cast<std::size_t>((cubic.first + i) * kSunSteps)];
    ratios[i] = std::min(node > 0.0F ? brightness / node : 1.0F, kMaxRatio);
    // Sum_i w_i B row_i / B_i: the ratio to the brightness here goes into the weights (SunTaps).
    cubic.weights[i] *= ratios[i];
  }
  point.taps.ratios[0] = ratios[cubic.between];
  point.taps.ratios[1] = ratios[cubic.between + 1];
  return point;
}

glm::dvec3 SkySlice::aerosol_phase(double nu) const noexcept {
  const auto phase = [&](double g) { return sky::aerosol_phase(tables_->atmosphere.aerosol_phase, g, nu); };
  const std::array<double, 3>& g = fold_.asymmetries();
  return {phase(g[0]), phase(g[1]), phase(g[2])};
}

glm::dvec3 SkySlice::ground_radiance(double mu_s) const noexcept {
  const double clamped = std::clamp(mu_s, -1.0, 1.0);
  const double root = clamped < 0.0 ? -std::sqrt(-clamped) : std::sqrt(clamped);
  const auto [node, t] = between(0.5 * (root + 1.0) * (kGroundNodes - 1), kGroundNodes);
  const float* const here = ground_.data() + 4 * node;
  glm::dvec3 rgb;
  for (int c = 0; c < 3; ++c) rgb[c] = (1.0 - t) * static_cast<double>(here[c]) + t * static_cast<double>(here[4 + c]);
  return rgb;
}

void SkySlice::view_rows(const CubicTaps& view, float* rows) const noexcept {
  const std::size_t count =
      std::size_t{kSkyRow} * static_cast<std::size_t>(azimuths_) * static_cast<std::size_t>(suns_);
  std::fill_n(rows, count, 0.0F);
  for (int i = 0; i < 4; ++i) {
    const float* const from = values_.data() + static_cast<std::size_t>(view.first + i) * count;
    for (std::size_t k = 0; k < count; ++k) rows[k] += view.weights[i] * from[k];
  }
}

SkyRun SkySlice::run(const glm::dvec3& sun) const noexcept {
  const double bottom = mapping_.bottom_radius();
  const double thickness = mapping_.thickness();
  const double rho = tangent_distance(bottom, inside_);
  const double longest = rho + mapping_.top_tangent();
  const double shortest = thickness - inside_;
  const int half = views_ / 2;
  const Atmosphere& air = tables_->atmosphere;
  const std::array<double, 3>& asymmetries = fold_.asymmetries();
  SkyRun run{};
  run.bottom = bottom;
  run.radius = bottom + inside_;
  run.altitude = inside_;
  run.rho_squared = inside_ * (2.0 * bottom + inside_);
  run.shell = std::max(0.0, shortest * (2.0 * bottom + thickness + inside_));
  run.shortest = shortest;
  // Positions of rays to the top are (d - shortest) (half - 1) / (longest - shortest), of rays to the ground
  // (half - 1) - (d - h) (half - 1) / (rho - h), each bent afterwards (TableMapping).
  run.to_sky = (half - 1) * inverse_or_0(longest - shortest);
  run.to_ground = (half - 1) * inverse_or_0(rho - inside_);
  run.view_bend = mapping_.view_bend();
  run.view_terms = mapping_.view_terms();
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
  run.sun_terms = mapping_.sun_terms();
  const SunLookup point = sun_lookup(run.sun_zenith);
  run.sun_taps = point.taps;
  run.brightness = brightness_.data();
  run.fade = point.fade;
  run.azimuth_terms = mapping_.azimuth_terms();
  run.azimuth_bend = mapping_.azimuth_bend(run.sun_zenith);
  run.half = half;
  run.azimuths = azimuths_;
  run.suns = suns_;
  run.rows = values_.data();
  run.henyey_greenstein = air.aerosol_phase == AerosolPhase::henyey_greenstein;
  run.lobes = all_equal(asymmetries) ? 1 : 3;
  for (std::size_t c = 0; c < 3; ++c) {
    const double g = asymmetries[c];
    run.asymmetry[c] = g;
    // The phase functions without their denominator and 1 + nu^2; (1 - g) (1 + g) keeps the digits of 1 - g^2 for g
    // near 1.
    run.aerosol_scale[c] = run.henyey_greenstein
                               ? (1.0 - g) * (1.0 + g) / (4.0 * std::numbers::pi)
                               : 3.0 / (8.0 * std::numbers::pi) * (1.0 - g) * (1.0 + g) / (2.0 + g * g);
  }
  run.hazy = !aureole_depths_.empty();
  if (run.hazy) aureole_.factors(aureole_depths(run.sun_zenith), run.aureole);
  run.reach = reach_.empty() ? nullptr : reach_.data();
  run.ground = ground_.data();
  run.grounds = kGroundNodes;
  run.night = night_.any() && !outside_ ? night_.nodes().data() : nullptr;
  run.night_lowest = night_.lowest();
  run.nights = kNightNodes;
  return run;
}

namespace {

/// Max ratio to the first channel. In channels that the compact layout leaves out, the aerosol's light is assumed to
/// have the colour of the molecules' (Bruneton and Neyret 2008, section 4: "C_M = C_*.rgb C_M.r / C_*.r ...").
constexpr double kMaxColourRatio = 1e4;

/// Weights of table rows along an axis: the rows from `first` on, `stride` apart.
struct Blend {
  Cubic cubic;
  int count;
};

Blend blend_at(double position, int count) { return {cubic_at(position, count), std::min(count, 4)}; }

/// Returns node `node` of a slice's axis among the tables' nodes. Its position on the shorter axis is linear:
/// node (table_nodes - 1) / (nodes - 1).
Blend node_of(int node, int nodes, int table_nodes) {
  if (nodes == table_nodes) return {{node, {1.0, 0.0, 0.0, 0.0}}, 1};
  return blend_at(static_cast<double>(node) * (table_nodes - 1) / (nodes - 1), table_nodes);
}

/// Returns that of a view's node, within its own half.
Blend view_of(int node, int nodes, int table_nodes) {
  const int half = nodes / 2;
  const int table_half = table_nodes / 2;
  Blend blend = node_of(node % half, half, table_half);
  if (node >= half) blend.cubic.first += table_half;
  return blend;
}

/// Per channel, the ratio of the aerosol's scattering to that of molecules, relative to the first channel; and that of
/// the aerosol alone where no molecules show its colour.
/// Single scattering by either kind of matter is its coefficient beta times nearly the same light, so that at one point
/// M_c / M_0 ~ (beta_M,c / beta_M,0) L_c / L_0 and R_c / R_0 ~ (beta_R,c / beta_R,0) L_c / L_0. Their quotient is
/// M_c = M_0 (R_c / R_0) (beta_M,c / beta_M,0) (beta_R,0 / beta_R,c).
struct AerosolColour {
  glm::dvec3 by_molecules{0.0};
  glm::dvec3 alone{0.0};

  AerosolColour(const Atmosphere& atmosphere, const ColourFold& fold) {
    const glm::dvec3 aerosol = fold.share(atmosphere.aerosol.scattering_per_m) * fold.sunlight();
    const glm::dvec3 rayleigh = fold.share(atmosphere.rayleigh.scattering_per_m) * fold.sunlight();
    for (int c = 0; c < 3; ++c) {
      if (!(aerosol[0] > 0.0)) continue;
      alone[c] = aerosol[c] / aerosol[0];
      by_molecules[c] = rayleigh[c] > 0.0 ? alone[c] * (rayleigh[0] / rayleigh[c]) : 0.0;
    }
  }

  void extrapolate(float* row) const {
    const auto first = static_cast<double>(row[4]);
    const auto red = static_cast<double>(row[0]);
    for (int c = 1; c < 3; ++c) {
      const double ratio =
          red > 0.0 && by_molecules[c] > 0.0 ? static_cast<double>(row[c]) / red * by_molecules[c] : alone[c];
      row[4 + c] = static_cast<float>(first * std::min(ratio, kMaxColourRatio));
    }
  }
};

/// Adds weight times `count` texels of one height.
void add_texels(const SkyTables& tables, std::size_t first, std::size_t count, float weight, float* rows) {
  const float* const scattering = tables.scattering.data() + 4 * first;
  const bool compact = tables.options.layout == ScatteringLayout::compact;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rows[kSkyRow * i + c] += weight * scattering[4 * i + c];
    if (compact) rows[kSkyRow * i + 4] += weight * scattering[4 * i + 3];
  }
  if (tables.single_mie.empty()) return;  // compact, or no aerosol
  const float* const mie = tables.single_mie.data() + 4 * first;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rows[kSkyRow * i + 4 + c] += weight * mie[4 * i + c];
  }
}

/// [view_zeniths][angles][sun_zeniths] rows at the altitude.
std::vector<float> rows_at(const SkyTables& tables, const TableMapping& mapping, const ColourFold& fold,
                           double altitude) {
  const SkyTableOptions& options = tables.options;
  const std::size_t count = static_cast<std::size_t>(options.view_zeniths) *
                            static_cast<std::size_t>(angles_of(options)) *
                            static_cast<std::size_t>(options.sun_zeniths);
  const Blend heights = blend_at(mapping.height_coordinate(altitude) * (options.heights - 1), options.heights);
  std::vector<float> rows(kSkyRow * count);
  for (int i = 0; i < heights.count; ++i) {
    const auto weight = static_cast<float>(heights.cubic.weights[i]);
    if (weight == 0.0F) continue;
    add_texels(tables, static_cast<std::size_t>(heights.cubic.first + i) * count, count, weight, rows.data());
  }
  // The cubic over heights may swing below 0 where light ends, at the edge of the planet's shadow.
  for (float& value : rows) value = value > 0.0F ? value : 0.0F;
  if (options.layout == ScatteringLayout::compact) {
    const AerosolColour colour(tables.atmosphere, fold);
    for (std::size_t i = 0; i < count; ++i) colour.extrapolate(rows.data() + kSkyRow * i);
  }
  return rows;
}

}  // namespace

SliceShape slice_shape(const SkyTableOptions& options) noexcept {
  return {2 * std::max(4, options.view_zeniths / 2), std::max(4, angles_of(options)), std::max(4, options.sun_zeniths)};
}

// Rows as the tables have them and, where there are fewer than a slice has, as it has them; what views, suns, the
// ground and the night add; and the aureole's tables.
std::uint64_t slice_bytes(const SkyTableOptions& options) noexcept {
  constexpr std::uint64_t kAureole = std::uint64_t{256} << 10U;
  const auto rows = [](int views, int azimuths, int suns) {
    return std::uint64_t{kSkyRow} * sizeof(float) * static_cast<std::uint64_t>(views) *
           static_cast<std::uint64_t>(azimuths) * static_cast<std::uint64_t>(suns);
  };
  const SliceShape shape = slice_shape(options);
  const int angles = angles_of(options);
  const bool continued =
      shape.views != options.view_zeniths || shape.azimuths != angles || shape.suns != options.sun_zeniths;
  const std::uint64_t first = continued ? rows(options.view_zeniths, angles, options.sun_zeniths) : 0;
  const std::uint64_t of_suns = static_cast<std::uint64_t>(shape.suns) * (8 * kSunSteps + 64);
  const std::uint64_t of_views = std::uint64_t{8} * static_cast<std::uint64_t>(shape.views);
  return rows(shape.views, shape.azimuths, shape.suns) + first + of_suns + of_views +
         16 * (kGroundNodes + std::uint64_t{kNightNodes}) + kAureole;
}

std::vector<float> slice_rows(const SkyTables& tables, const TableMapping& mapping, const ColourFold& fold,
                              double altitude) {
  const SkyTableOptions& options = tables.options;
  const SliceShape shape = slice_shape(options);
  const int angles = angles_of(options);
  std::vector<float> rows = rows_at(tables, mapping, fold, altitude);
  if (shape.views == options.view_zeniths && shape.azimuths == angles && shape.suns == options.sun_zeniths) {
    return rows;
  }
  std::vector<float> result;
  result.reserve(std::size_t{kSkyRow} * static_cast<std::size_t>(shape.views) *
                 static_cast<std::size_t>(shape.azimuths) * static_cast<std::size_t>(shape.suns));
  for (int v = 0; v < shape.views; ++v) {
    const Blend view = view_of(v, shape.views, options.view_zeniths);
    for (int a = 0; a < shape.azimuths; ++a) {
      const Blend azimuth = node_of(a, shape.azimuths, angles);
      for (int s = 0; s < shape.suns; ++s) {
        const Blend sun = node_of(s, shape.suns, options.sun_zeniths);
        double sums[kSkyRow]{};
        for (int i = 0; i < view.count; ++i) {
          for (int j = 0; j < azimuth.count; ++j) {
            for (int k = 0; k < sun.count; ++k) {
              const double weight = view.cubic.weights[i] * azimuth.cubic.weights[j] * sun.cubic.weights[k];
              const int texel = ((view.cubic.first + i) * angles + azimuth.cubic.first + j) * options.sun_zeniths +
                                sun.cubic.first + k;
              for (int c = 0; c < kSkyRow; ++c) {
                sums[c] += weight * static_cast<double>(rows[static_cast<std::size_t>(kSkyRow * texel + c)]);
              }
            }
          }
        }
        for (const double sum : sums) result.push_back(static_cast<float>(std::max(sum, 0.0)));
      }
    }
  }
  return result;
}

namespace {

double value_at(const std::vector<double>& values, std::size_t index) {
  return index < values.size() ? values[index] : 0.0;
}

std::vector<const Constituent*> matter_of(const Atmosphere& atmosphere) {
  std::vector<const Constituent*> matter{&atmosphere.rayleigh, &atmosphere.aerosol};
  for (const Constituent& absorber : atmosphere.absorbers) matter.push_back(&absorber);
  std::erase_if(matter, [](const Constituent* one) { return one->density.empty(); });
  return matter;
}

/// Altitudes from 0 to `altitude` between which every density is smooth. From each height where a density may jump or
/// bend, steps are the smallest scale height at first and grow by half from one to the next, as an exponential density
/// falls.
std::vector<double> panels_of(const std::vector<const Constituent*>& matter, double altitude) {
  double finest = altitude;
  std::vector<double> breaks{0.0, altitude};
  for (const Constituent* const one : matter) {
    for (const double point : density_breaks(one->density, altitude)) breaks.push_back(point);
    for (const DensityLayer& layer : one->density) {
      const double slope = std::abs(layer.exponential_scale_per_m);
      if (layer.exponential_term != 0.0 && slope * finest > 1.0) finest = 1.0 / slope;
    }
  }
  std::sort(breaks.begin(), breaks.end());
  std::vector<double> panels{0.0};
  for (std::size_t i = 1; i < breaks.size(); ++i) {
    double step = finest;
    while (panels.back() + 1.5 * step < breaks[i]) {
      panels.push_back(panels.back() + step);
      step *= 1.5;
    }
    if (breaks[i] > panels.back()) panels.push_back(breaks[i]);
  }
  return panels;
}

}  // namespace

std::vector<float> ground_radiances(const SkyTables& tables, const TableMapping& mapping, const ColourFold& fold) {
  std::vector<float> radiances(std::size_t{4} * kGroundNodes);
  const glm::dvec3 albedo = fold.share(tables.atmosphere.ground_albedo);
  const glm::dvec3 night = NightLight(tables, 0.0).irradiance();
  for (int node = 0; node < kGroundNodes; ++node) {
    const double root = 2.0 * node / (kGroundNodes - 1) - 1.0;
    // The inverse of root = sign(mu_s) sqrt|mu_s|.
    const double mu_s = root * std::abs(root);
    // A Lambertian ground under the irradiance E, sky, night and sun together, sends albedo E / pi in all directions.
    glm::dvec3 irradiance = sky_irradiance(tables, mapping, 0.0, mu_s) + night;
    if (mu_s > 0.0) irradiance += mu_s * fold.sunlight() * sun_share(tables, mapping, 0.0, mu_s);
    for (int c = 0; c < 3; ++c) {
      radiances[static_cast<std::size_t>(4 * node + c)] =
          static_cast<float>(albedo[c] * irradiance[c] * std::numbers::inv_pi);
    }
  }
  return radiances;
}

// Seen from where it ends, a ray of length d goes up with the cosine mu_g = (rho^2 - d^2) / (2 R d), and comes through
// an altitude whose tangent distance is u at s = sqrt((R mu_g)^2 + u^2) - R mu_g: smooth in u, the horizon's too.
// r^2 = R^2 + d^2 + 2 R d mu_g gives R mu_g = (rho^2 - d^2) / (2 d) = (rho - d) (rho + d) / (2 d) (`tangent`), and
// u^2 = s^2 + 2 R mu_g s the distance s. ds/du = u / sqrt((R mu_g)^2 + u^2) is at most 1, and 1 all along the horizon's
// ray (mu_g = 0), where ds/dh is infinite: so the nodes of one rule in u, whose densities are computed once, serve all
// rays.
// For mu_g > 0 the slope has poles at u = +-i R mu_g, which lie close to a panel that begins at the ground, or far
// below its end: there a rule of six nodes in u is wrong by up to 0.6 % of the length. Such panels are integrated over
// s for each ray: u^2 is a polynomial in s, and so the density is as smooth in s as it is in the altitude. Panels whose
// altitudes have a ratio below kWide = 3 span a ratio of sqrt(3) of u: poles next to the real axis at 0 lie (1.73 + 1)
// / (1.73 - 1) = 3.7 half widths from the middle, where six nodes are right to (3.7 + sqrt(3.7^2 - 1))^-12 = 4e-11.
std::vector<float> ground_reach(const SkyTables& tables, const TableMapping& mapping, const ColourFold& fold,
                                double altitude, int half) {
  constexpr int order = 6;
  constexpr double kWide = 3.0;
  const std::vector<double> forward = forward_shares(tables.atmosphere, tables.options.orders);  // goes straight on
  const Atmosphere& atmosphere = tables.atmosphere;
  const double bottom = atmosphere.bottom_radius_m;
  const std::vector<const Constituent*> matter = matter_of(atmosphere);
  const std::vector<double> panels = panels_of(matter, altitude);
  const math::GaussRule rule = math::gauss_legendre(order);
  struct Node {
    double u, weight;
    std::vector<double> densities;
  };
  std::vector<Node> nodes;
  struct Interval {
    double low, high;  // of u
  };
  std::vector<Interval> wide;
  for (std::size_t i = 1; i < panels.size(); ++i) {
    const double low = tangent_distance(bottom, panels[i - 1]);
    const double high = tangent_distance(bottom, panels[i]);
    if (panels[i] > kWide * panels[i - 1]) {
      wide.push_back({low, high});
      continue;
    }
    for (int k = 0; k < order; ++k) {
      const double u = low + 0.5 * (high - low) * (1.0 + rule.nodes[k]);
      Node node{u, 0.5 * (high - low) * rule.weights[k], {}};
      for (const Constituent* const one : matter) {
        node.densities.push_back(density(one->density, altitude_of_tangent(bottom, u)));
      }
      nodes.push_back(std::move(node));
    }
  }
  const double rho = tangent_distance(bottom, altitude);
  std::vector<float> reach(static_cast<std::size_t>(4 * half));
  std::vector<double> lengths(matter.size());
  std::vector<double> shares(atmosphere.wavelengths_nm.size());
  for (int k = 0; k < half; ++k) {
    const double distance = mapping.view_ray(altitude, k, 2 * half).length;
    const double tangent = distance > 0.0 ? std::max(0.0, 0.5 * (rho - distance) * (rho + distance) / distance) : 0.0;
    std::fill(lengths.begin(), lengths.end(), 0.0);
    // s = sqrt(tangent^2 + u^2) - tangent without cancellation
    const auto distance_of = [&](double u) {
      return u > 0.0 ? u * u / (tangent + std::sqrt(tangent * tangent + u * u)) : 0.0;
    };
    for (const Interval& panel : wide) {
      const double low = distance_of(panel.low);
      const double half_width = 0.5 * (distance_of(panel.high) - low);
      for (int n = 0; n < order; ++n) {
        const double s = low + half_width * (1.0 + rule.nodes[n]);
        const double above = altitude_of_tangent(bottom, std::sqrt(s * (s + 2.0 * tangent)));
        for (std::size_t i = 0; i < matter.size(); ++i) {
          lengths[i] += half_width * rule.weights[n] * density(matter[i]->density, above);
        }
      }
    }
    for (const Node& node : nodes) {
      const double slope = node.u / std::sqrt(tangent * tangent + node.u * node.u);
      for (std::size_t i = 0; i < matter.size(); ++i) lengths[i] += node.weight * slope * node.densities[i];
    }
    for (std::size_t w = 0; w < shares.size(); ++w) {
      double depth = 0.0;
      for (std::size_t i = 0; i < matter.size(); ++i) {
        const double straight = matter[i] == &atmosphere.aerosol ? forward[w] : 0.0;
        depth += lengths[i] * ((1.0 - straight) * value_at(matter[i]->scattering_per_m, w) +
                               value_at(matter[i]->absorption_per_m, w));
      }
      shares[w] = math::exponential(-depth);
    }
    const glm::dvec3 share = fold.share(shares);
    for (int c = 0; c < 3; ++c) reach[static_cast<std::size_t>(4 * k + c)] = static_cast<float>(share[c]);
  }
  return reach;
}

}  // namespace welkin::sky
