// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/field/deformation_file.h> // before Qt

#include "carrying_surface.h"
#include "deformation_uses.h"
#include "kept_graph.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "new_layers.h"
#include "save_files.h"

#include <memory>
#include <utility>

using vcg::fcd::DeformationField;
using vcg::fcd::Progress;

DeformedCopies copyDeformation(MeshDocument &document, const CopyParam &param, const std::vector<MeshModel *> &targets,
                               const Remark &remark, const Progress &progress) {
    progress(0, "Reading the source");
    std::unique_ptr<const CarryingSurface> source;
    std::unique_ptr<const vcg::fcd::Carrier> carrier;
    std::unique_ptr<const DeformationField> field;
    Displacements displacements;
    int sides = 0; // CarryingSurface::sidesTold for the present layer
    Eigen::Affine3d matrix = Eigen::Affine3d::Identity();
    if (param.file.isEmpty()) {
        const Deformation &deformation = deformationOf(param);
        source = std::make_unique<const CarryingSurface>(*param.source,
                                                         sourceThen(*param.source, deformation, remark).position);
        carrier = std::make_unique<vcg::fcd::Carrier>(*deformation.prepared->deformer, deformation.pose);
        displacements = [&](const CarriedVertices &vertices, auto &displacement, auto &linear) {
            std::vector<vcg::fcd::SurfacePlace> places(vertices.slot.size());
            vcg::fcd::NearestPlace::Hint hint;
            for (std::size_t n = 0; n < places.size(); ++n)
                places[n] = (*source)(vertices, n, sides, hint);
            carrier->Displacements(places, vertices.position, displacement, linear);
        };
        matrix = source->matrix;
    } else {
        field = std::make_unique<DeformationField>(vcg::fcd::ReadDeformationFile(pathOf(param.file)));
        displacements = [&field](const CarriedVertices &vertices, auto &displacement, auto &linear) {
            linear.resize(vertices.slot.size());
            for (std::size_t n = 0; n < linear.size(); ++n)
                displacement.push_back((*field)(vertices.position[n], &linear[n]));
        };
    }

    std::vector<std::unique_ptr<NewLayers>> added;
    const MeshModel *last = targets.back();
    DeformedCopies made;
    const Eigen::AlignedBox3d sourceBox =
        source ? boxOf(source->position, matrix, &param.source->cm) : boxOf(field->samples.position, matrix, nullptr);
    for (std::size_t t = 0; t < targets.size(); ++t) {
        const MeshModel &target = *targets[t];
        Eigen::Matrix3Xd position = positionsOf(target);
        std::vector<Eigen::Matrix3f> linear;
        if (std::string text =
                describeSpace(target, boxOf(position, invertibleMatrixOf(target), &target.cm), sourceBox, true);
            !text.empty())
            made.warnings.push_back(std::move(text));
        if (source) // a saved deformation goes by distance alone
            sides = source->sidesTold(target, position);
        carry(target, matrix, displacements,
              progress.Slice(0.2 + 0.8 * double(t) / double(targets.size()),
                             0.2 + 0.8 * double(t + 1) / double(targets.size())),
              position, linear);
        if (!hasDirections(target))
            linear.clear();
        added.push_back(std::make_unique<NewLayers>(document, target, remark));
        MeshModel &copy = added.back()->addDeformed("deformed", position, linear, {});
        if (param.displacement)
            added.back()->addDisplacement(copy, position);
        last = &copy;
        made.vertices += target.cm.vn;
    }
    NewLayers::keep(added, *last, progress);
    return made;
}

/// Maps positions and linear maps from the coordinates of a layer to the world. Vertices at rest stay so, to the bit.
static void toWorld(const Eigen::Affine3d &matrix, Eigen::Matrix3Xd &rest, Eigen::Matrix3Xd &deformed,
                    std::vector<Eigen::Matrix3f> &linear) {
    if (matrix.matrix().isIdentity(0))
        return;
    const Eigen::Matrix3d to = matrix.linear(), back = to.inverse();
    vcg::fcd::ParallelFor(0, linear.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        for (std::size_t slot = first; slot < last; ++slot) {
            const auto i = Eigen::Index(slot);
            rest.col(i) = matrix * Eigen::Vector3d(rest.col(i));
            deformed.col(i) = matrix * Eigen::Vector3d(deformed.col(i));
            if (linear[slot] != Eigen::Matrix3f::Identity())
                linear[slot] = (to * linear[slot].cast<double>() * back).cast<float>();
        }
    });
}

SavedDeformation saveDeformation(const SaveDeformationParam &param, const Remark &remark,
                                 const vcg::fcd::Progress &progress) {
    const vcg::fcd::Stopwatch watch;
    SavedDeformation saved;
    progress(0, "Reading the source");
    const Deformation &deformation = deformationOf(param, true);
    const SourceThen then = sourceThen(*param.source, deformation, remark);
    const Eigen::Affine3d &matrix = then.matrix;
    Eigen::Matrix3Xd rest = then.position, deformed = rest;
    std::vector<Eigen::Matrix3f> linear;
    vcg::fcd::Carrier(*deformation.prepared->deformer, deformation.pose, progress.threads)
        .Apply(deformed, &linear, progress.Slice(0, 0.1));
    toWorld(matrix, rest, deformed, linear);
    if (param.inverse) {
        rest.swap(deformed);
        saved.folded = vcg::fcd::Invert(linear);
    }
    const vcg::fcd::SurfaceArrays surface = vcg::tri::ReadSurface(param.source->cm);
    vcg::fcd::FieldParam sampling;
    sampling.accuracy = param.accuracy;
    saved.field =
        vcg::fcd::SampleField(surface.View().With(then.position), rest, deformed, linear, sampling,
                              progress.Slice(0.1, 0.95), matrix.linear(), deformation.prepared->deformer->FreeIn());
    progress(1, "Done");
    const std::string text = vcg::fcd::DeformationText(saved.field.samples);
    saved.bytes = text.size();
    saveFiles({{param.file, text}});
    saved.seconds = watch.Seconds();
    return saved;
}
