# SPDX-License-Identifier: GPL-3.0-or-later
"""Symmetry: restores sheared, bent or pressed shapes by their own mirror image."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _inputs
from ._deformer import Deformer
from ._fit import Fitter
from ._inputs import Points
from ._meshes import MeshLike
from ._numbers import lengths, plain, told_shape
from ._pose import Pose
from ._progress import Progress, report, shared
from ._warnings import FoldWarning, LandmarkWarning, NotAtRestWarning, SymmetryWarning, Told, triangles_turned, warn

PlaneFrom = Literal["given", "landmarks", "surface"]
_NONE: Final = np.zeros(0, np.int64)


@dataclass(frozen=True)
class SymmetryInfo:
    """How asymmetric a surface was, and the result. Lengths are in units of the vertices."""

    plane: tuple[tuple[float, float, float], tuple[float, float, float]]
    """The plane of symmetry: a point on it, and its normal, of length 1."""
    plane_from: PlaneFrom
    """`given`; by pairs and midline (`landmarks`); or the plane in which the surface is most like its mirror image (`surface`)."""
    is_sure: bool
    """False: the surface is nearly as much like its mirror image in another plane."""
    before: float
    """Distance of the surface from its own mirror image, root mean square over the nearest nine tenths of what has a counterpart."""
    after: float
    """The same for the result."""
    asymmetry: float
    """Distance of places from the mirror images of their counterparts, root mean square. Symmetry is half of it away."""
    asymmetry_most: float
    """The largest of these distances."""
    moved: float
    """How far the surface was moved, root mean square."""
    moved_most: float
    """The largest move."""
    matched: float
    """Share of the counting surface that has a counterpart on the other side, 0 to 1."""
    guessed: float
    """Share of the surface without a counterpart, which was carried along, 0 to 1."""
    guess_error: float
    """Estimated error of the guessed surface, root mean square; not a number if that cannot be told."""
    contradicted: tuple[int, ...]
    """Numbers, from 0, of the pairs that the others contradict; the midline's points are counted on after the pairs."""
    pairs: int
    """Number of pairs."""
    midline: int
    """Number of points of the midline."""
    converged: bool
    """Whether the fit onto the mirror image came to rest."""


class OtherSide(NamedTuple):
    """Mirror images of the parts without a counterpart on the other side."""

    vertices: Points
    """k x 3."""
    faces: NDArray[np.int64] | None
    """m x 3 numbers of these vertices, facing outwards as on the surface; None for a cloud."""
    source: NDArray[np.int64]
    """k: for each, the number of the surface's vertex that it mirrors."""


class Symmetrized(Pose):
    """A surface that was made symmetric, by [symmetrize][pymeshlab_fcd.symmetrize]. It has all that a [Pose][pymeshlab_fcd.Pose] has. Its `map`
    carries other surfaces of the same scan along, and its `deformation` can be saved."""

    _against_contact = "Give pairs, or look at those given, or raise stiffness."
    _symmetry: SymmetryInfo
    _mirrored: Points
    _matched: NDArray[np.bool_]

    @property
    def symmetry(self) -> SymmetryInfo:
        """How asymmetric it was, and the result."""
        return self._symmetry

    @property
    def mirrored(self) -> Points:
        """n x 3, read-only: for each vertex, the mirror image of its counterpart on the given surface."""
        return self._mirrored

    @property
    def matched(self) -> NDArray[np.bool_]:
        """n flags, read-only: whether a vertex has a counterpart on the other side."""
        return self._matched

    @property
    def asymmetry(self) -> NDArray[np.float64]:
        """n distances, in units of the vertices, of each vertex from the mirror image of its counterpart. 0 is symmetric."""
        return lengths(self._mirrored - self.deformer.vertices)

    def other_side(self) -> OtherSide:
        """Mirror images of the parts without a counterpart: of a mesh, the faces without a matched corner; of a cloud, the points. Join
        them with the surface, and the good side fills a hole or a missing part of the other."""
        (point, normal), vertices = np.asarray(self._symmetry.plane), self.vertices
        chosen = ~self._matched
        faces = self.deformer.faces
        lonely = None if faces is None else faces[chosen[faces].all(axis=1)]
        source = np.flatnonzero(chosen) if lonely is None else np.unique(lonely)
        places = vertices[source] - 2 * ((vertices[source] - point) @ normal)[:, None] * normal
        number = np.zeros(len(vertices), np.int64)
        number[source] = np.arange(len(source))
        return OtherSide(places, None if lonely is None else number[lonely][:, ::-1], source.astype(np.int64))

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "symmetry": self._symmetry, "mirrored": self._mirrored, "matched": self._matched}

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._symmetry, self._mirrored, self._matched = state["symmetry"], state["mirrored"], state["matched"]
        self._mirrored.flags.writeable = self._matched.flags.writeable = False

    def __repr__(self) -> str:
        found = self._symmetry
        return (f"<Symmetrized of {len(self.deformer.vertices)} vertices, {found.before:g} from its mirror image, now {found.after:g}"
                f"{'' if found.converged else ', not converged'}>")


def _marks(deformer: Deformer, name: str, values: ArrayLike | None) -> tuple[NDArray[np.int64], Points]:
    """Landmarks: numbers of vertices, k, and places, k x 3."""
    given = _NONE if values is None else _inputs.points(values, len(deformer.vertices), name)
    if given.ndim == 1:
        numbers = np.asarray(given, np.int64)
        return numbers, np.asarray(deformer.vertices[numbers], np.float64)
    places = np.asarray(given, np.float64)
    return _core.nearest_vertices(deformer.vertices, places, deformer._threads, None), places


def _ends(values: ArrayLike | None) -> NDArray[Any] | None:
    """The ends of pairs (k x 2 or k x 2 x 3), as 2 k or 2 k x 3."""
    array: NDArray[Any] = _NONE if values is None else plain("pairs", values)
    if array.size == 0:
        return None
    shape: tuple[int, ...] = array.shape
    if len(shape) not in (2, 3) or shape[1] != 2 or len(shape) == 2 and array.dtype.kind not in "iu" or shape[2:] not in ((), (3,)):
        raise ValueError(f"pairs must be k x 2 whole numbers of vertices, or k x 2 x 3 places, left and right; it is {told_shape(array)} of {array.dtype}")
    return array.reshape(2 * len(array), *array.shape[2:])


def symmetrize(
    vertices: ArrayLike | MeshLike,
    faces: ArrayLike | None = None,
    *,
    plane: ArrayLike | None = None,
    pairs: ArrayLike | None = None,
    midline: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    normals: ArrayLike | None = None,
    stiffness: float = 1.0,
    largest_distance: float = 0.0,
    landmark_tolerance: float = 0.0,
    patches: int = 150,
    smoothness: float = 0.0058,
    seed: int = 1,
    samples: int = 6000,
    steps: int = 50,
    threads: int = 0,
    progress: Progress = None,
) -> Symmetrized:
    """Restores the symmetry of a mesh or a cloud that was sheared, bent or pressed. The surface is fitted onto its own mirror image, first by a
    smooth warp of all of it, then by local deformations. The result is half-way. Parts without a counterpart on the other side are carried
    along.

    Rotations are halved in angle, so bent parts keep their length. Deformations that are equal on both sides, such as flattening, cannot be
    seen, and stay.

    Parameters
    ----------
    vertices : array_like or mesh
        n x 3, or a mesh of trimesh, pyvista, Open3D or pymeshlab.
    faces : array_like, optional
        m x 3 numbers of vertices; None: a cloud, or what the mesh has.
    plane : array_like, optional
        2 x 3: a point on the plane of symmetry, and its normal. None: the plane of `pairs` and `midline`; if they do not tell one, the plane
        in which the surface is most like its mirror image.
    pairs : array_like, optional
        k x 2 numbers of vertices, or k x 2 x 3 places, left and right. The vertices become exact mirror images of each other; a place stands
        for the vertex nearest to it.
    midline : array_like, optional
        k numbers of vertices, or k x 3 places, that belong on the plane. The vertices end exactly there.
    weights : array_like, optional
        n numbers from 0 to 1, or a mask: how much each vertex counts. Vertices of weight 0 are carried along, such as a growth on one side.
        None: all count.
    normals : array_like, optional
        n x 3, at rest. They turn with the surface, and tell the sides of a cloud apart. None: those of its faces.
    stiffness : float, default 1.0
        How rigid the surface is against local deformations in the end, 1e-6 to 1e6: 1 is the default, 10 is stiff.
    largest_distance : float, default 0.0
        A place farther than this from the mirror image, in units of the vertices, has no counterpart there. 0: no limit.
    landmark_tolerance : float, default 0.0
        How far a landmark may stay from its target, in units of the vertices. Above 0, landmarks that the others contradict are left out of the
        fit.
    patches, smoothness, seed, samples, steps, threads, progress
        As in [Fitter][pymeshlab_fcd.Fitter].

    Returns
    -------
    Symmetrized
        The new vertices, `Symmetrized.vertices`, and how asymmetric the surface was, `Symmetrized.symmetry` and `asymmetry`.

    Raises
    ------
    ValueError
        An argument has the wrong shape, or is out of range, a vertex is named twice as a landmark, the plane has no direction, no plane is better
        than any other, or nothing has a counterpart.
    RuntimeError
        The fit has no solution in double precision: the surface may be as thin as a line.

    Warns
    -----
    DeformationWarning
        The plane is not sure, little has a counterpart, landmarks contradict each other, triangles are flipped, or the fit did not converge.
    """
    told = shared(progress)
    fitter = Fitter(vertices, faces, normals=normals, weights=weights, stiffness=stiffness, largest_distance=largest_distance,
                    landmark_tolerance=landmark_tolerance, patches=patches, smoothness=smoothness, seed=seed, samples=samples, steps=steps,
                    threads=threads, progress=report(told, 0, 20))
    deformer = fitter.deformer
    ends, middle = _marks(deformer, "pairs", _ends(pairs)), _marks(deformer, "midline", midline)
    goal: dict[str, Any] = {
        "plane": None if plane is None else _inputs.finite("plane", _inputs.rows("plane", plane, 2, "a point and a normal")),
        "vertex": np.concatenate([ends[0], middle[0]]), "place": np.concatenate([ends[1], middle[1]]), "pairs": len(ends[0]) // 2,
    }
    counts = _inputs.weights(weights, len(deformer.vertices))
    solved, places, mirrored, matched, found = deformer._fitting.symmetrize(goal, deformer._rest_normals, counts, report(told, 20, 90))
    if found["matched"] == 0:
        raise ValueError("nothing of the surface has a counterpart on its other side: give pairs, a midline or the plane, or raise "
                         "largest_distance")
    diagonal, contradiction = found.pop("diagonal"), found.pop("contradiction")
    made = Symmetrized(deformer, solved)
    made._symmetry = SymmetryInfo(**found)
    made._mirrored, made._matched = mirrored, matched
    mirrored.flags.writeable = matched.flags.writeable = False
    made._write(None, None, None, lambda at: np.copyto(at, places))
    warn(_words(made, made._check(report(told, 90, 100))["folded"], diagonal, contradiction), 2)
    made._warn_of_contact(3)
    return made


def _words(made: Symmetrized, folded: int, diagonal: float, contradiction: str) -> list[Told]:
    """Warnings of what not to trust."""
    told, found = made.symmetry, list[Told]()
    if not told.is_sure:
        found.append((SymmetryWarning, "The surface is nearly as much like its mirror image in another plane. Look at the plane; if it is "
                                       "wrong, give pairs, a midline or the plane itself."))
    if told.after > told.before + 1e-6 * diagonal:  # more than rounding
        found.append((SymmetryWarning, "The result is farther from its mirror image than the surface was: the plane is probably wrong. "
                                       "Give pairs, a midline or another plane."))
    if told.matched < 0.3:  # most of the shape is a guess
        found.append((SymmetryWarning, f"Only {100 * told.matched:.3g} percent of the surface have a counterpart on the other side: do not "
                                       "trust the rest. Give pairs or a midline."))
    elif told.guessed > 0.05 and told.guess_error > 0.01 * diagonal:  # 1 %: no hand misses so much
        found.append((SymmetryWarning, f"{100 * told.guessed:.3g} percent of the surface have no counterpart on the other side: their "
                                       f"place is a guess that may be off by about {told.guess_error:.3g}."))
    if contradiction:
        found.append((LandmarkWarning, contradiction))
    if folded > 0:
        found.append((FoldWarning, f"{triangles_turned(folded)}: the surface is folded there. Give pairs, or look at those given, or raise stiffness."))
    if not told.converged:
        found.append((NotAtRestWarning, "The fit onto the mirror image did not converge: raise steps."))
    return found
