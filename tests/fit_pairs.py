# SPDX-License-Identifier: GPL-3.0-or-later
"""How well FCD: Fit to Layer finds surfaces whose truth is known (tests/fit_recipes.py), with the default parameters. Prints for each pair,
in percent of the diagonal of the truth: root mean square distance of the vertices from where they belong before the fit and after it, the
median of that, and the root mean square distance from the surface that they belong on; the triangles that are turned over against the
truth; and seconds. Where a part of the target is missing: the same for vertices with and without something there, and how many of the
triangles without are stretched by 0.8 to 1.25 at most.

    build/venv/bin/python tests/fit_pairs.py [--half training] [--seeds 5] [--dirty] [--save FOLDER] [NAME=VALUE...] [PAIR...]

NAME=VALUE are parameters of the filter. --seeds: the median and worst rms over so many random seeds. --dirty: how far the fits of eight
dirty versions of each pair (tests/fit_dirt.py) are at most from that of the clean one. --save: the surfaces of each pair and of the fit, to look
at. What is absent (the scans in ../shared, CGAL, see tests/peers.sh) is left out, and named."""
import argparse
import ast
import sys
import time
from pathlib import Path

import numpy as np
import pymeshlab

from fit_dirt import apart, dirty
from fit_recipes import RECIPES, made
from fit_shapes import Absent, diagonal

PLUGIN = Path(__file__).resolve().parents[1] / "build/plugins/pymeshlab-2025.7/libfilter_fcd.so"
HALVES = {"training": "training", "held-out": "held out"}


def mesh_of(points, faces, normals=()):
    return pymeshlab.Mesh(points, faces, v_normals_matrix=normals) if len(normals) else pymeshlab.Mesh(points, faces)


def fitted(pair, **parameters):
    """By the filter: (positions, what it returned, seconds)"""
    ms = pymeshlab.MeshSet()
    ms.add_mesh(mesh_of(pair.target, pair.target_faces, pair.normals), "target")
    ms.add_mesh(mesh_of(pair.points, pair.faces), "source")
    if len(pair.landmarks):
        path = Path(__file__).resolve().parents[1] / "build" / "fit_pairs" / "landmarks.csv"
        path.parent.mkdir(parents=True, exist_ok=True)
        np.savetxt(path, np.column_stack([pair.landmarks, pair.truth[pair.landmarks]]), ["%d"] + ["%.17g"] * 3)
        parameters = {"landmarks_file": str(path), **parameters}
    start = time.perf_counter()
    result = ms.apply_filter("generate_fcd_fitted_mesh", target_layer=0, graph_layers=False, **parameters)
    seconds = time.perf_counter() - start
    return ms.current_mesh().vertex_matrix(), result, seconds


def rms(values):
    return float(np.sqrt(np.mean(values ** 2))) if len(values) else float("nan")


def crosses(points, faces):
    return np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])


def stretches(before, after, faces):
    """Of each triangle: its least and largest stretch, m x 2; those without an area are left out."""
    def plane(points):
        a, b = points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]
        length = np.linalg.norm(a, axis=1)
        along = np.einsum("ij,ij->i", a, b) / length
        return np.stack([np.stack([length, along], 1), np.stack([0 * length, np.linalg.norm(np.cross(a, b), axis=1) / length], 1)], 1)
    with np.errstate(all="ignore"):
        rest, now = plane(before), plane(after)
        good = rest[:, 1, 1] > 0.02 * rest[:, 0, 0]  # of slivers, rounding decides
        return np.linalg.svd(now[good] @ np.linalg.inv(rest[good]), compute_uv=False)


def from_surface(points, surface, faces):
    """The distances of points from a surface."""
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(surface, faces))
    ms.add_mesh(pymeshlab.Mesh(points))
    ms.apply_filter("compute_scalar_by_distance_from_another_mesh_per_vertex", measuremesh=1, refmesh=0, signeddist=False,
                    maxdist=pymeshlab.PureValue(10 * diagonal(surface)))
    return np.abs(ms.current_mesh().vertex_scalar_array())


def measured(pair, positions):
    """What a result is worth; lengths in percent of the diagonal."""
    size = diagonal(pair.truth) / 100
    off = np.linalg.norm(positions - pair.truth, axis=1) / size
    said = {"before": rms(np.linalg.norm(pair.points - pair.truth, axis=1) / size), "rms": rms(off), "median": float(np.median(off)),
            "surface": rms(from_surface(positions, pair.truth, pair.surface) / size), "folded": 0,
            "landmarks": float(off[pair.landmarks].max()) if len(pair.landmarks) else float("nan"),
            "has": rms(off[pair.has]), "not": rms(off[~pair.has]), "stretch": float("nan")}
    true, now = crosses(pair.truth, pair.surface), crosses(positions, pair.surface)
    said["folded"] = int(((true * now).sum(1) < 0).sum())
    lonely = pair.surface[~pair.has[pair.surface].any(1)]
    if len(lonely):
        stretch = stretches(pair.points, positions, lonely)
        said["stretch"] = 100 * float(np.mean((stretch.min(1) > 0.8) & (stretch.max(1) < 1.25)))
    return said


def saved(pair, positions, stem):
    stem.parent.mkdir(parents=True, exist_ok=True)
    for name, points, faces in (("source", pair.points, pair.faces), ("target", pair.target, pair.target_faces),
                                ("truth", pair.truth, pair.surface), ("fitted", positions, pair.surface)):
        ms = pymeshlab.MeshSet()
        ms.add_mesh(mesh_of(points, faces))
        ms.save_current_mesh(f"{stem}_{name}.ply")


def from_clean(pair, clean, **parameters):
    """How far the fits of its dirty versions are from that of the clean one: [(name, percent of the diagonal, root mean square)]"""
    return [(name, apart(fitted(version, **parameters)[0], own, clean, pair.truth)) for name, (version, own) in dirty(pair).items()]


def number(value):
    return "" if value != value else f"{value:.3f}" if value < 10 else f"{value:.1f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="*", metavar="PAIR or NAME=VALUE")
    parser.add_argument("--half", choices=HALVES, help="only these")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--dirty", action="store_true")
    parser.add_argument("--save", type=Path)
    parser.add_argument("--plugin", default=PLUGIN)
    arguments = parser.parse_args()
    given = [each for each in arguments.what if "=" not in each]
    parameters = {name: ast.literal_eval(value) for name, _, value in (each.partition("=") for each in arguments.what if "=" in each)}
    unknown = set(given) - RECIPES.keys()
    if unknown:
        parser.error(f"there is no {', '.join(unknown)}; there are {', '.join(RECIPES)}")
    pymeshlab.load_plugin(str(arguments.plugin))
    print("| pair | half | vertices, onto | before | rms | median | to surface | folded | matched | s | notes |\n" + "|---" * 11 + "|")
    means = {}
    for name, (half, recipe) in RECIPES.items():
        if given and name not in given or arguments.half and half != HALVES[arguments.half]:
            continue
        try:
            pair = made(name)
        except Absent as why:
            print(f"{name} is left out: {why}", file=sys.stderr)
            continue
        runs = [fitted(pair, **({"random_seed": seed + 1} if arguments.seeds > 1 else {}), **parameters) for seed in range(arguments.seeds)]
        worth = [measured(pair, positions) for positions, _, _ in runs]
        middle = int(np.argsort([each["rms"] for each in worth])[len(worth) // 2])
        positions, result, seconds = runs[middle]
        one = worth[middle]
        notes = []
        if not pair.has.all():
            notes.append(f"there {number(one['has'])}, not there {number(one['not'])}, {one['stretch']:.1f} % stretch by 0.8 to 1.25")
        if len(pair.landmarks):
            notes.append(f"landmarks {one['landmarks']:.1g}")
        if arguments.seeds > 1:
            worst = max(each["rms"] for each in worth)
            notes.append(f"worst of {arguments.seeds} seeds {number(worst)}, {worst / one['rms']:.2f} medians")
        if arguments.dirty:
            versions = from_clean(pair, fitted(pair, **parameters)[0] if arguments.seeds > 1 else positions, **parameters)
            dirt, off = max(versions, key=lambda version: version[1])
            notes.append(f"dirty, off the clean fit by {number(off)} at most ({dirt})")
        print(f"| {name}: {recipe.__doc__} | {half} | {len(pair.points)}, {len(pair.target)} | {number(one['before'])} | {number(one['rms'])} | "
              f"{number(one['median'])} | {number(one['surface'])} | {one['folded']} | {result['matched']:.2f} | {seconds:.2f} | "
              f"{'; '.join(notes)} |", flush=True)
        means.setdefault(half, []).append([one["rms"], one["surface"]])
        if arguments.save:
            saved(pair, positions, arguments.save / name)
    for half, values in means.items():
        both = np.exp(np.log(values).mean(0))
        print(f"| geometric mean | {half} | | | {number(both[0])} | | {number(both[1])} | | | | {len(values)} pairs |")


if __name__ == "__main__":
    main()
