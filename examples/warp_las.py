# SPDX-License-Identifier: GPL-3.0-or-later
"""Applies a saved deformation to LAS or LAZ tiles, in chunks: memory does not grow with the tiles.

    python warp_las.py bend.ply OUT-FOLDER [--vectors] TILE.laz...

Needs laspy (with lazrs for LAZ) and pymeshlab_fcd. All that the points carry is kept, and so are the records before and after them
(VLRs and EVLRs, with the coordinate system); normals in extra dimensions turn with the surface. A file stores coordinates as whole
numbers of its scale, so a point moves to the nearest of these; where they do not reach to where the points go, the file gets another offset,
and, where the points lie too far apart for that, a coarser scale. --vectors adds extra dimensions: how far each point went, as displacement_x, _y
and _z, and the length of that, displacement; where a tile has such already, these stay, and the new ones are displacement_2_x and so on. Each
tile is written aside and then renamed: what stands there is whole at any time; what a killed run left aside is removed. Tiles of one name from
several folders keep their folders. TILE.copc.laz becomes TILE.laz, an ordinary LAZ file: its points move, so its octree would not hold. A tile
that cannot be read or written is told at the end, and the others are done all the same."""
from __future__ import annotations

import contextlib
import copy
import os
import re
import sys
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import laspy
import numpy as np
from laspy.vlrs.vlrlist import VLRList
from numpy.typing import NDArray

import pymeshlab_fcd

CHUNK = 1_000_000  # points
NORMALS = (("NormalX", "NormalY", "NormalZ"), ("normal_x", "normal_y", "normal_z"), ("nx", "ny", "nz"))  # CloudCompare, PDAL, others


def columns(points: Any, names: Iterable[str]) -> NDArray[np.float64]:
    """Three dimensions of points, n x 3."""
    return np.stack([np.asarray(points[name], np.float64) for name in names], axis=1)


def chunks(reader: laspy.LasReader, size: int) -> Iterator[Any]:
    """The points of a file, so many at a time. Raises ValueError where these are not all that it should have, which laspy does not tell."""
    if not np.isfinite([reader.header.offsets, reader.header.scales]).all():
        raise ValueError("it has no numbers as scale and offset of its coordinates")
    done = 0
    for points in reader.chunk_iterator(size):
        done += len(points)
        yield points
    if done != reader.header.point_count:
        raise ValueError(f"it is cut short: it has {done} of its {reader.header.point_count} points")


def vector_names(present: Iterable[str]) -> list[str]:
    """Of the dimensions of how far points went, none of which is there: x, y, z and length."""
    there, number = {name.casefold() for name in present}, 1
    while True:
        own = "displacement" if number == 1 else f"displacement_{number}"
        names = [f"{own}_x", f"{own}_y", f"{own}_z", own]
        if there.isdisjoint(names):
            return names
        number += 1


def targets(tiles: Iterable[str | Path], folder: str | Path) -> dict[Path, Path]:
    """Where each tile goes: to its own name, or, where two tiles have one name, to their folders below the one that all are in.

    Raises ValueError where a tile would be written over one that is read."""
    sources = list(dict.fromkeys(Path(tile).resolve() for tile in tiles))
    names = {tile: re.sub(r"\.copc\.laz$", ".laz", tile.name, flags=re.IGNORECASE) for tile in sources}
    above = [tile.parent for tile in sources]
    if len({name.casefold() for name in names.values()}) < len(sources):
        above = [Path(os.path.commonpath(above))] * len(sources)
    goals = {tile: Path(folder).resolve() / tile.parent.relative_to(top) / names[tile] for tile, top in zip(sources, above)}
    if len({str(goal).casefold() for goal in goals.values()}) < len(sources):
        raise ValueError("two of the tiles would be written to one file. Rename one of them")
    for tile, goal in goals.items():
        if goal in goals or (goal.exists() and any(goal.samefile(each) for each in sources if each.exists())):
            raise ValueError(f"{tile} would be written over {goal}, which is to be read. Give another folder")
    return goals


def tidy(target: Path) -> None:
    """Removes what runs that were killed left aside of a file."""
    for left in target.parent.glob("*.part"):
        run = re.fullmatch(re.escape(target.name) + r"\.(\d+)\.part", left.name)
        if run is None or os.name != "posix":
            continue
        try:
            os.kill(int(run[1]), 0)  # whether it still runs
        except ProcessLookupError:
            left.unlink(missing_ok=True)
        except (OSError, OverflowError):  # of another user
            pass


def widen(header: laspy.LasHeader, low: NDArray[np.float64], high: NDArray[np.float64]) -> None:
    """Gives the header of a file that has points from low to high another offset, and a scale that is coarser by a power of ten where needed."""
    whole = np.array(header.offsets), np.array(header.scales)  # as they are where they do
    usable = np.isfinite(whole[1]) & (whole[1] > 0)
    whole[1][~usable] = whole[1][usable].min() if usable.any() else 0.001  # a flat tile may have none of its height, which it needs now
    for d in range(3):
        if max(abs(low[d] - whole[0][d]), abs(high[d] - whole[0][d])) / whole[1][d] < 2 ** 31 - 1:
            continue
        while (high[d] - low[d]) / whole[1][d] >= 2 ** 32 - 4:
            whole[1][d] *= 10
        whole[0][d] = np.round((low[d] + high[d]) / 2 / whole[1][d]) * whole[1][d]
    header.offsets, header.scales = whole


def warp(bend: pymeshlab_fcd.Deformation, source: str | Path, target: str | Path, chunk: int = CHUNK, threads: int = 0,
         vectors: bool = False) -> int:
    """Deforms one tile, by so many threads (0: one a core). Returns how many points it has."""
    try:
        return warp_within(bend, source, target, chunk, threads, vectors)
    except OverflowError:  # the points go farther than the whole numbers reach: seen first how far
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        with laspy.open(source) as reader:
            for points in chunks(reader, chunk):
                xyz = bend(columns(points, "xyz"), threads=threads)
                low, high = np.minimum(low, xyz.min(0)), np.maximum(high, xyz.max(0))
        return warp_within(bend, source, target, chunk, threads, vectors, (low, high))


def warp_within(bend: pymeshlab_fcd.Deformation, source: str | Path, target: str | Path, chunk: int, threads: int, vectors: bool,
                reach: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None) -> int:
    """The same with the file's own whole numbers, or with those that reach from one corner to the other."""
    source, target = Path(source), Path(target)
    if target.exists() and source.exists() and target.samefile(source):
        raise ValueError(f"{source} would be written over itself. Give another file")
    target.parent.mkdir(parents=True, exist_ok=True)
    tidy(target)
    aside = target.with_name(f"{target.name}.{os.getpid()}.part")
    try:
        with laspy.open(source) as reader:
            names = [each for each in NORMALS if set(each) <= set(reader.header.point_format.dimension_names)]
            header = reader.header
            is_copc = any(each.user_id == "copc" for each in header.vlrs)  # which tells where its octree is in the file
            if is_copc or vectors or reach is not None:
                header = copy.deepcopy(header)
                header.vlrs = [each for each in header.vlrs if each.user_id != "copc"]
            if reach is not None:
                widen(header, *reach)
            own = vector_names(header.point_format.dimension_names) if vectors else []
            if vectors:
                if reach is None and own != vector_names(()):
                    warnings.warn(f"{source} has {', '.join(vector_names(()))} already, or one of these, which stay: how far its points went is in "
                                  f"{', '.join(own)}", stacklevel=3)
                header.add_extra_dims([laspy.ExtraBytesParams(name, "f4") for name in own])
            with laspy.open(aside, mode="w", header=header, do_compress=target.suffix.lower() == ".laz") as writer:
                for points in chunks(reader, chunk):
                    xyz = before = columns(points, "xyz")
                    if header is not reader.header:
                        points, given = laspy.ScaleAwarePointRecord.zeros(len(points), header=header), points
                        points.copy_fields_from(given)
                    if names:
                        xyz, turned = bend(xyz, columns(points, names[0]), threads=threads)
                        for name, values in zip(names[0], turned.T):
                            points[name] = values
                    else:
                        xyz = bend(xyz, threads=threads)
                    points.x, points.y, points.z = xyz.T
                    if vectors:
                        way = xyz - before
                        for name, values in zip(own, (*way.T, np.linalg.norm(way, axis=1))):
                            points[name] = values
                    writer.write_points(points)
                if others := [each for each in reader.evlrs or [] if each.user_id != "copc"]:
                    writer.write_evlrs(VLRList(others))
            count = int(reader.header.point_count)
        with open(aside, "rb+") as file:
            os.fsync(file.fileno())
        os.replace(aside, target)
    except BaseException:
        with contextlib.suppress(OSError):
            aside.unlink()
        raise
    return count


def main(deformation: str, folder: str, *tiles: str) -> int:
    vectors = "--vectors" in tiles
    tiles = tuple(tile for tile in tiles if tile != "--vectors")
    bend = pymeshlab_fcd.Deformation.load(deformation)
    failed, goals = [], targets(tiles, folder)
    for source, target in goals.items():
        try:
            print(source, warp(bend, source, target, vectors=vectors), "points", flush=True)
        except Exception as error:  # whatever laspy finds in it
            failed.append(f"{source}: {error or type(error).__name__}")
    if failed:
        print(f"{len(failed)} of {len(goals)} tiles could not be deformed:", *failed, sep="\n", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    try:
        sys.exit(main(*sys.argv[1:]))
    except (OSError, ValueError) as error:
        sys.exit(f"{error}".rstrip(".") + ".")
    except KeyboardInterrupt:
        sys.exit(130)
