#include "support/estimate_trials.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "image/geometry.h"
#include "reference/reference_projection.h"
#include "support/random_environments.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

constexpr int kProbes = 24;         ///< texels of a mip that are held to the truth
constexpr double kRounding = 1e-7;  ///< true errors below this say nothing of how careful an estimate is

double distance_between(const SphericalHarmonics& found, const SphericalHarmonics& truth) {
  double squares = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < truth.coefficients().size(); ++k) {
    const glm::dvec3 difference = found.coefficients()[k] - truth.coefficients()[k];
    squares += glm::dot(difference, difference);
    whole += glm::dot(truth.coefficients()[k], truth.coefficients()[k]);
  }
  return whole > 0.0 ? std::sqrt(squares / whole) : 0.0;
}

class Trial {
 public:
  Trial(std::uint32_t seed, double least_roughness, RandomEnvironments& random, EstimateTrials& trials)
      : seed_(seed), least_roughness_(least_roughness), random_(random), trials_(trials) {}

  template <class View>
  void run(const View& view, const std::string& layout) {
    project_it(view, layout);
    prefilter_it(view, layout);
  }

 private:
  void add(const std::string& kind, double truth, double estimate, const std::string& more) {
    auto& honesty = trials_[kind];
    if (!honesty) honesty = std::make_unique<Honesty>(kind);
    honesty->add(truth, estimate, "seed " + std::to_string(seed_) + ", " + random_.description() + more, kRounding);
  }

  template <class View>
  void project_it(const View& view, const std::string& layout) {
    const SphericalHarmonics truth = reference_projection(view);
    ProjectionOptions options;
    std::string kind = "projection, exact";
    if (random_.chance(0.3)) {
      options.quadrature = Quadrature::midpoint;
      kind = "projection, midpoint rule";
    } else if (random_.chance(0.4)) {
      options.target_size = random_.whole(2, 12);
      kind = "projection, target size";
    }
    const Projection projection = project(view, options);
    add(kind + ", " + layout, distance_between(projection.radiance, truth), projection.diagnostics.error_estimate, "");
  }

  template <class View>
  void prefilter_it(const View& view, const std::string& layout) {
    PrefilterOptions options{.size = 1 << random_.whole(2, 6), .mips = 1};
    options.roughness = {random_.scale(least_roughness_, 1.0)};
    const PrefilteredSpecular result = prefilter_specular(view, options);
    for (std::size_t level = 0; level < result.mips.size(); ++level) {
      const MipRecord& mip = result.mips[level];
      if (mip.error_estimate.value_or(0.0) == 0.0) continue;
      const double truth = rms_error(view, result.cubemap, static_cast<int>(level), mip.roughness);
      add(std::string("prefilter, ") + name(mip.method) + ", " + layout, truth, *mip.error_estimate,
          " roughness " + std::to_string(mip.roughness) + ", " + std::to_string(mip.size) + " texels");
    }
  }

  /// By solid angle, at random texels of a level.
  template <class View>
  double rms_error(const View& view, const CubemapChain& chain, int level, double roughness) {
    const int size = chain.level_size(level);
    const int texels = 6 * size * size;
    std::vector<int> probes;
    for (int k = 0; k < std::min(texels, kProbes); ++k)
      probes.push_back(texels <= kProbes ? k : random_.whole(0, texels - 1));
    std::vector<glm::dvec3> directions;
    for (const int texel : probes) {
      const int row = texel / size;
      directions.push_back(image::face_direction(size, row / size, texel % size + 0.5, row % size + 0.5));
    }
    const std::vector<glm::dvec3> truth = reference_specular(view, roughness, directions);
    double squares = 0.0;
    double whole = 0.0;
    for (std::size_t k = 0; k < probes.size(); ++k) {
      const double longest =
          std::max({std::abs(directions[k].x), std::abs(directions[k].y), std::abs(directions[k].z)});
      const double weight = longest * longest * longest;  // a texel's solid angle falls with its distance's cube
      const float* const found = chain.face(level, 0) + std::ptrdiff_t{3} * probes[k];
      const glm::dvec3 difference = glm::dvec3(found[0], found[1], found[2]) - truth[k];
      squares += weight * glm::dot(difference, difference);
      whole += weight * glm::dot(truth[k], truth[k]);
    }
    return whole > 0.0 ? std::sqrt(squares / whole) : 0.0;
  }

  std::uint32_t seed_;
  double least_roughness_;
  RandomEnvironments& random_;
  EstimateTrials& trials_;
};

CubemapImage picture_of(const std::vector<CubemapImage>& pictures, RandomEnvironments& random) {
  const CubemapImage& picture =
      pictures[static_cast<std::size_t>(random.whole(0, static_cast<int>(pictures.size()) - 1))];
  return to_cubemap(picture.view(), random.whole(6, 20), turn_about_y(random.between(0.0, 360.0)));
}

}  // namespace

void add_estimate_trials(std::uint32_t seed, int count, double least_roughness,
                         const std::vector<CubemapImage>& pictures, EstimateTrials& trials) {
  for (std::uint32_t own = seed; own < seed + static_cast<std::uint32_t>(count); ++own) {
    RandomEnvironments random(own);
    const bool real = !pictures.empty() && random.chance(0.2);
    const double exposure = random.chance(0.2) ? random.scale(1e-6, 1e-2) : 1.0;
    const auto expose = [&](std::vector<float>& pixels) {
      for (float& value : pixels) value *= static_cast<float>(exposure);
    };
    CubemapImage cube;
    if (real) cube = picture_of(pictures, random);
    if (random.chance(0.5)) {
      if (!real) cube = random.cubemap(4, 20);
      expose(cube.pixels);
      Trial(own, least_roughness, random, trials).run(cube.view(), "cubemap");
    } else {
      LatLongImage image;
      if (real) {
        image = to_lat_long(cube.view(), 4 * cube.size, 2 * cube.size);
      } else {
        image = random.lat_long(6, 32);
      }
      expose(image.pixels);
      Trial(own, least_roughness, random, trials).run(image.view(), "lat-long");
    }
  }
}

}  // namespace welkin::test
