#include "report/prefilter_passes.h"

#include <optional>
#include <random>

#include "report/cube_probes.h"
#include "report/number_words.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"
#include "welkin/projection.h"
#include "welkin/roughness.h"
#include "welkin/specular.h"

namespace welkin::report {
namespace {

constexpr const char* kTruth = "the integral over all texels in double, at some of the result's texels";
constexpr int kSmallestMip = 16;  // where cmgen ends

struct Blur {
  const char* id;
  double roughness;
  int size;  ///< texels along an edge, as the mips of a chain of 256 have them
};

constexpr Blur kBlurs[] = {{"0.15", 0.15, 128}, {"0.30", 0.30, 64}, {"0.55", 0.55, 32}, {"1.00", 1.00, 16}};

/// One way to do it, but for size and roughness.
struct Way {
  std::string method;
  std::string setting;
  PrefilterOptions options;
};

std::vector<int> sample_counts(int most) {
  std::vector<int> counts;
  for (int samples = 16; samples <= most; samples *= 4) counts.push_back(samples);
  return counts;
}

std::vector<Way> ways(const Scale& scale) {
  std::vector<Way> all;
  for (const PrefilterMethod method : {PrefilterMethod::automatic, PrefilterMethod::spectral}) {
    for (const double bound : {1e-1, 1e-2, 1e-3, 1e-4}) {
      PrefilterOptions options;
      options.method = method;
      options.rms_error = bound;
      options.maximum_error = 10.0 * bound;
      all.push_back({name(method), "bound " + percent(bound), options});
    }
  }
  for (const int samples : sample_counts(scale.most_samples)) {
    PrefilterOptions options;
    options.method = PrefilterMethod::sampled;
    options.samples = samples;
    all.push_back({name(options.method), std::to_string(samples) + " taps", options});
  }
  return all;
}

/// The truth of a chain's mips at the same places for every method.
class ChainTruth {
 public:
  ChainTruth(LatLongView source, int probes) : source_(source), count_(probes) {}

  /// Over the mips that are not copies; `roughness` has one entry a mip.
  ErrorNorms errors(const CubemapChain& chain, const std::vector<double>& roughness) {
    std::vector<ErrorNorms> mips;
    for (int level = 0; level < chain.levels(); ++level) {
      const double here = roughness[static_cast<std::size_t>(level)];
      if (here > 0.0)
        mips.push_back(errors_at(chain, level, probes(chain, level), truth(chain, level, here), mean()).norms);
    }
    return together(mips);
  }

 private:
  const std::vector<Probe>& probes(const CubemapChain& chain, int level) {
    const auto index = static_cast<std::size_t>(level);
    if (probes_.size() <= index) probes_.resize(index + 1);
    if (probes_[index].empty()) probes_[index] = probes_of(chain, level, count_, random_);
    return probes_[index];
  }

  const std::vector<glm::dvec3>& truth(const CubemapChain& chain, int level, double roughness) {
    const auto index = static_cast<std::size_t>(level);
    if (truths_.size() <= index) truths_.resize(index + 1);
    if (truths_[index].empty()) {
      truths_[index] =
          reference_specular(source_, roughness, directions_of(probes(chain, level), chain.level_size(level)));
    }
    return truths_[index];
  }

  const glm::dvec3& mean() {
    if (!mean_) mean_ = average_radiance(project(source_).radiance);
    return *mean_;
  }

  LatLongView source_;
  int count_;
  std::mt19937 random_{11};
  std::vector<std::vector<Probe>> probes_;
  std::vector<std::vector<glm::dvec3>> truths_;
  std::optional<glm::dvec3> mean_;
};

/// None where no method reaches the bounds.
template <typename Source>
std::optional<Measurement> measured(const Way& way, const Stopwatch& stopwatch, ChainTruth& truth,
                                    const Source& prefilter) {
  try {
    PrefilteredSpecular result;
    const double seconds = stopwatch.seconds([&] { result = prefilter(way.options); });
    std::vector<double> roughness;
    for (const MipRecord& mip : result.mips) roughness.push_back(mip.roughness);
    const ErrorNorms errors = truth.errors(result.cubemap, roughness);
    return Measurement{"", way.method, way.setting, errors.rms, errors.maximum, seconds, kTruth};
  } catch (const Error& error) {
    if (error.code() != ErrorCode::limit_exceeded) throw;
    return std::nullopt;
  }
}

std::vector<Measurement> one_roughness(const PassContext& context, const Blur& blur) {
  const LatLongView source = context.environment.image.view();
  ChainTruth truth(source, context.scale.probes);
  const std::vector<Way> all_ways = ways(context.scale);
  std::vector<Measurement> all;
  for (std::size_t k = 0; k < all_ways.size(); ++k) {
    const auto one = measured(all_ways[k], context.stopwatch, truth, [&](PrefilterOptions options) {
      options.size = blur.size * context.scale.chain_size / 256;
      options.mips = 1;
      options.roughness = {blur.roughness};
      return prefilter_specular(source, options);
    });
    if (one) all.push_back(*one);
    progress(context, k + 1, all_ways.size());
  }
  return all;
}

std::vector<Measurement> whole_chain(const PassContext& context) {
  const Environment read = read_environment(context.file);
  ChainTruth truth(read.lat_long(), context.scale.probes);
  const int size = context.scale.chain_size;
  const int mips = full_chain_levels(size) - full_chain_levels(kSmallestMip) + 1;
  const std::vector<double> roughness = roughness_of_mips(RoughnessSchedule::filament, mips, size);
  std::vector<Measurement> all;
  for (const Way& way : ways(context.scale)) {
    const auto one = measured(way, context.stopwatch, truth, [&](PrefilterOptions options) {
      options.size = size;
      options.mips = mips;
      options.roughness = roughness;
      return prefilter_specular(read_environment(context.file).lat_long(), options);
    });
    if (one) all.push_back(*one);
  }
  progress(context, 2, 3);
  const std::vector<int> samples = sample_counts(std::min(context.scale.most_samples, 1024));
  for (const PeerChain& peer :
       context.peers.prefilter_file(context.file, size, samples, context.folder, context.stopwatch)) {
    const ErrorNorms errors = truth.errors(peer.cubemap, roughness);
    all.push_back(
        {"", "importance sampling", peer.setting, errors.rms, errors.maximum, peer.seconds, kTruth, peer.peer});
  }
  return all;
}

constexpr const char* kErrors =
    "rms: of the difference over that of the truth, by solid angle. Maximum: the largest |value - truth| / truth of a "
    "texel.";

}  // namespace

std::vector<PassRunner> prefilter_passes() {
  std::vector<PassRunner> all;
  for (const Blur& blur : kBlurs) {
    all.push_back({{std::string("prefilter-") + blur.id, std::string("Reflections at roughness ") + blur.id,
                    "One mip of a specular cubemap from a lat-long in memory, made alone; its size is a chain's at "
                    "that roughness.",
                    kErrors},
                   3.0,
                   [blur](const PassContext& context) { return one_roughness(context, blur); }});
  }
  all.push_back(
      {{"prefilter-file", "Reflections, a chain from a file",
        "A specular chain down to 16 texels, roughness spread as Filament has it, from a Radiance .hdr file, reading "
        "included. Of cmgen the whole process counts, with writing the levels as OpenEXR.",
        std::string(kErrors) + " Over the blurred mips: root mean square, largest."},
       8.0,
       whole_chain});
  return all;
}

}  // namespace welkin::report
