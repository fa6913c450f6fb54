// The truth at chosen directions.
#include "reflections/direct.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "platform/float_environment.h"
#include "projection/sun_detection.h"
#include "reflections/lobe.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::reflections {
namespace {

constexpr std::size_t kBatch = 512;  ///< directions at a time: bounds the memory, 12 MiB of slots
constexpr std::size_t kMostTiles = 1024;

/// One worker's room.
struct Scratch {
  explicit Scratch(std::size_t columns) : integrals(columns), red(columns), green(columns), blue(columns) {
    for (auto* list : {&centres.x, &centres.y, &centres.z, &centres.solid_angle}) list->resize(columns);
  }
  TexelRow centres;
  std::vector<double> integrals;
  std::vector<double> red, green, blue;
};

void integrate_batch(const projection::SanitizedSource& source, const LobeTexels& texels, double alpha,
                     std::span<const glm::dvec3> directions, const Control& control, std::vector<glm::dvec3>& result) {
  const auto rows = static_cast<std::size_t>(source.rows());
  const auto columns = static_cast<std::size_t>(source.columns());
  const std::size_t rows_per_tile = (rows + kMostTiles - 1) / kMostTiles;
  const std::size_t tiles = (rows + rows_per_tile - 1) / rows_per_tile;
  const jobs::Placement placement = jobs::placement_for(static_cast<std::int64_t>(rows * columns * directions.size()));
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<Scratch> scratch(workers, Scratch(columns));
  std::vector<glm::dvec3> slots(tiles * directions.size(), glm::dvec3(0.0));

  jobs::run_tiles(tiles, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
    Scratch& room = scratch[worker];
    glm::dvec3* const slot = slots.data() + tile * directions.size();
    for (std::size_t row = tile * rows_per_tile; row < std::min(rows, (tile + 1) * rows_per_tile); ++row) {
      const float* const rgb = source.row(static_cast<int>(row));
      for (std::size_t i = 0; i < columns; ++i) {
        room.red[i] = static_cast<double>(rgb[3 * i]);
        room.green[i] = static_cast<double>(rgb[3 * i + 1]);
        room.blue[i] = static_cast<double>(rgb[3 * i + 2]);
      }
      texels.fill(static_cast<int>(row), room.centres);
      for (std::size_t n = 0; n < directions.size(); ++n) {
        if (!fill_lobe_integrals(texels, static_cast<int>(row), room.centres, directions[n], alpha, room.integrals))
          continue;
        slot[n] += glm::dvec3(math::dot(room.integrals, room.red), math::dot(room.integrals, room.green),
                              math::dot(room.integrals, room.blue));
      }
    }
  });

  const std::size_t first = result.size();
  result.resize(first + directions.size(), glm::dvec3(0.0));
  for (std::size_t k = 0; k < slots.size(); ++k) result[first + k % directions.size()] += slots[k];
}

int clamped(double place, int count) noexcept { return std::clamp(static_cast<int>(std::floor(place)), 0, count - 1); }

}  // namespace

std::vector<glm::dvec3> integrate_lobes(const projection::SanitizedSource& source, double alpha,
                                        std::span<const glm::dvec3> directions, const Control& control) {
  const auto texels = source.cubemap() ? lobe_texels_of_cubemap(source.columns())
                                       : lobe_texels_of_lat_long(source.columns(), source.rows());
  const auto share_done = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(directions.size());
  };
  std::vector<glm::dvec3> result;
  while (result.size() < directions.size()) {
    const std::size_t first = result.size();
    const std::size_t count = std::min(kBatch, directions.size() - first);
    const Control part = jobs::part_of(control, share_done(first), share_done(first + count));
    integrate_batch(source, *texels, alpha, directions.subspan(first, count), part, result);
  }
  const double whole = lobe_integral(alpha);
  for (glm::dvec3& value : result) value /= whole;
  return result;
}

glm::dvec3 radiance_towards(const projection::SanitizedSource& source, const glm::dvec3& d) noexcept {
  const int columns = source.columns();
  if (!source.cubemap()) {
    const double longitude = math::turns_of(d.x, d.z);
    const double latitude = math::turns_of(d.y, std::sqrt(d.x * d.x + d.z * d.z));
    const int column = clamped((0.5 - longitude) * columns, columns);
    const int row = clamped((0.25 - latitude) * 2.0 * source.rows(), source.rows());
    return projection::radiance_of(source.row(row) + std::ptrdiff_t{3} * column);
  }
  const int face = image::face_of(d);
  const image::Frame& frame = image::face_frame(face);
  const auto along = [&](const glm::dvec3& axis) { return d.x * axis.x + d.y * axis.y + d.z * axis.z; };
  const double normal = along(frame.normal);
  const int column = clamped(0.5 * (along(frame.u) / normal + 1.0) * columns, columns);
  const int row = clamped(0.5 * (along(frame.v) / normal + 1.0) * columns, columns);
  return projection::radiance_of(source.row(face * columns + row) + std::ptrdiff_t{3} * column);
}

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHorizonCell = 0.01;  ///< radians: what the horizon cuts is cut further down to this radius
constexpr int kMostDepth = 24;

/// The lobe with its constants at hand.
struct Lobe {
  explicit Lobe(double alpha) : square(alpha * alpha), slope(0.5 * (1.0 - square)), scale(square / kPi) {}

  /// x = 1 - cosine.
  [[nodiscard]] double at(double x) const noexcept {
    if (x >= 1.0) return 0.0;
    const double width = square + x * slope;
    return (1.0 - x) * scale / (width * width);
  }

  double square;
  double slope;
  double scale;
};

/// A part of a texel in units of texels, halves of its edges.
struct Part {
  double column, row;  ///< centre
  double across, down;
};

/// 1 - cosine without cancellation: both are of unit length.
double distance_of(const glm::dvec3& a, const glm::dvec3& b) noexcept {
  const glm::dvec3 chord = a - b;
  return 0.5 * glm::dot(chord, chord);
}

/// Points of the Gauss rule for a part of radius h whose nearest pole is l away: its error falls like (2 l / h)^(-2 n).
int order_for(double reach) noexcept {  // l / h
  if (reach > 2000.0) return 1;
  if (reach > 50.0) return 2;
  if (reach > 11.0) return 3;
  if (reach > 5.0) return 4;
  return reach > 3.0 ? 6 : 8;
}

/// Mapping: `direction(column, row)`, unit; `density(column, row)`, steradians an area unit there; `radius(part)`;
/// `too_wide(part)`: the mapping itself is not smooth enough over the part.
template <class Mapping>
double integrate(const Mapping& mapping, const Part& part, const glm::dvec3& normal, const Lobe& lobe,
                 int depth) noexcept {
  const glm::dvec3 centre = mapping.direction(part.column, part.row);
  const double radius = mapping.radius(part);
  const double x = distance_of(centre, normal);
  if (x - 1.0 > radius) return 0.0;
  const double reach = std::sqrt(2.0 * x + 4.0 * lobe.square) / radius;
  const bool cut = std::abs(x - 1.0) <= radius;
  if (depth < kMostDepth && ((cut && radius > kHorizonCell) || reach < 2.0 || mapping.too_wide(part))) {
    double sum = 0.0;
    for (const double down : {-0.5, 0.5}) {
      for (const double across : {-0.5, 0.5}) {
        const Part quarter{part.column + across * part.across, part.row + down * part.down, 0.5 * part.across,
                           0.5 * part.down};
        sum += integrate(mapping, quarter, normal, lobe, depth + 1);
      }
    }
    return sum;
  }
  const math::GaussRule rule = math::gauss_legendre(cut ? std::max(3, order_for(reach)) : order_for(reach));
  double sum = 0.0;
  for (int j = 0; j < rule.order; ++j) {
    for (int i = 0; i < rule.order; ++i) {
      const double column = part.column + part.across * rule.nodes[i];
      const double row = part.row + part.down * rule.nodes[j];
      sum += rule.weights[i] * rule.weights[j] * mapping.density(column, row) *
             lobe.at(distance_of(mapping.direction(column, row), normal));
    }
  }
  return sum * part.across * part.down;
}

/// Longitude and latitude.
class LatLongTexels final : public LobeTexels {
 public:
  LatLongTexels(int width, int height) : width_(width), height_(height) {
    const double node = math::gauss_legendre(2).nodes[1];
    for (int i = 0; i < width; ++i) {
      longitudes_.push_back(math::sine_cosine_of_turns(0.5 - (i + 0.5) / width));
      for (const double side : {-0.5, 0.5})
        two_longitudes_.push_back(math::sine_cosine_of_turns(0.5 - (i + 0.5 + side * node) / width));
    }
    for (int j = 0; j < height; ++j) {
      for (const double side : {-0.5, 0.5})
        two_latitudes_.push_back(math::sine_cosine_of_turns(0.25 - (j + 0.5 + side * node) / (2.0 * height)));
    }
  }

  [[nodiscard]] int rows() const noexcept override { return height_; }
  [[nodiscard]] int columns() const noexcept override { return width_; }

  void fill(int row, TexelRow& texels) const override {
    const math::SineCosine latitude = math::sine_cosine_of_turns(0.25 - centroid(row) / (2.0 * height_));
    for (std::size_t i = 0; i < longitudes_.size(); ++i) {
      texels.x[i] = longitudes_[i].sine * latitude.cosine;
      texels.y[i] = latitude.sine;
      texels.z[i] = longitudes_[i].cosine * latitude.cosine;
    }
    const double steradians = image::lat_long_texel_solid_angle(width_, height_, row);
    std::fill(texels.solid_angle.begin(), texels.solid_angle.end(), steradians);
    texels.radius = radius({0.5, row + 0.5, 0.5, 0.5});
  }

  [[nodiscard]] double integral(int row, int column, const glm::dvec3& normal, double alpha) const noexcept override {
    const Lobe lobe(alpha);
    const Part texel{column + 0.5, row + 0.5, 0.5, 0.5};
    const double double_x = 2.0 * distance_of(centre_at(row, column), normal);
    const double reach = std::sqrt(double_x + 4.0 * lobe.square) / radius(texel);
    const bool cut = std::abs(0.5 * double_x - 1.0) <= radius(texel);
    if (cut || reach < 50.0 || too_wide(texel)) return integrate(*this, texel, normal, lobe, 0);
    return by_four(row, column, normal, lobe);
  }

  [[nodiscard]] glm::dvec3 direction(double column, double row) const noexcept {
    return image::lat_long_direction(width_, height_, column, row);
  }
  [[nodiscard]] double density(double /*column*/, double row) const noexcept {
    const double cosine = math::sine_cosine_of_turns(0.5 * row / height_).sine;
    return 2.0 * kPi / width_ * (kPi / height_) * cosine;
  }
  /// No cosine of a latitude in the part is above that at its centre by more than half its height.
  [[nodiscard]] double radius(const Part& part) const noexcept {
    const double down = kPi / height_ * part.down;
    const double cosine = std::min(1.0, math::sine_cosine_of_turns(0.5 * part.row / height_).sine + down);
    const double across = 2.0 * kPi / width_ * part.across * cosine;
    return std::sqrt(across * across + down * down);
  }
  [[nodiscard]] bool too_wide(const Part& part) const noexcept {
    return part.across > 0.125 * width_ || part.down > 0.25 * height_;  // 45 degrees each side
  }

 private:
  /// Where a row's area has its centre: at a pole at two thirds of the row, not in its middle.
  [[nodiscard]] double centroid(int row) const noexcept {
    const math::GaussRule rule = math::gauss_legendre(3);
    double moment = 0.0;
    double whole = 0.0;
    for (int j = 0; j < rule.order; ++j) {
      const double place = row + 0.5 + 0.5 * rule.nodes[j];
      const double weight = rule.weights[j] * math::sine_cosine_of_turns(place / (2.0 * height_)).sine;
      moment += weight * 0.5 * rule.nodes[j];
      whole += weight;
    }
    return row + 0.5 + moment / whole;
  }
  [[nodiscard]] static glm::dvec3 towards(const math::SineCosine& longitude, const math::SineCosine& latitude) {
    return {longitude.sine * latitude.cosine, latitude.sine, longitude.cosine * latitude.cosine};
  }
  [[nodiscard]] glm::dvec3 centre_at(int row, int column) const noexcept {
    return towards(longitudes_[static_cast<std::size_t>(column)],
                   math::sine_cosine_of_turns(0.25 - (row + 0.5) / (2.0 * height_)));
  }

  /// `integrate` by the Gauss rule with two points along each edge, from tables.
  [[nodiscard]] double by_four(int row, int column, const glm::dvec3& normal, const Lobe& lobe) const noexcept {
    double sum = 0.0;
    for (std::size_t j = 0; j < 2; ++j) {
      const math::SineCosine& latitude = two_latitudes_[2 * static_cast<std::size_t>(row) + j];
      for (std::size_t i = 0; i < 2; ++i) {
        const math::SineCosine& longitude = two_longitudes_[2 * static_cast<std::size_t>(column) + i];
        sum += latitude.cosine * lobe.at(distance_of(towards(longitude, latitude), normal));
      }
    }
    return sum * (kPi / width_) * (kPi / (2.0 * height_));
  }

  int width_;
  int height_;
  std::vector<math::SineCosine> longitudes_;
  std::vector<math::SineCosine> two_longitudes_;  ///< of the two points of each column
  std::vector<math::SineCosine> two_latitudes_;
};

class CubemapTexels final : public LobeTexels {
 public:
  explicit CubemapTexels(int size) : size_(size) {}

  [[nodiscard]] int rows() const noexcept override { return 6 * size_; }
  [[nodiscard]] int columns() const noexcept override { return size_; }

  void fill(int row, TexelRow& texels) const override {
    image::cubemap_row_solid_angles(row % size_, texels.solid_angle);
    for (int column = 0; column < size_; ++column) {
      const auto i = static_cast<std::size_t>(column);
      const glm::dvec3 d = image::face_direction(size_, row / size_, column + 0.5, row % size_ + 0.5);
      texels.x[i] = d.x;
      texels.y[i] = d.y;
      texels.z[i] = d.z;
    }
    texels.radius = std::numbers::sqrt2 / size_;
  }

  [[nodiscard]] double integral(int row, int column, const glm::dvec3& normal, double alpha) const noexcept override {
    const Face face{size_, row / size_};
    return integrate(face, {column + 0.5, row % size_ + 0.5, 0.5, 0.5}, normal, Lobe(alpha), 0);
  }

 private:
  struct Face {
    int size;
    int face;

    [[nodiscard]] glm::dvec3 direction(double column, double row) const noexcept {
      return image::face_direction(size, face, column, row);
    }
    [[nodiscard]] double density(double column, double row) const noexcept {
      const double u = 2.0 * column / size - 1.0;
      const double v = 2.0 * row / size - 1.0;
      const double q = 1.0 / (1.0 + u * u + v * v);
      return 4.0 / (static_cast<double>(size) * size) * q * std::sqrt(q);
    }
    [[nodiscard]] double radius(const Part& part) const noexcept {
      return 2.0 / size * std::sqrt(part.across * part.across + part.down * part.down);
    }
    [[nodiscard]] bool too_wide(const Part& part) const noexcept { return part.across > 0.13 * size; }
  };

  int size_;
};

}  // namespace

std::unique_ptr<LobeTexels> lobe_texels_of_lat_long(int width, int height) {
  return std::make_unique<LatLongTexels>(width, height);
}

std::unique_ptr<LobeTexels> lobe_texels_of_cubemap(int size) { return std::make_unique<CubemapTexels>(size); }

bool fill_lobe_integrals(const LobeTexels& texels, int row, const TexelRow& centres, const glm::dvec3& normal,
                         double alpha, std::vector<double>& integrals) {
  const Lobe lobe(alpha);
  const std::size_t count = integrals.size();
  double* const x = integrals.data();
  for (std::size_t i = 0; i < count; ++i)
    x[i] = 1.0 - (normal.x * centres.x[i] + normal.y * centres.y[i] + normal.z * centres.z[i]);
  // Within `near` of the direction, or at the horizon, a texel is looked at more closely.
  const double reach = centres.radius / 0.007;
  const double near = std::max(0.0, 0.5 * (reach * reach - 4.0 * lobe.square));
  double largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (x[i] < near || std::abs(x[i] - 1.0) <= centres.radius) {
      x[i] = texels.integral(row, static_cast<int>(i), normal, alpha);
    } else {
      x[i] = lobe.at(x[i]) * centres.solid_angle[i];
    }
    largest = std::max(largest, x[i]);
  }
  return largest > 0.0;
}

}  // namespace welkin::reflections

namespace welkin {
namespace {

constexpr std::size_t kMostDirections = 10'000'000;
constexpr double kLeastAlpha = 1e-6;

std::vector<glm::dvec3> unit_directions(const std::vector<glm::dvec3>& directions) {
  if (directions.empty() || directions.size() > kMostDirections) {
    throw Error(ErrorCode::invalid_argument, std::to_string(directions.size()) + " directions; 1 to " +
                                                 std::to_string(kMostDirections) + " are possible");
  }
  std::vector<glm::dvec3> units;
  for (const glm::dvec3& direction : directions) {
    const double length = glm::length(direction);
    if (!(length > 0.0) || !std::isfinite(length)) {
      throw Error(ErrorCode::invalid_argument,
                  "direction " + std::to_string(units.size()) + " has no length that could be made 1");
    }
    units.push_back(direction / length);
  }
  return units;
}

template <class View>
std::vector<glm::dvec3> reference(const View& view, double roughness, const std::vector<glm::dvec3>& directions,
                                  const Control& control) {
  image::check_view(view);
  if (!(roughness >= 0.0 && roughness <= 1.0)) {
    throw Error(ErrorCode::invalid_argument, "roughness " + std::to_string(roughness) + " is not from 0 to 1");
  }
  const std::vector<glm::dvec3> units = unit_directions(directions);
  const projection::SanitizedSource source(view, {}, {control.stop, {}});
  const double alpha = roughness * roughness;
  if (alpha >= kLeastAlpha) return reflections::integrate_lobes(source, alpha, units, control);
  std::vector<glm::dvec3> values;
  values.reserve(units.size());
  for (const glm::dvec3& unit : units) values.push_back(reflections::radiance_towards(source, unit));
  return values;
}

}  // namespace

std::vector<glm::dvec3> reference_specular(const LatLongView& source, double roughness,
                                           const std::vector<glm::dvec3>& directions, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return reference(source, roughness, directions, control);
}

std::vector<glm::dvec3> reference_specular(const CubemapView& source, double roughness,
                                           const std::vector<glm::dvec3>& directions, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return reference(source, roughness, directions, control);
}

}  // namespace welkin
