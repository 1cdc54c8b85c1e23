# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""A simulated frame of three objects, as files and as arrays, and a library of their models."""

import os
import pathlib
import subprocess

import bpa
import pytest

BUILD = pathlib.Path(os.environ["BPA_BUILD"])


def run(folder, *command):
    """Runs a program of the build in a folder."""
    subprocess.run([BUILD / "bin" / command[0], *command[1:]], cwd=folder, check=True,
                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("recording")
    run(path, "bpa", "simulate", "scenes", "--out", ".", "--scenes", "1", "--seed", "6",
        "--objects", "3,3", "--clutter", "0,0.4", "--models", "mug,banana,l_brick")
    run(path, "bpa", "model", "from-bop", ".", "--library", "library")
    (path / "depth.png").symlink_to(path / "test/000001/depth/000000.png")
    (path / "color.png").symlink_to(path / "test/000001/rgb/000000.png")
    (path / "camera.json").write_text('{"width": 640, "height": 480, "fx": 525, "fy": 525, "cx": 319.5,'
                                      ' "cy": 239.5, "depth_scale": 1}')
    return path


@pytest.fixture(scope="session")
def frame(folder):
    return bpa.read_frame(folder / "depth.png", folder / "color.png", folder / "camera.json")


@pytest.fixture(scope="session")
def library(folder):
    return bpa.Library(folder / "library")
