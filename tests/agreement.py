#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far results are from each other, or from the truth, where one would like them to be the same: tables for tests/measured.py.

    build/venv-python/bin/python tests/agreement.py seeds|sampling|thinned|saved|straight|guessed

Distances are percent of the diagonal. No constant was chosen on these cases. What is absent (the scans in ../shared) is left out, and named."""
import sys
import warnings
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests/python"), str(ROOT / "examples")]
from fit_shapes import Absent, diagonal, loaded, meshlab
from test_compensate import placed

from pymeshlab_fcd import Deformer, Motion, fit, straighten


def off(one, other, rest):
    """Root mean square, percent of the diagonal of rest."""
    return 100 * np.sqrt(((one - other)**2).sum(1).mean()) / diagonal(rest)


def between(values, digits=2):
    low, high = (f"{value:.{digits}g}" for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def ends(points, share=0.15):
    """Tags of the ends along the longest side, 0 and 2; 1 between them."""
    along = points[:, np.argmax(np.ptp(points, 0))]
    along = (along - along.min()) / np.ptp(along)
    return np.where(along < share, 0, np.where(along > 1 - share, 2, 1))


def turned(points, faces=None, tags=None, rest=None, **parameters):
    """The pose whose one end turns by 60 degrees against the other about the shortest side of rest, or of points."""
    rest = points if rest is None else rest
    turn = Motion.rotate(np.eye(3)[np.argmin(np.ptp(rest, 0))], 60, about=rest.mean(0))
    return Deformer(points, faces, ends(points) if tags is None else tags, **parameters).pose({2: turn})


def seeds():
    print("| mesh, vertices | nodes | 300 patches | nodes | automatic |\n|---|---|---|---|---|")
    for path in ("dirty/thingi_73416_38k.stl.xz", "dirty/truck_3k.obj", "attr/cycloidal.ply", "dirty/boeing_soup.off"):
        points, faces = loaded(path)
        cells = []
        for patches in (300, 0):
            poses = [turned(points, faces, patches=patches, seed=seed) for seed in range(1, 6)]
            apart = [poses[i].vertices - poses[k].vertices for i in range(5) for k in range(i)]
            most = 100 * max(np.linalg.norm(each, axis=1).max() for each in apart) / diagonal(points)
            rms = max(off(each, 0, points) for each in apart)
            cells += [f"{np.median([pose.info.nodes for pose in poses]):.0f}", f"{most:.2f} / {rms:.2f}"]
        print(f"| {path.split('/')[1].split('.')[0]}, {len(points)} |", " | ".join(cells), "|", flush=True)


def wavy(u, v):
    """A tube of radius about 1 along x, 10 long; u, v in [0, 1]."""
    a, r = 2 * np.pi * v, 1 + 0.15 * np.sin(6 * np.pi * u) * np.cos(4 * np.pi * v)
    return np.stack([10 * u, r * np.cos(a), 0.8 * r * np.sin(a)], -1).reshape(-1, 3)


def tube(rows, around):
    """The wavy tube's vertices, row by row, and faces."""
    u, v = np.meshgrid(np.linspace(0, 1, rows), np.arange(around) / around, indexing="ij")
    i, k = np.meshgrid(np.arange(rows - 1), np.arange(around), indexing="ij")
    a, b = i * around + k, i * around + (k + 1) % around
    return wavy(u, v), np.concatenate([np.stack([a, a + around, b], -1), np.stack([b, a + around, b + around], -1)]).reshape(-1, 3)


def sampling():
    print("| surface | changed | from the unchanged one |\n|---|---|---|")
    random = np.random.default_rng(1)
    points, faces = tube(120, 80)
    soup, corners = points[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)
    plain, tags, size = turned(soup, corners).vertices, ends(soup), diagonal(points)
    found = [off(turned(soup + by * size * random.uniform(-0.5, 0.5, soup.shape), corners, tags, points).vertices, plain, points) for by in (1e-9, 1e-8, 1e-7, 3e-7)]
    print(f"| mesh, every triangle for itself | corners moved at random by 1e-9 to 3e-7 | {between(found)} |", flush=True)

    lines, dots = 60, 60
    coarse = wavy(*np.meshgrid(np.linspace(0, 1, lines), np.arange(dots) / dots, indexing="ij"))
    plain = turned(coarse).vertices
    for denser, told in (((2, 5, 20), "2 to 20 times"), ((60,), "60 times")):
        found = []
        for n in denser:
            dense = wavy(*np.meshgrid(np.linspace(0, 1, lines), np.arange(dots * n) / dots / n, indexing="ij"))
            found.append(off(turned(dense, rest=coarse).vertices[::n], plain, coarse))
        print(f"| cloud in scan lines | {told} denser along the lines | {between(found)} |", flush=True)
    for by in (7e-9, 7e-7, 7e-6, 7e-5):
        found = []
        for n in (2, 8, 30):
            many = np.repeat(coarse, n, 0) + by * size * random.uniform(-0.5, 0.5, (n * len(coarse), 3))
            found.append(off(turned(many, None, np.repeat(ends(coarse), n), coarse).vertices[::n], plain, coarse))
        print(f"| cloud, each point 2, 8 or 30 times | moved at random by {by:g} | {between(found)} |", flush=True)


def thinned():
    print("| scan | driven by | distance |\n|---|---|---|")
    for path in ("scans/cortex_pia_lh_153k.ply.xz", "dirty/dragon_vrip_res2_100k.ply.xz"):
        points, faces = loaded(path)
        thin, corners = meshlab(points, faces, "meshing_decimation_quadric_edge_collapse", targetfacenum=30000)
        name, tags = f"{path.split('/')[1].split('_')[0]}, {len(points)} vertices", ends(points)
        poses = [turned(points, faces, seed=seed) for seed in (1, 2, 3, 4)]
        print(f"| {name} | itself, with another seed | {between([off(poses[0].vertices, pose.vertices, points) for pose in poses[1:]])} |", flush=True)
        carried = [turned(thin, corners, rest=points, seed=seed).deformation()(points) for seed in (1, 2, 3, 4)]
        free = tags == 1
        found = [off(by[free], pose.vertices[free], points) for by, pose in zip(carried, poses)]
        print(f"| {name} | a saved deformation of a copy of 30 000 faces | {between(found)} |", flush=True)
        print(f"| {name} | its own saved deformation | {between([off(pose.deformation()(points), pose.vertices, points) for pose in poses[:2]])} |", flush=True)


def saved():
    print("| surface | samples | MB | off, rms / most | fixed vertices that move by a bit |\n|---|---|---|---|---|")
    for path in ("scans/dragon_full_436k_q11.ply.xz", "scans/mni_t1wm_stack_1230k.ply.xz"):
        points, faces = loaded(path)
        pose = turned(points, faces)
        kept = pose.deformation()
        moved, tags = kept(points, threads=0), ends(points)
        most = 100 * np.linalg.norm(moved - pose.vertices, axis=1).max() / diagonal(points)
        print(f"| {path.split('/')[1].split('_')[0]}, {len(points)} vertices | {len(kept.samples)} | {kept.file_size / 1e6:.1f} | "
              f"{off(moved, pose.vertices, points):.2g} / {most:.2g} | {(moved != points)[tags == 0].any(1).sum()} |", flush=True)


def box(rows):
    """A bar of 100 x 10 x 10 along x: vertices and faces."""
    k = np.arange(40)
    side = np.stack([np.clip(np.abs((k + o) % 40 - 20) - 5, 0, 10) - 5. for o in (10, 0)], 1)
    points = np.concatenate([np.column_stack([np.full(40, x), side]) for x in np.linspace(0, 100, rows)])
    i, k = np.meshgrid(np.arange(rows - 1), k, indexing="ij")
    a, b = i * 40 + k, i * 40 + (k + 1) % 40
    return points, np.concatenate([np.stack([a, a + 40, b], -1), np.stack([b, a + 40, b + 40], -1)]).reshape(-1, 3)


def along(axis, points):
    """Points (x along, y, z across) on a curve: axis(x) is n x 3; cross-sections turn as little as possible."""
    fine = np.linspace(points[:, 0].min(), points[:, 0].max(), 4001)
    at = axis(fine)
    ahead = np.gradient(at, fine, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    left = [np.cross(ahead[0], np.eye(3)[np.argmin(np.abs(ahead[0]))])]
    for direction in ahead:
        left.append(left[-1] - direction * (left[-1] @ direction))
        left[-1] /= np.linalg.norm(left[-1])
    left = np.array(left[1:])
    up = np.cross(ahead, left)
    pick = np.clip(np.searchsorted(fine, points[:, 0]), 0, len(fine) - 1)
    return at[pick] + points[:, 1:2] * left[pick] + points[:, 2:3] * up[pick]


def spiral(x):
    turn = 6 * np.pi * x / 100
    radius = 8 + 18 * x / 100
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), 0.3 * x], 1)


def arc(x):
    turn = np.radians(120) * (x / 100 - 0.5)
    radius = 100 / np.radians(120)
    return np.stack([radius * np.sin(turn), radius * np.cos(turn), 0 * x], 1)


def snake(x):
    return np.stack([x, 12 * np.sin(x / 16), 8 * np.cos(x / 23)], 1)


def straight():
    print("| shape | line | off, rms | length off |\n|---|---|---|---|")
    random = np.random.default_rng(1)
    bar, faces = box(201)
    rope, corners = tube(400, 48)
    rope = rope * [10, 1, 1]
    for name, axis, points, triangles in (("bar of 100 x 10 x 10, bent by 120 degrees", arc, bar, faces), ("tube of three turns of a spiral", spiral, rope, corners),
                                          ("tube along a wave", snake, rope, corners)):
        fine = np.linspace(0, 100, 4001)
        length = np.r_[0, np.cumsum(np.linalg.norm(np.diff(axis(fine), axis=0), axis=1))]
        true = points * [length[-1] / 100, 1, 1]  # cross-sections are where the curve's length says
        true[:, 0] = np.interp(points[:, 0], fine, length)
        bent = along(axis, points)
        for line, jitter, middle, told in (((20, 60, 200), 0, False, "its axis, 20, 60, 200 points"), ((100,), 0.1, False, "its axis with a jitter of 0.1, 100 points"),
                                           ((60,), 0, True, "on its side, 60 points; through the middle")):
            distance, longer = [], []
            for n in line:
                x = np.linspace(0, 100, n)
                side = np.column_stack([x, np.full(n, 5. if points is bar else 1.), np.zeros(n)]) if middle else np.column_stack([x, np.zeros((n, 2))])
                at = along(axis, side) + jitter * random.uniform(-1, 1, (n, 3))
                made = straighten(bent, triangles, at, middle=middle)
                distance.append(off(placed(made.vertices, true), true, true))
                longer.append(100 * abs(made.line.new_length / length[-1] - 1))
            print(f"| {name} | {told} | {between(distance)} | {max(longer):.2g} % |", flush=True)


def guessed():
    print("| surface | target has | estimate over truth | truly off by |\n|---|---|---|---|")
    points, faces = tube(120, 48)
    shapes = (("bent", lambda p: placed(along(lambda x: arc(5 * x) / 5, p), p)), ("waved", lambda p: p + [[0, 1, 0]] * (0.6 * np.sin(0.7 * p[:, :1]))),
              ("twisted", lambda p: np.column_stack([p[:, 0], *(p[:, 1:, None] * np.moveaxis(np.array([[np.cos(p[:, 0] / 8), np.sin(p[:, 0] / 8)],
                                                                                                [-np.sin(p[:, 0] / 8), np.cos(p[:, 0] / 8)]]), 2, 0)).sum(1).T])))
    for name, shape in shapes:
        truth, ratios, truths = shape(points), [], []
        for share in (0.7, 0.5, 0.3):
            known = points[:, 0] < 10 * share
            kept = known[faces].all(1)
            number = np.cumsum(known) - 1
            made = fit(points, faces, truth[known], number[faces[kept]])
            really = np.sqrt(((made.vertices - truth)[~known]**2).sum(1).mean())
            ratios.append(made.info.guess_error / really)
            truths.append(100 * really / diagonal(points))
        print(f"| tube, {name} | 70, 50, 30 % | {', '.join(f'{r:.2f}' for r in ratios)} | {', '.join(f'{t:.2g}' for t in truths)} |", flush=True)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    try:
        {f.__name__: f for f in (seeds, sampling, thinned, saved, straight, guessed)}[sys.argv[1]]()
    except Absent as absent:
        sys.exit(f"left out: {absent}")
