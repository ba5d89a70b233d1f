import numpy as np
import pymeshlab_fcd
from pymeshlab_fcd import Motion

data = open('meshes/cylinder.ply', 'rb').read()           # any reader of meshes will do
body = data.index(b'end_header\n') + 11
vertices = np.frombuffer(data, '<f4', 3 * 1986, body).reshape(-1, 3)
faces = np.frombuffer(data, [('corners', 'u1'), ('vertex', '<i4', 3)], 3968, body + 12 * 1986)['vertex']
tags = np.loadtxt('meshes/cylinder.sel', dtype=int)
motion = Motion.rotate([0, 1, 0], 90, about=[0, 0, 12]).then(Motion.translate([4, 0, -3]))

positions = pymeshlab_fcd.deform(vertices, faces, tags, {2: motion})
np.save('bent_numpy.npy', positions)
