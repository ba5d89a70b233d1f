#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The main job on real meshes: graph, patches and deformed mesh, through pymeshlab and through meshlabserver.

The meshes are the samples that the pymeshlab package ships, at their own size and refined past a million vertices. For each
case this writes to build/demo/:
  NAME.ply              the input, where it is not the sample as it is
  NAME graph.ply/.obj, NAME patches.ply, NAME deformed graph.ply/.obj, NAME deformed.ply
                        the layers that pymeshlab made (.obj: with the edges, which MeshLab's PLY leaves out)
  NAME.mlx, NAME.log    the same job as a filter script, and what meshlabserver said
  NAME meshlabserver.ply  the deformed layer that meshlabserver made
  NAME.png              input, patches, graph and result
The two results are compared vertex by vertex. Run it with tests/demo.sh.
"""
import argparse
import os
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import pymeshlab

import render

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build"
OUT = BUILD / "demo"
SAMPLES = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
PLUGIN = BUILD / "plugins" / "pymeshlab-2025.7" / "libfilter_fcd.so"
MESHLABSERVER = BUILD / "meshlab-2020.09" / "meshlabserver"

# One host computes with double and the other with float, so the results differ by rounding: % of the diagonal.
TOLERANCE = 0.01


@dataclass
class Case:
    name: str
    sample: str
    tags: str  # MeshLab's expression for the tag of a vertex
    motion: dict  # parameters of the deformation that are not the default
    view: tuple
    up: tuple
    refine: int = 0  # vertices to exceed by subdivision; 0 = as it is
    graph: dict = field(default_factory=dict)  # parameters of the graph that are not the default


# The bone is bent over its middle: the handle, one end, turns about a point a little inside the bend, so that the shaft
# keeps its length.
BONE = dict(
    sample="bone.ply",
    tags="x < 0.25 ? 0 : (x > 0.75 ? 2 : 1)",
    motion=dict(rotation_axis=(0, 1, 0), rotation_angle=-80, rotation_center=2, rotation_point=(0.5, 0.5, 0.56)),
    view=(0.1, -1, 0.35),
    up=(0, 0, 1),
)
# The bunny looks aside: the face is the handle, ears and chest follow, belly and hind legs stay.
BUNNY = dict(
    sample="bunny10k_textured.obj",
    tags="y < 6 || x > 2 ? 0 : (x < -4 && y > 12.5 && y < 14.5 ? 2 : 1)",
    motion=dict(rotation_axis=(0, 1, 0), rotation_angle=-40, rotation_center=2, rotation_point=(-3.5, 10, 0)),
    view=(-0.45, 0.3, 1),
    up=(0, 1, 0),
)
# The head of a scanned statue is tilted: chin and neck stay, the crown is the handle.
FACE = dict(
    sample="rangemaps/face000.ply",
    tags="y < -50 ? 0 : (y > 45 ? 2 : 1)",
    motion=dict(rotation_axis=(0, 0, 1), rotation_angle=-35, rotation_center=2, rotation_point=(0, 0, -800)),
    view=(0.15, 0, 1),
    up=(0, 1, 0),
)
CASES = [
    Case("bone", **BONE),
    Case("bunny", **BUNNY),
    Case("face", **FACE),
    Case("bone_million", refine=1000000, **BONE),
    Case("bunny_million", refine=1000000, **BUNNY),
]

# The parameters of the two filters: name, type in a filter script, default, names of an enum's values.
GRAPH_PARAMETERS = [
    ("target_radius", "RichAbsPerc", 0.0),
    ("initial_patches", "RichInt", 300),
    ("max_iterations", "RichInt", 100),
    ("random_seed", "RichInt", 1),
    ("patches_layer", "RichBool", True),
]
DEFORM_PARAMETERS = [
    ("handles", "RichEnum", 0, "Vertex quality", "Selection", "Custom vertex attribute", "Files"),
    ("tag_attribute", "RichString", "fcd_tag"),
    ("tag_file", "RichOpenFile", "", "*.sel"),
    ("transform_file", "RichOpenFile", "", "*.def"),
    ("transforms", "RichString", ""),
    ("point_handles_file", "RichOpenFile", "", "*.csv", "*.pp"),
    ("translation", "RichPoint3f", (0, 0, 0)),
    ("rotation_axis", "RichPoint3f", (0, 0, 1)),
    ("rotation_angle", "RichFloat", 0.0),
    ("rotation_center", "RichEnum", 0, "Barycentre of the handle", "Origin", "Rotation point"),
    ("rotation_point", "RichPoint3f", (0, 0, 0)),
    ("TransformMatrix", "RichMatrix44f", np.eye(4)),
    ("use_graph_layer", "RichBool", False),
    ("graph_layer", "RichMesh", 0),
    ("target_radius", "RichAbsPerc", 0.0),
    ("initial_patches", "RichInt", 0),
    ("random_seed", "RichInt", 1),
    ("smoothness", "RichFloat", 0.0058),
    ("max_iterations", "RichInt", 1000),
    ("tolerance", "RichFloat", 1e-5),
    ("graph_weights", "RichEnum", 0, "Common border", "Uniform", "As in the paper", "The paper to the letter"),
    ("weights", "RichEnum", 0, "Along the surface", "Euclidean"),
    ("influence", "RichFloat", 4.0),
    ("loose_parts", "RichEnum", 0, "Follow", "Stay"),
    ("pose", "RichFloat", 100.0),
    ("graph_layers", "RichBool", True),
    ("deformed_quality", "RichEnum", 0, "As the input", "Stretch", "Rotation angle", "Contact"),
]
TAG_PARAMETERS = [
    ("q", "RichString", ""),
    ("normalize", "RichBool", False),
    ("map", "RichBool", False),
    ("onselected", "RichBool", False),
]


def with_values(parameters, values):
    unknown = set(values) - {p[0] for p in parameters}
    assert not unknown, f"no such parameters: {unknown}"
    return [(name, kind, values.get(name, default), names) for name, kind, default, *names in parameters]


def script_parameter(name, kind, value, names, diagonal):
    """One parameter as it stands in a filter script."""
    if kind == "RichBool":
        rest = f'value="{str(value).lower()}"'
    elif kind == "RichPoint3f":
        rest = 'x="%g" y="%g" z="%g"' % tuple(value)
    elif kind == "RichMatrix44f":
        rest = " ".join(f'val{i}="{x:g}"' for i, x in enumerate(np.ravel(value)))
    elif kind == "RichAbsPerc":
        rest = f'value="{value:g}" min="0" max="{diagonal:g}"'
    elif kind == "RichEnum":
        rest = f'value="{value}" enum_cardinality="{len(names)}" ' + " ".join(
            f"enum_val{i}={quoteattr(n)}" for i, n in enumerate(names))
    elif kind == "RichOpenFile":
        rest = f'value={quoteattr(value)} exts_cardinality="{len(names)}" ' + " ".join(
            f'exts_val{i}="{name}"' for i, name in enumerate(names))
    elif kind == "RichFloat":
        rest = f'value="{value:g}"'
    else:
        rest = f"value={quoteattr(str(value))}"
    return f'  <Param type="{kind}" name="{name}" {rest}/>'


def filter_script(filters, diagonal):
    """A filter script; meshlabserver wants every parameter of every filter in it."""
    lines = ["<!DOCTYPE FilterScript>", "<FilterScript>"]
    for name, parameters, values in filters:
        lines.append(f" <filter name={quoteattr(name)}>")
        lines += [script_parameter(*p, diagonal) for p in with_values(parameters, values)]
        lines.append(" </filter>")
    return "\n".join(lines + ["</FilterScript>", ""])


def python_arguments(parameters, values):
    """The same for pymeshlab: all parameters that are not the default."""
    arguments = {}
    for name, kind, value, _ in with_values(parameters, values):
        if name in values:
            if kind in ("RichPoint3f", "RichMatrix44f"):
                value = np.array(value, float)
            elif kind == "RichAbsPerc":
                value = pymeshlab.PureValue(float(value))
            elif kind == "RichFloat":
                value = float(value)
            arguments[name.lower()] = value
    return arguments


def write_ply(path, mesh, folder):
    """Single precision, so that hosts with float and with double scalars read the very same mesh. With its texture, which
    is in a folder."""
    corners = [("n", "u1"), ("corner", "<i4", 3)]
    header = ["ply", "format binary_little_endian 1.0"]
    textures = list(mesh.textures()) if mesh.has_wedge_tex_coord() else []
    assert len(textures) <= 1, "one texture at most"
    for name in textures:
        shutil.copy(folder / name, path.parent)
        header.append(f"comment TextureFile {name}")
    header.append(f"element vertex {mesh.vertex_number()}")
    header += [f"property float {axis}" for axis in "xyz"]
    header += [f"element face {mesh.face_number()}", "property list uchar int vertex_indices"]
    if textures:
        corners += [("k", "u1"), ("uv", "<f4", 6)]
        header.append("property list uchar float texcoord")
    record = np.empty(mesh.face_number(), np.dtype(corners))
    record["n"], record["corner"] = 3, mesh.face_matrix()
    if textures:
        record["k"], record["uv"] = 6, mesh.wedge_tex_coord_matrix().reshape(-1, 6)
    with open(path, "wb") as file:
        file.write("\n".join(header + ["end_header", ""]).encode())
        file.write(mesh.vertex_matrix().astype("<f4").tobytes())
        file.write(record.tobytes())


def prepare(case):
    """The file with the input: the sample itself, or a PLY of it where it is to be refined (subdivision after Loop) or is in
    another format (MeshLab 2020.09 cannot read every OBJ)."""
    sample = SAMPLES / case.sample
    if not case.refine and sample.suffix == ".ply":
        return sample
    ms = pymeshlab.MeshSet(verbose=False)
    ms.load_new_mesh(str(sample))
    if case.refine:
        ms.meshing_remove_unreferenced_vertices()
    while ms.current_mesh().vertex_number() <= case.refine:
        ms.meshing_surface_subdivision_loop(loopweight=0, iterations=1, threshold=pymeshlab.PureValue(0), selected=False)
    path = OUT / f"{case.name}.ply"
    write_ply(path, ms.current_mesh(), sample.parent)
    return path


def reset_peak_memory():
    Path("/proc/self/clear_refs").write_text("5")


def peak_memory():
    """Of this process since the last reset, GiB."""
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 2**20


class Watch:
    """Seconds since it was made or asked last."""

    def __init__(self):
        self.start = time.perf_counter()

    def lap(self):
        now = time.perf_counter()
        lap, self.start = now - self.start, now
        return lap


def run_pymeshlab(case, source):
    """The job in pymeshlab. Returns the MeshSet, its layers by role, the returned values and seconds per stage."""
    seconds, watch = {}, Watch()
    ms = pymeshlab.MeshSet(verbose=False)
    ms.load_new_mesh(str(source))
    before = ms.current_mesh().vertex_matrix()
    seconds["load"] = watch.lap()
    ms.compute_scalar_by_function_per_vertex(q=case.tags)
    seconds["tags"] = watch.lap()
    graph = ms.apply_filter("generate_fcd_deformation_graph", **python_arguments(GRAPH_PARAMETERS, case.graph))
    seconds["graph filter"] = watch.lap()
    deform = ms.apply_filter("generate_fcd_deformed_mesh",
                             **python_arguments(DEFORM_PARAMETERS, {**case.graph, **case.motion}))
    seconds["deform filter"] = watch.lap()

    layers = dict(zip(("input", "graph", "patches", "rest graph", "deformed graph", "deformed"), ms))
    assert len(layers) == len(list(ms)) == 6, f"{len(list(ms))} layers instead of 6"
    assert ms.current_mesh().id() == layers["deformed"].id(), "the deformed mesh is not the current layer"
    assert (layers["input"].vertex_matrix() == before).all(), "the input was changed"
    return ms, layers, {"graph": graph, "deform": deform}, seconds


def run_meshlabserver(case, source, diagonal):
    """The same job as a filter script in meshlabserver. Returns the file with the result."""
    script, result, log = (OUT / f"{case.name}{end}" for end in (".mlx", " meshlabserver.ply", ".log"))
    script.write_text(filter_script(
        [("Per Vertex Quality Function", TAG_PARAMETERS, dict(q=case.tags)),
         ("FCD: Build Deformation Graph", GRAPH_PARAMETERS, case.graph),
         ("FCD: Deform Mesh", DEFORM_PARAMETERS, {**case.graph, **case.motion})], diagonal))
    result.unlink(missing_ok=True)
    with open(log, "w") as file:
        done = subprocess.run(["xvfb-run", "--auto-servernum", MESHLABSERVER, "-i", source, "-s", script, "-o", result],
                              stdout=file, stderr=subprocess.STDOUT, timeout=900)
    if done.returncode or not result.exists():
        tail = "\n".join(log.read_text(errors="replace").splitlines()[-15:])
        raise SystemExit(f"{case.name}: meshlabserver failed with {done.returncode}; the end of {log}:\n{tail}")
    return result


def save_layers(case, ms, layers):
    for role in ("graph", "patches", "deformed graph", "deformed"):
        ms.set_current_mesh(layers[role].id())
        ms.save_current_mesh(str(OUT / f"{case.name} {role}.ply"))
        if role.endswith("graph"):
            ms.save_current_mesh(str(OUT / f"{case.name} {role}.obj"))


def picture(case, layers):
    surface = {role: render.Surface.of_layer(layer) for role, layer in layers.items()}
    panel = render.Panel
    count = layers["input"].vertex_number()
    render.render(
        OUT / f"{case.name}.png",
        [panel(surface["input"], "tags", f"{count:,} vertices: fixed, free, handle"),
         panel(surface["patches"], "color", "patches"),
         panel(surface["rest graph"], "graph", f"graph of {layers['rest graph'].vertex_number()} nodes",
               ghost=surface["input"]),
         panel(surface["deformed graph"], "graph", "deformed graph", ghost=surface["deformed"]),
         panel(surface["deformed"], "plain", "deformed")],
        view=case.view, up=case.up)


def run(case):
    source = prepare(case)
    reset_peak_memory()
    ms, layers, values, seconds = run_pymeshlab(case, source)
    peak = peak_memory()
    rest = layers["input"].vertex_matrix()
    diagonal = np.linalg.norm(np.ptp(rest, axis=0))
    ours = layers["deformed"].vertex_matrix()
    assert np.isfinite(ours).all(), f"{(~np.isfinite(ours).all(1)).sum()} vertices are not at finite places"
    assert np.linalg.norm(ours - rest, axis=1).max() > 0.01 * diagonal, "nothing was deformed"
    difference = None
    watch = Watch()
    if MESHLABSERVER.exists():
        result = run_meshlabserver(case, source, diagonal)
        seconds["meshlabserver"] = watch.lap()
        other = pymeshlab.MeshSet(verbose=False)
        other.load_new_mesh(str(result))
        theirs = other.current_mesh().vertex_matrix()
        del other
        assert theirs.shape == ours.shape, f"{len(theirs)} vertices from meshlabserver, {len(ours)} from pymeshlab"
        difference = 100 * np.linalg.norm(theirs - ours, axis=1).max() / diagonal

    watch.lap()
    save_layers(case, ms, layers)
    seconds["save"] = watch.lap()
    picture(case, layers)
    seconds["picture"] = watch.lap()
    return dict(case=case, vertices=len(rest), peak=peak, difference=difference, seconds=seconds, **values)


COLUMNS = [  # heading, value of a run
    ("case", lambda r: r["case"].name),
    ("vertices", lambda r: f"{r['vertices']}"),
    ("nodes", lambda r: f"{r['deform']['nodes']}"),
    ("load", lambda r: f"{r['seconds']['load']:.2f}"),
    ("tags", lambda r: f"{r['seconds']['tags']:.2f}"),
    ("graph filter", lambda r: f"{r['seconds']['graph filter']:.2f}"),
    ("deform filter", lambda r: f"{r['seconds']['deform filter']:.2f}"),
    ("= graph", lambda r: f"{r['deform']['seconds_graph']:.3f}"),
    ("+ solve", lambda r: f"{r['deform']['seconds_solve']:.3f}"),
    ("+ map", lambda r: f"{r['deform']['seconds_map']:.3f}"),
    ("+ layers", lambda r: "%.3f" % (r["seconds"]["deform filter"] - r["deform"]["seconds_graph"]
                                     - r["deform"]["seconds_solve"] - r["deform"]["seconds_map"])),
    ("iterations", lambda r: "%d%s" % (r["deform"]["iterations"], "" if r["deform"]["converged"] else " (not converged)")),
    ("peak GiB", lambda r: f"{r['peak']:.1f}"),
]
COMPARED = [  # where there is a meshlabserver
    ("meshlabserver", lambda r: f"{r['seconds']['meshlabserver']:.1f}"),
    ("difference %", lambda r: f"{r['difference']:.1e}"),
]


def print_table(results):
    columns = COLUMNS + (COMPARED if MESHLABSERVER.exists() else [])
    rows = [[heading for heading, _ in columns]] + [[str(value(r)) for _, value in columns] for r in results]
    widths = [max(len(row[k]) for row in rows) for k in range(len(columns))]
    for row in rows:
        print("  ".join(cell.ljust(w) if k == 0 else cell.rjust(w) for k, (cell, w) in enumerate(zip(row, widths))))


def main():
    names = [case.name for case in CASES]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="case", help=f"default: all of {', '.join(names)}")
    args = parser.parse_args()
    if unknown := set(args.cases) - set(names):
        parser.error(f"no such case: {', '.join(unknown)}; there are {', '.join(names)}")

    OUT.mkdir(parents=True, exist_ok=True)
    pymeshlab.load_plugin(str(PLUGIN))
    results = []
    for case in CASES:
        if not args.cases or case.name in args.cases:
            print(f"demo: {case.name}", flush=True)
            results.append(run(case))
    print("\nSeconds per stage. Peak memory of pymeshlab with all six layers. " +
          ("'difference' is the largest distance between a vertex in\npymeshlab's result and in meshlabserver's, in % of the "
           "bounding box diagonal.\n" if MESHLABSERVER.exists() else "This MeshLab has no meshlabserver to compare with.\n"))
    print_table(results)
    print(f"\nLayers and pictures: {os.path.relpath(OUT)}/")
    apart = [r["case"].name for r in results if r["difference"] is not None and r["difference"] > TOLERANCE]
    if apart:
        raise SystemExit(f"The two hosts differ by more than {TOLERANCE} % of the diagonal: {', '.join(apart)}")


if __name__ == "__main__":
    sys.exit(main())
