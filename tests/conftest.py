# SPDX-License-Identifier: GPL-3.0-or-later
"""What the host tests share: the examples, the sample meshes that pymeshlab ships, and the optional benchmark meshes beside the checkout."""
import lzma
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pymeshlab
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "examples"))
sys.path.append(str(Path(__file__).parent / "python"))  # what the tests of the package share

SAMPLES = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
SHARED = Path(__file__).resolve().parents[2] / "shared"

QUALITY_TAGS = "(x < 0.25) ? 0 : ((x > 0.75) ? 2 : 1)"  # of bone.ply, which lies along x from 0.03 to 0.98

# Of the benchmark meshes.
MESHES = [
    "dirty/blobby_shuffled.off", "dirty/boeing_soup.off", "dirty/bunny_zipper_isolated_36k.ply", "dirty/cube_40k_nonmanifold.ply",
    "dirty/double_torus_nm.off", "dirty/dragon_vrip_res2_100k.ply.xz", "dirty/elephant_with_holes.off", "dirty/fan3.obj",
    "dirty/fly_aedes_63k.ply", "dirty/moebius.obj", "dirty/office_chair.obj", "dirty/rangemap_lato315_63k.ply",
    "dirty/thingi_73416_38k.stl.xz", "dirty/truck_3k.obj", "attr/Laurana50k.ply", "attr/TextureDouble.ply",
    "attr/bunny10k_textured.obj", "attr/cycloidal.ply", "attr/genesis_dragon.obj", "attr/laurana_custom_derived.ply",
    "attr/texturedknot.ply", "points/building_100k.ply.xz", "points/duplicated_pcloud.ply", "scans/armadillo_43k.ply"]
LARGE_SCANS = ["scans/igea_134k.ply.xz", "scans/cortex_pia_lh_153k.ply.xz", "scans/dragon_full_436k_q11.ply.xz"]


def record(message):
    """Leaves what the plugin says for tests/messages.py."""
    if "FCD_MESSAGES" in os.environ:
        with open(os.environ["FCD_MESSAGES"], "a", encoding="utf-8") as file:
            file.write(message + "\n")


def apply_filter(ms, *arguments, unrecorded=pymeshlab.MeshSet.apply_filter, **parameters):
    try:
        return unrecorded(ms, *arguments, **parameters)
    except pymeshlab.PyMeshLabException as error:
        record(str(error))
        raise


pymeshlab.MeshSet.apply_filter = apply_filter


@pytest.fixture
def shared():
    """The folder with benchmark meshes; a test that needs it is skipped where it is absent."""
    if not (SHARED / "meshes").is_dir():
        pytest.skip(f"no benchmark meshes ({SHARED / 'meshes'} is absent)")
    return SHARED


def is_busy(processes):
    """Whether a thread of these runs, or waits for a core or a disk. Of numbers of processes."""
    for process in processes:
        try:
            threads = os.listdir(f"/proc/{process}/task")
        except FileNotFoundError: # it ended
            continue
        for thread in threads:
            try:
                with open(f"/proc/{process}/task/{thread}/stat", "rb", buffering=0) as file:
                    if file.read(200).rpartition(b")")[2][1:2] in (b"R", b"D"):
                        return True
            except (FileNotFoundError, ProcessLookupError):
                pass
    return False


def settle(processes):
    """Waits until all that was sent to the processes of a window is done: nothing runs for longer than it takes to hand an event on."""
    calm, end = 0, time.time() + 60
    while calm < 5:
        time.sleep(0.015)
        calm = 0 if is_busy(processes) else calm + 1
        assert time.time() < end, "MeshLab does not come to rest"


def unpacked(path, folder):
    """The path itself, or of the file unpacked into the folder where it is packed."""
    if path.suffix != ".xz":
        return path
    (folder / path.stem).write_bytes(lzma.decompress(path.read_bytes()))
    return folder / path.stem


def rotation(axis, degrees):
    """3 x 3 rotation matrix (Rodrigues)."""
    a = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    t = np.radians(degrees)
    return np.eye(3) + np.sin(t) * k + (1 - np.cos(t)) * k @ k


def about(center, linear):
    """4 x 4 matrix of a linear map about a point."""
    m = np.eye(4)
    m[:3, :3] = linear
    m[:3, 3] = np.asarray(center) - linear @ np.asarray(center)
    return m


def translation(t):
    m = np.eye(4)
    m[:3, 3] = t
    return m


def transformed(m, points):
    return points @ m[:3, :3].T + m[:3, 3]


def write_tags(path, tags):
    path.write_text("# tags\n" + "".join(f"{t}\n" for t in tags))
    return str(path)


def write_transforms(path, *matrices):
    path.write_text("".join(" ".join(repr(float(x)) for x in row) + "\n" for m in matrices for row in m))
    return str(path)


def pytest_collection_modifyitems(items):
    """Tests that read the log first: after an error in any filter pymeshlab logs no more."""
    items.sort(key=lambda item: "capfd" not in item.fixturenames)


def check_faults(plugin, libraries):
    """Runs host_faults, built beside the plugin, with the libraries of the plugin's host."""
    program = plugin.parents[2] / "cmake" / plugin.parent.name / "host_faults"
    if not program.exists():
        pytest.skip(f"{program} is not built")
    done = subprocess.run([str(program), str(plugin)], text=True, timeout=300, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          env={**os.environ, "LD_LIBRARY_PATH": str(libraries), "MALLOC_ARENA_MAX": "1"})
    record(done.stdout)
    assert done.returncode == 0, done.stderr[-3000:]
    cancelled = [int(n) for n in re.findall(r"was cancelled (\d+) times", done.stdout)]
    ran_out = [int(n) for n in re.findall(r"ran out of memory (\d+) times", done.stdout)]
    assert len(cancelled) == 5 and len(ran_out) == 4 and min(cancelled) > 20 and min(ran_out) > 1, done.stdout
    first, second = map(int, re.search(r"Pose in Place ran out of memory (\d+) and (\d+) times", done.stdout).groups())
    assert first > 10 and second > 10, done.stdout
