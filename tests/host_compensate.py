# SPDX-License-Identifier: GPL-3.0-or-later
"""What to print of a nominal layer, inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import numpy as np
import pymeshlab
import pytest

from host_pymeshlab import assert_unchanged, check_returned, new_set, snapshot

COMPENSATE = "generate_fcd_compensated_mesh"
DEFAULTS = {"scan_layer": 1, "degree": 5, "largest_distance": 0, "samples": 12000, "compensated_quality": 1}
RETURNS = {"rms_before": float, "rms_left": float, "scanned": float, "change": float, "change_most": float, "missed": float, "seconds": float}


def plate(nx=41, ny=25):
    """Of 100 x 60 x 4: (points, faces)."""
    x, y, z = [each.ravel() for each in np.meshgrid(np.linspace(-50, 50, nx), np.linspace(-30, 30, ny), [0.0, 4.0], indexing="ij")]
    a = np.arange((nx - 1) * ny).reshape(nx - 1, ny)[:, :-1].ravel() * 2
    low = np.concatenate([np.stack([a, a + 2, a + 2 * ny], 1), np.stack([a + 2, a + 2 * ny + 2, a + 2 * ny], 1)])
    rim = 2 * np.concatenate([np.arange(ny), np.arange(2, nx) * ny - 1, np.arange(nx * ny - 1, (nx - 1) * ny - 1, -1), np.arange(nx - 1, 0, -1) * ny])
    rim = rim[np.r_[True, np.diff(rim) != 0]]
    beside = np.roll(rim, -1)
    walls = [np.stack([rim, rim + 1, beside], 1), np.stack([beside, rim + 1, beside + 1], 1)]
    return np.stack([x, y, z], 1), np.concatenate([low, low[:, ::-1] + 1, *walls]).astype(np.int32)


def warped(p):
    """It shrank, and bends: its ends lift."""
    return p * [0.995, 0.997, 1] + 4e-4 / 3 * np.stack([-2 * p[:, 0] * (p[:, 2] - 2), 0 * p[:, 0], p[:, 0] ** 2], 1)


POINTS, FACES = plate()


def layers(points=POINTS, faces=FACES, scan=None, scan_faces=FACES):
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=warped(POINTS) if scan is None else scan, face_matrix=scan_faces), "scan")
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=points, face_matrix=faces), "part")
    return ms


def off(points, onto):
    """After the best rigid motion: root mean square, along each axis."""
    a, b = points - points.mean(0), onto - onto.mean(0)
    u, _, v = np.linalg.svd(a.T @ b)
    return np.sqrt(((a @ (u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v) - b) ** 2).mean(0))


def logged(ms, capfd, **parameters):
    """(returned values, log). After an error in any filter pymeshlab logs no more, hence these tests come first."""
    ms.set_verbosity(True)
    capfd.readouterr()
    result = ms.apply_filter(COMPENSATE, **{"scan_layer": 0, **parameters})
    return result, capfd.readouterr().err


def test_what_is_printed_comes_out_as_it_should(capfd):
    ms = layers()
    before = [snapshot(mesh) for mesh in ms]
    result, log = logged(ms, capfd)
    check_returned(result, RETURNS)
    assert "have a counterpart on the scan" in log and "What to print differs from the nominal part by" in log
    made = ms.current_mesh()
    assert made.label() == "part compensated" and len(list(ms)) == 3 and (made.face_matrix() == FACES).all()
    assert off(warped(POINTS), POINTS)[[0, 2]].min() > 0.09 and (off(warped(made.vertex_matrix()), POINTS) < [0.05, 0.01, 0.01]).all()  # little wall tells x
    change = np.linalg.norm(made.vertex_matrix() - POINTS, axis=1)
    assert np.allclose(made.vertex_scalar_array(), change, atol=1e-6) and result["change_most"] == pytest.approx(change.max())
    assert result["missed"] < 1e-9 and result["rms_left"] < 0.1 * result["rms_before"]
    for each, mesh in zip(before, list(ms)):
        assert_unchanged(each, mesh)


def test_what_is_not_to_be_trusted_is_warned_of(capfd):
    few = POINTS[FACES].mean(1)[:, 0] < -25
    assert "percent of the nominal part have a counterpart" in logged(layers(scan_faces=FACES[few & (np.arange(len(FACES)) < len(FACES) // 2)]), capfd)[1]
    noise = np.random.default_rng(2).normal(0, 0.5, POINTS.shape)
    assert "The warp leaves" in logged(layers(scan=POINTS + noise), capfd)[1]


def test_the_same_in_the_world():
    """Matrices of the layers count; a cloud with normals is a scan, too."""
    plain = layers()
    plain.apply_filter(COMPENSATE, scan_layer=0)
    ms = layers(points=POINTS / [2, 4, 1])
    ms.apply_filter("set_matrix", transformmatrix=np.diag([2.0, 4, 1, 1]), freeze=False)
    ms.apply_filter(COMPENSATE, scan_layer=0, compensated_quality=0)
    made = ms.current_mesh()
    assert np.abs(made.vertex_matrix() * [2, 4, 1] - plain.current_mesh().vertex_matrix()).max() < 1e-9
    assert not made.has_vertex_scalar() or not made.vertex_scalar_array().any()
    cloud = new_set()
    normals = np.where(POINTS[:, 2:] > 1, [[0, 0, 1.0]], [[0, 0, -1.0]])
    cloud.add_mesh(pymeshlab.Mesh(vertex_matrix=warped(POINTS), v_normals_matrix=normals), "scan")
    cloud.add_mesh(pymeshlab.Mesh(vertex_matrix=POINTS, face_matrix=FACES), "part")
    cloud.apply_filter(COMPENSATE, scan_layer=0)
    assert off(warped(cloud.current_mesh().vertex_matrix()), POINTS)[2] < 0.02  # as far as these normals tell


def test_own_normals_turn_and_strays_stay():
    stray = np.r_[POINTS, [[1e5, 0, 0]]]
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=warped(POINTS), face_matrix=FACES), "scan")
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=stray, face_matrix=FACES), "part")
    ms.apply_filter("compute_normal_by_function_per_vertex", x="0.6", y="0", z="0.8")
    ms.apply_filter(COMPENSATE, scan_layer=0)
    made = ms.current_mesh()
    assert (made.vertex_matrix()[-1] == stray[-1]).all()
    normals = made.vertex_normal_matrix()
    assert np.allclose(np.linalg.norm(normals, axis=1), 1) and np.allclose(normals[-1], [0.6, 0, 0.8])
    x, _, z = made.vertex_matrix()[:-1].T
    k = 4e-4 / 3 * 2
    truth = np.stack([0.6 * (0.995 - k * (z - 2)) + 0.8 * k * x, 0 * x, 0.8 - 0.6 * k * x], 1)  # the transposed derivative of warped, which goes the other way
    assert np.abs(normals[:-1] - truth / np.linalg.norm(truth, axis=1, keepdims=True)).max() < 1e-3


def test_parameters_names_order_and_defaults():
    assert COMPENSATE in pymeshlab.filter_list()
    values = layers().filter_parameter_values(COMPENSATE)
    assert list(values) == list(DEFAULTS)
    assert {key: values[key] for key in DEFAULTS if key != "scan_layer"} == {key: value for key, value in DEFAULTS.items() if key != "scan_layer"}


def test_an_error_leaves_the_document_as_it_was():
    for parameters, text in ((dict(scan_layer=1), "'scan_layer' is 'part' itself"), (dict(scan_layer=77), "'scan_layer' names no layer"),
                             (dict(degree=8), "degree of the warp"), (dict(samples=9), "At least 100 places"), (dict(samples=2**31 - 1), "at most 1000000"), (dict(largest_distance=-1), "must be positive"),
                             (dict(largest_distance=1e-9), "counterpart on the scan")):
        ms = layers()
        before = snapshot(ms.current_mesh())
        with pytest.raises(pymeshlab.PyMeshLabException, match=text):
            ms.apply_filter(COMPENSATE, **{"scan_layer": 0, **parameters})
        assert_unchanged(before, ms.current_mesh())
        assert len(list(ms)) == 2
    points = layers(points=POINTS, faces=np.zeros((0, 3), np.int32))
    with pytest.raises(pymeshlab.PyMeshLabException, match="no triangles with an area"):
        points.apply_filter(COMPENSATE, scan_layer=0)
