#!/usr/bin/env python3
"""Simulates batches on farms of 1 to 1000 nodes of one core, from costs that were measured on one machine.

farm_simulation.py FIGURES    FIGURES is what scripts/farm-figures printed. Prints a table with tabs between columns.

A discrete event is the end of a part of a shard. The same figures give the same table: the generator's seed is fixed.
What is measured comes from FIGURES; what is assumed stands here, with its reason.
"""

import dataclasses
import heapq
import random
import sys

# Assumed of the farm.
SLOW_SHARE = 0.02  # nodes that other programs use too
SLOW_FACTOR = 2.0  # and how much longer work takes there
NODE_HOURS_TO_FAILURE = 1000.0  # of one node: a pessimist's, so that failures are seen at all
SECONDS_TO_NOTICE = 300.0  # SlurmdTimeout as Slurm has it by default
SECONDS_TO_REQUEUE = 120.0  # and how long a shard of a lost node waits until it may begin again
SECONDS_TO_REPAIR = 3600.0
SERVER_OPERATIONS = 20000.0  # a second, that the shared file system answers in all: one good server
COST_SPREAD = 0.5  # of a job's time about its prediction, relative
PARTS = 8  # of a shard: how finely a node's failure and the server's queue are seen

NODES = (1, 2, 4, 8, 16, 32, 64, 125, 250, 500, 1000)
LOSSES = ("starting", "files", "server", "slow nodes", "failures", "idle at the end")


@dataclasses.dataclass
class Workload:
    name: str
    jobs: int
    job_seconds: float


@dataclasses.dataclass
class Setting:
    name: str
    latency: float  # of a file operation, seconds
    shards_per_node: float = 0.0  # 0: by time
    shard_seconds: float = 0.0
    threads: int = 1  # on the node's one core: one computes while others wait for files


@dataclasses.dataclass
class Costs:
    start: float  # of a process, its plan and its tables
    schedule: float  # until a free node has its next task
    controller: float  # of the controller's time for a task
    operations: float  # of files, for a job


def read_figures(path):
    figures = {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            name, value, *_ = line.rstrip("\n").split("\t")
            figures[name] = value
    costs = Costs(float(figures["process_start_seconds"]), float(figures["slurm_task_seconds"]),
                  float(figures["slurm_controller_seconds"]), float(figures["file_operations"]))
    workloads = [Workload("probes", 1_000_000, float(figures["small_job_seconds"])),
                 Workload("photographs", 100_000, float(figures["large_job_seconds"]))]
    return costs, workloads


class Farm:
    """One run; `run` gives its length in seconds, `lost` the node seconds that were no work."""

    def __init__(self, nodes, workload, setting, costs):
        self.nodes, self.workload, self.setting, self.costs = nodes, workload, setting, costs
        self.random = random.Random(20 * nodes + 7)
        self.slow = [self.random.random() < SLOW_SHARE for _ in range(nodes)]
        self.fails_at = [self.time_to_failure() for _ in range(nodes)]
        self.server_free = 0.0
        self.controller_free = 0.0
        self.lost = dict.fromkeys(LOSSES, 0.0)
        self.work = 0.0

    def time_to_failure(self):
        return self.random.expovariate(1.0 / (NODE_HOURS_TO_FAILURE * 3600.0))

    def shards(self):
        jobs, setting = self.workload.jobs, self.setting
        if setting.shards_per_node:
            count = round(setting.shards_per_node * self.nodes)
        else:
            count = round(jobs * self.workload.job_seconds / setting.shard_seconds)
        count = max(1, min(count, jobs))
        return [jobs // count + (index < jobs % count) for index in range(count)]

    def begin(self, now):
        """When a task that a free node takes at `now` computes its first job."""
        self.controller_free = max(self.controller_free, now) + self.costs.controller
        begun = max(now + self.costs.schedule, self.controller_free) + self.costs.start
        self.lost["starting"] += begun - now
        return begun

    def do_part(self, node, now, jobs):
        """The end of so many jobs in a row."""
        spread = self.random.gauss(0.0, COST_SPREAD / jobs ** 0.5)
        compute = jobs * self.workload.job_seconds * max(0.1, 1.0 + spread)
        factor = SLOW_FACTOR if self.slow[node] else 1.0
        operations = jobs * self.costs.operations
        # Threads beyond the core's one hide latency until the core is busy all the time.
        waiting = operations * self.setting.latency
        without_server = max(compute * factor, (compute * factor + waiting) / self.setting.threads)
        self.server_free = max(self.server_free, now) + operations / SERVER_OPERATIONS
        end = max(now + without_server, self.server_free)
        self.work += compute
        self.lost["slow nodes"] += compute * (factor - 1.0)
        self.lost["files"] += without_server - compute * factor
        self.lost["server"] += max(0.0, end - (now + without_server))
        return end

    def run(self):
        waiting = [(0.0, number, jobs) for number, jobs in enumerate(self.shards())]  # time from which, order, jobs left
        heapq.heapify(waiting)
        # (time, node, jobs left of its shard, jobs of a part); idle nodes have none.
        events = [(0.0, node, 0, 1) for node in range(self.nodes)]
        heapq.heapify(events)
        order, last_end = len(waiting), 0.0
        idle_since = {}
        while events:
            now, node, left, part = heapq.heappop(events)
            if now >= self.fails_at[node]:
                down = self.fails_at[node] + SECONDS_TO_REPAIR
                self.lost["failures"] += max(0.0, min(SECONDS_TO_REPAIR, down - now))
                if left > 0:
                    heapq.heappush(waiting, (now + SECONDS_TO_NOTICE + SECONDS_TO_REQUEUE, order, left))
                    order += 1
                self.fails_at[node] = down + self.time_to_failure()
                heapq.heappush(events, (down, node, 0, 1))
                for other in list(idle_since):  # somebody must be there when the shard may begin
                    heapq.heappush(events, (now, other, 0, 1))
                    del idle_since[other]
                continue
            if left == 0:
                if not waiting:
                    idle_since[node] = now
                    continue
                ready, _, jobs = waiting[0]
                if ready > now:
                    heapq.heappush(events, (ready, node, 0, 1))
                    continue
                heapq.heappop(waiting)
                heapq.heappush(events, (self.begin(now), node, jobs, -(-jobs // PARTS)))
                continue
            jobs = min(part, left)
            end = self.do_part(node, now, jobs)
            last_end = max(last_end, end)
            heapq.heappush(events, (end, node, left - jobs, part))
        self.lost["idle at the end"] = max(0.0, self.nodes * last_end - self.work - sum(self.lost.values()))
        return last_end


SETTINGS = [
    Setting("shards of 20 minutes, 1 ms", 0.001, shard_seconds=1200.0),
    Setting("4 shards a node, 1 ms", 0.001, shards_per_node=4),
    Setting("16 shards a node, 1 ms", 0.001, shards_per_node=16),
    Setting("16 shards a node, 10 ms", 0.010, shards_per_node=16),
    Setting("the same, 8 threads a core", 0.010, shards_per_node=16, threads=8),
]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    costs, workloads = read_figures(sys.argv[1])
    print("# workload", "setting", "nodes", "seconds", "speed-up", "efficiency", "most lost by",
          *(f"lost: {name}" for name in LOSSES), sep="\t")
    for workload in workloads:
        for setting in SETTINGS:
            for nodes in NODES:
                farm = Farm(nodes, workload, setting, costs)
                seconds = farm.run()
                one = workload.jobs * workload.job_seconds
                whole = nodes * seconds
                shares = {name: max(0.0, lost) / whole for name, lost in farm.lost.items()}
                print(workload.name, setting.name, nodes, f"{seconds:.0f}", f"{one / seconds:.2f}", f"{one / whole:.3f}",
                      max(shares, key=shares.get), *(f"{shares[name]:.3f}" for name in LOSSES), sep="\t")


if __name__ == "__main__":
    main()
