// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/lists.h>
#include <vcg_ext/base/words.h>
#include <vcg_ext/line/line_points.h>

#include <algorithm>
#include <map>

namespace vcg::fcd {

std::vector<Index> PathOfEdges(std::vector<std::array<Index, 2>> edge, const std::string &name) {
    for (std::array<Index, 2> &each : edge)
        std::sort(each.begin(), each.end());
    SortUnique(edge);
    std::map<Index, std::vector<Index>> beside;
    for (const auto &[a, b] : edge)
        if (a != b) {
            beside[a].push_back(b);
            beside[b].push_back(a);
        }
    if (beside.empty())
        throw BadInput(name + " has no edges, so it is no line. Give a layer with edges, or a file with points.");
    std::vector<Index> ends;
    for (const auto &[vertex, others] : beside) {
        if (others.size() > 2)
            throw BadInput(name + " has a branch at vertex " + std::to_string(vertex) + ", where " +
                           std::to_string(others.size()) +
                           " edges meet: a line has no branches. Delete the edges that do not belong to it.");
        if (others.size() == 1)
            ends.push_back(vertex);
    }
    if (ends.empty())
        throw BadInput(name + " is closed: its edges form a ring. Delete an edge where you want to cut it.");
    std::vector<Index> path(1, ends.front());
    for (Index before = ends.front(), at = beside.at(before).front();;) {
        path.push_back(at);
        const std::vector<Index> &others = beside.at(at);
        if (others.size() == 1)
            break;
        const Index next = others[others[0] == before];
        before = at;
        at = next;
    }
    if (path.size() < beside.size())
        throw BadInput(name + " has several separate lines: the first has " + std::to_string(path.size()) + " of the " +
                       std::to_string(beside.size()) + " vertices with edges. Keep only the line that you need.");
    return path;
}

Eigen::Matrix3Xd ReadLineText(const std::string &text, const std::string &name) {
    detail::WordReader reader(text, name, ",;");
    std::vector<double> number;
    for (std::vector<double> row; reader.NextRow(row);) {
        if (row.size() != 3)
            reader.Fail("found " + std::to_string(row.size()) +
                        " numbers; expected the x, y and z of a point, with a point for decimals");
        number.insert(number.end(), row.begin(), row.end());
    }
    if (number.empty())
        reader.Fail("the file holds no points; expected a line with x, y and z for each");
    return Eigen::Map<const Eigen::Matrix3Xd>(number.data(), 3, Eigen::Index(number.size() / 3));
}

} // namespace vcg::fcd
