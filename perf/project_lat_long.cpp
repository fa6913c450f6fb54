#include "project_lat_long.h"

#include "subjects.h"
#include "welkin/projection.h"

namespace welkin::perf {

void add_project_lat_long(const std::vector<int>& thread_counts) {
  constexpr int width = 4096;
  constexpr int height = 2048;
  constexpr double texels = 1.0 * width * height;
  for (const PixelFormat format : {PixelFormat::rgb32f, PixelFormat::rgba32f, PixelFormat::rgba16f}) {
    for (const int threads : thread_counts) {
      add_benchmark("ProjectLatLong", name(format), "4096x2048", threads, texels,
                    texels * static_cast<double>(bytes_per_texel(format)), [=]() -> std::function<void()> {
                      const LatLongView view = noise_lat_long(format, width, height);
                      return [=] { benchmark::DoNotOptimize(project(view)); };
                    });
    }
  }
}

}  // namespace welkin::perf
