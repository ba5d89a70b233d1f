// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/straighten/line_places.h>
#include <vcg_ext/straighten/section_twist.h>

#include <algorithm>
#include <cmath>
#include <complex>

namespace vcg {
namespace fcd {

LineMotion::TwistAt TwistOf(const Deformer &deformer, const Eigen::Affine3d &world, const FramedLine &line) {
    using Complex = std::complex<double>;
    const detail::ToWorld toWorld(deformer.surface.frame, world);
    const std::vector<double> place =
        detail::PlacesAlong(line, deformer.graph.graph.adjacency, detail::NodesOf(deformer, toWorld));
    constexpr std::size_t bins = 128; // of the line; some hundred samples each
    struct Section {
        double weight = 0;
        Complex sum = 0, square = 0;
        double round = 0;
    };
    std::vector<Section> section(bins);
    for (const detail::LineSample &each : detail::SamplesAlong(line, deformer, toWorld, place, 20000)) {
        if (!(each.s >= 0 && each.s < line.Length()))
            continue;
        const FramedLine::Frame frame = line.At(each.s);
        const Eigen::Vector3d off = each.at - frame.point;
        const Complex z(off.dot(frame.axes.col(1)), off.dot(frame.axes.col(2)));
        Section &its = section[std::size_t(each.s / line.Length() * double(bins))];
        its.weight += each.weight;
        its.sum += each.weight * z;
        its.square += each.weight * z * z;
        its.round += each.weight * std::norm(z);
    }
    // Twice the angle of the longest axis is that of the second moment, which is as long as that axis is plain.
    std::vector<Complex> moment;
    double plain = 0, all = 0;
    for (const Section &its : section) {
        const Complex middle = its.weight > 0 ? its.sum / its.weight : 0;
        moment.push_back(its.square - middle * its.sum);
        plain += std::abs(moment.back());
        all += its.round - its.weight * std::norm(middle);
    }
    if (!(plain > 0.1 * all)) // axes of 10 : 9, which scans of something round have by chance
        throw BadInput("The cross-sections are as good as round, so they have no longest axis that tells how they are "
                       "twisted. Leave the twist as it is.");
    std::vector<double> angle;
    double last = 0;
    for (const Complex &each : moment) {
        if (std::abs(each) > 0)
            last += std::arg(each * std::polar(1.0, -last));
        angle.push_back(last / 2);
    }
    std::vector<double> smooth(bins);
    for (std::size_t b = 0; b < bins; ++b) { // over some bins, as the triangles make steps
        double sum = 0, total = 0;
        for (int k = -4; k <= 4; ++k) {
            const auto at = std::size_t(std::clamp(int(b) + k, 0, int(bins) - 1));
            const double w = std::exp(-0.125 * k * k) * std::abs(moment[at]);
            sum += w * angle[at];
            total += w;
        }
        smooth[b] = total > 0 ? sum / total : angle[b];
    }
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

} // namespace fcd
} // namespace vcg
