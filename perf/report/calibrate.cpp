#include "perf/report/calibrate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "reflections/brdf_table.h"
#include "reflections/prefilter_plan.h"
#include "sky/table_sizes.h"
#include "transform/spectrum.h"
#include "welkin/irradiance.h"
#include "welkin/plan.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::report {
namespace {

/// Nanoseconds: a difference of two times may come out as nothing, and no work costs nothing.
constexpr double kLeast = 1e-3;

constexpr int kRuns = 3;
constexpr double kNanosecond = 1e-9;
constexpr double kMillisecond = 1e6;  ///< in nanoseconds

/// In nanoseconds. Where other programs want the processor wall time is too long; where other threads of this one work,
/// its processor time is: the lesser is nearer to what the work takes.
struct Effort {
  double wall = 0.0;
  double processor = 0.0;
  [[nodiscard]] double least() const { return std::min(wall, processor); }
};

Effort effort_of(const std::function<void()>& work) {
  const std::clock_t processor = std::clock();
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double, std::nano> wall = std::chrono::steady_clock::now() - start;
  const double seconds = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
  return {wall.count(), seconds / kNanosecond};
}

/// Short pieces are repeated until one of them was not disturbed, as a rule.
bool enough(int runs, double nanoseconds) {
  constexpr double kEnough = 30.0 * kMillisecond;
  constexpr int kMostRuns = 50;
  return runs >= kRuns && (nanoseconds >= kEnough || runs >= kMostRuns);
}

/// Passes longer than this lost time to other programs in proportion; shorter ones did or did not.
constexpr double kSlice = 2.0;

void keep_fastest(std::vector<PassRecord>& fastest, const std::vector<PassRecord>& run, const Effort& effort) {
  if (fastest.empty()) fastest = run;
  const double share = effort.least() / effort.wall;
  for (std::size_t pass = 0; pass < fastest.size(); ++pass) {
    const double wall = run[pass].milliseconds;
    const double time = wall < kSlice ? wall : std::max(kSlice, wall * share);
    fastest[pass].milliseconds = std::min(fastest[pass].milliseconds, time);
  }
}

/// Time of the fastest of a few runs, of more if they are short.
double fastest_nanoseconds(const std::function<void()>& work) {
  double least = std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (int runs = 0; !enough(runs, sum); ++runs) {
    const double time = std::max(1.0, effort_of(work).least());
    least = std::min(least, time);
    sum += time;
  }
  return least;
}

/// The same for work that records its passes, which are the same ones in each run: of each pass the fastest.
std::vector<PassRecord> fastest_passes(const std::function<std::vector<PassRecord>()>& work) {
  std::vector<PassRecord> fastest;
  double sum = 0.0;
  for (int runs = 0; !enough(runs, sum); ++runs) {
    std::vector<PassRecord> passes;
    const Effort effort = effort_of([&] { passes = work(); });
    keep_fastest(fastest, passes, effort);
    sum += effort.least();
  }
  return fastest;
}

/// Of all records of that name together.
double nanoseconds_of(const std::vector<PassRecord>& passes, const std::string& name) {
  double sum = 0.0;
  for (const PassRecord& pass : passes) {
    if (pass.name == name) sum += kMillisecond * pass.milliseconds;
  }
  return sum;
}

SkyTableOptions small_tables(int orders) {
  SkyTableOptions options;
  options.heights = 16;
  options.view_zeniths = 32;
  options.sun_zeniths = 16;
  options.sun_angles = 4;
  options.transmittance_heights = 16;
  options.transmittance_zeniths = 64;
  options.orders = orders;
  return options;
}

/// The records have each pass's fastest time.
SkyTables tables_of(int orders, const Control& control) {
  SkyTables tables;
  std::vector<PassRecord> passes = fastest_passes([&] {
    tables = precompute_sky(earth_bruneton(), small_tables(orders), control);
    return tables.passes;
  });
  tables.passes = std::move(passes);
  return tables;
}

void calibrate_tables(const SkyTables& once, const SkyTables& often, CostModel& costs) {
  const SkyTableOptions options = small_tables(1);
  costs.transmittance_texel =
      nanoseconds_of(once.passes, "transmittance") / (static_cast<double>(sky::transmittance_floats(options)) / 3.0);
  const sky::SunPaths::Size paths = sky::sun_path_size(options);
  costs.sun_path_node = nanoseconds_of(once.passes, "sun paths") / (static_cast<double>(paths.heights) * paths.zeniths);
  const sky::SourceShape shape = sky::source_shape(options);
  const double nodes = static_cast<double>(shape.size()) / 4.0 / shape.angles;
  const double first = nanoseconds_of(once.passes, "orders");
  costs.first_order_node = std::max(kLeast, first / nodes);
  costs.order_node = std::max(kLeast, (nanoseconds_of(often.passes, "orders") - first) / (nodes * (often.orders - 1)));
  const auto texels = static_cast<double>(sky::scattering_texels(options));
  const double scattered = nanoseconds_of(once.passes, "scattering");
  costs.scattered_once = scattered / texels;
  costs.scattered_often = std::max(kLeast, (nanoseconds_of(often.passes, "scattering") - scattered) / texels);
}

/// Fills in what a sky\'s passes cost.
void calibrate_sky(CostModel& costs, const Control& control) {
  const SkyTables once = tables_of(1, control);
  const auto often = std::make_shared<const SkyTables>(tables_of(3, control));
  calibrate_tables(once, *often, costs);
  const double slice = static_cast<double>(sky::scattering_texels(often->options)) / often->options.heights;
  costs.slice_texel = fastest_nanoseconds([&] { const SkyView view(often, 0.0); }) / slice;
  const SkyView view(often, 0.0);
  const glm::dvec3 sun = sun_direction(20.0, 0.0);
  constexpr int kSize = 32;
  costs.sky_direction = fastest_nanoseconds([&] { static_cast<void>(sky_cubemap(view, sun, kSize, {}, control)); }) /
                        (6.0 * kSize * kSize);
  SkyCurveOptions curve;
  curve.nodes = 32;
  const double directions = 2.0 * curve.projection.zeniths * curve.projection.azimuths;
  costs.projected_direction =
      fastest_nanoseconds([&] { const SkyCurve baked(view, curve, control); }) / (curve.nodes * directions);
}

/// As uneven as photographs are.
LatLongImage picture(int width, int height) {
  LatLongImage image{width, height, {}};
  std::uint32_t state = 1;
  for (int texel = 0; texel < width * height; ++texel) {
    state = state * 1664525U + 1013904223U;
    const float grain = static_cast<float>(state >> 8U) / static_cast<float>(1U << 24U);
    const float light = texel < width * height / 2 ? 1.0F : 0.3F;
    for (const float colour : {1.0F, 0.9F, 0.7F}) image.pixels.push_back(colour * (light + 0.1F * grain));
  }
  return image;
}

double cube_texels(int edge) { return 6.0 * edge * edge; }

/// Slope and rest of t = rest + slope x through two points. Larger pieces spill out of the caches and take more than in
/// proportion, which would make the rest negative: a tenth of the smaller piece's time is left to it at least.
struct Line {
  double slope;
  double rest;
};
Line line_through(double x0, double t0, double x1, double t1) {
  constexpr double kLeastRest = 0.1;
  const double rest = std::max(kLeastRest * t0, (x1 * t0 - x0 * t1) / (x1 - x0));
  return {std::max(kLeast, (t1 - rest) / x1), rest};
}

class Calibration {
 public:
  explicit Calibration(const Control& control) : control_(control), image_(picture(512, 256)) {}

  CostModel run() {
    measure_pixels();
    measure_resampling();
    measure_prefilter();
    measure_slow_prefilters();
    measure_diffuse();
    calibrate_sky(costs_, quiet());
    scale_reading();
    return costs_;
  }

 private:
  [[nodiscard]] Control quiet() const { return {control_.stop, {}}; }
  [[nodiscard]] static double texels() { return 512.0 * 256.0; }

  void measure_pixels() {
    const LatLongView view = image_.view();
    costs_.clean_texel =
        fastest_nanoseconds([&] { const projection::SanitizedSource sanitized(view, {}, quiet()); }) / texels();
    const auto projecting = [&](int bands) {
      return fastest_nanoseconds([&] { static_cast<void>(project(view, {.bands = bands}, quiet())); }) / texels();
    };
    const Line line = line_through(6.0, projecting(3), 36.0, projecting(8));
    costs_.project_sum = line.slope;
    costs_.project_texel = line.rest;
  }

  void measure_resampling() {
    const auto filling = [&](int size) {
      return fastest_nanoseconds(
          [&] { static_cast<void>(to_cubemap(image_.view(), size, glm::dmat3(1.0), ResampleFilter::area, quiet())); });
    };
    const Line line = line_through(cube_texels(16), filling(16), cube_texels(128), filling(128));
    costs_.resample_texel = line.slope;
    costs_.resample_source = line.rest / texels();
    constexpr int kCube = 64;
    const CubemapImage cube = to_cubemap(image_.view(), kCube, glm::dmat3(1.0), ResampleFilter::area, quiet());
    const auto filling_from_cube = [&](int size) {
      return fastest_nanoseconds([&] { static_cast<void>(to_cubemap(cube.view(), size, glm::dmat3(1.0), quiet())); });
    };
    const Line of_cube = line_through(cube_texels(24), filling_from_cube(24), cube_texels(128), filling_from_cube(128));
    costs_.resample_cube_texel = of_cube.slope;
    costs_.resample_cube_source = of_cube.rest / cube_texels(kCube);
    constexpr int kSize = 256;
    CubemapChain chain(kSize, full_chain_levels(kSize));
    const auto values = static_cast<std::size_t>(3.0 * cube_texels(kSize));
    std::fill_n(chain.face(0, 0), values, 1.0F);
    costs_.mip_texel =
        fastest_nanoseconds([&] { fill_mips(chain, MipFilter::solid_angle, quiet()); }) / cube_texels(kSize);
    std::vector<float> copy(values);
    costs_.copy_texel =
        fastest_nanoseconds([&] { std::memcpy(copy.data(), chain.face(0, 0), values * sizeof(float)); }) /
        cube_texels(kSize);
  }

  static constexpr const char* kFirstMip = "all of mip 0";

  /// The records have each pass's fastest time, and the first mip's.
  template <class View>
  PrefilteredSpecular prefiltered(const View& view, const PrefilterOptions& options) const {
    PrefilteredSpecular made;
    std::vector<PassRecord> passes = fastest_passes([&] {
      made = prefilter_specular(view, options, quiet());
      std::vector<PassRecord> records = made.pixels.passes;
      records.push_back({kFirstMip, PassAction::run, "", made.mips.front().milliseconds});
      return records;
    });
    made.pixels.passes = std::move(passes);
    return made;
  }

  void measure_prefilter() {
    const double rings = 256.0;
    const auto terms = [&](int bands) { return 0.25 * bands * bands * rings / texels(); };
    const auto analysing = [&](const PrefilteredSpecular& made) {
      return nanoseconds_of(made.pixels.passes, "analyse") / texels();
    };
    const PrefilteredSpecular sharp = prefiltered(image_.view(), {.size = 128, .roughness = {0.12}});
    const PrefilteredSpecular rough = prefiltered(image_.view(), {.size = 128, .roughness = {0.6}});
    const Line line = line_through(terms(rough.mips.front().bands), analysing(rough), terms(sharp.mips.front().bands),
                                   analysing(sharp));
    costs_.legendre_term = line.slope;
    costs_.fourier_texel = line.rest;
    costs_.bright_texel = std::max(kLeast, nanoseconds_of(sharp.pixels.passes, "bright texels") / texels());
    costs_.face_texel = nanoseconds_of(sharp.pixels.passes, "mip 0: faces") / cube_texels(128);
    const CubemapImage cube = to_cubemap(image_.view(), 64, glm::dmat3(1.0), ResampleFilter::area, quiet());
    const PrefilterOptions options{.size = 64, .roughness = {0.2}};
    const double rows = reflections::plan_prefilter(options).rows_for_cubemap();
    const PrefilteredSpecular of_cube = prefiltered(cube.view(), options);
    const double per_texel = nanoseconds_of(of_cube.pixels.passes, "bright texels") / (2.0 * rows * rows);
    costs_.ring_texel = std::max(kLeast, per_texel - costs_.bright_texel);
  }

  void measure_slow_prefilters() {
    const std::vector<glm::dvec3> directions(8, glm::dvec3(0.6, 0.0, 0.8));
    const Line line = line_of_sources(static_cast<double>(directions.size()), [&](const LatLongView& source) {
      static_cast<void>(reference_specular(source, 0.5, directions, quiet()));
    });
    costs_.reference_pair = line.slope;
    costs_.reference_direction = line.rest;
  }

  /// Of work on all pairs of a source's texels and `directions`: time of a direction, over the texels.
  [[nodiscard]] Line line_of_sources(double directions, const std::function<void(const LatLongView&)>& work) const {
    const LatLongImage small = picture(64, 32);
    const double few = fastest_nanoseconds([&] { work(small.view()); }) / directions;
    const double many = fastest_nanoseconds([&] { work(image_.view()); }) / directions;
    return line_through(64.0 * 32.0, few, texels(), many);
  }

  void measure_diffuse() {
    const SphericalHarmonics light = project(image_.view(), {}, quiet()).radiance;
    costs_.irradiance_term = fastest_nanoseconds([&] { static_cast<void>(irradiance_cubemap(light, 64, quiet())); }) /
                             (9.0 * cube_texels(64));
    constexpr int kSize = 2;
    const Line line = line_of_sources(cube_texels(kSize), [&](const LatLongView& source) {
      static_cast<void>(direct_irradiance_cubemap(source, kSize, quiet()));
    });
    costs_.irradiance_pair = line.slope;
    costs_.irradiance_direction = line.rest;
    const auto tabulating = [&](bool sheen) {
      const BrdfTableOptions options{.width = 32, .height = 32, .sheen = sheen};
      return fastest_nanoseconds([&] { static_cast<void>(reflections::integrated_brdf(options, quiet())); }) /
             (32.0 * 32.0);
    };
    costs_.brdf_texel = tabulating(false);
    costs_.sheen_texel = tabulating(true);
  }

  /// Decoders are not measured: as much slower or faster as all else, by the geometric mean.
  void scale_reading() {
    const CostModel stored;
    double logarithms = 0.0;
    int count = 0;
    for (const CostUnit& unit : cost_units()) {
      if (costs_.*unit.value == stored.*unit.value) continue;
      logarithms += std::log(costs_.*unit.value / stored.*unit.value);
      ++count;
    }
    const double ratio = count > 0 ? std::exp(logarithms / count) : 1.0;
    costs_.read_texel *= ratio;
    costs_.read_plain_texel *= ratio;
  }

  const Control& control_;
  LatLongImage image_;
  CostModel costs_;
};

}  // namespace

CostModel calibrate_costs(const Control& control) {
  CostModel costs;
  run_with_threads(1, [&] { costs = Calibration(control).run(); });
  if (control.progress) control.progress(1.0);
  return costs;
}

}  // namespace welkin::report
