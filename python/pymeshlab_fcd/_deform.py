# SPDX-License-Identifier: GPL-3.0-or-later
"""Deforming in one call."""
from __future__ import annotations

from numpy.typing import ArrayLike

from . import _inputs
from ._deformation import Deformation
from ._deformer import Deformer, GraphWeights, LooseParts, Transforms, Weighing
from ._inputs import Points
from ._pose import Pose
from ._progress import Progress, report, shared


def _posed(vertices: object, faces: ArrayLike | None, tags: ArrayLike | None, transforms: Transforms | None, landmarks: ArrayLike | None,
           percent: float, steps: int, progress: Progress, points: ArrayLike | None, parameters: dict[str, object]) -> Pose:
    told = shared(progress)
    deformer = Deformer(vertices, faces, tags, points, progress=report(told, 0, 75), **parameters)  # type: ignore[arg-type]
    return deformer._pose(transforms, landmarks, percent, steps, None, None, None, True, report(told, 75, 100), 5)


def deform(
    vertices: ArrayLike | object,
    faces: ArrayLike | None = None,
    tags: ArrayLike | None = None,
    transforms: Transforms | None = None,
    points: ArrayLike | None = None,
    *,
    landmarks: ArrayLike | None = None,
    percent: float = 100.0,
    steps: int = 1,
    smoothness: float = 0.0058,
    patches: int = 0,
    target_radius: float = 0.0,
    seed: int = 1,
    nodes: ArrayLike | None = None,
    graph_weights: GraphWeights = "border",
    weights: Weighing = "surface",
    influence: float = 4.0,
    loose_parts: LooseParts = "follow",
    weld_distance: float = 1e-6,
    max_iterations: int = 1000,
    tolerance: float = 1e-5,
    threads: int = 0,
    progress: Progress = None,
) -> Points:
    """Deforms a mesh or a cloud in one call: what [Deformer][pymeshlab_fcd.Deformer] and its
    [pose][pymeshlab_fcd.Deformer.pose] do, where all parameters are explained.

    Args:
        vertices: n x 3, or a mesh of trimesh, pyvista, Open3D or pymeshlab.
        faces: m x 3 numbers of vertices; None: a cloud, or what the mesh has.
        tags: n whole numbers: 0 fixed, 1 free, 2 and up handles, negative outside.
        transforms: `{tag: 4 x 4 matrix or Motion}`; other handles stay.
        points: Landmarks: k numbers of free vertices, or k x 3 places.
        landmarks: k x 3, where the points go.
        percent: How much of all motions is carried out.
        steps: The pose is reached over so many.
        smoothness: 0.001 is loose, 0.1 is stiff.
        patches: How many patches to begin with; 0: 300, or 4800 where the surface is so thin or torn that it needs them.
        target_radius: How far a patch may reach; 0: automatic.
        seed: Chooses where the first patches are.
        nodes: k x 3, centres of patches to use instead.
        graph_weights: `border`, `uniform`, `paper` or `printed`.
        weights: `surface` or `euclidean`.
        influence: How far a node reaches, in radii of its patch.
        loose_parts: `follow` or `stay`.
        weld_distance: Fraction of the diagonal up to which vertices on open borders count as one.
        max_iterations: The shape is improved at most this often.
        tolerance: When it is at rest, a fraction of the diagonal.
        threads: How many to use; 0 is one a core.
        progress: Told what is being done; see [Progress][pymeshlab_fcd.Progress].

    Returns:
        The positions, n x 3: the same bits as those of the filter `generate_fcd_deformed_mesh`.

    Raises:
        TypeError: Something is of another kind than what is asked for here.
        ValueError: It has another shape or is out of range, nothing is free, there is no handle, or a coordinate is not finite.
        KeyboardInterrupt: Ctrl-C, at once; nothing is half done.

    Warns:
        DeformationWarning: What is probably not meant: nothing moves, triangles turned over, the shape did not come to rest.
    """
    return _posed(vertices, faces, tags, transforms, landmarks, percent, steps, progress, points, dict(
        smoothness=smoothness, patches=patches, target_radius=target_radius, seed=seed, nodes=nodes, graph_weights=graph_weights,
        weights=weights, influence=influence, loose_parts=loose_parts, weld_distance=weld_distance, max_iterations=max_iterations,
        tolerance=tolerance, threads=threads)).vertices


def deformation(
    vertices: ArrayLike | object,
    faces: ArrayLike | None = None,
    tags: ArrayLike | None = None,
    transforms: Transforms | None = None,
    points: ArrayLike | None = None,
    *,
    landmarks: ArrayLike | None = None,
    percent: float = 100.0,
    steps: int = 1,
    smoothness: float = 0.0058,
    patches: int = 0,
    target_radius: float = 0.0,
    seed: int = 1,
    nodes: ArrayLike | None = None,
    graph_weights: GraphWeights = "border",
    weights: Weighing = "surface",
    influence: float = 4.0,
    loose_parts: LooseParts = "follow",
    weld_distance: float = 1e-6,
    max_iterations: int = 1000,
    tolerance: float = 1e-5,
    accuracy: float = 0.0,
    threads: int = 0,
    progress: Progress = None,
) -> Deformation:
    """The same as [deform][pymeshlab_fcd.deform] as a deformation of space, to be applied to other points: deform a thinned scan,
    then all of it.

    Args:
        vertices: n x 3, or a mesh of trimesh, pyvista, Open3D or pymeshlab.
        faces: m x 3 numbers of vertices; None: a cloud, or what the mesh has.
        tags: n whole numbers: 0 fixed, 1 free, 2 and up handles, negative outside.
        transforms: `{tag: 4 x 4 matrix or Motion}`; other handles stay.
        points: Landmarks: k numbers of free vertices, or k x 3 places.
        landmarks: k x 3, where the points go.
        percent: How much of all motions is carried out.
        steps: The pose is reached over so many.
        smoothness: 0.001 is loose, 0.1 is stiff.
        patches: How many patches to begin with; 0: 300, or 4800 where the surface is so thin or torn that it needs them.
        target_radius: How far a patch may reach; 0: automatic.
        seed: Chooses where the first patches are.
        nodes: k x 3, centres of patches to use instead.
        graph_weights: `border`, `uniform`, `paper` or `printed`.
        weights: `surface` or `euclidean`.
        influence: How far a node reaches, in radii of its patch.
        loose_parts: `follow` or `stay`.
        weld_distance: Fraction of the diagonal up to which vertices on open borders count as one.
        max_iterations: The shape is improved at most this often.
        tolerance: When it is at rest, a fraction of the diagonal.
        accuracy: How far a vertex may be off at most, in world units; 0: a fiftieth of the largest motion, at most a ten-thousandth of
            the diagonal of what moves.
        threads: How many to use; 0 is one a core.
        progress: Told what is being done; see [Progress][pymeshlab_fcd.Progress].

    Returns:
        What `save_fcd_deformation` saves of the same, to the bit. Its `largest_difference` tells how far a vertex is off at most.

    Raises:
        TypeError: Something is of another kind than what is asked for here.
        ValueError: It has another shape or is out of range, nothing is free, there is no handle, or a coordinate is not finite.
        KeyboardInterrupt: Ctrl-C, at once; nothing is half done.

    Warns:
        DeformationWarning: As of [deform][pymeshlab_fcd.deform], and where vertices are farther off than the accuracy.
    """
    told, least = shared(progress), _inputs.accuracy(accuracy)
    pose = _posed(vertices, faces, tags, transforms, landmarks, percent, steps, report(told, 0, 60), points, dict(
        smoothness=smoothness, patches=patches, target_radius=target_radius, seed=seed, nodes=nodes, graph_weights=graph_weights,
        weights=weights, influence=influence, loose_parts=loose_parts, weld_distance=weld_distance, max_iterations=max_iterations,
        tolerance=tolerance, threads=threads))
    return pose._deformation(report(told, 60, 100), 3, least)
