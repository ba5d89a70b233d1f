// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MOTION_TEXT_H
#define VCG_FCD_MOTION_TEXT_H

#include <vcg_ext/handles/handles.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace vcg::fcd {

/// One step of a motion, world units.
struct MotionStep {
    enum Kind { Translation, Rotation, Scaling, Matrix };

    Kind kind = Translation;
    Eigen::Vector3d vector = Eigen::Vector3d::Zero(); ///< translation; axis, any length but 0; or factors, > 0
    double degrees = 0; ///< Rotation: any angle, counterclockwise if the axis points at you
    /// Rotation, Scaling: the pivot; none: the handle's barycentre.
    std::optional<Eigen::Vector3d> about = std::nullopt;
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity(); ///< Matrix: affine

    bool operator==(const MotionStep &o) const {
        return kind == o.kind && vector == o.vector && degrees == o.degrees && about == o.about && matrix == o.matrix;
    }
    static MotionStep Translate(const Eigen::Vector3d &by) { return {Translation, by}; }
    static MotionStep Rotate(const Eigen::Vector3d &axis, double degrees) { return {Rotation, axis, degrees}; }
    static MotionStep Scale(const Eigen::Vector3d &factors) { return {Scaling, factors}; }
    static MotionStep Affine(const Eigen::Matrix4d &matrix) {
        return {Matrix, Eigen::Vector3d::Zero(), 0, std::nullopt, matrix};
    }
};

/// Reads a text that says how handles move. \return the steps of each handle, by tag; none for an empty text
///
///     text   = [ clause { ";" clause } [ ";" ] ]
///     clause = tag ":" step { step }
///     step   = "translate" x y z
///            | "rotate" ax ay az degrees [ "about" x y z ]
///            | "scale" s [ "about" x y z ]
///            | "scale" sx sy sz [ "about" x y z ]
///            | "matrix" m11 m12 m13 m14 m21 ... m44
///
/// For example `2: rotate 0 0 1 135 about 0 0 0 translate 0 0 5; 3: translate 1 0 0`. Steps are applied in the order
/// written. Tags are whole numbers >= 2, each at most once. The axis of a rotation has any length but 0; the angle is
/// counterclockwise if the axis points at you. Factors are > 0. A matrix multiplies column vectors; it is written row
/// by row, and its last row is 0 0 0 1. "about" gives the pivot of rotate and scale; without it, that is the barycentre
/// of the handle after the steps before. Case does not matter. Commas may separate the numbers of a step. Numbers have
/// a decimal point, whatever the locale.
///
/// \param name of the text, for messages
/// \throw BadInput with the character (from 1), what was found there and what was expected
std::map<int, std::vector<MotionStep>> ReadMotionText(const std::string &text, const std::string &name = "transforms");

/// The text that ReadMotionText reads as \p motion, to the bit, in the fewest digits. Handles without a step are left
/// out.
std::string WriteMotionText(const std::map<int, std::vector<MotionStep>> &motion);

/// The motion of a handle by \p steps. If all rotations have one axis, or opposite ones, their angles add up to the
/// motion's turn, unless the other steps change its rotation; otherwise the motion has no turn.
/// \param barycenter mean of the handle's vertices at rest, world units
/// \throw BadInput the motion is not finite, mirrors or flattens
Motion ToMotion(const std::vector<MotionStep> &steps, const Eigen::Vector3d &barycenter);

} // namespace vcg::fcd

#endif
