// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_PREVIEWS_H
#define FCD_BEND_PREVIEWS_H

#include "edit_fcd/bend/model/session.h" // before Qt
#include "edit_fcd/kit/job_runner.h"
#include "edit_fcd/view/layer_drawing.h"

#include <layer_fcd/layer_straightener.h> // before Qt

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <QObject>

/// Finds the line along which a layer will be straightened: if wanted, through the middles of the surface's
/// cross-sections. It works in the background, on a copy of the surface.
class BendLinePreview : public QObject {
  public:
    /// What was found.
    struct Found {
        Eigen::Matrix3Xd points;           ///< 3 x n, of the line that is used, world
        Eigen::Matrix3Xd path;             ///< 3 x m, closer points along it, for drawing, world
        double length = 0;                 ///< world units
        vcg::fcd::StraightenReport report; ///< of LineOf
        std::string error;                 ///< why there is no line; else empty
    };

    /// \param changed called in the window's thread when something was found; throws nothing
    explicit BendLinePreview(std::function<void()> changed) : changed(std::move(changed)) {}

    /// Begins to find an unknown line of \p goal on the surface of \p layer. With no two points, only prepares that.
    /// \param shape number that identifies the surface \throw vcg::fcd::Error as LineSurface
    void look(const MeshModel &layer, std::uint64_t shape, const vcg::fcd::LineGoal &goal,
              const vcg::fcd::StraightenParam &param);
    /// Stops. \return what is known of the line of \p goal
    KnownLine stop(const vcg::fcd::LineGoal &goal);

    /// Whether last() is the answer to the last question.
    bool isFound() const { return isLast; }
    /// The last answer, maybe of an earlier line.
    const Found &last() const { return found; }
    double milliseconds() const { return took; } ///< the time to find it

  private:
    struct Search {
        vcg::fcd::LineGoal goal;
        std::shared_ptr<LineSurface> surface; ///< the work uses it while it runs
        Found found;
        vcg::fcd::Stopwatch watch;
    };
    void begin();
    void ended(const std::exception_ptr &thrown);

    std::function<void()> changed;
    vcg::fcd::LineGoal asked;
    vcg::fcd::StraightenParam bend;
    std::uint64_t shapeOfSurface = 0;
    std::shared_ptr<LineSurface> surface; ///< as read; the first work that is not stopped prepares it
    std::shared_ptr<Search> search;       ///< the running or last one
    Found found;
    bool isLast = false;
    double took = 0;
    JobRunner work{this}; ///< last member: it ends before all else
};

/// Shows the key frames before and after the shown time as ghosts. Their shapes are computed in the background, and
/// kept until handles, poses or the rest shape change. Until new ones are found, the last ones are shown.
class BendOnionSkin : public QObject {
  public:
    /// \param changed called when other ghosts are to be drawn; throws nothing
    explicit BendOnionSkin(std::function<void()> changed) : changed(std::move(changed)) {}

    /// Shows the key frames of ghostFrames() for a time, once they are found.
    void look(BendSession &session, double time, bool isShown);
    /// Hides all, and stops the search.
    void hide();
    /// Stops the search, since something else needs the time. Ghosts stay.
    void pause();
    /// \pre as LayerGhost::draw()
    void draw(const CMeshO &mesh);

  private:
    using Shape = std::shared_ptr<const std::vector<float>>; ///< null: it cannot be computed
    struct Search;

    void show(LayerGhost &ghost, const std::vector<double> &weight);
    void showWanted();
    void begin();
    void ended(const std::exception_ptr &thrown);

    std::function<void()> changed;
    GhostFrames wanted;
    BendSession::BlendSource source; ///< of the known shapes
    std::shared_ptr<BlendShapes> shapes;
    std::shared_ptr<const GhostParts> parts; ///< null: none yet
    std::map<std::vector<double>, Shape> known;
    std::shared_ptr<Search> search;                                 ///< the running one
    LayerGhost before{{40, 140, 60, 90}}, after{{60, 70, 210, 90}}; ///< green and blue, as in Blender
    JobRunner work{this};
};

#endif
