#include "reflections/near_weights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "reflections/near_kernels.h"
#include "simd/dispatch.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFineRadius = 2.0;        ///< texels from a direction within which weights have more points
constexpr int kMostFine = 16;              ///< so many texels of a face, at most
constexpr std::int64_t kTexelsOfTap = 10;  ///< whose sanitizing takes as long as a tap
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Interval {
  double first = kInfinity;
  double end = -kInfinity;
};

/// Returns the columns, or rows, that lie within an interval from -1 to 1 of a face of `size`.
std::array<int, 2> texels_of(const Interval& interval, int size) {
  const auto place = [&](double at) { return 0.5 * size * (1.0 + std::clamp(at, -1.0, 1.0)); };
  if (!(interval.first < 1.0 && interval.end > -1.0)) return {0, 0};
  return {static_cast<int>(place(interval.first)), std::min(size, static_cast<int>(place(interval.end)) + 1)};
}

/// A direction in the frame of a face.
glm::dvec3 in_frame_of(int face, const glm::dvec3& direction) {
  const glm::dvec3 out = image::face_direction(2, face, 1.0, 1.0);
  const glm::dvec3 across = image::face_direction(2, face, 2.0, 1.0) * std::numbers::sqrt2 - out;
  const glm::dvec3 down = image::face_direction(2, face, 1.0, 2.0) * std::numbers::sqrt2 - out;
  return {glm::dot(direction, across), glm::dot(direction, down), glm::dot(direction, out)};
}

}  // namespace

double NearSplit::end() const noexcept {
  const double sine = math::sine_cosine_of_turns(reach / (4.0 * kPi)).sine;
  return alpha * alpha / ((1.0 - alpha) * (1.0 + alpha)) + sine * sine;
}

/// All directions within the reach of another.
class NearWeights::Cone {
 public:
  explicit Cone(double reach) {
    const math::SineCosine angle = math::sine_cosine_of_turns(reach / (2.0 * kPi));
    sine_ = angle.sine;
    cosine_ = angle.cosine;
  }

  /// Returns where the planes lie that touch the cone, all with an edge of the face: x / z from the axis' coordinates
  /// across and outwards.
  [[nodiscard]] Interval across(double x, double z) const {
    const double square = x * x + z * z - sine_ * sine_;
    if (z <= -sine_) return {};
    if (square <= 0.0) return {-kInfinity, kInfinity};
    const double root = sine_ * std::sqrt(square);
    const double wide = z * z - sine_ * sine_;
    const double product = x * x - sine_ * sine_;
    if (z > sine_) return {(x * z - root) / wide, (x * z + root) / wide};
    if (product <= 0.0) return {-kInfinity, kInfinity};
    if (x > 0.0) return {product / (x * z + root), kInfinity};
    return {-kInfinity, product / (x * z - root)};
  }

  /// Returns the part of a line across the face that lies within, u where (u, v, 1) does.
  [[nodiscard]] Interval along(const glm::dvec3& axis, double v) const {
    // f(u) = (x u + k)^2 - c^2 (u^2 + w) is not negative there, and x u + k is positive
    const double x = std::abs(axis.x);
    const double k = axis.y * v + axis.z;
    const double w = 1.0 + v * v;
    const double a = (x - cosine_) * (x + cosine_);
    const double square = k * k + w * a;
    if (a < 0.0 && (k <= 0.0 || square <= 0.0)) return {};
    const double root = cosine_ * std::sqrt(std::max(0.0, square));
    const double b = x * k;
    const double first = b >= 0.0 ? (cosine_ * cosine_ * w - k * k) / (b + root) : (root - b) / a;
    const double end = a < 0.0 ? (b + root) / -a : kInfinity;
    return axis.x < 0.0 ? Interval{-end, -first} : Interval{first, end};
  }

 private:
  double sine_;
  double cosine_;
};

void NearWeights::find_runs(const std::vector<glm::dvec3>& directions) {
  const Cone cone(split_.reach);
  const double texel = 2.0 / split_.face;
  const double point = 0.5773502691896257 * 0.5 * texel;  // from a texel's middle
  run_ends_.push_back(0);
  ends_.push_back(0);
  std::uint32_t taps = 0;
  for (const glm::dvec3& direction : directions) {
    for (int face = 0; face < 6; ++face) {
      const glm::dvec3 axis = in_frame_of(face, direction);
      const std::array<int, 2> rows = texels_of(cone.across(axis.y, axis.z), split_.face);
      for (int row = rows[0]; row < rows[1]; ++row) {
        const double v = (row + 0.5) * texel - 1.0;
        const Interval upper = cone.along(axis, v - point);
        const Interval lower = cone.along(axis, v + point);
        const std::array<int, 2> columns =
            texels_of({std::min(upper.first, lower.first), std::max(upper.end, lower.end)}, split_.face);
        if (columns[0] >= columns[1]) continue;
        runs_.push_back({static_cast<std::int16_t>(face), static_cast<std::int16_t>(row),
                         static_cast<std::int16_t>(columns[0]), static_cast<std::int16_t>(columns[1])});
        taps += static_cast<std::uint32_t>(columns[1] - columns[0]);
      }
    }
    run_ends_.push_back(static_cast<std::uint32_t>(runs_.size()));
    ends_.push_back(taps);
  }
}

void NearWeights::number_records() {
  rows_.assign(std::size_t{6} * static_cast<std::size_t>(split_.face), {});
  for (const Run& run : runs_) {
    Row& row = rows_[static_cast<std::size_t>(split_.face * run.face + run.row)];
    row.first = row.first < row.end ? std::min<int>(row.first, run.first) : run.first;
    row.end = std::max<int>(row.end, run.end);
  }
  for (Row& row : rows_) {
    row.record = records_;
    records_ += static_cast<std::uint32_t>(row.end - row.first);
  }
}

/// Room for the texels near one direction, and a whole group more.
struct NearWeights::Room {
  float* columns;
  float* rows;
  float* weights;
};

/// Writes the weights of a face's runs. Returns how many there are.
int NearWeights::weigh_face(const glm::dvec3& direction, std::span<const Run> runs, const Room& room) const {
  const double texel = 2.0 / split_.face;
  const double q = split_.alpha * split_.alpha / ((1.0 - split_.alpha) * (1.0 + split_.alpha));
  const double inverse_end = 1.0 / split_.end();
  const glm::dvec3 axis = in_frame_of(runs.front().face, direction);
  NearTexels texels{room.columns,
                    room.rows,
                    0,
                    {},
                    static_cast<float>(0.5 * texel),
                    static_cast<float>(q * inverse_end),
                    static_cast<float>(inverse_end)};
  for (int k = 0; k < 3; ++k) texels.direction[k] = static_cast<float>(axis[k]);
  const auto middle = [texel](int at) { return static_cast<float>((at + 0.5) * texel - 1.0); };
  const auto place = [&](double at) { return axis.z > 0.0 ? (1.0 + at / axis.z) / texel : -2.0 * kFineRadius; };
  const double own_column = place(axis.x);
  const double own_row = place(axis.y);
  int fine[kMostFine];
  float fine_columns[kMostFine] = {};
  float fine_rows[kMostFine] = {};
  int fine_count = 0;
  for (const Run& run : runs) {
    const float row = middle(run.row);
    const bool beside = std::abs(run.row + 0.5 - own_row) < kFineRadius;
    for (int column = run.first; column < run.end; ++column, ++texels.count) {
      room.columns[texels.count] = middle(column);
      room.rows[texels.count] = row;
      if (!beside || std::abs(column + 0.5 - own_column) >= kFineRadius) continue;
      fine_columns[fine_count] = middle(column);
      fine_rows[fine_count] = row;
      fine[fine_count++] = texels.count;
    }
  }
  std::fill_n(room.columns + texels.count, simd::kLanes, 0.0F);
  std::fill_n(room.rows + texels.count, simd::kLanes, 0.0F);
  near_kernels().weigh(texels, room.weights);
  if (fine_count > 0) {
    float weights[kMostFine];
    NearTexels few = texels;
    few.columns = fine_columns;
    few.rows = fine_rows;
    few.count = fine_count;
    near_kernels().weigh_finely(few, weights);
    for (int k = 0; k < fine_count; ++k) room.weights[fine[k]] = weights[k];
  }
  return texels.count;
}

void NearWeights::weigh(const glm::dvec3& direction, std::size_t target, double share, const Room& room) {
  const std::span<const Run> runs(runs_.data() + run_ends_[target], runs_.data() + run_ends_[target + 1]);
  Room rest = room;
  for (auto first = runs.begin(); first != runs.end();) {
    const auto end = std::find_if(first, runs.end(), [&](const Run& run) { return run.face != first->face; });
    rest.weights += weigh_face(direction, {first, end}, rest);
    first = end;
  }
  const auto count = static_cast<int>(rest.weights - room.weights);
  std::fill_n(rest.weights, simd::kLanes, 0.0F);
  const auto scale = static_cast<float>(share / near_kernels().sum(room.weights, count));
  RingTap* to = taps_.data() + ends_[target];
  const float* from = room.weights;
  for (const Run& run : runs) {
    const Row& row = rows_[static_cast<std::size_t>(split_.face * run.face + run.row)];
    const int texels = run.end - run.first;
    near_kernels().write_taps(from, scale, row.record + static_cast<std::uint32_t>(run.first - row.first), texels, to);
    from += texels;
    to += texels;
  }
}

NearWeights::NearWeights(const NearSplit& split, const std::vector<glm::dvec3>& directions, double share)
    : split_(split) {
  constexpr std::size_t kTileTargets = 32;
  find_runs(directions);
  number_records();
  taps_ = platform::AlignedBuffer<RingTap>(ends_.back());
  std::uint32_t most = 0;
  for (std::size_t k = 0; k < directions.size(); ++k) most = std::max(most, ends_[k + 1] - ends_[k]);
  const std::size_t floats = (std::size_t{most} / simd::kLanes + 2) * simd::kLanes;
  const auto placement = jobs::placement_for(static_cast<std::int64_t>(ends_.back()) * kTexelsOfTap);
  const std::size_t workers = jobs::worker_count(placement);
  platform::AlignedBuffer<float> rooms(3 * floats * workers);
  jobs::run_tiles((directions.size() + kTileTargets - 1) / kTileTargets, placement, workers, {},
                  [&](std::size_t tile, std::size_t worker) {
                    float* const room = rooms.data() + 3 * floats * worker;
                    const std::size_t end = std::min(directions.size(), (tile + 1) * kTileTargets);
                    for (std::size_t k = tile * kTileTargets; k < end; ++k)
                      weigh(directions[k], k, share, {room, room + floats, room + 2 * floats});
                  });
}

}  // namespace welkin::reflections
