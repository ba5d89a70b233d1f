# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python package as it is installed from its wheel (tests/python_package.sh). Saved deformations, arrays, MeshSets."""
import concurrent.futures
import pickle
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pymeshlab
import pytest

import pymeshlab_fcd

ROOT = Path(__file__).resolve().parents[2]


def bar(n=101, m=15):
    """A bumpy bar along x, its tags, and a matrix that lifts the end."""
    x, y = np.meshgrid(np.linspace(0, 10, n), np.linspace(0, 1, m), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), 0.1 * np.sin(5 * x.ravel())], 1)
    i = np.arange(n * m).reshape(n, m)[:-1, :-1].ravel()
    faces = np.concatenate([np.stack([i, i + m, i + 1], 1), np.stack([i + 1, i + m, i + m + 1], 1)])
    tags = np.where(vertices[:, 0] < 1, 0, np.where(vertices[:, 0] > 9, 2, 1))
    return vertices, faces, tags, np.array([[0, 0, -1, 7], [0, 1, 0, 0], [1, 0, 0, -4], [0, 0, 0, 1.0]])


@pytest.fixture(scope="module")
def bend():
    vertices, faces, tags, lift = bar()
    return pymeshlab_fcd.deformation(vertices, faces, tags, {2: lift})


def same(a, b):
    return a.shape == b.shape and a.tobytes() == b.tobytes()


# --- with pymeshlab -------------------------------------------------------------------------------------------------------


def test_it_is_the_installed_package_and_knows_this_pymeshlab():
    assert "site-packages" in pymeshlab_fcd.__file__ and ROOT / "python" not in Path(pymeshlab_fcd.__file__).parents
    assert {"generate_fcd_deformed_mesh", "generate_fcd_deformed_copy", "save_fcd_deformation", "apply_coord_fcd_deformation"} <= set(
        pymeshlab_fcd._plugin.METHODS)


def test_filters_are_methods_and_arrays_give_the_same():
    vertices, faces, tags, lift = bar()
    positions = pymeshlab_fcd.deform(vertices, faces, tags, {2: lift})
    assert positions.shape == vertices.shape and positions.dtype == np.float64
    assert same(positions[tags == 0], vertices[tags == 0])
    assert np.abs(positions[tags == 2] - (vertices[tags == 2] @ lift[:3, :3].T + lift[:3, 3])).max() < 1e-12
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(vertices, faces, v_scalar_array=tags.astype(float)))
    result = ms.generate_fcd_deformed_mesh(transformmatrix=lift)
    assert result["converged"] and same(ms.current_mesh().vertex_matrix(), positions)


def test_a_layer_with_given_tags_or_its_own():
    vertices, faces, tags, lift = bar()
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(vertices, faces, v_scalar_array=tags.astype(float)))
    one = pymeshlab_fcd.deform_layer(ms, tags, {2: lift}, graph_layers=False)
    ms.set_current_mesh(0)
    other = pymeshlab_fcd.deform_layer(ms, None, {2: lift}, graph_layers=False, initial_patches=100)
    assert one["nodes"] > other["nodes"] and ms.mesh_number() == 3
    ms.set_current_mesh(0)
    pymeshlab_fcd.deform_layer(ms, None, {2: lift}, graph_layers=False)
    assert same(ms.mesh(1).vertex_matrix(), ms.mesh(3).vertex_matrix())


def test_a_cloud_and_parameters():
    vertices, _, tags, lift = bar()
    cloud = pymeshlab_fcd.deform(vertices, None, tags, {2: lift})
    half = pymeshlab_fcd.deform(vertices, None, tags, {2: lift}, pose=50.0)
    assert same(cloud[tags == 0], vertices[tags == 0]) and np.abs(cloud - half).max() > 1
    with pytest.raises(pymeshlab.PyMeshLabException, match="no handle"):
        pymeshlab_fcd.deform(vertices, None, np.minimum(tags, 1), {})


@pytest.mark.parametrize("change, words", [
    (dict(vertices=np.zeros(3)), "vertices must be n x 3"), (dict(faces=[[0, 1, 9999]]), "0 to 1514"), (dict(faces=[[0, 1]]), "m x 3"),
    (dict(faces=[[0.0, 1, 2]]), "whole numbers"), (dict(tags=[0, 1]), "tags must be 1515 whole numbers"), (dict(tags=np.full(1515, 0.5)), "whole numbers"),
    (dict(transforms={2: np.eye(3)}), "handle 2 must be a 4 x 4"), (dict(transforms={3: np.full((4, 4), np.nan)}), "handle 3")])
def test_arrays_of_other_shapes(change, words):
    vertices, faces, tags, lift = bar()
    with pytest.raises(ValueError, match=words):
        pymeshlab_fcd.deform(**{**dict(vertices=vertices, faces=faces, tags=tags, transforms={2: lift}), **change})


def test_what_the_readme_says(tmp_path):
    code = "\n".join(re.findall(r"^```python\n(.*?)^```$", (ROOT / "python" / "README.md").read_text(), re.M | re.S))
    assert code.count("pymeshlab_fcd.") >= 4
    code += "\nassert np.abs(bend(vertices) - positions).max() < 1.2e-3 and same_shape(moved, normals)"
    done = subprocess.run([sys.executable, "-c", "def same_shape(a, b): return a.shape == b.shape\n" + code], cwd=tmp_path, text=True,
                          stderr=subprocess.PIPE, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]


# --- saved deformations ---------------------------------------------------------------------------------------------------


def test_a_deformation_is_that_of_the_mesh(bend):
    vertices, faces, tags, lift = bar()
    positions = pymeshlab_fcd.deform(vertices, faces, tags, {2: lift})
    moved = bend(vertices)
    assert same(moved[tags == 0], vertices[tags == 0])
    assert np.linalg.norm(moved - positions, axis=1).max() < 1.1e-4 * 10


def test_the_same_bits_in_pieces_by_threads_and_after_pickling(bend, tmp_path):
    points = np.random.default_rng(1).uniform([-1, -1, -1], [11, 2, 1], (20000, 3))
    moved, normals = bend(points, np.tile([0.0, 0, 1], (len(points), 1)))
    assert same(bend(points), moved)
    assert same(bend(points, threads=3), moved) and same(bend(points, threads=0), moved)
    for size in (1, 7, 4096):
        part = points[:2000] if size == 1 else points
        assert same(np.concatenate([bend(part[k:k + size]) for k in range(0, len(part), size)]), moved[:len(part)])
    assert same(bend(points[::-1])[::-1].copy(), moved)
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        assert all(same(each, moved) for each in pool.map(lambda _: bend(points), range(8)))
    assert same(pickle.loads(pickle.dumps(bend))(points), moved)
    bend.save(tmp_path / "bend.ply")
    again = pymeshlab_fcd.Deformation.load(tmp_path / "bend.ply")
    assert same(again(points), moved)
    again.save(tmp_path / "again.ply")
    assert (tmp_path / "again.ply").read_bytes() == (tmp_path / "bend.ply").read_bytes()
    assert np.abs(np.linalg.norm(normals, axis=1) - 1).max() < 1e-12


def test_normals_turn_with_the_surface(bend):
    vertices, _, tags, lift = bar()
    _, normals = bend(vertices, np.tile([0.0, 0, 2], (len(vertices), 1)))
    assert same(normals[tags == 0], np.tile([0.0, 0, 2], ((tags == 0).sum(), 1)))
    assert np.abs(normals[tags == 2] - 2 * lift[:3, 2]).max() < 1e-5


def test_coordinates_are_double():
    # A survey in metres, far from its origin: a millimetre counts.
    vertices, faces, tags, _ = bar()
    origin = np.array([512345.0, 5412345.0, 300.0])
    lift = np.eye(4)
    lift[:3, 3] = [0, 0, 0.5]
    bend = pymeshlab_fcd.deformation(vertices + origin, faces, tags, {2: lift})
    moved = bend(vertices + origin) - origin
    assert np.abs(moved[tags == 2] - vertices[tags == 2] - [0, 0, 0.5]).max() < 2e-9
    assert same(moved[tags == 0], (vertices + origin)[tags == 0] - origin)


def test_odd_input(bend):
    assert bend(np.zeros((0, 3))).shape == (0, 3)
    assert same(bend([[5, 0, 0]]), bend(np.array([[5.0, 0, 0]], np.float32)))
    odd = np.array([[np.nan, 0, 0], [0, np.inf, 0], [9.5, 0.5, 0]])
    moved = bend(odd)
    assert same(moved[:2], odd[:2]) and moved[2, 2] > 1
    assert same(bend(np.asfortranarray(odd)), moved)
    for arguments, words in (((np.zeros(3),), "xyz must be n x 3"), ((np.zeros((2, 3)), np.zeros((3, 3))), "as many rows"), ((np.zeros((2, 2)),), "it is 2 x 2")):
        with pytest.raises(ValueError, match=words):
            bend(*arguments)
    with pytest.raises(ValueError, match="threads"):
        bend(odd, threads=-1)


def test_what_it_is_off_by_is_known(tmp_path, bend):
    vertices, faces, tags, lift = bar()
    off = np.linalg.norm(bend(vertices) - pymeshlab_fcd.deform(vertices, faces, tags, {2: lift}), axis=1).max()
    assert abs(bend.largest_difference - off) < 1e-6
    content = bend.__reduce__()[1][0]
    old = re.sub(rb"comment largest.*\ncomment CRC.*\n", b"", content).replace(b"version 2", b"version 1")
    before = pymeshlab_fcd.Deformation(old)
    assert before.largest_difference is None and same(before(vertices), bend(vertices))
    assert pickle.loads(pickle.dumps(bend)).largest_difference == bend.largest_difference


def test_a_bit_that_was_changed_is_an_error(bend):
    content, random = bend.__reduce__()[1][0], np.random.default_rng(0)
    for _ in range(300):
        changed = bytearray(content)
        changed[random.integers(len(changed))] ^= 1 << random.integers(8)
        with pytest.raises(ValueError):
            pymeshlab_fcd.Deformation(bytes(changed))


def test_a_file_is_replaced_as_a_whole_or_stays(tmp_path, bend):
    path, link = tmp_path / "bend.ply", tmp_path / "link.ply"
    path.write_bytes(b"old")
    path.chmod(0o640)
    link.symlink_to(path)
    limit = """
import resource, signal, sys, pymeshlab_fcd
bend = pymeshlab_fcd.Deformation.load(sys.argv[1])
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
try:
    bend.save(sys.argv[2])
except OSError:
    print("as a full disk")
"""
    bend.save(tmp_path / "new.ply")
    done = subprocess.run([sys.executable, "-c", limit, tmp_path / "new.ply", link], capture_output=True, text=True, check=True)
    assert "as a full disk" in done.stdout and path.read_bytes() == b"old"
    bend.save(link)
    assert link.is_symlink() and path.read_bytes() == (tmp_path / "new.ply").read_bytes() and path.stat().st_mode & 0o777 == 0o640
    assert sorted(file.name for file in tmp_path.iterdir()) == ["bend.ply", "link.ply", "new.ply"]


def test_files_that_hold_no_deformation(tmp_path, bend):
    with pytest.raises(FileNotFoundError):
        pymeshlab_fcd.Deformation.load(tmp_path / "none.ply")
    bend.save(tmp_path / "bend.ply")
    whole = (tmp_path / "bend.ply").read_bytes()
    (tmp_path / "cut.ply").write_bytes(whole[:-1])
    with pytest.raises(ValueError, match="cut.ply' has .* it is incomplete"):
        pymeshlab_fcd.Deformation.load(tmp_path / "cut.ply")
    with pytest.raises(ValueError, match="'deformation' is no saved deformation"):
        pymeshlab_fcd.Deformation(b"ply\n")


# --- other pymeshlabs -----------------------------------------------------------------------------------------------------

USE = """
import sys, warnings
{before}
with warnings.catch_warnings(record=True) as told:
    warnings.simplefilter("always")
    import pymeshlab_fcd
import numpy as np
print(len(told), *[str(w.message) for w in told])
print(pymeshlab_fcd.Deformation.load({path!r})(np.array([[9.5, 0.5, 0]]))[0, 2] > 1)
try:
    pymeshlab_fcd.deform(np.eye(3), None, [0, 1, 2], {{}})
except RuntimeError as error:
    print("RuntimeError:", error)
"""


@pytest.mark.parametrize("before, warned, words", [
    ("sys.modules['pymeshlab'] = None", 0, "pymeshlab cannot be imported"),
    ("import importlib.metadata as m; v = m.version; m.version = lambda name: '2031.1' if name == 'pymeshlab' else v(name)", 1,
     "pymeshlab 2031.1 is installed, and pymeshlab_fcd has plugins for 2022.2 and 2025.7")])
def test_without_a_pymeshlab_that_is_known(bend, tmp_path, before, warned, words):
    bend.save(tmp_path / "bend.ply")
    done = subprocess.run([sys.executable, "-c", USE.format(before=before, path=str(tmp_path / "bend.ply"))], text=True, timeout=300,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert done.returncode == 0, done.stderr[-2000:]
    first, works, error = done.stdout.splitlines()
    assert first.startswith(str(warned)) and (words in first) == bool(warned) and works == "True"
    assert error.startswith("RuntimeError: ") and words in error and "2022.2 and 2025.7" in error
