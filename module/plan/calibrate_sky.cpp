#include "plan/calibrate_sky.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "plan/calibration_times.h"
#include "sky/table_sizes.h"
#include "welkin/sky_harmonics.h"
#include "welkin/sky_view.h"

namespace welkin::planning {
namespace {

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
    tables = precompute_sky(earth(), small_tables(orders), control);
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

}  // namespace

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

}  // namespace welkin::planning
