# SPDX-License-Identifier: GPL-3.0-or-later
"""FCD: Fit to Layer beside others that lay one surface onto another, on pairs whose truth is known (tests/fit_recipes.py).

    build/venv-peers/bin/python tests/fit_peers.py FOLDER [--half held-out] [PAIR...]

Each cell of the table is a process of its own, with the default parameters of each program, and limits of memory and of processor time,
of all threads together; a program that ran over a limit is not tried on pairs whose source is larger. What is told: the root mean square
distance of the vertices from where they belong, in percent of the diagonal of the truth; the triangles that are turned over against the
truth; processor seconds from the arrays to the result. What fails: what does not come to its end, is no number, or is farther from the
truth than the source was.

What others get that they would not end without: pycpd, whose matrices are as large as both clouds, 1500 points of each, at a root mean
square distance of 1 from their middle, and its kernel then carries the vertices (it takes no landmarks); trimesh, of targets of more than
200 000 triangles, the vertices.

Writes fits.md, fit_failures.md and fits.csv into FOLDER, and fit_PAIR__METHOD.ply with the distance from the truth as quality. What
was measured before is in fits.csv; with --again it is measured again."""
import argparse
import csv
import json
import resource
import signal
import sys
from pathlib import Path

import numpy as np
import pymeshlab

import fit_pairs
import peers
from fit_recipes import RECIPES, made
from fit_shapes import Absent, diagonal

METHODS = {"fcd": "this plugin", "amberg": "trimesh, nricp_amberg", "sumner": "trimesh, nricp_sumner", "pycpd": "pycpd"}
FIELDS = ["pair", "method", "failure", "before", "rms", "median", "surface", "has", "not", "folded", "stretch", "landmarks", "cpu",
          "seconds", "megabytes"]
CPD_POINTS = 1500
MANY_TRIANGLES = 200_000


# --- methods, each in a process of its own: where the source's points come to lie ---

def with_plugin(pair):
    return fit_pairs.fitted(pair)[0]


def with_trimesh(pair, method):
    import trimesh.registration
    source = trimesh.Trimesh(pair.points, pair.faces, process=False)
    faces = len(pair.target_faces) > 0
    target = trimesh.Trimesh(pair.target, pair.target_faces, process=False) if faces else trimesh.PointCloud(pair.target)
    landmarks = (pair.landmarks, pair.truth[pair.landmarks]) if len(pair.landmarks) else (None, None)
    fit = getattr(trimesh.registration, f"nricp_{method}")
    return fit(source, target, *landmarks, use_faces=0 < len(pair.target_faces) <= MANY_TRIANGLES)


def with_pycpd(pair):
    from pycpd import DeformableRegistration
    middle = pair.points.mean(0)
    size = np.sqrt(((pair.points - middle) ** 2).sum(1).mean())  # as those who published it do
    random = np.random.default_rng(1)

    def some(points):
        return (points[random.permutation(len(points))[:CPD_POINTS]] - middle) / size
    cpd = DeformableRegistration(X=some(pair.target), Y=some(pair.points))
    cpd.register()
    everything = (pair.points - middle) / size
    for part in np.array_split(np.arange(len(everything)), len(everything) // 2000 + 1):  # its kernel, at other points than its own
        apart = ((everything[part, None] - cpd.Y) ** 2).sum(2)
        everything[part] += np.exp(-apart / (2 * cpd.beta ** 2)) @ cpd.W
    return everything * size + middle


def run_here(name, method, out, plugin):
    pair = made(name)
    if method == "fcd":
        pymeshlab.load_plugin(plugin)
    work = {"fcd": with_plugin, "pycpd": with_pycpd}.get(method, lambda pair: with_trimesh(pair, method))
    positions, cost = peers.measured(lambda: (work(pair), {}))
    np.ascontiguousarray(positions, float).tofile(out)
    print(json.dumps(cost))


# --- limits and what comes of each ---

def measured(name, method, arguments):
    """A row of FIELDS, and the positions or None."""
    out = arguments.folder / "fitted.bin"
    out.unlink(missing_ok=True)
    print(f"fit peers: {METHODS[method]}: {name}", file=sys.stderr, flush=True)

    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (arguments.seconds, arguments.seconds))
        resource.setrlimit(resource.RLIMIT_AS, (arguments.gigabytes << 30, arguments.gigabytes << 30))
    over = f"> {arguments.seconds} s"
    cost, said = peers.completed([sys.executable, __file__, arguments.folder, "--run", name, method, out, "--plugin", arguments.plugin],
                                 {signal.SIGXCPU: over, signal.SIGKILL: over}, preexec_fn=limit)
    row = {"pair": name, "method": method, **cost}
    if said:
        is_memory = any(each in said for each in ("MemoryError", "Unable to allocate", "bad_alloc", "Can't expand MemType"))
        return {**row, "failure": f"memory: > {arguments.gigabytes} GB" if is_memory else said}, None
    positions = np.fromfile(out).reshape(-1, 3)
    if not np.isfinite(positions).all():
        return {**row, "failure": "not a number"}, None
    worth = fit_pairs.measured(made(name), positions)
    failure = f"farther than before: {peers.number(worth['rms'])}" if worth["rms"] > worth["before"] else ""
    return {**row, **worth, "failure": failure}, positions


def keep(folder, name, what, points, faces, off=()):
    """For the picture. off: percent of the diagonal"""
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=off) if len(off) else pymeshlab.Mesh(points, faces))
    ms.save_current_mesh(str(folder / f"fit_{name}__{what}.ply"))


# --- tables ---

def cell(row):
    if row is None:
        return "-"
    if row["failure"]:
        return row["failure"]
    apart = "" if row["not"] != row["not"] else f" ({peers.number(row['has'])} / {peers.number(row['not'])})"
    folds = f", {int(row['folded'])} folded" if row["folded"] else ""
    return f"{peers.number(row['rms'])}{apart}{folds}, {peers.number(row['cpu'])} s"


def tables(rows):
    """Of rows, {(pair, method): row}: the fits, and what fails."""
    names = [name for name in RECIPES if (name, "fcd") in rows]
    ours = {name: rows[name, "fcd"] for name in names}
    fits = peers.table(["pair", "half", "vertices, onto", "before", *METHODS.values()], (
        [f"{name}: {RECIPES[name][1].__doc__}", RECIPES[name][0], f"{len(made(name).points):,}, {len(made(name).target):,}",
         peers.number(ours[name]["before"]), *(cell(rows.get((name, method))) for method in METHODS)] for name in names))
    lines, not_tried = [], {"failure": "not tried"}
    for half in ("held out", "training"):
        for method, title in METHODS.items():
            tried = [name for name in names if RECIPES[name][0] == half and rows.get((name, method), not_tried)["failure"] != "not tried"]
            if not tried:
                continue
            failures = [rows[name, method]["failure"] for name in tried]
            ended = [name for name, failure in zip(tried, failures) if not failure]
            nearest = [name for name in ended if rows[name, method]["rms"] <= min(
                other["rms"] for other in (rows.get((name, each)) for each in METHODS) if other and not other["failure"])]

            def count(*starts):
                return str(sum(failure.startswith(starts) for failure in failures) or "")
            line = [title, half, str(len(tried)), str(len(ended)), count(">"), count("memory"), count("error", "crash", "not a number"),
                    count("farther"), str(len(nearest))]
            if ended:
                times = [rows[name, method]["rms"] / ours[name]["rms"] for name in ended]
                line += [peers.number(np.exp(np.mean(np.log(times)))), str(int(sum(rows[name, method]["folded"] for name in ended))),
                         peers.number(np.median([rows[name, method]["cpu"] for name in ended]))]
            lines.append(line + [""] * (12 - len(line)))
    failures = peers.table(["program", "half", "pairs", "fitted", "over time", "over memory", "errors", "farther than before",
                            "nearest of all", "rms, times ours", "folded triangles", "median s"], lines)
    return fits, failures


def read(path):
    if not path.exists():
        return {}
    with open(path, encoding="utf-8") as file:
        return {(row["pair"], row["method"]): {name: value if name in FIELDS[:3] else float(value or "nan") for name, value in row.items()}
                for row in csv.DictReader(file)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("pairs", nargs="*", metavar="PAIR", help="only these")
    parser.add_argument("--half", choices=fit_pairs.HALVES, help="only these")
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS))
    parser.add_argument("--plugin", default=str(fit_pairs.PLUGIN))
    parser.add_argument("--seconds", type=int, default=60, help="limit of each cell, of processor time")
    parser.add_argument("--gigabytes", type=int, default=8, help="limit of each cell")
    parser.add_argument("--again", action="store_true", help="also what was measured before")
    parser.add_argument("--run", nargs=3, metavar=("PAIR", "METHOD", "OUT"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.run:
        run_here(*arguments.run, arguments.plugin)
        return
    unknown = set(arguments.pairs) - RECIPES.keys()
    if unknown:
        parser.error(f"there is no {', '.join(unknown)}; there are {', '.join(RECIPES)}")
    path = arguments.folder / "fits.csv"
    rows = read(path)
    pairs = {}
    for name, (half, _) in RECIPES.items():
        if arguments.pairs and name not in arguments.pairs or arguments.half and half != fit_pairs.HALVES[arguments.half]:
            continue
        try:
            pairs[name] = made(name)
        except Absent as why:
            print(f"{name} is left out: {why}", file=sys.stderr)
    over = {}  # how many vertices were too many for a method
    for name, pair in sorted(pairs.items(), key=lambda item: len(item[1].points)):
        size = len(pair.points)
        keep(arguments.folder, name, "source", pair.points, pair.faces)
        keep(arguments.folder, name, "target", pair.target, pair.target_faces)
        for method in arguments.methods:
            positions = None
            if (name, method) not in rows or arguments.again:
                if size > over.get(method, np.inf):
                    rows[name, method] = {"pair": name, "method": method, "failure": "not tried"}
                else:
                    rows[name, method], positions = measured(name, method, arguments)
            if rows[name, method]["failure"].startswith((">", "memory")):
                over.setdefault(method, size)
            if positions is not None:
                off = 100 * np.linalg.norm(positions - pair.truth, axis=1) / diagonal(pair.truth)
                keep(arguments.folder, name, method, positions, pair.surface, off)
            with open(path, "w", encoding="utf-8", newline="") as file:
                writer = csv.DictWriter(file, FIELDS, extrasaction="ignore")
                writer.writeheader()
                writer.writerows(rows.values())
            rows = read(path)
    for name, text in zip(("fits", "fit_failures"), tables(rows)):
        (arguments.folder / f"{name}.md").write_text(text)
        print(text)


if __name__ == "__main__":
    main()
