# SPDX-License-Identifier: GPL-3.0-or-later
"""Solves a deformation on a thinned scan: landmarks of a survey, and where they belong, to a file for warp_las.py.

    python solve_thinned.py LANDMARKS.csv bend.ply SPACING [--accuracy NUMBER] TILE.laz...

Each line of LANDMARKS.csv is a landmark: x, y, z, and where it belongs, x, y, z. A landmark that stays has the same place twice. Tiles are
LAS, LAZ or PLY files. The program keeps one point in each cube with sides of SPACING. Take a fraction of the distance between landmarks:
some ten thousand points are plenty. Each landmark moves the kept point that is nearest to it. --accuracy is how far bend.ply may be off at
a kept point. The program reads LAS and LAZ in chunks, and a PLY file at once. Needs laspy and pymeshlab_fcd."""
from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path

import laspy
import numpy as np
from numpy.typing import NDArray

import pymeshlab_fcd
from pymeshlab_fcd._ply import Ply
from warp_las import chunks, columns


def points_of(tile: str, chunk: int) -> Iterator[NDArray[np.float64]]:
    """The points of a tile, so many at a time; those of a PLY file at once, without those that have no place."""
    if tile.lower().endswith(".ply"):
        points = Ply(tile).vertices
        yield points[np.isfinite(points).all(1)]
        return
    try:
        with laspy.open(tile) as reader:
            for each in chunks(reader, chunk):
                yield columns(each, "xyz")
    except Exception as error:  # whatever laspy finds in it
        raise ValueError(f"{tile}: {error or type(error).__name__}") from error


def thinned(tiles: Iterable[str], spacing: float, chunk: int = 1_000_000) -> NDArray[np.float64]:
    """The first point in each cube, n x 3."""
    if not 0 < spacing < np.inf:
        raise ValueError(f"the spacing must be a positive number; it is {spacing}")
    cells, kept = np.zeros((0, 3), np.int64), np.zeros((0, 3))
    for tile in tiles:
        for points in points_of(tile, chunk):
            cells = np.concatenate([cells, np.floor(points / spacing).astype(np.int64)])
            kept = np.concatenate([kept, points])
            cells, first = np.unique(cells, axis=0, return_index=True)
            kept = kept[first]
    return kept


def read(landmarks: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where landmarks are and where they belong. Between numbers is a comma, a semicolon or white space, a first line may name the
    columns, and what follows a # is a remark."""
    lines = [re.split(r"[,;\s]+", line.partition("#")[0].strip(" \t\r,;")) for line in Path(landmarks).read_text().splitlines()]
    filled = [line for line in lines if line != [""]]
    if filled and re.match("[A-Za-z_]", filled[0][0]):
        del filled[0]
    for number, line in enumerate(filled, 1):
        if len(line) != 6:
            raise ValueError(f"landmark {number} of {landmarks} has {len(line)} numbers; give 6: x, y, z and where that belongs, x, y, z")
        for word in line:
            number_of(word, f"a number in landmark {number} of {landmarks}")
    table = np.array(filled, np.float64).reshape(-1, 6)
    return table[:, :3], table[:, 3:]


def number_of(word: str, what: str) -> float:
    """A word of the user as a number. what: is expected, for messages"""
    try:
        return float(word)
    except ValueError:
        raise ValueError(f"{what} is expected; there is {word!r}") from None


def tell_doubts(starts: NDArray[np.float64], points: NDArray[np.float64], spacing: float) -> None:
    """Warns of landmarks beside the survey, and if too few points are kept to bend between the landmarks: fewer than three lines of three
    for each. A point of the survey has a kept one within the diagonal of its cube. Raises ValueError if no point is left to bend."""
    if len(points) <= len(starts):
        raise ValueError(f"only {len(points)} points are kept for {len(starts)} landmarks, so none can bend: take a smaller spacing")
    if len(points) < 9 * len(starts):
        print(f"only {len(points)} points are kept for {len(starts)} landmarks, and little bends between them: take a smaller spacing",
              file=sys.stderr)
    for number, start in enumerate(starts, 1):
        off = np.sqrt(((points - start) ** 2).sum(1).min())
        if off > np.sqrt(3) * spacing:
            print(f"landmark {number} is {off:.6g} from the nearest kept point, which moves in its place: check its coordinates",
                  file=sys.stderr)


def main(landmarks: str, target: str, spacing: str, *rest: str) -> None:
    side, tiles, accuracy = number_of(spacing, "the spacing, a number before the tiles,"), list(rest), 0.0
    if "--accuracy" in tiles:
        at = tiles.index("--accuracy")
        accuracy = number_of("".join(tiles[at + 1:at + 2]), "a number after --accuracy")
        del tiles[at:at + 2]
    starts, ends = read(landmarks)
    points = thinned(tiles, side)
    if len(points):
        tell_doubts(starts, points, side)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"Landmark \d+, counted from 0", pymeshlab_fcd.LandmarkWarning)  # told, by the number of its line
        bend = pymeshlab_fcd.deformation(points, points=starts, landmarks=ends, accuracy=accuracy)
    bend.save(target)
    print(f"{len(points)} points kept; {target} is off by {bend.largest_difference:.3g} at most at these")


if __name__ == "__main__":
    if len(sys.argv) < 5:
        sys.exit(__doc__)
    try:
        main(*sys.argv[1:])
    except (OSError, ValueError) as error:
        sys.exit(f"{error}".rstrip(".") + ".")
    except KeyboardInterrupt:
        sys.exit(130)
