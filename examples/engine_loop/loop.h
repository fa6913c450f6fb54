// The loop: frames that begin at fixed times, 60 per second; and what a run of it was like.
#pragma once

#include <pthread.h>
#include <sched.h>
#include <tbb/task_scheduler_observer.h>

#include <atomic>
#include <cstring>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bakers.h"

namespace engine_loop {

constexpr double kFrame_ms = 1000.0 / 60.0;

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

inline Frame run_frame(Clock::time_point tick, int number, FrameWork& work, std::vector<Posting> postings,
                       Baker& baker) {
  auto lap_ms = [last = tick]() mutable {
    const Clock::time_point now = Clock::now();
    return milliseconds(now - std::exchange(last, now));
  };
  Frame frame;
  std::this_thread::sleep_until(tick);
  frame.wake = lap_ms();
  work.run(static_cast<float>(number * kFrame_ms / 1000.0));
  frame.work = lap_ms();
  baker.collect();
  frame.collect = lap_ms();
  // Last of all: a thread of the worker that is woken now has the rest of the frame's time for itself. Woken before the
  // frame's work, it would be in that work's way.
  for (Posting& posting : postings) baker.ask(std::move(posting));
  frame.ask = lap_ms();
  frame.total = frame.wake + frame.work + frame.collect + frame.ask;
  return frame;
}

/// Runs all frames of the schedule; then waits for the light that is still to come. A frame that takes too long leaves
/// the next one to begin at the next tick that is left, as with a display that shows 60 images per second.
inline Run run_loop(std::string name, FrameWork& work, Schedule schedule, Baker& baker) {
  constexpr std::chrono::nanoseconds kPeriod(16'666'667);
  constexpr int kWarmUpFrames = 30;
  const auto next_tick = [&](Clock::time_point tick) { return tick + kPeriod * ((Clock::now() - tick) / kPeriod + 1); };
  const auto frames = static_cast<int>(schedule.frames.size());
  Run run{std::move(name), {}, std::move(schedule.keys), {}};
  Clock::time_point tick = next_tick(Clock::now());
  for (int frame = -kWarmUpFrames; frame < frames; ++frame, tick = next_tick(tick)) {
    std::vector<Posting> postings;
    if (frame >= 0) postings = std::move(schedule.frames[static_cast<std::size_t>(frame)]);
    const Frame times = run_frame(tick, frame + kWarmUpFrames, work, std::move(postings), baker);
    if (frame >= 0) run.frames.push_back(times);
  }
  baker.finish();
  run.baked = baker.baked();
  return run;
}

/// Compares a run's light with the synchronous calls' bit by bit, and returns what is wrong, or nothing. Only light
/// that has a key may have been replaced, and never the last one of a key.
inline std::string difference(const Run& synchronous, const Run& run) {
  const std::size_t count = run.keys.size();
  if (synchronous.baked.size() != count || run.baked.size() != count) return "not all requests have an outcome";
  for (std::size_t number = 0; number < count; ++number) {
    const std::string name = "request " + std::to_string(number);
    const auto& expected = synchronous.baked[number].radiance;
    const auto& light = run.baked[number].radiance;
    if (!expected) return name + " has no synchronous result";
    if (!light) {
      const auto newer = run.keys.begin() + static_cast<std::ptrdiff_t>(number) + 1;
      const std::string& key = run.keys[number];
      if (key.empty() || std::find(newer, run.keys.end(), key) == run.keys.end()) return name + " was lost";
      continue;
    }
    const auto left = expected->coefficients(), right = light->coefficients();
    if (left.size() != right.size() || std::memcmp(left.data(), right.data(), left.size_bytes()) != 0) {
      return name + " differs";
    }
  }
  return {};
}

/// Ranks each thread as SCHED_RR, priority 1, from when it enters an arena until it leaves. Linux gives that to root,
/// to CAP_SYS_NICE, or to users whose RLIMIT_RTPRIO allows it.
class RealTime final : public tbb::task_scheduler_observer {
 public:
  explicit RealTime(tbb::task_arena& arena) : tbb::task_scheduler_observer(arena) { observe(true); }
  ~RealTime() override { observe(false); }
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  void on_scheduler_entry(bool) override {
    if (!rank(SCHED_RR, 1)) refused_ = true;
  }
  void on_scheduler_exit(bool) override { rank(SCHED_OTHER, 0); }

  [[nodiscard]] bool refused() const noexcept { return refused_; }

 private:
  static bool rank(int policy, int priority) {
    sched_param parameter{};
    parameter.sched_priority = priority;
    return pthread_setschedparam(pthread_self(), policy, &parameter) == 0;
  }

  std::atomic<bool> refused_{false};
};

}  // namespace engine_loop
