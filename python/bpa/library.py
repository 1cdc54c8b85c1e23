# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Models of objects."""

import os
import pathlib
from typing import Any, Iterator, List, Optional

import numpy as np

from . import _bpa
from .error import Error
from .frame import Image, Path

Floats = np.ndarray[Any, np.dtype[np.float32]]


class Model:
    """A known object. Arrays are views of its memory: read only, and valid as long as they are held."""

    def __init__(self, model: Any) -> None:
        self._model = model

    @property
    def name(self) -> str:
        """Unique in a library."""
        return str(self._model.name)

    @property
    def number(self) -> int:
        """From 1; unique in a library."""
        return int(self._model.number)

    @property
    def diameter(self) -> float:
        """The largest distance of two points of the surface, metres."""
        return float(self._model.diameter)

    @property
    def points(self) -> Floats:
        """(n, 3): the surface in the object's frame, metres, evenly spaced."""
        points: Floats = self._model.points
        return points

    @property
    def normals(self) -> Floats:
        """(n, 3): unit vectors out of the surface."""
        normals: Floats = self._model.normals
        return normals

    @property
    def colors(self) -> Image:
        """(n, 3) uint8, rgb; (0, 3) without colours."""
        colors: Image = self._model.colors
        return colors

    @property
    def symmetry(self) -> str:
        """The turns that map the shape onto itself, for people."""
        return str(self._model.symmetry)

    @property
    def warnings(self) -> List[str]:
        """What may be wrong with the model, for people."""
        return list(self._model.warnings)

    def draw(self, side: int = 256) -> Image:
        """The model in its colours from one corner: (side, side, 3) uint8, rgb."""
        picture: Image = self._model.draw(side)
        return picture

    def _repr_png_(self) -> bytes:  # what a notebook shows
        return bytes(self._model.png())

    def __repr__(self) -> str:
        return f"<bpa.Model {self.name}: {len(self.points)} points, {1000 * self.diameter:.1f} mm>"


class Library:
    """The objects that can be detected, by increasing number."""

    def __init__(self, folder: Optional[Path] = None, *, num_threads: int = 0) -> None:
        """Loads a folder that `bpa model` or save() made, with its score layers; empty without one.

        num_threads: 0 is one a core, here and below. Raises Error if no model is there or one is broken.
        """
        self._library = _bpa.Library() if folder is None else _bpa.Library(os.fspath(folder), num_threads)

    def add_mesh(self, path: Path, name: Optional[str] = None, *, scale: float = 1.0,
                 num_threads: int = 0) -> Model:
        """Makes a model of a PLY, OBJ, STL, GLB, glTF or DAE file, as `bpa model from-mesh` does.

        name: that of the file if not given. scale: metres of one unit of the file, 0.001 for
        millimetres; a factor for glTF and DAE, which are in metres. Takes some seconds.
        """
        path = os.fspath(path)
        return Model(self._library.add_mesh(path, name or pathlib.Path(path).stem, scale, num_threads))

    def add_arrays(self, name: str, vertices: Any, triangles: Any, colors: Optional[Image] = None, *,
                   num_threads: int = 0) -> Model:
        """Makes a model of a mesh in memory.

        vertices: (n, 3) numbers, metres. triangles: (m, 3) indices of vertices, counter-clockwise seen
        from outside. colors: (n, 3) uint8, rgb.
        """
        return Model(self._library.add_arrays(name, vertices, triangles, colors, num_threads))

    def save(self, folder: Path, *, num_threads: int = 0) -> None:
        """Writes the models into a folder; those that were loaded from there stay as they are."""
        self._library.save(os.fspath(folder), num_threads)

    @property
    def names(self) -> List[str]:
        """The names of the models."""
        return [model.name for model in self]

    def __len__(self) -> int:
        return len(self._library.models())

    def __iter__(self) -> Iterator[Model]:
        return map(Model, self._library.models())

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __getitem__(self, name: str) -> Model:
        for model in self:
            if model.name == name:
                return model
        raise Error(f"there is no model {name}; there are {', '.join(self.names) or 'none'}", "not_found")

    def __delitem__(self, name: str) -> None:
        self._library.remove(name)
