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

/// Which nodes of a surface are held, and which of them alone. Follows from the tags and the places of point handles.
struct HeldNodes {
    std::vector<Index> tag;      ///< n: 0 fixed, 1 free, from 2 handles; -1, -2, ... single nodes
    std::vector<Index> original; ///< tag of the single nodes before, -1 for point handles
    std::vector<Index> pointTag; ///< of each point handle: that of its node, 1 where no surface is

    static bool IsSingle(Index t) { return t < 0; }
    bool IsFixed(Index t) const { return Original(t) == 0; }
    /// The tag of a node of tag \p t before, -1 for a point handle.
    Index Original(Index t) const { return IsSingle(t) ? original[std::size_t(-1 - t)] : t; }

    /// Holds node \p u, alone. \return its tag
    Index HoldAlone(Index u, Index tagBefore) {
        original.push_back(tagBefore);
        return tag[u] = -Index(original.size());
    }
};

/// A node that is held without a neighbour that is held alike has no orientation of its own: only its position is
/// given, unless it is told to turn. (Holding its orientation leaves a bump around it.)
/// \param slotTag one per vertex slot \param point slots of the point handles, which exist
/// \throw BadInput two point handles at one place, or one where the surface is held
HeldNodes HoldNodes(const SurfaceGraph &surface, const std::vector<int> &slotTag, const std::vector<std::size_t> &point,
                    const Progress &progress);

/// How what is held moves, at one pose.
struct HeldMotions {
    std::map<Index, Eigen::Matrix4d> motion; ///< of every tag but 1, mesh units
    std::map<Index, bool> rotates;           ///< tags whose motion is told to turn
    /// By what each tag from 0, but 1, has turned since rest, with full turns: along the axis, as long as the angle in
    /// radians.
    std::map<Index, Eigen::Vector3d> turn;
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

/// The mean position of the vertices of each handle. \param at position of a slot \param tag one per vertex slot
template <class At>
std::map<Index, Eigen::Vector3d> HandleCenters(const std::vector<int> &tag, const At &at) {
    std::map<Index, std::pair<Eigen::Vector3d, double>> sums;
    auto last = sums.end(); // that of the vertex before, as mostly
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

/// \throw BadInput when \p motion leads so far that the numbers do not hold what follows from it
void ExpectNear(const Frame &frame, const Eigen::Matrix4d &motion, const std::string &name);

/// The closest rotation between the constrained nodes before and after, as the rotation that single nodes begin with.
void TurnTogether(const DeformationGraph &graph, const std::vector<Index> &tag, const Patches &patches,
                  NodeConstraints &given);

/// Small held parts of the surface: connected nodes of one tag that reach no farther than a fraction of D and have free
/// surface around them.
struct SmallParts {
    std::vector<Index> center;  ///< of each part, the node nearest its middle
    std::vector<double> radius; ///< farthest node of the part from there
    std::vector<char> isIn;     ///< n flags
};

SmallParts FindSmallParts(const Graph &surface, const std::vector<Index> &tag, double D, const ShapeConstants &shape);

/// Nodes of held patches move as their tag does, and turn with what they hold: the region behind them goes on for all
/// that is known of it, but behind a small part there is only what it covers. A single node that is told to turn does.
NodeConstraints ConstrainNodes(const DeformationGraph &graph, const std::vector<Index> &tag, const Patches &patches,
                               const SmallParts &small, const HeldMotions &motions,
                               const std::map<Index, Eigen::Affine3d> &motion);

/// Grows the patches anew with one around each small held part: its node then stands for the free surface around it, as
/// any other, so that the surface follows it and not only the nearest vertices.
void OpenSmallParts(const Graph &surface, const std::vector<Index> &tag, const SmallParts &small, Patches &patches,
                    const Progress &progress);

} // namespace detail
} // namespace vcg::fcd

#endif
