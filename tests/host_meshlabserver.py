# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin inside MeshLab 2020.09's meshlabserver, which runs filter scripts. FCD_MESHLABSERVER names the program; it needs
a display (xvfb-run). Layers are read back with pymeshlab."""
import os
import re
import shutil
import subprocess
import xml.etree.ElementTree
from pathlib import Path

import numpy as np
import pymeshlab
import pytest

from conftest import LARGE_SCANS, MESHES, SAMPLES, about, check_faults, record, rotation, transformed, translation, unpacked, write_tags, write_transforms
from glb import JPEG, Glb

SERVER = os.environ["FCD_MESHLABSERVER"]
PLUGINS = Path(__file__).resolve().parents[1] / "build" / "plugins"

BONE_TAGS = "(x &lt; 0.25) ? 0 : ((x &gt; 0.75) ? 2 : 1)"


def parameter(kind, name, **values):
    return f'<Param type="Rich{kind}" name="{name}" ' + " ".join(f'{k}="{v}"' for k, v in values.items()) + "/>"


def choice(name, value, count):
    return parameter("Enum", name, value=value, enum_cardinality=count, **{f"enum_val{i}": i for i in range(count)})


def point(name, p):
    return parameter("Point3f", name, x=p[0], y=p[1], z=p[2])


def boolean(name, value):
    return parameter("Bool", name, value="true" if value else "false")


def quality_filter(expression):
    return ('<filter name="Per Vertex Quality Function">' + parameter("String", "q", value=expression) +
            boolean("normalize", False) + boolean("map", False) + boolean("onselected", False) + "</filter>")


def graph_filter(target_radius=0, initial_patches=300, max_iterations=100, random_seed=1, patches_layer=True):
    return ('<filter name="FCD: Build Deformation Graph">' +
            parameter("AbsPerc", "target_radius", value=target_radius, min=0, max=100) +
            parameter("Int", "initial_patches", value=initial_patches) +
            parameter("Int", "max_iterations", value=max_iterations) + parameter("Int", "random_seed", value=random_seed) +
            boolean("patches_layer", patches_layer) + "</filter>")


def like(handle_layer):
    """What the window writes; scripts of before lack it."""
    return "" if handle_layer is None else parameter("Mesh", "handle_layer", value=handle_layer)


def deform_filter(handles=0, tag_attribute="fcd_tag", tag_file="", transform_file="", transforms="", point_handles_file="",
                  translation=(0, 0, 0), rotation_axis=(0, 0, 1), rotation_angle=0, rotation_center=0, rotation_point=(0, 0, 0), matrix=np.eye(4),
                  use_graph_layer=False, graph_layer=0, target_radius=0, initial_patches=0, random_seed=1, smoothness=0.0058,
                  max_iterations=1000, tolerance=1e-5, graph_weights=0, weights=0, influence=4, loose_parts=0, pose=100, graph_layers=True,
                  deformed_quality=0, handle_layer=None):
    return ('<filter name="FCD: Deform Mesh">' + choice("handles", handles, 4) +
            parameter("String", "tag_attribute", value=tag_attribute) +
            parameter("OpenFile", "tag_file", value=tag_file, exts_cardinality=1, exts_val0="*.sel") +
            parameter("OpenFile", "transform_file", value=transform_file, exts_cardinality=1, exts_val0="*.def") +
            parameter("String", "transforms", value=transforms) +
            parameter("OpenFile", "point_handles_file", value=point_handles_file, exts_cardinality=2, exts_val0="*.csv",
                      exts_val1="*.pp") + point("translation", translation) + point("rotation_axis", rotation_axis) +
            parameter("Float", "rotation_angle", value=rotation_angle) + choice("rotation_center", rotation_center, 3) +
            point("rotation_point", rotation_point) +
            parameter("Matrix44f", "TransformMatrix", **{f"val{i}": v for i, v in enumerate(np.ravel(matrix))}) + like(handle_layer) +
            boolean("use_graph_layer", use_graph_layer) + parameter("Mesh", "graph_layer", value=graph_layer) +
            parameter("AbsPerc", "target_radius", value=target_radius, min=0, max=100) +
            parameter("Int", "initial_patches", value=initial_patches) + parameter("Int", "random_seed", value=random_seed) +
            parameter("Float", "smoothness", value=smoothness) + parameter("Int", "max_iterations", value=max_iterations) +
            parameter("Float", "tolerance", value=tolerance) + choice("graph_weights", graph_weights, 4) +
            choice("weights", weights, 2) +
            parameter("Float", "influence", value=influence) + choice("loose_parts", loose_parts, 2) +
            parameter("Float", "pose", value=pose) + boolean("graph_layers", graph_layers) +
            choice("deformed_quality", deformed_quality, 4) + "</filter>")


def pose_filter(handles=0, tag_attribute="fcd_tag", transforms="", translation=(0, 0, 0), rotation_axis=(0, 0, 1), rotation_angle=0,
                rotation_center=0, rotation_point=(0, 0, 0), initial_patches=0, smoothness=0.0058, pose=100, handle_layer=None):
    """This host's dialogs do not scroll: the others have their defaults."""
    return ('<filter name="FCD: Pose in Place">' + choice("handles", handles, 4) + parameter("String", "tag_attribute", value=tag_attribute) +
            parameter("String", "transforms", value=transforms) + point("translation", translation) +
            point("rotation_axis", rotation_axis) + parameter("Float", "rotation_angle", value=rotation_angle) +
            choice("rotation_center", rotation_center, 3) + point("rotation_point", rotation_point) + like(handle_layer) +
            parameter("Int", "initial_patches", value=initial_patches) + parameter("Float", "smoothness", value=smoothness) +
            parameter("Float", "pose", value=pose) + "</filter>")


def fit_filter(target_layer, graph_layers=True, fit_quality=0, landmarks="", landmarks_only=False, start=0):
    handles, = re.findall(r'(<Param type="RichEnum" name="handles".*)<Param type="RichBool" name="use_graph_layer"',
                          deform_filter(handle_layer=target_layer))  # the same parameters, which move nothing here
    return ('<filter name="FCD: Fit to Layer">' + parameter("Mesh", "target_layer", value=target_layer) +
            parameter("OpenFile", "landmarks_file", value=landmarks, exts_cardinality=2, exts_val0="*.csv", exts_val1="*.pp") +
            parameter("OpenFile", "target_landmarks_file", value="", exts_cardinality=1, exts_val0="*.pp") +
            parameter("Float", "landmark_tolerance", value=0) + boolean("landmarks_only", landmarks_only) + choice("start", start, 4) +
            parameter("Float", "stiffness", value=1) + parameter("Float", "largest_distance", value=0) +
            parameter("Float", "largest_angle", value=70) + boolean("both_ways", False) + parameter("Int", "initial_patches", value=150) +
            parameter("Float", "smoothness", value=0.0058) + parameter("Int", "random_seed", value=1) +
            parameter("Int", "samples", value=6000) + parameter("Int", "fit_steps", value=50) + boolean("graph_layers", graph_layers) +
            choice("fit_quality", fit_quality, 3) + handles + "</filter>")


def straighten_filter(layer, line_file, to=1, angle=90, straightened_quality=1, middle=False, direction=(0, 0, 0), towards=(0, 0, 1)):
    return ('<filter name="FCD: Straighten Mesh">' + parameter("Mesh", "line_layer", value=layer) +
            parameter("OpenFile", "line_file", value=line_file, exts_cardinality=3, exts_val0="*.pp", exts_val1="*.csv", exts_val2="*.txt") +
            parameter("Float", "line_smoothing", value=0) + boolean("middle", middle) + choice("to", to, 3) +
            parameter("Float", "angle", value=angle) + point("direction", direction) + point("towards", towards) +
            parameter("Mesh", "target_layer", value=layer) + boolean("reverse", False) + parameter("Float", "length", value=0) +
            boolean("untwist", False) + parameter("Int", "initial_patches", value=1000) + parameter("Float", "smoothness", value=0.0058) +
            parameter("Int", "random_seed", value=1) + boolean("graph_layers", True) +
            choice("straightened_quality", straightened_quality, 2) + "</filter>")


def sequence_filter(poses_file, folder=None, frame_layers=1, gltf_shapes=0):
    """Writes files to a folder, or none."""
    file = lambda name: folder / name if folder else ""
    return ('<filter name="FCD: Pose Sequence">' + parameter("OpenFile", "poses_file", value=poses_file, exts_cardinality=1, exts_val0="*.csv") +
            parameter("Float", "frames_per_second", value=4) + choice("frame_layers", frame_layers, 3) +
            parameter("SaveFile", "gltf_file", value=file("bone.glb"), ext="*.glb") + choice("gltf_shapes", gltf_shapes, 2) +
            parameter("SaveFile", "pc2_file", value=file("bone.pc2"), ext="*.pc2") +
            parameter("SaveFile", "save_poses_file", value=file("again.csv"), ext="*.csv") +
            parameter("Int", "initial_patches", value=0) + parameter("Float", "smoothness", value=0.0058) +
            parameter("Int", "random_seed", value=1) + choice("handles", 0, 4) + parameter("String", "tag_attribute", value="fcd_tag") +
            parameter("OpenFile", "tag_file", value="", exts_cardinality=1, exts_val0="*.sel") + "</filter>")


def reset_filter(keep_shape=False, to=None):
    """Scripts of before lack the first."""
    return ('<filter name="FCD: Reset Pose">' + ("" if to is None else choice("to", to, 2)) + boolean("keep_shape", keep_shape) +
            "</filter>")


def copy_filter(source_layer, rest_graph, deformed_graph, all_visible=False):
    return ('<filter name="FCD: Apply Deformation to Layer">' + parameter("Mesh", "source_layer", value=source_layer) +
            parameter("Mesh", "rest_graph", value=rest_graph) + parameter("Mesh", "deformed_graph", value=deformed_graph) +
            boolean("all_visible", all_visible) + "</filter>")


class Run:
    """A filter script on a mesh, or on none: the log, and the layers (label without blanks -> mesh) that were there at the end."""

    def __init__(self, folder, mesh, *filters, server=SERVER, under=(), project=None, **environment):
        if mesh:
            shutil.copy(mesh, folder)
        script = folder / "script.mlx"
        script.write_text("<!DOCTYPE FilterScript>\n<FilterScript>" + "\n".join(filters) + "</FilterScript>\n")
        runtime = folder / "runtime"
        runtime.mkdir(mode=0o700)
        done = subprocess.run(
            ["xvfb-run", "-a", *under, server, *(["-i", str(folder / mesh.name)] if mesh else []),
             *(["-p", str(project)] if project else []), "-s", str(script),
             "-w", str(folder / "project.mlp")],
            cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=1800,
            env={**os.environ, "XDG_RUNTIME_DIR": str(runtime), **environment})
        self.log, self.code = done.stdout, done.returncode
        record(self.log)
        self.meshes, self.sets = {}, []  # a mesh lives as long as its set
        for path in sorted(folder.glob("*_out.*")):
            if path.suffix in (".ply", ".obj"):
                self.sets.append(pymeshlab.MeshSet())
                self.sets[-1].load_new_mesh(str(path))
                self.meshes[path.stem[:-len("_out")]] = self.sets[-1].current_mesh()

    def value(self, name):
        return re.search(rf"^{name} = (.*)$", self.log, re.MULTILINE).group(1)


BONE = SAMPLES / "bone.ply"


def test_graph(tmp_path):
    run = Run(tmp_path, BONE, graph_filter())
    assert run.code == 0, run.log
    assert set(run.meshes) == {"bone", "bonegraph", "bonepatches"}, run.log
    assert run.meshes["bonegraph"].vertex_number() == int(run.value("patches"))
    number = run.meshes["bonepatches"].vertex_scalar_array().astype(int)
    assert set(number) == set(range(int(run.value("patches"))))
    colors = run.meshes["bonegraph"].vertex_color_matrix()
    assert np.abs(run.meshes["bonepatches"].vertex_color_matrix() - colors[number]).max() < 1e-6


def test_deformation(tmp_path):
    run = Run(tmp_path, BONE, quality_filter(BONE_TAGS),
              deform_filter(translation=(0, 0, 0.25), rotation_axis=(0, 1, 0), rotation_angle=-45))
    assert run.code == 0, run.log
    assert set(run.meshes) == {"bone", "bonegraph", "bonedeformedgraph", "bonedeformed"}, run.log
    rest, tags = run.meshes["bone"].vertex_matrix(), run.meshes["bone"].vertex_scalar_array()
    points = run.meshes["bonedeformed"].vertex_matrix()
    assert np.isfinite(points).all()
    assert (points[tags == 0] == rest[tags == 0]).all()
    motion = translation([0, 0, 0.25]) @ about(rest[tags == 2].mean(0), rotation([0, 1, 0], -45))
    assert np.abs(points[tags == 2] - transformed(motion, rest[tags == 2])).max() < 1e-6  # the host has single precision
    assert np.linalg.norm(points - rest, axis=1)[tags == 1].max() > 0.05
    nodes = run.meshes["bonegraph"].vertex_number()
    assert nodes == run.meshes["bonedeformedgraph"].vertex_number() == int(run.value("nodes"))
    assert int(run.value("fixed_vertices")) == (tags == 0).sum()
    assert run.value("converged") == "true"


def test_fit_to_a_layer(tmp_path):
    run = Run(tmp_path, BONE, quality_filter(BONE_TAGS), deform_filter(translation=(0, 0, 0.05), graph_layers=False), quality_filter("1"),
              fit_filter(0, fit_quality=1))
    assert run.code == 0, run.log
    assert len(run.meshes) == 5 and run.value("converged") == "true", run.log
    truth, start = run.meshes["bone"].vertex_matrix(), run.meshes["bonedeformed"].vertex_matrix()
    result, = (mesh for name, mesh in run.meshes.items() if "fitted" in name)
    off = [np.sqrt(((points - truth) ** 2).sum(1).mean()) for points in (start, result.vertex_matrix())]
    assert off[1] < 0.1 * off[0]
    assert float(run.value("matched")) > 0.95 and np.median(result.vertex_scalar_array()) < 0.1 * off[0]


def test_a_bend_along_a_line(tmp_path):
    line = tmp_path / "line.csv"
    line.write_text("".join(f"{x}, 0.5, 0.5\n" for x in (0, 0.3, 0.6, 1)))  # along the bone
    run = Run(tmp_path, BONE, straighten_filter(0, line))
    assert "The line is 1 long, and 1 now" in run.log and run.value("length") == "1"
    before, after = run.meshes["bone"].vertex_matrix(), run.meshes["bonestraightened"]
    assert np.abs(after.vertex_scalar_array() - before[:, 0]).max() < 1e-4
    turn, radius, high = (before[:, 0] - 0.5) * np.pi / 2, 2 / np.pi, before[:, 2] - 0.5
    places = np.stack([(radius - high) * np.sin(turn), before[:, 1] - 0.5, radius - (radius - high) * np.cos(turn)], 1)
    off = np.abs(after.vertex_matrix() - 0.5 - places).max(1)
    assert np.median(off) < 1e-4 and np.percentile(off, 90) < 2e-3  # what is not connected follows what is near, rigidly


def test_what_to_print(tmp_path):
    """A bone, bent by a little, is to come out; what is scanned of it is not bent."""
    run = Run(tmp_path, BONE, quality_filter(BONE_TAGS), deform_filter(translation=(0, 0, 0.03), graph_layers=False),
              '<filter name="FCD: Compensate">' + parameter("Mesh", "scan_layer", value=0) + parameter("Int", "degree", value=5) +
              parameter("Float", "largest_distance", value=0) + parameter("Int", "samples", value=3000) + choice("compensated_quality", 1, 2) + "</filter>")
    assert run.code == 0 and float(run.value("missed")) < 1e-6 and float(run.value("rms_left")) < 0.5 * float(run.value("rms_before")), run.log
    nominal = run.meshes["bonedeformed"].vertex_matrix()
    result, = (mesh for name, mesh in run.meshes.items() if "compensated" in name)
    change = result.vertex_matrix() - nominal
    assert np.abs(np.linalg.norm(change, axis=1) - result.vertex_scalar_array()).max() < 1e-5


def test_a_pose_sequence(tmp_path):
    poses = tmp_path / "poses.csv"
    poses.write_text("time;easing;up;turned\nmotions;;\"2: translate 0 0 0.2\";2: rotate 1 0 0 90\n0;smooth\n0.5;linear;100\n1;;50;100\n")
    run = Run(tmp_path, BONE, quality_filter(BONE_TAGS), sequence_filter(poses, tmp_path))
    assert run.code == 0 and run.value("frames") == "5" and run.value("converged") == "true", run.log
    rest, tags = run.meshes["bone"].vertex_matrix(), run.meshes["bone"].vertex_scalar_array()
    up, last = (run.meshes[f"bonekeyframe{i}"].vertex_matrix() for i in (1, 2))
    assert (last[tags == 0] == rest[tags == 0]).all()
    assert np.abs(up[tags == 2] - rest[tags == 2] - [0, 0, 0.2]).max() < 1e-6
    motion = translation([0, 0, 0.1]) @ about(rest[tags == 2].mean(0), rotation([1, 0, 0], 90))
    assert np.abs(last[tags == 2] - transformed(motion, rest[tags == 2])).max() < 1e-6
    frames = np.frombuffer((tmp_path / "bone.pc2").read_bytes(), "<f4", offset=32).reshape(5, -1, 3)
    assert np.abs(frames[2] - up).max() < 1e-6 and np.abs(frames[4] - last).max() < 1e-6
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(tmp_path / "bone.glb"))  # as MeshLab reads it: the shape at rest
    points = ms.current_mesh().vertex_matrix() + ms.current_mesh().transform_matrix()[:3, 3]
    assert points.shape == rest.shape and np.abs(points.max(0) - rest.max(0)).max() < 1e-6 > np.abs(points.min(0) - rest.min(0)).max()
    assert (tmp_path / "again.csv").read_text().startswith("time,easing,up,turned\nsurface,,")


def test_files_and_graph_layer(tmp_path):
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(BONE))
    rest = ms.current_mesh().vertex_matrix()
    tags = np.where(rest[:, 0] < 0.25, 0, np.where(rest[:, 0] > 0.75, 2, 1))
    run = Run(tmp_path, BONE, graph_filter(initial_patches=60, patches_layer=False),
              deform_filter(handles=3, tag_file=write_tags(tmp_path / "t.sel", tags),
                            transform_file=write_transforms(tmp_path / "t.def", translation([0, 0, 0.25])),
                            use_graph_layer=True, graph_layer=1, graph_layers=False))
    assert run.code == 0, run.log
    assert set(run.meshes) == {"bone", "bonegraph", "bonedeformed"}, run.log
    assert 0 < int(run.value("nodes")) <= int(run.value("patches"))  # none where nothing bends
    points = run.meshes["bonedeformed"].vertex_matrix()
    assert (points[tags == 0] == rest[tags == 0]).all()
    assert np.abs(points[tags == 2] - rest[tags == 2] - [0, 0, 0.25]).max() < 1e-6


def test_posing_in_place_and_the_way_back(tmp_path):
    bend = dict(translation=(0, 0, 0.25), rotation_axis=(0, 1, 0), rotation_angle=-45)
    runs = {}
    for name, filters in {"rest": [], "layer": [deform_filter(graph_layers=False, **bend)],
                          "place": [pose_filter(translation=(0, 1, 0)), pose_filter(**bend)],
                          "back": [pose_filter(**bend), reset_filter()],
                          "kept": [pose_filter(**bend), reset_filter(True)],
                          "one back": [pose_filter(**bend), reset_filter(True), pose_filter(translation=(0, 1, 0)), reset_filter()],
                          "as loaded": [pose_filter(**bend), reset_filter(True), pose_filter(translation=(0, 1, 0)),
                                        reset_filter(to=1)]}.items():
        (tmp_path / name).mkdir()
        runs[name] = Run(tmp_path / name, BONE, quality_filter(BONE_TAGS), *filters)
        assert runs[name].code == 0, runs[name].log
    points = {name: run.meshes["bonedeformed" if name == "layer" else "bone"].vertex_matrix() for name, run in runs.items()}
    assert "prepared = false" in runs["place"].log
    assert set(runs["place"].meshes) == {"bone"}
    assert np.abs(points["layer"] - points["rest"]).max() > 0.2
    for name, expected in (("place", "layer"), ("kept", "layer"), ("one back", "layer"), ("back", "rest"), ("as loaded", "rest")):
        assert points[name].tobytes() == points[expected].tobytes(), name


def test_what_a_project_keeps(tmp_path):
    bend = dict(translation=(0, 0, 0.25), rotation_axis=(0, 1, 0), rotation_angle=-45)
    first_of = '<filter name="Change the current layer">' + parameter("Mesh", "layer", value=0) + "</filter>"

    def again(name, *script):
        """Another session: the first one's project, and a script on its first layer."""
        folder = tmp_path / name
        folder.mkdir()
        for path in [*(tmp_path / "first").glob("*_out.ply"), tmp_path / "first" / "project.mlp"]:
            shutil.copy(path, folder)
        return Run(folder, None, first_of, *script, project=folder / "project.mlp")

    (tmp_path / "first").mkdir()
    first = Run(tmp_path / "first", BONE, select_filter("x &lt; 0.25"), tag_filter(0), select_filter("x &gt; 0.75"), tag_filter(2),
                deform_filter(**bend))
    assert first.code == 0, first.log
    for name, parameters in ("anew", {}), ("graph", dict(use_graph_layer=True, graph_layer=1)):
        run = again(name, deform_filter(graph_layers=False, **parameters, **bend))
        assert run.code == 0, run.log
        assert run.meshes["bone_outdeformed"].vertex_matrix().tobytes() == first.meshes["bonedeformed"].vertex_matrix().tobytes()
        assert run.meshes["bone_out"].vertex_color_matrix().tobytes() == first.meshes["bone"].vertex_color_matrix().tobytes()
        assert run.meshes["bonegraph_out"].edge_number() == 0
    assert "so its own patches are used" in run.log
    assert "there is nothing to bring back" in again("clear", '<filter name="FCD: Clear Tags"/>').log
    assert "layers that are saved and loaded lose it" in again("copy", copy_filter(0, 1, 2)).log
    assert "has not been posed in place" in again("reset", reset_filter()).log


def test_a_deformation_for_another_layer(tmp_path):
    run = Run(tmp_path, BONE, quality_filter(BONE_TAGS), deform_filter(translation=(0, 0, 0.25)), copy_filter(0, 1, 2))
    assert run.code == 0, run.log
    assert "layers = 1" in run.log
    # The current layer is the one that was made last: what was done to the source is done to it, too.
    rest, tags = run.meshes["bone"].vertex_matrix(), run.meshes["bone"].vertex_scalar_array()
    once, twice = run.meshes["bonedeformed"].vertex_matrix(), run.meshes["bonedeformed2"].vertex_matrix()
    on_faces = np.isin(np.arange(len(rest)), run.meshes["bone"].face_matrix())  # the others are nearest to something else
    fixed = (tags == 0) & on_faces
    assert once[fixed].tobytes() == twice[fixed].tobytes() == rest[fixed].tobytes()
    assert np.abs((twice - rest)[(tags == 2) & on_faces] - [0, 0, 0.5]).max() < 0.01


def test_motions_as_text(tmp_path):
    run = Run(tmp_path, BONE, quality_filter(BONE_TAGS),
              deform_filter(transforms="2: rotate 1 0 0 270; ", pose=50, graph_layers=False))
    assert run.code == 0, run.log
    rest, tags = run.meshes["bone"].vertex_matrix(), run.meshes["bone"].vertex_scalar_array()
    points = run.meshes["bonedeformed"].vertex_matrix()
    half = about(rest[tags == 2].mean(0), rotation([1, 0, 0], 135))
    assert np.abs(points[tags == 2] - transformed(half, rest[tags == 2])).max() < 1e-6


def matrix_filter(matrix):
    return ('<filter name="Matrix: Set/Copy Transformation">' +
            parameter("Matrix44f", "TransformMatrix", **{f"val{i}": v for i, v in enumerate(np.ravel(matrix))}) +
            boolean("compose", False) + boolean("Freeze", False) + boolean("allLayers", False) + "</filter>")


def test_scripts_may_and_need_not_say_which_layer_the_handles_move_like(tmp_path):
    """The script deforms a copy in place; its handle moves like the original."""
    copied = [quality_filter(BONE_TAGS), '<filter name="Duplicate Current layer"/>', matrix_filter(translation([0, 0.25, -0.125]))]
    rotated = dict(rotation_axis=(0, 1, 0), rotation_angle=-45)
    runs = {}
    for name, script in {"step": [deform_filter(transforms="2: layer 'bone.ply' rotate 0 1 0 -45", graph_layers=False)],
                         "parameter": [deform_filter(handle_layer=0, graph_layers=False, **rotated)],
                         "itself": [deform_filter(handle_layer=1, graph_layers=False, **rotated)],
                         "lacking": [deform_filter(graph_layers=False, **rotated)],
                         "pose": [pose_filter(handle_layer=0, **rotated)]}.items():
        (tmp_path / name).mkdir()
        runs[name] = Run(tmp_path / name, BONE, *copied, *script)
        assert runs[name].code == 0, runs[name].log
    layer = {name: "bone.ply_copy" if name == "pose" else "bone.ply_copydeformed" for name in runs}
    bits = {name: run.meshes[layer[name]].vertex_matrix().tobytes() for name, run in runs.items()}
    assert bits["step"] == bits["parameter"] == bits["pose"]
    assert bits["itself"] == bits["lacking"] != bits["step"]


def test_a_rotation_point_that_single_precision_moves_is_logged(tmp_path):
    far = dict(rotation_angle=30, rotation_center=2, rotation_point=(600000, 5300000, 100), graph_layers=False)
    run = Run(tmp_path, BONE, quality_filter(BONE_TAGS), deform_filter(**far))
    assert "rotation_point reaches the filter in single precision" in run.log and "bonedeformed" in run.meshes, run.log
    (tmp_path / "near").mkdir()
    run = Run(tmp_path / "near", BONE, quality_filter(BONE_TAGS), deform_filter(**{**far, "rotation_point": (0.5, 0.25, 0)}))
    assert "single precision" not in run.log and "bonedeformed" in run.meshes, run.log


def test_point_handles(tmp_path):
    (tmp_path / "p.csv").write_text("# start, target\n0.1 0.5 0.5 0.1 0.5 0.5\n0.5 0.5 0.5, 0.5 0.5 0.6\n0.9 0.5 0.5 0.9 0.5 0.8\n")
    run = Run(tmp_path, BONE, deform_filter(point_handles_file=str(tmp_path / "p.csv"), graph_layers=False))
    assert run.code == 0, run.log
    rest, points = run.meshes["bone"].vertex_matrix(), run.meshes["bonedeformed"].vertex_matrix()
    for start, up in (([0.1, 0.5, 0.5], 0), ([0.5, 0.5, 0.5], 0.1), ([0.9, 0.5, 0.5], 0.3)):
        nearest = np.linalg.norm(rest - start, axis=1).argmin()
        assert np.abs(points[nearest] - rest[nearest] - [0, 0, up]).max() < 1e-6


def test_textures_and_colors_survive(tmp_path):
    source = tmp_path / "source"
    source.mkdir()
    ms = pymeshlab.MeshSet()  # the host's own OBJ importer stops at this file, hence PLY
    ms.load_new_mesh(str(SAMPLES / "bunny10k_textured.obj"))
    ms.apply_filter("compute_color_by_function_per_vertex", x="x*10+128", y="y*10", z="z*10+128")
    ms.save_current_mesh(str(source / "bunny.ply"), save_vertex_color=True, save_wedge_texcoord=True, save_textures=True)
    shutil.copy(SAMPLES / "TextureDouble_A.png", tmp_path)
    run = Run(tmp_path, source / "bunny.ply", quality_filter("(x &lt; 0) ? 0 : ((x &gt; 5) ? 2 : 1)"),
              deform_filter(translation=(0, 0, 2), graph_layers=False))
    assert set(run.meshes) == {"bunny", "bunnydeformed"}, run.log
    rest, deformed = run.meshes["bunny"], run.meshes["bunnydeformed"]
    assert rest.has_wedge_tex_coord() and deformed.has_wedge_tex_coord()
    assert (deformed.wedge_tex_coord_matrix() == rest.wedge_tex_coord_matrix()).all()
    assert deformed.texture_number() == rest.texture_number() == 1
    assert (deformed.vertex_color_matrix() == rest.vertex_color_matrix()).all()
    assert (deformed.vertex_scalar_array() == rest.vertex_scalar_array()).all()


@pytest.mark.parametrize("texture", ["skin.jpg", "gone.png"])
def test_an_animation_has_textures_and_colors(tmp_path, texture):
    """The image of the file, to the byte; where that is not there, the log says so, and the colours are seen."""
    content, source = JPEG if texture == "skin.jpg" else b"", tmp_path / "source"
    source.mkdir()
    if content:
        (tmp_path / texture).write_bytes(content)
    x, y = [grid.ravel() for grid in np.meshgrid(np.arange(41) / 4, np.arange(5) / 4, indexing="ij")]
    first = (5 * np.arange(40)[:, None] + np.arange(4)).ravel()
    points, faces = np.stack([x, y, 0 * x], 1), np.concatenate([np.stack([first, first + 5, first + 1], 1), np.stack([first + 1, first + 5, first + 6], 1)])
    ms = pymeshlab.MeshSet()
    colors = np.column_stack([np.random.default_rng(1).integers(0, 2, (len(points), 3)), np.ones(len(points))])
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_color_matrix=colors, w_tex_coords_matrix=points[faces].reshape(-1, 3)[:, :2] * 0.05))
    ms.save_current_mesh(str(source / "sheet.ply"), save_vertex_color=True, save_wedge_texcoord=True)
    saved = (source / "sheet.ply").read_bytes()
    (source / "sheet.ply").write_bytes(saved.replace(b"element vertex", b"comment TextureFile " + texture.encode() + b"\nelement vertex", 1))
    (tmp_path / "poses.csv").write_text("time,easing,up\nmotions,,2: translate 0 0 0.5\n0,,100\n")
    run = Run(tmp_path, source / "sheet.ply", quality_filter("(x &lt; 0.5) ? 0 : ((x &gt; 9.5) ? 2 : 1)"), sequence_filter(tmp_path / "poses.csv", tmp_path, frame_layers=0))
    assert run.code == 0, run.log
    file = Glb(tmp_path / "bone.glb")
    primitive, = file.json["meshes"][0]["primitives"]
    indices = file.array(primitive["indices"])
    places = file.array(primitive["attributes"]["TEXCOORD_0"])[indices] * [1, -1] + [0, 1]
    assert np.abs(places - points[faces].reshape(-1, 3)[:, :2] * 0.05).max() < 1e-6
    number = file.texture_of(primitive)
    assert (number is None) != bool(content) and ("COLOR_0" in primitive["attributes"]) != bool(content)
    if content:
        assert file.image(number) == (JPEG, "image/jpeg")
    else:
        assert "('gone.png') cannot be read, so the .glb file is without it" in run.log
        assert (file.array(primitive["attributes"]["COLOR_0"])[indices] == 65535 * colors[faces.ravel()]).all()


@pytest.mark.parametrize("quality, parameters, word", [
    ("0", {}, "nobody has tagged"),
    ("x*10", {}, "whole numbers"),
    ("(x &lt; 0.5) ? 0 : 2", {}, "free"),
    (BONE_TAGS, {"handles": 3, "tag_file": "/no/such.sel"}, "/no/such.sel"),
    (BONE_TAGS, {"transforms": "2: turn 0 0 1 90"}, "character 4: expected"),
    (BONE_TAGS, {"initial_patches": -1}, "patches"),
])
def test_an_error_is_a_message_and_no_new_layer(tmp_path, quality, parameters, word):
    run = Run(tmp_path, BONE, quality_filter(quality), deform_filter(**parameters))
    assert word in run.log
    assert "terminate called" not in run.log and run.code >= 0
    assert set(run.meshes) <= {"bone"}


def test_no_layer_is_an_error(tmp_path):
    for name, script in ("graph", graph_filter()), ("tags", tag_filter(2)):
        folder = tmp_path / name
        folder.mkdir()
        run = Run(folder, None, script)
        assert "There is no layer. Open a mesh first." in run.log
        assert "terminate called" not in run.log and run.code >= 0


def select_filter(condition):
    return ('<filter name="Conditional Vertex Selection">' + parameter("String", "condSelect", value=condition) + "</filter>")


def tag_filter(role, handle_number=2, tag_attribute="", colorize=True):
    return ('<filter name="FCD: Tag Selection">' + choice("role", role, 4) +
            parameter("Int", "handle_number", value=handle_number) + parameter("String", "tag_attribute", value=tag_attribute) +
            boolean("colorize", colorize) + "</filter>")


def read_filter(tag_file, tag_attribute="", colorize=True):
    return ('<filter name="FCD: Tags from Files">' +
            parameter("OpenFile", "tag_file", value=tag_file, exts_cardinality=1, exts_val0="*.sel") +
            parameter("String", "tag_attribute", value=tag_attribute) + boolean("colorize", colorize) + "</filter>")


def save_filter(tag_file, transform_file="", handles=0, tag_attribute="fcd_tag", translation=(0, 0, 0), rotation_axis=(0, 0, 1),
                rotation_angle=0):
    return ('<filter name="FCD: Save Tags">' + choice("handles", handles, 3) +
            parameter("String", "tag_attribute", value=tag_attribute) +
            parameter("SaveFile", "tag_file", value=tag_file, ext="*.sel") +
            parameter("SaveFile", "transform_file", value=transform_file, ext="*.def") +
            parameter("String", "transforms", value="") + point("translation", translation) +
            point("rotation_axis", rotation_axis) + parameter("Float", "rotation_angle", value=rotation_angle) +
            choice("rotation_center", 0, 3) + point("rotation_point", (0, 0, 0)) +
            parameter("Matrix44f", "TransformMatrix", **{f"val{i}": v for i, v in enumerate(np.eye(4).ravel())}) + "</filter>")


def test_tags_from_selections_saved_and_read(tmp_path):
    tag_file, transform_file = str(tmp_path / "t.sel"), str(tmp_path / "t.def")
    motion = dict(translation=(0, 0, 0.25), rotation_axis=(0, 1, 0), rotation_angle=-45)
    run = Run(tmp_path, BONE, select_filter("x &lt; 0.25"), tag_filter(0), select_filter("x &gt; 0.75"), tag_filter(2),
              select_filter("x &gt; 0.9"), tag_filter(2, handle_number=4), save_filter(tag_file, transform_file, **motion),
              read_filter(tag_file, tag_attribute="tags", colorize=False), deform_filter(**motion, graph_layers=False))
    assert run.code == 0, run.log
    bone, deformed = run.meshes["bone"], run.meshes["bonedeformed"]
    tags, x = bone.vertex_scalar_array(), bone.vertex_matrix()[:, 0]
    assert (tags == np.where(x < 0.25, 0, np.where(x > 0.9, 4, np.where(x > 0.75, 2, 1)))).all()
    assert (np.loadtxt(tag_file) == tags).all()
    assert f"fixed_vertices = {(tags == 0).sum()}" in run.log and f"handle_vertices = {(tags >= 2).sum()}" in run.log
    colors = np.rint(bone.vertex_color_matrix()[:, :3] * 255)
    assert (colors[tags == 0] == [59, 111, 201]).all() and (colors[tags == 2] == [210, 60, 50]).all()
    matrices = np.loadtxt(transform_file).reshape(-1, 4, 4)
    assert len(matrices) == 3 and (matrices[1] == np.eye(4)).all()
    for tag, m in ((2, matrices[0]), (4, matrices[2])):
        moved = transformed(m, bone.vertex_matrix()[tags == tag])
        assert np.abs(deformed.vertex_matrix()[tags == tag] - moved).max() < 1e-6

    (tmp_path / "again").mkdir()
    again = Run(tmp_path / "again", BONE, read_filter(tag_file),
                deform_filter(handles=3, tag_file=tag_file, transform_file=transform_file, graph_layers=False))
    assert again.code == 0, again.log
    assert again.meshes["bonedeformed"].vertex_matrix().tobytes() == deformed.vertex_matrix().tobytes()
    assert again.meshes["bone"].vertex_scalar_array().tobytes() == tags.tobytes()


@pytest.mark.parametrize("script, word", [
    ([tag_filter(2)], "Nothing is selected"),
    ([select_filter("x &gt; 0.5"), tag_filter(7)], "from 0 to 3"),
    ([quality_filter("x"), select_filter("x &gt; 0.5"), tag_filter(2)], "whole numbers"),
    ([select_filter("x &gt; 0.5"), tag_filter(2, handle_number=16777217)], "single precision"),
    ([read_filter("/no/such.sel")], "/no/such.sel"),
    ([quality_filter(BONE_TAGS), save_filter("/no/such/t.sel")], "Cannot write"),
    ([quality_filter(BONE_TAGS), save_filter("t.sel", handles=3)], "from 0 to 2"),
    ([quality_filter(BONE_TAGS), deform_filter(graph_weights=4)], "graph_weights is 4"),
    ([quality_filter(BONE_TAGS), deform_filter(deformed_quality=4)], "deformed_quality is 4"),
])
def test_an_error_about_tags_is_a_message(tmp_path, script, word):
    run = Run(tmp_path, BONE, *script)
    assert word in run.log
    assert "terminate called" not in run.log and run.code >= 0
    assert not list(tmp_path.glob("*.sel"))


@pytest.mark.parametrize("name", MESHES + LARGE_SCANS)
def test_every_mesh_through_every_filter(shared, name, tmp_path):
    source = tmp_path / "source"
    source.mkdir()
    ms = pymeshlab.MeshSet()  # the host's own importer stops at some of the OBJ files, hence PLY
    ms.load_new_mesh(str(unpacked(shared / "meshes" / name, source)))
    path = source / "input.ply"
    ms.save_current_mesh(str(path))
    axis = int(np.argmax(np.ptp(ms.current_mesh().vertex_matrix(), axis=0)))
    along = np.unique(ms.current_mesh().vertex_matrix()[:, axis])
    low, high = along[[len(along) // 4, -1 - len(along) // 4]] if len(along) > 4 else along[[0, -1]]
    gap = 1e-6 * np.abs(along).max()  # the host has single precision
    low, high = float(f"{low + gap:.9g}"), float(f"{high - gap:.9g}")
    letter = "xyz"[axis]
    move = np.zeros(3)
    move[(axis + 1) % 3] = 0.125 * np.ptp(along)
    tags = str(tmp_path / "tags.sel")
    run = Run(tmp_path, path, quality_filter(f"({letter} &lt;= {low}) ? 0 : (({letter} &gt;= {high}) ? 2 : 1)"),
              save_filter(tags), select_filter(f"{letter} &gt;= {high}"), tag_filter(2), read_filter(tags),
              graph_filter(patches_layer=False), deform_filter(translation=move, graph_layers=False))
    assert run.code == 0, run.log
    assert set(run.meshes) == {"input", "inputgraph", "inputdeformed"}, run.log
    rest, points = run.meshes["input"].vertex_matrix(), run.meshes["inputdeformed"].vertex_matrix()
    assert np.array_equal(np.float32(rest), np.float32(ms.current_mesh().vertex_matrix()))
    assert np.array_equal(run.meshes["input"].face_matrix(), ms.current_mesh().face_matrix())
    x = rest[:, axis]
    fixed, handle = x <= low, x >= high
    assert int(run.value("fixed_vertices")) == fixed.sum() > 0 and int(run.value("handle_vertices")) == handle.sum() > 0
    assert np.isfinite(points).all() and np.isfinite(run.meshes["inputgraph"].vertex_matrix()).all()
    assert points[fixed].tobytes() == rest[fixed].tobytes()
    assert np.abs(points[handle] - rest[handle] - move).max() < 2e-6 * np.abs(rest).max()


def test_the_plugins_of_other_hosts_are_left_out(tmp_path):
    """MeshLab 2020.09 loads what is in its folder, and checks no versions."""
    other = [path for path in sorted(PLUGINS.glob("pymeshlab-*/libfilter_fcd.so"))]
    if not other:
        pytest.skip(f"no plugin for another host in {PLUGINS}")
    server = tmp_path / "host"
    shutil.copytree(Path(SERVER).parent, server, symlinks=True)
    for path in other:
        shutil.copy(path, server / "plugins" / f"lib{path.parent.name}.so")
    run = Run(tmp_path, BONE, quality_filter(BONE_TAGS), deform_filter(translation=(0, 0, 0.25)), server=server / "meshlabserver")
    assert run.code == 0 and "bonedeformed" in run.meshes, run.log
    for path in other:
        assert re.search(f"Cannot load library .*lib{path.parent.name}.so", run.log), run.log


def test_a_decimal_comma_makes_no_difference(tmp_path):
    locales = Path(__file__).resolve().parents[1] / "build" / "locale"
    assert (locales / "de_DE.UTF-8").is_dir()
    runs = {}
    for name, environment in ("point", {}), ("comma", {"LC_ALL": "de_DE.UTF-8", "LOCPATH": str(locales)}):
        folder = tmp_path / name
        folder.mkdir()
        files = dict(tag_file=str(folder / "t.sel"), transform_file=str(folder / "t.def"))
        runs[name] = Run(folder, BONE, quality_filter(BONE_TAGS), save_filter(**files, translation=(0, 0, 0.25)),
                         deform_filter(handles=3, **files, smoothness=0.0075, graph_layers=False),
                         deform_filter(transforms="2: translate 0.125 0 0", graph_layers=False), **environment)
        assert runs[name].code == 0, runs[name].log
        assert "0.25" in (folder / "t.def").read_text()
    assert len(runs["point"].meshes) == 3
    for label, mesh in runs["point"].meshes.items():
        assert mesh.vertex_matrix().tobytes() == runs["comma"].meshes[label].vertex_matrix().tobytes()


def test_cancel_and_little_memory_leave_the_document_as_it_was():
    other = next((Path(SERVER).parent / "plugins").glob("libfilter_measure.so"))
    check_faults(PLUGINS / "meshlab-2020.09" / "libfilter_fcd.so", other.resolve().parents[1])


@pytest.mark.skipif(not shutil.which("valgrind"), reason="there is no valgrind")
def test_valgrind_finds_no_error_and_no_leak_of_the_plugin(tmp_path):
    files = dict(tag_file=str(tmp_path / "t.sel"), transform_file=str(tmp_path / "t.def"))
    valgrind = ["valgrind", "--quiet", "--trace-children=yes", "--xml=yes", f"--xml-file={tmp_path}/%p.xml", "--num-callers=100",
                "--leak-check=full", "--show-leak-kinds=definite"]
    run = Run(tmp_path, BONE, quality_filter(BONE_TAGS), graph_filter(initial_patches=60),
              save_filter(**files, translation=(0, 0, 0.25)), read_filter(files["tag_file"]),
              deform_filter(handles=3, **files, initial_patches=60), deform_filter(transforms="2: turn"), under=valgrind,
              QT_ENABLE_REGEXP_JIT="0")  # compiled regular expressions read beyond texts on purpose
    assert run.value("converged") == "true" and "transforms, character 4: expected" in run.log, run.log
    reports = [xml.etree.ElementTree.parse(path) for path in tmp_path.glob("*.xml")]
    reports = [report for report in reports if "meshlabserver.bin" in report.findtext("args/argv/exe")]
    assert len(reports) == 1 and reports[0].findall("status")[-1].findtext("state") == "FINISHED"
    # The host and its libraries have a few of their own.
    ours = [error for error in reports[0].iter("error") if any("libfilter_fcd" in (o.text or "") for o in error.iter("obj"))]
    assert not ours, "\n".join(xml.etree.ElementTree.tostring(error, "unicode") for error in ours[:3])
