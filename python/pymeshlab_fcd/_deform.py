# SPDX-License-Identifier: GPL-3.0-or-later
"""Deforming in one call."""
from __future__ import annotations

from numpy.typing import ArrayLike

from . import _inputs
from ._deformation import Deformation
from ._deformer import Deformer, Distances, Falloff, GraphWeights, LooseParts, Transforms, renamed_weights
from ._inputs import Points
from ._meshes import MeshLike
from ._pose import Pose
from ._progress import Progress, report, shared


def _posed(vertices: ArrayLike | MeshLike, faces: ArrayLike | None, tags: ArrayLike | None, transforms: Transforms | None,
           landmarks: ArrayLike | None, percent: float, steps: int, progress: Progress, points: ArrayLike | None,
           parameters: dict[str, object]) -> Pose:
    told = shared(progress)
    deformer = Deformer(vertices, faces, tags, points, progress=report(told, 0, 75), **parameters)  # type: ignore[arg-type]
    return deformer._pose(transforms, landmarks, percent, steps, None, None, None, True, report(told, 75, 100), 5)


def deform(
    vertices: ArrayLike | MeshLike,
    faces: ArrayLike | None = None,
    tags: ArrayLike | None = None,
    transforms: Transforms | None = None,
    points: ArrayLike | None = None,
    *,
    landmarks: ArrayLike | None = None,
    percent: float = 100.0,
    steps: int = 1,
    smoothness: float = 0.0058,
    falloff: Falloff = "smooth",
    elastic: bool = False,
    rigidity: float = 1.0,
    patches: int = 0,
    target_radius: float = 0.0,
    seed: int = 1,
    nodes: ArrayLike | None = None,
    graph_weights: GraphWeights = "border",
    distances: Distances = "surface",
    influence: float = 4.0,
    loose_parts: LooseParts = "follow",
    weld_distance: float = 1e-6,
    max_iterations: int = 1000,
    tolerance: float = 1e-5,
    threads: int = 0,
    progress: Progress = None,
    weights: Distances | None = None,
) -> Points:
    """Deforms a mesh or a cloud in one call.

    Parameters
    ----------
    vertices : array_like or mesh
        n x 3, or a mesh of trimesh, pyvista, Open3D or pymeshlab.
    faces : array_like, optional
        m x 3 numbers of vertices; None: a cloud, or what the mesh has.
    tags : array_like, optional
        n whole numbers: 0 fixed, 1 free, 2 and up handles, negative outside.
    transforms : Transforms, optional
        `{tag: 4 x 4 matrix or Motion}`; other handles stay.
    points : array_like, optional
        Landmarks: k numbers of free vertices, or k x 3 places.
    landmarks : array_like, optional
        k x 3, where the points go.
    percent, steps
        As in [Deformer.pose][pymeshlab_fcd.Deformer.pose].
    smoothness, falloff, elastic, rigidity, patches, target_radius, seed, nodes, graph_weights, distances, influence
        As in [Deformer][pymeshlab_fcd.Deformer].
    loose_parts, weld_distance, max_iterations, tolerance, threads, progress, weights
        As in [Deformer][pymeshlab_fcd.Deformer].

    Returns
    -------
    ndarray
        The positions, n x 3: the same bits as those of the filter `generate_fcd_deformed_mesh`.

    Raises
    ------
    ValueError
        An argument has the wrong shape, or is out of range, nothing is free, there is no handle, or a coordinate is not finite.

    Warns
    -----
    DeformationWarning
        You probably did not mean this: nothing moves, flipped triangles, the shape did not converge.
    """
    return _posed(vertices, faces, tags, transforms, landmarks, percent, steps, progress, points, dict(
        smoothness=smoothness, falloff=falloff, elastic=elastic, rigidity=rigidity, patches=patches, target_radius=target_radius, seed=seed, nodes=nodes, graph_weights=graph_weights,
        distances=renamed_weights(distances, weights, 3), influence=influence, loose_parts=loose_parts, weld_distance=weld_distance,
        max_iterations=max_iterations, tolerance=tolerance, threads=threads))._vertices.given_away()


def deformation(
    vertices: ArrayLike | MeshLike,
    faces: ArrayLike | None = None,
    tags: ArrayLike | None = None,
    transforms: Transforms | None = None,
    points: ArrayLike | None = None,
    *,
    landmarks: ArrayLike | None = None,
    percent: float = 100.0,
    steps: int = 1,
    smoothness: float = 0.0058,
    falloff: Falloff = "smooth",
    elastic: bool = False,
    rigidity: float = 1.0,
    patches: int = 0,
    target_radius: float = 0.0,
    seed: int = 1,
    nodes: ArrayLike | None = None,
    graph_weights: GraphWeights = "border",
    distances: Distances = "surface",
    influence: float = 4.0,
    loose_parts: LooseParts = "follow",
    weld_distance: float = 1e-6,
    max_iterations: int = 1000,
    tolerance: float = 1e-5,
    accuracy: float = 0.0,
    threads: int = 0,
    progress: Progress = None,
    weights: Distances | None = None,
) -> Deformation:
    """Like [deform][pymeshlab_fcd.deform], but returns a deformation of space that you apply to other points: solve on a thinned scan,
    then move all of it.

    Parameters
    ----------
    vertices, faces, tags, transforms, points, landmarks, percent, steps
        As in [deform][pymeshlab_fcd.deform].
    smoothness, falloff, elastic, rigidity, patches, target_radius, seed, nodes, graph_weights, distances, influence
        As in [Deformer][pymeshlab_fcd.Deformer].
    loose_parts, weld_distance, max_iterations, tolerance, threads, progress, weights
        As in [Deformer][pymeshlab_fcd.Deformer].
    accuracy : float, default 0.0
        How far a vertex may be off at most, in world units; 0: a fiftieth of the largest motion, at most a ten-thousandth of the diagonal
        of the part that moves.

    Returns
    -------
    Deformation
        The same as the filter `save_fcd_deformation` saves, to the bit. Its `largest_difference` tells how far a vertex is off at most.

    Warns
    -----
    DeformationWarning
        As in [deform][pymeshlab_fcd.deform], which also tells the errors, and where vertices are farther off than the accuracy.
    """
    told, least = shared(progress), _inputs.accuracy(accuracy)
    pose = _posed(vertices, faces, tags, transforms, landmarks, percent, steps, report(told, 0, 60), points, dict(
        smoothness=smoothness, falloff=falloff, elastic=elastic, rigidity=rigidity, patches=patches, target_radius=target_radius, seed=seed, nodes=nodes, graph_weights=graph_weights,
        distances=renamed_weights(distances, weights, 3), influence=influence, loose_parts=loose_parts, weld_distance=weld_distance,
        max_iterations=max_iterations, tolerance=tolerance, threads=threads))
    return pose._deformation(report(told, 60, 100), 3, least)
