// Where there is one thread: all work is done by whoever asks for it, in order.
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "jobs/backend.h"
#include "jobs/tiles.h"
#include "welkin/core.h"

namespace welkin::jobs::backend {

int concurrency() noexcept { return 1; }

void isolate(Call<> work) { work(); }

void loop(std::size_t count, Call<std::size_t> part) {
  for (std::size_t index = 0; index < count; ++index) part(index);
}

struct TaskGroup::Tasks {
  std::deque<std::function<void()>> waiting;
};

TaskGroup::TaskGroup() : tasks_(std::make_unique<Tasks>()) {}
TaskGroup::~TaskGroup() = default;

void TaskGroup::run(std::function<void()> task) { tasks_->waiting.push_back(std::move(task)); }

void TaskGroup::wait() {
  while (!tasks_->waiting.empty()) {
    const std::function<void()> task = std::move(tasks_->waiting.front());
    tasks_->waiting.pop_front();
    task();
  }
}

}  // namespace welkin::jobs::backend

namespace welkin {

int available_threads() { return 1; }

void run_with_threads(int threads, const std::function<void()>& work) {
  jobs::require_thread_count(threads);
  work();
}

}  // namespace welkin
