// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SORT_SHORT_H
#define VCG_FCD_SORT_SHORT_H

#include <algorithm>

namespace vcg {
namespace fcd {
namespace detail {

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

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
