// The error of the midpoint rule on a cubemap, from the sums of its faces.
//
// A texel of radiance L and solid angle w adds L w Y(centre) instead of L Int Y: off by L w d, d = Y(centre) minus the
// mean of Y over the texel. Over a face d is smooth, so it is nearly a combination of the values Y(centre) themselves,
// whose sums over the face the projection has. The combination depends on the size alone. What it leaves of d is at
// most `beyond` at any texel, which bounds the rest of the error by that fraction of the light.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "projection/texel_weights.h"

namespace welkin::projection {

class MidpointError {
 public:
  /// Returns the one in the cache, or builds it. `weights`: those of the midpoint rule at `size`, not reduced.
  static std::shared_ptr<const MidpointError> get(int size, int bands, const TexelWeights& weights);

  MidpointError(int size, int bands, const TexelWeights& weights);

  /// Adds the part of a face's error that follows from its sums to canonical[3][bands^2]. `face_sums`: [3][bands^2] in
  /// the order of the weights.
  void add(int face, const double* face_sums, double* canonical) const noexcept;

  /// Returns a bound on the rest of the error, as a norm over all functions and a fraction of the flux.
  [[nodiscard]] double beyond() const noexcept { return beyond_; }

  [[nodiscard]] std::size_t bytes() const noexcept { return sizeof *this + combination_.size() * sizeof(double); }

 private:
  struct Samples;
  void combine(const Samples& samples);

  int bands_;
  std::vector<int> weight_rows_;
  ClassCounts counts_;
  std::vector<double> combination_;  ///< of each class [count][count]
  double beyond_ = 0.0;
};

}  // namespace welkin::projection
