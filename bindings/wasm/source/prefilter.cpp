// Reflections of pixels: a chain of mips, each as halves or floats with an alpha of 1.
#include <optional>
#include <vector>

#include "chains.h"
#include "interface.h"
#include "welkin/reflections.h"

namespace welkin::wasm {
namespace {

constexpr int kChain = kSourceOptions + kPolicyOptions;

void prefilter_pixels(const Options& options) {
  PrefilterOptions wanted = prefilter_options(options, kChain);
  wanted.pixels = policy_of(options, kSourceOptions);
  give_chain(is_lat_long(options) ? prefilter_specular(lat_long_of(options), wanted, reporting())
                                  : prefilter_specular(cubemap_of(options), wanted, reporting()),
             options.flag(kChain + kChainFloats));
}

}  // namespace
}  // namespace welkin::wasm

WELKIN_ENTRY(welkin_prefilter) int welkin_prefilter(const double* options) {
  return welkin::wasm::guarded(welkin::wasm::prefilter_pixels, options);
}
