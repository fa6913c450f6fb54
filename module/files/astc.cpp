#include "files/astc.h"

#include <astcenc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <new>
#include <string>

#include "image/pixels.h"
#include "jobs/tiles.h"

namespace welkin::files {
namespace {

constexpr std::size_t kBlockBytes = 16;
/// In a row, of a tile: some milliseconds of work, so that a call can be cancelled soon.
constexpr int kTileBlocks = 64;
constexpr unsigned kOneThread = 1;
constexpr unsigned kThread = 0;  ///< the index of a context's only one

struct FreeContext {
  void operator()(astcenc_context* context) const noexcept { astcenc_context_free(context); }
};
using Context = std::unique_ptr<astcenc_context, FreeContext>;

/// All arguments are our own, so that what can go wrong is the memory, or a library that is not what it says.
void require_success(astcenc_error error) {
  if (error == ASTCENC_SUCCESS) return;
  if (error == ASTCENC_ERR_OUT_OF_MEM) throw std::bad_alloc();
  throw Error(ErrorCode::unsupported_file, std::string("astcenc refuses to work: ") + astcenc_get_error_string(error));
}

Context context_for(astcenc_profile profile, TexelKind kind, float quality, unsigned flags) {
  const auto edge = static_cast<unsigned>(block_edge(kind));
  astcenc_config config{};
  require_success(astcenc_config_init(profile, edge, edge, 1, quality, flags, &config));
  astcenc_context* context = nullptr;
  require_success(astcenc_context_alloc(&config, kOneThread, &context));
  return Context(context);
}

/// A picture of RGBA floats, as astcenc wants one.
class Picture {
 public:
  Picture(int width, int height)
      : values_(std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
        image_{static_cast<unsigned>(width), static_cast<unsigned>(height), 1, ASTCENC_TYPE_F32, &slice_} {}
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  [[nodiscard]] float* values() noexcept { return values_.data(); }
  [[nodiscard]] astcenc_image* image() noexcept { return &image_; }

 private:
  std::vector<float> values_;
  void* slice_ = values_.data();
  astcenc_image image_;
};

class Decoder final : public AstcDecoder {
 public:
  explicit Decoder(TexelKind kind)
      : edge_(block_edge(kind)), context_(context_for(ASTCENC_PRF_HDR, kind, 0.0F, ASTCENC_FLG_DECOMPRESS_ONLY)) {}

  void decode_rows(const std::uint8_t* blocks, int width, int first_row, int rows, float* rgb) override {
    const int top = first_row / edge_ * edge_;
    const int bottom = (first_row + rows + edge_ - 1) / edge_ * edge_;
    const int across = (width + edge_ - 1) / edge_;
    const auto bytes =
        kBlockBytes * static_cast<std::size_t>(across) * static_cast<std::size_t>((bottom - top) / edge_);
    Picture picture(width, bottom - top);
    constexpr astcenc_swizzle as_it_is{ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_A};
    require_success(astcenc_decompress_image(context_.get(), blocks, bytes, picture.image(), &as_it_is, kThread));
    const auto texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(rows);
    const float* rgba = picture.values() + std::ptrdiff_t{4} * width * (first_row - top);
    for (std::size_t k = 0; k < texels; ++k, rgba += 4, rgb += 3) std::copy_n(rgba, 3, rgb);
  }

 private:
  int edge_;
  Context context_;
};

float quality_of(AstcEffort effort) {
  switch (effort) {
    case AstcEffort::fastest: return ASTCENC_PRE_FASTEST;
    case AstcEffort::fast: return ASTCENC_PRE_FAST;
    case AstcEffort::medium: return ASTCENC_PRE_MEDIUM;
    case AstcEffort::thorough: return ASTCENC_PRE_THOROUGH;
  }
  throw Error(ErrorCode::invalid_argument, "the effort for ASTC is not one of the enumerators; pass one of them");
}

/// Blocks of one picture that are encoded together: neighbours in one row of blocks.
struct Tile {
  std::size_t level;
  std::size_t picture;  ///< of the level's
  int block_row;
  int first_block;  ///< of the row
  int blocks;
};

std::vector<Tile> tiles_of(std::span<const std::vector<LatLongView>> levels, int edge) {
  std::vector<Tile> tiles;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    for (std::size_t picture = 0; picture < levels[level].size(); ++picture) {
      const LatLongView& view = levels[level][picture];
      const int across = (view.width + edge - 1) / edge;
      for (int row = 0; row * edge < view.height; ++row) {
        for (int first = 0; first < across; first += kTileBlocks)
          tiles.push_back({level, picture, row, first, std::min(kTileBlocks, across - first)});
      }
    }
  }
  return tiles;
}

/// NaN becomes 0.
float held(float value, std::uint64_t& clamped) {
  if (value >= 0.0F && value <= image::kLargestHalf) return value;
  ++clamped;
  return value > image::kLargestHalf ? image::kLargestHalf : 0.0F;
}

/// Encodes a tile, and returns how many values were clamped. Beyond the edge of a picture astcenc repeats its texels.
std::uint64_t encode_tile(const LatLongView& view, const Tile& tile, int edge, astcenc_context* context,
                          std::uint8_t* blocks) {
  const int left = tile.first_block * edge;
  const int top = tile.block_row * edge;
  const int width = std::min(tile.blocks * edge, view.width - left);
  const int height = std::min(edge, view.height - top);
  Picture picture(width, height);
  std::vector<float> rgb(std::size_t{3} * static_cast<std::size_t>(width));
  std::uint64_t clamped = 0;
  float* rgba = picture.values();
  for (int row = 0; row < height; ++row) {
    const auto* const texels = static_cast<const std::byte*>(image::row_of(view, top + row)) +
                               static_cast<std::ptrdiff_t>(bytes_per_texel(view.format)) * left;
    image::decode_texels(view.format, texels, width, rgb.data());
    for (std::size_t k = 0; k < rgb.size(); k += 3, rgba += 4) {
      for (std::size_t channel = 0; channel < 3; ++channel) rgba[channel] = held(rgb[k + channel], clamped);
      rgba[3] = 1.0F;
    }
  }
  constexpr astcenc_swizzle opaque{ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_1};
  require_success(astcenc_compress_reset(context));
  require_success(astcenc_compress_image(context, picture.image(), &opaque, blocks,
                                         kBlockBytes * static_cast<std::size_t>(tile.blocks), kThread));
  return clamped;
}

}  // namespace

std::unique_ptr<AstcDecoder> make_astc_decoder(TexelKind kind, const std::filesystem::path& /*path*/) {
  return std::make_unique<Decoder>(kind);
}

BlockLevels encode_astc(std::span<const std::vector<LatLongView>> levels, TexelKind kind, AstcEffort effort,
                        const Control& control) {
  const float quality = quality_of(effort);
  const int edge = block_edge(kind);
  const auto blocks_across = [edge](int texels) { return static_cast<std::size_t>((texels + edge - 1) / edge); };
  BlockLevels encoded;
  for (const std::vector<LatLongView>& pictures : levels) {
    const LatLongView& first = pictures.front();
    encoded.levels.emplace_back(kBlockBytes * blocks_across(first.width) * blocks_across(first.height) *
                                pictures.size());
  }
  const std::vector<Tile> tiles = tiles_of(levels, edge);
  std::vector<std::uint64_t> clamped(tiles.size());
  // An encoder's texel takes a thousand times as long as those that a placement is chosen for.
  const jobs::Placement placement = tiles.size() > 1 ? jobs::Placement::arena : jobs::Placement::calling_thread;
  std::vector<Context> contexts(jobs::worker_count(placement));
  jobs::run_tiles(tiles.size(), placement, contexts.size(), control, [&](std::size_t index, std::size_t worker) {
    const Tile& tile = tiles[index];
    const LatLongView& view = levels[tile.level][tile.picture];
    Context& context = contexts[worker];
    if (!context) context = context_for(ASTCENC_PRF_HDR_RGB_LDR_A, kind, quality, 0);
    const std::size_t rows_above = tile.picture * blocks_across(view.height) + static_cast<std::size_t>(tile.block_row);
    const std::size_t block = rows_above * blocks_across(view.width) + static_cast<std::size_t>(tile.first_block);
    std::uint8_t* const to = encoded.levels[tile.level].data() + kBlockBytes * block;
    clamped[index] = encode_tile(view, tile, edge, context.get(), to);
  });
  for (const std::uint64_t values : clamped) encoded.values_clamped += values;
  return encoded;
}

}  // namespace welkin::files
