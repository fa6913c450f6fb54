#include "sky/aureole.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "math/elementary.h"
#include "sky/air.h"

namespace welkin::sky {
namespace {

constexpr double kLeastForward = 1e-3;  ///< below, nothing is seen of it
constexpr double kLastMoment = 1e-4;    ///< of f: no more of them
constexpr std::size_t kDepths = 33;     ///< even in x / (1 + x)
constexpr double kDeepest = 0.97;       ///< its last one
constexpr double kShallow = 1e-4;

double depth_of(std::size_t node) {
  const double y = kDeepest * static_cast<double>(node) / (kDepths - 1.0);
  return y / (1.0 - y);
}

/// (exp(-x (1 - chi)) - exp(-x)) / x - chi, and its first term where x is small.
double change(double x, double chi) {
  if (x < kShallow) return -x * chi * (1.0 - 0.5 * chi);
  return (math::exponential(-x * (1.0 - chi)) - math::exponential(-x)) / x - chi;
}

/// chi_0 and on, until they are negligible beside f.
std::vector<double> moments_of(const Atmosphere& atmosphere, double g, double forward) {
  const auto count = static_cast<int>(math::logarithm(kLastMoment * forward) / math::logarithm(g));
  return aerosol_moments(atmosphere, g, std::max(count, kMostSourceBands + 1));
}

/// (P + D) / P: [angles][depths]. Angles are even in the fourth root of (1 - cosine) / 2.
std::vector<double> factor_table(const Atmosphere& atmosphere, double g, double forward) {
  const std::vector<double> chi = moments_of(atmosphere, g, forward);
  const auto bands = static_cast<std::size_t>(phase_spectrum(atmosphere, g).bands);
  std::vector<double> moments(chi.size() * kDepths);  // (2 l + 1) / (4 pi) D_l: [bands][depths]
  for (std::size_t l = 0; l < chi.size(); ++l) {
    const double straight = l < bands ? 1.0 : std::min(1.0, chi[l] / forward);
    const double factor = (2.0 * static_cast<double>(l) + 1.0) / (4.0 * std::numbers::pi) * forward;
    for (std::size_t d = 0; d < kDepths; ++d) moments[l * kDepths + d] = factor * change(depth_of(d), straight);
  }
  std::vector<double> table;
  table.reserve(kAureoleAngles * kDepths);
  for (int angle = 0; angle < kAureoleAngles; ++angle) {
    const double t = static_cast<double>(angle) / (kAureoleAngles - 1);
    const double cosine = 1.0 - 2.0 * t * t * t * t;
    std::array<double, kDepths> sums{};
    double before = 0.0;
    double here = 1.0;  // P_l(cosine)
    for (std::size_t l = 0; l < chi.size(); ++l) {
      for (std::size_t d = 0; d < kDepths; ++d) sums[d] += moments[l * kDepths + d] * here;
      const auto degree = static_cast<double>(l);
      const double next = ((2.0 * degree + 1.0) * cosine * here - degree * before) / (degree + 1.0);
      before = here;
      here = next;
    }
    const double phase = aerosol_phase(atmosphere.aerosol_phase, g, cosine);
    for (const double sum : sums) table.push_back(std::max(0.0, 1.0 + sum / phase));
  }
  return table;
}

}  // namespace

Aureole::Aureole(const Atmosphere& atmosphere, const std::array<double, 3>& asymmetries, int orders) {
  for (std::size_t c = 0; c < (all_equal(asymmetries) ? 1 : 3); ++c) {
    const double forward = forward_share(atmosphere, asymmetries[c], orders);
    const bool any = forward > kLeastForward;
    lobes_.push_back(
        {any ? forward : 0.0, any ? factor_table(atmosphere, asymmetries[c], forward) : std::vector<double>{}});
  }
}

bool Aureole::any() const noexcept {
  return std::any_of(lobes_.begin(), lobes_.end(), [](const Lobe& lobe) { return !lobe.table.empty(); });
}

void Aureole::factors(const std::array<double, 3>& depths, float* values) const noexcept {
  for (std::size_t c = 0; c < 3; ++c) {
    const double x = std::max(0.0, depths[c]);
    const double position = std::min(x / (1.0 + x) / kDeepest, 1.0) * (kDepths - 1.0);
    const std::size_t node = std::min(static_cast<std::size_t>(position), kDepths - 2);
    const double part = position - static_cast<double>(node);
    const std::vector<double>& table = lobe(c).table;
    for (std::size_t angle = 0; angle < kAureoleAngles; ++angle) {
      const double factor = table.empty() ? 1.0 : table[angle * kDepths + node];
      const double next = table.empty() ? 1.0 : table[angle * kDepths + node + 1];
      values[4 * angle + c] = static_cast<float>(factor + part * (next - factor));
    }
  }
  for (std::size_t angle = 0; angle < kAureoleAngles; ++angle) values[4 * angle + 3] = 0.0F;
}

double Aureole::loss(std::size_t channel, double depth) const noexcept {
  return -lobe(channel).forward * change(std::max(0.0, depth), 1.0);
}

}  // namespace welkin::sky
