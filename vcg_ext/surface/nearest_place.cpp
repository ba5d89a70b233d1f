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
#include <iterator>
#include <limits>
#include <utility>

namespace vcg::fcd {

namespace {

// If more vertices than so many times those that are sought are at one position, as where a scanner writes zeros for
// missed points, only that position is found.
constexpr std::size_t mostAsked = 16;

// How many vertices tell whether a cloud ends: so many reach around a vertex by about three spacings (four where the
// cloud ends). If noise hides the plane there, four times as many tell it. If other sheets of a fold do, those vertices
// tell it that lie, to within this share of the reach, along the plane of the nearest third: most of them, since their
// own sheet is nearer than others. Around a rod, fewer do.
constexpr std::size_t few = 24, looks[] = {few, 4 * few, few};
constexpr double ofSheet = 0.25;
// They lie along a plane if they extend less across it than in it (variances: largest ratio), and if they extend in it
// to both sides (smallest ratio). At a straight end, half a disc has 0.28 of the latter. Vertices on both sides of an
// edge of 90 degrees have 0.28 of the former; so have noise of half a spacing, and the blade of a knife, in the first
// number. With 0.2, a fifth of the places beyond a cut through a folded sheet are found, with 0.3 two fifths; with 0.4,
// noise makes ends of closed clouds.
constexpr double flat = 0.3, wide = 0.1;
// A point lies beyond the end if it is `beyond` spacings beside the place (between vertices, the place is nearer: it is
// their mean), and if none of them lies beside the place on that side, farther than `empty` of their reach: at a
// straight end they lie up to a quarter of it there, elsewhere all of it.
constexpr double beyond = 0.75, empty = 0.5;

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

/// The points nearest to p, one of those at a position.
/// \param at the position of a point \param found out: \p count of them; fewer if there are no more
template <class At>
void FindApart(const PointTree<double> &points, const At &at, const Eigen::Vector3d &p, std::size_t count,
               std::size_t block, std::vector<PointTree<double>::Neighbour> &found) {
    for (std::size_t asked = count; asked <= mostAsked * count; asked *= 4) {
        points.Nearest(p, asked, found, block);
        const std::size_t all = found.size();
        std::size_t apart = 0;
        for (std::size_t i = 0; i < all && apart < count; ++i) {
            bool isRepeated = false;
            for (std::size_t k = apart; k > 0 && found[k - 1].square == found[i].square && !isRepeated; --k)
                isRepeated = at(found[k - 1]) == at(found[i]);
            if (!isRepeated)
                found[apart++] = found[i];
        }
        found.resize(apart);
        if (apart == count || all < asked)
            return;
    }
}

using Neighbours = std::vector<PointTree<double>::Neighbour>;

double SpacingOf(const Neighbours &nearest) {
    return std::sqrt(nearest.back().square * detail::pi / double(nearest.size()));
}

/// Finds the plane along which the vertices around one lie.
/// \param nearest the `few` nearest ones; changed \param search search(n) sets \p nearest to the n nearest ones
/// \param from from(neighbour): its position, from that vertex
template <class Search, class From>
void LookAround(Neighbours &nearest, const Search &search, const From &from, Around &around) {
    around.isKnown = true;
    for (std::size_t i = 0; i < std::size(looks); ++i) {
        const std::size_t count = looks[i];
        const bool isOfSheet = i + 1 == std::size(looks);
        if (isOfSheet)
            nearest.resize(count); // they are sorted
        else if (i > 0)
            search(count);
        if (nearest.size() < count)
            return;
        around.reach = std::sqrt(nearest.back().square);
        around.leastBeside = beyond * SpacingOf(nearest);
        around.least = std::max(around.least, around.leastBeside);
        const auto scatterOf = [&](std::size_t first) {
            return detail::ScatterOf(first, [&](std::size_t k) { return from(nearest[k]); });
        };
        Eigen::Matrix3d scatter = scatterOf(isOfSheet ? count / 3 : count);
        if (isOfSheet) {
            const Eigen::Vector3d across = detail::SymmetricEigen(scatter).Vectors().col(0);
            const auto others = std::stable_partition(nearest.begin(), nearest.end(), [&](const auto &each) {
                return std::abs(across.dot(from(each))) <= ofSheet * around.reach;
            });
            const auto most = std::size_t(others - nearest.begin());
            if (most < count / 2)
                return;
            scatter = scatterOf(most);
        }
        const detail::SymmetricEigen eigen(scatter);
        if (eigen.values[0] > flat * eigen.values[1] || !(eigen.values[1] > wide * eigen.values[2]))
            continue;
        around.isPlane = true;
        around.across = eigen.Vectors().col(0);
        around.position.resize(3, Eigen::Index(count));
        for (std::size_t k = 0; k < count; ++k)
            around.position.col(Eigen::Index(k)) = from(nearest[k]);
        return;
    }
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
    vertices = std::make_unique<PointTree<double>>(Eigen::Matrix3Xd(position(Eigen::all, vertex)), progress.threads);
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

bool NearestPlace::EndsBefore(const Eigen::Vector3d &p, const SurfacePlace &at, Hint &hint) const {
    if (!vertices)
        return false;
    const Eigen::Vector3d near = position.col(at.slot[0]);
    Eigen::Vector3d offset = InUnit(p);
    for (int k = 0; k < at.count; ++k)
        offset -= at.weight[k] * position.col(at.slot[k]);
    const auto positionOf = [&](const auto &each) { return position.col(vertex[std::size_t(each.point)]); };
    thread_local Neighbours nearest;
    const auto search = [&](std::size_t count) { FindApart(*vertices, positionOf, near, count, hint.block, nearest); };
    Around &around = hint.around;
    const bool isOther = around.slot != at.slot[0];
    if (isOther) {
        around.slot = at.slot[0];
        around.isKnown = around.isPlane = false;
        search(few);
        around.least = nearest.size() < few ? std::numeric_limits<double>::infinity() : beyond * SpacingOf(nearest);
    }
    if (!(offset.norm() > around.least))
        return false;
    if (!around.isKnown) {
        if (!isOther)
            search(few);
        LookAround(
            nearest, search, [&](const auto &each) { return Eigen::Vector3d(positionOf(each) - near); }, around);
    }
    if (!around.isPlane || !(offset.norm() > around.least))
        return false;
    const Eigen::Vector3d beside = offset - around.across.dot(offset) * around.across;
    const double far = beside.norm();
    if (!(far > around.leastBeside))
        return false;
    for (Eigen::Index k = 0; k < around.position.cols(); ++k)
        if (!(beside.dot(around.position.col(k)) <= empty * around.reach * far))
            return false;
    return true;
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
    thread_local std::vector<PointTree<double>::Neighbour> nearest;
    const auto at = [&](const auto &each) { return position.col(vertex[std::size_t(each.point)]); };
    FindApart(*vertices, at, p, found.size(), hint.block, nearest);
    hint.block = vertices->BlockOf(std::size_t(nearest.front().at));
    const std::size_t count = nearest.size();
    for (std::size_t i = 0; i < count; ++i)
        found[i] = {std::sqrt(nearest[i].square), vertex[std::size_t(nearest[i].point)]};
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
