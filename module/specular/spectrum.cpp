#include "specular/spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "image/check_views.h"
#include "sh/frame_transform.h"
#include "simd/transform_kernels.h"

namespace welkin::specular {

Spectrum::Spectrum(int bands) : bands_(bands) {
  image::require_range("bands", bands, 1, kMaximumSpectrumBands);
  values_ = tables::AlignedBuffer<float>(start(bands));
  std::fill_n(values_.data(), values_.size(), 0.0F);
}

std::size_t Spectrum::start(int m) const noexcept {
  const auto order = static_cast<std::size_t>(m);
  const std::size_t before = order * static_cast<std::size_t>(bands_) - order * (order > 0 ? order - 1 : 0) / 2;
  return before * simd::kHarmonicFloats;
}

std::complex<double> Spectrum::value(int l, int m, int channel) const noexcept {
  const float* const values = order(m) + std::ptrdiff_t{simd::kHarmonicFloats} * (l - m) + std::ptrdiff_t{2} * channel;
  return {values[0], values[1]};
}

// Y(l, m) = sqrt(2) P cos(m phi), Y(l, -m) = sqrt(2) P sin(m phi) for m > 0, and c = Int f P e^(-i m phi): in the frame
// whose third axis is y. The canonical frame's is z.
SphericalHarmonics Spectrum::harmonics(int bands) const {
  image::require_range("bands", bands, 1, std::min(bands_, kMaximumBands));
  const auto functions = static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
  std::vector<double> local(3 * functions);
  std::vector<double> canonical(3 * functions);
  std::vector<int> place(functions);
  for (std::size_t k = 0; k < functions; ++k) place[k] = static_cast<int>(k);
  for (int channel = 0; channel < 3; ++channel) {
    double* const here = local.data() + static_cast<std::size_t>(channel) * functions;
    for (int l = 0; l < bands; ++l) {
      for (int m = 0; m <= l; ++m) {
        const std::complex<double> c = value(l, m, channel) * (m > 0 ? std::numbers::sqrt2 : 1.0);
        here[SphericalHarmonics::index(l, m)] = c.real();
        if (m > 0) here[SphericalHarmonics::index(l, -m)] = -c.imag();
      }
    }
  }
  sh::lat_long_transform(bands).add(local.data(), place.data(), canonical.data());
  SphericalHarmonics result(bands);
  for (std::size_t k = 0; k < functions; ++k) {
    result.coefficients()[k] = {canonical[k], canonical[functions + k], canonical[2 * functions + k]};
  }
  return result;
}

}  // namespace welkin::specular
