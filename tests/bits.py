# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints a checksum of each thing that the package computes for a bar and for a cloud: the same on any system and processor.

    python tests/bits.py      where pymeshlab_fcd is installed; tests/python_systems.sh compares them"""
import hashlib
import platform
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np

import pymeshlab_fcd
from pymeshlab_fcd import Deformer, Motion, PoseSequence, fit, straighten


def told(name, *arrays):
    sums = hashlib.sha256()
    for array in arrays:
        sums.update(np.ascontiguousarray(array).tobytes())
    print(f"{name}: {sums.hexdigest()[:16]}")


def main():
    warnings.simplefilter("ignore", pymeshlab_fcd.DeformationWarning)
    print(platform.machine(), platform.system(), file=sys.stderr)
    a, b = np.meshgrid(np.arange(161) / 16, np.arange(33) / 16, indexing="ij")
    a, b = a.ravel(), b.ravel()
    points = np.stack([a, b, (a * (10 - a)) * b / 64], 1)  # products and sums alone: the same input anywhere
    i = np.arange(161 * 33).reshape(161, 33)[:-1, :-1].ravel()
    faces = np.concatenate([np.stack([i, i + 33, i + 1], 1), np.stack([i + 1, i + 33, i + 34], 1)])
    tags = np.where(a < 1, 0, np.where(a > 9, 2, 1))
    turn = Motion.rotate([0, 1, 0], -200).then(Motion.translate([-3, 0, 4]))
    anywhere = (np.arange(3 * 20000) * 2654435761 % 2**32 / 2**32).reshape(-1, 3) * [12, 4, 6] - [1, 1, 2]
    for kind, corners in (("mesh", faces), ("cloud", None)):
        deformer = Deformer(points, corners, tags)
        told(f"{kind}, graph", deformer.graph.nodes, deformer.graph.edges, deformer.graph.radius, deformer.patch_of)
        weights = deformer.weights()
        told(f"{kind}, weights", weights.indptr, weights.indices, weights.data)
        pose = deformer.pose({2: turn})
        told(f"{kind}, pose", pose.vertices)
        told(f"{kind}, half the way", deformer.pose({2: turn}, percent=50).vertices)
        told(f"{kind}, nodes", pose.nodes, pose.node_maps)
        told(f"{kind}, map", *pose.map(anywhere[:2000], anywhere[:2000]))
        if corners is not None:
            told(f"{kind}, normals, stretch", pose.normals, pose.stretch())
            poses = PoseSequence({"turned": {2: turn}, "large": {2: Motion.scale(1.5)}})
            told(f"{kind}, blended", poses.blend(deformer, {"turned": 40, "large": 30}).vertices)
            with tempfile.TemporaryDirectory() as folder:
                files = [Path(folder) / name for name in ("frames.glb", "frames.pc2", "poses.glb")]
                poses.write(deformer, gltf=files[0], pc2=files[1], rate=2)
                poses.write(deformer, gltf=files[2], rate=2, shapes="poses")
                for file in files:
                    told(f"{kind}, {file.name}", np.frombuffer(file.read_bytes(), np.uint8))
            fitted = fit(points, corners, pose.vertices, corners, start="axes")
            told(f"{kind}, fitted", fitted.vertices, fitted.normals)
            told(f"{kind}, way back", *fitted.deformation(inverse=True)(anywhere[:2000], anywhere[:2000]))
        told(f"{kind}, fitted to points", fit(points, corners, pose.vertices[::2], landmarks=(pose.vertices[:99:33], points[:99:33])).vertices)
        line = points[16 :: 33 * 8]
        told(f"{kind}, straightened", straighten(points, corners, line, degrees=30).vertices)
        told(f"{kind}, bent to a line", straighten(points, corners, line, pose.vertices[16 :: 33 * 8], untwist=True, smoothing=0.05).vertices)
        bend = pose.deformation()
        told(f"{kind}, saved", np.frombuffer(bend.__reduce__()[1][0], np.uint8))
        told(f"{kind}, carried", *bend(anywhere, anywhere))


if __name__ == "__main__":
    main()
