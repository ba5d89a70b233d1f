# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that are sent to other processes: by pickle, multiprocessing, joblib and Dask."""
import copy
import dataclasses
import multiprocessing
import pickle
import warnings

import numpy as np
import pytest
from shapes import bar, same

import pymeshlab_fcd as fcd
from pymeshlab_fcd import Deformer, Fitter, KeyFrame, Motion, PoseSequence, compensate, straighten

VERTICES, FACES, TAGS, LIFT = bar()
TURN = Motion.rotate([0, 1, 0], -200).then(Motion.translate([-2, 0, 3]))
LINE = [[0, 0.5, 0], [5, 0.5, 0], [10, 0.5, 0]]


@pytest.mark.filterwarnings("ignore::pymeshlab_fcd.DeformationWarning")
def test_all_that_is_public_can_be_sent_and_copied():
    deformer, fitter = Deformer(VERTICES, FACES, TAGS), Fitter(VERTICES, FACES, patches=40, samples=300)
    pose, fitted = deformer.pose({2: LIFT}), fitter.fit(VERTICES + 0.1, FACES)
    bent, even = straighten(VERTICES, FACES, LINE), fcd.symmetrize(VERTICES, FACES)
    printed, poses = compensate(VERTICES, FACES, VERTICES * 1.01, FACES), PoseSequence({"up": {2: LIFT}}, [KeyFrame(0), KeyFrame(1, {"up": 100})])
    found = [deformer, deformer.graph, deformer.weights(), deformer.info, fitter, pose, pose.info, pose.contact, pose.deformation(), pose.deformation().grid(2), fitted,
             fitted.info, bent, bent.line, even, even.symmetry, even.other_side(), printed, printed.info, poses, poses.keys[0], TURN, fcd.Look(),
             fcd.Companion(VERTICES), fcd.Curve("rim", VERTICES[:3], VERTICES[:3]), fcd.FrameContact(0, 1, 0.5),
             fcd.AnimationInfo(**dict.fromkeys(fcd.AnimationInfo.__dataclass_fields__, 0))]
    found += [each("why") for each in vars(fcd).values() if isinstance(each, type) and issubclass(each, Warning)]
    assert {type(each) for each in found} == {each for each in vars(fcd).values() if isinstance(each, type)}
    for thing in found:
        for other in [*sent(thing), copy.copy(thing), copy.deepcopy(thing)]:
            assert type(other) is type(thing) and len(repr(other)) > 0


def sent(thing):
    """As another process gets it, in bytes of its own or in buffers beside them."""
    buffers = []
    whole = pickle.loads(pickle.dumps(thing))
    beside = pickle.loads(pickle.dumps(thing, protocol=5, buffer_callback=buffers.append), buffers=buffers)
    assert type(whole) is type(beside) is type(thing)
    return [whole, beside]


def told(pose):
    return (pose.vertices, pose.normals, pose.stretch(), pose.map(VERTICES + 0.01), pose.nodes, pose.node_maps)


def expect_same(pose, other):
    assert all(same(a, b) for a, b in zip(told(pose), told(other)))
    assert dataclasses.replace(pose.info, seconds=0) == dataclasses.replace(other.info, seconds=0) and repr(pose) == repr(other)
    assert pose.deformation() == other.deformation()
    assert pose.deformation(inverse=True) == other.deformation(inverse=True)
    np.testing.assert_equal(other.info.discretisation_error, pose.info.discretisation_error)


@pytest.mark.filterwarnings("ignore::pymeshlab_fcd.DeformationWarning")
@pytest.mark.parametrize("given", [
    dict(), dict(faces=None), dict(normals=VERTICES + 1), dict(copy=False), dict(graph_weights="printed", smoothness=0.01), dict(threads=1), dict(falloff="constant"), dict(elastic=True), dict(rigidity=0.5),
    dict(tags=np.minimum(TAGS, 1), points=VERTICES[[700, 1400]] + 1e-3), dict(tags=np.minimum(TAGS, 1), points=[700, 1400])])
def test_deformers_and_poses(given):
    deformer = Deformer(**{**dict(vertices=VERTICES, faces=FACES, tags=TAGS), **given})
    motion = dict(landmarks=VERTICES[[700, 1400]] + [0, 0, 2]) if "points" in given else dict(transforms={2: TURN})
    pose = deformer.pose(**motion)
    for other in sent(deformer):
        assert same(other.vertices, deformer.vertices) and other.handles == deformer.handles and same(other.points, deformer.points)
        assert same(other.graph.nodes, deformer.graph.nodes) and repr(other) == repr(deformer)
        again = other.pose(**motion)
        assert same(again.vertices, pose.vertices)
        if "normals" in given or deformer.faces is not None:
            expect_same(pose, again)
    for other in sent(pose):
        assert same(other.vertices, pose.vertices) and other.deformer._ready is None  # which nothing has asked for yet
        if "normals" in given or deformer.faces is not None:
            expect_same(pose, other)
        on, expected = (each.deformer.pose(**motion, percent=80, start=each) for each in (other, pose))
        assert same(on.vertices, expected.vertices)
        assert same(sent(other)[0].vertices, pose.vertices)
        with pytest.raises(ValueError, match="read-only"):
            other.vertices[0] = 0


def test_nothing_is_prepared_again_for_what_is_known():
    pose = Deformer(VERTICES, FACES, TAGS).pose({2: LIFT})
    pose.info, pose.normals, pose.discretisation_error()
    other = sent(pose)[0]
    assert same(other.vertices, pose.vertices) and same(other.normals, pose.normals) and "converged" in repr(other)
    assert other.discretisation_error() == pose.discretisation_error() and other.deformer._ready is None
    info = pickle.loads(pickle.dumps(pose.info))
    assert info == pose.info and info.discretisation_error == pose.info.discretisation_error


@pytest.mark.filterwarnings("ignore::pymeshlab_fcd.DeformationWarning")
def test_fitters_and_fits():
    target = VERTICES @ np.array([[1, 0, 0.1], [0, 1, 0], [-0.1, 0, 1]]) + [0, 0, 0.05]
    fitter = Fitter(VERTICES, FACES, patches=40, samples=300, steps=10)
    fitted = fitter.fit(target, FACES, landmarks=([0, 1500], target[[0, 1500]]))
    for other in sent(fitter):
        assert same(other.fit(target, FACES, landmarks=([0, 1500], target[[0, 1500]])).vertices, fitted.vertices) and repr(other) == repr(fitter)
    for other in sent(fitted):
        np.testing.assert_equal(other.info.__getstate__() | {"_error": 0}, fitted.info.__getstate__() | {"_error": 0})
        assert same(other.vertices, fitted.vertices) and same(other.map(VERTICES), fitted.map(VERTICES))
        assert other.deformation() == fitted.deformation()


@pytest.mark.filterwarnings("ignore::pymeshlab_fcd.DeformationWarning")
def test_lines_and_sequences():
    bent = straighten(VERTICES, FACES, LINE, degrees=40, towards=[0, 0, 1])
    for other in sent(bent):
        expect_same(bent, other)
        assert other.line == bent.line
    poses = PoseSequence({"up, \"high\"": {2: TURN}, "aside": "2: translate 0 0.1 0"}, [KeyFrame(0), KeyFrame(1 / 3, {"aside": 100 / 7}, "hold")])
    deformer = Deformer(VERTICES, FACES, TAGS)
    for other in sent(poses):
        assert other.poses == poses.poses and other.keys == poses.keys and other.text(deformer) == poses.text(deformer)
    of_it = PoseSequence.parse(poses.text(deformer))
    for other in sent(of_it):  # they are still those of this surface
        assert other.poses == poses.poses
        with pytest.raises(ValueError, match="another"):
            other.blend(Deformer(VERTICES + 100, FACES, TAGS), {"aside": 5})
    blended = poses.blend(deformer, {"aside": 100})
    for other in sent(blended):
        expect_same(blended, other)


def damaged(state):
    """With a bit of one byte changed, in the places where sizes stand, and in others."""
    for at in (*range(20, 60), len(state) // 2, len(state) - 1):
        yield state[:at] + bytes([state[at] ^ 0x80]) + state[at + 1:]


def test_compensations():
    made = compensate(VERTICES, FACES, VERTICES @ np.diag([1.01, 1, 1]) + [0, 0, 0.1], FACES, degree=2, threads=1)
    for other in [*sent(made), copy.copy(made), copy.deepcopy(made), sent(sent(made)[0])[1]]:
        assert other.info == made.info and repr(other) == repr(made)
        assert same(other.vertices, made.vertices) and same(other.change, made.change)
        assert same(other.map(VERTICES + 0.01), made.map(VERTICES + 0.01)) and same(other.predict(VERTICES), made.predict(VERTICES))
        with pytest.raises(ValueError, match="read-only"):
            other.vertices[0] = 0
    state = made.__getstate__()
    for way in (b"", b"fcd pose 3\n", b"fcd compensation 2\n", state["way"][:-1], state["way"] + b"x", *damaged(state["way"])):
        with pytest.raises(ValueError, match="kept by another version of this package, or is damaged: compensate the part anew"):
            copy.copy(made).__setstate__({**state, "way": way})


def test_copies():
    deformer = Deformer(VERTICES, FACES, TAGS)
    pose = deformer.pose({2: LIFT})
    for thing in (copy.copy(pose), copy.deepcopy(pose), copy.deepcopy(deformer).pose({2: LIFT})):
        assert same(thing.vertices, pose.vertices) and same(thing.stretch(), pose.stretch())


def test_what_is_no_pose_of_this_version_says_so():
    pose = Deformer(VERTICES, FACES, TAGS).pose({2: LIFT})
    state = pose.__getstate__()
    whole = pose._core.state()
    for solved in (b"", b"fcd pose 0\n", whole[:-1], whole + b"x", b"fcd pose 1\n" + b"\xff" * 100, *damaged(whole)):
        other = copy.copy(pose)
        other.__setstate__({**state, "solved": fcd._pose._Solved(pose.deformer, solved)})
        with pytest.raises(ValueError, match="another version of this package, or is damaged: pose the surface anew"):
            other.stretch()
    coarse = Deformer(VERTICES, FACES, TAGS, patches=50)
    other.__setstate__({**state, "solved": fcd._pose._Solved(coarse, pose._core.state())})
    with pytest.raises(ValueError, match="one of another surface, or of another version"):
        other.stretch()


class Unpicklable:
    """As those of Open3D, whose meshes cannot be pickled."""

    vertices, faces = VERTICES, FACES

    def copy(self):
        return Unpicklable()

    def __reduce_ex__(self, protocol):
        raise TypeError("cannot pickle")


def test_a_mesh_that_cannot_be_pickled_is_left_behind():
    pose = Deformer(Unpicklable(), tags=TAGS).pose({2: LIFT})
    assert same(pose.mesh().vertices, pose.vertices)
    for other in sent(pose):
        assert same(other.vertices, pose.vertices)
        with pytest.raises(ValueError, match="cannot be pickled .a Unpicklable., and was left behind"):
            other.mesh()
        with pytest.raises(ValueError, match="was left behind"):
            sent(other)[0].mesh()
    trimesh = pytest.importorskip("trimesh")
    pose = Deformer(trimesh.Trimesh(VERTICES, FACES, process=False), tags=TAGS).pose({2: LIFT})
    assert same(np.asarray(sent(pose)[0].mesh().vertices), pose.vertices)


def posed(deformer, percent):
    return deformer.pose({2: LIFT}, percent=percent)


@pytest.mark.parametrize("method", ["spawn", "fork"])
def test_multiprocessing(method):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip("not on this system")
    deformer = Deformer(VERTICES, FACES, TAGS, threads=1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of forks, where there are threads
        with multiprocessing.get_context(method).Pool(2) as pool:
            poses = pool.starmap(posed, [(deformer, percent) for percent in (10, 100)])
    assert all(same(pose.vertices, posed(deformer, percent).vertices) for pose, percent in zip(poses, (10, 100)))


def test_joblib():
    joblib = pytest.importorskip("joblib")
    deformer = Deformer(VERTICES, FACES, TAGS, threads=1)
    poses = joblib.Parallel(n_jobs=2)(joblib.delayed(posed)(deformer, percent) for percent in (10, 100))
    assert same(poses[1].vertices, posed(deformer, 100).vertices)
    assert joblib.hash(deformer) == joblib.hash(Deformer(VERTICES.copy(), FACES, TAGS, threads=1))


def test_dask():
    distributed = pytest.importorskip("dask.distributed")
    deformer = Deformer(VERTICES, FACES, TAGS, threads=1)
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster, distributed.Client(cluster) as client:
        shared = client.scatter(deformer)
        poses = client.gather([client.submit(Deformer.pose, shared, {2: LIFT}, percent=percent) for percent in (10, 100)])
    assert same(poses[1].vertices, posed(deformer, 100).vertices) and same(poses[1].stretch(), posed(deformer, 100).stretch())
