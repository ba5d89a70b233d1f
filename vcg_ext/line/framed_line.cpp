// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/error.h>
#include <vcg_ext/line/framed_line.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace vcg::fcd {

namespace {

/// Number of segments of equal length. Cubics interpolate between their ends: a circle with a radius of a hundredth of
/// the length is met within a ten-thousandth of the radius.
constexpr Eigen::Index segments = 4096;

/// Points nearer to each other than this share of the length coincide.
constexpr double atOnePlace = 1e-9;

void Check(const Eigen::Matrix3Xd &points) {
    const Eigen::Index n = points.cols();
    if (n < 2)
        throw BadInput("The line has " + std::string(n == 0 ? "no point" : "one point only") +
                       ". Give two at least, in the order in which it goes through them.");
    if (!(points.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 1e100)) // then squares are finite, too
        throw BadInput("A point of the line is not finite, or beyond 1e100.");
    double length = 0;
    for (Eigen::Index i = 1; i < n; ++i)
        length += (points.col(i) - points.col(i - 1)).stableNorm();
    if (!(length > 1e-100))
        throw BadInput("The line has no extent: all its points are at one place.");
    for (Eigen::Index i = 1; i < n; ++i)
        if ((points.col(i) - points.col(i - 1)).stableNorm() <= atOnePlace * length)
            throw BadInput("Points " + std::to_string(i) + " and " + std::to_string(i + 1) +
                           " of the line are at one place. Leave one of them out.");
    if ((points.col(n - 1) - points.col(0)).stableNorm() <= atOnePlace * length)
        throw BadInput(
            "The line is closed: its last point is at its first. Open it: leave out points where you want to cut it.");
}

} // namespace

FramedLine::FramedLine(const Eigen::Matrix3Xd &points, double smoothing) {
    if (!(smoothing >= 0 && smoothing <= mostSmoothing))
        throw BadInput("The line can be smoothed over 0 to 25 percent of its length.");
    Check(points);
    const Eigen::Index n = points.cols();
    Eigen::Matrix3Xd chord(3, n - 1), direction(3, n);
    Eigen::VectorXd distance(n - 1);
    for (Eigen::Index i = 0; i + 1 < n; ++i) {
        chord.col(i) = points.col(i + 1) - points.col(i);
        distance[i] = chord.col(i).stableNorm();
        chord.col(i) /= distance[i];
    }
    for (Eigen::Index i = 1; i + 1 < n; ++i) {
        direction.col(i) = chord.col(i - 1) * distance[i] + chord.col(i) * distance[i - 1];
        // A turn by more than pi - 0.001.
        if (chord.col(i).dot(chord.col(i - 1)) < -1 + 5e-7)
            throw BadInput("The line turns back on itself at point " + std::to_string(i + 1) +
                           ". Give its points in the order in which it goes through them.");
        direction.col(i).normalize();
    }
    // Ends as on a circle, too: there, the tangents at both ends of a chord mirror each other.
    const auto mirrored = [](const Eigen::Vector3d &axis, const Eigen::Vector3d &t) {
        return Eigen::Vector3d(2 * t.dot(axis) * axis - t);
    };
    direction.col(0) = n > 2 ? mirrored(chord.col(0), direction.col(1)) : Eigen::Vector3d(chord.col(0));
    direction.col(n - 1) = n > 2 ? mirrored(chord.col(n - 2), direction.col(n - 2)) : Eigen::Vector3d(chord.col(0));

    const Eigen::Index pieces = std::max<Eigen::Index>(2, 4 * segments / (n - 1));
    Eigen::Matrix3Xd dense(3, pieces * (n - 1) + 1);
    dense.col(0) = points.col(0);
    for (Eigen::Index i = 0; i + 1 < n; ++i) {
        const Eigen::Vector3d a = points.col(i), b = points.col(i + 1), u = direction.col(i), v = direction.col(i + 1);
        // The length of the derivative for which the cubic meets the circle in its middle.
        const double turned = std::max(0.0, 0.5 * (u + v).dot(chord.col(i))), speed = 2 * distance[i] / (1 + turned);
        for (Eigen::Index k = 1; k <= pieces; ++k) {
            const double t = double(k) / double(pieces), r = 1 - t;
            dense.col(i * pieces + k) =
                r * r * (1 + 2 * t) * a + t * t * (1 + 2 * r) * b + speed * t * r * (r * u - t * v);
        }
    }
    Resample(dense);
    if (smoothing > 0)
        Smooth(smoothing * double(segments));
    FindFrames();
}

void FramedLine::Resample(const Eigen::Matrix3Xd &dense) {
    std::vector<double> along(1, 0);
    for (Eigen::Index i = 1; i < dense.cols(); ++i)
        along.push_back(along.back() + (dense.col(i) - dense.col(i - 1)).stableNorm());
    length = along.back();
    step = length / double(segments);
    point.resize(3, segments + 1);
    std::size_t at = 0;
    for (Eigen::Index i = 0; i <= segments; ++i) {
        const double s = double(i) * step;
        while (at + 2 < along.size() && along[at + 1] < s)
            ++at;
        const double gap = along[at + 1] - along[at], t = gap > 0 ? std::clamp((s - along[at]) / gap, 0.0, 1.0) : 0;
        point.col(i) = (1 - t) * dense.col(Eigen::Index(at)) + t * dense.col(Eigen::Index(at) + 1);
    }
}

/// Smooths by 2 G - G^2 with a Gaussian G: wide bends keep their radius. The ends stay. \param sigma in segments
void FramedLine::Smooth(double sigma) {
    const auto reach = Eigen::Index(std::ceil(4 * sigma));
    std::vector<double> weight;
    double sum = 0;
    for (Eigen::Index k = -reach; k <= reach; ++k)
        sum += weight.emplace_back(detail::Exponential(-0.5 * detail::Squared(double(k) / sigma)));
    const auto blurred = [&](const Eigen::Matrix3Xd &from) {
        const Eigen::Index last = from.cols() - 1;
        // Beyond an end, the line is reflected in that point.
        const auto at = [&](Eigen::Index i) -> Eigen::Vector3d {
            if (i < 0)
                return 2 * from.col(0) - from.col(std::min(-i, last));
            if (i > last)
                return 2 * from.col(last) - from.col(std::max<Eigen::Index>(2 * last - i, 0));
            return from.col(i);
        };
        Eigen::Matrix3Xd to(3, from.cols());
        for (Eigen::Index i = 0; i <= last; ++i) {
            Eigen::Vector3d p = Eigen::Vector3d::Zero();
            for (Eigen::Index k = -reach; k <= reach; ++k)
                p += weight[std::size_t(k + reach)] * at(i + k);
            to.col(i) = p / sum;
        }
        return to;
    };
    const Eigen::Matrix3Xd once = blurred(point), twice = blurred(once);
    Eigen::Matrix3Xd smooth = 2 * once - twice;
    smooth.col(0) = point.col(0);
    smooth.col(segments) = point.col(segments);
    Resample(smooth);
}

void FramedLine::FindFrames() {
    const Eigen::Index last = segments;
    const auto slope = [&](const Eigen::Matrix3Xd &of, Eigen::Index i) -> Eigen::Vector3d {
        if (i == 0)
            return (4 * of.col(1) - 3 * of.col(0) - of.col(2)) / (2 * step);
        if (i == last)
            return (3 * of.col(last) - 4 * of.col(last - 1) + of.col(last - 2)) / (2 * step);
        return (of.col(i + 1) - of.col(i - 1)) / (2 * step);
    };
    tangent.resize(3, last + 1);
    bend.resize(3, last + 1);
    for (Eigen::Index i = 0; i <= last; ++i)
        tangent.col(i) = slope(point, i).normalized();
    for (Eigen::Index i = 0; i <= last; ++i)
        bend.col(i) = slope(tangent, i);
    up.assign(1, tangent.col(0).unitOrthogonal());
    for (Eigen::Index i = 0; i < last; ++i) {
        const auto reflected = [](const Eigen::Vector3d &v, const Eigen::Vector3d &across) {
            const double square = across.squaredNorm();
            return square > 0 ? Eigen::Vector3d(v - (2 * v.dot(across) / square) * across) : v;
        };
        const Eigen::Vector3d offset = point.col(i + 1) - point.col(i), t = tangent.col(i), next = tangent.col(i + 1);
        Eigen::Vector3d r = reflected(reflected(up.back(), offset), next - reflected(t, offset));
        r -= r.dot(next) * next;
        up.push_back(r.normalized());
    }
}

namespace {

/// Interpolates a line at arc length \p s; beyond the ends it is straight.
struct Place {
    Eigen::Index i; ///< its segment, or the nearest one
    double t, r;    ///< position in the segment from its begin and from its end, [0, 1]
    Eigen::Vector3d point, along, bend;

    Place(double s, double length, double step, const Eigen::Matrix3Xd &points, const Eigen::Matrix3Xd &tangent,
          const Eigen::Matrix3Xd &bends) {
        const double within = std::clamp(s, 0.0, length);
        i = std::min(Eigen::Index(within / step), segments - 1);
        t = within / step - double(i);
        r = 1 - t;
        const Eigen::Vector3d u = tangent.col(i), v = tangent.col(i + 1);
        point = r * r * (1 + 2 * t) * points.col(i) + t * t * (1 + 2 * r) * points.col(i + 1) +
                step * t * r * (r * u - t * v);
        along = (r * u + t * v).normalized();
        bend = r * bends.col(i) + t * bends.col(i + 1);
        bend -= bend.dot(along) * along;
        if (s != within) {
            point += (s - within) * along;
            bend.setZero();
        }
    }
};

} // namespace

FramedLine::Frame FramedLine::At(double s) const {
    const Place place(s, length, step, point, tangent, bend);
    Frame frame;
    frame.point = place.point;
    Eigen::Vector3d across = place.r * up[std::size_t(place.i)] + place.t * up[std::size_t(place.i) + 1];
    across = (across - across.dot(place.along) * place.along).normalized();
    frame.axes << place.along, across, place.along.cross(across);
    frame.bend = place.bend;
    return frame;
}

Eigen::Vector3d FramedLine::Middle() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(); // Eigen's mean adds in an order that depends on the compiler
    for (Eigen::Index i = 0; i < point.cols(); ++i)
        sum += point.col(i);
    return sum / double(point.cols());
}

namespace {

/// The number of the point nearest to \p p, from \p first to \p last; the first of several. \param step largest
/// distance of neighbours
std::size_t NearestPoint(const Eigen::Matrix3Xd &point, const Eigen::Vector3d &p, std::size_t first, std::size_t last,
                         double step) {
    // Between two points so many steps apart, none is nearer than the mean of their distances minus half of these
    // steps. Mostly, that leaves out all but a few.
    constexpr std::size_t coarse = 16, most = std::size_t(segments) / coarse + 2;
    const auto square = [&](std::size_t i) { return (point.col(Eigen::Index(i)) - p).squaredNorm(); };
    std::array<double, most> distance;
    double bound = std::numeric_limits<double>::infinity();
    std::size_t count = 0;
    for (std::size_t i = first; i <= last; i += coarse)
        bound = std::min(bound, distance[count++] = std::sqrt(square(i)));
    std::size_t best = first;
    double least = square(first);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t begin = first + k * coarse, end = std::min(last + 1, begin + coarse);
        if (k + 1 < count) {
            const double both = distance[k] + distance[k + 1], apart = double(coarse) * step;
            if (0.5 * (both - apart) > bound + 1e-9 * (both + apart)) // up to rounding
                continue;
        }
        for (std::size_t i = begin; i < end; ++i)
            if (const double far = square(i); far < least) {
                least = far;
                best = i;
            }
    }
    return best;
}

} // namespace

double FramedLine::Nearest(const Eigen::Vector3d &p, double from, double to) const {
    const auto place = [&](double s) { return std::size_t(std::clamp(std::round(s / step), 0.0, double(segments))); };
    const std::size_t best = NearestPoint(point, p, place(from), std::max(place(from), place(to)), step);
    constexpr double any = std::numeric_limits<double>::infinity();
    const double begin = double(best) * step, low = best == 0 ? -any : begin - step,
                 high = best == std::size_t(segments) ? any : begin + step;
    double s = begin;
    for (int k = 0; k < 4; ++k) { // Newton's method, from within a segment
        const Place near(s, length, step, point, tangent, bend);
        const Eigen::Vector3d off = p - near.point;
        s += off.dot(near.along) / std::max(0.1, 1 - near.bend.dot(off));
        s = std::clamp(s, low, high);
    }
    return s;
}

void FramedLine::TurnTo(double s, const Eigen::Vector3d &across) {
    const Eigen::Matrix3d axes = At(s).axes;
    const double angle = detail::ArcTangent(across.dot(axes.col(2)), across.dot(axes.col(1)));
    for (std::size_t i = 0; i < up.size(); ++i) {
        const Eigen::Vector3d t = tangent.col(Eigen::Index(i));
        up[i] = detail::Cosine(angle) * up[i] + detail::Sine(angle) * t.cross(up[i]);
    }
}

} // namespace vcg::fcd
