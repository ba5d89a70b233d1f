// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/handles/handle_file.h> // before Qt

#include "kept_aside.h"
#include "kept_tool.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "measured_quality.h"
#include "tag_sources.h"
#include "weight_sources.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

using vcg::fcd::Error;

namespace {

/// The meaning of the tags, for messages.
const char *const tagMeaning = "0 = fixed, 1 = free, 2, 3, ... = handles, negative = outside";

/// Tags from the numbers of(slot). \param what name of the numbers, for messages
template <class NumberOf>
std::vector<int> tagsFrom(const MeshModel &layer, const std::string &what, const NumberOf &of) {
    const CMeshO &mesh = layer.cm;
    std::vector<int> tag(mesh.vert.size(), 1);
    std::atomic<std::size_t> wrong{tag.size()}; // the first one
    forVertices(mesh, [&](std::size_t i) {
        const double number = of(i), whole = std::round(number);
        // The tolerance is for files that store numbers as text.
        if (std::abs(number - whole) <= 1e-6 && whole >= std::numeric_limits<int>::lowest() &&
            whole <= std::numeric_limits<int>::max())
            tag[i] = int(whole);
        else
            for (std::size_t first = wrong; i < first && !wrong.compare_exchange_weak(first, i);) {
            }
    });
    if (const std::size_t i = wrong; i < tag.size())
        throw Error(inWords("The ", what, " of vertex ", i, " is ", of(i), ", but tags are whole numbers: ", tagMeaning,
                            ". Round them, or take the tags from another source."));
    return tag;
}

std::uint64_t countNotFree(const MeshModel &layer, const std::vector<int> &tag) {
    return sumOfVertices(layer.cm, [&](std::size_t i) { return tag[i] != 1; });
}

/// Whether a filter here gave \p layer its quality as tags.
bool isKnownAsTags(const MeshModel &layer) {
    const LayerState &state = LayerState::known(layer);
    return (state.scan && state.scan->quality) || (state.measured && state.measured->areTags);
}

/// What has become of a layer's tags, for messages that go on with takeWrittenTags.
const char *const noLongerTags =
    " is not what 'FCD: Tag' wrote: something else has changed it, or made vertices. But tags "
    "are whole numbers, and not 0 everywhere. To use what was written, ";
const char *const takeWrittenTags = "choose 'Tags of the layer' (4) as 'handles'";

/// Whether the quality of all vertices is a whole number.
bool isWhole(const MeshModel &layer) {
    return sumOfVertices(layer.cm, [&](std::size_t i) {
               return layer.cm.vert[i].cQ() == std::round(layer.cm.vert[i].cQ()) ? 0 : 1;
           }) == 0;
}

std::vector<int> tagsFromQuality(const MeshModel &layer, bool freeIfNone, bool mayLack) {
    const CMeshO &mesh = layer.cm;
    if (hasMarks(layer))
        return marksOf(layer);
    if (mayLack && !mayHaveTags(layer))
        return std::vector<int>(mesh.vert.size(), 1);
    if (hasTags(layer) && !freeIfNone && !(isWhole(layer) && hasQuality(layer)))
        throw Error("The vertex quality of " + inQuotes(layer) + noLongerTags + takeWrittenTags +
                    " (new vertices are then free). Or tag the layer again.");
    std::vector<int> tag = tagsFrom(layer, "quality", [&](std::size_t i) { return double(mesh.vert[i].cQ()); });
    const bool tagged = sumOfVertices(mesh, [&](std::size_t i) { return tag[i] != 0; }) > 0;
    if (!tagged && freeIfNone)
        return std::vector<int>(mesh.vert.size(), 1);
    if (!tagged)
        throw Error(std::string("No handle: the vertex quality of this layer is 0 everywhere: nobody has tagged the "
                                "vertices yet. Set the quality to a tag per vertex (") +
                    tagMeaning +
                    "), for example with 'FCD: Tag' (compute_fcd_tags) or 'Per Vertex Quality "
                    "Function' (compute_scalar_by_function_per_vertex), or select the "
                    "handle and choose 'Selection' (1), an attribute (2) or files (3) as 'handles'.");
    if (mayLack && !isKnownAsTags(layer) && countNotFree(layer, tag) == std::uint64_t(mesh.vn))
        throw Error("The vertex quality of " + inQuotes(layer) +
                    " counts as tags, since its numbers are whole, and none is 1: no vertex is free. If it is "
                    "something else (a label, a measure), " +
                    takeWrittenTags + ". Otherwise tag what may bend with 1.");
    return tag;
}

std::vector<int> tagsFromSelection(const MeshModel &layer, bool freeIfNone) {
    const CMeshO &mesh = layer.cm;
    const std::vector<char> onFaces = onSelectedFaces(layer);
    std::vector<int> tag(mesh.vert.size(), 1);
    bool handle = false;
    for (std::size_t i = 0; i < tag.size(); ++i) {
        if (onFaces[i])
            tag[i] = 0;
        if (!mesh.vert[i].IsD() && mesh.vert[i].IsS()) {
            tag[i] = 2;
            handle = true;
        }
    }
    if (!handle && !freeIfNone)
        throw Error(
            "No handle: no vertex is selected. Select the vertices of the handle, and the faces of what stays fixed, "
            "or choose another source with 'handles'.");
    return tag;
}

std::vector<int> tagsFromAttribute(const MeshModel &layer, const QString &name) {
    return tagsFrom(layer, "attribute '" + name.toStdString() + "'",
                    attributeNumbers(layer, name,
                                     std::string("with a tag per vertex (") + tagMeaning +
                                         "), or give its name as 'tag_attribute'"));
}

std::vector<int> tagsFromFile(const MeshModel &layer, const QString &path) {
    const CMeshO &mesh = layer.cm;
    const std::vector<int> listed = vcg::fcd::ReadTagFile(pathOf(path), mostBytes(layer, 100));
    if (listed.size() != std::size_t(mesh.vn))
        throw Error(path.toStdString() + " has " + std::to_string(listed.size()) + " tags, but the layer " +
                    inQuotes(layer) + " has " + std::to_string(mesh.vn) +
                    " vertices. It must list one tag per vertex of this very mesh, in the order of the vertices.");
    std::vector<int> tag(mesh.vert.size(), 1);
    std::size_t next = 0;
    for (std::size_t i = 0; i < tag.size(); ++i)
        if (!mesh.vert[i].IsD())
            tag[i] = listed[next++];
    return tag;
}

/// Says how many vertices are fixed by a quality of 0 that no filter for tags gave: others make new vertices with it.
void tellNewFixed(const MeshModel &layer, const std::vector<int> &tag, const Remark &remark) {
    const LayerState &state = LayerState::known(layer);
    const bool isTagged = state.scan && state.scan->quality;
    if (!isKnownAsTags(layer))
        return;
    const auto isNew = [&](std::size_t i) {
        return isTagged ? state.scan->number[i] == 0 : state.measured->number[i] == 0;
    };
    if (const auto count = sumOfVertices(layer.cm, [&](std::size_t i) { return isNew(i) && tag[i] == 0; }))
        remark(counted(count, "vertex is", "vertices are") + " new since " + inQuotes(layer) + " was " +
               (isTagged ? "tagged" : "made") +
               ", and fixed, since their quality is 0. If that is wrong, tag them: 1 is free.");
}

} // namespace

bool mayHaveTags(const MeshModel &layer) {
    return hasMarks(layer) || (hasQuality(layer) && !isMeasured(layer) && isWhole(layer));
}

void tellTakenForTags(const MeshModel &layer, const std::vector<int> &tag, const std::string &remedy,
                      const Remark &remark) {
    if (hasMarks(layer) || isKnownAsTags(layer))
        return;
    if (const auto count = countNotFree(layer, tag))
        remark("The vertex quality of " + inQuotes(layer) +
               " counts as tags, since its numbers are whole: " + counted(count, "vertex is", "vertices are") +
               " not free. If it is something else (a label, a measure), " + remedy + ".");
}

std::vector<int> readTags(const MeshModel &layer, const HandleParam &param) {
    if (param.allFree)
        return std::vector<int>(layer.cm.vert.size(), 1);
    const bool freeIfNone = param.mayLack || !param.pointFile.isEmpty();
    switch (param.source) {
    case HandleParam::Quality: return tagsFromQuality(layer, freeIfNone, param.mayLack);
    case HandleParam::Selection: return tagsFromSelection(layer, freeIfNone);
    case HandleParam::Attribute: return tagsFromAttribute(layer, param.tagAttribute);
    case HandleParam::Files:
        if (freeIfNone && param.tagFile.isEmpty())
            return std::vector<int>(layer.cm.vert.size(), 1);
        return tagsFromFile(layer, param.tagFile);
    case HandleParam::Known: return hasMarks(layer) ? marksOf(layer) : writtenTags(layer);
    }
    throw Error("Unknown source of tags.");
}

void tellOfTags(const MeshModel &layer, const HandleParam &param, const std::vector<int> &tag, const Remark &remark) {
    if (!remark || param.allFree || param.source != HandleParam::Quality || hasMarks(layer))
        return;
    tellNewFixed(layer, tag, remark);
    if (param.mayLack && hasTags(layer) && !mayHaveTags(layer))
        remark("All is free: the vertex quality of " + inQuotes(layer) + noLongerTags + takeWrittenTags + ".");
    else if (param.mayLack)
        tellTakenForTags(layer, tag, takeWrittenTags, remark);
}
