#include "reflections/lookups.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>

#include "image/geometry.h"
#include "image/pixels.h"
#include "math/basis.h"
#include "math/elementary.h"
#include "math/table_cache.h"
#include "platform/memory.h"
#include "reflections/lobe.h"
#include "reflections/prefilter_estimate.h"
#include "transform/spectrum.h"

namespace welkin::reflections {
namespace {

constexpr double kMirror = 1e-3;  ///< roughness below which a lobe leaves every degree as it is
constexpr int kDegrees = 512;     ///< that an image's energies have
constexpr int kSamples = 3;       ///< roughnesses that are looked at between two mips

double log2(double x) noexcept { return math::logarithm(x) / std::numbers::ln2; }

}  // namespace

double mip_by_formula(RoughnessSchedule schedule, double roughness, int mips, int size) {
  const int last = mips - 1;
  // as the engines' shaders have them, with `last` for their number of the last mip; `mip_roughness` has the inverses
  double mip = last * roughness;
  switch (schedule) {
    case RoughnessSchedule::linear: break;
    case RoughnessSchedule::filament: mip = last * roughness * (2.0 - roughness); break;
    case RoughnessSchedule::babylon: mip = 0.8 * log2(std::max(1e-9, size * roughness * roughness)); break;
    case RoughnessSchedule::unity: mip = 6.0 * roughness * (1.7 - 0.7 * roughness); break;
    case RoughnessSchedule::unreal: mip = last - 2 + 1.2 * log2(std::max(1e-9, roughness)); break;
  }
  return std::clamp(mip, 0.0, static_cast<double>(last));
}

LookupFormula formula_of(const std::vector<double>& roughness, int size) {
  LookupFormula formula{std::nullopt, static_cast<int>(roughness.size()), size};
  if (formula.mips < 2 || formula.mips > full_chain_levels(size)) return formula;
  for (const auto schedule : {RoughnessSchedule::filament, RoughnessSchedule::linear, RoughnessSchedule::babylon,
                              RoughnessSchedule::unity, RoughnessSchedule::unreal}) {
    if (roughness == mip_roughness(schedule, formula.mips, size)) formula.schedule = schedule;
  }
  return formula;
}

std::vector<Lookup> lookups_between(const MipPair& mips, const LookupFormula& formula, int count) {
  const auto [from, to] = mips.roughness;
  std::vector<Lookup> lookups;
  for (int k = 0; k < count && to > from; ++k) {
    const double along = (k + 0.5) / count;
    const double roughness = from + (to - from) * along;
    const double share = formula.schedule
                             ? mip_by_formula(*formula.schedule, roughness, formula.mips, formula.size) - mips.first
                             : along;
    lookups.push_back({roughness, std::clamp(share, 0.0, 1.0)});
  }
  return lookups;
}

std::vector<double> spectrum_of(double roughness, int degrees) {
  if (roughness < kMirror) return std::vector<double>(static_cast<std::size_t>(degrees), 1.0);
  const double alpha = roughness * roughness;
  // Beyond 2 alpha l = 12 there is nothing but the horizon's kink: exp(-12) = 6e-6.
  std::vector<double> spectrum = lobe_spectrum(alpha, std::min(degrees, 16 + static_cast<int>(6.0 / alpha)));
  spectrum.resize(static_cast<std::size_t>(degrees), 0.0);
  return spectrum;
}

// Samples of a wave, h apart, that are interpolated linearly: the wave times (sin x / x)^2, x half its phase from one
// sample to the next, and others; the mean square of all is (2 + cos 2 x) / 3. Waves run diagonally to the texels here.
//
// Interpolation is a convolution of the samples with a triangle, the box h twice, whose spectrum is (sin x / x)^2 at
// the wave itself; the other terms are its aliases. At a share t of the way from one sample to the next the value is
// (1 - t) + t e^(2 i x) times the first one, and Int_0^1 ((1 - t)^2 + t^2 + 2 t (1 - t) cos 2 x) dt = (2 + cos 2 x) /
// 3. Degree l has the wave number sqrt(l (l + 1)), and over sqrt(2) along each axis of the texels: both axes have the
// same x, amplitudes of a wave and mean squares of both are products of the axes'. `noise` is the mean square of the
// aliases. Means over texels are one box more along each axis.
TexelFilter::TexelFilter(int size, double roughness, int degrees) {
  const double texel = std::sqrt(2.0 * std::numbers::pi / 3.0) / size;  // root of its mean solid angle
  for (int l = 0; l < degrees; ++l) {
    const double x = 0.5 * texel * std::sqrt(0.5 * l * (l + 1.0));
    const math::SineCosine at = math::sine_cosine_of_turns(x / (2.0 * std::numbers::pi));
    const double sinc = x > 1e-4 ? at.sine / x : 1.0;
    const double square = (1.0 + 2.0 * at.cosine * at.cosine) / 3.0;
    const double wave = sinc * sinc * sinc * sinc;
    const double mean = roughness < kMirror ? sinc * sinc : 1.0;
    gain.push_back(wave * mean);
    noise.push_back(std::max(0.0, square * square - wave * wave) * mean * mean);
  }
}

namespace {

constexpr std::size_t kCacheBytes = std::size_t{4} << 20U;

struct PairKey {
  MipPair mips;
  LookupFormula formula;
  int degrees;
  bool operator==(const PairKey&) const = default;
};

/// Factors on the energy of each degree for one roughness between two mips. They do not depend on the image.
struct SeenBetween {
  explicit SeenBetween(const PairKey& key);

  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof(*this) + (errors.size() + truths.size()) * sizeof(double);
  }

  std::vector<double> errors;  ///< [lookup][degree], mean squares over the energy
  std::vector<double> truths;  ///< the same of the lobe alone
};

SeenBetween::SeenBetween(const PairKey& key) {
  const MipPair& mips = key.mips;
  const std::vector<double> first = spectrum_of(mips.lobes[0], key.degrees);
  const std::vector<double> second = spectrum_of(mips.lobes[1], key.degrees);
  const TexelFilter of_first(mips.sizes[0], mips.lobes[0], key.degrees);
  const TexelFilter of_second(mips.sizes[1], mips.lobes[1], key.degrees);
  for (const Lookup& lookup : lookups_between(mips, key.formula, kSamples)) {
    const std::vector<double> truth = spectrum_of(lookup.roughness, key.degrees);
    for (std::size_t l = 0; l < truth.size(); ++l) {
      const double a = (1.0 - lookup.share) * first[l];
      const double b = lookup.share * second[l];
      // The shader's amplitude of the degree less the lobe's, and the aliases of both mips' texels, which are
      // independent.
      const double off = a * of_first.gain[l] + b * of_second.gain[l] - truth[l];
      errors.push_back(off * off + a * a * of_first.noise[l] + b * b * of_second.noise[l]);
      truths.push_back(truth[l] * truth[l]);
    }
  }
}

}  // namespace

double error_between(const MipPair& mips, const LookupFormula& formula, std::span<const float> energies) {
  static auto& cache = *new math::TableCache<PairKey, SeenBetween>(kCacheBytes);  // never destroyed
  const PairKey key{mips, formula, static_cast<int>(energies.size())};
  const auto seen = cache.get(key, [&] { return std::make_shared<const SeenBetween>(key); });
  double squares = 0.0;
  for (std::size_t from = 0; from < seen->errors.size(); from += energies.size()) {
    double error = 0.0;
    double whole = 0.0;
    for (std::size_t l = energies.size(); l-- > 0;) {
      error += static_cast<double>(energies[l]) * seen->errors[from + l];
      whole += static_cast<double>(energies[l]) * seen->truths[from + l];
    }
    // relative to the reference at each roughness, as its mean square falls from one to the next
    if (whole > 0.0) squares += error / whole;
  }
  return std::sqrt(squares / kSamples);
}

namespace {

glm::dvec3 direction_of(const BrightTexel& light, const ImageShape& shape) {
  return shape.grid().direction(std::int64_t{light.row} * shape.columns + light.column);
}

/// Adds the energies of two points together for l < bands: by the addition theorem (2 l + 1) / 4 pi times the product
/// of their light times P_l of the cosine between them.
void add_pair(double light, double cosine, std::vector<double>& energies) {
  math::for_each_legendre(cosine, energies.size(), [&](std::size_t l, double legendre) {
    energies[l] += static_cast<double>(2 * l + 1) / (4.0 * std::numbers::pi) * light * legendre;
  });
}

/// Returns energies of the lights alone for l < bands. Many are spread over the cells of a lat-long that they lie in.
std::vector<double> energies_of_lights(const std::vector<BrightTexel>& lights, const ImageShape& shape, int bands,
                                       const Control& control) {
  constexpr std::size_t kFew = 40;  ///< whose pairs take less time than a transform
  if (lights.size() <= kFew) {
    std::vector<double> energies(static_cast<std::size_t>(bands));
    for (const BrightTexel& one : lights) {
      const glm::dvec3 direction = direction_of(one, shape);
      const glm::dvec3 light = one.light();
      for (const BrightTexel* other = lights.data(); other <= &one; ++other) {
        // the pair counts in both orders; `light()` has one's own steradians
        const double both = (other == &one ? 1.0 : 2.0) * other->steradians;
        add_pair(both * glm::dot(light, glm::dvec3(other->excess[0], other->excess[1], other->excess[2])),
                 glm::dot(direction, direction_of(*other, shape)), energies);
      }
    }
    return energies;
  }
  // cells of a quarter of the shortest wave
  const int rows = 2 * bands;
  const int columns = 2 * rows;
  platform::AlignedBuffer<float> cells(static_cast<std::size_t>(3 * rows * columns));
  std::fill_n(cells.data(), cells.size(), 0.0F);
  for (const BrightTexel& light : lights) {
    const glm::dvec3 direction = direction_of(light, shape);
    const double turns = math::turns_of(direction.x, direction.z) + 0.5;
    const double height = 0.5 - math::arc_sine(std::clamp(direction.y, -1.0, 1.0)) / std::numbers::pi;
    const int row = std::clamp(static_cast<int>(height * rows), 0, rows - 1);
    const int at = row * columns + std::clamp(static_cast<int>(turns * columns), 0, columns - 1);
    const double share = light.steradians / image::lat_long_texel_solid_angle(columns, rows, row);
    for (std::size_t c = 0; c < 3; ++c)
      cells.data()[3 * static_cast<std::size_t>(at) + c] += static_cast<float>(light.excess[c] * share);
  }
  const LatLongView view{cells.data(), columns, rows, 0, PixelFormat::rgb32f};
  return energies_of(transforms::analyse(view, bands, control));
}

/// Continues energies that are per degree and order by a power law through their last two quarters.
void continue_energies(std::vector<double>& energies, int degrees, double least_slope, double most_slope) {
  const auto known = static_cast<int>(energies.size());
  const int quarter = known / 4;
  const auto mean = [&](int from) {
    double sum = 0.0;
    for (int l = from; l < from + quarter; ++l) sum += energies[static_cast<std::size_t>(l)] / quarter;
    return sum;
  };
  if (quarter == 0) return energies.resize(static_cast<std::size_t>(degrees), 0.0);
  const double last = mean(known - quarter);
  const double before = mean(known - 2 * quarter);
  // Centres of the two quarters are 7/8 and 5/8 of what is known: 1.4 apart.
  const double slope = last > 0.0 && before > 0.0 ? math::logarithm(before / last) / math::logarithm(1.4) : most_slope;
  const double power = std::clamp(slope, least_slope, most_slope);
  const double centre = known - 0.5 * quarter;
  for (int l = known; l < degrees; ++l)
    energies.push_back(last * math::exponential(-power * math::logarithm(l / centre)));
}

}  // namespace

std::vector<float> whole_energies(std::span<const double> rest, const std::vector<BrightTexel>& lights,
                                  const ImageShape& shape, const Control& control) {
  std::vector<double> energies(rest.begin(), rest.begin() + std::min<std::ptrdiff_t>(std::ssize(rest), kDegrees));
  continue_energies(energies, kDegrees, -1.0, 3.0);
  if (!lights.empty()) {
    constexpr int kBands = 48;
    std::vector<double> of_lights = energies_of_lights(lights, shape, kBands, control);
    // slopes are those of energies per degree, of 2 l + 1 harmonics
    continue_energies(of_lights, kDegrees, -1.0, 3.0);  // a light by itself has as much in each order: slope -1
    const double mean = std::sqrt(energies.front()) + std::sqrt(of_lights.front());
    for (std::size_t l = 0; l < energies.size(); ++l) energies[l] += of_lights[l];
    // Waves of other degrees have independent phases, so that energies add up; means have one sign.
    energies.front() = mean * mean;  // both add up
  }
  double sum = 0.0;
  for (const double energy : energies) sum += energy;
  std::vector<float> shares;
  shares.reserve(energies.size());
  for (const double energy : energies) shares.push_back(sum > 0.0 ? static_cast<float>(energy / sum) : 0.0F);
  return shares;
}

}  // namespace welkin::reflections
