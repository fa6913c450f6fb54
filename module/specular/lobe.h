// The GGX lobe of the split sum as a zonal kernel, and its spectrum.
#pragma once

#include <vector>

namespace welkin::specular {

/// k(c) = c D(sqrt((1 + c) / 2)), 0 for c <= 0; `alpha` = perceptual roughness squared, in (0, 1]. DESIGN: specular.h.
[[nodiscard]] double lobe(double cosine, double alpha) noexcept;

/// Int k over the sphere, in closed form.
[[nodiscard]] double lobe_integral(double alpha) noexcept;

/// k_l / k_0 for l < bands, k_l = 2 pi Int k(c) P_l(c) dc: what the prefilter does to band l. In double to 1e-10.
[[nodiscard]] std::vector<double> lobe_spectrum(double alpha, int bands);

}  // namespace welkin::specular
