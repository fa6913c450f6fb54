// The GGX lobe of the split sum as a zonal kernel, and its spectrum.
#pragma once

#include <vector>

namespace welkin::reflections {

/// k(c) = c D(sqrt((1 + c) / 2)), 0 for c <= 0; `alpha` = perceptual roughness squared, in (0, 1]. DESIGN:
/// reflections.h.
[[nodiscard]] double lobe(double cosine, double alpha) noexcept;

/// Int k over the sphere, in closed form.
[[nodiscard]] double lobe_integral(double alpha) noexcept;

/// k_l / k_0 for l < bands, k_l = 2 pi Int k(c) P_l(c) dc: what the prefilter does to band l. In double to 1e-10.
[[nodiscard]] std::vector<double> lobe_spectrum(double alpha, int bands);

/// The far part of a lobe's spectrum, over k_0 of the whole lobe: of k (1 - (1 + u) e^-u), u = split (q + s),
/// s = sin^2(theta / 2) = (1 - c) / 2, q = alpha^2 / (1 - alpha^2). It is a mixture of Gaussians exp(-t s) with
/// t < split, so that band l holds e^(-l^2 / split) or less. In double to 1e-10; not kept.
[[nodiscard]] std::vector<double> far_spectrum(double alpha, double split, int bands);

/// The lobe as a sum of Gaussians, Int t e^(-t (q + s)) dt by steps of ln t: each 0.8 further, h t^2 e^(-t (q + s)).
/// The sum's relative error is 2 |Gamma(2 + 2 pi i / h)| = 5e-4 at most, in turns above and below.
inline constexpr double kGaussianStep = 0.8;

/// As `far_spectrum`, of the Gaussians below t = `least` of that sum (which is the first that is not far). Band l holds
/// e^(-l^2 / t) of each.
[[nodiscard]] std::vector<double> gaussian_spectrum(double alpha, double least, int bands);

/// Sum_i weights[i] P_l(1 - distances[i]) for l < bands: what a quadrature of a zonal kernel gives.
[[nodiscard]] std::vector<double> zonal_moments(std::vector<double> distances, std::vector<double> weights, int bands);

/// Returns what decides at such bounds how finely lights are merged, and which lobes are too narrow for harmonics: 9.25
/// for rms 1e-3 and maximum 1e-2, more for smaller ones.
[[nodiscard]] double reach_for(double rms_error, double maximum_error) noexcept;

}  // namespace welkin::reflections
