# SPDX-License-Identifier: GPL-3.0-or-later
"""Straightening a layer along a line, inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import numpy as np
import pymeshlab
import pytest

from host_pymeshlab import COPY, SURFACE_RETURNS, assert_unchanged, check_returned, new_set, same_points, snapshot
from straight_tube import LENGTH, RADIUS, bent, tube

STRAIGHTEN, SAVE = "generate_fcd_straightened_mesh", "save_fcd_deformation"
DEFAULTS = {
    "line_layer": 0, "line_file": "", "line_smoothing": 0, "middle": False, "to": 0, "angle": 90, "direction": [0, 0, 0], "towards": [0, 0, 0],
    "target_layer": 0, "reverse": False, "length": 0, "untwist": False, "initial_patches": 1000, "smoothness": 0.0058, "random_seed": 1,
    "graph_layers": True, "straightened_quality": 0}
RETURNS = {
    **SURFACE_RETURNS, "length": float, "new_length": float, "jitter": float, "middle_left": bool, "lengthening": float, "twist": float, "following_nodes": int, "released_nodes": int, "rms": float,
    "largest": float, "folded_triangles": int, "contact_triangles": int, "contact_depth": float, "nodes": int, "converged": bool, "seconds": float}
DIAGONAL = np.sqrt(LENGTH ** 2 + 8 * RADIUS ** 2)


def axis(count=9, off=(0, 0)):
    return np.stack([np.linspace(0, LENGTH, count), np.full(count, off[0]), np.full(count, off[1])], 1)


def polyline(points, order=None):
    """A layer with edges."""
    order = np.arange(len(points)) if order is None else np.asarray(order)
    return pymeshlab.Mesh(vertex_matrix=points, edge_matrix=np.stack([order[:-1], order[1:]], 1).astype(np.int32))


def rms_apart(points, truth):
    """After the best rigid motion, in percent of the diagonal."""
    a, b = points - points.mean(0), truth - truth.mean(0)
    u, _, v = np.linalg.svd(a.T @ b)
    turn = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    return 100 * np.sqrt(((a @ turn - b) ** 2).sum(1).mean()) / DIAGONAL


def layers(points, line=None):
    """A set with the tube as its current layer, and with the line as layer 0 where there is one."""
    ms = new_set()
    if line is not None:
        ms.add_mesh(line, "line")
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=points, face_matrix=tube()[1]), "tube")
    return ms


def line_file(path, points):
    if path.suffix == ".pp":
        path.write_text("<!DOCTYPE PickedPoints>\n<PickedPoints>\n" + "\n".join(
            f'<point x="{x!r}" y="{y!r}" z="{z!r}" active="1" name="{i}"/>' for i, (x, y, z) in enumerate(points.tolist())) + "\n</PickedPoints>\n")
    else:
        path.write_text("x, y, z\n" + "\n".join(", ".join(map(repr, p)) for p in points.tolist()) + "\n")
    return str(path)


def straighten(ms, **parameters):
    """(returned values, positions of the result)"""
    result = ms.apply_filter(STRAIGHTEN, **parameters)
    return result, ms.current_mesh().vertex_matrix()


def straighten_logged(ms, capfd, **parameters):
    """(returned values, log). After an error in any filter pymeshlab logs no more, hence these tests come first."""
    ms.set_verbosity(True)
    capfd.readouterr()
    result = straighten(ms, **parameters)[0]
    return result, capfd.readouterr().err


def test_what_is_done_is_logged(capfd, tmp_path):
    ms = layers(bent(tube()[0]), polyline(bent(axis())))
    result, log = straighten_logged(ms, capfd, line_layer=0)
    assert "The line is 10" in log and "nodes go with it" in log and "would fold" not in log and "twist" not in log
    oval = tube()[0] * [1, 1, 0.5]
    ms = layers(oval, polyline(axis()))
    assert "A twist of" in straighten_logged(ms, capfd, line_layer=0, untwist=True)[1]


def test_jitter_and_a_middle_that_is_left_are_logged(capfd, tmp_path):
    line = axis(200)[1:-1]
    clicked = bent(line) + np.random.default_rng(1).normal(0, 0.04, line.shape)
    ms = layers(bent(tube()[0]))
    result, log = straighten_logged(ms, capfd, line_file=line_file(tmp_path / "l.csv", clicked))
    assert "The points of the line jitter by 0.0" in log and result["jitter"] == pytest.approx(0.04, rel=0.2)
    assert result["length"] == pytest.approx(LENGTH, rel=0.02) and not result["middle_left"]
    points, faces = tube(301, 48)
    points[:, 1:] /= 2
    points[:, 2] += np.where(points[:, 2] > 0.28, 3 * np.exp(-((points[:, 0] - 6) / 0.6) ** 2), 0)  # a fin
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=bent(points), face_matrix=faces), "finned")
    result, log = straighten_logged(ms, capfd, line_file=line_file(tmp_path / "l.csv", bent(axis())), middle=True)
    assert result["middle_left"] and "through the middles of the cross-sections it would stretch the surface more" in log


@pytest.mark.parametrize("off, middle, is_beside", [((0, RADIUS), False, False), ((RADIUS, 0), False, True), ((RADIUS, 0), True, False)])
def test_a_line_to_one_side_is_warned_of(capfd, tmp_path, off, middle, is_beside):
    picked = line_file(tmp_path / "l.csv", bent(axis(off=off)))  # only the first number is across the bend
    result, log = straighten_logged(layers(bent(tube()[0])), capfd, line_file=picked, middle=middle)
    assert ("The line lies to one side of the surface" in log) == is_beside
    assert ("The line through the middles of the cross-sections is" in log) == middle
    assert result["lengthening"] > 0.1 if is_beside else result["lengthening"] < 0.01


def test_folds_are_warned_of(capfd, tmp_path):
    """A thick tube laid round a corner, and the way back from there."""
    ms = layers(tube()[0] * [1, 2.5, 2.5], polyline(np.array([[0, 0, 0], [3, 0, 0], [4, 0, 0], [4.05, 0.05, 0], [4.05, 0.5, 0], [4.05, 5, 0.0]])))
    result, log = straighten_logged(ms, capfd, line_file=line_file(tmp_path / "l.csv", axis()), to=2, target_layer=0)
    assert result["released_nodes"] > 0 and "Beside the line at " in log and "with the line would fold it" in log
    assert result["folded_triangles"] > 0 and "flipped: the surface is folded there" in log
    saved = ms.apply_filter(SAVE, deformation_file=str(tmp_path / "back.ply"), inverse=True, source_layer=1, rest_graph=2, deformed_graph=3)
    assert saved["folded_vertices"] > 0 and "these have no way back" in capfd.readouterr().err


def test_parameters_names_order_and_defaults():
    assert STRAIGHTEN in pymeshlab.filter_list()
    ms = layers(tube()[0], polyline(axis()))
    values = ms.filter_parameter_values(STRAIGHTEN)
    assert list(values) == list(DEFAULTS)
    for key, value in {**DEFAULTS, "target_layer": 1}.items():  # the only layer with edges is the line
        if isinstance(value, (str, bool)):
            assert values[key] == value and type(values[key]) is type(value), key
        else:
            assert np.allclose(values[key], value, rtol=1e-6, atol=0), key


@pytest.mark.parametrize("kind", ["layer", "layer in disorder", "pp", "csv", "txt"])
def test_a_bent_tube_becomes_straight(tmp_path, kind):
    points, line = bent(tube()[0]), bent(axis())
    order = np.array([4, 0, 7, 2, 8, 1, 5, 3, 6])
    mesh = polyline(line) if kind == "layer" else polyline(line[np.argsort(order)], order) if "disorder" in kind else None
    ms = layers(points, mesh)
    before = [snapshot(each) for each in ms]
    given = {"line_layer": 0} if mesh else {"line_file": line_file(tmp_path / f"line.{kind}", line)}
    result, straight = straighten(ms, **given)
    check_returned(result, RETURNS)
    assert rms_apart(straight, tube()[0]) < 0.05 and rms_apart(points, tube()[0]) > 5
    assert result["length"] == result["new_length"] == pytest.approx(LENGTH, rel=1e-3)
    assert result["released_nodes"] == 0 and result["folded_triangles"] == 0 and result["rms"] <= result["largest"] < 0.005 * DIAGONAL
    assert [each.label() for each in ms][-4:] == ["tube", "tube graph", "tube deformed graph", "tube straightened"]
    for each, mesh in zip(before, ms):
        assert_unchanged(each, mesh)
    other = layers(points)
    assert same_points(straight, straighten(other, line_file=line_file(tmp_path / "again.csv", line), graph_layers=False)[1]) or "layer" in kind
    assert [each.label() for each in other] == ["tube", "tube straightened"]


def test_the_middle_of_a_line_on_the_surface(tmp_path):
    ms = layers(bent(tube()[0]))
    on_surface = line_file(tmp_path / "line.pp", bent(axis(off=(-RADIUS, 0))))
    result, outer = straighten(ms, line_file=on_surface)
    assert result["length"] == pytest.approx(LENGTH + RADIUS * np.radians(120), rel=0.01)
    ms.set_current_mesh(0)
    result, points = straighten(ms, line_file=on_surface, middle=True)
    assert result["length"] == pytest.approx(LENGTH, rel=0.01) and rms_apart(points, tube()[0]) < 0.3 < rms_apart(outer, tube()[0])


def test_arcs_and_lengths(tmp_path):
    ms = layers(tube()[0])
    given = {"line_file": line_file(tmp_path / "line.csv", axis()), "graph_layers": False}
    points = straighten(ms, to=1, angle=120, towards=np.array([0, 1, 0.0]), **given)[1]
    assert rms_apart(points, bent(tube()[0])) < 0.05 and points[:, 1].max() > 2
    ms.set_current_mesh(0)
    points = straighten(ms, to=1, angle=-120, towards=np.array([0, 1, 0.0]), **given)[1]
    assert points[:, 1].min() < -2
    ms.set_current_mesh(0)
    result, points = straighten(ms, length=25, direction=np.array([0, 0, 3.0]), **given)
    assert np.ptp(points[:, 2]) == pytest.approx(25, abs=1e-6) and result["new_length"] == 25
    ms.set_current_mesh(0)
    assert same_points(straighten(ms, **given)[1], tube()[0])  # it is straight already


def test_along_the_line_of_a_layer_and_matrices(tmp_path):
    placed = np.array([[0, -2, 0, 7.0], [2, 0, 0, -5.0], [0, 0, 2, 3.0], [0, 0, 0, 1.0]])
    ms = layers(tube()[0], polyline(bent(axis())))
    for i in (0, 1):
        ms.set_current_mesh(i)
        ms.apply_filter("set_matrix", transformmatrix=placed, freeze=False)
    line = np.c_[axis(), np.ones(9)] @ placed.T
    file = line_file(tmp_path / "line.csv", line[:, :3])
    result, points = straighten(ms, line_file=file, to=2, target_layer=0)
    assert result["length"] == pytest.approx(2 * LENGTH) and rms_apart(points, bent(tube()[0])) < 0.05
    begin = np.abs(tube()[0][:, 0]) < 1e-9
    assert np.abs(points[begin].mean(0)).max() < 0.01
    ms.set_current_mesh(1)
    points = straighten(ms, line_file=file, to=2, target_layer=0, reverse=True)[1]
    assert np.abs(points[begin].mean(0) - bent(axis())[-1]).max() < 0.01


def test_the_place_along_the_line_as_quality():
    ms = layers(bent(tube()[0]), polyline(bent(axis())))
    straighten(ms, line_layer=0, straightened_quality=1)
    assert np.abs(ms.current_mesh().vertex_scalar_array() - tube()[0][:, 0]).max() < 0.05


def test_the_way_there_and_back(tmp_path):
    """Saved, it carries the layer to where the filter took it, and back."""
    points = bent(tube()[0])
    ms = layers(points, polyline(bent(axis())))
    straight = straighten(ms, line_layer=0)[1]
    layer = {"source_layer": 1, "rest_graph": 2, "deformed_graph": 3}
    there, back = str(tmp_path / "there.ply"), str(tmp_path / "back.ply")
    assert ms.apply_filter(SAVE, deformation_file=there, **layer)["folded_vertices"] == 0
    saved = ms.apply_filter(SAVE, deformation_file=back, inverse=True, **layer)
    assert saved["folded_vertices"] == 0 and saved["largest_difference"] < 1e-3 * DIAGONAL
    ms.set_current_mesh(1)
    ms.apply_filter(COPY, deformation_file=there)
    assert np.linalg.norm(ms.current_mesh().vertex_matrix() - straight, axis=1).max() < 1e-3 * DIAGONAL
    ms.apply_filter(COPY, deformation_file=back)
    assert np.linalg.norm(ms.current_mesh().vertex_matrix() - points, axis=1).max() < 1e-3 * DIAGONAL


ERRORS = {
    "no line": ({}, None, "There is no line"),
    "no edges": ({"line_layer": 0}, pymeshlab.Mesh(vertex_matrix=axis()), "has no edges"),
    "branch": ({"line_layer": 0}, polyline(axis(), [0, 1, 2, 3, 1]), "has a branch at vertex 1"),
    "ring": ({"line_layer": 0}, polyline(axis(), [0, 1, 2, 0]), "is closed: its edges form a ring"),
    "several": ({"line_layer": 0}, pymeshlab.Mesh(vertex_matrix=axis(), edge_matrix=np.array([[0, 1], [2, 3]], np.int32)), "has several separate lines"),
    "outside": ({"line_layer": 0}, polyline(axis() + [0, 50, 0]), "The line is outside of the surface"),
    "no target": ({"line_layer": 0, "to": 2}, polyline(axis()), "as 'target_layer'"),
    "360": ({"line_layer": 0, "to": 1, "angle": 360}, polyline(axis()), "less than 360 degrees"),
    "length": ({"line_layer": 0, "length": -1}, polyline(axis()), "must be a positive number"),
    "smoothing": ({"line_layer": 0, "line_smoothing": 30}, polyline(axis()), "0 to 25 percent"),
    "round": ({"line_layer": 0, "untwist": True}, polyline(axis()), "nearly round"),
    "empty file": ({"line_file": "# nothing\n"}, None, "holds no points"),
    "two numbers": ({"line_file": "1 2\n"}, None, "line.txt', line 1: found 2 numbers"),
    "one point": ({"line_file": "1 2 3\n"}, None, "has one point only"),
    "doubled": ({"line_file": "0 0 0\n5 0 0\n5 0 0\n9 0 0\n"}, None, "Points 2 and 3 of the line are at one place"),
    "no extent": ({"line_file": "1 0 0\n1 0 0\n"}, None, "has no extent"),
    "closed": ({"line_file": "0 0 0\n5 0 0\n5 1 0\n0 0 0\n"}, None, "The line is closed"),
}


@pytest.mark.parametrize("name", ERRORS)
def test_errors_change_nothing(tmp_path, name):
    parameters, line, message = ERRORS[name]
    if "line_file" in parameters:
        (tmp_path / "line.txt").write_text(parameters["line_file"])
        parameters = {"line_file": str(tmp_path / "line.txt")}
    ms = layers(tube()[0], line)
    before = [snapshot(each) for each in ms]
    with pytest.raises(pymeshlab.PyMeshLabException, match=message):
        straighten(ms, **({"line_layer": ms.current_mesh_id()} if line is None else {"target_layer": 1}), **parameters)
    assert len(before) == len(ms) and ms.current_mesh().label() == "tube"
    for each, mesh in zip(before, ms):
        assert_unchanged(each, mesh)


def test_an_empty_list_of_picked_points(tmp_path):
    ms = layers(tube()[0])
    with pytest.raises(pymeshlab.PyMeshLabException, match="has no point"):
        straighten(ms, line_file=line_file(tmp_path / "none.pp", np.zeros((0, 3))))
