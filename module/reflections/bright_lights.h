// Bright texels as lights without extent, blurred by a lobe: one by one near by, merged where they are far.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "image/geometry.h"
#include "reflections/bright_texels.h"
#include "reflections/direct.h"
#include "reflections/light_field.h"
#include "reflections/lobe.h"
#include "reflections/lobe_kernels.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// Pixels on the sphere.
struct ImageShape {
  bool cubemap = false;
  int columns = 1;  ///< of a cubemap: texels along an edge
  int rows = 1;     ///< of a lat-long

  [[nodiscard]] image::TexelGrid grid() const noexcept {
    return cubemap ? image::TexelGrid::cubemap(columns) : image::TexelGrid::lat_long(columns, rows);
  }
  [[nodiscard]] static ImageShape of(const projection::SanitizedSource& source) noexcept {
    return {source.cubemap(), source.columns(), source.cubemap() ? source.columns() : source.rows()};
  }
};

/// The lobe that blurs lights.
struct LightsLobe {
  const Lobe& lobe;
  double far_end = 0.0;  ///< above 0: only GGX's far part, which this is the end of: see `kFarPart`
  double least = 0.0;    ///< radiance of all of a GGX lobe's lights together that may be left out of a texel
};

/// The lobes that will blur lights.
enum class LightsOf { ggx, any };
struct LightLobes {
  LightsOf of = LightsOf::ggx;
  double least_alpha = 1.0;     ///< least `Lobe::width_alpha`, of all but annular ones
  double least_annular = 10.0;  ///< least `Lobe::scale` of annular ones

  void take_in(const Lobe& lobe) noexcept {
    double& least = lobe.annular() ? least_annular : least_alpha;
    least = std::min(least, lobe.annular() ? lobe.scale() : lobe.width_alpha());
  }
  /// Returns radians of a part of a light that is all but a parallelogram to annular lobes, which three cosines stand
  /// for.
  [[nodiscard]] double widest_part() const noexcept {
    return std::min(0.3 * std::sqrt(least_annular), 4.0 * least_annular);
  }
  /// Returns alpha of the GGX lobe that is as narrow as the narrowest of all.
  [[nodiscard]] double narrowest() const noexcept { return std::min(least_alpha, 4.0 / 3.0 * least_annular); }
};

/// A tree over the texels. Each node has lights that give the same through a lobe wherever the node is small relative
/// to its distance and the lobe's width: points of a Gauss rule on the part of the image that it covers, which take
/// over a light at any position by the rule's interpolation (so that every moment below the rule's order stays, in each
/// channel). A leaf is a texel, with Gauss points that stand for its area in a smooth lobe, and parts of it for where
/// the horizon cuts it; large texels, of which a parallelogram is no part, are integrated there.
class BrightLights {
 public:
  BrightLights() = default;
  /// `reach`: see `reach_for`.
  BrightLights(const std::vector<BrightTexel>& texels, const ImageShape& shape, const LightLobes& lobes, double reach);

  [[nodiscard]] bool empty() const noexcept { return nodes_.empty(); }
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Returns the maximum bytes for up to so many texels with those arguments: of the tree while it is made, and of the
  /// scratch of `workers`.
  [[nodiscard]] static std::size_t most_bytes(std::size_t texels, const ImageShape& shape, const LightLobes& lobes,
                                              std::size_t workers) noexcept;

  /// Adds to each texel of six packed RGB faces of `size` x `size` what the lights give in the direction of its centre.
  /// Returns how much of `LightsLobe::least` may be missing: nothing or all of it. The same bits on any number of
  /// threads and instruction set. Throws `Error` (cancelled).
  double add(const LightsLobe& lights, int size, const std::array<float*, 6>& faces, const Control& control) const;

  /// Returns the root mean square over the sphere of what they err, all channels together: at the horizon, and where
  /// merged. `rms`: that of a mip of `size` that they are part of, which their own does not exceed.
  [[nodiscard]] double error(const Lobe& lobe, int size, double rms) const;

 private:
  friend class LightTree;

  struct Node {
    glm::dvec3 centre{0.0};
    double radius = 0.0;  ///< of a sphere around the centre that holds all of its light
    double merged = 0.0;  ///< the same for the rule; 0: its lights are those of its leaves
    std::array<int, 2> children{-1, -1};
    LobeRun smooth{};
    LobeRun parts{};  ///< of a leaf, among the cut lights; or itself among the rectangles
  };
  /// Texels of one radiance.
  struct Rectangle {
    projection::TexelRectangle texels;
    std::array<float, 3> excess{};
  };
  struct Block;
  struct Blur;

  /// How nodes over an area are summed: at the points of a field, at its texels, or there with what the horizon cuts.
  enum class Step { field, texels, parts };

  struct Scratch;
  class ScratchPool;

  /// Returns the maximum leaves of the tree over so many texels, or over fewer of which more parts are made; and its
  /// bytes while it is made.
  [[nodiscard]] static std::size_t most_leaves(std::size_t texels, const ImageShape& shape,
                                               const LightLobes& lobes) noexcept;
  [[nodiscard]] static std::size_t tree_bytes(std::size_t texels, std::size_t leaves, const ImageShape& shape,
                                              const LightLobes& lobes) noexcept;

  void make_scratch();
  [[nodiscard]] Blur blur_of(const LightsLobe& lights) const;
  static void find_table(Blur& blur);
  void choose(const Block& block, Step step, Scratch& scratch) const;
  void sum_runs(int face, int count, const Blur& lobe, Scratch& scratch) const;
  void add_exactly(const FaceArea& area, const Blur& lobe, float* rgb, Scratch& scratch) const;
  void add_to_field(const FaceArea& area, const Blur& lobe, LightField& field, Scratch& scratch) const;
  void add_to_texels(const FaceArea& area, const Blur& lobe, const LightField& field, float* rgb,
                     Scratch& scratch) const;
  void add_to_leaf(const FaceArea& area, const Blur& lobe, const Block& block, const LightField& field,
                   std::size_t first, float* rgb, Scratch& scratch) const;
  void add_to_area(const FaceArea& area, const Blur& lobe, LightField field, std::size_t first, float* rgb,
                   Scratch& scratch) const;
  [[nodiscard]] double ggx_error(double alpha, int size, double rms) const;
  [[nodiscard]] double table_error(const Lobe& lobe, int size, double rms) const;

  /// The minimum ratio of a node's distance (and the lobe's width, see `Block::far_enough`) to its radius at which its
  /// rule suffices at the default bounds. The error falls with its fourth power.
  static constexpr double kFar = 3.0;

  std::shared_ptr<ScratchPool> scratches_;
  double far_ = 0.0;
  double edge_ = 0.0;  ///< radians of a texel
  int smooth_points_ = 2;
  double most_merged_ = 0.0;  ///< radius
  std::vector<Node> nodes_;   ///< the first is the root
  std::vector<LobeLight> lights_;
  std::vector<CutLight> cut_lights_;
  std::shared_ptr<const projection::TexelIntegrals> texels_;  ///< null: there are cut lights. Else rectangles of them
  std::vector<Rectangle> rectangles_;
  glm::dvec3 power_{0.0};
  glm::dvec3 cut_{0.0};      ///< sizes of parts^2 times colours
  double cut_square_ = 0.0;  ///< sizes^3 times squares of colours
  double squares_ = 0.0;     ///< of texels' light
  double leaning_ = 0.0;     ///< the same times squares of how much wider a part is at one end than in the middle
};

}  // namespace welkin::reflections
