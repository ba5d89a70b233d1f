# SPDX-License-Identifier: GPL-3.0-or-later
"""Small surfaces to try things with, made by formula."""
from typing import NamedTuple

import numpy as np
import numpy.typing as npt


class Sample(NamedTuple):
    """A surface with tags."""

    vertices: npt.NDArray[np.float64]
    """n x 3."""
    faces: npt.NDArray[np.int32]
    """m x 3, numbers of vertices."""
    tags: npt.NDArray[np.int32]
    """n: 0 is fixed, 1 is free, 2 is a handle."""


def strip(columns: int = 201, rows: int = 41) -> Sample:
    """A corrugated strip along x, 10 long and 2 wide. The first tenth is fixed; the last tenth is handle 2.

    Parameters
    ----------
    columns : int
        Vertices along x, 2 or more.
    rows : int
        Vertices along y, 2 or more.

    Returns
    -------
    Sample
        Its vertices, faces and tags.
    """
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, 10, columns), np.linspace(0, 2, rows), indexing="ij"))
    vertices = np.stack([x, y, 0.1 * np.sin(5 * x)], 1)
    corner = np.arange(columns * rows).reshape(columns, rows)[:-1, :-1].ravel()
    faces = np.concatenate([np.stack([corner, corner + rows, corner + 1], 1),
                            np.stack([corner + 1, corner + rows, corner + rows + 1], 1)]).astype(np.int32)
    tags = np.where(x < 1, 0, np.where(x > 9, 2, 1)).astype(np.int32)
    return Sample(vertices, faces, tags)
