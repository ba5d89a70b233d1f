// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_LINE_PREVIEW_H
#define FCD_BEND_LINE_PREVIEW_H

#include <layer_fcd/layer_straightener.h> // before Qt

#include "edit_fcd/kit/job_runner.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <QObject>

/// The line that a layer is going to be straightened along, as it is really used: through the middles of the surface's
/// cross-sections, where that is wanted. These are found beside the window, which only reads the surface, once.
class BendLinePreview : public QObject {
  public:
    /// What was found.
    struct Found {
        Eigen::Matrix3Xd points;           ///< 3 x n, of the line that is used, in the world
        Eigen::Matrix3Xd way;              ///< 3 x m, places of it that are close enough together to be drawn
        double length = 0;                 ///< world units
        vcg::fcd::StraightenReport report; ///< what LineOf has told
        std::string error;                 ///< why there is none; else empty
    };

    /// \param changed called when something was found, by the thread of the window; throws nothing
    explicit BendLinePreview(std::function<void()> changed) : changed(std::move(changed)) {}

    /// Begins to look for the line of \p goal on the surface that \p layer has now, if that is not what is known. With
    /// one point or none, the surface is made ready. \param shape a number that tells that surface from others
    /// \throw vcg::fcd::Error as LineSurface
    void look(const MeshModel &layer, std::uint64_t shape, const vcg::fcd::LineGoal &goal,
              const vcg::fcd::StraightenParam &param);
    /// Stops to look. \return what is known of the line of \p goal
    KnownLine stop(const vcg::fcd::LineGoal &goal);

    /// Whether last() is of what was asked for last.
    bool isFound() const { return isLast; }
    /// What was found last, maybe of a line before.
    const Found &last() const { return found; }
    double milliseconds() const { return took; } ///< that finding it took

  private:
    struct Search {
        vcg::fcd::LineGoal goal;
        std::shared_ptr<LineSurface> surface; ///< in use by the work as long as that runs
        Found found;
        vcg::fcd::Stopwatch watch;
    };
    void begin();
    void ended(const std::exception_ptr &thrown);

    std::function<void()> changed;
    vcg::fcd::LineGoal asked;
    vcg::fcd::StraightenParam bend;
    std::uint64_t shapeOfSurface = 0;
    std::shared_ptr<LineSurface> surface; ///< as it was read; prepared by the first work that is not stopped before
    std::shared_ptr<Search> search;       ///< that runs, or ran last
    Found found;
    bool isLast = false;
    double took = 0;
    JobRunner work{this}; ///< last: it ends before all else
};

#endif
