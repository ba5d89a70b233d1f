// SPDX-License-Identifier: GPL-3.0-or-later
//
// Allocations that fail, and threads that do not start, as faults.h says. Replaces the allocation functions (the
// linker's
// --wrap leads Eigen's calls of malloc and its kin here, see CMakeLists.txt).
#include "faults.h"

#include <cerrno>
#include <cstdlib>
#include <dlfcn.h>
#include <new>
#include <pthread.h>

using namespace fcd_test::faults;

// --- allocations ---

extern "C" {
void *__real_malloc(std::size_t);
void *__real_calloc(std::size_t, std::size_t);
void *__real_realloc(void *, std::size_t);
void __real_free(void *);
}

static bool Fails() {
    ++requests;
    const long left = countdown == never ? 1 : countdown--;
    return left == 0 || (left < 0 && forGood);
}
static void *Counted(void *memory) {
    live += memory != nullptr;
    return memory;
}

extern "C" {
void *__wrap_malloc(std::size_t size) { return Fails() ? nullptr : Counted(__real_malloc(size)); }
void *__wrap_calloc(std::size_t n, std::size_t size) { return Fails() ? nullptr : Counted(__real_calloc(n, size)); }
void *__wrap_realloc(void *old, std::size_t size) {
    if (Fails())
        return nullptr;
    void *memory = __real_realloc(old, size);
    live += !old && memory;
    return memory;
}
void __wrap_free(void *memory) {
    live -= memory != nullptr;
    __real_free(memory);
}
}

void *operator new(std::size_t size) {
    if (void *memory = __wrap_malloc(size))
        return memory;
    throw std::bad_alloc();
}
void *operator new(std::size_t size, const std::nothrow_t &) noexcept { return __wrap_malloc(size); }
void *operator new[](std::size_t size) { return operator new(size); }
void operator delete(void *memory) noexcept { __wrap_free(memory); }
void operator delete(void *memory, std::size_t) noexcept { __wrap_free(memory); }
void operator delete(void *memory, const std::nothrow_t &) noexcept { __wrap_free(memory); }
void operator delete[](void *memory) noexcept { __wrap_free(memory); }
void operator delete[](void *memory, std::size_t) noexcept { __wrap_free(memory); }

// --- threads ---

#ifndef FCD_TEST_SANITIZED // sanitizers have one of their own
extern "C" int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *), void *data) {
    using Create = int (*)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);
    static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
    return threadsLeft-- > 0 ? create(thread, attributes, run, data) : EAGAIN;
}
#endif
