// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_PARAM_H
#define VCG_FCD_DEFORMATION_PARAM_H

#include "deformation_graph.h"
#include "graph_deformer.h"
#include "mapping_candidates.h"
#include "seams.h"
#include "shape_constants.h"

namespace vcg {
namespace fcd {

/// By what the patches are balanced.
enum class PatchMeasure {
    Area,    ///< of the surface, however densely it is sampled
    Vertices ///< their number (paper, Eq. 1)
};

/// How the deformation graph is built.
struct GraphParam {
    double targetRadius = 0;  ///< D, mesh units, >= 0; 0 = 0.75 sqrt(area / initialPatches), of the area that can bend
    int initialPatches = 300; ///< k0, >= 1
    int maxIterations = 100;  ///< >= 1
    double tolerance = 1e-3;  ///< of the cost, [0, 1)
    unsigned randomSeed = 1;
    PatchMeasure measure = PatchMeasure::Area;

    /// \throw Error naming the value that is out of range
    void Validate() const {
        if (!(targetRadius >= 0) || std::isinf(targetRadius))
            throw Error("The target radius must be 0 (automatic) or a positive, finite length.");
        if (initialPatches < 1)
            throw Error("The number of initial patches must be at least 1.");
        if (maxIterations < 1)
            throw Error("The maximum number of iterations must be at least 1.");
        if (!(tolerance >= 0 && tolerance < 1))
            throw Error("The tolerance of the patches must be at least 0 and below 1.");
    }
};

/// Which motion the components of the mesh without a handle or fixed vertex make.
enum class LooseParts {
    Follow, ///< that of the nearest part of the surface that is held
    Stay    ///< none
};

/// How a mesh is prepared to be deformed.
struct DeformerParam {
    GraphParam graph;
    Eigen::Matrix3Xd nodes; ///< 3 x k, mesh units: centres of patches to use instead of sampling; empty = sample
    GraphWeights graphWeights = GraphWeights::Border;
    MappingWeights weights = MappingWeights::Surface;
    double influence = 4; ///< node radius over patch radius, > 1
    LooseParts looseParts = LooseParts::Follow;
    double weldDistance = defaultWeldDistance; ///< of vertices on open borders, as BuildSurfaceGraph takes it
    ShapeConstants shape;
};

/// How a mesh is deformed.
struct DeformationParam : DeformerParam, SolverParam {
    double pose = 100;    ///< percent of the handles' motion
    int steps = 1;        ///< >= 1; the pose is reached over so many, each solved from the one before
    bool measure = false; ///< also measure stretch and rotation of the surface
    bool linear = false;  ///< also give the linear map of the surface around each vertex

    /// \throw Error naming the value that is out of range
    void Validate() const {
        graph.Validate();
        if (!(smoothness >= 0) || std::isinf(smoothness))
            throw Error("The smoothness must be a finite number, 0 or more; useful are 0.001 to 0.1.");
        if (maxIterations < 1)
            throw Error("The maximum number of iterations must be at least 1.");
        if (!(tolerance > 0) || std::isinf(tolerance))
            throw Error("The tolerance must be a positive, finite number.");
        if (!(influence > 1) || std::isinf(influence))
            throw Error("The influence must be a finite number above 1: each node has to reach beyond its own patch.");
        if (!std::isfinite(pose))
            throw Error("The pose must be a finite number of percent.");
        if (steps < 1 || steps > 1000)
            throw Error("The pose can be reached in 1 to 1000 steps.");
        if (!(weldDistance >= 0 && float(weldDistance) <= 1e-3f)) // hosts give it in single precision
            throw Error("The weld distance must be from 0 to 0.001 (of the bounding box diagonal).");
    }
};

} // namespace fcd
} // namespace vcg

#endif
