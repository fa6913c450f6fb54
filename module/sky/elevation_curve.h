// Nodes over a sun's elevation, and cubics between them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace welkin::sky {

/// Where nodes stand. With x = sine of the elevation - that of the horizon: t = x / sqrt(w + sqrt(w^2 + x^2)), whose
/// inverse is x = t sqrt(t^2 + 2 w): equal steps in t are steps of sqrt(2 w) dt at the horizon and grow like sqrt(x).
class CurveAxis {
 public:
  /// `count` nodes from sine `lowest` to 1.
  CurveAxis(int count, double lowest, double horizon) noexcept;

  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] double sine(int node) const noexcept;

  struct Position {
    int interval;
    double part;  ///< 0 to 1
  };
  /// Returns the position of a sine; one below the lowest node counts as that node's.
  [[nodiscard]] Position place(double sine) const noexcept;

 private:
  [[nodiscard]] double coordinate(double sine) const noexcept;

  int count_;
  double horizon_;
  double first_ = 0.0;  ///< t of the first node
  double step_ = 1.0;
};

/// Hermite cubics for several functions at once: function i has its value at node k in values[(k * functions + i) * 2],
/// followed by the slope per step.
struct CurveValues {
  std::size_t functions = 0;
  std::vector<double> values;

  /// Writes all functions' values at a position to `results`.
  void at(const CurveAxis::Position& position, double* results) const noexcept;
  [[nodiscard]] double& value(int node, std::size_t function) noexcept {
    return values[(static_cast<std::size_t>(node) * functions + function) * 2];
  }
  [[nodiscard]] double& slope(int node, std::size_t function) noexcept {
    return values[(static_cast<std::size_t>(node) * functions + function) * 2 + 1];
  }
};

/// Nodes of the sun's irradiance for each of the sky's.
inline constexpr int kSunNodes = 2;

/// Bytes of a sky's curve at most: a value and a slope of each channel of the bands (bands + 1) / 2 coefficients that
/// are even in the azimuth, and of the sun's irradiance; and 512 for what holds them.
[[nodiscard]] constexpr std::uint64_t curve_bytes(int bands, int nodes) noexcept {
  const auto functions =
      3 * (static_cast<std::uint64_t>(bands) * static_cast<std::uint64_t>(bands + 1) / 2 + kSunNodes);
  return static_cast<std::uint64_t>(nodes) * 2 * functions * sizeof(double) + 512;
}

/// Slopes of a function that is nowhere negative and may fall by decades: those of its logarithm, times itself, where
/// all around are above zero; limited so that no cubic goes below zero (|slope| <= 3 value).
void set_slopes_of_positive(CurveValues& curve, int nodes, std::size_t function);

/// Slopes of a function that follows a positive one, `leader`, whose slopes are set: by their ratio.
void set_slopes_by_ratio(CurveValues& curve, int nodes, std::size_t function, std::size_t leader);

}  // namespace welkin::sky
