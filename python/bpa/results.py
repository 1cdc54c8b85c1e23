# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""What was found. The camera frame is the optical one: x right, y down, z forward, metres.

Poses are 4x4 matrices named by both frames: camera_from_object takes points of the object's frame to
the camera frame. Quaternions are in the order w, x, y, z. Covariances are of (x, y, z, rotation about
x, y, z) about the axes of the pose's frame, metres and radians.
"""

import json
from dataclasses import dataclass
from typing import Any, Dict, List, Tuple

import numpy as np

from .records import array, fields_of, key, matrix, record, records, wxyz

Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True, eq=False)
class Bingham:
    """The distribution of an orientation: exp(sum_i concentrations[i] (axes_wxyz[:, i] . q)^2)."""

    axes_wxyz: Array = array("axes", 4, 3)  #: (4, 3): an axis a column, quaternions w x y z.
    concentrations: Array = array("concentrations", 3)  #: (3,), not positive; all 0 is uniform.


@dataclass(frozen=True, eq=False)
class PoseAlternative:
    """Another pose that explains the view nearly as well."""

    camera_from_object: Array = matrix("pose")  #: (4, 4)
    rotation_wxyz: Array = wxyz("pose")  #: (4,)
    weight: float = key("weight")  #: In (0, 1].


@dataclass(frozen=True, eq=False)
class Placement:
    """One object at one pose."""

    model: str = key("model")  #: The model's name.
    number: int = key("obj_id")  #: The model's number in its library.
    camera_from_object: Array = matrix("pose")  #: (4, 4)
    rotation_wxyz: Array = wxyz("pose")  #: (4,), the same rotation.
    covariance: Array = array("covariance", 6, 6)
    orientation: Bingham = key("bingham", lambda value: record(Bingham, value))
    score: float = key("score")  #: Log odds; comparable within one model only.
    probability: float = key("probability")  #: That the pose is within 2.5 cm and pi/16 of the truth.
    presence: float = key("presence")  #: That the object is there, here or at an alternative.
    visible_fraction: float = key("visible_fraction")  #: Of the surface that faces the camera.
    components: Dict[str, float] = key("components")  #: Parts of the score, by name.
    alternatives: Tuple[PoseAlternative, ...] = records("alternatives", PoseAlternative)

    @property
    def mixture(self) -> List[Tuple[float, Array]]:
        """The pose and its alternatives with their weights, which sum to 1."""
        others = [(other.weight, other.camera_from_object) for other in self.alternatives]
        return [(1 - sum(weight for weight, _ in others), self.camera_from_object), *others]


@dataclass(frozen=True, eq=False)
class Interpretation:
    """One way to explain the frame: placements that fit together."""

    rank: int = key("rank")  #: 1 is the best.
    score: float = key("score")
    probability: float = key("probability")  #: Among those of the result, which sum to 1.
    placements: Tuple[Placement, ...] = records("placements", Placement)  #: By falling probability.


@dataclass(init=False, eq=False, repr=False)
class Result:
    """What a search found in one frame. An empty scene is a result."""

    interpretations: Tuple[Interpretation, ...] = records("interpretations", Interpretation)  #: Ranked.
    seconds: float = key("seconds")  #: That the search took.
    timings: List[Dict[str, Any]] = key("timings")  #: "stage" and "milliseconds", in their order.
    budget_exhausted: bool = key("budget_exhausted")  #: Without the time budget, more is searched.
    fused_frames: int = key("fused_frames")  #: Number of frames combined into the searched depth.
    missed: List[Dict[str, Any]] = key("missed")  #: "model", and how many objects are "expected" to be.
    scene_id: int = key("scene_id")  #: 0 for a frame of no data set.
    im_id: int = key("im_id")  #: 0 for a frame of no data set.
    sensor: str = key("sensor", otherwise="")  #: Kind of camera it was taken for; empty of a server.
    effort: Dict[str, int] = key("effort", otherwise={})  #: Counts of work; empty of a server.
    plan: Dict[str, Any] = key("plan", otherwise={})  #: What the search ran with, and why; as effort.
    stamp_ns: int = key("stamp_ns", otherwise=0)  #: Exposure time, UTC; of a server alone, as below.
    frame_id: str = key("frame_id", otherwise="")  #: Name of the camera frame.
    status: str = key("status", otherwise="ok")  #: The Error.code of a frame that was not searched.
    message: str = key("message", otherwise="")  #: Why not; or models that were not searched for.
    queue_position: int = key("queue_position", otherwise=0)  #: What waited before this frame.

    def __init__(self, found: Any) -> None:
        self._found = found

    def __getattr__(self, name: str) -> Any:
        # A search is not slowed by what nobody reads: the first field that is read makes all.
        if name.startswith("_"):
            raise AttributeError(name)
        self.__dict__.update(fields_of(type(self), self.to_dict()))
        return object.__getattribute__(self, name)

    @property
    def best(self) -> Tuple[Placement, ...]:
        """The placements of the best interpretation."""
        return self.interpretations[0].placements if self.interpretations else ()

    def to_dict(self) -> Dict[str, Any]:
        """The frame as `bpa detect --json` writes it (bpa-client --json, of a server)."""
        return dict(json.loads(self._found.json()))

    def __repr__(self) -> str:
        return f"<bpa.Result: {', '.join(p.model for p in self.best) or 'nothing known is there'}>"


@dataclass(frozen=True, eq=False)
class TrackAlternative:
    """Another pose that the views so far explain as well."""

    frame_from_object: Array = matrix("pose")  #: (4, 4)
    weight: float = key("weight")  #: In (0, 1].


@dataclass(frozen=True, eq=False)
class Track:
    """One object, followed from frame to frame, in the frame that Tracks.frame_id names."""

    id: int = key("id")  #: From 1; never another object's in a run of the server.
    name: str = key("name")  #: Unique; "MODEL_N" unless it was renamed.
    model: str = key("model")
    number: int = key("obj_id")  #: The model's number in the server's library.
    state: str = key("state")  #: "tentative", "confirmed", "occluded" or "lost".
    probability: float = key("probability")  #: That the object is there.
    frame_from_object: Array = matrix("pose")  #: (4, 4)
    rotation_wxyz: Array = wxyz("pose")  #: (4,), the same rotation.
    covariance: Array = array("covariance", 6, 6)
    orientation: Bingham = key("bingham", lambda value: record(Bingham, value))
    velocity: Array = array("velocity", 3)  #: Of the model's origin, m/s.
    angular_velocity: Array = array("angular_velocity", 3)  #: rad/s.
    visible_fraction: float = key("visible_fraction")
    age_s: float = key("age_s")
    unseen_s: float = key("unseen_s")
    held: bool = key("held")  #: Kept however long it is not seen.
    weight: float = key("weight")  #: Of the pose against its alternatives.
    alternatives: Tuple[TrackAlternative, ...] = records("alternatives", TrackAlternative)


@dataclass(frozen=True, eq=False)
class EndedTrack:
    """A track that is no more."""

    id: int = key("id")
    name: str = key("name")
    reason: str = key("reason")  #: For people.


@dataclass(frozen=True, eq=False)
class Tracks:
    """All tracks after one frame."""

    tracks: Tuple[Track, ...] = records("tracks", Track)  #: By id; tentative and lost ones too.
    ended: Tuple[EndedTrack, ...] = records("ended", EndedTrack)  #: In this frame.
    stamp_ns: int = key("stamp_ns")  #: Exposure time, UTC.
    frame_id: str = key("frame_id")  #: Of the poses: the fixed frame, or the camera frame.
    camera_frame_id: str = key("camera_frame_id")
    in_fixed_frame: bool = key("in_fixed_frame")  #: Whether the camera's motion is known.
    frame_from_camera: Array = matrix("frame_from_camera")  #: (4, 4)
    milliseconds: float = key("milliseconds")  #: That following took.
    scene_id: int = key("scene_id")  #: 0 for a frame of no data set.
    im_id: int = key("im_id")  #: 0 for a frame of no data set.
