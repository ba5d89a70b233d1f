#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders meshes side by side into one PNG, without a display.

Each panel is FILE[:MODE[=FILE2]][@TITLE]. FILE is anything MeshLab opens. The modes:
  plain              grey, smooth-lit (default)
  color              the colours of the vertices
  quality            the quality of the vertices, on a colour scale
  tags, tags=F.sel   handle tags from the quality, or from a file: 0 fixed blue, 1 free yellow, 2 up handle red, negative grey
  graph, graph=MESH  the vertices as balls and the edges as lines, MESH as a ghost around it
  bend=REST          faces by the largest change of the dihedral angle at their edges against the mesh REST, which has the
                     same faces: ripples and creases stand out. The percentiles are printed.

All panels share the view direction and the scale; each is centred on its own content.

  render.py out.png --view 1,-2,0.5 rest.ply:tags@input result.ply@result result.ply:bend=rest.ply@bend
  render.py detail.png --zoom 6 --focus 1234 rest.ply result.ply      (a close-up of vertex 1234 in each panel)
"""
import argparse
import os
import sys
from dataclasses import dataclass, field

os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")  # needs no display

import numpy as np  # noqa: E402
import pymeshlab  # noqa: E402
import pyvista as pv  # noqa: E402

GREY = "#c9c5bd"
TAG_COLORS = {"fixed": "#3b6fc9", "free": "#f0c53c", "handle": "#d23c32", "outside": "#9a9a9a"}


@dataclass
class Surface:
    """Arrays of a layer: vertices n x 3, faces m x 3, edges e x 2, colours n x 4 in 0..1, quality n."""

    vertices: np.ndarray
    faces: np.ndarray = field(default_factory=lambda: np.zeros((0, 3), np.int64))
    edges: np.ndarray = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    color: np.ndarray = None
    quality: np.ndarray = None

    @staticmethod
    def of_layer(mesh):
        return Surface(
            mesh.vertex_matrix(),
            mesh.face_matrix().astype(np.int64),
            mesh.edge_matrix().astype(np.int64),
            mesh.vertex_color_matrix() if mesh.has_vertex_color() else None,
            mesh.vertex_scalar_array() if mesh.has_vertex_scalar() else None,
        )

    @staticmethod
    def load(path):
        ms = pymeshlab.MeshSet(verbose=False)
        ms.load_new_mesh(os.path.abspath(path))
        return Surface.of_layer(ms.current_mesh())

    def normals(self):
        """Normals of the vertices, n x 3; faces weigh by their area."""
        v, f = self.vertices, self.faces
        n = np.cross(v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]])
        sums = [np.bincount(f.ravel(), np.repeat(n[:, k], 3), len(v)) for k in range(3)]
        total = np.stack(sums, 1)
        return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)


@dataclass
class Panel:
    surface: Surface
    mode: str = "plain"
    title: str = ""
    tags: np.ndarray = None  # for "tags"; the quality if None
    rest: Surface = None  # for "bend"
    ghost: Surface = None  # for "graph"


def interior_edges(faces):
    """The edges with two faces: their ends a and b (in the order of the first face) and the faces, four arrays."""
    ends = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    face = np.tile(np.arange(len(faces)), 3)
    low, high = ends.min(1), ends.max(1)
    key = low * (faces.max() + 1) + high
    order = np.argsort(key, kind="stable")
    key = key[order]
    start = np.flatnonzero(np.r_[True, key[1:] != key[:-1]])
    pair = start[np.diff(np.r_[start, len(key)]) == 2]
    first, second = order[pair], order[pair + 1]
    return ends[first, 0], ends[first, 1], face[first], face[second]


def dihedral_angles(vertices, faces, edges):
    """Signed angles between the normals at the edges, degrees: 0 flat, positive and negative for the two ways to fold."""
    a, b, left, right = edges
    normal = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    axis = vertices[b] - vertices[a]
    axis /= np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-300)
    n, m = normal[left], normal[right]
    sine = np.einsum("ij,ij->i", np.cross(n, m), axis)
    return np.degrees(np.arctan2(sine, np.einsum("ij,ij->i", n, m)))


def bend(rest, result):
    """Change of the dihedral angles from rest to result: per face the largest at its edges [m], and per edge [e]; degrees."""
    if rest.faces.shape != result.faces.shape or (rest.faces != result.faces).any():
        raise SystemExit("bend: the two meshes have different faces")
    edges = interior_edges(rest.faces)
    change = dihedral_angles(result.vertices, rest.faces, edges) - dihedral_angles(rest.vertices, rest.faces, edges)
    change = np.abs((change + 180) % 360 - 180)
    of_face = np.zeros(len(rest.faces))
    np.maximum.at(of_face, edges[2], change)
    np.maximum.at(of_face, edges[3], change)
    return of_face, change


def poly_data(surface):
    """The faces, or the vertices if there are none, as PyVista sees them."""
    if not len(surface.faces):
        return pv.PolyData(surface.vertices)
    mesh = pv.PolyData.from_regular_faces(surface.vertices.astype(np.float32), surface.faces)
    mesh.point_data.active_normals = surface.normals().astype(np.float32)
    return mesh


def tag_colors(tags):
    rgb = {name: np.array(pv.Color(c).int_rgb, np.uint8) for name, c in TAG_COLORS.items()}
    colors = np.empty((len(tags), 3), np.uint8)
    colors[tags < 0], colors[tags == 0], colors[tags == 1] = rgb["outside"], rgb["fixed"], rgb["free"]
    colors[tags >= 2] = rgb["handle"]
    return colors


def face_colors(surface, colors):
    """The colour of each face: that of its corner with the largest weight, so that regions do not run into one another."""
    f = surface.faces
    same = (colors[f[:, 1]] == colors[f[:, 2]]).all(1)
    return colors[np.where(same, f[:, 1], f[:, 0])]


def add_surface(plotter, surface, show_edges=False, **look):
    """Adds the faces, smooth-lit, or the points. Keywords as of pyvista.Plotter.add_mesh."""
    look = dict(color=GREY, specular=0.25, specular_power=20, ambient=0.06) | look
    actor = plotter.add_mesh(poly_data(surface), show_edges=show_edges, edge_color="#404040", line_width=1, **look)
    actor.prop.interpolation = "Phong"
    return actor


def add_graph(plotter, graph, diagonal):
    if len(graph.edges):
        lines = np.hstack([np.full((len(graph.edges), 1), 2), graph.edges])
        tubes = pv.PolyData(graph.vertices, lines=lines.ravel()).tube(radius=diagonal * 0.0012, n_sides=6)
        plotter.add_mesh(tubes, color="#404a58")
    nodes = pv.PolyData(graph.vertices)
    if graph.color is not None:
        nodes["rgb"] = (graph.color[:, :3] * 255).astype(np.uint8)
    balls = nodes.glyph(geom=pv.Sphere(radius=diagonal * 0.005, theta_resolution=12, phi_resolution=12), scale=False,
                        orient=False)
    if graph.color is not None:
        plotter.add_mesh(balls, scalars="rgb", rgb=True)
    else:
        plotter.add_mesh(balls, color=TAG_COLORS["handle"])


def add_panel(plotter, panel, limit, show_edges, scalar_title):
    surface, mode = panel.surface, panel.mode
    bar = dict(title=scalar_title, vertical=False, title_font_size=16, label_font_size=14, n_labels=2, width=0.5, height=0.1,
               position_x=0.25, position_y=0.01, fmt="%.3g", color="black")
    if mode in ("tags", "color"):
        if mode == "tags":
            tags = panel.tags if panel.tags is not None else surface.quality
            if tags is None or len(tags) != len(surface.vertices):
                raise SystemExit(f"{panel.title or 'tags'}: there must be one tag per vertex")
            colors = tag_colors(np.asarray(tags))
        else:
            if surface.color is None:
                raise SystemExit(f"{panel.title or 'color'}: the mesh has no vertex colours")
            colors = (surface.color[:, :3] * 255).astype(np.uint8)
        add_surface(plotter, surface, show_edges, color=None, rgb=True, copy_mesh=False,
                    scalars=face_colors(surface, colors) if len(surface.faces) else colors)
    elif mode == "quality":
        if surface.quality is None:
            raise SystemExit(f"{panel.title or 'quality'}: the mesh has no vertex quality")
        add_surface(plotter, surface, show_edges, color=None, scalars=surface.quality, cmap="viridis",
                    clim=(0, limit) if limit else None, scalar_bar_args=bar)
    elif mode == "bend":
        of_face, of_edge = bend(panel.rest, surface)
        p50, p99 = np.percentile(of_edge, [50, 99])
        print(f"{panel.title or 'bend'}: change of dihedral angle, degrees: median {p50:.2f}, 99 % {p99:.2f}, "
              f"largest {of_edge.max():.1f}")
        limit = limit or max(np.percentile(of_edge, 99.5), 1e-3)
        add_surface(plotter, surface, show_edges, color=None, scalars=of_face, cmap="inferno", clim=(0, limit),
                    scalar_bar_args=bar)
    elif mode == "graph":
        box = (panel.ghost or surface).vertices
        if panel.ghost is not None:
            add_surface(plotter, panel.ghost, opacity=0.18, specular=0)
        add_graph(plotter, surface, np.linalg.norm(np.ptp(box, axis=0)))
    elif mode == "plain":
        add_surface(plotter, surface, show_edges)
    else:
        raise SystemExit(f"unknown mode {mode}")
    if panel.title:
        plotter.add_text(panel.title, position="upper_edge", font_size=11, color="black")


def render(path, panels, title="", view=(1, -2, 0.7), up=(0, 0, 1), zoom=1.0, focus=None, columns=None, size=(560, 560),
           limit=None, show_edges=False):
    """Renders the panels into one PNG. focus: a point, or the number of a vertex, that is to be in the middle."""
    columns = columns or len(panels)
    rows = -(-len(panels) // columns)
    plotter = pv.Plotter(off_screen=True, shape=(rows, columns), border=False,
                         window_size=(size[0] * columns, size[1] * rows))
    plotter.set_background("white", all_renderers=True)
    back = np.asarray(view, float) / np.linalg.norm(view)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    frame = np.stack([right, np.cross(back, right), back])  # rows: right, up, towards the viewer

    boxes = []
    for panel in panels:
        shown = (panel.ghost or panel.surface).vertices @ frame.T
        used = (panel.ghost or panel.surface).faces
        shown = shown[np.unique(used)] if len(used) else shown  # vertices without a face are not seen
        boxes.append((shown.min(0), shown.max(0)))
    widest = max((b - a)[0] for a, b in boxes)
    highest = max((b - a)[1] for a, b in boxes)
    depth = max((b - a).max() for a, b in boxes)
    margin = 1.4 if any(panel.mode in ("quality", "bend") for panel in panels) else 1.22  # for titles and colour bars
    scale = 0.5 * max(highest, widest * size[1] / size[0]) * margin / zoom

    for k, (panel, box) in enumerate(zip(panels, boxes)):
        plotter.subplot(k // columns, k % columns)
        unit = {"bend": "bend, degrees"}.get(panel.mode, panel.mode)
        add_panel(plotter, panel, limit, show_edges, unit + " " * k)  # PyVista tells colour bars apart by their titles
        if focus is None:
            centre = frame.T @ ((box[0] + box[1]) / 2)
        elif np.ndim(focus) == 0:
            centre = panel.surface.vertices[int(focus)]
        else:
            centre = np.asarray(focus, float)
        camera = plotter.camera
        camera.focal_point, camera.up = centre, frame[1]
        camera.position = centre + back * depth * 4
        camera.enable_parallel_projection()
        camera.parallel_scale = scale
        plotter.renderer.reset_camera_clipping_range()
    if title:
        plotter.subplot(0, 0)
        plotter.add_text(title, position="lower_left", font_size=9, color="#505050")
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(str(path))
    plotter.close()


def read_tags(path):
    with open(path) as file:
        return np.array([int(line) for line in file if line.strip() and not line.startswith("#")])


def parse_panel(text):
    text, _, title = text.partition("@")
    path, _, mode = text.partition(":")
    mode, _, other = mode.partition("=")
    panel = Panel(Surface.load(path), mode or "plain", title or os.path.basename(path))
    if panel.mode == "tags" and other:
        panel.tags = read_tags(other)
    elif panel.mode == "bend":
        if not other:
            raise SystemExit(f"{text}: which mesh is the rest? Write FILE:bend=REST")
        panel.rest = Surface.load(other)
    elif panel.mode == "graph" and other:
        panel.ghost = Surface.load(other)
    return panel


def main():
    numbers = lambda text: tuple(float(x) for x in text.split(","))  # noqa: E731
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", help="PNG to write")
    parser.add_argument("panels", nargs="+", metavar="PANEL", help="FILE[:MODE[=FILE2]][@TITLE]")
    parser.add_argument("--title", default="", help="line at the bottom")
    parser.add_argument("--view", type=numbers, default=(1, -2, 0.7), metavar="X,Y,Z",
                        help="where the viewer stands, seen from the mesh (--view=-1,... if negative)")
    parser.add_argument("--up", type=numbers, default=(0, 0, 1), metavar="X,Y,Z")
    parser.add_argument("--zoom", type=float, default=1)
    parser.add_argument("--focus", type=numbers, metavar="X,Y,Z or VERTEX", help="what is in the middle")
    parser.add_argument("--bend", metavar="REST", help="show all panels in mode bend against this mesh")
    parser.add_argument("--limit", type=float, help="upper end of the colour scale of bend, degrees, or of quality, which begins at 0 then")
    parser.add_argument("--columns", type=int)
    parser.add_argument("--size", type=lambda t: tuple(int(x) for x in t.split("x")), default=(560, 560), metavar="WxH",
                        help="of one panel")
    parser.add_argument("--edges", action="store_true", help="draw the edges of the faces")
    args = parser.parse_args()
    panels = [parse_panel(text) for text in args.panels]
    if args.bend:
        rest = Surface.load(args.bend)
        for panel in panels:
            panel.mode, panel.rest = "bend", rest
    focus = args.focus[0] if args.focus and len(args.focus) == 1 else args.focus
    render(args.out, panels, args.title, args.view, args.up, args.zoom, focus, args.columns, args.size, args.limit,
           args.edges)


if __name__ == "__main__":
    sys.exit(main())
