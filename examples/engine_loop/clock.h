// The one clock that all is measured with.
#pragma once

#include <chrono>

namespace engine_loop {

using Clock = std::chrono::steady_clock;

[[nodiscard]] inline double milliseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace engine_loop
