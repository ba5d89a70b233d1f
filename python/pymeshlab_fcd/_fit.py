# SPDX-License-Identifier: GPL-3.0-or-later
"""Fitting a surface onto another one."""
from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _inputs, _meshes
from ._curves import Curve
from ._deformer import Deformer, Plan, Transforms
from ._inputs import Points
from ._kept import Unchanging
from ._meshes import MeshLike
from ._pose import Pose, PoseInfo
from ._progress import Progress, Report, report, shared
from ._warnings import FoldWarning, LandmarkWarning, MatchWarning, NotAtRestWarning, Told, triangles_turned, warn

FitStart = Literal["as_they_lie", "landmarks_rigid", "landmarks_similar", "axes"]
"""How the surface is placed before a fit; see [Fitter][pymeshlab_fcd.Fitter]."""
_STARTS: Final = ("as_they_lie", "landmarks_rigid", "landmarks_similar", "axes")  # in the order of FitStart in vcg_ext/fit.h


@dataclass(frozen=True)
class FitInfo(PoseInfo):
    """The result of a fit. Lengths are in units of the vertices. `energy` and `discretisation_error` of [PoseInfo][pymeshlab_fcd.PoseInfo] are
    not a number here, since the target moves the surface, too."""

    steps: int
    """Number of steps from stiff to soft."""
    rms: float
    """Distance of the matched surface from the target, root mean square."""
    median: float
    """Median of these distances."""
    percentile_95: float
    """95 percent of these distances are within this."""
    matched: float
    """Share of the counting surface that has a counterpart, 0 to 1."""
    counted: float
    """Share of the free surface that counts, with `weights` above 0; the rest was carried along."""
    carried: int
    """Number of separate parts without a counterpart, carried by the parts around."""
    moved: float
    """How far the matched surface moved from rest, median."""
    moved_most: float
    """The largest of these distances."""
    guessed: float
    """Share of the surface that is guessed, 0 to 1: parts without a counterpart, which were carried along."""
    guess_error: float
    """Estimated error of the guessed surface, root mean square, from the bends of the matched one; not a number if it is unknown."""
    check: tuple[float, ...]
    """Distance of each pair of `check` from where it belongs. The fit has not seen these pairs."""
    leave_one_out: tuple[float, ...]
    """With `leave_one_out`: distance of each landmark from where it belongs, in a fit without it."""
    landmarks: int
    """Number of landmarks."""
    landmark_residual: float
    """The largest distance of a landmark from where it belongs."""
    curve_residual: float
    """The largest distance of a vertex or place of `curves` from its curve; 0 without any."""
    landmark_pull: float
    """The largest move of a node to meet all landmarks at the end: large if these contradict each other or the target."""
    both_ways: bool
    """Whether the target was also matched to the surface: on request, or because it fits better."""
    inside_out: bool
    """Whether the surface faces the other way than the target; the target's normals were then flipped."""
    contradicted: tuple[int, ...]
    """Numbers of the landmarks that the others contradict, from 0; with a `landmark_tolerance`, they were left out."""
    target_not_finite: int
    """Number of vertices of the target with a coordinate that is not finite; they and their faces were left out."""
    from_afar: bool
    """Surface and target did not overlap, and the surface was moved onto the target's middle first."""


class Fitted(Pose):
    """A fitted surface, by [fit][pymeshlab_fcd.fit] or a [Fitter][pymeshlab_fcd.Fitter]. It has all that a [Pose][pymeshlab_fcd.Pose] has."""

    _against_contact = "Give landmarks, or raise stiffness."
    _report: dict[str, Any]

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "report": self._report}

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._report = state["report"]

    @functools.cached_property
    def info(self) -> FitInfo:
        """The result. Measured on first use."""
        told, found, contact = self._told, dict(self._report), self._contact_of(None, 4)
        for name in ("diagonal", "beyond", "alone", "landmark_remarks", "target_remarks", "is_misplaced"):
            del found[name]
        return FitInfo(nodes=told["nodes"], iterations=told["iterations"], converged=told["converged"], energy=math.nan,
                       folded=self._check()["folded"], strained=self._check()["strained"],
                       largest_stretch=float(self.stretch().max(initial=1)), seconds=told["seconds_solve"] + told["seconds_map"],
                       contact=contact.triangles, contact_depth=contact.largest_depth, **found)

    def discretisation_error(self, *, progress: Progress = None) -> float:
        """Not a number, since the target moves the surface, and not only Eq. 2.

        Parameters
        ----------
        progress : Progress, optional
            Not used.
        """
        return math.nan

    def _words(self, folded: int) -> list[Told]:
        """Warnings of what not to trust."""
        told = self._report
        found: list[Told] = [(LandmarkWarning, text) for text in told["landmark_remarks"]]
        found += [(MatchWarning, text) for text in told["target_remarks"]]
        if told["matched"] < 0.3 and not told["alone"]:  # most of the shape is a guess
            found.append((MatchWarning, f"Only {100 * told['matched']:.3g} percent of the surface have a counterpart: do not trust the rest. "
                                        "Move the surfaces onto each other first, give landmarks, or raise largest_distance or largest_angle."))
        if told["guessed"] > 0.05 and told["guess_error"] > 0.01 * told["diagonal"]:  # 1 %: no hand misses so much
            found.append((MatchWarning, f"{100 * told['guessed']:.3g} percent of the surface have no counterpart: their place is a guess that may be off "
                                        f"by about {told['guess_error']:.3g}: give landmarks there, or do not trust them."))
        if folded > 0:
            found.append((FoldWarning, f"{triangles_turned(folded)}: the fit folds the surface there. Give landmarks, or raise stiffness."))
        if told["landmark_pull"] > 0.01 * told["diagonal"] and not told["contradicted"]:  # 1 %: no hand misses so much
            found.append((LandmarkWarning, f"The landmarks contradict each other or the target, by {told['landmark_pull']:g}. Look for pairs "
                                           "that are mixed up."))
        if not self._told["converged"] and not told["is_misplaced"]:
            found.append((NotAtRestWarning, "The fit did not converge: raise steps."))
        return found


class Fitter(Unchanging):
    """A surface or a cloud, prepared once and fitted onto others as often as wanted. Any number of threads may fit one Fitter at a time,
    without Python's lock. The same input gives the same bits, for any number of threads. A Fitter can be pickled; the process that uses it
    prepares it again.

    Parameters
    ----------
    vertices : array_like or mesh
        n x 3, or a mesh of trimesh, pyvista, Open3D or pymeshlab.
    faces : array_like, optional
        m x 3 numbers of vertices; None: a cloud, or what the mesh has.
    tags : array_like, optional
        n whole numbers: 0 fixed, 1 free, 2 and up handles, negative outside. None: all is free.
    transforms : Transforms, optional
        `{tag: 4 x 4 matrix or Motion}` of handles, which move as they are told; other handles stay.
    normals : array_like, optional
        n x 3, at rest. They turn with the surface, and tell the sides of a cloud apart. None: those of its faces.
    weights : array_like, optional
        n numbers from 0 to 1, or a mask: how much the match of each vertex counts. Vertices of weight 0 are carried along, not matched: use it
        for parts that the target lacks. None: all counts. Separate parts without a counterpart are carried by the parts around them, whatever
        their weights.
    copy : bool, default True
        False: `vertices` and `normals` are referred to instead of copied, as by a [Deformer][pymeshlab_fcd.Deformer].
    start : {'as_they_lie', 'landmarks_rigid', 'landmarks_similar', 'axes'}, default 'as_they_lie'
        How the whole surface is first moved. `as_they_lie`: not at all; the only choice with fixed vertices or handles. Without an overlap and
        landmarks, the surface is moved onto the target's middle (`FitInfo.from_afar`). If the fit then leaves it strained, it tries to turn
        and scale it first, and a MatchWarning says so. `landmarks_rigid`, `landmarks_similar` (with a scale): by the landmarks, at least
        three. `axes`: middle onto middle and principal axes onto principal axes, in the best of 24 ways.
    stiffness : float, default 1.0
        How rigid the surface is in the end, 1e-6 to 1e6: 1 is the default, 10 is stiff.
    rigidity : float, default 1.0
        Share of the stiffness against stretching, 0 to 1. 1: as rigid as possible, for shapes that bend, like bodies. 0: smooth, for shapes
        that are sheared, scaled or grown all over, like one skull to another. Then only changes of the map from place to place cost, as in a
        thin-plate spline. Large turns need rigidity.
    largest_distance : float, default 0.0
        A place farther than this from the target, in units of the vertices, has no counterpart. 0: no limit.
    largest_angle : float, default 70.0
        In degrees, more than 0 to 180: a place of the target whose normal differs by more is no counterpart.
    landmarks_only : bool, default False
        The surface only follows its landmarks, as rigidly as `rigidity` says; no target is needed.
    both_ways : bool, default False
        Whether the target is also matched to the surface: places of it without surface nearby draw the nearest one. So thin, long parts are
        reached. Leave it off if the target has parts that the surface lacks. False: the fit tries this if it does not reach parts of the target, and
        keeps it if it then reaches them and matches more of the surface.
    landmark_tolerance : float, default 0.0
        How far a landmark may stay from its target, in units of the vertices. 0: it is exact, if the graph is fine enough. Above 0, pairs that
        the others contradict are left out (`FitInfo.contradicted`).
    patches : int, default 150
        How many patches to begin with, from 1.
    smoothness : float, default 0.0058
        How strongly neighbouring parts must turn alike: 0.001 is loose, 0.1 is stiff.
    seed : int, default 1
        Chooses where the first patches are.
    samples : int, default 6000
        How many places of the surface are matched, from 100 to a million.
    steps : int, default 50
        The most steps from stiff to soft, 2 to 10000; the less the surface moves, the fewer it takes.
    threads : int, default 0
        How many to use; 0 is one a core.
    progress : Progress, optional
        Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].

    Raises
    ------
    ValueError
        An argument has the wrong shape, or is out of range, nothing is free, a handle that moves does not exist, or a coordinate is not finite.
    """

    def __init__(
        self,
        vertices: ArrayLike | MeshLike,
        faces: ArrayLike | None = None,
        tags: ArrayLike | None = None,
        transforms: Transforms | None = None,
        *,
        normals: ArrayLike | None = None,
        weights: ArrayLike | None = None,
        copy: bool = True,
        start: FitStart = "as_they_lie",
        stiffness: float = 1.0,
        rigidity: float = 1.0,
        largest_distance: float = 0.0,
        largest_angle: float = 70.0,
        landmarks_only: bool = False,
        both_ways: bool = False,
        landmark_tolerance: float = 0.0,
        patches: int = 150,
        smoothness: float = 0.0058,
        seed: int = 1,
        samples: int = 6000,
        steps: int = 50,
        threads: int = 0,
        progress: Progress = None,
    ) -> None:
        param: dict[str, Any] = {
            "start": _inputs.choice("start", start, _STARTS), "stiffness": _inputs.number("stiffness", stiffness),
            "rigidity": _inputs.number("rigidity", rigidity), "largest_distance": _inputs.number("largest_distance", largest_distance),
            "largest_angle": _inputs.number("largest_angle", largest_angle), "both_ways": _inputs.flag("both_ways", both_ways),
            "landmark_tolerance": _inputs.number("landmark_tolerance", landmark_tolerance),
            "landmarks_only": _inputs.flag("landmarks_only", landmarks_only), "patches": _inputs.whole("patches", patches, 1),
            "smoothness": _inputs.number("smoothness", smoothness), "seed": _inputs.whole("seed", seed, 0),
            "samples": _inputs.whole("samples", samples, 0), "steps": _inputs.whole("steps", steps, 0),
        }

        self._alone: bool = param["landmarks_only"]

        def plan(n: int) -> Plan:
            regions = _inputs.tags(np.ones(n, np.int32) if tags is None else tags, n)
            own = {**param, "weights": _inputs.weights(weights, n)}
            return Plan("fitted", own, regions, _inputs.transforms(transforms, np.unique(regions[regions > 1]).tolist()))

        self._deformer = Deformer._made(vertices, faces, normals, not _inputs.flag("copy", copy), _inputs.whole("threads", threads, 0, 1024),
                                        plan, report(progress))

    @property
    def deformer(self) -> Deformer:
        """The surface: its `vertices`, `faces`, `graph`, and facts about it (`info`)."""
        return self._deformer

    def fit(
        self,
        target_vertices: ArrayLike | MeshLike | None = None,
        target_faces: ArrayLike | None = None,
        *,
        landmarks: Sequence[ArrayLike] | None = None,
        target_normals: ArrayLike | None = None,
        target_weights: ArrayLike | None = None,
        check: Sequence[ArrayLike] | None = None,
        leave_one_out: bool = False,
        curves: Curve | Sequence[Curve | Sequence[ArrayLike]] | None = None,
        progress: Progress = None,
    ) -> Fitted:
        """Fits the surface onto another one, from rest.

        Parameters
        ----------
        target_vertices : array_like or mesh, optional
            k x 3, or a mesh as in `vertices`. It is not changed. Vertices that are not finite are left out. Not read with `landmarks_only`.
        target_faces : array_like, optional
            m x 3 numbers of its vertices; None: a cloud, or what the mesh has.
        landmarks : Sequence[array_like], optional
            Two arrays: numbers of free vertices (or places, which go with the nearest vertices), and the points of the target where they
            belong. Vertices end there exactly, places to about 1e-6 of the diagonal; or all within `landmark_tolerance`.
        target_normals : array_like, optional
            k x 3, of a cloud: they tell its sides apart.
        target_weights : array_like, optional
            k numbers from 0 to 1, or a mask: how much each vertex of the target counts. A vertex of weight 0 is ignored. None: all count.
        check : Sequence[array_like], optional
            Two arrays as in `landmarks`, of any vertices. The fit does not see these pairs; their distance from where they belong judges it
            (`FitInfo.check`).
        leave_one_out : bool, default False
            Also fits without each landmark in turn, and tells its distance from where it belongs (`FitInfo.leave_one_out`). That takes one more
            fit for each.
        curves : Sequence[Sequence[array_like]], optional
            Curves that belong together and slide along each other, such as lips, a ridge or a tooth's margin. Each is two arrays: numbers of
            free vertices (or places, which go with the nearest vertices) in any order, and the k x 3 corners of a polyline on the target,
            in order. A polyline is closed if its last corner is its first. Landmarks hold the ends of an open one. Or pass what
            [read_curves][pymeshlab_fcd.read_curves] reads from a file, with a polyline on each.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].

        Returns
        -------
        Fitted
            The fitted vertices, `Fitted.vertices`, and how good the fit is, `Fitted.info`.

        Raises
        ------
        ValueError
            An argument has the wrong shape, or is out of range, the target is empty, a point, a line, 1e15 times larger or 1e8
            times smaller than the surface, nothing of the surface has a counterpart there, landmarks or curves are not free vertices of the
            surface, landmarks at one place, or the start does not go with them or with the tags.
        RuntimeError
            The fit has no solution in double precision: the surface may be as thin as a line.

        Warns
        -----
        DeformationWarning
            What not to trust: little is matched, flipped triangles, landmarks contradict each other or are too
            dense for the graph, much of the surface is a guess, the target lies far away, is of another size, mirrored or flat, the fit did not converge.
        """
        return self._fit(target_vertices, target_faces, landmarks, target_normals, target_weights, check, leave_one_out, curves,
                         shared(progress), 3)

    def _fit(self, target: object, faces: object, landmarks: Sequence[ArrayLike] | None, normals: ArrayLike | None,
             weights: ArrayLike | None, check: Sequence[ArrayLike] | None, leave_one_out: bool,
             curves: Curve | Sequence[Curve | Sequence[ArrayLike]] | None, told: Progress, level: int) -> Fitted:
        pairs, checks = self._pairs("landmarks", landmarks), self._pairs("check", check)
        lines = self._curves(curves, report(told, 0, 5))
        if self._alone and lines:
            raise ValueError("curves lie on a target: give that, and leave landmarks_only out")
        if self._alone and len(pairs[0]) == 0:
            raise ValueError("there are no landmarks to follow; give some as landmarks, or leave landmarks_only out")
        goal = {} if self._alone else {**self._goal(target, faces, normals, weights), "curves": lines}
        fitting = self._deformer._fitting
        solved, found = fitting.fit(goal, pairs, _inputs.flag("leave_one_out", leave_one_out), report(told, 5, 70))
        found["alone"] = self._alone
        if found["matched"] == 0 and not self._alone:
            known = " ".join(found["landmark_remarks"] + found["target_remarks"])
            raise ValueError("nothing of the surface has a counterpart on the target: move them onto each other first, as start= does by "
                             f"landmarks or axes, or raise largest_distance or largest_angle{known and '. ' + known}")
        made = Fitted(self._deformer, solved)
        made._report = found
        made._write(None, None, report(told, 70, 90), lambda vertices: fitting.put(pairs, vertices))
        found["check"] = tuple(fitting.residuals(solved, checks, made.vertices))
        warn(made._words(made._check(report(told, 90, 100))["folded"]), level)
        made._warn_of_contact(level + 1)
        return made

    def _goal(self, target: object, faces: object, normals: ArrayLike | None, weights: ArrayLike | None) -> dict[str, Any]:
        positions, corners = (np.zeros((0, 3)), None) if target is None else _meshes.surface(target, faces, "target_")[1:]
        if len(positions) == 0:
            raise ValueError("the target has no vertices; give a surface, or points, as target_vertices")
        if normals is not None:  # normals of points that are not finite are not read
            normals = _inputs.rows("target_normals", normals, len(positions), "one for each of target_vertices")
            normals = np.where(np.isfinite(positions).all(axis=1, keepdims=True), normals, 0.0)
        return {"vertices": positions, "faces": corners, "weights": _inputs.weights(weights, len(positions), "target_weights"),
                "normals": None if normals is None else _inputs.normals(normals, len(positions), "target_normals")}

    def _pairs(self, name: str, pairs: Sequence[ArrayLike] | None) -> tuple[NDArray[np.int64], Points, Points]:
        """Numbers of vertices, the targets, and the vectors from the vertices to the landmarks."""
        if pairs is None:
            return np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros((0, 3))
        if not isinstance(pairs, (tuple, list)) or len(pairs) != 2:
            raise TypeError(f"{name} must be a pair: (numbers of vertices or places, k x 3 points where they belong)")
        vertices = self._deformer.vertices
        given = _inputs.points(pairs[0], len(vertices), f"the first of {name}")
        second = f"the second of {name}"
        places = _inputs.finite(second, _inputs.rows(second, pairs[1], len(given), "one for each of the first"))
        if given.ndim == 1:
            return np.asarray(given, np.int64), places, np.zeros_like(places)
        starts = np.asarray(given, np.float64)
        points = self._nearest(starts)
        return points, places, starts - vertices[points]

    def _nearest(self, places: Points) -> NDArray[np.int64]:
        return _core.nearest_vertices(self._deformer.vertices, places, self._deformer._threads, None)

    def _curves(self, curves: Curve | Sequence[Curve | Sequence[ArrayLike]] | None,
                told: Report | None) -> list[tuple[NDArray[np.int64], Points, Points]]:
        """For each curve: numbers of vertices, corners on the target, and the vectors from the vertices to their places."""
        found, lines = [], {}
        for k, curve in enumerate([curves] if isinstance(curves, Curve) else () if curves is None else curves):
            if isinstance(curve, Curve):
                source, corners = _corners(f"the source of curve {k}", curve.source), _corners(f"the target of curve {k}", curve.target)
                lines[k] = str(curve.name).encode("utf-8", "replace"), curve._file, curve._lines, source, corners
                found.append((np.zeros(0, np.int64), corners, source))  # the loop below replaces it
                continue
            if not isinstance(curve, (tuple, list)) or len(curve) != 2:
                raise TypeError(f"curve {k} must be a pair: (numbers of vertices or places, k x 3 corners on the target)")
            given = _inputs.points(curve[0], len(self._deformer.vertices), f"the first of curve {k}")
            corners = _corners(f"the second of curve {k}", curve[1])
            if given.ndim == 1:
                found.append((np.asarray(given, np.int64), corners, np.zeros((0, 3))))
                continue
            places = np.asarray(given, np.float64)
            nearest = self._nearest(places)
            found.append((nearest, corners, places - self._deformer.vertices[nearest]))
        for k, (vertices, offsets) in zip(lines, self._deformer._fitting.along(list(lines.values()), told) if lines else ()):
            found[k] = vertices, found[k][1], offsets
        return found

    def __repr__(self) -> str:
        return f"<Fitter of {len(self._deformer.vertices)} vertices, {self._deformer.info.nodes} nodes>"


def _corners(name: str, values: object) -> Points:
    """The corners of a polyline."""
    corners = _inputs.finite(name, _inputs.rows(name, values))
    if len(corners) < 2:
        raise ValueError(f"{name} has {len(corners)} corners; give two at least, in order")
    return corners


def fit(
    vertices: ArrayLike | MeshLike,
    faces: ArrayLike | MeshLike | None = None,
    target_vertices: ArrayLike | MeshLike | None = None,
    target_faces: ArrayLike | None = None,
    *,
    landmarks: Sequence[ArrayLike] | None = None,
    tags: ArrayLike | None = None,
    transforms: Transforms | None = None,
    normals: ArrayLike | None = None,
    target_normals: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    target_weights: ArrayLike | None = None,
    check: Sequence[ArrayLike] | None = None,
    leave_one_out: bool = False,
    curves: Curve | Sequence[Curve | Sequence[ArrayLike]] | None = None,
    start: FitStart = "as_they_lie",
    stiffness: float = 1.0,
    rigidity: float = 1.0,
    largest_distance: float = 0.0,
    largest_angle: float = 70.0,
    landmarks_only: bool = False,
    both_ways: bool = False,
    landmark_tolerance: float = 0.0,
    patches: int = 150,
    smoothness: float = 0.0058,
    seed: int = 1,
    samples: int = 6000,
    steps: int = 50,
    threads: int = 0,
    progress: Progress = None,
) -> Fitted:
    """Fits a surface onto another one: deforms it, as rigidly as possible, until it lies on triangles or points. Parts without a counterpart
    are carried along. This is a [Fitter][pymeshlab_fcd.Fitter] and its [fit][pymeshlab_fcd.Fitter.fit] in one call. Meshes of other libraries
    bring their faces: `fit(mesh, target)`, or `fit(mesh, target_vertices, target_faces)`.

    Parameters
    ----------
    vertices : array_like or mesh
        n x 3, or a mesh of trimesh, pyvista, Open3D or pymeshlab.
    faces : array_like or mesh, optional
        m x 3 numbers of vertices; None: a cloud, or what the mesh has.
    target_vertices : array_like or mesh, optional
        k x 3, or a mesh.
    target_faces : array_like, optional
        m x 3 numbers of its vertices; None: a cloud, or what the mesh has.
    tags, transforms, normals, weights, start, stiffness, rigidity, largest_distance, largest_angle, landmarks_only, both_ways
        As in [Fitter][pymeshlab_fcd.Fitter].
    landmark_tolerance, patches, smoothness, seed, samples, steps, threads, progress
        As in [Fitter][pymeshlab_fcd.Fitter].
    landmarks, target_normals, target_weights, check, leave_one_out, curves
        As in [Fitter.fit][pymeshlab_fcd.Fitter.fit].

    Returns
    -------
    Fitted
        The fitted vertices, `Fitted.vertices`: the same bits as those of the filter `generate_fcd_fitted_mesh`. Its `map` carries other points
        along, and its `deformation` can be saved.

    Warns
    -----
    DeformationWarning
        What not to trust, as in [Fitter.fit][pymeshlab_fcd.Fitter.fit], which also tells the errors.
    """
    told = shared(progress)
    found, target, corners = _meshes.beside(vertices, faces, target_vertices, target_faces)
    own: Any = found
    fitter = Fitter(vertices, own, tags, transforms, normals=normals, weights=weights, start=start, stiffness=stiffness, rigidity=rigidity,
                    largest_distance=largest_distance, largest_angle=largest_angle, landmarks_only=landmarks_only, both_ways=both_ways, landmark_tolerance=landmark_tolerance,
                    patches=patches, smoothness=smoothness, seed=seed, samples=samples, steps=steps, threads=threads, progress=report(told, 0, 40))
    return fitter._fit(target, corners, landmarks, target_normals, target_weights, check, leave_one_out, curves, report(told, 40, 100), 3)
