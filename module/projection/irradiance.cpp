// Irradiance texel by texel: no harmonics, many normals at a time.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/basis.h"
#include "math/direction.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "projection/kernel_integrals.h"
#include "projection/projection_kernels.h"
#include "projection/sanitizer.h"
#include "welkin/core.h"
#include "welkin/projection.h"

namespace welkin {
namespace {

constexpr std::ptrdiff_t kMaxNormals = 100'000;

void require_possible(std::ptrdiff_t normals) {
  if (normals >= 1 && normals <= kMaxNormals) return;
  throw Error(ErrorCode::invalid_argument,
              std::to_string(normals) + " normals; 1 to " + std::to_string(kMaxNormals) + " are possible");
}

/// Returns directions that cover the sphere evenly: equal steps in height, the golden angle apart in azimuth.
/// Their bits are the same on every machine. Throws `Error` (invalid_argument) unless 1 <= count <= 100 000.
std::vector<glm::dvec3> spiral(int count) {
  require_possible(count);
  // The Fibonacci spiral. A zone of the sphere of height dy has the area 2 pi dy (Archimedes), so heights in equal
  // steps give each point the same area, and plain means over the points are means over the sphere. The azimuth
  // advances by the golden angle, 1 - 1 / phi of a turn: its continued fraction is [0; 2, 1, 1, 1, ...], so no small
  // number of steps nearly closes a turn and points of neighbouring rounds do not line up.
  const double golden = 0.5 * (3.0 - std::sqrt(5.0));  // of a turn
  std::vector<glm::dvec3> normals;
  for (int i = 0; i < count; ++i) {
    const double y = 1.0 - (2.0 * i + 1.0) / count;
    // sqrt(1 - y^2) without the cancellation of 1 - y y near the poles.
    const double ring = std::sqrt((1.0 - y) * (1.0 + y));
    const math::SineCosine azimuth = math::sine_cosine_of_turns(golden * i);
    normals.emplace_back(ring * azimuth.sine, y, ring * azimuth.cosine);
  }
  return normals;
}

/// max(0, cosine).
/// E(n) = Int L max(0, n . d) dw is the sum over texels of L Int max(0, n . d) dw. For a texel above the horizon the
/// integral is the scalar product of n and Int d dw; a texel below it has none; the few that the horizon cuts are
/// integrated over the part above it (texel_integrals.cpp).
class CosineFunction final : public projection::KernelFunction {
 public:
  CosineFunction() {
    last = 1.0;
    hemisphere = true;
    cosine = true;
  }
  [[nodiscard]] double at(double x) const noexcept override { return x < 1.0 ? 1.0 - x : 0.0; }
  void evaluate(std::span<double> x) const noexcept override {
    for (double& value : x) value = value < 1.0 ? 1.0 - value : 0.0;
  }
  /// Returns the points along an edge. On a face the integrand is (a u + b v + c) r^-4, which is linear but for the
  /// texel's own shape: poles lie at u = +-i sqrt(1 + v^2). With the half-width h = radius / sqrt(2), k points are off
  /// by nearly (h / 2)^(2k): measured at random texels and axes, 1.6e-8 of the texel's solid angle at radius 0.02 with
  /// 2 points, 9e-9 at 0.09 with 3 and 6e-9 at 0.2 with 4. From 0.2 on the texel is divided.
  [[nodiscard]] int order(double /*x*/, double radius) const noexcept override {
    if (radius < 0.02) return 2;
    if (radius < 0.09) return 3;
    return radius < 0.2 ? 4 : 0;
  }
  // No texel is too near to the axis: a texel's moment gives the integral of a cosine exactly.
  [[nodiscard]] double far(double /*radius*/) const noexcept override { return 0.0; }
};

std::vector<glm::dvec3> unit_normals(std::span<const glm::dvec3> normals) {
  require_possible(static_cast<std::ptrdiff_t>(normals.size()));
  return math::unit_directions(normals, "normal");
}

}  // namespace

std::vector<glm::dvec3> direct_irradiance(const EnvironmentView& environment, std::span<const glm::dvec3> normals,
                                          const PixelPolicy& pixels, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(environment);
  projection::check_policy(pixels);
  const std::vector<glm::dvec3> units = unit_normals(normals);
  const projection::SanitizedSource source(environment, pixels, {control.stop, {}});
  return projection::integrate_kernel(source, CosineFunction(), units, control);
}

glm::dvec3 direct_irradiance(const EnvironmentView& environment, const glm::dvec3& normal) {
  const platform::FloatingPointScope floating_point;
  return direct_irradiance(environment, {&normal, 1}).front();
}

namespace {

// Compares the irradiance of the first bands with the direct one.

double ratio(double difference, double whole) {
  if (difference == 0.0) return 0.0;
  return whole > 0.0 ? difference / whole : std::numeric_limits<double>::infinity();
}

std::vector<IrradianceError> errors_at(const std::vector<glm::dvec3>& normals, const std::vector<glm::dvec3>& truth,
                                       const SphericalHarmonics& radiance) {
  const auto bands = static_cast<std::size_t>(radiance.bands());
  const SphericalHarmonics irradiance = irradiance_from_radiance(radiance);
  std::vector<double> basis(irradiance.coefficients().size());
  std::vector<IrradianceError> errors(bands);
  std::vector<double> squares(bands);
  double truth_squares = 0.0;
  for (std::size_t n = 0; n < normals.size(); ++n) {
    math::evaluate_basis(normals[n].x, normals[n].y, normals[n].z, radiance.bands(), basis.data());
    const double size = glm::length(truth[n]);
    truth_squares += size * size;
    glm::dvec3 sum(0.0);
    for (std::size_t l = 0; l < bands; ++l) {
      // `sum` is E of l + 1 bands here: one pass over the coefficients gives the errors of all numbers of bands.
      for (std::size_t k = l * l; k < (l + 1) * (l + 1); ++k) sum += basis[k] * irradiance.coefficients()[k];
      const double difference = glm::length(sum - truth[n]);
      squares[l] += difference * difference;
      if (difference >= errors[l].maximum) {
        errors[l].maximum = difference;
        errors[l].worst_normal = normals[n];
      }
      errors[l].relative = std::max(errors[l].relative, ratio(difference, size));
    }
  }
  // Normals stand for equal areas (`spiral`), so no weights are needed: rms = sqrt(Int |E_l - E|^2 / Int |E|^2).
  const double truth_rms = std::sqrt(truth_squares / static_cast<double>(normals.size()));
  for (std::size_t l = 0; l < bands; ++l) {
    errors[l].bands = static_cast<int>(l) + 1;
    errors[l].rms = ratio(std::sqrt(squares[l] / static_cast<double>(normals.size())), truth_rms);
    errors[l].maximum = ratio(errors[l].maximum, truth_rms);
  }
  return errors;
}

}  // namespace

std::vector<IrradianceError> irradiance_errors(const EnvironmentView& environment, const SphericalHarmonics& radiance,
                                               int normals, const PixelPolicy& pixels, const Control& control) {
  const platform::FloatingPointScope floating_point;
  const std::vector<glm::dvec3> directions = spiral(normals);
  return errors_at(directions, direct_irradiance(environment, directions, pixels, control), radiance);
}

namespace {

constexpr int kLargestSize = 4096;
constexpr double kTileProducts = 1e6;    ///< texels times coefficients: approximately 0.2 ms
constexpr double kInlineProducts = 1e5;  ///< less is done by the caller's thread alone
constexpr std::size_t kNormalsAtATime = 65536;
constexpr double kMaxIrradiance = std::numeric_limits<float>::max();

Cubemap empty_cubemap(int size, const Control& control) {
  image::require_range("the irradiance cubemap's size", size, 1, kLargestSize);
  return Cubemap(size, 1, control.memory);
}

/// Channel after channel, as the kernel wants them.
std::vector<double> channels_of(const SphericalHarmonics& harmonics) {
  std::vector<double> channels;
  for (int c = 0; c < 3; ++c) {
    for (const glm::dvec3& coefficient : harmonics.coefficients()) channels.push_back(coefficient[c]);
  }
  return channels;
}

/// Returns u of each column's centre, (2 column + 1) / size - 1, as one quotient of whole numbers: rounded once, and
/// exactly symmetric about 0.
std::vector<double> texel_centres(int size) {
  std::vector<double> centres;
  centres.reserve(static_cast<std::size_t>(size));
  for (int column = 0; column < size; ++column) centres.push_back(static_cast<double>(2 * column + 1 - size) / size);
  return centres;
}

/// Returns whether these coefficients can sum to more than the floats hold. By the addition theorem the squares of a
/// band's harmonics sum to (2 l + 1) / (4 pi), so |Y(l, m)| <= sqrt(31 / (4 pi)) = 1.571 for l <= 15; 2.3 leaves room.
/// A NaN fails the comparison and counts as an overflow.
bool may_overflow(const std::vector<double>& channels) {
  double sum = 0.0;
  for (const double value : channels) sum += 2.3 * std::abs(value);
  return !(sum <= kMaxIrradiance);
}

}  // namespace

Cubemap irradiance_cubemap(const SphericalHarmonics& irradiance, int size, const Control& control) {
  const platform::FloatingPointScope floating_point;
  Cubemap result = empty_cubemap(size, control);
  const projection::ProjectionKernels& kernels = projection::projection_kernels();
  const std::vector<double> channels = channels_of(irradiance);
  const std::vector<double> centres = texel_centres(size);
  const int bands = irradiance.bands();
  const double row_products = 1.0 * size * bands * bands;
  const int rows = 6 * size;
  const int tile_rows = static_cast<int>(std::clamp(kTileProducts / row_products, 1.0, 1.0 * rows));
  const bool small = row_products * rows < kInlineProducts;
  const auto placement = small ? jobs::Placement::calling_thread : jobs::Placement::arena;
  jobs::run_rows(rows, tile_rows, placement, jobs::worker_count(placement), control, [&](int row, std::size_t) {
    const image::Frame& frame = image::face_frame(row / size);
    const double v = centres[static_cast<std::size_t>(row % size)];
    projection::DirectionRun run{};
    for (int axis = 0; axis < 3; ++axis) {
      // Points of a face's row, not of unit length: start + u step = normal + v v' + u u' with the frame's axes u' and
      // v'. The kernel normalizes.
      run.start[axis] = frame.normal[axis] + v * frame.v[axis];
      run.step[axis] = frame.u[axis];
    }
    run.u = centres.data();
    run.count = size;
    kernels.evaluate_harmonics(run, math::basis_constants(), channels.data(), bands,
                               result.face(0) + std::ptrdiff_t{3} * row * size);
  });
  if (may_overflow(channels)) {
    constexpr auto most = static_cast<float>(kMaxIrradiance);
    for (float& value : result.pixels()) value = std::clamp(value, -most, most);
  }
  return result;
}

Cubemap direct_irradiance_cubemap(const EnvironmentView& source, int size, const Control& control) {
  const platform::FloatingPointScope floating_point;
  Cubemap result = empty_cubemap(size, control);
  const std::span<float> pixels = result.pixels();
  const std::size_t texels = pixels.size() / 3;
  const auto grid = image::TexelGrid::cubemap(size);
  std::vector<glm::dvec3> normals;
  for (std::size_t first = 0; first < texels; first += normals.size()) {
    const std::size_t end = std::min(texels, first + kNormalsAtATime);
    normals.clear();
    for (std::size_t texel = first; texel < end; ++texel)
      normals.push_back(grid.direction(static_cast<std::int64_t>(texel)));
    const auto share = [&](std::size_t done) { return static_cast<double>(done) / static_cast<double>(texels); };
    const Control part = jobs::part_of(control, share(first), share(end));
    const std::vector<glm::dvec3> irradiance = direct_irradiance(source, normals, {}, part);
    for (std::size_t i = 0; i < irradiance.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = irradiance[i][static_cast<glm::length_t>(c)];
        pixels[3 * (first + i) + c] = static_cast<float>(std::clamp(value, -kMaxIrradiance, kMaxIrradiance));
      }
    }
  }
  return result;
}

}  // namespace welkin
