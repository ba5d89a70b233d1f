# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions of handles that a matrix cannot express: half turns and more, and steps about the handle's middle."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ._numbers import plain, told_shape
from ._numbers import text as expected_text


def _numbers(name: str, values: ArrayLike, shape: tuple[int, ...]) -> str:
    """The numbers as text, each to the bit."""
    what = f"{' x '.join(map(str, shape))} numbers" if shape else "a number"
    array = plain(name, values, what)
    if array.dtype.kind == "b":
        raise TypeError(f"{name} must be {what}, not a mask")
    if array.shape != shape:
        raise ValueError(f"{name} must be {what}; it is {told_shape(array)}. "
                         "A motion is a 4 x 4 matrix, or a Motion, as Motion.translate([0, 0, 5])")
    array = array.astype(np.float64)
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite numbers")
    return " ".join(repr(float(x)) for x in array.ravel())


@dataclass(frozen=True)
class Motion:
    """A motion of a handle: steps that are made in the order in which they were added.

    A 4 x 4 matrix also works, except for rotations of half a turn or more: a matrix turns the shortest way, and a full turn is
    none. World coordinates; matrices act on column vectors.

    ```python
    Motion.rotate([0, 0, 1], 270).then(Motion.translate([0, 0, 5]))
    ```
    """

    text: str = ""
    """The steps, for the filters' parameter `transforms`."""

    def __post_init__(self) -> None:
        expected_text("the steps", self.text, "translate 0 0 5")

    @classmethod
    def translate(cls, by: ArrayLike) -> Motion:
        """Moves.

        Parameters
        ----------
        by : array_like
            3 numbers, the units of the vertices.

        Raises
        ------
        TypeError
            The argument is not numbers.
        ValueError
            It has another shape, or is not finite.
        """
        return cls("translate " + _numbers("by", by, (3,)))

    @classmethod
    def rotate(cls, axis: ArrayLike, degrees: float, about: ArrayLike | None = None) -> Motion:
        """Turns, counterclockwise when the axis points at you.

        Parameters
        ----------
        axis : array_like
            3 numbers, of any length but 0.
        degrees : float
            Any angle; 360 is a full turn.
        about : array_like, optional
            The pivot, 3 numbers. None: the mean of the handle's vertices, as the steps before have moved it.

        Raises
        ------
        TypeError
            The argument is not numbers.
        ValueError
            It has another shape, is not finite, or the axis has no length.
        """
        text = f"rotate {_numbers('axis', axis, (3,))} {_numbers('degrees', degrees, ())}"
        if not np.any(np.asarray(axis, dtype=np.float64)):
            raise ValueError("axis must have a length: [0, 0, 1] is the z axis")
        return cls(text + ("" if about is None else " about " + _numbers("about", about, (3,))))

    @classmethod
    def scale(cls, factors: ArrayLike, about: ArrayLike | None = None) -> Motion:
        """Scales.

        Parameters
        ----------
        factors : array_like
            One number, or 3 for x, y and z; greater than 0.
        about : array_like, optional
            As in [rotate][pymeshlab_fcd.Motion.rotate].

        Raises
        ------
        TypeError
            The argument is not numbers.
        ValueError
            It has another shape, is not finite, or not greater than 0.
        """
        one = np.ndim(factors) == 0
        text = "scale " + _numbers("factors", factors, () if one else (3,))
        if not (np.asarray(factors, dtype=np.float64) > 0).all():
            raise ValueError("factors must be greater than 0: a motion neither mirrors nor flattens")
        return cls(text + ("" if about is None else " about " + _numbers("about", about, (3,))))

    @classmethod
    def affine(cls, matrix: ArrayLike) -> Motion:
        """Moves by a matrix.

        Parameters
        ----------
        matrix : array_like
            4 x 4, for column vectors; the last row is 0 0 0 1. It neither mirrors nor flattens (its determinant is greater than 0).

        Raises
        ------
        TypeError
            The argument is not numbers.
        ValueError
            It has another shape, is not finite, or has another last row.
        """
        text = _numbers("the matrix", matrix, (4, 4))
        if not np.array_equal(np.asarray(matrix, dtype=np.float64)[3], [0, 0, 0, 1]):
            raise ValueError("the last row of the matrix must be 0 0 0 1: it is for column vectors, with the translation in its last "
                             "column. Transpose a matrix for row vectors")
        return cls("matrix " + text)

    @classmethod
    def parse(cls, text: str) -> Motion:
        """Reads steps, as in the filters' parameter `transforms`.

        Parameters
        ----------
        text : str
            For example `rotate 0 0 1 135 about 0 0 0 translate 0 0 5`, without the tag. Errors in it are raised when the motion is used.

        Raises
        ------
        TypeError
            It is not a text.
        ValueError
            It is for several handles.
        """
        steps = cls(text)
        if ":" in steps.text or ";" in steps.text:
            raise ValueError("the steps must be those of one handle, without its tag: 'translate 0 0 5', not '2: translate 0 0 5'")
        return cls(steps.text.strip())

    def then(self, other: Motion) -> Motion:
        """The steps of this motion, and then those of another.

        Parameters
        ----------
        other : Motion
            Made after this one.

        Raises
        ------
        TypeError
            It is not a Motion.
        """
        if not isinstance(other, Motion):
            raise TypeError(f"what follows must be a Motion, as Motion.affine(matrix); it is a {type(other).__name__}")
        return Motion(f"{self.text} {other.text}".strip())
