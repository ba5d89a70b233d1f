# SPDX-License-Identifier: GPL-3.0-or-later
"""Dirty versions of a pair, and how far what a fit makes of them is from what it makes of the clean one, for tests/fit_pairs.py."""
from dataclasses import replace

import numpy as np

from fit_shapes import diagonal
from peers import dirty_cases


def pierced(points, faces):
    """A hundredth of the triangles is missing, here and there."""
    gone = np.random.default_rng(2).permutation(len(faces))[:len(faces) // 100]
    return points, np.delete(faces, gone, 0)


def versions(points, faces):
    """{name: (points, faces, which vertex of the clean mesh each of the first ones is)}; what is behind these is dirt. Eight."""
    own = np.arange(len(points))
    made = {name.split(":")[0]: (each[0], each[1], own if each[3] is None else each[3])
            for name, each in dirty_cases(points, faces, np.ones(len(points), int)).items() if name != "clean"}
    made["a hundredth of the triangles missing"] = (*pierced(points, faces), own)
    return made


def dirty(pair):
    """{name: (the pair, its source and a target of triangles dirty in the same way, which vertex of the clean source each of the first
    ones of the dirty one is)}"""
    sources = versions(pair.points, pair.faces)
    same = dict.fromkeys(sources, (pair.target, pair.target_faces))
    targets = versions(pair.target, pair.target_faces) if len(pair.target_faces) else same
    return {name: (replace(pair, points=points, faces=faces.astype(np.int32), truth=pair.truth[own], target=targets[name][0],
                           target_faces=targets[name][1].astype(np.int32),
                           landmarks=np.array([np.flatnonzero(own == i)[0] for i in pair.landmarks], int)), own)
            for name, (points, faces, own) in sources.items()}


def apart(positions, own, clean, truth):
    """Root mean square distance from what the clean pair is fitted to, percent of the diagonal of the truth."""
    off = positions[:len(own)] - clean[own]
    return 100 * float(np.sqrt(np.mean((off ** 2).sum(1)))) / diagonal(truth)
