# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the vertices of some surfaces go, for the same code with optimisation and without:

    python3 build_types.py write FILE     as this package is built
    python3 build_types.py compare FILE   fails where this package sends one elsewhere than the one that wrote it"""
import sys

import numpy as np

import pymeshlab_fcd


def tube(rows, columns):
    """A bumpy tube along z, from 0 to 6: vertices and faces."""
    z, turn = np.meshgrid(np.linspace(0, 6, rows), np.arange(columns) * 2 * np.pi / columns, indexing="ij")
    points = np.stack([np.cos(turn).ravel(), np.sin(turn).ravel(), z.ravel()], 1)
    points += np.random.default_rng(1).uniform(-0.02, 0.02, points.shape)
    row, column = (grid.ravel() for grid in np.meshgrid(np.arange(rows - 1), np.arange(columns), indexing="ij"))
    a, b = row * columns + column, row * columns + (column + 1) % columns
    return points, np.concatenate([np.stack([a, b, a + columns], 1), np.stack([b, b + columns, a + columns], 1)])


def deformed():
    points, faces = tube(60, 24)
    chip, chip_faces = tube(6, 8)
    corners = np.arange(3 * len(faces)).reshape(-1, 3)  # each triangle with vertices of its own
    loose = np.concatenate([points[faces].reshape(-1, 3), 0.2 * chip + [4, 0, 3]]), np.concatenate([corners, chip_faces + corners.size])
    angle = np.eye(3) * np.cos(1) + np.sin(1) * np.array([[0, -0.2, 0.3], [0.2, 0, -1], [-0.3, 1, 0]])
    motion = np.eye(4)
    motion[:3, :3] = np.linalg.qr(angle)[0] * np.sign(np.diag(np.linalg.qr(angle)[1]))  # a turn by about one radian
    motion[:3, 3] = 1.5, 0.5, -0.5
    for vertices, triangles in ((points, faces), (points, None), loose):
        tags = np.where(vertices[:, 2] < 1, 0, np.where(vertices[:, 2] > 5, 2, 1))
        for distances in ("surface", "euclidean"):
            yield pymeshlab_fcd.deform(vertices, triangles, tags, {2: motion}, patches=40, distances=distances)


what, path = sys.argv[1:]
now = np.concatenate(list(deformed()))
if what == "write":
    np.save(path, now)
else:
    before = np.load(path)
    assert now.shape == before.shape and np.isfinite(now).all() and np.abs(now).max() > 5
    far = np.abs(now - before).max()
    print(f"off by {far:.1e} at most from the build with optimisation")
    assert far < 1e-9
