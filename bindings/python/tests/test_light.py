"""Reflections, bakes, plans and skies."""
import numpy as np
import pytest

import truth
import welkin


def test_even_light_stays_even_on_every_mip():
    chain = welkin.prefilter(np.full((6, 32, 32, 3), 2, np.float32), size=32)
    assert [len(level[0]) for level in chain.levels] == [mip.size for mip in chain.mips]
    for level in chain.levels:
        # Rings of latitude, on the way of the sharpest mip, are as even as that.
        np.testing.assert_allclose(level, 2, rtol=1e-4)


def test_energy_is_the_same_on_every_mip(image):
    chain = welkin.prefilter(image, size=64, roughness=[0, 0.4, 0.7, 1.0])
    _, weights = truth.lat_long_directions(32)
    mean = np.einsum("hwc,hw->c", image.astype(float), weights) / (4 * np.pi)
    for level, mip in zip(chain.levels, chain.mips):
        np.testing.assert_allclose(mip.mean, mean, rtol=2e-3)
        _, solid = truth.cubemap_directions(len(level[0]))
        found = np.einsum("fvuc,fvu->c", level.astype(float), solid) / solid.sum()
        np.testing.assert_allclose(found, mean, rtol=2e-2)


def test_texels_are_the_reference(image):
    chain = welkin.prefilter(image, size=16, roughness=[0.0, 0.5])
    directions, _ = truth.cubemap_directions(8)
    expected = welkin.reference_specular(image, 0.5, directions[:, ::4, ::4])
    assert truth.relative(chain[1][:, ::4, ::4], expected) < 2e-3


def test_schedules_are_named():
    roughness = welkin.mip_roughness("filament", 5, 256)
    chain = welkin.prefilter(np.ones((8, 16, 3), np.float32), size=256, mips=5, roughness="filament")
    np.testing.assert_allclose([mip.roughness for mip in chain.mips], roughness)
    assert welkin.mip_for_roughness(roughness, roughness[2]) == pytest.approx(2)
    with pytest.raises(welkin.InvalidArgument, match="unreal"):
        welkin.prefilter(np.ones((8, 16, 3), np.float32), roughness="steep")
    with pytest.raises(welkin.InvalidArgument, match="unreal"):
        welkin.prefilter(np.ones((8, 16, 3), np.float32), roughness="")


def test_lobes_are_fitted_to_lookups():
    pixels = np.random.default_rng(1).random((16, 32, 3), np.float32)
    lobes = welkin.fitted_mip_roughness("filament", 4, 16)
    chain = welkin.prefilter(pixels, size=16, mips=4, lobe_roughness="fitted")
    assert [mip.lobe_roughness for mip in chain.mips] == lobes
    assert [mip.roughness for mip in chain.mips] == welkin.mip_roughness("filament", 4, 16)
    assert chain.mips[0].error_between > 0 and chain.mips[-1].error_between is None
    same = welkin.prefilter(pixels, size=16, roughness=lobes)
    assert all((a == b).all() for a, b in zip(chain.levels, same.levels))
    with pytest.raises(welkin.InvalidArgument, match="name a schedule"):
        welkin.prefilter(pixels, size=16, roughness=[0.0, 1.0], lobe_roughness="fitted")


def test_a_bake_is_its_parts(image):
    light = welkin.bake(image, specular={"size": 32, "mips": 3}, background={"size": 16}, irradiance={"size": 8})
    assert (light.radiance.coefficients == welkin.project(image).radiance.coefficients).all()
    chain = welkin.prefilter(image, size=32, mips=3)
    assert all((a == b).all() for a, b in zip(light.specular.levels, chain.levels))
    direct = welkin.irradiance(image, size=8, method="direct").cubemap
    np.testing.assert_allclose(light.irradiance, direct, rtol=2e-3)
    bands = welkin.bake(image, specular=False, brdf=False, irradiance={"size": 8, "method": "harmonics"}).irradiance
    assert (bands == welkin.irradiance(image, size=8).cubemap).all() and not np.allclose(bands, direct, rtol=2e-3)
    exact = welkin.bake(image, specular=False, brdf=False, irradiance={"size": 8, "rms_error": 1e-6}).irradiance
    assert (exact == direct).all()
    truth = welkin.bake(image, specular={"size": 4}, brdf=False, irradiance={"size": 8}, quality="reference")
    assert (truth.irradiance == direct).all() and truth.specular.mips[-1].method == "reference"
    loose = welkin.bake(image, specular={"size": 32, "mips": 3, "rms_error": 1e-3}, quality="fast").specular
    assert all((a == b).all() for a, b in zip(loose.levels, chain.levels))  # a bound that is given wins
    with pytest.raises(welkin.InvalidArgument, match="irradiance.rms_error"):
        welkin.bake(image, irradiance={"rms_error": 0.0})
    assert len(light.background) == 5 and light.brdf.values.shape == (64, 64, 3)
    less = welkin.bake(image, specular=False, background=False, irradiance=False, brdf=False)
    assert less.specular is less.background is less.irradiance is less.brdf is None and less.radiance.bands == 3


def test_lobes_are_those_of_kernels(image):
    sheen = {"size": 16, "roughness": [0.5, 0.8], "lobe": "charlie"}
    truth = welkin.prefilter(image, size=16, lobes=[welkin.ZonalLobe.charlie(r) for r in sheen["roughness"]])
    light = welkin.bake(image, specular=sheen, background=False, irradiance=False, brdf=False)
    assert all((a == b).all() for a, b in zip(light.specular.levels, truth.levels))
    spectra = [[1, 0.5, 0.25], [1, 0.25]]
    truth = welkin.prefilter(image, size=16, lobes=[welkin.ZonalLobe.from_spectrum(each) for each in spectra])
    found = welkin.prefilter(image, size=16, lobe="spectra", spectra=spectra)
    assert all((a == b).all() for a, b in zip(found.levels, truth.levels))
    probes = np.ones((2, 6, 8, 8, 3), np.float32)
    assert len(welkin.bake_many(probes, size=8, lobe="lambert").specular) == 1
    with pytest.raises(welkin.InvalidArgument, match="spectra"):
        welkin.prefilter(image, spectra=spectra)
    with pytest.raises(welkin.InvalidArgument, match="blinn"):
        welkin.prefilter(image, lobe="velvet")


def test_a_bake_has_the_octahedral_map_of_its_reflections(image):
    only = {"background": False, "irradiance": False, "brdf": False}
    how = {"size": 32, "levels": 3}
    light = welkin.bake(image, specular={"size": 16, "mips": 3}, octahedral=how, **only)
    truth = welkin.to_octahedral(welkin.prefilter(image, size=16, mips=3), **how)
    assert light.octahedral.border == 4 and len(light.octahedral) == 3
    assert all((a == b).all() for a, b in zip(light.octahedral.levels, truth.levels))
    assert welkin.bake(image, **only).octahedral is None
    with pytest.raises(welkin.InvalidArgument, match="specular"):
        welkin.bake(image, specular=False, octahedral=True, **only)


def test_threads_do_not_change_bits(image):
    one, two = (welkin.bake(image, specular={"size": 32}, threads=n) for n in (1, 2))
    assert all((a == b).all() for a, b in zip(one.specular.levels, two.specular.levels))


def test_a_plan_says_what_its_bake_does(image):
    plan = welkin.plan(image, needs={"glossy": False, "background": False}, specular={"size": 32})
    assert {step.name: step.action for step in plan.passes}["specular"] == "skip" and "glossy" in str(plan)
    light = welkin.bake(image, plan=plan)
    assert light.specular is None and light.irradiance is not None
    assert plan.result_bytes > 0 and plan.working_bytes > 0
    assert welkin.plan((32, 64, 3)).source == plan.source == "lat-long 64 x 32"
    assert welkin.plan((6, 32, 32, 3)).source == "cubemap of 32"
    with pytest.raises(welkin.InvalidArgument):
        welkin.bake(np.ones((6, 4, 4, 3), np.float32), plan=plan)
    with pytest.raises(welkin.LimitExceeded) as caught:
        welkin.bake(image, memory_limit=1000)
    assert isinstance(caught.value, MemoryError)


def test_split_sum_of_a_mirror_is_all_of_the_light():
    table = welkin.brdf_table(width=8, height=256, model="split-sum").values
    np.testing.assert_allclose(table[0, -1, 0] + table[0, -1, 1], 1, atol=1e-3)


def test_a_sky_is_seen_as_its_pictures(small_sky):
    sun = welkin.sun_direction(35.0, 60.0)
    np.testing.assert_allclose(np.linalg.norm(sun), 1)
    image = small_sky.lat_long(sun, 32)
    directions, _ = truth.lat_long_directions(32)
    np.testing.assert_allclose(small_sky.radiance(directions, sun), image, rtol=1e-4)
    projected = welkin.project(small_sky.cubemap(sun, 64)).radiance.coefficients
    harmonics = small_sky.harmonics(sun)
    assert truth.relative(harmonics.coefficients, projected) < 0.02
    curve = small_sky.curve(nodes=64)
    assert truth.relative(curve(sun).coefficients, harmonics.coefficients) < 0.02
    np.testing.assert_allclose(curve.sun_irradiance(sun), small_sky.sun(sun)["irradiance"], rtol=0.02)
    assert small_sky.tables["transmittance"].shape == (64, 256, 3)
    assert not small_sky.tables["scattering"].flags.writeable
    assert small_sky.at_altitude(5000.0).altitude == 5000
    with pytest.raises(welkin.InvalidArgument, match="sun"):
        small_sky.harmonics((0, 0))


def test_a_saved_sky_is_the_same(small_sky, tmp_path):
    small_sky.save(tmp_path / "sky.tables")
    again = welkin.load_sky(tmp_path / "sky.tables")
    assert (again.tables["scattering"] == small_sky.tables["scattering"]).all()


def test_pictures_turn_and_change_shape(image):
    turned = welkin.to_lat_long(image, 32, rotation=welkin.rotation_about_y(90))
    np.testing.assert_array_equal(turned, np.roll(image, -16, axis=1))
    cube = welkin.to_cubemap(image, 32)
    assert truth.relative(welkin.project(cube).radiance.mean, welkin.project(image).radiance.mean) < 1e-4
    assert len(welkin.build_mips(cube)) == 6


def test_objects_say_what_they_are(image, small_sky):
    light = welkin.bake(image, specular={"size": 16})
    objects = [light, light.specular, light.background, light.radiance, light.brdf, light.diagnostics, small_sky]
    objects += [light.specular.mips[0], light.diagnostics.passes[0], welkin.plan(image), welkin.PixelPolicy(clamp=2)]
    objects += [welkin.engine_light(light.radiance, "three"), light.radiance.window(), welkin.irradiance(image)]
    for each in objects:
        assert type(each).__name__ in repr(each) and len(repr(each)) < 300
    for each in (light, light.specular, light.background):
        assert each._repr_png_().startswith(b"\x89PNG")
    assert welkin.irradiance(image)._repr_png_() is None
