# SPDX-License-Identifier: GPL-3.0-or-later
"""The tool "FCD: Bend" straightens a layer along a line. Windows and mice as in host_edit.py, with the same environment."""

import re

import numpy as np
import pytest

import host_edit
from host_edit import MIDDLE, VERSION, load, tube_of, write_ply
from host_edit import window # noqa: F401, a fixture
from host_edit_fit import answer
from host_edit_hands import LIT, colored, state_text
from host_edit_state import EYE, choose_layer
from host_meshlabserver import Run, straighten_filter

pytestmark = host_edit.pytestmark

X, Y = MIDDLE


def straightened(folder, rest, line, **parameters):
    """The tube that meshlabserver straightens along a line."""
    folder.mkdir()
    run = Run(folder, rest, straighten_filter(0, line, straightened_quality=0, **{"towards": (0, 0, 0), **parameters}))
    assert run.code == 0, run.log
    return run.meshes["tubestraightened"].vertex_matrix()


def bent_tube(folder):
    """The file of it."""
    points, faces = tube_of(np.linspace(-1, 1, 120), 32, 0.1)
    points[:, 1] += 0.3 * np.cos(1.5 * points[:, 0]) - 0.2
    return write_ply(folder / "tube.ply", points, faces)


def place(x):
    """Where it is in the view, on its nearer side."""
    return round(X + 285 * x), round(Y - 285 * (0.3 * np.cos(1.5 * x) - 0.16))


def straighten(w):
    """Presses the button, and returns the call for a script."""
    calls = w.text().count("FCD: Bend: In a script: ")
    started = w.text().count("Started Mode FCD: Bend")
    w.click(w.place("straighten"))
    w.wait("FCD: Bend: In a script: ", calls + 1)
    w.wait("Started Mode FCD: Bend", started + 1) # with the new layer
    w.settle()
    return re.findall(r"FCD: Bend: In a script: (.*\))", w.text())[-1]


def test_a_layer_is_straightened_along_a_line(window, tmp_path):
    """Which is clicked on it, point by point, or that of a layer; the filter makes the same of it, to the bit."""
    rest = bent_tube(tmp_path)
    w = window(rest)
    w.start_tool()
    w.key("n")
    w.click(w.place("straighten"))
    w.wait("There is no line yet: click points along the layer, in their order, or choose a layer with edges.")
    for x in (-0.9, -0.6, -0.3, 0.3):
        w.click(place(x))
    w.drag(place(0.3), place(0))
    for x in (0.3, 0.6, 0.9, 0.75):
        w.click(place(x))
    w.key("Delete") # the one under the mouse
    w.key("ctrl+z", "ctrl+shift+z")
    w.do("mousemove", X, Y + 200)
    w.key("Delete", "ctrl+z") # the last one
    w.click(place(0.92)) # which is close to that, and takes it
    w.shot("line")
    answer(w, "saveline", "Save line", str(tmp_path / "line"))
    w.wait("Saved the line as")
    line = np.loadtxt(tmp_path / "line.csv", delimiter=",", skiprows=1)
    assert len(line) == 7 and np.all(np.diff(line[:, 0]) > 0.2) and abs(line[3, 0]) < 0.05
    call = straighten(w)
    assert call == "ms.apply_filter('generate_fcd_straightened_mesh', line_layer=1, middle=True, graph_layers=False)"
    w.shot("straight")
    straight = load(w.save("straight.ply"))[0]
    assert np.array_equal(straight, straightened(tmp_path / "server", rest, tmp_path / "line.csv", to=0, middle=True))
    assert np.abs(straight[:, 1] - straight[:, 1].mean()).max() < 0.12

    choose_layer(w, 0) # at rest, with its line
    w.key("n")
    answer(w, "saveline", "Save line", str(tmp_path / "again.csv"))
    w.wait("again.csv.")
    assert (tmp_path / "again.csv").read_text() == (tmp_path / "line.csv").read_text()
    w.click(w.place("clearline"))
    w.do("mousemove", *w.place("line"), "click", 5) # the wheel: the layer with the line
    w.do("mousemove", *w.place("becomes"), "click", 5) # an arc
    call = straighten(w)
    assert call.endswith("line_layer=1, middle=True, to=1, angle=90, graph_layers=False)"), call
    bent = load(w.save("bent.ply"))[0]
    assert np.array_equal(bent, straightened(tmp_path / "server2", rest, tmp_path / "line.csv", to=1, middle=True))

    choose_layer(w, 0)
    w.key("n")
    (tmp_path / "far.csv").write_text("0, 9, 0\n0, 9, 1\n")
    answer(w, "loadline", "Load line", str(tmp_path / "far.csv"))
    w.click(w.place("straighten"))
    w.wait("The line is outside of the surface")
    w.key("ctrl+z") # the points of before


def enter(w, name, text):
    """Types it into a field of the panel."""
    w.click(w.place(name))
    w.key("ctrl+a")
    w.do("type", "--delay", 5, text)
    w.key("Return")


def lines_found(w):
    """Of each line that was found: how many points it was given by, and its length."""
    return [(int(points), length) for points, length in re.findall(r"trace: line: \d+ vertices, (\d+) points, length (\S+), in", w.text())]


def wait_for_line(w, points, before):
    w.until(f"line of {points} points", lambda: len(lines_found(w)) > before and lines_found(w)[-1][0] == points)
    return float(lines_found(w)[-1][1])


def test_the_line_that_is_used_is_shown(window, tmp_path):
    """While it is clicked: through the middle, with its length, as the filter finds it."""
    points, faces = tube_of(np.linspace(-1, 1, 120), 48, 0.25)
    w = window(write_ply(tmp_path / "tube.ply", points, faces))
    w.start_tool()
    w.key("n")
    clicked = [(X + round(285 * x), Y - 45) for x in (-0.8, -0.3, 0.2, 0.7)] # at the upper side of what is seen
    found = 0
    for i, each in enumerate(clicked):
        w.click(each)
        w.do("mousemove", X, Y + 200)
        found, length = len(lines_found(w)), wait_for_line(w, i + 1, found)
    w.shot("middle")
    at = lambda x, y: colored(w, (X + round(285 * x), Y - y), LIT)
    assert at(0, 0) > 20 and at(0, 45) == 0 and at(-0.3, 45) > 20 # the points are where they were clicked
    assert length == pytest.approx(1.5, abs=0.03) # in newer windows a pixel is another part of it
    state = state_text(w)
    w.key("ctrl+z")
    w.until("line of 3 points", lambda: lines_found(w)[-1][0] == 3)
    w.shot("undone")
    assert state_text(w) != state and at(0.45, 0) == 0 and at(0, 0) > 20
    w.key("ctrl+shift+z")
    w.until("line of 4 points", lambda: lines_found(w)[-1][0] == 4)
    assert state_text(w) == state
    w.click(w.place("middle")) # the line itself
    w.do("mousemove", X, Y + 200)
    w.shot("as_clicked")
    assert at(0, 0) == 0 and at(0, 45) > 20
    w.click(w.place("middle"))
    w.do("mousemove", X, Y + 200)
    w.until("line of 4 points", lambda: at(0, 0) > 20)
    count = len(lines_found(w))
    w.press_and_move(clicked[3], (clicked[3][0] - 60, clicked[3][1])) # which is the line while it is dragged
    w.until("a shorter line", lambda: len(lines_found(w)) > count and float(lines_found(w)[-1][1]) < length - 0.15)
    w.do("mouseup", 1)
    w.shot("dragged")
    length = lines_found(w)[-1][1]
    straighten(w)
    assert f"The line through the middles of the cross-sections is {length} long" in w.text()

    (tmp_path / "far.csv").write_text("0, 9, 0\n0, 9, 1\n")
    choose_layer(w, 0)
    w.key("n")
    answer(w, "loadline", "Load line", str(tmp_path / "far.csv"))
    w.until("no line", lambda: lines_found(w)[-1] == (2, "0")) # the panel says why
    w.shot("far")
    w.click(w.place("clearline"))
    w.do("mousemove", *w.place("line"), "click", 5) # the wheel: the layer with the line
    w.until("that of the layer", lambda: lines_found(w)[-1] == (0, length))
    w.click(EYE) # it was hidden for the straight one
    w.shot("of_a_layer")
    assert at(0, 0) > 20


def test_a_large_layer_does_not_wait_for_its_line(window, tmp_path):
    """Clicks are taken while the surface is made ready; what is no longer wanted is stopped."""
    points, faces = tube_of(np.linspace(-1, 1, 900), 224, 0.25)
    w = window(write_ply(tmp_path / "large.ply", points, faces))
    before = w.save("before.ply").read_bytes()
    w.start_tool()
    place = lambda i: (X - 240 + 60 * i, Y - 30)
    w.do("mousemove", *place(0), "key", "n", *[word for i in range(9) for word in ("mousemove", *place(i), "click", 1)], settle=False)
    assert wait_for_line(w, 9, 0) == pytest.approx(480 / 285, rel=0.05) # in newer windows it is shown larger
    assert w.text().index("trace: click: 201602 vertices, 1 points") < w.text().index("trace: line: ")
    w.click(place(8)[:1] + (Y + 30,))
    w.key("m") # bends
    w.key("n", "m", "n")
    w.toggle_tool()
    w.shot("left")
    assert w.save("left.ply").read_bytes() == before


def test_an_arc_has_a_direction_and_bends_to_a_side(window, tmp_path):
    """As the filter's parameters of these names: the same bits."""
    rest = bent_tube(tmp_path)
    line = tmp_path / "line.csv"
    points = [[x, 0.3 * np.cos(1.5 * x) - 0.2, 0] for x in np.linspace(-0.95, 0.95, 9)]
    np.savetxt(line, np.float32(points), delimiter=", ", fmt="%.17g") # as a layer has them
    w = window(rest)
    w.start_tool()
    w.key("n")
    answer(w, "loadline", "Load line", str(line))
    enter(w, "direction", "0 0.3 1")
    w.shot("direction")
    call = straighten(w)
    assert call == "ms.apply_filter('generate_fcd_straightened_mesh', line_layer=1, middle=True, direction=numpy.array([0, {:.17g}, 1]), " \
                   "graph_layers=False)".format(float(np.float32(0.3))), call
    straight = load(w.save("straight.ply"))[0]
    assert np.array_equal(straight, straightened(tmp_path / "server", rest, line, to=0, middle=True, direction=(0, 0.3, 1)))
    spread = np.linalg.svd(straight - straight.mean(0), full_matrices=False)[2][0]
    assert abs(spread @ [0, 0.3, 1]) > 0.999 * np.linalg.norm([0, 0.3, 1])

    choose_layer(w, 0)
    w.key("n")
    w.do("mousemove", *w.place("becomes"), "click", 5) # an arc
    enter(w, "towards", "up")
    w.click(w.place("straighten"))
    w.wait("'Bends towards' is 'up': give three numbers, x y z, or 0 0 0 to follow the line.")
    enter(w, "direction", "0, 1, 0")
    enter(w, "towards", "0; 0; -2.5")
    w.shot("towards")
    call = straighten(w)
    assert "to=1, angle=90, direction=numpy.array([0, 1, 0]), towards=numpy.array([0, 0, -2.5])" in call
    bent = load(w.save("bent.ply"))[0]
    assert np.array_equal(bent, straightened(tmp_path / "server2", rest, line, to=1, middle=True, direction=(0, 1, 0), towards=(0, 0, -2.5)))
    ends = bent[:, 1] > np.quantile(bent[:, 1], 0.95)
    assert bent[ends, 2].mean() < bent[:, 2].mean() - 0.1


def test_a_layer_is_not_changed_by_a_line(window, tmp_path):
    """MeshLab's list of layers does not say that it is, either; of the new layers it does."""
    w = window(bent_tube(tmp_path))
    w.start_tool()
    w.key("n")
    for x in (-0.9, -0.3, 0.3, 0.9):
        w.click(place(x))
    straighten(w) # after which the list is written anew
    choose_layer(w, 0)
    w.shot("unchanged")
    left, end = {"2020.09": (1027, 117), "2022.02": (1043, 108), "2025.07": (1002, 108)}[VERSION] # of the names in the list
    behind = lambda row, x: np.ptp(np.asarray(w.picture().convert("L"))[122 + 31 * row:142 + 31 * row, left + x:left + 130]) # where a star is
    assert behind(0, 32) == 0 and behind(2, end) > 50
