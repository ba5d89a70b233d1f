# SPDX-License-Identifier: GPL-3.0-or-later
"""The mean of shapes with corresponding vertices: generalized Procrustes analysis (Gower 1975)."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._inputs import Points

# Largest move of the mean at rest, over its size: far below the errors of scans.
_STILL: Final = 1e-7
_MOST_PASSES: Final = 50  # it mostly comes to rest in four


class Mean(NamedTuple):
    """The mean of shapes."""

    vertices: Points
    """n x 3, placed as the first shape."""
    apart: NDArray[np.float64]
    """Distance of each shape, laid onto the mean, from it: root mean square over the vertices."""


def _laid(shape: Points, onto: Points, size: float | None) -> Points:
    """A shape, moved rigidly as near as possible to another one, which is centred at 0. size: if given, the shape is scaled to it"""
    centred = shape - shape.mean(axis=0)
    u, _, v = np.linalg.svd(centred.T @ onto)
    turned: Points = centred @ (u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v)
    return turned if size is None else turned * (size / max(_size(turned), 1e-300))


def _size(centred: Points) -> float:
    return float(np.sqrt((centred**2).sum(axis=1).mean()))


def mean_shape(shapes: Sequence[Callable[[], Points]], scaled: bool) -> Mean:
    """The mean shape, with each shape laid onto it by a rigid motion.

    Parameters
    ----------
    shapes
        Each returns a shape, n x 3. It is called once in each pass, so that only one is in memory.
    scaled
        Each is first scaled to the mean of their sizes.
    """
    first = shapes[0]()
    place = first.mean(axis=0)
    mean = first - place
    size: float | None = None
    if scaled:
        size = float(np.mean([_size(each - each.mean(axis=0)) for each in (shape() for shape in shapes)]))
        mean = mean * (size / max(_size(mean), 1e-300))
    for _ in range(_MOST_PASSES):
        total = np.zeros_like(mean)
        for shape in shapes:
            total += _laid(shape(), mean, size)
        # Placed as the first one: otherwise the mean may drift.
        found = _laid(total / len(shapes), first - place, size)
        moved = _size(found - mean)
        mean = found
        if moved <= _STILL * max(_size(mean), 1e-300):
            break
    return Mean(mean + place, np.array([_size(_laid(shape(), mean, size) - mean) for shape in shapes]))
