# SPDX-License-Identifier: GPL-3.0-or-later
"""Fast centroidal deformation of meshes and point clouds, on numpy's arrays.

Where the extra `meshlab` is installed, the filters of the plugin become methods of pymeshlab.MeshSet on import; nothing else needs
pymeshlab.
"""
from ._deform import deform, deformation
from ._deformation import Deformation
from ._deformer import Deformer, Graph, Transforms, SurfaceInfo, Weights
from ._fit import FitInfo, Fitted, Fitter, FitStart, fit
from ._meshlab import VERSIONS, deform_layer
from ._motion import Motion
from ._pose import DeformationWarning, Pose, PoseInfo
from ._progress import Progress
from ._sequence import AnimationInfo, KeyFrame, PoseSequence
from ._straighten import LineInfo, Straightened, straighten

__all__ = ["AnimationInfo", "Deformation", "DeformationWarning", "Deformer", "FitInfo", "FitStart", "Fitted", "Fitter", "Graph",
           "KeyFrame", "LineInfo", "Motion", "Pose", "PoseInfo", "PoseSequence", "Progress", "Straightened", "SurfaceInfo", "Transforms",
           "VERSIONS", "Weights", "deform", "deform_layer", "deformation", "fit", "straighten"]
