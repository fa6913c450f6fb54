// BC6H blocks with the texels that another decoder makes of them, and files of such blocks.
#pragma once

#include "image/bc6h.h"
#include "places.h"
#include "support/catch.h"
#include "support/temporary_directory.h"
#include "welkin/image.h"

namespace welkin::test {

struct RecordedBlock {
  image::Bc6hRange range;
  std::array<std::uint8_t, image::kBlockBytes> bytes;
  std::array<std::uint16_t, 3 * image::kBlockTexels> halves;
};

/// tests/data/bc6h_blocks.txt: random blocks of every mode, the reserved ones too, as OpenImageIO 2.4.7 reads them from
/// a DDS file. A line is U or S (unsigned, signed), the block's bytes and its halves.
inline std::vector<RecordedBlock> recorded_blocks() {
  std::ifstream file(WELKIN_TEST_DATA "/bc6h_blocks.txt");
  std::vector<RecordedBlock> blocks;
  std::string range;
  std::string bytes;
  std::string halves;
  while (file >> range >> bytes >> halves) {
    RecordedBlock& block = blocks.emplace_back();
    block.range = range == "U" ? image::Bc6hRange::positive : image::Bc6hRange::signed_values;
    for (std::size_t k = 0; k < block.bytes.size(); ++k) {
      block.bytes[k] = static_cast<std::uint8_t>(std::stoi(bytes.substr(2 * k, 2), nullptr, 16));
    }
    for (std::size_t k = 0; k < block.halves.size(); ++k) {
      block.halves[k] = static_cast<std::uint16_t>(std::stoi(halves.substr(4 * k, 4), nullptr, 16));
    }
  }
  return blocks;
}

/// Where in a cubemap of blocks each one lies, and the bytes of one: block (face, level, row, column).
inline std::array<std::uint8_t, image::kBlockBytes> block_at(const std::vector<RecordedBlock>& blocks, int face,
                                                             int level, int row, int column) {
  const auto number = static_cast<std::size_t>(37 * face + 101 * level + 7 * row + column);
  return blocks[number % blocks.size()].bytes;
}

/// What `block_at` says for a level's face, row after row.
inline void append_face(std::vector<char>& bytes, const std::vector<RecordedBlock>& blocks, int size, int level,
                        int face) {
  const int across = image::blocks_across(size >> level > 1 ? size >> level : 1);
  for (int row = 0; row < across; ++row) {
    for (int column = 0; column < across; ++column) {
      for (const std::uint8_t byte : block_at(blocks, face, level, row, column)) {
        bytes.push_back(static_cast<char>(byte));
      }
    }
  }
}

inline void put(std::vector<char>& bytes, std::size_t at, std::uint64_t value, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) bytes[at + k] = static_cast<char>(value >> (8 * k) & 0xFFU);
}

/// A DDS cubemap with a whole chain of levels; `header` is that of a file of another format and the same shape.
inline std::vector<char> dds_of_blocks(std::vector<char> header, const std::vector<RecordedBlock>& blocks, int size) {
  constexpr std::size_t header_bytes = 148;
  constexpr std::size_t format = 128;
  header.resize(header_bytes);
  put(header, format, blocks.front().range == image::Bc6hRange::positive ? 95 : 96, 4);
  for (int face = 0; face < 6; ++face) {
    for (int level = 0; level < full_chain_levels(size); ++level) append_face(header, blocks, size, level, face);
  }
  return header;
}

/// The same as KTX2.
inline std::vector<char> ktx2_of_blocks(std::vector<char> header, const std::vector<RecordedBlock>& blocks, int size) {
  constexpr std::size_t format = 12;
  constexpr std::size_t type_size = 16;
  constexpr std::size_t index = 80;
  put(header, format, blocks.front().range == image::Bc6hRange::positive ? 143 : 144, 4);
  put(header, type_size, 1, 4);
  for (int level = full_chain_levels(size) - 1; level >= 0; --level) {
    const std::size_t first = header.size();
    for (int face = 0; face < 6; ++face) append_face(header, blocks, size, level, face);
    const std::size_t entry = index + 24 * static_cast<std::size_t>(level);
    put(header, entry, first, 8);
    put(header, entry + 8, header.size() - first, 8);
    put(header, entry + 16, header.size() - first, 8);
  }
  return header;
}

}  // namespace welkin::test
