// What a table gains, as sums over the source's texels.
#include <algorithm>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "image/pixels.h"
#include "importance/row_weights.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "welkin/importance.h"

namespace welkin {
namespace {

using importance::Overlaps;
using importance::RowWeights;
using importance::Share;

constexpr double kPi = std::numbers::pi;

/// Of a row of the table: integrals over the sphere.
struct Sums {
  double weight = 0.0;
  double squared = 0.0;           ///< the weight's square
  double squared_by_table = 0.0;  ///< the weight's square over the density
};

void require_no_larger(const LatLongView& source, const ImportanceTable& table) {
  if (table.width <= source.width && table.height <= source.height) return;
  throw Error(ErrorCode::invalid_argument, "the importance table has " + std::to_string(table.width) + " x " +
                                               std::to_string(table.height) + " texels and the source " +
                                               std::to_string(source.width) + " x " + std::to_string(source.height) +
                                               "; it must not be larger");
}

}  // namespace

// With N samples of density p the variance of the mean of w / p is (integral of w^2 / p - (integral of w)^2) / N.
ImportanceVariance importance_variance(const LatLongView& source, const ImportanceTable& table, ImportanceWeight weight,
                                       const PixelPolicy& pixels, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(source);
  projection::check_policy(pixels);
  importance::check_table(table);
  require_no_larger(source, table);
  const RowWeights weights(source, weight, pixels);
  const Overlaps columns = Overlaps::of_columns(source.width, table.width);
  const Overlaps rows = Overlaps::of_rows(source.height, table.height);
  std::vector<Sums> sums(static_cast<std::size_t>(table.height));
  const jobs::Placement placement = jobs::placement_for(std::int64_t{source.width} * source.height);
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<RowWeights::Scratch> scratch(workers, RowWeights::Scratch(source));
  jobs::run_tiles(sums.size(), placement, workers, control, [&](std::size_t row, std::size_t worker) {
    Sums& sum = sums[row];
    const int index = static_cast<int>(row);
    const double cell_solid_angle = importance::texel_solid_angle(table.width, table.height, index);
    const auto width = static_cast<std::size_t>(table.width);
    const float* const function = table.function.data() + row * width;
    for (const Share& share : rows.of(index)) {
      const std::span<const float> values = weights.read(share.texel, scratch[worker]);
      const double area = share.part * 2.0 * kPi / source.width;
      for (std::size_t k = 0; k < width; ++k) {
        const double density = static_cast<double>(function[k]) / table.integral / cell_solid_angle;
        for (const Share& column : columns.of(static_cast<int>(k))) {
          const auto value = static_cast<double>(values[static_cast<std::size_t>(column.texel)]);
          if (value == 0.0) continue;
          const double solid_angle = area * column.part;
          sum.weight += value * solid_angle;
          sum.squared += value * value * solid_angle;
          sum.squared_by_table +=
              density > 0.0 ? value * value / density * solid_angle : std::numeric_limits<double>::infinity();
        }
      }
    }
  });
  Sums all;
  for (const Sums& sum : sums) {
    all.weight += sum.weight;
    all.squared += sum.squared;
    all.squared_by_table += sum.squared_by_table;
  }
  importance::throw_if_rejected(scratch);
  if (all.weight == 0.0) return {};
  // Relative to (Int w)^2, for one sample: Int w^2 / p / (Int w)^2 - 1, with p = 1 / (4 pi) for directions that are
  // even over the sphere, and the table's p. By Cauchy and Schwarz neither is below 0.
  const double square = all.weight * all.weight;
  // Rounding may leave a table that is exact a hair below 0.
  return {std::max(0.0, 4.0 * kPi * all.squared / square - 1.0), std::max(0.0, all.squared_by_table / square - 1.0)};
}

}  // namespace welkin
