# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of two surfaces, as files have them."""
from __future__ import annotations

import os
from dataclasses import dataclass, field

from . import _core
from ._inputs import Points
from ._numbers import shown


@dataclass(frozen=True, eq=False)
class Curve:
    """A line on each of two surfaces, which slide along each other in a fit: one of `curves` of [fit][pymeshlab_fcd.fit]."""

    name: str
    """Its name."""
    source: Points
    """k x 3 corners on the surface that is fitted, in order. The free vertices nearest to them, and to points between them at most a mean edge
    apart, slide along the target's line."""
    target: Points
    """m x 3 corners on the target, in order; m need not be k. It is closed if the last is the first."""
    _file: str = field(default="", repr=False)  # name of the file, for messages
    _lines: list[int] = field(default_factory=list, repr=False)  # line of each corner of the source there


def read_curves(path: str | os.PathLike[str]) -> list[Curve]:
    """Reads curves from a table. Its first row is `curve, surface, x, y, z`; each other row is a corner: the name of its curve, `source` or
    `target`, and the place. The filter *FCD: Fit to Layer* takes the same file as *Curves*, with the same bits.

    Parameters
    ----------
    path : path
        Of the file, `.csv`.

    Returns
    -------
    list[Curve]
        For `curves` of [fit][pymeshlab_fcd.fit], in the order of their first rows.

    Raises
    ------
    OSError
        It cannot be read.
    ValueError
        What is wrong in it, with the line.
    """
    with open(os.fspath(path), "rb") as file:  # no number of an open file
        content = file.read()
    name = shown(path)
    return [Curve(curve.decode("utf-8", "replace"), source, target, name, lines)
            for curve, lines, source, target in _core.read_curves(content, name)]
