// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/compensate.h>
#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_start.h>
#include <vcg_ext/fit/fit_target.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace vcg::fcd {

namespace {

/// Samples the triangles: points that stand for the same area each, and their normals, in units of \p scale.
/// \param volume out: that the triangles enclose \return their area
double SampleEvenly(const SurfaceView &mesh, int wanted, const Eigen::Vector3d &middle, double scale, WarpGoal &goal,
                    double &volume) {
    std::vector<double> area(mesh.faces, 0);
    const auto at = [&](std::size_t f, std::size_t k) {
        return Eigen::Vector3d((mesh.At(mesh.corner[3 * f + k]) - middle) / scale);
    };
    double all = 0;
    volume = 0;
    for (std::size_t f = 0; f < mesh.faces; ++f)
        if (mesh.IsFace(f)) {
            volume += at(f, 0).cross(at(f, 1)).dot(at(f, 2)) / 6;
            area[f] = (at(f, 1) - at(f, 0)).cross(at(f, 2) - at(f, 0)).norm();
            all += area[f];
        }
    if (!(all > 0))
        throw BadInput("The nominal part has no triangles with an area. Give its surface as a mesh.");
    double passed = 0;
    for (std::size_t f = 0; f < mesh.faces; ++f) {
        passed += area[f] / all * wanted;
        while (passed >= double(goal.place.size()) + 0.5) {
            // Within a triangle, points of a low-discrepancy sequence (Roberts' R2).
            const double n = double(goal.place.size()) + 1;
            double u = n * 0.7548776662466927, v = n * 0.5698402909980532;
            u -= std::floor(u);
            v -= std::floor(v);
            if (u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            const Eigen::Vector3d p = at(f, 0), a = at(f, 1) - p, b = at(f, 2) - p;
            goal.place.emplace_back(p + u * a + v * b);
            goal.normal.emplace_back(a.cross(b).stableNormalized());
        }
    }
    goal.weight.assign(goal.place.size(), 1);
    return all / 2;
}

/// Finds the match of a point on the scan.
class ScanSurface {
  public:
    /// \param spacing of a cloud's points, if they are all over the part; 0: triangles
    ScanSurface(const FitTarget &target, double spacing) : target(target), spacing(spacing) {}

    /// Flips the scan's normals if most of those near the part point the other way.
    void FindSide(const WarpGoal &goal, unsigned threads) {
        std::vector<double> far(goal.place.size()), cosine(goal.place.size(), 0);
        ParallelForEach(threads, goal.place.size(), 64, [&](std::size_t s) {
            const WarpMatch match = Match(goal.place[s]);
            far[s] = (match.point - goal.place[s]).norm();
            if (match.isOriented)
                cosine[s] = match.normal.dot(goal.normal[s]);
        });
        side = SideOfNearest(far, cosine);
    }

    /// In a cloud, the match lies on the plane through the nearest point, if it is within two spacings of that point.
    WarpMatch Match(const Eigen::Vector3d &at) const {
        const FitTarget::Match match = target.Nearest(at);
        const Eigen::Vector3d foot = at - match.normal * match.normal.dot(at - match.point);
        const bool isOnPlane = !match.normal.isZero(0) && (foot - match.point).norm() <= 2 * spacing;
        return {isOnPlane ? foot : match.point, side * match.normal, match.isOriented,
                match.onBorder ? 0 : match.weight};
    }

  private:
    const FitTarget &target;
    const double spacing;
    double side = 1;
};

// A match does not count if it is farther than this times the distance within which 95 % of the matches lie.
constexpr double farOff = 3;
// A scan of otherUnits times the part's size has other units: the closest that people mix, centimetres and inches, are
// 2.54 apart. A smaller scan may be of a piece, which the warning leaves open. If most of the part is matched, a larger
// scan has other things in it: in other units, a side of a flat part at most, half of it, lies on the scan.
constexpr double otherUnits = 2.2, mostInOtherUnits = 0.6;
// Printed, sintered and pressed parts shrink unevenly by a hundredth or two, and lift at their ends by a hundredth of
// their length, which is a bending of 8 hundredths.
constexpr double typicalStrain = 0.01, typicalBending = 0.1;

// So many samples, or points of a scan, are the fewest that tell something.
constexpr std::size_t leastMatched = 10;

/// How far the points of a cloud are apart, if they are all over a surface of this area.
double SpacingOf(const SurfaceView &cloud, double area) {
    std::size_t points = 0;
    for (std::size_t i = 0; i < cloud.vertexSlots; ++i)
        points += !cloud.IsDeleted(i) && cloud.At(i).allFinite();
    if (points < leastMatched)
        throw BadInput("The scan has " + std::to_string(points) +
                       " points, too few to tell a warp. Give points all over the part, thousands of them.");
    return std::sqrt(area / double(points));
}

/// A sentence about units, for messages; empty if the sizes tell nothing.
std::string UnitsOf(double larger) {
    if (!(larger > 0) || (larger < otherUnits && larger > 1 / otherUnits))
        return "";
    std::ostringstream line;
    line << std::setprecision(3) << " The scan is " << std::max(larger, 1 / larger) << " times "
         << (larger > 1 ? "larger" : "smaller") << " than the nominal part: if it has other units, scale it first.";
    return line.str();
}

} // namespace

Compensation::Compensation(const SurfaceView &nominal, const SurfaceView &scan, const NormalOf &scanNormal,
                           const CompensateParam &param, const Progress &progress) {
    const LoopHelpers helpers;
    if (param.degree < 1 || param.degree > 7)
        throw BadInput("The degree of the warp must be from 1 to 7; 5 is the default.");
    ValidateSamples(param.samples);
    if (!(param.largestDistance > 0))
        throw BadInput("The largest distance of matches must be positive.");
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < nominal.vertexSlots; ++i)
        if (!nominal.IsDeleted(i) && !nominal.At(i).allFinite())
            throw BadInput("Vertex " + std::to_string(i) + " of the nominal part has a coordinate that is not finite.");
    for (std::size_t f = 0; f < nominal.faces; ++f) // vertices without a face are no part of it
        for (std::size_t k = 0; nominal.IsFace(f) && k < 3; ++k)
            box.extend(Eigen::Vector3d(nominal.At(nominal.corner[3 * f + k])));
    middle = box.center();
    scale = std::max(box.diagonal().stableNorm(), std::numeric_limits<double>::min());
    WarpGoal goal;
    double volume;
    const double area = SampleEvenly(nominal, param.samples, middle, scale, goal, volume);
    const Eigen::Affine3d toFrame = Eigen::Scaling(1 / scale) * Eigen::Translation3d(-middle);
    const FitTarget target(scan, scanNormal, toFrame, progress.Slice(0, 0.1), {}, {}, "scan");
    if (target.Spans().IsLine())
        throw BadInput("The whole scan lies at one point or on one line, so it tells no warp. Scan the whole surface "
                       "of the part.");
    const double spacing = scan.isCloud ? SpacingOf(scan, area) : 0;
    report.spacing = spacing * scale;
    report.larger = target.Box().diagonal().norm();
    report.thickness = scanNormal ? std::numeric_limits<double>::infinity() : 2 * std::abs(volume) / area * scale;
    ScanSurface surface(target, spacing);
    surface.FindSide(goal, progress.threads);
    goal.match = [&](std::size_t, const Eigen::Vector3d &at) { return surface.Match(at); };
    goal.degree = param.degree;
    goal.typicalBending = typicalBending;
    goal.typicalStrain = typicalStrain;
    goal.noise = std::max(goal.noise, spacing / 10); // planes through a cloud's points cut edges by about this
    goal.farthest = param.largestDistance / scale;
    goal.expected = typicalStrain / 2; // a flat side slides along itself; only its rims show that it shrank
    WarpReport lies;
    warp = FitWarp(goal, progress.Slice(0.1, 0.6), &lies);

    // The position of the scan is no warp: the rigid motion nearest to the warp is taken out.
    std::vector<Eigen::Vector3d> warped;
    warped.reserve(goal.place.size());
    for (const Eigen::Vector3d &each : goal.place)
        warped.push_back(warp.At(each));
    placed = StartFromLandmarks(goal.place, warped, false);
    std::vector<double> before, left;
    for (std::size_t s = 0; s < goal.place.size(); ++s) {
        if (lies.share[s] < 0.5)
            continue;
        left.push_back((surface.Match(warped[s]).point - warped[s]).norm());
        const Eigen::Vector3d rigid = placed * goal.place[s];
        before.push_back((surface.Match(rigid).point - rigid).norm());
    }
    if (left.size() < leastMatched)
        throw BadInput("Nothing of the nominal part has a counterpart on the scan. Align them rigidly first, or raise "
                       "largest_distance." +
                       UnitsOf(report.larger));
    std::vector<double> sorted = left;
    std::sort(sorted.begin(), sorted.end());
    const double most = farOff * sorted[sorted.size() * 19 / 20];
    std::size_t count = 0;
    for (std::size_t i = 0; i < left.size(); ++i)
        if (left[i] <= most) {
            report.left += left[i] * left[i];
            report.before += before[i] * before[i];
            ++count;
        }
    report.left = std::sqrt(report.left / double(count)) * scale;
    report.before = std::sqrt(report.before / double(count)) * scale;
    report.scanned = double(count) / double(goal.place.size());
    double there = 0; // the same where the part is scanned
    for (std::size_t s = 0; s < lies.doubt.size(); ++s)
        (lies.share[s] < 0.5 ? report.doubt : there) += detail::Squared(lies.doubt[s]) / double(lies.doubt.size());
    report.doubt = report.doubt > there ? std::sqrt(report.doubt) * scale : 0;
    report.placed = toFrame.inverse() * placed * toFrame;
    report.rounding = 1e-12 * std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
    MakeVertices(nominal, box, progress.Slice(0.6, 1));
}

void Compensation::MakeVertices(const SurfaceView &nominal, const Eigen::AlignedBox3d &box, const Progress &progress) {
    position.resize(3, Eigen::Index(nominal.vertexSlots));
    std::vector<double> missed(nominal.vertexSlots, -1); // < 0: the vertex is not part of it
    ParallelForEach(progress, "Compensating", nominal.vertexSlots, 1 << 10, [&](std::size_t i) {
        const Eigen::Vector3d p = nominal.At(i);
        auto made = position.col(Eigen::Index(i));
        made = p;
        if (nominal.IsDeleted(i) || !box.contains(p)) // outside of the part, a polynomial has no meaning
            return;
        made = (*this)(p);
        missed[i] = ((Predicted(made) - p) / scale).norm();
    });
    double vertices = 0;
    for (std::size_t i = 0; i < nominal.vertexSlots; ++i) {
        if (missed[i] < 0)
            continue;
        const double change = ((position.col(Eigen::Index(i)) - nominal.At(i)) / scale).norm();
        report.change += change * change;
        report.changeMost = std::max(report.changeMost, change);
        report.missed = std::max(report.missed, missed[i]);
        ++vertices;
    }
    report.change = std::sqrt(report.change / std::max(vertices, 1.0)) * scale;
    report.changeMost *= scale;
    report.missed *= scale;
    progress(1, "Compensating");
}

Eigen::Vector3d Compensation::operator()(const Eigen::Vector3d &p) const {
    const Eigen::Vector3d at = (p - middle) / scale;
    return middle + scale * warp.Back(placed * at, at);
}

Eigen::Matrix3d Compensation::LinearAt(const Eigen::Vector3d &made) const {
    return warp.LinearBack((made - middle) / scale) * placed.linear();
}

Eigen::Vector3d Compensation::Predicted(const Eigen::Vector3d &p) const {
    return middle + scale * (placed.inverse(Eigen::Isometry) * warp.At((p - middle) / scale));
}

std::vector<std::string> CompensateReport::Warnings() const {
    std::vector<std::string> found;
    std::ostringstream line;
    line.precision(3);
    const auto tell = [&] {
        found.push_back(line.str());
        line.str("");
    };
    if (scanned < 0.3) { // most of the warp is a guess
        line << "Only " << 100 * scanned
             << " percent of the nominal part have a counterpart on the scan: the rest is a guess. Scan more of it, or "
                "align the two first."
             << UnitsOf(larger);
        tell();
    } else if (larger > otherUnits && scanned < mostInOtherUnits) {
        line << "Only " << 100 * scanned << " percent of the nominal part have a counterpart on the scan."
             << UnitsOf(larger);
        tell();
    } else if (doubt > std::max(0.5 * before, rounding)) {
        line << "The scan shows " << 100 * scanned << " percent of the nominal part: the rest is a guess, off by about "
             << doubt << ", where the part is off by " << before << ". Scan more of it.";
        tell();
    }
    if (spacing > thickness / 2) {
        line << "The scan's points are about " << spacing << " apart, and the part is about " << thickness
             << " thick, so a point does not show its side. Give a mesh, or normals.";
        tell();
    }
    if (left > std::max(0.5 * before, rounding)) {
        line << "The warp leaves " << left << " of the " << before
             << " (root mean square) that the part is off: the part hardly warped, the scan is noisy, or the warp is "
                "not smooth. If it is not smooth, raise degree.";
        tell();
    }
    if (missed > std::max(1e-6 * changeMost, rounding)) {
        line << "The warp cannot be turned round everywhere: the print would be off by " << missed
             << " somewhere. Lower degree.";
        tell();
    }
    return found;
}

} // namespace vcg::fcd
