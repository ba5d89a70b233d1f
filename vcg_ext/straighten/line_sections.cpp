// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/straighten/line_places.h>
#include <vcg_ext/straighten/line_sections.h>

#include <algorithm>
#include <cmath>
#include <complex>

namespace vcg {
namespace fcd {
namespace detail {

namespace {

/// A mean of values around each of them, by the weights that come with them and a Gaussian.
/// \param sigma in values \return NaN where no weight is near
template <class Value>
std::vector<Value> Blurred(const std::vector<Value> &sum, const std::vector<double> &weight, double sigma) {
    const int n = int(sum.size()), reach = int(3 * sigma) + 1;
    std::vector<Value> mean;
    for (int b = 0; b < n; ++b) {
        Value all = 0;
        double total = 0;
        for (int k = std::max(0, b - reach); k <= std::min(n - 1, b + reach); ++k) {
            const double w = Exponential(-0.5 * Squared((k - b) / sigma));
            all += w * sum[std::size_t(k)];
            total += w * weight[std::size_t(k)];
        }
        mean.push_back(all / total);
    }
    return mean;
}

using Complex = std::complex<double>; // across a line: along the two axes
double LengthOf(const Complex &z) { return std::sqrt(std::norm(z)); }
double AngleOf(const Complex &z) { return ArcTangent(z.imag(), z.real()); }

/// Samples within the line. \param take is called with each, the frame of its place, and where it is across
template <class Take>
void ForSamples(const Deformer &deformer, const Eigen::Affine3d &world, const FramedLine &line, Index count,
                const Progress &progress, const Take &take) {
    const ToWorld toWorld(deformer.surface.frame, world);
    const std::vector<double> place = PlacesAlong(line, deformer.graph.graph.adjacency, NodesOf(deformer, toWorld));
    for (const LineSample &each : SamplesAlong(line, deformer, toWorld, place, count, progress)) {
        if (!(each.s >= 0 && each.s < line.Length()))
            continue;
        const FramedLine::Frame frame = line.At(each.s);
        const Eigen::Vector3d off = each.at - frame.point;
        take(each, frame, Complex(off.dot(frame.axes.col(1)), off.dot(frame.axes.col(2))));
    }
}

} // namespace

Eigen::Matrix3Xd MiddleOf(const Deformer &deformer, const Eigen::Affine3d &world, const FramedLine &given,
                          const Progress &progress) {
    const std::size_t bins = 512; // narrower than thick, up to what is hundreds of times as long as thick
    FramedLine line = given;
    Eigen::Matrix3Xd points;
    // Each time, the planes of the cross-sections stand better across the body.
    const int rounds = 5;
    for (int round = 0; round < rounds; ++round) {
        std::vector<Complex> sum(bins, 0);
        std::vector<double> weight(bins, 0);
        double thick = 0, all = 0;
        ForSamples(deformer, world, line, 200000, progress.Slice(double(round) / rounds, double(round + 1) / rounds),
                   [&](const LineSample &its, const FramedLine::Frame &frame, const Complex &across) {
                       // At the outer side of a bend there is more surface to a stretch of the line.
                       const double w =
                           its.weight / std::max(1 / mostStretch, 1 - frame.bend.dot(its.at - frame.point));
                       const auto bin = std::size_t(its.s / line.Length() * double(bins));
                       sum[bin] += w * across;
                       weight[bin] += w;
                       thick += w * LengthOf(across);
                       all += w;
                   });
        // A body tells its middle no finer than it is thick; of finer wiggles its cross-sections would make more.
        const double part = std::min(mostSmoothing, std::max(0.5 * thick / (all * line.Length()), 1 / double(bins)));
        const std::vector<Complex> middle = Blurred(sum, weight, part * double(bins));
        std::vector<Eigen::Vector3d> found;
        for (std::size_t b = 0; b < bins; ++b)
            if (std::isfinite(middle[b].real())) {
                const FramedLine::Frame frame = line.At((double(b) + 0.5) / double(bins) * line.Length());
                found.emplace_back(frame.point + middle[b].real() * frame.axes.col(1) +
                                   middle[b].imag() * frame.axes.col(2));
            }
        if (!(all > 0) || found.size() < bins / 2)
            throw BadInput("The surface has cross-sections at too few places of the line to find its middle. Give a "
                           "line along it, or one through its middle.");
        points.resize(3, Eigen::Index(found.size()) + 2);
        for (std::size_t i = 0; i < found.size(); ++i)
            points.col(Eigen::Index(i) + 1) = found[i];
        const Eigen::Index last = points.cols() - 1; // half a stretch more at the ends
        points.col(0) = 1.5 * points.col(1) - 0.5 * points.col(2);
        points.col(last) = 1.5 * points.col(last - 1) - 0.5 * points.col(last - 2);
        line = FramedLine(points, part);
        for (Eigen::Index i = 0; i <= last; ++i)
            points.col(i) = line.At(line.Length() * double(i) / double(last)).point;
    }
    return points;
}

LineMotion::TwistAt TwistOf(const Deformer &deformer, const Eigen::Affine3d &world, const FramedLine &line) {
    constexpr std::size_t bins = 128; // some hundred samples each
    struct Section {
        double weight = 0;
        Complex sum = 0, square = 0;
        double round = 0;
    };
    std::vector<Section> section(bins);
    ForSamples(deformer, world, line, 20000, {},
               [&](const LineSample &each, const FramedLine::Frame &, const Complex &z) {
                   Section &its = section[std::size_t(each.s / line.Length() * double(bins))];
                   its.weight += each.weight;
                   its.sum += each.weight * z;
                   its.square += each.weight * z * z;
                   its.round += each.weight * std::norm(z);
               });
    // Twice the angle of the longest axis is that of the second moment, which is as long as that axis is plain.
    std::vector<Complex> moment;
    double plain = 0, all = 0;
    for (const Section &its : section) {
        const Complex middle = its.weight > 0 ? its.sum / its.weight : 0;
        moment.push_back(its.square - middle * its.sum);
        plain += LengthOf(moment.back());
        all += its.round - its.weight * std::norm(middle);
    }
    if (!(plain > 0.1 * all)) // axes of 10 : 9, which scans of something round have by chance
        throw BadInput("The cross-sections are as good as round, so they have no longest axis that tells how they are "
                       "twisted. Leave the twist as it is.");
    std::vector<double> angle, weight;
    double last = 0;
    for (const Complex &each : moment) {
        if (LengthOf(each) > 0)
            last += AngleOf(each * Complex(Cosine(last), -Sine(last)));
        weight.push_back(LengthOf(each));
        angle.push_back(weight.back() * last / 2);
    }
    std::vector<double> smooth = Blurred(angle, weight, 2); // triangles make steps
    // Where there is no surface, the angle is that before, or the first one.
    const auto known = [](double each) { return std::isfinite(each); };
    last = *std::find_if(smooth.begin(), smooth.end(), known);
    for (double &each : smooth)
        last = each = known(each) ? each : last;
    const double step = line.Length() / double(bins);
    const auto at = [smooth, step](double s) { // cubics between the bins' middles
        const double x = std::clamp(s / step - 0.5, 0.0, double(bins) - 1);
        const std::size_t i = std::min(std::size_t(x), bins - 2);
        const auto slope = [&](std::size_t k) {
            return k == 0          ? smooth[1] - smooth[0]
                   : k == bins - 1 ? smooth[k] - smooth[k - 1]
                                   : (smooth[k + 1] - smooth[k - 1]) / 2;
        };
        const double t = x - double(i), r = 1 - t, a = smooth[i], b = smooth[i + 1], u = slope(i), v = slope(i + 1);
        LineMotion::Twist twist;
        twist.angle = r * r * (1 + 2 * t) * a + t * t * (1 + 2 * r) * b + t * r * (r * u - t * v);
        twist.slope = (6 * t * r * (b - a) + r * (1 - 3 * t) * u + t * (3 * t - 2) * v) / step;
        return twist;
    };
    const double middle = at(line.Length() / 2).angle;
    return [at, middle](double s) {
        const LineMotion::Twist twist = at(s);
        return LineMotion::Twist{middle - twist.angle, -twist.slope};
    };
}

} // namespace detail
} // namespace fcd
} // namespace vcg
