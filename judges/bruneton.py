# Compares skies with the tables that npm's @takram/three-atmosphere ships: Bruneton's program of 2017 in half floats, with
# the constants of Hillaire 2020, four orders, on the ground by day.
#
#   python bruneton.py ASSETS SKY [--rows]       ASSETS: the package's assets; SKY: tables of `welkin sky --save-tables`
#
# A direction's radiance is looked up as the package's shader does it, in double.
import sys

import numpy as np

import welkin

assets, tables = sys.argv[1:3]
R, MU, MUS, NU = 32, 128, 32, 8
BOTTOM, TOP, MUS_MIN, G = 6360.0, 6420.0, np.cos(np.radians(120)), 0.8
H = np.sqrt(TOP * TOP - BOTTOM * BOTTOM)


def table(name):
    values = np.fromfile(f"{assets}/{name}.bin", np.float16).astype(np.float64)
    return values.reshape(R, MU, NU * MUS, 4)[..., :3]


rayleigh, mie = table("scattering"), table("single_mie_scattering")


def unit(x, size):
    return 0.5 / size + x * (1 - 1 / size)


def to_top(mu):
    return -BOTTOM * mu + np.sqrt(np.maximum(BOTTOM**2 * (mu * mu - 1) + TOP**2, 0))


def lookup(values, mu, mu_s, nu):
    """Trilinear on the ground (the first layer), linear between two values of nu."""
    u_mu = 0.5 + 0.5 * unit((to_top(mu) - (TOP - BOTTOM)) / (H - (TOP - BOTTOM)), MU // 2)
    a = (to_top(mu_s) - (TOP - BOTTOM)) / (H - (TOP - BOTTOM))
    A = (to_top(MUS_MIN) - (TOP - BOTTOM)) / (H - (TOP - BOTTOM))
    u_mus = unit(np.maximum(1 - a / A, 0) / (1 + a), MUS)
    at_nu = (nu + 1) / 2 * (NU - 1)
    low = min(int(at_nu), NU - 2)
    y = u_mu * MU - 0.5
    j = min(int(y), MU - 2)

    def one(index):
        x = (index + u_mus) * MUS - 0.5
        i = int(x)
        b, c = x - i, y - j
        return (1 - c) * ((1 - b) * values[0, j, i] + b * values[0, j, i + 1]) + c * ((1 - b) * values[0, j + 1, i] + b * values[0, j + 1, i + 1])

    return one(low) + (at_nu - low) * (one(low + 1) - one(low))


def radiance(sun, elevation, azimuth):
    mu, mu_s = np.sin(np.radians(elevation)), np.sin(np.radians(sun))
    nu = mu * mu_s + np.cos(np.radians(elevation)) * np.cos(np.radians(sun)) * np.cos(np.radians(azimuth))
    lobe = 3 / (8 * np.pi) * (1 - G * G) / (2 + G * G) * (1 + nu * nu) / (1 + G * G - 2 * G * nu) ** 1.5
    return lookup(rayleigh, mu, mu_s, nu) * 3 / (16 * np.pi) * (1 + nu * nu) + lookup(mie, mu, mu_s, nu) * lobe


sky = welkin.load_sky(tables)
print("| sun | rms, percent: red, green, blue | largest | mean |\n|---|---|---|---|")
for sun in (80, 60, 40, 20, 10, 5, 2, 0, -2, -4, -6):
    off = []
    for elevation in (5, 10, 20, 30, 45, 60, 80, 90):
        for azimuth in (0, 45, 90, 135, 180):
            nu = np.sin(np.radians(elevation)) * np.sin(np.radians(sun)) + np.cos(np.radians(elevation)) * np.cos(np.radians(sun)) * np.cos(np.radians(azimuth))
            if nu > np.cos(np.radians(5)):
                continue
            ours = sky.radiance(welkin.sun_direction(elevation, azimuth), welkin.sun_direction(sun, 0))
            off.append(100 * (np.asarray(ours, np.float64) / radiance(sun, elevation, azimuth) - 1))
            if "--rows" in sys.argv:
                print(sun, elevation, azimuth, off[-1])
    off = np.array(off)
    rms = np.sqrt(np.mean(off**2, 0))
    print(f"| {sun} | " + ", ".join(f"{x:.2f}" for x in rms) + f" | {off.flat[np.abs(off).argmax()]:+.1f} | {off.mean():+.2f} |")
