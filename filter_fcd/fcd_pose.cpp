// SPDX-License-Identifier: GPL-3.0-or-later
#include "fcd_pose.h"

#include <mutex>

using vcg::fcd::Error;
using vcg::fcd::ParallelFor;
using vcg::fcd::Progress;
using vcg::fcd::Stopwatch;
using vcg::tri::PrepareDeformer;

namespace {

/// The layer at rest for a while: its positions are those at rest until this goes.
class WhileAtRest {
  public:
    WhileAtRest(CMeshO &mesh, const Point3m *rest) : mesh(mesh), before(mesh.vert.size()) {
        for (std::size_t i = 0; i < before.size(); ++i) {
            before[i] = mesh.vert[i].cP();
            mesh.vert[i].P() = rest[i];
        }
    }
    WhileAtRest(const WhileAtRest &) = delete;
    WhileAtRest &operator=(const WhileAtRest &) = delete;
    ~WhileAtRest() {
        for (std::size_t i = 0; i < before.size(); ++i)
            mesh.vert[i].P() = before[i];
    }

  private:
    CMeshO &mesh;
    std::vector<Point3m> before;
};

/// What is summed up over all vertices of a shape.
struct Sum {
    std::uint64_t shape = 0;
    vcg::Box3<Scalarm> box;

    void add(std::size_t slot, const Point3m &position) {
        shape += shapeTerm(slot, position);
        box.Add(position);
    }
    void add(const Sum &other) {
        shape += other.shape;
        box.Add(other.box);
    }
};

/// Writes a pose into the layer. \return what all vertices sum up to
Sum writePose(CMeshO &mesh, const RestShape &rest, const Prepared &prepared, const vcg::fcd::Deformer::Pose &pose) {
    std::mutex lock;
    Sum all;
    struct Taker {
        Taker(CMeshO &mesh, std::mutex &lock, Sum &all) : mesh(mesh), lock(lock), all(all) {}
        Taker(const Taker &) = delete;
        Taker &operator=(const Taker &) = delete;
        ~Taker() {
            const std::lock_guard<std::mutex> guard(lock);
            all.add(sum);
        }
        void operator()(std::size_t slot, const Eigen::Vector3d &position, const Eigen::Vector3d &normal) {
            CVertexO &vertex = mesh.vert[slot];
            vertex.P() = toPoint(position);
            vertex.N() = toPoint(normal);
            sum.add(slot, vertex.cP());
        }
        CMeshO &mesh;
        std::mutex &lock;
        Sum &all, sum;
    };
    vcg::fcd::Carrier(*prepared.deformer, pose)
        .ApplyWithNormals(
            [&](std::size_t slot) { return toVector(rest.positions()[slot]); },
            [&](std::size_t slot) { return toVector(rest.normals()[slot]); }, [&] { return Taker(mesh, lock, all); },
            Progress(),
            [&](std::size_t slot) { prefetch(rest.positions()[slot], rest.normals()[slot], mesh.vert[slot]); });
    ParallelFor(0, mesh.vert.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        Sum still;
        for (std::size_t i = first; i < last; ++i)
            if (!prepared.moving[i] && !mesh.vert[i].IsD()) {
                if (mesh.vert[i].cP() != rest.positions()[i]) { // moved by a pose with other tags
                    mesh.vert[i].P() = rest.positions()[i];
                    mesh.vert[i].N() = rest.normals()[i];
                }
                still.add(i, mesh.vert[i].cP());
            }
        const std::lock_guard<std::mutex> guard(lock);
        all.add(still);
    });
    return all;
}

} // namespace

PoseResult poseInPlace(MeshDocument &document, MeshModel &layer, const PoseParam &param, PreparedLayers &preparedLayers,
                       const Remark &remark, const Progress &progress) {
    CMeshO &mesh = layer.cm;
    PoseResult result;
    Stopwatch watch;
    progress(0, "Reading the layer");
    const bool isFirst = !RestShape::exists(layer);
    if (!isFirst && !RestShape(layer).knows(shapeOf(mesh)))
        throw Error(
            "The layer '" + layer.label().toStdString() +
            "' was changed since its last pose, and posing it would undo that. Run 'FCD: Reset Pose' "
            "(apply_coord_fcd_reset): with 'Keep the present shape' poses begin from the shape that it has now, "
            "without it from the shape before the first pose.");
    const Point3m *rest = isFirst ? nullptr : RestShape(layer).positions();
    std::unique_ptr<WhileAtRest> atRest;
    const auto goToRest = [&] {
        if (rest && !atRest)
            atRest = std::make_unique<WhileAtRest>(mesh, rest);
    };
    if (!param.handles.pointFile.isEmpty())
        goToRest();
    vcg::fcd::Handles handles = readHandles(layer, param.handles);

    const std::shared_ptr<Prepared> prepared =
        preparedLayers.get(document, layer, rest, handles, param.deformation, [&] {
            result.prepared = true;
            result.secondsFind = watch.Seconds();
            goToRest();
            Eigen::Matrix3Xd position;
            return PrepareDeformer(mesh, handles, param.deformation, position, progress.Slice(0, 0.9));
        });
    result.secondsPrepare = prepared->seconds;
    result.tags = prepared->tags;
    if (!result.prepared)
        result.secondsFind = watch.Seconds();

    watch = {};
    readMotions(document, layer, param.handles, prepared->deformer->center, remark, handles);
    const vcg::fcd::Deformer::Pose pose = prepared->deformer->Solve(handles, param.deformation, progress.Slice(0.9, 1));
    atRest.reset();
    if (isFirst)
        RestShape::keep(layer);
    result.nodes = int(prepared->deformer->graph.Size());
    result.iterations = pose.iterations;
    result.converged = pose.graph.converged;
    result.secondsSolve = watch.Seconds();

    watch = {};
    RestShape restShape(layer);
    try {
        const Sum sum = writePose(mesh, restShape, *prepared, pose);
        mesh.bbox = sum.box;
        restShape.add(sum.shape);
    } catch (...) { // no memory
        restShape.restore();
        throw;
    }
    result.secondsMap = watch.Seconds();

    watch = {};
    if (param.exactNormals && mesh.fn > 0)
        computeBoxAndNormals(mesh);
    else
        computeFaceNormals(mesh, prepared->moving);
    result.secondsNormals = watch.Seconds();
    progress(1, "Done");
    return result;
}

void resetPose(MeshModel &layer, bool presentShape) {
    if (!RestShape::exists(layer))
        throw Error("The layer '" + layer.label().toStdString() +
                    "' has not been posed in place, so there is no other shape to go back to.");
    if (presentShape)
        RestShape::keep(layer);
    else
        RestShape(layer).restore();
}
