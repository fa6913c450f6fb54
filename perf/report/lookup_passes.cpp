#include "image/geometry.h"
#include "image/resampling.h"
#include "perf/report/passes.h"
#include "reflections/lookups.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"

namespace welkin::report {
namespace {

/// Returns a uniform unit vector from two numbers in [0, 1).
glm::dvec3 anywhere(double u, double v) {
  const double y = 1.0 - 2.0 * u;
  const double level = std::sqrt(std::max(0.0, 1.0 - y * y));
  const double azimuth = 2.0 * std::numbers::pi * v;
  return {level * std::sin(azimuth), y, level * std::cos(azimuth)};
}

/// Draws numbers in [0, 1), the same on every platform.
class Draw {
 public:
  double operator()() { return static_cast<double>(random_()) / 4294967296.0; }

 private:
  std::mt19937 random_{23};
};

/// Draws directions in proportion to the blurred luminance: a texel by its light, then a direction of the lobe around
/// it.
class LightDirections {
 public:
  explicit LightDirections(const LatLongView& source) : source_(source) {
    double sum = 0.0;
    for (int row = 0; row < source.height; ++row) {
      const double steradians = image::lat_long_texel_solid_angle(source.width, source.height, row);
      const auto* const rgb = static_cast<const float*>(source.pixels) + std::ptrdiff_t{3} * row * source.width;
      for (int column = 0; column < source.width; ++column)
        sums_.push_back(sum +=
                        steradians * luminance(glm::dvec3(rgb[3 * column], rgb[3 * column + 1], rgb[3 * column + 2])));
    }
  }

  static double luminance(const glm::dvec3& light) { return std::max(0.0, light.x + light.y + light.z) / 3.0; }

  [[nodiscard]] double mean() const { return sums_.back() / (4.0 * std::numbers::pi); }

  glm::dvec3 operator()(Draw& draw, double roughness) const {
    const auto texel = std::lower_bound(sums_.begin(), sums_.end() - 1, draw() * sums_.back()) - sums_.begin();
    const auto row = static_cast<int>(texel / source_.width);
    const auto column = static_cast<int>(texel % source_.width);
    const double x = column + draw();
    const double y = row + draw();
    const glm::dvec3 light = image::lat_long_direction(source_.width, source_.height, x, y);
    const glm::dvec3 other = std::abs(light.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(other, light));
    const glm::dvec3 v = glm::cross(light, u);
    const double alpha2 = std::pow(roughness, 4);
    for (;;) {
      const double share = draw();
      const double cosine = (1.0 - share - alpha2 * share) / (1.0 - share + alpha2 * share);
      const double azimuth = 2.0 * std::numbers::pi * draw();
      if (draw() >= cosine) continue;  // the lobe is weighted by the cosine
      const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
      return light * cosine + (u * std::cos(azimuth) + v * std::sin(azimuth)) * sine;
    }
  }

 private:
  LatLongView source_;
  std::vector<double> sums_;  ///< cumulative light of the texels
};

}  // namespace

glm::dvec3 lookup(const Cubemap& chain, int level, const glm::dvec3& direction) {
  glm::dvec3 light(0.0);
  image::CubemapSampler(chain.view(level)).add(direction, 1.0, light);
  return light;
}

glm::dvec3 lookup(const Cubemap& chain, double level, const glm::dvec3& direction) {
  const int first = std::clamp(static_cast<int>(level), 0, chain.levels() - 1);
  const int second = std::min(first + 1, chain.levels() - 1);
  return glm::mix(lookup(chain, first, direction), lookup(chain, second, direction),
                  std::clamp(level - first, 0.0, 1.0));
}

LookupTruth::LookupTruth(const LatLongView& source, int directions) {
  const LightDirections by_light(source);
  Draw draw;
  for (int k = 0; k < kRoughnesses; ++k) {
    const double roughness = (k + 0.5) / kRoughnesses;
    std::vector<glm::dvec3> all;
    for (int i = 0; i < directions; i += 2) {
      const double height = (0.5 * i + draw()) / (0.5 * directions + 1.0);
      all.push_back(anywhere(height, draw()));
      all.push_back(by_light(draw, roughness));
    }
    const std::vector<glm::dvec3> truths = reference_specular(source, roughness, all);
    std::vector<Sample>& samples = samples_.emplace_back();
    for (std::size_t i = 0; i < all.size(); ++i)
      samples.push_back({all[i], truths[i], 1.0 / (1.0 + LightDirections::luminance(truths[i]) / by_light.mean())});
  }
}

ErrorNorms LookupTruth::errors(const Cubemap& chain, RoughnessSchedule schedule) const {
  ErrorNorms norms;
  for (int k = 0; k < kRoughnesses; ++k) {
    const double roughness = (k + 0.5) / kRoughnesses;
    const double mip = reflections::mip_by_formula(schedule, roughness, chain.levels(), chain.level_size(0));
    double error = 0.0;
    double whole = 0.0;
    for (const Sample& sample : samples_[static_cast<std::size_t>(k)]) {
      const glm::dvec3 off = lookup(chain, mip, sample.direction) - sample.truth;
      error += sample.weight * glm::dot(off, off);
      whole += sample.weight * glm::dot(sample.truth, sample.truth);
    }
    norms.rms += error / whole / kRoughnesses;
    norms.maximum = std::max(norms.maximum, std::sqrt(error / whole));
  }
  norms.rms = std::sqrt(norms.rms);
  return norms;
}

namespace {

constexpr const char* kTruth = "the integral over all texels in double, in some directions";
constexpr double kBounds[] = {1e-2, 1e-3, 1e-4};
constexpr int kSamples[] = {64, 1024};  // for cmgen

struct Chain {
  const char* method;
  RoughnessSchedule schedule;
  int smallest;  ///< texels along an edge of its last mip
  bool fitted;   ///< lobes are fitted to lookups
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
    PrefilterOptions options{.size = size, .mips = mips};
    options.use_schedule(chain.schedule, chain.fitted);
    for (const double bound : kBounds) {
      options.rms_error = bound;
      const auto call = [&] { return prefilter_specular(read_environment(context.file).lat_long(), options).cubemap; };
      all.push_back(measured(chain.method, words_of(mips, bound), context.stopwatch, kTruth, call,
                             [&](const Cubemap& found) { return truth.errors(found, chain.schedule); }));
    }
  }
  progress(context, 2, 3);
  add_peers(all, context.peers.prefilter_file(context.file, size, kSamples), kTruth,
            [&](const PeerChain& found) { return truth.errors(found.cubemap, found.schedule); });
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
