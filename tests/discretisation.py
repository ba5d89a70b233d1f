# SPDX-License-Identifier: GPL-3.0-or-later
"""How far deformations are from those of a node at every vertex, and how far they say that they are (discretisation_error).

    build/venv/bin/python tests/discretisation.py libfilter_fcd.so MESH ...

The ends of each mesh, 15 % of its longest side each, are turned by 60 degrees against each other about its shortest side. Prints a table in
Markdown: root mean square over what is free, percent of the diagonal of that, as it is / as it says, median over three seeds. Meshes of
more than FACES faces are decimated."""
import sys
from pathlib import Path

import numpy as np
import pymeshlab

FACES = 12000
PATCHES = (100, 300, 1000)


def deform(points, faces, tags, patches, seed=1, **parameters):
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=tags.astype(float)))
    result = ms.apply_filter("generate_fcd_deformed_mesh", graph_layers=False, initial_patches=patches, random_seed=seed, rotation_angle=60.0,
                             rotation_axis=np.eye(3)[np.argmin(np.ptp(points, axis=0))], **parameters)
    return ms.current_mesh().vertex_matrix(), result["discretisation_error"]


def main(plugin, paths):
    pymeshlab.load_plugin(plugin)
    print("| |", " | ".join(f"{patches} patches" for patches in PATCHES), "|\n|" + "---|" * (len(PATCHES) + 1))
    for path in paths:
        ms = pymeshlab.MeshSet()
        ms.load_new_mesh(path)
        if ms.current_mesh().face_number() > FACES:
            ms.apply_filter("meshing_decimation_quadric_edge_collapse", targetfacenum=FACES)
        points, faces = ms.current_mesh().vertex_matrix(), ms.current_mesh().face_matrix()
        along = points[:, np.argmax(np.ptp(points, axis=0))]
        along = (along - along.min()) / np.ptp(along)
        tags = np.where(along < 0.15, 0, np.where(along > 0.85, 2, 1))
        free = points[tags == 1]
        limit, _ = deform(points, faces, tags, 10 * len(points), tolerance=1e-6, max_iterations=5000)
        cells = []
        for patches in PATCHES:
            found = [deform(points, faces, tags, patches, seed) for seed in (1, 2, 3)]
            off = [np.sqrt(((moved - limit) ** 2)[tags == 1].sum(1).mean()) / np.linalg.norm(np.ptp(free, axis=0)) for moved, _ in found]
            cells.append(f"{100 * np.median(off):.2f} / {100 * np.median([error for _, error in found]):.2f}")
        print(f"| {Path(path).stem}, {len(points)} vertices |", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
