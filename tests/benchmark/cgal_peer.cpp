// SPDX-License-Identifier: GPL-3.0-or-later
//
// cgal_peer arap|sr_arap STEM TOLERANCE OUT
//
// Deforms STEM.off or STEM.ply by STEM.sel and STEM.def with CGAL, until nothing moves by more than TOLERANCE times the
// diagonal in an iteration. Prints seconds, iterations and MB beyond those of the mesh; the positions go to OUT, 3
// doubles a vertex. For tests/peers.py.
#include "case_files.h"
#include "cgal_deformation.h"

#include <cstdio>
#include <fstream>

namespace {

/// A field of what Linux tells of this process, in MB.
double megabytes(const std::string &field) {
    std::ifstream status("/proc/self/status");
    for (std::string name; status >> name;)
        if (name == field + ":") {
            double kilobytes = 0;
            status >> kilobytes;
            return kilobytes / 1024;
        }
    return 0;
}

} // namespace

int main(int argc, char **argv) {
    if (argc != 5) {
        std::fprintf(stderr, "usage: cgal_peer arap|sr_arap STEM TOLERANCE OUT\n");
        return 2;
    }
    try {
        benchmark::Mesh mesh;
        vcg::fcd::Handles handles;
        benchmark::ReadCase(argv[2], mesh, handles);
        const double tolerance = std::atof(argv[3]);
        std::ofstream("/proc/self/clear_refs") << 5; // the peak from here on
        const double before = megabytes("VmRSS");
        const auto still = [&](const benchmark::Positions &, double moved) { return moved <= tolerance; };
        const vcg::fcd::Stopwatch watch;
        const auto result = std::string(argv[1]) == "arap"
                                ? benchmark::DeformWithCgal<CGAL::ORIGINAL_ARAP>(mesh, handles, still)
                                : benchmark::DeformWithCgal<CGAL::SRE_ARAP>(mesh, handles, still);
        std::printf("{\"seconds\": %.6f, \"iterations\": %d, \"megabytes\": %.1f}\n", watch.Seconds(),
                    result.Iterations(), megabytes("VmHWM") - before);
        std::ofstream out(argv[4], std::ios::binary);
        out.write(reinterpret_cast<const char *>(result.position.data()),
                  std::streamsize(std::size_t(result.position.size()) * sizeof(double)));
        return out ? 0 : 1;
    } catch (const std::exception &e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
