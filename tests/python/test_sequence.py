# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses with names, and animations of them."""
import errno
import os
import shutil
import struct
import warnings
from pathlib import Path

import numpy as np
import pytest

import pymeshlab_fcd
from pymeshlab_fcd import AnimationInfo, Companion, Deformer, DeformationWarning, KeyFrame, Look, Motion, PoseSequence
from glb import JPEG, Glb, assert_valid, png
from shapes import bar, same, with_filters

TURN = Motion.rotate([0, 1, 0], -60).then(Motion.translate([-2, 0, 3]))
TWIST = Motion.rotate([1, 0, 0], 220)


SURFACE = bar()[:3]
MOVES = SURFACE[2] == 2


def prepared(**more):
    return Deformer(*SURFACE, **more)


def sequence():
    return PoseSequence({"bent": {2: TURN}, "twisted": {2: TWIST}},
                        [KeyFrame(0), KeyFrame(0.5, {"bent": 100}, "smooth"), KeyFrame(1, {"twisted": 50})])


def test_a_table_and_back(tmp_path):
    made = sequence()
    assert made.poses == {"bent": "2: " + TURN.text, "twisted": "2: " + TWIST.text}
    assert made.keys[1] == KeyFrame(0.5, {"bent": 100, "twisted": 0}, "smooth")
    made.save(tmp_path / "poses.csv")
    read = PoseSequence.load(tmp_path / "poses.csv")
    assert read.text() == made.text() and read.keys == made.keys and read.poses == made.poses
    assert read.weights_at(0.75) == {"bent": 50, "twisted": 25} and read.weights_at(9) == {"bent": 0, "twisted": 50}
    assert PoseSequence({"a": "2: scale 2", "b": {}}).keys == [
        KeyFrame(0, {"a": 0, "b": 0}, "smooth"), KeyFrame(1, {"a": 100, "b": 0}, "smooth"), KeyFrame(2, {"a": 0, "b": 100}, "smooth")]
    assert "bent, twisted, 3 key frames" in repr(made)


def test_a_blend_of_one_pose_is_that_pose():
    deformer, made = prepared(), sequence()
    assert same(made.blend(deformer, {"bent": 100}).vertices, deformer.pose({2: TURN}).vertices)
    assert same(made.blend(deformer, {"twisted": 30}).vertices, deformer.pose({2: TWIST}, percent=30).vertices)
    assert same(made.blend(deformer, {}).vertices, deformer.vertices)
    both = made.blend(deformer, {"bent": 50, "twisted": 50})
    half = deformer.pose({2: TURN}, percent=50)
    assert np.abs(both.vertices[MOVES].mean(0) - half.vertices[MOVES].mean(0)).max() < 1e-9  # the twist leaves the middle where it is
    assert both.info.converged and both.info.folded == 0 and len(both.normals) == len(deformer.vertices)


def test_between_turns_about_a_joint_a_handle_stays_on_its_arc():
    deformer, middle, turn = prepared(), SURFACE[0][MOVES].mean(0), Motion.rotate
    joint = middle - [5, 0, 0]
    made = PoseSequence({"down": {2: turn([0, 1, 0], 40, about=joint)}, "up": {2: turn([0, 1, 0], -80, about=joint)},
                         "aside": {2: turn([0, 0, 1], 70, about=joint)}},
                        [KeyFrame(0, {"down": 100}), KeyFrame(1, {"up": 100}), KeyFrame(2, {"up": 50, "aside": 50})])
    for seconds, pose in made.frames(deformer, rate=4):
        way = pose.vertices[MOVES].mean(0) - joint
        assert abs(np.linalg.norm(way) - 5) < 1e-9
        if seconds <= 1:
            angle = np.radians(40 - 120 * seconds)
            assert np.abs(way - [5 * np.cos(angle), 0, -5 * np.sin(angle)]).max() < 1e-9


def test_frames_and_files_are_the_same(tmp_path):
    deformer, made = prepared(), sequence()
    frames = list(made.frames(deformer, rate=8))
    assert [time for time, _ in frames] == [i / 8 for i in range(9)]
    assert same(frames[0][1].vertices, deformer.vertices)
    assert same(frames[0][1].vertices, next(made.frames(deformer))[1].vertices)
    told = []
    info = made.write(deformer, gltf=tmp_path / "a.glb", pc2=tmp_path / "a.pc2", mdd=tmp_path / "a.mdd", rate=8, progress=lambda percent, stage: told.append(percent))
    assert info == AnimationInfo(9, 0.0, True, False, 0, (), info.discretisation_error) and 0 < info.discretisation_error < 0.01 and told == sorted(told) and told[-1] == 100
    points = np.frombuffer((tmp_path / "a.pc2").read_bytes(), "<f4", offset=32).reshape(9, -1, 3)
    assert all((points[i] == pose.vertices.astype(np.float32)).all() for i, (_, pose) in enumerate(frames))
    content = (tmp_path / "a.mdd").read_bytes()
    assert struct.unpack_from(">2i9f", content) == (9, points.shape[1], *(i / 8 for i in range(9)))
    assert (np.frombuffer(content, ">f4", offset=8 + 9 * 4).reshape(points.shape) == points).all()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.glb", "a.mdd", "a.pc2"]
    again = prepared(threads=1)
    made.write(again, gltf=tmp_path / "b.glb", rate=8)
    assert (tmp_path / "b.glb").read_bytes() == (tmp_path / "a.glb").read_bytes()


def contents(folder):
    return {path.name: os.readlink(path) if path.is_symlink() else path.read_bytes() for path in folder.iterdir() if not path.is_dir()}


@pytest.mark.parametrize("there", [("a.glb", "a.pc2"), ("a.glb",), ("a.pc2",), ()])
@pytest.mark.parametrize("ending", [".glb", ".pc2"])
@pytest.mark.parametrize("step", ["fsync", "copymode", "replace", "replace without links", "interrupt"])
def test_both_files_are_written_or_none(tmp_path, monkeypatch, there, ending, step):
    """Whichever of them fails, and at whatever step: each is as it was, and nothing is left beside them."""
    for name in there:
        (tmp_path / name).write_bytes(b"old " + name.encode())
    before, path = contents(tmp_path), tmp_path / f"a{ending}"

    def refuse(real, of, kind=OSError(errno.ENOSPC, "No space left on device")):
        def call(*given):
            if of(*given).startswith(str(path)) and not of(*given).endswith(".kept"):
                raise kind
            return real(*given)
        return call

    if step == "fsync":
        files = {}
        monkeypatch.setattr("builtins.open", lambda name, mode, real=open: files.setdefault(name, real(name, mode)))
        monkeypatch.setattr(os, "fsync", refuse(os.fsync, lambda number: next(n for n, file in files.items() if not file.closed
                                                                                and file.fileno() == number)))
    elif step == "copymode":
        if path.name not in there:
            pytest.skip("only of what is there")
        monkeypatch.setattr("shutil.copymode", refuse(shutil.copymode, lambda source, to: source))
    else:
        kind = KeyboardInterrupt() if step == "interrupt" else OSError(errno.EBUSY, "Device or resource busy")
        monkeypatch.setattr(os, "replace", refuse(os.replace, lambda source, to: to if source.endswith(".part") else "", kind))
        if step == "replace without links":
            monkeypatch.setattr(os, "link", refuse(os.link, lambda source, to: str(path), OSError(errno.EPERM, "Operation not permitted")))
    with pytest.raises(KeyboardInterrupt if step == "interrupt" else OSError) as caught:
        sequence().write(prepared(), gltf=tmp_path / "a.glb", pc2=tmp_path / "a.pc2", rate=2)
    monkeypatch.undo()
    assert contents(tmp_path) == before and (step == "interrupt" or caught.value.filename == str(path))


def test_files_are_replaced_together(tmp_path):
    for name in ("a.glb", "a.pc2"):
        (tmp_path / name).write_bytes(b"old")
        (tmp_path / name).chmod(0o640)
    with pytest.raises(FileNotFoundError, match="none/a.pc2'"):
        sequence().write(prepared(), gltf=tmp_path / "a.glb", pc2=tmp_path / "none" / "a.pc2", rate=2)
    assert contents(tmp_path) == {"a.glb": b"old", "a.pc2": b"old"}
    sequence().write(prepared(), gltf=tmp_path / "a.glb", pc2=tmp_path / "a.pc2", rate=2)
    written = contents(tmp_path)
    assert sorted(written) == ["a.glb", "a.pc2"] and written["a.glb"][:4] == b"glTF" and written["a.pc2"][:6] == b"POINTC"
    assert all((tmp_path / name).stat().st_mode & 0o777 == 0o640 for name in written)


@pytest.mark.parametrize("way", ["same", "relative", "link", "link to nothing", "linked folder", "folder and back", "hard link", "case"])
def test_one_file_is_not_written_twice(tmp_path, monkeypatch, way):
    first, second = tmp_path / "a.glb", tmp_path / "b.pc2"
    (tmp_path / "folder").mkdir()
    if way not in ("link to nothing", "case", "relative"):
        first.write_bytes(b"old")
    if way == "same":
        second = first
    elif way == "relative":
        monkeypatch.chdir(tmp_path / "folder")
        second = Path("..") / "folder" / ".." / "a.glb"
    elif way in ("link", "link to nothing"):
        second.symlink_to("a.glb")
    elif way == "linked folder":
        (tmp_path / "again").symlink_to(tmp_path / "folder")
        first, second = tmp_path / "folder" / "new", tmp_path / "again" / "new"
    elif way == "folder and back":
        second = tmp_path / "folder" / ".." / "a.glb"
    elif way == "hard link":
        os.link(first, second)
    else:
        first, second = tmp_path / "Á.bin", tmp_path / "a\u0301.BIN"
    before = contents(tmp_path)
    for kinds in (("gltf", "pc2"), ("gltf", "mdd"), ("pc2", "mdd")):
        with pytest.raises(ValueError, match="{} and {} are the same file; give different files".format(*kinds)):
            sequence().write(prepared(), **dict(zip(kinds, (first, second))))
    assert contents(tmp_path) == before


def test_gltf_is_what_it_should_be(tmp_path):
    """Positions and normals within 1e-6; trimesh reads the mesh at rest."""
    deformer, made = prepared(), sequence()
    diagonal = np.linalg.norm(np.ptp(deformer.vertices, axis=0))
    made.write(deformer, gltf=tmp_path / "a.glb", rate=4)
    file = Glb(tmp_path / "a.glb")
    primitive, = file.json["meshes"][0]["primitives"]
    node, = file.json["nodes"]
    rest, normals = (file.array(primitive["attributes"][name]) for name in ("POSITION", "NORMAL"))
    assert (file.array(primitive["indices"]).reshape(-1, 3) == deformer.faces).all()
    sampler, = file.json["animations"][0]["samplers"]
    times, weights = file.array(sampler["input"]), file.array(sampler["output"])
    assert times.tolist() == [0, 0.25, 0.5, 0.75, 1] and (weights.reshape(5, 5) == np.eye(5)).all()
    for i, (_, pose) in enumerate(made.frames(deformer, rate=4)):
        target = primitive["targets"][i]
        points = rest.astype(float) + file.array(target["POSITION"]) + node["translation"]
        assert np.abs(points - pose.vertices).max() < 1e-6 * diagonal
        assert np.abs(normals.astype(float) + file.array(target["NORMAL"]) - pose.normals).max() < 1e-6
    trimesh = pytest.importorskip("trimesh")
    trimesh.exchange.gltf.validate(file.json)  # by the schema of the format
    read = trimesh.load(tmp_path / "a.glb", process=False).to_geometry()
    assert np.abs(read.vertices - deformer.vertices).max() < 1e-6 * diagonal and (read.faces == deformer.faces).all()

    info = made.write(deformer, gltf=tmp_path / "b.glb", rate=4, shapes="poses")
    file = Glb(tmp_path / "b.glb")
    assert file.json["meshes"][0]["extras"]["targetNames"] == ["bent", "twisted"] and info.largest_difference > 1e-3 * diagonal
    target = file.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"]
    assert np.abs(rest.astype(float) + file.array(target) + node["translation"] - deformer.pose({2: TURN}).vertices).max() < 1e-6 * diagonal


@pytest.mark.parametrize("faces", [True, False])
@pytest.mark.parametrize("rate", [4, 2000])  # all weights, and those alone that are not 0
def test_colours_are_in_the_file(tmp_path, faces, rate):
    vertices, corners, tags = SURFACE
    if rate > 4:  # a small surface for many frames
        vertices, corners, tags = np.eye(4, 3) * 3, [[0, 1, 3], [1, 2, 3]], np.array([0, 1, 2, 1])
    deformer, made = Deformer(vertices, corners if faces else None, tags), sequence()
    colors = np.random.default_rng(1).integers(0, 256, (len(vertices), 4))
    colors[:3] = [[0, 1, 255, 128], [10, 11, 12, 0], [255, 0, 188, 255]]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pymeshlab_fcd.DeformationWarning)
        made.write(deformer, gltf=tmp_path / "plain.glb", rate=rate)
        made.write(deformer, gltf=tmp_path / "a.glb", rate=rate, colors=colors)
        made.write(deformer, gltf=tmp_path / "b.glb", rate=rate, colors=colors[:, :3] / 255)
    file, plain, opaque = (Glb(tmp_path / f"{name}.glb") for name in ("a", "plain", "b"))
    primitive, before = file.json["meshes"][0]["primitives"][0], plain.json["meshes"][0]["primitives"][0]
    at = primitive["attributes"].pop("COLOR_0")
    assert file.json["accessors"][at]["normalized"] and primitive == before and len(file.json["accessors"]) == len(plain.json["accessors"]) + 1
    c = colors[:, :3] / 255  # as seen, and as light
    light = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    assert np.abs(file.array(at)[:, :3] / 65535 - light).max() < 1e-5 and (file.array(at)[:, 3] == 257 * colors[:, 3]).all()
    assert (opaque.array(at)[:, :3] == file.array(at)[:, :3]).all() and (opaque.array(at)[:, 3] == 65535).all()
    for name in ("POSITION", *(["NORMAL"] if faces else [])):
        for shape in (primitive["attributes"], primitive["targets"][2]):
            assert (file.array(shape[name]) == plain.array(shape[name])).all()
    trimesh = pytest.importorskip("trimesh")
    trimesh.exchange.gltf.validate(file.json)
    for wrong, message in ((colors[1:], "one row for each vertex"), (colors[:, :2], "one row for each"), (colors + 1, "from 0 to 255"),
                           (colors * 1.0, "from 0 to 1"), (colors > 3, "one row for each")):
        with pytest.raises(ValueError, match=message):
            made.write(deformer, gltf=tmp_path / "c.glb", colors=wrong)


def textured(tmp_path):
    """Vertices, faces and tags of a bar with a vertex and some faces more than a manifold has, texture coordinates of the corners, with seams,
    and the texture of each face: -1, 0 or 1."""
    vertices, faces, tags = SURFACE
    vertices = np.concatenate([vertices, [[1.0, 2, 3]]])  # without a face
    faces = np.concatenate([faces, faces[:5], faces[9:12, ::-1]])
    corners = vertices[faces]
    uv = corners[:, :, :2] * [0.3, 0.7]
    uv[corners.mean(1)[:, 2] > vertices[:-1, 2].mean()] += 0.5  # another part of the image
    return vertices, faces, np.append(tags, 1), uv, np.arange(len(faces)) // 40 % 3 - 1


@pytest.mark.parametrize("shapes", ["frames", "poses"])
def test_textures_are_in_the_file(tmp_path, shapes):
    """Each corner has its place on its image, at rest and in each frame; where corners at a vertex differ, it is there once for each."""
    vertices, faces, tags, uv, numbers = textured(tmp_path)
    (tmp_path / "skin.png").write_bytes(png(200, 100, 50))
    colors = np.random.default_rng(1).integers(0, 256, (len(vertices), 3))
    deformer, made = Deformer(vertices, faces, tags), sequence()
    made.write(deformer, gltf=tmp_path / "a.glb", rate=2, shapes=shapes, name="bar",
               look=Look(colors=colors, uv=uv, textures=[tmp_path / "skin.png", JPEG], face_textures=numbers))
    file = Glb(tmp_path / "a.glb")
    node, = file.json["nodes"]
    mesh, = file.json["meshes"]
    assert (node["name"], mesh["name"]) == ("bar", "bar")
    assert [file.image(i) for i in range(2)] == [(png(200, 100, 50), "image/png"), (JPEG, "image/jpeg")]
    assert [each["name"] for each in file.json["images"]] == ["skin.png", "texture 1"]
    assert [file.texture_of(each) for each in mesh["primitives"]] == [None, 0, 1]
    poses = [pose.vertices for _, pose in made.frames(deformer, rate=2)] if shapes == "frames" else [
        made.blend(deformer, {name: 100}).vertices for name in ("bent", "twisted")]
    first = mesh["primitives"][0]["attributes"]
    rest, places, light = (file.array(first[name]).astype(float) for name in ("POSITION", "TEXCOORD_0", "COLOR_0"))
    pairs = np.unique(np.column_stack([faces.ravel(), uv.reshape(-1, 2).astype(np.float32)]), axis=0)
    assert len(rest) == len(pairs) + 1 > len(vertices) and np.abs(rest[:len(vertices)] + node["translation"] - vertices).max() < 1e-6
    for primitive, number in zip(mesh["primitives"], (-1, 0, 1)):
        indices, expected = file.array(primitive["indices"]), faces[numbers == number].ravel()
        assert ("COLOR_0" in primitive["attributes"]) == (number < 0)
        assert np.abs(rest[indices] + node["translation"] - vertices[expected]).max() < 1e-6
        assert np.abs(places[indices] * [1, -1] + [0, 1] - uv[numbers == number].reshape(-1, 2)).max() < 1e-6
        assert len(primitive["targets"]) == len(poses)
        for target, pose in zip(primitive["targets"], poses):
            assert np.abs(rest[indices] + file.array(target["POSITION"])[indices] + node["translation"] - pose[expected]).max() < 1e-5
    c = colors[faces[numbers == -1].ravel()] / 255
    assert np.abs(light[file.array(mesh["primitives"][0]["indices"])][:, :3] / 65535
                  - np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)).max() < 1e-5
    read = assert_valid(tmp_path / "a.glb")
    assert sum(len(each.faces) for each in read.values()) == len(faces)
    seen = [each.visual.material.baseColorTexture for each in read.values() if getattr(each.visual, "uv", None) is not None]
    assert [each.getpixel((0, 0)) for each in seen if each is not None and each.mode == "RGB"] == [(200, 100, 50)]


def test_texture_coordinates_of_vertices_split_none(tmp_path):
    vertices, faces, tags = SURFACE
    for name, uv in (("a", vertices[:, :2]), ("b", vertices[faces][:, :, :2])):
        sequence().write(Deformer(vertices, faces, tags), gltf=tmp_path / f"{name}.glb", rate=2, look=Look(uv=uv, textures=[png(1, 2, 3)]))
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()
    file = Glb(tmp_path / "a.glb")
    primitive, = file.json["meshes"][0]["primitives"]
    assert file.texture_of(primitive) == 0 and (file.array(primitive["indices"]).reshape(-1, 3) == faces).all()
    assert np.abs(file.array(primitive["attributes"]["TEXCOORD_0"]) * [1, -1] + [0, 1] - vertices[:, :2]).max() < 1e-6
    read, = assert_valid(tmp_path / "a.glb").values()
    assert np.abs(read.visual.uv - vertices[:, :2]).max() < 1e-6  # as trimesh has them, upwards
    sequence().write(Deformer(vertices, faces, tags), gltf=tmp_path / "c.glb", rate=2, look=Look(uv=vertices[:, :2]))
    plain = Glb(tmp_path / "c.glb")
    primitive, = plain.json["meshes"][0]["primitives"]
    assert "TEXCOORD_0" in primitive["attributes"] and plain.texture_of(primitive) is None and "images" not in plain.json


def test_many_frames_and_a_texture(tmp_path):
    """Weights that are not 0 alone, and behind them the image."""
    vertices, faces, tags = np.eye(4, 3) * 3, [[0, 1, 3], [1, 2, 3]], np.array([0, 1, 2, 1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pymeshlab_fcd.DeformationWarning)
        sequence().write(Deformer(vertices, faces, tags), gltf=tmp_path / "a.glb", rate=2000, look=Look(uv=vertices[:, :2], textures=[JPEG]))
    file = Glb(tmp_path / "a.glb")
    primitive, = file.json["meshes"][0]["primitives"]
    weights = file.json["accessors"][file.json["animations"][0]["samplers"][0]["output"]]
    assert weights["sparse"]["count"] == 2001 == len(primitive["targets"]) and file.image(file.texture_of(primitive)) == (JPEG, "image/jpeg")
    views = file.json["bufferViews"]
    assert all(a["byteOffset"] + a["byteLength"] <= b["byteOffset"] for a, b in zip(views, views[1:]))
    assert_valid(tmp_path / "a.glb")


def test_colours_of_faces_are_in_the_file(tmp_path):
    vertices, faces, tags = SURFACE
    colors = np.random.default_rng(2).integers(0, 2, (len(faces), 3)) * 255
    sequence().write(Deformer(vertices, faces, tags), gltf=tmp_path / "a.glb", rate=2, look=Look(face_colors=colors))
    file = Glb(tmp_path / "a.glb")
    primitive, = file.json["meshes"][0]["primitives"]
    light, indices, rest = (file.array(each) for each in (primitive["attributes"]["COLOR_0"], primitive["indices"], primitive["attributes"]["POSITION"]))
    assert (light[indices].reshape(-1, 3, 4)[:, :, :3] == 257 * colors[:, None]).all() and len(light) == len(rest)
    assert len(rest) == len(np.unique(np.column_stack([faces.ravel(), np.repeat(colors, 3, axis=0)]), axis=0))
    assert np.abs(rest[indices] + file.json["nodes"][0]["translation"] - vertices[faces.ravel()]).max() < 1e-6
    assert_valid(tmp_path / "a.glb")


@pytest.mark.parametrize("shapes", ["frames", "poses"])
def test_other_meshes_go_along(tmp_path, shapes):
    """A mesh and a cloud beside the bar, each where Pose.map takes it; one image that two have is there once."""
    deformer, made = prepared(), sequence()
    middle = deformer.vertices[deformer.vertices[:, 0] > 0.7 * deformer.vertices[:, 0].max()].mean(0)
    ball = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]) * 0.3 + middle
    sides = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]])
    cloud = np.random.default_rng(3).normal(size=(50, 3)) + middle
    skin, places = png(9, 8, 7), ball[:, :2]
    info = made.write(deformer, gltf=tmp_path / "a.glb", pc2=tmp_path / "a.pc2", rate=4, shapes=shapes,
                      look=Look(uv=deformer.vertices[:, :2], textures=[skin]),
                      others=[Companion(ball, sides, "eye", Look(uv=places, textures=[skin])),
                              Companion(cloud, name="dust", look=Look(colors=np.ones((50, 3)) * 0.5))])
    alone = made.write(deformer, gltf=tmp_path / "b.glb", pc2=tmp_path / "b.pc2", rate=4, shapes=shapes)
    assert (tmp_path / "a.pc2").read_bytes() == (tmp_path / "b.pc2").read_bytes() and info.frames == alone.frames
    assert info.largest_difference >= alone.largest_difference
    file = Glb(tmp_path / "a.glb")
    assert [(node["name"], node["mesh"]) for node in file.json["nodes"]] == [("surface", 0), ("eye", 1), ("dust", 2)]
    assert file.json["scenes"][0]["nodes"] == [0, 1, 2] and len(file.json["images"]) == 1
    animation, = file.json["animations"]
    assert [each["target"] for each in animation["channels"]] == [{"node": i, "path": "weights"} for i in range(3)]
    poses = [pose for _, pose in made.frames(deformer, rate=4)] if shapes == "frames" else [
        made.blend(deformer, {name: 100}) for name in ("bent", "twisted")]
    for number, points in ((1, ball), (2, cloud)):
        primitive, = file.json["meshes"][number]["primitives"]
        rest = file.array(primitive["attributes"]["POSITION"]).astype(float)
        assert len(primitive["targets"]) == len(poses) == len(file.json["meshes"][number]["weights"])
        for target, pose in zip(primitive["targets"], poses):
            found = rest + file.array(target["POSITION"]) + file.json["nodes"][number]["translation"]
            assert np.abs(found - pose.map(points)).max() < 1e-5
    assert max(np.abs(pose.map(ball) - ball).max() for pose in poses) > 1
    eye, dust = (file.json["meshes"][i]["primitives"][0] for i in (1, 2))
    assert file.texture_of(eye) == 0 and (file.array(eye["indices"]).reshape(-1, 3) == sides).all() and list(eye["targets"][0]) == ["POSITION", "NORMAL"]
    assert dust["mode"] == 0 and list(dust["targets"][0]) == ["POSITION"] and (file.array(dust["attributes"]["COLOR_0"])[:, :3] == 14146).all()
    assert sorted(assert_valid(tmp_path / "a.glb")) == ["dust", "eye", "surface"]
    made.write(prepared(threads=1), gltf=tmp_path / "c.glb", rate=4, shapes=shapes, look=Look(uv=deformer.vertices[:, :2], textures=[skin]),
               others=[Companion(ball, sides, "eye", Look(uv=places, textures=[skin])), Companion(cloud, name="dust", look=Look(colors=np.ones((50, 3)) * 0.5))])
    assert (tmp_path / "c.glb").read_bytes() == (tmp_path / "a.glb").read_bytes()


def test_wrong_looks_are_told(tmp_path):
    vertices, faces, _ = SURFACE
    n, m, image = len(vertices), len(faces), png(1, 2, 3)
    uv = np.zeros((n, 2))
    (tmp_path / "a.tga").write_bytes(b"\0\0\2")
    for wrong, error, message in [
            ({"look": 5}, TypeError, "look must be a Look"),
            ({"look": Look(), "colors": np.ones((n, 3))}, ValueError, "colors and look are both given"),
            ({"look": Look(colors=np.ones((n, 3)), face_colors=np.ones((m, 3)))}, ValueError, "colors and face_colors are both given"),
            ({"look": Look(face_colors=np.ones((n, 3)))}, ValueError, f"face_colors must be {m} x 3, .* one row for each face"),
            ({"look": Look(uv=np.zeros((n, 3)))}, ValueError, f"uv must be {n} x 2, .* or {m} x 3 x 2"),
            ({"look": Look(uv=uv + np.inf)}, ValueError, "uv must be finite"),
            ({"look": Look(uv=uv + 1e39)}, ValueError, "uv must be finite numbers, of single precision"),
            ({"look": Look(textures=[image])}, ValueError, "give uv, too"),
            ({"look": Look(uv=uv, textures="a.png")}, TypeError, "textures must be several"),
            ({"look": Look(uv=uv, textures=[7])}, TypeError, "textures must be files, .* there is a int"),
            ({"look": Look(uv=uv, textures=[tmp_path / "none.png"])}, FileNotFoundError, "none.png"),
            ({"look": Look(uv=uv, textures=[str(tmp_path / "a.tga")])}, ValueError, "'a.tga' is neither PNG nor JPEG"),
            ({"look": Look(uv=uv, textures=[image], face_textures=np.zeros(n, int))}, ValueError, f"face_textures must be {m} whole numbers"),
            ({"look": Look(uv=uv, textures=[image], face_textures=np.ones(m, int))}, ValueError, "numbers of the 1 textures, .* it holds 1 to 1"),
            ({"name": 3}, TypeError, "name must be a text"),
            ({"others": [vertices]}, TypeError, "others must be Companions"),
            ({"others": [Companion(vertices[:, :2])]}, ValueError, "the companion's vertices must be n x 3"),
            ({"others": [Companion(vertices, look=Look(uv=uv))]}, ValueError, "a cloud has no textures"),
            ({"others": [Companion(vertices[:0], name="eye")]}, ValueError, "'eye' has no vertices"),
            ({"others": [Companion(vertices * np.nan, name="eye")]}, ValueError, "Vertex 0 of 'eye' has a coordinate that is not a finite number")]:
        with pytest.raises(error, match=message):
            sequence().write(prepared(), gltf=tmp_path / "a.glb", **wrong)
    assert [path.name for path in tmp_path.iterdir()] == ["a.tga"]


def test_a_cloud_and_far_from_the_origin(tmp_path):
    vertices, _, tags = SURFACE
    far = vertices + [4e5, 5e6, 0]
    deformer = Deformer(far, None, tags)
    sequence().write(deformer, gltf=tmp_path / "a.glb", rate=2)
    file = Glb(tmp_path / "a.glb")
    primitive, = file.json["meshes"][0]["primitives"]
    assert primitive["mode"] == 0 and list(primitive["attributes"]) == ["POSITION"]
    pose = deformer.pose({2: TURN})
    points = file.array(primitive["attributes"]["POSITION"]).astype(float) + file.array(primitive["targets"][1]["POSITION"]) + file.json["nodes"][0]["translation"]
    assert np.abs(points - pose.vertices).max() < 1e-6 * np.linalg.norm(np.ptp(vertices, axis=0))


def test_what_single_precision_cannot_hold_is_refused(tmp_path):
    vertices, faces, _ = SURFACE
    for path, given in (("a.glb", {"others": [Companion(vertices * 1e40, faces)]}), ("a.glb", {"others": [Companion(vertices * 1e200)]})):
        with pytest.raises(ValueError, match="A vertex is farther away than single precision allows in this file"):
            sequence().write(prepared(), gltf=tmp_path / path, **given)
    late = PoseSequence({"bent": {2: TURN}}, [KeyFrame(1e7), KeyFrame(1e7 + 1, {"bent": 100})])
    with pytest.raises(ValueError, match="A .glb file has single-precision times, in which some frames would be at the same time"):
        late.write(prepared(), gltf=tmp_path / "a.glb")
    assert late.write(prepared(), gltf=tmp_path / "a.glb", rate=1).frames == 2
    far = Deformer(vertices * 1e39, faces, SURFACE[2])
    lift = PoseSequence({"up": {2: Motion.translate([0, 0, 1e38])}})
    with pytest.raises(ValueError, match="A vertex is farther away than single precision allows"):
        lift.write(far, pc2=tmp_path / "a.pc2", rate=1)
    assert [each.name for each in tmp_path.iterdir()] == ["a.glb"]


def test_of_another_surface(tmp_path):
    deformer, made = prepared(), sequence()
    made.save(tmp_path / "a.csv", deformer)
    read = PoseSequence.load(tmp_path / "a.csv")
    assert same(read.blend(deformer, {"bent": 100}).vertices, deformer.pose({2: TURN}).vertices)
    vertices, faces, tags = SURFACE
    with pytest.raises(ValueError, match="The poses are of another surface"):
        read.blend(Deformer(vertices + [0, 0, 1], faces, tags), {"bent": 100})
    with pytest.raises(ValueError, match="this surface is prepared with points"):
        made.blend(Deformer(vertices, faces, tags, points=[700]), {"bent": 100})
    with pytest.raises(ValueError, match="pose 'odd': handle 7 moves, but no vertex has tag 7"):
        next(PoseSequence({"odd": {7: TURN}}).frames(deformer))


def test_what_is_wrong_is_told(tmp_path):
    deformer, made = prepared(), sequence()
    for wrong, error, message in [
            (lambda: PoseSequence([TURN]), TypeError, "poses must be a mapping"),
            (lambda: PoseSequence({}), ValueError, "There is no pose"),
            (lambda: PoseSequence({"": {2: TURN}}), ValueError, "has no name"),
            (lambda: PoseSequence({"a": {2: TURN}}, [1]), TypeError, "keys must be KeyFrames"),
            (lambda: PoseSequence({"a": {2: TURN}}, [KeyFrame(0, {"b": 1})]), ValueError, "there is no pose 'b'; the poses are 'a'"),
            (lambda: PoseSequence({"a": {2: TURN}}, [KeyFrame(0, {"a": 1}, "soft")]), ValueError, "easing"),
            (lambda: PoseSequence({"a": {2: TURN}}, [KeyFrame(1), KeyFrame(1)]), ValueError, "Their times must ascend"),
            (lambda: PoseSequence({"a": {2: TURN}}, [KeyFrame(0, 5)]), TypeError, "weights must be a mapping"),
            (lambda: PoseSequence.parse("a,b\n", "x"), ValueError, "'x', line 1: expected a first row"),
            (lambda: PoseSequence.load(tmp_path / "none.csv"), OSError, "none.csv"),
            (lambda: made.blend(deformer, {"b": 5}), ValueError, "there is no pose 'b'"),
            (lambda: made.write(deformer), ValueError, "nothing to make"),
            (lambda: made.write(deformer, gltf=tmp_path / "a.glb", shapes="all"), ValueError, "shapes"),
            (lambda: made.write(deformer, gltf=tmp_path / "a.glb", rate=0), ValueError, "must be a positive number"),
            (lambda: made.write(deformer, gltf=tmp_path / "no" / "a.glb"), OSError, "a.glb")]:
        with pytest.raises(error, match=message):
            wrong()
    assert not list(tmp_path.iterdir())


def test_what_was_there_stays_after_an_interruption(tmp_path):
    (tmp_path / "a.glb").write_bytes(b"before")

    def stop(percent, stage):
        if percent > 30:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        sequence().write(prepared(), gltf=tmp_path / "a.glb", pc2=tmp_path / "a.pc2", rate=200, progress=stop)
    assert [path.name for path in tmp_path.iterdir()] == ["a.glb"] and (tmp_path / "a.glb").read_bytes() == b"before"


def test_folds_are_warned_of(tmp_path):
    x, y = [grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, 60), np.linspace(0, 1, 60), indexing="ij")]
    i = np.arange(60 * 60).reshape(60, 60)[:-1, :-1].ravel()
    faces = np.concatenate([np.stack([i, i + 60, i + 1], 1), np.stack([i + 1, i + 60, i + 61], 1)])
    deformer = Deformer(np.stack([x, y, 0 * x], 1), faces, np.where(x < 0.1, 0, np.where(x > 0.9, 2, 1)))
    pushed = PoseSequence({"pushed": {2: Motion.translate([-0.72, 0, 0])}}, [KeyFrame(0, {"pushed": 100})])
    with pytest.warns(pymeshlab_fcd.FoldWarning, match="flipped"):
        assert pushed.write(deformer, pc2=tmp_path / "a.pc2").folded > 0
    with pytest.warns(pymeshlab_fcd.FoldWarning, match="The pose has folds: .* flipped"):
        pushed.blend(deformer, {"pushed": 100})
    twice = PoseSequence({"pushed": {2: Motion.translate([-0.72, 0, 0])}}, [KeyFrame(0, {"pushed": 100}), KeyFrame(1, {"pushed": 101})])
    with pytest.warns(DeformationWarning) as told:
        frames = list(twice.frames(deformer, rate=2))
    assert len(frames) == 3 and [each.category for each in told] == [pymeshlab_fcd.FoldWarning] and "The frame at 0 s has folds" in str(told[0].message)
    lazy = Deformer(deformer.vertices, faces, np.where(x < 0.1, 0, np.where(x > 0.9, 2, 1)), max_iterations=1)
    up = PoseSequence({"up": {2: Motion.translate([0, 0, 0.3])}}, [KeyFrame(0, {"up": 100})])
    for warns in (lambda: list(up.frames(lazy)), lambda: up.blend(lazy, {"up": 100}), lambda: up.write(lazy, pc2=tmp_path / "a.pc2")):
        with pytest.warns(pymeshlab_fcd.NotAtRestWarning, match="did not converge") as told:
            warns()
        assert {each.filename for each in told} == {__file__}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        list(twice.frames(deformer, check=False))
        pushed.blend(deformer, {"pushed": 100}, check=False)


def test_the_filter_writes_the_same_bits(tmp_path):
    pymeshlab = with_filters()
    made = sequence()
    made.save(tmp_path / "poses.csv")
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(SURFACE[0], SURFACE[1].astype(np.int32), v_scalar_array=SURFACE[2].astype(float)), "surface")
    ms.apply_filter("generate_fcd_pose_sequence", poses_file=str(tmp_path / "poses.csv"), gltf_file=str(tmp_path / "filter.glb"),
                    pc2_file=str(tmp_path / "filter.pc2"), mdd_file=str(tmp_path / "filter.mdd"), frames_per_second=8)
    made.write(prepared(), gltf=tmp_path / "python.glb", pc2=tmp_path / "python.pc2", mdd=tmp_path / "python.mdd", rate=8)
    assert (tmp_path / "filter.mdd").read_bytes() == (tmp_path / "python.mdd").read_bytes()
    assert (tmp_path / "filter.pc2").read_bytes() == (tmp_path / "python.pc2").read_bytes()
    assert (tmp_path / "filter.glb").read_bytes() == (tmp_path / "python.glb").read_bytes()


@pytest.mark.parametrize("size", [2.0**-600, 2.0**600])
def test_poses_of_surfaces_of_any_size_are_blended_alike(size, tmp_path):
    """About one joint; and the table knows its surface."""
    vertices, faces, tags = SURFACE

    def blended(by):
        turns = {f"by {angle}": {2: Motion.rotate([0, 1, 0], angle, about=np.array([5, 0.5, 0]) * by)} for angle in (-30, -60)}
        deformer, poses = Deformer(vertices * by, faces, tags), PoseSequence(turns)
        poses.save(tmp_path / "poses.csv", deformer)
        read = PoseSequence.load(tmp_path / "poses.csv")
        with pytest.raises(ValueError, match="of another surface"):
            read.blend(Deformer((vertices + [1, 0, 0]) * by, faces, tags), {"by -30": 100})
        return read.blend(deformer, {"by -30": 50, "by -60": 50}).vertices / by

    np.testing.assert_allclose(blended(size), blended(1), rtol=0, atol=1e-9)


def test_a_table_in_another_encoding_is_told(tmp_path):
    (tmp_path / "p.csv").write_bytes("time, easing, geöffnet\nmotions, , 2: translate 0 0 1\n".encode("latin-1"))
    with pytest.raises(ValueError, match=r"p.csv is no text in UTF-8 \(invalid .* byte\): save it as such"):
        PoseSequence.load(tmp_path / "p.csv")
