// Work on oneTBB's threads, and an arena for programs that have none, as wide as the process may really run.
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "jobs/backend.h"
#include "jobs/tiles.h"
#include "platform/thread.h"
#include "platform/wait.h"
#include "welkin/core.h"

namespace welkin::jobs::backend {

int concurrency() noexcept { return std::max(1, tbb::this_task_arena::max_concurrency()); }

void isolate(Call<> work) {
  tbb::this_task_arena::isolate([&] { work(); });
}

void loop(std::size_t count, Call<std::size_t> part) {
  tbb::task_group_context own_group(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t index = range.begin(); index != range.end(); ++index) part(index);
        },
        own_group);
  });
}

struct TaskGroup::Tasks {
  tbb::task_group_context context{tbb::task_group_context::isolated};
  tbb::task_group group{context};
};

TaskGroup::TaskGroup() : tasks_(std::make_unique<Tasks>()) {}
TaskGroup::~TaskGroup() = default;

void TaskGroup::run(std::function<void()> task) { tasks_->group.run(std::move(task)); }

void TaskGroup::wait() { tasks_->group.wait(); }

}  // namespace welkin::jobs::backend

namespace welkin {
namespace {

/// Threads of our own that take part in the parallel work of an arena until this object goes. oneTBB's own would end
/// the process where the system refuses to make one; of ours there are fewer then.
class Helpers {
 public:
  Helpers(tbb::task_arena& arena, int wanted) {
    const detail::AddressReserve reserve(detail::kRoomForWork);
    if (!reserve.held()) return;
    helpers_.reserve(static_cast<std::size_t>(wanted));
    try {
      while (static_cast<int>(helpers_.size()) < wanted) make_one(arena);
    } catch (const std::system_error&) {  // no thread
    } catch (const std::bad_alloc&) {     // no memory for one
    }
    // Each helper allocates what it needs to enter the arena while the reserve is held.
    for (const std::unique_ptr<Helper>& helper : helpers_) platform::wait_while(helper->settled, false);
  }
  ~Helpers() {
    for (const std::unique_ptr<Helper>& helper : helpers_) helper->blocker = tbb::task_handle();
    for (const std::unique_ptr<Helper>& helper : helpers_) helper->thread.join();
  }
  Helpers(const Helpers&) = delete;
  Helpers& operator=(const Helpers&) = delete;

 private:
  struct Helper {
    tbb::task_group group;
    tbb::task_handle blocker;  ///< the group's wait ends when this goes
    std::atomic<bool> settled{false};
    std::thread thread;

    void settle() {
      settled = true;
      platform::wake_all(settled);
    }
    ~Helper() {
      blocker = tbb::task_handle();
      group.wait();  // which a group that no thread has waited for wants
    }
    Helper() : blocker(group.defer([] {})) {}
    Helper(const Helper&) = delete;
    Helper& operator=(const Helper&) = delete;
  };

  void make_one(tbb::task_arena& arena) {
    auto helper = std::make_unique<Helper>();
    helper->thread = std::thread([&arena, &one = *helper] { help(arena, one); });
    helpers_.push_back(std::move(helper));  // for which there is room
  }

  /// Waiting in the arena, a thread runs the tasks that others spawn there, and sleeps while there are none.
  static void help(tbb::task_arena& arena, Helper& helper) noexcept {
    try {
      arena.execute([&helper] {
        helper.settle();
        helper.group.wait();
      });
    } catch (const std::exception&) {  // no memory to enter the arena with: one thread fewer
      helper.settle();
    }
  }

  std::vector<std::unique_ptr<Helper>> helpers_;
};

}  // namespace

int available_threads() {
  const int processors = std::max(1, tbb::info::default_concurrency());
  const int quota = detail::quota_processors();
  return quota > 0 ? std::min(processors, quota) : processors;
}

void run_with_threads(int threads, const std::function<void()>& work) {
  jobs::require_thread_count(threads);
  const int count = threads == 0 ? available_threads() : threads;
  // All places are kept for threads that enter by themselves: oneTBB sends none of its own, which it would make first.
  tbb::task_arena arena(count, static_cast<unsigned>(count));
  arena.initialize();
  const Helpers helpers(arena, count - 1);
  arena.execute(work);
}

}  // namespace welkin
