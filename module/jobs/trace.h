// What a call does, taken down while one thread does it: which work could run side by side, and how long each part of
// it takes. From that perf computes how long the call would take on any number of threads.
#pragma once

#include <chrono>
#include <cstddef>
#include <typeinfo>
#include <vector>

namespace welkin::jobs {

struct TracedRegion;

/// A piece of work that one thread does from its start to its end: serial stretches with parallel regions between them.
struct TracedWork {
  /// Serial work, and the region that comes after it, if one does.
  struct Stretch {
    double seconds = 0.0;
    std::vector<TracedRegion> region;  ///< one or none
  };
  std::vector<Stretch> stretches;
};

/// Pieces of work that may run at the same time: tiles, or the passes of a graph.
struct TracedRegion {
  const std::type_info* what = nullptr;         ///< the type of the function that tiles call; of a graph null
  std::vector<TracedWork> parts;                ///< in the order of their numbers
  std::vector<std::vector<std::size_t>> after;  ///< of a graph: what each part waits for
};

/// As long as it lives, what the calling thread does is taken down. The work must stay on this thread: give it an arena
/// for one. Not within another. Costs two readings of the clock a tile, and memory for each: if there is none, the
/// program ends, for it is told where tiles end.
class TraceRecording {
 public:
  TraceRecording();
  ~TraceRecording();
  TraceRecording(const TraceRecording&) = delete;
  TraceRecording& operator=(const TraceRecording&) = delete;

  /// All since it was made.
  [[nodiscard]] TracedWork finish();

 private:
  friend class TracedRegionScope;
  friend class TracedPartScope;

  /// Ends the stretch of serial work that runs.
  void end_stretch();

  using Clock = std::chrono::steady_clock;

  TracedWork whole_;
  std::vector<TracedWork*> inside_;     ///< of what work the present one is a part, outermost first
  std::vector<TracedRegion*> regions_;  ///< likewise the regions
  Clock::time_point stretch_began_;
};

/// Around a region; without a recording it does nothing.
class TracedRegionScope {
 public:
  TracedRegionScope(const std::type_info* what, std::size_t parts);
  ~TracedRegionScope();
  TracedRegionScope(const TracedRegionScope&) = delete;
  TracedRegionScope& operator=(const TracedRegionScope&) = delete;

  /// Of a graph, before its parts begin.
  void set_waits(std::size_t part, std::size_t for_part);

 private:
  TraceRecording* recording_;
};

/// Around a part of the innermost region.
class TracedPartScope {
 public:
  explicit TracedPartScope(std::size_t part);
  ~TracedPartScope();
  TracedPartScope(const TracedPartScope&) = delete;
  TracedPartScope& operator=(const TracedPartScope&) = delete;

 private:
  TraceRecording* recording_;
};

}  // namespace welkin::jobs
