// What the real Babylon.js made of the seeded test cubemaps: tests/data/babylon.json, written by
// tests/babylon/record.mjs.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "support/catch.h"
#include "support/test_environments.h"
#include "welkin/engines.h"
#include "welkin/projection.h"

namespace welkin::test {

/// A BabylonPolynomial as a list: x, y, z, xx, yy, zz, yz, zx, xy.
using PolynomialTerms = std::array<glm::dvec3, 9>;

[[nodiscard]] PolynomialTerms terms(const BabylonPolynomial& polynomial);

/// Largest |found - expected| over all 27 entries, over the largest |expected|: infinite where nothing is
/// expected but something found, NaN if anything is.
[[nodiscard]] double relative_deviation(const PolynomialTerms& found, const PolynomialTerms& expected);

/// Recorded switches of Babylon.js as Welkin's midpoint options; `maximum_name` is what the clamp's maximum is called
/// in the record. Of a clamp at infinity only Babylon.js's lower bound is left, which Welkin has as a policy for
/// negatives.
[[nodiscard]] ProjectionOptions babylon_options(const nlohmann::json& recorded, const char* maximum_name);

struct RecordedCase {
  std::string group;
  Content content{};
  bool bytes = false;  ///< 8-bit channels, else float
  int size = 0;
  int channels = 0;
  std::uint32_t seed = 0;
  std::uint32_t checksum = 0;  ///< of the pixels that Babylon.js was given
  ProjectionOptions options;   ///< what asks Welkin for the same
  PolynomialTerms polynomial{};
  std::optional<std::array<glm::dvec3, 9>> radiance;  ///< Babylon.js's own, odd orders negated; recorded for a few

  /// Group, content, size and options in a line.
  [[nodiscard]] std::string description() const;
};

/// All of them, read once.
[[nodiscard]] const std::vector<RecordedCase>& recorded_cases();

}  // namespace welkin::test
