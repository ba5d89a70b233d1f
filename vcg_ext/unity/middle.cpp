// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled as one: most of the time that each takes goes to Eigen, which they all include. The path does not depend on
// where it is built, so that a compiler cache knows it anywhere.
#include <vcg_ext/patches/given_nodes.cpp>        // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/patches/patch_sampling.cpp>     // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/patches/surface_patches.cpp>    // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/graph/border_weights.cpp>       // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/graph/coarse_graph.cpp>         // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/graph/deformation_graph.cpp>    // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/graph/falloff.cpp>              // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/graph/held_nodes.cpp>           // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/solve/affine_deformer.cpp>      // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/solve/discretisation_error.cpp> // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/solve/graph_parts.cpp>          // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/solve/graph_pose.cpp>           // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/solve/patch_number.cpp>         // NOLINT(bugprone-suspicious-include)
