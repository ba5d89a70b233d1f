# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects of other libraries, taken as they are and given back as their kind."""
import numpy as np
import pytest
from shapes import bar, same

from pymeshlab_fcd import Deformer, deform


@pytest.fixture(scope="module")
def expected():
    vertices, faces, tags, lift = bar()
    return deform(vertices, faces, tags, {2: lift})


def test_trimesh(expected):
    trimesh = pytest.importorskip("trimesh")
    vertices, faces, tags, lift = bar()
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    pose = Deformer(mesh, tags=tags).pose({2: lift})
    other = pose.mesh()
    assert same(pose.vertices, expected) and isinstance(other, trimesh.Trimesh) and other is not mesh
    assert same(np.asarray(other.vertices), expected) and (other.faces == faces).all() and same(np.asarray(mesh.vertices), vertices)
    cloud = Deformer(trimesh.PointCloud(vertices), tags=tags).pose({2: lift})
    assert same(cloud.vertices, deform(vertices, None, tags, {2: lift})) and isinstance(cloud.mesh(), trimesh.PointCloud)


def test_pyvista(expected):
    pyvista = pytest.importorskip("pyvista")
    vertices, faces, tags, lift = bar()
    mesh = pyvista.PolyData.from_regular_faces(vertices, faces)
    mesh["quality"] = np.arange(len(vertices))
    mesh.compute_normals(cell_normals=False, split_vertices=False, consistent_normals=False, auto_orient_normals=False, inplace=True)
    pose = Deformer(mesh, tags=tags).pose({2: lift})
    other = pose.mesh()
    assert same(pose.vertices, expected) and isinstance(other, pyvista.PolyData) and (other["quality"] == mesh["quality"]).all()
    assert np.abs(np.asarray(other.points) - expected).max() < 1e-6 and np.abs(np.asarray(other.point_data["Normals"]) - pose.normals).max() < 1e-6
    cloud = Deformer(pyvista.PolyData(vertices), tags=tags).pose({2: lift})
    assert cloud.deformer.faces is None and isinstance(cloud.mesh(), pyvista.PolyData)
    with pytest.raises(TypeError, match="triangulate"):
        Deformer(pyvista.Plane(), tags=np.ones(121))
    with pytest.raises(TypeError, match="UnstructuredGrid"):
        Deformer(pyvista.PolyData(vertices).cast_to_unstructured_grid(), tags=tags)


def test_pymeshlab(expected):
    pymeshlab = pytest.importorskip("pymeshlab")
    vertices, faces, tags, lift = bar()
    pose = Deformer(pymeshlab.Mesh(vertices, faces), tags=tags).pose({2: lift})
    assert same(pose.vertices, expected) and same(pose.mesh().vertex_matrix(), expected)


def test_pymeshlab_keeps_what_it_has():
    pymeshlab = pytest.importorskip("pymeshlab")
    vertices, faces, tags, lift = bar()
    random = np.random.default_rng(0)
    mesh = pymeshlab.Mesh(vertices, faces, v_scalar_array=random.normal(size=len(vertices)), f_scalar_array=random.normal(size=len(faces)),
                          v_color_matrix=random.random((len(vertices), 4)), f_color_matrix=random.random((len(faces), 4)),
                          v_tex_coords_matrix=random.random((len(vertices), 2)), w_tex_coords_matrix=random.random((3 * len(faces), 2)))
    mesh.set_label("bar")
    pose = Deformer(mesh, tags=tags).pose({2: lift})
    other = pose.mesh()
    for name in ("vertex_scalar_array", "face_scalar_array", "vertex_color_array", "face_color_array", "vertex_tex_coord_matrix", "wedge_tex_coord_matrix",
                 "face_matrix", "label"):
        assert np.array_equal(getattr(other, name)(), getattr(mesh, name)()), name
    assert same(other.vertex_matrix(), pose.vertices)
    cloud = Deformer(pymeshlab.Mesh(vertices, v_color_matrix=random.random((len(vertices), 4))), tags=tags, normals=np.tile([0, 0, 1.0], (len(vertices), 1)))
    pose = cloud.pose({2: lift})
    assert same(pose.mesh().vertex_normal_matrix(), pose.normals) and not pose.mesh().has_wedge_tex_coord()
    assert not Deformer(pymeshlab.Mesh(vertices, faces), tags=tags).pose({2: lift}).mesh().label()


def test_normals_of_pyvista_are_those_of_the_pose():
    pyvista = pytest.importorskip("pyvista")
    vertices, faces, tags, lift = bar()
    for flip in (False, True):
        mesh = pyvista.PolyData.from_regular_faces(vertices, faces)
        mesh.compute_normals(split_vertices=False, consistent_normals=False, auto_orient_normals=False, flip_normals=False, inplace=True)
        if flip:
            mesh.cell_data["Normals"] *= -1
        for data in (mesh.point_data, mesh.cell_data):
            data["direction"] = data["Normals"].copy()
            data.active_vectors_name = "Normals"
        other = Deformer(mesh, tags=tags).pose({2: lift}).mesh()
        fresh = pyvista.PolyData.from_regular_faces(other.points, faces).compute_normals(split_vertices=False, consistent_normals=False, auto_orient_normals=False)
        assert np.abs(other.cell_data["Normals"] - (-1 if flip else 1) * fresh.cell_data["Normals"]).max() < 1e-5
        for data in (other.point_data, other.cell_data):
            assert data.active_normals_name == "Normals" and data.active_vectors_name == "Normals" and "direction" in data
    cloud = pyvista.PolyData(vertices)
    cloud.point_data["Normals"] = np.tile([0, 0, 1.0], (len(vertices), 1))
    assert "Normals" not in Deformer(cloud, tags=tags).pose({2: lift}).mesh().point_data


def test_open3d(expected):
    open3d = pytest.importorskip("open3d")
    vertices, faces, tags, lift = bar()
    mesh = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(vertices), open3d.utility.Vector3iVector(faces))
    mesh.compute_vertex_normals()
    pose = Deformer(mesh, tags=tags).pose({2: lift})
    assert same(pose.vertices, expected) and same(np.asarray(pose.mesh().vertices), expected)
    assert np.abs(np.asarray(pose.mesh().vertex_normals) - pose.normals).max() < 1e-9
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(vertices))
    assert same(np.asarray(Deformer(cloud, tags=tags).pose({2: lift}).mesh().points), deform(vertices, None, tags, {2: lift}))


def test_what_is_like_open3d(expected):
    """The attributes of its classes, where it is not installed."""
    class Vectors:
        def __init__(self, rows):
            self.rows = rows

        def __array__(self, dtype=None, copy=None):
            return np.asarray(self.rows, dtype)

    class Mesh:
        vertices, triangles = Vectors(bar()[0]), Vectors(bar()[1].astype(np.int32))

    class Cloud:
        points = Vectors(bar()[0])

    vertices, faces, tags, lift = bar()
    assert same(deform(Mesh(), tags=tags, transforms={2: lift}), expected)
    assert same(deform(Cloud(), tags=tags, transforms={2: lift}), deform(vertices, None, tags, {2: lift}))


def test_arrays_have_no_mesh_to_give_back():
    vertices, faces, tags, lift = bar()
    with pytest.raises(ValueError, match="was given arrays"):
        Deformer(vertices, faces, tags).pose({2: lift}).mesh()
    with pytest.raises(TypeError, match="neither an array of vertices nor a mesh"):
        Deformer(object(), tags=tags)
    class Mesh:
        vertices, faces = bar()[:2]
    with pytest.raises(TypeError, match="faces cannot be given beside a mesh"):
        Deformer(Mesh(), bar()[1], tags)
