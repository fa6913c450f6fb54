// Textures of BC6H blocks as environments.
#include "image/pixels.h"
#include "support/bc6h_files.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/ktx_files.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

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

/// Returns the block at a position in a cubemap of blocks.
const RecordedBlock& block_at(const std::vector<RecordedBlock>& blocks, int face, int level, int row, int column) {
  return blocks[static_cast<std::size_t>(37 * face + 101 * level + 7 * row + column) % blocks.size()];
}

/// Appends the blocks of a level's face, row after row.
void append_face(std::vector<std::byte>& bytes, const std::vector<RecordedBlock>& blocks, int size, int level,
                 int face) {
  const int across = image::blocks_across(std::max(1, size >> level));
  for (int block = 0; block < across * across; ++block) {
    const RecordedBlock& recorded = block_at(blocks, face, level, block / across, block % across);
    for (const std::uint8_t byte : recorded.bytes) bytes.push_back(std::byte{byte});
  }
}

/// Returns a DDS cubemap with a full chain of levels; its header is that of halves except for the format.
std::vector<std::byte> dds_of_blocks(const std::vector<RecordedBlock>& blocks, int size) {
  constexpr std::size_t header_bytes = 148;
  constexpr std::size_t format = 128;
  const int levels = full_chain_levels(size);
  std::vector<std::byte> bytes;
  write_texture({bytes, "sky.dds"}, noisy_chain(size, levels).views());
  bytes.resize(header_bytes);
  bytes[format] = std::byte{blocks.front().range == image::Bc6hRange::positive ? std::uint8_t{95} : std::uint8_t{96}};
  for (int face = 0; face < 6; ++face) {
    for (int level = 0; level < levels; ++level) append_face(bytes, blocks, size, level, face);
  }
  return bytes;
}

/// Returns a KTX2 cubemap of the blocks with a full chain of levels.
std::vector<std::byte> ktx2_of_blocks(const std::vector<RecordedBlock>& blocks, int size) {
  std::vector<std::vector<std::byte>> levels(static_cast<std::size_t>(full_chain_levels(size)));
  for (std::size_t level = 0; level < levels.size(); ++level) {
    for (int face = 0; face < 6; ++face) append_face(levels[level], blocks, size, static_cast<int>(level), face);
  }
  const auto edge = static_cast<std::uint32_t>(size);
  const std::uint32_t format = blocks.front().range == image::Bc6hRange::positive ? 143 : 144;
  return ktx2_bytes({format, 1, edge, edge, 0, 6}, levels);
}

/// Returns whether every texel of a chain has the value that is on record for its block.
bool is_recorded(const Cubemap& chain, const std::vector<RecordedBlock>& blocks) {
  bool same = true;
  for (int level = 0; level < chain.levels(); ++level) {
    const int size = chain.level_size(level);
    for (int texel = 0; texel < 6 * size * size; ++texel) {
      const int face = texel / (size * size);
      const int row = texel / size % size;
      const int column = texel % size;
      const RecordedBlock& block = block_at(blocks, face, level, row / 4, column / 4);
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

TEST_CASE("cubemaps of BC6H blocks are read exactly at all levels", "[codec][textures][bc6h][slow]") {
  for (const auto range : {image::Bc6hRange::positive, image::Bc6hRange::signed_values}) {
    const std::vector<RecordedBlock> blocks = blocks_of(range);
    for (const int size : {1, 2, 3, 4, 7, 64, 257}) {
      for (const auto& bytes : {dds_of_blocks(blocks, size), ktx2_of_blocks(blocks, size)}) {
        const FileInput file(bytes, "sky");
        const CubemapTexture texture = read_texture(file);
        CAPTURE(size, texture.format);
        REQUIRE(texture.cubemap.levels() == full_chain_levels(size));
        CHECK(is_recorded(texture.cubemap, blocks));
        const int last = texture.cubemap.levels() - 1;
        CHECK(read_environment(file, {.level = last}).pixels[0] == texture.cubemap.face(last, 0)[0]);
        const Environment whole = read_environment(file);
        CHECK(same_bytes(values_of(whole), level_values(texture.cubemap, 0)));
        CHECK(whole.info.storage == (range == image::Bc6hRange::positive ? "bc6h ufloat" : "bc6h sfloat"));
      }
    }
  }
}

TEST_CASE("cubemaps are written as BC6H and come back as their blocks say", "[codec][textures][bc6h]") {
  const TemporaryDirectory directory;
  for (const int size : {1, 7, 64}) {
    const Cubemap chain = noisy_chain(size, full_chain_levels(size), 2);
    for (const bool is_signed : {false, true}) {
      for (const Bc6hEffort effort : {Bc6hEffort::fast, Bc6hEffort::slow}) {
        const Cubemap wanted = decode_bc6h(encode_bc6h(chain.views(), {effort, is_signed}));
        for (const Supercompression packing : {Supercompression::none, Supercompression::zstd}) {
          for (const char* const name : {"sky.ktx2", "sky.dds"}) {
            if (packing != Supercompression::none && std::string(name) == "sky.dds") continue;
            CAPTURE(size, is_signed, name);
            TextureOptions options{is_signed ? TexelFormat::bc6h_sfloat : TexelFormat::bc6h_ufloat, packing, {}};
            options.bc6h_effort = effort;
            CHECK(write_texture(directory.file(name), chain.views(), options).values_clamped == 0);
            const CubemapTexture read = read_texture(directory.file(name));
            CHECK(all_values(read.cubemap, wanted, [](float a, float b) { return a == b; }));
          }
        }
      }
    }
  }
}

TEST_CASE("headers of BC6H textures are as their specifications have them", "[codec][textures][bc6h]") {
  const TemporaryDirectory directory;
  const Cubemap chain = noisy_chain(8, 4);
  TextureOptions options{.format = TexelFormat::bc6h_ufloat};
  write_texture(directory.file("sky.ktx2"), chain.views(), options);
  write_texture(directory.file("sky.dds"), chain.views(), options);
  const std::vector<char> ktx = read_bytes(directory.file("sky.ktx2"));
  const std::vector<char> dds = read_bytes(directory.file("sky.dds"));
  CHECK(number_at(ktx, 12) == 143);
  CHECK(number_at(ktx, 16) == 1);  // type size
  const std::size_t descriptor = number_at(ktx, 48);
  CHECK(number_at(ktx, descriptor) == 44);
  CHECK(number_at(ktx, descriptor + 12) == (133U | 1U << 8U | 1U << 16U));
  CHECK(number_at(ktx, descriptor + 16) == 0x0303);
  CHECK(number_at(ktx, descriptor + 20) == 16);
  CHECK(number_at(ktx, descriptor + 28) == (127U << 16U | 0x80U << 24U));
  CHECK(number_at(ktx, descriptor + 36) == 0);
  CHECK(number_at(ktx, descriptor + 40) == 0x3F800000);
  for (std::size_t level = 0; level < 4; ++level) {
    CHECK(number_at(ktx, 80 + 24 * level) % 16 == 0);
    CHECK(number_at(ktx, 88 + 24 * level) == (level == 0 ? 6U * 4U * 16U : 6U * 16U));
  }
  CHECK((number_at(dds, 8) & 0x80008U) == 0x80000U);  // linear size, no pitch
  CHECK(number_at(dds, 20) == 4 * 16);
  CHECK(number_at(dds, 112) == 0xFE00);
  CHECK(number_at(dds, 128) == 95);
  CHECK(number_at(dds, 136) == 4);
  CHECK(dds.size() == 148 + 6 * (4 + 1 + 1 + 1) * 16);
}

namespace {

/// Numbers that change slowly and are other at each texel and channel.
std::vector<float> slopes(int width, int height) {
  std::vector<float> rgb;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      for (const float share : {1.0F, 0.8F, 0.5F})
        rgb.push_back(share * (1.0F + 0.02F * static_cast<float>(column) + 0.03F * static_cast<float>(row)));
    }
  }
  return rgb;
}

bool is_near(std::span<const float> found, std::span<const float> wanted, float relative) {
  bool near = found.size() == wanted.size();
  for (std::size_t k = 0; near && k < wanted.size(); ++k) near = std::abs(found[k] / wanted[k] - 1.0F) < relative;
  return near;
}

}  // namespace

TEST_CASE("images are written as BC6H and are environments", "[codec][textures][bc6h]") {
  const TemporaryDirectory directory;
  const std::pair<int, int> shapes[] = {{1, 1}, {4, 2}, {7, 3}, {50, 25}, {64, 32}};
  for (const auto& [width, height] : shapes) {
    const std::vector<float> rgb = slopes(width, height);
    for (const TexelFormat format : {TexelFormat::bc6h_ufloat, TexelFormat::bc6h_sfloat}) {
      for (const char* const name : {"sky.ktx2", "sky.dds"}) {
        CAPTURE(width, height, name);
        const TextureOptions options{.format = format};
        CHECK(write_texture_2d(directory.file(name), width, height, rgb.data(), options).values_clamped == 0);
        const Environment read = read_environment(directory.file(name), {.layout = Layout::lat_long});
        REQUIRE(read.info.width == width);
        REQUIRE(read.info.height == height);
        CHECK(is_near(values_of(read), rgb, 0.02F));
      }
      TextureOptions packed{.format = format, .supercompression = Supercompression::zlib};
      write_texture_2d(directory.file("packed.ktx2"), width, height, rgb.data(), packed);
      const auto read = [&](const char* name) {
        return read_environment(directory.file(name), {.layout = Layout::lat_long});
      };
      CHECK(same_bytes(values_of(read("packed.ktx2")), values_of(read("sky.dds"))));
    }
  }
}

}  // namespace welkin::test
