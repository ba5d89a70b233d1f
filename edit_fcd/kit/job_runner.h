// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_JOB_RUNNER_H
#define FCD_JOB_RUNNER_H

#include "edit_fcd/kit/job.h"

#include <memory>
#include <utility>

#include <QObject>

/// One job at a time, beside the window, whose end is told in a turn of the window's loop.
class JobRunner {
  public:
    /// What a job has thrown, vcg::fcd::Cancelled among it; null: it came to its end.
    using Ended = std::function<void(std::exception_ptr)>;

    /// \param owner has this, and goes with it
    explicit JobRunner(QObject *owner) : owner(owner) {}

    /// Stops what runs, and begins. \param ended called by the owner's thread, unless it was stopped; throws nothing
    void begin(Job::Work work, Ended ended) {
        stop();
        const auto tell = [this, number = ++last, ended = std::move(ended)] {
            if (!job || number != last)
                return; // it was stopped
            const std::unique_ptr<Job> done = std::move(job);
            std::exception_ptr thrown;
            try {
                done->finish();
            } catch (...) {
                thrown = std::current_exception();
            }
            ended(thrown);
        };
        job = std::make_unique<Job>(std::move(work),
                                    [this, tell] { QMetaObject::invokeMethod(owner, tell, Qt::QueuedConnection); });
    }
    void stop() { job.reset(); } ///< cancels it, and waits until it has ended
    void cancel() { job->cancel(); }
    explicit operator bool() const { return job != nullptr; }
    int percent() const { return job->percent(); }
    bool cancelled() const { return job->cancelled(); }

  private:
    QObject *owner;
    std::size_t last = 0;
    std::unique_ptr<Job> job;
};

#endif
