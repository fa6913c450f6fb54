"""A day of skies: images from night to noon to night, and the light on the ground by the hour.

    python day_of_skies.py [FOLDER]
"""
import numpy as np
from _common import arguments, plt, save, show, small_sky


LATITUDE, DECLINATION = 48.0, 15.0  # degrees: central Europe in early May
HOURS = np.linspace(3, 21, 145)
SHOWN = [4.5, 5.5, 7, 10, 12, 16, 18.5, 19.5]


def sun_at(hour):
    """Direction towards the sun at a solar hour; +z is south."""
    turn = np.radians(15 * (hour - 12))
    latitude, declination = np.radians([LATITUDE, DECLINATION])
    up = np.sin(latitude) * np.sin(declination) + np.cos(latitude) * np.cos(declination) * np.cos(turn)
    south = np.sin(latitude) * np.cos(declination) * np.cos(turn) - np.cos(latitude) * np.sin(declination)
    west = np.cos(declination) * np.sin(turn)
    return np.array([-west, up, south])


def main():
    folder = arguments(__doc__.splitlines()[0]).folder
    sky = small_sky()
    curve = sky.curve()
    luminance = np.array([0.2126, 0.7152, 0.0722])
    from_sky = [curve(sun_at(hour)).irradiance()((0, 1, 0)) @ luminance for hour in HOURS]
    from_sun = [curve.sun_irradiance(sun_at(hour)) @ luminance * max(sun_at(hour)[1], 0) for hour in HOURS]

    figure = plt.figure(figsize=(11, 6.5))
    grid = figure.add_gridspec(3, 4, height_ratios=[1, 1, 1.6], hspace=0.25, wspace=0.06)
    for index, hour in enumerate(SHOWN):
        sun = sun_at(hour)
        title = f"{int(hour):02}:{int(60 * (hour % 1)):02}, sun at {np.degrees(np.arcsin(sun[1])):.0f}°"
        show(figure.add_subplot(grid[index // 4, index % 4]), sky.lat_long(sun, 128, sun_disc=True), title)
    axes = figure.add_subplot(grid[2, :])
    axes.semilogy(HOURS, np.maximum(from_sky, 1e-2), label="sky")
    axes.semilogy(HOURS, np.maximum(from_sun, 1e-2), label="sun")
    axes.set(xlabel="solar hour", ylabel="lux on level ground", xlim=(HOURS[0], HOURS[-1]), ylim=(1, 2e5))
    axes.grid(alpha=0.3)
    axes.legend()
    figure.suptitle(f"A day under {sky.name.lower()}, latitude {LATITUDE:.0f}°, pictures exposed each by itself")
    save(figure, folder, "day_of_skies.png")


if __name__ == "__main__":
    main()
