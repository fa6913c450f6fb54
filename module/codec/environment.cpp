#include "codec/byte_file.h"
#include "codec/layout.h"
#include "codec/row_source.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

[[noreturn]] void refuse_view(const EnvironmentInfo& info, const char* wanted) {
  throw codec::file_error(ErrorCode::invalid_argument, info.path,
                          std::string("is held as a ") + name(info.layout) + " (" + info.layout_reason +
                              "), and a view of a " + wanted + " was asked for; read it with that layout");
}

}  // namespace

int Environment::face_size() const noexcept { return codec::face_size(info.layout, info.width, info.height); }

LatLongView Environment::lat_long() const {
  if (info.layout != Layout::lat_long) refuse_view(info, "lat-long");
  return {pixels.get(), info.width, info.height, 0, PixelFormat::rgb_f32};
}

CubemapView Environment::cubemap() const {
  const int size = face_size();
  if (size == 0) refuse_view(info, "cubemap");
  const std::size_t face_floats = static_cast<std::size_t>(codec::rgb_bytes(size, size)) / sizeof(float);
  CubemapView view{{}, size, 0, PixelFormat::rgb_f32};
  for (std::size_t face = 0; face < view.faces.size(); ++face) {
    view.faces[face] = pixels.get() + face * face_floats;
  }
  return view;
}

}  // namespace welkin
