// A computed sky, prefiltered.
#include "welkin/sky_specular.h"

#include "jobs/tiles.h"
#include "welkin/sky_view.h"
#include "welkin/specular.h"

namespace welkin {

PrefilteredSpecular sky_specular(const SkyView& view, const glm::dvec3& sun, const PrefilterOptions& options,
                                 const SkyPictureOptions& picture, const Control& control) {
  constexpr double share_of_sky = 0.2;
  constexpr int largest = 8192;
  const int size = options.size >= 1 && options.size <= largest ? options.size : 1;  // the prefilter refuses others
  const CubemapImage source = sky_cubemap(view, sun, size, picture, jobs::part_of(control, 0.0, share_of_sky));
  return prefilter_specular(source.view(), options, jobs::part_of(control, share_of_sky, 1.0));
}

}  // namespace welkin
