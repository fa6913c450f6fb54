"""Shared by the scripts of the gallery: the folder of their images, and light for those without an environment."""
import argparse
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import welkin  # noqa: E402


def arguments(about, *inputs):
    """The output folder for images, and the user's files or folders, each of which may be omitted."""
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("folder", nargs="?", default=".", type=pathlib.Path, help="where the picture is written")
    for name in inputs:
        parser.add_argument(f"--{name}", type=pathlib.Path, help="a computed sky without it")
    found = parser.parse_args()
    found.folder.mkdir(parents=True, exist_ok=True)
    return found


def small_sky(**options):
    """Tables of a quarter of the default sizes: a fraction of a second."""
    return welkin.sky(heights=16, view_zeniths=64, sun_zeniths=64, **options)


def light_of(path, elevation=20.0, azimuth=60.0):
    """The pixels of a file, or a computed sky: (height, width, 3)."""
    if path is not None:
        return welkin.read(path).pixels
    return small_sky().lat_long(welkin.sun_direction(elevation, azimuth), 256, sun_disc=True)


def srgb(linear):
    """Linear light from 0 to 1 as a screen takes it."""
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def show(axes, pixels, title="", height=128, exposure=0.0):
    """A lat-long or a cubemap as a preview."""
    axes.imshow(srgb(welkin.tone_mapped(pixels, height, exposure)))
    axes.set_title(title, fontsize=8)
    axes.set_axis_off()


def sphere(pixels):
    """Normals (pixels, pixels, 3) of a sphere seen along -z, and where it is."""
    at = (2 * np.arange(pixels) + 1) / pixels - 1
    y, x = np.meshgrid(-at, at, indexing="ij")
    inside = x**2 + y**2 < 1
    z = np.sqrt(np.where(inside, 1 - x**2 - y**2, 1))
    normals = np.stack([x, y, z], axis=-1)
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True), inside


def number(value):
    """Three digits that matter, without an exponent."""
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def save(figure, folder, name):
    path = folder / name
    figure.savefig(path, dpi=110, bbox_inches="tight")
    plt.close(figure)
    print(path)
