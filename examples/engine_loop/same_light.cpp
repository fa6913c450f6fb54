#include "same_light.h"

#include <algorithm>
#include <cstring>

namespace engine_loop {
namespace {

bool same_bits(const welkin::SphericalHarmonics& a, const welkin::SphericalHarmonics& b) {
  const auto left = a.coefficients();
  const auto right = b.coefficients();
  return left.size() == right.size() && std::memcmp(left.data(), right.data(), left.size_bytes()) == 0;
}

/// Whether a posting after `number` has its key.
bool has_newer(const std::vector<std::string>& keys, std::size_t number) {
  if (keys[number].empty()) return false;
  return std::find(keys.begin() + static_cast<std::ptrdiff_t>(number) + 1, keys.end(), keys[number]) != keys.end();
}

}  // namespace

std::string difference(const Run& synchronous, const Run& run) {
  const std::size_t count = run.keys.size();
  if (synchronous.baked.size() != count || run.baked.size() != count) return "not all requests have an outcome";
  for (std::size_t number = 0; number < count; ++number) {
    const std::string name = "request " + std::to_string(number);
    const auto& expected = synchronous.baked[number].radiance;
    const auto& light = run.baked[number].radiance;
    if (!expected) return name + " has no synchronous result";
    if (light && !same_bits(*expected, *light)) return name + " differs";
    if (!light && !has_newer(run.keys, number)) return name + " was replaced by nothing";
  }
  return {};
}

}  // namespace engine_loop
