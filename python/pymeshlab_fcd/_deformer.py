# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface that is prepared once, and posed as often as wanted."""
from __future__ import annotations

import functools
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _inputs, _meshes
from ._inputs import Points
from ._motion import Motion
from ._pose import DeformationWarning, Pose
from ._progress import Progress, report

GraphWeights = Literal["border", "uniform", "paper", "printed"]
Weighing = Literal["surface", "euclidean"]
LooseParts = Literal["follow", "stay"]
Transforms = Mapping[int, Union[Motion, ArrayLike]]
"""Of each handle that moves: its tag, and a 4 x 4 matrix (column vectors, world coordinates) or a Motion. Other handles stay."""


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
    """k x 3, the vertices at the centres of the patches: what the parameter `nodes` takes."""


@dataclass(frozen=True)
class Weights:
    """What each of n vertices follows, as a sparse matrix of n rows in the CSR format.

    `scipy.sparse.csr_array((weights.data, weights.indices, weights.indptr), weights.shape)` makes it one of scipy. The first k columns are
    the nodes of the graph, the next ones the held regions (`tags`, 0 first: what is fixed or outside), the last ones the landmarks. Each
    row's sum is 1, but for loose parts that follow another part: their rows are empty.

    Blending the nodes' motions with them comes near to a pose, but is not the same: the method blends to second order, and stretches
    what runs into held regions with the surface.
    """

    indptr: NDArray[np.int64]
    """n + 1, where each vertex begins."""
    indices: NDArray[np.int32]
    """Columns."""
    data: NDArray[np.float32]
    """Weights, (0, 1]."""
    shape: tuple[int, int]
    """Vertices, and columns."""
    nodes: int
    """How many columns are nodes."""
    tags: tuple[int, ...]
    """Those of the held regions, in the order of their columns."""


@dataclass(frozen=True)
class SurfaceInfo:
    """What a surface is, as it was read."""

    nodes: int
    """Of the deformation graph."""
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
    """Vertices at the place of another, which count as one."""
    joined: int
    """Vertices on open borders a hair from another, which count as one."""
    gaps: int
    """Vertices on open borders that are close to another border, and are not joined with it."""
    one_sided: int
    """Points of a cloud that see others along their own line alone."""
    isolated: int
    """Vertices without a neighbour."""
    non_manifold_edges: int
    """Edges of more than two faces."""
    degenerate_faces: int
    """Faces without an area."""
    placed_nodes: int
    """How many of the given `nodes` lie on the surface, and are used."""
    seconds: float
    """That preparing took."""


_GRAPH_WEIGHTS = {"border": (0, False), "uniform": (1, False), "paper": (1, True), "printed": (2, True)}


class Deformer:
    """A surface or a cloud that is prepared to be deformed: read, divided into patches, its graph factorised. A pose then takes a
    fraction of the time. Any number of threads may pose one Deformer at a time; Python's lock is free while it works.

    The same input gives the same bits, for any number of threads, and the same as the filters of MeshLab give.

    Args:
        vertices: n x 3 coordinates, or a mesh of trimesh, pyvista, Open3D or pymeshlab. C-contiguous doubles are not copied but
            referred to: do not change them while the Deformer is used. Everything else (any kind of numbers, stride, byte order) is
            copied once.
        faces: m x 3 numbers of vertices, the corners of triangles. None: a cloud, or what the mesh has.
        tags: n whole numbers: 0 fixed, 1 free, 2 and up handles, negative outside (stays, and has no influence). None: all is free
            but the landmarks.
        points: Landmarks, which are put somewhere, while how the surface turns there is left to it: k numbers of free vertices, or
            k x 3 places, of which the nearest vertices are taken.
        normals: n x 3, at rest, which poses turn with the surface. None: poses have those of their faces.
        smoothness: How strongly neighbouring parts must turn alike, from 0; 0.001 is loose, 0.1 is stiff (alpha of Eq. 2 of the
            paper).
        patches: How many patches to begin with; more let the deformation bend in finer detail (k0 of sec. 2.1). 0: 300, or 4800 where
            the surface is so thin or torn that 300 would bend it otherwise.
        target_radius: How far a patch may reach from its centre, in units of the vertices, from 0. 0: from the number of patches
            and the area that can bend (D of sec. 2.1).
        seed: Chooses where the first patches are, 0 to 2147483647.
        nodes: k x 3, centres of patches to use instead of sampling, as `Graph.centers` of another Deformer.
        graph_weights: How strongly neighbouring patches hold together: `border` by their common border, `uniform` all alike, `paper` the
            same with patches balanced by their vertices, `printed` the paper to the letter in all else, too (w_ij of Eq. 2, which is
            1 in the paper).
        weights: What a node may influence: `surface` what is connected to it, `euclidean` whatever is near, as the paper has it (Eq. 8).
        influence: How far a node reaches, in radii of its patch, more than 1; below about 2 the patches begin to show (Eq. 8 has 1).
        loose_parts: What becomes of parts without a handle or fixed vertex: `follow` the nearest part that has one, or `stay`.
        weld_distance: Vertices on open borders that are no farther apart than this fraction of the diagonal count as one, 0 to
            0.001.
        max_iterations: The shape is improved at most this often, from 1.
        tolerance: At rest is where no node is farther from where it comes to rest than ten times this fraction of the diagonal,
            more than 0.
        threads: How many to use; 0 is one a core.
        progress: Told what is being done; see [Progress][pymeshlab_fcd.Progress].

    Raises:
        TypeError: Something is of another kind than what is asked for here.
        ValueError: It has another shape or is out of range, nothing is free, there is no handle, or a coordinate is not finite.
        MemoryError: There is not enough of it.
        KeyboardInterrupt: Ctrl-C, at once; nothing is half done.

    Warns:
        DeformationWarning: Open borders are close to each other, or nodes do not lie on the surface.
    """

    def __init__(
        self,
        vertices: ArrayLike | object,
        faces: ArrayLike | None = None,
        tags: ArrayLike | None = None,
        points: ArrayLike | None = None,
        *,
        normals: ArrayLike | None = None,
        smoothness: float = 0.0058,
        patches: int = 0,
        target_radius: float = 0.0,
        seed: int = 1,
        nodes: ArrayLike | None = None,
        graph_weights: GraphWeights = "border",
        weights: Weighing = "surface",
        influence: float = 4.0,
        loose_parts: LooseParts = "follow",
        weld_distance: float = 1e-6,
        max_iterations: int = 1000,
        tolerance: float = 1e-5,
        threads: int = 0,
        progress: Progress = None,
    ) -> None:
        self._mesh, positions, corners = _surface(vertices, faces)
        self.vertices: Points = positions
        """n x 3, at rest: the caller's own array where it is one of C-contiguous doubles."""
        n = len(self.vertices)
        self.faces: NDArray[np.uint32] | None = corners
        """m x 3, None for a cloud."""
        at: NDArray[np.int64] = np.zeros(0, np.int64)
        starts: Points | None = None
        if points is not None:
            given = _inputs.points(points, n)
            if given.ndim == 2:
                starts = _finite("points", np.asarray(given, np.float64))
                at = _core.nearest_vertices(self.vertices, starts)
            else:
                at = np.asarray(given, np.int64)
        if tags is None and len(at) == 0:
            raise ValueError(f"nothing is held: give tags ({_inputs.TAGS}), points, or both")
        self._starts = starts
        self._normals = None if normals is None else _inputs.normals(normals, n)
        kind, by_vertices = tuple(_GRAPH_WEIGHTS.values())[_inputs.choice("graph_weights", graph_weights, tuple(_GRAPH_WEIGHTS))]
        param: dict[str, Any] = {
            "patches": _inputs.whole("patches", patches, 0),
            "target_radius": _inputs.single("target_radius", target_radius),
            "seed": _inputs.whole("seed", seed, 0),
            "by_vertices": by_vertices,
            "graph_weights": kind,
            "weights": _inputs.choice("weights", weights, ("surface", "euclidean")),
            "influence": _inputs.single("influence", influence),
            "loose_parts": _inputs.choice("loose_parts", loose_parts, ("follow", "stay")),
            "weld_distance": _inputs.single("weld_distance", weld_distance),
            "smoothness": _inputs.single("smoothness", smoothness),
            "max_iterations": _inputs.whole("max_iterations", max_iterations, 1),
            "tolerance": _inputs.single("tolerance", tolerance),
            "nodes": None if nodes is None else _finite("nodes", _inputs.rows("nodes", nodes)),
        }
        self._core = _core.prepare(self.vertices, corners, _inputs.tags(np.ones(n, np.int32) if tags is None else tags, n), at, param,
                                   _inputs.whole("threads", threads, 0, 1024), report(progress))
        self.points: NDArray[np.int64] = at
        """k, the vertices of the landmarks."""
        self._warn(0 if nodes is None else len(param["nodes"]))

    @classmethod
    def _made(cls, vertices: object, faces: ArrayLike | None, normals: ArrayLike | None,
              prepare: Callable[[Points, NDArray[np.uint32] | None, Points | None], _core.Prepared]) -> Deformer:
        """What something else prepares of vertices, faces and normals, to be moved by that."""
        made = cls.__new__(cls)
        made._mesh, made.vertices, made.faces = _surface(vertices, faces)
        made._starts = None
        made._normals = None if normals is None else _inputs.normals(normals, len(made.vertices))
        made.points = np.zeros(0, np.int64)
        made._core = prepare(made.vertices, made.faces, made._normals)
        return made

    def _warn(self, nodes: int) -> None:
        info = self.info
        if info.gaps > 3:
            warnings.warn(f"{info.gaps} vertices on open borders lie closer to another border than a tenth of their edges, and nothing "
                          "joins the two: such a slit may open. Weld the surface first, or raise weld_distance.", DeformationWarning, 3)
        if 100 * info.one_sided > info.free:
            warnings.warn(f"{info.one_sided} points see others along their own line alone, so that lines hang together only here and "
                          "there. If this is a surface, thin out the points along the lines first.", DeformationWarning, 3)
        if info.placed_nodes < nodes:
            warnings.warn(f"{nodes - info.placed_nodes} of the {nodes} nodes do not lie on the free surface, and are left out.",
                          DeformationWarning, 3)

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
        """Moves the handles, and lets the free surface follow.

        Args:
            transforms: `{tag: 4 x 4 matrix or Motion}`; handles that are not in it stay.
            landmarks: k x 3, where the `points` go; None: they stay.
            percent: How much of all motions is carried out: 0 is none, and 100 all; it may be more, or less than 0.
            steps: The pose is reached over so many, 1 to 1000, each bent from the one before, which finds the shape that grows out
                of that at rest where there are several.
            start: A pose of this Deformer to go on from, instead of from rest.
            out: n x 3 doubles, C-contiguous: written to and used for `Pose.vertices`, instead of a new array.
            out_normals: The same for `Pose.normals`, which are then computed at once.
            check: Also look for what is probably not meant (triangles that turned over), and warn of it.
            progress: Told what is being done; see [Progress][pymeshlab_fcd.Progress].

        Raises:
            TypeError: Something is of another kind than what is asked for here.
            ValueError: It has another shape or is out of range, or a handle that moves does not exist.
            KeyboardInterrupt: Ctrl-C, at once; then `out` may have been written to, and nothing else is half done.

        Warns:
            DeformationWarning: Nothing moves, the shape did not come to rest, or the check found something.
        """
        return self._pose(transforms, landmarks, percent, steps, start, out, out_normals, check, progress, 4)

    def _pose(self, transforms: object, landmarks: object, percent: object, steps: object, start: object, out: object, out_normals: object,
              check: bool, progress: Progress, level: int) -> Pose:
        n = len(self.vertices)
        targets: Points | None = None
        if landmarks is not None:
            if len(self.points) == 0:
                raise ValueError("landmarks are where the points go: give the Deformer points, numbers of vertices or places")
            targets = _finite("landmarks", _inputs.rows("landmarks", landmarks, len(self.points), "one for each of points"))
            if self._starts is not None:  # the vertex goes as far as the place that it is nearest to
                targets = targets + (self.vertices[self.points] - self._starts)
        if start is not None:
            if not isinstance(start, Pose) or start.deformer is not self:
                raise TypeError(f"start must be a Pose of this Deformer; it is {'one of another' if isinstance(start, Pose) else f'a {type(start).__name__}'}")
            if steps != 1:
                raise ValueError("steps lead from rest; with start, pose in a loop, each from the one before")
        if not isinstance(check, (bool, np.bool_)):
            raise TypeError(f"check must be True or False; it is {check!r}")
        vertices = np.empty((n, 3)) if out is None else _inputs.written("out", out, n)
        turned = None if out_normals is None else _inputs.written("out_normals", out_normals, n)
        for name, array in (("out", out), ("out_normals", out_normals)):
            if array is not None and (np.shares_memory(array, self.vertices) or
                                      (self._normals is not None and np.shares_memory(array, self._normals))):
                raise ValueError(f"{name} must be another array than what the Deformer refers to: np.empty_like(vertices)")
        moves = _inputs.transforms(transforms, self.handles)
        told = report(progress)
        solved = _core.solve(self._core, moves, targets, _inputs.single("percent", percent), _inputs.whole("steps", steps, 1, 1000),
                             None if start is None else start._core, _part(told, 0, 50))
        pose = Pose(self, solved, vertices)
        pose._write(turned, _part(told, 50, 90))
        pose._warn(check, _part(told, 90, 100), level)
        return pose

    @property
    def handles(self) -> tuple[int, ...]:
        """The tags of the handles, ascending."""
        return tuple(self.centers)

    @functools.cached_property
    def centers(self) -> dict[int, tuple[float, float, float]]:
        """The mean of the vertices of each handle, by its tag: what a Motion turns and scales about."""
        return self._core.centers()

    @functools.cached_property
    def info(self) -> SurfaceInfo:
        """What the surface is, as it was read."""
        return SurfaceInfo(**self._core.report())

    @functools.cached_property
    def graph(self) -> Graph:
        """The deformation graph at rest."""
        return Graph(*self._core.graph())

    @functools.cached_property
    def patch_of(self) -> NDArray[np.int32]:
        """n, the patch (the node of the graph) of each vertex; -1 where it is in none."""
        return self._core.patch_of()

    def weights(self, *, progress: Progress = None) -> Weights:
        """What each vertex follows.

        Args:
            progress: Told what is being done; see [Progress][pymeshlab_fcd.Progress].
        """
        indptr, indices, data, tags = self._core.weights(report(progress))
        columns = self.info.nodes + len(tags) + len(self.points)
        return Weights(indptr, indices, data, (len(self.vertices), columns), self.info.nodes, tuple(tags))

    def __repr__(self) -> str:
        return f"<Deformer of {len(self.vertices)} vertices, {self.info.nodes} nodes, handles {list(self.handles)}>"


def _surface(vertices: object, faces: ArrayLike | None, whose: str = "") -> tuple[object, Points, NDArray[np.uint32] | None]:
    """The mesh of another library, if it is one; positions, corners."""
    mesh: object = None
    taken = _meshes.taken(vertices)
    if taken is not None:
        if faces is not None:
            raise TypeError(f"{whose}faces cannot be given beside a mesh, which has its own; give mesh.vertices and faces")
        mesh = vertices
        vertices, faces = taken
    positions = _inputs.rows(f"{whose}vertices", vertices, what="one row per vertex")
    return mesh, positions, _inputs.triangles(faces, len(positions), f"{whose}faces")


def _finite(name: str, values: Points) -> Points:
    if not np.isfinite(values).all():
        raise ValueError(f"{name} must be finite numbers")
    return values


def _part(told: Any, begin: int, end: int) -> Any:
    return None if told is None else lambda percent, stage: told(begin + percent * (end - begin) // 100, stage)
