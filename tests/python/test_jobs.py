# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands of the manual's jobs, as they are printed there, from the files that examples/job_data.py makes to the results."""
import csv
import os
import re
import subprocess
import sys
from pathlib import Path

import laspy
import numpy as np
import pytest
from job_data import MAKE, SIZE, THICK, ball, plate, skull, warped
from test_compensate import placed, rms
from test_symmetrize import off

from pymeshlab_fcd._ply import Ply

ROOT = Path(__file__).resolve().parents[2]
CLUSTER = "--scheduler tcp://head:8786"  # there is none of this name here


def commands(page):
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    return re.findall(r"^    (python (?:examples/|-m pymeshlab_fcd ).*)$", text, re.M)


def run(folder, page):
    (folder / "examples").symlink_to(ROOT / "examples")
    path = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    for command in commands(page):
        done = subprocess.run(["bash", "-c", command.replace(CLUSTER, "")], cwd=folder, env=path, text=True, capture_output=True, timeout=300)
        assert done.returncode == 0, (command, done.stdout, done.stderr)


def table(path):
    with open(path, encoding="utf-8", newline="") as file:
        return {row["source"]: row for row in csv.DictReader(file)}


def test_each_job_has_a_page_with_its_command():
    pages = {path.name: commands(path.name) for path in (ROOT / "docs").glob("*.md")}
    written = [command.split()[-1] for of_page in pages.values() for command in of_page if "job_data.py" in command]
    assert sorted(written) == sorted(MAKE)
    assert {page for page, of_page in pages.items() if of_page} == {"symmetry.md", "compensation.md", "jobs.md", "tiles.md"}


def test_symmetry(tmp_path):
    run(tmp_path, "symmetry.md")
    truth = 50 * skull(ball()[0], 3)
    before, after, by_pairs, brain = (Ply(tmp_path / name).vertices for name in ("skull.ply", "restored/skull.ply", "by_pairs/skull.ply", "inside/brain.ply"))
    assert off(before, truth) > 0.8 and off(after, truth) < 0.1 and off(by_pairs, truth) < 0.1
    assert off(brain, 0.8 * truth) < 0.2
    row = table(tmp_path / "restored/symmetrize.csv")["../skull.ply"]
    assert float(row["after"]) < 0.05 * float(row["before"])


def test_compensation(tmp_path):
    run(tmp_path, "compensation.md")
    nominal, made = plate()[0], Ply(tmp_path / "to_print/printed.ply").vertices
    assert rms(placed(warped(made), nominal) - nominal) < 0.03 < 0.1 < rms(placed(warped(nominal), nominal) - nominal)
    assert np.ptp(made, axis=0) == pytest.approx([*SIZE, THICK], abs=0.8)


def test_contact_and_many_scans(tmp_path):
    run(tmp_path, "jobs.md")
    row = table(tmp_path / "closed/deform.csv")["../finger.ply"]
    assert int(row["contact"]) > 500 and float(row["contact_depth"]) > 1
    rows = table(tmp_path / "fitted/fit.csv")
    assert sorted(rows) == ["../scans/ann.ply", "../scans/ben.ply", "../scans/cem.ply"]
    assert all(float(row["matched"]) > 0.95 and float(row["rms"]) < 0.2 for row in rows.values())


def test_tiles(tmp_path):
    run(tmp_path, "tiles.md")
    marks = [np.array(re.findall(r"[\d.]+", line), float) for line in re.findall(r"^    ([\d., ]+)$", (ROOT / "docs/tiles.md").read_text(), re.M)]
    assert np.allclose(np.loadtxt(tmp_path / "landmarks.csv", delimiter=","), marks)
    for name in ("432050.laz", "432150.laz"):
        before, after = (laspy.read(tmp_path / folder / name) for folder in ("tiles", "moved"))
        sunk = np.asarray(before.z) - np.asarray(after.z)
        assert 1.2 < sunk.max() < 1.6 and np.abs(np.asarray(after["displacement_z"]) + sunk).max() < 1e-3
        assert (np.asarray(laspy.read(tmp_path / "out" / name).z) == np.asarray(after.z)).all()
