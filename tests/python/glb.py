# SPDX-License-Identifier: GPL-3.0-or-later
"""Animations in binary glTF files, read byte by byte; and small images for them."""
import json
import struct
import zlib

import numpy as np
import pytest


class Glb:
    """What is in a binary glTF file."""

    def __init__(self, path):
        content = path.read_bytes()
        magic, version, size, bytes_, kind = np.frombuffer(content, "<u4", 5)
        assert (magic, version, size, kind) == (0x46546C67, 2, len(content), 0x4E4F534A)
        self.json, self._buffer = json.loads(content[20:20 + bytes_]), content[28 + bytes_:]
        assert self.json["buffers"] == [{"byteLength": len(self._buffer)}]

    def array(self, accessor):
        told = self.json["accessors"][accessor]
        view = self.json["bufferViews"][told["bufferView"]]
        kind, width = {5126: "<f4", 5125: "<u4", 5123: "<u2"}[told["componentType"]], {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[told["type"]]
        assert view["byteOffset"] % 4 == 0 and view["byteLength"] == told["count"] * width * np.dtype(kind).itemsize
        array = np.frombuffer(self._buffer, kind, told["count"] * width, view["byteOffset"])
        array = array.reshape(told["count"], -1) if told["type"] != "SCALAR" else array
        if "min" in told:
            assert (array.min(0) == np.float32(told["min"])).all() and (array.max(0) == np.float32(told["max"])).all()
        return array


    def image(self, number):
        told = self.json["images"][number]
        view = self.json["bufferViews"][told["bufferView"]]
        return self._buffer[view["byteOffset"]:view["byteOffset"] + view["byteLength"]], told["mimeType"]

    def texture_of(self, primitive):
        """The number of its image, None where it has none."""
        material = self.json["materials"][primitive["material"]]
        assert material["pbrMetallicRoughness"]["metallicFactor"] == 0 and material["doubleSided"]
        found = material["pbrMetallicRoughness"].get("baseColorTexture")
        return None if found is None else self.json["textures"][found["index"]]["source"]


def png(*color):
    """A PNG file with one pixel."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(bytes([0, *color])))
            + chunk(b"IEND", b""))


JPEG = bytes.fromhex(  # a file with 8 x 8 gray pixels
    "ffd8ffe000104a46494600010100000100010000ffdb004300100b0c0e0c0a100e0d0e1211101318281a181616183123251d283a333d3c3933383740485c4e404457453738506d51"
    "575f626768673e4d71797064785c656763ffc0000b080008000801011100ffc40014000100000000000000000000000000000005ffc4001410010000000000000000000000000000"
    "0000ffda0008010100003f0015ffd9")


def assert_valid(path):
    """By the schema of the format, as far as trimesh is there. Returns what it reads, {name: mesh}."""
    trimesh = pytest.importorskip("trimesh")
    trimesh.exchange.gltf.validate(Glb(path).json)
    return trimesh.load(path, process=False).geometry
