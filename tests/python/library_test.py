# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Models made in Python are those of `bpa model`, and their arrays are no copies."""

import filecmp

import bpa
import numpy as np
import pytest
from conftest import run

# A box of 100 x 60 x 40 mm: corners in metres, triangles counter-clockwise from outside.
CORNERS = np.array([[x, y, z] for z in (0, 0.04) for y in (0, 0.06) for x in (0, 0.1)])
TRIANGLES = np.array([[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
                      [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]])
RED = np.tile(np.array([200, 30, 30], np.uint8), (8, 1))


@pytest.fixture(scope="module")
def box():
    library = bpa.Library()
    library.add_arrays("box", CORNERS, TRIANGLES, RED)
    return library


def test_a_loaded_library_has_its_models(folder, library):
    assert len(library) == 3 and library.names == ["mug", "banana", "l_brick"]
    assert [model.number for model in library] == [1, 2, 3]
    assert "mug" in library and "cup" not in library
    with pytest.raises(bpa.Error, match="there is no model cup; there are mug, banana, l_brick"):
        library["cup"]
    with pytest.raises(bpa.Error) as raised:
        bpa.Library(folder / "nothing")
    assert raised.value.code == "not_found" and "nothing" in str(raised.value)


def test_a_mesh_becomes_the_model_of_the_program(folder, tmp_path):
    mesh = folder / "models/obj_000002.ply"
    run(tmp_path, "bpa", "model", "from-mesh", mesh, "--name", "fruit", "--scale", "0.001", "--library", "program")
    library = bpa.Library()
    model = library.add_mesh(mesh, "fruit", scale=0.001)
    library.save(tmp_path / "python")
    names = sorted(path.name for path in (tmp_path / "program/fruit").iterdir())
    assert len(names) > 2 and model.number == 1
    assert filecmp.cmpfiles(tmp_path / "program/fruit", tmp_path / "python/fruit", names, False)[0] == names


def test_arrays_become_a_model(box, tmp_path):
    model = box["box"]
    assert model.diameter == pytest.approx(np.linalg.norm([0.1, 0.06, 0.04]), abs=4e-3)
    assert (model.points >= -1e-3).all() and (model.points <= [0.101, 0.061, 0.041]).all()
    np.testing.assert_array_equal(np.abs(model.colors.astype(int) - RED[0]).max(), 0)
    np.testing.assert_allclose(np.linalg.norm(model.normals, axis=1), 1, atol=1e-5)
    assert model.symmetry.count("180 degrees") == 3
    assert model.draw(64).shape == (64, 64, 3) and model._repr_png_().startswith(b"\x89PNG")
    box.save(tmp_path)
    again = bpa.Library(tmp_path)
    np.testing.assert_array_equal(again["box"].points, model.points)
    del again["box"]
    assert len(again) == 0


def test_arrays_of_a_model_are_no_copies_and_outlive_the_library():
    library = bpa.Library()
    points = library.add_arrays("box", CORNERS, TRIANGLES).points
    address = points.__array_interface__["data"][0]
    assert library["box"].points.__array_interface__["data"][0] == address
    expected = points.copy()
    del library
    np.testing.assert_array_equal(points, expected)
    with pytest.raises(ValueError, match="read-only"):
        points[0] = 0


@pytest.mark.parametrize("arguments, text", [
    (("box", CORNERS, TRIANGLES), "box"),
    (("b", CORNERS[:, :2], TRIANGLES), r"vertices is float64 of shape \(8, 2\).* \(n, 3\), metres"),
    (("b", CORNERS, TRIANGLES + 1), "triangles has the index 8; it must be from 0 to 7"),
    (("b", CORNERS, TRIANGLES, RED[:4]), r"colors is uint8 of shape \(4, 3\).* \(8, 3\), rgb"),
    (("b", 1000 * CORNERS, TRIANGLES), r"123.288 m; it must be between 0.005 and 3 m. If its unit"),
    (("b", CORNERS * np.nan, TRIANGLES), "NaN or infinite"),
    (("b", "corners", TRIANGLES), "vertices is a str; it must be"),
    (("b", CORNERS, TRIANGLES[:0]), "b")])
def test_bad_meshes_are_refused(box, arguments, text):
    with pytest.raises(bpa.Error, match=text) as raised:
        box.add_arrays(*arguments)
    assert raised.value.code == "invalid_argument"


def test_a_detector_keeps_the_models_it_was_made_of(frame):
    with pytest.raises(bpa.Error, match="library"):
        bpa.Detector(bpa.Library()).detect(*frame)
