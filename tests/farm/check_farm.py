#!/usr/bin/env python3
"""What a batch's results and reports tell of a run on a farm of which a node failed.

check_farm.py snapshot RESULTS >whole.json   which results are whole now, and since when; LOOKED_AT is when this was done
check_farm.py check PLAN RESULTS whole.json LOOKED_AT NODE SHARD    prints the findings; exits with 1 if one is wrong
"""

import collections
import datetime
import json
import pathlib
import sys


def whole_results(results):
    """By folder name: result.json's file number and time of writing. A result computed again would have others."""
    found = {}
    for listed in results.glob("*/result.json"):
        state = listed.stat()
        found[listed.parent.name] = [state.st_ino, state.st_mtime_ns]
    return found


def records(results):
    """All records of all reports, each with the shard whose report it is in."""
    for path in sorted((results / "reports").glob("shard-*.jsonl")):
        _, number, _, count, *_ = path.name.split("-")
        for line in path.read_text(encoding="utf-8").splitlines():
            try:
                yield f"{number}/{count}", json.loads(line)
            except json.JSONDecodeError:
                pass  # the last line of a process that was killed in the middle of it


def seconds(time):
    return datetime.datetime.fromisoformat(time.replace("Z", "+00:00")).timestamp()


class Findings:
    def __init__(self):
        self.wrong = 0

    def add(self, holds, text):
        print(f"  {'yes' if holds else 'NO '}  {text}")
        self.wrong += not holds


def check(plan, results, before, looked_at, node, shard):
    jobs = json.loads(plan.read_text(encoding="utf-8"))["totals"]["jobs"]
    computed = collections.defaultdict(list)  # by result
    last = {}  # by job
    verified = differs = elsewhere = 0
    for place, record in records(results):
        if record["state"] == "computed":
            computed[record["result"]].append((place, record))
        if record["state"] in ("computed", "present"):
            last[record["index"]] = record
    for _, record in records(results):
        if record["state"] in ("verified", "differs"):
            verified += record["state"] == "verified"
            differs += record["state"] == "differs"
            makers = {made["host"] for _, made in computed[record["result"]]}
            elsewhere += bool(makers) and record["host"] not in makers
    now = whole_results(results)
    counts = collections.Counter(record["host"] for made in computed.values() for _, record in made)
    after = [record for made in computed.values() for place, record in made
             if place == shard and seconds(record["start"]) > looked_at]
    rerun = [record for place, record in records(results)
             if place == shard and record["state"] == "present" and seconds(record["start"]) > looked_at]

    findings = Findings()
    print(f"jobs computed, by node: {', '.join(f'{host} {count}' for host, count in sorted(counts.items()))}")
    print(f"shard {shard}, whose node {node} was killed, ran again on {', '.join(sorted({one['host'] for one in after}))}: "
          f"found {len(rerun)} results, computed {len(after)}")
    print("found:")
    findings.add(len(last) == jobs and len(now) == jobs, f"every result is present: {len(now)} of {jobs}")
    changed = [name for name, state in before.items() if now.get(name) != state]
    findings.add(not changed, f"what was whole when the node was killed ({len(before)} results) was not written again")
    again = [name for name in before if any(seconds(record["start"]) > looked_at for _, record in computed[name])]
    findings.add(not again, "and no report has any of it as computed later")
    twice = [name for name, made in computed.items() if len(made) > 1]
    findings.add(not twice, f"no result is reported as computed twice: {len(twice)}")
    findings.add(bool(after) and bool(rerun), "the node was killed in the middle of its shard, and Slurm ran it again")
    findings.add(verified > 0 and differs == 0,
                 f"computed again by another shard: {verified} verified, {differs} differ; {elsewhere} on another node")
    return findings.wrong == 0


def main():
    if len(sys.argv) == 3 and sys.argv[1] == "snapshot":
        json.dump(whole_results(pathlib.Path(sys.argv[2])), sys.stdout)
    elif len(sys.argv) == 8 and sys.argv[1] == "check":
        plan, results, before = (pathlib.Path(argument) for argument in sys.argv[2:5])
        known = json.loads(before.read_text(encoding="utf-8"))
        sys.exit(0 if check(plan, results, known, float(sys.argv[5]), sys.argv[6], sys.argv[7]) else 1)
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
