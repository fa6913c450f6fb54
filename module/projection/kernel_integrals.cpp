#include "projection/kernel_integrals.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "jobs/tiles.h"
#include "math/elementary.h"

namespace welkin::projection {
namespace {

constexpr std::size_t kBatch = 512;  ///< axes at a time: bounds the memory, 12 MiB of slots
constexpr std::size_t kMaxTiles = 1024;

/// One worker's scratch.
struct Scratch {
  explicit Scratch(std::size_t columns) : texels(columns), spread(columns), cut(columns) {
    for (std::vector<double>* const list : {&values, &variances, &red, &green, &blue}) list->resize(columns);
  }
  TexelRow texels;
  TexelSpread spread;          ///< of kernels that are curved
  TexelPoints points;          ///< none: values at centroids do
  std::vector<double> looked;  ///< the kernel at a texel's points
  std::vector<double> values;  ///< the kernel's integral over each texel
  std::vector<double> variances;
  std::vector<int> cut;  ///< columns of texels that the value at their centroid is not good enough for
  std::vector<double> red, green, blue;

  /// From x at centroids to the means of x, and their variances.
  void add_spread(const glm::dvec3& axis) noexcept {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double a = axis.x * spread.ax[i] + axis.y * spread.ay[i] + axis.z * spread.az[i];
      const double b = axis.x * spread.bx[i] + axis.y * spread.by[i] + axis.z * spread.bz[i];
      variances[i] = a * a + b * b;
      values[i] = 1.0 - spread.length[i] * (1.0 - values[i]);
    }
  }
};

/// Lists the texels of a row, whose `room.values` are x, that are near the axis or at a break. Returns their number.
std::size_t list_cut(const KernelFunction& kernel, Scratch& scratch) {
  // x = 1 - cos(angle), and |d cos| <= d angle: over a texel x stays within `radius` of x at the centroid. So a texel
  // whose x is farther than that from the horizon (x = 1) and from a break is not cut. The test may list too many
  // texels, which costs time only.
  const double radius = scratch.texels.radius;
  const double far = scratch.points.count > 0 ? 0.0 : kernel.far(radius);
  const double horizon = kernel.hemisphere ? radius : -1.0;
  const double* const x = scratch.values.data();
  int* const cut = scratch.cut.data();
  const std::size_t columns = scratch.values.size();
  std::size_t count = 0;
  if (kernel.breaks.empty()) {
    for (std::size_t i = 0; i < columns; ++i) {
      if (x[i] < far || std::abs(x[i] - 1.0) <= horizon) cut[count++] = static_cast<int>(i);
    }
    return count;
  }
  for (std::size_t i = 0; i < columns; ++i) {
    const bool near = x[i] < far || std::abs(x[i] - 1.0) <= horizon;
    const auto reached = [&](double at) { return std::abs(x[i] - at) <= radius; };
    if (near || std::any_of(kernel.breaks.begin(), kernel.breaks.end(), reached)) cut[count++] = static_cast<int>(i);
  }
  return count;
}

/// Replaces x at centroids in `room.values` by integrals over the row's texels by their points; 0 where the kernel is.
/// Returns false if all are 0.
/// Points and their weights are made once per row and serve all axes: what an axis adds is a product of vectors and the
/// kernel's value per point.
bool integrate_points(const glm::dvec3& axis, const KernelFunction& kernel, Scratch& scratch) {
  const double radius = scratch.texels.radius;
  const TexelPoints& points = scratch.points;
  bool seen = false;
  std::size_t first = 0;
  for (double& value : scratch.values) {
    // By the same bound: no point of the texel is where the kernel is above 0.
    const bool dark = value > kernel.last + radius || value < kernel.first - radius;
    seen = seen || !dark;
    if (!dark) {
      for (std::size_t k = 0; k < points.count; ++k) {
        const std::size_t at = first + k;
        scratch.looked[k] = 1.0 - (axis.x * points.x[at] + axis.y * points.y[at] + axis.z * points.z[at]);
      }
      kernel.evaluate(scratch.looked);
      value = 0.0;
      for (std::size_t k = 0; k < points.count; ++k) value += points.weight[first + k] * scratch.looked[k];
    } else {
      value = 0.0;
    }
    first += points.count;
  }
  return seen;
}

/// Fills `room.values` with the integrals over a row's texels. False if all are zero.
bool fill_integrals(const TexelIntegrals& integrals, int row, const glm::dvec3& axis, const KernelFunction& kernel,
                    Scratch& scratch) {
  const TexelRow& texels = scratch.texels;
  double* const values = scratch.values.data();
  const std::size_t count = scratch.values.size();
  for (std::size_t i = 0; i < count; ++i)
    values[i] = 1.0 - (axis.x * texels.x[i] + axis.y * texels.y[i] + axis.z * texels.z[i]);
  const std::size_t cut = list_cut(kernel, scratch);
  int seen = cut > 0 ? 1 : 0;
  if (scratch.points.count > 0) {
    seen |= integrate_points(axis, kernel, scratch) ? 1 : 0;
  } else {
    // Away from breaks and the axis k(x) = k(x0) + k' (x - x0) + k'' (x - x0)^2 / 2 + ..., x0 = 1 - n . c `length` the
    // mean over the texel, c the centroid's unit direction: the linear term's mean is 0 and the quadratic one's k'' / 2
    // times the variance. Without that, and with x0 = 1 - n . c, the value would be off in the second order of the
    // radius r: a lobe that falls like L^-4 at L from its pole has the Laplacian 16 / L^2, times r^2 / 12 of a square
    // texel 1.3 (r / L)^2, and along a long texel 20 / L^2 times r^2 / 6, 3.3 (r / L)^2. A multiple of the cosine has
    // no such error with the moment as weight: Int n . d dw = n . Int d dw = moment (n . c).
    if (kernel.curved) {
      scratch.add_spread(axis);
      kernel.evaluate_means(scratch.values, scratch.variances);
    } else {
      kernel.evaluate(scratch.values);
    }
    const double* const weights = kernel.cosine ? texels.moment.data() : texels.solid_angle.data();
    for (std::size_t i = 0; i < count; ++i) {
      values[i] *= weights[i];
      seen |= values[i] != 0.0 ? 1 : 0;
    }
  }
  // Few texels, those at the horizon, a break or the axis: a band along a circle, so of n texels on the sphere of the
  // order of sqrt(n).
  for (std::size_t k = 0; k < cut; ++k) {
    const int column = scratch.cut[k];
    values[column] = integrals.integral({row, column}, axis, kernel);
  }
  return seen != 0;
}

void integrate_batch(const SanitizedSource& source, const TexelIntegrals& integrals, const KernelFunction& kernel,
                     std::span<const glm::dvec3> axes, const Control& control, std::vector<glm::dvec3>& result) {
  const auto rows = static_cast<std::size_t>(source.rows());
  const auto columns = static_cast<std::size_t>(source.columns());
  const std::size_t rows_per_tile = (rows + kMaxTiles - 1) / kMaxTiles;
  const std::size_t tiles = (rows + rows_per_tile - 1) / rows_per_tile;
  const jobs::Placement placement = jobs::placement_for(static_cast<std::int64_t>(rows * columns * axes.size()));
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<Scratch> scratches(workers, Scratch(columns));
  std::vector<glm::dvec3> slots(tiles * axes.size(), glm::dvec3(0.0));

  jobs::run_tiles(tiles, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
    Scratch& scratch = scratches[worker];
    glm::dvec3* const slot = slots.data() + tile * axes.size();
    for (std::size_t row = tile * rows_per_tile; row < std::min(rows, (tile + 1) * rows_per_tile); ++row) {
      const float* const rgb = source.row(static_cast<int>(row));
      for (std::size_t i = 0; i < columns; ++i) {
        scratch.red[i] = static_cast<double>(rgb[3 * i]);
        scratch.green[i] = static_cast<double>(rgb[3 * i + 1]);
        scratch.blue[i] = static_cast<double>(rgb[3 * i + 2]);
      }
      integrals.fill(static_cast<int>(row), scratch.texels);
      const int order = kernel.shared_order(scratch.texels.radius);
      if (order > 0) integrals.fill(static_cast<int>(row), order, scratch.points);
      if (order == 0) scratch.points.count = 0;
      if (kernel.curved && order == 0) integrals.fill(static_cast<int>(row), scratch.texels, scratch.spread);
      scratch.looked.resize(scratch.points.count);
      for (std::size_t n = 0; n < axes.size(); ++n) {
        if (!fill_integrals(integrals, static_cast<int>(row), axes[n], kernel, scratch)) continue;
        slot[n] += glm::dvec3(math::dot(scratch.values, scratch.red), math::dot(scratch.values, scratch.green),
                              math::dot(scratch.values, scratch.blue));
      }
    }
  });

  // Slots are added tile after tile, whichever thread filled them, so the sums' order does not depend on the threads.
  const std::size_t first = result.size();
  result.resize(first + axes.size(), glm::dvec3(0.0));
  for (std::size_t k = 0; k < slots.size(); ++k) result[first + k % axes.size()] += slots[k];
}

}  // namespace

std::vector<glm::dvec3> integrate_kernel(const SanitizedSource& source, const KernelFunction& kernel,
                                         std::span<const glm::dvec3> axes, const Control& control) {
  const auto integrals =
      texel_integrals_of(source.cubemap() ? image::TexelGrid::cubemap(source.columns())
                                          : image::TexelGrid::lat_long(source.columns(), source.rows()));
  const auto share = [&](std::size_t count) { return static_cast<double>(count) / static_cast<double>(axes.size()); };
  std::vector<glm::dvec3> result;
  while (result.size() < axes.size()) {
    const std::size_t first = result.size();
    const std::size_t count = std::min(kBatch, axes.size() - first);
    const Control part = jobs::part_of(control, share(first), share(first + count));
    integrate_batch(source, *integrals, kernel, axes.subspan(first, count), part, result);
  }
  return result;
}

}  // namespace welkin::projection
