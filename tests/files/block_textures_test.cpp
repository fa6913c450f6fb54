// Textures of BC6H blocks as environments.
#include <cmath>

#include "image/pixels.h"
#include "support/bc6h_files.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"
#include "welkin/texture_file.h"

namespace welkin::test {

// Promises: KTX2 and DDS cubemaps of BC6H blocks are read exactly, at every level and size, and are environments like
// others.

namespace {

std::vector<RecordedBlock> blocks_of(image::Bc6hRange range) {
  std::vector<RecordedBlock> blocks;
  for (const RecordedBlock& block : recorded_blocks()) {
    if (block.range == range) blocks.push_back(block);
  }
  return blocks;
}

/// Whether every texel of a chain is what its block was recorded to stand for.
bool is_recorded(const CubemapChain& chain, const std::vector<RecordedBlock>& blocks) {
  bool same = true;
  for (int level = 0; level < chain.levels(); ++level) {
    const int size = chain.level_size(level);
    for (int texel = 0; texel < 6 * size * size; ++texel) {
      const int face = texel / (size * size);
      const int row = texel / size % size;
      const int column = texel % size;
      const auto number = static_cast<std::size_t>(37 * face + 101 * level + 7 * (row / 4) + column / 4);
      const RecordedBlock& block = blocks[number % blocks.size()];
      for (int c = 0; c < 3; ++c) {
        const float value = chain.face(level, face)[3 * (size * row + column) + c];
        const std::uint16_t half = block.halves[static_cast<std::size_t>(3 * (4 * (row % 4) + column % 4) + c)];
        same = same && value == image::float_from_half(half);
      }
    }
  }
  return same;
}

}  // namespace

TEST_CASE("cubemaps of BC6H blocks are read exactly at all levels", "[codec][textures][bc6h]") {
  const TemporaryDirectory directory;
  for (const auto range : {image::Bc6hRange::positive, image::Bc6hRange::signed_values}) {
    const std::vector<RecordedBlock> blocks = blocks_of(range);
    for (const int size : {1, 2, 3, 4, 7, 64, 257}) {
      for (const char* const name : {"sky.dds", "sky.ktx2"}) {
        CAPTURE(size, name);
        const auto path = directory.file(name);
        const CubemapChain other = noisy_chain(size, full_chain_levels(size));
        write_texture(path, other.views(), {});
        const std::vector<char> header = read_bytes(path);
        write_bytes(path, path.extension() == ".dds" ? dds_of_blocks(header, blocks, size)
                                                     : ktx2_of_blocks(header, blocks, size));
        const CubemapTexture texture = read_texture(path);
        REQUIRE(texture.cubemap.levels() == full_chain_levels(size));
        CHECK(is_recorded(texture.cubemap, blocks));
        ReadOptions options;
        options.level = texture.cubemap.levels() - 1;
        CHECK(read_environment(path, options).pixels[0] == texture.cubemap.face(options.level, 0)[0]);
        const Environment whole = read_environment(path);
        CHECK(same_bytes<float>({whole.pixels.get(), level_values(texture.cubemap, 0).size()},
                                level_values(texture.cubemap, 0)));
        CHECK(whole.info.storage == (range == image::Bc6hRange::positive ? "bc6h ufloat" : "bc6h sfloat"));
      }
    }
  }
}

TEST_CASE("a cubemap of BC6H blocks that ends too early is refused", "[codec][textures][bc6h]") {
  const TemporaryDirectory directory;
  const std::vector<RecordedBlock> blocks = blocks_of(image::Bc6hRange::positive);
  const auto path = directory.file("sky.dds");
  write_texture(path, noisy_chain(5, 3).views(), {});
  std::vector<char> bytes = dds_of_blocks(read_bytes(path), blocks, 5);
  bytes.pop_back();
  write_bytes(path, bytes);
  CHECK(thrown_by([&] { (void)read_texture(path); }).code == ErrorCode::corrupt_file);
}

}  // namespace welkin::test
