// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_JOB_H
#define FCD_JOB_H

#include <vcg_ext/base/progress.h> // before Qt

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

/// Work that runs beside the window.
class Job {
  public:
    using Work = std::function<void(const vcg::fcd::Progress &)>;

    /// Begins. \param done called when it has ended, in its thread
    Job(Work work, std::function<void()> done);
    Job(const Job &) = delete;
    Job &operator=(const Job &) = delete;
    /// Cancels it, and waits until it has ended.
    ~Job();

    int percent() const { return told; }
    void cancel() { isCancelled = true; }
    bool cancelled() const { return isCancelled; }
    /// Waits until it has ended. \throw what it has thrown \throw vcg::fcd::Cancelled it was cancelled, however late
    void finish();

  private:
    static bool tell(int percent, const char *stage);

    std::atomic<int> told{0};
    std::atomic<bool> isCancelled{false};
    std::exception_ptr thrown;
    std::thread thread; ///< last: it uses the others
};

#endif
