// Fourier transforms of 16 rings at once: a lane a ring, so that no number ever changes lanes. And what makes rings of
// rows of pixels.
#include "simd/vec.h"
#include "transform/transform_kernels.h"

namespace welkin::transforms::WELKIN_ISA {
namespace {

using simd::Block, simd::kBlock, simd::kWidth, simd::Lanes, simd::transpose;

struct Complex {
  Lanes re, im;
};

WELKIN_INLINE Complex load(const float* at) { return {Lanes::load_aligned(at), Lanes::load_aligned(at + kRingLanes)}; }
WELKIN_INLINE void store(Complex z, float* at) {
  z.re.store_aligned(at);
  z.im.store_aligned(at + kRingLanes);
}
WELKIN_INLINE Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
WELKIN_INLINE Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
WELKIN_INLINE Complex operator*(Complex a, Lanes s) { return {a.re * s, a.im * s}; }
WELKIN_INLINE Complex times(Complex a, Complex b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
/// a - i b and a + i b
WELKIN_INLINE Complex plus_turned_back(Complex a, Complex b) { return {a.re + b.im, a.im - b.re}; }
WELKIN_INLINE Complex plus_turned(Complex a, Complex b) { return {a.re - b.im, a.im + b.re}; }
WELKIN_INLINE Complex factor_at(const float* factor) { return {Lanes(factor[0]), Lanes(factor[1])}; }

/// Which output of a butterfly, as a type.
template <int value>
struct Index {
  static constexpr int k = value;
};

// Discrete Fourier transforms of a few numbers: `load(j)` gives the j-th, `put(Index<k>, number)` takes the k-th
// result.

// All have the sign of e^(-2 pi i j k / radix). Inputs j and radix - j meet conjugate roots: with s = x(j) + x(-j) and
// d = x(j) - x(-j)
//   x(j) w^(jk) + x(-j) w^(-jk) = s cos(2 pi j k / radix) - i d sin(2 pi j k / radix),
// so each pair costs real factors only, and outputs k and radix - k share all but one sign: `plus_turned_back`
// (a - i b) and `plus_turned` (a + i b).
struct Radix2 {
  static constexpr int radix = 2;
  template <class Load, class Put>
  WELKIN_INLINE static void run(const Load& get, const Put& put) {
    const Complex a = get(0);
    const Complex b = get(1);
    put(Index<0>(), a + b);
    put(Index<1>(), a - b);
  }
};

struct Radix3 {
  static constexpr int radix = 3;
  template <class Load, class Put>
  WELKIN_INLINE static void run(const Load& get, const Put& put) {
    const Lanes half(0.5F);
    const Lanes sine(0.866025403784438647F);  // of 60 degrees
    const Complex a = get(0);
    const Complex b = get(1);
    const Complex c = get(2);
    const Complex sum = b + c;
    const Complex middle = a - sum * half;
    const Complex across = (b - c) * sine;
    put(Index<0>(), a + sum);
    put(Index<1>(), plus_turned_back(middle, across));
    put(Index<2>(), plus_turned(middle, across));
  }
};

struct Radix4 {
  static constexpr int radix = 4;
  template <class Load, class Put>
  WELKIN_INLINE static void run(const Load& get, const Put& put) {
    const Complex a = get(0);
    const Complex b = get(1);
    const Complex c = get(2);
    const Complex d = get(3);
    const Complex even_sum = a + c;
    const Complex even_difference = a - c;
    const Complex odd_sum = b + d;
    const Complex odd_difference = b - d;
    put(Index<0>(), even_sum + odd_sum);
    put(Index<1>(), plus_turned_back(even_difference, odd_difference));
    put(Index<2>(), even_sum - odd_sum);
    put(Index<3>(), plus_turned(even_difference, odd_difference));
  }
};

struct Radix5 {
  static constexpr int radix = 5;
  template <class Load, class Put>
  WELKIN_INLINE static void run(const Load& get, const Put& put) {
    const Lanes cosine1(0.309016994374947424F);  // of 72 degrees, of 144 degrees
    const Lanes cosine2(-0.809016994374947424F);
    const Lanes sine1(0.951056516295153572F);
    const Lanes sine2(0.587785252292473129F);
    const Complex a = get(0);
    const Complex b = get(1);
    const Complex c = get(2);
    const Complex d = get(3);
    const Complex e = get(4);
    const Complex sum1 = b + e;
    const Complex sum2 = c + d;
    const Complex difference1 = b - e;
    const Complex difference2 = c - d;
    const Complex middle1 = a + sum1 * cosine1 + sum2 * cosine2;
    const Complex middle2 = a + sum1 * cosine2 + sum2 * cosine1;
    const Complex across1 = difference1 * sine1 + difference2 * sine2;
    const Complex across2 = difference1 * sine2 - difference2 * sine1;
    put(Index<0>(), a + sum1 + sum2);
    put(Index<1>(), plus_turned_back(middle1, across1));
    put(Index<2>(), plus_turned_back(middle2, across2));
    put(Index<3>(), plus_turned(middle2, across2));
    put(Index<4>(), plus_turned(middle1, across1));
  }
};

/// Two fours and four twos.
struct Radix8 {
  static constexpr int radix = 8;
  template <class Load, class Put>
  WELKIN_INLINE static void run(const Load& get, const Put& put) {
    const Lanes diagonal(0.707106781186547524F);
    const Complex a = get(0);
    const Complex b = get(1);
    const Complex c = get(2);
    const Complex d = get(3);
    const Complex e = get(4);
    const Complex f = get(5);
    const Complex g = get(6);
    const Complex h = get(7);
    const Complex ae = a + e;
    const Complex cg = c + g;
    const Complex bf = b + f;
    const Complex dh = d + h;
    const Complex even = ae + cg;
    const Complex odd = bf + dh;
    const Complex even_across = ae - cg;
    const Complex odd_across = bf - dh;
    put(Index<0>(), even + odd);
    put(Index<2>(), plus_turned_back(even_across, odd_across));
    put(Index<4>(), even - odd);
    put(Index<6>(), plus_turned(even_across, odd_across));
    const Complex x = a - e;
    const Complex y = c - g;
    const Complex u = b - f;
    const Complex v = d - h;
    const Complex x_back = plus_turned_back(x, y);
    const Complex x_on = plus_turned(x, y);
    const Complex u_back = plus_turned_back(u, v);
    const Complex u_on = plus_turned(u, v);
    // times e^(-i pi / 4) and e^(-3 i pi / 4)
    // e^(-i pi / 4) (p + i q) = ((p + q) + i (q - p)) sqrt(1/2), and e^(-3 i pi / 4) (p + i q) = ((q - p) - i (p + q))
    // sqrt(1/2): `third` has the imaginary part with the opposite sign.
    const Complex first = {(u_back.re + u_back.im) * diagonal, (u_back.im - u_back.re) * diagonal};
    const Complex third = {(u_on.im - u_on.re) * diagonal, (u_on.re + u_on.im) * diagonal};
    put(Index<1>(), x_back + first);
    put(Index<5>(), x_back - first);
    put(Index<3>(), {x_on.re + third.re, x_on.im - third.im});
    put(Index<7>(), {x_on.re - third.re, x_on.im + third.im});
  }
};

/// Runs a whole pass of one small radix. With n = p + count j and k + radix k' the exponent of e^(-2 pi i n
/// (k + radix k') / (count radix)) is p k / (count radix) + j k / radix + p k' / count plus a whole number. The middle
/// term is the butterfly over j, the first the twiddle t(p, k), and the last is the transform over p that the passes
/// after this one do, with a stride of radix times as much. A butterfly's outputs are written `stride` apart
/// (Stockham): after the last pass all are in order, without a permutation.
template <class Butterfly>
void run_single(const FourierPass& pass, const float* in, float* out) {
  constexpr int radix = Butterfly::radix;
  const std::ptrdiff_t stride = std::ptrdiff_t{kComplexFloats} * pass.stride;
  const std::ptrdiff_t in_step = pass.count * stride;
  for (int part = 0; part < kRingLanes; part += kWidth) {
    for (int p = 0; p < pass.count; ++p) {
      const float* const twiddles = pass.twiddles + std::ptrdiff_t{2} * radix * p;
      const float* from = in + p * stride + part;
      float* to = out + radix * p * stride + part;
      const float* const end = from + stride;
      for (; from < end; from += kComplexFloats, to += kComplexFloats) {
        const auto get = [&](int j) WELKIN_INLINE_LAMBDA { return load(from + in_step * j); };
        const auto put = [&](auto index, Complex z) WELKIN_INLINE_LAMBDA {
          constexpr int k = index.k;
          store(k == 0 ? z : times(z, factor_at(twiddles + 2 * k)), to + stride * k);
        };
        Butterfly::run(get, put);
      }
    }
  }
}

// A pass of radix first x second in one go, through a few kilobytes of the first-level cache: half the traffic to the
// second level, which is what limits the transform of a thousand columns.

/// in[j in_step] to local, transformed over j = p + second j1 for every p < second, twiddled.
template <class Butterfly>
void run_first(const float* in, std::ptrdiff_t in_step, int second, const float* twiddles, float* local) {
  constexpr int radix = Butterfly::radix;
  for (int p = 0; p < second; ++p) {
    const auto get = [&](int j) WELKIN_INLINE_LAMBDA { return load(in + in_step * (p + second * j)); };
    float* const to = local + std::ptrdiff_t{kComplexFloats} * radix * p;
    if (p == 0) {
      const auto put = [&](auto index, Complex z) WELKIN_INLINE_LAMBDA { store(z, to + kComplexFloats * index.k); };
      Butterfly::run(get, put);
    } else {
      const float* const t = twiddles + 2 * radix * p;
      const auto put = [&](auto index, Complex z) WELKIN_INLINE_LAMBDA {
        constexpr int k = index.k;
        store(k == 0 ? z : times(z, factor_at(t + 2 * k)), to + kComplexFloats * k);
      };
      Butterfly::run(get, put);
    }
  }
}

/// local to out[k out_step], k = q + first k1, times twiddles[k].
template <class Butterfly>
void run_second(const float* local, int first, const float* twiddles, bool twiddled, float* out,
                std::ptrdiff_t out_step) {
  for (int q = 0; q < first; ++q) {
    const float* const from = local + std::ptrdiff_t{kComplexFloats} * q;
    const auto get = [&](int j)
                         WELKIN_INLINE_LAMBDA { return load(from + std::ptrdiff_t{kComplexFloats} * first * j); };
    if (twiddled) {
      const auto put = [&](auto index, Complex z) WELKIN_INLINE_LAMBDA {
        const int k = q + first * index.k;
        store(times(z, factor_at(twiddles + 2 * k)), out + out_step * k);
      };
      Butterfly::run(get, put);
    } else {
      const auto put = [&](auto index, Complex z)
                           WELKIN_INLINE_LAMBDA { store(z, out + out_step * (q + first * index.k)); };
      Butterfly::run(get, put);
    }
  }
}

using RunFirst = void (*)(const float*, std::ptrdiff_t, int, const float*, float*);
using RunSecond = void (*)(const float*, int, const float*, bool, float*, std::ptrdiff_t);

/// By radix, up to 8.
constexpr RunFirst kRunFirst[] = {nullptr,           nullptr, run_first<Radix2>, run_first<Radix3>, run_first<Radix4>,
                                  run_first<Radix5>, nullptr, nullptr,           run_first<Radix8>};
constexpr RunSecond kRunSecond[] = {
    nullptr, nullptr, run_second<Radix2>, run_second<Radix3>, run_second<Radix4>, run_second<Radix5>,
    nullptr, nullptr, run_second<Radix8>};

/// j = p + second j1 and k = q + first k1: the split above once more, for the inner length first x second. At most 8 x
/// 8 numbers of 16 lanes: 8 KiB.
void run_double(const FourierPass& pass, const float* in, float* out) {
  alignas(64) float local[kComplexFloats * 64];
  const int radix = pass.radix * pass.second_radix;
  const RunFirst first = kRunFirst[pass.radix];
  const RunSecond second = kRunSecond[pass.second_radix];
  const std::ptrdiff_t stride = std::ptrdiff_t{kComplexFloats} * pass.stride;
  for (int part = 0; part < kRingLanes; part += kWidth) {
    for (int p = 0; p < pass.count; ++p) {
      const float* const twiddles = pass.twiddles + std::ptrdiff_t{2} * radix * p;
      for (int q = 0; q < pass.stride; ++q) {
        const std::ptrdiff_t from = p * stride + std::ptrdiff_t{kComplexFloats} * q + part;
        const std::ptrdiff_t to = radix * p * stride + std::ptrdiff_t{kComplexFloats} * q + part;
        first(in + from, pass.count * stride, pass.second_radix, pass.inner_twiddles, local);
        second(local, pass.radix, twiddles, p > 0, out + to, stride);
      }
    }
  }
}

/// Any radix, by its definition.
void run_any_radix(const FourierPass& pass, const float* in, float* out) {
  const int radix = pass.radix;
  const std::ptrdiff_t stride = std::ptrdiff_t{kComplexFloats} * pass.stride;
  for (int part = 0; part < kRingLanes; part += kWidth) {
    for (int p = 0; p < pass.count; ++p) {
      for (int q = 0; q < pass.stride; ++q) {
        const float* const from = in + p * stride + q * kComplexFloats + part;
        float* const to = out + radix * p * stride + q * kComplexFloats + part;
        for (int k = 0; k < radix; ++k) {
          Complex sum = load(from);
          int rotation = 0;  // j k modulo the radix
          for (int j = 1; j < radix; ++j) {
            rotation = rotation + k < radix ? rotation + k : rotation + k - radix;
            sum = sum + times(load(from + pass.count * stride * j), factor_at(pass.roots + 2 * rotation));
          }
          if (k > 0) sum = times(sum, factor_at(pass.twiddles + 2 * (std::ptrdiff_t{radix} * p + k)));
          store(sum, to + stride * k);
        }
      }
    }
  }
}

void run_fourier_pass(const FourierPass& pass, const float* in, float* out) {
  if (pass.second_radix > 1) return run_double(pass, in, out);
  switch (pass.radix) {
    case 2: return run_single<Radix2>(pass, in, out);
    case 3: return run_single<Radix3>(pass, in, out);
    case 4: return run_single<Radix4>(pass, in, out);
    case 5: return run_single<Radix5>(pass, in, out);
    case 8: return run_single<Radix8>(pass, in, out);
    default: return run_any_radix(pass, in, out);
  }
}

void multiply_complex(const float* in, std::ptrdiff_t step, const float* factors, int count, float* out) {
  for (int k = 0; k < count; ++k) {
    const float* const from = in + step * k;
    const Complex factor = {Lanes(factors[2 * k]), Lanes(factors[2 * k + 1])};
    for (int part = 0; part < kRingLanes; part += kWidth) {
      store(times(load(from + part), factor), out + std::ptrdiff_t{kComplexFloats} * k + part);
    }
  }
}

void part_orders(const float* z, int width, int orders, int channel, float* columns, std::ptrdiff_t order_stride) {
  for (int m = 0; m < orders; ++m) {
    // Orders from `width` on repeat: e^(-2 pi i m k / width) depends on m modulo width. Constant texels have these
    // aliases; their size is the sinc of m.
    const int index = m % width;
    const float* const here = z + std::ptrdiff_t{kComplexFloats} * index;
    const float* const mirrored = z + std::ptrdiff_t{kComplexFloats} * (index == 0 ? 0 : width - index);
    float* const even = columns + m * order_stride + std::ptrdiff_t{2} * kRingLanes * channel;
    float* const odd = even + 6 * kRingLanes;
    for (int part = 0; part < kRingLanes; part += kWidth) {
      const Complex a = load(here + part);
      const Complex b = load(mirrored + part);
      // z = even + i odd with both real: their transforms obey F(-m) = conj F(m), so z(m) + conj z(-m) = 2 even(m) and
      // z(m) - conj z(-m) = 2 i odd(m). The factor 2 stays in the columns.
      store({a.re + b.re, a.im - b.im}, even + part);
      store({a.im + b.im, b.re - a.re}, odd + part);
    }
  }
}

void join_orders(const float* columns, std::ptrdiff_t order_stride, int orders, int channel, int width, float* z) {
  for (int m = 0; m < orders; ++m) {
    const float* const even = columns + m * order_stride + std::ptrdiff_t{2} * kRingLanes * channel;
    const float* const odd = even + 6 * kRingLanes;
    float* const here = z + std::ptrdiff_t{kComplexFloats} * m;
    float* const mirrored = z + std::ptrdiff_t{kComplexFloats} * (width - m);
    for (int part = 0; part < kRingLanes; part += kWidth) {
      const Complex a = load(even + part);
      const Complex b = load(odd + part);
      const Complex north = a + b;
      const Complex south = a - b;
      // conj north + i conj south = (re n + im s) + i (re s - im n).
      if (m > 0) store({north.re + south.im, south.re - north.im}, mirrored + part);
      store({north.re - south.im, north.im + south.re}, here + part);
    }
  }
  // Between the orders and their mirror images all is 0.
  const Lanes zero(0.0F);
  float* const end = z + std::ptrdiff_t{kComplexFloats} * (orders > 0 ? width - orders + 1 : width);
  for (float* at = z + std::ptrdiff_t{kComplexFloats} * orders; at < end; at += kWidth) zero.store_aligned(at);
}

// Between rows of pixels in memory and 16 rings in lanes: transpositions.

/// Where float `index` of a row of rgb texels goes: [channel][width][kComplexFloats].
WELKIN_INLINE float* place_of(float* planes, int width, int index) {
  return planes + std::ptrdiff_t{kComplexFloats} * (std::ptrdiff_t{index % 3} * width + index / 3);
}

void load_row_quads(const RowQuads& rows, int width, float* planes) {
  const int floats = 3 * width;
  const int whole = floats - floats % kBlock;
  for (int index = 0; index < whole; index += kBlock) {
    for (int lane = 0; lane < kRingLanes; lane += kBlock) {
      Block even[kBlock];
      Block odd[kBlock];
      for (int k = 0; k < kBlock; ++k) {
        // A difference of two floats that are within a factor of 2 of each other is exact (Sterbenz's lemma): where
        // neighbouring rows are alike, nothing is rounded here.
        const Block north =
            Block::load_unaligned(rows.a[lane + k] + index) - Block::load_unaligned(rows.b[lane + k] + index);
        const Block south =
            Block::load_unaligned(rows.c[lane + k] + index) - Block::load_unaligned(rows.d[lane + k] + index);
        even[k] = north + south;
        odd[k] = north - south;
      }
      transpose(even);
      transpose(odd);
      for (int k = 0; k < kBlock; ++k) {
        float* const to = place_of(planes, width, index + k) + lane;
        even[k].store_aligned(to);
        odd[k].store_aligned(to + kRingLanes);
      }
    }
  }
  for (int index = whole; index < floats; ++index) {
    float* const to = place_of(planes, width, index);
    for (int lane = 0; lane < kRingLanes; ++lane) {
      const float north = rows.a[lane][index] - rows.b[lane][index];
      const float south = rows.c[lane][index] - rows.d[lane][index];
      to[lane] = north + south;
      to[lane + kRingLanes] = north - south;
    }
  }
}

void store_rings(const float* red, const float* green, const float* blue, int width, const RingRows& rows) {
  constexpr int texels = kBlock / 4;  // of a row that are transposed together
  const int whole = width - width % texels;
  for (int half = 0; half < 2; ++half) {
    float* const* const to = half == 0 ? rows.north : rows.south;
    for (int column = 0; column < whole; column += texels) {
      for (int lane = 0; lane < kRingLanes; lane += kBlock) {
        Block block[kBlock];
        for (int t = 0; t < texels; ++t) {
          const std::ptrdiff_t at = std::ptrdiff_t{kComplexFloats} * (column + t) + half * kRingLanes + lane;
          block[4 * t] = Block::load_unaligned(red + at);
          block[4 * t + 1] = Block::load_unaligned(green + at);
          block[4 * t + 2] = Block::load_unaligned(blue + at);
          block[4 * t + 3] = Block(0.0F);
        }
        transpose(block);
        for (int k = 0; k < kBlock; ++k) {
          if (to[lane + k] != nullptr) block[k].store_unaligned(to[lane + k] + std::ptrdiff_t{4} * column);
        }
      }
    }
    for (int column = whole; column < width; ++column) {
      for (int lane = 0; lane < kRingLanes; ++lane) {
        if (to[lane] == nullptr) continue;
        const std::ptrdiff_t at = std::ptrdiff_t{kComplexFloats} * column + half * kRingLanes + lane;
        float* const texel = to[lane] + std::ptrdiff_t{4} * column;
        texel[0] = red[at];
        texel[1] = green[at];
        texel[2] = blue[at];
        texel[3] = 0.0F;
      }
    }
  }
}

// Many rows of pixels to few.

WELKIN_INLINE void share_register(const StepRun& run, float* const* sums, int at) {
  Lanes total[kStepShares];
  for (int k = 0; k < kStepShares; ++k) total[k] = Lanes::load_unaligned(sums[k] + at);
  // Each row is loaded once, as the one below an edge and then the one above the next.
  Lanes above = Lanes::load_unaligned(run.rows[0] + run.first + at);
  for (int edge = 0; edge < run.edges; ++edge) {
    const Lanes below = Lanes::load_unaligned(run.rows[edge + 1] + run.first + at);
    const Lanes step = below - above;
    const float* const shares = run.shares + edge * kStepShares;
    for (int k = 0; k < kStepShares; ++k) total[k] = total[k] + step * Lanes(shares[k]);
    above = below;
  }
  for (int k = 0; k < kStepShares; ++k) total[k].store_unaligned(sums[k] + at);
}

void share_steps(const StepRun& run, float* const* sums) {
  int at = 0;
  for (; at + kWidth <= run.floats; at += kWidth) share_register(run, sums, at);
  for (; at < run.floats; ++at) {
    for (int edge = 0; edge < run.edges; ++edge) {
      const float step = run.rows[edge + 1][run.first + at] - run.rows[edge][run.first + at];
      for (int k = 0; k < kStepShares; ++k) sums[k][at] += step * run.shares[edge * kStepShares + k];
    }
  }
}

// Plain loops, which the compiler vectorizes: the order of operations is that of the source.
void halve_columns(const float* in, int count, float* out) {
  // The filter at every column, of which every other one is kept: twice the sums, in a loop whose loads follow each
  // other. 3 floats are one texel: taps 0 and 5, 1 and 4, 2 and 3 share their factor.
  constexpr int block = 32;  // texels of the result
  float sums[6 * block];
  for (int first = 0; first < count; first += block) {
    const int texels = count - first < block ? count - first : block;
    const float* const from = in + 6 * static_cast<std::ptrdiff_t>(first);
    for (int k = 0; k < 6 * texels; ++k) {
      sums[k] = (from[k] + from[k + 15]) * 0.0625F + (from[k + 3] + from[k + 12]) * 0.3125F +
                (from[k + 6] + from[k + 9]) * 0.625F;
    }
    float* const to = out + 3 * static_cast<std::ptrdiff_t>(first);
    for (int i = 0; i < texels; ++i) {
      for (int c = 0; c < 3; ++c) to[3 * i + c] = sums[6 * i + c];
    }
  }
}

}  // namespace

const FourierKernels fourier_kernels_table = {
    .load_row_quads = load_row_quads,
    .run_fourier_pass = run_fourier_pass,
    .multiply_complex = multiply_complex,
    .part_orders = part_orders,
    .join_orders = join_orders,
    .store_rings = store_rings,
    .share_steps = share_steps,
    .halve_columns = halve_columns,
};

}  // namespace welkin::transforms::WELKIN_ISA
