// Irradiance texel by texel: no harmonics, many normals at a time.
#include "projection/irradiance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/basis.h"
#include "math/direction.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "platform/float_environment.h"
#include "projection/projection_kernels.h"
#include "projection/sanitizer.h"
#include "projection/texel_weights.h"
#include "welkin/core.h"
#include "welkin/irradiance.h"

namespace welkin::projection {
namespace {

constexpr std::ptrdiff_t kMostNormals = 100'000;

void require_possible(std::ptrdiff_t normals) {
  if (normals >= 1 && normals <= kMostNormals) return;
  throw Error(ErrorCode::invalid_argument,
              std::to_string(normals) + " normals; 1 to " + std::to_string(kMostNormals) + " are possible");
}

}  // namespace

std::vector<glm::dvec3> spiral(int count) {
  require_possible(count);
  const double golden = 0.5 * (3.0 - std::sqrt(5.0));  // of a turn
  std::vector<glm::dvec3> normals;
  for (int i = 0; i < count; ++i) {
    const double y = 1.0 - (2.0 * i + 1.0) / count;
    const double ring = std::sqrt((1.0 - y) * (1.0 + y));
    const math::SineCosine azimuth = math::sine_cosine_of_turns(golden * i);
    normals.emplace_back(ring * azimuth.sine, y, ring * azimuth.cosine);
  }
  return normals;
}

}  // namespace welkin::projection

namespace welkin {
namespace {

constexpr std::size_t kBatch = 512;  ///< normals that are worked on at a time: bounds the memory, 12 MiB of slots
constexpr std::size_t kMostTiles = 1024;

/// A picture row by row, sanitized, whatever its layout.
struct Source {
  const projection::CosineTexels& texels;
  bool cubemap;
  std::function<void(int row, float* rgb)> decode;
};

/// One worker's room: a row's moments, and its channels in double.
struct Scratch {
  explicit Scratch(std::size_t columns) : rgb(3 * columns), cosine(columns) {
    for (auto* list : {&moments.x, &moments.y, &moments.z, &moments.horizon, &red, &green, &blue})
      list->resize(columns);
  }
  std::vector<float> rgb;
  projection::MomentRow moments;
  std::vector<double> red, green, blue;
  std::vector<double> cosine;  ///< of each texel with the normal at hand: its clipped integral
};

void read_row(const Source& source, const projection::Sanitizer& sanitizer, int row, Scratch& scratch,
              projection::SanitizeRecord& record) {
  const int columns = source.texels.columns();
  source.decode(row, scratch.rgb.data());
  const float no_weight = 0.0F;
  const int face = source.cubemap ? row / columns : 0;
  sanitizer.sanitize({.rgb = scratch.rgb.data(),
                      .count = columns,
                      .face = face,
                      .row = source.cubemap ? row % columns : row,
                      .first_column = 0,
                      .weights = &no_weight,
                      .weight_step = 0,
                      .weight_scale = 0.0},
                     record);
  for (std::size_t i = 0; i < static_cast<std::size_t>(columns); ++i) {
    scratch.red[i] = static_cast<double>(scratch.rgb[3 * i]);
    scratch.green[i] = static_cast<double>(scratch.rgb[3 * i + 1]);
    scratch.blue[i] = static_cast<double>(scratch.rgb[3 * i + 2]);
  }
  source.texels.fill(row, scratch.moments);
}

/// The clipped cosine integrals of a row's texels. False if all are zero.
bool fill_cosines(const projection::CosineTexels& texels, int row, const glm::dvec3& normal, Scratch& scratch) {
  const projection::MomentRow& m = scratch.moments;
  double* const cosine = scratch.cosine.data();
  const std::size_t count = scratch.cosine.size();
  for (std::size_t i = 0; i < count; ++i) cosine[i] = normal.x * m.x[i] + normal.y * m.y[i] + normal.z * m.z[i];
  double largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(cosine[i]) <= m.horizon[i]) cosine[i] = texels.clipped(row, static_cast<int>(i), normal);
    cosine[i] = cosine[i] > 0.0 ? cosine[i] : 0.0;
    largest = cosine[i] > largest ? cosine[i] : largest;
  }
  return largest > 0.0;
}

std::vector<glm::dvec3> unit_normals(std::span<const glm::dvec3> normals) {
  projection::require_possible(static_cast<std::ptrdiff_t>(normals.size()));
  return math::unit_directions(normals, "normal");
}

/// Appends the irradiance of one batch of normals.
void integrate_batch(const Source& source, std::span<const glm::dvec3> normals, const PixelPolicy& pixels,
                     const Control& control, std::vector<glm::dvec3>& irradiance) {
  const projection::Sanitizer sanitizer(pixels);
  const auto rows = static_cast<std::size_t>(source.texels.rows());
  const auto columns = static_cast<std::size_t>(source.texels.columns());
  const std::size_t rows_per_tile = (rows + kMostTiles - 1) / kMostTiles;
  const std::size_t tiles = (rows + rows_per_tile - 1) / rows_per_tile;
  const jobs::Placement placement = jobs::placement_for(static_cast<std::int64_t>(rows * columns * normals.size()));
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<Scratch> scratch(workers, Scratch(columns));
  std::vector<glm::dvec3> slots(tiles * normals.size(), glm::dvec3(0.0));
  std::vector<projection::SanitizeRecord> records(tiles);

  jobs::run_tiles(tiles, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
    Scratch& room = scratch[worker];
    glm::dvec3* const slot = slots.data() + tile * normals.size();
    for (std::size_t row = tile * rows_per_tile; row < std::min(rows, (tile + 1) * rows_per_tile); ++row) {
      read_row(source, sanitizer, static_cast<int>(row), room, records[tile]);
      for (std::size_t n = 0; n < normals.size(); ++n) {
        if (!fill_cosines(source.texels, static_cast<int>(row), normals[n], room)) continue;
        slot[n] += glm::dvec3(math::dot(room.cosine, room.red), math::dot(room.cosine, room.green),
                              math::dot(room.cosine, room.blue));
      }
    }
  });

  projection::SanitizeRecord record;
  for (const projection::SanitizeRecord& one : records) record.add(one);
  projection::throw_if_rejected(record, source.cubemap);
  const std::size_t first = irradiance.size();
  irradiance.resize(first + normals.size(), glm::dvec3(0.0));
  for (std::size_t k = 0; k < slots.size(); ++k) irradiance[first + k % normals.size()] += slots[k];
}

std::vector<glm::dvec3> integrate(const Source& source, std::span<const glm::dvec3> normals, const PixelPolicy& pixels,
                                  const Control& control) {
  const auto share_done = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(normals.size());
  };
  std::vector<glm::dvec3> irradiance;
  while (irradiance.size() < normals.size()) {
    const std::size_t first = irradiance.size();
    const std::size_t count = std::min(kBatch, normals.size() - first);
    const Control part = jobs::part_of(control, share_done(first), share_done(first + count));
    integrate_batch(source, normals.subspan(first, count), pixels, part, irradiance);
  }
  return irradiance;
}

/// A view's row: `row_stride_bytes` may be 0 (packed) or negative.
const std::byte* row_of(const void* pixels, std::ptrdiff_t stride, PixelFormat format, int width, int row) {
  const std::ptrdiff_t bytes = stride != 0 ? stride : static_cast<std::ptrdiff_t>(bytes_per_texel(format)) * width;
  return static_cast<const std::byte*>(pixels) + row * bytes;
}

}  // namespace

std::vector<glm::dvec3> direct_irradiance(const CubemapView& cubemap, std::span<const glm::dvec3> normals,
                                          const PixelPolicy& pixels, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(cubemap);
  projection::check_policy(pixels);
  const auto texels = projection::cosine_texels_of_cubemap(cubemap.size);
  const auto decode = [&](int row, float* rgb) {
    const void* const face = cubemap.faces[static_cast<std::size_t>(row / cubemap.size)];
    image::decode_texels(cubemap.format,
                         row_of(face, cubemap.row_stride_bytes, cubemap.format, cubemap.size, row % cubemap.size),
                         cubemap.size, rgb);
  };
  return integrate({*texels, true, decode}, unit_normals(normals), pixels, control);
}

std::vector<glm::dvec3> direct_irradiance(const LatLongView& lat_long, std::span<const glm::dvec3> normals,
                                          const PixelPolicy& pixels, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(lat_long);
  projection::check_policy(pixels);
  const auto texels = projection::cosine_texels_of_lat_long(lat_long.width, lat_long.height);
  const auto decode = [&](int row, float* rgb) {
    image::decode_texels(lat_long.format,
                         row_of(lat_long.pixels, lat_long.row_stride_bytes, lat_long.format, lat_long.width, row),
                         lat_long.width, rgb);
  };
  return integrate({*texels, false, decode}, unit_normals(normals), pixels, control);
}

glm::dvec3 direct_irradiance(const CubemapView& cubemap, const glm::dvec3& normal) {
  const platform::FloatingPointScope floating_point;
  return direct_irradiance(cubemap, {&normal, 1}).front();
}

glm::dvec3 direct_irradiance(const LatLongView& lat_long, const glm::dvec3& normal) {
  const platform::FloatingPointScope floating_point;
  return direct_irradiance(lat_long, {&normal, 1}).front();
}

}  // namespace welkin

namespace welkin::projection {
namespace {

constexpr double kPi = std::numbers::pi;

/// Cells along a texel's edge: 4, and more where fewer than 256 texels see a quarter of the horizon.
int cells_along(int texels_around) { return std::max(4, (1024 + texels_around - 1) / texels_around); }

/// With u the longitude and v the latitude, d = (sin u cos v, sin v, cos u cos v), dw = cos v du dv. Over a texel with
/// centre (u, v) and half-widths (a, b):
///   Int sin u du = 2 sin a sin u,   Int cos^2 v dv = b + sin b cos b cos 2v,   Int sin v cos v dv = sin b cos b sin
///   2v.
class LatLongTexels final : public CosineTexels {
 public:
  LatLongTexels(int width, int height)
      : width_(width), height_(height), across_(cells_along(width)), down_(cells_along(2 * height)) {
    for (int i = 0; i < width; ++i) columns_.push_back(math::sine_cosine_of_turns(0.5 - (i + 0.5) / width));
    const int cells = width * across_;
    for (int i = 0; i < cells; ++i) cells_.push_back(math::sine_cosine_of_turns(0.5 - (i + 0.5) / cells));
  }

  [[nodiscard]] int rows() const noexcept override { return height_; }
  [[nodiscard]] int columns() const noexcept override { return width_; }

  void fill(int row, MomentRow& moments) const override {
    const math::SineCosine twice = math::sine_cosine_of_turns(0.5 - (row + 0.5) / height_);  // 2v
    const math::SineCosine half_row = math::sine_cosine_of_turns(0.25 / height_);            // b
    const double skew = half_row.sine * half_row.cosine;
    const double ring = kPi / (2.0 * height_) + skew * twice.cosine;  // Int cos^2 v dv
    const double column = 2.0 * math::sine_cosine_of_turns(0.5 / width_).sine;
    const double height = 2.0 * kPi / width_ * skew * twice.sine;
    // From the moment's direction no point of the texel is farther than this angle.
    const double radius = kPi / height_ + kPi / width_;
    const double horizon = radius * image::lat_long_texel_solid_angle(width_, height_, row);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      moments.x[i] = columns_[i].sine * column * ring;
      moments.y[i] = height;
      moments.z[i] = columns_[i].cosine * column * ring;
      moments.horizon[i] = horizon;
    }
  }

  [[nodiscard]] double clipped(int row, int column, const glm::dvec3& normal) const noexcept override {
    const int cell_rows = height_ * down_;
    const double width = 2.0 * kPi / (static_cast<double>(width_) * across_);
    const double height = 2.0 * math::sine_cosine_of_turns(0.25 / cell_rows).sine;  // times cos v: its integral
    double sum = 0.0;
    for (int j = row * down_; j < (row + 1) * down_; ++j) {
      const math::SineCosine v = math::sine_cosine_of_turns(0.25 - (j + 0.5) / (2.0 * cell_rows));
      const double up = normal.y * v.sine;
      double along = 0.0;
      for (int i = column * across_; i < (column + 1) * across_; ++i) {
        const math::SineCosine& u = cells_[static_cast<std::size_t>(i)];
        along += std::max(0.0, up + v.cosine * (normal.x * u.sine + normal.z * u.cosine));
      }
      sum += along * v.cosine;
    }
    return sum * width * height;
  }

 private:
  int width_;
  int height_;
  int across_;
  int down_;
  std::vector<math::SineCosine> columns_;
  std::vector<math::SineCosine> cells_;
};

/// With d = (u, v, 1) / r in the face's frame and dw = du dv / r^3, a moment is Int (u, v, 1) r^-4 du dv, by a Gauss
/// rule that is exact to rounding.
class CubemapTexels final : public CosineTexels {
 public:
  explicit CubemapTexels(int size) : size_(size), cells_(cells_along(4 * size)) {}

  [[nodiscard]] int rows() const noexcept override { return 6 * size_; }
  [[nodiscard]] int columns() const noexcept override { return size_; }

  void fill(int row, MomentRow& moments) const override {
    const image::Frame& frame = image::face_frame(row / size_);
    const math::GaussRule rule = math::texel_rule(size_);
    const double half = 1.0 / size_;
    const double v0 = (2.0 * (row % size_) + 1.0) * half - 1.0;
    for (int column = 0; column < size_; ++column) {
      const double u0 = (2.0 * column + 1.0) * half - 1.0;
      glm::dvec3 local(0.0);
      double solid_angle = 0.0;
      for (int j = 0; j < rule.order; ++j) {
        for (int i = 0; i < rule.order; ++i) {
          const double u = u0 + half * rule.nodes[i];
          const double v = v0 + half * rule.nodes[j];
          const double q = 1.0 / (1.0 + u * u + v * v);
          const double weight = rule.weights[i] * rule.weights[j] * half * half * q;
          local += weight * q * glm::dvec3(u, v, 1.0);
          solid_angle += weight * std::sqrt(q);
        }
      }
      const glm::dvec3 moment = local.x * frame.u + local.y * frame.v + local.z * frame.normal;
      const auto i = static_cast<std::size_t>(column);
      moments.x[i] = moment.x;
      moments.y[i] = moment.y;
      moments.z[i] = moment.z;
      // The diagonal, on a plane at distance 1 or more, is longer than any chord of the texel.
      moments.horizon[i] = 2.0 * std::numbers::sqrt2 * half * solid_angle;
    }
  }

  [[nodiscard]] double clipped(int row, int column, const glm::dvec3& normal) const noexcept override {
    const image::Frame& frame = image::face_frame(row / size_);
    const double a = glm::dot(normal, frame.u);
    const double b = glm::dot(normal, frame.v);
    const double c = glm::dot(normal, frame.normal);
    const double step = 2.0 / (static_cast<double>(size_) * cells_);
    double sum = 0.0;
    for (int j = (row % size_) * cells_; j < (row % size_ + 1) * cells_; ++j) {
      const double v = (j + 0.5) * step - 1.0;
      for (int i = column * cells_; i < (column + 1) * cells_; ++i) {
        const double u = (i + 0.5) * step - 1.0;
        const double q = 1.0 / (1.0 + u * u + v * v);
        sum += std::max(0.0, u * a + v * b + c) * q * q;
      }
    }
    return sum * step * step;
  }

 private:
  int size_;
  int cells_;
};

}  // namespace

std::unique_ptr<CosineTexels> cosine_texels_of_lat_long(int width, int height) {
  return std::make_unique<LatLongTexels>(width, height);
}

std::unique_ptr<CosineTexels> cosine_texels_of_cubemap(int size) { return std::make_unique<CubemapTexels>(size); }

}  // namespace welkin::projection

namespace welkin {
namespace {

// The irradiance of the first bands beside the direct one.

double ratio(double difference, double whole) {
  if (difference == 0.0) return 0.0;
  return whole > 0.0 ? difference / whole : std::numeric_limits<double>::infinity();
}

std::vector<IrradianceError> errors_at(const std::vector<glm::dvec3>& normals, const std::vector<glm::dvec3>& truth,
                                       const SphericalHarmonics& radiance) {
  const auto bands = static_cast<std::size_t>(radiance.bands());
  const SphericalHarmonics irradiance = irradiance_from_radiance(radiance);
  std::vector<double> basis(irradiance.coefficients().size());
  std::vector<IrradianceError> errors(bands);
  std::vector<double> squares(bands);
  double truth_squares = 0.0;
  for (std::size_t n = 0; n < normals.size(); ++n) {
    math::evaluate_basis(normals[n].x, normals[n].y, normals[n].z, radiance.bands(), basis.data());
    const double size = glm::length(truth[n]);
    truth_squares += size * size;
    glm::dvec3 sum(0.0);
    for (std::size_t l = 0; l < bands; ++l) {
      for (std::size_t k = l * l; k < (l + 1) * (l + 1); ++k) sum += basis[k] * irradiance.coefficients()[k];
      const double difference = glm::length(sum - truth[n]);
      squares[l] += difference * difference;
      if (difference >= errors[l].maximum) {
        errors[l].maximum = difference;
        errors[l].worst_normal = normals[n];
      }
      errors[l].relative = std::max(errors[l].relative, ratio(difference, size));
    }
  }
  const double truth_rms = std::sqrt(truth_squares / static_cast<double>(normals.size()));
  for (std::size_t l = 0; l < bands; ++l) {
    errors[l].bands = static_cast<int>(l) + 1;
    errors[l].rms = ratio(std::sqrt(squares[l] / static_cast<double>(normals.size())), truth_rms);
    errors[l].maximum = ratio(errors[l].maximum, truth_rms);
  }
  return errors;
}

}  // namespace

std::vector<IrradianceError> irradiance_errors(const CubemapView& cubemap, const SphericalHarmonics& radiance,
                                               int normals, const PixelPolicy& pixels, const Control& control) {
  const platform::FloatingPointScope floating_point;
  const std::vector<glm::dvec3> directions = projection::spiral(normals);
  return errors_at(directions, direct_irradiance(cubemap, directions, pixels, control), radiance);
}

std::vector<IrradianceError> irradiance_errors(const LatLongView& lat_long, const SphericalHarmonics& radiance,
                                               int normals, const PixelPolicy& pixels, const Control& control) {
  const platform::FloatingPointScope floating_point;
  const std::vector<glm::dvec3> directions = projection::spiral(normals);
  return errors_at(directions, direct_irradiance(lat_long, directions, pixels, control), radiance);
}

namespace {

constexpr int kLargestSize = 4096;
constexpr double kTileProducts = 1e6;    ///< texels times coefficients: some 0.2 ms
constexpr double kInlineProducts = 1e5;  ///< less is done by the caller's thread alone
constexpr std::size_t kNormalsAtATime = 65536;
constexpr double kMostIrradiance = std::numeric_limits<float>::max();

CubemapImage empty_cubemap(int size) {
  image::require_range("the irradiance cubemap's size", size, 1, kLargestSize);
  const auto edge = static_cast<std::size_t>(size);
  return {size, std::vector<float>(18 * edge * edge)};
}

/// Channel after channel, as the kernel wants them.
std::vector<double> channels_of(const SphericalHarmonics& harmonics) {
  std::vector<double> channels;
  for (int c = 0; c < 3; ++c) {
    for (const glm::dvec3& coefficient : harmonics.coefficients()) channels.push_back(coefficient[c]);
  }
  return channels;
}

std::vector<double> texel_centres(int size) {
  std::vector<double> centres;
  centres.reserve(static_cast<std::size_t>(size));
  for (int column = 0; column < size; ++column) centres.push_back(static_cast<double>(2 * column + 1 - size) / size);
  return centres;
}

template <class View>
CubemapImage directly(const View& source, int size, const Control& control) {
  CubemapImage result = empty_cubemap(size);
  const std::size_t texels = result.pixels.size() / 3;
  const auto edge = static_cast<std::size_t>(size);
  std::vector<glm::dvec3> normals;
  for (std::size_t first = 0; first < texels; first += normals.size()) {
    const std::size_t end = std::min(texels, first + kNormalsAtATime);
    normals.clear();
    for (std::size_t texel = first; texel < end; ++texel) {
      const auto row = static_cast<int>(texel / edge);
      normals.push_back(
          image::face_direction(size, row / size, static_cast<double>(texel % edge) + 0.5, row % size + 0.5));
    }
    const auto share = [&](std::size_t done) { return static_cast<double>(done) / static_cast<double>(texels); };
    const Control part = jobs::part_of(control, share(first), share(end));
    const std::vector<glm::dvec3> irradiance = direct_irradiance(source, normals, {}, part);
    for (std::size_t i = 0; i < irradiance.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = irradiance[i][static_cast<glm::length_t>(c)];
        result.pixels[3 * (first + i) + c] = static_cast<float>(std::clamp(value, -kMostIrradiance, kMostIrradiance));
      }
    }
  }
  return result;
}

/// Whether these coefficients can sum to more than the floats hold; no harmonic of 16 bands exceeds 2.3.
bool may_overflow(const std::vector<double>& channels) {
  double sum = 0.0;
  for (const double value : channels) sum += 2.3 * std::abs(value);
  return !(sum <= kMostIrradiance);
}

}  // namespace

CubemapImage irradiance_cubemap(const SphericalHarmonics& irradiance, int size, const Control& control) {
  const platform::FloatingPointScope floating_point;
  CubemapImage result = empty_cubemap(size);
  const projection::ProjectionKernels& kernels = projection::projection_kernels();
  const std::vector<double> channels = channels_of(irradiance);
  const std::vector<double> centres = texel_centres(size);
  const int bands = irradiance.bands();
  const double row_products = 1.0 * size * bands * bands;
  const int rows = 6 * size;
  const int tile_rows = static_cast<int>(std::clamp(kTileProducts / row_products, 1.0, 1.0 * rows));
  const bool small = row_products * rows < kInlineProducts;
  const auto placement = small ? jobs::Placement::calling_thread : jobs::Placement::arena;
  jobs::run_tiles(static_cast<std::size_t>((rows + tile_rows - 1) / tile_rows), placement,
                  jobs::worker_count(placement), control, [&](std::size_t tile, std::size_t) {
                    const int first = static_cast<int>(tile) * tile_rows;
                    for (int row = first; row < std::min(rows, first + tile_rows); ++row) {
                      const image::Frame& frame = image::face_frame(row / size);
                      const double v = centres[static_cast<std::size_t>(row % size)];
                      projection::DirectionRun run{};
                      for (int axis = 0; axis < 3; ++axis) {
                        run.start[axis] = frame.normal[axis] + v * frame.v[axis];
                        run.step[axis] = frame.u[axis];
                      }
                      run.u = centres.data();
                      run.count = size;
                      kernels.evaluate_harmonics(run, math::basis_constants(), channels.data(), bands,
                                                 result.pixels.data() + std::size_t{3} * static_cast<std::size_t>(row) *
                                                                            static_cast<std::size_t>(size));
                    }
                  });
  if (may_overflow(channels)) {
    constexpr auto most = static_cast<float>(kMostIrradiance);
    for (float& value : result.pixels) value = std::clamp(value, -most, most);
  }
  return result;
}

CubemapImage direct_irradiance_cubemap(const CubemapView& source, int size, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return directly(source, size, control);
}

CubemapImage direct_irradiance_cubemap(const LatLongView& source, int size, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return directly(source, size, control);
}

}  // namespace welkin
