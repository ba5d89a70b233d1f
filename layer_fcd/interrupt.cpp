// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_host.h"

#ifdef _WIN32

// On Windows, Python's handler is in another C library, and the console's own thread calls it.
static vcg::CallBackPos *toHost;
Interruptible::Interruptible(vcg::CallBackPos *callback) { toHost = callback; }
Interruptible::~Interruptible() = default;
vcg::CallBackPos *Interruptible::callback() const {
    return toHost;
} // NOLINT(readability-convert-member-functions-to-static)

#else

#include <atomic>
#include <csignal>

namespace {

vcg::CallBackPos *toHost;
struct sigaction before;
std::atomic<bool> hasCome;
static_assert(std::atomic<bool>::is_always_lock_free, "a handler of signals may use it");

void note(int signal, siginfo_t *info, void *context) {
    hasCome = true;
    if ((before.sa_flags & SA_SIGINFO) != 0)
        before.sa_sigaction(signal, info, context);
    else
        before.sa_handler(signal);
}

bool goOn(const int percent, const char *stage) { return (!toHost || toHost(percent, stage)) && !hasCome; }

} // namespace

Interruptible::Interruptible(vcg::CallBackPos *callback) {
    toHost = callback;
    hasCome = false;
    isSet = sigaction(SIGINT, nullptr, &before) == 0 &&
            ((before.sa_flags & SA_SIGINFO) != 0 || (before.sa_handler != SIG_DFL && before.sa_handler != SIG_IGN));
    if (!isSet)
        return;
    struct sigaction noting = before;
    noting.sa_flags |= SA_SIGINFO;
    noting.sa_sigaction = note;
    isSet = sigaction(SIGINT, &noting, nullptr) == 0;
}

Interruptible::~Interruptible() {
    if (isSet)
        sigaction(SIGINT, &before, nullptr);
}

vcg::CallBackPos *Interruptible::callback() const { return isSet ? goOn : toHost; }

#endif
