#include "loop.h"

#include <chrono>
#include <thread>
#include <utility>

namespace engine_loop {
namespace {

constexpr std::chrono::nanoseconds kPeriod(16'666'667);
constexpr int kWarmUpFrames = 30;

/// Measures the stretches between its calls.
class Stopwatch {
 public:
  explicit Stopwatch(Clock::time_point start) : last_(start) {}

  double lap_ms() {
    const Clock::time_point now = Clock::now();
    return milliseconds(now - std::exchange(last_, now));
  }

 private:
  Clock::time_point last_;
};

/// The tick after `tick` that is still to come.
Clock::time_point next_tick(Clock::time_point tick) {
  const auto late = Clock::now() - tick;
  return tick + kPeriod * (late / kPeriod + 1);
}

Frame run_frame(Clock::time_point tick, int number, FrameWork& work, std::vector<Posting> postings, Baker& baker) {
  Frame frame;
  std::this_thread::sleep_until(tick);
  Stopwatch watch(tick);
  frame.wake = watch.lap_ms();
  work.run(static_cast<float>(number) * static_cast<float>(kFrame_ms / 1000.0));
  frame.work = watch.lap_ms();
  baker.collect();
  frame.collect = watch.lap_ms();
  // Last of all: a thread of the worker that is woken now has the rest of the frame's time for itself. Woken before the
  // frame's work, it would be in that work's way.
  for (Posting& posting : postings) baker.ask(std::move(posting));
  frame.ask = watch.lap_ms();
  frame.total = frame.wake + frame.work + frame.collect + frame.ask;
  return frame;
}

}  // namespace

Run run_loop(std::string name, int frames, FrameWork& work, Schedule schedule, Baker& baker) {
  Run run{std::move(name), {}, schedule.keys(), {}};
  run.frames.reserve(static_cast<std::size_t>(frames));
  Clock::time_point tick = next_tick(Clock::now());
  for (int frame = -kWarmUpFrames; frame < frames; ++frame, tick = next_tick(tick)) {
    const bool counts = frame >= 0;
    const Frame times =
        run_frame(tick, frame + kWarmUpFrames, work, counts ? schedule.take(frame) : std::vector<Posting>{}, baker);
    if (counts) run.frames.push_back(times);
  }
  baker.finish();
  run.baked = baker.baked();
  return run;
}

}  // namespace engine_loop
