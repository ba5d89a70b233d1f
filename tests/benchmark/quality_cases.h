// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_QUALITY_CASES_H
#define FCD_QUALITY_CASES_H

#include "benchmark_mesh.h"

#include <vcg_ext/handles/handles.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

/// The cases of quality_benchmark.
namespace benchmark {

/// A mesh, and how it is to be deformed.
struct Problem {
    Mesh mesh;
    vcg::fcd::Handles handles;
};

struct Instance {
    std::unique_ptr<Problem> problem;
    std::unique_ptr<Problem>
        fine;                ///< what was decimated to the problem, or none: the reference is the deformed \p fine
    std::vector<int> inFine; ///< which vertex of it each one of the problem is
};

enum class Half {
    Training, ///< constants that shape the result are chosen on these
    HeldOut,  ///< and not on these
    Buckles,  ///< nor on these, where the reference rests in another minimum: no mean counts them
    Given     ///< from files
};

struct Case {
    std::string name, what;
    Half half;
    std::function<Instance()> make;
};

std::vector<Case> MakeCases();

/// The case of STEM.off or STEM.ply, STEM.sel and STEM.def.
Case CaseOfFiles(const std::string &stem);

} // namespace benchmark

#endif
