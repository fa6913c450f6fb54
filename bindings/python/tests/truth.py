"""What the tests compare with, in numpy alone and in double precision."""
import numpy as np

COSINE_LOBE = np.pi * np.array([1.0, 2 / 3, 1 / 4])


def basis(d):
    """Nine real harmonics without Condon-Shortley phase at unit directions (..., 3)."""
    x, y, z = d[..., 0], d[..., 1], d[..., 2]
    one = np.sqrt(1 / (4 * np.pi))
    linear = np.sqrt(3 / (4 * np.pi))
    cross = np.sqrt(15 / (4 * np.pi))
    return np.stack(
        [
            np.full_like(x, one),
            linear * y,
            linear * z,
            linear * x,
            cross * x * y,
            cross * y * z,
            np.sqrt(5 / (16 * np.pi)) * (3 * z * z - 1),
            cross * x * z,
            np.sqrt(15 / (16 * np.pi)) * (x * x - y * y),
        ],
        axis=-1,
    )


def lat_long_directions(height, fine=1):
    """Directions (fine height, 2 fine height, 3) and solid angles of the texels, each cut into fine x fine."""
    rows, columns = fine * height, 2 * fine * height
    latitude = np.pi / 2 - np.pi * (np.arange(rows) + 0.5) / rows
    longitude = np.pi - 2 * np.pi * (np.arange(columns) + 0.5) / columns
    edges = np.sin(np.pi / 2 - np.pi * np.arange(rows + 1) / rows)
    weights = np.repeat(((edges[:-1] - edges[1:]) * 2 * np.pi / columns)[:, None], columns, axis=1)
    latitude, longitude = np.meshgrid(latitude, longitude, indexing="ij")
    directions = np.stack(
        [np.sin(longitude) * np.cos(latitude), np.sin(latitude), np.cos(longitude) * np.cos(latitude)], axis=-1
    )
    return directions, weights


def project_lat_long(pixels, fine=8):
    """Coefficients (9, 3) by explicit sums; texels are areas of one value."""
    directions, weights = lat_long_directions(pixels.shape[0], fine)
    values = pixels[..., :3].astype(float).repeat(fine, axis=0).repeat(fine, axis=1)
    return np.einsum("hwk,hwc,hw->kc", basis(directions), values, weights)


FACES = {  # normal, where columns go, where rows go
    0: ((1, 0, 0), (0, 0, -1), (0, -1, 0)),
    1: ((-1, 0, 0), (0, 0, 1), (0, -1, 0)),
    2: ((0, 1, 0), (1, 0, 0), (0, 0, 1)),
    3: ((0, -1, 0), (1, 0, 0), (0, 0, -1)),
    4: ((0, 0, 1), (1, 0, 0), (0, -1, 0)),
    5: ((0, 0, -1), (-1, 0, 0), (0, -1, 0)),
}


def cubemap_directions(size):
    """Unit directions (6, size, size, 3) of texels' centres, and their solid angles (nearly)."""
    at = (2 * np.arange(size) + 1) / size - 1
    v, u = np.meshgrid(at, at, indexing="ij")
    directions = np.stack(
        [
            np.array(n) + u[..., None] * np.array(right) + v[..., None] * np.array(down)
            for n, right, down in FACES.values()
        ]
    )
    length = np.linalg.norm(directions, axis=-1)
    return directions / length[..., None], 4 / size**2 / length**3


def rotation(rng):
    """A random rotation matrix."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def relative(a, b):
    """|a - b| / |b| of whole arrays."""
    return np.linalg.norm(np.asarray(a) - b) / np.linalg.norm(b)
