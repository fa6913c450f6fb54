// From pixels to harmonics.
//
// Texels are areas, so c(l, m) = sum over rows of F(m, row) Int P(l, m) sin(theta) d theta, F the row's Fourier
// coefficient times the column's sinc. Summed by parts, the integrals' recurrence (legendre_factors.h) asks for
//   K(l) = sum over edges between rows of (F(below) - F(above)) sin^2(theta) P(l, m) at the edge:
// the functions are needed at edges only, the result is exact at any size and any number of bands, and what is
// transformed are differences of neighbouring rows, taken between the pixels themselves before anything rounds.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>
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

constexpr double kPi = std::numbers::pi;

/// What the Fourier stage needs for one group of rings.
struct RowScratch {
  RowScratch(int width, const tables::RingFourier& fourier)
      : planes(std::size_t{3} * static_cast<std::size_t>(width) * simd::kComplexFloats),
        work(fourier.scratch_floats()) {}
  tables::AlignedBuffer<float> planes;
  tables::AlignedBuffer<float> work;
};

/// What the Legendre stage needs for one order.
struct OrderScratch {
  explicit OrderScratch(int bands)
      : state(std::size_t{simd::kAnalysisGroups} * 2 * simd::kRingLanes),
        sums(static_cast<std::size_t>(bands + 7) * simd::kHarmonicFloats) {}
  tables::AlignedBuffer<double> state;
  tables::AlignedBuffer<float> sums;
};

class Analysis {
 public:
  Analysis(const LatLongView& source, int bands)
      : source_(source),
        bands_(bands),
        kernels_(simd::active_kernels()),
        fourier_(tables::RingFourier::get(source.width)),
        factors_(tables::LegendreFactors::get(bands)),
        rings_(tables::LegendreRings::get({source.height, bands, tables::RingPlaces::edges})),
        groups_(rings_->groups()),
        zeros_(std::size_t{3} * static_cast<std::size_t>(source.width), 0.0F),
        columns_(static_cast<std::size_t>(bands) * static_cast<std::size_t>(groups_) * simd::kColumnFloats),
        spectrum_(bands) {}

  [[nodiscard]] Spectrum run(const Control& control);

 private:
  [[nodiscard]] const float* row(int index) const noexcept {
    const std::ptrdiff_t packed = std::ptrdiff_t{12} * source_.width;
    const std::ptrdiff_t stride = source_.row_stride_bytes != 0 ? source_.row_stride_bytes : packed;
    return reinterpret_cast<const float*>(static_cast<const std::byte*>(source_.pixels) + index * stride);
  }
  [[nodiscard]] float* column(int m, int group) noexcept {
    return columns_.data() +
           (static_cast<std::size_t>(m) * static_cast<std::size_t>(groups_) + static_cast<std::size_t>(group)) *
               simd::kColumnFloats;
  }
  [[nodiscard]] simd::RowQuads rows_of(int group) const noexcept;
  void transform_rows(int group, RowScratch& room) noexcept;
  void sum_order(int m, OrderScratch& room) noexcept;

  const LatLongView& source_;
  int bands_;
  const simd::Kernels& kernels_;
  std::shared_ptr<const tables::RingFourier> fourier_;
  std::shared_ptr<const tables::LegendreFactors> factors_;
  std::shared_ptr<const tables::LegendreRings> rings_;
  int groups_;
  std::vector<float> zeros_;              ///< a black row
  tables::AlignedBuffer<float> columns_;  ///< [m][group][kColumnFloats]
  Spectrum spectrum_;
};

/// Lane q: the steps across edge q + 1 from either pole. The last lane: the rows next to the equator, whose step is the
/// even part there (none in an odd number of rows) and whose sum starts the integrals.
simd::RowQuads Analysis::rows_of(int group) const noexcept {
  const int height = source_.height;
  const int pairs = tables::LegendreRings::pairs_of(height, tables::RingPlaces::edges);
  simd::RowQuads rows{};
  for (int lane = 0; lane < simd::kRingLanes; ++lane) {
    const int edge = group * simd::kRingLanes + lane + 1;
    if (edge < pairs) {
      rows.a[lane] = row(edge);
      rows.b[lane] = row(edge - 1);
      rows.c[lane] = row(height - edge);
      rows.d[lane] = row(height - 1 - edge);
    } else {
      const bool equator = edge == pairs;
      rows.a[lane] = equator ? row(height / 2) : zeros_.data();
      rows.b[lane] = rows.c[lane] = zeros_.data();
      rows.d[lane] = equator ? row((height + 1) / 2 - 1) : zeros_.data();
    }
  }
  return rows;
}

void Analysis::transform_rows(int group, RowScratch& room) noexcept {
  const jobs::FlushDenormalsScope flush;
  const int width = source_.width;
  kernels_.transform.load_row_quads(rows_of(group), width, room.planes.data());
  for (int channel = 0; channel < 3; ++channel) {
    float* const plane = room.planes.data() + std::ptrdiff_t{simd::kComplexFloats} * channel * width;
    const float* const z = fourier_->transform(kernels_, plane, room.work.data());
    kernels_.transform.part_orders(z, width, rings_->orders(group), channel, column(0, group),
                                   std::ptrdiff_t{simd::kColumnFloats} * groups_);
  }
}

void Analysis::sum_order(int m, OrderScratch& room) noexcept {
  const jobs::FlushDenormalsScope flush;
  const int first = rings_->first_group(m);
  std::fill_n(room.sums.data(), (bands_ - m + 7) * simd::kHarmonicFloats, 0.0F);
  for (int group = first; group < groups_; group += simd::kAnalysisGroups) {
    const int count = std::min(simd::kAnalysisGroups, groups_ - group);
    kernels_.transform.analyse_order(rings_->run(m, group, count, *factors_), column(m, group), room.state.data(),
                                     room.sums.data());
  }
  // A pixel's longitude is pi - 2 pi (i + 1/2) / width, and its extent turns the value at the centre into an integral;
  // the column numbers are doubled.
  const std::int64_t width = source_.width;
  const tables::SineCosine phase =
      tables::sine_cosine_of_turns(static_cast<double>(m * (width + 1) % (2 * width)) / static_cast<double>(2 * width));
  const double extent =
      m == 0 ? 2.0 * kPi / static_cast<double>(width)
             : 2.0 *
                   tables::sine_cosine_of_turns(static_cast<double>(m % (2 * width)) / static_cast<double>(2 * width))
                       .sine /
                   m;
  simd::IntegralRun run{.alpha = factors_->alpha(m),
                        .beta = factors_->beta(m),
                        .first = {},
                        .phase_real = 0.5 * extent * phase.cosine,
                        .phase_imaginary = 0.5 * extent * phase.sine,
                        .count = bands_ - m};
  if (first < groups_) {
    kernels_.transform.weigh_odd_parts(column(m, first),
                                       rings_->row_weights(m) + std::ptrdiff_t{simd::kRingLanes} * first,
                                       groups_ - first, run.first);
  }
  kernels_.transform.integrate_sums(run, room.sums.data(), spectrum_.order(m));
}

Spectrum Analysis::run(const Control& control) {
  const std::int64_t texels = std::int64_t{source_.width} * source_.height;
  const jobs::Placement placement = jobs::placement_for(texels + std::int64_t{bands_} * bands_ * groups_);
  const std::size_t workers = jobs::worker_count(placement);
  {
    std::vector<RowScratch> rooms;
    for (std::size_t k = 0; k < workers; ++k) rooms.emplace_back(source_.width, *fourier_);
    jobs::run_tiles(
        static_cast<std::size_t>(groups_), placement, workers, jobs::part_of(control, 0.0, 0.4),
        [&](std::size_t group, std::size_t worker) { transform_rows(static_cast<int>(group), rooms[worker]); });
  }
  std::vector<OrderScratch> rooms;
  for (std::size_t k = 0; k < workers; ++k) rooms.emplace_back(bands_);
  // A low order and a high one together: tiles of equal work.
  jobs::run_tiles(static_cast<std::size_t>((bands_ + 1) / 2), placement, workers, jobs::part_of(control, 0.4, 1.0),
                  [&](std::size_t tile, std::size_t worker) {
                    const int m = static_cast<int>(tile);
                    sum_order(m, rooms[worker]);
                    if (bands_ - 1 - m != m) sum_order(bands_ - 1 - m, rooms[worker]);
                  });
  return std::move(spectrum_);
}

}  // namespace

Spectrum analyse(const LatLongView& source, int bands, const Control& control) {
  image::check_view(source);
  image::require_range("bands", bands, 1, kMaximumSpectrumBands);
  if (source.format != PixelFormat::rgb_f32) {
    throw Error(ErrorCode::invalid_argument, "the transform reads rgb_f32 pixels only; decode them first");
  }
  if (control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled by the caller");
  return Analysis(source, bands).run(control);
}

}  // namespace welkin::specular
