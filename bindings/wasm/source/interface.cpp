#include "interface.h"

#include <cstdlib>
#include <exception>
#include <new>

namespace welkin::wasm {
namespace {

/// JavaScript's: posts the share of the work that is done to whoever waits for it.
extern "C" [[clang::import_module("welkin"), clang::import_name("progress")]] void report_progress(double share);

std::string& message() {
  static auto& text = *new std::string;
  return text;
}

}  // namespace

std::vector<Block>& results() {
  static auto& blocks = *new std::vector<Block>;
  return blocks;
}

void give(const SphericalHarmonics& harmonics) {
  std::vector<double> numbers;
  for (const dvec3& coefficient : harmonics.coefficients()) {
    numbers.insert(numbers.end(), {coefficient.x, coefficient.y, coefficient.z});
  }
  give(std::move(numbers));
}

int guarded(void (*body)(const Options& options), const double* options) {
  constexpr int kNoMemory = 1000;
  constexpr int kUnexpected = 1001;
  results().clear();
  try {
    body(Options(options));
    return 0;
  } catch (const Error& error) {
    results().clear();
    message() = error.what();
    return 1 + static_cast<int>(error.code());
  } catch (const std::bad_alloc&) {
    results().clear();
    message() = "there is not enough memory";
    return kNoMemory;
  } catch (const std::exception& error) {
    results().clear();
    message() = error.what();
    return kUnexpected;
  }
}

Control reporting() {
  Control control;
  control.progress = [](double share) { report_progress(share); };
  return control;
}

PixelPolicy policy_of(const Options& options, int first) {
  PixelPolicy policy;
  if (options.number(first) > 0.0) {
    policy.clamp = RadianceClamp{static_cast<float>(options.number(first)), options.flag(first + 1)};
  }
  policy.gamma = options.flag(first + 2);
  if (options.flag(first + 3)) policy.negative = NegativePolicy::replace;
  if (options.flag(first + 4)) {
    policy.nan = NonFinitePolicy::reject;
    policy.infinity = NonFinitePolicy::reject;
  }
  return policy;
}

bool is_lat_long(const Options& options) { return options.whole(kHeight) > 0; }

CubemapView cubemap_of(const Options& options) {
  CubemapView view;
  view.size = options.whole(kWidth);
  view.format = static_cast<PixelFormat>(options.whole(kFormat));
  const auto edge = static_cast<std::size_t>(view.size);
  for (std::size_t face = 0; face < 6; ++face) {
    view.faces[face] = options.pointer<std::byte>(kPixels) + face * edge * edge * bytes_per_texel(view.format);
  }
  return view;
}

LatLongView lat_long_of(const Options& options) {
  return {options.pointer<std::byte>(kPixels), options.whole(kWidth), options.whole(kHeight), 0,
          static_cast<PixelFormat>(options.whole(kFormat))};
}

}  // namespace welkin::wasm

WELKIN_ENTRY(welkin_allocate) void* welkin_allocate(std::size_t bytes) {
  constexpr std::size_t kAlignment = 64;
  return std::aligned_alloc(kAlignment, (bytes + kAlignment) / kAlignment * kAlignment);
}

WELKIN_ENTRY(welkin_free) void welkin_free(void* block) { std::free(block); }

WELKIN_ENTRY(welkin_result) const void* welkin_result(int index) {
  const auto& blocks = welkin::wasm::results();
  return index < static_cast<int>(blocks.size()) ? blocks[static_cast<std::size_t>(index)].data : nullptr;
}

WELKIN_ENTRY(welkin_result_bytes) std::size_t welkin_result_bytes(int index) {
  const auto& blocks = welkin::wasm::results();
  return index < static_cast<int>(blocks.size()) ? blocks[static_cast<std::size_t>(index)].bytes : 0;
}

WELKIN_ENTRY(welkin_release) void welkin_release() { welkin::wasm::results().clear(); }

WELKIN_ENTRY(welkin_message) const char* welkin_message() { return welkin::wasm::message().c_str(); }
