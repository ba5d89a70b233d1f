# SPDX-License-Identifier: GPL-3.0-or-later
"""Straightening, and bending along a line."""
import warnings

import numpy as np
import pytest

import pymeshlab_fcd
from pymeshlab_fcd import Deformation, DeformationWarning, Pose, Straightened, straighten
from shapes import same, with_filters
from straight_tube import LENGTH, RADIUS, bent, tube

AXIS = np.stack([np.linspace(0, LENGTH, 9), np.zeros(9), np.zeros(9)], 1)
CORNER = np.array([[0, 0, 0], [3, 0, 0], [4, 0, 0], [4.05, 0.05, 0], [4.05, 0.5, 0], [4.05, 5, 0.0]])


def rms_apart(points, truth):
    """After the best rigid motion."""
    a, b = points - points.mean(0), truth - truth.mean(0)
    u, _, v = np.linalg.svd(a.T @ b)
    turn = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    return np.sqrt(((a @ turn - b) ** 2).sum(1).mean())


def test_a_bent_tube_becomes_straight():
    vertices, faces = tube()
    made = straighten(bent(vertices), faces, bent(AXIS))
    assert isinstance(made, Straightened) and isinstance(made, Pose)
    assert repr(made) == f"<Straightened of {len(vertices)} vertices, along {made.line.length:g} to {made.line.new_length:g}>"
    assert rms_apart(made.vertices, vertices) < 1e-3 * LENGTH
    assert made.line.length == made.line.new_length == pytest.approx(LENGTH, rel=1e-3)
    assert made.line.released == 0 and made.line.released_at == [] and made.line.rms < made.line.largest < 5e-3 * LENGTH
    assert made.info.folded == 0 and 0.5 < made.stretch().min() < made.stretch().max() < 1.5
    assert np.allclose(np.linalg.norm(made.normals, axis=1), 1)
    inside = made.map(bent(AXIS))
    assert rms_apart(inside, AXIS) < 0.01 * LENGTH
    again = straighten(bent(vertices), faces, bent(AXIS), threads=1)
    assert same(again.vertices, made.vertices)
    cloud = straighten(bent(vertices), None, bent(AXIS))
    assert rms_apart(cloud.vertices, vertices) < 2e-3 * LENGTH


def test_there_and_back():
    vertices, faces = tube()
    made = straighten(vertices, faces, AXIS, degrees=120, towards=[0, 1, 0])
    assert rms_apart(made.vertices, bent(vertices)) < 1e-3 * LENGTH
    back = made.deformation(inverse=True)
    assert isinstance(back, Deformation) and back.largest_difference < 1e-3 * LENGTH
    assert np.linalg.norm(back(made.vertices) - vertices, axis=1).max() < 1e-3 * LENGTH
    inside = AXIS[1:-1]  # at its ends, the open tube tells less of what is in it
    assert np.linalg.norm(back(made.deformation()(inside)) - inside, axis=1).max() < 1e-3 * LENGTH
    assert Deformation(back._field.content()) == back


def test_middle_twist_length_and_target():
    vertices, faces = tube()
    beside = AXIS + [0, -RADIUS, 0]
    with pytest.warns(DeformationWarning, match="The line lies to one side of the surface"):
        given = straighten(bent(vertices), faces, bent(beside)).line
    assert given.is_beside and given.lengthening > 0.1
    assert given.length == pytest.approx(LENGTH + RADIUS * np.radians(120), rel=0.01)
    made = straighten(bent(vertices), faces, bent(beside), middle=True).line
    assert made.length == pytest.approx(LENGTH, rel=0.01) and not made.is_beside and made.lengthening < 0.01
    angle = 2 * vertices[:, :1] / LENGTH
    oval = vertices * [1, 1, 0.5]
    twisted = np.concatenate([oval[:, :1], np.cos(angle) * oval[:, 1:2] - np.sin(angle) * oval[:, 2:],
                              np.sin(angle) * oval[:, 1:2] + np.cos(angle) * oval[:, 2:]], 1)
    untwisted = straighten(twisted, faces, AXIS, untwist=True)
    assert untwisted.line.twist == pytest.approx(np.degrees(2), abs=6) and rms_apart(untwisted.vertices, oval) < 0.05
    longer = straighten(vertices, faces, AXIS, length=20, direction=[0, 0, 5])
    assert np.ptp(longer.vertices[:, 2]) == pytest.approx(20, abs=1e-6) and longer.line.new_length == 20
    along = straighten(vertices, faces, AXIS, bent(AXIS) + [5, 6, 7])
    assert np.abs(along.vertices - bent(vertices) - [5, 6, 7]).max() < 0.05 or rms_apart(along.vertices, bent(vertices)) < 1e-3 * LENGTH
    assert same(straighten(vertices, faces, AXIS).vertices, vertices)  # it is straight already


def test_meshes_of_other_libraries():
    trimesh = pytest.importorskip("trimesh")
    vertices, faces = tube()
    mesh = trimesh.Trimesh(bent(vertices), faces, process=False)
    made = straighten(mesh, None, bent(AXIS))
    assert rms_apart(np.asarray(made.mesh().vertices), vertices) < 1e-3 * LENGTH
    onto = straighten(bent(vertices), faces, bent(AXIS), AXIS)
    for call, expected in ((lambda: straighten(mesh, bent(AXIS)), made), (lambda: straighten(mesh, line=bent(AXIS)), made),
                           (lambda: straighten(mesh, bent(AXIS), AXIS), onto), (lambda: straighten(mesh, None, bent(AXIS), AXIS), onto),
                           (lambda: straighten(mesh, bent(AXIS).tolist(), target=AXIS), onto)):
        assert same(call().vertices, expected.vertices)
    with pytest.raises(TypeError, match="faces cannot be given beside a mesh"):
        straighten(mesh, faces, AXIS)


@pytest.mark.parametrize("count", [9, 14, 30, 90, 250])
def test_clicking_more_points_makes_it_no_longer(count):
    vertices, faces = tube()
    jitter = 0.04
    points = np.stack([np.linspace(0.1, LENGTH - 0.1, count), np.zeros(count), np.zeros(count)], 1)
    made = straighten(bent(vertices), faces, bent(points) + np.random.default_rng(count).normal(0, jitter, (count, 3)))
    assert made.line.length == pytest.approx(LENGTH - 0.2, abs=4 * jitter)
    assert rms_apart(made.vertices, vertices) < 2 * jitter
    assert not made.line.jitter or made.line.jitter == pytest.approx(jitter, rel=0.5)
    assert (count < 30 or made.line.jitter) and not made.line.is_middle and not made.line.left_middle


def test_a_middle_that_stretches_more_is_left():
    vertices, faces = tube(301, 48, 0.3)
    vertices[:, 2] += np.where(vertices[:, 2] > 0.28, 3 * np.exp(-((vertices[:, 0] - 6) / 0.6) ** 2), 0)  # a fin
    given = straighten(bent(vertices), faces, bent(AXIS))
    with pytest.warns(DeformationWarning, match="through the middles of the cross-sections it would stretch the surface more"):
        made = straighten(bent(vertices), faces, bent(AXIS), middle=True)
    assert made.line.left_middle and not made.line.is_middle and not given.line.left_middle and same(made.vertices, given.vertices)


def test_progress_goes_on():
    told = []
    vertices, faces = tube()
    straighten(bent(vertices), faces, bent(AXIS), progress=lambda percent, stage: told.append(percent))
    assert told == sorted(told) and told[-1] == 100 and len(told) > 5


def test_folds_are_warned_of():
    vertices, faces = tube(radius=1.5)
    with pytest.warns(DeformationWarning) as caught:
        made = straighten(vertices, faces, AXIS, CORNER)
    texts = [str(each.message) for each in caught]
    assert any("with the line would fold it" in text for text in texts) and any("flipped" in text for text in texts)
    assert made.line.released > 0 and 0 <= made.line.released_at[0][0] < made.line.released_at[0][1] <= LENGTH
    assert {each.category for each in caught} == {pymeshlab_fcd.LineWarning, pymeshlab_fcd.FoldWarning, pymeshlab_fcd.ContactWarning}
    with pytest.warns(DeformationWarning, match="have no way back"):
        made.deformation(inverse=True)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        straighten(*tube(), AXIS, degrees=60)


@pytest.mark.parametrize("line, given, message", [
    ([[1, 2, 3]], {}, "one point only"),
    (np.zeros((0, 3)), {}, "no point"),
    ([[0, 0, 0], [0, 0, 0]], {}, "no extent"),
    ([[0, 0, 0], [5, 0, 0], [5, 0, 0], [9, 0, 0]], {}, "Points 2 and 3 of the line are at one place"),
    ([[0, 0, 0], [5, 0, 0], [5, 1, 0], [0, 0, 0]], {}, "closed"),
    ([[0, 0, 0], [5, 0, 0], [2, 0, 0]], {}, "turns back on itself at point 2"),
    (AXIS + [0, 40, 0], {}, "outside of the surface"),
    (AXIS, {"degrees": 400}, "less than 360"),
    (AXIS, {"length": -2}, "positive number"),
    (AXIS, {"smoothing": 0.5}, "0 to 25 percent"),
    (AXIS, {"untwist": True}, "nearly round"),
    (AXIS, {"degrees": 90, "towards": [1, 0, 0]}, "cannot bend in its own direction"),
    (AXIS, {"target": bent(AXIS), "degrees": 90}, "not both"),
    (AXIS, {"target": [[0, 0, 0]]}, "The target line is wrong. The line has one point only"),
    (AXIS[:, :2], {}, "line must be n x 3"),
    (AXIS * np.nan, {}, "line must be finite"),
    (AXIS, {"direction": [1, 2]}, r"direction must be 3 numbers; it is 2 of int64"),
    (None, {}, "there is no line: it comes after the faces"),
    (AXIS, {"middle": 1}, "middle must be True or False; it is 1"),
    (AXIS, {"untwist": "no"}, "untwist must be True or False; it is 'no'"),
])
def test_what_cannot_be_taken(line, given, message):
    with pytest.raises((TypeError, ValueError), match=message):
        straighten(*tube(21, 8), line, **given)


@pytest.mark.parametrize("ours, its", [
    ({}, {}), (dict(smoothing=0.007), dict(line_smoothing=0.7)), (dict(degrees=33.3, towards=[0, 0, 1]), dict(to=1, angle=33.3, towards=[0, 0, 1])),
    (dict(length=12.3, smoothness=0.013), dict(length=12.3, smoothness=0.013))])
def test_the_same_bits_as_the_filter(tmp_path, ours, its):
    """Which gets numbers in single precision: they count as they were typed."""
    pymeshlab = with_filters()
    vertices, faces = tube()
    line = bent(AXIS) + 0.02 * np.sin(17.0 * np.arange(27)).reshape(9, 3)
    np.savetxt(tmp_path / "line.csv", line, "%.17g", ",")
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(bent(vertices), faces))
    ms.apply_filter("generate_fcd_straightened_mesh", line_file=str(tmp_path / "line.csv"), graph_layers=False, **its)
    mine = straighten(bent(vertices), faces, line, **ours).vertices
    assert same(mine, np.ascontiguousarray(ms.current_mesh().vertex_matrix()))


def test_places_along_the_line_are_told_once():
    """Of a row of points, each is a patch of its own."""
    row = np.arange(50.0)[:, None] + np.zeros(3)
    with pytest.warns(pymeshlab_fcd.LineWarning, match=r"Beside the line at [\d.]+, [\d.]+, [\d.]+, [\d.]+ of its length"):
        straighten(row, None, [[0, 0, 0], [1, 0.3, 0], [2, 0, 0]])


@pytest.mark.parametrize("middle, remedy", [(False, "Take the line through the middle (middle), or raise the smoothing of the line."), (True, "Raise the smoothing of the line.")])
def test_warnings_do_not_ask_for_what_was_asked_for(middle, remedy):
    """A corner so sharp that the thick surface folds at its inner side."""
    vertices, faces = tube(61, 24, 2.0)
    with pytest.warns(DeformationWarning) as told:
        straighten(vertices, faces, AXIS, CORNER, middle=middle, patches=100)
    texts = [str(each.message) for each in told if "Beside the line" in str(each.message) or "is folded there" in str(each.message)]
    assert len(texts) == 2 and all(text.endswith(remedy) and ("(middle)" in text) != middle for text in texts)
