// A graph's tasks without oneTBB: the thread that waits for them runs them in order.
#include <deque>
#include <functional>
#include <memory>
#include <utility>

#include "jobs/backend.h"

namespace welkin::jobs::backend {

void isolate(Call<> work) { work(); }

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
