# SPDX-License-Identifier: GPL-3.0-or-later
"""How many points a second a deformation carries: on one core, and on a local Dask cluster by workers.

    python measure.py bend.ply [MILLIONS-OF-POINTS]

The points lie around the samples of the deformation, neighbours beside each other as in a scan, or anywhere in the box around these."""
from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
import dask.distributed

import pymeshlab_fcd

distributed: Any = dask.distributed  # it has no types


def part(bend: pymeshlab_fcd.Deformation, seed: int, n: int, near: bool = True) -> float:
    """Applies to n points; they are made where they are used. Returns the seconds of this process that took."""
    random = np.random.default_rng(seed)
    samples = bend.samples
    low, size = samples.min(0), np.ptp(samples, axis=0)
    if near:
        samples = samples[np.lexsort(np.floor(samples / size.max() * 30).T)]
        points = np.repeat(samples, -(-n // len(samples)), axis=0)[:n]
        points = points + random.normal(scale=0.002 * size.max(), size=points.shape)
    else:
        points = low + size * random.random((n, 3))
    begin = time.process_time()
    bend(points, threads=1)
    return time.process_time() - begin


def main(deformation: str, millions: str = "2") -> None:
    bend, n = pymeshlab_fcd.Deformation.load(deformation), int(1e6 * float(millions))
    print(bend)
    print("| points | on | million points a second and core |\n|---|---|---|")
    for near, where in ((True, "around the samples"), (False, "anywhere in their box")):
        print(f"| {where} | one core | {n / min(part(bend, 0, n, near) for _ in range(3)) / 1e6:.2f} |")
    for workers in (1, 2):
        with distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster, distributed.Client(cluster) as client:
            shared = client.scatter(bend, broadcast=True)
            client.gather([client.submit(part, shared, 0, 1000, workers=[each], pure=False) for each in client.scheduler_info()["workers"]])  # imports
            seconds = sum(client.gather([client.submit(part, shared, seed, n // 4, pure=False) for seed in range(8)]))
            print(f"| around the samples | Dask, workers: {workers} | {2 * n / seconds / 1e6:.2f} |")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])
