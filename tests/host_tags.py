# SPDX-License-Identifier: GPL-3.0-or-later
"""What tagging leaves of a layer, inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import numpy as np
import pymeshlab
import pytest

from conftest import transformed
from host_pymeshlab import COPY, DEFORM, POSE, RESET, SAVE, TAG, allocated, clean_bone, matrix, new_set, same_points, set_quality

CLEAR, GRAPH = "clear_fcd_tags", "generate_fcd_deformation_graph"
BEND = dict(translation=np.array([0, 0, 0.25]), rotation_axis=np.array([0.0, 1, 0]), rotation_angle=-40.0)


def tag_ends(ms):
    """Fixed below 0.25, handle 2 above 0.75."""
    for condition, role in (("x < 0.25", 0), ("x > 0.75", 2)):
        ms.compute_selection_by_condition_per_vertex(condselect=condition)
        ms.apply_filter(TAG, role=role)


def coloured():
    """The bone with colours and a quality of its own."""
    ms = clean_bone()
    ms.compute_color_by_function_per_vertex(x="255 * x", y="100", z="50")
    set_quality(ms, "x + 0.125")
    ms.compute_selection_by_condition_per_vertex(condselect="1 < 0")
    return ms


def look(ms):
    mesh = ms.current_mesh()
    return mesh.vertex_color_matrix(), mesh.vertex_scalar_array()


def test_tags_stand_in_the_place_of_colours_and_quality_until_they_are_cleared():
    ms = coloured()
    color, quality = look(ms)
    with pytest.raises(pymeshlab.PyMeshLabException, match="are whole numbers"):
        tag_ends(ms)  # a quality that is no tags is not overwritten
    assert same_points(look(ms)[0], color) and same_points(look(ms)[1], quality)
    set_quality(ms, "x < 0.3 ? 5 : (x < 0.6 ? 1 : 4)")  # may be tags
    quality = look(ms)[1]
    tag_ends(ms)
    tags = look(ms)[1]
    assert set(np.unique(tags[ms.current_mesh().vertex_matrix()[:, 0] < 0.25])) == {0}
    assert not same_points(look(ms)[0], color)
    ms.apply_filter(CLEAR)
    assert same_points(look(ms)[0], color) and same_points(look(ms)[1], quality)
    with pytest.raises(pymeshlab.PyMeshLabException, match="nothing to bring back"):
        ms.apply_filter(CLEAR)


@pytest.mark.parametrize("target, words", [({}, "colours and quality"), (dict(colorize=False), "quality"), (dict(tag_attribute="tags"), "colours"),
                                           (dict(tag_attribute="tags", colorize=False), None)])
def test_the_log_says_what_a_file_has_that_is_saved_now(capfd, target, words):
    ms = clean_bone()
    set_quality(ms, "0")
    ms.compute_selection_by_condition_per_vertex(condselect="x < 0.25")
    ms.set_verbosity(True)
    capfd.readouterr()
    ms.apply_filter(TAG, role=0, **target)
    log = capfd.readouterr()
    assert (f"the file has the tags as {words} instead of its own" if words else " fixed") in log.err + log.out
    assert bool(words) == ("the file has the tags" in log.err + log.out)


def test_the_deformed_layer_has_the_colours_that_the_mesh_had():
    ms = coloured()
    set_quality(ms, "0")
    color = look(ms)[0]
    tag_ends(ms)
    tags = look(ms)[1]
    assert (tags == 0).any() and (tags == 1).any() and (tags == 2).any()
    ms.apply_filter(DEFORM, graph_layers=False, **BEND)
    assert same_points(look(ms)[0], color)
    assert same_points(look(ms)[1], tags), "it had no quality, so that tags may be used again"
    # Tagged twice, the colours of tags are not taken for the mesh's own.
    ms.set_current_mesh(0)
    tag_ends(ms)
    ms.apply_filter(DEFORM, graph_layers=False, **BEND)
    assert same_points(look(ms)[0], color)


def test_the_deformed_layer_has_the_quality_that_the_mesh_had():
    ms = coloured()
    set_quality(ms, "x < 0.3 ? 5 : (x < 0.6 ? 1 : 4)")
    quality = look(ms)[1]
    tag_ends(ms)
    ms.apply_filter(DEFORM, graph_layers=False, **BEND)
    assert same_points(look(ms)[1], quality)


def test_colours_that_were_given_after_tagging_are_meant():
    ms = coloured()
    set_quality(ms, "0")
    tag_ends(ms)
    ms.compute_color_by_function_per_vertex(x="10", y="255 * x", z="50")
    color = look(ms)[0]
    ms.apply_filter(DEFORM, graph_layers=False, **BEND)
    assert same_points(look(ms)[0], color)
    ms.set_current_mesh(0)
    tag_ends(ms)
    assert not same_points(look(ms)[0], color)
    ms.apply_filter(CLEAR)
    assert same_points(look(ms)[0], color)


def remeshing(name):
    """A filter that makes new vertices, with its parameters."""
    length = pymeshlab.PercentageValue if hasattr(pymeshlab, "PercentageValue") else pymeshlab.Percentage
    return {"subdivided": ("meshing_surface_subdivision_midpoint", dict(iterations=2, threshold=length(0))),
            "remeshed": ("meshing_isotropic_explicit_remeshing", dict(targetlen=length(3), iterations=3)),
            "clustered": ("meshing_decimation_clustering", dict(threshold=length(3)))}[name]


def scan_of_places():
    """The bone, its colours and quality a function of the place."""
    ms = clean_bone()
    ms.compute_color_by_function_per_vertex(x="255 * x", y="100", z="50")
    set_quality(ms, "rint(10 * x)")
    ms.compute_selection_by_condition_per_vertex(condselect="1 < 0")
    return ms


def off_by(ms):
    """How far colours and qualities of the current layer are from those of its places, as the worst twentieth is."""
    x, (color, quality) = ms.current_mesh().vertex_matrix()[:, 0], look(ms)
    return np.percentile(abs(color[:, 0] - x), 95), np.percentile(abs(quality - 10 * x), 95)


@pytest.mark.parametrize("change", ["subdivided", "remeshed", "clustered"])
@pytest.mark.parametrize("moved", [False, True])
def test_vertices_that_something_else_has_made_have_what_was_at_their_place(change, moved):
    name, parameters = remeshing(change)
    ms, untagged = scan_of_places(), scan_of_places()
    tag_ends(ms)
    for each in ms, untagged:
        if moved:
            each.apply_filter("compute_matrix_from_translation_rotation_scale", translationy=3.0, rotationx=30.0, scaley=2.0, scalez=2.0)
        each.apply_filter(name, **parameters)
    tags = look(ms)
    ms.compute_selection_by_condition_per_vertex(condselect="x < 0.25 || x > 0.75")
    ms.apply_filter(DEFORM, graph_layers=False, handles=1) # which moves nothing
    deformed = off_by(ms)
    ms.set_current_mesh(0)
    assert same_points(look(ms)[0], tags[0]) and same_points(look(ms)[1], tags[1])
    count = ms.current_mesh().vertex_number()
    result = ms.apply_filter(CLEAR)
    if moved and change != "subdivided": # nothing is left that would tell of the move
        assert result == {"other_vertices": count, "new_vertices": 0} and same_points(look(ms)[0], tags[0])
        return
    assert result["new_vertices"] > 0 and result["other_vertices"] < 0.02 * count
    color, quality = off_by(ms)
    assert color < 0.03 and quality < 1 and deformed[0] < 0.05
    assert color < off_by(untagged)[0] + 0.02


def test_new_vertices_of_a_posed_layer_keep_what_they_have():
    ms = scan_of_places()
    set_quality(ms, "1")
    known = {tuple(c) for c in look(ms)[0]}
    tag_ends(ms)
    ms.apply_filter(POSE, **BEND)
    before = ms.current_mesh().vertex_number()
    ms.apply_filter("meshing_surface_subdivision_midpoint", iterations=1)
    mixed = look(ms)[0]
    result = ms.apply_filter(CLEAR)
    assert result == {"other_vertices": ms.current_mesh().vertex_number() - before, "new_vertices": 0}
    back = np.array([tuple(c) in known for c in look(ms)[0]])
    assert back.sum() >= before and same_points(look(ms)[0][before:], mixed[before:])


def test_new_vertices_that_were_painted_keep_that():
    ms = scan_of_places()
    tag_ends(ms)
    ms.apply_filter("meshing_surface_subdivision_midpoint", iterations=1)
    ms.compute_selection_by_condition_per_vertex(condselect="x > 0.4 && x < 0.5")
    ms.compute_color_by_function_per_vertex(x="10", y="20", z="30", onselected=True)
    painted = ms.current_mesh().vertex_selection_array()
    assert ms.apply_filter(CLEAR)["other_vertices"] == painted.sum()
    assert (np.round(255 * look(ms)[0][painted, :3]) == [10, 20, 30]).all()
    assert np.abs(look(ms)[0][~painted, 0] - ms.current_mesh().vertex_matrix()[~painted, 0]).max() < 0.1


def test_what_is_painted_after_tagging_stays_and_all_else_comes_back():
    ms = coloured()
    set_quality(ms, "0")
    color = look(ms)[0]
    tag_ends(ms)
    ms.compute_selection_by_condition_per_vertex(condselect="x > 0.4 && x < 0.5")
    ms.compute_color_by_function_per_vertex(x="10", y="20", z="30", onselected=True)
    painted = ms.current_mesh().vertex_selection_array()
    expected = np.where(painted[:, None], look(ms)[0], color)
    tags = look(ms)[1]
    ms.apply_filter(DEFORM, graph_layers=False, **BEND)
    assert same_points(look(ms)[0], expected) and same_points(look(ms)[1], tags)
    ms.set_current_mesh(0)
    assert ms.apply_filter(CLEAR) == {"other_vertices": painted.sum(), "new_vertices": 0}
    assert same_points(look(ms)[0], expected) and not look(ms)[1].any()


@pytest.mark.parametrize("computed, stays", [("vi", True), ("rint(200 * x)", True), ("x < 0.5 ? 0 : (x > 0.7 ? 2 : 1)", False), ("x < 0.25 ? 0 : (x > 0.75 ? (y > 0 ? 3 : 2) : 1)", False)])
def test_a_quality_of_whole_numbers_that_is_no_tags_stays(computed, stays):
    ms = coloured()
    set_quality(ms, "x < 0.3 ? 5 : (x < 0.6 ? 1 : 4)")
    color, quality = look(ms)
    tag_ends(ms)
    set_quality(ms, computed)
    now = look(ms)[1]
    assert ms.apply_filter(CLEAR)["other_vertices"] == (len(now) if stays else 0)
    assert same_points(look(ms)[0], color) and same_points(look(ms)[1], now if stays else quality)


def test_what_lies_outside_has_its_quality_back_too():
    """Its tag is -1, which is a number as others are."""
    ms = coloured()
    set_quality(ms, "x < 0.3 ? 5 : (x < 0.6 ? 1 : 4)")
    color, quality = look(ms)
    tag_ends(ms)
    ms.compute_selection_by_condition_per_vertex(condselect="x > 0.4 && x < 0.5")
    ms.apply_filter(TAG, role=3)
    tag_ends(ms)
    assert (look(ms)[1] == -1).sum() > 50
    assert ms.apply_filter(CLEAR)["other_vertices"] == 0
    assert same_points(look(ms)[0], color) and same_points(look(ms)[1], quality)


def test_where_there_is_no_colour_none_is_left(tmp_path):
    def properties():
        ms.save_current_mesh(str(tmp_path / "mesh.ply"), binary=False)
        return (tmp_path / "mesh.ply").read_text().split("end_header")[0]

    ms = clean_bone()
    mesh = ms.current_mesh()
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(mesh.vertex_matrix(), mesh.face_matrix()))
    before = properties()
    tag_ends(ms)
    tagged = properties()
    ms.apply_filter(DEFORM, graph_layers=False, **BEND)
    if "red" not in before:
        assert "red" in tagged and "red" not in properties()
    ms.set_current_mesh(0)
    ms.apply_filter(CLEAR)
    assert ("red" in properties()) == ("red" in before)
    assert not look(ms)[1].any()


def test_a_handle_moves_as_another_layer_lies():
    ms = clean_bone()
    matrix = np.array([[0, -1, 0, 0.125], [1, 0, 0, -0.5], [0, 0, 1, 0.5], [0, 0, 0, 1.0]])
    mesh = ms.current_mesh()
    ms.add_mesh(pymeshlab.Mesh(mesh.vertex_matrix(), mesh.face_matrix()), "a copy in place")
    label = ms.current_mesh().label()
    ms.apply_filter("set_matrix", transformmatrix=matrix, freeze=False)
    points = []
    for text in (f"2: layer '{label}'", "2: matrix " + " ".join(map(str, matrix.ravel()))):
        ms.set_current_mesh(0)
        ms.apply_filter(DEFORM, graph_layers=False, transforms=text)
        points.append(ms.current_mesh().vertex_matrix())
    assert same_points(*points)
    ms.set_current_mesh(0)
    with pytest.raises(pymeshlab.PyMeshLabException, match="no layer has that name"):
        ms.apply_filter(DEFORM, transforms='2: layer "nobody"')
    with pytest.raises(pymeshlab.PyMeshLabException, match="'layer' without a name in quotes. Write layer 'NAME'"):
        ms.apply_filter(DEFORM, transforms="2: layer nobody")
    ms.add_mesh(pymeshlab.Mesh(mesh.vertex_matrix(), mesh.face_matrix()))
    ms.apply_filter("set_mesh_name", newname=label)
    ms.set_current_mesh(0)
    with pytest.raises(pymeshlab.PyMeshLabException, match="2 layers have that name"):
        ms.apply_filter(DEFORM, transforms=f"2: layer '{label}'")


# 90 degrees about z, and away; and what the layer that is deformed has itself: neither is the identity.
PLACED = np.array([[0, -1, 0, 0.125], [1, 0, 0, -0.5], [0, 0, 1, 0.5], [0, 0, 0, 1.0]])
IDENTITY = np.eye(4)
OWN = np.array([[0.8, 0, 0.6, 0.1], [0, 1, 0, 0.2], [-0.6, 0, 0.8, 0.3], [0, 0, 0, 1.0]])


def with_a_copy(matrix, own=OWN):
    """The bone, handle 3 beside handle 2, and a copy of it that lies elsewhere: (set, identifier of the copy)."""
    ms = clean_bone()
    set_quality(ms, "x < 0.25 ? 0 : (x > 0.9 ? 3 : (x > 0.75 ? 2 : 1))")
    mesh = ms.current_mesh()
    ms.apply_filter("set_matrix", transformmatrix=own, freeze=False)
    ms.add_mesh(pymeshlab.Mesh(mesh.vertex_matrix(), mesh.face_matrix()), "a copy in place")
    copy = ms.current_mesh_id()
    ms.apply_filter("set_matrix", transformmatrix=matrix, freeze=False)
    ms.set_current_mesh(0)
    return ms, copy


ON_TOP = dict(transformmatrix=np.diag([1.25, 1, 1, 1]), rotation_axis=np.array([1.0, 0, 0]), rotation_angle=-270.0,
              translation=np.array([0, 0, 0.25]))


@pytest.mark.parametrize("name", [DEFORM, POSE])
@pytest.mark.parametrize("other, steps", [({}, ""), (ON_TOP, " matrix 1.25 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 rotate 1 0 0 -270 translate 0 0 0.25")])
def test_the_layer_that_handles_move_like_is_a_parameter(name, other, steps):
    bits = []
    for both in True, False:
        ms, copy = with_a_copy(PLACED)
        step = f"layer 'a copy in place'{steps}"
        if both:  # handle 3 by the dialog
            ms.apply_filter(name, transforms=f"2: {step}", handle_layer=copy, pose=50.0, **other)
        else:
            ms.apply_filter(name, transforms=f"2: {step}; 3: {step}", pose=50.0)
        bits.append(ms.current_mesh().vertex_matrix())
    assert same_points(*bits)
    ms, _ = with_a_copy(PLACED)
    assert not same_points(bits[0], ms.current_mesh().vertex_matrix())


def test_the_handle_lies_where_the_layer_does():
    ms, copy = with_a_copy(PLACED)
    tags, placed = look(ms)[1], transformed(PLACED, ms.mesh(copy).vertex_matrix())
    ms.apply_filter(DEFORM, handle_layer=copy, graph_layers=False)
    world = transformed(OWN, ms.current_mesh().vertex_matrix())
    assert np.abs(world - placed)[tags >= 2].max() < 1e-12


def test_a_layer_that_lies_as_this_one_does_adds_nothing():
    ms, copy = with_a_copy(OWN)
    points = []
    for layer in 0, copy:
        ms.set_current_mesh(0)
        ms.apply_filter(DEFORM, handle_layer=layer, graph_layers=False, **ON_TOP)
        points.append(ms.current_mesh().vertex_matrix())
    assert np.abs(points[0] - points[1]).max() < 1e-12
    ms.set_current_mesh(0)  # the layer itself is the default
    ms.apply_filter(DEFORM, graph_layers=False, **ON_TOP)
    assert same_points(points[0], ms.current_mesh().vertex_matrix())


def test_the_motion_of_a_layer_is_saved(tmp_path):
    files = dict(tag_file=str(tmp_path / "t.sel"), transform_file=str(tmp_path / "t.def"))
    ms, copy = with_a_copy(PLACED, np.eye(4))
    ms.apply_filter(SAVE, handle_layer=copy, **files)
    points = []
    for parameters in dict(handle_layer=copy), dict(handles=3, **files):
        ms.set_current_mesh(0)
        ms.apply_filter(DEFORM, graph_layers=False, **parameters)
        points.append(ms.current_mesh().vertex_matrix())
    assert same_points(*points) and not same_points(points[0], ms.mesh(0).vertex_matrix())


@pytest.mark.parametrize("entry, value, word", [
    ((2, 2), 0, "cannot move like the layer 'a copy in place': A transform mirrors or flattens"),
    ((2, 2), -1, "cannot move like the layer 'a copy in place': A transform mirrors or flattens"),
    ((0, 3), np.inf, "The matrix of the layer 'a copy in place' holds a number that is not finite"),
    ((3, 0), 0.5, "The matrix of the layer 'a copy in place' is a projection"), (None, None, "'handle_layer' names no layer")])
def test_a_layer_that_no_handle_can_move_like_is_named(entry, value, word):
    matrix = np.eye(4)
    if entry:
        matrix[entry] = value
    ms, copy = with_a_copy(matrix)
    before = ms.current_mesh().vertex_matrix()
    for name in DEFORM, POSE:
        with pytest.raises(pymeshlab.PyMeshLabException, match=word):
            ms.apply_filter(name, handle_layer=copy if entry else 77)
        assert len(list(ms)) == 2 and same_points(ms.current_mesh().vertex_matrix(), before)


def saved(ms, folder, kind):
    """The layers as PLY, and the project that names these, opened again."""
    for mesh in list(ms):
        ms.set_current_mesh(mesh.id())
        ms.save_current_mesh(str(folder / f"{mesh.id()}.ply"))
    ms.save_project(str(folder / f"project.{kind}"))
    again = new_set()
    again.load_project(str(folder / f"project.{kind}"))
    return again


@pytest.mark.parametrize("kind", ["mlp", "mlb"])
@pytest.mark.parametrize("own", [IDENTITY, OWN + np.pi * np.eye(4, k=3)], ids=["in place", "placed"])
def test_what_a_project_keeps(tmp_path, kind, own):
    ms = coloured()
    set_quality(ms, "0")
    color = look(ms)[0]
    ms.apply_filter("set_matrix", transformmatrix=own, freeze=False)
    tag_ends(ms)
    ms.apply_filter(DEFORM, **BEND)
    again = saved(ms, tmp_path, kind)
    assert [mesh.label() for mesh in again] == [mesh.label() for mesh in ms]
    for mesh, before in zip(again, ms):
        assert same_points(mesh.vertex_matrix(), before.vertex_matrix())
        assert same_points(mesh.vertex_scalar_array(), before.vertex_scalar_array())
        assert same_points(mesh.vertex_color_matrix(), before.vertex_color_matrix())
    exact = kind == "mlb" or own is IDENTITY  # the text has six digits of a matrix
    assert np.abs(matrix(again.mesh(0)) - own).max() == 0 if exact else 0 < np.abs(matrix(again.mesh(0)) - own).max() < 1e-5
    for parameters in {}, dict(use_graph_layer=True, graph_layer=1):
        again.set_current_mesh(0)
        again.apply_filter(DEFORM, graph_layers=False, **parameters, **BEND)
        result, before = again.current_mesh().vertex_matrix(), ms.mesh(3).vertex_matrix()
        assert same_points(result, before) if exact else np.abs(result - before).max() < 1e-5
    # Edges and attributes are gone, and with these the colours of before the tags and the deformation that the graph holds.
    assert [mesh.edge_number() for mesh in again][:3] == [0, 0, 0]
    again.set_current_mesh(0)
    assert not same_points(look(again)[0], color)
    for name, parameters, word in ((CLEAR, {}, "there is nothing to bring back"), (RESET, {}, "has not been posed in place"),
                                   (COPY, dict(source_layer=0, rest_graph=1, deformed_graph=2), "layers that are saved and loaded lose it")):
        with pytest.raises(pymeshlab.PyMeshLabException, match=word):
            again.apply_filter(name, **parameters)


def test_the_graph_is_also_to_be_had_as_a_surface():
    ms = clean_bone()
    result = ms.apply_filter(GRAPH, surface_layer=True)
    meshes = {mesh.label(): mesh for mesh in ms}
    surface = next(mesh for label, mesh in meshes.items() if label.endswith("graph surface"))
    nodes, edges = result["patches"], result["edges"]
    assert surface.vertex_number() == 8 * (2 * edges + 7 * nodes)
    assert surface.face_number() == 16 * (edges + 6 * nodes)
    box = ms.current_mesh().bounding_box()
    assert (surface.vertex_matrix() > box.min() - 0.1 * box.diagonal()).all()
    assert (surface.vertex_matrix() < box.max() + 0.1 * box.diagonal()).all()
    normals = surface.vertex_normal_matrix()
    assert np.isfinite(normals).all()


def test_faces_have_the_colour_of_one_patch():
    ms = clean_bone()
    ms.apply_filter(GRAPH)
    patches = next(mesh for mesh in ms if mesh.label().endswith("patches"))
    corner, patch = patches.vertex_color_matrix()[patches.face_matrix()], patches.vertex_scalar_array()[patches.face_matrix()]
    color = patches.face_color_matrix()
    for k in range(3):
        both = patch[:, k] == patch[:, (k + 1) % 3]
        assert same_points(color[both], corner[both, k])
    assert (color[:, None] == corner).all(2).any(1).all()


def deleted(ms):
    if list(ms):
        ms.delete_current_mesh()
    return ms


def cleared(ms):
    ms.clear()
    return ms


@pytest.mark.parametrize("close", [deleted, cleared])
def test_a_closed_layer_leaves_no_memory(close):
    """What the filters keep of a layer that is tagged and posed, 130 bytes a vertex, goes with it."""
    points = np.random.default_rng(0).random((20000, 3)) * [1, 1, 0.01]  # a sheet has fewer neighbours than a block
    sizes, ms = [], new_set()
    for _ in range(25):
        ms = close(ms)
        ms.add_mesh(pymeshlab.Mesh(vertex_matrix=points, v_normals_matrix=points))
        ms.apply_filter("compute_selection_by_condition_per_vertex", condselect="x < 0.1")
        ms.apply_filter(TAG, role=0)
        ms.apply_filter("compute_selection_by_condition_per_vertex", condselect="x > 0.9")
        ms.apply_filter(TAG, role=2)
        ms.apply_filter(POSE, transforms="2: translate 0 0 0.05")
        sizes.append(allocated())
    assert sizes[-1] - sizes[9] < 0.2 * 15 * 130 * len(points)  # of what would be left


@pytest.mark.parametrize("name", ["fcd_rest", "fcd_rest_normal", "fcd_posed_2", "fcd_posed_layer_3", "fcd_marks_1", "fcd_tagged_2", "fcd_scan_1"])
def test_attributes_of_the_user_are_his_whatever_they_are_called(name):
    ms = coloured()
    set_quality(ms, "0")
    mesh = ms.current_mesh()
    mesh.add_vertex_custom_scalar_attribute(np.arange(float(mesh.vertex_number())), name)
    has_points = hasattr(ms, "mesh_number")  # 2022.2 ends when one adds such an attribute
    if has_points:
        mesh.add_vertex_custom_point_attribute(mesh.vertex_matrix(), name + "_")
    rest = mesh.vertex_matrix()
    tag_ends(ms)
    ms.apply_filter(POSE, **BEND)
    ms.apply_filter(RESET)
    ms.apply_filter(CLEAR)
    assert same_points(mesh.vertex_matrix(), rest)
    assert np.array_equal(mesh.vertex_custom_scalar_attribute_array(name), np.arange(float(mesh.vertex_number())))
    if has_points:
        assert same_points(mesh.vertex_custom_point_attribute_matrix(name + "_"), rest)


def test_a_filter_that_takes_the_first_attribute_does_not_take_what_is_kept():
    ms = coloured()
    name = "apply_coord_directional_preservation"
    if name not in pymeshlab.filter_list():
        pytest.skip(f"no {name} in this pymeshlab")
    set_quality(ms, "0")
    tag_ends(ms)
    ms.apply_filter(POSE, **BEND)
    posed = ms.current_mesh().vertex_matrix()
    with pytest.raises(pymeshlab.PyMeshLabException, match='point attribute called ""'):
        ms.apply_filter(name)
    assert same_points(ms.current_mesh().vertex_matrix(), posed)


def split_at(ms):
    ms.compute_selection_by_condition_per_face(condselect="x0 > 0.4")
    ms.generate_from_selected_faces()
    return 1


def duplicate(ms):
    ms.generate_copy_of_current_mesh()
    return ms.current_mesh().id()


def merge(ms):
    ms.create_cube()
    ms.generate_by_merging_visible_meshes(mergevertices=False)
    return ms.current_mesh().id()


@pytest.mark.parametrize("pose", [False, True], ids=["", "posed"])
@pytest.mark.parametrize("by", [split_at, duplicate, merge])
@pytest.mark.parametrize("first", ["", "cleared", "deleted"])
def test_what_a_host_makes_of_tagged_layers_has_their_own_colours_back(by, first, pose):
    """Also where the tagged layer is cleared, or gone, by then."""
    ms = coloured()
    set_quality(ms, "x < 0.3 ? 5 : (x < 0.6 ? 1 : 4)")
    own = {tuple(p): (tuple(c), q) for p, c, q in zip(ms.current_mesh().vertex_matrix(), *look(ms))}
    where = {tuple(p): tuple(p) for p in ms.current_mesh().vertex_matrix()}
    tag_ends(ms)
    if pose:
        before = ms.current_mesh().vertex_matrix()
        ms.apply_filter(POSE, **BEND)
        where = {tuple(b): tuple(a) for a, b in zip(before, ms.current_mesh().vertex_matrix())}
    made = by(ms)
    if first and any(mesh.id() == 0 for mesh in ms):
        ms.set_current_mesh(0)
        ms.apply_filter(CLEAR) if first == "cleared" else ms.delete_current_mesh()
    ms.set_current_mesh(made)
    colors = look(ms)[0]
    ms.apply_filter(CLEAR)
    mesh = ms.current_mesh()
    known = 0
    for p, c, q, tagged in zip(mesh.vertex_matrix(), *look(ms), colors):
        if tuple(p) in where:
            assert (tuple(c), q) == own[where[tuple(p)]]
            known += 1
        else:
            assert np.array_equal(c, tagged)  # of the cube
    assert known > 100


@pytest.mark.parametrize("now", ["x + 0.125", "0", "x < 0.5 ? 3 : 1"])
def test_written_tags_count_whatever_the_quality_is_now(now):
    ms, other = coloured(), coloured()
    for each in ms, other:
        set_quality(each, "0")
        tag_ends(each)
    tags = look(ms)[1]
    set_quality(ms, now)
    quality = look(ms)[1]
    if now != "x < 0.5 ? 3 : 1":  # which may be tags that are meant
        with pytest.raises(pymeshlab.PyMeshLabException, match="is not what 'FCD: Tag' wrote: .*choose 'Tags of the layer' .4. as 'handles'"):
            ms.apply_filter(DEFORM, graph_layers=False, **BEND)
    result = ms.apply_filter(DEFORM, graph_layers=False, handles=4, **BEND)
    assert (result["fixed_vertices"], result["handle_vertices"]) == ((tags == 0).sum(), (tags == 2).sum())
    other.apply_filter(DEFORM, graph_layers=False, **BEND)
    assert same_points(ms.current_mesh().vertex_matrix(), other.current_mesh().vertex_matrix())
    ms.set_current_mesh(0)
    assert same_points(look(ms)[1], quality)
    ms.apply_filter("meshing_surface_subdivision_midpoint", iterations=1)  # new vertices are free
    result = ms.apply_filter(DEFORM, graph_layers=False, handles=4, **BEND)
    assert (result["fixed_vertices"], result["handle_vertices"]) == ((tags == 0).sum(), (tags == 2).sum())
    ms.set_current_mesh(0)
    ms.apply_filter(CLEAR)
    with pytest.raises(pymeshlab.PyMeshLabException, match="no vertex has a tag of 2 or more"):
        ms.apply_filter(DEFORM, graph_layers=False, handles=4, **BEND)


def test_a_quality_that_is_taken_for_tags_is_told(capfd):
    """Labels, or what a scanner writes, are whole numbers, too."""
    def log_of(ms):
        ms.compute_selection_by_condition_per_vertex(condselect="x < 0.25")
        ms.set_verbosity(True)
        capfd.readouterr()
        ms.apply_filter(TAG, role=0)
        return capfd.readouterr().err

    told = "counts as tags, since its numbers are whole: {} vertices are not free. If it is something else (a label, a measure), run 'FCD: Clear Tags'"
    ms = clean_bone()
    set_quality(ms, "751")
    assert told.format(ms.current_mesh().vertex_number()) in log_of(ms)
    assert "counts as tags" not in log_of(ms), "now they are known to be tags"
    for free in "01":
        ms = clean_bone()
        set_quality(ms, free)
        assert "counts as tags" not in log_of(ms)


@pytest.mark.parametrize("copied", ["generate_copy_of_current_mesh", "generate_by_merging_visible_meshes", "generate_from_selected_faces", "save"])
def test_a_copy_has_the_tags_that_were_written(tmp_path, copied):
    ms = coloured()
    set_quality(ms, "0")
    tag_ends(ms)
    tags = look(ms)[1]
    if copied == "save":
        ms.save_current_mesh(str(tmp_path / "copy.ply"))
        ms.load_new_mesh(str(tmp_path / "copy.ply"))
    else:
        ms.apply_filter("set_selection_all")
        ms.apply_filter(copied)
    copy = ms.current_mesh_id()
    for now in ("", "x + 0.125"):  # once it is known
        ms.set_current_mesh(copy)
        if now:
            set_quality(ms, now)
        result = ms.apply_filter(DEFORM, graph_layers=False, handles=4, **BEND)
        assert (result["fixed_vertices"], result["handle_vertices"]) == ((tags == 0).sum(), (tags == 2).sum())
