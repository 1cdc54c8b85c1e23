# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Finds known rigid objects, with their poses, in RGB-D frames.

    library = bpa.Library()
    library.add_mesh("mug.ply", scale=0.001)
    result = bpa.Detector(library).detect(depth, color, bpa.Camera(525, 525, 319.5, 239.5))
    for placement in result.best:
        print(placement.model, placement.probability, placement.camera_from_object)

Client asks a running bpa-server instead. What fails raises Error.
"""

from ._bpa import version as __version__  # type: ignore
from .client import Client, Stream
from .detector import Detector, draw
from .error import Error
from .frame import Camera, read_frame
from .library import Library, Model
from .results import (Bingham, EndedTrack, Interpretation, Placement, PoseAlternative, Result, Track,
                      TrackAlternative, Tracks)

__all__ = ["Bingham", "Camera", "Client", "Detector", "EndedTrack", "Error", "Interpretation", "Library",
           "Model", "Placement", "PoseAlternative", "Result", "Stream", "Track", "TrackAlternative", "Tracks",
           "__version__", "draw", "read_frame"]
