// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LOOSE_PARTS_H
#define VCG_FCD_LOOSE_PARTS_H

#include "graph_deformer.h"
#include "handles.h"
#include "surface_graph.h"

#include <functional>

namespace vcg {
namespace fcd {

/// The free surface that nothing holds: connected components without a fixed or handle vertex, isolated vertices.
struct LooseSurface {
    std::vector<Index> partOf; ///< per vertex slot: its loose part, -1 for none; empty where there are no loose parts
    Index parts = 0;
    Index components = 0;         ///< connected components of the free surface and what holds it, loose ones included
    Index isolated = 0;           ///< loose vertices without a neighbour
    bool isPartOfSurface = false; ///< some loose part has nodes in the surface that it was found in
};

} // namespace fcd

namespace tri {

/// The free surface of a mesh and the held vertices beside it. \param partOf of LooseSurface; what has a part is left
/// out
template <class MeshType>
fcd::SurfaceGraph ReadFreeSurface(const MeshType &m, const std::vector<int> &tag, const std::vector<fcd::Index> &partOf,
                                  const Eigen::Matrix3d &metric, const fcd::Progress &progress) {
    std::vector<char> excluded(partOf.size());
    for (std::size_t i = 0; i < partOf.size(); ++i)
        excluded[i] = partOf[i] >= 0;
    const Region region = FreeRegion(m, tag, excluded, metric, progress.Slice(0, 0.2));
    return BuildSurfaceGraph(m, &region, tag, metric, progress.Slice(0.2, 1));
}

/// \param tag of each node of \p surface; 1 is free
template <class MeshType>
fcd::LooseSurface FindLoose(const MeshType &m, const fcd::Handles &handles, const fcd::SurfaceGraph &surface,
                            const std::vector<fcd::Index> &tag, const fcd::Progress &progress) {
    using fcd::Index;
    fcd::LooseSurface loose;
    std::vector<Index> componentOf(surface.graph.Size());
    loose.components = fcd::ConnectedComponents(surface.graph.adjacency, componentOf, progress);
    std::vector<char> isHeld(loose.components, 0);
    for (Index u = 0; u < surface.graph.Size(); ++u)
        isHeld[componentOf[u]] |= tag[u] != 1;
    std::vector<Index> number(loose.components, -1);
    for (Index c = 0; c < loose.components; ++c)
        if (!isHeld[c])
            number[c] = loose.parts++;
    loose.isPartOfSurface = loose.parts > 0;
    std::vector<char> isPoint;
    for (const fcd::PointHandle &point : handles.point)
        if (surface.nodeOf[point.vertex] < 0) {
            isPoint.resize(m.vert.size(), 0);
            isPoint[point.vertex] = 1;
        }
    for (std::size_t i = 0; i < m.vert.size(); ++i) {
        const Index u = surface.nodeOf[i];
        if (handles.tag[i] != 1 || (u >= 0 && isHeld[componentOf[u]]) || (!isPoint.empty() && isPoint[i]) ||
            m.vert[i].IsD())
            continue;
        if (loose.partOf.empty())
            fcd::AssignLarge(loose.partOf, m.vert.size(), Index(-1));
        if (u < 0) {
            ++loose.isolated;
            ++loose.components;
        }
        loose.partOf[i] = u < 0 ? loose.parts++ : number[componentOf[u]];
    }
    return loose;
}

/// The motion of each loose part, mesh units: the rigid one of the nearest place that is held or that follows what is,
/// so that a button follows the sleeve.
/// \param follow false: they stay
/// \param motion of each tag but 1
/// \param pointMotion of the point handles at vertices that are no surface, by slot
/// \param motionAt motionAt(node, p): the rigid motion of \p surface there, in its frame
template <class MeshType, class MotionAt>
std::vector<Eigen::Matrix4d>
LooseMotions(const MeshType &m, const fcd::Handles &handles, const fcd::SurfaceGraph &surface,
             const fcd::LooseSurface &loose, bool follow, const std::map<fcd::Index, Eigen::Matrix4d> &motion,
             const std::map<std::size_t, Eigen::Matrix4d> &pointMotion, const MotionAt &motionAt) {
    using fcd::Index;
    std::vector<Eigen::Matrix4d> result(loose.parts, Eigen::Matrix4d::Identity());
    if (!follow || loose.parts == 0)
        return result;
    // Places to follow, in a frame of all of them: a sample of vertices fine enough that the next one moves alike.
    const std::size_t most = 1 << 16;
    std::vector<std::size_t> held, bent;
    for (std::size_t i = 0; i < m.vert.size(); ++i)
        if (!m.vert[i].IsD() && loose.partOf[i] < 0)
            (handles.tag[i] == 1 ? bent : held).push_back(i);
    std::vector<std::size_t> place;
    for (const std::vector<std::size_t> *from : {&bent, &held})
        for (std::size_t i = 0; i < std::min(most, from->size()); ++i)
            place.push_back((*from)[from->size() * i / std::min(most, from->size())]);
    if (place.empty())
        return result;
    const auto pointOf = [&](std::size_t i) {
        const Eigen::Vector3d p = surface.frame.ToWorld(PositionOf(m.vert[i]));
        return vcg::Point3d(p[0], p[1], p[2]);
    };
    std::vector<vcg::Point3d> point;
    for (std::size_t i : place)
        point.push_back(pointOf(i));
    vcg::ConstDataWrapper<vcg::Point3d> wrapper(point.data(), int(point.size()));
    vcg::KdTree<double> tree(wrapper);
    std::vector<double> distance(loose.parts, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> leader(loose.parts, std::size_t(-1));
    for (std::size_t i = 0; i < m.vert.size(); ++i) {
        if (loose.partOf[i] < 0)
            continue;
        unsigned nearest = 0;
        double d = 0;
        tree.doQueryClosest(pointOf(i), nearest, d);
        if (d < distance[loose.partOf[i]]) {
            distance[loose.partOf[i]] = d;
            leader[loose.partOf[i]] = place[nearest];
        }
    }
    for (Index part = 0; part < loose.parts; ++part) {
        const std::size_t i = leader[part];
        if (i == std::size_t(-1))
            continue;
        const Eigen::Vector3d p = surface.frame.ToFrame(PositionOf(m.vert[i]));
        Eigen::Affine3d there;
        if (surface.nodeOf[i] >= 0 && surface.tag[surface.nodeOf[i]] == 1) {
            there = motionAt(surface.nodeOf[i], p);
        } else {
            const Eigen::Matrix4d &given =
                handles.tag[i] == 1 ? pointMotion.at(i) : motion.at(std::max(0, handles.tag[i]));
            if (given.isIdentity(0))
                continue;
            const Eigen::Affine3d moved = surface.frame.ToFrame(given);
            there.linear() = fcd::detail::RotationOf(moved.linear());
            there.translation() = moved * p - there.linear() * p;
        }
        result[part] = surface.frame.FromFrame(there);
        result[part].row(3) << 0, 0, 0, 1;
    }
    return result;
}

} // namespace tri
} // namespace vcg

#endif
