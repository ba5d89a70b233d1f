# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a surface passes through itself."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ._warnings import ContactWarning, Told

UNASKED: Final = 250_000
"""Surfaces of at most so many faces are checked for contact unasked, which takes a tenth of a second at most. In larger ones, it takes longer
than the pose itself."""


@dataclass(frozen=True, eq=False)
class Contact:
    """Where a surface passes through itself and did not at rest. Neighbours, and other triangles that touched at rest, do not count."""

    faces: NDArray[np.int64]
    """Numbers of the triangles that pass through another one, ascending."""
    pairs: int
    """Number of pairs of such triangles."""
    largest_depth: float
    """The largest of `depth`; 0 without contact."""
    depth: NDArray[np.float64]
    """n: how far each vertex has come through the surface, in units of the vertices; 0 for most. Corners of the triangles in contact have the
    depth of their pair. These triangles also cut the surface into pieces. In each connected part, all pieces but the largest are inside. Their
    vertices have the distance from the surface that they passed. At a crease, that may be the same piece."""

    @property
    def triangles(self) -> int:
        """How many triangles pass through another one."""
        return len(self.faces)

    def __repr__(self) -> str:
        return f"<Contact of {self.triangles} triangles, up to {self.largest_depth:g} deep>"

    def _words(self, remedy: str) -> list[Told]:
        if not self.triangles:
            return []
        return [(ContactWarning, f"{self.triangles} triangles pass through others and did not at rest: the surface reaches up to "
                                 f"{self.largest_depth:g} into itself (Pose.contact tells where). {remedy}")]
