# SPDX-License-Identifier: GPL-3.0-or-later
"""The editing tool "FCD: Bend" in MeshLab's real window under Xvfb, with a scripted mouse (xdotool, and openbox as window
manager), against the filters in meshlabserver 2020.09, which FCD_MESHLABSERVER names. The window is the one of meshlab beside it, or
of the program that FCD_MESHLAB names, with the plugins; FCD_MESHLAB_VERSION is then 2022.02 or 2025.07 (2020.09).

FCD_EDIT_SHOTS names a folder for screenshots; FCD_MONKEY_SECONDS is how long the monkey plays (20)."""
import atexit
import os
import random
import re
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import pymeshlab
import pytest
from PIL import ImageGrab

import host_window
from conftest import record, settle
from mouse import Mouse
from host_meshlabserver import SERVER, Run, deform_filter, pose_filter

MESHLAB = Path(os.environ.get("FCD_MESHLAB", Path(SERVER).with_name("meshlab")))
SHOTS = os.environ.get("FCD_EDIT_SHOTS")
MISSING = [program for program in ("Xvfb", "xdotool", "openbox") if not shutil.which(program)]

pytestmark = [
    pytest.mark.skipif(bool(MISSING), reason="a scripted mouse needs " + ", ".join(MISSING)),
    pytest.mark.skipif(not MESHLAB.exists(), reason=f"there is no {MESHLAB}"),
]

VERSION = os.environ.get("FCD_MESHLAB_VERSION", "2020.09")
# In the window, maximised on a screen of 1366 x 768: the middle of the view, with the tool's panel to the left of it. (Where things of the
# panel are, the tool tells: Window.place().)
MIDDLE = {"2020.09": (662, 411), "2022.02": (662, 411), "2025.07": (642, 411)}[VERSION]


def tube(rows, columns):
    """A closed tube along x, from -1 to 1."""
    return tube_of(np.linspace(-1, 1, rows), columns, 0.25)


def tube_with_ends():
    """Without vertices where mark_two_regions() ends: which ones these are does not hang on a pixel. Its tags, too."""
    points, faces = tube_of(np.hstack([np.linspace(-0.69, -0.5, 16), np.linspace(-0.2, 0.2, 50), np.linspace(0.5, 0.69, 16)]), 64, 0.4)
    return points, faces, np.select([points[:, 0] < -0.4, points[:, 0] > 0.4], [0.0, 2.0], 1.0)


def tube_of(x, columns, radius):
    rows, ends = len(x), [[x[0], 0, 0], [x[-1], 0, 0]]
    x = np.repeat(x, columns)
    turn = np.tile(np.arange(columns) * 2 * np.pi / columns, rows)
    points = np.vstack([np.stack([x, radius * np.cos(turn), radius * np.sin(turn)], 1), ends])
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(columns), indexing="ij")
    a, b = (row * columns + column).ravel(), (row * columns + (column + 1) % columns).ravel()
    ring = np.arange(columns)
    last = (rows - 1) * columns
    faces = np.vstack([np.stack([a, b, a + columns], 1), np.stack([b, b + columns, a + columns], 1),
                       np.stack([np.full(columns, rows * columns), (ring + 1) % columns, ring], 1),
                       np.stack([np.full(columns, rows * columns + 1), last + ring, last + (ring + 1) % columns], 1)])
    return points.astype(np.float32), faces.astype(np.int32)


def write_ply(path, points, faces, quality=None, colors=None):
    fields = [("p", "<f4", 3)] + ([("q", "<f4")] if quality is not None else []) + ([("c", "u1", 3)] if colors is not None else [])
    vertices = np.zeros(len(points), fields)
    vertices["p"] = points
    if quality is not None:
        vertices["q"] = quality
    if colors is not None:
        vertices["c"] = colors
    triangles = np.zeros(len(faces), [("n", "u1"), ("v", "<i4", 3)])
    triangles["n"], triangles["v"] = 3, faces
    header = ("ply\nformat binary_little_endian 1.0\n"
              f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n" +
              ("property float quality\n" if quality is not None else "") +
              ("property uchar red\nproperty uchar green\nproperty uchar blue\n" if colors is not None else "") +
              f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(header.encode() + vertices.tobytes() + triangles.tobytes())
    return path


def load(path):
    """Positions and quality."""
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(path))
    return ms.current_mesh().vertex_matrix(), ms.current_mesh().vertex_scalar_array()


def colors_of(path):
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(path))
    return np.round(255 * ms.current_mesh().vertex_color_matrix()[:, :3])


class Screen:
    """A display with a window manager, which serves one window of MeshLab after another. Of each, only these know."""
    free = []

    @classmethod
    def taken(cls):
        screen = cls.free.pop() if cls.free else cls()
        screen.mouse.do("mousemove", 683, 384) # the middle, whatever was before
        return screen

    def __init__(self):
        self.home = tempfile.TemporaryDirectory()
        read, write = os.pipe()
        self.server = self.start(["Xvfb", "-displayfd", str(write), "-screen", "0", "1366x768x24"], pass_fds=[write])
        os.close(write)
        with os.fdopen(read) as pipe:
            self.display = ":" + pipe.readline().strip()
        self.manager = self.start(["openbox"], DISPLAY=self.display, HOME=self.home.name)
        settle([self.server.pid, self.manager.pid])
        self.mouse = Mouse(self.display)
        atexit.register(self.close)

    def start(self, command, pass_fds=(), **environment):
        return subprocess.Popen(command, env={**os.environ, **environment}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                stdin=subprocess.DEVNULL, cwd=self.home.name, pass_fds=pass_fds)

    def give_back(self):
        """Once its window is gone; what a test that failed has pressed is released."""
        self.mouse.do(*[word for button in (1, 2, 3) for word in ("mouseup", button)], *[word for key in ("shift", "ctrl", "alt") for word in ("keyup", key)])
        self.free.append(self)

    def close(self):
        self.mouse.close()
        for process in (self.manager, self.server):
            process.kill()
            process.wait()
        self.home.cleanup()


class Window:
    """MeshLab with meshes, of which the last one is the current layer, on a display of its own."""

    def __init__(self, folder, *meshes):
        self.folder, self.log, self.shots = folder, folder / "log.txt", 0
        self.pressed = None, 0.0 # where, and when
        self.is_here = all(mesh.parent == folder for mesh in meshes) # so that the dialog that saves a layer begins in the folder
        self.screen = Screen.taken()
        self.manager = self.screen.manager
        runtime = folder / "runtime"
        runtime.mkdir(mode=0o700)
        self.environment = {"DISPLAY": self.screen.display, "HOME": str(folder), "XDG_RUNTIME_DIR": str(runtime), "FCD_TRACE": "1", "LC_ALL": "C.UTF-8"}
        with open(self.log, "wb") as log:
            self.meshlab = subprocess.Popen([str(MESHLAB), *map(str, meshes)], env={**os.environ, **self.environment}, stdout=log, stderr=log,
                                            stdin=subprocess.DEVNULL, cwd=folder)
        self.processes = [self.screen.server.pid, self.manager.pid, self.meshlab.pid]
        project = meshes[0].name if meshes and meshes[0].suffix == ".mlp" else ""
        if project and VERSION != "2020.09":  # of which the newer ones log nothing
            self.until(project, lambda: project in self.title())
        else:
            self.wait("Opened mesh" if project else "All files opened", len(meshes))
        self.wait_for_title("MeshLab")
        self.settle()

    def text(self):
        return self.log.read_text(errors="replace")

    def said(self):
        """The text of the panel, and what was traced since it was set."""
        return self.text().rpartition("trace: says: ")[2]

    def wait(self, text, count=1, seconds=60):
        self.until(f"'{text}' in the log", lambda: self.text().count(text) >= count, seconds)

    def until(self, what, that, seconds=60):
        """Waits for something."""
        end = time.time() + seconds
        while not that():
            assert self.meshlab.poll() is None, "MeshLab ended: " + self.text()[-2000:]
            assert time.time() < end, f"no {what}: " + self.text()[-2000:]
            time.sleep(0.05)

    def settle(self):
        settle(self.processes)

    def do(self, *arguments, settle=True):
        self.screen.mouse.do(*arguments)
        if settle:
            self.settle()

    def while_asleep(self, process, *arguments):
        """As do(), but that a process hears of it only after all of it. The window manager, which sees presses first and then lets the
        window have them, does so late then: keys that came after them are there first. MeshLab does nothing in between."""
        os.kill(process.pid, signal.SIGSTOP)
        try:
            self.do(*arguments)
        finally:
            os.kill(process.pid, signal.SIGCONT)
        self.settle()

    def title(self):
        return self.screen.mouse.title()

    def has_title(self, beginning, seconds):
        """Whether the window that has the keyboard gets such a title within so many seconds."""
        end = time.time() + seconds
        while time.time() < end and not self.title().startswith(beginning):
            time.sleep(0.1)
        return self.title().startswith(beginning)

    def wait_for_title(self, *beginnings, other_than=None):
        """Waits for the window that has the keyboard. Returns its title."""
        end = time.time() + 60
        while not (title := self.title()).startswith(beginnings) or title == other_than:
            assert self.meshlab.poll() is None, "MeshLab ended: " + self.text()[-2000:]
            assert time.time() < end, f"no {beginnings}, but '{title}'"
            time.sleep(0.03)
        self.settle()
        return title

    def key(self, *keys):
        for key in keys:
            self.do("key", key)

    def press_and_move(self, start, end, button=1, steps=8):
        if self.pressed[0] == tuple(start): # two presses at one place within half a second are a double click
            time.sleep(max(0, self.pressed[1] + 0.6 - time.time()))
        self.pressed = tuple(start), time.time()
        self.do("mousemove", *start)
        self.do("mousedown", button)
        way = [[round(a + (b - a) * i / steps) for a, b in zip(start, end)] for i in range(1, steps + 1)]
        self.do(*[word for place in way for word in ("mousemove", *place, "sleep", 0.04)])

    def drag(self, start, end, button=1, steps=8):
        self.press_and_move(start, end, button, steps)
        self.do("mouseup", button)

    def click(self, *places, count=1):
        for place in places:
            self.do("mousemove", *place, "click", "--repeat", count, "--delay", 50, 1)

    def toggle_tool(self, name="FCD: Bend", is_on=False):
        """Edit menu: the second of the entries that can be chosen, or the third; while a tool is on, no other can be."""
        self.do("mousemove", *MIDDLE)
        self.key("alt+e", *["Down"] * (2 if name == "FCD: Fit" and not is_on else 1), "Return")

    def start_tool(self, name="FCD: Bend", mode="m"):
        """Of FCD: Bend, in a mode, by its key: most tests pull, on limbs, too; None: in that in which it begins."""
        before, places = self.text().count(f"Started Mode {name}"), self.text().count("trace: place:")
        self.toggle_tool(name)
        self.wait(f"Started Mode {name}", before + 1)
        self.wait("trace: place:", places + 1) # where its buttons are, which it says when they are there
        self.do("mousemove", *MIDDLE)
        if name == "FCD: Bend" and mode:
            self.key(mode)

    def save(self, name, by_menu=False, between=lambda: None):
        """between: what is done before each further try of the menu."""
        path = self.folder / name
        if by_menu:
            for i in range(5): # a busy machine loses a click at times
                if i:
                    between()
                    if self.has_title("Save", 2): # it had waited with what was clicked
                        break
                self.do("mousemove", 36, 29, "click", 1, "sleep", 1) # File: it takes a while to open
                self.click((110, 230)) # Export Mesh As
                if self.has_title("Save", 10):
                    break
        else:
            self.key("ctrl+shift+e")
        asked = self.wait_for_title("Save")
        self.do("type", "--delay", "5", name if self.is_here else str(path))
        self.key("Return")
        self.wait_for_title("", other_than=asked) # what the file is to have
        self.key("Return")
        self.wait(f"Saved Mesh {path}")
        self.wait_for_title("MeshLab")
        return path

    def picture(self):
        return ImageGrab.grab(xdisplay=self.environment["DISPLAY"])

    def shot(self, name):
        if SHOTS:
            self.shots += 1
            self.picture().save(f"{SHOTS}/{self.folder.name}_{self.shots:02}_{name}.png")

    def seen(self):
        """The colours in the view, but for the lines of text at its lower edge."""
        x, y = MIDDLE
        return np.asarray(self.picture().convert("RGB"))[y - 300:y + 190, x - 270:x + 270].astype(int)

    def box(self, name):
        """Left, top, width and height of a thing of the tool's panel."""
        time.sleep(0.3) # 0.2 after a change it says where things are
        self.wait(f"FCD trace: place: {name} ")
        return list(map(int, re.findall(rf"FCD trace: place: {name} (\d+) (\d+) (\d+) (\d+)", self.text())[-1]))

    def place(self, name):
        """Where it begins, half way down: a button, or a check box."""
        x, y, _, height = self.box(name)
        return x + 8, y + height // 2

    def is_unfolded(self, part):
        time.sleep(0.3) # as in box()
        return self.text().rfind(f"FCD trace: place: {part} ") > self.text().rfind("FCD trace: place: marks_fold ")

    def unfold(self, button, part):
        """Shows what a button of the panel shows, if it is not there yet: it is remembered."""
        if not self.is_unfolded(part):
            self.click(self.place(button))
            self.until(part, lambda: self.is_unfolded(part))

    def more(self):
        """Shows what shapes a deformation, and motions as text."""
        if self.is_unfolded("take"): # once more, as that scrolls there
            self.click(self.place("more"))
            self.until("nothing more", lambda: not self.is_unfolded("take"))
        self.unfold("more", "take")

    def traces(self, kind):
        return [tuple(map(float, found)) for found in re.findall(
            rf"FCD trace: {kind}: (\d+) vertices, (\d+) nodes, prepare ([\d.]+), solve ([\d.]+), write ([\d.]+), buffers ([\d.]+), "
            r"in all ([\d.]+)", self.text())]

    def close(self):
        record(self.text())
        self.meshlab.kill()
        self.meshlab.wait()
        self.screen.give_back()


class Filters(host_window.Window):
    """The filters' dialogs in such a window."""

    def __init__(self, window):
        self.screen, self.clicks, self.log, self.program = window, 0, window.log, window.meshlab
        self.main = self.wait(f"MeshLab {VERSION}")

    def back(self):
        """The view has the keyboard, as before a dialog."""
        self.x("windowactivate", "--sync", self.main)
        self.x("mousemove", *MIDDLE)
        time.sleep(0.3)


@pytest.fixture
def window(tmp_path):
    opened = []

    def open_window(*meshes):
        opened.append(Window(tmp_path, *meshes))
        return opened[-1]

    yield open_window
    for each in opened:
        each.close()
    for each in opened: # what the standard library throws says nothing to a person
        assert not re.search(r"FCD: \w+: (\w+::|bad_|std)", each.text())


def mark_two_regions(w, far=280):
    """The left end of the tube fixed, the right end the handle, through the tube. A drag may end beside the view."""
    x, y = MIDDLE
    w.key("v", "t", "f")
    w.drag((x - 110, y + 200), (x - far, y - 200), steps=3)
    w.key("h")
    w.drag((x + 110, y - 200), (x + far, y + 200), steps=3)
    w.shot("marked")
    w.do("mousemove", x, y - 250)
    w.key("m")


def bend_a_marked_tube(window, tmp_path, to, colors=None):
    """The tool on a tube, its ends marked, the right one dragged to a place. Returns its rest shape, and tags, too."""
    points, faces, tags = tube_with_ends()
    w = window(write_ply(tmp_path / "tube.ply", points, faces, colors=colors))
    w.start_tool()
    mark_two_regions(w, 310) # in newer windows it is shown larger
    w.drag((MIDDLE[0] + 225, MIDDLE[1]), to)
    return w, points, faces, tags


def filtered(tmp_path, points, faces, tags, script):
    """The positions in the layers that meshlabserver makes of a tagged mesh."""
    folder = tmp_path / "server"
    folder.mkdir()
    run = Run(folder, write_ply(tmp_path / "rest.ply", points, faces, tags), script)
    return {name: mesh.vertex_matrix() for name, mesh in run.meshes.items()} # meshes live as long as the run


def transforms_of(w, script, more=""):
    found = re.findall(rf"FCD: Bend: .*ms\.apply_filter\('{script}', handles=2, tag_attribute='fcd_applied', transforms='([^']*)'{more}", w.text())
    assert len(found) == 1, w.text()[-2000:]
    return found[0]


@pytest.mark.parametrize("in_place", [True, False])
def test_marked_regions_bent_by_mouse_equal_the_filter(window, tmp_path, in_place):
    w, points, faces, tags = bend_a_marked_tube(window, tmp_path, (MIDDLE[0] + 165, MIDDLE[1] - 150))
    w.shot("dragged")
    drags = w.traces("drag")
    assert len(drags) > 1 and drags[-1][0] == len(points) and drags[-1][1] > 50
    w.key("ctrl+Return" if in_place else "ctrl+shift+Return")
    w.wait("ms.apply_filter")
    w.shot("applied")
    bent, quality = load(w.save("bent.ply"))
    assert bent.shape == points.shape
    assert not quality.any() # of which the tool makes nothing

    script = "apply_coord_fcd_deformation" if in_place else "generate_fcd_deformed_mesh"
    transforms = transforms_of(w, script)
    layers = filtered(tmp_path, points, faces, tags, (pose_filter if in_place else deform_filter)(transforms=transforms))
    expected = layers["rest" if in_place else "restdeformed"]
    moved = np.linalg.norm(expected - points, axis=1)
    assert moved.max() > 0.1 and np.all(moved[tags == 0] == 0)
    assert np.array_equal(bent, expected)


def test_a_new_layer_has_the_colours_of_the_layer(window, tmp_path):
    colors = np.random.default_rng(0).integers(0, 256, (len(tube_with_ends()[0]), 3))
    w, points, _, _ = bend_a_marked_tube(window, tmp_path, (MIDDLE[0] + 165, MIDDLE[1] - 150), colors)
    assert np.array_equal(colors_of(w.save("marked.ply")), colors)
    w.key("ctrl+shift+Return")
    w.wait("ms.apply_filter")
    w.shot("new_layer")
    bent = w.save("bent.ply")
    assert np.abs(load(bent)[0] - points).max() > 0.1
    assert np.array_equal(colors_of(bent), colors)


def layer_of(path):
    """Positions, tags and colours."""
    return *load(path), colors_of(path)


# Filters and tool are two libraries that tell each other by the layer what it keeps aside, what was made of it, and how it is bent.
the_dialogs_are_those_of_2020 = pytest.mark.skipif(VERSION != "2020.09", reason="host_window.py knows the dialogs of 2020.09")


@the_dialogs_are_those_of_2020
def test_tags_of_the_filter_then_marks_of_the_tool(window, tmp_path):
    points, faces, tags = tube_with_ends()
    colors = np.random.default_rng(0).integers(0, 256, points.shape)
    w = window(write_ply(tmp_path / "tube.ply", points, faces, colors=colors))
    filters = Filters(w)
    filters.select("x < -0.4")
    filters.tag("Home") # fixed
    filters.back()
    w.start_tool()
    x, y = MIDDLE
    w.key("v", "t", "h")
    w.drag((x + 280, y + 200), (x + 110, y - 200))
    w.key("m")
    w.shot("tagged_and_marked")
    _, quality, shown = layer_of(w.save("marked.ply"))
    assert np.array_equal(quality == 0, tags == 0) and len(np.unique(quality)) == 2 # what the filter has made, and nothing more
    assert len(np.unique(shown, axis=0)) == 2
    w.drag((x + 225, y), (x + 165, y - 150))
    w.key("ctrl+shift+Return")
    w.wait("ms.apply_filter")
    bent, _, own = layer_of(w.save("bent.ply"))
    assert np.abs(bent - points).max() > 0.1 and np.array_equal(bent[tags == 0], points[tags == 0])
    assert np.array_equal(own, colors) # which the filter has kept aside

    # What the tool has made is a result for the filter: the layer is bent that it was made from.
    filters.back()
    dialog = filters.dialog("FCD: Deform Mesh")
    filters.enter(dialog, *host_window.MOVE_X, "1")
    filters.apply(dialog)
    filters.wait_for_log("layers of the last try are replaced")
    filters.finish(dialog)
    filters.back()
    again, _, own = layer_of(w.save("again.ply"))
    assert np.abs(again - (points + (tags == 2)[:, None] * [1, 0, 0]))[tags != 1].max() < 1e-6
    assert np.array_equal(own, colors)


@the_dialogs_are_those_of_2020
def test_marks_of_the_tool_then_tags_of_the_filter(window, tmp_path):
    points, faces, expected = tube_with_ends()
    colors = np.random.default_rng(0).integers(0, 256, points.shape)
    w = window(write_ply(tmp_path / "tube.ply", points, faces, colors=colors))
    before = w.save("before.ply").read_bytes()
    filters = Filters(w)
    w.start_tool()
    mark_two_regions(w)
    w.toggle_tool()
    assert w.save("marked.ply").read_bytes() == before
    filters.select("x > 0.6")
    filters.tag("Home", "Down", "Down") # handle
    filters.back()
    _, tags, shown = layer_of(w.save("tagged.ply"))
    assert np.array_equal(tags, expected) and len(np.unique(shown, axis=0)) == 3 # with what the tool has marked

    dialog = filters.dialog("FCD: Deform Mesh")
    filters.enter(dialog, *host_window.MOVE_X, "1")
    filters.apply(dialog)
    filters.wait_for_log("is shown")
    filters.finish(dialog)
    filters.back()
    bent, _, own = layer_of(w.save("bent.ply"))
    assert np.abs(bent - (points + (tags == 2)[:, None] * [1, 0, 0]))[tags != 1].max() < 1e-6
    assert np.array_equal(own, colors)

    filters.current_layer(0)
    filters.run("FCD: Clear Tags")
    filters.back()
    assert np.array_equal(colors_of(w.save("cleared.ply")), colors)
    assert (tmp_path / "cleared.ply").read_bytes() == before


def other_shape_of_the_panel(window, tmp_path, name, notches, least, call, button=5, typed=None):
    """Another choice of the panel, by so many notches of the wheel or clicks, or a number typed, gives another shape, which is applied; the log's
    call has it."""
    points, faces = tube(80, 64) # whose jagged marks make a difference
    w = window(write_ply(tmp_path / "tube.ply", points, faces))
    w.start_tool()
    mark_two_regions(w)
    w.drag((MIDDLE[0] + 180, MIDDLE[1]), (MIDDLE[0] + 120, MIDDLE[1] - 150))
    usual = load(w.save("usual.ply"))[0]
    w.more()
    w.do("mousemove", *w.place(name), *["click", button] * notches)
    if typed:
        w.key("ctrl+a")
        w.do("type", typed)
        w.key("Return")
    w.shot(name)
    w.do("mousemove", *MIDDLE)
    other = load(w.save("other.ply"))[0]
    assert np.abs(other - usual).max() > least
    w.key("ctrl+shift+Return")
    w.wait("ms.apply_filter")
    assert np.array_equal(load(w.save("bent.ply"))[0], other)
    transforms_of(w, "generate_fcd_deformed_mesh", f", {call}, graph_layers=False")


def test_weights_of_the_panel_are_those_of_the_filter(window, tmp_path):
    other_shape_of_the_panel(window, tmp_path, "distances", 1, 1e-4, "weights=1") # Euclidean


def test_the_falloff_of_the_panel_is_that_of_the_method(window, tmp_path):
    other_shape_of_the_panel(window, tmp_path, "falloff", 2, 0.02, "falloff=2") # sharp


def test_the_panel_can_keep_the_volume(window, tmp_path):
    other_shape_of_the_panel(window, tmp_path, "elastic", 1, 0.003, "elastic=True", button=1)


def test_the_panel_can_let_the_surface_stretch(window, tmp_path):
    other_shape_of_the_panel(window, tmp_path, "rigidity", 1, 0.003, "rigidity=0.25", button=1, typed="0.25")


def marked_in(seen, plain):
    """Where the marks of fixed, of the handle and of what is outside are seen, by their colours, and were not in a plain view."""
    red, green, blue = seen[..., 0], seen[..., 1], seen[..., 2]
    grey = (abs(red - green) < 12) & (abs(green - blue) < 12)
    changed = (seen != plain).any(-1)
    return changed & (blue > red + 60), changed & (red > blue + 60), changed & grey


def test_polylines_mark_what_rectangles_mark(window, tmp_path):
    w = window(write_ply(tmp_path / "tube.ply", *tube(80, 64)))
    w.start_tool()
    plain = w.seen()
    mark_two_regions(w)
    x, y = MIDDLE
    w.do("mousemove", x, y - 250)
    expected = w.seen()
    fixed, handle, _ = marked_in(expected, plain)
    assert min(np.count_nonzero(fixed), np.count_nonzero(handle)) > 5000
    w.key("ctrl+z", "ctrl+z")
    assert np.array_equal(w.seen(), plain)
    w.key("l", "f")
    w.click((x - 280, y - 200), (x - 110, y - 200), (x - 110, y + 200), (x - 280, y + 200))
    w.shot("polyline")
    w.key("Return", "h")
    w.click((x + 280, y + 200), (x + 280, y - 200), (x + 110, y - 200))
    w.click((x + 110, y + 200), count=2) # ends it
    w.shot("polylines")
    w.key("m")
    w.do("mousemove", x, y - 250)
    assert np.array_equal(w.seen(), expected)
    w.key("l", "o") # a triangle: its two legs are beside the tube
    w.click((x - 60, y - 200), (x + 60, y - 200), (x, y + 5))
    w.key("Return", "m")
    w.do("mousemove", x, y - 250)
    w.shot("triangle")
    outside = marked_in(w.seen(), expected)[2]
    rows = outside.sum(1)
    place = np.flatnonzero(rows > 3)
    assert place[-1] < 315 and 0 < rows[place[-10]] < rows[place].max() / 2 # above the middle, and narrower below


def stretch_colors(rest, now, faces):
    """The colours that show the stretch: the principal stretches of the triangles are the singular values of their maps."""
    def edges(points):
        return np.stack([points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]], 2)

    e = edges(np.float64(rest))
    q, r = np.linalg.qr(e)
    exponent = np.log2(np.linalg.svd(edges(np.float64(now)) @ np.linalg.inv(r), compute_uv=False))
    exponent = np.where(exponent[:, 0] >= -exponent[:, 1], exponent[:, 0], exponent[:, 1])
    area = np.abs(np.linalg.det(r)) / 2
    weight = np.bincount(faces.ravel(), np.repeat(area, 3))
    mean = np.clip(np.bincount(faces.ravel(), np.repeat(area * exponent, 3)) / weight, -1, 1)[:, None]
    grey, red, blue = np.array([225, 225, 225]), np.array([215, 35, 35]), np.array([30, 80, 220])
    return grey + np.abs(mean) * (np.where(mean < 0, blue, red) - grey)


def expect_stretch(seen, plain, rest, now, faces):
    """The colours of stretch in the view: red and blue, as much of them as the shape has, and none in a plain view."""
    def parts(picture):
        red, blue = picture[..., 0] - picture[..., 2], picture[..., 2] - picture[..., 0]
        return np.count_nonzero(red > 60), np.count_nonzero((blue > 60) & (picture[..., 2] > 170))

    color = stretch_colors(rest, now, faces)
    expected = np.mean(color[:, 0] - color[:, 2] > 75), np.mean(color[:, 2] - color[:, 0] > 75)
    seen = seen * (seen != plain).any(-1)[..., None]
    for part, share in zip(parts(seen), expected):
        assert (part > 300) == (share > 0.01), (parts(seen), expected)
    assert max(expected) > 0.01


def test_stretch_is_shown_and_leaves_nothing(window, tmp_path):
    points, faces = tube(80, 64)
    w = window(write_ply(tmp_path / "tube.ply", points, faces))
    w.start_tool()
    x, y = MIDDLE
    w.drag((x + 40, y), (x + 60, y - 120))
    bent = w.save("bent.ply")
    plain = w.seen()
    w.click(w.place("stretch"))
    w.shot("stretch")
    shown = w.seen()
    assert w.save("shown.ply").read_bytes() == bent.read_bytes()
    expect_stretch(shown, plain, points, load(bent)[0], faces)
    assert np.ptp(shown[250:350, 70].mean(-1)) > 10 # the shape is still seen, where nothing is stretched, too
    w.key("b") # who marks sees the marks: there are none
    w.do("mousemove", x, y - 250)
    red = w.seen()
    assert np.count_nonzero(red[..., 0] > red[..., 2] + 60) < 200 # the point
    w.key("m")
    w.click(w.place("stretch"), (x, y - 250))
    w.key("ctrl+z")
    w.toggle_tool()
    w.shot("left")
    assert np.array_equal(load(w.save("left.ply"))[0], points)


def test_says_what_cannot_be_done(window, tmp_path):
    points, faces = tube(80, 64)
    w = window(write_ply(tmp_path / "tube.ply", points, faces))
    w.start_tool()
    w.key("ctrl+Return")
    w.wait("Nothing was moved, so there is nothing to apply.")
    w.do("mousemove", MIDDLE[0], MIDDLE[1] - 250) # at the mesh, that place would become one
    w.key("g")
    w.wait("There is no handle yet: mark one, or drag a point of the surface.")
    w.key("p")
    w.wait("There is no handle whose pivot you could place: mark one, or drag a point of the surface.")
    mark_two_regions(w)
    x, y = MIDDLE
    w.more()
    w.click(w.place("motions"))
    w.do("type", "--delay", "5", "7: translate 0 0 1")
    w.click(w.place("take"))
    w.wait("The motions move handle 7, but no vertex has that tag.")
    assert not any(nodes for _, nodes, *_ in w.traces("full")) # nothing was solved


def test_drag_on_the_surface_bends_and_leaving_keeps(window, tmp_path):
    points, faces = tube(80, 64)
    w = window(write_ply(tmp_path / "tube.ply", points, faces))
    before = w.save("before.ply").read_bytes()
    w.start_tool()
    x, y = MIDDLE
    name = lambda: np.asarray(w.picture().convert("L"))[118:146, 990:1100] # in the list of layers
    saved = name()
    w.press_and_move((x + 40, y), (x + 60, y - 120))
    w.shot("dragging")
    w.do("mouseup", 1)
    w.shot("released")
    assert not np.array_equal(name(), saved) # it has a star
    assert len(w.traces("drag")) > 1 and w.traces("full")
    bent = load(w.save("bent.ply"))[0] # the tool is on
    moved = np.linalg.norm(bent - points, axis=1)
    assert moved.max() > 0.1 and 0.5 < np.mean(moved == 0) < 0.98 # beyond the radius nothing moves
    w.key("ctrl+z")
    assert w.save("undone.ply").read_bytes() == before
    w.key("ctrl+shift+z")
    assert np.array_equal(load(w.save("redone.ply"))[0], bent)
    w.key("g", "x", "1", "Return")
    typed = np.linalg.norm(load(w.save("typed.ply"))[0] - bent, axis=1).max()
    assert typed == pytest.approx(1, rel=1e-3)
    typed = load(tmp_path / "typed.ply")[0]
    w.toggle_tool()
    w.wait("keeps the pose")
    w.shot("left")
    assert np.array_equal(load(w.save("left.ply"))[0], typed)
    w.start_tool()
    w.key("ctrl+z", "ctrl+z")
    assert w.save("undone_later.ply").read_bytes() == before
    w.toggle_tool()
    assert w.save("at_rest.ply").read_bytes() == before


def memory(process):
    """Resident megabytes."""
    status = Path(f"/proc/{process.pid}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) / 1024


def test_monkey(window, tmp_path):
    points, faces = tube(60, 48)
    first = write_ply(tmp_path / "one.ply", points, faces)
    write_ply(tmp_path / "two.ply", points * np.float32(0.5) + np.float32([0, 0.5, 0]), faces) # where the other does not hide it
    w = window(first)
    w.start_tool()
    seed = int(os.environ.get("FCD_MONKEY_SEED", random.randrange(10**6)))
    print("seed", seed)
    rng = random.Random(seed)
    place = lambda: (MIDDLE[0] + rng.randint(-200, 200), MIDDLE[1] + rng.randint(-150, 150))
    seconds = float(os.environ.get("FCD_MONKEY_SECONDS", "20"))
    start = time.time()
    layers, sizes, bends = 1, [], [] # what is resident, and how often all was solved, at five times
    w.drag((MIDDLE[0] + 40, MIDDLE[1]), (MIDDLE[0] + 60, MIDDLE[1] - 80)) # whatever comes, it has bent something
    while time.time() < start + seconds:
        what = rng.random()
        if what < 0.45:
            w.drag(place(), place(), button=rng.choice([1, 1, 1, 1, 2, 3]))
        elif what < 0.65:
            w.key(rng.choice(["b", "v", "l", "m", "m", "m", "f", "u", "h", "shift+h", "o", "t", "p", "question", "Return", "BackSpace", "ctrl+z", "ctrl+shift+z"]))
        elif what < 0.75: # a motion by keys
            w.key(rng.choice("grs"), rng.choice("xyz"))
            w.do("mousemove", *place())
            w.key(rng.choice(["1", "minus", "m"]))
            w.do("click", rng.choice([1, 3])) # keep, or cancel
        elif what < 0.8:
            w.do("mousemove", *place(), "click", rng.choice([1, 4, 5]))
        elif what < 0.85:
            w.do("mousemove", 1030, rng.choice([133, 164]), "click", 1) # another layer
            if rng.random() < 0.5: # or what is in the list of handles
                x, y, width, _ = w.box("handles")
                w.do("mousemove", x + rng.choice([20, 112, 150, width - 12]), y + 35 + 22 * rng.randint(0, 2), "click", 1)
            w.do("mousemove", *MIDDLE)
        elif what < 0.9: # off and on
            w.toggle_tool()
            w.toggle_tool()
        elif what < 0.95: # the mesh may have left the view, or lie anyhow
            w.do("mousemove", *MIDDLE)
            w.key("ctrl+h", *rng.choice([[], ["ctrl+shift+r"]]), "m") # Reset Trackball, Reload All Meshes
            w.drag((MIDDLE[0] + 20, MIDDLE[1]), place())
        elif layers < 4:
            w.do("mousemove", *MIDDLE)
            w.key("ctrl+i")
            w.do("type", "--delay", "5", str(tmp_path / "two.ply"))
            w.key("Return")
            layers += 1
        assert w.meshlab.poll() is None, f"MeshLab ended, seed {seed}: " + w.text()[-3000:]
        if time.time() > start + seconds * (len(sizes) + 1) / 5:
            sizes.append(round(memory(w.meshlab)))
            bends.append(len(w.traces("full")))
            w.shot("monkey")
    print("resident megabytes", sizes, "bends", bends)
    assert bends[-1] > (bends[0] if seconds > 60 else 0), f"the monkey did nothing, seed {seed}"
    assert w.meshlab.poll() is None
    assert sizes[-1] < sizes[0] + 300, seed
    assert "exception was thrown" not in w.text()
    w.key("Escape", "ctrl+s")
    w.do("type", "--delay", "5", str(tmp_path / "all.mlp"))
    w.key("Return")
    w.shot("project")
    assert (tmp_path / "all.mlp").read_text().count("<MLMesh ") == layers, seed
