// Fuzzes saved sky tables. Their checksum is corrected first, as a fuzzer would never get past it.
#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "sky/table_sizes.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace {

void repair(std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t summed_from = 16;
  if (bytes.size() < summed_from + 12) return;
  const std::uint64_t following = bytes.size() - 24;
  std::memcpy(bytes.data() + 16, &following, sizeof following);
  const auto sum = static_cast<std::uint32_t>(crc32_z(0, bytes.data() + summed_from, bytes.size() - summed_from));
  std::memcpy(bytes.data() + 12, &sum, sizeof sum);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* first, std::size_t count) {
  std::vector<std::uint8_t> bytes(first, first + count);
  if (count % 2 == 0) repair(bytes);
  try {
    const welkin::SkyTables tables =
        welkin::load_sky_tables({std::as_bytes(std::span(bytes)), "fuzzed.sky"}, std::uint64_t{1} << 24U);
    for (const float value : tables.scattering) {
      if (!(value >= 0.0F) || !std::isfinite(value)) std::abort();
    }
    welkin::check(tables.atmosphere);
    static_cast<void>(welkin::sky::sky_table_bytes(tables.atmosphere, tables.options));
  } catch (const welkin::Error&) {
  }
  return 0;
}
