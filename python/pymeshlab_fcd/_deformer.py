# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface that is prepared once, and posed as often as wanted."""
from __future__ import annotations

import functools
import importlib
import threading
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Final, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _inputs, _meshes
from ._inputs import Points
from ._kept import Kept, Unchanging
from ._meshes import MeshLike
from ._motion import Motion
from ._numbers import lengths
from ._pose import Pose
from ._progress import Progress, Report, report
from ._warnings import LandmarkWarning, NodeWarning, ScanLineWarning, SlitWarning, Told, VolumeWarning, warn

GraphWeights = Literal["border", "uniform", "paper", "printed"]
Falloff = Literal["smooth", "linear", "sharp", "constant"]
Distances = Literal["surface", "euclidean"]
LooseParts = Literal["follow", "stay"]
Transforms = Mapping[int, Union[Motion, ArrayLike]]
"""For each handle that moves, by its tag: a 4 x 4 matrix (column vectors, world coordinates) or a Motion. Other handles stay."""


@dataclass(frozen=True)
class Graph:
    """The deformation graph at rest, of k nodes."""

    nodes: Points
    """k x 3, where the nodes are: barycentres of patches."""
    edges: NDArray[np.int32]
    """e x 2, pairs of nodes, the smaller first."""
    radius: NDArray[np.float64]
    """k, how far each patch reaches from its centre, along the surface; units of the vertices."""
    centers: Points
    """k x 3, the vertices at the centres of the patches, for the parameter `nodes`."""


@dataclass(frozen=True)
class Weights:
    """The weights by which each of n vertices follows nodes, held regions and landmarks: a sparse matrix of n rows in the CSR format.

    `to_scipy` makes a scipy matrix of it. The first k columns are the nodes of the graph, the next ones the held regions (`tags`; the first, 0,
    is what is fixed or outside), the last ones the landmarks. Each row sums to 1. Only rows of loose parts that follow another part are empty.

    Blending the motions by these weights comes near to a pose, but is not the same: the method blends to second order, and takes the surface's
    stretch into account near held regions.
    """

    indptr: NDArray[np.int64]
    """n + 1, the begin of each vertex in `indices` and `data`."""
    indices: NDArray[np.int32]
    """Columns."""
    data: NDArray[np.float32]
    """Weights, (0, 1]."""
    shape: tuple[int, int]
    """Vertices, and columns."""
    nodes: int
    """How many columns are nodes."""
    tags: tuple[int, ...]
    """The tags of the held regions, in the order of their columns."""

    def to_scipy(self) -> Any:
        """A `scipy.sparse.csr_array` on the same numbers.

        Raises
        ------
        ImportError
            scipy is not installed; nothing else needs it.
        """
        return importlib.import_module("scipy.sparse").csr_array((self.data, self.indices, self.indptr), self.shape)


@dataclass(frozen=True)
class SurfaceInfo:
    """Facts about a surface, as it was read."""

    nodes: int
    """Nodes of the deformation graph."""
    fixed: int
    """Vertices with tag 0."""
    handle: int
    """Vertices with a tag of 2 or more, and landmarks."""
    free: int
    """Vertices with tag 1."""
    outside: int
    """Vertices with a negative tag."""
    components: int
    """Connected parts."""
    loose_parts: int
    """Connected parts without a fixed or handle vertex."""
    welded: int
    """Vertices at the position of another one, which count as one."""
    joined: int
    """Vertices on open borders within `weld_distance` of another one, which count as one."""
    gaps: int
    """Vertices on open borders that are close to another border, but not joined with it."""
    one_sided: int
    """Points of a cloud whose neighbours all lie along their own scan line."""
    unenclosed: int
    """Connected parts that should keep their volume (`elastic`), but enclose none."""
    isolated: int
    """Vertices without a neighbour."""
    non_manifold_edges: int
    """Edges of more than two faces."""
    degenerate_faces: int
    """Faces without an area."""
    placed_nodes: int
    """How many of the given `nodes` lie on the surface, and are used."""
    seconds: float
    """Time of the preparation."""


_CHANGED: Final = ("{} has been changed since it was given with copy=False: give it anew, or leave copy=False out, so that there is a "
                   "copy of it")
_GRAPH_WEIGHTS = {"border": (0, False), "uniform": (1, False), "paper": (1, True), "printed": (2, True)}


@dataclass(frozen=True)
class Plan:
    """How to prepare a surface; after pickling, it is prepared again, with the same bits."""

    kind: Literal["held", "free", "fitted"]
    param: dict[str, Any]
    tags: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    motions: list[tuple[int, str]] = field(default_factory=list)


def renamed_weights(distances: Distances, weights: Distances | None, level: int) -> Distances:
    """The value of `distances`, also by its old name `weights`. level: of the caller, as in warnings.warn"""
    if weights is None:
        return distances
    warnings.warn("the parameter weights is called distances now; this name goes with the next version", DeprecationWarning, level)
    return weights


class Deformer(Unchanging):
    """A surface or a cloud that is prepared to be deformed: read, divided into patches, its graph factorised. A pose then takes a fraction of
    the time. Any number of threads may pose one Deformer at a time, without Python's lock. It does not change, and its arrays are read-only. It
    can be pickled; the process that uses it prepares it again, with the same bits.

    The same input gives the same bits, for any number of threads, and the same as the filters of MeshLab give.

    Parameters
    ----------
    vertices : array_like or mesh
        n x 3 coordinates, or a mesh of trimesh, pyvista, Open3D or pymeshlab. Any kind of numbers, stride or byte order. It is copied, unless
        `copy=False`.
    faces : array_like, optional
        m x 3 numbers of vertices, the corners of triangles. None: a cloud, or what the mesh has.
    tags : array_like, optional
        n whole numbers: 0 fixed, 1 free, 2 and up handles, negative outside (stays, and has no influence). None: all is free but the
        landmarks.
    points : array_like, optional
        Landmarks: points that each pose moves to a place, while the surface turns freely there. k numbers of free vertices, or k x 3 places,
        which stand for the nearest vertices.
    normals : array_like, optional
        n x 3, at rest, which poses turn with the surface. None: poses have those of their faces.
    copy : bool, default True
        False: `vertices` and `normals`, if they are C-contiguous doubles, are referred to instead of copied, which saves 24 bytes a vertex
        each. Do not change them while the Deformer or a pose of it is used: that is an error then.
    smoothness : float, default 0.0058
        How strongly neighbouring parts must turn alike, from 0; 0.001 is loose, 0.1 is stiff (alpha of Eq. 2 of the paper).
    falloff : {'smooth', 'linear', 'sharp', 'constant'}, default 'smooth'
        How the motion of a handle fades towards other held regions. `smooth`: evenly. `linear`: straight, with bends near both ends. `sharp`:
        with a peak at the handle. `constant`: with a plateau around the handle, and the bend far from it.
    elastic : bool, default False
        Each connected part of the free surface keeps its volume, within a thousandth: squeezed parts get thicker, pulled ones thinner. A cloud
        and an open sheet have no volume; a VolumeWarning says so.
    rigidity : float, default 1.0
        Share of the stiffness against stretching, 0 to 1. 1: as rigid as possible, for shapes that bend, like bodies. 0: smooth, for shapes
        that are sheared, scaled or grown all over, like one skull to another by its landmarks. Then only changes of the map from place to place
        cost, as in a thin-plate spline. Large turns need rigidity. Below 1 there is no `elastic` and no `graph_weights="printed"`.
    patches : int, default 0
        Number of patches to begin with; more let the deformation bend in finer detail (k0 of sec. 2.1). 0: as many as the surface needs,
        whatever its number of vertices: about 300 for most, 100 if little bends, up to 1500 if it is thin, folded or torn.
    target_radius : float, default 0.0
        Largest radius of a patch, in units of the vertices, from 0. 0: by the number of patches and the area that can bend (D of sec. 2.1).
    seed : int, default 1
        Chooses where the first patches are, 0 to 2147483647.
    nodes : array_like, optional
        k x 3, centres of patches to use instead of sampling, as `Graph.centers` of another Deformer.
    graph_weights : {'border', 'uniform', 'paper', 'printed'}, default 'border'
        How strongly neighbouring patches hold together (w_ij of Eq. 2). `border`: by their common border. `uniform`: all alike. `paper`: all
        alike, with patches balanced by their vertices. `printed`: the paper to the letter, also in all else.
    distances : {'surface', 'euclidean'}, default 'surface'
        What a node influences. `surface`: near surface that is connected to it. `euclidean`: all near surface, as in the paper (Eq. 8).
    influence : float, default 4.0
        Radius of a node's influence, in radii of its patch, more than 1. Below about 2, patches begin to show (Eq. 8 has 1).
    loose_parts : {'follow', 'stay'}, default 'follow'
        What parts without a handle or fixed vertex do: `follow` the nearest part with one, or `stay`.
    weld_distance : float, default 1e-06
        Vertices on open borders within this fraction of the diagonal count as one, 0 to 0.001.
    max_iterations : int, default 1000
        The most iterations of the solver, from 1.
    tolerance : float, default 1e-05
        The shape is at rest if no node is farther from its final place than ten times this fraction of the diagonal, more than 0.
    threads : int, default 0
        Number of threads, also for its poses; 0 is one a core.
    progress : Progress, optional
        Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].
    weights : {'surface', 'euclidean'}, optional
        The old name of `distances`.

    Raises
    ------
    ValueError
        An argument has the wrong shape, or is out of range, nothing is free, there is no handle, or a coordinate is not finite.
    MemoryError
        There is not enough of it.

    Warns
    -----
    DeformationWarning
        Open borders are close to each other, or nodes do not lie on the surface.
    """

    _starts: Points | None

    def __init__(
        self,
        vertices: ArrayLike | MeshLike,
        faces: ArrayLike | None = None,
        tags: ArrayLike | None = None,
        points: ArrayLike | None = None,
        *,
        normals: ArrayLike | None = None,
        copy: bool = True,
        smoothness: float = 0.0058,
        falloff: Falloff = "smooth",
        elastic: bool = False,
        rigidity: float = 1.0,
        patches: int = 0,
        target_radius: float = 0.0,
        seed: int = 1,
        nodes: ArrayLike | None = None,
        graph_weights: GraphWeights = "border",
        distances: Distances = "surface",
        influence: float = 4.0,
        loose_parts: LooseParts = "follow",
        weld_distance: float = 1e-6,
        max_iterations: int = 1000,
        tolerance: float = 1e-5,
        threads: int = 0,
        progress: Progress = None,
        weights: Distances | None = None,
    ) -> None:
        distances = renamed_weights(distances, weights, 3)
        lent = not _inputs.flag("copy", copy)
        self._take(vertices, faces, normals, lent, _inputs.whole("threads", threads, 0, 1024))
        told = report(progress)
        held = self._hold(tags, points)
        kind, by_vertices = tuple(_GRAPH_WEIGHTS.values())[_inputs.choice("graph_weights", graph_weights, tuple(_GRAPH_WEIGHTS))]
        param: dict[str, Any] = {
            "patches": _inputs.whole("patches", patches, 0),
            "target_radius": _inputs.number("target_radius", target_radius),
            "seed": _inputs.whole("seed", seed, 0),
            "by_vertices": by_vertices,
            "graph_weights": kind,
            "weights": _inputs.choice("distances", distances, ("surface", "euclidean")),
            "influence": _inputs.number("influence", influence),
            "loose_parts": _inputs.choice("loose_parts", loose_parts, ("follow", "stay")),
            "weld_distance": _inputs.number("weld_distance", weld_distance),
            "smoothness": _inputs.number("smoothness", smoothness),
            "falloff": _inputs.choice("falloff", falloff, ("smooth", "linear", "sharp", "constant")),
            "elastic": _inputs.flag("elastic", elastic),
            "rigidity": _inputs.number("rigidity", rigidity),
            "max_iterations": _inputs.whole("max_iterations", max_iterations, 1),
            "tolerance": _inputs.number("tolerance", tolerance),
            "nodes": None if nodes is None else _inputs.finite("nodes", _inputs.rows("nodes", nodes)),
        }
        self._plan = Plan("held", param, held)
        self._prepare(told)
        self._warn(0 if nodes is None else len(param["nodes"]))

    def _hold(self, tags: ArrayLike | None, points: ArrayLike | None) -> NDArray[np.int32]:
        """Takes the landmarks. Returns the tags."""
        n = len(self._vertices.look())
        if points is not None:
            given = _inputs.points(points, n)
            if given.ndim == 2:
                starts = np.asarray(given, np.float64)
                self._starts = starts
                self._points = _inputs.own(_core.nearest_vertices(self._vertices.look(), starts, self._threads, None), np.int64)
            else:
                self._points = np.asarray(given, np.int64)
        if tags is None and len(self._points) == 0:
            raise ValueError(f"nothing is held: give tags ({_inputs.TAGS}), points, or both")
        return _inputs.tags(np.ones(n, np.int32) if tags is None else tags, n)

    def with_tags(self, tags: ArrayLike | None = None, points: ArrayLike | None = None, *, progress: Progress = None) -> Deformer:
        """The same surface with other tags or landmarks, and the same parameters. A region (a connected part of the free surface, with what
        holds it) that stays the same is taken over instead of prepared again. The result has the bits of a new Deformer.

        Parameters
        ----------
        tags : array_like, optional
            As in Deformer.
        points : array_like, optional
            As in Deformer.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].

        Returns
        -------
        Deformer
            Another Deformer; this one does not change.

        Raises
        ------
        ValueError
            As in Deformer, or the surface was prepared to be fitted or straightened.

        Warns
        -----
        DeformationWarning
            As in Deformer.
        """
        if self._plan.kind != "held":
            raise ValueError("this surface was prepared to be moved by something else than handles: make a Deformer of it")
        made = type(self).__new__(type(self))
        made._lock, made._ready, made._threads = threading.Lock(), None, self._threads
        made._mesh, made._left_behind, made._faces = self._mesh, self._left_behind, self._faces
        made._vertices, made._normals = self._vertices, self._normals
        made._starts, made._points = None, _inputs.own(np.zeros(0), np.int64)
        told = report(progress)
        made._plan = Plan("held", self._plan.param, made._hold(tags, points))
        made._prepare(told, self._prepared)
        nodes = self._plan.param["nodes"]
        made._warn(0 if nodes is None else len(nodes))
        return made

    @classmethod
    def _made(cls, vertices: object, faces: object, normals: ArrayLike | None, lent: bool, threads: int, plan: Callable[[int], Plan],
              told: Report | None) -> Deformer:
        """A Deformer that something else than handles moves. plan: for a number of vertices"""
        made = cls.__new__(cls)
        made._take(vertices, faces, normals, lent, threads)
        made._plan = plan(len(made.vertices))
        made._prepare(told)
        return made

    def _take(self, vertices: object, faces: object, normals: ArrayLike | None, lent: bool, threads: int) -> None:
        self._lock = threading.Lock()
        self._ready: tuple[_core.Prepared, _core.Fitting | None] | None = None
        self._threads = threads
        self._mesh, positions, self._faces = _meshes.surface(vertices, faces, lent=lent)
        self._left_behind = ""
        self._vertices = Kept(positions, _CHANGED.format("vertices") if lent else None, threads)
        self._normals = None if normals is None else Kept(_inputs.normals(normals, len(positions), lent=lent),
                                                          _CHANGED.format("normals") if lent else None, threads)
        self._starts = None
        self._points = _inputs.own(np.zeros(0), np.int64)

    def _prepare(self, told: Report | None, kept: _core.Prepared | None = None) -> tuple[_core.Prepared, _core.Fitting | None]:
        plan, vertices = self._plan, self._vertices.look()
        fitting: _core.Fitting | None = None
        if plan.kind == "held":
            prepared = _core.prepare(vertices, self._faces, plan.tags, self._points, plan.param, self._threads, told, kept)
        elif plan.kind == "free":
            prepared = _core.prepare_free(vertices, self._faces, plan.param, self._threads, told)
        else:
            fitting = _core.Fitting(vertices, self._faces, plan.tags, plan.motions, self._rest_normals, plan.param, self._threads, told)
            prepared = fitting.prepared
        self._ready = prepared, fitting
        return self._ready

    def _both(self) -> tuple[_core.Prepared, _core.Fitting | None]:
        self._vertices.look()
        if self._ready is None:  # after pickling
            with self._lock:
                return self._ready or self._prepare(None)
        return self._ready

    @property
    def _prepared(self) -> _core.Prepared:
        return self._both()[0]

    @property
    def _fitting(self) -> _core.Fitting:
        fitting = self._both()[1]
        assert fitting
        return fitting

    @property
    def _rest_normals(self) -> Points | None:
        return None if self._normals is None else self._normals.look()

    def _given_mesh(self) -> object:
        if self._left_behind:
            raise ValueError(f"the mesh that the Deformer was given cannot be pickled (a {self._left_behind}), and was left behind; "
                             "Pose.vertices has the positions")
        if self._mesh is None:
            raise ValueError("the Deformer was given arrays, not a mesh; Pose.vertices has the positions")
        return self._mesh

    def __getstate__(self) -> dict[str, Any]:
        carried = _meshes.can_be_pickled(self._mesh)
        return {"mesh": self._mesh if carried else None, "left_behind": self._left_behind if carried else type(self._mesh).__name__,
                "vertices": self.vertices, "faces": self._faces, "normals": self._rest_normals, "starts": self._starts,
                "points": self._points, "plan": self._plan, "threads": self._threads}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._lock, self._ready = threading.Lock(), None
        self._mesh, self._left_behind, self._threads, self._plan = state["mesh"], state["left_behind"], state["threads"], state["plan"]
        self._vertices, normals, faces = Kept(_inputs.own(state["vertices"], np.float64)), state["normals"], state["faces"]
        self._starts = state["starts"]
        self._normals = None if normals is None else Kept(_inputs.own(normals, np.float64))
        self._faces = None if faces is None else _inputs.own(faces, np.uint32)
        self._points = _inputs.own(state["points"], np.int64)

    @property
    def vertices(self) -> Points:
        """n x 3, at rest, read-only.

        Raises
        ------
        ValueError
            They are your own array (`copy=False`), and you have changed it since.
        """
        return self._vertices.look()

    @property
    def faces(self) -> NDArray[np.uint32] | None:
        """m x 3, read-only; None for a cloud."""
        return self._faces

    @property
    def points(self) -> NDArray[np.int64]:
        """k, read-only: the vertices of the landmarks."""
        return self._points

    def _warn(self, nodes: int) -> None:
        info = self.info
        found: list[Told] = []
        if info.gaps > 3:
            found.append((SlitWarning, f"{info.gaps} vertices on open borders nearly touch another border (within a tenth of their edges): "
                                       "such a slit may open. Weld the surface first, or raise weld_distance."))
        if 100 * info.one_sided > info.free:
            found.append((ScanLineWarning, f"{info.one_sided} points have neighbours only on their own scan line, so the lines are hardly "
                                           "connected. If this is a surface, first thin out the points along the lines."))
        if info.unenclosed > 0:
            found.append((VolumeWarning, f"{info.unenclosed} connected free parts enclose no volume that elastic could keep: a cloud, or a surface "
                                         "with open borders in its free part. They bend as without elastic."))
        if info.placed_nodes < nodes:
            found.append((NodeWarning, f"{nodes - info.placed_nodes} of the {nodes} nodes do not lie on the free surface, and are left out."))
        if self._starts is not None and len(self._starts):
            vertices = self._vertices.look()
            off, size = lengths(self._starts - vertices[self._points]), lengths(np.ptp(vertices, axis=0)[None])[0]
            farthest = int(off.argmax())
            if off[farthest] > size:
                found.append((LandmarkWarning, f"Landmark {farthest}, counted from 0, is {off[farthest]:g} from the surface, which is {size:g} large. "
                                               "The vertex nearest to it moves as it does. Look whether its coordinates are right."))
        if len(self._points) > 1 and info.fixed == 0 and info.handle == len(self._points) and self._turns_about_landmarks():
            found.append((LandmarkWarning, "The landmarks lie on one line, and nothing else holds the surface: nothing says how it turns about that "
                                           "line. Add a landmark beside it."))
        warn(found, 3)

    def _turns_about_landmarks(self) -> bool:
        """Whether the landmarks lie on a line: within a hundredth of their extent, which leaves the turn about it to rounding and noise."""
        at = self._vertices.look()[self._points]
        spread = np.linalg.svd(at - at.mean(axis=0), compute_uv=False)
        return bool(spread[1] <= 0.01 * spread[0])

    def pose(
        self,
        transforms: Transforms | None = None,
        *,
        landmarks: ArrayLike | None = None,
        percent: float = 100.0,
        steps: int = 1,
        start: Pose | None = None,
        out: Points | None = None,
        out_normals: Points | None = None,
        check: bool = True,
        progress: Progress = None,
    ) -> Pose:
        """Moves the handles; the free surface follows.

        Parameters
        ----------
        transforms : Transforms, optional
            `{tag: 4 x 4 matrix or Motion}`; handles that are not in it stay.
        landmarks : array_like, optional
            k x 3, where the `points` go; None: they stay.
        percent : float, default 100.0
            Share of all motions that is made: 0 is none, 100 is all; it may be more, or less than 0.
        steps : int, default 1
            The least number of steps to the pose, 1 to 1000. Each is bent from the one before. If there are several shapes, this finds the one
            that develops continuously from rest. There are more steps if handles would turn by more than 60 degrees in one.
        start : Pose, optional
            A pose of this Deformer to begin from, instead of rest. Handles move from there as in a blend of both.
        out : ndarray, optional
            n x 3 doubles, C-contiguous: becomes `Pose.vertices`, instead of a new array. Once you write to it again, reading this pose's
            `vertices` is an error.
        out_normals : ndarray, optional
            The same for `Pose.normals`, which are then computed at once.
        check : bool, default True
            Whether to warn of flipped triangles, and of triangles that pass through others. In more than 250 thousand triangles, only
            `Pose.contact` and `Pose.info` look for the latter, since that takes longer than the pose.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].

        Raises
        ------
        ValueError
            An argument has the wrong shape, or is out of range, or a handle that moves does not exist.
        KeyboardInterrupt
            Ctrl-C, at once; `out` may have been written to, and nothing else is half done.

        Warns
        -----
        DeformationWarning
            Nothing moves, the shape did not converge, or the check found something.
        """
        return self._pose(transforms, landmarks, percent, steps, start, out, out_normals, check, progress, 4)

    def percent_to_contact(
        self,
        transforms: Transforms | None = None,
        *,
        landmarks: ArrayLike | None = None,
        percent: float = 100.0,
        steps: int = 1,
        progress: Progress = None,
    ) -> float:
        """How much of the motions can be made before the surface passes through itself, for `percent` of [pose][pymeshlab_fcd.Deformer.pose],
        to a hundredth of them. Found by bisection, in eight poses. If the surface passes through itself and comes out again, the result is the
        end of one of the free ranges.

        Parameters
        ----------
        transforms, landmarks, percent, steps, progress
            As in [pose][pymeshlab_fcd.Deformer.pose].

        Returns
        -------
        float
            `percent`, if all of it is free; else less; 0 is rest.

        Raises
        ------
        ValueError
            An argument has the wrong shape, or is out of range, or a handle that moves does not exist.
        """
        told, tries = report(progress), 0
        wanted = _inputs.number("percent", percent)

        def is_free(hundredths: int) -> bool:
            nonlocal tries
            begin, end = 100 * tries // 8, 100 * (tries + 1) // 8
            tries += 1
            made = self._pose(transforms, landmarks, wanted * hundredths / 100, steps, None, None, None, False,
                              _part(told, begin, (begin + end) // 2), 0)
            return len(made._core.contact(made.vertices, _part(told, (begin + end) // 2, end))[0]) == 0

        if is_free(100):
            return wanted
        last, first = 0, 100
        while first - last > 1:
            middle = (last + first) // 2
            if is_free(middle):
                last = middle
            else:
                first = middle
        return wanted * last / 100

    def _pose(self, transforms: object, landmarks: object, percent: object, steps: object, start: object, out: object, out_normals: object,
              check: object, progress: Progress, level: int) -> Pose:
        if self._plan.kind == "free":
            raise ValueError("this surface was prepared to be bent along a line, not to be posed: make a Deformer of its vertices and faces")
        rest = self.vertices
        n = len(rest)
        targets: Points | None = None
        if landmarks is not None:
            if len(self._points) == 0:
                raise ValueError("landmarks are where the points go: give the Deformer points, numbers of vertices or places")
            targets = _inputs.finite("landmarks", _inputs.rows("landmarks", landmarks, len(self._points), "one for each of points"))
            if self._starts is not None:  # the vertex moves by the same vector as the place
                targets = targets + (rest[self._points] - self._starts)
        begin: _core.Posed | None = None
        if start is not None:
            if not isinstance(start, Pose) or start.deformer is not self:
                raise TypeError(f"start must be a Pose of this Deformer; it is {'one of another' if isinstance(start, Pose) else f'a {type(start).__name__}'}")
            begin = start._core
        checked = _inputs.flag("check", check)
        vertices = None if out is None else _inputs.written("out", out, n)
        turned = None if out_normals is None else _inputs.written("out_normals", out_normals, n)
        for name, array in (("out", out), ("out_normals", out_normals)):
            if array is not None and any(kept is not None and np.shares_memory(array, kept) for kept in (rest, self._rest_normals)):
                raise ValueError(f"{name} must be another array than what the Deformer refers to: np.empty_like(vertices)")
        moves = _inputs.transforms(transforms, self.handles)
        told = report(progress)
        solved = _core.solve(self._prepared, moves, targets, _inputs.number("percent", percent), _inputs.whole("steps", steps, 1, 1000),
                             begin, _part(told, 0, 50))
        pose = Pose(self, solved)
        pose._write(vertices, turned, _part(told, 50, 90))
        if level:  # 0: only a trial
            pose._warn(checked, _part(told, 90, 100), level)
        return pose

    @property
    def handles(self) -> tuple[int, ...]:
        """The tags of the handles, ascending."""
        return tuple(self.centers)

    @functools.cached_property
    def centers(self) -> Mapping[int, tuple[float, float, float]]:
        """The mean of the vertices of each handle, by its tag: the default pivot of a Motion."""
        return MappingProxyType(self._prepared.centers())

    @functools.cached_property
    def info(self) -> SurfaceInfo:
        """Facts about the surface, as it was read."""
        return SurfaceInfo(**self._prepared.report())

    @functools.cached_property
    def graph(self) -> Graph:
        """The deformation graph at rest; its arrays are read-only."""
        nodes, edges, radius, centers = self._prepared.graph()
        return Graph(_inputs.own(nodes, np.float64), _inputs.own(edges, np.int32), _inputs.own(radius, np.float64),
                     _inputs.own(centers, np.float64))

    @functools.cached_property
    def patch_of(self) -> NDArray[np.int32]:
        """n, read-only: the patch (the node of the graph) of each vertex; -1 if it is in none."""
        return _inputs.own(self._prepared.patch_of(), np.int32)

    def weights(self, *, progress: Progress = None) -> Weights:
        """The weights by which each vertex follows nodes, held regions and landmarks.

        Parameters
        ----------
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].
        """
        indptr, indices, data, tags = self._prepared.weights(report(progress))
        columns = self.info.nodes + len(tags) + len(self._points)
        return Weights(_inputs.own(indptr, np.int64), _inputs.own(indices, np.int32), _inputs.own(data, np.float32),
                       (len(self.vertices), columns), self.info.nodes, tuple(tags))

    def __repr__(self) -> str:
        points = f", {len(self._points)} points" if len(self._points) else ""
        return f"<Deformer of {len(self._vertices.look())} vertices, {self.info.nodes} nodes, handles {list(self.handles)}{points}>"


def _part(told: Any, begin: int, end: int) -> Any:
    return None if told is None else lambda percent, stage: told(begin + percent * (end - begin) // 100, stage)
