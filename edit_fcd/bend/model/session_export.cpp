// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/animation_export.h" // before Qt

#include "edit_fcd/bend/model/named_poses.h"
#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/layer_look.h>
#include <layer_fcd/layer_sequence.h>
#include <layer_fcd/new_layers.h>

#include <utility>

// Makes files and layers of the animation as FCD: Pose Sequence does.

using vcg::fcd::PoseSequence;

BendSession::Animation BendSession::animation(const AnimationExport &how) {
    writeAppliedTags(); // by which the filter knows the handles
    const PoseSequence &all = expectAnimation(state());
    return {posesInNumbers(),
            partOfAnimation(all, how.from, how.to, asTyped(how.rate)).key,
            layer.label().toStdString(),
            {},
            {}};
}

void BendSession::readLook(Animation &animation) const {
    animation.look = lookOf(document, layer, [&](const std::string &text) { animation.remarks.push_back(text); });
}

void BendSession::exportAnimation(const Animation &animation, const AnimationExport &how, ExportedAnimation &made,
                                  const vcg::fcd::Progress &progress) {
    prepare(progress.Slice(0, 0.2));
    PoseSequence sequence = animation.poses;
    sequence.key = animation.key;
    vcg::fcd::Handles handles;
    handles.tag = tags();
    handles.world = rest.world();
    vcg::fcd::SequenceOutput output;
    output.rate = asTyped(how.rate);
    output.name = animation.name;
    output.look = animation.look;
    output.shapes = how.shapes;
    const vcg::fcd::SurfaceView view = surface->View();
    const vcg::fcd::Deformer &deformer = *solver.prepared()->deformer;
    if (how.isFile())
        (how.isPc2() ? output.pc2 : how.isMdd() ? output.mdd : output.gltf) = made.files.add(how.file);
    takeFrames(how.layers, layer, view, deformer, output,
               [&](const QString &what, const auto &position, const auto &linear) {
                   made.frames.push_back({what, position, linear});
               });
    made.report = WriteFrames(view, handles, deformer, sequence, motionsOfPoses(), deformationOf(data.options), output,
                              progress.Slice(0.2, 1));
}

void BendSession::addLayers(ExportedAnimation &made, const Remark &remark) {
    restore(); // the layers get its normals, turned
    NewLayers layers(document, layer, remark);
    std::vector<MeshModel *> added;
    added.reserve(made.frames.size());
    for (ExportedAnimation::Frame &each : made.frames) {
        const ExportedAnimation::Frame frame = std::move(each); // its memory is for the next layers
        added.push_back(&layers.addDeformed(frame.what, frame.position, frame.linear, {}));
    }
    layers.keep(layer, {});
    for (MeshModel *each : added)
        host::setVisible(*each, false);
    host::showChanges(document);
}
