// The source that an order leaves for the next (scattering_solver.h): the light about a point, what the ground sends
// included, to harmonics; folded with the phase functions; and back to directions.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "jobs/tiles.h"
#include "math/elementary.h"
#include "sky/air.h"
#include "sky/scattering_solver.h"
#include "sky/sky_geometry.h"
#include "sky/solver_worker.h"
#include "sky/vertical_harmonics.h"

namespace welkin::sky {
namespace {

using solver::index, solver::kSunBlock, solver::kZeniths;
using std::numbers::pi;

constexpr float kMaxExtrapolation = 4.0F;  ///< of a node that no direction makes, times the light at the nearest

}  // namespace

void SourceSolver::set_source_nodes() {
  source_legendre_.resize(index(shape_.zeniths) * pair_count(bands_));
  for (int z = 0; z < shape_.zeniths; ++z) {
    const double zenith = std::clamp(0.5 * z / (shape_.zeniths - 1), solver::kOffAxis, 0.5 - solver::kOffAxis);
    even_legendre(bands_, math::sine_cosine_of_turns(zenith).cosine,
                  source_legendre_.data() + index(z) * pair_count(bands_));
    for (int a = 0; a < shape_.angles; ++a) {
      for (std::size_t s = 0; s < index(shape_.suns); ++s) add_source_node(zenith, s, 0.5 * a / (shape_.angles - 1));
    }
  }
}

// Angles in turns.
// View and sun stand at the angles z and s from the vertical. By the triangle's inequality on the sphere the angle
// between them lies from |z - s| (azimuth 0) to min(z + s, 1 - z - s) (azimuth 180 degrees: over the zenith, or by the
// nadir where that way is shorter). In between, cos angle = cos z cos s + sin z sin s cos phi gives cos phi. z and s
// keep `kOffAxis` from the vertical, so that the sines are not 0 and the interval has a width. A node outside of the
// interval is reached by the straight line through the light at the end of the interval and at the point that lies as
// far inside as the node lies outside (or at the other end, if that is nearer):
//   value = nearest + slope (nearest - inside),   slope = (angle - nearest) / (nearest - inside) of the angles,
// which is 1 but where `inside` was clamped.
void SourceSolver::add_source_node(double zenith, std::size_t s, double angle) {
  const math::SineCosine view = math::sine_cosine_of_turns(zenith);
  const double sun = math::turns_of(sun_sines_[s], sun_cosines_[s]);
  const double minimum = std::abs(zenith - sun);
  const double maximum = std::min(zenith + sun, 1.0 - zenith - sun);
  const double nearest = std::clamp(angle, minimum, maximum);
  const double inside = std::clamp(2.0 * nearest - angle, minimum, maximum);
  const auto add = [&](double at, std::vector<float>& azimuths) {
    const double nu = math::sine_cosine_of_turns(at).cosine;
    const double azimuth = (nu - view.cosine * sun_cosines_[s]) / (view.sine * sun_sines_[s]);
    azimuths.push_back(static_cast<float>(std::clamp(azimuth, -1.0, 1.0)));
    for (std::size_t c = 0; c < 3 && source_.glow.any(); ++c) {
      source_nodes_.inverse_glow.push_back(static_cast<float>(1.0 / source_.glow.at(c, nu)));
    }
  };
  add(nearest, source_nodes_.azimuths);
  add(inside, source_nodes_.inside);
  // Relative to a glow light changes by other laws: it is held.
  const double beyond = angle == nearest || source_.glow.any() ? 0.0 : (angle - nearest) / (nearest - inside);
  source_nodes_.slopes.push_back(static_cast<float>(beyond));
}

// From the radiance of the last order, the ground's light and the phase functions to the next source.
void SourceSolver::gather(const Control& control) {
  const std::size_t workers = jobs::worker_count(jobs::Placement::arena);
  const std::size_t blocks = index(shape_.suns) / kSunBlock;
  std::vector<Worker> scratch;
  for (std::size_t i = 0; i < workers; ++i) scratch.emplace_back(air_, shape_, azimuths_, bands_);
  jobs::run_tiles(followed_.size() * blocks, jobs::Placement::arena, workers, control,
                  [&](std::size_t tile, std::size_t worker) {
                    project(followed_[tile / blocks], tile % blocks * kSunBlock, scratch[worker]);
                    fold(followed_[tile / blocks], tile % blocks * kSunBlock, scratch[worker]);
                  });
  solver::each(skipped_, [&](std::size_t height) {
    solver::fill(height, heights_.size(), source_.brightness);
    solver::fill(height, heights_.size(), source_.rayleigh, true);
    solver::fill(height, heights_.size(), source_.aerosol);
  });
  source_.set_steps();
}

// c(l, m) = Int L(w) Y(l, m)(w) dw = Sum_i w_i (2 pi / n) Sum_j L cos(m phi_j) Y(l, m)(mu_i), phi_j = pi (j + 1/2) / n:
// the n midpoints of half the circle stand for their mirror images too, as light is even in the azimuth about a sun at
// azimuth 0. On n midpoints cos((2 n - k) phi) = -cos(k phi), and cos(n phi) = 0: orders of m >= n cannot be told from
// lower ones. Two sums can be made of such light, for the addition theorem gives Sum_lm chi_l c(l, m) Y(l, m)(v) =
// Sum_ij w_ij L_ij p(v.w_ij) over the directions w_ij, p of so many bands, if all m <= l are projected, and the
// integral of p times the trigonometric polynomial through L if only m < n are. Neither contains what L has at m >= n.
// Where an order of scattering is followed along fewer azimuths than `shape_.azimuths`, only m < n are projected: by
// all m, tables would differ by 1.5 to 40 times as much from tables of 40 azimuths. Along all of them, of which n is 10
// (compact tables) or 16, neither sum is better throughout. Root mean square difference of scattered light to tables of
// 40 azimuths, four orders, by all m (and by m < n): compact tables of Bruneton's Earth 6.9e-5 (5.0e-5), `earth()`
// 2.1e-5 (4.2e-5), in haze 4.8e-5 (5.4e-5), Mars 2.5e-3 (2.9e-3; but of irradiance 7.7e-3 and 4.8e-3); full tables of
// Bruneton's Earth 6.9e-6 (5.7e-6), others within 3 % of each other.
void SourceSolver::project(std::size_t height, std::size_t first_sun, Worker& worker) {
  const SolverKernels& kernels = solver_kernels();
  const std::size_t suns = index(shape_.suns);
  const bool reflects = *std::max_element(group_.albedo.begin(), group_.albedo.end()) > 0.0;
  std::fill(worker.harmonics.begin(), worker.harmonics.end(), 0.0F);
  for (std::size_t i = 0; i < kZeniths; ++i) {
    const double weight = rules_[height].weights[i] * 2.0 * pi / static_cast<double>(azimuths_);
    const double* const values = legendre_.data() + (height * kZeniths + i) * worker.values.size();
    for (std::size_t k = 0; k < worker.values.size(); ++k) {
      worker.values[k] = static_cast<float>(values[k] * weight);
    }
    SkyRing ring{
        .radiance = radiance_.data() + radiance_index(height, i, 0) + first_sun,
        .channel_stride = static_cast<std::ptrdiff_t>(azimuths_ * suns),
        .azimuth_stride = static_cast<std::ptrdiff_t>(suns),
        .azimuths = static_cast<int>(azimuths_),
        .azimuth_cosines = azimuth_cosines_.data(),
        .values = worker.values.data(),
        .bands = bands_,
        .orders = azimuths_ == index(shape_.azimuths) ? bands_ : std::min(bands_, static_cast<int>(azimuths_))};
    if (reflects && i < index(DirectionRule::kGroundNodes)) {
      add_ground(height, i, first_sun, worker);
      ring.radiance = worker.rays.data();
      ring.channel_stride = static_cast<std::ptrdiff_t>(azimuths_ * kSunBlock);
      ring.azimuth_stride = static_cast<std::ptrdiff_t>(kSunBlock);
    }
    kernels.project_ring(ring, worker.harmonics.data());
  }
}

// The irradiance of the ground that is reflected, at a point with that sun.
// For the sun, E = T(ground, sun) visible share solar mu_s. Later orders have theirs in steps between nodes, read
// linearly.
std::array<double, 3> SourceSolver::ground_light(double sun_zenith_cosine) const noexcept {
  if (direct_ground_) {
    std::array<double, 3> light = light_.at(0.0, sun_zenith_cosine);
    for (std::size_t c = 0; c < 3; ++c) light[c] *= group_.solar[c] * std::max(0.0, sun_zenith_cosine);
    return light;
  }
  const double position = mapping_.smooth_sun_coordinate(sun_zenith_cosine) * ((shape_.suns - 1) * kSunSteps);
  const int step = std::min(static_cast<int>(position), (shape_.suns - 1) * kSunSteps - 1);
  std::array<double, 3> light{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto low = static_cast<double>(ground_before_[c][index(step)]);
    const auto high = static_cast<double>(ground_before_[c][index(step + 1)]);
    light[c] = low + (position - step) * (high - low);
  }
  return light;
}

// Light of the ground at the end of a ray of length d: its zenith there, the sun's cosine is (r mu_s + d nu) / R, since
// the end is x + d v and the sun's direction has the product r mu_s with x and nu with v. A Lambertian ground of
// irradiance E sends albedo E / pi in all directions, of which the ray's transmittance arrives.
void SourceSolver::add_ground(std::size_t height, std::size_t zenith, std::size_t first_sun, Worker& worker) const {
  const std::size_t node = height * index(DirectionRule::kGroundNodes) + zenith;
  const std::size_t suns = index(shape_.suns);
  const double altitude = source_altitude(mapping_, shape_, height);
  const double start = (air_.bottom_radius() + altitude) / air_.bottom_radius();
  const double distance = ground_distance_[node] / air_.bottom_radius();
  const double cosine = rules_[height].cosines[zenith];
  const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
  for (std::size_t j = 0; j < azimuths_; ++j) {
    const double azimuth = ray_azimuths_[j];
    for (std::size_t s = 0; s < kSunBlock; ++s) {
      const double sun = sun_cosines_[first_sun + s];
      const double nu = cosine * sun + sine * sun_sines_[first_sun + s] * azimuth;
      const std::array<double, 3> light = ground_light(std::clamp(start * sun + distance * nu, -1.0, 1.0));
      for (std::size_t c = 0; c < 3; ++c) {
        const auto arrived =
            static_cast<double>(radiance_[radiance_index(height, zenith, c) + j * suns + first_sun + s]);
        worker.rays[(c * azimuths_ + j) * kSunBlock + s] =
            static_cast<float>(arrived + ground_transmittance_[node][c] * group_.albedo[c] / pi * light[c]);
      }
    }
  }
}

// chi_l c(l, m), where the wavelengths' chi_l differ.
void SourceSolver::multiply_lobes(Worker& worker) const {
  std::copy(worker.harmonics.begin(), worker.harmonics.end(), worker.lobed.begin());
  for (int m = 0; m < bands_; ++m) {
    for (int l = m; l < bands_; ++l) {
      for (std::size_t c = 0; c < 3; ++c) {
        float* const harmonic = worker.lobed.data() + (pair_index(bands_, l, m) * 3 + c) * kSunBlock;
        const auto moment = static_cast<float>(spectra_[c].aerosol[index(l)]);
        for (std::size_t s = 0; s < kSunBlock; ++s) harmonic[s] *= moment;
      }
    }
  }
}

// Y(0, 0) to Y(2, 2) without what depends on the direction, as `even_legendre` has them; terms as in sky_kernels.h.
// With P_2(mu) = (3 mu^2 - 1) / 2 and the sines s, s_s of both zenith angles, q = s s_s cos phi:
//   Y(2, 0)            = N P_2(mu),   N = sqrt(5 / (4 pi))
//   Y(2, 1) cos phi    = N sqrt(3) mu s cos phi            = N sqrt(3) mu q / s_s
//   Y(2, 2) cos(2 phi) = N sqrt(3/4) s^2 (2 cos^2 phi - 1) = N (sqrt(3) q^2 / s_s^2 - sqrt(3/4) s^2),
// which gives the terms t0 to t4: c(2, 2) is in t2 (times -(1 - mu^2)) and in t4. Their moments are 1 and 1/10, since
// 3 / (16 pi) (1 + x^2) = 1 / (4 pi) (1 + P_2(x) / 2) and 5 chi_2 = 1/2. Suns keep off the vertical: s_s is not 0.
void SourceSolver::fold_molecules(std::size_t height, std::size_t first_sun, const Worker& worker) {
  const std::size_t suns = index(shape_.suns);
  const double band_0 = std::sqrt(0.25 / pi);
  const double band_2 = 0.1 * std::sqrt(5.0 / (4.0 * pi));
  float* const row = source_.rayleigh.data() + height * shape_.molecule_row() + 4 * first_sun;
  for (std::size_t s = 0; s < kSunBlock; ++s) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto harmonic = [&](int l, int m, std::size_t sun) {
        return static_cast<double>(worker.harmonics[(pair_index(bands_, l, m) * 3 + c) * kSunBlock + sun]);
      };
      const double sine = sun_sines_[first_sun + s];
      const double terms[kMoleculeTerms] = {band_0 * harmonic(0, 0, s), band_2 * harmonic(2, 0, s),
                                            band_2 * std::sqrt(0.75) * harmonic(2, 2, s),
                                            band_2 * std::sqrt(3.0) * harmonic(2, 1, s) / sine,
                                            band_2 * std::sqrt(3.0) * harmonic(2, 2, s) / (sine * sine)};
      for (std::size_t k = 0; k < index(kMoleculeTerms); ++k) {
        row[k * 4 * suns + 4 * s + c] = static_cast<float>(terms[k]);
      }
    }
  }
}

// J(direction) = sum over l and m of chi_l c(l, m) Y(l, m)(direction), for both phase functions.
// By the addition theorem p(v.w) = Sum_l (2 l + 1) / (4 pi) chi_l P_l(v.w) = Sum_l chi_l Sum_m Y(l, m)(v) Y(l, m)(w),
// and so Int p(v.w) L(w) dw = Sum chi_l c(l, m) Y(l, m)(v): folding with a phase function multiplies bands (Funk and
// Hecke).
void SourceSolver::fold(std::size_t height, std::size_t first_sun, Worker& worker) {
  // The mean of all directions is that of the harmonic that is the same everywhere, Y(0, 0) = 1 / sqrt(4 pi).
  // c(0, 0) = Int L Y(0, 0) dw, so that the mean Int L dw / (4 pi) is c(0, 0) / sqrt(4 pi); that over three channels is
  // their sum over 3 sqrt(4 pi) = sqrt(36 pi).
  for (std::size_t s = 0; s < kSunBlock; ++s) {
    double mean = 0.0;
    for (std::size_t c = 0; c < 3; ++c) mean += static_cast<double>(worker.harmonics[c * kSunBlock + s]);
    source_.brightness[height * index(shape_.suns) + first_sun + s] = std::max(0.0, mean / std::sqrt(36.0 * pi));
  }
  fold_molecules(height, first_sun, worker);
  if (!with_aerosol_) return;
  const SolverKernels& kernels = solver_kernels();
  const int bands = bands_;
  const bool lobed = spectra_.size() > 1;
  if (lobed) multiply_lobes(worker);
  const std::vector<float>& harmonics = lobed ? worker.lobed : worker.harmonics;
  const std::vector<double>& moments = lobed ? ones_ : spectra_.front().aerosol;
  for (int z = 0; z < shape_.zeniths; ++z) {
    const double* const values = source_legendre_.data() + index(z) * pair_count(bands);
    for (int m = 0; m < bands; ++m) {
      for (int l = m; l < bands; ++l) {
        const std::size_t pair = pair_index(bands, l, m);
        worker.values[pair] = static_cast<float>(values[pair] * moments[index(l)]);
      }
    }
    kernels.fold_orders(harmonics.data(), worker.values.data(), bands, worker.aerosol.data());
    const std::size_t slot = (height * index(shape_.zeniths) + index(z)) * 4 * shape_.image() + 4 * first_sun;
    for (int a = 0; a < shape_.angles; ++a) {
      const std::size_t first = (index(z) * index(shape_.angles) + index(a)) * index(shape_.suns) + first_sun;
      float* const texels = source_.aerosol.data() + slot + 4 * index(a) * index(shape_.suns);
      kernels.sum_orders(worker.aerosol.data(), bands, source_nodes_.azimuths.data() + first, texels);
      const float* const slopes = source_nodes_.slopes.data() + first;
      float inside[4 * kSunBlock];
      const bool outside = std::any_of(slopes, slopes + kSunBlock, [](float slope) { return slope != 0.0F; });
      if (outside) kernels.sum_orders(worker.aerosol.data(), bands, source_nodes_.inside.data() + first, inside);
      if (outside || source_.glow.any()) go_on_outside(outside ? inside : texels, first, texels);
    }
  }
}

// Relative to the glow, if there is one; of the nodes `first` and on (SourceNodes).
void SourceSolver::go_on_outside(const float* inside, std::size_t first, float* texels) const {
  const bool glows = source_.glow.any();
  for (std::size_t s = 0; s < kSunBlock; ++s) {
    const float* const inverse = glows ? source_nodes_.inverse_glow.data() + 6 * (first + s) : nullptr;
    for (std::size_t c = 0; c < 3; ++c) {
      const float nearest = texels[4 * s + c] * (glows ? inverse[c] : 1.0F);
      const float change = nearest - inside[4 * s + c] * (glows ? inverse[3 + c] : 1.0F);
      texels[4 * s + c] =
          std::clamp(nearest + source_nodes_.slopes[first + s] * change, 0.0F, kMaxExtrapolation * nearest);
    }
  }
}

}  // namespace welkin::sky
