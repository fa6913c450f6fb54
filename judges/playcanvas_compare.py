# How far PlayCanvas' atlas of an image (browsers.mjs) is from the integral in double: python playcanvas_compare.py IMAGE ATLAS.u8
#
# 512 x 512 texels of 8-bit RGBP; GGX level k = 1 ... 6 of a lat-long each, of the roughness of Blinn's power 2048 / 4^k, with
# a border of a texel. Prints a table in Markdown: rms relative to the integral's.
import itertools
import sys

import numpy as np

import welkin

image, atlas = sys.argv[1:3]
texels = np.fromfile(atlas, np.uint8).reshape(512, 512, 4) / 255.0
light = (texels[..., :3] * (8 - 7 * texels[..., 3:])) ** 2
y, width, height = 256, 256, 128
turns = [
    np.array([[s[i] * (o[i] == j) for j in range(3)] for i in range(3)], float)
    for o in itertools.permutations(range(3))
    for s in itertools.product((1, -1), repeat=3)
]
chosen = None
print("| level | roughness | rms error, percent | mean |\n|---|---|---|---|")
for level in range(1, 7):
    power = max(1, 2048 >> (2 * level))
    roughness = 1 - np.log2(power) / 11
    step = max(1, height // 8)
    rows, columns = np.mgrid[1 + step // 2 : height - 1 : step, 1 + step // 2 : width - 1 : step]
    found = light[y + rows, columns].reshape(-1, 3)
    u = ((columns - 0.5) / (width - 2)).ravel()
    v = ((rows - 0.5) / (height - 2)).ravel()
    longitude, latitude = 2 * np.pi * (0.5 - u), np.pi * (0.5 - v)
    directions = np.stack([np.sin(longitude) * np.cos(latitude), np.sin(latitude), np.cos(longitude) * np.cos(latitude)], 1)
    weights = np.cos(latitude)[:, None]

    def error(turn, every=1):
        wanted = welkin.reference_specular(image, roughness, directions[::every] @ turn.T)
        off, weight = found[::every] - wanted, weights[::every]
        return np.sqrt(np.sum(weight * off**2) / np.sum(weight * wanted**2)), np.sum(weight * found[::every]) / np.sum(weight * wanted)

    if chosen is None:  # by some directions of the sharpest level
        chosen = min(turns, key=lambda turn: error(turn, 11)[0])
    rms, mean = error(chosen)
    print(f"| {level} | {roughness:.2f} | {100 * rms:.1f} | {100 * (mean - 1):+.1f} |")
    y, width, height = y + height, width // 2, height // 2
print(f"\nAxes: {chosen.tolist()}")
