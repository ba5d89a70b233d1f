// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/frame.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/base/symmetric_eigen.h>
#include <vcg_ext/surface/nearest_place.h>
#include <vcg_ext/surface/triangle_tree.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace vcg::fcd {

namespace {

// If more vertices than these are at one position, as where a scanner writes zeros for missed points, only that
// position is found.
constexpr std::size_t mostAsked = std::size_t(16) * (SurfacePlace::most + 1);

// How many vertices tell whether a cloud ends: so many reach around a vertex by about three spacings (four where the
// cloud ends). If noise hides the plane there, four times as many tell it.
constexpr std::size_t around[] = {24, 96};
// They lie along a plane if they extend less across it than in it (variances: largest ratio), and if they extend in it
// to both sides (smallest ratio). At a straight end, half a disc has 0.28 of the latter. Vertices on both sides of an
// edge of 90 degrees have 0.28 of the former; so have noise of half a spacing, and the blade of a knife, in the first
// number.
constexpr double flat = 0.2, wide = 0.1;
// A point lies beyond the end if it is `beyond` spacings beside the place, and seen from there less than 50 degrees (of
// this tangent) above the plane. Between vertices, the place is nearer: it is their mean. With 45 degrees and two
// spacings, fits onto halves of clouds were drawn over the end, and with one spacing a little; with 55 degrees, noise
// of half a spacing makes up to a hundredth of a closed cloud an end.
constexpr double beyond = 0.75, steepest = 1.19;

// No number that is searched is beyond this, so that squares are numbers.
constexpr double farAway = 1e100;

/// The largest coordinate of what is searched.
double FarthestOf(const Eigen::Matrix3Xd &position, const std::vector<std::array<Index, 3>> &triangle,
                  const std::vector<char> &isVertex) {
    double farthest = 0;
    const auto take = [&](Index i) { farthest = std::max(farthest, position.col(i).cwiseAbs().maxCoeff()); };
    for (const auto &corners : triangle)
        std::for_each(corners.begin(), corners.end(), take);
    for (std::size_t i = 0; triangle.empty() && i < isVertex.size(); ++i)
        if (isVertex[i])
            take(Index(i));
    return farthest;
}

} // namespace

NearestPlace::NearestPlace(const Eigen::Matrix3Xd &given, std::vector<std::array<Index, 3>> triangle,
                           const std::vector<char> &isVertex, const Progress &progress)
    : unit(detail::UnitOf(FarthestOf(given, triangle, isVertex))),
      scaled(unit == 1 ? Eigen::Matrix3Xd() : Eigen::Matrix3Xd(given / unit)), position(unit == 1 ? given : scaled) {
    assert(!triangle.empty() || std::count(isVertex.begin(), isVertex.end(), char(1)) > 0);
    if (!triangle.empty()) {
        triangles = std::make_unique<detail::TriangleTree>(position, std::move(triangle), progress);
        return;
    }
    for (std::size_t i = 0; i < isVertex.size(); ++i)
        if (isVertex[i])
            vertex.push_back(Index(i));
    Eigen::Matrix3Xd point(3, Eigen::Index(vertex.size()));
    for (std::size_t i = 0; i < vertex.size(); ++i)
        point.col(Eigen::Index(i)) = position.col(vertex[i]);
    vertices = std::make_unique<PointTree<double>>(point, progress.threads);
}

NearestPlace::~NearestPlace() = default;

/// What is farther away than numbers reach in this unit is so far in its direction.
Eigen::Vector3d NearestPlace::InUnit(const Eigen::Vector3d &p) const {
    return unit == 1 ? p : Eigen::Vector3d((p / unit).cwiseMax(-farAway).cwiseMin(farAway));
}

const std::vector<std::array<Index, 3>> &NearestPlace::Triangles() const { return triangles->Triangles(); }

SurfacePlace NearestPlace::Find(const Eigen::Vector3d &at, Hint &hint, const Eigen::Vector3d *normal) const {
    const Eigen::Vector3d p = InUnit(at);
    SurfacePlace place;
    if (vertices) {
        Among(p, hint, place);
        return place;
    }
    detail::TriangleTree::Nearest nearest = (*triangles)(p, hint.triangle);
    hint.triangle = nearest.triangle;
    if (normal && nearest.triangle >= 0 && triangles->NormalOf(nearest.triangle).dot(*normal) < 0) {
        const double reach = std::sqrt(nearest.square) + 0.5 * triangles->LongestEdgeOf(nearest.triangle);
        const detail::TriangleTree::Nearest facing = triangles->Facing(p, *normal, reach);
        if (facing.triangle >= 0)
            nearest = facing;
    }
    const double rounding = 1e-9; // smaller weights are 0: at a vertex, it is the only one
    for (int k = 0; k < 3 && nearest.triangle >= 0; ++k)
        if (nearest.weight[k] > rounding) {
            place.slot[place.count] = (*triangles)[nearest.triangle][k];
            place.weight[place.count++] = nearest.weight[k];
        }
    return place;
}

bool NearestPlace::EndsBefore(const Eigen::Vector3d &p, const SurfacePlace &at, const Hint &hint) const {
    if (!vertices)
        return false;
    const Eigen::Vector3d near = position.col(at.slot[0]);
    Eigen::Vector3d offset = InUnit(p);
    for (int k = 0; k < at.count; ++k)
        offset -= at.weight[k] * position.col(at.slot[k]);
    thread_local std::vector<PointTree<double>::Neighbour> nearest;
    for (const std::size_t count : around) {
        vertices->Nearest(near, count, nearest, hint.block);
        const double spacing = std::sqrt(nearest.back().square * detail::pi / double(nearest.size()));
        if (nearest.size() < count || !(offset.norm() > beyond * spacing))
            return false;
        const auto placeOf = [&](std::size_t k) { return position.col(vertex[std::size_t(nearest[k].point)]); };
        const detail::SymmetricEigen eigen(detail::ScatterOf(count, placeOf));
        if (eigen.values[0] > flat * eigen.values[1] || !(eigen.values[1] > wide * eigen.values[2]))
            continue;
        const double above = std::abs(eigen.Vectors().col(0).dot(offset)),
                     beside = std::sqrt(std::max(0., offset.squaredNorm() - above * above));
        return above < steepest * beside && beside > beyond * spacing;
    }
    return false;
}

double NearestPlace::SideOf(const Eigen::Vector3d &p, const Eigen::Vector3d &normal) const {
    const Index t = triangles ? (*triangles)(InUnit(p), -1).triangle : -1;
    return t < 0 ? 0 : triangles->NormalOf(t).dot(normal);
}

/// Weights of the vertices nearest to p, one of those at a position. They fall to 0 at the next vertex, and grow
/// without bound at the vertex itself (R. Franke, G. Nielson, Smooth interpolation of large sets of scattered data,
/// 1980).
void NearestPlace::Among(const Eigen::Vector3d &p, Hint &hint, SurfacePlace &place) const {
    std::array<std::pair<double, Index>, SurfacePlace::most + 1> found; // distances
    std::size_t count = 0;
    for (std::size_t asked = found.size(); count < found.size() && asked <= mostAsked; asked *= 4) {
        thread_local std::vector<PointTree<double>::Neighbour> nearest;
        vertices->Nearest(p, asked, nearest, hint.block);
        hint.block = vertices->BlockOf(std::size_t(nearest.front().at));
        count = 0;
        for (std::size_t i = 0; i < nearest.size() && count < found.size(); ++i) {
            const std::pair<double, Index> next(std::sqrt(nearest[i].square), vertex[std::size_t(nearest[i].point)]);
            bool isRepeated = false;
            for (std::size_t k = count; k > 0 && found[k - 1].first == next.first && !isRepeated; --k)
                isRepeated = position.col(found[k - 1].second) == position.col(next.second);
            if (!isRepeated)
                found[count++] = next;
        }
        if (nearest.size() < asked)
            break; // these are all
    }
    std::sort(found.begin(), found.begin() + std::ptrdiff_t(count));
    const double farthest = found[0].first > 0 ? found[count - 1].first : 0; // 0: at a vertex, the only one
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double near = std::max(found[i].first / farthest, 1e-6),
                     weight = farthest > 0 ? detail::Squared(1 / near - 1) : 0;
        if (!(weight > 0))
            break;
        place.slot[place.count] = found[i].second;
        place.weight[place.count++] = weight;
        sum += weight;
    }
    if (place.count == 0) { // p is at a vertex, or there is one vertex, or all are equally far
        place.slot[place.count] = found[0].second;
        sum = place.weight[place.count++] = 1;
    }
    for (int i = 0; i < place.count; ++i)
        place.weight[i] /= sum;
}

} // namespace vcg::fcd
