// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MOVING_SURFACE_H
#define VCG_FCD_MOVING_SURFACE_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/graph/held_nodes.h>
#include <vcg_ext/map/graph_mapping.h>
#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/solve/graph_pose.h>
#include <vcg_ext/surface/loose_parts.h>
#include <vcg_ext/surface/surface_graph.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace vcg {
namespace fcd {

/// One pose of a surface.
struct SurfacePose {
    HeldMotions given;
    GraphPose solved;                        ///< of the graph
    GraphPose graph;                         ///< the same with linear maps (FitLinear; rotations as printed)
    std::vector<Eigen::Affine3d> nodeMotion; ///< k, of constrained nodes, frame units
    /// Of every tag but 1, frame units; of single nodes that turn as the surface around them does, that.
    std::map<Index, Eigen::Affine3d> motion;
    int iterations = 0; ///< of the solver, with those of the poses on the way
    bool isFitted = false; ///< the surface moves though nothing that holds it does: it was fitted to data
};

/// A surface with its deformation graph, and how each of its vertices follows the graph.
struct MovingSurface {
    /// A free vertex of the surface.
    struct Bent {
        std::uint32_t slot;
        Index node;
    };

    const SurfaceGraph surface; ///< the free surface without its loose parts, and what holds it
    const HeldNodes held;
    const LooseSurface loose;
    const std::vector<int> slotTag; ///< one per vertex slot, noVertex where it is deleted
    Patches patches;
    DeformationGraph graph;
    MappingWeights weights = MappingWeights::Surface;
    std::unique_ptr<GraphMapping> mapping;
    LooseFollowing following;
    std::vector<Eigen::Vector3d> leaderRest; ///< of each loose part, mesh units
    std::vector<Bent> bent;                  ///< the free vertices of the surface
    std::vector<std::uint32_t> carried;      ///< slots of handles, and of loose parts

    MovingSurface(SurfaceGraph surface, HeldNodes held, LooseSurface loose, std::vector<int> slotTag)
        : surface(std::move(surface)), held(std::move(held)), loose(std::move(loose)), slotTag(std::move(slotTag)) {}
    MovingSurface(const MovingSurface &) = delete; // its parts refer to each other
    MovingSurface &operator=(const MovingSurface &) = delete;

    /// body(slot) for each slot that may move in some pose, once.
    template <class Body>
    void ForMoving(const Body &body) const {
        for (const Bent &vertex : bent)
            body(std::size_t(vertex.slot));
        for (std::uint32_t i : carried)
            body(std::size_t(i));
    }

    /// Lists what may move, free vertices of one patch beside each other. \param point slots of the point handles
    void FindMoving(const std::vector<std::size_t> &point, const Progress &progress);
};

} // namespace fcd
} // namespace vcg

#endif
