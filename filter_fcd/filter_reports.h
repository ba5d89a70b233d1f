// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FILTER_REPORTS_H
#define FCD_FILTER_REPORTS_H

#include <vcg_ext/field/field_sampling.h> // before Qt

#include <layer_fcd/filter_host.h>
#include <layer_fcd/kept_aside.h>
#include <layer_fcd/layer_compensator.h>
#include <layer_fcd/layer_deformer.h>
#include <layer_fcd/layer_fitter.h>
#include <layer_fcd/layer_sequence.h>
#include <layer_fcd/layer_straightener.h>
#include <layer_fcd/layer_symmetrizer.h>
#include <layer_fcd/parameters.h>
#include <layer_fcd/saved_deformation.h>

#include <string>
#include <vector>

/// \file
/// What the filters say of what they did: in words, and in numbers for scripts.

/// What the surface is like, in words. Mentions only what was met.
std::string describe(const vcg::fcd::SurfaceReport &surface);
/// What describe() tells, for scripts.
HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::SurfaceReport &surface);

std::string describe(const vcg::fcd::TagCount &tags);
HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::TagCount &tags);

/// What a file of a layer has that is saved while it has tags; nothing where these take no place of its own.
std::string describe(const MeshModel &layer, const TagTarget &target);
/// How many new vertices have what was at their place, and how many vertices keep what they have.
std::string describePlaced(const MeshModel &layer, const BroughtBack &made);
std::string describeOthers(const MeshModel &layer, const BroughtBack &made);

/// What loose parts did, and which graph was used where one was given.
std::vector<std::string> describe(const DeformedLayers &made, const DeformMeshParam &param);

/// A sentence for each thing on the way to a pose that is worth knowing.
std::vector<std::string> describe(const vcg::fcd::PoseWay &way);
HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::PoseWay &way);

/// A sentence where there are too few nodes. \param error as Deformer::DiscretisationError gives it
std::string describeDiscretisation(double error);
/// The same for scripts, all of whose values are finite: -1 where it cannot be told.
double valueOfDiscretisation(double error);

/// How well a layer fits, in words and in numbers, besides valuesOf its result.
std::string describe(const FittedLayers &made);
HostFilterPlugin::ReturnedValues valuesOf(const FittedLayers &made);
/// A sentence for each thing for which a fit is not to be trusted.
std::vector<std::string> warningsOf(const FittedLayers &made);

/// What all that deform a surface tell of it, in numbers.
HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::DeformationResult &result);

/// How a layer was straightened, in numbers, besides.
HostFilterPlugin::ReturnedValues valuesOf(const StraightenedLayers &made);
HostFilterPlugin::ReturnedValues valuesOf(const SymmetrizedLayers &made);
HostFilterPlugin::ReturnedValues valuesOf(const CompensatedLayers &made);

/// What was made of poses, in words and in numbers.
std::string describe(const SequenceLayers &made);
HostFilterPlugin::ReturnedValues valuesOf(const SequenceLayers &made);
std::vector<std::string> warningsOf(const SequenceLayers &made);

/// What a saved deformation is like, in words and in numbers.
std::string describe(const SavedDeformation &saved);
HostFilterPlugin::ReturnedValues valuesOf(const SavedDeformation &saved);
std::vector<std::string> warningsOf(const SavedDeformation &saved);

/// What of a layer passes through it, in numbers, and in words where something does.
HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::SurfaceContact &contact);
std::vector<std::string> warningsOf(const vcg::fcd::SurfaceContact &contact);

/// A sentence for each thing that is probably not meant.
std::vector<std::string> describe(const vcg::fcd::DeformationCheck &check, const vcg::fcd::SurfaceReport &surface);

#endif
