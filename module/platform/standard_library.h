// Replacements for parts of the standard library that libc++ 14 lacks.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <functional>
#include <iterator>
#include <memory>
#include <type_traits>
#include <utility>
#include <version>

namespace welkin::platform {

#ifdef __cpp_lib_bit_cast
using std::bit_cast;
#else
/// Does what std::bit_cast does.
template <class To, class From>
[[nodiscard]] constexpr To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  static_assert(std::is_trivially_copyable_v<To> && std::is_trivially_copyable_v<From>);
  return __builtin_bit_cast(To, from);
}
#endif

/// Does what std::make_unique_for_overwrite does for an array: its values are uninitialized.
template <class Array>
[[nodiscard]] std::unique_ptr<Array> make_unique_for_overwrite(std::size_t size) {
  static_assert(std::is_unbounded_array_v<Array>);
  return std::unique_ptr<Array>(new std::remove_extent_t<Array>[size]);
}

#ifdef __cpp_lib_ranges
namespace ranges = std::ranges;
#else
/// The parts of std::ranges that are used here.
namespace ranges {

template <class Range, class Out>
void copy(const Range& from, Out to) {
  std::copy(std::begin(from), std::end(from), to);
}
template <class Range, class Test>
[[nodiscard]] bool all_of(const Range& range, const Test& test) {
  return std::all_of(std::begin(range), std::end(range), test);
}
template <class Range, class Test>
[[nodiscard]] bool any_of(const Range& range, const Test& test) {
  return std::any_of(std::begin(range), std::end(range), test);
}
template <class Range, class Test>
[[nodiscard]] auto count_if(const Range& range, const Test& test) {
  return std::count_if(std::begin(range), std::end(range), test);
}
template <class Range, class Value, class Part>
[[nodiscard]] auto find(Range& range, const Value& value, Part part) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](const auto& element) { return std::invoke(part, element) == value; });
}
template <class Range>
[[nodiscard]] bool is_sorted(const Range& range) {
  return std::is_sorted(std::begin(range), std::end(range));
}
template <class Range, class Less = std::less<> >
void sort(Range& range, const Less& less = {}) {
  std::sort(std::begin(range), std::end(range), less);
}
template <class Range, class Less>
void stable_sort(Range& range, const Less& less) {
  std::stable_sort(std::begin(range), std::end(range), less);
}
template <class Range>
[[nodiscard]] auto max_element(const Range& range) {
  return std::max_element(std::begin(range), std::end(range));
}
template <class Range>
[[nodiscard]] auto minmax(const Range& range) {
  const auto ends = std::minmax_element(std::begin(range), std::end(range));
  return std::pair(*ends.first, *ends.second);
}

}  // namespace ranges
#endif

}  // namespace welkin::platform
