# SPDX-License-Identifier: GPL-3.0-or-later
"""Applies a saved deformation to LAS or LAZ tiles on a Dask cluster, a tile a task.

    python warp_las_dask.py bend.ply OUT-FOLDER TILE.laz... [--scheduler ADDRESS]

Without an address, a cluster with a process a core is started here. The workers need laspy and pymeshlab_fcd, and see the same
folders."""
import argparse
from pathlib import Path

from dask.distributed import Client, LocalCluster, as_completed

import pymeshlab_fcd
from warp_las import CHUNK, warp


def warp_all(client, bend, tiles, folder, chunk=CHUNK):
    """Deforms tiles. Yields the name of each and how many points it has, as they are done."""
    client.upload_file(str(Path(__file__).with_name("warp_las.py")))  # workers may not have it
    shared = client.scatter(bend, broadcast=True)  # once to each worker, not with each task
    tasks = {client.submit(warp, shared, str(tile), str(Path(folder) / Path(tile).name), chunk, pure=False): tile for tile in tiles}
    for task in as_completed(tasks):
        yield tasks[task], task.result()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("deformation")
    parser.add_argument("folder", type=Path)
    parser.add_argument("tiles", nargs="+")
    parser.add_argument("--scheduler")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    cluster = arguments.scheduler or LocalCluster(threads_per_worker=1)
    with Client(cluster) as client:
        for tile, points in warp_all(client, pymeshlab_fcd.Deformation.load(arguments.deformation), arguments.tiles, arguments.folder):
            print(tile, points, "points")


if __name__ == "__main__":
    main()
