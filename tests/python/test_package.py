# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python package as it is installed from its wheel (tests/python_package.sh). Saved deformations, arrays, MeshSets."""
import concurrent.futures
import importlib.metadata
import os
import pickle
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pymeshlab
import pytest
from shapes import bar, same

import pymeshlab_fcd

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def bend():
    vertices, faces, tags, lift = bar()
    return pymeshlab_fcd.deformation(vertices, faces, tags, {2: lift})


# --- with pymeshlab -------------------------------------------------------------------------------------------------------


def test_it_is_the_installed_package_and_knows_this_pymeshlab():
    assert "site-packages" in pymeshlab_fcd.__file__ and ROOT / "python" not in Path(pymeshlab_fcd.__file__).parents
    assert {"generate_fcd_deformed_mesh", "generate_fcd_deformed_copy", "save_fcd_deformation", "apply_coord_fcd_deformation"} <= set(
        pymeshlab_fcd.enable_pymeshlab())
    assert all(hasattr(pymeshlab.MeshSet, name) for name in pymeshlab_fcd.enable_pymeshlab())  # any number of times
    assert pymeshlab_fcd.__version__ == importlib.metadata.version("pymeshlab-fcd")


def test_a_program_in_cpp_finds_the_library(tmp_path):
    def run(*command):
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout

    prefix = run(sys.executable, "-m", "pymeshlab_fcd.cmake").strip()
    run("cmake", "-S", str(ROOT / "examples" / "bend_arrays"), "-B", "build", f"-DCMAKE_PREFIX_PATH={prefix}")
    run("cmake", "--build", "build")
    assert re.fullmatch(r"\d+ nodes, \d+ iterations, moved by up to 3.162\n", run("build/bend_arrays"))


def test_a_checkout_has_no_library_for_cpp(tmp_path, monkeypatch):
    import pymeshlab_fcd.cmake
    monkeypatch.setattr(pymeshlab_fcd.cmake, "__file__", str(tmp_path / "cmake.py"))
    with pytest.raises(FileNotFoundError, match="this is no installed package. Install one with pip"):
        pymeshlab_fcd.cmake.prefix()


@pytest.mark.parametrize("enable, does", [("import pymeshlab_fcd", False), ("import pymeshlab_fcd_plugin", True),
                                          ("import pymeshlab_fcd; pymeshlab_fcd.enable_pymeshlab()", True)])
def test_import_leaves_pymeshlab_alone(enable, does):
    code = f"import sys; {enable}; print('pymeshlab' in sys.modules); import pymeshlab; print(hasattr(pymeshlab.MeshSet, 'generate_fcd_deformed_mesh'))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split()[-2:] == [str(does)] * 2


@pytest.fixture(scope="module", autouse=True)
def filters():
    pymeshlab_fcd.enable_pymeshlab()


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


def filtered(vertices, faces, tags, **parameters):
    """What the filter makes of them."""
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(vertices, faces, v_scalar_array=tags.astype(float)) if faces is not None else
                pymeshlab.Mesh(vertices, v_scalar_array=tags.astype(float)))
    result = ms.generate_fcd_deformed_mesh(graph_layers=False, **parameters)
    return ms.current_mesh().vertex_matrix(), result


@pytest.mark.parametrize("ours, its", [
    ({}, {}), (dict(patches=100), dict(initial_patches=100)), (dict(smoothness=0.05, tolerance=1e-4), dict(smoothness=0.05, tolerance=1e-4)),
    (dict(percent=40), dict(pose=40.0)), (dict(steps=3), dict(pose_steps=3)), (dict(seed=5, max_iterations=30), dict(random_seed=5, max_iterations=30)),
    (dict(graph_weights="uniform", distances="euclidean"), dict(graph_weights=1, weights=1)), (dict(graph_weights="paper"), dict(graph_weights=2)),
    (dict(graph_weights="printed"), dict(graph_weights=3)), (dict(falloff="sharp"), dict(falloff=2)), (dict(elastic=True), dict(elastic=True)), (dict(rigidity=0), dict(rigidity=0.0)), (dict(rigidity=0.3), dict(rigidity=0.3)),
    (dict(influence=3, loose_parts="stay"), dict(influence=3.0, loose_parts=1)),
    (dict(target_radius=0.4, weld_distance=1e-4), dict(target_radius=pymeshlab.PureValue(0.4), weld_distance=1e-4))])
@pytest.mark.parametrize("cloud", [False, True])
@pytest.mark.filterwarnings("ignore::pymeshlab_fcd.DeformationWarning")
def test_the_filter_gives_the_same_bits(ours, its, cloud):
    vertices, faces, tags, lift = bar()
    faces = None if cloud else faces
    mine = pymeshlab_fcd.deform(vertices, faces, tags, {2: lift}, **ours)
    theirs, result = filtered(vertices, faces, tags, transformmatrix=lift, **its)
    assert same(mine, theirs)
    of_poses = ("percent", "steps")
    deformer = pymeshlab_fcd.Deformer(vertices, faces, tags, **{name: value for name, value in ours.items() if name not in of_poses})
    pose = deformer.pose({2: lift}, **{name: value for name, value in ours.items() if name in of_poses})
    assert (pose.info.nodes, pose.info.iterations, pose.info.converged, pose.info.folded) == tuple(
        result[name] for name in ("nodes", "iterations", "converged", "folded_triangles"))
    assert (deformer.info.components, deformer.info.fixed, deformer.info.handle, deformer.info.free) == tuple(
        result[name] for name in ("components", "fixed_vertices", "handle_vertices", "free_vertices"))


def test_the_filter_gives_the_same_bits_for_steps_and_landmarks(tmp_path):
    vertices, faces, tags, _ = bar()
    turn = pymeshlab_fcd.Motion.rotate([0, 1, 0], -250, about=[9, 0, 0]).then(pymeshlab_fcd.Motion.translate([0.1, 0, 2]))
    mine = pymeshlab_fcd.deform(vertices, faces, tags, {2: turn}, percent=30)
    assert same(mine, filtered(vertices, faces, tags, pose=30.0, transforms="2: rotate 0 1 0 -250 about 9 0 0 translate 0.1 0 2")[0])
    start = vertices[-8] + [0.001, 0.002, 0]
    (tmp_path / "points.csv").write_text(", ".join(map(repr, map(float, [*start, *(start + [0, 0, 3])]))))
    left = np.where(tags == 0, 0, 1)
    mine = pymeshlab_fcd.deform(vertices, faces, left, points=[start], landmarks=[start + [0, 0, 3]])
    assert same(mine, filtered(vertices, faces, left, point_handles_file=str(tmp_path / "points.csv"))[0])


def test_stretch_and_deformation_are_those_of_the_filters(tmp_path):
    vertices, faces, tags, lift = bar()
    pose = pymeshlab_fcd.Deformer(vertices, faces, tags).pose({2: lift})
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(vertices, faces, v_scalar_array=tags.astype(float)))
    ms.generate_fcd_deformed_mesh(transformmatrix=lift, deformed_quality=1)
    assert (ms.current_mesh().vertex_scalar_array() == pose.stretch()).all()
    ms.save_fcd_deformation(source_layer=0, rest_graph=1, deformed_graph=2, deformation_file=str(tmp_path / "bend.ply"))
    assert pymeshlab_fcd.Deformation.load(tmp_path / "bend.ply") == pose.deformation()


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
    for arguments, words in (((np.zeros(3),), "xyz must be n x 3"), ((np.zeros((2, 3)), np.zeros((3, 3))), "normals must have 2 rows"), ((np.zeros((2, 2)),), "it is 2 x 2")):
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


WRITES = """
import os, resource, signal, sys, numpy as np, pymeshlab_fcd
how, folder = sys.argv[1:]
bend = pymeshlab_fcd.Deformation.load(folder + "/new.ply")
x, y = [grid.ravel() for grid in np.meshgrid(np.arange(20.0), np.arange(9.0))]
deformer = pymeshlab_fcd.Deformer(np.stack([x, y, 0 * x], 1), None, np.where(x < 3, 0, np.where(x > 16, 2, 1)))
poses = pymeshlab_fcd.PoseSequence({"pose": {2: pymeshlab_fcd.Motion.translate([0, 0, 3])}})
if how == "the disk is full":
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
if how == "killed in the middle":  # by Linux, where the file gets too large
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
if how == "killed at the end":
    os.replace = lambda *names: os.kill(os.getpid(), signal.SIGKILL)
else:
    resource.setrlimit(resource.RLIMIT_FSIZE, (10, 10))
for name, write in {"bend.ply": bend.save, "poses.csv": poses.save, "a.glb": lambda path: poses.write(deformer, gltf=path),
                    "a.pc2": lambda path: poses.write(deformer, pc2=path)}.items():
    if os.fork() == 0:
        try:
            write(folder + "/" + name)
            os._exit(1)
        except OSError:
            os._exit(2)
    print(name, os.waitstatus_to_exitcode(os.wait()[1]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="what limits and kills is Linux's")
@pytest.mark.parametrize("how, ends, beside", [("the disk is full", 2, 0), ("killed in the middle", -25, 4), ("killed at the end", -9, 4)])
def test_what_a_file_held_stays_whole_whatever_ends_a_write(tmp_path, bend, how, ends, beside):
    names = ("bend.ply", "poses.csv", "a.glb", "a.pc2")
    for name in names:
        (tmp_path / name).write_bytes(b"old")
    bend.save(tmp_path / "new.ply")
    done = subprocess.run([sys.executable, "-c", WRITES, how, tmp_path], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [f"{name} {ends}" for name in names], done.stderr
    assert all((tmp_path / name).read_bytes() == b"old" for name in names)
    assert len([file for file in tmp_path.iterdir() if file.name.endswith(".part")]) == beside


def test_a_file_is_replaced_where_a_link_leads_and_keeps_its_mode(tmp_path, bend):
    path, link = tmp_path / "bend.ply", tmp_path / "link.ply"
    path.write_bytes(b"old")
    path.chmod(0o640)
    link.symlink_to(path)
    bend.save(tmp_path / "new.ply")
    poses = pymeshlab_fcd.PoseSequence({"pose": "2: scale 2"})
    poses.save(link)
    assert link.is_symlink() and path.read_text() == poses.text()
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


def test_the_bits_are_those_of_no_library():
    """glibc computes sine and the like in other ways where it is told that the processor does not fuse products and sums."""
    def sums(*without):
        here = {**os.environ, "GLIBC_TUNABLES": "glibc.cpu.hwcaps=" + ",".join(f"-{name}" for name in without)}
        return subprocess.run([sys.executable, ROOT / "tests" / "bits.py"], env=here, capture_output=True, text=True, check=True).stdout

    usual = sums()
    assert len(usual.splitlines()) == 29 and usual == sums("AVX2", "FMA", "FMA4", "AVX2_Usable", "FMA_Usable")


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
x = np.arange(30.0)
lift = np.eye(4)
lift[2, 3] = 1
moved = pymeshlab_fcd.deform(np.stack([x, x % 3, 0 * x], 1), None, np.where(x < 4, 0, np.where(x > 25, 2, 1)), {{2: lift}})
assert (moved[:4, 2] == 0).all() and abs(moved[26:, 2] - 1).max() < 1e-9
try:
    pymeshlab_fcd.deform_layer(None, [0, 1, 2], {{}})
except RuntimeError as error:
    print("RuntimeError:", error)
"""


@pytest.mark.parametrize("before, words", [
    ("sys.modules['pymeshlab'] = None", "pymeshlab cannot be imported"),
    ("import pymeshlab; pymeshlab.filter_list = None", "cannot load the filters ('NoneType' object is not callable)"),
    ("import importlib.metadata as m; v = m.version; m.version = lambda name: '2031.1' if name == 'pymeshlab' else v(name)",
     "pymeshlab 2031.1 is installed, and there are filters for ... 2025.7"),
    ("import importlib.util as u; f = u.find_spec; u.find_spec = lambda name, *a: None if name == 'pymeshlab_fcd_plugin' else f(name, *a)",
     "MeshLab's filters are not installed: pip install . ./python/plugin"),
    ("sys.modules['pymeshlab_fcd_plugin'] = None", "MeshLab's filters are not installed")])
def test_without_a_pymeshlab_that_is_known(bend, tmp_path, before, words):
    bend.save(tmp_path / "bend.ply")
    done = subprocess.run([sys.executable, "-c", USE.format(before=before, path=str(tmp_path / "bend.ply"))], text=True, timeout=300,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert done.returncode == 0, done.stderr[-2000:]
    first, works, error = done.stdout.splitlines()
    assert first == "0" and works == "True"
    assert error.startswith("RuntimeError: ") and all(each in error for each in words.split(" ... "))
