# SPDX-License-Identifier: GPL-3.0-or-later
"""Restoring the symmetry of a layer, inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import re

import numpy as np
import pymeshlab
import pytest
from job_data import MIRROR, ball, bent, skull

from host_pymeshlab import COPY, SURFACE_RETURNS, assert_unchanged, check_returned, new_set, point_file, snapshot

SYMMETRIZE = "generate_fcd_symmetrized_mesh"
DEFAULTS = {
    "pairs_file": "", "midline_file": "", "plane_point": [0, 0, 0], "plane_normal": [0, 0, 0], "weights": 0, "weight_attribute": "fcd_weight",
    "mirror_missing": False, "stiffness": 1, "largest_distance": 0, "landmark_tolerance": 0, "initial_patches": 150, "smoothness": 0.0058,
    "random_seed": 1, "samples": 6000, "fit_steps": 50, "graph_layers": True, "symmetrized_quality": 1}
RETURNS = {
    **SURFACE_RETURNS, **{f"plane_{what}_{axis}": float for what in ("point", "normal") for axis in "xyz"}, "plane_is_sure": bool,
    "rms_before": float, "rms_after": float, "asymmetry": float, "asymmetry_most": float, "moved": float, "moved_most": float, "matched": float,
    "pairs": int, "midline_points": int, "mirrored_vertices": int, "folded_triangles": int, "contact_triangles": int, "contact_depth": float, "nodes": int, "converged": bool, "seconds": float}


def off(points, truth):
    """After the best rigid motion, in percent of the diagonal."""
    a, b = points - points.mean(0), truth - truth.mean(0)
    u, _, v = np.linalg.svd(a.T @ b)
    turn = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    return 100 * np.sqrt(((a @ turn - b) ** 2).sum(1).mean()) / np.linalg.norm(np.ptp(truth, axis=0))


AT, FACES = ball(50, 70)
TRUTH, FACES = skull(AT, 1), FACES.astype(np.int32)


def layers(points=None, faces=FACES):
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=bent(TRUTH) if points is None else points, face_matrix=faces), "skull")
    return ms


def landmarks(count=14):
    random = np.random.default_rng(4)
    side = random.normal(size=(count, 3))
    side /= np.linalg.norm(side, axis=1)[:, None]
    return bent(skull(side, 1)), bent(skull(side * MIRROR, 1))


def logged(ms, capfd, **parameters):
    """(returned values, log). After an error in any filter pymeshlab logs no more, hence these tests come first."""
    ms.set_verbosity(True)
    capfd.readouterr()
    result = ms.apply_filter(SYMMETRIZE, **parameters)
    return result, capfd.readouterr().err


def test_what_is_done_is_logged(capfd):
    ms = layers()
    result, log = logged(ms, capfd)
    check_returned(result, RETURNS)
    assert "as the surface tells it" in log and "(rms) from its mirror image" in log and result["plane_is_sure"] and result["converged"]
    assert off(ms.current_mesh().vertex_matrix(), TRUTH) < 0.2 and off(bent(TRUTH), TRUTH) > 0.8
    assert result["rms_after"] < 0.1 * result["rms_before"] and 0 < result["moved"] < result["asymmetry"] < result["asymmetry_most"]
    assert ms.current_mesh().vertex_scalar_array().max() == pytest.approx(result["asymmetry_most"], rel=0.3)
    assert [ms.mesh(i).label() for i in range(4)] == ["skull", "skull graph", "skull deformed graph", "skull symmetrized"]
    other = 0.9 * bent(TRUTH)
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=other), "inside")
    ms.apply_filter(COPY, source_layer=0, rest_graph=1, deformed_graph=2)
    assert off(ms.current_mesh().vertex_matrix(), 0.9 * TRUTH) < 0.4


def test_what_is_not_sure_is_warned_of(capfd):
    at = TRUTH / np.linalg.norm(TRUTH, axis=1)[:, None]
    egg = at * [1.0, 0.8, 0.6] * (1 + 0.2 * at[:, 2:])
    assert "nearly as much like its mirror image in another plane" in logged(layers(egg), capfd)[1]


def test_points_far_from_the_layer_are_told(capfd, tmp_path):
    left, right = landmarks(6)
    left[3] += [30, 0, 0]
    pairs = point_file(tmp_path / "pairs.csv", "coordinates", None, left, right)
    midline = tmp_path / "midline.csv"
    midline.write_text("0, 1, 0\n0, -30, 0\n0, 0, -30\n")
    log = logged(layers(), capfd, pairs_file=pairs, midline_file=str(midline), landmark_tolerance=0.05, samples=300, initial_patches=60, graph_layers=False)[1]
    assert re.search(r"Point 3 of '.*pairs.csv', counted from 0, is [23]\d\.\S* from 'skull', which is [34]\.\S+ large", log)
    assert re.search(r"Points 1, 2 of '.*midline.csv', counted from 0, are up to [23]\d\.\S* from 'skull', which", log)


def test_the_good_side_is_mirrored(capfd):
    gone = ((TRUTH - [0.6, 0.3, 0.3]) ** 2).sum(1) < 0.15
    number = np.cumsum(~gone) - 1
    faces = number[FACES[(~gone)[FACES].all(axis=1)]].astype(np.int32)
    ms = layers(bent(TRUTH)[~gone], faces)
    result, log = logged(ms, capfd, mirror_missing=True, graph_layers=False, symmetrized_quality=3)
    assert off(ms.current_mesh().vertex_matrix(), TRUTH[~gone]) < 0.3 and "mirrored over what is missing" in log
    missing = ms.mesh(1)
    assert missing.label() == "skull mirrored" and result["mirrored_vertices"] == missing.vertex_number() > 50
    matched = ms.current_mesh().vertex_scalar_array()
    assert set(np.unique(matched)) == {0, 1} and missing.face_number() > 50


def test_parameters_names_order_and_defaults():
    assert SYMMETRIZE in pymeshlab.filter_list()
    values = layers().filter_parameter_values(SYMMETRIZE)
    assert list(values) == list(DEFAULTS)
    for key, value in DEFAULTS.items():
        assert np.allclose(values[key], value) if not isinstance(value, str) else values[key] == value, key


def test_landmarks_from_files(tmp_path):
    left, right = landmarks()
    pairs = tmp_path / "pairs.csv"
    pairs.write_text("\n".join(", ".join(map(repr, [*a, *b])) for a, b in zip(left.tolist(), right.tolist())) + "\n")
    middle = np.argsort(np.abs(TRUTH[:, 0]))[:4]
    midline = tmp_path / "midline.csv"
    midline.write_text("\n".join(", ".join(map(repr, p)) for p in bent(TRUTH)[middle].tolist()) + "\n")
    ms = layers()
    result = ms.apply_filter(SYMMETRIZE, pairs_file=str(pairs), midline_file=str(midline))
    assert result["pairs"] == 14 and result["midline_points"] == 4 and off(ms.current_mesh().vertex_matrix(), TRUTH) < 0.2
    plane = [[result[f"plane_{what}_{axis}"] for axis in "xyz"] for what in ("point", "normal")]
    assert np.abs((ms.current_mesh().vertex_matrix()[middle] - plane[0]) @ plane[1]).max() < 1e-9
    ms.set_current_mesh(0)
    ms.apply_filter(SYMMETRIZE, plane_point=plane[0], plane_normal=plane[1], symmetrized_quality=2)
    assert off(ms.current_mesh().vertex_matrix(), TRUTH) < 0.2


def test_a_plane_in_which_the_surface_is_pressed_together_is_told():
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=np.array([[1.36, 1.22, -0.51], [-0.3, -0.53, 0.57], [-0.06, 0.75, -1.85]])))
    with pytest.raises(pymeshlab.PyMeshLabException, match="not at all like its mirror image in this plane"):
        ms.apply_filter(SYMMETRIZE, plane_point=np.array([1.57, -0.1, 0.68]), plane_normal=np.array([-0.14, -0.38, 0.46]))


def test_random_points_are_told_before_any_fit():
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=np.random.default_rng(8).uniform(size=(150, 3))))
    with pytest.raises(pymeshlab.PyMeshLabException, match="as much like its mirror image in any plane as in another one. Give pairs, a midline or the plane"):
        ms.apply_filter(SYMMETRIZE)


def test_an_error_leaves_the_document_as_it_was(tmp_path):
    far = tmp_path / "far.csv"
    far.write_text("999999, 0, 0, 0\n")
    twice = tmp_path / "twice.csv"
    twice.write_text("0, 0, 0, 0\n0, 1, 0, 0\n")
    for parameters, text in ((dict(pairs_file=str(far)), "names vertex 999999, but the layer has vertices 0 to 3499"), (dict(pairs_file=str(twice)), "named twice"),
                             (dict(weights=3, weight_attribute="none"), "no vertex attribute"), (dict(stiffness=0), "stiffness"),
                             (dict(largest_distance=1e-30), "counterpart on its other side")):
        ms = layers()
        before = snapshot(ms.current_mesh())
        with pytest.raises(pymeshlab.PyMeshLabException, match=text):
            ms.apply_filter(SYMMETRIZE, **parameters)
        assert_unchanged(before, ms.current_mesh())
        assert len(list(ms)) == 1
