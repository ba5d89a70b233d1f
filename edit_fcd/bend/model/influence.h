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

/// The rest shape of a layer, as influenceOf() reads it.
struct BendGround {
    std::size_t vertexSlots = 0;
    double diagonal = 1;                                  ///< of the bounding box, world units
    Eigen::Affine3d world = Eigen::Affine3d::Identity();  ///< the layer's matrix
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();     ///< of the box, layer units
    std::function<Eigen::Vector3d(std::size_t)> at;       ///< position of a slot, layer units
    std::function<Eigen::Vector3d(std::size_t)> normalAt; ///< of a vertex, layer units
    BendReach *reach = nullptr;
};

/// What each handle holds and bends: all that follows from a state on a rest shape.
struct BendInfluence {
    std::shared_ptr<const BendTags> tags;              ///< one per vertex slot: the result, for the deformer
    std::map<vcg::fcd::Index, Eigen::Vector3d> center; ///< of the handles at rest, layer units
    bool isLocal = false; ///< nothing is marked as fixed: handles only bend the surface around them
    std::set<int> apart;  ///< ranks whose handles bend less than their radius
    std::map<int, std::shared_ptr<const BendExtent>> extents; ///< by tag; if there are several handles, or a grip
    std::map<int, std::vector<int>> beyond;                   ///< by tag: the handles beyond it, on its limb

    bool isHandle(int tag) const { return center.count(tag) > 0; }
    std::vector<int> handles() const; ///< ascending
    int unusedTag() const;
};

/// \param before earlier tags, or null; if the new ones are equal, this object is returned
BendInfluence influenceOf(const BendState &state, const BendGround &ground,
                          const std::shared_ptr<const BendTags> &before = nullptr);

/// Whether a point holds a vertex only since that lies beyond it on the limb: a new handle may take it.
bool isAlong(const BendState &state, const BendInfluence &influence, std::size_t slot);

/// The gap of the usual radius, world units.
inline double usualGap(double diagonal) { return gapOfRadius * usualRadius * diagonal; }

#endif
