# SPDX-License-Identifier: GPL-3.0-or-later
"""Nothing that a person did in the tool "FCD: Bend" is lost, and nothing is done that nobody asked for: undo over applies, other layers,
filters, documents. Windows and mice as in host_edit.py, with the same environment."""
import os
import random
import re
import time

import numpy as np
import pytest
from PIL import Image

import host_edit
from host_edit import MIDDLE, VERSION, Filters, colors_of, load, mark_two_regions, the_dialogs_are_those_of_2020, tube, tube_with_ends, write_ply
from host_edit import window # noqa: F401, a fixture

pytestmark = host_edit.pytestmark

X, Y = MIDDLE
EYE = {"2020.09": (985, 133), "2022.02": (1003, 131), "2025.07": (961, 131)}[VERSION] # of the first one
SHADING_BY_FACE = 1180, 439 # in the list of layers
PULL, PULL_ON = ((X + 40, Y), (X + 60, Y - 120)), ((X - 120, Y), (X - 130, Y + 80))


def open_tube(window, tmp_path, **content):
    points, faces = tube(80, 64)
    return window(write_ply(tmp_path / "tube.ply", points, faces, **content)), points, faces


def import_another(w, tmp_path, is_cloud=False):
    """A second layer, which becomes the current one, where the first does not hide it. Returns its points."""
    points, faces = tube(40, 32)
    points, faces = points * np.float32(0.3) + np.float32([0, 0.6, 0]), faces[:0] if is_cloud else faces
    w.key("ctrl+i")
    w.do("type", "--delay", "5", str(write_ply(tmp_path / "two.ply", points, faces)))
    w.key("Return")
    w.wait("two.ply in")
    w.settle()
    return points


def choose_layer(w, place):
    w.do("mousemove", 1030, 133 + 31 * place, "click", 1)
    w.do("mousemove", X, Y + 150)


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
        w.key("ctrl+Return")
        w.wait("ms.apply_filter", i + 1)
        shapes.append(load(w.save(f"applied{i}.ply"))[0])
        assert np.abs(shapes[-1] - shapes[-2]).max() > 0.1
    w.shot("two_applies")
    for i, steps in enumerate((2, 2)): # an apply, and what was dragged before it
        w.key(*["ctrl+z"] * steps)
        assert np.array_equal(load(w.save(f"undone{i}.ply"))[0], shapes[-2 - i])
    assert (tmp_path / "undone1.ply").read_bytes() == before
    w.shot("undone")
    w.key(*["ctrl+shift+z"] * 4)
    assert np.array_equal(load(w.save("redone.ply"))[0], shapes[-1])
    w.toggle_tool()
    w.start_tool() # also when one comes back
    w.key(*["ctrl+z"] * 4)
    assert w.save("back.ply").read_bytes() == before


@the_dialogs_are_those_of_2020
def test_the_filter_goes_back_over_applies_of_the_tool(window, tmp_path):
    w, _, _ = open_tube(window, tmp_path)
    before = w.save("before.ply").read_bytes()
    w.start_tool()
    for i, pull in enumerate((PULL, PULL_ON)):
        w.drag(*pull)
        w.key("ctrl+Return")
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


@the_dialogs_are_those_of_2020
def test_an_apply_that_is_undone_leaves_copies_their_rest_shape(window, tmp_path):
    w, points, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.drag(*PULL)
    w.key("ctrl+Return")
    w.wait("ms.apply_filter")
    applied = load(w.save("applied.ply"))[0]
    w.toggle_tool()
    filters = Filters(w)
    filters.run("Duplicate Current layer")
    choose_layer(w, 0)
    w.start_tool()
    w.key("ctrl+z", "ctrl+z")
    assert np.array_equal(load(w.save("undone.ply"))[0], points)
    choose_layer(w, 1)
    assert np.array_equal(load(w.save("copy.ply"))[0], applied)
    dialog = filters.dialog("FCD: Reset Pose")
    filters.apply(dialog)
    filters.wait_for_log("Applied filter FCD: Reset Pose")
    filters.finish(dialog)
    filters.back()
    assert np.array_equal(load(w.save("reset.ply"))[0], points)


def test_a_layer_is_not_touched_by_marks(window, tmp_path):
    points, faces, _ = tube_with_ends()
    rng = np.random.default_rng(0)
    w = window(write_ply(tmp_path / "tube.ply", points, faces, quality=rng.random(len(points), np.float32),
                         colors=rng.integers(0, 256, (len(points), 3))))
    before = w.save("before.ply").read_bytes()
    quality, colors = load(tmp_path / "before.ply")[1], colors_of(tmp_path / "before.ply")
    settings = lambda: np.asarray(w.picture().convert("RGB"))[375:600, 965:1355].astype(int) # how the layer is shown
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
    assert np.array_equal(settings(), shown)
    assert w.save("left.ply").read_bytes() == before


def grain(seen):
    """How much the colours change from one pixel to the next, on the fixed end of the tube."""
    end = seen[300 - 40:300 + 40, 20:120].sum(-1)
    return np.abs(np.diff(end, axis=1)).mean()


def test_shading_by_face_comes_back_after_a_drag(window, tmp_path):
    points, faces = tube(180, 160)
    assert len(faces) > 50000 # shaded by vertex while they are dragged
    points[:, 1:] *= 1 + 0.03 * np.random.default_rng(0).random((len(points), 1), np.float32)
    w = window(write_ply(tmp_path / "rough.ply", points, faces))
    w.click(SHADING_BY_FACE)
    w.start_tool()
    mark_two_regions(w)
    w.do("mousemove", X, Y - 250)
    plain = w.seen()
    w.press_and_move((X + 225, Y), (X + 165, Y - 150))
    dragged = w.seen()
    w.shot("dragged")
    w.do("mouseup", 1)
    released = w.seen()
    w.shot("released")
    assert grain(dragged) < 0.8 * grain(plain) and abs(grain(released) / grain(plain) - 1) < 0.05
    w.key("ctrl+z")
    assert np.array_equal(w.seen()[:, :270], plain[:, :270]) # the gizmo is on the right


def longest_edges(points, faces):
    return max(np.linalg.norm(points[faces[:, k]] - points[faces[:, k - 1]], axis=1).max() for k in range(3))


def test_a_mark_after_a_pull_is_a_new_handle_at_rest(window, tmp_path):
    w, points, faces = open_tube(window, tmp_path)
    w.start_tool()
    w.drag((X + 120, Y), (X + 120, Y - 60))
    pulled = load(w.save("pulled.ply"))[0]
    w.key("v", "t") # the role is still that of a handle
    w.drag((X - 230, Y - 200), (X - 170, Y + 200))
    w.shot("marked")
    marked = load(w.save("marked.ply"))[0]
    assert np.array_equal(marked[points[:, 0] < 0], points[points[:, 0] < 0]) # at rest
    # What was pulled has fewer patches, since others are around the new handle.
    assert np.abs(marked - pulled).max() < 0.25 * np.abs(pulled - points).max()
    w.key("m")
    w.drag((X - 200, Y), (X - 200, Y - 60))
    w.shot("both")
    both = load(w.save("both.ply"))[0]
    moved = np.linalg.norm(both - marked, axis=1)
    assert moved.max() > 0.1 and moved[points[:, 0] > 0.1].max() < 1e-3
    turned = np.linalg.norm(both - points, axis=1) > 0
    assert not turned[abs(points[:, 0] + 0.05) < 0.02].any() # between the two, all is as it was
    assert longest_edges(both, faces) < 1.5 * longest_edges(pulled, faces) # nothing is torn


def test_a_handle_alone_bends_what_is_around_it(window, tmp_path):
    w, points, faces = open_tube(window, tmp_path)
    w.start_tool()
    w.key("v", "t", "h")
    w.drag((X - 30, Y - 200), (X + 30, Y + 200))
    w.key("m")
    w.press_and_move((X, Y), (X, Y - 80))
    narrow = load_after(w, "narrow.ply", points)
    w.drag((X, Y - 80), (X, Y - 100))
    w.key("ctrl+z", "ctrl+z")
    w.do("mousemove", X, Y, "mousedown", 1)
    for _ in range(6):
        w.do("click", 4) # the wheel
    w.do("mousemove", X, Y - 40, "mousemove", X, Y - 80)
    wide = load_after(w, "wide.ply", points)
    assert 0.1 < np.mean(narrow > 0) + 0.05 < np.mean(wide > 0) < 0.95


def load_after(w, name, points):
    """How far all is moved when the button is released."""
    w.do("mouseup", 1)
    return np.linalg.norm(load(w.save(name))[0] - points, axis=1)


def test_the_brush_is_seen_before_it_marks(window, tmp_path):
    """As wide as it was left."""
    w, _, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.key("b")

    def circle(w, place):
        w.do("mousemove", *place)
        light = w.seen()[300 + place[1] - Y - 60:300 + place[1] - Y + 60, 270 + place[0] - X - 60:270 + place[0] - X + 60].min(-1) > 200
        rows, columns = np.nonzero(light)
        assert len(rows) > 60 and abs(rows.mean() - 60) < 3 and abs(columns.mean() - 60) < 3
        return np.ptp(columns)

    for place in ((X - 100, Y - 200), (X + 100, Y - 220)): # on the dark ground above the tube
        width = circle(w, place)
    w.shot("brush")
    w.do("click", 4, "click", 4, "click", 4) # the wheel
    wider = circle(w, place)
    assert wider > width + 5
    w.toggle_tool()
    time.sleep(1)
    kept = next((tmp_path / ".config").rglob("*.conf")).read_text(encoding="utf-8")
    assert int(re.search(r"bend\\brush=(\d+)", kept)[1]) > 20 # which another MeshLab begins with
    w.start_tool()
    w.key("b")
    assert circle(w, place) == wider


def write_textured(folder, points, faces):
    """Squares in red and green."""
    square = (np.indices((256, 256)) // 32).sum(0) % 2
    Image.fromarray(np.where(square[..., None] == 1, [255, 40, 40], [40, 220, 60]).astype(np.uint8)).save(folder / "squares.png")
    place = np.stack([(points[:, 0] + 1) / 2, np.arctan2(points[:, 2], points[:, 1]) / (2 * np.pi) + 0.5], 1)
    triangles = np.zeros(len(faces), [("n", "u1"), ("v", "<i4", 3), ("m", "u1"), ("t", "<f4", 6)])
    triangles["n"], triangles["v"], triangles["m"], triangles["t"] = 3, faces, 6, place[faces].reshape(-1, 6)
    header = ("ply\nformat binary_little_endian 1.0\ncomment TextureFile squares.png\n"
              f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
              f"element face {len(faces)}\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n")
    (folder / "textured.ply").write_bytes(header.encode() + points.astype("<f4").tobytes() + triangles.tobytes())
    return folder / "textured.ply"


def test_textures_stay(window, tmp_path):
    def squares():
        """How much of the view is red, and green."""
        seen = w.seen()
        return np.array([np.count_nonzero(seen[..., k] > seen[..., 1 - k] + 60) for k in (0, 1)])

    w = window(write_textured(tmp_path, *tube(80, 64)))
    w.start_tool()
    before = squares()
    assert before.min() > 10000
    w.press_and_move(*PULL)
    w.shot("dragged")
    assert np.all(squares() > 0.8 * before)
    w.do("mouseup", 1)
    assert np.all(squares() > 0.8 * before)
    w.key("ctrl+shift+Return") # the view is larger then, and the mesh in it smaller
    w.shot("new_layer")
    assert np.all(squares() > 0.3 * before)


@pytest.mark.parametrize("in_place", [True, False])
def test_a_drag_marks_nothing(window, tmp_path, in_place):
    """Neither on the layer, nor on the new one: any place of either can be dragged at once."""
    w, _, _ = open_tube(window, tmp_path)
    said = w.said
    before = w.save("before.ply").read_bytes()
    w.start_tool()
    w.drag(*PULL)
    w.key("ctrl+Return" if in_place else "ctrl+shift+Return")
    w.wait("ms.apply_filter")
    if not in_place:
        w.wait("Started Mode FCD: Bend", 2) # on the new layer
        w.settle()
        assert said().startswith("The layer 'tube deformed' has the pose; the tool goes on with it.")
    for layer in [0] if in_place else [1, 0]:
        if layer == 0 and not in_place:
            choose_layer(w, 0)
            assert said().startswith("The layer 'tube.ply' is hidden: its eye in the list of layers shows it.")
            w.drag((X - 150, Y), (X - 150, Y + 60)) # nobody bends what is not seen
            w.key("g")
            w.shot("hidden")
            assert w.save("source.ply").read_bytes() == before
            w.click(EYE)
            w.do("mousemove", X, Y + 150)
            assert said().startswith("Drag a point of the surface")
        steps = len(w.traces("drag"))
        w.drag((X - 150, Y), (X - 150, Y + 60))
        w.shot(f"layer{layer}")
        assert len(w.traces("drag")) > steps + 1
        w.key("ctrl+z")


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
    w.key("ctrl+z")
    assert w.save("undone.ply").read_bytes() == before
    w.key("ctrl+shift+z")
    choose_layer(w, 1)
    choose_layer(w, 0)
    assert np.array_equal(load(w.save("redone.ply"))[0], posed)
    w.key("Delete") # with nothing selected
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


@the_dialogs_are_those_of_2020
def test_a_closed_dialog_outlives_the_last_layer(window, tmp_path):
    w, _, _ = open_tube(window, tmp_path)
    filters = Filters(w)
    filters.finish(filters.dialog("FCD: Deform Mesh"))
    filters.run("Delete Current Mesh")
    filters.back()
    points = import_another(w, tmp_path)
    assert np.array_equal(load(w.save("two_again.ply"))[0], points)
    assert "the dialog: " not in w.text()


def test_the_panel_goes_with_its_document(window, tmp_path):
    w, _, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.drag(*PULL)
    posed = load(w.save("posed.ply"))[0]
    shown = panel(w)
    w.click((29, 64)) # New Empty Project
    w.shot("new_project")
    assert np.abs(panel(w) - shown).mean() > 20
    w.key("ctrl+Return")
    assert "ms.apply_filter" not in w.text()
    w.key("ctrl+w") # the new one, which is empty
    w.shot("closed")
    assert np.abs(panel(w) - shown).mean() < 2
    assert np.array_equal(load(w.save("still.ply"))[0], posed)


class Monkey:
    """What it may do to two layers, and what each of these is then."""

    def __init__(self, w, tmp_path, rng):
        self.w, self.filters, self.rng, self.saved = w, Filters(w), rng, 0
        self.layer, self.on = 0, False
        self.folder = tmp_path

    def shape(self):
        """Of the current layer."""
        self.saved += 1
        return load(self.w.save(f"shape{self.saved}.ply"))[0]

    def bends(self):
        w, rng = self.w, self.rng
        width, height, middle = (200, 40, 52) if self.layer == 0 else (60, 12, -94) # where the layer is in the view
        on = lambda: (X + rng.randint(-width, width), Y + middle + rng.randint(-height, height))
        place = lambda: (X + rng.randint(-200, 200), Y + rng.randint(-120, 120))
        for _ in range(rng.randint(2, 8)):
            what = rng.random()
            if what < 0.5:
                w.key("m")
                w.drag(on(), place())
            elif what < 0.6:
                w.key(rng.choice("bv"), rng.choice("fuho"))
                w.drag(on(), place())
            elif what < 0.7:
                w.key("m", rng.choice("grs"), rng.choice("xyz"), "1", "Return") # Escape would hand the mouse to the camera
            else:
                w.key(rng.choice(["ctrl+z", "ctrl+shift+z", "BackSpace", "Return", "ctrl+Return", "ctrl+Return"]))
        w.key("m")

    def turn_off(self):
        if self.on:
            self.w.toggle_tool()
        self.on = False

    def choose(self, layer):
        choose_layer(self.w, layer)
        self.layer = layer

    def run(self, title):
        count = self.w.text().count(f"Applied filter {title}")
        self.filters.search(title)
        self.w.wait(f"Applied filter {title}", count + 1)
        self.filters.back()
        self.on = False

    def smooth(self):
        dialog = self.filters.dialog("Taubin Smooth")
        count = self.w.text().count("Applied filter Taubin Smooth")
        self.filters.apply(dialog)
        self.w.wait("Applied filter Taubin Smooth", count + 1)
        self.filters.finish(dialog)
        self.filters.back()
        self.on = False

    def reset(self, wanted):
        """Goes back until the current layer has a shape."""
        shape = self.shape()
        for _ in range(40):
            if np.array_equal(shape, wanted):
                return True
            dialog = self.filters.dialog("FCD: Reset Pose")
            self.filters.apply(dialog)
            self.w.settle()
            self.filters.finish(dialog)
            self.filters.back()
            last, shape = shape, self.shape()
            if np.array_equal(shape, last):
                return np.array_equal(shape, wanted)
        return False


@the_dialogs_are_those_of_2020
def test_each_layer_is_what_it_was_left_as(window, tmp_path):
    """A monkey with two layers, other filters, and files between: a layer is what it was when the tool left it, whatever is done to the
    other one; and all poses lead back to the shape as loaded, or as another filter left it."""
    w, points, _ = open_tube(window, tmp_path)
    import_another(w, tmp_path)
    seed = int(os.environ.get("FCD_MONKEY_SEED", random.randrange(10**6)))
    print("seed", seed)
    monkey = Monkey(w, tmp_path, random.Random(seed))
    known = {}
    for layer in (1, 0):
        monkey.choose(layer)
        known[layer] = monkey.shape()
    rest = dict(known)
    end = time.time() + float(os.environ.get("FCD_MONKEY_SECONDS", "20"))
    turns = 0
    while time.time() < end or turns < 3:
        turns += 1
        if not monkey.on:
            w.start_tool()
            monkey.on = True
        assert np.array_equal(monkey.shape(), known[monkey.layer]), f"seed {seed}, turn {turns}: the tool begins with another shape"
        monkey.bends()
        known[monkey.layer] = monkey.shape()
        what = monkey.rng.random()
        if what < 0.4:
            monkey.choose(1 - monkey.layer)
        elif what < 0.55:
            monkey.turn_off()
        elif what < 0.75:
            monkey.run(monkey.rng.choice(["Remove Unreferenced Vertices", "Re-Orient all faces coherentely"]))
        elif what < 0.85:
            monkey.smooth()
            known[monkey.layer] = rest[monkey.layer] = monkey.shape()
        else:
            path = tmp_path / f"project{turns}.mlp"
            monkey.filters.save_project(path)
            monkey.filters.back()
        assert w.meshlab.poll() is None, f"seed {seed}"
    monkey.turn_off()
    for layer in (0, 1):
        monkey.choose(layer)
        assert np.array_equal(monkey.shape(), known[layer]), f"seed {seed}: layer {layer}"
        assert monkey.reset(rest[layer]), f"seed {seed}: layer {layer} does not lead back"
    print(turns, "turns,", w.text().count("keeps the pose"), "poses left,", w.text().count("Bend: ms.apply"), "applies")
    assert "exception was thrown" not in w.text()


def test_who_saves_a_project_is_told_what_is_not_in_it(window, tmp_path):
    w, _, _ = open_tube(window, tmp_path)
    w.start_tool()
    w.drag((X + 40, Y), (X + 60, Y - 120))
    w.toggle_tool()
    w.wait("keeps the pose")
    w.key("ctrl+s")
    w.do("type", "--delay", "5", str(tmp_path / "all.mlp"))
    w.key("Return")
    w.wait("FCD: a project has no room for what is kept of 'tube.ply': rest shape, handles and motions. 'FCD: Save Session' writes that to a file.")
    assert (tmp_path / "all.mlp").exists()
