// The light that is asked for in each frame. The same for every run, so that none can win by doing less.
#pragma once

#include <tbb/parallel_for.h>
#include <welkin/bake_file.h>
#include <welkin/environment_file.h>
#include <welkin/requests.h>
#include <welkin/sky.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "../probes/cube_frames.h"
#include "tools/test_map.h"

namespace engine_loop {

/// Returns a cubemap of a blue gradient, dark ground and a small bright sun half-way up, turned about the vertical by
/// `sun_angle` (radians). Cost: 10 ns per texel, in the caller's arena.
inline welkin::Cubemap sky_cubemap(int size, double sun_angle) {
  const auto angle = static_cast<float>(sun_angle);
  const glm::vec3 sun = glm::normalize(glm::vec3(std::sin(angle), 1.0F, std::cos(angle)));
  const auto radiance = [&](const glm::vec3& direction) {
    if (direction.y < 0.0F) return glm::vec3(0.1F, 0.09F, 0.08F);
    float lobe = std::max(glm::dot(direction, sun), 0.0F);
    for (int i = 0; i < 9; ++i) lobe *= lobe;  // x^512: some three degrees wide
    return glm::mix(glm::vec3(0.8F, 0.9F, 1.0F), glm::vec3(0.2F, 0.4F, 1.0F), direction.y) +
           lobe * glm::vec3(900.0F, 800.0F, 600.0F);
  };
  welkin::Cubemap image(size);
  tbb::parallel_for(0, 6 * size, [&](int row) {
    float* texel = image.face(0) + std::ptrdiff_t{3} * size * row;
    for (int column = 0; column < size; ++column) {
      const glm::vec3 rgb = radiance(glm::vec3(cube_frames::direction_of(row / size, column, row % size, size)));
      texel = std::copy_n(&rgb[0], 3, texel);
    }
  });
  return image;
}

/// The light of such a sky. A request of the engine's own making: any callable over Welkin's calls is one.
struct TurningSky {
  int size = 256;
  double sun_angle = 0.0;  ///< radians

  [[nodiscard]] welkin::Projection operator()(const welkin::Control& control) const {
    return welkin::project(sky_cubemap(size, sun_angle).view(), {}, control);
  }
};

/// Returns the .exr and .hdr files of a folder, by name; none if it is not there.
inline std::vector<std::filesystem::path> environments_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::is_directory(folder)) return files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::filesystem::path extension = entry.path().extension();
    if (extension == ".exr" || extension == ".hdr") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Writes skies and test maps of several sizes and formats to a folder, for users who have no files. `height` is that
/// of the largest lat-long, in texels.
inline std::vector<std::filesystem::path> write_environments(const std::filesystem::path& folder, int height) {
  std::filesystem::create_directories(folder);
  std::vector<std::filesystem::path> files;
  const auto write = [&](const char* name, const auto& image, const welkin::WriteOptions& options = {}) {
    files.push_back(folder / name);
    welkin::write_environment(files.back(), image.view(), options);
  };
  const welkin::SkyTableOptions small{.heights = 8, .view_zeniths = 64, .sun_zeniths = 16};
  const welkin::SkyView view(std::make_shared<const welkin::SkyTables>(welkin::precompute_sky(welkin::earth(), small)),
                             0.0);
  const int half = std::max(1, height / 2);
  const auto sky = [&](int rows) {
    return welkin::sky_lat_long(view, welkin::sun_direction(40.0, 25.0), rows, {.sun_disc = true});
  };
  write("sky.exr", sky(height));
  write("sky_float.exr", sky(height), {welkin::Layout::automatic, welkin::SampleType::float32});
  write("sky.hdr", sky(height));
  write("small_sky.hdr", sky(half));
  write("test_map.exr", welkin::test_map_lat_long(2 * half, half));
  write("test_map_faces.exr", welkin::test_map_cubemap(half));
  return files;
}

/// A file that is streamed in, the changing sky, or pixels that are in memory and are moved in.
using Request = std::variant<welkin::ProjectFile, TurningSky, welkin::Project>;

struct Posting {
  std::size_t number = 0;  ///< from 0, in the order of posting
  std::string key;         ///< of requests of which only the newest counts; else empty
  Request request;
};

struct ScheduleOptions {
  int frames = 600;
  int sky_size = 256;     ///< edge of the changing cubemap, texels
  int level_size = 1024;  ///< edge of a level's cubemaps, texels
  std::vector<std::filesystem::path> files;
};

/// A new sun every third frame, a file every twelfth, and in the middle of each third of a run a level that brings
/// three large cubemaps at once: about 0.3 s of one processor's time per second, levels apart.
struct Schedule {
  std::vector<std::vector<Posting>> frames;
  std::vector<std::string> keys;  ///< of all postings, by number

  /// Makes the levels' pixels, too: nine cubemaps, 680 MB with 1024 texels per edge.
  explicit Schedule(const ScheduleOptions& options) : frames(static_cast<std::size_t>(options.frames)) {
    for (int frame = 0, level = 0; frame < options.frames; ++frame) {
      const auto add = [&](Request request, std::string key = {}) {
        keys.push_back(key);
        frames[static_cast<std::size_t>(frame)].push_back({keys.size() - 1, std::move(key), std::move(request)});
      };
      if (frame % 3 == 0) add(TurningSky{options.sky_size, 0.01 * frame}, "sky");
      if (frame % 12 == 0) {
        add(welkin::ProjectFile{options.files[static_cast<std::size_t>(frame / 12) % options.files.size()]});
      }
      if (frame == (2 * level + 1) * options.frames / 6) {
        for (int cubemap = 0; cubemap < 3; ++cubemap) {
          add(welkin::Project{sky_cubemap(options.level_size, level + 0.3 * cubemap)});
        }
        ++level;
      }
    }
  }
};

}  // namespace engine_loop
