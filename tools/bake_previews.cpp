// The previews of a bake.
#include <algorithm>

#include "tools/bake_files.h"
#include "tools/preview_cross.h"
#include "tools/preview_spheres.h"

namespace welkin::tool {
namespace {

void write(const PreviewPicture& picture, const char* name, const char* what, OutputFolder& folder) {
  WriteOptions options;
  options.layout = Layout::lat_long;  // a plain picture, to a PNG
  write_environment(folder.place(name), picture.view(), options);
  folder.add({name, what, "PNG", 0, 0, "", {{"width", picture.width()}, {"height", picture.height()}}});
}

}  // namespace

ToneMap tone_map_of(const Baked& baked) {
  constexpr int kEnough = 32;
  const bool background = baked.light.background.levels() > 0;
  if (!background && !baked.light.specular) return {};
  const CubemapChain& chain = background ? baked.light.background : baked.light.specular->cubemap;
  int level = 0;
  while (level + 1 < chain.levels() && chain.level_size(level + 1) >= kEnough) ++level;
  return tone_map_of(chain.view(level));
}

void write_previews(const Baked& baked, OutputFolder& folder) {
  const ToneMap tone_map = tone_map_of(baked);
  const bool has_background = baked.light.background.levels() > 0;
  if (has_background) {
    write(preview_cross(CubeLookup(baked.light.background), tone_map), "preview_environment.png",
          "the surroundings as seen from inside, facing Welkin's +z", folder);
  }
  if (!baked.light.specular) return;
  const CubeLookup specular(baked.light.specular->cubemap);
  if (has_background)
    write(preview_spheres(baked.light, tone_map), "preview_spheres.png",
          "metal balls of roughness 0, 0.15, 0.3, 0.5, 0.75 and 1, and a white matte one, seen along Welkin's -z",
          folder);
  write(preview_mips(specular, tone_map), "preview_mips.png", "the specular mips as crosses, sharpest first", folder);
}

}  // namespace welkin::tool
