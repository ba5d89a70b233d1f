// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/kit/job_runner.h"

#include <utility>

static thread_local JobRunner *running = nullptr; // for tell(), which only gets a percentage

void JobRunner::begin(Work work, Ended ended) {
    stop();
    told = 0;
    isCancelled = false;
    thrown = nullptr;
    const auto end = [this, number = last, ended = std::move(ended)] {
        if (number != last)
            return; // the job was stopped
        thread.join();
        if (!thrown && isCancelled) // after the job had last checked
            thrown = std::make_exception_ptr(vcg::fcd::Cancelled());
        ended(std::exchange(thrown, nullptr));
    };
    thread = std::thread([this, work = std::move(work), end] {
        running = this;
        try {
            work(vcg::fcd::Progress(&JobRunner::tell));
        } catch (...) {
            thrown = std::current_exception();
        }
        QMetaObject::invokeMethod(owner, end, Qt::QueuedConnection);
    });
}

void JobRunner::stop() {
    ++last;
    cancel();
    if (thread.joinable())
        thread.join();
}

bool JobRunner::tell(int percent, const char *) {
    running->told = percent;
    return !running->isCancelled;
}
