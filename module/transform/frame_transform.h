// From the harmonics of a local frame to the canonical ones.
#pragma once

#include <vector>

#include "image/geometry.h"

namespace welkin::transforms {

struct SphereRule;

/// The matrix that takes coefficients over the harmonics of a frame to canonical coefficients. It mixes
/// orders within a band only, and few of them; it is kept as a list of what is not zero.
class FrameTransform {
 public:
  FrameTransform() = default;
  FrameTransform(const image::Frame& frame, const SphereRule& rule);  ///< of as many bands as the rule

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
