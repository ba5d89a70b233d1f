# SPDX-License-Identifier: GPL-3.0-or-later
"""What README.md and the manual tell their readers to type, as it is printed there, and that the manual tells of all there is. Needs
what tests/setup.sh makes, and a display."""
import os
import re
import subprocess
import sys
from pathlib import Path

import pymeshlab
import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = {path.name: path.read_text(encoding="utf-8") for path in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]}
VCGLIB = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "fcd/vcglib"
LIMIT = 1800  # seconds, for what hangs


def blocks(page, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGES[page], re.MULTILINE | re.DOTALL)


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


@pytest.mark.parametrize("page, count, made", [("scripts.md", 4, "bar_deformed.ply"), ("layers.md", 3, "bend.ply"),
                                               ("straighten.md", 1, "cylinder_bent.ply"), ("sequences.md", 1, "cylinder_key_frame_2.ply")])
def test_python_of_a_page_in_one_session(folder, page, count, made):
    assert len(blocks(page, "python")) == count
    printed = run(folder, sys.executable, "-c", "\n".join(blocks(page, "python")))
    assert ("'nodes': " in printed and "'converged': True" in printed) == ("print(" in PAGES[page])
    assert (folder / made).stat().st_size > 10000
    assert (folder / made).read_bytes().startswith(b"ply\n")


@pytest.mark.parametrize("host, place, names", [
    ("meshlab-2020.09", "/usr/lib/*/meshlab/plugins", ["libedit_fcd.so", "libfilter_fcd.so"]),
    ("meshlab-2025.07", "/usr/lib/*/meshlab/plugins", ["libedit_fcd.so", "libfilter_fcd.so"]),
    ("pymeshlab-2025.7", f"{ROOT}/build/venv/lib/python3*/site-packages/pymeshlab/lib/plugins", ["libfilter_fcd.so"])])
def test_cmake_installs_where_the_host_looks(folder, host, place, names):
    run(ROOT, "env", f"DESTDIR={folder}", "cmake", "--install", f"build/cmake/{host}")
    installed = sorted(folder.glob(f".{place}/*"))
    assert [path.name for path in installed] == names
    for path in installed:
        assert path.read_bytes() == (ROOT / "build/plugins" / host / path.name).read_bytes()


def test_links_of_the_readme_lead_somewhere():
    links = [link for link in re.findall(r"\]\(([^)]+)\)", PAGES["README.md"]) if "://" not in link]
    assert len(links) > 8 and [link for link in links if not (ROOT / link).exists()] == []


def test_no_page_has_python_that_is_not_run():
    of_the_package = {"README.md", "python.md", "tiles.md", "symmetry.md", "compensation.md"}  # which tests/python/test_pages.py runs
    assert {page for page in PAGES if blocks(page, "python")} == {"scripts.md", "layers.md", "straighten.md", "sequences.md"} | of_the_package


def test_the_manual_has_what_the_filters_say():
    """If not: the command below writes it."""
    run(ROOT, "ninja", "-C", "build/cmake/pymeshlab-2025.7", "-j", "1", "filter_texts")
    printed = run(ROOT, "env", f"LD_LIBRARY_PATH={Path(pymeshlab.__file__).parent / 'lib'}",
                  "build/cmake/pymeshlab-2025.7/filter_texts", str(ROOT / "build/plugins/pymeshlab-2025.7/libfilter_fcd.so"))
    assert printed == PAGES["filters.md"]


def test_a_filter_script_of_the_demo_in_meshlabserver(folder):
    command, = re.findall(r"^    (xvfb-run .*)$", PAGES["scripts.md"], re.MULTILINE)
    case, = re.findall(r"-i build/demo/(\w+)\.ply", command)
    run(ROOT, sys.executable, "-B", "tests/demo.py", case)
    run(folder, "bash", "-c", command)
    assert (folder / "out.ply").stat().st_size > 10000


def test_cpp_with_a_mesh(folder):
    code, = blocks("scripts.md", "cpp")
    includes = re.findall(r"^#include .*$", code, re.MULTILINE)
    lines = [line for line in code.splitlines() if line not in includes]
    (folder / "program.cpp").write_text("\n".join([
        *includes, '#include "tests/unit/test_mesh.h"',
        "int main() {", "const fcd_test::MeshD mesh(fcd_test::Tube(20, 8));", *lines,
        "return position.allFinite() && position.cols() == int(mesh.vert.size()) ? 0 : 1;", "}", ""]))
    run(folder, "ccache", "clang++", "-std=c++17", f"-I{ROOT}", "-isystem", str(VCGLIB),
        "-isystem", "/usr/include/eigen3", "-c", "program.cpp", "-o", "program.o")
    library = ROOT / "build" / "cmake" / "pymeshlab-2025.7" / "vcg_ext" / "libfcd_vcg_ext.a"
    run(folder, "clang++", "program.o", str(library), "-o", "program", "-pthread")
    run(folder, "./program")
