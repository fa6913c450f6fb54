"""Relighting: one bake, and spheres under it as the light turns, grows warmer and gets a second sun, without new pixels.

    python relighting.py [FOLDER] [--picture city.hdr]
"""
import numpy as np
from _common import arguments, sphere, light_of, plt, save, srgb

import welkin

ALBEDO = np.array([0.75, 0.7, 0.65])
PIXELS = 160
TURNS = [0, 60, 120, 180, 240, 300]


def matte(radiance):
    """A matte sphere: what it reflects, (PIXELS, PIXELS, 3)."""
    normals, inside = sphere(PIXELS)
    return np.where(inside[..., None], ALBEDO * radiance.irradiance()(normals) / np.pi, 0), inside


def second_sun(direction, irradiance, bands):
    """Coefficients of a directional light."""
    values = welkin.basis(direction / np.linalg.norm(direction), bands)
    return welkin.SphericalHarmonics(values[:, None] * np.asarray(irradiance))


def main():
    options = arguments(__doc__.splitlines()[0], "picture")
    radiance = welkin.bake(light_of(options.picture), background=False, specular=False, brdf=False).radiance
    level = radiance.mean.mean()
    ways = {
        "rotate": lambda light: light,
        "warmer": lambda light: light * (1.3, 1.0, 0.6),
        "and a blue lamp": lambda light: light + second_sun(np.array([1, 0.4, 0.5]), level * np.array([0.5, 1, 3]), 3),
        "softened by a window": lambda light: light.window("hanning", 3.0).harmonics,
    }
    figure, rows = plt.subplots(len(ways), len(TURNS), figsize=(11, 7.9), layout="constrained")
    for row, (title, change) in zip(rows, ways.items()):
        for axes, degrees in zip(row, TURNS):
            seen, inside = matte(change(radiance.rotate(welkin.rotation_about_y(degrees))))
            axes.imshow(np.dstack([srgb(0.4 * seen / level), inside]))
            axes.set_axis_off()
            axes.set_title(f"{title}, {degrees}°", fontsize=8)
    figure.suptitle("One bake of 27 numbers, 24 lights")
    save(figure, options.folder, "relighting.png")


if __name__ == "__main__":
    main()
