"""The types in welkin/__init__.pyi are those of the package that runs."""
import pathlib
import subprocess
import sys

import numpy as np
import pytest

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
    "welkin.prefilter(FACES, kernels=[0.5])": "list-item",
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
