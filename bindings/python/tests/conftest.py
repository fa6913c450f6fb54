import numpy as np
import pytest

import welkin


@pytest.fixture
def rng():
    return np.random.default_rng(7)


@pytest.fixture
def image(rng):
    """A lat-long of 64 x 32 with a bright spot."""
    pixels = rng.random((32, 64, 3), dtype=np.float32)
    pixels[9, 20] = 50
    return pixels


@pytest.fixture
def faces(rng):
    return rng.random((6, 16, 16, 3), dtype=np.float32)


@pytest.fixture(scope="session")
def small_sky():
    return welkin.sky(heights=8, view_zeniths=32, sun_zeniths=32, orders=2)
