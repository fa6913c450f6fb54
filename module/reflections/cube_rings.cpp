#include "reflections/cube_rings.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/table_cache.h"
#include "reflections/source_rows.h"

namespace welkin::reflections {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{192} << 20U;

/// About a table's weights: each texel of a sixteenth reaches the rings that it covers and those next to them. A face
/// is 90 degrees high, rows / 2 rings, and a ring's texels are as wide as it is high.
double about_taps(const RingTableKey& key) noexcept {
  const double rings = 0.5 * key.rows / key.face_size;
  return 6.0 / kRingImages * key.face_size * key.face_size * (kSpread + rings) * (kSpread + rings);
}

/// [image][k]: the image by which a texel has there what its image `image` has at image k.
///
/// With G_k the symmetries, a texel t's record has L(G_k t). A texel whose window reaches into another sixteenth is
/// seen there by its own image t' = G_i^-1 t, whose record has L(G_k t') = L(G_k G_i^-1 t), an entry of t's own
/// record. The point (1, 2, 4) is moved to a different position by each, so it identifies G_k G_i^-1.
std::array<std::array<std::size_t, kRingImages>, kRingImages> composed_images() {
  const glm::ivec3 point{1, 2, 4};
  std::array<std::array<std::size_t, kRingImages>, kRingImages> composed{};
  for (int image = 0; image < kRingImages; ++image) {
    const glm::ivec3 there = moved_back(image::cube_image_of(image), point);
    for (int k = 0; k < kRingImages; ++k) {
      int found = 0;
      while (moved(image::cube_image_of(found), point) != moved(image::cube_image_of(k), there)) ++found;
      composed[static_cast<std::size_t>(image)][static_cast<std::size_t>(k)] = static_cast<std::size_t>(found);
    }
  }
  return composed;
}

/// Counts to where each texel's taps begin, and the end of the last one's.
void add_up(std::vector<std::uint32_t>& counts) {
  std::uint32_t sum = 0;
  for (std::uint32_t& count : counts) {
    const std::uint32_t start = sum;
    sum += count;
    count = start;
  }
}

}  // namespace

RingTable::RingTable(const RingTableKey& key, const Control& control, std::size_t largest)
    : key_(key), weights_(key.face_size, key.rows) {
  if (about_taps(key) * sizeof(RingTap) > static_cast<double>(largest)) return;
  constexpr auto arena = jobs::Placement::arena;
  bands_.resize(static_cast<std::size_t>(weights_.bands()));
  jobs::run_tiles(bands_.size(), arena, jobs::worker_count(arena), {control.stop, {}},
                  [&](std::size_t band, std::size_t) { bands_[band] = weigh(static_cast<int>(band)); });
}

RingTable::Band RingTable::weigh(int band) const {
  const int rings = weights_.first_ring(band + 1) - weights_.first_ring(band);
  Band made;
  made.ends.resize(static_cast<std::size_t>(rings) * static_cast<std::size_t>(key_.rows / 4) + 1);
  weights_.count(band, made.ends.data());
  add_up(made.ends);
  made.taps = platform::AlignedBuffer<RingTap>(made.ends.back());
  std::vector<std::uint32_t> next = made.ends;
  weights_.weigh(band, next.data(), made.taps.data());
  return made;
}

std::shared_ptr<const RingTable> RingTable::get(const RingTableKey& key, const Control& control) {
  static auto& cache = *new math::TableCache<RingTableKey, RingTable>(kCacheBytes);  // never destroyed
  return cache.get(key, [&] { return std::make_shared<const RingTable>(key, control); });
}

std::size_t RingTable::bytes() const noexcept {
  std::size_t sum = sizeof(*this) + weights_.bytes();
  for (const Band& band : bands_) sum += band.ends.size() * sizeof(std::uint32_t) + band.taps.bytes();
  return sum;
}

std::size_t RingTable::working_bytes(const RingTableKey& key) noexcept {
  // A margin of some texels all around the sixteenth is read too.
  const auto half = static_cast<std::size_t>(key.face_size) / 2 + 2 * kSpread;
  return 2 * half * half * kRecordFloats * sizeof(float);
}

std::size_t RingTable::making_bytes(const RingTableKey& key) {
  // Columns crowd at the poles: there a texel reaches more of them than elsewhere.
  const double rings = 0.5 * key.rows / key.face_size;
  const double taps = 1.06 * (1.0 + 0.7 * rings / (kSpread + rings)) * about_taps(key);
  const auto cells = static_cast<std::size_t>(key.rows / 2) * static_cast<std::size_t>(key.rows / 4);
  return static_cast<std::size_t>(taps * sizeof(RingTap)) + 2 * cells * sizeof(std::uint32_t) +
         RingWeights::making_bytes(key.face_size, key.rows, jobs::worker_count(jobs::Placement::arena));
}

void RingTable::gather(const std::vector<const float*>& faces, const RingWeights::TexelRow& row, float* records) const {
  const int size = key_.face_size;
  for (int k = 0; k < kRingImages; ++k) {
    const image::CubeImage image = image::cube_image_of(k);
    const auto source_texel = [&](int column) {
      return image::texel_at(size, moved(image, row.first + glm::ivec3(2 * column, 0, 0)));
    };
    const image::CubeTexel from = source_texel(0);
    const image::CubeTexel next = source_texel(row.count > 1 ? 1 : 0);
    const RecordCopy copy{faces.data(), from.face * size + from.row, next.row - from.row,
                          from.column,  next.column - from.column,   row.count,
                          size};
    copy.to(records + static_cast<std::size_t>(row.record) * kRecordFloats, k);
  }
}

void RingTable::sum(const RingRun& run, int ring, float* rgb) const {
  const int columns = 2 * key_.rows;
  RingLayout layout{};
  for (int k = 0; k < kRingImages; ++k) {
    const image::CubeImage image = image::cube_image_of(k);
    const std::ptrdiff_t line = image.below ? key_.rows - 1 - ring : ring;
    // the first of the sixteenth's columns in the image: mirrored ones go back from the line where it begins
    const int column = (image.quarter * (columns / 4) + (image.mirrored ? columns - 1 : 0)) % columns;
    layout.to[k] = rgb + 3 * (line * columns + column);
    layout.step[k] = image.mirrored ? -3 : 3;
  }
  ring_kernels().sum_ring_taps(run, layout);
}

void RingTable::fill(const std::vector<const float*>& faces, float* rgb, const Control& control) const {
  constexpr int kTileRows = 4;
  constexpr int kTileTexels = 2048;
  const std::vector<RingWeights::TexelRow>& rows = weights_.rows();
  const std::size_t texels = rows.back().record + static_cast<std::size_t>(rows.back().count);
  platform::AlignedBuffer<float> records(weights_.record_count() * kRecordFloats);
  const auto placement = jobs::placement_for(std::int64_t{2} * key_.rows * key_.rows);
  const std::size_t workers = jobs::worker_count(placement);
  jobs::run_rows(static_cast<int>(rows.size()), kTileRows, placement, workers, jobs::part_of(control, 0.0, 0.2),
                 [&](int row, std::size_t) { gather(faces, rows[static_cast<std::size_t>(row)], records.data()); });
  static const auto composed = composed_images();
  float* to = records.data() + texels * kRecordFloats;
  for (const RingWeights::ImageRecord& image : weights_.images()) {
    const float* const from = records.data() + std::size_t{image.record} * kRecordFloats;
    for (const std::size_t k : composed[static_cast<std::size_t>(image.image)]) to = std::copy_n(from + 3 * k, 3, to);
  }
  const int width = key_.rows / 4;
  const int parts = bands_.empty() ? 1 : std::max(1, weights_.first_ring(1) * width / kTileTexels);
  jobs::run_tiles(
      static_cast<std::size_t>(weights_.bands() * parts), placement, workers, jobs::part_of(control, 0.2, 1.0),
      [&](std::size_t tile, std::size_t) {
        const int band = static_cast<int>(tile) / parts;
        const int part = static_cast<int>(tile) % parts;
        const Band made = bands_.empty() ? weigh(band) : Band();
        const Band& used = bands_.empty() ? made : bands_[static_cast<std::size_t>(band)];
        const int first = weights_.first_ring(band);
        const int rings = weights_.first_ring(band + 1) - first;
        for (int k = rings * part / parts; k < rings * (part + 1) / parts; ++k)
          sum({records.data(), used.taps.data(), used.ends.data() + std::ptrdiff_t{width} * k, width}, first + k, rgb);
      });
}

Rings rings_of_cubemap(const std::vector<const float*>& faces, int rows, const Control& control) {
  const std::size_t floats = std::size_t{6} * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows);
  Rings rings{{}, platform::AlignedBuffer<float>(floats)};
  rings.view = transforms::ImageRows(LatLongView{rings.owned.data(), 2 * rows, rows});
  const auto table = RingTable::get({static_cast<int>(faces.size() / 6), rows}, {control.stop});
  table->fill(faces, rings.owned.data(), control);
  return rings;
}

SourceRows rows_without(const std::vector<BrightTexel>& bright, const projection::SanitizedSource& source) {
  std::size_t changed = 0;
  for (std::size_t k = 0; k < bright.size(); ++k) changed += k == 0 || bright[k].row != bright[k - 1].row ? 1 : 0;
  const auto row_values = std::size_t{3} * static_cast<std::size_t>(source.columns());
  SourceRows rest{{}, platform::AlignedBuffer<float>(changed * row_values)};
  for (int row = 0; row < source.rows(); ++row) rest.rows.push_back(source.row(row));
  float* next = rest.owned.data();
  float* copy = nullptr;
  int row = -1;
  for (const BrightTexel& texel : bright) {  // by rows
    if (texel.row != row) {
      row = texel.row;
      copy = next;
      next = std::copy_n(source.row(row), row_values, copy);
      rest.rows[static_cast<std::size_t>(row)] = copy;
    }
    std::copy(texel.rest.begin(), texel.rest.end(), copy + std::ptrdiff_t{3} * texel.column);
  }
  return rest;
}

Rings rings_of_lat_long(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright) {
  SourceRows rest = rows_without(bright, source);
  Rings rings{transforms::ImageRows(source.lat_long()), std::move(rest.owned)};
  rings.view.rows = std::move(rest.rows);
  return rings;
}

std::size_t cube_rings_bytes(int size, int face_size, int rows) {
  const RingTableKey key{face_size, rows};
  return halved_faces_bytes(size, face_size) + RingTable::working_bytes(key) + RingTable::making_bytes(key);
}

}  // namespace welkin::reflections
