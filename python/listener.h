// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_LISTENER_H
#define PYMESHLAB_FCD_LISTENER_H

#include <vcg_ext/base/progress.h>

#include <nanobind/nanobind.h>

#include <chrono>
#include <exception>
#include <utility>

/// Reports the progress of work to a callable of Python, and lets Ctrl-C or an exception of the callable interrupt it,
/// within about 30 ms.
class Listener {
  public:
    /// Calls body(progress) without Python's lock. \param report called with percent and stage; may be None \throw what
    /// \p report or a handler of signals throws
    template <class Body>
    static void Run(const nanobind::object &report, unsigned threads, const Body &body) {
        Listener listener(report);
        Listener *&present = Present(), *const before = std::exchange(present, &listener);
        try {
            nanobind::gil_scoped_release release;
            vcg::fcd::Progress progress(&Listener::OnProgress);
            progress.threads = threads;
            body(progress);
        } catch (...) {
            present = before;
            if (listener.thrown)
                std::rethrow_exception(listener.thrown);
            throw;
        }
        present = before;
        if (!report.is_none())
            report(100, "Done");
    }

  private:
    using Clock = std::chrono::steady_clock;

    explicit Listener(const nanobind::object &report) : report(report) {}

    static Listener *&Present() {
        thread_local Listener *present = nullptr;
        return present;
    }

    static bool OnProgress(int percent, const char *stage) { return Present()->Tell(percent, stage); }

    bool Tell(int percent, const char *stage) {
        const Clock::time_point now = Clock::now();
        if (now < next)
            return true;
        next = now + std::chrono::milliseconds(30);
        const nanobind::gil_scoped_acquire acquire;
        try {
            if (PyErr_CheckSignals() != 0)
                throw nanobind::python_error();
            if (!report.is_none())
                report(percent, stage);
        } catch (...) {
            thrown = std::current_exception();
        }
        return !thrown;
    }

    const nanobind::object &report;
    Clock::time_point next = Clock::now();
    std::exception_ptr thrown;
};

#endif
