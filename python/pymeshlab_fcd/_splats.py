# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaussian splats that move along: their rotations, scales, and the harmonics of their colours."""
from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ._inputs import Points

Numbers = NDArray[np.float64]

ROTATION: Final = tuple(f"rot_{i}" for i in range(4))  # w, x, y, z of a quaternion of any length
SCALE: Final = tuple(f"scale_{i}" for i in range(3))  # natural logarithms
_CHUNK: Final = 1 << 14  # splats: 100 MB
# Directions at which harmonics are fitted, spread evenly (a Fibonacci sphere): more than the seven harmonics of the
# highest band.
_DIRECTIONS: Final = 16


def is_splats(names: Sequence[str]) -> bool:
    """Whether vertices with these properties are splats of 3D Gaussian Splatting (Kerbl et al. 2023)."""
    return set(ROTATION + SCALE) <= set(names)


def harmonics(names: Sequence[str]) -> list[str]:
    """The names of the harmonics of the bands from 1, in order: red, then green, then blue."""
    return [f"f_rest_{i}" for i in range(sum(name.startswith("f_rest_") for name in names))]


def carried(rotation: Numbers, scale: Numbers, linear: Numbers) -> tuple[Numbers, Numbers]:
    """The rotations, n x 4, and the logarithms of the scales, n x 3, of splats after linear maps, n x 3 x 3: those of the mapped ellipsoids."""
    w, x, y, z = rotation.T / np.maximum(np.linalg.norm(rotation, axis=1), 1e-300)
    axes = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1).reshape(-1, 3, 3)
    largest = scale.max(axis=1, keepdims=True)  # subtracted, so that exp does not overflow
    turned, sizes, along = np.linalg.svd(linear @ (axes * np.exp(scale - largest)[:, None, :]))
    # Keeps the order of the axes, so that the identity changes nothing.
    order = np.argsort(np.argsort(-scale, axis=1, kind="stable"), axis=1, kind="stable")
    turned = np.take_along_axis(turned, order[:, None, :], axis=2)
    sizes = np.take_along_axis(sizes, order, axis=1)
    turned[:, :, 2] *= np.sign(np.linalg.det(turned))[:, None]
    return _quaternions(turned), np.log(np.maximum(sizes, 1e-300)) + largest


def _quaternions(turn: Numbers) -> Numbers:
    """The quaternions of rotations, n x 3 x 3: eigenvectors of the largest eigenvalue (Bar-Itzhack 2000), with w >= 0."""
    a = turn
    k = np.empty((len(a), 4, 4))
    k[:, 0, 0] = a[:, 0, 0] + a[:, 1, 1] + a[:, 2, 2]
    k[:, 1, 1] = a[:, 0, 0] - a[:, 1, 1] - a[:, 2, 2]
    k[:, 2, 2] = a[:, 1, 1] - a[:, 0, 0] - a[:, 2, 2]
    k[:, 3, 3] = a[:, 2, 2] - a[:, 0, 0] - a[:, 1, 1]
    for i, j, value in ((0, 1, a[:, 2, 1] - a[:, 1, 2]), (0, 2, a[:, 0, 2] - a[:, 2, 0]), (0, 3, a[:, 1, 0] - a[:, 0, 1]),
                        (1, 2, a[:, 0, 1] + a[:, 1, 0]), (1, 3, a[:, 0, 2] + a[:, 2, 0]), (2, 3, a[:, 1, 2] + a[:, 2, 1])):
        k[:, i, j] = k[:, j, i] = value
    found: Numbers = np.linalg.eigh(k)[1][:, :, 3]
    return found * np.where(found[:, :1] < 0, -1.0, 1.0)


def _basis(band: int, d: Numbers) -> Numbers:
    """The real harmonics of a band at directions, ... x 3: ... x (2 band + 1), in the order and with the signs of 3D Gaussian Splatting."""
    x, y, z = d[..., 0], d[..., 1], d[..., 2]
    if band == 1:
        return 0.4886025119029199 * np.stack([-y, z, -x], -1)
    if band == 2:
        return np.stack([1.0925484305920792 * x * y, -1.0925484305920792 * y * z, 0.31539156525252005 * (2 * z * z - x * x - y * y),
                         -1.0925484305920792 * x * z, 0.5462742152960396 * (x * x - y * y)], -1)
    return np.stack([-0.5900435899266435 * y * (3 * x * x - y * y), 2.890611442640554 * x * y * z, -0.4570457994644658 * y * (4 * z * z - x * x - y * y),
                     0.3731763325901154 * z * (2 * z * z - 3 * x * x - 3 * y * y), -0.4570457994644658 * x * (4 * z * z - x * x - y * y),
                     1.445305721320277 * z * (x * x - y * y), -0.5900435899266435 * x * (x * x - 3 * y * y)], -1)


def turned_harmonics(coefficients: Numbers, linear: Numbers) -> Numbers:
    """Turns harmonics by the rotations nearest to linear maps, n x 3 x 3.

    Parameters
    ----------
    coefficients
        n x colours x 3, 8 or 15: of band 1, of the bands 1 and 2, or 1 to 3.
    """
    i = np.arange(_DIRECTIONS) + 0.5
    height, angle = 1 - 2 * i / _DIRECTIONS, i * (np.pi * (3 - np.sqrt(5)))
    radius = np.sqrt(1 - height**2)
    d = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], 1)
    made = coefficients.copy()
    for begin in range(0, len(made), _CHUNK):
        part = slice(begin, begin + _CHUNK)
        u, _, v = np.linalg.svd(linear[part])
        u[:, :, 2] *= np.sign(np.linalg.det(u @ v))[:, None]
        before = d @ (u @ v)  # each direction, turned back
        first = 0
        for band in (1, 2, 3):
            if first >= made.shape[2]:
                break
            of_band = slice(first, first + 2 * band + 1)
            seen: Any = np.einsum("ndb,ncb->ncd", _basis(band, before), coefficients[part, :, of_band])
            made[part, :, of_band] = seen @ np.linalg.pinv(_basis(band, d)).T
            first += 2 * band + 1
    return made


def columns(names: Sequence[str], read: Points, linear: Numbers) -> dict[str, Numbers]:
    """The properties of moved splats that change, by name.

    Parameters
    ----------
    names
        Of all properties.
    read
        n x properties, as they are at rest.
    linear
        n x 3 x 3: the derivative of the deformation at each splat.
    """
    def of(wanted: Sequence[str]) -> Numbers:
        return read[:, [names.index(name) for name in wanted]]

    known = np.isfinite(read).all(axis=1) & np.isfinite(linear).all(axis=(1, 2))  # others stay unchanged
    rotation, scale = of(ROTATION), of(SCALE)
    rotation[known], scale[known] = carried(rotation[known], scale[known], linear[known])
    made = {**dict(zip(ROTATION, rotation.T)), **dict(zip(SCALE, scale.T))}
    rest = harmonics(names)
    if rest and len(rest) % 3 == 0 and len(rest) // 3 in (3, 8, 15):
        coefficients = of(rest)
        coefficients[known] = turned_harmonics(coefficients[known].reshape(-1, 3, len(rest) // 3), linear[known]).reshape(-1, len(rest))
        made.update(zip(rest, coefficients.T))
    elif rest:
        warnings.warn(f"The {len(rest)} harmonics of the colours stay unturned: those of the bands 1 to 3 are 9, 24 or 45.", stacklevel=2)
    return made
