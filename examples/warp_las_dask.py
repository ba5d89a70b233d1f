# SPDX-License-Identifier: GPL-3.0-or-later
"""Applies a saved deformation to LAS or LAZ tiles on a Dask cluster, a tile a task.

    python warp_las_dask.py bend.ply OUT-FOLDER TILE.laz... [--scheduler ADDRESS]

Without an address, a cluster with a process a core is started here. The workers need laspy and pymeshlab_fcd, and see the same
folders. What becomes of a tile is told in warp_las.py."""
from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import dask.distributed

import pymeshlab_fcd
from warp_las import CHUNK, targets, warp

distributed: Any = dask.distributed  # it has no types


def warp_all(client: Any, bend: pymeshlab_fcd.Deformation, tiles: Iterable[str | Path], folder: str | Path,
             chunk: int = CHUNK) -> Iterator[tuple[Path, int | Exception]]:
    """Deforms tiles. Yields each, as they are done, and how many points it has, or why it could not be deformed."""
    client.upload_file(str(Path(__file__).with_name("warp_las.py")))  # workers may not have it
    shared = client.scatter(bend, broadcast=True)  # once to each worker, not with each task
    tasks = {client.submit(warp, shared, str(source), str(target), chunk, threads=1, pure=False): source
             for source, target in targets(tiles, folder).items()}
    for task in distributed.as_completed(tasks):
        try:
            yield tasks[task], task.result()
        except Exception as error:  # whatever laspy finds in it
            yield tasks[task], error


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("deformation")
    parser.add_argument("folder", type=Path)
    parser.add_argument("tiles", nargs="+")
    parser.add_argument("--scheduler")
    arguments = parser.parse_args()
    cluster = arguments.scheduler or distributed.LocalCluster(threads_per_worker=1)
    failed, count = [], 0
    with distributed.Client(cluster) as client:
        bend = pymeshlab_fcd.Deformation.load(arguments.deformation)
        for count, (tile, done) in enumerate(warp_all(client, bend, arguments.tiles, arguments.folder), 1):
            if isinstance(done, Exception):
                failed.append(f"{tile}: {done or type(done).__name__}")
            else:
                print(tile, done, "points", flush=True)
    if failed:
        print(f"{len(failed)} of {count} tiles could not be deformed:", *failed, sep="\n", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
