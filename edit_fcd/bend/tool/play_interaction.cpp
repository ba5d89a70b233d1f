// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/play_interaction.h"

#include "edit_fcd/view/trace.h"

#include <cmath>

void PlayInteraction::begin() {
    stage.beside(
        "Preparing the layer",
        [this](const vcg::fcd::Progress &progress) { length = stage.session->beginAnimation(progress); },
        [this] {
            stage.display->move();
            stage.isLive = true;
            stage.every(frames, [this] {
                try {
                    show();
                } catch (...) {
                    cancel();
                    throw;
                }
            });
            frames.start(5);
            since.start();
            stage.panel->poses().showPlaying(true);
            stage.refresh();
        },
        [this] { stage.ended(); });
}

/// Shows the next frame, once the last one is painted.
void PlayInteraction::show() {
    if (!stage.isPainted)
        return;
    if (!stage.layer()) {
        cancel();
        return;
    }
    const double time = std::fmod(double(since.nsecsElapsed()) / 1e9, length);
    stage.session->showAnimation(time);
    stage.panel->poses().timeline().showTime(stage.session->state().poses->key.front().time + time);
    stage.showVertices(false);
    stage.view->update();
    trace("frame: at %.3f s", time);
}

void PlayInteraction::cancel() {
    frames.stop();
    stage.ended();
    if (stage.session)
        stage.session->endAnimation();
    if (stage.panel)
        stage.panel->poses().showPlaying(false);
    if (stage.layer())
        stage.comeToRest();
}
