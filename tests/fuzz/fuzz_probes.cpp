// Probes: a description, and arrays behind its first zero byte.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/probes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* first, std::size_t count) {
  const auto bytes = std::as_bytes(std::span(first, count));
  const auto end = static_cast<std::size_t>(std::find(first, first + count, std::uint8_t{0}) - first);
  const welkin::FileInput description(bytes.first(end), "fuzzed.json");
  const welkin::FileInput arrays(bytes.subspan(std::min(end + 1, count)), "fuzzed.bin");
  try {
    const welkin::BakedProbes probes = welkin::read_probes(description, arrays);
    if (probes.grid.size() > count || probes.validity.size() != probes.grid.size()) std::abort();
    try {
      static_cast<void>(welkin::probe_irradiance(probes, probes.grid.origin, {0.0, 1.0, 0.0}));
    } catch (const welkin::Error&) {
    }
    for (const auto layout : {welkin::ProbeLayout::bevy, welkin::ProbeLayout::rtxgi, welkin::ProbeLayout::three}) {
      try {
        static_cast<void>(welkin::pack_probes(probes, layout));
      } catch (const welkin::Error&) {
      }
    }
  } catch (const welkin::Error&) {
  }
  return 0;
}
