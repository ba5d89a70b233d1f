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

/// How a pose was reached.
struct PosePath {
    int steps = 1;         ///< number of poses that were solved, each from the one before; this pose is the last
    bool jumps = false;    ///< the shape jumps to another one on the way, instead of changing continuously
    bool unstable = false; ///< the pose is a saddle of the energy: a small push would make it buckle
};

/// One pose of a region.
struct RegionPose {
    HeldMotions given;                       ///< motions of what holds it, with its single nodes
    GraphPose solved;                        ///< of the graph, as solved
    GraphPose graph;                         ///< the same with linear maps (FitLinear; rotations as printed)
    std::vector<Eigen::Affine3d> nodeMotion; ///< k, of constrained nodes, frame units
    /// Of every tag but 1, frame units. Single nodes that only move turn as the surface around them.
    std::map<Index, Eigen::Affine3d> motion;
    int iterations = 0; ///< of the solver, for all steps
    PosePath path;
    double volumeOff = 0; ///< largest error of a volume that should be kept, over that volume

    bool Moves() const { return given.Moves() || solved.moves; }
};

/// A region: a connected part of the free surface with what holds it, its deformation graph, and the mapping to its
/// vertices. Nothing in it depends on other regions.
struct MovingRegion {
    /// A vertex slot and its node of the surface.
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
    std::vector<Bent> bent;    ///< the free vertices; vertices of a patch mostly follow each other
    std::vector<Bent> beside;  ///< the held vertices
    const std::uint32_t first; ///< the smallest slot of a free vertex

    MovingRegion(SurfaceGraph surface, HeldNodes held, std::uint32_t first = 0)
        : surface(std::move(surface)), held(std::move(held)), first(first) {}
    MovingRegion(const MovingRegion &) = delete; // its parts refer to each other
    MovingRegion &operator=(const MovingRegion &) = delete;

    bool IsFree(Index node) const { return held.tag[std::size_t(node)] == 1; }

  protected:
    /// Sets bent and beside. \param nodeOf node of each of surface.slots, by slot
    void ListVertices(const std::vector<Index> &nodeOf, const Progress &progress);
};

} // namespace vcg::fcd

#endif
