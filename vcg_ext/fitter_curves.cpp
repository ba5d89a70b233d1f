// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/base/words.h>
#include <vcg_ext/fit.h>
#include <vcg_ext/fit/fit_target.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <utility>

namespace vcg::fcd {

namespace {

/// Frame units.
double LongestEdge(const Graph &graph) {
    float most = 0;
    for (Index u = 0; u < graph.Size(); ++u)
        for (const Index v : graph.adjacency[u])
            most = std::max(most, (graph.position.col(u) - graph.position.col(v)).squaredNorm());
    return double(std::sqrt(most));
}

} // namespace

std::vector<AlongLine> Fitter::Along(const std::vector<std::vector<Eigen::Vector3d>> &lines,
                                     const Progress &progress) const {
    const RegionDeformer &region = deformer->Whole();
    const SurfaceGraph &surface = region.surface;
    std::vector<std::size_t> slot;
    std::vector<Eigen::Vector3d> position;
    for (std::size_t i = 0; i < source.vertexSlots; ++i) {
        const Eigen::Vector3d p = surface.frame.ToFrame(Eigen::Vector3d(source.At(i)));
        if (source.IsDeleted(i) || !p.allFinite())
            continue;
        slot.push_back(i);
        position.push_back(p);
    }
    const PointTree<double> tree(position, progress.threads);
    const Eigen::Affine3d toFrame = ToFrame(Eigen::Affine3d::Identity());
    const double most = std::max(farFromAll, LongestEdge(surface.graph));
    std::vector<AlongLine> all;
    std::size_t looked = 0; // points looked up; each takes some microseconds
    for (const std::vector<Eigen::Vector3d> &line : lines) {
        const auto told = [&] { progress(double(all.size()) / double(lines.size()), "Following the curves"); };
        told();
        AlongLine &along = all.emplace_back();
        std::map<std::size_t, std::pair<double, Eigen::Vector3d>> nearestTo; // of each vertex: distance, and the point
        const auto add = [&](const Eigen::Vector3d &place, std::size_t corner) {
            if (++looked % 4096 == 0)
                told();
            double far = 0;
            const std::size_t nearest = slot[std::size_t(tree.Nearest(toFrame * place, &far))];
            if (!(far <= along.farthest)) { // also if far is not finite
                along.farthest = far;
                along.corner = corner;
            }
            const Index node = deformer->nodeOf[nearest];
            if (node < 0 || region.held.tag[node] != 1)
                return;
            const auto [found, isNew] = nearestTo.try_emplace(nearest, far, place);
            if (!isNew && far < found->second.first)
                found->second = {far, place};
        };
        double length = 0;
        for (std::size_t k = 0; k < line.size(); ++k) {
            add(line[k], k);
            if (k > 0)
                length += (toFrame.linear() * (line[k] - line[k - 1])).norm();
        }
        along.isElsewhere = !(along.farthest <= most);
        // At most as many points as there are vertices, however often the line goes to and fro.
        const double spacing =
            std::max({surface.averageEdge, length / double(slot.size()), std::numeric_limits<double>::min()});
        for (std::size_t k = 0; k + 1 < line.size() && !along.isElsewhere; ++k) {
            const Eigen::Vector3d offset = line[k + 1] - line[k];
            const auto parts = std::size_t(std::ceil((toFrame.linear() * offset).norm() / spacing));
            for (std::size_t part = 1; part < parts; ++part)
                add(line[k] + double(part) / double(parts) * offset, k);
        }
        along.isElsewhere = !(along.farthest <= most);
        along.farthest *= surface.frame.scale;
        if (along.isElsewhere)
            break;
        for (const auto &[vertex, place] : nearestTo) {
            along.vertex.push_back(vertex);
            along.offset.emplace_back(place.second - handles.world * Eigen::Vector3d(source.At(vertex)));
        }
    }
    return all;
}

CurveLead Fitter::LeadAlong(const std::vector<CurvePair> &pairs, const std::string &surface,
                            const Progress &progress) const {
    std::vector<std::vector<Eigen::Vector3d>> lines;
    lines.reserve(pairs.size());
    for (const CurvePair &pair : pairs)
        lines.push_back(pair.source);
    CurveLead lead;
    const std::vector<AlongLine> all = Along(lines, progress);
    for (std::size_t c = 0; c < all.size(); ++c) {
        const AlongLine &along = all[c];
        const CurvePair &pair = pairs[c];
        std::string where = "the curve " + detail::Excerpt(pair.name, 0, pair.name.size());
        if (along.corner < pair.sourceLine.size()) // only if the corners came from a file
            where = "'" + pair.file + "', line " + std::to_string(pair.sourceLine[along.corner]) + ": " + where;
        if (along.isElsewhere) {
            std::ostringstream far;
            far << along.farthest;
            throw BadInput(
                where + " is " + far.str() + " from the vertices of " + surface +
                " there, more than a tenth of its diagonal. Give the rows with 'source' in world coordinates, "
                "as it lies, with enough corners.");
        }
        if (along.vertex.empty())
            throw BadInput(where + " lies where nothing of " + surface +
                           " is free. Leave it out, or tag vertices along it as free.");
        lead.vertices += along.vertex.size();
        lead.farthest = std::max(lead.farthest, along.farthest);
        lead.curve.push_back({along.vertex, pair.target, along.offset});
    }
    return lead;
}

} // namespace vcg::fcd
