#include "fuzzed_file.h"
#include "png_checksums.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t count, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t count, std::size_t most,
                                               unsigned seed) {
  const std::size_t changed = LLVMFuzzerMutate(bytes, count, most);
  if (seed % 8 != 0) {
    welkin::fuzz::mend_png_checksums(bytes, changed);
  }
  return changed;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  welkin::fuzz::use_as_file(bytes, count);
  return 0;
}
