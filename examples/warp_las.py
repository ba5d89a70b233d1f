# SPDX-License-Identifier: GPL-3.0-or-later
"""Applies a saved deformation to LAS or LAZ tiles, in chunks: memory does not grow with the tiles.

    python warp_las.py bend.ply OUT-FOLDER TILE.laz...

Needs laspy (with lazrs for LAZ) and pymeshlab_fcd, no pymeshlab. All that the points carry is kept. A file stores coordinates as
whole numbers of its scale, so a point moves to the nearest of these."""
import sys
from pathlib import Path

import laspy
import numpy as np

import pymeshlab_fcd

CHUNK = 1_000_000  # points


def warp(bend, source, target, chunk=CHUNK):
    """Deforms one tile. Returns how many points it has."""
    with laspy.open(source) as reader, laspy.open(target, mode="w", header=reader.header) as writer:
        for points in reader.chunk_iterator(chunk):
            moved = bend(np.stack([points.x, points.y, points.z], axis=1))
            points.x, points.y, points.z = moved.T
            writer.write_points(points)
        return reader.header.point_count


def main(deformation, folder, *tiles):
    bend = pymeshlab_fcd.Deformation.load(deformation)
    Path(folder).mkdir(parents=True, exist_ok=True)
    for tile in tiles:
        print(tile, warp(bend, tile, Path(folder) / Path(tile).name), "points")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
