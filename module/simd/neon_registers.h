// Registers of NEON with operators: that part of xsimd's interface that kernels use, under xsimd's name, which the
// command line makes xsimd_neon as it makes xsimd_avx2 of the library's own.
//
// xsimd itself does not do here. Its version 8.1 divides floats and takes their square roots by estimates and Newton's
// steps, whose last bits are wrong; and NEON's minimum of a number and a NaN is NaN, where x86 has the second operand.
// Every function here gives the bits that its namesake gives on x86, NaNs excepted: which NaN results (sign, payload)
// may differ.
#pragma once

#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

#include "platform/compiler.h"

namespace xsimd {

/// The only set of instructions.
struct neon64 {};

namespace detail {

/// The intrinsics for one type of value, by the names that xsimd has for them.
template <class Value>
struct Intrinsics;

template <>
struct Intrinsics<float> {
  using Register = float32x4_t;
  using Mask = uint32x4_t;
  static WELKIN_INLINE Register all(float value) { return vdupq_n_f32(value); }
  static WELKIN_INLINE Register load(const float* from) { return vld1q_f32(from); }
  static WELKIN_INLINE void store(float* to, Register a) { vst1q_f32(to, a); }
  static WELKIN_INLINE Register add(Register a, Register b) { return vaddq_f32(a, b); }
  static WELKIN_INLINE Register sub(Register a, Register b) { return vsubq_f32(a, b); }
  static WELKIN_INLINE Register mul(Register a, Register b) { return vmulq_f32(a, b); }
  static WELKIN_INLINE Register div(Register a, Register b) { return vdivq_f32(a, b); }
  static WELKIN_INLINE Register sqrt(Register a) { return vsqrtq_f32(a); }
  static WELKIN_INLINE Register abs(Register a) { return vabsq_f32(a); }
  static WELKIN_INLINE Mask less(Register a, Register b) { return vcltq_f32(a, b); }
  static WELKIN_INLINE Mask at_most(Register a, Register b) { return vcleq_f32(a, b); }
  static WELKIN_INLINE Mask equal(Register a, Register b) { return vceqq_f32(a, b); }
  static WELKIN_INLINE Register select(Mask mask, Register a, Register b) { return vbslq_f32(mask, a, b); }
  static WELKIN_INLINE uint32x4_t bits(Register a) { return vreinterpretq_u32_f32(a); }
  static WELKIN_INLINE Register from_bits(uint32x4_t a) { return vreinterpretq_f32_u32(a); }
};

template <>
struct Intrinsics<double> {
  using Register = float64x2_t;
  using Mask = uint64x2_t;
  static WELKIN_INLINE Register all(double value) { return vdupq_n_f64(value); }
  static WELKIN_INLINE Register load(const double* from) { return vld1q_f64(from); }
  static WELKIN_INLINE void store(double* to, Register a) { vst1q_f64(to, a); }
  static WELKIN_INLINE Register add(Register a, Register b) { return vaddq_f64(a, b); }
  static WELKIN_INLINE Register sub(Register a, Register b) { return vsubq_f64(a, b); }
  static WELKIN_INLINE Register mul(Register a, Register b) { return vmulq_f64(a, b); }
  static WELKIN_INLINE Register div(Register a, Register b) { return vdivq_f64(a, b); }
  static WELKIN_INLINE Register sqrt(Register a) { return vsqrtq_f64(a); }
  static WELKIN_INLINE Register abs(Register a) { return vabsq_f64(a); }
  static WELKIN_INLINE Mask less(Register a, Register b) { return vcltq_f64(a, b); }
  static WELKIN_INLINE Mask at_most(Register a, Register b) { return vcleq_f64(a, b); }
  static WELKIN_INLINE Mask equal(Register a, Register b) { return vceqq_f64(a, b); }
  static WELKIN_INLINE Register select(Mask mask, Register a, Register b) { return vbslq_f64(mask, a, b); }
  static WELKIN_INLINE uint32x4_t bits(Register a) { return vreinterpretq_u32_f64(a); }
  static WELKIN_INLINE Register from_bits(uint32x4_t a) { return vreinterpretq_f64_u32(a); }
};

template <>
struct Intrinsics<std::int32_t> {
  using Register = int32x4_t;
  using Mask = uint32x4_t;
  static WELKIN_INLINE Register all(std::int32_t value) { return vdupq_n_s32(value); }
  static WELKIN_INLINE Register load(const std::int32_t* from) { return vld1q_s32(from); }
  static WELKIN_INLINE void store(std::int32_t* to, Register a) { vst1q_s32(to, a); }
  static WELKIN_INLINE Register add(Register a, Register b) { return vaddq_s32(a, b); }
  static WELKIN_INLINE Register sub(Register a, Register b) { return vsubq_s32(a, b); }
  static WELKIN_INLINE Register mul(Register a, Register b) { return vmulq_s32(a, b); }
  static WELKIN_INLINE Mask less(Register a, Register b) { return vcltq_s32(a, b); }
  static WELKIN_INLINE Mask at_most(Register a, Register b) { return vcleq_s32(a, b); }
  static WELKIN_INLINE Mask equal(Register a, Register b) { return vceqq_s32(a, b); }
  static WELKIN_INLINE Register select(Mask mask, Register a, Register b) { return vbslq_s32(mask, a, b); }
  static WELKIN_INLINE uint32x4_t bits(Register a) { return vreinterpretq_u32_s32(a); }
  static WELKIN_INLINE Register from_bits(uint32x4_t a) { return vreinterpretq_s32_u32(a); }
};

WELKIN_INLINE uint32x4_t words(uint32x4_t mask) { return mask; }
WELKIN_INLINE uint32x4_t words(uint64x2_t mask) { return vreinterpretq_u32_u64(mask); }
WELKIN_INLINE void from_words(uint32x4_t words, uint32x4_t& mask) { mask = words; }
WELKIN_INLINE void from_words(uint32x4_t words, uint64x2_t& mask) { mask = vreinterpretq_u64_u32(words); }

}  // namespace detail

/// Result of a comparison: all bits of a lane are set, or none.
template <class Value, class Arch>
struct batch_bool {
  using Mask = typename detail::Intrinsics<Value>::Mask;
  Mask data;

  batch_bool() = default;
  WELKIN_INLINE batch_bool(Mask mask) : data(mask) {}
  WELKIN_INLINE explicit batch_bool(bool value) { detail::from_words(vdupq_n_u32(value ? ~0U : 0U), data); }

  friend WELKIN_INLINE batch_bool operator&(batch_bool a, batch_bool b) {
    return of(vandq_u32(detail::words(a.data), detail::words(b.data)));
  }
  friend WELKIN_INLINE batch_bool operator|(batch_bool a, batch_bool b) {
    return of(vorrq_u32(detail::words(a.data), detail::words(b.data)));
  }
  friend WELKIN_INLINE batch_bool operator&&(batch_bool a, batch_bool b) { return a & b; }
  friend WELKIN_INLINE batch_bool operator||(batch_bool a, batch_bool b) { return a | b; }
  friend WELKIN_INLINE batch_bool operator!(batch_bool a) { return of(vmvnq_u32(detail::words(a.data))); }

 private:
  static WELKIN_INLINE batch_bool of(uint32x4_t words) {
    batch_bool result(false);
    detail::from_words(words, result.data);
    return result;
  }
};

/// A register of values.
template <class Value, class Arch>
struct batch {
  using arch_type = Arch;
  using value_type = Value;
  using register_type = typename detail::Intrinsics<Value>::Register;
  static constexpr std::size_t size = 16 / sizeof(Value);
  register_type data;

 private:
  using Do = detail::Intrinsics<Value>;
  using Bool = batch_bool<Value, Arch>;

 public:
  batch() = default;
  WELKIN_INLINE batch(register_type values) : data(values) {}
  WELKIN_INLINE batch(Value value) : data(Do::all(value)) {}
  template <class... Others>
  requires(sizeof...(Others) + 1 == size) WELKIN_INLINE batch(Value first, Others... others) : data{first, others...} {}
  WELKIN_INLINE operator register_type() const { return data; }

  static WELKIN_INLINE batch load_aligned(const Value* from) { return Do::load(from); }
  static WELKIN_INLINE batch load_unaligned(const Value* from) { return Do::load(from); }
  WELKIN_INLINE void store_aligned(Value* to) const { Do::store(to, data); }
  WELKIN_INLINE void store_unaligned(Value* to) const { Do::store(to, data); }

  friend WELKIN_INLINE batch operator+(batch a, batch b) { return Do::add(a.data, b.data); }
  friend WELKIN_INLINE batch operator-(batch a, batch b) { return Do::sub(a.data, b.data); }
  friend WELKIN_INLINE batch operator*(batch a, batch b) { return Do::mul(a.data, b.data); }
  friend WELKIN_INLINE batch operator/(batch a, batch b) { return Do::div(a.data, b.data); }
  WELKIN_INLINE batch operator-() const {
    return Do::from_bits(veorq_u32(Do::bits(data), Do::bits(Do::all(Value(-0.0F)))));
  }
  WELKIN_INLINE batch& operator+=(batch b) { return *this = *this + b; }

  friend WELKIN_INLINE batch operator&(batch a, batch b) {
    return Do::from_bits(vandq_u32(Do::bits(a.data), Do::bits(b.data)));
  }
  friend WELKIN_INLINE batch operator|(batch a, batch b) {
    return Do::from_bits(vorrq_u32(Do::bits(a.data), Do::bits(b.data)));
  }
  friend WELKIN_INLINE batch operator^(batch a, batch b) {
    return Do::from_bits(veorq_u32(Do::bits(a.data), Do::bits(b.data)));
  }
  /// Shifts integers; a shift to the right is arithmetic.
  friend WELKIN_INLINE batch operator<<(batch a, std::int32_t count) { return vshlq_s32(a.data, vdupq_n_s32(count)); }
  friend WELKIN_INLINE batch operator>>(batch a, std::int32_t count) { return vshlq_s32(a.data, vdupq_n_s32(-count)); }

  friend WELKIN_INLINE Bool operator<(batch a, batch b) { return Do::less(a.data, b.data); }
  friend WELKIN_INLINE Bool operator<=(batch a, batch b) { return Do::at_most(a.data, b.data); }
  friend WELKIN_INLINE Bool operator>(batch a, batch b) { return Do::less(b.data, a.data); }
  friend WELKIN_INLINE Bool operator>=(batch a, batch b) { return Do::at_most(b.data, a.data); }
  friend WELKIN_INLINE Bool operator==(batch a, batch b) { return Do::equal(a.data, b.data); }
};

template <class Value, class Arch>
WELKIN_INLINE batch<Value, Arch> select(batch_bool<Value, Arch> mask, batch<Value, Arch> a, batch<Value, Arch> b) {
  return detail::Intrinsics<Value>::select(mask.data, a.data, b.data);
}

/// The second one if either is NaN or both are zeros, as MINPS and MAXPS have it.
template <class Value, class Arch>
WELKIN_INLINE batch<Value, Arch> min(batch<Value, Arch> a, batch<Value, Arch> b) {
  return select(a < b, a, b);
}
template <class Value, class Arch>
WELKIN_INLINE batch<Value, Arch> max(batch<Value, Arch> a, batch<Value, Arch> b) {
  return select(a > b, a, b);
}

template <class Value, class Arch>
WELKIN_INLINE batch<Value, Arch> sqrt(batch<Value, Arch> a) {
  return detail::Intrinsics<Value>::sqrt(a.data);
}
template <class Value, class Arch>
WELKIN_INLINE batch<Value, Arch> abs(batch<Value, Arch> a) {
  return detail::Intrinsics<Value>::abs(a.data);
}

template <class Value, class Arch>
WELKIN_INLINE bool all(batch_bool<Value, Arch> mask) {
  return vminvq_u32(detail::words(mask.data)) != 0;
}
template <class Value, class Arch>
WELKIN_INLINE bool any(batch_bool<Value, Arch> mask) {
  return vmaxvq_u32(detail::words(mask.data)) != 0;
}
template <class Value, class Arch>
WELKIN_INLINE bool none(batch_bool<Value, Arch> mask) {
  return !any(mask);
}

/// Towards zero. What is beyond an int, or NaN, gives what it gives on x86: the least int.
template <class Arch>
WELKIN_INLINE batch<std::int32_t, Arch> to_int(batch<float, Arch> a) {
  const uint32x4_t fits = vcltq_f32(vabsq_f32(a.data), vdupq_n_f32(2147483648.0F));
  return vbslq_s32(fits, vcvtq_s32_f32(a.data), vdupq_n_s32(INT32_MIN));
}
template <class Arch>
WELKIN_INLINE batch<float, Arch> to_float(batch<std::int32_t, Arch> a) {
  return vcvtq_f32_s32(a.data);
}

template <class To, class Value, class Arch>
WELKIN_INLINE To bitwise_cast(batch<Value, Arch> a) {
  return detail::Intrinsics<typename To::value_type>::from_bits(detail::Intrinsics<Value>::bits(a.data));
}

}  // namespace xsimd
