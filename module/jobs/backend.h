// The interface by which tiles and graphs run: on oneTBB (one_tbb.cpp), on the standard library's threads
// (standard_threads.cpp) or on the calling thread alone (serial.cpp). A build has one of them (CMakeLists.txt).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace welkin::jobs::backend {

/// A function that is called while its owner waits: a reference, so passing it copies and allocates nothing.
template <class... Arguments>
class Call {
 public:
  template <class Function>
  Call(const Function& function)  // NOLINT(google-explicit-constructor): lambdas are given as they are
      : function_(&function), call_([](const void* called, Arguments... arguments) {
          (*static_cast<const Function*>(called))(arguments...);
        }) {}

  void operator()(Arguments... arguments) const { call_(function_, arguments...); }

 private:
  const void* function_;
  void (*call_)(const void* function, Arguments... arguments);
};

/// How many threads may be inside the calling thread's arena at once, at least 1.
[[nodiscard]] int concurrency() noexcept;

/// Calls `work`. While it waits for tasks of its own, this thread does not pick up a stranger's.
void isolate(Call<> work);

/// Calls `part(index)` once for each index below `count`, on any threads of the caller's arena, and returns when all
/// are done; isolated. If the caller's own group of tasks is cancelled, these go on. Throws what a part throws first;
/// parts that were not begun by then are dropped.
void loop(std::size_t count, Call<std::size_t> part);

/// Tasks that may run at the same time, in the caller's arena, and go on if the caller's own group of tasks is
/// cancelled.
class TaskGroup {
 public:
  TaskGroup();
  ~TaskGroup();
  TaskGroup(const TaskGroup&) = delete;
  TaskGroup& operator=(const TaskGroup&) = delete;

  /// `task` throws nothing. May be called from tasks of the group. Throws std::bad_alloc.
  void run(std::function<void()> task);
  /// Until no task waits or runs any more. Must be called before the group goes.
  void wait();

 private:
  struct Tasks;
  std::unique_ptr<Tasks> tasks_;
};

}  // namespace welkin::jobs::backend
