// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/fit/fit_target.h>
#include <vcg_ext/surface/surface_graph.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>

namespace vcg {
namespace fcd {

Eigen::Matrix3d Moments::Axes() const {
    const Eigen::Vector3d middle = Middle();
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second / sum - middle * middle.transpose()).eigenvectors();
}

FitTarget::FitTarget(const SurfaceView &target, const std::function<Eigen::Vector3d(std::size_t)> &normalOf,
                     const Eigen::Affine3d &toFrame, const Progress &progress, const std::function<void()> &isRead)
    : isCloud(target.isCloud) {
    std::vector<std::array<Index, 3>> triangle;
    if (isCloud)
        ReadPoints(target, normalOf, toFrame);
    else
        triangle = ReadTriangles(target, toFrame, progress);
    if (isRead)
        isRead();
    place = std::make_unique<NearestPlace>(position, std::move(triangle), flags, progress.Slice(0.7, 1));
    if (!isCloud)
        LookAround(); // only now: while a tree is built, it takes the most
}

/// The vertices at one place are one, so that a border is where the surface ends, and not where vertices are doubled.
std::vector<std::array<Index, 3>> FitTarget::ReadTriangles(const SurfaceView &target, const Eigen::Affine3d &toFrame,
                                                           const Progress &progress) {
    SurfaceGraph surface = BuildSurfaceGraph(target, progress.Slice(0, 0.7));
    const Index n = surface.graph.Size();
    const std::vector<Index> nodeOf = std::move(surface.nodeOf);
    surface = {}; // what joins the nodes takes as much as all that is read here
    position.resize(3, n);
    for (std::size_t i = 0; i < target.vertexSlots; ++i)
        if (nodeOf[i] >= 0)
            position.col(nodeOf[i]) = toFrame * target.At(i);
    std::vector<std::array<Index, 3>> triangle;
    triangle.reserve(target.faces);
    for (std::size_t f = 0; f < target.faces; ++f) {
        if (!target.IsFace(f))
            continue;
        std::array<Index, 3> c;
        for (std::size_t k = 0; k < 3; ++k)
            c[k] = nodeOf[target.corner[3 * f + k]];
        if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0] || std::min({c[0], c[1], c[2]}) < 0)
            continue;
        const Eigen::Vector3d p = position.col(c[0]), one = position.col(c[1]) - p, other = position.col(c[2]) - p;
        if (one.cross(other).norm() > 1e-12 * one.norm() * other.norm()) // else a line, but for rounding: no plane
            triangle.push_back(c);
    }
    if (triangle.empty())
        throw BadInput("The target has no triangle with an area.");
    return triangle;
}

/// What the triangles tell of their corners, and of all together.
void FitTarget::LookAround() {
    const std::size_t n = std::size_t(position.cols());
    normal = Eigen::Matrix3Xf::Zero(3, position.cols());
    flags.assign(n, 0);
    // The exclusive or of the neighbours over the faces around a node: each inner one comes twice.
    std::vector<std::uint64_t> once(n, 0);
    const auto spread = [](Index i) { return (std::uint64_t(i) + 1) * 0x9E3779B97F4A7C15u; };
    for (const std::array<Index, 3> &c : place->Triangles()) {
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
                           const Eigen::Affine3d &toFrame) {
    flags.assign(target.vertexSlots, 0);
    position = Eigen::Matrix3Xd::Zero(3, Eigen::Index(target.vertexSlots));
    if (normalOf)
        normal = Eigen::Matrix3Xf::Zero(3, position.cols());
    std::size_t points = 0;
    const Eigen::Matrix3d turn = toFrame.linear().inverse().transpose();
    for (std::size_t i = 0; i < target.vertexSlots; ++i)
        if (!target.IsDeleted(i)) {
            if (!target.At(i).allFinite())
                throw detail::NotFinite(i);
            flags[i] = inside;
            ++points;
            position.col(Eigen::Index(i)) = toFrame * target.At(i);
            if (normalOf)
                normal.col(Eigen::Index(i)) = (turn * normalOf(i)).stableNormalized().cast<float>();
            moments.Add(position.col(Eigen::Index(i)), 1);
        }
    if (points == 0)
        throw BadInput("The target has no vertices.");
}

std::vector<FitTarget::Match> FitTarget::Places(std::size_t wanted) const {
    std::vector<Match> places;
    const std::size_t all = flags.size() - std::size_t(std::count(flags.begin(), flags.end(), char(0))),
                      stride = 1 + (all - 1) / std::max<std::size_t>(wanted, 1);
    std::size_t before = stride - stride / 2; // one comes where it is a multiple of the stride
    for (std::size_t i = 0; i < flags.size(); ++i)
        if (flags[i] != 0 && before++ % stride == 0)
            places.push_back(Nearest(position.col(Eigen::Index(i))));
    return places;
}

FitTarget::Match FitTarget::Nearest(const Eigen::Vector3d &p, NearestPlace::Hint &hint) const {
    const SurfacePlace at = (*place)(p, hint);
    Match match;
    match.point.setZero();
    bool isBorder = !isCloud;
    for (int k = 0; k < at.count; ++k) {
        match.point += at.weight[std::size_t(k)] * position.col(at.slot[std::size_t(k)]);
        if (normal.cols() > 0)
            match.normal += at.weight[std::size_t(k)] * normal.col(at.slot[std::size_t(k)]).cast<double>();
        isBorder = isBorder && IsBorder(at.slot[std::size_t(k)]);
    }
    match.onBorder = isBorder && at.count < 3;
    match.isOriented = true;
    if (isCloud && match.normal.isZero(0) && at.count > 2) { // the plane through the points around
        Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        for (int k = 0; k < at.count; ++k)
            middle += position.col(at.slot[std::size_t(k)]) / at.count;
        for (int k = 0; k < at.count; ++k) {
            const Eigen::Vector3d way = position.col(at.slot[std::size_t(k)]) - middle;
            spread += way * way.transpose();
        }
        match.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
        match.isOriented = false;
    }
    const double length = match.normal.norm();
    match.normal = length > 0 ? Eigen::Vector3d(match.normal / length) : Eigen::Vector3d::Zero();
    return match;
}

} // namespace fcd
} // namespace vcg
