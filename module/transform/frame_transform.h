// From the harmonics of a local frame to the canonical ones.
#pragma once

#include <vector>

#include "image/geometry.h"

namespace welkin::transforms {

/// A quadrature over the sphere that is exact for products of two harmonics of as many bands: Gauss points in z, twice
/// as many even azimuths as bands.
class SphereRule {
 public:
  struct Point {
    double x, y, z;
    double weight;
    const double* harmonics;  ///< [bands^2], at this point
  };

  explicit SphereRule(int bands);

  [[nodiscard]] int bands() const noexcept { return bands_; }
  [[nodiscard]] const std::vector<Point>& points() const noexcept { return points_; }

 private:
  int bands_;
  std::vector<Point> points_;
  std::vector<double> values_;
};

/// The matrix that takes coefficients over the harmonics of a frame to canonical coefficients. It mixes
/// orders within a band only, and few of them; it is kept as a list of what is not zero.
class FrameTransform {
 public:
  FrameTransform() = default;
  FrameTransform(const image::Frame& frame, const SphereRule& rule);

  /// canonical[l(l+1)+m] += sum over m' of T_l[m][m'] local[rows[l(l+1)+m']], for the three channels.
  /// local: [3][bands^2], in the order that `rows` says; canonical: [3][bands^2].
  void add(const double* local, const int* rows, double* canonical) const noexcept;

 private:
  struct Entry {
    int canonical;
    int local;
    double factor;
  };
  int functions_ = 0;
  std::vector<Entry> entries_;
};

/// Returns the transform of cubemap face 0 to 5 (+X -X +Y -Y +Z -Z), built once for each number of bands.
[[nodiscard]] const FrameTransform& face_transform(int face, int bands);

/// Returns that of the frame whose third axis a lat-long's rows encircle: u = +z, v = +x, normal = +y.
[[nodiscard]] const FrameTransform& lat_long_transform(int bands);

}  // namespace welkin::transforms
