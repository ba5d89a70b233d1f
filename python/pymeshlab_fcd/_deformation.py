# SPDX-License-Identifier: GPL-3.0-or-later
"""Saved deformations, without MeshLab."""
from __future__ import annotations

import math
import os
from collections.abc import Sequence
from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _files, _inputs
from ._core import Field
from ._grid import Axes, DisplacementGrid, GridKind
from ._inputs import Points
from ._numbers import plain, shown, text
from ._progress import Progress, report
from ._warnings import SpaceWarning, warn


class Deformation:
    """A deformation of space, as `save_fcd_deformation` and [Pose.deformation][pymeshlab_fcd.Pose.deformation] make it.

    Call it with points in world coordinates. Each point moves with the nearest place of the deformed surface. Its bits do not depend on other
    points, on their order, or on threads. Any number of threads may use one object at a time. It can be pickled, to a megabyte or so. Two are
    equal if all their bits are.

    Parameters
    ----------
    content : bytes
        The content of a file.
    name : str, default 'deformation'
        Its name in messages.

    Raises
    ------
    TypeError
        The content is not bytes.
    ValueError
        It is no saved deformation; the message says what is wrong.
    """

    __slots__ = ("_field", "_seconds")

    def __init__(self, content: bytes, name: str = "deformation") -> None:
        if not isinstance(content, (bytes, bytearray, memoryview)):
            raise TypeError(f"content must be the bytes of a file; it is a {type(content).__name__}. Deformation.load(path) reads a file")
        self._field = Field.read(bytes(content), shown(text("name", name)), 1)  # small: more threads would not help
        self._seconds: float | None = None

    @classmethod
    def _of(cls, field: Field, seconds: float) -> Deformation:
        made = cls.__new__(cls)
        made._field, made._seconds = field, seconds
        return made

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Deformation:
        """Reads a file.

        Parameters
        ----------
        path : path
            A file of `save_fcd_deformation` or [save][pymeshlab_fcd.Deformation.save].

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
        """Writes a file. An existing one is replaced once all is on the disk; if that fails, it stays.

        Parameters
        ----------
        path : path
            Where it goes.

        Raises
        ------
        OSError
            It cannot be written, for example since the disk is full.
        """
        _files.write(path, self._field.content())

    @overload
    def __call__(self, xyz: ArrayLike, normals: None = None, *, threads: int = 1, progress: Progress = None) -> Points: ...
    @overload
    def __call__(self, xyz: ArrayLike, normals: ArrayLike, *, threads: int = 1, progress: Progress = None) -> tuple[Points, Points]: ...
    def __call__(self, xyz: ArrayLike, normals: ArrayLike | None = None, *, threads: int = 1,
                 progress: Progress = None) -> Points | tuple[Points, Points]:
        """Maps points.

        Parameters
        ----------
        xyz : array_like
            n x 3, world coordinates. Points nearest to a fixed part keep their bits. So do points that are not finite, or beyond 1e100.
        normals : array_like, optional
            n x 3, of any length.
        threads : int, default 1
            How many to use; 0 is one a core. Python's lock is free meanwhile.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].

        Returns
        -------
        ndarray or tuple[ndarray, ndarray]
            The positions, n x 3; with normals, also the turned normals, with their lengths kept.

        Raises
        ------
        ValueError
            An argument has the wrong shape.

        Warns
        -----
        SpaceWarning
            The points lie far from the surface that was deformed, or are of other units.
        """
        rows = _inputs.rows("xyz", xyz, lent=True)
        if remark := self._field.space_remark(rows):
            warn([(SpaceWarning, remark)], 2)
        beside = None if normals is None else _inputs.rows("normals", normals, len(rows), "one for each point", lent=True)
        positions, turned = self._field.apply(rows, beside, _inputs.whole("threads", threads, 0, 1024), report(progress))
        return positions if turned is None else (positions, turned)

    def linear(self, xyz: ArrayLike, *, threads: int = 1, progress: Progress = None) -> NDArray[np.float64]:
        """The linear maps of space at points: for strain, tensors, splats and all else that has directions.

        Parameters
        ----------
        xyz : array_like
            n x 3, world coordinates.
        threads : int, default 1
            How many to use; 0 is one a core.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].

        Returns
        -------
        ndarray
            n x 3 x 3: each matrix times a small vector there is the deformed vector.

        Raises
        ------
        ValueError
            An argument has the wrong shape.
        """
        return self._field.linear(_inputs.rows("xyz", xyz, lent=True), _inputs.whole("threads", threads, 0, 1024), report(progress))

    def grid(self, spacing: float | Sequence[float], *, low: ArrayLike | None = None, high: ArrayLike | None = None, axes: Axes = "LPS",
             kind: GridKind = "modeling", threads: int = 0, progress: Progress = None) -> DisplacementGrid:
        """Displacements on a grid, to save for ITK, Slicer or VTK. They are exact at the points of the grid.

        Parameters
        ----------
        spacing : float or Sequence[float]
            Distance of neighbouring points, or three, along x, y and z. Other programs interpolate between the points: choose it no wider than
            the gap between parts that move differently.
        low : array_like, optional
            The smallest coordinates of the box that the grid covers. None: a spacing below those of the samples.
        high : array_like, optional
            The largest coordinates. None: a spacing above those of the samples.
        axes : {'LPS', 'RAS'}, default 'LPS'
            The directions of the surface's coordinate axes.
        kind : {'modeling', 'resampling'}, default 'modeling'
            The kind that the file states. `modeling`: displacements of points and surfaces. `resampling`: the inverse,
            `pose.deformation(inverse=True)`, to resample a volume.
        threads : int, default 0
            How many to use; 0 is one a core.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].

        Raises
        ------
        ValueError
            An argument has the wrong shape, or is out of range, or the grid has more than 500 million points.
        """
        steps = _inputs.finite("spacing", np.atleast_1d(plain("spacing", spacing)).astype(np.float64))
        if steps.shape not in ((1,), (3,)) or not (steps > 0).all():
            raise ValueError("spacing must be one number above 0, or three, for x, y and z")
        steps = np.broadcast_to(steps, 3)
        samples = self.samples
        begin, end = (
            default if given is None else _inputs.vector(name, given)
            for name, given, default in (("low", low, samples.min(0) - steps), ("high", high, samples.max(0) + steps)))
        if not (begin <= end).all():
            raise ValueError("low must not be above high")
        counts = np.ceil((end - begin) / steps * (1 - 1e-12)) + 1  # no additional step by rounding
        if np.prod(counts) > 5e8:
            raise ValueError(f"a grid of {np.prod(counts):.3g} points is more than 500 million: give a wider spacing, or a smaller box")
        chosen = _inputs.choice("axes", axes, ("LPS", "RAS")), _inputs.choice("kind", kind, ("modeling", "resampling"))
        lines = [begin[d] + steps[d] * np.arange(int(counts[d])) for d in range(3)]
        points = np.stack(np.meshgrid(*lines, indexing="ij"), axis=3).reshape(-1, 3)
        moved = self(points, threads=threads, progress=progress)
        moved -= points
        return DisplacementGrid(moved.reshape(*map(len, lines), 3), (float(begin[0]), float(begin[1]), float(begin[2])),
                                (float(steps[0]), float(steps[1]), float(steps[2])),
                                "RAS" if chosen[0] else "LPS", "resampling" if chosen[1] else "modeling")

    @property
    def samples(self) -> Points:
        """k x 3, the positions of the samples at rest: a thinned surface. Far from it, the deformation means nothing."""
        return self._field.positions()

    @property
    def largest_difference(self) -> float | None:
        """The largest error at a vertex of the deformed surface, in world units: this object is an approximation. None if it was read from a
        file of an earlier version."""
        largest = self._field.largest_difference
        return None if math.isnan(largest) else largest

    @property
    def file_size(self) -> int:
        """The size of the file that [save][pymeshlab_fcd.Deformation.save] writes, in bytes."""
        return len(self._field.content())

    @property
    def seconds(self) -> float | None:
        """The time to make it. None if it was read from a file."""
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
