# SPDX-License-Identifier: GPL-3.0-or-later
"""Odd input: each is taken as what it is, or is a TypeError or ValueError that says what to do."""
import inspect
import re
import warnings

import numpy as np
import pytest
from shapes import bar, same

import pymeshlab_fcd
from pymeshlab_fcd import Deformation, Deformer, Motion

V, F, T, LIFT = bar(31, 7)
N = len(V)


class AsMatrix:
    """As scipy's RigidTransform."""

    def as_matrix(self):
        return LIFT


class Broken:
    def __array__(self, dtype=None, copy=None):
        raise RuntimeError("it is on another device")


def nan_at(values, place, value=np.nan):
    changed = values.astype(float)
    changed[place] = value
    return changed


def mirrored():
    return np.diag([1, 1, -1, 1.0])


# What is changed in Deformer(vertices, faces, tags).pose({2: LIFT}), and the error and some words of it; None: it is taken.
CASES = {
    "vertices: one row": (dict(vertices=V[0]), ValueError, "vertices must be n x 3, one row per vertex; it is 3"),
    "vertices: flat": (dict(vertices=V[:, :2]), ValueError, "it is 217 x 2"),
    "vertices: a file": (dict(vertices="scan.ply"), TypeError, "an array of numbers; the text 'scan.ply' is none"),
    "vertices: transposed": (dict(vertices=V.T), ValueError, "it is 3 x 217"),
    "vertices: a number": (dict(vertices=1.0), TypeError, "neither an array of vertices nor a mesh"),
    "vertices: None": (dict(vertices=None), TypeError, "vertices is None"),
    "vertices: text": (dict(vertices="cat.ply"), TypeError, "vertices must be an array of numbers"),
    "vertices: objects": (dict(vertices=V.astype(object)), TypeError, r"an array of object is none. If all of it is numbers, use .astype\(np.float64\)"),
    "vertices: complex": (dict(vertices=V + 1j), TypeError, "complex128"),
    "vertices: ragged": (dict(vertices=[[0, 0, 0], [1, 1]]), TypeError, "vertices cannot be read as an array"),
    "vertices: a mask": (dict(vertices=V > 0), TypeError, "not a mask"),
    "vertices: none": (dict(vertices=V[:0], faces=None, tags=T[:0]), ValueError, "no handle"),
    "vertices: of a device": (dict(vertices=Broken()), TypeError, "on another device"),
    "vertices: NaN": (dict(vertices=nan_at(V, (100, 1))), ValueError, "100"),
    "vertices: inf": (dict(vertices=nan_at(V, (100, 1), np.inf)), ValueError, "100"),
    "vertices: 1e300": (dict(vertices=V * 1e300), (None, ValueError), ""),
    "vertices: 1e-300": (dict(vertices=V * 1e-300), (None, ValueError), ""),
    "vertices: half precision": (dict(vertices=V.astype(np.float16)), None, ""),
    "vertices: long doubles": (dict(vertices=V.astype(np.longdouble)), None, ""),
    "vertices: masked": (dict(vertices=np.ma.masked_array(V, V > 5)), ValueError, "masked values"),
    "vertices: not masked": (dict(vertices=np.ma.masked_array(V)), None, ""),
    "vertices: a memoryview": (dict(vertices=memoryview(V)), None, ""),
    "vertices: read-only": (dict(vertices=np.frombuffer(V.tobytes()).reshape(-1, 3)), None, ""),
    "faces: quads": (dict(faces=np.c_[F, F[:, 0]]), ValueError, "Split other polygons into triangles"),
    "faces: of pyvista": (dict(faces=np.c_[np.full(len(F), 3), F].ravel()), ValueError, "faces must be m x 3"),
    "faces: beyond": (dict(faces=F + 1), ValueError, "0 to 216; it holds 1 to 217"),
    "faces: negative": (dict(faces=F - 1), ValueError, "it holds -1 to"),
    "faces: 2^32 - 1": (dict(faces=np.where(F == 0, 2**32 - 1, F).astype(np.uint32)), ValueError, "4294967295"),
    "faces: 2^40": (dict(faces=F + 2**40), ValueError, "faces must hold numbers of vertices"),
    "faces: doubles": (dict(faces=F.astype(float)), TypeError, r"faces.astype\(np.int64\)"),
    "faces: none": (dict(faces=F[:0]), None, ""),
    "faces: text": (dict(faces="faces"), TypeError, "faces must be an array of numbers"),
    "tags: 2.7": (dict(tags=np.where(T == 2, 2.7, T)), ValueError, "that of vertex .* is 2.7"),
    "tags: 2.0": (dict(tags=T.astype(float)), None, ""),
    "tags: NaN": (dict(tags=nan_at(T, 5)), ValueError, "that of vertex 5 is nan"),
    "tags: inf": (dict(tags=nan_at(T, 5, np.inf)), ValueError, "tags must be below 2147483648"),
    "tags: 2^40": (dict(tags=np.where(T == 2, 2**40, T)), ValueError, "below 2147483648; that of vertex .* is 1099511627776"),
    "tags: -2^40": (dict(tags=np.where(T == 0, -(2**40), T)), None, ""),
    "tags: too few": (dict(tags=T[:-1]), ValueError, "tags must be 217 whole numbers, one for each vertex"),
    "tags: a column": (dict(tags=T[:, None]), ValueError, "it is 217 x 1"),
    "tags: one": (dict(tags=1), ValueError, "it is a single number"),
    "tags: a mask": (dict(tags=T == 2), TypeError, r"np.where\(mask, 2, 1\)"),
    "tags: masked": (dict(tags=np.ma.masked_array(T, T == 0)), ValueError, "tags has masked values"),
    "tags: None": (dict(tags=None), ValueError, "nothing is held: give tags"),
    "tags: text": (dict(tags=["free"] * N), TypeError, "tags must be an array of numbers"),
    "tags: all free": (dict(tags=np.ones(N)), ValueError, "There is no handle"),
    "tags: none free": (dict(tags=np.where(T == 1, 0, T)), ValueError, "nothing to deform"),
    "points: beyond": (dict(points=[N]), ValueError, "points must be numbers of vertices, 0 to 216"),
    "points: doubles": (dict(points=[1.0]), ValueError, "points must be n x 3"),
    "points: one": (dict(points=np.int64(5)), ValueError, "points must be numbers of vertices, or k x 3 places; it is a single number"),
    "points: NaN": (dict(points=[[np.nan, 0, 0]]), ValueError, "points must be finite"),
    "points: among none": (dict(vertices=V * np.nan, points=[[0, 0, 0]]), ValueError, "no finite coordinates"),
    "points: twice": (dict(points=[100, 100]), ValueError, "same place"),
    "points: fixed": (dict(points=[0]), ValueError, "fixed|held"),
    "points: None": (dict(points=None), None, ""),
    "points: none": (dict(points=[]), None, ""),
    "normals: too few": (dict(normals=V[:-1]), ValueError, "normals must have 217 rows"),
    "normals: NaN": (dict(normals=nan_at(V, (0, 0))), ValueError, "normals must be finite"),
    "normals: 1e300": (dict(normals=np.full((N, 3), 1e300)), ValueError, "scale them to length 1"),
    "normals: 0": (dict(normals=np.zeros((N, 3))), None, ""),
    "transforms: a matrix": (dict(transforms=LIFT), TypeError, "must be a mapping"),
    "transforms: None": (dict(transforms=None), None, ""),
    "transforms: another tag": (dict(transforms={3: LIFT}), ValueError, "no vertex has tag 3: the handles are 2"),
    "transforms: tag 1": (dict(transforms={1: LIFT}), ValueError, "must be from 2"),
    "transforms: 2^40": (dict(transforms={2**40: LIFT}), ValueError, "must be from 2 to 2147483647; it is 1099511627776"),
    "transforms: '2'": (dict(transforms={"2": LIFT}), TypeError, "must be a whole number; it is '2'"),
    "transforms: 2.0": (dict(transforms={2.0: LIFT}), TypeError, "must be a whole number; it is 2.0"),
    "transforms: True": (dict(transforms={True: LIFT}), TypeError, "must be a whole number"),
    "transforms: np.int8": (dict(transforms={np.int8(2): LIFT}), None, ""),
    "transforms: to None": (dict(transforms={2: None}), (TypeError, ValueError), "the motion of handle 2"),
    "transforms: 3 x 3": (dict(transforms={2: np.eye(3)}), ValueError, "the motion of handle 2: the matrix must be 4 x 4 numbers; it is 3 x 3"),
    "transforms: a way": (dict(transforms={2: [0, 0, 1]}), ValueError, r"Motion.translate"),
    "transforms: masked": (dict(transforms={2: np.ma.masked_array(LIFT, np.eye(4) > 0)}), ValueError, "the motion of handle 2: the matrix has masked"),
    "transforms: texts": (dict(transforms={2: LIFT.astype(str)}), TypeError, "the motion of handle 2: the matrix must be 4 x 4 numbers; an array of <U"),
    "transforms: NaN": (dict(transforms={2: LIFT * np.nan}), ValueError, "finite"),
    "transforms: rows": (dict(transforms={2: LIFT.T}), ValueError, "Transpose a matrix for row vectors"),
    "transforms: mirrors": (dict(transforms={2: mirrored()}), ValueError, "mirrors or flattens"),
    "transforms: text": (dict(transforms={2: "translate 0 0 1"}), TypeError, r"handle 2 is a text; give it as Motion.parse\('translate 0 0 1'\)"),
    "transforms: steps": (dict(transforms={2: Motion.parse("fly away")}), ValueError, "fly"),
    "transforms: as_matrix": (dict(transforms={2: AsMatrix()}), None, ""),
    "transforms: 1e300": (dict(transforms={2: Motion.translate([1e300, 0, 0])}), ValueError, "moves too far"),
    "landmarks: without points": (dict(landmarks=[[0, 0, 0]]), ValueError, "give the Deformer points"),
    "landmarks: too many": (dict(points=[100], landmarks=np.zeros((2, 3))), ValueError, "landmarks must have 1 rows"),
    "landmarks: NaN": (dict(points=[100], landmarks=[[np.nan, 0, 0]]), ValueError, "landmarks must be finite"),
    "landmarks: None": (dict(points=[100], landmarks=None), None, ""),
    "percent: text": (dict(percent="50"), TypeError, "percent must be a number; it is '50'"),
    "percent: NaN": (dict(percent=np.nan), ValueError, "finite number of percent"),
    "percent: 1e300": (dict(percent=1e300), (None, ValueError), ""),
    "percent: np.float32": (dict(percent=np.float32(50)), None, ""),
    "steps: 1.5": (dict(steps=1.5), TypeError, "steps must be a whole number"),
    "steps: 0": (dict(steps=0), ValueError, "steps must be from 1 to 1000"),
    "start: a number": (dict(start=1), TypeError, "start must be a Pose of this Deformer; it is a int"),
    "check: a word": (dict(check="no"), TypeError, "check must be True or False; it is 'no'"),
    "smoothness: text": (dict(smoothness="loose"), TypeError, "smoothness must be a number"),
    "smoothness: 10^400": (dict(smoothness=10**400), ValueError, "a number that a double holds"),
    "smoothness: negative": (dict(smoothness=-1), ValueError, "smoothness must be a finite number, 0 or more"),
    "patches: text": (dict(patches="600"), TypeError, "patches must be a whole number; it is '600'"),
    "patches: 600.0": (dict(patches=600.0), TypeError, "patches must be a whole number"),
    "patches: -1": (dict(patches=-1), ValueError, "patches must be from 0"),
    "patches: 2^31": (dict(patches=2**31), ValueError, "to 2147483647"),
    "target_radius: negative": (dict(target_radius=-1), ValueError, "radius"),
    "seed: negative": (dict(seed=-1), ValueError, "seed must be from 0"),
    "nodes: elsewhere": (dict(nodes=[[1e3, 0, 0]]), (None, ValueError), ""),
    "nodes: NaN": (dict(nodes=[[np.nan, 0, 0]]), ValueError, "nodes must be finite"),
    "graph_weights: a number": (dict(graph_weights=0), TypeError, "graph_weights must be one of 'border'"),
    "falloff: typo": (dict(falloff="steep"), ValueError, "falloff must be one of 'smooth', 'linear', 'sharp', 'constant'; it is 'steep'"),
    "rigidity: a word": (dict(rigidity="soft"), TypeError, "rigidity must be a number"),
    "rigidity: 2": (dict(rigidity=2), ValueError, "The rigidity must be from 0 to 1"),
    "rigidity: nearly 1": (dict(rigidity=0.9999), ValueError, "between 0.999 and 1 hardly comes to rest"),
    "rigidity: and elastic": (dict(rigidity=0, elastic=True), ValueError, "take one of them"),
    "rigidity: as printed": (dict(rigidity=0, graph_weights="printed"), ValueError, "take other graph weights"),
    "elastic: a word": (dict(elastic="yes"), TypeError, "elastic must be True or False"),
    "distances: typo": (dict(distances="surfaces"), ValueError, "distances must be one of 'surface', 'euclidean'; it is 'surfaces'"),
    "influence: 1": (dict(influence=1), ValueError, "above 1"),
    "loose_parts: None": (dict(loose_parts=None), TypeError, "loose_parts must be one of"),
    "weld_distance: 1": (dict(weld_distance=1), ValueError, "weld distance"),
    "max_iterations: 0": (dict(max_iterations=0), ValueError, "max_iterations must be from 1"),
    "tolerance: 0": (dict(tolerance=0), ValueError, "tolerance must be a positive"),
    "threads: -1": (dict(threads=-1), ValueError, "threads must be from 0 to 1024"),
    "progress: a number": (dict(progress=1), TypeError, "progress must be callable"),
    "a typo": (dict(initial_patches=600), TypeError, "initial_patches"),
}


@pytest.mark.parametrize("name", CASES)
def test_each_is_taken_or_an_error_that_says_what_to_do(name):
    change, error, words = CASES[name]
    given = {**dict(vertices=V, faces=F, tags=T, transforms={2: LIFT}), **change}
    given = {**given, "faces": None} if isinstance(given["vertices"], Broken) else given
    of_poses = {key: given.pop(key) for key in ("transforms", "landmarks", "percent", "steps", "start", "check") if key in given}
    if np.size(given.get("points", [])) > 0 and given["points"] is not None:  # beside what is fixed, but no handle
        given["tags"] = np.minimum(T, 1)
        of_poses["transforms"] = None
    before = [np.copy(array) for array in (V, F, T)]

    def run():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pymeshlab_fcd.DeformationWarning)
            pose = Deformer(**given).pose(**of_poses)
        assert np.isfinite(pose.vertices).all() and pose.vertices.shape == (N, 3)

    kinds = error if isinstance(error, tuple) else (error,)
    if kinds == (None,):
        run()
    elif None in kinds:
        try:
            run()
        except tuple(kind for kind in kinds if kind) as thrown:
            assert len(str(thrown)) > 20
    else:
        with pytest.raises(kinds, match=words) as thrown:
            run()
        assert len(str(thrown.value)) > 20
    assert all(same(a, b) for a, b in zip(before, (V, F, T)))


@pytest.mark.parametrize("make, error, words", [
    (lambda: Motion.translate([0, 0]), ValueError, "by must be 3 numbers; it is 2"), (lambda: Motion.translate("up"), TypeError, "by must be 3 numbers"),
    (lambda: Motion.rotate([0, 0, 0], 90), ValueError, "axis must have a length"), (lambda: Motion.rotate([0, 0, 1], np.inf), ValueError, "finite"),
    (lambda: Motion.rotate([0, 0, 1], [1, 2]), ValueError, "degrees must be a number; it is 2"), (lambda: Motion.translate(None), TypeError, "by is None"),
    (lambda: Motion.rotate([0, 0, 1], "90"), TypeError, "degrees must be a number; the text '90' is none"),
    (lambda: Motion.translate([True] * 3), TypeError, "mask"), (lambda: Motion.scale(0), ValueError, "greater than 0"),
    (lambda: Motion.scale([1, 2]), ValueError, "factors must be 3 numbers"), (lambda: Motion.parse(3), TypeError, "must be a text"),
    (lambda: Motion.parse("2: translate 0 0 1"), ValueError, "without its tag"), (lambda: Motion.scale(2).then(LIFT), TypeError, r"Motion.affine\(matrix\)")])
def test_motions_that_are_none(make, error, words):
    with pytest.raises(error, match=words):
        make()


@pytest.mark.parametrize("make, error, words", [
    (lambda: Deformation("bend.ply"), TypeError, r"Deformation.load\(path\)"), (lambda: Deformation(b""), ValueError, "no saved deformation"),
    (lambda: Deformation.load(3.5), TypeError, "float"), (lambda: Deformation.load("none.ply"), FileNotFoundError, "none.ply")])
def test_deformations_that_are_none(make, error, words):
    with pytest.raises(error, match=words):
        make()


def test_arrays_to_write_to_that_are_others():
    deformer, out = Deformer(V, F, T, copy=False), np.empty_like(V)
    for array in (V, out):
        with pytest.raises(ValueError, match="must be another array than"):
            deformer.pose({2: LIFT}, out=out, out_normals=array)
    with pytest.raises(ValueError, match="out must be C-contiguous"):
        deformer.pose({2: LIFT}, out=np.asfortranarray(out))
    with pytest.raises(ValueError, match="a cloud has no normals of its own"):
        Deformer(V, tags=T).pose({2: LIFT}, out_normals=out)


def test_a_pose_of_another_is_no_start():
    other = Deformer(V, F, T).pose({2: LIFT})
    with pytest.raises(TypeError, match="it is one of another"):
        Deformer(V, F, T).pose({2: LIFT}, start=other)
    other.deformer.__init__(V, F, T, patches=50)  # a Deformer that is made anew: another surface, though the same object
    with pytest.raises(ValueError, match="start is a pose of another surface"):
        other.deformer.pose({2: LIFT}, percent=50, start=other)
    with pytest.raises(ValueError, match="an array has another number of rows"):
        other.deformer._prepared.normals_of(V[1:], np.empty_like(V[1:]))


class Odd:
    """Something that nobody asks for."""


ODD = [None, 5, -1, 2**70, 1.5, float("nan"), "a\ud800", "x\0y", b"ply", True, [], [[]], {}, {"a": object()}, object(), Odd, np.float32(3), np.array(7), np.zeros((2, 3)),
       np.array([None]), (1, 2), range(3), 1j]


def callables():
    """Each public function and method, and what to call it with."""
    deformer, fitter = Deformer(V, F, T, patches=40), pymeshlab_fcd.Fitter(V, F, patches=40, samples=100, steps=2)
    pose, poses = deformer.pose({2: LIFT}), pymeshlab_fcd.PoseSequence({"a": {2: LIFT}})
    line = [[0, 0.5, 0], [10, 0.5, 0]]
    yield from [(Deformer, dict(vertices=V, faces=F, tags=T)), (pymeshlab_fcd.deform, dict(vertices=V, faces=F, tags=T, transforms={2: LIFT})),
                (pymeshlab_fcd.Fitter, dict(vertices=V, faces=F, patches=40)), (deformer.pose, dict(transforms={2: LIFT})),
                (pymeshlab_fcd.fit, dict(vertices=V, faces=F, target_vertices=V, target_faces=F, patches=40, samples=100, steps=2)),
                (fitter.fit, dict(target_vertices=V, target_faces=F)), (pymeshlab_fcd.straighten, dict(vertices=V, faces=F, line=line)),
                (pose.map, dict(points=V)), (pose.stretch, {}), (pose.deformation, {}), (pose.discretisation_error, {}), (deformer.weights, {}),
                (pymeshlab_fcd.PoseSequence, dict(poses={"a": {2: LIFT}})), (pymeshlab_fcd.PoseSequence.parse, dict(text=poses.text())),
                (pymeshlab_fcd.PoseSequence.load, {}), (poses.text, {}), (poses.save, {}), (poses.weights_at, {}),
                (poses.blend, dict(deformer=deformer, weights={"a": 50})), (lambda **given: list(poses.frames(**given)), dict(deformer=deformer, rate=1)),
                (poses.write, dict(deformer=deformer, rate=1)), (Deformation, dict(content=b"")), (Deformation.load, {}), (pose.deformation(), dict(xyz=V)),
                (Motion, {}), (Motion.translate, {}), (Motion.rotate, dict(axis=[0, 0, 1], degrees=5)), (Motion.scale, {}), (Motion.affine, {}),
                (Motion.parse, {}), (Motion().then, {}), (pymeshlab_fcd.KeyFrame, dict(time=1))]


@pytest.mark.filterwarnings("ignore")
def test_no_message_is_the_binding_s(tmp_path, monkeypatch):
    """Whatever is given for a parameter: what is not taken is an error of these kinds, in words that are ours, or numpy's."""
    monkeypatch.chdir(tmp_path)
    names = {"frames": ("rate", "check", "deformer")}
    for function, given in callables():
        try:
            parameters = [each.name for each in inspect.signature(function).parameters.values() if each.kind is not each.VAR_KEYWORD] or names["frames"]
        except ValueError:
            parameters = list(given)
        for name in parameters:
            for odd in ODD:
                try:
                    function(**{**given, name: odd})
                except (TypeError, ValueError, OSError, RuntimeError) as error:
                    words = str(error)
                    assert len(words) > 10 and not re.search(r"incompatible function arguments|std::|nanobind|_core|Invoked with|argument types", words), (
                        function, name, odd, words)
    assert not [path for path in tmp_path.iterdir() if path.suffix == ".part"]
