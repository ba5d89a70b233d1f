# SPDX-License-Identifier: GPL-3.0-or-later
"""What posing costs in pymeshlab, and of what that is made up: for each mesh, seconds of a pose in place from its second call on
(find: comparing the layer with what is prepared; solve: the graph; map: positions and normals of vertices; normals: of faces;
host: the rest of the call), and what filters cost in times of what MeshLab itself does in the same process: a deformed layer, with
the deformer kept and without, in copies of the layer (generate_copy_of_current_mesh); the graph filter in steps of Laplacian
smoothing; and a deformed layer of the vertices as a cloud in those of the mesh. Medians.

    build/venv/bin/python tests/poses.py PLUGIN.so MESH...

The lowest tenth of the mesh is fixed, the highest is the handle; --shuffle puts the vertices in no order."""
import argparse
import statistics
import time

import numpy as np
import pymeshlab

PARTS = ("find", "solve", "map", "normals")


def seconds(work):
    begin = time.perf_counter()
    result = work()
    return time.perf_counter() - begin, result


def load(path, shuffle):
    ms = pymeshlab.MeshSet(verbose=False)
    ms.load_new_mesh(path)
    mesh = ms.current_mesh()
    vertices, faces = mesh.vertex_matrix(), mesh.face_matrix()
    if shuffle:
        order = np.random.default_rng(1).permutation(len(vertices))
        place = np.empty_like(order)
        place[order] = np.arange(len(order))
        vertices, faces = vertices[order], place[faces].astype(np.int32)
    longest = vertices[:, np.argmax(np.ptp(vertices, axis=0))]
    low, high = np.quantile(longest, [0.1, 0.9])
    tags = np.where(longest < low, 0.0, np.where(longest > high, 2.0, 1.0))
    return vertices, faces, tags


def document(vertices, faces, tags):
    ms = pymeshlab.MeshSet(verbose=False)
    ms.add_mesh(pymeshlab.Mesh(vertices, faces, v_scalar_array=tags))
    return ms


def measure(path, shuffle, times):
    vertices, faces, tags = load(path, shuffle)
    ms = document(vertices, np.zeros((0, 3), np.int32), tags)

    def turn(i):
        return f"2: rotate 1 1 0 {20 + i}"

    def drop():
        for layer in [mesh.id() for mesh in ms if mesh.id() != 0]:
            ms.set_current_mesh(layer)
            ms.delete_current_mesh()
        ms.set_current_mesh(0)
        assert ms.mesh_number() == 1

    def deform(i, **parameters):
        ms.apply_filter("generate_fcd_deformed_mesh", transforms=turn(i), graph_layers=False, **parameters)

    def timed(work, times=times):
        taken = []
        for i in range(times):
            taken.append(seconds(lambda: work(i))[0])
            drop()
        return statistics.median(taken)

    cloud = timed(lambda i: deform(i, random_seed=100 + i))
    ms = document(vertices, faces, tags)
    copied = timed(lambda _: ms.generate_copy_of_current_mesh())
    anew = timed(lambda i: deform(i, random_seed=100 + i))
    kept = timed(lambda i: deform(i, random_seed=100 + times - 1))
    graph = timed(lambda _: ms.apply_filter("generate_fcd_deformation_graph", patches_layer=False), 3)
    smooth = statistics.median(seconds(lambda: ms.apply_filter("apply_coord_laplacian_smoothing", stepsmoothnum=1))[0] for _ in range(3))

    first, _ = seconds(lambda: ms.apply_filter("apply_coord_fcd_deformation", transforms=turn(0)))
    poses = [seconds(lambda: ms.apply_filter("apply_coord_fcd_deformation", transforms=turn(i))) for i in range(1, 1 + 2 * times)]
    assert not any(values["prepared"] for _, values in poses)
    whole = statistics.median(taken for taken, _ in poses)
    part = {name: statistics.median(values["seconds_" + name] for _, values in poses) for name in PARTS}
    host = whole - sum(part.values())
    print(f"| {len(vertices)} | {first:.2f} | {whole:.3f} | {1 / whole:.1f} | " + " | ".join(f"{part[name]:.3f}" for name in PARTS) +
          f" | {host:.3f} | {anew / copied:.2f} | {kept / copied:.2f} | {graph / smooth:.2f} | {cloud / anew:.2f} |", flush=True)


if __name__ == "__main__":
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("plugin")
    arguments.add_argument("mesh", nargs="+")
    arguments.add_argument("--shuffle", action="store_true")
    arguments.add_argument("--times", type=int, default=5)
    given = arguments.parse_args()
    pymeshlab.load_plugin(given.plugin)
    print("| vertices | first pose s | pose s | poses/s | " + " | ".join(PARTS) +
          " | host | deformed layer / copy | the same, kept | graph / Laplacian step | cloud / mesh |")
    print("|---" * 13 + "|")
    for path in given.mesh:
        measure(path, given.shuffle, given.times)
