// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_LIMB_TURN_H
#define FCD_BEND_LIMB_TURN_H

#include "edit_fcd/view/camera.h"

#include <optional>

/// How a limb turns so that a place of it follows the mouse: as one piece, or as a chain of two bones, which bends at
/// the joint between. It gets neither longer nor shorter, so that nothing is squeezed; near the joint, where it would
/// have to, it turns out of the view's plane. What it does is continuous along the way of the mouse. World units.
class LimbTurn {
  public:
    /// \param root the joint at which all of it turns \param middle the one between, of a chain \param held what
    /// follows; all of these as they are when it begins
    LimbTurn(const Eigen::Vector3d &root, const std::optional<Eigen::Vector3d> &middle, const Eigen::Vector3d &held);

    /// \param from where the mouse was when it began, window \param window where it is
    void moveTo(const Camera &view, const Eigen::Vector3d &from, const Eigen::Vector3d &window);
    /// What lies beyond the middle joint turns about that first; none of one piece.
    Eigen::AngleAxisd bend() const;
    /// Then all of it turns about the root.
    Eigen::AngleAxisd turn() const;

    bool isOf(const Eigen::Vector3d &itsRoot, const std::optional<Eigen::Vector3d> &itsMiddle) const {
        return root == itsRoot && middle == itsMiddle;
    }

  private:
    Eigen::Vector3d aimAt(const Camera &view, const Eigen::Vector3d &from, const Eigen::Vector3d &window) const;
    double bent() const;
    double lengthAt(double angle) const;
    double aside(double angle) const;

    Eigen::Vector3d root, held;
    std::optional<Eigen::Vector3d> middle;
    double length, nearest;       ///< from root to held: at most, and where it leaves the view's plane
    double first = 0, second = 0; ///< lengths of the bones of a chain
    double begun = 0, most = 0;   ///< by so much a chain is bent as it begins, and at most; 0: straight
    Eigen::Vector3d axis = Eigen::Vector3d::Zero(); ///< that it bends about; 0: not known yet

    Eigen::Vector3d window = Eigen::Vector3d::Zero(), aim = Eigen::Vector3d::Zero(); ///< now; no aim: not moved yet
    double aimed = 0;                                                                ///< length of the first aim
    Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();                      ///< from the first aim to now
};

#endif
