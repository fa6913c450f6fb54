// Files of any format that needs no mutator of its own.
#include "fuzzed_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  welkin::fuzz::use_as_file(bytes, count);
  return 0;
}
