// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_HANDLES_H
#define FCD_BEND_HANDLES_H

#include <vcg_ext/handles/motion_text.h> // before Qt

#include "edit_fcd/bend/model/reach.h"

#include <layer_fcd/bend_state.h>

#include <set>
#include <string>
#include <vector>

// --- what a state has of one handle, by its tag ---

/// The value of a key, or else the usual one.
template <class Map>
const typename Map::mapped_type &valueOr(const Map &map, const typename Map::key_type &key) {
    static const typename Map::mapped_type usual{};
    const auto found = map.find(key);
    return found == map.end() ? usual : found->second;
}

const BendHandle &handleOf(const BendState &state, int tag);
void setHandle(BendState &state, int tag, BendHandle handle);
std::string nameOf(const BendState &state, int tag); ///< for the user
/// The steps of its motion; empty: at rest.
const std::vector<vcg::fcd::MotionStep> &motionOf(const BendState &state, int tag);
/// Its steps as text for "Motions as text"; empty: at rest.
std::string motionTextOf(const BendState &state, int tag);
/// The same in a few words. The last step is first, since a list may cut off the rest. The degrees of a turn are about
/// the axis whose largest coordinate is positive: two handles that turn together show the same sign.
std::string shortMotionOf(const BendState &state, int tag);
int rankOf(const BendState &state, int tag);
/// The rank of a new handle: above those of moved handles, so that these keep what they bend.
int rankOfNew(const BendState &state);
bool isGrip(const BendState &state, int tag);
/// Whether no mark holds a vertex.
bool isFree(const BendState &state, std::size_t slot);
/// The motions, for a change by hand: ends a blend of poses.
BendMotions &motionByHand(BendState &state);

// --- marks, and the radius within which each bends the surface if nothing is marked as fixed; \a diagonal is that of
// the bounding box; radii, rims and the diagonal are in world units ---

/// The radius of a marked vertex.
double rimAt(const BendState &state, std::size_t slot, double diagonal);
/// The radius of a handle; of a marked one, that of its first vertex.
double radiusOf(const BendState &state, int tag, double diagonal);
/// \param vertexSlots number of all vertices
void setRims(BendState &state, const std::vector<std::size_t> &vertices, double radius, std::size_t vertexSlots);
/// Sets the radius, and the lowest rank, so that no gap makes the handle bend less.
void setRadiusOf(BendState &state, int tag, double radius);

/// Keeps marks apart: frees what else is held within the gap of a mark. Fixed vertices yield to handles, and older
/// handles to newer ones, within the larger gap of the two. \param made in: the marks, out: tags
void freeGaps(const BendState &state, BendReach &reach, BendTags &made);

/// Gives the state new marks, and removes points whose vertex they take. \param marked the vertices of the new marks
/// \param rim their radius \param known handles before \return tags of the new handles
std::set<int> takeMarks(BendState &state, const BendTags &marks, const std::vector<std::size_t> &marked, double rim,
                        const std::map<vcg::fcd::Index, Eigen::Vector3d> &known);
/// Frees what a handle holds.
void freeHandle(BendState &state, int tag);

// --- steps of motions ---

/// The steps of a motion, up to rounding. \param center of the handle at rest, world
std::vector<vcg::fcd::MotionStep> stepsOf(const vcg::fcd::Motion &motion, const Eigen::Vector3d &center);

/// Sets the places of turns and scalings explicitly; by default, they are the middle of the handle. \param center of
/// the handle at rest, world \return whether any step has changed
bool setPlaces(std::vector<vcg::fcd::MotionStep> &steps, const Eigen::Vector3d &center);

/// The step on the other side of a mirror; exact if the layer's matrix keeps angles.
vcg::fcd::MotionStep mirroredStep(const vcg::fcd::MotionStep &step, const Eigen::Affine3d &mirror);

/// Steps of the rigid motion that takes points nearest to others, in few digits; none if they hardly move.
/// \param middle pivot of the turn \param least smallest move that counts
std::vector<vcg::fcd::MotionStep> rigidSteps(const Eigen::Matrix3Xd &from, const Eigen::Matrix3Xd &to,
                                             const Eigen::Vector3d &middle, double least);

/// A number with so many digits.
std::string inDigits(double x, int digits);
/// Rounds a number to few digits, as people write it.
double inFewDigits(double x);
Eigen::Vector3d inFewDigits(const Eigen::Vector3d &v);

#endif
