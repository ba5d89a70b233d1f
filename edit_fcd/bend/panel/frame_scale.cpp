// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/frame_scale.h"

#include <algorithm>
#include <cmath>

int FrameScale::last() const {
    return key.empty() ? 0 : int(std::ceil((key.back() - key.front()) * rate - 1e-6)); // up to rounding
}

double FrameScale::timeOf(int frame) const { return std::clamp(key.front() + frame / rate, key.front(), key.back()); }

int FrameScale::frameOf(double time) const {
    return key.empty() ? 0 : std::clamp(int(std::lround((time - key.front()) * rate)), 0, last());
}

double FrameScale::xOf(double time) const {
    const double length = key.empty() ? 0 : key.back() - key.front();
    return length > 0 ? left + width * (time - key.front()) / length : left;
}

std::optional<std::size_t> FrameScale::keyAt(double x, double reach) const {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < key.size(); ++i)
        if (const double away = std::abs(xOf(key[i]) - x); away <= reach) {
            reach = away;
            found = i;
        }
    return found;
}

double FrameScale::timeAt(double x, double reach) const {
    if (const auto found = keyAt(x, reach))
        return key[*found];
    const double length = key.back() - key.front(), share = width > 0 ? std::clamp((x - left) / width, 0.0, 1.0) : 0;
    return timeOf(int(std::lround(share * length * rate)));
}

double FrameScale::movedTo(std::size_t which, double x) const {
    const double length = key.back() - key.front();
    const double frame = width > 0 ? std::round((x - left) / width * length * rate) : 0;
    double time = std::max(0.0, key.front() + frame / rate);
    if (which + 1 < key.size())
        time = std::min(time, key[which + 1] - 1 / rate);
    if (which > 0)
        time = std::max(time, key[which - 1] + 1 / rate);
    return which + 1 < key.size() && time >= key[which + 1] ? key[which]
                                                            : std::max(0.0, time); // no room: it does not move
}
