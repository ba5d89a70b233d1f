// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/parallel.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace vcg::fcd {

unsigned ThreadsFor(unsigned threads) { return threads ? threads : std::max(1u, std::thread::hardware_concurrency()); }

namespace detail {

/// A loop that threads share. It lives in the function that runs it.
class Loop {
  public:
    Loop(std::size_t n, std::size_t grain, std::size_t threads,
         const std::function<void(std::size_t, std::size_t)> &body)
        : wanted(threads - 1), n(n), grain(grain), body(body) {}

    bool IsLeft() const { return next < Ranges(); }
    /// Runs ranges until none is left.
    void Work() {
        Attempt([&] {
            for (std::size_t i; (i = next++) < Ranges();)
                body(i * grain, std::min(n, (i + 1) * grain));
        });
    }
    /// Keeps the first exception of what is called; then no further range begins.
    template <class What>
    void Attempt(const What &what) {
        try {
            what();
        } catch (...) {
            next = Ranges();
            const std::lock_guard<std::mutex> guard(lock);
            if (!failure)
                failure = std::current_exception();
        }
    }
    /// Call it when no other thread is in the loop.
    void Rethrow() const {
        if (failure)
            std::rethrow_exception(failure);
    }

    // Under the lock of the crew:
    std::size_t wanted;   ///< how many helpers may still come
    std::size_t here = 0; ///< helpers at work

  private:
    std::size_t Ranges() const { return (n + grain - 1) / grain; }

    const std::size_t n, grain;
    const std::function<void(std::size_t, std::size_t)> &body;
    std::atomic<std::size_t> next{0};
    std::mutex lock; // of failure
    std::exception_ptr failure;
};

} // namespace detail

/// Threads that help with loops that are open, the innermost first.
class LoopHelpers::Crew {
  public:
    /// The crew of the running thread; null: none.
    static Crew *&Here() {
        thread_local Crew *here = nullptr;
        return here;
    }

    ~Crew() {
        {
            const std::lock_guard<std::mutex> guard(lock);
            ends = true;
        }
        hasWork.notify_all();
        for (std::thread &helper : helpers)
            helper.join();
    }

    void Run(detail::Loop &loop, const std::function<void()> &whileWaiting) {
        {
            const std::lock_guard<std::mutex> guard(lock);
            open.push_back(&loop);
            Start(loop.wanted);
        }
        hasWork.notify_all();
        loop.Work();
        std::unique_lock<std::mutex> guard(lock);
        open.erase(std::find(open.begin(), open.end(), &loop)); // nobody comes any more
        const auto areGone = [&] { return loop.here == 0; };
        while (!areGone())
            if (!whileWaiting) {
                haveGone.wait(guard, areGone);
            } else if (!haveGone.wait_for(guard, std::chrono::milliseconds(50), areGone)) {
                guard.unlock();
                loop.Attempt(whileWaiting);
                guard.lock();
            }
    }

  private:
    void Start(std::size_t count) {
        try {
            while (helpers.size() < count)
                helpers.emplace_back([this] { Help(); });
        } catch (const std::exception &) { // no further thread: do with fewer
        }
    }

    /// What a helper does.
    void Help() {
        Here() = this;
        std::unique_lock<std::mutex> guard(lock);
        while (!ends) {
            const auto found = std::find_if(open.rbegin(), open.rend(), [](const detail::Loop *loop) {
                return loop->wanted > 0 && loop->IsLeft();
            });
            if (found == open.rend()) {
                hasWork.wait(guard);
                continue;
            }
            detail::Loop &loop = **found;
            --loop.wanted;
            ++loop.here;
            guard.unlock();
            loop.Work();
            guard.lock();
            if (--loop.here == 0)
                haveGone.notify_all();
        }
    }

    std::mutex lock;
    std::condition_variable hasWork, haveGone;
    std::vector<std::thread> helpers;
    std::vector<detail::Loop *> open;
    bool ends = false;
};

LoopHelpers::LoopHelpers() : own(Crew::Here() ? nullptr : new Crew()) {
    if (own)
        Crew::Here() = own.get();
}

LoopHelpers::~LoopHelpers() {
    if (own)
        Crew::Here() = nullptr;
}

void ParallelFor(unsigned threads, std::size_t n, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)> &body, const std::function<void()> &whileWaiting) {
    assert(grain > 0);
    const std::size_t ranges = (n + grain - 1) / grain;
    const std::size_t count = std::min<std::size_t>(ThreadsFor(threads), ranges);
    if (count <= 1) {
        for (std::size_t i = 0; i < ranges; ++i)
            body(i * grain, std::min(n, (i + 1) * grain));
        return;
    }
    const LoopHelpers helpers; // if there are none
    detail::Loop loop(n, grain, count, body);
    LoopHelpers::Crew::Here()->Run(loop, whileWaiting);
    loop.Rethrow();
}

void ParallelForAdding(unsigned threads, std::size_t n, std::size_t grain,
                       const std::function<void(std::size_t, std::size_t)> &compute,
                       const std::function<void(std::size_t, std::size_t)> &add) {
    // Sequentially consistent: a thread that finds another one adding may leave, since that one looks again.
    std::array<std::atomic<bool>, rangesAhead> ready{};
    std::atomic<std::size_t> added{0}; // items
    std::atomic<bool> isAdding{false}, failed{false};
    const auto place = [&](std::size_t first) -> std::atomic<bool> & { return ready[first / grain % rangesAhead]; };
    const auto addReady = [&] {
        while (added < n && place(added) && !isAdding.exchange(true)) {
            for (std::size_t first; (first = added) < n && place(first);) {
                const std::size_t last = std::min(n, first + grain);
                add(first, last);
                place(first) = false;
                added = last;
            }
            isAdding = false;
        }
    };
    ParallelFor(threads, n, grain, [&](std::size_t first, std::size_t last) {
        try {
            while (first >= added + rangesAhead * grain) {
                if (failed)
                    return;
                std::this_thread::sleep_for(std::chrono::microseconds(100));
            }
            compute(first, last);
            place(first) = true;
            addReady();
        } catch (...) {
            failed = true;
            throw;
        }
    });
}

} // namespace vcg::fcd
