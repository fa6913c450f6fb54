// Cubemaps that the library made, reflections, BRDF tables and bakes: synchronous, as jobs, and written to the caller's
// memory.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "c/c_support.h"
#include "c/c_worker.h"
#include "image/pixels.h"
#include "transform/spectrum.h"
#include "welkin/bake.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/requests.h"
#include "welkin/welkin.h"

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

// Chains.

welkin_chain::welkin_chain(std::shared_ptr<const welkin::PrefilteredSpecular> specular)
    : levels(specular->cubemap.views()), mips(specular->mips), owner(std::move(specular)) {}

welkin_chain::welkin_chain(std::vector<welkin::CubemapView> its_levels, std::shared_ptr<const void> its_owner)
    : levels(std::move(its_levels)), owner(std::move(its_owner)) {}

namespace {

const welkin::CubemapView& level_of(const welkin_chain* chain, std::int32_t level) {
  require(chain, "chain");
  if (level < 0 || static_cast<std::size_t>(level) >= chain->levels.size()) {
    refuse("level is " + std::to_string(level) + "; the chain has " + std::to_string(chain->levels.size()) +
           ", counted from 0");
  }
  return chain->levels[static_cast<std::size_t>(level)];
}

}  // namespace

void welkin_chain_destroy(welkin_chain* chain) { destroy(chain); }

welkin_status welkin_chain_share(const welkin_chain* chain, welkin_chain** another) {
  return guarded_making(another, "another", [&] {
    require(chain, "chain");
    return new welkin_chain(*chain);
  });
}

welkin_status welkin_chain_get_info(const welkin_chain* chain, welkin_chain_info* info) {
  return guarded([&] {
    welkin_chain_info values{};
    values.size = level_of(chain, 0).size;
    values.levels = static_cast<std::int32_t>(chain->levels.size());
    values.prefiltered = chain->mips.empty() ? 0 : 1;
    write_struct(info, values, "info");
  });
}

welkin_status welkin_chain_get_level(const welkin_chain* chain, int32_t level, welkin_environment* pixels) {
  return guarded([&] {
    const welkin::CubemapView& view = level_of(chain, level);
    welkin_environment values{};
    values.format = WELKIN_FORMAT_RGB_F32;
    std::copy(view.faces.begin(), view.faces.end(), values.faces);
    values.size = view.size;
    write_struct(pixels, values, "pixels");
  });
}

welkin_status welkin_chain_copy(const welkin_chain* chain, int32_t level, const welkin_target* target,
                                uint64_t* values_clamped) {
  return guarded([&] {
    const welkin::CubemapView& view = level_of(chain, level);
    const Target checked = cubemap_target(target);
    require_size(checked, view.size, view.size);
    tell(write_faces(checked, view), values_clamped);
  });
}

namespace {

static_assert(WELKIN_PREFILTER_SPECTRAL == static_cast<int>(welkin::PrefilterMethod::spectral));
static_assert(WELKIN_PREFILTER_REFERENCE == static_cast<int>(welkin::PrefilterMethod::reference));

welkin_prefilter_method method_of(const welkin::MipRecord& mip) {
  switch (mip.method) {
    case welkin::MipMethod::spectral: return WELKIN_PREFILTER_SPECTRAL;
    case welkin::MipMethod::reference: return WELKIN_PREFILTER_REFERENCE;
    case welkin::MipMethod::near_far: return WELKIN_PREFILTER_NEAR_FAR;
    case welkin::MipMethod::copy:
    case welkin::MipMethod::stored: break;
  }
  return WELKIN_PREFILTER_COPY;
}

}  // namespace

welkin_status welkin_chain_get_mip(const welkin_chain* chain, int32_t level, welkin_mip* mip) {
  return guarded([&] {
    static_cast<void>(level_of(chain, level));
    if (chain->mips.empty()) refuse("the chain is not prefiltered; its mips have no roughness");
    const welkin::MipRecord& record = chain->mips[static_cast<std::size_t>(level)];
    welkin_mip values{};
    values.size = record.size;
    values.roughness = record.roughness;
    values.method = method_of(record);
    values.bands = record.bands;
    values.bright_texels = record.bright_texels;
    values.error_estimate = record.error_estimate.value_or(std::numeric_limits<double>::quiet_NaN());
    write_triple(record.mean, values.mean);
    values.lobe_roughness = record.lobe_roughness;
    values.error_between = record.error_between.value_or(std::numeric_limits<double>::quiet_NaN());
    write_struct(mip, values, "mip");
  });
}

// Options of reflections, tables and bakes.

static_assert(WELKIN_QUALITY_NORMAL == static_cast<int>(welkin::Quality::normal));
static_assert(WELKIN_QUALITY_FAST == static_cast<int>(welkin::Quality::fast));
static_assert(WELKIN_QUALITY_REFERENCE == static_cast<int>(welkin::Quality::reference));

namespace welkin::c_interface {
namespace {

constexpr int kDefaultReflections = 256;
constexpr std::int32_t kMaxRoughness = 16;

using SpecularPointer = std::shared_ptr<const PrefilteredSpecular>;

SpecularPointer prefiltered(const EnvironmentView& view, const PrefilterOptions& options, const Control& control) {
  return std::make_shared<const PrefilteredSpecular>(prefilter_specular(view, options, control));
}

/// `prefilter_specular`, as a request.
struct PrefilterRequest {
  EnvironmentSource source;
  PrefilterOptions options;

  [[nodiscard]] SpecularPointer operator()(const Control& control) const {
    return prefiltered(source.view(), options, control);
  }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return source.bytes(); }
};

welkin_chain* chain_of(SpecularPointer specular) { return new welkin_chain(std::move(specular)); }

static_assert(WELKIN_LOBE_FAMILY_SPECTRA == static_cast<int>(LobeFamily::spectra));

void read_spectra(const welkin_prefilter_options& given, PrefilterOptions& wanted) {
  wanted.lobe = enumerator("lobe", given.lobe, LobeFamily::spectra);
  if (given.spectra == nullptr && given.spectrum_bands == 0 && wanted.lobe != LobeFamily::spectra) return;
  if (wanted.lobe != LobeFamily::spectra)
    refuse("spectra are given, and the lobe is another; set it to WELKIN_LOBE_FAMILY_SPECTRA");
  require(given.spectra, "spectra");
  image::require_range("spectrum_bands", given.spectrum_bands, 1, transforms::kMaximumSpectrumBands);
  const int mips = given.mips != 0 ? given.mips : std::max(1, given.roughness_count);
  image::require_range("mips", mips, 1, kMaxRoughness);
  for (int mip = 0; mip < mips; ++mip) {
    const double* const first = given.spectra + std::ptrdiff_t{mip} * given.spectrum_bands;
    wanted.spectra.emplace_back(first, first + given.spectrum_bands);
  }
}

/// Reads roughness by a named schedule, unless the caller has a table.
void read_schedule(const welkin_prefilter_options& given, PrefilterOptions& wanted) {
  constexpr std::array schedules{RoughnessSchedule::filament, RoughnessSchedule::linear, RoughnessSchedule::filament,
                                 RoughnessSchedule::babylon,  RoughnessSchedule::unity,  RoughnessSchedule::unreal};
  require_enumerator("schedule", given.schedule, WELKIN_ROUGHNESS_UNREAL);
  const bool fitted = flag("fitted", given.fitted);
  if (given.schedule == WELKIN_ROUGHNESS_DEFAULT && !fitted) return;
  if (given.roughness_count > 0) refuse("schedule or fitted is set together with roughness; pass one of them");
  wanted.use_schedule(schedules[static_cast<std::size_t>(given.schedule)], fitted);
}

}  // namespace

PrefilterOptions prefilter_options(const welkin_prefilter_options* options, int size, bool pixels, Quality otherwise) {
  const auto given = read_options(options, "prefilter options");
  const Quality named = enumerator("quality", given.quality, Quality::reference);
  const Quality quality = named != Quality::normal ? named : otherwise;
  PrefilterOptions wanted = PrefilterOptions::at(given.rms_error == 0.0 ? quality : Quality::normal);
  wanted.size = given.size != 0 ? given.size : size;
  if (given.mips != 0) wanted.mips = given.mips;
  image::require_range("roughness_count", given.roughness_count, 0, kMaxRoughness);
  if (given.roughness_count > 0) {
    require(given.roughness, "roughness");
    wanted.roughness.assign(given.roughness, given.roughness + given.roughness_count);
  }
  if (given.lobe_roughness != nullptr) {
    if (given.roughness_count == 0) refuse("lobe_roughness is given, and roughness_count is 0; pass roughness too");
    wanted.lobe_roughness.assign(given.lobe_roughness, given.lobe_roughness + given.roughness_count);
  }
  read_schedule(given, wanted);
  read_spectra(given, wanted);
  set_unless_zero(wanted.method, enumerator("method", given.method, PrefilterMethod::reference));
  set_unless_zero(wanted.rms_error, given.rms_error);
  if (given.maximum_error != 0.0) wanted.maximum_error = given.maximum_error;
  if (pixels) {
    wanted.pixels = pixel_policy(given.pixels);
  } else if (given.pixels != nullptr) {
    refuse("pixels of the prefilter options is not null; here it must be, as no call would read it");
  }
  return wanted;
}

namespace {

BrdfTableOptions brdf_options(const welkin_brdf_options* options) {
  const auto given = read_options(options, "brdf options");
  BrdfTableOptions wanted;
  set_unless_zero(wanted.width, given.width);
  set_unless_zero(wanted.height, given.height);
  const bool multiple_scattering = flag("multiple_scattering", given.multiple_scattering);
  wanted.model = multiple_scattering ? BrdfModel::multiple_scattering : BrdfModel::split_sum;
  wanted.sheen = !flag("without_sheen", given.without_sheen);
  return wanted;
}

std::uint64_t write_table(const Target& target, const BrdfTable& table) {
  require_size(target, table.options.width, table.options.height);
  return write_image(target, 0, table.values.data(), table.channels);
}

using BakePointer = std::shared_ptr<const BakeResult>;

constexpr welkin_parts kAllParts =
    WELKIN_PART_BACKGROUND | WELKIN_PART_SPECULAR | WELKIN_PART_IRRADIANCE | WELKIN_PART_HARMONICS | WELKIN_PART_BRDF;

static_assert(WELKIN_IRRADIANCE_DIRECT == static_cast<int>(IrradianceMethod::direct));
static_assert(WELKIN_IRRADIANCE_HARMONICS == static_cast<int>(IrradianceMethod::harmonics));

welkin_bake_result* handle_of(BakePointer result) { return new welkin_bake_result(std::move(result)); }

BakeTargets bake_targets(const welkin_bake_targets* targets) {
  const auto given = read_struct(targets, "targets");
  BakeTargets wanted{.background = cubemap_targets(given.background, given.background_count, "targets.background"),
                     .specular = cubemap_targets(given.specular, given.specular_count, "targets.specular")};
  if (given.irradiance != nullptr) {
    wanted.irradiance = cubemap_targets(given.irradiance, 1, "targets.irradiance").front();
  }
  return wanted;
}

const BakeResult& result_of(const welkin_bake_result* result) {
  require(result, "result");
  return *result->result;
}

}  // namespace

BakeOptions bake_options(const welkin_bake_options* options) {
  const auto given = read_options(options, "options");
  if ((given.leave_out & ~kAllParts) != 0) {
    refuse("leave_out is " + std::to_string(given.leave_out) + "; it must be a sum of WELKIN_PART_ flags");
  }
  const auto wants = [&](welkin_parts part) { return (given.leave_out & part) == 0; };
  const auto quality = enumerator("quality", given.quality, Quality::reference);
  BakeOptions wanted = BakeOptions::at(given.irradiance_rms_error == 0.0 ? quality : Quality::normal);
  if (given.background_size != 0) wanted.background->size = given.background_size;
  wanted.background->mips = !flag("background_without_mips", given.background_without_mips);
  const bool box = flag("background_box_filter", given.background_box_filter);
  wanted.background->mip_filter = box ? MipFilter::box : MipFilter::solid_angle;
  if (!wants(WELKIN_PART_BACKGROUND)) wanted.background.reset();
  set_unless_zero(wanted.irradiance->size, given.irradiance_size);
  wanted.irradiance->method = enumerator("irradiance_method", given.irradiance_method, IrradianceMethod::harmonics);
  set_unless_zero(wanted.irradiance->rms_error, given.irradiance_rms_error);
  if (!wants(WELKIN_PART_IRRADIANCE)) wanted.irradiance.reset();
  set_unless_zero(wanted.bands, given.bands);
  if (!wants(WELKIN_PART_HARMONICS)) wanted.bands = 0;
  wanted.specular = prefilter_options(given.specular, kDefaultReflections, false, quality);
  if (given.octahedral_size != 0) {
    wanted.octahedral = OctahedralOptions{.size = given.octahedral_size, .border = given.octahedral_border};
    set_unless_zero(wanted.octahedral->levels, given.octahedral_levels);
  } else if (given.octahedral_levels != 0 || given.octahedral_border != 0) {
    refuse("octahedral_levels or octahedral_border are given, and octahedral_size is 0; set it, or leave them 0");
  }
  if (!wants(WELKIN_PART_SPECULAR)) wanted.specular.reset();
  wanted.brdf = brdf_options(given.brdf);
  if (!wants(WELKIN_PART_BRDF)) wanted.brdf.reset();
  wanted.pixels = pixel_policy(given.pixels);
  set_unless_zero(wanted.memory_limit_bytes, given.memory_limit_bytes);
  return wanted;
}

}  // namespace welkin::c_interface

// Reflections.

welkin_status welkin_prefilter(const welkin_environment* environment, const welkin_prefilter_options* options,
                               const welkin_control* control, welkin_chain** chain) {
  return guarded_making(chain, "chain", [&] {
    const auto wanted = prefilter_options(options, kDefaultReflections, true);
    return chain_of(prefiltered(environment_view(environment), wanted, control_of(control)));
  });
}

welkin_status welkin_post_prefilter(welkin_worker* worker, const welkin_environment* environment,
                                    const welkin_prefilter_options* options, const welkin_post_options* post,
                                    welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& posting) {
    const auto view = environment_view(environment);
    auto wanted = prefilter_options(options, kDefaultReflections, true);
    return PrefilterRequest{{view, make_owner(std::move(posting.handed_over))}, std::move(wanted)};
  });
}

welkin_status welkin_job_get_chain(const welkin_job* job, welkin_chain** chain) {
  return hand_out_result<SpecularPointer>(job, chain, "chain", chain_of);
}

// Tables and irradiance cubemaps.

welkin_status welkin_brdf_table(const welkin_brdf_options* options, const welkin_control* control,
                                const welkin_target* target, uint64_t* values_clamped) {
  return guarded([&] {
    const auto wanted = brdf_options(options);
    const Target checked = flat_target(target);
    require_size(checked, wanted.width, wanted.height);
    tell(write_table(checked, *welkin::brdf_table(wanted, control_of(control))), values_clamped);
  });
}

welkin_status welkin_irradiance_cubemap(int32_t bands, const double* irradiance, const welkin_control* control,
                                        const welkin_target* target, uint64_t* values_clamped) {
  return guarded([&] {
    const auto harmonics = read_harmonics(bands, irradiance, "irradiance");
    const Target checked = cubemap_target(target);
    const auto cubemap = welkin::irradiance_cubemap(harmonics, checked.width, control_of(control));
    tell(write_faces(checked, cubemap.view()), values_clamped);
  });
}

// Bakes.

welkin_bake_result::welkin_bake_result(std::shared_ptr<const welkin::BakeResult> its_result)
    : result(std::move(its_result)) {
  if (result->background) background = welkin_chain(result->background->views(), result);
  if (result->specular) specular = welkin_chain(SpecularPointer(result, &*result->specular));
  if (result->irradiance) irradiance = welkin_chain({result->irradiance->view()}, result);
}

welkin_status welkin_bake_many(const welkin_environment* probes, int64_t probe_count,
                               const welkin_prefilter_options* options, const welkin_control* control,
                               const welkin_target* targets, int64_t target_count, int32_t bands, double* coefficients,
                               welkin_projection* totals, uint64_t* values_clamped) {
  return guarded([&] {
    const auto wanted = prefilter_options(options, kDefaultReflections, true);
    const auto views = probe_views(probes, probe_count);
    const auto written = cubemap_targets(targets, target_count);
    if (totals != nullptr) require_room(totals, 0);
    if (!views.empty() && bands != 0) require(coefficients, "coefficients");
    const std::size_t count =
        bands > 0 && bands <= welkin::kMaximumBands ? views.size() * static_cast<std::size_t>(bands * bands) : 0;
    const auto baked =
        welkin::bake_many(views, written, triples(coefficients, count), wanted, bands, control_of(control));
    if (totals != nullptr) write_diagnostics(totals, baked.diagnostics);
    tell(baked.values_clamped, values_clamped);
  });
}

welkin_status welkin_bake(const welkin_environment* environment, const welkin_bake_options* options,
                          const welkin_control* control, welkin_bake_result** result) {
  return guarded_making(result, "result", [&] {
    const auto view = environment_view(environment);
    return handle_of(
        std::make_shared<const welkin::BakeResult>(welkin::bake(view, bake_options(options), control_of(control))));
  });
}

welkin_status welkin_post_bake(welkin_worker* worker, const welkin_environment* environment,
                               const welkin_bake_options* options, const welkin_bake_targets* targets,
                               const welkin_post_options* post, welkin_job** job) {
  if (targets == nullptr) {
    return guarded_post(worker, post, job, [&](Posting& posting) {
      const auto view = environment_view(environment);
      auto wanted = bake_options(options);
      return welkin::Bake{{view, make_owner(std::move(posting.handed_over))}, std::move(wanted)};
    });
  }
  return guarded_post(worker, post, job, [&](Posting& posting) {
    const auto view = environment_view(environment);
    auto wanted = bake_options(options);
    welkin::BakeTo request{{view, nullptr}, bake_targets(targets), std::move(wanted)};
    request.owner = make_owner(std::move(posting.handed_over));
    return request;
  });
}

welkin_status welkin_job_get_bake(const welkin_job* job, welkin_bake_result** result) {
  return hand_out_result<BakePointer>(job, result, "result", handle_of);
}

void welkin_bake_result_destroy(welkin_bake_result* result) { destroy(result); }

welkin_status welkin_bake_result_get_info(const welkin_bake_result* result, welkin_bake_info* info) {
  return guarded([&] {
    const welkin::BakeResult& light = result_of(result);
    welkin_bake_info values{};
    if (!result->background.levels.empty()) values.parts |= WELKIN_PART_BACKGROUND;
    if (!result->specular.levels.empty()) values.parts |= WELKIN_PART_SPECULAR;
    if (!result->irradiance.levels.empty()) values.parts |= WELKIN_PART_IRRADIANCE;
    if (light.radiance) {
      values.parts |= WELKIN_PART_HARMONICS;
      values.bands = light.radiance->bands();
    }
    if (light.brdf) values.parts |= WELKIN_PART_BRDF;
    if (light.octahedral) {
      values.parts |= WELKIN_PART_OCTAHEDRAL;
      values.octahedral_size = light.octahedral->size;
      values.octahedral_levels = static_cast<std::int32_t>(light.octahedral->levels.size());
      values.octahedral_border = light.octahedral->border;
    }
    values.peak_bytes = light.peak_bytes;
    values.values_clamped = light.values_clamped;
    const std::optional<double> error = light.irradiance_record.value_or(welkin::MipRecord{}).error_estimate;
    values.irradiance_error_estimate = error.value_or(std::numeric_limits<double>::quiet_NaN());
    write_struct(info, values, "info");
  });
}

const welkin_chain* welkin_bake_result_chain(const welkin_bake_result* result, welkin_parts part) {
  if (result == nullptr) return nullptr;
  const welkin_chain* chain = nullptr;
  if (part == WELKIN_PART_BACKGROUND) chain = &result->background;
  if (part == WELKIN_PART_SPECULAR) chain = &result->specular;
  if (part == WELKIN_PART_IRRADIANCE) chain = &result->irradiance;
  return chain == nullptr || chain->levels.empty() ? nullptr : chain;
}

welkin_status welkin_bake_result_get_projection(const welkin_bake_result* result, welkin_projection* projection) {
  return guarded([&] {
    const welkin::BakeResult& light = result_of(result);
    if (!light.radiance) refuse("the bake has no harmonics; request WELKIN_PART_HARMONICS");
    write_projection(projection, *light.radiance, light.diagnostics);
  });
}

welkin_status welkin_bake_result_copy_octahedral(const welkin_bake_result* result, int32_t level,
                                                 const welkin_target* target, uint64_t* values_clamped) {
  return guarded([&] {
    const welkin::BakeResult& light = result_of(result);
    if (!light.octahedral) refuse("the bake has no octahedral map; set octahedral_size");
    const welkin::OctahedralMap& map = *light.octahedral;
    if (level < 0 || static_cast<std::size_t>(level) >= map.levels.size()) {
      refuse("level is " + std::to_string(level) + "; the map has " + std::to_string(map.levels.size()) +
             ", counted from 0");
    }
    const Target checked = flat_target(target);
    require_size(checked, map.level_size(level), map.level_size(level));
    tell(write_image(checked, 0, map.levels[static_cast<std::size_t>(level)].data(), 3), values_clamped);
  });
}

welkin_status welkin_bake_result_copy_brdf(const welkin_bake_result* result, const welkin_target* target,
                                           uint64_t* values_clamped) {
  return guarded([&] {
    const welkin::BakeResult& light = result_of(result);
    if (!light.brdf) refuse("the bake has no BRDF table; request WELKIN_PART_BRDF");
    tell(write_table(flat_target(target), *light.brdf), values_clamped);
  });
}
