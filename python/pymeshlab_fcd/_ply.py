# SPDX-License-Identifier: GPL-3.0-or-later
"""PLY files whose vertices move. All else in them (labels, colours, textures, other elements) stays, to the byte."""
from __future__ import annotations

import contextlib
import copy
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from . import _files
from ._inputs import Points
from ._numbers import shown

_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
          "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8"}
_NORMALS = ("nx", "ny", "nz")
_FACES = ("face", "tristrips")
_CORNERS = ("vertex_indices", "vertex_index")


@dataclass
class _Element:
    name: str
    count: int
    properties: list[tuple[str, str, str]]  # name, type, type of the count of a list or ""


class Ply:
    """The content of a file."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._name = shown(path)
        with open(os.fspath(path), "rb") as file:
            content = file.read()
        ends = re.search(rb"\nend_header[ \t\r]*\n", content)
        if not content.startswith(b"ply") or ends is None:
            raise ValueError(f"{self._name} is no PLY file: save it as one")
        begin = ends.end()
        self._head, self._elements, order = content[:begin].splitlines(keepends=True), list[_Element](), ""
        try:
            for words in ([word.decode("utf-8", "replace") for word in line.split()] for line in self._head):
                if words[:1] == ["format"]:
                    order = {"ascii": "ascii", "binary_little_endian": "<", "binary_big_endian": ">"}[words[1]]
                elif words[:1] == ["element"]:
                    self._elements.append(_Element(words[1], int(words[2]), []))
                elif words[:1] == ["property"]:
                    is_list = words[1] == "list"
                    self._elements[-1].properties.append((words[-1], _TYPES[words[-2]], _TYPES[words[2]] if is_list else ""))
            self._order = order
            self._read(content, begin)
        except (KeyError, IndexError, ValueError, OverflowError) as error:
            raise ValueError(f"{self._name} cannot be read as PLY: {error}") from error

    def _read(self, content: bytes, at: int) -> None:
        self._faces: NDArray[np.int64] | None = None
        if not self._elements or self._elements[0].name != "vertex" or any(kind for _, _, kind in self._elements[0].properties):
            raise ValueError("its first element is not vertices with numbers alone")
        first = self._elements[0]
        names = [name for name, _, _ in first.properties]
        if not {"x", "y", "z"} <= set(names):
            raise ValueError("its vertices have no x, y, z")
        self._names = names
        if self._order == "ascii":
            lines = content[at:].split(b"\n")
            self._rows = [line.split() for line in lines[:first.count]]
            if len(self._rows) < first.count or any(len(row) != len(names) for row in self._rows):
                raise ValueError("it has fewer vertices than it says")
            self._rest = b"\n".join(lines[first.count:])
            self.vertices = self._columns(("x", "y", "z"))
            line = first.count
            for element in self._elements[1:]:
                if element.name in _FACES:
                    if line + element.count > len(lines):
                        raise ValueError("it has fewer faces than it says")
                    self._add_faces(element, self._text_faces(element, lines[line:line + element.count]))
                line += element.count
            return
        kind = np.dtype([(name, self._order + each) for name, each, _ in first.properties])
        end = at + first.count * kind.itemsize
        if end > len(content):
            raise ValueError("it has fewer vertices than it says")
        self._table = np.frombuffer(content[at:end], kind).copy()
        self._rest = content[end:]
        self.vertices = self._columns(("x", "y", "z"))
        at = 0
        last = max((i for i, element in enumerate(self._elements) if element.name in _FACES), default=0)
        for element in self._elements[1:last + 1]:  # later elements are not read
            faces, at = self._binary(element, at)
            self._add_faces(element, faces)

    def _add_faces(self, element: _Element, corners: list[list[int]] | NDArray[np.int64]) -> None:
        if element.name in _FACES:
            made = _triangles(corners) if element.name == "face" else _of_strips(corners)
            self._faces = made if self._faces is None else np.concatenate([self._faces, made])

    def _text_faces(self, element: _Element, lines: list[bytes]) -> list[list[int]] | NDArray[np.int64]:
        if lines and len(element.properties) == 1:  # as nearly all files: lists alone, of one length
            with contextlib.suppress(ValueError, OverflowError):
                table = np.loadtxt(lines, np.float64, comments=None, ndmin=2)
                if table.shape == (len(lines), int(table[0, 0]) + 1) and (table[:, 0] == table[0, 0]).all():
                    return table[:, 1:].astype(np.int64) if element.properties[0][0] in _CORNERS else np.zeros((0, 3), np.int64)
        return [self._corners(element, [float(each) for each in row.split()]) for row in lines]

    def _corners(self, element: _Element, numbers: list[float]) -> list[int]:
        found, at = [0], 0
        for name, _, kind in element.properties:
            count = int(numbers[at]) if kind else 1
            at += bool(kind)
            if name in _CORNERS:
                found = [int(each) for each in numbers[at:at + count]]
            at += count
        if at > len(numbers):
            raise ValueError("it has fewer numbers in a face than it says")
        return found

    def _binary(self, element: _Element, at: int) -> tuple[list[list[int]] | NDArray[np.int64], int]:
        lists = [name for name, _, kind in element.properties if kind]
        # In nearly all files, each list has the same length in all faces.
        fields: list[tuple[str, str] | tuple[str, str, tuple[int]]] = []
        place = at
        for name, each, kind in element.properties:
            if kind and element.count:
                count = int(np.frombuffer(self._rest, self._order + kind, 1, place)[0])
                fields += [(f"count {name}", self._order + kind), (name, self._order + each, (count,))]
                place += np.dtype(kind).itemsize + count * np.dtype(each).itemsize
            else:
                fields.append((name, self._order + each))
                place += np.dtype(each).itemsize
        table = np.dtype(fields)
        end = at + element.count * table.itemsize
        if end <= len(self._rest):
            all_of_it = np.frombuffer(self._rest, table, element.count, at)
            if all((all_of_it[f"count {name}"] == table[name].shape[0]).all() for name in lists if element.count):
                corners = next((name for name in _CORNERS if name in lists), None)
                return (np.zeros((0, 3), np.int64) if corners is None or not element.count else all_of_it[corners].astype(np.int64)), end
        faces: list[list[int]] = []
        for _ in range(element.count):
            for name, each, kind in element.properties:
                count = 1
                if kind:
                    count = int(np.frombuffer(self._rest, self._order + kind, 1, at)[0])
                    at += np.dtype(kind).itemsize
                values = np.frombuffer(self._rest, self._order + each, count, at)
                at += values.nbytes
                if name in _CORNERS:
                    faces.append([int(value) for value in values])
        return faces, at

    def _columns(self, names: tuple[str, ...]) -> Points:
        if self._order == "ascii":
            places = [self._names.index(name) for name in names]
            return np.fromiter((float(row[k]) for row in self._rows for k in places), np.float64).reshape(-1, len(names))
        return np.stack([self._table[name].astype(np.float64) for name in names], axis=1)

    @property
    def faces(self) -> NDArray[np.int64] | None:
        """m x 3, polygons divided into fans; None for a cloud."""
        return self._faces if self._faces is not None and len(self._faces) else None

    @property
    def has_normals(self) -> bool:
        return set(_NORMALS) <= set(self._names)

    @property
    def normals(self) -> Points | None:
        return self._columns(_NORMALS) if self.has_normals else None

    def column(self, name: str) -> NDArray[np.float64]:
        """A number of each vertex."""
        if name not in self._names:
            raise ValueError(f"the vertices of {self._name} have no {name}; they have {', '.join(self._names)}")
        return self._columns((name,))[:, 0]

    @property
    def names(self) -> list[str]:
        """The names of the vertices' properties."""
        return list(self._names)

    def columns(self) -> Points:
        """All properties of the vertices, n x properties."""
        return self._columns(tuple(self._names))

    def part(self, numbers: NDArray[np.int64], faces: NDArray[np.int64] | None) -> Ply:
        """The vertices of these numbers, with all that they carry, and triangles of them; nothing else."""
        made = copy.copy(self)
        others = [i for i, line in enumerate(self._head) if line.split()[:1] == [b"element"]]
        made._head = self._head[:others[1] if len(others) > 1 else -1]
        made._head[others[0]] = b"element vertex %d\n" % len(numbers)
        made._elements, made._faces, made._rest = self._elements[:1], faces, b""
        if faces is not None:
            made._head += [b"element face %d\n" % len(faces), b"property list uchar int vertex_indices\n"]
            if self._order == "ascii":
                made._rest = b"".join(b"3 %d %d %d\n" % tuple(face) for face in faces.tolist())
            else:
                table = np.empty(len(faces), [("count", "u1"), ("corners", self._order + "i4", 3)])
                table["count"], table["corners"] = 3, faces
                made._rest = table.tobytes()
        made._head.append(b"end_header\n")
        made.vertices = self.vertices[numbers]
        if self._order == "ascii":
            made._rows = [self._rows[i] for i in numbers]
        else:
            made._table = self._table[numbers]
        return made

    def save(self, path: str | os.PathLike[str], vertices: Points, normals: Points | None, others: Mapping[str, Points] = MappingProxyType({})) -> None:
        """Writes the file with other positions, with other normals if it has some and some are given, and with other properties."""
        new = list(zip("xyz", vertices.T))
        if normals is not None and self.has_normals:
            new += list(zip(_NORMALS, normals.T))
        new += list(others.items())
        kinds = {name: kind if kind in ("f4", "f8") else "f8" if kind in ("i4", "u4") else "f4" for name, kind, _ in self._elements[0].properties}
        if self._order == "ascii":
            rows = [list(row) for row in self._rows]
            for name, values in new:
                k = self._names.index(name)
                for row, value in zip(rows, values):
                    row[k] = repr(float(value)).encode()
            body = b"".join(b" ".join(row) + b"\n" for row in rows)
        else:
            changed = dict(new)
            table = self._table.astype([(name, self._order + (kinds[name] if name in changed else kind)) for name, kind, _ in self._elements[0].properties])
            for name, values in new:
                table[name] = values
            body = table.tobytes()
        with _files.written([path]) as files:
            files[0].write(self._new_head({name: kinds[name] for name, _ in new}) + body + self._rest)

    def _new_head(self, kinds: Mapping[str, str]) -> bytes:
        """The header, with other types for properties that were whole numbers, by name."""
        head, names = list(self._head), iter(self._elements[0].properties)
        for i, line in enumerate(head):
            words = line.split()
            if words[:1] == [b"property"] and (now := next(names, None)) and kinds.get(now[0], now[1]) != now[1]:
                head[i] = re.sub(rb"(property\s+)\S+", rb"\1" + (b"double" if kinds[now[0]] == "f8" else b"float"), line, count=1)
        return b"".join(head)


def _of_strips(strips: list[list[int]] | NDArray[np.int64]) -> NDArray[np.int64]:
    """The triangles of strips; -1 begins another strip. Triangles with a repeated corner are left out."""
    made: list[tuple[int, int, int]] = []
    for strip in strips:
        first = 0
        for k in range(len(strip)):
            if strip[k] < 0:
                first = k + 1
            elif k >= first + 2:
                a, b, c = (int(each) for each in strip[k - 2:k + 1])
                if a != b and b != c and c != a:
                    made.append((a, b, c) if (k - first) % 2 == 0 else (b, a, c))
    return np.array(made, np.int64).reshape(-1, 3)


def _triangles(faces: list[list[int]] | NDArray[np.int64]) -> NDArray[np.int64]:
    if isinstance(faces, np.ndarray):
        return np.stack([faces[:, [0] * (faces.shape[1] - 2)], faces[:, 1:-1], faces[:, 2:]], axis=2).reshape(-1, 3)
    return np.array([[each[0], each[k], each[k + 1]] for each in faces for k in range(1, len(each) - 1)], np.int64).reshape(-1, 3)
