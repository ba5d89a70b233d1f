# SPDX-License-Identifier: GPL-3.0-or-later
"""What to print so that it becomes what is wanted."""
import numpy as np
import pytest

import pymeshlab_fcd
from pymeshlab_fcd import CompensationWarning, compensate

SIZE, THICK, HOLE, TILES = np.array([120.0, 60.0]), 4.0, 5.0, (4, 2)  # millimetres


def plate(around=64, rings=10):
    """Drilled; unwelded, as STL files are: (vertices, faces, holes), where holes are the vertices of each hole's wall."""
    half = SIZE / TILES / 2
    a = 2 * np.pi * np.arange(around) / around
    circle = np.stack([np.cos(a), np.sin(a)], 1)
    square = circle / np.abs(circle / half).max(axis=1, keepdims=True)
    share = np.linspace(0, 1, rings)[:, None, None]
    flat = (1 - share) * HOLE * circle + share * square
    here = np.arange(around)
    beside = np.roll(here, -1)
    tile = np.concatenate([np.concatenate([np.stack([here, here + around, beside], 1), np.stack([beside, here + around, beside + around], 1)]) + r * around
                           for r in range(rings - 1)])
    corners, of_hole = [], []
    for i in range(TILES[0]):
        for j in range(TILES[1]):
            at = flat.reshape(-1, 2) + half * [2 * i + 1, 2 * j + 1]
            top, low = (np.concatenate([at, np.full((len(at), 1), z)], 1) for z in (THICK, 0))
            corners += [top[tile], low[tile[:, ::-1]]]
            of_hole += [np.zeros(len(tile), int)] * 2
            ring_top, ring_low = top[:around], low[:around]
            corners += [np.stack([ring_top[here], ring_top[beside], ring_low[here]], 1), np.stack([ring_top[beside], ring_low[beside], ring_low[here]], 1)]
            of_hole += [np.full(around, 1 + i * TILES[1] + j)] * 2
    for axis, number in ((0, 60), (1, 120)):
        for side in (0, 1):
            t = np.linspace(0, SIZE[1 - axis], number)
            wall = np.stack([np.full(number, SIZE[axis] * side), t], 1)
            wall = wall if axis == 0 else wall[:, ::-1]
            up, down = (np.concatenate([wall, np.full((number, 1), z)], 1) for z in (THICK, 0))
            faces = [np.stack([up[:-1], down[:-1], down[1:]], 1), np.stack([up[:-1], down[1:], up[1:]], 1)]
            outward = (side == 1) == (axis == 1)
            corners += [each[:, ::-1] if outward else each for each in faces]
            of_hole += [np.zeros(number - 1, int)] * 2
    soup, holes = np.concatenate(corners).reshape(-1, 3), np.repeat(np.concatenate(of_hole), 3)
    return soup, np.arange(len(soup)).reshape(-1, 3), holes


def warped(p):
    """By 0.48 mm at most: it lifts at the corners, twists, and shrinks."""
    x, y = (p[:, 0] / SIZE[0] - 0.5) * 2, (p[:, 1] / SIZE[1] - 0.5) * 2
    lift = 0.28 * x**2 + 0.1 * y**2 + 0.1 * x * y + 0.06 * np.sin(3 * x)
    return np.stack([p[:, 0] * 0.998 - 0.3 * lift * x * (p[:, 2] - 2) / 10, p[:, 1] * 0.999 + 0.05 * x**2 * y, p[:, 2] + lift], 1)


def scan(noise=0.03, kept=None):
    points, faces, _ = plate(97, 17)  # of another density
    measured, same = np.unique(points.round(9), axis=0, return_inverse=True)
    faces = same.reshape(-1)[faces]
    if kept is not None:
        faces = faces[kept(measured[faces].mean(1))]
    measured = warped(measured)
    return measured + np.random.default_rng(1).normal(0, noise, measured.shape), faces


def rms(a):
    return np.sqrt((a**2).sum(1).mean())


def placed(points, onto):
    """By the best rigid motion."""
    a, b = points - points.mean(0), onto - onto.mean(0)
    u, _, v = np.linalg.svd(a.T @ b)
    return a @ (u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v) + onto.mean(0)


def out_of_round(points, holes):
    """The largest of the ranges of the radii of holes."""
    return max(np.ptp(np.linalg.norm((points[holes == k] - points[holes == k].mean(0))[:, :2], axis=1)) for k in range(1, holes.max() + 1))


@pytest.fixture(scope="module")
def part():
    nominal, faces, holes = plate()
    return nominal, faces, holes, compensate(nominal, faces, *scan())


def test_what_is_printed_comes_out_as_it_should(part):
    nominal, faces, holes, made = part
    off = rms(placed(warped(nominal), nominal) - nominal)
    assert off > 0.1 and rms(placed(warped(made.vertices), nominal) - nominal) < 0.03
    truth = out_of_round(2 * nominal - placed(warped(nominal), nominal), holes)
    assert out_of_round(made.vertices, holes) < truth + 0.02
    info = made.info
    assert info.left < 0.05 and info.before > 3 * info.left and info.scanned > 0.9 and info.missed < 1e-9
    assert made.change.max() == pytest.approx(info.change_most) and 0 < info.change < info.change_most < 1
    assert np.abs(made.predict(made.vertices) - nominal).max() < 1e-9
    assert np.abs(made.map(nominal[:100]) - made.vertices[:100]).max() == 0 and "Compensated of" in repr(made)


def test_welded_or_not_and_any_number_of_threads(part):
    nominal, faces, _, made = part
    again = compensate(nominal, faces, *scan(), threads=1)
    assert again.vertices.tobytes() == made.vertices.tobytes()
    together = nominal.round(9)
    _, first, same = np.unique(together, axis=0, return_index=True, return_inverse=True)
    assert np.abs(made.vertices[first][same.reshape(-1)] - made.vertices).max() < 1e-7  # no cracks


def test_progress_and_cancel_to_the_last_vertex(part):
    nominal, faces = part[:2]
    told = []
    compensate(nominal, faces, *scan(), threads=1, progress=lambda percent, stage: told.append((percent, stage)))
    last = [percent for percent, stage in told if stage == "Compensating"]
    assert len(set(last)) > 3 and last == sorted(last)  # there, too, one sees how far it is

    def stop(percent, stage):
        if stage == "Compensating" and percent > 80:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        compensate(nominal, faces, *scan(), progress=stop)


def test_what_is_not_scanned_goes_along(part):
    nominal, faces, holes, _ = part
    made = compensate(nominal, faces, *scan(kept=lambda at: at[:, 2] > 0.1))  # lying on its lower side
    assert made.info.scanned < 0.8
    assert rms(placed(warped(made.vertices), nominal) - nominal) < 0.03


def test_what_makes_no_sense_is_told(part):
    nominal, faces = part[:2]
    points, triangles = scan()
    for wrong, text in ((dict(faces=None), "no triangles"), (dict(scan_vertices=np.zeros((0, 3)), scan_faces=None), "no vertices"),
                        (dict(degree=8), "degree"), (dict(samples=10), "samples"), (dict(largest_distance=-1), "largest distance"),
                        (dict(scan_vertices=points + 1e4, largest_distance=1.0), "counterpart on the scan")):
        given = {**dict(vertices=nominal, faces=faces, scan_vertices=points, scan_faces=triangles), **wrong}
        with pytest.raises(ValueError, match=text):
            compensate(**given)
    with pytest.raises(TypeError, match="no scan"):
        compensate(nominal, faces)
    with pytest.raises(ValueError, match="not finite"):
        compensate(np.r_[nominal, [[np.nan, 0, 0]]], faces, points, triangles)


def test_a_stray_vertex_changes_nothing(part):
    nominal, faces = part[:2]
    points, triangles = scan()
    alone = compensate(nominal, faces, points, triangles)
    stray = compensate(np.r_[nominal, [[1e5, 0, 0]]], faces, points, triangles)
    assert stray.info == alone.info and (stray.vertices[:-1] == alone.vertices).all()


def test_a_scan_that_is_the_part_needs_no_compensation_and_no_warning(part):
    nominal, faces = part[:2]
    assert compensate(nominal, faces, nominal, faces).info.change_most < 1e-9


def test_what_is_not_to_be_trusted_is_told(part):
    nominal, faces = part[:2]
    noise = np.random.default_rng(2).normal(0, 0.3, nominal.shape)
    with pytest.warns(CompensationWarning, match="The warp leaves"):
        compensate(nominal, faces, nominal + noise, faces)
    with pytest.warns(CompensationWarning, match="percent of the nominal part"):
        compensate(nominal, faces, *scan(kept=lambda at: (at[:, 0] < 30) & (at[:, 2] > 0.1)))


def test_it_is_a_function_of_the_package():
    assert {"compensate", "Compensated", "CompensationInfo"} <= set(pymeshlab_fcd.__all__)
