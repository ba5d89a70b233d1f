// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MOVING_REGION_H
#define VCG_FCD_MOVING_REGION_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/graph/held_nodes.h>
#include <vcg_ext/map/graph_mapping.h>
#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/solve/graph_pose.h>
#include <vcg_ext/surface/surface_graph.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// The way on which a pose was reached.
struct PoseWay {
    int steps = 1;         ///< each from the one before
    bool jumps = false;    ///< whether the shape jumps on it to another one, instead of growing
    bool unstable = false; ///< whether it was found that it would give way at its end, left to itself
};

/// One pose of a region.
struct RegionPose {
    HeldMotions given;                       ///< of what holds it, with its single nodes
    GraphPose solved;                        ///< of the graph
    GraphPose graph;                         ///< the same with linear maps (FitLinear; rotations as printed)
    std::vector<Eigen::Affine3d> nodeMotion; ///< k, of constrained nodes, frame units
    /// Of every tag but 1, frame units; of single nodes that turn as the surface around them does, that.
    std::map<Index, Eigen::Affine3d> motion;
    int iterations = 0; ///< of the solver, with those of the poses on the way
    PoseWay way;
    double volumeOff = 0; ///< share of its volume that a part is off which was to keep it, the largest

    bool Moves() const { return given.Moves() || solved.moves; }
};

/// A region: a connected part of the free surface with what holds it, its deformation graph, and how its vertices
/// follow the graph. Nothing in it depends on what lies outside of it.
struct MovingRegion {
    /// A vertex slot and the node of the surface that it is at.
    struct Bent {
        std::uint32_t slot;
        Index node;
    };

    SurfaceGraph surface; ///< with slots of the whole mesh, but without SurfaceGraph::nodeOf
    HeldNodes held;
    Patches patches;
    DeformationGraph graph;
    MappingWeights weights = MappingWeights::Surface;
    std::unique_ptr<GraphMapping> mapping;
    std::vector<Bent> bent;    ///< the free vertices, those of one patch beside each other
    std::vector<Bent> beside;  ///< the held ones
    const std::uint32_t first; ///< the smallest slot of a free one

    MovingRegion(SurfaceGraph surface, HeldNodes held, std::uint32_t first = 0)
        : surface(std::move(surface)), held(std::move(held)), first(first) {}
    MovingRegion(const MovingRegion &) = delete; // its parts refer to each other
    MovingRegion &operator=(const MovingRegion &) = delete;

    bool IsFree(Index node) const { return held.tag[std::size_t(node)] == 1; }

  protected:
    /// Sets bent and beside. \param nodeOf of each of surface.slots' slots
    void ListVertices(const std::vector<Index> &nodeOf, const Progress &progress);
};

} // namespace vcg::fcd

#endif
