// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MEMORY_H
#define VCG_FCD_MEMORY_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace vcg::fcd {

/// Starts to load memory that is needed soon.
#ifdef __GNUC__
__attribute__((always_inline)) // or calls, which have no effect, would be optimised away
#endif
inline void
Prefetch(const void *memory) {
#ifdef __GNUC__
    __builtin_prefetch(memory);
#else
    (void)memory;
#endif
}

/// Asks for large pages for memory that has not been used yet. In arrays as large as the mesh, looking up small pages
/// takes a fifth of the time.
inline void PreferLargePages(const void *memory, std::size_t bytes) {
#ifdef __linux__
    constexpr std::uintptr_t large = 1 << 21;
    const auto begin = reinterpret_cast<std::uintptr_t>(memory);
    const std::uintptr_t first = (begin + large - 1) & ~(large - 1), last = (begin + bytes) & ~(large - 1);
    if (first < last)
        madvise(const_cast<char *>(static_cast<const char *>(memory)) + (first - begin), last - first, MADV_HUGEPAGE);
#else
    (void)memory;
    (void)bytes;
#endif
}

/// \p n uninitialised items, in large pages.
template <class T>
std::unique_ptr<T[]> LargeArray(std::size_t n) {
    static_assert(std::is_trivially_destructible<T>::value, "LargeArray holds plain data");
    std::unique_ptr<T[]> array(new T[n]);
    PreferLargePages(array.get(), n * sizeof(T));
    return array;
}

/// Sets \p array to \p n equal items, in large pages.
template <class T>
void AssignLarge(std::vector<T> &array, std::size_t n, const T &value) {
    array.clear();
    array.reserve(n);
    PreferLargePages(array.data(), n * sizeof(T));
    array.resize(n, value);
}

} // namespace vcg::fcd

#endif
