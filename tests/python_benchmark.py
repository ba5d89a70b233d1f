# SPDX-License-Identifier: GPL-3.0-or-later
"""How long the Python package takes for a surface, beside the filter: seconds by the clock and of all cores, the least of several runs.

    build/venv-python/bin/python tests/python_benchmark.py [VERTICES]      after tests/python_package.sh"""
import sys
import time
import warnings

import numpy as np
import pymeshlab

import pymeshlab_fcd


def least(name, runs, work):
    clock, cores = [], []
    for run in range(runs):
        begin = time.perf_counter(), time.process_time()
        work(run)
        clock.append(time.perf_counter() - begin[0])
        cores.append(time.process_time() - begin[1])
    print(f"{name}: {min(clock):.3f} s, {min(cores):.3f} s of all cores", flush=True)


def main(vertices="1400000"):
    n = round(float(vertices) ** 0.5)
    x, y = np.meshgrid(np.linspace(0, 10, n), np.linspace(0, 10, n), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), 0.1 * np.sin(5 * x.ravel())], 1)
    i = np.arange(n * n).reshape(n, n)[:-1, :-1].ravel()
    faces = np.concatenate([np.stack([i, i + n, i + 1], 1), np.stack([i + 1, i + n, i + n + 1], 1)]).astype(np.int32)
    tags = np.where(points[:, 0] < 1, 0, np.where(points[:, 0] > 9, 2, 1))
    lift = np.array([[0, 0, -1, 7], [0, 1, 0, 0], [1, 0, 0, -4], [0, 0, 0, 1.0]])
    print(len(points), "vertices")
    out, normals = np.empty_like(points), np.empty_like(points)
    deformer = pymeshlab_fcd.Deformer(points, faces, tags, normals=np.tile([0, 0, 1.0], (len(points), 1)))
    least("a pose, into an array", 10, lambda _: deformer.pose({2: lift}, out=out, check=False))
    least("with normals that turn", 10, lambda _: deformer.pose({2: lift}, out=out, out_normals=normals, check=False))
    least("and checked", 10, lambda _: deformer.pose({2: lift}, out=out, out_normals=normals))
    plain = pymeshlab_fcd.Deformer(points, faces, tags)
    least("with normals of the faces", 10, lambda _: plain.pose({2: lift}, out=out, out_normals=normals, check=False))
    least("Deformer()", 4, lambda _: pymeshlab_fcd.Deformer(points, faces, tags))
    least("deform()", 4, lambda _: pymeshlab_fcd.deform(points, faces, tags, {2: lift}))
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=tags.astype(float)))

    def filtered(run):
        ms.set_current_mesh(0)
        ms.generate_fcd_deformed_mesh(transformmatrix=lift, graph_layers=False, random_seed=2 + run)  # each prepared anew

    least("the filter", 4, filtered)
    bend = deformer.pose({2: lift}).deformation()
    anywhere = np.random.default_rng(0).uniform(points.min(0) - 0.1, points.max(0) + 0.1, (1_000_000, 3))
    least("a saved deformation, a million points in any order, one core", 3, lambda _: bend(anywhere))


if __name__ == "__main__":
    warnings.simplefilter("ignore", pymeshlab_fcd.DeformationWarning)
    main(*sys.argv[1:])
