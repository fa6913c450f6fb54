"""The types in welkin/__init__.pyi are those of the package that runs."""
import inspect
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import welkin

pytest.importorskip("mypy")
HERE = pathlib.Path(__file__).resolve().parent


def output_of(module, *arguments):
    run = subprocess.run([sys.executable, "-m", module, *arguments], cwd=HERE, capture_output=True, text=True)
    return run.returncode, run.stdout + run.stderr


def test_stubs_name_all_that_is_there_with_its_arguments_and_no_more():
    code, said = output_of(
        "mypy.stubtest", "welkin", "--mypy-config-file", "mypy.ini", "--allowlist", "stubtest_allowlist.txt"
    )
    assert code == 0, said


def test_a_typed_program_passes_and_runs(tmp_path):
    code, said = output_of("mypy", "--strict", "typed_use.py")
    assert code == 0, said
    import typed_use

    assert typed_use.harmonics().shape == (2, 3)
    assert all(level.dtype == np.float32 for level in typed_use.reflections(tmp_path))
    assert typed_use.others() > 0


WRONG = {
    "welkin.project(FACES, band=3)": "call-arg",
    "welkin.project(FACES, bands='3')": "arg-type",
    "welkin.engine_light(LIGHT, 'threejs')": "arg-type",
    "welkin.bake(FACES).specular.levels": "union-attr",
    "welkin.prefilter(FACES, lobes=[0.5])": "list-item",
    "welkin.bake(FACES, specular={'sizes': 3})": "typeddict-item|arg-type|misc",
    "x: int = welkin.write('a', FACES)['files']": "assignment",
    "LIGHT.coefficients = 1": "misc",
    "welkin.no_such_call": "attr-defined",
}


def test_wrong_programs_are_refused(tmp_path):
    lines = ["import numpy as np", "import welkin", "FACES = np.zeros((6, 4, 4, 3), np.float32)",
             "LIGHT = welkin.SphericalHarmonics(3)"]  # fmt: skip
    program = tmp_path / "wrong.py"
    program.write_text("\n".join(lines + list(WRONG)))
    _, said = output_of("mypy", "--strict", "--show-error-codes", str(program))
    for number, (wrong, kinds) in enumerate(WRONG.items(), len(lines) + 1):
        found = [line for line in said.splitlines() if f"wrong.py:{number}:" in line and "error" in line]
        assert any(f"[{kind}]" in line for line in found for kind in kinds.split("|")), (wrong, found)


def test_signatures_name_the_options_that_calls_take(image, faces, small_sky, tmp_path):
    file = welkin.encode("sky.pfm", image)
    cube = welkin.encode("cube.pfm", faces, "vertical-strip")
    table, sun = welkin.importance_table(image), (0, 0.5, 1)
    calls = {
        welkin.project: [(image,), (file,)],
        welkin.irradiance: [(image,), (file,)],
        welkin.direct_irradiance: [(image, sun), (file, sun)],
        welkin.prefilter: [(image,), (file,)],
        welkin.reference_specular: [(image, 0.5, sun), (file, 0.5, sun)],
        welkin.brdf_table: [()],
        welkin.build_mips: [(faces,), (file,)],
        welkin.to_octahedral: [(welkin.SphericalHarmonics(3),)],
        welkin.bake: [(image,), (file,)],
        welkin.project_many: [([faces],), ([],), ([cube],)],
        welkin.bake_many: [([faces],), ([],), ([cube],)],
        welkin.bake_probes: [([faces],), ([],), ([cube],)],
        welkin.relocate_probes: [(np.ones((1, 6, 2, 2), np.float32),)],
        welkin.sun_position: [("2026-06-21T18:30Z", 52.5, 13.4)],
        welkin.plan: [(image,), (file,)],
        welkin.importance_table: [(image,), (file,)],
        welkin.sky: [()],
        welkin.load_sky: [(tmp_path / "sky",)],
        welkin.read: [(file,)],
        welkin.inspect: [(file,)],
        welkin.measure: [(file,)],
        welkin.write: [(tmp_path / "sky.pfm", image), (tmp_path / "sky.pfm", file)],
        welkin.encode: [("sky.pfm", image), ("sky.pfm", file)],
        welkin.read_texture: [(file,)],
        welkin.write_texture: [(tmp_path / "sky.ktx2", faces), (tmp_path / "sky.ktx2", cube)],
        welkin.to_cubemap: [(image, 4), (file, 4)],
        welkin.to_lat_long: [(image, 4), (file, 4)],
        welkin.preview: [(image,), (file,)],
        welkin.tone_mapped: [(image,), (file,)],
        table.alias: [()],
        table.pyramid: [()],
        table.variance: [(image,), (file,)],
        small_sky.harmonics: [(sun,)],
        small_sky.curve: [()],
        small_sky.cubemap: [(sun, 4)],
        small_sky.lat_long: [(sun, 4)],
    }
    for call, arguments in calls.items():
        taken = set()
        for each in arguments:
            with pytest.raises(TypeError, match='takes no argument "nonsense"; it takes ') as caught:
                call(*each, nonsense=1)
            taken |= set(str(caught.value).split("it takes ")[1].split(", "))
        parameters = inspect.signature(call).parameters.values()
        named = {p.name for p in parameters if p.kind is p.KEYWORD_ONLY}
        # `layout` of `write` is an argument of its own, the file's.
        assert taken - {p.name for p in parameters if p.kind is not p.KEYWORD_ONLY} == named, call.__name__
    # No call with options is left out.
    names = {call.__name__ for call in calls}
    for name in welkin.__all__:
        each = getattr(welkin, name)
        if inspect.isbuiltin(each) and any(
            p.kind is p.KEYWORD_ONLY for p in inspect.signature(each).parameters.values()
        ):
            assert name in names, name
