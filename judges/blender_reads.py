# Asks Blender's own image code what is in the .exr and .hdr files that texture_samples wrote.
#
#   blender -b -P blender_reads.py -- SAMPLES
import os
import sys

import bpy
import numpy as np

samples = sys.argv[sys.argv.index("--") + 1]
lat_long = np.fromfile(os.path.join(samples, "lat_long.f32"), np.float32).reshape(8, 16, 3)
size = 8
faces = np.fromfile(os.path.join(samples, "chain.f32"), np.float32)[: 18 * size * size].reshape(6, size, size, 3)
turned = faces[:, :, ::-1].copy()  # in OpenEXR's frames
turned[2:4] = faces[2:4, ::-1]
print(f"| file in Blender {bpy.app.version_string} | largest difference, relative |\n|---|---|")
good = True
for file, wanted, allowed in (
    ("lat_long.exr", lat_long, 0),
    ("lat_long.hdr", lat_long, 1 / 128),
    ("half.exr", turned.reshape(6 * size, size, 3), 0),
    ("float.exr", turned.reshape(6 * size, size, 3), 0),
):
    image = bpy.data.images.load(os.path.join(samples, file))
    width, height = image.size
    pixels = np.array(image.pixels[:], np.float32).reshape(height, width, -1)[::-1, :, :3]  # it has the bottom row first
    worst = np.inf
    if pixels.shape == wanted.shape:
        worst = float(np.max(np.abs(pixels - wanted) / wanted.max(-1, keepdims=True)))
    good = good and worst <= allowed
    print(f"| {file}, {width} x {height} | {worst:.1e}{'' if worst <= allowed else ' FAILED'} |")
if not good:
    raise SystemExit(1)
