// The loop: frames that begin at fixed times, 60 per second; and what a run of it was like, in figures.
#pragma once

#include <pthread.h>
#include <sched.h>
#include <tbb/task_scheduler_observer.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
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

// Runs as a table, as a file with a line per frame, and as an image by gnuplot.

/// Returns the smallest value that at least this share of all are not above (nearest rank); 0 of none.
inline double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

inline std::vector<double> frame_times(const Run& run) {
  std::vector<double> times;
  for (const Frame& frame : run.frames) times.push_back(frame.total);
  return times;
}

inline auto missed(const std::vector<double>& times) {
  return std::count_if(times.begin(), times.end(), [](double time) { return time > kFrame_ms; });
}

/// Returns a line per run. The first is the one with which the others are compared.
inline std::string table(const std::vector<Run>& runs) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  text << "               frame time, ms                               light\n"
          "run            frames     50 %    99 %     max  missed  99 % /base  done  replaced      MB  ms 50 %   ms "
          "max\n";
  for (const Run& run : runs) {
    const std::vector<double> times = frame_times(run);
    text << std::left << std::setw(14) << run.name << std::right << std::setw(7) << times.size();
    for (const double share : {0.5, 0.99, 1.0}) text << std::setw(8) << percentile(times, share);
    text << std::setw(8) << missed(times) << std::setw(9)
         << percentile(times, 0.99) / percentile(frame_times(runs.front()), 0.99);
    if (!run.baked.empty()) {
      std::vector<double> latencies;
      std::uint64_t texels = 0;
      for (const Baked& one : run.baked) {
        texels += one.texels;
        if (one.radiance) latencies.push_back(one.latency_ms);
      }
      text << std::setw(9) << latencies.size() << std::setw(10) << run.baked.size() - latencies.size() << std::setw(8)
           << texels * 12 / 1'000'000;  // as RGB floats
      for (const double share : {0.5, 1.0}) text << std::setw(9) << percentile(latencies, share);
    }
    text << '\n';
  }
  return text.str();
}

/// Writes a line per frame, after one that names the columns. Throws std::ios_base::failure.
inline void write_csv(const std::filesystem::path& path, const std::vector<Run>& runs) {
  std::ofstream file;
  file.exceptions(std::ios::failbit | std::ios::badbit);
  file.open(path);
  file << std::fixed << std::setprecision(4) << "run,frame,total_ms,wake_ms,work_ms,collect_ms,ask_ms\n";
  for (const Run& run : runs) {
    int number = 0;
    for (const auto& [total, wake, work, collect, ask] : run.frames) {
      file << run.name << ',' << number++ << ',' << total << ',' << wake << ',' << work << ',' << collect << ',' << ask
           << '\n';
    }
  }
  file.close();
}

/// Draws frame time over frame number by gnuplot, one panel for each run, from the file that `write_csv` wrote. Panels
/// share their axes; time is logarithmic, or the longest frame would press all others flat. Returns false if that did
/// not work, as where there is no gnuplot.
inline bool draw_plot(const std::filesystem::path& csv, const std::filesystem::path& png,
                      const std::vector<Run>& runs) {
  const auto quoted = [](const std::string& text) {  // inside single quotes only these themselves are special
    std::string result = "'";
    for (const char letter : text) result += letter == '\'' ? "''" : std::string(1, letter);
    return result + "'";
  };
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << "csv = " << quoted(csv.string()) << "\nset output "
       << quoted(png.string()) << "\nset terminal png noenhanced size 1200," << 60 + 270 * runs.size() << R"( font ',11'
set datafile separator ','
set key off
stats csv using 2:3 every ::1 name 'all' nooutput
set xrange [-1:all_max_x + 1]
set logscale y 2
set yrange [(all_min_y < 5 ? 0.8 * all_min_y : 4):(all_max_y > 32 ? 1.3 * all_max_y : 40)]
set ytics (1, 2, 4, 8, 16.67, 32, 64, 128, 256, 512)
set grid ytics linecolor rgb '#dddddd'
set lmargin 8
set rmargin 3
set multiplot layout )"
       << runs.size() << ",1 title 'Time of each frame, ms. Above the line (16.67) it is missed.'\n";
  for (const Run& run : runs) {
    const std::vector<double> times = frame_times(run);
    text << "set title '" << run.name << ": 50 % of the frames within " << percentile(times, 0.5) << " ms, 99 % within "
         << percentile(times, 0.99) << " ms; " << missed(times) << " missed' offset 0,-0.6\n"
         << (&run == &runs.back() ? "set xlabel 'frame'\n" : "") << "plot csv using (strcol(1) eq '" << run.name
         << "' ? $2 : NaN):3 every ::1 with points pointtype 7 pointsize 0.6 linecolor rgb '#1f5fa8', "
            "1000.0 / 60.0 with lines linewidth 1.5 linecolor rgb '#c0392b'\n";
  }
  text << "unset multiplot\n";
  std::FILE* gnuplot = popen("gnuplot", "w");
  if (gnuplot == nullptr) return false;
  const bool written = std::fputs(text.str().c_str(), gnuplot) >= 0;
  return pclose(gnuplot) == 0 && written;
}

}  // namespace engine_loop
