# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes in which a promise can break; one line each, with a figure and 'holds' or 'BROKEN'. Distances are in % of the
diagonal of the part that deforms.

    build/venv/bin/python tests/promises.py PLUGIN.so
"""
import os
import sys
import tempfile
import numpy as np
import pymeshlab

DEFORM = 'generate_fcd_deformed_mesh'
broken = 0


def rotation(axis, degrees, about=(0, 0, 0)):
    a = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    t = np.radians(degrees)
    m = np.eye(4)
    m[:3, :3] += np.sin(t) * k + (1 - np.cos(t)) * k @ k
    m[:3, 3] = about - m[:3, :3] @ np.asarray(about, float)
    return m


def text(tag, m):
    return '%d: matrix %s' % (tag, ' '.join('%.17g' % x for x in m.ravel()))


def deform(v, f, tag, normals=None, matrix=None, **parameters):
    ms = pymeshlab.MeshSet(verbose=False)
    args = dict(vertex_matrix=v, v_scalar_array=tag.astype(float))
    if f is not None:
        args['face_matrix'] = f
    if normals is not None:
        args['v_normals_matrix'] = normals
    ms.add_mesh(pymeshlab.Mesh(**args))
    if matrix is not None:
        ms.apply_filter('set_matrix', transformmatrix=matrix, freeze=False)
    r = ms.apply_filter(DEFORM, graph_layers=False, **parameters)
    m = ms.current_mesh()  # lives as long as its MeshSet
    return m.vertex_matrix(), m.vertex_normal_matrix()


def say(what, figure, holds):
    global broken
    broken += not holds
    print('%-96s %s   %s' % (what, figure, 'holds' if holds else 'BROKEN'), flush=True)


def sheet(n):
    x, y = (a.ravel().astype(float) for a in np.meshgrid(np.arange(n), np.arange(n), indexing='ij'))
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    return np.column_stack([x, y, 0 * x]), np.vstack([np.column_stack([a, a + n, a + 1]), np.column_stack([a + 1, a + n, a + n + 1])])


def sphere(n, rings):
    u, w = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.linspace(.02, np.pi - .02, rings), indexing='ij')
    p = np.column_stack([(np.sin(w) * np.cos(u)).ravel(), (np.sin(w) * np.sin(u)).ravel(), np.cos(w).ravel()])
    i = (np.arange(n)[:, None] * rings + np.arange(rings - 1)).ravel()
    j = (((np.arange(n) + 1) % n)[:, None] * rings + np.arange(rings - 1)).ravel()
    return p, np.vstack([np.column_stack([i, i + 1, j]), np.column_stack([j, i + 1, j + 1])])


def read(stem):
    ms = pymeshlab.MeshSet(verbose=False)
    ms.load_new_mesh(stem + '.ply')
    mesh = ms.current_mesh()
    return mesh.vertex_matrix(), mesh.face_matrix(), np.loadtxt(stem + '.sel').astype(int)


def main():
    stem = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, 'meshes', 'cylinder')
    v, f, tag = read(stem)
    n, diagonal = len(v), np.linalg.norm(np.ptp(v, axis=0))
    files = dict(transform_file=stem + '.def')
    plain = deform(v, f, tag, **files)[0]

    def away(points, reference=plain):
        return 100 * np.linalg.norm(points - reference, axis=1).max() / diagonal

    # What lies elsewhere.
    for side in (10, 1000):
        t = np.array([[50., 0, 0], [50 + side, 0, 0], [50, side, 0]])
        m, _ = deform(np.vstack([v, t]), np.vstack([f, [[n, n + 1, n + 2]]]), np.r_[tag, [-1, -1, -1]], **files)
        e = away(m[:n])
        say('a triangle of side %d outside the region of influence, far away' % side, 'shape changes by %.3g %%' % e, e == 0)
    for far in (1e3, 1e6):
        for t in (-1, 1):
            m, _ = deform(np.vstack([v, [[far * diagonal] * 3]]), f, np.r_[tag, [t]], **files)
            e = away(m[:n])
            say('one stray vertex %g diagonals away, %s' % (far, 'outside' if t < 0 else 'free'), 'shape changes by %.3g %%' % e, e <= .01)
    m, _ = deform(np.vstack([v, np.random.default_rng(1).uniform(-1, 1, (100000, 3)) * 2 * diagonal]), f, np.r_[tag, np.full(100000, 1)], **files)
    e = away(m[:n])
    say('100 000 isolated vertices around it', 'shape changes by %.3g %%' % e, e <= .01)

    # No motion moves nothing.
    s, g = sheet(300)
    base = np.where(s[:, 0] < 40, 0, np.where(s[:, 0] > 250, 2, 1))
    lone = base.copy()
    lone[40 * 300 + 150] = 2
    points = os.path.join(tempfile.gettempdir(), 'promises_%d.csv' % os.getpid())
    open(points, 'w').write('%d,40,150,0\n' % (40 * 300 + 150))
    for what, t, more in (('a sheet', base, {}), ('a sheet with one handle vertex beside the fixed border', lone, {}),
                          ('a sheet with a point handle beside the fixed border', base, dict(point_handles_file=points)), ('a sheet, smoothness 0', base, dict(smoothness=0.))):
        m, _ = deform(s, g, t, **more)
        e = 100 * np.linalg.norm(m - s, axis=1).max() / np.linalg.norm(np.ptp(s, axis=0))
        say('no motion: ' + what, 'moves by %.3g %%' % e, e < 1e-6)
    rng = np.random.default_rng(3)
    balls = np.ones(n, int)
    for t, count in ((0, 12), (2, 12)):
        for c in rng.choice(n, count, replace=False):
            balls[np.linalg.norm(v - v[c], axis=1) < .25 * rng.uniform(.5, 3)] = t
    for more in ({}, dict(smoothness=0.)):
        m, _ = deform(v, f, balls, **more)
        e = away(m, v)
        say('no motion: cylinder with fixed and handle balls at random %s' % (more or ''), 'moves by %.3g %%' % e, e < 1e-6)

    # One rigid motion of all handles, in layers with a matrix.
    both = np.where(tag == 0, 3, tag)
    for what, matrix in (('similarity', 2 * np.eye(4)), ('mirror', np.diag([-1., 1, 1, 1])), ('scale 1.1 1 1', np.diag([1.1, 1, 1, 1])), ('scale 3 1 1', np.diag([3., 1, 1, 1])),
                         ('shear', np.array([[1., .5, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]))):
        matrix = matrix.copy()
        matrix[3, 3] = 1
        world = v @ matrix[:3, :3].T
        motion = rotation((0, 1, 1), 70, world.mean(0))
        m, _ = deform(v, f, both, matrix=matrix, transforms=text(2, motion) + '; ' + text(3, motion))
        got = m @ matrix[:3, :3].T
        e = 100 * np.linalg.norm(got - (world @ motion[:3, :3].T + motion[:3, 3]), axis=1).max() / np.linalg.norm(np.ptp(world, axis=0))
        say('both handles turned alike, layer matrix: ' + what, 'off by %.3g %%' % e, e < .01)
        bend = rotation((0, 1, 0), 60, world[tag == 2].mean(0))
        m, _ = deform(v, f, tag, matrix=matrix, transforms=text(2, bend))
        frozen, _ = deform(world, f if np.linalg.det(matrix[:3, :3]) > 0 else f[:, ::-1], tag, transforms=text(2, bend))
        e = 100 * np.linalg.norm(m @ matrix[:3, :3].T - frozen, axis=1).max() / diagonal
        say('bent, layer matrix %s against the frozen layer' % what, 'off by %.3g %%' % e, e < .5)

    # A cloud's normals turn with it.
    p, q = sphere(80, 60)
    half = np.where(p[:, 2] > 0, 2, 1)
    x, k = deform(p, None, half, normals=p, transforms=text(2, rotation((0, 1, 0), 120)))
    e = np.degrees(np.arccos(np.clip((x * k).sum(1) / np.linalg.norm(x, axis=1) / np.maximum(np.linalg.norm(k, axis=1), 1e-30), -1, 1)))
    say('a cloud (sphere) turned by 120 degrees as a whole: its normals', 'median %.1f, largest %.1f degrees wrong' % (np.median(e), e.max()), e.max() < 1)

    # Strain spreads evenly over a pulled or pushed sheet.
    s, g = sheet(150)
    s = s / 149
    t = np.where(s[:, 0] < .1, 0, np.where(s[:, 0] > .9, 2, 1))
    for to, allowed in ((3., .15), (1.5, .1), (.7, .1), (.4, .3)):
        m, _ = deform(s, g, t, transforms='2: translate %g 0 0' % (.8 * (to - 1)))
        row = m.reshape(150, 150, 3)[:, 75]
        free = (s.reshape(150, 150, 3)[:-1, 75, 0] > .1) & (s.reshape(150, 150, 3)[1:, 75, 0] < .9)
        ratio = np.linalg.norm(np.diff(row, axis=0), axis=1)[free] * 149
        a, b = m[g], s[g]
        flipped = int((np.cross(a[:, 1] - a[:, 0], a[:, 2] - a[:, 0])[:, 2] * np.cross(b[:, 1] - b[:, 0], b[:, 2] - b[:, 0])[:, 2] < 0).sum())
        say('a sheet pulled to %.1f of its free length: edges along its middle' % to, 'ratio %.2f to %.2f, %d triangles flipped' % (ratio.min(), ratio.max(), flipped),
            max(ratio.max() / to, to / ratio.min()) < 1 + allowed and flipped == 0)

    # Saving loses nothing.
    ms = pymeshlab.MeshSet(verbose=False)
    ms.add_mesh(pymeshlab.Mesh(vertex_matrix=v, face_matrix=f, v_scalar_array=tag.astype(float)))
    with tempfile.TemporaryDirectory() as folder:
        sel, deff = os.path.join(folder, 'a.sel'), os.path.join(folder, 'none', 'a.def')
        open(sel, 'w').write('old\n')
        try:
            ms.apply_filter('save_fcd_tags', tag_file=sel, transform_file=deff)
            failed = False
        except pymeshlab.PyMeshLabException:
            failed = True
        say('save tags where the second file cannot be written: the first is as it was', 'error' if failed else 'no error', failed and open(sel).read() == 'old\n')
        os.symlink(sel, os.path.join(folder, 'b.def'))
        try:
            ms.apply_filter('save_fcd_tags', tag_file=sel, transform_file=os.path.join(folder, 'b.def'))
            failed = False
        except pymeshlab.PyMeshLabException:
            failed = True
        say('save tags and motions to one file through a link', 'error' if failed else 'no error', failed and open(sel).read() == 'old\n')
    print('%d broken' % broken)
    return broken > 0


if __name__ == '__main__':
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    pymeshlab.load_plugin(sys.argv[1])
    sys.exit(main())
