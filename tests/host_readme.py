# SPDX-License-Identifier: GPL-3.0-or-later
"""What README.md and the manual tell their readers to type, as it is printed there, and that the manual tells of all there is. Needs
what tests/setup.sh makes, and a display."""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pymeshlab
import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = {str(path.relative_to(ROOT / "docs")) if path.parent.name != ROOT.name else path.name: path.read_text(encoding="utf-8")
         for path in [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))]}
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


IN_HOST = [(page, number, code) for page in PAGES for number, code in enumerate(blocks(page, "python")) if "load_plugin" in code]


@pytest.mark.parametrize("page, number, code", [pytest.param(*block, id=f"{block[0]}-{block[1]}") for block in IN_HOST])
def test_python_of_a_page_by_itself(folder, page, number, code):
    saved = re.findall(r"(?:save_current_mesh\(|gltf_file=)'(\S+\.(?:ply|glb))'", code)
    printed = run(folder, sys.executable, "-c", code)
    assert ("'nodes': " in printed and "'converged': True" in printed) == ("print(" in code)
    assert saved, "the block leaves nothing to look at"
    for made in saved:
        assert (folder / made).stat().st_size > 10000
        assert (folder / made).read_bytes().startswith(b"ply\n" if made.endswith(".ply") else b"glTF")


DOORS = ROOT / "examples" / "one_bend"


@pytest.mark.parametrize("door", sorted(path.name for path in DOORS.iterdir()))
def test_the_page_of_the_doors_has_the_files(door):
    assert f"\n{(DOORS / door).read_text(encoding='utf-8')}```\n" in PAGES["doors.md"]


def test_the_doors_lead_to_one_shape(folder):
    run(folder, sys.executable, str(DOORS / "with_pymeshlab.py"))
    compiled(folder, (DOORS / "with_cpp.cpp").read_text(encoding="utf-8"))
    script = pymeshlab.MeshSet()
    os.chdir(folder)
    try:
        if "generate_fcd_deformed_mesh" not in pymeshlab.filter_list():
            pymeshlab.load_plugin("build/plugins/pymeshlab-2025.7/libfilter_fcd.so")
        script.load_new_mesh("meshes/cylinder.ply")
        script.load_filter_script(str(DOORS / "filter_script.mlx"))
        script.apply_filter_script()
    finally:
        os.chdir(ROOT)
    first = script.current_mesh().vertex_matrix()
    for made in ("bent_pymeshlab.ply", "bent_cpp.ply"):
        ms = pymeshlab.MeshSet()
        ms.load_new_mesh(str(folder / made))
        assert abs(ms.current_mesh().vertex_matrix() - first).max() < 1e-6, made  # files of positions in single precision
    top = script.mesh(0).vertex_matrix()[:, 2] > 11.9
    assert abs(first[top][:, 0] - 4).max() < 0.6 and len(first) == 1986


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
    links = [link for link in re.findall(r"\]\(([^)#]+)", PAGES["README.md"]) if "://" not in link]
    assert len(links) > 8 and [link for link in links if not (ROOT / link).exists()] == []


def test_pages_are_short():
    """Those that people read; that of a filter is as long as its parameters."""
    long = {page: text.count("\n") for page, text in PAGES.items() if text.count("\n") > (90 if page == "README.md" else 120)}
    assert not long


def test_links_of_the_manual_lead_somewhere():
    for page, text in PAGES.items():
        for link in re.findall(r"\]\(([^)#\s]+)", text) if page != "README.md" else []:
            assert "://" in link or (ROOT / "docs" / page).parent.joinpath(link).exists(), (page, link)


def test_the_tables_are_those_of_the_data():
    """If not: python3 tests/measured.py writes them."""
    run(ROOT, sys.executable, "tests/measured.py", "check")


def test_what_is_recorded_stands_on_its_page(tmp_path):
    (tmp_path / "docs" / "measured").mkdir(parents=True)
    (tmp_path / "tests").mkdir()
    program = shutil.copy(ROOT / "tests" / "measured.py", tmp_path / "tests")
    (tmp_path / "README.md").touch()
    page = tmp_path / "docs" / "page.md"
    page.write_text("<!-- measured: a where b is 2 with c -->\n<!-- end -->\n")
    subprocess.run([sys.executable, program, "record", "a", "--command", "try"], input="| b | c |\n|---|---|\n| 1 | one |\n| 2 | two |\n",
                   text=True, check=True)
    assert "\n| c |\n|---|\n| two |\n\n<small>`try`; " in page.read_text()
    subprocess.run([sys.executable, program, "check"], check=True)
    page.write_text(page.read_text().replace("two", "three"))
    stale = subprocess.run([sys.executable, program, "check"], stderr=subprocess.PIPE, text=True, check=False)
    assert stale.returncode == 1 and "page.md differ from the data" in stale.stderr


def test_the_manual_has_what_the_filters_say(tmp_path):
    """If not: the command below, with docs as its folder, writes it."""
    run(ROOT, "ninja", "-C", "build/cmake/pymeshlab-2025.7", "-j", "1", "filter_texts")
    run(ROOT, "env", f"LD_LIBRARY_PATH={Path(pymeshlab.__file__).parent / 'lib'}", "build/cmake/pymeshlab-2025.7/filter_texts",
        str(ROOT / "build/plugins/pymeshlab-2025.7/libfilter_fcd.so"), str(tmp_path))
    written = {str(path.relative_to(tmp_path)): path.read_text(encoding="utf-8") for path in tmp_path.glob("**/*.md")}
    assert written == {page: text for page, text in PAGES.items() if page == "filters.md" or page.startswith("filters/")}


def test_a_filter_script_of_the_demo_in_meshlabserver(folder):
    command, = re.findall(r"^    (xvfb-run .*)$", PAGES["scripts.md"], re.MULTILINE)
    case, = re.findall(r"-i build/demo/(\w+)\.ply", command)
    run(ROOT, sys.executable, "-B", "tests/demo.py", case)
    run(folder, "bash", "-c", command)
    assert (folder / "out.ply").stat().st_size > 10000


def compiled(folder, code):
    """Compiles a program with the library, and runs it."""
    (folder / "program.cpp").write_text(code)
    run(folder, "ccache", "clang++", "-std=c++17", f"-I{ROOT}", "-isystem", str(VCGLIB),
        "-isystem", "/usr/include/eigen3", "-c", "program.cpp", "-o", "program.o")
    library = ROOT / "build" / "cmake" / "pymeshlab-2025.7" / "vcg_ext" / "libfcd_vcg_ext.a"
    ply = folder / "plylib.o"
    run(folder, "ccache", "clang++", "-std=c++17", "-isystem", str(VCGLIB), "-w", "-c", str(VCGLIB / "wrap/ply/plylib.cpp"), "-o", str(ply))
    run(folder, "clang++", "program.o", str(ply), str(library), "-o", "program", "-pthread")
    run(folder, "./program")


def test_cpp_with_a_mesh(folder):
    code, = blocks("cpp.md", "cpp")
    includes = re.findall(r"^#include .*$", code, re.MULTILINE)
    lines = [line for line in code.splitlines() if line not in includes]
    compiled(folder, "\n".join([
        *includes, '#include "tests/unit/test_mesh.h"',
        "int main() {", "const fcd_test::MeshD mesh(fcd_test::Tube(20, 8));", *lines,
        "return position.allFinite() && position.cols() == int(mesh.vert.size()) ? 0 : 1;", "}", ""]))
