# SPDX-License-Identifier: GPL-3.0-or-later
"""Deformer and Pose: arrays in, arrays out, without MeshLab."""
import concurrent.futures
import os
import signal
import subprocess
import sys
import threading
import time
import types
import warnings
from pathlib import Path

import numpy as np
import pytest
from shapes import bar, same

import pymeshlab_fcd
import pymeshlab_fcd as fcd
from pymeshlab_fcd import DeformationWarning, Deformer, Motion


@pytest.fixture(scope="module")
def bent():
    vertices, faces, tags, lift = bar()
    deformer = Deformer(vertices, faces, tags)
    return deformer, deformer.pose({2: lift})


def finger(n=120, m=40):
    """A tube along x with its phalanges as tags; what closes it by so many degrees."""
    s, a = np.meshgrid(np.linspace(0, 80, n), np.linspace(0, 2 * np.pi, m, endpoint=False) + 0.01, indexing="ij")
    vertices = np.stack([s.ravel(), 8 * np.cos(a).ravel(), 8 * np.sin(a).ravel()], 1)
    i, k = np.arange(n - 1)[:, None] * m, np.arange(m)
    a, b = (i + k).ravel(), (i + (k + 1) % m).ravel()
    tags = np.where(vertices[:, 0] < 32, 0, np.where(vertices[:, 0] > 48, 2, 1))
    return vertices, np.r_[np.c_[a, b, a + m], np.c_[b, b + m, a + m]], tags, lambda degrees: {2: Motion.rotate([0, 1, 0], -degrees, about=[40, 0, 0])}


@pytest.mark.filterwarnings("ignore::pymeshlab_fcd.ContactWarning")
def test_the_depth_grows_as_the_surface_moves():
    """Both sides of a crease may be one piece, which is cut off only if no vertex leads out of it. Here, one did from 147 degrees on."""
    s, a = np.meshgrid(np.linspace(0, 100, 100), np.linspace(0, 2 * np.pi, 40, endpoint=False) + 0.01, indexing="ij")
    vertices = np.stack([s.ravel(), 8 * np.cos(a).ravel(), 8 * np.sin(a).ravel()], 1)
    faces = finger(100)[1]
    deformer = Deformer(vertices, faces, np.where(vertices[:, 0] < 42, 0, np.where(vertices[:, 0] > 58, 2, 1)))
    depth = [deformer.pose({2: Motion.rotate([0, 1, 0], -degrees, about=[50, 0, 0])}, steps=8, check=False).contact.largest_depth
             for degrees in range(140, 156, 2)]
    assert 7 < depth[0] and (np.diff(depth) > 0).all() and np.diff(depth).max() < 0.5


def test_a_finger_that_closes_into_its_palm_is_told(monkeypatch):
    vertices, faces, tags, close = finger()
    deformer = Deformer(vertices, faces, tags)
    with pytest.warns(pymeshlab_fcd.ContactWarning, match="triangles pass through others") as told:
        pose = deformer.pose(close(160), steps=10)
    assert told[0].filename == __file__
    contact = pose.contact  # which does not warn again
    inside = (tags == 2) & (np.abs(pose.vertices[:, 0] - 16) < 16) & (np.hypot(pose.vertices[:, 1], pose.vertices[:, 2]) < 7.5)
    assert inside.sum() > 100 and (contact.depth[inside] > 0.3).all()
    # The deepest comes out where it went in, nowhere else: no farther than the tube is wide.
    assert contact.triangles == len(contact.faces) > 100 and contact.pairs >= contact.triangles / 2
    assert 5 < contact.largest_depth == contact.depth.max() < 16 and contact.depth.dtype == np.float64
    assert (pose.info.contact, pose.info.contact_depth) == (contact.triangles, contact.largest_depth)
    assert str(contact).startswith(f"<Contact of {contact.triangles} triangles, up to ")
    with pytest.raises(ValueError, match="read-only"):
        contact.depth[0] = 1
    assert deformer.pose(close(60)).contact.triangles == 0
    cloud = Deformer(vertices, None, tags).pose(close(160), steps=10, check=False)
    assert cloud.contact.triangles == cloud.info.contact == 0 and (cloud.contact.depth == 0).all()

    monkeypatch.setattr(pymeshlab_fcd._pose, "UNASKED", 1000)  # as of a large surface: told where it is asked for
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        large, other = (deformer.pose(close(160), steps=10) for _ in range(2))
    with pytest.warns(pymeshlab_fcd.ContactWarning) as told:
        assert large.contact.triangles == contact.triangles
    assert [each.filename for each in told] == [__file__]
    with pytest.warns(pymeshlab_fcd.ContactWarning) as told:
        assert other.info.contact == contact.triangles
    assert [each.filename for each in told] == [__file__]


def test_a_motion_is_free_up_to_contact():
    vertices, faces, tags, close = finger()
    deformer, told = Deformer(vertices, faces, tags), []
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # what is tried on the way is not told of
        free = deformer.percent_to_contact(close(160), steps=10, progress=lambda percent, stage: told.append(percent))
        assert 40 < free < 99 and free == round(free) and told == sorted(told)
        assert deformer.pose(close(160), percent=free, steps=10).contact.triangles == 0
        assert deformer.percent_to_contact(close(60)) == 100 and deformer.percent_to_contact(close(60), percent=50) == 50
        assert Deformer(vertices, None, tags).percent_to_contact(close(160)) == 100  # a cloud
    with pytest.warns(pymeshlab_fcd.ContactWarning):
        assert deformer.pose(close(160), percent=free + 1, steps=10).contact.triangles > 0
    assert deformer.percent_to_contact(close(160), percent=200, steps=10) == pytest.approx(free, abs=2)


def test_an_animation_tells_in_which_frames_there_is_contact(tmp_path):
    vertices, faces, tags, close = finger()
    deformer, sequence = Deformer(vertices, faces, tags), pymeshlab_fcd.PoseSequence({"closed": close(160)})
    with pytest.warns(pymeshlab_fcd.ContactWarning, match="of 9 frames, triangles pass through others") as told:
        info = sequence.write(deformer, pc2=tmp_path / "a.pc2", rate=8)
    assert told[0].filename == __file__ and 0 < len(info.contacts) < 9
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        frames = [(time, pose.contact) for time, pose in sequence.frames(deformer, rate=8)]
    assert [(time, each.triangles, each.largest_depth) for time, each in frames if each.triangles] == list(info.contacts)
    assert f"{info.contacts[0].triangles} at {info.contacts[0].time:g} s" in str(told[0].message)


def test_a_fit_that_passes_through_itself_is_told():
    vertices, faces, tags, close = finger()
    with pytest.warns(pymeshlab_fcd.ContactWarning) as told:
        fitted = pymeshlab_fcd.fit(vertices, faces, tags=np.where(tags == 1, 1, tags), transforms=close(160), landmarks=([50 * 40], vertices[[50 * 40]]),
                                   landmarks_only=True)
    assert fitted.info.contact > 20 and told[-1].filename == __file__


def lifted(vertices, lift):
    return vertices @ lift[:3, :3].T + lift[:3, 3]


def face_normals(vertices, faces):
    """Angle-weighted normals of vertices, another way."""
    sums = np.zeros_like(vertices)
    p = vertices[faces]
    cross = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    unit = cross / np.linalg.norm(cross, axis=1, keepdims=True)
    for k in range(3):
        a, b = p[:, (k + 1) % 3] - p[:, k], p[:, (k + 2) % 3] - p[:, k]
        angle = np.arccos(np.clip((a * b).sum(1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1), -1, 1))
        np.add.at(sums, faces[:, k], unit * angle[:, None])
    return sums / np.linalg.norm(sums, axis=1, keepdims=True)


# --- the method ---


def test_import_needs_numpy_alone():
    code = ("import sys; sys.modules['pymeshlab'] = None; before = set(sys.modules); import pymeshlab_fcd; "
            "print(sorted({name.split('.')[0] for name in set(sys.modules) - before if hasattr(sys.modules[name], '__file__') and "
            "'site-packages' in str(sys.modules[name].__file__)}))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert set(eval(done.stdout)) <= {"numpy", "pymeshlab_fcd", "pymeshlab_fcd_plugin"}


def test_what_is_held_is_exact_and_the_rest_follows(bent):
    vertices, faces, tags, lift = bar()
    deformer, pose = bent
    assert same(pose.vertices[tags == 0], vertices[tags == 0])
    assert np.abs(pose.vertices[tags == 2] - lifted(vertices[tags == 2], lift)).max() < 1e-12
    assert pose.info.converged and pose.info.folded == 0 and pose.info.nodes == deformer.info.nodes > 100
    assert 1 < pose.info.largest_stretch < 1.05 and pose.info.seconds > 0
    assert 0 < pose.info.discretisation_error < 0.01
    assert (deformer.info.fixed, deformer.info.handle, deformer.info.free) == (150, 150, 1215)
    assert same(pymeshlab_fcd.deform(vertices, faces, tags, {2: lift}), pose.vertices)


def test_what_is_elastic_keeps_its_volume():
    vertices, faces, tags, closed = finger(m=40)

    def volume(at):
        ends = [(at[:40], 1), (at[-40:], -1)]
        caps = [np.stack([np.roll(ring, -way, 0), ring, np.broadcast_to(ring.mean(0), ring.shape)], 1) for ring, way in ends]
        return np.linalg.det(np.concatenate([at[faces], *caps])).sum() / 6

    plain, kept = Deformer(vertices, faces, tags), Deformer(vertices, faces, tags, elastic=True)
    for motion in (closed(60), {2: Motion.translate([5, 0, 0])}):
        before, after = (each.pose(motion).vertices for each in (plain, kept))
        assert abs(volume(before) / volume(vertices) - 1) > 0.02 and abs(volume(after) / volume(vertices) - 1) < 0.002
        assert np.array_equal(after[tags != 1], before[tags != 1])
    assert kept.info.unenclosed == 0
    with pytest.warns(fcd.VolumeWarning, match="The volume of the free surface is off by [0-9]+ percent"):
        kept.pose({2: Motion.translate([60, 0, 0])}).info


def test_a_loose_part_stretches_as_what_it_follows():
    vertices, faces, _, _ = bar()
    part = (vertices - vertices.mean(0)) * 0.04 + vertices.max(0) + [-3, 0, 0.1]
    both, all_faces = np.concatenate([vertices, part]), np.concatenate([faces, faces + len(vertices)])
    tags = np.ones(len(both), int)
    points = np.arange(0, len(vertices), 101)
    tags[points] = np.arange(len(points)) + 2
    pose = Deformer(both, all_faces, tags, rigidity=0).pose({int(tags[i]): Motion.translate(both[i]) for i in points})
    assert np.abs(np.ptp(pose.vertices, 0) / np.ptp(both, 0) - 2).max() < 1e-3
    assert np.abs(np.ptp(pose.vertices[len(vertices):], 0) / np.ptp(part, 0) - 2).max() < 1e-3


def test_landmarks_of_what_was_sheared_lead_it_without_rigidity():
    vertices, faces, _, _ = bar()
    points = np.arange(0, len(vertices), 101)
    sheared = vertices @ [[1, 0, 0], [0.3, 1.1, 0], [0.1, -0.2, 0.9]] + [1, 2, 3]

    def off(truth, rigidity):
        pose = Deformer(vertices, faces, points=points, rigidity=rigidity).pose(landmarks=truth[points])
        assert pose.info.converged
        return np.linalg.norm(pose.vertices - truth, axis=1).max() / np.linalg.norm(np.ptp(vertices, 0))

    assert off(sheared, 0) < 1e-7 < 1e-3 < min(off(sheared, 0.1), off(sheared, 1))
    bent = sheared + 0.02 * (sheared[:, :1] - 5)**2 * [0, 0, 1]
    assert off(bent, 0) < 0.5 * off(bent, 1)
    one, two = (Deformer(vertices, faces, points=points, rigidity=0, threads=threads).pose(landmarks=bent[points]).vertices for threads in (1, 3))
    assert same(one, two)


@pytest.mark.parametrize("as_given", [
    lambda v, f, t: (v.astype(">f8"), f.astype(">i4"), t.astype(">i2")), lambda v, f, t: (np.asfortranarray(v), np.asfortranarray(f), t.astype(float)),
    lambda v, f, t: (np.repeat(v, 2, 0)[::2], f.astype(np.uint64), np.repeat(t, 3)[::3]), lambda v, f, t: (v.tolist(), f.tolist(), t.tolist()),
    lambda v, f, t: (v[::-1], len(v) - 1 - f, t[::-1]), lambda v, f, t: (np.frombuffer(v.tobytes()).reshape(-1, 3), f.astype(np.int16), t.astype(np.int8))])
def test_any_numbers_in_any_layout(as_given):
    vertices, faces, tags, lift = bar()
    pose = Deformer(*as_given(vertices, faces, tags)).pose({2: lift}).vertices
    if same(np.asarray(as_given(vertices, faces, tags)[0], float)[0], vertices[0]):
        assert same(pose, Deformer(vertices, faces, tags).pose({2: lift}).vertices)
    else:  # another order: the same shape
        assert np.abs(pose[::-1] - Deformer(vertices, faces, tags).pose({2: lift}).vertices).max() < 0.05


def test_floats_of_single_precision():
    vertices, faces, tags, lift = bar()
    single = vertices.astype(np.float32)
    assert same(pymeshlab_fcd.deform(single, faces, tags, {2: lift}), pymeshlab_fcd.deform(single.astype(float), faces, tags, {2: lift}))


def test_a_cloud():
    vertices, faces, tags, lift = bar()
    deformer = Deformer(vertices, tags=tags, normals=np.tile([0, 0, 2.0], (len(vertices), 1)))
    pose = deformer.pose({2: lift})
    assert deformer.faces is None and same(pose.vertices[tags == 0], vertices[tags == 0])
    assert np.abs(pose.normals[tags == 2] - 2 * lift[:3, 2]).max() < 1e-5
    with pytest.raises(ValueError, match="a cloud has no normals of its own"):
        Deformer(vertices, tags=tags).pose({2: lift}).normals


# --- poses ---


def test_any_pose_is_that_of_a_deformation_anew(bent):
    vertices, faces, tags, lift = bar()
    for percent in (0, 30, 100, -50, 30):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            assert same(bent[0].pose({2: lift}, percent=percent).vertices, pymeshlab_fcd.deform(vertices, faces, tags, {2: lift}, percent=percent))
    assert same(bent[0].pose({2: lift}, percent=0).vertices, vertices)


def test_motions_are_matrices_or_steps(bent):
    vertices, _, tags, _ = bar()
    turn = Motion.rotate([0, 0, 1], 30, about=[9, 0.5, 0]).then(Motion.translate([0, 0, 2]))
    matrix = np.eye(4)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    matrix[:2, :2] = [[c, -s], [s, c]]
    matrix[:3, 3] = np.array([9, 0.5, 2]) - matrix[:3, :3] @ [9, 0.5, 0]
    assert np.abs(bent[0].pose({2: turn}).vertices - bent[0].pose({2: matrix}).vertices).max() < 1e-6
    whole = bent[0].pose({2: Motion.rotate([1, 0, 0], 360)}, percent=50).vertices
    assert np.abs(whole[tags == 2][:, 1].mean() - 0.5) < 1e-9 and np.abs(whole - vertices).max() > 0.5
    grown = bent[0].pose({2: Motion.scale(1.5)}).vertices[tags == 2]
    assert abs(np.ptp(grown[:, 1]) - 1.5) < 1e-9
    assert same(bent[0].pose({2: Motion.parse("translate 0 0 1")}).vertices, bent[0].pose({2: Motion.translate([0, 0, 1])}).vertices)
    assert same(bent[0].pose({np.int64(2): Motion.affine(matrix)}).vertices, bent[0].pose({2: matrix.tolist()}).vertices)


def test_landmarks_are_vertices_or_places():
    vertices, faces, tags, _ = bar()
    left = np.where(vertices[:, 0] < 1, 0, 1)
    at = np.array([len(vertices) - 8])
    to = vertices[at] + [0, 0, 3]
    by_number = Deformer(vertices, faces, left, at).pose(landmarks=to).vertices
    assert np.abs(by_number[at] - to).max() < 1e-12 and by_number[at[0] - 300, 2] > 0.5
    beside = vertices[at] + [1e-3, 0, 0]
    by_place = Deformer(vertices, faces, left, beside)
    assert by_place.points.tolist() == at.tolist()
    assert np.abs(by_place.pose(landmarks=beside + [0, 0, 3]).vertices - by_number).max() < 1e-12
    with pytest.warns(fcd.LandmarkWarning, match="on one line"):
        alone = Deformer(vertices, faces, points=[0, len(vertices) - 1]).pose(landmarks=vertices[[0, -1]] + [[0, 0, 0], [0, 0, 1]])
    assert np.abs(alone.vertices[-1] - vertices[-1] - [0, 0, 1]).max() < 1e-12 and np.abs(alone.vertices[0] - vertices[0]).max() < 1e-12


def test_poses_go_on_from_others(bent):
    _, _, _, lift = bar()
    deformer, pose = bent
    half = deformer.pose({2: lift}, percent=50)
    on = deformer.pose({2: lift}, start=half)
    assert on.info.iterations < pose.info.iterations + half.info.iterations
    assert np.abs(on.vertices - pose.vertices).max() < 1e-3
    assert np.abs(deformer.pose({2: lift}, steps=2).vertices - on.vertices).max() < 1e-3  # which is not at rest half-way
    with pytest.warns(pymeshlab_fcd.NothingMovesWarning):
        rest = deformer.pose()
    assert same(deformer.pose({2: lift}, start=rest).vertices, pose.vertices)  # where all begin
    assert same(deformer.pose({2: lift}, start=pose, percent=0).vertices, deformer.vertices)


@pytest.mark.parametrize("landmarks", [False, True])
@pytest.mark.parametrize("degrees", [(0, 360), (100, 360), (-150, 200), (360, 0), (300, 660)])
def test_turns_are_followed_from_where_a_pose_starts(degrees, landmarks):
    """Of a tube along z, which twists by them."""
    around, rings = 24, 90
    z, a = [grid.ravel() for grid in np.meshgrid(np.arange(rings) * 0.2, 2 * np.pi * np.arange(around) / around, indexing="ij")]
    here = np.arange(around)
    beside = np.roll(here, -1)
    faces = np.concatenate([np.concatenate([np.stack([here, beside, here + around], 1), np.stack([beside, beside + around, here + around], 1)])
                            + r * around for r in range(rings - 1)])
    vertices = np.stack([np.cos(a), np.sin(a), z], 1)
    deformer = Deformer(vertices, faces, np.where(z < 1, 0, np.where(z > 16.8, 2, 1)), points=[45 * around] if landmarks else None)
    turn = [Motion.rotate([0, 0, 1], each).then(Motion.translate([0, 0, each / 1000])) for each in degrees]
    middle = np.radians(degrees) / 2  # the landmark goes along
    where = [{"landmarks": [[np.cos(middle[i]), np.sin(middle[i]), 9 + degrees[i] / 2000]]} if landmarks else {} for i in range(2)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pymeshlab_fcd.NothingMovesWarning)
        begin = deformer.pose({2: turn[0]}, **where[0])
    from_rest = deformer.pose({2: turn[1]}, **where[1])
    for steps in (1, 12):
        on = deformer.pose({2: turn[1]}, start=begin, steps=steps, **where[1])
        assert on.info.converged and np.abs(on.vertices - from_rest.vertices).max() < 1e-3 * np.linalg.norm([2, 2, 17.8])  # as much as rest is left open
    turned = np.unwrap(np.arctan2(*on.vertices[::around, 1::-1].T))
    assert abs(np.degrees(turned[-1] - turned[0]) - degrees[1]) < 1


def test_arrays_that_are_written_to(bent):
    vertices, faces, tags, lift = bar()
    up = np.tile([0, 0, 1.0], (len(vertices), 1))
    deformer, out, normals = Deformer(vertices, faces, tags, normals=up), np.empty_like(vertices), np.empty_like(vertices)
    pose = deformer.pose({2: lift}, out=out, out_normals=normals)
    assert np.shares_memory(pose.vertices, out) and np.shares_memory(pose.normals, normals) and same(out, bent[1].vertices)
    assert same(normals, deformer.pose({2: lift}).normals) and same(normals[tags == 0], up[tags == 0])
    assert same(bent[0].pose({2: lift}, out_normals=normals).normals, bent[1].normals) and same(normals, bent[1].normals)
    for wrong in (out[::-1], out[:-1], out.astype(np.float32), out.tolist()):
        with pytest.raises((TypeError, ValueError), match="out must be"):
            deformer.pose({2: lift}, out=wrong)


def test_normals_are_those_of_the_faces_or_turned(bent):
    vertices, faces, tags, lift = bar()
    deformer, pose = bent
    expected = face_normals(pose.vertices, faces)
    assert np.abs(pose.normals - expected).max() < 1e-7
    vertices, faces, tags, lift = bar(401, 61)  # patches of many faces
    turned = Deformer(vertices, faces, tags, normals=face_normals(vertices, faces)).pose({2: lift})
    degrees = np.degrees(np.arccos(np.clip((turned.normals * face_normals(turned.vertices, faces)).sum(1), -1, 1)))
    assert np.median(degrees) < 0.5 and np.percentile(degrees, 99) < 6


def test_other_points_and_their_normals(bent):
    vertices, _, tags, lift = bar()
    pose = bent[1]
    assert np.abs(pose.map(vertices) - pose.vertices).max() < 1e-12
    beside = vertices[tags == 2] + [0, 0, 0.01]
    moved, normals = pose.map(beside, np.tile([0, 0, 3.0], (len(beside), 1)))
    assert np.abs(moved - lifted(beside, lift)).max() < 1e-3 and np.abs(normals - 3 * lift[:3, 2]).max() < 1e-3
    odd = np.array([[np.nan, 0, 0], [np.inf, 0, 0], [1e300, 0, 0], [0.2, 0.5, 0]])
    assert same(pose.map(odd), odd)


def test_stretch_is_that_of_the_surface():
    vertices, faces, tags, _ = bar()
    far = np.eye(4)
    far[0, 3] = 8
    pose = Deformer(vertices, faces, tags).pose({2: far})
    stretch = pose.stretch()
    assert (stretch[tags == 2] == 1).mean() > 0.8 and np.median(stretch[tags == 1]) > 1.3
    assert pose.info.largest_stretch == stretch.max()


# --- what it is made of ---


def test_the_graph_and_what_vertices_follow(bent):
    vertices, faces, tags, lift = bar()
    deformer, pose = bent
    graph, weights = deformer.graph, deformer.weights()
    k = deformer.info.nodes
    assert graph.nodes.shape == graph.centers.shape == (k, 3) and graph.radius.shape == (k,)
    assert (graph.edges[:, 0] < graph.edges[:, 1]).all() and graph.edges.max() < k
    patch = deformer.patch_of
    assert set(patch[tags == 1]) <= set(range(k)) and (patch[tags == 0] == -1).any()
    assert weights.shape == (len(vertices), k + 2) and weights.nodes == k and weights.tags == (0, 2)
    assert weights.indptr[0] == 0 and weights.indptr[-1] == len(weights.data) == len(weights.indices)
    sums = np.add.reduceat(weights.data.astype(float), weights.indptr[:-1])
    assert np.abs(sums - 1).max() < 1e-6 and weights.data.min() > 0
    dense = np.zeros(weights.shape)
    dense[np.repeat(np.arange(len(vertices)), np.diff(weights.indptr)), weights.indices] = weights.data
    assert (dense[tags == 0, k] == 1).all() and (dense[tags == 2, k + 1] == 1).all()
    # Blending the motions of nodes and regions by them comes near to the pose.
    moved = pose.nodes[None] + np.einsum("kij,nkj->nki", pose.node_maps, vertices[:, None] - graph.nodes[None])
    regions = np.stack([vertices, lifted(vertices, lift)], 1)
    blended = np.einsum("nk,nki->ni", dense[:, :k], moved) + np.einsum("nk,nki->ni", dense[:, k:], regions)
    assert np.abs(blended - pose.vertices).max() < 0.02
    again = Deformer(vertices, faces, tags, nodes=graph.centers[np.unique(patch[tags == 1])])
    assert again.info.placed_nodes == len(np.unique(patch[tags == 1]))


def test_weights_of_landmarks_and_loose_parts():
    vertices, faces, tags, lift = bar()
    other = vertices + [0, 5, 0]
    deformer = Deformer(np.concatenate([vertices, other]), np.concatenate([faces, faces + len(vertices)]),
                        np.concatenate([np.minimum(tags, 1), np.ones_like(tags)]), points=[len(vertices) - 8])
    weights = deformer.weights()
    assert deformer.info.loose_parts == 1 and weights.tags == (0,) and weights.shape[1] == weights.nodes + 2
    counts = np.diff(weights.indptr)
    assert (counts[len(vertices):] == 0).all() and (counts[:len(vertices)] > 0).all()
    mine = slice(weights.indptr[len(vertices) - 8], weights.indptr[len(vertices) - 7])
    assert weights.indices[mine].tolist() == [weights.nodes + 1] and weights.data[mine].tolist() == [1]
    stays = Deformer(deformer.vertices, deformer.faces, np.concatenate([tags, np.ones_like(tags)]), loose_parts="stay").pose({2: lift})
    assert same(stays.vertices[len(vertices):], other)


def test_weights_of_scipy(bent, monkeypatch):
    weights = bent[0].weights()
    monkeypatch.setitem(sys.modules, "scipy.sparse", types.SimpleNamespace(csr_array=lambda parts, shape: (*parts, shape)))
    data, indices, indptr, shape = weights.to_scipy()
    assert data is weights.data and indices is weights.indices and indptr is weights.indptr and shape == weights.shape
    monkeypatch.setitem(sys.modules, "scipy.sparse", None)
    with pytest.raises(ImportError):
        weights.to_scipy()
    monkeypatch.undo()
    pytest.importorskip("scipy")
    assert np.abs(weights.to_scipy().sum(axis=1) - 1).max() < 1e-6


def test_names_of_before(bent):
    vertices, faces, tags, lift = bar()
    with pytest.warns(DeprecationWarning, match="the parameter weights is called distances now") as told:
        old = Deformer(vertices, faces, tags, weights="euclidean").pose({2: lift}).vertices
        assert same(pymeshlab_fcd.deform(vertices, faces, tags, {2: lift}, weights="euclidean"), old)
        pymeshlab_fcd.deformation(vertices, faces, tags, {2: lift}, weights="euclidean")
    assert len(told) == 3 and {each.filename for each in told} == {__file__}
    assert same(Deformer(vertices, faces, tags, distances="euclidean").pose({2: lift}).vertices, old) and not same(old, bent[1].vertices)


def test_numbers_are_doubles():
    vertices, faces, tags, lift = bar()
    one, other = (Deformer(vertices, faces, tags, smoothness=0.0058 * (1 + step)).pose({2: lift}) for step in (0, 1e-10))
    assert not same(one.vertices, other.vertices) and np.abs(one.vertices - other.vertices).max() < 1e-6
    percent = [one.deformer.pose({2: lift}, percent=50 + step).vertices[tags == 2] for step in (0, 1e-9)]
    assert 0 < np.abs(percent[0] - percent[1]).max() < 1e-8


@pytest.mark.parametrize("graph_weights", ["uniform", "paper", "printed"])
def test_other_ways_to_deform(bent, graph_weights):
    vertices, faces, tags, lift = bar()
    deformer = Deformer(vertices, faces, tags, graph_weights=graph_weights, distances="euclidean")
    pose = deformer.pose({2: lift})
    assert 0 < np.abs(pose.vertices - bent[1].vertices).max() < 1
    data = deformer.weights()
    assert np.abs(np.add.reduceat(data.data.astype(float), data.indptr[:-1]) - 1).max() < 1e-6


# --- what is told ---


def limbs():
    """A bumpy bar with three parts that bend, each with a handle, between held ones."""
    vertices, faces, _, _ = bar(301)
    x = vertices[:, 0]
    tags = np.zeros(len(vertices), int)
    for k, middle in enumerate((1.5, 5, 8.5)):
        tags[abs(x - middle) < 1.2] = 1
        tags[abs(x - middle) < 0.2] = 2 + k
    return vertices, faces, tags, {2 + k: Motion.rotate([0, 1, k], 30).then(Motion.translate([0, 0.1 * k, 0.4])) for k in range(3)}


@pytest.mark.parametrize("kind", ["mesh", "cloud", "unwelded"])
def test_what_bends_in_one_place_does_not_depend_on_what_bends_elsewhere(kind):
    vertices, faces, tags, motions = limbs()
    faces = None if kind == "cloud" else faces
    if kind == "unwelded":
        vertices, tags, faces = vertices[faces.ravel()], tags[faces.ravel()], np.arange(faces.size).reshape(-1, 3)
    together = Deformer(vertices, faces, tags)
    pose = together.pose(motions)
    saved = pose.deformation()
    nodes = 0
    for k, middle in enumerate((1.5, 5, 8.5)):
        here = abs(vertices[:, 0] - middle) < 1.3
        alone = Deformer(vertices, faces, np.where(here, tags, 0))
        one = alone.pose({2 + k: motions[2 + k]})
        nodes += one.info.nodes
        assert same(one.vertices[here], pose.vertices[here])
        assert same(one.deformation()(vertices[here]), saved(vertices[here]))
    assert pose.info.nodes == nodes == len(together.graph.nodes) == len(pose.nodes)
    assert together.patch_of.max() == nodes - 1
    weights = together.weights()
    assert weights.nodes == nodes and weights.indices.max() < weights.shape[1]


def test_other_tags_prepare_what_they_change_alone():
    vertices, faces, tags, motions = limbs()
    without = np.where(tags == 4, 1, tags)
    first = Deformer(vertices, faces, without, smoothness=0.01)
    for other in (tags, np.where(vertices[:, 0] > 7, 0, tags), np.where(vertices[:, 0] < 3, 1, tags), without):
        kept, anew = first.with_tags(other), Deformer(vertices, faces, other, smoothness=0.01)
        moved = {tag: motions[tag] for tag in kept.handles}
        a, b = kept.pose(moved), anew.pose(moved)
        assert same(a.vertices, b.vertices) and same(kept.graph.nodes, anew.graph.nodes) and kept.handles == anew.handles
        assert a.info.energy == b.info.energy and a.info.iterations == b.info.iterations
        again = first.pose({tag: motions[tag] for tag in first.handles})
        assert same(again.vertices, Deformer(vertices, faces, without, smoothness=0.01).pose({2: motions[2], 3: motions[3]}).vertices)
    point = int(np.argmin(abs(vertices[:, 0] - 1)))
    kept, anew = first.with_tags(without, [point]), Deformer(vertices, faces, without, [point], smoothness=0.01)
    target = vertices[[point]] + [0, 0, 0.2]
    assert same(kept.pose(motions_of(kept, motions), landmarks=target).vertices, anew.pose(motions_of(anew, motions), landmarks=target).vertices)
    with pytest.raises(ValueError, match="There is no handle"):
        first.with_tags(np.minimum(tags, 1))
    with pytest.raises(ValueError, match="nothing is held"):
        first.with_tags()
    with pytest.raises(ValueError, match="moved by something else than handles"):
        fcd.straighten(vertices, faces, [[0, 0.5, 0], [10, 0.5, 0]]).deformer.with_tags(tags)


def motions_of(deformer, motions):
    return {tag: motions[tag] for tag in deformer.handles}


def test_a_landmark_far_from_the_surface_is_told():
    x, y = [grid.ravel() for grid in np.meshgrid(np.arange(9.0), np.arange(9.0))]
    grid, size = np.stack([x, y, 0 * x], 1), np.hypot(8, 8)
    tags = np.where(x == 0, 0, 1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        near = Deformer(grid, None, tags, points=[[8, 8, 0.99 * size]])
    assert near.points.tolist() == [80]
    with pytest.warns(fcd.LandmarkWarning, match="Landmark 1, counted from 0, is 800 from the surface, which is 11.3137 large"):
        near.with_tags(tags, points=[[8, 8, 0.0], [4, 8, 800]])


def test_landmarks_on_a_line_are_told():
    x, y = [grid.ravel() for grid in np.meshgrid(np.arange(9.0), np.arange(9.0))]
    grid, line = np.stack([x, y, 0 * x], 1), [0, 40, 80]
    told = pytest.warns(fcd.LandmarkWarning, match="lie on one line, and nothing else holds")
    with told:
        deformer = Deformer(grid, None, points=line)
    with told:
        deformer.with_tags(None, points=line[:2])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Deformer(grid, None, points=[*line, 8])
        Deformer(grid, None, np.where(x == 8, 0, 1), points=[0, 36])
        Deformer(grid, None, np.where(x == 8, 2, 1), points=[0, 36])
        Deformer(grid, None, points=[0])


def test_what_is_probably_not_meant_is_told():
    vertices, faces, tags, _ = bar()
    flat, onto = vertices * [1, 1, 0], np.eye(4)
    onto[0, 3] = -7.5
    with pytest.warns(fcd.FoldWarning, match=r"triangles? (is|are) flipped"):
        pose = Deformer(flat, faces, tags).pose({2: onto})
    assert pose.info.folded > 0
    with pytest.warns(fcd.NothingMovesWarning, match="No handle moves"):
        Deformer(vertices, faces, tags).pose()
    up = np.eye(4)
    up[2, 3] = 1
    with pytest.warns(fcd.RigidWarning, match="moves rigidly"):
        assert np.abs(Deformer(vertices, faces, np.maximum(tags, 1)).pose({2: up}).vertices - vertices - [0, 0, 1]).max() < 1e-6
    with pytest.warns(fcd.NotAtRestWarning, match="did not converge: raise max_iterations"):
        Deformer(vertices, faces, tags, max_iterations=1).pose({2: up})
    with pytest.warns(fcd.StretchWarning, match="two held regions that move differently"):
        Deformer(vertices, faces, np.where(vertices[:, 0] < 1, 0, np.where(vertices[:, 0] < 2, 2, 1))).pose({2: up})
    with pytest.warns(fcd.OverruledWarning, match="at the place of a fixed vertex"):
        Deformer(np.concatenate([vertices, vertices[135:136]]), faces, np.append(tags, 2)).pose({2: up})
    with pytest.warns(fcd.NodeWarning, match="1 of the 2 nodes do not lie on the free surface"):
        Deformer(vertices, faces, tags, nodes=[vertices[700], [50, 50, 50.0]])
    y, x = (a.ravel() for a in np.meshgrid(np.arange(8.0), np.arange(1401) / 200, indexing="ij"))
    with pytest.warns(fcd.ScanLineWarning, match="have neighbours only on their own scan line"):
        Deformer(np.column_stack([x, y, 0 * x]), None, np.where(x < 1, 0, np.where(x > 6, 2, 1)))
    with pytest.warns(fcd.VolumeWarning, match="1 connected free parts enclose no volume that elastic could keep"):
        assert Deformer(vertices, None, tags, elastic=True).info.unenclosed == 1
    with pytest.warns(fcd.SlitWarning, match="such a slit may open"):
        x, y = np.meshgrid(np.linspace(0, 1, 21), np.linspace(0, 1, 21), indexing="ij")
        sheet = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1)
        i = np.arange(441).reshape(21, 21)[:-1, :-1].ravel()
        corners = np.concatenate([np.stack([i, i + 21, i + 1], 1), np.stack([i + 1, i + 21, i + 22], 1)])
        Deformer(np.concatenate([sheet, sheet + [1.0002, 0, 0]]), np.concatenate([corners, corners + 441]),
                 np.where(np.arange(882) < 21, 0, np.where(np.arange(882) >= 861, 2, 1)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pymeshlab_fcd.deform(vertices, faces, tags, {2: up})
        Deformer(flat, faces, tags).pose({2: onto}, check=False)


def test_warnings_name_the_line_that_asked():
    vertices, faces, tags, _ = bar()
    with pytest.warns(DeformationWarning) as told:
        Deformer(vertices, faces, tags).pose()
        pymeshlab_fcd.deform(vertices, faces, tags)
        pymeshlab_fcd.deformation(vertices, faces, tags)
        Deformer(vertices, faces, tags, nodes=[vertices[700], [50, 50, 50.0]])
    assert len(told) == 4 and {each.filename for each in told} == {__file__}


def test_progress_is_told():
    vertices, faces, tags, lift = bar(601, 601)
    heard = []
    pymeshlab_fcd.deform(vertices, faces, tags, {2: lift}, progress=lambda percent, stage: heard.append((percent, stage)))
    percents = [percent for percent, _ in heard]
    assert percents == sorted(percents) and percents[-1] == 100 and len(heard) > 4 and all(isinstance(stage, str) for _, stage in heard)
    tqdm = pytest.importorskip("tqdm")
    with tqdm.tqdm(total=50, disable=None) as bar_of_fifty:
        Deformer(vertices, faces, tags, progress=bar_of_fifty)
        assert bar_of_fifty.n == 50 or bar_of_fifty.disable
    Deformer(vertices, faces, tags, progress=tqdm.tqdm)
    with pytest.raises(TypeError, match="progress must be callable"):
        Deformer(vertices, faces, tags, progress=7)


@pytest.mark.parametrize("call", [lambda p: Deformer(*bar(601, 601)[:3], progress=p), lambda p: Deformer(*bar(601, 601)[:3]).pose({2: bar()[3]}, progress=p),
                                  lambda p: Deformer(*bar(601, 601)[:3]).pose({2: bar()[3]}).deformation(progress=p)])
def test_an_exception_of_the_listener_ends_the_work(call):
    class Enough(Exception):
        pass

    def enough(percent, stage):
        raise Enough(stage)

    with pytest.raises(Enough):
        call(enough)


INTERRUPT = """
import _thread, sys, threading, time
import numpy as np
sys.path.insert(0, sys.argv[1])
from shapes import bar
import pymeshlab_fcd
vertices, faces, tags, lift = bar(1001, 1001)
sent = []
def send():
    time.sleep(float(sys.argv[2]))
    sent.append(time.perf_counter())
    _thread.interrupt_main()
copy = vertices.copy()
threading.Thread(target=send).start()
try:
    while True:
        pymeshlab_fcd.Deformer(vertices, faces, tags).pose({2: lift}, check=True).deformation()
except KeyboardInterrupt:
    print(time.perf_counter() - sent[0])
assert (copy == vertices).all()
"""


def test_it_can_be_interrupted():
    waited = []
    for delay in (0.15, 0.3, 0.45, 0.6, 1.0, 1.5):
        done = subprocess.run([sys.executable, "-c", INTERRUPT, str(Path(__file__).parent), str(delay)], capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stderr[-2000:]
        waited.append(float(done.stdout))
    assert np.median(waited) < 0.2 and max(waited) < 1, waited  # on a machine that others use, too


def test_the_lock_is_free_and_threads_share_a_deformer(bent):
    _, _, _, lift = bar()
    deformer, pose = bent
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        poses = list(pool.map(lambda percent: deformer.pose({2: lift}, percent=percent).vertices, [100, 50, 100, 20] * 5))
    assert all(same(each, pose.vertices) for each in poses[::2])
    vertices, faces, tags, lift = bar(601, 601)
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before, begin = counted[0], time.perf_counter()
    Deformer(vertices, faces, tags)
    seconds, ran = time.perf_counter() - begin, counted[0] - before
    stop.set()
    thread.join()
    assert ran > 50 * seconds


def test_only_what_computes_solves(bent, monkeypatch):
    """The estimate of the error, which takes a second solution, is made where it is asked for."""
    def solved(self, progress=None):
        raise AssertionError

    monkeypatch.setattr(fcd._pose._Solved, "error", solved)
    deformer, (_, _, _, lift) = bent[0], bar()
    for check in (False, True):
        pose = deformer.pose({2: lift}, check=check)
        assert "converged" in repr(pose) and "folded=0" in repr(pose.info)
    with pytest.raises(AssertionError):
        pose.info.discretisation_error
    assert "discretisation_error" not in pose._core.info()


@pytest.mark.skipif(sys.platform != "linux", reason="Linux tells of a process's threads")
def test_one_thread_is_one_thread():
    """The threads of the process while it works are those of before."""
    vertices, faces, tags, lift = bar(601, 101)
    most, stop = [0], threading.Event()

    def watch():
        while not stop.is_set():
            most[0] = max(most[0], len(os.listdir("/proc/self/task")))
            time.sleep(0.0003)

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        deformer = Deformer(vertices, faces, tags, threads=1)
        before = len(os.listdir("/proc/self/task"))
        most[0] = 0
        pose = deformer.pose({2: lift})
        deformer.pose({2: lift}, start=pose)
        assert len(pose.normals) == len(pose.stretch()) == len(pose.map(vertices)) and pose.discretisation_error() > 0
        field = pose.deformation()
        field(vertices, threads=1)
        pymeshlab_fcd.Deformation(field.__reduce__()[1][0])
        deformer.weights()
        cloud = Deformer(vertices[::3], None, tags[::3], threads=1).pose({2: lift})
        cloud.map(vertices)
        assert most[0] == before
    finally:
        stop.set()
        thread.join()


def test_the_lock_is_free_where_something_is_computed():
    vertices, faces, tags, lift = bar(1201, 301)
    deformer = Deformer(vertices, faces, tags)
    pose = deformer.pose({2: lift}, check=False)
    ran, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            ran[0] += 1
            time.sleep(0.0005)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        for compute in (pose.stretch, lambda: pose.normals, lambda: pose.map(vertices), lambda: deformer.pose({2: lift}), deformer.weights,
                        pose.deformation):
            before, begin = ran[0], time.perf_counter()
            compute()
            assert ran[0] - before > 50 * (time.perf_counter() - begin)
    finally:
        stop.set()
        thread.join()


def test_the_same_bits_for_any_number_of_threads(bent):
    vertices, faces, tags, lift = bar(201, 31)
    one, three = (Deformer(vertices, faces, tags, threads=threads).pose({2: lift}) for threads in (1, 3))
    assert same(one.vertices, three.vertices) and same(one.normals, three.normals) and one.deformation() == three.deformation()


def test_signal_handlers_of_others_are_left_alone(bent):
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


# --- saved ---


def test_a_pose_as_a_deformation(bent, tmp_path):
    vertices, faces, tags, lift = bar()
    made = bent[1].deformation()
    assert made == pymeshlab_fcd.deformation(vertices, faces, tags, {2: lift}) and hash(made) == hash(bent[1].deformation())
    assert made != bent[0].pose({2: lift}, percent=50).deformation() and made != 7
    assert np.abs(made(vertices) - bent[1].vertices).max() <= made.largest_difference + 1e-9
    made.save(tmp_path / "bend.ply")
    assert pymeshlab_fcd.Deformation.load(tmp_path / "bend.ply") == made


def test_points_far_from_what_was_deformed_are_told(bent):
    bend, points = bent[1].deformation(), bar()[0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bend(points)
        bend(points + [0, 0, 3])
        bend(points / 50)  # a part of it may be so small
        bend(points[:50] / 1000)
        bend(np.full((200, 3), np.nan))
    for elsewhere, word in ((points + [1e6, 0, 0], "apart"), (points * 1000, "across"), (np.r_[points / 1000, [[np.nan] * 3]], "across")):
        with pytest.warns(pymeshlab_fcd.SpaceWarning, match=f"The points are .*{word}.*same place and units first") as told:
            bend(elsewhere)
        assert told[0].filename == __file__


def test_a_deformation_is_as_exact_as_is_asked(bent, tmp_path):
    vertices, faces, tags, lift = bar(301, 45)
    pose, size = Deformer(vertices, faces, tags).pose({2: lift}), []
    for accuracy in (0.02, 0.002, 0.0002):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            exact = pose.deformation(accuracy=accuracy)
        assert np.linalg.norm(exact(vertices) - pose.vertices, axis=1).max() <= exact.largest_difference + 1e-9 <= accuracy + 1e-9
        assert exact == pymeshlab_fcd.deformation(vertices, faces, tags, {2: lift}, accuracy=accuracy)
        back = pose.deformation(inverse=True, accuracy=accuracy)
        assert np.linalg.norm(back(pose.vertices) - vertices, axis=1).max() <= accuracy + 1e-9
        size.append(len(exact.samples))
        exact.save(tmp_path / "exact.ply")
        assert exact.file_size == (tmp_path / "exact.ply").stat().st_size > 84 * size[-1] and 0 < exact.seconds < 60
        assert pymeshlab_fcd.Deformation.load(tmp_path / "exact.ply").seconds is None
    assert size[0] <= size[1] < size[2]
    slide = bent[0].pose({2: Motion.translate([0, 0, 0.001])})
    moved = np.linalg.norm(slide.vertices - bent[0].vertices, axis=1).max()
    assert slide.deformation().largest_difference <= moved / 50 + 1e-12  # a ten-thousandth of the diagonal is as far as it slides
    for accuracy in (-1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="accuracy must be a positive number, in world units, or 0"):
            bent[1].deformation(accuracy=accuracy)
        with pytest.raises(ValueError, match="accuracy must be a positive number"):
            pymeshlab_fcd.deformation(vertices, faces, tags, {2: lift}, accuracy=accuracy)
    with pytest.raises(TypeError, match="accuracy must be a number"):
        bent[1].deformation(accuracy="fine")
    assert bent[1].deformation() == bent[1].deformation(accuracy=0)


@pytest.mark.parametrize("second, told", [(-1, "^[0-9]+ vertices that rest move: parts"), (3, "vertices are farther off than 0.00[0-9]*, up to [0-9.]*: parts")])
def test_a_deformation_that_cannot_be_told_by_samples_says_so(second, told):
    vertices, faces, tags, lift = bar()
    two = np.concatenate([vertices, vertices + [0, 0, 1e-9]])  # a second sheet at the same place, which stays, or moves elsewhere
    others = np.full(len(vertices), -1) if second < 0 else np.where(tags == 2, second, tags)
    motions = {2: lift} if second < 0 else {2: lift, second: np.linalg.inv(lift)}
    with pytest.warns(fcd.AccuracyWarning, match=told):
        pymeshlab_fcd.deformation(two, np.concatenate([faces, faces + len(vertices)]), np.concatenate([tags, others]), motions)


def test_a_triangle_far_away_makes_nothing_slow():
    across, along = 150, 80
    u, w = (a.ravel() for a in np.meshgrid(np.arange(across) * 2 * np.pi / across, np.linspace(0, 4, along), indexing="ij"))
    vertices = np.column_stack([w, np.cos(u), np.sin(u)])
    i, j = np.meshgrid(np.arange(across), np.arange(along - 1), indexing="ij")
    a, b = (i * along + j).ravel(), ((i + 1) % across * along + j).ravel()
    faces = np.vstack([np.column_stack([a, a + 1, b]), np.column_stack([b, a + 1, b + 1])])
    seconds, moved = [], []
    for far in (0, 1e3, 1e6, 1e9):
        n = len(vertices)
        stray = [[far, 0, 0], [far, 1, 0], [far, 0, 1]] if far else np.zeros((0, 3))
        all_vertices = np.vstack([vertices, stray])
        all_faces = np.vstack([faces, [[n, n + 1, n + 2]]]) if far else faces
        tags = np.where(all_vertices[:, 0] < 0.5, 0, np.where((all_vertices[:, 0] > 3.5) & (all_vertices[:, 0] < 4.5), 2, 1))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeformationWarning)
            pose = Deformer(all_vertices, all_faces, tags).pose({2: Motion.translate([0.3, 0.2, 0])})
            begin = time.perf_counter()
            moved.append(pose.map(vertices + 0.01))
            pose.deformation()(vertices + 0.01)
        seconds.append(time.perf_counter() - begin)
    assert max(seconds[1:]) < 10 * seconds[0] + 1
    for each in moved[1:]:
        assert same(each, moved[0])


@pytest.mark.parametrize("radius", [1e5, 1e30, 1e300])
def test_no_patch_reaches_farther_than_the_surface_is_large(radius):
    vertices, faces, tags, lift = bar()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        moved = pymeshlab_fcd.deform(vertices, faces, tags, {2: lift}, target_radius=radius)
        assert same(moved, pymeshlab_fcd.deform(vertices, faces, tags, {2: lift}, target_radius=1e4))
    assert np.ptp(moved, axis=0).max() < 2 * np.linalg.norm(np.ptp(vertices, axis=0))


@pytest.mark.parametrize("size", [2.0**-1000, 2.0**-600, 2.0**600, 2.0**900])
def test_meshes_and_clouds_of_any_size_bend_alike(size):
    """Squares of such lengths are no numbers."""
    vertices, faces, tags, _ = bar()

    def bent(by, triangles):
        return pymeshlab_fcd.deform(vertices * by, triangles, tags, {2: Motion.translate([0, 0, 0.5 * by])}) / by

    for triangles in (faces, np.zeros((0, 3), int)):
        np.testing.assert_allclose(bent(size, triangles), bent(1, triangles), rtol=0, atol=1e-9)


@pytest.mark.parametrize("size", [2.0**-1000, 2.0**-600, 2.0**-300, 2.0**200, 2.0**320])
@pytest.mark.parametrize("cloud", [False, True])
def test_points_near_meshes_and_clouds_of_any_size_are_carried_alike(size, cloud):
    """By the pose, and by its deformation, whose samples have single precision; up to 1e100, beyond which no point goes along."""
    vertices, faces, tags, _ = bar()
    points = np.random.default_rng(1).uniform([-1, -1, -1], [11, 2, 1], (400, 3))

    def carried(by):
        pose = Deformer(vertices * by, None if cloud else faces, tags).pose({2: Motion.rotate([0, 1, 0], 30)})
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            bend = pose.deformation()
            back = pose.deformation(inverse=True)
        moved, normals = pose.map(points * by, points)
        return [moved / by, normals, bend(points * by) / by, back(points * by) / by, bend.largest_difference / by, pose.deformation(accuracy=0.01 * by)(points * by) / by]

    for each, expected in zip(carried(size), carried(1)):
        assert same(np.asarray(each), np.asarray(expected))


@pytest.mark.parametrize("size", [2.0**-1000, 2.0**-300, 2.0**300, 2.0**600, 2.0**900])
def test_what_is_told_of_a_pose_does_not_depend_on_the_unit(size):
    """Normals, folds, contact, errors, loose parts, regions that share patches, landmarks by their place."""
    vertices, faces, tags, turn = finger(60, 20)
    button = vertices[:160] * [0.5, 0.1, 0.1] + [40, 0, 9]
    near = (faces < 160).all(1)
    vertices = np.r_[vertices, button, 2 * vertices + [0, 50, 0]]
    faces = np.r_[faces, faces[near] + 1200, faces + 1360]
    tags = np.r_[tags, np.ones(160, int), tags]

    def told(by):
        about = np.array([40.0, 0, 0]) * by
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeformationWarning)
            deformer = Deformer(vertices * by, faces, tags, points=[vertices[1400 + 20 * 22] * by], patches=100)
            pose = deformer.pose({2: Motion.rotate([0, 1, 0], -160, about=about)}, steps=10, landmarks=deformer.vertices[deformer.points])
            pinched = deformer.pose({2: Motion.rotate([1, 0, 0], 900, about=about)})
            return {"vertices": pose.vertices / by, "normals": pose.normals, "stretch": pose.stretch(), "contact": pose.contact.faces,
                    "depth": pose.contact.depth / by, "error": pose.discretisation_error(), "point": deformer.points,
                    "folded": pinched.info.folded, "patches": deformer.patch_of, "nodes": deformer.graph.nodes / by,
                    "percent": finger_of(by).percent_to_contact({2: Motion.rotate([0, 1, 0], -160, about=about)})}

    def finger_of(by):
        return Deformer(vertices[:1200] * by, faces[:len(near)], tags[:1200])

    expected, found = told(1), told(size)
    assert expected["folded"] > 0 and len(expected["contact"]) > 0 and expected["percent"] < 100 and expected["error"] > 0
    for name, each in found.items():
        assert same(np.asarray(each), np.asarray(expected[name])), name
