// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FILTER_PARAMETERS_H
#define FCD_FILTER_PARAMETERS_H

#include "fields.h"

/// \file
/// The parameters of the filters: each is declared once, for dialogs, scripts and reading.

/// Parameters of filters for older scripts, which do a part of "FCD: Tag".
struct TagSelectionParam : TagParam {};
struct TagsFromFilesParam : TagParam {};

struct SaveSessionParam {
    QString file; ///< .fcd
};
struct LoadSessionParam {
    QString file; ///< .fcd
};

/// Declares or reads the parameters of a filter. \throw vcg::fcd::Error a value that is read is invalid
void ask(Fields &fields, BuildGraphParam &param);
void ask(Fields &fields, DeformMeshParam &param);
void ask(Fields &fields, FitMeshParam &param);
void ask(Fields &fields, StraightenMeshParam &param);
void ask(Fields &fields, SymmetrizeParam &param);
void ask(Fields &fields, CompensateLayerParam &param);
void ask(Fields &fields, SequenceParam &param);
void ask(Fields &fields, PoseParam &param);
void ask(Fields &fields, ResetPoseParam &param);
void ask(Fields &fields, CopyParam &param);
void ask(Fields &fields, SaveDeformationParam &param);
void ask(Fields &fields, TagParam &param);
void ask(Fields &fields, TagSelectionParam &param);
void ask(Fields &fields, TagsFromFilesParam &param);
void ask(Fields &fields, SaveTagsParam &param);
void ask(Fields &fields, SaveSessionParam &param);
void ask(Fields &fields, LoadSessionParam &param);

/// The parameters with their defaults, for the host.
template <class Param>
RichParameterList parametersOf(const MeshDocument &document) {
    Param param;
    Fields fields(document);
    ask(fields, param);
    return fields.declared();
}

/// Reads the parameters of the host. \throw vcg::fcd::Error a value is invalid
template <class Param>
Param read(const RichParameterList &given, const MeshDocument &document) {
    Param param;
    Fields fields(document, given);
    ask(fields, param);
    return param;
}

// --- parameters of several filters ---

/// Tags and motions. \param shown of the parameters for motions
void askHandles(Fields &fields, HandleParam &handles, host::Shown shown = host::Shown::Always);
/// The tags alone.
void askTags(Fields &fields, HandleParam &handles, host::Shown shown = host::Shown::Always);

// The graph.
void askTargetRadius(Fields &fields, vcg::fcd::GraphParam &graph, host::Shown shown = host::Shown::Advanced);
void askInitialPatches(Fields &fields, vcg::fcd::GraphParam &graph, host::Shown shown = host::Shown::Advanced);
void askRandomSeed(Fields &fields, vcg::fcd::GraphParam &graph);

// The deformation.
void askSmoothness(Fields &fields, double &smoothness, host::Shown shown = host::Shown::Advanced);
/// Smoothness and, if scripts may lack these, falloff, elasticity and rigidity.
void askElasticity(Fields &fields, vcg::fcd::DeformationParam &deformation);
/// All of \p deformation but the graph and what is measured. \param all also newer parameters, which old scripts lack
void askBending(Fields &fields, vcg::fcd::DeformationParam &deformation, bool all);

/// Whether to add the graph as layers.
void askGraphLayers(Fields &fields, bool &graphLayers);

#endif
