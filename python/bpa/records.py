# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""How the JSON of results becomes objects: a field of a class is a line that names its key."""

import dataclasses
from typing import Any, Callable

import numpy as np

from . import _bpa


def key(name: str, read: Callable[[Any], Any] = lambda value: value, **otherwise: Any) -> Any:
    """The field that read() makes of the value of this key, or `otherwise`, if given, without the key."""
    return dataclasses.field(metadata={"key": name, "read": read, **otherwise})


def array(name: str, *shape: int) -> Any:
    """A field of numbers, row by row."""
    return key(name, lambda values: np.array(values, dtype=np.float64).reshape(shape))


def matrix(name: str) -> Any:
    """A field of a pose as a 4x4 matrix."""
    return key(name, lambda pose: _bpa.matrix(pose["rotation_wxyz"], pose["translation_m"]))


def wxyz(name: str) -> Any:
    """A field of a pose's quaternion."""
    return key(name, lambda pose: np.array(pose["rotation_wxyz"]))


def records(name: str, cls: Any) -> Any:
    """A field of a tuple of objects of another class."""
    return key(name, lambda values: tuple(record(cls, value) for value in values))


def fields_of(cls: Any, values: "dict[str, Any]") -> "dict[str, Any]":
    """The fields of a class by name, of a JSON object."""
    found = {}
    for field in dataclasses.fields(cls):
        about = field.metadata
        missing = about["key"] not in values and "otherwise" in about
        found[field.name] = about["otherwise"] if missing else about["read"](values[about["key"]])
    return found


def record(cls: Any, values: "dict[str, Any]") -> Any:
    """An object of a class, of a JSON object."""
    return cls(**fields_of(cls, values))
