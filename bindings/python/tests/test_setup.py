"""setup.py asks CMake for what it should, and says what is missing."""
import os
import pathlib
import subprocess
import sys
import sysconfig

import pytest

SETUP = pathlib.Path(__file__).resolve().parent.parent / "setup.py"


def builds_asked_for(folder, **surroundings):
    """The arguments of `cmake --build`, by a cmake that only writes them down."""
    stand_in = folder / "cmake"
    stand_in.write_text(f'#!/bin/sh\nprintf "%s " "$@" >> "{folder}/asked"; echo >> "{folder}/asked"\n')
    stand_in.chmod(0o755)
    (folder / "extension").mkdir()
    (folder / "extension" / ("_welkin" + sysconfig.get_config_var("EXT_SUFFIX"))).write_text("")
    of_this = {key: value for key, value in os.environ.items() if key != "CMAKE_BUILD_PARALLEL_LEVEL"}
    subprocess.run(
        [sys.executable, SETUP, "-q", "build_ext", "--build-lib", folder / "lib"],
        cwd=SETUP.parent,
        env={**of_this, "PATH": f"{folder}:{os.environ['PATH']}", "WELKIN_PYTHON_BUILD": str(folder), **surroundings},
        check=True,
    )
    return [line for line in (folder / "asked").read_text().splitlines() if line.startswith("--build")]


@pytest.mark.parametrize("level", [None, "2"])
def test_the_number_of_compilers_is_cmakes_variable(tmp_path, level):
    surroundings = {"CMAKE_BUILD_PARALLEL_LEVEL": level} if level else {}
    (asked,) = builds_asked_for(tmp_path, **surroundings)
    assert ("--parallel" in asked) == (level is None)


def test_a_python_without_wheel_is_told_what_to_do(tmp_path):
    program = (
        "import runpy, sys; sys.modules['wheel'] = None; sys.modules['setuptools.command.bdist_wheel'] = None\n"
        f"sys.argv = ['setup.py', 'bdist_wheel']; runpy.run_path({str(SETUP)!r}, run_name='__main__')"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=SETUP.parent,
        env={**os.environ, "WELKIN_PYTHON_BUILD": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1
    assert "has no package `wheel`" in done.stderr and "--no-build-isolation" in done.stderr, done.stderr
