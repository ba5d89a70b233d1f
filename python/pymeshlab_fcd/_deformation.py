# SPDX-License-Identifier: GPL-3.0-or-later
"""Saved deformations, without MeshLab."""
from __future__ import annotations

import math
import os
from typing import overload

from numpy.typing import ArrayLike

from . import _files, _inputs
from ._core import Field
from ._inputs import Points
from ._numbers import shown, text
from ._progress import Progress, report


class Deformation:
    """A deformation of space, as `save_fcd_deformation` and [Pose.deformation][pymeshlab_fcd.Pose.deformation] make it.

    Call it with points in world coordinates. Each point goes with the nearest place of the surface that was deformed, for
    itself: the bits do not depend on how points are cut into pieces, on their order, or on threads. Any number of threads may
    use one object at a time; it can be pickled, and is a megabyte or so then. Two are equal where they are the same to the bit.

    Parameters
    ----------
    content : bytes
        That of a file.
    name : str, default 'deformation'
        What messages call it.

    Raises
    ------
    TypeError
        The content is no bytes.
    ValueError
        It is no saved deformation; the message says what is wrong.
    """

    __slots__ = ("_field", "_seconds")

    def __init__(self, content: bytes, name: str = "deformation") -> None:
        if not isinstance(content, (bytes, bytearray, memoryview)):
            raise TypeError(f"content must be the bytes of a file; it is a {type(content).__name__}. Deformation.load(path) reads a file")
        self._field = Field.read(bytes(content), shown(text("name", name)), 1)  # so small that more threads than one would not help
        self._seconds: float | None = None

    @classmethod
    def _of(cls, field: Field, seconds: float) -> Deformation:
        made = cls.__new__(cls)
        made._field, made._seconds = field, seconds
        return made

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Deformation:
        """From a file.

        Parameters
        ----------
        path : path
            Of a file that `save_fcd_deformation` or [save][pymeshlab_fcd.Deformation.save] has written.

        Raises
        ------
        OSError
            It cannot be read.
        ValueError
            It is no saved deformation; the message says what is wrong.
        """
        with open(os.fspath(path), "rb") as file:  # no number of an open file
            return cls(file.read(), shown(path))

    def save(self, path: str | os.PathLike[str]) -> None:
        """To a file. What is there is replaced at once, when all is on the disk, and otherwise stays.

        Parameters
        ----------
        path : path
            Where it goes.

        Raises
        ------
        OSError
            It cannot be written, as where the disk is full.
        """
        _files.write(path, self._field.content())

    @overload
    def __call__(self, xyz: ArrayLike, normals: None = None, *, threads: int = 0, progress: Progress = None) -> Points: ...
    @overload
    def __call__(self, xyz: ArrayLike, normals: ArrayLike, *, threads: int = 0, progress: Progress = None) -> tuple[Points, Points]: ...
    def __call__(self, xyz: ArrayLike, normals: ArrayLike | None = None, *, threads: int = 1,
                 progress: Progress = None) -> Points | tuple[Points, Points]:
        """Carries points.

        Parameters
        ----------
        xyz : array_like
            n x 3, world coordinates. Points that are not finite, or beyond 1e100, stay as they are, and so does, to the bit, what is
            nearest to something that was fixed.
        normals : array_like, optional
            n x 3, of any length.
        threads : int, default 1
            How many to use; 0 is one a core. Python's lock is free meanwhile.
        progress : Progress, optional
            Told what is being done; see [Progress][pymeshlab_fcd.Progress].

        Returns
        -------
        ndarray or tuple[ndarray, ndarray]
            The positions, n x 3, and, where normals are given, these, too, as long as they were.

        Raises
        ------
        TypeError
            Something is of another kind than what is asked for here.
        ValueError
            It has another shape.
        """
        rows = _inputs.rows("xyz", xyz, lent=True)
        beside = None if normals is None else _inputs.rows("normals", normals, len(rows), "one for each point", lent=True)
        positions, turned = self._field.apply(rows, beside, _inputs.whole("threads", threads, 0, 1024), report(progress))
        return positions if turned is None else (positions, turned)

    @property
    def samples(self) -> Points:
        """k x 3, where it was sampled, at rest: the thinned surface. Far from it, no answer makes sense."""
        return self._field.positions()

    @property
    def largest_difference(self) -> float | None:
        """By how much a vertex of the surface that was deformed is off at most, in world units: what this approximates by.
        None where the file, of an earlier version, does not tell."""
        largest = self._field.largest_difference
        return None if math.isnan(largest) else largest

    @property
    def file_size(self) -> int:
        """Of what [save][pymeshlab_fcd.Deformation.save] writes, in bytes."""
        return len(self._field.content())

    @property
    def seconds(self) -> float | None:
        """How long it took to be made. None where it was read."""
        return self._seconds

    def __eq__(self, other: object) -> bool:
        return self._field.content() == other._field.content() if isinstance(other, Deformation) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._field.content())

    def __reduce__(self) -> tuple[type[Deformation], tuple[bytes]]:
        return Deformation, (self._field.content(),)

    def __repr__(self) -> str:
        largest = self.largest_difference
        return f"<Deformation of {self._field.samples} samples, off by {'an unknown amount' if largest is None else f'{largest:g} at most'}>"
