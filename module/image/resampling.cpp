#include "image/resampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/core.h"
#include "welkin/resampling.h"

namespace welkin::image {
namespace {

void add_weighted(const float* rgb, double weight, glm::dvec3& sum) noexcept {
  sum.x += weight * static_cast<double>(rgb[0]);
  sum.y += weight * static_cast<double>(rgb[1]);
  sum.z += weight * static_cast<double>(rgb[2]);
}

int wrapped(int column, int width) noexcept {
  const int rest = column % width;
  return rest < 0 ? rest + width : rest;
}

/// The texel before a position, and how far on the position is.
struct Between {
  int before;
  double share;  // of the texel after it
};

Between between(double position) noexcept {
  const double whole = std::floor(position);
  return {static_cast<int>(whole), position - whole};
}

/// Bilinear interpolation as `CubemapSampler` does it; across the poles it goes on in the columns on the other side,
/// 180 degrees away. In rows whose texels are narrower than the distance of samples, the mean over that distance takes
/// the place of interpolation: samples pass none over.
class LatLongSampler {
 public:
  /// `spacing`: radians between samples. The view's pixels must outlive the sampler.
  LatLongSampler(const LatLongView& view, double spacing)
      : plane_(view), width_(view.width), height_(view.height), spans_(static_cast<std::size_t>(view.height)) {
    for (std::size_t row = 0; row < spans_.size(); ++row) {
      const double turns = 0.25 - (static_cast<double>(row) + 0.5) / (2.0 * height_);
      const double texel = 2.0 * std::numbers::pi / width_ * math::sine_cosine_of_turns(turns).cosine;  // radians
      spans_[row] = std::clamp(spacing / texel, 1.0, 1.0 * width_);
    }
  }

  void add(const glm::dvec3& direction, double weight, glm::dvec3& sum) const noexcept {
    const double longitude = math::turns_of(direction.x, direction.z);
    const double horizontal = std::sqrt(direction.x * direction.x + direction.z * direction.z);
    const double latitude = math::turns_of(direction.y, horizontal);
    const double column = (0.5 - longitude) * width_ - 0.5;
    const Between row = between((0.25 - latitude) * 2.0 * height_ - 0.5);
    add_from_row(row.before, column, weight * (1.0 - row.share), sum);
    add_from_row(row.before + 1, column, weight * row.share, sum);
  }

 private:
  void add_from_row(int row, double column, double weight, glm::dvec3& sum) const noexcept {
    if (row < 0 || row >= height_) {
      // A meridian goes on beyond the pole on the opposite one: row -1 is row 0, 180 degrees away.
      row = row < 0 ? 0 : height_ - 1;
      column += 0.5 * width_;
    }
    // The mean of texels as areas over `span` columns; over one column it is linear interpolation.
    const double span = spans_[static_cast<std::size_t>(row)];
    const double begin = column + 0.5 - 0.5 * span;
    const double end = begin + span;
    const double density = weight / span;
    for (int texel = static_cast<int>(std::floor(begin)); texel < end; ++texel) {
      const double covered = std::min(end, texel + 1.0) - std::max(begin, 1.0 * texel);
      add_weighted(plane_.texel(wrapped(texel, width_), row), density * covered, sum);
    }
  }

  FloatPlane plane_;
  int width_;
  int height_;
  std::vector<double> spans_;  // of each row: columns that a sample stands for, 1 to the width
};

}  // namespace

CubemapSampler::CubemapSampler(const CubemapView& view)
    : planes_{FloatPlane(view, 0), FloatPlane(view, 1), FloatPlane(view, 2),
              FloatPlane(view, 3), FloatPlane(view, 4), FloatPlane(view, 5)},
      size_(view.size) {}

void CubemapSampler::add_texel(const CubeTexel& texel, double weight, glm::dvec3& sum) const noexcept {
  const CubeTexel nearest{texel.face, std::clamp(texel.column, 0, size_ - 1), std::clamp(texel.row, 0, size_ - 1)};
  const bool beside = nearest.column != texel.column;
  const bool above = nearest.row != texel.row;
  if (beside && above) {
    const double third = weight / 3.0;
    add_weighted(inside(nearest), third, sum);
    add_weighted(inside(across_edge(size_, {texel.face, texel.column, nearest.row})), third, sum);
    add_weighted(inside(across_edge(size_, {texel.face, nearest.column, texel.row})), third, sum);
  } else {
    add_weighted(inside(beside || above ? across_edge(size_, texel) : texel), weight, sum);
  }
}

void CubemapSampler::add(const glm::dvec3& direction, double weight, glm::dvec3& sum) const noexcept {
  const int face = face_of(direction);
  const Frame& frame = face_frame(face);
  const double scale = 0.5 * size_ / glm::dot(direction, frame.normal);
  // u from -1 to 1 is (u + 1) / 2 size from the edge, and texel 0's centre is half a texel from it: column =
  // (size - 1) / 2 + u size / 2.
  const double middle = 0.5 * (size_ - 1);
  const Between column = between(middle + scale * glm::dot(direction, frame.u));
  const Between row = between(middle + scale * glm::dot(direction, frame.v));
  // Rounding may lead a hair beyond the edge: the outermost pair of texels is -1 and 0, or size - 1 and size.
  const int left = std::clamp(column.before, -1, size_ - 1);
  const int top = std::clamp(row.before, -1, size_ - 1);
  const double upper = weight * (1.0 - row.share);
  const double lower = weight * row.share;
  add_texel({face, left, top}, upper * (1.0 - column.share), sum);
  add_texel({face, left + 1, top}, upper * column.share, sum);
  add_texel({face, left, top + 1}, lower * (1.0 - column.share), sum);
  add_texel({face, left + 1, top + 1}, lower * column.share, sum);
}

}  // namespace welkin::image

namespace welkin {
namespace {

constexpr int kTileSamples = 4096;
constexpr int kMinSamples = 2;  // along each edge of a texel, that it has an area also where there is no reduction
constexpr int kSamplesToLookUp = 64;  // along an edge; from here on a single texel makes a person wait

void require_orthogonal(const glm::dmat3& rotation) {
  constexpr double kTolerance = 1e-6;
  const glm::dmat3 product = glm::transpose(rotation) * rotation;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const double off = std::abs(product[column][row] - (column == row ? 1.0 : 0.0));
      if (off <= kTolerance) continue;
      throw Error(ErrorCode::invalid_argument,
                  "the rotation is not an orthogonal matrix: two of its columns are off by " +
                      platform::number_text(off) + "; pass a rotation, or a rotation and a mirror");
    }
  }
}

// Texels a radian, where they lie closest: a cube's at the middle of an edge.
// A face has size / 2 texels per unit of u, and u = tan(angle) has the slope 1 + u^2: size / 2 texels per radian in the
// middle of a face and size at u = 1, v = 0. (Along u it is size / 2 (1 + u^2 + v^2) / sqrt(1 + v^2), 1.06 size in the
// corners: samples 1.06 texels apart miss none, as interpolation reaches over 2. From 32 to 16 x 16 x 6, askew, a lone
// texel keeps 1 +- 0.087 of its light there; with the 5/4 squared as many samples of 1.06 size 1 +- 0.032.)
double closest_texels(const CubemapView& source) { return source.size; }
double closest_texels(const LatLongView& source) {
  return std::max(0.5 * source.width, 1.0 * source.height) / std::numbers::pi;
}

int samples_along_edge(double source_density, double result_density) {
  // As many samples as source texels lie under a texel of the result, so that none is skipped. 1e-9: a quotient that is
  // whole but for rounding does not take one more.
  const double ratio = source_density / result_density;
  return std::max(kMinSamples, static_cast<int>(std::ceil(ratio - 1e-9)));
}

/// Where the samples of a lat-long's or a cubemap's texels lie: `samples_across` x `samples_down` of them a texel.
class Cells {
 public:
  // Texels lie widest apart in the middle of a face: size / 2 a radian; or at the equator: width / 2 pi a radian
  // across, height / pi down.
  Cells(const image::TexelGrid& grid, double source_density)
      : lat_long_(grid.kind() == image::TexelGrid::Kind::lat_long),
        columns_(grid.columns()),
        rows_(grid.rows()),
        across_(samples_along_edge(source_density, lat_long_ ? 0.5 * columns_ / std::numbers::pi : 0.5 * columns_)),
        down_(samples_along_edge(source_density, lat_long_ ? rows_ / std::numbers::pi : 0.5 * columns_)),
        lines_(1.0 * (lat_long_ ? rows_ : columns_) * down_) {
    const int columns = lat_long_ ? columns_ * across_ : 0;
    longitudes_.reserve(static_cast<std::size_t>(columns));
    for (int column = 0; column < columns; ++column) {
      longitudes_.push_back(math::sine_cosine_of_turns(0.5 - (column + 0.5) / columns));
    }
  }

  [[nodiscard]] int columns() const noexcept { return columns_; }
  [[nodiscard]] int rows() const noexcept { return rows_; }
  [[nodiscard]] int samples_across() const noexcept { return across_; }
  [[nodiscard]] int samples_down() const noexcept { return down_; }

  struct Sample {
    glm::dvec3 direction;
    double weight;  // in proportion to the solid angle that it stands for
  };

  /// The position that a row of samples shares: sample row `sub_row` of texel row `row`.
  struct RowSample {
    int face;
    double v;                     // cube: the place on the face
    math::SineCosine latitude{};  // lat-long
  };
  [[nodiscard]] RowSample row_sample(int row, int sub_row) const noexcept {
    const int face = lat_long_ ? 0 : row / columns_;
    const double line = 1.0 * (row - face * columns_) * down_ + sub_row;
    if (lat_long_) return {0, 0.0, math::sine_cosine_of_turns(0.25 - (line + 0.5) / (2.0 * lines_))};
    return {face, (2.0 * line + 1.0) / lines_ - 1.0};
  }

  /// Sample column `column`, counted through all texels.
  [[nodiscard]] Sample sample(const RowSample& row, int column) const noexcept {
    if (lat_long_) {
      const math::SineCosine& longitude = longitudes_[static_cast<std::size_t>(column)];
      const auto& [sine, cosine] = row.latitude;
      return {{longitude.sine * cosine, sine, longitude.cosine * cosine}, cosine};
    }
    const image::Frame& frame = image::face_frame(row.face);
    const double u = (2.0 * column + 1.0) / lines_ - 1.0;
    // The solid angle of du dv is du dv / (1 + u^2 + v^2)^(3/2). Weights are relative: du dv, alike for all samples,
    // drops out when the sum is divided by that of the weights.
    const double squared = 1.0 + u * u + row.v * row.v;
    return {frame.normal + u * frame.u + row.v * frame.v, 1.0 / (squared * std::sqrt(squared))};
  }

 private:
  bool lat_long_;
  int columns_;
  int rows_;
  int across_;
  int down_;
  double lines_;                              // of samples, of a face or all
  std::vector<math::SineCosine> longitudes_;  // lat-long
};

LatLongImage empty_lat_long(int width, int height) {
  return {width, height,
          std::vector<float>(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
}

template <class Sampler>
class Resampler {
 public:
  Resampler(const Cells& cells, const Sampler& source, const glm::dmat3& rotation, const Control& control)
      : cells_(cells), source_(source), back_(glm::transpose(rotation)), control_(control) {}

  /// Writes `cells.rows()` x `cells.columns()` texels of three floats.
  void run(float* rgb) const {
    const double texel_samples = 1.0 * cells_.samples_across() * cells_.samples_down();
    const int tile_columns = std::clamp(static_cast<int>(kTileSamples / texel_samples), 1, cells_.columns());
    const int tiles_a_row = (cells_.columns() + tile_columns - 1) / tile_columns;
    const std::size_t tiles = static_cast<std::size_t>(tiles_a_row) * static_cast<std::size_t>(cells_.rows());
    const double samples = 1.0 * cells_.rows() * cells_.columns() * texel_samples;
    constexpr double kInlineSamples = 10'000;
    const auto where = samples < kInlineSamples ? jobs::Placement::calling_thread : jobs::Placement::arena;
    jobs::run_tiles(tiles, where, jobs::worker_count(where), control_, [&](std::size_t tile, std::size_t) {
      const int row = static_cast<int>(tile / static_cast<std::size_t>(tiles_a_row));
      const int first = static_cast<int>(tile % static_cast<std::size_t>(tiles_a_row)) * tile_columns;
      const int end = std::min(first + tile_columns, cells_.columns());
      const std::size_t texel = static_cast<std::size_t>(row) * static_cast<std::size_t>(cells_.columns());
      for (int column = first; column < end; ++column) {
        const glm::dvec3 mean = texel_mean(row, column);
        float* to = rgb + 3 * (texel + static_cast<std::size_t>(column));
        for (int channel = 0; channel < 3; ++channel) to[channel] = static_cast<float>(mean[channel]);
      }
    });
  }

 private:
  [[nodiscard]] glm::dvec3 texel_mean(int row, int column) const {
    const int across = cells_.samples_across();
    glm::dvec3 sum(0.0);
    double weights = 0.0;
    for (int sub_row = 0; sub_row < cells_.samples_down(); ++sub_row) {
      if (across >= kSamplesToLookUp) jobs::throw_if_cancelled(control_);
      const Cells::RowSample row_of_samples = cells_.row_sample(row, sub_row);
      for (int sub_column = 0; sub_column < across; ++sub_column) {
        const Cells::Sample sample = cells_.sample(row_of_samples, column * across + sub_column);
        source_.add(back_ * sample.direction, sample.weight, sum);
        weights += sample.weight;
      }
    }
    return sum / weights;
  }

  const Cells& cells_;
  const Sampler& source_;
  glm::dmat3 back_;
  const Control& control_;
};

// `spacing`: radians between samples, which are as far apart as a cube's texels or less.
image::CubemapSampler sampler_of(const CubemapView& source, double /*spacing*/) {
  return image::CubemapSampler(source);
}
image::LatLongSampler sampler_of(const LatLongView& source, double spacing) { return {source, spacing}; }

template <typename View>
Cubemap resampled_cubemap(const View& source, int size, const glm::dmat3& rotation, const Control& control) {
  const Cells cells(image::TexelGrid::cubemap(size), closest_texels(source));
  const auto sampler = sampler_of(source, 2.0 / (1.0 * size * cells.samples_down()));
  Cubemap result(size, 1, control.memory);
  Resampler(cells, sampler, rotation, control).run(result.face(0));
  return result;
}

template <typename View>
LatLongImage resampled_lat_long(const View& source, int width, int height, const glm::dmat3& rotation,
                                const Control& control) {
  const Cells cells(image::TexelGrid::lat_long(width, height), closest_texels(source));
  const double turn = 2.0 * std::numbers::pi;
  const auto sampler = sampler_of(source, std::max(turn / (1.0 * width * cells.samples_across()),
                                                   0.5 * turn / (1.0 * height * cells.samples_down())));
  LatLongImage result = empty_lat_long(width, height);
  Resampler(cells, sampler, rotation, control).run(result.pixels.data());
  return result;
}

/// Returns an upright cubemap changed by one of a cube's symmetries.
Cubemap rotate(Cubemap upright, const glm::dmat3& rotation, const Control& control) {
  if (rotation == glm::dmat3(1.0)) return upright;
  return *image::rotate_exactly(upright.view(), rotation, control);
}

/// Returns how often `size` doubles to `source_size`; 0 if it does not.
int halvings(int source_size, int size) {
  int count = 0;
  while (source_size > size && source_size % 2 == 0) {
    source_size /= 2;
    ++count;
  }
  return source_size == size ? count : 0;
}

constexpr double kShareOfFilling = 0.9;  // the rest is for turning

Cubemap reduced(const CubemapView& source, int levels, const Control& control) {
  const Cubemap chain = build_mips(source, MipFilter::solid_angle, levels + 1, control);
  Cubemap result(chain.level_size(levels), 1, control.memory);
  std::copy_n(chain.face(levels, 0), result.pixels().size(), result.face(0));
  return result;
}

Cubemap cubemap_of(const CubemapView& source, int size, const glm::dmat3& rotation, ResampleFilter /*filter*/,
                   const Control& control) {
  if (size == source.size) {
    if (auto exact = image::rotate_exactly(source, rotation, control)) return *std::move(exact);
  }
  const int levels = halvings(source.size, size);
  if (levels > 0 && image::cube_symmetry_of(rotation)) {
    return rotate(reduced(source, levels, jobs::part_of(control, 0.0, kShareOfFilling)), rotation,
                  jobs::part_of(control, kShareOfFilling, 1.0));
  }
  return resampled_cubemap(source, size, rotation, control);
}

Cubemap cubemap_of(const LatLongView& source, int size, const glm::dmat3& rotation, ResampleFilter filter,
                   const Control& control) {
  if (image::cube_symmetry_of(rotation)) {
    const bool upright = rotation == glm::dmat3(1.0);
    Cubemap result(size, 1, control.memory);
    image::fill_cubemap(source, result, 0, filter, upright ? control : jobs::part_of(control, 0.0, kShareOfFilling));
    return rotate(std::move(result), rotation, jobs::part_of(control, kShareOfFilling, 1.0));
  }
  return resampled_cubemap(source, size, rotation, control);
}

LatLongImage lat_long_of(const CubemapView& source, int width, int height, const glm::dmat3& rotation,
                         ResampleFilter filter, const Control& control) {
  if (filter == ResampleFilter::area && image::cube_symmetry_of(rotation)) {
    LatLongImage result = empty_lat_long(width, height);
    const auto fill = [&](const CubemapView& upright, const Control& part) {
      image::fill_lat_long_by_area(upright, width, height, result.pixels.data(), part);
    };
    if (rotation == glm::dmat3(1.0)) {
      fill(source, control);
    } else {
      const double turning = 1.0 - kShareOfFilling;
      const Cubemap upright = *image::rotate_exactly(source, rotation, jobs::part_of(control, 0.0, turning));
      fill(upright.view(), jobs::part_of(control, turning, 1.0));
    }
    return result;
  }
  return resampled_lat_long(source, width, height, rotation, control);
}

LatLongImage lat_long_of(const LatLongView& source, int width, int height, const glm::dmat3& rotation,
                         ResampleFilter /*filter*/, const Control& control) {
  if (width == source.width && height == source.height) {
    if (auto moved = image::moved_along_rows(source, rotation, control)) return *std::move(moved);
  }
  return resampled_lat_long(source, width, height, rotation, control);
}

}  // namespace

Cubemap to_cubemap(const EnvironmentView& source, int size, const glm::dmat3& rotation, ResampleFilter filter,
                   const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(source);
  image::check_face_size(size);
  require_orthogonal(rotation);
  return image::with_view(source, [&](const auto& view) { return cubemap_of(view, size, rotation, filter, control); });
}

LatLongImage to_lat_long(const EnvironmentView& source, int width, int height, const glm::dmat3& rotation,
                         ResampleFilter filter, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(source);
  image::check_lat_long_size(width, height);
  require_orthogonal(rotation);
  return image::with_view(
      source, [&](const auto& view) { return lat_long_of(view, width, height, rotation, filter, control); });
}

}  // namespace welkin
