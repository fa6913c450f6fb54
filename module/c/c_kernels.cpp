// Chains by other lobes than GGX, and tables for path tracers.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "c/c_support.h"
#include "c/c_worker.h"
#include "transform/spectrum.h"
#include "welkin/importance.h"
#include "welkin/welkin.h"
#include "welkin/zonal_kernel.h"

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

namespace {

enum class Lobe { charlie, lambert, phong, blinn, spectrum };

constexpr int kMostMips = 16;

welkin::ZonalKernel kernel_of(Lobe lobe, const welkin_kernel_options& options, std::size_t mip) {
  switch (lobe) {
    case Lobe::charlie: return welkin::ZonalKernel::charlie(options.numbers[mip]);
    case Lobe::phong: return welkin::ZonalKernel::phong(options.numbers[mip]);
    case Lobe::blinn: return welkin::ZonalKernel::blinn(options.numbers[mip]);
    case Lobe::spectrum: {
      const auto bands = static_cast<std::size_t>(options.bands);
      const double* const first = options.numbers + mip * bands;
      return welkin::ZonalKernel::from_spectrum({first, first + bands});
    }
    case Lobe::lambert: break;
  }
  return welkin::ZonalKernel::lambert();
}

welkin::KernelChainOptions kernel_options(const welkin_kernel_options* options) {
  require(options, "options");
  const auto given = read_options(options, "kernel options");
  const auto lobe = enumerator("lobe", given.lobe, Lobe::spectrum);
  if (given.mips < 1 || given.mips > kMostMips)
    refuse("mips is " + std::to_string(given.mips) + "; it must be from 1 to " + std::to_string(kMostMips));
  if (lobe != Lobe::lambert) require(given.numbers, "numbers");
  const int most = welkin::transforms::kMaximumSpectrumBands;
  if (lobe == Lobe::spectrum && (given.bands < 1 || given.bands > most))
    refuse("bands is " + std::to_string(given.bands) + "; it must be from 1 to " + std::to_string(most));
  welkin::KernelChainOptions wanted;
  set_unless_zero(wanted.size, given.size);
  wanted.method = enumerator("method", given.method, welkin::PrefilterMethod::reference);
  set_unless_zero(wanted.rms_error, given.rms_error);
  wanted.pixels = pixel_policy(given.pixels);
  for (std::size_t mip = 0; mip < static_cast<std::size_t>(given.mips); ++mip)
    wanted.kernels.push_back(kernel_of(lobe, given, mip));
  return wanted;
}

template <class View>
welkin_cubemap_chain* chain_by_kernels(const View& view, const welkin_kernel_options* options,
                                       const welkin_control* control) {
  return new welkin_cubemap_chain(std::make_shared<const welkin::PrefilteredSpecular>(
      welkin::prefilter_by_kernels(view, kernel_options(options), control_of(control))));
}

std::span<float> target(float* first, std::size_t count, const char* name) {
  require(first, name);
  return {first, count};
}

}  // namespace

welkin_status welkin_prefilter_cubemap_by_kernels(const welkin_cubemap* cubemap, const welkin_kernel_options* options,
                                                  const welkin_control* control, welkin_cubemap_chain** chain) {
  return guarded([&] {
    hand_out(chain, "chain", [&] { return chain_by_kernels(cubemap_view(cubemap), options, control); });
    return WELKIN_OK;
  });
}

welkin_status welkin_prefilter_lat_long_by_kernels(const welkin_lat_long* lat_long,
                                                   const welkin_kernel_options* options, const welkin_control* control,
                                                   welkin_cubemap_chain** chain) {
  return guarded([&] {
    hand_out(chain, "chain", [&] { return chain_by_kernels(lat_long_view(lat_long), options, control); });
    return WELKIN_OK;
  });
}

welkin_status welkin_charlie_roughness_of_mips(int32_t mips, int32_t size, double* roughness) {
  return guarded([&] {
    require(roughness, "roughness");
    const std::vector<double> table = welkin::charlie_roughness_of_mips(mips, size);
    std::copy(table.begin(), table.end(), roughness);
    return WELKIN_OK;
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
    return WELKIN_OK;
  });
}
