// BC6H blocks and the texels that another decoder reads from them.
#pragma once

#include "image/bc6h.h"
#include "places.h"
#include "support/catch.h"

namespace welkin::test {

struct RecordedBlock {
  image::Bc6hRange range;
  std::array<std::uint8_t, image::kBlockBytes> bytes;
  std::array<std::uint16_t, 3 * image::kBlockTexels> halves;
};

/// tests/data/bc6h_blocks.txt: random blocks of every mode, reserved ones included, as OpenImageIO 2.4.7 reads them
/// from a DDS file. Each line holds U or S (unsigned, signed), the block's bytes and its half floats.
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

}  // namespace welkin::test
