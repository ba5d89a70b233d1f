# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin inside processes of pymeshlab that are started for one test each: what a process has once (memory, its
environment, its plugins). FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pymeshlab
import pytest

from conftest import check_faults

PLUGIN = Path(os.environ["FCD_PLUGIN"]).resolve()
NAMES = ["generate_fcd_deformation_graph", "generate_fcd_deformed_mesh", "compute_fcd_tags_from_selection",
         "compute_fcd_tags_from_files", "save_fcd_tags"]

PRELUDE = """
import ctypes, hashlib, os, resource, sys
import numpy as np
import pymeshlab

def sheet(n):
    x, y = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.vstack([np.column_stack([a, a + n, a + 1]), np.column_stack([a + 1, a + n, a + n + 1])])
    points = np.column_stack([x, y, 3 * np.sin(0.05 * x) * np.cos(0.07 * y)])
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=np.where(x < n / 5, 0.0, np.where(x > n * 4 / 5, 2.0, 1.0))), "sheet")
    return ms

GRAPH, DEFORM = "generate_fcd_deformation_graph", "generate_fcd_deformed_mesh"
MOTION = dict(translation=np.array([1.0, 2, 3]), rotation_axis=np.array([0, 1.0, 0]), rotation_angle=-50.0)
"""


def run(code, plugin=PLUGIN, cwd=None, **environment):
    """What the code prints."""
    load = f"pymeshlab.load_plugin({str(plugin)!r})\n" if plugin else ""
    done = subprocess.run([sys.executable, "-c", PRELUDE + load + code], cwd=cwd, text=True, timeout=300,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={**os.environ, **environment})
    assert done.returncode == 0, done.stdout + done.stderr[-3000:]
    return done.stdout


def test_two_processes_give_the_same_bits():
    code = """
ms = sheet(400)
ms.apply_filter(GRAPH)
print(hashlib.sha256(ms.mesh(1).vertex_matrix().tobytes()).hexdigest())
ms.set_current_mesh(0)
ms.apply_filter(DEFORM, **MOTION)
for mesh in ms:
    print(hashlib.sha256(mesh.vertex_matrix().tobytes()).hexdigest())
"""
    first = run(code)
    assert len(set(first.split())) >= 5
    # Memory that is not set before it is read, and the number of cores, would show.
    assert run(code, MALLOC_PERTURB_="165", MALLOC_ARENA_MAX="1", LC_ALL="C") == first
    assert run("os.sched_setaffinity(0, list(os.sched_getaffinity(0))[:1])\n" + code, MALLOC_PERTURB_="90") == first


@pytest.mark.parametrize("host", ["pymeshlab-2025.7", "pymeshlab-2022.2", "meshlab-2020.09"])
def test_the_plugin_of_another_host_is_refused(host):
    other = PLUGIN.parents[1] / host / PLUGIN.name
    if other == PLUGIN:
        pytest.skip("this is the host of that plugin")
    if not other.exists():
        pytest.skip(f"{other} is absent")
    out = run(f"""
before = pymeshlab.filter_list()
try:
    pymeshlab.load_plugin({str(other)!r})
except pymeshlab.PyMeshLabException as e:
    print(e)
assert pymeshlab.filter_list() == before
pymeshlab.load_plugin({str(PLUGIN)!r})
sheet(20).apply_filter(DEFORM)
""", plugin=None)
    assert "libfilter_fcd.so" in out and ("version" in out or "not a MeshLab plugin" in out)


def test_loads_next_to_all_other_plugins():
    out = run(f"""
before = pymeshlab.filter_list()
pymeshlab.load_plugin({str(PLUGIN)!r})
after = pymeshlab.filter_list()
assert set(before) < set(after) and len(before) > 100
print(*set(after) - set(before))
""", plugin=None).split()
    assert set(NAMES) <= set(out)


def test_loading_says_nothing():
    """Without a window, Qt warns of what only a window has."""
    done = subprocess.run([sys.executable, "-c", f"import pymeshlab\npymeshlab.load_plugin({str(PLUGIN)!r})"], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_nothing_but_the_entry_of_a_plugin_is_exported():
    symbols = subprocess.run(["nm", "-D", "--defined-only", str(PLUGIN)], stdout=subprocess.PIPE, text=True, check=True).stdout
    assert sorted(line.split()[2] for line in symbols.splitlines()) == ["qt_plugin_instance", "qt_plugin_query_metadata"]


def test_leaves_no_files_and_no_environment_behind(tmp_path):
    folders = [tmp_path / name for name in ("work", "home", "temporary")]
    for folder in folders:
        folder.mkdir()
    work, home, temporary = map(str, folders)
    run("""
def environment():
    at, entries = ctypes.POINTER(ctypes.c_char_p).in_dll(ctypes.CDLL(None), "environ"), []
    while at[len(entries)]:
        entries.append(at[len(entries)])
    return entries

def files():
    return sorted(os.path.join(folder, name) for top in TOPS for folder, _, names in os.walk(top) for name in names)

TOPS = [os.getcwd(), os.environ["HOME"], os.environ["TMPDIR"]]
before = environment(), files(), os.getcwd(), os.umask(0o22)
ms = sheet(60)
ms.apply_filter(GRAPH)
ms.set_current_mesh(0)
ms.apply_filter(DEFORM, **MOTION)
ms.set_current_mesh(0)
ms.apply_filter("save_fcd_tags", tag_file="t.sel", transform_file="t.def", **MOTION)
ms.apply_filter("compute_fcd_tags_from_files", tag_file="t.sel")
ms.apply_filter("set_selection_all")
ms.apply_filter("compute_fcd_tags_from_selection")
try:
    ms.apply_filter(DEFORM)
except pymeshlab.PyMeshLabException:
    pass
os.remove("t.sel")
os.remove("t.def")
assert before == (environment(), files(), os.getcwd(), os.umask(0o22))
""", cwd=work, HOME=home, TMPDIR=temporary)


SAVE = """
ms = pymeshlab.MeshSet()  # lives to the end: an error is written to its log

def save(folder):
    ms.add_mesh(pymeshlab.Mesh(np.eye(3), v_scalar_array=np.array([0, 1, 2.0])), "few")
    try:
        ms.apply_filter("save_fcd_tags", tag_file=folder + "/t.sel", transform_file=folder + "/t.def",
                        transforms="2: rotate 1 2 3 40 about 5 6 7")
    except pymeshlab.PyMeshLabException as e:
        print(e)
"""


@pytest.mark.parametrize("size", [50, 200])
@pytest.mark.parametrize("there", [("t.sel", "t.def"), ("t.def",), ()])
def test_a_full_disk_loses_no_file(tmp_path, size, there):
    """Files that cannot grow stand for the disk: the tags take some hundred bytes, the motions more than 200."""
    for name in there:
        (tmp_path / name).write_text("old\n")
    out = run(SAVE + f"""
import signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, ({size}, {size}))
save({str(tmp_path)!r})
""")
    assert f"Cannot write '{tmp_path}/t.{'sel' if size == 50 else 'def'}': File too large." in out
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == dict.fromkeys(there, "old\n")
    assert run(SAVE + f"save({str(tmp_path)!r})") == ""
    assert (tmp_path / "t.sel").stat().st_size > 50 and (tmp_path / "t.def").stat().st_size > 200


@pytest.mark.parametrize("there", [("a.glb", "a.pc2", "a.csv"), ()])
def test_a_full_disk_loses_no_animation(tmp_path, there):
    """The disk is full while frames are being written."""
    (tmp_path / "poses.csv").write_text("time,easing,up\nmotions,,2: translate 0 0 1\n")
    for name in there:
        (tmp_path / name).write_text("old\n")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    animate = f"""
ms = sheet(40)
try:
    ms.apply_filter("generate_fcd_pose_sequence", poses_file={str(tmp_path / "poses.csv")!r}, frames_per_second=4, gltf_file={str(tmp_path / "a.glb")!r},
                    pc2_file={str(tmp_path / "a.pc2")!r}, save_poses_file={str(tmp_path / "a.csv")!r})
except pymeshlab.PyMeshLabException as e:
    print(e)
print(len(list(ms)), "layers")
"""
    out = run(f"""
import signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000))
{animate}""")
    assert "a.pc2': File too large." in out or "a.glb': File too large." in out, out
    assert "1 layers" in out and {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert "3 layers" in run(animate) and (tmp_path / "a.glb").stat().st_size > 60000 < (tmp_path / "a.pc2").stat().st_size


@pytest.mark.parametrize("there", [("t.sel", "t.def"), ("t.def",), ()])
def test_the_tags_are_as_they_were_where_the_motions_cannot_take_their_place(tmp_path, there):
    library = tmp_path / "refuse.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-o", str(library), "-xc", "-"], text=True, check=True, input="""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <string.h>
static int refuse(const char *to) {
    return strlen(to) > 5 && !strcmp(to + strlen(to) - 5, "t.def") ? errno = EBUSY : 0;
}
int rename(const char *from, const char *to) {
    return refuse(to) ? -1 : ((int (*)(const char *, const char *))dlsym(RTLD_NEXT, "rename"))(from, to);
}
int linkat(int in, const char *from, int out, const char *to, int flags) {
    return refuse(to) ? -1 : ((int (*)(int, const char *, int, const char *, int))dlsym(RTLD_NEXT, "linkat"))(in, from, out, to, flags);
}
""")
    folder = tmp_path / "folder"
    folder.mkdir()
    for name in there:
        (folder / name).write_text("old\n")
    out = run(SAVE + f"save({str(folder)!r})", LD_PRELOAD=str(library))
    assert f"Cannot write '{folder}/t.def': Device or resource busy." in out
    assert {path.name: path.read_text() for path in folder.iterdir()} == dict.fromkeys(there, "old\n")


@pytest.mark.parametrize("name, parameters", [("t.sel", "handles=3, tag_file"), ("t.def", "transform_file"),
                                              ("p.csv", "point_handles_file"), ("p.pp", "point_handles_file")])
def test_a_file_that_is_far_too_large_is_not_read_to_its_end(tmp_path, name, parameters):
    path = tmp_path / name
    path.touch()
    os.truncate(path, 30 << 30)  # a hole
    out = run(f"""
ms = sheet(30)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
try:
    ms.apply_filter(DEFORM, {parameters}={str(path)!r})
except pymeshlab.PyMeshLabException as e:
    print(e)
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) // 1024, "MB")
""")
    assert f"'{path}' is larger than 1 MB" in out and int(out.split()[-2]) < 100, out


def test_cancel_and_little_memory_leave_the_document_as_it_was():
    check_faults(PLUGIN, Path(pymeshlab.__file__).parent / "lib")


@pytest.mark.parametrize("name", ["GRAPH", "DEFORM", "'apply_coord_fcd_deformation'"])
def test_ctrl_c_ends_a_filter_which_changes_nothing(name):
    code = f"""
import signal
ms = sheet(1500)
points = ms.current_mesh().vertex_matrix()
parameters = {{}} if {name} == GRAPH else MOTION
print("begins", flush=True)
try:
    ms.apply_filter({name}, **parameters)
    print("went through")
except pymeshlab.PyMeshLabException as e:
    try:
        print(e)  # Python looks at its own note of the signal about here
    except KeyboardInterrupt:
        print(e)
except KeyboardInterrupt:
    print("late")
try:
    for i in range(100000):
        pass
except KeyboardInterrupt:
    pass
print(sum(1 for _ in ms), (ms.current_mesh().vertex_matrix() == points).all())
ms.apply_filter({name}, **dict(parameters, initial_patches=50))
print(sum(1 for _ in ms), (ms.current_mesh().vertex_matrix() == points).all())
print(signal.getsignal(signal.SIGINT) is signal.default_int_handler)
"""
    child = subprocess.Popen([sys.executable, "-c", PRELUDE + f"pymeshlab.load_plugin({str(PLUGIN)!r})\n" + code], text=True,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert child.stdout.readline() == "begins\n"
    time.sleep(0.2)  # it takes a second or more, most of it in what is prepared
    child.send_signal(signal.SIGINT)
    out, errors = child.communicate(timeout=300)
    assert child.returncode == 0, out + errors[-3000:]
    lines = out.splitlines()
    assert "Cancelled." in out and lines[-3] == "1 True" and lines[-2] != "1 True" and lines[-1] == "True", out
