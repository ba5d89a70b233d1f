// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/animation_export.h" // before Qt

#include "edit_fcd/bend/model/named_poses.h"
#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/layer_look.h>
#include <layer_fcd/save_files.h>

// Writes the animation to a file as FCD: Pose Sequence does.

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

vcg::fcd::SequenceReport BendSession::exportAnimation(const Animation &animation, const AnimationExport &how,
                                                      FilesToSave &files, const vcg::fcd::Progress &progress) {
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
    (how.isPc2() ? output.pc2 : how.isMdd() ? output.mdd : output.gltf) = files.add(how.file);
    return WriteFrames(surface->View(), handles, *solver.prepared()->deformer, sequence, motionsOfPoses(),
                       deformationOf(data.options), output, progress.Slice(0.2, 1));
}
