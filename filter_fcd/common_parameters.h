// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_COMMON_PARAMETERS_H
#define FCD_COMMON_PARAMETERS_H

#include "filter_parameters.h"

/// \file
/// Parameters of several filters.

// Tags and motions.
/// Not validated. \param shown of the parameters for motions
void askHandles(Fields &fields, HandleParam &handles, host::Shown shown = host::Shown::Always);
// Parts of it.
void askTags(Fields &fields, HandleParam &handles, host::Shown shown = host::Shown::Always);
void askTagAttribute(Fields &fields, HandleParam &handles);
void askMotionText(Fields &fields, HandleParam &handles, host::Shown shown = host::Shown::Always);
void askMotion(Fields &fields, HandleParam &handles, host::Shown shown = host::Shown::Always);

// The graph.
void askTargetRadius(Fields &fields, vcg::fcd::GraphParam &graph, host::Shown shown = host::Shown::Advanced);
void askInitialPatches(Fields &fields, vcg::fcd::GraphParam &graph, host::Shown shown = host::Shown::Advanced);
void askRandomSeed(Fields &fields, vcg::fcd::GraphParam &graph);

// The deformation.
void askSmoothness(Fields &fields, double &smoothness, host::Shown shown = host::Shown::Advanced);
// Only if scripts may lack them.
void askFalloff(Fields &fields, vcg::fcd::Falloff &falloff);
void askElastic(Fields &fields, bool &elastic);
void askRigidity(Fields &fields, double &rigidity);
/// All of \p deformation but the graph and what is measured. \param all also newer parameters, which old scripts lack
void askBending(Fields &fields, vcg::fcd::DeformationParam &deformation, bool all);

// Filters that match surfaces.
/// The target. The default is the only other layer, or else the current one, which is no target.
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

/// Whether to add the attribute "fcd_displacement". Only if scripts may lack it.
void askDisplacement(Fields &fields, bool &displacement);
/// Whether to add the graph as layers.
void askGraphLayers(Fields &fields, bool &graphLayers);

#endif
