#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the parameters that shape a deformation do, in pictures: those of docs/tuning.md, and of docs/method.md that of the paper.

  build/venv/bin/python tests/tuning.py docs/pictures
"""
import sys
from pathlib import Path

import numpy as np
import pymeshlab

import demo
import render

MESHES = Path(__file__).resolve().parents[1] / "meshes"


def benchmark(name):
    """Points, faces, tags and motion of a benchmark shape."""
    rest = render.Surface.load(str(MESHES / f"{name}.ply"))
    return rest.vertices, rest.faces, render.read_tags(MESHES / f"{name}.sel").astype(float), {"transform_file": str(MESHES / f"{name}.def")}


def hairpin():
    """A sheet folded so that its halves lie close to each other; one stays, the end of the other is lifted."""
    n = 121
    s, y = np.meshgrid(np.linspace(-60, 60, n), np.linspace(0, 40, 41), indexing="ij")
    fold, gap = 6.0, 4.0
    turn = np.clip(s / fold, -1, 1) * np.pi / 2
    x = np.where(np.abs(s) > fold, np.abs(s) - fold, 0) - gap / 2 * np.cos(turn)
    points = np.stack([x.ravel(), y.ravel(), gap / 2 * np.sin(turn).ravel()], 1)
    corner = (np.arange(n - 1)[:, None] * 41 + np.arange(40)).ravel()
    faces = np.vstack([np.stack([corner, corner + 41, corner + 1], 1), np.stack([corner + 1, corner + 41, corner + 42], 1)])
    tags = np.select([s.ravel() < -50, s.ravel() > 50], [0.0, 2.0], 1.0)
    return points, faces.astype(np.int32), tags, {"transforms": "2: translate 0 0 30"}


def disc():
    """A sheet with a disc in its middle, which is lifted, and a rim."""
    n = 121
    x, y = np.meshgrid(np.linspace(-1.1, 1.1, n), np.linspace(-1.1, 1.1, n), indexing="ij")
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.vstack([np.stack([corner, corner + n, corner + 1], 1), np.stack([corner + 1, corner + n, corner + n + 1], 1)])
    radius = np.hypot(x, y).ravel()
    tags = np.select([radius > 1, radius < 0.1], [0.0, 2.0], 1.0)
    return np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1), faces.astype(np.int32), tags, {"transforms": "2: translate 0 0 0.5"}


# name: case, mode of the pictures, view, parameter, its values
ROWS = {
    "smoothness": (lambda: benchmark("cylinder"), "plain", (0, -1, 0.1), "smoothness", [0.0005, 0.0058, 0.1]),
    "falloff": (disc, "plain", (0.3, -1, 0.35), "falloff", ["Smooth", "Linear", "Sharp", "Constant"]),
    "elastic": (lambda: benchmark("cylinder")[:3] + ({"transforms": "2: translate 0 0 -3"},), "plain", (0, -1, 0.1), "elastic", [False, True]),
    "patches": (lambda: benchmark("cactus"), "bend", (1, -2, 0.5), "initial_patches", [30, 300, 3000]),
    "influence": (lambda: benchmark("bar"), "bend", (1, -2, 0.5), "influence", [1.2, 4, 8]),
    "weights": (lambda: benchmark("bar"), "plain", (1, -2, 0.5), "graph_weights",
                ["The paper to the letter", "As in the paper", "Common border"]),
    "distances": (hairpin, "plain", (0.3, -1, 0.15), "weights", ["Along the surface", "Euclidean"]),
}


def main(folder):
    pymeshlab.load_plugin(str(demo.PLUGIN))
    for name, (case, mode, view, parameter, values) in ROWS.items():
        points, faces, tags, motion = case()
        rest = render.Surface(points, faces)
        panels = [render.Panel(rest, mode="tags", tags=tags, title="tags")]
        for value in values:
            ms = pymeshlab.MeshSet(verbose=False)
            ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=tags))
            ms.apply_filter("generate_fcd_deformed_mesh", graph_layers=False, **{parameter: value}, **motion)
            panels.append(render.Panel(render.Surface.of_layer(ms.current_mesh()), mode=mode, rest=rest,
                                       title=value if isinstance(value, str) else f"{parameter} = {value}"))
        render.render(folder / f"tuning_{name}.png", panels, view=view, columns=len(panels), size=(340, 340))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
