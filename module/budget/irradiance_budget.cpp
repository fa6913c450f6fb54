// How many bands irradiance needs.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "budget/budget.h"
#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/basis.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/irradiance.h"
#include "projection/sanitized_pixels.h"
#include "projection/sun_detection.h"
#include "welkin/core.h"

namespace welkin {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kNormals = 400;
constexpr double kPeakOfMany = 5.0;  ///< over the rms, of light from many places; of one sun's the first bound is less
constexpr double kBetweenNormals = 1.1;  ///< a maximum over 400 normals may miss the peak by a tenth of it
/// An rms over a few hundred normals, as who checks it will take, differs from that over all by some percent.
constexpr double kSampledNormals = 1.05;
constexpr double kRounding = 5e-7;               ///< of the coefficients
constexpr double kCoefficientNanoseconds = 1.0;  ///< of an evaluation
constexpr int kMeasuredBands = kMaximumBands;

/// The cosine lobe max(0, cos) without its first bands.
struct LobeTail {
  double rms = 0.0;           ///< over the sphere
  double maximum = 0.0;       ///< over the sphere
  double largest_band = 0.0;  ///< largest |A_l| among the bands left
};

/// |A_l| falls with l but for the odd bands, which are zero above 1.
LobeTail lobe_tail(int bands) {
  LobeTail tail;
  double kept = 0.0;
  for (int l = 0; l < bands; ++l) kept += cosine_lobe(l) * cosine_lobe(l) * (2.0 * l + 1.0) / (16.0 * kPi * kPi);
  tail.rms = std::sqrt(std::max(0.0, 1.0 / 6.0 - kept));
  tail.largest_band = std::max(std::abs(cosine_lobe(bands)), std::abs(cosine_lobe(bands + 1)));
  constexpr int steps = 2000;
  for (int k = 0; k <= steps; ++k) {
    const double x = 2.0 * k / steps - 1.0;
    double value = std::max(0.0, x);
    double before = 0.0;
    double legendre = 1.0;
    for (int l = 0; l < bands; ++l) {
      value -= cosine_lobe(l) * (2.0 * l + 1.0) / (4.0 * kPi) * legendre;
      const double next = ((2.0 * l + 1.0) * x * legendre - l * before) / (l + 1.0);
      before = legendre;
      legendre = next;
    }
    tail.maximum = std::max(tail.maximum, std::abs(value));
  }
  return tail;
}

/// Irradiance of what each setting leaves out of the bands that are known.
class KnownBands {
 public:
  explicit KnownBands(const SphericalHarmonics& radiance) : irradiance_(irradiance_from_radiance(radiance)) {
    const auto bands = static_cast<std::size_t>(radiance.bands());
    squares_.resize(bands + 1);
    maxima_.resize(bands + 1);
    for (std::size_t l = bands; l-- > 0;) {
      squares_[l] = squares_[l + 1];
      for (std::size_t k = l * l; k < (l + 1) * (l + 1); ++k)
        squares_[l] += glm::dot(irradiance_.coefficients()[k], irradiance_.coefficients()[k]) / (4.0 * kPi);
    }
    std::vector<double> basis(irradiance_.coefficients().size());
    for (const glm::dvec3& normal : projection::spiral(kNormals)) look_towards(normal, basis);
  }

  /// Root mean square of all but the first bands' irradiance; 0: of the whole.
  [[nodiscard]] double rms(int bands) const { return std::sqrt(squares_[static_cast<std::size_t>(bands)]); }
  [[nodiscard]] double maximum(int bands) const { return maxima_[static_cast<std::size_t>(bands)]; }

 private:
  void look_towards(const glm::dvec3& normal, std::vector<double>& basis) {
    math::evaluate_basis(normal.x, normal.y, normal.z, irradiance_.bands(), basis.data());
    glm::dvec3 sum(0.0);
    for (std::size_t l = maxima_.size() - 1; l-- > 0;) {
      for (std::size_t k = l * l; k < (l + 1) * (l + 1); ++k) sum += basis[k] * irradiance_.coefficients()[k];
      maxima_[l] = std::max(maxima_[l], glm::length(sum));
    }
  }

  SphericalHarmonics irradiance_;
  std::vector<double> squares_;
  std::vector<double> maxima_;
};

double root_of_squares(double a, double b) { return std::sqrt(a * a + b * b); }

void check_high(const HighBands& high) {
  if (high.energy >= 0.0 && high.absolute >= 0.0 && std::isfinite(high.energy) && std::isfinite(high.absolute)) return;
  throw Error(ErrorCode::invalid_argument, "what is in the high bands is energy " + platform::number_text(high.energy) +
                                               " and absolute " + platform::number_text(high.absolute) +
                                               "; both must be finite and not negative");
}

template <class View>
BudgetChoice<int> choose(const View& view, const ErrorBudget& budget, const PixelPolicy& pixels,
                         const Control& control) {
  budget::check_budget(budget);
  const ProjectionOptions all{.bands = kMeasuredBands, .pixels = pixels};
  const SphericalHarmonics radiance = project(view, all, jobs::part_of(control, 0.0, 0.7)).radiance;
  const HighBands high = budget::high_bands(view, radiance, pixels, jobs::part_of(control, 0.7, 1.0));
  return choose_irradiance_bands(radiance, high, budget);
}

}  // namespace

BudgetChoice<int> choose_irradiance_bands(const SphericalHarmonics& radiance, const HighBands& high,
                                          const ErrorBudget& budget) {
  const platform::FloatingPointScope floating_point;
  budget::check_budget(budget);
  check_high(high);
  const bool by_maximum = budget.measure == ErrorMeasure::maximum;
  const KnownBands known(radiance);
  const LobeTail lobe = lobe_tail(radiance.bands());
  const double root = std::sqrt(high.energy);
  const double rest_rms = std::min(lobe.rms * high.absolute, lobe.largest_band * root / std::sqrt(4.0 * kPi));
  const double rest_maximum = std::min({lobe.maximum * high.absolute, lobe.rms * std::sqrt(4.0 * kPi) * root,
                                        kPeakOfMany * lobe.largest_band * root / std::sqrt(4.0 * kPi)});
  const double whole = known.rms(0);
  BudgetChoice<int> choice;
  choice.relative_to = "root mean square of the irradiance over all normals";
  for (int bands = 1; bands <= radiance.bands(); bands += bands < 3 ? 1 : 2) {
    const double error = by_maximum ? kBetweenNormals * known.maximum(bands) + rest_maximum
                                    : kSampledNormals * root_of_squares(known.rms(bands), rest_rms);
    const double relative = whole > 0.0   ? error / whole + kRounding
                            : error > 0.0 ? std::numeric_limits<double>::infinity()
                                          : 0.0;
    choice.tried.push_back({bands, relative, kCoefficientNanoseconds * bands * bands});
  }
  budget::settle(choice, budget);
  return choice;
}

BudgetChoice<int> choose_irradiance_bands(const CubemapView& cubemap, const ErrorBudget& budget,
                                          const PixelPolicy& pixels, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return choose(cubemap, budget, pixels, control);
}

BudgetChoice<int> choose_irradiance_bands(const LatLongView& lat_long, const ErrorBudget& budget,
                                          const PixelPolicy& pixels, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return choose(lat_long, budget, pixels, control);
}

}  // namespace welkin

namespace welkin::budget {
namespace {

image::TexelGrid grid_of(const CubemapView& view) { return image::TexelGrid::cubemap(view.size); }
image::TexelGrid grid_of(const LatLongView& view) { return image::TexelGrid::lat_long(view.width, view.height); }

/// One class of rows: Int |L - mean|^2 and Int |L - mean|.
HighBands sum_rows(const projection::SanitizedSource& source, const image::TexelGrid& grid, int row_class,
                   const glm::dvec3& mean, std::span<double> steradians) {
  HighBands sums;
  grid.solid_angles(row_class, steradians);
  for (const int row : grid.rows_of(row_class)) {
    const float* rgb = source.row(row);
    for (std::size_t column = 0; column < steradians.size(); ++column, rgb += 3) {
      const glm::dvec3 off = projection::radiance_of(rgb) - mean;
      const double square = glm::dot(off, off);
      sums.energy += steradians[column] * square;
      sums.absolute += steradians[column] * std::sqrt(square);
    }
  }
  return sums;
}

template <class View>
HighBands measure(const View& view, const SphericalHarmonics& radiance, const PixelPolicy& pixels,
                  const Control& control) {
  const projection::SanitizedSource source(view, pixels, {control.stop, {}});
  const image::TexelGrid grid = grid_of(view);
  const glm::dvec3 mean = mean_radiance(radiance);
  const auto classes = static_cast<std::size_t>(grid.row_classes());
  const auto columns = static_cast<std::size_t>(grid.columns());
  const jobs::Placement placement = jobs::placement_for(grid.texels());
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<double> steradians(workers * columns);
  std::vector<HighBands> slots(classes);
  jobs::run_tiles(classes, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
    slots[tile] =
        sum_rows(source, grid, static_cast<int>(tile), mean, std::span(steradians).subspan(worker * columns, columns));
  });
  HighBands sums;
  for (const HighBands& slot : slots) {
    sums.energy += slot.energy;
    sums.absolute += slot.absolute;
  }
  // Parseval: what the first bands hold of it is their coefficients' squares, band 0 being the mean.
  for (std::size_t k = 1; k < radiance.coefficients().size(); ++k)
    sums.energy -= glm::dot(radiance.coefficients()[k], radiance.coefficients()[k]);
  sums.energy = std::max(0.0, sums.energy);
  return sums;
}

}  // namespace

HighBands high_bands(const CubemapView& view, const SphericalHarmonics& radiance, const PixelPolicy& pixels,
                     const Control& control) {
  return measure(view, radiance, pixels, control);
}

HighBands high_bands(const LatLongView& view, const SphericalHarmonics& radiance, const PixelPolicy& pixels,
                     const Control& control) {
  return measure(view, radiance, pixels, control);
}

}  // namespace welkin::budget
