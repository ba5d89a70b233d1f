// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_STATE_H
#define FCD_BEND_STATE_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/deformer.h>
#include <vcg_ext/handles/motion_text.h>
#include <vcg_ext/sequence/pose_sequence.h>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// A handle around a vertex.
struct BendPoint {
    std::size_t slot = 0;
    double radius = 0;   ///< reach if nothing is marked as fixed: how far from it the surface bends, world units
    bool isGrip = false; ///< it can turn: holds its core (BendExtent) and the tip beyond; else only a spot

    bool operator==(const BendPoint &o) const { return slot == o.slot && radius == o.radius && isGrip == o.isGrip; }
};

/// What a user has set for a handle.
struct BendHandle {
    std::string name;                        ///< empty: by its number
    bool isHidden = false, isLocked = false; ///< not shown; not moved by the mouse
    std::optional<Eigen::Vector3d> pivot;    ///< at rest, world units; none: see pivotOf()

    bool operator==(const BendHandle &o) const {
        return name == o.name && isHidden == o.isHidden && isLocked == o.isLocked && pivot == o.pivot;
    }
};

/// A point of the line that a layer is straightened along: on its surface, which it follows, or in the world.
struct BendLinePoint {
    std::array<std::size_t, 3> corner{};              ///< slots of vertices
    Eigen::Vector3d weight = Eigen::Vector3d::Zero(); ///< barycentric, of these; all 0: the point is not on the surface
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< its position then, world units

    bool operator==(const BendLinePoint &o) const {
        return corner == o.corner && weight == o.weight && place == o.place;
    }
};

using BendTags = std::vector<int>; ///< one per vertex slot, as the filters' tags

/// One per vertex slot: the reach of its mark, as BendPoint::radius. Within a part of it (gapOfRadius), nothing else is
/// held. 0: a tag of a filter, which leaves no gap.
using BendRims = std::vector<float>;

/// The reach of a new handle, over the diagonal of the bounding box.
const double usualRadius = 0.15;
const double leastRadius = 0.005, mostRadius = 4; ///< the same unit; as in the panel

/// The gap between marks, over the reach. At the usual reach this is 3 % of the diagonal, about a patch's radius for
/// 300 patches on a ball: less than a patch would show as a crease.
const double gapOfRadius = 0.2;

/// The steps of the handles' motions, by tag.
using BendMotions = std::map<int, std::vector<vcg::fcd::MotionStep>>;

/// What undo and redo restore: which vertices are held, and how the handles move. If nothing is marked as fixed,
/// handles bend the surface within their reach, and all else is fixed.
struct BendState {
    std::shared_ptr<const BendTags> marks; ///< null: nothing is marked
    std::map<int, BendPoint> points;       ///< by their tag
    std::shared_ptr<const BendRims> rims;  ///< of the marks; null: 0 everywhere
    std::map<int, BendHandle> handles;     ///< by tag, if a user has set something
    std::map<int, int> rank;               ///< by tag, else 0: a gap keeps a handle from surface that lower ranks bend
    BendMotions motion;                    ///< world units
    double pose = 100;                     ///< percent of the motions
    std::shared_ptr<const vcg::fcd::PoseSequence> poses; ///< poses with names; null: none
    std::vector<double> weights;     ///< percent of each of these, if the motions are their blend; else empty
    std::vector<BendLinePoint> line; ///< in its order
    std::size_t applies = 0;         ///< number since the tool started: each made its shape the rest shape
    std::size_t loads = 0;           ///< number of files since then: each brought options

    bool operator==(const BendState &o) const {
        return applies == o.applies && loads == o.loads && rims == o.rims && marks == o.marks && points == o.points &&
               handles == o.handles && rank == o.rank && pose == o.pose && poses == o.poses && weights == o.weights &&
               line == o.line && motion == o.motion;
    }
};

/// The axes that a handle is moved along and turned about.
enum class BendAxes { World, Layer, View, Surface };

/// The options of the panel.
struct BendOptions {
    double smoothness = vcg::fcd::SolverParam().smoothness;
    vcg::fcd::Falloff falloff = vcg::fcd::DeformerParam().falloff;
    bool elastic = vcg::fcd::DeformerParam().elastic;
    double rigidity = vcg::fcd::SolverParam().rigidity; ///< if it is not elastic
    double pose = 100;                                  ///< as BendState::pose
    int initialPatches = vcg::fcd::GraphParam().initialPatches;
    vcg::fcd::MappingWeights weights = vcg::fcd::DeformerParam().weights;
    int mirror = -1; ///< 0, 1, 2: changes on one side are mirrored at the middle of x, y or z; -1: no mirror
    BendAxes axes = BendAxes::World;
    bool stretch = false; ///< the layer's colours show its stretch

    /// Whether the same marks and motions give the same shape.
    bool givesSameShape(const BendOptions &o) const {
        return smoothness == o.smoothness && falloff == o.falloff && elastic == o.elastic && rigidity == o.rigidity &&
               pose == o.pose && initialPatches == o.initialPatches && weights == o.weights;
    }
};

/// \file
/// The settings of FCD: Bend for a layer as a text that people can read, a line each.
///
///     FCD bend 1
///     smoothness S            options, as BendOptions has them; enumerations by their numbers
///     falloff N               left out if it is smooth
///     elastic 1               left out if it is not
///     rigidity R              left out if it is 1
///     detail N
///     distances N
///     symmetry N
///     axes N
///     pose PERCENT
///     point TAG VERTEX RADIUS [grip]
///     rank TAG RANK
///     name TAG ...            to the end of the line
///     hidden TAG
///     locked TAG
///     pivot TAG X Y Z
///     motions ...             as ReadMotionText reads them
///     mark TAG FIRST LAST FIRST LAST ...          of these vertices
///     rim RADIUS FIRST LAST FIRST LAST ...
///     weights PERCENT ...     of each pose that has a name
///     line A B C WA WB WC X Y Z                   of each point: BendLinePoint's corners, weights and place
///
/// Lines after the first may be left out. Live vertices are numbered from 0, as programs do that open the layer's file.

/// The text of all but poses with names, applies and loads; numbers are to the bit.
/// \param live slots of the live vertices, ascending
std::string bendText(const BendState &state, const BendOptions &options, const std::vector<std::size_t> &live);

/// Reads such a text. \param name of the text, for messages \param vertexSlots number of all slots
/// \throw vcg::fcd::BadInput what is wrong, with the line
std::pair<BendState, BendOptions> readBendText(const std::string &text, const std::string &name,
                                               const std::vector<std::size_t> &live, std::size_t vertexSlots);

#endif
