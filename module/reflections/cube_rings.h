// A cubemap on rings of latitude, as transforms take it, and what that blurs, undone.
#pragma once

#include <cstddef>
#include <vector>

#include "math/elementary.h"
#include "platform/memory.h"
#include "projection/sanitized_pixels.h"
#include "reflections/bright_texels.h"
#include "welkin/core.h"
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

  /// `rings`: packed RGB floats.
  void sharpen(float* rings) const;

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

/// The environment as the transform reads it: a lat-long of sanitized pixels, its bright texels taken out.
struct Rings {
  LatLongView view{};
  platform::AlignedBuffer<float> owned{};  ///< holds the pixels where the caller's own would not do

  [[nodiscard]] std::size_t bytes() const noexcept { return owned.bytes(); }
};

/// A packed RGB float cubemap as a lat-long of 2 rows x rows texels, each the mean of the cube's texels over its area.
/// Where rows is a multiple of the faces' 2 size, a cube's texel is cut into as many parts first: edges between texels
/// are followed in steps of a part, not of a texel. The same bits on any number of threads. Throws `Error` (cancelled).
[[nodiscard]] Rings rings_of_cubemap(const CubemapView& source, int rows, const Control& control);

/// What a transform takes for a cubemap: by a `RingTable`, or, where there is none, `rings_of_cubemap` sharpened.
[[nodiscard]] Rings sharp_rings_of_cubemap(const CubemapView& source, int rows, const Control& control);

/// `source` without `bright`: itself if it is a lat-long with none, else a copy; a cubemap on `rows` rings.
[[nodiscard]] Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright,
                             int rows, const Control& control);

/// A bound on what that takes beside the rings, a `RingTable` that has yet to be made included.
[[nodiscard]] std::size_t cube_rings_bytes(int face_size, int rows);

}  // namespace welkin::reflections
