# SPDX-License-Identifier: GPL-3.0-or-later
"""python -m pymeshlab_fcd: whose a result is, what ends it, and files as others write them."""
import argparse
import csv
import inspect
import os
import re
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from shapes import bar
from test_batch import scans, table, write_ply

import pymeshlab_fcd as fcd
from pymeshlab_fcd import Deformer, Motion, _files, _fit, _pose, _straighten, _symmetrize, _tables, read_curves
from pymeshlab_fcd._batch import _parsers, _tried, main
from pymeshlab_fcd._ply import Ply
from pymeshlab_fcd._results import Table


def refused(capsys, command):
    with pytest.raises(SystemExit) as ended:
        main([str(each) for each in command])
    assert ended.value.code == 2
    return capsys.readouterr().err


def test_a_result_is_of_one_file_and_one_job(tmp_path, capsys, monkeypatch):
    vertices, faces, tags, _ = bar(9, 3)
    out = tmp_path / "o"
    for name in "ab":
        (tmp_path / name).mkdir()
        write_ply(tmp_path / name / "x.ply", vertices + [0, 0, ord(name)], faces, tags)
    lift = ["--move", "2", "translate 0 0 1", "--out", str(out)]
    command = ["deform", str(tmp_path / "a" / "x.ply"), *lift]
    assert main(command) == 0
    made = (out / "x.ply").read_bytes()
    said = refused(capsys, ["deform", tmp_path / "b" / "x.ply", *lift])
    assert f"x.ply is what deform made of {tmp_path / 'a' / 'x.ply'}: give another folder, or delete it first" in said
    monkeypatch.chdir(tmp_path / "b")  # by a name that the other one could have, too
    assert "is what deform made of" in refused(capsys, ["deform", "x.ply", *lift])
    Deformer(vertices, faces, tags).pose({2: Motion.translate([0, 0, 1])}).deformation().save(tmp_path / "bend.fcd")
    assert "is what deform made of" in refused(capsys, ["apply", tmp_path / "bend.fcd", tmp_path / "a" / "x.ply", "--out", out])
    assert "is what deform made of" in refused(capsys, ["symmetrize", tmp_path / "b" / "x.ply", "--again", "--out", out])
    monkeypatch.chdir(tmp_path / "a")
    assert main(["deform", "x.ply", *lift]) == 0 and "1 of 1 files are done already" in capsys.readouterr().out  # the same one
    assert (out / "x.ply").read_bytes() == made
    (out / "x.ply").write_bytes(made[:-1] + b"?")
    assert main(command) == 0 and "done already" not in capsys.readouterr().out and (out / "x.ply").read_bytes() == made
    assert len(table(out / "deform.csv")) == 1
    (out / "x.ply").unlink()  # it is free
    assert main(["deform", str(tmp_path / "b" / "x.ply"), *lift]) == 0
    assert main([*command, "--deformations", "--out", str(tmp_path / "p")]) == 0
    (tmp_path / "p" / "deformations" / "x.ply").unlink()
    assert main([*command, "--deformations", "--out", str(tmp_path / "p")]) == 0 and (tmp_path / "p" / "deformations" / "x.ply").exists()
    (tmp_path / "p" / "symmetrize.csv").write_text("my,own\n1,2\n")
    assert "is no table of results" in refused(capsys, ["symmetrize", tmp_path / "b" / "x.ply", "--out", tmp_path / "p"])


def test_files_that_were_there_before_are_not_replaced(tmp_path, capsys):
    vertices, faces, tags, _ = bar(9, 3)
    for name in ("in", "own", "own/deformations"):
        (tmp_path / name).mkdir()
    write_ply(tmp_path / "in" / "x.ply", vertices, faces, tags)
    command = ["deform", str(tmp_path / "in" / "x.ply"), "--move", "2", "translate 0 0 1", "--deformations", "--out", str(tmp_path / "own")]
    for own in (tmp_path / "own" / "x.ply", tmp_path / "own" / "deformations" / "x.ply"):
        own.write_bytes(b"mine")
        assert f"{own} is there already, and no table there says that it is a result: move it" in refused(capsys, command)
        assert own.read_bytes() == b"mine" and not (tmp_path / "own" / "deform.csv").exists()
        own.unlink()
    assert main(command) == 0


def test_what_an_interrupted_command_left_is_replaced(tmp_path, monkeypatch):
    """Also if its first file was done, and its row not yet written."""
    vertices, faces, tags, _ = bar(9, 3)
    write_ply(tmp_path / "x.ply", vertices, faces, tags)
    command = ["deform", str(tmp_path / "x.ply"), "--move", "2", "translate 0 0 1", "--out", str(tmp_path / "o")]

    def interrupted(*given):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Table, "add", interrupted)
        assert main(command) == 130 and (tmp_path / "o" / "x.ply").exists()
    assert main(command) == 0


def test_files_are_known_wherever_they_are(tmp_path, capsys, monkeypatch):
    """By what is in them: a folder may be moved, copied, or be another one's link; nothing of it is done again, and nothing is another's."""
    vertices, faces, tags, _ = bar(9, 3)
    scans = tmp_path / "job" / "scans"
    scans.mkdir(parents=True)
    for name in "ab":
        write_ply(scans / f"{name}.ply", vertices + [0, 0, ord(name)], faces, tags)

    def run(job, *given, scans="scans"):
        monkeypatch.chdir(job)
        status = main(["deform", *(str(job / scans / f"{name}.ply") for name in "ab"), "--move", "2", "translate 0 0 1", "--out", "out", *given])
        return status, "2 of 2 files are done already" in capsys.readouterr().out, list(table(job / "out" / "deform.csv"))

    first = run(tmp_path / "job")
    assert first[:2] == (0, False) and run(tmp_path / "job")[:2] == (0, True)
    (tmp_path / "job").rename(tmp_path / "moved")
    moved = run(tmp_path / "moved")
    assert moved[:2] == (0, True) and len(moved[2]) == 2
    shutil.copytree(tmp_path / "moved", tmp_path / "copied", copy_function=shutil.copyfile)  # with other times
    assert run(tmp_path / "copied")[:2] == (0, True)
    (tmp_path / "copied" / "scans").rename(tmp_path / "copied" / "elsewhere")  # beside the results
    again = run(tmp_path / "copied", scans="elsewhere")
    assert again[:2] == (0, True)
    other = run(tmp_path / "copied", "--percent", "50", scans="elsewhere")
    assert other[:2] == (0, False) and len(other[2]) == 2 and all("elsewhere" in name for name in other[2])
    (tmp_path / "copied" / "elsewhere").rename(tmp_path / "copied" / "third")
    third = run(tmp_path / "copied", scans="third")  # with other options, too
    assert third[:2] == (0, False) and len(third[2]) == 2 and all("third" in name for name in third[2])


def test_an_option_that_is_not_given_counts_for_nothing():
    """So that what an earlier version did, which had fewer, is done."""
    from pymeshlab_fcd import _batch

    jobs = _batch._parsers()[1]
    given = _batch._parsers()[0].parse_args(["deform", "x.ply", "--out", "o", "--move", "2", "scale 2"])
    defaults = {name: jobs["deform"].get_default(name) for name in vars(given)}
    keys = []
    for later in ({}, {"newer": None}, {"newer": 1}):
        more = argparse.Namespace(**{**vars(given), **later})
        keys.append(_batch._key(more, {**defaults, "newer": None}, _batch.Path("x.ply"), lambda path: "same"))
    assert keys[0] == keys[1] != keys[2]


def test_each_option_is_told():
    _, jobs = _parsers()
    for job in jobs.values():
        for action in job._actions:
            assert action.help, (job.prog, action.dest)


def test_what_a_warning_asks_for_can_be_given():
    """Whatever a parameter is to be raised to: the command has it, too."""
    found = set()
    for job, (call, *modules) in {"fit": (fcd.fit, _fit), "straighten": (fcd.straighten, _straighten), "symmetrize": (fcd.symmetrize, _symmetrize),
                                  "deform": (fcd.deform, _pose)}.items():
        asked = {name for module in modules for name in re.findall(r"(?:or raise|raise|or) ([a-z_]+)", inspect.getsource(module))}
        options = {action.dest for action in _parsers()[1][job]._actions}
        if job == "straighten":
            asked |= {"middle", "smoothing"}  # by StraightenReport::Remedy
        for name in asked & {"largest_angle", "largest_distance", "max_iterations", "middle", "patches", "smoothing", "steps", "stiffness"}:
            assert name in inspect.signature(call).parameters and name in options, (job, name)
            found.add(name)
    assert {"largest_angle", "max_iterations", "smoothing", "steps"} <= found


def test_the_mean_is_of_what_was_fitted(tmp_path, capsys):
    from pymeshlab_fcd import _batch

    vertices, faces, tags, files = scans(tmp_path, 2)
    write_ply(tmp_path / "mean.ply", vertices, faces, tags)
    out = tmp_path / "o"
    command = ["fit", str(tmp_path / "template.ply"), *files, "--mean", "--out", str(out)]
    assert main(["deform", str(tmp_path / "mean.ply"), "--out", str(out)]) == 0
    assert f"is what deform made of {tmp_path / 'mean.ply'}" in refused(capsys, command)
    (out / "mean.ply").unlink()
    job = _batch._JOBS["fit"]

    def beside(given, path, other, threads):  # another program writes there, too
        row = job(given, path, other, threads)
        if other.stem == "scan1":
            (out / "scan0.ply").write_bytes((tmp_path / "mean.ply").read_bytes())
        return row

    _batch._JOBS["fit"] = beside
    try:
        assert main(command) == 1 and not (out / "mean.ply").exists()
    finally:
        _batch._JOBS["fit"] = job
    assert "no mean is made: " in capsys.readouterr().err
    assert main(command) == 0 and (out / "mean.ply").exists()


def test_the_mean_is_nobody_elses(tmp_path, capsys):
    vertices, faces, tags, files = scans(tmp_path, 2)
    write_ply(tmp_path / "mean.ply", vertices, faces, tags)
    out = tmp_path / "o"
    command = ["fit", str(tmp_path / "template.ply"), *files, "--out", str(out)]
    for _ in range(2):
        assert main([*command, "--mean"]) == 0
    made = (out / "mean.ply").read_bytes()
    for other in (["deform", str(tmp_path / "mean.ply"), "--out", str(out)], [*command[:2], str(tmp_path / "mean.ply"), "--out", str(out)]):
        assert f"{out / 'mean.ply'} is the mean that fit made: give another folder, or delete it first" in refused(capsys, other)
    assert main(command) == 0 and (out / "mean.ply").read_bytes() == made and "2 of 2 files are done already" in capsys.readouterr().out
    assert [row["file"] for row in table(out / "fit.csv").values()] == [*files, str(out / "mean.ply")]
    (tmp_path / "more.ply").write_bytes((tmp_path / "scan0.ply").read_bytes())
    assert main([*command[:2], str(tmp_path / "more.ply"), *command[2:]]) == 0 and len(table(out / "fit.csv")) == 4


def test_one_command_at_a_time_writes_to_a_folder(tmp_path, capsys):
    vertices, faces, tags, _ = bar(9, 3)
    write_ply(tmp_path / "a.ply", vertices, faces, tags)
    command = ["deform", str(tmp_path / "a.ply"), "--out", str(tmp_path / "o")]
    (tmp_path / "o").mkdir()
    with _files.alone(tmp_path / "o") as is_alone:
        assert is_alone
        said = subprocess.run([sys.executable, "-m", "pymeshlab_fcd", *command], capture_output=True, text=True, timeout=60)
        assert said.returncode == 2 and "another command is writing to --out" in said.stderr and not list((tmp_path / "o").iterdir())
        assert main([*command[:-1], str(tmp_path / "p")]) == 0
    assert main(command) == 0 and sorted(each.name for each in (tmp_path / "o").iterdir()) == ["a.ply", "deform.csv"]
    holding = subprocess.Popen([sys.executable, "-c", "import sys, time; from pymeshlab_fcd import _files\n"
                                "with _files.alone(sys.argv[1]) as is_alone: print(is_alone, flush=True); time.sleep(60)", str(tmp_path / "o")], stdout=subprocess.PIPE)
    assert holding.stdout.readline().strip() == b"True"
    assert "another command is writing to --out" in refused(capsys, command)
    holding.kill()
    holding.communicate()
    assert main(command) == 0


@pytest.mark.skipif(sys.platform == "win32", reason="streams of a shell")
def test_nobody_need_listen(tmp_path):
    vertices, faces, tags, _ = bar(9, 3)
    for name in "abc":
        write_ply(tmp_path / f"{name}.ply", vertices, faces, tags)
    run = f"'{sys.executable}' -m pymeshlab_fcd deform a.ply b.ply c.ply --out o"
    for line, status in ((f"exec 3>&1; {{ {run} --processes 2; echo $? >&3; }} | true; wait", "141"), (f"{run} >&-; echo $?", "0"), (f"{run} >&- 2>&-; echo $?", "0")):
        done = subprocess.run(["sh", "-c", line], cwd=tmp_path, capture_output=True, text=True, timeout=120)
        assert done.stdout.split()[-1] == status and not done.stderr, done
    assert len(list((tmp_path / "o").glob("*.ply"))) == 3


def test_a_table_that_cannot_be_written_is_told(tmp_path, capsys, monkeypatch):
    from pymeshlab_fcd import _results

    vertices, faces, tags, _ = bar(9, 3)
    write_ply(tmp_path / "a.ply", vertices, faces, tags)

    def full(*_):
        raise OSError(28, "No space left on device", "deform.csv")

    monkeypatch.setattr(_results._files, "write", full)
    assert main(["deform", str(tmp_path / "a.ply"), "--out", str(tmp_path / "o")]) == 1
    assert "ended: deform.csv: No space left on device; mend that, and the same command goes on from here" in capsys.readouterr().err


def test_many_files_are_told_apart_at_once(tmp_path, monkeypatch):
    from pymeshlab_fcd import _batch

    for i in range(400):
        (tmp_path / f"{i}.ply").write_bytes(b"")
    looked, stat = [], os.stat
    monkeypatch.setattr(_files.os, "stat", lambda *given, **more: (looked.append(given), stat(*given, **more))[1])
    paths = [tmp_path / f"{i}.ply" for i in range(400)]
    parser = _batch._parsers()[0]
    given = parser.parse_args(["deform", *map(str, paths), "--out", str(tmp_path / "o")])
    _batch._looked_at(parser, given, paths, {path: tmp_path / "o" / path.name for path in paths})
    assert len(looked) < 10 * len(paths)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("how, status", [(signal.SIGTERM, 143), (signal.SIGINT, 130), (signal.SIGKILL, -9)])
def test_its_processes_end_with_it(tmp_path, how, status):
    vertices, faces, _, files = scans(tmp_path, 12)
    x, y = np.meshgrid(np.linspace(0, 10, 601), np.linspace(0, 1, 101), indexing="ij")  # seconds each
    i = np.arange(601 * 101).reshape(601, 101)[:-1, :-1].ravel()
    write_ply(tmp_path / "template.ply", np.stack([x.ravel(), y.ravel(), np.sin(5 * x.ravel()) / 10], 1),
              np.concatenate([np.stack([i, i + 101, i + 1], 1), np.stack([i + 1, i + 101, i + 102], 1)]))
    command = [sys.executable, "-m", "pymeshlab_fcd", "fit", str(tmp_path / "template.ply"), *files, "--processes", "2", "--out", str(tmp_path / "o")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True) as run:
        try:
            run.stdout.readline()
            run.send_signal(how)  # to it alone
            said = run.communicate(timeout=300)[1].decode()  # all that have its streams are gone
            assert run.returncode == status and len(list((tmp_path / "o").glob("*.ply"))) < len(files) / 2, said
        finally:
            try:
                os.killpg(run.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
    assert "Traceback" not in said and (status < 0 or "the same command goes on from here" in said)
    rows = table(tmp_path / "o" / "fit.csv")
    assert 0 < len(rows) < 12 and not any(row["error"] for row in rows.values())
    assert status < 0 or not list((tmp_path / "o").glob("*.part"))


def test_what_a_killed_command_left_is_removed_by_the_next_one(tmp_path):
    vertices, faces, tags, _ = bar(9, 3)
    write_ply(tmp_path / "x.ply", vertices, faces, tags)
    out, mark = tmp_path / "o", f".{os.getpid()}.{'0f' * 16}"
    kill = ("import os, shutil, sys; from pymeshlab_fcd import _batch\n"
            "shutil.copymode = lambda *_: os._exit(9)\nos.replace = lambda *_: os._exit(9)\nsys.exit(_batch.main(sys.argv[1:]))")
    command = ["deform", str(tmp_path / "x.ply"), "--move", "2", "translate 0 0 1", "--deformations", "--out", str(out)]
    assert subprocess.run([sys.executable, "-c", kill, *command], check=False).returncode == 9
    left = list(out.glob("x.ply.*.part"))
    assert len(left) == 1
    ours = [out / f"deform.csv{mark}.part", out / "deformations" / f"x.ply{mark}.part"]
    others = [out / f"y.ply{mark}.part", out / f"x.ply{mark}.kept", out / "x.ply.part", out / f"my x.ply{mark}.part"]
    ours[1].parent.mkdir(exist_ok=True)
    for each in [*ours, *others]:
        each.write_bytes(b"")
    assert main(command) == 0
    assert not any(each.exists() for each in [*left, *ours]) and all(each.exists() for each in others) and (out / "x.ply").exists()


def test_scans_are_whole_scenes(tmp_path, capsys):
    trimesh = pytest.importorskip("trimesh")
    vertices, faces, _, _ = bar(9, 3)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    move = np.diag([-1.0, 1, 1, 1])
    move[2, 3] = 5
    scene = trimesh.Scene({"a": mesh})
    scene.add_geometry(mesh, geom_name="b", node_name="b", transform=move)
    scene.export(tmp_path / "two.glb")
    lines = [f"v {x} {y} {z}\n" for x, y, z in vertices]
    corners = [f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces]
    (tmp_path / "m.mtl").write_text("newmtl m\nKd 1 0 0\nnewmtl n\nKd 0 1 0\n")
    (tmp_path / "parts.obj").write_text("".join(["mtllib m.mtl\n", *lines, "usemtl m\n", *corners[:9], "usemtl n\n", *corners[9:]]))
    trimesh.Scene([trimesh.PointCloud(vertices)]).export(tmp_path / "points.glb")
    (tmp_path / "points.xyz").write_text("".join(line[2:] for line in lines))
    trimesh.Scene([trimesh.load_path([[[0, 0, 0], [1, 0, 0]]])]).export(tmp_path / "line.glb")
    from pymeshlab_fcd._batch import _target

    found, corners, *_ = _target(tmp_path / "two.glb")
    assert len(found) == 2 * len(vertices) and len(corners) == 2 * len(faces)
    assert np.abs(np.sort(found[:, 2]) - np.sort(np.r_[vertices[:, 2], vertices[:, 2] + 5])).max() < 1e-6 and found[:, 0].min() == -10
    up = np.cross(found[corners[:, 1]] - found[corners[:, 0]], found[corners[:, 2]] - found[corners[:, 0]])[:, 2]
    assert (np.sign(up) == np.sign(up[0])).all()  # the mirrored one has its outside outside
    found, corners, *_ = _target(tmp_path / "parts.obj")
    assert len(corners) == len(faces) and np.abs(np.sort(found[corners].mean(1), 0) - np.sort(vertices[faces].mean(1), 0)).max() < 1e-6
    for name in ("points.glb", "points.xyz"):
        found, corners, *_ = _target(tmp_path / name)
        assert np.abs(found - vertices).max() < 1e-6 and corners is None
    assert main(["info", str(tmp_path / "line.glb")]) == 1 and "has neither a mesh nor points" in capsys.readouterr().out


def test_figures_are_of_what_is_finite(tmp_path, capsys):
    vertices, faces, tags, _ = bar(9, 3)
    holed = vertices.copy()
    holed[0] = np.nan, 0, 99
    write_ply(tmp_path / "holed.ply", holed, faces, tags)
    write_ply(tmp_path / "empty.ply", vertices[:0], faces[:0], tags[:0])
    Deformer(vertices, faces, tags).pose({2: Motion.translate([0, 0, 1])}).deformation().save(tmp_path / "lift.fcd")
    files = [str(tmp_path / name) for name in ("holed.ply", "empty.ply")]
    assert main(["info", *files]) == 0
    said = capsys.readouterr().out
    assert f"vertices {len(vertices)}, " in said and "nan" not in said and "99" not in said.partition("low")[2].partition("seconds")[0]
    assert "vertices 0, faces 0, seconds" in said
    assert main(["apply", str(tmp_path / "lift.fcd"), *files, "--out", str(tmp_path / "o")]) == 0
    rows = table(tmp_path / "o" / "apply.csv")
    assert [float(rows[name]["largest_displacement"]) for name in files] == [pytest.approx(1, abs=0.1), 0]


def test_tables_are_taken_as_spreadsheets_save_them(tmp_path):
    path = tmp_path / "a.csv"
    for text in ("1,2,3\n4,5,6\n", "\ufeff1,2,3\r\n4,5,6\r\n", "1;2;3\n\n# more\n4;5;6;;\n", "1\t2\t3\n4\t5\t6", "1,\t2,\t3 # the nose\n\"4\",+5,6e0\n"):
        path.write_text(text, encoding="utf-8", newline="")
        assert (_tables.numbers(path, 3, "x, y, z") == [[1, 2, 3], [4, 5, 6]]).all(), text
    for text, where in (("x,y,z\n1,2,3\n", "line 1"), ("1,2,3\n4,5\n", "line 2"), ("1,5;2;3\n", "line 1"), ("1,2,3\n\n1,2,nan\n", "line 3"), ("1,2,3,4\n", "line 1")):
        path.write_text(text)
        with pytest.raises(ValueError, match=f"{where} of .*a.csv must have 3 numbers, x, y, z, with points for decimals and commas or semicolons"):
            _tables.numbers(path, 3, "x, y, z")
    path.write_bytes("1,2,3\n".encode("utf-16"))
    with pytest.raises(ValueError, match="line 1 of .*a.csv must have 3 numbers"):
        _tables.numbers(path, 3, "x, y, z")
    path.write_text("# none\n")
    with pytest.raises(ValueError, match="a.csv has no line with 3 numbers, x, y, z"):
        _tables.numbers(path, 3, "x, y, z")
    path.write_text("\ufeffcurve;surface;x;y;z\n" + "".join(f"a;{which};{k};0;0\n" for which in ("source", "target") for k in range(2)), encoding="utf-8")
    assert read_curves(path)[0].name == "a"


@pytest.mark.skipif(sys.platform != "linux", reason="others have no such names")
def test_names_may_have_any_characters(tmp_path):
    vertices, faces, tags, _ = bar(9, 3)
    write_ply(tmp_path / "a.ply", vertices, faces, tags)
    names = ["\u00fc \u65e5.ply".encode(), b"\xe9.ply"]
    for name in names:
        os.link(tmp_path / "a.ply", os.fsencode(tmp_path) + b"/" + name)
    command = [sys.executable, "-m", "pymeshlab_fcd", "deform", *names, "missing\udce9.ply", "--move", "2", "translate 0 0 1", "--out", "o"]
    for more in ({}, {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": ""}, {}):
        for processes in "12":
            done = subprocess.run([*command, "--processes", processes], cwd=tmp_path, env={**os.environ, **more}, capture_output=True, timeout=120)
            assert done.returncode == 1 and b"Traceback" not in done.stderr and b"\\xe9.ply: failed: " in done.stdout, done
    assert b"2 of 3 files are done already" in done.stdout
    with open(tmp_path / "o" / "deform.csv", newline="", encoding="utf-8") as file:
        assert [row["file"] for row in csv.DictReader(file)] == ["\u00fc \u65e5.ply", "\\xe9.ply", "missing\\xe9.ply"]
    assert {name for name in os.listdir(os.fsencode(tmp_path / "o")) if name.endswith(b".ply")} == set(names)


def test_a_name_that_begins_as_an_option_does_is_told_how_to_write(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    vertices, faces, tags, _ = bar(9, 3)
    for name in ("-help.ply", "b.ply"):
        write_ply(tmp_path / name, vertices, faces, tags)
    for command in (["deform", "-help.ply", "b.ply", "--out", "o"], ["fit", "b.ply", "-help.ply", "--out", "o"]):
        assert "-help.ply begins with a dash, as an option does: write ./-help.ply" in refused(capsys, command) and not (tmp_path / "o").exists()
    assert main(["deform", "--out", "o", "--", "-help.ply"]) == 0 and main(["deform", "./-help.ply", "b.ply", "--out", "o"]) == 0
    assert "1 of 2 files are done already" in capsys.readouterr().out


def test_motions_and_folders_that_cannot_be_are_refused_at_once(tmp_path, capsys):
    vertices, faces, tags, _ = bar(9, 3)
    write_ply(tmp_path / "a.ply", vertices, faces, tags)
    for moves, message in ((["two", "translate 0 0 1"], "--move two 'translate 0 0 1': the first is the tag of a handle, a whole number from 2"),
                           (["1", "translate 0 0 1"], "a whole number from 2"), (["2", "rotat 0 0 1"], "expected 'translate', 'rotate'"),
                           (["2", "3: translate 0 0 1"], "without its tag"),
                           (["2", "translate 0,5 0 1"], "write decimals with a point, as in 0.5"), (["2", "scale 0"], "must be greater than 0"),
                           (["2", "translate 0 0 1", "--move", "2", "translate 0 0 2"], "handle 2 moves already")):
        assert message in refused(capsys, ["deform", tmp_path / "a.ply", "--move", *moves, "--out", tmp_path / "o"])
    assert not (tmp_path / "o").exists()
    (tmp_path / "o").write_text("")
    for job, option in (("fit", "landmarks"), ("straighten", "lines"), ("symmetrize", "pairs"), ("symmetrize", "midlines")):
        command = [job, tmp_path / "a.ply", tmp_path / "a.ply", f"--{option}", tmp_path / "o", "--out", tmp_path / "p"]
        assert f"--{option} {tmp_path / 'o'} is no folder" in refused(capsys, command) and not (tmp_path / "p").exists()
    assert f"--out {tmp_path / 'o'} is no folder" in refused(capsys, ["deform", tmp_path / "a.ply", "--out", tmp_path / "o"])
    (tmp_path / "o").unlink()
    assert main(["deform", str(tmp_path / "a.ply"), "--move", "2", "translate 0 0 1 rotate 1 0 0 300", "--out", str(tmp_path / "o")]) == 0
    row = table(tmp_path / "o" / "deform.csv")[str(tmp_path / "a.ply")]
    assert "rigid" not in row["warnings"]


def test_options_that_no_file_can_be_done_with_are_refused_at_once(tmp_path, capsys):
    vertices, faces, tags, _ = bar(9, 3)
    write_ply(tmp_path / "a.ply", vertices, faces, tags)
    here = tmp_path / "a.ply"
    for command, message in ((["deform", here, "--steps", "0"], "steps must be from 1 to 1000; it is 0"),
                             (["deform", here, "--percent", "nan"], "must be a finite number of percent"),
                             (["deform", here, "--max-iterations", "0"], "max_iterations must be from 1"),
                             (["fit", here, here, "--steps", "0"], "A fit takes 2 to 10000 steps"),
                             (["fit", here, here, "--start", "landmarks_rigid"], "needs three of them"),
                             (["fit", here, here, "--weights", "label"], "have no label"),
                             (["fit", here, here, "--curves", tmp_path / "no"], "no is neither a file nor a folder"),
                             (["straighten", here, "--lines", tmp_path, "--degrees", "400"], "An arc bends by less than 360"),
                             (["symmetrize", here, "--stiffness", "0"], "The stiffness must be from 1e-6"),
                             (["compensate", here, here, "--degree", "9"], "degree must be from 1 to 7; it is 9"),
                             (["compensate", tmp_path, here], f"{tmp_path} is a folder: give a file"),
                             (["apply", tmp_path / "no", here], "no: No such file or directory"),
                             (["fit", here, ""], "a name is empty"), (["deform", here, "--out", ""], "a name is empty")):
        assert message in refused(capsys, [*command, *([] if "--out" in command else ["--out", tmp_path / "o"])])
    assert not (tmp_path / "o").exists()
    assert main(["info", str(tmp_path), str(here)]) == 1
    assert f"1/2 {tmp_path}: failed: {tmp_path} is a folder: give a file\n2/2" in capsys.readouterr().out


@pytest.mark.parametrize("command", [["fit", "--start", "landmarks_similar", "--landmarks", "."], ["fit", "--start", "axes", "--largest-distance", "1e-9"],
                                     ["fit", "--stiffness", "1e6"],
                                     ["straighten", "--lines", ".", "--middle", "--untwist"], ["straighten", "--lines", ".", "--degrees", "-359", "--smoothing", "0.25"],
                                     ["symmetrize", "--landmark-tolerance", "9", "--largest-distance", "1e-9"], ["compensate", "--degree", "7", "--largest-distance", "1e-9"],
                                     ["deform", "--percent", "-100", "--smoothness", "0"]])
def test_options_that_a_file_can_be_done_with_are_not_refused(command):
    """What they are tried on is no better or worse for any of them."""
    job, *options = command
    _tried(_parsers()[0].parse_args([job, *(["a.ply"] if job in ("fit", "compensate") else []), "b.ply", "--out", "o", *options]))
