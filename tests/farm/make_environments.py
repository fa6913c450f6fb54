#!/usr/bin/env python3
"""make_environments.py COUNT FOLDER [WIDTH]: as many lat-longs in PFM, of which no two are alike. The same every time."""

import array
import math
import pathlib
import sys


def environment(number, width):
    """A sky over ground with a sun, all of which depend on the number; rows from below, as PFM has them."""
    height = width // 2
    sun_row, sun_column = height // 2 + number % (height // 2), (number * 7) % width
    texels = array.array("f")
    for row in range(height):
        up = math.sin(math.pi * ((row + 0.5) / height - 0.5))
        for column in range(width):
            light = 0.2 + 0.05 * (number % 17) + (0.5 * up if up > 0.0 else 0.1 * up)
            if (row, column) == (sun_row, sun_column):
                light = 100.0 + number
            texels.extend((light, light * 0.9, light * (1.0 + 0.3 * up)))
    if sys.byteorder == "big":
        texels.byteswap()
    return f"PF\n{width} {height}\n-1.0\n".encode() + texels.tobytes()


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    width = int(sys.argv[3]) if len(sys.argv) == 4 else 32
    for number in range(int(sys.argv[1])):
        (folder / f"environment {number:04}.pfm").write_bytes(environment(number, width))


if __name__ == "__main__":
    main()
