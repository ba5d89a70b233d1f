# SPDX-License-Identifier: GPL-3.0-or-later
"""What to print so that it becomes what is wanted."""
import warnings

import numpy as np
import pytest
from job_data import SIZE, THICK, plate, scan, warped

import pymeshlab_fcd
from pymeshlab_fcd import CompensationWarning, compensate


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


@pytest.mark.parametrize("kept, most, is_told", [(lambda p: p[:, 2] > 3.9, 0.9, True), (lambda p: p[:, 0] < 60, 0.6, False), (lambda p: p[:, 0] < 40, 0.9, True),
                                                 (lambda p: np.hypot(p[:, 0] - 60, p[:, 1] - 30) > 20, 0.2, False)])
def test_a_part_of_which_a_part_is_scanned_gets_no_worse(part, kept, most, is_told):
    """The upper side alone, a half, a third, all but a hole."""
    nominal, faces = part[:2]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        made = compensate(nominal, faces, *scan(kept=kept))
    assert rms(placed(warped(made.vertices), nominal) - nominal) < most * rms(placed(warped(nominal), nominal) - nominal)
    assert [issubclass(each.category, CompensationWarning) and "the rest is a guess, off by about" in str(each.message) for each in told] == [True] * is_told


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


def block(thick):
    """A part with a flat top and a flat underside, and what becomes of its places when it is printed."""
    x, y, z = (grid.ravel() for grid in np.meshgrid(np.linspace(-50, 50, 41), np.linspace(-30, 30, 25), [0.0, thick], indexing="ij"))
    a = np.arange(40 * 25).reshape(40, 25)[:, :-1].ravel() * 2
    low = np.concatenate([np.stack([a, a + 2, a + 50], 1), np.stack([a + 2, a + 52, a + 50], 1)])
    top = low[:, ::-1] + 1
    return np.stack([x, y, z], 1), np.concatenate([low, top]), top, lambda p: p * [0.995, 0.995, 1] + np.outer(4e-4 * p[:, 0] ** 2 / 3, [0, 0, 1])


def off_above(made, points, printed):
    """How far the tops of prints are from flat."""
    top = points[:, 2] > 0
    return np.abs((placed(printed(made.vertices)[top], points[top]) - points[top])[:, 2]).max()


@pytest.mark.parametrize("thick, turned_over", [(8.0, False), (20.0, False), (20.0, True)])
def test_a_thick_part_of_which_one_side_is_scanned(thick, turned_over):
    """What is nearest to the underside, the scan's top, is as far as the part is thick, and no noise."""
    points, faces, top, printed = block(thick)
    made = compensate(points, faces, printed(points), top[:, ::-1] if turned_over else top)
    assert off_above(made, points, printed) < 0.01 < 0.2 < np.ptp(printed(points)[points[:, 2] > 0, 2])
    assert made.info.scanned == pytest.approx(0.5, abs=0.03) and made.info.left < 1e-3


def test_rims_alone_tell_that_flat_sides_shrank():
    """Most of the part slides along itself, to where it lies exactly."""
    points, faces, _ = plate()
    for printed in (lambda p: p * [0.985, 0.99, 1], lambda p: p * [0.985, 0.99, 1] + np.outer(1e-4 * (p[:, 0] - 60) ** 2, [0, 0, 1])):
        made = compensate(points, faces, printed(points), faces)
        assert np.abs(np.ptp(placed(printed(made.vertices), points), 0) - [*SIZE, THICK]).max() < 0.05


def test_points_farther_apart_than_the_part_is_thick_are_told():
    points, faces, _, printed = block(1.0)
    with pytest.warns(CompensationWarning, match="points are about 2.*so a point does not show its side"):
        compensate(points, faces, printed(points))


def test_a_cloud_tells_as_much_as_its_triangles():
    """Its points are 2.5 apart: what is between them is off by nothing."""
    points, faces, _, printed = block(8.0)
    mesh, cloud = compensate(points, faces, printed(points), faces), compensate(points, faces, printed(points))
    assert cloud.info.before == pytest.approx(mesh.info.before, rel=0.05) and cloud.info.left < 2e-3 * mesh.info.before
    assert off_above(cloud, points, printed) < 0.01


@pytest.mark.parametrize("size", [2.0**-1000, 2.0**600])
def test_parts_of_any_size_are_compensated_alike(size):
    """Squares of such lengths are no numbers."""
    points, faces, _, printed = block(8.0)
    usual, odd = compensate(points, faces, printed(points)), compensate(size * points, faces, size * printed(points))
    assert np.abs(odd.vertices / size - usual.vertices).max() < 1e-5 and np.abs(odd.change / size - usual.change).max() < 1e-5
    assert odd.info.change / size == pytest.approx(usual.info.change, rel=1e-4) and odd.info.left / size == pytest.approx(usual.info.left, rel=1e-3)


def test_what_makes_no_sense_is_told(part):
    nominal, faces = part[:2]
    points, triangles = scan()
    for wrong, text in ((dict(faces=None), "no triangles"), (dict(scan_vertices=np.zeros((0, 3)), scan_faces=None), "no vertices"),
                        (dict(degree=8), "degree"), (dict(samples=10), "places"), (dict(largest_distance=-1), "largest distance"),
                        (dict(scan_vertices=points + 1e4, largest_distance=1.0), "counterpart on the scan")):
        given = {**dict(vertices=nominal, faces=faces, scan_vertices=points, scan_faces=triangles), **wrong}
        with pytest.raises(ValueError, match=text):
            compensate(**given)
    with pytest.raises(ValueError, match="The scan has no triangle with an area"):
        compensate(nominal, faces, points, [[0, 0, 1]])
    with pytest.raises(ValueError, match="The scan has no vertices whose coordinates are finite"):
        compensate(nominal, faces, points * np.nan, triangles)
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
    found, triangles = scan()
    middle = nominal.mean(0)
    with pytest.warns(CompensationWarning, match="The scan is 10 times smaller than the nominal part: if it has other units, scale it first"):
        compensate(nominal, faces, (found - middle) / 10 + middle, triangles)
    points, faces_of, _, printed = block(4.0)
    for larger, text in ((2.54, "^Only .* The scan is 2.5. times larger than the nominal part: if it has other units, scale it first"),
                         (1 / 2.54, "The scan is 2.5. times smaller than the nominal part: if it has other units")):
        with pytest.warns(CompensationWarning, match=text):
            compensate(points, faces_of, larger * printed(points), faces_of)
    for larger, text in ((1 / 25.4, "The scan is 25.. times smaller than"), (10, "The scan is (9.9.|10) times larger than")):
        with pytest.raises(ValueError, match="Align them rigidly first, or raise largest_distance. " + text):
            compensate(points, faces_of, larger * (printed(points) + [0, 0, 5]), faces_of, largest_distance=0.1)
    with warnings.catch_warnings():  # a scan of the part and of the table below it
        warnings.simplefilter("error")
        table = 400 * np.array([[-1, -1, -0.02], [1, -1, -0.02], [1, 1, -0.02], [-1, 1, -0.02]])
        compensate(points, faces_of, np.r_[printed(points), table], np.r_[faces_of, len(points) + np.array([[0, 1, 2], [0, 2, 3]])])
    with pytest.warns(CompensationWarning, match="percent of the nominal part"):
        compensate(nominal, faces, *scan(kept=lambda at: (at[:, 0] < 30) & (at[:, 2] > 0.1)))


def test_it_is_a_function_of_the_package():
    assert {"compensate", "Compensated", "CompensationInfo"} <= set(pymeshlab_fcd.__all__)
