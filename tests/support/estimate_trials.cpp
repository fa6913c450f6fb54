#include "support/estimate_trials.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <numbers>

#include "image/geometry.h"
#include "reference/reference_projection.h"
#include "support/random_environments.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

constexpr int kProbes = 96;         ///< texels per mip compared with the reference; all, in mips of up to 192 texels
constexpr double kRounding = 1e-7;  ///< true errors below this do not show how conservative an estimate is

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

/// Texels of a mip, and the weight of each in a mean over all.
struct Probes {
  std::vector<int> texels;
  std::vector<glm::dvec3> directions;
  std::vector<double> weights;  ///< their sum is 1 for all texels; for a sample it is 1 in the mean
};

glm::dvec3 direction_of(int size, int texel) {
  const int row = texel / size;
  return image::face_direction(size, row / size, texel % size + 0.5, row % size + 0.5);
}

glm::dvec3 value_of(const Cubemap& chain, int level, int texel) {
  const float* const rgb = chain.face(level, 0) + std::ptrdiff_t{3} * texel;
  return {rgb[0], rgb[1], rgb[2]};
}

/// Returns each texel's fraction of the sphere's solid angle.
std::vector<double> shares_of(int size) {
  std::vector<double> shares;
  double whole = 0.0;
  for (int texel = 0; texel < 6 * size * size; ++texel) {
    const glm::dvec3 d = direction_of(size, texel);
    const double longest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    shares.push_back(longest * longest * longest);  // a texel's solid angle falls with its distance's cube
    whole += shares.back();
  }
  for (double& share : shares) share /= whole;
  return shares;
}

/// Returns the sum of the squared differences to the texels on either side within the face.
double gradient_square(const Cubemap& chain, int level, int texel) {
  const int size = chain.level_size(level);
  const int column = texel % size;
  const int row = texel / size % size;
  const glm::dvec3 own = value_of(chain, level, texel);
  double sum = 0.0;
  const auto add = [&](bool inside, int step) {
    if (!inside) return;
    const glm::dvec3 difference = value_of(chain, level, texel + step) - own;
    sum += glm::dot(difference, difference);
  };
  add(column > 0, -1);
  add(column + 1 < size, 1);
  add(row > 0, -size);
  add(row + 1 < size, size);
  return sum;
}

/// A chain's mip: its root mean square, and the squared error at probes.
class MipTruth {
 public:
  /// `probes`: number of texels drawn; a mip of up to twice as many texels has all of them taken.
  MipTruth(const Cubemap& chain, int level, RandomEnvironments& random, int probes = kProbes)
      : chain_(chain), level_(level), count_(probes), shares_(shares_of(chain.level_size(level))) {
    for (std::size_t k = 0; k < shares_.size(); ++k) {
      const glm::dvec3 value = value_of(chain, level, static_cast<int>(k));
      square_ += shares_[k] * glm::dot(value, value);
    }
    if (shares_.size() <= 2 * static_cast<std::size_t>(count_)) {
      for (std::size_t k = 0; k < shares_.size(); ++k) add_probe(k, shares_[k]);
    } else {
      draw(random);
    }
  }

  template <class View>
  [[nodiscard]] double error(const View& view, double roughness) const {
    return error(reference_specular(view, roughness, probes_.directions));
  }
  template <class View>
  [[nodiscard]] double error(const View& view, const ZonalLobe& kernel) const {
    return error(reference_by_lobe(view, kernel, probes_.directions));
  }

 private:
  [[nodiscard]] double error(const std::vector<glm::dvec3>& truth) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const glm::dvec3 difference = value_of(chain_, level_, probes_.texels[k]) - truth[k];
      sum += probes_.weights[k] * glm::dot(difference, difference);
    }
    return square_ > 0.0 ? std::sqrt(sum / square_) : 0.0;
  }

  void add_probe(std::size_t texel, double weight) {
    probes_.texels.push_back(static_cast<int>(texel));
    probes_.directions.push_back(direction_of(chain_.level_size(level_), static_cast<int>(texel)));
    probes_.weights.push_back(weight);
  }

  /// Two fifths of the draws are uniform over the sphere. The others fall where it is bright and where it changes,
  /// because errors lie there.
  void draw(RandomEnvironments& random) {
    std::vector<double> steep;
    double all_steep = 0.0;
    for (std::size_t k = 0; k < shares_.size(); ++k) {
      steep.push_back(shares_[k] * gradient_square(chain_, level_, static_cast<int>(k)));
      all_steep += steep.back();
    }
    std::vector<double> ends;
    double end = 0.0;
    for (std::size_t k = 0; k < shares_.size(); ++k) {
      const glm::dvec3 value = value_of(chain_, level_, static_cast<int>(k));
      end += 0.4 * shares_[k];
      if (square_ > 0.0) end += 0.3 * shares_[k] * glm::dot(value, value) / square_;
      if (all_steep > 0.0) end += 0.3 * steep[k] / all_steep;
      ends.push_back(end);
    }
    const double offset = random.number();
    for (int i = 0; i < count_; ++i) {
      const double place = (i + offset) / count_ * end;
      const auto found = std::min<std::ptrdiff_t>(std::lower_bound(ends.begin(), ends.end(), place) - ends.begin(),
                                                  static_cast<std::ptrdiff_t>(ends.size()) - 1);
      const auto texel = static_cast<std::size_t>(found);
      const double chance = (ends[texel] - (texel > 0 ? ends[texel - 1] : 0.0)) / end;
      add_probe(texel, shares_[texel] / (chance * count_));
    }
  }

  const Cubemap& chain_;
  int level_;
  int count_;
  std::vector<double> shares_;
  double square_ = 0.0;
  Probes probes_;
};

/// Returns a size whose texels are 1/8 to 1.5 times as wide as is needed to show a lobe.
int size_for(double roughness, RandomEnvironments& random) {
  const double wanted = 0.5 * std::numbers::pi / (roughness * roughness) * random.scale(0.125, 1.5);
  const int most = roughness < 0.055 ? 32 : 128;  // narrow mips take 1 us per texel
  int size = 4;
  while (size < most && 1.4 * size < wanted) size *= 2;
  return size;
}

void add_to(EstimateTrials& trials, const std::string& kind, double truth, double estimate, const std::string& where) {
  auto& honesty = trials[kind];
  if (!honesty) honesty = std::make_unique<Honesty>(kind);
  honesty->add(truth, estimate, where, kRounding);
}

class Trial {
 public:
  /// `family`: whether the environment belongs to a `Family`.
  Trial(std::uint32_t seed, bool family, const RoughnessSpan& roughness, RandomEnvironments& random,
        EstimateTrials& trials)
      : seed_(seed),
        family_(family),
        roughness_(family && roughness.least < 0.1 && random.chance(0.4)
                       ? RoughnessSpan{std::max(0.02, roughness.least), 0.1, roughness.rms_error}
                       : roughness),
        bands_(random.chance(0.5) ? 3 : random.whole(1, family ? 9 : 6)),
        random_(random),
        trials_(trials) {}

  void run(const CubemapView& view) {
    project_it(view, "cubemap");
    prefilter_it(view, "cubemap");
    if (random_.chance(0.3)) project_levels(view);
  }

  void run(const LatLongView& view) {
    project_it(view, "lat-long");
    prefilter_it(view, "lat-long");
  }

 private:
  void add(const std::string& kind, double truth, double estimate, const std::string& more) {
    add_to(trials_, kind, truth, estimate, "seed " + std::to_string(seed_) + ", " + what() + more);
  }

  [[nodiscard]] std::string what() const { return random_.description().empty() ? "an image" : random_.description(); }

  template <class View>
  void project_it(const View& view, const std::string& layout) {
    const SphericalHarmonics truth = reference_projection(view, {.bands = bands_});
    ProjectionOptions options{.bands = bands_};
    std::string kind = "projection, exact";
    if (random_.chance(0.4)) {
      options.quadrature = Quadrature::midpoint;
      kind = "projection, midpoint rule";
    }
    if (random_.chance(0.4)) {
      options.target_size = random_.whole(2, 12);
      kind = "projection, target size";
    }
    const Projection projection = project(view, options);
    add(kind + ", " + layout, distance_between(projection.radiance, truth), projection.diagnostics.error_estimate,
        ", " + std::to_string(bands_) + " bands, target " + std::to_string(options.target_size.value_or(0)));
  }

  /// Projects a mip of a mip chain.
  void project_levels(const CubemapView& view) {
    const SphericalHarmonics truth = reference_projection(view);
    const Cubemap chain = build_mips(view, MipFilter::solid_angle);
    if (chain.levels() < 3) return;
    const std::vector<CubemapView> views = chain.views();
    const int level = random_.whole(1, chain.levels() - 2);
    const Projection projection = project(views, {.target_size = chain.level_size(level)});
    add("projection, level of a mip chain", distance_between(projection.radiance, truth),
        projection.diagnostics.error_estimate, ", level " + std::to_string(level));
  }

  template <class View>
  void prefilter_it(const View& view, const std::string& layout) {
    PrefilterOptions options{.mips = 1, .rms_error = roughness_.rms_error};
    options.roughness = {random_.scale(roughness_.least, roughness_.most)};
    options.size = size_for(options.roughness[0], random_);
    judge(view, layout, options, 0);
    if (!family_ || !random_.chance(0.3)) return;
    // a whole chain, whose narrowest lobe decides for all mips
    judge(view, layout, {.size = random_.chance(0.5) ? 16 : 64, .rms_error = roughness_.rms_error},
          random_.whole(1, 4));
  }

  template <class View>
  void judge(const View& view, const std::string& layout, const PrefilterOptions& options, int level) {
    const PrefilteredSpecular result = prefilter_specular(view, options);
    const MipRecord& mip = result.mips[static_cast<std::size_t>(level)];
    const std::string place = " roughness " + std::to_string(mip.roughness) + ", " + std::to_string(mip.size) +
                              " texels of a chain of " + std::to_string(options.size);
    if (mip.error_estimate.value_or(0.0) == 0.0) return;
    const MipTruth truth(result.cubemap, level, random_);
    add(std::string("prefilter, ") + name(mip.method) + ", " + layout, truth.error(view, mip.roughness),
        *mip.error_estimate, place);
  }

  std::uint32_t seed_;
  bool family_;
  RoughnessSpan roughness_;
  int bands_;
  RandomEnvironments& random_;
  EstimateTrials& trials_;
};

struct NamedLobe {
  std::string family;
  std::string name;
  ZonalLobe kernel;
};

NamedLobe random_kernel(RandomEnvironments& random) {
  const double choice = random.number();
  if (choice < 0.5) {
    const double roughness = random.scale(kMinCharlieRoughness, 1.0);
    return {"Charlie", "Charlie " + std::to_string(roughness), ZonalLobe::charlie(roughness)};
  }
  if (choice < 0.8) {
    const double power = random.scale(1.0, 2000.0);
    const bool blinn = random.chance(0.5);
    return {blinn ? "Blinn" : "Phong", (blinn ? "Blinn " : "Phong ") + std::to_string(power),
            blinn ? ZonalLobe::blinn(power) : ZonalLobe::phong(power)};
  }
  if (choice < 0.9) return {"Lambert", "Lambert", ZonalLobe::lambert()};
  std::vector<double> spectrum(static_cast<std::size_t>(random.whole(2, 40)));
  const double width = random.scale(0.01, 1.0);
  for (std::size_t l = 0; l < spectrum.size(); ++l)
    spectrum[l] = std::exp(-0.5 * width * static_cast<double>(l * (l + 1)));
  return {"spectra", "a spectrum of " + std::to_string(spectrum.size()), ZonalLobe::from_spectrum(spectrum)};
}

/// Prefilters a mip with a lobe other than GGX and adds its error. Returns false if the lobe was refused.
template <class View>
bool judge_lobe(const View& view, const std::string& layout, std::uint32_t seed, RandomEnvironments& random,
                EstimateTrials& trials) {
  const NamedLobe lobe = random_kernel(random);
  LobeChainOptions options{.size = random.chance(0.1) ? 64 : 1 << random.whole(2, 5), .lobes = {lobe.kernel}};
  if (random.chance(0.5)) options.rms_error = 1e-4;
  PrefilteredSpecular result;
  try {
    result = prefilter_by_lobes(view, options);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::limit_exceeded) throw;
    return false;
  }
  constexpr double kTruthError = 7e-6;  // of the integrals, for a lobe with a fractional power at its axis or horizon
  constexpr int kLobeProbes = 48;       // an integral takes up to 20 ms
  const MipTruth truth(result.cubemap, 0, random, kLobeProbes);
  add_to(trials, std::string("prefilter, ") + lobe.family + ", " + layout,
         std::max(0.0, truth.error(view, lobe.kernel) - kTruthError), *result.mips[0].error_estimate,
         "seed " + std::to_string(seed) + ", " + random.description() + " " + lobe.name + ", " +
             std::to_string(options.size) + " texels");
  return true;
}

Cubemap image_of(const std::vector<Cubemap>& images, RandomEnvironments& random) {
  const Cubemap& image = images[static_cast<std::size_t>(random.whole(0, static_cast<int>(images.size()) - 1))];
  return to_cubemap(image.view(), random.whole(6, 20), rotation_about_y(random.between(0.0, 360.0)));
}

/// Draws small sources, powers of two, and occasionally an odd large one.
int rows_of_family(RandomEnvironments& random, bool large) {
  constexpr int kOdd[] = {67, 72, 88};
  if (large && random.chance(0.2)) return kOdd[random.whole(0, 2)];
  return random.chance(0.3) ? 1 << random.whole(2, large ? 5 : 4) : random.whole(4, large ? 24 : 16);
}

}  // namespace

void add_estimate_trials(std::uint32_t seed, int count, const RoughnessSpan& roughness,
                         const std::vector<Cubemap>& images, EstimateTrials& trials) {
  for (std::uint32_t own = seed; own < seed + static_cast<std::uint32_t>(count); ++own) {
    RandomEnvironments random(own);
    const bool real = !images.empty() && random.chance(0.2);
    const double exposure = random.chance(0.2) ? random.scale(1e-6, 1e-2) : 1.0;
    const bool large = random.chance(0.1);
    const auto expose = [&](std::span<float> pixels) {
      for (float& value : pixels) value *= static_cast<float>(exposure);
    };
    Cubemap cube;
    if (real) cube = image_of(images, random);
    if (random.chance(0.5)) {
      if (!real) cube = random.cubemap(4, large ? 40 : 16);
      expose(cube.pixels());
      Trial(own, false, roughness, random, trials).run(cube.view());
    } else {
      LatLongImage image;
      if (real) {
        image = to_lat_long(cube.view(), 4 * cube.size(), 2 * cube.size());
      } else {
        image = random.lat_long(6, large ? 64 : 24);
      }
      expose(image.pixels);
      Trial(own, false, roughness, random, trials).run(image.view());
    }
  }
}

int add_lobe_trials(std::uint32_t seed, int count, const std::vector<Cubemap>& images, EstimateTrials& trials) {
  int refused = 0;
  for (std::uint32_t own = seed; own < seed + static_cast<std::uint32_t>(count); ++own) {
    RandomEnvironments random(own);
    const bool cubemap = random.chance(0.5);
    const int rows = random.chance(0.15) ? random.whole(32, 48) : random.whole(4, 24);
    const int kind = random.whole(0, 9);
    Cubemap cube;
    LatLongImage image;
    if (kind == 9 && !images.empty()) {
      cube = image_of(images, random);
      if (!cubemap) image = to_lat_long(cube.view(), 4 * cube.size(), 2 * cube.size());
    } else if (kind >= 7) {
      if (cubemap) cube = random.cubemap(4, 24);
      if (!cubemap) image = random.lat_long(6, 32);
    } else {
      const Family family = kind < 3 ? Family::studio : static_cast<Family>(random.whole(0, 4));
      if (cubemap) cube = random.cubemap(family, rows);
      if (!cubemap) image = random.lat_long(family, 2 * rows, rows);
    }
    const bool made = cubemap ? judge_lobe(cube.view(), "cubemap", own, random, trials)
                              : judge_lobe(image.view(), "lat-long", own, random, trials);
    if (!made) ++refused;
  }
  return refused;
}

void add_family_trials(std::uint32_t seed, int count, const RoughnessSpan& roughness, bool large,
                       EstimateTrials& trials) {
  constexpr std::uint32_t kFamilies = 5;  // the first ones
  for (std::uint32_t own = seed; own < seed + static_cast<std::uint32_t>(count); ++own) {
    RandomEnvironments random(own);
    const auto family = static_cast<Family>(own % kFamilies);
    const int rows = rows_of_family(random, large);
    if (random.chance(0.5)) {
      const Cubemap cube = random.cubemap(family, rows);
      Trial(own, true, roughness, random, trials).run(cube.view());
    } else {
      const LatLongImage image =
          random.lat_long(family, random.chance(0.8) ? 2 * rows : random.whole(4, 4 * rows), rows);
      Trial(own, true, roughness, random, trials).run(image.view());
    }
  }
}

}  // namespace welkin::test
