// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FILTER_REPORTS_H
#define FCD_FILTER_REPORTS_H

#include <vcg_ext/field/field_sampling.h> // before Qt

#include <layer_fcd/deformation_uses.h>
#include <layer_fcd/filter_host.h>
#include <layer_fcd/kept_aside.h>
#include <layer_fcd/layer_corrections.h>
#include <layer_fcd/layer_deformer.h>
#include <layer_fcd/layer_fitter.h>
#include <layer_fcd/layer_sequence.h>
#include <layer_fcd/layer_straightener.h>
#include <layer_fcd/parameters.h>

#include <string>
#include <vector>

/// \file
/// Reports of the filters: describe() and warningsOf() in words, for the log; valuesOf() in numbers, for scripts.

/// The properties of a surface that are not as usual.
std::string describe(const vcg::fcd::SurfaceReport &surface);
HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::SurfaceReport &surface);

std::string describe(const vcg::fcd::TagCount &tags);
HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::TagCount &tags);

/// What a file of the layer holds if it is saved while it has tags; empty if tags replace nothing.
std::string describe(const MeshModel &layer, const TagTarget &target);

/// Loose parts, and the use of a given graph.
std::vector<std::string> describe(const DeformedLayers &made, const DeformMeshParam &param);

HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::PosePath &path);

/// An error, as in Deformer::DiscretisationError, for scripts, which get finite values only: -1 if it is unknown.
double valueOfDiscretisation(double error);

/// How well a layer fits; besides valuesOf its result.
std::string describe(const FittedLayers &made);
HostFilterPlugin::ReturnedValues valuesOf(const FittedLayers &made);
std::vector<std::string> warningsOf(const FittedLayers &made);

/// The values of all filters that deform a surface.
HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::DeformationResult &result);

/// Besides valuesOf the result.
HostFilterPlugin::ReturnedValues valuesOf(const StraightenedLayers &made);
HostFilterPlugin::ReturnedValues valuesOf(const SymmetrizedLayers &made);
HostFilterPlugin::ReturnedValues valuesOf(const CompensatedLayers &made);
inline std::vector<std::string> warningsOf(const CompensatedLayers &made) { return made.report.Warnings(); }

std::string describe(const SequenceLayers &made);
HostFilterPlugin::ReturnedValues valuesOf(const SequenceLayers &made);
std::vector<std::string> warningsOf(const SequenceLayers &made);

std::string describe(const SavedDeformation &saved);
HostFilterPlugin::ReturnedValues valuesOf(const SavedDeformation &saved);
std::vector<std::string> warningsOf(const SavedDeformation &saved);

HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::SurfaceContact &contact);
std::vector<std::string> warningsOf(const vcg::fcd::SurfaceContact &contact);

/// What is probably unwanted in a pose, a sentence each.
std::vector<std::string> describe(const vcg::fcd::DeformationCheck &check, const vcg::fcd::SurfaceReport &surface);

#endif
