"""Which arrays are taken, that none is copied, and what is said of the others."""
import gc
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import truth
import welkin


def coefficients(pixels, **options):
    return welkin.project(pixels, **options).radiance.coefficients


def test_types_and_channels_agree(faces):
    expected = coefficients(faces)
    alpha = np.concatenate([faces, np.full((6, 16, 16, 1), 9, np.float32)], axis=-1)
    assert (coefficients(alpha) == expected).all()
    half = faces.astype(np.float16)
    assert (coefficients(half) == coefficients(half.astype(np.float32))).all()
    assert truth.relative(coefficients(half), expected) < 1e-3
    byte = np.round(faces * 255).astype(np.uint8)
    linear = coefficients(byte, encoding="linear")
    assert truth.relative(linear, coefficients(byte.astype(np.float32) / 255)) < 1e-6
    code = byte.astype(float) / 255
    decoded = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4).astype(np.float32)
    assert truth.relative(coefficients(byte, encoding="srgb"), coefficients(decoded)) < 1e-5


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 5), st.booleans(), st.sampled_from([np.float32, np.float16]), st.sampled_from([3, 4]))
def test_layouts_are_the_same_cubemap(size, bottom_up, kind, channels):
    faces = np.random.default_rng(size).random((6, size, size, channels)).astype(kind)
    px, nx, py, ny, pz, nz = faces
    dark = np.zeros_like(px)
    turned = nz[::-1, ::-1]
    layouts = {
        "vertical-strip": faces.reshape(6 * size, size, channels),
        "horizontal-strip": np.concatenate(list(faces), axis=1),
        "horizontal-cross": np.concatenate(
            [
                np.concatenate([dark, py, dark, dark], axis=1),
                np.concatenate([nx, pz, px, nz], axis=1),
                np.concatenate([dark, ny, dark, dark], axis=1),
            ]
        ),
        "vertical-cross": np.concatenate(
            [
                np.concatenate([dark, py, dark], axis=1),
                np.concatenate([nx, pz, px], axis=1),
                np.concatenate([dark, ny, dark], axis=1),
                np.concatenate([dark, turned, dark], axis=1),
            ]
        ),
    }
    expected = coefficients(faces)
    assert (coefficients(list(faces)) == expected).all()
    for layout, image in layouts.items():
        if bottom_up:
            image = np.ascontiguousarray(image[::-1])[::-1]
            assert image.strides[0] < 0 or image.shape[0] == 1
        assert (coefficients(image, layout=layout) == expected).all(), layout


def test_rows_may_lie_apart_or_bottom_up(image):
    expected = coefficients(image)
    wide = np.zeros((32, 70, 3), np.float32)
    wide[:, 3:67] = image
    assert (coefficients(wide[:, 3:67]) == expected).all()
    assert (coefficients(np.ascontiguousarray(image[::-1])[::-1]) == expected).all()


@pytest.mark.parametrize(
    "view",
    [
        lambda p: p[:, ::2],
        lambda p: p[..., ::-1],
        lambda p: np.asfortranarray(p),
        lambda p: np.broadcast_to(p[:1], p.shape),
        lambda p: np.concatenate([p, p[..., :1]], axis=-1)[..., :3],
    ],
)
def test_other_strides_are_refused_and_said(image, view):
    with pytest.raises(welkin.InvalidArgument, match="ascontiguousarray"):
        welkin.project(view(image))
    welkin.project(np.ascontiguousarray(view(image)))


def test_misaligned_values_are_refused_and_said(image):
    shifted = np.frombuffer(bytearray(b"x" + image.tobytes()), np.uint8)[1:]
    misaligned = shifted.view(image.dtype).reshape(image.shape)
    with pytest.raises(welkin.InvalidArgument, match="multiples of their 4 bytes"):
        welkin.project(misaligned)
    again = welkin.project(np.array(misaligned)).radiance.coefficients
    np.testing.assert_array_equal(again, welkin.project(image).radiance.coefficients)


@pytest.mark.parametrize(
    ("pixels", "words"),
    [
        (np.zeros((4, 8, 3)), "astype"),
        (np.zeros((4, 8, 3), ">f4"), "byte order"),
        (np.zeros((4, 8, 3), np.int32), "uint8"),
        (np.zeros((4, 8, 3), np.uint8), "encoding"),
        (np.zeros((4, 8, 2), np.float32), "last dimension"),
        (np.zeros((4, 8), np.float32), "height, width, channels"),
        (np.zeros((5, 8, 8, 3), np.float32), "six square faces"),
        (np.zeros((6, 8, 4, 3), np.float32), "six square faces"),
        (np.zeros((0, 8, 3), np.float32), ""),
        ([np.zeros((4, 4, 3), np.float32)] * 5, "six faces"),
        ([np.zeros((4, 4, 3), np.float32)] * 5 + [np.zeros((2, 2, 3), np.float32)], "face 5"),
    ],
)
def test_wrong_pixels_are_said(pixels, words):
    with pytest.raises(welkin.InvalidArgument, match=words) as caught:
        welkin.project(pixels)
    assert caught.value.code == "invalid_argument" and isinstance(caught.value, ValueError)


def test_wrong_arguments_are_said(image, faces):
    with pytest.raises(TypeError, match=r'takes no argument "band" \(did you mean "bands"\?\); it takes bands'):
        welkin.project(image, band=2)
    with pytest.raises(TypeError, match=r"project\(bands=...\)"):
        welkin.project(image, bands="many")
    with pytest.raises(welkin.InvalidArgument, match='"exact", "midpoint"'):
        welkin.project(image, quadrature="other")
    with pytest.raises(welkin.InvalidArgument, match="bands"):
        welkin.project(image, bands=17)
    with pytest.raises(welkin.InvalidArgument, match="4 n x 3 n"):
        welkin.project(image, layout="horizontal-cross")
    with pytest.raises(welkin.InvalidArgument, match="three dimensions"):
        welkin.project(faces, layout="lat-long")
    with pytest.raises(TypeError, match="numpy array"):
        welkin.project(7)
    with pytest.raises(TypeError, match='takes no "sizes"'):
        welkin.bake(image, specular={"sizes": 3})


def test_no_copy_goes_in():
    pixels = np.ones((1024, 2048, 3), np.float32)
    tracemalloc.start()  # numpy tells it of its memory
    before = rss()
    welkin.project(pixels)
    assert tracemalloc.get_traced_memory()[1] < pixels.nbytes // 20
    tracemalloc.stop()
    assert rss() - before < pixels.nbytes // 2


def rss():
    """Peak memory of the process in bytes."""
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def test_no_copy_comes_out(image):
    chain = welkin.prefilter(image, size=32)
    first = chain.levels[0]
    assert np.shares_memory(first, chain.levels[0]) and np.shares_memory(first, chain[0])
    assert not np.shares_memory(first, chain[1])
    # One block: level after level.
    assert chain[1].ctypes.data == first.ctypes.data + first.nbytes
    assert sum(level.nbytes for level in chain.levels) == chain.nbytes
    table = welkin.brdf_table(width=16, height=16)
    assert np.shares_memory(table.values, welkin.brdf_table(width=16, height=16).values)
    with pytest.raises(ValueError):
        table.values[0] = 1


def test_arrays_outlive_what_they_came_from(image):
    level = welkin.prefilter(image, size=32)[2]
    kept = level.copy()
    light = welkin.bake(image, specular=False, brdf=False).irradiance
    sums = light.copy()
    gc.collect()
    churn = [np.random.random(level.size) for _ in range(50)]
    assert churn and (level == kept).all() and (light == sums).all()


def test_the_pixels_own_array_is_kept_while_they_are_read():
    assert welkin.project(np.ones((4, 8, 3), np.float32)).radiance.mean[0] == pytest.approx(1)


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.integers(0, 7), min_size=0, max_size=5),
    st.sampled_from([np.float32, np.float16, np.uint8, np.float64, bool, complex]),
    st.sampled_from(["", "lat-long", "vertical-strip", "horizontal-cross", "vertical-cross", "\0"]),
)
def test_any_array_is_projected_or_refused(shape, kind, layout):
    pixels = np.zeros(shape, kind)
    try:
        welkin.project(pixels, layout=layout, encoding="srgb" if kind is np.uint8 else None)
    except welkin.InvalidArgument:
        pass


def test_rows_that_lie_in_one_another_are_refused():
    """The memory of a face is as large as its rows are apart: these would not fit."""
    memory = np.zeros(4096, np.float32)
    rows = np.lib.stride_tricks.as_strided(memory, (16, 12, 3), (12, 12, 4))
    for layout in ("lat-long", "vertical-cross"):
        with pytest.raises(welkin.InvalidArgument, match="strides"):
            welkin.project(rows, layout=layout)


def test_faces_outlive_the_list_that_they_stand_in():
    """A callback may change the list while its arrays are read."""
    faces = [np.full((64, 64, 3), 1.0, np.float32) for _ in range(6)]
    chain = welkin.prefilter(faces, size=16, method="reference", progress=lambda share: faces.clear())
    assert np.allclose(chain[0], 1.0, rtol=1e-3)


def test_what_shows_itself_as_its_pixels_is_refused():
    class Endless:
        pixels = property(lambda self: self)

    with pytest.raises(TypeError, match="Endless"):
        welkin.project(Endless())


def test_array_copies_and_casts_as_numpy_asks():
    harmonics = welkin.project(np.ones((6, 4, 4, 3), np.float32)).radiance
    assert harmonics.__array__().base is not None
    copy = harmonics.__array__(copy=True)
    copy[:] = 7.0
    assert harmonics.coefficients[0, 0] != 7.0
    assert harmonics.__array__(np.float32).dtype == np.float32
    with pytest.raises(ValueError, match="copy"):
        harmonics.__array__(np.float32, copy=False)
