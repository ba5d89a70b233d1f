# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of tests/fit_recipes.py: how near to their truth a fit comes."""
import pytest

import host_pymeshlab  # noqa: F401  loads the plugin, once in a process
from fit_pairs import fitted, from_clean, measured
from fit_recipes import RECIPES, made
from fit_shapes import Absent

# rms from the truth and from the surface, percent of the diagonal: a tenth above what is reached. To be lowered when it gets better.
LIMITS = {"tube_clean": (0.62, 0.034), "potato_noise": (1.35, 0.017), "sheet_normals": (1.34, 0.085)}


@pytest.mark.parametrize("name", LIMITS)
def test_a_fit_comes_as_near_to_the_truth_as_it_did(name):
    assert RECIPES[name][0] == "training"
    pair = made(name)
    positions, result, _ = fitted(pair)
    worth = measured(pair, positions)
    assert worth["before"] > 2.5 and worth["folded"] == 0 and result["folded_triangles"] == 0
    assert worth["rms"] < LIMITS[name][0] and worth["surface"] < LIMITS[name][1]


@pytest.mark.parametrize("name, limit", [("igea_holes", 0.1), ("bunny_cloud", 0.11)])
def test_noise_is_not_what_stiffening_would_press(name, limit):  # 0.109 and 0.113 where all of it gets stiffer
    try:
        pair = made(name)
    except Absent as absent:
        pytest.skip(str(absent))
    assert measured(pair, fitted(pair)[0])["rms"] < limit


def test_dirt_moves_a_fit_by_little():
    pair, few = made("tube_clean"), {"samples": 1000, "fit_steps": 25}
    off = dict(from_clean(pair, fitted(pair, **few)[0], **few))
    assert len(off) == 8 and max(off.values()) < 0.15
    for vertices in ("unwelded", "1000 isolated vertices"):  # bend nothing
        assert off[vertices] < 0.01


def test_both_halves_have_pairs_enough_and_no_mesh_is_in_both():
    halves = [half for half, _ in RECIPES.values()]
    assert halves.count("training") >= 7 and halves.count("held out") >= 7
    files = {half: set() for half in set(halves)}
    for half, recipe in RECIPES.values():
        files[half] |= {each for each in recipe.__code__.co_consts if isinstance(each, str) and each.endswith((".ply", ".xz", ".off", ".obj"))}
    assert len(files["training"]) > 2 and len(files["held out"]) > 2 and not files["training"] & files["held out"]
