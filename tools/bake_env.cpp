// Babylon.js's .env of a bake.
#include "tools/bake_files.h"
#include "welkin/babylon_environment.h"

namespace welkin::tool {
namespace {

Json roughness_json(const std::vector<MipRecord>& mips) {
  Json list = Json::array();
  for (const MipRecord& mip : mips) list.push_back(mip.roughness);
  return list;
}

}  // namespace

void write_env(const Baked& baked, OutputFolder& folder, const Control& control) {
  const PrefilteredSpecular& specular = baked.env_is_specular ? *baked.light.specular : *baked.env;
  // The polynomial from the source's own harmonics, or those that it stored: mip 0 ends at 255.
  const SphericalHarmonics& radiance = baked.stored_light ? baked.stored_light->radiance : *baked.light.radiance;
  BabylonEnvironment environment = to_babylon(specular.cubemap, radiance);
  constexpr const char* kName = "environment.env";
  const WriteReport report = write_babylon_environment(folder.place(kName), environment, control);
  const Json details = {
      {"size", environment.specular.size()},
      {"mips", environment.specular.levels()},
      {"roughness", roughness_json(specular.mips)},
      {"axes", "babylon"},
      {"lod_generation_scale", environment.lod_generation_scale},
      {"polynomial", baked.stored_light ? "the one that the input stores" : "of the source's harmonics"}};
  folder.add({kName, "all that Babylon.js wants: specular cubemap, and diffuse light as a polynomial",
              "Babylon.js .env, RGBD in PNG", 0, report.values_clamped, "above 255 or below 0 clamped: RGBD ends there",
              details});
}

}  // namespace welkin::tool
