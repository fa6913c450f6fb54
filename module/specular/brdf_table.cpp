#include "welkin/brdf_table.h"

#include <algorithm>
#include <bit>
#include <string>

#include "specular/brdf_integration.h"
#include "tables/table_cache.h"
#include "welkin/error.h"

namespace welkin {
namespace {

constexpr int kLargestEdge = 4096;
constexpr std::size_t kCacheBytes = std::size_t{32} << 20U;  ///< some 650 tables of 64 x 64, or two of 1024 x 1024

void check_edge(const char* which, int edge) {
  if (edge >= 1 && edge <= kLargestEdge) return;
  throw Error(ErrorCode::invalid_argument, "a BRDF table's " + std::string(which) + " is " + std::to_string(edge) +
                                               "; pass 1 to " + std::to_string(kLargestEdge));
}

/// IEEE binary16, ties to even; beyond its range the largest half.
std::uint16_t half_from_float(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t sign = (bits >> 16U) & 0x8000U;
  const std::uint32_t magnitude = bits & 0x7FFFFFFFU;
  constexpr std::uint32_t least_normal = 0x38800000U;  // 2^-14
  constexpr std::uint32_t largest = 0x477FE000U;       // 65504
  if (magnitude >= largest) return static_cast<std::uint16_t>(sign | 0x7BFFU);
  if (magnitude < least_normal) {
    // A float addition rounds to multiples of 2^-24, to even, and leaves them in the mantissa's last bits.
    const float rounded = std::bit_cast<float>(magnitude) + 0.5F;
    return static_cast<std::uint16_t>(sign | (std::bit_cast<std::uint32_t>(rounded) - 0x3F000000U));
  }
  const std::uint32_t odd = (magnitude >> 13U) & 1U;
  return static_cast<std::uint16_t>(sign | ((magnitude - 0x38000000U + 0xFFFU + odd) >> 13U));
}

tables::TableCache<BrdfTableOptions, BrdfTable>& cache() {
  static tables::TableCache<BrdfTableOptions, BrdfTable> tables(kCacheBytes);
  return tables;
}

}  // namespace

std::vector<std::uint16_t> BrdfTable::half_values() const {
  std::vector<std::uint16_t> halves(values.size());
  std::transform(values.begin(), values.end(), halves.begin(), half_from_float);
  return halves;
}

void specular::check_brdf(const BrdfTableOptions& options) {
  check_edge("width", options.width);
  check_edge("height", options.height);
}

std::shared_ptr<const BrdfTable> specular::shared_brdf(const BrdfTableOptions& options, const Control& control,
                                                       bool& made) {
  check_brdf(options);
  made = true;
  if (control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled by the caller");
  // What would not be kept is made without the cache, where whoever wants the same waits for it, deaf to its own stop.
  if (specular::brdf_values(options) * sizeof(float) > kCacheBytes) return specular::integrated_brdf(options, control);
  made = false;
  std::shared_ptr<const BrdfTable> table = cache().get(options, [&] {
    made = true;
    return specular::integrated_brdf(options, control);
  });
  if (!made && control.progress) control.progress(1.0);
  return table;
}

std::shared_ptr<const BrdfTable> brdf_table(const BrdfTableOptions& options, const Control& control) {
  bool made = false;
  return specular::shared_brdf(options, control, made);
}

}  // namespace welkin
