# SPDX-License-Identifier: GPL-3.0-or-later
"""Fitting a layer to another one, inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import re

import numpy as np
import pymeshlab
import pytest

from conftest import transformed
from host_pymeshlab import (COPY, DEFORM, DEFORM_DEFAULTS, SURFACE_RETURNS, assert_unchanged, check_returned, new_set, point_file,
                            same_points, set_quality, snapshot)
from lumpy_tube import DIAGONAL, LENGTH, bent, rms, round_tube, tube

FIT, SAVE = "generate_fcd_fitted_mesh", "save_fcd_deformation"
HANDLES = ["handles", "tag_attribute", "tag_file", "transform_file", "transforms", "point_handles_file", "translation", "rotation_axis",
           "rotation_angle", "rotation_center", "rotation_point", "transformmatrix", "handle_layer"]
FIT_DEFAULTS = {
    "target_layer": 0, "landmarks_file": "", "target_landmarks_file": "", "landmark_tolerance": 0, "curves_file": "", "check_file": "", "target_check_file": "", "leave_one_out": False, "landmarks_only": False, "start": 0, "stiffness": 1, "rigidity": 1, "largest_distance": 0, "largest_angle": 70, "both_ways": False, "weights": 0, "target_weights": 0, "weight_attribute": "fcd_weight",
    "initial_patches": 150, "smoothness": 0.0058, "random_seed": 1, "samples": 6000, "fit_steps": 50, "graph_layers": True, "fit_quality": 0,
    **{name: DEFORM_DEFAULTS[name] for name in HANDLES}}
FIT_RETURNS = {
    **SURFACE_RETURNS, "fixed_vertices": int, "handle_vertices": int, "free_vertices": int, "outside_vertices": int, "rms": float,
    "median": float, "percentile_95": float, "matched": float, "counted": float, "moved": float, "moved_most": float, "guessed": float, "guess_error": float, "check_rms": float, "check_largest": float,
    "leave_one_out_rms": float, "leave_one_out_largest": float, "carried_parts": int, "folded_triangles": int, "contact_triangles": int, "contact_depth": float, "landmarks": int, "landmark_residual": float, "landmark_pull": float,
    "curves": int, "curve_residual": float, "landmarks_contradicted": int, "target_not_finite": int, "from_afar": bool, "both_ways": bool, "inside_out": bool, "nodes": int, "steps": int, "converged": bool, "seconds": float}
FINE = (120, 60)  # rings of the tube, and vertices of each
PLACED = np.array([[0, -2, 0, 7.0], [2, 0, 0, -5.0], [0, 0, 2, 3.0], [0, 0, 0, 1.0]])  # turned, twice as large, and away
OWN = np.array([[0.8, 0, 0.6, 0.1], [0, 1, 0, 0.2], [-0.6, 0, 0.8, 0.3], [0, 0, 0, 1.0]])


def mesh_of(points, faces, **more):
    return pymeshlab.Mesh(vertex_matrix=points, face_matrix=faces, **more) if faces is not None else pymeshlab.Mesh(vertex_matrix=points, **more)


def pair(source=None, target=None, degrees=15.0):
    """The tube, current, and a copy of it with other vertices that is bent: (set, where the tube's vertices belong)."""
    source, target = source or tube(*FINE), target or tube(97, 53, shift=0.5)
    ms = new_set()
    ms.add_mesh(mesh_of(bent(target[0], degrees), target[1]), "target")
    ms.add_mesh(mesh_of(*source), "tube")
    return ms, bent(source[0], degrees)


FEW = {"samples": 600, "graph_layers": False}  # where the fit itself is not what is asked for


def fit(ms, **parameters):
    """(returned values, positions of the result)"""
    result = ms.apply_filter(FIT, **{"target_layer": 0, **parameters})
    return result, ms.current_mesh().vertex_matrix()


def fit_logged(ms, capfd, **parameters):
    """(returned values, log). After an error in any filter pymeshlab logs no more, hence these tests come first."""
    ms.set_verbosity(True)
    capfd.readouterr()
    result = fit(ms, **parameters)[0]
    return result, capfd.readouterr().err


def test_what_a_fit_is_worth_is_logged(capfd, tmp_path):
    ms, _ = pair()
    result, log = fit_logged(ms, capfd)
    assert "percent have a counterpart" in log and "do not trust" not in log and "off by" not in log
    ms, _ = pair(target=tube(10, 53, end=0.4))
    result, log = fit_logged(ms, capfd, largest_distance=0.01 * DIAGONAL)
    assert result["matched"] < 0.3 and "do not trust the rest" in log
    points, faces = tube(97, 53, shift=0.5)
    ms, truth = pair(target=(points, faces[:, ::-1]))
    result, log = fit_logged(ms, capfd)
    assert result["inside_out"] and "point to the other side than the target's" in log and result["matched"] > 0.9
    assert rms(ms.current_mesh().vertex_matrix(), truth) < 0.5
    ms, truth = pair()
    chosen = np.array([600, 601])  # side by side, where one belongs at the other end
    file = point_file(tmp_path / "mixed.csv", "index", chosen, None, truth[[600, 6600]])
    result, log = fit_logged(ms, capfd, landmarks_file=file)
    assert result["landmark_pull"] > 0.01 * DIAGONAL and "contradict each other or the target" in log
    assert result["folded_triangles"] > 0 and "flipped: the fit folds the surface there" in log
    assert result["landmarks"] == 2 and "None of the 2 landmarks is off" in log
    ms, _ = pair()
    result, log = fit_logged(ms, capfd, fit_steps=2)
    assert not result["converged"] and "did not converge: raise fit_steps" in log


@pytest.mark.parametrize("quality", [1, 2], ids=["distance", "matched"])
def test_a_fit_is_fitted_again_whatever_was_measured_of_it(capfd, quality):
    """A quality that a fit has measured is no tags, also where its numbers are whole."""
    ms, _ = pair()
    fit(ms, **FEW, fit_quality=quality)
    again = ms.current_mesh().id()
    assert len(np.unique(ms.current_mesh().vertex_scalar_array())) > 1
    for handles in (0, 4):
        ms.set_current_mesh(again)
        result, log = fit_logged(ms, capfd, **FEW, handles=handles)
        assert result["fixed_vertices"] == 0 and result["free_vertices"] == ms.current_mesh().vertex_number()
        assert ("is a measure, not tags, so nothing is held" in log) == (handles == 0)


def test_what_counts_is_told_by_quality_selection_or_attribute(capfd):
    points, faces = tube(97, 53, shift=0.5)
    far = np.vstack([points, points[:53] + [0, 0, 0.2]])  # loose points beside it, which do not count
    counts = np.arange(len(far)) < len(points)
    carried = tube(*FINE)[0][:, 2] > 3

    def weighed(source, **parameters):
        ms = new_set()
        ms.add_mesh(mesh_of(bent(far), None, v_scalar_array=counts.astype(float)), "target")
        ms.add_mesh(mesh_of(*tube(*FINE), v_scalar_array=np.where(carried, 0.0, 1.0)), "tube")
        for layer in (0, 1):
            ms.set_current_mesh(layer)
            ms.apply_filter("compute_selection_by_condition_per_vertex", condselect="q > 0.5")
            ms.current_mesh().add_vertex_custom_scalar_attribute(ms.current_mesh().vertex_scalar_array(), "counts")
            if source != 1:
                set_quality(ms, "1")
        result, log = fit_logged(ms, capfd, **FEW, weights=source, target_weights=source, handles=parameters.pop("handles", 0), **parameters)
        return ms.current_mesh().vertex_matrix(), result, log
    fitted, result, log = weighed(1)
    assert 0.7 < result["counted"] < 0.8 and result["matched"] > 0.8 and result["free_vertices"] == len(fitted)
    assert "percent that count; the rest went along" in log
    assert same_points(weighed(2)[0], fitted) and same_points(weighed(2, handles=1)[0], fitted)
    assert same_points(weighed(3, weight_attribute="counts")[0], fitted)
    assert not same_points(weighed(0)[0], fitted)


def test_a_fit_is_judged_by_what_it_does_not_see(capfd, tmp_path):
    ms, truth = pair()
    start = ms.current_mesh().vertex_matrix()
    chosen, kept = np.arange(5, 7200, 1200), np.arange(700, 7200, 900)
    wrong = truth.copy()
    wrong[kept[3]] += [0, 0.1, 0]
    check = point_file(tmp_path / "check.csv", "index", kept, None, wrong[kept])
    plain = fit(ms, **FEW)[1]
    ms.set_current_mesh(1)
    result, log = fit_logged(ms, capfd, check_file=check, **FEW)
    off = np.linalg.norm(plain - wrong, axis=1)[kept]
    assert same_points(ms.current_mesh().vertex_matrix(), plain)  # which has not seen them
    assert abs(result["check_rms"] - np.sqrt((off ** 2).mean())) < 1e-9 and abs(result["check_largest"] - off.max()) < 1e-9
    assert "Pairs that were kept back are off by" in log and "(number 3 of 8, counted from 0)" in log
    assert "That came from" in log and 0 < result["moved"] < result["moved_most"] and result["leave_one_out_rms"] == 0
    ms.set_current_mesh(1)
    names = {f"p{i}": i for i in kept}
    result, _ = fit_logged(ms, capfd, **FEW, check_file=picked(tmp_path / "a.pp", **{name: start[i] for name, i in names.items()}),
                           target_check_file=picked(tmp_path / "b.pp", **{name: wrong[i] for name, i in names.items()}))
    assert abs(result["check_largest"] - off.max()) < 1e-6
    ms.set_current_mesh(1)
    landmarks = point_file(tmp_path / "landmarks.csv", "index", chosen, None, wrong[chosen])
    for alone in (False, True):
        ms.set_current_mesh(1)
        result, log = fit_logged(ms, capfd, **FEW, landmarks_file=landmarks, leave_one_out=True, landmarks_only=alone)
        assert result["landmark_residual"] < 1e-5 < result["leave_one_out_rms"] <= result["leave_one_out_largest"] < (0.7 if alone else 0.05)
        assert "Landmarks that are left out in turn are off by" in log


def test_what_is_guessed_is_told(capfd):
    ms, truth = pair(target=tube(50, 53, end=LENGTH / 2), degrees=60)
    result, log = fit_logged(ms, capfd)
    off = np.linalg.norm(ms.current_mesh().vertex_matrix() - truth, axis=1)[tube(*FINE)[0][:, 2] > LENGTH / 2]
    assert abs(result["guessed"] - 0.5) < 0.05 and 0.5 < result["guess_error"] / np.sqrt((off ** 2).mean()) < 2
    assert "percent have no counterpart; their place is a guess that may be off by about" in log and "give landmarks there, or do not trust them" in log
    ms, _ = pair()
    result, log = fit_logged(ms, capfd)
    assert result["guessed"] < 0.05 and "give landmarks there" not in log


def test_a_separate_part_without_a_counterpart_is_carried(capfd):
    points, faces = tube(*FINE)
    ball = new_set()
    ball.create_sphere(radius=0.3, subdiv=3)
    eye, corners = ball.current_mesh().vertex_matrix() + [0.1, 0, 3], ball.current_mesh().face_matrix()
    ms, _ = pair(source=(np.vstack([points, eye]), np.vstack([faces, corners + len(points)])))
    result, log = fit_logged(ms, capfd)
    assert result["carried_parts"] == 1 and "1 separate part without a counterpart was carried by the parts around" in log
    assert rms(ms.current_mesh().vertex_matrix()[len(points):], bent(eye)) < 0.8


def test_what_is_wrong_with_landmarks_and_target_is_logged(capfd, tmp_path):
    ms, truth = pair()
    chosen = np.arange(300, 7200, 500)
    places = truth[chosen]
    places[[2, 9]] = places[[9, 2]]
    file = point_file(tmp_path / "swapped.csv", "index", chosen, None, places)
    result, log = fit_logged(ms, capfd, landmarks_file=file, landmark_tolerance=0.02)
    assert result["landmarks_contradicted"] == 2 and "Pairs 2 and 9 of the landmarks, counted from 0" in log and "were left out" in log
    assert "None of the 12 landmarks is off" in log and rms(ms.current_mesh().vertex_matrix(), truth) < 0.5
    points, faces = tube(97, 53, shift=0.5)
    ms, truth = pair(target=(points, None))
    holed = bent(points)
    holed[::3] = np.nan
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=holed), "holed")
    ms.set_current_mesh(1)
    result, log = fit_logged(ms, capfd, target_layer=2)
    assert result["target_not_finite"] == len(holed[::3]) and "are not finite and were left out" in log
    ms, truth = pair()
    ms.add_mesh(mesh_of(bent(points) + [900, 0, 0], faces), "far")
    ms.set_current_mesh(1)
    result, log = fit_logged(ms, capfd, target_layer=2)
    assert result["from_afar"] and "did not overlap" in log and "raise fit_steps" not in log
    assert rms(ms.current_mesh().vertex_matrix(), truth + [900, 0, 0]) < 0.5


TURN = np.array([[np.cos(0.35), -np.sin(0.35), 0], [np.sin(0.35), np.cos(0.35), 0], [0, 0, 1]])


def round_tubes():
    """Round ones, which slide about their axis; the target, layer 0, is turned: (set, where the tube's vertices belong)."""
    (points, faces), (target, target_faces) = round_tube(*FINE), round_tube(97, 53)
    ms = new_set()
    ms.add_mesh(mesh_of(target @ TURN.T, target_faces), "target")
    ms.add_mesh(mesh_of(points, faces), "tube")
    return ms, points @ TURN.T


def curve_file(path, **curves):
    """Of names, each with the corners on the source and on the target."""
    path.write_text("curve,surface,x,y,z\n" + "".join(
        f"{name},{surface},{x!r},{y!r},{z!r}\n" for name, sides in curves.items()
        for surface, corners in zip(("source", "target"), sides) for x, y, z in np.asarray(corners, float).tolist()))
    return str(path)


def line_along(end=3.9, count=2):
    return np.stack([np.full(count, 0.4), np.zeros(count), np.linspace(0.1, end, count)], 1)


def test_points_far_from_the_layer_are_told(capfd, tmp_path):
    """In other units than the layer, they would all be one vertex."""
    ms, _ = pair()
    points = ms.current_mesh().vertex_matrix()[[100, 3000, 7000]]
    away = points * [[1], [1], [1000.0]]

    def told(name, **parameters):
        ms.set_current_mesh(1)
        ms.set_verbosity(True)
        capfd.readouterr()
        ms.apply_filter(name, **parameters)
        found = re.search(r"(Points? .*) of '.*', counted from 0, (is|are up to) .* from 'tube', which is 4\.\S+ large", capfd.readouterr().err)
        return found and found[1]

    def file(where):
        return point_file(tmp_path / "p.csv", "coordinates", None, where, where)

    for where, expected in ((1.3 * points, None), (away, "Point 2"), (points + [[0, 0, -100], [0, 0, 0], [0, 0, 100.0]], "Points 0, 2")):
        assert told(DEFORM, point_handles_file=file(where), initial_patches=60, graph_layers=False) == expected
        assert told(FIT, target_layer=0, landmarks_file=file(where), **FEW) == expected
    assert told(FIT, target_layer=0, check_file=file(away), **FEW) == "Point 2"


@pytest.mark.parametrize("placed", [False, True], ids=["as it lies", "with matrices"])
def test_curves_lead_what_slides(capfd, tmp_path, placed):
    """A round tube slides about its axis; a line along it, and one around it, tell how far, though no corner has its counterpart."""
    around = 0.3 + np.linspace(0, 2 * np.pi, 41)
    around[-1] = around[0]
    ring = np.stack([0.4 * np.cos(around), 0.4 * np.sin(around), np.full(41, 2.0)], 1)
    seam, scale, matrix = line_along(), 1, np.eye(4)
    curves = {"seam": (seam, line_along(count=9) @ TURN.T), "the ring": (ring, ring[::-1])}
    ms, truth = round_tubes()
    start = ms.current_mesh().vertex_matrix()
    if placed:
        scale, matrix = 2, PLACED @ OWN
        for layer in (0, 1):
            ms.set_current_mesh(layer)
            ms.apply_filter("set_matrix", transformmatrix=matrix, freeze=False)
        curves = {name: [transformed(matrix, side) for side in sides] for name, sides in curves.items()}
    file = curve_file(tmp_path / "curves.csv", **curves)
    result, log = fit_logged(ms, capfd, graph_layers=False, curves_file=file)
    led = ms.current_mesh().vertex_matrix()
    assert result["curves"] == 2 and 0 < result["curve_residual"] < 1e-3 * scale * DIAGONAL
    on, far, off = re.search(r" (\d+) vertices lie along the 2 curves, at most (\S+) away on this layer; on the target, none is off by more than (\S+)\. ", log).groups()
    assert 60 + 80 < int(on) < 60 + 114 and 0 < float(far) < 0.03 * scale and float(off) == pytest.approx(result["curve_residual"], rel=1e-4)
    assert "flipped" not in log
    ms.set_current_mesh(1)
    without, log = fit_logged(ms, capfd, graph_layers=False)
    assert without["curves"] == without["curve_residual"] == 0 and "curve" not in log
    assert rms(led, truth) < 0.2 * rms(ms.current_mesh().vertex_matrix(), truth)
    beside = (np.abs(start[:, 1]) < 1e-9) & (start[:, 0] > 0) & (start[:, 2] > 0.1) & (start[:, 2] < 3.9)
    goes = np.hypot(*(led[beside] @ TURN)[:, :2].T - [[0.4], [0]])  # the target's line, turned back
    assert beside.sum() == 114 and goes.max() < 1e-3 * DIAGONAL


def test_what_is_held_is_not_drawn_to_a_curve(capfd, tmp_path):
    file = curve_file(tmp_path / "curves.csv", seam=(line_along(), line_along()))
    on = []
    for least in (0, 2):
        ms, _ = round_tubes()
        set_quality(ms, f"z < {least} ? 0 : 1")
        result, log = fit_logged(ms, capfd, graph_layers=False, curves_file=file)
        assert result["curves"] == 1 and result["fixed_vertices"] == 60 * 60 * (least == 2)
        on.append(int(re.search(r" (\d+) vertices lie along the 1 curve, at most ", log)[1]))
    assert on[0] > 70 and on[1] == pytest.approx(on[0] / 2, abs=1)


@pytest.mark.parametrize("degrees, samples, most", [
    (60.0, 6000, 0.6), (91.0, 6000, 0.8), (110.0, 6000, 1.0),
    (86.0, 1500, 1.0)])  # from where it came to rest; drawn from the start only, it is off by 1.3
def test_a_tube_is_found_that_is_bent_far(capfd, degrees, samples, most):
    ms, truth = pair(degrees=degrees)
    result, log = fit_logged(ms, capfd, samples=samples)
    assert "also drew the nearest surface" in log and result["both_ways"]
    assert rms(ms.current_mesh().vertex_matrix(), truth) < most, "one way, it is off by more than 2; led by ends, by 0.7 and 1.3"


def test_parameters_names_order_and_defaults():
    assert FIT in pymeshlab.filter_list()
    ms, _ = pair()
    values = ms.filter_parameter_values(FIT)
    assert list(values) == list(FIT_DEFAULTS)
    for key, value in {**FIT_DEFAULTS, "handle_layer": 1}.items():
        if isinstance(value, (str, bool)):
            assert values[key] == value and type(values[key]) is type(value), key
        else:
            assert np.allclose(values[key], value, rtol=1e-6, atol=0), key


def test_an_untagged_layer_comes_near_the_truth():
    ms, truth = pair()
    before = [snapshot(ms.mesh(i)) for i in (0, 1)]
    result, points = fit(ms)
    check_returned(result, FIT_RETURNS)
    assert rms(points, truth) < 0.5 and rms(ms.mesh(1).vertex_matrix(), truth) > 5
    assert result["rms"] < 0.002 * DIAGONAL and result["median"] <= result["percentile_95"] < 0.005 * DIAGONAL
    assert result["matched"] > 0.9 and result["folded_triangles"] == 0 and result["free_vertices"] == len(truth)
    assert result["landmarks"] == 0 and result["landmark_residual"] == 0
    assert [mesh.label() for mesh in ms] == ["target", "tube", "tube graph", "tube deformed graph", "tube fitted"]
    for i, each in enumerate(before):
        assert_unchanged(each, ms.mesh(i))
    energy = ms.mesh(3).vertex_custom_scalar_attribute_array("energy")
    assert energy.min() > 0, "it bends everywhere"
    # The same bits again.
    ms, _ = pair()
    assert same_points(points, fit(ms, graph_layers=False)[1])
    assert [mesh.label() for mesh in ms] == ["target", "tube", "tube fitted"]


@pytest.mark.parametrize("kind", ["index", "coordinates", "picked"])
def test_landmarks_lead_where_the_shape_alone_does_not(tmp_path, kind):
    def turned(points):  # about the axis: at 120 degrees, its bumps are nearly the same again
        return points @ [[np.cos(2), np.sin(2), 0], [-np.sin(2), np.cos(2), 0], [0, 0, 1]]

    points, faces = tube(97, 53, shift=0.5)
    ms, _ = pair(target=(turned(points), faces))
    source = tube(*FINE)[0]
    truth = bent(turned(source))
    far = rms(fit(ms, graph_layers=False)[1], truth)
    chosen = np.arange(5, len(truth), len(truth) // 12)
    file = point_file(tmp_path / ("p.pp" if kind == "picked" else "p.csv"), kind, chosen, source[chosen], truth[chosen])
    ms.set_current_mesh(1)
    result, points = fit(ms, landmarks_file=file)
    assert result["landmarks"] == len(chosen) and result["landmark_residual"] < 1e-12 * DIAGONAL and result["landmark_pull"] < 0.01 * DIAGONAL
    assert np.linalg.norm(points - truth, axis=1)[chosen].max() < 1e-12 * DIAGONAL
    assert rms(points, truth) < min(0.5, 0.3 * far)


def stretches(before, after, faces):
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    return [np.linalg.norm(p[edges[:, 0]] - p[edges[:, 1]], axis=1).reshape(3, -1).sum(0) for p in (before, after)]


def test_what_has_no_counterpart_is_carried_along():
    ms, truth = pair(target=tube(60, 53, end=0.6 * LENGTH, shift=0.5))
    before, faces = tube(*FINE)
    result, points = fit(ms, fit_quality=2)
    assert 0.4 < result["matched"] < 0.75
    rest, now = stretches(before, points, faces)
    assert np.mean((now / rest > 0.8) & (now / rest < 1.25)) > 0.99
    has = before[:, 2] < 0.55 * LENGTH
    assert rms(points[has], truth[has]) < 0.5
    # What is matched is told vertex by vertex.
    matched = ms.current_mesh().vertex_scalar_array()
    assert set(np.unique(matched)) == {0, 1}
    assert matched[has].mean() > 0.9 and matched[before[:, 2] > 0.65 * LENGTH].mean() < 0.05


def test_the_distance_as_quality():
    ms, _ = pair()
    result, points = fit(ms, fit_quality=1)
    target = bent(tube(400, 200)[0])
    distance = ms.current_mesh().vertex_scalar_array()
    some = np.arange(0, len(points), 61)
    nearest = np.sqrt(((points[some, None] - target[None]) ** 2).sum(2).min(1))
    assert np.all(distance >= 0) and np.abs(nearest - distance[some]).max() < 0.02
    assert np.median(distance) == pytest.approx(result["median"], rel=0.3)


@pytest.mark.parametrize("kind", ["target", "target with normals", "source", "both"])
def test_clouds(kind):
    source, target = tube(*FINE), tube(160, 80, shift=0.5)
    ms, truth = pair((source[0], None) if kind in ("source", "both") else source, target if kind == "source" else (target[0], None))
    if kind == "target with normals":
        ms.set_current_mesh(0)
        ms.apply_filter("compute_normal_for_point_clouds")
        ms.set_current_mesh(1)
    result, points = fit(ms)
    # Points without normals do not tell how the surface slides along them.
    assert rms(points, truth) < (1 if kind in ("target", "both") else 0.6) and result["matched"] > 0.8
    assert (ms.current_mesh().face_number() == 0) == (kind in ("source", "both"))


def test_fixed_vertices_keep_their_bits_and_handles_move_as_told():
    ms, truth = pair()
    set_quality(ms, f"z < 0.3 ? 0 : (z > {LENGTH - 0.01} ? 2 : 1)")
    before = ms.current_mesh().vertex_matrix()
    result, points = fit(ms, translation=np.array([0.5, 0, 0]))
    fixed, handle = before[:, 2] < 0.3, before[:, 2] > LENGTH - 0.01
    assert result["fixed_vertices"] == fixed.sum() and result["handle_vertices"] == handle.sum()
    assert same_points(points[fixed], before[fixed])
    assert np.abs(points[handle] - before[handle] - [0.5, 0, 0]).max() < 1e-12
    middle = (before[:, 2] > 1) & (before[:, 2] < 3)
    assert rms(points[middle], truth[middle]) < 1


def test_matrices_of_the_layers_count():
    ms, truth = pair()
    plain, points = fit(ms, graph_layers=False)
    matrix = PLACED @ OWN
    ms = new_set()
    target, faces = tube(97, 53, shift=0.5)
    # The same pair in a world that is turned and twice as large: one by its matrix, the other by its coordinates.
    ms.add_mesh(mesh_of(transformed(matrix, bent(target)), faces), "target")
    ms.add_mesh(mesh_of(*tube(*FINE)), "tube")
    ms.apply_filter("set_matrix", transformmatrix=matrix, freeze=False)
    result, placed = fit(ms, graph_layers=False, fit_quality=1)
    assert rms(placed, points) < 0.2 and rms(placed, truth) < 0.5
    assert result["rms"] == pytest.approx(2 * plain["rms"], rel=0.1)
    assert np.median(ms.current_mesh().vertex_scalar_array()) == pytest.approx(result["median"], rel=0.3)


def test_the_layer_with_the_graph_does_the_same_to_a_decimated_copy(tmp_path):
    ms, _ = pair()
    points = fit(ms)[1]
    before, faces = tube(61, 30)
    ms.add_mesh(mesh_of(before, faces), "coarse")
    ms.apply_filter(COPY, source_layer=1, rest_graph=2, deformed_graph=3)
    fine = tube(*FINE)[0].reshape(120, 60, 3)
    coarse = ms.current_mesh().vertex_matrix().reshape(61, 30, 3)
    assert np.abs(fine[0, ::2] - before[:30]).max() < 1e-12
    fitted = points.reshape(120, 60, 3)
    for ring in 0, 60:  # those that both have
        assert np.linalg.norm(coarse[ring] - fitted[0 if ring == 0 else 119, ::2], axis=1).max() < 1e-3 * DIAGONAL
    # As the saved deformation does.
    file = str(tmp_path / "fit.ply")
    ms.apply_filter(SAVE, source_layer=1, rest_graph=2, deformed_graph=3, deformation_file=file)
    ms.add_mesh(mesh_of(*tube(*FINE)), "again")
    ms.apply_filter(COPY, deformation_file=file)
    assert rms(ms.current_mesh().vertex_matrix(), points) < 0.05


def test_the_result_carries_what_the_source_does():
    ms, _ = pair()
    ms.compute_color_by_function_per_vertex(x="60 * z", y="100", z="50")
    color = ms.current_mesh().vertex_color_matrix()
    fit(ms)
    result = ms.current_mesh()
    assert same_points(result.vertex_color_matrix(), color)
    normal = result.vertex_normal_matrix()
    ms.apply_filter("compute_normal_per_vertex")
    again = ms.current_mesh().vertex_normal_matrix()
    length = np.linalg.norm(normal, axis=1) * np.linalg.norm(again, axis=1)
    assert ((normal * again).sum(1) / length).min() > 0.99


def picked(path, **points):
    path.write_text("<PickedPoints>" + "".join(f'<point x="{p[0]:.17g}" y="{p[1]:.17g}" z="{p[2]:.17g}" active="1" name="{name}"/>'
                                                for name, p in points.items()) + "</PickedPoints>")
    return str(path)


def test_landmarks_alone(tmp_path):
    """Of the target, nothing but where they belong counts."""
    ms, truth = pair()
    start = ms.current_mesh().vertex_matrix()
    with pytest.raises(pymeshlab.PyMeshLabException, match="There are no landmarks to follow"):
        fit(ms, landmarks_only=True)
    chosen = np.arange(30, len(start), 700)
    file = point_file(tmp_path / "pairs.csv", "index", chosen, None, (truth + [3, 0, 0])[chosen])
    result, points = fit(ms, landmarks_file=file, landmarks_only=True)
    assert result["converged"] and result["landmarks"] == len(chosen)
    assert np.abs(points - truth - [3, 0, 0])[chosen].max() < 1e-5
    assert rms(points, truth + [3, 0, 0]) < 1  # as near as the few of them say


@pytest.mark.parametrize("start, scale", [("Rigid, from landmarks", 1), ("Rigid and scaled, from landmarks", 1.3), ("Axes tried out", 1)])
def test_a_layer_that_lies_elsewhere(tmp_path, start, scale):
    ms, truth = pair()
    source = tube(*FINE)[0]
    away = scale * source @ np.array([[0, 0, 1], [0, -1, 0], [1, 0, 0]]) + [3, -4, 5]
    ms.set_current_mesh(1)
    ms.add_mesh(pymeshlab.Mesh(away, tube(*FINE)[1]), "away")
    parameters = {}
    if "landmarks" in start:
        chosen = np.arange(5, len(truth), len(truth) // 6)
        parameters = {"landmarks_file": picked(tmp_path / "a.pp", **{f"p{i}": away[i] for i in chosen}),
                      "target_landmarks_file": picked(tmp_path / "b.pp", **{f"p{i}": truth[i] for i in chosen[::-1]})}
    result, points = fit(ms, graph_layers=False, start=start, **parameters)
    assert result["matched"] > 0.9
    if parameters:
        assert rms(points, truth) < 0.5
        assert np.linalg.norm(points - truth, axis=1)[chosen].max() < 1e-12 * DIAGONAL
    else:  # a tube may be turned about its axis, too
        assert result["rms"] < 0.003 * DIAGONAL


@pytest.mark.parametrize("start, scale", [("Rigid, from landmarks", 1), ("Rigid and scaled, from landmarks", 0.001)])
def test_places_between_vertices_turn_and_grow_with_the_surface(tmp_path, start, scale):
    """As landmarks, and as pairs to check."""
    points, faces = tube()
    there = PLACED.copy()
    there[:3, :3] *= scale / 2

    def pairs(name, vertices):
        places = points[vertices] + 0.4 * (points[vertices + 1] - points[vertices])
        np.savetxt(tmp_path / name, np.hstack([places, places @ there[:3, :3].T + there[:3, 3]]), "%.17g", ",")
        return str(tmp_path / name)

    truth = points @ there[:3, :3].T + there[:3, 3]
    chosen = np.arange(5, len(points), len(points) // 8)
    ms = pymeshlab.MeshSet()
    ms.add_mesh(mesh_of(truth, faces), "target")
    ms.add_mesh(mesh_of(points, faces), "source")
    result, made = fit(ms, target_layer=0, start=start, landmarks_file=pairs("a.csv", chosen), check_file=pairs("b.csv", chosen + 11), **FEW)
    assert np.abs(made - truth)[chosen].max() < 1e-4 * scale * DIAGONAL
    assert 0 < result["check_largest"] < 1e-3 * scale * DIAGONAL


@pytest.mark.parametrize("first, second, word", [
    ({"a": (0, 0, 0), "b": (1, 0, 0)}, {"a": (0, 0, 0)}, "of which 1 have the same names"),
    ({"a": (0, 0, 0)}, None, "where both files are picked points")])
def test_picked_points_that_do_not_match(tmp_path, first, second, word):
    ms, _ = pair()
    second = picked(tmp_path / "b.pp", **second) if second else str(tmp_path / "b.csv")
    check_error(ms, word, landmarks_file=picked(tmp_path / "a.pp", **first), target_landmarks_file=second)


def test_picked_points_of_one_name(tmp_path):
    ms, _ = pair()
    (tmp_path / "a.pp").write_text('<PickedPoints>' + 2 * '<point x="0" y="0" z="0" active="1" name="a"/>' + '</PickedPoints>')
    check_error(ms, "two active points with the name 'a'", landmarks_file=str(tmp_path / "a.pp"), target_landmarks_file=str(tmp_path / "a.pp"))


def test_a_start_that_cannot_be():
    ms, _ = pair()
    check_error(ms, "A start from landmarks needs three of them", start=1)
    set_quality(ms, "z < 0.3 ? 0 : 1")
    check_error(ms, "A start cannot move the surface", start=3)


@pytest.mark.parametrize("name, value, word", [
    ("target_layer", 1, "'target_layer' is 'tube' itself, the current layer"), ("target_layer", 77, "'target_layer' names no layer"),
    ("stiffness", 0.0, "The stiffness must be from 1e-6"), ("largest_distance", -1.0, "largest distance of matches must be positive"),
    ("largest_distance", 1e-9, "has a counterpart on 'target'"), ("largest_angle", 200.0, "largest angle of matches"),
    ("weights", 2, "The weights of the surface are 0 wherever it is free"), ("target_weights", 3, "with a weight from 0 to 1 per vertex"),
    ("landmark_tolerance", -1.0, "The tolerance of the landmarks"), ("fit_steps", 1, "A fit takes 2 to 10000 steps"), ("samples", 5, "At least 100 places"), ("samples", 2**31 - 1, "at most 1000000"),
    ("transforms", "2: translate 0 0 1", "no vertex has tag 2"), ("landmarks_file", "/no/such.csv", "Cannot open '/no/such.csv'")])
def test_a_value_that_makes_no_sense_changes_nothing(name, value, word):
    ms, _ = pair()
    check_error(ms, word, **{name: value})


def check_error(ms, word, **parameters):
    before = [snapshot(mesh) for mesh in ms]
    current = ms.current_mesh_id()
    with pytest.raises(pymeshlab.PyMeshLabException) as error:
        fit(ms, **parameters)
    assert word in str(error.value), str(error.value)
    assert ms.current_mesh_id() == current and len(list(ms)) == len(before)
    for each, mesh in zip(before, list(ms)):
        assert_unchanged(each, mesh)


@pytest.mark.parametrize("text, word", [
    ("3600 0 0 0\n3600 0 0 1\n", "Landmark 2 is at the place of another one"), ("3600 0 0 0\n0 0 0 0\n", "Landmark 2 is at a vertex that is not free"),
    ("9999999 0 0 0\n", "names vertex 9999999"), ("1 2\n", "line 1: found 2 numbers")])
def test_landmarks_that_make_no_sense(tmp_path, text, word):
    ms, _ = pair()
    set_quality(ms, "z < 0.3 ? 0 : 1")
    (tmp_path / "p.csv").write_text(text)
    check_error(ms, word, landmarks_file=str(tmp_path / "p.csv"))


@pytest.mark.parametrize("text, word", [
    ("lips,source,0,0,0\n", "line 1: expected the first row 'curve,surface,x,y,z'"), ("curve,surface,x,y,z\n", "the file holds no curves"),
    ("curve,surface,x,y,z\nlips,scan,0,0,0\n", "line 2: expected source or target as the surface, found 'scan'"),
    ("curve,surface,x,y,z\nlips,source,0,0\n", "line 2: found 4 cells"), ("curve,surface,x,y,z\n,source,0,0,0\n", "expected the name of a curve in the first cell"),
    ("curve;surface;x;y;z\nlips;source;0,5;0;0\n", "line 2: expected a finite number, with a point for decimals, found '0,5'"),
    ("curve,surface,x,y,z\nlips,source,0,0,0\nlips,source,1,0,0\n", "line 2: the curve 'lips' needs corners at two places of the target at least")])
def test_curves_that_make_no_sense(tmp_path, text, word):
    ms, _ = pair()
    (tmp_path / "c.csv").write_text(text)
    check_error(ms, word, curves_file=str(tmp_path / "c.csv"))


def test_curves_that_lie_elsewhere(tmp_path):
    ms, _ = pair()
    file = lambda line: curve_file(tmp_path / "c.csv", a=(line_along(), line_along()), b=(line, line_along()))
    for line, where in [(line_along() + [0, 0, 40], 7), ([[0.4, 0, 1], [0.4, 0, 2], [0.4, 0, 80]], 8), ([[0.4, 0, 1], [0.4, 0, 1e300]], 7)]:
        check_error(ms, f"c.csv', line {where}: the curve 'b' is ", curves_file=file(line))
    check_error(ms, "from the vertices of 'tube' there, more than a tenth of its diagonal. Give the rows with 'source'", curves_file=file(line))
    check_error(ms, "from the target at the least, more than a tenth of its diagonal. Give its line there in world coordinates",
                curves_file=curve_file(tmp_path / "c.csv", a=(line_along(), line_along() + [0, 3, 0])))
    check_error(ms, "Curve 1 has all its points on the target at one place",
                curves_file=curve_file(tmp_path / "c.csv", a=(line_along(), [[0.4, 0, 1], [0.4, 1e-300, 1]])))
    check_error(ms, "Curves do not go with 'landmarks_only'", curves_file=file(line_along()), landmarks_only=True,
                landmarks_file=point_file(tmp_path / "p.csv", "index", [5], None, np.zeros((1, 3))))
    set_quality(ms, "z < 3 ? 0 : 1")
    check_error(ms, "line 6: the curve 'b' lies where nothing of 'tube' is free", curves_file=file(line_along(end=2)))
    check_error(ms, "/no/such.csv", curves_file="/no/such.csv")


def test_a_layer_that_is_fixed_everywhere_and_one_without_vertices():
    ms, _ = pair()
    ms.apply_filter("compute_selection_by_condition_per_face", condselect="1")
    check_error(ms, "There is nothing to fit", handles=1)
    set_quality(ms, "751")
    check_error(ms, "counts as tags, since its numbers are whole, and none is 1: no vertex is free. If it is something else (a label, a measure), choose "
                    "'Tags of the layer' (4) as 'handles'. Otherwise tag what may bend with 1.")
    ms.add_mesh(pymeshlab.Mesh(np.eye(3)), "empty")
    ms.apply_filter("set_selection_all")
    ms.apply_filter("meshing_remove_selected_vertices")
    ms.set_current_mesh(1)
    check_error(ms, "Layer 'empty' has no vertices", target_layer=2)
    ms.set_current_mesh(2)
    check_error(ms, "has no vertices. Make the mesh the current layer")
    with pytest.raises(pymeshlab.PyMeshLabException):
        new_set().apply_filter(FIT)


def test_a_matrix_that_is_not_finite():
    ms, _ = pair()
    ms.apply_filter("set_matrix", transformmatrix=np.diag([np.inf, 1, 1, 1]), freeze=False)
    check_error(ms, "holds a number that is not finite")


def test_a_quality_that_is_taken_for_tags_is_told(capfd):
    told = "counts as tags, since its numbers are whole: {} vertices are not free. If it is something else (a label, a measure), choose 'Tags of the layer' (4)"
    ms, _ = pair()
    source = ms.current_mesh().id()
    set_quality(ms, "z < 0.5 ? 0 : 1")
    fixed = np.count_nonzero(ms.current_mesh().vertex_scalar_array() == 0)
    for handles, is_told in ((0, True), (4, False)):
        ms.set_current_mesh(source)
        assert (told.format(fixed) in fit_logged(ms, capfd, handles=handles, **FEW)[1]) == is_told
    ms.set_current_mesh(source)
    set_quality(ms, "0")
    ms.compute_selection_by_condition_per_vertex(condselect="z < 0.5")
    ms.apply_filter("compute_fcd_tags_from_selection", role=0)
    assert "counts as tags" not in fit_logged(ms, capfd, **FEW)[1], "they are known to be tags"
    ms.set_current_mesh(source)
    set_quality(ms, "z + 0.125")
    assert "All is free: the vertex quality of 'tube' is not what 'FCD: Tag' wrote" in fit_logged(ms, capfd, **FEW)[1]
    ms.set_current_mesh(source)
    assert fit(ms, handles=4, **FEW)[0]["fixed_vertices"] == fixed


def test_a_quality_is_tags_where_a_filter_for_tags_wrote_it():
    ms, _ = pair()
    source = ms.current_mesh().id()
    set_quality(ms, "z < 0.5 ? 0 : 1")  # as a filter that counts something would leave it
    assert ms.apply_filter(FIT, target_layer=0, handles=4, **FEW)["fixed_vertices"] == 0
    ms.set_current_mesh(source)
    ms.compute_selection_by_condition_per_vertex(condselect="z < 0.5")
    ms.apply_filter("compute_fcd_tags_from_selection", role=0)
    fixed = np.count_nonzero(ms.current_mesh().vertex_scalar_array() == 0)
    for handles in (0, 4):
        ms.set_current_mesh(source)
        assert ms.apply_filter(FIT, target_layer=0, handles=handles, **FEW)["fixed_vertices"] == fixed > 0
