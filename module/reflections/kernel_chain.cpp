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
#include "reflections/band_choice.h"
#include "reflections/bright_lights.h"
#include "reflections/cube_rings.h"
#include "reflections/direct.h"
#include "reflections/kernel_reference.h"
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
constexpr int kLeastBands = 64;
constexpr int kFirstLook = 256;
constexpr int kMostBands = transforms::kMaximumSpectrumBands;
constexpr int kBandStep = 8;
constexpr double kOfBound = 0.8;       ///< what bands may lose of `rms_error`: lights err beside them
constexpr double kOversampling = 2.0;  ///< of the synthesis' rings: a kink's last bands are not as small as GGX's
constexpr double kReferenceError = 1e-5;

/// At most: from there on every texel above 25 times the mean is a light, however wide the kernel.
constexpr double kLightAlpha = 0.1;

struct KernelMip {
  int size = 0;
  double roughness = 0.0;
  const ZonalShape* kernel = nullptr;
  std::vector<double> spectrum;  ///< of half as many bands again as the transform
  std::vector<double> zonal;     ///< what the synthesis multiplies bands by
};

struct KernelPlan {
  std::vector<KernelMip> mips;
  bool reference = false;
  double rms_error = 0.0;
  int bands = 0;              ///< of the first transform
  double light_alpha = 1.0;   ///< of the GGX lobe that a light of the sharpest kernel is as bright through
  double narrow_alpha = 1.0;  ///< of the one that is as narrow as the finest detail of a kernel
  double least_scale = kPi;   ///< radians
};

/// Returns the kernel's spectrum over `bands` bands, tapered unless it ends by itself.
std::vector<double> zonal_of(const KernelMip& mip, int bands) {
  std::vector<double> zonal(mip.spectrum.begin(), mip.spectrum.begin() + bands);
  if (mip.kernel->last_band() > 0) return zonal;
  for (int l = 0; l < bands; ++l) zonal[static_cast<std::size_t>(l)] *= taper(l, bands);
  return zonal;
}

int next_step(int bands) { return bands + std::max(kBandStep, bands / 16 / kBandStep * kBandStep); }

/// Returns the bands of the first transform: as many as a kernel takes for a picture with many edges, whose energy of
/// degree l is kEdges / l^2 of the whole.
int first_bands(const ZonalShape& kernel, double rms_error) {
  constexpr double kEdges = 6.0;
  constexpr double kShare = 0.4;
  if (kernel.last_band() > 0) return kernel.last_band();
  int looked_at = kFirstLook;
  for (;; looked_at = std::min(kMostBands, 2 * looked_at)) {
    const std::vector<double> spectrum = kernel.spectrum(looked_at);
    double lost = 0.0;
    int bands = looked_at;
    while (bands > kLeastBands) {
      const double ratio = spectrum[static_cast<std::size_t>(bands - 1)] / bands;
      lost += kEdges * ratio * ratio;
      if (lost > kShare * kOfBound * rms_error * rms_error) break;
      --bands;
    }
    // what lies beyond is as much as what lies in the last third
    if (bands < looked_at * 2 / 3 || looked_at == kMostBands)
      return std::min(kMostBands, (bands + kBandStep - 1) / kBandStep * kBandStep);
  }
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
  plan.rms_error = options.rms_error;
  for (std::size_t level = 0; level < options.kernels.size(); ++level) {
    const ZonalKernel& kernel = options.kernels[level];
    KernelMip mip{std::max(1, options.size >> level), kernel.roughness(), &kernel.shape(), {}, {}};
    if (!plan.reference) plan.bands = std::max(plan.bands, first_bands(kernel.shape(), options.rms_error));
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
int rows_for(int bands, int face_size) {
  PrefilterPlan of_lobe;
  of_lobe.least_alpha = std::clamp(reach_within({}) / (2.0 * bands), 1e-6, 1.0);
  return of_lobe.rows_for_cubemap(face_size);
}

/// One call's work on sanitized pixels.
class KernelChain {
 public:
  KernelChain(const projection::SanitizedSource& source, const KernelPlan& plan, memory_resource* memory)
      : source_(source), plan_(plan), mips_(plan.mips) {
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
    transforms::Spectrum spectrum;
    std::vector<double> energies;
    SpectralSource read;
    std::size_t working = 0;
    for (int bands = plan_.bands;; bands = std::min(kMostBands, bands + bands / 2)) {
      const int rows = source_.cubemap() ? rows_for(bands, source_.columns()) : 0;
      const Rings rings = rings_of(source_, texels, rows, quiet);
      spectrum =
          transforms::analyse(rings.view, bands, bands == plan_.bands ? jobs::part_of(control, 0.0, 0.4) : quiet);
      energies = energies_of(spectrum);
      read = {energies, source_.cubemap() ? source_.columns() : 0, rings.view.height};
      working = lights.bytes() + rings.bytes() + spectrum.bytes() +
                (source_.cubemap() ? cube_rings_bytes(source_.columns(), rows) : 0);
      if (choose_bands(bands, read)) break;
    }
    result_.peak_bytes += working;
    jobs::TaskGraph graph;
    for (std::size_t level = 0; level < plan_.mips.size(); ++level) {
      const KernelMip& mip = mips_[level];
      const auto bands = static_cast<int>(mip.zonal.size());
      const transforms::GridSize size = transforms::grid_for_bands(bands, kOversampling);
      result_.peak_bytes +=
          image::SphereGrid(size.rings, size.columns, image::GridContent::spline_coefficients).bytes();
      graph.add(static_cast<double>(mip.size) * mip.size * (1.0 + static_cast<double>(texels.size())) + bands * bands,
                [&, level, size](const Control& part) {
                  const auto start = std::chrono::steady_clock::now();
                  const std::array<float*, 6> faces = image::faces_of(result_.cubemap, static_cast<int>(level));
                  const KernelMip& own = mips_[level];
                  blur(own, spectrum, size, faces, part);
                  lights.add({1.0, 0.0, own.kernel}, own.size, faces, jobs::part_of(part, 0.6, 1.0));
                  note(level, static_cast<int>(texels.size()));
                  const double rms = rms_of_level(result_.cubemap, static_cast<int>(level));
                  result_.mips[level].error_estimate = spectral_rms_error(
                      KernelFactors{own.spectrum, own.zonal, size.rings}, read, lights.error(*own.kernel, rms), rms);
                  end_mip(level, start);
                });
    }
    graph.run(jobs::part_of(control, 0.4, 1.0));
  }

  /// Returns what the kernel makes of light beyond its known spectrum, as dense by degrees as in the last quarter.
  static double beyond(const KernelMip& mip, const SpectralSource& read) {
    if (mip.kernel->last_band() > 0) return 0.0;
    double left = 4.0 * kPi * mip.kernel->square();
    for (std::size_t l = 0; l < mip.spectrum.size(); ++l)
      left -= (2.0 * static_cast<double>(l) + 1.0) * mip.spectrum[l] * mip.spectrum[l];
    const std::size_t quarter = std::max<std::size_t>(1, read.energies.size() / 4);
    double tail = 0.0;
    for (const double energy : read.energies.last(quarter)) tail += energy / static_cast<double>(quarter);
    return std::sqrt(std::max(0.0, left) * tail / (2.0 * static_cast<double>(mip.spectrum.size()) + 1.0) / (4.0 * kPi));
  }

  /// Chooses each mip's bands, of at most `bands`, by the picture's energies. Returns false if more are needed. Throws
  /// `Error` (limit_exceeded) if there are no more.
  bool choose_bands(int bands, const SpectralSource& read) {
    for (std::size_t level = 0; level < mips_.size(); ++level) {
      KernelMip& mip = mips_[level];
      const int last = mip.kernel->last_band();
      mip.spectrum = mip.kernel->spectrum(last > 0 ? last : std::min(kMostBands, bands + bands / 2));
      double error = 0.0;
      int own = last > 0 ? last : std::min(kLeastBands, bands);
      for (;; own = std::min(bands, next_step(own))) {
        mip.zonal = zonal_of(mip, own);
        // what is dark beside lights is to be right too
        const double rest = blurred_rms(read.energies, mip.zonal);
        const int rings = transforms::grid_for_bands(own, kOversampling).rings;
        error = spectral_rms_error(KernelFactors{mip.spectrum, mip.zonal, rings}, read, beyond(mip, read), rest);
        if (error <= kOfBound * plan_.rms_error || own >= bands) break;
      }
      if (last > 0 || error <= kOfBound * plan_.rms_error) continue;
      if (bands < kMostBands) return false;
      if (error <= plan_.rms_error) continue;
      throw Error(ErrorCode::limit_exceeded,
                  "the kernel of mip " + std::to_string(level) + " is too narrow or has too sharp an edge: with " +
                      std::to_string(kMostBands) + " harmonic bands the mip errs by an estimated " +
                      platform::number_text(error) + ", and rms_error is " + platform::number_text(plan_.rms_error) +
                      "; widen the kernel, raise rms_error, or take the reference method");
    }
    return true;
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
    record.bands = static_cast<int>(mips_[level].zonal.size());
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
    for (const glm::dvec3& value : integrate_kernel(source_, *mip.kernel, directions, control)) {
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
  std::vector<KernelMip> mips_;  ///< with the bands that this picture takes
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
  return integrate_kernel(source, kernel.shape(), unit_directions(directions), control);
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
