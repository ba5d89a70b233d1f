// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_state.h"

#include <algorithm>

using vcg::fcd::MotionStep;

namespace {

bool isSame(const MotionStep &a, const MotionStep &b) {
    return a.kind == b.kind && a.vector == b.vector && a.degrees == b.degrees && a.about == b.about &&
           a.matrix == b.matrix;
}

} // namespace

bool BendState::operator==(const BendState &other) const {
    return applies == other.applies && loads == other.loads && rims == other.rims && marks == other.marks &&
           points == other.points && handles == other.handles && rank == other.rank && pose == other.pose &&
           poses == other.poses && weights == other.weights && line == other.line &&
           motion.size() == other.motion.size() &&
           std::equal(motion.begin(), motion.end(), other.motion.begin(), [](const auto &a, const auto &b) {
               return a.first == b.first &&
                      std::equal(a.second.begin(), a.second.end(), b.second.begin(), b.second.end(), isSame);
           });
}
