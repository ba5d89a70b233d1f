# SPDX-License-Identifier: GPL-3.0-or-later
"""A pose of a surface."""
from __future__ import annotations

import functools
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _inputs, _meshes
from ._deformation import Deformation
from ._inputs import Points
from ._progress import Progress, Report, report

if TYPE_CHECKING:
    from ._deformer import Deformer


class DeformationWarning(UserWarning):
    """Something in a deformation is probably not meant, or only approximate; the text says what to do."""


@dataclass(frozen=True)
class PoseInfo:
    """What became of a pose."""

    nodes: int
    """Of the deformation graph."""
    iterations: int
    """Of the solver, with those of the steps."""
    converged: bool
    """Whether the shape came to rest."""
    energy: float
    """Of Eq. 2, in squares of the units of the vertices."""
    discretisation_error: float
    """How far it is, about, from the pose with a node at every vertex, because there are so few: root mean square, over the diagonal of
    what bends; not a number where that cannot be told."""
    folded: int
    """Triangles that turned over."""
    strained: int
    """Edges that join two held regions and got half or twice as long, or worse."""
    largest_stretch: float
    """The largest of [stretch][pymeshlab_fcd.Pose.stretch]."""
    seconds: float
    """That it took, without the check."""


class Pose:
    """A pose of a surface, as [Deformer.pose][pymeshlab_fcd.Deformer.pose] makes it."""

    def __init__(self, deformer: Deformer, core: _core.Posed, vertices: Points) -> None:
        self.deformer = deformer
        """What was posed."""
        self.vertices: Points = vertices
        """n x 3: what is fixed or outside is as it was, to the bit, and handles are where they were put."""
        self._core = core
        self._turned: Points | None = None
        self._found: dict[str, Any] | None = None

    def _write(self, turned: Points | None, told: Report | None) -> None:
        rest = self.deformer._normals
        if turned is not None and rest is None and self.deformer.faces is None:
            raise ValueError("a cloud has no normals of its own: give the Deformer those at rest, normals=")
        if turned is not None and np.shares_memory(turned, self.vertices):
            raise ValueError("out_normals must be another array than out")
        self._core.write(self.vertices, rest if turned is not None else None, turned if rest is not None else None, told)
        if turned is not None:
            self._turned = turned if rest is not None else self.deformer._core.normals_of(self.vertices, turned)

    def _check(self, told: Report | None = None) -> dict[str, Any]:
        if self._found is None:
            self._found = self._core.check(self.vertices, told)
        return self._found

    def _warn(self, check: bool, told: Report | None, level: int) -> None:
        info = self._core.info()
        texts = []
        if not info["moves"]:
            texts.append("No handle moves: nothing that was given leads them away from where they are.")
        if not info["converged"]:
            texts.append("The deformation did not come to rest: raise max_iterations, or tolerance, or move the handles less at a time "
                         "(steps).")
        if check:
            texts += _describe(self._check(told))
        elif told:
            told(100, "Done")
        for text in texts:
            warnings.warn(text, DeformationWarning, level)

    @property
    def normals(self) -> Points:
        """n x 3: the normals at rest that the Deformer was given, turned with the surface and as long as they were; or else, of
        length 1, those of the faces in this pose, weighed by their angles (0 at a vertex without a face).

        Raises:
            ValueError: A cloud that was given none.
        """
        if self._turned is None:
            rest = self.deformer._normals
            if rest is not None:
                turned = np.empty_like(rest)
                self._core.write(np.empty_like(self.vertices), rest, turned, None)
                self._turned = turned
            elif self.deformer.faces is None:
                raise ValueError("a cloud has no normals of its own: give the Deformer those at rest, normals=")
            else:
                self._turned = self.deformer._core.normals_of(self.vertices, None)
        return self._turned

    @functools.cached_property
    def info(self) -> PoseInfo:
        """What became of it; measured when it is asked for first."""
        info, found = self._core.info(), self._check()
        return PoseInfo(info["nodes"], info["iterations"], info["converged"], info["energy"], info["discretisation_error"], found["folded"],
                        found["strained"], float(self.stretch().max(initial=1)), info["seconds_solve"] + info["seconds_map"])

    def stretch(self, *, progress: Progress = None) -> NDArray[np.float32]:
        """How much longer the surface got around each vertex: n, root mean square length of the edges there over that at rest; 1
        is as long as before, 2 twice as long.

        Args:
            progress: Told what is being done; see [Progress][pymeshlab_fcd.Progress].
        """
        return self._core.stretch(self.vertices, report(progress))

    @overload
    def map(self, points: ArrayLike, normals: None = None, *, progress: Progress = None) -> Points: ...
    @overload
    def map(self, points: ArrayLike, normals: ArrayLike, *, progress: Progress = None) -> tuple[Points, Points]: ...
    def map(self, points: ArrayLike, normals: ArrayLike | None = None, *, progress: Progress = None) -> Points | tuple[Points, Points]:
        """Carries other points of the same space: each goes with the nearest place of the surface.

        Args:
            points: k x 3, at rest. Those that are not finite, or beyond 1e100, stay as they are.
            normals: k x 3, to be turned along.
            progress: Told what is being done; see [Progress][pymeshlab_fcd.Progress].

        Returns:
            The points, k x 3, and where normals are given these, too, as long as they were.

        Raises:
            TypeError: Something is of another kind than what is asked for here.
            ValueError: It has another shape.
        """
        rows = _inputs.rows("points", points)
        beside = None if normals is None else _inputs.rows("normals", normals, len(rows), "one for each of points")
        moved, turned = self._core.map(rows, beside, report(progress))
        return moved if turned is None else (moved, turned)

    @functools.cached_property
    def nodes(self) -> Points:
        """k x 3, where the nodes of the graph went."""
        return self._core.nodes()[0]

    @functools.cached_property
    def node_maps(self) -> NDArray[np.float64]:
        """k x 3 x 3, how the surface turns and stretches at each node: the linear map of column vectors."""
        return self._core.nodes()[1]

    def deformation(self, *, inverse: bool = False, accuracy: float = 0.0, progress: Progress = None) -> Deformation:
        """The same as a [Deformation][pymeshlab_fcd.Deformation], which can be saved and applied to any number of points: its samples
        are as few as tell it.

        Args:
            inverse: Whether it is the way back, from where the surface went to where it was.
            accuracy: How far a vertex may be off at most, in world units. A tenth of it takes about five times as many samples, up to a
                million; `Deformation.file_size` and `seconds` tell what came of it. 0: a fiftieth of the largest motion, at most a
                ten-thousandth of the diagonal of what moves.
            progress: Told what is being done; see [Progress][pymeshlab_fcd.Progress].

        Raises:
            ValueError: The accuracy is below 0, or not finite.
            KeyboardInterrupt: Ctrl-C, at once.

        Warns:
            DeformationWarning: It is farther off at some vertices (`Deformation.largest_difference` tells by how much), or the pose
                folds the surface somewhere, and there is no way back from there.
        """
        return self._deformation(progress, 4, _inputs.accuracy(accuracy), inverse)

    def _deformation(self, progress: Progress, level: int, accuracy: float, inverse: bool = False) -> Deformation:
        field, told = self._core.field(_inputs.flag("inverse", inverse), accuracy, report(progress))
        made = Deformation._of(field, told["seconds"])
        if told["folded"] > 0:
            warnings.warn(f"The pose folds the surface at {told['folded']} vertices: from there it has no way back, and what is near them may come "
                          "to another place.", DeformationWarning, level)
        if told["off"] > 0:
            warnings.warn(f"{told['off']} vertices are farther off than {told['accuracy']:g}, up to {made.largest_difference:g}: parts that lie "
                          "at one place move differently there, or a million samples are not enough. Where that matters, use Pose.map.",
                          DeformationWarning, level)
        return made

    def mesh(self) -> Any:
        """The mesh of another library that the Deformer was given, as a copy in this pose.

        Raises:
            ValueError: It was given arrays.
        """
        if self.deformer._mesh is None:
            raise ValueError("the Deformer was given arrays, not a mesh; Pose.vertices has the positions")
        has_normals = self.deformer.faces is not None or self.deformer._normals is not None
        return _meshes.posed(self.deformer._mesh, self.vertices, self.normals if has_normals else None)

    def __repr__(self) -> str:
        info = self._core.info()
        return f"<Pose of {len(self.vertices)} vertices, {info['iterations']} iterations, {'' if info['converged'] else 'not '}converged>"


def _describe(found: dict[str, Any]) -> list[str]:
    """What is probably not meant, in words."""
    def count(n: int, one: str, many: str) -> str:
        return f"{n} {one if n == 1 else many}"

    texts = []
    if found["rigid"]:
        texts.append("All that the free surface touches makes the same motion, so it moves rigidly with that. Mark what stays as fixed "
                     "(tag 0), beside what is free.")
    if found["overruled"]:
        texts.append(f"{count(found['overruled'], 'handle vertex is', 'handle vertices are')} at the same place as a fixed vertex, or one of "
                     "a handle with a smaller number, and held as that one. Give all vertices at a place the same tag.")
    if found["strained"]:
        texts.append(f"{count(found['strained'], 'edge leads', 'edges lead')} straight from one held region to another that moves otherwise, "
                     "and stretched or shrunk to less than half or more than twice the length (the longest: "
                     f"{found['longest']:g} times). Leave free vertices between them.")
    if found["folded"]:
        texts.append(f"{count(found['folded'], 'triangle has', 'triangles have')} turned over: the surface is squeezed or twisted too much "
                     "there. Move the handles less, or leave more free surface between them.")
    return texts
