// From harmonics to rings.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "image/check_views.h"
#include "jobs/floating_point_scope.h"
#include "jobs/tiles.h"
#include "simd/kernels.h"
#include "specular/spectrum.h"
#include "tables/legendre_factors.h"
#include "tables/legendre_rings.h"
#include "tables/ring_fourier.h"
#include "tables/trigonometry.h"
#include "welkin/error.h"

namespace welkin::specular {
namespace {

/// What the Legendre stage needs for one order.
struct OrderScratch {
  OrderScratch(int bands, int groups)
      : coefficients(static_cast<std::size_t>(bands + 3) * simd::kHarmonicFloats),
        rows(simd::spline_scratch_floats(groups)) {}
  tables::AlignedBuffer<float> coefficients;
  tables::AlignedBuffer<float> rows;
};

/// What the Fourier stage needs for one group of rings.
struct RingScratch {
  RingScratch(int columns, const tables::RingFourier& fourier)
      : planes(std::size_t{3} * plane_floats(columns)), work(std::size_t{3} * fourier.scratch_floats()) {}
  static std::size_t plane_floats(int columns) { return static_cast<std::size_t>(columns) * simd::kComplexFloats; }
  tables::AlignedBuffer<float> planes;
  tables::AlignedBuffer<float> work;
};

class Synthesis {
 public:
  Synthesis(const Spectrum& spectrum, std::span<const double> zonal, image::SphereGrid& grid)
      : spectrum_(spectrum),
        zonal_(zonal),
        bands_(static_cast<int>(zonal.size())),
        grid_(grid),
        spline_(grid.content() == image::GridContent::spline_coefficients),
        kernels_(simd::active_kernels()),
        fourier_(tables::RingFourier::get(grid.columns())),
        factors_(tables::LegendreFactors::get(bands_)),
        rings_(tables::LegendreRings::get({grid.rings(), bands_, tables::RingPlaces::centres})),
        groups_(rings_->groups()),
        columns_(static_cast<std::size_t>(bands_) * static_cast<std::size_t>(groups_) * simd::kColumnFloats) {}

  void run(const Control& control);

 private:
  [[nodiscard]] float* column(int m, int group) noexcept {
    return columns_.data() +
           (static_cast<std::size_t>(m) * static_cast<std::size_t>(groups_) + static_cast<std::size_t>(group)) *
               simd::kColumnFloats;
  }
  void sum_order(int m, OrderScratch& room) noexcept;
  void write_rings(int group, RingScratch& room) noexcept;

  const Spectrum& spectrum_;
  std::span<const double> zonal_;
  int bands_;
  image::SphereGrid& grid_;
  bool spline_;
  const simd::Kernels& kernels_;
  std::shared_ptr<const tables::RingFourier> fourier_;
  std::shared_ptr<const tables::LegendreFactors> factors_;
  std::shared_ptr<const tables::LegendreRings> rings_;
  int groups_;
  tables::AlignedBuffer<float> columns_;  ///< [m][group][kColumnFloats]
};

void Synthesis::sum_order(int m, OrderScratch& room) noexcept {
  const jobs::FlushDenormalsScope flush;
  // A texel's longitude is pi - 2 pi (i + 1/2) / columns.
  const std::int64_t width = grid_.columns();
  const tables::SineCosine phase =
      tables::sine_cosine_of_turns(static_cast<double>(m * (width - 1) % (2 * width)) / static_cast<double>(2 * width));
  double scale = 1.0;
  if (spline_) {
    const double wave = tables::sine_cosine_of_turns(static_cast<double>(m) / static_cast<double>(width)).cosine;
    scale = simd::kSplineGain * 3.0 / (2.0 + wave);
  }
  const int count = bands_ - m;
  kernels_.transform.scale_harmonics({.scale = zonal_.data() + m,
                                      .gamma = factors_->gamma(m),
                                      .phase_real = scale * phase.cosine,
                                      .phase_imaginary = scale * phase.sine,
                                      .count = count},
                                     spectrum_.order(m), room.coefficients.data());
  float* const end = room.coefficients.data() + std::ptrdiff_t{simd::kHarmonicFloats} * count;
  std::fill_n(end, (4 * simd::fours_of(count) - count) * simd::kHarmonicFloats, 0.0F);
  kernels_.transform.synthesise_order(rings_->run(m, 0, groups_, *factors_), room.coefficients.data(), column(m, 0));
  if (spline_) kernels_.transform.spline_rings({groups_, grid_.rings(), m % 2 != 0}, column(m, 0), room.rows.data());
}

void Synthesis::write_rings(int group, RingScratch& room) noexcept {
  const jobs::FlushDenormalsScope flush;
  const int width = grid_.columns();
  // Spline coefficients reach a little beyond where the functions vanish.
  const int orders = rings_->orders(spline_ ? std::min(group + 1, groups_ - 1) : group);
  const float* planes[3] = {};
  for (int channel = 0; channel < 3; ++channel) {
    float* const plane = room.planes.data() + static_cast<std::size_t>(channel) * RingScratch::plane_floats(width);
    float* const work = room.work.data() + static_cast<std::size_t>(channel) * fourier_->scratch_floats();
    kernels_.transform.join_orders(column(0, group), std::ptrdiff_t{simd::kColumnFloats} * groups_, orders, channel,
                                   width, plane);
    planes[channel] = fourier_->transform(kernels_, plane, work);
  }
  simd::RingRows rows{};
  const int first = group * simd::kRingLanes;
  const int last = std::min(first + simd::kRingLanes, (grid_.rings() + 1) / 2);
  for (int ring = first; ring < last; ++ring) {
    rows.north[ring - first] = grid_.texel(0, ring);
    rows.south[ring - first] = grid_.texel(0, grid_.rings() - 1 - ring);
  }
  kernels_.transform.store_rings(planes[0], planes[1], planes[2], width, rows);
  grid_.fill_sides(first, last - first);
  grid_.fill_sides(grid_.rings() - last, last - first);
}

void Synthesis::run(const Control& control) {
  const std::int64_t texels = std::int64_t{grid_.columns()} * grid_.rings();
  const jobs::Placement placement = jobs::placement_for(texels + std::int64_t{bands_} * bands_ * groups_);
  const std::size_t workers = jobs::worker_count(placement);
  {
    std::vector<OrderScratch> rooms;
    for (std::size_t k = 0; k < workers; ++k) rooms.emplace_back(bands_, groups_);
    // A low order and a high one together: tiles of equal work.
    jobs::run_tiles(static_cast<std::size_t>((bands_ + 1) / 2), placement, workers, jobs::part_of(control, 0.0, 0.6),
                    [&](std::size_t tile, std::size_t worker) {
                      const int m = static_cast<int>(tile);
                      sum_order(m, rooms[worker]);
                      if (bands_ - 1 - m != m) sum_order(bands_ - 1 - m, rooms[worker]);
                    });
  }
  std::vector<RingScratch> rooms;
  for (std::size_t k = 0; k < workers; ++k) rooms.emplace_back(grid_.columns(), *fourier_);
  jobs::run_tiles(static_cast<std::size_t>(groups_), placement, workers, jobs::part_of(control, 0.6, 1.0),
                  [&](std::size_t group, std::size_t worker) { write_rings(static_cast<int>(group), rooms[worker]); });
  grid_.fill_poles();
}

}  // namespace

void synthesise(const Spectrum& spectrum, std::span<const double> zonal, image::SphereGrid& grid,
                const Control& control) {
  image::require_range("zonal factors", static_cast<std::int64_t>(zonal.size()), 1, spectrum.bands());
  image::require_range("rings of the grid", grid.rings(), 1, image::kLargestLatLongHeight);
  image::require_range("columns of the grid", grid.columns(), 2 * static_cast<std::int64_t>(zonal.size()) - 1,
                       image::kLargestLatLongWidth);
  if (grid.columns() % 2 != 0) {
    throw Error(ErrorCode::invalid_argument,
                "the grid has " + std::to_string(grid.columns()) + " columns; it needs an even number");
  }
  if (control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled by the caller");
  Synthesis(spectrum, zonal, grid).run(control);
}

}  // namespace welkin::specular
