# SPDX-License-Identifier: GPL-3.0-or-later
"""The package and the examples as type checkers see them. In a folder of their own: no setting of this repository counts."""
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import pymeshlab_fcd

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def run(*command, cwd):
    here = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}  # --verifytypes asks the first Python there
    return subprocess.run([sys.executable, "-m", *command], cwd=cwd, text=True, capture_output=True, timeout=600, env=here)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """With a file that uses all of it, as somebody would."""
    folder = tmp_path_factory.mktemp("typed")
    for example in EXAMPLES:
        (folder / example.name).write_bytes(example.read_bytes())
    (folder / "use.py").write_text("""
import warnings

import numpy as np
from numpy.typing import NDArray
from pymeshlab_fcd import (AnimationInfo, Companion, Deformation, Deformer, Fitted, Fitter, FoldWarning, KeyFrame, Look, Motion, PoseSequence, Straightened,
                           __version__, deform, deformation, fit, straighten)

v: NDArray[np.float64] = np.zeros((3, 3))
deformer = Deformer(v, [[0, 1, 2]], [0, 1, 2], smoothness=0.01, graph_weights="border", progress=lambda percent, stage: None)
pose = deformer.pose({2: np.eye(4)}, percent=50)
again = deformer.pose({2: Motion.rotate([0, 0, 1], 90).then(Motion.scale(2))}, start=pose, out=np.empty((3, 3)), check=False)
a: NDArray[np.float64] = pose.map(v)
b, c = pose.map(v, v)
folded: int = pose.info.folded
poses = PoseSequence({"up": {2: Motion.scale(2)}, "down": "2: scale 0.5"}, [KeyFrame(0, {"up": 100}, "smooth")])
blended = poses.blend(deformer, {"up": 50}).map(v)
written: AnimationInfo = poses.write(deformer, gltf="a.glb", shapes="poses")
poses.write(deformer, gltf="b.glb", look=Look(colors=v), others=[Companion(v, [[0, 1, 2]], "eye", Look(uv=v[:, :2], textures=["a.png", b""]))])
times: list[float] = [time for time, each in poses.frames(deformer, rate=12)]
d: Deformation = deformation(v, tags=[0, 1, 2], transforms={2: np.eye(4)})
e: float | None = d.largest_difference
f: NDArray[np.float64] = deform(v, None, [0, 1, 2], {2: np.eye(4)}, patches=100)
g: NDArray[np.int32] = deformer.patch_of
h: Fitted = fit(v, [[0, 1, 2]], v, landmarks=([0, 1], v[:2]), tags=[0, 1, 2], transforms={2: np.eye(4)}, start="axes")
class Mesh:
    vertices, faces = v, [[0, 1, 2]]
class Cloud:
    points = v
j: Fitted = fit(Mesh(), Cloud(), landmarks_only=False)
k: Straightened = straighten(Mesh(), v, middle=True)
l: NDArray[np.float64] = deform(Cloud(), tags=[0, 1, 2], transforms={2: np.eye(4)}, distances="euclidean")
with warnings.catch_warnings():
    warnings.simplefilter("error", FoldWarning)
m: str = __version__
i: float = Fitter(v, stiffness=10).fit(v, [[0, 1, 2]], landmarks=(v, v)).info.percentile_95
""")
    return folder


def test_mypy(folder):
    pytest.importorskip("mypy")
    for system in ("win32", "darwin"):  # which have classes of their own
        done = run("mypy", "--strict", "--platform", system, "-p", "pymeshlab_fcd", cwd=folder)
        assert done.returncode == 0, done.stdout
    done = run("mypy", "--strict", "-p", "pymeshlab_fcd", cwd=folder)
    assert done.returncode == 0, done.stdout
    (folder / "typo.py").write_text("import numpy as np, pymeshlab_fcd\npymeshlab_fcd.deform(np.eye(3), patches='600')\n"
                                    "pymeshlab_fcd.deform(np.eye(3), initial_patches=600)\npymeshlab_fcd.Deformer(object())\n"
                                    "pymeshlab_fcd.Deformer(np.eye(3)).vertices = np.eye(3)\n")
    done = run("mypy", "--strict", "typo.py", cwd=folder)
    (folder / "typo.py").unlink()
    assert "HasVertices" in done.stdout and 'Property "vertices" defined in "Deformer" is read-only' in done.stdout
    assert 'expected "int"' in done.stdout and 'Unexpected keyword argument "initial_patches"' in done.stdout
    # Last: with another option, it reads numpy anew.
    done = run("mypy", "--strict", "--ignore-missing-imports", ".", cwd=folder)
    assert done.returncode == 0, done.stdout


def test_pyright(folder):
    pytest.importorskip("pyright")
    package = str(Path(pymeshlab_fcd.__file__).parent)
    done = run("pyright", "--pythonpath", sys.executable, package, "use.py", *[example.name for example in EXAMPLES], cwd=folder)
    assert done.returncode == 0, done.stdout
    done = run("pyright", "--pythonpath", sys.executable, "--outputjson", "--ignoreexternal", "--verifytypes", "pymeshlab_fcd", cwd=folder)
    assert json.loads(done.stdout)["typeCompleteness"]["completenessScore"] >= 0.95
