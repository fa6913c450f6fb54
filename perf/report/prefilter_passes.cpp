#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "perf/report/error_norms.h"
#include "perf/report/importance_sampling.h"
#include "perf/report/passes.h"
#include "perf/report/words.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"

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
  int samples = 0;  ///< of importance sampling, which is not the library's; 0: the library prefilters
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
    all.push_back({"importance sampling", std::to_string(samples) + " samples", {}, samples});
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
    if (!mean_) mean_ = mean_radiance(project(source_).radiance);
    return *mean_;
  }

  LatLongView source_;
  int count_;
  std::mt19937 random_{11};
  std::vector<std::vector<Probe>> probes_;
  std::vector<std::vector<glm::dvec3>> truths_;
  std::optional<glm::dvec3> mean_;
};

/// None where no method reaches the bounds. `shape`: size and roughness of each mip. `read` gives the lat-long's view,
/// whose time counts.
template <typename Read>
std::optional<Measurement> measured(const Way& way, const Stopwatch& stopwatch, ChainTruth& truth,
                                    const PrefilterOptions& shape, const Read& read) {
  try {
    PrefilterOptions options = way.options;
    options.size = shape.size;
    options.roughness = shape.roughness;
    CubemapChain result;
    const double seconds = stopwatch.seconds([&] {
      result = way.samples > 0 ? importance_sampled(read(), options.size, options.roughness, way.samples)
                               : prefilter_specular(read(), options).cubemap;
    });
    const ErrorNorms errors = truth.errors(result, options.roughness);
    return Measurement{
        "", way.method, way.setting, errors.rms, errors.maximum, seconds, kTruth, way.samples > 0 ? kSamplingPeer : ""};
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
    const PrefilterOptions shape{.size = blur.size * context.scale.chain_size / 256, .roughness = {blur.roughness}};
    const auto one = measured(all_ways[k], context.stopwatch, truth, shape, [&] { return source; });
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
    std::optional<Environment> picture;
    const auto one = measured(way, context.stopwatch, truth, {.size = size, .roughness = roughness},
                              [&] { return picture.emplace(read_environment(context.file)).lat_long(); });
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

namespace {

constexpr const char* kTableTruth = "a finer table's texels, each within 1e-5";
constexpr int kRuns = 3;

/// Two channels of a table, to be looked up as a shader does.
struct Lookup {
  const float* values;
  int width, height, channels;

  [[nodiscard]] double at(int column, int row, int channel) const {
    const int x = std::clamp(column, 0, width - 1);
    const int y = std::clamp(row, 0, height - 1);
    return static_cast<double>(values[(static_cast<std::ptrdiff_t>(y) * width + x) * channels + channel]);
  }

  /// Bilinear, clamped to the edge; both coordinates in [0, 1].
  [[nodiscard]] double linear(double across, double down, int channel) const {
    const double x = across * width - 0.5;
    const double y = down * height - 0.5;
    const int column = static_cast<int>(std::floor(x));
    const int row = static_cast<int>(std::floor(y));
    const double right = x - column;
    const double below = y - row;
    return (1.0 - below) * ((1.0 - right) * at(column, row, channel) + right * at(column + 1, row, channel)) +
           below * ((1.0 - right) * at(column, row + 1, channel) + right * at(column + 1, row + 1, channel));
  }
};

Lookup lookup(const BrdfTable& table) {
  return {table.values.data(), table.options.width, table.options.height, table.channels};
}

ErrorNorms errors_of(const Lookup& table, const BrdfTable& truth) {
  const Lookup exact = lookup(truth);
  double squares = 0.0;
  double whole = 0.0;
  double largest = 0.0;
  for (int row = 0; row < exact.height; ++row) {
    for (int column = 0; column < exact.width; ++column) {
      for (int channel = 0; channel < 2; ++channel) {
        const double expected = exact.at(column, row, channel);
        const double error = table.linear((column + 0.5) / exact.width, (row + 0.5) / exact.height, channel) - expected;
        squares += error * error;
        whole += expected * expected;
        largest = std::max(largest, std::abs(error));
      }
    }
  }
  return {std::sqrt(squares / whole), largest};
}

/// Tables are kept once made: neighbours a column or two wider stand in for repeats, their time in proportion.
double seconds_of(BrdfTableOptions options, const Stopwatch& stopwatch) {
  Stopwatch once = stopwatch;
  once.most_runs = 1;
  const int width = options.width;
  double fastest = HUGE_VAL;
  for (int run = 1; run <= kRuns; ++run) {
    options.width = width + run;
    fastest = std::min(fastest, once.seconds([&] { (void)brdf_table(options); }) * width / options.width);
  }
  return fastest;
}

std::string size_words(int size) { return std::to_string(size) + " x " + std::to_string(size); }

std::vector<Measurement> by_size(const PassContext& context, BrdfModel model) {
  const int fine = context.scale.table_truth;
  std::vector<int> sizes;
  for (int size = 8; size <= context.scale.largest_table; size *= 2) sizes.push_back(size);
  const auto truth = brdf_table({fine, fine, model, false});
  std::vector<Measurement> all;
  for (const int size : sizes) {
    const BrdfTableOptions options{size, size, model, false};
    const ErrorNorms errors = errors_of(lookup(*brdf_table(options)), *truth);
    all.push_back({"", "table", size_words(size), errors.rms, errors.maximum, seconds_of(options, context.stopwatch),
                   kTableTruth});
    progress(context, all.size(), sizes.size() + 1);
  }
  if (model != BrdfModel::multiple_scattering) return all;
  for (const PeerTable& peer : context.peers.brdf_table(sizes, context.folder, context.stopwatch)) {
    const ErrorNorms errors = errors_of({peer.values.data(), peer.size, peer.size, 3}, *truth);
    all.push_back(
        {"", "table", size_words(peer.size), errors.rms, errors.maximum, peer.seconds, kTableTruth, peer.peer});
  }
  return all;
}

PassRunner runner(const char* id, const char* title, const char* holds, BrdfModel model) {
  return {{id, title,
           std::string("A table of ") + holds +
               ", without sheen, made anew. Its error is that of looking it up with linear interpolation. Of cmgen the "
               "whole process counts.",
           "rms: of the difference over that of the truth. Maximum: the largest difference."},
          1.0,
          [model](const PassContext& context) { return by_size(context, model); }};
}

}  // namespace

std::vector<PassRunner> brdf_passes() {
  return {runner("brdf-split-sum", "BRDF table, split sum", "scale and bias", BrdfModel::split_sum),
          runner("brdf-multiple", "BRDF table, multiple scattering", "bias and whole albedo",
                 BrdfModel::multiple_scattering)};
}

}  // namespace welkin::report
