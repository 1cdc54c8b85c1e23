# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""A running bpa-server, from any process and any host; no ROS is needed."""

import collections
import json
import threading
import weakref
from types import TracebackType
from typing import Any, Callable, Deque, Dict, Generic, List, Mapping, Optional, Sequence, Type, TypeVar

from . import _bpa
from .error import Error
from .frame import CameraLike, Depth, Image, images, priors_json
from .records import record
from .results import Result, Tracks

T = TypeVar("T")


class Stream(Generic[T]):
    """An iterator over what a subscription delivers; it ends with the subscription.

    Keeps the newest 100 that are not taken yet. next() raises Error ("timeout") when `timeout_s` passes.
    """

    def __init__(self, client: "Client", timeout_s: Optional[float]) -> None:
        self._client = client  # which calls _put() as long as it lives
        self._timeout_s = timeout_s
        self._items: Deque[T] = collections.deque(maxlen=100)
        self._changed = threading.Condition()
        self._open = True

    def _put(self, item: T) -> None:
        with self._changed:
            self._items.append(item)
            self._changed.notify()

    def _end(self) -> None:
        with self._changed:
            self._open = False
            self._changed.notify_all()

    def __iter__(self) -> "Stream[T]":
        return self

    def __next__(self) -> T:
        with self._changed:
            if not self._changed.wait_for(lambda: self._items or not self._open, self._timeout_s):
                raise Error(f"nothing came within {self._timeout_s} s", "timeout")
            if not self._items:
                raise StopIteration
            return self._items.popleft()


class Client:
    """A connection to a server. Every call may be made from any thread and ends within its time-out.

    A server that restarts is found again: calls made meanwhile raise Error ("unavailable"), and
    subscriptions go on. Functions that are subscribed are called on a thread of the client; what they
    raise is printed. A second subscription of one kind ends the first. What the SDK has to say
    (a type or QoS that does not match) goes to the logger "bpa".
    """

    def __init__(self, *, server_namespace: str = "/bpa", domain: int = -1, localhost_only: bool = False,
                 peers: Sequence[str] = (), timeout_s: float = 5.0, detect_timeout_s: float = 60.0) -> None:
        """Joins the domain and waits for a server. Raises Error ("unavailable") without one in time.

        domain: 0 to 232; -1 takes ROS_DOMAIN_ID, and 0 without it. localhost_only: looks at this machine
        alone; otherwise as ROS_AUTOMATIC_DISCOVERY_RANGE says. peers: more hosts to look at.
        timeout_s: the longest that a call waits; detect_timeout_s: that detect() and load_model() do.
        """
        self._client = _bpa.Client(domain, server_namespace, timeout_s, detect_timeout_s, localhost_only,
                                   list(peers))
        self._streams: Dict[str, Stream[Any]] = {}
        # The interpreter may not end before the client's threads do.
        self._end = weakref.finalize(self, Client._close, self._client, self._streams)

    @staticmethod
    def _close(client: Any, streams: "Dict[str, Stream[Any]]") -> None:
        client.close()
        for stream in streams.values():
            stream._end()

    def close(self) -> None:
        """Ends subscriptions and streams; later calls raise Error ("unavailable")."""
        self._end()

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def models(self) -> List["Mapping[str, Any]"]:
        """The models that the server looks for, by number.

        Dicts of "name", "number", "diameter", "box_min" and "box_max" (metres, in the object's frame)
        and "point_count".
        """
        return list(self._client.models())

    def load_model(self, source: str, name: str = "") -> None:
        """Adds a model of the server's library folder by name; `name`: another one for it."""
        self._client.load_model(source, name)

    def unload_model(self, name: str) -> None:
        """Stops looking for a model."""
        self._client.unload_model(name)

    def detect(self, depth: Optional[Depth] = None, color: Optional[Image] = None,
               camera: Optional[CameraLike] = None, *, models: Sequence[str] = (), top_k: int = 0,
               budget_ms: float = 0, seed: int = 0, mask: Optional[Image] = None,
               roi: Optional[Sequence[int]] = None, priors: Sequence[Mapping[str, Any]] = (),
               stamp_ns: int = 0, frame_id: str = "camera", timeout_s: float = 0) -> Result:
        """Searches a frame, or the next one of the server's camera without `depth`.

        Arguments as of Detector.detect(); the arrays are not copied before they are sent. 0 leaves
        `top_k` and `budget_ms` to the server. stamp_ns: exposure time, UTC. frame_id: of the camera.
        """
        frame = None if depth is None else images(depth, color, camera, mask, roi, stamp_ns, frame_id)
        return Result(self._client.detect(frame, list(models), top_k, budget_ms, seed, priors_json(priors),
                                          timeout_s))

    def publish(self, depth: Depth, color: Optional[Image] = None, camera: Optional[CameraLike] = None, *,
                stamp_ns: int, frame_id: str = "camera", mask: Optional[Image] = None,
                roi: Optional[Sequence[int]] = None, priors: Sequence[Mapping[str, Any]] = ()) -> None:
        """Hands a frame to the server's stream, and returns once it is sent; subscribers get the result."""
        self._client.publish(images(depth, color, camera, mask, roi, stamp_ns, frame_id),
                             priors_json(priors))

    def subscribe(self, on_result: Callable[[Result], None]) -> None:
        """Calls a function with the result of every frame that the server searches."""
        self._client.subscribe(lambda found: on_result(Result(found)))
        self._replace("results", None)

    def results(self, timeout_s: Optional[float] = None) -> Stream[Result]:
        """The same as an iterator."""
        return self._stream("results", self.subscribe, timeout_s)

    def subscribe_tracks(self, on_tracks: Callable[[Tracks], None]) -> None:
        """Calls a function with the tracks of every frame: objects at the camera's rate."""
        self._client.tracks(lambda line: on_tracks(record(Tracks, json.loads(line))))
        self._replace("tracks", None)

    def tracks(self, timeout_s: Optional[float] = None) -> Stream[Tracks]:
        """The same as an iterator."""
        return self._stream("tracks", self.subscribe_tracks, timeout_s)

    def _stream(self, kind: str, subscribe: Callable[[Callable[[T], None]], None],
                timeout_s: Optional[float]) -> Stream[T]:
        stream: Stream[T] = Stream(self, timeout_s)
        subscribe(stream._put)
        self._replace(kind, stream)
        return stream

    def _replace(self, kind: str, stream: "Optional[Stream[Any]]") -> None:
        if before := self._streams.pop(kind, None):
            before._end()
        if stream:
            self._streams[kind] = stream

    def rename_track(self, track: str, name: str) -> None:
        """Names a track, which is called by its name or its id in decimal digits, as below."""
        self._client.rename_track(track, name)

    def hold_track(self, track: str, hold: bool = True) -> None:
        """Keeps a track however long its object is not seen; False: no longer."""
        self._client.hold_track(track, hold)

    def forget_track(self, track: str) -> None:
        """Ends a track."""
        self._client.forget_track(track)
