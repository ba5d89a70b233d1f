# SPDX-License-Identifier: GPL-3.0-or-later
"""How well FCD: Fit to Layer finds a surface whose truth is known: each mesh is bent, twisted and waved by a map that is none of any
graph, and given new triangles; some get noise, holes, or lose their faces. Prints how far the vertices of the fitted mesh are from
where they truly belong, in percent of the diagonal.

    build/venv/bin/python tests/fit_pairs.py MESH...
"""
import sys
import time
from pathlib import Path

import numpy as np
import pymeshlab

PLUGIN = Path(__file__).resolve().parents[1] / "build/plugins/pymeshlab-2025.7/libfilter_fcd.so"


def bent(points, seed):
    """Along its longest axis: bent by up to 40 degrees, twisted by up to 25, and waved."""
    random = np.random.default_rng(seed)
    middle, size = points.mean(0), np.linalg.norm(np.ptp(points, 0))
    axes = np.linalg.svd((points - middle)[:: max(1, len(points) // 5000)], full_matrices=False)[2]
    x, y, z = ((points - middle) @ axes.T / size).T
    length = np.ptp(x)
    twist, radius = x * random.uniform(0.2, 0.45) / length, length / random.uniform(0.3, 0.7)
    y, z = np.cos(twist) * y - np.sin(twist) * z, np.sin(twist) * y + np.cos(twist) * z
    x, y = (radius - y) * np.sin(x / radius), radius - (radius - y) * np.cos(x / radius)
    out = np.column_stack([x, y, z])
    waves, phase, amount = random.normal(size=(6, 3)) * 4, random.uniform(0, 6.28, 6), random.normal(size=(6, 3)) * 0.005
    return (out + np.sin(out @ waves.T + phase) @ amount) @ axes * size + middle


def without(points, faces, gone):
    keep = ~gone
    return points[keep], (np.cumsum(keep) - 1)[faces[keep[faces].all(1)]]


def variants(points, faces):
    """Of a target: its name, points and faces."""
    random = np.random.default_rng(1)
    size = np.linalg.norm(np.ptp(points, 0))
    yield "clean", points, faces
    yield "noise of 0.15 %", points + random.normal(size=points.shape) * 0.0015 * size / np.sqrt(3), faces
    holes = points[random.choice(len(points), 8)]
    near = np.min([np.linalg.norm(points - hole, axis=1) for hole in holes], axis=0)
    yield "8 holes", *without(points, faces, near < 0.04 * size)
    yield "cloud", points, np.zeros((0, 3), int)


def main(files):
    pymeshlab.load_plugin(str(PLUGIN))
    print(f"{'mesh':24} {'target':16} {'vertices':>8} {'before':>7} {'rms':>6} {'median':>6} {'p99':>6} {'matched':>7} {'s':>5}")
    for seed, file in enumerate(files):
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(file)
        source = meshes.current_mesh()
        points, faces = source.vertex_matrix(), source.face_matrix()
        truth = bent(points, seed)
        size = np.linalg.norm(np.ptp(truth, 0)) / 100
        meshes.add_mesh(pymeshlab.Mesh(truth, faces))
        meshes.apply_filter("meshing_isotropic_explicit_remeshing", targetlen=pymeshlab.PercentageValue(0.9), iterations=6)
        for name, there, corners in variants(meshes.current_mesh().vertex_matrix(), meshes.current_mesh().face_matrix()):
            pair = pymeshlab.MeshSet()
            pair.add_mesh(pymeshlab.Mesh(points, faces))
            pair.add_mesh(pymeshlab.Mesh(there, corners))
            pair.set_current_mesh(0)
            start = time.perf_counter()
            result = pair.apply_filter("generate_fcd_fitted_mesh", target_layer=1, graph_layers=False)
            seconds = time.perf_counter() - start
            off = np.linalg.norm(pair.current_mesh().vertex_matrix() - truth, axis=1) / size
            before = np.sqrt(np.mean(np.sum((points - truth) ** 2, 1))) / size
            print(f"{Path(file).stem:24} {name:16} {len(points):8} {before:7.2f} {np.sqrt(np.mean(off ** 2)):6.3f} {np.median(off):6.3f} "
                  f"{np.quantile(off, 0.99):6.2f} {result['matched']:7.2f} {seconds:5.2f}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
