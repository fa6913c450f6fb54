#include "environments.h"

#include <welkin/environment_file.h>
#include <welkin/sky.h>

#include <algorithm>
#include <memory>

#include "tools/test_map.h"

namespace engine_loop {

std::vector<std::filesystem::path> environments_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::is_directory(folder)) return files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::filesystem::path extension = entry.path().extension();
    if (extension == ".exr" || extension == ".hdr") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::filesystem::path> write_environments(const std::filesystem::path& folder, int height) {
  std::filesystem::create_directories(folder);
  std::vector<std::filesystem::path> files;
  const auto write = [&](const char* name, const auto& image, const welkin::WriteOptions& options = {}) {
    files.push_back(folder / name);
    welkin::write_environment(files.back(), image.view(), options);
  };
  const int half = std::max(1, height / 2);
  // An afternoon of Earth; small tables will do.
  welkin::SkyTableOptions tables;
  tables.heights = 8;
  tables.view_zeniths = 64;
  tables.sun_zeniths = 16;
  const welkin::SkyView view(std::make_shared<const welkin::SkyTables>(welkin::precompute_sky(welkin::earth(), tables)),
                             0.0);
  const glm::dvec3 sun = welkin::sun_direction(40.0, 25.0);
  const welkin::LatLongImage sky = welkin::sky_lat_long(view, sun, height, {.sun_disc = true});
  write("sky.exr", sky);
  write("sky_float.exr", sky, {welkin::Layout::automatic, welkin::SampleType::float32});
  write("sky.hdr", sky);
  write("small_sky.hdr", welkin::sky_lat_long(view, sun, half, {.sun_disc = true}));
  write("test_map.exr", welkin::test_map_lat_long(2 * half, half));
  write("test_map_faces.exr", welkin::test_map_cubemap(half));
  return files;
}

}  // namespace engine_loop
