#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual's pictures of MeshLab's window: the tools and the filters' dialogs, by a scripted mouse as in host_edit.py. Look at each
before it is kept.

  FCD_MESHLABSERVER=$PWD/build/meshlab-2020.09/meshlabserver build/venv/bin/python tests/pictures.py docs/pictures [steps bend preview result fit]
"""
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pymeshlab
from PIL import Image

import host_edit_fit
import host_window
from host_edit import MIDDLE, Filters, Window
from host_edit_hands import keep_pose

X, Y = MIDDLE
CACTUS = Path(__file__).resolve().parents[1] / "meshes" / "cactus.ply"
GREY = (0.75, 0.75, 0.75, 1.0)
SMOOTH = (1134, 438) # the button of the shading by vertex, in MeshLab's list of layers


def write(picture, path, box=None, width=None):
    picture = picture.convert("RGB").crop(box or (0, 0, *picture.size))
    if width:
        picture = picture.resize((width, round(picture.height * width / picture.width)), Image.Resampling.LANCZOS)
    picture.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE).save(path, optimize=True)


def cactus(folder):
    """Upright in the view that a mesh opens in."""
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(CACTUS))
    mesh = ms.current_mesh()
    ms.add_mesh(pymeshlab.Mesh(mesh.vertex_matrix()[:, [1, 2, 0]], mesh.face_matrix(), v_color_matrix=np.tile(GREY, (mesh.vertex_number(), 1))))
    ms.save_current_mesh(str(folder / "cactus.ply"), save_vertex_quality=False)
    return folder / "cactus.ply"


def name_handle(w, row, name):
    x, y, _, _ = w.box("handles")
    w.click((x + 45, y + 35 + 22 * row), count=2)
    w.do("key", "ctrl+a", "type", "--delay", "5", name)
    w.key("Return")


def steps(w, out):
    """drag.png and marks.png: steps 5, 7 and 8 of docs/window.md."""
    w.click(SMOOTH)
    w.start_tool(mode="d")
    w.drag((X - 110, Y - 110), (X - 150, Y - 60))
    write(w.picture(), out / "drag.png", (0, 90, 950, 734), 700)
    w.key("ctrl+z", "t", "b", "f")
    for y in range(150, 216, 15):
        w.drag((X - 20, Y + y), (X + 20, Y + y + 5))
    w.key("h")
    for y in range(-190, -144, 15):
        w.drag((X - 20, Y + y), (X + 20, Y + y + 5))
    write(w.picture(), out / "marks.png", (0, 90, 950, 734), 700)


def bend(w, out):
    """bend.png: steps 3 to 9 of docs/window.md, another handle, and poses that are kept."""
    w.click(SMOOTH)
    w.start_tool()
    w.unfold("poses_fold", "keep")
    w.key("v", "t", "f")
    w.drag((X - 100, Y + 100), (X + 100, Y + 260))
    w.key("h")
    w.drag((X - 50, Y - 260), (X + 50, Y - 120))
    w.key("shift+h")
    w.drag((X - 200, Y - 260), (X - 90, Y - 100))
    w.key("m")
    for row, name in enumerate(("top", "arm")):
        name_handle(w, row, name)
    w.do("mousemove", X - 120, Y - 140)
    w.key("g", "x", "minus", "period", "1", "5", "Return")
    keep_pose(w, "wave")
    w.do("mousemove", X, Y - 170)
    w.key("r", "z", "minus", "2", "0", "Return")
    keep_pose(w, "lean")
    write(w.picture(), out / "bend.png", width=900)


def tag(w, out):
    """tag.png: the foot fixed, the top a handle. Returns the filters' dialogs."""
    f = Filters(w)
    w.click(SMOOTH)
    f.select("y < 0.3")
    f.tag("Home")
    f.select("(y > 0.7) && (abs(x - 0.5) < 0.1)")
    dialog = f.dialog("FCD: Tag")
    f.choose(dialog, -60, -321, "Home", "Down", "Down")
    f.apply(dialog)
    f.wait_for_log("outside vertices", 2)
    f.x("windowmove", "--sync", dialog, 946, 92) # beside the mesh
    write(w.picture(), out / "tag.png", (200, 90, 1366, 740), 950)
    f.finish(dialog)
    f.select("y > 2") # nothing
    return f


def preview(w, out):
    """preview.png."""
    f = tag(w, out)
    f.preview("0.1")
    write(w.picture(), out / "preview.png", width=1100)


def result(w, out):
    """dialog.png, and result.png after a second try."""
    f = tag(w, out)
    dialog = f.dialog("FCD: Deform Mesh")
    f.enter(dialog, *host_window.ANGLE, "20")
    x, y, width, height = f.place(dialog)
    write(w.picture(), out / "dialog.png", (x, y, x + width, y + height))
    f.apply(dialog)
    f.wait_for_log("is shown")
    f.enter(dialog, *host_window.ANGLE, "30")
    f.apply(dialog)
    f.wait_for_log("layers of the last try are replaced")
    f.finish(dialog)
    w.click(SMOOTH)
    write(w.picture(), out / "result.png", width=1100)


def fit(w, out):
    """fit.png, as docs/fit.md tells it: pairs, the pull, the distance."""
    w.start_tool("FCD: Fit")
    host_edit_fit.place_pairs(w)
    host_edit_fit.pull(w)
    w.click(w.place("distance"))
    w.do("mousemove", X, Y + 200)
    write(w.picture(), out / "fit.png", (0, 90, 950, 734), 900)


def main(out, *names):
    for take in [globals()[name] for name in names] or [steps, bend, preview, result, fit]:
        with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
            def window(*meshes):
                opened = Window(Path(folder), *meshes)
                stack.callback(opened.close)
                return opened

            take(host_edit_fit.open_two(window, Path(folder))[0] if take is fit else window(cactus(Path(folder))), Path(out))


if __name__ == "__main__":
    main(*sys.argv[1:])
