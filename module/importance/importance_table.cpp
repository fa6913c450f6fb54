// The density's integrals and their cumulative sums, samples by them, and what they gain.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <string>

#include "image/pixels.h"
#include "importance/row_weights.h"
#include "jobs/tiles.h"
#include "math/direction.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "welkin/importance.h"

namespace welkin {
namespace {

using importance::Overlaps;
using importance::RowWeights;
using importance::Share;

constexpr double kPi = std::numbers::pi;
constexpr std::int64_t kTileTexels = 65536;

struct Size {
  int width;
  int height;
};

/// Calls row(index, worker) for all rows; `workers` as `jobs::run_tiles` has it.
template <class Row>
void for_each_row(Size size, jobs::Placement placement, std::size_t workers, const Control& control, const Row& row) {
  const int together = static_cast<int>(std::max<std::int64_t>(1, kTileTexels / size.width));
  jobs::run_rows(size.height, together, placement, workers, control, row);
}

void require_size(const char* name, int cells, int texels) {
  if (cells >= 0 && cells <= texels) return;
  throw Error(ErrorCode::invalid_argument, "ImportanceOptions: " + std::string(name) + " is " + std::to_string(cells) +
                                               "; it must be from 1 to the source's " + std::to_string(texels) +
                                               ", or 0 for that");
}

void require_length(const char* name, std::size_t is, std::size_t must_be) {
  if (is == must_be) return;
  throw Error(ErrorCode::invalid_argument, "ImportanceTargets: " + std::string(name) + " has " + std::to_string(is) +
                                               " floats; it must have " + std::to_string(must_be));
}

Size size_of(const LatLongView& source, const ImportanceOptions& options) {
  image::check_view(source);
  projection::check_policy(options.pixels);
  require_size("width", options.width, source.width);
  require_size("height", options.height, source.height);
  if (options.weight != ImportanceWeight::luminance && options.weight != ImportanceWeight::mean &&
      options.weight != ImportanceWeight::largest) {
    throw Error(ErrorCode::invalid_argument,
                "ImportanceOptions: weight has no known value; pass luminance, mean or largest");
  }
  return {options.width > 0 ? options.width : source.width, options.height > 0 ? options.height : source.height};
}

/// In four sums side by side: a single one would wait for itself at each value.
template <class Value>
double sum_of(std::span<const Value> values) noexcept {
  double sums[4] = {};
  std::size_t k = 0;
  for (; k + 4 <= values.size(); k += 4) {
    for (std::size_t i = 0; i < 4; ++i) sums[i] += static_cast<double>(values[k + i]);
  }
  for (std::size_t i = 0; k + i < values.size(); ++i) sums[i] += static_cast<double>(values[k + i]);
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/// cdf[k] = the share of what comes before k; even where there is nothing. Returns the sum.
template <class Value>
double accumulate(std::span<const Value> values, std::span<float> cdf) noexcept {
  const double total = sum_of(values);
  const std::size_t count = values.size();
  cdf[0] = 0.0F;
  if (!(total > 0.0)) {
    for (std::size_t k = 1; k <= count; ++k) {
      cdf[k] = static_cast<float>(static_cast<double>(k) / static_cast<double>(count));
    }
    return total;
  }
  const double scale = 1.0 / total;
  const auto share = [&](double sum) { return static_cast<float>(std::min(1.0, sum * scale)); };
  // Four at a time, each from the sum before the four: it never falls, as a sum of more is not rounded to less.
  double before = 0.0;
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      sum += static_cast<double>(values[k + i]);
      cdf[k + i + 1] = share(before + sum);
    }
    before += sum;
  }
  for (; k < count; ++k) {
    before += static_cast<double>(values[k]);
    cdf[k + 1] = share(before);
  }
  // The rounding remainder goes to the last value above 0, not to the zeros after it.
  while (k > 0 && !(values[k - 1] > Value{0})) --k;
  std::fill(cdf.begin() + static_cast<std::ptrdiff_t>(k), cdf.end(), 1.0F);
  return total;
}

/// Fills the arrays of a table.
class Builder {
 public:
  Builder(const LatLongView& source, Size size, const ImportanceOptions& options, const ImportanceTargets& targets)
      : source_(source),
        size_(size),
        options_(options),
        targets_(targets),
        weights_(source, options.weight, options.pixels),
        columns_(Overlaps::of_columns(source.width, size.width)),
        rows_(Overlaps::of_rows(source.height, size.height)),
        totals_(static_cast<std::size_t>(size.height)) {}

  double build(const Control& control) {
    const bool again = options_.mis_compensation;
    integrate(!again, jobs::part_of(control, 0.0, again ? 0.6 : 1.0));
    double integral = total();
    if (again && integral > 0.0) {
      const double mean = integral / (4.0 * kPi);
      each_row(jobs::part_of(control, 0.6, 1.0), [&](int row) { compensate(row, mean); });
      // An even environment has nothing above its mean: all of it counts again.
      if (total() > 0.0) {
        integral = total();
      } else {
        integrate(true, {});
      }
    }
    if (!(integral > 0.0)) {
      each_row({}, [&](int row) { spread_evenly(row); });
      integral = total();
    }
    return accumulate<double>(totals_, targets_.row_cdf);
  }

 private:
  /// Scratch memory of one thread.
  struct Scratch : RowWeights::Scratch {
    Scratch(const LatLongView& source, Size size)
        : RowWeights::Scratch(source), sums(static_cast<std::size_t>(size.width)) {}
    std::vector<double> sums;  ///< of a row of the table
  };

  [[nodiscard]] std::span<float> function_of(int row) const {
    const auto width = static_cast<std::size_t>(size_.width);
    return targets_.function.subspan(static_cast<std::size_t>(row) * width, width);
  }
  [[nodiscard]] std::span<float> cdf_of(int row) const {
    const auto length = static_cast<std::size_t>(size_.width) + 1;
    return targets_.column_cdf.subspan(static_cast<std::size_t>(row) * length, length);
  }

  template <class Row>
  void each_row(const Control& control, const Row& row) const {
    const jobs::Placement placement = jobs::placement_for(std::int64_t{size_.width} * size_.height);
    for_each_row(size_, placement, jobs::worker_count(placement), control, [&](int index, std::size_t) { row(index); });
  }

  [[nodiscard]] double total() const noexcept {
    double sum = 0.0;
    for (const double row : totals_) sum += row;
    return sum;
  }

  /// The integral of the weight over each texel of the table; with `finish` the distributions of rows, too.
  void integrate(bool finish, const Control& control) {
    const jobs::Placement placement = jobs::placement_for(std::int64_t{source_.width} * source_.height);
    const std::size_t workers = jobs::worker_count(placement);
    std::vector<Scratch> scratch(workers, Scratch(source_, size_));
    for_each_row(size_, placement, workers, control, [&](int row, std::size_t worker) {
      integrate_row(row, scratch[worker]);
      if (finish) {
        finish_row(row);
      } else {
        totals_[static_cast<std::size_t>(row)] = sum_of<float>(function_of(row));
      }
    });
    importance::throw_if_rejected(scratch);
  }

  void integrate_row(int row, Scratch& scratch) {
    std::vector<double>& sums = scratch.sums;
    std::fill(sums.begin(), sums.end(), 0.0);
    const double column_width = 2.0 * kPi / source_.width;
    for (const Share& share : rows_.of(row)) {
      const std::span<const float> weights = weights_.read(share.texel, scratch);
      const double scale = share.part * column_width;
      if (columns_.one_to_one()) {
        for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += static_cast<double>(weights[k]) * scale;
        continue;
      }
      for (std::size_t k = 0; k < sums.size(); ++k) {
        double sum = 0.0;
        for (const Share& column : columns_.of(static_cast<int>(k))) {
          sum += static_cast<double>(weights[static_cast<std::size_t>(column.texel)]) * column.part;
        }
        // The weight is constant in a source texel: its integral over a table's texel is the sum of weight times the
        // part of longitude times the part of height.
        sums[k] += sum * scale;
      }
    }
    const std::span<float> function = function_of(row);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      function[k] = static_cast<float>(std::min(sums[k], 3.402823466e38));
    }
  }

  void finish_row(int row) {
    totals_[static_cast<std::size_t>(row)] = accumulate<float>(function_of(row), cdf_of(row));
  }

  void compensate(int row, double mean) {
    const double even = mean * importance::texel_solid_angle(size_.width, size_.height, row);
    for (float& value : function_of(row)) {
      // max(0, f - mean) over the sphere, integrated over the texel: f's integral less mean times solid angle.
      // The factor 1 + 1e-6 makes images that are uniform to within rounding exactly 0.
      value = static_cast<float>(std::max(0.0, static_cast<double>(value) - even * (1.0 + 1e-6)));
    }
    finish_row(row);
  }

  void spread_evenly(int row) {
    const std::span<float> function = function_of(row);
    std::fill(function.begin(), function.end(),
              static_cast<float>(importance::texel_solid_angle(size_.width, size_.height, row)));
    finish_row(row);
  }

  const LatLongView& source_;
  Size size_;
  const ImportanceOptions& options_;
  const ImportanceTargets& targets_;
  RowWeights weights_;
  Overlaps columns_;
  Overlaps rows_;
  std::vector<double> totals_;  ///< of the rows' functions
};

/// Which step of a cumulative distribution a number falls into, and how far.
struct Step {
  std::size_t index;
  double within;  ///< 0 to 1
};

Step step_of(std::span<const float> cdf, double number) noexcept {
  // The inverse of the cumulative distribution: the first step whose end is above the number. Steps of height 0 end at
  // their beginning and are never the first. Numbers stay below 1, the end of the last step that rises.
  const double inside = number > 0.0 ? std::min(number, 1.0 - 0x1p-53) : 0.0;  // NaN: 0
  const auto above =
      std::upper_bound(cdf.begin(), cdf.end(), inside, [](double a, float b) { return a < static_cast<double>(b); });
  const auto index =
      std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - cdf.begin(), 1)), cdf.size() - 1) - 1;
  const auto from = static_cast<double>(cdf[index]);
  const double height = static_cast<double>(cdf[index + 1]) - from;
  return {index, std::min((inside - from) / height, 1.0 - 0x1p-53)};
}

std::span<const float> cdf_of(const ImportanceTable& table, std::size_t row) noexcept {
  const auto length = static_cast<std::size_t>(table.width) + 1;
  return std::span(table.column_cdf).subspan(row * length, length);
}

/// Uses the function, not the steps of the cumulative distributions: rounding moves the steps of dim texels next to a
/// bright one, so that some are picked more often than the function says and others never, with the right total.
double density_of(const ImportanceTable& table, std::size_t row, std::size_t column) noexcept {
  // Per steradian: the texel's probability over its solid angle, as directions are even within it.
  const double probability =
      static_cast<double>(table.function[row * static_cast<std::size_t>(table.width) + column]) / table.integral;
  return probability / importance::texel_solid_angle(table.width, table.height, static_cast<int>(row));
}

}  // namespace

ImportanceTable importance_table(const LatLongView& source, const ImportanceOptions& options, const Control& control) {
  const Size size = size_of(source, options);
  ImportanceTable table{size.width, size.height, {}, {}, {}, 0.0};
  const auto width = static_cast<std::size_t>(size.width);
  const auto height = static_cast<std::size_t>(size.height);
  table.function.resize(width * height);
  table.row_cdf.resize(height + 1);
  table.column_cdf.resize(height * (width + 1));
  table.integral = importance_table(source, {table.function, table.row_cdf, table.column_cdf}, options, control);
  return table;
}

double importance_table(const LatLongView& source, const ImportanceTargets& targets, const ImportanceOptions& options,
                        const Control& control) {
  const platform::FloatingPointScope floating_point;
  const Size size = size_of(source, options);
  const auto width = static_cast<std::size_t>(size.width);
  const auto height = static_cast<std::size_t>(size.height);
  require_length("function", targets.function.size(), width * height);
  require_length("row_cdf", targets.row_cdf.size(), height + 1);
  require_length("column_cdf", targets.column_cdf.size(), height * (width + 1));
  return Builder(source, size, options, targets).build(control);
}

// Within a texel longitude and height, minus the cosine of the polar angle, are even: so is solid angle.
ImportanceSample ImportanceTable::sample(double across, double down) const {
  const platform::FloatingPointScope floating_point;
  importance::check_table(*this);
  const Step row = step_of(row_cdf, down);
  const Step column = step_of(cdf_of(*this, row.index), across);
  const double top = importance::height_of_edge(static_cast<int>(row.index), height);
  const double bottom = importance::height_of_edge(static_cast<int>(row.index) + 1, height);
  // Uniform in height, so uniform in area (Archimedes).
  const double y = -(top + row.within * (bottom - top));
  // The longitude is pi at the left edge and falls to -pi.
  const double turns = 0.5 - (static_cast<double>(column.index) + column.within) / width;
  const math::SineCosine longitude = math::sine_cosine_of_turns(turns);
  const double ring = std::sqrt(std::max(0.0, (1.0 - y) * (1.0 + y)));
  return {{ring * longitude.sine, y, ring * longitude.cosine},
          density_of(*this, row.index, column.index),
          static_cast<int>(column.index),
          static_cast<int>(row.index)};
}

double ImportanceTable::density(const dvec3& direction) const {
  const platform::FloatingPointScope floating_point;
  importance::check_table(*this);
  const dvec3 unit = math::as_unit_direction(direction, "direction");
  const auto cell = [](double position, int cells) {
    return std::min(static_cast<std::size_t>(std::max(position, 0.0)), static_cast<std::size_t>(cells) - 1);
  };
  const std::size_t column = cell((0.5 - math::turns_of(unit.x, unit.z)) * width, width);
  const double ring = std::sqrt(unit.x * unit.x + unit.z * unit.z);
  // The angle of (y, ring) is the polar angle, from 0 to 180 degrees.
  const std::size_t row = cell(2.0 * math::turns_of(ring, unit.y) * height, height);
  return density_of(*this, row, column);
}

// The gain of a table, as sums over the source's texels.

namespace {

/// A row's part of integrals over the sphere.
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
