# SPDX-License-Identifier: GPL-3.0-or-later
"""One deformation for many layers inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import re
import zlib

import numpy as np
import pymeshlab
import pytest

from conftest import QUALITY_TAGS, about, rotation, transformed, translation
from host_pymeshlab import COPY, DEFORM, POSE, assert_unchanged, clean_bone, matrix, new_set, same_points, set_quality, snapshot

BEND = dict(translation=np.array([0, 0.05, 0.25]), rotation_axis=np.array([0.0, 1, 0]), rotation_angle=-40.0)
SAVE_DEFORMATION = "save_fcd_deformation"
LAYERS = dict(source_layer=0, rest_graph=1, deformed_graph=2)


def bent_bone():
    """The bone (0), its graph (1), that deformed (2), the bone deformed (3); the bone is current."""
    ms = clean_bone()
    ms.apply_filter(DEFORM, **BEND)
    ms.set_current_mesh(0)
    return ms


def rms(a, b):
    return np.sqrt(((a - b) ** 2).sum(1).mean())


def test_how_far_vertices_went_is_an_attribute(tmp_path):
    ms = new_set()
    points = np.random.default_rng(1).normal(size=(300, 3))
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=points, v_scalar_array=np.where(points[:, 2] < -0.5, 0.0, np.where(points[:, 2] > 0.5, 2, 1))), "cloud")
    ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.5]), displacement=True)
    bent = ms.current_mesh()
    assert np.abs(bent.vertex_custom_point_attribute_matrix("fcd_displacement") - (bent.vertex_matrix() - points)).max() < 1e-12
    other = 0.9 * points[:50]
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=other), "other")
    ms.apply_filter(COPY, source_layer=0, rest_graph=1, deformed_graph=2, displacement=True)
    copy = ms.current_mesh()
    way = copy.vertex_custom_point_attribute_matrix("fcd_displacement")
    assert np.abs(way - (copy.vertex_matrix() - other)).max() < 1e-12 and np.abs(way).max() > 0.3
    ms.apply_filter(COPY, source_layer=0, rest_graph=1, deformed_graph=2, displacement=True)  # in the place of what it has
    again = ms.current_mesh()
    assert np.abs(again.vertex_custom_point_attribute_matrix("fcd_displacement") - (again.vertex_matrix() - copy.vertex_matrix())).max() < 1e-12


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


def touching_sheets():
    """A fixed sheet and, across it, another one that bends, whose vertices lie in the faces of the first, and its tags."""
    x, y = np.meshgrid(np.arange(21.0), np.arange(21.0))
    flat = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1)
    i = np.arange(20 * 21).reshape(20, 21)[:, :20].ravel()
    faces = np.concatenate([np.stack([i, i + 1, i + 21], 1), np.stack([i + 1, i + 22, i + 21], 1)])
    across = flat[:, [0, 2, 1]] + [0, 10, -10]  # its middle row is one of the first sheet's, too
    tags = np.concatenate([np.zeros(len(flat)), np.where(across[:, 0] < 3, 0, np.where(across[:, 0] > 17, 2, 1))])
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(np.concatenate([flat, across]), np.concatenate([faces, faces + len(flat)]), v_scalar_array=tags), "sheets")
    return ms, tags


@pytest.mark.parametrize("shift, least", [(0, 1.0), (0.5, 1.0)])
def test_a_layer_that_touches_itself_is_copied_as_it_was_deformed(shift, least):
    ms, tags = touching_sheets()
    if shift:  # to the middle of faces
        ms.apply_filter("compute_coord_by_function", x="x", y=f"vi < 441 ? y : y + {shift}", z="z")
    rest = ms.current_mesh().vertex_matrix()
    ms.apply_filter(DEFORM, translation=np.array([0, 0, 8.0]))
    expected = ms.current_mesh().vertex_matrix()
    assert np.linalg.norm(expected - rest, axis=1)[tags == 1].max() > least
    # The layer itself, and its vertices in another order, where normals tell those at one place apart.
    order = np.random.default_rng(1).permutation(len(rest))
    ms.add_mesh(pymeshlab.Mesh(rest[order], np.argsort(order)[ms.mesh(0).face_matrix()]), "shuffled")
    for layer, same in (0, np.arange(len(rest))), (4, order):
        ms.set_current_mesh(layer)
        ms.apply_filter(COPY)
        points = ms.current_mesh().vertex_matrix()
        assert np.abs(points - expected[same]).max() < 1e-9
        assert same_points(points[tags[same] == 0], rest[same][tags[same] == 0])


def hairpin(spacing, wave):
    """Two walls of 20 x 6, 0.1 apart and waved alike, that are one sheet, folded at x = 20. Points, faces, and which wall."""
    along = np.arange(0, 20 + 1e-9, spacing)
    x = np.r_[along, along[::-1]]
    top = np.r_[np.zeros(len(along)), np.ones(len(along))]
    y = np.arange(0, 6 + 1e-9, spacing)
    points = np.column_stack([np.repeat(x, len(y)), np.tile(y, len(x)), np.repeat(0.1 * top + wave * np.sin(np.pi * x / 2), len(y))])
    a = (np.arange(len(x) - 1)[:, None] * len(y) + np.arange(len(y) - 1)).ravel()
    faces = np.vstack([np.column_stack([a, a + len(y), a + 1]), np.column_stack([a + 1, a + len(y), a + len(y) + 1])])
    return points, faces, np.repeat(top, len(y)) > 0


@pytest.mark.parametrize("inside_out", [False, True])
def test_a_thin_copy_of_a_fold_drives_each_wall_as_its_own(inside_out):
    points, faces, top = hairpin(2, 0)  # the waves fall between its points
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=np.where(points[:, 0] > 1, 1.0, np.where(top, 2.0, 0.0))))
    ms.apply_filter(DEFORM, translation=np.array([0, 0, 5.0]))
    moved = ms.current_mesh().vertex_matrix()
    fine, triangles, upper = hairpin(0.25, 0.055)
    ms.add_mesh(pymeshlab.Mesh(fine, triangles[:, ::-1] if inside_out else triangles), "fine")
    ms.apply_filter(COPY, **LAYERS)
    lift = ms.current_mesh().vertex_matrix()[:, 2] - fine[:, 2]
    crests = (np.abs(fine[:, 0] % 2 - 1) < 1e-9) & (np.abs(fine[:, 1] - 3) < 2) & (np.abs(fine[:, 0] - 9) < 7)
    assert (crests & ~upper & (fine[:, 2] > 0.05)).sum() > 10, "these are nearer to the other wall"
    for wall, own in ((upper, top), (~upper, ~top)):
        rows = [(moved - points)[own & (points[:, 0] == x), 2].mean() for x in range(0, 21, 2)]
        expected = np.interp(fine[crests & wall, 0], range(0, 21, 2), rows)
        assert np.abs(lift[crests & wall] - expected).max() < 0.5  # the walls are 1 to 5 apart


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
    with pytest.raises(pymeshlab.PyMeshLabException, match="Only the source and its graphs are visible. Show the layers"):
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
    with pytest.raises(pymeshlab.PyMeshLabException, match="lose it. Deform the source again"):
        ms.apply_filter(COPY, source_layer=0, rest_graph=1, deformed_graph=4)


def test_the_layers_of_the_deformation_made_last_are_the_defaults(tmp_path):
    ms = bent_bone()
    ms.add_mesh(pymeshlab.Mesh(ms.mesh(0).vertex_matrix(), ms.mesh(0).face_matrix()), "points graph")
    for layer in 4, 3, 0:  # whichever is the current one
        ms.set_current_mesh(layer)
        ms.apply_filter(SAVE_DEFORMATION, deformation_file=str(tmp_path / f"{layer}.ply"))
        assert (tmp_path / f"{layer}.ply").read_bytes() == (tmp_path / "4.ply").read_bytes()
    ms.set_current_mesh(4)
    ms.apply_filter(COPY)
    assert np.abs(ms.current_mesh().vertex_matrix() - ms.mesh(3).vertex_matrix()).max() < 1e-6
    ms.set_current_mesh(3)  # the result, bent once more: layers 6 to 8
    set_quality(ms, QUALITY_TAGS)
    ms.apply_filter(DEFORM, translation=np.array([0, 0.1, 0.0]))
    ms.set_current_mesh(3)
    ms.apply_filter(COPY)
    assert np.abs(ms.current_mesh().vertex_matrix() - ms.mesh(8).vertex_matrix()).max() < 1e-6


def test_the_default_graph_is_one_that_holds_a_deformation(tmp_path):
    ms = bent_bone()
    for layer in 2, 1:  # the graphs, deformed and at rest
        ms.set_current_mesh(layer)
        ms.apply_filter("generate_copy_of_current_mesh")
    ms.set_current_mesh(1)
    ms.delete_current_mesh()
    ms.set_current_mesh(0)
    ms.apply_filter(SAVE_DEFORMATION, deformation_file=str(tmp_path / "a.ply"))
    assert (tmp_path / "a.ply").stat().st_size > 1000


def test_what_is_deformed_in_a_pose_is_saved_and_applied(tmp_path):
    other, ms = dict(translation=np.array([0, 0, 0.1])), clean_bone()
    ms.apply_filter(POSE, **other)
    posed = ms.current_mesh().vertex_matrix()
    ms.apply_filter(DEFORM, **BEND)
    expected = ms.current_mesh().vertex_matrix()
    ms.apply_filter(SAVE_DEFORMATION, deformation_file=str(tmp_path / "bend.ply"))
    assert rms(applied(posed, tmp_path / "bend.ply")[0], expected) < 1e-4
    ms.set_current_mesh(0)
    ms.apply_filter(COPY)
    assert np.abs(ms.current_mesh().vertex_matrix() - expected).max() < 1e-6
    ms.set_current_mesh(0)
    ms.apply_filter(POSE, pose=0.0)
    with pytest.raises(pymeshlab.PyMeshLabException, match="give it the pose that it had then"):
        ms.apply_filter(COPY)
    ms.apply_filter(POSE, **other)
    ms.apply_filter(COPY)
    assert np.abs(ms.current_mesh().vertex_matrix() - expected).max() < 1e-6


# --- a saved deformation --------------------------------------------------------------------------------------------------


def saved(ms, path, **layers):
    """Saves the deformation of LAYERS. Returns what the filter does."""
    return ms.apply_filter(SAVE_DEFORMATION, deformation_file=str(path), **{**LAYERS, **layers})


def applied(points, path, faces=None, normals=None):
    """Points that a saved deformation was applied to, in a session of its own, and their normals."""
    ms = new_set()
    arguments = {} if normals is None else {"v_normals_matrix": normals}
    ms.add_mesh(pymeshlab.Mesh(points, **arguments) if faces is None else pymeshlab.Mesh(points, faces), "points")
    ms.apply_filter(COPY, deformation_file=str(path))
    return ms.current_mesh().vertex_matrix(), ms.current_mesh().vertex_normal_matrix()


def test_parameters_of_saving_and_what_it_returns(tmp_path):
    ms = bent_bone()
    assert list(ms.filter_parameter_values(SAVE_DEFORMATION)) == ["source_layer", "rest_graph", "deformed_graph", "deformation_file", "accuracy", "inverse"]
    assert list(ms.filter_parameter_values(COPY)) == ["deformation_file", "source_layer", "rest_graph", "deformed_graph", "all_visible", "displacement"]
    before = snapshot(ms.mesh(0))
    result = saved(ms, tmp_path / "bend.ply")
    assert {key: type(value) for key, value in result.items()} == {
        "samples": int, "rms_difference": float, "largest_difference": float, "accuracy": float, "folded_vertices": int, "megabytes": float,
        "seconds": float}
    assert result["megabytes"] == pytest.approx((tmp_path / "bend.ply").stat().st_size / 1e6) and 0 < result["seconds"] < 600
    assert 1200 < result["samples"] <= ms.mesh(0).vertex_number() and result["largest_difference"] < 1e-4  # few enough to keep nearly all
    assert len(list(ms)) == 4 and ms.current_mesh_id() == 0
    assert_unchanged(before, ms.mesh(0))


def test_a_saved_deformation_in_another_session(tmp_path):
    ms = clean_bone()
    ms.apply_filter("meshing_surface_subdivision_midpoint", iterations=3, threshold=absolute_zero())
    set_quality(ms, QUALITY_TAGS)
    ms.apply_filter(DEFORM, **BEND)
    result = saved(ms, tmp_path / "bend.ply")
    assert 0 < result["rms_difference"] < result["largest_difference"] < 1.5e-4
    assert result["samples"] < ms.mesh(0).vertex_number() / 8 and (tmp_path / "bend.ply").stat().st_size < 2e6
    rest, expected = ms.mesh(0).vertex_matrix(), ms.mesh(3).vertex_matrix()
    points, _ = applied(rest, tmp_path / "bend.ply")
    error = np.linalg.norm(points - expected, axis=1)
    assert error.max() <= 1.001 * result["largest_difference"]
    fixed = ms.mesh(0).vertex_scalar_array() == 0
    assert same_points(points[fixed], rest[fixed]) and not same_points(points, rest)
    # In pieces, and through a mesh: the same bits.
    pieces = [applied(rest[k:k + 10000], tmp_path / "bend.ply")[0] for k in range(0, len(rest), 10000)]
    assert same_points(np.concatenate(pieces), points)
    assert same_points(applied(rest, tmp_path / "bend.ply", rest_faces(ms))[0], points)


def test_a_saved_deformation_is_as_exact_as_is_asked(tmp_path):
    ms = clean_bone()
    ms.apply_filter("meshing_surface_subdivision_midpoint", iterations=2, threshold=absolute_zero())
    set_quality(ms, QUALITY_TAGS)
    m = about([1.0, 2, 3], rotation([1, 2, 0.5], 70) * 2.5)
    ms.apply_filter("set_matrix", transformmatrix=m, freeze=False)
    ms.apply_filter(DEFORM, **BEND)
    rest, expected = transformed(m, ms.mesh(0).vertex_matrix()), transformed(m, ms.mesh(3).vertex_matrix())
    samples = []
    for accuracy in (0.01, 0.0001):  # of the world
        result = saved(ms, tmp_path / "bend.ply", accuracy=accuracy)
        points, _ = applied(rest, tmp_path / "bend.ply")
        assert np.linalg.norm(points - expected, axis=1).max() <= accuracy * 1.001 and result["accuracy"] == pytest.approx(accuracy)
        samples.append(result["samples"])
    assert samples[0] < samples[1]
    before = (tmp_path / "bend.ply").read_bytes()
    with pytest.raises(pymeshlab.PyMeshLabException, match="accuracy of a saved deformation must be a positive number, or 0"):
        saved(ms, tmp_path / "bend.ply", accuracy=-1.0)
    assert (tmp_path / "bend.ply").read_bytes() == before


def test_a_saved_deformation_turns_normals(tmp_path):
    ms = bent_bone()
    saved(ms, tmp_path / "bend.ply")
    rest = ms.mesh(0)
    _, normals = applied(rest.vertex_matrix(), tmp_path / "bend.ply", normals=rest.vertex_normal_matrix())
    turned = (normals * ms.mesh(3).vertex_normal_matrix()).sum(1)
    assert np.median(turned) > 0.999 and np.abs(np.linalg.norm(normals, axis=1) - 1).max() < 1e-6


def test_a_saved_deformation_stands_in_world_coordinates(tmp_path):
    ms = clean_bone()
    m = about([1.0, 2, 3], rotation([1, 2, 0.5], 70) * 2.5)
    ms.apply_filter("set_matrix", transformmatrix=m, freeze=False)
    ms.apply_filter(DEFORM, **BEND)
    ms.set_current_mesh(0)
    saved(ms, tmp_path / "bend.ply")
    rest, expected = transformed(m, ms.mesh(0).vertex_matrix()), transformed(m, ms.mesh(3).vertex_matrix())
    points, _ = applied(rest, tmp_path / "bend.ply")
    assert rms(points, expected) < 1e-4 < 0.1 < rms(rest, expected)
    # The target's own matrix counts, too, and fixed points keep their bits whatever it is.
    ms.apply_filter(COPY, deformation_file=str(tmp_path / "bend.ply"))
    moved = ms.current_mesh()
    assert rms(moved.vertex_matrix(), ms.mesh(3).vertex_matrix()) < 1e-4
    fixed = ms.mesh(0).vertex_scalar_array() == 0
    still = (moved.vertex_matrix()[fixed] == ms.mesh(0).vertex_matrix()[fixed]).all(1)
    assert still.mean() > 0.99  # rounding of the matrix may take a point across a border


def test_a_saved_deformation_of_a_cloud_and_of_a_posed_source(tmp_path):
    ms = clean_bone()
    mesh = ms.current_mesh()
    ms.add_mesh(pymeshlab.Mesh(mesh.vertex_matrix(), v_scalar_array=mesh.vertex_scalar_array()), "cloud")
    ms.apply_filter(DEFORM, **BEND)
    saved(ms, tmp_path / "nube á.ply", source_layer=1, rest_graph=2, deformed_graph=3)
    points, _ = applied(mesh.vertex_matrix(), tmp_path / "nube á.ply")
    assert rms(points, ms.mesh(4).vertex_matrix()) < 1e-4
    fixed = mesh.vertex_scalar_array() == 0
    assert same_points(points[fixed], mesh.vertex_matrix()[fixed])

    ms = bent_bone()
    rest = ms.current_mesh().vertex_matrix()
    ms.apply_filter(POSE, translation=np.array([0, 0, 0.1]))
    saved(ms, tmp_path / "posed.ply")
    assert rms(applied(rest, tmp_path / "posed.ply")[0], ms.mesh(3).vertex_matrix()) < 1e-4


def test_the_file_is_ply_and_all_visible_layers_take_it(tmp_path):
    ms = bent_bone()
    result = saved(ms, tmp_path / "bend.ply")
    ms.load_new_mesh(str(tmp_path / "bend.ply"))
    assert ms.current_mesh().vertex_number() == result["samples"] and ms.current_mesh().face_number() > 100
    other = new_set()
    for name in ("one", "other"):
        other.add_mesh(pymeshlab.Mesh(ms.mesh(0).vertex_matrix()), name)
    assert other.apply_filter(COPY, deformation_file=str(tmp_path / "bend.ply"), all_visible=True)["layers"] == 2
    assert same_points(other.mesh(2).vertex_matrix(), other.mesh(3).vertex_matrix())


def test_the_checksum_is_that_of_other_programs_and_tells_what_was_changed(tmp_path):
    ms = bent_bone()
    largest = saved(ms, tmp_path / "bend.ply")["largest_difference"]
    whole = (tmp_path / "bend.ply").read_bytes()
    line, = re.findall(rb"comment CRC-32 without this line [0-9a-f]{8}\n", whole)
    assert int(line[-9:], 16) == zlib.crc32(whole.replace(line, b""))
    assert float(re.findall(rb"comment largest difference (.*)\n", whole)[0]) == largest
    old = re.sub(rb"comment largest.*\ncomment CRC.*\n", b"", whole).replace(b"version 2", b"version 1")
    (tmp_path / "old.ply").write_bytes(old)
    rest = ms.mesh(0).vertex_matrix()
    assert same_points(applied(rest, tmp_path / "old.ply")[0], applied(rest, tmp_path / "bend.ply")[0])
    (tmp_path / "flip.ply").write_bytes(whole[:-100] + bytes([whole[-100] ^ 1]) + whole[-99:])
    with pytest.raises(pymeshlab.PyMeshLabException, match="was changed since it was written: its checksum does not fit"):
        ms.apply_filter(COPY, deformation_file=str(tmp_path / "flip.ply"))


def test_the_largest_difference_is_that_of_all_vertices(tmp_path, capfd):
    ms, _ = touching_sheets()
    ms.set_verbosity(True)
    rest = ms.current_mesh().vertex_matrix()
    ms.apply_filter(DEFORM, translation=np.array([0, 0, 8.0]))
    result = saved(ms, tmp_path / "bend.ply")
    points, _ = applied(rest, tmp_path / "bend.ply")
    error = np.linalg.norm(points - ms.mesh(3).vertex_matrix(), axis=1).max()
    assert error > 0.1 and abs(result["largest_difference"] - error) < 1e-6 * error
    assert re.search(r"\d+ vertices are farther off than [0-9.e-]+, up to [0-9.e-]+: parts at one place", capfd.readouterr().err)


def test_saving_twice_gives_the_same_file_and_an_error_leaves_it(tmp_path):
    ms = bent_bone()
    saved(ms, tmp_path / "one.ply")
    saved(ms, tmp_path / "two.ply")
    before = (tmp_path / "one.ply").read_bytes()
    assert before == (tmp_path / "two.ply").read_bytes()
    with pytest.raises(pymeshlab.PyMeshLabException, match="holds no deformation"):
        saved(ms, tmp_path / "one.ply", deformed_graph=1)
    assert (tmp_path / "one.ply").read_bytes() == before
    for path, words in (("", "deformation_file is empty"), (tmp_path / "no" / "such.ply", "Cannot write")):
        with pytest.raises(pymeshlab.PyMeshLabException, match=words):
            saved(ms, path)


def test_files_that_hold_no_deformation(tmp_path):
    ms = bent_bone()
    saved(ms, tmp_path / "bend.ply")
    ms.save_current_mesh(str(tmp_path / "mesh.ply"))
    whole = (tmp_path / "bend.ply").read_bytes()
    (tmp_path / "cut.ply").write_bytes(whole[:-1])
    for path, words in ((tmp_path / "none.ply", "Cannot open"), (tmp_path / "mesh.ply", "is no saved deformation"),
                        (tmp_path / "cut.ply", "incomplete")):
        with pytest.raises(pymeshlab.PyMeshLabException, match=words):
            ms.apply_filter(COPY, deformation_file=str(path))
    assert len(list(ms)) == 4 and ms.current_mesh_id() == 0
