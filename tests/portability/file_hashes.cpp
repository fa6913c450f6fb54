// Prints hashes of the formats that need no third-party codec in welkin::files: `file_hashes`. See core_hashes.cpp.
#include <cstddef>
#include <string>
#include <vector>

#include "portability/hashing.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"

namespace welkin::portability {
namespace {

std::vector<std::byte> written(const std::string& name, const LatLongImage& image) {
  std::vector<std::byte> bytes;
  write_environment({bytes, name}, image.view());
  return bytes;
}

void images() {
  for (const int size : kSizes) {
    for (const char* extension : {".hdr", ".pfm"}) {
      const std::string name = std::string("image") + extension;
      const std::vector<std::byte> file = written(name, lat_long(size, 21));
      const Environment read = read_environment({file, name}, {.layout = Layout::lat_long});
      const std::vector<float> pixels(read.pixels.get(), read.pixels.get() + 6 * size * size);
      print(sized("files/written", size) + extension, file);
      print(sized("files/read", size) + extension, pixels);
      print(sized("files/projected", size) + extension,
            project_file({file, name}, {.layout = Layout::lat_long}).radiance);
    }
  }
}

void bakes() {
  const std::vector<std::byte> file = written("sky.hdr", lat_long(64, 22));
  const BakeResult light = bake_file({file, "sky.hdr"}, {}, {.specular = PrefilterOptions{.size = 32}});
  print("files/bake", light.specular->cubemap, *light.radiance, light.irradiance->pixels());
  std::vector<std::byte> texture;
  write_texture({texture, "sky.ktx2"}, light.specular->cubemap.views(), {.format = TexelFormat::e5b9g9r9});
  print("files/ktx2", texture);
}

}  // namespace
}  // namespace welkin::portability

int main() {
  welkin::portability::images();
  welkin::portability::bakes();
}
