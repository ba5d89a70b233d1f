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
#include <vector>

/// A handle of a vertex and those beside it.
struct BendPoint {
    std::size_t slot = 0;
    double radius = 0; ///< of what it bends where nothing is marked as fixed, along the surface, world units
    bool isGrip =
        false; ///< it holds what is turned with it: half of that, and the tip beyond; else hardly more than a place

    bool operator==(const BendPoint &other) const {
        return slot == other.slot && radius == other.radius && isGrip == other.isGrip;
    }
};

/// What a person has said of a handle.
struct BendHandle {
    std::string name;                        ///< empty: by its number
    bool isHidden = false, isLocked = false; ///< neither shown; nor moved by the mouse
    std::optional<Eigen::Vector3d> pivot;    ///< where it is turned, at rest, in the world; none: see pivotOf()

    bool operator==(const BendHandle &other) const {
        return name == other.name && isHidden == other.isHidden && isLocked == other.isLocked && pivot == other.pivot;
    }
};

/// A point of the line that a layer is straightened along: on its surface, and then it moves along, or in the world.
struct BendLinePoint {
    std::array<std::size_t, 3> corner{};              ///< slots of vertices
    Eigen::Vector3d weight = Eigen::Vector3d::Zero(); ///< barycentric, of these; all 0: the point is not on the surface
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< then it is here, in the world

    bool operator==(const BendLinePoint &other) const {
        return corner == other.corner && weight == other.weight && place == other.place;
    }
};

using BendTags = std::vector<int>; ///< one per vertex slot, as the filters' tags

/// One per vertex slot: how far the mark that it is of bends what is around it where nothing is marked as fixed, as
/// BendPoint::radius; within a part of that, nothing else is held. 0: a tag of a filter, which leaves no gap.
using BendRims = std::vector<float>;

/// How far a handle bends what is around it, of the diagonal of the bounding box, until a person says otherwise.
const double usualRadius = 0.15;
const double leastRadius = 0.005, mostRadius = 4; ///< the same unit; as in the panel

/// The gap between marks, of that radius. At the usual one this is 3 % of the diagonal, about a patch's radius for 300
/// patches on a ball: less than a patch would still be a crease.
const double gapOfRadius = 0.2;

/// What is undone and redone: which vertices are held, and how the handles move. Where nothing is marked as fixed,
/// handles bend what is around them, and all else is fixed.
struct BendState {
    std::shared_ptr<const BendTags> marks; ///< null: nothing is marked
    std::map<int, BendPoint> points;       ///< by their tag
    std::shared_ptr<const BendRims> rims;  ///< of what is marked; null: none has any
    std::map<int, BendHandle> handles;     ///< by tag, where a person has said something
    std::map<int, int> rank; ///< by tag, 0 where there is none: a handle frees nothing beside what lower ranks bend
    std::map<int, std::vector<vcg::fcd::MotionStep>> motion; ///< by tag; world units
    double pose = 100;                                       ///< percent of the motions
    std::shared_ptr<const vcg::fcd::PoseSequence> poses;     ///< that have names; null: none
    std::vector<double> weights;     ///< percent of each of these, where the motions are their blend; else empty
    std::vector<BendLinePoint> line; ///< in its order
    std::size_t applies = 0;         ///< in place, since the session began: each made its shape the rest shape
    std::size_t loads = 0;           ///< of files, since then: each brought options

    bool operator==(const BendState &other) const;
};

/// What the axes are that a handle is moved along and turned about. Those of the view are the tool's.
enum class BendAxes { World, Layer, View, Surface };

/// What the panel sets.
struct BendOptions {
    double smoothness = vcg::fcd::SolverParam().smoothness;
    vcg::fcd::Falloff falloff = vcg::fcd::DeformerParam().falloff;
    bool elastic = vcg::fcd::DeformerParam().elastic;
    double rigidity = vcg::fcd::SolverParam().rigidity; ///< where it is not elastic
    double pose = 100;                                  ///< as BendState::pose
    int initialPatches = vcg::fcd::GraphParam().initialPatches;
    vcg::fcd::MappingWeights weights = vcg::fcd::DeformerParam().weights;
    int mirror = -1; ///< 0, 1, 2: what is done to one side of the middle of x, y or z is done to the other; -1: no
    BendAxes axes = BendAxes::World;
    bool stretch = false; ///< the layer's colours show how much it is stretched

    /// Whether the same marks and motions give the same shape.
    bool givesSameShape(const BendOptions &other) const {
        return smoothness == other.smoothness && falloff == other.falloff && elastic == other.elastic &&
               rigidity == other.rigidity && pose == other.pose && initialPatches == other.initialPatches &&
               weights == other.weights;
    }
};

#endif
