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


# What is checked after a block, by a line that only this block has.
CHECKS = {
    "turn = pymeshlab_fcd.Motion.rotate([0, 1, 0], -90)": "assert pose.info.converged and abs(pose.vertices[tags == 2] - vertices[tags == 2]).max() > 3",
    "positions = pymeshlab_fcd.deform(vertices, faces, tags, {2: turn})": "assert abs(positions - vertices)[tags == 0].max() == 0",
    "beside = pose.map(vertices + [0, 0, 0.02])": "assert abs(moved - pose.vertices[:100]).max() < 1e-3 and abs(beside - pose.vertices).max() < 0.2",
    "pose = deformer.pose(landmarks=[[9, 1, 3], [5, 1, 0.5]])": "assert pose.info.converged",
    "sink = Deformation.load('sink.ply')": "assert -1 < moved[:, 2].min() + 2 < 1.5",
    "fitted = pymeshlab_fcd.fit(template, faces, scan, faces)": "assert fitted.info.matched > 0.9",
    "bent = pymeshlab_fcd.straighten(vertices, faces, [[0, 1, 0], [5, 1, 0], [10, 1, 0]]": "assert bent.vertices[:, 2].max() - bent.vertices[:, 2].min() > 1.5",
    "poses.write(deformer, gltf='bar.glb', pc2='bar.pc2')": "from pathlib import Path; assert Path('bar.glb').stat().st_size > 10000",
    "poses.write(deformer, gltf='checks.glb', others=[eye],": "from pathlib import Path; assert Path('checks.png').read_bytes() in Path('checks.glb').read_bytes()",
    "made = pymeshlab_fcd.compensate(nominal, faces, scan, faces)": "assert made.info.left < 0.1 * made.info.before and support.shape == (1, 3)",
    "restored = pymeshlab_fcd.symmetrize(sheared, faces)": "assert restored.symmetry.after < 0.1 * restored.symmetry.before and others.shape == (98, 3)",
    "np.save('bent_numpy.npy', positions)": "assert abs(positions[tags == 0] - vertices[tags == 0]).max() == 0 and abs(positions[tags == 2][:, 0] - 4).max() < 0.6",
}


def blocks():
    """Each Python block of README and manual that needs nothing of MeshLab."""
    for path in [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))]:
        for number, code in enumerate(re.findall(r"^```python\n(.*?)^```$", path.read_text(encoding="utf-8"), re.M | re.S)):
            if "load_plugin" not in code:
                yield pytest.param(code, id=f"{path.relative_to(ROOT)}-{number}")


def run(code, folder):
    (folder / "meshes").symlink_to(ROOT / "meshes")
    done = subprocess.run([sys.executable, "-W", "error::UserWarning", "-c", code], cwd=folder, text=True, stderr=subprocess.PIPE, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]


@pytest.mark.parametrize("code", list(blocks()))
def test_python_of_a_page_by_itself(tmp_path, code):
    run("\n".join([code, *(check for line, check in CHECKS.items() if line in code)]), tmp_path)


def test_each_check_has_its_block():
    code = "\n".join(block.values[0] for block in blocks())
    assert [line for line in CHECKS if line not in code] == []


def test_python_of_the_package_readme_in_one_session(tmp_path):
    code = "\n".join(re.findall(r"^```python\n(.*?)^```$", (ROOT / "python/README.md").read_text(), re.M | re.S))
    run(f"{code}\nassert abs(bend(vertices) - positions).max() < 1.2e-3 and moved.shape == normals.shape", tmp_path)


def test_the_reference_has_all_there_is():
    told = set(re.findall(r"^::: pymeshlab_fcd\.(\w+)$", (ROOT / "docs/python.md").read_text(), re.M))
    assert told == set(pymeshlab_fcd.__all__) - {"__version__"}


def test_every_parameter_is_explained():
    for name in ("deform", "deformation", "deform_layer", "enable_pymeshlab", "straighten", "symmetrize", "compensate", "read_curves", "PoseSequence", "fit", "Fitter", "Deformer", "Motion", "Deformation", "Pose"):
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
            lines = re.findall(r"^(\w+(?:, \w+)*)(?: : |$)", told[1], re.M) if told else []
            names = [each for line in lines for each in line.split(", ")] # several, that another page explains, may share a line
            assert text and sorted(names) == sorted(parameters), (name, function, parameters)


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
