// SPDX-License-Identifier: GPL-3.0-or-later
//
// deformation_benchmark DIRECTORY STEM...
//
// Deforms STEM.off or STEM.ply by STEM.sel and STEM.def with default parameters, and with CGAL's SR-ARAP and ARAP of
// the mesh itself, in one run. Prints a CSV line for each: nodes, iterations, root mean square distance to the limit of
// the method's own iterations (per cent of the diagonal), seconds from the mesh to the result, and the ratio to our
// seconds. We stop where we do. CGAL's SR-ARAP stops (sr_arap) when nothing moves by more than our solver's tolerance
// in an iteration, and (sr_arap_as_near) when it is as near to its limit as we are to ours; ARAP is for the eye and
// stops as sr_arap does. The results go to DIRECTORY/NAME_METHOD.off.
#include "benchmark_mesh.h"

#include <vcg_ext/centroidal_deformation.h>
#include <vcg_ext/handle_file.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>
#include <wrap/io_trimesh/export_off.h>
#include <wrap/io_trimesh/import.h>

#include <cstdio>

using benchmark::Face;
using benchmark::Mesh;
using benchmark::Vertex;

namespace {

using vcg::fcd::Handles;
using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

using Positions = Eigen::Matrix3Xd;

struct Result {
    Positions position;
    int nodes = 0, iterations = 0;
    double seconds = 0;
};

double distance(const Mesh &mesh, const Positions &a, const Positions &b) {
    return std::sqrt((a - b).colwise().squaredNorm().mean()) / mesh.bbox.Diag();
}

Result deformWithUs(const Mesh &mesh, const Handles &handles, const vcg::fcd::DeformationParam &param = {}) {
    const vcg::fcd::Stopwatch watch;
    const auto result = vcg::tri::DeformCentroidal(mesh, handles, param);
    return {result.position, int(result.rest.position.cols()), result.iterations, watch.Seconds()};
}

/// Iterates until done(positions, largest motion of the iteration over the diagonal).
template <CGAL::Deformation_algorithm_tag algorithm, class Done>
Result deformWithCgal(const Mesh &mesh, const Handles &handles, const Done &done) {
    Surface surface;
    for (const Vertex &v : mesh.vert)
        surface.add_vertex(Kernel::Point_3(v.cP()[0], v.cP()[1], v.cP()[2]));
    const auto vertex = [](std::size_t i) { return Surface::Vertex_index(Surface::size_type(i)); };
    for (const Face &f : mesh.face)
        surface.add_face(vertex(vcg::tri::Index(mesh, f.cV(0))), vertex(vcg::tri::Index(mesh, f.cV(1))),
                         vertex(vcg::tri::Index(mesh, f.cV(2))));

    const vcg::fcd::Stopwatch watch;
    CGAL::Surface_mesh_deformation<Surface, CGAL::Default, CGAL::Default, algorithm> deformation(surface);
    for (Surface::Vertex_index v : vertices(surface))
        deformation.insert_roi_vertex(v);
    for (Surface::Vertex_index v : vertices(surface))
        if (handles.tag[v] != 1)
            deformation.insert_control_vertex(v);
    if (!deformation.preprocess())
        throw vcg::fcd::Error("CGAL cannot factorise the matrix.");
    for (Surface::Vertex_index v : vertices(surface))
        if (handles.tag[v] >= 2) {
            const Kernel::Point_3 p = surface.point(v);
            const Eigen::Vector4d q =
                handles.motion.at(handles.tag[v]).matrix * Eigen::Vector4d(p.x(), p.y(), p.z(), 1);
            deformation.set_target_position(v, Kernel::Point_3(q[0], q[1], q[2]));
        }
    Result result{Positions::Constant(3, mesh.vert.size(), 1e300), int(surface.number_of_vertices())};
    double moved = 0;
    do {
        deformation.deform(1, 0);
        moved = 0;
        for (Surface::Vertex_index v : vertices(surface)) {
            const Eigen::Vector3d p(surface.point(v).x(), surface.point(v).y(), surface.point(v).z());
            moved = std::max(moved, (p - result.position.col(v)).norm() / mesh.bbox.Diag());
            result.position.col(v) = p;
        }
    } while (++result.iterations < 100000 && !done(result.position, moved));
    result.seconds = watch.Seconds();
    return result;
}

} // namespace

int main(int argc, char **argv) {
    std::printf("mesh,method,nodes,iterations,from_limit_percent,seconds,times_ours\n");
    for (int a = 2; a < argc; ++a) {
        const std::string stem = argv[a], name = stem.substr(stem.find_last_of('/') + 1);
        Mesh mesh;
        if (vcg::tri::io::Importer<Mesh>::Open(mesh, (stem + ".off").c_str()) != 0 &&
            vcg::tri::io::Importer<Mesh>::Open(mesh, (stem + ".ply").c_str()) != 0) {
            std::fprintf(stderr, "deformation_benchmark: cannot read '%s' (.off or .ply)\n", argv[a]);
            return 1;
        }
        vcg::tri::UpdateBounding<Mesh>::Box(mesh);
        Handles handles;
        try {
            handles.tag = vcg::fcd::ReadTagFile(stem + ".sel");
            const auto transforms = vcg::fcd::ReadTransformFile(stem + ".def");
            for (std::size_t i = 0; i < transforms.size(); ++i)
                handles.motion[vcg::fcd::Index(2 + i)] = vcg::fcd::Motion(transforms[i]);
            const Mesh &rest = mesh;
            const double tolerance = vcg::fcd::SolverParam().tolerance;
            const auto still = [&](const Positions &, double moved) { return moved <= tolerance; };
            vcg::fcd::DeformationParam exact;
            exact.tolerance = 1e-3 * tolerance;
            exact.maxIterations = 100000;

            std::vector<Result> runs; // of milliseconds: the median counts
            for (int run = 0; run < 9; ++run)
                runs.push_back(deformWithUs(rest, handles));
            std::nth_element(runs.begin(), runs.begin() + 4, runs.end(),
                             [](const Result &a, const Result &b) { return a.seconds < b.seconds; });
            const Result ours = runs[4], arap = deformWithCgal<CGAL::ORIGINAL_ARAP>(rest, handles, still),
                         smooth = deformWithCgal<CGAL::SRE_ARAP>(rest, handles, still);
            const Positions ourLimit = deformWithUs(rest, handles, exact).position;
            const Positions limit = deformWithCgal<CGAL::SRE_ARAP>(rest, handles, [&](const Positions &, double moved) {
                                        return moved <= 1e-2 * tolerance;
                                    }).position;
            const double near = distance(rest, ours.position, ourLimit);
            const Result asNear = deformWithCgal<CGAL::SRE_ARAP>(
                rest, handles, [&](const Positions &p, double) { return distance(rest, p, limit) <= near; });

            const auto report = [&](const char *method, const Result &result, double fromLimit) {
                std::printf("%s,%s,%d,%d,%.4f,%.4f,%.0f\n", name.c_str(), method, result.nodes, result.iterations,
                            100 * fromLimit, result.seconds, result.seconds / ours.seconds);
                std::fflush(stdout);
                for (std::size_t i = 0; i < mesh.vert.size(); ++i)
                    mesh.vert[i].P() =
                        vcg::Point3d(result.position(0, i), result.position(1, i), result.position(2, i));
                vcg::tri::io::ExporterOFF<Mesh>::Save(
                    mesh, (std::string(argv[1]) + "/" + name + "_" + method + ".off").c_str());
            };
            report("fcd", ours, near);
            report("sr_arap", smooth, distance(mesh, smooth.position, limit));
            report("sr_arap_as_near", asNear, distance(mesh, asNear.position, limit));
            report("arap", arap, std::nan(""));
        } catch (const std::exception &e) {
            std::fprintf(stderr, "deformation_benchmark: %s: %s\n", argv[a], e.what());
            return 1;
        }
    }
}
