# SPDX-License-Identifier: GPL-3.0-or-later
"""Fast centroidal deformation of meshes and point clouds, on numpy's arrays.

Nothing but numpy is imported. Where the filters for pymeshlab are installed, `enable_pymeshlab` makes them methods of its MeshSet.
"""
from ._compensate import Compensated, CompensationInfo, compensate
from ._core import __version__
from ._contact import Contact
from ._curves import Curve, read_curves
from ._deform import deform, deformation
from ._deformation import Deformation
from ._deformer import Deformer, Graph, SurfaceInfo, Transforms, Weights
from ._grid import DisplacementGrid
from ._fit import FitInfo, FitStart, Fitted, Fitter, fit
from ._meshes import MeshLike
from ._look import Companion, Look
from ._meshlab import VERSIONS, deform_layer, enable_pymeshlab
from ._motion import Motion
from ._pose import Pose, PoseInfo
from ._progress import Progress
from ._sequence import AnimationInfo, FrameContact, KeyFrame, PoseSequence
from ._straighten import LineInfo, Straightened, straighten
from ._symmetrize import OtherSide, Symmetrized, SymmetryInfo, symmetrize
from ._warnings import (AccuracyWarning, CompensationWarning, ContactWarning, DeformationWarning, FoldWarning, LandmarkWarning, LineWarning, MatchWarning,
                        NodeWarning, NotAtRestWarning, NothingMovesWarning, OverruledWarning, RigidWarning, ScanLineWarning, SlitWarning, SpaceWarning, StretchWarning,
                        SymmetryWarning, VolumeWarning)

__all__ = ["AccuracyWarning", "AnimationInfo", "Companion", "Compensated", "CompensationInfo", "CompensationWarning", "Contact", "ContactWarning", "Curve", "Deformation",
           "DeformationWarning", "Deformer", "DisplacementGrid", "FitInfo", "FitStart", "Fitted", "Fitter",
           "FoldWarning", "FrameContact", "Graph", "KeyFrame", "LandmarkWarning", "LineInfo", "LineWarning", "Look", "MatchWarning", "MeshLike", "Motion",
           "NodeWarning", "NotAtRestWarning", "NothingMovesWarning", "OtherSide", "OverruledWarning", "Pose", "PoseInfo", "PoseSequence", "Progress", "RigidWarning",
           "ScanLineWarning", "SlitWarning", "SpaceWarning", "Straightened", "StretchWarning", "SurfaceInfo", "Symmetrized", "SymmetryInfo", "SymmetryWarning", "Transforms", "VERSIONS", "VolumeWarning", "Weights",
           "__version__", "compensate", "deform", "deform_layer", "deformation", "enable_pymeshlab", "fit", "read_curves", "straighten", "symmetrize"]
