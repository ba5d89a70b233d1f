// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/lists.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/surface/free_region.h>
#include <vcg_ext/surface/loose_parts.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <utility>

namespace vcg::fcd {

namespace {

/// The places of a surface that loose parts follow: a sample of its vertices, so dense that neighbours move alike.
class Places {
  public:
    /// \param position 3 x slots, mesh units \param slotTag as in FindLoose \param isPlace isPlace(slot): it may be one
    template <class IsPlace>
    Places(const PositionsRef &position, const std::vector<int> &slotTag, const Frame &frame, const IsPlace &isPlace)
        : frame(frame) {
        const std::size_t most = 1 << 16;
        std::vector<std::size_t> held, bent;
        for (std::size_t i = 0; i < slotTag.size(); ++i)
            if (slotTag[i] != noVertex && isPlace(i))
                (slotTag[i] == 1 ? bent : held).push_back(i);
        // Vertices at one position are one place: the several of unwelded meshes would leave no room for other places.
        std::set<std::array<double, 3>> seen;
        for (const std::vector<std::size_t> *from : {&bent, &held})
            for (std::size_t i = 0; i < std::min(most, from->size()); ++i) {
                const std::size_t each = (*from)[from->size() * i / std::min(most, from->size())];
                const auto p = position.col(Eigen::Index(each));
                if (seen.insert({p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}).second) // no negative zero
                    slot.push_back(each);
            }
        std::vector<Eigen::Vector3d> point;
        point.reserve(slot.size());
        for (std::size_t i : slot)
            point.push_back(frame.ToWorld(position.col(Eigen::Index(i))));
        unit = detail::TakeUnit(point);
        if (!slot.empty())
            tree = std::make_unique<PointTree<double>>(point);
    }

    bool IsEmpty() const { return slot.empty(); }

    /// The slot of the place nearest to \p p (mesh units). \param distance out, world units
    std::size_t Nearest(const Eigen::Vector3d &p, double &distance) const {
        const std::size_t nearest = slot[std::size_t(tree->Nearest(frame.ToWorld(p) / unit, &distance))];
        distance *= unit;
        return nearest;
    }

    static constexpr int several = LooseFollowing::several;
    /// The slots of the places nearest to \p p (mesh units), -1 beyond the last one, and weights of sum 1 that change
    /// smoothly with \p p.
    void Several(const Eigen::Vector3d &p, Index slots[several], float weights[several]) const {
        std::vector<PointTree<double>::Neighbour> nearest;
        tree->Nearest(frame.ToWorld(p) / unit, several + 1, nearest);
        std::vector<std::pair<double, Index>> found;
        found.reserve(several + 1);
        for (const auto &each : nearest)
            found.emplace_back(std::sqrt(each.square), Index(slot[std::size_t(each.point)]));
        std::sort(found.begin(), found.end());
        const double last = found.empty() ? 0 : found.back().first; // weights fall to 0 at the farthest place
        double sum = 0, weight[several] = {};
        for (int i = 0; i < several; ++i) {
            const bool is = i < int(found.size());
            slots[i] = is ? found[i].second : -1;
            weight[i] = is && last > 0 ? detail::Squared(1 - found[i].first / last) : 0;
            sum += weight[i];
        }
        if (!(sum > 0) && !found.empty())
            sum = weight[0] = 1;
        for (int i = 0; i < several; ++i)
            weights[i] = sum > 0 ? float(weight[i] / sum) : 0.f;
    }

  private:
    const Frame &frame;
    double unit; ///< world units, of the tree's
    std::vector<std::size_t> slot;
    std::unique_ptr<PointTree<double>> tree;
};

/// Lists the places that vertices follow, each once, and replaces their slots by indices into that list.
void NumberPlaces(LooseFollowing &following) {
    for (const LooseFollowing::Vertex &vertex : following.vertex)
        for (const Index slot : vertex.place)
            if (slot >= 0)
                following.place.push_back(std::size_t(slot));
    SortUnique(following.place);
    for (LooseFollowing::Vertex &vertex : following.vertex)
        for (Index &place : vertex.place)
            if (place >= 0)
                place = Index(std::lower_bound(following.place.begin(), following.place.end(), std::size_t(place)) -
                              following.place.begin());
}

} // namespace

SurfaceGraph ReadFreeSurface(const SurfaceView &mesh, const std::vector<int> &tag, const Eigen::Matrix3d &metric,
                             const Progress &progress, double weldDistance, const CloudPart &of) {
    Region region = FreeRegion(mesh, tag, metric, progress.Slice(0, 0.2), of);
    SurfaceGraph surface;
    if (region.reach <= of.reach)
        surface = BuildSurfaceGraph(mesh, &region, tag, metric, progress.Slice(0.2, 1), weldDistance);
    surface.faces = std::move(region.faces);
    surface.apart = std::move(region.apart);
    surface.reach = region.reach;
    return surface;
}

LooseSurface FindLoose(const std::vector<int> &slotTag, const std::vector<std::size_t> &point,
                       const SurfaceGraph &surface, const FreeComponents &components, const Progress &progress,
                       double least) {
    LooseSurface loose;
    loose.components = components.connected;
    const std::vector<Index> &componentOf = components.componentOf;
    std::vector<char> stays = components.isHeld;
    if (std::isfinite(least)) {
        std::vector<double> area(stays.size(), 0);
        for (Index u = 0; u < surface.graph.Size(); ++u)
            if (componentOf[u] >= 0)
                area[componentOf[u]] += surface.nodeArea[u];
        const double largest = area.empty() ? 0 : *std::max_element(area.begin(), area.end());
        for (std::size_t c = 0; c < area.size(); ++c)
            stays[c] |= area[c] >= std::min(least, largest);
    }
    std::vector<Index> number(stays.size(), -1);
    for (std::size_t c = 0; c < stays.size(); ++c)
        if (!stays[c])
            number[c] = loose.parts++;
    loose.isPartOfSurface = loose.parts > 0;
    std::vector<char> isPoint;
    for (std::size_t i : point)
        if (surface.nodeOf[i] < 0) {
            isPoint.resize(slotTag.size(), 0);
            isPoint[i] = 1;
        }
    const std::vector<Index> slots = NumbersThat(progress, readingStage, slotTag.size(), [&](Index i) {
        const Index u = surface.nodeOf[i];
        return slotTag[i] == 1 &&
               (u < 0 ? isPoint.empty() || !isPoint[i] : componentOf[u] >= 0 && !stays[componentOf[u]]);
    });
    if (!slots.empty())
        AssignLarge(loose.partOf, slotTag.size(), Index(-1));
    for (Index i : slots) {
        const Index u = surface.nodeOf[i];
        if (u < 0) {
            ++loose.isolated;
            ++loose.components;
        }
        loose.partOf[i] = u < 0 ? loose.parts++ : number[componentOf[u]];
    }
    return loose;
}

LooseFollowing FollowNearest(const PositionsRef &position, const std::vector<int> &slotTag, const Frame &frame,
                             const LooseSurface &loose, const std::function<double(std::size_t)> &large,
                             const Progress &progress) {
    LooseFollowing following;
    following.leader.assign(loose.parts, LooseFollowing::none);
    if (loose.parts == 0)
        return following;
    const Places places(position, slotTag, frame, [&](std::size_t i) { return loose.partOf[i] < 0; });
    if (places.IsEmpty())
        return following;
    struct Near {
        std::size_t slot, place;
        double distance;
    };
    std::vector<Near> near; // of the vertices of the parts
    for (std::size_t i = 0; i < slotTag.size(); ++i)
        if (loose.partOf[i] >= 0)
            near.push_back({i, LooseFollowing::none, 0});
    const char *stage = "Finding what loose parts follow";
    ParallelForEach(progress.Slice(0, 0.6), stage, near.size(), 1 << 10, [&](std::size_t n) {
        near[n].place = places.Nearest(position.col(Eigen::Index(near[n].slot)), near[n].distance);
    });
    std::vector<double> distance(loose.parts, std::numeric_limits<double>::infinity());
    std::vector<Eigen::AlignedBox3d> box(loose.parts);
    for (const Near &each : near) {
        const Index part = loose.partOf[each.slot];
        if (each.distance < distance[part]) {
            distance[part] = each.distance;
            following.leader[part] = each.place;
        }
        box[part].extend(frame.ToWorld(position.col(Eigen::Index(each.slot))));
    }
    std::vector<char> isLarge(loose.parts);
    for (Index part = 0; part < loose.parts; ++part)
        isLarge[part] = box[part].diagonal().stableNorm() > large(following.leader[part]);
    for (std::size_t i = 0; i < slotTag.size(); ++i)
        if (loose.partOf[i] >= 0 && isLarge[loose.partOf[i]]) {
            following.vertex.emplace_back();
            following.vertex.back().slot = i;
        }
    ParallelForEach(progress.Slice(0.6, 1), stage, following.vertex.size(), 1 << 10, [&](std::size_t v) {
        LooseFollowing::Vertex &vertex = following.vertex[v];
        places.Several(position.col(Eigen::Index(vertex.slot)), vertex.place, vertex.weight);
    });
    NumberPlaces(following);
    return following;
}

} // namespace vcg::fcd
