# SPDX-License-Identifier: GPL-3.0-or-later
"""A pose of a surface."""
from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _inputs, _meshes
from ._contact import UNASKED, Contact
from ._deformation import Deformation
from ._inputs import Points
from ._kept import Kept, Unchanging
from ._progress import Progress, Report, report
from ._warnings import (AccuracyWarning, FoldWarning, NotAtRestWarning, NothingMovesWarning, OverruledWarning, RigidWarning, StretchWarning,
                        Told, VolumeWarning, triangles_turned, warn)

if TYPE_CHECKING:
    from ._deformer import Deformer

_OVERWRITTEN: Final = ("the array that this pose was written to ({}) has been written to since: pose again, or give each pose an array of "
                       "its own")


@dataclass(frozen=True)
class PoseInfo:
    """The result of a pose."""

    nodes: int
    """Nodes of the deformation graph."""
    iterations: int
    """Iterations of the solver, in all steps."""
    converged: bool
    """Whether the shape came to rest."""
    energy: float
    """Energy (Eq. 2 of the paper), in squares of the units of the vertices."""
    folded: int
    """Triangles that are flipped."""
    strained: int
    """Edges between two held regions that became at most half or at least twice as long."""
    largest_stretch: float
    """The largest of [stretch][pymeshlab_fcd.Pose.stretch]."""
    seconds: float
    """Time of the pose, without the check."""
    contact: int = field(kw_only=True)
    """Triangles that pass through the surface, and did not at rest; see [Pose.contact][pymeshlab_fcd.Pose.contact]."""
    contact_depth: float = field(kw_only=True)
    """The largest depth of contact, in units of the vertices."""
    _error: Callable[[], float] = field(default=lambda: math.nan, repr=False, compare=False, kw_only=True)

    @property
    def discretisation_error(self) -> float:
        """See [Pose.discretisation_error][pymeshlab_fcd.Pose.discretisation_error]; computed on first use."""
        return self._error()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_error": self._error()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        error = float(state["_error"])
        self.__dict__.update({**state, "_error": functools.partial(float, error)})


class _Solved:
    """The solution of a pose, without its arrays; after pickling, bytes until it is needed."""

    def __init__(self, deformer: Deformer, solved: _core.Posed | bytes, error: float | None = None) -> None:
        self.deformer, self._solved, self._error = deformer, solved, error

    def __getstate__(self) -> dict[str, Any]:
        solved = self._solved
        return {"deformer": self.deformer, "_solved": solved if isinstance(solved, bytes) else solved.state(), "_error": self._error}

    @property
    def core(self) -> _core.Posed:
        prepared = self.deformer._prepared
        if isinstance(self._solved, bytes):
            self._solved = _core.restore(prepared, self._solved)
        return self._solved

    def error(self, progress: Progress = None) -> float:
        if self._error is None:
            self._error = self.core.discretisation_error(report(progress))
        return self._error


class Pose(Unchanging):
    """A pose of a surface, by [Deformer.pose][pymeshlab_fcd.Deformer.pose]. It does not change, and its arrays are read-only. It can be pickled
    with its Deformer, which is prepared again only if it is needed."""

    _against_contact: ClassVar[str] = "Move the handles less."
    """What to do about contact, for the warning."""

    def __init__(self, deformer: Deformer, core: _core.Posed) -> None:
        self._deformer = deformer
        self._solved = _Solved(deformer, core)
        self._told = core.info()
        self._found: dict[str, Any] | None = None
        self._contact: Contact | None = None
        self._normals: Kept | None = None
        self._vertices: Kept

    @property
    def deformer(self) -> Deformer:
        """The surface that was posed."""
        return self._deformer

    @property
    def vertices(self) -> Points:
        """n x 3, read-only. Fixed and outside vertices keep their bits; handles are exactly where their motions put them.

        Raises
        ------
        ValueError
            They are in your array (`out`), and you have written to it since.
        """
        return self._vertices.look()

    @property
    def _core(self) -> _core.Posed:
        return self._solved.core

    def __getstate__(self) -> dict[str, Any]:
        state = {"solved": self._solved, "told": self._told, "found": self._found, "vertices": self.vertices}
        if self._normals is not None:
            state["normals"] = self._normals.look()
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._solved, self._told, self._found = state["solved"], state["told"], state["found"]
        self._contact = None
        self._deformer, self._vertices = self._solved.deformer, Kept(_inputs.own(state["vertices"], np.float64))
        self._normals = Kept(_inputs.own(state["normals"], np.float64)) if "normals" in state else None

    def _write(self, out: Points | None, out_normals: Points | None, told: Report | None,
               change: Callable[[Points], None] | None = None) -> None:
        """Maps the pose to the vertices. change: called with them afterwards"""
        deformer = self._deformer
        rest = deformer._rest_normals
        if out_normals is not None:
            if rest is None and deformer.faces is None:
                raise ValueError("a cloud has no normals of its own: give the Deformer those at rest, normals=")
            if out is not None and np.shares_memory(out_normals, out):
                raise ValueError("out_normals must be another array than out")
        vertices = np.empty_like(deformer.vertices) if out is None else out
        self._core.write(vertices, rest if out_normals is not None else None, out_normals if rest is not None else None, told)
        if change:
            change(vertices)
        if out_normals is not None:
            if rest is None:
                deformer._prepared.normals_of(vertices, out_normals)
            self._normals = Kept(out_normals, _OVERWRITTEN.format("out_normals"), deformer._threads)
        self._vertices = Kept(vertices, None if out is None else _OVERWRITTEN.format("out"), deformer._threads)
        self._told = self._core.info()

    def _check(self, told: Report | None = None) -> dict[str, Any]:
        if self._found is None:
            self._found = self._core.check(self.vertices, told)
        return self._found

    def _contact_of(self, told: Report | None, level: int) -> Contact:
        """Looks for contact, if that was not done yet, and warns of it."""
        if self._contact is None:
            faces, pairs, largest, depth = self._core.contact(self.vertices, told)
            if depth is None:
                depth = np.zeros(len(self.vertices))
            for each in (faces, depth):
                each.flags.writeable = False
            self._contact = Contact(faces, pairs, largest, depth)
            warn(self._contact._words(self._against_contact), level)
        return self._contact

    def _warn_of_contact(self, level: int) -> None:
        faces = self._deformer.faces
        if faces is not None and len(faces) <= UNASKED:
            self._contact_of(None, level + 1)

    def _warn(self, check: bool, told: Report | None, level: int) -> None:
        found: list[Told] = []
        if not self._told["moves"]:
            found.append((NothingMovesWarning, "No handle moves: all motions lead to where the handles are already. Give other motions."))
        if not self._told["converged"]:
            found.append((NotAtRestWarning, "The deformation did not converge: raise max_iterations, or tolerance, or move the handles "
                                            "less at a time (steps)."))
        if check:
            found += _describe(self._check(told))
        elif told:
            told(100, "Done")
        warn(found, level)
        if check:
            self._warn_of_contact(level + 1)

    @property
    def normals(self) -> Points:
        """n x 3, read-only. If the Deformer has normals at rest: these, turned with the surface, with their lengths kept. If not: the means of
        the faces' normals in this pose, weighed by their angles, of length 1 (0 at a vertex without a face).

        Raises
        ------
        ValueError
            A cloud without normals at rest, or they are in your array (`out_normals`), and you have written to it since.
        """
        if self._normals is None:
            rest = self._deformer._rest_normals
            if rest is not None:
                turned = np.empty_like(rest)
                self._core.write(np.empty_like(rest), rest, turned, None)
            elif self._deformer.faces is None:
                raise ValueError("a cloud has no normals of its own: give the Deformer those at rest, normals=")
            else:
                vertices = self.vertices
                turned = np.empty_like(vertices)
                self._deformer._prepared.normals_of(vertices, turned)
            self._normals = Kept(turned)
        return self._normals.look()

    @property
    def contact(self) -> Contact:
        """Where the surface passes through itself and did not at rest. Computed on first use, in about a second for a million triangles. A
        cloud has no contact.

        Warns
        -----
        ContactWarning
            There is contact; only the first time.
        """
        return self._contact_of(None, 3)

    @functools.cached_property
    def info(self) -> PoseInfo:
        """The result. Measured on first use.

        Warns
        -----
        ContactWarning
            The surface passes through itself, and that was not looked for before.
        """
        told, found, contact = self._told, self._check(), self._contact_of(None, 4)
        return PoseInfo(told["nodes"], told["iterations"], told["converged"], told["energy"], found["folded"], found["strained"],
                        float(self.stretch().max(initial=1)), told["seconds_solve"] + told["seconds_map"],
                        contact=contact.triangles, contact_depth=contact.largest_depth, _error=self._solved.error)

    def discretisation_error(self, *, progress: Progress = None) -> float:
        """Estimates the distance from the pose with a node at each vertex: root mean square, over the diagonal of the part that bends; not a number if
        it is unknown. Computed on first use, from a second, coarser solution.

        Parameters
        ----------
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].
        """
        return self._solved.error(progress)

    def stretch(self, *, progress: Progress = None) -> NDArray[np.float32]:
        """The stretch of the surface around each vertex, n numbers: 1 is as long as at rest, 2 twice as long. It is the ratio of the root mean
        square lengths of the edges there.

        Parameters
        ----------
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].
        """
        return self._core.stretch(self.vertices, report(progress))

    @overload
    def map(self, points: ArrayLike, normals: None = None, *, progress: Progress = None) -> Points: ...
    @overload
    def map(self, points: ArrayLike, normals: ArrayLike, *, progress: Progress = None) -> tuple[Points, Points]: ...
    def map(self, points: ArrayLike, normals: ArrayLike | None = None, *, progress: Progress = None) -> Points | tuple[Points, Points]:
        """Maps other points of the same space: each moves with the nearest place of the surface.

        Parameters
        ----------
        points : array_like
            k x 3, at rest. Those that are not finite, or beyond 1e100, stay as they are.
        normals : array_like, optional
            k x 3, of the points; they turn along.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].

        Returns
        -------
        ndarray or tuple[ndarray, ndarray]
            The points, k x 3; with normals, also the turned normals, with their lengths kept.

        Raises
        ------
        ValueError
            An argument has the wrong shape.
        """
        rows = _inputs.rows("points", points, lent=True)
        beside = None if normals is None else _inputs.rows("normals", normals, len(rows), "one for each of points", lent=True)
        moved, turned = self._core.map(rows, beside, report(progress))
        return moved if turned is None else (moved, turned)

    @functools.cached_property
    def nodes(self) -> Points:
        """k x 3, read-only: the nodes of the graph in the pose."""
        return self._of_nodes[0]

    @functools.cached_property
    def node_maps(self) -> NDArray[np.float64]:
        """k x 3 x 3, read-only: the linear map of the surface at each node, for column vectors."""
        return self._of_nodes[1]

    @functools.cached_property
    def _of_nodes(self) -> tuple[Points, NDArray[np.float64]]:
        places, maps = self._core.nodes()
        return _inputs.own(places, np.float64), _inputs.own(maps, np.float64)

    def deformation(self, *, inverse: bool = False, accuracy: float = 0.0, progress: Progress = None) -> Deformation:
        """Makes a [Deformation][pymeshlab_fcd.Deformation], which can be saved and applied to any number of points. It has as few samples as
        the accuracy allows.

        Parameters
        ----------
        inverse : bool, default False
            Whether it is the inverse, from the pose back to rest.
        accuracy : float, default 0.0
            Largest error of a vertex, in world units. A tenth of it takes about five times as many samples, up to a million; see
            `Deformation.file_size` and `seconds`. 0: a fiftieth of the largest motion, at most a ten-thousandth of the diagonal of the part that moves.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].

        Raises
        ------
        ValueError
            The accuracy is below 0, or not finite.

        Warns
        -----
        DeformationWarning
            The error is larger at some vertices (see `Deformation.largest_difference`), or the pose folds the surface somewhere, so that it has
            no inverse there.
        """
        return self._deformation(progress, 4, _inputs.accuracy(accuracy), inverse)

    def _deformation(self, progress: Progress, level: int, accuracy: float, inverse: bool = False) -> Deformation:
        field, told = self._core.field(_inputs.flag("inverse", inverse), accuracy, report(progress))
        made = Deformation._of(field, told["seconds"])
        found: list[Told] = [(kind, told[name]) for kind, name in ((FoldWarning, "folds"), (AccuracyWarning, "warning")) if told[name]]
        warn(found, level)
        return made

    def mesh(self) -> Any:
        """A copy in this pose of the other library's mesh that the Deformer got, with all that it carries.

        If it stores normals of vertices or faces, the copy has those of the pose. A cloud's normals are left out if the Deformer did not get
        them (`normals`). Other vectors stay unchanged. A copy of pymeshlab's mesh has normals, quality, colours, texture coordinates (not in
        2022.2), edges and label. pymeshlab cannot make a mesh with selections, texture images, custom attributes, polygons or a matrix.

        Raises
        ------
        ValueError
            The Deformer got arrays, the mesh has other faces or another number of vertices by now, or it could not be pickled.
        """
        has_normals = self._deformer.faces is not None or self._deformer._rest_normals is not None
        return _meshes.posed(self._deformer._given_mesh(), self.vertices, self._deformer.faces, self.normals if has_normals else None)

    def __repr__(self) -> str:
        told, name = self._told, type(self).__name__
        return f"<{name} of {len(self._deformer.vertices)} vertices, {told['iterations']} iterations, {'' if told['converged'] else 'not '}converged>"


def _describe(found: dict[str, Any]) -> list[Told]:
    """Warnings of what is probably not intended."""
    def count(n: int, one: str, many: str) -> str:
        return f"{n} {one if n == 1 else many}"

    told: list[Told] = []
    if found["rigid"]:
        told.append((RigidWarning, "Nothing is fixed beside the free surface, so it moves rigidly with the handles. Mark as fixed "
                                   "(tag 0) what has to stay, beside the free surface."))
    if found["overruled"]:
        told.append((OverruledWarning,
                     f"{count(found['overruled'], 'handle vertex is', 'handle vertices are')} at the place of a fixed vertex, or of one with "
                     "a smaller tag, which counts. Give all vertices at a place the same tag."))
    if found["strained"]:
        told.append((StretchWarning,
                     f"{count(found['strained'], 'edge joins', 'edges join')} two held regions that move differently: less than half or more "
                     f"than twice as long as at rest (the longest: {found['longest']:g} times). Leave free vertices between them."))
    if found["volume_off"]:
        told.append((VolumeWarning, f"The volume of the free surface is off by {100 * found['volume_off']:.0f} percent: elastic makes a limb at most "
                                    "twice or half as thick. Move the handles less, or leave more of the surface free."))
    if found["folded"]:
        told.append((FoldWarning, f"{triangles_turned(found['folded'])}: the surface is squeezed or twisted too much there. Move the handles "
                                  "less, or leave more free surface between them."))
    return told
