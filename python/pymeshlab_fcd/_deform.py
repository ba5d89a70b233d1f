# SPDX-License-Identifier: GPL-3.0-or-later
"""Deforming meshes: numpy, or a MeshSet, to pymeshlab's filters."""
from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _plugin
from ._deformation import Deformation, Points, _rows

if TYPE_CHECKING:
    import pymeshlab


def _tags(tags: ArrayLike, vertices: int) -> np.ndarray:
    given = np.asarray(tags)
    whole = given.astype(np.int64) if given.size else given
    if given.shape != (vertices,) or not np.array_equal(whole, given):
        raise ValueError(f"tags must be {vertices} whole numbers, one for each vertex: 0 fixed, 1 free, 2 and up handles, "
                         "negative outside")
    return whole


def _text(transforms: Mapping[int, ArrayLike]) -> str:
    """The text that the filter's parameter takes."""
    clauses = []
    for tag, matrix in transforms.items():
        m = np.asarray(matrix, dtype=np.float64)
        if m.shape != (4, 4) or not np.isfinite(m).all():
            raise ValueError(f"the transform of handle {tag} must be a 4 x 4 matrix of finite numbers")
        clauses.append(f"{int(tag)}: matrix " + " ".join(repr(float(x)) for x in m.ravel()))
    return "; ".join(clauses)


def deform_layer(ms: pymeshlab.MeshSet, tags: ArrayLike | None, transforms: Mapping[int, ArrayLike], **parameters: Any) -> dict[str, Any]:
    """Deforms the current layer of a MeshSet; the deformed layers become new ones, the last of them the current one.

    tags: a whole number per vertex (0 fixed, 1 free, 2 and up handles, negative outside), or None where the layer has them as
    vertex quality. transforms: {tag: 4 x 4 matrix}, column vectors, world coordinates. parameters: those of the filter
    generate_fcd_deformed_mesh. Returns what the filter returns.

    Raises RuntimeError where there is no pymeshlab that this package knows, ValueError for arrays of another shape, and
    pymeshlab.PyMeshLabException, which says what is wrong, for what cannot be deformed. The MeshSet is then as it was.
    """
    if _plugin.missing:
        raise RuntimeError(_plugin.missing)
    text = _text(transforms)
    if tags is None:
        return ms.apply_filter("generate_fcd_deformed_mesh", transforms=text, **parameters)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "tags.sel"
        np.savetxt(file, _tags(tags, ms.current_mesh().vertex_number()), fmt="%d")
        return ms.apply_filter("generate_fcd_deformed_mesh", handles=3, tag_file=str(file), transforms=text, **parameters)


def _deformed(vertices, faces, tags, transforms, parameters):
    if _plugin.missing:
        raise RuntimeError(_plugin.missing)
    import pymeshlab

    points = _rows("vertices", vertices)
    corners = np.zeros((0, 3), np.int32) if faces is None else np.ascontiguousarray(faces)
    if corners.size == 0:
        mesh = pymeshlab.Mesh(points)
    else:
        if corners.ndim != 2 or corners.shape[1] != 3 or not np.issubdtype(corners.dtype, np.integer):
            raise ValueError("faces must be m x 3 whole numbers, the vertices at the corners of triangles; None for a cloud")
        if corners.min() < 0 or corners.max() >= len(points):
            raise ValueError(f"faces must hold numbers of vertices, 0 to {len(points) - 1}")
        mesh = pymeshlab.Mesh(points, corners.astype(np.int32))
    _tags(tags, len(points))
    ms = pymeshlab.MeshSet()
    ms.add_mesh(mesh, "mesh")
    deform_layer(ms, tags, transforms, **parameters)
    return ms


def deform(vertices: ArrayLike, faces: ArrayLike | None, tags: ArrayLike, transforms: Mapping[int, ArrayLike], **parameters: Any) -> Points:
    """The positions (n x 3, float64) of the vertices of a mesh, or of a point cloud, after a deformation.

    vertices: n x 3. faces: m x 3 vertex numbers, None for a cloud. tags: n whole numbers (0 fixed, 1 free, 2 and up handles,
    negative outside). transforms: {tag: 4 x 4 matrix} moves the handles; column vectors. parameters: those of the filter
    generate_fcd_deformed_mesh, as initial_patches=600. Errors as of deform_layer.
    """
    ms = _deformed(vertices, faces, tags, transforms, {"graph_layers": False, **parameters})  # must outlive its meshes
    return ms.current_mesh().vertex_matrix()


def deformation(vertices: ArrayLike, faces: ArrayLike | None, tags: ArrayLike, transforms: Mapping[int, ArrayLike], **parameters: Any) -> Deformation:
    """The same as a deformation to be applied to other points in the same space: deform a thinned scan, then all of it."""
    ms = _deformed(vertices, faces, tags, transforms, {**parameters, "graph_layers": True})
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "deformation.ply")
        ms.apply_filter("save_fcd_deformation", source_layer=0, rest_graph=1, deformed_graph=2, deformation_file=path)
        return Deformation.load(path)
