# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Frames as arrays, and their camera."""

import dataclasses
import json
import os
from typing import Any, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _bpa
from .error import Error

Image = np.ndarray[Any, np.dtype[np.uint8]]
Depth = Union[np.ndarray[Any, np.dtype[np.uint16]], np.ndarray[Any, np.dtype[np.float32]]]
Path = Union[str, "os.PathLike[str]"]


@dataclasses.dataclass(frozen=True)
class Camera:
    """A pinhole camera without distortion. Pixel (0, 0) is the centre of the top left pixel."""

    fx: float  #: Focal lengths and principal point, pixels.
    fy: float
    cx: float
    cy: float
    width: int = 0  #: Pixels; both 0: those of the image.
    height: int = 0


CameraLike = Union[Camera, Mapping[str, float]]


def read_frame(depth: Path, color: Optional[Path], camera: Path) -> Tuple[Depth, Optional[Image], Camera]:
    """Reads files as `bpa detect --depth --color --camera` does: what Detector.detect() takes.

    depth: a 16-bit PNG, registered to `color`, a PNG or JPEG. camera: BOP's camera.json, which may have
    a depth_scale, or ROS's camera_info YAML; its lens distortion is taken out of depth and colours (nearest
    pixel). Returns depth in float32 metres, colours and camera.
    """
    pixels, colors, numbers = _bpa.read_frame(os.fspath(depth), os.fspath(color or ""), os.fspath(camera))
    return pixels, colors, Camera(*numbers)


def images(depth: Any, color: Any, camera: Optional[CameraLike], mask: Any = None,
           roi: Optional[Sequence[int]] = None, stamp_ns: int = 0, frame_id: str = "camera") -> Any:
    """The arrays of a frame, checked; they are not copied."""
    try:
        c = camera if isinstance(camera, Camera) else Camera(**(camera or {}))  # type: ignore[arg-type]
        numbers = [float(c.fx), float(c.fy), float(c.cx), float(c.cy)]
    except (TypeError, ValueError) as error:
        raise Error(f"camera is {camera!r}; it must be a bpa.Camera, or a dict of fx, fy, cx, cy and, "
                    "if you like, width and height") from error
    return _bpa.Images(depth, color, mask, numbers, [c.width, c.height], list(roi or (0, 0, 0, 0)),
                       stamp_ns, frame_id)


def plain(value: Any) -> Any:
    """What JSON takes for a value of numpy."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise Error(f"{value!r} is a {type(value).__name__}; it must be a number, a text, a list or a dict")


def priors_json(priors: Sequence[Mapping[str, Any]]) -> str:
    """Priors as a file of `bpa detect --priors` has them."""
    return json.dumps({"priors": list(priors)}, default=plain)
