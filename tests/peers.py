# SPDX-License-Identifier: GPL-3.0-or-later
"""This plugin beside CGAL, Open3D and libigl: what a deformation takes on scans of growing size, and what each makes of dirty ones.

    build/venv-peers/bin/python tests/peers.py FOLDER --cgal PROGRAM --plugin libfilter_fcd.so --scans STEM...

Each cell of the tables is a process of its own, on the same files (STEM.ply, .sel, .def), with a limit of time. Seconds are those
from the mesh in memory to the result in memory; MB is what the process grows by meanwhile. CGAL and libigl stop when nothing
moves by more than the tolerance of the plugin's solver in an iteration, Open3D after 50 iterations, since it takes nothing but
their number. Writes peers.csv, scans.md, dirty.md and scans.png into FOLDER, and dirty_CASE__METHOD.ply.

The dirty scans are the smallest of the scans with something done to it. What is compared is each method with itself: how far is its
result from the one that it has on the clean scan, at the vertices of that (root mean square, percent of the diagonal)?"""
import argparse
import csv
import importlib
import json
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pymeshlab

TOLERANCE = 1e-5  # of SolverParam
OPEN3D_ITERATIONS = 50
METHODS = {
    "fcd": "this plugin",
    "printed": "this plugin, the paper to the letter",
    "every_vertex": "this plugin, a node at every vertex",
    "cgal_sr_arap": "CGAL SR-ARAP",
    "cgal_arap": "CGAL ARAP",
    "open3d_smoothed": "Open3D, smoothed",
    "open3d_spokes": "Open3D, spokes",
    "libigl_arap": "libigl ARAP",
}
REFERENCE = "cgal_sr_arap"


# --- files ---

def write_ply(path, points, faces):
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(points, faces))
    ms.save_current_mesh(str(path), save_vertex_quality=False)


def write_case(stem, points, faces, tags, matrix):
    write_ply(stem.with_suffix(".ply"), points, faces)
    np.savetxt(stem.with_suffix(".sel"), tags, "%d")
    np.savetxt(stem.with_suffix(".def"), matrix, "%.17g")


def read_case(stem):
    """Points, faces, tags and where the points are with those of the handle moved."""
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(f"{stem}.ply")
    points, faces = ms.current_mesh().vertex_matrix(), ms.current_mesh().face_matrix()
    tags, matrix = np.loadtxt(f"{stem}.sel", dtype=int), np.loadtxt(f"{stem}.def")
    return points, faces, tags, np.where((tags == 2)[:, None], points @ matrix[:3, :3].T + matrix[:3, 3], points)


# --- methods, each in a process of its own: they give the positions and what these cost ---

def with_plugin(stem, plugin, method):
    pymeshlab.load_plugin(plugin)
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(f"{stem}.ply")
    parameters = {"fcd": {}, "printed": {"graph_weights": 3}, "every_vertex": {"initial_patches": ms.current_mesh().vertex_number()}}[method]

    def work():
        result = ms.apply_filter("generate_fcd_deformed_mesh", handles="Files", tag_file=f"{stem}.sel", transform_file=f"{stem}.def",
                                 graph_layers=False, **parameters)
        return ms.current_mesh(), {"iterations": result["iterations"], "rests": bool(result["converged"])}

    mesh, cost = measured(work)
    return mesh.vertex_matrix(), cost


def with_open3d(stem, energy):
    import open3d
    points, faces, tags, places = read_case(stem)
    mesh = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(points), open3d.utility.Vector3iVector(faces))
    held = np.flatnonzero(tags != 1)

    def work():
        return mesh.deform_as_rigid_as_possible(
            open3d.utility.IntVector(held.astype(np.int32)), open3d.utility.Vector3dVector(places[held]), OPEN3D_ITERATIONS,
            getattr(open3d.geometry.DeformAsRigidAsPossibleEnergy, energy)), {"iterations": OPEN3D_ITERATIONS}

    moved, cost = measured(work)
    return np.asarray(moved.vertices), cost


def with_libigl(stem):
    import igl
    points, faces, tags, places = read_case(stem)
    held = np.flatnonzero(tags != 1)
    still = TOLERANCE * diagonal(points)

    def work():
        data = igl.ARAPData()
        data.max_iter = 1
        igl.arap_precomputation(points, faces.astype(np.int64), 3, held.astype(np.int32), data)
        now, iterations, moved = points, 0, np.inf
        while moved > still:  # not for NaN
            before, now = now, igl.arap_solve(places[held], data, now)
            moved = np.linalg.norm(now - before, axis=1).max()
            iterations += 1
        return now, {"iterations": iterations}

    return measured(work)


def megabytes(field):
    return int(re.search(rf"{field}:\s+(\d+)", Path("/proc/self/status").read_text())[1]) / 1024


def measured(work):
    Path("/proc/self/clear_refs").write_text("5")  # the peak from here on
    before, start, cpu = megabytes("VmRSS"), time.perf_counter(), time.process_time()
    result, cost = work()
    return result, {"seconds": time.perf_counter() - start, "cpu": time.process_time() - cpu, "megabytes": megabytes("VmHWM") - before,
                    **cost}


def completed(command, limits=None, **options):
    """(what it cost, or nothing, what it said where it failed), of a process whose last line tells what it cost; options as of
    subprocess.run. limits: what signals say, where these are more than a crash."""
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, **options)
    if done.returncode < 0:
        return {}, (limits or {}).get(-done.returncode, f"crash (signal {-done.returncode})")
    if done.returncode > 0:
        lines = re.sub(r"\x1b\[[0-9;]*m", "", done.stderr).strip().splitlines()
        return {}, "error: " + re.sub(r".*\.cpp:\d+: ", "", (lines or [f"exit code {done.returncode}"])[-1])
    return json.loads(done.stdout.strip().splitlines()[-1]), ""


def run_here(method, stem, plugin, out):
    if method in ("fcd", "printed", "every_vertex"):
        points, cost = with_plugin(stem, plugin, method)
    elif method == "libigl_arap":
        points, cost = with_libigl(stem)
    else:
        points, cost = with_open3d(stem, method.removeprefix("open3d_").capitalize())
    np.ascontiguousarray(points, float).tofile(out)
    print(json.dumps(cost))


class Runner:
    """Runs methods on cases, within limits."""

    def __init__(self, arguments):
        self.arguments = arguments
        self.rows = []

    def __call__(self, method, stem):
        """(positions or None, what it cost, what it said)"""
        out = self.arguments.folder / "positions.bin"
        out.unlink(missing_ok=True)
        if method.startswith("cgal_"):
            command = [self.arguments.cgal, method.removeprefix("cgal_"), stem, str(TOLERANCE), out]
        else:
            command = [sys.executable, __file__, self.arguments.folder, "--run", method, stem, out, "--plugin", self.arguments.plugin]
        print(f"peers: {METHODS[method]}: {stem.name}", file=sys.stderr, flush=True)
        points, cost, said = None, {}, ""
        try:
            cost, said = completed(command, timeout=self.arguments.seconds)  # seconds, megabytes, iterations, and of ours whether it rests
            points = None if said else np.fromfile(out).reshape(-1, 3)
        except subprocess.TimeoutExpired:
            said = f"> {self.arguments.seconds} s"
        return points, cost, said

    def record(self, table, case, vertices, method, cost, outcome):
        self.rows.append({"table": table, "case": case, "vertices": vertices, "method": method, "outcome": outcome, **cost})

    def report(self, name, text):
        (self.arguments.folder / f"{name}.md").write_text(text)
        print(text)


# --- what both tables need ---

def number(value):
    return f"{value:.3g}" if value < 100 else f"{value:.0f}"


def table(head, rows):
    """In Markdown."""
    return "".join("| " + " | ".join(row) + " |\n" for row in [head, ["---"] * len(head), *rows])


def diagonal(points):
    return np.linalg.norm(np.ptp(points, axis=0))


def miss(result, tags, places):
    """How far held vertices are at most from where they should be, over the diagonal of those."""
    return np.abs(result - places)[tags != 1].max()


# --- scans of growing size ---


def scans(run, stems):
    times, cells, sizes = {}, {}, []
    over = set()  # methods that did not come to an end: larger scans are not tried
    for stem in stems:
        points, _, tags, places = read_case(stem)
        size = len(points)
        sizes.append(size)
        for method in METHODS:
            if method in over:
                cells[method, size] = "-"
                continue
            result, cost, said = run(method, stem)
            if result is None:
                cells[method, size] = said
                over.add(method)
            else:
                times[method, size] = cost["seconds"]
                off = miss(result, tags, places) / diagonal(points)
                said = "" if off < 1e-6 else f", handles off by {100 * off:.2g} %"
                if not cost.get("rests", True):
                    said += f", not at rest after {cost['iterations']} iterations"
                    over.add(method)
                cells[method, size] = f"{number(cost['seconds'])} s, {cost['megabytes']:.0f} MB{said}"
            run.record("scans", stem.name, size, method, cost, said or "done")
    return table(["vertices", *(f"{size:,}" for size in sizes)],
                 ([name, *(cells[method, size] for size in sizes)] for method, name in METHODS.items())), times


def without_window():
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    return pyplot


def plot(times, limit, path):
    pyplot = without_window()
    figure, axes = pyplot.subplots(figsize=(9.5, 4.5), dpi=110)
    for method, name in METHODS.items():
        line = sorted((size, seconds) for (m, size), seconds in times.items() if m == method)
        if line:
            axes.loglog(*zip(*line), "o-", label=name, linewidth=2.5 if method == "fcd" else 1.2)
    axes.axhline(limit, color="grey", linestyle=":", label=f"limit, {limit} s")
    axes.set_xlabel("vertices")
    axes.set_ylabel("seconds from the mesh to the result")
    axes.grid(True, which="major", alpha=0.3)
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1, 0.5))
    figure.tight_layout()
    figure.savefig(path)


# --- how near after how long ---

def plot_errors(files, path):
    pyplot = without_window()
    figure, axes = pyplot.subplots(1, len(files), figsize=(3.2 * len(files), 3.6), dpi=110, sharey=True, squeeze=False)
    for one, file in zip(axes[0], files):
        rows = list(csv.DictReader(open(file, encoding="utf-8")))
        for method, name in {"fcd": METHODS["fcd"], "every_vertex": METHODS["every_vertex"], "sr_arap": METHODS["cgal_sr_arap"]}.items():
            line = [(float(row["seconds"]), float(row["percent"])) for row in rows if row["method"] == method]
            one.loglog(*zip(*line), "o-" if method != "sr_arap" else "-", label=name, linewidth=2.5 if method == "fcd" else 1.2, markersize=4)
        one.set_title(file.name.removesuffix("_error.csv"), fontsize=10)
        one.set_xlabel("seconds from the mesh on")
        one.grid(True, which="major", alpha=0.3)
    axes[0][0].set_ylabel("% of the diagonal from SR-ARAP's limit")
    axes[0][-1].legend(fontsize=8, loc="upper left", bbox_to_anchor=(1, 1))
    figure.tight_layout()
    figure.savefig(path)


# --- dirty scans ---

def dirty_cases(points, faces, tags):
    """{name: (points, faces, tags, copies, loose)}: the clean vertices stand first, except that copies, where given, tells for each
    vertex of which it is a copy; loose vertices, {vertex: clean vertex nearby}, belong to parts that hang on nothing."""
    random = np.random.default_rng(1)
    n, edge = len(points), np.linalg.norm(points[faces[:, 0]] - points[faces[:, 1]], axis=1).mean()
    cross = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    normal = cross / np.linalg.norm(cross, axis=1, keepdims=True)
    some = random.permutation(len(faces))
    corners = faces.ravel()
    cases = {"clean": (points, faces, tags, None, {})}
    cases["unwelded: every triangle for itself"] = (points[corners], np.arange(len(corners)).reshape(-1, 3), tags[corners], corners, {})

    fins = some[:200]
    cases["200 fins: edges with three triangles"] = (
        np.vstack([points, points[faces[fins, 0]] + edge * normal[fins]]),
        np.vstack([faces, np.stack([faces[fins, 0], faces[fins, 1], n + np.arange(200)], 1)]),
        np.concatenate([tags, tags[faces[fins, 0]]]), None, {})

    free = some[(tags[faces[some]] == 1).all(1)]
    at = faces[free[:2000], 0]
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * 0.3 * edge
    sides = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    parts = (points[at] + 0.5 * edge * normal[free[:2000]])[:, None] + corner
    cases["2000 loose crumbs on it"] = (
        np.vstack([points, parts.reshape(-1, 3)]),
        np.vstack([faces, (n + 4 * np.arange(2000)[:, None, None] + sides).reshape(-1, 3)]),
        np.concatenate([tags, np.ones(8000, int)]), None, dict(zip(range(n, n + 8000), np.repeat(at, 4))))
    cases["1000 isolated vertices"] = (
        np.vstack([points, points[at[:1000]] + 0.5 * edge]), faces, np.concatenate([tags, np.ones(1000, int)]), None,
        dict(zip(range(n, n + 1000), at[:1000])))

    cut = some[:2000]
    a, b, c = faces[cut].T
    middle = n + np.arange(2000)
    cases["2000 slivers: a millionth as high as long"] = (
        np.vstack([points, (points[a] + points[b]) / 2 + 1e-6 * (points[c] - points[a])]),
        np.vstack([np.delete(faces, cut, 0), np.stack([a, b, middle], 1), np.stack([b, c, middle], 1), np.stack([c, a, middle], 1)]),
        np.concatenate([tags, np.where(tags[a] == tags[b], tags[a], 1)]), None, {})

    turned = faces.copy()
    turned[some[:len(faces) // 20]] = turned[some[:len(faces) // 20]][:, ::-1]
    cases["a twentieth of the triangles turned over"] = (points, turned, tags, None, {})
    cases["500 triangles twice"] = (points, np.vstack([faces, faces[some[:500]]]), tags, None, {})
    return cases


def distance(a, b, clean):
    """Root mean square, percent of the diagonal."""
    return 100 * np.sqrt(np.mean(np.sum((a - b) ** 2, axis=1))) / diagonal(clean)


def outcome(result, own, case, clean):
    """What became of a case, in words. own: the method's result on the clean scan; clean: that scan's points, tags and places"""
    points, _, _, copies, loose = case
    clean, tags, places = clean
    if not np.isfinite(result).all():
        return "NaN"
    if copies is not None:
        low, high = np.full(clean.shape, np.inf), np.full(clean.shape, -np.inf)
        np.minimum.at(low, copies, result)
        np.maximum.at(high, copies, result)
        used = np.isfinite(low[:, 0])
        gap = np.linalg.norm(high[used] - low[used], axis=1).max() / diagonal(clean)
        if gap > 1e-3:
            return f"falls apart: gaps of {100 * gap:.2g} %"
        result = np.where(used[:, None], low, own)
    missed = miss(result[:len(clean)], tags, places) / diagonal(clean)
    if missed > 1e-3:
        return f"handles off by {100 * missed:.2g} %"
    off = distance(result[:len(clean)], own, clean)
    if off > 1:
        return f"another shape: {off:.2g} % off"
    if loose:
        vertex, nearby = np.array(list(loose)), np.array(list(loose.values()))
        way = (result[vertex] - points[vertex]) - (result[nearby] - points[nearby])
        behind = distance(way, 0, clean)
        if behind > 1:
            return f"what is loose is left behind, {behind:.2g} %"
    return f"as clean, {off:.2g} % off" if off > 1e-3 else "as clean"


def dirty(run, stem):
    points, faces, tags, places = read_case(stem)
    matrix = np.loadtxt(f"{stem}.def")
    own, cells = {}, {}
    cases = dirty_cases(points, faces, tags)
    for name, case in cases.items():
        short = run.arguments.folder / ("dirty_" + "".join(c if c.isalnum() else "_" for c in name.split(":")[0]))
        write_case(short, *case[:3], matrix)
        for method in METHODS:
            if name != "clean" and method not in own:
                cells[name, method] = "-"
                continue
            result, cost, said = run(method, short)
            if result is not None and name == "clean":
                own[method] = result
                said = f"{number(cost['seconds'])} s" if np.isfinite(result).all() else "NaN"
            elif result is not None:
                said = outcome(result, own[method], case, (points, tags, places))
            if result is not None:
                write_ply(short.with_name(f"{short.name}__{method}.ply"), result, case[1])
            cells[name, method] = said
            run.record("dirty", name, len(case[0]), method, cost, said)
        if name == "clean" and REFERENCE in own:
            for method in own.keys() - {REFERENCE}:
                cells[name, method] += f", {distance(own[method], own[REFERENCE], points):.2g} % from {METHODS[REFERENCE]}"
    return table([f"{len(points):,} vertices", *METHODS.values()], ([name, *(cells[name, method] for method in METHODS)] for name in cases))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--cgal", help="cgal_peer")
    parser.add_argument("--plugin")
    parser.add_argument("--scans", type=Path, nargs="+", default=[], help="from small to large")
    parser.add_argument("--seconds", type=int, default=120, help="limit of each cell")
    parser.add_argument("--errors", type=Path, nargs="+", help="only draw these of deformation_benchmark, NAME_error.csv, to errors.png")
    parser.add_argument("--run", nargs=3, metavar=("METHOD", "STEM", "OUT"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.run:
        run_here(*arguments.run[:2], arguments.plugin, arguments.run[2])
        return
    if arguments.errors:
        plot_errors(arguments.errors, arguments.folder / "errors.png")
        return
    if not arguments.plugin or not arguments.scans:
        parser.error("--plugin and --scans are missing")
    for module in ("igl", "matplotlib", "open3d"):  # what is not there would fail in each cell
        importlib.import_module(module)
    run = Runner(arguments)
    run.report("dirty", dirty(run, arguments.scans[0]))
    text, times = scans(run, arguments.scans)
    run.report("scans", text)
    plot(times, arguments.seconds, arguments.folder / "scans.png")
    with open(arguments.folder / "peers.csv", "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, ["table", "case", "vertices", "method", "outcome", "seconds", "megabytes", "iterations"],
                                extrasaction="ignore")
        writer.writeheader()
        writer.writerows(run.rows)


if __name__ == "__main__":
    main()
