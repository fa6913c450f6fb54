// Decides which passes a bake has: run, reused or left out, why, in what memory, and what waits for what.
#include "bake/bake_plan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include "harmonics/octahedral.h"
#include "image/pixels.h"
#include "image/sphere_grid.h"
#include "jobs/tiles.h"
#include "platform/text.h"
#include "projection/sanitizer.h"
#include "reflections/brdf_table.h"
#include "reflections/bright_lights.h"
#include "reflections/bright_texels.h"
#include "reflections/cube_rings.h"
#include "reflections/prefilter.h"
#include "reflections/prefilter_plan.h"
#include "transform/row_reduction.h"
#include "transform/spectrum.h"
#include "transform/transform_kernels.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {

std::string SourceShape::description() const {
  return cubemap ? "cubemap of " + std::to_string(columns)
                 : "lat-long " + std::to_string(columns) + " x " + std::to_string(rows);
}

SourceShape shape_of(const EnvironmentView& view) {
  image::check_view(view);
  if (view.kind() == EnvironmentKind::lat_long) {
    const LatLongView lat_long = view.lat_long();
    return {false, lat_long.width, lat_long.height, lat_long.format};
  }
  const CubemapView cubemap = view.cubemap();
  return {true, cubemap.size, 6 * cubemap.size, cubemap.format};
}

}  // namespace welkin

namespace welkin::baking {
namespace {

constexpr int kLargestIrradiance = 4096;
constexpr std::uint64_t kTexelBytes = 3 * sizeof(float);
constexpr std::uint64_t kSmallChange = std::uint64_t{2} << 20U;  ///< scratch space of tiles, lists of rows

std::uint64_t squared(int edge) { return static_cast<std::uint64_t>(edge) * static_cast<std::uint64_t>(edge); }

// The cost of work: memory, and nanoseconds on one thread.

/// Returns the bytes of the transform's columns: orders times rings, in groups of lanes.
std::uint64_t columns_bytes(int bands, int rings) {
  const auto groups = static_cast<std::uint64_t>((rings + 1) / 2 + transforms::kRingLanes) / transforms::kRingLanes;
  return static_cast<std::uint64_t>(bands) * groups * transforms::kColumnFloats * sizeof(float);
}

std::uint64_t grid_bytes(int bands, const transforms::GridSize& grid) {
  constexpr int border = 2 * image::SphereGrid::kBorder;
  return columns_bytes(bands, grid.rings) + sizeof(float) * 4 * static_cast<std::uint64_t>(grid.rings + border) *
                                                static_cast<std::uint64_t>(grid.columns + border);
}

reflections::ImageShape image_of(const SourceShape& source) {
  return {source.cubemap, source.columns, source.cubemap ? source.columns : source.rows};
}

/// Returns the bytes of the transform that spectral mips share, and of the bright texels that are summed apart.
std::uint64_t spectral_bytes(const SourceShape& source, const reflections::PrefilterPlan& plan) {
  const int rings = source.cubemap ? plan.rows_for_cubemap() : source.rows;
  const std::uint64_t ring_texels = source.cubemap ? 2 * squared(rings) : source.texels();
  std::uint64_t bytes = kTexelBytes * ring_texels + columns_bytes(plan.bands, rings) +
                        squared(plan.bands) * transforms::kHarmonicFloats * sizeof(float);
  if (source.cubemap)
    bytes += reflections::cube_rings_bytes(source.columns, plan.face_for_cubemap(source.columns), rings);
  bytes += transforms::ReducedRows::most_bytes(source.cubemap ? 2 * rings : source.columns, rings, plan.bands,
                                               jobs::worker_count(jobs::Placement::arena));
  const reflections::BrightSearch search = reflections::search_for_bright_texels(
      source.cubemap, source.columns, source.rows, plan.light_alpha, reflections::kMaxBright);
  if (search.texels == 0) return bytes;
  if (source.cubemap) bytes += kTexelBytes * source.texels();  // a copy without the bright texels
  return std::max<std::uint64_t>(bytes, search.bytes) +
         reflections::BrightLights::most_bytes(search.texels, image_of(source), plan.lights,
                                               jobs::worker_count(jobs::Placement::arena));
}

/// Returns the bytes that one step of the prefilter holds when all mips are being made.
std::uint64_t bytes_of_step(const SourceShape& source, const reflections::PrefilterPlan& plan) {
  std::uint64_t bytes = 0;
  if (plan.bands > 0) bytes += spectral_bytes(source, plan);
  std::uint64_t records = 0;  // of the largest narrow mip: they are made one by one
  for (const reflections::MipPlan& mip : plan.mips) {
    if (mip.near.face == 0) continue;
    const std::uint64_t texels =
        mip.near.cubemap() ? 6 * squared(mip.near.face)
                           : static_cast<std::uint64_t>(mip.near.face) * static_cast<std::uint64_t>(mip.near.rows);
    const std::uint64_t sums = reflections::near_sums_bytes(mip.near) + kTexelBytes * texels;
    const bool narrow = mip.method == MipMethod::near_far;
    bytes += reflections::NearTable::most_bytes(mip.near) + (narrow ? 0 : sums);
    if (narrow) records = std::max(records, sums);
  }
  bytes += records;
  for (const reflections::MipPlan& mip : plan.mips) {
    if (mip.method == MipMethod::copy) bytes += kTexelBytes * 6 * squared(mip.size);
    if (mip.bands.bands() == 0) continue;
    // wide lobes may take more
    const bool is_ggx = plan.lights.of == reflections::LightsOf::ggx;
    const int dark = is_ggx ? std::min(plan.bands, reflections::bands_for_dark(plan.bounds)) : 0;
    const int bands = std::max(mip.bands.bands(), dark);
    bytes += grid_bytes(bands, is_ggx ? transforms::grid_for_bands(bands) : mip.grid());
  }
  if (plan.irradiance) {
    const int dark = reflections::bands_for_dark(plan.irradiance_bounds);
    const int bands = std::min(plan.bands, std::max(plan.irradiance->bands.bands(), dark));
    bytes += kTexelBytes * 6 * squared(plan.irradiance->size) + grid_bytes(bands, transforms::grid_for_bands(bands));
  }
  return bytes;
}

std::uint64_t prefilter_bytes(const SourceShape& source, const reflections::PrefilterPlan& plan) {
  std::uint64_t bytes = 0;
  for (int step = 0; step <= reflections::kMaxTightenings; ++step)
    bytes = std::max(bytes, bytes_of_step(source, plan.at_step(step, image_of(source))));
  return bytes;
}

double cube_texels(int edge) { return 6.0 * edge * edge; }

/// Returns whether a cubemap is reduced by a power of two, as its mips are.
bool halves(int source_size, int size) {
  return source_size % size == 0 && std::has_single_bit(static_cast<unsigned>(source_size / size));
}

/// Returns the cost of resampling: of lookups for the result's texels, and of averages over those of the source.
double resampling(const SourceShape& source, int size) {
  const auto texels = static_cast<double>(source.texels());
  if (source.cubemap && source.columns == size) return 0.25 * texels;
  if (source.cubemap && halves(source.columns, size)) return texels;
  return source.cubemap ? 290.0 * cube_texels(size) + 450.0 * texels : 5.3 * cube_texels(size) + 0.9 * texels;
}

/// Returns the cost of both halves of a transform: rings by Fourier, orders by Legendre.
double transforming(double rings, double columns, int bands) {
  return 1.7 * rings * columns + 0.09 * bands * bands * rings;
}

double prefiltering(const SourceShape& source, const reflections::PrefilterPlan& plan) {
  const double rings = source.cubemap ? plan.rows_for_cubemap() : source.rows;
  const double columns = source.cubemap ? 2.0 * rings : source.columns;
  const auto source_texels = static_cast<double>(source.texels());
  double sum = 3.0 * source_texels + transforming(rings, columns, plan.bands);
  for (const reflections::MipPlan& mip : plan.mips) {
    const double texels = cube_texels(mip.size);
    switch (mip.method) {
      case MipMethod::copy:
      case MipMethod::stored: sum += resampling(source, mip.size); break;
      case MipMethod::near_far: sum += 100.0 * texels; break;
      case MipMethod::reference: sum += 26.0 * texels * source_texels; break;
      case MipMethod::spectral: {
        const transforms::GridSize grid = mip.grid();
        sum += 8.0 * texels + transforming(grid.rings, grid.columns, mip.bands.bands());
        break;
      }
    }
  }
  return sum;
}

/// The cost of a pass.
struct Work {
  double weight = 0.0;  ///< see `BakeStep`
  std::uint64_t result_bytes = 0;
  std::uint64_t working_bytes = 0;  ///< in addition to the result
};

Work prefilter_work(const SourceShape& source, const reflections::PrefilterPlan& plan) {
  const int mips = static_cast<int>(plan.mips.size());
  return {prefiltering(source, plan), kTexelBytes * chain_texels(plan.mips.front().size, mips),
          prefilter_bytes(source, plan)};
}

// Texts of reasons.

constexpr const char* kNotAskedFor = "not requested";

std::string edge(int size) { return std::to_string(size) + " x " + std::to_string(size); }

std::string mips_from(int mips, int size) { return std::to_string(mips) + " mips from " + edge(size); }

std::string prefilter_words(const reflections::PrefilterPlan& plan) {
  const int mips = static_cast<int>(plan.mips.size());
  std::string words = mips_from(mips, plan.mips.front().size);
  if (plan.family != LobeFamily::ggx) words += std::string(" by the lobe ") + welkin::name(plan.family);
  return words;
}

// The passes.

void check(const BakeOptions& options) {
  if (options.background && options.background->size)
    image::require_range("background.size", *options.background->size, 1, image::kLargestFace);
  if (options.irradiance) {
    image::require_range("irradiance.size", options.irradiance->size, 1, kLargestIrradiance);
    reflections::check_irradiance_error(options.irradiance->rms_error);
  }
  image::require_range("bands", options.bands, 0, kMaximumBands);
  if (options.irradiance && options.bands == 0 && options.irradiance->method == IrradianceMethod::harmonics) {
    throw Error(ErrorCode::invalid_argument,
                "an irradiance cubemap by IrradianceMethod::harmonics needs bands, and bands is 0; pass 3, leave "
                "irradiance empty, or choose automatic");
  }
  if (options.brdf) reflections::check_brdf(*options.brdf);
}

/// Builds a plan, with one function per pass.
class BakePlanner {
 public:
  BakePlanner(const SourceShape& source, const BakeOptions& options, const StoredKinds& stored)
      : source_(source), options_(options), stored_(stored) {
    settle_projection();
    settle_sizes();
  }

  BakePlan run() {
    plan_.working_bytes = kSmallChange;
    sanitize();
    specular();
    background();
    background_mips();
    project();
    irradiance();
    brdf();
    octahedral();
    return std::move(plan_);
  }

 private:
  void settle_projection() {
    projected_bands_ = options_.bands > 0 || !options_.total_radiance ? options_.bands : 1;
    plan_.projecting.bands = std::max(1, projected_bands_);
    plan_.projecting.pixels = options_.pixels;
    projection::check_options(plan_.projecting);
    plan_.stored_harmonics = options_.bands > 0 && options_.bands <= stored_.harmonics_bands;
    if (!options_.irradiance) return;
    plan_.irradiance = options_.irradiance->method;
    if (plan_.irradiance == IrradianceMethod::automatic && plan_.stored_harmonics)
      plan_.irradiance = IrradianceMethod::harmonics;
  }

  void settle_sizes() {
    plan_.background_size = background_size(source_, options_);
    if (plan_.background_size > 0)
      plan_.background_levels = options_.background->mips ? full_chain_levels(plan_.background_size) : 1;
    plan_.stored_specular = options_.specular && stored_.specular_mips > 0;
    if (options_.specular && !plan_.stored_specular) {
      plan_.prefilter = reflections::plan_prefilter(*options_.specular);
      if (convolves_by_harmonics()) {
        const IrradianceOptions& wanted = *options_.irradiance;
        plan_.shares_harmonics = reflections::share_harmonics(*plan_.prefilter, wanted.size, wanted.rms_error);
        if (plan_.shares_harmonics) plan_.irradiance_plan = plan_.prefilter;
      }
      const reflections::MipPlan& first = plan_.prefilter->mips.front();
      plan_.same_level = first.method == MipMethod::copy && plan_.background_size == first.size;
    }
    plan_.stored_background = source_.cubemap && plan_.background_levels > 1 &&
                              plan_.background_size == source_.columns &&
                              stored_.background_levels >= plan_.background_levels;
    if (convolves_by_harmonics() && !plan_.irradiance_plan) {
      plan_.irradiance_plan = reflections::plan_irradiance(options_.irradiance->size, options_.irradiance->rms_error);
    }
  }

  void add(BakePass pass, PassAction action, std::string reason, const Work& work, std::vector<BakePass> after = {}) {
    plan_.steps.push_back({pass,
                           {name(pass), action, std::move(reason), work.result_bytes + work.working_bytes},
                           work.weight,
                           std::move(after)});
    plan_.result_bytes += work.result_bytes;
    plan_.working_bytes += work.working_bytes;
  }
  void skip(BakePass pass, std::string reason = kNotAskedFor) { add(pass, PassAction::skip, std::move(reason), {}); }

  [[nodiscard]] double source_texels() const { return static_cast<double>(source_.texels()); }
  [[nodiscard]] bool convolves_by_harmonics() const {
    return options_.irradiance && plan_.irradiance == IrradianceMethod::automatic;
  }
  [[nodiscard]] bool convolves() const {
    return options_.irradiance && plan_.irradiance != IrradianceMethod::harmonics;
  }

  void sanitize() {
    if (!plan_.prefilter && plan_.background_size == 0 && !convolves())
      return skip(BakePass::sanitize, "only the projection reads pixels, and sanitizes them itself");
    // The memory is for a copy in either case: the source's pixels may turn out not to be clean.
    const Work work{0.3 * source_texels(), 0, kTexelBytes * source_.texels()};
    if (source_.format == PixelFormat::rgb32f && !options_.pixels.clamp && !options_.pixels.gamma) {
      add(BakePass::sanitize, PassAction::reuse, "RGB floats are checked, and copied only if some are invalid", work);
    } else {
      add(BakePass::sanitize, PassAction::run, "a copy as RGB floats, with the pixel policy applied", work);
    }
  }

  void specular() {
    if (plan_.prefilter) {
      add(BakePass::specular, PassAction::run, prefilter_words(*plan_.prefilter),
          prefilter_work(source_, *plan_.prefilter), {BakePass::sanitize});
    } else if (plan_.stored_specular) {
      const std::uint64_t texels = chain_texels(stored_.specular_size, stored_.specular_mips);
      add(BakePass::specular, PassAction::reuse,
          mips_from(stored_.specular_mips, stored_.specular_size) + " stored in the source",
          {0.25 * static_cast<double>(texels), kTexelBytes * texels, 0});
    } else {
      skip(BakePass::specular);
    }
  }

  void background() {
    const int size = plan_.background_size;
    if (size == 0) return skip(BakePass::background);
    const std::uint64_t bytes = kTexelBytes * chain_texels(size, 1);
    if (plan_.same_level) {
      add(BakePass::background, PassAction::reuse, "mip 0 of the specular cubemap is the same",
          {0.25 * cube_texels(size), bytes, 0}, {BakePass::specular});
    } else {
      add(BakePass::background, PassAction::run, source_.description() + " to faces of " + edge(size) + ", by area",
          {resampling(source_, size), bytes, source_.cubemap ? bytes : 0}, {BakePass::sanitize});
    }
  }

  void background_mips() {
    const int size = plan_.background_size;
    if (size == 0) return skip(BakePass::background_mips, "no background is made");
    const int levels = plan_.background_levels;
    if (levels == 1)
      return skip(BakePass::background_mips, options_.background->mips ? "level 0 is 1 texel" : kNotAskedFor);
    const std::uint64_t bytes = kTexelBytes * (chain_texels(size, levels) - chain_texels(size, 1));
    const std::string count = std::to_string(levels) + " levels";
    if (plan_.stored_background) {
      add(BakePass::background_mips, PassAction::reuse, count + " stored in the source",
          {0.1 * cube_texels(size), bytes, 0}, {BakePass::background});
    } else {
      const bool box = options_.background->mip_filter == MipFilter::box;
      add(BakePass::background_mips, PassAction::run,
          count + ", each from the one before, by " + (box ? "plain mean" : "solid angle"),
          {cube_texels(size), bytes, 0}, {BakePass::background});
    }
  }

  void project() {
    if (plan_.stored_harmonics) return add(BakePass::project, PassAction::reuse, "harmonics stored in the source", {});
    if (projected_bands_ == 0) return skip(BakePass::project);
    std::string words = "1 band, for the total radiance only";
    if (options_.bands > 0) {
      words = std::to_string(options_.bands) + (options_.bands > 1 ? " bands" : " band") + " from the source's texels";
    }
    add(BakePass::project, PassAction::run, words,
        {source_texels() * (0.4 + 0.01 * projected_bands_ * projected_bands_), 0, 0});
  }

  void irradiance() {
    if (!options_.irradiance) return skip(BakePass::irradiance);
    const int size = options_.irradiance->size;
    const double texels = cube_texels(size);
    const std::uint64_t bytes = kTexelBytes * chain_texels(size, 1);
    const bool direct = plan_.irradiance == IrradianceMethod::direct;
    if (direct || (plan_.irradiance_plan && plan_.irradiance_plan->bands == 0)) {
      add(BakePass::irradiance, PassAction::run,
          edge(size) + " by direct convolution in double" + (direct ? "" : ", because no other method meets the bound"),
          {4.0 * texels * source_texels(), bytes, 0}, {BakePass::sanitize});
    } else if (plan_.irradiance_plan) {
      convolve(*plan_.irradiance_plan, bytes);
    } else {
      add(BakePass::irradiance, PassAction::run, edge(size) + " from " + std::to_string(options_.bands) + " bands",
          {0.5 * texels * options_.bands * options_.bands, bytes, 0}, {BakePass::project});
    }
  }

  void convolve(const reflections::PrefilterPlan& how, std::uint64_t bytes) {
    const std::string words =
        edge(options_.irradiance->size) + " by " + std::to_string(how.irradiance->bands.bands()) + " bands";
    if (plan_.shares_harmonics) {
      add(BakePass::irradiance, PassAction::run, words + " from the specular chain's harmonics",
          {0.25 * cube_texels(how.irradiance->size), bytes, 0}, {BakePass::sanitize, BakePass::specular});
    } else {
      add(BakePass::irradiance, PassAction::run, words + ", bright texels one by one",
          {prefiltering(source_, how), bytes, prefilter_bytes(source_, how)}, {BakePass::sanitize});
    }
  }

  void brdf() {
    if (!options_.brdf) return skip(BakePass::brdf);
    const int width = options_.brdf->width;
    const int height = options_.brdf->height;
    add(BakePass::brdf, PassAction::run, std::to_string(width) + " x " + std::to_string(height) + " by quadrature",
        {400.0 * width * height, sizeof(float) * reflections::brdf_values(*options_.brdf), 0});
  }

  /// Counts only mips that exist: a file may hold fewer.
  void octahedral() {
    if (!options_.octahedral) return;
    if (!options_.specular) {
      throw Error(ErrorCode::invalid_argument,
                  "octahedral requires specular, which is empty; set specular, or leave octahedral empty");
    }
    const int mips = plan_.prefilter ? static_cast<int>(plan_.prefilter->mips.size()) : stored_.specular_mips;
    const int size = plan_.prefilter ? plan_.prefilter->mips.front().size : stored_.specular_size;
    const int whole = plan_.prefilter ? mips : options_.octahedral->levels;
    OctahedralOptions map = *options_.octahedral;
    octahedral::check_options(map, std::min(whole, full_chain_levels(std::clamp(map.size, 1, image::kLargestFace))));
    map.levels = std::min(map.levels, mips);
    plan_.octahedral = map;
    const std::uint64_t bytes = octahedral::map_bytes(map);
    add(BakePass::octahedral, PassAction::run,
        edge(map.size) + (map.levels > 1 ? " and " + std::to_string(map.levels - 1) + " smaller" : "") +
            " from the specular cubemap",
        {200.0 * static_cast<double>(chain_texels(size, map.levels)), bytes,
         octahedral::working_bytes(map, size, jobs::worker_count(jobs::Placement::arena))},
        {BakePass::specular});
  }

  const SourceShape& source_;
  const BakeOptions& options_;
  const StoredKinds& stored_;
  int projected_bands_ = 0;  ///< 0 if nothing is projected
  BakePlan plan_;
};

}  // namespace

const char* name(BakePass pass) noexcept {
  constexpr std::array names{"sanitize", "specular",   "background", "background mips",
                             "project",  "irradiance", "brdf",       "octahedral"};
  return platform::name_in<BakePass::octahedral>(names, pass, "");
}

std::uint64_t chain_texels(int size, int levels) noexcept {
  std::uint64_t texels = 0;
  for (int level = 0; level < levels; ++level) texels += 6 * squared(std::max(1, size >> level));
  return texels;
}

int background_size(const SourceShape& source, const BakeOptions& options) {
  if (!options.background) return 0;
  if (options.background->size) return *options.background->size;
  if (options.specular) return options.specular->size;
  return source.cubemap ? source.columns : std::max(1, source.columns / 4);
}

BakePlan plan_bake(const SourceShape& source, const BakeOptions& options, const StoredKinds& stored) {
  check(options);
  return BakePlanner(source, options, stored).run();
}

PlannedPass plan_prefilter_pass(const SourceShape& source, const reflections::PrefilterPlan& plan) {
  const Work work = prefilter_work(source, plan);
  return {name(BakePass::specular), PassAction::run, prefilter_words(plan), work.result_bytes + work.working_bytes};
}

void require_memory(const BakePlan& plan, const BakeOptions& options) {
  const std::uint64_t needed = plan.result_bytes + plan.working_bytes;
  if (needed <= options.memory_limit_bytes) return;
  throw Error(ErrorCode::limit_exceeded,
              "the bake may need " + std::to_string(needed) + " bytes (results " + std::to_string(plan.result_bytes) +
                  ", working memory " + std::to_string(plan.working_bytes) + ") and the limit is " +
                  std::to_string(options.memory_limit_bytes) +
                  "; pass smaller sizes, request fewer results, or raise memory_limit_bytes");
}

}  // namespace welkin::baking
