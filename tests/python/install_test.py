# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""What users get: the package by pip and by CMake, its types, and its tutorial's words."""

import pathlib
import subprocess
import sys

import pytest
from conftest import BUILD

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python/bpa"
USE = "import sys; sys.path.insert(0, sys.argv[1]); import bpa; print(bpa.__file__, len(bpa.Library()))"


def run(*command, cwd=ROOT):
    return subprocess.run([str(part) for part in command], cwd=cwd, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)


def check(folder):
    """The package is whole where it was installed, without the build's folder."""
    used = run(sys.executable, "-E", "-c", USE, folder, cwd="/")
    assert used.stdout == f"{folder}/bpa/__init__.py 0\n"
    names = {path.name for path in PACKAGE.iterdir()} - {"__pycache__"}
    assert names <= {path.name for path in (folder / "bpa").iterdir()}


@pytest.mark.skipif(BUILD.name != "release", reason="pip builds the preset release")
def test_pip_installs_a_checkout(tmp_path):
    done = run(sys.executable, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index",
               "--target", tmp_path, ".")
    assert done.returncode == 0, done.stdout
    check(tmp_path)


def test_cmake_installs_the_package(tmp_path):
    done = run("cmake", "--install", BUILD, "--component", "python", "--prefix", tmp_path)
    assert done.returncode == 0, done.stdout
    check(tmp_path / "lib/python3/dist-packages")


def test_types_are_whole_and_users_see_them(tmp_path):
    mypy = [sys.executable, "-m", "mypy", "--cache-dir", tmp_path / "cache", "--strict"]
    whole = run(*mypy, PACKAGE)
    assert whole.returncode == 0, whole.stdout
    use = tmp_path / "use.py"
    use.write_text("import bpa\nreveal_type(bpa.Library('x')['mug'].diameter)\n"
                   "bpa.Camera('wide', 1, 1, 1)\nbpa.Result.placements\n")
    seen = run("env", f"MYPYPATH={PACKAGE.parent}", *mypy, use).stdout
    assert 'use.py:2: note: Revealed type is "builtins.float"' in seen
    assert "use.py:3: error: Argument 1" in seen and "use.py:4: error:" in seen
