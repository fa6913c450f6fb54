// From pixels to harmonics.
//
// Texels are areas, so c(l, m) = sum over rows of F(m, row) Int P(l, m) sin(theta) d theta, F the row's Fourier
// coefficient times the column's sinc. Summed by parts, the integrals' recurrence (ring_legendre.h) needs
//   K(l) = sum over edges between rows of (F(below) - F(above)) sin^2(theta) P(l, m) at the edge:
// the functions are needed at edges only, the result is exact at any size and any number of bands, and what is
// transformed are differences of neighbouring rows, taken between the pixels themselves before anything rounds.
#include "transform/spectrum.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "transform/dark_scale.h"
#include "transform/ring_fft.h"
#include "transform/ring_legendre.h"
#include "transform/row_reduction.h"
#include "transform/transform_kernels.h"
#include "welkin/core.h"

namespace welkin::transforms {

Spectrum::Spectrum(int bands) : bands_(bands) {
  image::require_range("bands", bands, 1, kMaximumSpectrumBands);
  values_ = platform::AlignedBuffer<float>(start(bands));
  std::fill_n(values_.data(), values_.size(), 0.0F);
}

std::size_t Spectrum::start(int m) const noexcept {
  const auto order = static_cast<std::size_t>(m);
  const std::size_t before = order * static_cast<std::size_t>(bands_) - order * (order > 0 ? order - 1 : 0) / 2;
  return before * kHarmonicFloats;
}

std::complex<double> Spectrum::value(int l, int m, int channel) const noexcept {
  const float* const values = order(m) + std::ptrdiff_t{kHarmonicFloats} * (l - m) + std::ptrdiff_t{2} * channel;
  return {values[0], values[1]};
}

namespace {

constexpr double kPi = std::numbers::pi;

/// Calls `use(m, worker)` for all orders, in tiles of equal work: a low order and a high one together.
template <class Use>
void run_orders(int bands, jobs::Placement placement, std::size_t workers, const Control& control, const Use& use) {
  jobs::run_tiles(static_cast<std::size_t>((bands + 1) / 2), placement, workers, control,
                  [&](std::size_t tile, std::size_t worker) {
                    const int m = static_cast<int>(tile);
                    use(m, worker);
                    if (bands - 1 - m != m) use(bands - 1 - m, worker);
                  });
}

/// Scratch memory of the Fourier stage for one group of rings.
struct RowScratch {
  RowScratch(int width, const RingFourier& fourier)
      : planes(std::size_t{3} * static_cast<std::size_t>(width) * kComplexFloats), work(fourier.scratch_floats()) {}
  platform::AlignedBuffer<float> planes;
  platform::AlignedBuffer<float> work;
};

/// Scratch memory of the Legendre stage for one order.
struct AnalysisScratch {
  explicit AnalysisScratch(int bands)
      : state(std::size_t{kAnalysisGroups} * 2 * kRingLanes),
        sums(static_cast<std::size_t>(bands + 7) * kHarmonicFloats) {}
  platform::AlignedBuffer<double> state;
  platform::AlignedBuffer<float> sums;
};

class Analysis {
 public:
  /// `reduced`: how the rows are brought to fewer first, if it has rows.
  Analysis(const ImageRows& source, int bands, const ReducedShape& reduced)
      : source_(source),
        bands_(bands),
        reduced_(reduced),
        columns_of_row_(reduced.rows > 0 ? reduced.columns : source.width),
        fourier_kernels_(fourier_kernels()),
        legendre_kernels_(legendre_kernels()),
        fourier_(RingFourier::get(columns_of_row_)),
        factors_(LegendreFactors::get(bands)),
        rings_(LegendreRings::get({reduced.rows > 0 ? reduced.rows : source.height, bands, RingSet::edges})),
        groups_(rings_->groups()),
        zeros_(std::size_t{3} * static_cast<std::size_t>(source.width), 0.0F),
        columns_(static_cast<std::size_t>(bands) * static_cast<std::size_t>(groups_) * kColumnFloats),
        spectrum_(bands) {}

  [[nodiscard]] Spectrum run(const Control& control);

 private:
  [[nodiscard]] jobs::Placement placement() const noexcept {
    const std::int64_t texels = std::int64_t{source_.width} * source_.height;
    return jobs::placement_for(texels + std::int64_t{bands_} * bands_ * groups_);
  }
  [[nodiscard]] const float* row(int index) const noexcept { return source_.row(index); }
  [[nodiscard]] float* column(int m, int group) noexcept {
    return columns_.data() +
           (static_cast<std::size_t>(m) * static_cast<std::size_t>(groups_) + static_cast<std::size_t>(group)) *
               kColumnFloats;
  }
  [[nodiscard]] RowQuads rows_of(int group) const noexcept;
  void transform_rows(const RowQuads& rows, int group, RowScratch& scratch) noexcept;
  void transform_all_rows(const Control& control);
  void sum_order(int m, AnalysisScratch& scratch) noexcept;

  const ImageRows& source_;
  int bands_;
  ReducedShape reduced_;
  int columns_of_row_;  ///< that is transformed
  const FourierKernels& fourier_kernels_;
  const LegendreKernels& legendre_kernels_;
  std::shared_ptr<const RingFourier> fourier_;
  std::shared_ptr<const LegendreFactors> factors_;
  std::shared_ptr<const LegendreRings> rings_;
  int groups_;
  std::vector<float> zeros_;                ///< a black row
  platform::AlignedBuffer<float> columns_;  ///< [m][group][kColumnFloats]
  Spectrum spectrum_;
};

/// Lane q: the steps across edge q + 1 from either pole. The last lane: the rows next to the equator, whose step is the
/// even part there (none in an odd number of rows) and whose sum starts the integrals.
RowQuads Analysis::rows_of(int group) const noexcept {
  const int height = source_.height;
  const int pairs = LegendreRings::pairs_of(height, RingSet::edges);
  RowQuads rows{};
  for (int lane = 0; lane < kRingLanes; ++lane) {
    const int edge = group * kRingLanes + lane + 1;
    if (edge < pairs) {
      rows.a[lane] = row(edge);
      rows.b[lane] = row(edge - 1);
      rows.c[lane] = row(height - edge);
      rows.d[lane] = row(height - 1 - edge);
    } else {
      const bool equator = edge == pairs;
      // (a - b) + (c - d) = row(height / 2) - row((height - 1) / 2), the step, and (a - b) - (c - d) is the sum of the
      // two rows. An odd height has one middle row: no step, and twice the row.
      rows.a[lane] = equator ? row(height / 2) : zeros_.data();
      rows.b[lane] = rows.c[lane] = zeros_.data();
      rows.d[lane] = equator ? row((height + 1) / 2 - 1) : zeros_.data();
    }
  }
  return rows;
}

void Analysis::transform_rows(const RowQuads& rows, int group, RowScratch& scratch) noexcept {
  const platform::FlushDenormalsScope flush;
  const int width = columns_of_row_;
  fourier_kernels_.load_row_quads(rows, width, scratch.planes.data());
  for (int channel = 0; channel < 3; ++channel) {
    float* const plane = scratch.planes.data() + std::ptrdiff_t{kComplexFloats} * channel * width;
    const float* const z = fourier_->transform(fourier_kernels_, plane, scratch.work.data());
    fourier_kernels_.part_orders(z, width, rings_->orders(group), channel, column(0, group),
                                 std::ptrdiff_t{kColumnFloats} * groups_);
  }
}

/// The integral of order m over a column, over the value at its middle.
double column_extent(std::int64_t width, int m) noexcept {
  // (e^(i m d / 2) - e^(-i m d / 2)) / (i m) = 2 sin(m d / 2) / m with d = 2 pi / width: m / (2 width) of a turn, which
  // repeats in m after 2 width.
  if (m == 0) return 2.0 * kPi / static_cast<double>(width);
  return 2.0 * math::sine_cosine_of_turns(static_cast<double>(m % (2 * width)) / static_cast<double>(2 * width)).sine /
         m;
}

void Analysis::sum_order(int m, AnalysisScratch& scratch) noexcept {
  const platform::FlushDenormalsScope flush;
  const int first = rings_->first_group(m);
  std::fill_n(scratch.sums.data(), (bands_ - m + 7) * kHarmonicFloats, 0.0F);
  for (int group = first; group < groups_; group += kAnalysisGroups) {
    const int count = std::min(kAnalysisGroups, groups_ - group);
    legendre_kernels_.analyse_order(rings_->run(m, group, count, *factors_), column(m, group), scratch.state.data(),
                                    scratch.sums.data());
  }
  // A pixel's longitude is pi - 2 pi (i + 1/2) / width, and its extent turns the value at the centre into an integral;
  // the column numbers are doubled.
  const std::int64_t columns = columns_of_row_;
  // c(m) = Int f e^(-i m lon): with lon = pi - 2 pi (i + 1/2) / n and real f it is e^(-i m pi (1 - 1 / n)) conj F(m), F
  // the transform with e^(-2 pi i m k / n). As e^(-i m pi) = e^(i m pi), the phase is m (n + 1) / (2 n) of a turn. It
  // multiplies conj J, and all orders beyond n / 2 are meant as well: m is reduced in whole numbers.
  const math::SineCosine phase = math::sine_cosine_of_turns(static_cast<double>(m * (columns + 1) % (2 * columns)) /
                                                            static_cast<double>(2 * columns));
  const double extent = column_extent(source_.width, m) /
                        (reduced_.rows > 0 ? column_response(source_.width, reduced_.halvings, m) : 1.0);
  IntegralRun run{.alpha = factors_->alpha(m),
                  .beta = factors_->beta(m),
                  .first = {},
                  .phase_real = 0.5 * extent * phase.cosine,
                  .phase_imaginary = 0.5 * extent * phase.sine,
                  .count = bands_ - m};
  if (first < groups_) {
    legendre_kernels_.weigh_odd_parts(column(m, first), rings_->row_weights(m) + std::ptrdiff_t{kRingLanes} * first,
                                      groups_ - first, run.first);
  }
  legendre_kernels_.integrate_sums(run, scratch.sums.data(), spectrum_.order(m));
}

void Analysis::transform_all_rows(const Control& control) {
  std::optional<ReducedRows> reduced;
  if (reduced_.rows > 0) reduced.emplace(source_, reduced_).fill(jobs::part_of(control, 0.0, 0.6));
  const jobs::Placement placement = this->placement();
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<RowScratch> scratches;
  for (std::size_t k = 0; k < workers; ++k) scratches.emplace_back(columns_of_row_, *fourier_);
  jobs::run_tiles(static_cast<std::size_t>(groups_), placement, workers,
                  jobs::part_of(control, reduced ? 0.6 : 0.0, 1.0), [&](std::size_t tile, std::size_t worker) {
                    const int group = static_cast<int>(tile);
                    transform_rows(reduced ? reduced->quads(group) : rows_of(group), group, scratches[worker]);
                  });
}

Spectrum Analysis::run(const Control& control) {
  transform_all_rows(jobs::part_of(control, 0.0, 0.4));
  const jobs::Placement placement = this->placement();
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<AnalysisScratch> scratches;
  for (std::size_t k = 0; k < workers; ++k) scratches.emplace_back(bands_);
  // Order m has bands - m degrees: m and bands - 1 - m together have bands + 1, the same work for every tile.
  run_orders(bands_, placement, workers, jobs::part_of(control, 0.4, 1.0),
             [&](int m, std::size_t worker) { sum_order(m, scratches[worker]); });
  return std::move(spectrum_);
}

// Dark images and spectra: see dark_scale.h. Of others the first texel is looked at, or few.

DarkScale dark_scale_of(const ImageRows& image) noexcept {
  Brightness brightness;
  for (int row = 0; row < image.height && !brightness.is_enough(); ++row) {
    brightness.look_at(image.row(row), image.width, 3);
  }
  return brightness.scale();
}

/// A coefficient counts as a texel does: the zonal factors are at most about 1, and one harmonic is all of an image.
DarkScale dark_scale_of(const Spectrum& spectrum) noexcept {
  Brightness brightness;
  for (int m = 0; m < spectrum.bands() && !brightness.is_enough(); ++m) {
    for (int i = 0; i < spectrum.bands() - m; ++i) {
      const float* const at = spectrum.order(m) + std::ptrdiff_t{kHarmonicFloats} * i;
      const float magnitudes[3] = {std::max(std::abs(at[0]), std::abs(at[1])),
                                   std::max(std::abs(at[2]), std::abs(at[3])),
                                   std::max(std::abs(at[4]), std::abs(at[5]))};
      brightness.look_at(magnitudes, 1, 3);
    }
  }
  return brightness.scale();
}

/// Packed.
std::vector<float> multiplied(const ImageRows& image, const DarkScale& scale) {
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(image.width);
  std::vector<float> pixels(row_floats * static_cast<std::size_t>(image.height));
  for (int row = 0; row < image.height; ++row) {
    multiply_channels(image.row(row), image.width, 3, scale,
                      pixels.data() + row_floats * static_cast<std::size_t>(row));
  }
  return pixels;
}

/// The real parts by the scale, and the imaginary ones.
void multiply_harmonics(const float* from, int count, const DarkScale& scale, float* to) noexcept {
  for (int i = 0; i < kHarmonicFloats * count; i += kHarmonicFloats) {
    for (int k = 0; k < 6; ++k) {
      const double factor = scale.factor[static_cast<std::size_t>(k / 2)];
      to[i + k] = static_cast<float>(static_cast<double>(from[i + k]) * factor);
    }
  }
}

Spectrum multiplied(const Spectrum& spectrum, const DarkScale& scale) {
  Spectrum result(spectrum.bands());
  for (int m = 0; m < spectrum.bands(); ++m) {
    multiply_harmonics(spectrum.order(m), spectrum.bands() - m, scale, result.order(m));
  }
  return result;
}

}  // namespace

Spectrum analyse(const LatLongView& source, int bands, const Control& control, SourceRows rows) {
  image::check_view(source);
  if (source.format != PixelFormat::rgb32f)
    throw Error(ErrorCode::invalid_argument, "the transform reads rgb32f pixels only; decode them first");
  return analyse(ImageRows(source), bands, control, rows);
}

Spectrum analyse(const ImageRows& source, int bands, const Control& control, SourceRows rows) {
  image::require_range("bands", bands, 1, kMaximumSpectrumBands);
  jobs::throw_if_cancelled(control);
  const ReducedShape shape =
      rows == SourceRows::all ? ReducedShape{} : reduced_shape(source.width, source.height, bands);
  const DarkScale scale = dark_scale_of(source);
  if (scale.is_one()) return Analysis(source, bands, shape).run(control);
  const std::vector<float> brighter = multiplied(source, scale);
  const ImageRows rows_of_brighter(LatLongView{brighter.data(), source.width, source.height});
  return multiplied(Analysis(rows_of_brighter, bands, shape).run(control), scale.inverse());
}

namespace {

// From harmonics to rings.

/// Scratch memory of the Legendre stage for one order.
struct SynthesisScratch {
  SynthesisScratch(int bands, int groups)
      : coefficients(static_cast<std::size_t>(bands + 3) * kHarmonicFloats), rows(spline_scratch_floats(groups)) {}
  platform::AlignedBuffer<float> coefficients;
  platform::AlignedBuffer<float> rows;
};

/// Scratch memory of the Fourier stage for one group of rings.
struct RingScratch {
  RingScratch(int columns, const RingFourier& fourier)
      : planes(std::size_t{3} * plane_floats(columns)), work(std::size_t{3} * fourier.scratch_floats()) {}
  static std::size_t plane_floats(int columns) { return static_cast<std::size_t>(columns) * kComplexFloats; }
  platform::AlignedBuffer<float> planes;
  platform::AlignedBuffer<float> work;
};

class Synthesis {
 public:
  Synthesis(const Spectrum& spectrum, std::span<const double> zonal, image::SphereGrid& grid)
      : spectrum_(spectrum),
        zonal_(zonal),
        bands_(static_cast<int>(zonal.size())),
        grid_(grid),
        spline_(grid.content() == image::GridContent::spline_coefficients),
        fourier_kernels_(fourier_kernels()),
        legendre_kernels_(legendre_kernels()),
        fourier_(RingFourier::get(grid.columns())),
        factors_(LegendreFactors::get(bands_)),
        rings_(LegendreRings::get({grid.rings(), bands_, RingSet::centres})),
        functions_(spline_ && SplineFunctions::serve(grid.rings(), bands_) ? SplineFunctions::get(grid.rings(), bands_)
                                                                           : nullptr),
        groups_(rings_->groups()),
        columns_(static_cast<std::size_t>(bands_) * static_cast<std::size_t>(groups_) * kColumnFloats) {}

  void run(const Control& control);

 private:
  [[nodiscard]] float* column(int m, int group) noexcept {
    return columns_.data() +
           (static_cast<std::size_t>(m) * static_cast<std::size_t>(groups_) + static_cast<std::size_t>(group)) *
               kColumnFloats;
  }
  void sum_order(int m, SynthesisScratch& scratch) noexcept;
  void write_rings(int group, RingScratch& scratch) noexcept;

  const Spectrum& spectrum_;
  std::span<const double> zonal_;
  int bands_;
  image::SphereGrid& grid_;
  bool spline_;
  const FourierKernels& fourier_kernels_;
  const LegendreKernels& legendre_kernels_;
  std::shared_ptr<const RingFourier> fourier_;
  std::shared_ptr<const LegendreFactors> factors_;
  std::shared_ptr<const LegendreRings> rings_;
  std::shared_ptr<const SplineFunctions> functions_;  ///< null: they are too many
  int groups_;
  platform::AlignedBuffer<float> columns_;  ///< [m][group][kColumnFloats]
};

void Synthesis::sum_order(int m, SynthesisScratch& scratch) noexcept {
  const platform::FlushDenormalsScope flush;
  // A texel's longitude is pi - 2 pi (i + 1/2) / columns.
  // f(lon_i) = sum of c(m) e^(i m lon_i) with e^(i m lon_i) = e^(i m pi (1 - 1 / n)) e^(-2 pi i m i / n): the forward
  // transform again, after a phase of m (n - 1) / (2 n) turns.
  const std::int64_t width = grid_.columns();
  const math::SineCosine phase =
      math::sine_cosine_of_turns(static_cast<double>(m * (width - 1) % (2 * width)) / static_cast<double>(2 * width));
  double scale = 1.0;
  if (spline_) {
    // Along a ring order m is an eigenvector of the B-spline's samples (c[-1] + 4 c[0] + c[1]) / 6 with the eigenvalue
    // (4 + 2 cos(2 pi m / n)) / 6 = (2 + wave) / 3: dividing by it is the spline's prefilter, at the cost of a number
    // per order. Down the meridians `spline_rings` does it, which leaves out kSplineGain.
    const double wave = math::sine_cosine_of_turns(static_cast<double>(m) / static_cast<double>(width)).cosine;
    scale = kSplineGain * 3.0 / (2.0 + wave);
  }
  const int count = bands_ - m;
  legendre_kernels_.scale_harmonics({.scale = zonal_.data() + m,
                                     .gamma = factors_->gamma(m),
                                     .phase_real = scale * phase.cosine,
                                     .phase_imaginary = scale * phase.sine,
                                     .count = count},
                                    spectrum_.order(m), scratch.coefficients.data());
  float* const end = scratch.coefficients.data() + std::ptrdiff_t{kHarmonicFloats} * count;
  std::fill_n(end, (4 * fours_of(count) - count) * kHarmonicFloats, 0.0F);
  for (int group = 0; functions_ && group < groups_; ++group) {
    legendre_kernels_.sum_functions(functions_->of(m, group), scratch.coefficients.data(), functions_->degrees(m),
                                    column(m, group));
  }
  if (functions_) return;
  legendre_kernels_.synthesise_order(rings_->run(m, 0, groups_, *factors_), scratch.coefficients.data(), column(m, 0));
  if (spline_) legendre_kernels_.spline_rings({groups_, grid_.rings(), m % 2 != 0}, column(m, 0), scratch.rows.data());
}

void Synthesis::write_rings(int group, RingScratch& scratch) noexcept {
  const platform::FlushDenormalsScope flush;
  const int width = grid_.columns();
  // Spline coefficients reach a little beyond where the functions vanish.
  const int orders = rings_->orders(spline_ ? std::min(group + 1, groups_ - 1) : group);
  const float* planes[3] = {};
  for (int channel = 0; channel < 3; ++channel) {
    float* const plane = scratch.planes.data() + static_cast<std::size_t>(channel) * RingScratch::plane_floats(width);
    float* const work = scratch.work.data() + static_cast<std::size_t>(channel) * fourier_->scratch_floats();
    fourier_kernels_.join_orders(column(0, group), std::ptrdiff_t{kColumnFloats} * groups_, orders, channel, width,
                                 plane);
    planes[channel] = fourier_->transform(fourier_kernels_, plane, work);
  }
  RingRows rows{};
  const int first = group * kRingLanes;
  const int last = std::min(first + kRingLanes, (grid_.rings() + 1) / 2);
  for (int ring = first; ring < last; ++ring) {
    rows.north[ring - first] = grid_.texel(0, ring);
    rows.south[ring - first] = grid_.texel(0, grid_.rings() - 1 - ring);
  }
  fourier_kernels_.store_rings(planes[0], planes[1], planes[2], width, rows);
  grid_.fill_sides(first, last - first);
  grid_.fill_sides(grid_.rings() - last, last - first);
}

void Synthesis::run(const Control& control) {
  const std::int64_t texels = std::int64_t{grid_.columns()} * grid_.rings();
  const jobs::Placement placement = jobs::placement_for(texels + std::int64_t{bands_} * bands_ * groups_);
  const std::size_t workers = jobs::worker_count(placement);
  {
    std::vector<SynthesisScratch> scratches;
    for (std::size_t k = 0; k < workers; ++k) scratches.emplace_back(bands_, groups_);
    run_orders(bands_, placement, workers, jobs::part_of(control, 0.0, 0.6),
               [&](int m, std::size_t worker) { sum_order(m, scratches[worker]); });
  }
  std::vector<RingScratch> scratches;
  for (std::size_t k = 0; k < workers; ++k) scratches.emplace_back(grid_.columns(), *fourier_);
  jobs::run_tiles(
      static_cast<std::size_t>(groups_), placement, workers, jobs::part_of(control, 0.6, 1.0),
      [&](std::size_t group, std::size_t worker) { write_rings(static_cast<int>(group), scratches[worker]); });
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
  jobs::throw_if_cancelled(control);
  const DarkScale scale = dark_scale_of(spectrum);
  if (scale.is_one()) {
    Synthesis(spectrum, zonal, grid).run(control);
    return;
  }
  Synthesis(multiplied(spectrum, scale), zonal, grid).run(control);
  constexpr int border = image::SphereGrid::kBorder;
  for (int ring = -border; ring < grid.rings() + border; ++ring) {
    float* const texels = grid.texel(-border, ring);
    multiply_channels(texels, grid.columns() + 2 * border, 4, scale.inverse(), texels);
  }
}

GridSize grid_for_bands(int bands, double oversampling) noexcept {
  constexpr double least_rings = 8.0;
  constexpr double most_rings = 32768.0;
  // 1e-9: a product such as 48 x 4/3 may come out a rounding above a whole number, and must not give one ring more.
  const double rings = std::clamp(std::ceil(bands * oversampling - 1e-9), least_rings, most_rings);
  const int columns = fast_even_length(2 * static_cast<int>(rings));
  return {columns / 2, columns};
}

}  // namespace welkin::transforms
