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
//
// DIRECTORY/NAME_error.csv tells how far, after so many seconds, each is from the limit of CGAL's SR-ARAP (root mean
// square, per cent of the diagonal): CGAL in every iteration, we with the patches of the default and with a node at
// every vertex, after 1, 2, 4 ... iterations, each from the start.
#include "case_files.h"
#include "cgal_deformation.h"

#include <vcg_ext/centroidal_deformation.h>

#include <cstdio>
#include <fstream>

using benchmark::Mesh;
using benchmark::Positions;

namespace {

using vcg::fcd::Handles;

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

template <CGAL::Deformation_algorithm_tag algorithm, class Done>
Result deformWithCgal(const Mesh &mesh, const Handles &handles, const Done &done) {
    const auto result = benchmark::DeformWithCgal<algorithm>(mesh, handles, done);
    return {result.position, int(mesh.vert.size()), result.Iterations(), result.seconds};
}

} // namespace

int main(int argc, char **argv) {
    std::printf("mesh,method,nodes,iterations,from_limit_percent,seconds,times_ours\n");
    for (int a = 2; a < argc; ++a) {
        const std::string name = benchmark::NameOf(argv[a]);
        Mesh mesh;
        Handles handles;
        try {
            benchmark::ReadCase(argv[a], mesh, handles);
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
            std::ofstream errors(std::string(argv[1]) + "/" + name + "_error.csv");
            errors << "method,seconds,percent\n";
            const auto note = [&](const char *method, double seconds, const Positions &p) {
                const double off = distance(rest, p, limit);
                errors << method << ',' << seconds << ',' << 100 * off << '\n';
                return off;
            };
            const vcg::fcd::Stopwatch watch;
            const Result asNear = deformWithCgal<CGAL::SRE_ARAP>(
                rest, handles, [&](const Positions &p, double) { return note("sr_arap", watch.Seconds(), p) <= near; });
            for (const bool atEveryVertex : {false, true}) {
                vcg::fcd::DeformationParam param;
                if (atEveryVertex)
                    param.graph.initialPatches = int(rest.vert.size());
                bool isAtRest = false;
                for (param.maxIterations = 1; !isAtRest && param.maxIterations <= 1024; param.maxIterations *= 2) {
                    const Result some = deformWithUs(rest, handles, param);
                    note(atEveryVertex ? "every_vertex" : "fcd", some.seconds, some.position);
                    isAtRest = some.iterations < param.maxIterations;
                }
            }

            const auto report = [&](const char *method, const Result &result, double fromLimit) {
                std::printf("%s,%s,%d,%d,%.4f,%.4f,%.0f\n", name.c_str(), method, result.nodes, result.iterations,
                            100 * fromLimit, result.seconds, result.seconds / ours.seconds);
                std::fflush(stdout);
                benchmark::WriteOff(mesh, result.position, std::string(argv[1]) + "/" + name + "_" + method + ".off");
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
