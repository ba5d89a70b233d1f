// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_COMMON_PARAMETERS_H
#define FCD_COMMON_PARAMETERS_H

#include "filter_parameters.h"

/// \file
/// What several filters ask for.

// What moves, and how.
/// \param shown what says how handles move, and which. Not validated
void askHandles(Fields &fields, HandleParam &handles, host::Shown shown = host::Shown::Always);
// Parts of it.
void askTags(Fields &fields, HandleParam &handles, host::Shown shown = host::Shown::Always);
void askTagAttribute(Fields &fields, HandleParam &handles);
void askMotionText(Fields &fields, HandleParam &handles, host::Shown shown = host::Shown::Always);
void askMotion(Fields &fields, HandleParam &handles, host::Shown shown = host::Shown::Always);

// With which graph.
void askTargetRadius(Fields &fields, vcg::fcd::GraphParam &graph, host::Shown shown = host::Shown::Advanced);
void askInitialPatches(Fields &fields, vcg::fcd::GraphParam &graph, host::Shown shown = host::Shown::Advanced);
void askRandomSeed(Fields &fields, vcg::fcd::GraphParam &graph);

// How it bends.
void askSmoothness(Fields &fields, double &smoothness, host::Shown shown = host::Shown::Advanced);
// Where scripts may lack them.
void askFalloff(Fields &fields, vcg::fcd::Falloff &falloff);
void askElastic(Fields &fields, bool &elastic);
void askRigidity(Fields &fields, double &rigidity);
/// All but the graph, and what is measured. \param all also what a filter may lack where scripts may not
void askBending(Fields &fields, vcg::fcd::DeformationParam &deformation, bool all);

// What filters that match surfaces have alike.
/// The layer to lie on. By default the only other one, or else the current one, which is none.
void askOtherLayer(Fields &fields, const QString &name, const MeshModel *&layer, const QString &label,
                   const QString &help);
void askWeightSource(Fields &fields, const QString &name, FitMeshParam::Weights &weights, const QString &label,
                     const QString &help);
void askWeightAttribute(Fields &fields, QString &name, const QString &help);
void askStiffness(Fields &fields, vcg::fcd::FitParam &fit);
/// 0 for infinite.
void askLargestDistance(Fields &fields, double &distance, const QString &help);
void askLandmarkTolerance(Fields &fields, vcg::fcd::FitParam &fit);
void askSamples(Fields &fields, int &samples, const QString &help);
/// The graph, samples and steps.
void askSampling(Fields &fields, vcg::fcd::FitParam &fit);

/// Whether the result also tells how far each vertex went, as an attribute. Where scripts may lack it.
void askDisplacement(Fields &fields, bool &displacement);
/// Whether the graph is added as layers, too.
void askGraphLayers(Fields &fields, bool &graphLayers);

#endif
