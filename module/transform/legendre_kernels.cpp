// Sums with Legendre functions, down the rings (analysis) and over the degrees (synthesis).
//
// For two degrees, one even and one odd about the equator, and 16 ring pairs the sums take 24 operations in float. The
// functions take 10 more in float, or 22 in double: 12 (half as wide), and 10 to narrow the results.
#include "simd/vec.h"
#include "transform/transform_kernels.h"

namespace welkin::transforms::WELKIN_ISA {
namespace {

using simd::Block, simd::DoubleLanes, simd::kBlock, simd::kDoubleWidth, simd::kWidth, simd::Lanes, simd::narrow,
    simd::sum_rows;

constexpr int kNumbers = 6;  // three channels, real and imaginary

/// Two consecutive degrees, for as many rings as a register has floats, in double. `at`: [2][kRingLanes].
struct DoubleState {
  using Number = double;
  DoubleLanes even_low, even_high, odd_low, odd_high, x_low, x_high;

  WELKIN_INLINE DoubleState(const double* at, const LegendreRun& run, std::ptrdiff_t lane)
      : even_low(DoubleLanes::load_aligned(at)),
        even_high(DoubleLanes::load_aligned(at + kDoubleWidth)),
        odd_low(DoubleLanes::load_aligned(at + kRingLanes)),
        odd_high(DoubleLanes::load_aligned(at + kRingLanes + kDoubleWidth)),
        x_low(DoubleLanes::load_aligned(run.x + lane)),
        x_high(DoubleLanes::load_aligned(run.x + lane + kDoubleWidth)) {}
  WELKIN_INLINE void store(double* at) const {
    even_low.store_aligned(at);
    even_high.store_aligned(at + kDoubleWidth);
    odd_low.store_aligned(at + kRingLanes);
    odd_high.store_aligned(at + kRingLanes + kDoubleWidth);
  }
  /// On from degrees m + i - 2 and m + i - 1 to the next two.
  WELKIN_INLINE void advance(const LegendreRun& run, int i) {
    const DoubleLanes a_even(run.a[i]);
    const DoubleLanes a_odd(run.a[i + 1]);
    even_low = a_even * x_low * odd_low - even_low;
    even_high = a_even * x_high * odd_high - even_high;
    odd_low = a_odd * x_low * even_low - odd_low;
    odd_high = a_odd * x_high * even_high - odd_high;
  }
  [[nodiscard]] WELKIN_INLINE Lanes even() const { return narrow(even_low, even_high); }
  [[nodiscard]] WELKIN_INLINE Lanes odd() const { return narrow(odd_low, odd_high); }
};

/// The recurrence's state in float.
struct SingleState {
  using Number = float;
  Lanes even_, odd_, x, x_rest;

  WELKIN_INLINE SingleState(const float* at, const LegendreRun& run, std::ptrdiff_t lane)
      : even_(Lanes::load_aligned(at)),
        odd_(Lanes::load_aligned(at + kRingLanes)),
        x(Lanes::load_aligned(places(run, lane))),
        x_rest(Lanes::load_aligned(places(run, lane) + kRingLanes)) {}
  static WELKIN_INLINE const float* places(const LegendreRun& run, std::ptrdiff_t lane) {
    return run.x_single + 2 * lane - lane % kRingLanes;
  }
  WELKIN_INLINE void store(float* at) const {
    even_.store_aligned(at);
    odd_.store_aligned(at + kRingLanes);
  }
  WELKIN_INLINE void advance(const LegendreRun& run, int i) {
    const Lanes a_even(run.a_single[i]);
    const Lanes a_odd(run.a_single[i + 1]);
    // x alone is off by up to 3e-8, the same way in each step: Q would belong to another colatitude, and its phase, l
    // theta, would drift in proportion to l. x_rest removes that, and random roundings grow as sqrt(l).
    even_ = (a_even * x + a_even * x_rest) * odd_ - even_;
    odd_ = (a_odd * x + a_odd * x_rest) * even_ - odd_;
  }
  [[nodiscard]] WELKIN_INLINE Lanes even() const { return even_; }
  [[nodiscard]] WELKIN_INLINE Lanes odd() const { return odd_; }
};

WELKIN_INLINE bool any_reaches(DoubleLanes values, DoubleLanes least) {
  return xsimd::any(xsimd::max(values, DoubleLanes(0.0) - values) >= least);
}

/// A group's first state as floats, [2][kRingLanes].
WELKIN_INLINE void narrow_state(const double* from, float* to) {
  for (int k = 0; k < 2 * kRingLanes; k += kWidth) {
    narrow(DoubleLanes::load_aligned(from + k), DoubleLanes::load_aligned(from + k + kDoubleWidth))
        .store_aligned(to + k);
  }
}

/// One running sum for each number, named apart by recursion: see projection/projection_kernels.cpp.
template <int count>
struct Sums {
  Lanes here = Lanes(0.0F);
  Sums<count - 1> next;

  /// += function x the numbers, each the same in all lanes
  WELKIN_INLINE void add_all(Lanes function, const float* numbers) {
    here = here + function * Lanes(*numbers);
    next.add_all(function, numbers + 1);
  }
  WELKIN_INLINE void store(float* lanes) const {
    here.store_aligned(lanes);
    next.store(lanes + kRingLanes);
  }
};
template <>
struct Sums<0> {
  WELKIN_INLINE void add_all(Lanes, const float*) {}
  WELKIN_INLINE void store(float*) const {}
};

/// sums[i] += the 16 lanes of row i: lanes k and k + 8 first, then k and k + 4, k + 2, k + 1. 16 rows.
WELKIN_INLINE void add_folded(const float* rows, float* sums) {
  for (int row = 0; row < 16; row += kBlock) {
    Block sums_of_rows;
    sum_rows(rows + row * kRingLanes, sums_of_rows);
    (Block::load_aligned(sums + row) + sums_of_rows).store_aligned(sums + row);
  }
}

constexpr int kStateDoubles = 2 * kRingLanes;
constexpr int kRowFloats = kHarmonicFloats * kRingLanes;  // lanes of one degree's sums

// Analysis goes by eight degrees: first their functions on all groups, then the sums of the four even ones and of the
// four odd ones, 24 sums in registers each. (Both in one loop, states back and forth through memory, took a third
// more.)

constexpr int kDegrees = 8;
constexpr int kFunctionFloats = kDegrees / 2 * kRingLanes;  // of one group and parity

/// functions[parity][kDegrees / 2][kRingLanes] of one group for fours `four` and the next, from its state on.
template <class State>
WELKIN_INLINE void run_recurrence(const LegendreRun& run, int group, int four, int part, double* state,
                                  float* functions) {
  auto* const here = reinterpret_cast<typename State::Number*>(state + std::ptrdiff_t{kStateDoubles} * group) + part;
  float* even = functions;
  float* odd = even + kAnalysisGroups * kFunctionFloats;
  int i = 4 * four + 2;
  int pairs = kDegrees / 2;
  // States stand at the group's first four: the even and the odd function of degrees before it count as 0.
  if (run.starts[group] > four) {  // begins in the second four
    for (int k = 0; k < 2; ++k, even += kRingLanes, odd += kRingLanes) {
      Lanes(0.0F).store_aligned(even);
      Lanes(0.0F).store_aligned(odd);
    }
    i += 4;
    pairs = 2;
  }
  State values(here, run, std::ptrdiff_t{kRingLanes} * group + part);
  for (; pairs > 0; --pairs, i += 2, even += kRingLanes, odd += kRingLanes) {
    values.even().store_aligned(even);
    values.odd().store_aligned(odd);
    values.advance(run, i);
  }
  values.store(here);
}

/// Sums of `degrees` (2 or 4) functions with each of `count` numbers.
template <int count, int degrees>
struct DegreeSums {
  Lanes first = Lanes(0.0F);
  Lanes second = Lanes(0.0F);
  Lanes third = Lanes(0.0F);
  Lanes fourth = Lanes(0.0F);
  DegreeSums<count - 1, degrees> next;

  WELKIN_INLINE void add(Lanes f1, Lanes f2, Lanes f3, Lanes f4, const float* numbers) {
    const Lanes number = Lanes::load_aligned(numbers);
    first = first + f1 * number;
    second = second + f2 * number;
    if constexpr (degrees == 4) {
      third = third + f3 * number;
      fourth = fourth + f4 * number;
    }
    next.add(f1, f2, f3, f4, numbers + kRingLanes);
  }
  /// Every other degree's rows.
  WELKIN_INLINE void store(float* rows) const {
    first.store_aligned(rows);
    second.store_aligned(rows + 2 * kRowFloats);
    if constexpr (degrees == 4) {
      third.store_aligned(rows + 4 * kRowFloats);
      fourth.store_aligned(rows + 6 * kRowFloats);
    }
    next.store(rows + kRingLanes);
  }
};
template <int degrees>
struct DegreeSums<0, degrees> {
  WELKIN_INLINE void add(Lanes, Lanes, Lanes, Lanes, const float*) {}
  WELKIN_INLINE void store(float*) const {}
};

template <int degrees>
WELKIN_INLINE void sum_groups(const float* functions, const float* columns, int groups, float* rows) {
  DegreeSums<kNumbers, degrees> sums;
  for (int group = 0; group < groups; ++group, functions += kFunctionFloats, columns += kColumnFloats) {
    const Lanes f1 = Lanes::load_aligned(functions);
    const Lanes f2 = Lanes::load_aligned(functions + kRingLanes);
    if constexpr (degrees == 4) {
      sums.add(f1, f2, Lanes::load_aligned(functions + 2 * kRingLanes), Lanes::load_aligned(functions + 3 * kRingLanes),
               columns);
    } else {
      sums.add(f1, f2, f1, f2, columns);
    }
  }
  sums.store(rows);
}

/// Synthesis keeps a group's sums in registers, and its functions.
template <class State>
WELKIN_INLINE void sum_degrees(const LegendreRun& run, int group, int part, const typename State::Number* state,
                               const float* coefficients, float* column) {
  Sums<kNumbers> even;
  Sums<kNumbers> odd;
  State values(state, run, std::ptrdiff_t{kRingLanes} * group + part);
  const int end = 4 * run.fours;
  for (int i = 4 * run.starts[group]; i < end; i += 2) {
    const float* const here = coefficients + std::ptrdiff_t{kHarmonicFloats} * i;
    even.add_all(values.even(), here);
    odd.add_all(values.odd(), here + kHarmonicFloats);
    values.advance(run, i + 2);
  }
  even.store(column);
  odd.store(column + kNumbers * kRingLanes);
}

void analyse_order(const LegendreRun& run, const float* columns, double* state, float* sums) {
  alignas(64) float functions[2 * kAnalysisGroups * kFunctionFloats];
  for (int group = 0; group < run.groups; ++group) {
    const double* const from = run.states + std::ptrdiff_t{kStateDoubles} * group;
    double* const to = state + std::ptrdiff_t{kStateDoubles} * group;
    if (group >= run.first_single) {
      narrow_state(from, reinterpret_cast<float*>(to));
    } else {
      for (int k = 0; k < kStateDoubles; k += kDoubleWidth) {
        DoubleLanes::load_aligned(from + k).store_aligned(to + k);
      }
    }
  }
  // Each degree's last two rows stay zero: sums come by eights.
  alignas(64) float rows[kDegrees * kRowFloats] = {};
  int first = run.groups;  // groups before it have not started
  // P(m, m) holds sin^m(theta), down to 1e-280 (kVanished in ring_legendre.cpp), in a double's range: no scaling by
  // powers of two along the recurrence. Where all functions of a four are below `threshold`, the four is left out of
  // the sums.
  for (int four = 0; four < run.fours; four += 2) {
    // Starts never rise with the group (towards the equator), so the groups that have begun are the last ones.
    while (first > 0 && run.starts[first - 1] <= four + 1) --first;
    if (first == run.groups) continue;
    for (int part = 0; part < kRingLanes; part += kWidth) {
      for (int group = first; group < run.groups; ++group) {
        float* const to = functions + kFunctionFloats * group + part;
        if (group < run.first_single) {
          run_recurrence<DoubleState>(run, group, four, part, state, to);
        } else {
          run_recurrence<SingleState>(run, group, four, part, state, to);
        }
      }
      for (int parity = 0; parity < 2; ++parity) {
        const float* const from = functions + (parity * kAnalysisGroups + first) * kFunctionFloats + part;
        const float* const column =
            columns + std::ptrdiff_t{kColumnFloats} * first + parity * kNumbers * kRingLanes + part;
        float* const to = rows + parity * kRowFloats + part;
        if constexpr (kWidth == kRingLanes) {  // 24 sums fit the registers of AVX-512
          sum_groups<4>(from, column, run.groups - first, to);
        } else {
          sum_groups<2>(from, column, run.groups - first, to);
          sum_groups<2>(from + 2 * kRingLanes, column, run.groups - first, to + 4 * kRowFloats);
        }
      }
    }
    float* const sums_here = sums + std::ptrdiff_t{4} * kHarmonicFloats * four;
    for (int k = 0; k < kDegrees; k += 2) add_folded(rows + k * kRowFloats, sums_here + k * kHarmonicFloats);
  }
}

int find_start(const double* a, const double* x, const double* sectoral, double threshold, int last, double* state) {
  constexpr int parts = kRingLanes / kWidth;
  const DoubleLanes least(threshold);
  double most = 0.0;
  for (int k = 0; k < kRingLanes; k += kDoubleWidth) {
    const DoubleLanes first = DoubleLanes::load_unaligned(sectoral + k);
    first.store_aligned(state + k);
    // Q(m + 1) = a(m + 1) x Q(m), for Q(m - 1) = 0.
    (DoubleLanes(a[1]) * DoubleLanes::load_aligned(x + k) * first).store_aligned(state + kRingLanes + k);
  }
  for (int k = 0; k < kRingLanes; ++k) most = most < sectoral[k] ? sectoral[k] : most;
  if (most == 0.0) return last;
  int four = 0;
  for (; four < last; ++four, a += 4) {
    bool reached = false;
    for (int part = 0; part < parts; ++part) {
      const double* const at = state + part * kWidth;
      for (int k = 0; k < 2 * kRingLanes; k += kRingLanes) {
        reached = reached || any_reaches(DoubleLanes::load_aligned(at + k), least) ||
                  any_reaches(DoubleLanes::load_aligned(at + k + kDoubleWidth), least);
      }
    }
    if (reached) break;
    for (int part = 0; part < kRingLanes; part += kDoubleWidth) {
      const DoubleLanes position = DoubleLanes::load_aligned(x + part);
      DoubleLanes even = DoubleLanes::load_aligned(state + part);
      DoubleLanes odd = DoubleLanes::load_aligned(state + kRingLanes + part);
      for (int i = 2; i < 6; i += 2) {
        even = DoubleLanes(a[i]) * position * odd - even;
        odd = DoubleLanes(a[i + 1]) * position * even - odd;
      }
      even.store_aligned(state + part);
      odd.store_aligned(state + kRingLanes + part);
    }
  }
  return four;
}

void synthesise_order(const LegendreRun& run, const float* coefficients, float* columns) {
  alignas(64) float single[kStateDoubles];
  for (int group = 0; group < run.groups; ++group) {
    const double* const state = run.states + std::ptrdiff_t{kStateDoubles} * group;
    float* const column = columns + std::ptrdiff_t{kColumnFloats} * group;
    if (group >= run.first_single) narrow_state(state, single);
    for (int part = 0; part < kRingLanes; part += kWidth) {
      if (group < run.first_single) {
        sum_degrees<DoubleState>(run, group, part, state + part, coefficients, column + part);
      } else {
        sum_degrees<SingleState>(run, group, part, single + part, coefficients, column + part);
      }
    }
  }
}

void sum_functions(const float* functions, const float* coefficients, int degrees, float* column) {
  for (int part = 0; part < kRingLanes; part += kWidth) {
    Sums<kNumbers> even;
    Sums<kNumbers> odd;
    const float* function = functions + part;
    for (int i = 0; i < degrees; i += 2, function += std::ptrdiff_t{2} * kRingLanes) {
      const float* const here = coefficients + std::ptrdiff_t{kHarmonicFloats} * i;
      even.add_all(Lanes::load_aligned(function), here);
      odd.add_all(Lanes::load_aligned(function + kRingLanes), here + kHarmonicFloats);
    }
    even.store(column + part);
    odd.store(column + kNumbers * kRingLanes + part);
  }
}

// Steps for one order m between Legendre sums and coefficients, as plain loops, which compilers vectorize.

void weigh_odd_parts(const float* columns, const double* weights, int groups, double* sums) {
  constexpr int numbers = 6;
  alignas(64) double lanes[numbers * kRingLanes] = {};
  for (int group = 0; group < groups; ++group) {
    const float* const odd = columns + std::ptrdiff_t{kColumnFloats} * group + numbers * kRingLanes;
    const double* const weight = weights + std::ptrdiff_t{kRingLanes} * group;
    for (int number = 0; number < numbers; ++number) {
      for (int k = 0; k < kRingLanes; ++k) {
        lanes[number * kRingLanes + k] += static_cast<double>(odd[number * kRingLanes + k]) * weight[k];
      }
    }
  }
  for (int number = 0; number < numbers; ++number) {
    double* const lane = lanes + number * kRingLanes;
    for (int half = kRingLanes / 2; half > 0; half /= 2) {
      for (int k = 0; k < half; ++k) lane[k] += lane[k + half];
    }
    sums[number] = lane[0];
  }
}

void integrate_sums(const IntegralRun& run, const float* sums, float* coefficients) {
  // The integral over the polar angle is not conjugated by the sign of the exponent, its data are: hence conj.
  alignas(64) double before[kHarmonicFloats] = {};  // J(l - 2)
  alignas(64) double here[kHarmonicFloats] = {};    // J(l - 1), and then J(l)
  for (int i = 0; i < run.count; ++i) {
    alignas(64) double next[kHarmonicFloats] = {};
    if (i == 0) {
      for (int k = 0; k < 6; ++k) next[k] = run.first[k];
    } else {
      const float* const sum = sums + std::ptrdiff_t{kHarmonicFloats} * (i - 1);
      for (int k = 0; k < kHarmonicFloats; ++k) {
        // J(l) = alpha(l) J(l - 2) - beta(l) K(l - 1): the recurrence of the integrals (ring_legendre.h), summed over
        // rows by parts (spectrum.cpp).
        next[k] = run.alpha[i] * before[k] - run.beta[i] * static_cast<double>(sum[k]);
      }
    }
    float* const out = coefficients + std::ptrdiff_t{kHarmonicFloats} * i;
    for (int k = 0; k < kHarmonicFloats; k += 2) {
      // phase conj J = (pr Jr + pi Ji) + i (pi Jr - pr Ji).
      out[k] = static_cast<float>(run.phase_real * next[k] + run.phase_imaginary * next[k + 1]);
      out[k + 1] = static_cast<float>(run.phase_imaginary * next[k] - run.phase_real * next[k + 1]);
    }
    for (int k = 0; k < kHarmonicFloats; ++k) {
      before[k] = here[k];
      here[k] = next[k];
    }
  }
}

void scale_harmonics(const ScaleRun& run, const float* in, float* out) {
  for (int i = 0; i < run.count; ++i) {
    const double scale = run.scale[i] * run.gamma[i];
    const auto real = static_cast<float>(scale * run.phase_real);
    const auto imaginary = static_cast<float>(scale * run.phase_imaginary);
    const float* const from = in + std::ptrdiff_t{kHarmonicFloats} * i;
    float* const to = out + std::ptrdiff_t{kHarmonicFloats} * i;
    for (int k = 0; k < kHarmonicFloats; k += 2) {
      to[k] = real * from[k] - imaginary * from[k + 1];
      to[k + 1] = real * from[k + 1] + imaginary * from[k];
    }
  }
}

// B-spline coefficients down the rings.
//
// With z = sqrt(3) - 2 and s the shift by a ring, (s^-1 + 4 + s) / 6 = (1 - z s) (1 - z s^-1) / kSplineGain. Its
// inverse is a recursion, which would go ring by ring; but 1 / (1 - z s) is the product of (1 + (z s)^(2^k)) for k = 0,
// 1, 2, ..., and four factors leave out only z^16 = 7e-10. So every ring is served at once.

// z^2 + 4 z + 1 = 0 gives 1 + z^2 = -4 z, so (1 - z s) (1 - z s^-1) = 1 + z^2 - z (s + s^-1) = -6 z (s^-1 + 4 + s) / 6,
// and kSplineGain = -6 z. The product of the first four factors is (1 - (z s)^16) / (1 - z s), exactly. Four sums of
// two reach 1 + 2 + 4 + 8 = 15 rings each way, and a ring beyond a pole or the equator is another ring's with a sign
// (`mirrored`), so no boundary condition is needed.
constexpr int kRows = 12;   // of a column: two parts of six numbers
constexpr int kReach = 15;  // rings that four factors bring together, each way

/// Where ring pair `pair`, beyond a pole or the equator, is to be found: the pair, and the signs of its parts.
struct Mirrored {
  int pair;
  float even_sign;
  float odd_sign;
};

WELKIN_INLINE Mirrored mirrored(int pair, const SplineRun& run) {
  const int circle = 2 * run.rings;
  int ring = pair;
  while (ring < 0) ring += circle;
  while (ring >= circle) ring -= circle;
  float sign = 1.0F;
  if (ring >= run.rings) {
    ring = circle - 1 - ring;
    if (run.odd_order) sign = -1.0F;
  }
  // The rings on a meridian and on the opposite one make a circle of 2 rings. 180 degrees further order m has the sign
  // (-1)^m. South of the equator the value is even - odd.
  const bool south = ring >= (run.rings + 1) / 2;
  return {south ? run.rings - 1 - ring : ring, sign, south ? -sign : sign};
}

WELKIN_INLINE void gather_ring(const SplineRun& run, const float* columns, int length, int pair, float* rows) {
  const Mirrored from = mirrored(pair, run);
  const float* const column =
      columns + std::ptrdiff_t{kColumnFloats} * (from.pair / kRingLanes) + from.pair % kRingLanes;
  float* const to = rows + kSplineMargin + pair;
  for (int row = 0; row < kRows; ++row) {
    const float sign = row < kRows / 2 ? from.even_sign : from.odd_sign;
    to[std::ptrdiff_t{length} * row] = sign * column[row * kRingLanes];
  }
}

/// The column numbers as rows of rings, continued by kReach on both sides; the rest of the margins is zero.
WELKIN_INLINE void gather(const SplineRun& run, const float* columns, int length, float* rows) {
  const int pairs = (run.rings + 1) / 2;
  const int whole = pairs / kRingLanes;  // groups without an empty lane
  for (int row = 0; row < kRows; ++row) {
    float* const to = rows + std::ptrdiff_t{length} * row;
    for (int k = 0; k < kSplineMargin; k += kWidth) Lanes(0.0F).store_aligned(to + k);
    for (int group = 0; group < whole; ++group) {
      const float* const from = columns + std::ptrdiff_t{kColumnFloats} * group + row * kRingLanes;
      float* const here = to + kSplineMargin + std::ptrdiff_t{kRingLanes} * group;
      for (int k = 0; k < kRingLanes; k += kWidth) Lanes::load_aligned(from + k).store_aligned(here + k);
    }
    for (int k = kSplineMargin + whole * kRingLanes; k < length; k += kWidth) Lanes(0.0F).store_aligned(to + k);
  }
  for (int pair = -kReach; pair < 0; ++pair) gather_ring(run, columns, length, pair, rows);
  for (int pair = whole * kRingLanes; pair < pairs + kReach; ++pair) gather_ring(run, columns, length, pair, rows);
}

void spline_rings(const SplineRun& run, float* columns, float* scratch) {
  const int length = run.groups * kRingLanes + 2 * kSplineMargin;
  gather(run, columns, length, scratch);
  // Margins are 32 floats, of which the inner 15 hold neighbours. The first loop leaves out the outer 16: what it would
  // have to read lies before the buffer, and no ring is reached from there. The second one writes from the first ring
  // on.
  constexpr int shifts[4] = {1, 2, 4, 8};
  constexpr float z = -0.267949192431122706F;
  constexpr float powers[4] = {z, z * z, z * z * z * z, z * z * z * z * z * z * z * z};
  // All rows take a step before any takes the next: a load that straddles two stores still on their way would wait.
  const auto each_row = [&](const auto& step) WELKIN_INLINE_LAMBDA {
    for (int row = 0; row < kRows; ++row) step(scratch + std::ptrdiff_t{length} * row, row);
  };
  for (int k = 0; k < 4; ++k) {
    const Lanes power(powers[k]);
    const int shift = shifts[k];
    each_row([&](float* values, int) WELKIN_INLINE_LAMBDA {
      // 1 + power s^shift in place, from the last ring down, so that values i - shift are still the old ones; the
      // factors of s^-1 run upwards for the same reason.
      for (int i = length - kWidth; i >= kRingLanes; i -= kWidth) {
        const Lanes sum = Lanes::load_aligned(values + i) + power * Lanes::load_unaligned(values + i - shift);
        sum.store_aligned(values + i);
      }
    });
  }
  for (int k = 0; k < 4; ++k) {
    const Lanes power(powers[k]);
    const int shift = shifts[k];
    each_row([&](float* values, int) WELKIN_INLINE_LAMBDA {
      for (int i = kSplineMargin; i < length - kRingLanes; i += kWidth) {
        const Lanes sum = Lanes::load_aligned(values + i) + power * Lanes::load_unaligned(values + i + shift);
        sum.store_aligned(values + i);
      }
    });
  }
  each_row([&](const float* values, int row) WELKIN_INLINE_LAMBDA {
    for (int group = 0; group < run.groups; ++group) {
      const float* const from = values + kSplineMargin + std::ptrdiff_t{kRingLanes} * group;
      float* const to = columns + std::ptrdiff_t{kColumnFloats} * group + row * kRingLanes;
      for (int k = 0; k < kRingLanes; k += kWidth) Lanes::load_aligned(from + k).store_aligned(to + k);
    }
  });
}

}  // namespace

const LegendreKernels legendre_kernels_table = {
    .analyse_order = analyse_order,
    .synthesise_order = synthesise_order,
    .find_start = find_start,
    .weigh_odd_parts = weigh_odd_parts,
    .integrate_sums = integrate_sums,
    .scale_harmonics = scale_harmonics,
    .spline_rings = spline_rings,
    .sum_functions = sum_functions,
};

}  // namespace welkin::transforms::WELKIN_ISA
