// Light carried along rays through the air (sky_kernels.h).
#include "simd/vec.h"
#include "sky/sky_kernels.h"

namespace welkin::sky::WELKIN_ISA {
namespace {

using simd::kLanes, simd::kNarrowWidth, simd::kWidth, simd::Lanes, simd::NarrowLanes, simd::Quad;

using Indices = xsimd::batch<std::int32_t, Lanes::arch_type>;

constexpr int kPair = 8;  ///< floats of two nodes of suns that follow each other, or of molecules and aerosol

WELKIN_INLINE Lanes load(const float* p) { return Lanes::load_unaligned(p); }
WELKIN_INLINE NarrowLanes load_narrow(const float* p) { return NarrowLanes::load_unaligned(p); }

/// A position among nodes: the node below, and the fraction towards the next.
struct NodeFraction {
  Indices node;
  Lanes fraction;
};

WELKIN_INLINE NodeFraction place_among(Lanes position, int nodes) {
  const Lanes inside = xsimd::min(xsimd::max(position, Lanes(0.0F)), Lanes(static_cast<float>(nodes - 1)));
  const Indices node = xsimd::min(xsimd::to_int(inside), Indices(nodes - 2));
  return {node, inside - xsimd::to_float(node)};
}

/// Four channels' weights, again and again.
WELKIN_INLINE Lanes repeated(const float* four) {
  alignas(64) float weights[kWidth];
  for (int i = 0; i < kWidth; ++i) weights[i] = four[i % 4];
  return Lanes::load_aligned(weights);
}

WELKIN_INLINE Lanes sun_zenith(float start_ratio, float distance_ratio, const SkySuns& suns, int i) {
  return Lanes(start_ratio) * load(suns.zenith_cosine + i) + Lanes(distance_ratio) * load(suns.angle_cosine + i);
}

/// Transmittance from the sample to the sun, over the nodes of a row: each twice, for molecules and aerosol.
/// Each node's four floats are stored twice: molecules and aerosol see the same sunlight, and their two colours make
/// one row of eight floats, which one register multiplies where it is wide enough.
WELKIN_INLINE void make_slice(const SunlitSample& sample, int nodes, float* slice) {
  Lanes weights[4];
  for (int k = 0; k < 4; ++k) weights[k] = Lanes(sample.row_weights[k]);
  for (int i = 0; i < 4 * nodes; i += kWidth) {
    Lanes sum(0.0F);
    for (int k = 0; k < 4; ++k) sum = sum + weights[k] * load(sample.rows[k] + i);
    alignas(64) float light[kWidth];
    xsimd::max(sum, Lanes(0.0F)).store_aligned(light);
    for (int q = 0; q < kWidth; q += 4) {
      const Quad node = Quad::load_aligned(light + q);
      node.store_unaligned(slice + 2 * (i + q));
      node.store_unaligned(slice + 2 * (i + q) + 4);
    }
  }
}

/// The integral of t^2 (3 - 2 t) from 0, that function being 0 before 0 and 1 after 1.
WELKIN_INLINE Lanes risen(Lanes t) {
  const Lanes inside = xsimd::min(xsimd::max(t, Lanes(0.0F)), Lanes(1.0F));
  return inside * inside * inside * (Lanes(1.0F) - Lanes(0.5F) * inside) + xsimd::max(t - Lanes(1.0F), Lanes(0.0F));
}

/// The disc's visible share, averaged: half widths of at least 1/32 of its diameter keep the quotient's digits.
/// With F = risen(), F' = t^2 (3 - 2 t) is the visible share, and its mean from t - w to t + w is
/// (F(t + w) - F(t - w)) / (2 w). The difference cancels as w falls: at w = 1/32 a float's rounding leaves an error of
/// 2e-6. Where the stretch of the ray spans less, averaging over 1/32 changes the share by at most w^2 = 1e-3, next to
/// the two ends of the rise: by w^2 / 6 times the share's second derivative 6 - 12 t.
WELKIN_INLINE Lanes disc_share(const SunlitSample& sample, Lanes mu, Lanes nu, Lanes above_horizon) {
  const Lanes moved = Lanes(sample.turning) * (nu - Lanes(sample.view_cosine) * mu) - Lanes(sample.sinking);
  const Lanes width = xsimd::max(xsimd::max(moved, Lanes(0.0F) - moved), Lanes(0.03125F));
  const Lanes risen_by = Lanes(sample.disc_slope) * above_horizon + Lanes(sample.disc_offset);
  const auto lit = risen_by >= Lanes(1.0F) + width;
  if (xsimd::all(lit)) return Lanes(1.0F);
  const Lanes t = xsimd::min(xsimd::max(risen_by, Lanes(0.0F) - width), Lanes(1.0F) + width);
  const Lanes share =
      xsimd::min(xsimd::max((risen(t + width) - risen(t - width)) / (width + width), Lanes(0.0F)), Lanes(1.0F));
  return xsimd::select(lit, Lanes(1.0F), share);
}

/// `TableMapping::smooth_sun_coordinate` in float. The ray from the ground to the sphere of tangent distance H has
/// d^2 + 2 R mu d = H^2, so that in units of R d = sqrt(mu^2 + (H / R)^2) - mu: `reach` is (H / R)^2.
WELKIN_INLINE NodeFraction sun_lookup(const SunAxis& axis, Lanes zenith_cosine) {
  const Lanes mu = xsimd::min(xsimd::max(zenith_cosine, Lanes(-1.0F)), Lanes(1.0F));
  // Cancels by day, but by no more than a float's last bit of 1: `reach` is 0.016 at least, the shortest distance
  // 0.008.
  const Lanes distance = xsimd::sqrt(mu * mu + Lanes(axis.reach)) - mu;
  const Lanes a = xsimd::max(distance - Lanes(axis.shortest), Lanes(0.0F)) * Lanes(axis.scale);
  const Lanes path =
      xsimd::max(Lanes(1.0F) - a * Lanes(axis.inverse_lowest), Lanes(0.0F)) / (Lanes(1.0F) + Lanes(axis.bend) * a);
  const Lanes x = Lanes(axis.path) * path + Lanes(axis.level) * xsimd::max(mu - Lanes(axis.lowest), Lanes(0.0F));
  constexpr auto high = static_cast<float>(kHighSuns);
  const Lanes u = xsimd::min(xsimd::max(Lanes(1.0F) - x, Lanes(0.0F)) * Lanes(1.0F / high), Lanes(1.0F));
  const Lanes rest = Lanes(1.0F) - u;
  const Lanes bent = xsimd::sqrt(u * (u + Lanes(axis.zenith) * (rest * rest * rest))) - u;
  return place_among((x - Lanes(high) * bent) * Lanes(static_cast<float>(axis.nodes - 1)), axis.nodes);
}

// Positions are computed across texels. Then each texel loads its four channels with one load per node, which beats
// gathering them channel by channel on every instruction set.
void add_sunlight(const SunlitSample& sample, int nodes, const SkySuns& suns, float* slice, float* sums) {
  make_slice(sample, nodes, slice);
  alignas(64) std::int32_t node[kWidth];
  alignas(64) float fraction[kWidth];
  alignas(64) float shares[kWidth];
  alignas(64) float matter[kPair]{};  // molecules and aerosol side by side, in one register where it holds both
  for (int c = 0; c < 4; ++c) {
    matter[c] = sample.rayleigh[c];
    matter[4 + c] = sample.with_aerosol ? sample.aerosol[c] : 0.0F;
  }
  for (int i = 0; i < suns.count; i += kWidth) {
    const Lanes mu = sun_zenith(sample.start_ratio, sample.distance_ratio, suns, i);
    const Lanes above = mu - Lanes(sample.horizon);
    const Lanes share = disc_share(sample, mu, load(suns.angle_cosine + i), above);
    if (!xsimd::any(share > Lanes(0.0F))) continue;  // all in the planet's shadow
    share.store_aligned(shares);
    const Lanes y = xsimd::max(above, Lanes(0.0F));
    const NodeFraction lookup =
        place_among(Lanes(sample.rational) * (y / (y + Lanes(sample.bend))) + Lanes(sample.linear) * y, nodes);
    lookup.node.store_aligned(node);
    lookup.fraction.store_aligned(fraction);
    for (int k = 0; k < kWidth; ++k) {
      if (shares[k] == 0.0F) continue;
      const float* const low = slice + kPair * node[k];
      float* const sum = sums + kPair * (i + k);
      for (int h = 0; h < kPair; h += kNarrowWidth) {
        const NarrowLanes first = load_narrow(low + h);
        const NarrowLanes light =
            NarrowLanes(shares[k]) * (first + NarrowLanes(fraction[k]) * (load_narrow(low + kPair + h) - first));
        (load_narrow(sum + h) + load_narrow(matter + h) * light).store_unaligned(sum + h);
      }
    }
  }
}

/// The brightness at the sample's height in steps, and at the nodes the inverse of it, four times each.
/// Between nodes k and k + 1 of suns, a fraction f apart, the source is B ((1 - f) S_k / B_k + f S_(k+1) / B_(k+1)),
/// with the brightness B read in steps. This is exact where all directions fall alike, S proportional to B. Straight
/// lines in S itself would be too bright between nodes: by cosh(1/2) - 1 = 13 % in the middle of a step over which
/// light falls by a factor e.
WELKIN_INLINE void mix_steps(const SourceSample& sample, int nodes, float* inverse, float* steps) {
  const Lanes low(sample.step_weights[0]);
  const Lanes high(sample.step_weights[1]);
  const int count = (nodes - 1) * kSunSteps + 1;
  for (int i = 0; i < count; i += kWidth) {
    (low * load(sample.steps[0] + i) + high * load(sample.steps[1] + i)).store_unaligned(steps + i);
  }
  for (int k = 0; k < nodes; ++k) {
    const float brightness = steps[k * kSunSteps];
    Quad(brightness > 0.0F ? 1.0F / brightness : 0.0F).store_unaligned(inverse + 4 * k);
  }
}

/// Mixes the light that molecules scatter at the sample's height and zenith angle, relative to the brightness:
/// coefficients of 1, q and q^2, `rows`[3][nodes][4].
/// The direction enters by mu alone here and by q per sun later: the five terms of sky_kernels.h are folded to
///   (t0 + P_2(mu) t1 - (1 - mu^2) t2) + q (mu t3) + q^2 t4
/// once per sample, and a sun costs two multiplications and additions per channel.
WELKIN_INLINE void mix_molecules(const SourceSample& sample, int nodes, const float* inverse, float* rows) {
  const Lanes low = repeated(sample.molecule_weights[0]);
  const Lanes high = repeated(sample.molecule_weights[1]);
  const Lanes cosine(sample.view_cosine);
  const Lanes square = cosine * cosine;
  const Lanes second = Lanes(1.5F) * square - Lanes(0.5F);
  const Lanes sine_square = Lanes(1.0F) - square;
  const int row = 4 * nodes;
  for (int i = 0; i < row; i += kWidth) {
    Lanes terms[kMoleculeTerms];
    for (int k = 0; k < kMoleculeTerms; ++k) {
      terms[k] = low * load(sample.molecules[0] + k * row + i) + high * load(sample.molecules[1] + k * row + i);
    }
    const Lanes scale = load(inverse + i);
    (scale * (terms[0] + second * terms[1] - sine_square * terms[2])).store_unaligned(rows + i);
    (scale * (cosine * terms[3])).store_unaligned(rows + row + i);
    (scale * terms[4]).store_unaligned(rows + 2 * row + i);
  }
}

/// The sum of the images, relative to the brightness.
WELKIN_INLINE void mix_images(const SourceSample& sample, int nodes, int size, const float* inverse, float* image) {
  Lanes weights[4];
  for (int k = 0; k < sample.count; ++k) weights[k] = repeated(sample.weights[k]);
  for (int row = 0; row < 4 * size; row += 4 * nodes) {
    for (int i = 0; i < 4 * nodes; i += kWidth) {
      Lanes sum(0.0F);
      for (int k = 0; k < sample.count; ++k) sum = sum + weights[k] * load(sample.images[k] + row + i);
      (sum * load(inverse + i)).store_unaligned(image + row + i);
    }
  }
}

/// The weights of both are w0 = b (1 - f) and w1 = b f: b times the first of these plus b f times the second.
alignas(64) constexpr float kFirstOfPair[kPair] = {1.0F, 1.0F, 1.0F, 1.0F, 0.0F, 0.0F, 0.0F, 0.0F};
alignas(64) constexpr float kSlopeOfPair[kPair] = {-1.0F, -1.0F, -1.0F, -1.0F, 1.0F, 1.0F, 1.0F, 1.0F};

// Both nodes about a sun lie side by side, so that one register holds them; they are added up apart.
template <bool molecules, bool images>
WELKIN_INLINE void add_light(const SourceSample& sample, const SunAxis& axis, const SkySuns& suns, const float* image,
                             const float* rows, const float* steps, float* sums) {
  alignas(64) std::int32_t node[kWidth];
  alignas(64) std::int32_t step[kWidth];
  alignas(64) float fraction[kWidth];
  alignas(64) float part[kWidth];
  alignas(64) float across[kWidth];
  const int row = 4 * axis.nodes;
  for (int i = 0; i < suns.count; i += kWidth) {
    const Lanes mu = sun_zenith(sample.start_ratio, sample.distance_ratio, suns, i);
    (load(suns.angle_cosine + i) - Lanes(sample.view_cosine) * mu).store_aligned(across);
    const NodeFraction lookup = sun_lookup(axis, mu);
    lookup.node.store_aligned(node);
    lookup.fraction.store_aligned(fraction);
    // A position among nodes is `node` + `fraction`, and among steps kSunSteps times that: the step is found from the
    // fraction by itself, which has more digits than the whole position. The last step is kept inside of the interval
    // where the fraction is 1.
    const Lanes fine = lookup.fraction * Lanes(static_cast<float>(kSunSteps));
    const Indices whole = xsimd::min(xsimd::to_int(fine), Indices(kSunSteps - 1));
    (lookup.node * Indices(kSunSteps) + whole).store_aligned(step);
    (fine - xsimd::to_float(whole)).store_aligned(part);
    for (int k = 0; k < kWidth; ++k) {
      const float brightness = steps[step[k]] + part[k] * (steps[step[k] + 1] - steps[step[k]]);
      const NarrowLanes first(brightness);
      const NarrowLanes slope(brightness * fraction[k]);
      const NarrowLanes q(across[k]);
      const int at = 4 * node[k];
      for (int h = 0; h < kPair; h += kNarrowWidth) {
        NarrowLanes light(0.0F);
        if constexpr (molecules) {
          light = load_narrow(rows + at + h) +
                  q * (load_narrow(rows + row + at + h) + q * load_narrow(rows + 2 * row + at + h));
          light = xsimd::max(light, NarrowLanes(0.0F));
        }
        if constexpr (images) {
          const float* const nearer = image + 4 * suns.row[i + k] + at + h;
          const NarrowLanes low = load_narrow(nearer);
          light = light + (low + NarrowLanes(suns.row_fraction[i + k]) * (load_narrow(nearer + row) - low));
        }
        // w0 = b (1 - f) for the nearer four floats and w1 = b f for the farther four, as b {1, 0} + b f {-1, 1}: no
        // lane is shuffled.
        const NarrowLanes weight = first * load_narrow(kFirstOfPair + h) + slope * load_narrow(kSlopeOfPair + h);
        float* const sum = sums + kPair * (i + k) + h;
        (load_narrow(sum) + weight * light).store_unaligned(sum);
      }
    }
  }
}

void add_source(const SourceSample& sample, const SunAxis& axis, int size, const SkySuns& suns, float* scratch,
                float* sums) {
  float* const image = scratch;
  float* const inverse = image + 4 * size;
  float* const rows = inverse + 4 * axis.nodes;
  float* const steps = rows + 3 * 4 * axis.nodes;
  mix_steps(sample, axis.nodes, inverse, steps);
  const bool molecules = sample.molecules[0] != nullptr;
  if (molecules) mix_molecules(sample, axis.nodes, inverse, rows);
  if (sample.count > 0) mix_images(sample, axis.nodes, size, inverse, image);
  if (molecules && sample.count > 0) {
    add_light<true, true>(sample, axis, suns, image, rows, steps, sums);
  } else if (molecules) {
    add_light<true, false>(sample, axis, suns, image, rows, steps, sums);
  } else if (sample.count > 0) {
    add_light<false, true>(sample, axis, suns, image, rows, steps, sums);
  }
}

/// Abramowitz and Stegun 4.4.46: arccos x = sqrt(1 - x) times this polynomial for x from 0 to 1, within 2e-8.
constexpr float kArcCosine[8] = {1.5707963050F, -0.2145988016F, 0.0889789874F, -0.0501743046F,
                                 0.0308918810F, -0.0170881256F, 0.0066700901F, -0.0012624911F};

void place_angles(const float* cosines, int count, int angles, int row, std::int32_t* rows, float* fractions) {
  constexpr float inverse_pi = 0.318309886F;
  for (int i = 0; i < count; i += kWidth) {
    const Lanes x = xsimd::min(xsimd::max(load(cosines + i), Lanes(-1.0F)), Lanes(1.0F));
    const Lanes size = xsimd::max(x, Lanes(0.0F) - x);
    Lanes polynomial(kArcCosine[7]);
    for (int k = 6; k >= 0; --k) polynomial = polynomial * size + Lanes(kArcCosine[k]);
    // arccos |x| / pi, then arccos(-x) = pi - arccos x. 1 - |x| is exact in float for |x| >= 1/2, so that near 0 and
    // 180 degrees the polynomial adds nothing to the error of the cosine itself: 2^-25 of 1 is an angle of
    // sqrt(2^-24) = 2.4e-4 radians.
    const Lanes turned = xsimd::sqrt(Lanes(1.0F) - size) * polynomial * Lanes(inverse_pi);
    const Lanes share = xsimd::select(x < Lanes(0.0F), Lanes(1.0F) - turned, turned);
    const NodeFraction lookup = place_among(share * Lanes(static_cast<float>(angles - 1)), angles);
    (lookup.node * Indices(row)).store_unaligned(rows + i);
    lookup.fraction.store_unaligned(fractions + i);
  }
}

// Radiance about a point to harmonics, folded with phase functions, and back (sky_kernels.h): sixteen suns at a time.

constexpr int kRegisters = kLanes / kWidth;
constexpr int kValues = 3 * kLanes;  ///< of a pair

// The ring's share of c(l, m) = Int L Y(l, m) dw. Its directions share Y's part in the zenith angle, so that azimuths
// are summed first,
//   s_m = Sum_j L(phi_j) cos(m phi_j),   c(l, m) += values(l, m) s_m,
// with the ring's weight in `values`: azimuths x m + pairs operations per ring in place of azimuths x pairs.
void project_sky_ring(const SkyRing& ring, float* harmonics) {
  int pair = 0;
  for (int m = 0; m < ring.orders; ++m) {
    const float* const cosines = ring.azimuth_cosines + m * ring.azimuths;
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < kRegisters; ++k) {
        const float* const radiance = ring.radiance + c * ring.channel_stride + k * kWidth;
        Lanes sum(0.0F);
        for (int j = 0; j < ring.azimuths; ++j) {
          sum = sum + Lanes(cosines[j]) * Lanes::load_unaligned(radiance + j * ring.azimuth_stride);
        }
        for (int l = m; l < ring.bands; ++l) {
          float* const to = harmonics + (pair + l - m) * kValues + c * kLanes + k * kWidth;
          (Lanes::load_unaligned(to) + Lanes(ring.values[pair + l - m]) * sum).store_unaligned(to);
        }
      }
    }
    pair += ring.bands - m;
  }
}

// The inverse in the same two steps: by_order(m) = Sum_l weights(l, m) c(l, m) for one zenith angle, with the lobe's
// moments in the weights, and then Sum_m by_order(m) cos(m phi) per azimuth (`sum_sky_orders`).
void fold_sky_orders(const float* harmonics, const float* weights, int bands, float* by_order) {
  int pair = 0;
  for (int m = 0; m < bands; ++m) {
    for (int i = 0; i < kValues; i += kWidth) {
      Lanes sum(0.0F);
      for (int l = m; l < bands; ++l) {
        sum = sum + Lanes(weights[pair + l - m]) * Lanes::load_unaligned(harmonics + (pair + l - m) * kValues + i);
      }
      sum.store_unaligned(by_order + m * kValues + i);
    }
    pair += bands - m;
  }
}

// cos(m phi) by Chebyshev's recurrence, cos((m + 1) phi) = 2 cos phi cos(m phi) - cos((m - 1) phi), from
// cos(-phi) = cos phi and cos 0 = 1: only cos phi is stored per node, and no angle is needed. A truncated series may
// swing below 0; light may not.
void sum_sky_orders(const float* by_order, int bands, const float* azimuth_cosines, float* out) {
  for (int k = 0; k < kRegisters; ++k) {
    const Lanes cosine = Lanes::load_unaligned(azimuth_cosines + k * kWidth);
    Lanes before = cosine;  // cos(-phi)
    Lanes here(1.0F);
    Lanes sums[3] = {Lanes(0.0F), Lanes(0.0F), Lanes(0.0F)};
    for (int m = 0; m < bands; ++m) {
      const float* const values = by_order + m * kValues + k * kWidth;
      for (int c = 0; c < 3; ++c) sums[c] = sums[c] + here * Lanes::load_unaligned(values + c * kLanes);
      const Lanes next = (cosine + cosine) * here - before;
      before = here;
      here = next;
    }
    alignas(64) float colours[3][kWidth];
    for (int c = 0; c < 3; ++c) xsimd::max(sums[c], Lanes(0.0F)).store_aligned(colours[c]);
    for (int i = 0; i < kWidth; ++i) {
      float* const texel = out + 4 * (k * kWidth + i);
      for (int c = 0; c < 3; ++c) texel[c] = colours[c][i];
      texel[3] = 0.0F;
    }
  }
}

}  // namespace

const SolverKernels solver_kernels_table = {
    .add_sunlight = add_sunlight,
    .add_source = add_source,
    .place_angles = place_angles,
    .project_ring = project_sky_ring,
    .fold_orders = fold_sky_orders,
    .sum_orders = sum_sky_orders,
};

}  // namespace welkin::sky::WELKIN_ISA
