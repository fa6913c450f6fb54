#include "codec/byte_file.h"
#include "codec/row_source.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

void require_layout(const EnvironmentInfo& info, Layout wanted) {
  if (info.layout != wanted) {
    throw codec::file_error(ErrorCode::invalid_argument, info.path,
                            std::string("is held as a ") + name(info.layout) + " (" + info.layout_reason +
                                "), and a view of a " + name(wanted) + " was asked for; read it with that layout");
  }
}

}  // namespace

LatLongView Environment::lat_long() const {
  require_layout(info, Layout::lat_long);
  return {pixels.get(), info.width, info.height, 0, PixelFormat::rgb_f32};
}

CubemapView Environment::cubemap() const {
  require_layout(info, Layout::vertical_strip);
  const int size = info.width;
  const std::size_t face_floats = static_cast<std::size_t>(codec::rgb_bytes(size, size)) / sizeof(float);
  CubemapView view{{}, size, 0, PixelFormat::rgb_f32};
  for (std::size_t face = 0; face < view.faces.size(); ++face) {
    view.faces[face] = pixels.get() + face * face_floats;
  }
  return view;
}

}  // namespace welkin
