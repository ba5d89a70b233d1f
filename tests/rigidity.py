#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Point handles at their true places on shapes that were sheared, bent and warped by formulas: how far off all vertices are (rms, % of the
diagonal), by the rigidity, and by splines of the same points through space (SciPy). Geometric means over the meshes, as a table for
tests/measured.py.

    build/venv-python/bin/python tests/rigidity.py [MESH...]

Each MESH (.ply of triangles) is one that no constant was chosen on; without any, meshes/ of here. The splines: r, the biharmonic one of space,
which is the thin-plate spline of landmarks there; and r^2 log r, that of a plane."""
import sys
from pathlib import Path

import numpy as np
from scipy.interpolate import RBFInterpolator

from pymeshlab_fcd import Deformer
from pymeshlab_fcd._ply import Ply

ROOT = Path(__file__).resolve().parents[1]
RIGIDITIES = (1, 0.5, 0.1, 0)
COUNTS = (10, 20, 50)


def unit(vertices):
    low, high = vertices.min(0), vertices.max(0)
    return (vertices - (low + high) / 2) / np.linalg.norm(high - low)


def sheared_and_bent(x):
    """As one skull to another."""
    y = x * [1, 1.15, 1]
    y[:, 0] += 0.25 * x[:, 2] + 0.35 * x[:, 2]**2
    y[:, 2] += 0.2 * x[:, 0] * x[:, 1]
    return y


def twisted_and_tapered(x):
    a = int(np.argmax(np.ptp(x, 0)))
    b, c = (a + 1) % 3, (a + 2) % 3
    turn, size, y = 0.9 * x[:, a], 1 + 0.5 * x[:, a], x.copy()
    y[:, b], y[:, c] = size * (np.cos(turn) * x[:, b] - np.sin(turn) * x[:, c]), size * (np.sin(turn) * x[:, b] + np.cos(turn) * x[:, c])
    return y


def warped(seed):
    def warp(x):
        random, y = np.random.default_rng(seed), x.copy()
        for _ in range(6):
            y += 0.025 * np.sin(x @ (2.5 * random.normal(size=3)) + random.uniform(0, 2 * np.pi))[:, None] * random.normal(size=3)
        return y
    return warp


def bent_by_90_degrees(x):
    a = int(np.argmax(np.ptp(x, 0)))
    b, radius = (a + 1) % 3, np.ptp(x[:, a]) / (np.pi / 2)
    turn, y = (x[:, a] - x[:, a].min()) / radius, x.copy()
    y[:, a], y[:, b] = (radius - x[:, b]) * np.sin(turn), radius - (radius - x[:, b]) * np.cos(turn)
    return y


MAPS = {"sheared and bent": sheared_and_bent, "twisted and tapered": twisted_and_tapered, "warped": warped(7), "warped otherwise": warped(8), "bent by 90 degrees": bent_by_90_degrees}


def spread(vertices, count):
    """Numbers of vertices, each as far from those before it as can be."""
    found = [int(np.argmax(np.linalg.norm(vertices - vertices[0], axis=1)))]
    far = np.full(len(vertices), np.inf)
    while len(found) < count:
        far = np.minimum(far, np.linalg.norm(vertices - vertices[found[-1]], axis=1))
        found.append(int(np.argmax(far)))
    return np.array(found)


def main(files):
    rows = {(name, count): [] for name in MAPS for count in COUNTS}
    for file in files:
        ply = Ply(file)
        x = unit(np.asarray(ply.vertices, float))
        for name, count in rows:
            truth, points = MAPS[name](x), spread(x, count)
            posed = [Deformer(x, ply.faces, None, points, rigidity=r).pose(landmarks=truth[points], check=False).vertices for r in RIGIDITIES]
            posed += [RBFInterpolator(x[points], truth[points], kernel=kernel, degree=1)(x) for kernel in ("linear", "thin_plate_spline")]
            off = [100 * np.sqrt(((p - truth)**2).sum(1).mean()) / np.linalg.norm(np.ptp(truth, 0)) for p in posed]
            rows[name, count].append(off)
            print(f"{file.stem}, {name}, {count} points:" + "".join(f" {o:.3f}" for o in off), file=sys.stderr, flush=True)
    print("| shape | points | " + " | ".join([*(f"rigidity {r:g}" for r in RIGIDITIES), "spline of space, *r*", "spline, *r*² log *r*"]) + " |")
    print("|---" * (len(RIGIDITIES) + 4) + "|")
    for (name, count), all_of_it in rows.items():
        print(f"| {name} | {count} | " + " | ".join(f"{o:.2f}" for o in np.exp(np.mean(np.log(all_of_it), axis=0))) + " |")


if __name__ == "__main__":
    main([Path(f) for f in sys.argv[1:]] or [ROOT / "meshes" / f"{name}.ply" for name in ("bar", "cactus", "cylinder", "plane")])
