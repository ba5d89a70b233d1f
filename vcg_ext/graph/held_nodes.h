// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_HELD_NODES_H
#define VCG_FCD_HELD_NODES_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/graph/node_constraints.h>
#include <vcg_ext/handles/handles.h>
#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/shape_constants.h>
#include <vcg_ext/surface/surface_graph.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// Which nodes of a surface of n nodes are held, and which of them are single.
///
/// A node is single if it is held, but none of its neighbours is held by the same tag; point handles are single, too.
/// Then only its position is given: its rotation is not, unless its motion is told to turn it. (A given rotation would
/// leave a bump around it.) Single nodes get negative tags, each its own.
struct HeldNodes {
    std::vector<Index> tag;      ///< n: 0 fixed, 1 free, from 2 handles; -1, -2, ... single nodes
    std::vector<Index> original; ///< of each single node, its tag before; -1 for point handles
    std::vector<Index> pointTag; ///< of each point handle, the tag of its node; 1 where there is no surface

    static bool IsSingle(Index t) { return t < 0; }
    bool IsFixed(Index t) const { return Original(t) == 0; }
    /// The tag before of a node of tag \p t; -1 for a point handle.
    Index Original(Index t) const { return IsSingle(t) ? original[std::size_t(-1 - t)] : t; }

    /// Makes \p u a single node. \return its new tag
    Index HoldAlone(Index u, Index tagBefore) {
        original.push_back(tagBefore);
        return tag[u] = -Index(original.size());
    }
};

/// Finds the held and the single nodes of \p surface.
/// \param slotTag one per vertex slot \param point slots of the point handles; none is deleted
/// \throw BadInput two point handles at one position, or one where the surface is held
HeldNodes HoldNodes(const SurfaceGraph &surface, const std::vector<int> &slotTag, const std::vector<std::size_t> &point,
                    const Progress &progress);

/// The motions of all that is held, in one pose.
struct HeldMotions {
    std::map<Index, Eigen::Matrix4d> motion; ///< of every tag but 1, mesh units
    std::map<Index, bool> rotates;           ///< whether the motion of a tag also gives the rotation of single nodes
    std::map<Index, Eigen::Vector3d> turn;   ///< of every tag >= 0 but 1: rotation vector since rest, with full turns
    std::map<std::size_t, Eigen::Matrix4d> pointMotion; ///< of each point handle, by slot

    bool operator==(const HeldMotions &o) const {
        return motion == o.motion && rotates == o.rotates && turn == o.turn && pointMotion == o.pointMotion;
    }
    bool Moves() const {
        const auto moves = [](const auto &each) { return each.second != Eigen::Matrix4d::Identity(); };
        return std::any_of(motion.begin(), motion.end(), moves) ||
               std::any_of(pointMotion.begin(), pointMotion.end(), moves);
    }
};

/// The mean position of the vertices of each handle. \param tag one per vertex slot \param at position of a slot
template <class At>
std::map<Index, Eigen::Vector3d> HandleCenters(const std::vector<int> &tag, const At &at) {
    std::map<Index, std::pair<Eigen::Vector3d, double>> sums;
    auto last = sums.end(); // the entry of the vertex before: mostly the right one
    for (std::size_t i = 0; i < tag.size(); ++i)
        if (tag[i] >= 2) {
            if (last == sums.end() || last->first != tag[i])
                last = sums.emplace(tag[i], std::make_pair(Eigen::Vector3d::Zero().eval(), 0.0)).first;
            last->second.first += at(i);
            ++last->second.second;
        }
    std::map<Index, Eigen::Vector3d> center;
    for (const auto &sum : sums)
        center[sum.first] = sum.second.first / sum.second.second;
    return center;
}

namespace detail {

/// \throw BadInput if \p motion (mesh units) leads farther than numbers can hold \param name says whose motion it is
void ExpectNear(const Frame &frame, const Eigen::Matrix4d &motion, const std::string &name);

/// Fits one rotation to the motions of all constrained nodes: the rotation that single nodes begin with.
void TurnTogether(const DeformationGraph &graph, const std::vector<Index> &tag, const Patches &patches,
                  NodeConstraints &given);

/// The small held parts of the surface: connected nodes of one tag that reach no farther than a fraction of D
/// (ShapeConstants::smallHeldPart) and have free surface around them.
struct SmallParts {
    std::vector<Index> center;  ///< of each part, the node nearest its middle
    std::vector<double> radius; ///< of each part, the distance from there to its farthest node, frame units
    std::vector<char> isIn;     ///< n flags: the node is in a small part
};

SmallParts FindSmallParts(const Graph &surface, const std::vector<Index> &tag, double D, const ShapeConstants &shape);

/// Constrains the nodes of held patches to the motions of their tags. They are compliant, except for single nodes whose
/// motion gives their rotation. Behind a node, the held area counts as infinite; behind a small part it is the part's
/// area, and behind a single node 0.
/// \param motion of every tag but 1, frame units
NodeConstraints ConstrainNodes(const DeformationGraph &graph, const std::vector<Index> &tag, const Patches &patches,
                               const SmallParts &small, const HeldMotions &motions,
                               const std::map<Index, Eigen::Affine3d> &motion);

/// Grows the patches again, with a patch of free surface around each small held part. The surface around then follows
/// the part's node, and not only the nearest vertices.
void OpenSmallParts(const Graph &surface, const std::vector<Index> &tag, const SmallParts &small, Patches &patches,
                    const Progress &progress);

} // namespace detail
} // namespace vcg::fcd

#endif
