// Numbers as a person reads them. Independent of the locale.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <string>
#include <string_view>

namespace welkin::tool {

/// The number with so many significant digits, no trailing zeros: "0.25", "1.3e-08".
[[nodiscard]] std::string significant(double value, int digits = 6);

/// Three of them: "0.2  0.25  0.4".
[[nodiscard]] std::string significant(const glm::dvec3& rgb, int digits = 6);

/// The shortest text that reads back as the same number.
[[nodiscard]] std::string all_digits(double value);

/// Digits in groups of three: "2,097,152".
[[nodiscard]] std::string grouped(std::uint64_t count);

/// A count with its noun, in the plural where that is due: "1 texel", "2,097,152 texels".
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view noun);

struct Count {
  std::uint64_t number;
  std::string_view noun;
};

/// Those of the counts that are not zero, with their nouns: "2 NaNs, 1 negative value".
[[nodiscard]] std::string counted(std::initializer_list<Count> counts);

/// A duration with its unit: "0.21 ms", "3.4 s".
[[nodiscard]] std::string duration(double milliseconds);

[[nodiscard]] std::string pad_left(std::string_view text, std::size_t width);
[[nodiscard]] std::string pad_right(std::string_view text, std::size_t width);

/// A column of numbers with their decimal points below each other: fixed point, so many decimals that the
/// largest number shows six significant digits, or scientific where that would be mostly zeros.
class NumberColumn {
 public:
  explicit NumberColumn(double largest_magnitude);

  /// Right-aligned in `width` characters.
  [[nodiscard]] std::string cell(double value, std::size_t width = 11) const;
  [[nodiscard]] std::string cells(const glm::dvec3& rgb, std::size_t width = 11) const;

 private:
  int decimals_ = 0;
  bool scientific_ = false;
};

/// The largest absolute value of the three.
[[nodiscard]] double largest_magnitude(const glm::dvec3& rgb);

}  // namespace welkin::tool
