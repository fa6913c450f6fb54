// The passes about reflections: error against time from the integral in double to the loosest bound, warm and in first
// calls, next to importance sampling and cmgen.

#include "perf/report/passes.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::report {
namespace {

constexpr const char* kTruth = "the integral over all texels in double, at some of the result's texels";
constexpr const char* kFromFile = "prefilter-file";
constexpr const char* kFromCube = "prefilter-cube";
constexpr int kSmallestOfCmgen = 16;  // texels along an edge of its last mip
constexpr int kFirstCalls = 3;        // the shortest counts
constexpr double kBounds[] = {3e-2, 1e-2, 3e-3, 1e-3, 1e-4, 1e-5};

struct Blur {
  const char* id;
  double roughness;
  int size;  ///< texels along an edge, as the mips of a chain of 256 have them
};

constexpr Blur kBlurs[] = {{"0.15", 0.15, 128}, {"0.30", 0.30, 64}, {"0.55", 0.55, 32}, {"1.00", 1.00, 16}};

constexpr const char* kSampling = "importance sampling";

std::string sample_words(int samples) { return std::to_string(samples) + " samples"; }

std::vector<int> sample_counts(int most) {
  std::vector<int> counts;
  for (int samples = 16; samples <= most; samples *= 4) counts.push_back(samples);
  return counts;
}

std::string bound_words(double bound) { return "bound " + percent(bound); }

/// The image to blur, of either kind.
struct Source {
  std::function<Cubemap(const PrefilterOptions&)> prefilter;
  std::function<std::vector<glm::dvec3>(double roughness, const std::vector<glm::dvec3>&)> integral;
  glm::dvec3 mean{};
};

template <typename View>
Source source_of(const View& view) {
  return {[view](const PrefilterOptions& options) { return prefilter_specular(view, options).cubemap; },
          [view](double roughness, const std::vector<glm::dvec3>& directions) {
            return reference_specular(view, roughness, directions);
          },
          mean_radiance(project(view).radiance)};
}

/// The reference of chains' mips at the same texels for every method.
class ChainTruth {
 public:
  ChainTruth(Source source, int probes) : source_(std::move(source)), count_(probes) {}

  /// Returns the errors over the mips that are not copies; `roughness` has one entry per mip.
  ErrorNorms errors(const Cubemap& chain, const std::vector<double>& roughness) {
    std::vector<ErrorNorms> mips;
    for (int level = 0; level < chain.levels(); ++level) {
      if (roughness[static_cast<std::size_t>(level)] <= 0.0) continue;
      const Mip& mip = at(chain, level, roughness);
      mips.push_back(errors_at(chain, level, mip.probes, mip.truth, source_.mean).norms);
    }
    return together(mips);
  }

  /// Measures the integral itself, as floats: its error is that of rounding. Its time is that of a few probes, in
  /// proportion to all texels.
  Measurement reference(const PrefilterOptions& shape, const Stopwatch& stopwatch) {
    const std::vector<double>& roughness = shape.roughness;
    Cubemap like(shape.size, static_cast<int>(roughness.size()));
    double seconds = 0.0;
    Stopwatch once = stopwatch;
    once.most_runs = 1;
    for (int level = 0; level < like.levels(); ++level) {
      const double here = roughness[static_cast<std::size_t>(level)];
      if (here <= 0.0) continue;
      const Mip& mip = at(like, level, roughness);
      const int size = like.level_size(level);
      const std::vector<glm::dvec3> few(
          mip.directions.begin(),
          mip.directions.begin() + std::min<std::ptrdiff_t>(kTimed, std::ssize(mip.directions)));
      seconds += once.seconds([&] { (void)source_.integral(here, few); }) * 6.0 * size * size /
                 static_cast<double>(few.size());
      for (std::size_t k = 0; k < mip.probes.size(); ++k) {
        const auto truth = glm::vec3(mip.truth[k]);
        std::copy_n(&truth.x, 3, like.face(level, 0) + 3 * mip.probes[k].texel);
      }
    }
    return measurement("the integral in double", "reference", errors(like, roughness), seconds, kTruth);
  }

 private:
  static constexpr std::ptrdiff_t kTimed = 24;  // probes

  struct Mip {
    std::vector<Probe> probes;
    std::vector<glm::dvec3> directions;
    std::vector<glm::dvec3> truth;
  };

  const Mip& at(const Cubemap& chain, int level, const std::vector<double>& roughness) {
    const double here = roughness[static_cast<std::size_t>(level)];
    Mip& mip = mips_[{chain.level_size(level), here}];
    if (mip.probes.empty()) {
      mip.probes = probes_of(chain, level, count_, random_);
      mip.directions = directions_of(mip.probes, chain.level_size(level));
      mip.truth = source_.integral(here, mip.directions);
    }
    return mip;
  }

  Source source_;
  int count_;
  std::mt19937 random_{11};
  std::map<std::pair<int, double>, Mip> mips_;  ///< by size and roughness
};

/// Measures Welkin with each of its bounds, from the tightest one on; none for a bound that no method reaches. `shape`:
/// size and roughness of each mip. `call`: the timed call.
std::vector<Measurement> by_bound(const Stopwatch& stopwatch, ChainTruth& truth, const PrefilterOptions& shape,
                                  const std::function<Cubemap(const PrefilterOptions&)>& call) {
  std::vector<Measurement> all;
  for (const double bound : kBounds) {
    try {
      PrefilterOptions options = shape;
      options.rms_error = bound;
      all.push_back(measured(
          name(PrefilterMethod::automatic), bound_words(bound), stopwatch, kTruth, [&] { return call(options); },
          [&](const Cubemap& found) { return truth.errors(found, options.roughness); }));
    } catch (const Error& error) {
      if (error.code() != ErrorCode::limit_exceeded) throw;
    }
  }
  return all;
}

std::vector<Measurement> by_samples(const PassContext& context, ChainTruth& truth, const PrefilterOptions& shape) {
  std::vector<Measurement> all;
  const LatLongView source = context.environment.image.view();
  for (const int samples : sample_counts(context.scale.most_samples)) {
    all.push_back(measured(
        kSampling, sample_words(samples), context.stopwatch, kTruth,
        [&] { return importance_sampled(source, shape.size, shape.roughness, samples); },
        [&](const Cubemap& found) { return truth.errors(found, shape.roughness); }));
    all.back().peer = kSamplingPeer;
  }
  return all;
}

std::vector<Measurement> one_roughness(const PassContext& context, const Blur& blur) {
  const Source source = source_of(context.environment.image.view());
  ChainTruth truth(source, context.scale.probes);
  const PrefilterOptions shape{.size = blur.size * context.scale.chain_size / 256, .roughness = {blur.roughness}};
  std::vector<Measurement> all = by_bound(context.stopwatch, truth, shape, source.prefilter);
  progress(context, 1, 3);
  for (Measurement& one : by_samples(context, truth, shape)) all.push_back(std::move(one));
  return all;
}

/// Returns the chain of a pass: down to cmgen's last size, or the default one.
PrefilterOptions shape_of(const std::string& pass, int size) {
  PrefilterOptions shape{.size = size};
  if (pass == kFromFile) shape.mips = full_chain_levels(size) - full_chain_levels(kSmallestOfCmgen) + 1;
  shape.use_schedule(RoughnessSchedule::filament);
  return shape;
}

/// Returns the timed call of a pass about a chain. A lat-long's file is read in each call, a cubemap's before them.
std::function<Cubemap(const PrefilterOptions&)> call_of(const std::string& pass, const std::filesystem::path& file) {
  if (pass == kFromFile) {
    return [file](const PrefilterOptions& options) {
      return prefilter_specular(read_environment(file).lat_long(), options).cubemap;
    };
  }
  const auto cube = std::make_shared<const Environment>(read_environment(file));
  return [cube](const PrefilterOptions& options) { return prefilter_specular(cube->cubemap(), options).cubemap; };
}

/// Measures the settings of `warm` in the first call of a process, which makes tables and gets memory from the system.
std::vector<Measurement> first_calls(const PassContext& context, const std::string& pass,
                                     const std::filesystem::path& file, const std::vector<Measurement>& warm) {
  std::vector<Measurement> all;
  if (context.program.empty()) return all;
  const std::filesystem::path output = context.folder / "first_call.txt";
  for (const double bound : kBounds) {
    const auto found = std::find_if(warm.begin(), warm.end(),
                                    [&](const Measurement& one) { return one.setting == bound_words(bound); });
    if (found == warm.end()) continue;  // no method reached it
    const std::vector<std::string> arguments{context.program.string(),
                                             kFirstCall,
                                             pass,
                                             file.string(),
                                             std::to_string(context.scale.chain_size),
                                             std::to_string(bound),
                                             std::to_string(context.stopwatch.threads)};
    Measurement first = *found;
    first.peer = "first call of a process";
    first.seconds = HUGE_VAL;
    for (int run = 0; run < kFirstCalls; ++run) {
      const ProcessResult result = run_process(arguments, context.stopwatch.threads, context.stopwatch.clock(), output);
      double seconds = 0.0;
      if (result.exit_code == 0 && std::ifstream(output) >> seconds) first.seconds = std::min(first.seconds, seconds);
    }
    if (std::isfinite(first.seconds)) all.push_back(first);
  }
  return all;
}

std::vector<Measurement> chain(const PassContext& context, const std::string& pass, const Source& source,
                               const std::filesystem::path& file) {
  ChainTruth truth(source, context.scale.probes);
  const PrefilterOptions shape = shape_of(pass, context.scale.chain_size);
  std::vector<Measurement> all = by_bound(context.stopwatch, truth, shape, call_of(pass, file));
  progress(context, 1, 3);
  for (Measurement& one : first_calls(context, pass, file, all)) all.push_back(std::move(one));
  all.push_back(truth.reference(shape, context.stopwatch));
  progress(context, 2, 3);
  const std::vector<int> samples = sample_counts(std::min(context.scale.most_samples, 1024));
  const auto errors_of = [&](const PeerChain& found) {
    const Cubemap& chain = found.cubemap;
    return truth.errors(chain, mip_roughness(found.schedule, chain.levels(), chain.level_size(0)));
  };
  if (pass == kFromFile) {
    add_peers(all, context.peers.prefilter_file(file, shape.size, samples), kTruth, errors_of);
  } else {
    const Environment cube = read_environment(file);
    const int mips = static_cast<int>(shape.roughness.size());
    add_peers(all, context.peers.prefilter_cube(cube.cubemap(), mips, samples), kTruth, errors_of);
  }
  return all;
}

std::vector<Measurement> from_file(const PassContext& context) {
  return chain(context, kFromFile, source_of(read_environment(context.file).lat_long()), context.file);
}

std::vector<Measurement> from_cube(const PassContext& context) {
  const Cubemap cube = to_cubemap(context.environment.image.view(), context.scale.chain_size);
  const std::filesystem::path file = context.folder / "cube.pfm";
  write_environment(file, cube.view());
  return chain(context, kFromCube, source_of(cube.view()), file);
}

constexpr const char* kErrors =
    "rms: rms of the difference over that of the reference, by solid angle. Maximum: largest relative error of a "
    "texel.";
constexpr const char* kOverMips = " Over the blurred mips: root mean square, largest.";
constexpr const char* kOfReference =
    " First calls are those of a new process. The integral's time is that of some texels in proportion, its error that "
    "of floats.";

}  // namespace

double first_call_seconds(std::span<const std::string> arguments) {
  if (arguments.size() != 5) throw Error(ErrorCode::invalid_argument, "a first call takes five arguments");
  PrefilterOptions options = shape_of(arguments[0], std::stoi(arguments[2]));
  options.rms_error = std::stod(arguments[3]);
  const auto call = call_of(arguments[0], arguments[1]);
  return Stopwatch{std::stoi(arguments[4]), 0.0, 1}.seconds([&] { (void)call(options); });
}

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
      {{kFromFile, "Reflections, a chain from a file",
        std::string("A specular chain down to 16 texels, roughness spread as Filament has it, from a Radiance .hdr "
                    "file, reading included. For cmgen, the time is that of the process, which writes OpenEXR.") +
            kOfReference,
        std::string(kErrors) + kOverMips},
       8.0,
       from_file});
  all.push_back({{kFromCube, "Reflections, a chain from a captured cubemap",
                  std::string("The default specular chain, down to 4 texels, from a cubemap of the same size in "
                              "memory: a reflection probe.") +
                      kOfReference,
                  std::string(kErrors) + kOverMips},
                 8.0,
                 from_cube});
  return all;
}

}  // namespace welkin::report
