"""Builds the extension `welkin._welkin` with the tree's own CMake project, in build/python of the tree.

The environment variables of CMake count (CMAKE_CXX_COMPILER_LAUNCHER, CMAKE_BUILD_PARALLEL_LEVEL, ...), and
WELKIN_PYTHON_BUILD names another folder to build in, such as build/release, whose library then serves the package too.
What was built before is not built again.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
from importlib.util import find_spec

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = pathlib.Path(__file__).resolve().parent
TREE = HERE.parent.parent
BUILD = pathlib.Path(TREE / os.environ.get("WELKIN_PYTHON_BUILD", "build/python"))
LEFT_OUT = ("TESTS", "PERF", "TOOLS", "EXAMPLES", "INSTALL")


def version():
    """The version that the tree's CMakeLists.txt names."""
    project = (TREE / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(welkin VERSION ([0-9.]+)", project).group(1)


class BuildByCMake(build_ext):
    """Asks CMake for the extension, and puts it where setuptools wants it."""

    def build_extension(self, ext):
        # Of a virtual environment the Python that it was made by: the folder may serve longer than the environment.
        python = getattr(sys, "_base_executable", sys.executable)
        options = ["-DWELKIN_PYTHON=ON", f"-DPython_EXECUTABLE={python}"]
        if not (BUILD / "CMakeCache.txt").exists():  # else the folder stays what it is, build/release perhaps
            options += ["-DCMAKE_BUILD_TYPE=Release", *(f"-DWELKIN_{part}=OFF" for part in LEFT_OUT)]
            if shutil.which("ninja"):
                options += ["-G", "Ninja"]
        subprocess.run(["cmake", "-S", TREE, "-B", BUILD, *options], check=True)
        # Without a number it would overrule CMAKE_BUILD_PARALLEL_LEVEL.
        parallel = [] if "CMAKE_BUILD_PARALLEL_LEVEL" in os.environ else ["--parallel"]
        subprocess.run(["cmake", "--build", BUILD, "--target", "welkin_python", *parallel], check=True)
        place = pathlib.Path(self.get_ext_fullpath(ext.name))
        place.parent.mkdir(parents=True, exist_ok=True)
        built = BUILD / "extension" / ("_welkin" + sysconfig.get_config_var("EXT_SUFFIX"))
        shutil.copyfile(built, place)


# setuptools has wheels of its own from 70.1 on.
if not find_spec("wheel") and not find_spec("setuptools.command.bdist_wheel"):
    sys.exit(
        f"welkin: {sys.executable} has no package `wheel`, which pip needs to build this one. Install it there "
        "(pip install wheel), let pip fetch it (leave out --no-build-isolation), or take Debian's Python, for which "
        "scripts/install-dependencies --python installs all: /usr/bin/python3 -m venv --system-site-packages env"
    )

# What setuptools writes on the way stands beside it, and not among the sources.
BUILD.mkdir(parents=True, exist_ok=True)
setup(
    version=version(),
    packages=["welkin"],
    package_data={"welkin": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("welkin._welkin", sources=[])],
    cmdclass={"build_ext": BuildByCMake},
    options={"build": {"build_base": str(BUILD / "setuptools")}, "egg_info": {"egg_base": str(BUILD)}},
)
