// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SORT_SHORT_H
#define VCG_FCD_SORT_SHORT_H

#include <algorithm>

namespace vcg::fcd::detail {

/// std::sort, fast for the few items that most lists here have.
template <class T>
void SortShort(T *first, T *last) {
    if (last - first > 32) {
        std::sort(first, last);
        return;
    }
    for (T *i = first; i < last; ++i) {
        const T item = *i;
        T *at = i;
        for (; at > first && item < at[-1]; --at)
            *at = at[-1];
        *at = item;
    }
}

/// Sorts n different items from one array into another, by counting how many are smaller than each: without branches
/// that could not be predicted.
template <int n, class T>
void SortDiffering(const T *from, T *to) {
    int place[n] = {};
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k)
            place[k] += from[i] < from[k];
    for (int k = 0; k < n; ++k)
        to[place[k]] = from[k];
}

} // namespace vcg::fcd::detail

#endif
