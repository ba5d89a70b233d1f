# SPDX-License-Identifier: GPL-3.0-or-later
"""The examples for surveys in tiles: LAS and LAZ in chunks, on one machine and on a local Dask cluster."""
import os
import subprocess
import sys
from pathlib import Path

import laspy
import numpy as np
import pytest
from solve_thinned import read, tell_doubts
from test_batch import write_ply
from warp_las import targets, warp
from warp_las_dask import warp_all

import pymeshlab_fcd

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

ORIGIN = np.array([512000.0, 5412000.0, 300.0])
SCALE = 0.001


def height(x, y):
    return 2 * np.sin(x / 9) + np.cos(y / 7)


@pytest.fixture(scope="module")
def sink(tmp_path_factory):
    """Terrain of 100 x 100 m of which the middle sinks by 2 m, solved on a thinned scan."""
    x, y = np.meshgrid(np.arange(0, 101.0), np.arange(0, 101.0), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), height(x, y).ravel()], 1)
    radius = np.linalg.norm(points[:, :2] - 50, axis=1)
    tags = np.where(radius > 40, 0, np.where(radius < 5, 2, 1))
    i = np.arange(101 * 101).reshape(101, 101)[:-1, :-1].ravel()
    faces = np.concatenate([np.stack([i, i + 101, i + 1], 1), np.stack([i + 1, i + 101, i + 102], 1)])
    down = np.eye(4)
    down[2, 3] = -2
    path = tmp_path_factory.mktemp("sink") / "sink.ply"
    pymeshlab_fcd.deformation(points + ORIGIN, faces, tags, {2: down}).save(path)
    return path


def write_tile(path, low, high, n, seed):
    """Random points of a tile, those on its border on a grid that neighbours share."""
    random = np.random.default_rng(seed)
    xy = random.uniform(low, high, (n, 2))
    edge = np.arange(0, 50.01, 0.25)
    for k, axis in enumerate((0, 0, 1, 1)):
        at = np.empty((len(edge), 2))
        at[:, axis] = (low if k % 2 else high)[axis]
        at[:, 1 - axis] = low[1 - axis] + edge
        xy[k * len(edge):(k + 1) * len(edge)] = at
    header = laspy.LasHeader(point_format=3, version="1.2")
    header.scales, header.offsets = [SCALE] * 3, ORIGIN
    las = laspy.LasData(header)
    las.x, las.y, las.z = xy[:, 0] + ORIGIN[0], xy[:, 1] + ORIGIN[1], height(*xy.T) + ORIGIN[2]
    las.intensity = random.integers(0, 65536, n)
    las.red = random.integers(0, 65536, n)
    las.classification = random.integers(0, 20, n)
    las.gps_time = random.uniform(0, 1e6, n)
    las.write(path)
    return path


@pytest.fixture(scope="module")
def tiles(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tiles")
    return [write_tile(folder / f"{x}_{y}.{kind}", np.array([x, y]) * 50.0, np.array([x, y]) * 50.0 + 50, 20000, 2 * x + y)
            for x, y, kind in ((0, 0, "las"), (0, 1, "laz"), (1, 0, "laz"), (1, 1, "las"))]


def xyz(las):
    return np.stack([las.x, las.y, las.z], 1)


def test_tiles_in_chunks(sink, tiles, tmp_path):
    done = subprocess.run([sys.executable, str(EXAMPLES / "warp_las.py"), str(sink), str(tmp_path / "out"), *map(str, tiles)], text=True,
                          stdout=subprocess.PIPE, timeout=300)
    assert done.returncode == 0 and done.stdout.count("20000 points") == 4
    bend = pymeshlab_fcd.Deformation.load(sink)
    border = {}
    for tile in tiles:
        before, after = laspy.read(tile), laspy.read(tmp_path / "out" / tile.name)
        assert np.abs(xyz(after) - bend(xyz(before))).max() < 0.51 * SCALE
        for name in ("intensity", "red", "classification", "gps_time", "return_number"):
            assert (np.asarray(before[name]) == np.asarray(after[name])).all(), name
        outside = np.linalg.norm(xyz(before)[:, :2] - ORIGIN[:2] - 50, axis=1) > 42
        assert outside.any() and (after.Z[outside] == before.Z[outside]).all() and (after.X[outside] == before.X[outside]).all()
        assert (xyz(before) - xyz(after))[:, 2].max() > 1.5
        for p, q in zip(xyz(before), xyz(after)):
            if 50 in np.round(p[:2] - ORIGIN[:2], 6):
                border.setdefault(tuple(np.round(p, 6)), []).append(q)
        warp(bend, tile, tmp_path / tile.name, chunk=1234)
        assert (laspy.read(tmp_path / tile.name).points.array == after.points.array).all()
    shared = [np.ptp(each, axis=0).max() for each in border.values() if len(each) > 1]
    assert len(shared) > 300 and max(shared) == 0  # no gap where tiles meet


def test_a_flat_tile_whose_heights_have_no_scale_gets_one(sink, tmp_path):
    header = laspy.LasHeader(point_format=3, version="1.2")
    header.scales, header.offsets = [SCALE, SCALE, 0.0], ORIGIN
    las = laspy.LasData(header)
    xy = np.random.default_rng(5).integers(0, 100000, (5000, 2))
    las.X, las.Y, las.Z = xy[:, 0], xy[:, 1], np.zeros(5000, int)
    las.write(tmp_path / "flat.las")
    bend = pymeshlab_fcd.Deformation.load(sink)
    assert warp(bend, tmp_path / "flat.las", tmp_path / "sunk.las", vectors=True) == 5000
    before, after = laspy.read(tmp_path / "flat.las"), laspy.read(tmp_path / "sunk.las")
    assert np.ptp(before.z) == 0 and np.ptp(after.z) > 1 and list(after.header.scales) == [SCALE] * 3
    assert np.abs(xyz(after) - bend(xyz(before))).max() < 0.51 * SCALE


def test_memory_is_bounded_by_the_chunk(sink, tmp_path):
    code = ("import re, sys; sys.path.insert(0, sys.argv[1]); import pymeshlab_fcd; from warp_las import warp; "
            "warp(pymeshlab_fcd.Deformation.load(sys.argv[2]), sys.argv[3], sys.argv[4], 50000); "
            "print(int(re.search(r'VmHWM:\\s+(\\d+)', open('/proc/self/status').read())[1]) // 1024)")
    peak = []
    for n in (60_000, 1_500_000):
        tile = write_tile(tmp_path / f"{n}.las", np.array([0.0, 0]), np.array([50.0, 50]), n, 1)
        peak.append(int(subprocess.run([sys.executable, "-c", code, str(EXAMPLES), str(sink), str(tile), str(tmp_path / "out.las")],
                                       stdout=subprocess.PIPE, check=True, text=True, timeout=300).stdout))
    assert (tmp_path / "out.las").stat().st_size > 50e6
    assert peak[1] - peak[0] < 12, peak  # MB


def test_a_dask_cluster_gives_the_same_files(sink, tiles, tmp_path):
    from dask.distributed import Client, LocalCluster

    bend = pymeshlab_fcd.Deformation.load(sink)
    (tmp_path / "dask").mkdir()
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        done = dict(warp_all(client, bend, tiles, tmp_path / "dask", chunk=3000))
    assert done == {tile.resolve(): 20000 for tile in tiles}
    for tile in tiles:
        warp(bend, tile, tmp_path / tile.name)
        one, other = laspy.read(tmp_path / tile.name), laspy.read(tmp_path / "dask" / tile.name)
        assert (one.points.array == other.points.array).all()


def test_landmarks_solved_on_thinned_tiles(tiles, tmp_path):
    lines = []
    for x, y, down in [(50, 50, 2)] + [(50 + 35 * np.cos(a), 50 + 35 * np.sin(a), 0) for a in np.arange(0, 2 * np.pi, 0.3)]:
        p = ORIGIN + [x, y, height(x, y)]
        lines.append(", ".join(map(repr, map(float, [*p, *(p - [0, 0, down])]))))
    (tmp_path / "landmarks.csv").write_text("x y z, to x, y, z\n" + "\n".join(lines) + " # the last\n\n")
    done = subprocess.run([sys.executable, str(EXAMPLES / "solve_thinned.py"), str(tmp_path / "landmarks.csv"), str(tmp_path / "bend.ply"), "2",
                           *map(str, tiles)], text=True, stdout=subprocess.PIPE, timeout=300)
    assert done.returncode == 0 and 2000 < int(done.stdout.split()[0]) < 8000
    assert "bend.ply is off by " in done.stdout
    bend = pymeshlab_fcd.Deformation.load(tmp_path / "bend.ply")
    at = np.array([[50, 50, height(50, 50)], [85, 50, height(85, 50)], [67, 50, height(67, 50)]]) + ORIGIN
    moved = bend(at) - at
    less = tmp_path / "less.las"
    less.write_bytes(tiles[0].read_bytes()[:-1000 * laspy.open(tiles[0]).header.point_format.size])
    for wrong, said in ((["0", str(tiles[0])], "the spacing must be a positive number; it is 0.0."),
                        ([str(tiles[0]), str(tiles[1])], f"the spacing, a number before the tiles, is expected; there is '{tiles[0]}'."),
                        (["2", str(tiles[0]), "--accuracy"], "a number after --accuracy is expected; there is ''."),
                        (["2", str(tiles[1]), str(less)], f"{less}: it is cut short: it has 19000 of its 20000 points.")):
        done = subprocess.run([sys.executable, str(EXAMPLES / "solve_thinned.py"), str(tmp_path / "landmarks.csv"), str(tmp_path / "no.ply"), *wrong],
                              text=True, stderr=subprocess.PIPE, timeout=300)
        assert done.returncode == 1 and done.stderr == f"{said}\n" and not (tmp_path / "no.ply").exists()
    (tmp_path / "short.csv").write_text("1; 2; 3\n")
    with pytest.raises(ValueError, match="landmark 1 of .*short.csv has 3 numbers; give 6"):
        read(str(tmp_path / "short.csv"))
    (tmp_path / "word.csv").write_text("1 2 3 1 2 3\n1 2 3 1 2 3m\n")
    with pytest.raises(ValueError, match="a number in landmark 2 of .*word.csv is expected; there is '3m'"):
        read(str(tmp_path / "word.csv"))
    assert abs(moved[0, 2] + 2) < 0.2 and abs(moved[1, 2]) < 0.1 and -1.9 < moved[2, 2] < -0.1


def test_tiles_in_ply_give_what_those_in_las_give(tiles, tmp_path):
    """The same landmarks and the same points; one point more has no place, as of a depth camera."""
    places = np.array([[10, 10], [90, 10], [10, 90], [90, 90], [50, 50.0]])
    start = np.column_stack([places, height(*places.T)]) + ORIGIN
    np.savetxt(tmp_path / "landmarks.csv", np.hstack([start, start - ([[0, 0, 0]] * 4 + [[0, 0, 3]])]), "%.4f", ",")
    clouds = [tmp_path / f"{tile.stem}.PLY" for tile in tiles]
    for tile, cloud in zip(tiles, clouds):
        write_ply(cloud, np.vstack([xyz(laspy.read(tile)), [[np.nan] * 3]]))
    for given, accuracy, name in ((tiles, "0.02", "las"), (clouds, "0.02", "ply"), (clouds, "0.002", "near")):
        subprocess.run([sys.executable, str(EXAMPLES / "solve_thinned.py"), str(tmp_path / "landmarks.csv"), str(tmp_path / name), "2",
                        "--accuracy", accuracy, *map(str, given)], check=True, timeout=300)
    las, ply, near = ((tmp_path / name) for name in ("las", "ply", "near"))
    assert las.read_bytes() == ply.read_bytes()
    assert 0.002 < pymeshlab_fcd.Deformation.load(ply).largest_difference <= 0.02
    assert pymeshlab_fcd.Deformation.load(near).largest_difference <= 0.002


def test_landmarks_beside_the_survey_and_too_few_points_are_told(capsys):
    points = ORIGIN + np.stack(np.meshgrid(np.arange(0, 20, 2.0), np.arange(0, 20, 2.0), [0.0]), -1).reshape(-1, 3)
    tell_doubts(points[[0, 57]] + [0, 0, 3.4], points, 2)  # a cube of 2 has a diagonal of 3.46
    assert capsys.readouterr().err == ""
    tell_doubts(points[[0, 57]] - [[0, 0, 0], [0, 0, 250]], points, 2)
    assert capsys.readouterr().err == \
        "landmark 2 is 250 from the nearest kept point, which moves in its place: check its coordinates\n"
    tell_doubts(points[[0, 96]], points[::6], 2)
    assert capsys.readouterr().err == "only 17 points are kept for 2 landmarks, and little bends between them: take a smaller spacing\n"
    with pytest.raises(ValueError, match="only 2 points are kept for 2 landmarks, so none can bend: take a smaller spacing"):
        tell_doubts(points[[0, 96]], points[::60], 2)


# --- what must not be lost ---


def write_rich(path, version="1.4"):
    """A tile with a coordinate system in an EVLR, a VLR, and normals in extra dimensions."""
    header = laspy.LasHeader(point_format=6, version=version)
    header.scales, header.offsets = [SCALE] * 3, ORIGIN
    header.vlrs.append(laspy.VLR("house", 7, "ours", b"kept"))
    header.add_extra_dims([laspy.ExtraBytesParams(name, np.float32) for name in ("NormalX", "NormalY", "NormalZ")])
    header.add_extra_dims([laspy.ExtraBytesParams("amplitude", np.int16)])
    las = laspy.LasData(header)
    xy = np.random.default_rng(3).uniform(0, 100, (5000, 2))
    las.x, las.y, las.z = xy[:, 0] + ORIGIN[0], xy[:, 1] + ORIGIN[1], height(*xy.T) + ORIGIN[2]
    las["NormalX"], las["NormalY"], las["NormalZ"] = np.zeros(5000), np.zeros(5000), np.full(5000, 2.0)
    las["amplitude"] = np.arange(5000)
    las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("LASF_Projection", 2112, "WKT", b'PROJCS["somewhere"]\0'), laspy.VLR("house", 8, "", b"x" * 70000)])
    las.write(path)
    return path


@pytest.mark.parametrize("kind", ["las", "laz"])
def test_records_coordinate_systems_and_normals_come_along(sink, tmp_path, kind):
    source = write_rich(tmp_path / f"rich.{kind}")
    warp(pymeshlab_fcd.Deformation.load(sink), source, tmp_path / "out" / f"rich.{kind}", chunk=700)
    before, after = laspy.read(source), laspy.read(tmp_path / "out" / f"rich.{kind}")

    def records(list_of):
        return [(each.user_id, each.record_id, each.record_data_bytes()) for each in list_of if each.user_id != "LASF_Spec"]  # laspy's own

    assert len(records(before.evlrs)) == 2 and records(after.evlrs) == records(before.evlrs) and records(after.vlrs) == records(before.vlrs)
    assert "PROJCS" in str(after.evlrs[0].string)
    assert (after["amplitude"] == before["amplitude"]).all() and after.point_format == before.point_format
    normals = np.stack([after[name] for name in ("NormalX", "NormalY", "NormalZ")], 1)
    radius = np.linalg.norm(xyz(before)[:, :2] - ORIGIN[:2] - 50, axis=1)
    assert np.abs(np.linalg.norm(normals, axis=1) - 2).max() < 1e-5
    assert (normals[radius > 42] == [0, 0, 2]).all() and np.abs(normals[(radius > 15) & (radius < 30)][:, :2]).max() > 0.05


def test_no_tile_is_written_over_one_that_is_read(sink, tiles, tmp_path):
    bend = pymeshlab_fcd.Deformation.load(sink)
    tile = tmp_path / "a" / "tile.las"
    tile.parent.mkdir()
    tile.write_bytes(tiles[0].read_bytes())
    (tmp_path / "link").symlink_to(tmp_path / "a")
    for folder in ("a", "link"):
        done = subprocess.run([sys.executable, str(EXAMPLES / "warp_las.py"), str(sink), str(tmp_path / folder), str(tile)], text=True,
                              stderr=subprocess.PIPE)
        assert done.returncode == 1 and "which is to be read. Give another folder" in done.stderr
        with pytest.raises(ValueError, match="over itself"):
            warp(bend, tile, tmp_path / folder / "tile.las")
    assert tile.read_bytes() == tiles[0].read_bytes()


def test_tiles_of_one_name_keep_their_folders(tmp_path):
    tiles = [tmp_path / "east" / "1.laz", tmp_path / "west" / "1.laz", tmp_path / "west" / "2.laz"]
    assert sorted(goal.relative_to(tmp_path / "out") for goal in targets(tiles, tmp_path / "out").values()) == [
        Path("east/1.laz"), Path("west/1.laz"), Path("west/2.laz")]
    assert [goal.name for goal in targets(tiles[1:], tmp_path / "out").values()] == ["1.laz", "2.laz"]
    assert len(set(targets([tiles[0], tmp_path / "west" / "1.LAZ"], tmp_path / "out").values())) == 2
    assert len(targets([tiles[0], tiles[0]], tmp_path / "out")) == 1


def test_a_bad_tile_is_told_at_the_end(sink, tiles, tmp_path):
    bad = tmp_path / "bad.las"
    bad.write_bytes(b"LASF" + bytes(300))
    cut = tmp_path / "cut.las"
    cut.write_bytes(tiles[0].read_bytes()[:-30000])
    whole, less, scaleless = tiles[0].read_bytes(), tmp_path / "less.las", tmp_path / "scaleless.las"
    less.write_bytes(whole[:-1000 * laspy.open(tiles[0]).header.point_format.size])  # by whole points, which laspy does not tell
    scaleless.write_bytes(whole[:131] + np.array(np.nan, "<f8").tobytes() + whole[139:])
    for script in ("warp_las.py", "warp_las_dask.py"):
        out = tmp_path / script
        done = subprocess.run([sys.executable, str(EXAMPLES / script), str(sink), str(out), str(bad), str(tiles[0]), str(tmp_path / "none.las"),
                               str(tiles[1]), str(cut), str(less), str(scaleless), str(tiles[0])], text=True, capture_output=True, timeout=300)
        assert done.returncode == 1 and done.stdout.count("20000 points") == 2
        said = done.stderr[done.stderr.index("5 of 7 tiles could not be deformed:"):]
        assert all(str(each) in said for each in (bad, cut, tmp_path / "none.las"))
        assert f"{less}: it is cut short: it has 19000 of its 20000 points" in said
        assert f"{scaleless}: it has no numbers as scale and offset of its coordinates" in said
        assert sorted(each.name for each in out.iterdir()) == sorted(tile.name for tile in tiles[:2])


def test_a_full_disk_or_a_kill_leaves_what_was_there(sink, tiles, tmp_path):
    target = tmp_path / "tile.las"
    target.write_bytes(b"old")
    limited = ("import resource, signal, sys; sys.path.insert(0, sys.argv[1]); from warp_las import warp; import pymeshlab_fcd\n"
               "signal.signal(signal.SIGXFSZ, signal.SIG_IGN); resource.setrlimit(resource.RLIMIT_FSIZE, (300000, 300000))\n"
               "try:\n    warp(pymeshlab_fcd.Deformation.load(sys.argv[2]), sys.argv[3], sys.argv[4], 1000)\n"
               "except OSError:\n    print('as a full disk')")
    done = subprocess.run([sys.executable, "-c", limited, str(EXAMPLES), str(sink), str(tiles[0]), str(target)], text=True, stdout=subprocess.PIPE)
    assert "as a full disk" in done.stdout and target.read_bytes() == b"old" and [each.name for each in tmp_path.iterdir()] == ["tile.las"]
    killed = ("import os, signal, sys; sys.path.insert(0, sys.argv[1]); from warp_las import warp; import pymeshlab_fcd\n"
              "bend = pymeshlab_fcd.Deformation.load(sys.argv[2]); calls = []\n"
              "def dies(xyz, threads):\n    calls.append(1)\n    return bend(xyz) if len(calls) < 5 else os.kill(os.getpid(), signal.SIGKILL)\n"
              "warp(dies, sys.argv[3], sys.argv[4], 1000)")
    done = subprocess.run([sys.executable, "-c", killed, str(EXAMPLES), str(sink), str(tiles[0]), str(target)])
    assert done.returncode == -9 and target.read_bytes() == b"old" and len(list(tmp_path.glob("tile.las.*.part"))) == 1
    running, other = tmp_path / f"tile.las.{os.getppid()}.part", tmp_path / "a tile.las.999999999.part"
    running.write_bytes(b"")
    other.write_bytes(b"")
    warp(pymeshlab_fcd.Deformation.load(sink), tiles[0], target)
    assert sorted(tmp_path.iterdir()) == sorted([target, running, other]) and target.stat().st_size > 3


def test_a_tile_with_an_octree_becomes_an_ordinary_one(tmp_path):
    """The records of COPC 1.0 tell where the octree is in the file."""
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.scales = [SCALE] * 3
    header.vlrs += [laspy.VLR("copc", 1, "COPC info VLR", bytes(160)), laspy.VLR("own", 7, "", b"abc")]
    las = laspy.LasData(header)
    las.xyz = np.random.default_rng(0).random((100, 3))
    las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("copc", 1000, "EPT hierarchy", bytes(32)), laspy.VLR("own", 8, "", b"def")])
    las.write(tmp_path / "a.copc.laz")
    goal = targets([tmp_path / "a.copc.laz"], tmp_path / "o")[tmp_path / "a.copc.laz"]
    assert goal == tmp_path / "o" / "a.laz" and warp(lambda points, threads: points + [0, 0, 1], tmp_path / "a.copc.laz", goal) == 100
    made = laspy.read(goal)
    assert [each.record_data_bytes() for each in [*made.vlrs, *made.evlrs]] == [b"abc", b"def"]
    assert np.abs(xyz(made) - xyz(las) - [0, 0, 1]).max() < 1e-9
    las.write(tmp_path / "a.laz")
    with pytest.raises(ValueError, match="two of the tiles would be written to one file"):
        targets([tmp_path / "a.copc.laz", tmp_path / "a.laz"], tmp_path / "o")


def test_vectors_and_distances_are_extra_dimensions(sink, tiles, tmp_path):
    done = subprocess.run([sys.executable, str(EXAMPLES / "warp_las.py"), str(sink), str(tmp_path / "out"), "--vectors", str(tiles[0])], text=True,
                          capture_output=True, timeout=300)
    assert done.returncode == 0, done.stderr
    bend = pymeshlab_fcd.Deformation.load(sink)
    before, after = laspy.read(tiles[0]), laspy.read(tmp_path / "out" / tiles[0].name)
    way = bend(xyz(before)) - xyz(before)
    names = ["displacement_x", "displacement_y", "displacement_z"]
    assert np.abs(np.stack([after[name] for name in names], 1) - way).max() < 1e-6 and np.abs(way).max() > 1
    assert np.abs(after["displacement"] - np.linalg.norm(way, axis=1)).max() < 1e-6
    assert (after.intensity == before.intensity).all() and (after.gps_time == before.gps_time).all()
    assert np.abs(xyz(after) - xyz(before) - way).max() < 0.51 * SCALE
    with pytest.warns(UserWarning, match="has displacement_x.* already.*displacement_2_x"):
        warp(bend, tmp_path / "out" / tiles[0].name, tmp_path / "again.las", vectors=True)
    again = laspy.read(tmp_path / "again.las")
    assert len(list(again.point_format.extra_dimensions)) == 8 and (again["displacement"] == after["displacement"]).all()
    assert np.abs(again["displacement_2"] - np.linalg.norm(bend(xyz(after)) - xyz(after), axis=1)).max() < 1e-6
    assert np.abs(again["displacement_2_z"] - (bend(xyz(after)) - xyz(after))[:, 2]).max() < 1e-6


@pytest.mark.parametrize("far", [2 ** 31 - 1500, 2 ** 31 - 1])  # of the offset, in whole numbers; and that to both sides
def test_a_tile_whose_numbers_reach_no_farther_gets_others(tmp_path, far):
    header = laspy.LasHeader(point_format=3, version="1.4")
    header.scales, header.offsets = [SCALE] * 3, ORIGIN
    las = laspy.LasData(header)
    las.X, las.Y, las.Z = ([0, 5, far if axis == 2 else 7, -far if far == 2 ** 31 - 1 and axis == 2 else 7] for axis in range(3))
    las.intensity = [1, 2, 3, 4]
    las.write(tmp_path / "far.las")

    def bend(points, threads=1):
        return points + [0, 0, 3]

    assert warp(bend, tmp_path / "far.las", tmp_path / "moved.las", chunk=2) == 4
    made = laspy.read(tmp_path / "moved.las")
    coarse = far == 2 ** 31 - 1  # then no offset helps
    assert list(made.header.scales) == pytest.approx([SCALE, SCALE, 10 * SCALE if coarse else SCALE])
    assert (made.header.offsets[:2] == ORIGIN[:2]).all() and made.header.offsets[2] != ORIGIN[2]
    assert np.abs(xyz(made) - xyz(las) - [0, 0, 3]).max() < 0.51 * made.header.scales[2]
    assert list(made.intensity) == [1, 2, 3, 4]
