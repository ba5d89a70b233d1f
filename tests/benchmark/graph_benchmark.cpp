// SPDX-License-Identifier: GPL-3.0-or-later
//
// graph_benchmark FILE...
//
// Builds the deformation graph of each mesh and prints a CSV line with the figures of the paper's figure 2 (m, d_avg,
// k0, t0, D, k1, t1, N, kN, tN; times in ms), what it takes per vertex, how it compares with the plain algorithm (a
// full growth over the mesh by a priority queue in every iteration; same connectivity, seeds, D and tolerance), and the
// coefficient of variation of the patches' areas. Two runs, the faster one counts; plain runs once, and not beyond ten
// million vertices.
#include "../plain_sampling.h"
#include "benchmark_mesh.h"

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/surface/read_surface.h>
#include <vcg_ext/surface/surface_graph.h>

#include <wrap/io_trimesh/import.h>

#include <cstdio>
#include <sys/resource.h>

using benchmark::Face;
using benchmark::Mesh;

namespace {

double peakMegabytes() {
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss / 1024.0;
}

double areaVariation(const Mesh &mesh, const vcg::fcd::SurfaceGraph &surface, const vcg::fcd::Patches &patches) {
    std::vector<double> area(patches.Size(), 0);
    for (const Face &f : mesh.face)
        for (int corner = 0; corner < 3; ++corner)
            area[patches.patchOf[surface.nodeOf[f.cV(corner) - mesh.vert.data()]]] += vcg::DoubleArea(f) / 6;
    double mean = 0, square = 0;
    for (double a : area) {
        mean += a / double(area.size());
        square += a * a / double(area.size());
    }
    return std::sqrt(std::max(0.0, square / (mean * mean) - 1));
}

} // namespace

int main(int argc, char **argv) {
    using namespace vcg::fcd;
    std::printf("mesh,m,d_avg,k0,t0_ms,D,k1,t1_ms,N,kN,tN_ms,graph_ms,ns_per_vertex,extra_bytes_per_vertex,"
                "plain_ms,speedup,cost_over_plain,plain_kN,area_cv\n");
    for (int a = 1; a < argc; ++a) {
        Mesh mesh;
        if (vcg::tri::io::Importer<Mesh>::Open(mesh, argv[a]) != 0) {
            std::fprintf(stderr, "graph_benchmark: cannot read '%s'\n", argv[a]);
            return 1;
        }
        const double before = peakMegabytes();
        SurfaceGraph surface;
        Patches patches;
        PatchParam param;
        double surfaceSeconds = 0, total = 1e300;
        for (int run = 0; run < 2; ++run) {
            surface = SurfaceGraph();
            patches = Patches();
            const Stopwatch watch;
            surface = BuildSurfaceGraph(vcg::tri::ReadSurface(mesh).View());
            const double read = watch.Seconds();
            param.targetRadius =
                0.7 * surface.averageEdge * std::sqrt(double(surface.graph.Size()) / param.initialPatches);
            patches = SamplePatches(surface.graph, {}, {}, param);
            MakeDeformationGraph(surface.graph, {}, surface.nodeArea, patches, GraphWeights::Border);
            if (watch.Seconds() < total) {
                total = watch.Seconds();
                surfaceSeconds = read;
            }
        }
        const double extra = (peakMegabytes() - before) * 1048576 / surface.report.vertices;
        const double scale = surface.frame.scale;
        std::printf("%s,%d,%g,%d,%.1f,%g,%d,%.1f,%d,%d,%.1f,%.1f,%.1f,%.0f,", argv[a], surface.report.vertices,
                    surface.averageEdge * scale, param.initialPatches, surfaceSeconds * 1e3, param.targetRadius * scale,
                    patches.history.size() > 1 ? patches.history[1].patches : patches.Size(),
                    patches.history[0].seconds * 1e3, patches.iterations, patches.Size(),
                    patches.history.back().seconds * 1e3, total * 1e3, total * 1e9 / surface.report.vertices, extra);
        if (surface.report.vertices > 10000000)
            std::printf(",,,,");
        else {
            const Stopwatch watch;
            const fcd_test::PlainPatches plain = fcd_test::SamplePlainly(surface.graph, param);
            const double seconds = watch.Seconds();
            std::printf("%.1f,%.1f,%.3f,%zu,", seconds * 1e3, (surfaceSeconds + seconds) / total,
                        patches.cost / plain.cost, plain.center.size());
        }
        std::printf("%.3f\n", areaVariation(mesh, surface, patches));
        std::fflush(stdout);
    }
}
