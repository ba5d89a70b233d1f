// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/map/moving_region.h>

namespace vcg::fcd {

void MovingRegion::ListVertices(const std::vector<Index> &nodeOf, const Progress &progress) {
    const char *stage = "Preparing the mapping";
    const std::size_t grain = 1 << 14, count = surface.slots.size(), chunks = (count + grain - 1) / grain;
    std::vector<std::size_t> begin(chunks + 1, 0);
    const auto isBent = [&](std::size_t i) {
        const Index node = nodeOf[surface.slots[i]];
        return node >= 0 && IsFree(node);
    };
    std::vector<std::vector<Bent>> heldOnes(chunks);
    ParallelFor(progress, stage, count, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const Index node = nodeOf[surface.slots[i]];
            if (node >= 0 && !IsFree(node)) {
                heldOnes[first / grain].push_back({surface.slots[i], node});
            } else if (node >= 0) {
                ++begin[first / grain + 1];
            }
        }
    });
    beside = Together(heldOnes);
    for (std::size_t c = 0; c < chunks; ++c)
        begin[c + 1] += begin[c];
    AssignLarge(bent, begin[chunks], Bent{0, 0});
    ParallelFor(progress, stage, count, grain, [&](std::size_t first, std::size_t last) {
        std::vector<std::pair<Index, Bent>> here; // by patch
        here.reserve(last - first);
        std::map<Index, std::size_t> next; // of each patch: count, then the entry of bent for its next vertex
        Index patch = -1;
        std::size_t *ofPatch = nullptr; // neighbours are mostly of one patch: saves lookups
        const auto nextOf = [&](Index j) -> std::size_t & {
            if (j != patch)
                ofPatch = &next[patch = j];
            return *ofPatch;
        };
        for (std::size_t i = first; i < last; ++i)
            if (isBent(i)) {
                const Index node = nodeOf[surface.slots[i]];
                here.push_back({patches.patchOf[node], {surface.slots[i], node}});
                ++nextOf(here.back().first);
            }
        std::size_t at = begin[first / grain];
        for (auto &each : next)
            each.second = std::exchange(at, at + each.second);
        for (const auto &each : here)
            bent[nextOf(each.first)++] = each.second;
    });
}

} // namespace vcg::fcd
