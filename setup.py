# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""What pyproject.toml cannot say: the extension is built by CMake in build/release, as ./run does."""

import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent
BUILD = ROOT / "build/release"


class CMakeBuild(build_ext):
    def build_extension(self, ext):
        cache = BUILD / "CMakeCache.txt"
        known = cache.read_text() if cache.exists() else ""
        commands = [["--build", "--preset", "release", "--target", "bpa_python"]]
        if f"Python_EXECUTABLE:FILEPATH={sys.executable}\n" not in known:
            # What was chosen before stays; without a build there are no tests.
            tests = [] if known else ["-D", "BPA_BUILD_TESTS=OFF"]
            commands.insert(0, ["--preset", "release", "-D", f"Python_EXECUTABLE={sys.executable}", *tests])
        for command in commands:
            subprocess.run(["cmake", *command], cwd=ROOT, check=True)
        to = pathlib.Path(self.get_ext_fullpath(ext.name))
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(BUILD / "python/bpa" / to.name, to)


(ROOT / "build").mkdir(exist_ok=True)
setup(version=re.search(r"project\(bpa VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1],
      ext_modules=[Extension("bpa._bpa", [])], cmdclass={"build_ext": CMakeBuild},
      options={"build": {"build_base": "build/pip"}, "egg_info": {"egg_base": "build"}})
