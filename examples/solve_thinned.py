# SPDX-License-Identifier: GPL-3.0-or-later
"""Solves a deformation on a thinned scan: landmarks of a survey, and where they belong, to a file for warp_las.py.

    python solve_thinned.py LANDMARKS.csv bend.ply SPACING TILE.laz...

A line of the landmarks is x, y, z and where that is to go, x, y, z; what stays is a landmark that goes where it is. Of the tiles,
read in chunks, a point is kept in each cube with sides of SPACING, a fraction of the distance between landmarks: some ten thousand
points are plenty. Needs laspy and pymeshlab_fcd."""
import sys

import laspy
import numpy as np

import pymeshlab_fcd


def thinned(tiles, spacing, chunk=1_000_000):
    """The first point in each cube, n x 3."""
    cells, kept = np.zeros((0, 3), np.int64), np.zeros((0, 3))
    for tile in tiles:
        with laspy.open(tile) as reader:
            for points in reader.chunk_iterator(chunk):
                xyz = np.stack([points.x, points.y, points.z], axis=1)
                cells = np.concatenate([cells, np.floor(xyz / spacing).astype(np.int64)])
                kept = np.concatenate([kept, xyz])
                cells, first = np.unique(cells, axis=0, return_index=True)
                kept = kept[first]
    return kept


def main(landmarks, target, spacing, *tiles):
    points = thinned(tiles, float(spacing))
    table = np.loadtxt(landmarks, delimiter=",", ndmin=2)
    bend = pymeshlab_fcd.deformation(points, points=table[:, :3], landmarks=table[:, 3:])
    bend.save(target)
    print(len(points), "points kept,", bend)


if __name__ == "__main__":
    if len(sys.argv) < 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
