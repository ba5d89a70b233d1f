// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled as one: most of the time that each takes goes to Eigen, which they all include. The path does not depend on
// where it is built, so that a compiler cache knows it anywhere.
#include <vcg_ext/fit/fit_contradictions.cpp> // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fit/fit_curves.cpp>         // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fit/fit_gaps.cpp>           // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fit/fit_guess.cpp>          // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fit/fit_landmarks.cpp>      // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fit/fit_matches.cpp>        // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fit/fit_parts.cpp>          // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fit/fit_samples.cpp>        // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fit/fit_start.cpp>          // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fit/fit_system.cpp>         // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fit/fit_target.cpp>         // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fit/one_sided.cpp>          // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fitter.cpp>                 // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fitter_landmarks.cpp>       // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fitter_param.cpp>           // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/fitter_report.cpp>          // NOLINT(bugprone-suspicious-include)
