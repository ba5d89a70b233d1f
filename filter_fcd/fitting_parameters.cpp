// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

#include <limits>

// Parameters of the filters that match surfaces.

using host::Shown;

namespace {

/// The default target: the only other layer, or else the current one, which is no target.
const MeshModel *likelyTarget(const MeshDocument &document) {
    const std::vector<const MeshModel *> layers = host::layers(document);
    if (layers.size() != 2)
        return document.mm();
    return layers[0] == document.mm() ? layers[1] : layers[0];
}

} // namespace

void askOtherLayer(Fields &fields, const QString &name, const MeshModel *&layer, const QString &label,
                   const QString &help) {
    fields.layer(name, layer, likelyTarget(fields.document), Shown::Always, label, help);
}

void askWeightSource(Fields &fields, const QString &name, FitMeshParam::Weights &weights, const QString &label,
                     const QString &help) {
    fields.choice(name, weights, Shown::Always, {"All counts", "Vertex quality", "Selected vertices", "Attribute"},
                  label, help);
}

void askWeightAttribute(Fields &fields, QString &name, const QString &help) {
    fields.field("weight_attribute", name, Shown::Advanced, "Attribute with weights", help);
}

void askStiffness(Fields &fields, vcg::fcd::FitParam &fit) {
    fields.field("stiffness", fit.stiffness, Shown::Always, "Stiffness (1 is the default, 10 stiff)",
                 "How rigid the surface is in the end. <b>Raise it</b> to smooth over noise and holes of the target. "
                 "<b>Lower it</b> to follow finer detail.");
}

void askLargestDistance(Fields &fields, double &distance, const QString &help) {
    double limit = 0;
    fields.field("largest_distance", limit, Shown::Always, "Largest distance", help);
    distance = limit == 0 ? std::numeric_limits<double>::infinity() : limit;
}

void askLandmarkTolerance(Fields &fields, vcg::fcd::FitParam &fit) {
    fields.field("landmark_tolerance", fit.landmarkTolerance, Shown::Advanced, "Landmark tolerance",
                 "How far a landmark may stay from where it belongs, in world units. <b>0</b> (the default): it is "
                 "exact. <b>Raise it</b> to the error of measured or picked points. Pairs that the others contradict, "
                 "such as two that are mixed up, are then left out. The log names them in any case.");
}

void askSamples(Fields &fields, int &samples, const QString &help) {
    fields.field("samples", samples, Shown::Advanced, "Samples", help);
}

void askSampling(Fields &fields, vcg::fcd::FitParam &fit) {
    askInitialPatches(fields, fit.graph);
    askSmoothness(fields, fit.smoothness);
    askRandomSeed(fields, fit.graph);
    askSamples(fields, fit.samples,
               "How many places of the surface are matched, evenly spread. <b>Raise it</b> where there are many "
               "patches; it takes longer.");
    fields.field("fit_steps", fit.fitSteps, Shown::Advanced, "Steps",
                 "The most steps from stiff to soft; the less the surface moves, the fewer it takes. <b>Raise it</b> "
                 "where it has far to go, or when the log says that it did not converge.");
}
