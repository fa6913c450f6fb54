// Length of sums: faces up to 8192, against sums in double. An error must not grow with the number of texels.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <vector>

#include "image/texel_geometry.h"
#include "report/stability/cases.h"
#include "report/stability/maps.h"
#include "report/stability/measures.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/mip_chain.h"
#include "welkin/projection.h"
#include "welkin/specular.h"

namespace welkin::report::stability {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kProjectionError = 5e-7;  ///< projection.h

/// k / 1024 as a half, for k below 2048: exactly.
std::uint16_t half_of_1024ths(std::uint32_t k) {
  if (k == 0) return 0;
  const auto exponent = static_cast<std::uint32_t>(std::bit_width(k)) - 1U;
  return static_cast<std::uint16_t>(((exponent + 5U) << 10U) | ((k << (10U - exponent)) & 0x3FFU));
}

/// One face in memory that stands for all six: 8192 x 8192 take 0.4 GB that way.
struct SharedFace {
  int size;
  std::vector<std::uint16_t> pixels;

  [[nodiscard]] CubemapView view() const {
    CubemapView view{{}, size, 0, PixelFormat::rgb_f16};
    view.faces.fill(pixels.data());
    return view;
  }
};

std::uint32_t noise_1024ths(std::size_t value) { return hashed(3, static_cast<std::uint32_t>(value)) & 1023U; }

SharedFace noise_face(int size) {
  SharedFace face{size, std::vector<std::uint16_t>(std::size_t{3} * static_cast<std::size_t>(size * size))};
  for (std::size_t k = 0; k < face.pixels.size(); ++k) face.pixels[k] = half_of_1024ths(noise_1024ths(k));
  return face;
}

/// 1638 / 16384, the half next to 0.1: every sum rounds the same way.
constexpr std::uint16_t kTenth = 0x2E66;
constexpr double kTenthValue = 1638.0 / 16384.0;

SharedFace constant_face(int size) {
  return {size, std::vector<std::uint16_t>(std::size_t{3} * static_cast<std::size_t>(size * size), kTenth)};
}

/// Nine harmonics of one row of the noise face in the face's own frame, by the midpoint rule.
void add_noise_row(int size, int row, SphericalHarmonics& sum) {
  const double y0 = 0.5 / std::sqrt(kPi);
  const double y1 = std::sqrt(3.0 / (4.0 * kPi));
  const double y2 = std::sqrt(15.0 / (4.0 * kPi));
  std::vector<double> angles(static_cast<std::size_t>(size));
  image::cubemap_row_solid_angles(row, angles);
  const double v = (2.0 * row + 1.0) / size - 1.0;
  std::array<glm::dvec3, 9> part{};
  for (int column = 0; column < size; ++column) {
    const double u = (2.0 * column + 1.0) / size - 1.0;
    const double r = 1.0 / std::sqrt(1.0 + u * u + v * v);
    const glm::dvec3 d(u * r, v * r, r);
    const std::size_t texel =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(size) + static_cast<std::size_t>(column);
    const glm::dvec3 light =
        angles[static_cast<std::size_t>(column)] / 1024.0 *
        glm::dvec3(noise_1024ths(3 * texel), noise_1024ths(3 * texel + 1), noise_1024ths(3 * texel + 2));
    const std::array<double, 9> basis{y0,
                                      y1 * d.y,
                                      y1 * d.z,
                                      y1 * d.x,
                                      y2 * d.x * d.y,
                                      y2 * d.y * d.z,
                                      y2 * (3.0 * d.z * d.z - 1.0) / std::sqrt(12.0),
                                      y2 * d.x * d.z,
                                      y2 * 0.5 * (d.x * d.x - d.y * d.y)};
    for (std::size_t k = 0; k < 9; ++k) part[k] += basis[k] * light;
  }
  for (std::size_t k = 0; k < 9; ++k) sum.coefficients()[k] += part[k];
}

/// In double: one face's sums, turned into each of the six frames.
SphericalHarmonics noise_truth(int size) {
  SphericalHarmonics local(3);
  for (int row = 0; row < size; ++row) add_noise_row(size, row, local);
  SphericalHarmonics sum(3);
  for (int face = 0; face < 6; ++face) {
    const image::Frame& frame = image::face_frame(face);
    sum = add(sum, transform(local, glm::dmat3(frame.u, frame.v, frame.normal)));
  }
  return sum;
}

double noise_error(int size, const Control& control) {
  ProjectionOptions midpoint;
  midpoint.quadrature = Quadrature::midpoint;
  const SharedFace face = noise_face(size);
  return relative_error(project(face.view(), midpoint, control).radiance, noise_truth(size));
}

double constant_error(int size, const Control& control) {
  const SharedFace face = constant_face(size);
  return relative_error(project(face.view(), {}, control).radiance, constant_radiance(glm::dvec3(kTenthValue), 3));
}

double constant_lat_long_error(int height, const Control& control) {
  const std::vector<std::uint16_t> pixels(
      std::size_t{6} * static_cast<std::size_t>(height) * static_cast<std::size_t>(height), kTenth);
  const LatLongView view{pixels.data(), 2 * height, height, 0, PixelFormat::rgb_f16};
  return relative_error(project(view, {}, control).radiance, constant_radiance(glm::dvec3(kTenthValue), 3));
}

/// The worst error of larger sizes over that of smaller ones, errors below a rounding of float counting as that.
double growth(const std::function<double(int)>& error, const std::vector<int>& small, const std::vector<int>& large) {
  const auto worst = [&](const std::vector<int>& sizes) {
    double most = 0x1p-24;
    for (const int size : sizes) most = worse(most, error(size));
    return most;
  };
  return worst(large) / worst(small);
}

/// Mean of the sphere on each mip against that of the first.
double mips_drift(int size, const Control& control) {
  const CubemapChain chain = build_mips(noise_cube(size, 9).view(), MipFilter::solid_angle, 0, control);
  const glm::dvec3 first = project(chain.view(0)).diagnostics.flux;
  double worst = 0.0;
  for (int level = 1; level < chain.levels(); ++level) {
    worst = worse(worst, relative_error(project(chain.view(level)).diagnostics.flux, first));
  }
  return worst;
}

double prefilter_drift(int height, const Control& control) {
  PrefilterOptions options{.size = 64};
  const PrefilteredSpecular result = prefilter_specular(noise_lat_long(2 * height, height, 4).view(), options, control);
  double worst = 0.0;
  for (const MipRecord& mip : result.mips) worst = worse(worst, relative_error(mip.mean, result.mips[0].mean));
  return worst;
}

using SizedError = double (*)(int, const Control&);

/// `sizes` rise, with some below and some above 1024.
void add_sized(StabilityCases& cases, const std::string& name, const std::string& what, const std::string& truth,
               SizedError error, const std::vector<int>& sizes) {
  for (const int size : sizes) {
    cases.push_back({"accumulation/" + name + "-" + std::to_string(size),
                     what + ", size " + std::to_string(size),
                     truth,
                     StabilityUnit::relative,
                     kProjectionError,
                     [error, size](const Control& control) { return error(size, control); },
                     {},
                     size > 1024 ? Effort::full : Effort::quick});
  }
  const auto add_growth = [&](const std::vector<int>& small, const std::vector<int>& large, Effort effort) {
    const std::string most = std::to_string(large.back());
    cases.push_back(
        {"accumulation/" + name + "-growth-" + most,
         "the worst error of sizes " + std::to_string(large.front()) + " to " + most + " over that of " +
             std::to_string(small.front()) + " to " + std::to_string(small.back()) + " (below 2^-24 counts as 2^-24)",
         truth,
         StabilityUnit::ratio,
         4.0,
         [=](const Control& control) { return growth([&](int size) { return error(size, control); }, small, large); },
         {},
         effort});
  };
  add_growth({16, 64}, {256, 500, 512}, Effort::quick);
  const auto first_large = std::find_if(sizes.begin(), sizes.end(), [](int size) { return size > 1024; });
  add_growth({64, 256, 512}, {first_large, sizes.end()}, Effort::full);
}

}  // namespace

void add_accumulation_cases(StabilityCases& cases) {
  add_sized(cases, "noise-cube", "faces of noise by the midpoint rule", "the same sum in double", noise_error,
            {16, 64, 256, 512, 2048, 4096, 8192});
  add_sized(cases, "tenth-cube", "faces of 0.1 everywhere, which rounds the same way in every sum", "closed form",
            constant_error, {16, 64, 256, 1024, 2048, 4096, 8192});
  add_sized(cases, "tenth-lat-long", "the same on a lat-long, twice as wide as high", "closed form",
            constant_lat_long_error, {16, 64, 256, 1024, 2048, 4096});
  cases.push_back({"accumulation/mips-256", "the sphere's flux is the same on every mip of 256",
                   "flux of the first mip", StabilityUnit::relative, 1e-6,
                   [](const Control& control) { return mips_drift(256, control); }});
  cases.push_back({"accumulation/mips-2048",
                   "the sphere's flux is the same on every mip of 2048",
                   "flux of the first mip",
                   StabilityUnit::relative,
                   1e-6,
                   [](const Control& control) { return mips_drift(2048, control); },
                   {},
                   Effort::full});
  cases.push_back({"accumulation/prefilter-mean-128", "a prefiltered chain keeps the mean (source 256 x 128)",
                   "mean of the first mip", StabilityUnit::relative, 1e-3,
                   [](const Control& control) { return prefilter_drift(128, control); }});
  cases.push_back({"accumulation/prefilter-mean-2048",
                   "a prefiltered chain keeps the mean (source 4096 x 2048)",
                   "mean of the first mip",
                   StabilityUnit::relative,
                   1e-3,
                   [](const Control& control) { return prefilter_drift(2048, control); },
                   {},
                   Effort::full});
}

}  // namespace welkin::report::stability
