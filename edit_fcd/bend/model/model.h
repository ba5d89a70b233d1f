// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_MODEL_H
#define FCD_BEND_MODEL_H

#include "edit_fcd/bend/model/reach.h"

#include <layer_fcd/bend_state.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
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

/// The gap of the usual radius, world units.
inline double usualGap(double diagonal) { return gapOfRadius * usualRadius * diagonal; }

/// The state of a bend, its options and consequences. Functions here change these data only; BendSession changes
/// layers.
struct BendModel {
    BendState state;
    BendOptions options;
    BendGround ground;
    BendInfluence influence; ///< of the state on the ground

    Eigen::Vector3d rest(int tag) const; ///< the middle of a handle at rest, world
};

// --- where handles are: in the pose, world ---

Eigen::Affine3d motionAt(const BendModel &model, int tag);
/// The same for other steps.
Eigen::Affine3d motionBy(const BendModel &model, int tag, const std::vector<vcg::fcd::MotionStep> &steps);
Eigen::Vector3d centerOf(const BendModel &model, int tag); ///< the middle of a handle
Eigen::Vector3d dotOf(const BendModel &model, int tag);    ///< where it is dragged: its vertex, or its middle
/// The joint of a point on a limb, at rest (BendExtent::joint); none for other handles.
std::optional<Eigen::Vector3d> jointOf(const BendModel &model, int tag);
/// The pivot: as the user has set it, or else the joint, or else the dot.
Eigen::Vector3d pivotOf(const BendModel &model, int tag);
/// The axes by options.axes, as columns; those of the view are not known here.
Eigen::Matrix3d axesOf(const BendModel &model, int tag);
Eigen::Affine3d mirrorOf(const BendModel &model); ///< the identity if there is none
/// The twin of a handle: that on the other side of the mirror; 0 if there is none, or no mirror.
int mirrored(const BendModel &model, int tag);
/// Whether symmetry is on, but a handle far from the mirror moves without a twin.
bool lacksTwin(const BendModel &model, int tag);
/// Whether a vertex is near enough to the mirror image of another one to be that of a twin.
bool isTwin(const BendModel &model, std::size_t slot, std::size_t other);

// --- which handles move others ---

/// The handles that move along with one: those beyond it, except locked ones.
std::vector<int> carriedBy(const BendModel &model, int tag);
/// Whether a handle bends less than its radius since others bend the surface beside it. Setting its radius ends that.
bool isKeptApart(const BendModel &model, int tag);
/// Whether a handle turns a limb about its joint.
bool turnsLimb(const BendModel &model, int tag);
/// The handle of the joint before that of \p tag; the limb is then a chain of two bones. It is the nearest one that
/// moves \p tag along, if the two bones are about equally long; 0: none. \param held the dragged point, in the pose
int jointBefore(const BendModel &model, int tag, const Eigen::Vector3d &held);
/// Whether a point holds a vertex only since that lies beyond it on the limb: a new handle may take it.
bool isAlong(const BendModel &model, std::size_t slot);
/// Whether a point can be made of a vertex.
bool canBecomePoint(const BendModel &model, std::size_t slot);
double radiusOf(const BendModel &model, int tag); ///< world units

// --- motions ---

/// The motions of all handles.
std::map<vcg::fcd::Index, vcg::fcd::Motion> motionsOf(const BendModel &model);
bool isMoved(const BendModel &model); ///< whether any handle is away from rest
/// Sets the motions of handles, and of their twins, except locked ones.
void setMotion(BendModel &model, const BendMotions &steps);
/// \throw vcg::fcd::Error it is not the text of a motion
void setMotionText(BendModel &model, int tag, const std::string &text);
/// \throw vcg::fcd::Error it is not a text of motions, or has other handles
void setMotions(BendModel &model, const std::string &text);
void setPose(BendModel &model, double percent);
/// Sets the pivot of a handle, and of its twin. \param place in the pose; none: the default
void setPivot(BendModel &model, int tag, const std::optional<Eigen::Vector3d> &place);

/// Forgets all about handles that are gone.
void forgetGone(BendModel &model);
/// Changes steps so that motions stay the same although the middles of handles have moved. \param before the earlier
/// middles, by tag \return whether any step has changed
bool keepPlaces(const BendModel &model, const std::map<vcg::fcd::Index, Eigen::Vector3d> &before, BendMotions &motion);

#endif
