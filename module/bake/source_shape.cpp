#include "welkin/source_shape.h"

#include "image/check_views.h"

namespace welkin {

std::string SourceShape::words() const {
  return cubemap ? "cubemap of " + std::to_string(columns)
                 : "lat-long " + std::to_string(columns) + " x " + std::to_string(rows);
}

SourceShape shape_of(const LatLongView& view) {
  image::check_view(view);
  return {false, view.width, view.height, view.format};
}

SourceShape shape_of(const CubemapView& view) {
  image::check_view(view);
  return {true, view.size, 6 * view.size, view.format};
}

}  // namespace welkin
