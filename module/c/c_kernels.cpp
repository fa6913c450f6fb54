// The roughness of sheen chains, and tables for path tracers.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "c/c_support.h"
#include "welkin/importance.h"
#include "welkin/reflections.h"
#include "welkin/welkin.h"

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

namespace {

std::span<float> target(float* first, std::size_t count, const char* name) {
  require(first, name);
  return {first, count};
}

}  // namespace

welkin_status welkin_charlie_roughness_of_mips(int32_t mips, int32_t size, double* roughness) {
  return guarded([&] {
    require(roughness, "roughness");
    const std::vector<double> table = welkin::charlie_roughness_of_mips(mips, size);
    std::copy(table.begin(), table.end(), roughness);
  });
}

welkin_status welkin_importance_lat_long(const welkin_lat_long* lat_long, const welkin_importance_options* options,
                                         const welkin_control* control, float* function, float* row_cdf,
                                         float* column_cdf, double* integral) {
  return guarded([&] {
    const welkin::LatLongView view = lat_long_view(lat_long);
    const auto given = read_options(options, "importance options");
    welkin::ImportanceOptions wanted;
    wanted.width = given.width;
    wanted.height = given.height;
    wanted.weight = enumerator("weight", given.weight, welkin::ImportanceWeight::largest);
    wanted.mis_compensation = flag("mis_compensation", given.mis_compensation);
    wanted.pixels = pixel_policy(given.pixels);
    const auto width = static_cast<std::size_t>(std::max(0, given.width > 0 ? given.width : view.width));
    const auto height = static_cast<std::size_t>(std::max(0, given.height > 0 ? given.height : view.height));
    const double sum =
        welkin::importance_table(view,
                                 {target(function, width * height, "function"), target(row_cdf, height + 1, "row_cdf"),
                                  target(column_cdf, height * (width + 1), "column_cdf")},
                                 wanted, control_of(control));
    if (integral != nullptr) *integral = sum;
  });
}
