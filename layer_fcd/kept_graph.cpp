// SPDX-License-Identifier: GPL-3.0-or-later
#include "rest_shape.h" // which includes others before Qt
#include "inherited.h"
#include "kept_graph.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_matrix.h"

#include <algorithm>
#include <utility>

#include <QRegularExpression>

using vcg::fcd::Error;

std::optional<GraphState> graphOf(const MeshDocument &document, const MeshModel &layer) {
    if (const std::optional<GraphState> &own = LayerState::known(layer).graph)
        return own;
    std::optional<std::uint64_t> shape; // computed if needed
    for (const LayerState *other : LayerState::ofOthers(document, layer))
        if (other->graph && layer.cm.fn == 0) {
            shape = shape ? shape : shapeOf(layer.cm);
            if (*shape == other->graph->shape)
                return other->graph;
        }
    return {};
}

void handDownGraph(const MeshDocument &document, const LayerState &state) {
    handDown(document, state, &LayerState::graph, [&state](const MeshModel &layer) {
        return layer.cm.fn == 0 && shapeOf(layer.cm) == state.graph->shape ? state.graph : std::nullopt;
    });
}

const MeshModel *likelyGraph(const MeshDocument &document, bool isDeformed) {
    static const QRegularExpression deformed(" deformed graph[ 0-9()]*$"), any(" graph( \\d+)?(\\(\\d+\\))?$");
    const MeshModel *found = document.mm();
    int best = 0;
    for (const MeshModel *layer : host::layers(document)) {
        found = found ? found : layer;
        const std::optional<GraphState> graph = graphOf(document, *layer);
        const bool isDeformedGraph = graph ? graph->isDeformed : layer->label().contains(deformed);
        const bool isOfCurrent = graph && document.mm() && graph->source == document.mm()->id();
        // A deformed graph without a deformation is a copy, or was loaded.
        const int rank = 1 + 2 * isOfCurrent + (isDeformed && LayerState::known(*layer).deformation);
        if ((graph || layer->label().contains(any)) && isDeformedGraph == isDeformed && rank >= best) {
            found = layer;
            best = rank;
        }
    }
    return found;
}

bool isGraph(const MeshDocument &document, const MeshModel &layer) {
    if (graphOf(document, layer))
        return true;
    Scalarm least = 0, greatest = 0;
    for (const CVertexO &vertex : layer.cm.vert)
        if (!vertex.IsD()) {
            least = std::min(least, Scalarm(vertex.cQ()));
            greatest = std::max(greatest, Scalarm(vertex.cQ()));
        }
    return layer.cm.fn == 0 && least == 0 && greatest > 0;
}

/// Whether \p layer has the shape that was deformed, now or at rest.
static bool hasShape(MeshModel &layer, const Deformation &deformation) {
    return shapeOf(layer.cm) == deformation.shape ||
           (RestShape::exists(layer) && RestShape(layer).shape() == deformation.shape);
}

/// Whether \p layer is the very one that was deformed, with the same mesh, wherever its vertices are now.
static bool isMeshOf(const MeshModel &layer, const Deformation &deformation) {
    const CMeshO &mesh = layer.cm;
    return layer.id() == deformation.source && mesh.vert.size() == std::size_t(deformation.rest.cols()) &&
           mesh.vn == deformation.vertices && facesOf(mesh) == deformation.corners;
}

void keepDeformation(const MeshDocument &document, MeshModel &graph, const MeshModel &restGraph,
                     const MeshModel &source, const std::shared_ptr<const Prepared> &prepared,
                     const vcg::fcd::Deformer::Pose &pose) {
    const CMeshO &mesh = source.cm;
    LayerState::made(document, graph).deformation = std::make_shared<const Deformation>(
        Deformation{prepared, pose, positionsOf(source), invertibleMatrixOf(source), shapeOf(mesh), facesOf(mesh),
                    mesh.vn, mesh.fn, source.id(), restGraph.id()});
}

DeformationThen deformationOf(const DeformationLayers &layers, bool evenIfMoved, const Remark &remark) {
    const auto [source, restGraph, deformedGraph] = layers;
    if (!source || !restGraph || !deformedGraph)
        throw Error(
            "source_layer, rest_graph and deformed_graph must be layers of this document. Or give a deformation_file.");
    const std::shared_ptr<const Deformation> &found = LayerState::known(*deformedGraph).deformation;
    if (!found)
        throw Error("The layer " + inQuotes(*deformedGraph) +
                    " holds no deformation. It must be the deformed graph that 'FCD: Deform Mesh' "
                    "(generate_fcd_deformed_mesh) made in this session, with 'Add graph layers': layers that "
                    "are saved and loaded lose it. Deform the source again; to keep a deformation, use 'FCD: Save "
                    "Deformation' (save_fcd_deformation), and give its deformation_file.");
    const Deformation &deformation = *found;
    const bool isThere = source->cm.fn == deformation.faces && hasShape(*source, deformation),
               isElsewhere = !isThere && isMeshOf(*source, deformation);
    if (!isThere && !(isElsewhere && evenIfMoved))
        throw Error("The layer " + inQuotes(*source) + " is not what " + inQuotes(*deformedGraph) +
                    " was made from, or it was changed since. Choose the layer that was deformed, give it the pose "
                    "that it had then, or deform it again." +
                    (isElsewhere ? " It was only moved: 'FCD: Save Deformation' (save_fcd_deformation) still saves the "
                                   "deformation as it was; give that deformation_file."
                                 : ""));
    DeformationThen then{deformation, positionsOf(*source), isThere ? invertibleMatrixOf(*source) : deformation.matrix};
    if (restGraph == source || !HasNodes(*deformation.prepared->deformer, positionsIn(then.matrix, *restGraph)))
        throw Error("The layer " + inQuotes(*restGraph) + " is not the graph at rest of " + inQuotes(*deformedGraph) +
                    ". Choose the graph that was made together with it.");
    if (!isThere && remark)
        remark("Something else has moved " + inQuotes(*source) +
               " since it was deformed. The deformation is that of its shape and place then.");
    const Eigen::Index known = std::min(then.position.cols(), deformation.rest.cols());
    then.position.leftCols(known) = deformation.rest.leftCols(known);
    return then;
}

DeformationLayers lastDeformation(const MeshDocument &document) {
    DeformationLayers last;
    for (const MeshModel *layer : host::layers(document)) {
        const std::shared_ptr<const Deformation> &found = LayerState::known(*layer).deformation;
        if (!found || (last.deformedGraph && layer->id() < last.deformedGraph->id()))
            continue;
        MeshDocument &all = const_cast<MeshDocument &>(document); // which is not changed
        MeshModel *source = all.getMesh(found->source), *restGraph = all.getMesh(found->restGraph);
        if (source && restGraph)
            last = {source, restGraph, all.getMesh(layer->id())};
    }
    return last;
}
