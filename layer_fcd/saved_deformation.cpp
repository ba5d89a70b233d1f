// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/field/deformation_file.h> // before Qt

#include "kept_deformation.h"
#include "layer_matrix.h"
#include "save_files.h"
#include "saved_deformation.h"

namespace {

/// Maps positions and linear maps from the coordinates of a layer to the world. Vertices at rest stay so, to the bit.
void toWorld(const Eigen::Affine3d &matrix, Eigen::Matrix3Xd &rest, Eigen::Matrix3Xd &deformed,
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

} // namespace

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
