# SPDX-License-Identifier: GPL-3.0-or-later
"""The tool "FCD: Fit": pairs on two layers, the surface that follows them, and the pull. Windows and mice as in host_edit.py, with the
same environment."""

import shutil

import numpy as np
import pytest

import host_edit
from host_edit import MIDDLE, Filters, load, the_dialogs_are_those_of_2020, tube_of, write_ply
from host_edit import window # noqa: F401, a fixture
from host_meshlabserver import Run, fit_filter

pytestmark = host_edit.pytestmark

X, Y = MIDDLE
UNIT, HIGH = 280, 0.13 # pixels a unit, before the axes, and the height in the middle of the view


def bow(points):
    return points + np.outer(0.3 * (1 - points[:, 0] ** 2), [0, 1, 0]).astype(points.dtype)


def on_template(x, y=0.0):
    return round(X + UNIT * x), round(Y - UNIT * (y - HIGH))


def on_target(x, y=0.0):
    return on_template(x, y + 0.3 * (1 - x * x))


def open_two(window, tmp_path, *others):
    """A straight tube, current, and one that is bent like a bow, and others before. Returns the first one's points and faces, too."""
    target, target_faces = tube_of(np.linspace(-1, 1, 150), 48, 0.25)
    points, faces = tube_of(np.linspace(-1, 1, 40), 16, 0.25) # with twice as many vertices, a pull takes five times as long
    return window(*others, write_ply(tmp_path / "scan.ply", bow(target), target_faces), write_ply(tmp_path / "template.ply", points, faces)), points, faces


def place_pairs(w):
    """Three of them. After each one the template lies elsewhere: first it has moved, then it has turned, too."""
    left, middle = np.array(on_target(-0.7)), np.array(on_target(0))
    w.click(on_template(-0.7))
    w.shot("one_end")
    w.click(left)
    w.click(left + (0.7 * UNIT, 0))
    w.click(middle)
    w.click(2 * middle - left)
    w.click(on_target(0.7))


def pull(w):
    before = w.text().count("trace: pulled")
    w.key("p")
    w.wait("trace: pulled", before + 1)
    w.settle()


def answer(w, button, title, name):
    """Gives a name to the dialog that a button opens."""
    w.click(w.place(button))
    asked = w.wait_for_title(title)
    w.do("type", "--delay", "5", name)
    w.key("Return")
    w.wait_for_title("MeshLab", other_than=asked)


def save_pairs(w, name):
    saved = w.text().count("Saved the pairs")
    answer(w, "save", "Save pairs", str(w.folder / name))
    w.wait("Saved the pairs", saved + 1)
    return w.folder / name


def pairs_of(path):
    """Vertices and places of a list, and its names."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    numbers = np.array([line.partition("#")[0].split(",") for line in lines], float)
    return numbers[:, 0].astype(int), numbers[:, 1:], [line.partition("#")[2].strip() for line in lines]


def test_a_template_is_laid_onto_a_scan(window, tmp_path):
    """Pairs in turn, one is dragged, the pull, and what is applied is what the filter gives with the saved pairs."""
    w, points, _ = open_two(window, tmp_path)
    before = w.save("before.ply").read_bytes()
    w.start_tool("FCD: Fit")
    w.shot("started")
    place_pairs(w)
    w.key("2") # both
    w.shot("pairs")
    vertices, places, names = pairs_of(save_pairs(w, "pairs.csv"))
    assert names == ["1", "2", "3"]
    assert np.abs(points[vertices][:, 0] - (-0.7, 0, 0.7)).max() < 0.06 and points[vertices][:, 2].min() > 0.2
    heights = 0.3 * (1 - places[:, 0] ** 2)
    assert np.abs(places[:, 0] - (-0.7, 0, 0.7)).max() < 0.05
    assert np.abs(np.hypot(places[:, 1] - heights, places[:, 2]) - 0.25).max() < 2e-3 # on the scan
    followed = load(w.save("followed.ply"))[0]
    assert np.abs(followed[vertices] - places).max() < 1e-5 # the surface follows at once

    w.press_and_move(on_target(0), on_target(0, 0.1)) # the surface follows while it is dragged
    w.shot("dragged")
    w.do("mouseup", 1)
    assert w.text().count("trace: follow") > 5
    moved = pairs_of(save_pairs(w, "moved.csv"))[1]
    assert np.abs(moved - places)[[0, 2]].max() == 0 and 0.05 < moved[1, 1] - places[1, 1] < 0.15
    assert np.abs(load(w.save("followed_on.ply"))[0][vertices] - moved).max() < 1e-5
    w.key("ctrl+z")
    assert np.array_equal(load(w.save("followed_back.ply"))[0], followed)

    pull(w)
    w.click(w.place("distance"))
    w.shot("pulled")
    pulled = load(w.save("pulled.ply"))[0]
    off = np.abs(np.hypot(pulled[:, 1] - 0.3 * (1 - pulled[:, 0] ** 2), pulled[:, 2]) - 0.25)[abs(points[:, 0]) < 0.99]
    assert np.percentile(off, 95) < 0.01
    w.key("ctrl+shift+Return")
    w.wait("In a script: ")
    w.shot("applied")
    applied = load(w.save("applied.ply"))[0]
    assert np.array_equal(applied, pulled)
    assert np.array_equal(fitted(tmp_path, fit_filter(0, landmarks=tmp_path / "pairs.csv")), applied)
    assert (tmp_path / "before.ply").read_bytes() == before


PAIRS = """# vertex, x, y, z of its place on the target # name
{0}, -0.7, 0.403, 0 # left
{1}, 0, 0.55, 0 # top
{2}, 0.7, 0.403, 0 # right
{3}, 0.0, 0.3, 0.25 # front
"""


def write_pairs(points, path):
    """Three on the upper side, and one at the front."""
    places = [(-0.7, 0.25, 0), (0, 0.25, 0), (0.7, 0.25, 0), (0, 0, 0.25)]
    path.write_text(PAIRS.format(*(np.linalg.norm(points - place, axis=1).argmin() for place in places)))
    return path


def test_what_stays_of_a_fit(window, tmp_path):
    """What is shown; undo leads back over that, pairs come back with the tool, and both files hold them."""
    w, points, _ = open_two(window, tmp_path)
    before = w.save("before.ply").read_bytes()
    w.start_tool("FCD: Fit")
    answer(w, "load", "Load pairs", str(write_pairs(points, tmp_path / "pairs.csv")))
    w.wait("trace: follow")
    w.shot("loaded")
    saved = save_pairs(w, "saved.csv")
    assert saved.read_text() == (tmp_path / "pairs.csv").read_text().replace("0.0,", "0,")
    vertices, places, _ = pairs_of(saved)
    followed = load(w.save("followed.ply"))[0]
    assert np.abs(followed[vertices] - places).max() < 1e-5
    alone = fitted(tmp_path, fit_filter(0, landmarks=saved, landmarks_only=True, start=2))
    assert np.array_equal(np.delete(alone, vertices, 0), np.delete(followed, vertices, 0)) # these are put there at last

    pull(w)
    pulled = load(w.save("pulled.ply"))[0]
    assert np.abs(pulled[vertices] - places).max() < 1e-6 and np.abs(pulled - followed).max() > 1e-3
    w.key("ctrl+Return")
    w.wait("In a script: ms.apply_filter('generate_fcd_fitted_mesh', target_layer=0, landmarks_file='pairs.csv', start=2, graph_layers=False)")
    assert np.array_equal(load(w.save("applied.ply"))[0], pulled)
    w.key("ctrl+z")
    w.wait("trace: pulled", 2)
    assert np.array_equal(load(w.save("undone.ply"))[0], pulled)
    w.key("ctrl+z", "ctrl+z")
    assert w.save("at_rest.ply").read_bytes() == before
    w.key("ctrl+shift+z", "ctrl+shift+z")
    assert np.array_equal(load(w.save("redone.ply"))[0], pulled)
    x, y, width, height = w.box("stiffness")
    w.do("mousemove", x + width // 2, y + height // 2, "click", 4)
    w.wait("trace: pulled", 3)
    assert np.abs(load(w.save("stiffer.ply"))[0] - pulled).max() > 1e-6
    w.toggle_tool("FCD: Fit", is_on=True)
    w.wait("keeps the fit: undo in the tool, or 'FCD: Reset Pose', takes it back.")
    left = load(w.save("left.ply"))[0]
    assert np.abs(left - pulled).max() > 1e-6 # what is shown is kept: that of another stiffness

    w.start_tool("FCD: Fit")
    assert np.array_equal(load(w.save("still.ply"))[0], left)
    assert save_pairs(w, "back.csv").read_bytes() == saved.read_bytes()
    w.key("ctrl+z")
    w.wait("trace: pulled", 4)
    assert np.array_equal(load(w.save("softer.ply"))[0], pulled)
    w.key("BackSpace")
    assert w.save("at_rest_again.ply").read_bytes() == before
    picked = save_pairs(w, "picked.pp")
    w.click(w.place("clear"))
    answer(w, "load", "Load pairs", str(picked))
    assert save_pairs(w, "from_picked.csv").read_bytes() == saved.read_bytes()
    beside = points[vertices] + [0.004, 0, 0.001] # places between vertices stay what they are
    (tmp_path / "beside.csv").write_text("".join(f"{a}, {b}, {c}, {d}, {e}, {f}\n" for a, b, c, d, e, f in np.hstack([beside, places])))
    answer(w, "load", "Load pairs", str(tmp_path / "beside.csv"))
    kept = [np.array(line.partition("#")[0].split(","), float) for line in save_pairs(w, "kept.csv").read_text().splitlines()[1:]]
    assert np.abs(kept - np.hstack([beside, places])).max() < 1e-6


@the_dialogs_are_those_of_2020
@pytest.mark.parametrize(("title", "is_moved"), [("Taubin Smooth", True), ("Re-Compute Vertex Normals", False)])
def test_what_a_filter_makes_of_a_fitted_layer_stays(window, tmp_path, title, is_moved):
    """Of one whose dialog was open before the tool: its positions, or its normals alone."""
    w, points, _ = open_two(window, tmp_path)
    filters = Filters(w)
    dialog = filters.dialog(title)
    w.do("windowmove", dialog, 960, 350) # not over the panel
    w.start_tool("FCD: Fit")
    answer(w, "load", "Load pairs", str(write_pairs(points, tmp_path / "pairs.csv")))
    w.wait("trace: follow")
    followed = load(w.save("followed.ply"))[0]
    assert np.abs(followed - points).max() > 0.1
    filters.apply(dialog)
    w.wait(f"Applied filter {title}")
    filters.finish(dialog)
    filters.back()
    changed = w.save("changed.ply").read_bytes()
    assert np.array_equal(load(tmp_path / "changed.ply")[0], followed) != is_moved
    w.toggle_tool("FCD: Fit", is_on=True)
    assert w.save("left.ply").read_bytes() == changed
    w.start_tool("FCD: Fit")
    w.key("ctrl+z")
    w.toggle_tool("FCD: Fit", is_on=True)
    assert w.save("left_again.ply").read_bytes() == changed


def test_an_apply_does_not_wait_for_what_is_prepared(window, tmp_path):
    """And is not bent once more when that is done."""
    target, target_faces = tube_of(np.linspace(-1, 1, 150), 48, 0.25)
    points, faces = tube_of(np.linspace(-1, 1, 300), 120, 0.25)
    w = window(write_ply(tmp_path / "scan.ply", bow(target), target_faces), write_ply(tmp_path / "template.ply", points, faces))
    w.start_tool("FCD: Fit")
    answer(w, "load", "Load pairs", str(write_pairs(points, tmp_path / "pairs.csv")))
    w.wait("trace: follow")
    vertices, places, _ = pairs_of(save_pairs(w, "saved.csv"))
    w.key("BackSpace")
    w.click(w.place("start")) # another one, for which it is prepared anew
    w.key("Home", "Return")
    w.click(w.place("follow"))
    w.settle()
    w.key("BackSpace")
    w.click(w.place("start"))
    w.key("Down", "Return")
    w.while_asleep(w.meshlab, "mousemove", *w.place("follow"), "click", 1, "mousemove", X, Y, "key", "ctrl+Return")
    w.wait("In a script: ")
    w.settle()
    applied = load(w.save("applied.ply"))[0]
    assert np.abs(applied[vertices] - places).max() < 1e-5
    w.key("ctrl+z")
    w.key("BackSpace")
    assert np.array_equal(load(w.save("undone.ply"))[0], points)


def test_what_does_not_count_is_carried_along(window, tmp_path):
    """One end of the target is something else: the template's end there counts no more, by its quality."""
    target, target_faces = tube_of(np.linspace(-1, 1, 150), 48, 0.25)
    points, faces = tube_of(np.linspace(-1, 1, 40), 16, 0.25)
    bulge = target + np.outer(np.clip(target[:, 0] - 0.4, 0, None), [0, 0.8, 0]).astype(target.dtype)
    counts = np.where(points[:, 0] > 0.3, 0, 1).astype(np.float32)
    w = window(write_ply(tmp_path / "scan.ply", bulge, target_faces), write_ply(tmp_path / "template.ply", points, faces, counts))
    w.start_tool("FCD: Fit")
    pull(w)
    end = points[:, 0] > 0.8
    drawn = load(w.save("all.ply"))[0][end, 1].mean()
    pulled = w.text().count("trace: pulled")
    w.click(w.place("weights"))
    w.key("Down", "Return") # by vertex quality
    w.wait("trace: pulled", pulled + 1)
    w.settle()
    w.shot("weights")
    carried = load(w.save("carried.ply"))[0][end, 1].mean()
    assert drawn > 0.2 and abs(carried) < 0.1 # of 0.4 at the end
    w.key("ctrl+z")
    w.wait("trace: pulled", pulled + 2)
    w.settle()
    assert load(w.save("undone.ply"))[0][end, 1].mean() == drawn
    w.key("ctrl+shift+z")
    w.wait("trace: pulled", pulled + 3)
    w.key("ctrl+shift+Return")
    w.wait("weights=1, graph_layers=False")


def colored(w):
    """Pixels of the view that are tinted as what is carried along."""
    seen = w.seen()
    return int(((seen[..., 2] > seen[..., 1] + 40) & (seen[..., 0] > seen[..., 1] + 20)).sum())


def sheet(across):
    """From -1 to 1 along x, half as high."""
    x, y = np.meshgrid(np.linspace(-1, 1, 2 * across + 1), np.linspace(-0.5, 0.5, across + 1), indexing="ij")
    first = (np.arange(2 * across)[:, None] * (across + 1) + np.arange(across)).ravel()
    faces = np.stack([first, first + across + 1, first + 1, first + 1, first + across + 1, first + across + 2], 1).reshape(-1, 3)
    return np.stack([x, y, 0 * x], 2).reshape(-1, 3).astype(np.float32), faces


def test_the_brush_paints_what_is_carried_along(window, tmp_path):
    """The same by the brush: a stroke down the end that is something else, and one step of undo."""
    target, target_faces = sheet(40)
    points, faces = sheet(20)
    target[:, 2] += 0.8 * np.clip(target[:, 0] - 0.4, 0, None)
    w = window(write_ply(tmp_path / "scan.ply", target, target_faces), write_ply(tmp_path / "template.ply", points, faces))
    stroke = (X + 180, Y - 50), (X + 180, Y + 120) # the end of either layer is at X + 240 and more
    w.start_tool("FCD: Fit")
    w.key("3") # this layer alone
    w.settle()
    plain = colored(w)
    w.key("b")
    for _ in range(11):
        w.do("mousemove", *on_template(0.6), "click", 4) # the wheel: 20 * 1.15^11 pixels
    w.drag(*stroke)
    w.settle()
    w.shot("carried")
    painted = colored(w)
    assert painted > plain + 20000
    w.key("b") # pairs again
    w.settle()
    assert colored(w) == plain
    end = points[:, 0] > 0.8
    pull(w)
    carried = load(w.save("carried.ply"))[0]
    w.key("ctrl+z", "ctrl+z") # the pull, and the stroke
    pull(w)
    drawn = load(w.save("drawn.ply"))[0]
    assert drawn[end, 2].mean() > 0.3 and abs(carried[end, 2].mean()) < 0.1
    w.key("BackSpace")

    # On the target, which then pulls less there.
    w.key("4", "b")
    w.settle()
    w.drag(*stroke)
    w.settle()
    w.shot("target")
    painted = colored(w)
    assert painted > plain + 20000
    pull(w)
    assert abs(load(w.save("less.ply"))[0][end, 2].mean()) < 0.1
    pulled = w.text().count("trace: pulled")
    w.key("4", "x")
    w.drag((X + 230, Y), (X + 230, Y + 60)) # that counts again, and is pulled so
    w.wait("trace: pulled", pulled + 1)
    w.settle()
    assert plain + 2000 < colored(w) < painted - 5000
    w.key("b", "ctrl+shift+Return")
    w.wait("target_weights=3")


def write_curves(path, turn):
    """The template's upper line belongs turned about the axis by so many degrees on the target."""
    x, angle = np.linspace(-0.95, 0.95, 20), np.radians(turn)
    line = np.stack([x, np.full(20, 0.25), np.zeros(20)], 1)
    turned = np.stack([x, np.full(20, 0.25 * np.cos(angle)), np.full(20, 0.25 * np.sin(angle))], 1)
    path.write_text("curve,surface,x,y,z\n" + "".join(f"top,{surface},{a!r},{b!r},{c!r}\n" for surface, places in (("source", line), ("target", bow(turned)))
                                                     for a, b, c in places.tolist()))
    return path


def along_top(points, positions):
    """Where the template's upper line is: the mean of its places across."""
    top = (abs(points[:, 2]) < 1e-6) & (points[:, 1] > 0.2) & (abs(points[:, 0]) < 0.9)
    return positions[top, 2].mean()


def test_curves_lead_the_pull(window, tmp_path):
    """They are drawn on both layers, go with undo, and are there when the tool comes back."""
    w, points, _ = open_two(window, tmp_path)
    w.start_tool("FCD: Fit")
    w.key("2")
    plain = w.seen()
    file = write_curves(tmp_path / "curves.csv", 40)
    (tmp_path / "bad.csv").write_text("curve,surface,x,y,z\ntop,source,0,0\n")
    answer(w, "curves", "Load curves", str(tmp_path / "bad.csv"))
    w.wait("bad.csv', line 2: found 4 cells")
    answer(w, "curves", "Load curves", str(file))
    w.settle()
    w.shot("curves")
    lines = np.abs(w.seen() - plain).sum(2) > 60
    color = w.seen()[lines]
    assert 500 < lines.sum() < 20000
    assert ((color[:, 2] > 200) & (color[:, 0] < 90)).sum() > 100 and ((color[:, 0] > 220) & (color[:, 2] < 80)).sum() > 100 # blue, orange
    w.key("3") # this layer alone
    assert not ((w.seen()[..., 0] > 220) & (w.seen()[..., 2] < 80)).any()
    w.key("2")
    pull(w)
    w.shot("pulled_with_curves")
    led = load(w.save("led.ply"))[0]
    assert abs(along_top(points, led) - 0.25 * np.sin(np.radians(40))) < 0.02
    w.key("ctrl+z", "ctrl+z") # the pull, and the curves
    assert (np.abs(w.seen() - plain).sum(2) > 60).sum() < 50
    pull(w)
    assert abs(along_top(points, load(w.save("without.ply"))[0])) < 0.02
    answer(w, "curves", "Load curves", str(file)) # while it is pulled
    w.wait("trace: pulled", 3)
    assert np.array_equal(load(w.save("led_again.ply"))[0], led)
    w.key("BackSpace")
    w.toggle_tool("FCD: Fit", is_on=True)
    w.start_tool("FCD: Fit")
    w.key("p")
    assert np.array_equal(load(w.save("back.ply"))[0], led)
    w.click(w.place("nocurves"))
    w.wait("trace: pulled", 4)
    w.key("ctrl+z")
    w.wait("trace: pulled", 5)
    w.key("ctrl+Return")
    w.wait(f"curves_file='{file}', graph_layers=False)")
    w.wait("The curves are gone: they belonged to the earlier shape")
    w.shot("applied")
    pull(w)
    w.key("ctrl+z", "ctrl+z") # over the apply
    w.wait("trace: pulled", 7)
    assert np.array_equal(load(w.save("undone.ply"))[0], led)
    file.write_text(file.read_text().replace(",0.25,", ",9.25,"))
    answer(w, "curves", "Load curves", str(file))
    w.wait("from the vertices of 'template.ply' there, more than a tenth of its diagonal")


def test_a_file_is_replaced_only_when_asked(window, tmp_path):
    """Also one whose ending the tool has added to what was typed."""
    w, points, _ = open_two(window, tmp_path)
    w.start_tool("FCD: Fit")
    answer(w, "load", "Load pairs", str(write_pairs(points, tmp_path / "pairs.csv")))
    w.wait("trace: follow")
    walk = tmp_path / "walk.csv"
    walk.write_text("mine")
    w.click(w.place("save"))
    for key in ("Return", "y"): # no, which is chosen; yes
        w.wait_for_title("Save pairs")
        w.key("ctrl+a")
        w.do("type", "--delay", "5", str(tmp_path / "walk"))
        w.key("Return")
        w.settle()
        assert walk.read_text() == "mine" and "Saved the pairs" not in w.text()
        w.shot("asked")
        w.key("alt+y" if key == "y" else key)
    w.wait("Saved the pairs")
    assert len(pairs_of(walk)[0]) == 4


def test_bad_pairs_change_nothing(window, tmp_path):
    w, points, _ = open_two(window, tmp_path)
    before = w.save("before.ply").read_bytes()
    w.start_tool("FCD: Fit")
    w.click(w.place("save"))
    w.wait("There is no pair of landmarks to be saved.")
    w.key("ctrl+Return")
    w.wait("Nothing is fitted yet: place pairs, or press 'Pull', then apply.")
    w.click(on_template(-0.7))
    w.key("p")
    w.wait("The pair '1' is on one layer only. Click its point on the other one, or remove the pair.")
    w.key("ctrl+z")
    w.click(on_target(-0.7))
    w.key("3")
    first, beside = on_target(-0.7), (on_target(-0.7)[0] + 60, on_target(-0.7)[1]) # where the template is now
    w.click(beside)
    w.drag(beside, first)
    w.wait("The pair '1' is at that vertex already.")
    w.key("Delete", "BackSpace")
    assert w.save("same.ply").read_bytes() == before
    (tmp_path / "bad.csv").write_text("0, 1, 2\n")
    answer(w, "load", "Load pairs", str(tmp_path / "bad.csv"))
    w.wait("bad.csv', line 1: found 3 numbers; expected 4")
    assert len(pairs_of(save_pairs(w, "pairs.csv"))[0]) == 1 # that of before
    w.do("key", "p", "key", "ctrl+Return")
    w.wait("The pull is not done yet: wait until it is, or press 'Pull'.")
    w.wait("trace: pulled")
    w.key("BackSpace")
    assert w.save("still.ply").read_bytes() == before
    w.toggle_tool("FCD: Fit", is_on=True)

    w.start_tool() # which leaves another shape
    w.drag((X, on_template(0)[1]), (X, on_template(0)[1] - 80))
    w.toggle_tool()
    w.start_tool("FCD: Fit")
    assert save_pairs(w, "kept.csv").read_bytes() == (tmp_path / "pairs.csv").read_bytes() # its vertices are there


def test_a_layer_alone_has_no_target(window, tmp_path):
    w = window(write_ply(tmp_path / "tube.ply", *tube_of(np.linspace(-1, 1, 60), 24, 0.25)))
    w.start_tool("FCD: Fit")
    w.shot("alone")
    w.click(MIDDLE)
    w.wait("There is no other layer to fit onto. Open the scan as another layer, or choose a target.")


def fitted(tmp_path, script):
    """The positions that meshlabserver gives the template of open_two()."""
    folder = tmp_path / "server"
    folder.mkdir()
    for name in ("scan.ply", "template.ply"):
        shutil.copy(tmp_path / name, folder)
    path = folder / "both.mlp"
    path.write_text('<!DOCTYPE MeshLabDocument>\n<MeshLabProject><MeshGroup>' + "".join(
        f'<MLMesh label="{name}.ply" filename="{name}.ply"><MLMatrix44>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</MLMatrix44></MLMesh>'
        for name in ("scan", "template")) + "</MeshGroup><RasterGroup/></MeshLabProject>\n")
    run = Run(folder, None, script, project=path)
    return next(mesh for name, mesh in run.meshes.items() if "fitted" in name).vertex_matrix()
