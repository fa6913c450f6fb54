// The only file that includes xxHash. All of it is inlined here: programs that link Welkin do not need the library.
#include "welkin/result_cache.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "cache/recipe.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "welkin/core.h"

namespace welkin {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 18U;  ///< 10 to 30 microseconds of hashing
constexpr std::size_t kFileBlockBytes = std::size_t{1} << 20U;

ContentHash of(const XXH128_hash_t& hash) noexcept { return {hash.high64, hash.low64}; }

/// A part of an image: one face, or all of a lat-long.
struct Plane {
  const std::byte* first_row;
  std::size_t row_bytes;
  std::ptrdiff_t stride_bytes;
  int rows;

  [[nodiscard]] int rows_per_block() const {
    return static_cast<int>(std::clamp<std::size_t>(kBlockBytes / row_bytes, 1, static_cast<std::size_t>(rows)));
  }
  [[nodiscard]] std::size_t blocks() const {
    return static_cast<std::size_t>((rows + rows_per_block() - 1) / rows_per_block());
  }
};

ContentHash hash_block(const Plane& plane, std::size_t block) noexcept {
  const int first = static_cast<int>(block) * plane.rows_per_block();
  const int end = std::min(first + plane.rows_per_block(), plane.rows);
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  for (int row = first; row < end; ++row) {
    XXH3_128bits_update(&state, plane.first_row + row * plane.stride_bytes, plane.row_bytes);
  }
  return of(XXH3_128bits_digest(&state));
}

/// Returns the hash of each plane, over its shape's hash (what pixels mean, without their bytes) and the hashes of its
/// blocks, in order. All planes have one shape.
std::vector<ContentHash> hash_planes(std::span<const Plane> planes, const ContentHash& shape, const Control& control) {
  const std::size_t blocks = planes.front().blocks();
  const std::size_t each = blocks + 1;
  std::vector<ContentHash> parts(planes.size() * each);
  for (std::size_t plane = 0; plane < planes.size(); ++plane) parts[plane * each] = shape;
  const std::size_t bytes = planes.size() * planes.front().row_bytes * static_cast<std::size_t>(planes.front().rows);
  // In texels of 12 bytes: a projection takes about as long for each.
  const jobs::Placement placement = jobs::placement_for(static_cast<std::int64_t>(bytes / 12));
  jobs::run_tiles(planes.size() * blocks, placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t) {
                    const std::size_t plane = tile / blocks;
                    const std::size_t block = tile % blocks;
                    parts[plane * each + 1 + block] = hash_block(planes[plane], block);
                  });
  std::vector<ContentHash> hashes;
  for (std::size_t plane = 0; plane < planes.size(); ++plane) {
    hashes.push_back(combine(std::span(parts).subspan(plane * each, each)));
  }
  return hashes;
}

Plane plane_of(const void* pixels, int width, int height, std::ptrdiff_t stride, PixelFormat format) {
  const std::size_t row_bytes = bytes_per_texel(format) * static_cast<std::size_t>(width);
  return {static_cast<const std::byte*>(pixels), row_bytes,
          stride != 0 ? stride : static_cast<std::ptrdiff_t>(row_bytes), height};
}

}  // namespace

std::string ContentHash::text() const {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint64_t half : {high, low}) {
    for (unsigned shift = 64; shift > 0; shift -= 4) text += kDigits[(half >> (shift - 4)) & 15U];
  }
  return text;
}

ContentHash hash_bytes(const void* bytes, std::size_t count) noexcept { return of(XXH3_128bits(bytes, count)); }

ContentHash combine(std::span<const ContentHash> parts) noexcept {
  static_assert(sizeof(ContentHash) == 16, "no padding may be hashed");
  return hash_bytes(parts.data(), parts.size_bytes());
}

std::array<ContentHash, 6> cache::hash_faces(const CubemapView& cubemap, const Control& control) {
  image::check_view(cubemap);
  std::array<Plane, 6> planes{};
  for (std::size_t face = 0; face < planes.size(); ++face) {
    planes[face] = plane_of(cubemap.faces[face], cubemap.size, cubemap.size, cubemap.row_stride_bytes, cubemap.format);
  }
  const std::vector<ContentHash> hashes =
      hash_planes(planes, hash_of("face", cubemap.size, cubemap.size, cubemap.format), control);
  std::array<ContentHash, 6> faces{};
  std::copy(hashes.begin(), hashes.end(), faces.begin());
  return faces;
}

ContentHash hash_pixels(const EnvironmentView& environment, const Control& control) {
  if (environment.kind() == EnvironmentKind::cubemap) return combine(cache::hash_faces(environment.cubemap(), control));
  const LatLongView lat_long = environment.lat_long();
  image::check_view(lat_long);
  const Plane plane =
      plane_of(lat_long.pixels, lat_long.width, lat_long.height, lat_long.row_stride_bytes, lat_long.format);
  const ContentHash shape = cache::hash_of("lat-long", lat_long.width, lat_long.height, lat_long.format);
  return hash_planes(std::span(&plane, 1), shape, control).front();
}

ContentHash hash_file(const std::filesystem::path& path, const Control& control) {
  const platform::FloatingPointScope floating_point;
  platform::ByteFile file(path);
  std::vector<std::byte> block(static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), kFileBlockBytes)));
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  while (file.remaining() > 0) {
    jobs::throw_if_cancelled(control);
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(file.remaining(), block.size()));
    file.read(block.data(), count);
    XXH3_128bits_update(&state, block.data(), count);
  }
  if (control.progress) control.progress(1.0);
  return of(XXH3_128bits_digest(&state));
}

}  // namespace welkin
