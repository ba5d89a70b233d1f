// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_HISTORY_H
#define FCD_HISTORY_H

#include <algorithm>
#include <cstddef>
#include <vector>

/// The states before and after the present one. Each change begins with begin().
template <class State>
class History {
  public:
    /// \param most steps of undo
    explicit History(std::size_t most) : most(most) {}

    void begin(const State &now) {
        if (!before.empty() && before.back() == now)
            return; // nothing came of the last
        before.push_back(now);
        if (before.size() > most)
            before.erase(before.begin());
        after.clear();
    }
    // Each makes \p now another state. \return whether it did
    bool undo(State &now) {
        while (!before.empty() && before.back() == now)
            before.pop_back();
        return step(before, after, now);
    }
    bool redo(State &now) { return step(after, before, now); }
    /// Takes back what was done since the last begin(), without a redo.
    bool cancel(State &now) {
        if (before.empty())
            return false;
        now = before.back();
        before.pop_back();
        return true;
    }
    /// Forgets states before the present one. \param isGone of a state
    template <class IsGone>
    void forget(const IsGone &isGone) {
        before.erase(std::remove_if(before.begin(), before.end(), isGone), before.end());
    }
    void forgetUndone() { after.clear(); }

  private:
    static bool step(std::vector<State> &from, std::vector<State> &to, State &now) {
        if (from.empty())
            return false;
        to.push_back(now);
        now = from.back();
        from.pop_back();
        return true;
    }

    std::size_t most;
    std::vector<State> before, after;
};

#endif
