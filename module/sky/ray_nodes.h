// Where integrals along a ray through the air take their samples, and how much air lies before each of them.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "sky/air.h"
#include "sky/table_mapping.h"
#include "welkin/core.h"

namespace welkin::sky {

inline constexpr std::size_t kPanelNodes = 4;   ///< of a Gauss-Legendre rule
inline constexpr std::size_t kMaxPanels = 384;  ///< of one ray
inline constexpr std::size_t kMaxRayNodes = kPanelNodes * kMaxPanels;

/// Rising distances along a ray at which it crosses shells and where it is nearest to the ground; 0 and its length too.
/// Scratch of a fixed size: nothing is allocated after construction.
class RayPanels {
 public:
  explicit RayPanels(const AirModel& air);
  /// A copy's vector would lose its capacity.
  RayPanels(const RayPanels&) = delete;
  RayPanels& operator=(const RayPanels&) = delete;
  RayPanels(RayPanels&&) noexcept = default;
  RayPanels& operator=(RayPanels&&) noexcept = default;
  ~RayPanels() = default;

  /// `shells`: the air's, or its length shells.
  void cut(const AirModel& air, const Ray& ray, const std::vector<double>& shells) noexcept;
  [[nodiscard]] const std::vector<double>& ends() const noexcept { return ends_; }

 private:
  void add(double distance, double length) noexcept;
  std::vector<double> ends_;
};

/// Returns each constituent's density integrated along a whole ray, metres. Relative error about 1e-6.
[[nodiscard]] PerConstituent lengths_along(const AirModel& air, const Ray& ray, RayPanels& panels) noexcept;

// Density-weighted lengths along the rays of a table: independent of wavelength, ground and amount of haze.

struct RayLengths {
  std::vector<PerConstituent> amounts;  ///< `lengths_along` each ray

  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof *this +
           amounts.size() * (sizeof(PerConstituent) + sizeof(Ray));  // the rays are kept too, to be compared
  }
};

/// Returns the lengths of a table's rays. Those of the last few tables are cached: a sky that only changes its ground
/// or the amount of its haze computes them once. Throws `Error` (cancelled).
[[nodiscard]] std::shared_ptr<const RayLengths> lengths_of(const AirModel& air, std::vector<Ray> rays,
                                                           const Control& control);

// Samples of a ray.

/// Extinction of each constituent at three wavelengths, 1/m.
using Extinctions = std::array<PerConstituent, 3>;
[[nodiscard]] double optical_depth(const PerConstituent& extinction, const PerConstituent& lengths) noexcept;

struct RayNode {
  double distance;
  double altitude;
  double weight;  ///< metres that it stands for
  PerConstituent density;
  std::array<double, 3> transmittance;  ///< from the ray's start
};

/// Samples of a ray such that integrals of density, transmittance and smooth light are right to about 1e-4: Gauss nodes
/// on panels that end at shells, are short against the planet's curve, and optically thin at three wavelengths.
class RayNodes {
 public:
  explicit RayNodes(const AirModel& air);
  /// Allocates nothing.
  void place(const AirModel& air, const Ray& ray, const Extinctions& extinctions) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] const RayNode& operator[](std::size_t i) const noexcept { return nodes_[i]; }

 private:
  bool try_panel(const AirModel& air, const Ray& ray, const Extinctions& extinctions, double from, double to,
                 bool last_chance) noexcept;

  RayPanels panels_;
  std::vector<RayNode> nodes_;
  std::vector<double> pending_;
  std::size_t count_ = 0;
  std::array<double, 3> transmittance_{};
};

}  // namespace welkin::sky
