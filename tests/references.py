# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the references in meshes/, NAME_sr_arap.ply: CGAL's SR-ARAP of NAME.ply, run to convergence by tests/quality.sh; some minutes.

    build/venv/bin/python tests/references.py [NAME ...]
    build/venv/bin/python tests/references.py --distances [NAME ...]    how far this plugin's results are from them, over five seeds

The quads of these meshes have their diagonals one way, and CGAL's result goes with them: a reference is the mean of two, of the mesh as it
is and with all of these the other way. By how much each of the two is off, half of their distance, is printed; tests take it as their limit."""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pymeshlab

ROOT = Path(__file__).resolve().parents[1]
NAMES = ["bar", "cactus", "cylinder", "plane"]


def read(path):
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(path))
    return ms.current_mesh().vertex_matrix(), ms.current_mesh().face_matrix()


def other_diagonals(points, faces):
    """Pairs of triangles that share the longest edge of both and lie almost in a plane get the other diagonal."""
    edges = {}
    long = np.argmax([((points[faces[:, (k + 1) % 3]] - points[faces[:, k]]) ** 2).sum(1) for k in range(3)], axis=0)
    normals = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for i, (face, k) in enumerate(zip(faces, long)):
        edges.setdefault(tuple(sorted((face[k], face[(k + 1) % 3]))), []).append(i)
    flipped = faces.copy()
    for pair in edges.values():
        if len(pair) == 2 and normals[pair[0]] @ normals[pair[1]] > 0.99:
            (a, p, q), b = np.roll(faces[pair[0]], -(long[pair[0]] + 2) % 3), faces[pair[1]][(long[pair[1]] + 2) % 3]
            flipped[pair[0]], flipped[pair[1]] = (a, p, b), (b, q, a)
    return flipped


def distance(one, other, rest):
    """Root mean square, percent of the diagonal."""
    return 100 * np.sqrt(((one - other) ** 2).sum(1).mean()) / np.linalg.norm(np.ptp(rest, axis=0))


def main(names):
    with tempfile.TemporaryDirectory() as folder:
        at, stems = Path(folder), []
        for name in names:
            points, faces = read(ROOT / "meshes" / f"{name}.ply")
            for which, corners in (("as_is", faces), ("flipped", other_diagonals(points, faces))):
                stems.append(at / f"{name}_{which}")
                ms = pymeshlab.MeshSet()
                ms.add_mesh(pymeshlab.Mesh(points, corners))
                ms.save_current_mesh(f"{stems[-1]}.ply", save_vertex_quality=False)
                for kind in ("sel", "def"):
                    Path(f"{stems[-1]}.{kind}").write_text((ROOT / "meshes" / f"{name}.{kind}").read_text())
        (at / "results").mkdir()
        subprocess.run(["bash", str(ROOT / "tests" / "quality.sh"), "--seeds", "1", "--patches", "300", "--save", str(at / "results"),
                        *map(str, stems)], check=True)
        for name in names:
            rest, _ = read(ROOT / "meshes" / f"{name}.ply")
            two = [read(at / "results" / f"{name}_{which}_reference.off")[0] for which in ("as_is", "flipped")]
            ms = pymeshlab.MeshSet()
            ms.add_mesh(pymeshlab.Mesh(np.mean(two, axis=0)))
            ms.save_current_mesh(str(ROOT / "meshes" / f"{name}_sr_arap.ply"), save_vertex_quality=False, save_vertex_normal=False,
                                 save_vertex_color=False, save_vertex_coord=False)
            print(f"{name}: each of the two is {distance(*two, rest) / 2:.3f} % from their mean")


def distances(names):
    pymeshlab.load_plugin(str(Path(os.environ.get("FCD_PLUGIN", ROOT / "build" / "plugins" / "pymeshlab-2025.7" / "libfilter_fcd.so"))))
    for name in names:
        stem, said = str(ROOT / "meshes" / name), []
        wanted, (rest, _) = read(f"{stem}_sr_arap.ply")[0], read(f"{stem}.ply")
        for what, patches, seeds in (("by itself", 0, 5), ("300 patches", 300, 5), ("a node at every vertex", 20 * len(rest), 1)):
            found = []
            for seed in range(1, seeds + 1):
                ms = pymeshlab.MeshSet()
                ms.load_new_mesh(f"{stem}.ply")
                result = ms.apply_filter("generate_fcd_deformed_mesh", handles=3, tag_file=f"{stem}.sel", transform_file=f"{stem}.def",
                                         graph_layers=False, initial_patches=patches, random_seed=seed)
                found.append((distance(ms.current_mesh().vertex_matrix(), wanted, rest), result["nodes"]))
            said.append(f"{what}: {min(found)[0]:.3f} to {max(found)[0]:.3f} %, {np.mean([nodes for _, nodes in found]):.0f} nodes")
        print(f"{name}: " + "; ".join(said))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--distances"]:
        distances(sys.argv[2:] or NAMES)
    else:
        main(sys.argv[1:] or NAMES)
