# SPDX-License-Identifier: GPL-3.0-or-later
"""Straightening, and bending along a line."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core, _inputs, _meshes
from ._deformer import Deformer, Plan
from ._inputs import Points
from ._meshes import MeshLike
from ._pose import Pose
from ._progress import Progress, report, shared
from ._warnings import FoldWarning, LineWarning, Told, triangles_turned, warn


@dataclass(frozen=True)
class LineInfo:
    """The result for a line, and the surface along it. Lengths are in units of the vertices."""

    length: float
    """Length of the line before."""
    new_length: float
    """Length of the line after."""
    jitter: float
    """Jitter across the line that was removed, root mean square in one direction; 0: none."""
    is_middle: bool
    """Whether the line through the middles of the cross-sections was used."""
    left_middle: bool
    """Whether the given line was used in spite of `middle`, since the middles would stretch the surface more."""
    lengthening: float
    """How much longer or shorter than the line the surface beside it gets, as a share, root mean square; 0 for a line through the middle."""
    is_beside: bool
    """Whether `lengthening` is more than 0.03, and `middle=True` would make it less."""
    twist: float
    """Twist of the surface about the line that `untwist` removed, from end to end, in degrees; else 0."""
    following: int
    """Nodes of the deformation graph that move with the line."""
    released: int
    """Nodes that follow the others instead: moving with the line would fold the surface there, or make it twice or half as long."""
    released_at: list[tuple[float, float]]
    """The ranges of the line with released nodes: from, to."""
    rms: float
    """Distance of the surface from its moved cross-sections, root mean square."""
    largest: float
    """The largest of these distances."""


class Straightened(Pose):
    """A surface that was straightened, or bent along a line, by [straighten][pymeshlab_fcd.straighten]. It has all that a
    [Pose][pymeshlab_fcd.Pose] has."""

    _against_contact = "Raise the smoothing of the line, or bend it less."
    _line: LineInfo

    @property
    def line(self) -> LineInfo:
        """The result for the line."""
        return self._line

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "line": self._line}

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._line = state["line"]

    def __repr__(self) -> str:
        return f"<Straightened of {len(self.deformer.vertices)} vertices, along {self._line.length:g} to {self._line.new_length:g}>"


def _direction(name: str, value: ArrayLike | None) -> Points:
    return np.zeros((1, 3)) if value is None else _inputs.vector(name, value)[None]


def straighten(
    vertices: ArrayLike | MeshLike,
    faces: ArrayLike | None = None,
    line: ArrayLike | None = None,
    target: ArrayLike | None = None,
    *,
    degrees: float = 0.0,
    direction: ArrayLike | None = None,
    towards: ArrayLike | None = None,
    length: float = 0.0,
    middle: bool = False,
    untwist: bool = False,
    smoothing: float = 0.0,
    normals: ArrayLike | None = None,
    patches: int = 1000,
    seed: int = 1,
    smoothness: float = 0.0058,
    weld_distance: float = 1e-6,
    threads: int = 0,
    progress: Progress = None,
) -> Straightened:
    """Straightens a mesh or a cloud along a line, or bends it along another one. Each cross-section goes, unchanged and without twist, from
    its place on the line to the same place on a straight line, an arc, or the target. Where cross-sections meet and would fold the
    surface, it follows as rigidly as possible instead. Meshes of other libraries bring their faces: `straighten(mesh, line)`, or
    `straighten(mesh, line, target)`.

    Parameters
    ----------
    vertices : array_like or mesh
        n x 3, or a mesh of trimesh, pyvista, Open3D or pymeshlab.
    faces : array_like, optional
        m x 3 numbers of vertices; None: a cloud, or what the mesh has.
    line : array_like, optional
        k x 3, points of one open line without branches, in the surface or on it, in their order. A smooth curve leads through them. Points
        that lie closer than the surface is thick may jitter, as picked ones do. Jitter that would stretch the surface by more than a
        hundredth is removed (`Straightened.line.jitter`).
    target : array_like, optional
        k x 3, points of the line that it becomes, from the target's beginning on; beyond its end, it is straight. None: a straight line, or an
        arc, at the same place.
    degrees : float, default 0.0
        Bend of the arc from end to end, less than 360; 0 is straight.
    direction : array_like, optional
        Direction of the straight line, or of the arc in its middle. None: from end to end of the line.
    towards : array_like, optional
        The direction that the ends of the arc bend to. None: as the ends of the line.
    length : float, default 0.0
        New length of the line; 0: as before. Cross-sections keep their size.
    middle : bool, default False
        Whether to use the line through the middles of the cross-sections; the given line may then lie on the surface. If the middles would
        stretch the surface more, the given line is used (`Straightened.line.left_middle`).
    untwist : bool, default False
        Whether to turn the cross-sections about the line so that their longest axes are aligned.
    smoothing : float, default 0.0
        Share of the line's length, 0 to 0.25: wiggles shorter than about three times this are smoothed away, instead of jitter.
    normals : array_like, optional
        n x 3, at rest, which turn with the surface. None: those of its faces.
    patches : int, default 1000
        How many patches to begin with, from 1.
    smoothness : float, default 0.0058
        Smoothness of the parts that do not move with the line: 0.001 is loose, 0.1 is stiff.
    seed, weld_distance, threads, progress
        As in [Deformer][pymeshlab_fcd.Deformer].

    Returns
    -------
    Straightened
        The new vertices, `Straightened.vertices`: the same bits as those of the filter `generate_fcd_straightened_mesh`. `map` carries other
        points along. `deformation` can be saved; `deformation(inverse=True)` leads back.

    Raises
    ------
    ValueError
        An argument has the wrong shape, or is out of range; the line has one point, no extent, two points in a row at one place, is closed, turns back
        on itself or is elsewhere than the surface; cross-sections are too round to tell a twist.

    Warns
    -----
    DeformationWarning
        The line lies to one side of the surface, parts of the surface do not move with it, the middles were not used, or flipped triangles.
    """
    if _meshes.is_beside_mesh(vertices, faces):
        if line is None:  # the target, if any, was given by name
            faces, line = None, faces
        elif target is None:
            faces, line, target = None, faces, line
    if line is None:
        raise TypeError("there is no line: it comes after the faces, straighten(vertices, None, line) for a cloud")
    goal: dict[str, Any] = {
        "line": _inputs.finite("line", _inputs.rows("line", line)),
        "target": None if target is None else _inputs.finite("target", _inputs.rows("target", target)),
        "degrees": _inputs.number("degrees", degrees),
        "direction": _direction("direction", direction),
        "towards": _direction("towards", towards),
        "length": _inputs.number("length", length),
        "smoothing": _inputs.number("smoothing", smoothing),
        "middle": _inputs.flag("middle", middle),
        "untwist": _inputs.flag("untwist", untwist),
    }
    param: dict[str, Any] = {
        "patches": _inputs.whole("patches", patches, 1), "target_radius": 0.0, "seed": _inputs.whole("seed", seed, 0), "by_vertices": False,
        "graph_weights": 0, "weights": 0, "influence": 4.0, "loose_parts": 0, "nodes": None, "max_iterations": 1000, "tolerance": 1e-5,
        "smoothness": _inputs.number("smoothness", smoothness), "weld_distance": _inputs.number("weld_distance", weld_distance),
    }
    if target is not None and (degrees != 0 or direction is not None or towards is not None):
        raise ValueError("degrees, direction and towards are of an arc: give them, or a target, not both")
    told = shared(progress)
    deformer = Deformer._made(vertices, faces, normals, False, _inputs.whole("threads", threads, 0, 1024), lambda _: Plan("free", param),
                              report(told, 0, 60))
    solved, measured, warnings, remedy = _core.straighten(deformer._prepared, goal, report(told, 60, 80))
    made = Straightened(deformer, solved)
    made._line = LineInfo(**measured)
    made._write(None, None, report(told, 80, 95))
    found: list[Told] = [(LineWarning, each) for each in warnings]
    folded = made._check(report(told, 95, 100))["folded"]
    if folded > 0:
        found.append((FoldWarning, f"{triangles_turned(folded)}: the surface is folded there. {remedy}"))
    warn(found, 2)
    made._warn_of_contact(3)
    return made
