// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/graph.h> // before Qt

#include "layer_contents.h"
#include "results.h"

#include <cstdint>
#include <type_traits>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace {

const char *const resultName = "fcd_result_2";

/// What a result is made from, and how it was then. Who changes it changes the number in its name.
struct Result {
    int source = 0;
    std::uint64_t contents = 0; ///< as contentsOf tells them
    std::uint64_t label = 0;    ///< as numberOf tells it
};
static_assert(std::is_trivially_copyable<Result>::value, "plain data, whoever has made it");

/// A number for a label.
std::uint64_t numberOf(const QString &label) {
    return XXH3_64bits(label.constData(), std::size_t(label.size()) * sizeof(QChar));
}

const Result *resultOf(const MeshModel &layer) { return host::meshAttribute<Result>(layer.cm, resultName); }

} // namespace

void showLast(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results) {
    for (MeshModel *result : results)
        host::setVisible(*result, result == results.back());
    host::setVisible(source, false);
    host::showChanges(document);
}

void showResult(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results) {
    for (MeshModel *result : results)
        host::madeMeshAttribute<Result>(result->cm, resultName) = {source.id(), contentsOf(*result),
                                                                   numberOf(result->label())};
    showLast(document, source, results);
}

MeshModel &sourceOf(MeshDocument &document, MeshModel &layer) {
    const Result *result = resultOf(layer);
    if (!result || result->contents != contentsOf(layer))
        return layer;
    for (const MeshModel *other : host::layers(document))
        if (other->id() == result->source && other->cm.vn > 0)
            return const_cast<MeshModel &>(*other);
    return layer;
}

std::vector<MeshModel *> earlierResults(MeshDocument &document, const MeshModel &source) {
    std::vector<MeshModel *> results;
    for (const MeshModel *layer : host::layers(document)) {
        const Result *result = resultOf(*layer);
        if (result && result->source == source.id() && numberOf(layer->label()) == result->label &&
            contentsOf(*layer) == result->contents)
            results.push_back(const_cast<MeshModel *>(layer));
    }
    return results;
}
