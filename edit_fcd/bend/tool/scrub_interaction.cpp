// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/scrub_interaction.h"

#include "edit_fcd/view/trace.h"

void ScrubInteraction::begin(double time) {
    asked = time;
    stage.beside(
        "Preparing the layer", [this](const vcg::fcd::Progress &progress) { stage.session->beginAnimation(progress); },
        [this] {
            isReady = stage.isLive = true;
            first = stage.session->state().poses->key.front().time;
            stage.display->move();
            to(asked);
            if (isReleased)
                end();
        },
        [this] { stage.ended(); });
}

void ScrubInteraction::to(double time) {
    asked = time;
    if (!isReady)
        return;
    stage.panel->poses().timeline().showTime(time);
    stage.refresh();
    stage.requestStep();
}

void ScrubInteraction::step() {
    if (!isReady || !stage.layer())
        return;
    try {
        stage.session->showAnimation(asked - first);
    } catch (...) {
        cancel();
        throw;
    }
    stage.showVertices(false);
    stage.view->update();
    trace("scrub: at %.3f s", asked);
}

void ScrubInteraction::stop() {
    isReady = stage.isStepWanted = false;
    stage.ended();
    if (stage.session)
        stage.session->endAnimation();
}

void ScrubInteraction::end() {
    isReleased = true;
    if (!isReady)
        return;
    stop();
    if (!stage.layer())
        return;
    stage.display->rest();
    kept(asked);
}

void ScrubInteraction::cancel() {
    stop();
    if (stage.layer())
        stage.comeToRest();
}

QString ScrubInteraction::text() const {
    return "Shows " + stage.panel->poses().timeline().textOf(asked) + ". Esc: as before.";
}
