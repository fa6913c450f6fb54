"""Calls of the package as a typed program makes them: mypy --strict reads it, and test_stubs.py runs it."""
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import welkin

FACES = np.random.default_rng(1).random((6, 8, 8, 3), dtype=np.float32)
PANORAMA = np.random.default_rng(2).random((8, 16, 3), dtype=np.float32)


def harmonics() -> NDArray[np.float64]:
    found: welkin.Projection = welkin.project(FACES, bands=4, policy=welkin.PixelPolicy(clamp=10.0), threads=1)
    light: welkin.SphericalHarmonics = found.radiance.rotate(welkin.rotation_about_y(20.0)) + 2 * found.radiance
    windowed: welkin.WindowResult = light.window("lanczos", width=4.0)
    form: welkin.EngineLight = welkin.engine_light(windowed.harmonics, "unity")
    assert form.vectors["unity_SHAr"].shape == (4,)
    dominant = light.dominant_light()
    if dominant is not None:
        direction, _ = dominant
        light = light.lerp(welkin.SphericalHarmonics(4), 0.5) * (1.0, 0.5, float(direction[1]))
    light = -light / 2 + sum([light, light], welkin.SphericalHarmonics(4))
    assert light == light and len(light) == 16 and [each.shape for each in light] == [(3,)] * 16
    return light.irradiance()([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])


def reflections(folder: Path) -> list[NDArray[np.float32]]:
    shares: list[float] = []
    light: welkin.Bake = welkin.bake(
        PANORAMA, specular={"size": 16, "roughness": "linear", "mips": 3}, brdf=False, progress=shares.append
    )
    assert light.specular is not None and light.radiance is not None and shares[-1] == 1.0
    sheen: welkin.Reflections = welkin.prefilter(FACES, size=8, lobes=[welkin.ZonalLobe.phong(4.0)])
    octahedral: welkin.OctahedralMap = welkin.to_octahedral(light.specular, size=32)
    welkin.write_texture(folder / "map.ktx2", octahedral, format="rgba32f")
    report = welkin.write_texture(str(folder / "sheen.dds"), sheen)
    assert report["files"] == [folder / "sheen.dds"]
    again: welkin.Texture = welkin.read_texture(folder / "sheen.dds")
    many: welkin.ManyLights = welkin.bake_many([FACES, again], size=8, mips=2, type="float32")
    assert many.coefficients.shape == (2, 9, 3)
    welkin.write(folder / "sky.hdr", PANORAMA)
    from_file: welkin.Reflections = welkin.prefilter(folder / "sky.hdr", size=8, read={"layout": "lat-long"})
    return light.specular[1:] + octahedral.levels + [from_file[0]]


def others() -> float:
    table: welkin.ImportanceTable = welkin.importance_table(PANORAMA, weight="mean")
    directions, densities = table.sample([0.25, 0.5], [0.5, 0.75])
    assert np.allclose(table.density(directions), densities)
    plan: welkin.Plan = welkin.plan((8, 16, 3), needs={"glossy": (0.0, 0.5)})
    try:
        welkin.read(b"no picture")
    except welkin.UnsupportedFile as error:
        assert error.code == "unsupported_file"
    return plan.result_bytes + table.integral
