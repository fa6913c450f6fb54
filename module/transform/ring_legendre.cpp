#include "transform/ring_legendre.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "math/elementary.h"
#include "math/table_cache.h"
#include "transform/transform_kernels.h"

namespace welkin::transforms {
namespace {

constexpr std::size_t kRingsCacheBytes = std::size_t{128} << 20U;  // 384 bands on 512 rows take 2.5 MiB
constexpr double kPi = std::numbers::pi;

/// Functions below this are left out: a thousandth of a float's rounding error relative to those of order 1.
constexpr double kNothing = 0x1p-34;

/// Groups whose rings all have a larger sine go in float: their rings' sines differ by a factor of 2 at most, so that
/// all of a group's functions begin within a float's range of each other.
constexpr double kSineForSingle = 0.25;

/// sin^m(theta) below this is taken as 0 for good. Where order m still rises above kNothing before degree L,
/// m < L sin(theta) (nearly), and sin^m > exp(-L / e): 1e-245 for 1536 bands.
constexpr double kVanished = 1e-280;

}  // namespace

std::shared_ptr<const LegendreRings> LegendreRings::get(const LegendreRingsKey& key) {
  static auto& cache = *new math::TableCache<LegendreRingsKey, LegendreRings>(kRingsCacheBytes);  // never destroyed
  return cache.get(key, [&] { return std::make_shared<const LegendreRings>(key); });
}

LegendreRings::LegendreRings(const LegendreRingsKey& key)
    : bands_(key.bands), groups_(groups_of(key.rings, key.places)) {
  place_rings(key);
  find_starts(key);
  if (key.places == RingSet::edges) fill_row_weights(key);
}

void LegendreRings::place_rings(const LegendreRingsKey& key) {
  const int pairs = pairs_of(key.rings, key.places);
  sines_.assign(lanes(), 0.0);
  x_ = platform::AlignedBuffer<double>(lanes());
  std::fill_n(x_.data(), lanes(), 0.0);
  for (int q = 0; q < pairs; ++q) {
    const bool equator = key.places == RingSet::edges && q + 1 == pairs;
    const double row = key.places == RingSet::centres ? q + 0.5 : q + 1.0;
    const math::SineCosine theta = math::sine_cosine_of_turns(equator ? 0.25 : row / (2.0 * key.rings));
    sines_[static_cast<std::size_t>(q)] = theta.sine;
    x_.data()[q] = theta.cosine;
  }
  x_single_ = platform::AlignedBuffer<float>(2 * lanes());
  for (int q = 0; q < groups_ * kRingLanes; ++q) {
    const double x = x_.data()[q];
    const auto nearest = static_cast<float>(x);
    float* const to = x_single_.data() + 2 * q - q % kRingLanes;
    to[0] = nearest;
    to[kRingLanes] = static_cast<float>(x - static_cast<double>(nearest));
  }
  if (key.places == RingSet::edges) first_single_ = groups_;
  while (first_single_ < groups_ && sines_[static_cast<std::size_t>(first_single_ * kRingLanes)] < kSineForSingle) {
    ++first_single_;
  }
}

void LegendreRings::find_starts(const LegendreRingsKey& key) {
  const auto factors = LegendreFactors::get(key.bands);
  const auto bands = static_cast<std::size_t>(key.bands);
  const auto groups = static_cast<std::size_t>(groups_);
  constexpr int state_doubles = 2 * kRingLanes;
  states_ = platform::AlignedBuffer<double>(bands * groups * static_cast<std::size_t>(state_doubles));
  starts_.resize(bands * groups);
  orders_.assign(groups, 0);
  // P(m, m) = sqrt(1 / 4 pi) prod over k <= m of sqrt((2k + 1) / (2k)) sin(theta)
  std::vector<double> sectoral(lanes());
  for (std::size_t q = 0; q < lanes(); ++q) {
    const double sine = sines_[q];
    sectoral[q] = sine > 0.0 ? std::sqrt(0.25 / kPi) * (key.places == RingSet::edges ? sine * sine : 1.0) : 0.0;
  }
  const LegendreKernels& kernels = legendre_kernels();
  double* state = states_.data();
  for (int m = 0; m < key.bands; ++m) {
    if (m > 0) {
      const double factor = std::sqrt((2.0 * m + 1.0) / (2.0 * m));
      for (std::size_t q = 0; q < lanes(); ++q) {
        sectoral[q] *= factor * sines_[q];
        if (sectoral[q] < kVanished) sectoral[q] = 0.0;
      }
    }
    const double* const a = factors->a(m);
    const int fours = fours_of(key.bands - m);
    int last = fours;  // starts must not rise towards the equator
    int first_group = groups_;
    for (int group = 0; group < groups_; ++group, state += state_doubles) {
      const double* const x = x_.data() + std::ptrdiff_t{kRingLanes} * group;
      const int four =
          kernels.find_start(a, x, sectoral.data() + std::ptrdiff_t{kRingLanes} * group, kNothing, last, state);
      starts_[static_cast<std::size_t>(m) * groups + static_cast<std::size_t>(group)] = four;
      last = four;
      if (four == fours) continue;
      first_group = std::min(first_group, group);
      orders_[static_cast<std::size_t>(group)] = m + 1;
    }
    first_groups_.push_back(first_group);
  }
}

// With g(theta) = Int from theta to pi/2 of sin^(m + 1), a row's integral is a difference of g's; summing by parts
// gives g(0) times the sum over the equator's two rows, less (g(0) - g) times the steps at the other edges.
// Int sin^n = (sin^(n - 1) cos + (n - 1) Int sin^(n - 2)) / n, taken from theta to pi/2.
void LegendreRings::fill_row_weights(const LegendreRingsKey& key) {
  const auto last_lane = static_cast<std::size_t>(pairs_of(key.rings, key.places) - 1);
  row_weights_ = platform::AlignedBuffer<double>(static_cast<std::size_t>(key.bands) * lanes());
  // P(m, m) = norm sin^m, and a row's integral is Int P sin d theta = norm Int sin^(m + 1). `here` is that without the
  // norm, `before` Int sin^m, and the next order's is the recurrence for n = m + 2. It starts with Int 1 = pi / 2 -
  // theta and Int sin = cos(theta); all terms are positive, so it is stable upwards.
  std::vector<double> before(last_lane);  // Int sin^m
  std::vector<double> here(x_.data(), x_.data() + last_lane);
  std::vector<double> power(last_lane, 1.0);  // sin^m
  for (std::size_t q = 0; q < last_lane; ++q) before[q] = kPi * (0.5 - (static_cast<double>(q) + 1.0) / key.rings);
  double before_whole = 0.5 * kPi;  // the same from theta = 0
  double here_whole = 1.0;
  double norm = std::sqrt(0.25 / kPi);
  double* weights = row_weights_.data();
  for (int m = 0; m < key.bands; ++m, weights += lanes()) {
    const double n = m + 2.0;
    // Lane by lane, so that compilers make registers of them.
    for (std::size_t q = 0; q < last_lane; ++q) {
      // -(g(0) - g): what a step weighs.
      weights[q] = norm * (here[q] - here_whole);
      power[q] *= sines_[q];
      const double next = (power[q] * x_.data()[q] + (n - 1.0) * before[q]) / n;
      before[q] = here[q];
      here[q] = next;
    }
    weights[last_lane] = norm * here_whole;
    std::fill(weights + last_lane + 1, weights + lanes(), 0.0);
    const double next_whole = (n - 1.0) * before_whole / n;
    before_whole = here_whole;
    here_whole = next_whole;
    norm *= std::sqrt((2.0 * m + 3.0) / (2.0 * m + 2.0));
  }
}

LegendreRun LegendreRings::run(int m, int first, int groups, const LegendreFactors& factors) const noexcept {
  const std::size_t from =
      static_cast<std::size_t>(m) * static_cast<std::size_t>(groups_) + static_cast<std::size_t>(first);
  return {.a = factors.a(m),
          .a_single = factors.a_single(m),
          .x = x_.data() + std::ptrdiff_t{kRingLanes} * first,
          .x_single = x_single_.data() + std::ptrdiff_t{2} * kRingLanes * first,
          .states = states_.data() + from * 2 * static_cast<std::size_t>(kRingLanes),
          .starts = starts_.data() + from,
          .groups = groups,
          .first_single = std::max(0, first_single_ - first),
          .fours = fours_of(bands_ - m)};
}

std::size_t LegendreRings::bytes() const noexcept {
  return sizeof(*this) + x_.bytes() + x_single_.bytes() + states_.bytes() + row_weights_.bytes() +
         (starts_.size() + orders_.size() + first_groups_.size()) * sizeof(int) + sines_.size() * sizeof(double);
}

namespace {

// kBeyond: kernels read a(m + i) for i < 4 fours + 6, and 4 fours <= bands - m + 3.
constexpr std::size_t kFactorsCacheBytes = std::size_t{64} << 20U;  // 512 bands take 4 MiB, 1536 take 38
constexpr int kBeyond = 9;                                          // degrees that kernels run past the last one

/// e(l, m); 0 for l = m.
double ratio(double l, double m) { return std::sqrt((l - m) * (l + m) / ((2.0 * l - 1.0) * (2.0 * l + 1.0))); }

}  // namespace

std::shared_ptr<const LegendreFactors> LegendreFactors::get(int bands) {
  static auto& cache = *new math::TableCache<int, LegendreFactors>(kFactorsCacheBytes);  // never destroyed
  return cache.get(bands, [&] { return std::make_shared<const LegendreFactors>(bands); });
}

LegendreFactors::LegendreFactors(int bands) {
  for (int m = 0; m < bands; ++m) {
    starts_.push_back(length_);
    length_ += static_cast<std::size_t>(bands - m + kBeyond);
  }
  values_ = platform::AlignedBuffer<double>(4 * length_);
  single_ = platform::AlignedBuffer<float>(length_);
  for (int m = 0; m < bands; ++m) fill_order(m, bands - m + kBeyond);
  for (std::size_t k = 0; k < length_; ++k) single_.data()[k] = static_cast<float>(values_.data()[k]);
}

void LegendreFactors::fill_order(int m, int count) {
  double* const a = values_.data() + start(m);
  double* const gamma = a + length_;
  double* const alpha = gamma + length_;
  double* const beta = alpha + length_;
  a[0] = alpha[0] = beta[0] = 0.0;  // not used
  gamma[0] = 1.0;
  // Loop by loop, so that compilers make registers of all but one: `beta` has e(l) meanwhile.
  for (int i = 1; i < count; ++i) beta[i] = ratio(m + i, m);
  for (int i = 1; i < count; ++i) alpha[i] = beta[i - 1] / beta[i];
  // With P(l) = gamma(l) Q(l), e(l) P(l) = x P(l - 1) - e(l - 1) P(l - 2) divided by e(l) gamma(l) has the factor
  // e(l - 1) gamma(l - 2) / (e(l) gamma(l)) of Q(l - 2): 1 for the gamma(l) here. That of x Q(l - 1) is a(l).
  gamma[1] = 1.0;
  for (int i = 2; i < count; ++i) gamma[i] = alpha[i] * gamma[i - 2];
  for (int i = 1; i < count; ++i) {
    const double l = m + i;
    a[i] = gamma[i - 1] / (beta[i] * gamma[i]);
    alpha[i] = (l - 2.0) * beta[i - 1] / ((l + 1.0) * beta[i]);
  }
  for (int i = 1; i < count; ++i) beta[i] = gamma[i - 1] / ((m + i + 1.0) * beta[i]);
}

namespace {

constexpr std::size_t kFunctionsCacheBytes = std::size_t{8} << 20U;
constexpr std::size_t kMaxFunctionBytes = std::size_t{1} << 20U;

}  // namespace

bool SplineFunctions::serve(int rings, int bands) noexcept {
  const auto lanes = static_cast<std::size_t>(LegendreRings::groups_of(rings, RingSet::centres)) * kRingLanes;
  const auto functions = static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands + 2) / 2;
  return functions * lanes * sizeof(float) <= kMaxFunctionBytes;
}

std::shared_ptr<const SplineFunctions> SplineFunctions::get(int rings, int bands) {
  static auto& cache = *new math::TableCache<std::pair<int, int>, SplineFunctions>(kFunctionsCacheBytes);  // as above
  return cache.get({rings, bands}, [=] { return std::make_shared<const SplineFunctions>(rings, bands); });
}

// Six degrees of each parity at a time are sums of their own, in the places of the six numbers.
SplineFunctions::SplineFunctions(int rings, int bands)
    : bands_(bands), groups_(LegendreRings::groups_of(rings, RingSet::centres)) {
  constexpr int kParity = 6;
  std::size_t length = 0;
  for (int m = 0; m < bands; ++m) {
    starts_.push_back(length);
    length += static_cast<std::size_t>(degrees(m));
  }
  values_ = platform::AlignedBuffer<float>(length * static_cast<std::size_t>(groups_) * kRingLanes);
  const auto factors = LegendreFactors::get(bands);
  const auto places = LegendreRings::get({rings, bands, RingSet::centres});
  const LegendreKernels& kernels = legendre_kernels();
  platform::AlignedBuffer<float> units(static_cast<std::size_t>(bands + 3) * kHarmonicFloats);
  platform::AlignedBuffer<float> columns(static_cast<std::size_t>(groups_) * kColumnFloats);
  platform::AlignedBuffer<float> scratch(spline_scratch_floats(groups_));
  for (int m = 0; m < bands; ++m) {
    for (int first = 0; first < degrees(m); first += 2 * kParity) {
      const int count = std::min(2 * kParity, degrees(m) - first);
      std::fill_n(units.data(), units.size(), 0.0F);
      for (int i = first; i < std::min(first + count, bands - m); ++i)
        units.data()[kHarmonicFloats * i + (i - first) / 2] = 1.0F;
      LegendreRun run = places->run(m, 0, groups_, *factors);
      run.fours = std::min(run.fours, fours_of(first + count));
      kernels.synthesise_order(run, units.data(), columns.data());
      kernels.spline_rings({groups_, rings, m % 2 != 0}, columns.data(), scratch.data());
      for (int group = 0; group < groups_; ++group) {
        float* to = values_.data() + start(m, group) + std::ptrdiff_t{kRingLanes} * first;
        for (int k = 0; k < count; ++k, to += kRingLanes) {
          const int row = k % 2 * kParity + k / 2;
          std::copy_n(columns.data() + std::ptrdiff_t{kColumnFloats} * group + std::ptrdiff_t{kRingLanes} * row,
                      kRingLanes, to);
        }
      }
    }
  }
}

}  // namespace welkin::transforms
