// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_COMMON_PARAMETERS_H
#define FCD_COMMON_PARAMETERS_H

#include "filter_parameters.h"

/// \file
/// What several filters ask for.

// What moves, and how.
/// \param shown what says how handles move, and which
void addHandles(RichParameterList &list, const HandleParam &handles, const MeshDocument &document,
                host::Shown shown = host::Shown::Always);
/// \throw vcg::fcd::Error when a value makes no sense
HandleParam handleParam(const RichParameterList &list, const MeshDocument &document);

// With which graph.
void addTargetRadius(RichParameterList &list, double targetRadius, const MeshDocument &document,
                     host::Shown shown = host::Shown::Advanced);
void addInitialPatches(RichParameterList &list, int initialPatches, host::Shown shown = host::Shown::Advanced);
void addRandomSeed(RichParameterList &list, unsigned randomSeed);
vcg::fcd::GraphParam graphParam(const RichParameterList &list);

// How it bends.
void addSmoothness(RichParameterList &list, host::Shown shown, double smoothness);
/// Where scripts may lack it; else it is smooth.
void addFalloff(RichParameterList &list, vcg::fcd::Falloff falloff);
vcg::fcd::Falloff falloff(const RichParameterList &list);
void addElastic(RichParameterList &list, bool elastic);
bool elastic(const RichParameterList &list);
/// \param all also what a filter may lack where scripts may not
void addBending(RichParameterList &list, const vcg::fcd::DeformationParam &deformation, bool all);
/// All but nodes, and what is measured. \throw vcg::fcd::Error when a value makes no sense
vcg::fcd::DeformationParam deformationParam(const RichParameterList &list, bool all);

// What filters that match surfaces have alike.
/// The layer to lie on. \param given or null: the only other one, or else the current one, which is none
void addOtherLayer(RichParameterList &list, const char *name, const MeshModel *given, const MeshDocument &document,
                   const QString &label, const QString &help);
void addWeightSource(RichParameterList &list, const char *name, FitMeshParam::Weights weights, const QString &label,
                     const QString &help);
void addWeightAttribute(RichParameterList &list, const QString &name, const QString &help);
void addStiffness(RichParameterList &list, const vcg::fcd::FitParam &fit);
void addLargestDistance(RichParameterList &list, const QString &help);
/// Infinite where it is 0.
double largestDistance(const RichParameterList &list);
void addLandmarkTolerance(RichParameterList &list, const vcg::fcd::FitParam &fit);
void addSamples(RichParameterList &list, int samples, const QString &help);
/// The graph, samples and steps.
void addSampling(RichParameterList &list, const vcg::fcd::FitParam &fit);
/// All of a fit from stiffness to the number of steps; not checked.
void readFitting(const RichParameterList &list, vcg::fcd::FitParam &fit);

/// Whether the result also tells how far each vertex went, as an attribute.
void addDisplacement(RichParameterList &list, bool displacement);
bool displacement(const RichParameterList &list);

/// Whether the graph is added as layers, too.
void addGraphLayers(RichParameterList &list, bool graphLayers);

/// \p list with the parameters \p first before the others, which come last or, without \p others, not at all; with
/// handleLayer first where an older script may lack it.
RichParameterList inOrder(const RichParameterList &list, QStringList first, bool others);

/// The value of an enum parameter with \p count values. \throw vcg::fcd::Error when it is none of them
int enumValue(const RichParameterList &list, const char *name, int count);

#endif
