# SPDX-License-Identifier: GPL-3.0-or-later
"""fit and Fitter: one surface laid onto another, without MeshLab."""
import concurrent.futures
import dataclasses
import pickle
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from lumpy_tube import DIAGONAL, LENGTH, bent, rms, round_tube, tube
from shapes import same, with_filters

import pymeshlab_fcd
from pymeshlab_fcd import Curve, Deformation, DeformationWarning, FitInfo, Fitted, Fitter, Motion, Pose, fit, read_curves

VERTICES, FACES = tube()
TRUTH = bent(VERTICES)
TARGET, TARGET_FACES = bent(tube(49, 27, shift=0.5)[0]), tube(49, 27)[1]
CHOSEN = np.arange(5, len(VERTICES), len(VERTICES) // 8)
QUICK = {"patches": 60, "samples": 600, "steps": 40}  # enough for so small a surface


@pytest.fixture(scope="module")
def fitter():
    return Fitter(VERTICES, FACES, **QUICK)


@pytest.fixture(scope="module")
def laid(fitter):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return fitter.fit(TARGET, TARGET_FACES)


def test_it_comes_near_the_truth(laid):
    assert isinstance(laid, Fitted) and isinstance(laid, Pose) and isinstance(laid.info, FitInfo)
    assert rms(laid.vertices, TRUTH) < 0.6 < 5 < rms(VERTICES, TRUTH)
    info = laid.info
    assert info.matched > 0.9 and info.converged and info.folded == 0 and info.steps == info.iterations <= QUICK["steps"]
    assert 0 < info.median <= info.percentile_95 < 0.01 * DIAGONAL and 0 < info.rms < 0.004 * DIAGONAL
    assert info.landmarks == 0 and info.landmark_residual == info.landmark_pull == 0
    assert info.nodes == laid.deformer.info.nodes >= QUICK["patches"] and 1 < info.largest_stretch < 1.5 and info.seconds > 0
    assert np.isnan(info.energy) and np.isnan(info.discretisation_error)
    assert {each.name for each in dataclasses.fields(info)} > {"nodes", "converged", "rms", "median", "percentile_95", "matched"}


def test_it_is_a_pose_with_all_that_one_has(laid):
    assert np.allclose(np.linalg.norm(laid.normals, axis=1), 1)
    assert np.abs(laid.map(VERTICES) - laid.vertices).max() < 1e-6
    saved = laid.deformation()
    assert isinstance(saved, Deformation) and np.abs(saved(VERTICES) - laid.vertices).max() < 1e-3 * DIAGONAL


def test_the_same_bits_in_one_call_and_for_any_threads(fitter, laid):
    assert same(fit(VERTICES, FACES, TARGET, TARGET_FACES, threads=1, **QUICK).vertices, laid.vertices)
    with concurrent.futures.ThreadPoolExecutor(2) as pool:  # at a time
        both = list(pool.map(lambda target: fitter.fit(target, TARGET_FACES.astype(np.int16)), [TARGET.tolist(), np.asfortranarray(TARGET)]))
    assert all(same(each.vertices, laid.vertices) for each in both)


def test_landmarks_are_exact(fitter):
    truth, target = bent(VERTICES, 60.0), bent(tube(49, 27, shift=0.5)[0], 60.0)
    led = fitter.fit(target, TARGET_FACES, landmarks=(CHOSEN, truth[CHOSEN]))
    assert np.abs(led.vertices - truth)[CHOSEN].max() < 1e-12 and rms(led.vertices, truth) < 0.6
    assert led.info.landmarks == len(CHOSEN) and led.info.landmark_residual < 1e-12 and 0 < led.info.landmark_pull < 0.01 * DIAGONAL
    places = VERTICES[CHOSEN] + 0.4 * (VERTICES[CHOSEN + 1] - VERTICES[CHOSEN])
    beside = fitter.fit(target, TARGET_FACES, landmarks=(places, bent(places, 60.0)))
    assert beside.info.landmark_residual < 1e-6 and np.abs(beside.vertices - truth)[CHOSEN].max() < 0.02 * DIAGONAL


def test_landmarks_that_contradict_each_other_are_warned_of(fitter):
    with pytest.warns(DeformationWarning) as caught:
        fitter.fit(TARGET, TARGET_FACES, landmarks=([600, 601], TRUTH[[600, 1600]]))
    assert {each.category for each in caught} >= {pymeshlab_fcd.LandmarkWarning, pymeshlab_fcd.FoldWarning}
    texts = [str(each.message) for each in caught]
    assert any("contradict each other or the target" in text for text in texts)
    assert any("flipped: the fit folds the surface there" in text for text in texts) and all(each.filename == __file__ for each in caught)


def test_pairs_that_the_others_contradict_are_named_and_left_out():
    chosen = np.arange(5, len(VERTICES), 113)
    places = TRUTH[chosen].copy()
    places[[2, 6]] = places[[6, 2]]
    with pytest.warns(DeformationWarning, match="Pairs 2 and 6 of the landmarks, counted from 0, .* mixed up or mistyped; with a landmark_tolerance"):
        torn = fit(VERTICES, FACES, TARGET, TARGET_FACES, landmarks=(chosen, places), **QUICK)
    with pytest.warns(DeformationWarning, match="Pairs 2 and 6 of the landmarks, counted from 0, .* were left out"):
        whole = fit(VERTICES, FACES, TARGET, TARGET_FACES, landmarks=(chosen, places), landmark_tolerance=0.02, **QUICK)
    assert torn.info.contradicted == whole.info.contradicted == (2, 6)
    assert rms(whole.vertices, TRUTH) < 0.6 < 2 < rms(torn.vertices, TRUTH) and whole.info.landmark_residual < 0.02
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert fit(VERTICES, FACES, TARGET, TARGET_FACES, landmarks=(chosen, TRUTH[chosen]), **QUICK).info.contradicted == ()


def test_more_landmarks_than_nodes_fling_nothing_away():
    dense = np.arange(0, len(VERTICES), 4)
    with pytest.warns(DeformationWarning, match="are not met, the worst by .*: the graph is too coarse for them. Begin with 900 patches or more"):
        led = fit(VERTICES, FACES, None, landmarks=(dense, TRUTH[dense]), landmarks_only=True, **{**QUICK, "patches": 30})
    assert np.linalg.norm(led.vertices - TRUTH, axis=1).max() < 0.03 * DIAGONAL and led.info.contradicted == ()


def test_curves_lead_what_slides():
    """A round tube slides about its axis; a line along it tells how far, wherever the vertices are along that."""
    turn = np.array([[np.cos(0.35), -np.sin(0.35), 0], [np.sin(0.35), np.cos(0.35), 0], [0, 0, 1]])
    points, faces = round_tube()
    target, target_faces = round_tube(49, 27)
    target, truth = target @ turn.T, points @ turn.T
    line = np.arange(2, 58) * 30
    corners = np.stack([np.full(9, 0.4), np.zeros(9), np.linspace(0, LENGTH, 9)], 1) @ turn.T
    without = fit(points, faces, target, target_faces, **QUICK)
    led = fit(points, faces, target, target_faces, curves=[(line, corners)], **QUICK)
    assert rms(led.vertices, truth) < 0.2 * rms(without.vertices, truth)
    assert led.info.curve_residual < 1e-3 and without.info.curve_residual == 0
    assert same(led.vertices, fit(points, faces, target, target_faces, curves=[(points[line], corners)], **QUICK).vertices)


def curve_table(lines):
    """Of pairs of corners."""
    return "curve,surface,x,y,z\n" + "".join(f"{k},{surface},{x!r},{y!r},{z!r}\n" for k, line in enumerate(lines)
                                             for surface, side in zip(("source", "target"), line) for x, y, z in side.tolist())


def test_the_search_along_curves_can_be_cancelled(fitter):
    source = np.repeat(VERTICES[:400:8], 2000, axis=0)  # as a scanner of lines gives it
    def stop(percent, stage):
        if stage == "Following the curves":
            raise KeyboardInterrupt
    with pytest.raises(KeyboardInterrupt):
        fitter.fit(TARGET, TARGET_FACES, curves=Curve("edge", source, TRUTH[:400:8]), progress=stop)
    told = []
    fitter.fit(TARGET, TARGET_FACES, curves=Curve("edge", source, TRUTH[:400:8]), progress=lambda percent, stage: told.append((percent, stage)))
    assert [percent for percent, _ in told] == sorted(percent for percent, _ in told) and "Following the curves" in [stage for _, stage in told]


def test_curves_of_a_file_lead_as_those_that_are_given(fitter, tmp_path):
    """Two that are far from each other, one of vertices before, and what is wrong with the line of the file."""
    lines = [(VERTICES[[610, 640, 641]], TRUTH[[610, 640, 641, 642]]), (VERTICES[5:906:90] + 0.001, TRUTH[5:906:30])]
    path = tmp_path / "Kurven \u00e4.csv"
    path.write_text(curve_table(lines))
    read = read_curves(path)
    assert [repr(each.name) for each in read] == ["'0'", "'1'"] and all(same(each.target, line[1]) for each, line in zip(read, lines))
    led = fitter.fit(TARGET, TARGET_FACES, curves=read)
    own = [Curve("own", *line) for line in lines]
    assert led.info.curve_residual > 0 and same(fitter.fit(TARGET, TARGET_FACES, curves=own).vertices, led.vertices)
    assert same(fitter.fit(TARGET, TARGET_FACES, curves=pickle.loads(pickle.dumps(read))).vertices, led.vertices)
    one = fitter.fit(TARGET, TARGET_FACES, curves=read[:1]).vertices
    assert not same(one, led.vertices) and same(one, fitter.fit(TARGET, TARGET_FACES, curves=read[0]).vertices)
    given = [(np.arange(700, 730), TRUTH[700:730]), own[0]]
    assert not same(fitter.fit(TARGET, TARGET_FACES, curves=given).vertices, fitter.fit(TARGET, TARGET_FACES, curves=given[1:]).vertices)
    held = Fitter(VERTICES, FACES, np.where(np.arange(len(VERTICES)) < 800, 0, 1), **QUICK)
    with pytest.raises(ValueError, match=r"Kurven ä\.csv', line 2: the curve '0' lies where nothing of the surface is free"):
        held.fit(TARGET, TARGET_FACES, curves=read)
    lines[1][0][3] += 100
    path.write_text(curve_table(lines))
    with pytest.raises(ValueError, match=r"csv', line 12: the curve '1' is .* from the vertices of the surface there"):
        fitter.fit(TARGET, TARGET_FACES, curves=read_curves(path))
    with pytest.raises(ValueError, match="^the curve 'far' is"):
        fitter.fit(TARGET, TARGET_FACES, curves=[Curve("far", *lines[1])])
    with pytest.raises(ValueError, match="^the curve '0' is"):  # whose last corner the file does not have
        fitter.fit(TARGET, TARGET_FACES, curves=[dataclasses.replace(read[0], source=np.append(read[0].source, lines[1][0][3:4], 0))])
    for text, message in (("curve,x\n", "line 1: expected the first row"), (curve_table(lines).replace("source", "sauce"), "line 2: expected source or target"),
                          ("curve,surface,x,y,z\na,source,0,0,0\n", "needs corners at two places of the source"), ("\0", "zero byte")):
        path.write_text(text)
        with pytest.raises(ValueError, match=message):
            read_curves(path)
    with pytest.raises(FileNotFoundError):
        read_curves(tmp_path / "none.csv")
    for curve, message in ((Curve("a", lines[0][0][:1], TRUTH), "the source of curve 0 has 1 corners"), (Curve("a", TRUTH, TRUTH * np.nan), "the target of curve 0")):
        with pytest.raises(ValueError, match=message):
            fitter.fit(TARGET, TARGET_FACES, curves=[curve])


def test_curves_that_cannot_be(fitter):
    line = np.array([[0.0, 0, 0], [0, 0, 1]])
    for curves, error, text in [([([5], line[:1])], ValueError, "has 1 corners"), ([line[0]], TypeError, "curve 0 must be a pair"),
                                ([([5], line), ([9], line * np.nan)], ValueError, "the second of curve 1"),
                                ([([10 ** 6], line)], ValueError, "the first of curve 0 must be numbers of vertices")]:
        with pytest.raises(error, match=text):
            fitter.fit(TARGET, TARGET_FACES, curves=curves)
    alone = Fitter(VERTICES, FACES, landmarks_only=True, **QUICK)
    with pytest.raises(ValueError, match="leave landmarks_only out"):
        alone.fit(landmarks=(CHOSEN, TRUTH[CHOSEN]), curves=[([5], line)])


def test_a_target_that_lies_elsewhere_or_is_another():
    with pytest.warns(DeformationWarning, match="did not overlap: they were .* apart, so the fit first moved the surface onto the target's middle"):
        far = fit(VERTICES, FACES, TARGET + [500, 0, -200], TARGET_FACES, **QUICK)
    assert far.info.from_afar and rms(far.vertices, TRUTH + [500, 0, -200]) < 0.6
    with pytest.warns(DeformationWarning) as caught:
        fit(VERTICES, FACES, TARGET * 100, TARGET_FACES, **{**QUICK, "steps": 5})
    texts = [str(each.message) for each in caught]
    assert any("times larger than the surface. If the two have other units" in text for text in texts)
    assert not any("raise steps" in text for text in texts), "which is no help then"
    with pytest.warns(DeformationWarning, match="The target is flat: the fit has pressed all matched parts") as caught:
        fit(VERTICES, FACES, TARGET * [1, 1, 0] + [0, 0, 2], **{**QUICK, "steps": 5})
    assert any("pass through others" in text and text.endswith("Give landmarks, or raise stiffness.") for text in map(str, (each.message for each in caught)))


def bar(around, length=8):
    """An open box, bent a little: around points on each of its four sides."""
    u = np.arange(4 * around) / around
    side = np.floor(u).astype(int)
    corner = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], float)
    ring = corner[side] + (corner[side + 1] - corner[side]) * (u - side)[:, None]
    z = np.linspace(0, length, around * length + 1)
    points = np.column_stack([np.tile(ring, (len(z), 1)), np.repeat(z, len(ring))])
    here = np.arange(len(ring) * (len(z) - 1))
    beside = here - here % len(ring) + (here + 1) % len(ring)
    above = len(ring)
    faces = np.concatenate([np.stack([here, beside, beside + above], 1), np.stack([here, beside + above, here + above], 1)])
    points[:, 0] += 0.4 * (points[:, 2] / length) ** 2
    return points, faces.astype(np.int32)


def test_a_surface_that_lies_across_its_target():
    """Little of it meets the target, and nothing strains it."""
    points, faces = bar(10)
    target, target_faces = bar(11)
    across = target @ [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeformationWarning)
        laid = fit(points, faces, across, target_faces)
    assert laid.info.matched > 0.95


def test_a_target_that_is_mirrored_by_negating_a_coordinate_is_told():
    """Its faces look inwards, and it is as smooth as the surface: a fit does not come to rest, but not since there is noise."""
    n, k = 90, 45
    a, w = (grid.ravel() for grid in np.meshgrid(2 * np.pi * np.arange(n) / n, np.linspace(0.02, np.pi - 0.02, k), indexing="ij"))
    vertices = np.stack([2 * np.sin(w) * np.cos(a), np.sin(w) * np.sin(a), 0.7 * np.cos(w) + 0.1 * np.sin(3 * a) * np.sin(w)], 1)
    i, j = ((column[:, None] * k + np.arange(k - 1)).ravel() for column in (np.arange(n), (np.arange(n) + 1) % n))
    faces = np.concatenate([np.stack([i, i + 1, j], 1), np.stack([j, i + 1, j + 1], 1)])
    target = vertices + np.stack([0 * a, 0.025 * vertices[:, 0] ** 2, 0.15 * np.sin(1.5 * vertices[:, 0])], 1)
    with pytest.warns(DeformationWarning, match="looks like the mirror image"):
        fit(vertices, faces, target * [1, -1, 1], faces)


def test_what_has_no_counterpart_is_told_why():
    with pytest.raises(ValueError, match="nothing of the surface has a counterpart .* as start= does .* times smaller than the surface"):
        fit(VERTICES, FACES, TARGET / 1000, TARGET_FACES, **QUICK)


def test_a_stray_point_of_the_target_changes_nothing_of_its_shape(fitter):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        fitted = fitter.fit(np.vstack([TARGET, [1e12, 1e12, 0]]))
    assert rms(fitted.vertices, TRUTH) < 2 and not any("flat" in str(each.message) for each in caught)


def test_what_is_not_finite_is_left_out_of_the_target(fitter):
    gaps = np.arange(len(TARGET)) % 3 == 1
    holed, normals = TARGET.copy(), np.ones_like(TARGET)
    holed[gaps], normals[gaps] = np.nan, np.nan
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # so coarse a cloud
        onto, clean = fitter.fit(holed), fitter.fit(TARGET[~gaps])
        assert fitter.fit(holed, target_normals=normals).info.target_not_finite == gaps.sum()
    assert onto.info.target_not_finite == gaps.sum() and clean.info.target_not_finite == 0
    assert same(onto.vertices, clean.vertices)
    carried = onto.map(holed)  # as in fitting
    assert np.isnan(carried[gaps]).all() and same(carried[~gaps], onto.map(TARGET[~gaps]))


def test_faces_count_once_and_look_to_one_side(laid):
    for faces in (np.vstack([TARGET_FACES, TARGET_FACES[:, ::-1]]), np.where(np.arange(len(TARGET_FACES))[:, None] % 2, TARGET_FACES, TARGET_FACES[:, ::-1])):
        other = fit(VERTICES, FACES, TARGET, faces, **QUICK)
        assert rms(other.vertices, laid.vertices) < 0.02 and other.info.matched == laid.info.matched


def test_fixed_vertices_keep_their_bits_and_handles_move_as_told():
    tags = np.where(VERTICES[:, 2] < 0.3, 0, np.where(VERTICES[:, 2] > LENGTH - 0.1, 2, 1))
    held = fit(VERTICES, FACES, TARGET, TARGET_FACES, tags=tags, transforms={2: Motion.translate([0.5, 0, 0])}, **QUICK)
    assert same(held.vertices[tags == 0], VERTICES[tags == 0])
    assert np.abs(held.vertices[tags == 2] - VERTICES[tags == 2] - [0.5, 0, 0]).max() < 1e-12
    middle = (VERTICES[:, 2] > 1) & (VERTICES[:, 2] < 3)
    assert rms(held.vertices[middle], TRUTH[middle]) < 1.5
    assert held.deformer.info.fixed == (tags == 0).sum() and held.deformer.handles == (2,)


def test_clouds(fitter):
    target, faces = bent(tube(90, 45, shift=0.5)[0]), tube(90, 45)[1]
    onto = fitter.fit(target)
    assert rms(onto.vertices, TRUTH) < 1 and onto.info.matched > 0.8
    normals = np.zeros_like(target)
    corner = target[faces]
    for k in range(3):
        np.add.at(normals, faces[:, k], np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]))
    sided = fitter.fit(target, target_normals=normals)
    assert rms(sided.vertices, TRUTH) < 1 and not same(sided.vertices, onto.vertices)
    both = fit(VERTICES, None, target, **QUICK)
    assert both.deformer.faces is None and rms(both.vertices, TRUTH) < 1.5


@pytest.mark.parametrize("times", [2, 6])
def test_points_at_one_place_count_once_as_a_target(fitter, times):
    """As the corners of triangles do that are not joined, and scans that were put together twice."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        once = fitter.fit(TARGET)
        doubled = fitter.fit(np.tile(TARGET, (times, 1)))
    assert same(doubled.vertices, once.vertices) and doubled.info.matched == once.info.matched


@pytest.mark.parametrize("start, scale", [("landmarks_rigid", 1), ("landmarks_similar", 1.3), ("axes", 1)])
def test_a_surface_that_lies_elsewhere(start, scale):
    away = scale * VERTICES @ np.array([[0, 0, 1], [0, -1, 0], [1, 0, 0]]) + [3, -4, 5]
    landmarks = None if start == "axes" else (CHOSEN, TRUTH[CHOSEN])
    laid = fit(away, FACES, TARGET, TARGET_FACES, landmarks=landmarks, start=start, **QUICK)
    assert laid.info.matched > 0.9 and laid.info.rms < 0.004 * DIAGONAL
    assert landmarks is None or np.abs(laid.vertices - TRUTH)[CHOSEN].max() < 1e-12


@pytest.mark.parametrize("start, scale", [("landmarks_rigid", 1), ("landmarks_similar", 0.001)])
def test_places_turn_and_grow_with_the_surface(start, scale):
    """As landmarks, and as pairs to check."""
    def there(points):
        return scale * points @ np.array([[0, 0, 1], [0, -1, 0], [1, 0, 0]]) + [3, -4, 5]

    def between(vertices):
        return VERTICES[vertices] + 0.4 * (VERTICES[vertices + 1] - VERTICES[vertices])

    others = CHOSEN + 11
    laid = fit(VERTICES, FACES, there(VERTICES), FACES, landmarks=(between(CHOSEN), there(between(CHOSEN))),
               check=(between(others), there(between(others))), start=start, **QUICK)
    assert np.abs(laid.vertices - there(VERTICES))[CHOSEN].max() < 1e-4 * scale * DIAGONAL
    assert max(laid.info.check) < 1e-3 * scale * DIAGONAL


def ball(middle, radius, around=16):
    """(vertices, faces)"""
    a, b = (each.ravel() for each in np.meshgrid(2 * np.pi * np.arange(around) / around, np.linspace(0.1, np.pi - 0.1, 9), indexing="ij"))
    i = (np.arange(around)[:, None] * 9 + np.arange(8)).ravel()
    j = ((np.arange(around)[:, None] + 1) % around * 9 + np.arange(8)).ravel()
    return radius * np.stack([np.sin(b) * np.cos(a), np.sin(b) * np.sin(a), np.cos(b)], 1) + middle, np.vstack([np.c_[i, i + 1, j], np.c_[j, i + 1, j + 1]])


def test_a_part_without_a_counterpart_is_carried():
    eye, corners = ball([0.15, 0, 3], 0.3)
    both, faces = np.vstack([VERTICES, eye]), np.vstack([FACES, corners + len(VERTICES)])
    weights = np.arange(len(both)) < len(VERTICES)
    for given in ({}, {"weights": weights}, {"weights": weights.astype(np.float32).tolist()}):
        laid = fit(both, faces, TARGET, TARGET_FACES, **given, **{**QUICK, "steps": 60})
        assert rms(laid.vertices[weights], TRUTH) < 0.6 and rms(laid.vertices[~weights], bent(eye)) < 0.8
        assert laid.info.carried == 1 and laid.info.matched > 0.7 and (laid.info.counted < 1) == bool(given)
    fitter = pickle.loads(pickle.dumps(Fitter(both, faces, weights=weights, **{**QUICK, "steps": 60})))
    assert same(fitter.fit(TARGET, TARGET_FACES).vertices, laid.vertices)


def test_what_does_not_count_of_the_target_is_as_if_it_were_not_there(fitter, laid):
    beside, corners = ball([0.6, 0, 2], 0.3)
    both = np.vstack([TARGET, beside])
    counts = np.arange(len(both)) < len(TARGET)
    assert same(fitter.fit(both, np.vstack([TARGET_FACES, corners + len(TARGET)]), target_weights=counts).vertices, laid.vertices)
    assert same(fit(VERTICES, FACES, both, target_weights=counts, **QUICK).vertices, fitter.fit(TARGET).vertices)


def test_it_is_judged_by_what_it_does_not_see(fitter, laid):
    kept = np.arange(60, len(VERTICES), 200)
    wrong = TRUTH[kept] + np.where(np.arange(len(kept))[:, None] == 2, 0.2, 0)
    judged = fitter.fit(TARGET, TARGET_FACES, check=(kept, wrong))
    assert same(judged.vertices, laid.vertices) and laid.info.check == ()
    assert np.allclose(judged.info.check, np.linalg.norm(laid.vertices[kept] - wrong, axis=1)) and np.argmax(judged.info.check) == 2
    beside = laid.map(VERTICES[kept] + [0, 0, 1e-3]) - laid.vertices[kept]  # the way to the place turns with the surface
    places = fitter.fit(TARGET, TARGET_FACES, check=(VERTICES[kept] + [0, 0, 1e-3], wrong + beside))
    assert np.allclose(places.info.check, judged.info.check, atol=1e-4)
    assert 0 < laid.info.moved < laid.info.moved_most < DIAGONAL and laid.info.leave_one_out == ()
    chosen = CHOSEN[::2]
    places = TRUTH[chosen] + np.where(np.arange(len(chosen))[:, None] == 1, [0, 0.3, 0], 0)
    for alone in (False, True):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            left = fit(VERTICES, FACES, TARGET, TARGET_FACES, landmarks=(chosen, places), leave_one_out=True, landmarks_only=alone, **QUICK).info
            rest = np.arange(len(chosen)) != 1
            without = fit(VERTICES, FACES, TARGET, TARGET_FACES, landmarks=(chosen[rest], places[rest]), landmarks_only=alone, **QUICK).vertices
        assert len(left.leave_one_out) == len(chosen) and left.landmark_residual < 1e-9
        assert abs(left.leave_one_out[1] - np.linalg.norm(without[chosen[1]] - places[1])) < 1e-4
    with pytest.raises(TypeError, match="check must be a pair"):
        fitter.fit(TARGET, TARGET_FACES, check=[1])
    with pytest.raises(ValueError, match="the second of check must have 1 rows"):
        fitter.fit(TARGET, TARGET_FACES, check=([1], wrong))


def test_what_is_guessed_is_told(laid):
    truth, (part, faces) = bent(VERTICES, 60.0), tube(25, 27, end=LENGTH / 2)
    with pytest.warns(pymeshlab_fcd.MatchWarning, match="percent of the surface have no counterpart: their place is a guess that may be off by about"):
        half = fit(VERTICES, FACES, bent(part, 60.0), faces, **QUICK)
    off = np.linalg.norm(half.vertices - truth, axis=1)[VERTICES[:, 2] > LENGTH / 2]
    assert abs(half.info.guessed - 0.5) < 0.1 and 0.4 < half.info.guess_error / np.sqrt((off ** 2).mean()) < 2.5
    assert laid.info.guessed < 0.1


def test_little_that_is_matched_is_warned_of(fitter):
    part, faces = tube(8, 27, end=0.4)
    with pytest.warns(pymeshlab_fcd.MatchWarning, match="do not trust the rest"):
        laid = fit(VERTICES, FACES, bent(part), faces, largest_distance=0.01 * DIAGONAL, **QUICK)
    assert laid.info.matched < 0.3
    with pytest.warns(pymeshlab_fcd.NotAtRestWarning, match="did not converge: raise steps"):
        fit(VERTICES, FACES, TARGET, TARGET_FACES, **{**QUICK, "steps": 2})


def test_progress_goes_on_and_ends_it():
    told = []
    fit(VERTICES, FACES, TARGET, TARGET_FACES, progress=lambda percent, stage: told.append(percent), **QUICK)
    assert told == sorted(told) and told[-1] == 100 and len(told) > 5

    def stop(percent, stage):
        raise KeyboardInterrupt
    with pytest.raises(KeyboardInterrupt):
        fit(VERTICES, FACES, TARGET, TARGET_FACES, progress=stop)


def test_meshes_of_other_libraries(laid):
    trimesh = pytest.importorskip("trimesh")
    mesh, target = (trimesh.Trimesh(*each, process=False) for each in ((VERTICES, FACES), (TARGET, TARGET_FACES)))
    assert same(np.asarray(fit(mesh, None, target, **QUICK).mesh().vertices), laid.vertices)
    for call in (lambda: fit(mesh, target, **QUICK), lambda: fit(mesh, TARGET, TARGET_FACES, **QUICK), lambda: fit(mesh, TARGET, target_faces=TARGET_FACES, **QUICK),
                 lambda: fit(VERTICES, FACES, target, **QUICK),
                 lambda: fit(mesh, target_vertices=target, **QUICK), lambda: Fitter(mesh, **QUICK).fit(target)):
        assert same(call().vertices, laid.vertices)
    with pytest.raises(TypeError, match="target_faces cannot be given beside a mesh"):
        fit(mesh, None, target, TARGET_FACES)
    with pytest.raises(TypeError, match="faces cannot be given beside a mesh"):
        fit(mesh, FACES, target)


def test_landmarks_alone():
    places = VERTICES[CHOSEN] + [0.3, 0, 0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        led = fit(VERTICES, FACES, None, landmarks=(CHOSEN, places), landmarks_only=True, **QUICK)
    assert rms(led.vertices, VERTICES + [0.3, 0, 0]) < 1e-3 and same(led.vertices[CHOSEN], places)
    assert led.info.matched == 0 and led.info.landmarks == len(CHOSEN)
    # A target changes nothing; without landmarks there is nothing to follow, and without landmarks_only, a target is needed.
    assert same(fit(VERTICES, FACES, TARGET, landmarks=(CHOSEN, places), landmarks_only=True, **QUICK).vertices, led.vertices)
    with pytest.raises(ValueError, match="there are no landmarks to follow"):
        fit(VERTICES, FACES, None, landmarks_only=True, **QUICK)
    with pytest.raises(ValueError, match="the target has no vertices"):
        fit(VERTICES, FACES, None, landmarks=(CHOSEN, places), **QUICK)


def test_without_rigidity_what_is_sheared_all_over_is_found():
    sheared = VERTICES @ np.array([[1.2, 0.3, 0], [0, 0.9, -0.2], [0.1, 0, 1.1]])
    led = np.arange(5, len(VERTICES), 97)
    far = [rms(fit(VERTICES, FACES, landmarks=(led, sheared[led]), landmarks_only=True, rigidity=rigidity, **QUICK).vertices, sheared)
           for rigidity in (1, 0.5, 0)]
    assert 20 * far[2] < far[1] < far[0]


@pytest.mark.parametrize("kind", ["plain", "alone", "curves"])
def test_the_same_bits_as_the_filter(tmp_path, kind):
    pymeshlab = with_filters()
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(TARGET, TARGET_FACES))
    ms.add_mesh(pymeshlab.Mesh(VERTICES, FACES))
    given, files = {}, {}
    if kind == "alone":
        given, files = {"landmarks": (CHOSEN, TRUTH[CHOSEN]), "landmarks_only": True, "rigidity": 0.3}, {"landmarks_file": str(tmp_path / "landmarks.csv")}
        np.savetxt(files["landmarks_file"], np.column_stack([CHOSEN, TRUTH[CHOSEN]]), ["%d"] + ["%.17g"] * 3)
    if kind == "curves":
        lines = [(VERTICES[[610, 640, 641]], TRUTH[[610, 640, 641, 642]]), (VERTICES[5:906:90] + 0.001, TRUTH[5:906:30])]
        files = {"curves_file": str(tmp_path / "curves.csv")}
        (tmp_path / "curves.csv").write_text(curve_table(lines))
        given = {"curves": read_curves(files["curves_file"])}
        assert [each.name for each in given["curves"]] == ["0", "1"] and same(given["curves"][1].source, lines[1][0])
    ms.apply_filter("generate_fcd_fitted_mesh", target_layer=0, graph_layers=False, initial_patches=QUICK["patches"], samples=QUICK["samples"],
                    fit_steps=QUICK["steps"], landmarks_only=kind == "alone", rigidity=given.get("rigidity", 1), **files)
    assert same(fit(VERTICES, FACES, TARGET, TARGET_FACES, **given, **QUICK).vertices, np.ascontiguousarray(ms.current_mesh().vertex_matrix()))


@pytest.mark.filterwarnings("ignore::pymeshlab_fcd.DeformationWarning")
@pytest.mark.parametrize("points", [0, 1, 2, 3])
def test_few_points(points):
    if points == 0:
        with pytest.raises(ValueError, match="There is nothing to fit: the surface has no vertices"):
            fit(VERTICES[:0], None, TARGET, TARGET_FACES)
    elif points == 1:
        with pytest.raises(ValueError, match="only single vertices are free"):
            fit(VERTICES[:1], None, TARGET, TARGET_FACES)
    else:
        assert np.isfinite(fit(VERTICES[:points], None, TARGET, TARGET_FACES).vertices).all()


FIXED = np.where(VERTICES[:, 2] < 0.3, 0, 1)
NOWHERE = np.array([[0, 0, 0.0], [0, 0, 1]])


@pytest.mark.parametrize("target, given, message", [
    (np.zeros((0, 3)), {}, "the target has no vertices"),
    (TARGET + 100, {"largest_distance": 1}, "nothing of the surface has a counterpart on the target"),
    (TARGET * np.nan, {}, "The target has no vertices whose coordinates are finite numbers"),
    (TARGET * np.nan, {"target_faces": [[0, 1, 2]]}, "The target has no vertices whose coordinates are finite numbers"),
    (TARGET[:1], {}, "All of the target lies at one point or on one line"),
    (TARGET * [0, 0, 1], {}, "All of the target lies at one point or on one line"),
    (TARGET[:, :2], {}, "target_vertices must be n x 3"),
    (TARGET, {"target_faces": [[0, 1, 9999]]}, "target_faces must hold numbers of vertices"),
    (TARGET, {"target_faces": [[0, 1, 1]]}, "The target has no triangle with an area"),
    (TARGET, {"vertices": VERTICES * [0, 0, 1]}, "The surface has no triangle with an area where it is free to bend"),
    (TARGET, {"vertices": np.outer(VERTICES[:, 2], [0.3, 0.2, 1])}, "The surface has no triangle with an area where it is free to bend"),
    (TARGET, {"faces": FACES[:, [0, 1, 1]]}, "The surface has no triangle with an area where it is free to bend"),
    (TARGET * 1e77, {"target_faces": TARGET_FACES}, "The target is about .e.7[67] times larger than the surface. Scale one of them first"),
    (TARGET * 1e-12, {}, "The target is about .e.1[12] times smaller than the surface. Scale one of them first"),
    (TARGET, {"vertices": VERTICES[:1], "faces": None, "landmarks": ([0], NOWHERE[:1])}, "There is nothing to fit: only single vertices are free"),
    (TARGET, {"vertices": np.r_[VERTICES, [[0, 0, 9]]], "landmarks": ([len(VERTICES)], NOWHERE[:1])}, "Landmark 1 is at a vertex of a loose part"),
    (TARGET, {"target_normals": TARGET * np.nan}, "target_normals must be finite"),
    (TARGET, {"tags": 0 * FIXED}, "There is nothing to fit: no vertex is free"),
    (TARGET, {"transforms": {2: np.eye(4)}}, "no vertex has tag 2"),
    (TARGET, {"landmarks": ([900, 900], NOWHERE)}, "Landmark 2 is at the place of another one"),
    (TARGET, {"landmarks": ([900, 0], NOWHERE), "tags": FIXED}, "Landmark 2 is at a vertex that is not free"),
    (TARGET, {"landmarks": ([900, 9999], NOWHERE)}, "the first of landmarks must be numbers of vertices, 0 to"),
    (TARGET, {"landmarks": ([900], NOWHERE)}, "the second of landmarks must have 1 rows, one for each of the first"),
    (TARGET, {"landmarks": ([900, 901], NOWHERE * np.nan)}, "the second of landmarks must be finite"),
    (TARGET, {"landmarks": (NOWHERE * np.nan, NOWHERE)}, "the first of landmarks must be finite"),
    (TARGET, {"start": "landmarks_rigid"}, "A start from landmarks needs three of them"),
    (TARGET, {"start": "axes", "tags": FIXED}, "A start cannot move the surface"),
    (TARGET, {"start": "moments"}, "start must be one of 'as_they_lie', 'landmarks_rigid', 'landmarks_similar', 'axes'"),
    (TARGET, {"stiffness": 0}, "The stiffness must be from 1e-6 to 1e6"),
    (TARGET, {"stiffness": 1e300}, "The stiffness must be from 1e-6 to 1e6"),
    (TARGET, {"smoothness": 1e300}, "The smoothness of a fit must be at most 1e6"),
    (TARGET, {"rigidity": 2}, "The rigidity must be from 0"),
    (TARGET, {"largest_distance": -1}, "largest distance of matches must be positive"),
    (TARGET, {"largest_angle": 200}, "largest angle of matches"),
    (TARGET, {"samples": 5}, "At least 100 places"),
    (TARGET, {"samples": 2**31 - 1}, "at most 1000000"),
    (TARGET, {"weights": np.ones(3)}, "weights must be 1800 numbers, one for each vertex"),
    (TARGET, {"weights": np.full(len(VERTICES), np.nan)}, "weights must be from 0 .* that of vertex 0 is nan"),
    (TARGET, {"weights": np.arange(len(VERTICES)) / 2}, "weights must be from 0 .* that of vertex 3 is 1.5"),
    (TARGET, {"weights": np.zeros(len(VERTICES))}, "The weights of the surface are 0 wherever it is free"),
    (TARGET, {"target_weights": np.zeros(len(TARGET))}, "The weights of the target are 0 everywhere"),
    (TARGET, {"target_weights": np.ones(4)}, "target_weights must be 1323 numbers, one for each vertex"),
    (TARGET, {"steps": 1}, "A fit takes 2 to 10000 steps"),
])
def test_what_cannot_be_taken(target, given, message):
    with pytest.raises(ValueError, match=message):
        fit(**{"vertices": VERTICES, "faces": FACES, "target_vertices": target, **QUICK, **given})


def test_what_has_no_solution():
    x = np.linspace(0, 1, 60)
    line = np.concatenate([np.stack([x, y + 0 * x, 0 * x], 1) for y in (0, 1e-10)])
    i = np.arange(59)
    faces = np.concatenate([np.stack([i, i + 1, i + 60], 1), np.stack([i + 1, i + 61, i + 60], 1)])
    with pytest.raises(RuntimeError, match="Take stiffness and smoothness nearer to their defaults"):
        fit(line, faces, TARGET, TARGET_FACES, landmarks=([0, 59], [[0, 0, 0], [1, 0, 0.1]]), **QUICK)


@pytest.mark.parametrize("landmarks", [[900], CHOSEN, {"a": 1}])
def test_landmarks_are_a_pair(fitter, landmarks):
    with pytest.raises(TypeError, match="landmarks must be a pair"):
        fitter.fit(TARGET, TARGET_FACES, landmarks=landmarks)


def test_the_example_lays_a_template_onto_a_scan(tmp_path):
    trimesh = pytest.importorskip("trimesh")

    def there(points):
        return 1.2 * points[:, [1, 2, 0]] + [3, -2, 1]  # a third of a turn, and larger
    trimesh.Trimesh(VERTICES, FACES, process=False).export(tmp_path / "template.ply")
    trimesh.PointCloud(there(TARGET)).export(tmp_path / "scan.ply")
    np.savetxt(tmp_path / "landmarks.csv", np.hstack([VERTICES[CHOSEN], there(TRUTH[CHOSEN])]), delimiter=",", header="template, scan")
    example = Path(__file__).resolve().parents[2] / "examples" / "fit_template.py"
    done = subprocess.run([sys.executable, str(example), "template.ply", "scan.ply", "landmarks.csv", "fitted.ply"], cwd=tmp_path, text=True,
                          capture_output=True, timeout=100)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("100 % have a counterpart")
    assert rms(trimesh.load(tmp_path / "fitted.ply", process=False).vertices, there(TRUTH)) < 0.5 * 1.2


@pytest.mark.parametrize("size", [2.0**-900, 2.0**600])
def test_surfaces_of_any_size_are_fitted_alike(size):
    """Squares of such lengths are no numbers. Landmarks are met to the bit."""
    def laid(by):
        return fit(VERTICES * by, FACES, TARGET * by, TARGET_FACES, landmarks=(CHOSEN, TRUTH[CHOSEN] * by), check=(CHOSEN[:1] + 1, TRUTH[CHOSEN[:1] + 1] * by), **QUICK)

    usual, odd = laid(1), laid(size)
    assert same(odd.vertices / size, usual.vertices) and same(usual.vertices[CHOSEN], TRUTH[CHOSEN])
    for name in ("rms", "median", "percentile_95", "landmark_residual", "landmark_pull", "moved"):
        assert getattr(odd.info, name) / size == getattr(usual.info, name), name
    assert odd.info.matched == usual.info.matched and odd.info.check[0] / size == usual.info.check[0] > 0
