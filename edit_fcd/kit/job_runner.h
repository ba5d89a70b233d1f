// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_JOB_RUNNER_H
#define FCD_JOB_RUNNER_H

#include <vcg_ext/base/progress.h> // before Qt

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

#include <QObject>

/// One job at a time, beside the window, whose end is told in a turn of the window's loop.
class JobRunner {
  public:
    using Work = std::function<void(const vcg::fcd::Progress &)>;
    /// What a job has thrown, vcg::fcd::Cancelled among it; null: it came to its end.
    using Ended = std::function<void(std::exception_ptr)>;

    /// \param owner has this, and goes with it
    explicit JobRunner(QObject *owner) : owner(owner) {}
    ~JobRunner() { stop(); }
    JobRunner(const JobRunner &) = delete;
    JobRunner &operator=(const JobRunner &) = delete;

    /// Stops what runs, and begins. \param ended called by the owner's thread, unless it was stopped; throws nothing
    void begin(Work work, Ended ended);
    void stop(); ///< cancels it, and waits until it has ended
    void cancel() { isCancelled = true; }
    explicit operator bool() const { return thread.joinable(); }
    int percent() const { return told; }
    bool cancelled() const { return isCancelled; }

  private:
    static bool tell(int percent, const char *stage);

    QObject *owner;
    std::size_t last = 0; ///< number of what runs
    std::atomic<int> told{0};
    std::atomic<bool> isCancelled{false};
    std::exception_ptr thrown;
    std::thread thread;
};

#endif
