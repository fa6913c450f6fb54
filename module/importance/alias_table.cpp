// Picks in constant time.
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

}  // namespace welkin
