// The loop: frames that begin at fixed times, 60 a second.
#pragma once

#include <string>
#include <vector>

#include "baker.h"
#include "frame_work.h"
#include "schedule.h"

namespace engine_loop {

inline constexpr double kFrame_ms = 1000.0 / 60.0;

/// One frame's times, in milliseconds.
struct Frame {
  double total = 0.0;    ///< from the time at which it should begin to the end of its work; over kFrame_ms: missed
  double wake = 0.0;     ///< of that: until the thread was awake
  double work = 0.0;     ///< the engine's own work
  double collect = 0.0;  ///< taking the light that is there
  double ask = 0.0;      ///< asking for more
};

struct Run {
  std::string name;
  std::vector<Frame> frames;
  std::vector<std::string> keys;  ///< of all that was asked for, by number
  std::vector<Baked> baked;       ///< by number; empty without any baking
};

/// Runs all frames of the schedule; then waits for the light that is still to come. A frame that takes too long
/// leaves the next one to begin at the next tick that is left, as with a display that shows 60 pictures a second.
[[nodiscard]] Run run_loop(std::string name, int frames, FrameWork& work, Schedule schedule, Baker& baker);

}  // namespace engine_loop
