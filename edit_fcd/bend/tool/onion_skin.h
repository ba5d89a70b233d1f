// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_ONION_SKIN_H
#define FCD_BEND_ONION_SKIN_H

#include "edit_fcd/bend/model/session.h" // before Qt

#include "edit_fcd/kit/job_runner.h"
#include "edit_fcd/view/layer_drawing.h"

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include <QObject>

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
