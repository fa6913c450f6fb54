// Checksums of fuzzed PNGs.
#pragma once

#include <cstddef>
#include <cstdint>

namespace welkin::fuzz {

/// Makes the checksums of a PNG's chunks right: nearly no change to a chunk keeps its own, and behind a wrong one
/// nothing is read.
void mend_png_checksums(std::uint8_t* bytes, std::size_t count);

}  // namespace welkin::fuzz
