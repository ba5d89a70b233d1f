# SPDX-License-Identifier: GPL-3.0-or-later
"""What README and manual tell of the Python package, as it is printed there, and that the reference has all of it."""
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import pymeshlab_fcd

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("page, check", [
    ("README.md", "assert pose.info.converged and abs(pose.vertices[tags == 2] - vertices[tags == 2]).max() > 3"),
    ("python/README.md", "assert abs(bend(vertices) - positions).max() < 1.2e-3 and moved.shape == normals.shape"),
    ("docs/python.md", "assert abs(moved - bend(vertices)).max() == 0 and abs(pose.vertices[tags == 0] - vertices[tags == 0]).max() == 0"),
    ("docs/symmetry.md", "assert restored.symmetry.after < 0.1 * restored.symmetry.before and others.shape == (98, 3)"),
    ("docs/compensation.md", "assert made.info.left < 0.1 * made.info.before and support.shape == (1, 3)"),
    ("docs/tiles.md", "assert -1 < moved[:, 2].min() + 2 < 1.5")])
def test_python_of_a_page_in_one_session(tmp_path, page, check):
    code = "\n".join(re.findall(r"^```python\n(.*?)^```$", (ROOT / page).read_text(), re.M | re.S))
    assert "pymeshlab_fcd" in code
    done = subprocess.run([sys.executable, "-W", "error::UserWarning", "-c", f"{code}\n{check}"], cwd=tmp_path, text=True,
                          stderr=subprocess.PIPE, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]


def test_the_reference_has_all_there_is():
    told = set(re.findall(r"^::: pymeshlab_fcd\.(\w+)$", (ROOT / "docs/python.md").read_text(), re.M))
    assert told == set(pymeshlab_fcd.__all__) - {"__version__"}


def test_every_parameter_is_explained():
    for name in ("deform", "deformation", "deform_layer", "enable_pymeshlab", "straighten", "symmetrize", "compensate", "PoseSequence", "fit", "Fitter", "Deformer", "Motion", "Deformation", "Pose"):
        thing = getattr(pymeshlab_fcd, name)
        members = [thing] if callable(thing) and not inspect.isclass(thing) else [
            member for key, member in vars(thing).items() if not key.startswith("_") and (inspect.isfunction(member) or isinstance(member, classmethod))]
        if name in ("Deformer", "Fitter", "Deformation"):
            members.append(thing)
        for member in members:
            function = getattr(member, "__func__", member)
            parameters = [each for each in inspect.signature(function).parameters if each not in ("self", "cls")]
            text = inspect.getdoc(function) or ""
            told = re.search(r"^Parameters\n-+\n(.*?)(?:\n\n\w+\n-+\n|\Z)", text, re.M | re.S)  # as numpydoc has them
            names = re.findall(r"^(\w+) : ", told[1], re.M) if told else []
            assert text and names == parameters, (name, function, parameters)


def test_the_notebook_runs_as_it_is(tmp_path):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    notebook = nbformat.read(ROOT / "examples" / "bend_strip.ipynb", as_version=4)
    nbformat.validate(notebook)
    assert not any(cell.get("outputs") for cell in notebook.cells)  # kept without what it makes
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    made = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    pictures = [output for output in made if "image/png" in output.get("data", {})]
    said = "".join(output.get("text", "") for output in made)
    assert len(pictures) == 5 and said.count("converged=True") == 3 and (tmp_path / "bend.ply").stat().st_size > 10000, said
