// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled as one: most of the time that each takes goes to Eigen, which they all include. The path does not depend on
// where it is built, so that a compiler cache knows it anywhere.
#include <vcg_ext/line/framed_line.cpp>         // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/line/line_jitter.cpp>         // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/line/line_motion.cpp>         // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/line/line_points.cpp>         // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/straighten/line_places.cpp>   // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/straighten/line_sections.cpp> // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/straightener.cpp>             // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/straightener_report.cpp>      // NOLINT(bugprone-suspicious-include)
