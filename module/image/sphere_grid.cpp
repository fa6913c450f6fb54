// A row of a face and its mirror image, on all faces alike, share their positions on the rings; so these are found
// once for the four faces round the equator, and once for the two at the poles.
#include "image/sphere_grid.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "image/image_kernels.h"
#include "jobs/tiles.h"
#include "platform/memory.h"

namespace welkin::image {
namespace {

constexpr std::size_t kTexelBytes = 4 * sizeof(float);

float mean(float a, float b) noexcept { return 0.5F * a + 0.5F * b; }

}  // namespace

void SphereGrid::fill_sides(int first, int count) noexcept {
  for (int ring = first; ring < first + count; ++ring) {
    for (int k = 0; k < kBorder; ++k) {  // one by one: a ring may have fewer texels than the border
      const int wrapped_left = ((columns_ - 1 - k) % columns_ + columns_) % columns_;
      std::memcpy(texel(-1 - k, ring), texel(wrapped_left, ring), kTexelBytes);
      std::memcpy(texel(columns_ + k, ring), texel(k % columns_, ring), kTexelBytes);
    }
  }
}

void SphereGrid::fill_poles() noexcept {
  const int half_turn = columns_ / 2;
  for (int beyond = 1; beyond <= kBorder; ++beyond) {
    const int distance = (beyond - 1) % (2 * rings_);  // over one pole, and with few rings over the other one too
    const bool over_both = distance >= rings_;
    const int top_source = over_both ? 2 * rings_ - 1 - distance : distance;
    const int bottom_source = rings_ - 1 - top_source;
    for (int column = 0; column < columns_; ++column) {
      const int from = over_both ? column : (column + half_turn) % columns_;
      const int next = over_both || columns_ % 2 == 0 ? from : (from + 1) % columns_;
      for (int c = 0; c < 4; ++c) {
        texel(column, -beyond)[c] = mean(texel(from, top_source)[c], texel(next, top_source)[c]);
        texel(column, rings_ - 1 + beyond)[c] = mean(texel(from, bottom_source)[c], texel(next, bottom_source)[c]);
      }
    }
    fill_sides(-beyond, 1);
    fill_sides(rings_ - 1 + beyond, 1);
  }
}

namespace {

constexpr int kTileTexels = 16384;
constexpr int kInlineTexels = 16384;  // some 50 microseconds

constexpr int kFaceX = 0;
constexpr int kFaceMinusX = 1;
constexpr int kFaceY = 2;
constexpr int kFaceMinusY = 3;
constexpr int kFaceZ = 4;
constexpr int kFaceMinusZ = 5;
constexpr std::array<int, 4> kSides{kFaceX, kFaceMinusX, kFaceZ, kFaceMinusZ};

/// Between which texels of the grid a row's points lie along one axis, and with which weights.
struct Taps {
  std::int32_t* first = nullptr;
  float* weights = nullptr;  ///< four of each point
};

/// Memory of taps: one piece, because small faces take no longer than some hundred allocations.
struct TapsMemory {
  TapsMemory(int points, std::size_t count)
      : size(static_cast<std::size_t>(points)), first(count * size), weights(4 * count * size) {}
  [[nodiscard]] Taps at(std::size_t index) noexcept {
    return {first.data() + index * size, weights.data() + 4 * index * size};
  }

  std::size_t size;  ///< points of a row
  platform::AlignedBuffer<std::int32_t> first;
  platform::AlignedBuffer<float> weights;
};

/// The taps of one row of a face.
struct RowTaps {
  Taps rings;
  Taps front;  ///< polar faces: columns where z >= 0
  Taps back;   ///< and where z < 0
};

/// One worker's scratch.
struct Scratch {
  Scratch(int size, int rows)
      : across(static_cast<std::size_t>(size)),
        along(static_cast<std::size_t>(size)),
        angles(static_cast<std::size_t>(size)),
        positions(static_cast<std::size_t>(size)),
        taps(size, 3 * static_cast<std::size_t>(rows)) {}

  std::vector<double> across, along, angles, positions;
  TapsMemory taps;
};

/// Rows [first, end) of the upper half of a face.
struct Rows {
  int first;
  int end;
};

class FaceSampler {
 public:
  FaceSampler(const SphereGrid& grid, int size, const std::array<float*, 6>& faces, const GridSampling& sampling)
      : grid_(grid),
        size_(size),
        half_((size + 1) / 2),
        faces_(faces),
        sampling_(sampling),
        rings_a_quarter_(0.5 * grid.rings()),
        columns_a_quarter_(0.25 * grid.columns()),
        side_taps_(size, kSides.size()),
        distances_(static_cast<std::size_t>(half_)) {
    for (int column = 0; column < half_; ++column) distances_[static_cast<std::size_t>(column)] = distance(column);
    side_lengths_.resize(distances_.size());
    kernels_.plane_lengths(distances_.data(), 1.0, half_, side_lengths_.data());
    place_side_columns();
  }

  /// Rows of the four side faces, and their rows opposite. Face after face: rows side by side share most of their
  /// rings, and a processor foresees a few runs of memory but not 32 at a time.
  void sample_sides(const Rows& rows, Scratch& scratch) const {
    for (int row = rows.first; row < rows.end; ++row) place_side_rings(row, scratch, taps_of(rows, row, scratch).rings);
    for (std::size_t side = 0; side < kSides.size(); ++side) {
      for (const bool below : {false, true}) {
        for (int row = rows.first; row < rows.end; ++row) {
          if (below && row == opposite(row)) continue;
          sample_row(kSides[side], below ? opposite(row) : row, below, taps_of(rows, row, scratch).rings,
                     side_columns_[side]);
        }
      }
    }
  }

  /// Samples rows of the faces +Y and -Y. On +Y the upper rows have z < 0, on -Y the lower ones.
  void sample_poles(const Rows& rows, Scratch& scratch) const {
    for (int row = rows.first; row < rows.end; ++row) place_polar_taps(row, scratch, taps_of(rows, row, scratch));
    for (const bool below : {false, true}) {
      for (const bool front : {false, true}) {
        for (int row = rows.first; row < rows.end; ++row) {
          if (!front && row == opposite(row)) continue;
          const RowTaps taps = taps_of(rows, row, scratch);
          sample_row(below ? kFaceMinusY : kFaceY, front == below ? row : opposite(row), below, taps.rings,
                     front ? taps.front : taps.back);
        }
      }
    }
  }

  [[nodiscard]] int half() const noexcept { return half_; }

 private:
  /// |u| of a column, |v| of a row, in the first half.
  [[nodiscard]] double distance(int index) const noexcept { return static_cast<double>(size_ - 1 - 2 * index) / size_; }
  [[nodiscard]] int opposite(int row) const noexcept { return size_ - 1 - row; }

  void take_taps(const std::vector<double>& positions, const Taps& taps) const {
    const bool cubic = grid_.content() == GridContent::spline_coefficients;
    kernels_.position_taps(positions.data(), size_, cubic, taps.first, taps.weights);
  }

  [[nodiscard]] static RowTaps taps_of(const Rows& rows, int row, Scratch& scratch) {
    const std::size_t index = 3 * static_cast<std::size_t>(row - rows.first);
    return {scratch.taps.at(index), scratch.taps.at(index + 1), scratch.taps.at(index + 2)};
  }

  void place_side_rings(int row, Scratch& scratch, const Taps& rings) const {
    std::fill_n(scratch.across.begin(), half_, distance(row));
    kernels_.angle_positions(scratch.across.data(), side_lengths_.data(), half_, -rings_a_quarter_,
                             0.5 * grid_.rings() - 0.5, scratch.positions.data());
    place_rings(scratch, rings);
  }

  void place_polar_taps(int row, Scratch& scratch, const RowTaps& taps) const {
    kernels_.plane_lengths(distances_.data(), distance(row), half_, scratch.across.data());
    std::fill_n(scratch.along.begin(), half_, 1.0);
    kernels_.angle_positions(scratch.across.data(), scratch.along.data(), half_, rings_a_quarter_, -0.5,
                             scratch.positions.data());
    place_rings(scratch, taps.rings);
    place_polar_columns(row, scratch, taps);
  }

  /// Fills in the positions of the right half from those of the left half.
  void place_rings(Scratch& scratch, const Taps& rings) const {
    for (int column = half_; column < size_; ++column) {
      scratch.positions[static_cast<std::size_t>(column)] =
          scratch.positions[static_cast<std::size_t>(opposite(column))];
    }
    take_taps(scratch.positions, rings);
  }

  /// Fills in left(angle) for the columns with u <= 0 and right(angle) for the others; `angles`: of the
  /// left half, in columns of the grid. The grid's columns run against longitude, column c's centre being at
  /// columns / 2 - 1/2 - c past +z.
  template <class Left, class Right>
  void fill(const double* angles, std::vector<double>& positions, const Left& left, const Right& right) const {
    for (int column = 0; column < half_; ++column) positions[static_cast<std::size_t>(column)] = left(angles[column]);
    for (int column = half_; column < size_; ++column) {
      positions[static_cast<std::size_t>(column)] = right(angles[opposite(column)]);
    }
  }

  // The longitude is that of the face's middle plus atan(u).
  void place_side_columns() {
    Scratch scratch(size_, 0);
    std::fill_n(scratch.along.begin(), half_, 1.0);
    kernels_.angle_positions(distances_.data(), scratch.along.data(), half_, columns_a_quarter_, 0.0,
                             scratch.angles.data());
    const double columns = grid_.columns();
    const std::array<double, 4> middles{0.25 * columns - 0.5, 0.75 * columns - 0.5, 0.5 * columns - 0.5, -0.5};
    for (std::size_t side = 0; side < kSides.size(); ++side) {
      const double left_middle = middles[side];
      const double right_middle = kSides[side] == kFaceMinusZ ? columns - 0.5 : left_middle;  // beyond the seam
      fill(
          scratch.angles.data(), scratch.positions, [&](double angle) { return left_middle + angle; },
          [&](double angle) { return right_middle - angle; });
      side_columns_[side] = side_taps_.at(side);
      take_taps(scratch.positions, side_columns_[side]);
    }
  }

  // The longitude is +-a where z >= 0 and +-(pi - a) where z < 0, a = atan(|u| / |v|).
  void place_polar_columns(int row, Scratch& scratch, const RowTaps& taps) const {
    std::fill_n(scratch.along.begin(), half_, distance(row));
    kernels_.angle_positions(distances_.data(), scratch.along.data(), half_, columns_a_quarter_, 0.0,
                             scratch.angles.data());
    const double columns = grid_.columns();
    const double middle = 0.5 * columns - 0.5;
    fill(
        scratch.angles.data(), scratch.positions, [&](double angle) { return middle + angle; },
        [&](double angle) { return middle - angle; });
    take_taps(scratch.positions, taps.front);
    fill(
        scratch.angles.data(), scratch.positions, [&](double angle) { return columns - 0.5 - angle; },
        [](double angle) { return angle - 0.5; });
    take_taps(scratch.positions, taps.back);
  }

  /// `below`: rings counted from the other pole.
  void sample_row(int face, int row, bool below, const Taps& rings, const Taps& columns) const {
    GridRun run{};
    run.origin = below ? grid_.texel(0, grid_.rings() - 1) : grid_.texel(0, 0);
    run.ring_stride = below ? -grid_.stride() : grid_.stride();
    run.rings = rings.first;
    run.columns = columns.first;
    run.ring_weights = rings.weights;
    run.column_weights = columns.weights;
    run.count = size_;
    run.not_negative = sampling_.not_negative;
    kernels_.sample_grid(run, faces_[static_cast<std::size_t>(face)] +
                                  std::size_t{3} * static_cast<std::size_t>(row) * static_cast<std::size_t>(size_));
  }

  const ImageKernels& kernels_ = image_kernels();
  const SphereGrid& grid_;
  int size_;
  int half_;
  std::array<float*, 6> faces_;
  GridSampling sampling_;
  double rings_a_quarter_;  ///< turn
  double columns_a_quarter_;
  TapsMemory side_taps_;
  std::array<Taps, 4> side_columns_{};
  std::vector<double> distances_;     ///< |u| of the left half's columns
  std::vector<double> side_lengths_;  ///< sqrt(1 + u^2)
};

}  // namespace

void sample_faces(const SphereGrid& grid, int size, const std::array<float*, 6>& faces, const GridSampling& sampling,
                  const Control& control) {
  const FaceSampler sampler(grid, size, faces, sampling);
  const bool small = std::int64_t{6} * size * size <= kInlineTexels;
  const jobs::Placement placement = small ? jobs::Placement::calling_thread : jobs::Placement::arena;
  const std::size_t workers = jobs::worker_count(placement);
  const int side_rows = std::max(1, kTileTexels / (8 * size));
  const int polar_rows = std::max(1, kTileTexels / (4 * size));
  std::vector<Scratch> scratch;
  for (std::size_t k = 0; k < workers; ++k) scratch.emplace_back(size, std::min(polar_rows, sampler.half()));
  const auto tiles_of = [&](int rows) { return static_cast<std::size_t>((sampler.half() + rows - 1) / rows); };
  const std::size_t side_tiles = tiles_of(side_rows);
  jobs::run_tiles(side_tiles + tiles_of(polar_rows), placement, workers, control,
                  [&](std::size_t tile, std::size_t worker) {
                    const bool polar = tile >= side_tiles;
                    const int count = polar ? polar_rows : side_rows;
                    const int first = static_cast<int>(polar ? tile - side_tiles : tile) * count;
                    const Rows rows{first, std::min(first + count, sampler.half())};
                    polar ? sampler.sample_poles(rows, scratch[worker]) : sampler.sample_sides(rows, scratch[worker]);
                  });
}

}  // namespace welkin::image
