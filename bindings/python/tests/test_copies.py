"""Pixels are read where they lie, and results handed over: with no memory left for a copy, calls succeed."""
import os
import subprocess
import sys
import textwrap

import pytest

# In a process of its own: with half of the array's size to spare a call must do, and numpy's own copy must fail.
PROGRAM = """
import resource, sys
import numpy as np
import welkin

def data():
    for line in open("/proc/self/status"):
        if line.startswith("VmData"):
            return int(line.split()[1]) * 1024

def limited(spare, work):
    resource.setrlimit(resource.RLIMIT_DATA, (data() + spare, resource.RLIM_INFINITY))
    try:
        return work()
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))

def call(pixels, **options):
    return welkin.project(pixels, threads=2, **options).radiance.mean

def check(pixels, **options):
    expected = call(pixels, **options)  # threads and tables are there afterwards
    spare = pixels.nbytes // 2
    try:
        limited(spare, pixels.copy)
        sys.exit("the limit is none")
    except MemoryError:
        pass
    assert (limited(spare, lambda: call(pixels, **options)) == expected).all()
"""


def run(body):
    program = textwrap.dedent(PROGRAM) + textwrap.dedent(body)
    # Without it glibc keeps large blocks that were freed, and a copy could lie in them.
    surroundings = {**os.environ, "MALLOC_MMAP_THRESHOLD_": "65536"}
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=300, env=surroundings
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("kind", ["float32", "float16", "uint8"])
def test_no_type_is_copied_in(kind, channels):
    run(
        f"""
        kind, channels = np.dtype({kind!r}), {channels}
        options = dict(encoding="linear") if kind == np.uint8 else {{}}
        width = 8192 if kind.itemsize == 1 else 4096
        check(np.ones((width // 2, width, channels), kind), **options)
        """
    )


@pytest.mark.parametrize(
    ("shape", "options"),
    [
        ("(6, 1024, 1024, 3)", "{}"),
        ("(6 * 1024, 1024, 3)", "dict(layout='vertical-strip')"),
        ("(1024, 6 * 1024, 3)", "dict(layout='horizontal-strip')"),
        ("(3 * 1024, 4 * 1024, 3)", "dict(layout='horizontal-cross')"),
        ("(4 * 1024, 3 * 1024, 3)", "dict(layout='vertical-cross')"),  # one face of twelve is rotated, and copied
    ],
)
def test_no_layout_is_copied_in(shape, options):
    run(f"check(np.ones({shape}, np.float32), **{options})")


def test_rows_that_lie_apart_or_bottom_up_are_not_copied_in():
    run(
        """
        wide = np.ones((2048, 4200, 3), np.float32)
        check(wide[::-1, 50:4146])
        """
    )


@pytest.mark.parametrize(
    "work",
    [
        "lambda: welkin.to_lat_long(pixels, 1024, threads=2)",
        "lambda: welkin.to_cubemap(pixels, 512, threads=2)",
        "lambda: welkin.build_mips(faces, levels=1, threads=2)[0]",
        "lambda: welkin.read(stored, threads=2).pixels",
    ],
)
def test_no_result_is_copied_out(work):
    run(
        f"""
        pixels = np.ones((1024, 2048, 3), np.float32)
        faces = np.ones((6, 512, 512, 3), np.float32)
        stored = welkin.encode("sky.pfm", pixels)
        work = {work}
        size = work().nbytes
        assert limited(size + size * 2 // 3, work).nbytes == size
        """
    )
