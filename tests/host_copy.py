# SPDX-License-Identifier: GPL-3.0-or-later
"""One deformation for many layers inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import numpy as np
import pymeshlab
import pytest

from conftest import QUALITY_TAGS, translation
from host_pymeshlab import COPY, DEFORM, POSE, assert_unchanged, clean_bone, matrix, same_points, set_quality, snapshot

BEND = dict(translation=np.array([0, 0.05, 0.25]), rotation_axis=np.array([0.0, 1, 0]), rotation_angle=-40.0)
LAYERS = dict(source_layer=0, rest_graph=1, deformed_graph=2)


def bent_bone():
    """The bone (0), its graph (1), that deformed (2), the bone deformed (3); the bone is current."""
    ms = clean_bone()
    ms.apply_filter(DEFORM, **BEND)
    ms.set_current_mesh(0)
    return ms


def rms(a, b):
    return np.sqrt(((a - b) ** 2).sum(1).mean())


def test_the_source_itself_becomes_the_deformed_layer():
    ms = bent_bone()
    before = snapshot(ms.current_mesh())
    result = ms.apply_filter(COPY, **LAYERS)
    assert result == {"layers": 1, "vertices": len(before["points"])}
    assert ms.current_mesh_id() == 4
    points, expected = ms.current_mesh().vertex_matrix(), ms.mesh(3).vertex_matrix()
    assert np.abs(points - expected).max() < 1e-6
    fixed = before["quality"] == 0
    assert same_points(points[fixed], before["points"][fixed])
    assert_unchanged(before, ms.mesh(0))


def test_a_coarse_copy_drives_the_fine_mesh():
    fine = clean_bone()
    fine.apply_filter("meshing_surface_subdivision_midpoint", iterations=3, threshold=absolute_zero())
    set_quality(fine, QUALITY_TAGS)
    rest = fine.current_mesh()
    points = rest.vertex_matrix()
    fine.apply_filter(DEFORM, **BEND)
    expected = fine.current_mesh().vertex_matrix()
    ms = bent_bone()
    ms.add_mesh(pymeshlab.Mesh(points, rest_faces(fine)), "fine")
    ms.apply_filter(COPY, **LAYERS)
    got = ms.current_mesh().vertex_matrix()
    diagonal = np.linalg.norm(points.max(0) - points.min(0))
    assert rms(got, expected) < 0.003 * diagonal
    assert np.linalg.norm(expected - points, axis=1).max() > 0.2 * diagonal


def absolute_zero():
    kind = pymeshlab.PureValue if hasattr(pymeshlab, "PureValue") else pymeshlab.AbsoluteValue
    return kind(0.0)


def rest_faces(ms):
    return ms.mesh(0).face_matrix()


def test_points_beside_the_surface_follow_it_and_matrices_count():
    ms = bent_bone()
    mesh = ms.mesh(0)
    free = mesh.vertex_matrix()[mesh.vertex_scalar_array() == 1]
    shifted = free + [3.0, 0, 0]
    cloud = pymeshlab.Mesh(shifted)
    ms.add_mesh(cloud, "landmarks")
    ms.apply_filter("set_matrix", transformmatrix=translation([-3, 0, 0]), freeze=False)
    ms.apply_filter(COPY, **LAYERS)
    moved = ms.current_mesh()
    assert np.abs(np.array(matrix(moved)) - translation([-3, 0, 0])).max() == 0
    expected = ms.mesh(3).vertex_matrix()[mesh.vertex_scalar_array() == 1] + [3.0, 0, 0]
    assert np.abs(moved.vertex_matrix() - expected).max() < 1e-6


def test_a_cloud_drives_a_cloud():
    ms = clean_bone()
    mesh = ms.current_mesh()
    ms.add_mesh(pymeshlab.Mesh(mesh.vertex_matrix(), v_normals_matrix=mesh.vertex_normal_matrix(), v_scalar_array=mesh.vertex_scalar_array()), "cloud")
    ms.apply_filter(DEFORM, **BEND)
    ms.set_current_mesh(1)
    ms.apply_filter(COPY, source_layer=1, rest_graph=2, deformed_graph=3)
    assert np.abs(ms.current_mesh().vertex_matrix() - ms.mesh(4).vertex_matrix()).max() < 1e-6
    assert np.abs(ms.current_mesh().vertex_normal_matrix() - ms.mesh(4).vertex_normal_matrix()).max() < 1e-3


def test_parts_that_are_close_stay_apart():
    # Two sheets a hundredth apart, joined nowhere: the upper one bends, the lower one is fixed.
    x, y = np.meshgrid(np.linspace(0, 1, 41), np.linspace(0, 1, 41))
    flat = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1)
    i = np.arange(40 * 41).reshape(40, 41)[:, :40].ravel()
    faces = np.concatenate([np.stack([i, i + 1, i + 41], 1), np.stack([i + 1, i + 42, i + 41], 1)])
    points = np.concatenate([flat, flat + [0, 0, 0.01]])
    tags = np.concatenate([np.zeros(len(flat)), np.where(flat[:, 0] < 0.2, 0, np.where(flat[:, 0] > 0.8, 2, 1))])
    ms = clean_bone()
    ms.add_mesh(pymeshlab.Mesh(points, np.concatenate([faces, faces + len(flat)]), v_scalar_array=tags.astype(float)), "sheets")
    ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.5]))
    between = flat[::7] + [0, 0, 0.002]
    ms.add_mesh(pymeshlab.Mesh(np.concatenate([between, between + [0, 0, 0.006]])), "points")
    ms.apply_filter(COPY, source_layer=1, rest_graph=2, deformed_graph=3)
    moved = ms.current_mesh().vertex_matrix()
    assert same_points(moved[:len(between)], between)
    assert (moved[len(between):, 2] - between[:, 2]).max() > 0.4


def test_all_visible_layers():
    ms = bent_bone()
    for name in ("one", "other"):
        ms.add_mesh(pymeshlab.Mesh(ms.mesh(0).vertex_matrix(), ms.mesh(0).face_matrix()), name)
    ms.set_current_mesh(3)
    ms.set_current_mesh_visibility(False)
    ms.set_current_mesh(0)
    result = ms.apply_filter(COPY, all_visible=True, **LAYERS)
    assert result["layers"] == 2
    assert [m.label() for m in ms][-2:] == ["one deformed", "other deformed"]
    for k in (6, 7):
        assert np.abs(ms.mesh(k).vertex_matrix() - ms.mesh(3).vertex_matrix()).max() < 1e-6


def test_no_other_layer_is_visible():
    ms = bent_bone()
    ms.set_current_mesh(3)
    ms.set_current_mesh_visibility(False)
    ms.set_current_mesh(0)
    with pytest.raises(pymeshlab.PyMeshLabException, match="No layer but the source and its graphs is visible. Show those"):
        ms.apply_filter(COPY, all_visible=True, **LAYERS)
    assert len(list(ms)) == 4


def test_a_source_that_is_posed_counts_at_rest():
    ms = bent_bone()
    before = ms.current_mesh().vertex_matrix()
    ms.apply_filter(POSE, translation=np.array([0, 0, 0.1]))
    ms.add_mesh(pymeshlab.Mesh(before), "points")
    ms.apply_filter(COPY, **LAYERS)
    assert np.abs(ms.current_mesh().vertex_matrix() - ms.mesh(3).vertex_matrix()).max() < 1e-6


@pytest.mark.parametrize("layers, word", [
    (dict(LAYERS, deformed_graph=1), "holds no deformation"),
    (dict(LAYERS, deformed_graph=3), "holds no deformation"),
    (dict(LAYERS, source_layer=3), "is not what"),
    (dict(LAYERS, rest_graph=2), "not the graph at rest"),
    (dict(LAYERS, rest_graph=0), "not the graph at rest"),
    (dict(LAYERS, source_layer=9), "must be layers of this document")])
def test_layers_that_do_not_belong_together(layers, word):
    ms = bent_bone()
    with pytest.raises(pymeshlab.PyMeshLabException, match=word):
        ms.apply_filter(COPY, **layers)
    assert len(list(ms)) == 4 and ms.current_mesh_id() == 0


def test_a_source_that_was_changed_and_a_graph_that_was_loaded(tmp_path):
    ms = bent_bone()
    ms.apply_filter("apply_coord_laplacian_smoothing", stepsmoothnum=1)
    with pytest.raises(pymeshlab.PyMeshLabException, match="was changed since"):
        ms.apply_filter(COPY, **LAYERS)
    ms = bent_bone()
    ms.set_current_mesh(2)
    ms.save_current_mesh(str(tmp_path / "graph.ply"))
    ms.load_new_mesh(str(tmp_path / "graph.ply"))
    ms.set_current_mesh(0)
    with pytest.raises(pymeshlab.PyMeshLabException, match="Deform the source again"):
        ms.apply_filter(COPY, source_layer=0, rest_graph=1, deformed_graph=4)
