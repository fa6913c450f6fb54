// The other half of the split sum: how much of the light a GGX surface (or sheen) sends back, by angle and roughness.
//
//   auto table = welkin::brdf_table();                               // 64 x 64, split sum, sheen in the third channel
//   auto dfg = welkin::brdf_table({128, 128, welkin::BrdfModel::multiple_scattering});
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "welkin/control.h"
#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

/// What the first two channels hold. With V the height-correlated Smith visibility (Heitz 2014, equation 99), F
/// Schlick's Fresnel and alpha = roughness squared, E = Int D V F (n.l) dl over the lights' hemisphere is
///
///   E = f0 Int D V (n.l) (1 - (1 - v.h)^5) dl + Int D V (n.l) (1 - v.h)^5 dl = f0 scale + bias.
enum class BrdfModel {
  split_sum,            ///< (scale, bias) (Karis 2013, Real Shading in Unreal Engine 4): E = f0 scale + bias
  multiple_scattering,  ///< (bias, scale + bias): E = (1 - f0) x + f0 y, as Filament's DFG has them. y is the whole
                        ///< albedo, which its energy compensation 1 + f0 (1 / y - 1) needs
};

/// What the table holds.
struct BrdfTableOptions {
  int width = 64;                          ///< along N.V, 1 to 4096: column i is at N.V = (i + 0.5) / width
  int height = 64;                         ///< along perceptual roughness, 1 to 4096: row j is at (j + 0.5) / height
  BrdfModel model = BrdfModel::split_sum;  ///< what red and green are

  /// A third channel: directional albedo of Charlie sheen, D of Estevez and Kulla 2017 (Production Friendly Microfacet
  /// Sheen BRDF) with alpha = roughness squared, with the visibility 1 / (4 (n.l + n.v - n.l n.v)) of Neubelt and
  /// Pettineo 2013: that is what Filament and three.js shade with, and the table must fit the shader. (Charlie's own
  /// lambda is for path tracers.) That visibility does not keep energy: below a roughness of 0.4 or so the albedo
  /// exceeds 1 at grazing angles (8 at 0.05, hundreds below), for which renderers bound roughness from below.
  bool sheen = true;

  friend bool operator==(const BrdfTableOptions&, const BrdfTableOptions&) = default;
};

/// The table: reflectance of a surface in even light, by the cosine to the viewer and by roughness.
struct BrdfTable {
  BrdfTableOptions options;   ///< those that it was made with
  int channels = 2;           ///< 3 with sheen
  std::vector<float> values;  ///< height x width x channels, row 0 at the lowest roughness

  /// The same as IEEE half floats, rounded to nearest, ties to even; beyond 65504: 65504.
  [[nodiscard]] std::vector<std::uint16_t> half_values() const;
  /// Memory of `values`.
  [[nodiscard]] std::size_t bytes() const noexcept { return values.size() * sizeof(float); }
};

/// The table, by deterministic quadrature: absolute error below 1e-5 in every texel, sheen above 1 by 1e-5 of its
/// value. Tables depend on no scene: those that were used last are kept, up to 32 MiB of them, and shared; larger ones
/// are made at every call. Cost: some 0.6 microseconds a texel and thread with AVX-512, and as much again for sheen.
/// The same bits on any number of threads and instruction set. Throws `Error`: invalid_argument, cancelled.
[[nodiscard]] std::shared_ptr<const BrdfTable> brdf_table(const BrdfTableOptions& options = {},
                                                          const Control& control = {});

}  // namespace welkin
