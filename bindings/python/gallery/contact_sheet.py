"""A contact sheet of a folder: each environment with its matte sphere, its size and its mean; broken ones named.

    python contact_sheet.py [FOLDER] [--environments pictures/]
"""
import math
import tempfile
from pathlib import Path

import numpy as np
from _common import arguments, sphere, number, plt, save, show, small_sky, srgb

import welkin

ENDINGS = {".exr", ".hdr", ".pfm", ".png", ".ktx2", ".ktx", ".dds", ".env"}
COLUMNS = 4


def skies(folder):
    """A folder to show where there is none: a few skies, and a file that is cut off."""
    sky = small_sky()
    for elevation in (60, 30, 10, 3, -3):
        pixels = sky.lat_long(welkin.sun_direction(elevation, 60.0), 128, sun_disc=True)
        welkin.write(folder / f"sky_{elevation:+03}.hdr", pixels)
    welkin.write(folder / "cube.exr", sky.cubemap(welkin.sun_direction(20.0, 0.0), 64), "horizontal-cross")
    (folder / "broken.hdr").write_bytes(welkin.encode("broken.hdr", pixels)[:5000])
    return folder


def draw(axes, path):
    """A cell of the sheet: the image, with the sphere in its corner."""
    try:
        image = welkin.read(path)
    except welkin.Error as error:
        axes.text(0.5, 0.5, f"{path.name}\n{error.code}", ha="center", va="center", color="firebrick")
        axes.set_axis_off()
        return
    radiance = welkin.project(image).radiance
    luminance = max(radiance.mean @ (0.2126, 0.7152, 0.0722), 1e-30)
    show(axes, image, f"{path.name}\n{image.info['width']} x {image.info['height']}, {image.info['format']}, "
                      f"mean {number(luminance)}", 192)  # fmt: skip
    normals, inside = sphere(96)
    seen = srgb(0.4 * radiance.irradiance()(normals) / np.pi / luminance)
    corner = axes.inset_axes([0.0, 0.0, 0.25, 0.5])
    corner.imshow(np.dstack([seen, inside]))
    corner.set_axis_off()


def main():
    options = arguments(__doc__.splitlines()[0], "environments")
    with tempfile.TemporaryDirectory() as made:
        folder = options.environments or skies(Path(made))
        files = sorted(path for path in folder.iterdir() if path.suffix.lower() in ENDINGS)
        rows = max(1, math.ceil(len(files) / COLUMNS))
        figure, cells = plt.subplots(rows, COLUMNS, figsize=(13, 2.2 * rows), squeeze=False)
        for axes in cells.flat[len(files) :]:
            axes.set_axis_off()
        for axes, path in zip(cells.flat, files):
            draw(axes, path)
        save(figure, options.folder, "contact_sheet.png")


if __name__ == "__main__":
    main()
