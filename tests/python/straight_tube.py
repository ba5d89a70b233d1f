# SPDX-License-Identifier: GPL-3.0-or-later
"""A tube along x, and what it is when it is bent, for the tests of straightening, here and inside MeshLab."""
import numpy as np

LENGTH, RADIUS = 10.0, 0.6


def tube(rings=101, around=24, radius=RADIUS):
    """Along x: (vertices, faces)."""
    x, a = [grid.ravel() for grid in np.meshgrid(np.linspace(0, LENGTH, rings), 2 * np.pi * np.arange(around) / around, indexing="ij")]
    here = np.arange(around)
    beside = np.roll(here, -1)
    faces = [face for r in range(rings - 1) for face in (
        np.stack([here, here + around, beside], 1) + r * around, np.stack([beside, here + around, beside + around], 1) + r * around)]
    return np.stack([x, radius * np.cos(a), radius * np.sin(a)], 1), np.concatenate(faces).astype(np.int32)


def bent(points, degrees=120.0):
    """Along an arc in the plane of x and y."""
    radius = LENGTH / np.radians(degrees)
    turn = points[:, 0] / radius
    return np.stack([(radius - points[:, 1]) * np.sin(turn), radius - (radius - points[:, 1]) * np.cos(turn), points[:, 2]], 1)
