// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled as one: most of the time that each takes goes to Eigen, which they all include. The path does not depend on
// where it is built, so that a compiler cache knows it anywhere.
#include <vcg_ext/base/frame.cpp>               // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/base/parallel.cpp>            // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/base/rotation_fit.cpp>        // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/base/words.cpp>               // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/handles/handle_file.cpp>      // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/handles/handles.cpp>          // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/handles/motion_text.cpp>      // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/surface/face_normals.cpp>     // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/surface/free_region.cpp>      // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/surface/loose_parts.cpp>      // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/surface/nearest_place.cpp>    // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/surface/surface_arrays.cpp>   // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/surface/surface_graph.cpp>    // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/surface/surface_reach.cpp>    // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/surface/surface_regions.cpp>  // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/surface/triangle_stretch.cpp> // NOLINT(bugprone-suspicious-include)
