# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes and clouds of other libraries, taken as they are and given back as copies of their kind. None of them is imported
before an object of it comes along."""
from __future__ import annotations

import copy
import importlib
from typing import Any

import numpy as np

from ._inputs import Points

Taken = tuple[Any, Any]  # vertices, faces


def taken(mesh: object) -> Taken | None:
    """Vertices and faces of an object of another library; None where it is none of those that are known."""
    given: Any = mesh
    if isinstance(mesh, (np.ndarray, list, tuple)) or mesh is None:
        return None
    if _is_pyvista(mesh):
        has_faces = np.size(given.faces) > 0
        if has_faces and not given.is_all_triangles:
            raise TypeError("the pyvista mesh has cells that are no triangles; give mesh.triangulate()")
        return given.points, given.regular_faces if has_faces else None
    if hasattr(mesh, "triangles") and hasattr(mesh, "vertices") and not hasattr(mesh, "faces"):  # Open3D
        return np.asarray(given.vertices), np.asarray(given.triangles)
    if hasattr(mesh, "vertices"):  # trimesh, and whatever is like it
        return given.vertices, getattr(given, "faces", None)
    if hasattr(mesh, "vertex_matrix") and hasattr(mesh, "face_matrix"):  # pymeshlab
        return given.vertex_matrix(), given.face_matrix()
    if hasattr(mesh, "points") and not hasattr(mesh, "cells"):  # Open3D's clouds
        return np.asarray(given.points), None
    if hasattr(mesh, "__array__") or hasattr(mesh, "__len__"):
        return None
    raise TypeError(f"a {type(mesh).__name__} is neither an array of vertices nor a mesh of trimesh, pyvista, Open3D or pymeshlab; "
                    "give vertices (n x 3) and faces (m x 3)")


def _is_pyvista(mesh: object) -> bool:
    return hasattr(mesh, "regular_faces") and hasattr(mesh, "points")


def posed(mesh: object, vertices: Points, normals: Points | None) -> Any:
    """A copy of a mesh that was taken, with other vertices, and with other normals where it stores any."""
    given: Any = mesh
    if hasattr(mesh, "vertex_matrix"):
        return importlib.import_module("pymeshlab").Mesh(vertices, given.face_matrix())
    if _is_pyvista(mesh):
        other = given.copy()
        other.points = vertices
        if "Normals" in other.point_data:
            other.point_data.remove("Normals")
            if normals is not None:
                other.point_data["Normals"] = normals
        return other
    if hasattr(mesh, "has_triangles") or hasattr(mesh, "has_points"):  # Open3D
        other = copy.deepcopy(given)
        vectors = importlib.import_module("open3d").utility.Vector3dVector
        cloud = hasattr(mesh, "has_points")
        setattr(other, "points" if cloud else "vertices", vectors(vertices))
        has = other.has_normals() if cloud else other.has_vertex_normals()
        if has and normals is not None:
            setattr(other, "normals" if cloud else "vertex_normals", vectors(normals))
        if not cloud and other.has_triangle_normals():
            other.compute_triangle_normals()
        return other
    other = given.copy()
    other.vertices = vertices
    return other


