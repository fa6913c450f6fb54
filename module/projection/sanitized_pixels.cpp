#include "projection/sanitized_pixels.h"

#include <algorithm>
#include <cstdint>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "projection/projection_kernels.h"
#include "projection/sanitizer.h"

namespace welkin::projection {
namespace {

constexpr std::size_t kRowsPerTile = 16;

std::size_t tiles_of(std::size_t rows) { return (rows + kRowsPerTile - 1) / kRowsPerTile; }

/// Calls `work(row)` for all rows, tile by tile.
template <class Work>
void for_rows(std::size_t rows, int columns, const Control& control, const Work& work) {
  const auto placement = jobs::placement_for(static_cast<std::int64_t>(rows) * columns);
  jobs::run_tiles(tiles_of(rows), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t /*worker*/) {
                    const std::size_t end = std::min(rows, (tile + 1) * kRowsPerTile);
                    for (std::size_t row = tile * kRowsPerTile; row < end; ++row) work(tile, row);
                  });
}

}  // namespace

SanitizedSource::SanitizedSource(const EnvironmentView& view, const PixelPolicy& policy, const Control& control)
    : cubemap_(view.kind() == EnvironmentKind::cubemap) {
  std::vector<const void*> rows;
  if (!cubemap_) {
    lat_long_ = view.lat_long();
    columns_ = lat_long_.width;
    rows.reserve(static_cast<std::size_t>(lat_long_.height));
    for (int row = 0; row < lat_long_.height; ++row) rows.push_back(image::row_of(lat_long_, row));
    read(lat_long_.format, rows, policy, control);
    if (copy_.size() > 0) lat_long_ = {copy_.data(), columns_, lat_long_.height, 0, PixelFormat::rgb32f};
    return;
  }
  cube_ = view.cubemap();
  columns_ = cube_.size;
  rows.reserve(std::size_t{6} * static_cast<std::size_t>(columns_));
  for (int row = 0; row < 6 * columns_; ++row) rows.push_back(image::row_of(cube_, row / columns_, row % columns_));
  read(cube_.format, rows, policy, control);
  if (copy_.size() == 0) return;
  cube_ = {{}, columns_, 0, PixelFormat::rgb32f};
  for (std::size_t face = 0; face < 6; ++face) cube_.faces[face] = row(static_cast<int>(face) * columns_);
}

void SanitizedSource::read(PixelFormat format, const std::vector<const void*>& rows, const PixelPolicy& policy,
                           const Control& control) {
  ranges_.resize(rows.size());
  first_texels_.resize(rows.size());
  diagnostics_.texels = static_cast<std::uint64_t>(rows.size()) * static_cast<std::uint64_t>(columns_);
  bool usable = false;
  if (format == PixelFormat::rgb32f && !policy.gamma) {
    for (std::size_t row = 0; row < rows.size(); ++row) first_texels_[row] = static_cast<const float*>(rows[row]);
    usable = measure(policy, jobs::part_of(control, 0.0, 0.5));
  }
  if (!usable) {
    copy(format, rows, policy, jobs::part_of(control, 0.5, 1.0));
  }
  has_negatives_ = std::any_of(ranges_.begin(), ranges_.end(), [](const RowRange& r) { return r.least < 0.0F; });
}

bool SanitizedSource::measure(std::size_t row, const Sanitizer& sanitizer) {
  const RowMeasure found = projection_kernels().measure_row(first_texels_[row], 3 * columns_);
  ranges_[row] = {found.least, found.largest, static_cast<double>(found.sum) / (3.0 * columns_)};
  return found.finite && found.least >= sanitizer.low() && found.largest <= sanitizer.high();
}

bool SanitizedSource::measure(const PixelPolicy& policy, const Control& control) {
  const Sanitizer sanitizer(policy);
  std::vector<char> dirty(tiles_of(ranges_.size()), 0);
  for_rows(ranges_.size(), columns_, control, [&](std::size_t tile, std::size_t row) {
    if (!measure(row, sanitizer)) dirty[tile] = 1;
  });
  return std::find(dirty.begin(), dirty.end(), 1) == dirty.end();
}

void SanitizedSource::copy(PixelFormat format, const std::vector<const void*>& rows, const PixelPolicy& policy,
                           const Control& control) {
  const Sanitizer sanitizer(policy);
  const auto row_values = static_cast<std::size_t>(3 * columns_);
  copy_ = platform::AlignedBuffer<float>(rows.size() * row_values);
  std::vector<char> suspects(rows.size());
  for_rows(rows.size(), columns_, jobs::part_of(control, 0.0, 0.7), [&](std::size_t /*tile*/, std::size_t row) {
    float* const rgb = copy_.data() + row * row_values;
    image::decode_texels(format, rows[row], columns_, rgb);
    first_texels_[row] = rgb;
    suspects[row] = measure(row, sanitizer) && !policy.gamma ? 0 : 1;
  });
  if (std::find(suspects.begin(), suspects.end(), 1) == suspects.end()) return;
  sanitize(suspects, sanitizer, jobs::part_of(control, 0.7, 1.0));
}

namespace {

/// Returns the solid angles of texels as the sanitizer takes them: of a cubemap's face, or of each row of a lat-long.
std::vector<float> texel_angles(bool cubemap, int columns, int rows) {
  std::vector<double> of_row(static_cast<std::size_t>(columns));
  std::vector<float> angles;
  angles.reserve(cubemap ? of_row.size() * of_row.size() : static_cast<std::size_t>(rows));
  for (int row = 0; row < (cubemap ? columns : rows); ++row) {
    if (cubemap) {
      image::cubemap_row_solid_angles(row, of_row);
      for (const double angle : of_row) angles.push_back(static_cast<float>(angle));
    } else {
      angles.push_back(static_cast<float>(image::lat_long_texel_solid_angle(columns, rows, row)));
    }
  }
  return angles;
}

}  // namespace

void SanitizedSource::sanitize(const std::vector<char>& suspects, const Sanitizer& sanitizer, const Control& control) {
  const std::size_t rows = suspects.size();
  const auto columns = static_cast<std::size_t>(columns_);
  const std::vector<float> angles = texel_angles(cubemap_, columns_, static_cast<int>(rows));
  std::vector<SanitizeRecord> records(tiles_of(rows));
  for_rows(rows, columns_, control, [&](std::size_t tile, std::size_t row) {
    if (suspects[row] == 0) return;
    sanitizer.sanitize({.rgb = copy_.data() + row * 3 * columns,
                        .count = columns_,
                        .face = cubemap_ ? static_cast<int>(row) / columns_ : 0,
                        .row = cubemap_ ? static_cast<int>(row) % columns_ : static_cast<int>(row),
                        .weights = angles.data() + (cubemap_ ? row % columns * columns : row),
                        .weight_step = cubemap_ ? 1 : 0},
                       records[tile]);
    measure(row, sanitizer);
  });
  SanitizeRecord record;
  for (const SanitizeRecord& one : records) record.add(one);
  throw_if_rejected(record, cubemap_);
  diagnostics_.nans_replaced = record.nans;
  diagnostics_.infinities_replaced = record.infinities;
  diagnostics_.negatives_replaced = record.negatives;
  diagnostics_.texels_clamped = record.clamped;
  clamped_radiance_ = record.radiance_removed;
}

}  // namespace welkin::projection
