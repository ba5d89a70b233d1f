// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LOOSE_PARTS_H
#define VCG_FCD_LOOSE_PARTS_H

#include "free_region.h"
#include "handles.h"
#include "surface_graph.h"

#include <Eigen/Geometry>
#include <memory>
#include <vcg/space/index/kdtree/kdtree.h>
#include <vcg/space/point3.h>

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
/// out \param known as of PositionOf
template <class MeshType>
fcd::SurfaceGraph ReadFreeSurface(const MeshType &m, const std::vector<int> &tag, const std::vector<fcd::Index> &partOf,
                                  const Eigen::Matrix3d &metric, const fcd::Progress &progress,
                                  double weldDistance = fcd::defaultWeldDistance,
                                  const Eigen::Matrix3Xd *known = nullptr) {
    std::vector<char> excluded(partOf.size());
    for (std::size_t i = 0; i < partOf.size(); ++i)
        excluded[i] = partOf[i] >= 0;
    Region region = FreeRegion(m, tag, excluded, metric, progress.Slice(0, 0.2), known);
    fcd::SurfaceGraph surface = BuildSurfaceGraph(m, &region, tag, metric, progress.Slice(0.2, 1), weldDistance, known);
    surface.faces = std::move(region.faces);
    surface.apart = std::move(region.apart);
    return surface;
}

} // namespace tri

namespace fcd {

/// \param slotTag one per vertex slot, noVertex where it is deleted \param point slots of point handles
/// \param tag of each node of \p surface; 1 is free
inline LooseSurface FindLoose(const std::vector<int> &slotTag, const std::vector<std::size_t> &point,
                              const SurfaceGraph &surface, const std::vector<Index> &tag, const Progress &progress) {
    LooseSurface loose;
    std::vector<Index> componentOf(surface.graph.Size());
    loose.components = ConnectedComponents(surface.graph.adjacency, componentOf, progress);
    std::vector<char> isHeld(loose.components, 0);
    for (Index u = 0; u < surface.graph.Size(); ++u)
        isHeld[componentOf[u]] |= tag[u] != 1;
    std::vector<Index> number(loose.components, -1);
    for (Index c = 0; c < loose.components; ++c)
        if (!isHeld[c])
            number[c] = loose.parts++;
    loose.isPartOfSurface = loose.parts > 0;
    std::vector<char> isPoint;
    for (std::size_t i : point)
        if (surface.nodeOf[i] < 0) {
            isPoint.resize(slotTag.size(), 0);
            isPoint[i] = 1;
        }
    for (std::size_t i = 0; i < slotTag.size(); ++i) {
        const Index u = surface.nodeOf[i];
        if (slotTag[i] != 1 || (u >= 0 && isHeld[componentOf[u]]) || (!isPoint.empty() && isPoint[i]))
            continue;
        if (loose.partOf.empty())
            AssignLarge(loose.partOf, slotTag.size(), Index(-1));
        if (u < 0) {
            ++loose.isolated;
            ++loose.components;
        }
        loose.partOf[i] = u < 0 ? loose.parts++ : number[componentOf[u]];
    }
    return loose;
}

/// Places of a surface that things near it follow: a sample of vertices so fine that the next one moves alike.
class Places {
  public:
    /// \param position 3 x slots, mesh units \param slotTag as of FindLoose \param isPlace slots that may be one
    template <class IsPlace>
    Places(const Eigen::Matrix3Xd &position, const std::vector<int> &slotTag, const Frame &frame,
           const IsPlace &isPlace)
        : frame(frame) {
        const std::size_t most = 1 << 16;
        std::vector<std::size_t> held, bent;
        for (std::size_t i = 0; i < slotTag.size(); ++i)
            if (slotTag[i] != noVertex && isPlace(i))
                (slotTag[i] == 1 ? bent : held).push_back(i);
        for (const std::vector<std::size_t> *from : {&bent, &held})
            for (std::size_t i = 0; i < std::min(most, from->size()); ++i)
                slot.push_back((*from)[from->size() * i / std::min(most, from->size())]);
        std::vector<vcg::Point3d> point;
        point.reserve(slot.size());
        for (std::size_t i : slot)
            point.push_back(InWorld(position.col(Eigen::Index(i))));
        if (!slot.empty())
            tree = std::make_unique<vcg::KdTree<double>>(
                vcg::ConstDataWrapper<vcg::Point3d>(point.data(), int(point.size())));
    }

    bool IsEmpty() const { return slot.empty(); }

    /// The slot of the place nearest to \p p (mesh units). \param distance in the world, out
    std::size_t Nearest(const Eigen::Vector3d &p, double &distance) const {
        unsigned found = 0;
        tree->doQueryClosest(InWorld(p), found, distance);
        return slot[found];
    }

    static constexpr int several = 8;
    /// The slots of the places nearest to \p p, and weights of sum 1 that change smoothly with it; -1 fills up.
    void Several(const Eigen::Vector3d &p, Index slots[several], float weights[several]) const {
        vcg::KdTree<double>::PriorityQueue queue;
        const int wanted = int(std::min<std::size_t>(several + 1, slot.size()));
        tree->doQueryK(InWorld(p), wanted, queue);
        std::vector<std::pair<double, Index>> found;
        found.reserve(several + 1);
        for (int i = 0; i < queue.getNofElements(); ++i)
            found.emplace_back(std::sqrt(queue.getWeight(i)), Index(slot[queue.getIndex(i)]));
        std::sort(found.begin(), found.end());
        const double last = found.empty() ? 0 : found.back().first; // has no weight left
        double sum = 0, weight[several] = {};
        for (int i = 0; i < several; ++i) {
            const bool is = i < int(found.size());
            slots[i] = is ? found[i].second : -1;
            weight[i] = is && last > 0 ? std::pow(1 - found[i].first / last, 2) : 0;
            sum += weight[i];
        }
        if (!(sum > 0) && !found.empty())
            sum = weight[0] = 1;
        for (int i = 0; i < several; ++i)
            weights[i] = sum > 0 ? float(weight[i] / sum) : 0.f;
    }

  private:
    vcg::Point3d InWorld(const Eigen::Vector3d &p) const {
        const Eigen::Vector3d w = frame.ToWorld(p);
        return vcg::Point3d(w[0], w[1], w[2]);
    }
    const Frame &frame;
    std::vector<std::size_t> slot;
    std::unique_ptr<vcg::KdTree<double>> tree;
};

/// How loose parts follow what holds or bends nearby, so that a button follows the sleeve.
struct LooseFollowing {
    static constexpr std::size_t none = std::size_t(-1);
    std::vector<std::size_t> leader; ///< of each part, the slot of the nearest place, or none
    /// Vertices of parts that reach farther than patches do: each follows what is nearest to it.
    struct Vertex {
        std::size_t slot;
        Index place[Places::several]; ///< slots, -1 fills up
        float weight[Places::several];
    };
    std::vector<Vertex> vertex;
};

/// \param large diameter in frame units from which a part does not move as one
inline LooseFollowing FollowNearest(const Eigen::Matrix3Xd &position, const std::vector<int> &slotTag,
                                    const Frame &frame, const LooseSurface &loose, double large,
                                    const Progress &progress) {
    LooseFollowing following;
    following.leader.assign(loose.parts, LooseFollowing::none);
    if (loose.parts == 0)
        return following;
    const Places places(position, slotTag, frame, [&](std::size_t i) { return loose.partOf[i] < 0; });
    if (places.IsEmpty())
        return following;
    std::vector<double> distance(loose.parts, std::numeric_limits<double>::infinity());
    std::vector<Eigen::AlignedBox3d> box(loose.parts);
    for (std::size_t i = 0; i < slotTag.size(); ++i) {
        const Index part = loose.partOf[i];
        if (part < 0)
            continue;
        double d = 0;
        const std::size_t nearest = places.Nearest(position.col(Eigen::Index(i)), d);
        if (d < distance[part]) {
            distance[part] = d;
            following.leader[part] = nearest;
        }
        box[part].extend(frame.ToFrame(Eigen::Vector3d(position.col(Eigen::Index(i)))));
    }
    for (std::size_t i = 0; i < slotTag.size(); ++i)
        if (loose.partOf[i] >= 0 && box[loose.partOf[i]].diagonal().norm() > large) {
            following.vertex.emplace_back();
            following.vertex.back().slot = i;
        }
    ParallelFor(progress, "Finding what loose parts follow", following.vertex.size(), 1 << 10,
                [&](std::size_t first, std::size_t last) {
                    for (std::size_t v = first; v < last; ++v) {
                        LooseFollowing::Vertex &vertex = following.vertex[v];
                        places.Several(position.col(Eigen::Index(vertex.slot)), vertex.place, vertex.weight);
                    }
                });
    return following;
}

} // namespace fcd
} // namespace vcg

#endif
