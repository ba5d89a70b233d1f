# SPDX-License-Identifier: GPL-3.0-or-later
"""The order of the house: who may include whom, and how long a source may be.

    python3 tests/rooms.py

In vcg_ext each folder includes what stands before it in FLOORS, or is its own; only the doors, the headers at the top, include all
of them. Qt and MeshLab are for the plugins alone, VCG for the places in VCG. layer_fcd and filter_fcd have floors, PLUGIN_FLOORS, and edit_fcd
rooms, TOOL_ROOMS. filter_fcd and edit_fcd do not include each other. What the window's loop calls of a tool is guarded. The method takes sine,
exponential and the like from base/elementary.h, for the same bits everywhere."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FLOORS = ["shape_constants.h", "base", "warp", "line", "handles", "surface", "contact", "patches", "graph", "solve", "map", "field", "region_deformer.h", "deformer.h", "fit", "fit.h", "straighten", "straighten.h", "symmetry", "symmetrize.h", "compensate.h", "sequence",
          "centroidal_deformation.h"]
SOURCES = {"deformer.cpp": "deformer.h", "region_deformer.cpp": "region_deformer.h", "deformer_graph.cpp": "region_deformer.h", "region_reader.h": "region_deformer.h", "region_reader.cpp": "region_deformer.h", "deformer_maker.cpp": "deformer.h", "deform_surface.cpp": "deformer.h", "fitter.cpp": "fit.h", "fitter_curves.cpp": "fit.h", "fitter_landmarks.cpp": "fit.h", "fitter_param.cpp": "fit.h", "fitter_report.cpp": "fit.h", "fitter_run.h": "fit.h", "fitter_run.cpp": "fit.h", "fitter_settle.cpp": "fit.h", "fitter_starts.cpp": "fit.h", "straightener.cpp": "straighten.h", "straightener_report.cpp": "straighten.h", "symmetrizer.cpp": "symmetrize.h", "symmetrizer_report.cpp": "symmetrize.h", "compensator.cpp": "compensate.h"}  # of a door, at its floor
VCG = {"centroidal_deformation.h": "reads VCG meshes"}
# Of a tool, what the window's loop calls is guarded: by LayerTool's when(), later() and every().
# The rooms of edit_fcd: what each may include of the others, but for its own. What is a folder's alone is defined in it.
TOOL_ROOMS = {
    "view": [],
    "kit": ["view"],
    "shape": [],
    "bend/model": ["shape", "kit/history.h"],
    "bend/panel": ["kit", "view/colors.h", "bend/model/animation_export.h"],
    "bend/tool": ["view", "kit", "shape", "bend/model", "bend/panel"],
    "fit/model": ["shape", "kit/history.h"],
    "fit/panel": ["kit", "view/colors.h", "fit/model/session.h"],
    "fit/tool": ["view", "kit", "shape", "fit/model", "fit/panel"],
    "": ["bend/tool", "fit/tool"],
}
# The floors of the other two, from below: a file includes what is on its own or a lower one.
PLUGIN_FLOORS = {
    "layer_fcd": [
        "meshlab_host edit_host filter_host parameters angle_normals bend_state bend_text contrasting_colors interrupt layer_labels layer_matrix mesh_copy"
        " layer_normals picked_points save_files weight_sources",
        "layer_state prepared_layers kept_graph inherited kept_tool measured_quality session_format layer_contents rest_shape kept_aside"
        " session_parts session_file",  # the state of a layer, which the document keeps
        "handle_sources tag_sources point_sources",
        "new_layers pose_in_place tagging deformation_uses graph_layer layer_fitter layer_straightener layer_corrections"
        " layer_deformer layer_sequence layer_look",
    ],
    "filter_fcd": [
        "fields filter_reports filter_parameters",
        "bending_parameters fit_parameters fit_reports dialogs",
        "filter_fcd bending_filters filter_texts",
    ],
}
UNGUARDED = re.compile(r"\b(connect|QTimer::singleShot|callOnTimeout)\(")
LONGEST = 350
# What libraries compute each in their own way. (AngleAxis and the closed form for eigenvalues call them.)
VARYING = re.compile(r"\bstd::(sin|cos|tan|asin|acos|atan2?|sinh|cosh|tanh|exp2?|expm1|log|log2|log10|log1p|pow|cbrt|hypot|polar|arg)\b|AngleAxis|computeDirect"
                     r"|\.(sin|cos|tan|exp|log|pow)\(|\.slerp\(")
LONG = {}  # longer ones, each with its reason


def place(name):
    """The floor of a file of vcg_ext, by its path there."""
    return FLOORS.index(SOURCES.get(name, name) if "/" not in name else name.split("/")[0])


def includes(path):
    for number, line in enumerate(path.read_text().split("\n"), 1):
        found = re.match(r'\s*#\s*include\s*[<"]([^>"]+)[>"]', line)
        if found:
            yield number, found[1]


def tool_rooms():
    """What is in edit_fcd where it does not belong."""
    paths = sorted(path for ending in ("h", "cpp") for path in (ROOT / "edit_fcd").glob(f"**/*.{ending}"))
    room = {path: str(path.parent.relative_to(ROOT / "edit_fcd")).lstrip(".") for path in paths}
    home = {name: room[path] for path in paths if path.suffix == ".h"
            for name in re.findall(r"^(?:class|struct) (\w+)(?= [:{]| final)", path.read_text(), re.MULTILINE)}
    for path in paths:
        own, name = room[path], path.relative_to(ROOT)
        if own not in TOOL_ROOMS:
            yield f"{name}:1: error: tests/rooms.py knows no room edit_fcd/{own}"
            continue
        for line, included in includes(path):
            if not included.startswith("edit_fcd/") or "/moc_" in included:
                continue
            to = included[len("edit_fcd/"):]
            if to.rpartition("/")[0] != own and not any(to.startswith(each + "/") or to == each for each in TOOL_ROOMS[own]):
                yield f"{name}:{line}: error: {included} is not for edit_fcd/{own}"
        for found in re.finditer(r"^\S[^\n(=]*?\b(\w+)::~?\w+\(", path.read_text(), re.MULTILINE):
            if home.get(found[1], own) != own:
                yield f"{name}:1: error: defines a function of {found[1]}, which is edit_fcd/{home[found[1]]}'s"


def plugin_floors():
    """What in layer_fcd and filter_fcd includes a higher floor."""
    for folder, floors in PLUGIN_FLOORS.items():
        floor = {name: number for number, names in enumerate(floors) for name in names.split()}
        for path in sorted([*(ROOT / folder).glob("*.h"), *(ROOT / folder).glob("*.cpp")]):
            if path.stem not in floor:
                yield f"{folder}/{path.name}:1: error: tests/rooms.py knows no floor for it"
                continue
            for line, included in includes(path):
                other = Path(included).stem
                if (path.parent / Path(included).name).exists() and floor.get(other, 0) > floor[path.stem]:
                    yield f"{folder}/{path.name}:{line}: error: {included} is on a higher floor"


def main():
    faults = [*tool_rooms(), *plugin_floors()]
    for path in sorted([*ROOT.glob("vcg_ext/**/*.h"), *ROOT.glob("vcg_ext/**/*.cpp")]):
        name = str(path.relative_to(ROOT / "vcg_ext"))
        if name.startswith("unity/"):
            continue
        for line, text in enumerate(path.read_text().split("\n"), 1):
            found = VARYING.search(text.split("//")[0])
            if found:
                faults.append(f"vcg_ext/{name}:{line}: error: {found[0]} has other bits elsewhere; see base/elementary.h")
        for line, included in includes(path):
            where = f"vcg_ext/{name}:{line}: error: "
            if included.startswith("vcg_ext/"):
                if place(included[len("vcg_ext/"):]) > place(name):
                    faults.append(f"{where}{included} is on a higher floor")
            elif included.startswith(("vcg/", "wrap/")) and name not in VCG:
                faults.append(f"{where}{included} is VCG's, which is for {', '.join(VCG)}")
            elif included.startswith(("Q", "common/", "meshlab/")):
                faults.append(f"{where}{included} is Qt's or MeshLab's, which are for the plugins")
    compiled = {included for path in (ROOT / "vcg_ext/unity").glob("*.cpp") for _, included in includes(path)}
    for path in sorted(ROOT.glob("vcg_ext/**/*.cpp")):
        name = str(path.relative_to(ROOT))
        if name not in compiled and not name.startswith("vcg_ext/unity/"):
            faults.append(f"{name}:1: error: no source in vcg_ext/unity includes it")
    for plugin, other in (("filter_fcd", "edit_fcd"), ("edit_fcd", "filter_fcd"), ("layer_fcd", "filter_fcd"),
                          ("layer_fcd", "edit_fcd")):
        for path in sorted((ROOT / plugin).glob("**/*.*")):
            if path.suffix in (".h", ".cpp"):
                faults += [f"{path.relative_to(ROOT)}:{line}: error: includes {included}"
                           for line, included in includes(path) if other in included]
    for path in sorted((ROOT / "edit_fcd").glob("**/*.cpp")):
        text = path.read_text()
        if re.search(r"^\S.* (Bend|Fit)Tool::", text, re.MULTILINE):
            faults += [f"{path.relative_to(ROOT)}:{line}: error: a slot of a tool that is not guarded"
                       for line, each in enumerate(text.split("\n"), 1) if UNGUARDED.search(each)]
    for folder in ("vcg_ext", "layer_fcd", "filter_fcd", "edit_fcd", "python"):
        for path in sorted([*(ROOT / folder).glob("**/*.h"), *(ROOT / folder).glob("**/*.cpp")]):
            name, lines = str(path.relative_to(ROOT)), path.read_text().count("\n")
            if lines > LONGEST and name not in LONG:
                faults.append(f"{name}:1: error: {lines} lines, where {LONGEST} are the most without a reason")
            if lines <= LONGEST and name in LONG:
                faults.append(f"{name}:1: error: tests/rooms.py has a reason for its length, which it does not need")
    faults += [f"tests/rooms.py: error: has a reason for {name}, which is nowhere" for name in LONG if not (ROOT / name).exists()]
    print("\n".join(faults) or "everything is where it belongs")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
