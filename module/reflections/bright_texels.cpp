// Texels so bright that their lobes are summed one by one, and those sums.
#include "reflections/bright_texels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "reflections/lobe.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;

/// Float arithmetic loses some 3e-7 of the brightest light to everything on its ring of latitude. Blurred light of 500
/// times the mean so costs 1e-4 of the mean, or a hundredth of what is dark: well below that a light is extracted, or
/// where a quarter of all light lies in one lobe, with every texel that makes a tenth of that by itself. What is left
/// of one is as bright as the darkest texel about it.
constexpr double kPeak = 100.0;
constexpr double kLeastPeak = 4.0;
constexpr double kPart = 0.25;
constexpr double kShare = 0.1;

constexpr std::size_t kRowsPerTile = 8;
constexpr std::size_t kMostInTile = 256;

/// What a tile found, in room that was there before.
struct Found {
  explicit Found(BrightTexel* room) : texels(room) {}
  BrightTexel* texels;
  std::size_t count = 0;
};

/// A picture as the search sees it: the light of a texel is the largest of its channels.
class Search {
 public:
  Search(const projection::SanitizedSource& source, double alpha)
      : source_(source), alpha_(alpha), scale_(1.0 / lobe_integral(alpha)) {
    double total_radiance = 0.0;
    for (int row = 0; row < source.rows(); ++row) {
      solid_angle_.push_back(image::lat_long_texel_solid_angle(source.columns(), source.rows(), row));
      total_radiance += solid_angle_.back() * source.columns() * source.range(row).mean;
    }
    mean_ = std::max(0.0, total_radiance / (4.0 * kPi));
    threshold_ = mean_ * std::clamp(kPart * 4.0 * kPi * lobe(1.0, alpha) * scale_, kLeastPeak, kPeak);
    for (int column = 0; column < source.columns(); ++column)
      longitudes_.push_back(math::sine_cosine_of_turns((column + 0.5) / source.columns()));
    for (int row = 0; row < source.rows(); ++row)
      colatitudes_.push_back(math::sine_cosine_of_turns((row + 0.5) / (2.0 * source.rows())));
  }

  void read_row(int row, Found& found) const {
    const double reach = solid_angle_[static_cast<std::size_t>(row)] * lobe(1.0, alpha_) * scale_;
    const double least = kShare * threshold_;
    if (!(static_cast<double>(source_.range(row).largest) * reach > least)) return;
    for (int column = 0; column < source_.columns(); ++column) {
      const double own = light(row, column);
      if (!(own * reach > least)) continue;
      const Surroundings around = surroundings(row, column);
      if (!(around.blurred > threshold_) || !(around.darkest < own)) continue;
      if (found.count == kMostInTile) return;
      const auto factor = static_cast<float>(around.darkest / own);
      BrightTexel texel{row, column, {}, {}, static_cast<float>(own * reach)};
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = source_.row(row)[std::size_t{3} * static_cast<std::size_t>(column) + c];
        texel.rest[c] = value > 0.0F ? value * factor : value;
        texel.excess[c] = value - texel.rest[c];
      }
      found.texels[found.count++] = texel;
    }
  }

 private:
  [[nodiscard]] double light(int row, int column) const {
    const float* const rgb = source_.row(row) + std::ptrdiff_t{3} * column;
    return static_cast<double>(std::max({rgb[0], rgb[1], rgb[2], 0.0F}));
  }

  struct Surroundings {
    double blurred;  ///< light at the texel as the lobe blurs it, from what lies about it: never too much
    double darkest;
  };
  /// Of what lies within the lobe's width.
  [[nodiscard]] Surroundings surroundings(int row, int column) const {
    const int rows = source_.rows();
    const int columns = source_.columns();
    const double width = 2.0 * alpha_;
    const int down = std::clamp(static_cast<int>(width * rows / kPi), 1, 16);
    const math::SineCosine& here = colatitudes_[static_cast<std::size_t>(row)];
    double sum = 0.0;
    double darkest = light(row, column);
    for (int y = std::max(0, row - down); y <= std::min(rows - 1, row + down); ++y) {
      const math::SineCosine& there = colatitudes_[static_cast<std::size_t>(y)];
      const double wide = width * columns / (2.0 * kPi * std::max(1e-3, there.sine));
      const int across = std::min({static_cast<int>(wide) + 1, (columns - 1) / 2, 64});
      for (int x = -across; x <= across; ++x) {
        const int wrapped = (column + x + columns) % columns;
        // The cosine of the difference of two longitudes is that of a longitude: columns are evenly spaced.
        const math::SineCosine& a = longitudes_[static_cast<std::size_t>(column)];
        const math::SineCosine& b = longitudes_[static_cast<std::size_t>(wrapped)];
        const double turn = a.cosine * b.cosine + a.sine * b.sine;
        const double cosine = here.cosine * there.cosine + here.sine * there.sine * turn;
        sum += lobe(cosine, alpha_) * solid_angle_[static_cast<std::size_t>(y)] * light(y, wrapped);
        darkest = std::min(darkest, light(y, wrapped));
      }
    }
    return {sum * scale_, darkest};
  }

  const projection::SanitizedSource& source_;
  double alpha_;
  double scale_;
  double mean_ = 0.0;
  double threshold_ = 0.0;  ///< of blurred light
  std::vector<double> solid_angle_;
  std::vector<math::SineCosine> longitudes_;
  std::vector<math::SineCosine> colatitudes_;
};

}  // namespace

std::vector<BrightTexel> find_bright_texels(const projection::SanitizedSource& source, double alpha, std::size_t most,
                                            const Control& control) {
  // A texel about as wide as the lobe is no point of light; its edges are the harmonics' business.
  if (kPi / source.rows() > 2.0 * alpha || 2.0 * kPi / source.columns() > 2.0 * alpha) return {};
  const Search search(source, alpha);
  const auto rows = static_cast<std::size_t>(source.rows());
  const std::size_t tiles = (rows + kRowsPerTile - 1) / kRowsPerTile;
  std::vector<BrightTexel> room(tiles * kMostInTile);
  std::vector<Found> found;
  for (std::size_t tile = 0; tile < tiles; ++tile) found.emplace_back(room.data() + tile * kMostInTile);
  const auto placement = jobs::placement_for(static_cast<std::int64_t>(rows) * source.columns());
  jobs::run_tiles(tiles, placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t /*worker*/) {
                    const std::size_t end = std::min(rows, (tile + 1) * kRowsPerTile);
                    for (std::size_t row = tile * kRowsPerTile; row < end; ++row)
                      search.read_row(static_cast<int>(row), found[tile]);
                  });
  std::vector<BrightTexel> all;
  for (const Found& list : found) all.insert(all.end(), list.texels, list.texels + list.count);
  if (all.size() <= most) return all;
  std::stable_sort(all.begin(), all.end(), [](const BrightTexel& a, const BrightTexel& b) { return a.peak > b.peak; });
  all.resize(most);
  return all;
}

namespace {

/// A point of a rule that stands for a texel's area, and what it stands for itself.
struct Point {
  glm::dvec3 direction;
  double steradians;
  double half_width;  ///< radians: as wide as the square of the same moment of inertia
};

/// Gauss points on a texel, `across` x `down` of them.
std::vector<Point> points_of(const BrightTexel& texel, int width, int height, int across, int down) {
  const math::GaussRule columns = math::gauss_legendre(across);
  const math::GaussRule rows = math::gauss_legendre(down);
  const double steradians = image::lat_long_texel_solid_angle(width, height, texel.row);
  const auto row_at = [&](int j) { return texel.row + 0.5 + 0.5 * rows.nodes[j]; };
  const auto sine = [&](int j) { return math::sine_cosine_of_turns(row_at(j) / (2.0 * height)).sine; };
  double whole = 0.0;
  for (int j = 0; j < down; ++j) whole += 2.0 * rows.weights[j] * sine(j);
  std::vector<Point> points;
  for (int j = 0; j < down; ++j) {
    for (int i = 0; i < across; ++i) {
      const double wide = 0.5 * columns.weights[i] * kPi / width * sine(j);
      const double high = 0.5 * rows.weights[j] * kPi / (2.0 * height);
      points.push_back(
          {image::lat_long_direction(width, height, texel.column + 0.5 + 0.5 * columns.nodes[i], row_at(j)),
           steradians * columns.weights[i] * rows.weights[j] * sine(j) / whole,
           std::sqrt(0.5 * (wide * wide + high * high))});
    }
  }
  return points;
}

/// Points along an edge of `radians`: they may lie half a lobe's width apart, two stand for a quarter to 1e-3. One
/// would lie in the middle, where a texel at a pole has not its weight, and would meet the horizon as a square; where
/// that cuts a large texel, six keep the part above it to 1e-2 of the sky about a sun a million times as bright.
int points_along(double radians, double alpha, std::size_t texels) {
  const double edge = radians / (2.0 * alpha);
  const int for_horizon = radians < 0.01 ? 2 : (texels <= 16 ? 6 : 4);
  return std::max(for_horizon, edge < 0.3 ? 2 : (edge < 0.6 ? 3 : 5));
}

}  // namespace

std::vector<LobeLight> lobe_lights(const std::vector<BrightTexel>& texels, int width, int height, double alpha) {
  std::vector<LobeLight> lights;
  const double constant = alpha * alpha / kPi / lobe_integral(alpha);
  const int across = points_along(2.0 * kPi / width, alpha, texels.size());
  const int down = points_along(kPi / height, alpha, texels.size());
  for (const BrightTexel& texel : texels) {
    for (const Point& point : points_of(texel, width, height, across, down)) {
      const auto light = [&](std::size_t c) {
        return static_cast<float>(constant * point.steradians * static_cast<double>(texel.excess[c]));
      };
      lights.push_back({static_cast<float>(point.direction.x), static_cast<float>(point.direction.y),
                        static_cast<float>(point.direction.z), light(0), light(1), light(2),
                        static_cast<float>(point.half_width), static_cast<float>(0.25 / point.half_width)});
    }
  }
  return lights;
}

namespace {

constexpr std::int64_t kTileWork = 1 << 16;  ///< texels times lights: some 50 microseconds

LobeRow lobe_row(int face, int size, int row, double alpha) {
  const image::Frame& frame = image::face_frame(face);
  const double v = (2.0 * row + 1.0) / size - 1.0;
  LobeRow result{};
  for (int axis = 0; axis < 3; ++axis) {
    result.base[axis] = static_cast<float>(frame.normal[axis] + v * frame.v[axis]);
    result.along[axis] = static_cast<float>(frame.u[axis]);
  }
  result.step = static_cast<float>(1.0 / size);
  result.count = size;
  result.alpha_squared = static_cast<float>(alpha * alpha);
  result.half_slope = static_cast<float>(0.25 * (1.0 - alpha * alpha));
  return result;
}

}  // namespace

void add_lobe_lights(std::span<const LobeLight> lights, double alpha, int size, const std::array<float*, 6>& faces,
                     const Control& control) {
  if (lights.empty()) return;
  const std::int64_t row_work = static_cast<std::int64_t>(size) * static_cast<std::int64_t>(lights.size());
  const int rows = 6 * size;
  const int rows_per_tile = static_cast<int>(std::clamp<std::int64_t>(kTileWork / row_work, 1, rows));
  const int tiles = (rows + rows_per_tile - 1) / rows_per_tile;
  const auto placement = jobs::placement_for(rows * row_work / 4);
  const LobeKernels& kernels = lobe_kernels();
  jobs::run_tiles(static_cast<std::size_t>(tiles), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t /*worker*/) {
                    const int first = static_cast<int>(tile) * rows_per_tile;
                    for (int row = first; row < std::min(rows, first + rows_per_tile); ++row) {
                      const int face = row / size;
                      float* const rgb =
                          faces[static_cast<std::size_t>(face)] + std::ptrdiff_t{3} * size * (row % size);
                      kernels.add_lobes(lobe_row(face, size, row % size, alpha), lights.data(),
                                        static_cast<int>(lights.size()), rgb);
                    }
                  });
}

}  // namespace welkin::reflections
