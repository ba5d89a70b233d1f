# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers as callers may give them, as an array of numpy."""
from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def plain(name: str, values: object, what: str = "an array of numbers") -> NDArray[Any]:
    """An array of any kind of numbers, of any shape; the caller's own where it is one. what: that is asked for"""
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
        raise TypeError(f"{name} must be {what}; {_kind(values, array)} is none")
    return array


def _kind(values: object, array: NDArray[Any]) -> str:
    return f"an array of {array.dtype}" if isinstance(values, np.ndarray) else f"a {type(values).__name__} that holds {array.dtype}"


def told_shape(array: NDArray[Any]) -> str:
    return " x ".join(map(str, array.shape)) or "a single number"
