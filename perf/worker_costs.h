#pragma once

namespace welkin::perf {

/// What single calls cost the thread that makes them, on a worker with one thread; `ns_each` is the median:
/// - Drain/callback/N/1: `drain()` over N finished jobs whose callbacks do nothing, a callback;
/// - Post/in-a-row-N/KIND/1: each of N posts while the thread is busy; of requests that cannot be shared (empty), or
///   of different ones that can and are compared with what waits (cubemap);
/// - Post/to-asleep/empty/1: a `post` that has to wake the thread;
/// - CancelWaiting/in-a-row-N/empty/1: `cancel` of each of N waiting jobs, the oldest first.
void add_worker_costs();

}  // namespace welkin::perf
