// What rings of latitude blur of a cubemap on its way to harmonics, undone.
#pragma once

#include <vector>

#include "math/elementary.h"
#include "welkin/image.h"

namespace welkin::reflections {

/// A lat-long whose texels are means of a cubemap's over their areas (`rings_of_cubemap`), and are taken as areas by
/// the transform: light that lay at x of a texel's width, 0 to 1, comes to lie at its edges, 1 - x and x of it. That
/// blurs by a variance of x (1 - x) h^2 along each axis, h a texel's width: h^2 / 6 in the mean over an edge that
/// crosses texels at all places. What flows between neighbours, x (1 - x) / 2 of their difference, takes the blur back,
/// right to the fourth order of h. Along a column that is 1/12 but for the equator; along a row, 1/12 but for the edges
/// between a side face's columns of texels: they are meridians, each with an x of its own. The edges of cubemaps of an
/// even size at the equator, and those that part faces or halve them, lie on the lat-long's own edges: x = 0.
class RingSharpener {
 public:
  /// `rows`: a multiple of 2 `face_size`; the lat-long is twice as wide.
  RingSharpener(int rows, int face_size);

  void sharpen(LatLongImage& rings) const;

 private:
  /// An edge of the lat-long's columns: the share of 1/12 that flows through it near the equator.
  struct ColumnEdge {
    float flow = 1.0F;
    double reach = 0.0;  ///< tangent of the latitude where that ends
  };

  void add_meridian(double turns, double reach);
  [[nodiscard]] math::SineCosine edge_of(int row) const;  ///< between `row` - 1 and `row`
  [[nodiscard]] double mean_sine(int row) const;
  [[nodiscard]] double steepness(int row) const;   ///< tangent of the latitude of its middle, positive
  [[nodiscard]] double flow_above(int row) const;  ///< sine at its upper edge, 0 where nothing flows
  [[nodiscard]] float flow_before(int column, double steepness) const;

  int rows_;
  bool even_;
  std::vector<ColumnEdge> columns_;  ///< the edge before each column
};

}  // namespace welkin::reflections
