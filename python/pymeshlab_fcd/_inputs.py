# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of arguments: each is converted, or an error says what to give instead."""
from __future__ import annotations

import math
import operator
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ._motion import Motion
from ._numbers import plain, told_shape

Points = NDArray[np.float64]
TAGS: Final = "0 fixed, 1 free, 2 and up handles, negative outside"
_LAST_INT32: Final = 2**31 - 1


def own(array: NDArray[Any], dtype: type[np.generic]) -> NDArray[Any]:
    """A copy of our own that nobody can write to. (A view, since its flag cannot be set back.)"""
    copy = np.array(array, dtype=dtype, order="C", copy=True)
    copy.flags.writeable = False
    return copy.view()


def rows(name: str, values: object, count: int | None = None, what: str = "one row per point", lent: bool = False) -> Points:
    """n x 3 doubles, C-contiguous: a copy, or, if `lent`, the caller's own array if it has this form."""
    array = plain(name, values)
    if array.dtype.kind == "b":
        raise TypeError(f"{name} must be coordinates, not a mask")
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} must be {'n' if count is None else count} x 3, {what}; it is {told_shape(array)}")
    if count is not None and len(array) != count:
        raise ValueError(f"{name} must have {count} rows, {what}; it has {len(array)}")
    return np.ascontiguousarray(array, dtype=np.float64) if lent else own(array, np.float64)


def normals(values: object, count: int, name: str = "normals", lent: bool = False) -> Points:
    """Normals at rest, of any length whose square single precision holds, or 0."""
    array = rows(name, values, count, "one for each vertex", lent)
    largest = np.abs(array).max(axis=1, initial=0)
    if not (((largest >= 1e-15) & (largest <= 1e15)) | (largest == 0)).all():
        raise ValueError(f"{name} must be finite, of lengths from 1e-15 to 1e15, or 0 where there is none; scale them to length 1")
    return array


def vector(name: str, value: object) -> Points:
    """A direction or a corner, 3 finite doubles."""
    array = plain(name, value, "3 numbers")
    if array.dtype.kind == "b" or array.shape not in ((3,), (1, 3)):
        raise ValueError(f"{name} must be 3 numbers; it is {told_shape(array)} of {array.dtype}")
    return finite(name, own(array.reshape(3), np.float64))


def written(name: str, array: object, count: int) -> Points:
    """The caller's array, checked for writing."""
    if not isinstance(array, np.ndarray) or array.dtype != np.float64 or array.shape != (count, 3):
        raise TypeError(f"{name} must be an array of numpy to write to, {count} x 3 doubles: np.empty(({count}, 3))")
    if not (array.flags.c_contiguous and array.flags.writeable and array.dtype.isnative and array.flags.aligned):
        raise ValueError(f"{name} must be C-contiguous, writeable and of this machine's byte order: np.empty(({count}, 3))")
    return array


def triangles(values: object, vertices: int, name: str = "faces") -> NDArray[np.uint32] | None:
    """A copy of m x 3 numbers of vertices; None if there are none."""
    if values is None:
        return None
    array = plain(name, values)
    if array.size == 0:
        return None
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} must be m x 3, the numbers of the vertices at the corners of triangles; it is {told_shape(array)}. "
                         "Split other polygons into triangles first; give None for a cloud")
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name} must be whole numbers, those of the vertices at the corners; it holds {array.dtype}. "
                        f"Use {name}.astype(np.int64)")
    corners: NDArray[np.uint32] | None = None
    if array.min() >= 0 and array.max() < vertices:
        corners = own(array, np.uint32)
    if corners is None or corners.max() >= vertices:  # checked again: another thread may have written meanwhile
        raise ValueError(f"{name} must hold numbers of vertices, 0 to {vertices - 1}; it holds {array.min()} to {array.max()}")
    return corners


def tags(values: object, vertices: int) -> NDArray[np.int32]:
    """A whole number per vertex."""
    array = plain("tags", values)
    if array.dtype.kind == "b":
        raise TypeError(f"tags must be whole numbers ({TAGS}), not a mask; np.where(mask, 2, 1) makes handles of where it is true")
    if array.shape != (vertices,):
        raise ValueError(f"tags must be {vertices} whole numbers, one for each vertex ({TAGS}); it is {told_shape(array)}")
    if array.dtype.kind == "f":
        odd = ~(array == np.rint(array))  # NaN, too
        if odd.any():
            raise ValueError(f"tags must be whole numbers ({TAGS}); that of vertex {odd.argmax()} is {array[odd.argmax()]}")
    if vertices and array.max() > _LAST_INT32:
        raise ValueError(f"tags must be below 2147483648; that of vertex {array.argmax()} is {array.max()}")
    return own(np.maximum(array, -1) if array.dtype.kind != "u" else array, np.int32)


def weights(values: object, vertices: int, name: str = "weights") -> NDArray[np.float64] | None:
    """A number from 0 to 1 per vertex; may be a mask."""
    if values is None:
        return None
    array = plain(name, values)
    if array.shape != (vertices,) or array.dtype.kind not in "bfiu":
        raise ValueError(f"{name} must be {vertices} numbers, one for each vertex, from 0 to 1; it is {told_shape(array)} of {array.dtype}")
    odd = ~((array >= 0) & (array <= 1))  # NaN, too
    if odd.any():
        raise ValueError(f"{name} must be from 0 (carried along) to 1; that of vertex {odd.argmax()} is {array[odd.argmax()]}")
    return own(array, np.float64)


def number(name: str, value: object) -> float:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise TypeError(f"{name} must be a number; it is {value!r}")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{name} must be a number that a double holds; it is {value!r}") from None


def accuracy(value: object) -> float:
    """The accuracy of a saved deformation."""
    given = number("accuracy", value)
    if not 0 <= given < math.inf:
        raise ValueError(f"accuracy must be a positive number, in world units, or 0, so that the largest motion sets it; it is {given}")
    return given


def flag(name: str, value: object) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} must be True or False; it is {value!r}")
    return bool(value)


def whole(name: str, value: object, low: int, high: int = _LAST_INT32) -> int:
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        index = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise TypeError(f"{name} must be a whole number; it is {value!r}") from None
    if not low <= index <= high:
        raise ValueError(f"{name} must be from {low} to {high}; it is {index}")
    return index


def choice(name: str, value: object, options: Sequence[str]) -> int:
    """The index of a word in the options."""
    if not isinstance(value, str) or value not in options:
        kind = TypeError if not isinstance(value, str) else ValueError
        raise kind(f"{name} must be one of {', '.join(map(repr, options))}; it is {value!r}")
    return options.index(value)


def _motion(tag: int, value: object) -> Motion:
    if isinstance(value, Motion):
        return value
    if isinstance(value, str):
        raise TypeError(f"the motion of handle {tag} is a text; give it as Motion.parse({value!r:.60})")
    as_matrix = getattr(value, "as_matrix", None)  # scipy's rigid transforms
    given: Any = as_matrix() if callable(as_matrix) else value
    try:
        return Motion.affine(given)
    except (TypeError, ValueError) as error:
        raise type(error)(f"the motion of handle {tag}: {error}") from error


def transforms(given: object, handles: Sequence[int] | None) -> list[tuple[int, str]]:
    """The tags of the handles that move, with their steps. handles: existing ones; None: not known"""
    if given is None:
        return []
    if not isinstance(given, Mapping):
        raise TypeError(f"transforms must be a mapping, {{tag: 4 x 4 matrix or Motion}}; it is a {type(given).__name__}")
    steps = []
    for key, value in given.items():
        tag = whole("a key of transforms, the tag of a handle,", key, 2)
        if handles is not None and tag not in handles:
            known = f"the handles are {', '.join(map(str, handles[:20]))}" if handles else "no vertex has a tag of 2 or more"
            raise ValueError(f"transforms moves handle {tag}, but no vertex has tag {tag}: {known}")
        text = _motion(tag, value).text
        if text:
            steps.append((tag, text))
    return steps


def points(values: object, vertices: int, name: str = "points") -> NDArray[np.int64] | Points:
    """Landmarks: numbers of vertices, k, or places, k x 3."""
    array = plain(name, values)
    if array.ndim == 2 or array.dtype.kind == "f" and array.size:
        return finite(name, rows(name, array, what="a place for each landmark, or whole numbers of vertices"))
    if array.size == 0:
        return np.zeros(0, np.int64)
    if array.dtype.kind not in "iu" or array.ndim != 1:
        raise ValueError(f"{name} must be numbers of vertices, or k x 3 places; it is {told_shape(array)} of {array.dtype}")
    numbers: NDArray[np.int64] = own(array, np.int64)
    if array.max() > _LAST_INT32 or numbers.min() < 0 or numbers.max() >= vertices:
        raise ValueError(f"{name} must be numbers of vertices, 0 to {vertices - 1}; it holds {array.min()} to {array.max()}")
    return numbers


def colors(values: object, count: int, name: str = "colors", what: str = "vertex") -> NDArray[np.uint8]:
    """n x 4 numbers from 0 to 255."""
    array = plain(name, values)
    if array.dtype.kind not in "fiu" or array.ndim != 2 or array.shape[0] != count or array.shape[1] not in (3, 4):
        raise ValueError(f"{name} must be {count} x 3, or x 4 with the opacity, one row for each {what}; it is {told_shape(array)} of {array.dtype}")
    most = 1 if array.dtype.kind == "f" else 255
    if not ((array >= 0) & (array <= most)).all():
        raise ValueError(f"{name} must be from 0 to {most}; they are from {array.min()} to {array.max()}")
    all_of_it = np.full((count, 4), 255, np.uint8)
    all_of_it[:, :array.shape[1]] = np.round(array * (255 / most))
    return all_of_it


def finite(name: str, values: Points) -> Points:
    if not np.isfinite(values).all():
        raise ValueError(f"{name} must be finite numbers")
    return values


