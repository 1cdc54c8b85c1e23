# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Detection in Python is that of `bpa detect`, to the bit; bad input is said to be so."""

import dataclasses
import json
import sys
import threading
import tracemalloc

import bpa
import numpy as np
import pytest
from conftest import run

MEASURED = ("seconds", "timings")
CAMERA = bpa.Camera(525, 525, 319.5, 239.5)


def answer(result):
    return {name: value for name, value in result.to_dict().items() if name not in MEASURED}


def of_the_program(folder, *options):
    """What `bpa detect` finds in the frame."""
    run(folder, "bpa", "detect", "--library", "library", "--depth", "depth.png", "--color", "color.png",
        "--camera", "camera.json", "--json", "result.json", "--annotate", "pictures", *options)
    found = json.loads((folder / "result.json").read_text())["frames"][0]
    return {name: value for name, value in found.items() if name not in MEASURED}


@pytest.fixture(scope="module")
def result(library, frame):
    return bpa.Detector(library).detect(*frame, seed=2)


def test_result_is_that_of_the_program_to_the_bit(folder, library, frame, result):
    expected = of_the_program(folder, "--seed", "2")
    assert answer(result) == expected
    depth, color, camera = frame
    millimetres = np.round(1000 * depth).astype(np.uint16)
    same = bpa.Detector(library).detect(millimetres, color, dataclasses.asdict(camera), seed=2, num_threads=1)
    assert answer(same) == expected


def test_options_are_those_of_a_file(folder, library, frame):
    (folder / "detector.yaml").write_text("surface:\n  max_range_m: 0.8\nmax_rounds: 2\n")
    expected = of_the_program(folder, "--config", "detector.yaml", "--models", "mug,banana", "--top", "3")
    options = {"surface": {"max_range_m": np.float64(0.8)}, "max_rounds": 2}
    for given in (options, folder / "detector.yaml"):
        found = bpa.Detector(library, given).detect(*frame, models=["mug", "banana"], top_k=3)
        assert answer(found) == expected


def test_poses_are_the_true_ones(folder, result):
    truth = json.loads((folder / "test/000001/scene_gt.json").read_text())["0"]
    assert len(result.best) > 1
    for placement in result.best:
        [true] = [one for one in truth if one["obj_id"] == placement.number]
        pose = placement.camera_from_object
        assert np.linalg.norm(pose[:3, 3] - np.array(true["cam_t_m2c"]) / 1000) < 0.025
        w, x, y, z = placement.rotation_wxyz
        axis = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        np.testing.assert_allclose(pose[:3, :3], np.eye(3) + 2 * w * axis + 2 * axis @ axis, atol=1e-12)
        assert (pose[3] == [0, 0, 0, 1]).all()
        assert (np.linalg.eigvalsh(placement.covariance) > 0).all()
        assert sum(weight for weight, _ in placement.mixture) == pytest.approx(1)
        np.testing.assert_allclose(placement.orientation.axes_wxyz.T @ placement.orientation.axes_wxyz,
                                   np.eye(3), atol=1e-9)


@pytest.mark.parametrize("cls, of", [
    (bpa.Result, lambda frame: frame),
    (bpa.Interpretation, lambda frame: frame["interpretations"][0]),
    (bpa.Placement, lambda frame: frame["interpretations"][0]["placements"][0])])
def test_every_key_of_the_file_is_a_field(cls, of, result):
    fields = {field.metadata["key"] for field in dataclasses.fields(cls) if "otherwise" not in field.metadata}
    more = {field.metadata["key"] for field in dataclasses.fields(cls)} - fields
    assert fields <= set(of(result.to_dict())) <= fields | more
    assert not hasattr(result, "no_such_field")


def test_picture_is_that_of_the_program(folder, library, frame, result):
    of_the_program(folder, "--seed", "2")
    _, expected, _ = bpa.read_frame(folder / "depth.png", folder / "pictures/000000_000000.png",
                                    folder / "camera.json")
    np.testing.assert_array_equal(bpa.draw(result, library, *frame), expected)
    assert bpa.draw(result, library, frame[0], None, CAMERA).shape == (480, 640, 3)
    with pytest.raises(bpa.Error, match="rank is 30; the result has 1 to"):
        bpa.draw(result, library, *frame, rank=30)


def test_lens_distortion_is_taken_out(folder, frame, tmp_path):
    k1, f, cx, cy = 0.1, 525, 319.5, 239.5
    (tmp_path / "camera.yaml").write_text(f"width: 640\nheight: 480\nK: [{f}, 0, {cx}, 0, {f}, {cy}, 0, 0, 1]\n"
                                          f"distortion_model: plumb_bob\nD: [{k1}, 0, 0, 0, 0]\n")
    depth, color, _ = bpa.read_frame(folder / "depth.png", folder / "color.png", tmp_path / "camera.yaml")
    y, x = (np.indices((480, 640)) - np.array([cy, cx])[:, None, None]) / f
    factor = 1 + k1 * (x * x + y * y)
    u, v = (np.rint(f * one * factor + c).astype(int) for one, c in ((x, cx), (y, cy)))
    inside = (u >= 0) & (u < 640) & (v >= 0) & (v < 480)
    for taken, given in ((depth, frame[0]), (color, frame[1])):
        expected = np.where(inside.reshape(inside.shape + (1,) * (given.ndim - 2)),
                            given[v.clip(0, 479), u.clip(0, 639)], 0)
        assert np.mean(taken != expected) < 1e-3
    assert np.mean(depth != frame[0]) > 0.1


def test_rounds_are_reported_and_what_the_function_raises_ends_the_search(library, frame):
    detector = bpa.Detector(library)
    rounds = []
    found = detector.detect(*frame, on_round=rounds.append)
    assert rounds and all(isinstance(one, bpa.Result) and one.interpretations for one in rounds)
    assert answer(found) == answer(detector.detect(*frame))

    def stop(_):
        raise KeyError("enough")
    with pytest.raises(KeyError, match="enough"):
        detector.detect(*frame, on_round=stop)


def test_the_frame_before_and_priors_are_used(library, frame, result):
    detector = bpa.Detector(library)
    after = detector.detect(*frame, after=result)
    assert after.effort["sampled_poses"] < result.effort["sampled_poses"]
    best = result.best[0]
    pose = {"rotation_wxyz": best.rotation_wxyz, "translation_m": best.camera_from_object[:3, 3]}
    prior = {"model": best.model, "pose": pose, "position_sigma_m": 0.01, "rotation_sigma_deg": 5}
    assert answer(detector.detect(*frame, priors=[prior])) != answer(detector.detect(*frame))
    with pytest.raises(bpa.Error, match=r'priors\[0\]: unknown field "sigma"'):
        detector.detect(*frame, priors=[{"model": "mug", "sigma": 1}])


def test_other_threads_run_during_a_search(library, frame):
    go, counted = threading.Event(), []
    thread = threading.Thread(target=lambda: (go.wait(), counted.extend(range(1000))))
    thread.start()
    before = sys.getswitchinterval()
    sys.setswitchinterval(100)  # seconds: from here on a thread runs only where this one lets it
    try:
        go.set()
        bpa.Detector(library).detect(*frame)
        assert len(counted) == 1000
    finally:
        sys.setswitchinterval(before)
    thread.join()


def test_arrays_are_read_where_they_are(library, frame):
    depth, color, camera = frame
    depth = depth.copy()
    depth[:20] = np.nan
    kept = depth.copy()
    detector = bpa.Detector(library)
    tracemalloc.start()  # numpy reports its arrays to it
    detector.detect(depth, color, camera)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < depth.nbytes / 10
    np.testing.assert_array_equal(depth, kept)


Z = np.full((480, 640), 0.8, np.float32)
RGB = np.zeros((480, 640, 3), np.uint8)
BAD = [
    (([[1.0]], None, CAMERA), {}, "depth is a list; it must be a C-contiguous array"),
    ((Z.astype(np.float64), None, CAMERA), {}, r"depth is float64 of shape \(480, 640\); .* float32 in metres"),
    ((Z.astype(">f4"), None, CAMERA), {}, "depth is >f4 of shape"),
    ((RGB, None, CAMERA), {}, r"depth is uint8 of shape \(480, 640, 3\); it must be"),
    ((Z[:, ::2], None, CAMERA), {}, r"depth is float32 of shape \(480, 320\), not C-contiguous"),
    ((Z, RGB[:, :, :2], CAMERA), {}, r"color is uint8 of shape .* must be .* \(480, 640, 3\), rgb"),
    ((Z, RGB.astype(np.float32), CAMERA), {}, "color is float32"),
    ((Z, RGB[::-1], CAMERA), {}, "color is uint8 .* not C-contiguous"),
    ((Z, None, None), {}, "camera is None; it must be a bpa.Camera"),
    ((Z, None, {"fx": 525}), {}, "camera is {'fx': 525}; it must be a bpa.Camera"),
    ((Z, None, {"f": 525}), {}, "camera is {'f': 525}; it must be"),
    ((Z, None, bpa.Camera(525, 525, 320, 240, 320, 240)), {},
     "depth has 640 x 480 pixels; the camera has 320 x 240"),
    ((Z, None, bpa.Camera(-1, 525, 320, 240)), {}, "fx is -1"),
    ((0 * Z, None, CAMERA), {}, "frame depth has 0 valid pixels"),
    ((Z, None, CAMERA), {"mask": RGB}, "mask is uint8 of shape"),
    ((Z, None, CAMERA), {"roi": (600, 0, 100, 100)}, "frame roi 100x100"),
    ((Z, None, CAMERA), {"top_k": 101}, "top_k is 101; it must be between 1 and 100"),
    ((Z, None, CAMERA), {"models": ["cup"]}, "cup"),
]


@pytest.mark.parametrize("arrays, options, text", BAD)
def test_bad_input_is_refused(library, arrays, options, text):
    with pytest.raises(bpa.Error, match=text) as raised:
        bpa.Detector(library).detect(*arrays, **options)
    assert raised.value.code == ("not_found" if "models" in options else "invalid_argument")


@pytest.mark.parametrize("options, text", [
    ({"surface": {"max_rang_m": 1}}, "^unknown key surface.max_rang_m; the nearest is surface.max_range_m$"),
    ({"max_in_library": 1}, "unknown key max_in_library; there is check.max_in_library or"),
    ({"max_range_m": 300}, "surface.max_range_m is 300; it must be between"),
    ({"max_range_m": "far"}, "surface.max_range_m is far; it must be a number"),
    ({"surface": 3}, "surface is 3; it must be a map"),
    ({"surface": {1}}, "^.1. is a set; it must be"),
    ("/no/such/file.yaml", "/no/such/file.yaml: there is no such file")])
def test_bad_options_are_refused_as_in_a_file(library, options, text):
    with pytest.raises(bpa.Error, match=text):
        bpa.Detector(library, options)
