# SPDX-License-Identifier: GPL-3.0-or-later
"""Pose sequences of a layer, inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
import io
import struct

import numpy as np
import pymeshlab
import pytest

from glb import Glb, png
from host_pymeshlab import COPY, DEFORM, POSE, allocated, assert_unchanged, check_returned, matrix, new_set, same_points, sheet, snapshot
from host_straighten import DIAGONAL
from straight_tube import LENGTH, tube

SEQUENCE = "generate_fcd_pose_sequence"
DEFAULTS = {
    "poses_file": "", "frames_per_second": 24, "frame_layers": 1, "gltf_file": "", "gltf_shapes": 0, "all_visible": False, "pc2_file": "", "mdd_file": "", "save_poses_file": "",
    "initial_patches": 0, "smoothness": 0.0058, "falloff": 0, "elastic": False, "rigidity": 1, "random_seed": 1, "handles": 0, "tag_attribute": "fcd_tag", "tag_file": ""}
RETURNS = {
    "fixed_vertices": int, "handle_vertices": int, "free_vertices": int, "outside_vertices": int, "poses": int, "key_frames": int,
    "frames": int, "layers": int, "largest_difference": float, "folded_triangles": int, "contact_frames": int, "contact_triangles": int, "contact_depth": float, "nodes": int, "converged": bool, "jumps": bool,
    "stable": bool, "discretisation_error": float, "seconds": float}
BENT, TWISTED = "2: rotate 0 1 0 60 translate -1 0 -2", "2: rotate 1 0 0 200"
HEAD = f'time,easing,bent,twisted\nmotions,,{BENT},{TWISTED}\n'
KEYS = "0,smooth\n0.5,linear,100\n1,,0,50\n"


def layers(matrix=None):
    """A tube along x, fixed at its beginning, with handle 2 at its end."""
    points, faces = tube()
    ms = new_set()
    tags = np.where(points[:, 0] < 0.5, 0.0, np.where(points[:, 0] > LENGTH - 0.5, 2.0, 1.0))
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=points, face_matrix=faces, v_scalar_array=tags), "tube")
    if matrix is not None:
        ms.apply_filter("set_matrix", transformmatrix=matrix, freeze=False)
    return ms


def table(folder, text, name="poses.csv"):
    (folder / name).write_text(text)
    return str(folder / name)


def deformed(matrix=None, **motion):
    ms = layers(matrix)
    ms.apply_filter(DEFORM, graph_layers=False, **motion)
    return ms.current_mesh().vertex_matrix()


def cached(path):
    """(number of the first frame, frames x points x 3) of a point cache."""
    content = path.read_bytes()
    assert content[:12] == b"POINTCACHE2\0"
    version, points, frames = np.frombuffer(content, "<i4", 7, 4)[[2, 3, 6]]
    start, rate = np.frombuffer(content, "<f4", 2, 20)
    assert (version, rate) == (1, 1)
    return start, np.frombuffer(content, "<f4", offset=32).reshape(frames, points, 3)


def mdd(path):
    """(times, frames x points x 3) of a point cache of LightWave."""
    content = path.read_bytes()
    frames, points = struct.unpack_from(">2i", content)
    times = struct.unpack_from(f">{frames}f", content, 8)
    return times, np.frombuffer(content, ">f4", offset=8 + 4 * frames).reshape(frames, points, 3)


class Gltf:
    """A file with a mesh that has morph targets, as VTK reads it."""

    def __init__(self, path):
        core = pytest.importorskip("vtkmodules.vtkIOGeometry", reason="there is no VTK beside this pymeshlab")
        from vtkmodules.util.numpy_support import vtk_to_numpy
        self._arrays = vtk_to_numpy
        self._reader = core.vtkGLTFReader()
        self._reader.SetFileName(str(path))
        self._reader.ApplyDeformationsToGeometryOn()
        self._reader.UpdateInformation()
        assert self._reader.GetNumberOfAnimations() == 1
        self._reader.EnableAnimation(0)
        self._reader.SetFrameRate(60)
        self._reader.UpdateInformation()
        self.duration = self._reader.GetAnimationDuration(0)

    def at(self, seconds):
        """(positions, faces, normals)"""
        self._reader.UpdateTimeStep(seconds)
        data = self._reader.GetOutput()
        while data.IsA("vtkMultiBlockDataSet"):
            data = data.GetBlock(0)
        faces = self._arrays(data.GetPolys().GetConnectivityArray()).reshape(-1, 3) if data.GetNumberOfPolys() else None
        normals = data.GetPointData().GetNormals()
        return (self._arrays(data.GetPoints().GetData()).astype(float), faces, None if normals is None else self._arrays(normals))


def test_what_is_done_is_logged(capfd, tmp_path):
    """After an error in any filter pymeshlab logs no more, hence this test comes first."""
    ms = layers()
    ms.set_verbosity(True)
    capfd.readouterr()
    ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS), gltf_file=str(tmp_path / "a.glb"), gltf_shapes=1, frames_per_second=4)
    log = capfd.readouterr().err
    assert "2 poses, 3 key frames, 5 frames; 3 new layers." in log and "mixed in straight lines, are off from the frames by up to" in log
    assert " flipped:" not in log
    points, faces = sheet(60, 1 / 59)  # flat, and pushed together
    tags = np.where(points[:, 0] < 0.1, 0.0, np.where(points[:, 0] > 0.9, 2.0, 1.0))
    ms = new_set()
    ms.add_mesh(pymeshlab.Mesh(points * [1, 1, 0], faces, v_scalar_array=tags), "sheet")
    ms.set_verbosity(True)
    folding = table(tmp_path, "time,easing,folded\nmotions,,2: translate -0.72 0 0\n0,,0\n1,,100\n")
    result, log = ms.apply_filter(SEQUENCE, poses_file=folding), capfd.readouterr().err
    assert f"In a frame, {result['folded_triangles']} triangles are flipped" in log and "1 pose, 2 key frames, 2 frames" in log


def test_parameters_names_order_and_defaults():
    assert SEQUENCE in pymeshlab.filter_list()
    values = layers().filter_parameter_values(SEQUENCE)
    assert list(values) == list(DEFAULTS)
    for key, value in DEFAULTS.items():
        assert values[key] == value if isinstance(value, str) else np.allclose(values[key], value, rtol=1e-6, atol=0), key


@pytest.mark.parametrize("matrix", [None, np.array([[0, -2, 0, 7.0], [2, 0, 0, -5.0], [0, 0, 2, 3.0], [0, 0, 0, 1.0]])])
def test_key_frames_are_layers(tmp_path, matrix):
    """The first after rest is to the bit what the deformation is."""
    ms = layers(matrix)
    before = snapshot(ms.mesh(0))
    result = ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS))
    check_returned(result, RETURNS)
    assert (result["poses"], result["key_frames"], result["frames"], result["layers"]) == (2, 3, 3, 3) and result["converged"]
    assert [mesh.label() for mesh in ms] == ["tube", "tube key frame 0", "tube key frame 1", "tube key frame 2"]
    assert ms.current_mesh().label() == "tube key frame 2"
    assert_unchanged(before, ms.mesh(0))
    assert same_points(ms.mesh(1).vertex_matrix(), ms.mesh(0).vertex_matrix())
    assert same_points(ms.mesh(1).vertex_scalar_array(), ms.mesh(0).vertex_scalar_array())
    assert same_points(ms.mesh(2).vertex_matrix(), deformed(matrix, transforms=BENT))
    straight = deformed(matrix, transforms=TWISTED, pose=50)
    assert np.abs(ms.mesh(3).vertex_matrix() - straight).max() < 5e-4 * DIAGONAL  # it came there from the pose before


def test_a_blend_turns_and_moves_the_handle(tmp_path):
    ms = layers()
    ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, "time,easing,up,turned\nmotions,,2: translate 0 0 3,2: rotate 1 0 0 300\n0,,50,100\n"))
    points, tags = ms.current_mesh().vertex_matrix(), ms.mesh(0).vertex_scalar_array()
    rest, turn = ms.mesh(0).vertex_matrix()[tags == 2], np.radians(300)
    middle = rest.mean(0)
    turned = (rest - middle) @ np.array([[1, 0, 0], [0, np.cos(turn), np.sin(turn)], [0, -np.sin(turn), np.cos(turn)]])
    assert np.abs(points[tags == 2] - turned - middle - [0, 0, 1.5]).max() < 1e-9 * DIAGONAL
    assert same_points(points[tags == 0], ms.mesh(0).vertex_matrix()[tags == 0])
    half = np.abs(ms.mesh(0).vertex_matrix()[:, 0] - LENGTH / 2) < 1e-9  # a turn of 300 degrees is followed half by half
    y, z = (points - points[half].mean(0))[half][:, 1:].T, (ms.mesh(0).vertex_matrix()[half][:, 1:]).T
    angle = np.angle((y[0] + 1j * y[1]) @ (z[0] - 1j * z[1]))
    assert np.degrees(angle) % 360 == pytest.approx(150, abs=5)


def test_frames_are_layers_and_a_point_cache(tmp_path):
    ms = layers()
    ms.apply_filter("meshing_remove_selected_vertices")  # none; the slots stay
    result = ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS.replace("0,smooth", "0.25,smooth", 1)), frame_layers=2,
                             frames_per_second=8, pc2_file=str(tmp_path / "a.pc2"), mdd_file=str(tmp_path / "a.mdd"))
    start, frames = cached(tmp_path / "a.pc2")
    assert (start, len(frames), result["frames"], result["layers"]) == (2, 7, 7, 7)
    assert ms.mesh(3).label() == "tube frame 2"
    for i, frame in enumerate(frames):
        assert np.abs(ms.mesh(i + 1).vertex_matrix() - frame).max() < 1e-6 * DIAGONAL, i
    apart = np.linalg.norm(np.diff(frames, axis=0), axis=2).max(1)
    assert 0 < apart[0] < 3 and (apart < 4).all()  # smooth: no frame jumps
    times, same = mdd(tmp_path / "a.mdd")
    assert times == tuple(0.25 + i / 8 for i in range(7)) and (same == frames).all()


def test_an_animation_as_another_program_reads_it(tmp_path):
    """Each frame, within 1e-6 of the diagonal; its normals are those of its faces."""
    placed = np.array([[0, -2, 0, 7.0], [2, 0, 0, -5.0], [0, 0, 2, 3.0], [0, 0, 0, 1.0]])
    ms = layers(placed)
    result = ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS), frame_layers=2, frames_per_second=8,
                             gltf_file=str(tmp_path / "frames.glb"))
    file = Gltf(tmp_path / "frames.glb")
    assert file.duration == 1 and result["frames"] == 9 and result["largest_difference"] == 0
    for i in (0, 3, 4, 8):
        points, faces, normals = file.at(i / 8)
        expected = ms.mesh(i + 1).vertex_matrix() @ placed[:3, :3].T + placed[:3, 3]
        assert np.abs(points - expected).max() < 1e-6 * 2 * DIAGONAL and (faces == ms.mesh(0).face_matrix()).all()
        turned = ms.mesh(i + 1).vertex_normal_matrix() @ placed[:3, :3].T
        turned /= np.linalg.norm(turned, axis=1)[:, None]
        normals = normals / np.linalg.norm(normals, axis=1)[:, None]
        assert np.degrees(np.arccos(np.clip((normals * turned).sum(1), -1, 1))).max() < 1
    between = (ms.mesh(4).vertex_matrix() + ms.mesh(5).vertex_matrix()) / 2 @ placed[:3, :3].T + placed[:3, 3]
    assert np.abs(file.at(3.5 / 8)[0] - between).max() < 1e-5 * DIAGONAL


def test_shapes_of_poses_are_mixed(tmp_path):
    ms = layers()
    result = ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS), frame_layers=2, frames_per_second=8, gltf_shapes=1,
                             gltf_file=str(tmp_path / "poses.glb"))
    file = Gltf(tmp_path / "poses.glb")
    bent, twisted, rest = deformed(transforms=BENT), deformed(transforms=TWISTED), ms.mesh(0).vertex_matrix()
    assert np.abs(file.at(0.5)[0] - bent).max() < 1e-6 * DIAGONAL
    assert np.abs(file.at(0.75)[0] - rest - (bent - rest) / 2 - (twisted - rest) / 4).max() < 1e-6 * DIAGONAL
    off = max(np.linalg.norm(file.at(i / 8)[0] - ms.mesh(i + 1).vertex_matrix(), axis=1).max() for i in range(9))
    assert result["largest_difference"] == pytest.approx(off, rel=1e-3) and off > 0.01


def textured(folder, textures=("skin.png", "sub/other.png"), colors=None):
    """The tube as a .obj file with seams, each half with a texture; the set with it, tagged, and the texture coordinates of its corners."""
    points, faces = tube()
    places = points[faces][:, :, :2] * [0.09, 0.7]
    half = points[faces].mean(1)[:, 2] > 0
    places[half] += [0, 0.25]
    color = np.full((len(points), 3), "", object) if colors is None else colors
    lines = ["mtllib a.mtl"] + ["v " + " ".join(map(str, [*p, *c])) for p, c in zip(points, color)] + [f"vt {u} {v}" for u, v in places.reshape(-1, 2)]
    for number, rows in enumerate((np.flatnonzero(~half), np.flatnonzero(half))):
        lines += [f"usemtl m{number}"] + ["f " + " ".join(f"{1 + faces[f, k]}/{3 * f + k + 1}" for k in range(3)) for f in rows]
    (folder / "sub").mkdir(exist_ok=True)
    (folder / "a.obj").write_text("\n".join(lines) + "\n")
    (folder / "a.mtl").write_text("".join(f"newmtl m{i}\nKd 1 1 1\nmap_Kd {name}\n" for i, name in enumerate(textures)))
    ms = new_set()
    ms.load_new_mesh(str(folder / "a.obj"))
    ms.compute_scalar_by_function_per_vertex(q=f"x < 0.5 ? 0 : (x > {LENGTH - 0.5} ? 2 : 1)")
    order = np.concatenate([np.flatnonzero(~half), np.flatnonzero(half)])
    return ms, faces[order], places[order], half[order].astype(int)


def test_a_textured_layer(tmp_path):
    """Two textures, as they are in their files, with seams: each corner has its place in each frame."""
    (tmp_path / "skin.png").write_bytes(png(200, 100, 50))
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "other.png").write_bytes(png(1, 2, 3))
    ms, faces, places, half = textured(tmp_path)
    result = ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS), frame_layers=2, frames_per_second=4, gltf_file=str(tmp_path / "a.glb"))
    assert (ms.mesh(0).face_matrix() == faces).all() and np.abs(ms.mesh(0).wedge_tex_coord_matrix().reshape(-1, 3, 2) - places).max() < 1e-6
    file = Glb(tmp_path / "a.glb")
    assert [file.image(i) for i in range(2)] == [(png(200, 100, 50), "image/png"), (png(1, 2, 3), "image/png")]
    assert [each["name"] for each in file.json["images"]] == ["skin.png", "other.png"]
    primitives, move = file.json["meshes"][0]["primitives"], file.json["nodes"][0]["translation"]
    assert [file.texture_of(each) for each in primitives] == [0, 1] and result["frames"] == 5
    for number, primitive in enumerate(primitives):
        assert list(primitive["attributes"]) == ["POSITION", "NORMAL", "TEXCOORD_0"]
        indices = file.array(primitive["indices"])
        at = file.array(primitive["attributes"]["TEXCOORD_0"])[indices].reshape(-1, 3, 2)
        assert np.abs(at * [1, -1] + [0, 1] - places[half == number]).max() < 1e-6
        for i, target in enumerate(primitive["targets"]):
            points = file.array(primitive["attributes"]["POSITION"]).astype(float) + file.array(target["POSITION"]) + move
            assert np.abs(points[indices] - ms.mesh(i + 1).vertex_matrix()[faces[half == number].ravel()]).max() < 1e-5
    vtk, posed, _ = Gltf(tmp_path / "a.glb").at(0.5)  # reads the first primitive
    assert np.abs(vtk[posed].reshape(-1, 3) - ms.mesh(3).vertex_matrix()[faces[half == 0]].reshape(-1, 3)).max() < 1e-5


def test_textures_that_are_no_png_and_those_that_are_not_there(tmp_path, capfd):
    """What MeshLab reads becomes a PNG with the same pixels; of what is not there the log tells, and its faces have the colours."""
    image = pytest.importorskip("PIL.Image", reason="there is no Pillow beside this pymeshlab")
    pixels = np.random.default_rng(1).integers(0, 256, (5, 7, 3)).astype(np.uint8)
    image.fromarray(pixels).save(tmp_path / "skin.bmp")
    colors = np.random.default_rng(2).integers(0, 256, (len(tube()[0]), 3)) / 255
    ms, faces, _, half = textured(tmp_path, ("skin.bmp", "gone.png"), colors)
    ms.set_verbosity(True)
    capfd.readouterr()
    ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS), frame_layers=0, frames_per_second=2, gltf_file=str(tmp_path / "a.glb"))
    assert "cannot be read, so the .glb file is without it. Put it beside the layer's file, as PNG" in capfd.readouterr().err
    file = Glb(tmp_path / "a.glb")
    first, second = file.json["meshes"][0]["primitives"]
    content, kind = file.image(file.texture_of(first))
    assert kind == "image/png" and (np.array(image.open(io.BytesIO(content)).convert("RGB")) == pixels).all()
    assert file.texture_of(second) is None and len(file.json["images"]) == 1
    assert "COLOR_0" not in first["attributes"] and "COLOR_0" in second["attributes"]
    light = file.array(second["attributes"]["COLOR_0"])[file.array(second["indices"])][:, :3] / 65535
    c = np.rint(colors[faces[half == 1].ravel()] * 255) / 255
    assert np.abs(light - np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)).max() < 0.01  # as MeshLab reads them, one of 255 off


def test_a_texture_that_a_filter_has_painted(tmp_path):
    """What the layer holds is what is seen, whatever its file has."""
    image = pytest.importorskip("PIL.Image", reason="there is no Pillow beside this pymeshlab")
    for name, color in (("skin.png", (1, 2, 3)), ("sub/other.png", (9, 9, 9))):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(png(*color))
    ms, *_ = textured(tmp_path)
    (tmp_path / "skin.png").write_bytes(png(7, 7, 7))  # of later
    ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS), frame_layers=0, frames_per_second=2, gltf_file=str(tmp_path / "a.glb"))
    contents = [Glb(tmp_path / "a.glb").image(i)[0] for i in range(2)]
    assert [image.open(io.BytesIO(each)).convert("RGB").getpixel((0, 0)) for each in contents] == [(1, 2, 3), (9, 9, 9)]
    assert contents[1] == png(9, 9, 9)  # untouched: a copy


@pytest.mark.parametrize("what", ["vertices", "faces", "tagged", "none"])
def test_colours_of_a_layer(tmp_path, what):
    """Its own ones, not those of tags."""
    points, faces = tube()
    tags = np.where(points[:, 0] < 0.5, 0.0, np.where(points[:, 0] > LENGTH - 0.5, 2.0, 1.0))
    ms = new_set()
    random = np.random.default_rng(3)
    colors = np.column_stack([random.integers(0, 2, (len(faces if what == "faces" else points), 3)), np.ones(len(faces if what == "faces" else points))])
    given = {} if what == "none" else {"f_color_matrix": colors} if what == "faces" else {"v_color_matrix": colors}
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=tags, **given), "tube")
    if what == "tagged":
        for end, role in (("x < 0.5", 0), (f"x > {LENGTH - 0.5}", 2)):
            ms.compute_selection_by_condition_per_vertex(condselect=end)
            ms.apply_filter("compute_fcd_tags_from_selection", role=role)
        assert np.abs(ms.current_mesh().vertex_color_matrix() - colors).max() > 0.01
    ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS), frame_layers=0, frames_per_second=2, gltf_file=str(tmp_path / "a.glb"))
    file = Glb(tmp_path / "a.glb")
    primitive, = file.json["meshes"][0]["primitives"]
    if what == "none":
        assert "COLOR_0" not in primitive["attributes"]
        return
    light = file.array(primitive["attributes"]["COLOR_0"])[file.array(primitive["indices"])].reshape(-1, 3, 4)
    assert (light == 65535 * (colors[:, None] if what == "faces" else colors[faces])).all()


def test_visible_layers_go_along(tmp_path):
    """An eye with a matrix of its own, a cloud, and a copy: each where 'FCD: Apply Deformation to Layer' takes it."""
    placed = np.array([[0, -2, 0, 7.0], [2, 0, 0, -5.0], [0, 0, 2, 3.0], [0, 0, 0, 1.0]])
    ms = layers(placed)
    points, faces = ms.mesh(0).vertex_matrix(), ms.mesh(0).face_matrix()
    ms.apply_filter(DEFORM, graph_layers=True, transforms=BENT)  # its graphs and result are there, too
    source, rest, deformed_graph = 0, *[mesh.id() for mesh in ms if "graph" in mesh.label()]
    ms.create_sphere(radius=0.4, subdiv=2)
    ms.apply_filter("set_matrix", transformmatrix=placed @ np.array([[1, 0, 0, 9], [0, 1, 0, 0.5], [0, 0, 1, 1], [0, 0, 0, 1.0]]), freeze=False)
    eye = ms.current_mesh_id()
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=(points * 1.1) @ placed[:3, :3].T + placed[:3, 3]), "cloud")
    cloud = ms.current_mesh_id()
    ms.add_mesh(pymeshlab.Mesh(points[::-1].copy(), len(points) - 1 - faces), "copy")
    ms.apply_filter("set_matrix", transformmatrix=placed, freeze=False)
    copy = ms.current_mesh_id()
    for mesh in list(ms):
        ms.set_current_mesh(mesh.id())
        ms.set_current_mesh_visibility("deformed" not in mesh.label() or "graph" in mesh.label())
    ms.set_current_mesh(0)
    before = [snapshot(ms.mesh(i)) for i in (eye, cloud, copy)]
    result = ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS), frame_layers=1, frames_per_second=2, gltf_file=str(tmp_path / "a.glb"), all_visible=True)
    check_returned(result, RETURNS)
    file = Glb(tmp_path / "a.glb")
    assert [node["name"] for node in file.json["nodes"]] == ["tube"] + [ms.mesh(i).label() for i in (eye, cloud, copy)]
    for number, (layer, was) in enumerate(zip((eye, cloud, copy), before), 1):
        assert_unchanged(was, ms.mesh(layer))
        ms.set_current_mesh(layer)
        ms.apply_filter(COPY, source_layer=source, rest_graph=rest, deformed_graph=deformed_graph)
        its = matrix(ms.current_mesh())
        expected = ms.current_mesh().vertex_matrix() @ its[:3, :3].T + its[:3, 3]
        primitive, = file.json["meshes"][number]["primitives"]
        points = (file.array(primitive["attributes"]["POSITION"]).astype(float) + file.array(primitive["targets"][1]["POSITION"])
                  + file.json["nodes"][number]["translation"])
        assert np.abs(points - expected).max() < 1e-5 * DIAGONAL and ("mode" in primitive) == (layer == cloud), number
        assert np.abs(points - file.array(primitive["attributes"]["POSITION"]) - file.json["nodes"][number]["translation"]).max() > 1
    with pytest.raises(pymeshlab.PyMeshLabException, match="No other layer is visible. Show the layers that should go along"):
        layers().apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS), gltf_file=str(tmp_path / "b.glb"), all_visible=True)
    assert not (tmp_path / "b.glb").exists()


def test_a_cloud(tmp_path):
    points, _ = tube()
    ms = new_set()
    tags = np.where(points[:, 0] < 0.5, 0.0, np.where(points[:, 0] > LENGTH - 0.5, 2.0, 1.0))
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=points, v_scalar_array=tags), "cloud")
    ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS), gltf_file=str(tmp_path / "cloud.glb"), frames_per_second=2)
    read, faces, normals = Gltf(tmp_path / "cloud.glb").at(0.5)
    assert faces is None and normals is None and np.abs(read - ms.mesh(2).vertex_matrix()).max() < 1e-6 * DIAGONAL


def test_the_table_is_saved_with_its_surface(tmp_path):
    ms = layers()
    saved = tmp_path / "saved.csv"
    ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD), frame_layers=0, save_poses_file=str(saved))
    assert len(list(ms)) == 1 and ms.current_mesh_id() == 0
    rows = saved.read_text().splitlines()
    assert rows[0] == "time,easing,bent,twisted" and rows[1].startswith('surface,,2424 vertices from 0 -0.6') and rows[2] == HEAD.split("\n")[1]
    assert rows[3:] == ["0,smooth,0,0", "1,smooth,100,0", "2,smooth,0,100"]
    ms.apply_filter(SEQUENCE, poses_file=str(saved), save_poses_file=str(saved))
    assert saved.read_text().splitlines() == rows and same_points(ms.mesh(2).vertex_matrix(), deformed(transforms=BENT))
    other = layers(np.diag([2.0, 2, 2, 1]))
    with pytest.raises(pymeshlab.PyMeshLabException, match="saved.csv': The poses are of another surface"):
        other.apply_filter(SEQUENCE, poses_file=str(saved))
    assert len(list(other)) == 1


def test_a_layer_keeps_its_poses(tmp_path):
    ms = layers()
    first = table(tmp_path, HEAD + KEYS)
    ms.apply_filter(SEQUENCE, poses_file=first)
    ms.set_current_mesh(0)
    result = ms.apply_filter(SEQUENCE, frame_layers=0, save_poses_file=str(tmp_path / "kept.csv"))
    assert (result["poses"], result["layers"]) == (2, 0) and (tmp_path / "kept.csv").read_text().startswith("time,easing,bent,twisted\nsurface")
    ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, "time,easing,other\nmotions,,2: scale 2\n", "b.csv"), frame_layers=0,
                    save_poses_file=str(tmp_path / "kept.csv"))
    with pytest.raises(pymeshlab.PyMeshLabException):
        ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, "time,easing,x\nmotions,,9: scale 2\n", "c.csv"))
    assert ms.apply_filter(SEQUENCE)["poses"] == 1  # those of the last time that went well
    ms.set_current_mesh(0)
    ms.apply_filter("set_matrix", transformmatrix=np.diag([2.0, 2, 2, 1]), freeze=False)
    with pytest.raises(pymeshlab.PyMeshLabException, match="'tube': The poses are of another surface, or of this one at another place.*"
                       "Bring it back to where it was .'FCD: Reset Pose' brings a shape back., or give poses for it as 'poses_file'"):
        ms.apply_filter(SEQUENCE)
    with pytest.raises(pymeshlab.PyMeshLabException, match="kept.csv': The poses are of another surface.*delete the row 'surface'"):
        ms.apply_filter(SEQUENCE, poses_file=str(tmp_path / "kept.csv"))
    for leaves in ("generate_copy_of_current_mesh", "save"):
        other = layers()
        other.apply_filter(SEQUENCE, poses_file=first)
        other.set_current_mesh(0)
        if leaves == "save":
            other.save_current_mesh(str(tmp_path / "tube.ply"))
            other.load_new_mesh(str(tmp_path / "tube.ply"))
        else:
            other.apply_filter(leaves)
        with pytest.raises(pymeshlab.PyMeshLabException, match="keeps no poses.*Load its session"):
            other.apply_filter(SEQUENCE)


@pytest.mark.parametrize("cloud", [False, True])
def test_poses_of_the_rest_shape_pose_that_while_the_layer_is_posed(tmp_path, cloud):
    ms = layers()
    if cloud:
        mesh = ms.current_mesh()
        ms.add_mesh(pymeshlab.Mesh(vertex_matrix=mesh.vertex_matrix(), v_normals_matrix=mesh.vertex_normal_matrix(), v_scalar_array=mesh.vertex_scalar_array()), "cloud")
    layer, others = ms.current_mesh_id(), len(list(ms))
    first = ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD + KEYS), save_poses_file=str(tmp_path / "kept.csv"))
    expected = [(m.vertex_matrix(), m.vertex_normal_matrix()) for m in list(ms)[others:]]
    ms.set_current_mesh(layer)
    ms.apply_filter(POSE, transforms="2: rotate 0 1 0 30 translate 0 0.2 0")
    before = snapshot(ms.current_mesh())
    for file in "", str(tmp_path / "kept.csv"):
        ms.set_current_mesh(layer)
        result = ms.apply_filter(SEQUENCE, poses_file=file)
        assert result["nodes"] == first["nodes"]
        for (points, normals), mesh in zip(expected, list(ms)[-len(expected):]):
            assert same_points(mesh.vertex_matrix(), points) and same_points(mesh.vertex_normal_matrix(), normals)
        assert_unchanged(before, ms.mesh(layer))
    ms.set_current_mesh(layer)
    ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, HEAD))  # of whatever shape the layer has
    assert not same_points(list(ms)[-2].vertex_matrix(), expected[1][0])
    ms.set_current_mesh(layer)
    ms.compute_coord_by_function(x="x + (vi == 7 ? 0.5 : 0)")
    with pytest.raises(pymeshlab.PyMeshLabException, match="was changed since its last pose: .* were moved .* The poses are of the shape before. To go back to it, run 'FCD: Reset Pose'"):
        ms.apply_filter(SEQUENCE, poses_file=str(tmp_path / "kept.csv"))


ERRORS = {
    "no file": ({}, None, "The layer 'tube' keeps no poses: .* or give the .csv file with the poses as 'poses_file'"),
    "missing": ({"poses_file": "/nowhere/poses.csv"}, None, "Cannot open '/nowhere/poses.csv'"),
    "no table": ({}, "1 2 3\n", "poses.csv', line 1: expected a first row 'time, easing'"),
    "nothing": ({"frame_layers": 0}, HEAD, "There is nothing to make: choose 'frame_layers'"),
    "rate": ({"frames_per_second": 0}, HEAD, "frames_per_second must be a positive number"),
    "same file": ({"gltf_file": "{}/a", "pc2_file": "{}/a"}, HEAD, "are the same file"),
    "same caches": ({"pc2_file": "{}/a", "mdd_file": "{}/a"}, HEAD, "are the same file"),
    "unknown handle": ({}, "time,easing,odd\nmotions,,5: scale 2\n", "Pose 'odd': transforms moves handle 5, but no vertex has tag 5"),
    "motion": ({}, "time,easing,odd\nmotions,,2: jump 1\n", "Pose 'odd': transforms, character 4: expected"),
    "mirrors": ({}, "time,easing,odd\nmotions,,2: matrix -1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n", "Pose 'odd': transforms, handle 2: A transform mirrors"),
    "twice": ({}, "time,easing,a,a\nmotions,,2: scale 2\n", "Two poses are called 'a'"),
    "times": ({}, HEAD + "1\n0\n", "Their times must ascend"),
    "easing": ({}, HEAD + "1,soft\n", "expected linear, smooth or hold, found 'soft'"),
    "folder": ({"pc2_file": "{}/none/a.pc2", "gltf_file": "{}/a.glb"}, HEAD, "Cannot write '.*a.pc2'"),
    "too many": ({"frames_per_second": 1e9}, HEAD + KEYS, "more than a million frames"),
}


@pytest.mark.parametrize("name", ERRORS)
def test_errors_change_nothing(tmp_path, name):
    parameters, text, message = ERRORS[name]
    parameters = {key: value.replace("{}", str(tmp_path)) if isinstance(value, str) else value for key, value in parameters.items()}
    if text is not None:
        parameters["poses_file"] = table(tmp_path, text)
    ms = layers()
    before, files = snapshot(ms.mesh(0)), sorted(tmp_path.iterdir())
    with pytest.raises(pymeshlab.PyMeshLabException, match=message):
        ms.apply_filter(SEQUENCE, **parameters)
    assert len(list(ms)) == 1 and ms.current_mesh_id() == 0 and sorted(tmp_path.iterdir()) == files
    assert_unchanged(before, ms.mesh(0))


def test_files_that_were_there_stay_after_an_error(tmp_path):
    """Also where the frames are being written: a motion too far."""
    (tmp_path / "a.pc2").write_bytes(b"before")
    ms = layers()
    far = table(tmp_path, "time,easing,far\nmotions,,2: translate 1e35 0 0\n0,\n1,,100\n")
    with pytest.raises(pymeshlab.PyMeshLabException, match="Handle 2"):
        ms.apply_filter(SEQUENCE, poses_file=far, pc2_file=str(tmp_path / "a.pc2"), frames_per_second=2)
    assert (tmp_path / "a.pc2").read_bytes() == b"before" and len(list(ms)) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.pc2", "poses.csv"]


def test_a_layer_keeps_one_table_of_poses(tmp_path):
    """What was kept before the last one is freed."""
    ms = layers()
    keys = "".join(f"{k / 1000},linear,{k % 100}.125\n" for k in range(200000)) # 4 MB
    size = []
    for i in range(14):
        ms.apply_filter(SEQUENCE, poses_file=table(tmp_path, f"time,easing,bent\nmotions,,2: rotate 0 1 0 {i + 1}\n" + keys), frame_layers=0,
                        save_poses_file=str(tmp_path / "written.csv"))
        size.append(allocated())
    assert size[-1] < size[2] + 7e6, size # not so much more each time
