# Compares renders of cycles_scene.py with shading by Welkin's harmonics, irradiance, chain and BRDF table.
#
#   python cycles_compare.py IMAGE white_1.exr white_2.exr lit_1.exr lit_2.exr [FIGURE.png]
#
# IMAGE is what was baked, two renders each have different seeds. With a and b their pixels and s ours, the mean of
# (s - a)(s - b) is the mean square of our difference without that of the noise, which is that of (a - b)^2 / 4.
# Prints tables in Markdown. Fails where a bound at the end does not hold.
import sys

import numpy as np

import layout
import png
import welkin

image, white_files, lit_files = sys.argv[1], sys.argv[2:4], sys.argv[4:6]
figure = sys.argv[6] if len(sys.argv) > 6 else None

# How the world's normals, as rows of Blender's axes, are in Welkin's.
to_welkin = np.linalg.inv(np.asarray(welkin.conventions()["blender"].from_welkin))
camera = np.array([layout.RIGHT, layout.UP, layout.BACK])
BACK = to_welkin @ np.array(layout.BACK)
RINGS = [(0.9, 1.0), (0.7, 0.8), (0.5, 0.6), (0.3, 0.4), (0.2, 0.3), (0.1, 0.2)]


def pixels_of(file):
    return np.asarray(welkin.read(file, layout="lat-long").pixels, np.float64)[..., :3]


def sphere(number):
    """Rows, columns and normals (in Welkin's axes) of the pixels in a sphere, and their N.V."""
    cx, cy = layout.CENTRES[number]
    columns, rows = np.meshgrid(np.arange(layout.WIDTH), np.arange(layout.HEIGHT))
    x = (columns + 0.5 - layout.WIDTH / 2) / layout.PIXELS - cx
    y = (layout.HEIGHT / 2 - rows - 0.5) / layout.PIXELS - cy
    inside = x * x + y * y < 0.99
    x, y = x[inside], y[inside]
    z = np.sqrt(1 - x * x - y * y)
    normals = np.stack([x, y, z], 1) @ camera @ to_welkin.T
    return rows[inside], columns[inside], normals, z


def in_lat_long(values, directions):
    """Bilinear, as Cycles and GPUs do it: columns wrap, rows end at the poles."""
    height, width = values.shape[:2]
    x, y, z = directions.T
    u = (0.5 - np.arctan2(x, z) / (2 * np.pi)) * width - 0.5
    v = np.arccos(np.clip(y, -1, 1)) / np.pi * height - 0.5
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    a, b = (u - i)[:, None], (v - j)[:, None]
    row = lambda k: np.clip(k, 0, height - 1)
    texel = lambda dj, di: values[row(j + dj), (i + di) % width]
    return (1 - b) * ((1 - a) * texel(0, 0) + a * texel(0, 1)) + b * ((1 - a) * texel(1, 0) + a * texel(1, 1))


def in_cubemap(faces, directions):
    """Bilinear inside of a face."""
    size = faces.shape[1]
    d = directions
    axis = np.abs(d).argmax(1)
    face = 2 * axis + (d[np.arange(len(d)), axis] < 0)
    x, y, z = (d / np.abs(d).max(1)[:, None]).T
    columns = np.choose(face, [-z, z, x, x, x, -x])
    rows = np.choose(face, [-y, -y, z, -z, -y, -y])
    u, v = (columns + 1) * size / 2 - 0.5, (rows + 1) * size / 2 - 0.5
    u, v = np.clip(u, 0, size - 1), np.clip(v, 0, size - 1)
    i, j = np.minimum(u.astype(int), size - 2), np.minimum(v.astype(int), size - 2)
    a, b = (u - i)[:, None], (v - j)[:, None]
    top = (1 - a) * faces[face, j, i] + a * faces[face, j, i + 1]
    return (1 - b) * top + b * ((1 - a) * faces[face, j + 1, i] + a * faces[face, j + 1, i + 1])


def in_table(table, n_dot_v, roughness):
    height, width = table.shape[:2]
    u = np.clip(n_dot_v * width - 0.5, 0, width - 1)
    v = np.clip(roughness * height - 0.5, 0, height - 1)
    i, j = np.minimum(u.astype(int), width - 2), int(min(v, height - 2))
    a, b = (u - i)[:, None], v - j
    return (1 - b) * ((1 - a) * table[j, i] + a * table[j, i + 1]) + b * ((1 - a) * table[j + 1, i] + a * table[j + 1, i + 1])


def albedo(n_dot_v, roughness, correlated, samples=1024):
    """The integral of D G / (4 N.V) over directions with Smith's G of GGX, by half vectors: midpoints."""
    alpha = roughness * roughness
    s = (np.arange(samples) + 0.5) / samples
    t, p = np.meshgrid(s, s[: samples // 4] * 4 * 2 * np.pi / 2)  # half of the azimuths
    cosine = np.sqrt((1 - t) / (1 + (alpha * alpha - 1) * t))
    sine = np.sqrt(1 - cosine * cosine)
    found = []
    for nv in n_dot_v:
        vh = np.sqrt(1 - nv * nv) * sine * np.cos(p) + nv * cosine
        nl = 2 * vh * cosine - nv
        lit = (vh > 0) & (nl > 0)
        nl_ = np.where(lit, nl, 1)
        root = lambda c: np.sqrt(1 + alpha * alpha * (1 / (c * c) - 1))
        a, b = (root(nv) - 1) / 2, (root(nl_) - 1) / 2
        shadowing = 1 / (1 + a + b) if correlated else 1 / ((1 + a) * (1 + b))
        found.append(np.mean(np.where(lit, shadowing * vh / (cosine * nv), 0)))
    return np.array(found)


def difference(ours, a, b):
    """Of our pixels and two renders, in percent of the renders' rms: rms without noise, noise of their mean, mean."""
    both = (a + b) / 2
    scale = np.sqrt(np.mean(both * both))
    square = np.mean((ours - a) * (ours - b))
    noise = np.sqrt(np.mean((a - b) ** 2) / 4)
    return 100 * np.sqrt(max(square, 0)) / scale, 100 * noise / scale, 100 * (np.mean(ours) / np.mean(both) - 1)


def ring_row(numbers):
    return " | ".join(numbers)


white = [pixels_of(each) for each in white_files]
lit = [pixels_of(each) for each in lit_files]
source = pixels_of(image)
table = np.asarray(welkin.brdf_table(width=128, height=128, sheen=False))
failed = []
shaded = np.zeros_like(lit[0])

harmonics = welkin.project(image, bands=3).radiance.irradiance().lambertian()
many = welkin.project(image, bands=16).radiance.irradiance().lambertian()
# Lambert's lobe, by as many bands as its bound needs (`welkin.irradiance` and bakes use three).
irradiance = np.asarray(welkin.prefilter(image, size=64, lobe="lambert", mips=1).levels[0], np.float64)
print("| surface | shading | rms difference, percent | noise of Cycles | of the mean |\n|---|---|---|---|---|")


def row(surface, shading, ours, at, bound):
    rms, noise, mean = difference(ours, *(each[at] for each in lit))
    print(f"| {surface} | {shading} | {rms:.3f} | {noise:.3f} | {mean:+.3f} |")
    if bound and rms > bound:
        failed.append(f"{surface}, {shading}: {rms:.3f} % (at most {bound})")


rows, columns, normals, nv = sphere(0)
at = (rows, columns)
row("matte sphere", "harmonics, 3 bands", harmonics(normals), at, None)
row("matte sphere", "harmonics, 16 bands", many(normals), at, None)
row("matte sphere", "irradiance cubemap of 64 (`lobe=\"lambert\"`)", in_cubemap(irradiance, normals), at, 0.5)
row("matte sphere", "`direct_irradiance`, in double", welkin.direct_irradiance(image, normals) / np.pi, at, 0.5)
shaded[at] = in_cubemap(irradiance, normals)
rows, columns, normals, nv = sphere(1)
at = (rows, columns)
mirrored = 2 * nv[:, None] * normals - BACK
row("mirror", "the image, bilinear", in_lat_long(source, mirrored), at, 0.5)
shaded[at] = in_lat_long(source, mirrored)
# The level plane's inner pixels: its axes are the world's.
columns, rows = np.meshgrid(np.arange(layout.WIDTH), np.arange(layout.HEIGHT))
x = (columns + 0.5 - layout.WIDTH / 2) / layout.PIXELS - layout.FLOOR_CENTRE[0]
y = ((layout.HEIGHT / 2 - rows - 0.5) / layout.PIXELS - layout.FLOOR_CENTRE[1]) / np.sin(layout.TILT)
along, across = x * np.cos(layout.TURN) - y * np.sin(layout.TURN), x * np.sin(layout.TURN) + y * np.cos(layout.TURN)
level = (np.abs(along) < layout.FLOOR_SIZE[0] / 2 - 0.1) & (np.abs(across) < layout.FLOOR_SIZE[1] / 2 - 0.1)
level &= y * np.sin(layout.TILT) < 0.6  # not behind the spheres above
count = int(level.sum())
up = to_welkin @ np.array([0.0, 0.0, 1.0])
row("level plane", "harmonics, 16 bands", np.repeat(many(up)[None], count, 0), level, None)
row("level plane", "irradiance cubemap of 64 (`lobe=\"lambert\"`)", np.repeat(in_cubemap(irradiance, up[None]), count, 0), level, 0.5)
shaded[level] = in_cubemap(irradiance, up[None])

# Which of the 48 ways to name axes fits: the mirror of the one that the convention states is by far the best.
turns = []
for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (1, 0, 2), (2, 1, 0)):
    for signs in np.ndindex(2, 2, 2):
        turn = np.zeros((3, 3))
        turn[range(3), order] = 1 - 2 * np.array(signs)
        turns.append((difference(in_lat_long(source, mirrored @ turn.T), *(each[at] for each in lit))[0], turn))
turns.sort(key=lambda each: each[0])
print(f"\nOf the 48 turns and mirrors of the axes the identity fits best: {turns[0][0]:.3f} %, the next {turns[1][0]:.0f} %.")
if not np.array_equal(turns[0][1], np.eye(3)):
    failed.append(f"orientation: {turns[0][1]} fits best")

heads = " | ".join(f"{a:.1f} to {b:.1f}" for a, b in RINGS)
dashes = "|---" * (len(RINGS) + 1) + "|"
furnace, own, users, noises = [], [], [], []
for number, (kind, roughness) in enumerate(layout.SPHERES):
    if kind != "rough":
        continue
    rows, columns, normals, nv = sphere(number)
    at = (rows, columns)
    size = 1024 if roughness < 0.15 else 512 if roughness < 0.5 else 128
    chain = welkin.prefilter(image, size=size, roughness=[roughness], rms_error=1e-4)
    light = in_cubemap(np.asarray(chain.levels[0], np.float64), 2 * nv[:, None] * normals - BACK)
    angles = np.linspace(0.05, 1, 48)
    as_cycles = np.interp(nv, angles, albedo(angles, roughness, False))[:, None]
    ours = in_table(table, nv, roughness).sum(1)[:, None]
    shaded[at] = light * ours
    for rows_of, of in ((furnace, None), (own, light * as_cycles), (users, light * ours)):
        cells = []
        for low, high in RINGS:
            ring = (nv >= low) & (nv < high)
            where = (rows[ring], columns[ring])
            if of is None:
                both = np.mean([each[where] for each in white])
                cells.append(f"{100 * (np.mean(as_cycles[ring]) / both - 1):+.2f}, {100 * (np.mean(ours[ring]) / both - 1):+.2f}")
            else:
                rms, noise, mean = difference(of[ring], *(each[where] for each in lit))
                cells.append(f"{rms:.1f} ({mean:+.1f})")
        rows_of.append(f"| {roughness} | {ring_row(cells)} |")
    noises.append(f"{roughness}: {difference(light * as_cycles, *(each[at] for each in lit))[1]:.2f}")
for title, rows_of in (
    ("White surroundings: mean difference from Cycles, percent, by N.V. Of the integral with Cycles' own shadowing (separable Smith), of Welkin's table (height-correlated)", furnace),
    ("The split sum's own error: chain times albedo (Cycles' shadowing) from Cycles, rms (mean), percent, by N.V", own),
    ("Chain times Welkin's table", users),
):
    print(f"\n{title}:\n\n| roughness | {heads} |\n{dashes}")
    print("\n".join(rows_of))
print("\nNoise of Cycles, percent rms of a pixel: " + ", ".join(noises))

if figure:
    both = (lit[0] + lit[1]) / 2
    stated = np.zeros_like(both)
    shown = shaded.sum(2) > 0
    stated[shown] = np.where(np.abs(both[shown]) > 0, shaded[shown] / np.maximum(both[shown], 1e-9), 1)
    error = np.full_like(both, 0.5)
    error[shown] = np.clip(0.5 + 2.5 * (stated[shown] - 1), 0, 1)  # grey is equal; +-20 % is white and black
    both[~shown] = 0
    scale = 0.5 / np.mean(both[shown])
    tone = lambda x: np.clip(x * scale / (1 + 0.4 * x * scale), 0, 1) ** (1 / 2.2)
    row_ = np.concatenate([tone(both), tone(shaded), error], 1)
    png.write(figure, np.repeat(np.repeat(row_, 2, 0), 2, 1))
for each in failed:
    print("FAILED: " + each, file=sys.stderr)
sys.exit(1 if failed else 0)
