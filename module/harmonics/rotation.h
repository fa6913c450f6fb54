// The matrices by which an orthogonal map of directions acts on the harmonics of each band.
#pragma once

#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>

#include "welkin/spherical_harmonics.h"

namespace welkin::harmonics {

/// Matrices of the bands 0, 1, 2, ..., one after the other, each from the one before:
/// c'(l, m) = sum over n of at(m, n) c(l, n) are the coefficients of d -> f(map^-1 d).
///
/// `map` must be orthogonal; mirrors are as good as rotations, since a band's matrix is what band 1's makes of a
/// product of harmonics. Error below 1e-13 to band 15. Cost: some 20 flops and three square roots per entry.
class BandRotation {
 public:
  /// Band 0.
  explicit BandRotation(const glm::dmat3& map);

  [[nodiscard]] int band() const noexcept { return band_; }

  /// -band() <= m, n <= band().
  [[nodiscard]] double at(int m, int n) const noexcept { return here()[index(band_, m, n)]; }

  /// Goes on to the next band.
  void advance();

 private:
  static constexpr int kWidest = 2 * kMaximumBands - 1;
  using Matrix = std::array<double, static_cast<std::size_t>(kWidest) * kWidest>;

  [[nodiscard]] const Matrix& here() const noexcept { return matrices_[static_cast<unsigned>(band_) % 2U]; }
  [[nodiscard]] static std::size_t index(int l, int m, int n) noexcept {
    return static_cast<std::size_t>((m + l) * (2 * l + 1) + n + l);
  }
  [[nodiscard]] double linear(int m, int n) const noexcept { return linear_[m + 1][n + 1]; }
  [[nodiscard]] double before(int m, int n) const noexcept {
    return matrices_[static_cast<unsigned>(band_ + 1) % 2U][index(band_ - 1, m, n)];
  }
  [[nodiscard]] double product(int i, int m, int n) const noexcept;
  [[nodiscard]] double entry(int m, int n) const noexcept;

  int band_ = 0;
  double linear_[3][3];  ///< band 1: the map in the order y, z, x
  Matrix matrices_[2];   ///< of this band and the one before, in turn
};

/// Rotates bands 2 and up in place by an orthogonal map: about z, y and z, after an inversion if it is a mirror.
///
/// A turn about z takes four products per pair of coefficients. One about y is one about z between two swaps of y and
/// z, which are one fixed, sparse matrix per band (D. Pinchon and P. E. Hoggan, "Rotation matrices for real spherical
/// harmonics: general rotations of atomic orbitals in space-fixed axes", J. Phys. A 40, 2007, 1597-1610).
void rotate_bands(const glm::dmat3& map, SphericalHarmonics& harmonics);

}  // namespace welkin::harmonics
