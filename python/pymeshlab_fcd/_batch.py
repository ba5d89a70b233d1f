# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `python -m pymeshlab_fcd`: one job on many files, in several processes. The same command continues where one stopped."""
from __future__ import annotations

import argparse
import concurrent.futures
import contextlib
import functools
import hashlib
import importlib
import os
import signal
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any, NamedTuple, TextIO

import numpy as np
from numpy.typing import NDArray

from . import _files, _measures, _splats, _tables, _workers, samples
from ._compensate import compensate
from ._curves import read_curves
from ._deform import _posed, deform
from ._deformation import Deformation
from ._fit import fit
from ._inputs import Points
from ._mean import mean_shape
from ._motion import Motion
from ._numbers import lengths, shown, told
from ._ply import Ply
from ._pose import Pose
from ._results import Row, Table, state
from ._straighten import straighten
from ._symmetrize import symmetrize

_MEASURED = "measured: "  # before the names of measurements in the table, since users choose these

_FITTED = ("matched", "rms", "median", "percentile_95", "guessed", "landmark_residual", "curve_residual", "folded", "contact", "contact_depth", "converged")
_POSED = ("nodes", "folded", "strained", "contact", "contact_depth", "largest_stretch", "converged")
_COMPENSATED = ("before", "left", "scanned", "change", "change_most", "missed")
_SYMMETRIC = ("before", "after", "asymmetry", "asymmetry_most", "moved", "moved_most", "matched", "is_sure")

_PARAMETERS = {  # options that the job's function takes as they are
    "fit": ("start", "stiffness", "rigidity", "largest_distance", "largest_angle", "both_ways", "landmark_tolerance", "patches", "steps"),
    "deform": ("smoothness", "max_iterations"),
    "straighten": ("degrees", "middle", "smoothing", "untwist"),
    "symmetrize": ("stiffness", "largest_distance", "landmark_tolerance", "steps"),
    "compensate": ("degree", "largest_distance", "samples"),
}


def _parameters(given: argparse.Namespace) -> dict[str, Any]:
    return {name: getattr(given, name) for name in _PARAMETERS[given.job]}


class _Target(NamedTuple):
    """A scan."""

    vertices: Points
    faces: NDArray[np.int64] | None
    weights: NDArray[np.float64] | None = None
    normals: Points | None = None
    """Of a cloud."""


def _target(path: Path, weights: str | None = None) -> _Target:
    if path.suffix.lower() == ".ply":
        ply = Ply(path)
        return _Target(ply.vertices, ply.faces, ply.column(weights) if weights else None, ply.normals if ply.faces is None else None)
    if weights:
        raise ValueError(f"{path} is no PLY file, so it has no {weights}: save it as PLY, or leave --target-weights out")
    try:
        files: Any = importlib.import_module("trimesh")
    except ImportError:
        raise ValueError(f"{path} is no PLY file: trimesh, which reads others, is not installed") from None
    loaded = files.load(path, process=False)
    parts = [loaded]
    if hasattr(loaded, "geometry"):  # a scene
        parts = []
        for node in loaded.graph.nodes_geometry:
            matrix, name = loaded.graph[node]
            parts.append(loaded.geometry[name].copy())
            parts[-1].apply_transform(matrix)
    parts = [part for part in parts if not hasattr(part, "entities")]  # those are lines
    meshes = [part for part in parts if len(getattr(part, "faces", ()))]
    parts = meshes or parts
    if not sum(len(part.vertices) for part in parts):
        raise ValueError(f"{path} has neither a mesh nor points")
    begin = np.cumsum([0, *(len(part.vertices) for part in parts)])
    return _Target(np.concatenate([np.asarray(part.vertices, np.float64) for part in parts]),
                   np.concatenate([np.asarray(part.faces, np.int64) + first for part, first in zip(parts, begin)]) if meshes else None)


def _curves_of(given: str, scan: Path) -> Path:
    """The file of curves for a scan, or the one for all."""
    return Path(given) / f"{scan.stem}.csv" if Path(given).is_dir() else Path(given)


def _deformation_of(out: Path) -> Path:
    """The file with the deformation that led to a result: not beside it, where "*.ply" would take it for another one."""
    return out.parent / "deformations" / out.name


def _other_side_of(out: Path) -> Path:
    """The file with what a result lacked on one side."""
    return out.parent / "other_side" / out.name


def _read(path: Path, given: argparse.Namespace) -> Ply:
    """A mesh whose vertices will move. Raises ValueError if what is to be measured of it cannot be, before any work."""
    ply = Ply(path)
    if given.measure:
        _measures.take(_measures.read(given.measure), ply.vertices, ply.faces)
    return ply


def _write(ply: Ply, pose: Pose, out: Path, names: Sequence[str], given: argparse.Namespace) -> Row:
    """Writes the posed file, and its deformation if asked for. Returns its figures and measurements."""
    measured: Row = dict(_measures.take(_measures.read(given.measure), pose.vertices, ply.faces)) if given.measure else {}
    normals = pose.normals if ply.has_normals and (ply.faces is not None or pose.deformer._rest_normals is not None) else None
    ply.save(out, pose.vertices, normals)
    if given.deformations:
        _deformation_of(out).parent.mkdir(exist_ok=True)
        pose.deformation().save(_deformation_of(out))
    info = pose.info
    return {**{name: getattr(info, name) for name in names}, **{f"{_MEASURED}{name}": value for name, value in measured.items()}}


def _fit(given: argparse.Namespace, scan: Path, out: Path, threads: int) -> Row:
    template = _read(given.template, given)
    target = _target(scan, given.target_weights)
    pairs = _marks(given.landmarks, scan, 6, "x, y, z on the template and x, y, z on the scan")
    landmarks = None if pairs is None else (pairs[:, :3], pairs[:, 3:])
    curves = read_curves(_curves_of(given.curves, scan)) if given.curves else None
    fitted = fit(template.vertices, template.faces, target.vertices, target.faces, landmarks=landmarks, curves=curves, normals=template.normals,
                 weights=template.column(given.weights) if given.weights else None, target_weights=target.weights, threads=threads,
                 **_parameters(given))
    return _write(template, fitted, out, _FITTED, given)


def _normals_of(ply: Ply, vertices: Points) -> Points | None:
    """Normals of a mesh with other positions, by the area of the faces; None if the file has none."""
    if not ply.has_normals or ply.faces is None:
        return None
    corner, at = vertices[ply.faces], ply.faces.ravel()
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normals = np.stack([np.bincount(at, np.repeat(along, 3), len(vertices)) for along in across.T], axis=1).astype(np.float64, copy=False)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    return normals


def _compensate(given: argparse.Namespace, scan: Path, out: Path, threads: int) -> Row:
    nominal = Ply(given.nominal)
    target = _target(scan)
    made = compensate(nominal.vertices, nominal.faces, target.vertices, target.faces, scan_normals=target.normals, threads=threads, **_parameters(given))
    nominal.save(out, made.vertices, _normals_of(nominal, made.vertices))
    return {name: getattr(made.info, name) for name in _COMPENSATED}


def _moves(given: argparse.Namespace) -> dict[int, Motion]:
    """The motions of --move, by tag. Raises ValueError for a wrong one."""
    found: dict[int, Motion] = {}
    for word, text in given.move:
        where = f"--move {word} '{text}'"
        try:
            tag = int(word)
            if not 2 <= tag < 2**31:
                raise ValueError
        except ValueError:
            raise ValueError(f"{where}: the first is the tag of a handle, a whole number from 2") from None
        if tag in found:
            raise ValueError(f"{where}: handle {tag} moves already; put one motion after the other, as 'rotate 0 0 1 30 translate 0 0 5'")
        try:
            found[tag] = Motion.parse(text)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                deform(np.eye(3), None, [0, 1, tag], {tag: found[tag]})  # raises what is wrong with it
        except ValueError as error:
            raise ValueError(f"{where}: {error}") from None
    return found


def _deform(given: argparse.Namespace, path: Path, out: Path, threads: int) -> Row:
    ply = _read(path, given)
    tags = ply.column(given.tags)
    if not (tags == np.round(tags)).all():
        raise ValueError(f"{given.tags} of the vertices of {path} must be tags, whole numbers")
    pose = _posed(ply.vertices, ply.faces, tags.astype(np.int64), _moves(given), None, given.percent, given.steps, None, None,
                  {"normals": ply.normals, "threads": threads, **_parameters(given)})
    return _write(ply, pose, out, _POSED, given)


def _apply(given: argparse.Namespace, path: Path, out: Path, threads: int) -> Row:
    ply, bend = Ply(path), Deformation.load(given.deformation)
    if ply.normals is None:
        moved, turned = bend(ply.vertices, threads=threads), None
    else:
        moved, turned = bend(ply.vertices, ply.normals, threads=threads)
    others = _splats.columns(ply.names, ply.columns(), bend.linear(ply.vertices, threads=threads)) if _splats.is_splats(ply.names) else {}
    ply.save(out, moved, turned, others)
    way = lengths(moved - ply.vertices)
    return {"vertices": len(way), "largest_displacement": float(way.max(initial=0, where=np.isfinite(way))), "off_by": bend.largest_difference}


def _straighten(given: argparse.Namespace, path: Path, out: Path, threads: int) -> Row:
    ply = _read(path, given)
    line = _tables.numbers(Path(given.lines) / f"{path.stem}.csv", 3, "x, y, z")
    made = straighten(ply.vertices, ply.faces, line, normals=ply.normals, threads=threads, **_parameters(given))
    measured = made.line
    return {"length": measured.length, "new_length": measured.new_length, "is_middle": measured.is_middle, "twist": measured.twist, "released": measured.released,
            **_write(ply, made, out, _POSED, given)}


def _marks(folder: str | None, path: Path, columns: int, what: str) -> Points | None:
    return _tables.numbers(Path(folder) / f"{path.stem}.csv", columns, what) if folder else None


def _symmetrize(given: argparse.Namespace, path: Path, out: Path, threads: int) -> Row:
    ply = _read(path, given)
    pairs = _marks(given.pairs, path, 6, "x, y, z on the left and x, y, z on the right")
    made = symmetrize(ply.vertices, ply.faces, pairs=None if pairs is None else pairs.reshape(-1, 2, 3), midline=_marks(given.midlines, path, 3, "x, y, z"),
                      normals=ply.normals, threads=threads, **_parameters(given))
    found = made.symmetry
    if given.other_side:
        other, normal = made.other_side(), np.asarray(found.plane[1])
        turned = made.normals[other.source]
        part = _other_side_of(out)
        part.parent.mkdir(exist_ok=True)
        ply.part(other.source, other.faces).save(part, other.vertices, turned - 2 * np.outer(turned @ normal, normal))
    return {**{name: getattr(found, name) for name in _SYMMETRIC}, **_write(ply, made, out, ("folded", "contact", "contact_depth", "converged"), given)}


def _info(given: argparse.Namespace, path: Path, out: Path, threads: int) -> Row:
    with open(path, "rb") as file:
        is_deformation = b"\ncomment FCD deformation, version " in file.read(1000)
    if is_deformation:
        bend = Deformation.load(path)
        samples = bend.samples
        return {"samples": len(samples), "off_by": bend.largest_difference, "low": samples.min(0).tolist(), "high": samples.max(0).tolist()}
    vertices, faces, *_ = _target(path)
    row: Row = {"vertices": len(vertices), "faces": 0 if faces is None else len(faces)}
    whole = vertices[np.isfinite(vertices).all(axis=1)]
    return {**row, "low": whole.min(0).tolist(), "high": whole.max(0).tolist()} if len(whole) else row


_JOBS: dict[str, Callable[[argparse.Namespace, Path, Path, int], Row]] = {
    "fit": _fit, "deform": _deform, "apply": _apply, "straighten": _straighten, "symmetrize": _symmetrize,
    "compensate": _compensate, "info": _info}


def _results_of(given: argparse.Namespace, out: Path) -> list[Path]:
    if given.job == "info":
        return []
    more = {"deformations": _deformation_of, "other_side": _other_side_of}
    return [out, *(of(out) for name, of in more.items() if getattr(given, name, False))]


def _job(given: argparse.Namespace, path: Path, out: Path, threads: int) -> Row:
    """Does one file. An error is put in the row."""
    begin = time.perf_counter()
    row: Row = {}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            row.update(_JOBS[given.job](given, path, out, threads))
            row["error"] = ""
        except Exception as error:  # of any kind: the other files are done anyway
            row["error"] = told(error)
    row["seconds"] = round(time.perf_counter() - begin, 3)
    row["result"] = "" if row["error"] else state(*_results_of(given, out))
    row["warnings"] = " | ".join(dict.fromkeys(str(each.message) for each in caught if issubclass(each.category, UserWarning)))
    return row


def _key(given: argparse.Namespace, defaults: Mapping[str, object], path: Path, known: Callable[[Path], str]) -> str:
    """All that a result depends on, as two hashes: of the file's content, and of the options. A file with the same key is not done again,
    wherever it lies. Default options do not count, so that later versions may add some. known: hash of a file's content"""
    asked: dict[str, object] = {}
    for name, value in vars(given).items():
        if name in ("files", "out", "processes", "scheduler", "mean", "again") or value == defaults.get(name):
            continue
        if name in ("template", "nominal", "deformation", "measure"):
            value = known(Path(value))
        elif name in ("landmarks", "lines", "pairs", "midlines"):
            value = known(Path(value) / f"{path.stem}.csv")
        elif name == "curves":
            value = known(_curves_of(value, path))
        asked[name] = value
    return f"{known(path) or '-'} {hashlib.sha256(repr(sorted(asked.items())).encode()).hexdigest()[:16]}"


def _on_cluster(client: Any, given: argparse.Namespace, jobs: Sequence[tuple[Path, Path]]) -> Iterator[tuple[Path, Row]]:
    """The rows, as they come, from the workers of a Dask cluster, which see the same folders. A lost worker becomes an error in its row."""
    tasks = {client.submit(_job, given, path, out, 1, pure=False): path for path, out in jobs}
    try:
        for task in importlib.import_module("distributed").as_completed(tasks):
            row: Row
            try:
                row = task.result()
            except Exception as error:  # of the cluster: a job puts its own error in its row
                row = {"error": f"the cluster could not do it: {told(error)}"}
            yield tasks[task], row
    finally:
        client.cancel(list(tasks))


def _done(given: argparse.Namespace, jobs: Sequence[tuple[Path, Path]]) -> Iterator[tuple[Path, Row]]:
    """The rows of the files, as they come."""
    if given.scheduler:
        with importlib.import_module("distributed").Client(given.scheduler, timeout="30s") as client:
            yield from _on_cluster(client, given, jobs)
        return
    processes = min(given.processes, len(jobs))
    if processes <= 1:
        for path, out in jobs:
            yield path, _job(given, path, out, 0)
        return
    threads = max(1, (os.cpu_count() or 1) // processes)
    with _workers.pool(processes) as pool:
        waiting = {pool.submit(_workers.run, _job, given, path, out, threads): path for path, out in jobs}
        for each in concurrent.futures.as_completed(waiting):
            row: Row
            try:
                row = each.result()
            except BrokenProcessPool:
                row = {"error": "the process that did it was ended, perhaps as there was no memory left: use fewer processes"}
            yield waiting[each], row


def _write_mean(files: Sequence[Path], out: Path, scaled: bool) -> None:
    """Writes the mean of results with the same vertices, with all else of the first one."""
    first = Ply(files[0])
    found = mean_shape([lambda path=path: Ply(path).vertices for path in files], scaled)  # type: ignore[misc]
    first.save(out, found.vertices, _normals_of(first, found.vertices))
    far = int(found.apart.argmax())
    _say(f"mean of {len(files)} shapes: {shown(out)}; they are {float(np.sqrt((found.apart**2).mean())):.4g} from it (root mean square), "
         f"{shown(files[far])} the most, {found.apart[far]:.4g}")


def _parsers() -> tuple[argparse.ArgumentParser, Mapping[str, argparse.ArgumentParser]]:
    """The parser of the command, and those of its jobs."""
    parser = argparse.ArgumentParser(prog="python -m pymeshlab_fcd", description="Does one job on many files. A table in the folder of the "
                                     "results has a row for each file, with its figures and warnings. Run the same command again, and it does only "
                                     "what is not done yet. The status is 0 if all files are done, 1 if a file failed, 2 if the command is wrong.")
    jobs = parser.add_subparsers(dest="job", required=True, metavar="JOB")

    texts = {"FILE": "a PLY file", "SCAN": "a PLY file, or, with trimesh, another one that it reads", "TEMPLATE": "a PLY file", "NOMINAL": "a PLY file",
             "DEFORMATION": "a file of --deformations, of Deformation.save, or of MeshLab's FCD: Save Deformation"}

    def job(name: str, text: str, files: str, *own: str) -> argparse.ArgumentParser:
        made = jobs.add_parser(name, help=text, description=text)
        for each in own:
            made.add_argument(each.lower(), metavar=each, help=texts[each])
        made.add_argument("files", nargs="+", metavar=files, help=texts[files])
        made.add_argument("--out", required=name != "info", metavar="FOLDER", help="the folder for the results and their table, JOB.csv")
        made.add_argument("--processes", type=int, default=1, help="how many files to do at a time (default: 1, on all cores)")
        made.add_argument("--scheduler", metavar="ADDRESS", help="does the files on this Dask cluster, a task each; its workers must see the same "
                          "folders")
        made.add_argument("--again", action="store_true", help="does again what is done already")
        if name not in ("apply", "compensate", "info"):
            made.add_argument("--deformations", action="store_true", help="also saves the deformation of each, deformations/NAME.ply")
            made.add_argument("--measure", metavar="FILE", help="adds lengths of each result to the table. Each line has a name, a kind (distance, "
                              "length or girth: the latter two along edges) and numbers of vertices, from 0")
        return made

    made = job("fit", "Lays a template onto each scan. Labels, colours and textures of the template stay.", "SCAN", "TEMPLATE")
    made.add_argument("--landmarks", metavar="FOLDER", help="NAME.csv for each scan: x, y, z on the template, and x, y, z on the scan")
    made.add_argument("--curves", metavar="FOLDER_OR_FILE", help="NAME.csv for each scan, or one file for all: lines that slide along each other. "
                      "The first row is curve, surface, x, y, z; the surface is source (the template) or target (the scan)")
    made.add_argument("--start", default="as_they_lie", choices=["as_they_lie", "landmarks_rigid", "landmarks_similar", "axes"],
                      help="how to move the template onto the scan first: not (default), by the landmarks, by these and a scale, or by middle and axes")
    made.add_argument("--weights", metavar="PROPERTY", help="how much each vertex of the template counts: 0 (goes along) to 1")
    made.add_argument("--target-weights", metavar="PROPERTY", help="how much each vertex of a scan counts: 0 to 1")
    made.add_argument("--stiffness", type=float, default=1.0, help="how much the template keeps its shape (default: 1)")
    made.add_argument("--rigidity", type=float, default=1.0, help="1: parts keep their size (default); 0: they may stretch evenly")
    made.add_argument("--largest-distance", type=float, default=0.0, help="parts farther than this from the scan go along (default: no limit)")
    made.add_argument("--largest-angle", type=float, default=70.0, help="parts that face the scan at a larger angle go along (default: 70 degrees)")
    made.add_argument("--both-ways", action="store_true", help="the scan also draws the template; for thin parts that come from far")
    made.add_argument("--landmark-tolerance", type=float, default=0.0, help="how far landmarks may be off (default: 0, exact)")
    made.add_argument("--patches", type=int, default=150, help="number of patches at first; more for finer bends and close landmarks (default: 150)")
    made.add_argument("--steps", type=int, default=50, help="the most steps; more if a fit does not converge (default: 50)")
    made.add_argument("--mean", nargs="?", const="rigid", choices=["rigid", "similar"], help="also writes mean.ply, the mean of all results, laid "
                      "onto each other by rigid motions; with similar, scaled, too")
    made = job("deform", "Moves the handles of each mesh.", "FILE")
    made.add_argument("--tags", default="quality", metavar="PROPERTY", help="the property of vertices with the tags: 0 fixed, 1 free, 2 and up "
                      "handles (default: quality)")
    made.add_argument("--move", nargs=2, action="append", default=[], metavar=("TAG", "MOTION"), help="how a handle moves, such as "
                      "2 'rotate 0 0 1 30 translate 0 0 5'")
    made.add_argument("--percent", type=float, default=100.0, help="how much of the motions (default: 100)")
    made.add_argument("--steps", type=int, default=1, help="the least number of steps; more if the shape jumps on its way (default: 1)")
    made.add_argument("--smoothness", type=float, default=0.0058, help="how far bends spread: 0.001 loose, 0.1 stiff (default: 0.0058)")
    made.add_argument("--max-iterations", type=int, default=1000, help="the most iterations; more if a deformation does not converge (default: 1000)")
    job("apply", "Carries each mesh or cloud by a saved deformation.", "FILE", "DEFORMATION")
    made = job("straighten", "Straightens each mesh along its line.", "FILE")
    made.add_argument("--lines", required=True, metavar="FOLDER", help="NAME.csv for each file: x, y, z of the points of its line")
    made.add_argument("--degrees", type=float, default=0.0, help="the angle of the arc that the line becomes (default: 0, straight)")
    made.add_argument("--middle", action="store_true", help="moves the line into the middles of the cross-sections")
    made.add_argument("--smoothing", type=float, default=0.0, help="removes wiggles shorter than about three times this share of the length (default: 0, none)")
    made.add_argument("--untwist", action="store_true", help="also turns back cross-sections that are twisted about the line")
    made = job("symmetrize", "Restores the symmetry of each mesh.", "FILE")
    made.add_argument("--pairs", metavar="FOLDER", help="NAME.csv for each file: x, y, z on the left, and x, y, z on the right")
    made.add_argument("--midlines", metavar="FOLDER", help="NAME.csv for each file: x, y, z of points on the plane of symmetry")
    made.add_argument("--stiffness", type=float, default=1.0, help="how much the surface keeps its shape (default: 1)")
    made.add_argument("--landmark-tolerance", type=float, default=0.0, help="how far pairs and midlines may be off (default: 0, exact)")
    made.add_argument("--largest-distance", type=float, default=0.0, help="parts farther than this from the mirror image have no counterpart (default: no limit)")
    made.add_argument("--steps", type=int, default=50, help="the most steps of the fit onto the mirror image; more if it does not converge (default: 50)")
    made.add_argument("--other-side", action="store_true", help="also saves other_side/NAME.ply: the good side, mirrored, where the other one is missing")
    made = job("compensate", "Makes the part to print from each scan of a printed one. Its print comes out as the nominal part.", "SCAN", "NOMINAL")
    made.add_argument("--degree", type=int, default=5, help="degree of the warp, 1 to 7; more follows finer warps (default: 5)")
    made.add_argument("--largest-distance", type=float, default=0.0, help="parts farther than this from the scan count as not scanned (default: no limit)")
    made.add_argument("--samples", type=int, default=12000, help="how many places of the nominal part to match; more for noisy scans (default: 12000)")
    job("info", "Says how large each file, or saved deformation, is, and where it lies.", "FILE")
    return parser, jobs.choices


def _say(text: str, file: TextIO | None = None) -> None:
    """Prints a text; characters that the stream lacks are escaped."""
    stream: Any = file or sys.stdout
    if stream is None:  # it was closed before the start
        return
    kind = stream.encoding or "ascii"
    print(text.encode(kind, "backslashreplace").decode(kind), file=stream, flush=True)


def _tried(given: argparse.Namespace) -> None:
    """Raises ValueError for options that no file can be done with: they are tried on a small surface."""
    if given.job not in _PARAMETERS:
        return
    vertices, faces, tags = samples.strip(9, 5)
    some = [0, 4, 22, 40]
    asked: dict[str, Any] = _parameters(given)
    if asked.get("largest_distance", 0) > 0:
        asked["largest_distance"] = 0.0  # any limit is right, but may leave nothing of this surface
    with warnings.catch_warnings(), contextlib.suppress(RuntimeError):  # it has no solution; a file's may
        warnings.simplefilter("ignore")
        if given.job == "fit":
            fit(vertices, faces, vertices, faces, landmarks=(some, vertices[some]) if given.landmarks else None, samples=100, **asked)
        elif given.job == "deform":
            deform(vertices, faces, tags, {}, percent=given.percent, steps=given.steps, **asked)
        elif given.job == "straighten":
            straighten(vertices, faces, vertices[2::5], **{**asked, "middle": False, "untwist": False})  # such a strip has none
        elif given.job == "symmetrize":
            symmetrize(vertices, faces, plane=[[5, 1, 0], [0, 1, 0]], samples=100, **asked)
        else:
            compensate(vertices, faces, vertices, faces, **{**asked, "samples": min(given.samples, 100)})


def _shared(given: argparse.Namespace) -> None:
    """Raises OSError or ValueError if what all files need cannot be read."""
    if hasattr(given, "template"):
        template = _read(given.template, given)
        if given.weights:
            template.column(given.weights)
        if given.curves and not Path(given.curves).exists():
            raise ValueError(f"--curves {shown(given.curves)} is neither a file nor a folder")
    elif hasattr(given, "nominal"):
        Ply(given.nominal)
    elif hasattr(given, "deformation"):
        Deformation.load(given.deformation)


def _looked_at(parser: argparse.ArgumentParser, given: argparse.Namespace, paths: Sequence[Path], outs: Mapping[Path, Path]) -> None:
    """Ends a wrong command before anything is done."""
    if given.processes < 1:
        parser.error("--processes must be 1 or more")
    if given.scheduler:
        try:
            importlib.import_module("distributed")
        except ImportError:
            parser.error("--scheduler needs Dask: pip install 'dask[distributed]'")
    try:
        if getattr(given, "measure", None):
            _measures.read(given.measure)
        if given.job == "deform":
            _moves(given)
        for name in ("landmarks", "lines", "pairs", "midlines"):
            folder = getattr(given, name, None)
            if folder is not None and not Path(folder).is_dir():
                raise ValueError(f"--{name} {shown(folder)} is no folder")
        _shared(given)
        _tried(given)
    except (OSError, ValueError) as error:
        parser.error(told(error))
    if given.job == "info":
        return
    names: dict[str, Path] = {"mean.ply": Path("--mean")} if getattr(given, "mean", None) else {}
    read = set().union(*map(_files.marks, [*paths, *(Path(getattr(given, name)) for name in ("template", "nominal", "deformation") if hasattr(given, name))]))
    for path, out in outs.items():
        if names.setdefault(out.name.casefold(), path) != path:
            parser.error(f"{shown(names[out.name.casefold()])} and {shown(path)} would have one result, {shown(out)}: rename one of them")
        for each in _results_of(given, out):
            if not read.isdisjoint(_files.marks(each)):
                parser.error(f"{shown(each)} would be written over what is read: give another folder")


def _table(parser: argparse.ArgumentParser, given: argparse.Namespace, outs: Mapping[Path, Path], keys: Mapping[Path, str]) -> Table | None:
    """The folder's table. Ends the command if it would overwrite a result of another file or job. A moved file is recognised by its content."""
    if not given.out:
        return None
    folder = Path(given.out)
    try:
        table = Table(folder / f"{given.job}.csv", list(outs))
        others = {job: Table(folder / f"{job}.csv") for job in _JOBS if job not in ("info", given.job)}
    except (OSError, ValueError) as error:
        parser.error(told(error))
    mean = folder / "mean.ply"  # its source in the table is itself
    written = [*outs.items(), *([(mean, mean)] if getattr(given, "mean", None) else [])] if given.job != "info" else []
    if not any(known.path.exists() for known in (table, *others.values())):  # no command has begun here
        for there in (result for _, out in written for result in _results_of(given, out) if os.path.lexists(result)):
            parser.error(f"{shown(there)} is there already, and no table there says that it is a result: move it, or give another folder")
    for path, out in written:
        for job, each in {given.job: table, **others}.items():
            for row in each.owners(out):
                if job == given.job and row["source"] == each.source(path):
                    continue
                if job == given.job and (_files.same_file(each.place(row), path) or f"{row['key']}".split(" ")[0] == keys.get(path, "").split(" ")[0]):
                    each.rename(row, path)
                else:
                    if row["source"] == each.source(out):
                        parser.error(f"{shown(out)} is the mean that {job} made: give another folder, or delete it first")
                    parser.error(f"{shown(out)} is what {job} made of {each.place(row)}: give another folder, or delete it first")
    return table


def _folder(parser: argparse.ArgumentParser, given: argparse.Namespace) -> contextlib.AbstractContextManager[bool]:
    """Makes the folder of results, and locks it for this command; `True` if there is none."""
    if not given.out:
        return contextlib.nullcontext(True)
    try:
        os.makedirs(given.out, exist_ok=True)
    except OSError as error:
        parser.error(f"--out {shown(given.out)} is no folder, and cannot be made: {error.strerror}")
    return _files.alone(given.out)


def main(arguments: Sequence[str] | None = None) -> int:
    parser, jobs = _parsers()
    words = list(sys.argv[1:] if arguments is None else arguments)
    for word in words[:words.index("--")] if "--" in words else words:
        if word.startswith("-") and Path(word).suffix and os.path.lexists(word):  # as of "*.ply"; not "-h"
            parser.error(f"{shown(word)} begins with a dash, as an option does: write ./{shown(word)}")
    given = parser.parse_args(words)
    if "" in [given.out, *given.files]:  # as of a variable of the shell that is not set
        parser.error("a name is empty: give files, and a folder for --out")
    paths = list(dict.fromkeys(Path(each) for each in given.files))
    ending = "" if given.job == "info" else ".ply"
    outs = {path: Path(given.out or ".") / f"{path.stem}{ending}" for path in paths}
    _looked_at(parser, given, paths, outs)
    try:
        with _workers.terminable(), _folder(parser, given) as is_alone:
            if not is_alone:
                parser.error(f"another command is writing to --out {shown(given.out)}: wait until it is done, or give another folder")
            defaults = {name: jobs[given.job].get_default(name) for name in vars(given)}
            known = functools.cache(state)  # reads a template once
            keys = {path: _key(given, defaults, path, known) for path in outs} if given.out else {}
            return _go(given, outs, keys, _table(parser, given, outs, keys))
    except BrokenPipeError:  # the reader of the output is gone, as with "| head"
        with contextlib.suppress(AttributeError, OSError, ValueError):  # discards the rest of the output
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141  # as by SIGPIPE
    except OSError as error:  # of the table or the mean: a job puts its own in its row
        with contextlib.suppress(OSError):
            _say(f"ended: {told(error)}; mend that, and the same command goes on from here", sys.stderr)
        return 1
    except KeyboardInterrupt as ended:
        is_asked = isinstance(ended, _workers.Terminated)
        _say(f"{'ended' if is_asked else 'interrupted'}: the same command goes on from here", sys.stderr)
        return 128 + (signal.SIGTERM if is_asked else signal.SIGINT)


def _go(given: argparse.Namespace, outs: Mapping[Path, Path], keys: Mapping[Path, str], table: Table | None) -> int:
    """Does the files that are left. Returns the status."""
    rows = table.rows if table else {}
    if table:
        _files.sweep([table.path, Path(given.out) / "mean.ply", *(each for out in outs.values() for each in _results_of(given, out))])

    def is_as_written(path: Path) -> bool:
        row = rows.get(table.source(path)) if table else None
        return row is not None and not row.get("error") and row.get("key") == keys[path] and row["result"] == state(*_results_of(given, outs[path]))

    done = set() if given.again else {path for path in outs if is_as_written(path)}
    left = [(path, out) for path, out in outs.items() if path not in done]
    if done:
        _say(f"{len(done)} of {len(outs)} files are done already")
    failed = 0
    if table and rows:
        table.write()  # removes a row that an interrupt left unfinished
    elif table:
        table.path.touch()  # says that what is here from now on are results
    for number, (path, row) in enumerate(_done(given, left), len(done) + 1):
        failed += bool(row["error"])
        if table:  # before the output: what it reports is not done again
            table.add(path, {**row, "key": keys[path]})
        seen = f"failed: {row['error']}" if row["error"] else ", ".join(
            f"{name} {value:.4g}" if isinstance(value, float) else f"{name} {value}" for name, value in row.items()
            if name not in ("error", "warnings", "result") and value is not None)
        _say(f"{number}/{len(outs)} {shown(path)}: {seen}")
        for text in filter(None, str(row.get("warnings", "")).split(" | ")):
            _say(f"    warning: {text}")
    if table and left:
        table.write()
    if getattr(given, "mean", None):
        good = [out for path, out in outs.items() if is_as_written(path)]
        if len(good) < len(outs) - failed:
            _say(f"no mean is made: {shown(next(out for path, out in outs.items() if out not in good))} has been changed since", sys.stderr)
            return 1
        if good:
            mean = Path(given.out) / "mean.ply"
            _write_mean(good, mean, given.mean == "similar")
            if table:
                table.add(mean, {"error": "", "seconds": "", "warnings": "", "result": state(mean), "key": "mean"})
    if failed:
        _say(f"{failed} of {len(outs)} files could not be done", sys.stderr)
    return 1 if failed else 0
