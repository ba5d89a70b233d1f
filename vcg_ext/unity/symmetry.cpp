// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled as one: most of the time that each takes goes to Eigen, which they all include. The path does not depend on
// where it is built, so that a compiler cache knows it anywhere.
#include <vcg_ext/compensator.cpp>           // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/symmetrizer.cpp>           // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/symmetrizer_report.cpp>    // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/symmetry/best_plane.cpp>   // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/symmetry/half_pose.cpp>    // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/symmetry/mirror_plane.cpp> // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/warp/smooth_warp.cpp>      // NOLINT(bugprone-suspicious-include)
