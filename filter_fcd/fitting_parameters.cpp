// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

#include <limits>

// What the filters that match surfaces ask for.

using host::addParameter;
using host::Shown;

namespace {

/// The only other layer, or else the current one, which is no target.
const MeshModel *likelyTarget(const MeshDocument &document) {
    const std::vector<const MeshModel *> layers = host::layers(document);
    const MeshModel *current = const_cast<MeshDocument &>(document).mm(); // which is not changed
    if (layers.size() != 2)
        return current;
    return layers[0] == current ? layers[1] : layers[0];
}

} // namespace

void addOtherLayer(RichParameterList &list, const char *name, const MeshModel *given, const MeshDocument &document,
                   const QString &label, const QString &help) {
    host::addLayerParameter(list, Shown::Always, name, given ? given : likelyTarget(document), document, label, help);
}

void addWeightSource(RichParameterList &list, const char *name, FitMeshParam::Weights weights, const QString &label,
                     const QString &help) {
    addParameter<RichEnum>(list, Shown::Always, name, int(weights),
                           QStringList() << "All counts"
                                         << "Vertex quality"
                                         << "Selected vertices"
                                         << "Attribute",
                           label, help);
}

void addWeightAttribute(RichParameterList &list, const QString &name, const QString &help) {
    addParameter<RichString>(list, Shown::Advanced, "weight_attribute", name, "Attribute with weights", help);
}

void addStiffness(RichParameterList &list, const vcg::fcd::FitParam &fit) {
    addParameter<RichFloat>(list, Shown::Always, "stiffness", Scalarm(fit.stiffness),
                            "Stiffness (1 is the default, 10 stiff)",
                            "How rigid the surface is in the end. <b>Raise it</b> to smooth over noise and holes of "
                            "the target. <b>Lower it</b> to follow finer detail.");
}

void addLargestDistance(RichParameterList &list, const QString &help) {
    addParameter<RichFloat>(list, Shown::Always, "largest_distance", Scalarm(0), "Largest distance", help);
}

double largestDistance(const RichParameterList &list) {
    const double given = asTyped(list.getFloat("largest_distance"));
    return given == 0 ? std::numeric_limits<double>::infinity() : given;
}

void addLandmarkTolerance(RichParameterList &list, const vcg::fcd::FitParam &fit) {
    addParameter<RichFloat>(
        list, Shown::Advanced, "landmark_tolerance", Scalarm(fit.landmarkTolerance), "Landmark tolerance",
        "How far a landmark may stay from where it belongs, in world units. <b>0</b> (the default): it is exact. "
        "<b>Raise it</b> to the error of measured or picked points. Pairs that the others contradict, such as two that "
        "are mixed up, are then left out. The log names them in any case.");
}

void addSamples(RichParameterList &list, int samples, const QString &help) {
    addParameter<RichInt>(list, Shown::Advanced, "samples", samples, "Samples", help);
}

void addSampling(RichParameterList &list, const vcg::fcd::FitParam &fit) {
    addInitialPatches(list, fit.graph.initialPatches);
    addSmoothness(list, Shown::Advanced, fit.smoothness);
    addRandomSeed(list, fit.graph.randomSeed);
    addSamples(list, fit.samples,
               "How many places of the surface are matched, evenly spread. <b>Raise it</b> where there are many "
               "patches; it takes longer.");
    addParameter<RichInt>(list, Shown::Advanced, "fit_steps", fit.fitSteps, "Steps",
                          "The most steps from stiff to soft; the less the surface moves, the fewer it takes. <b>Raise "
                          "it</b> where it has far to go, or when the log says that it did not converge.");
}

void readFitting(const RichParameterList &list, vcg::fcd::FitParam &fit) {
    fit.stiffness = asTyped(list.getFloat("stiffness"));
    fit.largestDistance = largestDistance(list);
    fit.landmarkTolerance = asTyped(list.getFloat("landmark_tolerance"));
    fit.graph.initialPatches = list.getInt("initial_patches");
    fit.graph.randomSeed = unsigned(list.getInt("random_seed"));
    fit.smoothness = asTyped(list.getFloat("smoothness"));
    fit.samples = list.getInt("samples");
    fit.fitSteps = list.getInt("fit_steps");
}
