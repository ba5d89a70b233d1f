# SPDX-License-Identifier: GPL-3.0-or-later
"""What tagging leaves of a layer, inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import numpy as np
import pymeshlab
import pytest

from host_pymeshlab import DEFORM, TAG, clean_bone, same_points, set_quality

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
