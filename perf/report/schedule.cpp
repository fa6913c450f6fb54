#include "perf/report/schedule.h"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace welkin::report {
namespace {

using jobs::TracedRegion;
using jobs::TracedWork;

/// Of each part of a graph, the longest way from its start to the graph's end; of tiles, what each takes.
std::vector<double> ways(const TracedRegion& region) {
  std::vector<double> way;
  for (const TracedWork& part : region.parts) way.push_back(critical_path_seconds(part));
  const std::vector<double> own = way;
  for (std::size_t part = region.after.size(); part-- > 0;) {  // a part waits for earlier ones only
    for (const std::size_t earlier : region.after[part])
      way[earlier] = std::max(way[earlier], own[earlier] + way[part]);
  }
  return way;
}

/// Work that has begun, or waits to.
struct Task {
  const TracedWork* work;
  Task* parent = nullptr;
  std::size_t part = 0;              ///< which of the parent's region
  std::size_t stretch = 0;           ///< that runs, or runs next
  std::size_t left = 0;              ///< parts of its region that have not ended
  std::vector<std::size_t> waits{};  ///< of a graph: how many parts each part still waits for
  std::vector<Task*> parts{};
};

class Simulation {
 public:
  Simulation(const TracedWork& work, int workers) : free_(workers) { ready_.push_back(add(work, nullptr, 0)); }

  double run() {
    while (true) {
      for (; free_ > 0 && !ready_.empty(); --free_) begin_next();
      if (running_.empty()) return now_;
      const auto [end, task] = running_.top();
      running_.pop();
      now_ = end;
      ++free_;
      end_stretch(*task);
    }
  }

 private:
  Task* add(const TracedWork& work, Task* parent, std::size_t part) {
    tasks_.push_back({&work, parent, part});
    return &tasks_.back();
  }

  void begin_next() {
    Task* const task = ready_.back();
    ready_.pop_back();
    const double seconds =
        task->stretch < task->work->stretches.size() ? task->work->stretches[task->stretch].seconds : 0;
    running_.push({now_ + seconds, task});
  }

  void end_stretch(Task& task) {
    if (task.stretch < task.work->stretches.size()) {
      const auto& region = task.work->stretches[task.stretch].region;
      if (!region.empty() && !region.front().parts.empty()) {
        open(task, region.front());
        return;
      }
    }
    go_on(task);
  }

  /// Parts become ready so that the one to begin first is the last of the list.
  void open(Task& task, const TracedRegion& region) {
    task.left = region.parts.size();
    task.waits.clear();
    task.parts.clear();
    for (std::size_t part = 0; part < region.parts.size(); ++part) {
      task.waits.push_back(region.after.empty() ? 0 : region.after[part].size());
      task.parts.push_back(add(region.parts[part], &task, part));
    }
    std::vector<std::size_t> free_parts;
    for (std::size_t part = 0; part < task.parts.size(); ++part) {
      if (task.waits[part] == 0) free_parts.push_back(part);
    }
    const std::vector<double> way = region.after.empty() ? std::vector<double>() : ways(region);
    std::reverse(free_parts.begin(), free_parts.end());
    if (!way.empty()) {
      std::stable_sort(free_parts.begin(), free_parts.end(),
                       [&](std::size_t a, std::size_t b) { return way[a] < way[b]; });
    }
    for (const std::size_t part : free_parts) ready_.push_back(task.parts[part]);
  }

  void go_on(Task& task) {
    if (++task.stretch < task.work->stretches.size()) {
      ready_.push_back(&task);
      return;
    }
    if (task.parent != nullptr) end_part(*task.parent, task.part);
  }

  void end_part(Task& parent, std::size_t ended) {
    const TracedRegion& region = parent.work->stretches[parent.stretch].region.front();
    for (std::size_t part = 0; part < region.after.size(); ++part) {
      for (const std::size_t earlier : region.after[part]) {
        if (earlier == ended && --parent.waits[part] == 0) ready_.push_back(parent.parts[part]);
      }
    }
    if (--parent.left == 0) go_on(parent);
  }

  using Running = std::pair<double, Task*>;

  std::deque<Task> tasks_;  // whose addresses stay
  std::vector<Task*> ready_;
  std::priority_queue<Running, std::vector<Running>, std::greater<>> running_;
  int free_;
  double now_ = 0.0;
};

}  // namespace

double scheduled_seconds(const TracedWork& work, int workers) { return Simulation(work, workers).run(); }

double critical_path_seconds(const TracedWork& work) {
  double sum = 0.0;
  for (const TracedWork::Stretch& stretch : work.stretches) {
    sum += stretch.seconds;
    for (const TracedRegion& region : stretch.region) {
      const std::vector<double> way = ways(region);
      sum += way.empty() ? 0.0 : *std::max_element(way.begin(), way.end());
    }
  }
  return sum;
}

std::vector<std::size_t> longest_way(const TracedRegion& region) {
  const std::vector<double> way = ways(region);
  std::vector<std::size_t> parts;
  if (way.empty()) return parts;
  parts.push_back(static_cast<std::size_t>(std::max_element(way.begin(), way.end()) - way.begin()));
  const auto waits_for = [&](std::size_t part, std::size_t earlier) {
    const std::vector<std::size_t>& after = region.after[part];
    return std::find(after.begin(), after.end(), earlier) != after.end();
  };
  for (bool longer = !region.after.empty(); longer;) {
    longer = false;
    std::size_t next = 0;
    for (std::size_t part = parts.back() + 1; part < way.size(); ++part) {
      if (!waits_for(part, parts.back()) || (longer && way[part] <= way[next])) continue;
      next = part;
      longer = true;
    }
    if (longer) parts.push_back(next);
  }
  return parts;
}

}  // namespace welkin::report
