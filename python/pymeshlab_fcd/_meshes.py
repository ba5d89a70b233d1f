# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes and clouds of other libraries: read, and returned as copies of the same kind. A library is only imported to make one of its
objects."""
from __future__ import annotations

import copy
import importlib
from typing import Any, Protocol, Union

import numpy as np
from numpy.typing import NDArray

from . import _inputs
from ._inputs import Points

Taken = tuple[Any, Any]  # vertices, faces


class HasVertices(Protocol):
    """A mesh or cloud of trimesh (`vertices`, `faces`), a mesh of Open3D (`vertices`, `triangles`), or a similar object."""

    @property
    def vertices(self) -> Any:
        """n x 3."""


class HasPoints(Protocol):
    """A mesh of pyvista (`points`, `regular_faces`), a cloud of Open3D (`points`)."""

    @property
    def points(self) -> Any:
        """n x 3."""


class HasVertexMatrix(Protocol):
    """A mesh of pymeshlab."""

    def vertex_matrix(self) -> Any:
        """n x 3."""

    def face_matrix(self) -> Any:
        """m x 3."""


MeshLike = Union[HasVertices, HasPoints, HasVertexMatrix]
"""A mesh or a cloud of trimesh, pyvista, Open3D or pymeshlab, or a similar object."""


def taken(mesh: object) -> Taken | None:
    """Vertices and faces of an object of another library; None for arrays. Raises TypeError for other objects."""
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
    if hasattr(mesh, "vertices"):  # trimesh, and similar objects
        return given.vertices, getattr(given, "faces", None)
    if hasattr(mesh, "vertex_matrix") and hasattr(mesh, "face_matrix"):  # pymeshlab
        return given.vertex_matrix(), given.face_matrix()
    if hasattr(mesh, "points") and not hasattr(mesh, "cells"):  # Open3D's clouds
        return np.asarray(given.points), None
    if hasattr(mesh, "__array__") or hasattr(mesh, "__len__"):
        return None
    raise TypeError(f"a {type(mesh).__name__} is neither an array of vertices nor a mesh of trimesh, pyvista, Open3D or pymeshlab; "
                    "give vertices (n x 3) and faces (m x 3)")


def surface(vertices: object, faces: object, whose: str = "", lent: bool = False) -> tuple[object, Points, NDArray[np.uint32] | None]:
    """The mesh of another library or None, its positions, and its corners."""
    mesh: object = None
    found = taken(vertices)
    if found is not None:
        if faces is not None:
            raise TypeError(f"{whose}faces cannot be given beside a mesh, which has its own; give mesh.vertices and faces")
        mesh = vertices
        vertices, faces = found
    positions = _inputs.rows(f"{whose}vertices", vertices, what="one row per vertex", lent=lent)
    return mesh, positions, _inputs.triangles(faces, len(positions), f"{whose}faces")


def is_beside_mesh(vertices: object, other: object) -> bool:
    """Whether vertices are a mesh, and other, in the place of faces, is the next argument."""
    found = taken(vertices)
    if found is None or other is None:
        return False
    try:
        given = np.asarray(other)
    except Exception:  # of another library
        return True
    return given.dtype.kind not in "iu" or given.shape != np.shape(found[1])


def beside(vertices: object, faces: object, other: object, other_faces: object) -> tuple[object, object, object]:
    """The faces of a surface, another surface, and its faces, from four arguments in this order. If the first is a mesh, which has its own
    faces, the others may come one place earlier."""
    if not is_beside_mesh(vertices, faces):
        return faces, other, other_faces
    if other is None:  # the other faces, if any, were given by name
        return None, faces, other_faces
    return (None, faces, other) if other_faces is None else (faces, other, other_faces)


def can_be_pickled(mesh: object) -> bool:
    try:
        mesh.__reduce_ex__(4)
    except Exception:  # of another library
        return False
    return True


def _is_pyvista(mesh: object) -> bool:
    return hasattr(mesh, "regular_faces") and hasattr(mesh, "points")


def posed(mesh: object, vertices: Points, faces: NDArray[np.uint32] | None, normals: Points | None) -> Any:
    """A copy of a mesh with other vertices, and with other normals if it stores any. faces: as they were read"""
    given: Any = mesh
    now = taken(mesh)
    corners = None if now is None or now[1] is None or np.size(now[1]) == 0 else np.asarray(now[1])
    is_same = corners is None if faces is None else corners is not None and np.array_equal(corners, faces)
    if now is None or len(np.asarray(now[0])) != len(vertices) or not is_same:
        raise ValueError("the mesh that the Deformer was given has other faces or another number of vertices by now; Pose.vertices has the "
                         "positions")
    vertices = vertices.copy()  # for the mesh to keep
    normals = None if normals is None else normals.copy()
    if hasattr(mesh, "vertex_matrix"):
        return _pymeshlab(given, vertices, normals)
    if _is_pyvista(mesh):
        other = given.copy()
        other.points = vertices
        _turn(other.point_data, normals)
        _turn(other.cell_data, None if corners is None else _of_faces(vertices, corners), None if corners is None else _of_faces(now[0], corners))
        return other
    if hasattr(mesh, "has_triangles") or hasattr(mesh, "has_points"):  # Open3D
        other = copy.deepcopy(given)
        vectors = importlib.import_module("open3d").utility.Vector3dVector
        cloud = hasattr(mesh, "has_points")
        setattr(other, "points" if cloud else "vertices", vectors(vertices))
        has = other.has_normals() if cloud else other.has_vertex_normals()
        if has:  # without new ones, those at rest are removed
            setattr(other, "normals" if cloud else "vertex_normals", vectors(np.zeros((0, 3)) if normals is None else normals))
        if not cloud and other.has_triangle_normals():
            other.compute_triangle_normals()
        return other
    other = given.copy()
    other.vertices = vertices
    return other




def _turn(data: Any, normals: Points | None, rest: Points | None = None) -> None:
    """Replaces normals of pyvista's points or cells, if they have any; without new ones, removes them. rest: the faces' normals before; stored
    ones may be opposite"""
    for name in {"Normals", data.active_normals_name} & set(data.keys()):
        before = np.asarray(data[name], np.float64)
        is_active, is_vector = (each == name for each in (data.active_normals_name, data.active_vectors_name))
        data.remove(name)
        if normals is None or before.shape != normals.shape:
            continue
        data[name] = normals if rest is None else normals * np.where((before * rest).sum(axis=1, keepdims=True) < 0, -1, 1)
        if is_active:
            data.active_normals_name = name
        if is_vector:
            data.active_vectors_name = name


def _of_faces(vertices: Any, faces: Any) -> Points:
    """The normals of faces, of length 1; 0 for faces without an area."""
    a, b, c = np.moveaxis(np.asarray(vertices, np.float64)[faces], 1, 0)
    across = np.cross(b - a, c - a)
    made: Points = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
    return made


def _pymeshlab(given: Any, vertices: Points, normals: Points | None) -> Any:
    """A new mesh with all that this version of pymeshlab can set."""
    made = importlib.import_module("pymeshlab").Mesh
    has = {"v_scalar_array": ("has_vertex_scalar", "vertex_scalar_array"), "f_scalar_array": ("has_face_scalar", "face_scalar_array"),
           "v_color_matrix": ("has_vertex_color", "vertex_color_matrix"), "f_color_matrix": ("has_face_color", "face_color_matrix"),
           "v_tex_coords_matrix": ("has_vertex_tex_coord", "vertex_tex_coord_matrix"),
           "w_tex_coords_matrix": ("has_wedge_tex_coord", "wedge_tex_coord_matrix")}
    kept = {name: getattr(given, what)() for name, (is_there, what) in has.items() if name in made.__init__.__doc__ and getattr(given, is_there)()}
    if normals is not None:
        kept["v_normals_matrix"] = normals
    other = made(vertices, given.face_matrix(), given.edge_matrix(), **kept)
    other.set_label(given.label())
    return other
