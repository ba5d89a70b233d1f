// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // before Qt

#include "layer_contents.h"
#include "marks.h"

#include <type_traits>

namespace {

const char *const markName = "fcd_marks_1";

/// Zero for a vertex that something else makes, which is free. Who changes it changes the number in markName.
struct MarkedVertex {
    int aboveFree; ///< tag - 1
};
static_assert(std::is_trivial<MarkedVertex>::value, "plain data, whoever has made it");

} // namespace

bool hasMarks(const MeshModel &layer) { return host::vertexAttribute<MarkedVertex>(layer.cm, markName) != nullptr; }

std::vector<int> marksOf(const MeshModel &layer) {
    const auto *marked = host::vertexAttribute<MarkedVertex>(layer.cm, markName);
    std::vector<int> tag(layer.cm.vert.size(), 1);
    forVertices(layer.cm, [&](std::size_t i) { tag[i] = marked[i].aboveFree + 1; });
    return tag;
}

void setMarks(MeshModel &layer, const std::vector<int> &tag) {
    auto *marked = host::madeVertexAttribute<MarkedVertex>(layer.cm, markName);
    forVertices(layer.cm, [&](std::size_t i) { marked[i].aboveFree = tag[i] - 1; });
}

void dropMarks(MeshModel &layer) {
    if (vcg::tri::HasPerVertexAttribute(layer.cm, markName))
        vcg::tri::Allocator<CMeshO>::DeletePerVertexAttribute(layer.cm, markName);
}

bool isMarks(const std::string &attribute) { return attribute == markName || attribute == appliedTags; }
