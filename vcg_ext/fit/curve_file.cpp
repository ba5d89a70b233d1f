// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/table_reader.h>
#include <vcg_ext/fit/curve_file.h>
#include <vcg_ext/handles/handle_file.h>

#include <algorithm>
#include <map>

namespace vcg::fcd {

namespace {

// In each step of a fit, each vertex of a curve looks at a box for every 64 corners. A curve drawn by hand has hundreds
// of corners, one traced along the edges of a scan has thousands.
constexpr std::size_t mostCorners = 100000;
constexpr std::size_t mostBytes = 200 * mostCorners; // three numbers of 24 characters, a name, and comments

void ExpectLine(const detail::TableReader &reader, const std::string &name, std::size_t line,
                const std::vector<Eigen::Vector3d> &corner, const std::string &surface) {
    if (std::none_of(corner.begin(), corner.end(), [&](const Eigen::Vector3d &each) { return each != corner[0]; }))
        reader.Fail("the curve " + detail::Excerpt(name, 0, name.size()) + " needs corners at two places of the " +
                        surface + " at least, in rows with '" + surface + "'; it has " +
                        (corner.empty() ? "none" : "one"),
                    line);
}

} // namespace

std::vector<CurvePair> ReadCurveText(const std::string &text, const std::string &name) {
    detail::TableReader reader(text, name);
    if (!reader.Next() || reader.cell != std::vector<std::string>{"curve", "surface", "x", "y", "z"})
        reader.Fail("expected the first row 'curve,surface,x,y,z'");
    std::vector<CurvePair> curves;
    std::vector<std::size_t> firstLine;
    std::map<std::string, std::size_t> number;
    for (std::size_t corners = 1; reader.Next(); ++corners) {
        if (corners > mostCorners)
            reader.Fail("found more than " + std::to_string(mostCorners) +
                        " corners; leave out those that lie straight between others");
        const std::vector<std::string> &cell = reader.cell;
        if (cell.size() != 5)
            reader.Fail("found " + std::to_string(cell.size()) +
                        " cells; expected the name of a curve, source or target, and the x, y and z of a corner, with "
                        "a point for decimals");
        if (cell[0].empty())
            reader.Fail("expected the name of a curve in the first cell, which is empty");
        const bool isSource = cell[1] == "source";
        if (!isSource && cell[1] != "target")
            reader.Fail("expected source or target as the surface, found " +
                        detail::Excerpt(cell[1], 0, cell[1].size()));
        Eigen::Vector3d corner;
        for (std::size_t d = 0; d < 3; ++d)
            corner[Eigen::Index(d)] = reader.Number(2 + d, "a finite number, with a point for decimals");
        const auto [found, isNew] = number.emplace(cell[0], curves.size());
        if (isNew) {
            curves.push_back({cell[0], {}, {}, {}, name});
            firstLine.push_back(reader.Line());
        }
        CurvePair &curve = curves[found->second];
        (isSource ? curve.source : curve.target).push_back(corner);
        if (isSource)
            curve.sourceLine.push_back(reader.Line());
    }
    if (curves.empty())
        reader.Fail("the file holds no curves; expected a row for each corner of one");
    for (std::size_t c = 0; c < curves.size(); ++c) {
        ExpectLine(reader, curves[c].name, firstLine[c], curves[c].source, "source");
        ExpectLine(reader, curves[c].name, firstLine[c], curves[c].target, "target");
    }
    return curves;
}

std::vector<CurvePair> ReadCurveFile(const std::string &path) { return ReadCurveText(ReadFile(path, mostBytes), path); }

} // namespace vcg::fcd
