// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include <cstdio>
#include <cstdlib>

// Work on a large layer, beside the window.

/// Does work on the session: at once, or, with a large layer, beside the window. \param what the panel says meanwhile
/// \param stopped called instead of \p done when it is cancelled, or fails; may be empty
void BendTool::beside(const QString &what, const Job::Work &work, std::function<void()> done,
                      std::function<void()> stopped) {
    preparingWhat = what;
    whenPrepared = std::move(done);
    whenStopped = std::move(stopped);
    session->beginBeside();
    if (model->cm.vn <= preparedAtOnce) {
        try {
            work({});
        } catch (...) {
            stopPreparing();
            throw;
        }
        whenDone();
        return;
    }
    const auto ended = [this, number = ++preparingNumber] {
        if (!preparing || number != preparingNumber)
            return; // it was stopped
        guarded([&] {
            try {
                preparing->finish();
                preparing.reset();
            } catch (const vcg::fcd::Cancelled &) {
                stopPreparing();
                return;
            } catch (...) {
                stopPreparing();
                throw;
            }
            restFromPreparing();
            if (!layer() || session->isUpToDate()) {
                whenDone();
                return;
            }
            stopPreparing(); // what something else has made of the layer stays
            say("Something else has changed the layer meanwhile: what was begun is not done.", true);
        });
    };
    preparing =
        std::make_unique<Job>(work, [this, ended] { QMetaObject::invokeMethod(this, ended, Qt::QueuedConnection); });
    view->setCursor(Qt::BusyCursor);
    every(preparingTimer, [this] { refresh(); });
    preparingTimer.start(100);
    refresh();
    if (std::getenv("FCD_TRACE"))
        std::fprintf(stderr, "FCD trace: answer: %d vertices, since the event %.1f ms\n", model->cm.vn,
                     sinceEvent.isValid() ? double(sinceEvent.nsecsElapsed()) / 1e6 : 0.0);
}

void BendTool::whenDone() {
    if (!layer())
        return;
    session->endBeside();
    const std::function<void()> done = std::move(whenPrepared); // which may begin other work
    done();
}

/// The window looks as if nothing was being done.
void BendTool::restFromPreparing() {
    preparingTimer.stop();
    if (view)
        view->unsetCursor();
}

/// What has been begun is taken back.
void BendTool::stopPreparing() {
    const bool wasBeside = preparing != nullptr;
    preparing.reset(); // waits for it
    if (wasBeside)
        restFromPreparing();
    const std::function<void()> stopped = std::move(whenStopped);
    if (!layer())
        return;
    session->endBeside();
    if (stopped)
        stopped();
    refresh();
    view->update();
}
