"""What a call from Python costs beyond the same call in C++, in microseconds: the least of many rounds each.

    python overhead.py [--limit 5]

Ends with 1 if a call is above the limit.
"""
import argparse
import sys
import time

import numpy as np

import welkin
from welkin import _welkin

FACES = np.random.default_rng(1).random((6, 4, 4, 3), dtype=np.float32)
LIGHT = welkin.project(FACES).radiance
TURN = welkin.rotation_about_y(30.0)
UP = np.array([0.0, 1.0, 0.0])
SMALL = {"size": 4, "mips": 1}
CALLS = {  # by the names in source/timing.cpp
    "project": lambda: welkin.project(FACES),
    "prefilter": lambda: welkin.prefilter(FACES, size=4, mips=1),
    "bake": lambda: welkin.bake(FACES, background=False, specular=SMALL, irradiance=False, brdf=False),
    "to_cubemap": lambda: welkin.to_cubemap(FACES, 4),
    "irradiance": lambda: LIGHT.irradiance(),
    "rotate": lambda: LIGHT.rotate(TURN),
    "evaluate": lambda: LIGHT(UP),
    "engine_light": lambda: welkin.engine_light(LIGHT, "three"),
    "brdf_table": lambda: welkin.brdf_table(),
}
ROUNDS, SECONDS = 40, 0.004  # rounds in turn, so that what else the machine does meets both alike


def seconds_here(call, count):
    start = time.perf_counter()
    for _ in range(count):
        call()
    return (time.perf_counter() - start) / count


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--limit", type=float, default=5.0, help="microseconds")
    limit = parser.parse_args().limit
    over = False
    print(f"{'call':14}{'C++':>10}{'Python':>10}{'beyond':>10}  microseconds, the least of {ROUNDS} rounds")
    for name, call in CALLS.items():
        count = max(1, int(SECONDS / max(seconds_here(call, 3), 1e-7)))
        there, here = zip(
            *((_welkin._seconds_of(name, FACES, count), seconds_here(call, count)) for _ in range(ROUNDS))
        )
        beyond = 1e6 * (min(here) - min(there))
        over |= beyond > limit
        print(f"{name:14}{1e6 * min(there):10.2f}{1e6 * min(here):10.2f}{beyond:10.2f}")
    return 1 if over else 0


if __name__ == "__main__":
    sys.exit(main())
