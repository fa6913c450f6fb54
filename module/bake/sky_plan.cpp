// Carries out plans for skies.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "bake/bake_plan.h"
#include "image/pixels.h"
#include "jobs/stopwatch.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "reflections/brdf_table.h"
#include "reflections/prefilter.h"
#include "sky/elevation_curve.h"
#include "sky/sky_projection.h"
#include "sky/sky_slice.h"
#include "sky/table_sizes.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/reflections.h"
#include "welkin/sky.h"

namespace welkin {
namespace {

constexpr std::uint64_t kTexelBytes = 3 * sizeof(float);

/// The passes, in the order in which they are planned and recorded: `SkyPlan::passes` has each once.
enum class SkyPass {
  transmittance,
  sun_paths,
  orders,
  scattering,
  aerosol,
  absorbers,
  view,
  curve,
  project,
  specular,
  background,
  brdf,
};

const char* name(SkyPass pass) noexcept {
  constexpr std::array names{"transmittance", "sun paths", "orders",  "scattering", "aerosol",    "absorbers",
                             "view",          "curve",     "project", "specular",   "background", "brdf"};
  return platform::name_in<SkyPass::brdf>(names, pass, "");
}

SkyBakeOptions needed_options(const SceneNeeds& needs, const SkyBakeOptions& full_options) {
  SkyBakeOptions options = full_options;
  options.bands = std::min(full_options.bands, needs.diffuse_bands);
  if (!needs.background) options.background_size.reset();
  if (!needs.glossy) options.specular.reset();
  if (!needs.glossy || !needs.brdf_table) options.brdf.reset();
  return options;
}

/// Builds the list of passes, with one function per group of them.
class SkyPlanner {
 public:
  SkyPlanner(SkyPlan& plan, const SceneNeeds& needs, const SkyBakeOptions& full_options)
      : plan_(plan), needs_(needs), full_options_(full_options), options_(plan.options) {}

  void run() {
    settle();
    plan_tables();
    plan_matter();
    plan_light();
    plan_reflections();
    plan_background();
    if (options_.brdf) {
      add(SkyPass::brdf, "by quadrature", sizeof(float) * reflections::brdf_values(*options_.brdf));
    } else {
      skip(SkyPass::brdf, !full_options_.brdf ? "not requested"
                          : needs_.glossy     ? "the engine has its own table"
                                              : kNotGlossy);
    }
  }

 private:
  static constexpr const char* kNotGlossy = "the scene has no glossy materials";
  static constexpr const char* kNoTables = "no pass uses the scattering tables";

  /// `working`: upper bound on the bytes that it needs in addition to its result.
  void add(SkyPass pass, std::string reason, std::uint64_t bytes, std::uint64_t working = 0) {
    plan_.passes.push_back({name(pass), PassAction::run, std::move(reason), bytes + working});
    plan_.result_bytes += bytes;
  }
  void skip(SkyPass pass, std::string reason) {
    plan_.passes.push_back({name(pass), PassAction::skip, std::move(reason), 0});
  }
  void settle() {
    PrefilterOptions* const specular = plan_.options.specular ? &*plan_.options.specular : nullptr;
    if (specular != nullptr) {
      plan_.specular_source = specular->size;
      unused_mips_ = baking::keep_used_mips(*needs_.glossy, *specular);
    }
    plan_.tables = options_.bands > 0 || specular != nullptr || options_.background_size;
    plan_.curve = options_.bands > 0 && needs_.sun_moves;
  }
  void plan_tables() {
    if (!plan_.tables) {
      for (const SkyPass pass : {SkyPass::transmittance, SkyPass::sun_paths, SkyPass::orders, SkyPass::scattering}) {
        skip(pass, kNoTables);
      }
      return;
    }
    const SkyTableOptions& tables = options_.tables;
    const std::uint64_t floats = sky::transmittance_floats(tables);
    add(SkyPass::transmittance, "along rays to the top of the air", sizeof(float) * floats);
    add(SkyPass::sun_paths, "path lengths to the sun, for all wavelengths", 0);
    add(SkyPass::orders,
        tables.orders > 1
            ? "orders 2 to " + std::to_string(tables.orders) +
                  (tables.truncate_orders ? "" : ", estimate of further ones") + ", and irradiance of the ground"
            : "irradiance of the ground only, because one order has no multiple scattering",
        sizeof(float) * sky::irradiance_floats(tables),
        sky::sky_table_bytes(plan_.atmosphere, tables) - sky::result_bytes(plan_.atmosphere, tables));
    add(SkyPass::scattering, tables.orders > 1 ? "single and multiple scattering" : "single scattering",
        sizeof(float) * (4 * sky::scattering_texels(tables) + sky::single_mie_floats(plan_.atmosphere, tables)));
  }

  /// Lists aerosol and absorbers, which are computed with the tables and have no memory of their own.
  void plan_matter() {
    const Atmosphere& air = plan_.atmosphere;
    const auto in_tables = [&](SkyPass pass, bool there, const char* why_not, const std::string& reason) {
      if (there && plan_.tables) return add(pass, reason, 0);
      skip(pass, there ? kNoTables : why_not);
    };
    in_tables(SkyPass::aerosol, sky::scatters(air.aerosol),
              "the planet has no scattering aerosol: no table of single Mie scattering", "in the tables");
    const auto absorbers = platform::ranges::count_if(air.absorbers, sky::matters);
    in_tables(SkyPass::absorbers, absorbers > 0, "the planet has none, such as ozone",
              std::to_string(absorbers) + " of them, in the tables");
  }

  void plan_light() {
    if (!plan_.tables) {
      skip(SkyPass::view, kNoTables);
    } else {
      add(SkyPass::view, "slice of the tables at the altitude", 0, sky::slice_bytes(options_.tables));
    }
    const std::string bands = std::to_string(options_.bands) + " bands";
    const auto quadrature = [&](SkyHarmonicsOptions harmonics) {
      harmonics.bands = options_.bands;
      return sky::projection_bytes(options_.tables, harmonics);
    };
    if (plan_.curve) {
      add(SkyPass::curve, bands + " over the sun's elevation", sky::curve_bytes(options_.bands, options_.curve.nodes),
          quadrature(options_.curve.projection));
    } else {
      skip(SkyPass::curve, options_.bands == 0 ? no_light() : "the sun does not move");
    }
    if (options_.bands > 0 && !plan_.curve) {
      const std::uint64_t coefficients =
          static_cast<std::uint64_t>(options_.bands) * static_cast<std::uint64_t>(options_.bands);
      add(SkyPass::project, bands + " for one sun", coefficients * sizeof(glm::dvec3), quadrature(options_.harmonics));
    } else {
      skip(SkyPass::project, options_.bands == 0 ? no_light() : "the curve covers every sun");
    }
  }
  [[nodiscard]] const char* no_light() const {
    return full_options_.bands == 0 ? "not requested" : "the scene uses no diffuse light";
  }

  void plan_reflections() {
    if (!options_.specular) return skip(SkyPass::specular, full_options_.specular ? kNotGlossy : "not requested");
    const int size = plan_.specular_source;
    const SourceShape source{true, size, 6 * size, PixelFormat::rgb32f};
    const PlannedPass pass = baking::plan_prefilter_pass(source, reflections::plan_prefilter(*options_.specular));
    add(SkyPass::specular, pass.reason + unused_mips_ + ", for one sun; the shader rotates it about the vertical",
        pass.bytes, kTexelBytes * baking::chain_texels(size, 1));
  }

  void plan_background() {
    if (!options_.background_size)
      return skip(SkyPass::background, full_options_.background_size ? "the scene does not show it" : "not requested");
    const std::uint64_t texels = baking::chain_texels(*options_.background_size, 1);
    add(SkyPass::background, "a cubemap of the sky for one sun", kTexelBytes * texels);
  }

  SkyPlan& plan_;
  const SceneNeeds& needs_;
  const SkyBakeOptions& full_options_;
  const SkyBakeOptions& options_;
  std::string unused_mips_{};
};

}  // namespace

SkyPlan plan(const Atmosphere& atmosphere, const SceneNeeds& needs, const SkyBakeOptions& full_options) {
  const platform::FloatingPointScope floating_point;
  check(needs);
  static_cast<void>(sky::sky_table_bytes(atmosphere, full_options.tables));  // refuses what cannot be computed
  if (full_options.background_size)
    image::require_range("background_size", *full_options.background_size, 1, image::kLargestFace);
  SkyPlan plan;
  plan.atmosphere = atmosphere;
  plan.source = "the sky of " + (atmosphere.name.empty() ? std::string("a planet") : atmosphere.name) + ", " +
                (needs.sun_moves ? "a moving sun" : "one sun");
  plan.options = needed_options(needs, full_options);
  SkyPlanner(plan, needs, full_options).run();
  return plan;
}

const PlannedPass& SkyPlan::pass(const std::string& name) const { return baking::pass_of(passes, name); }

std::string plan_text(const SkyPlan& plan, const std::vector<PassRecord>& measured) {
  const platform::FloatingPointScope floating_point;
  return "Plan for " + plan.source + '\n' + baking::passes_text(plan.passes, measured);
}

namespace {

/// `size`: texels along an edge of the sky that is prefiltered.
PrefilteredSpecular prefiltered_sky(const SkyView& view, const glm::dvec3& sun, int size,
                                    const PrefilterOptions& options, const SkyImageOptions& image,
                                    const Control& control) {
  constexpr double share_of_sky = 0.2;
  const reflections::PrefilterPlan plan = reflections::plan_prefilter(options);
  const Cubemap sky = sky_cubemap(view, sun, size, image, jobs::part_of(control, 0.0, share_of_sky));
  return reflections::prefilter(sky.view(), plan, options.pixels, {}, jobs::part_of(control, share_of_sky, 1.0));
}

constexpr double kTables = 0.8;  ///< of the progress

class SkyBaking {
 public:
  SkyBaking(const SkyPlan& plan, const glm::dvec3& sun, const Control& control)
      : plan_(plan), sun_(sun), control_(control), quiet_{control.stop, {}, control.memory} {}

  SkyBake run() {
    if (plan_.tables) {
      sky_.tables = std::make_shared<const SkyTables>(
          precompute_sky(plan_.atmosphere, plan_.options.tables, jobs::part_of(control_, 0.0, kTables)));
    }
    for (std::size_t k = 0; k < plan_.passes.size(); ++k) {
      const PlannedPass& planned = plan_.passes[k];
      if (planned.action == PassAction::skip) {
        sky_.passes.push_back({planned.name, planned.action, planned.reason, 0.0});
      } else if (!record_of_tables(planned.name)) {
        run_pass(static_cast<SkyPass>(k), planned);
      }
    }
    if (control_.progress) control_.progress(1.0);
    return std::move(sky_);
  }

 private:
  /// Records the tables' passes of that name. Returns false if they have none.
  bool record_of_tables(const std::string& name) {
    bool found = false;
    for (const PassRecord& record : sky_.tables ? sky_.tables->passes : std::vector<PassRecord>()) {
      if (record.name != name) continue;
      sky_.passes.push_back(record);
      found = true;
    }
    return found;
  }

  void run_pass(SkyPass pass, const PlannedPass& planned) {
    const jobs::Stopwatch watch;
    make(pass);
    sky_.passes.push_back({planned.name, planned.action, planned.reason, watch.milliseconds()});
  }

  void make(SkyPass pass) {
    const SkyBakeOptions& options = plan_.options;
    switch (pass) {
      case SkyPass::view:
        view_.emplace(sky_.tables, options.altitude_m);
        sky_.sun = view_->sun_light(sun_);
        break;
      case SkyPass::curve: {
        SkyCurveOptions curve = options.curve;
        curve.bands = options.bands;
        sky_.curve.emplace(*view_, curve, quiet_);
        break;
      }
      case SkyPass::project: {
        SkyHarmonicsOptions harmonics = options.harmonics;
        harmonics.bands = options.bands;
        sky_.radiance = SkyProjector(*view_, harmonics).project(sun_);
        break;
      }
      case SkyPass::specular:
        sky_.specular = prefiltered_sky(*view_, sun_, plan_.specular_source, *options.specular, {}, quiet_);
        break;
      case SkyPass::background:
        sky_.background = sky_cubemap(*view_, sun_, *options.background_size, {}, quiet_);
        break;
      case SkyPass::brdf: sky_.brdf = brdf_table(*options.brdf, quiet_); break;
      // Recorded with the tables.
      case SkyPass::transmittance:
      case SkyPass::sun_paths:
      case SkyPass::orders:
      case SkyPass::scattering:
      case SkyPass::aerosol:
      case SkyPass::absorbers: break;
    }
  }

  const SkyPlan& plan_;
  glm::dvec3 sun_;
  const Control& control_;
  Control quiet_;  ///< can stop but reports no progress: what follows the tables is short
  std::optional<SkyView> view_;
  SkyBake sky_;
};

}  // namespace

SkyBake bake(const SkyPlan& plan, const glm::dvec3& sun, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return SkyBaking(plan, sun, control).run();
}

// A computed sky, prefiltered.

PrefilteredSpecular sky_specular(const SkyView& view, const glm::dvec3& sun, const PrefilterOptions& options,
                                 const SkyImageOptions& image, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return prefiltered_sky(view, sun, options.size, options, image, control);
}

}  // namespace welkin
