# SPDX-License-Identifier: GPL-3.0-or-later
"""What becomes of arrays later, in the caller's hands: no object changes by it, or it says so."""
import gc
import os
import pickle
import subprocess
import sys
import threading
import weakref
from pathlib import Path

import numpy as np
import pytest
from shapes import bar, same

import pymeshlab_fcd
from pymeshlab_fcd import Deformer


@pytest.fixture(scope="module")
def bent():
    vertices, faces, tags, lift = bar()
    deformer = Deformer(vertices, faces, tags)
    return deformer, deformer.pose({2: lift})


def test_arrays_are_copied_or_lent():
    vertices, faces, tags, lift = bar()
    corners = faces.astype(np.int32)
    own = Deformer(vertices, corners, tags, normals=vertices)
    assert not np.shares_memory(own.vertices, vertices) and not np.shares_memory(own.faces, corners)
    lent = Deformer(vertices, corners, tags, normals=vertices, copy=False)
    assert np.shares_memory(lent.vertices, vertices) and not np.shares_memory(lent.faces, corners)  # a wrong corner would end Python
    assert same(lent.pose({2: lift}).vertices, own.pose({2: lift}).vertices)
    with pytest.raises(ValueError, match="out must be another array than what the Deformer refers to"):
        lent.pose({2: lift}, out=vertices)


def test_what_is_lent_and_changed_says_so():
    vertices, faces, tags, lift = bar()
    deformer = Deformer(vertices, faces, tags, normals=np.tile([0, 0, 1.0], (len(vertices), 1)), copy=False)
    pose = deformer.pose({2: lift})
    points = vertices[::9].copy()
    expected = pose.map(points)
    for place, value in (((3, 1), 0.5), ((len(vertices) - 1, 2), 1e-300), ((0, 0), -0.0), ((7, 0), np.nan)):
        before = vertices[place]
        vertices[place] = value
        for look in (lambda: deformer.vertices, lambda: deformer.pose({2: lift}), lambda: pose.map(points), pose.stretch, pose.deformation,
                     lambda: deformer.weights(), lambda: pickle.dumps(deformer)):
            with pytest.raises(ValueError, match="vertices has been changed since it was given with copy=False"):
                look()
        vertices[place] = before
        assert same(pose.map(points), expected)
    vertices[[5, 6]] = vertices[[6, 5]]
    with pytest.raises(ValueError, match="vertices has been changed"):
        pose.normals
    vertices.resize((7, 3), refcheck=False)
    with pytest.raises(ValueError, match="vertices has been changed"):
        deformer.pose({2: lift})


def test_a_pose_in_an_array_of_the_caller_tells_when_that_is_used_again():
    vertices, faces, tags, lift = bar()
    deformer, out, normals = Deformer(vertices, faces, tags), np.empty_like(vertices), np.empty_like(vertices)
    own, half = deformer.pose({2: lift}), deformer.pose({2: lift}, percent=50)
    first = deformer.pose({2: lift}, out=out, out_normals=normals)
    assert same(first.stretch(), own.stretch()) and same(first.normals, own.normals)
    second = deformer.pose({2: lift}, percent=50, out=out, out_normals=normals)
    for look in (lambda: first.vertices, first.stretch, lambda: first.info, lambda: pickle.dumps(first)):
        with pytest.raises(ValueError, match=r"written to \(out\) has been written to since: pose again"):
            look()
    with pytest.raises(ValueError, match=r"written to \(out_normals\) has been written to since"):
        first.normals
    assert same(first.map(vertices), own.map(vertices)) and first.deformation() == own.deformation()  # which need no array
    assert same(second.stretch(), half.stretch()) and same(second.vertices, half.vertices) and same(second.normals, half.normals)
    out += 1
    with pytest.raises(ValueError, match="has been written to since"):
        second.stretch()
    assert np.isfinite(deformer.pose({2: lift}, out=vertices).vertices).all()  # what is copied may be overwritten


@pytest.mark.parametrize("of", [lambda d, p: d.vertices, lambda d, p: d.faces, lambda d, p: d.points, lambda d, p: d.graph.nodes,
                                lambda d, p: d.graph.edges, lambda d, p: d.graph.radius, lambda d, p: d.graph.centers, lambda d, p: d.patch_of,
                                lambda d, p: p.vertices, lambda d, p: p.normals, lambda d, p: p.nodes, lambda d, p: p.node_maps])
def test_arrays_of_an_object_are_read_only(bent, of):
    array = of(*bent)
    for change in (lambda: array.__setitem__(Ellipsis, 0), lambda: array.setflags(write=True)):
        with pytest.raises(ValueError, match="read-only|WRITEABLE"):
            change()
    assert same(of(*bent), array)


def test_a_pose_is_freed_where_it_is_dropped(bent):
    """Also where its figures are kept, which can still be asked."""
    gc.disable()
    try:
        pose = bent[0].pose({2: bar()[3]})
        info, gone = pose.info, weakref.ref(pose)
        pose.normals, pose.nodes, repr(pose)
        del pose
        assert gone() is None and info.discretisation_error == bent[1].discretisation_error()
    finally:
        gc.enable()


def test_attributes_cannot_be_set(bent):
    for thing in bent:
        for name in ("vertices", "faces", "points", "handles", "deformer", "normals"):
            if hasattr(type(thing), name):
                with pytest.raises(AttributeError):
                    setattr(thing, name, np.zeros((5, 3)))
    with pytest.raises(TypeError):
        bent[0].centers[5] = (0, 0, 0)
    vertices, faces, tags, lift = bar()
    mine = pymeshlab_fcd.deform(vertices, faces, tags, {2: lift})
    mine += 1  # what no object has is the caller's


SPOILT = r"""
import gc, sys, warnings
import numpy as np
sys.path.insert(0, sys.argv[1])
from shapes import bar
import pymeshlab_fcd as fcd
warnings.simplefilter("ignore")

def spoil(*arrays):  # changes each, frees it, and has its memory used again
    for array in arrays:
        array[...] = np.full(array.shape, 123456789 if array.dtype.kind in "iu" else 0).astype(array.dtype)
        if array.flags.owndata:
            array.resize(1, refcheck=False)
    del arrays, array
    gc.collect()
    return [np.full(size, -7777777, kind) for size in (4545, 8400, 1515, 3) for kind in (np.int32, np.int64, float)]

def given(kind):
    vertices, faces, tags, lift = bar()
    normals, points = np.tile([0, 0, 1.0], (len(vertices), 1)).copy(), np.array([700, 1400])
    return [vertices, faces.astype(kind), tags.astype(kind), lift, normals, points]

def all_of(pose):
    return [pose.vertices.copy(), pose.normals.copy(), pose.stretch(), pose.map(np.ones((5, 3))), pose.nodes.copy(), pose.deformation(), repr(pose)]

def same(one, other):
    return one.tobytes() == other.tobytes() if isinstance(one, np.ndarray) else one == other

for kind in (np.int32, np.uint32, np.int64):
    made = []
    for spoils in (False, True):
        kept = []
        vertices, faces, tags, lift, normals, points = given(kind)
        nodes = vertices[200:1400:100].copy()
        deformer = fcd.Deformer(vertices, faces, np.minimum(tags, 1), points, normals=normals, nodes=nodes)
        if spoils:
            kept += spoil(vertices, faces, tags, normals, points, nodes)
        targets = deformer.vertices[[700, 1400]] + [0, 0, 2.0]
        lead = deformer.pose(landmarks=targets)
        if spoils:
            kept += spoil(targets)
        weights = deformer.weights()
        found = all_of(lead) + [weights.data.copy(), deformer.graph.nodes, deformer.patch_of]
        found += [deformer.weights().data]

        vertices, faces, tags, lift, normals, points = given(kind)
        deformer = fcd.Deformer(vertices, faces, tags)
        motion = {2: lift}
        pose = deformer.pose(motion)
        poses = fcd.PoseSequence({"up": motion})
        if spoils:
            kept += spoil(vertices, faces, tags, lift)
            motion.clear()
        found += all_of(pose) + all_of(deformer.pose({2: fcd.Motion.translate([0, 0, 1])}, start=pose)) + all_of(poses.blend(deformer, {"up": 50}))
        mapped, turned = np.ones((9, 3)), np.ones((9, 3))
        moved = pose.map(mapped, turned) + pose.deformation()(mapped, turned)
        if spoils:
            kept += spoil(mapped, turned)
        found += list(moved)

        vertices, faces, tags, lift, normals, points = given(kind)
        target, corners = deformer.vertices + [0, 0.02, 0.1], faces.copy()
        places = target[points].copy()
        fitter = fcd.Fitter(vertices, faces, normals=normals, patches=40, samples=300, steps=10)
        if spoils:
            kept += spoil(vertices, faces, normals)
        fitted = fitter.fit(target, corners, landmarks=(points, places))
        if spoils:
            kept += spoil(target, corners, points, places)
        found += all_of(fitted)

        vertices, faces, tags, lift, normals, points = given(kind)
        line = np.array([[0, 0.5, 0], [5, 0.5, 0], [10, 0.5, 0]])
        bent = fcd.straighten(vertices, faces, line, degrees=40, towards=[0, 0, 1], normals=normals)
        if spoils:
            kept += spoil(vertices, faces, line, normals)
        found += all_of(bent)
        made.append(found)
    assert len(made[0]) == len(made[1]) and all(map(same, *made)), [i for i, pair in enumerate(zip(*made)) if not same(*pair)]
print("whole")
"""


def test_arguments_may_be_changed_freed_and_their_memory_used_again():
    done = subprocess.run([sys.executable, "-c", SPOILT, str(Path(__file__).parent)], capture_output=True, text=True, timeout=300,
                          env={**os.environ, "MALLOC_PERTURB_": "165"})  # glibc then fills what is freed
    assert done.returncode == 0 and done.stdout == "whole\n", (done.returncode, done.stderr[-2000:])


def test_faces_that_another_thread_writes_to_do_no_harm():
    vertices, faces, tags, _ = bar()
    corners, stop = faces.astype(np.int32), threading.Event()
    right = corners.copy()

    def write():
        while not stop.is_set():
            corners[:] = 2**31 - 1
            corners[:] = right

    thread = threading.Thread(target=write)
    thread.start()
    try:
        for _ in range(30):
            try:
                Deformer(vertices, corners, tags, patches=50)
            except ValueError as error:
                assert "faces must hold numbers of vertices" in str(error)
    finally:
        stop.set()
        thread.join()


def test_nothing_of_an_object_can_be_assigned(bent):
    for each, names in (bent[0], ("vertices", "info", "graph", "centers", "patch_of", "new")), (bent[1], ("vertices", "info", "nodes", "node_maps")):
        for name in names:
            with pytest.raises(AttributeError, match=f"{name} cannot be changed: a .* does not change"):
                setattr(each, name, 1)
            with pytest.raises(AttributeError, match="does not change"):
                delattr(each, name)
    weights = bent[0].weights()
    for array in (weights.indptr, weights.indices, weights.data):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
