// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/animation_interaction.h"
#include "edit_fcd/view/trace.h"

#include <cmath>

void AnimationInteraction::prepare(const std::function<void()> &begun) {
    stage.beside(
        "Preparing the layer",
        [this](const vcg::fcd::Progress &progress) { length = stage.session->beginAnimation(progress); },
        [this, begun] {
            isReady = stage.isLive = true;
            first = stage.session->state().poses->key.front().time;
            stage.display->move();
            begun();
        },
        [this] { stage.ended(); });
}

void AnimationInteraction::show(double time) {
    try {
        stage.session->showAnimation(time - first);
    } catch (...) {
        cancel();
        throw;
    }
    stage.showVertices(false);
    stage.view->update();
}

void AnimationInteraction::leave() {
    isReady = stage.isStepWanted = false;
    stage.ended();
    if (stage.session)
        stage.session->endAnimation();
}

void AnimationInteraction::cancel() {
    leave();
    if (stage.layer())
        stage.comeToRest();
}

void PlayInteraction::begin() {
    prepare([this] {
        stage.every(frames, [this] {
            if (!stage.isPainted) // the last frame
                return;
            if (!stage.layer()) {
                cancel();
                return;
            }
            const double time = std::fmod(double(since.nsecsElapsed()) / 1e9, length);
            stage.panel->poses().timeline().showTime(first + time);
            show(first + time);
            trace("frame: at %.3f s", time);
        });
        frames.start(5);
        since.start();
        stage.panel->poses().showPlaying(true);
        stage.refresh();
    });
}

void PlayInteraction::cancel() {
    frames.stop();
    if (stage.panel)
        stage.panel->poses().showPlaying(false);
    AnimationInteraction::cancel();
}

void ScrubInteraction::begin(double time) {
    asked = time;
    prepare([this] {
        to(asked);
        if (isReleased)
            end();
    });
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
    show(asked);
    trace("scrub: at %.3f s", asked);
}

void ScrubInteraction::end() {
    isReleased = true;
    if (!isReady)
        return;
    leave();
    if (!stage.layer())
        return;
    stage.display->rest();
    kept(asked);
}

QString ScrubInteraction::text() const {
    return "Shows " + stage.panel->poses().timeline().textOf(asked) + ". Esc: as before.";
}
