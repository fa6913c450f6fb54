"""What a call from Python costs beyond the library's own: `scripts/python overhead`."""
import timeit

import numpy

import welkin
from welkin import _welkin

CALLS = 10_000


def microseconds(pixels, **options):
    """Of one call, the best of some runs: (from Python, in C++)."""
    from_python = min(timeit.repeat(lambda: welkin.project(pixels, **options), number=CALLS, repeat=7)) / CALLS * 1e6
    in_library = min(_welkin._nanoseconds_of_project(pixels, CALLS) for _ in range(7)) / 1e3
    return from_python, in_library


def main():
    print(f"welkin {welkin.__version__}, {welkin.instruction_set()}")
    print("project of a cubemap, us      Python    C++   beyond")
    for size in (1, 8, 32):
        pixels = numpy.ones((6, size, size, 3), numpy.float32)
        for options in ({}, {"bands": 3}):
            ours, theirs = microseconds(pixels, **options)
            print(f"  {size:3} texels, {len(options)} options  {ours:12.2f} {theirs:6.2f} {ours - theirs:8.2f}")


if __name__ == "__main__":
    main()
