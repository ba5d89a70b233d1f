// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_labels.h"
#include "weight_sources.h"

#include <algorithm>

using vcg::fcd::Error;

std::function<double(std::size_t)> attributeNumbers(const MeshModel &layer, const QString &name,
                                                    const std::string &use) {
    std::string others;
    for (const vcg::PointerToAttribute &attribute : layer.cm.vert_attr) {
        if (attribute._name != name.toStdString()) {
            if (!attribute._name.empty())
                others += (others.empty() ? " It has: " : ", ") + attribute._name;
            continue;
        }
        // The handle's own index, not its operator[]: that one refers to the container the attribute was made for.
        const vcg::SimpleTempDataBase *data = attribute._handle;
        if (host::isOfType<float>(attribute))
            return [data](std::size_t i) { return double(*static_cast<const float *>(data->At(i))); };
        if (host::isOfType<double>(attribute))
            return [data](std::size_t i) { return *static_cast<const double *>(data->At(i)); };
        if (host::isOfType<int>(attribute))
            return [data](std::size_t i) { return double(*static_cast<const int *>(data->At(i))); };
        throw Error("The vertex attribute '" + name.toStdString() +
                    "' does not hold one number per vertex. Use a scalar attribute (float, double or int).");
    }
    throw Error("The layer " + inQuotes(layer) + " has no vertex attribute '" + name.toStdString() +
                "'. Add a scalar attribute of that name " + use + "." +
                (others.empty() ? " It has no attributes at all." : others + "."));
}

std::vector<float> readWeights(const MeshModel &layer, FitMeshParam::Weights source, const QString &attribute) {
    if (source == FitMeshParam::AllCounts)
        return {};
    const CMeshO &mesh = layer.cm;
    std::function<double(std::size_t)> of;
    switch (source) {
    case FitMeshParam::WeightsAttribute:
        of = attributeNumbers(layer, attribute,
                              "with a weight from 0 to 1 per vertex, or give its name as 'weight_attribute'");
        break;
    case FitMeshParam::WeightsSelection: of = [&](std::size_t i) { return mesh.vert[i].IsS() ? 1 : 0; }; break;
    default: of = [&](std::size_t i) { return double(mesh.vert[i].cQ()); };
    }
    std::vector<float> weight(mesh.vert.size(), 1.f);
    for (std::size_t i = 0; i < weight.size(); ++i)
        if (!mesh.vert[i].IsD())
            weight[i] = float(of(i));
    return weight;
}

std::vector<float> paintedWeights(const MeshModel &layer) {
    std::vector<float> weights;
    try {
        weights = readWeights(layer, FitMeshParam::WeightsAttribute, FitMeshParam::paintedAttribute);
    } catch (const Error &) { // there is none, or of another type
        return {};
    }
    const bool arePainted =
        std::all_of(weights.begin(), weights.end(), [](float weight) { return weight >= 0 && weight <= 1; });
    return arePainted ? weights : std::vector<float>();
}

void paintWeights(MeshModel &layer, const std::vector<float> &weights) {
    using Allocator = vcg::tri::Allocator<CMeshO>;
    const std::string name = FitMeshParam::paintedAttribute;
    if (vcg::tri::HasPerVertexAttribute(layer.cm, name)) // perhaps of another type
        Allocator::DeletePerVertexAttribute(layer.cm, name);
    if (weights.empty())
        return;
    auto painted = Allocator::AddPerVertexAttribute<Scalarm>(layer.cm, name);
    for (std::size_t i = 0; i < weights.size(); ++i)
        painted[i] = Scalarm(weights[i]);
}

vcg::fcd::WeightOf weightOf(const std::vector<float> &weights) {
    if (weights.empty())
        return {};
    return [&weights](std::size_t i) { return double(weights[i]); };
}
