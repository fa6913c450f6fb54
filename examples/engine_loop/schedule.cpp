#include "schedule.h"

#include <utility>

#include "welkin/bake_file.h"

namespace engine_loop {
namespace {

constexpr int kFramesPerSky = 3;
constexpr int kFramesPerFile = 12;
constexpr int kLevels = 3;
constexpr int kCubemapsPerLevel = 3;
constexpr double kSunStep = 0.01;  // radians a frame

}  // namespace

Schedule::Schedule(const ScheduleOptions& options) : frames_(static_cast<std::size_t>(options.frames)) {
  int level = 0;
  for (int frame = 0; frame < options.frames; ++frame) {
    if (frame % kFramesPerSky == 0) add(frame, TurningSky{options.sky_size, kSunStep * frame}, "sky");
    if (frame % kFramesPerFile == 0) {
      const auto file = static_cast<std::size_t>(frame / kFramesPerFile) % options.files.size();
      add(frame, welkin::ProjectFile{options.files[file]});
    }
    // In the middle of each third of the run.
    if (frame == (2 * level + 1) * options.frames / (2 * kLevels)) {
      for (int cubemap = 0; cubemap < kCubemapsPerLevel; ++cubemap) {
        add(frame, welkin::Project{sky_cubemap(options.level_size, 1.0 * level + 0.3 * cubemap)});
      }
      ++level;
    }
  }
}

std::vector<Posting> Schedule::take(int frame) { return std::move(frames_[static_cast<std::size_t>(frame)]); }

void Schedule::add(int frame, Request request, std::string key) {
  keys_.push_back(key);
  frames_[static_cast<std::size_t>(frame)].push_back({keys_.size() - 1, std::move(key), std::move(request)});
}

}  // namespace engine_loop
