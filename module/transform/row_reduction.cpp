#include "transform/row_reduction.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "transform/ring_legendre.h"

namespace welkin::transforms {
namespace {

constexpr int kFilterOrder = 5;
constexpr int kColumnsOfBand = 4;
constexpr int kStripColumns = 512;  ///< of the source, that are worked on at a time
constexpr int kTileEdges = 64;      ///< coarse edges of a tile
constexpr int kSharesBefore = 2;    ///< coarse edges before an interval that its fine edges give to
constexpr int kSharesBeyond = 2;    ///< coarse edges beyond a pole that fine edges give to

/// Fine columns that filters read beyond either end of a strip.
/// Output column i of a halving is centred between columns 2 i and 2 i + 1, and its six taps begin at 2 i - 2. So m
/// columns of margin after a halving need 2 m + 2 before it, and h halvings 2 (2^h - 1).
constexpr int margin_of(int halvings) { return 2 * ((1 << halvings) - 1); }

/// Lagrange's polynomials of the nodes -2 to 3 at 0 <= t < 1.
/// For a wave of degree k and nodes h apart, interpolation is off by max |prod (t - node)| (k h)^6 / 6! =
/// (2.5 1.5 0.5)^2 / 720 (k h)^6 = 0.005 (k h)^6, largest at t = 1/2. The transpose of the interpolation gives a step
/// at t to the six nodes: sum over nodes of share g(node) = g(t), nearly, for every g of these degrees.
std::array<double, kStepShares> shares_at(double t) {
  std::array<double, kStepShares> shares{};
  for (int k = 0; k < kStepShares; ++k) {
    double share = 1.0;
    for (int other = 0; other < kStepShares; ++other) {
      if (other != k) share *= (t + (kSharesBefore - other)) / (k - other);
    }
    shares[static_cast<std::size_t>(k)] = share;
  }
  return shares;
}

}  // namespace

ReducedShape reduced_shape(int width, int height, int bands) noexcept {
  constexpr int lanes = 2 * kRingLanes;
  ReducedShape shape;
  shape.rows = (2 * bands + lanes - 1) / lanes * lanes;
  if (width % 2 != 0 || 2 * std::int64_t{height} < 3 * std::int64_t{shape.rows}) return {};
  shape.columns = width;
  while (shape.columns % 4 == 0 && shape.columns / 2 >= kColumnsOfBand * bands) {
    shape.columns /= 2;
    ++shape.halvings;
  }
  return shape;
}

double column_response(int width, int halvings, int order) noexcept {
  // (1, 5, 10, 10, 5, 1) / 32 is ((1 + s) / 2)^5 for the shift s by a column: about its middle it multiplies
  // e^(i m lon) by cos(m d / 2)^5, d = 2 pi / width, and m d / 2 is m / (2 width) of a turn. The width halves with each
  // stage. Orders m and width / 2 - m then fall together, the latter by sin(m d / 2)^5, which is the tan^5 of the
  // header after division. Kernels divide by 16 instead of 32: the sum over half as many columns stays.
  double response = 1.0;
  for (int k = 0; k < halvings; ++k, width /= 2) {
    const double cosine =
        math::sine_cosine_of_turns(static_cast<double>(order % (2 * width)) / (2.0 * static_cast<double>(width)))
            .cosine;
    for (int power = 0; power < kFilterOrder; ++power) response *= cosine;
  }
  return response;
}

/// Columns of the source, `first` to `end`, whole ones of the result.
struct ReducedRows::Strip {
  int first;
  int end;
  int margin;  ///< beyond both ends

  [[nodiscard]] int columns() const noexcept { return end - first + 2 * margin; }
  [[nodiscard]] std::size_t floats() const noexcept { return std::size_t{3} * static_cast<std::size_t>(columns()); }
};

/// One worker's scratch: the sums of as many coarse edges as one interval gives to, and one that is thrown away.
struct ReducedRows::Scratch {
  explicit Scratch(std::size_t strip_floats)
      : stride((strip_floats + 15) / 16 * 16), floats((kStepShares + 1) * stride) {}
  [[nodiscard]] float* sums(int slot) noexcept { return floats.data() + static_cast<std::size_t>(slot) * stride; }
  [[nodiscard]] float* nowhere() noexcept { return sums(kStepShares); }

  std::size_t stride;
  platform::AlignedBuffer<float> floats;
};

ReducedRows::ReducedRows(ImageRows source, const ReducedShape& shape)
    : source_(std::move(source)),
      shape_(shape),
      kernels_(reduction_kernels()),
      row_floats_(std::size_t{3} * static_cast<std::size_t>(shape.columns)),
      rows_(row_floats_ * static_cast<std::size_t>(shape.rows + 2)) {
  find_shares();
  std::fill_n(row(row_of_zeros()), row_floats_, 0.0F);
}

std::size_t ReducedRows::most_bytes(int width, int height, int bands, std::size_t workers) noexcept {
  constexpr std::size_t kLine = 64;  // that a buffer begins on
  const ReducedShape shape = reduced_shape(width, height, bands);
  if (shape.rows == 0) return 0;
  const auto count = [](int number) { return static_cast<std::size_t>(number); };
  const std::size_t rows = 3 * count(shape.columns) * count(shape.rows + 2);
  const std::size_t shares = 3 * count(height) * kStepShares;
  const std::size_t strip = 3 * count(kStripColumns + 2 * margin_of(shape.halvings));
  const std::size_t scratch = (kStepShares + 1) * ((strip + 15) / 16 * 16);
  return sizeof(float) * (rows + shares + workers * scratch) + sizeof(int) * count(shape.rows + 1) +
         sizeof(const float*) * count(height) + (workers + 1) * (kLine + sizeof(Scratch));
}

void ReducedRows::find_shares() {
  const std::int64_t height = source_.height;
  const int equator = shape_.rows / 2;
  const auto all = static_cast<std::size_t>(height) * kStepShares;
  shares_.assign(all, 0.0F);
  beyond_.assign(all, 0.0F);
  across_.assign(all, 0.0F);
  first_edges_.assign(static_cast<std::size_t>(shape_.rows) + 1, source_.height);
  for (int edge = source_.height - 1; edge > 0; --edge) {
    const std::int64_t index = edge * std::int64_t{shape_.rows};
    const auto interval = static_cast<int>(index / height);
    for (int k = interval; k >= 0 && first_edges_[static_cast<std::size_t>(k)] > edge; --k)
      first_edges_[static_cast<std::size_t>(k)] = edge;
    const auto shares = shares_at(static_cast<double>(index % height) / static_cast<double>(height));
    const std::size_t at = static_cast<std::size_t>(edge) * kStepShares;
    double across = 0.0;
    for (int k = 0; k < kStepShares; ++k) {
      const double share = shares[static_cast<std::size_t>(k)];
      const int to = interval - kSharesBefore + k;
      const int pole_distance = to < 0 ? -to : to - shape_.rows;
      if (to >= 0 && to <= shape_.rows) {
        shares_[at + static_cast<std::size_t>(k)] = static_cast<float>(share);
      } else {
        beyond_[at + static_cast<std::size_t>(pole_distance - 1)] = static_cast<float>(share);
      }
      // J(m) = sum over rows of f Int sin^(m + 1). With Phi(theta) = Int from 0 to theta of sin^(m + 1) and summation
      // by parts from either pole, a step at theta weighs
      //   -Phi(theta) in the north,   Phi(pi - theta) in the south,
      // and the two rows next to the equator weigh g0 = Phi(pi / 2) each. As Phi(theta) + Phi(pi - theta) = 2 g0, the
      // step's weight jumps by 2 g0 at the equator, while interpolation takes it for its smooth continuation. So a
      // share that a step in the north gives beyond the equator counts 2 g0 too much, and one to the equator itself,
      // where the weight is 0 in place of -g0, counts g0 too much; those of a step in the south count as much too
      // little. The sum of the two rows, which weighs g0, makes up for that.
      // Twice what goes beyond the equator, and once what goes to it: minus from the north, plus from the south.
      const std::int64_t side = 2 * std::int64_t{edge} - height;
      if (side < 0 && to >= equator) across -= (to > equator ? 2.0 : 1.0) * share;
      if (side > 0 && to <= equator) across += (to < equator ? 2.0 : 1.0) * share;
    }
    across_[at] = static_cast<float>(0.5 * across);
  }
}

void ReducedRows::add_interval(int interval, const float* shares, const Strip& strip, bool rotated,
                               float* const* sums) noexcept {
  const int first_edge = first_edges_[static_cast<std::size_t>(interval)];
  const int edges = first_edges_[static_cast<std::size_t>(interval) + 1] - first_edge;
  if (edges <= 0) return;
  const int width = source_.width;
  int column = ((strip.first - strip.margin + (rotated ? width / 2 : 0)) % width + width) % width;
  for (int done = 0; done < strip.columns();) {
    const int count = std::min(strip.columns() - done, width - column);
    std::array<float*, kStepShares> here{};
    for (int k = 0; k < kStepShares; ++k) here[static_cast<std::size_t>(k)] = sums[k] + std::ptrdiff_t{3} * done;
    kernels_.share_steps({source_.rows.data() + first_edge - 1, std::ptrdiff_t{3} * column,
                          shares + static_cast<std::ptrdiff_t>(first_edge) * kStepShares, edges, 3 * count},
                         here.data());
    done += count;
    column = 0;
  }
}

/// Adds the shares that edges near a pole give, beyond it, to coarse edge `edge` at 180 degrees.
/// g(-theta) = (-1)^m g(theta), and a turn of the row by 180 degrees multiplies order m by (-1)^m: so the share goes to
/// the mirrored edge with the row shifted by half its width, for all orders at once.
void ReducedRows::add_beyond_pole(int edge, const Strip& strip, Scratch& scratch) noexcept {
  const bool south = edge > shape_.rows / 2;
  const int distance = south ? shape_.rows - edge : edge;
  if (distance > kSharesBeyond) return;
  std::array<float*, kStepShares> sums{};
  sums.fill(scratch.nowhere());
  sums[static_cast<std::size_t>(distance - 1)] = scratch.sums(edge % kStepShares);
  for (int k = 0; k < kSharesBeyond; ++k)
    add_interval(south ? shape_.rows - 1 - k : k, beyond_.data(), strip, true, sums.data());
}

void ReducedRows::finish(float* sums, const Strip& strip, int to) noexcept {
  int columns = strip.columns();
  for (int k = 0; k < shape_.halvings; ++k) {
    columns = columns / 2 - kFilterOrder / 2;
    kernels_.halve_columns(sums, columns, sums);
  }
  std::copy_n(sums, std::ptrdiff_t{3} * columns, row(to) + std::ptrdiff_t{3} * (strip.first >> shape_.halvings));
}

/// Computes the steps at coarse edges `first_edge` to `end_edge` - 1. Interval i gives to edges i - 2 to i + 3. Going
/// through the intervals in order, six sums are open at a time, in a ring by edge modulo 6; edge i - 2 is finished
/// after interval i. Shares for edges of other tiles go to a row that is not read. Intervals at a tile's ends are read
/// by both tiles, so every sum has its terms in one order whatever the tiles.
void ReducedRows::sum_steps(int first_edge, int end_edge, const Strip& strip, Scratch& scratch) noexcept {
  for (int interval = first_edge - kStepShares + 1 + kSharesBefore; interval < end_edge + kSharesBefore; ++interval) {
    if (interval >= 0 && interval < shape_.rows) {
      std::array<float*, kStepShares> sums{};
      for (int k = 0; k < kStepShares; ++k) {
        const int edge = interval - kSharesBefore + k;
        const bool here = edge >= first_edge && edge < end_edge;
        sums[static_cast<std::size_t>(k)] = here ? scratch.sums(edge % kStepShares) : scratch.nowhere();
      }
      add_interval(interval, shares_.data(), strip, false, sums.data());
    }
    const int edge = interval - kSharesBefore;  // no later interval gives to it
    if (edge < first_edge) continue;
    float* const sums = scratch.sums(edge % kStepShares);
    add_beyond_pole(edge, strip, scratch);
    if (edge == shape_.rows / 2) {
      std::transform(sums, sums + strip.floats(), scratch.nowhere(), [](float step) { return -0.5F * step; });
      finish(scratch.nowhere(), strip, row_of_negated_step());
      std::transform(sums, sums + strip.floats(), sums, [](float step) { return 0.5F * step; });
    }
    finish(sums, strip, edge - 1);
    std::fill_n(sums, strip.floats(), 0.0F);
  }
}

/// Half the sum of the rows next to the equator, with half of what edges give across it.
void ReducedRows::sum_equator(const Strip& strip, Scratch& scratch) noexcept {
  const int equator = shape_.rows / 2;
  float* const sum = scratch.sums(0);
  const float* const below = source_.row(source_.height / 2);
  const float* const above = source_.row((source_.height + 1) / 2 - 1);
  const int width = source_.width;
  int column = (strip.first - strip.margin + width) % width;
  for (int k = 0; k < strip.columns(); ++k) {
    for (int c = 0; c < 3; ++c)
      sum[3 * k + c] = 0.5F * below[std::ptrdiff_t{3} * column + c] + 0.5F * above[std::ptrdiff_t{3} * column + c];
    if (++column == width) column = 0;
  }
  std::array<float*, kStepShares> sums{};
  sums.fill(scratch.nowhere());
  sums[0] = sum;
  for (int interval = equator - kStepShares / 2; interval < equator + kStepShares / 2; ++interval)
    add_interval(interval, across_.data(), strip, false, sums.data());
  finish(sum, strip, row_of_half_sum());
}

void ReducedRows::fill(const Control& control) {
  const int margin = margin_of(shape_.halvings);
  const int strips = (source_.width + kStripColumns - 1) / kStripColumns;
  const int blocks = (shape_.rows - 1 + kTileEdges - 1) / kTileEdges;
  const jobs::Placement placement = jobs::placement_for(std::int64_t{source_.width} * source_.height);
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<Scratch> scratches;
  for (std::size_t k = 0; k < workers; ++k)
    scratches.emplace_back(std::size_t{3} * static_cast<std::size_t>(kStripColumns + 2 * margin));
  jobs::run_tiles(static_cast<std::size_t>(strips) * static_cast<std::size_t>(blocks + 1), placement, workers, control,
                  [&](std::size_t tile, std::size_t worker) {
                    const platform::FlushDenormalsScope flush;
                    Scratch& scratch = scratches[worker];
                    std::fill_n(scratch.floats.data(), scratch.floats.size(), 0.0F);
                    const int block = static_cast<int>(tile) / strips;
                    const int first = static_cast<int>(tile) % strips * kStripColumns;
                    const Strip strip{first, std::min(first + kStripColumns, source_.width), margin};
                    if (block == blocks) return sum_equator(strip, scratch);
                    const int first_edge = 1 + block * kTileEdges;
                    sum_steps(first_edge, std::min(first_edge + kTileEdges, shape_.rows), strip, scratch);
                  });
}

RowQuads ReducedRows::quads(int group) const noexcept {
  const int equator = shape_.rows / 2;
  const float* const black = row(row_of_zeros());
  RowQuads rows{};
  for (int lane = 0; lane < kRingLanes; ++lane) {
    const int edge = group * kRingLanes + lane + 1;
    rows.a[lane] = rows.b[lane] = rows.c[lane] = rows.d[lane] = black;
    if (edge < equator) {
      rows.a[lane] = row(edge - 1);
      rows.c[lane] = row(shape_.rows - edge - 1);
    } else if (edge == equator) {
      // (a - b) + (c - d) = S / 2 + D / 2 + D / 2 - S / 2 = D and (a - b) - (c - d) = S, with the step D and the sum S
      // at the equator: one lane has both as its even and its odd part, as in spectrum.cpp.
      rows.a[lane] = rows.d[lane] = row(row_of_half_sum());
      rows.b[lane] = row(row_of_negated_step());
      rows.c[lane] = row(edge - 1);
    }
  }
  return rows;
}

}  // namespace welkin::transforms
