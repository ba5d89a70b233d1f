// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_DRAG_H
#define FCD_BEND_DRAG_H

#include <vcg_ext/handles/motion_text.h> // before Qt

#include "edit_fcd/bend/tool/limb_turn.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

/// A handle that is being moved: what a way of the mouse, or a typed number, makes of its motion.
struct BendDrag {
    enum Kind { Move, Turn, Scale, Limb }; ///< Limb: turned so that a place of it follows the mouse

    using Steps = std::vector<vcg::fcd::MotionStep>;

    int tag = 0;
    Kind kind = Move;
    int axis = -1;      ///< -1: in the view plane, or about the direction of the view; 0, 1, 2: of the axes
    bool modal = false; ///< begun by a key: the mouse moves it without a button
    bool snap = false;  ///< in steps
    std::optional<Eigen::Vector3d> onto; ///< where a move leads the pivot, world; none: where the mouse is
    std::string typed;                   ///< a number
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity(); ///< of length 1, as columns, world
    Eigen::Vector3d pivot, from;  ///< where the handle is turned as it begins, world, and where the mouse was, window
    Eigen::Vector3d held;         ///< of a limb: where what follows the mouse was as it began, world
    bool isAbout = false;         ///< the pivot is not the handle's middle
    double angle = 0;             ///< that the mouse went about the pivot, degrees
    Eigen::Vector3d last;         ///< where the mouse is, window
    Steps begin;                  ///< the motion before it
    std::map<int, Steps> carried; ///< by tag, the motions before it of the handles that go along

    /// The joint of a limb before that of the handle: the limb bends at the handle's, and all of it turns at this one.
    struct Before {
        Eigen::Vector3d pivot;        ///< world
        std::map<int, Steps> carried; ///< the motions before it of its handle, and of what goes along with that alone
    };
    std::optional<Before> before; ///< none: it turns at the handle's

    void moveTo(const Camera &view, const Eigen::Vector3d &window);
    /// What it adds to the motion, none where that is nothing.
    std::optional<vcg::fcd::MotionStep> step(const Camera &view) const;
    /// All of that: a limb of two joints is bent, and then turned.
    Steps steps(const Camera &view) const;
    /// Whether what was typed is no number, so that nothing moves.
    bool isRefused() const;
    /// What it does now, or what can be done where nothing was yet, as a person reads it.
    std::string text(const Camera &view) const;
    /// The motions with that, by tag. Numbers are as people would write them.
    std::map<int, Steps> motions(const Camera &view) const;

  private:
    Kind does() const { return kind == Limb && (axis >= 0 || !typed.empty()) ? Turn : kind; }
    std::optional<vcg::fcd::MotionStep> turnOf(const Eigen::AngleAxisd &turn, const Eigen::Vector3d &about) const;
    bool readTyped(double &number) const;
    bool isBeginning(const Camera &view) const;

    std::optional<LimbTurn> limb; ///< since the mouse has moved
};

#endif
