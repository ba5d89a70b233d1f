// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/shape/layer_shape.h"

#include <layer_fcd/layer_contents.h>
#include <layer_fcd/layer_matrix.h>
#include <layer_fcd/layer_normals.h>

#include <vcg/complex/algorithms/update/bounding.h>

RestGuard::RestGuard(MeshModel &layer) : layer(layer), matrix(invertibleMatrixOf(layer)) {}

void RestGuard::keep() {
    const CMeshO &mesh = layer.cm;
    position.resize(mesh.vert.size());
    normal.resize(mesh.vert.size());
    faceNormal.resize(mesh.face.size());
    for (std::size_t i = 0; i < position.size(); ++i) {
        position[i] = mesh.vert[i].cP();
        normal[i] = mesh.vert[i].cN();
    }
    for (std::size_t f = 0; f < faceNormal.size(); ++f)
        faceNormal[f] = mesh.face[f].cN();
    box = mesh.bbox;
    Eigen::AlignedBox3d all;
    surface = {};
    for (const CVertexO &vertex : mesh.vert)
        if (!vertex.IsD()) {
            all.extend(toVector(vertex.cP()));
            surface.box.extend(matrix * toVector(vertex.cP()));
            ++surface.vertices;
        }
    center = all.center();
    size = surface.box.diagonal().norm();
    know();
    posed = false;
}

void RestGuard::keepPosed(const std::function<void()> &keepRest) {
    const auto updateFacesAndBox = [this] {
        computeFaceNormals(layer.cm, {});
        vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
    };
    {
        const AtRest atRest(layer);
        updateFacesAndBox();
        keepRest();
    }
    updateFacesAndBox();
    leave();
    know();
}

void RestGuard::restoreVertices() {
    if (!posed || layer.cm.vert.size() != position.size())
        return;
    forEach(position.size(), [&](std::size_t i) {
        layer.cm.vert[i].P() = position[i];
        layer.cm.vert[i].N() = normal[i];
    });
    posed = false;
}

RestGuard::Shown RestGuard::shown() const {
    Shown all(posed ? layer.cm.vert.size() : 0);
    forEach(all.size(), [&](std::size_t i) { all[i] = {layer.cm.vert[i].cP(), layer.cm.vert[i].cN()}; });
    return all;
}

void RestGuard::restore() {
    if (!fits())
        return;
    restoreVertices();
    for (std::size_t f = 0; f < faceNormal.size(); ++f)
        layer.cm.face[f].N() = faceNormal[f];
    layer.cm.bbox = box;
    know();
}

void RestGuard::know() {
    shape = shapeOf(layer.cm);
    shownNormals = normalsOf(layer.cm);
}

bool RestGuard::isAsKnown() const {
    Eigen::Matrix4d present;
    layer.cm.Tr.ToEigenMatrix(present);
    if (!fits() || present != matrix.matrix() || shape != shapeOf(layer.cm))
        return false;
    // The host may recompute normals at any time, with other weights: some tenths of a degree off.
    return shownNormals == normalsOf(layer.cm) || (layer.cm.fn > 0 && !hasOtherNormals(layer, 1, 0.01));
}

bool PoseSolver::isPrepared(const Tags &tags, const Param &param) const {
    return preparedFor && preparedFor == tags && preparedParam.Numbers() == param.Numbers();
}

void PoseSolver::prepare(const Tags &tags, const Param &param, const vcg::fcd::SurfaceView &surface,
                         const Eigen::Affine3d &world, const vcg::fcd::Progress &progress) {
    last.reset();
    preparedFor.reset();
    deformer.prepare(surface, *tags, world, param, progress);
    preparedFor = tags;
    preparedParam = param;
}

void PoseSolver::clear() {
    last.reset();
    preparedFor.reset();
    deformer.forget();
    kept.clear();
}

const vcg::fcd::Deformer::Pose &PoseSolver::solve(Motions motions, Param param, bool full) {
    deformer.takeMotions(std::move(motions));
    if (full) {
        last = deformer.solve(param);
    } else {
        param.maxIterations = 20;
        param.tolerance = std::max(param.tolerance, 1e-4);
        last = deformer.solveFrom(last ? &*last : nullptr, param);
    }
    return *last;
}

const vcg::fcd::Deformer::Pose &PoseSolver::solveBlend(std::vector<std::map<int, vcg::fcd::Motion>> poses,
                                                       const Eigen::Affine3d &world, const std::vector<double> &weight,
                                                       const Param &param) {
    beginBlends(std::move(poses), world, param);
    const vcg::fcd::Deformer::Pose &pose = last.emplace(solveNextBlend(weight));
    endBlends();
    return pose;
}

void PoseSolver::beginBlends(std::vector<std::map<int, vcg::fcd::Motion>> poses, const Eigen::Affine3d &world,
                             const Param &param) {
    blends = std::make_unique<vcg::fcd::SequenceSolver>(*prepared()->deformer, world, std::move(poses), param);
}
