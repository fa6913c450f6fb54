#include "sky/aureole.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "math/basis.h"
#include "math/elementary.h"
#include "sky/air.h"
#include "sky/ray_nodes.h"
#include "sky/sky_geometry.h"

namespace welkin::sky {
namespace {

constexpr double kMinForwardShare = 1e-3;  ///< below, its effect is not visible
constexpr double kLastMoment = 1e-4;       ///< of f: moments below are dropped
constexpr std::size_t kDepths = 33;        ///< evenly spaced in x / (1 + x)
constexpr double kDeepest = 0.97;          ///< the last of them
constexpr double kShallow = 1e-4;
/// Deflected light takes longer paths: by this much times 1 - g. Found by trial: of HG 0.95 and depth 0.3, tables of 8
/// azimuths are then right to 4 % under a sun of 10 degrees, and to 2 % under one of 45.
constexpr double kLonger = 1.2;
constexpr double kThickestGlow = 4.0;  ///< tau, beyond which deflections are no longer small

// y = x / (1 + x) holds all depths in [0, 1): even where they are small, and 32 at the last node.
double depth_of(std::size_t node) {
  const double y = kDeepest * static_cast<double>(node) / (kDepths - 1.0);
  return y / (1.0 - y);
}

/// (exp(-x (1 - chi)) - exp(-x)) / x - chi, and its first term where x is small.
/// exp(-x) (exp(x chi) - 1) / x = (1 - x) (chi + x chi^2 / 2) + O(x^2) = chi - x chi + x chi^2 / 2.
double change(double x, double chi) {
  if (x < kShallow) return -x * chi * (1.0 - 0.5 * chi);
  return (math::exponential(-x * (1.0 - chi)) - math::exponential(-x)) / x - chi;
}

/// Returns chi_0 and on, until they are negligible against f.
/// g^l = kLastMoment f at l = log(kLastMoment f) / log(g); only forward lobes come here, 0 < g < 1.
std::vector<double> moments_of(const Atmosphere& atmosphere, double g, double forward) {
  const auto count = static_cast<int>(math::logarithm(kLastMoment * forward) / math::logarithm(g));
  return aerosol_moments(atmosphere, g, std::max(count, kNarrowBands + 1));
}

/// Returns (exp(tau chi) - 1) / (exp(tau) - 1), without the light that was deflected once.
double often(double tau, double chi) {
  if (tau < kShallow) return 0.5 * tau * chi * chi;
  return (math::exponential(tau * chi) - 1.0 - tau * chi) / (math::exponential(tau) - 1.0);
}

/// Returns the fraction of S that was deflected once.
double once(double tau) { return tau < kShallow ? 1.0 - 0.5 * tau : tau / (math::exponential(tau) - 1.0); }

/// tau of x.
double glow_depth(double depth, double g, double forward) {
  return std::min((1.0 + kLonger * (1.0 - g)) * depth / forward, kThickestGlow);
}

double band_factor(std::size_t l) { return (2.0 * static_cast<double>(l) + 1.0) / (4.0 * std::numbers::pi); }

/// The sum of the bands' moments, (2 l + 1) / (4 pi) m_l = moment(l, chi_l, depth's node), over P: [angles][depths].
/// Angles are even in the fourth root of (1 - cosine) / 2.
template <class Moment>
std::vector<double> over_phase(const Atmosphere& atmosphere, double g, double forward, const Moment& moment) {
  const std::vector<double> chi = moments_of(atmosphere, g, forward);
  std::vector<double> moments;
  moments.reserve(chi.size() * kDepths);
  for (std::size_t l = 0; l < chi.size(); ++l) {
    for (std::size_t d = 0; d < kDepths; ++d) moments.push_back(moment(l, chi[l], d));
  }
  std::vector<double> table;
  table.reserve(kAureoleAngles * kDepths);
  for (int angle = 0; angle < kAureoleAngles; ++angle) {
    const double t = static_cast<double>(angle) / (kAureoleAngles - 1);
    const double cosine = 1.0 - 2.0 * t * t * t * t;
    std::array<double, kDepths> sums{};
    math::for_each_legendre(cosine, chi.size(), [&](std::size_t l, double legendre) {
      for (std::size_t d = 0; d < kDepths; ++d) sums[d] += moments[l * kDepths + d] * legendre;
    });
    const double phase = aerosol_phase(atmosphere.aerosol_phase, g, cosine);
    for (const double sum : sums) table.push_back(sum / phase);
  }
  return table;
}

/// (P + D) / P.
std::vector<double> once_table(const Atmosphere& atmosphere, double g, double forward) {
  const auto bands = static_cast<std::size_t>(phase_spectrum(atmosphere, g).bands);
  std::vector<double> table = over_phase(atmosphere, g, forward, [&](std::size_t l, double chi, std::size_t d) {
    const double straight = l < bands ? 1.0 : std::min(1.0, chi / forward);
    return band_factor(l) * forward * change(depth_of(d), straight);
  });
  for (double& value : table) value = std::max(0.0, 1.0 + value);
  return table;
}

/// Returns (P + D) / P where f is large. Beyond the kept bands P + D is exp(-x) P and a part that falls as the square
/// of chi, so that truncating its bands causes no ringing.
/// With tau = x / f and chi_f = chi / f, the moment of P + D in a band beyond those that are kept is
/// chi + f ((exp(-x (1 - chi_f)) - exp(-x)) / x - chi_f) = exp(-x) (exp(tau chi) - 1) / tau = exp(-x) (chi + `more`),
/// `more` = (exp(tau chi) - 1 - tau chi) / tau = tau chi^2 / 2 + ... The part exp(-x) chi of all bands is exp(-x) P in
/// closed form, added at the end; only the rest is summed by bands, divided by P.
std::vector<double> narrow_once_table(const Atmosphere& atmosphere, double g, double forward) {
  const auto bands = static_cast<std::size_t>(phase_spectrum(atmosphere, g).bands);
  std::array<double, kDepths> once;
  for (std::size_t d = 0; d < kDepths; ++d) once[d] = math::exponential(-depth_of(d));
  std::vector<double> table = over_phase(atmosphere, g, forward, [&](std::size_t l, double chi, std::size_t d) {
    const double tau = depth_of(d) / forward;
    // (exp(tau chi) - 1 - tau chi) / tau
    const double more =
        tau * chi < kShallow ? 0.5 * tau * chi * chi : (math::exponential(tau * chi) - 1.0 - tau * chi) / tau;
    const double all = l < bands ? chi + forward * change(depth_of(d), 1.0) : once[d] * (chi + more);
    return band_factor(l) * (all - once[d] * chi);
  });
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = std::max(0.0, once[i % kDepths] + table[i]);
  return table;
}

/// S / P.
/// S_l = once(tau) chi_l + often(tau, chi_l): the first part is once(tau) P in closed form, and the second falls as
/// chi^2, so that its sum of bands is cut where nothing is left. tau = x / f, longer by `kLonger`.
std::vector<double> glow_table(const Atmosphere& atmosphere, double g, double forward) {
  std::vector<double> table = over_phase(atmosphere, g, forward, [&](std::size_t l, double chi, std::size_t d) {
    return band_factor(l) * often(glow_depth(depth_of(d), g, forward), chi);
  });
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = std::max(0.0, table[i]) + once(glow_depth(depth_of(i % kDepths), g, forward));
  }
  return table;
}

/// Returns the position of a depth among the nodes.
Between position_of(double depth) {
  const double x = std::max(0.0, depth);
  return between(std::min(x / (1.0 + x) / kDeepest, 1.0) * (kDepths - 1.0), static_cast<int>(kDepths));
}

double value_at(const std::vector<double>& table, std::size_t angle, const Between& point) {
  if (table.empty()) return 1.0;
  const double factor = table[angle * kDepths + point.node];
  return factor + point.part * (table[angle * kDepths + point.node + 1] - factor);
}

}  // namespace

Aureole::Aureole(const Atmosphere& atmosphere, const std::array<double, 3>& asymmetries,
                 const SkyTableOptions& options) {
  std::array<double, 3> forward{};
  for (std::size_t c = 0; c < 3; ++c) forward[c] = forward_share(atmosphere, asymmetries[c], options.orders);
  const bool narrow = std::any_of(asymmetries.begin(), asymmetries.end(),
                                  [&](double g) { return phase_spectrum(atmosphere, g).narrow; });
  const bool glows =
      narrow && options.layout == ScatteringLayout::full && narrow_lobe(atmosphere, options.orders) != NarrowLobe::none;
  for (std::size_t c = 0; c < (all_equal(asymmetries) ? 1 : 3); ++c) {
    Lobe& lobe = lobes_.emplace_back();
    if (forward[c] > kMinForwardShare) {
      lobe.asymmetry = asymmetries[c];
      lobe.forward = forward[c];
      lobe.once = glows ? narrow_once_table(atmosphere, asymmetries[c], forward[c])
                        : once_table(atmosphere, asymmetries[c], forward[c]);
      if (glows) lobe.glow = glow_table(atmosphere, asymmetries[c], forward[c]);
    }
  }
}

bool Aureole::any() const noexcept {
  return std::any_of(lobes_.begin(), lobes_.end(), [](const Lobe& lobe) { return !lobe.once.empty(); });
}

bool Aureole::glows() const noexcept {
  return std::any_of(lobes_.begin(), lobes_.end(), [](const Lobe& lobe) { return !lobe.glow.empty(); });
}

void Aureole::factors(const std::array<double, 3>& depths, float* values) const noexcept {
  for (std::size_t c = 0; c < 3; ++c) {
    const Between point = position_of(depths[c]);
    const std::vector<double>& table = lobe(c).seen();
    for (std::size_t angle = 0; angle < kAureoleAngles; ++angle) {
      values[4 * angle + c] = static_cast<float>(value_at(table, angle, point));
    }
  }
  for (std::size_t angle = 0; angle < kAureoleAngles; ++angle) values[4 * angle + 3] = 0.0F;
}

Aureole::Factors Aureole::factors(std::size_t channel, double cosine, double depth) const noexcept {
  const Lobe& lobe = this->lobe(channel);
  const Between point = position_of(depth);
  const double root = std::sqrt(std::sqrt(std::clamp(0.5 * (1.0 - cosine), 0.0, 1.0)));
  const Between angle = between(root * (kAureoleAngles - 1), kAureoleAngles);
  const auto at = [&](const std::vector<double>& table) {
    const double low = value_at(table, angle.node, point);
    return low + angle.part * (value_at(table, angle.node + 1, point) - low);
  };
  return {at(lobe.once), at(lobe.glow)};
}

// Bands that are kept have chi_f = 1, where the change is (1 - exp(-x)) / x - 1 < 0, times f. With a glow all light is
// seen as S.
double Aureole::loss(std::size_t channel, double chi, double depth) const noexcept {
  const Lobe& lobe = this->lobe(channel);
  if (lobe.glow.empty()) return -lobe.forward * change(std::max(0.0, depth), 1.0);
  const double tau = glow_depth(depth, lobe.asymmetry, lobe.forward);
  return chi - once(tau) * chi - often(tau, chi);
}

std::vector<std::array<double, 3>> aureole_depths(const Atmosphere& atmosphere, const SkyTableOptions& options,
                                                  const ColourFold& fold, const TableMapping& mapping, double altitude,
                                                  int suns) {
  const AirModel air(atmosphere);
  RayPanels panels(air);
  const std::vector<double>& scattering = atmosphere.aerosol.scattering_per_m;
  const std::vector<double> forward = forward_shares(atmosphere, options.orders);
  std::vector<double> depths(scattering.size());
  std::vector<std::array<double, 3>> channels;
  for (int k = 0; k < suns; ++k) {
    const double mu = std::max(mapping.sun_zenith_cosine(static_cast<double>(k) / (suns - 1)),
                               horizon_cosine(mapping.bottom_radius(), altitude));
    const double length = distance_to_top(mapping.bottom_radius(), mapping.thickness(), altitude, mu);
    const double column = lengths_along(air, {altitude, mu, false, length}, panels)[kAerosol];
    for (std::size_t i = 0; i < depths.size(); ++i) depths[i] = forward[i] * column * scattering[i];
    const glm::dvec3 share = fold.share(depths);
    channels.push_back({share[0], share[1], share[2]});
  }
  return channels;
}

}  // namespace welkin::sky
