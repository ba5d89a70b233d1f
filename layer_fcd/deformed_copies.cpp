// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/field/deformation_file.h> // before Qt

#include "carrying_surface.h"
#include "deformed_copies.h"
#include "kept_deformation.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "new_layers.h"

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
