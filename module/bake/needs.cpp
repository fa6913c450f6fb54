#include <algorithm>
#include <string>
#include <utility>

#include "bake/bake_plan.h"
#include "image/pixels.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "reflections/prefilter_plan.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {

void check(const SceneNeeds& needs) {
  const platform::FloatingPointScope floating_point;
  image::require_range("diffuse_bands", needs.diffuse_bands, 0, kMaximumBands);
  if (!needs.glossy) return;
  const RoughnessRange& range = *needs.glossy;
  if (range.minimum >= 0.0 && range.minimum <= range.maximum && range.maximum <= 1.0) return;
  throw Error(ErrorCode::invalid_argument,
              "glossy materials' roughness is from " + platform::number_text(range.minimum) + " to " +
                  platform::number_text(range.maximum) + "; pass 0 <= minimum <= maximum <= 1");
}

}  // namespace welkin

namespace welkin::baking {
namespace {

constexpr const char* kNotGlossy = "the scene has no glossy materials";

void need_diffuse(const SceneNeeds& needs, NeededOptions& needed) {
  BakeOptions& options = needed.options;
  if (needs.diffuse_bands == 0 && options.bands > 0) {
    options.total_radiance = false;
    needed.left_out[BakePass::project] = "the scene uses no diffuse light";
  }
  options.bands = std::min(options.bands, needs.diffuse_bands);
  if (!options.irradiance || (needs.irradiance_cubemap && needs.diffuse_bands > 1)) return;
  options.irradiance.reset();
  needed.left_out[BakePass::irradiance] = needs.diffuse_bands == 0   ? "the scene uses no diffuse light"
                                          : needs.diffuse_bands == 1 ? "the scene uses ambient light only"
                                                                     : "the scene evaluates coefficients instead";
}

void need_reflections(const SceneNeeds& needs, NeededOptions& needed) {
  BakeOptions& options = needed.options;
  if (!needs.glossy) {
    if (options.specular) needed.left_out[BakePass::specular] = kNotGlossy;
    if (options.brdf) needed.left_out[BakePass::brdf] = kNotGlossy;
    options.specular.reset();
    options.octahedral.reset();
    options.brdf.reset();
    return;
  }
  if (options.specular) {
    needed.unused_mips = keep_used_mips(*needs.glossy, *options.specular);
    if (options.octahedral && !needed.unused_mips.empty())
      options.octahedral->levels = std::min(options.octahedral->levels, *options.specular->mips);
  }
  if (!needs.brdf_table && options.brdf) {
    needed.left_out[BakePass::brdf] = "the engine has its own table";
    options.brdf.reset();
  }
}

/// Comes first: the background's size must not follow the specular cubemap's when that is made smaller or not at all.
void need_background(const SourceShape& source, const SceneNeeds& needs, NeededOptions& needed) {
  std::optional<BackgroundOptions>& background = needed.options.background;
  if (!background) return;
  if (!needs.background) {
    background.reset();
    needed.left_out[BakePass::background] = "the scene does not show it";
    return;
  }
  background->size = background_size(source, needed.options);
  if (needs.background_mips || !background->mips) return;
  background->mips = false;
  needed.left_out[BakePass::background_mips] = "the scene shows it at full size only";
}

}  // namespace

UsedMips used_mips(const std::vector<double>& roughness, const RoughnessRange& range) {
  const auto mips = static_cast<int>(roughness.size());
  if (!platform::ranges::is_sorted(roughness)) return {0, mips};  // who knows where shaders look
  const auto at = [&](int mip) { return roughness[static_cast<std::size_t>(mip)]; };
  int first = 0;
  while (first + 1 < mips && at(first + 1) <= range.minimum) ++first;
  while (first > 0 && at(first - 1) == at(first)) --first;  // a lookup may find either
  int last = mips - 1;
  while (last > first && at(last - 1) >= range.maximum) --last;
  while (last + 1 < mips && at(last + 1) == at(last)) ++last;
  return {first, last + 1 - first};
}

std::string keep_used_mips(const RoughnessRange& range, PrefilterOptions& options) {
  const std::vector<double> whole = reflections::roughness_of_chain(options);
  const UsedMips used = used_mips(whole, range);
  const int rougher = static_cast<int>(whole.size()) - used.first - used.count;
  if (used.first + rougher == 0) return {};
  const auto keep = [used](auto& of_mips) {
    const int given = static_cast<int>(of_mips.size());
    of_mips.erase(of_mips.begin() + std::min(given, used.first + used.count), of_mips.end());
    of_mips.erase(of_mips.begin(), of_mips.begin() + std::min(given, used.first));
  };
  options.size = std::max(1, options.size >> used.first);
  options.mips = used.count;
  options.roughness = whole;
  keep(options.roughness);
  keep(options.lobe_roughness);
  keep(options.spectra);
  return "; omitted: " + std::to_string(used.first) + " sharper, " + std::to_string(rougher) + " rougher";
}

NeededOptions needed_options(const SourceShape& source, const SceneNeeds& needs, const BakeOptions& full_options) {
  NeededOptions needed{full_options};
  need_background(source, needs, needed);
  need_diffuse(needs, needed);
  need_reflections(needs, needed);
  return needed;
}

}  // namespace welkin::baking
