#include "reflections/image_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "projection/projection_kernels.h"
#include "reflections/cube_rings.h"

namespace welkin::reflections {
namespace {

/// Sums of squares over rows.
struct Steps {
  double across = 0.0;
  double down = 0.0;
};

/// `below`: the next row, or `here` where there is none; `left`: what is left of the first texel.
Steps steps_of(const float* here, const float* below, const float* left, int columns) {
  Steps steps;
  for (int k = 0; k < 3 * columns; ++k) {
    const auto value = static_cast<double>(here[k]);
    const double across = value - static_cast<double>(k >= 3 ? here[k - 3] : left[k]);
    const double down = value - static_cast<double>(below[k]);
    steps.across += across * across;
    steps.down += down * down;
  }
  return steps;
}

/// Edges of meridians are a row high at all latitudes, those of rows as long as their columns are wide. A texel has
/// 2 pi / columns pi / rows `middle` steradians, an edge between columns the length pi / rows and one between rows
/// 2 pi / columns `end`: over the former, columns / 2 pi and rows / pi `end` remain, per sum of `middle`.
double edges_of_lat_long(const projection::SanitizedSource& source) {
  const double columns_a_radian = source.columns() / (2.0 * std::numbers::pi);
  const double rows_a_radian = source.rows() / std::numbers::pi;
  double edges = 0.0;
  double whole = 0.0;
  for (int row = 0; row < source.rows(); ++row) {
    const bool last = row + 1 == source.rows();
    const float* const here = source.row(row);
    const Steps steps = steps_of(here, last ? here : source.row(row + 1),
                                 here + std::ptrdiff_t{3} * (source.columns() - 1), source.columns());
    const double middle = math::sine_cosine_of_turns(0.5 * (row + 0.5) / source.rows()).sine;
    const double end = math::sine_cosine_of_turns(0.5 * (row + 1.0) / source.rows()).sine;
    edges += columns_a_radian * steps.across + rows_a_radian * end * steps.down;
    whole += middle * source.columns();
  }
  return std::sqrt(edges / whole);
}

}  // namespace

// All texels count alike, as their solid angles nearly do.
double contrast_of_faces(const std::vector<const float*>& rows, int columns) {
  Steps all;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const bool face_ends = (row + 1) % static_cast<std::size_t>(columns) == 0;
    const Steps steps = steps_of(rows[row], face_ends ? rows[row] : rows[row + 1], rows[row], columns);
    all = {all.across + steps.across, all.down + steps.down};
  }
  return std::sqrt((all.across + all.down) / (static_cast<double>(rows.size()) * columns));
}

double contrast_of(const projection::SanitizedSource& source) {
  return source.cubemap() ? contrast_of_faces(rows_without({}, source).rows, source.columns())
                          : edges_of_lat_long(source);
}

double rms_of_level(const Cubemap& chain, int level, int samples) {
  const int size = chain.level_size(level);
  const int step = (size + samples - 1) / samples;
  const auto angles = image::FaceSolidAngles::get(size);
  std::array<double, 12> squares{};  // four texels side by side: one addition after the other would take the time
  double whole = 0.0;
  const auto seen = static_cast<std::size_t>((size - step / 2 + step - 1) / step);
  std::vector<double> steradians((3 * seen + 11) / 12 * 12);  // of a row's texels, for each channel
  std::vector<float> texels(steradians.size());
  for (int row = step / 2; row < size; row += step) {
    for (std::size_t k = 0; k < seen; ++k) {
      const double angle = angles->at(row, step / 2 + static_cast<int>(k) * step);
      std::fill_n(&steradians[3 * k], 3, angle);
      whole += 6.0 * angle;
    }
    for (int face = 0; face < 6; ++face) {
      const float* rgb = chain.face(level, face) + std::ptrdiff_t{3} * (size * row + step / 2);
      if (step > 1 || texels.size() > 3 * seen) {
        for (std::size_t k = 0; k < 3 * seen; ++k) texels[k] = rgb[k / 3 * 3 * static_cast<std::size_t>(step) + k % 3];
        rgb = texels.data();
      }
      std::array<double, 12> sums = squares;
      for (std::size_t first = 0; first < steradians.size(); first += sums.size()) {
        for (std::size_t k = 0; k < sums.size(); ++k)
          sums[k] +=
              steradians[first + k] * (static_cast<double>(rgb[first + k]) * static_cast<double>(rgb[first + k]));
      }
      squares = sums;
    }
  }
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) / whole);
}

double least_of(const Cubemap& chain, int level, const Control& control) {
  constexpr std::ptrdiff_t kTileValues = 65536;
  const int size = chain.level_size(level);
  const std::ptrdiff_t values = std::ptrdiff_t{18} * size * size;
  const float* const first = chain.face(level, 0);
  std::vector<float> minima(static_cast<std::size_t>((values + kTileValues - 1) / kTileValues));
  const auto placement = minima.size() < 4 ? jobs::Placement::calling_thread : jobs::Placement::arena;
  jobs::run_tiles(minima.size(), placement, jobs::worker_count(placement), {control.stop, {}},
                  [&](std::size_t tile, std::size_t) {
                    const std::ptrdiff_t begin = static_cast<std::ptrdiff_t>(tile) * kTileValues;
                    const auto count = static_cast<int>(std::min(values - begin, kTileValues));
                    minima[tile] = projection::projection_kernels().measure_row(first + begin, count).least;
                  });
  return static_cast<double>(*std::min_element(minima.begin(), minima.end()));
}

}  // namespace welkin::reflections
