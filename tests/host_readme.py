# SPDX-License-Identifier: GPL-3.0-or-later
"""What README.md tells its readers to type, as it is printed there. Needs what tests/setup.sh makes, and a display."""
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
VCGLIB = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "fcd/meshlab-2025.07/src/vcglib"
LIMIT = 1800  # seconds, for what hangs


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


def commands(program):
    """The indented lines that begin with it."""
    return re.findall(rf"^    ({program} .*)$", README, re.MULTILINE)


@pytest.fixture
def folder(tmp_path):
    """An empty folder where the paths in the README lead to this checkout."""
    for name in ("build", "meshes", "tests"):
        (tmp_path / name).symlink_to(ROOT / name)
    return tmp_path


def run(folder, *command):
    done = subprocess.run(command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LIMIT)
    assert done.returncode == 0, done.stdout[-3000:]
    return done.stdout


def test_python_in_one_session(folder):
    assert len(blocks("python")) == 7
    printed = run(folder, sys.executable, "-c", "\n".join(blocks("python")))
    assert "'nodes': " in printed and "'converged': True" in printed
    assert (folder / "bar_deformed.ply").stat().st_size > 10000
    assert (folder / "bend.ply").read_bytes().startswith(b"ply\n")


def test_a_filter_script_of_the_demo_in_meshlabserver(folder):
    command, = commands("xvfb-run")
    case, = re.findall(r"-i build/demo/(\w+)\.ply", command)
    run(ROOT, sys.executable, "-B", "tests/demo.py", case)
    run(folder, "bash", "-c", command)
    assert (folder / "out.ply").stat().st_size > 10000


def test_cpp_with_a_mesh(folder):
    code, = blocks("cpp")
    includes = re.findall(r"^#include .*$", code, re.MULTILINE)
    lines = [line for line in code.splitlines() if line not in includes]
    (folder / "program.cpp").write_text("\n".join([
        *includes, '#include "tests/unit/test_mesh.h"',
        "int main() {", "const fcd_test::MeshD mesh(fcd_test::Tube(20, 8));", *lines,
        "return position.allFinite() && position.cols() == int(mesh.vert.size()) ? 0 : 1;", "}", ""]))
    run(folder, "ccache", "g++", "-std=c++17", f"-I{ROOT}", f"-I{ROOT / 'vcg_ext'}", "-isystem", str(VCGLIB),
        "-isystem", "/usr/include/eigen3", "-c", "program.cpp", "-o", "program.o")
    run(folder, "g++", "program.o", "-o", "program", "-pthread")
    run(folder, "./program")
