# SPDX-License-Identifier: GPL-3.0-or-later
"""The tool "FCD: Bend" in a modeller's hands: what is marked, pulled and turned there, and what the window says of it. Windows and mice as
in host_edit.py, with the same environment."""

import ctypes
import errno
import os
import re
import struct
import time

import numpy as np
import pytest

import host_edit
from host_edit import MIDDLE, Filters, load, mark_two_regions, the_dialogs_are_those_of_2020, tube_of, tube_with_ends, write_ply
from host_edit import window # noqa: F401, a fixture
from host_edit_fit import answer
from host_edit_state import choose_layer, import_another, open_tube
from host_meshlabserver import Run, pose_filter, sequence_filter

pytestmark = host_edit.pytestmark

X, Y = MIDDLE


def most_stretched(rest, now, faces):
    edges = lambda points, k: np.linalg.norm(points[faces[:, k]] - points[faces[:, k - 1]], axis=1)
    return max((edges(now, k) / edges(rest, k)).max() for k in range(3))


def test_marks_never_touch(window, tmp_path):
    """Neither a handle what is fixed, nor two handles: what is between them bends, and nothing is torn."""
    w, points, faces = open_tube(window, tmp_path)
    w.start_tool()
    w.key("v", "t", "f")
    w.drag((X - 280, Y - 200), (X + 280, Y + 200)) # all of it
    w.key("h")
    w.drag((X - 40, Y - 200), (X + 40, Y + 200))
    w.key("shift+h")
    w.drag((X + 40, Y + 200), (X + 120, Y - 200))
    w.shot("marked")
    w.key("m")
    w.drag((X + 80, Y), (X + 80, Y - 30))
    w.shot("moved")
    bent = load(w.save("bent.ply"))[0]
    moved = np.linalg.norm(bent - points, axis=1)
    assert 0.2 < np.mean(moved > 0) < 0.4 and np.mean(abs(moved - moved.max()) < 1e-5) > 0.05
    assert most_stretched(points, bent, faces) < 3.5 # torn: 5
    said = state_text(w)
    w.drag((X - 180, Y), (X - 180, Y + 5)) # what is fixed is not pulled, and that is said
    w.do("mousemove", X, Y - 220)
    w.shot("fixed")
    assert state_text(w) != said


def colored(w, place, color):
    """How many pixels around a place have about a color."""
    x, y = place
    seen = np.asarray(w.picture().convert("RGB"))[y - 12:y + 13, x - 12:x + 13].astype(int)
    return np.count_nonzero(abs(seen - color).max(-1) < 25)


def state_text(w):
    """What the panel says, as a picture."""
    x, y, width, height = w.box("state")
    return np.asarray(w.picture().convert("L"))[y:y + height, x:x + width].tobytes()


LIT = (255, 225, 60)


def test_handles_are_things(window, tmp_path):
    """The gizmo is there from the start; what is under the mouse lights up, and is what keys move; a handle has a place to turn about, can
    be locked and removed."""
    w, points, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.key("v", "t", "h")
    w.drag((X - 230, Y - 200), (X - 180, Y + 200))
    w.key("shift+h")
    w.drag((X + 180, Y - 200), (X + 230, Y + 200))
    w.key("f")
    w.drag((X - 20, Y - 200), (X + 20, Y + 200))
    w.key("m")
    left, right = points[:, 0] < -0.75, points[:, 0] > 0.75
    w.do("mousemove", X + 205 + 60, Y) # the arrow of the gizmo of the handle that was marked last
    w.shot("arrow")
    assert colored(w, (X + 205 + 60, Y), LIT) > 30
    w.do("mousemove", X - 215, Y + 30) # the other handle
    w.shot("handle")
    assert colored(w, (X - 205, Y), LIT) > 80
    w.key("g", "y", "1", "Return")
    moved = load(w.save("moved.ply"))[0] - points
    assert np.abs(moved[left] - [0, 1, 0]).max() < 1e-5 and not moved[right].any()
    w.do("mousemove", X + 150, Y - 170) # beside the mesh: the one that was moved last
    w.key("g", "z", "1", "Return")
    moved = load(w.save("moved_on.ply"))[0] - points
    assert np.abs(moved[left] - [0, 1, 1]).max() < 1e-5 and not moved[right].any()

    w.key("ctrl+z", "ctrl+z")
    w.do("mousemove", X, Y)
    w.key("p", "r", "z", "9", "0", "Return") # about the nearest point of the surface, which is before the tube's middle
    turned = load(w.save("turned.ply"))[0]
    assert np.abs(turned[left] - (points @ [[0, 1, 0], [-1, 0, 0], [0, 0, 1]])[left]).max() < 0.03
    w.shot("turned")
    w.key("ctrl+z", "g", "y", "1", "Return", "ctrl+Return") # which takes the pivot along
    w.wait("ms.apply_filter")
    w.key("r", "z", "9", "0", "Return")
    turned = load(w.save("turned_later.ply"))[0]
    assert np.abs(turned[left] - (points @ [[0, 1, 0], [-1, 0, 0], [0, 0, 1]] + [0, 1, 0])[left]).max() < 0.03
    w.key("ctrl+z", "ctrl+z", "ctrl+z")

    x, y, width, _ = w.box("handles")
    row = lambda i: y + 35 + 22 * i
    w.click((x + width - 20, row(1))) # removes the other one
    w.click((x + 30, row(0)), count=2)
    w.do("type", "arm")
    w.key("Return")
    w.do("mousemove", X - 215, Y + 180)
    w.shot("removed")
    w.click((x + 104 + 38 + 12, row(0))) # locks it
    w.shot("locked")
    w.do("mousemove", X, Y + 200)
    w.key("g", "x", "1", "Return")
    w.wait("arm is locked: the list of handles unlocks it.")
    w.key("ctrl+z", "ctrl+z", "ctrl+z")
    w.shot("undone")
    w.do("mousemove", X + 215, Y + 30)
    assert colored(w, (X + 205, Y), LIT) > 80


def test_a_click_beside_a_box_of_the_list_sets_it(window, tmp_path):
    """All of the cell does; and motions, of which there is room for a few words, are edited as the filters take them."""
    w, points, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.drag((X, Y), (X, Y - 60))
    w.do("mousemove", X, Y - 200)
    x, y, width, _ = w.box("handles")
    row, seen, lock = y + 35, x + 104, x + 104 + 38
    dot = lambda: colored(w, (X, Y - 60), (250, 250, 250)) # of the gizmo
    assert dot() > 80
    for place in (seen + 33, seen + 5, seen + 33, seen + 14): # off, on, off and on by the box
        before = dot()
        w.click((place, row))
        assert (dot() > 80) != (before > 80)
        time.sleep(0.6) # no double click
    w.click((lock + 33, row))
    w.do("mousemove", X, Y + 200)
    w.key("g", "x", "1", "Return")
    w.wait("is locked: the list of handles unlocks it.")
    w.shot("locked")
    w.click((lock + 5, row))
    w.click((x + width - 60, row), count=2)
    w.shot("edited")
    w.key("End")
    w.do("type", " translate 0 0 1")
    w.key("Return")
    moved = load(w.save("moved.ply"))[0] - points
    assert moved[:, 1].max() > 0.1 and moved[:, 2].max() == pytest.approx(1, abs=1e-5)
    w.shot("short")


def test_a_handle_turns_about_a_place_of_itself(window, tmp_path):
    """Such as a joint at its edge, where P is pressed; beside the mesh, P takes that back."""
    w, points, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.key("v", "t", "h")
    w.drag((X + 60, Y - 200), (X + 230, Y + 200))
    w.key("m")
    right = points[:, 0] > 0.4
    w.do("mousemove", X + 80, Y) # x is about 0.3 there
    said = state_text(w)
    w.key("p")
    w.shot("placed")
    assert state_text(w) != said
    w.key("r", "z", "9", "0", "Return")
    turn, joint = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]), [0.3, 0, 0]
    turned = load(w.save("turned.ply"))[0]
    assert np.abs(turned[right] - ((points - joint) @ turn + joint)[right]).max() < 0.06
    w.key("ctrl+z")
    w.do("mousemove", X, Y - 200)
    w.key("p", "r", "z", "9", "0", "Return")
    turned = load(w.save("turned_again.ply"))[0]
    assert np.abs(turned[right].mean(0) - points[right].mean(0)).max() < 0.2 # about the joint it would be 0.4


LIMB = np.linspace(-1, 1, 120), 32, 0.08


def tip_of_a_limb(window, tmp_path):
    """A window with the tool on a thin tube along x, whose right end is a tip."""
    points, faces = tube_of(*LIMB)
    w = window(write_ply(tmp_path / "limb.ply", points, faces))
    w.start_tool()
    return w, points


def turned_by(points, now):
    """How far points were turned, at best (Kabsch), in degrees."""
    a, b = points - points.mean(0), now - now.mean(0)
    u, _, v = np.linalg.svd(a.T @ b)
    return np.degrees(np.arccos((np.trace(u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v) - 1) / 2))


def test_a_point_that_is_turned_takes_the_tip_along(window, tmp_path):
    """By as much as was asked for, from where it was pulled to, however it came there; and about the joint: where that is, nothing moves."""
    w, points = tip_of_a_limb(window, tmp_path)
    tip = points[:, 0] > 0.75
    w.drag((X + 110, Y), (X + 110, Y - 60))
    pulled = load(w.save("pulled.ply"))[0]
    w.do("mousemove", X + 110, Y - 60)
    w.key("r", "z", "4", "5")
    w.shot("turning")
    w.key("Return")
    turned = load(w.save("turned.ply"))[0]
    assert turned_by(pulled[tip], turned[tip]) == pytest.approx(45, abs=1)
    joint = np.abs(points[:, 0] - 0.2) < 0.05 # of what bends behind the point at 0.44
    assert np.linalg.norm((turned - pulled)[joint].mean(0)) < 0.05
    assert np.linalg.norm((turned - pulled)[np.abs(points[:, 0] - 0.44) < 0.05].mean(0)) > 0.07
    assert not (turned - points)[points[:, 0] < 0].any()
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("undone.ply"))[0], pulled)
    w.do("mousemove", X + 110, Y - 60)
    w.key("g", "r", "z", "4", "5", "Return") # begun as a move
    assert np.array_equal(load(w.save("again.ply"))[0], turned)
    w.key("ctrl+shift+Return") # the filter makes the same of it
    w.wait("ms.apply_filter")
    assert np.array_equal(load(w.save("applied.ply"))[0], turned)


def test_a_new_handle_leaves_what_is_posed(window, tmp_path):
    """At the edge of what others bend; and it begins where it is seen. (The rest of it: BendModel.ANewHandleLeavesWhatOthersBend.)"""
    w, points = tip_of_a_limb(window, tmp_path)
    w.drag((X + 110, Y), (X + 110, Y - 60))
    pulled = load(w.save("pulled.ply"))[0]
    w.do("mousemove", X + 60, Y, "click", 1)
    w.shot("new")
    full = load(w.save("new.ply"))[0]
    far = np.linalg.norm(pulled - points, axis=1).max()
    assert np.linalg.norm(full - pulled, axis=1).max() < 0.05 * far
    w.drag((X + 61, Y), (X + 60, Y + 40))
    w.shot("moved")
    both = load(w.save("both.ply"))[0]
    assert np.linalg.norm(both - full, axis=1).max() > 0.1


def test_what_lies_beyond_a_handle_goes_along(window, tmp_path):
    """A hand that was posed, with its elbow, pulled or turned, as it was posed; but not where it is locked."""
    w, points = tip_of_a_limb(window, tmp_path)
    faces = tube_of(*LIMB)[1]
    hand, body = points[:, 0] > 0.55, points[:, 0] < -0.1 # beyond the reach in any window: the newer ones show it larger
    w.drag((X + 200, Y), (X + 200, Y - 50))
    posed = load(w.save("posed.ply"))[0]
    assert np.linalg.norm(posed - points, axis=1)[hand].max() > 0.15
    w.drag((X + 75, Y), (X + 75, Y + 40))
    w.shot("elbow")
    elbow = load(w.save("elbow.ply"))[0]
    moved = (elbow - posed)[hand]
    assert moved.mean(0)[1] < -0.12 and np.ptp(moved, axis=0).max() < 0.02
    assert np.array_equal(elbow[body], points[body]) and most_stretched(points, elbow, faces) < 3
    w.do("mousemove", X + 75, Y + 40)
    w.key("r", "z", "3", "0", "Return")
    w.shot("turned")
    turned = load(w.save("turned.ply"))[0]
    assert turned_by(elbow[hand], turned[hand]) == pytest.approx(30, abs=2)
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("undone.ply"))[0], elbow)
    x, y, _, _ = w.box("handles")
    w.click((x + 104 + 38 + 12, y + 35)) # locks the hand
    w.do("mousemove", X + 75, Y + 40)
    w.key("g", "y", "0", "period", "2", "Return")
    w.shot("locked")
    held = np.linalg.norm(load(w.save("locked.ply"))[0] - elbow, axis=1)
    assert held.max() > 0.15 and held[np.abs(points[:, 0] - 0.75) < 0.1].min() < 1e-5 # where it is held


def test_a_limb_is_posed_joint_by_joint(window, tmp_path):
    """What goes along with a point that is turned can be pulled, and turned, by itself, and then goes along."""
    w, points = tip_of_a_limb(window, tmp_path)
    faces = tube_of(*LIMB)[1]
    w.do("mousemove", X + 75, Y)
    w.key("r", "z", "3", "0", "Return") # there is no handle yet: here
    shoulder = load(w.save("shoulder.ply"))[0]
    w.shot("shoulder")
    at = shoulder[np.argmin(np.linalg.norm(points - [0.72, 0, 0.08], axis=1))] # seen from z
    place = X + round(250 * at[0]), Y - round(250 * at[1])
    w.do("mousemove", *place, "click", 1)
    w.shot("clicked")
    far = np.linalg.norm(shoulder - points, axis=1).max()
    assert np.linalg.norm(load(w.save("clicked.ply"))[0] - shoulder, axis=1).max() < 0.05 * far
    w.key("r", "z", "4", "0", "Return")
    w.shot("elbow")
    elbow = load(w.save("elbow.ply"))[0]
    hand, arm = points[:, 0] > 0.88, points[:, 0] < 0.25
    assert turned_by(shoulder[hand], elbow[hand]) == pytest.approx(40, abs=1) and np.linalg.norm((elbow - shoulder)[arm], axis=1).max() < 0.05 * far
    assert most_stretched(points, elbow, faces) < 3
    at = elbow[np.argmin(np.linalg.norm(points - [0.3, 0, 0.08], axis=1))]
    w.do("mousemove", X + round(250 * at[0]), Y - round(250 * at[1]))
    w.key("r", "z", "minus", "6", "0", "Return")
    w.shot("again")
    again = load(w.save("again.ply"))[0]
    along = points[:, 0] > 0.45
    assert turned_by(elbow[along], again[along]) == pytest.approx(60, abs=0.5)
    off = again[along] - again[along].mean(0)
    was = elbow[along] - elbow[along].mean(0)
    turn = np.radians(-60)
    assert np.abs(off - was @ [[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]]).max() < 0.005
    w.key(*4 * ["ctrl+z"]) # the handle under the mouse, too
    assert np.array_equal(load(w.save("undone.ply"))[0], np.float32(points))
    w.key(*4 * ["ctrl+shift+z"])
    assert np.array_equal(load(w.save("redone.ply"))[0], again)
    w.key("ctrl+shift+Return")
    w.wait("ms.apply_filter")
    assert np.array_equal(load(w.save("applied.ply"))[0], again)


def test_a_turned_shoulder_leaves_the_head(window, tmp_path):
    """Though it is cut off, too, by what bends around the shoulder; the arm goes along."""
    n = 40 # squares a unit
    x, y = np.meshgrid(np.arange(-20, 60), np.arange(-60, 24), indexing="ij")
    body, arm, head = (y < 0) & (x < 20), (y < 0) & (y >= -10) & (x >= 20), (y >= 0) & (x >= 11) & (x < 19)
    x, y = x[body | arm | head], y[body | arm | head]
    corners = np.stack([np.stack([x + i, y + j], 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))], 1)
    places, squares = np.unique(corners.reshape(-1, 2), axis=0, return_inverse=True)
    squares = squares.reshape(-1, 4)
    points = np.column_stack([places / n, np.zeros(len(places))])
    w = window(write_ply(tmp_path / "sheet.ply", points, np.vstack([squares[:, :3], squares[:, [0, 2, 3]]]).astype(np.int32)))
    w.start_tool()
    w.shot("sheet")
    seen = w.seen()
    is_mesh = (np.ptp(seen, axis=-1) < 25) & (seen.min(-1) > 120)
    rows, columns = np.flatnonzero(is_mesh.sum(1) > 10), np.flatnonzero(is_mesh.sum(0) > 10)
    pixels = (columns[-1] - columns[0]) / 2
    w.do("mousemove", X - 270 + columns[0] + 1.05 * pixels, Y - 300 + rows[0] + 0.72 * pixels, "click", 1)
    w.key("r", "z", "4", "0", "Return")
    w.shot("turned")
    turned = load(w.save("turned.ply"))[0]
    head, hand = points[:, 1] > 0.4, points[:, 0] > 1.1
    assert np.array_equal(turned[head], np.float32(points)[head])
    assert turned_by(points[hand], turned[hand]) == pytest.approx(40, abs=1)


def across(w):
    """Where a grey mesh is in the view, from left to right, in pixels from its middle."""
    columns = np.flatnonzero(np.ptp(w.seen()[300], axis=-1) < 20)
    return columns[0] - 270, columns[-1] - 270


def test_a_double_click_centers_the_view(window, tmp_path):
    """As elsewhere in MeshLab; it makes no handle, and leaves those that there are."""
    points, faces = tube_of(np.linspace(-0.4, 0.4, 40), 64, 0.4)
    w = window(write_ply(tmp_path / "tube.ply", points, faces))

    def double_click(dx, button):
        count = w.text().count("Recentering on point")
        for _ in range(2): # MeshLab begins with hasToGetPickCoords unset, and may take the first one for that
            w.do("mousemove", X + dx, Y, "click", "--repeat", 2, "--delay", 60, button)
            if w.text().count("Recentering on point") > count:
                break
            time.sleep(0.6)
        w.wait("Recentering on point", count + 1, 10)
        w.do("mousemove", X, Y - 250)

    w.start_tool()
    w.do("mousemove", X, Y - 250)
    right = across(w)[1]
    double_click(right - 60, 1)
    w.shot("centered")
    assert across(w)[1] < right - 40
    w.key("g")
    w.wait("There is no handle yet")
    w.key("b")
    before = across(w)[0]
    double_click(before + 60, 3)
    w.shot("back")
    assert across(w)[0] > before + 40
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("as_it_was.ply"))[0], points)


def test_each_mode_says_what_it_does(window, tmp_path):
    """And what becomes of what is marked; brush and radius are as wide on the next layer."""
    w, _, _ = open_tube(window, tmp_path)
    w.start_tool()
    said = [state_text(w)]
    for key in ("b", "f", "u", "o", "v", "t", "l", "h"):
        w.key(key)
        said.append(state_text(w))
    assert len(set(said)) == len(said)
    w.key("b")
    w.do("mousemove", X, Y + 200, "click", "--repeat", 5, "--delay", 50, 4)

    def brush():
        x, y, width, height = w.box("brush")
        return np.asarray(w.picture().convert("L"))[y:y + height, x:x + width].tobytes()

    wider = brush()
    w.key("m")
    w.drag((X, Y), (X, Y - 60))
    places = w.text().count("trace: place: brush")
    w.key("ctrl+shift+Return")
    w.wait("trace: place: brush", places + 1)
    w.shot("next_layer")
    assert brush() == wider


def test_keys_belong_to_what_is_under_the_mouse(window, tmp_path):
    """Also after a number was typed; what the host would do with them does not happen; Esc and the slider of the pose say what they did."""
    w, points, _ = open_tube(window, tmp_path)
    before = w.save("before.ply").read_bytes()
    w.start_tool()
    x, y, width, _ = w.box("brush")
    w.click((x + 20, y + 10)) # in a number
    w.do("mousemove", X, Y)
    w.key("v", "t", "h")
    w.drag((X - 230, Y - 200), (X - 180, Y + 200))
    w.key("shift+h") # which is MeshLab's own for the trackball
    w.drag((X + 180, Y - 200), (X + 230, Y + 200))
    w.key("m", "shift+question")
    w.shot("keys")
    x, y, *_ = w.box("page")
    w.key("shift+question")
    w.press_and_move((X + 205, Y), (X + 205, Y - 60))
    w.key("ctrl+w") # nothing is closed under what is being dragged
    w.shot("dragged")
    w.do("mouseup", 1)
    bent = load(w.save("bent.ply"))[0]
    moved = np.linalg.norm(bent - points, axis=1)
    assert moved[points[:, 0] > 0.75].min() > 0.1 and not moved[points[:, 0] < -0.75].any() # two handles

    x, y, width, height = w.box("pose")
    w.do("mousemove", x + width // 2, y + height // 2, "mousedown", 1)
    for i in range(1, 6):
        w.do("mousemove", x + width // 2 - i * width // 10, y + height // 2)
    w.do("mouseup", 1, "mousemove", X, Y + 200)
    assert np.abs(load(w.save("none.ply"))[0] - points).max() < 0.01 # about 0 % of it
    w.key("ctrl+z") # one step
    assert np.array_equal(load(w.save("all.ply"))[0], bent)

    arrow = lambda: colored(w, (X + 205, Y - 60 - 60), (40, 190, 40)) # the end of it
    gizmo = arrow()
    said = state_text(w)
    w.key("Escape")
    w.shot("camera")
    assert gizmo > 20 and arrow() == 0 and state_text(w) != said
    w.key("Escape", "ctrl+z")
    assert w.save("undone.ply").read_bytes() == before


def test_a_button_that_is_released_over_a_question_ends_the_drag(window, tmp_path):
    """Such as the one that the host asks before it closes a document."""
    w, points, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.drag((X - 150, Y), (X - 150, Y - 60)) # something was changed
    w.key("b")
    w.press_and_move((X + 110, Y), (X + 110, Y - 60))
    main = w.title()
    w.key("ctrl+w")
    asked = w.wait_for_title("", other_than=main)
    w.shot("asked")
    w.do("mousemove", X, Y - 200, "mouseup", 1)
    w.key("Escape")
    w.wait_for_title("MeshLab", other_than=asked)
    w.do("mousemove", X, Y - 200, "mousemove", X, Y - 250)
    kept = w.seen()
    w.do("mousemove", X + 20, Y - 20, "mousemove", X + 60, Y + 20, "mousemove", X, Y - 250) # without the button
    w.shot("moved_on")
    assert np.array_equal(w.seen(), kept)


def test_keys_are_the_views_after_a_click_in_the_panel(window, tmp_path):
    """With the mouse still there: Ctrl+Z takes back what was done in the list, and Esc leaves a number, and gives the mouse to nobody."""
    w, points, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.drag((X + 40, Y), (X + 40, Y - 80))
    bent = load(w.save("bent.ply"))[0]
    x, y, width, _ = w.box("handles")
    w.click((x + width - 20, y + 35)) # removes it
    w.shot("removed")
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("back.ply"))[0], bent)
    w.click((x + 30, y + 35), count=2)
    w.do("type", "arm")
    w.key("Return", "ctrl+z", "ctrl+z") # the name, and the pull
    assert np.array_equal(load(w.save("at_rest.ply"))[0], points)
    x, y, *_ = w.box("brush")
    w.click((x + 20, y + 10), count=2)
    said = state_text(w)
    w.key("Escape")
    w.shot("left")
    assert state_text(w) == said
    w.key("ctrl+shift+z")
    assert np.array_equal(load(w.save("again.ply"))[0], bent)


def test_the_page_of_keys_fits_a_small_screen(window, tmp_path):
    """All of it, with room for the window's frame and bars of the desktop."""
    w, *_ = open_tube(window, tmp_path)
    w.start_tool()
    w.key("shift+question")
    w.shot("page_of_keys")
    x, y, width, height = w.box("page")
    assert x >= 0 and y >= 0 and x + width <= 1366 and y + height <= 768
    assert width <= 0.75 * 1366 and height <= 0.75 * 768
    _, _, text_width, text_height = w.box("page_text")
    assert text_width <= width and text_height <= height # nothing to scroll


def test_a_large_layer_is_prepared_beside_the_window(window, tmp_path):
    """A pull that is over before the layer is prepared is made then."""
    points, faces = tube_of(np.linspace(-1, 1, 900), 224, 0.25)
    w = window(write_ply(tmp_path / "large.ply", points, faces))
    before = w.save("before.ply").read_bytes()
    w.start_tool()
    full = w.text().count("trace: full")
    w.do("mousemove", X + 40, Y)
    w.do("mousedown", 1, "mousemove", X + 50, Y - 40, "mousemove", X + 60, Y - 80, "mouseup", 1)
    w.wait("trace: full", full + 1)
    w.shot("pulled")
    moved = np.linalg.norm(load(w.save("pulled.ply"))[0] - points, axis=1)
    assert moved.max() > 0.1 and np.mean(moved == 0) > 0.3
    w.key("ctrl+z")
    assert w.save("undone.ply").read_bytes() == before


class Asleep:
    """Threads of a process that do nothing meanwhile: those that it has begun since."""
    SEIZE, INTERRUPT, DETACH, ANY_THREAD = 0x4206, 0x4207, 17, 0x40000000

    def __init__(self, process):
        self.process, self.before = process, self.threads(process)

    @staticmethod
    def threads(process):
        return set(map(int, os.listdir(f"/proc/{process}/task")))

    @staticmethod
    def ask(what, thread):
        done = ctypes.CDLL(None, use_errno=True).ptrace(what, thread, None, None)
        if done and ctypes.get_errno() == errno.EPERM:
            pytest.skip("no process may stop another one's threads here (ptrace)")
        return done

    def fall_asleep(self):
        self.asleep = [each for each in self.threads(self.process) - self.before if self.ask(self.SEIZE, each) == 0]
        for each in self.asleep:
            self.ask(self.INTERRUPT, each)
            os.waitpid(each, self.ANY_THREAD)

    def wake_up(self):
        for each in self.asleep:
            self.ask(self.DETACH, each)

    def turn_over(self):
        """Wakes them up for a moment: one that fell asleep within malloc has a lock that the window may wait for."""
        self.wake_up()
        time.sleep(0.01)
        self.fall_asleep()

    def __enter__(self):
        self.fall_asleep()
        return self.asleep

    def __exit__(self, *error):
        self.wake_up()


@the_dialogs_are_those_of_2020
def test_a_large_layer_that_is_prepared_is_what_it_shows(window, tmp_path):
    """While the threads that prepare it sleep, a file gets the shape that is seen. And MeshLab may end meanwhile."""
    points, faces = tube_of(np.linspace(-1, 1, 900), 280, 0.25)
    w = window(write_ply(tmp_path / "large.ply", points, faces))
    w.start_tool()
    full = w.text().count("trace: full")
    w.do("mousemove", X + 100, Y, "mousedown", 1, "mousemove", X + 120, Y - 80, "mouseup", 1)
    w.wait("trace: full", full + 1)
    posed = load(w.save("posed.ply"))[0]
    assert np.abs(posed - points).max() > 0.1
    slept = 0
    is_prepared = lambda: "trace: press" in w.text().rpartition("trace: answer")[2]
    for i in range(4): # at one of these, it has begun with what takes longest
        asleep, answers = Asleep(w.meshlab.pid), w.text().count("trace: answer")
        w.do("mousemove", X - 120 + i, Y, "mousedown", 1, "mousemove", X - 130, Y + 60, "mouseup", 1, settle=False)
        w.wait("trace: answer", answers + 1)
        time.sleep(0.1 * i)
        with asleep as threads:
            if threads and not is_prepared():
                saved = w.save(f"meanwhile_{i}.ply", by_menu=True, between=asleep.turn_over)
                if not is_prepared(): # on a busy machine it is, while they turn over
                    slept += 1
                    assert np.array_equal(load(saved)[0], posed)
        w.do("mousemove", X, Y + 230)
        w.until("end of it", lambda: w.text().rpartition("trace: answer")[2].count("trace: full"))
        w.settle()
        assert np.abs(load(w.save(f"pulled_{i}.ply"))[0] - posed).max() > 0.1
        w.key("ctrl+z")
        assert np.array_equal(load(w.save(f"undone_{i}.ply"))[0], posed)
    assert slept
    asleep, answers = Asleep(w.meshlab.pid), w.text().count("trace: answer")
    w.do("mousemove", X - 110, Y, "mousedown", 1, "mousemove", X - 130, Y + 60, "mouseup", 1, settle=False)
    w.wait("trace: answer", answers + 1)
    with asleep as threads:
        assert threads
        w.do("mousemove", 36, 29, "click", 1, "sleep", 1, "mousemove", 62, 413, "click", 1, "sleep", 1, settle=False) # File, Exit
        w.do("key", "alt+y", settle=False) # it asks whether that is meant
        time.sleep(0.5)
    for _ in range(3): # a busy machine asks later
        time.sleep(1)
        if w.meshlab.poll() is None:
            w.do("key", "alt+y", settle=False)
    assert w.meshlab.wait(60) == 0


@the_dialogs_are_those_of_2020
def test_what_a_filter_makes_of_a_layer_that_is_prepared_stays(window, tmp_path):
    """One whose dialog was open before the tool."""
    points, faces = tube_of(np.linspace(-1, 1, 900), 224, 0.25)
    w = window(write_ply(tmp_path / "large.ply", points, faces))
    filters = Filters(w)
    dialog = filters.dialog("Taubin Smooth")
    w.do("windowmove", dialog, 960, 350) # not over the layer
    w.start_tool()
    asleep = Asleep(w.meshlab.pid)
    w.do("mousemove", X - 100, Y, "mousedown", 1, "mousemove", X - 130, Y + 60, "mouseup", 1, settle=False)
    w.wait("trace: answer")
    with asleep as threads:
        assert threads
        filters.apply(dialog)
        w.wait("Applied filter Taubin Smooth")
    w.wait("Nothing was done: something else has changed the layer meanwhile")
    filters.finish(dialog)
    filters.back()
    smooth = w.save("smooth.ply").read_bytes()
    assert np.abs(load(tmp_path / "smooth.ply")[0] - points).max() > 1e-6
    w.key("ctrl+z", "BackSpace")
    w.toggle_tool()
    assert w.save("left.ply").read_bytes() == smooth


def test_what_is_typed_is_a_number_or_refused(window, tmp_path):
    """With a comma before its decimals as with a point, while a handle moves and in the lists; what can be done is said at once."""
    w, points, _ = open_tube(window, tmp_path)
    w.start_tool()
    mark_two_regions(w)
    w.do("mousemove", X, Y + 200)
    handle = points[:, 0] > 0.9
    for key, text in (("g", "move: move the mouse"), ("r", "turn: move the mouse, X Y Z, degrees; wheel: how far; Enter, Esc; or drag along a limb"),
                      ("s", "scale: move the mouse")):
        w.key(key)
        assert w.said().startswith("Handle 2: " + text)
        w.key("Escape")
    w.key("g", "x", "1", "comma", "5", "Return")
    moved = load(w.save("comma.ply"))[0]
    assert np.abs((moved - points)[handle] - [1.5, 0, 0]).max() < 1e-5
    w.key("g", "y", "a", "b", "c", "1", "Return") # which goes on
    assert "abc1_, which is no number: Backspace takes back what was typed" in w.text()
    w.key("BackSpace", "BackSpace", "BackSpace", "BackSpace", "1", "Return")
    assert np.abs(load(w.save("typed_anew.ply"))[0][handle] - moved[handle] - [0, 1, 0]).max() < 1e-5
    w.key("ctrl+z", "o")
    assert "Marks now become ignored." in w.text()

    x, y, width, height = w.box("handles")
    row, cells = y + 35, lambda: np.asarray(w.picture().convert("L"))[y:y + height, x:x + width].astype(int)
    w.do("mousemove", X, Y + 200)
    before = cells()
    for place, text, said in ((x + width - 70, "foo", "The motion"), (x + 50, "", "")):
        w.click((place, row), count=2)
        w.key("ctrl+a", "BackSpace")
        if text:
            w.do("type", text)
        w.key("Return")
        w.do("mousemove", X, Y + 200)
        w.shot("typed")
        assert np.array_equal(cells(), before)
        assert said in w.said()
    assert "The motion" not in w.said() # what was refused is said until something else is done
    for key in ("Escape", "Return"): # and until it is given up
        w.click((x + width - 70, row), count=2)
        w.key("ctrl+a")
        w.do("type", "foo")
        w.key("Return")
        assert "The motion" in w.said()
        w.click((x + width - 70, row), count=2)
        w.key(key)
        w.until("another text", lambda: "The motion" not in w.said())
    w.more()
    for text in ("300", "1,5"): # the latter is not 15
        px, py, pwidth, pheight = w.box("patches")
        w.click((px + 20, py + pheight // 2))
        w.key("ctrl+a")
        w.do("type", text)
        w.key("Tab")
        w.do("mousemove", X, Y + 200)
        before = np.asarray(w.picture())[py:py + pheight, px:px + pwidth - 24] if text == "300" else before
        w.shot("patches")
        assert np.array_equal(np.asarray(w.picture())[py:py + pheight, px:px + pwidth - 24], before)


def test_of_a_large_layer_only_what_moves_is_drawn(window, tmp_path):
    """While it is dragged; what stays looks as it did, what moves as afterwards, and at the end MeshLab draws all of it again."""
    points, faces = tube_of(np.linspace(-1, 1, 640), 160, 0.4)
    colors = np.uint8(128 + 100 * np.sin(12 * points))
    w = window(write_ply(tmp_path / "large.ply", points, faces, colors=colors))
    w.start_tool()
    w.key("v", "t", "f")
    for side in (-1, 1): # marks that stay, and are seen
        w.drag((X + side * 80, Y + 200), (X + side * 280, Y - 200))
    w.key("m")
    w.do("mousemove", X, Y - 230)
    before = w.seen()
    still = np.zeros(before.shape[:2], bool)
    still[:, :150] = still[:, -150:] = True

    def press_and_drag(to):
        w.do("mousemove", X, Y, "mousedown", 1)
        for i in range(1, 5):
            w.do("mousemove", X + i * to[0] // 4, Y + i * to[1] // 4)
        w.until("drag", lambda: w.traces("drag"))
        w.settle()

    press_and_drag((30, -80))
    w.shot("dragged")
    drawn = re.findall(r"trace: moving: (\d+) of (\d+) faces", w.text())
    assert len(drawn) >= 4 and all(0 < int(some) < int(all) / 2 for some, all in drawn)
    dragged = w.seen()
    assert np.mean(abs(dragged - before).max(-1)[still] > 4) < 1e-3
    assert np.mean(abs(dragged - before).max(-1) > 40) > 0.03
    w.key("space") # no key of a drag: it goes on
    w.do("click", 4) # the wheel: other vertices move
    w.settle()
    assert np.mean(abs(w.seen() - before).max(-1)[still] > 4) < 1e-3
    w.do("click", 5)
    w.settle()
    w.do("mouseup", 1)
    w.do("mousemove", X, Y - 230)
    after = w.seen()
    w.shot("released")
    assert np.mean(abs(after - dragged).max(-1) > 40) < 0.02
    count = len(re.findall("trace: moving", w.text()))
    w.key("ctrl+z")
    w.do("mousemove", X, Y - 230)
    assert np.mean(abs(w.seen() - before).max(-1) > 4) < 1e-3
    assert len(re.findall("trace: moving", w.text())) == count # MeshLab draws it
    press_and_drag((30, -80))
    w.key("Escape")
    w.do("mouseup", 1, "mousemove", X, Y - 230)
    assert np.mean(abs(w.seen() - before).max(-1) > 4) < 1e-3
    assert np.array_equal(load(w.save("as_it_was.ply"))[0], points)


def test_esc_stops_what_was_begun_before_it(window, tmp_path):
    """However late Esc is for the preparing of a large layer, and also where the window gets the press only after it."""
    points, faces = tube_of(np.linspace(-1, 1, 900), 224, 0.25)
    w = window(write_ply(tmp_path / "large.ply", points, faces))
    before = w.save("before.ply").read_bytes()
    w.start_tool()
    for i in range(8): # until after the last step of preparing
        w.do("mousemove", X + 40 + i, Y, "mousedown", 1, "mousemove", X + 60, Y - 80, "sleep", 0.1 + 0.03 * i, "key", "Escape", "mouseup", 1)
    assert w.text().count("trace: answer") == 8
    assert not any(solve for *_, solve, _, _, _ in w.traces("full"))
    w.do("mousemove", X + 40, Y)
    w.while_asleep(w.manager, "mousedown", 1, "mousemove", X + 60, Y - 80, "key", "Escape", "mouseup", 1)
    w.shot("stopped")
    assert w.save("stopped.ply").read_bytes() == before
    full = w.text().count("trace: full")
    w.do("mousemove", X + 40, Y, "mousedown", 1, "mousemove", X + 60, Y - 80, "mouseup", 1) # the mouse is not the camera's
    w.wait("trace: full", full + 1)


@pytest.mark.parametrize("kind", ["surface", "cloud"])
def test_a_handle_is_laid_onto_another_layer(window, tmp_path, kind):
    """By Shift, where the mouse points at one, at its surface or at a point of a cloud; elsewhere it goes with the mouse."""
    w, points, _ = open_tube(window, tmp_path)
    cloud = import_another(w, tmp_path, is_cloud=kind == "cloud") # along x through y = 0.6
    choose_layer(w, 0)
    w.start_tool()
    y, other = Y + 52, Y - 94 # where the two are in the view
    w.do("mousemove", X, y, "mousedown", 1, "keydown", "shift")
    for i in range(1, 9):
        w.do("mousemove", X, y + (other - y) * i // 8)
    w.do("mouseup", 1, "keyup", "shift")
    w.shot("laid")
    laid = load(w.save("laid.ply"))[0]
    moved = np.linalg.norm(laid - points, axis=1)
    at = laid[moved > moved.max() - 1e-4] # the point, and what is held beside it
    assert moved.max() > 0.3 and abs(np.hypot(at[:, 1] - 0.6, at[:, 2]) - 0.3 * 0.25).min() < 0.01
    assert kind == "surface" or min(np.linalg.norm(cloud - each, axis=1).min() for each in at) < 1e-4 # which are 8e-3 apart or more


def test_each_mark_has_a_rim_of_its_own(window, tmp_path):
    """By Ctrl and the wheel over it: what is fixed at one side, or a handle, leaves more free around it, and the others as before."""
    w, points, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.key("v", "t", "f")
    w.drag((X - 280, Y - 200), (X + 280, Y + 200)) # all of it
    w.key("h")
    w.drag((X - 40, Y - 200), (X + 40, Y + 200))
    w.key("m")

    def moved(name):
        """How many are between the handle and what is fixed, at its left and at its right."""
        w.do("mousemove", X, Y)
        w.key("g", "y", "0", "period", "1", "Return")
        off = np.linalg.norm(load(w.save(name))[0] - points, axis=1)
        w.key("ctrl+z")
        free = (off > 0) & (off < 0.0999)
        return [np.count_nonzero(free & (np.sign(points[:, 0]) == side)) for side in (-1, 1)]

    def turn_wheel(place, button):
        w.do("mousemove", *place, "keydown", "ctrl")
        w.do("click", "--repeat", 10, "--delay", 30, button, "keyup", "ctrl")

    left, right = moved("before.ply")
    assert left > 0 and 0.7 < left / right < 1.4
    turn_wheel((X - 180, Y), 4)
    w.shot("wider_at_the_left")
    wider = moved("left.ply")
    assert wider[0] > 1.6 * left and wider[1] == right
    w.key("ctrl+z") # one way of the wheel
    assert moved("undone.ply") == [left, right]
    turn_wheel((X, Y), 5) # the handle's gets narrower: those of what is fixed are left
    assert moved("handle.ply") == [left, right]
    turn_wheel((X + 180, Y), 5)
    narrower = moved("right.ply")
    w.shot("narrower_at_the_right")
    assert narrower[0] == left and narrower[1] < 0.6 * right


def test_axes_and_steps(window, tmp_path):
    """Of the surface: z is its normal; with Ctrl, a drag goes in round lengths."""
    w, points, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.key("v", "h")
    w.drag((X - 40, Y - 55), (X + 40, Y - 15)) # what is seen of the upper half
    w.key("m")
    w.do("mousemove", *w.place("axes"), "click", "--repeat", 3, "--delay", 100, 5) # the wheel: Surface
    w.do("mousemove", X - 200, Y - 180)
    w.key("g", "z", "1", "Return")
    moved = load(w.save("along.ply"))[0] - points
    along = moved[np.linalg.norm(moved, axis=1).argmax()]
    assert np.linalg.norm(along) == pytest.approx(1, abs=1e-3)
    assert abs(along[0]) < 0.05 and along[1] > 0.4 and along[2] > 0.4
    w.key("ctrl+z")
    w.do("mousemove", X, Y - 30, "mousedown", 1, "keydown", "ctrl")
    for i in range(1, 6):
        w.do("mousemove", X + 12 * i, Y - 30 - 9 * i)
    w.do("mouseup", 1, "keyup", "ctrl")
    w.shot("in_steps")
    moved = load(w.save("in_steps.ply"))[0] - points
    steps = moved[np.linalg.norm(moved, axis=1).argmax()] / 0.05 # 20 pixels are 0.08
    assert np.abs(steps).max() > 1 and np.abs(steps - steps.round()).max() < 1e-3


def keep_pose(w, name):
    """By the panel, where the name is typed at once."""
    kept = w.text().count("The layer keeps the pose")
    w.click(w.place("keep"))
    w.wait("The layer keeps the pose", kept + 1)
    w.do("type", "--delay", 5, name)
    w.key("Return")


def tube_with_poses(window, tmp_path, colors=None):
    """A window with the tool, the list of poses and two marked regions; and what they are on."""
    points, faces, tags = tube_with_ends()
    w = window(write_ply(tmp_path / "tube.ply", points, faces, colors=colors))
    w.start_tool()
    w.unfold("poses_fold", "keep")
    mark_two_regions(w, 310)
    return w, points, faces, tags


def row_of_poses(w, i):
    x, y, width, _ = w.box("poses")
    return x, y + 35 + 22 * i, width


def show_percent(w, i, percent):
    x, y, width = row_of_poses(w, i)
    full = w.text().count("trace: full")
    w.click((x + width - 40, y), count=2)
    w.do("type", "--delay", 5, percent)
    w.key("Return")
    w.wait("trace: full", full + 1)
    w.settle()


def test_a_pose_is_as_it_was_kept_when_its_point_is_turned_later(window, tmp_path):
    """Though the point holds more from then on."""
    w, points = tip_of_a_limb(window, tmp_path)
    w.drag((X + 110, Y), (X + 110, Y - 60))
    pulled = load(w.save("pulled.ply"))[0]
    w.do("mousemove", X, Y + 230) # where it changes nothing that the panel says
    w.unfold("poses_fold", "keep")
    keep_pose(w, "up")
    w.do("mousemove", X + 110, Y - 60)
    w.key("r", "z", "4", "5", "Return")
    turned = load(w.save("turned.ply"))[0]
    assert np.linalg.norm(turned - pulled, axis=1).max() > 0.2
    x, y, _ = row_of_poses(w, 0)
    w.click((x + 30, y))
    shown = load(w.save("shown.ply"))[0]
    w.shot("shown")
    tip = points[:, 0] > 0.75
    assert turned_by(points[tip], pulled[tip]) > 20 and turned_by(pulled[tip], shown[tip]) < 2
    assert np.linalg.norm(shown - pulled, axis=1).max() < 0.2 * np.linalg.norm(pulled - points, axis=1).max()


@pytest.mark.parametrize("is_marked", [False, True], ids=["pulled", "marked"])
def test_a_pose_is_as_it_was_kept_when_another_handle_is_made_later(window, tmp_path, is_marked):
    """On what goes along with its own one."""
    w, points = tip_of_a_limb(window, tmp_path)
    w.do("mousemove", X + 75, Y)
    w.key("r", "z", "3", "0", "Return")
    turned = load(w.save("turned.ply"))[0]
    w.do("mousemove", X, Y + 230)
    w.unfold("poses_fold", "keep")
    keep_pose(w, "up")
    at = turned[np.argmin(np.linalg.norm(points - [0.72, 0, 0.08], axis=1))] # seen from z
    place = X + round(250 * at[0]), Y - round(250 * at[1])
    if is_marked:
        w.do("mousemove", *place) # the keys are the view's
        w.key("v", "shift+h")
        w.drag((place[0] - 15, place[1] - 35), (place[0] + 15, place[1] + 35))
        w.key("m")
    w.drag(place, (place[0], place[1] + 50))
    pulled = load(w.save("pulled.ply"))[0]
    assert np.linalg.norm(pulled - turned, axis=1).max() > 0.15
    x, y, _ = row_of_poses(w, 0)
    w.click((x + 30, y))
    w.shot("shown")
    shown = load(w.save("shown.ply"))[0]
    assert np.linalg.norm(shown - turned, axis=1).max() < 0.05 * np.linalg.norm(turned - points, axis=1).max()


def test_a_handle_is_dragged_where_an_arrow_of_another_one_lies_over_it(window, tmp_path):
    points, faces = tube_of(*LIMB[:2], 0.04) # so thin that two handles are near, and the first one still beyond the second
    w = window(write_ply(tmp_path / "limb.ply", points, faces))
    w.start_tool()
    w.drag((X + 150, Y), (X + 150, Y - 6))
    w.drag((X + 95, Y), (X + 95, Y - 40)) # with what lies beyond it; its arrow along x ends at 155
    before = load(w.save("before.ply"))[0]
    w.shot("under an arrow")
    w.drag((X + 150, Y - 46), (X + 150, Y - 86))
    w.shot("dragged")
    moved = (load(w.save("after.ply"))[0] - before)[:, 1]
    at = lambda x: np.argmin(np.linalg.norm(points - [x, 0, 0.04], axis=1))
    pixels = 285 # a unit, at the side that is seen
    assert abs(moved[at(150 / pixels)] - 40 / pixels) < 0.03 and abs(moved[at(95 / pixels)]) < 0.03


def test_keys_act_on_what_is_under_the_mouse_or_was_chosen(window, tmp_path):
    """On a place that is no handle yet, too; but where one was clicked, wherever the mouse is."""
    w, points = tip_of_a_limb(window, tmp_path)
    w.drag((X + 180, Y), (X + 180, Y - 30))
    pulled = load(w.save("pulled.ply"))[0]
    w.do("mousemove", X - 180, Y)
    w.key("r", "z", "3", "0", "Return")
    turned = load(w.save("turned.ply"))[0]
    w.shot("turned")
    left, right = points[:, 0] < -0.75, points[:, 0] > 0.4
    assert turned_by(points[left], turned[left]) > 25 and np.abs(turned[right] - pulled[right]).max() < 0.02
    w.click((X + 180, Y - 30))
    w.do("mousemove", X + 20, Y)
    w.key("g", "y", "0", "period", "1", "Return")
    moved = load(w.save("moved.ply"))[0] - turned
    w.shot("moved")
    at = np.argmin(np.linalg.norm(points - [180 / 250, 0, 0.08], axis=1))
    assert np.abs(moved[at] - [0, 0.1, 0]).max() < 0.02 and np.abs(moved[points[:, 0] < 0.1]).max() < 0.005


def test_rings_take_presses_and_keys_take_the_surface(window, tmp_path):
    """Where a ring of a handle's gizmo lies over a place, R turns the place, and a drag turns the handle; the panel says both."""
    w, points = tip_of_a_limb(window, tmp_path)
    w.drag((X + 110, Y), (X + 110, Y - 10))
    pulled = load(w.save("pulled.ply"))[0]
    on_ring = X + 110 - 42, Y - 8
    said = w.said
    w.do("mousemove", *on_ring)
    w.shot("on_ring")
    assert said().startswith("Handle 2: drag turns it about z. G, R, S: this point.")
    w.key("r")
    assert said().startswith("Handle 3: turn")
    w.key("Escape")
    w.press_and_move(on_ring, (X + 110, Y - 50))
    assert said().startswith("Handle 2: turn about z")
    w.key("Escape")
    w.do("mouseup", 1)
    assert np.array_equal(load(w.save("as_it_was.ply"))[0], pulled)


def yellow(w):
    """Which columns of the view have much of the colour of what would move, and how strong it is there at most."""
    seen = w.seen()[200:400]
    return (seen[..., 0] - seen[..., 2]).max(0)


@pytest.mark.parametrize("rings, columns", [(120, 32), (1040, 128)], ids=["small", "134_thousand"])
def test_what_would_move_is_seen_before(window, tmp_path, rings, columns):
    """Under the mouse, by how much it would, and while R waits; the wheel changes it; beside the mesh, and afterwards, nothing is tinted."""
    points, faces = tube_of(np.linspace(-1, 1, rings), columns, 0.08)
    w = window(write_ply(tmp_path / "limb.ply", points, faces))
    w.start_tool()
    foreseen = lambda: re.findall(r"trace: foreseen: \d+ vertices, (\d+) move, ([\d.]+) ms", w.text())

    def hover(place):
        """Until it is shown: the surface is read meanwhile."""
        count = len(foreseen())
        for i in range(40):
            w.do("mousemove", place[0] + i % 2, place[1])
            if len(foreseen()) > count:
                break
            time.sleep(0.1)
        w.settle()

    w.do("mousemove", X, Y + 200)
    assert yellow(w).max() < 15
    hover((X + 75, Y))
    w.shot("hover")
    tint = yellow(w)
    at = lambda x: tint[270 + x - 3:270 + x + 4].max()
    assert at(-60) < 15 and at(0) < at(75) - 30 and at(200) > 60 # stays, bends, moves
    for i in range(8):
        hover((X + 60 + 15 * i, Y))
    milliseconds = sorted(float(each) for _, each in foreseen())
    print(f"\n{rings * columns} vertices: {milliseconds} ms")
    w.key("shift+j") # of a limb the same
    seen = len(foreseen())
    for i in range(8):
        hover((X + 60 + 15 * i, Y))
    of_limbs = sorted(float(each) for _, each in foreseen()[seen:])
    print(f"limbs: {of_limbs} ms")
    w.key("m")
    w.do("mousemove", X, Y + 200)
    assert yellow(w).max() < 15
    w.do("mousemove", X + 75, Y)
    w.key("r")
    w.shot("waits")
    waits = yellow(w)
    w.do("click", "--repeat", 6, "--delay", 50, 4)
    w.shot("wider")
    wider = yellow(w)
    assert np.count_nonzero(wider > 40) > np.count_nonzero(waits > 40) + 15
    w.key("Escape")
    w.do("mousemove", X, Y + 200)
    assert yellow(w).max() < 15
    assert np.array_equal(load(w.save("as_it_was.ply"))[0], points)


def test_what_symmetry_moves_is_seen_before(window, tmp_path):
    """Both sides are tinted, also while they are dragged; where there is no other side, the panel says so."""
    points, faces = tube_of(np.linspace(-1, 1, 120), 32, 0.08)
    w = window(write_ply(tmp_path / "limb.ply", points, faces))
    w.start_tool()
    sides = lambda: [yellow(w)[part].max() > 60 for part in (slice(0, 200), slice(340, 540))]

    def hover(place):
        for i in range(4):
            w.do("mousemove", place[0] + i % 2, place[1], "sleep", 0.1)

    hover((X + 150, Y))
    assert sides() == [False, True]
    w.click(w.place("mirror"))
    w.key("Home", "Down", "Return") # x
    hover((X + 150, Y))
    w.shot("both")
    assert sides() == [True, True]
    w.do("mousemove", X, Y + 200)
    assert sides() == [False, False]
    w.key("d")
    w.press_and_move((X + 150, Y), (X + 140, Y - 60))
    w.shot("dragged")
    assert sides() == [True, True] and "Symmetry" not in w.said()
    w.do("mouseup", 1)
    moved = np.abs(load(w.save("both.ply"))[0] - points).max(1)
    assert all(moved[side].max() > 0.1 for side in (points[:, 0] > 0.5, points[:, 0] < -0.5))


def folded(rest, now, faces):
    """How many edges there are at which a surface that was nearly flat is folded back: normals of the faces beside it by more than 90 degrees."""
    def normals(p):
        n = np.cross(p[faces[:, 1]] - p[faces[:, 0]], p[faces[:, 2]] - p[faces[:, 0]])
        return n / np.maximum(np.linalg.norm(n, axis=1), 1e-30)[:, None]
    edges = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    order = np.lexsort(edges.T)
    same = np.flatnonzero((edges[order][1:] == edges[order][:-1]).all(1))
    one, other = order[same] % len(faces), order[same + 1] % len(faces)
    cosine = lambda p: np.einsum("ij,ij->i", normals(p)[one], normals(p)[other])
    return np.count_nonzero((cosine(rest) > 0.5) & (cosine(now) < 0))


def open_figure(window, tmp_path, mode="m"):
    """A tube of which the half of x < 0 is three times as thick: a body with a limb. The window in the tool, points, faces, which are the body."""
    points, faces = tube_of(np.linspace(-1, 1, 200), 32, 0.08)
    body = points[:, 0] < 0
    points[:, 1:] *= np.clip(np.where(points[:, 0] < 0.05, 3 - 40 * np.maximum(points[:, 0], 0), 1), 1, 3)[:, None]
    w = window(write_ply(tmp_path / "figure.ply", points.astype(np.float32), faces))
    w.start_tool(mode=mode)
    return w, points, faces, body


def test_what_a_drag_does_is_said_once_the_surface_is_read(window, tmp_path):
    """Not that it pulls where it will turn, and without another move of the mouse. All that is said of keys is seen without scrolling."""
    points, faces = tube_of(*LIMB)
    points[points[:, 0] < -0.4, 1:] *= 3 # a body
    w = window(write_ply(tmp_path / "limb.ply", points, faces))
    w.start_tool(mode=None) # Drag
    w.do("mousemove", X + 5, Y)
    said = re.findall("trace: says: (.*)", w.text())
    assert said[-2:] == ["Reading the surface: in a moment you see what a drag moves.",
                         "Drag this: its limb turns so that it follows. G pulls it alone."]
    w.shot("read")
    w.key("r")
    w.shot("keys")
    w.key("s", "g", "shift+j", "Escape", "j", "Escape")
    w.press_and_move((X + 150, Y), (X + 140, Y - 60))
    w.shot("dragged")
    w.do("click", 4, "mouseup", 1)
    w.key("r", "Escape")
    heights = re.findall(r"trace: text: (\d+) of (\d+) pixels", w.text())
    assert len(heights) > 8 and all(int(text) <= int(room) for text, room in heights), heights


def test_a_limb_follows_the_mouse(window, tmp_path):
    """After J: the place under the mouse goes with it, what is beyond turns as a whole, what is before the limb stays, nothing is squeezed;
    and later, further along, the limb turns where it did."""
    w, points, faces, body = open_figure(window, tmp_path)
    said = w.said
    w.do("mousemove", X + 180, Y)
    w.key("j")
    assert said().startswith("Handle 2: turn the limb: move the mouse")
    for i in range(1, 9): # on a circle about the joint
        place = X + 25 + round(155 * np.cos(np.radians(5 * i))), Y - round(155 * np.sin(np.radians(5 * i)))
        w.do("mousemove", *place)
    w.shot("limb")
    w.key("Return")
    turned = load(w.save("turned.ply"))[0]
    hand = points[:, 0] > 0.45
    assert np.abs(turned[body] - points[body]).max() < 0.03
    assert 25 < turned_by(points[hand], turned[hand]) < 60
    assert most_stretched(points, turned, faces) < 2.2
    at = np.argmin(np.linalg.norm(points - [180 / 285, 0, 0.08], axis=1))
    assert np.abs(turned[at, :2] - [(place[0] - X) / 285, (Y - place[1]) / 285]).max() < 0.06 # pixels a unit, at the side that is seen
    w.do("mousemove", *place)
    w.key("j")
    assert said().startswith("Handle 2: turn the limb") # again the same one
    w.key("x", "9", "0", "Return")
    assert "Handle 2: turn about x 90_" in w.text()
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("undone.ply"))[0], turned)
    w.do("mousemove", X - 180, Y)
    w.key("j")
    w.wait("There is no limb here to turn")
    assert np.array_equal(load(w.save("as_it_was.ply"))[0], turned)
    w.key("v", "shift+h")
    w.drag((X - 220, Y - 40), (X - 140, Y + 40))
    w.key("m")
    w.do("mousemove", X - 180, Y)
    w.key("j")
    w.wait("A marked handle is no point of a limb: R turns it.")


def test_a_finger_turns_by_itself(window, tmp_path):
    """Also where the arm that has it was turned before."""
    points, faces = tube_of(np.linspace(-1, 1, 200), 32, 1)
    points[:, 1:] *= np.interp(points[:, 0], [0, 0.05, 0.72, 0.75], [0.24, 0.08, 0.08, 0.03])[:, None] # body, arm, finger
    w = window(write_ply(tmp_path / "figure.ply", points.astype(np.float32), faces))
    w.start_tool(mode=None)
    said = w.said

    def place(p):
        pixels = 285 * 1.95 / (2.03 - p[2]) # a unit: the camera is 2.03 away
        return X + round(pixels * p[0]), Y - round(pixels * p[1])

    arm, finger = (points[:, 0] > 0.4) & (points[:, 0] < 0.7), points[:, 0] > 0.9
    tip = np.flatnonzero(finger & (points[:, 0] < 0.95) & (points[:, 2] > 0))
    w.drag(place([0.4, 0, 0.08]), place([0.4, 0.1, 0.08]))
    assert "Handle 2: turn the limb by" in w.text()
    turned = load(w.save("turned.ply"))[0]
    assert 10 < turned_by(points[arm], turned[arm]) < 35 and abs(turned_by(points[arm], turned[arm]) - turned_by(points[finger], turned[finger])) < 1
    at = turned[tip].mean(0)
    w.drag(place(at), place(at + [-0.03, 0.1, 0]))
    w.shot("finger")
    assert "Handle 3: turn the limb by" in w.text()
    bent = load(w.save("bent.ply"))[0]
    assert np.abs(bent[arm] - turned[arm]).max() < 1e-3 and turned_by(turned[finger], bent[finger]) > 15
    w.drag(place([0.4, 0.1, 0.08]), place([0.4, 0, 0.08])) # the arm, by its own handle, with the finger as it is bent
    back = load(w.save("back.ply"))[0]
    assert said().startswith("Handle 2") or "Handle 4" not in w.text()
    assert turned_by(points[arm], back[arm]) < 8 and abs(turned_by(turned[finger], bent[finger]) - turned_by(points[finger], back[finger])) < 8


def test_a_limb_is_turned_by_a_drag(window, tmp_path):
    """In the mode that the tool begins in, Drag, as after J. What would turn is tinted before. Elsewhere, and in the mode Pull, by its button or
    its key, a drag pulls the place alone; so does G during a drag."""
    w, points, faces, body = open_figure(window, tmp_path, mode=None)
    said = w.said
    foreseen = lambda: [int(found) for found in re.findall(r"trace: foreseen: \d+ vertices, (\d+) move", w.text())]
    for i in range(40): # until it is shown: the surface is read meanwhile
        w.do("mousemove", X + 170 + i % 2, Y)
        if foreseen():
            break
    w.do("mousemove", X + 180, Y)
    assert said().startswith("Drag this: its limb turns so that it follows.")
    w.shot("foreseen")
    assert foreseen()[-1] > 0.8 * np.count_nonzero(points[:, 0] > 0.1) # all of the limb
    place = X + 135, Y - 110
    w.drag((X + 180, Y), place)
    w.shot("turned")
    turned = load(w.save("turned.ply"))[0]
    hand = points[:, 0] > 0.45
    assert np.abs(turned[body] - points[body]).max() < 0.03 and 25 < turned_by(points[hand], turned[hand]) < 60
    assert most_stretched(points, turned, faces) < 2.2
    w.drag((X + 78, Y - 55), (X + 98, Y - 39)) # a place that the handle holds follows
    w.shot("turned_back")
    back = load(w.save("turned_back.ply"))[0]
    under = np.flatnonzero(np.linalg.norm(turned[:, :2] - np.array([78, 55]) / 285, axis=1) < 0.03)
    at = under[turned[under, 2].argmax()]
    assert np.abs(back[at, :2] - turned[at, :2] - np.array([20, -16]) / 285).max() < 0.025
    assert turned_by(points[hand], back[hand]) < turned_by(points[hand], turned[hand]) - 10
    w.key("ctrl+z")
    w.do("mousemove", X - 180, Y)
    assert not said().startswith("Drag this: its limb")
    w.press_and_move((X - 180, Y), (X - 180, Y - 30)) # the body is no limb
    assert said().startswith("Handle 3: move by")
    w.key("Escape")
    w.do("mouseup", 1)
    w.press_and_move(place, (place[0] - 20, place[1] - 30))
    assert said().startswith("Handle 2: turn the limb by")
    w.key("g")
    assert said().startswith("Handle 3: move by")
    w.key("Escape")
    w.do("mouseup", 1)
    w.click(w.place("mode1"))
    w.drag(place, (place[0] - 20, place[1] - 30))
    assert said().startswith("Drag")
    w.shot("pulled")
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("undone.ply"))[0], turned)
    w.key("d")
    w.do("mousemove", *place)
    assert said().startswith("Drag this: its limb turns")
    w.drag(place, (X + 180, Y)) # back, by the same handle
    assert w.text().count("Handle 3: turn the limb") == 0
    assert np.abs((load(w.save("back.ply"))[0] - points)[hand].mean(0)[:2]).max() < 0.05


def test_the_wheel_takes_a_joint_nearer_to_the_mouse(window, tmp_path):
    """During the drag of a limb: what is before that joint stays, and what was dragged follows the mouse; up, it is as it was."""
    w, points, faces, body = open_figure(window, tmp_path, mode=None)
    upper, hand = np.abs(points[:, 0] - 0.25) < 0.03, points[:, 0] > 0.8
    place = X + 200, Y - 80
    shapes, seen = [], [w.seen()]
    for name, turns in (("root", ()), ("nearer", (5, 5)), ("back", (5, 5, 4, 4))):
        w.press_and_move((X + 230, Y), place)
        assert w.said().startswith("Handle 2: turn the limb by") and "; wheel: another joint" in w.said()
        for button in turns:
            w.do("click", button)
        w.shot(name)
        seen.append(w.seen()) # the mouse has not moved since
        w.do("mouseup", 1)
        shapes.append(load(w.save(name + ".ply"))[0])
        w.key("ctrl+z")
        assert np.array_equal(load(w.save(name + "_undone.ply"))[0], np.float32(points)) # in one step
    root, nearer, back = shapes
    assert np.linalg.norm((root - points)[upper], axis=1).mean() > 0.03
    assert np.linalg.norm((nearer - points)[upper], axis=1).mean() < 0.01
    assert turned_by(points[hand], nearer[hand]) > turned_by(points[hand], root[hand]) + 5 # it is shorter
    assert np.abs(back - root).max() < 1e-4
    changed = lambda k: np.count_nonzero(np.abs(seen[3] - seen[k]).sum(2) > 60)
    assert changed(1) < 0.2 * changed(0)


def test_what_is_fixed_bounds_a_drag_without_a_handle(window, tmp_path):
    w, points, *_ = open_figure(window, tmp_path, mode=None)
    w.key("v", "t", "f")
    w.drag((X - 280, Y - 100), (X - 150, Y + 100))
    w.key("d")
    w.do("mousemove", X + 230, Y)
    w.shot("fixed")
    assert w.said().startswith("Drag a point: all that is not fixed bends."), w.said()


def bent_arm():
    """A thick trunk along x, with an arm that is bent by 60 degrees: places along the arm and around it, points, faces."""
    straight, faces = tube_of(np.linspace(-1, 1, 300), 32, 0.08)
    x, y, z = straight.T
    thick = np.where(x < 0, 3, 1)
    ways = np.linspace(0, 1, 1001)
    turn = lambda at: np.radians(60) * np.clip((at - 0.5) / 0.06 + 0.5, 0, 1)
    line = np.cumsum([np.cos(turn(ways)), -np.sin(turn(ways))], 1) / 1000
    middle = [np.minimum(x, 0) + np.interp(x, ways, line[0]) * (x > 0), np.interp(x, ways, line[1]) * (x > 0)]
    points = np.stack([middle[0] + thick * y * np.sin(turn(x)), middle[1] + thick * y * np.cos(turn(x)), thick * z], 1).astype(np.float32)
    return straight, points, faces


def test_a_bent_limb_turns_where_it_is_bent(window, tmp_path):
    """A drag of the forearm turns it at the elbow, also after the shoulder was turned; wheel up: at the shoulder."""
    straight, points, faces = bent_arm()
    x, y, z = straight.T
    w = window(write_ply(tmp_path / "figure.ply", points, faces))
    w.start_tool(mode=None)
    center, scale = (points.min(0) + points.max(0)) / 2, 285 * 2.11 / np.linalg.norm(np.ptp(points, axis=0))
    seen = lambda now, at: tuple((np.array([X, Y]) + scale * (now[at] - center)[:2] * [1, -1]).round().astype(int))
    nearest = lambda at: np.argmin(abs(x - at) + abs(y) + (z < 0))
    part = lambda begin, end: (begin < x) & (x < end)
    upper, fore = part(0.2, 0.4), part(0.65, 0.95)

    def drag(name, now, at, by, wheel=()):
        begin = seen(now, nearest(at))
        w.press_and_move(begin, (begin[0] + by[0], begin[1] + by[1]))
        for button in wheel:
            w.do("click", button)
        w.shot(name)
        w.do("mouseup", 1)
        return load(w.save(name + ".ply"))[0]

    at_elbow = drag("at_elbow", points, 0.85, (40, -20))
    assert turned_by(points[fore], at_elbow[fore]) > 8 and np.abs(at_elbow - points)[upper | part(-1, 0)].max() < 0.01
    w.key("ctrl+z")
    at_shoulder = drag("at_shoulder", points, 0.85, (40, -20), [4])
    assert turned_by(points[upper], at_shoulder[upper]) > 4
    assert abs(turned_by(points[upper | fore], at_shoulder[upper | fore]) - turned_by(points[upper], at_shoulder[upper])) < 1 # as one
    w.key("ctrl+z")
    shoulder = drag("shoulder", points, 0.35, (0, -25))
    assert turned_by(points[upper], shoulder[upper]) > 8
    elbow = drag("elbow", shoulder, 0.85, (40, -20))
    assert turned_by(shoulder[fore], elbow[fore]) > 8 and w.text().count("Handle 3: turn") > 0


def test_a_bent_limb_of_a_layer_with_a_matrix_keeps_its_handle(window, tmp_path):
    straight, points, faces = bent_arm()
    write_ply(tmp_path / "figure.ply", points, faces)
    (tmp_path / "moved.mlp").write_text("""<!DOCTYPE MeshLabDocument><MeshLabProject><MeshGroup><MLMesh label="figure.ply" filename="figure.ply">
<MLMatrix44>1 0 0 5 \n0 1 0 3 \n0 0 1 0 \n0 0 0 1 \n</MLMatrix44></MLMesh></MeshGroup><RasterGroup/></MeshLabProject>""")
    w = window(tmp_path / "moved.mlp")
    w.start_tool(mode=None)
    wrist = np.argmin(abs(straight[:, 0] - 0.85) + abs(straight[:, 1]) + (straight[:, 2] < 0))
    center, scale = (points.min(0) + points.max(0)) / 2, 285 * 2.11 / np.linalg.norm(np.ptp(points, axis=0))
    begin = (np.array([X, Y]) + scale * (points[wrist] - center)[:2] * [1, -1]).round().astype(int)
    for by in (20, -20):
        w.drag(tuple(begin), tuple(begin + [by, -by]))
        w.shot(f"dragged{by}")
    assert w.text().count("Handle 2: turn") > 0 and w.text().count("Handle 3") == 0


def test_a_far_drag_of_a_limb_folds_nothing(window, tmp_path):
    """Sideways by more than it is long, to its joint, where it turns to the eye, and away from it: by a press and a drag, without a key."""
    w, points, faces, body = open_figure(window, tmp_path, mode=None)
    for way in ((0, -280), (-150, -10), (80, 0)):
        w.drag((X + 180, Y), (X + 180 + way[0], Y + way[1]))
        w.shot(f"dragged{way[0]}_{way[1]}")
        now = load(w.save(f"dragged{way[0]}_{way[1]}.ply"))[0]
        assert np.abs(now[body] - points[body]).max() < 0.05
        assert most_stretched(points, now, faces) < 3 and folded(points, now, faces) <= 2 # of 19 thousand, where it turns by 90 degrees
        w.key("ctrl+z")
        assert np.array_equal(load(w.save(f"undone{way[0]}_{way[1]}.ply"))[0], np.float32(points)) # in one step
    w.click(w.place("mirror"))
    w.key("Home", "Down", "Return") # in x, where the body is too thick for a twin
    w.press_and_move((X + 180, Y), (X + 180, Y - 100))
    assert "\nSymmetry finds nothing on the other side: this side moves alone.\n" in w.said()
    w.key("Escape")
    w.do("mouseup", 1)
    w.key("m")
    w.drag((X + 180, Y), (X + 30, Y - 10))
    w.shot("pulled")
    assert folded(points, load(w.save("pulled.ply"))[0], faces) > 5 # which is why it turns


def test_a_limb_of_two_joints_bends_between(window, tmp_path):
    """An arm whose shoulder and elbow were turned: a drag of its hand towards the shoulder bends the elbow and turns the shoulder, the hand follows
    the mouse, and all of it is one step; while the shoulder is locked, the forearm turns alone."""
    w, points, faces, body = open_figure(window, tmp_path, mode=None)
    said = w.said
    place = lambda now, at: (X + round(285 * now[at, 0]), Y - round(285 * now[at, 1]))
    hand = np.argmin(np.linalg.norm(points - [0.9, 0, 0.08], axis=1)) # at the side that is seen
    w.drag((X + 250, Y), (X + 248, Y - 30))
    turned = load(w.save("turned.ply"))[0]
    w.do("mousemove", *place(turned, np.argmin(np.linalg.norm(points - [0.6, 0, 0.08], axis=1))))
    w.key("r", "z", "3", "0", "Return")
    bent = load(w.save("bent.ply"))[0]
    begin = place(bent, hand)
    w.do("mousemove", *begin)
    w.shot("foreseen")
    goal = begin[0] - 60, begin[1] + 20
    w.press_and_move(begin, goal)
    assert ", its middle joint by" in said()
    w.do("mouseup", 1)
    w.shot("chain")
    chain = load(w.save("chain.ply"))[0]
    assert np.abs(chain[hand, :2] - bent[hand, :2] - np.array([-60, -20]) / 285).max() < 0.03
    upper = np.abs(points[:, 0] - 0.35) < 0.05
    assert turned_by(bent[upper], chain[upper]) > 5 and np.abs(chain[body] - points[body]).max() < 0.03
    assert most_stretched(points, chain, faces) < 3 and folded(points, chain, faces) == 0
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("undone.ply"))[0], bent)
    x, y, _, _ = w.box("handles")
    w.click((x + 104 + 38 + 12, y + 35)) # locks the shoulder
    w.press_and_move(begin, goal)
    assert "turn the limb by" in said() and "middle joint" not in said()
    w.do("mouseup", 1)
    alone = load(w.save("alone.ply"))[0]
    assert turned_by(bent[upper], alone[upper]) < 0.4 * turned_by(bent[upper], chain[upper]) # it bends near there


def test_a_stroke_along_a_limb_gives_the_joint(window, tmp_path):
    """Where R was pressed: what lies beyond turns about the middle of the limb there, what lies before it stays, and all of it is one step
    of undo. Esc, a click, and a stroke towards the body change nothing."""
    w, points, faces, body = open_figure(window, tmp_path)
    said = w.said
    shape = lambda name: load(w.save(name + ".ply"))[0]

    def stroke(start, end):
        w.do("mousemove", *start)
        w.key("r")
        w.settle()
        w.press_and_move(start, end)

    scale = 285 # pixels a unit, at the side that is seen
    joint, end = (X + round(0.4 * scale), Y), (X + round(0.8 * scale), Y + 5)
    stroke(joint, end)
    assert said().startswith("Drag along the limb: the tinted part turns where you began.")
    w.shot("drawn")
    tint = yellow(w)
    assert tint[270 + 114 + 60:270 + 240].min() > 40 and tint[:270 + 60].max() < 15 # beyond, and the body
    w.key("Escape")
    w.do("mouseup", 1)
    w.shot("cancelled")
    assert yellow(w).max() < 15 and np.array_equal(shape("cancelled"), np.float32(points))
    stroke(joint, (joint[0] + 3, Y))
    w.do("mouseup", 1)
    w.do("mousemove", X, Y - 100)
    assert np.array_equal(shape("clicked"), np.float32(points)) and not said().startswith("Handle")
    stroke((X + 180, Y), (X + 60, Y))
    w.do("mouseup", 1)
    w.wait("There is no free limb beyond this stroke: draw it from a joint towards the end of the limb.")
    assert np.array_equal(shape("refused"), np.float32(points))

    stroke(joint, end)
    w.do("mouseup", 1)
    assert said().startswith("Handle 2: turn: move the mouse")
    w.key("z", "3", "0")
    w.shot("turning")
    w.key("Return")
    turned = shape("turned")
    beyond, before = points[:, 0] > 0.4 + 0.16, points[:, 0] < 0.4 - 0.16
    assert np.abs(turned[before] - points[before]).max() < 1e-6
    assert turned_by(points[beyond], turned[beyond]) == pytest.approx(30, abs=0.5)
    pivot = np.array([0.4, 0, 0])
    turn = np.array([[np.cos(np.pi / 6), np.sin(np.pi / 6), 0], [-np.sin(np.pi / 6), np.cos(np.pi / 6), 0], [0, 0, 1]])
    assert np.abs((points - pivot) @ turn + pivot - turned)[beyond].max() < 0.03
    assert most_stretched(points, turned, faces) < 1.8
    w.key("ctrl+z")
    assert np.array_equal(shape("undone"), np.float32(points))
    w.key("ctrl+shift+z")
    assert np.array_equal(shape("redone"), turned)

    hand = X + round(scale * 0.75), Y - round(scale * 0.2) # of what is turned, another joint, which goes with it
    stroke(hand, (hand[0] + 50, hand[1] - 29))
    w.do("mouseup", 1)
    assert said().startswith("Handle 3: turn: move the mouse")
    w.key("z", "minus", "3", "0", "Return")
    w.shot("hand")
    again = shape("hand")
    tip = points[:, 0] > 0.97
    assert turned_by(points[tip], again[tip]) == pytest.approx(0, abs=1.5)
    assert np.abs(again - turned)[points[:, 0] < 0.6].max() < 3e-3 # other patches, so as much as a shape is off by them
    w.key("ctrl+z", "ctrl+z")
    assert np.array_equal(shape("at_rest"), np.float32(points))

    stroke((X - 150, Y), (X - 70, Y)) # on the body: about half way through it, as far as the stroke is long
    w.do("mouseup", 1)
    w.key("y", "3", "0", "Return")
    w.shot("body")
    bulge = shape("body")
    core = np.linalg.norm(points - [-70 / 300, 0, 0.24], axis=1) < 0.1 # nearer to the eye
    turn = np.array([[np.cos(np.pi / 6), 0, np.sin(np.pi / 6)], [0, 1, 0], [-np.sin(np.pi / 6), 0, np.cos(np.pi / 6)]])
    about = np.linalg.lstsq(np.eye(3) - turn, bulge[core].mean(0) - turn @ points[core].mean(0), rcond=None)[0]
    assert turned_by(points[core], bulge[core]) == pytest.approx(30, abs=2) and np.abs(about - [-150 / 266, 0, 0]).max() < 0.03 # in the middle a unit is smaller
    assert np.array_equal(bulge[points[:, 0] > 0.1], np.float32(points[points[:, 0] > 0.1]))


def test_the_wheel_is_for_the_handle_that_is_dragged(window, tmp_path):
    """The next one bends as far as its place says, whatever the wheel did."""
    w, points = tip_of_a_limb(window, tmp_path)
    bent = lambda name: np.mean(np.any(load(w.save(name))[0] != points, axis=1))
    w.drag((X - 60, Y), (X - 60, Y - 30))
    before = bent("before.ply")
    w.key("ctrl+z")
    w.press_and_move((X - 60, Y), (X - 60, Y - 30))
    w.do("click", "--repeat", 8, "--delay", 50, 4)
    assert "; radius " in w.said()
    w.do("mouseup", 1)
    assert bent("wider.ply") > 1.2 * before
    w.key("ctrl+z")
    w.drag((X - 60, Y), (X - 60, Y - 30))
    assert bent("again.ply") == before


def test_a_reset_lets_each_handle_bend_all_around_it(window, tmp_path):
    """Since nothing is posed any more that it would have to keep."""
    side = 101
    y, x = np.meshgrid(*[np.linspace(-1, 1, side)] * 2, indexing="ij")
    points = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3).astype(np.float32)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).reshape(-1, 1)
    w = window(write_ply(tmp_path / "plane.ply", points, np.vstack([corner + [0, 1, side + 1], corner + [0, side + 1, side]])))
    w.start_tool()
    w.drag((X - 50, Y), (X - 50, Y - 30)) # at -0.3 and 0.4, where a unit is 177 pixels; it bends 0.42 around
    first = load(w.save("first.ply"))[0]
    w.drag((X + 70, Y), (X + 70, Y - 30))
    bent = np.linalg.norm(load(w.save("second.ply"))[0] - first, axis=1) > 0.02
    w.do("mousemove", X, Y + 230)
    w.key("BackSpace")
    assert np.linalg.norm(load(w.save("reset.ply"))[0] - points, axis=1).max() < 1e-6
    w.drag((X + 70, Y), (X + 70, Y - 30))
    bent_again = np.linalg.norm(load(w.save("again.ply"))[0] - points, axis=1) > 0.02
    w.shot("again")
    assert points[bent, 0].min() > 0.2 and points[bent_again, 0].min() < 0.2 # what the first one bends, and a gap, end there


def test_the_panel_keeps_its_places_on_a_small_screen(window, tmp_path):
    """Modes and text stay above what is scrolled, and nothing moves when the text gets longer; a usual panel with poses needs no scrolling;
    what is folded is so the next time."""
    w, _ = tip_of_a_limb(window, tmp_path)
    w.unfold("poses_fold", "keep")
    before = {name: w.box(name) for name in ("keys", "marks_fold", "state", "handles", "poses", "play", "export")}
    x, y, width, height = before["export"]
    assert y + height < 768 - 34 # above the line of the window's own
    assert w.box("brush")[1] > before["state"][1] + before["state"][3] # and all that is above it is seen
    w.press_and_move((X + 180, Y), (X + 180, Y - 60))
    w.shot("long")
    assert {name: w.box(name) for name in before} == before
    w.do("mouseup", 1)
    w.do("mousemove", X, Y + 230) # where there is less to say
    w.shot("short")
    keep_pose(w, "up")
    w.more()
    w.shot("more")
    assert {name: w.box(name) for name in ("keys", "marks_fold", "state")} == {name: before[name] for name in ("keys", "marks_fold", "state")}
    assert w.box("play")[1] != before["play"][1] # it was scrolled

    w.click(w.place("more"), w.place("marks_fold"))
    w.until("no marks", lambda: not w.is_unfolded("brush"))
    assert w.box("handles")[1] < before["handles"][1]
    w.toggle_tool()
    w.start_tool()
    w.until("the same parts", lambda: w.is_unfolded("keep") and not w.is_unfolded("brush") and not w.is_unfolded("take"))
    w.click(w.place("marks_fold"))
    w.until("marks", lambda: w.is_unfolded("brush"))


def sequenced(folder, points, faces, tags, poses):
    """The key frames that meshlabserver makes of a tagged mesh."""
    folder.mkdir()
    rest = write_ply(folder.parent / "tube.ply", points, faces, tags)
    run = Run(folder, rest, sequence_filter(poses))
    assert run.code == 0, run.log
    return [run.meshes[f"tubekeyframe{i}"].vertex_matrix() for i in range(len(run.meshes) - 1)]


def test_poses_have_names(window, tmp_path):
    """They are kept, shown, blended, undone, saved and loaded; the filter makes the same of them, to the bit."""
    w, points, faces, tags = tube_with_poses(window, tmp_path)
    w.click(w.place("keep"))
    w.wait("Nothing was moved, so there is no pose to keep.")
    w.click(w.place("saveposes"))
    w.wait("There is no pose yet: 'Keep pose' makes one of the shape that you see.")
    w.drag((X + 225, Y), (X + 165, Y - 150))
    keep_pose(w, "bent")
    shapes = {"bent": load(w.save("bent.ply"))[0]}
    w.key("BackSpace")
    w.do("mousemove", X + 225, Y)
    w.key("r", "x", "2", "0", "0", "Return")
    shapes["turned"] = load(w.save("turned.ply"))[0]
    keep_pose(w, "turned, far")
    w.shot("kept")
    assert np.array_equal(load(w.save("kept.ply"))[0], shapes["turned"]) # is what was shown
    x, y, _ = row_of_poses(w, 0)
    w.click((x + 30, y))
    assert np.array_equal(load(w.save("chosen.ply"))[0], shapes["bent"])
    show_percent(w, 0, 40)
    show_percent(w, 1, 75)
    w.shot("blended")
    shapes["blend"] = load(w.save("blend.ply"))[0]
    answer(w, "saveposes", "Save poses", str(tmp_path / "poses"))
    w.wait("Saved the poses as")
    table = (tmp_path / "poses.csv").read_text()
    assert table.startswith('time,easing,bent,"turned, far"\nsurface,,') and table.endswith("\n0,smooth,0,0\n1,smooth,100,0\n2,smooth,0,100\n")

    frames = sequenced(tmp_path / "server", points, faces, tags, tmp_path / "poses.csv")
    assert np.array_equal(frames[0], points) and np.array_equal(frames[1], shapes["bent"])
    assert np.abs(frames[2] - shapes["turned"]).max() < 1e-3 # it came there from the pose before
    blend = tmp_path / "blend.csv"
    blend.write_text(table[:table.index("\n0,smooth")] + "\n0,,40,75\n")
    assert np.array_equal(sequenced(tmp_path / "server2", points, faces, tags, blend)[0], shapes["blend"])

    w.do("mousemove", X, Y + 200)
    w.key("ctrl+z", "ctrl+z")
    assert np.array_equal(load(w.save("back.ply"))[0], shapes["bent"])
    x, y, width, height = w.box("weight1")
    w.do("mousemove", x + 4, y + height // 2, "mousedown", 1)
    for i in range(1, 6):
        w.do("mousemove", x + 4 + i * width // 5, y + height // 2)
    w.do("mouseup", 1, "mousemove", X, Y + 200)
    w.shot("slid")
    assert np.abs(load(w.save("slid.ply"))[0] - shapes["bent"]).max() > 0.1
    w.key("ctrl+z") # one step
    assert np.array_equal(load(w.save("before_slid.ply"))[0], shapes["bent"])

    blend.write_text(blend.read_text().replace("2: ", "3: "))
    answer(w, "loadposes", "Load poses", str(blend))
    w.wait("Pose 'bent': transforms moves handle 3, but no vertex has tag 3; the only handle is 2.")
    x, y, width = row_of_poses(w, 0)
    w.click((x + width - 20, y)) # removes the first one
    answer(w, "saveposes", "Save poses", str(tmp_path / "one.csv"))
    w.wait("one.csv.")
    assert (tmp_path / "one.csv").read_text().endswith("\n0,smooth,0\n1,smooth,100\n")
    answer(w, "loadposes", "Load poses", str(tmp_path / "poses.csv"))
    show_percent(w, 0, 40)
    show_percent(w, 1, 75)
    assert np.array_equal(load(w.save("loaded.ply"))[0], shapes["blend"])


def test_a_pose_takes_the_place_of_another(window, tmp_path):
    """If that is wanted; and a blend that is applied is the blend that was shown, to the bit."""
    w = tube_with_poses(window, tmp_path)[0]
    poses = lambda name: (answer(w, "saveposes", "Save poses", str(tmp_path / name)), w.wait(f"{name}."), (tmp_path / name).read_text())[2]
    w.drag((X + 225, Y), (X + 165, Y - 150))
    keep_pose(w, "bent")
    first = poses("first.csv")
    w.key("BackSpace")
    w.do("mousemove", X + 225, Y)
    w.key("r", "x", "9", "0", "Return")
    turned = load(w.save("turned.ply"))[0]
    keep_pose(w, "bent")
    w.wait_for_title("Replace pose")
    w.shot("asks")
    w.key("Return")
    w.wait("The pose 'bent' is replaced.")
    second = poses("second.csv")
    assert second.splitlines()[0] == first.splitlines()[0] and second != first and second.endswith("\n0,smooth,0\n1,smooth,100\n")
    assert np.array_equal(load(w.save("replaced.ply"))[0], turned)
    w.do("mousemove", X, Y + 200)
    w.key("ctrl+z")
    undone = poses("undone.csv")
    assert undone.startswith("time,easing,bent,Pose 2\n")
    x, y, _ = row_of_poses(w, 1)
    w.click((x + 30, y), count=2)
    w.do("type", "--delay", 5, "bent")
    w.key("Return")
    w.wait_for_title("Replace pose")
    w.key("Escape")
    w.wait("Another pose is called 'bent' and stays. Choose another name.")
    assert poses("kept.csv") == undone

    show_percent(w, 0, 40)
    show_percent(w, 1, 75)
    blend = load(w.save("blend.ply"))[0]
    w.do("mousemove", X, Y + 200)
    w.key("ctrl+Return")
    w.wait("(nearly: no filter blends poses in place; a new layer has this blend to the bit by open('poses.csv'")
    assert np.array_equal(load(w.save("in_place.ply"))[0], blend)
    w.key("ctrl+z", "ctrl+shift+Return")
    w.wait("FCD: Bend: open('poses.csv'")
    assert np.array_equal(load(w.save("new_layer.ply"))[0], blend)


def calls_in(text, folder):
    """The filter calls of a line of the log, as Python makes them in a folder: names and parameters."""
    calls = []

    class Recorder:
        def apply_filter(self, name, **parameters):
            calls.append((name, parameters))

    folder.mkdir()
    before = os.getcwd()
    os.chdir(folder)
    try:
        exec(text, {"ms": Recorder(), "numpy": np})
    finally:
        os.chdir(before)
    return calls


def test_the_log_has_the_calls_that_make_blends(window, tmp_path):
    """To the bit, as far as a filter can."""
    w, points, faces, tags = tube_with_poses(window, tmp_path)
    rest = write_ply(tmp_path / "tagged.ply", points, faces, tags)
    w.drag((X + 225, Y), (X + 165, Y - 150)) # which does not turn it
    keep_pose(w, "don't")
    w.key("BackSpace")
    w.do("mousemove", X + 225, Y)
    w.key("r", "x", "2", "0", "0", "Return")
    keep_pose(w, "turned, \\ far")
    applied = lambda: re.findall(r"FCD: Bend: ((?:open|ms\.).*\))$", w.text(), re.MULTILINE)

    def apply(keys, name, *percents):
        for i, percent in enumerate(percents):
            if percent: # none is shown yet
                show_percent(w, i, percent)
        shown = load(w.save(f"shown_{name}.ply"))[0]
        w.do("mousemove", X, Y + 200)
        count = len(applied())
        w.key(keys)
        w.until("call", lambda: len(applied()) > count)
        assert np.array_equal(load(w.save(f"{name}.ply"))[0], shown)
        return shown, applied()[-1]

    def back():
        choose_layer(w, 0)
        w.unfold("poses_fold", "keep")

    shape, text = apply("ctrl+Return", "one", 0, 40) # one that turns the handle, as no other does more
    (name, parameters), = calls_in(text, tmp_path / "calls1")
    assert name == "apply_coord_fcd_deformation" and parameters["pose"] == 40
    (tmp_path / "server1").mkdir()
    run = Run(tmp_path / "server1", rest, pose_filter(transforms=parameters["transforms"], pose=40))
    assert np.array_equal(run.meshes["tagged"].vertex_matrix(), shape)
    w.key("ctrl+z")
    for i, percents in enumerate([(40, 75), (100, 0)]): # the latter keeps its own turn, as the other pose turns it
        shape, text = apply("ctrl+shift+Return", f"new{i}", *percents)
        (name, parameters), = calls_in(text, tmp_path / f"calls2{i}")
        assert name == "generate_fcd_pose_sequence" and parameters == {"poses_file": "poses.csv", "handles": 2, "tag_attribute": "fcd_applied"}
        made, = sequenced(tmp_path / f"server2{i}", points, faces, tags, tmp_path / f"calls2{i}" / "poses.csv")
        assert np.array_equal(made, shape)
        back()
    w.more()
    w.click(w.place("graphs"))
    assert "(which makes no graph layers; with these, and nearly: ms.apply_filter('generate_fcd_deformed_mesh'" in apply("ctrl+shift+Return", "graphs", 40, 75)[1]
    back()
    w.more()
    w.do("mousemove", *w.place("distances"), "click", 5) # the wheel: Euclidean
    assert "(nearly: no filter blends poses in place)" in apply("ctrl+Return", "euclidean_in_place", 40, 75)[1]
    assert "(nearly: FCD: Pose Sequence, which blends poses, has no other distances)" in apply("ctrl+shift+Return", "euclidean", 40, 75)[1]


def test_a_large_layer_is_prepared_for_an_animation_beside_the_window(window, tmp_path):
    """Which Esc stops; the layer then has the shape of before."""
    points, faces = tube_of(np.linspace(-1, 1, 900), 224, 0.4)
    w = window(write_ply(tmp_path / "large.ply", points, faces))
    w.start_tool()
    w.unfold("poses_fold", "keep")
    full = w.text().count("trace: full")
    w.do("mousemove", X + 40, Y, "mousedown", 1, "mousemove", X + 60, Y - 80, "mouseup", 1)
    w.wait("trace: full", full + 1)
    keep_pose(w, "pulled")
    pulled = load(w.save("pulled.ply"))[0]
    w.toggle_tool()
    w.start_tool() # nothing is prepared any more
    w.unfold("poses_fold", "keep")
    answers = w.text().count("trace: answer")
    w.while_asleep(w.meshlab, "mousemove", *w.place("play"), "click", 1, "mousemove", X, Y + 200, "key", "Escape")
    assert w.text().count("trace: answer") == answers + 1 and not w.text().count("trace: frame")
    assert np.array_equal(load(w.save("stopped.ply"))[0], pulled)
    w.do("mousemove", *w.place("play"), "click", 1, settle=False)
    w.wait("trace: frame: at", 2)
    w.do("mousemove", X, Y + 230, "click", 1)
    assert np.array_equal(load(w.save("after.ply"))[0], pulled)
    w.toggle_tool()
    w.start_tool()
    w.unfold("poses_fold", "keep")
    x, y, width, _ = w.box("timeline")
    w.do("mousemove", x + width // 2, y + 8, "mousedown", 1, "mousemove", x + 8, y + 8, "mouseup", 1) # over before it is prepared
    w.wait("trace: scrub: at 0.000 s")
    w.do("mousemove", X, Y + 230)
    assert np.array_equal(load(w.save("first.ply"))[0], points)


def test_an_animation_is_played(window, tmp_path):
    """Key frames are made of what is shown, have times and easings, and are played in the view until something else is done."""
    w = tube_with_poses(window, tmp_path)[0]
    w.click(w.place("play"))
    w.wait("An animation needs two key frames: 'Keep pose' and 'Key frame' make them.")
    w.drag((X + 225, Y), (X + 165, Y - 150))
    bent = w.seen()
    w.click(w.place("frame"))
    w.wait("The shape that you see is no named pose: 'Keep pose' makes it one.")
    keep_pose(w, "bent")
    show_percent(w, 0, 50)
    half = load(w.save("half.ply"))[0]
    w.click(w.place("frame"))
    x, y, width, _ = w.box("frames")
    row = lambda i: y + 35 + 22 * i
    w.do("mousemove", x + 20, row(0), "click", "--repeat", 3, 4) # up: the new one, which is shown, is at the end
    w.click((x + 20, row(0)), count=2)
    w.do("type", "1") # which is that of the next one
    w.key("Return")
    w.wait("Their times must ascend.")
    w.click((x + width - 20, row(0)), (x + 80, row(0))) # the one at rest goes, and that of the pose is held now
    w.do("mousemove", X, Y + 200)
    w.shot("key_frames")
    answer(w, "saveposes", "Save poses", str(tmp_path / "poses.csv"))
    assert (tmp_path / "poses.csv").read_text().endswith("\n1,hold,100\n2,smooth,50\n")

    frames = lambda: [float(time) for time in re.findall(r"trace: frame: at ([\d.]+) s", w.text())]
    w.do("mousemove", *w.place("play"), "click", 1, settle=False)
    w.wait("trace: frame: at", 10)
    far = lambda: np.mean(abs(w.seen() - bent).max(-1) > 40)
    still = far()
    w.shot("playing")
    w.until("a second time round", lambda: max(frames()) > 0.5 and any(a > b for a, b in zip(frames(), frames()[1:])))
    w.do("mousemove", X, Y + 230, "click", 1) # beside the mesh, which only ends it
    count = len(frames())
    assert 0 <= min(frames()) and max(frames()) <= 1 # as rounded
    assert np.array_equal(load(w.save("after.ply"))[0], half) and len(frames()) == count
    assert still < 0.03 and far() > 1.5 * still # the gizmo was there, and is again


def test_the_animation_is_scrubbed_on_its_bar(window, tmp_path):
    """The shape follows, once a painted frame; what it rests at is kept, as one step of undo; a click on a mark shows that key frame."""
    w, points, *_ = tube_with_poses(window, tmp_path)
    w.drag((X + 225, Y), (X + 165, Y - 150))
    keep_pose(w, "bent")
    bent = load(w.save("bent.ply"))[0]
    said = w.said
    scrubbed = lambda: [float(time) for time in re.findall(r"trace: scrub: at ([\d.]+) s", w.text())]
    x, y, width, _ = w.box("timeline")
    at = lambda share: (x + 8 + round(share * (width - 16)), y + 8)
    row = lambda i: w.picture().convert("RGB").getpixel((w.box("frames")[0] + 110, w.box("frames")[1] + 35 + 22 * i))
    selected = lambda i: row(i)[2] > row(i)[0] + 60
    assert selected(1) and not selected(0) # what is shown is that key frame
    full = w.text().count("trace: full")
    w.press_and_move(at(1), at(0.5))
    w.shot("scrubbing")
    assert said().startswith("Shows frame 12, 0.50 s. Esc: as before.")
    assert scrubbed()[0] == 1 and scrubbed()[-1] == 0.5 and len(scrubbed()) > 4 and sorted(scrubbed(), reverse=True) == scrubbed()
    assert w.text().count("trace: full") == full
    w.do("mouseup", 1, "mousemove", X, Y + 200)
    assert w.text().count("trace: full") == full + 1
    half = load(w.save("half.ply"))[0]
    assert not selected(0) and not selected(1)
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("undone.ply"))[0], bent)
    show_percent(w, 0, 50)
    assert np.array_equal(load(w.save("typed.ply"))[0], half)

    w.do("mousemove", *at(1), "keydown", "shift", "mousedown", 1, "mousemove", *at(0.8), "mousemove", *at(0.5), "mouseup", 1, "keyup", "shift")
    w.do("mousemove", X, Y + 200)
    w.shot("moved")
    answer(w, "saveposes", "Save poses", str(tmp_path / "moved.csv"))
    assert (tmp_path / "moved.csv").read_text().endswith("\n0,smooth,0\n0.5,smooth,100\n")
    assert np.array_equal(load(w.save("moved.ply"))[0], half) # the shape stays
    w.key("ctrl+z")

    w.click(at(0))
    w.do("mousemove", X, Y + 200)
    w.shot("first")
    assert np.array_equal(load(w.save("first.ply"))[0], points) and selected(0)
    w.press_and_move(at(0), at(0.8))
    w.key("Escape")
    w.do("mouseup", 1)
    assert np.array_equal(load(w.save("escaped.ply"))[0], points) and selected(0)
    w.do("mousemove", *w.place("play"), "click", 1, settle=False)
    w.wait("trace: frame: at", 5)
    w.shot("playing")
    w.click(at(1)) # ends that
    assert np.array_equal(load(w.save("last.ply"))[0], bent) and selected(1)


def fill_export(w, **fields):
    """Fills the dialog for an export, and accepts it."""
    for field, text in fields.items():
        x, y, _, height = w.box(field)
        w.click((x + 20, y + height // 2))
        w.key("ctrl+a")
        w.do("type", "--delay", 5, text)
        w.key("Tab")
    w.shot("asked")
    w.click(w.place("choose"))


def test_an_animation_is_exported(window, tmp_path):
    """As the filter writes it, to the bit, with the layer's colours; a part of it, too. The log has the call."""
    colors = np.random.default_rng(1).integers(0, 256, (len(tube_with_ends()[0]), 3))
    w, points, faces, tags = tube_with_poses(window, tmp_path, colors)
    w.click(w.place("export"))
    w.wait("An animation needs two key frames: 'Keep pose' and 'Key frame' make them.")
    w.drag((X + 225, Y), (X + 165, Y - 150))
    keep_pose(w, "bent")
    shown = load(w.save("shown.ply"))[0]
    answer(w, "saveposes", "Save poses", str(tmp_path / "poses.csv"))

    def write(name, kind="", **fields):
        written = w.text().count("Bend: Wrote ")
        w.click(w.place("export"))
        w.wait_for_title("Export animation")
        fill_export(w, **fields)
        w.do("sleep", 0.5) # the next dialog has the same title
        w.wait_for_title("Export animation")
        w.do("type", "--delay", 5, str(tmp_path / name))
        if kind:
            w.click((680, 537)) # the list of kinds
            w.key(*kind.split(), "Return")
        w.key("Return")
        w.wait("Bend: Wrote ", written + 1)
        w.wait_for_title("MeshLab")
        return re.findall(r"Bend: Wrote (\d+) frames to .*", w.text())[-1], w.text().rpartition("Bend: Wrote ")[2].splitlines()[0]

    assert write("all", rate="4")[0] == "5"
    assert w.said().startswith(f"Wrote 5 frames to {tmp_path}/all.glb.\n")
    frames, line = write("all.pc2", rate="4")
    assert frames == "5" and line.endswith(
        f"ms.apply_filter('generate_fcd_pose_sequence', handles=2, tag_attribute='fcd_applied', frame_layers=0, frames_per_second=4, "
        f"pc2_file='{tmp_path}/all.pc2')")
    assert write("all of", kind="Down Down", rate="4")[0] == "5" # the ending is of the kind that was chosen
    content, cache = (tmp_path / "all of.mdd").read_bytes(), (tmp_path / "all.pc2").read_bytes()
    assert struct.unpack_from(">2i5f", content) == (5, len(points), 0, 0.25, 0.5, 0.75, 1)
    assert np.array_equal(np.frombuffer(content, ">f4", offset=28), np.frombuffer(cache, "<f4", offset=32))
    assert f"mdd_file='{tmp_path}/all of.mdd')" in w.text()
    rest = write_ply(tmp_path / "tube.ply", points, faces, tags, colors)
    for folder in ("filter", "server"):
        (tmp_path / folder).mkdir(exist_ok=True)
    run = Run(tmp_path / "server", rest, sequence_filter(tmp_path / "poses.csv", tmp_path / "filter", frame_layers=0))
    assert run.code == 0, run.log
    assert (tmp_path / "all.glb").read_bytes() == (tmp_path / "filter" / "bone.glb").read_bytes()
    assert b'"COLOR_0"' in (tmp_path / "all.glb").read_bytes()
    assert (tmp_path / "all.pc2").read_bytes() == (tmp_path / "filter" / "bone.pc2").read_bytes()

    frames, line = write("part.pc2", rate="4", **{"from": "0,5"})
    assert frames == "3" and "open('poses.csv', 'w', encoding='utf-8').write('time,easing,bent\\n" in line and "poses_file='poses.csv'" in line
    floats = np.frombuffer((tmp_path / "part.pc2").read_bytes()[32:], "<f4").reshape(3, -1, 3)
    assert np.abs(floats[2] - shown).max() < 1e-3 and np.abs(floats[0] - points).max() > 0.05
    assert np.array_equal(load(w.save("after.ply"))[0], shown)

    w.click(w.place("export"))
    w.wait_for_title("Export animation")
    fill_export(w, **{"from": "0.8", "to": "0.2"})
    w.wait("The animation would end before it begins.")

    w.click(w.place("saveposes"))
    asked = w.wait_for_title("Save poses")
    w.key("Return") # as it is offered
    w.wait_for_title("MeshLab", other_than=asked)
    w.wait(f"Saved the poses as {tmp_path}/tube.csv.")
    assert (tmp_path / "tube.csv").read_bytes() == (tmp_path / "poses.csv").read_bytes()
    w.click(w.place("export"))
    w.wait_for_title("Export animation")
    fill_export(w, rate="4")
    w.do("sleep", 0.5)
    asked = w.wait_for_title("Export animation")
    w.click((680, 537))
    w.key("Down", "Return", "Return") # a point cache: the offered name follows
    w.wait(f"Bend: Wrote 5 frames to {tmp_path}/tube.pc2.")
    assert (tmp_path / "tube.pc2").read_bytes() == cache


def test_an_animation_is_exported_as_layers(window, tmp_path):
    """As the filter makes them, to the bit: hidden, while the tool goes on. The log has the call."""
    w, points, faces, tags = tube_with_poses(window, tmp_path)
    w.drag((X + 225, Y), (X + 165, Y - 150))
    keep_pose(w, "bent")
    shown = load(w.save("shown.ply"))[0]
    answer(w, "saveposes", "Save poses", str(tmp_path / "poses.csv"))
    rest = write_ply(tmp_path / "rest.ply", points, faces, tags)

    def made_by_filter(frames):
        folder = tmp_path / f"server{frames}"
        folder.mkdir()
        run = Run(folder, rest, sequence_filter(tmp_path / "poses.csv", frame_layers=frames))
        assert run.code == 0, run.log
        return [mesh.vertex_matrix().copy() for name, mesh in run.meshes.items() if "frame" in name]

    def make(downs, **fields):
        made = w.text().count("Bend: Made ")
        w.click(w.place("export"))
        w.wait_for_title("Export animation")
        w.click(w.place("what"))
        w.key(*downs, "Return")
        fill_export(w, **fields)
        w.wait("Bend: Made ", made + 1)
        w.wait_for_title("MeshLab")
        w.settle()
        w.shot("made")
        return w.text().rpartition("Bend: Made ")[2].splitlines()[0]

    w.do("mousemove", X, Y - 250)
    w.settle()
    seen = w.seen()
    line = make(["Down", "Down"], rate="4")
    assert w.said().startswith("Made 5 layers. They are hidden:")
    assert line.startswith("5 layers. They are hidden: the eyes in the list of layers show them. ") and line.endswith(
        "ms.apply_filter('generate_fcd_pose_sequence', handles=2, tag_attribute='fcd_applied', frame_layers=2, frames_per_second=4)")
    w.do("mousemove", X, Y - 250)
    w.settle()
    assert np.mean(np.abs(w.seen() - seen) > 20) < 0.02 # but for the gizmo; the frame at rest reaches farther
    assert np.array_equal(load(w.save("goes_on.ply"))[0], shown)
    w.drag((X + 150, Y + 60), (X + 150, Y + 110)) # so does the tool
    assert not np.array_equal(load(w.save("dragged.ply"))[0], shown)
    w.key("ctrl+z")
    frames = []
    for i in range(5):
        choose_layer(w, 1 + i)
        frames.append(load(w.save(f"frame{i}.ply"))[0])
    expected = made_by_filter(2)
    assert len(expected) == 5 and all(np.array_equal(a, np.float32(b)) for a, b in zip(frames, expected))

    choose_layer(w, 0)
    w.do("mousemove", X, Y - 250)
    w.key("b")
    assert make(["Down"]).startswith("2 layers. ")
    w.do("mousemove", X, Y - 250)
    w.key("t", "t")
    assert w.said().startswith("Paint over the surface: it becomes ") # the mode stays
    choose_layer(w, 7)
    assert np.array_equal(load(w.save("key.ply"))[0], shown)


@the_dialogs_are_those_of_2020
def test_the_tool_and_the_filter_have_the_same_poses(window, tmp_path):
    """What the one keeps with the layer, the other finds there."""
    w = tube_with_poses(window, tmp_path)[0]
    w.drag((X + 225, Y), (X + 165, Y - 150))
    bent = load(w.save("bent.ply"))[0]
    keep_pose(w, "bent")
    w.do("mousemove", X, Y + 200)
    w.key("BackSpace") # the filter poses what it finds, so that is at rest
    filters = Filters(w)
    dialog = filters.dialog("FCD: Pose Sequence")
    filters.apply(dialog)
    filters.wait_for_log("1 pose, 2 key frames")
    filters.finish(dialog)
    filters.back()
    assert np.array_equal(load(w.save("key_frame.ply"))[0], bent)

    (tmp_path / "other.csv").write_text("time,easing,other\nmotions,,2: translate 0.2 0.3 0\n0,linear,0\n2,,50\n")
    filters.current_layer(0)
    dialog = filters.dialog("FCD: Pose Sequence")
    filters.click(dialog, 440, 208) # of the file with the poses
    asked = w.wait_for_title("", other_than="FCD: Pose Sequence")
    w.do("type", "--delay", 5, str(tmp_path / "other.csv"))
    w.key("Return")
    w.wait_for_title("FCD", "MeshLab", other_than=asked)
    filters.apply(dialog)
    filters.wait_for_log("1 pose, 2 key frames", 2)
    filters.finish(dialog)
    filters.current_layer(0)
    filters.back()
    w.start_tool()
    w.unfold("poses_fold", "keep")
    w.shot("found")
    answer(w, "saveposes", "Save poses", str(tmp_path / "found.csv"))
    rows = (tmp_path / "found.csv").read_text().splitlines()
    assert rows[0] == "time,easing,other" and rows[2:] == ["motions,,2: translate 0.2 0.3 0", "0,linear,0", "2,linear,50"]
    w.do("mousemove", X, Y + 200)
    w.key("ctrl+z") # those that the tool had
    answer(w, "saveposes", "Save poses", str(tmp_path / "back.csv"))
    assert (tmp_path / "back.csv").read_text().startswith("time,easing,bent\n")


def test_contact_is_told_and_shown(window, tmp_path):
    """An end that is pushed into the other one, and taken back: once it rests, not at each step of a slider."""
    w, _, _ = open_tube(window, tmp_path)
    w.start_tool()
    mark_two_regions(w)
    w.do("mousemove", X, Y + 200)
    w.key("g", "x", "minus", "1", "period", "3", "Return", "g", "y", "0", "period", "1", "Return")
    said = w.said
    w.until("contact", lambda: re.search(r"\d+ triangles pass through others\.", said()))
    assert len(re.findall(r"FCD: Bend: \d+ triangles pass through others and did not at rest", w.text())) == 1 # in the log, once
    w.click(w.place("stretch"))
    w.shot("contact")

    def magenta():
        seen = w.seen()
        return np.count_nonzero((seen[..., 0] > seen[..., 1] + 60) & (seen[..., 2] > seen[..., 1] + 60)) > 100

    assert magenta() and "triangles pass through others, shown in magenta." in said()
    x, y, width, height = w.box("pose")
    full, looked = w.text().count("trace: full"), w.text().count("trace: contact")
    w.do("mousemove", x + width // 2, y + height // 2, "mousedown", 1)
    for end in (-20, 0): # away, and back: all of it
        w.do(*[word for i in range(9) for word in ("mousemove", x + width // 2 - 20 - end + (5 * i * (1 if end else -1)) // 2, y + height // 2, "sleep", 0.04)])
    steps = w.text().count("trace: full") - full
    w.until("a look", lambda: w.text().count("trace: contact") > looked)
    assert steps >= 4 and w.text().count("trace: contact") <= looked + 1 + steps // 4 # a machine may pause
    w.do("mouseup", 1, "mousemove", X, Y + 200)
    w.until("contact", lambda: "triangles pass through others, shown in magenta." in said() and magenta())
    assert w.text().count("triangles pass through others and did not at rest") == 1 # it was there all the time
    w.key("ctrl+z", "ctrl+z", "ctrl+z")
    assert "triangles pass through" not in said() and not magenta()


def test_key_frames_beside_what_is_shown_are_ghosts(window, tmp_path):
    """Green the one before, blue the one after, while one scrubs and poses; they go with the box, with the tool, and while the animation is
    played. What is known of them is kept, and the layer has nothing of it."""
    w, points, *_ = tube_with_poses(window, tmp_path)
    w.drag((X + 240, Y - 60), (X + 180, Y - 210)) # beside the gizmo
    keep_pose(w, "bent")
    bent = load(w.save("bent.ply"))[0]
    w.do("mousemove", X, Y + 230)
    plain = w.seen()
    found = lambda: re.findall(r"trace: ghosts: (\d), of (\d+) vertices, as (\w+)", w.text())

    def tinted(seen, against):
        """How many pixels are greener, and how many bluer, than before; and where these are, from left to right."""
        more = (seen - against)[..., 1:] - (seen - against)[..., :1]
        return [(np.count_nonzero(part), np.nonzero(part)[1].mean() if part.any() else 0)
                for part in (more[..., 0] > np.maximum(more[..., 1], 0) + 12, more[..., 1] > np.maximum(more[..., 0], 0) + 12)]

    w.more()
    w.click(w.place("onion"))
    w.wait("trace: ghosts: 1, of ")
    w.do("mousemove", X, Y + 230)
    w.shot("after_rest")
    assert found()[-1][1:] == (str(len(points)), "faces")
    (green, place), (blue, _) = tinted(w.seen(), plain)
    assert green > 2000 and place > 270 and blue < 100 # the straight tube was to the right
    w.click(w.place("onion"))
    w.do("mousemove", X, Y + 230)
    assert np.array_equal(w.seen(), plain)

    w.unfold("poses_fold", "keep")
    x, y, width, _ = w.box("timeline")
    at = lambda share: (x + 8 + round(share * (width - 16)), y + 8)
    w.press_and_move(at(0), at(0.5))
    w.do("mouseup", 1, "mousemove", X, Y + 230)
    between = w.seen()
    w.click(w.place("onion"))
    w.wait("trace: ghosts: 2, of ")
    w.do("mousemove", X, Y + 230)
    w.shot("between")
    (green, right), (blue, left) = tinted(w.seen(), between)
    assert green > 1000 and blue > 1000 and left < right - 20
    count = len(found())
    w.press_and_move(at(0.5), at(0.9))
    w.shot("scrubbing")
    w.do("mouseup", 1)
    assert len(found()) == count # they are known

    w.press_and_move((X - 60, Y), (X - 60, Y - 40)) # what is posed is none of the key frames; ghosts are there nevertheless
    w.shot("posing")
    w.do("mouseup", 1)
    w.do("mousemove", *w.place("play"), "click", 1, settle=False)
    w.wait("trace: frame: at", 10)
    w.shot("playing")
    w.do("mousemove", X, Y + 230, "click", 1)
    w.key("ctrl+z", "ctrl+z", "ctrl+z")
    assert np.array_equal(load(w.save("bent_again.ply"))[0], bent)
    w.toggle_tool()
    w.do("mousemove", X, Y + 230)
    w.shot("left")
    left = w.seen()
    w.start_tool() # it is remembered
    w.until("ghosts again", lambda: len(found()) > count)
    w.shot("again")
    w.more()
    w.click(w.place("onion"))
    w.toggle_tool()
    w.do("mousemove", X, Y + 230)
    assert np.array_equal(w.seen(), left)


def test_ghosts_of_a_large_layer_are_points(window, tmp_path):
    """Which a drag hardly waits for."""
    points, faces = tube_of(np.linspace(-1, 1, 200), 80, 0.4)
    w = window(write_ply(tmp_path / "large.ply", points, faces))
    w.start_tool()
    w.unfold("poses_fold", "keep")
    w.drag((X + 40, Y), (X + 60, Y - 80))
    keep_pose(w, "pulled")
    w.more()
    w.click(w.place("onion"))
    w.wait("trace: ghosts: 1, of ")
    w.shot("points")
    vertices, kind = re.findall(r"trace: ghosts: 1, of (\d+) vertices, as (\w+)", w.text())[-1]
    assert kind == "points" and 100 < int(vertices) < len(points) / 2 # what moves
    w.click(w.place("onion"))
