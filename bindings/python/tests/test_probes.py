"""Grids of light probes, and the sun by date."""
import datetime

import numpy as np
import pytest
import welkin

COUNTS = (3, 1, 2)


def captures(size=4):
    pixels = np.ones((6, 6, size, size, 3), np.float32)
    pixels[..., 0] += np.arange(6)[:, None, None, None]
    depths = np.full((6, 6, size, size), 2.0, np.float32)
    depths[2] = -0.3  # the third probe stands in a wall
    return pixels, depths


def test_a_grid_is_baked_looked_up_and_read_back(tmp_path):
    pixels, depths = captures()
    probes = welkin.bake_probes(
        pixels, depths, counts=COUNTS, origin=(1, 2, 3), spacing=(1, 2, 1), distance_size=4, environment_bands=2
    )
    assert len(probes) == 6 and probes.counts == COUNTS
    assert probes.coefficients.shape == (6, 9, 3) and probes.distances.shape == (6, 6, 6, 2)
    assert probes.sky.shape == (6, 16) and list(probes.passes) == [0, 0, 1, 0, 0, 0]
    np.testing.assert_array_equal(probes.coefficients[0], welkin.project(pixels[0]).radiance.coefficients)
    np.testing.assert_array_equal(probes.positions[4], (2, 2, 4))
    light = probes.irradiance(probes.positions[:2], [(0, 1, 0), (0, 0, 1)], visibility=False, normal_bias=0.0)
    np.testing.assert_allclose(light, np.pi * np.array([(1, 1, 1), (2, 1, 1)]), rtol=1e-5)
    with pytest.raises(welkin.InvalidArgument, match="2 positions and 1 normals"):
        probes.irradiance(probes.positions[:2], [(0, 1, 0)])

    with pytest.raises(welkin.InvalidArgument, match="2 values; the grid has 6 probes"):
        welkin.bake_probes(pixels, depths, counts=COUNTS, spacing=(1, 2, 1), offsets=np.zeros((2, 3)))

    offsets = welkin.relocate_probes(depths, counts=COUNTS, spacing=(1, 2, 1))
    assert offsets.shape == (6, 3) and np.count_nonzero(offsets.any(axis=1)) == 1
    np.testing.assert_allclose(np.linalg.norm(offsets[2]), 0.3 + 0.12, rtol=1e-6)
    assert probes.offsets is None
    probes.offsets = offsets
    probes.write(tmp_path / "level.json", ["bevy", "rtxgi", "three"])
    assert (tmp_path / "level_rtxgi_data.ktx2").exists() and (tmp_path / "level_three.json").exists()
    again = welkin.read_probes(tmp_path / "level.json")
    for name in ("coefficients", "validity", "passes", "distances", "sky", "offsets"):
        np.testing.assert_array_equal(getattr(again, name), getattr(probes, name))


def test_textures_of_engines_have_their_shapes():
    pixels, depths = captures()
    probes = welkin.bake_probes(pixels, depths, counts=COUNTS)
    voxels = probes.pack("bevy")["voxels"]
    assert voxels.shape == (6, 2, 3, 4) and voxels.dtype == np.float16
    np.testing.assert_allclose(voxels[0, 0, :2, 0], (1, 2), rtol=1e-3)
    maps = probes.pack("rtxgi")
    assert {name: maps[name].shape for name in maps} == {
        "irradiance": (1, 16, 24, 4),
        "distance": (1, 20, 30, 4),
        "data": (1, 2, 3, 4),
    }
    np.testing.assert_allclose(maps["irradiance"][0, 3, 3, 1].astype(float) ** 5 * 2, 1, rtol=5e-3)
    with pytest.raises(welkin.InvalidArgument, match="unity-l2"):
        probes.pack("unity")
    with pytest.raises(TypeError, match="counts"):
        welkin.bake_probes(pixels)
    with pytest.raises(welkin.InvalidArgument, match="size, size"):
        welkin.bake_probes(pixels, depths[0], counts=COUNTS)
    assert "probe_offset" in welkin.probe_sampling_code("wgsl")


def test_probes_are_relit():
    pixels, depths = captures()
    depths[:] = np.inf
    probes = welkin.bake_probes(pixels, depths, counts=COUNTS, environment_bands=3)
    sky = welkin.project(pixels[0]).radiance
    before = probes.coefficients.copy()
    probes.relight(sky, sky * 2.0)
    np.testing.assert_allclose(probes.coefficients[0], 2 * before[0], atol=1e-5)


def test_the_sun_stands_where_astropy_has_it():
    sun = welkin.sun_position("2026-06-21T20:30+02:00", 52.5, 13.4)
    assert sun["elevation"] == pytest.approx(6.9232, abs=0.002)
    assert sun["compass"] == pytest.approx(299.9915, abs=0.002)
    np.testing.assert_array_equal(sun["direction"], welkin.sun_direction(sun["elevation"], sun["azimuth"]))
    moment = datetime.datetime(2026, 6, 21, 18, 30, tzinfo=datetime.timezone.utc)
    assert welkin.sun_position(moment, 52.5, 13.4)["azimuth"] == sun["azimuth"]
    raised = welkin.sun_position(moment.timestamp(), 52.5, 13.4, refraction=True, north=0.0)
    assert raised["elevation"] == pytest.approx(sun["elevation"] + raised["refraction"])
    with pytest.raises(welkin.InvalidArgument, match="time zone"):
        welkin.sun_position(moment.replace(tzinfo=None), 52.5, 13.4)
    with pytest.raises(welkin.InvalidArgument, match="1900 to 2099"):
        welkin.sun_position("1850-01-01T00:00Z", 0, 0)
