// Chains by kernels: a product in harmonics, bright texels beside it.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "image/sphere_grid.h"
#include "jobs/task_graph.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/sanitizer.h"
#include "reflections/bright_lights.h"
#include "reflections/cube_rings.h"
#include "reflections/direct.h"
#include "reflections/lobe.h"
#include "reflections/prefilter.h"
#include "reflections/prefilter_estimate.h"
#include "reflections/radiance_scale.h"
#include "reflections/zonal_shape.h"
#include "transform/spectrum.h"
#include "welkin/zonal_kernel.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kLargestSize = 8192;
constexpr int kLeastBands = 96;
constexpr int kBandStep = 8;
constexpr double kOversampling = 2.0;  ///< of the synthesis' rings: a kink's last bands are not as small as GGX's
constexpr double kReferenceError = 1e-5;

/// What a light alone in the dark may err by, over `rms_error`. Bright lights do not go through the harmonics, and what
/// is left of a picture has most of its light in the lowest degrees.
constexpr double kOfLoneLight = 3.5;

/// At most: from there on every texel above 25 times the mean is a light, however wide the kernel.
constexpr double kLightAlpha = 0.1;

struct KernelMip {
  int size = 0;
  double roughness = 0.0;
  const ZonalShape* kernel = nullptr;
  std::vector<double> spectrum;  ///< of half as many bands again as `zonal`
  std::vector<double> zonal;     ///< tapered
};

struct KernelPlan {
  std::vector<KernelMip> mips;
  bool reference = false;
  int bands = 0;
  double light_alpha = 1.0;   ///< of the GGX lobe that a light of the sharpest kernel is as bright through
  double narrow_alpha = 1.0;  ///< of the one that is as narrow as the finest detail of a kernel
  double least_scale = kPi;   ///< radians
};

/// Of a light alone, when the kernel ends with a taper at so many bands: root mean square over that of the whole.
double lost_by_taper(const ZonalShape& kernel, const std::vector<double>& spectrum, int bands) {
  double kept = 0.0;
  double whole = 0.0;
  for (int l = 0; l < bands; ++l) {
    const double own = (2.0 * l + 1.0) * spectrum[static_cast<std::size_t>(l)] * spectrum[static_cast<std::size_t>(l)];
    const double left = 1.0 - taper(l, bands);
    whole += own;
    kept += own * (1.0 - left * left);
  }
  const double all = std::max(whole, 4.0 * kPi * kernel.square());
  return std::sqrt(std::max(0.0, all - kept) / all);
}

void choose_bands(KernelMip& mip, std::size_t level, double rms_error) {
  const ZonalShape& kernel = *mip.kernel;
  constexpr int most = transforms::kMaximumSpectrumBands;
  if (kernel.last_band() > 0) {  // nothing is left out
    mip.spectrum = mip.zonal = kernel.spectrum(kernel.last_band());
    return;
  }
  mip.spectrum = kernel.spectrum(most);
  int bands = kLeastBands;
  const double bound = kOfLoneLight * rms_error;
  while (bands < most && lost_by_taper(kernel, mip.spectrum, bands) > bound)
    bands += std::max(kBandStep, bands / 16 / kBandStep * kBandStep);
  bands = std::min(bands, most);
  if (const double lost = lost_by_taper(kernel, mip.spectrum, bands); lost > bound) {
    throw Error(ErrorCode::limit_exceeded,
                "the kernel of mip " + std::to_string(level) +
                    " is too narrow or has too sharp an edge: " + std::to_string(most) + " harmonic bands lose " +
                    platform::number_text(lost) + " of a light alone, and " + platform::number_text(bound) +
                    " is the bound; widen it, raise rms_error, or take the reference method");
  }
  for (int l = 0; l < bands; ++l) mip.zonal.push_back(taper(l, bands) * mip.spectrum[static_cast<std::size_t>(l)]);
  mip.spectrum.resize(static_cast<std::size_t>(std::min(most, bands + bands / 2)));
}

KernelPlan plan_kernels(const KernelChainOptions& options) {
  image::require_range("size", options.size, 1, kLargestSize);
  image::require_range("the number of kernels, which is that of mips,",
                       static_cast<int>(std::min<std::size_t>(options.kernels.size(), 99)), 1,
                       full_chain_levels(options.size));
  if (!(options.rms_error >= 1e-6 && options.rms_error <= 1.0)) {
    throw Error(ErrorCode::invalid_argument,
                "rms_error is " + platform::number_text(options.rms_error) + "; it must be from 1e-6 to 1");
  }
  const bool known = options.method == PrefilterMethod::automatic || options.method == PrefilterMethod::spectral ||
                     options.method == PrefilterMethod::reference;
  if (!known)
    throw Error(ErrorCode::invalid_argument, "kernels are prefiltered by the methods automatic, spectral, reference");
  projection::check_policy(options.pixels);
  KernelPlan plan;
  plan.reference = options.method == PrefilterMethod::reference;
  for (std::size_t level = 0; level < options.kernels.size(); ++level) {
    const ZonalKernel& kernel = options.kernels[level];
    KernelMip mip{std::max(1, options.size >> level), kernel.roughness(), &kernel.shape(), {}, {}};
    if (!plan.reference) choose_bands(mip, level, options.rms_error);
    plan.bands = std::max(plan.bands, static_cast<int>(mip.zonal.size()));
    // GGX's peak is 4 / alpha^2 times the mean; two points along an edge do for 0.6 alpha
    const double peak = 4.0 * kPi * kernel.shape().peak();
    plan.light_alpha = std::min(plan.light_alpha, std::min(kLightAlpha, std::sqrt(4.0 / std::max(4.0, peak))));
    plan.least_scale = std::min(plan.least_scale, kernel.shape().scale());
    plan.mips.push_back(std::move(mip));
  }
  plan.narrow_alpha = std::clamp(4.0 / 3.0 * plan.least_scale, 1e-4, 1.0);
  return plan;
}

/// Rows of a lat-long that a cubemap goes through: as for a GGX lobe that needs as many bands.
int rows_for(const KernelPlan& plan) {
  PrefilterPlan of_lobe;
  of_lobe.least_alpha = std::clamp(reach_for(1e-3, 1e-2) / (2.0 * plan.bands), 1e-6, 1.0);
  return of_lobe.rows_for_cubemap();
}

/// One call's work on sanitized pixels.
class KernelChain {
 public:
  KernelChain(const projection::SanitizedSource& source, const KernelPlan& plan, memory_resource* memory)
      : source_(source), plan_(plan) {
    result_.cubemap = image::shaped({}, plan.mips.front().size, static_cast<int>(plan.mips.size()), memory);
    result_.mips.resize(plan.mips.size());
    result_.peak_bytes = source.bytes();
  }

  PrefilteredSpecular run(const Control& control) {
    if (plan_.reference) {
      for (std::size_t level = 0; level < plan_.mips.size(); ++level) {
        const auto count = static_cast<double>(plan_.mips.size());
        const auto number = static_cast<double>(level);
        integrate_mip(level, jobs::part_of(control, number / count, (number + 1.0) / count));
      }
    } else {
      run_spectral(control);
    }
    return std::move(result_);
  }

 private:
  void run_spectral(const Control& control) {
    const Control quiet{control.stop, {}};
    const std::vector<BrightTexel> texels = find_bright_texels(source_, plan_.light_alpha, kMostBrightFar, quiet);
    const BrightLights lights(texels, PictureShape::of(source_), plan_.narrow_alpha, reach_for(1e-3, 1e-2),
                              LightsOf::kernels);
    const int rows = source_.cubemap() ? rows_for(plan_) : 0;
    Rings rings = rings_of(source_, texels, rows, quiet);
    const SpectralSource read{{}, source_.cubemap() ? source_.columns() : 0, rings.view.height};
    const transforms::Spectrum spectrum =
        transforms::analyse(rings.view, plan_.bands, jobs::part_of(control, 0.0, 0.4));
    result_.peak_bytes += lights.bytes() + rings.bytes() + spectrum.bytes() +
                          (source_.cubemap() ? cube_rings_bytes(source_.columns(), rows) : 0);
    rings = {};
    const std::vector<double> energies = energies_of(spectrum);
    jobs::TaskGraph graph;
    for (std::size_t level = 0; level < plan_.mips.size(); ++level) {
      const KernelMip& mip = plan_.mips[level];
      const auto bands = static_cast<int>(mip.zonal.size());
      const transforms::GridSize size = transforms::grid_for_bands(bands, kOversampling);
      result_.peak_bytes +=
          image::SphereGrid(size.rings, size.columns, image::GridContent::spline_coefficients).bytes();
      graph.add(static_cast<double>(mip.size) * mip.size * (1.0 + static_cast<double>(texels.size())) + bands * bands,
                [&, level, size](const Control& part) {
                  const auto start = std::chrono::steady_clock::now();
                  const std::array<float*, 6> faces = image::faces_of(result_.cubemap, static_cast<int>(level));
                  blur(plan_.mips[level], spectrum, size, faces, part);
                  lights.add({1.0, 0.0, plan_.mips[level].kernel}, plan_.mips[level].size, faces,
                             jobs::part_of(part, 0.6, 1.0));
                  note(level, static_cast<int>(texels.size()));
                  const SpectralSource from{energies, read.face_size, read.rings};
                  result_.mips[level].error_estimate = spectral_rms_error(
                      KernelFactors{plan_.mips[level].spectrum, plan_.mips[level].zonal, size.rings}, from,
                      lights.error(*plan_.mips[level].kernel), rms_of_level(result_.cubemap, static_cast<int>(level)));
                  end_mip(level, start);
                });
    }
    graph.run(jobs::part_of(control, 0.4, 1.0));
  }

  void blur(const KernelMip& mip, const transforms::Spectrum& spectrum, const transforms::GridSize& size,
            const std::array<float*, 6>& faces, const Control& control) const {
    image::SphereGrid grid(size.rings, size.columns, image::GridContent::spline_coefficients);
    transforms::synthesise(spectrum, mip.zonal, grid, jobs::part_of(control, 0.0, 0.4));
    const bool keeps_sign = !source_.has_negatives() && !mip.kernel->negative();
    image::sample_faces(grid, mip.size, faces, {.not_negative = keeps_sign}, jobs::part_of(control, 0.4, 0.6));
  }

  void note(std::size_t level, int bright_texels) {
    MipRecord& record = result_.mips[level];
    record.method = MipMethod::spectral;
    record.bands = static_cast<int>(plan_.mips[level].zonal.size());
    record.bright_texels = bright_texels;
  }

  void integrate_mip(std::size_t level, const Control& control) {
    const auto start = std::chrono::steady_clock::now();
    const KernelMip& mip = plan_.mips[level];
    std::vector<glm::dvec3> directions;
    for (int face = 0; face < 6; ++face) {
      for (int row = 0; row < mip.size; ++row) {
        for (int column = 0; column < mip.size; ++column)
          directions.push_back(image::face_direction(mip.size, face, column + 0.5, row + 0.5));
      }
    }
    float* to = result_.cubemap.face(static_cast<int>(level), 0);
    for (const glm::dvec3& value : integrate_shape(source_, *mip.kernel, directions, control)) {
      for (int c = 0; c < 3; ++c) *to++ = static_cast<float>(value[c]);
    }
    result_.mips[level].method = MipMethod::reference;
    result_.mips[level].error_estimate = kReferenceError;
    end_mip(level, start);
  }

  void end_mip(std::size_t level, std::chrono::steady_clock::time_point start) {
    MipRecord& record = result_.mips[level];
    record.size = plan_.mips[level].size;
    record.roughness = plan_.mips[level].roughness;
    record.mean = mean_radiance(project(result_.cubemap.view(static_cast<int>(level)), {.bands = 1}, {}).radiance);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    record.milliseconds = took.count();
  }

  const projection::SanitizedSource& source_;
  const KernelPlan& plan_;
  PrefilteredSpecular result_;
};

template <class View>
PrefilteredSpecular run(const View& view, const KernelChainOptions& options, const Control& control) {
  image::check_view(view);
  const KernelPlan plan = plan_kernels(options);
  const projection::SanitizedSource source(view, options.pixels, jobs::part_of(control, 0.0, 0.05));
  const Control rest = jobs::part_of(control, 0.05, 1.0);
  PrefilteredSpecular result;
  if (const float scale = safe_scale(source); scale != 1.0F) {
    const auto scaled_pixels = scaled(source, view, scale);
    const projection::SanitizedSource scaled_source(scaled_pixels.view(), {}, {control.stop, {}});
    result = KernelChain(scaled_source, plan, rest.memory).run(rest);
    undo_scale(result, scale);
  } else {
    result = KernelChain(source, plan, rest.memory).run(rest);
  }
  describe_pixels(source.diagnostics(), source.clamped_radiance(), result);
  return result;
}

template <class View>
std::vector<glm::dvec3> reference(const View& view, const ZonalKernel& kernel,
                                  const std::vector<glm::dvec3>& directions, const Control& control) {
  image::check_view(view);
  const projection::SanitizedSource source(view, {}, {control.stop, {}});
  return integrate_shape(source, kernel.shape(), unit_directions(directions), control);
}

}  // namespace
}  // namespace welkin::reflections

namespace welkin {

PrefilteredSpecular prefilter_by_kernels(const LatLongView& source, const KernelChainOptions& options,
                                         const Control& control) {
  const platform::FloatingPointScope floating_point;
  return reflections::run(source, options, control);
}

PrefilteredSpecular prefilter_by_kernels(const CubemapView& source, const KernelChainOptions& options,
                                         const Control& control) {
  const platform::FloatingPointScope floating_point;
  return reflections::run(source, options, control);
}

std::vector<dvec3> reference_by_kernel(const LatLongView& source, const ZonalKernel& kernel,
                                       const std::vector<dvec3>& directions, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return reflections::reference(source, kernel, directions, control);
}

std::vector<dvec3> reference_by_kernel(const CubemapView& source, const ZonalKernel& kernel,
                                       const std::vector<dvec3>& directions, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return reflections::reference(source, kernel, directions, control);
}

}  // namespace welkin
