// How a point's light goes to the rings and columns about it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "image/geometry.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "reflections/ring_weights.h"

namespace welkin::reflections {
namespace {

constexpr int kMiddle = kSpread / 2;
constexpr std::size_t kCells = kSpread - 1;  ///< that take a point's light, of two groups of neighbours

using Polynomial = std::array<double, kSharePowers>;  ///< the lowest power first

/// [cell][power of the position]: the inverse of the means of powers over the cells about an edge.
///
/// With A[k][j] the mean of x^j over cell k and B the inverse, w_k(x) = Sum_j B[j][k] x^j are shares whose light, as
/// areas of the cells, has the moments Sum_k w_k A[k][i] = Sum_j x^j Sum_k B[j][k] A[k][i] = x^i, i = 0 to 3: those of
/// a point at x, so that every cubic keeps its value there. The fourth moment of columns differs from x^4 by -10/21 in
/// the mean over all positions of `blended` shares (-0.8 at most), in cells: a wave of k radians per cell loses 10/21
/// k^4 / 24 = 0.0198 k^4 along an axis. Columns narrow with the sine of the polar angle, whose fourth power has the
/// mean 8/15 over the sphere, and the cosine's of a wave's direction has 3/8: degree l loses 0.0198 3/8 (1 + 8/15) (l
/// h)^4 = 0.0114 (l h)^4, h a ring's height. `kSpreadOrder`, a fit, is 0.012.
using Spreading = glm::dmat4;
static_assert(kCells == 4);

/// `density(x)`: light at a point, counted in cells from the edge. Beyond a pole it is below 0, and so is a cell's sum.
template <class Density>
Spreading spreading_by(const Density& density) {
  const math::GaussRule rule = math::gauss_legendre(6);
  glm::dmat4 means(0.0);  // [power][cell]
  for (int k = 0; k < 4; ++k) {
    for (int i = 0; i < rule.order; ++i) {
      const double x = k + 0.5 - kMiddle + 0.5 * rule.nodes[i];
      double power = rule.weights[i] * density(x);
      for (int j = 0; j < 4; ++j, power *= x) means[j][k] += power;
    }
    // the zeroth last: the others are over it
    for (int j = 3; j >= 0; --j) means[j][k] /= means[0][k];
  }
  return glm::inverse(means);
}

/// Returns those of the rings about the upper edge of ring `row`, which go on beyond the pole. Light of a ring spreads
/// over its area, whose density is the sine of the polar angle.
Spreading spreading_of_rings(int row, int rows) {
  return spreading_by([=](double x) { return math::sine_cosine_of_turns((row + x) / (2.0 * rows)).sine; });
}

Polynomial product(const Polynomial& a, const Polynomial& b) {
  Polynomial result{};
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == 0.0) continue;
    for (std::size_t j = 0; i + j < a.size(); ++j) result[i + j] += a[i] * b[j];
  }
  return result;
}

/// p(x + by).
Polynomial shifted(const glm::dvec4& p, double by) {
  Polynomial result{};
  for (int k = 3; k >= 0; --k) {
    for (std::size_t j = kCells - 1; j > 0; --j) result[j] = result[j] * by + result[j - 1];
    result[0] = result[0] * by + p[k];
  }
  return result;
}

/// From -1/2 on.
Polynomial integral(const Polynomial& p) {
  Polynomial result{};
  for (std::size_t k = 0; k + 1 < p.size(); ++k) result[k + 1] = p[k] / static_cast<double>(k + 1);
  double power = 1.0;
  double start = 0.0;
  for (const double coefficient : result) {
    start += coefficient * power;
    power *= -0.5;
  }
  result[0] = -start;
  return result;
}

double at_end(const Polynomial& p) {
  double sum = 0.0;
  for (std::size_t k = p.size(); k-- > 0;) sum = sum * 0.5 + p[k];
  return sum;
}

/// From one group's shares to the next one's where a point is half way through a cell, so that all shares are smooth;
/// of the position from the middle of the cell in the middle. Both groups have the point's moments, so every mean of
/// theirs has them too; the quintic's first and second derivative are 0 at both ends. Its product with a cubic has the
/// degree 8, and 9 when it is integrated; times a cubic for the sine, 11 and 12: `kSharePowers` is 13.
std::array<Polynomial, kSpread> blended(const Spreading& before, const Spreading& after) {
  // s^3 (6 s^2 - 15 s + 10), s = x + 1/2
  constexpr Polynomial after_share{0.5, 1.875, 0.0, -5.0, 0.0, 6.0};
  constexpr Polynomial before_share{0.5, -1.875, 0.0, 5.0, 0.0, -6.0};
  std::array<Polynomial, kSpread> shares{};
  for (std::size_t k = 0; k < kCells; ++k) {
    const auto cell = static_cast<glm::length_t>(k);
    const Polynomial first = product(before_share, shifted(before[cell], 0.5));
    const Polynomial second = product(after_share, shifted(after[cell], -0.5));
    for (std::size_t j = 0; j < first.size(); ++j) {
      shares[k][j] += first[j];
      shares[k + 1][j] += second[j];
    }
  }
  return shares;
}

/// `to`: [power][lane].
void write(const std::array<Polynomial, kSpread>& shares, float* to) {
  std::fill_n(to, kSharePowers * kShareLanes, 0.0F);
  for (std::size_t lane = 0; lane < kSpread; ++lane) {
    for (std::size_t j = 0; j < kSharePowers; ++j)
      to[(kSharePowers - 1 - j) * kShareLanes + lane] = static_cast<float>(shares[lane][j]);
  }
}

/// The light that the rings about a cell get of uniform light on it, from the cell's upper edge to a position.
using CellLight = std::array<Polynomial, kSpread>;

/// Returns the area of a ring's texel over the width of its column; rings go on beyond the pole and the equator.
double area_of(int ring, int rows) {
  const int real = ring < 0 ? -1 - ring : std::min(ring, rows - 1 - ring);
  return image::lat_long_texel_solid_angle(2 * rows, rows, real) * rows / std::numbers::pi;
}

std::vector<CellLight> light_of_rings(int rows) {
  const double step = std::numbers::pi / rows;
  std::vector<CellLight> light;
  light.reserve(static_cast<std::size_t>(rows / 2 + 1));
  Spreading above = spreading_of_rings(0, rows);
  for (int row = 0; row <= rows / 2; ++row) {
    const Spreading below = spreading_of_rings(row + 1, rows);
    light.push_back(blended(above, below));
    above = below;
    const math::SineCosine middle = math::sine_cosine_of_turns((row + 0.5) / (2.0 * rows));
    // Taylor's polynomial of sin(p0 + step x) step about the ring's middle p0. The first term left out is
    // (step x)^4 / 24 sin(p0), |x| <= 1/2.
    Polynomial sine{};  // of the polar angle, times a ring's height
    sine[0] = step * middle.sine;
    sine[1] = step * step * middle.cosine;
    sine[2] = -0.5 * step * step * sine[0];
    sine[3] = -step * step / 6.0 * sine[1];
    for (Polynomial& share : light.back()) share = integral(product(share, sine));
  }
  return light;
}

/// By the shares alone, uniform light would be off by up to 0.9 % on the first rings about a pole. What a ring has too
/// much or too little flows to or from the next one, no more than 1 % of its light.
void even_out(std::vector<CellLight>& light, int rows) {
  constexpr int kPolarRings = 32;
  const auto received = [&](int ring, int first_cell, int last_cell) {
    double sum = 0.0;
    for (int cell = std::max(first_cell, 0); cell <= last_cell; ++cell) {
      const int lane = ring - cell + kMiddle;
      if (lane >= 0 && lane < kSpread)
        sum += at_end(light[static_cast<std::size_t>(cell)][static_cast<std::size_t>(lane)]);
    }
    return sum;
  };
  for (int ring = 0; ring < std::min(kPolarRings, rows / 4); ++ring) {
    const int reach = ring + kMiddle;
    // ring -1 - ring, beyond the pole, is the same ring 180 degrees on
    const double excess = received(ring, 0, reach) + received(-1 - ring, 0, reach) - area_of(ring, rows);
    // Cells that give light to both rings.
    const int first_cell = std::max(0, ring + 1 - kMiddle);
    const bool outwards = excess > 0.0;
    const double share = std::abs(excess) / received(outwards ? ring : ring + 1, first_cell, reach);
    for (int cell = first_cell; cell <= reach; ++cell) {
      const auto lane = static_cast<std::size_t>(ring - cell + kMiddle);
      CellLight& here = light[static_cast<std::size_t>(cell)];
      Polynomial& from = here[outwards ? lane : lane + 1];
      Polynomial& to = here[outwards ? lane + 1 : lane];
      for (std::size_t j = 0; j < from.size(); ++j) {
        const double flow = share * from[j];
        from[j] -= flow;
        to[j] += flow;
      }
    }
  }
}

constexpr std::size_t kCellFloats = std::size_t{kSharePowers} * kShareLanes;

}  // namespace

RingShares::RingShares(int rows)
    : columns(kCellFloats),
      columns_before(kCellFloats),
      rings_before(kCellFloats * static_cast<std::size_t>(rows / 2 + 1)) {
  const Spreading across = spreading_by([](double) { return 1.0; });
  std::array<Polynomial, kSpread> shares = blended(across, across);
  write(shares, columns.data());
  double before = 0.0;
  for (std::size_t k = kSpread; k-- > 0;) {  // a column that lies further on has been passed less
    shares[k] = integral(shares[k]);
    const double passed = at_end(shares[k]);
    // In the cells that were passed before this one, the column lay in the lanes behind this one.
    shares[k][0] += before;
    before += passed;
  }
  write(shares, columns_before.data());

  std::vector<CellLight> light = light_of_rings(rows);
  even_out(light, rows);
  std::vector<double> sums(static_cast<std::size_t>(rows / 2 + 5));  // of ring k - 2
  for (std::size_t row = 0; row < light.size(); ++row) {
    for (std::size_t k = 0; k < kSpread; ++k) {
      const int ring = static_cast<int>(row + k) - kMiddle;
      double& sum = sums[row + k];
      const double area = area_of(ring, rows);
      for (double& coefficient : light[row][k]) coefficient /= area;
      const double passed = at_end(light[row][k]);
      light[row][k][0] += sum;
      sum += passed;
    }
    write(light[row], rings_before.data() + kCellFloats * row);
  }
  whole.assign(sums.begin(), sums.end());
}

}  // namespace welkin::reflections
