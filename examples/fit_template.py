# SPDX-License-Identifier: GPL-3.0-or-later
"""Lays a template onto a scan, wherever the two lie, by a few landmarks.

    python fit_template.py TEMPLATE.ply SCAN.ply LANDMARKS.csv FITTED.ply

A line of the landmarks is x, y, z on the template, and x, y, z on the scan where that belongs: three at least, four or more where the
sizes differ. The scan may be a cloud. Says how near the template is, and how much of it has a counterpart. Needs trimesh and
pymeshlab_fcd."""
from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

import pymeshlab_fcd

files: Any = trimesh  # its types say little of what a file holds


def fit_files(template: str | Path, scan: str | Path, landmarks: str | Path, fitted: str | Path) -> pymeshlab_fcd.Fitted:
    source, target = files.load(template, process=False), files.load(scan, process=False)
    pairs = np.loadtxt(landmarks, delimiter=",", ndmin=2)
    faces = None if isinstance(target, trimesh.PointCloud) else target.faces
    start: pymeshlab_fcd.FitStart = "landmarks_similar" if len(pairs) > 3 else "landmarks_rigid"
    made = pymeshlab_fcd.fit(source.vertices, source.faces, target.vertices, faces, landmarks=(pairs[:, :3], pairs[:, 3:]), start=start)
    source.vertices = made.vertices  # colours and texture of the template stay
    source.export(fitted)
    return made


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    info = fit_files(*sys.argv[1:]).info
    print(f"{100 * info.matched:.0f} % have a counterpart, {info.rms:.3g} from it (root mean square); the worst landmark is off by "
          f"{info.landmark_residual:.2g}")
