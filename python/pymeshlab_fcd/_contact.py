# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a surface passes through itself."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ._warnings import ContactWarning, Told

UNASKED: Final = 250_000
"""Faces of a surface in which contact is looked for without being asked: that takes a tenth of a second at most. It takes longer than
the pose itself, so that of a larger one, it is looked for where somebody asks."""


@dataclass(frozen=True, eq=False)
class Contact:
    """Where a surface passes through itself and did not at rest. Neighbours, and other triangles that touched at rest, do not count."""

    faces: NDArray[np.int64]
    """Ascending: numbers of the triangles that pass through another one."""
    pairs: int
    """Of such triangles."""
    largest_depth: float
    """How far the surface has come through itself at most, in units of the vertices; 0 without contact."""
    depth: NDArray[np.float64]
    """n: how far each vertex has come through, which is 0 of most. Where the triangles in contact cut something off, that is its distance
    from the surface that it came through; of other corners of these triangles, how far the two reach through each other."""

    @property
    def triangles(self) -> int:
        """How many triangles pass through another one."""
        return len(self.faces)

    def __repr__(self) -> str:
        return f"<Contact of {self.triangles} triangles, up to {self.largest_depth:g} deep>"

    def _words(self) -> list[Told]:
        if not self.triangles:
            return []
        return [(ContactWarning, f"{self.triangles} triangles pass through others, which they did not at rest: the surface has come up to "
                                 f"{self.largest_depth:g} far through itself (Pose.contact tells where). Move the handles less.")]
