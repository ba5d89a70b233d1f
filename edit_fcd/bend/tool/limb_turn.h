// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_LIMB_TURN_H
#define FCD_BEND_LIMB_TURN_H

#include "edit_fcd/view/camera.h"

#include <optional>

/// Turns a limb so that a point of it follows the mouse: as one piece, or as a chain of two bones that bends at the
/// joint between. The limb keeps its length, so that nothing is squeezed; if the mouse comes near the joint, the limb
/// turns out of the view plane. It moves continuously with the mouse. World units.
class LimbTurn {
  public:
    /// \param root the joint at which the whole limb turns
    /// \param middle of a chain, the joint between \param held the point that follows; all as at the begin
    LimbTurn(const Eigen::Vector3d &root, const std::optional<Eigen::Vector3d> &middle, const Eigen::Vector3d &held);

    /// \param from the mouse at the begin, window \param window the mouse now
    void moveTo(const Camera &view, const Eigen::Vector3d &from, const Eigen::Vector3d &window);
    /// First, what lies beyond the middle joint turns about that by this; the identity for one piece.
    Eigen::AngleAxisd bend() const;
    /// Then the whole limb turns about the root by this.
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
    double length, nearest;       ///< from root to held: the largest, and that below which it leaves the view plane
    double first = 0, second = 0; ///< lengths of the bones of a chain
    double begun = 0, most = 0;   ///< bend of a chain at the begin, and the largest, radians; 0: straight
    Eigen::Vector3d axis = Eigen::Vector3d::Zero(); ///< about which a chain bends; 0: not known yet

    Eigen::Vector3d window = Eigen::Vector3d::Zero(), aim = Eigen::Vector3d::Zero(); ///< now; aim 0: not moved yet
    double aimed = 0;                                                                ///< length of the first aim
    Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();                      ///< from the first aim to now
};

#endif
