// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_DRAG_H
#define FCD_BEND_DRAG_H

#include <vcg_ext/handles/motion_text.h> // before Qt

#include "edit_fcd/view/camera.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

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

    bool isOf(const Eigen::Vector3d &joint, const std::optional<Eigen::Vector3d> &between) const {
        return root == joint && middle == between;
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

/// A handle that is being moved: turns moves of the mouse, or a typed number, into its motion.
struct BendDrag {
    enum Kind { Move, Turn, Scale, Limb }; ///< Limb: turns so that a point of it follows the mouse

    using Steps = std::vector<vcg::fcd::MotionStep>;

    int tag = 0;
    Kind kind = Move;
    int axis = -1;                       ///< 0, 1, 2: of axes; -1: in the view plane, or about the view direction
    bool modal = false;                  ///< begun by a key: follows the mouse without a button
    bool snap = false;                   ///< in steps
    std::optional<Eigen::Vector3d> onto; ///< target of a move for the pivot, world; none: the mouse
    std::string typed;                   ///< a number
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity(); ///< of length 1, as columns, world
    Eigen::Vector3d pivot, from;                        ///< at the begin: the pivot, world, and the mouse, window
    Eigen::Vector3d held;         ///< of a limb, at the begin: the point that follows the mouse, world
    bool isAbout = false;         ///< the pivot is another point than the handle's middle
    double angle = 0;             ///< by which the mouse went around the pivot, degrees
    Eigen::Vector3d last;         ///< the mouse now, window
    Steps begin;                  ///< the handle's motion before
    std::map<int, Steps> carried; ///< by tag: motions before, of handles that move along

    /// The joint before that of the handle. The limb bends at the handle's joint, and all of it turns at this one.
    struct Before {
        Eigen::Vector3d pivot; ///< world
        std::map<int, Steps>
            carried; ///< by tag: motions before, of its handle, and of those that move along with it only
    };
    std::optional<Before> before; ///< none: it only turns at the handle's joint

    void moveTo(const Camera &view, const Eigen::Vector3d &window);
    /// The step that is added to the handle's motion; none if it is nothing.
    std::optional<vcg::fcd::MotionStep> step(const Camera &view) const;
    /// All such steps: a limb of two joints first bends, and then turns.
    Steps steps(const Camera &view) const;
    /// Whether the typed text is no number, so that nothing moves.
    bool isRefused() const;
    /// A text for the user: what it does now, or what can be done.
    std::string text(const Camera &view) const;
    /// The motions with these steps, by tag; numbers in few digits.
    std::map<int, Steps> motions(const Camera &view) const;

  private:
    Kind does() const { return kind == Limb && (axis >= 0 || !typed.empty()) ? Turn : kind; }
    std::optional<vcg::fcd::MotionStep> turnOf(const Eigen::AngleAxisd &turn, const Eigen::Vector3d &about) const;
    bool readTyped(double &number) const;
    bool isBeginning(const Camera &view) const;

    std::optional<LimbTurn> limb; ///< none before the mouse has moved
};

#endif
