#include "tools/bake_lat_long.h"

#include <algorithm>
#include <type_traits>

#include "projection/sanitized_pixels.h"
#include "welkin/resampling.h"

namespace welkin::tool {
namespace {

struct Size {
  int width = 0;
  int height = 0;
};

Size size_of(const SourceShape& source, const BakeCommandOptions& options, const BakeOptions& whole) {
  constexpr int kLargestFace = 2048;  // 8192 x 4096 pixels
  if (!contains(options.files, Content::lat_long)) return {};
  const SceneNeeds scene = options.scene.needs();
  const bool alone = is_lat_long_folder(options);
  const bool is_used = scene.background || (alone && (scene.glossy || scene.diffuse_bands > 0));
  if (!is_used) return {};
  int face = whole.background->size.value_or(whole.specular->size);
  if (alone && options.background_size == 0) {
    if (!source.cubemap) return {source.columns, source.rows};
    face = std::min(source.columns, kLargestFace);
  }
  return {4 * face, 2 * face};
}

}  // namespace

std::uint64_t lat_long_bytes(const SourceShape& source, const BakeCommandOptions& options, const BakeOptions& whole) {
  const Size size = size_of(source, options, whole);
  return 3 * sizeof(float) * static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height);
}

LatLongImage lat_long_of(const EnvironmentView& source, const BakeCommandOptions& options, const BakeOptions& whole,
                         const Control& control) {
  const Size size = size_of(shape_of(source), options, whole);
  if (size.width == 0) return {};
  const projection::SanitizedSource clean(source, whole.pixels, control);
  return to_lat_long(clean.view(), size.width, size.height, dmat3(1.0), ResampleFilter::bilinear, control);
}

}  // namespace welkin::tool
