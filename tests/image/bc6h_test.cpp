// BC6H blocks: their bits, and the halves that they stand for.
#include "image/bc6h.h"

#include <bit>
#include <cstring>
#include <random>
#include <set>

#include "image/pixels.h"
#include "support/bc6h_files.h"
#include "support/catch.h"
#include "support/same_bits.h"

namespace welkin::test {

// Promises: every block of every mode decodes to the halves that another decoder gives; each bit of a block belongs to
// one number, and the numbers packed again are the same block.

namespace {

using image::Bc6hFields, image::Bc6hRange, image::kBlockBytes, image::kBlockTexels;
using Block = std::array<std::uint8_t, kBlockBytes>;

Block with_mode(Block block, int mode) {
  const image::Bc6hMode& found = image::bc6h_mode(mode);
  const auto mask = static_cast<std::uint8_t>((1 << found.prefix_bits) - 1);
  block[0] = static_cast<std::uint8_t>((block[0] & ~mask) | found.prefix);
  return block;
}

/// How many bits of their numbers two blocks differ in.
int different_bits(const Bc6hFields& a, const Bc6hFields& b) {
  int count = std::popcount(static_cast<unsigned>(a.partition ^ b.partition));
  for (std::size_t end = 0; end < 4; ++end) {
    for (std::size_t c = 0; c < 3; ++c) count += std::popcount(a.ends[end][c] ^ b.ends[end][c]);
  }
  for (std::size_t k = 0; k < kBlockTexels; ++k) {
    count += std::popcount(static_cast<unsigned>(a.indices[k] ^ b.indices[k]));
  }
  return count;
}

}  // namespace

TEST_CASE("BC6H blocks of all modes decode as OpenImageIO decodes them", "[image][bc6h]") {
  std::set<std::pair<int, bool>> modes;
  for (const RecordedBlock& block : recorded_blocks()) {
    std::array<std::uint16_t, 3 * kBlockTexels> halves{};
    image::decode_bc6h(block.bytes.data(), block.range, halves.data());
    const int mode = image::unpack_bc6h(block.bytes.data()).mode;
    CAPTURE(mode);
    CHECK(halves == block.halves);
    modes.emplace(mode, block.range == Bc6hRange::positive);
  }
  CHECK(modes.size() == 2 * (image::kBc6hModes + 1));  // with the reserved ones, which are black
}

TEST_CASE("each bit of a BC6H block is one bit of one of its numbers", "[image][bc6h]") {
  std::mt19937 random(3);
  for (int mode = 1; mode <= image::kBc6hModes; ++mode) {
    CAPTURE(mode);
    for (int trial = 0; trial < 64; ++trial) {
      Block block{};
      for (std::uint8_t& byte : block) byte = static_cast<std::uint8_t>(random());
      block = with_mode(block, mode);
      const Bc6hFields fields = image::unpack_bc6h(block.data());
      REQUIRE(fields.mode == mode);
      Block packed{};
      image::pack_bc6h(fields, packed.data());
      REQUIRE(packed == block);
      const image::Bc6hMode& found = image::bc6h_mode(mode);
      // A bit of the partition may move an anchor, and with it all indices behind: it is not turned round here.
      for (int bit = found.prefix_bits; bit < 128; ++bit) {
        if (found.two_lines && bit >= 77 && bit < 82) continue;
        Block turned = block;
        turned[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        REQUIRE(different_bits(fields, image::unpack_bc6h(turned.data())) == 1);
      }
    }
  }
}

TEST_CASE("a partition's anchor lies in its second line", "[image][bc6h]") {
  for (int partition = 0; partition < 32; ++partition) {
    CHECK((image::bc6h_second_line(partition) >> image::bc6h_anchor(partition) & 1) == 1);
    CHECK((image::bc6h_second_line(partition) & 1) == 0);
  }
}

TEST_CASE("rows of BC6H blocks are cut where they are asked for", "[image][bc6h]") {
  const std::vector<RecordedBlock> recorded = recorded_blocks();
  for (const int width : {1, 2, 3, 4, 7, 16}) {
    const int across = image::blocks_across(width);
    std::vector<std::uint8_t> blocks;
    for (int k = 0; k < across * across; ++k) {
      const auto& bytes = recorded[static_cast<std::size_t>(k)].bytes;
      blocks.insert(blocks.end(), bytes.begin(), bytes.end());
    }
    const auto row_values = 3 * static_cast<std::size_t>(width);
    std::vector<float> whole(row_values * static_cast<std::size_t>(width));
    image::decode_bc6h_rows(blocks.data(), Bc6hRange::positive, width, 0, width, whole.data());
    for (int row = 0; row < width; ++row) {
      for (int rows = 1; row + rows <= width; ++rows) {
        std::vector<float> some(row_values * static_cast<std::size_t>(rows));
        const auto skipped = kBlockBytes * static_cast<std::size_t>(row / 4 * across);
        image::decode_bc6h_rows(blocks.data() + skipped, Bc6hRange::positive, width, row, rows, some.data());
        const float* const wanted = whole.data() + row_values * static_cast<std::size_t>(row);
        CHECK(same_bytes<float>(some, {wanted, some.size()}));
      }
    }
    std::array<std::uint16_t, 3 * kBlockTexels> last{};
    image::decode_bc6h(blocks.data() + blocks.size() - kBlockBytes, Bc6hRange::positive, last.data());
    const int place = (width - 1) % 4;
    CHECK(whole.back() == image::float_from_half(last[static_cast<std::size_t>(3 * (4 * place + place) + 2)]));
  }
}

}  // namespace welkin::test
