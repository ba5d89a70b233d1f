# SPDX-License-Identifier: GPL-3.0-or-later
"""A tube whose bends are known, for the tests of fits, here and inside MeshLab."""
import numpy as np

LENGTH = 4.0
DIAGONAL = np.sqrt(2 + LENGTH ** 2)


def tube(rings=60, around=30, end=LENGTH, shift=0.0):
    """A tube with bumps that tell each place of it from the others: (vertices, faces)."""
    angle = 2 * np.pi * (np.arange(around) + shift) / around
    z, a = [grid.ravel() for grid in np.meshgrid(np.linspace(0, end, rings), angle, indexing="ij")]
    radius = 0.4 + 0.05 * np.cos(3 * a + 2 * z) + 0.06 * np.sin(2.5 * z) * np.cos(a)
    here = np.arange(around)
    beside = np.roll(here, -1)
    faces = [face for r in range(rings - 1) for face in (
        np.stack([here, beside, here + around], 1) + r * around, np.stack([beside, beside + around, here + around], 1) + r * around)]
    return np.stack([radius * np.cos(a), radius * np.sin(a), z], 1), np.concatenate(faces).astype(np.int32)


def bent(points, degrees=15.0):
    """Along an arc, of so many degrees from end to end; the lower end stays."""
    radius = LENGTH / np.radians(degrees)
    turn = points[:, 2] / radius
    return np.stack([radius - (radius - points[:, 0]) * np.cos(turn), points[:, 1], (radius - points[:, 0]) * np.sin(turn)], 1)


def rms(a, b):
    """In percent of the diagonal."""
    return 100 * np.sqrt(((a - b) ** 2).sum(1).mean()) / DIAGONAL


def round_tube(*how):
    """One that slides about its axis."""
    points, faces = tube(*how)
    return points * np.stack([0.4 / np.hypot(points[:, 0], points[:, 1])] * 2 + [np.ones(len(points))], 1), faces
