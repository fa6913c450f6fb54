#include "c_interface/worker.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>

#include "c_interface/enumeration.h"
#include "c_interface/error_status.h"
#include "c_interface/lent_arena.h"
#include "c_interface/versioned_struct.h"

namespace welkin::c_interface {
namespace {

static_assert(WELKIN_THREAD_PRIORITY_BELOW == static_cast<int>(ThreadPriority::below));
static_assert(WELKIN_THREAD_PRIORITY_NORMAL == static_cast<int>(ThreadPriority::normal));
static_assert(WELKIN_WHEN_FULL_REFUSE == static_cast<int>(WhenFull::refuse));
static_assert(WELKIN_WHEN_FULL_DROP_OLDEST == static_cast<int>(WhenFull::drop_oldest));

WorkerOptions worker_options(const welkin_worker_options* options) {
  const auto given = read_options(options, "options");
  WorkerOptions wanted;
  wanted.threads = given.threads;
  wanted.thread_priority = enumerator("thread_priority", given.thread_priority, ThreadPriority::normal);
  wanted.when_full = enumerator("when_full", given.when_full, WhenFull::drop_oldest);
  if (given.name != nullptr) wanted.name = given.name;
  wanted.lent_arena = lent_arena(given.enqueue, given.enqueue_user);
  if (given.most_jobs != 0) wanted.most_jobs = given.most_jobs;
  if (given.most_bytes != 0) wanted.most_bytes = given.most_bytes;
  return wanted;
}

std::chrono::nanoseconds budget(std::uint64_t nanoseconds) {
  constexpr auto kMost = static_cast<std::uint64_t>(std::chrono::nanoseconds::max().count());
  return std::chrono::nanoseconds(static_cast<std::int64_t>(std::min(nanoseconds, kMost)));
}

}  // namespace
}  // namespace welkin::c_interface

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace)

welkin_status welkin_worker_create(const welkin_worker_options* options, welkin_worker** worker) {
  return guarded([&] {
    require(worker, "worker");
    *worker = nullptr;
    *worker = std::make_unique<welkin_worker>(worker_options(options)).release();
    return WELKIN_OK;
  });
}

void welkin_worker_destroy(welkin_worker* worker) {
  guarded([&] {
    const std::unique_ptr<welkin_worker> gone(worker);
    return WELKIN_OK;
  });
}

welkin_status welkin_worker_terminate(welkin_worker* worker) {
  return guarded([&] {
    require(worker, "worker");
    worker->worker.terminate();
    return WELKIN_OK;
  });
}

welkin_status welkin_worker_wait_until_idle(welkin_worker* worker) {
  return guarded([&] {
    require(worker, "worker");
    worker->worker.wait_until_idle();
    return WELKIN_OK;
  });
}

welkin_status welkin_worker_drain(welkin_worker* worker, uint64_t budget_nanoseconds, uint64_t* called) {
  return guarded([&] {
    require(worker, "worker");
    const std::size_t count = worker->worker.drain(budget(budget_nanoseconds));
    if (called != nullptr) *called = count;
    return WELKIN_OK;
  });
}

welkin_status welkin_worker_get_load(const welkin_worker* worker, welkin_worker_load* load) {
  return guarded([&] {
    require(worker, "worker");
    const welkin::WorkerLoad now = worker->worker.load();
    welkin_worker_load values{};
    values.threads = worker->worker.threads();
    values.waiting = now.waiting;
    values.running = now.running;
    values.undrained = now.undrained;
    values.jobs = now.jobs;
    values.bytes = now.bytes;
    write_struct(load, values, "load");
    return WELKIN_OK;
  });
}
