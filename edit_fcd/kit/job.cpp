// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/kit/job.h"

namespace {

thread_local Job *running = nullptr; // a callback of progress knows nothing but its arguments

} // namespace

Job::Job(Work work, std::function<void()> done)
    : thread([this, work = std::move(work), done = std::move(done)] {
          running = this;
          try {
              work(vcg::fcd::Progress(&Job::tell));
          } catch (...) {
              thrown = std::current_exception();
          }
          done();
      }) {}

Job::~Job() {
    cancel();
    if (thread.joinable())
        thread.join();
}

bool Job::tell(int percent, const char *) {
    running->told = percent;
    return !running->isCancelled;
}

void Job::finish() {
    thread.join();
    if (thrown)
        std::rethrow_exception(thrown);
    if (isCancelled) // after it had looked for the last time
        throw vcg::fcd::Cancelled();
}
