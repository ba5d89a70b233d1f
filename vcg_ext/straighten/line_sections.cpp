// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/straighten/line_places.h>
#include <vcg_ext/straighten/line_sections.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

namespace vcg::fcd::detail {

namespace {

/// Means of values around each of them, by their weights and a Gaussian. \param sum values times weights \param sigma
/// in items \return NaN if no weight is near
template <class Value>
std::vector<Value> Blurred(const std::vector<Value> &sum, const std::vector<double> &weight, double sigma) {
    const int n = int(sum.size()), reach = int(3 * sigma) + 1;
    std::vector<Value> mean;
    for (int b = 0; b < n; ++b) {
        Value all = 0;
        double total = 0;
        for (int k = std::max(0, b - reach); k <= std::min(n - 1, b + reach); ++k) {
            const double w = Exponential(-0.5 * Squared((k - b) / sigma));
            all += w * sum[k];
            total += w * weight[k];
        }
        mean.push_back(all / total);
    }
    return mean;
}

using Complex = std::complex<double>; // a vector across a line, by the frame's two axes
double LengthOf(const Complex &z) { return std::sqrt(std::norm(z)); }
double AngleOf(const Complex &z) { return ArcTangent(z.imag(), z.real()); }

/// Calls take(sample, frame, offset across) for each sample beside the line.
template <class Take>
void ForSamples(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line, Index count,
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

/// The length of the line over which the middle of each bin's cross-section is averaged, in bins: the distance of the
/// surface from the line. In a wide part, even a tilted cross-section then averages over nearly the whole part, and the
/// middle is not drawn to one side. Beside a wide part, scales fall by half of the distance. \param reach distance of
/// the surface at each bin, in bins \param least scale
std::vector<double> ScalesOf(std::vector<double> reach, double least) {
    for (double &each : reach)
        each = std::clamp(each, least, mostSmoothing * double(reach.size()));
    for (std::size_t b = 1; b < reach.size(); ++b)
        reach[b] = std::max(reach[b], reach[b - 1] - 0.5);
    for (std::size_t b = reach.size() - 1; b-- > 0;)
        reach[b] = std::max(reach[b], reach[b + 1] - 0.5);
    return reach;
}

/// Local fits around each bin, weighed by a Gaussian as wide as its scale.
class Around {
  public:
    explicit Around(std::vector<double> scale) : scale(std::move(scale)) {}

    /// The value at each bin of a straight line fitted to the values around (a mean would draw in the ends). \param sum
    /// 3 x bins, values times weights \return 3 x bins, NaN if no weight is near
    Eigen::Matrix3Xd Fitted(const Eigen::Matrix3Xd &sum, const std::vector<double> &weight) const {
        Eigen::Matrix3Xd found(3, sum.cols());
        const int n = int(sum.cols());
        for (int b = 0; b < n; ++b) {
            const double sigma = scale[b];
            const int reach = int(3 * sigma) + 1;
            Eigen::Vector3d all = Eigen::Vector3d::Zero(), slope = all;
            double total = 0, first = 0, second = 0;
            for (int k = std::max(0, b - reach); k <= std::min(n - 1, b + reach); ++k) {
                const double offset = k - b, w = Exponential(-0.5 * Squared(offset / sigma)), share = w * weight[k];
                all += w * sum.col(k);
                slope += w * offset * sum.col(k);
                total += share;
                first += offset * share;
                second += offset * offset * share;
            }
            const double spread = second - first * first / total;
            found.col(b) = all / total;
            if (spread > total) // else weights lie in one or two bins: the mean
                found.col(b) -= first / total / spread * (slope - first / total * all);
        }
        return found;
    }

    /// The value at each bin of a parabola fitted to the points around: bends that are wide against the scale keep
    /// their radius, also at the ends.
    Eigen::Matrix3Xd Smooth(const Eigen::Matrix3Xd &points) const {
        Eigen::Matrix3Xd found(3, points.cols());
        const int n = int(points.cols());
        for (int b = 0; b < n; ++b) {
            const double sigma = scale[b];
            const int reach = int(3 * sigma) + 3; // at an end, more than a parabola needs
            double moment[5] = {};
            Eigen::Vector3d sum[3] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
            for (int k = std::max(0, b - reach); k <= std::min(n - 1, b + reach); ++k) {
                const double offset = (k - b) / sigma;
                double w = Exponential(-0.5 * Squared(offset));
                for (int d = 0; d < 5; w *= offset, ++d) {
                    moment[d] += w;
                    if (d < 3)
                        sum[d] += w * points.col(k);
                }
            }
            const double zero = moment[2] * moment[4] - moment[3] * moment[3],
                         one = moment[2] * moment[3] - moment[1] * moment[4],
                         two = moment[1] * moment[3] - moment[2] * moment[2];
            found.col(b) =
                (zero * sum[0] + one * sum[1] + two * sum[2]) / (zero * moment[0] + one * moment[1] + two * moment[2]);
        }
        return found;
    }

  private:
    const std::vector<double> scale;
};

} // namespace

double ThicknessAlong(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line,
                      const Progress &progress) {
    double squares = 0, all = 0;
    ForSamples(deformer, world, line, 20000, progress,
               [&](const LineSample &sample, const FramedLine::Frame &, const Complex &across) {
                   squares += sample.weight * std::norm(across);
                   all += sample.weight;
               });
    return all > 0 ? std::sqrt(squares / all) : 0;
}

double StretchAlong(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line,
                    const Progress &progress) {
    double squares = 0, all = 0;
    ForSamples(deformer, world, line, 20000, progress,
               [&](const LineSample &sample, const FramedLine::Frame &frame, const Complex &) {
                   const double open = 1 - frame.bend.dot(sample.at - frame.point);
                   squares += sample.weight * Squared(Logarithm(std::clamp(open, 1 / mostStretch, mostStretch)));
                   all += sample.weight;
               });
    return all > 0 ? squares / all : 0;
}

Eigen::Matrix3Xd MiddleOf(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &given,
                          const Progress &progress) {
    const std::size_t bins = 512; // narrower than the body is thick, up to hundreds of times as long
    FramedLine line = given;
    Eigen::Matrix3Xd points;
    // In each round, the planes of the cross-sections are more at right angles to the body.
    const int rounds = 6;
    for (int round = 0; round < rounds; ++round) {
        std::vector<Complex> sum(bins, 0);
        std::vector<double> weight(bins, 0), reach(bins, 0);
        std::vector<std::pair<std::size_t, Complex>> places;
        double thick = 0, all = 0;
        ForSamples(deformer, world, line, 200000, progress.Slice(double(round) / rounds, double(round + 1) / rounds),
                   [&](const LineSample &sample, const FramedLine::Frame &frame, const Complex &across) {
                       // On the outer side of a bend there is more surface for each length of the line.
                       const double w =
                           sample.weight / std::max(1 / mostStretch, 1 - frame.bend.dot(sample.at - frame.point));
                       const auto bin = std::size_t(sample.s / line.Length() * double(bins));
                       sum[bin] += w * across;
                       weight[bin] += w;
                       places.emplace_back(bin, across);
                       thick += w * LengthOf(across);
                       all += w;
                   });
        // The middle has no detail finer than the body is thick: cross-sections would amplify finer wiggles.
        const double part = std::min(mostSmoothing, std::max(0.5 * thick / (all * line.Length()), 1 / double(bins)));
        for (const auto &[bin, across] : places)
            reach[bin] = std::max(reach[bin], LengthOf(across - sum[bin] / weight[bin]) / line.Length() * double(bins));
        // Smooths the line at the scale of the cross-sections, then adds their middles' offsets.
        const Around around(ScalesOf(reach, part * double(bins)));
        Eigen::Matrix3Xd on(3, Eigen::Index(bins)), off(3, Eigen::Index(bins));
        std::vector<FramedLine::Frame> frames;
        for (Eigen::Index b = 0; b < on.cols(); ++b) {
            frames.push_back(line.At((double(b) + 0.5) / double(bins) * line.Length()));
            on.col(b) = frames.back().point;
            off.col(b) << 0, sum[b].real(), sum[b].imag();
        }
        const Eigen::Matrix3Xd smooth = around.Smooth(on), across = around.Fitted(off, weight),
                               lost = around.Fitted(on - smooth, std::vector<double>(bins, 1));
        std::vector<Eigen::Vector3d> found;
        for (Eigen::Index b = 0; b < on.cols(); ++b)
            if (std::isfinite(across(1, b))) {
                const Eigen::Matrix3d &axes = frames[b].axes;
                const Eigen::Vector3d along = axes.col(0), offset = smooth.col(b) + lost.col(b) - on.col(b);
                found.emplace_back(on.col(b) + offset - offset.dot(along) * along + axes * across.col(b));
            }
        if (!(all > 0) || found.size() < bins / 2)
            throw BadInput("The surface has too few cross-sections along the line to find its middle. Give a line "
                           "along it, or one through its middle.");
        points.resize(3, Eigen::Index(found.size()) + 2);
        for (std::size_t i = 0; i < found.size(); ++i)
            points.col(Eigen::Index(i) + 1) = found[i];
        const Eigen::Index last = points.cols() - 1; // half a bin more at the ends
        points.col(0) = 1.5 * points.col(1) - 0.5 * points.col(2);
        points.col(last) = 1.5 * points.col(last - 1) - 0.5 * points.col(last - 2);
        line = FramedLine(points, part);
        for (Eigen::Index i = 0; i <= last; ++i)
            points.col(i) = line.At(line.Length() * double(i) / double(last)).point;
    }
    return points;
}

LineMotion::TwistAt TwistOf(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line) {
    constexpr std::size_t bins = 128; // about 150 samples each
    struct Section {
        double weight = 0;
        Complex sum = 0, square = 0;
        double round = 0;
    };
    std::vector<Section> section(bins);
    ForSamples(deformer, world, line, 20000, {},
               [&](const LineSample &each, const FramedLine::Frame &, const Complex &z) {
                   Section &sums = section[std::size_t(each.s / line.Length() * double(bins))];
                   sums.weight += each.weight;
                   sums.sum += each.weight * z;
                   sums.square += each.weight * z * z;
                   sums.round += each.weight * std::norm(z);
               });
    // The complex second moment has twice the angle of the longest axis; its length tells how distinct that axis is.
    std::vector<Complex> moment;
    double plain = 0, all = 0;
    for (const Section &sums : section) {
        const Complex middle = sums.weight > 0 ? sums.sum / sums.weight : 0;
        moment.push_back(sums.square - middle * sums.sum);
        plain += LengthOf(moment.back());
        all += sums.round - sums.weight * std::norm(middle);
    }
    if (!(plain > 0.1 * all)) // axes of 10 : 9, as scans of round bodies have by chance
        throw BadInput(
            "The cross-sections are nearly round, so no longest axis shows their twist. Leave the twist as it is.");
    std::vector<double> angle, weight;
    double last = 0;
    for (const Complex &each : moment) {
        if (LengthOf(each) > 0)
            last += AngleOf(each * Complex(Cosine(last), -Sine(last)));
        weight.push_back(LengthOf(each));
        angle.push_back(weight.back() * last / 2);
    }
    std::vector<double> smooth = Blurred(angle, weight, 2); // without the steps of triangles
    // Bins without surface have the angle before them, or the first one.
    const auto known = [](double each) { return std::isfinite(each); };
    last = *std::find_if(smooth.begin(), smooth.end(), known);
    for (double &each : smooth)
        last = each = known(each) ? each : last;
    const double step = line.Length() / double(bins);
    const auto at = [smooth, step](double s) { // cubics between the middles of the bins
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

} // namespace vcg::fcd::detail
