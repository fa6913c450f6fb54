// The transforms of module/transform beside libsharp (Reinecke and Seljebotn 2013, "Libsharp: spherical harmonic
// transforms revisited"; Debian's libsharp-dev), both ways.
//
//   transforms [BANDS...]
//
// Synthesis: random coefficients to the texels' centres of a grid of BANDS x 2 BANDS. Analysis: random texels of an
// image of that size, taken as areas. libsharp knows points: it is given six Gauss points for each row, and its
// coefficients of order m are multiplied by what a column's width leaves of them, sin(m pi / columns) / (m pi /
// columns). Differences are relative to the root mean square. Times are processor time on one thread, the least of
// three: of three channels in float here, of three calls in double there; libsharp's analysis of points has a ring for
// each row. Prints a table in Markdown.
#include <libsharp/sharp.h>
#include <libsharp/sharp_almhelpers.h>
#include <libsharp/sharp_geomhelpers.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "image/sphere_grid.h"
#include "math/quadrature.h"
#include "transform/spectrum.h"
#include "transform/transform_kernels.h"

namespace {

using namespace welkin;
using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;

double processor_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double least_seconds(const std::function<void()>& run) {
  double least = 1e9;
  for (int i = 0; i < 3; ++i) {
    const double before = processor_seconds();
    run();
    least = std::min(least, processor_seconds() - before);
  }
  return least;
}

/// Coefficients l < bands, 0 <= m <= l, order after order, and libsharp's words for that.
struct Coefficients {
  int bands;
  std::vector<Complex> values;
  sharp_alm_info* info = nullptr;

  explicit Coefficients(int of)
      : bands(of), values(static_cast<std::size_t>(of) * static_cast<std::size_t>(of + 1) / 2) {
    std::vector<std::ptrdiff_t> starts;
    for (int m = 0; m < bands; ++m) starts.push_back(start(m) - m);  // of the hypothetical degree 0
    sharp_make_alm_info(bands - 1, bands - 1, 1, starts.data(), &info);
  }
  Coefficients(const Coefficients&) = delete;
  Coefficients& operator=(const Coefficients&) = delete;
  ~Coefficients() { sharp_destroy_alm_info(info); }

  [[nodiscard]] std::ptrdiff_t start(int m) const {
    return std::ptrdiff_t{m} * bands - std::ptrdiff_t{m} * (m - 1) / 2;
  }
  /// libsharp's harmonics have the Condon-Shortley phase.
  [[nodiscard]] static double phase(int m) { return m % 2 == 0 ? 1.0 : -1.0; }
  [[nodiscard]] Complex& at(int l, int m) { return values[static_cast<std::size_t>(start(m) + l - m)]; }
};

void execute(sharp_jobtype job, Coefficients& coefficients, std::vector<double>& map, const sharp_geom_info* geometry) {
  void* alm = coefficients.values.data();
  void* texels = map.data();
  sharp_execute(job, 0, &alm, &texels, geometry, coefficients.info, SHARP_DP | SHARP_NO_OPENMP, nullptr, nullptr);
}

struct Difference {
  double rms;
  double largest;
};
struct Way {
  Difference difference;
  double ours;
  double theirs;
};

Way synthesis(int bands) {
  const int columns = 2 * bands;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  transforms::Spectrum spectrum(bands);
  Coefficients theirs(bands);
  for (int m = 0; m < bands; ++m)
    for (int l = m; l < bands; ++l) {
      float* const to = spectrum.order(m) + static_cast<std::ptrdiff_t>(transforms::kHarmonicFloats) * (l - m);
      for (int k = 0; k < 6; ++k) to[k] = m == 0 && k % 2 == 1 ? 0.0F : static_cast<float>(normal(random));
      theirs.at(l, m) = Coefficients::phase(m) * Complex(to[0], to[1]);
    }
  const std::vector<double> zonal(static_cast<std::size_t>(bands), 1.0);
  image::SphereGrid grid(bands, columns, image::GridContent::samples);
  Way way{};
  way.ours = least_seconds([&] { run_with_threads(1, [&] { transforms::synthesise(spectrum, zonal, grid, {}); }); });
  sharp_geom_info* geometry = nullptr;
  sharp_make_fejer1_geom_info(bands, columns, kPi / columns - kPi, 1, columns, &geometry);
  std::vector<double> map(static_cast<std::size_t>(bands) * static_cast<std::size_t>(columns));
  way.theirs = 3.0 * least_seconds([&] { execute(SHARP_Y, theirs, map, geometry); });
  sharp_destroy_geom_info(geometry);
  double squares = 0.0;
  double scale = 0.0;
  double largest = 0.0;
  for (int j = 0; j < bands; ++j)
    for (int i = 0; i < columns; ++i) {  // our columns run against the longitude
      const double wanted = map[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) +
                                static_cast<std::size_t>(columns - 1 - i)];
      const double off = static_cast<double>(grid.texel(i, j)[0]) - wanted;
      squares += off * off;
      scale += wanted * wanted;
      largest = std::max(largest, std::abs(off));
    }
  const double rms = std::sqrt(scale / (static_cast<double>(bands) * columns));
  way.difference = {std::sqrt(squares / scale), largest / rms};
  return way;
}

Way analysis(int bands) {
  const int rows = bands;
  const int columns = 2 * bands;
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::vector<float> image(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns) * 3);
  for (float& value : image) value = uniform(random);
  const LatLongView view{image.data(), columns, rows, 0, PixelFormat::rgb32f};
  transforms::Spectrum spectrum;
  Way way{};
  way.ours = least_seconds([&] { run_with_threads(1, [&] { spectrum = transforms::analyse(view, bands, {}); }); });

  constexpr int kPoints = 6;
  const auto rule = math::gauss_legendre(kPoints);
  std::vector<double> colatitudes;
  std::vector<double> weights;
  std::vector<double> map;
  for (int j = 0; j < rows; ++j) {
    const double low = std::cos(kPi * (j + 1) / rows);
    const double high = std::cos(kPi * j / rows);
    for (int k = 0; k < kPoints; ++k) {
      const double node = rule.nodes[static_cast<std::size_t>(k)];
      colatitudes.push_back(std::acos(0.5 * (low + high) - 0.5 * (high - low) * node));
      weights.push_back(0.5 * (high - low) * rule.weights[static_cast<std::size_t>(k)] * 2.0 * kPi / columns);
      for (int i = columns - 1; i >= 0; --i)
        map.push_back(
            image[(static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i)) * 3]);
    }
  }
  const auto rings = colatitudes.size();
  const std::vector<int> lengths(rings, columns);
  const std::vector<int> strides(rings, 1);
  const std::vector<double> first(rings, kPi / columns - kPi);
  std::vector<std::ptrdiff_t> offsets;
  for (std::size_t ring = 0; ring < rings; ++ring) offsets.push_back(static_cast<std::ptrdiff_t>(ring) * columns);
  sharp_geom_info* geometry = nullptr;
  sharp_make_geom_info(static_cast<int>(rings), lengths.data(), offsets.data(), strides.data(), first.data(),
                       colatitudes.data(), weights.data(), &geometry);
  Coefficients theirs(bands);
  execute(SHARP_MAP2ALM, theirs, map, geometry);
  sharp_destroy_geom_info(geometry);
  double squares = 0.0;
  double scale = 0.0;
  double largest = 0.0;
  for (int m = 0; m < bands; ++m) {
    const double half = kPi * m / columns;
    const double left = Coefficients::phase(m) * (m == 0 ? 1.0 : std::sin(half) / half);
    for (int l = std::max(m, 1); l < bands; ++l) {  // without the mean, which is far larger than the others
      const double doubled = m == 0 ? 1.0 : 2.0;
      const Complex wanted = left * theirs.at(l, m);
      const double off = std::abs(spectrum.value(l, m, 0) - wanted);
      squares += doubled * off * off;
      scale += doubled * std::norm(wanted);
      largest = std::max(largest, off);
    }
  }
  way.difference = {std::sqrt(squares / scale), largest / std::sqrt(scale / (static_cast<double>(bands) * bands))};
  // Its time: a ring for each row.
  std::vector<double> points(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), 0.5);
  sharp_make_fejer1_geom_info(rows, columns, kPi / columns - kPi, 1, columns, &geometry);
  way.theirs = 3.0 * least_seconds([&] { execute(SHARP_MAP2ALM, theirs, points, geometry); });
  sharp_destroy_geom_info(geometry);
  return way;
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<int> all;
  for (int i = 1; i < count; ++i) all.push_back(std::atoi(arguments[i]));
  if (all.empty()) all = {64, 128, 256, 512, 1024, 1536};
  std::printf(
      "| bands | way | difference, rms | largest | Welkin, ms | libsharp, ms | ratio "
      "|\n|---|---|---|---|---|---|---|\n");
  bool good = true;
  for (const int bands : all)
    for (const auto& [name, found] :
         {std::pair{"synthesis", synthesis(bands)}, std::pair{"analysis", analysis(bands)}}) {
      std::printf("| %d | %s | %.1e | %.1e | %.2f | %.2f | %.2f |\n", bands, name, found.difference.rms,
                  found.difference.largest, 1e3 * found.ours, 1e3 * found.theirs, found.ours / found.theirs);
      std::fflush(stdout);
      good = good && found.difference.rms < 5e-5;
    }
  return good ? 0 : 1;
}
