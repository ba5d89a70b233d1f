// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LISTS_H
#define VCG_FCD_LISTS_H

#include <vcg_ext/base/memory.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// Joins the lists of several ranges into one, and frees each as soon as it is copied. One thread does it. Most of the
/// time goes to the first use of memory; several threads take twice as long, since they need initialised memory. \param
/// list the member of a part that is its list
template <class Part, class Item>
std::vector<Item> Together(std::vector<Part> &parts, std::vector<Item> Part::*list) {
    std::size_t size = 0;
    for (const Part &part : parts)
        size += (part.*list).size();
    std::vector<Item> all;
    all.reserve(size);
    PreferLargePages(all.data(), size * sizeof(Item));
    for (Part &part : parts) {
        all.insert(all.end(), (part.*list).begin(), (part.*list).end());
        std::vector<Item>().swap(part.*list);
    }
    return all;
}

/// The same for plain lists.
template <class Item>
std::vector<Item> Together(std::vector<std::vector<Item>> &lists) {
    struct Part {
        std::vector<Item> list;
    };
    std::vector<Part> parts;
    parts.reserve(lists.size());
    for (std::vector<Item> &list : lists)
        parts.push_back({std::move(list)});
    return Together(parts, &Part::list);
}

/// Sorts a list, and keeps one of equal items.
template <class Item>
void SortUnique(std::vector<Item> &list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
}

} // namespace vcg::fcd

#endif
