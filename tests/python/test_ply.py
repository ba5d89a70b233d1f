# SPDX-License-Identifier: GPL-3.0-or-later
"""PLY files as others write them."""
import struct

import numpy as np
import pytest
from shapes import bar
from test_batch import write_ply, write_splats

from pymeshlab_fcd import Deformer, Motion
from pymeshlab_fcd._batch import main
from pymeshlab_fcd._ply import Ply


@pytest.mark.parametrize("order", ["<", ">", ""])
def test_whole_numbers_become_what_the_result_needs(tmp_path, order):
    vertices, faces, tags, _ = bar(21, 5)
    whole = np.round(vertices * [10, 10, 0])
    write_ply(tmp_path / "a.ply", whole, faces, tags, order, normals=np.tile([0, 0, 1.0], (len(whole), 1)))
    text = (tmp_path / "a.ply").read_bytes()
    if order:
        head, rest = text.split(b"end_header\n")
        table_of = lambda kinds: [*((each, order + kind) for each, kind in zip("xyz", kinds)), *((each, order + kinds[3]) for each in "abc"), ("q", order + "f4"), ("r", "u1")]
        old = np.frombuffer(rest, table_of(["f8"] * 3 + ["f4"]), len(whole))
        text = head + b"end_header\n" + old.astype(table_of(["i2", "u1", "i4", "i1"])).tobytes() + rest[old.nbytes:]
    else:
        text = text.replace(b".0 ", b" ")
    for name, kind in ((b"double x", b"short x"), (b"double y", b"uchar y"), (b"double z", b"int z"), *((b"float n" + each, b"char n" + each) for each in (b"x", b"y", b"z"))):
        text = text.replace(name, kind, 1)
    (tmp_path / "a.ply").write_bytes(text)
    assert (Ply(tmp_path / "a.ply").vertices == whole).all()
    assert main(["deform", str(tmp_path / "a.ply"), "--move", "2", "rotate 0 1 0 20 translate 0 0 70000", "--out", str(tmp_path / "o")]) == 0
    pose = Deformer(whole, faces, tags, normals=np.tile([0, 0, 1.0], (len(whole), 1))).pose({2: Motion("rotate 0 1 0 20 translate 0 0 70000")}, check=False)
    made = Ply(tmp_path / "o" / "a.ply")
    assert np.abs(made.vertices / np.abs(pose.vertices).max(0) - pose.vertices / np.abs(pose.vertices).max(0)).max() < 1e-6
    assert (made.vertices[:, 2] == pose.vertices[:, 2]).all() and np.abs(made.normals - pose.normals).max() < 1e-6 and (made.faces == faces).all()
    assert (made.column("quality") == tags).all()
    head = (tmp_path / "o" / "a.ply").read_bytes().split(b"end_header")[0].decode()
    assert "float x\n" in head and "float y\n" in head and "double z\n" in head and "float nx\n" in head and "uchar red\n" in head and "uchar region\n" in head


@pytest.mark.parametrize("order", ["<", ""])
def test_strips_are_triangles_and_comments_are_none_of_the_header(tmp_path, order):
    vertices, _, _, _ = bar(4, 2)
    strip = [0, 1, 2, 3, 4, 5, -1, 4, 5, 5, 6, 7]
    head = (f"ply\nformat {'binary_little_endian' if order else 'ascii'} 1.0\ncomment no end_header of \x85 element face 3\nelement vertex 8\n"
            "property double x\nproperty double y\nproperty double z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n").encode("latin-1")
    numbers = [len(strip), *strip]
    (tmp_path / "a.ply").write_bytes(head + (vertices.astype("<f8").tobytes() + struct.pack(f"<{len(numbers)}i", *numbers) if order else
                                             ("\n".join(" ".join(map(repr, map(float, p))) for p in vertices) + "\n" + " ".join(map(str, numbers)) + "\n").encode()))
    ply = Ply(tmp_path / "a.ply")
    assert ply.faces.tolist() == [[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5], [5, 6, 7]] and (ply.vertices == vertices).all()
    ply.save(tmp_path / "b.ply", vertices, None)
    assert (tmp_path / "b.ply").read_bytes() == (tmp_path / "a.ply").read_bytes()


def test_harmonics_of_other_bands_are_told(tmp_path, capsys):
    vertices, faces, tags, _ = bar(9, 3)
    random = np.random.default_rng(0)
    write_splats(tmp_path / "s.ply", vertices, random.normal(size=(len(vertices), 3)), random.normal(size=(len(vertices), 4)), random.normal(size=(len(vertices), 72)))
    Deformer(vertices, faces, tags).pose({2: Motion.rotate([0, 1, 0], 30)}).deformation().save(tmp_path / "b.fcd")
    assert main(["apply", str(tmp_path / "b.fcd"), str(tmp_path / "s.ply"), "--out", str(tmp_path / "o")]) == 0
    assert "warning: The 72 harmonics of the colours stay unturned" in capsys.readouterr().out


def text_faces(path, lines):
    path.write_text("ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n" f"element face {len(lines)}\n"
                    "property list uchar int vertex_indices\nend_header\n" + "0 0 0\n" * 5 + "".join(f"{each}\n" for each in lines))
    return Ply(path)


def test_faces_as_text_are_read_alike_whatever_their_lengths(tmp_path):
    triangles = ["3 0 1 2", "3 1 2 3", "3 2 3 4"]
    for lines, more in ((triangles, []), ([*triangles, "4 0 1 2 3"], [[0, 1, 2], [0, 2, 3]]), ([*triangles, "3 4 0 1 9"], [[4, 0, 1]])):
        assert text_faces(tmp_path / "a.ply", lines).faces.tolist() == [[0, 1, 2], [1, 2, 3], [2, 3, 4], *more]
    for lines in (["inf 0 1 2"], ["1e400 0 1 2"], ["nan 0 1 2"], ["3 0 1"], ["3 0 1 two"]):
        with pytest.raises(ValueError, match="a.ply cannot be read as PLY"):
            text_faces(tmp_path / "a.ply", lines)


def test_faces_of_many_corners_are_split_in_the_same_order_as_text_and_as_bytes(tmp_path):
    head = ("ply\nformat {} 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
            "property list uchar int vertex_indices\nend_header\n")
    points, faces = np.arange(24.0).reshape(8, 3), [[0, 1, 2, 3, 4], [7, 6, 5, 4, 3]]
    lines = [*(" ".join(map(str, p)) for p in points), *(" ".join(map(str, [5, *each])) for each in faces)]
    (tmp_path / "a.ply").write_text(head.format("ascii") + "\n".join(lines) + "\n")
    (tmp_path / "b.ply").write_bytes(head.format("binary_little_endian").encode() + points.astype("<f4").tobytes() + b"".join(struct.pack("<B5i", 5, *each) for each in faces))
    triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [7, 6, 5], [7, 5, 4], [7, 4, 3]]
    assert Ply(tmp_path / "a.ply").faces.tolist() == Ply(tmp_path / "b.ply").faces.tolist() == triangles
