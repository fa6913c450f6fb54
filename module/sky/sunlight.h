// How much sunlight reaches any point of the air: transmittance to the sun over altitude and elevation.
#pragma once

#include <array>
#include <vector>

#include "simd/sky_kernels.h"
#include "sky/air.h"
#include "sky/ray_nodes.h"
#include "sky/table_mapping.h"
#include "welkin/control.h"

namespace welkin::sky {

/// Density-weighted path lengths to the top for rays above the horizon: of no wavelength, and so computed once.
///
/// Heights are those of the tables (x = rho / H). Over zenith cosines, y = mu - mu_h above each height's own horizon:
/// x = share (Y + b) / Y y / (y + b) + (1 - share) y / Y, Y = 1 - mu_h: half of the nodes lie where the air is deepest,
/// the bend b being a few times the width over which an exponential air darkens, sqrt(2 scale height / R).
class SunPaths {
 public:
  /// At least 4 heights; zeniths a multiple of 4.
  struct Size {
    int heights = 128;
    int zeniths = 256;
  };

  SunPaths(const Air& air, const TableMapping& mapping, const Size& size, const Control& control);

  /// The two coefficients of a height's axis, per node.
  struct Axis {
    double horizon, rational, bend, linear;
  };
  [[nodiscard]] Axis axis(double altitude) const noexcept;
  [[nodiscard]] const Amounts& lengths(int height, int zenith) const noexcept {
    return lengths_[static_cast<std::size_t>(height * size_.zeniths + zenith)];
  }
  [[nodiscard]] const TableMapping& mapping() const noexcept { return mapping_; }
  [[nodiscard]] const Size& size() const noexcept { return size_; }

 private:
  [[nodiscard]] double zenith_cosine(double altitude, int node) const noexcept;

  TableMapping mapping_;
  Size size_;
  double bend_;
  std::vector<Amounts> lengths_;
};

/// The light of the sun at three wavelengths, of one at unit irradiance.
class Sunlight {
 public:
  Sunlight(const Air& air, const SunPaths& paths, const Extinctions& extinctions);

  /// Nodes of a row of a sample.
  [[nodiscard]] int nodes() const noexcept { return paths_->size().zeniths; }

  /// Fills in what of a sample depends on its altitude.
  void at(double altitude, simd::SunlitSample& sample) const noexcept;

  /// In double, for a single point: transmittance times the visible share of the disc.
  [[nodiscard]] std::array<double, 3> at(double altitude, double sun_zenith_cosine) const noexcept;

 private:
  const SunPaths* paths_;
  double bottom_radius_;
  std::size_t row_;          ///< floats of a height
  double disc_slope_;        ///< 1 / (2 a)
  std::vector<float> rows_;  ///< [heights][zeniths][4]
};

}  // namespace welkin::sky
