// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // these before Qt
#include <vcg_ext/field/deformation_file.h>

#include "deformed_copies.h"
#include "kept_deformation.h"
#include "layer_contents.h"
#include "layer_matrix.h"
#include "new_layers.h"

#include <functional>
#include <memory>

#include <QFile>

using vcg::fcd::DeformationField;
using vcg::fcd::Error;
using vcg::fcd::Index;
using vcg::fcd::NearestPlace;
using vcg::fcd::Progress;

namespace {

/// The source as it was before it was deformed.
class Source {
  public:
    Source(MeshModel &layer, const Deformation &deformation)
        : position(positionsBefore(layer, deformation)), matrix(invertibleMatrixOf(layer)) {
        const CMeshO &mesh = layer.cm;
        std::vector<std::array<Index, 3>> triangle;
        triangle.reserve(std::size_t(mesh.fn));
        for (const CFaceO &face : mesh.face)
            if (!face.IsD())
                triangle.push_back({Index(vcg::tri::Index(mesh, face.cV(0))), Index(vcg::tri::Index(mesh, face.cV(1))),
                                    Index(vcg::tri::Index(mesh, face.cV(2)))});
        std::vector<char> isVertex(mesh.vert.size());
        for (std::size_t i = 0; i < isVertex.size(); ++i)
            isVertex[i] = !mesh.vert[i].IsD();
        places = std::make_unique<NearestPlace>(position, std::move(triangle), isVertex);
    }

    Eigen::Matrix3Xd position;
    Eigen::Affine3d matrix;
    std::unique_ptr<NearestPlace> places;
};

/// The displacement of a point, and how space turns and stretches there.
using Displacement = std::function<Eigen::Vector3d(const Eigen::Vector3d &, Eigen::Matrix3f &)>;

/// Positions and maps of the vertices of \p target. \param matrix from the coordinates of \p displacement to the world
void carry(const MeshModel &target, const Eigen::Affine3d &matrix, const Displacement &displacement,
           const Progress &progress, Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> &linear) {
    const CMeshO &mesh = target.cm;
    const Eigen::Affine3d here = invertibleMatrixOf(target);
    const bool isSame = here.matrix() == matrix.matrix();
    const Eigen::Affine3d to = isSame ? Eigen::Affine3d::Identity() : matrix.inverse() * here;
    const Eigen::Matrix3d back = isSame ? Eigen::Matrix3d::Identity() : Eigen::Matrix3d(to.linear().inverse());
    linear.assign(mesh.vert.size(), Eigen::Matrix3f::Identity());
    ParallelFor(progress, "Mapping to the layer", mesh.vert.size(), 1 << 12, [&](std::size_t first, std::size_t last) {
        Eigen::Matrix3f map;
        for (std::size_t i = first; i < last; ++i) {
            const Eigen::Vector3d p = position.col(Eigen::Index(i));
            if (mesh.vert[i].IsD() || !p.allFinite())
                continue;
            const Eigen::Vector3d way = displacement(isSame ? p : to * p, map);
            if (way.isZero(0)) // what is fixed keeps its bits
                continue;
            position.col(Eigen::Index(i)) = p + back * way;
            linear[i] = isSame ? map : Eigen::Matrix3f((back * map.cast<double>() * to.linear()).cast<float>());
        }
    });
}

} // namespace

int copyDeformation(MeshDocument &document, const CopyParam &param, const std::vector<MeshModel *> &targets,
                    const Remark &remark, const Progress &progress) {
    progress(0, "Reading the source");
    std::unique_ptr<const Source> source;
    std::unique_ptr<const vcg::fcd::Carrier> carrier;
    std::unique_ptr<const DeformationField> field;
    Displacement displacement;
    Eigen::Affine3d matrix = Eigen::Affine3d::Identity();
    if (param.file.isEmpty()) {
        const Deformation &deformation = deformationOf(param.source, param.restGraph, param.deformedGraph);
        source = std::make_unique<Source>(*param.source, deformation);
        carrier = std::make_unique<vcg::fcd::Carrier>(*deformation.prepared->deformer, deformation.pose);
        displacement = [&](const Eigen::Vector3d &x, Eigen::Matrix3f &map) {
            return carrier->Displacement((*source->places)(x), x, map);
        };
        matrix = source->matrix;
    } else {
        field = std::make_unique<DeformationField>(
            vcg::fcd::ReadDeformationFile(QFile::encodeName(param.file).toStdString()));
        displacement = [&field](const Eigen::Vector3d &x, Eigen::Matrix3f &map) { return (*field)(x, &map); };
    }

    std::vector<std::unique_ptr<NewLayers>> added;
    const MeshModel *last = targets.back();
    int vertices = 0;
    for (std::size_t t = 0; t < targets.size(); ++t) {
        const MeshModel &target = *targets[t];
        Eigen::Matrix3Xd position = positionsOf(target);
        std::vector<Eigen::Matrix3f> linear;
        carry(target, matrix, displacement,
              progress.Slice(0.2 + 0.8 * double(t) / double(targets.size()),
                             0.2 + 0.8 * double(t + 1) / double(targets.size())),
              position, linear);
        if (!hasDirections(target))
            linear.clear();
        added.push_back(std::make_unique<NewLayers>(document, target, remark));
        last = &added.back()->addDeformed("deformed", position, linear, {});
        vertices += target.cm.vn;
    }
    for (const auto &layers : added)
        layers->keep(*last);
    progress(1, "Done");
    return vertices;
}
