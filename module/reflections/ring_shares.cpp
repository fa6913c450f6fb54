#include "reflections/ring_shares.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "image/geometry.h"
#include "math/elementary.h"
#include "reflections/ring_weight_kernels.h"

namespace welkin::reflections {
namespace {

constexpr int kMiddle = kSpread / 2;
constexpr std::size_t kCells = kSpread - 1;  ///< that take a point's light, of two groups of neighbours

using Shares = std::array<double, kCells>;
using Polynomial = std::array<double, kSharePowers>;  ///< the lowest power first

/// [cell][power of the place]: the inverse of moments[j][k], the mean of x^j over cell k.
using Spreading = std::array<Shares, kCells>;

/// By Gauss and Jordan.
Spreading spreading_of(std::array<Shares, kCells> moments) {
  Spreading inverse{};
  for (std::size_t k = 0; k < kCells; ++k) inverse[k][k] = 1.0;
  for (std::size_t pivot = 0; pivot < kCells; ++pivot) {
    std::size_t best = pivot;
    for (std::size_t row = pivot + 1; row < kCells; ++row) {
      if (std::abs(moments[row][pivot]) > std::abs(moments[best][pivot])) best = row;
    }
    std::swap(moments[pivot], moments[best]);
    std::swap(inverse[pivot], inverse[best]);
    const double scale = 1.0 / moments[pivot][pivot];
    for (std::size_t k = 0; k < kCells; ++k) {
      moments[pivot][k] *= scale;
      inverse[pivot][k] *= scale;
    }
    for (std::size_t row = 0; row < kCells; ++row) {
      const double factor = moments[row][pivot];
      if (row == pivot || factor == 0.0) continue;
      for (std::size_t k = 0; k < kCells; ++k) {
        moments[row][k] -= factor * moments[pivot][k];
        inverse[row][k] -= factor * inverse[pivot][k];
      }
    }
  }
  return inverse;
}

/// Integrals of x^j times cosine and sine of x `step` over the cells about an edge.
struct Moments {
  explicit Moments(double step) {
    constexpr int kTerms = 12;
    for (std::size_t k = 0; k < kCells; ++k) {
      const double above = static_cast<double>(k) + 1.0 - kMiddle;
      const double below = above - 1.0;
      for (std::size_t j = 0; j < kCells; ++j) {
        double factor = 1.0;  // step^n / n!
        double high = above;
        double low = below;
        for (std::size_t i = 0; i < j; ++i) {
          high *= above;
          low *= below;
        }
        for (int n = 0; n < kTerms; ++n) {
          const double term = factor * (high - low) / static_cast<double>(n + static_cast<int>(j) + 1);
          const double sign = n / 2 % 2 == 0 ? 1.0 : -1.0;
          (n % 2 == 0 ? cosine : sine)[j][k] += sign * term;
          high *= above;
          low *= below;
          factor *= step / (n + 1);
        }
      }
    }
  }
  std::array<Shares, kCells> cosine{};  ///< [power][cell]
  std::array<Shares, kCells> sine{};
};

/// Of columns, all alike.
Spreading spreading_of_columns() { return spreading_of(Moments(0.0).cosine); }

/// Of the rings about the upper edge of ring `row`, which go on beyond the pole.
Spreading spreading_of_rings(const Moments& moments, int row, int rows) {
  const math::SineCosine edge = math::sine_cosine_of_turns(row / (2.0 * rows));
  std::array<Shares, kCells> means{};
  for (std::size_t k = 0; k < kCells; ++k) {
    // Beyond a pole the sine is below 0, and so is the divisor.
    const auto of = [&](std::size_t j) { return edge.sine * moments.cosine[j][k] + edge.cosine * moments.sine[j][k]; };
    const double area = of(0);
    for (std::size_t j = 0; j < kCells; ++j) means[j][k] = of(j) / area;
  }
  return spreading_of(means);
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
Polynomial shifted(const Shares& p, double by) {
  Polynomial result{};
  for (std::size_t k = kCells; k-- > 0;) {
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
/// of the place from the middle of the cell in the middle.
std::array<Polynomial, kSpread> blended(const Spreading& before, const Spreading& after) {
  // s^3 (6 s^2 - 15 s + 10), s = x + 1/2
  constexpr Polynomial after_share{0.5, 1.875, 0.0, -5.0, 0.0, 6.0};
  constexpr Polynomial before_share{0.5, -1.875, 0.0, 5.0, 0.0, -6.0};
  std::array<Polynomial, kSpread> shares{};
  for (std::size_t k = 0; k < kCells; ++k) {
    const Polynomial first = product(before_share, shifted(before[k], 0.5));
    const Polynomial second = product(after_share, shifted(after[k], -0.5));
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

/// What the rings about a cell get of uniform light on it, from the cell's upper edge to a place.
using CellLight = std::array<Polynomial, kSpread>;

/// Of a column's width; rings go on beyond the pole and the equator.
double area_of(int ring, int rows) {
  const int real = ring < 0 ? -1 - ring : std::min(ring, rows - 1 - ring);
  return image::lat_long_texel_solid_angle(2 * rows, rows, real) * rows / std::numbers::pi;
}

std::vector<CellLight> light_of_rings(int rows) {
  const double step = std::numbers::pi / rows;
  const Moments moments(step);
  std::vector<CellLight> light;
  light.reserve(static_cast<std::size_t>(rows / 2 + 1));
  Spreading above = spreading_of_rings(moments, 0, rows);
  for (int row = 0; row <= rows / 2; ++row) {
    const Spreading below = spreading_of_rings(moments, row + 1, rows);
    light.push_back(blended(above, below));
    above = below;
    const math::SineCosine middle = math::sine_cosine_of_turns((row + 0.5) / (2.0 * rows));
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
  const Spreading across = spreading_of_columns();
  std::array<Polynomial, kSpread> shares = blended(across, across);
  write(shares, columns.data());
  double before = 0.0;
  for (std::size_t k = kSpread; k-- > 0;) {  // a column that lies further on has been passed less
    shares[k] = integral(shares[k]);
    const double passed = at_end(shares[k]);
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
