# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of docs/method.md of patches, their borders and the blend: a flat sheet as the method sees it.

    build/venv-python/bin/python tests/blend.py docs/pictures/blend.png      after tests/python_package.sh"""
import sys

import matplotlib
import numpy as np

import pymeshlab_fcd

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

LENGTH, WIDTH, STEP = 10, 6, 0.04


def main(path):
    x, y = np.meshgrid(np.arange(0, LENGTH + STEP / 2, STEP), np.arange(0, WIDTH + STEP / 2, STEP), indexing="ij")
    shape = x.shape
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1)
    i = np.arange(x.size).reshape(shape)[:-1, :-1].ravel()
    faces = np.concatenate([np.stack([i, i + shape[1], i + 1], 1), np.stack([i + 1, i + shape[1], i + shape[1] + 1], 1)])
    tags = np.where(points[:, 0] < 1.5, 0, np.where(points[:, 0] > LENGTH - 1.5, 2, 1))
    deformer = pymeshlab_fcd.Deformer(points, faces, tags, patches=40)
    weights, graph, patch = deformer.weights(), deformer.graph, deformer.patch_of.reshape(shape)
    rows = np.repeat(np.arange(len(points)), np.diff(weights.indptr))
    whole = np.zeros(weights.shape, np.float32)
    whole[rows, weights.indices] = weights.data

    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(15, 3.6), layout="constrained", width_ratios=[1, 1, 0.9])
    held = np.where(tags == 0, 0.0, np.where(tags == 2, 1.0, np.nan)).reshape(shape)
    for axes in (left, middle):
        axes.pcolormesh(x, y, held, cmap="coolwarm", vmin=-0.3, vmax=1.3, shading="nearest", rasterized=True)
        for each in range(patch.max() + 1):
            axes.contour(x, y, patch == each, levels=[0.5], colors="0.6", linewidths=0.7)
        axes.set_aspect("equal")
        axes.set_axis_off()
    for a, b in graph.edges:
        left.plot(*graph.nodes[[a, b], :2].T, color="black", linewidth=0.9)
    left.plot(*graph.nodes[:, :2].T, "o", color="black", markersize=3.5)
    left.set_title("patches, borders, graph")

    node = int(np.argmin(np.linalg.norm(graph.nodes - [LENGTH / 2, WIDTH / 2, 0], axis=1)))
    share = whole[:, node].reshape(shape)
    middle.contourf(x, y, np.where(share > 0, share, np.nan), levels=12, cmap="Greens")
    middle.contour(x, y, patch == node, levels=[0.5], colors="black", linewidths=1.6)
    middle.plot(*graph.nodes[node, :2], "o", color="black", markersize=3.5)
    turn = np.linspace(0, 2 * np.pi, 100)
    for radii, style in ((1, ":"), (4, "--")):
        circle = graph.nodes[node, :2, None] + radii * graph.radius[node] * np.stack([np.cos(turn), np.sin(turn)])
        middle.plot(*circle, style, color="black", linewidth=1)
    middle.set_xlim(x.min(), x.max())
    middle.set_ylim(y.min(), y.max())
    middle.set_title("one node: its patch, $d_j$, $4\\,d_j$, its weight")

    line = np.flatnonzero(np.isclose(points[:, 1], WIDTH / 2))
    at = points[line, 0]
    right.plot(at, whole[line, :weights.nodes].sum(1), color="green", label="nodes")
    right.plot(at, whole[line, weights.nodes], color="tab:blue", label="fixed")
    right.plot(at, whole[line, weights.nodes + 1], color="tab:red", label="handle")
    right.plot(at, whole[line, node], ":", color="green", label="one node")
    right.set_title("weights along the middle of the sheet")
    right.legend(loc="center", fontsize="small")
    figure.savefig(path, dpi=80)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
