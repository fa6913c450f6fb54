#include "chains.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace welkin::wasm {

void require_edge(const char* name, int size) {
  constexpr int kLargestEdge = 4096;
  if (size >= 1 && size <= kLargestEdge) return;
  throw Error(ErrorCode::invalid_argument, std::string(name) + " is " + std::to_string(size) +
                                               "; it must be from 1 to " + std::to_string(kLargestEdge) +
                                               " in WebAssembly");
}

PrefilterOptions prefilter_options(const Options& options, int first) {
  const bool bounded = options.number(first + kChainError) > 0.0;
  PrefilterOptions wanted =
      PrefilterOptions::at(bounded ? Quality::normal : static_cast<Quality>(options.whole(first + kChainQuality)));
  const auto schedule = static_cast<RoughnessSchedule>(options.whole(first + kChainSchedule));
  if (options.whole(first + kChainSize) != 0) wanted.size = options.whole(first + kChainSize);
  require_edge("size", wanted.size);
  const int mips = options.whole(first + kChainMips);
  wanted.lobe = static_cast<LobeFamily>(options.whole(first + kChainLobe));
  if (mips != 0) wanted.mips = mips;
  if (wanted.lobe != LobeFamily::charlie && wanted.lobe != LobeFamily::lambert) {
    wanted.use_schedule(schedule, options.flag(first + kChainFitted));
  }
  if (bounded) wanted.rms_error = options.number(first + kChainError);
  if (options.number(first + kChainLargestError) > 0.0)
    wanted.maximum_error = options.number(first + kChainLargestError);
  return wanted;
}

void give_texels(const Cubemap& chain, bool floats) {
  const UploadLayout layout{
      .format = floats ? TexelFormat::rgba32f : TexelFormat::rgba16f, .size = chain.size(), .levels = chain.levels()};
  const auto bytes = static_cast<std::size_t>(upload_bytes(layout));
  const std::shared_ptr<std::byte[]> texels(new std::byte[bytes]);  // all written: a vector would set them first
  store_texels(chain, upload_targets(layout, {texels.get(), bytes}));
  results().push_back({texels.get(), bytes, {texels, texels.get()}});
}

void give_numbers(const PrefilteredSpecular& chain) {
  std::vector<double> numbers{static_cast<double>(chain.cubemap.size()), static_cast<double>(chain.mips.size())};
  for (const MipRecord& mip : chain.mips) {
    numbers.insert(numbers.end(), {static_cast<double>(mip.size), mip.roughness, mip.error_estimate.value_or(-1.0),
                                   mip.error_between.value_or(-1.0)});
  }
  give(std::move(numbers));
}

void give_chain(const PrefilteredSpecular& chain, bool floats) {
  give_numbers(chain);
  give_texels(chain.cubemap, floats);
}

}  // namespace welkin::wasm
