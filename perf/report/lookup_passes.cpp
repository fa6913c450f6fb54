// The pass about reflections as shaders read them: between texels and between mips, of Welkin's chains and other
// programs'.
#include <string>
#include <vector>

#include "perf/report/lookups.h"
#include "perf/report/passes.h"
#include "perf/report/words.h"
#include "welkin/environment_file.h"
#include "welkin/reflections.h"

namespace welkin::report {
namespace {

constexpr const char* kTruth = "the integral over all texels in double, in some directions";
constexpr double kBounds[] = {1e-2, 1e-3, 1e-4};
constexpr int kSamples[] = {64, 1024};  // of cmgen

struct Chain {
  const char* method;
  RoughnessSchedule schedule;
  int smallest;  ///< texels along an edge of its last mip
  bool fitted;   ///< lobes, to lookups
};

constexpr Chain kChains[] = {{"Filament's formula", RoughnessSchedule::filament, 16, false},
                             {"Filament's formula", RoughnessSchedule::filament, 8, false},
                             {"Filament's formula", RoughnessSchedule::filament, 4, false},
                             {"Filament's formula, fitted lobes", RoughnessSchedule::filament, 4, true},
                             {"Babylon.js' formula, fitted lobes", RoughnessSchedule::babylon, 1, true}};

std::string words_of(int mips, double bound) { return std::to_string(mips) + " mips, bound " + percent(bound); }

std::vector<Measurement> from_file(const PassContext& context) {
  const LookupTruth truth(read_environment(context.file).lat_long(), 2 * context.scale.probes);
  progress(context, 1, 3);
  const int size = context.scale.chain_size;
  std::vector<Measurement> all;
  for (const Chain& chain : kChains) {
    const int mips = full_chain_levels(size) - full_chain_levels(chain.smallest) + 1;
    PrefilterOptions options{.size = size, .roughness = roughness_of_mips(chain.schedule, mips, size)};
    if (chain.fitted) options.lobe_roughness = fitted_roughness_of_mips(chain.schedule, mips, size);
    for (const double bound : kBounds) {
      options.rms_error = bound;
      Cubemap result;
      const double seconds = context.stopwatch.seconds(
          [&] { result = prefilter_specular(read_environment(context.file).lat_long(), options).cubemap; });
      const ErrorNorms errors = truth.errors(result, chain.schedule);
      all.push_back({"", chain.method, words_of(mips, bound), errors.rms, errors.maximum, seconds, kTruth});
    }
  }
  progress(context, 2, 3);
  std::vector<PeerChain> peers =
      context.peers.prefilter_file(context.file, size, kSamples, context.folder, context.stopwatch);
  for (PeerChain& peer : context.peers.prefilter_by_webgl(context.file, size, context.folder))
    peers.push_back(std::move(peer));
  for (const PeerChain& peer : peers) {
    const ErrorNorms errors = truth.errors(peer.cubemap, peer.schedule);
    all.push_back({"", peer.method, peer.setting, errors.rms, errors.maximum, peer.seconds, kTruth, peer.peer});
  }
  return all;
}

}  // namespace

std::vector<PassRunner> lookup_passes() {
  return {{{"lookups", "Reflections as a shader reads them",
            "A specular chain from a Radiance .hdr file, reading included, that is read as the engine's shader does: "
            "bilinearly within a mip, across the edges of faces, linearly between two mips by the engine's formula.",
            "rms: rms of the difference over that of the reference, by solid angle, over roughnesses 1/32, 3/32, ..., "
            "31/32. "
            "Maximum: the rms error of the worst of these roughnesses."},
           5.0,
           from_file}};
}

}  // namespace welkin::report
