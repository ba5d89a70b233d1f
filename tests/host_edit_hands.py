# SPDX-License-Identifier: GPL-3.0-or-later
"""The tool "FCD: Bend" in a modeller's hands: what is marked, pulled and turned there, and what the window says of it. Windows and mice as
in host_edit.py, with the same environment."""
import re
import time

import numpy as np
import pytest

import host_edit
from host_edit import MIDDLE, load
from host_edit import window # noqa: F401, a fixture
from host_edit_state import open_tube

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
