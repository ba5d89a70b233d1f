// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/nearest_place.h> // before Qt

#include "fcd_copy.h"
#include "fcd_rest.h"

#include <vcg/complex/allocate.h>

using vcg::fcd::Error;
using vcg::fcd::Index;
using vcg::fcd::NearestPlace;
using vcg::fcd::Progress;

namespace {

const char *const deformationName = "fcd_deformation";
using Kept = std::shared_ptr<const Deformation>;

std::string quoted(const MeshModel &layer) { return "'" + layer.label().toStdString() + "'"; }

/// The layers of a deformation that can be used again. \throw Error when they are not
const Deformation &deformationOf(MeshModel *source, const MeshModel *restGraph, MeshModel *deformedGraph) {
    if (!source || !restGraph || !deformedGraph)
        throw Error("source_layer, rest_graph and deformed_graph must be layers of this document.");
    const Kept *kept = host::meshAttribute<Kept>(deformedGraph->cm, deformationName);
    if (!kept)
        throw Error("The layer " + quoted(*deformedGraph) +
                    " holds no deformation. It must be the deformed graph that 'FCD: Deform Mesh' "
                    "(generate_fcd_deformed_mesh) made in this session, with 'Layers with the graph': files do not "
                    "keep all of a deformation. Deform the source again.");
    const Deformation &deformation = **kept;
    const CMeshO &mesh = source->cm;
    const bool isPosed = RestShape::exists(*source);
    if ((isPosed ? RestShape(*source).shape() : shapeOf(mesh)) != deformation.shape || mesh.fn != deformation.faces)
        throw Error("The layer " + quoted(*source) + " is not what " + quoted(*deformedGraph) +
                    " was made from, or it was changed since. Choose the layer that was deformed, or deform it again.");
    if (restGraph == source || !HasNodes(*deformation.prepared->deformer, readNodes(*source, restGraph)))
        throw Error("The layer " + quoted(*restGraph) + " is not the graph at rest of " + quoted(*deformedGraph) +
                    ". Choose the graph that was made together with it.");
    return deformation;
}

/// The source at rest.
class Source {
  public:
    explicit Source(MeshModel &layer) : position(positionsOf(layer)), matrix(invertibleMatrixOf(layer)) {
        const CMeshO &mesh = layer.cm;
        if (RestShape::exists(layer)) {
            const Point3m *rest = RestShape(layer).positions();
            for (std::size_t i = 0; i < mesh.vert.size(); ++i)
                position.col(Eigen::Index(i)) << rest[i][0], rest[i][1], rest[i][2];
        }
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

/// Positions and maps of the vertices of \p target, as \p source carries them.
void carry(const MeshModel &target, const Source &source, const vcg::fcd::Deformer::Carrier &carrier,
           const Progress &progress, Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> &linear) {
    const CMeshO &mesh = target.cm;
    const Eigen::Affine3d here = invertibleMatrixOf(target);
    const bool isSame = here.matrix() == source.matrix.matrix();
    const Eigen::Affine3d to = isSame ? Eigen::Affine3d::Identity() : source.matrix.inverse() * here;
    const Eigen::Matrix3d back = isSame ? Eigen::Matrix3d::Identity() : Eigen::Matrix3d(to.linear().inverse());
    linear.assign(mesh.vert.size(), Eigen::Matrix3f::Identity());
    ParallelFor(progress, "Mapping to the layer", mesh.vert.size(), 1 << 12, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const Eigen::Vector3d p = position.col(Eigen::Index(i));
            if (mesh.vert[i].IsD() || !p.allFinite())
                continue;
            const Eigen::Vector3d x = to * p;
            const vcg::fcd::SurfacePlace place = (*source.places)(x);
            Eigen::Vector3d way = Eigen::Vector3d::Zero();
            Eigen::Matrix3f map = Eigen::Matrix3f::Zero(), each;
            for (int k = 0; k < place.count; ++k) {
                way += place.weight[k] * (carrier(std::size_t(place.slot[k]), x, each) - x);
                map += float(place.weight[k]) * each;
            }
            if (way.isZero(0)) // what is fixed keeps its bits
                continue;
            position.col(Eigen::Index(i)) = p + back * way;
            linear[i] = isSame ? map : Eigen::Matrix3f((back * map.cast<double>() * to.linear()).cast<float>());
        }
    });
}

} // namespace

void keepDeformation(MeshModel &deformedGraph, std::shared_ptr<const Deformation> deformation) {
    host::madeMeshAttribute<Kept>(deformedGraph.cm, deformationName) = std::move(deformation);
}

int copyDeformation(MeshDocument &document, const CopyParam &param, const std::vector<MeshModel *> &targets,
                    const Remark &remark, const Progress &progress) {
    progress(0, "Reading the source");
    const Deformation &deformation = deformationOf(param.source, param.restGraph, param.deformedGraph);
    const Source source(*param.source);
    const vcg::fcd::Deformer::Carrier carrier(*deformation.prepared->deformer, deformation.pose);

    std::vector<std::unique_ptr<NewLayers>> added;
    const MeshModel *last = targets.back();
    int vertices = 0;
    for (std::size_t t = 0; t < targets.size(); ++t) {
        const MeshModel &target = *targets[t];
        Eigen::Matrix3Xd position = positionsOf(target);
        std::vector<Eigen::Matrix3f> linear;
        carry(target, source, carrier,
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
