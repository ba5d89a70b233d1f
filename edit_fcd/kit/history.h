// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_HISTORY_H
#define FCD_HISTORY_H

#include <algorithm>
#include <cstddef>
#include <vector>

/// Undo and redo of a state. Call begin() before each change.
template <class State>
class History {
  public:
    /// \param most steps of undo
    explicit History(std::size_t most) : most(most) {}

    void begin(const State &now) {
        if (!before.empty() && before.back() == now)
            return; // the last change changed nothing
        before.push_back(now);
        if (before.size() > most)
            before.erase(before.begin());
        after.clear();
    }
    // Both set \p now. \return whether there was another state
    bool undo(State &now) {
        while (!before.empty() && before.back() == now)
            before.pop_back();
        return step(before, after, now);
    }
    bool redo(State &now) { return step(after, before, now); }
    /// Takes back the changes since the last begin(), without a redo.
    bool cancel(State &now) {
        if (before.empty())
            return false;
        now = before.back();
        before.pop_back();
        return true;
    }
    /// Forgets earlier states for which \p isGone.
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
