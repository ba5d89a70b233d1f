# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tool "FCD: Bend" knows of a layer, in a file for another run. Windows and mice as in host_edit.py, with the same environment."""
import hashlib
import re

import numpy as np
import pytest

import host_edit
from host_edit import MIDDLE, Filters, Window, load, the_dialogs_are_those_of_2020, tube, tube_of, write_ply
from host_edit import window # noqa: F401, a fixture
from host_edit_fit import answer, on_target, on_template, open_two, pairs_of, place_pairs, pull, save_pairs, write_curves
from host_edit_hands import keep_pose, tube_with_poses
from host_edit_state import PULL, import_another

pytestmark = host_edit.pytestmark

X, Y = MIDDLE


@pytest.fixture
def another(tmp_path):
    """Opens windows of other runs."""
    opened = []

    def open_window(*meshes):
        folder = tmp_path / f"run{len(opened)}"
        folder.mkdir()
        opened.append(Window(folder, *meshes))
        return opened[-1]

    yield open_window
    for each in opened:
        each.close()


def choose(w, key, title, path):
    """A file, by the menu."""
    w.click(w.place("session"))
    w.key(key)
    asked = w.wait_for_title(title)
    w.do("type", "--delay", 5, str(path))
    w.key("Return")
    w.wait_for_title("MeshLab", other_than=asked)


def save_session(w, path):
    saved = w.text().count("Saved the session as")
    choose(w, "s", "Save session", path)
    w.wait("Saved the session as", saved + 1)
    assert w.said().startswith(f"Saved the session as {path.with_suffix('.fcd')}.\n")
    return known(path.with_suffix(".fcd"))


def load_session(w, path):
    choose(w, "l", "Load session", path)
    w.wait(f"Loaded the session {path}.")
    w.settle()


def known(path):
    """What a session says of handles, motions, and line."""
    return re.search(rb"FCD bend 1\n(?:[a-z]+ [^\n]*\n)+", path.read_bytes())[0].decode()


def poses_of(w, path):
    w.unfold("poses_fold", "keep")
    answer(w, "saveposes", "Save poses", str(path))
    w.wait(f"Saved the poses as {path}.")
    return path.read_text()


def full_session(window, tmp_path):
    """Marks, a pose with a name and key frames, another motion, a line, a name, other options. Returns the shape, the text, the poses."""
    w = tube_with_poses(window, tmp_path)[0]
    w.drag((X + 225, Y), (X + 165, Y - 150))
    keep_pose(w, "bent")
    w.do("mousemove", X, Y + 200)
    poses = poses_of(w, tmp_path / "poses.csv")
    w.click(w.place("poses_fold")) # and so it stays, until a session with poses is loaded
    w.more()
    x, y, width, height = w.box("patches")
    w.click((x + width // 3, y + height // 2))
    w.key("ctrl+a")
    w.do("type", "--delay", 5, "123")
    w.key("Return")
    w.click(w.place("more"))
    w.do("mousemove", X, Y + 200)
    w.key("g", "x", "0", "period", "1", "Return", "r", "z", "2", "0", "Return", "n")
    for x in (-150, 0, 50):
        w.click((X + x, Y))
    w.do("mousemove", X, Y + 200)
    w.key("m")
    shape = load(w.save("posed.ply"))[0]
    w.shot("before")
    text = save_session(w, tmp_path / "all.fcd")
    assert np.array_equal(load(w.save("saved.ply"))[0], shape)
    assert "\ndetail 123\n" in text and "\nmark 0 " in text and "\nmark 2 " in text and "\nmotions 2: " in text and "\nrim " in text and text.count("\nline ") == 3
    return w, shape, text, poses


def check_whole(w, folder, shape, text, poses, points):
    """The tool shows, and knows, all of a session. What is shown is solved again, too."""
    w.shot("all_is_there")
    assert np.array_equal(load(w.save("loaded.ply"))[0], shape)
    w.key("BackSpace")
    assert np.array_equal(load(w.save("rest.ply"))[0], points)
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("again.ply"))[0], shape)
    assert poses_of(w, folder / "poses.csv") == poses
    assert save_session(w, folder / "all.fcd") == text


def test_a_session_goes_on_in_another_run(window, another, tmp_path):
    w, shape, text, poses = full_session(window, tmp_path)
    w.drag((X, Y - 40), (X + 10, Y - 90)) # the first run goes on
    assert not np.array_equal(load(w.save("on.ply"))[0], shape)
    points = load(tmp_path / "tube.ply")[0]

    w = another(tmp_path / "tube.ply")
    w.start_tool()
    w.drag((X - 20, Y - 40), (X - 20, Y - 90))
    pulled = load(w.save("pulled.ply"))[0]
    assert not w.is_unfolded("keep")
    load_session(w, tmp_path / "all.fcd")
    assert w.is_unfolded("keep")
    assert np.array_equal(load(w.save("there.ply"))[0], shape)
    w.key("ctrl+z") # what was there before
    assert np.array_equal(load(w.save("undone.ply"))[0], pulled)
    w.key("ctrl+shift+z")
    check_whole(w, w.folder, shape, text, poses, points)
    w.toggle_tool()
    w.start_tool()
    w.drag((X + 180, Y), (X + 160, Y - 60)) # and it goes on
    assert not np.array_equal(load(w.save("bent_on.ply"))[0], shape)


def by_filter(filters, title, path, says):
    dialog = filters.dialog(title)
    filters.click(dialog, -60, -112) # of the file
    filters.screen.shot(title)
    asked = filters.screen.wait_for_title("", other_than=title)
    filters.screen.do("type", "--delay", 5, str(path))
    filters.screen.key("Return")
    filters.screen.wait_for_title("FCD", "MeshLab", other_than=asked)
    filters.apply(dialog)
    filters.wait_for_log(says)
    filters.finish(dialog)
    filters.back()


@the_dialogs_are_those_of_2020
def test_pairs_of_a_fit_go_on_in_another_run(window, another, tmp_path):
    """Those of which an end is missing, too."""
    w, _, _ = open_two(window, tmp_path)
    w.start_tool("FCD: Fit")
    place_pairs(w)
    pairs = save_pairs(w, "pairs.csv").read_bytes()
    w.click(on_target(0.3)) # where the template is now
    w.toggle_tool("FCD: Fit", is_on=True)
    by_filter(Filters(w), "FCD: Save Session", tmp_path / "pairs.fcd", "pairs of 'FCD: Fit': 4, options")
    w = another(tmp_path / "scan.ply", tmp_path / "template.ply")
    by_filter(Filters(w), "FCD: Load Session", tmp_path / "pairs.fcd", "pairs of 'FCD: Fit': 4, options")
    w.start_tool("FCD: Fit")
    w.shot("pairs_are_there")
    w.click(w.place("save"))
    w.wait("The pair '4' is on one layer only.")
    w.click(on_target(0.3))
    assert len(save_pairs(w, "four.csv").read_bytes()) > len(pairs)
    w.key("ctrl+z", "ctrl+z", "ctrl+z") # the place, the fit, and what was loaded
    w.click(w.place("save"))
    w.wait("There is no pair of landmarks to be saved.")


@the_dialogs_are_those_of_2020
def test_options_of_a_fit_go_on_in_another_run(window, another, tmp_path):
    """What the panel says, and the target by its name, among other layers."""
    target, target_faces = tube_of(np.linspace(-1, 1, 150), 48, 0.25)
    other = write_ply(tmp_path / "other.ply", target, target_faces)
    w, points, _ = open_two(window, tmp_path, other)
    w.start_tool("FCD: Fit")
    w.click(w.place("target"))
    w.key("End", "Return") # the scan, which is not the first one
    x, y, width, height = w.box("stiffness")
    w.do("mousemove", x + width // 2, y + height // 2, "click", "--repeat", 3, 4)
    w.click(w.place("start"))
    w.key("Home", "Return")
    answer(w, "curves", "Load curves", str(write_curves(tmp_path / "curves.csv", 20)))
    pull(w)
    w.shot("told")
    pulled = load(w.save("pulled.ply"))[0]
    w.key("BackSpace")
    w.toggle_tool("FCD: Fit", is_on=True)
    w.start_tool("FCD: Fit") # which goes on with the same
    w.key("p") # it knows the shape
    assert np.array_equal(load(w.save("pulled_again.ply"))[0], pulled)
    w.key("BackSpace")
    w.toggle_tool("FCD: Fit", is_on=True)
    by_filter(Filters(w), "FCD: Save Session", tmp_path / "fit.fcd", "Saved: options of 'FCD: Fit'.")

    w = another(other, tmp_path / "scan.ply", tmp_path / "template.ply")
    by_filter(Filters(w), "FCD: Load Session", tmp_path / "fit.fcd", "Loaded: options of 'FCD: Fit'.")
    w.start_tool("FCD: Fit")
    w.shot("options_are_there")
    pull(w)
    w.shot("pulled_as_then")
    assert np.array_equal(load(w.save("as_then.ply"))[0], pulled)
    w.key("ctrl+z", "ctrl+z") # the pull, and what was loaded
    pull(w)
    assert not np.array_equal(load(w.save("by_defaults.ply"))[0], pulled)

    w = another(other, tmp_path / "template.ply")
    (tmp_path / "curves.csv").unlink()
    by_filter(Filters(w), "FCD: Load Session", tmp_path / "fit.fcd", "no other layer is called 'scan.ply', its target, and its curves are not there, ")
    w.start_tool("FCD: Fit")
    w.wait("The curves of the layer 'template.ply' are left out: Cannot open '")
    w.wait("The layer 'template.ply' was fitted to 'scan.ply', which is not here: open it and choose this layer again, or choose another target.")
    w.shot("target_is_not_here")


def test_the_fit_saves_and_loads_sessions(window, another, tmp_path):
    """By its own button. Undo leads back to what was there before."""
    w, points, _ = open_two(window, tmp_path)
    w.start_tool("FCD: Fit")
    choose(w, "s", "Save session", tmp_path / "none.fcd")
    w.wait("Nothing is known of the layer 'template.ply' that a session would keep.")
    place_pairs(w)
    pull(w)
    choose(w, "s", "Save session", tmp_path / "pulled") # .fcd is added
    w.wait("keeps the fit: undo in the tool, or 'FCD: Reset Pose', takes it back.")
    w.wait(f"Saved the session as {tmp_path / 'pulled.fcd'}. It has ")
    has = "the rest shape, pairs of 'FCD: Fit': 3, options of 'FCD: Fit', the fit that the layer shows."
    w.wait(has)
    pulled = load(w.save("pulled.ply"))[0]
    w.key("ctrl+z")
    assert not np.array_equal(load(w.save("goes_on.ply"))[0], pulled)

    w = another(tmp_path / "scan.ply", tmp_path / "template.ply")
    w.start_tool("FCD: Fit")
    w.click(on_template(-0.2))
    w.click(on_target(-0.2))
    followed = load(w.save("followed.ply"))[0]
    (tmp_path / "cut.fcd").write_bytes((tmp_path / "pulled.fcd").read_bytes()[:-9])
    choose(w, "l", "Load session", tmp_path / "cut.fcd")
    w.wait("is no session")
    assert not np.array_equal(followed, points) and np.array_equal(load(w.save("still.ply"))[0], followed)
    choose(w, "l", "Load session", tmp_path / "pulled.fcd")
    w.wait(f"Loaded the session {tmp_path / 'pulled.fcd'}. It has {has} The layer was at rest; it has the saved pose now.")
    w.wait("trace: pulled") # for the distances
    w.settle()
    w.shot("loaded")
    assert np.array_equal(load(w.save("as_then.ply"))[0], pulled)
    assert len(pairs_of(save_pairs(w, "three.csv"))[0]) == 3
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("undone.ply"))[0], points)
    w.key("ctrl+z")
    assert len(pairs_of(save_pairs(w, "one.csv"))[0]) == 1


def reset_pose(w):
    filters = Filters(w)
    dialog = filters.dialog("FCD: Reset Pose")
    filters.apply(dialog)
    filters.wait_for_log("Applied filter FCD: Reset Pose")
    filters.finish(dialog)
    filters.back()


def fitted_session(w, path, had):
    """Leaves the tool, and saves what it shows."""
    w.toggle_tool("FCD: Fit", is_on=True)
    w.wait("keeps the fit: undo in the tool, or 'FCD: Reset Pose', takes it back.")
    by_filter(Filters(w), "FCD: Save Session", path, f"Saved: the rest shape, pairs of 'FCD: Fit': 3, options of 'FCD: Fit', {had}")
    return load(w.save(path.stem + ".ply"))[0]


@the_dialogs_are_those_of_2020
def test_a_fit_goes_on_in_another_run(window, another, tmp_path):
    """As it was pulled, and as its pairs took it: it is undone, changed, applied and left as there."""
    w, points, _ = open_two(window, tmp_path)
    meshes = tmp_path / "scan.ply", tmp_path / "template.ply"
    shown = "the fit that the layer shows."
    w.start_tool("FCD: Fit")
    place_pairs(w)
    fitted_session(w, tmp_path / "followed.fcd", shown)
    w.start_tool("FCD: Fit")
    pull(w)
    pulled = fitted_session(w, tmp_path / "pulled.fcd", shown)

    w = another(*meshes)
    by_filter(Filters(w), "FCD: Load Session", tmp_path / "pulled.fcd", f"{shown} The layer was at rest; it has the saved pose now.")
    w.start_tool("FCD: Fit")
    w.wait("trace: pulled") # for the distances
    w.settle()
    w.shot("pulled_as_then")
    assert np.array_equal(load(w.save("as_then.ply"))[0], pulled)
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("undone.ply"))[0], points)
    assert len(pairs_of(save_pairs(w, "pairs.csv"))[0]) == 3 # which are undone next
    w.key("ctrl+shift+z")
    assert np.array_equal(load(w.save("redone.ply"))[0], pulled)
    w.key("BackSpace")
    assert np.array_equal(load(w.save("at_rest.ply"))[0], points)
    w.key("ctrl+z", "ctrl+Return")
    w.wait("In a script: ms.apply_filter('generate_fcd_fitted_mesh', target_layer=0, landmarks_file='pairs.csv'")
    assert np.array_equal(load(w.save("applied.ply"))[0], pulled)
    w.toggle_tool("FCD: Fit", is_on=True)
    reset_pose(w)
    assert np.array_equal(load(w.save("reset.ply"))[0], points)

    w = another(*meshes)
    by_filter(Filters(w), "FCD: Load Session", tmp_path / "followed.fcd", shown)
    followed = load(w.save("followed.ply"))[0]
    assert not np.array_equal(followed, points) and not np.array_equal(followed, pulled)
    w.start_tool("FCD: Fit")
    assert np.array_equal(load(w.save("still.ply"))[0], followed)
    w.press_and_move(on_target(0), on_target(0, 0.1))
    w.do("mouseup", 1)
    w.settle()
    w.shot("goes_on")
    assert not np.array_equal(load(w.save("dragged.ply"))[0], followed)
    w.key("ctrl+z")
    w.settle()
    assert np.abs(load(w.save("followed_back.ply"))[0] - followed).max() < 1e-6
    w.toggle_tool("FCD: Fit", is_on=True)
    w.wait("keeps the fit: undo in the tool, or 'FCD: Reset Pose', takes it back.")
    reset_pose(w)
    assert np.array_equal(load(w.save("reset.ply"))[0], points)


@the_dialogs_are_those_of_2020
def test_a_pull_of_another_run_stays_where_its_target_is_not_here(window, another, tmp_path):
    """Or where it is cancelled, or left before it is done."""
    w, points, _ = open_two(window, tmp_path)
    w.start_tool("FCD: Fit")
    place_pairs(w)
    pull(w)
    pulled = fitted_session(w, tmp_path / "pulled.fcd", "the fit that the layer shows.")
    (tmp_path / "other.ply").write_bytes((tmp_path / "scan.ply").read_bytes())
    w = another(tmp_path / "other.ply", tmp_path / "template.ply")
    by_filter(Filters(w), "FCD: Load Session", tmp_path / "pulled.fcd", "no other layer is called 'scan.ply', its target.")
    w.start_tool("FCD: Fit")
    w.wait("was fitted to 'scan.ply', which is not here")
    w.key("ctrl+Return")
    w.wait("The pull is not done yet: wait until it is, or press 'Pull'.")
    assert "trace: pulled" not in w.text()
    w.toggle_tool("FCD: Fit", is_on=True)
    by_filter(Filters(w), "FCD: Save Session", tmp_path / "again.fcd", "the fit that the layer shows.")
    assert np.array_equal(load(w.save("still.ply"))[0], pulled)
    w.start_tool("FCD: Fit")
    pull(w)
    assert np.array_equal(load(w.save("onto_the_other.ply"))[0], pulled)
    w.key("BackSpace")
    assert np.array_equal(load(w.save("at_rest.ply"))[0], points)


@the_dialogs_are_those_of_2020
def test_the_tool_goes_on_with_what_the_filter_loads(window, another, tmp_path):
    _, shape, text, poses = full_session(window, tmp_path)
    w = another(tmp_path / "tube.ply")
    filters = Filters(w)
    by_filter(filters, "FCD: Load Session", tmp_path / "all.fcd", "handles and motions of 'FCD: Bend'")
    w.start_tool()
    check_whole(w, w.folder, shape, text, poses, load(tmp_path / "tube.ply")[0])
    filters.run("FCD: Clear Tags") # the tool is elsewhere meanwhile
    filters.back()
    w.start_tool()
    w.wait("The handles that the layer 'tube.ply' keeps do not fit its marks")
    assert np.array_equal(load(w.save("cleared.ply"))[0], shape)


def changed(data, before, after):
    """A session that says something else, of the same length."""
    assert data.count(before) == 1 and len(before) == len(after)
    at = data.index(b"layer") + 6 # as CBOR has bytes, with four of their length
    layer = data[at + 4:at + 4 + int.from_bytes(data[at:at + 4], "big")]
    new = layer.replace(before, after)
    return data.replace(layer, new).replace(hashlib.sha256(layer).digest(), hashlib.sha256(new).digest())


def test_a_session_of_another_layer_is_refused(window, tmp_path):
    points, faces = tube(80, 64)
    w = window(write_ply(tmp_path / "tube.ply", points, faces))
    w.start_tool()
    choose(w, "s", "Save session", tmp_path / "none.fcd")
    w.wait("Nothing is known of the layer 'tube.ply' that a session would keep.")
    w.drag(*PULL)
    pulled = load(w.save("pulled.ply"))[0]
    save_session(w, tmp_path / "tube") # .fcd is added
    data = (tmp_path / "tube.fcd").read_bytes()
    w.drag((X - 120, Y), (X - 130, Y + 80))
    both = load(w.save("both.ply"))[0]
    assert not np.array_equal(both, pulled)
    (tmp_path / "later.fcd").write_bytes(changed(data, b"FCD bend 1", b"FCD bend 2"))
    choose(w, "l", "Load session", tmp_path / "later.fcd")
    w.wait("line 1: expected 'FCD bend 1': this is of another version of the tool.")
    assert np.array_equal(load(w.save("both_still.ply"))[0], both)
    (tmp_path / "odd.fcd").write_bytes(changed(data, b"axes 0\npose 100\n", b"weights 12345.5\n"))
    load_session(w, tmp_path / "odd.fcd") # the layer has its pose then, and the tool begins there
    w.wait("The handles that the layer 'tube.ply' keeps do not fit its marks, or its poses: bends begin from the shape that it has now.")
    assert np.array_equal(load(w.save("odd.ply"))[0], pulled)
    import_another(w, tmp_path)
    w.drag((X, Y - 90), (X + 20, Y - 150))
    bent = load(w.save("bent.ply"))[0]
    choose(w, "l", "Load session", tmp_path / "tube.fcd")
    w.wait("is of a layer with")
    w.shot("refused")
    assert np.array_equal(load(w.save("still.ply"))[0], bent)
    (tmp_path / "cut.fcd").write_bytes(data[:-7])
    choose(w, "l", "Load session", tmp_path / "cut.fcd")
    w.wait("is no session")
    assert np.array_equal(load(w.save("still_so.ply"))[0], bent) and not np.array_equal(bent, pulled)
