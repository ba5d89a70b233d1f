# SPDX-License-Identifier: GPL-3.0-or-later
"""Fast centroidal deformation of meshes and point clouds, for PyMeshLab and numpy.

On import, the filters of the plugin become methods of pymeshlab.MeshSet (where pymeshlab is one of VERSIONS). Deformation
needs no pymeshlab.
"""
from ._deform import deform, deform_layer, deformation
from ._deformation import Deformation
from ._plugin import VERSIONS

__all__ = ["Deformation", "VERSIONS", "deform", "deform_layer", "deformation"]
