// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/symmetric_eigen.h>
#include <vcg_ext/fit/fit_target.h>
#include <vcg_ext/surface/surface_graph.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace vcg::fcd {

Eigen::Matrix3d Moments::Covariance() const { return second / sum - Middle() * Middle().transpose(); }

Eigen::Matrix3d Moments::Axes() const {
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(Covariance()).eigenvectors();
}

Eigen::Vector3d Moments::Longest() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spectrum(Covariance());
    return spectrum.eigenvectors().col(2) * std::sqrt(std::max(spectrum.eigenvalues()[2], 0.0));
}

double Moments::Radius() const { return std::sqrt(std::max(Covariance().trace(), 0.0)); }

namespace {

/// A surface without vertices that are not finite and the faces at them, and without points of weight 0 and faces with
/// three corners of weight 0.
class CountingPart {
  public:
    CountingPart(const SurfaceView &all, const WeightOf &weight, const std::string &name) : view(all) {
        std::vector<char> isNone(weight ? all.vertexSlots : 0, 0); // has weight 0, and no face that counts
        bool isLess = false;
        for (std::size_t i = 0; i < all.vertexSlots; ++i) {
            if (all.IsDeleted(i))
                continue;
            if (weight && CheckedWeight(weight, i, name.c_str()) == 0)
                isNone[i] = isLess = true;
            if (!all.At(i).allFinite()) {
                Leave(all, i);
                ++leftOut;
            } else if (isNone.empty() || !isNone[i]) {
                any = true;
            }
        }
        if (deleted.empty() && !isLess)
            return;
        corner.assign(all.corner, all.corner + 3 * all.faces);
        const std::vector<char> zero = isNone;
        for (std::size_t f = 0; f < all.faces; ++f) {
            if (!all.IsFace(f))
                continue;
            std::uint32_t *const at = &corner[3 * f];
            if ((!deleted.empty() && (deleted[at[0]] || deleted[at[1]] || deleted[at[2]])) ||
                (isLess && zero[at[0]] && zero[at[1]] && zero[at[2]]))
                at[0] = SurfaceView::none;
            else if (isLess)
                isNone[at[0]] = isNone[at[1]] = isNone[at[2]] = 0;
        }
        for (std::size_t i = 0; i < isNone.size(); ++i)
            if (isNone[i])
                Leave(all, i);
        if (!deleted.empty())
            view.deleted = deleted.data();
        view.corner = corner.data();
        view.edges = 0; // fits do not use edge elements
    }

    SurfaceView view;        ///< refers to this object
    std::size_t leftOut = 0; ///< number of vertices that are not finite
    bool any = false;        ///< something counts

  private:
    void Leave(const SurfaceView &all, std::size_t i) {
        if (deleted.empty())
            for (std::size_t k = 0; k < all.vertexSlots; ++k)
                deleted.push_back(all.IsDeleted(k));
        deleted[i] = 1;
    }

    std::vector<char> deleted;
    std::vector<std::uint32_t> corner;
};

} // namespace

FitTarget::FitTarget(const SurfaceView &target, const std::function<Eigen::Vector3d(std::size_t)> &normalOf,
                     const Eigen::Affine3d &toFrame, const Progress &progress, const std::function<void()> &isRead,
                     const WeightOf &weightOf, const std::string &name)
    : isCloud(target.isCloud), name(name) {
    std::vector<Corners> triangle;
    {
        const CountingPart part(target, weightOf, name);
        leftOut = part.leftOut;
        if (weightOf && !part.any)
            throw BadInput("The weights of the " + name +
                           " are 0 everywhere, so nothing can be matched. Raise them where it counts, up to 1.");
        std::size_t i = 0;
        while (i < part.view.vertexSlots && part.view.IsDeleted(i))
            ++i;
        if (i == part.view.vertexSlots)
            throw BadInput("The " + name + " has no vertices" +
                           (leftOut > 0 ? " whose coordinates are finite numbers." : "."));
        if (isCloud)
            ReadPoints(part.view, normalOf, toFrame, weightOf);
        else
            triangle = ReadTriangles(part.view, toFrame, weightOf, progress);
    }
    if (isRead)
        isRead();
    place = std::make_unique<NearestPlace>(position, std::move(triangle), flags, progress.Slice(0.7, 0.9));
    if (!isCloud)
        LookAround(progress.Slice(0.9, 1)); // after the tree, whose building needs the most memory
    for (std::size_t i = 0; i < flags.size(); ++i)
        if (flags[i] != 0)
            box.extend(position.col(Eigen::Index(i)));
}

/// Reads the triangles between welded vertices, so that borders are where the surface ends, not where vertices are
/// doubled.
std::vector<Corners> FitTarget::ReadTriangles(const SurfaceView &target, const Eigen::Affine3d &toFrame,
                                              const WeightOf &weightOf, const Progress &progress) {
    SurfaceGraph surface = BuildSurfaceGraph(target, progress.Slice(0, 0.5));
    const Index n = surface.graph.Size();
    const std::vector<Index> nodeOf = std::move(surface.nodeOf);
    surface = {}; // frees as much memory as all that is read here needs
    position.resize(3, n);
    if (weightOf)
        weight.assign(std::size_t(n), 1.f);
    for (std::size_t i = 0; i < target.vertexSlots; ++i)
        if (nodeOf[i] >= 0) {
            position.col(nodeOf[i]) = toFrame * target.At(i);
            if (weightOf) // the least of the vertices of a node
                weight[std::size_t(nodeOf[i])] = std::min(weight[std::size_t(nodeOf[i])], float(weightOf(i)));
        }
    std::vector<Corners> triangle;
    triangle.reserve(target.faces);
    ForTriangles(target, nodeOf, progress.Slice(0.5, 0.55), [&](const Corners &c) {
        const Eigen::Vector3d p = position.col(c[0]), one = position.col(c[1]) - p, other = position.col(c[2]) - p;
        if (one.cross(other).norm() > 1e-12 * one.norm() * other.norm()) // not a line, up to rounding
            triangle.push_back(c);
    });
    if (triangle.empty())
        throw BadInput("The " + name + " has no triangle with an area.");
    MakeOneSided(position, triangle, progress.Slice(0.55, 0.7));
    return triangle;
}

/// Finds normals, borders and moments from the triangles.
void FitTarget::LookAround(const Progress &progress) {
    const std::size_t n = std::size_t(position.cols());
    normal = Eigen::Matrix3Xf::Zero(3, position.cols());
    flags.assign(n, 0);
    // The exclusive or of the neighbours over a node's faces is 0 unless it is on a border: else each comes twice.
    std::vector<std::uint64_t> once(n, 0);
    const auto spread = [](Index i) { return (std::uint64_t(i) + 1) * 0x9E3779B97F4A7C15u; };
    std::size_t seen = 0;
    for (const Corners &c : place->Triangles()) {
        progress.Round(seen++, place->Triangles().size(), readingStage);
        const Eigen::Vector3d p = position.col(c[0]), one = position.col(c[1]) - p, other = position.col(c[2]) - p,
                              across = one.cross(other);
        moments.Add(p + (one + other) / 3, across.norm());
        for (std::size_t k = 0; k < 3; ++k) {
            flags[std::size_t(c[k])] = inside;
            normal.col(c[k]) += across.cast<float>();
            once[std::size_t(c[k])] ^= spread(c[(k + 1) % 3]) ^ spread(c[(k + 2) % 3]);
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        normal.col(Eigen::Index(i)).stableNormalize();
        if (once[i] != 0)
            flags[i] = border;
    }
}

void FitTarget::ReadPoints(const SurfaceView &target, const std::function<Eigen::Vector3d(std::size_t)> &normalOf,
                           const Eigen::Affine3d &toFrame, const WeightOf &weightOf) {
    flags.assign(target.vertexSlots, 0);
    if (weightOf)
        weight.assign(target.vertexSlots, 1.f);
    position = Eigen::Matrix3Xd::Zero(3, Eigen::Index(target.vertexSlots));
    if (normalOf)
        normal = Eigen::Matrix3Xf::Zero(3, position.cols());
    const Eigen::Matrix3d turn = toFrame.linear().inverse().transpose();
    for (std::size_t i = 0; i < target.vertexSlots; ++i)
        if (!target.IsDeleted(i)) {
            flags[i] = inside;
            position.col(Eigen::Index(i)) = toFrame * target.At(i);
            if (weightOf)
                weight[i] = float(weightOf(i));
            if (const Eigen::Vector3d turned = normalOf ? Eigen::Vector3d(turn * normalOf(i)) : Eigen::Vector3d::Zero();
                normalOf && turned.allFinite())
                normal.col(Eigen::Index(i)) = turned.stableNormalized().cast<float>();
            moments.Add(position.col(Eigen::Index(i)), 1);
        }
}

FitTarget::Shape FitTarget::Spans() const {
    // About the centre of the box: far from it, rounding would hide thin shapes.
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double count = 0;
    std::vector<Eigen::Index> slot;
    for (std::size_t i = 0; i < flags.size(); ++i)
        if (flags[i] != 0)
            slot.push_back(Eigen::Index(i));
    Shape shape;
    if (slot.empty())
        return shape;
    // Without strays, beside which any shape is a point.
    const Eigen::AlignedBox3d core =
        detail::WithoutStrays(box, slot.size(), [&](std::size_t k) { return Eigen::Vector3d(position.col(slot[k])); });
    const auto forAll = [&](const auto &visit) {
        for (const Eigen::Index i : slot)
            if (core.contains(position.col(i)))
                visit(Eigen::Vector3d(position.col(i) - core.center()));
    };
    forAll([&](const Eigen::Vector3d &p) {
        mean += p;
        ++count;
    });
    mean /= count;
    forAll([&](const Eigen::Vector3d &p) { second += (p - mean) * (p - mean).transpose(); });
    const Eigen::Vector3d squared = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second).eigenvalues().cwiseMax(0);
    if (std::sqrt(squared[2] / count) > 1e-12 * (core.center().norm() + 1)) { // more than rounding
        shape.acrossLine = std::sqrt(squared[1] / squared[2]);
        shape.acrossPlane = std::sqrt(squared[0] / squared[2]);
    }
    return shape;
}

std::vector<FitTarget::Match> FitTarget::Places(std::size_t wanted) const {
    std::vector<Match> places;
    if (!isCloud) {
        const auto area = [&](const Corners &c) {
            const Eigen::Vector3d p = position.col(c[0]);
            return (position.col(c[1]) - p).cross(position.col(c[2]) - p).norm();
        };
        double all = 0, passed = 0;
        for (const Corners &c : place->Triangles())
            all += area(c);
        for (const Corners &c : place->Triangles()) {
            const double size = area(c);
            passed += size;
            while (passed * double(wanted) >= (double(places.size()) + 0.5) * all) {
                const std::size_t k = places.size();
                std::size_t corner = k % 3; // in a small triangle, a corner; one on a border if there is one
                for (std::size_t i = 0; i < 3 && !IsBorder(c[corner]); ++i)
                    corner = IsBorder(c[i]) ? i : corner;
                double u = corner == 1 ? 1 : 0, v = corner == 2 ? 1 : 0;
                if (size * double(wanted) > all) { // in a large one, a point of an even sequence (Roberts' R2)
                    double whole;
                    u = std::modf(0.5 + 0.7548776662466927 * double(k), &whole);
                    v = std::modf(0.5 + 0.5698402909980532 * double(k), &whole);
                    if (u + v > 1) {
                        u = 1 - u;
                        v = 1 - v;
                    }
                }
                const Eigen::Vector3d p = position.col(c[0]);
                places.push_back(Nearest(p + u * (position.col(c[1]) - p) + v * (position.col(c[2]) - p)));
            }
        }
        return places;
    }
    const std::size_t all = flags.size() - std::size_t(std::count(flags.begin(), flags.end(), char(0))),
                      stride = 1 + (all - 1) / std::max<std::size_t>(wanted, 1);
    std::size_t before = stride - stride / 2; // a point is chosen at each multiple of the stride
    for (std::size_t i = 0; i < flags.size(); ++i)
        if (flags[i] != 0 && before++ % stride == 0)
            places.push_back(Nearest(position.col(Eigen::Index(i))));
    return places;
}

FitTarget::Match FitTarget::Nearest(const Eigen::Vector3d &p, NearestPlace::Hint &hint, bool asksEnd) const {
    const SurfacePlace at = (*place)(p, hint);
    Match match;
    match.point.setZero();
    bool isBorder = !isCloud;
    for (int k = 0; k < at.count; ++k) {
        match.point += at.weight[k] * position.col(at.slot[k]);
        if (!weight.empty())
            match.weight -= at.weight[k] * (1 - double(weight[std::size_t(at.slot[k])]));
        if (normal.cols() > 0)
            match.normal += at.weight[k] * normal.col(at.slot[k]).cast<double>();
        isBorder = isBorder && IsBorder(at.slot[k]);
    }
    match.weight = match.weight < 1e-6 ? 0 : match.weight; // rounding
    match.onBorder = isBorder && at.count < 3;
    match.isOriented = true;
    if (isCloud && match.normal.isZero(0) && at.count > 2) { // of the plane through the points around
        const auto placeOf = [&](std::size_t k) { return position.col(at.slot[k]); };
        const Eigen::Matrix3d scatter = detail::ScatterOf(std::size_t(at.count), placeOf);
        match.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
        match.isOriented = false;
    }
    const double length = match.normal.norm();
    match.normal = length > 0 ? Eigen::Vector3d(match.normal / length) : Eigen::Vector3d::Zero();
    if (isCloud) {
        if (reachesFarther)
            for (int k = 0; k < at.count; ++k)
                match.reach = std::max(match.reach, (position.col(at.slot[k]) - match.point).norm());
        match.onBorder = asksEnd && place->EndsBefore(p, at, hint);
    }
    return match;
}

} // namespace vcg::fcd
