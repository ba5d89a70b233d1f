// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_JOB_RUNNER_H
#define FCD_JOB_RUNNER_H

#include <vcg_ext/base/progress.h> // before Qt

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

#include <QObject>

/// Runs one job at a time in the background, and reports its end in the window's event loop.
class JobRunner {
  public:
    using Work = std::function<void(const vcg::fcd::Progress &)>;
    /// Gets what the job threw (vcg::fcd::Cancelled if it was cancelled), or null.
    using Ended = std::function<void(std::exception_ptr)>;

    /// \param owner owns this; \a ended is called in its thread
    explicit JobRunner(QObject *owner) : owner(owner) {}
    ~JobRunner() { stop(); }
    JobRunner(const JobRunner &) = delete;
    JobRunner &operator=(const JobRunner &) = delete;

    /// Stops the running job, and begins another. \param ended not called if the job is stopped; throws nothing
    void begin(Work work, Ended ended);
    void stop(); ///< cancels the job and waits for its end
    void cancel() { isCancelled = true; }
    explicit operator bool() const { return thread.joinable(); }
    int percent() const { return told; }
    bool cancelled() const { return isCancelled; }

  private:
    static bool tell(int percent, const char *stage);

    QObject *owner;
    std::size_t last = 0; ///< number of the job
    std::atomic<int> told{0};
    std::atomic<bool> isCancelled{false};
    std::exception_ptr thrown;
    std::thread thread;
};

#endif
