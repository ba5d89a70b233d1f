// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/surface/nearest_place.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/BVH>
#include <utility>

namespace vcg {
namespace fcd {

class NearestPlace::Search {
  public:
    Search(const Eigen::Matrix3Xd &position, std::vector<std::array<Index, 3>> triangle,
           const std::vector<char> &isVertex)
        : position(position), triangle(std::move(triangle)) {
        assert(!this->triangle.empty() || std::count(isVertex.begin(), isVertex.end(), char(1)) > 0);
        if (!this->triangle.empty()) {
            std::vector<Index> object(this->triangle.size());
            std::vector<Box> box(this->triangle.size());
            Box all;
            for (std::size_t t = 0; t < object.size(); ++t) {
                object[t] = Index(t);
                for (Index i : this->triangle[t])
                    box[t].extend(Eigen::Vector3d(position.col(i)));
            }
            for (const Box &each : box)
                all.extend(each);
            triangles.init(object.begin(), object.end(), box.begin(), box.end());
            largestSquare = all.min().cwiseAbs().cwiseMax(all.max().cwiseAbs()).squaredNorm();
            return;
        }
        std::vector<Eigen::Vector3d> point;
        for (std::size_t i = 0; i < isVertex.size(); ++i)
            if (isVertex[i]) {
                vertex.push_back(Index(i));
                point.emplace_back(position.col(Eigen::Index(i)));
            }
        vertices = std::make_unique<PointTree<double>>(point);
    }

    SurfacePlace operator()(const Eigen::Vector3d &p, Hint &hint) const {
        SurfacePlace place;
        if (vertices) {
            Among(p, place);
            return place;
        }
        Descent search{*this, p, -1, Eigen::Vector3d::Zero(), std::numeric_limits<double>::infinity()};
        // A bound above its distance by more than rounding (1e-10 of the coordinates): what may be nearest is looked at
        // in the same order, whatever the bound.
        if (hint.triangle >= 0)
            search.least =
                search.SquareOf(hint.triangle, search.weight) * (1 + 1e-7) + 1e-20 * (p.squaredNorm() + largestSquare);
        search.Run();
        if (search.best < 0) { // the bound was no number, or below the least one
            search.least = std::numeric_limits<double>::infinity();
            search.Run();
        }
        hint.triangle = search.best;
        const double rounding = 1e-9; // at a vertex there is no other
        for (int k = 0; k < 3 && search.best >= 0; ++k)
            if (search.weight[k] > rounding) {
                place.slot[place.count] = triangle[search.best][k];
                place.weight[place.count++] = search.weight[k];
            }
        return place;
    }

  private:
    using Box = Eigen::AlignedBox3d;

    struct Descent {
        const Search &places;
        Eigen::Vector3d p;
        Index best;
        Eigen::Vector3d weight;
        double least;

        /// Depth first, into the nearer box first. (Eigen::BVMinimize takes the nearest box of all, from a heap that it
        /// allocates: the same result in more than twice the time.)
        void Run() {
            using Tree = Eigen::KdBVH<double, 3, Index>;
            struct Step {
                double square;
                int box;
            };
            std::array<Step, 128> next; // two a level, of 31 at most
            int count = 0;
            next[count++] = {0, places.triangles.getRootIndex()};
            while (count > 0) {
                const Step step = next[--count];
                if (!(step.square < least))
                    continue;
                Tree::VolumeIterator box = nullptr, lastBox = nullptr;
                Tree::ObjectIterator object = nullptr, lastObject = nullptr;
                places.triangles.getChildren(step.box, box, lastBox, object, lastObject);
                for (; object != lastObject; ++object)
                    Try(*object);
                const int first = count;
                for (; box != lastBox; ++box)
                    next[count++] = {places.triangles.getVolume(*box).squaredExteriorDistance(p), *box};
                if (count - first == 2 && next[first].square < next[first + 1].square)
                    std::swap(next[first], next[first + 1]);
            }
        }

        double SquareOf(Index t, Eigen::Vector3d &here) const {
            const auto corner = [&](int k) { return Eigen::Vector3d(places.position.col(places.triangle[t][k])); };
            here = WeightsOfNearest(corner(0), corner(1), corner(2), p);
            return (corner(0) * here[0] + corner(1) * here[1] + corner(2) * here[2] - p).squaredNorm();
        }

        void Try(Index t) {
            Eigen::Vector3d here;
            const double square = SquareOf(t, here);
            if (square < least || (square == least && t < best)) {
                least = square;
                best = t;
                weight = here;
            }
        }
    };

    /// Barycentric coordinates of the point of a triangle that is nearest to p (C. Ericson, Real-Time Collision
    /// Detection, 5.1.5).
    static Eigen::Vector3d WeightsOfNearest(const Eigen::Vector3d &a, const Eigen::Vector3d &b,
                                            const Eigen::Vector3d &c, const Eigen::Vector3d &p) {
        const Eigen::Vector3d ab = b - a, ac = c - a;
        const double d1 = ab.dot(p - a), d2 = ac.dot(p - a), d3 = ab.dot(p - b), d4 = ac.dot(p - b), d5 = ab.dot(p - c),
                     d6 = ac.dot(p - c);
        if (d1 <= 0 && d2 <= 0)
            return {1, 0, 0};
        if (d3 >= 0 && d4 <= d3)
            return {0, 1, 0};
        if (d6 >= 0 && d5 <= d6)
            return {0, 0, 1};
        const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
        if (vc <= 0 && d1 >= 0 && d3 <= 0)
            return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
        if (vb <= 0 && d2 >= 0 && d6 <= 0)
            return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
        if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
            const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
            return {0, 1 - w, w};
        }
        const double sum = va + vb + vc;
        return {va / sum, vb / sum, vc / sum};
    }

    /// The vertices nearest to p, by weights that fall to 0 at the next one, and are beyond all others at the vertex
    /// itself (R. Franke, G. Nielson, Smooth interpolation of large sets of scattered data, 1980).
    void Among(const Eigen::Vector3d &p, SurfacePlace &place) const {
        std::vector<PointTree<double>::Found> nearest;
        vertices->Nearest(p, SurfacePlace::most + 1, nearest);
        std::vector<std::pair<double, Index>> found;
        found.reserve(SurfacePlace::most + 1);
        for (const auto &each : nearest)
            found.emplace_back(std::sqrt(each.square), vertex[std::size_t(each.point)]);
        std::sort(found.begin(), found.end());
        if (found.empty())
            return;
        const double last = found[0].first > 0 ? found.back().first : 0; // at a vertex there is no other
        double sum = 0;
        for (const auto &each : found) {
            const double near = std::max(each.first / last, 1e-6), weight = last > 0 ? std::pow(1 / near - 1, 2) : 0;
            if (!(weight > 0))
                break;
            place.slot[place.count] = each.second;
            place.weight[place.count++] = weight;
            sum += weight;
        }
        if (place.count == 0) { // one vertex, at it, or all of them equally far
            place.slot[place.count] = found[0].second;
            sum = place.weight[place.count++] = 1;
        }
        for (int i = 0; i < place.count; ++i)
            place.weight[i] /= sum;
    }

    const Eigen::Matrix3Xd &position;
    std::vector<std::array<Index, 3>> triangle;
    Eigen::KdBVH<double, 3, Index> triangles;
    double largestSquare = 0; ///< of the triangles' coordinates
    std::vector<Index> vertex;
    std::unique_ptr<PointTree<double>> vertices;
};

NearestPlace::NearestPlace(const Eigen::Matrix3Xd &position, std::vector<std::array<Index, 3>> triangle,
                           const std::vector<char> &isVertex)
    : search(std::make_unique<Search>(position, std::move(triangle), isVertex)) {}

NearestPlace::~NearestPlace() = default;

SurfacePlace NearestPlace::operator()(const Eigen::Vector3d &p) const {
    Hint none;
    return (*search)(p, none);
}

SurfacePlace NearestPlace::operator()(const Eigen::Vector3d &p, Hint &hint) const { return (*search)(p, hint); }

} // namespace fcd
} // namespace vcg
