# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours and textures of meshes in files of animations."""
from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _inputs, _meshes
from ._meshes import MeshLike
from ._numbers import plain, shown, told_shape
from ._numbers import text as expected_text

if TYPE_CHECKING:
    from ._core import Look as _Told
    from ._core import Other as _Other

Texture = Union[str, "os.PathLike[str]", bytes]


@dataclass(frozen=True, eq=False)
class Look:
    """Colours and textures of a mesh in a `.glb` file. None: without."""

    colors: ArrayLike | None = None
    """n x 3 or n x 4: red, green, blue (and opacity) of each vertex, as they are seen (sRGB): whole numbers from 0 to 255, or others from 0 to
    1. Faces with a texture only have that."""
    face_colors: ArrayLike | None = None
    """m x 3 or m x 4: the same of each face; not with `colors`. Vertices between faces of several colours are repeated for each."""
    uv: ArrayLike | None = None
    """Texture coordinates, u to the right and v upwards: n x 2, one row for each vertex, or m x 3 x 2, of the corners of each face. Vertices
    whose corners differ are repeated for each."""
    textures: Sequence[Texture] = ()
    """PNG or JPEG images: files, or their bytes. Each is copied unchanged, into a material."""
    face_textures: ArrayLike | None = None
    """m whole numbers: the texture of each face, from 0; -1 for none. None: all have the first."""


@dataclass(frozen=True, eq=False)
class Companion:
    """Another mesh, or a cloud, that moves along in an animation, like eyes in a head, by [Pose.map][pymeshlab_fcd.Pose.map]."""

    vertices: ArrayLike | MeshLike
    """n x 3, in the space of the Deformer's; or a mesh of another library, without faces then."""
    faces: ArrayLike | None = None
    """m x 3; None: a cloud."""
    name: str = "companion"
    """Its name in the file."""
    look: Look = field(default_factory=Look)
    """Its colours and textures."""


def look_of(look: object, name: str, vertices: int, faces: NDArray[np.uint32] | None) -> _Told:
    """Name and look, for the extension."""
    if not isinstance(look, Look):
        raise TypeError(f"look must be a Look, as Look(colors=...); it is a {type(look).__name__}")
    count = 0 if faces is None else len(faces)
    if look.colors is not None and look.face_colors is not None:
        raise ValueError("colors and face_colors are both given; give those of the vertices or those of the faces")
    colors = None if look.colors is None else _inputs.colors(look.colors, vertices)
    of_faces = None if look.face_colors is None else _inputs.colors(look.face_colors, count, "face_colors", "face")
    places = None if look.uv is None else _places(look.uv, vertices, faces)
    if isinstance(look.textures, (str, bytes, os.PathLike)):
        raise TypeError("textures must be several, as ['skin.png']; it is one")
    images = [_image(texture, i) for i, texture in enumerate(look.textures)]
    if images and places is None:
        raise ValueError("textures have no place on the mesh without texture coordinates; give uv, too")
    return (expected_text("name", name), colors, of_faces, places,
            None if look.face_textures is None else _numbers(look.face_textures, count, len(images)), images)


def other_of(given: object) -> _Other:
    """A companion, for the extension."""
    if not isinstance(given, Companion):
        raise TypeError(f"others must be Companions, as Companion(vertices, faces); there is a {type(given).__name__}")
    _, positions, faces = _meshes.surface(given.vertices, given.faces, "the companion's ")
    return positions, faces, look_of(given.look, given.name, len(positions), faces)


def _places(values: object, vertices: int, faces: NDArray[np.uint32] | None) -> NDArray[np.float32]:
    """u and v of the corners of each face, m x 6."""
    if faces is None:
        raise ValueError("uv is for meshes; a cloud has no textures")
    array = plain("uv", values)
    if array.dtype.kind == "b" or array.shape not in ((vertices, 2), (len(faces), 3, 2)):
        raise ValueError(f"uv must be {vertices} x 2, one row for each vertex, or {len(faces)} x 3 x 2, of the corners of each face; it is "
                         f"{told_shape(array)} of {array.dtype}")
    with np.errstate(over="ignore"):
        array = array.astype(np.float32)
    if not np.isfinite(array).all():
        raise ValueError("uv must be finite numbers, of single precision")
    if array.ndim == 3:
        return np.ascontiguousarray(array.reshape(-1, 6))
    places = np.empty((len(faces), 6), np.float32)
    for first in range(0, len(faces), 1 << 20):  # Ctrl-C is heard in between
        places[first:first + (1 << 20)] = array[faces[first:first + (1 << 20)]].reshape(-1, 6)
    return places


def _numbers(values: object, faces: int, images: int) -> NDArray[np.int32]:
    array = plain("face_textures", values)
    if array.dtype.kind not in "iu" or array.shape != (faces,):
        raise ValueError(f"face_textures must be {faces} whole numbers, one for each face; it is {told_shape(array)} of {array.dtype}")
    if faces and (array.min() < -1 or array.max() >= images):
        raise ValueError(f"face_textures must be numbers of the {images} textures, from 0, or -1; it holds {array.min()} to {array.max()}")
    return np.ascontiguousarray(array, dtype=np.int32)


def _image(texture: Any, number: int) -> tuple[str, bytes]:
    if isinstance(texture, bytes):
        name, content = f"texture {number}", texture
    elif isinstance(texture, (str, os.PathLike)):
        name = shown(os.path.basename(texture))
        with open(texture, "rb") as file:
            content = file.read()
    else:
        raise TypeError(f"textures must be files, or the bytes of such; there is a {type(texture).__name__}")
    if not content.startswith((b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff")):
        raise ValueError(f"the texture {name!r} is neither PNG nor JPEG, which glTF holds; convert it")
    return name, content
