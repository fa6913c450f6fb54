#include "reflections/ring_weights.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>

#include "image/image_kernels.h"
#include "platform/memory.h"

namespace welkin::reflections {
namespace {

constexpr int kMiddle = kSpread / 2;
// A part of an edge that crosses three lines between columns reaches 3 + `kSpread` of them, which are `kShareLanes`.
// Parts are even along the edge and not in longitude, whose density 1 / (distance^2 + along^2) changes by a factor of 2
// from the middle of a face's line to its diagonal: hence half of three. Along the first edge of a line that runs away
// from the middle of +Y it changes by a factor of 5/2, or 5 in odd faces (`EdgeLine::cut` allows for it).
constexpr double kPartCells = 1.5;  ///< that a part of an edge may cross: its columns fit in `kShareLanes`
constexpr int kBandRings = 32;      ///< texels at a band's ends are weighed twice
constexpr double kGaussPoint = 0.57735026918962576;  ///< of a rule of two points, from the middle
constexpr int kEighths = 8;                          ///< of a turn: the columns of a sixteenth

/// Splits positions, in cells, into a cell and the rest from its middle.
void split(const double* positions, int count, int last_cell, int* cells, float* rest) {
  for (int i = 0; i < count; ++i) {
    cells[i] = std::clamp(static_cast<int>(positions[i]), 0, last_cell);
    rest[i] = static_cast<float>(positions[i] - cells[i] - 0.5);
  }
}

}  // namespace

/// Edges of texels, cut into parts, and what their points give. An edge lies on a line at a distance from the axis, and
/// reaches along it from one position to another, seen from above at a height.
class RingWeights::EdgeLine {
 public:
  EdgeLine(const RingWeights& weights, std::size_t edges, std::size_t parts)
      : weights_(weights), edges_(edges), first_parts_(edges + 1), memory_(parts * kPartBytes) {
    std::byte* next = memory_.data();
    const auto take = [&](auto*& values, std::size_t count) {
      values = reinterpret_cast<std::remove_reference_t<decltype(values)>>(next);
      next += count * parts * sizeof(*values);
    };
    for (double** values : {&ends_, &distances_, &positions_, &horizontals_}) take(*values, kPartPoints);
    for (float** values : {&end_shares_, &point_shares_, &across_, &along_}) take(*values, kPartPoints * kShareLanes);
    for (float** values : {&rest_, &widths_}) take(*values, kPartPoints);
    for (int** values : {&end_cells_, &point_cells_, &rings_, &all_alike_}) take(*values, kPartPoints);
    take(columns_, 1);
    std::fill_n(all_alike_, kPartPoints * parts, 0);
  }

  struct Edge {
    double distance;
    double from;
    double to;
  };
  static constexpr std::size_t kPartBytes =
      kPartPoints * (4 * sizeof(double) + (4 * kShareLanes + 2) * sizeof(float)) + (4 * kPartPoints + 1) * sizeof(int);
  [[nodiscard]] Edge& edge(int index) noexcept { return edges_[static_cast<std::size_t>(index)]; }

  /// `mirrored`: lines that run away from the middle of the face, whose longitudes count from the other end of a
  /// quadrant.
  void cut(int first, int end, double height, bool mirrored);
  /// Rings of points of this or of another cut line, for edges of the latter.
  void find_rings(const EdgeLine& line, int first, int end, double height);

  [[nodiscard]] RingEdges edges(const EdgeLine& cut) const noexcept {
    return {cut.first_parts_.data(), cut.columns_, cut.across_, rings_, along_};
  }
  [[nodiscard]] std::uint32_t first_part(int edge) const noexcept {
    return first_parts_[static_cast<std::size_t>(edge)];
  }

 private:
  /// Sets positions_ to the angles of ends_ over distances_, in columns.
  void find_longitudes(int count, bool mirrored);

  const RingWeights& weights_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> first_parts_;
  platform::AlignedBuffer<std::byte> memory_;  ///< of all that is below
  double *ends_, *distances_, *positions_, *horizontals_;
  float *end_shares_, *point_shares_, *across_, *along_, *rest_, *widths_;
  int *end_cells_, *point_cells_, *rings_, *columns_;
  int* all_alike_;  ///< columns' shares are those of one cell
};

void RingWeights::EdgeLine::find_longitudes(int count, bool mirrored) {
  // the angle from the middle of the face's line; a line that runs away from there is seen from the other axis
  weights_.find_angles(ends_, distances_, count, positions_);
  if (!mirrored) return;
  const double quarter = 0.25 * weights_.columns_;
  for (int i = 0; i < count; ++i) positions_[i] = quarter - positions_[i];
}

void RingWeights::EdgeLine::cut(int first, int end, double height, bool mirrored) {
  if (first >= end) return;
  const auto per_column = weights_.columns_ / (2.0 * std::numbers::pi);
  // The angles at an edge's ends decide the number of its parts.
  std::size_t k = 0;
  for (int index = first; index < end; ++index) {
    for (const double position : {edge(index).from, edge(index).to}) {
      ends_[k] = position;
      distances_[k++] = edge(index).distance;
    }
  }
  const auto ends = static_cast<int>(k);
  find_longitudes(ends, mirrored);
  std::uint32_t part = 0;
  for (int index = first; index < end; ++index) {
    const Edge& here = edge(index);
    const auto at = static_cast<std::size_t>(2 * (index - first));
    const double across = std::abs(positions_[at + 1] - positions_[at]);
    const double low = here.distance * here.distance + height * height;
    // With x the position on the line, the polar angle is p = atan(g / height), g = sqrt(distance^2 + x^2), so that
    //   dp / dx = x height / (g (height^2 + g^2)).
    // x / g rises and 1 / (height^2 + g^2) falls with x: the ring's change is at most (to - from) times the
    // former at `to` and the latter at `from`. On a side face g >= 1 >= height, where this rises with the height, so
    // that the height 1 of the face's edge bounds all lines.
    const double reach = (here.to - here.from) * here.to * height /
                         (std::sqrt(here.distance * here.distance + here.to * here.to) * (low + here.from * here.from));
    // Where longitude is denser at the edge's beginning than 2 times its mean, that decides.
    const double densest =
        (here.to - here.from) * here.distance / (here.distance * here.distance + here.from * here.from);
    const double cells = std::max({across, reach * per_column, 0.5 * densest * per_column});
    first_parts_[static_cast<std::size_t>(index)] = part;
    part += static_cast<std::uint32_t>(std::max(1.0, std::ceil(cells / kPartCells)));
  }
  first_parts_[static_cast<std::size_t>(end)] = part;
  k = 0;
  for (int index = first; index < end; ++index) {
    const Edge& here = edge(index);
    const std::uint32_t count = first_part(index + 1) - first_part(index);
    const double step = (here.to - here.from) / count;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double low = i == 0 ? here.from : here.from + i * step;
      const double high = i + 1 == count ? here.to : here.from + (i + 1) * step;
      for (const double position : {low, high}) {
        ends_[k] = position;
        distances_[k++] = here.distance;
      }
    }
  }
  const auto count = static_cast<int>(k);
  find_longitudes(count, mirrored);
  const RingShares& shares = weights_.shares_;
  const int last_column = 2 * weights_.rows_;
  split(positions_, count, last_column, end_cells_, rest_);
  weights_.kernels_.evaluate_shares(shares.columns_before.data(), all_alike_, rest_, count, end_shares_);
  for (std::size_t i = 0; i < k; i += 2) {
    const double middle = 0.5 * (ends_[i] + ends_[i + 1]);
    const double half = 0.5 * (ends_[i + 1] - ends_[i]);
    for (std::size_t point = i; point < i + 2; ++point) {
      const double along = middle + (point == i ? -kGaussPoint : kGaussPoint) * half;
      const double square = distances_[point] * distances_[point] + along * along;
      ends_[point] = along;
      horizontals_[point] = std::sqrt(square);
      // the longitude is atan(along / distance), whose slope is distance / (distance^2 + along^2); half the part's
      // length stands for each of the two points
      widths_[point] = static_cast<float>(per_column * half * distances_[point] / square);
    }
  }
  find_longitudes(count, mirrored);
  split(positions_, count, last_column, point_cells_, rest_);
  weights_.kernels_.evaluate_shares(shares.columns.data(), all_alike_, rest_, count, point_shares_);
  weights_.kernels_.share_columns(
      {end_cells_, end_shares_, point_cells_, point_shares_, widths_, count / kPartPoints, mirrored}, columns_,
      across_);
}

void RingWeights::EdgeLine::find_rings(const EdgeLine& line, int first, int end, double height) {
  if (first >= end) return;
  const auto from = std::size_t{kPartPoints} * line.first_part(first);
  const auto count = static_cast<int>(std::size_t{kPartPoints} * line.first_part(end) - from);
  std::fill_n(distances_, count, height);
  // the polar angle atan(horizontal / height), in rings
  weights_.find_angles(line.horizontals_ + from, distances_, count, positions_);
  split(positions_, count, weights_.rows_ / 2, rings_ + from, rest_);
  weights_.kernels_.evaluate_shares(weights_.shares_.rings_before.data(), rings_ + from, rest_, count,
                                    along_ + kShareLanes * from);
}

/// The scratch of one thread.
class RingWeights::Workspace {
 public:
  explicit Workspace(const RingWeights& weights);

  EdgeLine side;  ///< of -Z, cut once
  EdgeLine lines[2];
  EdgeLine steps;  ///< of +Y: edges that run away from the middle of the face, of one row of texels
  std::vector<float> block;
};

/// An edge has one part, and more where it crosses many rings or columns: those of a line's edges add up to less than a
/// third of the columns, 2 rows / 3, and each part beyond the first stands for kPartCells = 1.5 of them.
std::size_t RingWeights::parts_of_line(int texels, int rows) noexcept {
  constexpr int kRounding = 16;
  return static_cast<std::size_t>(texels + rows / 2 + kRounding);
}

std::size_t RingWeights::making_bytes(int face_size, int rows, std::size_t threads) noexcept {
  constexpr std::size_t kLines = 4;  // of a `Workspace`
  constexpr std::size_t kCornerBytes = 12;
  constexpr std::size_t kTexelBytes = 20;  // with images along the sixteenth's edges
  const int texels = (face_size + 1) / 2;
  const auto corners = static_cast<std::size_t>(texels + 1) * static_cast<std::size_t>(texels + 1);
  const auto near_corners =
      static_cast<std::size_t>(texels + 2 * kSpread) * static_cast<std::size_t>(texels + 2 * kSpread);
  const std::size_t bands = static_cast<std::size_t>(std::max(1, rows / 2 / kBandRings));
  const std::size_t shares = sizeof(float) * kSharePowers * kShareLanes * static_cast<std::size_t>(rows / 2 + 3);
  const auto rings = static_cast<std::size_t>(rows / 2 + 2 * kSpread);
  const std::size_t block =
      sizeof(float) * (rings / static_cast<std::size_t>(texels) + 2 * kSpread) * (rings / 2 + 2 * kSpread);
  return kCornerBytes * corners + kTexelBytes * near_corners + shares +
         std::min(bands, threads) * (kLines * EdgeLine::kPartBytes * parts_of_line(texels, rows) + block);
}

std::size_t RingWeights::bytes() const noexcept {
  const std::size_t corners = side_rings_.size() + top_rings_.size() + top_columns_.size() + side_columns_.size();
  return sizeof(*this) + corners * sizeof(int) + shares_.rings_before.size() * sizeof(float) +
         lines_.size() * sizeof(double) + texel_count_ * (sizeof(std::uint16_t) + sizeof(std::uint32_t)) +
         images_.size() * sizeof(ImageRecord) + texel_rows_.size() * sizeof(TexelRow);
}

RingWeights::Workspace::Workspace(const RingWeights& weights)
    : side(weights, static_cast<std::size_t>(weights.texels_), weights.parts_),
      lines{{weights, static_cast<std::size_t>(weights.texels_), weights.parts_},
            {weights, static_cast<std::size_t>(weights.texels_), weights.parts_}},
      steps(weights, static_cast<std::size_t>(weights.texels_ + 1), weights.parts_),
      block(weights.block_floats_ + kShareLanes) {
  const std::vector<double>& lines_on_face = weights.lines_;
  for (int k = 0; k < weights.texels_; ++k) {
    const auto at = static_cast<std::size_t>(k);
    side.edge(k) = {1.0, lines_on_face[at], lines_on_face[at + 1]};
  }
  side.cut(0, weights.texels_, 1.0, false);
}

RingWeights::RingWeights(int face_size, int rows, const RingKernels& kernels)
    : texels_((face_size + 1) / 2),
      rows_(rows),
      columns_(2 * rows),
      shares_(rows),
      kernels_(kernels),
      parts_(parts_of_line(texels_, rows)) {
  const int odd = face_size % 2;
  for (int k = 0; k <= texels_; ++k) lines_.push_back(k == 0 ? 0.0 : (2.0 * k - odd) / face_size);
  for (int row = 0; row < texels_; ++row) {
    texel_rows_.push_back({{1 - odd, 2 * row + 1 - odd, -face_size}, texels_, texel_count_});
    texel_count_ += static_cast<std::uint32_t>(texels_);
  }
  for (int row = 0; row < texels_; ++row) {
    texel_rows_.push_back({{1 - odd, face_size, -(2 * row + 1 - odd)}, row + 1, texel_count_});
    texel_count_ += static_cast<std::uint32_t>(row + 1);
  }
  find_corners();
  find_images();
}

/// Angles of the points (x, y) from the x axis, in columns; a ring is as high as a column is wide.
void RingWeights::find_angles(const double* y, const double* x, int count, double* angles) const {
  image::image_kernels().angle_positions(y, x, count, 0.25 * columns_, 0.0, angles);
}

void RingWeights::find_corners() {
  const auto edge = static_cast<std::size_t>(texels_ + 1);
  std::vector<double> y(edge);
  std::vector<double> x(edge);
  std::vector<double> angles(edge);
  const auto find = [&](int* to) {
    find_angles(y.data(), x.data(), texels_ + 1, angles.data());
    std::transform(angles.begin(), angles.end(), to, [](double angle) { return static_cast<int>(angle); });
  };
  side_columns_.resize(edge);
  for (std::vector<int>* list : {&side_rings_, &top_rings_, &top_columns_}) list->resize(edge * edge);
  std::fill(x.begin(), x.end(), 1.0);
  std::copy(lines_.begin(), lines_.end(), y.begin());
  find(side_columns_.data());
  for (int row = 0; row <= texels_; ++row) {
    const double line = lines_[static_cast<std::size_t>(row)];
    std::copy(lines_.begin(), lines_.end(), y.begin());
    std::fill(x.begin(), x.end(), line);
    find(top_columns_.data() + corner(row, 0));
    for (std::size_t k = 0; k < edge; ++k) y[k] = std::sqrt(1.0 + lines_[k] * lines_[k]);
    find(side_rings_.data() + corner(row, 0));
    for (std::size_t k = 0; k < edge; ++k) y[k] = std::sqrt(line * line + lines_[k] * lines_[k]);
    std::fill(x.begin(), x.end(), 1.0);
    find(top_rings_.data() + corner(row, 0));
  }
}

// The corners that are nearest to the pole and farthest from it, and their longitudes: on -Z the polar angle grows with
// the column and falls with the row, longitude is the column's alone; on +Y the polar angle grows with both, and
// longitude atan(x / |z|) falls with the row and grows with the column, up to the diagonal, an eighth of a turn.
RingWindow RingWeights::window(int row, int column) const noexcept {
  const bool top = row >= texels_;
  const int line = top ? row - texels_ : row;
  const auto at = static_cast<std::size_t>(column);
  const int first_ring = top ? top_rings_[corner(line, column)] : side_rings_[corner(line + 1, column)];
  const int last_ring = top ? top_rings_[corner(line + 1, column + 1)] : side_rings_[corner(line, column + 1)];
  const int first_column = top ? top_columns_[corner(line + 1, column)] : side_columns_[at];
  int last_column = top ? columns_ / kEighths : side_columns_[at + 1];
  if (top && line != column) last_column = top_columns_[corner(line, column + 1)];
  return {first_ring - kMiddle, last_ring - first_ring + kSpread, first_column - kMiddle,
          last_column - first_column + kSpread};
}

std::uint32_t RingWeights::images_of(const RingWindow& window) const noexcept {
  const int width = columns_ / kEighths;
  const int end_column = window.first_column + window.columns;
  const int end_ring = window.first_ring + window.rings;
  if (window.first_ring >= 0 && end_ring <= rows_ / 2 && window.first_column >= 0 && end_column <= width) return 0;
  std::uint32_t bits = 0;
  const auto add = [&](int ring) {
    for_folded(ring, window.first_column, window.columns, rows_, width,
               [&](const RingCells& cells, int) { bits |= 1U << static_cast<unsigned>(cells.image); });
  };
  if (window.first_ring < 0) add(window.first_ring);
  if (end_ring > rows_ / 2) add(end_ring - 1);
  if (end_ring > 0 && window.first_ring < rows_ / 2) add(std::max(0, window.first_ring));
  return bits & ~1U;
}

void RingWeights::find_images() {
  image_bits_.reserve(texel_count_);
  first_images_.reserve(texel_count_);
  for (std::size_t row = 0; row < texel_rows_.size(); ++row) {
    for (int column = 0; column < texel_rows_[row].count; ++column) {
      const RingWindow here = window(static_cast<int>(row), column);
      const std::uint32_t bits = images_of(here);
      const auto record = static_cast<std::uint32_t>(image_bits_.size());
      image_bits_.push_back(static_cast<std::uint16_t>(bits));
      first_images_.push_back(texel_count_ + static_cast<std::uint32_t>(images_.size()));
      for (int image = 1; image < kRingImages; ++image) {
        if ((bits >> static_cast<unsigned>(image) & 1U) != 0) images_.push_back({record, image});
      }
      block_floats_ = std::max(
          block_floats_, static_cast<std::size_t>(here.rings) * static_cast<std::size_t>(here.columns + kShareLanes));
    }
  }
}

int RingWeights::bands() const noexcept { return std::max(1, rows_ / 2 / kBandRings); }

int RingWeights::first_ring(int band) const noexcept { return band * (rows_ / 2) / bands(); }

RingWeights::Clip RingWeights::clip_of(int band) const noexcept {
  return {band == 0 ? -kSpread : first_ring(band), band + 1 == bands() ? rows_ / 2 + kSpread : first_ring(band + 1)};
}

/// Windows lie farther from the pole from texel to texel, so that two bisections find the texels of a clip.
RingWeights::Range RingWeights::range_of(int row, const Clip& clip) const {
  const int count = texel_rows_[static_cast<std::size_t>(row)].count;
  const auto first_where = [&](const auto& reached) {
    int low = 0;
    int high = count;
    while (low < high) {
      const int middle = (low + high) / 2;
      if (reached(window(row, middle)))
        high = middle;
      else
        low = middle + 1;
    }
    return low;
  };
  const int first = first_where([&](const RingWindow& here) { return here.first_ring + here.rings > clip.first; });
  const int end = first_where([&](const RingWindow& here) { return here.first_ring >= clip.end; });
  return {first, std::max(first, end)};
}

void RingWeights::count(int band, std::uint32_t* counts) const {
  const Clip clip = clip_of(band);
  const int width = columns_ / kEighths;
  for (int row = 0; row < 2 * texels_; ++row) {
    const Range range = range_of(row, clip);
    for (int column = range.first; column < range.end; ++column) {
      const RingWindow here = window(row, column);
      const int end = std::min(clip.end, here.first_ring + here.rings);
      for (int ring = std::max(clip.first, here.first_ring); ring < end; ++ring) {
        for_folded(ring, here.first_column, here.columns, rows_, width, [&](const RingCells& cells, int) {
          std::uint32_t* count = counts + (cells.ring - first_ring(band)) * width + cells.column;
          for (int k = 0; k < cells.count; ++k, count += cells.step) ++*count;
        });
      }
    }
  }
}

WeighedTexel RingWeights::texel(int row, int column, const Clip& clip) const noexcept {
  const std::uint32_t record = record_of(row, column);
  return {window(row, column), clip.first, clip.end, {}, 0, record, image_bits_[record], first_images_[record]};
}

/// Calls `weigh` with each row of a face that has texels in the clip, after `find` with the lines below it and above it
/// and the edges of theirs that this row or the one beyond takes.
template <class Find, class Weigh>
void RingWeights::walk(int first_row, const Clip& clip, const Find& find, const Weigh& weigh) const {
  Range before{0, 0};
  int ready = -1;  // the line whose rings are known
  Range here = range_of(first_row, clip);
  for (int row = 0; row < texels_; ++row) {
    const Range after = row + 1 < texels_ ? range_of(first_row + row + 1, clip) : Range{0, 0};
    if (here.first < here.end) {
      const auto find_for = [&](int line, const Range& one, const Range& other) {
        const bool both = one.first < one.end && other.first < other.end;
        find(line, Range{both ? std::min(one.first, other.first) : here.first,
                         both ? std::max(one.end, other.end) : here.end});
      };
      if (ready != row) find_for(row, before, here);
      find_for(row + 1, here, after);
      ready = row + 1;
      weigh(row, here);
    }
    before = here;
    here = after;
  }
}

// A side face's vertical edges are meridians, along which the longitude does not change: the lower edge of a texel is
// its outer one, the upper edge its inner one. All lines of the face have the same longitudes and parts (`side`); the
// height of a line decides its rings.
void RingWeights::weigh_side(const Clip& clip, const RingBand& band, Workspace& workspace) const {
  EdgeLine& side = workspace.side;
  const auto find = [&](int line, const Range& range) {
    workspace.lines[line % 2].find_rings(side, range.first, range.end, lines_[static_cast<std::size_t>(line)]);
  };
  walk(0, clip, find, [&](int row, const Range& here) {
    const RingEdges lower = workspace.lines[row % 2].edges(side);
    const RingEdges upper = workspace.lines[(row + 1) % 2].edges(side);
    for (int column = here.first; column < here.end; ++column) {
      WeighedTexel weighed = texel(row, column, clip);
      const std::uint32_t first = side.first_part(column);
      const std::uint32_t end = side.first_part(column + 1);
      weighed.edges[weighed.edge_count++] = {&lower, first, end, false};
      weighed.edges[weighed.edge_count++] = {&upper, first, end, true};
      kernels_.weigh_texel(weighed, band, workspace.block.data());
    }
  });
}

// In +Y's texels |z| lies between two lines and x between two others, x <= |z|. The edges at the larger |z| and the
// larger x are outer ones. From a texel on the diagonal the half with x <= |z| belongs to the sixteenth; its long side
// is a meridian and gives nothing, like the edges on x = 0: so one edge counts in the middle of the face, two on the
// diagonal, three at x = 0 and four elsewhere.
void RingWeights::weigh_top(const Clip& clip, const RingBand& band, Workspace& workspace) const {
  constexpr double kHeight = 1.0;
  EdgeLine& steps = workspace.steps;
  const auto cut = [&](EdgeLine& edges, int first, int end, bool mirrored, const auto& edge_of) {
    for (int k = first; k < end; ++k) edges.edge(k) = edge_of(static_cast<std::size_t>(k));
    edges.cut(first, end, kHeight, mirrored);
    edges.find_rings(edges, first, end, kHeight);
  };
  const auto find = [&](int line, const Range& range) {
    const double distance = lines_[static_cast<std::size_t>(line)];
    // A line has edges up to the diagonal.
    cut(workspace.lines[line % 2], range.first, std::min(line, range.end), false, [&](std::size_t k) {
      return EdgeLine::Edge{distance, lines_[k], lines_[k + 1]};
    });
  };
  walk(texels_, clip, find, [&](int row, const Range& here) {
    const auto at = static_cast<std::size_t>(row);
    cut(steps, std::max(1, here.first), std::min(row, here.end) + 1, true, [&](std::size_t k) {
      return EdgeLine::Edge{lines_[k], lines_[at], lines_[at + 1]};
    });
    const EdgeLine& near_line = workspace.lines[row % 2];
    const EdgeLine& far_line = workspace.lines[(row + 1) % 2];
    const RingEdges near_edges = near_line.edges(near_line);
    const RingEdges far_edges = far_line.edges(far_line);
    const RingEdges step_edges = steps.edges(steps);
    for (int column = here.first; column < here.end; ++column) {
      WeighedTexel weighed = texel(texels_ + row, column, clip);
      const auto add = [&](const RingEdges& edges, const EdgeLine& line, int edge, bool inner) {
        weighed.edges[weighed.edge_count++] = {&edges, line.first_part(edge), line.first_part(edge + 1), inner};
      };
      add(far_edges, far_line, column, false);
      if (column < row) add(step_edges, steps, column + 1, false);
      if (column < row) add(near_edges, near_line, column, true);
      if (column > 0) add(step_edges, steps, column, true);
      kernels_.weigh_texel(weighed, band, workspace.block.data());
    }
  });
}

void RingWeights::weigh(int band, std::uint32_t* next, RingTap* taps) const {
  Workspace workspace(*this);
  const RingBand to{shares_.whole.data(), rows_, first_ring(band), columns_ / kEighths, next, taps};
  weigh_side(clip_of(band), to, workspace);
  weigh_top(clip_of(band), to, workspace);
}

}  // namespace welkin::reflections
