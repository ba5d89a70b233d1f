// SPDX-License-Identifier: GPL-3.0-or-later
// Divides a surface into its regions, and prepares each.
#include <vcg_ext/deformer.h>
#include <vcg_ext/patches/given_nodes.h>
#include <vcg_ext/surface/surface_regions.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <string>
#include <utility>

namespace vcg {
namespace fcd {

/// Makes a Deformer: reads the free surface, divides it into regions, reads each of these by itself, in its own frame,
/// and prepares it. A region that falls apart when it is read by itself, as what is a hair in the whole is none in it,
/// is divided again.
class SurfaceDivider {
  public:
    SurfaceDivider(const SurfaceView &mesh, const Handles &handles, const DeformerParam &param, const Deformer *kept)
        : mesh(mesh), param(param), metric(handles.world.linear()), kept(kept), made(new Deformer()) {
        for (const PointHandle &p : handles.point) {
            if (p.vertex >= mesh.vertexSlots || mesh.IsDeleted(p.vertex))
                throw BadInput("Point handle " + std::to_string(made->point.size() + 1) + " is at vertex " +
                               std::to_string(p.vertex) + ", which does not exist.");
            made->point.push_back(p.vertex);
            made->pointRest.emplace_back(mesh.At(p.vertex));
        }
    }

    std::unique_ptr<Deformer> Make(const std::vector<int> &tag, const Progress &progress) {
        Source whole;
        whole.mesh = mesh;
        whole.point = made->point;
        whole.isOne = param.IsOneRegion();
        AssignLarge(whole.tag, mesh.vertexSlots, 0);
        ParallelFor(progress.threads, mesh.vertexSlots, 1 << 16, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                whole.tag[i] = mesh.IsDeleted(i) ? noVertex : std::max(-1, tag[i]);
        });
        Found found = Read(whole, true, progress.Slice(0, 0.95));
        made->slotTag = std::move(whole.tag);
        made->center = HandleCenters(made->slotTag, [&](std::size_t i) { return Eigen::Vector3d(mesh.At(i)); });
        for (const auto &[slot, its] : heldBeside)
            made->slotTag[slot] = its;
        made->loose = std::move(found.loose);
        Join(std::move(found));
        FollowLoose(progress.Slice(0.95, 1));
        FindCarried(progress.Slice(1, 1));
        return std::move(made);
    }

  private:
    static constexpr std::size_t grain = 1 << 14;

    /// What a surface is read from.
    struct Source {
        SurfaceView mesh;
        std::vector<int> tag;              // one per slot
        std::vector<Index> leftOut;        // per slot, -1 for those that are read; empty: all are
        std::vector<std::uint32_t> slotOf; // of each slot, that of the whole mesh; empty: the same
        std::vector<std::uint32_t> faceOf; // of each face, as slotOf
        std::vector<std::size_t> point;    // slots of the point handles in it
        double share = 1;                  // as of ReadRegion
        bool isOne = false;                // one region, whatever it hangs together by

        std::uint32_t InMesh(std::size_t slot) const { return slotOf.empty() ? std::uint32_t(slot) : slotOf[slot]; }
    };
    struct Found {
        std::vector<std::shared_ptr<const RegionDeformer>> regions;
        std::vector<Index> nodeOf; // of each slot, where there is one region and it is all of the mesh
        LooseSurface loose;        // of the source's slots
    };

    /// \param isWhole whether it is all of the mesh
    Found Read(const Source &source, bool isWhole, const Progress &progress) {
        Found found;
        // Of a cloud, it is known only then which of the points count.
        const bool isReadFirst = isWhole || source.mesh.isCloud;
        ContentSum::Value key{};
        if (!isReadFirst) {
            key = KeyOf(source, nullptr, progress);
            if (TakeKept(key, found))
                return found;
        }
        SurfaceGraph surface = ReadFreeSurface(source.mesh, source.tag, source.leftOut, metric, progress.Slice(0, 0.25),
                                               param.weldDistance);
        HeldNodes held = HoldNodes(surface, source.tag, source.point, progress.Slice(0.25, 0.25));
        const double patch =
            param.bendsUnheld ? surface.area / param.graph.Patches() : std::numeric_limits<double>::infinity();
        found.loose = FindLoose(source.tag, source.point, surface, held.tag, progress.Slice(0.25, 0.3), patch);
        if (isWhole) {
            made->apart = std::move(surface.apart);
            if (param.nodes.cols() > 0)
                FindGiven(surface, source.tag, held.tag);
        }
        const auto prepare = [&](double from) {
            if (isReadFirst)
                key = KeyOf(source, &surface, progress);
            if (isReadFirst && TakeKept(key, found))
                found.nodeOf = std::move(surface.nodeOf);
            else
                Prepare(source, std::move(surface), std::move(held), key, progress.Slice(from, 1), found);
            return std::move(found);
        };
        if (source.isOne) {
            if (found.loose.isPartOfSurface) {
                surface = ReadFreeSurface(source.mesh, source.tag, found.loose.partOf, metric, progress.Slice(0.3, 0.4),
                                          param.weldDistance);
                held = HoldNodes(surface, source.tag, source.point, progress.Slice(0.4, 0.4));
            }
            return prepare(0.4);
        }
        const SurfaceRegions regions = FindRegions(surface, held.tag, progress.Slice(0.3, 0.3));
        if (regions.count == 1 && !found.loose.isPartOfSurface)
            return prepare(0.3);
        if (isWhole) {
            made->together = regions.together;
            FindHeldBeside(surface, source.tag, held);
        }
        Divide(source, std::move(surface), held, regions, progress.Slice(0.3, 1), found);
        return found;
    }

    /// Reads each region of a surface by itself.
    void Divide(const Source &source, SurfaceGraph surface, const HeldNodes &held, const SurfaceRegions &regions,
                const Progress &progress, Found &found) {
        std::vector<SubMesh> parts;
        if (!source.mesh.isCloud)
            parts =
                TakeRegions(source.mesh, surface, held.tag, source.tag, source.point, regions, progress.Slice(0, 0.1));
        std::vector<std::vector<std::size_t>> point(std::size_t(regions.count)); // of each region
        std::vector<Index> of;
        for (std::size_t i : source.point)
            if (const Index u = surface.nodeOf[i]; u >= 0) {
                regions.Of(surface.graph, u, of);
                for (Index region : of)
                    point[std::size_t(region)].push_back(i);
            }
        std::vector<Found> within(point.size());
        ParallelTasks(progress.Slice(0.1, 1), readingStage, within.size(), [&](std::size_t r, const Progress &part) {
            Source each;
            each.share = source.share * regions.share[r];
            each.isOne = regions.together > 0 && r + 1 == within.size();
            if (source.mesh.isCloud)
                TakePoints(source, surface, held, regions, found.loose, Index(r), each);
            else
                TakeMesh(source, parts[r], each);
            for (std::size_t i : point[r])
                each.point.push_back(source.mesh.isCloud ? i : parts[r].Find(i));
            within[r] = Read(each, false, part);
        });
        for (std::size_t r = 0; r < within.size(); ++r) {
            found.regions.insert(found.regions.end(), within[r].regions.begin(), within[r].regions.end());
            static const std::vector<std::uint32_t> same;
            within[r].loose.components = 0; // they are counted where all is read
            AddLoose(within[r].loose, source.mesh.isCloud ? same : parts[r].slotOf, source.tag.size(), found.loose);
        }
    }

    void TakeMesh(const Source &source, SubMesh &part, Source &each) const {
        each.mesh = part.arrays.View();
        each.tag = std::move(part.tag);
        each.slotOf.reserve(part.slotOf.size());
        for (std::uint32_t i : part.slotOf)
            each.slotOf.push_back(source.InMesh(i));
        each.faceOf = std::move(part.faceOf);
        if (!source.faceOf.empty())
            for (std::uint32_t &f : each.faceOf)
                f = source.faceOf[f];
    }

    /// Of a cloud all points are looked at, as any may be a neighbour: those of other regions as if they were fixed.
    void TakePoints(const Source &source, const SurfaceGraph &surface, const HeldNodes &held,
                    const SurfaceRegions &regions, const LooseSurface &loose, Index region, Source &each) const {
        each.mesh = source.mesh;
        each.leftOut = loose.partOf;
        AssignLarge(each.tag, source.tag.size(), 0);
        std::vector<Index> of;
        for (std::size_t i = 0; i < each.tag.size(); ++i) {
            const Index u = surface.nodeOf[i];
            each.tag[i] = source.tag[i];
            if (source.tag[i] != 1)
                continue;
            bool isOwn = u >= 0 && regions.regionOf[std::size_t(u)] == region;
            if (u >= 0 && held.tag[std::size_t(u)] != 1) { // at the place of what is held, as a point handle
                regions.Of(surface.graph, u, of);
                isOwn = std::binary_search(of.begin(), of.end(), region);
            }
            if (!isOwn)
                each.tag[i] = 0;
        }
    }

    void Prepare(const Source &source, SurfaceGraph surface, HeldNodes held, const ContentSum::Value &key,
                 const Progress &progress, Found &found) const {
        ReadRegion read;
        read.key = key;
        read.slotOf = source.slotOf;
        if (!source.faceOf.empty())
            for (std::uint32_t &f : surface.faces)
                f = source.faceOf[f];
        std::vector<Index> pointTag;
        for (std::size_t i = 0; i < source.point.size(); ++i)
            if (HeldNodes::IsSingle(held.pointTag[i])) {
                pointTag.push_back(held.pointTag[i]);
                read.point.push_back(source.InMesh(source.point[i]));
            }
        held.pointTag = std::move(pointTag);
        read.share = source.share;
        read.hasGivenNodes = param.nodes.cols() > 0;
        std::vector<char> isTaken(std::size_t(surface.graph.Size()), 0);
        for (std::size_t slot : given) {
            const auto at = std::lower_bound(source.slotOf.begin(), source.slotOf.end(), slot);
            if (!source.slotOf.empty() && (at == source.slotOf.end() || *at != slot))
                continue;
            const Index u = surface.nodeOf[source.slotOf.empty() ? slot : std::size_t(at - source.slotOf.begin())];
            if (u >= 0 && held.tag[std::size_t(u)] == 1 && !std::exchange(isTaken[std::size_t(u)], char(1)))
                read.center.push_back(u);
        }
        surface.componentOf = {}; // as large as the surface, and not needed any more
        read.surface = std::move(surface);
        read.held = std::move(held);
        found.regions.push_back(std::make_shared<RegionDeformer>(std::move(read), param, found.nodeOf, progress));
    }

    /// What tells the content of a region: vertices and elements by their slots in the whole mesh, and the parameters.
    /// \param surface what was read of it; null: all of the source is
    ContentSum::Value KeyOf(const Source &source, const SurfaceGraph *surface, const Progress &progress) const {
        const std::size_t slots = surface ? surface->slots.size() : source.tag.size(),
                          faces = surface ? surface->faces.size() : source.mesh.faces;
        std::vector<ContentSum> sums((slots + faces + grain - 1) / grain);
        ParallelFor(progress.threads, slots + faces, grain, [&](std::size_t first, std::size_t last) {
            ContentSum sum;
            for (std::size_t i = first; i < std::min(last, slots); ++i) {
                const std::size_t slot = surface ? surface->slots[i] : i;
                if (surface && surface->nodeOf[slot] < 0)
                    continue;
                const auto p = source.mesh.At(slot);
                sum.Add(source.InMesh(slot), p[0], p[1], p[2], std::max(0, source.tag[slot]));
            }
            for (std::size_t i = std::max(first, slots); i < last; ++i) {
                const std::uint32_t *c =
                    source.mesh.corner + 3 * (surface ? std::size_t(surface->faces[i - slots]) : i - slots);
                sum.Add(source.InMesh(c[0]), source.InMesh(c[1]), source.InMesh(c[2]));
            }
            sums[first / grain] = sum;
        });
        ContentSum all;
        for (const ContentSum &sum : sums)
            all.Add(sum);
        for (std::size_t e = 0; e < source.mesh.edges; ++e)
            if (const std::uint32_t *end = source.mesh.end + 2 * e;
                source.mesh.IsEdge(e) && (!surface || (surface->nodeOf[end[0]] >= 0 && surface->nodeOf[end[1]] >= 0)))
                all.Add(source.InMesh(end[0]), source.InMesh(end[1]));
        for (std::size_t i : source.point)
            if (!surface || surface->nodeOf[i] >= 0)
                all.Add('p', source.InMesh(i));
        for (Eigen::Index k = 0; k < param.nodes.size(); ++k)
            all.Add('n', k, param.nodes.data()[k]);
        for (Eigen::Index k = 0; k < metric.size(); ++k)
            all.Add('m', k, metric.data()[k]);
        const GraphParam &graph = param.graph;
        all.Add(graph.targetRadius, graph.initialPatches, graph.maxIterations, graph.tolerance, graph.randomSeed,
                graph.measure, graph.initialPatches > 0 ? source.share : 1, param.graphWeights, param.weights,
                param.influence, param.bendsUnheld, param.weldDistance, source.isOne);
        const ShapeConstants &shape = param.shape;
        for (double each :
             {shape.patchRadius, shape.heldDepth, shape.leastWeight, shape.tensorRidge, shape.mostTensorChange,
              shape.smallHeldPart, shape.surrounded, shape.blendWidth, shape.smallBlendWidth, shape.openness,
              shape.detour, shape.longDetour, shape.nearby, shape.shareBall})
            all.Add('s', each);
        return all.Get();
    }

    /// \return whether the region has been prepared before
    bool TakeKept(const ContentSum::Value &key, Found &found) const {
        for (std::size_t i = 0; kept && i < kept->regions.size(); ++i)
            if (kept->Region(i).key == key) {
                found.regions.push_back(std::static_pointer_cast<const RegionDeformer>(kept->regions[i]));
                return true;
            }
        return false;
    }

    /// Vertices that share a place move as what holds it, be a region there or not.
    void FindHeldBeside(const SurfaceGraph &surface, const std::vector<int> &tag, const HeldNodes &held) {
        for (std::uint32_t slot : surface.slots)
            if (const Index u = surface.nodeOf[slot]; u >= 0)
                if (const Index its = held.Original(held.tag[std::size_t(u)]);
                    its != 1 && its >= 0 && its != std::max(0, tag[slot]))
                    heldBeside.emplace_back(slot, its);
    }

    /// The slots of the nodes that are given.
    void FindGiven(const SurfaceGraph &surface, const std::vector<int> &tag, const std::vector<Index> &nodeTag) {
        const std::vector<Index> node =
            detail::NearestNodes(mesh.Positions(), surface, tag, nodeTag, param.nodes, made->placedNodes);
        std::vector<Index> number(std::size_t(surface.graph.Size()), -1);
        for (std::size_t i = 0; i < node.size(); ++i)
            number[std::size_t(node[i])] = Index(i);
        given.assign(node.size(), 0);
        for (std::uint32_t slot : surface.slots)
            if (const Index u = surface.nodeOf[slot]; u >= 0 && number[std::size_t(u)] >= 0)
                given[std::size_t(number[std::size_t(u)])] = slot;
    }

    /// Sets what is known of each vertex, and of all regions.
    void Join(Found found) {
        Deformer &all = *made;
        all.regions.assign(found.regions.begin(), found.regions.end());
        const std::size_t count = all.regions.size();
        if (count > 0)
            all.frame = all.regions[0]->surface.frame;
        all.nodeOf = std::move(found.nodeOf);
        if (all.nodeOf.empty() && count > 0) {
            AssignLarge(all.nodeOf, mesh.vertexSlots, Index(-1));
            if (count > 1)
                AssignLarge(all.regionOf, mesh.vertexSlots, std::uint32_t(0));
            const auto set = [&](std::size_t r, const std::vector<MovingRegion::Bent> &list) {
                for (const MovingRegion::Bent &vertex : list) {
                    all.nodeOf[vertex.slot] = vertex.node;
                    if (count > 1)
                        all.regionOf[vertex.slot] = std::uint32_t(r);
                }
            };
            for (std::size_t r = count; r-- > 0;) // of what holds several, the first is kept
                set(r, all.regions[r]->beside);
            for (std::size_t r = 0; r < count; ++r)
                set(r, all.regions[r]->bent);
        }
        SurfaceReport &sum = all.report;
        for (const auto &region : all.regions) {
            const SurfaceReport &each = region->surface.report;
            for (Index SurfaceReport::*number :
                 {&SurfaceReport::vertices, &SurfaceReport::welded, &SurfaceReport::isolated,
                  &SurfaceReport::nonManifoldEdges, &SurfaceReport::repeatedFaces, &SurfaceReport::degenerateFaces,
                  &SurfaceReport::seams, &SurfaceReport::gaps, &SurfaceReport::oneSided})
                sum.*number += each.*number;
        }
        sum.pointCloud = mesh.isCloud;
        sum.components = all.loose.components;
        sum.isolated += all.loose.isolated;
    }

    void FollowLoose(const Progress &progress) {
        Deformer &all = *made;
        double largest = all.regions.empty() ? std::numeric_limits<double>::infinity() : 0;
        for (std::size_t r = 0; r < all.regions.size(); ++r)
            largest = std::max(largest, all.Region(r).TargetRadius() * all.regions[r]->surface.frame.scale);
        const auto large = [&](std::size_t leader) { // as far as patches reach
            const MovingSurface::Place place =
                leader == LooseFollowing::none ? MovingSurface::Place{nullptr, 0, -1} : all.At(leader);
            return 2 * (place.region ? all.Region(place.number).TargetRadius() * place.region->surface.frame.scale
                                     : largest);
        };
        all.following = param.looseParts == LooseParts::Follow
                            ? FollowNearest(mesh.Positions(), all.slotTag, all.frame, all.loose, large, progress)
                            : LooseFollowing{std::vector<std::size_t>(all.loose.parts, LooseFollowing::none), {}, {}};
        for (std::size_t i : all.following.leader)
            all.leaderRest.push_back(i == LooseFollowing::none ? Eigen::Vector3d::Zero() : Eigen::Vector3d(mesh.At(i)));
    }

    /// Lists the vertices that move and are not bent.
    void FindCarried(const Progress &progress) {
        Deformer &all = *made;
        std::vector<char> isPoint; // one per slot, where there is any
        for (std::size_t i : all.point) {
            isPoint.resize(all.slotTag.size(), 0);
            isPoint[i] = 1;
        }
        const auto isCarried = [&](std::size_t i) {
            if (const MovingSurface::Place place = all.At(i); place.region) {
                const Index tag = place.region->held.tag[std::size_t(place.node)];
                return tag != 1 && !place.region->held.IsFixed(tag);
            }
            if (all.slotTag[i] != 1)
                return all.slotTag[i] > 1;
            return (!all.loose.partOf.empty() && all.loose.partOf[i] >= 0) || (!isPoint.empty() && isPoint[i]);
        };
        all.carried = CollectInOrder<std::uint32_t>(progress, "Preparing the mapping", Index(all.slotTag.size()),
                                                    [&](Index i, std::vector<std::uint32_t> &found) {
                                                        if (isCarried(std::size_t(i)))
                                                            found.push_back(std::uint32_t(i));
                                                    });
    }

    const SurfaceView mesh;
    const DeformerParam &param;
    const Eigen::Matrix3d metric;
    const Deformer *kept;
    std::unique_ptr<Deformer> made;
    std::vector<std::size_t> given; // slots of the nodes that are given
    std::vector<std::pair<std::uint32_t, int>>
        heldBeside; // vertices held as others at their place, and the tags of these
};

std::unique_ptr<Deformer> PrepareDeformer(const SurfaceView &mesh, const Handles &handles, const DeformerParam &param,
                                          const Progress &progress, const Deformer *kept) {
    assert(handles.tag.size() == mesh.vertexSlots);
    return SurfaceDivider(mesh, handles, param, kept).Make(handles.tag, progress);
}

} // namespace fcd
} // namespace vcg
