# SPDX-License-Identifier: GPL-3.0-or-later
"""The filters as a person meets them: MeshLab's own window on a screen of 1366 x 768, with a mouse and a keyboard that this
drives. DISPLAY is that screen, without a window manager; FCD_MESHLAB is the program. Prints clicks and seconds of a try; FCD_PICTURES names a folder for pictures of the way."""
import os
import re
import subprocess
import time
from pathlib import Path

import numpy as np
import pymeshlab
import pytest
from PIL import ImageGrab

from conftest import SAMPLES, record, settle

WIDTH, HEIGHT = 1366, 768
FILTERS = ["FCD: Build Deformation Graph", "FCD: Deform Mesh", "FCD: Pose in Place", "FCD: Reset Pose",
           "FCD: Apply Deformation to Layer", "FCD: Save Deformation", "FCD: Tag"]


class Screen:
    """A screen with a window manager."""

    def __init__(self, folder):
        (folder / "run").mkdir(mode=0o700)
        own = {key: value for key, value in os.environ.items() if not key.startswith(("QT_", "LD_"))}  # pymeshlab sets some
        self.environment = dict(own, HOME=str(folder), XDG_RUNTIME_DIR=str(folder / "run"))
        self.manager = self.managed()
        number = os.environ["DISPLAY"].partition(":")[2].partition(".")[0]
        self.processes = [int(Path(f"/tmp/.X{number}-lock").read_text()), self.manager.pid]  # of the X server, too

    def managed(self):
        """The window manager, when it says how many desktops it has. On a busy machine the screen may come after it."""
        for _ in range(20):
            manager = subprocess.Popen(["openbox"], env=self.environment, stderr=subprocess.DEVNULL)
            while manager.poll() is None:
                if subprocess.run(["xdotool", "get_num_desktops"], env=self.environment, capture_output=True, timeout=60, check=False).returncode == 0:
                    return manager
                time.sleep(0.05)
            time.sleep(0.5)
        raise AssertionError("no window manager")

    def close(self):
        self.manager.terminate()
        self.manager.wait()


def alike(one, other):
    """Two pictures of a field, but for its cursor, which comes and goes."""
    return one.shape == other.shape and np.count_nonzero((one != other).any(axis=(0, 2))) <= 2


class Window:
    """MeshLab with a mesh, or a project."""

    def __init__(self, screen, mesh, log):
        self.screen, self.clicks, self.log = screen, 0, log
        with open(log, "w", encoding="utf-8") as out:
            self.program = subprocess.Popen([os.environ["FCD_MESHLAB"], str(mesh)], env=screen.environment, stdout=out,
                                            stderr=subprocess.STDOUT)
        self.main = self.wait("MeshLab 2020.09")
        if mesh.suffix == ".mlp":
            self.wait_for_log("Opened mesh", mesh.read_text().count("<MLMesh "))
        else:
            self.wait_for_log("All files opened")

    def close(self):
        self.program.kill()
        self.program.wait()

    def x(self, *arguments):
        result = subprocess.run(["xdotool", *map(str, arguments)], env=self.screen.environment, capture_output=True, text=True,
                                timeout=60, check=False)
        return result.stdout.strip()

    def find(self, title):
        return self.x("search", "--onlyvisible", "--name", "^" + re.escape(title)).split()

    def until(self, what, that):
        """Waits for something; far longer than it takes."""
        for _ in range(1200):
            assert self.program.poll() is None, f"MeshLab ended: {self.lines()[-3:]}"
            found = that()
            if found:
                return found
            time.sleep(0.05)
        self.picture("never")
        raise AssertionError(f"no {what}; the log ends with {self.lines()[-3:]}")

    def wait(self, title):
        return self.until(title, lambda: self.find(title))[-1]

    def settle(self):
        settle([*self.screen.processes, self.program.pid])

    def settled(self, title):
        """The window of a title, when it has found its place."""
        window = self.wait(title)
        self.settle()
        self.x("windowactivate", "--sync", window)
        self.settle()
        return window

    def lines(self):
        return self.log.read_text(encoding="utf-8", errors="replace").splitlines()

    def wait_for_log(self, text, times=1):
        self.until(text, lambda: sum(text in line for line in self.lines()) >= times)
        self.settle()  # until it is drawn

    def place(self, window):
        found = dict(re.findall(r"(X|Y|WIDTH|HEIGHT)=(-?\d+)", self.x("getwindowgeometry", "--shell", window)))
        return tuple(int(found[key]) for key in ("X", "Y", "WIDTH", "HEIGHT"))

    def click(self, window, x, y, times=1):
        """Negative numbers count from the far edge."""
        left, top, width, height = self.place(window)
        self.clicks += 1
        self.x("mousemove", left + x + (width if x < 0 else 0), top + y + (height if y < 0 else 0), "click", "--repeat", times,
               "--delay", 60, 1)
        self.settle()

    def keys(self, *keys):
        self.x("key", "--delay", 40, *keys)
        self.settle()

    def type(self, text):
        self.x("type", "--delay", 15, text)
        self.settle()

    def search(self, text):
        """Chooses what MeshLab's search finds first."""
        self.x("windowactivate", "--sync", self.main)
        self.x("mousemove", 500, 700)  # away from where the search lists what it finds
        self.keys("ctrl+f")
        self.type(text)
        self.keys("Down", "Return")

    def dialog(self, title, search=None):
        """Opens a filter by MeshLab's search."""
        for _ in range(3):  # a busy machine loses a key at times, while the list of what is found changes
            self.search(search or title)
            for _ in range(100):
                if self.find(title):
                    break
                time.sleep(0.1)
            else:
                self.keys("Escape", "Escape")
                continue
            break
        self.clicks += 1
        return self.settled(title)

    def run(self, title):
        """Runs a filter that asks for nothing."""
        self.search(title)
        self.wait_for_log(f"Applied filter {title}")

    def apply(self, window):
        """Runs the filter of a dialog, which says something in the log. A busy machine loses a click at times."""
        before = len(self.lines())
        for _ in range(3):
            self.click(window, -100, -20)
            if len(self.lines()) > before or self.find("Filter Failure"):
                return
            self.x("windowactivate", "--sync", window)

    def default(self, window):
        """The dialog with the plugin's own values: it opens anew."""
        title = self.x("getwindowname", window)
        self.click(window, 157, -51)
        return self.settled(title)

    def current_layer(self, place):
        """Makes the layer at a place in the list the current one."""
        self.x("mousemove", self.place(self.main)[2] - 306, 133 + 31 * place, "click", 1)
        self.settle()

    def finish(self, window):
        self.click(window, 100, -20)  # Close
        self.until("end of the dialog", lambda: self.find(self.x("getwindowname", window)) == [])

    def enter(self, window, x, y, text):
        """Types into a field. A busy machine loses a click at times, so it looks whether the text came: the field has it both times,
        and had not when it was empty. Not by Delete: where the click was lost, that key deletes what is selected and closes the dialog."""
        clicks = self.clicks + 1
        for down in (0, LINE):
            shown = None
            for _ in range(4):
                self.x("windowactivate", "--sync", window)  # so that the keys go there
                left, top, width, _ = self.place(window)
                row = (left, top + y + down - 8, left + width, top + y + down + 8)
                self.click(window, x, y + down, times=3)
                self.keys("ctrl+a", "BackSpace")
                empty = self.seen(row)
                self.type(text)
                before, shown = shown, self.seen(row)
                if before is not None and alike(before, shown) and not alike(empty, shown):
                    self.clicks = clicks
                    return
        self.picture("no field")
        raise AssertionError(f"'{text}' did not come into the field at {x}, {y}")

    def seen(self, box):
        return np.asarray(ImageGrab.grab(box, xdisplay=self.screen.environment["DISPLAY"]))

    def windows(self):
        return set(self.x("search", "--onlyvisible", "--class", ".").split())

    def choose(self, window, x, y, *keys):
        """From a list that opens on a click. A busy machine loses one at times, or is so slow that its end closes the list again; then
        the field has the focus, and F4 opens it."""
        before = self.windows()

        def opens():
            end = time.time() + 3
            while not self.windows() - before and time.time() < end:
                time.sleep(0.05)
            return self.windows() - before

        for down in (0, LINE, 0, LINE):
            self.x("windowactivate", "--sync", window)
            self.click(window, x, y + down)
            if opens():
                break
            self.keys("F4")
            if opens():
                break
        else:
            self.picture("no list")
            raise AssertionError(f"no list opens at {x}, {y}")
        self.keys(*keys, "Return")
        self.until("end of the list", lambda: not self.windows() - before)

    def picture(self, name):
        if "FCD_PICTURES" in os.environ:
            folder = Path(os.environ["FCD_PICTURES"])
            folder.mkdir(parents=True, exist_ok=True)
            ImageGrab.grab(xdisplay=os.environ["DISPLAY"]).save(folder / f"{name}.png")

    def message(self):
        """The text of the box that a filter that failed shows, which is closed."""
        box = self.wait("Filter Failure")
        self.picture("message")
        self.x("windowactivate", "--sync", box)
        self.keys("Return")
        self.wait_for_log("Filter failed")
        text = [line for line in self.lines() if "Filter failed" in line][-1]
        record(text)
        return text

    def select(self, condition):
        count = sum("selected" in line for line in self.lines())
        window = self.dialog("Conditional Vertex Selection")
        left, top, width, height = self.place(window)
        self.enter(window, width - 60, height - 122, condition)
        self.apply(window)
        self.wait_for_log("selected", count + 1)
        self.finish(window)

    def tag(self, *keys):
        count = sum("outside vertices" in line for line in self.lines())
        window = self.dialog("FCD: Tag")
        self.choose(window, -60, -321, *keys)
        self.picture(f"tag {len(keys)}")
        self.apply(window)
        self.wait_for_log("outside vertices", count + 1)
        self.finish(window)

    def tag_ends(self, low, high):
        """Fixed below, handle 2 above."""
        self.select(f"z < {low}")
        self.tag("Home")
        self.select(f"z > {high}")
        self.tag("Home", "Down", "Down")

    def preview(self, x):
        """The dialog of a pose in place by x, with its preview on."""
        dialog = self.dialog("FCD: Pose in Place")
        self.enter(dialog, *PREVIEW_X, x)
        self.click(dialog, 17, PREVIEW_BOX)
        self.wait_for_log("nodes, ")
        return dialog

    def save_project(self, path):
        """Whose layers' files are there."""
        self.x("windowactivate", "--sync", self.main)
        self.keys("ctrl+s")
        self.settled("Save Project File")
        self.keys("ctrl+a")
        self.type(str(path))
        self.keys("Return")
        self.until("project", lambda: path.exists() and "</MeshLabProject>" in path.read_text())

    def export(self, path):
        self.x("windowactivate", "--sync", self.main)
        self.keys("ctrl+shift+e")
        self.x("windowactivate", "--sync", self.wait("Save \""))
        self.keys("ctrl+a")
        self.type(str(path))
        self.keys("Return")
        options = self.wait("Choose Saving Options")
        self.x("windowactivate", "--sync", options)
        self.keys("Return")
        self.wait_for_log(f"Saved Mesh {path}")


# Where the fields of the dialogs are, from their left and upper, or lower, edge. They are a line of text lower, between two other
# places, where the window has made the dialog narrower, so that the text above takes one more.
LINE = 15
PREVIEW_X, PREVIEW_BOX = (272, 239), -84
MOVE_X, AXIS_Y, AXIS_Z, ANGLE, LIKE_LAYER = (272, 210), (318, 241), (364, 241), (400, 272), (400, 365)


def loaded(path):
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(path))
    return ms


def positions(path):
    ms = loaded(path)  # which holds the mesh
    return ms.current_mesh().vertex_matrix()


def cylinder():
    """A coloured cylinder: (points, faces, colours)."""
    ms = loaded(Path(__file__).resolve().parents[1] / "meshes" / "cylinder.ply")
    points, faces = ms.current_mesh().vertex_matrix(), ms.current_mesh().face_matrix()
    colors = np.ones((len(points), 4))
    colors[:, 0], colors[:, 1], colors[:, 2] = np.round(points[:, 2] * 20) / 255, 0.6, 0.2
    return points, faces, colors


def tags_of_ends(points):
    """Of the cylinder: fixed below, handle 2 above, as Window.tag_ends(0.5, 11.5)."""
    return np.select([points[:, 2] < 0.5, points[:, 2] > 11.5], [0.0, 2.0], 1.0)


@pytest.fixture(scope="module")
def screen(tmp_path_factory):
    if "FCD_MESHLAB" not in os.environ:
        pytest.skip("FCD_MESHLAB names no MeshLab")
    screen = Screen(tmp_path_factory.mktemp("home"))
    yield screen
    screen.close()


@pytest.fixture
def open_mesh(screen, tmp_path):
    windows = []

    def open_mesh(mesh, name="mesh.ply"):
        if mesh is not None:
            ms = pymeshlab.MeshSet()
            ms.add_mesh(mesh, "mesh")
            ms.save_current_mesh(str(tmp_path / name), save_vertex_quality=False)
        windows.append(Window(screen, tmp_path / name, tmp_path / "log"))
        return windows[-1]

    yield open_mesh
    for window in windows:
        window.close()


def rows_of_text(left, top, right, bottom):
    """How many lines of text are in a part of the screen."""
    dark = (np.asarray(ImageGrab.grab(xdisplay=os.environ["DISPLAY"]).convert("L"))[top:bottom, left:right] < 100).any(1)
    return np.count_nonzero(dark[1:] & ~dark[:-1])


def test_every_dialog_fits_the_screen(open_mesh):
    points, faces, colors = cylinder()
    window = open_mesh(pymeshlab.Mesh(points, faces, v_color_matrix=colors))
    for title in FILTERS:
        dialog = window.dialog(title)
        left, top, width, height = window.place(dialog)
        assert height <= 640 and left >= 0 and top >= 0 and left + width <= WIDTH and top + height <= HEIGHT, title
        if title == "FCD: Pose in Place":
            assert left > 700 # the view is seen beside a preview
        window.picture(title)
        window.click(dialog, -100, -51)  # Help
        left, top, width, height = window.place(dialog)
        assert top + height <= HEIGHT, f"{title} with help: {height}"
        window.picture(f"{title}, help")
        if title == "FCD: Reset Pose": # whose helps have 12 lines, and are all seen
            assert rows_of_text(left + width - 260, top + 125, left + width - 20, top + height - 65) == 12
        window.finish(dialog)
    for word in ("warp", "ARAP"):
        window.finish(window.dialog("FCD: Deform Mesh", search=f"{word} deform mesh"))


def test_from_an_open_scan_to_a_bend_and_another(open_mesh, tmp_path):
    points, faces, colors = cylinder()
    window = open_mesh(pymeshlab.Mesh(points, faces, v_color_matrix=colors))
    window.tag_ends(0.5, 11.5)

    dialog = window.dialog("FCD: Deform Mesh")
    window.apply(dialog)
    assert "Nothing would move" in window.message()
    assert rows_of_text(690, 744, 1360, 762) == 0 # the bar of progress is empty
    window.enter(dialog, *MOVE_X, "2")
    window.enter(dialog, *AXIS_Y, "1")
    window.enter(dialog, *AXIS_Z, "0")
    window.enter(dialog, *ANGLE, "30")
    window.apply(dialog)
    window.wait_for_log("is shown")
    window.picture("first try")

    # Another try: a value and Apply. It begins from the mesh again, and takes the place of the first.
    clicks = window.clicks
    window.enter(dialog, *ANGLE, "70")
    window.apply(dialog)
    window.wait_for_log("3 layers of the last try are replaced")
    assert window.clicks - clicks <= 2
    window.finish(dialog)
    window.picture("second try")

    # The dialog remembers.
    dialog = window.dialog("FCD: Deform Mesh")
    window.picture("remembered")
    window.apply(dialog)
    window.wait_for_log("3 layers of the last try are replaced", 2)
    window.finish(dialog)

    window.export(tmp_path / "result.ply")
    ms = loaded(tmp_path / "result.ply")
    result = ms.current_mesh()
    assert np.array_equal(np.round(255 * result.vertex_color_matrix()), np.round(255 * colors)), "the mesh's own colours"
    tags = tags_of_ends(points)
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=tags))
    if "FCD_PLUGIN" in os.environ:
        pymeshlab.load_plugin(os.environ["FCD_PLUGIN"])
        ms.apply_filter("generate_fcd_deformed_mesh", translation=np.array([2.0, 0, 0]), rotation_axis=np.array([0, 1.0, 0]),
                        rotation_angle=70.0)
        distance = np.linalg.norm(ms.current_mesh().vertex_matrix() - result.vertex_matrix(), axis=1)
        assert distance.max() < 0.01, "as in a script with double precision"
    assert np.abs(result.vertex_matrix() - points)[tags == 0].max() < 1e-6
    assert np.linalg.norm(result.vertex_matrix() - points, axis=1)[tags == 2].min() > 1


def test_a_result_that_was_worked_on_is_kept_and_deformed_itself(open_mesh):
    points, faces, colors = cylinder()
    window = open_mesh(pymeshlab.Mesh(points, faces, v_color_matrix=colors))
    window.tag_ends(0.5, 11.5)
    dialog = window.dialog("FCD: Deform Mesh")
    window.enter(dialog, *MOVE_X, "2")
    window.apply(dialog)
    window.wait_for_log("'mesh deformed' is shown")
    window.finish(dialog)
    window.tag_ends(0.5, 11.5)  # the same tags: nothing but its colours changes
    dialog = window.dialog("FCD: Deform Mesh")
    window.apply(dialog)
    window.wait_for_log("'mesh deformed 2' is shown, 'mesh deformed' and the graphs are hidden")
    window.finish(dialog)
    assert not [line for line in window.lines() if "are replaced" in line]


def test_the_whole_way_from_a_preview_to_a_project_that_is_opened_again(open_mesh, tmp_path):
    points, faces, colors = cylinder()
    window = open_mesh(pymeshlab.Mesh(points, faces, v_color_matrix=colors))
    window.tag_ends(0.5, 11.5)
    dialog = window.preview("3")
    window.picture("way, preview")
    window.finish(dialog)

    def bend():
        dialog = window.dialog("FCD: Deform Mesh")
        window.enter(dialog, *MOVE_X, "3")
        window.apply(dialog)
        window.wait_for_log("is shown")
        window.finish(dialog)

    bend()
    window.picture("way, result")
    for place, name in enumerate(["source", "graph", "deformed graph", "result"]):
        window.current_layer(place)
        window.export(tmp_path / f"{name}.ply")
    window.save_project(tmp_path / "way.mlp")
    window.close()

    window = open_mesh(None, "way.mlp")
    window.picture("way, opened again")
    window.export(tmp_path / "result again.ply")
    window.current_layer(0)
    bend()
    window.picture("way, bent again")
    window.export(tmp_path / "bent again.ply")
    bent = positions(tmp_path / "result.ply")
    assert np.abs(bent - points).max() > 2
    assert positions(tmp_path / "result again.ply").tobytes() == bent.tobytes()
    assert positions(tmp_path / "bent again.ply").tobytes() == bent.tobytes()


def placed_copy(tmp_path):
    """A project: a copy of the cylinder, its upper end put elsewhere by the layer's matrix, and the cylinder, which is current."""
    points, faces, colors = cylinder()
    tags = tags_of_ends(points)
    matrix = np.array([[0.5, 0, 0.8660254, -3], [0, 1, 0, 0.5], [-0.8660254, 0, 0.5, 4], [0, 0, 0, 1]], np.float32)
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=tags))
    ms.save_current_mesh(str(tmp_path / "cylinder.ply"), save_vertex_quality=True)
    rows = " ".join(f"{v:.9g}" for v in matrix.ravel())
    (tmp_path / "project.mlp").write_text(f"""<!DOCTYPE MeshLabDocument>
<MeshLabProject><MeshGroup>
<MLMesh label="in place" filename="cylinder.ply"><MLMatrix44>{rows} </MLMatrix44></MLMesh>
<MLMesh label="cylinder" filename="cylinder.ply"><MLMatrix44>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 </MLMatrix44></MLMesh>
</MeshGroup><RasterGroup/></MeshLabProject>
""")
    return points, tags, matrix


def test_the_handle_moves_like_a_layer_that_is_in_place(open_mesh, tmp_path):
    points, tags, matrix = placed_copy(tmp_path)
    window = open_mesh(None, "project.mlp")

    def exported(name):
        window.export(tmp_path / name)
        return positions(tmp_path / name)

    dialog = window.dialog("FCD: Deform Mesh")
    window.choose(dialog, *LIKE_LAYER, "Home")
    window.picture("like a layer")
    window.apply(dialog)
    window.wait_for_log("is shown")
    window.finish(dialog)
    moved = exported("like.ply")
    assert np.abs(moved - points)[tags == 0].max() < 1e-6
    assert np.abs(moved - (points @ matrix[:3, :3].T + matrix[:3, 3]))[tags == 2].max() < 1e-5

    # A script that the window saves.
    window.x("windowactivate", "--sync", window.main)
    window.keys("alt+l", "Down", "Return")  # Show current filter script
    script = window.settled("Dialog")
    # xdotool takes a window with a title for as much lower as its title is high.
    window.click(script, 51, -48)  # Save Script
    window.settled("Save Filter Script File")
    window.keys("ctrl+a")
    window.type(str(tmp_path / "script.mlx"))
    window.keys("Return")
    window.until("script", (tmp_path / "script.mlx").exists)
    window.click(script, -170, -48)  # Close
    (tmp_path / "server").mkdir()
    done = subprocess.run([str(Path(os.environ["FCD_MESHLAB"]).with_name("meshlabserver")), "-p", str(tmp_path / "project.mlp"), "-s",
                           str(tmp_path / "script.mlx"), "-o", str(tmp_path / "server.ply")], env=window.screen.environment,
                          text=True, timeout=300, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    assert done.returncode == 0, done.stdout
    assert positions(tmp_path / "server.ply").tobytes() == moved.tobytes()

    # The dialog remembers the layer, as long as there is one of its name; Default does not.
    dialog = window.dialog("FCD: Deform Mesh")
    window.enter(dialog, *MOVE_X, "1")
    window.apply(dialog)
    window.wait_for_log("3 layers of the last try are replaced")
    assert np.abs(exported("again.ply") - moved)[tags == 2].max() == pytest.approx(1, abs=1e-5)
    dialog = window.default(dialog)
    window.apply(dialog)
    assert "Nothing would move" in window.message()
    window.finish(dialog)

    # A layer after the results in the list, which has another place there when they are replaced.
    window.current_layer(0)
    dialog = window.dialog("FCD: Build Deformation Graph")  # of the copy, with its matrix
    window.apply(dialog)
    window.wait_for_log("Applied filter FCD: Build")
    window.finish(dialog)
    window.current_layer(4)
    dialog = window.dialog("FCD: Deform Mesh")
    window.choose(dialog, *LIKE_LAYER, "End")
    for count in 2, 3:
        window.apply(dialog)
        window.wait_for_log("3 layers of the last try are replaced", count)
    window.picture("like a later layer")
    window.finish(dialog)
    assert exported("later.ply").tobytes() == moved.tobytes()


def test_a_preview_follows_and_goes(open_mesh, tmp_path):
    points, faces, colors = cylinder()
    window = open_mesh(pymeshlab.Mesh(points, faces, v_color_matrix=colors))
    window.export(tmp_path / "before.ply")
    window.tag_ends(0.5, 11.5)
    dialog = window.preview("3")
    window.enter(dialog, *PREVIEW_X, "4")
    window.keys("Tab")
    window.wait_for_log("already prepared")
    window.picture("preview")
    dialog = window.default(dialog)  # while it previews
    window.picture("preview, default")
    window.finish(dialog)
    window.run("FCD: Clear Tags")
    window.export(tmp_path / "after.ply")
    assert (tmp_path / "before.ply").read_bytes() == (tmp_path / "after.ply").read_bytes()


def test_the_result_shows_its_texture(open_mesh, shared, tmp_path):
    """Deforms a textured knot, and counts what is drawn in the colours of its image, which are not those of light."""
    def colourful(name):
        window.picture(name)
        picture = np.array(ImageGrab.grab(xdisplay=os.environ["DISPLAY"]).convert("RGB")).astype(int)[100:600, 640:920]
        return ((picture.max(2) - picture.min(2) > 150) & (picture.min(2) < 40)).sum()

    ms = loaded(shared / "meshes" / "attr" / "texturedknot.ply")
    x = ms.current_mesh().vertex_matrix()[:, 0]
    low, high = x.min() + 0.15 * np.ptp(x), x.max() - 0.15 * np.ptp(x)
    ms.compute_scalar_by_function_per_vertex(q=f"x < {low} ? 0 : (x > {high} ? 2 : 1)")
    (tmp_path / "textured").mkdir()
    ms.save_current_mesh(str(tmp_path / "textured" / "knot.ply"), save_vertex_quality=True, save_vertex_color=False)
    window = open_mesh(None, "textured/knot.ply")
    before = colourful("texture")
    dialog = window.dialog("FCD: Deform Mesh")
    window.enter(dialog, *MOVE_X, "10")
    window.apply(dialog)
    window.wait_for_log("is shown")
    window.finish(dialog)
    assert not any("loading texture" in line for line in window.lines())
    assert before > 500 and colourful("texture, deformed") > before / 2


@pytest.mark.parametrize("subdivisions, least", [(0, 5000), (2, 80000), (4, 1280000)])
def test_what_a_try_takes(open_mesh, tmp_path, subdivisions, least):
    """Of the bunny, about 5 thousand, 80 thousand and 1.3 million vertices."""
    ms = loaded(SAMPLES / "bunny10k_textured.obj")
    ms.meshing_merge_close_vertices()
    if subdivisions:
        ms.meshing_surface_subdivision_midpoint(iterations=subdivisions, threshold=pymeshlab.PercentageValue(0))
    points, faces = ms.current_mesh().vertex_matrix(), ms.current_mesh().face_matrix()
    assert len(points) > least
    low, high = points.min(0), points.max(0)
    axis = int(np.argmax(high - low))
    points = np.roll((points - low) / (high - low).max(), 2 - axis, axis=1)  # along z from 0 to 1
    ms.add_mesh(pymeshlab.Mesh(points, faces, v_scalar_array=np.where(points[:, 2] < 0.1, 0.0, np.where(points[:, 2] > 0.9, 2.0, 1.0))))
    ms.save_current_mesh(str(tmp_path / "mesh.ply"), save_vertex_quality=True)
    window = open_mesh(None)
    dialog = window.dialog("FCD: Deform Mesh")
    window.enter(dialog, *AXIS_Y, "1")
    window.enter(dialog, *AXIS_Z, "0")
    for count, angle in enumerate((20, 30, 40)):
        clicks, start = window.clicks, time.perf_counter()
        window.enter(dialog, *ANGLE, str(angle))
        window.apply(dialog)
        window.wait_for_log("is shown", count + 1)
        print(f"{len(points)} vertices, try {count + 1}: {window.clicks - clicks} clicks, {time.perf_counter() - start:.2f} s")
        assert window.clicks - clicks <= 2
    window.picture(f"{len(points)} vertices")
