// What all entries of the WebAssembly module share: how JavaScript hands over options and pixels, and how it gets
// results. The other side is package/worker.js.
//
// An entry takes one pointer to doubles, its options in the order of its `enum`; a pointer to pixels or bytes is one of
// these doubles. It returns 0, or 1 + the `ErrorCode`. What it made is then a list of blocks of memory, which
// JavaScript copies out before it calls the next entry: `welkin_result(k)`, `welkin_result_bytes(k)`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

#define WELKIN_ENTRY(name) extern "C" [[clang::export_name(#name)]]

namespace welkin::wasm {

/// The options of an entry as JavaScript wrote them.
class Options {
 public:
  explicit Options(const double* values) : values_(values) {}

  [[nodiscard]] double number(int index) const { return values_[index]; }
  [[nodiscard]] int whole(int index) const { return static_cast<int>(values_[index]); }
  [[nodiscard]] bool flag(int index) const { return values_[index] != 0.0; }
  /// Where something lies in the module's memory.
  template <class Value>
  [[nodiscard]] const Value* pointer(int index) const {
    return reinterpret_cast<const Value*>(static_cast<std::uintptr_t>(values_[index]));
  }

 private:
  const double* values_;
};

/// A block of a result, and who keeps it.
struct Block {
  const void* data = nullptr;
  std::size_t bytes = 0;
  std::shared_ptr<const void> owner;
};

/// Those of the last entry.
std::vector<Block>& results();

/// Adds a block that `values` become.
template <class Value>
void give(std::vector<Value> values) {
  const auto kept = std::make_shared<const std::vector<Value>>(std::move(values));
  results().push_back({kept->data(), kept->size() * sizeof(Value), kept});
}

/// Adds the numbers of coefficients: three a coefficient.
void give(const SphericalHarmonics& harmonics);

/// Calls `body`, which gives results, and turns what it throws into a status; JavaScript asks for the message.
int guarded(void (*body)(const Options& options), const double* options);

/// A control that reports to JavaScript.
[[nodiscard]] Control reporting();

/// What becomes of pixels: five options from `first` on (a clamp's maximum, 0 for none; whether it keeps colours;
/// gamma; whether negatives are replaced; whether NaN and infinities are refused).
inline constexpr int kPolicyOptions = 5;
[[nodiscard]] PixelPolicy policy_of(const Options& options, int first);

/// Six options from `first` on: pixels, width, height (of a cubemap: 0), format, and so on.
enum SourceOption { kPixels, kWidth, kHeight, kFormat, kSourceOptions };
[[nodiscard]] bool is_lat_long(const Options& options);
[[nodiscard]] CubemapView cubemap_of(const Options& options);
[[nodiscard]] LatLongView lat_long_of(const Options& options);

}  // namespace welkin::wasm
