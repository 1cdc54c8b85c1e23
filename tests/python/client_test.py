# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""The client against a real server, on this machine alone."""

import os
import subprocess
import sys
import textwrap
import time
import tracemalloc

import bpa
import numpy as np
import pytest
from conftest import BUILD

DOMAIN = 20 + os.getpid() % 80
NAMESPACE = f"/python{os.getpid()}"
WHERE = {"domain": DOMAIN, "server_namespace": NAMESPACE, "localhost_only": True}


@pytest.fixture(scope="module")
def server(folder):
    with open(folder / "server.log", "w", encoding="utf-8") as log:
        process = subprocess.Popen([BUILD / "bin/bpa-server", "--library", folder / "library", "--localhost",
                                    "--domain", str(DOMAIN), "--namespace", NAMESPACE], stdout=log, stderr=log)
        yield process
        process.terminate()
        process.wait()


@pytest.fixture
def client(server):
    with bpa.Client(**WHERE, timeout_s=60) as connected:
        yield connected


def poses(result):
    return [[placement["pose"] for placement in one["placements"]]
            for one in result.to_dict()["interpretations"]]


def test_a_server_answers_as_a_detector_does(client, library, frame):
    detector = bpa.Detector(library)
    expected = detector.detect(*frame, seed=4)
    tracemalloc.start()
    found = client.detect(*frame, seed=4, stamp_ns=5, frame_id="eye")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < frame[0].nbytes / 10
    assert poses(found) == poses(expected) and found.best
    assert (found.status, found.stamp_ns, found.frame_id) == ("ok", 5, "eye")
    assert found.plan == {} and expected.plan
    picture = bpa.draw(found, library, *frame)
    np.testing.assert_array_equal(picture, bpa.draw(expected, library, *frame))
    millimetres = np.round(1000 * frame[0]).astype(np.uint16)
    assert poses(client.detect(millimetres, *frame[1:], seed=4)) == poses(expected)


def test_models_come_and_go(client, frame):
    assert [model["name"] for model in client.models()] == ["mug", "banana", "l_brick"]
    client.unload_model("mug")
    with pytest.raises(bpa.Error, match="mug") as raised:
        client.detect(*frame, models=["mug"])
    assert raised.value.code == "not_found"
    client.load_model("mug")
    assert [model["name"] for model in client.models()] == ["mug", "banana", "l_brick"]


def test_results_come_by_iterator_and_by_function(client, frame):
    stream = client.results(timeout_s=60)
    client.publish(*frame, stamp_ns=7)
    assert next(stream).stamp_ns == 7
    came = []
    client.subscribe(came.append)  # in place of the stream, which ends
    assert list(stream) == []
    client.publish(*frame, stamp_ns=8)
    while not came:
        time.sleep(0.01)
    assert came[0].stamp_ns == 8 and came[0].best
    quick = client.results(timeout_s=0.01)
    with pytest.raises(bpa.Error, match="nothing came within 0.01 s"):
        next(quick)


def test_tracks_keep_their_names(client, frame):
    stream = client.tracks(timeout_s=60)
    renamed = None
    for number in range(1, 1000):
        client.publish(*frame, stamp_ns=33_000_000 * number)
        tracks = next(stream)
        confirmed = [track for track in tracks.tracks if track.state == "confirmed"]
        if confirmed and renamed is None:
            renamed = confirmed[0]
            client.rename_track(str(renamed.id), "mine")
        if any(track.name == "mine" for track in confirmed):
            break
    [mine] = [track for track in confirmed if track.name == "mine"]
    assert (mine.id, mine.model) == (renamed.id, renamed.model)
    assert mine.frame_from_object.shape == (4, 4) and mine.covariance.shape == (6, 6)
    np.testing.assert_array_equal(tracks.frame_from_camera, np.eye(4))
    with pytest.raises(bpa.Error) as raised:
        client.hold_track("nobody")
    assert raised.value.code == "not_found"


def test_what_a_function_raises_is_printed_and_close_ends_all(server, folder):
    """In a process of its own: it ends well with a client that nobody closed."""
    script = textwrap.dedent(f"""
        import bpa, threading
        frame = bpa.read_frame("depth.png", "color.png", "camera.json")
        where = dict(domain={DOMAIN}, server_namespace="{NAMESPACE}", localhost_only=True, timeout_s=60)
        first, second, third = (bpa.Client(**where) for _ in range(3))
        came = threading.Event()
        def fail(result):
            came.set()
            raise ValueError("a mistake of mine")
        first.subscribe(fail)
        stream = second.results()
        third.subscribe(lambda result: third.close())
        first.publish(*frame, stamp_ns=9)
        print(next(stream).status, came.wait(60))
        second.close()
        print(list(stream))
        try:
            second.models()
        except bpa.Error as error:
            print(error.code, error)
    """)
    done = subprocess.run([sys.executable, "-c", script], cwd=folder, text=True, capture_output=True,
                          timeout=300, check=False)
    assert (done.returncode, done.stdout) == (0, "ok True\n[]\nunavailable the client is closed\n"), done
    assert "ValueError: a mistake of mine" in done.stderr


def test_nobody_answers():
    with pytest.raises(bpa.Error) as raised:
        bpa.Client(domain=DOMAIN, server_namespace="/nobody", localhost_only=True, timeout_s=0.2)
    assert raised.value.code == "unavailable"
    for options, text in (({"domain": 500}, "domain"), ({"timeout_s": float("nan")}, "a time-out is nan s")):
        with pytest.raises(bpa.Error, match=text):
            bpa.Client(**options, localhost_only=True)
