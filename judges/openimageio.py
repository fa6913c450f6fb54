# Asks OpenImageIO (Debian: python3-openimageio) what is in the .exr, .hdr and .dds files that texture_samples wrote.
#
#   python3 openimageio.py SAMPLES
#
# Prints a table in Markdown; fails where a texel is not the one that went in.
import os
import sys

import numpy as np
import OpenImageIO as oiio

samples = sys.argv[1]
chain = np.fromfile(os.path.join(samples, "chain.f32"), np.float32)
lat_long = np.fromfile(os.path.join(samples, "lat_long.f32"), np.float32).reshape(8, 16, 3)
levels, at = [], 0
for size in (8, 4, 2, 1):
    levels.append(chain[at : at + 18 * size * size].reshape(6, size, size, 3))
    at += 18 * size * size


def rows(file, mip, wanted_shape):
    image = oiio.ImageInput.open(os.path.join(samples, file))
    if not image:
        return None, oiio.geterror()
    pixels = image.read_image(0, mip, 0, 3, oiio.FLOAT)
    if pixels is None:
        return None, image.geterror() or f"no level {mip}"
    pixels = np.asarray(pixels)
    if pixels.size != np.prod(wanted_shape):
        return None, f"another level than asked for: {pixels.shape}"
    return pixels.reshape(wanted_shape), ""


def open_exr_faces(faces):
    """Our faces in OpenEXR's frames: columns mirrored, but rows on +Y and -Y."""
    turned = faces[:, :, ::-1].copy()
    turned[2:4] = faces[2:4, ::-1]
    return turned


failed = 0
print(f"OpenImageIO {oiio.VERSION_STRING}\n\n| file | level | largest difference, relative | |\n|---|---|---|---|")


def row(file, level, found, wanted, allowed, word=""):
    global failed
    worst = np.inf
    if found is not None:
        worst = float(np.max(np.abs(found - wanted) / np.max(np.abs(wanted), axis=-1, keepdims=True)))
    good = worst <= allowed
    failed += not good
    print(f"| {file} | {level} | {worst:.1e} | {word}{'' if good else ' FAILED'} |")


for file in ("half.exr", "float.exr"):
    for level, faces in enumerate(levels):
        size = faces.shape[1]
        found, word = rows(file, level, (6, size, size, 3))
        row(file, level, found, open_exr_faces(faces), 0, word)
for file, allowed in (("lat_long.exr", 0), ("lat_long.hdr", 1 / 128)):
    found, word = rows(file, 0, (8, 16, 3))
    row(file, 0, found, lat_long, allowed, word)
for file in ("rgba16f.dds", "rgba32f.dds", "b10g11r11.dds", "e5b9g9r9.dds", "bc6h.dds", "image.dds"):
    image = oiio.ImageInput.open(os.path.join(samples, file))
    if not image:
        print(f"| {file} | | | not read: {oiio.geterror()} |")
        continue
    spec = image.spec()
    if file == "image.dds":
        found, word = rows(file, 0, (8, 16, 3))
        row(file, 0, found, lat_long, 0, word)
        continue
    wanted = levels if file != "bc6h.dds" else None
    if wanted is None:
        blocks, wanted, at = np.fromfile(os.path.join(samples, "bc6h.f32"), np.float32), [], 0
        for size in (8, 4, 2, 1):
            wanted.append(blocks[at : at + 18 * size * size].reshape(6, size, size, 3))
            at += 18 * size * size
    for level, faces in enumerate(wanted):
        size = faces.shape[1]
        if not image.seek_subimage(0, level) or image.spec().width != size:
            print(f"| {file} | {level} | | it shows level 0 alone |")
            continue
        spec = image.spec()
        found, word = rows(file, level, (6, size, size, 3))  # it stacks the faces
        row(file, level, found, faces, 0, f"{spec.width} x {spec.height} {word}")
sys.exit(1 if failed else 0)
