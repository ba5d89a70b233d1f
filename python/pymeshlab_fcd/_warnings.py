# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings: a class for each kind, so that each can be silenced, or made an error."""
from __future__ import annotations

import warnings
from collections.abc import Iterable


class DeformationWarning(UserWarning):
    """Something in a deformation is probably not intended, or only approximate; the text says what to do. Each kind is a subclass."""


class NothingMovesWarning(DeformationWarning):
    """No handle or landmark moves."""


class NotAtRestWarning(DeformationWarning):
    """The shape did not converge."""


class FoldWarning(DeformationWarning):
    """Triangles are flipped, or the deformation has no inverse at a fold."""


class ContactWarning(DeformationWarning):
    """The surface passes through itself, and did not at rest."""


class StretchWarning(DeformationWarning):
    """Edges join two held regions that move differently, and are stretched."""


class RigidWarning(DeformationWarning):
    """Nothing is fixed beside the free surface, so it moves rigidly."""


class OverruledWarning(DeformationWarning):
    """Vertices at the same position have different tags."""


class SlitWarning(DeformationWarning):
    """Open borders are close to each other, and are not joined."""


class ScanLineWarning(DeformationWarning):
    """Points of a cloud are only connected along their scan lines."""


class VolumeWarning(DeformationWarning):
    """A part that should keep its volume encloses none, or could not keep it."""


class NodeWarning(DeformationWarning):
    """Given nodes do not lie on the free surface."""


class AccuracyWarning(DeformationWarning):
    """A saved deformation is less accurate than asked for."""


class SpaceWarning(DeformationWarning):
    """Points take a deformation far from the surface that was deformed, or in other units."""


class MatchWarning(DeformationWarning):
    """Little of a surface has a counterpart on the other one."""


class LandmarkWarning(DeformationWarning):
    """Landmarks contradict each other or the target, lie far from the surface, or leave a turn open."""


class SymmetryWarning(DeformationWarning):
    """The plane of symmetry is not sure, or little of a surface has a counterpart on its other side."""


class CompensationWarning(DeformationWarning):
    """Little of a part is scanned, or much is left after the warp."""


class LineWarning(DeformationWarning):
    """Parts of a surface do not move with the line, or its middles were not used."""


Told = tuple[type[DeformationWarning], str]


def warn(found: Iterable[Told], level: int) -> None:
    """Warns of each. level: as in warnings.warn, counted from here"""
    for kind, text in found:
        warnings.warn(text, kind, level + 1)


def triangles_turned(folded: int) -> str:
    return f"{folded} {'triangle is' if folded == 1 else 'triangles are'} flipped"
