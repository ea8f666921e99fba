"""Builds the Python package: `pip install .` in the root of the repository. CMake builds the extension module, for any
machine of this architecture: with AVX2 where it runs. PELLICLE_BUILD in the environment is a CMake folder to build in."""

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


def version():
    return re.search(r'#define PEL_VERSION "(.+)"', (ROOT / "include/pellicle/base.h").read_text())[1]


class BuildCore(build_ext):
    def build_extension(self, extension):
        build = pathlib.Path(os.environ.get("PELLICLE_BUILD") or pathlib.Path(self.build_temp) / "cmake").resolve()
        options = [
            "-DCMAKE_BUILD_TYPE=Release",
            "-DPELLICLE_NATIVE=OFF",
            "-DPELLICLE_TESTS=OFF",
            "-DPELLICLE_VIEW=OFF",
            "-DPELLICLE_SHARED=OFF",
            "-DPELLICLE_PYTHON=ON",
            f"-DPELLICLE_PYTHON_PROGRAM={sys.executable}",
        ]
        if shutil.which("ninja"):
            options += ["-G", "Ninja"]
        subprocess.run(["cmake", "-S", ROOT, "-B", build, *options], check=True)
        subprocess.run(["cmake", "--build", build, "--parallel", str(os.cpu_count() or 1), "--target", "pellicle_python"], check=True)
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(build / "python/pellicle/_core.abi3.so", target)
        # the page of reports, where `make web` has built it
        page = ROOT / "build/web/report.html"
        if page.is_file():
            shutil.copy2(page, target.parent)


class AbiWheel(bdist_wheel):
    """One wheel for Python 3.11 and later."""

    def get_tag(self):
        python, abi, platform = super().get_tag()
        return ("cp311", "abi3", platform) if python.startswith("cp") else (python, abi, platform)


setup(
    version=version(),
    ext_modules=[Extension("pellicle._core", [], py_limited_api=True)],
    cmdclass={"build_ext": BuildCore, "bdist_wheel": AbiWheel},
)
