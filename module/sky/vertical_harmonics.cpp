#include "sky/vertical_harmonics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "math/basis.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::sky {
namespace {

/// One entry of a change of axes: of Welkin's coefficient `to` from the vertical one `from`.
struct Entry {
  int to;
  int from;
  double factor;
};

/// Entries of all bands, one band after the other.
struct AxisChange {
  std::vector<Entry> entries;
  std::array<std::size_t, kMaximumBands + 1> first{};  ///< of a band
};

using Basis = std::array<double, kMaximumBands * kMaximumBands>;

Basis basis_at(double x, double y, double z) {
  Basis values{};
  math::for_each_basis_value(math::basis_constants(), x, y, z, 1.0, kMaximumBands,
                             [&](int index, double value) { values[static_cast<std::size_t>(index)] = value; });
  return values;
}

/// Integrals of products of both kinds of functions, by a rule that is exact for their degree; what is not there but
/// for rounding is left out.
/// Two bases of the same space of degree l differ by an orthogonal matrix per band: M(to, from) = Int
/// Y_to(x, y, z) Y_from(z, x, y) dw. Products of two functions of degree 15 have degree 30: 16 Gauss nodes in z are
/// exact to degree 31, and 32 azimuths to order 31.
AxisChange make_axis_change() {
  constexpr int rings = kMaximumBands;
  constexpr int columns = 2 * kMaximumBands;
  const math::GaussRule rule = math::gauss_legendre(rings);
  std::vector<double> products(static_cast<std::size_t>(kMaximumBands) * kMaximumBands * (2 * kMaximumBands));
  const auto index_of = [](int to, int l, int from) {
    return static_cast<std::size_t>(to * 2 * kMaximumBands + from - l * l);
  };
  for (int j = 0; j < rings; ++j) {
    const double z = rule.nodes[j];
    const double sine = std::sqrt(1.0 - z * z);
    for (int i = 0; i < columns; ++i) {
      const math::SineCosine azimuth = math::sine_cosine_of_turns(static_cast<double>(i) / columns);
      const double x = sine * azimuth.cosine;
      const double y = sine * azimuth.sine;
      const Basis values = basis_at(x, y, z);
      const Basis vertical = basis_at(z, x, y);
      for (int l = 0; l < kMaximumBands; ++l) {
        for (int to = l * l; to < (l + 1) * (l + 1); ++to) {
          const double weighted =
              rule.weights[j] * (2.0 * std::numbers::pi / columns) * values[static_cast<std::size_t>(to)];
          for (int from = l * l; from < (l + 1) * (l + 1); ++from) {
            products[index_of(to, l, from)] += weighted * vertical[static_cast<std::size_t>(from)];
          }
        }
      }
    }
  }
  AxisChange change;
  for (int l = 0; l < kMaximumBands; ++l) {
    change.first[static_cast<std::size_t>(l)] = change.entries.size();
    for (int to = l * l; to < (l + 1) * (l + 1); ++to) {
      for (int from = l * l; from < (l + 1) * (l + 1); ++from) {
        const double factor = products[index_of(to, l, from)];
        if (factor * factor > 1e-24) change.entries.push_back({to, from, factor});
      }
    }
  }
  change.first[kMaximumBands] = change.entries.size();
  return change;
}

const AxisChange& axis_change() {
  // Never destroyed: a worker's thread may still compute while the program exits.
  static const AxisChange& change = *new AxisChange(make_axis_change());
  return change;
}

}  // namespace

void prepare_turns() { (void)axis_change(); }

void even_basis(double zenith_cosine, double zenith_sine, int bands, std::span<double> values) {
  int l = 0;
  const Basis all = basis_at(zenith_sine, 0.0, zenith_cosine);
  for (; l < bands; ++l) {
    for (int m = 0; m <= l; ++m) values[even_index(l, m)] = all[SphericalHarmonics::index(l, m)];
  }
}

// A function even about azimuth 0, Sum c(l, m) cos(m phi), rotated to the azimuth phi_s of the sun is
//   Sum c(l, m) cos(m (phi - phi_s)) = Sum c(l, m) (cos(m phi_s) cos(m phi) + sin(m phi_s) sin(m phi)).
// cos(m phi_s) and sin(m phi_s) follow from cos and sin of phi_s by the sum formulas, without an arctangent.
void rotate_even(std::span<const glm::dvec3> even, int bands, const SunAngles& sun,
                 std::span<glm::dvec3> coefficients) noexcept {
  std::array<double, kMaximumBands> cosines{1.0};
  std::array<double, kMaximumBands> sines{};
  for (std::size_t m = 1; m < static_cast<std::size_t>(bands); ++m) {
    cosines[m] = cosines[m - 1] * sun.azimuth_cosine - sines[m - 1] * sun.azimuth_sine;
    sines[m] = sines[m - 1] * sun.azimuth_cosine + cosines[m - 1] * sun.azimuth_sine;
  }
  std::array<glm::dvec3, kMaximumBands * kMaximumBands> rotated;
  for (int l = 0; l < bands; ++l) {
    rotated[SphericalHarmonics::index(l, 0)] = even[even_index(l, 0)];
    for (int m = 1; m <= l; ++m) {
      rotated[SphericalHarmonics::index(l, m)] = cosines[static_cast<std::size_t>(m)] * even[even_index(l, m)];
      rotated[SphericalHarmonics::index(l, -m)] = sines[static_cast<std::size_t>(m)] * even[even_index(l, m)];
    }
  }
  for (int i = 0; i < bands * bands; ++i) coefficients[static_cast<std::size_t>(i)] = glm::dvec3(0.0);
  const AxisChange& change = axis_change();
  const std::size_t end = change.first[static_cast<std::size_t>(bands)];
  for (std::size_t k = 0; k < end; ++k) {
    const Entry& entry = change.entries[k];
    coefficients[static_cast<std::size_t>(entry.to)] += entry.factor * rotated[static_cast<std::size_t>(entry.from)];
  }
}

// K(l, m) P_l^m without the Condon-Shortley sign, K^2 = (2 l + 1) / (4 pi) (l - m)! / (l + m)!, twice that for m > 0.
// Starts:
//   Y(m, m) = sqrt((2 m + 1) / (2 m)) sin(theta) Y(m - 1, m - 1), since P_m^m = (2 m - 1) sin(theta) P_(m-1)^(m-1);
// the factor 2 of m > 0 comes in once, at m = 1. With n = l + 1, (n - m) P_n^m = (2 l + 1) mu P_l^m - (l + m) P_(l-1)^m
// times the ratios of K becomes Y(n, m) = a mu Y(l, m) - b Y(l - 1, m),
//   a^2 = (4 n^2 - 1) / (n^2 - m^2),   b^2 = (2 n + 1) / (2 n - 3) ((n - 1)^2 - m^2) / (n^2 - m^2).
// Upwards in l the recurrence is stable. No factorial appears: (l + m)! of band 27 would be 54! = 2e71.
void even_legendre(int bands, double zenith_cosine, double* values) noexcept {
  const double sine = std::sqrt(std::max(0.0, (1.0 - zenith_cosine) * (1.0 + zenith_cosine)));
  double start = std::sqrt(0.25 / std::numbers::pi);
  for (int m = 0; m < bands; ++m) {
    if (m > 0) start *= sine * std::sqrt((2.0 * m + 1.0) / (2.0 * m) * (m == 1 ? 2.0 : 1.0));
    double before = 0.0;
    double here = start;
    for (int l = m; l < bands; ++l) {
      values[pair_index(bands, l, m)] = here;
      const double n = l + 1.0;
      const double a = std::sqrt((4.0 * n * n - 1.0) / (n * n - m * m));
      const double b =
          l > m ? std::sqrt((2.0 * n + 1.0) * ((n - 1.0) * (n - 1.0) - m * m) / ((2.0 * n - 3.0) * (n * n - m * m)))
                : 0.0;
      const double next = a * zenith_cosine * here - b * before;
      before = here;
      here = next;
    }
  }
}

}  // namespace welkin::sky
