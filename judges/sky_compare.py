# One day by Welkin, by Blender's Nishita and by its Hosek-Wilkie sky: a table in Markdown and an image.
#
#   python sky_compare.py FOLDER IMAGE.png        FOLDER as sky_scene.py wrote it
import os
import sys

import numpy as np

import png
import welkin

folder, image = sys.argv[1:3]
SUNS = (60, 30, 10, 5, 2, 0, -4)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
ROWS, COLUMNS = 128, 256
elevations = np.radians(90 - (np.arange(ROWS // 2) + 0.5) * 180 / ROWS)
azimuths = np.radians(180 - (np.arange(COLUMNS) + 0.5) * 360 / COLUMNS)
grid = np.stack(
    [
        np.cos(elevations)[:, None] * np.sin(azimuths)[None],
        np.repeat(np.sin(elevations)[:, None], COLUMNS, 1),
        np.cos(elevations)[:, None] * np.cos(azimuths)[None],
    ],
    2,
)
ours = welkin.sky("earth")


def skies(model, sun):
    """The upper half of a lat-long whose centre looks towards the sun."""
    if model == "Welkin":
        return np.asarray(ours.radiance(grid.reshape(-1, 3), welkin.sun_direction(sun, 0)), np.float64).reshape(ROWS // 2, COLUMNS, 3)
    file = os.path.join(folder, f"{model}_{sun}.exr")
    if not os.path.exists(file):
        return None
    return np.asarray(welkin.read(file, layout="lat-long").pixels, np.float64)[: ROWS // 2, :, :3]


def irradiance(sky):
    weights = np.sin(elevations) * np.cos(elevations) * (np.pi / ROWS) * (2 * np.pi / COLUMNS)
    return np.einsum("rcx,r->x", sky, weights)


def at(sky, elevation, opposite=False):
    row = min(int((90 - elevation) / 180 * ROWS), ROWS // 2 - 1)
    column = 0 if opposite else COLUMNS // 2
    return sky[row, [column - 1, column]].mean(0)


def fisheye(sky, size=112):
    y, x = (np.mgrid[0:size, 0:size] + 0.5) / size * 2 - 1
    radius = np.hypot(x, y)
    row = np.clip((radius * ROWS / 2).astype(int), 0, ROWS // 2 - 1)
    column = np.clip(((0.5 + np.arctan2(x, y) / (2 * np.pi)) * COLUMNS).astype(int), 0, COLUMNS - 1)  # the sun below
    return np.where((radius < 1)[..., None], sky[row, column], 0)


print("| sun | sky | irradiance over that at 60 | zenith over mean | 10 up: sun's side, opposite, over zenith | blue over red: zenith, 10 up opposite |")
print("|---|---|---|---|---|---|")
tiles = {}
scales = {}
for model in ("Welkin", "nishita", "hosek_wilkie"):
    scales[model] = irradiance(skies(model, 60)) @ LUMINANCE
for sun in SUNS:
    for model in ("Welkin", "nishita", "hosek_wilkie"):
        sky = skies(model, sun)
        if sky is None:
            tiles[model, sun] = np.zeros((112, 112, 3))
            continue
        light = irradiance(sky) @ LUMINANCE
        zenith = at(sky, 89)
        towards, away = at(sky, 10), at(sky, 10, True)
        name = {"Welkin": "Welkin, earth", "nishita": "Nishita", "hosek_wilkie": "Hosek-Wilkie, turbidity 3"}[model]
        print(
            f"| {sun} | {name} | {light / scales[model]:.3g} | {zenith @ LUMINANCE * np.pi / light:.2f} | "
            f"{towards @ LUMINANCE / (zenith @ LUMINANCE):.2f}, {away @ LUMINANCE / (zenith @ LUMINANCE):.2f} | "
            f"{zenith[2] / zenith[0]:.2f}, {away[2] / away[0]:.2f} |"
        )
        exposure = 1.1 / scales[model] * (light / scales[model]) ** -0.85
        shown = fisheye(sky) * exposure
        tiles[model, sun] = np.clip(1 - np.exp(-2.2 * np.maximum(shown, 0)), 0, 1) ** (1 / 2.2)
rows = [np.concatenate([tiles[model, sun] for sun in SUNS], 1) for model in ("Welkin", "nishita", "hosek_wilkie")]
png.write(image, np.concatenate(rows, 0))
