# SPDX-License-Identifier: GPL-3.0-or-later
"""Saved deformations, without MeshLab."""
from __future__ import annotations

import contextlib
import math
import os
import shutil
import uuid
from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._field import Field

Points = NDArray[np.float64]


def _rows(name: str, values: ArrayLike) -> Points:
    rows = np.ascontiguousarray(values, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ValueError(f"{name} must be n x 3, one row per point; it is {' x '.join(map(str, rows.shape)) or 'a number'}")
    return rows


def _write(path: str, content: bytes) -> None:
    if os.path.exists(path) and not os.path.isfile(path):  # a pipe, a device
        with open(path, "wb") as file:
            file.write(content)
        return
    aside = f"{path}.{os.getpid()}.{uuid.uuid4().hex}.part"
    try:
        with open(aside, "xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if os.path.exists(path):
            shutil.copymode(path, aside)
        os.replace(aside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(aside)
        raise


class Deformation:
    """A deformation of space, as ``save_fcd_deformation`` writes it.

    Call it with points in world coordinates. Each point goes with the nearest place of the surface that was deformed, for
    itself: the bits do not depend on how points are cut into pieces, on their order, or on threads. Any number of threads may
    use one object at a time; it can be pickled, and is a megabyte or so then.
    """

    __slots__ = ("_field",)

    def __init__(self, content: bytes, name: str = "deformation") -> None:
        """From the content of a file. Raises ValueError, which says what is wrong, where it is no saved deformation."""
        self._field = Field(bytes(content), name)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Deformation:
        """From a file. Raises OSError or, where it is no saved deformation, ValueError."""
        with open(path, "rb") as file:
            return cls(file.read(), os.fspath(path))

    def save(self, path: str | os.PathLike[str]) -> None:
        """To a file. What is there is replaced at once, when all is on the disk, and otherwise stays."""
        _write(os.path.realpath(os.fsdecode(path)), self._field.content())

    @overload
    def __call__(self, xyz: ArrayLike, normals: None = None, *, threads: int = 1) -> Points: ...
    @overload
    def __call__(self, xyz: ArrayLike, normals: ArrayLike, *, threads: int = 1) -> tuple[Points, Points]: ...
    def __call__(self, xyz, normals=None, *, threads=1):
        """The positions of points, n x 3 (float64), and, where their normals are given, these (as long as they were).

        threads: how many to use, 0 for one a core. Python's lock is released meanwhile. Points that are not finite stay as
        they are, and so does, to the bit, what is nearest to something that was fixed.
        """
        if threads < 0:
            raise ValueError("threads must be 0 (one a core) or more")
        positions, turned = self._field.apply(_rows("xyz", xyz), None if normals is None else _rows("normals", normals), threads)
        return positions if normals is None else (positions, turned)

    @property
    def samples(self) -> Points:
        """Where it was sampled, at rest, k x 3: the thinned surface. Far from it, no answer makes sense."""
        return self._field.positions()

    @property
    def largest_difference(self) -> float | None:
        """By how much a vertex of the surface that was deformed is off at most, in world units: what this approximates by.
        None where the file, of an earlier version, does not tell."""
        largest = self._field.largest_difference
        return None if math.isnan(largest) else largest

    def __reduce__(self):
        return Deformation, (self._field.content(),)

    def __repr__(self) -> str:
        return f"<Deformation of {self._field.samples} samples>"
