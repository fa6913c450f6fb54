// What the prefilter's tests share.
#pragma once

#include "image/geometry.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/same_bits.h"
#include "welkin/image.h"
#include "welkin/reflections.h"

namespace welkin::test {

/// Directions of the centres of all texels of a level.
inline std::vector<glm::dvec3> centres(int size) {
  std::vector<glm::dvec3> directions;
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column)
        directions.push_back(image::face_direction(size, face, column + 0.5, row + 0.5));
    }
  }
  return directions;
}

struct LevelError {
  double rms = 0.0;      ///< relative to the rms of the truth
  double maximum = 0.0;  ///< of |x - t| / t
};

/// Of every `step`-th texel against `truth` there.
inline LevelError level_error(const Cubemap& chain, int level, const std::vector<glm::dvec3>& truth,
                              std::size_t step = 1) {
  const float* const rgb = chain.face(level, 0);
  LevelError error;
  double squares = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      const double t = truth[k][c];
      const double off = std::abs(static_cast<double>(rgb[3 * k * step + static_cast<std::size_t>(c)]) - t);
      squares += off * off;
      whole += t * t;
      error.maximum = std::max(error.maximum, off / std::max(std::abs(t), 1e-30));
    }
  }
  error.rms = squares > 0.0 ? std::sqrt(squares / whole) : 0.0;
  return error;
}

}  // namespace welkin::test
