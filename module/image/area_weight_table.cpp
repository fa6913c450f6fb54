#include "image/area_weight_table.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "math/table_cache.h"

namespace welkin::image {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{64} << 20U;
constexpr std::size_t kLargestTableBytes = std::size_t{48} << 20U;
constexpr double kPi = std::numbers::pi;

math::TableCache<TileWeightKey, TileWeightTable>& cache() {
  static auto& tables = *new math::TableCache<TileWeightKey, TileWeightTable>(kCacheBytes);  // never destroyed
  return tables;
}

}  // namespace

std::shared_ptr<const TileWeightTable> TileWeightTable::find(const TileWeightKey& key) { return cache().find(key); }

void TileWeightTable::keep(const TileWeightKey& key, const std::shared_ptr<const TileWeightTable>& table) {
  (void)cache().get(key, [&] { return table; });
}

TileWeightTable::TileWeightTable(const TileWeightKey& key)
    : weights_(key.width, key.height, key.size, true),
      rests_(key.width % 4 == 0   ? 1
             : key.width % 2 == 0 ? 3
                                  : 4) {
  const auto rests = static_cast<std::size_t>(rests_);
  std::size_t floats = 0;
  std::size_t indices = 0;
  for (const bool polar : {false, true}) {
    for (int row = 0; row < weights_.lines(); ++row) {
      const TileKind kind = weights_.kind_of(polar, row);
      const std::size_t room = kind == TileKind::pole ? 0 : floats_for(kind, row);
      lines_.push_back({floats, indices, room, false, {}});
      floats += room * rests;
      indices += 2 * rests * static_cast<std::size_t>(weights_.tiles_of(kind, row));
      if ((floats + indices) * sizeof(float) > kLargestTableBytes) {
        lines_.clear();
        return;
      }
    }
  }
  floats_ = platform::AlignedBuffer<float>(floats);
  indices_ = platform::AlignedBuffer<std::int32_t>(indices);
}

/// Room for a line's weights. An estimate from above: a line that needs more is weighed anew each time.
std::size_t TileWeightTable::floats_for(TileKind kind, int row) const noexcept {
  // A texel is at most 2 / size radians high, and begins and ends within ramps.
  const int height = static_cast<int>(std::ceil(2.0 / weights_.size() * weights_.height() / kPi)) + 2;
  const auto tiles = static_cast<std::size_t>(weights_.tiles_of(kind, row));
  if (kind == TileKind::side && row > 0) return tiles * static_cast<std::size_t>(height);
  // On +Y, 1 / row radians wide; at the border between faces, 2 / size.
  const double radians = kind == TileKind::side ? 2.0 / weights_.size() : std::min(0.5 * kPi, 1.0 / std::max(row, 1));
  const int width = static_cast<int>(std::ceil(radians * weights_.width() / (2.0 * kPi))) + 2;
  return tiles * static_cast<std::size_t>(height + 1) * static_cast<std::size_t>((width + 3) / 4 * 4);
}

std::size_t TileWeightTable::bytes() const noexcept {
  return floats_.bytes() + indices_.bytes() + lines_.size() * sizeof(Line) + sizeof(*this);
}

bool TileWeightTable::complete() const noexcept {
  return !lines_.empty() && std::all_of(lines_.begin(), lines_.end(), [](const Line& line) { return line.kept; });
}

/// Copies what goes by.
class TileWeightTable::Filler final : public RunSink {
 public:
  Filler(TileWeightTable& table, Line& line, std::size_t tiles, RunSink& next)
      : table_(table), line_(line), tiles_(tiles), next_(next) {
    line.kept = true;
  }

  void take(const WeighedRun& run) override {
    const PatchRun& patches = run.patches;
    const bool product = patches.row_weights != nullptr;
    const auto patch = static_cast<std::size_t>(patches.patch_rows * (product ? 1 : 4 * patches.patch_groups));
    if (tiles_ * patch > line_.floats || run.rest >= table_.rests_) {
      line_.kept = false;
    } else {
      const auto rest = static_cast<std::size_t>(run.rest);
      const auto first = static_cast<std::size_t>(run.first);
      const auto count = static_cast<std::size_t>(patches.count);
      line_.patches[rest] = {patches.patch_rows, patches.patch_groups};
      std::copy_n(product ? patches.row_weights : patches.weights, patch * count,
                  table_.floats_.data() + line_.first_float + rest * line_.floats + first * patch);
      std::int32_t* const indices = table_.indices_.data() + line_.first_index + 2 * rest * tiles_ + first;
      std::copy_n(patches.rows, count, indices);
      std::copy_n(patches.columns, count, indices + tiles_);
    }
    next_.take(run);
  }

 private:
  TileWeightTable& table_;
  Line& line_;
  std::size_t tiles_;
  RunSink& next_;
};

void TileWeightTable::fill(bool polar, int row, TileScratch& scratch, RunSink& sink) {
  const TileKind kind = weights_.kind_of(polar, row);
  if (lines_.empty()) return weights_.weigh(kind, row, scratch, sink);
  Filler filler(*this, lines_[line_index(polar, row)], static_cast<std::size_t>(weights_.tiles_of(kind, row)), sink);
  weights_.weigh(kind, row, scratch, filler);
}

void TileWeightTable::read(bool polar, int row, TileScratch* scratch, RunSink& sink) const {
  const TileKind kind = weights_.kind_of(polar, row);
  if (lines_.empty() || !lines_[line_index(polar, row)].kept) return weights_.weigh(kind, row, *scratch, sink);
  const Line& line = lines_[line_index(polar, row)];
  const int tiles = weights_.tiles_of(kind, row);
  WeighedRun run{kind, polar ? row : weights_.lines() - 1 - row, 0, 0, {}, nullptr};
  for (run.rest = 0; run.rest < rests_; ++run.rest) {
    const auto rest = static_cast<std::size_t>(run.rest);
    if (line.patches[rest].rows == 0) continue;
    const float* const weights = floats_.data() + line.first_float + rest * line.floats;
    const std::int32_t* const indices = indices_.data() + line.first_index + 2 * rest * static_cast<std::size_t>(tiles);
    const bool product = kind == TileKind::side && row > 0;
    run.patches.count = tiles;
    run.patches.patch_rows = line.patches[rest].rows;
    run.patches.patch_groups = line.patches[rest].groups;
    run.patches.rows = indices;
    run.patches.columns = indices + tiles;
    run.patches.weights = product ? weights_.side_columns(run.rest).weights.data() : weights;
    run.patches.row_weights = product ? weights : nullptr;
    sink.take(run);
  }
}

}  // namespace welkin::image
