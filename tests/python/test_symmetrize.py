# SPDX-License-Identifier: GPL-3.0-or-later
"""Restoring symmetry."""
import warnings

import numpy as np
import pytest
from job_data import MIRROR, ball, buried, skull, turned
from shapes import same
from test_straighten import rms_apart

from pymeshlab_fcd import Deformation, DeformationWarning, Pose, Symmetrized, symmetrize

AT, FACES = ball()


def off(made, truth):
    """Percent of the diagonal."""
    return 100 * rms_apart(made, truth) / np.linalg.norm(np.ptp(truth, axis=0))


@pytest.fixture(scope="module")
def restored():
    truth = skull(AT, 1)
    return truth, symmetrize(buried(truth), FACES)


def test_what_was_sheared_and_bent_is_symmetric_again(restored):
    truth, made = restored
    assert isinstance(made, Symmetrized) and isinstance(made, Pose)
    assert off(buried(truth), truth) > 0.8 and off(made.vertices, truth) < 0.15
    told = made.symmetry
    assert told.is_sure and told.plane_from == "surface" and told.converged and told.matched > 0.95
    assert repr(made) == f"<Symmetrized of {len(truth)} vertices, {told.before:g} from its mirror image, now {told.after:g}>"
    assert told.after < 0.05 * told.before and 0 < told.moved < told.asymmetry < told.asymmetry_most
    assert made.matched.mean() > 0.95 and made.asymmetry.max() == pytest.approx(told.asymmetry_most, rel=0.3)
    assert np.array(told.plane).shape == (2, 3)
    place = symmetrize(made.vertices, FACES, plane=told.plane)  # symmetric already
    assert place.symmetry.moved < 0.05 * told.moved
    assert same(symmetrize(buried(truth), FACES, threads=1).vertices, made.vertices)


def test_what_it_did_is_kept_for_other_surfaces(restored, tmp_path):
    truth, made = restored
    inner = buried(0.9 * truth)
    assert off(made.map(inner), 0.9 * truth) < 0.3
    made.deformation(accuracy=1e-3).save(tmp_path / "restored")
    assert off(Deformation.load(tmp_path / "restored")(inner), 0.9 * truth) < 0.3


def test_landmarks_lie_in_each_others_mirror_image():
    truth = skull(AT, 3)
    random = np.random.default_rng(4)
    side = np.abs(random.normal(size=(14, 3))) * [1, 1, 1] * np.where(np.arange(42).reshape(14, 3) % 3 > 0, random.choice([-1, 1], (14, 3)), 1)
    side /= np.linalg.norm(side, axis=1)[:, None]
    pairs = np.stack([buried(skull(side, 3), 0.14, 0.15), buried(skull(side * MIRROR, 3), 0.14, 0.15)], 1)
    made = symmetrize(buried(truth, 0.14, 0.15), FACES, pairs=pairs)
    assert off(buried(truth, 0.14, 0.15), truth) > 1.7 and off(made.vertices, truth) < 0.25
    assert made.symmetry.plane_from == "landmarks" and made.symmetry.pairs == 14
    middle = np.argsort(np.abs(truth[:, 0]))[:5]
    left, right = np.argmax(truth[:, 0]), np.argmin(((truth - truth[np.argmax(truth[:, 0])] * MIRROR) ** 2).sum(1))
    exact = symmetrize(buried(truth), FACES, midline=middle, pairs=[[left, right]])
    point, normal = map(np.array, exact.symmetry.plane)
    assert np.abs((exact.vertices[middle] - point) @ normal).max() < 1e-12
    mirrored = exact.vertices[left] - 2 * ((exact.vertices[left] - point) @ normal) * normal
    assert np.abs(mirrored - exact.vertices[right]).max() < 1e-12
    assert symmetrize(buried(truth), FACES, plane=[point, 2 * normal]).symmetry.plane_from == "given"


@pytest.mark.parametrize("kind, named", [("swapped", "pair 0, pair 5"), ("beside", "pair 2"), ("midline", "midline point 3")])
def test_landmarks_that_the_others_contradict_are_left_out(kind, named):
    """Two pairs whose right ends are swapped; one whose right end is a tenth of the diagonal beside its place; a point of the midline that lies
    on one side. With a tolerance, nothing of them is left, as in the plane."""
    def place(sites):
        return buried(skull(sites, 7), 0.14, 0.15)

    at, faces = ball(40, 60)
    a = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    sites = np.stack([np.where(kind == "midline", 0 * a, 0.6), 0.8 * np.cos(a), 0.8 * np.sin(a)], 1)
    sites /= np.linalg.norm(sites, axis=1)[:, None]
    if kind == "midline":
        sites[3] = [0.8, 0.6, 0]
        given, wrong = {"midline": place(sites)}, (3,)
    else:
        right = sites * MIRROR
        if kind == "beside":
            right[2] = (right[2] + [0, 0.2, 0]) / np.linalg.norm(right[2] + [0, 0.2, 0])
        marks = np.stack([place(sites), place(right)], 1)
        if kind == "swapped":
            marks[[0, 5], 1] = marks[[5, 0], 1]
        given, wrong = {"pairs": marks}, (0, 5) if kind == "swapped" else (2,)
    with pytest.warns(DeformationWarning, match=f"counted from 0, do not go with the others: {named}. Look whether they are mixed up. They were left out"):
        made = symmetrize(place(at), faces, landmark_tolerance=0.01, **given)
    assert made.symmetry.contradicted == wrong and made.symmetry.converged
    assert off(place(at), skull(at, 7)) > 1.7 and off(made.vertices, skull(at, 7)) < 0.25
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        assert symmetrize(place(at), faces, **given).symmetry.contradicted == wrong
    assert any(f"do not go with the others: {named}" in str(each.message) and "followed, so the surface may be folded there; with a "
               "landmark tolerance above 0 they are left out" in str(each.message) for each in told)


def test_errors_of_landmarks_close_together_stay_small():
    """Vertices of a mesh lie beside the midline, by 0.3 % of the diagonal, some 0.2 % from the next one."""
    at, faces = ball(40, 60)
    truth = skull(at, 8)
    midline = np.argsort(np.abs(truth[:, 0]))[:60:5]
    bent = buried(truth, 0.14, 0.15)
    assert off(bent, truth) > 1.7 and off(symmetrize(bent, faces, midline=midline).vertices, truth) < 1.2


def test_the_good_side_is_mirrored_over_a_missing_one():
    truth = skull(AT, 5)
    gone = ((truth - [0.6, 0.3, 0.3]) ** 2).sum(1) < 0.15
    kept = np.flatnonzero(~gone)
    number = np.full(len(truth), -1)
    number[kept] = np.arange(len(kept))
    faces = number[FACES[(~gone)[FACES].all(axis=1)]]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeformationWarning)
        made = symmetrize(buried(truth)[kept], faces)
    assert off(made.vertices, truth[kept]) < 0.15
    assert made.matched[((truth[kept] * MIRROR - [0.6, 0.3, 0.3]) ** 2).sum(1) < 0.1].mean() < 0.1
    places, corners, source = made.other_side()
    assert len(places) == len(source) and corners.max() == len(places) - 1
    whole = np.concatenate([made.vertices, places])
    belongs = np.concatenate([truth[kept], truth[kept][source] * MIRROR])
    assert off(whole, belongs) < 0.5
    assert (belongs[len(kept):, 0] > 0).mean() > 0.9


@pytest.mark.parametrize("radius, is_cloud, most", [(0.62, False, 0.2), (0.8, False, 0.2), (0.62, True, 0.25), (0.8, True, 0.4)])
def test_nothing_is_drawn_over_a_missing_part(radius, is_cloud, most):
    """A fifth or a third of one side is gone. The middle lies beside the plane, and what mirrors the rest of that side is not
    reached."""
    truth = skull(AT, 22)
    kept = (np.linalg.norm(truth - [0.5, -0.3, 0.4], axis=1) > radius) | (truth[:, 0] < 0.05)
    faces = (np.cumsum(kept) - 1)[FACES[kept[FACES].all(axis=1)]]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeformationWarning)
        made = symmetrize(buried(truth, 0.1, 0.15)[kept], None if is_cloud else faces)
    assert made.symmetry.matched < 0.9 and made.symmetry.converged and made.symmetry.is_sure
    assert off(made.vertices, truth[kept]) < most


@pytest.mark.parametrize("side, radius", [(1, 0.5), (-1, 0.5), (-1, 0.4)])
def test_a_missing_ear_does_not_hide_the_plane(side, radius):
    """In a ball that is nearly round, a sheared one is as much like its mirror image in many planes before it is warped."""
    at, faces = ball()
    bumps = [(0.8, 0.1, 0.6, 0.2), (-0.8, 0.1, 0.6, 0.2), (0, 0.9, 0.3, 0.25), (0, 0.7, -0.7, 0.2), (0, -0.8, 0.5, -0.2), (0.4, 0.8, 0.5, -0.1), (-0.4, 0.8, 0.5, -0.1)]
    head = at * (1 + sum(height * np.exp(-8 * ((at - middle) ** 2).sum(1)) for *middle, height in bumps))[:, None]
    head = np.stack([0.8 * head[:, 0] + 0.08 * head[:, 1], head[:, 1], head[:, 2]], 1)
    kept = np.linalg.norm(head - [0.8 * side, 0.1, 0.6], axis=1) > radius
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        made = symmetrize(head[kept], (np.cumsum(kept) - 1)[faces[kept[faces].all(1)]]).symmetry
    assert abs(made.plane[1][0]) > 0.99 and made.after < 0.05 * made.before


def test_a_plane_near_a_better_direction_is_found():
    """Matching from the best direction near the plane comes to rest 23 degrees off, from its neighbour in the plane's reach."""
    random = np.random.default_rng(601)
    random.normal(size=2), random.uniform(), random.integers(1, 3)  # those of another skull
    shear = random.normal(size=2)
    shear *= random.uniform(0.1, 0.2) / np.linalg.norm(shear)
    bend, truth = random.uniform(0.05, 0.14), skull(AT, 601)
    x, a = truth[:, 0] + truth[:, 1:] @ shear + 1 / bend, bend * truth[:, 2]
    made = symmetrize(turned(np.stack([x * np.cos(a) - 1 / bend, truth[:, 1], x * np.sin(a)], 1), 11), FACES)
    assert made.symmetry.is_sure and off(made.vertices, truth) < 0.35


def test_the_plane_of_a_cube_with_one_bump():
    """In many other planes, all but the bump is its mirror image, too: it is in some that are tried first."""
    a, b = (grid.ravel() for grid in np.meshgrid(np.linspace(-15, 15, 21), np.linspace(-15, 15, 21), indexing="ij"))
    i = np.arange(441).reshape(21, 21)[:-1, :-1].ravel()
    square = np.concatenate([np.stack([i, i + 21, i + 1], 1), np.stack([i + 1, i + 21, i + 22], 1)])
    sides = [np.roll(np.stack([np.full(441, 15.0 * side), a, b], 1), axis, axis=1) for axis in range(3) for side in (-1, 1)]
    every = np.concatenate([square[:, ::side] + 441 * k for k, side in enumerate([-1, 1] * 3)])
    cube, same_place = np.unique(np.concatenate(sides).round(9), axis=0, return_inverse=True)
    faces = same_place.ravel()[every]
    bump = cube * (1 + 0.12 * np.exp(-((cube - [15, 15, 6]) ** 2).sum(1) / 60))[:, None]
    random = np.random.default_rng(5)
    for _ in range(6):
        turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            made = symmetrize(bump @ turn.T, faces).symmetry
        assert abs(made.plane[1] @ turn @ [1, -1, 0]) > 0.999 * np.sqrt(2)


def test_what_is_symmetric_is_not_called_less_so_afterwards():
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(-1, 1, 21), np.linspace(-1, 1, 31)))
    faces = [(i, i + 1, i + 21) for i in range(30 * 21 - 1) if i % 21 < 20]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        symmetrize(np.stack([x, 1.5 * y + 0.2 * x**2, 0 * x], 1), faces)
    assert not any("farther from its mirror image" in str(each.message) for each in told)


def test_a_missing_part_is_not_less_symmetric_afterwards():
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(-1, 1, 41), np.linspace(-1, 1, 41)))
    at = np.stack([x, y, 0.2 * np.cos(5 * x) * np.sin(3 * y) + 0.02 * x], 1)
    kept = (x < 0.3) | (y < 0)
    faces = np.array([three for i in range(40 * 41 - 1) if i % 41 < 40 for three in ((i, i + 1, i + 41), (i + 1, i + 42, i + 41))])
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        made = symmetrize(at[kept], (np.cumsum(kept) - 1)[faces[kept[faces].all(axis=1)]], plane=[[0, 0, 0], [1, 0, 0]]).symmetry
    assert made.matched < 0.89 and made.after < 0.1 * made.before
    assert not any("farther from its mirror image" in str(each.message) for each in told)


def test_what_comes_out_less_symmetric_is_told():
    """A skull that is symmetric, and a pair that is none. (A plane beside the skull ends anywhere: the last bit decides.)"""
    at, faces = ball(40, 60)
    vertices = skull(at, 3)
    with pytest.warns(DeformationWarning, match="farther from its mirror image than the surface was: the plane is probably wrong"):
        symmetrize(vertices, faces, plane=[[0, 0, 0], [1, 0, 0]], pairs=[[vertices[:, 0].argmax(), vertices[:, 2].argmax()]])


def test_what_does_not_count_is_carried():
    truth = skull(AT, 6)
    grown = np.exp(-((AT - [0.8, 0, 0.6]) ** 2).sum(1) / 0.04)
    lump = buried(truth * (1 + 0.25 * grown)[:, None])
    made = symmetrize(lump, FACES, weights=grown < 0.05)
    others = grown < 0.01
    assert off(made.vertices[others], truth[others]) < 0.25


@pytest.mark.parametrize("seed, shear, bend", [(1, 0.08, 0.06), (22, 0.1, 0.15)])
def test_a_cloud_comes_nearly_as_near_as_its_mesh(seed, shear, bend):
    """Without the directions of its surface, the second one would be 1 % off."""
    truth = skull(AT, seed)
    cloud = symmetrize(buried(truth, shear, bend), None)
    assert off(cloud.vertices, truth) < 0.25 and cloud.other_side().faces is None


def test_pieces_that_end_everywhere_have_no_plane():
    """Nearly all matches are on a border there, so borders tell nothing."""
    random = np.random.default_rng(300)
    pieces = (random.normal(size=(300, 1, 3)) + 0.2 * random.normal(size=(300, 3, 3))).reshape(-1, 3)
    with pytest.raises(ValueError, match="as much like its mirror image in any plane as in another one"):
        symmetrize(pieces, np.arange(900).reshape(-1, 3))


def test_what_makes_no_sense_is_told():
    truth = skull(AT, 1)
    for wrong, text in (
        (dict(pairs=[[1, 2], [2, 3]]), "named twice"), (dict(pairs=[1, 2, 3]), "pairs must be k x 2"), (dict(pairs=[[0.0, 2.0]]), "k x 2 whole numbers of vertices, or k x 2 x 3 places, left and right; it is 1 x 2 of float64"),
        (dict(pairs=np.zeros((1, 2, 3, 1))), "it is 1 x 2 x 3 x 1"), (dict(plane=[0, 0, 1]), "plane must be 2 x 3, a point and a normal; it is 3"),
        (dict(plane=[[0, 0, 0], [0, 0, 0]]), "no direction"), (dict(plane=[[0, 0, 0]]), "plane must have 2 rows"),
        (dict(midline=[len(truth)]), "numbers of vertices")):
        with pytest.raises(ValueError, match=text):
            symmetrize(truth, FACES, **wrong)


@pytest.mark.parametrize("seed", [11, 21])
def test_a_plane_in_which_the_surface_is_pressed_together_is_told(seed):
    """No message speaks of the pressed mirror image as if it was the surface."""
    random = np.random.default_rng(seed)
    places = random.normal(size=(int(random.integers(3, 6)), 3))
    with pytest.raises(ValueError, match="not at all like its mirror image in this plane. Give pairs, a midline or another plane"):
        symmetrize(places, None, plane=random.normal(size=(2, 3)))


def test_a_plane_that_is_not_sure_is_told():
    egg = AT * [1.0, 0.8, 0.6] * (1 + 0.2 * AT[:, 2:])  # the mirror image of itself in two planes
    with pytest.warns(DeformationWarning, match="another plane"):
        assert not symmetrize(egg, FACES).symmetry.is_sure


def test_random_points_are_told_before_any_fit_and_mirrored_ones_are_not():
    told, places = [], np.random.default_rng(8).uniform(size=(150, 3))
    with pytest.raises(ValueError, match="as much like its mirror image in any plane as in another one. Give pairs, a midline or the plane"):
        symmetrize(places, None, progress=lambda percent, stage: told.append(stage))
    assert "Looking for the plane" in told and "Fitting" not in told
    half = np.random.default_rng(9).uniform(size=(75, 3))
    assert abs(symmetrize(np.r_[half, half * MIRROR], None).symmetry.plane[1][0]) == pytest.approx(1)


@pytest.mark.parametrize("places, given, text", [
    (np.ones((5, 3)), {}, "All of the surface lies at one point or on one line, so it is no surface"),
    (np.arange(30.0)[:, None] + np.zeros(3), {}, "All of the surface lies at one point or on one line"),
    (np.arange(9.0).reshape(3, 3), {"faces": [[0, 1, 2]]}, "The surface has no triangle with an area"),
    (np.zeros((0, 3)), {}, "There is nothing to fit: the surface has no vertices")])
def test_errors_speak_of_what_was_given(places, given, text):
    with pytest.raises(ValueError, match=text):
        symmetrize(places, **given)


@pytest.mark.parametrize("size", [2.0**-900, 2.0**600])
def test_surfaces_of_any_size_become_symmetric_alike(size):
    """Squares of such lengths are no numbers. Pairs of vertices become mirror images to the bit."""
    pairs, (at, faces) = [(10, 30), (400, 420), (800, 820)], ball(30, 40)

    def restored(by):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeformationWarning)
            return symmetrize(buried(skull(at, 3)) * by, faces, pairs=pairs)

    usual, odd = restored(1), restored(size)
    assert same(odd.vertices / size, usual.vertices) and same(odd.asymmetry / size, usual.asymmetry)
    assert odd.symmetry.before / size == usual.symmetry.before and odd.symmetry.after / size == usual.symmetry.after
