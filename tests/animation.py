#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A loop over the parameter "pose": the demo's bunny looks aside and back, as an animated GIF.

  build/venv/bin/python tests/animation.py docs/pictures/bunny.gif
"""
import sys
import tempfile
from pathlib import Path

import numpy as np
import pymeshlab
from PIL import Image

import demo
import render

FRAMES, SIZE, COLUMNS = 16, 360, 4


def main(out):
    pymeshlab.load_plugin(str(demo.PLUGIN))
    ms = pymeshlab.MeshSet(verbose=False)
    ms.load_new_mesh(str(demo.SAMPLES / demo.BUNNY["sample"]))
    ms.apply_filter("compute_scalar_by_function_per_vertex", q=demo.BUNNY["tags"])
    motion = demo.python_arguments(demo.DEFORM_PARAMETERS, demo.BUNNY["motion"])
    panels = []
    for frame in range(FRAMES):
        pose = 130 * (1 - np.cos(np.pi * frame / (FRAMES - 1))) / 2  # begins and ends gently, and goes on beyond 100
        ms.set_current_mesh(0)
        ms.apply_filter("generate_fcd_deformed_mesh", pose=float(pose), graph_layers=False, **motion)
        panels.append(render.Panel(render.Surface.of_layer(ms.current_mesh())))
        ms.delete_current_mesh()
    centre = (panels[0].surface.vertices.min(0) + panels[0].surface.vertices.max(0)) / 2
    with tempfile.TemporaryDirectory() as folder:
        sheet = Path(folder) / "sheet.png"
        render.render(sheet, panels, view=demo.BUNNY["view"], up=demo.BUNNY["up"], focus=centre, columns=COLUMNS,
                      size=(SIZE, SIZE))
        pixels = Image.open(sheet).convert("L").quantize(24)
        corners = [(SIZE * (i % COLUMNS), SIZE * (i // COLUMNS)) for i in range(FRAMES)]
        images = [pixels.crop((x, y, x + SIZE, y + SIZE)) for x, y in corners]
    images += images[-2:0:-1]
    images[0].save(out, save_all=True, append_images=images[1:], duration=60, loop=0, optimize=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
