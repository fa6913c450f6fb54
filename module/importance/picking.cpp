// Tables by which renderers pick without searching: aliases, in constant time, and probabilities of ever larger blocks.
#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "importance/row_weights.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "welkin/importance.h"

namespace welkin {
namespace {

/// Lists of entries that hold less, and more, than their share; made once for each thread.
struct Scratch {
  explicit Scratch(std::size_t count) : shares(count) {
    poor.reserve(count);
    rich.reserve(count);
  }
  std::vector<double> shares;
  std::vector<std::uint32_t> poor;
  std::vector<std::uint32_t> rich;
};

// Vose's way: with shares scaled so that 1 is an entry's fill, an entry below 1 is filled up from one above. What
// rounding leaves over at the end is within a rounding of 1.
template <class Value>
void fill_entries(std::span<const Value> values, Scratch& scratch, AliasEntry* entries) {
  const std::size_t count = values.size();
  double total = 0.0;
  for (const Value value : values) total += static_cast<double>(value);
  scratch.poor.clear();
  scratch.rich.clear();
  for (std::size_t k = 0; k < count; ++k) {
    const double share = total > 0.0 ? static_cast<double>(values[k]) / total * static_cast<double>(count) : 1.0;
    scratch.shares[k] = share;
    entries[k] = {1.0F, static_cast<std::uint32_t>(k)};
    (share < 1.0 ? scratch.poor : scratch.rich).push_back(static_cast<std::uint32_t>(k));
  }
  // An entry is picked with the probability 1 / count, and then either itself or its alias. After filling, what k gets
  // over all entries is its share: k's own fill and what it gives to others sum to share(k), because a poor entry takes
  // 1 - share from its rich one, and a poor one is never touched again. Every round settles one entry, so the time is
  // linear (Vose 1991).
  while (!scratch.poor.empty() && !scratch.rich.empty()) {
    const std::uint32_t poor = scratch.poor.back();
    const std::uint32_t rich = scratch.rich.back();
    scratch.poor.pop_back();
    entries[poor] = {static_cast<float>(scratch.shares[poor]), rich};
    double& rest = scratch.shares[rich];
    // rest - (1 - share), in the order that loses less: both are added before 1 is taken off (Schwarz, "Darts, Dice,
    // and Coins", 2011).
    rest = (rest + scratch.shares[poor]) - 1.0;
    if (rest >= 1.0) continue;
    scratch.rich.pop_back();
    scratch.poor.push_back(rich);
  }
}

}  // namespace

AliasTable alias_table(const ImportanceTable& table, const Control& control) {
  const platform::FloatingPointScope floating_point;
  importance::check_table(table);
  const auto width = static_cast<std::size_t>(table.width);
  const auto height = static_cast<std::size_t>(table.height);
  AliasTable result{std::vector<AliasEntry>(height), std::vector<AliasEntry>(width * height)};
  std::vector<double> totals(height, 0.0);
  const jobs::Placement placement = jobs::placement_for(static_cast<std::int64_t>(width * height));
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<Scratch> scratch;
  for (std::size_t k = 0; k < workers; ++k) scratch.emplace_back(width);
  jobs::run_tiles(height, placement, workers, control, [&](std::size_t row, std::size_t worker) {
    const std::span<const float> values = std::span(table.function).subspan(row * width, width);
    for (const float value : values) totals[row] += static_cast<double>(value);
    fill_entries(values, scratch[worker], result.columns.data() + row * width);
  });
  Scratch rows(height);
  fill_entries<double>(totals, rows, result.rows.data());
  return result;
}

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
