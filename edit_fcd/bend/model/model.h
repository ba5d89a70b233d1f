// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_MODEL_H
#define FCD_BEND_MODEL_H

#include "edit_fcd/bend/model/influence.h"

#include <layer_fcd/bend_state.h>

#include <optional>

/// What is bent, how, and what follows from that: data, which the functions here read and change. None of them touches
/// a layer; BendSession does that.
struct BendModel {
    BendState state;
    BendOptions options;
    BendGround ground;
    BendInfluence influence; ///< of this state on this ground

    Eigen::Vector3d rest(int tag) const; ///< the middle of a handle at rest, in the world
};

// --- where handles are; places are in the pose, and in the world ---

Eigen::Affine3d motionAt(const BendModel &model, int tag);
/// The same, if these were its steps.
Eigen::Affine3d motionBy(const BendModel &model, int tag, const std::vector<vcg::fcd::MotionStep> &steps);
Eigen::Vector3d centerOf(const BendModel &model, int tag); ///< the middle of a handle
Eigen::Vector3d dotOf(const BendModel &model, int tag);    ///< where the mouse grips it: its vertex, or its middle
/// The joint of a point on a limb, at rest: the middle of what bends between what turns with the point and what stays.
/// None of other handles.
std::optional<Eigen::Vector3d> jointOf(const BendModel &model, int tag);
/// The pivot: where the user has put it, or else the joint, or else the dot.
Eigen::Vector3d pivotOf(const BendModel &model, int tag);
/// By options.axes, as columns; those of the view are not known here.
Eigen::Matrix3d axesOf(const BendModel &model, int tag);
Eigen::Affine3d mirrorOf(const BendModel &model); ///< the identity where there is none
/// The handle on the other side of the mirror, 0 where there is none or no mirror.
int mirrored(const BendModel &model, int tag);
/// Whether two vertices are so near to each other's place in the mirror that they are one handle's and its twin's.
bool isTwin(const BendModel &model, std::size_t slot, std::size_t other);

// --- who goes with whom ---

/// The handles that go along when one is moved: those beyond it, except locked ones.
std::vector<int> carriedBy(const BendModel &model, int tag);
/// Whether a handle bends less than its radius, since others have bent the surface beside it. Setting its radius ends
/// it.
bool isKeptApart(const BendModel &model, int tag);
/// Whether a handle turns a limb about its joint.
bool turnsLimb(const BendModel &model, int tag);
/// The handle of the joint before that of \p tag, so that the limb is a chain of two bones: the nearest one that takes
/// it along and is about as far from it as what is dragged; 0: none. \param held what is dragged, in the pose
int jointBefore(const BendModel &model, int tag, const Eigen::Vector3d &held);
bool isAlong(const BendModel &model, std::size_t slot); ///< as isAlong() of its state
/// Whether a point can be made of a vertex.
bool canBecomePoint(const BendModel &model, std::size_t slot);
double radiusOf(const BendModel &model, int tag); ///< world units

// --- motions ---

/// Motions of the handles.
std::map<vcg::fcd::Index, vcg::fcd::Motion> motionsOf(const BendModel &model);
bool isMoved(const BendModel &model); ///< whether anything leads away from rest
/// Of some handles, and of those on the other side of the mirror.
void setMotion(BendModel &model, const std::map<int, std::vector<vcg::fcd::MotionStep>> &steps);
/// \throw vcg::fcd::Error when it is not the text of a motion
void setMotionText(BendModel &model, int tag, const std::string &text);
/// \throw vcg::fcd::Error when it is not a text of motions, or not of the handles here
void setMotions(BendModel &model, const std::string &text);
void setPose(BendModel &model, double percent);
/// Of a handle, and of the one on the other side of the mirror. \param place in the pose, none: the handle's middle
void setPivot(BendModel &model, int tag, const std::optional<Eigen::Vector3d> &place);

/// Forgets what belongs to handles that are gone.
void forgetGone(BendModel &model);
/// Changes steps so that motions stay the same although the middles of handles have moved. \param before these middles,
/// by tag, before \return whether any has changed
bool keepPlaces(const BendModel &model, const std::map<vcg::fcd::Index, Eigen::Vector3d> &before,
                std::map<int, std::vector<vcg::fcd::MotionStep>> &motion);

#endif
