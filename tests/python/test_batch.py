# SPDX-License-Identifier: GPL-3.0-or-later
"""python -m pymeshlab_fcd: one job on many files."""
import csv
import os
import signal
import subprocess
import sys
import time
import warnings

import numpy as np
import pytest
from shapes import bar

from pymeshlab_fcd import Deformer, Motion, _batch as batch, _splats, compensate, deform, deformation, fit, read_curves
from pymeshlab_fcd._batch import main
from pymeshlab_fcd._ply import Ply


def write_ply(path, vertices, faces=None, label=None, order="<", normals=None, quad=False):
    """Double positions, a float label and a colour of each vertex; faces with a colour; and an element that nobody knows."""
    label = np.zeros(len(vertices)) if label is None else label
    faces = np.zeros((0, 3), int) if faces is None else faces
    name = {"<": "binary_little_endian", ">": "binary_big_endian", "": "ascii"}[order]
    more = [] if normals is None else ["nx", "ny", "nz"]
    head = (f"ply\nformat {name} 1.0\ncomment kept\nelement vertex {len(vertices)}\n"
            + "".join(f"property {kind} {each}\n" for kind, each in [*(("double", each) for each in "xyz"), *(("float", each) for each in more),
                                                                      ("float", "quality"), ("uchar", "red")])
            + f"element face {len(faces)}\nproperty uchar region\nproperty list uchar int vertex_indices\nelement odd 2\nproperty list uchar short what\n"
              "end_header\n")
    rows = [(*p, *n, q, i % 251) for i, (p, n, q) in enumerate(zip(vertices, normals if more else [()] * len(vertices), label))]
    corners = [(i % 7, list(map(int, f))) for i, f in enumerate(faces)]
    if quad:  # the first two, as one of four
        corners[0:2] = [(9, [*corners[0][1], corners[1][1][1]])]
        head = head.replace(f"element face {len(faces)}", f"element face {len(corners)}")
    if order:
        o = order
        body = np.array(rows, [*((each, o + "f8") for each in "xyz"), *((each, o + "f4") for each in more), ("q", o + "f4"), ("r", "u1")]).tobytes()
        body += b"".join(bytes([region, len(f)]) + np.array(f, o + "i4").tobytes() for region, f in corners)
        body += b"\1\0\0\2\0\0\0\0"
    else:
        body = "".join([*(" ".join(map(repr, map(float, row[:-1]))) + f" {row[-1]}\n" for row in rows),
                        *(f"{region} {len(f)} {' '.join(map(str, f))}\n" for region, f in corners), "1 0\n2 0 0\n"]).encode()
    path.write_bytes(head.encode() + body)


@pytest.mark.parametrize("order", ["<", ">", ""])
@pytest.mark.parametrize("quad", [False, True])
def test_a_file_keeps_all_but_its_positions_to_the_byte(tmp_path, order, quad):
    vertices, faces, tags, _ = bar(9, 3)
    write_ply(tmp_path / "a.ply", vertices, faces, tags, order, quad=quad)
    ply = Ply(tmp_path / "a.ply")
    assert (ply.vertices == vertices).all() and (ply.column("quality") == tags).all() and ply.normals is None
    assert len(ply.faces) == len(faces) and (ply.faces[2:] == faces[2:]).all() and (quad or (ply.faces == faces).all())
    moved = vertices + [1, 2, 3]
    ply.save(tmp_path / "b.ply", moved, None)
    write_ply(tmp_path / "c.ply", moved, faces, tags, order, quad=quad)
    assert (tmp_path / "b.ply").read_bytes() == (tmp_path / "c.ply").read_bytes()
    for damage, message in ((lambda text: text[:200], "is no PLY file"), (lambda text: b"PK" + text, "is no PLY file"),
                            (lambda text: text[:text.index(b"end_header") + 40], "fewer vertices than it says"),
                            (lambda text: text.replace(b"double x", b"double a", 1), "no x, y, z"),
                            (lambda text: text.replace(b"float quality", b"half quality", 1), "cannot be read as PLY")):
        (tmp_path / "d.ply").write_bytes(damage((tmp_path / "a.ply").read_bytes()))
        with pytest.raises(ValueError, match=message):
            Ply(tmp_path / "d.ply")
    if not order and not quad:
        whole = (tmp_path / "a.ply").read_bytes().split(b"\n")
        first = whole.index(b"end_header") + 1 + len(vertices)
        (tmp_path / "d.ply").write_bytes(b"\n".join([*whole[:first], b"1 3 0"]) + b"\n")
        with pytest.raises(ValueError, match="fewer"):
            Ply(tmp_path / "d.ply")
    with pytest.raises(ValueError, match="have no tag; they have x, y, z, quality, red"):
        ply.column("tag")


def table(path):
    with open(path, newline="") as file:
        return {row["file"]: row for row in csv.DictReader(file)}


def scans(folder, count=3):
    """A template, and its scans: bent by so much, moved, each with landmarks."""
    vertices, faces, tags, _ = bar(41, 7)
    write_ply(folder / "template.ply", vertices, faces, tags)
    (folder / "marks").mkdir()
    for i in range(count):
        bent = deform(vertices, faces, tags, {2: Motion.rotate([0, 1, 0], 15 * i + 10, about=[5, 0, 0])}) + [0, 0, 1]
        write_ply(folder / f"scan{i}.ply", bent, faces)
        at = np.array([0, 6, 140, 280, 286])
        np.savetxt(folder / "marks" / f"scan{i}.csv", np.c_[vertices[at], bent[at]], delimiter=",")
    return vertices, faces, tags, [str(folder / f"scan{i}.ply") for i in range(count)]


def test_fits_are_those_of_the_package_and_are_not_done_twice(tmp_path, capsys):
    vertices, faces, tags, files = scans(tmp_path)
    command = ["fit", str(tmp_path / "template.ply"), *files, "--landmarks", str(tmp_path / "marks"), "--start", "landmarks_rigid",
               "--out", str(tmp_path / "out"), "--deformations"]
    (tmp_path / "marks" / "scan1.csv").rename(tmp_path / "later.csv")
    assert main(command) == 1
    said = capsys.readouterr()
    assert "3/3" in said.out and "1 of 3 files could not be done" in said.err and "failed: " in said.out and "scan1.csv" in said.out
    rows = table(tmp_path / "out" / "fit.csv")
    assert list(rows) == files and rows[files[1]]["error"] and not rows[files[0]]["error"]
    for i in (0, 2):
        scan, marks = Ply(files[i]), np.loadtxt(tmp_path / "marks" / f"scan{i}.csv", delimiter=",")
        fitted = fit(vertices, faces, scan.vertices, scan.faces, landmarks=(marks[:, :3], marks[:, 3:]), start="landmarks_rigid")
        made = Ply(tmp_path / "out" / f"scan{i}.ply")
        assert (made.vertices == fitted.vertices).all() and (made.column("quality") == tags).all()
        assert float(rows[files[i]]["rms"]) == fitted.info.rms and float(rows[files[i]]["matched"]) > 0.9
        assert (tmp_path / "out" / "deformations" / f"scan{i}.ply").stat().st_size > 1000

    (tmp_path / "later.csv").rename(tmp_path / "marks" / "scan1.csv")
    times = [(tmp_path / "out" / f"scan{i}.ply").stat().st_mtime_ns for i in (0, 2)]
    assert main(command) == 0  # what had failed, alone
    said = capsys.readouterr().out
    assert "2 of 3 files are done already" in said and said.count("rms") == 1
    assert [(tmp_path / "out" / f"scan{i}.ply").stat().st_mtime_ns for i in (0, 2)] == times
    assert not any(row["error"] for row in table(tmp_path / "out" / "fit.csv").values())
    (tmp_path / "out" / "scan0.ply").unlink()
    os.utime(files[2])  # which changes nothing in it
    marks = tmp_path / "marks" / "scan1.csv"
    known = marks.stat()
    marks.write_bytes(marks.read_bytes()[:-2] + marks.read_bytes()[-2:-3:-1] + b" ")  # as long, and as old
    os.utime(marks, ns=(known.st_atime_ns, known.st_mtime_ns))
    assert main(command) == 0 and capsys.readouterr().out.count("rms") == 2  # one is gone, one has changed
    assert main([*command, "--stiffness", "3"]) == 0 and capsys.readouterr().out.count("rms") == 3  # other options
    assert main([*command, "--stiffness", "3", "--again"]) == 0 and capsys.readouterr().out.count("rms") == 3


def test_fits_take_what_counts_and_how_stiff(tmp_path, capsys):
    vertices, faces, tags, files = scans(tmp_path, 1)
    half, of_scan = (vertices[:, 0] < 6) * 1.0, np.where(vertices[:, 1] > 0.2, 1.0, 0.5)
    write_ply(tmp_path / "template.ply", vertices, faces, half)
    scan = Ply(files[0])
    write_ply(tmp_path / "scan0.ply", scan.vertices, faces, of_scan)
    command = ["fit", str(tmp_path / "template.ply"), *files, "--out", str(tmp_path / "out")]
    made = []
    for options, given in (([], {}), (["--weights", "quality"], {"weights": half}), (["--target-weights", "quality"], {"target_weights": of_scan}),
                           (["--rigidity", "0.5"], {"rigidity": 0.5}), (["--largest-distance", "1"], {"largest_distance": 1}),
                           (["--both-ways"], {"both_ways": True})):
        assert main([*command, *options]) == 0
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            expected = fit(vertices, faces, scan.vertices, scan.faces, **given).vertices
        made.append(Ply(tmp_path / "out" / "scan0.ply").vertices)
        assert (made[-1] == expected).all(), options
    assert not any((other == made[0]).all() for other in made[1:4])
    (tmp_path / "scan0.obj").write_text("v 0 0 0\n")
    capsys.readouterr()
    assert main(["fit", str(tmp_path / "template.ply"), str(tmp_path / "scan0.obj"), "--out", str(tmp_path / "other"), "--target-weights", "quality"]) == 1
    assert "is no PLY file, so it has no quality" in capsys.readouterr().out


def test_curves_are_read_for_each_scan_or_for_all(tmp_path, capsys):
    vertices, faces, tags, files = scans(tmp_path, 2)
    (tmp_path / "curves").mkdir()
    def write(path, target, more=0):
        rows = [("edge", surface, *p) for surface, places in (("source", vertices[:287:7]), ("target", target[:287 - more:7])) for p in places.tolist()]
        path.write_text("curve,surface,x,y,z\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))
    for i in range(2):
        write(tmp_path / "curves" / f"scan{i}.csv", Ply(files[i]).vertices)
    command = ["fit", str(tmp_path / "template.ply"), *files, "--landmarks", str(tmp_path / "marks"), "--start", "landmarks_rigid", "--out",
               str(tmp_path / "out")]
    assert main([*command, "--curves", str(tmp_path / "curves")]) == 0
    rows = table(tmp_path / "out" / "fit.csv")
    for i, file in enumerate(files):
        scan, marks = Ply(file), np.loadtxt(tmp_path / "marks" / f"scan{i}.csv", delimiter=",")
        led = fit(vertices, faces, scan.vertices, scan.faces, landmarks=(marks[:, :3], marks[:, 3:]), start="landmarks_rigid",
                  curves=read_curves(tmp_path / "curves" / f"scan{i}.csv"))
        assert (Ply(tmp_path / "out" / f"scan{i}.ply").vertices == led.vertices).all()
        assert float(rows[file]["curve_residual"]) == led.info.curve_residual > 0
    capsys.readouterr()
    write(tmp_path / "curves" / "scan1.csv", Ply(files[1]).vertices, 70)
    assert main([*command, "--curves", str(tmp_path / "curves")]) == 0 and "1 of 2 files are done already" in capsys.readouterr().out
    first = str(tmp_path / "curves" / "scan0.csv")
    assert main([*command, "--curves", first]) == 0  # one file, for both, which the first one had
    assert "1 of 2 files are done already" in capsys.readouterr().out
    assert float(table(tmp_path / "out" / "fit.csv")[files[1]]["curve_residual"]) > 10 * float(rows[files[1]]["curve_residual"])
    (tmp_path / "curves" / "scan1.csv").unlink()
    assert main([*command, "--curves", str(tmp_path / "curves")]) == 1
    said = capsys.readouterr().out
    assert "failed: " in said and "scan1.csv" in said
    (tmp_path / "curves" / "scan1.csv").write_text("curve,surface,x,y,z\nedge,source,a,0,0\n")
    assert main([*command, "--curves", str(tmp_path / "curves")]) == 1
    assert "scan1.csv', line 2: expected a finite number" in capsys.readouterr().out


def test_processes_have_the_same_bits_and_carry_on_after_an_interrupt(tmp_path):
    _, _, _, files = scans(tmp_path, 6)
    command = [sys.executable, "-m", "pymeshlab_fcd", "fit", str(tmp_path / "template.ply"), *files]
    done = subprocess.run([*command, "--out", str(tmp_path / "one")], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    with subprocess.Popen([*command, "--out", str(tmp_path / "two"), "--processes", "2"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          start_new_session=True) as run:
        run.stdout.readline()
        if sys.platform != "win32":
            os.killpg(run.pid, signal.SIGINT)
            begin = time.monotonic()
            _, said = run.communicate(timeout=120)
            assert run.returncode in (0, 130) and time.monotonic() - begin < 60
            assert run.returncode == 0 or "goes on from here" in said
    done = subprocess.run([*command, "--out", str(tmp_path / "two"), "--processes", "2"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0 and "files are done already" in done.stdout, done.stderr
    for i in range(6):
        assert (tmp_path / "one" / f"scan{i}.ply").read_bytes() == (tmp_path / "two" / f"scan{i}.ply").read_bytes()


def test_meshes_are_deformed_carried_straightened_and_told_of(tmp_path, capsys):
    vertices, faces, tags, _ = bar(41, 7)
    (tmp_path / "lines").mkdir()
    normals = np.tile([0, 0, 1.0], (len(vertices), 1))
    for name in "ab":
        write_ply(tmp_path / f"{name}.ply", vertices, faces, tags, normals=normals)
        np.savetxt(tmp_path / "lines" / f"{name}.csv", np.c_[np.linspace(0, 10, 21), np.full((21, 2), [0.5, 0])], delimiter=",")
    files = [str(tmp_path / "a.ply"), str(tmp_path / "b.ply")]
    assert main(["deform", *files, "--move", "2", "rotate 0 1 0 170", "--deformations", "--out", str(tmp_path / "bent")]) == 0
    pose = Deformer(vertices, faces, tags, normals=normals).pose({2: Motion("rotate 0 1 0 170")}, check=False)
    bent = Ply(tmp_path / "bent" / "a.ply")
    assert (bent.vertices == pose.vertices).all() and (bent.normals == pose.normals.astype(np.float32)).all()
    row = table(tmp_path / "bent" / "deform.csv")[files[0]]
    assert int(row["contact"]) == pose.contact.triangles and row["converged"] == "True"

    assert main(["apply", str(tmp_path / "bent" / "deformations" / "a.ply"), *files, "--out", str(tmp_path / "carried")]) == 0
    off = float(table(tmp_path / "carried" / "apply.csv")[files[1]]["off_by"])
    assert abs(Ply(tmp_path / "carried" / "b.ply").vertices - pose.vertices).max() <= off * 1.0001 < 0.1
    write_ply(tmp_path / "far.ply", vertices + [0, 5e6, 0], faces, tags)
    assert main(["apply", str(tmp_path / "bent" / "deformations" / "a.ply"), str(tmp_path / "far.ply"), "--out", str(tmp_path / "far")]) == 0
    assert "same place and units first" in table(tmp_path / "far" / "apply.csv")[str(tmp_path / "far.ply")]["warnings"]
    assert main(["straighten", *files, "--lines", str(tmp_path / "lines"), "--degrees", "90", "--out", str(tmp_path / "arc")]) == 0
    row = table(tmp_path / "arc" / "straighten.csv")[files[0]]
    assert float(row["length"]) == pytest.approx(10, abs=0.1) and row["is_middle"] == "False"
    capsys.readouterr()
    assert main(["info", *files, str(tmp_path / "bent" / "deformations" / "a.ply")]) == 0
    said = capsys.readouterr().out
    assert f"vertices {len(vertices)}, faces {len(faces)}, low [0.0, 0.0, " in said and "samples " in said


def test_measurements_are_carried_and_the_mean_is_made(tmp_path, capsys):
    vertices, faces, _, files = scans(tmp_path)
    edge = faces[0]
    (tmp_path / "lengths.csv").write_text(f"# of the bar\nlong, distance, 0, {len(vertices) - 1}\naround, girth, {', '.join(map(str, edge))}\n"
                                          f"side, length, {edge[0]}, {edge[1]}\n")
    command = ["fit", str(tmp_path / "template.ply"), *files, "--landmarks", str(tmp_path / "marks"), "--start", "landmarks_rigid", "--measure",
               str(tmp_path / "lengths.csv"), "--mean", "--out", str(tmp_path / "out")]
    assert main(command) == 0
    assert "mean of 3 shapes" in capsys.readouterr().out
    made = [Ply(tmp_path / "out" / f"scan{i}.ply").vertices for i in range(3)]
    rows = table(tmp_path / "out" / "fit.csv")
    for file, places in zip(files, made):
        a, b, c = places[edge]
        assert float(rows[file]["measured: long"]) == np.linalg.norm(places[0] - places[-1])
        assert float(rows[file]["measured: side"]) == np.linalg.norm(a - b)
        assert float(rows[file]["measured: around"]) == pytest.approx(sum(np.linalg.norm(p - q) for p, q in ((a, b), (b, c), (c, a))))

    def laid(points, onto):
        middle = points - points.mean(0)
        u, _, v = np.linalg.svd(middle.T @ (onto - onto.mean(0)))
        return middle @ (u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v)

    mean = Ply(tmp_path / "out" / "mean.ply")
    centred = mean.vertices - mean.vertices.mean(0)
    assert np.abs(np.mean([laid(each, mean.vertices) for each in made], axis=0) - centred).max() < 1e-5
    assert np.abs(mean.vertices - made[0]).max() < np.abs(mean.vertices.mean(0)).max() + 20 and (mean.faces == faces).all()
    whole = [np.sqrt(((each - each.mean(0)) ** 2).sum(1).mean()) for each in made]
    command[command.index("--mean")] = "--mean=similar"  # what is done is not done again, but the mean is another one
    assert main(command) == 0 and "3 of 3 files are done already" in capsys.readouterr().out
    scaled = Ply(tmp_path / "out" / "mean.ply").vertices
    assert np.sqrt(((scaled - scaled.mean(0)) ** 2).sum(1).mean()) == pytest.approx(np.mean(whole), rel=1e-9)


@pytest.mark.parametrize("text, message", [
    ("waist, circumference, 1, 2", "must be: name, distance or length or girth"), ("waist", "must be: name"), ("a, girth, 1, x", "whole numbers from 0"),
    ("a, girth, 1, 2", "3 or more numbers"), ("a, distance, 1, 2, 3", "a distance has two numbers"), ("a, length, -1, 2", "from 0"),
    ("a, length, 1, 2\na, length, 1, 3", "a name of its own"), ("# none", "names no measurement")])
def test_measurements_that_cannot_be_are_refused_before_anything_is_done(tmp_path, capsys, text, message):
    (tmp_path / "lengths.csv").write_text(text + "\n")
    with pytest.raises(SystemExit):
        main(["deform", "a.ply", "--measure", str(tmp_path / "lengths.csv"), "--out", str(tmp_path / "out")])
    assert message in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_measurements_of_other_meshes_are_told(tmp_path, capsys, monkeypatch):
    vertices, faces, tags, _ = bar(9, 3)
    write_ply(tmp_path / "a.ply", vertices, faces, tags)
    for text, message in ((f"a, distance, 0, {len(vertices)}", f"there are only {len(vertices)}"), (f"a, length, 0, {len(vertices) - 1}", "which no edge joins: name each vertex")):
        (tmp_path / "lengths.csv").write_text(text)
        assert main(["deform", str(tmp_path / "a.ply"), "--measure", str(tmp_path / "lengths.csv"), "--out", str(tmp_path / "out")]) == 1
        assert message in capsys.readouterr().out
    with monkeypatch.context() as told:  # before the work, which a whole batch would do in vain
        told.setattr(batch, "_posed", None)
        assert main(["deform", str(tmp_path / "a.ply"), "--measure", str(tmp_path / "lengths.csv"), "--out", str(tmp_path / "out")]) == 1
        assert message in capsys.readouterr().out


def test_what_is_not_symmetric_becomes_so(tmp_path, capsys):
    i, k = np.meshgrid(np.arange(40), np.arange(60), indexing="ij")
    z, angle = np.cos(np.pi * (i + 0.5) / 40), 2 * np.pi * (k + 0.3) / 60
    sphere = np.stack([np.sqrt(1 - z**2) * np.cos(angle), np.sqrt(1 - z**2) * np.sin(angle), z], 2).reshape(-1, 3)
    whole = sphere * [0.7, 1, 0.85] * (1 + 0.2 * sphere[:, 1:2] * np.abs(sphere[:, :1]) + 0.1 * np.sin(4 * sphere[:, 2:]))
    here = i[:-1, :] * 60 + k[:-1, :]
    beside = i[:-1, :] * 60 + (k[:-1, :] + 1) % 60
    faces = np.concatenate([np.stack([here, here + 60, beside], 2).reshape(-1, 3), np.stack([beside, here + 60, beside + 60], 2).reshape(-1, 3)])
    sheared = whole + np.outer(0.1 * whole[:, 1], [1, 0, 0])
    write_ply(tmp_path / "skull.ply", sheared, faces)
    (tmp_path / "pairs").mkdir()
    left = np.array([[0.6, 0.5, 0.6], [0.5, -0.5, 0.7], [0.8, 0.1, -0.6]])
    near = [np.linalg.norm(whole - p * side, axis=1).argmin() for p in left for side in ([1, 1, 1], [-1, 1, 1])]
    np.savetxt(tmp_path / "pairs" / "skull.csv", sheared[near].reshape(-1, 6), delimiter=",")
    assert main(["symmetrize", str(tmp_path / "skull.ply"), "--pairs", str(tmp_path / "pairs"), "--landmark-tolerance", "0.05", "--deformations",
                 "--out", str(tmp_path / "out")]) == 0, capsys.readouterr().out
    row = table(tmp_path / "out" / "symmetrize.csv")[str(tmp_path / "skull.ply")]
    assert float(row["after"]) < 0.3 * float(row["before"]) and float(row["moved"]) > 0 and (tmp_path / "out" / "deformations" / "skull.ply").exists()
    assert main(["symmetrize", str(tmp_path / "skull.ply"), "--midlines", str(tmp_path / "pairs"), "--out", str(tmp_path / "out")]) == 1
    assert "must have 3 numbers, x, y, z, with points for decimals" in capsys.readouterr().out


@pytest.mark.parametrize("order", ["<", ">", ""])
def test_the_good_side_is_saved_where_the_other_one_is_missing(tmp_path, order):
    """All that its vertices carry is that of those it mirrors."""
    i, k = np.meshgrid(np.arange(40), np.arange(60), indexing="ij")
    z, angle = np.cos(np.pi * (i + 0.5) / 40), 2 * np.pi * (k + 0.3) / 60
    sphere = np.stack([np.sqrt(1 - z**2) * np.cos(angle), np.sqrt(1 - z**2) * np.sin(angle), z], 2).reshape(-1, 3)
    whole = sphere * [0.7, 1, 0.85] * (1 + 0.2 * sphere[:, 1:2] * np.abs(sphere[:, :1]) + 0.1 * np.sin(4 * sphere[:, 2:]))
    here, beside = i[:-1, :] * 60 + k[:-1, :], i[:-1, :] * 60 + (k[:-1, :] + 1) % 60
    faces = np.concatenate([np.stack([here, here + 60, beside], 2).reshape(-1, 3), np.stack([beside, here + 60, beside + 60], 2).reshape(-1, 3)])
    lost = np.linalg.norm(whole - whole[np.argmax(whole @ [1, 0.5, 0.5])], axis=1) < 0.35
    write_ply(tmp_path / "skull.ply", whole, faces[~lost[faces].any(axis=1)], np.arange(len(whole)), order, normals=sphere)
    command = ["symmetrize", str(tmp_path / "skull.ply"), "--other-side", "--out", str(tmp_path / "out")]
    assert main(command) == 0
    part, result = Ply(tmp_path / "out" / "other_side" / "skull.ply"), Ply(tmp_path / "out" / "skull.ply")
    assert len(part.faces) > 30 and part.names == result.names and part.faces.max() == len(part.vertices) - 1
    mirrored = part.column("quality").astype(int)  # the number of each vertex
    assert np.allclose(part.vertices, result.vertices[mirrored] * [-1, 1, 1], atol=0.02) and (part.column("red") == mirrored % 251).all()
    assert np.linalg.norm(part.vertices - whole[lost].mean(0), axis=1).max() < 0.5  # where it is missing
    assert np.allclose(part.normals, result.normals[mirrored] * [-1, 1, 1], atol=0.05)
    corner = part.vertices[part.faces]
    assert (np.einsum("ij,ij->i", np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), part.normals[part.faces[:, 0]]) > 0).all()
    (tmp_path / "out" / "other_side" / "skull.ply").unlink()
    assert main(command) == 0 and (tmp_path / "out" / "other_side" / "skull.ply").exists()  # made again


def test_parts_are_compensated_by_each_scan(tmp_path, capsys):
    x, y, z = (grid.ravel() for grid in np.meshgrid(np.linspace(-50, 50, 21), np.linspace(-30, 30, 13), [0.0, 9.0], indexing="ij"))
    nominal, a = np.stack([x, y, z], 1), np.arange(20 * 13).reshape(20, 13)[:, :-1].ravel() * 2
    low = np.concatenate([np.stack([a, a + 2, a + 26], 1), np.stack([a + 2, a + 28, a + 26], 1)])
    faces = np.concatenate([low, low[:, ::-1] + 1])
    up = np.outer(np.where(z > 0, 1, -1), [0, 0, 1])
    write_ply(tmp_path / "nominal.ply", nominal, faces, x, normals=up)
    for name, bend in (("a", 1e-4), ("b", -2e-4)):
        write_ply(tmp_path / f"{name}.ply", nominal + np.outer(bend * x**2, [0, 0, 1]), faces if name == "a" else None, normals=up)
    command = ["compensate", str(tmp_path / "nominal.ply"), str(tmp_path / "a.ply"), str(tmp_path / "b.ply"), "--degree", "4", "--out", str(tmp_path / "out")]
    assert main(command) == 0
    rows = table(tmp_path / "out" / "compensate.csv")
    for name in "ab":
        scan, made = Ply(tmp_path / f"{name}.ply"), Ply(tmp_path / "out" / f"{name}.ply")
        right = compensate(nominal, faces, scan.vertices, scan.faces, scan_normals=None if name == "a" else scan.normals, degree=4)
        assert (made.vertices == right.vertices).all() and (made.column("quality") == np.float32(x)).all() and (made.faces == faces).all()
        assert float(rows[str(tmp_path / f"{name}.ply")]["change_most"]) == right.info.change_most > 0.1
        corner = made.vertices[faces]
        across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        assert (np.einsum("ij,ij->i", across / np.linalg.norm(across, axis=1)[:, None], made.normals[faces[:, 0]]) > 0.99).all()
    capsys.readouterr()
    assert main(command) == 0 and "2 of 2 files are done already" in capsys.readouterr().out
    write_ply(tmp_path / "nominal.ply", nominal * [1, 1, 1.01], faces, x, normals=up)
    assert main(command) == 0 and "1/2" in capsys.readouterr().out  # it is another part
    with pytest.raises(SystemExit):
        main(["compensate", str(tmp_path / "nominal.ply"), str(tmp_path / "a.ply"), str(tmp_path / "nominal.ply"), "--out", str(tmp_path)])
    assert "would be written over what is read" in capsys.readouterr().err


def test_rows_are_added_and_half_a_row_is_not_counted(tmp_path, capsys):
    vertices, faces, tags, _ = bar(9, 3)
    files = [str(tmp_path / f"{name}.ply") for name in "abc"]
    for file in files:
        write_ply(tmp_path / file, vertices, faces, tags)
    command = ["deform", *files, "--move", "2", "translate 0 0 1", "--out", str(tmp_path / "o")]
    written = []
    whole = batch.Table.write
    batch.Table.write = lambda self: written.append(1) or whole(self)
    try:
        assert main(command) == 0 and len(written) == 2  # the columns, with the first one, and in the end
    finally:
        batch.Table.write = whole
    path = tmp_path / "o" / "deform.csv"
    text = path.read_bytes()
    path.write_bytes(text[:-30])  # as an interrupt may leave it
    capsys.readouterr()
    assert main(command) == 0 and "2 of 3 files are done already" in capsys.readouterr().out
    assert list(table(path)) == files and len(path.read_text().splitlines()) == 4


def test_a_dask_cluster_does_the_same(tmp_path, capsys):
    from dask.distributed import LocalCluster

    vertices, faces, tags, _ = bar(21, 5)
    for name in "ab":
        write_ply(tmp_path / f"{name}.ply", vertices, faces, tags)
    (tmp_path / "c.ply").write_text("nothing")
    files = [str(tmp_path / f"{name}.ply") for name in "abc"]
    command = ["deform", *files, "--move", "2", "rotate 0 1 0 60"]
    assert main([*command, "--out", str(tmp_path / "here")]) == 1
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        assert main([*command, "--scheduler", cluster.scheduler_address, "--out", str(tmp_path / "there")]) == 1
    for name in "ab":
        assert (tmp_path / "here" / f"{name}.ply").read_bytes() == (tmp_path / "there" / f"{name}.ply").read_bytes()
    rows = [table(tmp_path / folder / "deform.csv") for folder in ("here", "there")]
    assert [[row["error"] for row in each.values()] for each in rows][0] == [row["error"] for row in rows[1].values()]


def write_splats(path, points, scale, rotation, rest):
    names = ["x", "y", "z", *(f"f_dc_{i}" for i in range(3)), *(f"f_rest_{i}" for i in range(rest.shape[1])), "opacity",
             *(f"scale_{i}" for i in range(3)), *(f"rot_{i}" for i in range(4))]
    rows = np.concatenate([points, np.full((len(points), 3), 0.5), rest, np.ones((len(points), 1)), scale, rotation], axis=1).astype("<f4")
    path.write_bytes(("ply\nformat binary_little_endian 1.0\n" + f"element vertex {len(points)}\n"
                      + "".join(f"property float {name}\n" for name in names) + "end_header\n").encode() + rows.tobytes())


def turn_of(quaternion):
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


@pytest.mark.parametrize("rest", [0, 9, 24, 45])
def test_splats_turn_and_stretch_with_the_field(tmp_path, rest):
    vertices, faces, tags, _ = bar(21, 5)
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0], [0.48, 0.64, 0.6]])
    random = np.random.default_rng(3)
    points, scale, rotation = vertices[::4], random.normal(-3, 1, (len(vertices[::4]), 3)), random.normal(size=(len(vertices[::4]), 4))
    scale[-1, 0] = np.inf  # which stays as it is
    write_splats(tmp_path / "splats.ply", points, scale, rotation, random.normal(size=(len(points), rest)))
    for name, linear in (("turned", turn), ("stretched", turn @ np.diag([1.5, 1.0, 0.7]))):
        motion = np.eye(4)
        motion[:3, :3], motion[:3, 3] = linear, [3, 1, 2]
        bend = Deformer(vertices, faces, np.where(tags == 1, 1, 2)).pose({2: motion}, check=False).deformation()
        bend.save(tmp_path / f"{name}.fcd")
        assert main(["apply", str(tmp_path / f"{name}.fcd"), str(tmp_path / "splats.ply"), "--out", str(tmp_path / name)]) == 0
        before, after = Ply(tmp_path / "splats.ply"), Ply(tmp_path / name / "splats.ply")
        maps, names = bend.linear(before.vertices), before.names
        if name == "turned":
            assert np.abs(maps - turn).max() < 1e-5
        old, new = before.columns(), after.columns()
        at = {each: names.index(each) for each in names}
        for k in range(0, len(points) - 1, 7):
            shape = [turn_of(each[k, at["rot_0"]:at["rot_0"] + 4]) * np.exp(each[k, at["scale_0"]:at["scale_0"] + 3]) for each in (old, new)]
            wanted = maps[k] @ shape[0]
            assert np.allclose(shape[1] @ shape[1].T, wanted @ wanted.T, rtol=1e-3, atol=1e-4 * np.abs(wanted).max() ** 2)
        assert (old[-1, 6:] == new[-1, 6:]).all()
        for each in ("f_dc_0", "opacity"):
            assert (old[:, at[each]] == new[:, at[each]]).all()
        if rest:
            d = random.normal(size=(5, 3))
            d /= np.linalg.norm(d, axis=1, keepdims=True)
            u, _, v = np.linalg.svd(maps[0])
            seen = []
            for each, directions in ((old, d), (new, d @ (u @ v).T)):  # what shone there shines in the turned direction
                basis = np.concatenate([_splats._basis(band, directions) for band in (1, 2, 3)], axis=1)[:, :rest // 3]
                seen.append(basis @ each[0, at["f_rest_0"]:at["f_rest_0"] + rest].reshape(3, -1).T)
            assert np.abs(seen[0] - seen[1]).max() < 1e-4 and np.abs(old[0] - new[0])[at["f_rest_0"]:at["f_rest_0"] + rest].max() > 0.1


def test_the_harmonics_are_orthonormal():
    """By Gauss quadrature over the sphere: they are what they are called."""
    heights, weights = np.polynomial.legendre.leggauss(8)
    angle = 2 * np.pi * np.arange(16) / 16
    z, a = np.meshgrid(heights, angle, indexing="ij")
    d = np.stack([np.sqrt(1 - z**2) * np.cos(a), np.sqrt(1 - z**2) * np.sin(a), z], -1).reshape(-1, 3)
    basis = np.concatenate([_splats._basis(band, d) for band in (1, 2, 3)], axis=1)
    assert np.abs(basis.T @ (np.repeat(weights, 16)[:, None] * 2 * np.pi / 16 * basis) - np.eye(15)).max() < 1e-9


def test_wrong_commands_are_refused_before_anything_is_done(tmp_path, capsys):
    vertices, faces, tags, _ = bar(9, 3)
    (tmp_path / "other").mkdir()
    for folder in (tmp_path, tmp_path / "other"):
        write_ply(folder / "a.ply", vertices, faces, tags)
    here, other, bend = str(tmp_path / "a.ply"), str(tmp_path / "other" / "a.ply"), str(tmp_path / "bend.fcd")
    deformation(vertices, faces, tags, {2: Motion.translate([0, 0, 1])}).save(bend)
    for command, message in ((["deform", here, "--out", str(tmp_path)], "would be written over what is read"),
                             (["deform", here, other, "--out", str(tmp_path / "o")], "would have one result"),
                             (["deform", here, "--out", str(tmp_path / "o"), "--processes", "0"], "must be 1 or more"),
                             (["apply", bend, other, "--out", str(tmp_path / "other")], "would be written over what is read"),
                             (["deform", here], "--out"), (["bend", here], "invalid choice"), ([], "JOB")):
        with pytest.raises(SystemExit) as ended:
            main(command)
        assert ended.value.code == 2 and message in capsys.readouterr().err
    assert not (tmp_path / "o").exists()
    assert main(["deform", here, "--tags", "label", "--out", str(tmp_path / "o")]) == 1
    assert "have no label; they have x, y, z, quality, red" in capsys.readouterr().out
    assert main(["deform", here, "--out", str(tmp_path / "o")]) == 0
    assert "No handle moves" in table(tmp_path / "o" / "deform.csv")[here]["warnings"]
    write_ply(tmp_path / "a.ply", vertices, faces, tags + 0.5)
    assert main(["deform", here, "--out", str(tmp_path / "o")]) == 1
    assert "must be tags, whole numbers" in capsys.readouterr().out
