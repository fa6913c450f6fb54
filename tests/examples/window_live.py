"""Runs examples/window under Xvfb by its script of events, and judges pixels; times are printed and not judged.

    window_live.py WINDOW WORK_DIR

The environment is a polynomial of degree 2 in the direction, for which three bands of harmonics are exact. The white
sphere is compared with the cosine integral over the image's pixels, the mirror with the polynomial itself, and the
white sphere under the sky with the library's own harmonics. Exit code 77 where there is no Xvfb.
"""

import json
import math
import os
import shutil
import struct
import subprocess
import sys

HEIGHT = 64


def radiance(x, y, z):
    return (0.6 + 0.4 * x + 0.1 * y * z, 0.5 + 0.3 * y - 0.15 * x * z, 0.4 - 0.2 * z + 0.15 * (y * y - x * x))


def texels():
    for row in range(HEIGHT):
        latitude = math.pi / 2 - math.pi * (row + 0.5) / HEIGHT
        for column in range(2 * HEIGHT):
            longitude = math.pi - math.pi * (column + 0.5) / HEIGHT
            across = math.cos(latitude)
            direction = (math.sin(longitude) * across, math.sin(latitude), math.cos(longitude) * across)
            yield row, column, direction, across * (math.pi / HEIGHT) ** 2


def write_pfm(path):
    rows = [[] for _ in range(HEIGHT)]
    for row, _, direction, _ in texels():
        rows[row].extend(radiance(*direction))
    with open(path, "wb") as file:
        file.write(b"PF\n%d %d\n-1.0\n" % (2 * HEIGHT, HEIGHT))
        for row in reversed(rows):  # the bottom row comes first
            file.write(struct.pack("<%df" % len(row), *row))


def white_light(normal):
    total = [0.0, 0.0, 0.0]
    for _, _, direction, area in texels():
        cosine = sum(a * b for a, b in zip(direction, normal))
        if cosine > 0:
            total = [sum_ + area * cosine * value for sum_, value in zip(total, radiance(*direction))]
    return [value / math.pi for value in total]


def encoded(linear):
    linear = min(max(linear, 0.0), 1.0)
    return 255 * (12.92 * linear if linear < 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055)


def main(window, work):
    if not shutil.which("xvfb-run"):
        print("SKIPPED: xvfb-run is not installed")
        sys.exit(77)
    os.makedirs(work, exist_ok=True)
    picture, record = os.path.join(work, "smooth.pfm"), os.path.join(work, "frames.json")
    write_pfm(picture)
    words = ["--frames", "180", "--record", record, "--screenshot", os.path.join(work, "window"), picture]
    environment = dict(os.environ, LIBGL_ALWAYS_SOFTWARE="1", SDL_VIDEODRIVER="x11")
    subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 800x600x24", window, *words], env=environment, check=True)
    with open(record) as file:
        pixels = json.load(file)["pixels"]
    assert len(pixels) == 20
    worst = 0.0
    for pixel in pixels:
        if pixel["light"] == "sky":
            if pixel["sphere"] == "mirror":
                continue
            wanted = pixel["white"]
        elif pixel["sphere"] == "white":
            wanted = [pixel["exposure"] * value for value in white_light(pixel["normal"])]
        else:
            wanted = [pixel["exposure"] * value for value in radiance(*pixel["reflected"])]
        difference = max(abs(encoded(value) - byte) for value, byte in zip(wanted, pixel["rgb"]))
        assert difference < 3, (pixel, [encoded(value) for value in wanted])
        worst = max(worst, difference)
    print("pixels differ from their integrals by at most %.2f of 255" % worst)


main(*sys.argv[1:])
