// Probabilities of ever larger blocks.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "importance/row_weights.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "welkin/importance.h"

namespace welkin {
namespace {

using Level = ImportancePyramid::Level;

void for_each_row(const Level& level, const Control& control, const std::function<void(int)>& row) {
  const jobs::Placement placement = jobs::placement_for(std::int64_t{level.width} * level.height);
  constexpr int kRows = 16;
  jobs::run_rows(level.height, kRows, placement, jobs::worker_count(placement), control,
                 [&](int k, std::size_t) { row(k); });
}

Level empty_level(int width, int height) {
  return {width, height, std::vector<float>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
}

Level half_of(const Level& finer, const Control& control) {
  Level level = empty_level((finer.width + 1) / 2, (finer.height + 1) / 2);
  const auto value = [&](int column, int row) {
    if (column >= finer.width || row >= finer.height) return 0.0;
    return static_cast<double>(
        finer.probabilities[static_cast<std::size_t>(row) * static_cast<std::size_t>(finer.width) +
                            static_cast<std::size_t>(column)]);
  };
  for_each_row(level, control, [&](int row) {
    float* const to = level.probabilities.data() + std::ptrdiff_t{row} * level.width;
    for (int k = 0; k < level.width; ++k) {
      // A block's probability is that of its four parts, so a sample descends from the last level with one choice among
      // four at each. Cells beyond an odd edge have 0. The sum's order is fixed: rows first.
      const double upper = value(2 * k, 2 * row) + value(2 * k + 1, 2 * row);
      to[k] = static_cast<float>(upper + (value(2 * k, 2 * row + 1) + value(2 * k + 1, 2 * row + 1)));
    }
  });
  return level;
}

}  // namespace

ImportancePyramid importance_pyramid(const ImportanceTable& table, const Control& control) {
  const platform::FloatingPointScope floating_point;
  importance::check_table(table);
  ImportancePyramid pyramid;
  Level level = empty_level(table.width, table.height);
  for_each_row(level, jobs::part_of(control, 0.0, 0.6), [&](int row) {
    const std::ptrdiff_t first = std::ptrdiff_t{row} * table.width;
    for (std::ptrdiff_t k = first; k < first + table.width; ++k) {
      const auto at = static_cast<std::size_t>(k);
      level.probabilities[at] = static_cast<float>(static_cast<double>(table.function[at]) / table.integral);
    }
  });
  pyramid.levels.push_back(std::move(level));
  const Control rest = jobs::part_of(control, 0.6, 1.0);
  while (pyramid.levels.back().width > 1 || pyramid.levels.back().height > 1) {
    pyramid.levels.push_back(half_of(pyramid.levels.back(), rest));
  }
  return pyramid;
}

}  // namespace welkin
