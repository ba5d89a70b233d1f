# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements of a mesh: defined once on its vertices, and taken of each result."""
from __future__ import annotations

import os
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _tables
from ._inputs import Points
from ._numbers import lengths, shown

_FEWEST: Final = {"distance": 2, "length": 2, "girth": 3}


class Measure(NamedTuple):
    """A length between vertices."""

    name: str
    kind: str
    """`distance`: the straight line between two; `length`: along edges; `girth`: along edges and back to the first one."""
    vertices: NDArray[np.int64]

    def of(self, places: Points) -> float:
        """The length, in units of places (n x 3)."""
        way = places[self.vertices]
        ends = np.roll(way, -1, axis=0) if self.kind == "girth" else way[1:]
        return float(lengths(ends - way[:len(ends)]).sum())


def read(path: str | os.PathLike[str]) -> list[Measure]:
    """Reads measurements from a file, a line for each: name, kind, numbers of vertices from 0. Lines that begin with # are comments.

    Raises
    ------
    OSError
        It cannot be read.
    ValueError
        A line is wrong; the message names it.
    """
    found: list[Measure] = []
    for where, row in _tables.rows(path):
        name, kind, *numbers = row if len(row) > 1 else [row[0], ""]
        if kind not in _FEWEST:
            raise ValueError(f"{where} must be: name, distance or length or girth, numbers of vertices; it is {', '.join(row)}")
        try:
            vertices = np.array([int(each) for each in numbers], np.int64)
        except (ValueError, OverflowError):
            raise ValueError(f"{where}: numbers of vertices are whole numbers from 0; they are {', '.join(numbers)}") from None
        if len(vertices) < _FEWEST[kind] or (kind == "distance" and len(vertices) > 2) or vertices.min() < 0:
            raise ValueError(f"{where}: a {kind} has {'two' if kind == 'distance' else f'{_FEWEST[kind]} or more'} numbers of vertices, from 0")
        if not name or any(name == other.name for other in found):
            raise ValueError(f"{where}: each measurement needs a name of its own; this one is '{name}'")
        found.append(Measure(name, kind, vertices))
    if not found:
        raise ValueError(f"{shown(path)} names no measurement: a line is name, distance or length or girth, numbers of vertices")
    return found


def take(measures: list[Measure], places: Points, faces: NDArray[np.int64] | None) -> dict[str, float]:
    """Takes all measurements, by name.

    Parameters
    ----------
    places
        n x 3.
    faces
        m x 3; lengths and girths must follow their edges. None: a cloud, where they go straight from point to point.

    Raises
    ------
    ValueError
        A vertex does not exist, or no edge joins two successive vertices.
    """
    edges: NDArray[np.int64] | None = None
    for each in measures:
        if each.vertices.max() >= len(places):
            raise ValueError(f"the measurement {each.name} names vertex {each.vertices.max()}, but there are only {len(places)}, from 0")
        if faces is None or each.kind == "distance":
            continue
        if edges is None:
            edges = np.unique(_numbered(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), len(places)))
        ends = np.roll(each.vertices, -1) if each.kind == "girth" else each.vertices[1:]
        pairs = np.stack([each.vertices[:len(ends)], ends], 1)
        lacks = np.flatnonzero(~np.isin(_numbered(pairs, len(places)), edges))
        if len(lacks):
            a, b = pairs[lacks[0]]
            raise ValueError(f"the measurement {each.name} goes from vertex {a} to {b}, which no edge joins: name each vertex that it passes")
    return {each.name: each.of(places) for each in measures}


def _numbered(pairs: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """A number for each pair of vertices, independent of their order."""
    numbered: NDArray[np.int64] = pairs.min(axis=1) * np.int64(count) + pairs.max(axis=1)
    return numbered
