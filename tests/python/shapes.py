# SPDX-License-Identifier: GPL-3.0-or-later
"""Small surfaces for the tests of the Python package."""
import numpy as np
import pytest

import pymeshlab_fcd


def bar(n=101, m=15):
    """A bumpy bar along x, its tags, and a matrix that lifts the end."""
    x, y = np.meshgrid(np.linspace(0, 10, n), np.linspace(0, 1, m), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), 0.1 * np.sin(5 * x.ravel())], 1)
    i = np.arange(n * m).reshape(n, m)[:-1, :-1].ravel()
    faces = np.concatenate([np.stack([i, i + m, i + 1], 1), np.stack([i + 1, i + m, i + m + 1], 1)])
    tags = np.where(vertices[:, 0] < 1, 0, np.where(vertices[:, 0] > 9, 2, 1))
    return vertices, faces, tags, np.array([[0, 0, -1, 7], [0, 1, 0, 0], [1, 0, 0, -4], [0, 0, 0, 1.0]])


def with_filters():
    """pymeshlab, where it has the filters."""
    pymeshlab = pytest.importorskip("pymeshlab")
    try:
        pymeshlab_fcd.enable_pymeshlab()
    except RuntimeError as error:
        pytest.skip(str(error))
    return pymeshlab


def same(a, b):
    return a.shape == b.shape and a.tobytes() == b.tobytes()
