// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled as one: most of the time that each takes goes to Eigen, which they all include. The path does not depend on
// where it is built, so that a compiler cache knows it anywhere.
#include <vcg_ext/sequence/frame_files.cpp>     // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/sequence/gltf_file.cpp>       // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/sequence/gltf_json.cpp>       // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/sequence/pose_sequence.cpp>   // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/sequence/sequence_frames.cpp> // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/sequence/sequence_solver.cpp> // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/sequence/surface_look.cpp>    // NOLINT(bugprone-suspicious-include)
