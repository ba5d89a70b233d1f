# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the files that the jobs of the manual begin with, into this folder. All are made by formulas.

    python job_data.py skull|plate|scans|finger|tiles

skull: skull.ply, which was sheared and bent, brain.ply inside it, and pairs/skull.csv, 14 landmarks on both sides.
plate: plate.ply, a drilled plate of 120 x 60 x 4 mm, and printed.ply, the scan of a print of it, warped and noisy.
scans: template.ply, three scans of other heads in scans/, and marks/, 8 landmarks for each.
finger: finger.ply, whose quality says what is fixed (0), free (1) and moved (2).
tiles: tiles/, a survey in two LAZ files, and landmarks.csv: its middle sinks (needs laspy)."""
from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Faces = NDArray[np.int64]
MIRROR = np.array([-1, 1, 1.0])
SIZE, THICK, HOLE, TILES = np.array([120.0, 60.0]), 4.0, 5.0, (4, 2)  # of the plate, mm; a hole in each of 4 x 2 parts


def save(path: str, vertices: Points, faces: Faces, quality: NDArray[np.float64] | None = None) -> None:
    """Writes a binary PLY file."""
    rows = vertices if quality is None else np.column_stack([vertices, quality])
    names = ["x", "y", "z", "quality"][:rows.shape[1]]
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(rows)}", *(f"property double {name}" for name in names),
            f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
    corners = np.empty(len(faces), [("count", "u1"), ("corner", "<i4", 3)])
    corners["count"], corners["corner"] = 3, faces
    Path(path).parent.mkdir(exist_ok=True)
    Path(path).write_bytes("\n".join(head).encode() + rows.astype("<f8").tobytes() + corners.tobytes())


def table(path: str, *columns: Points) -> None:
    Path(path).parent.mkdir(exist_ok=True)
    np.savetxt(path, np.concatenate(columns, axis=1), "%.10g", ", ")


def turned(points: Points, seed: int = 7) -> Points:
    """By a rotation made of random numbers."""
    turn: Points = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    turn[:, 0] *= np.sign(np.linalg.det(turn))
    return points @ turn


def rings(count: int, around: int) -> Faces:
    """Triangles between rings of so many points each."""
    here = np.arange(around)
    beside = np.roll(here, -1)
    between = np.concatenate([np.stack([here, here + around, beside], 1), np.stack([beside, here + around, beside + around], 1)])
    return np.concatenate([between + k * around for k in range(count - 1)])


def ball(count: int = 90, around: int = 120) -> tuple[Points, Faces]:
    """A sphere whose triangles are not symmetric."""
    z, a = np.meshgrid(np.cos(np.pi * (np.arange(count) + 0.5) / count), 2 * np.pi * (np.arange(around) + 0.3) / around, indexing="ij")
    r = np.sqrt(1 - z**2)
    return turned(np.stack([r * np.cos(a), r * np.sin(a), z], 2).reshape(-1, 3), 2), rings(count, around)


def skull(at: Points, seed: int) -> Points:
    """Symmetric about x = 0, with features on both sides and in the middle. at: on a sphere"""
    random, height = np.random.default_rng(seed), np.ones(len(at))
    for k in range(14):
        middle = random.normal(size=3) * [k % 4 > 0, 1, 1]
        middle /= np.linalg.norm(middle)
        width, bump = random.uniform(0.12, 0.45), random.uniform(-0.18, 0.22)
        for side in [1, -1][: 1 + (middle[0] != 0)]:
            height += bump * np.exp(-((at - middle * [side, 1, 1]) ** 2).sum(1) / width**2 / 2)
    return at * height[:, None] * [0.75, 1.0, 0.85]


def bent(points: Points, shear: float = 0.08, bend: float = 0.06) -> Points:
    """Sheared, and bent to one side."""
    p = points.copy()
    p[:, 0] += shear * (0.8 * p[:, 1] - 0.6 * p[:, 2])
    angle = bend * p[:, 1]
    return np.stack([(p[:, 0] + 1 / bend) * np.cos(angle) - 1 / bend, (p[:, 0] + 1 / bend) * np.sin(angle), p[:, 2]], 1)


def buried(points: Points, shear: float = 0.08, bend: float = 0.06) -> Points:
    """Sheared, bent to one side, and anywhere."""
    return turned(bent(points, shear, bend)) + [3, -1, 2]


def sides(seed: int, count: int = 14) -> Points:
    """Random places on one half of a sphere."""
    side = np.random.default_rng(seed).normal(size=(count, 3))
    side[:, 0] = np.abs(side[:, 0])
    side /= np.linalg.norm(side, axis=1)[:, None]
    return side


def make_skull() -> None:
    (at, faces), side = ball(), sides(4)
    save("skull.ply", 50 * buried(skull(at, 3)), faces)
    save("brain.ply", 50 * buried(0.8 * skull(at, 3)), faces)
    table("pairs/skull.csv", 50 * buried(skull(side, 3)), 50 * buried(skull(side * MIRROR, 3)))


def plate(around: int = 64, count: int = 10) -> tuple[Points, Faces, NDArray[np.int64]]:
    """Drilled; unwelded, as STL files are: vertices, faces, and for each vertex the number of the hole on whose wall it is, from 1, or 0."""
    half = SIZE / TILES / 2
    a = 2 * np.pi * np.arange(around) / around
    circle = np.stack([np.cos(a), np.sin(a)], 1)
    square = circle / np.abs(circle / half).max(axis=1, keepdims=True)
    share = np.linspace(0, 1, count)[:, None, None]
    flat = (1 - share) * HOLE * circle + share * square
    here = np.arange(around)
    beside = np.roll(here, -1)
    tile = rings(count, around)
    corners: list[Points] = []
    of_hole: list[NDArray[np.int64]] = []
    for i in range(TILES[0]):
        for j in range(TILES[1]):
            at = flat.reshape(-1, 2) + half * [2 * i + 1, 2 * j + 1]
            top, low = (np.concatenate([at, np.full((len(at), 1), z)], 1) for z in (THICK, 0))
            corners += [top[tile], low[tile[:, ::-1]]]
            of_hole += [np.zeros(len(tile), np.int64)] * 2
            ring_top, ring_low = top[:around], low[:around]
            corners += [np.stack([ring_top[here], ring_top[beside], ring_low[here]], 1), np.stack([ring_top[beside], ring_low[beside], ring_low[here]], 1)]
            of_hole += [np.full(around, 1 + i * TILES[1] + j)] * 2
    for axis, number in ((0, 60), (1, 120)):
        for side in (0, 1):
            t = np.linspace(0, SIZE[1 - axis], number)
            wall = np.stack([np.full(number, SIZE[axis] * side), t], 1)
            wall = wall if axis == 0 else wall[:, ::-1]
            up, down = (np.concatenate([wall, np.full((number, 1), z)], 1) for z in (THICK, 0))
            two = [np.stack([up[:-1], down[:-1], down[1:]], 1), np.stack([up[:-1], down[1:], up[1:]], 1)]
            outward = (side == 1) == (axis == 1)
            corners += [each[:, ::-1] if outward else each for each in two]
            of_hole += [np.zeros(number - 1, np.int64)] * 2
    soup, holes = np.concatenate(corners).reshape(-1, 3), np.repeat(np.concatenate(of_hole), 3)
    return soup, np.arange(len(soup)).reshape(-1, 3), holes


def warped(p: Points) -> Points:
    """It lifts at the corners, twists, and shrinks: by 0.43 mm at most, laid onto the plate."""
    x, y = (p[:, 0] / SIZE[0] - 0.5) * 2, (p[:, 1] / SIZE[1] - 0.5) * 2
    lift = 0.28 * x**2 + 0.1 * y**2 + 0.1 * x * y + 0.06 * np.sin(3 * x)
    return np.stack([p[:, 0] * 0.998 - 0.3 * lift * x * (p[:, 2] - 2) / 10, p[:, 1] * 0.999 + 0.05 * x**2 * y, p[:, 2] + lift], 1)


def scan(noise: float = 0.03, kept: Callable[[Points], NDArray[np.bool_]] | None = None) -> tuple[Points, Faces]:
    """Of the print, with vertices elsewhere. kept: which triangles, by their middles on the plate"""
    points, faces, _ = plate(97, 17)
    measured, same = np.unique(points.round(9), axis=0, return_inverse=True)
    faces = same.reshape(-1)[faces]
    if kept is not None:
        faces = faces[kept(measured[faces].mean(1))]
    measured = warped(measured)
    return measured + np.random.default_rng(1).normal(0, noise, measured.shape), faces


def make_plate() -> None:
    save("plate.ply", *plate()[:2])
    save("printed.ply", *scan())


def make_scans() -> None:
    """Heads of other widths and heights, each with the noise of its scan."""
    (at, faces), marks = ball(), np.concatenate([sides(5, 4), sides(5, 4) * MIRROR])
    save("template.ply", 100 * skull(at, 1), faces)
    for k, name in enumerate(["ann", "ben", "cem"]):
        (at, faces), grown = ball(80, 110), np.array([1.05 - 0.05 * k, 1 + 0.06 * k, 0.95])
        save(f"scans/{name}.ply", 100 * turned(skull(at, 1) * grown, k) + np.random.default_rng(k).normal(0, 0.1, at.shape), faces)
        table(f"marks/{name}.csv", 100 * skull(marks, 1), 100 * turned(skull(marks, 1) * grown, k))


def make_finger() -> None:
    s, a = np.meshgrid(np.linspace(0, 80, 200), np.linspace(0, 2 * np.pi, 60, endpoint=False), indexing="ij")
    along = s.ravel()
    save("finger.ply", np.stack([along, 8 * np.cos(a).ravel(), 8 * np.sin(a).ravel()], 1), rings(200, 60), np.where(along < 32, 0, np.where(along > 48, 2, 1)))


def make_tiles() -> None:
    import laspy
    random, west, south = np.random.default_rng(0), 432050, 5411990
    Path("tiles").mkdir(exist_ok=True)

    def height(x: Points, y: Points) -> Points:
        hollow: Points = 1.6 * np.exp(-((x - west - 100) ** 2 + (y - south - 50) ** 2) / 400)
        return 311.1 + 0.02 * (x - west) - hollow

    for begin in (west, west + 100):
        x, y = random.uniform([[begin], [south]], [[begin + 100], [south + 100]], (2, 100_000))
        header = laspy.LasHeader(point_format=3, version="1.2")
        header.scales, header.offsets = np.full(3, 0.001), np.array([begin, south, 300.0])
        tile = laspy.LasData(header)
        tile.x, tile.y, tile.z = x, y, height(x, y)
        tile.write(f"tiles/{begin}.laz")
    x, y = np.array([[10, 10], [190, 10], [10, 90], [190, 90], [100, 50.0]]).T + [[west], [south]]
    start = np.stack([x, y, height(x, y)], 1)
    table("landmarks.csv", start, start - ([[0, 0, 0]] * 4 + [[0, 0, 1.5]]))


MAKE: Mapping[str, Callable[[], None]] = {"skull": make_skull, "plate": make_plate, "scans": make_scans, "finger": make_finger, "tiles": make_tiles}

if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1] not in MAKE:
        sys.exit(__doc__)
    MAKE[sys.argv[1]]()
