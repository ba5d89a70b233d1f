// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/handles/handle_file.h> // before Qt

#include "deformation_uses.h"
#include "layer_contents.h"
#include "layer_deformer.h"
#include "layer_labels.h"
#include "layer_sequence.h"
#include "layer_matrix.h"
#include "handle_sources.h"
#include "new_layers.h"
#include "rest_shape.h"
#include "save_files.h"

#include <memory>
#include <utility>

using vcg::fcd::Companion;
using vcg::fcd::Deformer;
using vcg::fcd::Error;
using vcg::fcd::Motion;
using vcg::fcd::PoseSequence;
using vcg::fcd::Progress;
using vcg::fcd::SurfaceMark;

std::optional<PoseSequence> posesOf(const MeshModel &layer) { return LayerState::known(layer).poses; }

void keepPoses(const MeshDocument &document, MeshModel &layer, const PoseSequence &poses) {
    if (poses.pose.empty() && !LayerState::of(layer))
        return;
    std::optional<PoseSequence> &kept = LayerState::made(document, layer).poses;
    kept = poses.pose.empty() ? std::nullopt : std::make_optional(poses);
}

namespace {

struct Poses {
    PoseSequence sequence;
    QString file;     ///< empty: the layer keeps them
    std::string name; ///< of the file, or of the layer

    /// \throw Error they are of another surface
    PoseSequence of(const SurfaceMark &surface) && {
        try {
            if (file.isEmpty())
                sequence.ExpectSurface(surface,
                                       "Bring it back to where it was ('FCD: Reset Pose' brings a shape back), "
                                       "or give poses for it as 'poses_file'.");
            else
                sequence.ExpectSurface(surface);
        } catch (const Error &e) {
            throw Error("'" + name + "': " + e.what());
        }
        sequence.surface = surface;
        return std::move(sequence);
    }
};

Poses findPoses(const MeshModel &layer, const QString &file) {
    const std::size_t most = 100000000; // bytes, of a million key frames
    const std::string name = file.toStdString();
    if (file.isEmpty()) {
        if (std::optional<PoseSequence> sequence = posesOf(layer))
            return {std::move(*sequence), file, layer.label().toStdString()};
        throw Error("The layer " + inQuotes(layer) +
                    " keeps no poses: layers that are saved and loaded, or copied, lose them. Load its session ('FCD: "
                    "Load Session'), or give the .csv file with the poses as 'poses_file'.");
    }
    return {vcg::fcd::ReadPoseSequence(vcg::fcd::ReadFile(pathOf(file), most), name), file, name};
}

} // namespace

PoseSequence readPoses(const MeshModel &layer, const QString &file, const SurfaceMark &surface) {
    return findPoses(layer, file).of(surface);
}

std::vector<std::map<int, Motion>> motionsOf(const PoseSequence &sequence, const MeshDocument &document,
                                             const MeshModel &layer,
                                             const std::map<vcg::fcd::Index, Eigen::Vector3d> &center,
                                             const Eigen::Affine3d &world) {
    std::vector<std::map<int, Motion>> motions;
    for (const vcg::fcd::NamedPose &pose : sequence.pose) {
        HandleParam param;
        param.transforms = QString::fromStdString(pose.motions);
        vcg::fcd::Handles posed;
        posed.world = world;
        try {
            readMotions(
                document, layer, nullptr, param, center, [](const std::string &) {}, posed);
        } catch (const Error &e) {
            throw Error("Pose '" + pose.name + "': " + e.what());
        }
        motions.push_back(std::move(posed.motion));
    }
    return motions;
}

/// The layers that \p layer carries along. \param rest its positions at rest
static std::vector<Companion> companionsOf(const MeshDocument &document, const MeshModel &layer, Eigen::Matrix3Xd rest,
                                           const Remark &remark, const Progress &progress) {
    std::vector<const MeshModel *> targets;
    for (const MeshModel *each : host::layers(document)) {
        const bool isOfEdges = each->cm.fn == 0 && each->cm.en > 0; // a graph, say
        if (each != &layer && each->isVisible() && each->cm.vn > 0 && !isOfEdges)
            targets.push_back(each);
    }
    if (targets.empty())
        throw Error("No other layer is visible. Show the layers that should go along, or untick all_visible.");
    const auto surface = std::make_shared<const CarryingSurface>(layer, std::move(rest));
    const Eigen::AlignedBox3d box = boxOf(surface->position, surface->matrix, &layer.cm);
    std::vector<Companion> companions;
    for (std::size_t t = 0; t < targets.size(); ++t) {
        const MeshModel &target = *targets[t];
        const auto arrays = std::make_shared<const vcg::fcd::SurfaceArrays>(vcg::tri::ReadSurface(target.cm));
        Eigen::Matrix3Xd position = positionsOf(target);
        if (const std::string text =
                describeSpace(target, boxOf(position, invertibleMatrixOf(target), &target.cm), box, false);
            !text.empty() && remark)
            remark(text);
        const auto places = std::make_shared<std::vector<vcg::fcd::SurfacePlace>>(target.cm.vert.size());
        const int sides = surface->sidesTold(target, position);
        std::vector<Eigen::Matrix3f> linear;
        carry(
            target, surface->matrix,
            [&](const CarriedVertices &vertices, auto &displacement, auto &) { // no displacement yet
                vcg::fcd::NearestPlace::Hint hint;
                for (std::size_t n = 0; n < vertices.slot.size(); ++n)
                    (*places)[vertices.slot[n]] = (*surface)(vertices, n, sides, hint);
                displacement.assign(vertices.slot.size(), Eigen::Vector3d::Zero());
            },
            progress.Slice(double(t) / double(targets.size()), double(t + 1) / double(targets.size())), position,
            linear);
        Companion companion;
        companion.surface = arrays->View();
        companion.world = invertibleMatrixOf(target);
        companion.name = target.label().toStdString();
        companion.look = lookOf(document, target, remark);
        companion.carry = [arrays, places, &target, matrix = surface->matrix](const vcg::fcd::Carrier &carrier,
                                                                              Eigen::Matrix3Xd &posed) {
            std::vector<Eigen::Matrix3f> turns;
            carry(
                target, matrix,
                [&](const CarriedVertices &vertices, auto &displacement, auto &linear) {
                    std::vector<vcg::fcd::SurfacePlace> at;
                    at.reserve(vertices.slot.size());
                    for (const std::size_t slot : vertices.slot)
                        at.push_back((*places)[slot]);
                    carrier.Displacements(at, vertices.position, displacement, linear);
                },
                {}, posed, turns);
        };
        companions.push_back(std::move(companion));
    }
    return companions;
}

void takeFrames(SequenceParam::Layers which, const MeshModel &layer, const vcg::fcd::SurfaceView &surface,
                const Deformer &deformer, vcg::fcd::SequenceOutput &output, const TakeFrame &take) {
    const bool turns = hasDirections(layer);
    const auto taking = [=, &deformer](const QString &what) {
        return [=, &deformer](std::size_t number, const Deformer::Pose &pose, const Eigen::Matrix3Xd &position) {
            std::vector<Eigen::Matrix3f> linear;
            if (turns) {
                Eigen::Matrix3Xd again = surface.Positions();
                vcg::fcd::Carrier(deformer, pose).Apply(again, &linear);
            }
            take(what.arg(number), position, linear);
        };
    };
    if (which == SequenceParam::KeyFrames)
        output.keyFrame = taking("key frame %1");
    else if (which == SequenceParam::Frames)
        output.frame = taking("frame %1");
}

SequenceLayers makeSequence(MeshDocument &document, MeshModel &layer, PreparedLayers &preparedLayers,
                            const SequenceParam &param, const Remark &remark, const Progress &progress) {
    const vcg::fcd::Stopwatch watch;
    SequenceLayers made;
    vcg::fcd::SurfaceArrays surface = vcg::tri::ReadSurface(layer.cm, progress.Slice(0, 0.01));
    const Eigen::Affine3d world = invertibleMatrixOf(layer);
    Poses poses = findPoses(layer, param.posesFile);
    std::optional<AtRest> atRest;
    if (poses.sequence.surface && !poses.sequence.surface->IsSame(SurfaceMark::Of(surface.View(), world)) &&
        RestShape::exists(layer)) {
        RestShape(layer).checkVertices("The poses are of the shape before. To go back to it, run 'FCD: Reset Pose' "
                                       "(apply_coord_fcd_reset) with to=2 first.",
                                       remark);
        atRest.emplace(layer);
        surface = vcg::tri::ReadSurface(layer.cm, progress.Slice(0.01, 0.02));
    }
    const vcg::fcd::SurfaceView view = surface.View();
    const PoseSequence sequence = std::move(poses).of(SurfaceMark::Of(view, world));
    const vcg::fcd::Handles handles = readHandles(layer, nullptr, param.handles, remark);
    LayerDeformer layerDeformer(document, layer, preparedLayers, remark);
    layerDeformer.prepare(view, handles.tag, handles.world, param.deformation, progress.Slice(0.02, 0.3));
    const Prepared &prepared = *layerDeformer.prepared();
    const Deformer &deformer = *prepared.deformer;
    const auto motions = motionsOf(sequence, document, layer, deformer.center, handles.world);

    FilesToSave files;
    if (!param.saveFile.isEmpty()) {
        const std::string text = vcg::fcd::PoseSequenceText(sequence);
        files.add(param.saveFile)(0, text.data(), text.size());
    }
    vcg::fcd::SequenceOutput output;
    output.rate = param.rate;
    output.name = layer.label().toStdString();
    output.shapes = param.shapes;
    if (!param.gltfFile.isEmpty()) {
        output.gltf = files.add(param.gltfFile);
        output.look = lookOf(document, layer, remark);
        if (param.allVisible)
            output.companions = companionsOf(document, layer, view.Positions(), remark, progress.Slice(0.3, 0.4));
        made.companions = int(output.companions.size());
    }
    if (!param.pc2File.isEmpty())
        output.pc2 = files.add(param.pc2File);
    if (!param.mddFile.isEmpty())
        output.mdd = files.add(param.mddFile);
    NewLayers layers(document, layer, remark);
    takeFrames(param.layers, layer, view, deformer, output,
               [&](const QString &what, const auto &position, const auto &linear) {
                   made.layers.push_back(&layers.addDeformed(what, position, linear, {}));
               });
    if (output.gltf || output.pc2 || output.mdd || output.frame || output.keyFrame)
        made.report = vcg::fcd::WriteFrames(view, handles, deformer, sequence, motions, param.deformation, output,
                                            progress.Slice(output.companions.empty() ? 0.3 : 0.4, 1));
    atRest.reset();
    layers.keep(made.layers.empty() ? layer : *made.layers.back(), progress, [&] {
        files.save();
        keepPoses(document, layer, sequence);
    });
    showLast(document, layer, made.layers);
    made.poses = int(sequence.pose.size());
    made.keyFrames = int(sequence.key.size());
    made.nodes = int(deformer.Nodes());
    made.tags = prepared.tags;
    made.seconds = watch.Seconds();
    return made;
}
