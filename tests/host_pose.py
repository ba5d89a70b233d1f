# SPDX-License-Identifier: GPL-3.0-or-later
"""Posing a layer in place inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import gc
import tempfile
from pathlib import Path

import numpy as np
import pymeshlab
import pytest

from conftest import QUALITY_TAGS
from host_pymeshlab import DEFORM, POSE, RESET, absolute, allocated, assert_unchanged, clean_bone, new_set, same_points, set_quality, snapshot

BEND = dict(translation=np.array([0, 0, 0.25]), rotation_axis=np.array([0.0, 1, 0]), rotation_angle=-40.0)
LIFT = dict(translation=np.array([0, 0.1, 0.3]))


def deformed(ms, **parameters):
    """What FCD: Deform Mesh makes of the current layer: (points, vertex normals, face normals)."""
    current = ms.current_mesh_id()
    ms.apply_filter(DEFORM, graph_layers=False, **parameters)
    mesh = ms.current_mesh()
    result = mesh.vertex_matrix(), mesh.vertex_normal_matrix(), mesh.face_normal_matrix()
    ms.set_current_mesh(current)
    return result


def unit(normals):
    return normals / np.linalg.norm(normals, axis=1)[:, None]


def test_a_pose_in_place_is_the_deformed_layer():
    ms = clean_bone()
    before = snapshot(ms.current_mesh())
    expected, exact, faces = deformed(ms, **BEND)
    result = ms.apply_filter(POSE, **BEND)
    mesh = ms.current_mesh()
    assert not result["prepared"], "the deformed layer was made with the same deformer"
    assert result["converged"] and result["free_vertices"] == (before["quality"] == 1).sum()
    assert same_points(mesh.vertex_matrix(), expected)
    assert len(list(ms)) == 2 and ms.current_mesh_id() == 0
    for key in ("faces", "quality", "colors", "matrix", "selected"):
        assert same_points(before[key], snapshot(mesh)[key]), key
    assert np.abs(mesh.vertex_normal_matrix() - exact).max() < 1e-5
    assert np.abs(mesh.face_normal_matrix() - faces).max() < 1e-12
    assert np.allclose(mesh.bounding_box().min(), expected.min(0)) and np.allclose(mesh.bounding_box().max(), expected.max(0))
    # Otherwise they turn as the surface does; on this coarse mesh, that is not quite what the triangles have.
    ms.apply_filter(POSE, exact_normals=False, **BEND)
    mesh = ms.current_mesh()
    angle = np.degrees(np.arccos(np.clip((unit(mesh.vertex_normal_matrix()) * unit(exact)).sum(1), -1, 1)))
    assert np.median(angle) < 2 and 0.1 < np.percentile(angle, 99) < 20
    assert np.abs(mesh.face_normal_matrix() - faces).max() < 1e-12


def test_normals_of_a_layer_that_are_its_own_turn(tmp_path):
    mesh = clean_bone().current_mesh()
    points, faces = mesh.vertex_matrix(), mesh.face_matrix()
    lines = ["ply", "format ascii 1.0", f"element vertex {len(points)}", *(f"property double {name}" for name in ("x", "y", "z", "nx", "ny", "nz")),
             f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(repr, map(float, row))) for row in np.hstack([points, unit(mesh.vertex_normal_matrix() + [0, 0, 9.0])])]
    lines += [f"3 {a} {b} {c}" for a, b, c in faces]
    (tmp_path / "own.ply").write_text("\n".join(lines) + "\n")
    ms = new_set()
    ms.load_new_mesh(str(tmp_path / "own.ply"))
    normals = ms.current_mesh().vertex_normal_matrix()
    assert normals[:, 2].min() > 0.5, "as they are in the file"
    set_quality(ms, QUALITY_TAGS)
    expected = deformed(ms, **BEND)[1]
    moved = ms.current_mesh().vertex_scalar_array() != 0
    assert np.abs(expected - normals)[moved].max() > 0.1
    for exact in True, False:
        ms.apply_filter(POSE, exact_normals=exact, **BEND)
        assert np.abs(ms.current_mesh().vertex_normal_matrix() - expected).max() < 1e-5
    ms.apply_filter(RESET)
    assert same_points(ms.current_mesh().vertex_normal_matrix(), normals)


@pytest.mark.parametrize("angle", [20, 60, 90])
def test_normals_of_a_pose_are_those_of_its_faces(angle):
    ms = new_set()
    ms.load_new_mesh(str(Path(__file__).resolve().parents[1] / "meshes" / "cylinder.ply"))
    set_quality(ms, "z < 0.5 ? 0 : (z > 11.5 ? 2 : 1)")
    ms.apply_filter(POSE, rotation_axis=np.array([0.0, 1, 0]), rotation_angle=float(angle))
    mesh = ms.current_mesh()
    points, faces, normals = mesh.vertex_matrix(), mesh.face_matrix(), unit(mesh.vertex_normal_matrix())
    corner = points[faces]
    cross = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    expected = np.zeros_like(points)
    for k in range(3):
        a, b = unit(corner[:, (k + 1) % 3] - corner[:, k]), unit(corner[:, (k + 2) % 3] - corner[:, k])
        np.add.at(expected, faces[:, k], unit(cross) * np.arccos((a * b).sum(1))[:, None])
    assert np.degrees(np.arccos(np.clip((normals * unit(expected)).sum(1), -1, 1))).max() < 0.01


def test_poses_do_not_add_up():
    ms = clean_bone()
    rest = snapshot(ms.current_mesh())
    faces = ms.current_mesh().face_normal_matrix()
    ms.apply_filter(POSE, **BEND)
    bent = ms.current_mesh().vertex_matrix()
    assert not ms.apply_filter(POSE, **LIFT)["prepared"]
    assert not same_points(bent, ms.current_mesh().vertex_matrix())
    ms.apply_filter(POSE, **BEND)
    assert same_points(bent, ms.current_mesh().vertex_matrix())
    ms.apply_filter(POSE, pose=0.0, **BEND)
    assert_unchanged(rest, ms.current_mesh())
    ms.apply_filter(POSE, **BEND)
    ms.apply_filter(RESET)
    assert_unchanged(rest, ms.current_mesh())
    assert same_points(faces, ms.current_mesh().face_normal_matrix())


def test_other_tags_are_never_posed_as_those_before():
    ms = clean_bone()
    ms.apply_filter(POSE, **BEND)
    for tags in ("(x < 0.3) ? 0 : (x > 0.7) ? 3 : 1", "(x > 0.6) ? 0 : (x < 0.3) ? 2 : 1", QUALITY_TAGS):
        # The expression reads positions: those at rest.
        ms.apply_filter(RESET)
        set_quality(ms, tags)
        fresh = clean_bone()
        set_quality(fresh, tags)
        ms.apply_filter(POSE, **LIFT)
        ms.apply_filter(POSE, **BEND)
        assert same_points(ms.current_mesh().vertex_matrix(), deformed(fresh, **BEND)[0])


def test_tags_may_change_while_the_layer_is_posed():
    ms, fresh = clean_bone(), clean_bone()
    rest = ms.current_mesh().vertex_matrix()
    tags = np.where(rest[:, 0] < 0.5, 2.0, np.where(rest[:, 0] > 0.9, 0.0, 1.0))
    ms.apply_filter(POSE, **BEND)
    for each in (ms, fresh):
        each.apply_filter("set_selection_none")
        mesh = each.current_mesh()
        name = "other_tags"
        mesh.add_vertex_custom_scalar_attribute(tags, name)
    ms.apply_filter(POSE, handles=2, tag_attribute="other_tags", **LIFT)
    assert same_points(ms.current_mesh().vertex_matrix(), deformed(fresh, handles=2, tag_attribute="other_tags", **LIFT)[0])


@pytest.mark.parametrize("parameters", [dict(initial_patches=100), dict(random_seed=7), dict(weights=1), dict(influence=3.0),
                                        dict(graph_weights=1), dict(target_radius=absolute(0.05)), dict(smoothness=0.05)])
def test_a_deformer_is_used_only_for_what_it_was_made_for(parameters):
    ms = clean_bone()
    ms.apply_filter(POSE, **BEND)
    bent = ms.current_mesh().vertex_matrix()
    result = ms.apply_filter(POSE, **BEND, **parameters)
    assert "smoothness" not in parameters or not result["prepared"]
    assert not same_points(bent, ms.current_mesh().vertex_matrix())
    assert same_points(ms.current_mesh().vertex_matrix(), deformed(clean_bone(), **BEND, **parameters)[0])


def test_what_something_else_changed_is_not_undone():
    ms = clean_bone()
    rest = ms.current_mesh().vertex_matrix()
    ms.apply_filter(POSE, **BEND)
    ms.apply_filter("apply_coord_laplacian_smoothing", stepsmoothnum=1)
    before = snapshot(ms.current_mesh())
    with pytest.raises(pymeshlab.PyMeshLabException, match="changed since its last pose.*Reset Pose"):
        ms.apply_filter(POSE, **BEND)
    assert_unchanged(before, ms.current_mesh())
    ms.apply_filter(RESET, keep_shape=True)
    assert_unchanged(before, ms.current_mesh())
    ms.apply_filter(POSE, **LIFT)
    moved = ms.current_mesh().vertex_matrix()
    assert not same_points(moved, before["points"])
    ms.apply_filter(RESET)
    assert same_points(ms.current_mesh().vertex_matrix(), before["points"]) and not same_points(before["points"], rest)


def test_reset_undoes_what_moved_some_vertices_where_that_is_asked_for():
    ms = clean_bone()
    rest = snapshot(ms.current_mesh())
    ms.apply_filter(POSE, **BEND)
    ms.apply_filter("apply_coord_laplacian_smoothing", stepsmoothnum=1)
    before = snapshot(ms.current_mesh())
    with pytest.raises(pymeshlab.PyMeshLabException, match="would undo that, too.*to=2.*keep_shape"):
        ms.apply_filter(RESET)
    assert_unchanged(before, ms.current_mesh())
    ms.apply_filter(RESET, to=2)
    assert_unchanged(rest, ms.current_mesh())
    ms.apply_filter(POSE, **BEND)  # as if nothing had been
    assert same_points(ms.current_mesh().vertex_matrix(), deformed(clean_bone(), **BEND)[0])


@pytest.mark.parametrize("change", ["added", "remeshed", "deleted"])
def test_reset_never_scrambles_whatever_is_asked_for(change):
    ms = clean_bone()
    ms.apply_filter(POSE, **BEND)
    CHANGES[change](ms)
    ms.apply_filter("apply_coord_laplacian_smoothing", stepsmoothnum=1)
    before = snapshot(ms.current_mesh())
    with pytest.raises(pymeshlab.PyMeshLabException, match="no place for these"):
        ms.apply_filter(RESET, to=2)
    assert_unchanged(before, ms.current_mesh())


def mirror(ms):
    ms.apply_filter("apply_matrix_flip_or_swap_axis", flipx=True, freeze=True)


@pytest.mark.parametrize("move", ["turn", "mirror"])
@pytest.mark.parametrize("cloud", [False, True])
def test_applies_follow_a_layer_that_was_moved_as_a_whole(move, cloud):
    ms, fresh = clean_bone(), clean_bone()
    if cloud:
        mesh = ms.current_mesh()
        for each in ms, fresh:
            each.add_mesh(pymeshlab.Mesh(mesh.vertex_matrix(), v_normals_matrix=mesh.vertex_normal_matrix(), v_scalar_array=mesh.vertex_scalar_array()))
    for motion in BEND, LIFT:
        ms.apply_filter(POSE, **motion)
        ms.apply_filter(RESET, keep_shape=True)
    ms.apply_filter(POSE, **BEND)
    for each in ms, fresh:
        {"turn": turn, "mirror": mirror}[move](each)
        if not cloud: # whose normals this host leaves as they are
            each.apply_filter("compute_normal_per_vertex", weightmode="By Angle")
    size = np.ptp(fresh.current_mesh().vertex_matrix(), axis=0).max()
    ms.apply_filter(RESET, to=1)
    found, expected = ms.current_mesh(), fresh.current_mesh()
    assert np.abs(found.vertex_matrix() - expected.vertex_matrix()).max() < 1e-14 * size * 10
    if not cloud:
        assert (unit(found.vertex_normal_matrix()) * unit(expected.vertex_normal_matrix())).sum(1).min() > 0.999999
    ms.apply_filter(POSE, **LIFT)
    fresh.apply_filter(POSE, **LIFT)
    assert np.abs(ms.current_mesh().vertex_matrix() - fresh.current_mesh().vertex_matrix()).max() < 1e-6 * size


def test_a_flat_layer_that_was_turned_as_a_whole_goes_back():
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, 4, 40), np.linspace(0, 2, 20), indexing="ij"))
    first = np.arange(800).reshape(40, 20)[:-1, :-1].ravel()
    faces = np.concatenate([np.stack([first, first + 20, first + 1], 1), np.stack([first + 1, first + 20, first + 21], 1)])
    ms, fresh = pymeshlab.MeshSet(), pymeshlab.MeshSet()
    for each in ms, fresh:
        each.add_mesh(pymeshlab.Mesh(np.stack([x, y, 0 * x], 1), faces, v_scalar_array=np.where(x < 0.5, 0.0, np.where(x > 3.5, 2.0, 1.0))))
    ms.apply_filter(POSE, translation=np.array([0, 1.0, 0]))
    for each in ms, fresh:
        each.apply_filter("compute_matrix_from_translation_rotation_scale", freeze=True, rotationx=20.0, rotationz=30.0, translationy=0.7)
    ms.apply_filter(RESET, to=1)
    assert np.abs(ms.current_mesh().vertex_matrix() - fresh.current_mesh().vertex_matrix()).max() < 1e-9


def test_a_long_layer_of_many_points_is_known_to_be_moved_as_a_whole():
    """Sums over it are rounded by more than its points are."""
    points = np.random.default_rng(5).random((20000, 3)) * [1, 0.1, 0.03]
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(points, v_scalar_array=np.where(points[:, 0] < 0.25, 0.0, np.where(points[:, 0] > 0.75, 2.0, 1.0))))
    fresh = new_set()
    fresh.add_mesh(pymeshlab.Mesh(points))
    ms.apply_filter(POSE, initial_patches=60, **LIFT)
    for each in ms, fresh:
        turn(each)
    ms.apply_filter(RESET)
    assert np.abs(ms.current_mesh().vertex_matrix() - fresh.current_mesh().vertex_matrix()).max() < 1e-13


@pytest.mark.parametrize("filter", [POSE, RESET])
def test_the_log_says_that_the_rest_shape_follows(capfd, filter):
    ms = clean_bone()
    ms.apply_filter(POSE, **BEND)
    turn(ms)
    ms.set_verbosity(True)
    for said in True, False:
        capfd.readouterr()
        ms.apply_filter(filter)
        assert ("Something else has moved 'bone.ply' as a whole since its last pose" in capfd.readouterr().err) == said


def test_who_else_computed_normals_is_told_that_a_pose_gives_those_of_the_rest_shape(capfd):
    """Of a cloud, whose normals no pose can compute."""
    points = np.random.default_rng(1).random((3000, 3)) * [4, 1, 0.02]
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=points, v_normals_matrix=np.tile([0.0, 0, 1], (3000, 1)),
                               v_scalar_array=np.where(points[:, 0] < 1, 0, np.where(points[:, 0] > 3, 2, 1.0))))
    said = "Something else has computed the normals"

    def log(name, **parameters):
        capfd.readouterr()
        ms.set_verbosity(True)
        ms.apply_filter(name, **parameters)
        ms.set_verbosity(False)
        return capfd.readouterr().err

    assert said not in log(POSE, **LIFT)
    assert said not in log(POSE, **LIFT)
    ms.compute_normal_for_point_clouds(k=12)
    assert said in log(POSE, **LIFT)
    assert said not in log(POSE, **LIFT)
    ms.compute_normal_for_point_clouds(k=12)
    assert said in log(RESET)
    assert same_points(ms.current_mesh().vertex_normal_matrix(), np.tile([0.0, 0, 1], (3000, 1)))


def test_each_apply_can_be_taken_back():
    ms = clean_bone()
    shapes = [snapshot(ms.current_mesh())]
    for motion in BEND, LIFT, BEND:
        ms.apply_filter(POSE, **motion)
        ms.apply_filter(RESET, keep_shape=True)
        shapes.append(snapshot(ms.current_mesh()))
    ms.apply_filter(POSE, **LIFT) # which is not kept
    for shape in shapes[3], shapes[2], shapes[1]:
        ms.apply_filter(RESET)
        assert_unchanged(shape, ms.current_mesh())
    ms.apply_filter(POSE, **LIFT) # another way from there
    ms.apply_filter(RESET, keep_shape=True)
    for shape in shapes[1], shapes[0], shapes[0]:
        ms.apply_filter(RESET)
        assert_unchanged(shape, ms.current_mesh())


def test_back_to_the_shape_as_loaded_over_any_number_of_applies():
    ms = clean_bone()
    rest = snapshot(ms.current_mesh())
    for i in range(12): # more than are kept
        ms.apply_filter(POSE, **(BEND if i % 2 else LIFT))
        ms.apply_filter(RESET, keep_shape=True)
    without(ms, "vi < 5") # what is left is known
    ms.apply_filter(POSE, **LIFT)
    ms.apply_filter(RESET, to=1)
    left = {tuple(p) for p in ms.current_mesh().vertex_matrix()}
    assert len(left) > 0 and left <= {tuple(p) for p in rest["points"]}
    ms.apply_filter("apply_coord_laplacian_smoothing", stepsmoothnum=1)
    before = snapshot(ms.current_mesh())
    with pytest.raises(pymeshlab.PyMeshLabException, match="changed since its last pose"):
        ms.apply_filter(RESET, to=1)
    assert_unchanged(before, ms.current_mesh())


def test_deleted_vertices_do_not_hinder_and_new_ones_are_not_lost():
    ms = clean_bone()
    rest = ms.current_mesh().vertex_matrix()
    ms.apply_filter(POSE, **BEND)
    ms.apply_filter("set_selection_none")
    ms.apply_filter("compute_selection_by_condition_per_vertex", condselect="q == 2")
    ms.apply_filter("meshing_remove_selected_vertices")
    ms.apply_filter(RESET)
    left = {tuple(p) for p in ms.current_mesh().vertex_matrix()}
    assert len(left) > 0 and left <= {tuple(p) for p in rest}
    ms = clean_bone()
    ms.apply_filter(POSE, **BEND)
    ms.apply_filter("meshing_surface_subdivision_midpoint", iterations=1)
    before = snapshot(ms.current_mesh())
    with pytest.raises(pymeshlab.PyMeshLabException, match="4533 of its 6046 vertices were moved or made.*no place for these"):
        ms.apply_filter(RESET)
    assert_unchanged(before, ms.current_mesh())


def percent(value):
    return pymeshlab.PercentageValue(value) if hasattr(pymeshlab, "PercentageValue") else pymeshlab.Percentage(value)


@pytest.mark.parametrize("name, parameters", [("meshing_isotropic_explicit_remeshing", dict(targetlen=percent(3), iterations=3)),
                                              ("meshing_decimation_clustering", dict(threshold=percent(2)))])
def test_a_mesh_of_other_vertices_is_never_scrambled(name, parameters):
    ms = clean_bone()
    ms.apply_filter(POSE, **BEND)
    vertices = ms.current_mesh().vertex_number()
    ms.apply_filter(name, **parameters)
    before = snapshot(ms.current_mesh())
    assert len(before["points"]) < vertices, "a count would not tell"
    for filter in POSE, RESET:
        with pytest.raises(pymeshlab.PyMeshLabException, match="changed since its last pose.*keep_shape"):
            ms.apply_filter(filter)
        assert_unchanged(before, ms.current_mesh())
    ms.apply_filter(RESET, keep_shape=True)
    set_quality(ms, QUALITY_TAGS)
    ms.apply_filter(POSE, **LIFT)
    assert not same_points(before["points"], ms.current_mesh().vertex_matrix())


def without(ms, condition):
    ms.apply_filter("set_selection_none")
    ms.apply_filter("compute_selection_by_condition_per_vertex", condselect=condition)
    ms.apply_filter("meshing_remove_selected_vertices")


def test_what_is_left_of_a_posed_layer_is_posed_and_reset():
    ms, fresh = clean_bone(), clean_bone()
    ms.apply_filter(POSE, **BEND)
    for each in ms, fresh:
        without(each, "vi < 5")  # all others change their places in memory
    ms.apply_filter(POSE, **LIFT)
    assert same_points(ms.current_mesh().vertex_matrix(), deformed(fresh, **LIFT)[0])
    fresh.set_current_mesh(0)
    ms.apply_filter(RESET)
    assert same_points(ms.current_mesh().vertex_matrix(), fresh.current_mesh().vertex_matrix())
    ms.apply_filter(POSE, **BEND)
    assert same_points(ms.current_mesh().vertex_matrix(), deformed(fresh, **BEND)[0])


def test_normals_follow_faces_that_are_turned_between_poses():
    ms = clean_bone()
    rest = ms.current_mesh().vertex_normal_matrix()
    ms.apply_filter(POSE, **BEND)
    ms.apply_filter("meshing_invert_face_orientation")
    turned = ms.current_mesh().vertex_normal_matrix()
    ms.apply_filter(POSE, **BEND)
    assert ((unit(turned) * unit(ms.current_mesh().vertex_normal_matrix())).sum(1) > 0.8).all()
    ms.apply_filter(RESET)
    assert same_points(ms.current_mesh().vertex_normal_matrix(), -rest)


def test_pose_0_has_the_normals_of_rest_after_exact_ones():
    ms = clean_bone()
    set_quality(ms, "x < 0.3 ? (sin(900 * x) > 0.8 ? 0 : 1) : (x > 0.7 ? 2 : 1)")  # fixed points between free ones
    ms.apply_filter("set_selection_none")
    rest = snapshot(ms.current_mesh())
    normals = ms.current_mesh().vertex_normal_matrix()
    ms.apply_filter(POSE, exact_normals=True, **LIFT)
    ms.apply_filter(POSE, pose=0.0, **LIFT)
    assert_unchanged(rest, ms.current_mesh())
    assert same_points(ms.current_mesh().vertex_normal_matrix(), normals)


def test_errors_leave_the_layer_as_it_was():
    ms = clean_bone()
    with pytest.raises(pymeshlab.PyMeshLabException, match="has not been posed"):
        ms.apply_filter(RESET)
    for _ in range(2):
        before = snapshot(ms.current_mesh())
        for parameters, word in ((dict(transforms="3: scale 2"), "no vertex has tag 3"), (dict(initial_patches=-1), "patches"),
                                 (dict(handles=1), "selected"), (dict(transforms="2: scale 1e300"), "too far"),
                                 (dict(point_handles_file="/no/such.csv"), "no/such")):
            with pytest.raises(pymeshlab.PyMeshLabException, match=word):
                ms.apply_filter(POSE, **parameters)
            assert_unchanged(before, ms.current_mesh())
        ms.apply_filter(POSE, **BEND)


def test_points_and_their_normals(tmp_path):
    ms = clean_bone()
    mesh = ms.current_mesh()
    cloud = pymeshlab.Mesh(mesh.vertex_matrix(), v_normals_matrix=mesh.vertex_normal_matrix(), v_scalar_array=mesh.vertex_scalar_array())
    ms.add_mesh(cloud, "cloud")
    rest = snapshot(ms.current_mesh())
    points, normals, _ = deformed(ms, **BEND)
    ms.apply_filter(POSE, **BEND)
    assert same_points(ms.current_mesh().vertex_matrix(), points)
    assert np.abs(unit(ms.current_mesh().vertex_normal_matrix()) - normals).max() < 1e-5
    # Point handles are vertices at rest, whatever the pose.
    free = int(np.nonzero(rest["quality"] == 1)[0][7])
    start = rest["points"][free]
    path = tmp_path / "points.csv"
    path.write_text(",".join(repr(float(v)) for v in [*start, *(start + [0, 0.02, 0])]))
    ms.apply_filter(POSE, point_handles_file=str(path), **BEND)
    assert np.abs(ms.current_mesh().vertex_matrix()[free] - start - [0, 0.02, 0]).max() < 1e-9
    ms.apply_filter(RESET)
    assert_unchanged(rest, ms.current_mesh())


def test_a_new_layer_has_no_rest_shape_of_another():
    ms = clean_bone()
    ms.apply_filter(POSE, **BEND)
    posed = ms.current_mesh().vertex_matrix()
    ms.apply_filter(DEFORM, graph_layers=False, **LIFT)
    assert same_points(ms.mesh(0).vertex_matrix(), posed)
    with pytest.raises(pymeshlab.PyMeshLabException, match="has not been posed"):
        ms.apply_filter(RESET)
    ms.apply_filter(POSE, **LIFT)
    ms.set_current_mesh(0)
    ms.apply_filter(POSE, **BEND)
    assert same_points(ms.current_mesh().vertex_matrix(), posed)


def test_a_layer_matrix_counts():
    ms = clean_bone()
    ms.apply_filter("compute_matrix_from_translation_rotation_scale", translationx=1.0, rotationz=30.0, scalex=2.0, scaley=2.0, scalez=2.0, freeze=False)
    expected, _, faces = deformed(ms, **BEND)
    ms.apply_filter(POSE, **BEND)
    assert same_points(ms.current_mesh().vertex_matrix(), expected)
    assert np.abs(ms.current_mesh().face_normal_matrix() - faces).max() < 1e-12


def test_many_layers_keep_their_own():
    sets = [clean_bone() for _ in range(3)]
    for k, ms in enumerate(sets):
        ms.apply_filter(POSE, translation=np.array([0, 0, 0.1 * (k + 1)]))
    assert len({ms.current_mesh().vertex_matrix().tobytes() for ms in sets}) == 3


def test_deformers_of_what_is_gone_are_dropped():
    mesh = clean_bone().current_mesh()
    points, faces, tags = mesh.vertex_matrix() * 1.5, mesh.face_matrix(), mesh.vertex_scalar_array()

    def with_layers(count):
        ms = pymeshlab.MeshSet()
        for _ in range(count):
            ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=tags))
        return ms

    def is_prepared_anew(ms):
        return ms.apply_filter(POSE, **BEND)["prepared"]

    first, second = with_layers(1), with_layers(1)
    assert is_prepared_anew(first) and not is_prepared_anew(second), "one that is there serves for the same elsewhere"
    del first
    gc.collect()
    third = with_layers(3)
    assert is_prepared_anew(third)
    third.delete_current_mesh()
    assert is_prepared_anew(third) and not is_prepared_anew(second)


def test_a_document_that_is_closed_leaves_nothing_in_memory():
    def use(k):
        """Poses and deforms a sheet, none like another. Returns what is held before its document is closed. The graph is small, as
        that of the last layer stays until the next call."""
        ms = pymeshlab.MeshSet()
        ms.add_mesh(pymeshlab.Mesh(np.stack([x, y, k * np.sin(x)], 1), faces, v_scalar_array=tags))
        before = allocated()
        if k % 2: # one by its layers, one by its document
            ms.apply_filter(DEFORM, translation=np.array([0, 0, 30.0]), initial_patches=100)
            takes = allocated() - before
            for layer in list(ms):
                ms.set_current_mesh(layer.id())
                ms.delete_current_mesh()
            assert allocated() - before < takes / 3
            return takes
        ms.apply_filter(DEFORM, translation=np.array([0, 0, 30.0]), initial_patches=100)
        return allocated() - before

    x, y = (a.ravel().astype(float) for a in np.meshgrid(np.arange(120), np.arange(80), indexing="ij"))
    first = (np.arange(119)[:, None] * 80 + np.arange(79)).ravel()
    faces = np.concatenate([np.stack([first, first + 80, first + 1], 1), np.stack([first + 1, first + 80, first + 81], 1)])
    tags = np.where(x < 15, 0.0, np.where(x > 105, 2.0, 1.0))
    use(0)
    before = allocated()
    takes = [use(k) for k in range(1, 5)]
    assert min(takes) > 1e6 and allocated() - before < min(takes) / 2, (takes, allocated() - before)


# --- the table of docs/layers-changed.md: what becomes of a layer that was tagged, posed and then changed ----------------------------


def duplicate(ms):
    ms.apply_filter("generate_copy_of_current_mesh" if "generate_copy_of_current_mesh" in pymeshlab.filter_list() else "duplicate_current_layer")


def save_and_load(ms):
    path = str(Path(tempfile.mkdtemp()) / "layer.ply")
    ms.save_current_mesh(path)
    ms.load_new_mesh(path)


def merge(ms):
    ms.apply_filter("generate_by_merging_visible_meshes", deletelayer=False)


def freeze(ms):
    ms.apply_filter("compute_matrix_from_translation_rotation_scale", translationx=1.0, freeze=True)


def turn(ms):
    """About an axis of no plane of the coordinates, and by other filters after it."""
    for parameters in dict(rotationx=20.0, rotationz=30.0, translationy=0.7), dict(scalex=1.5, scaley=1.5, scalez=1.5), dict(scalex=1.2):
        ms.apply_filter("compute_matrix_from_translation_rotation_scale", freeze=True, **parameters)


CHANGES = {
    "none": lambda ms: None,
    "some moved": lambda ms: ms.apply_filter("apply_coord_laplacian_smoothing", stepsmoothnum=1),
    "all moved alike": turn,
    "deleted": lambda ms: without(ms, "vi > 1400"),
    "reordered": lambda ms: without(ms, "vi < 5"),
    "added": lambda ms: ms.apply_filter("meshing_surface_subdivision_midpoint", iterations=1),
    "remeshed": lambda ms: ms.apply_filter("meshing_isotropic_explicit_remeshing", targetlen=percent(3), iterations=3),
    "flipped faces": lambda ms: ms.apply_filter("meshing_invert_face_orientation"),
    "new colours": lambda ms: ms.compute_color_by_function_per_vertex(x="10", y="255 * x", z="51"),
    "new tags": lambda ms: set_quality(ms, "vi < 300 ? 0 : (vi > 1200 ? 2 : 1)"),
    "frozen matrix": freeze,
    "duplicated": duplicate,
    "merged": merge,
    "saved and loaded again": save_and_load,
}


def tagged_and_posed():
    """The bone with colours of its own, its quality 1, tagged and posed: (set, what it was at rest by its place there)."""
    ms = clean_bone()
    ms.compute_color_by_function_per_vertex(x="255 * x", y="100", z="50")
    set_quality(ms, "1")
    mesh = ms.current_mesh()
    rest, color = mesh.vertex_matrix(), mesh.vertex_color_matrix()
    for condition, role in (("x < 0.25", 0), ("x > 0.75", 2)):
        ms.compute_selection_by_condition_per_vertex(condselect=condition)
        ms.apply_filter("compute_fcd_tags_from_selection", role=role)
    ms.apply_filter("set_selection_none")
    ms.apply_filter(POSE, initial_patches=300, **BEND)  # where a remesher puts vertices, and mixes tags, hangs on the shape
    return ms, {tuple(p): tuple(c) for p, c in zip(rest, color)}


def outcome(ms, name, **parameters):
    """What a filter does, or says."""
    before = snapshot(ms.current_mesh())
    try:
        return ms.apply_filter(name, **parameters)
    except pymeshlab.PyMeshLabException as error:
        assert_unchanged(before, ms.current_mesh())
        return next(word for word in ("was changed since its last pose", "has not been posed in place", "nothing to bring back",
                                      "are whole numbers") if word in str(error))


def is_moved_alike(ms, change):
    """Whether the layer is the bone at rest, changed so."""
    fresh, _ = tagged_and_posed()
    fresh.apply_filter(RESET)
    CHANGES[change](fresh)
    expected, found = fresh.current_mesh().vertex_matrix(), ms.current_mesh().vertex_matrix()
    return expected.shape == found.shape and np.abs(expected - found).max() < 1e-12


@pytest.mark.skipif("apply_coord_cubic_stylization" not in pymeshlab.filter_list(), reason="this pymeshlab has no filter that replaces a mesh")
def test_what_went_with_a_replaced_mesh_is_told():
    ms, _ = tagged_and_posed()
    ms.apply_filter("apply_coord_cubic_stylization")
    with pytest.raises(pymeshlab.PyMeshLabException, match="If a filter has replaced its whole mesh since, its rest shapes are gone with the old mesh"):
        ms.apply_filter(RESET)
    ms.compute_selection_by_condition_per_vertex(condselect="x > 0.75")
    ms.apply_filter("compute_fcd_tags_from_selection", role=2)  # begins anew
    ms.apply_filter(POSE, **BEND)
    ms.apply_filter(RESET)


def reset_of(change):
    ms, rest = tagged_and_posed()
    CHANGES[change](ms)
    said = outcome(ms, RESET)
    points = {tuple(p) for p in ms.current_mesh().vertex_matrix()}
    return said if isinstance(said, str) else "at rest" if points <= set(rest) else "at rest, moved alike" if is_moved_alike(ms, change) else "scrambled"


def clear_of(change):
    ms, rest = tagged_and_posed()
    CHANGES[change](ms)
    said = outcome(ms, "clear_fcd_tags")
    if isinstance(said, str):
        return said
    mesh = ms.current_mesh()
    own = {*rest.values()}
    back = np.array([tuple(c) in own for c in mesh.vertex_color_matrix()]) & (mesh.vertex_scalar_array() == 1)
    assert said["other_vertices"] <= mesh.vertex_number()
    return "all" if back.all() and said["other_vertices"] == 0 else "those tagged" if back.any() else "quality" if (
        mesh.vertex_scalar_array() == 1).all() else "none"


def deform_of(change):
    ms, _ = tagged_and_posed()
    CHANGES[change](ms)
    shape = ms.current_mesh().vertex_matrix()
    said = outcome(ms, DEFORM, graph_layers=False, **LIFT)
    if isinstance(said, str):
        return said
    moved = np.linalg.norm(ms.current_mesh().vertex_matrix() - shape, axis=1)
    return "the present shape" if (moved == 0).any() and moved.max() <= 1.5 * np.linalg.norm(LIFT["translation"]) else "another shape"


def pose_of(change):
    ms, rest = tagged_and_posed()
    CHANGES[change](ms)
    shape = {tuple(p) for p in ms.current_mesh().vertex_matrix()}
    said = outcome(ms, POSE, pose=0.0, **LIFT)
    if isinstance(said, str):
        return said
    points = {tuple(p) for p in ms.current_mesh().vertex_matrix()}
    if points <= set(rest):
        return "the rest shape"
    return "the present shape" if points == shape else "the rest shape, moved alike" if is_moved_alike(ms, change) else "scrambled"


PHRASES = {"at rest": "the rest shape", "at rest, moved alike": "the rest shape, moved alike", "all": "all are back", "those tagged": "back where tagged", "quality": "the quality is back"}
REFUSALS = {"was changed since its last pose", "has not been posed in place", "nothing to bring back", "are whole numbers"}


def table():
    page = (Path(__file__).resolve().parents[1] / "docs" / "layers-changed.md").read_text(encoding="utf-8")
    rows = page[page.index("| changed | *Reset Pose*"):].split("\n\n")[0].splitlines()[2:]
    return {row[0]: row[1:] for row in ([cell.strip() for cell in line.strip("|").split("|")] for line in rows)}


@pytest.mark.parametrize("then", ["", "the posed one is posed again", "it is reset", "it is deleted", "the copy is posed"])
def test_a_copy_of_a_posed_layer_goes_back_as_that_does(then):
    """... and a part of it that another filter copies, whatever becomes of the layer that it comes from."""
    ms, _ = tagged_and_posed()
    ms.apply_filter(RESET, keep_shape=True)
    shapes = [None, ms.current_mesh().vertex_matrix()]
    ms.apply_filter(POSE, **LIFT)
    last = ms.current_mesh().vertex_matrix()
    duplicate(ms)
    copy = ms.current_mesh_id()
    assert copy != 0 and same_points(ms.current_mesh().vertex_matrix(), last)
    ms.set_current_mesh(0)
    if "again" in then:
        ms.apply_filter(POSE, translation=np.array([0, 0.1, 0]))
    elif "reset" in then:
        ms.apply_filter(RESET, to=1)
    elif "deleted" in then:
        ms.delete_current_mesh()
    ms.set_current_mesh(copy)
    if "copy" in then:
        ms.apply_filter(POSE, **LIFT)
        assert not same_points(ms.current_mesh().vertex_matrix(), last)
        ms.apply_filter(RESET)
        assert same_points(ms.current_mesh().vertex_matrix(), last)
    ms.apply_filter(RESET)
    assert same_points(ms.current_mesh().vertex_matrix(), shapes[1])
    ms.apply_filter(RESET)
    rest = ms.current_mesh().vertex_matrix()
    assert not same_points(rest, shapes[1])
    fresh, _ = tagged_and_posed()
    fresh.apply_filter(RESET)
    assert same_points(rest, fresh.current_mesh().vertex_matrix())


@pytest.mark.parametrize("then", ["", "what is left is posed again", "what is left is reset", "what is left is deleted"])
def test_a_part_that_is_moved_to_a_new_layer_goes_back(then):
    """Some of its vertices stay in the old layer, too: those of faces on both sides."""
    ms, rest = tagged_and_posed()
    ms.compute_selection_by_condition_per_face(condselect=f"fi < {ms.current_mesh().face_number() // 2}")
    ms.generate_from_selected_faces(deleteoriginal=True)
    part = ms.current_mesh_id()
    ms.set_current_mesh(0)
    if "again" in then:
        ms.apply_filter(POSE, translation=np.array([0, 0.1, 0]))
    elif "reset" in then:
        ms.apply_filter(RESET)
    elif "deleted" in then:
        ms.delete_current_mesh()
    ms.set_current_mesh(part)
    ms.apply_filter(RESET)
    assert {tuple(p) for p in ms.current_mesh().vertex_matrix()} <= set(rest)


@pytest.mark.parametrize("deleted", [False, True])
def test_a_layer_with_a_matrix_is_merged_with_its_rest_shapes(deleted):
    """Hosts merge layers in the world."""
    def placed():
        ms = clean_bone()
        ms.apply_filter("compute_matrix_from_translation_rotation_scale", translationx=1.0, rotationz=30.0, scalex=2.0, scaley=2.0, scalez=2.0, freeze=False)
        return ms
    ms, fresh = placed(), placed()
    ms.apply_filter(POSE, initial_patches=60, **LIFT)
    for each in ms, fresh:
        each.apply_filter("generate_by_merging_visible_meshes", deletelayer=deleted)
    ms.apply_filter(RESET)
    found, expected = ms.current_mesh(), fresh.current_mesh()
    assert same_points(found.vertex_matrix(), expected.vertex_matrix())
    assert np.abs(unit(found.vertex_normal_matrix()) - unit(expected.vertex_normal_matrix())).max() < 1e-9


@pytest.mark.parametrize("change", CHANGES)
def test_what_becomes_of_a_layer_that_was_changed(change):
    assert list(table()) == list(CHANGES)
    for cell, found in zip(table()[change], (reset_of(change), clear_of(change), deform_of(change), pose_of(change))):
        assert cell.startswith("refuses" if found in REFUSALS else PHRASES.get(found, found)), (cell, found)
