"""Builds the Python package: `pip install .` in the root of the repository. CMake builds the extension module, for any
machine of this architecture: with AVX2 where it runs. In the environment:

PELLICLE_BUILD       a CMake folder to build in
PELLICLE_PORTABLE    set: the wheel of a release. It needs no library but libc (libfyaml and zlib are compiled in, assimp and pictures are left
                     out), contains the program, its scenes and pages, and is marked for the machines that its symbols permit (tools/audit-symbols)
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from wheel.bdist_wheel import bdist_wheel

ROOT = pathlib.Path(__file__).resolve().parent
PORTABLE = "PELLICLE_PORTABLE" in os.environ
BUILD = pathlib.Path(os.environ.get("PELLICLE_BUILD") or ROOT / "build/wheel").resolve()
PAGES = [ROOT / "build/web" / f"{name}.html" for name in ("report", "live", "play")]


def version():
    return re.search(r'#define PEL_VERSION "(.+)"', (ROOT / "include/pellicle/base.h").read_text())[1]


class BuildCore(build_ext):
    def build_extension(self, extension):
        build = BUILD if PORTABLE or os.environ.get("PELLICLE_BUILD") else (pathlib.Path(self.build_temp) / "cmake").resolve()
        options = [
            "-DCMAKE_BUILD_TYPE=Release",
            "-DPELLICLE_NATIVE=OFF",
            "-DPELLICLE_TESTS=OFF",
            "-DPELLICLE_VIEW=OFF",
            "-DPELLICLE_SHARED=OFF",
            "-DPELLICLE_PYTHON=ON",
            f"-DPELLICLE_PYTHON_PROGRAM={sys.executable}",
        ]
        targets = ["pellicle_python"]
        if PORTABLE:
            options += ["-DPELLICLE_OWN_LIBRARIES=ON", "-DCMAKE_EXE_LINKER_FLAGS=-s", "-DCMAKE_MODULE_LINKER_FLAGS=-s"]
            targets += ["pellicle_program"]
        if shutil.which("ninja"):
            options += ["-G", "Ninja"]
        subprocess.run(["cmake", "-S", ROOT, "-B", build, *options], check=True)
        subprocess.run(["cmake", "--build", build, "--parallel", str(os.cpu_count() or 1), "--target", *targets], check=True)
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(build / "python/pellicle/_core.abi3.so", target)
        # the page of reports, where `make web` has built it
        if PAGES[0].is_file() and not PORTABLE:
            shutil.copy2(PAGES[0], target.parent)


class AbiWheel(bdist_wheel):
    """One wheel for Python 3.11 and later."""

    def get_tag(self):
        python, abi, platform = super().get_tag()
        if PORTABLE:
            files = [BUILD / "pellicle", BUILD / "python/pellicle/_core.abi3.so"]
            platform = subprocess.run([ROOT / "tools/audit-symbols", *files], check=True, stdout=subprocess.PIPE, text=True).stdout.strip()
        return ("cp311", "abi3", platform) if python.startswith("cp") else (python, abi, platform)


def program_files():
    """What `make install` places beside the package: folder of the environment, and files."""
    if not PORTABLE:
        return []
    pages = [str(page.relative_to(ROOT)) for page in PAGES if page.is_file()]
    scenes = [str(path.relative_to(ROOT)) for path in sorted((ROOT / "scenes").glob("*.yaml"))]
    licences = [f"build/sources/{name}/LICENSE" for name in ("libfyaml", "zlib")]
    rows = [("bin", [str(BUILD / "pellicle")]), ("share/pellicle", pages), ("share/pellicle/scenes", scenes)]
    return rows + [(f"share/doc/pellicle/{path.split('/')[2]}", [path]) for path in licences]


setup(
    version=version(),
    ext_modules=[Extension("pellicle._core", [], py_limited_api=True)],
    cmdclass={"build_ext": BuildCore, "bdist_wheel": AbiWheel},
    data_files=program_files(),
)
