"""Pixels to coefficients, against explicit sums in numpy."""
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import truth
import welkin

small_images = arrays.arrays(np.float32, (4, 8, 3), elements=st.floats(0, 100, width=32))


@settings(max_examples=30, deadline=None)
@given(small_images)
def test_projection_of_a_lat_long_is_its_explicit_sum(pixels):
    expected = truth.project_lat_long(pixels, fine=32)
    found = welkin.project(pixels).radiance.coefficients
    assert np.linalg.norm(found - expected) <= 1e-3 * np.linalg.norm(expected) + 1e-6


def test_projection_of_faces_is_their_explicit_sum(rng):
    directions, weights = truth.cubemap_directions(64)
    smooth = np.exp(directions @ rng.normal(size=(3, 3))).astype(np.float32)
    expected = np.einsum("fvuk,fvuc,fvu->kc", truth.basis(directions), smooth, weights)
    assert truth.relative(welkin.project(smooth).radiance.coefficients, expected) < 1e-3


@settings(max_examples=20, deadline=None)
@given(small_images, small_images, st.floats(0, 4, width=32))
def test_projection_is_linear(a, b, factor):
    factor = np.float32(factor)
    of = lambda pixels: welkin.project(pixels).radiance.coefficients  # noqa: E731
    expected = of(a) + factor * of(b)
    assert np.linalg.norm(of(a + factor * b) - expected) <= 1e-5 * np.linalg.norm(expected) + 1e-5


def test_basis_is_that_of_numpy(rng):
    directions = rng.normal(size=(5, 7, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    found = welkin.basis(directions, 3)
    assert found.shape == (5, 7, 9)
    np.testing.assert_allclose(found, truth.basis(directions), atol=1e-13)


def test_a_turned_picture_has_turned_coefficients(image):
    quarter = np.roll(image, 16, axis=1)  # texels move right by a quarter
    turn = np.round(welkin.rotation_about_y(-90.0))
    expected = welkin.project(quarter).radiance.coefficients
    assert truth.relative(welkin.project(image).radiance.rotate(turn).coefficients, expected) < 1e-6


def test_turns_keep_power_and_values(image, rng):
    harmonics = welkin.project(image, bands=5).radiance
    turn = truth.rotation(rng)
    turned = harmonics.rotate(turn)
    for band in range(5):
        part = slice(band**2, (band + 1) ** 2)
        before = np.linalg.norm(harmonics.coefficients[part], axis=0)
        np.testing.assert_allclose(np.linalg.norm(turned.coefficients[part], axis=0), before, rtol=1e-12)
    directions = rng.normal(size=(20, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    np.testing.assert_allclose(turned(directions @ turn.T), harmonics(directions), rtol=1e-10, atol=1e-12)


def test_a_quaternion_is_its_matrix(image):
    harmonics = welkin.project(image).radiance
    half = np.radians(70) / 2
    by_quaternion = harmonics.rotate((2 * np.cos(half), 0, 2 * np.sin(half), 0))
    np.testing.assert_allclose(
        by_quaternion.coefficients, harmonics.rotate(welkin.rotation_about_y(70)).coefficients, atol=1e-12
    )


def test_irradiance_of_even_light_is_pi():
    light = welkin.irradiance(np.ones((8, 16, 3), np.float32), size=4)
    np.testing.assert_allclose(light.harmonics((0, 1, 0)), np.pi, rtol=1e-6)
    np.testing.assert_allclose(light.cubemap, np.pi, rtol=1e-6)


def test_irradiance_of_a_linear_sky_has_a_closed_form():
    directions, _ = truth.lat_long_directions(64)
    pixels = (2 + directions[..., 1:2] * np.array([1.0, 0.5, 0.25])).astype(np.float32)
    up = welkin.project(pixels).irradiance((0, 1, 0))
    np.testing.assert_allclose(up, 2 * np.pi + 2 * np.pi / 3 * np.array([1, 0.5, 0.25]), rtol=1e-4)


def test_irradiance_by_bands_is_the_direct_one_on_smooth_light():
    directions, _ = truth.lat_long_directions(32)
    pixels = (1 + 0.3 * directions**2).astype(np.float32)
    normals = np.array([[[0, 1, 0], [1, 0, 0]]], float)
    direct = welkin.direct_irradiance(pixels, normals)
    assert direct.shape == (1, 2, 3)
    np.testing.assert_allclose(welkin.irradiance(pixels).harmonics(normals), direct, rtol=1e-3)
    assert welkin.irradiance(pixels, size=4, method="direct").cubemap.shape == (6, 4, 4, 3)


def test_bands_add_up(image):
    a = welkin.project(image).radiance
    twice = a + a
    np.testing.assert_allclose(twice.coefficients, (2 * a).coefficients)
    np.testing.assert_allclose((twice - a).coefficients, a.coefficients)
    np.testing.assert_allclose(a.lerp(twice, 0.5).coefficients, (a * 1.5).coefficients)
    np.testing.assert_allclose((a * (1, 0, 2)).coefficients, a.coefficients * (1, 0, 2))
    assert a.resized(5).bands == 5
    assert a.product(a).bands == 5


def test_a_window_leaves_no_negative_irradiance():
    pixels = np.zeros((32, 64, 3), np.float32)
    pixels[3, 5] = 1000
    radiance = welkin.project(pixels).radiance
    windowed = radiance.window()
    assert windowed.minimum_before.max() < 0 and windowed.minimum_after.min() > -1e-6 * radiance.mean.max() * np.pi
    np.testing.assert_allclose(windowed.harmonics.mean, radiance.mean)
    values, directions = radiance.irradiance().minimum()
    np.testing.assert_allclose(values, windowed.minimum_before, rtol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1)
    direction, _ = radiance.dominant_light()
    expected = truth.lat_long_directions(32)[0][3, 5]
    assert direction @ expected > 0.99


def test_coefficients_are_the_objects_own(image):
    harmonics = welkin.project(image).radiance
    harmonics.coefficients[0] = 7
    assert (harmonics.coefficients[0] == 7).all()
    assert np.shares_memory(np.asarray(harmonics), harmonics.coefficients)


def test_policy_counts_and_rejects(image):
    image[0, 0, 0] = np.nan
    image[1, 1, 1] = -1
    found = welkin.project(image, policy=welkin.PixelPolicy(negative="replace", clamp=10)).diagnostics
    assert (found.nans_replaced, found.negatives_replaced, found.texels_clamped) == (1, 1, 1)
    with pytest.raises(welkin.RejectedPixel, match="row 0") as caught:
        welkin.project(image, policy=welkin.PixelPolicy(nan="reject"))
    assert caught.value.code == "rejected_pixel" and isinstance(caught.value, welkin.Error)


def test_engine_forms_have_their_formulas(image):
    radiance = welkin.project(image).radiance
    unity = welkin.engine_light(radiance, "unity")
    irradiance = radiance.irradiance()
    # The shader's sum for a normal of Unity's, which is Welkin's by the convention.
    normal = np.array([0.48, 0.6, 0.64])
    x, y, z = normal
    value = [
        unity.vectors[f"unity_SHA{c}"] @ [x, y, z, 1]
        + unity.vectors[f"unity_SHB{c}"] @ [x * y, y * z, z * z, z * x]
        + unity.vectors["unity_SHC"][i] * (x * x - y * y)
        for i, c in enumerate("rgb")
    ]
    there = np.linalg.inv(welkin.conventions()["unity"].from_welkin) @ normal
    np.testing.assert_allclose(value, irradiance(there) / np.pi, rtol=1e-6)
    assert len(welkin.engine_light(radiance, "babylon").terms) == 9
    own = list(welkin.engine_light(radiance, "welkin").terms.values())
    basis = [1, y, z, x, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y]
    np.testing.assert_allclose(np.dot(basis, own), irradiance(normal) / np.pi, rtol=1e-6)
    with pytest.raises(welkin.InvalidArgument, match="babylon"):
        welkin.engine_light(radiance, "blender")
