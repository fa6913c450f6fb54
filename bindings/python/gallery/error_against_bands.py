"""Error of irradiance against the number of bands, with and without a window against ringing.

    python error_against_bands.py [FOLDER] [--picture city.hdr]
"""
import numpy as np
from _common import arguments, light_of, plt, save, show

import welkin

BANDS = range(1, 10)


def spiral(count):
    """Directions that cover the sphere evenly."""
    index = np.arange(count) + 0.5
    y = 1 - 2 * index / count
    turn = np.pi * (1 + 5**0.5) * index
    across = np.sqrt(1 - y * y)
    return np.stack([across * np.cos(turn), y, across * np.sin(turn)], axis=-1)


def main():
    options = arguments(__doc__.splitlines()[0], "picture")
    pixels = light_of(options.picture)
    normals = spiral(300)
    truth = welkin.direct_irradiance(welkin.to_lat_long(pixels, 128), normals)
    scale = np.sqrt(np.mean(np.sum(truth**2, axis=1)))

    def errors(harmonics):
        difference = np.linalg.norm(harmonics.irradiance()(normals) - truth, axis=1)
        return np.sqrt(np.mean(difference**2)) / scale, difference.max() / scale

    radiance = welkin.project(pixels, bands=max(BANDS)).radiance
    plain = np.array([errors(radiance.resized(bands)) for bands in BANDS])
    windowed = np.array([errors(radiance.resized(bands).window().harmonics) for bands in BANDS])

    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4))
    show(left, pixels, "the light", 256)
    right.semilogy(BANDS, plain[:, 0], "o-", label="rms")
    right.semilogy(BANDS, plain[:, 1], "s-", label="largest")
    right.semilogy(BANDS, windowed[:, 0], "o--", mfc="none", ms=10, label="rms, windowed: no negative light")
    right.set(xlabel="bands", ylabel="error of irradiance, relative to its rms", title="against direct integration")
    right.grid(alpha=0.3)
    right.legend()
    save(figure, options.folder, "error_against_bands.png")


if __name__ == "__main__":
    main()
