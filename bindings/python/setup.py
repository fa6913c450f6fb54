"""Builds the extension `welkin._welkin` with the tree's own CMake project, in build/python of the tree.

The environment variables of CMake count (CMAKE_CXX_COMPILER_LAUNCHER, CMAKE_BUILD_PARALLEL_LEVEL, ...), and
WELKIN_PYTHON_BUILD names another folder to build in, such as build/release, whose library then serves the package too.
What was built before is not built again.

WELKIN_WHEEL_PROGRAM names a static program `welkin`, which then comes with the package for `python -m welkin`; such a
wheel is for machines without a compiler, and its name says the oldest Linux that it runs on (scripts/release).
WELKIN_WHEEL_LICENCES names the texts of the licences of what is linked, which then come along. For another processor
WELKIN_PYTHON_OPTIONS is more words for CMake, and WELKIN_WHEEL_TOOLS is how names of its compiler's tools begin.
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
PROGRAM = os.environ.get("WELKIN_WHEEL_PROGRAM")
LICENCES = os.environ.get("WELKIN_WHEEL_LICENCES", TREE / "LICENSE")
TOOLS = os.environ.get("WELKIN_WHEEL_TOOLS", "")
LEFT_OUT = ("TESTS", "PERF", "TOOLS", "EXAMPLES", "INSTALL")


def version():
    """The version that the tree's CMakeLists.txt names."""
    project = (TREE / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(welkin VERSION ([0-9.]+)", project).group(1)


class BuildByCMake(build_ext):
    """Asks CMake for the extension, and puts it where setuptools wants it."""

    def build_extension(self, ext):
        # In a virtual environment, the Python that made it: the folder may outlive the environment.
        python = getattr(sys, "_base_executable", sys.executable)
        options = ["-DWELKIN_PYTHON=ON", f"-DPython_EXECUTABLE={python}"]
        options += os.environ.get("WELKIN_PYTHON_OPTIONS", "").split()
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
        if PROGRAM:
            program = place.parent / "bin" / pathlib.Path(PROGRAM).name
            program.parent.mkdir(exist_ok=True)
            shutil.copy(PROGRAM, program)
            subprocess.run([TOOLS + "strip", place, program], check=True)
            shutil.copy(LICENCES, place.parent / "LICENSES.txt")


ALWAYS_THERE = re.compile(r"^(ld-linux.*|lib(c|m|pthread|dl|rt|gcc_s)\.so\..*)$")


def manylinux_tag(library):
    """The platform tag (PEP 600) of the newest symbol of glibc that a library needs. It may need no other library
    but GCC's, whose static one would ask for a newer glibc: what auditwheel, which Debian does not have, would refuse too.
    """
    headers = subprocess.check_output([TOOLS + "objdump", "-p", library], text=True)
    strangers = [name for name in re.findall(r"NEEDED\s+(\S+)", headers) if not ALWAYS_THERE.match(name)]
    if strangers:
        sys.exit(f"welkin: {library.name} needs {', '.join(strangers)}, which a machine may lack")
    versions = [tuple(map(int, found.split("."))) for found in re.findall(r"GLIBC_(\d+\.\d+)", headers)]
    machine = {"x86-64": "x86_64", "littleaarch64": "aarch64"}[re.search(r"file format elf64-(\S+)", headers)[1]]
    return "manylinux_{}_{}_{}".format(*max(versions), machine)


# setuptools has wheels of its own from 70.1 on.
if not find_spec("wheel") and not find_spec("setuptools.command.bdist_wheel"):
    sys.exit(
        f"welkin: {sys.executable} has no package `wheel`, which pip needs to build this one. Install it there "
        "(pip install wheel), let pip fetch it (leave out --no-build-isolation), or take Debian's Python, for which "
        "scripts/install-dependencies --python installs all: /usr/bin/python3 -m venv --system-site-packages env"
    )

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:
    from wheel.bdist_wheel import bdist_wheel


class WheelByWhatItNeeds(bdist_wheel):
    """Asks, once the extension is built, what it needs."""

    def get_tag(self):
        python, abi, platform = super().get_tag()
        libraries = list(pathlib.Path(self.bdist_dir).rglob("_welkin*.so")) if PROGRAM else []
        return (python, abi, manylinux_tag(libraries[0])) if libraries else (python, abi, platform)


# Files that setuptools writes on the way stay out of the sources.
BUILD.mkdir(parents=True, exist_ok=True)
setup(
    version=version(),
    packages=["welkin"],
    package_data={"welkin": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("welkin._welkin", sources=[])],
    cmdclass={"build_ext": BuildByCMake, "bdist_wheel": WheelByWhatItNeeds},
    options={"build": {"build_base": str(BUILD / "setuptools")}, "egg_info": {"egg_base": str(BUILD)}},
)
