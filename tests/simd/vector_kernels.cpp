#include "simd/vector_kernels.h"

#include "simd/vec.h"

namespace welkin::test::WELKIN_ISA {
namespace {

using simd::Block, simd::DoubleLanes, simd::kBlock, simd::kDoubleWidth, simd::kLanes, simd::kParts, simd::kWidth,
    simd::Lanes;

template <class Operation>
WELKIN_INLINE void each(const float* a, const float* b, float* to, const Operation& operation) {
  for (int k = 0; k < kLanes; k += kWidth) {
    operation(Lanes::load_unaligned(a + k), Lanes::load_unaligned(b + k)).store_unaligned(to + k);
  }
}

template <class Operation>
WELKIN_INLINE void each(const double* a, const double* b, double* to, const Operation& operation) {
  for (int k = 0; k < kLanes; k += kDoubleWidth) {
    operation(DoubleLanes::load_unaligned(a + k), DoubleLanes::load_unaligned(b + k)).store_unaligned(to + k);
  }
}

// clang-format off
void sum(const float* a, const float* b, float* to) { each(a, b, to, [](auto x, auto y) { return x + y; }); }
void difference(const float* a, const float* b, float* to) { each(a, b, to, [](auto x, auto y) { return x - y; }); }
void product(const float* a, const float* b, float* to) { each(a, b, to, [](auto x, auto y) { return x * y; }); }
void quotient(const float* a, const float* b, float* to) { each(a, b, to, [](auto x, auto y) { return x / y; }); }
void root(const float* a, const float* b, float* to) { each(a, b, to, [](auto x, auto) { return xsimd::sqrt(x); }); }
void least(const float* a, const float* b, float* to) { each(a, b, to, [](auto x, auto y) { return xsimd::min(x, y); }); }
void largest(const float* a, const float* b, float* to) { each(a, b, to, [](auto x, auto y) { return xsimd::max(x, y); }); }
void magnitude(const float* a, const float* b, float* to) { each(a, b, to, [](auto x, auto) { return xsimd::abs(x); }); }
void select_less(const float* a, const float* b, float* to) {
  each(a, b, to, [](auto x, auto y) { return xsimd::select(x < y, x, y); });
}
void whole(const float* a, const float* b, float* to) {
  each(a, b, to, [](auto x, auto) { return xsimd::to_float(xsimd::to_int(x)); });
}
void double_quotient(const double* a, const double* b, double* to) { each(a, b, to, [](auto x, auto y) { return x / y; }); }
void double_root(const double* a, const double* b, double* to) { each(a, b, to, [](auto x, auto) { return xsimd::sqrt(x); }); }
void double_least(const double* a, const double* b, double* to) { each(a, b, to, [](auto x, auto y) { return xsimd::min(x, y); }); }
void double_largest(const double* a, const double* b, double* to) { each(a, b, to, [](auto x, auto y) { return xsimd::max(x, y); }); }
// clang-format on

void narrowed(const double* a, float* to) {
  for (int k = 0; k < kLanes; k += kWidth) {
    simd::narrow(DoubleLanes::load_unaligned(a + k), DoubleLanes::load_unaligned(a + k + kDoubleWidth))
        .store_unaligned(to + k);
  }
}

void widened(const float* a, double* to) {
  for (int k = 0; k < kLanes; k += kDoubleWidth) simd::load_widened(a + k).store_unaligned(to + k);
}

void comparisons(const float* a, const float* b, int* to) {
  const Lanes one(1.0F);
  const Lanes none(0.0F);
  float counts[5][kLanes];
  for (int k = 0; k < kLanes; k += kWidth) {
    const Lanes x = Lanes::load_unaligned(a + k);
    const Lanes y = Lanes::load_unaligned(b + k);
    xsimd::select(x < y, one, none).store_unaligned(counts[0] + k);
    xsimd::select(x <= y, one, none).store_unaligned(counts[1] + k);
    xsimd::select(x > y, one, none).store_unaligned(counts[2] + k);
    xsimd::select(x >= y, one, none).store_unaligned(counts[3] + k);
    xsimd::select(x == y, one, none).store_unaligned(counts[4] + k);
  }
  for (int i = 0; i < 5; ++i) {
    to[i] = 0;
    for (int k = 0; k < kLanes; ++k) to[i] += counts[i][k] > 0.0F ? 1 : 0;
  }
}

bool any_less(const float* a, const float* b) {
  return xsimd::any(Lanes::load_unaligned(a) < Lanes::load_unaligned(b));
}
bool all_less(const float* a, const float* b) {
  return xsimd::all(Lanes::load_unaligned(a) < Lanes::load_unaligned(b));
}

WELKIN_INLINE simd::Texels texels_at(const float* from) {
  simd::Texels texels;
  for (int k = 0; k < kParts; ++k) texels.part[k] = Lanes::load_unaligned(from + k * kWidth);
  return texels;
}
WELKIN_INLINE void store(const simd::Texels& texels, float* to) {
  for (int k = 0; k < kParts; ++k) texels.part[k].store_unaligned(to + k * kWidth);
}

bool no_bit_set(const float* texels) { return simd::no_bit_set(texels_at(texels)); }

/// `load(k)`: the Rgb of the registers of texels from k on. Reversed, those of the last texels come first.
template <class Load>
WELKIN_INLINE void store_rgb(bool reversed, float* rgb, const Load& load) {
  for (int k = 0; k < kLanes; k += kWidth) {
    const simd::Rgb channels = load(k);
    const int index = reversed ? kLanes - kWidth - k : k;
    channels.red.store_unaligned(rgb + index);
    channels.green.store_unaligned(rgb + kLanes + index);
    channels.blue.store_unaligned(rgb + 2 * kLanes + index);
  }
}

void load_rgb(const float* texels, bool reversed, float* rgb) {
  store_rgb(reversed, rgb, [&](int k) {
    return reversed ? simd::load_rgb<true>(texels + 3 * k) : simd::load_rgb<false>(texels + 3 * k);
  });
}
template <class Channel>
WELKIN_INLINE void load_four(const Channel* texels, bool reversed, float* rgb) {
  store_rgb(reversed, rgb, [&](int k) {
    return reversed ? simd::load_rgba<true>(texels + 4 * k) : simd::load_rgba<false>(texels + 4 * k);
  });
}
void load_rgba(const float* texels, bool reversed, float* rgb) { load_four(texels, reversed, rgb); }
void load_half_rgba(const std::uint16_t* texels, bool reversed, float* rgb) { load_four(texels, reversed, rgb); }

void load_rgb_texels(const float* texels, float* to) { store(simd::load_rgb_texels(texels), to); }
void weighted_columns(const float* texels, const float* weights, bool reversed, float* to) {
  store(reversed ? simd::weighted_columns<true>(texels_at(texels), weights)
                 : simd::weighted_columns(texels_at(texels), weights),
        to);
}
void folded(const float* texels, float* to) { simd::folded(texels_at(texels)).store_unaligned(to); }

void store_thrice(const float* a, float* to) {
  for (int k = 0; k < kLanes; k += kWidth) simd::store_thrice(Lanes::load_unaligned(a + k), to + 3 * k);
}
void reverse_rgb(const float* texels, float* to) { simd::reverse_rgb(texels, to); }

void transposed(const float* rows, float* to, int* size) {
  Block block[kBlock];
  for (int k = 0; k < kBlock; ++k) block[k] = Block::load_unaligned(rows + k * kLanes);
  simd::transpose(block);
  for (int k = 0; k < kBlock; ++k) block[k].store_unaligned(to + k * kLanes);
  *size = kBlock;
}
void sum_rows(const float* rows, float* sums) {
  for (int row = 0; row < kLanes; row += kBlock) {
    Block block;
    simd::sum_rows(rows + row * kLanes, block);
    block.store_unaligned(sums + row);
  }
}

}  // namespace

const VectorKernels vector_kernels_table = {
    .sum = sum,
    .difference = difference,
    .product = product,
    .quotient = quotient,
    .root = root,
    .least = least,
    .largest = largest,
    .magnitude = magnitude,
    .select_less = select_less,
    .whole = whole,
    .double_quotient = double_quotient,
    .double_root = double_root,
    .double_least = double_least,
    .double_largest = double_largest,
    .narrowed = narrowed,
    .widened = widened,
    .comparisons = comparisons,
    .any_less = any_less,
    .all_less = all_less,
    .no_bit_set = no_bit_set,
    .load_rgb = load_rgb,
    .load_rgba = load_rgba,
    .load_half_rgba = load_half_rgba,
    .load_rgb_texels = load_rgb_texels,
    .weighted_columns = weighted_columns,
    .folded = folded,
    .store_thrice = store_thrice,
    .reverse_rgb = reverse_rgb,
    .transposed = transposed,
    .sum_rows = sum_rows,
};

}  // namespace welkin::test::WELKIN_ISA
