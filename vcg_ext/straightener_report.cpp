// SPDX-License-Identifier: GPL-3.0-or-later
// What a straightening tells its user.
#include <vcg_ext/straighten.h>

#include <sstream>

namespace vcg::fcd {

std::string StraightenReport::Remedy() const {
    const bool mayBeMiddle = !isMiddle && !leftMiddle;
    return mayBeMiddle ? "Take the line through the middle (middle), or raise the smoothing of the line."
                       : "Raise the smoothing of the line.";
}

std::vector<std::string> StraightenReport::Warnings() const {
    std::vector<std::string> found;
    if (leftMiddle)
        found.emplace_back("The line stays as given: through the middles of the cross-sections it would stretch the "
                           "surface more.");
    if (released > 0) {
        std::ostringstream line;
        line << "Beside the line at ";
        for (std::size_t i = 0; i < releasedAt.size() && i < 5; ++i) {
            const auto &[from, to] = releasedAt[i];
            line << (i > 0 ? ", " : "") << from;
            if (to - from > 1e-3 * length) // not a patch of about one vertex
                line << " to " << to;
        }
        line << (releasedAt.size() > 5 ? ", and elsewhere" : "")
             << " of its length, the surface follows its surroundings as rigidly as possible: cross-sections that move "
                "with the line would fold it, or make it twice or half as long. "
             << Remedy();
        found.push_back(line.str());
    }
    if (isBeside) {
        std::ostringstream line;
        line.precision(3);
        line << "The line lies to one side of the surface, which gets longer or shorter along it by "
             << 100 * lengthening
             << " % (root mean square). If the line was picked on the surface, take the line through the middle "
                "(middle).";
        found.push_back(line.str());
    }
    return found;
}

} // namespace vcg::fcd
