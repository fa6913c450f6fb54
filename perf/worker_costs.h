#pragma once

namespace welkin::perf {

/// What single calls cost the thread that makes them, on a worker with one thread; `ns_each` is the median:
/// - Drain/callback/N/1: `drain()` over N finished jobs whose callbacks do nothing, a callback;
/// - Post/in-a-row-N/KIND/1: each of N posts while the thread is busy; of requests that cannot be shared (empty), or
///   of different ones that can and are compared with what waits (cubemap);
/// - Post/to-asleep/empty/1: a `post` that has to wake the thread;
/// - Post/beside-busy-processors/empty-idle-priority/1: a `post` every 0.2 ms to a worker of idle-class threads whose
/// thread starts
///   one small job after the other, while other threads keep all processors busy nearly all the time; median, 99th
///   percentile and maximum;
/// - CancelWaiting/in-a-row-N/empty/1: `cancel` of each of N waiting jobs, the oldest first.
void add_worker_costs();

}  // namespace welkin::perf
