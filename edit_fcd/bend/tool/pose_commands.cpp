// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include "edit_fcd/bend/panel/export_dialog.h" // before Qt

#include "edit_fcd/bend/model/named_poses.h"
#include "edit_fcd/bend/tool/interactions.h"

#include <layer_fcd/layer_labels.h>
#include <layer_fcd/layer_sequence.h>
#include <layer_fcd/save_files.h>

#include <algorithm>

#include <QMessageBox>

// The panel's commands for named poses.

void BendTool::connectPoses() {
    BendPoseBox *box = &panel->poses();
    when(box, &BendPoseBox::command, [this](int which) { onPoseCommand(which); });
    const BendPoseList *list = &box->list();
    when(list, &BendPoseList::begins, [this] {
        if (session && !drag() && !preparing)
            session->change();
    });
    when(list, &BendPoseList::weighted, [this](int row, double percent) {
        changePose(row, [&] {
            std::vector<double> weights = weightsOfPoses(session->state());
            weights[std::size_t(row)] = percent;
            showBlend(weights);
        });
    });
    when(list, &BendPoseList::chosen, [this](int row) {
        changePose(row, [&] {
            session->change();
            showBlend(aloneOf(session->state().poses->pose.size(), std::size_t(row)));
        });
    });
    when(list, &BendPoseList::renamed, [this](int row, const QString &name) {
        later([=] { // after the list's own events: this may ask the user
            changePose(row, [&] { renamePose(std::size_t(row), name.trimmed().toStdString()); });
        });
    });
    when(list, &BendPoseList::removed, [this](int row) {
        changePose(row, [&] {
            session->change();
            session->removePose(std::size_t(row));
            solve(true);
        });
    });
    const BendKeyList *frames = &box->keys();
    when(frames, &BendKeyList::chosen,
         [this](int row) { changeFrame(row, [&] { showFrame(keyFrames(session->state())[std::size_t(row)].time); }); });
    const auto scrub = [this] { return dynamic_cast<ScrubInteraction *>(going.get()); }; // null: it was cancelled
    const BendTimeline *bar = &box->timeline();
    when(bar, &BendTimeline::begins, [this](double time) {
        hint.clear();
        if (isForPanel() && session->state().poses)
            goOn<ScrubInteraction>([this](double end) { changePoses([&] { showFrame(end); }); }).begin(time);
    });
    when(bar, &BendTimeline::goes, [scrub](double time) {
        if (ScrubInteraction *going = scrub())
            going->to(time);
    });
    when(bar, &BendTimeline::ends, [scrub] {
        if (ScrubInteraction *going = scrub())
            going->end();
    });
    using KeyFrames = std::vector<vcg::fcd::KeyFrame>;
    const auto edit = [this](int row, const std::function<void(KeyFrames &)> &change) {
        changeFrame(row, [&] {
            session->change();
            KeyFrames frames = keyFrames(session->state());
            change(frames);
            session->setPoses(withKeyFrames(*session->state().poses, std::move(frames)));
        });
    };
    when(frames, &BendKeyList::edited, [edit](int row, double time, int easing) {
        edit(row, [=](KeyFrames &all) {
            all[std::size_t(row)].time = time;
            all[std::size_t(row)].easing = vcg::fcd::Easing(easing);
        });
    });
    when(bar, &BendTimeline::keyMoved,
         [edit](int row, double time) { edit(row, [=](KeyFrames &all) { all[std::size_t(row)].time = time; }); });
    when(frames, &BendKeyList::removed,
         [edit](int row) { edit(row, [=](KeyFrames &all) { all.erase(all.begin() + row); }); });
}

/// Changes the poses, if that can be done now, and updates the panel.
void BendTool::changePoses(const std::function<void()> &change) {
    hint.clear();
    guarded([&] {
        if (isForPanel())
            change();
    });
    later([this] { refreshAll(); }); // after the list's own events
}

/// Changes one pose. It may be gone: while a cell is edited, its list is not updated.
void BendTool::changePose(int row, const std::function<void()> &change) {
    changePoses([&] {
        if (session->state().poses && std::size_t(row) < session->state().poses->pose.size())
            change();
    });
}

/// Changes a key frame, in the same way.
void BendTool::changeFrame(int row, const std::function<void()> &change) {
    changePoses([&] {
        if (session->state().poses && std::size_t(row) < keyFrames(session->state()).size())
            change();
    });
}

/// Renames a pose. If another pose has the name, asks whether to replace it; undo takes it back.
void BendTool::renamePose(std::size_t number, const std::string &name) {
    const std::optional<std::size_t> other = poseOfName(session->state(), name, number);
    if (!other) {
        session->change();
        session->setPoses(renamed(*session->state().poses, number, name));
        return;
    }
    const auto poses = session->state().poses;
    const bool isWanted =
        QMessageBox::question(view->window(), "Replace pose",
                              "There is a pose '" + QString::fromStdString(name) + "' already. Replace it?",
                              QMessageBox::Yes | QMessageBox::No, QMessageBox::Yes) == QMessageBox::Yes;
    if (!isReady() || session->state().poses != poses)
        return;
    if (!isWanted)
        throw vcg::fcd::Error("Another pose is called '" + name + "' and stays. Choose another name.");
    session->change();
    session->replacePose(*other, number);
    solve(true);
    tell("The pose '" + name + "' is replaced. Undo takes that back.");
}

void BendTool::showBlend(const std::vector<double> &weights) {
    session->blend(weights);
    panel->showOptions(session->model().options);
    solve(true);
}

/// Shows the animation at a time.
void BendTool::showFrame(double time) {
    session->change();
    showBlend(session->state().poses->WeightsAt(time));
    frameShown = time;
}

void BendTool::onPoseCommand(int which) {
    const QString kinds = "Tables of poses (*.csv)";
    const bool wasPlaying = going && going->isEndedByAll();
    if (!isForPanel())
        return;
    hint.clear();
    switch (which) {
    case BendPoseBox::Keep: {
        session->change();
        const std::string call = session->keepPose();
        say("The layer keeps the pose. In a script, once it is at rest: " + call);
        solve(true);
        refresh();
        panel->poses().list().nameLast();
        break;
    }
    case BendPoseBox::Load: {
        const QString file = fileToLoad("Load poses", kinds);
        if (file.isEmpty())
            return;
        session->change();
        session->loadPoses(file);
        refresh();
        break;
    }
    case BendPoseBox::Save: {
        const vcg::fcd::PoseSequence poses = expectPoses(session->state());
        const QString file = fileToSave("Save poses", kinds);
        if (file.isEmpty())
            return;
        saveFiles({{file, PoseSequenceText(poses)}});
        tell("Saved the poses as " + file.toStdString() + ".");
        break;
    }
    case BendPoseBox::KeyFrame:
        session->change();
        session->setPoses(withKeyFrame(session->state(), isMoved(session->model())));
        refresh();
        break;
    case BendPoseBox::Play:
        if (!wasPlaying) // otherwise the press has stopped it
            goOn<PlayInteraction>().begin();
        break;
    case BendPoseBox::Export: exportAnimation(); break;
    }
    view->update();
}

/// Exports the key frames, in the background.
void BendTool::exportAnimation() {
    const std::vector<vcg::fcd::KeyFrame> &keys = expectAnimation(session->state()).key;
    BendExportDialog dialog(keys.front().time, keys.back().time, view->window());
    if (dialog.exec() != QDialog::Accepted || !isReady())
        return;
    AnimationExport how = dialog.asked();
    const auto animation = std::make_shared<BendSession::Animation>(session->animation(how));
    if (how.isFile()) {
        how.file = fileToSave("Export animation", "glTF (*.glb);;Point cache (*.pc2);;Point cache (*.mdd)");
        if (how.file.isEmpty())
            return;
    }
    if (how.isGltf())
        session->readLook(*animation);
    const auto made = std::make_shared<ExportedAnimation>();
    beside(
        "Exporting the animation",
        [=](const vcg::fcd::Progress &progress) { session->exportAnimation(*animation, how, *made, progress); },
        [=] {
            const std::string call = "In a script, once the layer is at rest: " + session->exportCall(*animation, how);
            const auto tellOf = [&](const std::string &what) {
                tell(what, call);
                for (const std::string &each : animation->remarks)
                    say(each, true);
                if (!made->report.converged)
                    say("Some frames did not converge.", true);
                if (made->report.folded > 0)
                    say("In a frame, " + trianglesFlipped(std::size_t(made->report.folded)) +
                            ": the surface is squeezed or twisted too much there.",
                        true);
            };
            if (!how.isFile()) {
                applyToNewLayer(
                    [&] {
                        session->addLayers(*made, toLog());
                        tellOf("Made " + counted(made->frames.size(), "layer", "layers") +
                               ". They are hidden: the eyes in the list of layers show them.");
                    },
                    true);
                return;
            }
            made->files.save();
            tellOf("Wrote " + std::to_string(made->report.frames) + " frames to " + how.file.toStdString() + ".");
            refreshAll(); // with the gizmo
        },
        {}, true);
}

/// The time of the animation with the shown shape: the one asked for last, or that of a key frame.
std::optional<double> BendTool::shownFrame() const {
    const BendState &state = session->state();
    const std::vector<vcg::fcd::KeyFrame> keys = keyFrames(state);
    if (keys.empty() || (state.weights.empty() && isMoved(session->model())))
        return {};
    const std::vector<double> weights = weightsOfPoses(state);
    if (state.poses->WeightsAt(frameShown) == weights)
        return std::clamp(frameShown, keys.front().time, keys.back().time);
    const auto found =
        std::find_if(keys.rbegin(), keys.rend(), [&](const auto &each) { return each.weight == weights; });
    return found == keys.rend() ? std::nullopt : std::optional(found->time);
}

void BendTool::showPoses() {
    const BendState &state = session->state();
    const auto poses = state.poses ? state.poses->pose : std::vector<vcg::fcd::NamedPose>();
    const std::vector<double> weights = weightsOfPoses(state);
    std::vector<BendPoseRow> rows;
    rows.reserve(poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i)
        rows.push_back({QString::fromStdString(poses[i].name), QString::fromStdString(poses[i].motions), weights[i]});
    panel->poses().list().show(rows);
    std::vector<BendKeyRow> frames;
    std::vector<double> times;
    const bool isElsewhere = going && going->isEndedByAll(); // it is played, or scrubbed
    const std::optional<double> time = isElsewhere ? std::nullopt : shownFrame();
    int selected = -1;
    for (const vcg::fcd::KeyFrame &each : keyFrames(state)) {
        QStringList shown;
        for (std::size_t i = 0; i < each.weight.size(); ++i)
            if (each.weight[i] != 0)
                shown << rows[i].name + (each.weight[i] == 100 ? "" : QString(" %1 %").arg(each.weight[i], 0, 'g', 4));
        if (each.time == time)
            selected = int(frames.size());
        times.push_back(each.time);
        frames.push_back({each.time, int(each.easing), shown.empty() ? "at rest" : shown.join(", ")});
    }
    panel->setGhostsArePoints(model->cm.fn > 0 && GhostParts::isPoints(std::size_t(model->cm.fn)));
    panel->poses().keys().show(frames, selected);
    BendTimeline &bar = panel->poses().timeline();
    bar.show(times);
    if (!isElsewhere)
        bar.showTime(time);
}

/// Updates the ghosts, unless key frames are played. During a drag, they stay.
void BendTool::lookForGhosts() {
    const auto *scrub = dynamic_cast<const ScrubInteraction *>(going.get());
    if (!panel->hasOnionSkin() || !layer() || (going && going->isEndedByAll() && !scrub)) {
        onionSkin.reset();
        return;
    }
    if (!onionSkin)
        onionSkin = std::make_unique<BendOnionSkin>([this] {
            later([this] {
                if (!panel || !session || !layer() || preparing)
                    return;
                lookForGhosts();
                view->update();
            });
        });
    if (drag()) {
        onionSkin->pause();
        return;
    }
    const std::optional<double> time = scrub ? std::optional(scrub->time()) : shownFrame();
    timeOfGhosts = time.value_or(timeOfGhosts);
    onionSkin->look(*session, timeOfGhosts, time.has_value());
}
