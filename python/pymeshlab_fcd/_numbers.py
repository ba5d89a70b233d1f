# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers and texts of callers."""
from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray


def plain(name: str, values: object, what: str = "an array of numbers") -> NDArray[Any]:
    """An array of any kind of numbers, of any shape; the caller's own if it is one. what: is expected, for messages"""
    if values is None:
        raise TypeError(f"{name} is None; give {what}")
    if isinstance(values, np.ma.MaskedArray):
        if np.ma.getmaskarray(values).any():
            raise ValueError(f"{name} has masked values; give it without them, as values.compressed() or values.filled(...)")
        values = values.data
    try:
        array = np.asarray(values)
    except Exception as error:  # of another library
        raise TypeError(f"{name} cannot be read as {what}: {error}") from error
    if array.dtype.kind not in "fiub":
        remedy = ". If all of it is numbers, use .astype(np.float64) or .astype(np.int64)" if array.dtype.kind == "O" and array.ndim else ""
        raise TypeError(f"{name} must be {what}; {_kind(values, array)} is none{remedy}")
    return array


def lengths(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """The lengths of n x 3 rows, without overflow or underflow."""
    largest = np.abs(rows).max(initial=0)
    unit = 1.0 if not 0 < largest < np.inf or 1e-100 < largest < 1e100 else np.ldexp(1.0, int(np.log2(largest)))
    found: NDArray[np.float64] = np.linalg.norm(rows / unit, axis=1) * unit
    return found


def text(name: str, value: object, example: str = "") -> str:
    """A text that can be written as UTF-8."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a text{example and f', as {example!r}'}; it is a {type(value).__name__}")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ValueError(f"{name} must be a text of whole characters; {value!r} has half of a surrogate pair") from None
    return value


def shown(path: str | bytes | os.PathLike[Any]) -> str:
    """The name of a file for tables and messages, the same in any locale; bytes that are no UTF-8 are escaped as \\xe9."""
    return os.fsencode(path).decode("utf-8", "backslashreplace").replace("\0", "\\0")


def told(error: BaseException) -> str:
    """What an error says, in a line for people: of a file, without the number of the error."""
    if not isinstance(error, OSError) or error.filename is None:
        return f"{error}" or type(error).__name__
    return f"{shown(error.filename)} is a folder: give a file" if os.path.isdir(error.filename) else f"{shown(error.filename)}: {error.strerror}"


def _kind(values: object, array: NDArray[Any]) -> str:
    if isinstance(values, (str, bytes)):
        return f"the text {values!r:.60}"
    return f"an array of {array.dtype}" if isinstance(values, np.ndarray) else f"a {type(values).__name__} that holds {array.dtype}"


def told_shape(array: NDArray[Any]) -> str:
    return " x ".join(map(str, array.shape)) or "a single number"
