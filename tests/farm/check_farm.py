#!/usr/bin/env python3
"""What a batch's results and logs tell of a run on a farm of which a node failed.

check_farm.py snapshot RESULTS >whole.json   which results are whole now, and since when; LOOKED_AT is when this was done
check_farm.py check PLAN RESULTS whole.json LOOKED_AT NODE SHARD    prints the findings; exits with 1 if one is wrong
"""

import collections
import json
import pathlib
import re
import sys


def whole_results(results):
    """By folder name: result.json's file number and time of writing. A result computed again would have others."""
    found = {}
    for listed in results.glob("*/result.json"):
        state = listed.stat()
        found[listed.parent.name] = [state.st_ino, state.st_mtime_ns]
    return found


def verified(results):
    """How many results the second array computed again, and how many of those differed: by its logs."""
    counts = collections.Counter()
    for log in (results / "slurm").glob("verify-*.log"):
        for number, state in re.findall(r"(\d+) (verified|differs)", log.read_text(encoding="utf-8")):
            counts[state] += int(number)
    return counts


class Findings:
    def __init__(self):
        self.wrong = 0

    def add(self, holds, text):
        print(f"  {'yes' if holds else 'NO '}  {text}")
        self.wrong += not holds


def check(plan, results, before, looked_at, node, shard):
    jobs = json.loads(plan.read_text(encoding="utf-8"))["totals"]["jobs"]
    made = {listed.parent.name: json.loads(listed.read_text(encoding="utf-8"))
            for listed in results.glob("*/result.json")}
    now = whole_results(results)
    counts = collections.Counter(record["host"] for record in made.values())
    log = (results / "slurm" / f"shard-{shard.split('/')[0]}.log").read_text(encoding="utf-8")
    rerun = re.findall(r"(\d+) computed, (\d+) present", log)

    findings = Findings()
    print(f"jobs computed, by node: {', '.join(f'{host} {count}' for host, count in sorted(counts.items()))}")
    print("found:")
    findings.add(len(now) == jobs and all(record["state"] == "computed" for record in made.values()),
                 f"every result is present: {len(now)} of {jobs}")
    changed = [name for name, state in before.items() if now.get(name) != state]
    findings.add(not changed, f"what was whole when the node was killed ({len(before)} results) was not written again")
    again = [name for name in before if made[name]["start"] > looked_at]
    findings.add(not again, "and none of it says that it was computed later")
    findings.add(bool(rerun) and min(map(int, rerun[-1])) > 0,
                 f"shard {shard} was killed with {node} in the middle, and Slurm ran it again: computed and present {rerun}")
    counts = verified(results)
    findings.add(counts["verified"] > 0 and counts["differs"] == 0,
                 f"computed again by another shard: {counts['verified']} verified, {counts['differs']} differ")
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
