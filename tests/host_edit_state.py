# SPDX-License-Identifier: GPL-3.0-or-later
"""Nothing that a person did in the tool "FCD: Bend" is lost, and nothing is done that nobody asked for: undo over applies, other layers,
filters, documents. Windows and mice as in host_edit.py, with the same environment."""
import time

import numpy as np
import pytest

import host_edit
from host_edit import MIDDLE, Filters, colors_of, load, mark_two_regions, memory, the_dialogs_are_those_of_2020, tube, tube_with_ends, write_ply
from host_edit import window # noqa: F401, a fixture

pytestmark = host_edit.pytestmark

X, Y = MIDDLE
PULL, PULL_ON = ((X + 40, Y), (X + 60, Y - 120)), ((X - 120, Y), (X - 130, Y + 80))


def open_tube(window, tmp_path, **content):
    points, faces = tube(80, 64)
    return window(write_ply(tmp_path / "tube.ply", points, faces, **content)), points, faces


def import_another(w, tmp_path):
    """A second layer, which becomes the current one, where the first does not hide it."""
    points, faces = tube(40, 32)
    w.key("ctrl+i", pause=1)
    w.do("type", "--delay", "5", str(write_ply(tmp_path / "two.ply", points * np.float32(0.3) + np.float32([0, 0.6, 0]), faces)))
    w.key("Return", pause=1)
    w.wait("two.ply in")
    time.sleep(0.5)


def choose_layer(w, place):
    w.do("mousemove", 1030, 133 + 31 * place, "click", 1, pause=0.7)
    w.do("mousemove", X, Y + 150, pause=0.3)


def panel(w):
    """The left part of the window."""
    return np.asarray(w.picture().convert("RGB"))[90:730, :370].astype(int)


def test_applies_are_undone_and_done_again(window, tmp_path):
    w, points, _ = open_tube(window, tmp_path)
    before = w.save("before.ply").read_bytes()
    w.start_tool()
    shapes = [points]
    for i, pull in enumerate((PULL, PULL_ON)):
        w.drag(*pull)
        w.key("Return") # which confirms what is dragged, and applies nothing
        assert w.text().count("ms.apply_filter") == i
        w.key("ctrl+Return", pause=1)
        w.wait("ms.apply_filter", i + 1)
        shapes.append(load(w.save(f"applied{i}.ply"))[0])
        assert np.abs(shapes[-1] - shapes[-2]).max() > 0.1
    w.shot("two_applies")
    for i, steps in enumerate((2, 2)): # an apply, and what was dragged before it
        w.key(*["ctrl+z"] * steps, pause=0.4)
        assert np.array_equal(load(w.save(f"undone{i}.ply"))[0], shapes[-2 - i])
    assert (tmp_path / "undone1.ply").read_bytes() == before
    w.shot("undone")
    w.key(*["ctrl+shift+z"] * 4, pause=0.5)
    assert np.array_equal(load(w.save("redone.ply"))[0], shapes[-1])
    w.toggle_tool()
    w.start_tool() # also when one comes back
    w.key(*["ctrl+z"] * 4, pause=0.4)
    assert w.save("back.ply").read_bytes() == before


@the_dialogs_are_those_of_2020
def test_the_filter_goes_back_over_applies_of_the_tool(window, tmp_path):
    w, _, _ = open_tube(window, tmp_path)
    before = w.save("before.ply").read_bytes()
    w.start_tool()
    for i, pull in enumerate((PULL, PULL_ON)):
        w.drag(*pull)
        w.key("ctrl+Return", pause=1)
        w.wait("ms.apply_filter", i + 1)
        w.save(f"applied{i}.ply")
    w.drag((X + 160, Y), (X + 160, Y - 70))
    filters = Filters(w)
    dialog = filters.dialog("FCD: Reset Pose")
    w.wait("keeps the pose")
    for i, name in enumerate(("applied1", "applied0", "before")):
        filters.apply(dialog)
        filters.wait_for_log("Applied filter FCD: Reset Pose", i + 1)
        filters.back()
        assert np.array_equal(load(w.save(f"back{i}.ply"))[0], load(tmp_path / f"{name}.ply")[0])
    assert (tmp_path / "back2.ply").read_bytes() == before


def test_a_layer_is_not_touched_by_marks(window, tmp_path):
    points, faces, _ = tube_with_ends()
    rng = np.random.default_rng(0)
    w = window(write_ply(tmp_path / "tube.ply", points, faces, quality=rng.random(len(points), np.float32),
                         colors=rng.integers(0, 256, (len(points), 3))))
    before = w.save("before.ply").read_bytes()
    quality, colors = load(tmp_path / "before.ply")[1], colors_of(tmp_path / "before.ply")
    settings = lambda: np.asarray(w.picture().convert("RGB"))[375:630, 965:1355].astype(int) # how the layer is shown
    shown = settings()
    w.start_tool()
    mark_two_regions(w)
    assert w.save("marked.ply").read_bytes() == before
    assert np.array_equal(settings(), shown)
    w.drag((X + 225, Y), (X + 165, Y - 150))
    w.shot("posed")
    assert np.array_equal(settings(), shown)
    w.save("posed.ply")
    assert np.array_equal(load(tmp_path / "posed.ply")[1], quality) and np.array_equal(colors_of(tmp_path / "posed.ply"), colors)
    w.key("ctrl+z", "ctrl+z", "ctrl+z")
    w.toggle_tool()
    time.sleep(1)
    assert np.array_equal(settings(), shown)
    assert w.save("left.ply").read_bytes() == before


@pytest.mark.parametrize("in_place", [True, False])
def test_a_drag_marks_nothing(window, tmp_path, in_place):
    """Neither on the layer, nor on the new one: any place of either can be dragged at once."""
    w, _, _ = open_tube(window, tmp_path)
    before = w.save("before.ply").read_bytes()
    w.start_tool()
    w.drag(*PULL)
    w.key("ctrl+Return" if in_place else "ctrl+shift+Return", pause=1.5)
    w.wait("ms.apply_filter")
    if in_place:
        w.toggle_tool()
    for layer in [0] if in_place else [1, 0]:
        choose_layer(w, layer)
        if not in_place and layer == 0:
            assert w.save("source.ply").read_bytes() == before
        w.start_tool()
        steps = len(w.traces("drag"))
        w.drag((X - 150, Y), (X - 150, Y + 60))
        w.shot(f"layer{layer}")
        assert len(w.traces("drag")) > steps + 3
        w.key("ctrl+z")
        w.toggle_tool()


def test_a_pose_stays_with_its_layer(window, tmp_path):
    w, points, _ = open_tube(window, tmp_path)
    before = w.save("before.ply").read_bytes()
    w.start_tool()
    w.drag(*PULL)
    posed = load(w.save("posed.ply"))[0]
    assert np.abs(posed - points).max() > 0.1
    import_another(w, tmp_path)
    w.wait("keeps the pose")
    choose_layer(w, 0)
    w.shot("back")
    assert np.array_equal(load(w.save("back.ply"))[0], posed)
    w.key("ctrl+z", pause=0.5)
    assert w.save("undone.ply").read_bytes() == before
    w.key("ctrl+shift+z", pause=0.5)
    choose_layer(w, 1)
    choose_layer(w, 0)
    assert np.array_equal(load(w.save("redone.ply"))[0], posed)
    w.key("Delete", pause=1) # with nothing selected
    assert np.array_equal(load(w.save("deleted.ply"))[0], posed)


@the_dialogs_are_those_of_2020
def test_filters_find_the_pose(window, tmp_path):
    w, points, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.drag(*PULL)
    posed = load(w.save("posed.ply"))[0]
    assert np.abs(posed - points).max() > 0.1
    filters = Filters(w)
    filters.run("Duplicate Current layer")
    filters.back()
    assert np.array_equal(load(w.save("copy.ply"))[0], posed)
    filters.current_layer(0)
    filters.back()
    assert np.array_equal(load(w.save("posed_still.ply"))[0], posed)


def test_the_panel_goes_with_its_document(window, tmp_path):
    w, _, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.drag(*PULL)
    posed = load(w.save("posed.ply"))[0]
    shown = panel(w)
    w.key("ctrl+n", pause=1.5)
    w.shot("new_project")
    assert np.abs(panel(w) - shown).mean() > 20
    w.key("ctrl+Return", pause=1)
    assert "ms.apply_filter" not in w.text()
    w.key("ctrl+w", pause=1.5) # the new one, which is empty
    w.shot("closed")
    assert np.abs(panel(w) - shown).mean() < 2
    assert np.array_equal(load(w.save("still.ply"))[0], posed)


def test_memory_goes_with_the_document(window, tmp_path):
    points, faces = tube(1000, 400)
    w = window(write_ply(tmp_path / "large.ply", points, faces))
    loaded = memory(w.meshlab)
    w.start_tool()
    for pull in PULL, PULL_ON:
        w.drag(*pull)
        time.sleep(1)
    bent = memory(w.meshlab)
    assert bent > loaded + 30 # what is prepared
    w.key("ctrl+w", pause=1.5)
    w.key("Left", "Return", pause=2) # Yes, without saving
    w.shot("closed")
    print("megabytes", loaded, bent, memory(w.meshlab))
    assert memory(w.meshlab) < loaded
