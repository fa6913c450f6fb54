#include "projection/box_reduction.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "image/pixels.h"
#include "jobs/tiles.h"
#include "projection/sanitizer.h"

namespace welkin::projection {
namespace {

/// A row's channels as they are averaged: floats as they are, 8-bit values as 0 to 255.
void decode_row(const CubemapView& cubemap, const void* row, float* rgb) {
  if (!image::is_eight_bit(cubemap.format)) {
    image::decode_texels(cubemap.format, row, cubemap.size, rgb);
    return;
  }
  const auto* bytes = static_cast<const std::uint8_t*>(row);
  const std::size_t channels = bytes_per_texel(cubemap.format);
  for (int column = 0; column < cubemap.size; ++column, bytes += channels, rgb += 3) {
    for (int c = 0; c < 3; ++c) rgb[c] = static_cast<float>(bytes[c]);
  }
}

/// Back from an averaged channel to what the cubemap's format makes of it.
float finish_channel(float average, PixelFormat format) {
  if (!image::is_eight_bit(format)) return average;
  const auto encoded = static_cast<std::uint8_t>(static_cast<int>(average + 0.5F) & 0xFF);
  const std::uint8_t texel[3] = {encoded, encoded, encoded};
  float rgb[3];
  const bool srgb = format == PixelFormat::srgb8 || format == PixelFormat::srgba8;
  image::decode_texels(srgb ? PixelFormat::srgb8 : PixelFormat::rgb8, texel, 1, rgb);
  return rgb[0];
}

/// The policies that refuse a texel; what they would do otherwise is done to the cells.
std::optional<Sanitizer> rejecting_sanitizer(const PixelPolicy& pixels) {
  const bool rejects = pixels.nan == NonFinitePolicy::reject || pixels.infinity == NonFinitePolicy::reject ||
                       pixels.negative == NegativePolicy::reject;
  if (!rejects) return std::nullopt;
  return Sanitizer({.nan = pixels.nan, .infinity = pixels.infinity, .negative = pixels.negative});
}

/// One worker's room.
struct Scratch {
  std::vector<float> decoded;  ///< a row of the source
  std::vector<float> checked;  ///< a copy of it
  std::vector<double> sums;    ///< of a row of cells
};

/// Remembers the first texel of a decoded row that the policy rejects.
void check_row(const Sanitizer& sanitizer, int face, int row, int size, Scratch& scratch, SanitizeRecord& record) {
  scratch.checked = scratch.decoded;
  sanitizer.sanitize({.rgb = scratch.checked.data(), .count = size, .face = face, .row = row}, record);
}

/// Reduces one row of cells of one face.
void reduce_row(const CubemapView& cubemap, int target, int face, int cell_row, const std::optional<Sanitizer>& strict,
                Scratch& scratch, SanitizeRecord& record, float* cells) {
  const double ratio = static_cast<double>(cubemap.size) / target;
  const auto edge = [ratio](int cell) { return static_cast<int>(std::floor(cell * ratio)); };
  float* const decoded = scratch.decoded.data();
  double* const sums = scratch.sums.data();
  std::fill_n(sums, 3 * target, 0.0);
  for (int row = edge(cell_row); row < edge(cell_row + 1); ++row) {
    decode_row(cubemap, image::row_of(cubemap, face, row), decoded);
    if (strict) check_row(*strict, face, row, cubemap.size, scratch, record);
    for (int cell = 0; cell < target; ++cell) {
      for (int column = edge(cell); column < edge(cell + 1); ++column) {
        for (int c = 0; c < 3; ++c) sums[3 * cell + c] += static_cast<double>(decoded[3 * column + c]);
      }
    }
  }
  const double scale = 1.0 / (ratio * ratio);
  for (int k = 0; k < 3 * target; ++k) {
    cells[k] = finish_channel(static_cast<float>(sums[k] * scale), cubemap.format);
  }
}

}  // namespace

Cubemap reduce_by_box(const CubemapView& cubemap, int target, const ProjectionOptions& options,
                      const Control& control) {
  Cubemap reduced(target, 1, new_delete_resource());
  const std::int64_t texels = std::int64_t{6} * cubemap.size * cubemap.size;
  const jobs::Placement placement = jobs::placement_for(texels);
  const auto row_floats = static_cast<std::size_t>(3 * cubemap.size);
  const auto cell_floats = static_cast<std::size_t>(3 * target);
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<Scratch> scratch(
      workers, {std::vector<float>(row_floats), std::vector<float>(row_floats), std::vector<double>(cell_floats)});
  const std::optional<Sanitizer> strict = rejecting_sanitizer(options.pixels);
  const auto tiles = static_cast<std::size_t>(6 * target);
  std::vector<SanitizeRecord> records(tiles);
  jobs::run_tiles(tiles, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
    const int face = static_cast<int>(tile) / target;
    const int row = static_cast<int>(tile) % target;
    reduce_row(cubemap, target, face, row, strict, scratch[worker], records[tile],
               reduced.face(0) + tile * cell_floats);
  });
  SanitizeRecord total;
  for (const SanitizeRecord& record : records) total.add(record);
  throw_if_rejected(total, true);
  return reduced;
}

}  // namespace welkin::projection
