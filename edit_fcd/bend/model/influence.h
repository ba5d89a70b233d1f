// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_INFLUENCE_H
#define FCD_BEND_INFLUENCE_H

#include "edit_fcd/bend/model/reach.h"

#include <layer_fcd/bend_state.h>

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <vector>

/// What the influence of handles needs to know of a layer's rest shape.
struct BendGround {
    std::size_t vertexSlots = 0;
    double diagonal = 1;                                  ///< of the bounding box, world units
    Eigen::Affine3d world = Eigen::Affine3d::Identity();  ///< the layer's matrix
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();     ///< of the box, layer units
    std::function<Eigen::Vector3d(std::size_t)> at;       ///< of a slot, layer units
    std::function<Eigen::Vector3d(std::size_t)> normalAt; ///< of a vertex, layer units
    BendReach *reach = nullptr;
};

/// What each handle bends: all that follows from a state on a rest shape.
struct BendInfluence {
    std::shared_ptr<const BendTags> tags;                     ///< one per vertex slot: the result, for the deformer
    std::map<vcg::fcd::Index, Eigen::Vector3d> center;        ///< of the handles at rest, layer units
    bool isLocal = false;                                     ///< handles bend what is around them only
    std::set<int> apart;                                      ///< ranks that bend less than their radius
    std::map<int, std::shared_ptr<const BendExtent>> extents; ///< by tag, of handles that others may lie beyond
    std::map<int, std::vector<int>> beyond;                   ///< by tag, the handles that do

    bool isHandle(int tag) const { return center.count(tag) > 0; }
    std::vector<int> handles() const; ///< ascending
    int unusedTag() const;
};

/// \param before returned as the tags, the same object, if the tags equal it; may be null
BendInfluence influenceOf(const BendState &state, const BendGround &ground,
                          const std::shared_ptr<const BendTags> &before = nullptr);

/// Whether a vertex is held by a point only because it lies beyond that: a new handle frees it.
bool isAlong(const BendState &state, const BendInfluence &influence, std::size_t slot);

/// The gap of the usual radius, world units.
inline double usualGap(double diagonal) { return gapOfRadius * usualRadius * diagonal; }

#endif
