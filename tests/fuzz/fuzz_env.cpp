#include <algorithm>
#include <array>

#include "fuzzed_file.h"
#include "png_checksums.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t count, std::size_t most);

// The images of an .env begin where a PNG's signature stands. What follows an image is no chunk of it, so mending
// ends there by itself.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t count, std::size_t most,
                                               unsigned seed) {
  constexpr std::array<std::uint8_t, 4> signature{0x89, 'P', 'N', 'G'};
  const std::size_t changed = LLVMFuzzerMutate(bytes, count, most);
  if (seed % 8 == 0) return changed;
  for (std::uint8_t* index = bytes; index != bytes + changed;) {
    index = std::search(index, bytes + changed, signature.begin(), signature.end());
    if (index == bytes + changed) break;
    welkin::fuzz::mend_png_checksums(index, static_cast<std::size_t>(bytes + changed - index));
    ++index;
  }
  return changed;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  welkin::fuzz::use_as_file(bytes, count);
  return 0;
}
