# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import ctypes
import gc
import os
import struct
from pathlib import Path

import numpy as np
import pymeshlab
import pytest

from conftest import LARGE_SCANS, MESHES, QUALITY_TAGS, SAMPLES, about, rotation, transformed, translation, unpacked, write_tags, write_transforms

pymeshlab.load_plugin(os.environ["FCD_PLUGIN"])
GRAPH, DEFORM = "generate_fcd_deformation_graph", "generate_fcd_deformed_mesh"
POSE, RESET, COPY = "apply_coord_fcd_deformation", "apply_coord_fcd_reset", "generate_fcd_deformed_copy"
IS_2022 = not hasattr(pymeshlab, "PureValue")
absolute = pymeshlab.AbsoluteValue if IS_2022 else pymeshlab.PureValue

GRAPH_DEFAULTS = {"target_radius": 0, "initial_patches": 0, "max_iterations": 100, "random_seed": 1, "patches_layer": True, "surface_layer": False}
DEFORM_DEFAULTS = {
    "handles": 0, "tag_attribute": "fcd_tag", "tag_file": "", "transform_file": "", "transforms": "", "point_handles_file": "",
    "translation": [0, 0, 0], "rotation_axis": [0, 0, 1], "rotation_angle": 0, "rotation_center": 0, "rotation_point": [0, 0, 0],
    "transformmatrix": np.eye(4), "handle_layer": 0, "use_graph_layer": False, "graph_layer": 0, "target_radius": 0, "initial_patches": 0,
    "random_seed": 1, "smoothness": 0.0058, "falloff": 0, "elastic": False, "rigidity": 1, "max_iterations": 1000, "tolerance": 1e-5, "graph_weights": 0, "weights": 0, "influence": 4,
    "loose_parts": 0, "weld_distance": 1e-6, "pose": 100, "pose_steps": 1, "graph_layers": True, "deformed_quality": 0, "displacement": False, "stop_at_contact": False}
OF_LAYERS = {"use_graph_layer", "graph_layer", "graph_layers", "deformed_quality", "displacement", "stop_at_contact"}
POSE_DEFAULTS = {**{name: value for name, value in DEFORM_DEFAULTS.items() if name not in OF_LAYERS}, "exact_normals": True, "contact": False}
SURFACE_RETURNS = {"components": int, "welded_vertices": int, "joined_vertices": int, "gap_vertices": int, "isolated_vertices": int, "non_manifold_edges": int,
                   "degenerate_faces": int}
GRAPH_RETURNS = {**SURFACE_RETURNS, "patches": int, "edges": int, "iterations": int, "converged": bool, "cost": float, "target_radius": float,
                 "average_edge": float, "seconds": float}
DEFORM_RETURNS = {**SURFACE_RETURNS, "loose_parts": int, "nodes": int, "iterations": int, "fixed_vertices": int, "handle_vertices": int, "free_vertices": int,
                  "outside_vertices": int, "pose_percent": float, "folded_triangles": int, "contact_triangles": int, "contact_depth": float, "strained_edges": int, "converged": bool, "energy": float,
                  "discretisation_error": float, "seconds_graph": float, "seconds_solve": float, "seconds_map": float, "steps": int, "jumps": bool, "stable": bool}


kept = []


def new_set():
    """A MeshSet that lives to the end: after an error in any filter, pymeshlab writes to the log of the set that had it."""
    kept.append(pymeshlab.MeshSet())
    return kept[-1]


def open_sample(name):
    ms = new_set()
    ms.load_new_mesh(str(SAMPLES / name))
    return ms


def layers(ms):
    return {m.label(): m for m in ms}


def matrix(mesh):
    return mesh.trasform_matrix() if IS_2022 else mesh.transform_matrix()


def set_quality(ms, expression):
    ms.apply_filter("compute_scalar_by_function_per_vertex", q=expression)


def same_points(a, b):
    """Equal to the bit."""
    return a.shape == b.shape and a.tobytes() == b.tobytes()


def clean_bone():
    """The bone without its isolated vertices, tagged by quality."""
    ms = open_sample("bone.ply")
    ms.apply_filter("meshing_remove_unreferenced_vertices")
    set_quality(ms, QUALITY_TAGS)
    return ms


class MallocInfo(ctypes.Structure):
    _fields_ = [(name, ctypes.c_size_t) for name in ("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks", "fordblks",
                                                     "keepcost")]


def allocated():
    """Bytes that somebody holds. What the allocator keeps to itself, as the sanitizers' does of what is freed, is not counted."""
    gc.collect()
    process = ctypes.CDLL(None)
    try:
        call = process.__getattr__("__sanitizer_get_current_allocated_bytes")
    except AttributeError:
        process.mallinfo2.restype = MallocInfo
        info = process.mallinfo2()
        return info.uordblks + info.hblkhd
    call.restype = ctypes.c_size_t
    return call()


def snapshot(mesh):
    return {"points": mesh.vertex_matrix(), "faces": mesh.face_matrix(), "quality": mesh.vertex_scalar_array(),
            "colors": mesh.vertex_color_matrix(), "normals": mesh.vertex_normal_matrix(), "matrix": np.array(matrix(mesh)),
            "selected": mesh.vertex_selection_array(), "visible": np.array(mesh.is_visible())}


def assert_unchanged(before, mesh):
    after = snapshot(mesh)
    for key in before:
        assert before[key].tobytes() == after[key].tobytes(), key


# --- interface ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name, defaults", [(GRAPH, GRAPH_DEFAULTS), (DEFORM, DEFORM_DEFAULTS), (POSE, POSE_DEFAULTS), (RESET, {"to": 0, "keep_shape": False})])
def test_parameters_names_order_and_defaults(name, defaults):
    assert name in pymeshlab.filter_list()
    values = open_sample("bone.ply").filter_parameter_values(name)
    assert list(values) == list(defaults)
    for key, value in defaults.items():
        if isinstance(value, (str, bool)):
            assert values[key] == value and type(values[key]) is type(value), key
        else:
            assert np.allclose(values[key], value, rtol=1e-6, atol=0), key


@pytest.mark.parametrize("name", [GRAPH, DEFORM, POSE, RESET, COPY])
def test_a_document_without_layers_is_an_error_and_no_crash(name):
    ms = new_set()
    with pytest.raises(pymeshlab.PyMeshLabException):
        ms.apply_filter(name)
    assert len(list(ms)) == 0


def test_many_calls_share_the_texts_of_their_parameters(tmp_path):
    """pymeshlab keeps the parameters of each call, with labels and help: 10 KB of this filter."""
    ms = clean_bone()
    held = []
    for _ in range(25):
        ms.apply_filter("save_fcd_tags", tag_file=str(tmp_path / "tags.sel"))
        held.append(allocated())
    assert held[-1] - held[4] < 20 * 6000


def check_returned(result, types):
    assert {key: type(value) for key, value in result.items()} == types
    assert all(np.isfinite(value) for value in result.values())


# --- graph --------------------------------------------------------------------------------------------------------------


def test_graph_layers():
    ms = open_sample("bunny10k_textured.obj")
    before = snapshot(ms.current_mesh())
    result = ms.apply_filter(GRAPH)
    check_returned(result, GRAPH_RETURNS)
    made = layers(ms)
    assert list(made) == ["bunny10k_textured.obj", "bunny10k_textured graph", "bunny10k_textured patches"]
    assert ms.current_mesh_id() == 0
    assert_unchanged(before, ms.mesh(0))

    graph, patches, mesh = made["bunny10k_textured graph"], made["bunny10k_textured patches"], ms.mesh(0)
    assert graph.vertex_number() == result["patches"] >= 300
    assert graph.edge_number() == result["edges"]
    assert graph.face_number() == 0
    assert (graph.vertex_scalar_array() >= 0).all() and graph.vertex_scalar_array().max() > 0

    # Quality is the number of the patch; nodes are vertices of their own patch; colours agree.
    number = patches.vertex_scalar_array().astype(int)
    assert patches.vertex_number() == mesh.vertex_number() and patches.face_number() == mesh.face_number()
    assert same_points(patches.vertex_matrix(), mesh.vertex_matrix())
    assert set(number) == set(range(result["patches"]))
    assert (patches.vertex_color_matrix() == graph.vertex_color_matrix()[number]).all()
    points = mesh.vertex_matrix()
    for node, center in enumerate(graph.vertex_matrix()):
        distance = np.linalg.norm(points - center, axis=1)
        assert number[distance == distance.min()][0] == node and distance.min() < 1e-4 * result["average_edge"]

    # Edges connect patches that touch, and neighbours have different colours.
    faces = mesh.face_matrix()
    pairs = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    touching = {tuple(sorted(p)) for p in number[pairs] if p[0] != p[1]}
    edges = {tuple(sorted(e)) for e in graph.edge_matrix()}
    assert edges == touching
    color = graph.vertex_color_matrix()
    assert all((color[a] != color[b]).any() for a, b in edges)


def test_graph_without_patches_layer_and_with_a_radius():
    ms = open_sample("bunny10k_textured.obj")
    many = ms.apply_filter(GRAPH, patches_layer=False)
    assert list(layers(ms)) == ["bunny10k_textured.obj", "bunny10k_textured graph"]
    wide = ms.apply_filter(GRAPH, patches_layer=False, initial_patches=20, target_radius=absolute(5.0))
    assert wide["target_radius"] == pytest.approx(5.0, rel=1e-6)
    assert wide["patches"] < many["patches"]
    assert list(layers(ms))[-1] == "bunny10k_textured graph(1)"


# --- deformation --------------------------------------------------------------------------------------------------------


def deform_bone(**parameters):
    """Deforms the bone; returns (set, result, rest points, deformed points, tags) after the checks that hold every time."""
    ms = clean_bone()
    before = snapshot(ms.current_mesh())
    result = ms.apply_filter(DEFORM, **parameters)
    check_returned(result, DEFORM_RETURNS)
    assert_unchanged(before, ms.mesh(0))
    deformed = ms.current_mesh()
    assert deformed.label() == "bone deformed"
    rest, points, tags = before["points"], deformed.vertex_matrix(), before["quality"].astype(int)
    assert np.isfinite(points).all()
    assert same_points(points[tags == 0], rest[tags == 0])
    for tag, key in ((0, "fixed_vertices"), (1, "free_vertices"), (2, "handle_vertices")):
        assert result[key] == (tags == tag).sum() > 0
    assert result["outside_vertices"] == 0
    return ms, result, rest, points, tags


def test_deformed_layers_and_handle():
    ms, result, rest, points, tags = deform_bone(translation=np.array([0.0, 0.0, 0.25]), rotation_axis=np.array([0.0, 2, 0]),
                                                 rotation_angle=-45.0)
    assert list(layers(ms)) == ["bone.ply", "bone graph", "bone deformed graph", "bone deformed"]
    graph, moved = ms.mesh(1), ms.mesh(2)
    assert graph.vertex_number() == moved.vertex_number() == result["nodes"]
    assert graph.edge_number() == moved.edge_number() > result["nodes"] / 2
    assert (graph.edge_matrix() == moved.edge_matrix()).all()
    assert (ms.current_mesh().face_matrix() == ms.mesh(0).face_matrix()).all()
    assert result["converged"] and result["iterations"] > 1

    # The rotation is about the barycentre of the handle, before the translation.
    motion = translation([0, 0, 0.25]) @ about(rest[tags == 2].mean(0), rotation([0, 1, 0], -45))
    expected = transformed(motion, rest[tags == 2])
    assert np.abs(points[tags == 2] - expected).max() < 1e-12
    # Free vertices move, each no further than the handle, about; and the surface does not tear.
    free = np.linalg.norm(points - rest, axis=1)[tags == 1]
    assert 0.05 < free.max() < 1.5 * np.linalg.norm(expected - rest[tags == 2], axis=1).max()
    faces = ms.mesh(0).face_matrix()
    length = lambda v: np.linalg.norm(v[faces[:, 0]] - v[faces[:, 1]], axis=1)
    stretch = length(points) / length(rest)
    assert np.percentile(stretch, 99) < 2 and np.percentile(stretch, 1) > 0.4

    # Normals are recomputed, and colours, quality as they were.
    normals = ms.current_mesh().face_normal_matrix()
    v = points[faces]
    expected_normals = np.cross(v[:, 1] - v[:, 0], v[:, 2] - v[:, 0])
    lengths = np.linalg.norm(expected_normals, axis=1)
    solid = lengths > 1e-12
    assert np.abs(normals[solid] - expected_normals[solid] / lengths[solid, None]).max() < 1e-6
    assert (ms.current_mesh().vertex_scalar_array() == ms.mesh(0).vertex_scalar_array()).all()


def test_normals_of_a_deformed_layer_are_those_that_meshlab_computes():
    """Of faces: unit; of vertices: their sums by angle, not of unit length; a vertex without a face keeps its own."""
    rng = np.random.default_rng(3)
    sheets = two_sheets(0.01).current_mesh()
    v, f, tags = sheets.vertex_matrix(), sheets.face_matrix(), sheets.vertex_scalar_array()
    v = np.vstack([v + rng.normal(0, 0.05, v.shape), [[0.3, 0.3, 50]]])
    order = rng.permutation(len(v))
    place = np.argsort(order)
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(v[order], place[f], v_scalar_array=np.append(tags, 1)[order]))
    before = ms.current_mesh().vertex_normal_matrix()
    ms.apply_filter("generate_fcd_deformed_mesh", transforms="2: rotate 0 1 0 50", graph_layers=False)
    mesh = ms.current_mesh()
    p, face = mesh.vertex_matrix(), mesh.face_matrix()
    expected = np.zeros_like(p)
    corner = p[face]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    for k in range(3):
        a, b = corner[:, (k + 1) % 3] - corner[:, k], corner[:, (k + 2) % 3] - corner[:, k]
        cosine = np.einsum("ij,ij->i", a, b) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
        np.add.at(expected, face[:, k], normal * np.arccos(cosine)[:, None])
    alone = place[len(v) - 1]
    expected[alone] = before[alone]
    assert np.abs(mesh.face_normal_matrix() - normal).max() < 1e-12
    assert np.abs(mesh.vertex_normal_matrix() - expected).max() < 1e-12
    box = mesh.bounding_box()
    assert (box.min() == p.min(axis=0)).all() and (box.max() == p.max(axis=0)).all()


def test_rotation_centers_and_matrix():
    point = np.array([0.5, 0.25, -0.125])
    turn = rotation([1, 0, 0], 30)
    scale = np.diag([1.25, 1.25, 1.25, 1.0])
    for center, at in ((1, np.zeros(3)), (2, point)):
        _, _, rest, points, tags = deform_bone(rotation_axis=np.array([1.0, 0, 0]), rotation_angle=30.0, rotation_center=center,
                                               rotation_point=point, transformmatrix=scale, graph_layers=False)
        expected = transformed(about(at, turn) @ scale, rest[tags == 2])
        assert np.abs(points[tags == 2] - expected).max() < 1e-12
    # The barycentre is that of the handle after the matrix.
    _, _, rest, points, tags = deform_bone(rotation_axis=np.array([1.0, 0, 0]), rotation_angle=30.0, transformmatrix=scale)
    handle = transformed(scale, rest[tags == 2])
    assert np.abs(points[tags == 2] - transformed(about(handle.mean(0), turn), handle)).max() < 1e-12


def test_no_motion_leaves_the_mesh_as_it_is():
    _, _, rest, points, _ = deform_bone()
    assert np.abs(points - rest).max() < 1e-6
    _, _, rest, points, _ = deform_bone(translation=np.array([0, 0, 0.5]), pose=0.0)
    assert np.abs(points - rest).max() < 1e-6


def test_pose():
    ends = []
    for pose in (50.0, 100.0, 150.0):
        _, _, rest, points, tags = deform_bone(translation=np.array([0, 0, 0.25]), pose=pose)
        ends.append((points - rest)[tags == 2])
    for end, fraction in zip(ends, (0.5, 1, 1.5)):
        assert np.abs(end - [0, 0, 0.25 * fraction]).max() < 1e-9


def test_same_seed_gives_the_same_bits():
    motion = dict(translation=np.array([0, 0, 0.25]), graph_layers=False)
    first, second, third = (deform_bone(random_seed=seed, **motion)[3] for seed in (1, 1, 2))
    assert same_points(first, second) and not same_points(first, third)


def test_parameters_that_shape_the_result_have_an_effect():
    motion = dict(rotation_axis=np.array([0.0, 1, 0]), rotation_angle=60.0, graph_layers=False)
    base = deform_bone(**motion)[3]
    for change in ({"smoothness": 0.1}, {"influence": 2.0}, {"initial_patches": 40},
                   {"target_radius": absolute(0.2)}, {"max_iterations": 2}):
        assert np.abs(deform_bone(**motion, **change)[3] - base).max() > 1e-5, change
    assert deform_bone(**motion, max_iterations=2)[1]["converged"] is False
    assert deform_bone(**motion, tolerance=1e-9)[1]["iterations"] > deform_bone(**motion)[1]["iterations"]


def test_weights_along_the_surface_do_not_cross_a_gap():
    """A sheet folded like a hairpin: one end fixed, the other, which lies close above the middle, is lifted."""
    n, m, gap = 60, 12, 0.02
    along = np.linspace(0, 2, n)
    across = np.linspace(0, 0.4, m)
    u, w = np.meshgrid(along, across, indexing="ij")
    x = np.where(u < 1, u, 2 - u)
    points = np.column_stack([x.ravel(), w.ravel(), np.where(u < 1, 0, gap).ravel()])
    i, j = np.meshgrid(np.arange(n - 1), np.arange(m - 1), indexing="ij")
    a = (i * m + j).ravel()
    faces = np.vstack([np.column_stack([a, a + m, a + 1]), np.column_stack([a + 1, a + m, a + m + 1])])
    tags = np.where(u < 0.1, 0.0, np.where(u > 1.9, 2.0, 1.0)).ravel()
    low = (u > 0.15).ravel() & (u < 0.3).ravel()  # close to the fixed end, right under the handle
    lifted = {}
    for weights in (0, 1):
        ms = new_set()
        ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=tags), "hairpin")
        ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.2]), weights=weights, graph_layers=False, initial_patches=80)
        lifted[weights] = (ms.current_mesh().vertex_matrix() - points)[low, 2].max()
    assert lifted[0] < 0.04 and lifted[1] > 2 * lifted[0]


def test_loose_parts_follow_or_stay():
    two = open_sample("bone.ply")
    two.apply_filter("meshing_remove_unreferenced_vertices")
    points, faces = two.current_mesh().vertex_matrix(), two.current_mesh().face_matrix()
    button = np.array([[0.9, 0.5, 0.9], [0.95, 0.5, 0.9], [0.9, 0.55, 0.9], [0.9, 0.5, 0.95]])
    cap = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    tags = np.where(points[:, 0] < 0.25, 0.0, np.where(points[:, 0] > 0.75, 2.0, 1.0))
    moved = {}
    for choice in (0, 1):
        ms = new_set()
        ms.add_mesh(pymeshlab.Mesh(np.vstack([points, button]), np.vstack([faces, cap + len(points)]),
                                   v_scalar_array=np.append(tags, np.ones(4))), "two")
        ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.25]), loose_parts=choice, graph_layers=False)
        assert ms.current_mesh().label() == "two deformed"
        moved[choice] = ms.current_mesh().vertex_matrix()[-4:] - button
    assert np.abs(moved[0] - [0, 0, 0.25]).max() < 1e-6
    assert np.abs(moved[1]).max() < 1e-9


def test_negative_tags_are_never_moved():
    ms = clean_bone()
    set_quality(ms, "(x < 0.2) ? 0-1 : ((x < 0.3) ? 0 : ((x > 0.75) ? 2 : 1))")
    tags, rest = ms.current_mesh().vertex_scalar_array(), ms.current_mesh().vertex_matrix()
    result = ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.25]))
    assert result["outside_vertices"] == (tags < 0).sum() > 0
    assert same_points(ms.current_mesh().vertex_matrix()[tags <= 0], rest[tags <= 0])


def test_what_was_met_is_returned_and_logged(capfd):
    """A sheet, cut along a seam; three triangles on one edge; a lone triangle; faces without area; vertices without faces."""
    n = 12
    x, y = (a.ravel().astype(float) for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    quads = np.vstack([np.column_stack([a, a + n, a + 1]), np.column_stack([a + 1, a + n, a + n + 1])])
    sheet = np.column_stack([x, y, 0 * x])
    fan = np.array([[0, 20, 0], [1, 20, 0], [0, 21, 0], [0, 19, 0], [0.5, 20, 1]])
    lone = np.array([[40, 0, 0], [41, 0, 0], [40, 1, 0]])
    points = np.vstack([sheet, sheet + [n - 1, 0, 0], fan, lone, [[50, 0, 0], [51, 0, 0]]])  # the two sheets share n places
    start = 2 * n * n
    faces = np.vstack([quads, quads + n * n, start + np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]]), start + 5 + np.array([[0, 1, 2]]),
                       [[0, 0, 1], [n - 1, n - 1, n - 1]]])
    tags = np.where(points[:, 1] < 2.5, 0.0, np.where(points[:, 1] > 8.5, 2.0, 1.0))
    tags[start + 5:] = 1  # nothing holds the lone triangle and the vertices without faces
    expected = {"components": 5, "welded_vertices": n, "isolated_vertices": 2, "non_manifold_edges": 1, "degenerate_faces": 2}
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=tags), "met")
    ms.set_verbosity(True)
    sentence = (f"5 connected parts, {n} vertices at the place of another (treated as one), 2 isolated vertices, "
                "1 non-manifold edges, 2 degenerate faces.")
    # Of a deformation, what is free and what holds it counts: not the fan, and eight of the shared places.
    free = (tags[:n] == 1).sum()
    bent = {**expected, "components": 4, "welded_vertices": free + 2, "non_manifold_edges": 0, "degenerate_faces": 0, "loose_parts": 3}
    bent_sentence = f"4 connected parts, {free + 2} vertices at the place of another (treated as one), 2 isolated vertices."
    for name, parameters, more, said in ((GRAPH, {}, {}, ""), (DEFORM, {}, bent, "3 parts are loose"),
                                         (DEFORM, {"loose_parts": 1}, bent, "staying in place")):
        ms.set_current_mesh(0)
        capfd.readouterr()
        result = ms.apply_filter(name, **parameters)
        log = capfd.readouterr().err
        for key, value in {**expected, **more}.items():
            assert result[key] == value, key
        assert (bent_sentence if more else sentence) in log and said in log, log


def deform_logged(ms, capfd, **parameters):
    """(returned values, log) of a deformation. After an error in any filter pymeshlab logs no more, hence the tests that read
    the log come first."""
    ms.set_verbosity(True)
    capfd.readouterr()
    result = ms.apply_filter(DEFORM, **parameters)
    return result, capfd.readouterr().err


def test_very_many_regions_share_a_graph_and_the_log_says_so(capfd):
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
    points = (triangle + np.stack([np.arange(1100.0) * 3, np.zeros(1100), np.zeros(1100)], 1)[:, None]).reshape(-1, 3)
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(points, np.arange(3300).reshape(-1, 3), v_scalar_array=np.tile([0.0, 1, 2], 1100)))
    _, log = deform_logged(ms, capfd, transforms="2: translate 0 0 1")
    assert "so many regions that 101 of them, the smallest, share one deformation graph" in log
    moved = ms.current_mesh().vertex_matrix()
    assert (moved[::3] == points[::3]).all() and np.abs(moved[2::3] - points[2::3] - [0, 0, 1]).max() < 1e-6
    assert (np.abs(moved[1::3] - points[1::3]).max(axis=1) < 1).all()


def test_many_regions_that_could_have_more_patches_have_fewer_and_the_log_says_so(capfd):
    around, along, count = 28, 24, 190
    angle, z = (a.ravel() for a in np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(along) * 0.23, indexing="ij"))
    a = (np.arange(around)[:, None] * along + np.arange(along - 1)).ravel()
    b = ((np.arange(around)[:, None] + 1) % around * along + np.arange(along - 1)).ravel()
    tube, faces = np.column_stack([np.cos(angle), np.sin(angle), z]), np.vstack([np.column_stack([a, b, a + 1]), np.column_stack([b, b + 1, a + 1])])
    tags = np.where(z < 0.1, 0.0, np.where(z > 5.2, 2.0, 1.0))
    points = np.concatenate([tube + [4 * k, 0, 0] for k in range(count)])
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(points, np.concatenate([faces + len(tube) * k for k in range(count)]),
                               v_scalar_array=np.tile(tags, count)))
    result, log = deform_logged(ms, capfd, transforms="2: rotate 1 0 0 30")
    assert f"so many regions that {count} of them have fewer patches than they would have alone" in log
    moved = ms.current_mesh().vertex_matrix()
    one = new_set()
    one.add_mesh(pymeshlab.Mesh(tube, faces, v_scalar_array=tags))
    alone, log = deform_logged(one, capfd, transforms="2: rotate 1 0 0 30")
    assert "fewer patches" not in log
    assert result["nodes"] < count * alone["nodes"] and (moved[::along] == points[::along]).all()


def slender(around=24, along=67):
    """A tube of length 11 and radius 1 along z, its ends tagged 0 and 2."""
    angle, z = (a.ravel() for a in np.meshgrid(np.arange(around) * 2 * np.pi / around, np.linspace(0, 11, along), indexing="ij"))
    a = (np.arange(around)[:, None] * along + np.arange(along - 1)).ravel()
    b = ((np.arange(around)[:, None] + 1) % around * along + np.arange(along - 1)).ravel()
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=np.column_stack([np.cos(angle), np.sin(angle), z]),
                               face_matrix=np.vstack([np.column_stack([a, b, a + 1]), np.column_stack([b, b + 1, a + 1])]),
                               v_scalar_array=np.where(z < 0.7, 0.0, np.where(z > 10.3, 2.0, 1.0))))
    return ms


@pytest.mark.parametrize("translation, said", [
    ([0, 0, 0], "it stays where it is"), ([0, 1, 0], "translation, rotation and matrix of the dialog move it")])
def test_the_log_says_what_becomes_of_a_handle_that_is_not_in_the_text(capfd, translation, said):
    ms = slender()
    set_quality(ms, "(z < 0.7) ? 3 : ((z > 10.3) ? 2 : 1)")
    _, log = deform_logged(ms, capfd, transforms="2: translate 1 0 0", translation=translation)
    assert f"Handle 3 is not in transforms: {said}" in log


@pytest.mark.parametrize("motion, sentence", [
    ("translate 0 0 -4", "the handles press or twist it too far"), ("translate 0 0 -25", "The shape jumps to another one")])
def test_the_log_says_what_becomes_of_what_is_pressed(capfd, motion, sentence):
    result, log = deform_logged(slender(), capfd, transforms="2: " + motion, pose_steps=4 if "-25" in motion else 1)
    assert sentence in log and (result["jumps"] if "jumps" in sentence else not result["stable"])


def test_a_squeezed_limb_gets_thicker_and_the_log_says_where_nothing_can(capfd):
    thickness = []
    for elastic in (False, True):
        ms = slender()
        _, log = deform_logged(ms, capfd, transforms="2: translate 0 0 -2", elastic=elastic)
        thickness.append(np.hypot(*ms.current_mesh().vertex_matrix()[:, :2].T).max())
        assert "that 'elastic' could keep" not in log
    assert thickness[1] > thickness[0] + 0.05
    _, log = deform_logged(slender(), capfd, transforms="2: translate 0 0 80", elastic=True)
    assert "The volume of the free surface is off by" in log
    x, y = (a.ravel() for a in np.meshgrid(np.arange(20.0), np.arange(20.0), indexing="ij"))
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(np.column_stack([x, y, 0 * x]), v_scalar_array=np.where(x < 3, 0.0, np.where(x > 16, 2.0, 1.0))))
    _, log = deform_logged(ms, capfd, transforms="2: translate 0 0 3", elastic=True)
    assert "1 free part encloses no volume that 'elastic' could keep" in log


def test_landmarks_of_what_was_sheared_lead_it_without_rigidity(tmp_path, capfd):
    off = []
    for rigidity in (1.0, 0.0):
        ms = slender()
        at = ms.current_mesh().vertex_matrix()
        sheared = at @ [[1, 0, 0], [0.3, 1.1, 0], [0.1, -0.2, 0.9]]
        set_quality(ms, "1")
        points = np.arange(0, len(at), 61)
        file = point_file(tmp_path / "points.csv", "index", points, at[points], sheared[points])
        result, _ = deform_logged(ms, capfd, point_handles_file=file, rigidity=rigidity)
        assert result["converged"]
        off.append(np.abs(ms.current_mesh().vertex_matrix() - sheared).max())
    assert off[1] < 1e-6 < 1e-2 < off[0]


def test_the_log_says_where_there_are_too_few_patches(capfd):
    errors = []
    for patches in (20, 600):
        result, log = deform_logged(slender(), capfd, transforms="2: rotate 0 1 0 60", initial_patches=patches)
        errors.append(result["discretisation_error"])
        assert ("With so few patches, the shape is off by about" in log) == (errors[-1] > 0.01)
    assert errors[0] > 0.01 > 2 * errors[1] > 0


def test_the_log_says_how_many_vertices_are_not_those_that_were_tagged(capfd):
    ms = clean_bone()
    set_quality(ms, "0")
    ms.compute_selection_by_condition_per_vertex(condselect="x < 0.25")
    ms.apply_filter("compute_fcd_tags_from_selection", role=0)
    tagged = ms.current_mesh().vertex_number()
    ms.apply_filter("meshing_surface_subdivision_midpoint", iterations=1)
    ms.compute_selection_by_condition_per_vertex(condselect="x > 0.4 && x < 0.5")
    ms.compute_color_by_function_per_vertex(x="10", y="20", z="30", onselected=True)
    vertices, painted = ms.current_mesh().vertex_number(), ms.current_mesh().selected_vertex_number()
    ms.set_verbosity(True)
    capfd.readouterr()
    new = ms.apply_filter("clear_fcd_tags")["new_vertices"]
    log = capfd.readouterr().err
    assert f"{painted} of the {vertices} vertices of 'bone.ply' were made, coloured or given" in log
    assert f"{new} of the {vertices} vertices of 'bone.ply' were made by something else since they were tagged: they have what" in log
    assert vertices - tagged - painted <= new < vertices - tagged


@pytest.mark.parametrize("factor, shift, points, said", [
    (1, 0, 1000, None), (1, 1, 1000, None), (1, 1000, 1000, "apart: a deformation means nothing"), (1000, 0, 1000, "across and the source"),
    (0.001, 0, 1000, "across and the source"), (0.001, 0, 20, None)])
@pytest.mark.parametrize("is_file", [False, True])
def test_a_layer_that_is_elsewhere_or_in_other_units_is_logged(tmp_path, capfd, factor, shift, points, said, is_file):
    ms = clean_bone()
    ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.25]))
    file = {}
    if is_file:
        file["deformation_file"] = str(tmp_path / "bend.ply")
        ms.apply_filter("save_fcd_deformation", **file)
    ms.add_mesh(pymeshlab.Mesh(ms.mesh(0).vertex_matrix()[:points] * factor + [shift, 0, 0]), "other")
    ms.set_verbosity(True)
    capfd.readouterr()
    ms.apply_filter(COPY, **file)
    log = capfd.readouterr().err
    assert (said in log and "The layer 'other' is " in log) if said else "same place and units" not in log, log


def test_the_log_says_how_many_nodes_of_a_graph_layer_lie_on_the_surface(capfd):
    ms = clean_bone()
    k = ms.apply_filter(GRAPH, initial_patches=60, patches_layer=False)["patches"]
    nodes = ms.mesh(1).vertex_matrix()
    ms.add_mesh(pymeshlab.Mesh(np.vstack([nodes, nodes[:k // 2] + [100, 0, 0]])), "more")
    for layer, said in ((1, f"{k} of the {k} nodes of 'bone graph' lie on the surface."),
                        (2, f"{k} of the {k + k // 2} nodes of 'more' lie on the surface; the others are left out.")):
        ms.set_current_mesh(0)
        _, log = deform_logged(ms, capfd, use_graph_layer=True, graph_layer=layer, translation=np.array([0, 0, 0.25]), graph_layers=False)
        assert said in log, log


def test_a_graph_that_was_kept_deforms_to_the_same_bits(tmp_path, capfd):
    ms = clean_bone()
    motion = dict(translation=np.array([0, 0, 0.25]))
    ms.apply_filter(DEFORM, **motion)
    first = ms.current_mesh().vertex_matrix()
    for layer, name in ((1, "graph.ply"), (0, "bone.ply")):
        ms.set_current_mesh(layer)
        ms.save_current_mesh(str(tmp_path / name))
    again = new_set()
    again.load_new_mesh(str(tmp_path / "bone.ply"))
    again.load_new_mesh(str(tmp_path / "graph.ply"))
    graph = dict(use_graph_layer=True, graph_layer=1)
    for each in (ms, again):
        each.set_current_mesh(0)
        _, log = deform_logged(each, capfd, **graph, **motion)
        assert "is the graph that these parameters make here" in log
        assert same_points(each.current_mesh().vertex_matrix(), first)
    again.set_current_mesh(0)
    _, log = deform_logged(again, capfd, random_seed=5, **graph, **motion)
    assert "Their patches are grown anew" in log


def test_a_graph_layer_is_known_by_what_it_is(capfd):
    """Whatever becomes of its name and its quality; a copy of it, too, also where it is gone itself. The graph of the current layer is the default."""
    ms = clean_bone()
    ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.25]))
    first = ms.current_mesh().vertex_matrix()
    ms.add_mesh(pymeshlab.Mesh(*sheet(20)), "sheet")
    ms.apply_filter(GRAPH, patches_layer=False)
    ms.set_current_mesh(1)
    ms.generate_copy_of_current_mesh()
    copy = ms.current_mesh().id()
    for gone in (False, True):
        if gone:
            ms.set_current_mesh(1)
            ms.delete_current_mesh()
        for layer in (copy,) if gone else (copy, 1):
            ms.set_current_mesh(layer)
            set_quality(ms, "-1")
            ms.set_current_mesh(0)
            assert ms.filter_parameter_values(DEFORM)["graph_layer"] == copy
            _, log = deform_logged(ms, capfd, use_graph_layer=True, graph_layer=layer, translation=np.array([0, 0, 0.25]), graph_layers=False)
            assert "is the graph that these parameters make here" in log
            assert same_points(ms.current_mesh().vertex_matrix(), first)
    ms.set_current_mesh(copy)
    ms.apply_filter("set_matrix", transformmatrix=translation([1e-3, 0, 0]), freeze=True)
    ms.generate_copy_of_current_mesh()  # of what is no graph any more but by its radii
    set_quality(ms, "-1")
    moved = ms.current_mesh().id()
    ms.set_current_mesh(0)
    _, log = deform_logged(ms, capfd, use_graph_layer=True, graph_layer=moved, translation=np.array([0, 0, 0.25]), graph_layers=False)
    assert "is the graph that these parameters make here" not in log


@pytest.mark.parametrize("turned", ["vi != 16 * rint(vi / 16)", "vi == 16 * rint(vi / 16)"])
def test_own_normals_are_told_by_all_vertices(turned):
    """Most of them are others than the faces', or few are: no stride tells that."""
    ms = new_set()
    points, faces = sheet(200)
    points[:, 2] = 0
    ms.add_mesh(pymeshlab.Mesh(points, faces), "sheet")
    set_quality(ms, "x < 10 ? 0 : (x > 190 ? 2 : 1)")
    ms.apply_filter("compute_selection_by_condition_per_vertex", condselect=turned)
    ms.apply_filter("compute_normal_by_function_per_vertex", x="0.6", y="0", z="0.8", onselected=True)
    ms.apply_filter("set_selection_none")
    unit = lambda v: v / np.linalg.norm(v, axis=1)[:, None]
    before = unit(ms.current_mesh().vertex_normal_matrix())
    assert 0.05 < (before[:, 0] > 0.5).mean() < 0.95
    ms.apply_filter(DEFORM, translation=np.array([0, 0, 5.0]), graph_layers=False)
    after, fixed = unit(ms.current_mesh().vertex_normal_matrix()), points[:, 0] < 9
    expected = before if (before[:, 0] > 0.5).mean() > 0.5 else np.array([[0, 0, 1.0]] * len(points))
    assert np.allclose(after[fixed], expected[fixed])


def two_sheets(gap):
    """Two sheets of 21 x 21 vertices side by side, a gap (over the diagonal) between them, held at their far ends."""
    x, y = np.meshgrid(np.arange(21.0), np.arange(21.0), indexing="ij")
    sheet = np.column_stack([x.ravel(), y.ravel(), 0.3 * np.sin(x.ravel())])
    a = np.array([i * 21 + j for i in range(20) for j in range(20)])
    faces = np.vstack([np.column_stack([a, a + 21, a + 1]), np.column_stack([a + 1, a + 21, a + 22])])
    points = np.vstack([sheet, sheet * [-1, 1, 1] - [gap * 44, 0, 0]])  # the second one mirrored
    tags = np.where(points[:, 0] > 18.5, 2.0, np.where(points[:, 0] < -18.5, 0.0, 1.0))
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(points, np.vstack([faces, faces[:, ::-1] + 441]), v_scalar_array=tags), "sheets")
    return ms


def test_seams_a_hair_apart_hold(capfd):
    seam = np.arange(21)
    for gap, more, joined in ((0, {}, True), (1e-9, {}, True), (5e-7, {}, True), (1e-4, {}, False), (1e-4, dict(weld_distance=2e-4), True),
                             (5e-4, dict(weld_distance=1e-3), True)):
        ms = two_sheets(gap)
        result, log = deform_logged(ms, capfd, translation=np.array([2.0, 0, 8]), rotation_axis=np.array([0.0, 1, 0]), rotation_angle=-60, **more)
        assert result["components"] == (1 if joined else 2)
        assert result["welded_vertices"] + result["joined_vertices"] == (21 if joined else 0)
        assert result["gap_vertices"] == (0 if joined else 42)
        points = ms.current_mesh().vertex_matrix()
        opened = np.linalg.norm(points[seam] - points[441 + seam], axis=1).max() / 44
        assert opened <= 3 * gap + 1e-12 if joined else opened > 0.01
        assert ("such a slit may open" in log) == (not joined), log


def test_lines_that_points_do_not_see_beyond_are_told(capfd):
    for denser in (10, 200):
        y, x = (a.ravel() for a in np.meshgrid(np.arange(8.0), np.arange(7 * denser + 1) / denser, indexing="ij"))
        ms = new_set()
        ms.add_mesh(pymeshlab.Mesh(np.column_stack([x, y, 0 * x]), v_scalar_array=np.where(x < 1, 0.0, np.where(x > 6, 2.0, 1.0))), "lines")
        _, log = deform_logged(ms, capfd, rotation_axis=np.array([0.0, 1, 0]), rotation_angle=-40)
        assert ("have neighbours only on their own scan line" in log) == (denser == 200), log


WARNINGS = {
    "rigid": "moves rigidly", "overruled": "at the place of a fixed vertex", "strained": "two held regions that move differently",
    "folded": " flipped:", "still": "No handle moves"}


@pytest.mark.parametrize("case", ["none", *WARNINGS])
def test_what_is_probably_not_meant_is_logged(capfd, case):
    tags = {"rigid": "(x > 0.75) ? 2 : 1", "strained": "(x < 0.5) ? 0 : ((x < 0.6) ? 2 : 1)"}.get(case, QUALITY_TAGS)
    move = {"still": [0, 0, 0], "folded": [-1.0, 0, 0]}.get(case, [0, 0, 0.2])
    ms = clean_bone()
    set_quality(ms, tags)
    mesh = ms.current_mesh()
    points, faces, values = mesh.vertex_matrix(), mesh.face_matrix(), mesh.vertex_scalar_array()
    if case == "overruled":  # a vertex of the handle lies on a fixed one beside what is free
        beside = faces[((values[faces] == 0).sum(1) == 1) & ((values[faces] == 1).sum(1) == 2)][0]
        points, values = np.vstack([points, points[beside][values[beside] == 0]]), np.append(values, 2)
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=values), "bone")
    result, log = deform_logged(ms, capfd, translation=np.array(move, float))
    met = {name for name, words in WARNINGS.items() if words in log}
    assert met - ({"folded", "rigid"} if case == "strained" else set()) == {case} - {"none"}, log
    assert (result["folded_triangles"] > 0) == ("folded" in met) and (result["strained_edges"] > 0) == (case == "strained")
    if case == "folded":
        assert f"{result['folded_triangles']} triangles are flipped" in log


def test_a_rotation_point_that_single_precision_moves_is_logged(capfd):
    """Scripts pass points in single precision."""
    far = np.array([600000.005, 5300000.003, 100])
    for point, transforms, coarse in ((far, "", True), (far, "2: rotate 0 0 1 30 about 600000.005 5300000.003 100", False),
                                      (np.array([0.5, 0.25, 0.125]), "", False)):
        ms = clean_bone()
        ms.apply_filter("set_matrix", transformmatrix=translation(point), freeze=False)
        _, log = deform_logged(ms, capfd, rotation_angle=30.0, rotation_center=2, rotation_point=point, transforms=transforms)
        assert ("rotation_point reaches the filter in single precision" in log) == coarse, log


# --- where the handles come from ----------------------------------------------------------------------------------------


def test_handles_from_selection():
    ms = clean_bone()
    rest = ms.current_mesh().vertex_matrix()
    set_quality(ms, "0")
    ms.apply_filter("compute_selection_by_condition_per_face", condselect="(x0 < 0.25) && (x1 < 0.25) && (x2 < 0.25)")
    ms.apply_filter("compute_selection_by_condition_per_vertex", condselect="x > 0.75")
    mesh = ms.current_mesh()
    handle = mesh.vertex_selection_array()
    fixed = np.zeros(len(rest), bool)
    fixed[mesh.face_matrix()[mesh.face_selection_array()]] = True
    result = ms.apply_filter(DEFORM, handles=1, translation=np.array([0, 0, 0.25]))
    points = ms.current_mesh().vertex_matrix()
    assert result["fixed_vertices"] == fixed.sum() > 0 and result["handle_vertices"] == handle.sum() > 0
    assert same_points(points[fixed], rest[fixed])
    assert np.abs(points[handle] - rest[handle] - [0, 0, 0.25]).max() < 1e-12
    assert (ms.current_mesh().vertex_selection_array() == handle).all()  # carried over


def test_selected_handle_wins_over_selected_faces():
    ms = clean_bone()
    ms.apply_filter("compute_selection_by_condition_per_face", condselect="(x0 < 0.3) || (x0 > 0.7)")
    ms.apply_filter("compute_selection_by_condition_per_vertex", condselect="x > 0.6")
    handle = ms.current_mesh().vertex_selection_array()
    assert ms.apply_filter(DEFORM, handles=1)["handle_vertices"] == handle.sum()


def test_handles_from_attribute():
    ms = clean_bone()
    tags = ms.current_mesh().vertex_scalar_array()
    set_quality(ms, "0")
    ms.current_mesh().add_vertex_custom_scalar_attribute(tags, "my tags")
    rest = ms.current_mesh().vertex_matrix()
    result = ms.apply_filter(DEFORM, handles=2, tag_attribute="my tags", translation=np.array([0, 0, 0.25]))
    points = ms.current_mesh().vertex_matrix()
    assert result["handle_vertices"] == (tags == 2).sum()
    assert np.abs(points[tags == 2] - rest[tags == 2] - [0, 0, 0.25]).max() < 1e-12
    assert same_points(points[tags == 0], rest[tags == 0])


def test_handles_from_files(tmp_path):
    ms = clean_bone()
    x = ms.current_mesh().vertex_matrix()[:, 0]
    rest = ms.current_mesh().vertex_matrix()
    tags = np.where((x > 0.4) & (x < 0.5), 0, np.where(x < 0.15, 2, np.where(x > 0.85, 3, 1)))
    second = translation([0, 0.1, 0.2]) @ about([0.9, 0.5, 0.5], rotation([0, 0, 1], 20))
    files = dict(tag_file=write_tags(tmp_path / "bone.sel", tags))
    both = write_transforms(tmp_path / "both.def", translation([0, 0, 0.25]), second)
    one = write_transforms(tmp_path / "one.def", translation([0, 0, 0.25]))

    ms.apply_filter(DEFORM, handles=3, transform_file=both, **files)
    points = ms.current_mesh().vertex_matrix()
    assert same_points(points[tags == 0], rest[tags == 0])
    assert np.abs(points[tags == 2] - rest[tags == 2] - [0, 0, 0.25]).max() < 1e-12
    assert np.abs(points[tags == 3] - transformed(second, rest[tags == 3])).max() < 1e-12

    # A handle without a matrix moves by the parameters; without any file, all do.
    for given, first in ((one, [0, 0, 0.25]), ("", [0, 0.5, 0])):
        ms.set_current_mesh(0)
        ms.apply_filter(DEFORM, handles=3, transform_file=given, translation=np.array([0, 0.5, 0]), **files)
        points = ms.current_mesh().vertex_matrix()
        assert np.abs(points[tags == 2] - rest[tags == 2] - first).max() < 1e-12
        assert np.abs(points[tags == 3] - rest[tags == 3] - [0, 0.5, 0]).max() < 1e-12


def test_transform_file_with_quality_tags(tmp_path):
    motion = translation([0, 0, 0.25])
    _, _, rest, points, tags = deform_bone(transform_file=write_transforms(tmp_path / "m.def", motion))
    assert np.abs(points[tags == 2] - rest[tags == 2] - [0, 0, 0.25]).max() < 1e-12


# --- motions as text ----------------------------------------------------------------------------------------------------


def three_handles(ms):
    """Tags the bone with handles 2, 3 and 4; returns rest points and tags."""
    set_quality(ms, "(x < 0.2) ? 2 : ((x > 0.8) ? 3 : (((x > 0.4) && (x < 0.5)) ? 0 : (((x > 0.6) && (x < 0.7)) ? 4 : 1)))")
    mesh = ms.current_mesh()
    return mesh.vertex_matrix(), mesh.vertex_scalar_array().astype(int)


def bone_by_every_source(folder):
    """The bone with the same tags in each source of tags: [(set, parameters)], and the tags."""
    chosen = clean_bone()
    chosen.apply_filter("compute_selection_by_condition_per_face", condselect="(x0 < 0.25) && (x1 < 0.25) && (x2 < 0.25)")
    chosen.apply_filter("compute_selection_by_condition_per_vertex", condselect="x > 0.75")
    mesh = chosen.current_mesh()
    tags = np.ones(mesh.vertex_number())
    tags[mesh.face_matrix()[mesh.face_selection_array()]] = 0
    tags[mesh.vertex_selection_array()] = 2
    by_quality = new_set()
    by_quality.add_mesh(pymeshlab.Mesh(mesh.vertex_matrix(), mesh.face_matrix(), v_scalar_array=tags), "bone")
    by_attribute = clean_bone()
    by_attribute.current_mesh().add_vertex_custom_scalar_attribute(tags, "which")
    return [(chosen, dict(handles=1)), (by_quality, dict(handles=0)),
            (by_attribute, dict(handles=2, tag_attribute="which")),
            (clean_bone(), dict(handles=3, tag_file=write_tags(folder / "bone.sel", tags.astype(int))))], tags


def test_every_way_to_say_the_same_gives_the_same(tmp_path):
    sources, tags = bone_by_every_source(tmp_path)
    shift, turn = translation([0.25, -0.5, 0.75]), about([0.5, 0.25, -0.125], rotation([0, 1, 0], -40))

    def ways(name, matrix, text, **parameters):
        return [parameters, dict(transformmatrix=matrix), dict(transforms=text),
                dict(transform_file=write_transforms(tmp_path / name, matrix))]

    def results(parameters):
        for ms, source in sources:
            rest = ms.mesh(0).vertex_matrix()
            for motion in parameters:
                ms.set_current_mesh(0)
                ms.apply_filter(DEFORM, graph_layers=False, **source, **motion)
                yield rest, ms.current_mesh().vertex_matrix()

    # These matrices are the same to the bit ...
    shifted = list(results(ways("shift.def", shift, "2: translate .25, -5e-1, 0.75", translation=np.array([0.25, -0.5, 0.75]))))
    assert len(shifted) == 16
    for rest, points in shifted:
        assert same_points(points, shifted[0][1])
        assert same_points(points[tags == 2], rest[tags == 2] + [0.25, -0.5, 0.75])
    # ... and these up to rounding.
    for rest, points in results(ways("turn.def", turn, "2: ROTATE 0 2 0 -40 about 0.5 0.25 -0.125;",
                                     rotation_axis=np.array([0, 1.0, 0]), rotation_angle=-40.0, rotation_center=2,
                                     rotation_point=np.array([0.5, 0.25, -0.125]))):
        assert np.abs(points[tags == 2] - transformed(turn, rest[tags == 2])).max() < 1e-12
        assert same_points(points[tags == 0], rest[tags == 0])


def test_transforms_go_before_the_file_and_the_parameters(tmp_path):
    ms = clean_bone()
    rest, tags = three_handles(ms)
    file = write_transforms(tmp_path / "two.def", translation([0, 0.25, 0]), translation([0, 0.5, 0]))
    ms.apply_filter(DEFORM, transforms="2: translate 0 0 0.125", transform_file=file, translation=np.array([0.0625, 0, 0]))
    points = ms.current_mesh().vertex_matrix()
    for tag, move in ((0, [0, 0, 0]), (2, [0, 0, 0.125]), (3, [0, 0.5, 0]), (4, [0.0625, 0, 0])):
        assert (tags == tag).sum() > 0
        assert np.abs(points[tags == tag] - rest[tags == tag] - move).max() < 1e-12


def test_transforms_move_each_handle_about_its_own_barycentre():
    ms = clean_bone()
    rest, tags = three_handles(ms)
    ms.apply_filter(DEFORM, transforms="3: translate 0 0 0.25 rotate 1 0 0 30;\n 2: scale 1.5 rotate 0 0 1 20 about 0 0 0;")
    points = ms.current_mesh().vertex_matrix()
    center = {tag: rest[tags == tag].mean(0) for tag in (2, 3)}
    motions = {2: about([0, 0, 0], rotation([0, 0, 1], 20)) @ about(center[2], 1.5 * np.eye(3)),
               3: translation([0, 0, 0.25]) @ about(center[3], rotation([1, 0, 0], 30)), 4: np.eye(4)}
    for tag, motion in motions.items():
        assert np.abs(points[tags == tag] - transformed(motion, rest[tags == tag])).max() < 1e-12


@pytest.mark.parametrize("degrees", [270.0, -270.0, 360.0])
def test_a_pose_of_a_large_rotation(degrees):
    for motion in (dict(rotation_axis=np.array([1.0, 0, 0]), rotation_angle=degrees), dict(transforms=f"2: rotate 1 0 0 {degrees}")):
        _, _, rest, points, tags = deform_bone(pose=50.0, graph_layers=False, **motion)
        half = about(rest[tags == 2].mean(0), rotation([1, 0, 0], degrees / 2))
        assert np.abs(points[tags == 2] - transformed(half, rest[tags == 2])).max() < 1e-9
        _, _, rest, points, tags = deform_bone(graph_layers=False, **motion)
        whole = about(rest[tags == 2].mean(0), rotation([1, 0, 0], degrees))
        assert np.abs(points[tags == 2] - transformed(whole, rest[tags == 2])).max() < 1e-12


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_pose_of_a_large_rotation_of_a_layer_with_a_matrix(mirrored):
    place = translation([3, -2, 1]) @ about([0, 0, 0], 2 * rotation([1, 2, 3], 50)) @ np.diag([-1.0 if mirrored else 1, 1, 1, 1])
    ms = clean_bone()
    tags, rest = ms.current_mesh().vertex_scalar_array(), ms.current_mesh().vertex_matrix()
    ms.apply_filter("set_matrix", transformmatrix=place, freeze=False)
    ms.apply_filter(DEFORM, transforms="2: rotate 1 2 0 270 about 1 2 3", pose=50.0, graph_layers=False)
    world = transformed(place, ms.current_mesh().vertex_matrix())
    half = about([1, 2, 3], rotation([1, 2, 0], 135))
    assert np.abs(world[tags == 2] - transformed(half @ place, rest[tags == 2])).max() < 1e-9


def test_transforms_name_the_handles_that_are_there():
    ms = clean_bone()
    with pytest.raises(pymeshlab.PyMeshLabException, match="transforms moves handle 5, but no vertex has tag 5; the only handle is 2"):
        ms.apply_filter(DEFORM, transforms="2: scale 2; 5: scale 2")
    three_handles(ms)
    with pytest.raises(pymeshlab.PyMeshLabException, match="has tag 5; the handles are 2, 3 and 4"):
        ms.apply_filter(DEFORM, transforms="5: scale 2")
    assert len(list(ms)) == 1


# --- a graph of one's own -----------------------------------------------------------------------------------------------


def test_use_graph_layer():
    ms = clean_bone()
    patches = ms.apply_filter(GRAPH, initial_patches=60)["patches"]
    rest, tags = ms.mesh(0).vertex_matrix(), ms.mesh(0).vertex_scalar_array()
    # The graph layer's own matrix is taken into account: shift it and shift it back.
    ms.set_current_mesh(1)
    nodes = ms.current_mesh().vertex_matrix()
    ms.set_current_mesh(0)
    motion = dict(translation=np.array([0, 0, 0.25]), use_graph_layer=True, graph_layer=1)
    result = ms.apply_filter(DEFORM, **motion)
    first = ms.current_mesh().vertex_matrix()
    nearest = np.linalg.norm(nodes[:, None] - rest, axis=2).argmin(1)
    free = (tags[nearest] == 1).sum()  # the others are not needed
    assert free * 0.8 < result["nodes"] < patches * 3
    assert np.abs(first[tags == 2] - rest[tags == 2] - [0, 0, 0.25]).max() < 1e-12
    ms.set_current_mesh(0)
    assert ms.apply_filter(DEFORM, **motion)["seconds_graph"] == 0, "it is prepared"
    assert same_points(ms.current_mesh().vertex_matrix(), first)
    ms.set_current_mesh(1)
    ms.apply_filter("set_matrix", transformmatrix=translation([5, 0, 0]), freeze=True)
    ms.apply_filter("set_matrix", transformmatrix=translation([-5, 0, 0]), freeze=False)
    assert np.abs(ms.current_mesh().vertex_matrix() - nodes - [5, 0, 0]).max() < 1e-12
    ms.set_current_mesh(0)
    ms.apply_filter(DEFORM, **motion)
    assert np.abs(ms.current_mesh().vertex_matrix() - first).max() < 1e-6


@pytest.mark.parametrize("case", ["far away", "graph of another mesh", "another mesh", "the default"])
def test_nodes_that_are_not_on_the_surface_are_an_error(case):
    ms = open_sample("bunny10k_textured.obj")
    ms.apply_filter(GRAPH, patches_layer=False)
    ms.load_new_mesh(str(SAMPLES / "bone.ply"))
    set_quality(ms, QUALITY_TAGS)
    ms.apply_filter(GRAPH, patches_layer=False)
    ms.set_current_mesh(3)
    ms.apply_filter("set_matrix", transformmatrix=translation([0, 100, 0]), freeze=False)
    ms.set_current_mesh(2)
    layer = {"far away": 3, "graph of another mesh": 1, "another mesh": 0}.get(case)
    with pytest.raises(pymeshlab.PyMeshLabException, match="Only [0-9]+ of the [0-9]+ given nodes lie on the surface"):
        ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.25]), use_graph_layer=True, **({} if layer is None else {"graph_layer": layer}))
    assert len(list(ms)) == 4 and ms.current_mesh_id() == 2


def test_a_graph_layer_may_have_a_matrix_that_flattens():
    points, faces = sheet(30)
    points[:, 2] = 0
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=np.where(points[:, 0] < 5, 0.0, np.where(points[:, 0] > 24, 2.0, 1.0))), "flat")
    ms.apply_filter(GRAPH, patches_layer=False)
    ms.set_current_mesh(1)
    ms.apply_filter("set_matrix", transformmatrix=np.diag([1.0, 1, 0, 1]), freeze=False)
    results = []
    for matrix in np.diag([1.0, 1, 0, 1]), np.eye(4):
        ms.set_current_mesh(1)
        ms.apply_filter("set_matrix", transformmatrix=matrix, freeze=False)
        ms.set_current_mesh(0)
        ms.apply_filter(DEFORM, translation=np.array([0, 0, 5.0]), use_graph_layer=True, graph_layer=1, graph_layers=False)
        results.append(ms.current_mesh().vertex_matrix())
    assert same_points(*results)


# --- what is probably not meant -----------------------------------------------------------------------------------------

def test_folds_are_those_of_the_surface():
    """A flat sheet that is pushed together lies flat, so that its folds can be seen from above."""
    n = 60
    points, faces = sheet(n, 1 / (n - 1))
    points[:, 2] = 0
    tags = np.where(points[:, 0] < 0.1, 0.0, np.where(points[:, 0] > 0.9, 2.0, 1.0))
    for to, folds in ((0.7, False), (0.3, False), (0.1, True)):
        ms = new_set()
        ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=tags), "sheet")
        result = ms.apply_filter(DEFORM, transforms=f"2: translate {0.8 * (to - 1)} 0 0", graph_layers=False)
        moved = ms.current_mesh().vertex_matrix()[faces]
        side = np.cross(moved[:, 1] - moved[:, 0], moved[:, 2] - moved[:, 0])[:, 2]
        before = np.cross(points[faces][:, 1] - points[faces][:, 0], points[faces][:, 2] - points[faces][:, 0])[:, 2]
        assert result["folded_triangles"] == (side * before < 0).sum() and (result["folded_triangles"] > 0) == folds


# --- the layer's matrix -------------------------------------------------------------------------------------------------


def test_layer_matrix():
    """Motions are in world coordinates: a layer with a matrix deforms as its frozen copy does."""
    place = translation([3, -2, 1]) @ about([0, 0, 0], 2 * rotation([1, 2, 3], 50))
    motion = dict(translation=np.array([0.5, 0, 0.25]), rotation_axis=np.array([0, 1.0, 0]), rotation_angle=30.0)
    world = {}
    for freeze in (True, False):
        ms = clean_bone()
        tags = ms.current_mesh().vertex_scalar_array()
        ms.apply_filter("set_matrix", transformmatrix=place, freeze=freeze)
        rest = ms.current_mesh().vertex_matrix()
        ms.apply_filter(DEFORM, **motion)
        m = np.array(matrix(ms.current_mesh()))
        for layer in ms:
            assert np.allclose(np.array(matrix(layer)), np.eye(4) if freeze else place, atol=1e-15)
        assert same_points(ms.current_mesh().vertex_matrix()[tags == 0], rest[tags == 0])
        world[freeze] = transformed(m, ms.current_mesh().vertex_matrix())
        at_rest = transformed(m, rest)
        expected = translation([0.5, 0, 0.25]) @ about(at_rest[tags == 2].mean(0), rotation([0, 1, 0], 30))
        assert np.abs(world[freeze][tags == 2] - transformed(expected, at_rest[tags == 2])).max() < 1e-9
    diagonal = np.linalg.norm(np.ptp(world[True], axis=0))
    assert np.sqrt(((world[True] - world[False]) ** 2).sum(1).mean()) < 0.02 * diagonal


# --- what a layer carries -----------------------------------------------------------------------------------------------


def test_textures_and_texture_coordinates_survive():
    ms = open_sample("bunny10k_textured.obj")
    x = ms.current_mesh().vertex_matrix()[:, 0]
    lo, hi = np.percentile(x, [20, 80])
    set_quality(ms, f"(x < {lo}) ? 0 : ((x > {hi}) ? 2 : 1)")
    ms.apply_filter(DEFORM, translation=np.array([0, 0, 2.0]))
    rest, deformed = ms.mesh(0), ms.current_mesh()
    assert rest.texture_number() == 1 and rest.has_wedge_tex_coord()
    assert deformed.texture_number() == 1
    assert list(deformed.textures()) == list(rest.textures())
    (name, image), = deformed.textures().items()
    assert image.width() == rest.texture(name).width() > 0
    assert (deformed.wedge_tex_coord_matrix() == rest.wedge_tex_coord_matrix()).all()
    assert (deformed.face_matrix() == rest.face_matrix()).all()


def test_colors_face_data_and_custom_attributes_survive():
    ms = clean_bone()
    mesh = ms.current_mesh()
    rng = np.random.default_rng(0)
    ms.apply_filter("compute_color_by_function_per_vertex", x="x*255", y="y*255", z="z*255")
    ms.apply_filter("compute_color_by_function_per_face", r="x0*255", g="y1*255", b="7")
    ms.apply_filter("compute_scalar_by_function_per_face", q="x0+2*fi")
    per_vertex, per_face = rng.random(mesh.vertex_number()), rng.random((mesh.face_number(), 3))
    mesh.add_vertex_custom_scalar_attribute(per_vertex, "heat")
    mesh.add_face_custom_scalar_attribute(per_face[:, 0], "cold")
    carried = [lambda m: m.vertex_color_matrix(), lambda m: m.face_color_matrix(), lambda m: m.face_scalar_array(),
               lambda m: m.vertex_scalar_array(), lambda m: m.vertex_custom_scalar_attribute_array("heat"),
               lambda m: m.face_custom_scalar_attribute_array("cold")]
    if not IS_2022:  # whose own functions for point attributes write past the end of the array
        mesh.add_vertex_custom_point_attribute(rng.random((mesh.vertex_number(), 3)), "wind")
        mesh.add_face_custom_point_attribute(per_face, "flow")
        carried += [lambda m: m.vertex_custom_point_attribute_matrix("wind"),
                    lambda m: m.face_custom_point_attribute_matrix("flow")]
    ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.25]))
    rest, deformed = ms.mesh(0), ms.current_mesh()
    for get in carried:
        assert (get(deformed) == get(rest)).all()
    assert (deformed.vertex_custom_scalar_attribute_array("heat") == per_vertex).all()
    assert len(np.unique(deformed.vertex_color_matrix(), axis=0)) > 100


def test_deleted_elements_and_selection_are_dealt_with():
    ms = clean_bone()
    ms.apply_filter("compute_selection_by_condition_per_vertex", condselect="(x > 0.5) && (x < 0.55) && (z < 0.5)")
    ms.apply_filter("meshing_remove_selected_vertices")
    mesh = ms.current_mesh()
    tags, rest = mesh.vertex_scalar_array(), mesh.vertex_matrix()
    ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.25]))
    deformed = ms.current_mesh()
    assert deformed.vertex_number() == len(rest) and deformed.face_number() == ms.mesh(0).face_number()
    assert same_points(deformed.vertex_matrix()[tags == 0], rest[tags == 0])


def test_point_cloud():
    ms = clean_bone()
    points, tags = ms.current_mesh().vertex_matrix(), ms.current_mesh().vertex_scalar_array()
    cloud = new_set()
    cloud.add_mesh(pymeshlab.Mesh(points, v_scalar_array=tags), "cloud")
    cloud.apply_filter(DEFORM, translation=np.array([0, 0, 0.25]))
    moved = cloud.current_mesh().vertex_matrix()
    assert cloud.current_mesh().face_number() == 0 and np.isfinite(moved).all()
    assert same_points(moved[tags == 0], points[tags == 0])
    assert np.abs(moved[tags == 2] - points[tags == 2] - [0, 0, 0.25]).max() < 1e-12


def write_stl(path, triangles):
    with open(path, "wb") as out:
        out.write(b" " * 80 + struct.pack("<I", len(triangles)))
        for t in triangles:
            out.write(struct.pack("<12fH", 0, 0, 0, *t.ravel(), 0))


def test_unwelded_mesh_moves_as_one(tmp_path):
    ms = clean_bone()
    mesh = ms.current_mesh()
    triangles = mesh.vertex_matrix()[mesh.face_matrix()].astype(np.float32)
    soup = new_set()
    soup.add_mesh(pymeshlab.Mesh(triangles.reshape(-1, 3).astype(float), np.arange(triangles.size // 3).reshape(-1, 3)), "soup")
    set_quality(soup, QUALITY_TAGS)
    soup.apply_filter(DEFORM, rotation_axis=np.array([0, 1.0, 0]), rotation_angle=40.0)
    rest, moved = soup.mesh(0).vertex_matrix(), soup.current_mesh().vertex_matrix()
    _, group = np.unique(rest, axis=0, return_inverse=True)
    group = group.ravel()
    first = np.zeros(group.max() + 1, int)
    first[group[::-1]] = np.arange(len(group))[::-1]
    assert len(first) < len(rest) / 3
    assert same_points(moved, moved[first[group]])


# --- what the surface does ----------------------------------------------------------------------------------------------


def two_fingers(rings=100, around=60, radius=0.5, length=4.0):
    """Two open tubes side by side, joined at the bottom; the gap is 1 % of the diagonal."""
    gap = 0.01 * np.linalg.norm([4 * radius, 2 * radius, length])
    angle, n = 2 * np.pi * np.arange(around) / around, rings * around
    points = np.concatenate([np.stack([side * (radius * (1 - np.cos(angle)) + gap / 2), radius * np.sin(angle), np.full(around, z)], 1)
                             for side in (-1, 1) for z in np.linspace(0, length, rings)])
    here = np.arange(around)
    beside = np.roll(here, -1)
    faces = [[here + r * around, beside + r * around, here + (r + 1) * around] for r in range(2 * rings) if r % rings < rings - 1]
    faces += [[beside + r * around, beside + (r + 1) * around, here + (r + 1) * around] for r in range(2 * rings) if r % rings < rings - 1]
    faces += [[here, beside, n + here], [n + here, n + beside, beside]]
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=points, face_matrix=np.concatenate([np.transpose(f) for f in faces]).astype(np.int32)))
    return ms


def test_a_finger_leaves_the_one_beside_it_alone():
    ms = two_fingers()
    set_quality(ms, "(z < 0.4) ? 0 : (((z > 3) && (x < 0)) ? 2 : 1)")
    rest = ms.current_mesh().vertex_matrix()
    diagonal, other = np.linalg.norm(np.ptp(rest, axis=0)), rest[:, 0] > 0
    moved = []
    for weights in (0, 1):
        ms.set_current_mesh(0)
        ms.apply_filter(DEFORM, transforms="2: rotate 1 0 0 60 about 0 0 2", weights=weights, graph_layers=False)
        step = np.linalg.norm(ms.current_mesh().vertex_matrix() - rest, axis=1) / diagonal
        assert step[~other].max() > 0.3
        moved.append(step[other].max())
    assert moved[0] < 1e-4
    assert moved[1] > 0.05  # the paper's weights drag it along


def test_stretch_and_rotation_as_quality():
    move = dict(rotation_axis=np.array([0.0, 1, 0]), rotation_angle=-45.0, translation=np.array([0, 0, 0.25]))
    for quality, held, turned in ((1, 1, 1), (2, 0, 45)):
        ms, _, rest, points, tags = deform_bone(deformed_quality=quality, **move)
        values = ms.current_mesh().vertex_scalar_array()
        # Away from the free region, where all edges of a vertex are held.
        assert np.abs(values[(tags == 0) & (rest[:, 0] < 0.15)] - held).max() < 1e-3
        assert np.abs(values[(tags == 2) & (rest[:, 0] > 0.85)] - turned).max() < 1e-3 * max(turned, 1)
        free = values[tags == 1]
        assert np.isfinite(free).all() and free.min() >= 0 and np.ptp(free) > 0.01
        assert same_points(points, deform_bone(**move)[3])
        assert set(ms.mesh(0).vertex_scalar_array()) == {0, 1, 2}  # the input keeps its own
    assert set(deform_bone(**move)[0].current_mesh().vertex_scalar_array()) == {0, 1, 2}


def closing_tube():
    """A tube with a free middle, that a turn of its end closes onto itself: (layers, motion of so many degrees)."""
    s, a = np.meshgrid(np.linspace(0, 80, 120), np.linspace(0, 2 * np.pi, 40, endpoint=False) + 0.01, indexing="ij")
    points = np.stack([s.ravel(), 8 * np.cos(a).ravel(), 8 * np.sin(a).ravel()], 1)
    i, k = np.arange(119)[:, None] * 40, np.arange(40)
    a, b = (i + k).ravel(), (i + (k + 1) % 40).ravel()
    tags = np.where(s.ravel() < 32, 0.0, np.where(s.ravel() > 48, 2, 1))
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(points, np.r_[np.c_[a, b, a + 40], np.c_[b, b + 40, a + 40]], v_scalar_array=tags), "tube")
    return ms, lambda degrees: f"2: rotate 0 1 0 -{degrees} about 40 0 0"


def test_contact_is_logged_counted_and_shown_as_quality():
    for degrees, deep in ((160, True), (60, False)):
        ms, turn = closing_tube()
        found = ms.apply_filter(DEFORM, transforms=turn(degrees), graph_layers=False, deformed_quality=3)
        depth = ms.current_mesh().vertex_scalar_array()
        assert (found["contact_triangles"] > 100) == deep == (found["contact_depth"] > 5)
        assert abs(depth.max() - found["contact_depth"]) < 1e-5 and depth.min() == 0 and (depth > 0).any() == deep


def test_a_motion_stops_at_contact():
    ms, turn = closing_tube()
    found = ms.apply_filter(DEFORM, transforms=turn(160), graph_layers=False, stop_at_contact=True)
    stopped, points = found["pose_percent"], ms.current_mesh().vertex_matrix()
    assert found["contact_triangles"] == 0 and 40 < stopped < 99 and stopped == round(stopped)
    for percent, free in ((stopped, True), (stopped + 1, False)):
        ms.set_current_mesh(0)
        found = ms.apply_filter(DEFORM, transforms=turn(160), graph_layers=False, pose=percent)
        assert (found["contact_triangles"] == 0) == free and same_points(ms.current_mesh().vertex_matrix(), points) == free
    ms.set_current_mesh(0)
    assert ms.apply_filter(DEFORM, transforms=turn(60), graph_layers=False, stop_at_contact=True)["pose_percent"] == 100


def test_a_pose_in_place_tells_of_contact():
    ms, turn = closing_tube()
    deep = ms.apply_filter(DEFORM, transforms=turn(160), graph_layers=False)
    ms.set_current_mesh(0)
    for degrees in (60, 160):
        assert ms.apply_filter(POSE, transforms=turn(degrees))["contact_triangles"] == 0  # nobody has asked
        found = ms.apply_filter(POSE, transforms=turn(degrees), contact=True)
        assert (found["contact_triangles"], found["contact_depth"]) == ((0, 0) if degrees == 60 else (deep["contact_triangles"], deep["contact_depth"]))


def test_graph_layers_carry_the_energy():
    ms, result, *_ = deform_bone(translation=np.array([0, 0, 0.25]))
    energies = [mesh.vertex_custom_scalar_attribute_array("energy") for mesh in ms if "graph" in mesh.label()]
    assert len(energies) == 2 and same_points(*energies)
    assert energies[0].min() >= 0 and abs(energies[0].sum() / result["energy"] - 1) < 1e-6


@pytest.mark.skipif(IS_2022, reason="pymeshlab 2022.2 has no MeshSet without messages and other names")
def test_promises_hold(capsys):
    import promises
    broken = promises.main()
    said = capsys.readouterr().out
    assert not broken and said.count("   holds") >= 30, said


def test_graph_weights_of_the_paper():
    move = dict(translation=np.array([0, 0, 0.25]))
    _, result, rest, uniform, tags = deform_bone(graph_weights=1, **move)
    _, _, _, paper, _ = deform_bone(graph_weights=2, **move)
    assert 0 < np.abs(paper - uniform).max() < 0.1  # patches balanced by vertices lie elsewhere
    assert result["converged"]
    border = deform_bone(**move)[3]
    assert not same_points(uniform, border)
    assert np.linalg.norm(uniform - border, axis=1).max() < 0.05 * np.linalg.norm(np.ptp(rest, axis=0))
    assert same_points(uniform[tags == 0], rest[tags == 0])
    _, result, _, printed, _ = deform_bone(graph_weights=3, **move)
    assert result["converged"] and result["iterations"] > 1
    assert same_points(printed[tags == 0], rest[tags == 0])
    assert same_points(printed, deform_bone(graph_weights=3, weights=1, influence=2, **move)[3])  # neither is read
    off = np.linalg.norm(printed - border, axis=1).max() / np.linalg.norm(np.ptp(rest, axis=0))
    assert 1e-3 < off < 0.2  # creases at what is held


# --- point handles ------------------------------------------------------------------------------------------------------


def point_targets(ms):
    """Vertices far apart on the bone and where they go, world coordinates."""
    mesh = ms.current_mesh()
    points = transformed(matrix(mesh), mesh.vertex_matrix())
    wanted = transformed(matrix(mesh), np.array([[0.1, 0.5, 0.5], [0.5, 0.5, 0.5], [0.9, 0.5, 0.5], [0.9, 0.4, 0.6]]))
    chosen = [int(np.linalg.norm(points - p, axis=1).argmin()) for p in wanted]
    size = np.linalg.norm(np.ptp(points, axis=0))
    return chosen, points[chosen], points[chosen] + size * np.array([[0, 0, 0], [0, 0, 0.05], [0, 0, 0.2], [0.01, 0, 0.2]])


def point_file(path, kind, chosen, start, target):
    if kind == "index":
        path.write_text("vertex;x;y;z\n" + "".join(f"{v}; {x!r}; {y!r}; {z!r}\n" for v, (x, y, z) in zip(chosen, target.tolist())))
    elif kind == "coordinates":
        path.write_text("# start, target\r\n" +
                        "".join(",".join(map(repr, a + b)) + "\r\n" for a, b in zip(start.tolist(), target.tolist())))
    else:
        lines = [f'<point x="{x!r}" y="{y!r}" z="{z!r}" active="1" name="{i}"/>'
                 for i, (x, y, z) in enumerate(np.stack([start, target], 1).reshape(-1, 3).tolist())]
        lines.insert(1, '<point x="7" y="7" z="7" active="0" name="not picked"/>')
        path.write_text("<!DOCTYPE PickedPoints>\n<PickedPoints>\n <DocumentData/>\n" + "\n".join(lines) + "\n</PickedPoints>\n")
    return str(path)


def test_point_handles_arrive_and_every_kind_of_file_gives_the_same_bits(tmp_path):
    ms = untagged_bone()
    chosen, start, target = point_targets(ms)
    rest, results = ms.current_mesh().vertex_matrix(), []
    for kind, name in (("index", "points.csv"), ("coordinates", "points.txt"), ("picked", "points.PP")):
        ms.set_current_mesh(0)
        result = ms.apply_filter(DEFORM, point_handles_file=point_file(tmp_path / name, kind, chosen, start, target), graph_layers=False)
        assert result["converged"] and result["handle_vertices"] == 4
        results.append(ms.current_mesh().vertex_matrix())
    points = results[0]
    assert np.abs(points[chosen] - target).max() < 1e-12
    assert same_points(points, results[1]) and same_points(points, results[2])
    # What is between them follows, without folds: edges keep their length by and large.
    edge = np.concatenate([ms.current_mesh().face_matrix()[:, [0, 1]], ms.current_mesh().face_matrix()[:, [1, 2]]])
    length = [np.linalg.norm(p[edge[:, 0]] - p[edge[:, 1]], axis=1) for p in (rest, points)]
    assert 0.3 < (length[1] / length[0]).min() and (length[1] / length[0]).max() < 2


@pytest.mark.parametrize("kind", ["index", "coordinates", "picked"])
def test_point_handles_are_in_world_coordinates(tmp_path, kind):
    ms = untagged_bone()
    place = translation([3, -2, 1]) @ about([0, 0, 0], 2 * rotation([1, 2, 3], 50))
    ms.apply_filter("set_matrix", transformmatrix=place, freeze=False)
    chosen, start, target = point_targets(ms)
    path = tmp_path / ("p.pp" if kind == "picked" else "p.csv")
    ms.apply_filter(DEFORM, point_handles_file=point_file(path, kind, chosen, start, target))
    mesh = ms.current_mesh()
    assert np.abs(transformed(matrix(mesh), mesh.vertex_matrix())[chosen] - target).max() < 1e-11


def test_a_start_beside_the_surface_stands_for_the_nearest_vertex(tmp_path):
    ms = untagged_bone()
    chosen, start, target = point_targets(ms)
    beside = np.array([1e-5, -1e-5, 1e-5])
    ms.apply_filter(DEFORM, point_handles_file=point_file(tmp_path / "p.csv", "coordinates", chosen, start + beside, target + beside))
    assert np.abs(ms.current_mesh().vertex_matrix()[chosen] - target).max() < 1e-12


def test_point_handles_with_tags_and_pose(tmp_path):
    ms = clean_bone()
    chosen, start, target = point_targets(ms)
    rest, tags = ms.current_mesh().vertex_matrix(), ms.current_mesh().vertex_scalar_array()
    path = point_file(tmp_path / "p.csv", "index", chosen[1:2], start[1:2], target[1:2])
    ms.apply_filter(DEFORM, point_handles_file=path, translation=np.array([0, 0, 0.25]), pose=50.0)
    points = ms.current_mesh().vertex_matrix()
    assert same_points(points[tags == 0], rest[tags == 0])
    assert np.abs(points[tags == 2] - rest[tags == 2] - [0, 0, 0.125]).max() < 1e-12
    assert np.abs(points[chosen[1]] - (start[1] + target[1]) / 2).max() < 1e-12


def test_a_point_handle_is_a_single_vertex_that_is_translated(tmp_path):
    ms = clean_bone()
    chosen, start, target = point_targets(ms)
    path = point_file(tmp_path / "p.csv", "index", chosen[2:3], start[2:3], target[2:3])
    set_quality(ms, "(x < 0.25) ? 0 : 1")
    ms.apply_filter(DEFORM, point_handles_file=path)
    by_file = ms.current_mesh().vertex_matrix()
    ms.set_current_mesh(0)
    set_quality(ms, f"(x < 0.25) ? 0 : ((vi == {chosen[2]}) ? 2 : 1)")
    ms.apply_filter(DEFORM, translation=target[2] - start[2])
    assert np.abs(ms.current_mesh().vertex_matrix() - by_file).max() < 1e-7


@pytest.mark.parametrize("handles, selected", [(1, ""), (1, "faces"), (3, "")])
def test_point_handles_need_no_tags(tmp_path, handles, selected):
    ms = untagged_bone()
    chosen, start, target = point_targets(ms)
    select(ms, faces="x0 < 0.2" if selected else "")
    mesh = ms.current_mesh()
    fixed = np.unique(mesh.face_matrix()[mesh.face_selection_array()])
    rest = mesh.vertex_matrix()
    path = point_file(tmp_path / "p.csv", "index", chosen[1:], start[1:], target[1:])
    result = ms.apply_filter(DEFORM, handles=handles, point_handles_file=path)
    assert result["fixed_vertices"] == len(fixed) and (len(fixed) > 0) == bool(selected)
    points = ms.current_mesh().vertex_matrix()
    assert same_points(points[fixed], rest[fixed]) and np.abs(points[chosen[1:]] - target[1:]).max() < 1e-12


POINT_ERRORS = {
    "file is missing": ("/no/such.csv", None, "Cannot open '/no/such.csv'"),
    "picked points are missing": ("/no/such.pp", None, "Cannot open '/no/such.pp'"),
    "file is empty": ("p.csv", "", "holds no points"),
    "a word": ("p.csv", "1, 0, 0, zero\n", "line 1: expected a number, found 'zero'"),
    "five numbers": ("p.csv", "# list\n1 2 3 4 5\n", "line 2: found 5 numbers"),
    "not finite": ("p.csv", "1, 0, 0, nan\n", "line 1: expected a finite number"),
    "no such vertex": ("p.csv", "100000000, 0, 0, 0\n", "names vertex 100000000, but the layer has vertices 0 to"),
    "vertex is a fraction": ("p.csv", "0.5, 0, 0, 0\n", "expected the number of a vertex"),
    "vertex is negative": ("p.csv", "-1, 0, 0, 0\n", "expected the number of a vertex"),
    "held already": ("p.csv", "0.1 0.5 0.5 0 0 0\n", "is held already"),
    "twice": ("p.csv", "0.5 0.5 0.5 0 0 0\n0.5 0.5 0.5 0 0 1\n", "same place as point handle 1"),
    "no pairs": ("p.pp", '<PickedPoints><point x="0" y="0" z="0" active="1"/></PickedPoints>', "holds 1 active points"),
    "no points": ("p.pp", "<PickedPoints></PickedPoints>", "holds 0 active points"),
    "no XML": ("p.pp", "vertex\n", "line 1: expected the XML of picked points: "),
    "cut short": ("p.pp", '<PickedPoints>\n<point x="0" y="0" z="0" active="1"/>\n', "line 3: "),
    "unknown entity": ("p.pp", "<PickedPoints>&\u00e9;</PickedPoints>", "line 1: expected the XML of picked points: Entity '"),
    "no coordinate": ("p.pp", '<PickedPoints>\n<point x="0" z="0" active="1"/></PickedPoints>', "line 2: expected a number as y"),
    "coordinate is infinite": ("p.pp", '<PickedPoints>\n<point x="inf" y="0" z="0"/></PickedPoints>', "expected a number as x"),
}


@pytest.mark.parametrize("case", POINT_ERRORS)
def test_an_error_in_a_file_of_points_changes_nothing(tmp_path, case):
    name, content, word = POINT_ERRORS[case]
    path = name if content is None else tmp_path / name
    if content is not None:
        path.write_text(content)
    ms = clean_bone()
    before = snapshot(ms.current_mesh())
    with pytest.raises(pymeshlab.PyMeshLabException) as error:
        ms.apply_filter(DEFORM, point_handles_file=str(path))
    assert word in str(error.value) and "Details:" in str(error.value), str(error.value)
    assert len(list(ms)) == 1
    assert_unchanged(before, ms.current_mesh())


def test_no_vertex_is_near_a_point_where_none_is_finite(tmp_path):
    path = tmp_path / "p.csv"
    path.write_text("0 0 0 1 1 1\n")
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(np.full((5, 3), np.inf)), "bad")
    with pytest.raises(pymeshlab.PyMeshLabException, match="not finite numbers, so no vertex is nearest"):
        ms.apply_filter(DEFORM, point_handles_file=str(path))
    assert len(list(ms)) == 1


def test_a_text_moves_no_points(tmp_path):
    path = tmp_path / "p.csv"
    path.write_text("0, 1, 1, 1\n")
    ms = open_sample("bone.ply")
    with pytest.raises(pymeshlab.PyMeshLabException, match="no vertex has tag 2; the handles are points"):
        ms.apply_filter(DEFORM, point_handles_file=str(path), transforms="2: scale 2")


# --- errors -------------------------------------------------------------------------------------------------------------

ERRORS = {
    "nobody tagged the vertices": (dict(), "0", "quality"),
    "tags are not whole": (dict(), "x*10", "whole number"),
    "no handle": (dict(), "(x < 0.5) ? 0 : 1", "handle"),
    "nothing is free": (dict(), "(x < 0.5) ? 0 : 2", "free"),
    "nothing is selected": (dict(handles=1), QUALITY_TAGS, "select"),
    "no such attribute": (dict(handles=2, tag_attribute="nope"), QUALITY_TAGS, "nope"),
    "attribute without a name": (dict(handles=2, tag_attribute=""), QUALITY_TAGS, "tag_attribute"),
    "no tag file": (dict(handles=3), QUALITY_TAGS, "tag_file"),
    "tag file is missing": (dict(handles=3, tag_file="/no/such.sel"), QUALITY_TAGS, "/no/such.sel"),
    "transform file is missing": (dict(transform_file="/no/such.def"), QUALITY_TAGS, "/no/such.def"),
    "motion as text has an unknown step": (dict(transforms="2: turn 0 0 1 90"), QUALITY_TAGS, "transforms, character 4: expected"),
    "motion as text ends early": (dict(transforms="2: translate 0 0"), QUALITY_TAGS, "found the end"),
    "motion as text is for nobody": (dict(transforms="3: scale 2"), QUALITY_TAGS, "no vertex has tag 3"),
    "motion as text is for a handle that is not there": (dict(transforms="2: scale 2"), "(x < 0.5) ? 0 : 1", "there is no handle"),
    "motion as text mirrors": (dict(transforms="2: matrix 1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1"), QUALITY_TAGS, "transforms, handle 2: a transform mirrors"),
    "motion as text is not finite": (dict(transforms="2: translate 1e400 0 0"), QUALITY_TAGS, "'1e400'"),
    "axis is zero": (dict(rotation_angle=10.0, rotation_axis=np.zeros(3)), QUALITY_TAGS, "rotation_axis"),
    "matrix is a projection": (dict(transformmatrix=np.ones((4, 4))), QUALITY_TAGS, "affine"),
    "matrix flattens": (dict(transformmatrix=np.diag([1.0, 1, 0, 1])), QUALITY_TAGS, "flatten"),
    "scale beyond all bounds": (dict(transforms="2: scale 1e300"), QUALITY_TAGS, "handle 2 moves too far"),
    "smoothness beyond all bounds": (dict(smoothness=1e308), QUALITY_TAGS, "smoothness must be a finite number"),
    "weld distance of a tenth": (dict(weld_distance=0.1), QUALITY_TAGS, "weld distance must be from 0 to 0.001"),
    "no steps": (dict(pose_steps=0), QUALITY_TAGS, "in 1 to 1000 steps"),
    "tolerance beyond all bounds": (dict(tolerance=1e308), QUALITY_TAGS, "tolerance must be a positive, finite number"),
    "influence beyond all bounds": (dict(influence=1e308), QUALITY_TAGS, "influence must be a finite number above 1"),
    "not a number": (dict(translation=np.array([np.nan, 0, 0])), QUALITY_TAGS, "finite"),
    "no patches": (dict(initial_patches=-1), QUALITY_TAGS, "patches"),
    "negative radius": (dict(target_radius=absolute(-1.0)), QUALITY_TAGS, "radius"),
    "a rigidity of 2": (dict(rigidity=2.0), QUALITY_TAGS, "rigidity must be from 0 to 1"),
    "a rigidity of nearly 1": (dict(rigidity=0.9999), QUALITY_TAGS, "between 0.999 and 1 hardly comes to rest"),
    "elastic and not rigid": (dict(rigidity=0.0, elastic=True), QUALITY_TAGS, "take one of them"),
    "the paper to the letter and not rigid": (dict(rigidity=0.0, graph_weights=3), QUALITY_TAGS, "take other graph weights"),
    "negative smoothness": (dict(smoothness=-1.0), QUALITY_TAGS, "smoothness"),
    "influence too small": (dict(influence=0.5), QUALITY_TAGS, "influence"),
    "no iterations": (dict(max_iterations=0), QUALITY_TAGS, "iterations"),
    "zero tolerance": (dict(tolerance=0.0), QUALITY_TAGS, "tolerance"),
    "pose is not a number": (dict(pose=float("nan")), QUALITY_TAGS, "pose"),
    "the graph is the mesh itself": (dict(use_graph_layer=True, graph_layer=0), QUALITY_TAGS, "graph_layer"),
    "the graph is no layer": (dict(use_graph_layer=True, graph_layer=7), QUALITY_TAGS, "no layer of this document"),
}


@pytest.mark.parametrize("case", ERRORS)
def test_an_error_is_one_message_and_no_new_layer(case):
    parameters, quality, word = ERRORS[case]
    ms = clean_bone()
    set_quality(ms, quality)
    ms.apply_filter("set_selection_none")
    before = snapshot(ms.current_mesh())
    with pytest.raises(pymeshlab.PyMeshLabException) as error:
        ms.apply_filter(DEFORM, **parameters)
    message = str(error.value)
    assert word.lower() in message.lower(), message
    assert "Details:" in message and len(message) < 700
    assert len(list(ms)) == 1 and ms.current_mesh_id() == 0
    assert_unchanged(before, ms.current_mesh())


@pytest.mark.parametrize("tags, transforms, word", [
    ([0, 1, 2], "", "3 tags"),
    ("count-with-junk", "", "line"),
    ("good", "1 0 0 0\n0 1 0 0\n", "16"),
    ("good", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1", "affine"),
    ("good", "1 0 0 x 0 1 0 0 0 0 1 0 0 0 0 1", "line"),
])
def test_bad_files(tmp_path, tags, transforms, word):
    ms = clean_bone()
    good = ms.current_mesh().vertex_scalar_array().astype(int)
    path = tmp_path / "t.sel"
    write_tags(path, good if tags == "good" else tags if isinstance(tags, list) else ["junk"] * len(good))
    (tmp_path / "t.def").write_text(transforms)
    with pytest.raises(pymeshlab.PyMeshLabException) as error:
        ms.apply_filter(DEFORM, handles=3, tag_file=str(path), transform_file=str(tmp_path / "t.def") if transforms else "")
    assert word in str(error.value) and "/t." in str(error.value)
    assert len(list(ms)) == 1


def test_an_empty_graph_layer_is_an_error():
    ms = clean_bone()
    ms.add_mesh(pymeshlab.Mesh(np.eye(3)), "nothing")
    ms.apply_filter("set_selection_all")
    ms.apply_filter("meshing_remove_selected_vertices")
    ms.set_current_mesh(0)
    with pytest.raises(pymeshlab.PyMeshLabException, match="no vertices"):
        ms.apply_filter(DEFORM, use_graph_layer=True, graph_layer=1)
    assert len(list(ms)) == 2


def test_coordinates_that_are_not_finite_are_an_error():
    ms = clean_bone()
    points = np.random.default_rng(1).random((50, 3))
    points[17, 1] = np.inf
    ms.add_mesh(pymeshlab.Mesh(points), "bad")
    with pytest.raises(pymeshlab.PyMeshLabException, match="Vertex 17 has a coordinate that is not a finite number"):
        ms.apply_filter(GRAPH)
    ms.set_current_mesh(0)
    with pytest.raises(pymeshlab.PyMeshLabException, match="A node of the deformation graph has a coordinate"):
        ms.apply_filter(DEFORM, use_graph_layer=True, graph_layer=1)
    assert len(list(ms)) == 2


def test_a_layer_without_vertices_is_an_error():
    ms = clean_bone()
    ms.apply_filter("set_selection_all")
    ms.apply_filter("meshing_remove_selected_vertices")
    for name in GRAPH, DEFORM:
        with pytest.raises(pymeshlab.PyMeshLabException, match="The layer '.*' has no vertices"):
            ms.apply_filter(name)
    assert len(list(ms)) == 1


# --- the worst that can be made up ---------------------------------------------------------------------------------------


def loose_triangles(n):
    corner = 2.0 * np.column_stack(np.unravel_index(np.arange(n), (50, 50, -(-n // 2500))))
    turn = 0.1 * np.arange(n)
    second = corner + np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
    points = np.stack([corner, second, corner + [0, 0.5, 1]], axis=1).reshape(-1, 3)
    return points, np.arange(3 * n).reshape(-1, 3)


def fan(n):
    angle = 2 * np.pi * np.arange(n) / n
    points = np.vstack([[[0, 0, 0], [0, 0, 1]], np.column_stack([np.cos(angle), np.sin(angle), 0.5 + 0 * angle])])
    return points, np.column_stack([np.zeros(n, int), np.ones(n, int), np.arange(2, n + 2)])


def sheet(n, spacing=1.0, at=(0, 0, 0)):
    x, y = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.vstack([np.column_stack([a, a + n, a + 1]), np.column_stack([a + 1, a + n, a + n + 1])])
    return np.asarray(at) + spacing * np.column_stack([x, y, np.sin(0.1 * x * y)]), faces


def no_area(n):
    i = np.arange(n * n - 2)
    return sheet(n)[0], np.vstack([np.column_stack([i, i, i]), np.column_stack([i, i + 1, i + i % 2]), np.column_stack([i, i, i + 2])])


def collinear(n):
    along = np.arange(n)
    return np.column_stack([along, 2.0 * along, 0 * along]), np.column_stack([along[:-2], along[1:-1], along[2:]])


WORST = {
    "a hundred thousand components": loose_triangles(100000),
    "a fan of thirty thousand faces": fan(30000),
    "faces without area": no_area(100),
    "one triangle": (np.eye(3), np.array([[0, 1, 2]])),
    "collinear": collinear(2000),
    "far from the origin": sheet(60, 0.01, (1e7, -1e7, 1e7)),
    "tiny": sheet(60, 1e-30),
    "huge": sheet(60, 1e30),
}


@pytest.mark.parametrize("case", WORST)
def test_worst_cases(case):
    points, faces = WORST[case]
    n = len(points)
    tags = np.ones(n)
    tags[:n // 4 + 1] = 0
    tags[-(n // 4) - 1:] = 2
    size = np.linalg.norm(np.ptp(points, axis=0))
    move = np.array([0, 0, np.float32(0.2 * size)], float)  # a script passes points in single precision
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=tags), "worst")
    before = snapshot(ms.mesh(0))
    rest = before["points"]
    check_returned(ms.apply_filter(GRAPH), GRAPH_RETURNS)
    ms.set_current_mesh(0)
    check_returned(ms.apply_filter(DEFORM, translation=move), DEFORM_RETURNS)
    assert_unchanged(before, ms.mesh(0))
    moved = ms.current_mesh().vertex_matrix()
    assert np.isfinite(moved).all()
    assert same_points(moved[tags == 0], rest[tags == 0])
    assert np.abs(moved[tags == 2] - rest[tags == 2] - move).max() <= 1e-12 * np.abs(rest).max() + 1e-12 * size
    for layer in ms:
        assert np.isfinite(layer.vertex_matrix()).all() and np.isfinite(layer.vertex_normal_matrix()).all()


def test_all_vertices_at_one_point():
    points, faces = sheet(60)
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(np.tile([1.0, 2, 3], (len(points), 1)), faces, v_scalar_array=np.arange(len(points)) % 2 + 1.0), "one")
    check_returned(ms.apply_filter(GRAPH), GRAPH_RETURNS)
    ms.set_current_mesh(0)
    check_returned(ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.5])), DEFORM_RETURNS)
    assert np.abs(ms.current_mesh().vertex_matrix() - [1, 2, 3.5]).max() < 1e-12


def bad_coordinate(value):
    points, faces = sheet(10)
    points[17, 1] = value
    return points, faces


IMPOSSIBLE = {
    "one vertex, fixed": ((np.eye(3)[:1], np.zeros((0, 3), int)), [-1.0], {}, "no handle"),
    "one vertex, moved": ((np.eye(3)[:1], np.zeros((0, 3), int)), [2.0], {}, "nothing to deform"),
    "a coordinate is not a number": (bad_coordinate(np.nan), None, {}, "Vertex 17"),
    "a coordinate is infinite": (bad_coordinate(-np.inf), None, {}, "Vertex 17"),
    "everything is fixed": (sheet(10), [-1.0] * 100, {}, "no handle"),
    "nothing is tagged": (sheet(10), [1.0] * 100, {}, "no handle"),
    "everything moves": (sheet(10), [2.0] * 100, {}, "nothing to deform"),
    "a tag is not a number": (sheet(10), [0.0] * 50 + [np.nan] + [2.0] * 49, {}, "quality of vertex 50"),
    "a tag is infinite": (sheet(10), [0.0] * 50 + [np.inf] + [2.0] * 49, {}, "quality of vertex 50"),
    "a tag is half a number": (sheet(10), [0.0] * 50 + [1.5] + [2.0] * 49, {}, "whole numbers"),
    "a tag is too large": (sheet(10), [0.0] * 50 + [1e30] + [2.0] * 49, {}, "whole numbers"),
    "a mirror": (sheet(10), None, dict(transformmatrix=np.diag([1.0, 1, -1, 1])), "mirrors"),
    "a flat": (sheet(10), None, dict(transformmatrix=np.diag([0.0, 0, 0, 1])), "flattens"),
    "too far": (sheet(10), None, dict(translation=np.array([0, 0, 1e38])), "too far"),
    "too far beyond the motion": (sheet(10), None, dict(translation=np.array([0, 0, 1.0]), pose=1e35), "too far"),
}


@pytest.mark.parametrize("case", IMPOSSIBLE)
def test_what_cannot_be_done_is_one_message(case):
    (points, faces), tags, parameters, word = IMPOSSIBLE[case]
    if tags is None:
        tags = [0.0] * 30 + [1.0] * 40 + [2.0] * 30
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=np.array(tags)), "impossible")
    before = snapshot(ms.mesh(0))
    with pytest.raises(pymeshlab.PyMeshLabException) as error:
        ms.apply_filter(DEFORM, **parameters)
    assert word in str(error.value) and len(str(error.value)) < 700, str(error.value)
    assert len(list(ms)) == 1
    assert_unchanged(before, ms.mesh(0))


def test_a_layer_matrix_that_flattens_is_an_error():
    ms = clean_bone()
    ms.apply_filter("set_matrix", transformmatrix=np.diag([1.0, 1, 0, 1]), freeze=False)
    before = snapshot(ms.mesh(0))
    for parameters in {}, dict(translation=np.array([0, 0, 0.25])):
        with pytest.raises(pymeshlab.PyMeshLabException, match="The matrix of the layer 'bone.ply' cannot be inverted"):
            ms.apply_filter(DEFORM, **parameters)
        assert len(list(ms)) == 1
    check_returned(ms.apply_filter(GRAPH), GRAPH_RETURNS)  # which needs no matrix
    assert_unchanged(before, ms.mesh(0))


@pytest.mark.parametrize("entry, value, word", [((0, 0), np.nan, "holds a number that is not finite"),
                                                ((1, 3), np.inf, "holds a number that is not finite"),
                                                ((3, 0), 0.5, "is a projection"), ((3, 3), 2, "is a projection"),
                                                ((2, 2), 0, "cannot be inverted"), ((1, 1), 1e-300, "cannot be inverted")])
def test_a_layer_matrix_of_no_use_is_named_as_what_it_is(entry, value, word):
    ms = clean_bone()
    matrix = np.eye(4)
    matrix[entry] = value
    ms.apply_filter("set_matrix", transformmatrix=matrix, freeze=False)
    with pytest.raises(pymeshlab.PyMeshLabException, match=f"The matrix of the layer 'bone.ply' {word}"):
        ms.apply_filter(DEFORM, rotation_angle=30.0)
    assert len(list(ms)) == 1


def test_a_rotation_in_a_layer_that_is_almost_flat():
    ms = clean_bone()
    tags, rest = ms.current_mesh().vertex_scalar_array(), ms.current_mesh().vertex_matrix()
    flat = np.diag([1, 1, 1e-8, 1])
    ms.apply_filter("set_matrix", transformmatrix=flat, freeze=False)
    ms.apply_filter(DEFORM, transforms="2: rotate 1 0 0 30 about 0 0 0", graph_layers=False)
    world = transformed(flat, ms.current_mesh().vertex_matrix())
    wanted = transformed(about([0, 0, 0], rotation([1, 0, 0], 30)), transformed(flat, rest))
    assert np.abs(world - wanted)[tags == 2].max() < 1e-9


def test_the_result_of_a_result_is_numbered():
    ms = clean_bone()
    move = dict(translation=np.array([0, 0, 0.1]))
    for _ in range(3):
        ms.apply_filter(DEFORM, **move)
    ms.apply_filter(GRAPH)
    assert list(layers(ms)) == ["bone.ply", "bone graph", "bone deformed graph", "bone deformed",
                                "bone graph 2", "bone deformed graph 2", "bone deformed 2",
                                "bone graph 3", "bone deformed graph 3", "bone deformed 3", "bone graph 4", "bone patches 4"]
    ms.set_current_mesh(3)
    ms.apply_filter(DEFORM, graph_layers=False, **move)
    assert ms.current_mesh().label() == "bone deformed 2(1)"
    ms.apply_filter(DEFORM, graph_layers=False, **move)
    assert ms.current_mesh().label() == "bone deformed 3(1)"
    # The default is the last graph, where a graph is asked for.
    assert ms.filter_parameter_values(DEFORM)["graph_layer"] == list(layers(ms)).index("bone graph 4")


@pytest.mark.skipif(IS_2022, reason="pymeshlab 2022.2's own functions for point attributes write past the end of the array")
def test_an_attribute_of_points_is_an_error():
    ms = clean_bone()
    ms.current_mesh().add_vertex_custom_point_attribute(np.zeros((ms.current_mesh().vertex_number(), 3)), "wind")
    with pytest.raises(pymeshlab.PyMeshLabException, match="The vertex attribute 'wind' does not hold one number per vertex"):
        ms.apply_filter(DEFORM, handles=2, tag_attribute="wind")
    assert len(list(ms)) == 1


# --- benchmark meshes ---------------------------------------------------------------------------------------------------


def read_off(path):
    words = path.read_text().split()
    n = int(words[1])
    return np.array(words[4:4 + 3 * n], float).reshape(-1, 3)


@pytest.mark.parametrize("case", ["bar", "cactus", "cylinder", "plane"])
def test_the_shape_hardly_depends_on_the_number_of_nodes_and_the_seed(shared, case):
    folder = shared / "meshes" / "bs08"
    files = dict(handles=3, tag_file=str(folder / f"{case}.sel"), transform_file=str(folder / f"{case}.def"), graph_layers=False)
    ms = new_set()
    ms.load_new_mesh(str(folder / f"{case}.off"))
    rest = ms.current_mesh().vertex_matrix()
    diagonal = np.linalg.norm(np.ptp(rest, axis=0))

    def shape(**parameters):
        ms.set_current_mesh(0)
        result = ms.apply_filter(DEFORM, **files, **parameters)
        assert result["converged"]
        points = ms.current_mesh().vertex_matrix()
        ms.delete_current_mesh()
        return points

    def rms(a, b):
        return np.sqrt(((a - b) ** 2).sum(1).mean()) / diagonal

    few, some, many = (shape(initial_patches=n) for n in (190, 400, 1000))  # about 300, 600 and 1500 nodes
    assert max(rms(few, some), rms(few, many), rms(some, many)) < 0.005
    plain = shape()
    assert max(rms(plain, shape(random_seed=seed)) for seed in (2, 3)) < 0.003


# How far 300 patches may be from a node at every vertex, percent of the diagonal: half as far again as the worst of the benchmark's
# shapes is (0.09 to 0.10).
PATCHES = 0.15


@pytest.mark.parametrize("case, limit", [
    # Bar and plane: half of what CGAL's own results with all diagonals one way and the other way differ by (0.70 and 1.75). The
    # references are the means of the two, and who is farther from them than each of the two is worse than another triangulation.
    ("bar", 0.35), ("plane", 0.875),
    # Cactus and cylinder: how far ours is from CGAL's with a node at every vertex, where the energies alone differ (docs/method.md),
    # and what patches may add to that.
    ("cactus", 0.152 + PATCHES), ("cylinder", 0.234 + PATCHES)])
def test_benchmark_of_botsch_and_sorkine(shared, case, limit):
    """Close to converged SR-ARAP (percent of the diagonal, root mean square), constraints exact."""
    folder = shared / "meshes" / "bs08"
    references = [shared / "reference" / "bs08" / f"{case}_sr_arap_{which}.off" for which in ("mean", "free")]
    reference = next((path for path in references if path.exists()), None)
    if not reference:
        pytest.skip(f"{references[0]} is absent")
    ms = new_set()
    ms.load_new_mesh(str(folder / f"{case}.off"))
    rest = ms.current_mesh().vertex_matrix()
    tags = np.loadtxt(folder / f"{case}.sel").astype(int)
    motion = np.loadtxt(folder / f"{case}.def")[:4]
    result = ms.apply_filter(DEFORM, handles=3, tag_file=str(folder / f"{case}.sel"),
                             transform_file=str(folder / f"{case}.def"))
    points, wanted = ms.current_mesh().vertex_matrix(), read_off(reference)
    diagonal = np.linalg.norm(np.ptp(rest, axis=0))
    assert result["converged"]
    assert same_points(points[tags == 0], rest[tags == 0])
    assert np.abs(points[tags >= 2] - transformed(motion, rest[tags >= 2])).max() < 1e-9 * diagonal
    rms = 100 * np.sqrt(((points - wanted) ** 2).sum(1).mean()) / diagonal
    assert rms < limit


@pytest.mark.parametrize("case, energies", [("bar", 0.020), ("cactus", 0.150), ("cylinder", 0.174), ("plane", 0.818)])
def test_shapes_are_near_sr_arap(case, energies):
    """The same on meshes of two thousand vertices of the project's own, with the references that tests/references.py makes.
    energies: how far a node at every vertex is from them, where the energies alone differ; patches may add to that."""
    folder = Path(__file__).resolve().parents[1] / "meshes"
    ms = new_set()
    ms.load_new_mesh(str(folder / f"{case}_sr_arap.ply"))
    wanted = ms.current_mesh().vertex_matrix()
    ms.load_new_mesh(str(folder / f"{case}.ply"))
    rest = ms.current_mesh().vertex_matrix()
    for patches, limit in ((300, energies + PATCHES), (20 * len(rest), 1.1 * energies)):
        ms.set_current_mesh(1)
        result = ms.apply_filter(DEFORM, handles=3, tag_file=str(folder / f"{case}.sel"), transform_file=str(folder / f"{case}.def"),
                                 graph_layers=False, initial_patches=patches)
        points = ms.current_mesh().vertex_matrix()
        assert result["converged"]
        assert 100 * np.sqrt(((points - wanted) ** 2).sum(1).mean()) / np.linalg.norm(np.ptp(rest, axis=0)) < limit


def open_shared(path, folder):
    """Opens a mesh, unpacked into the folder where it is packed."""
    ms = new_set()
    ms.load_new_mesh(str(unpacked(path, folder)))
    return ms


def test_a_gyrus_leaves_those_across_the_sulcus_behind(shared, tmp_path):
    ms = open_shared(shared / "meshes" / "scans" / "cortex_pia_lh_153k.ply.xz", tmp_path)
    rest = ms.current_mesh().vertex_matrix()
    top = rest[np.argmax(rest[:, 2])]
    ms.apply_filter("compute_scalar_by_geodesic_distance_from_given_point_per_vertex", startpoint=top)
    way = ms.current_mesh().vertex_scalar_array()
    tags = tmp_path / "tags.sel"
    np.savetxt(tags, np.where(way < 8, 2, np.where(way > 40, 0, 1)), "%d")
    # Vertices less than 2 mm from each other and more than 8 mm along the surface.
    free = np.flatnonzero((way >= 8) & (way <= 40))
    points, way = rest[free], way[free]
    pairs = []
    for start in range(0, len(free), 1000):
        near = np.linalg.norm(points[start:start + 1000, None] - points, axis=2) < 2
        pairs.append(np.argwhere(near & (way[start:start + 1000, None] + 8 < way)) + [start, 0])
    pairs = np.concatenate(pairs)
    assert len(pairs) > 500
    apart = []
    for weights in (0, 1):
        ms.set_current_mesh(0)
        ms.apply_filter(DEFORM, handles=3, tag_file=str(tags), translation=np.array([0.0, 0, 8]), weights=weights,
                        initial_patches=300, graph_layers=False)  # more, and what is across is across a patch, too
        move = ms.current_mesh().vertex_matrix()[free] - rest[free]
        assert np.isfinite(move).all()
        apart.append(np.linalg.norm(move[pairs[:, 0]] - move[pairs[:, 1]], axis=1).mean())
    assert apart[0] > 1.5 * apart[1]


@pytest.mark.parametrize("name", ["dirty/thingi_73416_38k.stl.xz", "dirty/truck_3k.obj", "attr/cycloidal.ply"])
def test_a_dirty_mesh_bends_alike_for_any_seed(shared, tmp_path, name):
    """Which 300 patches do not do: up to 5.4 and 1.5."""
    ms = open_shared(shared / "meshes" / name, tmp_path)
    rest, faces = ms.current_mesh().vertex_matrix(), ms.current_mesh().face_matrix()
    size = np.ptp(rest, axis=0)
    along = rest[:, np.argmax(size)]
    along = (along - along.min()) / np.ptp(along)
    tags = np.where(along < 0.15, 0.0, np.where(along > 0.85, 2.0, 1.0))
    shapes = []
    for seed in (1, 2, 3):
        ms.clear()
        ms.add_mesh(pymeshlab.Mesh(rest, faces, v_scalar_array=tags))
        ms.apply_filter(DEFORM, random_seed=seed, rotation_axis=np.eye(3)[np.argmin(size)], rotation_angle=60.0, graph_layers=False)
        shapes.append(ms.current_mesh().vertex_matrix())
    apart = [100 * np.linalg.norm(a - b, axis=1) / np.linalg.norm(size) for i, a in enumerate(shapes) for b in shapes[:i]]
    assert max(way.max() for way in apart) < 2
    assert max(np.sqrt((way ** 2).mean()) for way in apart) < 0.7


@pytest.mark.parametrize("name", ["scans/armadillo_43k.ply", "cloud: scans/armadillo_43k.ply", "attr/cycloidal.ply", "dirty/office_chair.obj",
                                  "dirty/elephant_with_holes.off", "dirty/rangemap_lato315_63k.ply", "cloud: points/duplicated_pcloud.ply"])
def test_what_bends_in_one_ball_is_what_bends_in_it_alone(shared, tmp_path, name):
    """Balls that are free, each with a handle in its middle, wherever they are."""
    ms = open_shared(shared / "meshes" / name.split()[-1], tmp_path)
    rest = ms.current_mesh().vertex_matrix()
    faces = {} if name.startswith("cloud") else {"face_matrix": ms.current_mesh().face_matrix()}
    diagonal = np.linalg.norm(np.ptp(rest, axis=0))
    random = np.random.default_rng(1)
    balls = []
    while len(balls) < 4:
        middle, radius = rest[random.integers(len(rest))], diagonal * random.uniform(0.05, 0.12)
        if all(np.linalg.norm(middle - other) > 1.05 * (radius + its) + 0.02 * diagonal for other, its in balls):
            balls.append((middle, radius))
    motions = [f"{2 + k}: rotate {' '.join(map(str, random.normal(size=3)))} 40 translate {0.03 * diagonal} 0 0" for k in range(4)]

    def bent(which):
        tags = np.zeros(len(rest))
        for k in which:
            away = np.linalg.norm(rest - balls[k][0], axis=1)
            tags[away < balls[k][1]] = 1
            tags[away < 0.3 * balls[k][1]] = 2 + k
        ms.clear()
        ms.add_mesh(pymeshlab.Mesh(rest, **faces, v_scalar_array=tags))
        result = ms.apply_filter(DEFORM, transforms="; ".join(motions[k] for k in which), graph_layers=False)
        return ms.current_mesh().vertex_matrix(), result["nodes"]

    together, nodes = bent(range(4))
    each = [bent([k]) for k in range(4)]
    for k, (alone, _) in enumerate(each):
        here = np.linalg.norm(rest - balls[k][0], axis=1) < balls[k][1]
        assert (together[here] == alone[here]).all() and (alone[here] != rest[here]).any()
    assert nodes <= sum(count for _, count in each)


SCANS = ["scans/armadillo_43k.ply"] + ([] if IS_2022 else LARGE_SCANS)  # large ones in one host


@pytest.mark.parametrize("name", SCANS)
def test_patches_of_scans_are_nearly_uniform(shared, name, tmp_path):
    """The coefficient of variation of the patches' areas."""
    ms = open_shared(shared / "meshes" / name, tmp_path)
    result = ms.apply_filter(GRAPH)
    assert result["converged"]
    patches = list(ms)[-1]
    number, points, faces = patches.vertex_scalar_array().astype(int), patches.vertex_matrix(), patches.face_matrix()
    double_area = np.linalg.norm(np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]), axis=1)
    area = np.bincount(number[faces].ravel(), np.repeat(double_area / 6, 3), result["patches"])
    assert area.std() / area.mean() < 0.35


# --- tags without a calculator ------------------------------------------------------------------------------------------

TAGS = "compute_fcd_tags"
TAG, READ, SAVE = "compute_fcd_tags_from_selection", "compute_fcd_tags_from_files", "save_fcd_tags" # its parts, for scripts
HELPER_DEFAULTS = {
    TAGS: {"role": 2, "handle_number": 2, "tag_file": "", "tag_attribute": "", "colorize": True, "save_tag_file": "", "save_transform_file": "",
           "transforms": ""},
    TAG: {"role": 2, "handle_number": 2, "tag_attribute": "", "colorize": True},
    READ: {"tag_file": "", "tag_attribute": "", "colorize": True},
    SAVE: {"handles": 0, "tag_attribute": "fcd_tag", "tag_file": "", "transform_file": "", "transforms": "",
           "translation": [0, 0, 0], "rotation_axis": [0, 0, 1], "rotation_angle": 0, "rotation_center": 0, "rotation_point": [0, 0, 0],
           "transformmatrix": np.eye(4), "handle_layer": 0}}
TAG_COLORS = {-1: [154, 154, 154], 0: [59, 111, 201], 1: [240, 197, 60], 2: [210, 60, 50]}


@pytest.mark.parametrize("name", HELPER_DEFAULTS)
def test_parameters_of_the_tag_filters(name):
    test_parameters_names_order_and_defaults(name, HELPER_DEFAULTS[name])
    test_a_document_without_layers_is_an_error_and_no_crash(name)


def untagged_bone():
    ms = clean_bone()
    set_quality(ms, "0")
    return ms


def select(ms, vertices="", faces=""):
    ms.apply_filter("set_selection_none")
    if faces:
        ms.apply_filter("compute_selection_by_condition_per_face", condselect=faces)
    if vertices:
        ms.apply_filter("compute_selection_by_condition_per_vertex", condselect=vertices)
    return ms.current_mesh().vertex_selection_array()


def state(mesh):
    return dict(snapshot(mesh), faces_selected=mesh.face_selection_array(), face_normals=mesh.face_normal_matrix())


def in_place(ms, name, may_change=("quality", "colors"), **parameters):
    """Applies a filter that changes tags and colours only; returns (returned values, tags in the quality)."""
    mesh, before = ms.current_mesh(), state(ms.current_mesh())
    result = ms.apply_filter(name, **parameters)
    assert len(list(ms)) == 1 and ms.current_mesh_id() == 0
    after = state(mesh)
    for key in before:
        assert key in may_change or before[key].tobytes() == after[key].tobytes(), key
    return result, mesh.vertex_scalar_array()


def check_counts(result, tags):
    assert {key: type(value) for key, value in result.items()} == dict.fromkeys(
        ["fixed_vertices", "handle_vertices", "free_vertices", "outside_vertices"], int)
    assert result["fixed_vertices"] == (tags == 0).sum() and result["free_vertices"] == (tags == 1).sum()
    assert result["handle_vertices"] == (tags >= 2).sum() and result["outside_vertices"] == (tags < 0).sum()


def check_colors(mesh, tags):
    colors = np.rint(mesh.vertex_color_matrix() * 255).astype(int)
    for tag, color in TAG_COLORS.items():
        assert (colors[tags == tag] == color + [255]).all()


@pytest.mark.parametrize("role, tag", [(0, 0), (1, 1), (2, 2), (3, -1)])
def test_role_of_a_selection_on_an_untagged_layer(role, tag):
    ms = untagged_bone()
    chosen = select(ms, "x > 0.75")
    result, tags = in_place(ms, TAG, role=role)
    assert 0 < chosen.sum() < len(chosen)
    assert (tags == np.where(chosen, tag, 1)).all()
    check_counts(result, tags)
    check_colors(ms.current_mesh(), tags)


def test_tagging_step_by_step_and_deforming():
    ms = untagged_bone()
    rest = ms.current_mesh().vertex_matrix()
    expected = np.ones(len(rest))
    # Selected faces count with their vertices; what is not selected keeps its tag.
    select(ms, faces="(x0 < 0.25) && (x1 < 0.25) && (x2 < 0.25)")
    mesh = ms.current_mesh()
    expected[mesh.face_matrix()[mesh.face_selection_array()].ravel()] = 0
    assert (in_place(ms, TAG, role=0)[1] == expected).all()
    for condition, number in (("x > 0.9", 3), ("(x > 0.75) && (x < 0.8)", 7), ("x > 0.95", 2)):
        expected[select(ms, condition)] = number
        result, tags = in_place(ms, TAG, handle_number=number)
        assert (tags == expected).all()
    expected[select(ms, "x < 0.1", faces="(x0 > 0.85) && (x0 < 0.9)") | (expected == -1)] = -1
    expected[mesh.face_matrix()[mesh.face_selection_array()].ravel()] = -1
    assert (in_place(ms, TAG, role=3, handle_number=0)[1] == expected).all()  # the number is not read
    expected[select(ms, "x > 0.97")] = 1
    result, tags = in_place(ms, TAG, role=1)
    assert (tags == expected).all() and set(tags) == {-1, 0, 1, 2, 3, 7}
    check_counts(result, tags)
    check_colors(mesh, tags)
    deformed = ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.25]))
    assert all(deformed[key] == value for key, value in result.items())
    assert np.abs(ms.current_mesh().vertex_matrix()[tags >= 2] - rest[tags >= 2] - [0, 0, 0.25]).max() < 1e-12


def test_everything_selected_is_tagged():
    ms = untagged_bone()
    ms.apply_filter("set_selection_all")
    assert (in_place(ms, TAG, role=3)[1] == -1).all()
    assert (in_place(ms, TAG, role=0)[1] == 0).all()


def test_handles_are_shades_of_red():
    ms = untagged_bone()
    shades = []
    for number in list(range(2, 30)) + [1000, 12345678]:
        chosen = select(ms, "x > 0.75")
        in_place(ms, TAG, handle_number=number)
        colors = np.unique(np.rint(ms.current_mesh().vertex_color_matrix()[chosen] * 255).astype(int), axis=0)
        assert len(colors) == 1
        shades.append(tuple(colors[0]))
    assert len(set(shades)) == len(shades)
    assert all(r > g + 40 and r > b + 40 for r, g, b, _ in shades)


def test_tagging_without_colours():
    ms = untagged_bone()
    ms.apply_filter("compute_color_by_function_per_vertex", x="x*255", y="y*255", z="z*255")
    select(ms, "x > 0.75")
    in_place(ms, TAG, may_change=("quality",), colorize=False)


def test_tags_in_an_attribute(tmp_path):
    ms = clean_bone()
    set_quality(ms, "x")  # no tags, and stays
    mesh = ms.current_mesh()
    tags = np.where(select(ms, "x < 0.25"), 0, 1)
    result, _ = in_place(ms, TAG, may_change=("colors",), role=0, tag_attribute="my_tags")
    check_counts(result, tags)
    assert (mesh.vertex_custom_scalar_attribute_array("my_tags") == tags).all()
    tags[select(ms, "x > 0.75")] = 5
    in_place(ms, TAG, may_change=("colors",), handle_number=5, tag_attribute="my_tags")
    assert (mesh.vertex_custom_scalar_attribute_array("my_tags") == tags).all()
    check_colors(mesh, tags)
    # An attribute that is 0 everywhere says fixed, since it is there to hold tags.
    mesh.add_vertex_custom_scalar_attribute(np.zeros(len(tags)), "zero")
    in_place(ms, TAG, may_change=("colors",), tag_attribute="zero")
    assert (mesh.vertex_custom_scalar_attribute_array("zero") == np.where(tags == 5, 2, 0)).all()

    path = str(tmp_path / "t.sel")
    in_place(ms, SAVE, may_change=(), handles=2, tag_attribute="my_tags", tag_file=path)
    assert (np.loadtxt(path) == tags).all()
    result, _ = in_place(ms, READ, may_change=("colors",), tag_file=path, tag_attribute="read")
    assert (mesh.vertex_custom_scalar_attribute_array("read") == tags).all()
    check_counts(result, tags)
    deformed = ms.apply_filter(DEFORM, handles=2, tag_attribute="read", translation=np.array([0, 0, 0.25]))
    assert all(deformed[key] == value for key, value in result.items())


def test_tags_from_files(tmp_path):
    ms = clean_bone()
    set_quality(ms, "x")  # whatever it is, it is replaced
    x = ms.current_mesh().vertex_matrix()[:, 0]
    tags = np.where(x < 0.1, -2147483648, np.where(x < 0.25, 0, np.where(x > 0.75, 2, 1)))
    result, read = in_place(ms, READ, tag_file=write_tags(tmp_path / "t.sel", tags))
    assert (read == tags).all()
    check_counts(result, tags)
    check_colors(ms.current_mesh(), np.maximum(tags, -1))
    in_place(ms, READ, may_change=(), tag_file=write_tags(tmp_path / "t.sel", tags), colorize=False)
    # What was written is read, the lowest tag, too.
    in_place(ms, SAVE, may_change=(), tag_file=str(tmp_path / "again.sel"))
    assert (np.loadtxt(tmp_path / "again.sel") == tags).all()
    assert ms.apply_filter(DEFORM, translation=np.array([0, 0, 0.25]))["outside_vertices"] == (tags < 0).sum() > 0


@pytest.mark.parametrize("attribute", ["", "other"])
def test_one_filter_does_what_its_parts_do(tmp_path, attribute):
    parts, whole = untagged_bone(), untagged_bone()
    for role, condition in enumerate(["x < 0.25", "x < 0.1", "x > 0.75", "x > 0.9"]):
        given = dict(role=role, handle_number=3, tag_attribute=attribute, colorize=role < 3)
        results = []
        for ms, name in ((parts, TAG), (whole, TAGS)):
            select(ms, condition)
            results.append(ms.apply_filter(name, **given))
        assert results[0] == results[1]
    text = "3: translate 0 0 0.5"
    parts.apply_filter(SAVE, handles=2 if attribute else 0, tag_attribute=attribute or "fcd_tag", tag_file=str(tmp_path / "a.sel"),
                       transform_file=str(tmp_path / "a.def"), transforms=text)
    before = state(whole.current_mesh())
    told = whole.apply_filter(TAGS, role=5, tag_attribute=attribute, save_tag_file=str(tmp_path / "b.sel"), save_transform_file=str(tmp_path / "b.def"),
                              transforms=text)
    assert told == results[1] and all(before[key].tobytes() == value.tobytes() for key, value in state(whole.current_mesh()).items())
    for ending in (".sel", ".def"):
        assert (tmp_path / f"a{ending}").read_bytes() == (tmp_path / f"b{ending}").read_bytes()
    for ms, name, role in ((parts, READ, {}), (whole, TAGS, {"role": 4})):
        select(ms, "x < 2")
        ms.apply_filter(TAG, role=1)
        ms.apply_filter(name, tag_file=str(tmp_path / "a.sel"), tag_attribute=attribute, **role)
    one, other = state(parts.current_mesh()), state(whole.current_mesh())
    assert one.keys() == other.keys() and all(one[key].tobytes() == other[key].tobytes() for key in one)


@pytest.mark.parametrize("given, message", [
    (dict(role=4), "tag_file is empty"), (dict(role=2, selected=True, tag_file="t.sel"), "tag_file would not be read"), (dict(role=5), "There is nothing to do"),
    (dict(role=2, handle_number=1), "handle_number is 1"), (dict(role=2), "Nothing is selected"),
    (dict(role=2, selected=True, save_tag_file="no/such/folder/t.sel"), "no/such/folder"),
    (dict(role=0, selected=True, save_transform_file="t.def"), "No vertex belongs to a handle"),
    (dict(role=2, selected=True, save_tag_file="t.sel", save_transform_file="t.sel"), "save_tag_file and save_transform_file are the same file"),
    (dict(role=4, tag_file="t.sel", save_transform_file="./t.sel"), "tag_file and save_transform_file are the same file"),
    (dict(role=5, save_tag_file="t.sel"), "nobody has tagged"),
    (dict(role=5, save_tag_file="t.sel", tag_attribute="misspelt"), "no vertex attribute 'misspelt'"),
    (dict(role=2, selected=True, save_transform_file="t.def", transforms="2: turn"), "turn")])
def test_tags_that_cannot_be_made_or_saved_change_nothing(tmp_path, monkeypatch, given, message):
    monkeypatch.chdir(tmp_path)
    ms = untagged_bone()
    select(ms, "x > 0.75" if given.pop("selected", False) else "")
    before = state(ms.current_mesh())
    with pytest.raises(pymeshlab.PyMeshLabException, match=message):
        ms.apply_filter(TAGS, **given)
    after = state(ms.current_mesh())
    assert all(before[key].tobytes() == after[key].tobytes() for key in before) and not list(tmp_path.iterdir())


def test_tags_of_a_mesh_with_deleted_vertices(tmp_path):
    ms = clean_bone()
    select(ms, "(x > 0.5) && (x < 0.55) && (z < 0.5)")
    ms.apply_filter("meshing_remove_selected_vertices")
    mesh, path = ms.current_mesh(), str(tmp_path / "t.sel")
    tags = mesh.vertex_scalar_array()
    check_counts(in_place(ms, SAVE, may_change=(), tag_file=path)[0], tags)
    assert (np.loadtxt(path) == tags).all()
    set_quality(ms, "0")
    assert (in_place(ms, READ, tag_file=path)[1] == tags).all()


MOTIONS = {
    "translation": dict(translation=np.array([0.1, -0.2, 0.25])),
    "rotation": dict(rotation_axis=np.array([0.3, 1, 0.1]), rotation_angle=-50.0),
    "all": dict(translation=np.array([0, 0, 0.1]), rotation_axis=np.array([0, 1.0, 0.2]), rotation_angle=20.0, rotation_center=2,
                rotation_point=np.array([0.7, 0.4, 0.3]), transformmatrix=about([0.8, 0.5, 0.5], 1.1 * rotation([1, 2, 3], 10))),
    "text": dict(transforms="2: translate 0 0 0.25; 4: rotate 1 2 0 40 translate 0 0.1 0.25"),
}


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("placed", [False, True])
def test_saved_tags_and_motions_deform_as_the_parameters_do(tmp_path, motion, placed):
    tag_file, transform_file = str(tmp_path / "t.sel"), str(tmp_path / "t.def")
    ms = clean_bone()
    set_quality(ms, "(x < 0.1) ? 0-3 : ((x < 0.25) ? 0 : ((x > 0.9) ? 4 : ((x > 0.75) ? 2 : 1)))")
    if placed:
        place = translation([3, -2, 1]) @ about([0, 0, 0], 2 * rotation([1, 2, 3], 50))
        ms.apply_filter("set_matrix", transformmatrix=place, freeze=False)
    tags = ms.current_mesh().vertex_scalar_array()
    result, _ = in_place(ms, SAVE, may_change=(), tag_file=tag_file, transform_file=transform_file, **MOTIONS[motion])
    check_counts(result, tags)
    assert (np.loadtxt(tag_file) == tags).all()
    matrices = np.loadtxt(transform_file).reshape(-1, 4, 4)
    assert len(matrices) == 3 and (matrices[1] == np.eye(4)).all()  # handles 2, 3 (no vertex), 4
    ms.apply_filter(DEFORM, **MOTIONS[motion])
    direct = ms.current_mesh().vertex_matrix()
    ms.set_current_mesh(0)
    ms.apply_filter(DEFORM, handles=3, tag_file=tag_file, transform_file=transform_file)
    points = ms.current_mesh().vertex_matrix()
    if placed:
        assert np.abs(points - direct).max() < 1e-12 * np.linalg.norm(np.ptp(direct, axis=0))
    else:
        assert same_points(points, direct)


def test_save_tags_of_the_selection_without_motions(tmp_path):
    ms = untagged_bone()
    chosen = select(ms, "x > 0.75", faces="(x0 < 0.25) && (x1 < 0.25) && (x2 < 0.25)")
    mesh, path = ms.current_mesh(), tmp_path / "a folder" / "tágs.sel"
    path.parent.mkdir()
    tags = np.ones(len(chosen))
    tags[mesh.face_matrix()[mesh.face_selection_array()].ravel()] = 0
    tags[chosen] = 2
    # A matrix that cannot be inverted is no concern where no motions are saved.
    ms.apply_filter("set_matrix", transformmatrix=np.diag([1.0, 1, 0, 1]), freeze=False)
    check_counts(in_place(ms, SAVE, may_change=(), handles=1, tag_file=str(path))[0], tags)
    assert (np.loadtxt(path) == tags).all()
    assert os.listdir(path.parent) == [path.name]


def contents(folder):
    """What is in the files of a folder, and where its links lead."""
    return {path.name: os.readlink(path) if path.is_symlink() else path.read_bytes() for path in folder.iterdir() if not path.is_dir()}


@pytest.mark.parametrize("way", ["link", "link to nothing", "chain of links", "linked folder", "folder and back", "hard link", "case"])
def test_tags_and_motions_do_not_go_to_one_file_by_two_names(tmp_path, way):
    ms = clean_bone()
    folder = tmp_path / "folder"
    folder.mkdir()
    first, second = tmp_path / "a.sel", tmp_path / "b.def"
    if way == "case":
        first, second = folder / "Á.sel", tmp_path / "folder" / "a\u0301.SEL"
    elif way != "link to nothing":
        first.write_text("old\n")
    if way in ("link", "link to nothing"):
        second.symlink_to("a.sel")
    elif way == "chain of links":
        second.symlink_to(folder / "c")
        (folder / "c").symlink_to("../a.sel")
    elif way == "linked folder":
        (tmp_path / "again").symlink_to(folder)
        first, second = folder / "t", tmp_path / "again" / "t"
    elif way == "folder and back":
        second = folder / ".." / "a.sel"
    elif way == "hard link":
        second.hardlink_to(first)
    files = contents(tmp_path), contents(folder)
    with pytest.raises(pymeshlab.PyMeshLabException, match="are the same file"):
        ms.apply_filter(SAVE, tag_file=str(first), transform_file=str(second))
    assert (contents(tmp_path), contents(folder)) == files


def test_saving_replaces_what_a_link_leads_to_and_keeps_its_permissions(tmp_path):
    ms = clean_bone()
    real, link, motions = tmp_path / "real.sel", tmp_path / "link.sel", tmp_path / "t.def"
    real.write_text("old\n")
    real.chmod(0o640)
    link.symlink_to("real.sel")
    motions.symlink_to("new.def")
    ms.apply_filter(SAVE, tag_file=str(link), transform_file=str(motions))
    assert (np.loadtxt(real) == ms.current_mesh().vertex_scalar_array()).all() and real.stat().st_mode & 0o777 == 0o640
    assert (np.loadtxt(tmp_path / "new.def") == np.eye(4)).all()
    assert link.is_symlink() and motions.is_symlink() and len(os.listdir(tmp_path)) == 4


TAG_ERRORS = {
    "nothing is selected": (TAG, QUALITY_TAGS, "", dict(), "Nothing is selected"),
    "handle number too small": (TAG, QUALITY_TAGS, "x > 0.5", dict(handle_number=1), "handle_number is 1"),
    "quality is no tag": (TAG, "x", "x > 0.5", dict(), "set its quality to 0 everywhere"),
    "attribute is no tag": (TAG, "x", "x > 0.5", dict(tag_attribute="half"), "name of a new attribute"),
    "attribute is no scalar": (TAG, "x", "x > 0.5", dict(tag_attribute="wind"), "is no scalar"),
    "no tag file": (READ, "x", "", dict(), "tag_file is empty"),
    "tag file is missing": (READ, "x", "", dict(tag_file="/no/such.sel"), "/no/such.sel"),
    "too few tags": (READ, "x", "", dict(tag_file="FOLDER/short.sel"), "has 3 tags"),
    "tag file holds words": (READ, "x", "", dict(tag_file="FOLDER/words.sel"), "line 2"),
    "read into no scalar": (READ, "x", "", dict(tag_file="FOLDER/good.sel", tag_attribute="wind"), "is no scalar"),
    "tags to no file": (SAVE, QUALITY_TAGS, "", dict(transform_file="FOLDER/new.def"), "tag_file is empty"),
    "tags to no folder": (SAVE, QUALITY_TAGS, "", dict(tag_file="/no/such/t.sel"), "Cannot write '/no/such/t.sel': No such file or directory."),
    "motions to no folder": (SAVE, QUALITY_TAGS, "", dict(tag_file="FOLDER/good.sel", transform_file="/no/such/t.def"),
                             "Cannot write '/no/such/t.def': No such file or directory."),
    "one file for both": (SAVE, QUALITY_TAGS, "", dict(tag_file="FOLDER/new", transform_file="FOLDER/new"), "same file"),
    "tags to a folder": (SAVE, QUALITY_TAGS, "", dict(tag_file="FOLDER"), "it is no ordinary file"),
    "motions to a device": (SAVE, QUALITY_TAGS, "", dict(tag_file="FOLDER/good.sel", transform_file="/dev/full"), "it is no ordinary file"),
    "nobody tagged the vertices": (SAVE, "0", "", dict(tag_file="FOLDER/new.sel"), "nobody has tagged"),
    "saved quality is no tag": (SAVE, "x", "", dict(tag_file="FOLDER/new.sel"), "whole numbers"),
    "saved selection is empty": (SAVE, "0", "", dict(handles=1, tag_file="FOLDER/new.sel"), "no vertex is selected"),
    "no such attribute": (SAVE, "0", "", dict(handles=2, tag_file="FOLDER/new.sel"), "fcd_tag"),
    "attribute without a name": (SAVE, "0", "", dict(handles=2, tag_attribute="", tag_file="FOLDER/new.sel"), "tag_attribute"),
    "no handle moves": (SAVE, "x < 0.5", "", dict(tag_file="FOLDER/new.sel", transform_file="FOLDER/new.def"), "no motions"),
    "too many matrices": (SAVE, "x < 0.5 ? 1 : 200000", "", dict(tag_file="FOLDER/new.sel", transform_file="FOLDER/new.def"),
                          "200000"),
    "axis is zero": (SAVE, QUALITY_TAGS, "", dict(tag_file="FOLDER/new.sel", transform_file="FOLDER/new.def", rotation_angle=10.0,
                                                  rotation_axis=np.zeros(3)), "rotation_axis"),
    "matrix flattens": (SAVE, QUALITY_TAGS, "", dict(tag_file="FOLDER/new.sel", transform_file="FOLDER/new.def",
                                                     transformmatrix=np.diag([1.0, 1, 0, 1])), "flatten"),
}


@pytest.mark.parametrize("case", TAG_ERRORS)
def test_an_error_about_tags_changes_nothing(tmp_path, case):
    name, quality, selected, parameters, word = TAG_ERRORS[case]
    if parameters.get("tag_attribute") == "wind" and IS_2022:
        pytest.skip("pymeshlab 2022.2's own functions for point attributes write past the end of the array")
    ms = clean_bone()
    mesh = ms.current_mesh()
    n = mesh.vertex_number()
    set_quality(ms, quality)
    select(ms, selected)
    if parameters.get("tag_attribute") == "half":
        mesh.add_vertex_custom_scalar_attribute(np.full(n, 0.5), "half")
    if parameters.get("tag_attribute") == "wind":
        mesh.add_vertex_custom_point_attribute(np.zeros((n, 3)), "wind")
    write_tags(tmp_path / "short.sel", [0, 1, 2])
    write_tags(tmp_path / "words.sel", ["two"] * n)
    write_tags(tmp_path / "good.sel", [1] * n)
    before, files = state(mesh), contents(tmp_path)
    with pytest.raises(pymeshlab.PyMeshLabException) as error:
        ms.apply_filter(name, **{key: value.replace("FOLDER", str(tmp_path)) if isinstance(value, str) else value
                                 for key, value in parameters.items()})
    message = str(error.value)
    assert word in message and "Details:" in message and len(message) < 800, message
    assert len(list(ms)) == 1
    after = state(mesh)
    for key in before:
        assert before[key].tobytes() == after[key].tobytes(), key
    assert contents(tmp_path) == files


# --- all benchmark meshes through all filters ---------------------------------------------------------------------------

ALL_MESHES = MESHES + ["bs08/grid.off", "bs08/simple.off", "bs08/uniform.off"]
if not IS_2022:
    ALL_MESHES += LARGE_SCANS + ["scans/mni_t1wm_stack_1230k.ply.xz"]


def data_of(mesh):
    """All that a layer carries but positions and normals, by the name of what gets it."""
    data = {"matrix": np.array(matrix(mesh)), "textures": np.array(sorted(mesh.textures()))}
    for name in ("face_matrix", "edge_matrix", "vertex_color_matrix", "vertex_scalar_array", "vertex_selection_array", "face_color_matrix",
                 "face_scalar_array", "face_selection_array", "vertex_tex_coord_matrix", "wedge_tex_coord_matrix"):
        try:
            data[name] = getattr(mesh, name)()
        except pymeshlab.MissingComponentException:
            pass
    for name in ("fcd_tag", "heat"):
        data[name] = mesh.vertex_custom_scalar_attribute_array(name)
    if mesh.face_number():
        data["cold"] = mesh.face_custom_scalar_attribute_array("cold")
    return data


def assert_same_data(before, after, but=()):
    assert before.keys() == after.keys()
    for key in before:
        assert key in but or (before[key].shape == after[key].shape and before[key].tobytes() == after[key].tobytes()), key


@pytest.mark.parametrize("name", ALL_MESHES)
def test_every_mesh_through_every_filter(shared, name, tmp_path):
    ms = open_shared(shared / "meshes" / name, tmp_path)
    count, current = len(list(ms)), ms.current_mesh_id()
    ms.apply_filter("set_matrix", transformmatrix=translation([3, -2, 1]), freeze=False)
    mesh = ms.current_mesh()
    rest, normals = mesh.vertex_matrix(), mesh.vertex_normal_matrix()
    # A quarter stays, a quarter moves; vertices at one place have one tag.
    axis = int(np.argmax(np.ptp(rest, axis=0)))
    along = np.sort(rest[:, axis])
    low, high = along[len(along) // 4], along[-1 - len(along) // 4]
    free = along[(along > low) & (along < high)]
    if not len(free):
        low, high = along[0], along[-1]
    x = rest[:, axis]
    tags = np.where(x <= low, 0.0, np.where(x >= high, 2.0, 1.0))
    assert set(tags) == {0, 1, 2}
    random = np.random.default_rng(1)
    mesh.add_vertex_custom_scalar_attribute(tags, "fcd_tag")
    mesh.add_vertex_custom_scalar_attribute(random.random(len(rest)), "heat")
    if mesh.face_number():
        mesh.add_face_custom_scalar_attribute(random.random(mesh.face_number()), "cold")
    letter = "xyz"[axis]
    ms.apply_filter("compute_selection_by_condition_per_vertex", condselect=f"{letter} > {high:.17g}")
    selected = mesh.vertex_selection_array()
    before = data_of(mesh)

    def assert_input_unchanged():
        assert same_points(mesh.vertex_matrix(), rest) and mesh.vertex_normal_matrix().tobytes() == normals.tobytes()
        assert_same_data(before, data_of(mesh))
        assert mesh.is_visible()

    def begin():
        ms.set_current_mesh(current)

    check_returned(ms.apply_filter(GRAPH), GRAPH_RETURNS)
    assert_input_unchanged()
    graph, patches = list(ms)[-2:]
    assert np.isfinite(graph.vertex_matrix()).all() and same_points(patches.vertex_matrix(), rest)
    begin()
    move = np.zeros(3)
    move[(axis + 1) % 3] = np.float32(0.1 * np.ptp(x))  # a script passes points in single precision
    result = ms.apply_filter(DEFORM, handles=2, translation=move)
    check_returned(result, DEFORM_RETURNS)
    assert result["fixed_vertices"] == (tags == 0).sum() and result["handle_vertices"] == (tags == 2).sum()
    assert_input_unchanged()
    deformed = ms.current_mesh()
    points = deformed.vertex_matrix()
    assert np.isfinite(points).all() and np.isfinite(deformed.vertex_normal_matrix()).all()
    assert same_points(points[tags == 0], rest[tags == 0])
    assert np.abs(points[tags == 2] - rest[tags == 2] - move).max() < 1e-9 * (1 + np.abs(rest).max())
    assert_same_data(before, data_of(deformed))
    assert deformed.label() == f"{mesh.label().rsplit('.', 1)[0]} deformed" and deformed.is_visible()
    if not deformed.face_number():  # turned with the surface, but not those of what is fixed
        turned = deformed.vertex_normal_matrix()
        length = np.linalg.norm(normals, axis=1)
        assert np.allclose(np.linalg.norm(turned, axis=1), length > 0, atol=1e-6)
        fixed = (tags == 0) & (length > 0)
        assert np.allclose(turned[fixed], (normals / np.maximum(length, 1e-30)[:, None])[fixed], atol=1e-6)
    for layer in ms:
        assert np.allclose(matrix(layer), translation([3, -2, 1]), atol=0)
    assert len(list(ms)) == count + 5

    begin()
    path = str(tmp_path / "saved.sel")
    check_counts(ms.apply_filter(SAVE, handles=2, tag_file=path), tags)
    assert_input_unchanged()
    assert (np.loadtxt(path, ndmin=1) == tags).all()
    check_counts(ms.apply_filter(READ, tag_file=path, tag_attribute="read", colorize=False), tags)
    assert_input_unchanged()
    assert (mesh.vertex_custom_scalar_attribute_array("read") == tags).all()
    if selected.any() or mesh.face_selection_array().any():
        ms.apply_filter(TAG, role=3, tag_attribute="read", colorize=False)
        assert_input_unchanged()
        assert (mesh.vertex_custom_scalar_attribute_array("read")[selected] == -1).all()
    assert len(list(ms)) == count + 5
    ms.clear()  # large ones would stay in memory


def test_steps_reach_the_same_pose_where_there_is_one_way():
    points = []
    for steps in (1, 5):
        ms = two_sheets(0)
        ms.apply_filter(DEFORM, translation=[-2, 0, 8], rotation_axis=[0, 1, 0], rotation_angle=-60, tolerance=1e-8, pose_steps=steps)
        points.append(ms.current_mesh().vertex_matrix())
    assert np.abs(points[0] - points[1]).max() < 1e-3


def test_a_turn_is_what_is_told_by_whatever_asks():
    def turned(**how):
        ms = slender()
        rest = ms.current_mesh().vertex_matrix()
        result = ms.apply_filter(DEFORM, **how)
        points = ms.current_mesh().vertex_matrix()
        ms.set_current_mesh(0)
        ms.apply_filter(POSE, **{name: value for name, value in how.items() if name not in OF_LAYERS})
        assert (ms.current_mesh().vertex_matrix() == points).all()
        x, y = rest[:, :2].T, points[:, :2].T
        middle = np.abs(rest[:, 2] - 5.5) < 0.3
        sine, cosine = (x[0] * y[1] - x[1] * y[0])[middle].sum(), (x * y).sum(0)[middle].sum()
        return points, np.degrees(np.arctan2(sine, cosine)), result

    typed, middle, result = turned(rotation_angle=190)
    assert abs(middle - 95) < 5 and result["steps"] == 4 and result["stable"] and not result["jumps"]
    for other in (dict(transforms="2: rotate 0 0 1 190"), dict(transforms="2: rotate 0 0 1 380", pose=50),
                  dict(transforms="2: rotate 0 0 2 100 rotate 0 0 -1 -90")):
        assert np.abs(turned(**other)[0] - typed).max() < 1e-4, other
    twice = [turned(transforms=f"2: rotate 0 0 1 {degrees}")[2] for degrees in (719, 720, 721)]
    assert np.ptp([result["energy"] for result in twice]) < 0.01 * twice[0]["energy"] and twice[1]["energy"] > 1
    assert [result["steps"] for result in twice] == [12, 12, 13] and all(result["converged"] for result in twice)


@pytest.mark.parametrize("percent", [15, 30, 40])  # at 20 it is about to give way: what patches make out counts for more
def test_what_is_pressed_beyond_what_it_carries_is_the_same_for_every_seed(percent):
    shapes, stable = [], []
    for seed in range(1, 5):
        ms = slender(60, 180)  # fine enough that seeds differ little at rest
        diagonal = np.linalg.norm(np.ptp(ms.current_mesh().vertex_matrix(), axis=0))
        result = ms.apply_filter(DEFORM, translation=[0, 0, -percent / 100 * diagonal], random_seed=seed, initial_patches=300)
        assert result["converged"] and not result["jumps"] and result["iterations"] < 110
        shapes.append(ms.current_mesh().vertex_matrix())
        stable.append(result["stable"])
    assert all(stable) == (percent == 15)
    assert max(np.sqrt(((a - b) ** 2).sum(1).mean()) for a in shapes for b in shapes) < 0.005 * diagonal
