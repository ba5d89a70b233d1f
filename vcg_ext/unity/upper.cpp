// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled as one: most of the time that each takes goes to Eigen, which they all include. The path does not depend on
// where it is built, so that a compiler cache knows it anywhere.
#include <vcg_ext/map/carrier.cpp>             // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/map/deformation_check.cpp>   // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/map/graph_mapping.cpp>       // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/map/kept_volume.cpp>         // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/map/mapping_kernel.cpp>      // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/map/moving_region.cpp>       // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/field/deformation_field.cpp> // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/field/deformation_file.cpp>  // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/field/field_sampling.cpp>    // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/deform_surface.cpp>          // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/deformer.cpp>                // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/deformer_graph.cpp>          // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/region_deformer.cpp>         // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/deformer_maker.cpp>          // NOLINT(bugprone-suspicious-include)
#include <vcg_ext/region_reader.cpp>           // NOLINT(bugprone-suspicious-include)
