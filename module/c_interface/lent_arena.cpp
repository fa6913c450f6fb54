#include "c_interface/lent_arena.h"

#include <memory>
#include <utility>

namespace welkin::c_interface {
namespace {

using Task = std::function<void()>;

/// What the engine calls: once, so the task goes with it. Nothing may be thrown into the engine.
void run_task(void* argument) noexcept {
  const std::unique_ptr<Task> task(static_cast<Task*>(argument));
  try {
    (*task)();
  } catch (
      ...) {  // NOLINT(bugprone-empty-catch): a worker's tasks throw nothing; what requests throw is in the futures
  }
}

}  // namespace

std::function<void(Task)> lent_arena(decltype(welkin_worker_options::enqueue) enqueue, void* user) {
  if (enqueue == nullptr) return {};
  return [enqueue, user](Task task) {
    auto argument = std::make_unique<Task>(std::move(task));
    enqueue(user, &run_task, argument.release());
  };
}

}  // namespace welkin::c_interface
