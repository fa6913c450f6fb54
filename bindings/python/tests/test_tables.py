"""Importance tables, octahedral maps, zonal lobes, and many cubemaps at once."""
import numpy as np
import pytest

import truth
import welkin


def test_a_tables_probabilities_are_luminance_by_solid_angle(image):
    table = welkin.importance_table(image)
    assert (table.width, table.height) == (64, 32)
    edges = np.sin(np.pi / 2 - np.pi * np.arange(33) / 32)
    solid = (2 * np.pi / 64) * (edges[:-1] - edges[1:])[:, None]
    expected = image.astype(float) @ (0.2126, 0.7152, 0.0722) * solid
    np.testing.assert_allclose(table.function, expected, rtol=1e-5)
    assert table.integral == pytest.approx(expected.sum())
    np.testing.assert_allclose(np.diff(table.row_cdf), expected.sum(axis=1) / expected.sum(), atol=1e-6)
    assert table.column_cdf.shape == (32, 65) and (table.column_cdf[:, -1] == 1).all()
    for part in (table.function, table.row_cdf, table.column_cdf):
        assert not part.flags.writeable and part.dtype == np.float32
    assert np.shares_memory(table.function, table.function)


def test_samples_are_by_the_density(image, rng):
    table = welkin.importance_table(image)
    across, down = rng.random((2, 50, 40))
    directions, densities = table.sample(across, down)
    assert directions.shape == (50, 40, 3) and densities.shape == (50, 40)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=-1), 1)
    np.testing.assert_allclose(table.density(directions), densities, rtol=1e-6)
    # The mean of 1 / density is the sphere.
    assert np.mean(1 / densities) == pytest.approx(4 * np.pi, rel=0.1)
    # `down` picks the row, and `across` the column in it.
    row = np.floor((0.5 - np.arcsin(directions[..., 1]) / np.pi) * 32).astype(int)
    column = np.floor((0.5 - np.arctan2(directions[..., 0], directions[..., 2]) / (2 * np.pi)) * 64).astype(int)
    for cdf, number in ((table.row_cdf, down), (table.column_cdf[row], across)):
        at = row if cdf.ndim == 1 else column
        below = cdf[at] if cdf.ndim == 1 else np.take_along_axis(cdf, at[..., None], -1)[..., 0]
        above = cdf[at + 1] if cdf.ndim == 1 else np.take_along_axis(cdf, at[..., None] + 1, -1)[..., 0]
        assert ((below - 1e-6 <= number) & (number <= above + 1e-6)).all()
    one, density = table.sample(0.5, 0.5)
    assert one.shape == (3,) and density > 0
    with pytest.raises(welkin.InvalidArgument, match="one shape"):
        table.sample([0.1, 0.2], 0.5)


def test_other_ways_of_picking_have_the_same_probabilities(image):
    table = welkin.importance_table(image, width=16, height=8, weight="largest")
    rows, columns = table.alias()
    assert rows.shape == (8,) and columns.shape == (8, 16) and rows.dtype.names == ("own", "other")
    found = rows["own"] / 8
    np.add.at(found, rows["other"], (1 - rows["own"]) / 8)
    np.testing.assert_allclose(found, np.diff(table.row_cdf), atol=1e-6)
    levels = table.pyramid()
    assert [level.shape for level in levels] == [(8, 16), (4, 8), (2, 4), (1, 2), (1, 1)]
    np.testing.assert_allclose(levels[0], table.function / table.integral, rtol=1e-5)
    np.testing.assert_allclose(levels[1], levels[0].reshape(4, 2, 8, 2).sum(axis=(1, 3)), rtol=1e-5)
    uniform, by_table = table.variance(image, weight="largest")
    assert 0 < by_table < uniform
    with pytest.raises(welkin.InvalidArgument, match="lat-long"):
        welkin.importance_table(np.ones((6, 4, 4, 3), np.float32))


def test_compensated_tables_leave_dim_light_out(image):
    assert (welkin.importance_table(image, mis_compensation=True).function == 0).sum() > 500


def test_an_octahedral_map_has_the_light_where_its_place_says(image):
    radiance = welkin.project(image).radiance
    octahedral = welkin.to_octahedral(radiance, size=64, border=2)
    (level,) = octahedral.levels
    assert level.shape == (64, 64, 3) and (octahedral.size, octahedral.border, len(octahedral)) == (64, 2, 1)
    at = (np.arange(60) + 0.5) / 60
    places = np.stack(np.meshgrid(at, at), axis=-1)  # column first
    directions = welkin.octahedral_decode(places)
    np.testing.assert_allclose(level[2:-2, 2:-2], radiance(directions), rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(welkin.octahedral_encode(directions), places, atol=1e-12)
    np.testing.assert_allclose(
        welkin.octahedral_encode([(0, 0, 1), (1, 0, 0), (0, 1, 0)]), [[0.5, 0.5], [1, 0.5], [0.5, 1]]
    )


def test_octahedral_maps_of_chains_are_written(image, tmp_path):
    chain = welkin.prefilter(image, size=32)
    octahedral = welkin.to_octahedral(chain, size=64, levels=3)
    assert [len(level) for level in octahedral.levels] == [64, 32, 16]
    report = welkin.write_texture(tmp_path / "map.ktx2", octahedral, format="rgba32f")
    assert report["values_clamped"] == 0 and (tmp_path / "map.ktx2").stat().st_size > 64 * 64 * 16
    with pytest.raises(TypeError, match="Chain"):
        welkin.to_octahedral(image)
    with pytest.raises(welkin.InvalidArgument):
        welkin.to_octahedral(chain, size=63, levels=3)


def test_the_lambert_lobe_gives_irradiance_over_pi(image):
    chain = welkin.prefilter(image, size=8, lobes=[welkin.ZonalLobe.lambert()])
    expected = welkin.irradiance(image, size=8, method="direct").cubemap / np.pi
    np.testing.assert_allclose(chain[0], expected, rtol=5e-3)


def test_kernels_are_functions_or_spectra(image):
    phong = welkin.ZonalLobe.phong(3.0)
    mine = welkin.ZonalLobe.from_function(lambda cosine: max(cosine, 0.0) ** 3)
    cosines = np.linspace(-1, 1, 9)
    np.testing.assert_allclose(mine.value(cosines), phong.value(cosines), atol=1e-6)
    np.testing.assert_allclose(phong.value(cosines), 4 / (2 * np.pi) * np.clip(cosines, 0, None) ** 3, atol=1e-9)
    np.testing.assert_allclose(mine.spectrum(6), phong.spectrum(6), atol=1e-6)
    constant = welkin.prefilter(image, size=4, lobes=[welkin.ZonalLobe.from_spectrum([1.0])])[0]
    np.testing.assert_allclose(
        constant, np.broadcast_to(welkin.project(image).radiance.mean, constant.shape), rtol=1e-3
    )
    directions, _ = truth.cubemap_directions(4)
    reference = welkin.reference_specular(image, phong, directions)
    assert truth.relative(welkin.prefilter(image, size=4, lobes=[phong])[0], reference) < 5e-3
    assert welkin.ZonalLobe.charlie(0.4).roughness == 0.4 and phong.roughness == 0
    roughness = [0.1, 0.3, 1.0]
    sheen = welkin.prefilter(image, size=64, lobes=[welkin.ZonalLobe.charlie(r) for r in roughness])
    np.testing.assert_allclose([mip.roughness for mip in sheen.mips], roughness)


def test_wrong_kernels_are_said(image):
    with pytest.raises(welkin.InvalidArgument, match="roughness"):
        welkin.prefilter(image, lobes=[welkin.ZonalLobe.lambert()], roughness=[0.5])
    with pytest.raises(TypeError, match="lobes"):
        welkin.prefilter(image, lobes=[0.5])
    with pytest.raises(welkin.InvalidArgument):
        welkin.ZonalLobe.phong(-1)
    with pytest.raises(ZeroDivisionError):
        welkin.ZonalLobe.from_function(lambda cosine: 1 / 0)
    with pytest.raises(TypeError, match="ZonalLobe"):
        welkin.reference_specular(image, "rough", [(0, 1, 0)])


def test_a_level_of_a_chain_is_projected_for_a_target_size(faces):
    faces[...] = np.round(faces * 16)  # means of them are exact
    chain = welkin.build_mips(faces, filter="box")
    levels = chain.levels
    third = welkin.project(levels[2]).radiance.coefficients
    assert not np.allclose(third, welkin.project(faces).radiance.coefficients, rtol=1e-9)
    for given in (chain, levels):
        found = welkin.project(given, target_size=4)
        assert (found.radiance.coefficients == third).all() and found.diagnostics.texels == 96
        assert (welkin.project(given).radiance.coefficients == welkin.project(faces).radiance.coefficients).all()
    with pytest.raises(welkin.InvalidArgument):
        welkin.project([levels[0], levels[2]], target_size=4)


def test_many_projections_are_single_ones(rng):
    probes = rng.random((5, 6, 8, 8, 3), dtype=np.float32)
    many = welkin.project_many(probes, bands=4)
    assert many.coefficients.shape == (5, 16, 3) and len(many) == 5 and many.specular == []
    others = [probes[0], list(probes[1]), probes[2].astype(np.float16), rng.random((6, 3, 3, 4), dtype=np.float32)]
    for found, probe in zip(many.coefficients, probes):
        assert (found == welkin.project(probe, bands=4).radiance.coefficients).all()
    for found, probe in zip(welkin.project_many(others).coefficients, others):
        assert (found == welkin.project(probe).radiance.coefficients).all()
    assert many.diagnostics.texels == 5 * 6 * 64
    assert welkin.project_many([]).coefficients.shape == (0, 9, 3)
    with pytest.raises(welkin.InvalidArgument, match="lat-long"):
        welkin.project_many([probes[0], np.ones((4, 8, 3), np.float32)])
    with pytest.raises(TypeError, match="probes"):
        welkin.project_many(7)


@pytest.mark.parametrize("kind", ["float16", "float32"])
def test_many_bakes_are_single_ones(rng, kind):
    probes = rng.random((3, 6, 16, 16, 3), dtype=np.float32)
    many = welkin.bake_many(probes, size=8, mips=3, type=kind, threads=2)
    assert [level.shape for level in many.specular] == [(3, 6, n, n, 4) for n in (8, 4, 2)]
    for index, probe in enumerate(probes):
        chain = welkin.prefilter(probe, size=8, mips=3)
        for level, expected in zip(many.specular, chain.levels):
            assert level.dtype == kind and (level[index, ..., 3] == 1).all()
            assert (level[index, ..., :3] == expected.astype(kind)).all()
        assert (many.coefficients[index] == welkin.project(probe).radiance.coefficients).all()
    assert welkin.bake_many(probes, size=8, roughness=[0.5], bands=0).coefficients.shape == (3, 0, 3)
    for wrong in ({"mips": 9}, {"mips": 0}, {"size": 0}, {"bands": 17}, {"type": "uint8"}):
        with pytest.raises(welkin.InvalidArgument):
            welkin.bake_many(probes, **{"size": 8, **wrong})


def test_these_objects_say_what_they_are(image, faces):
    objects = [
        welkin.importance_table(image),
        welkin.to_octahedral(welkin.project(image).radiance),
        welkin.ZonalLobe.charlie(0.3),
        welkin.bake_many([faces], size=4),
    ]
    assert [repr(each) for each in objects] == [
        "<welkin.ImportanceTable: 64 x 32>",
        "<welkin.OctahedralMap: 256 x 256, border 1, 1 level>",
        "<welkin.ZonalLobe: charlie, roughness 0.3>",
        "<welkin.ManyLights: 1 probe, 3 mips>",
    ]
