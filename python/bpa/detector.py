# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Detection in this process."""

import json
import os
from typing import Any, Callable, Iterator, Mapping, Optional, Sequence, Union

from . import _bpa
from .frame import CameraLike, Depth, Image, Path, images, plain, priors_json
from .library import Library
from .results import Result

Options = Union[Mapping[str, Any], Path]


def _assignments(options: Mapping[str, Any], group: str = "") -> Iterator[str]:
    for name, value in options.items():
        if isinstance(value, Mapping):
            yield from _assignments(value, f"{group}{name}.")
        else:
            yield f"{group}{name}={json.dumps(value, default=plain)}"


class Detector:
    """Finds the objects of a library in RGB-D frames. May be used from several threads at once."""

    def __init__(self, library: Library, options: Optional[Options] = None) -> None:
        """Takes the models that `library` has now, and the score layers of its folder.

        options: settings as detector.yaml has them, {"surface": {"max_range_m": 1.5}} or
            {"max_range_m": 1.5}, checked as a file is; or the path of such a file.
        """
        is_file = isinstance(options, (str, os.PathLike))
        settings = [] if is_file else list(_assignments(options or {}))  # type: ignore[arg-type]
        file = os.fspath(options) if is_file else ""  # type: ignore[arg-type]
        self._detector = _bpa.Detector(library._library, file, settings)

    def detect(self, depth: Depth, color: Optional[Image] = None, camera: Optional[CameraLike] = None, *,
               models: Sequence[str] = (), top_k: int = _bpa.default_top_k, budget_ms: float = 0,
               seed: int = 0, num_threads: int = 0, mask: Optional[Image] = None,
               roi: Optional[Sequence[int]] = None, priors: Sequence[Mapping[str, Any]] = (),
               after: Optional[Result] = None,
               on_round: Optional[Callable[[Result], None]] = None) -> Result:
        """Searches one frame. Other threads of Python run meanwhile.

        depth: (height, width), registered to colour: uint16 in millimetres or float32 in metres along
            z; 0 and NaN are no depth. color: (height, width, 3) uint8, rgb. Both C-contiguous.
        camera: a Camera, or a dict of fx, fy, cx, cy in pixels.
        models: names; empty means all. top_k: number of interpretations, 1 to 100.
        budget_ms: time for the frame; 0 is no limit. seed: the same gives the same answer.
        num_threads: 0 is one a core; does not change the answer.
        mask: (height, width) bool or uint8, 0 is not searched. roi: x, y, width, height in pixels.
        priors: what is known beforehand, as a file of `bpa detect --priors` has it: dicts of "model",
            "pose": {"rotation_wxyz", "translation_m"}, "position_sigma_m", "rotation_sigma_deg", "weight".
        after: the result of the frame before; what it showed is looked for first.
        on_round: called after each round of the search with what is found so far.
        Raises Error on what breaks a rule, and what on_round raises.
        """
        call = on_round
        progress = None if call is None else lambda found: call(Result(found))
        return Result(self._detector.detect(
            images(depth, color, camera, mask, roi), list(models), top_k, budget_ms, seed, num_threads,
            priors_json(priors), after and after._found, progress))


def draw(result: Result, library: Library, depth: Depth, color: Optional[Image] = None,
         camera: Optional[CameraLike] = None, *, rank: int = 1) -> Image:
    """Draws an interpretation over the colours, or over the depth without: outlines and probabilities.

    Arrays and camera as for Detector.detect(); `rank` 1 is the best interpretation. Models that the
    library lacks are left out. Returns (height, width, 3) uint8, rgb.
    """
    picture: Image = result._found.draw(library._library, images(depth, color, camera), rank)
    return picture
