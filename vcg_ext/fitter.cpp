// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/fit.h>

#include <algorithm>

namespace vcg::fcd {

namespace {

/// Whether no connected part of the free surface has a third of its area. (Area, not vertices: crumbs count little.)
/// \throw BadInput where all its triangles are lines, of which nothing tells how they bend
bool IsInParts(const SurfaceView &source, const Deformer &deformer, const Progress &progress) {
    std::vector<Index> componentOf;
    const Index parts = ConnectedComponents(deformer.Whole().surface.graph.adjacency, componentOf,
                                            progress.Slice(0, 0.4), readingStage);
    std::vector<double> area(std::size_t(parts), 0);
    double all = 0;
    bool isLines = false, isSurface = false;
    const Progress adding = progress.Slice(0.4, 1);
    for (std::size_t f = 0; f < source.faces; ++f) {
        adding.Round(f, source.faces, readingStage);
        if (!source.IsFace(f) || deformer.slotTag[source.corner[3 * f]] != 1)
            continue;
        const auto at = [&](std::size_t k) {
            return deformer.Whole().surface.frame.ToFrame(Eigen::Vector3d(source.At(source.corner[3 * f + k])));
        };
        const Eigen::Vector3d p = at(0), a = at(1) - p, b = at(2) - p;
        const double each = a.cross(b).norm();
        (each * each > 1e-12 * a.squaredNorm() * b.squaredNorm() ? isSurface : isLines) =
            true; // or it is rounding, in single precision
        all += each;
        if (const Index node = deformer.nodeOf[source.corner[3 * f]]; node >= 0) // -1: a loose part
            area[std::size_t(componentOf[node])] += each;
    }
    if (isLines && !isSurface)
        throw BadInput("The surface has no triangle with an area where it is free to bend. Take its vertices alone, as "
                       "a cloud.");
    return !area.empty() && 3 * *std::max_element(area.begin(), area.end()) < all;
}

// Of a surface in parts, those with less than a twentieth of the area of the median part (by area), less than a quarter
// as wide, are crumbs: their places tell nothing of how the others bend.
constexpr double crumbShare = 0.05;

/// Which vertex slots of a surface in parts are crumbs', or of no face; empty: none. None where these have a twentieth
/// of the area, or half of the places: then they are the surface.
std::vector<char> CrumbsOf(const SurfaceView &source, const Progress &progress) {
    const SurfaceGraph surface = BuildSurfaceGraph(source, progress.Slice(0, 0.8));
    std::vector<Index> componentOf;
    const Index parts = ConnectedComponents(surface.graph.adjacency, componentOf, progress.Slice(0.8, 1), readingStage);
    std::vector<double> area(std::size_t(parts), 0);
    for (Index u = 0; u < surface.graph.Size(); ++u)
        area[std::size_t(componentOf[u])] += double(surface.nodeArea[u]);
    std::vector<double> sorted = area;
    std::sort(sorted.begin(), sorted.end());
    double below = 0; // area of the parts that are smaller than the median one
    auto median = sorted.begin();
    for (; median != sorted.end() - 1 && 2 * (below + *median) < surface.area; ++median)
        below += *median;
    const double least = crumbShare * *median;
    const auto isCrumb = [&](Index u) { return area[std::size_t(componentOf[u])] < least; };
    double crumbs = 0; // their area
    Index places = 0;
    for (Index u = 0; u < surface.graph.Size(); ++u)
        if (isCrumb(u)) {
            crumbs += double(surface.nodeArea[u]);
            ++places;
        }
    if (places == 0 || crumbs >= crumbShare * surface.area || 2 * places >= surface.graph.Size())
        return {};
    std::vector<char> found(source.vertexSlots, 0);
    for (std::size_t i = 0; i < found.size(); ++i)
        found[i] = surface.nodeOf[i] >= 0 && isCrumb(surface.nodeOf[i]);
    return found;
}

} // namespace

Fitter::Fitter(const SurfaceView &source, const NormalOf &normal, const Handles &handles, const FitParam &param,
               const Progress &progress, const WeightOf &weight)
    : source(source), handles(handles), param(param) {
    const LoopHelpers helpers;
    param.ValidateFit();
    if (handles.tag.empty())
        throw BadInput("There is nothing to fit: the surface has no vertices.");
    if (std::count(handles.tag.begin(), handles.tag.end(), 1) == 0)
        throw BadInput("There is nothing to fit: no vertex is free. Mark the part that may bend with tag 1.");
    deformer = PrepareDeformer(source, handles, param, progress.Slice(0, 0.65));
    const std::vector<Index> &tag = deformer->Whole().held.tag;
    if (std::find(tag.begin(), tag.end(), 1) == tag.end())
        throw BadInput(
            "There is nothing to fit: only single vertices are free. Give a surface, or points all over one.");
    std::vector<char> crumb; // one per slot, or empty: none
    if (!source.isCloud &&
        IsInParts(source, *deformer, progress.Slice(0.65, 0.7))) { // join parts that lie near, as points
        SurfaceView points = source;
        points.faces = points.edges = 0;
        points.isCloud = true;
        crumb = CrumbsOf(source, progress.Slice(0.7, 0.75));
        deformer = PrepareDeformer(points, handles, param, progress.Slice(0.75, 0.9));
    }
    if (weight && !FollowsAlone())
        nodeWeight = WeightsAtNodes(source, weight, *deformer);
    if (!crumb.empty() && !FollowsAlone()) {
        nodeWeight.resize(std::size_t(deformer->Whole().surface.graph.Size()), 1);
        for (std::size_t i = 0; i < crumb.size(); ++i)
            if (crumb[i] && deformer->nodeOf[i] >= 0)
                nodeWeight[std::size_t(deformer->nodeOf[i])] = 0;
    }
    sample = EvenSample(deformer->Whole(), std::size_t(param.samples), nodeWeight);
    if (sample.empty() && !nodeWeight.empty())
        throw BadInput("The weights of the surface are 0 wherever it is free, so nothing can be matched. Raise them "
                       "where it counts, up to 1.");
    sampleNormal = NormalsAtNodes(source, normal, *deformer, sample, progress.Slice(0.9, 1));
    progress(1, "Preparing the fit");
}

} // namespace vcg::fcd
