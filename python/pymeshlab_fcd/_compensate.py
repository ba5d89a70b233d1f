# SPDX-License-Identifier: GPL-3.0-or-later
"""Compensation: the part to print so that the nominal part comes out."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _inputs, _meshes
from ._inputs import Points
from ._meshes import MeshLike
from ._numbers import lengths
from ._progress import Progress, report
from ._warnings import CompensationWarning, warn


@dataclass(frozen=True)
class CompensationInfo:
    """How far a part was warped, and how it was changed. Lengths are in units of the vertices."""

    before: float
    """Distance of the nominal part from the scan, when laid onto it rigidly, root mean square over the scanned surface."""
    left: float
    """The same after the warp: noise of the scan, and warps that are not smooth."""
    scanned: float
    """Share of the nominal surface that has a counterpart on the scan, 0 to 1."""
    change: float
    """Distance from the nominal vertices to those to print, root mean square."""
    change_most: float
    """The largest of these distances."""
    missed: float
    """How far, at most, the predicted print is off the nominal vertices."""


class Compensated:
    """The part to print, by [compensate][pymeshlab_fcd.compensate]. It can be pickled."""

    def __init__(self, way: _core.Compensating, nominal: Points) -> None:
        self._way = way
        self._nominal = nominal
        self._vertices: Points = way.made()
        self._vertices.flags.writeable = False

    def __getstate__(self) -> dict[str, Any]:
        return {"way": self._way.state(), "nominal": self._nominal, "vertices": self._vertices}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._way = _core.Compensating(state["way"])
        self._nominal, self._vertices = (_inputs.own(state[name], np.float64) for name in ("nominal", "vertices"))

    @property
    def vertices(self) -> Points:
        """n x 3, read-only: the vertices to print, with the faces of the nominal part. Vertices without a face that lie beyond the part
        stay."""
        return self._vertices

    @property
    def info(self) -> CompensationInfo:
        """How far the part was warped, and how it was changed."""
        return CompensationInfo(**self._way.told())

    @property
    def change(self) -> NDArray[np.float64]:
        """n distances: of each vertex from its nominal place."""
        return lengths(self._vertices - self._nominal)

    def map(self, points: ArrayLike, *, progress: Progress = None) -> Points:
        """Takes other points of the nominal part to their places in the part to print: supports, other resolutions, drawings.

        Parameters
        ----------
        points : array_like
            k x 3, finite.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].
        """
        return self._way.apply(_inputs.finite("points", _inputs.rows("points", points, lent=True)), False, report(progress))

    def predict(self, points: ArrayLike, *, progress: Progress = None) -> Points:
        """Predicts where points of the printed part come to lie, if it is warped again as it was. It lies as the nominal part does.

        Parameters
        ----------
        points : array_like
            k x 3, finite.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].
        """
        return self._way.apply(_inputs.finite("points", _inputs.rows("points", points, lent=True)), True, report(progress))

    def __repr__(self) -> str:
        return f"<Compensated of {len(self._vertices)} vertices, changed by {self.info.change_most:g} at most>"


def compensate(
    vertices: ArrayLike | MeshLike,
    faces: ArrayLike | MeshLike | None = None,
    scan_vertices: ArrayLike | MeshLike | None = None,
    scan_faces: ArrayLike | None = None,
    *,
    scan_normals: ArrayLike | None = None,
    degree: int = 5,
    largest_distance: float = 0.0,
    samples: int = 12000,
    threads: int = 0,
    progress: Progress = None,
) -> Compensated:
    """Computes the part to print so that the nominal part comes out. The scan of a printed part shows the warp; this is its inverse. The warp
    is smooth and moves all of space. So flat faces, round holes and sharp edges stay, parts that were not scanned move along, and noise has no
    effect. Vertices need not be welded. Meshes of other libraries bring their faces: `compensate(mesh, scan)`.

    The method assumes that the next print warps at each place as this one did. If the change is large, print, scan and compensate again.

    Parameters
    ----------
    vertices : array_like or mesh
        n x 3, of the nominal part, or a mesh of trimesh, pyvista, Open3D or pymeshlab.
    faces : array_like, optional
        m x 3 numbers of vertices, or what the mesh has.
    scan_vertices : array_like or mesh
        k x 3, of the scan of the printed part in the same units, rigidly aligned with the nominal one; vertices that are not finite are
        left out.
    scan_faces : array_like, optional
        m x 3 numbers of vertices of the scan; None: a cloud, or what the mesh has.
    scan_normals : array_like, optional
        k x 3, of a cloud: they tell the two sides of thin parts apart.
    degree : int, default 5
        Degree of the warp's polynomial, 1 to 7. 1 is shrinkage and shear; more follows finer warps.
    largest_distance : float, default 0.0
        Parts farther than this from the scan count as not scanned, in units of the vertices. 0: no limit.
    samples : int, default 12000
        How many places of the nominal part are matched, from 100 to a million.
    threads, progress
        As in [Deformer][pymeshlab_fcd.Deformer].

    Returns
    -------
    Compensated
        The part to print, `Compensated.vertices`, and how far it is from the nominal part, `Compensated.info`.

    Raises
    ------
    ValueError
        An argument has the wrong shape, or is out of range, the nominal part has no faces, the scan has few points or lies on one line, or
        nothing of the part has a counterpart there.

    Warns
    -----
    DeformationWarning
        Little is scanned, half of the distance is left after the warp, or the warp cannot be inverted.
    """
    found, scan, corners = _meshes.beside(vertices, faces, scan_vertices, scan_faces)
    own: Any = found
    if scan is None:
        raise TypeError("there is no scan: it comes after the faces, compensate(vertices, faces, scan_vertices, scan_faces)")
    nominal, triangles = _meshes.surface(vertices, own, lent=False)[1:]
    places, of_scan = _meshes.surface(scan, corners, "scan_")[1:]
    if len(places) == 0:
        raise ValueError("the scan has no vertices; give a surface, or points, as scan_vertices")
    normals = None if scan_normals is None else _inputs.normals(scan_normals, len(places), "scan_normals")
    param: dict[str, Any] = {"degree": _inputs.whole("degree", degree, 1, 7), "samples": _inputs.whole("samples", samples, 0),
                             "largest_distance": _inputs.number("largest_distance", largest_distance)}
    way = _core.Compensating(nominal, triangles, places, of_scan, normals, param, _inputs.whole("threads", threads, 0, 1024),
                             report(progress))
    warn([(CompensationWarning, each) for each in way.warnings()], 2)
    return Compensated(way, nominal)
