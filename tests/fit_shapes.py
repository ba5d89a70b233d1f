# SPDX-License-Identifier: GPL-3.0-or-later
"""What the pairs of tests/fit_recipes.py are made of: sources, poses that are none of our deformations, and what becomes of scans."""
import lzma
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pymeshlab

ROOT = Path(__file__).resolve().parents[1]
MESHES = ROOT.parent / "shared" / "meshes"
CGAL = ROOT / "build" / "cmake" / "peers" / "tests" / "cgal_peer"
NONE = np.zeros((0, 3))


class Absent(Exception):
    """What a pair is made of is not here."""


@dataclass
class Pair:
    """Coordinates are n x 3, in the units of the mesh."""

    points: np.ndarray  # of the source
    faces: np.ndarray  # m x 3; 0 x 3 for a cloud
    truth: np.ndarray  # where the points belong
    surface: np.ndarray  # m x 3, triangles on truth: the surface that they belong on
    target: np.ndarray
    target_faces: np.ndarray
    normals: np.ndarray  # of the target's points; 0 x 3: none are told
    has: np.ndarray  # n, whether there is something on the target where the point belongs
    landmarks: np.ndarray  # numbers of points, which are told to belong at the truth


# --- sources ---

def meshlab(points, faces, name, **parameters):
    """What a filter of MeshLab makes of a mesh."""
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(points, faces))
    ms.apply_filter(name, **parameters)
    return ms.current_mesh().vertex_matrix(), ms.current_mesh().face_matrix()


def loaded(name):
    path = MESHES / name
    if not path.exists():
        raise Absent(f"{path} is not there")
    with tempfile.TemporaryDirectory() as folder:
        if path.suffix == ".xz":
            unpacked = Path(folder) / path.stem
            unpacked.write_bytes(lzma.decompress(path.read_bytes()))
            path = unpacked
        ms = pymeshlab.MeshSet()
        ms.load_new_mesh(str(path))
    return ms.current_mesh().vertex_matrix(), ms.current_mesh().face_matrix()


def simplified(mesh, vertices):
    return meshlab(*mesh, "meshing_decimation_quadric_edge_collapse", targetfacenum=2 * vertices, preservenormal=True)


def remeshed(mesh, percent):
    return meshlab(*mesh, "meshing_isotropic_explicit_remeshing", targetlen=pymeshlab.PercentageValue(percent), iterations=6)


def refined(mesh):
    """Each triangle in four."""
    points, faces = mesh
    ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1).astype(np.int64)
    _, first, edge = np.unique(ends[:, 0] * len(points) + ends[:, 1], return_index=True, return_inverse=True)
    a, b, c = len(points) + edge.reshape(3, -1)
    fine = np.concatenate([[faces[:, 0], a, c], [a, faces[:, 1], b], [c, b, faces[:, 2]], [a, b, c]], axis=1).T
    return np.concatenate([points, points[ends[first]].mean(1)]), fine.astype(np.int32)


def grid(columns, rows, closed):
    """Triangles between vertices in rows, with or without the last column beside the first."""
    here = np.arange(columns if closed else columns - 1)
    beside = (here + 1) % columns
    return np.concatenate([np.concatenate([np.stack([here, beside, here + columns], 1), np.stack([beside, beside + columns, here + columns], 1)])
                           + row * columns for row in range(rows - 1)]).astype(np.int32)


def tube():
    """With bumps that tell each place of it from the others."""
    z, a = [each.ravel() for each in np.meshgrid(np.linspace(0, 4, 120), 2 * np.pi * np.arange(60) / 60, indexing="ij")]
    radius = 0.4 + 0.05 * np.cos(3 * a + 2 * z) + 0.06 * np.sin(2.5 * z) * np.cos(a)
    return np.stack([radius * np.cos(a), radius * np.sin(a), z], 1), grid(60, 120, True)


def potato():
    ms = pymeshlab.MeshSet()
    ms.create_sphere(subdiv=5)
    ball = ms.current_mesh().vertex_matrix()
    random = np.random.default_rng(5)
    waves, phase, height = random.normal(size=(9, 3)) * 3, random.uniform(0, 6.28, 9), random.uniform(-0.09, 0.09, 9)
    return ball * (1 + np.sin(ball @ waves.T + phase) @ height)[:, None] * [1.6, 1, 0.8], ms.current_mesh().face_matrix()


def sheet():
    """Thin and open."""
    x, y = [each.ravel() for each in np.meshgrid(np.linspace(0, 3, 150), np.linspace(0, 2, 100))]
    height = 0.06 * np.sin(5 * x + 2 * y) + 0.05 * np.sin(4 * y - 3 * x) + 0.1 * np.exp(-4 * ((x - 1.1) ** 2 + (y - 0.8) ** 2))
    return np.stack([x, y, height], 1), grid(150, 100, False)


# --- poses ---

def diagonal(points):
    return np.linalg.norm(np.ptp(points, 0))


def bent(seed, strength=1.0, base=None):
    """Along the longest axis: bent by 17 to 40 degrees, twisted by 12 to 25, and waved; as a map, of the space of the base."""
    random = np.random.default_rng(seed)
    middle, size = base.mean(0), diagonal(base)
    axes = np.linalg.svd((base - middle)[:: max(1, len(base) // 5000)], full_matrices=False)[2]
    length = np.ptp((base - middle) @ axes[0]) / size
    twist, radius = strength * random.uniform(0.2, 0.45) / length, length / random.uniform(0.3, 0.7) / strength
    waves, phase, amount = random.normal(size=(6, 3)) * 4, random.uniform(0, 6.28, 6), random.normal(size=(6, 3)) * 0.005

    def pose(points):
        x, y, z = ((points - middle) @ axes.T / size).T
        y, z = np.cos(twist * x) * y - np.sin(twist * x) * z, np.sin(twist * x) * y + np.cos(twist * x) * z
        out = np.column_stack([(radius - y) * np.sin(x / radius), radius - (radius - y) * np.cos(x / radius), z])
        return (out + np.sin(out @ waves.T + phase) @ amount) @ axes * size + middle
    return pose


def limb(points, faces, tip, share):
    """Of the part that ends at the vertex tip and is cut off at a share of the diagonal from it: which vertices, the place of the
    joint, and how far each lies beyond it, in times of its length."""
    to = points.mean(0) - points[tip]
    length = share * diagonal(points)
    joint = points[tip] + to / np.linalg.norm(to) * length
    beyond = (points - joint) @ (points[tip] - joint) / length ** 2
    inside = beyond > 0
    own, reached = faces[inside[faces].all(1)], np.zeros(len(points), bool)
    reached[tip] = True
    count = 0
    while count != reached.sum():
        count = reached.sum()
        reached[own[reached[own].any(1)]] = True
    return reached, joint, beyond


def turned(points, joint, axis, degrees):
    """Each point about the joint, by its own angle."""
    k = np.asarray(axis, float) / np.linalg.norm(axis)
    p, t = points - joint, np.radians(degrees)[:, None]
    return joint + p * np.cos(t) + np.cross(k, p) * np.sin(t) + k * (p @ k)[:, None] * (1 - np.cos(t))


def jointed(points, faces, *joints):
    """Limbs turned at their joints, smoothly along half of them. joints: (tip, share, axis, degrees)"""
    out = points
    for tip, share, axis, degrees in joints:
        reached, joint, beyond = limb(points, faces, tip, share)
        t = np.clip(beyond * 2, 0, 1)
        out = turned(out, joint, axis, np.where(reached, degrees * t * t * (3 - 2 * t), 0.0))
    return out


def cgal(points, faces, tags, matrix):
    """Posed by SR-ARAP of CGAL (bash tests/peers.sh builds it)."""
    if not CGAL.exists():
        raise Absent(f"{CGAL} is not there")
    with tempfile.TemporaryDirectory() as folder:
        stem = Path(folder) / "case"
        ms = pymeshlab.MeshSet()
        ms.add_mesh(pymeshlab.Mesh(points, faces))
        ms.save_current_mesh(f"{stem}.ply", save_vertex_quality=False)
        np.savetxt(f"{stem}.sel", tags, "%d")
        np.savetxt(f"{stem}.def", matrix, "%.17g")
        subprocess.run([CGAL, "sr_arap", stem, "1e-5", Path(folder) / "out"], check=True, stdout=subprocess.DEVNULL)
        return np.fromfile(Path(folder) / "out").reshape(-1, 3)


def lifted(points, faces, tip, share, axis, degrees):
    """A limb, of which the outer half is turned about its joint, by CGAL."""
    reached, joint, beyond = limb(points, faces, tip, share)
    matrix = np.eye(4)
    matrix[:3] = np.column_stack([turned(np.vstack([np.eye(3), [0, 0, 0]]), joint, axis, np.full(4, degrees)).T])
    matrix[:3, :3] -= matrix[:3, 3:]
    return cgal(points, faces, np.where(~reached, 0, np.where(beyond > 0.5, 2, 1)), matrix)


# --- what becomes of sources and targets ---

def noisy(points, percent):
    return points + np.random.default_rng(1).normal(size=points.shape) * percent / 100 * diagonal(points) / np.sqrt(3)


def without(points, faces, gone):
    keep = ~gone
    return points[keep], (np.cumsum(keep) - 1)[faces[keep[faces].all(1)]]


def holes(points, faces, count=8):
    at = points[np.random.default_rng(1).choice(len(points), count)]
    near = np.min([np.linalg.norm(points - hole, axis=1) for hole in at], axis=0)
    return without(points, faces, near < 0.04 * diagonal(points))


def soup(points, faces):
    """Each triangle for itself."""
    return points[faces.ravel()], np.arange(faces.size).reshape(-1, 3).astype(np.int32)


def shattered(points, faces, parts):
    """In so many parts, a little smaller than they were, so that nothing welds them."""
    seeds = np.random.default_rng(1).choice(len(faces), parts, replace=False)
    middles = points[faces].mean(1)
    part = np.concatenate([((some[:, None] - middles[seeds]) ** 2).sum(2).argmin(1) for some in np.array_split(middles, len(faces) // 500 + 1)])
    corners, own = np.unique(np.stack([np.repeat(part, 3), faces.ravel()], 1), axis=0, return_inverse=True)
    count = np.bincount(corners[:, 0], minlength=parts)[:, None]
    centers = np.stack([np.bincount(corners[:, 0], points[corners[:, 1], k], parts) for k in range(3)], 1) / count
    return 0.97 * points[corners[:, 1]] + 0.03 * centers[corners[:, 0]], own.reshape(-1, 3).astype(np.int32)


def spread(points, count):
    """Numbers of points that are far from each other."""
    chosen = [int(np.linalg.norm(points - points.mean(0), axis=1).argmax())]
    far = np.full(len(points), np.inf)
    while len(chosen) < count:
        far = np.minimum(far, np.linalg.norm(points - points[chosen[-1]], axis=1))
        chosen.append(int(far.argmax()))
    return np.array(chosen)


def against(source, truth, target=None, percent=0.9, noise=0.0, make=None, beyond=None, cloud="", landmarks=0):
    """A pair. target: by default the truth with new triangles, of so many percent of the diagonal. beyond: a function of places,
    negative where nothing is left of the target. cloud: '', 'plain', 'with normals'."""
    points, faces = source
    there, corners = remeshed((truth, faces), percent) if target is None else target
    there = noisy(there, noise)
    normals = NONE
    if cloud == "with normals":
        ms = pymeshlab.MeshSet()
        ms.add_mesh(pymeshlab.Mesh(there, corners))
        ms.apply_filter("compute_normal_per_vertex")
        normals = ms.current_mesh().vertex_normal_matrix()
    if make is not None:
        there, corners = make(there, corners)
    if beyond is not None:
        there, corners = without(there, corners, beyond(there) < 0)
    if cloud:
        corners = np.zeros((0, 3), np.int32)
    has = np.ones(len(points), bool) if beyond is None else beyond(truth) >= 0
    chosen = spread(points, landmarks) if landmarks else np.zeros(0, int)
    return Pair(points, faces, truth, faces, there, corners, normals, has, chosen)
