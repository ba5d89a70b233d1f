// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/graph.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <algorithm>
#include <atomic>
#include <string>

namespace vcg::fcd {

namespace {

// Nodes and slots are numbered by Index; elements by 32 bits, the last value of which is `none`.
constexpr std::size_t mostSlots = std::numeric_limits<Index>::max();
constexpr std::size_t mostElements = SurfaceView::none - 1;

void ExpectCountable(std::size_t slots, std::size_t faces, std::size_t edges) {
    if (slots > mostSlots || faces > mostElements || edges > mostElements)
        throw BadInput("The mesh has " + std::to_string(slots) + " vertices, " + std::to_string(faces) + " faces and " +
                       std::to_string(edges) + " edges; 2147483647 vertices are the most. Simplify it first.");
}

} // namespace

Eigen::Matrix3Xd SurfaceView::Copy(unsigned threads) const {
    Eigen::Matrix3Xd copy(3, Eigen::Index(vertexSlots));
    PreferLargePages(copy.data(), 3 * vertexSlots * sizeof(double));
    ParallelFor(threads, vertexSlots, 1 << 16, [&](std::size_t first, std::size_t last) {
        std::copy(position + 3 * first, position + 3 * last, copy.data() + 3 * first);
    });
    return copy;
}

void SurfaceView::Validate(const Progress &progress) const {
    ExpectCountable(vertexSlots, faces, edges);
    std::atomic<std::size_t> bad{faces + edges};
    const auto check = [&](const std::uint32_t *vertex, std::size_t count, std::size_t elements, std::size_t before) {
        ParallelForEach(progress, readingStage, elements, 1 << 16, [&](std::size_t e) {
            for (std::size_t k = 0; k < count && vertex[count * e] != none; ++k)
                if (vertex[count * e + k] >= vertexSlots) {
                    std::size_t least = bad;
                    while (before + e < least && !bad.compare_exchange_weak(least, before + e)) {
                    }
                }
        });
    };
    check(corner, 3, faces, 0);
    check(end, 2, edges, faces);
    if (bad < faces + edges)
        throw BadInput(std::string(bad < faces ? "Face " : "Edge ") + std::to_string(bad < faces ? +bad : bad - faces) +
                       " has a corner that is no vertex: there are " + std::to_string(vertexSlots) + " vertices.");
}

SurfaceArrays::SurfaceArrays(std::size_t slots, std::size_t faces, std::size_t edges, bool withDeleted)
    : slots(slots), faces(faces), edges(edges) {
    ExpectCountable(slots, faces, edges);
    position = LargeArray<double>(3 * slots);
    if (withDeleted)
        deleted = LargeArray<char>(slots);
    corner = LargeArray<std::uint32_t>(3 * faces);
    end = LargeArray<std::uint32_t>(2 * edges);
}

SurfaceView SurfaceArrays::View() const {
    return {position.get(), slots, deleted.get(), corner.get(), faces, end.get(), edges, isCloud};
}

} // namespace vcg::fcd
