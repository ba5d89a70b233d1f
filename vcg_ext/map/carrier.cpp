// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/map/carrier.h>

#include <algorithm>

namespace vcg::fcd {

namespace {

std::vector<std::unique_ptr<const GraphMapping::Posed>> MappedOf(const MovingSurface &moving, const SurfacePose &pose,
                                                                 unsigned threads) {
    std::vector<std::unique_ptr<const GraphMapping::Posed>> mapped(moving.regions.size());
    ParallelFor(threads, mapped.size(), 1, [&](std::size_t r, std::size_t) {
        const MovingRegion &region = *moving.regions[r];
        const RegionPose &posed = pose.region[r];
        mapped[r] = std::make_unique<const GraphMapping::Posed>(*region.mapping, posed.graph, posed.motion,
                                                                region.surface.frame, threads);
    });
    return mapped;
}

} // namespace

Carrier::Carrier(const MovingSurface &surface, const SurfacePose &pose, unsigned threads)
    : moving(surface), pose(pose), mapped(MappedOf(surface, pose, threads)), looseMotion(LooseMotions()),
      placeMotion(PlaceMotions(threads)), moves(pose.Moves()) {
    for (const RegionPose &region : pose.region)
        regionMoves.push_back(region.Moves());
}

Eigen::Vector3d Carrier::MovedUnbent(std::size_t slot, const Eigen::Vector3d &p, Eigen::Matrix3f &linear) const {
    linear.setIdentity();
    if (!moves || moving.slotTag[slot] == noVertex)
        return p;
    const MovingSurface::Place place = moving.At(slot);
    if (place.region && place.region->held.IsFixed(place.region->held.tag[place.node]))
        return p;
    const auto told = pose.given.pointMotion.find(slot);
    const auto &follows = moving.following.vertex;
    const auto follower =
        std::lower_bound(follows.begin(), follows.end(), slot,
                         [](const LooseFollowing::Vertex &vertex, std::size_t s) { return vertex.slot < s; });
    const Eigen::Matrix4d &matrix = place.region ? GivenAt(slot) : MatrixAt(slot);
    linear = matrix.topLeftCorner<3, 3>().cast<float>();
    if (told != pose.given.pointMotion.end())
        return p + told->second.topRightCorner<3, 1>();
    if (follower != follows.end() && follower->slot == slot)
        return Followed(*follower, p);
    return matrix.isIdentity(0) ? p : Eigen::Vector3d((matrix * p.homogeneous()).head<3>());
}

void Carrier::Displacements(const std::vector<SurfacePlace> &place, const std::vector<Eigen::Vector3d> &p,
                            std::vector<Eigen::Vector3d> &displacement, std::vector<Eigen::Matrix3f> &linear) const {
    // Each corner of each place is mapped. Free ones of one patch are mapped together.
    struct Corner {
        std::size_t region;
        Index patch, node;
        std::size_t point, at; // at: in moved and map
        bool operator<(const Corner &o) const { return region != o.region ? region < o.region : patch < o.patch; }
    };
    std::vector<Corner> free;
    std::vector<Eigen::Vector3d> moved;
    std::vector<Eigen::Matrix3f> map;
    for (std::size_t s = 0; s < place.size(); ++s)
        for (int k = 0; k < place[s].count; ++k) {
            const auto slot = std::size_t(place[s].slot[k]);
            const MovingSurface::Place at = moving.At(slot);
            map.emplace_back(Eigen::Matrix3f::Identity());
            moved.push_back(p[s]);
            if (!at.region || !at.region->IsFree(at.node))
                moved.back() = MovedUnbent(slot, p[s], map.back());
            else if (const Index patch = at.region->patches.patchOf[at.node]; !Rests(at.number, patch))
                free.push_back({at.number, patch, at.node, s, moved.size() - 1});
        }
    std::stable_sort(free.begin(), free.end());
    GraphMapping::Posed::Scratch scratch;
    for (std::size_t i = 0, next; i < free.size(); i = next) {
        Index node[detail::lanes];
        for (next = i; next < std::min(free.size(), i + detail::lanes) && !(free[i] < free[next]); ++next) {
            node[next - i] = free[next].node;
            scratch.vertices.SetRest(int(next - i), p[free[next].point]);
        }
        mapped[free[i].region]->Map(node, int(next - i), true, scratch);
        for (std::size_t c = i; c < next; ++c) {
            moved[free[c].at] = scratch.vertices.Moved(int(c - i));
            map[free[c].at] = scratch.vertices.Linear(int(c - i));
        }
    }
    displacement.assign(place.size(), Eigen::Vector3d::Zero());
    linear.assign(place.size(), Eigen::Matrix3f::Zero());
    for (std::size_t s = 0, at = 0; s < place.size(); ++s)
        for (int k = 0; k < place[s].count; ++k, ++at) {
            displacement[s] += place[s].weight[k] * (moved[at] - p[s]);
            linear[s] += float(place[s].weight[k]) * map[at];
        }
}

void Carrier::Apply(Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> *linear, const Progress &progress) const {
    if (linear)
        linear->assign(moving.slotTag.size(), Eigen::Matrix3f::Identity());
    Apply([&](std::size_t i) { return Eigen::Vector3d(position.col(Eigen::Index(i))); },
          [&] {
              return [&](std::size_t i, const Eigen::Vector3d &p, const Eigen::Matrix3f &map) {
                  position.col(Eigen::Index(i)) = p;
                  if (linear)
                      (*linear)[i] = map;
              };
          },
          linear != nullptr, progress, [](std::size_t) {});
}

const Eigen::Matrix4d &Carrier::MatrixAt(std::size_t slot) const {
    if (moving.slotTag[slot] == 1 && !moving.loose.partOf.empty() && moving.loose.partOf[slot] >= 0)
        return looseMotion[moving.loose.partOf[slot]];
    return pose.given.motion.at(moving.slotTag[slot] == 1 ? 0 : std::max(0, moving.slotTag[slot]));
}

const Eigen::Matrix4d &Carrier::GivenAt(std::size_t slot) const {
    if (const MovingSurface::Place place = moving.At(slot); place.region)
        return pose.region[place.number].given.motion.at(place.region->held.tag[place.node]);
    return moving.slotTag[slot] == 1 ? pose.given.pointMotion.at(slot)
                                     : pose.given.motion.at(std::max(0, moving.slotTag[slot]));
}

std::vector<Eigen::Matrix4d> Carrier::LooseMotions() const {
    std::vector<Eigen::Matrix4d> result(moving.loose.parts, Eigen::Matrix4d::Identity());
    for (Index part = 0; part < moving.loose.parts; ++part) {
        const std::size_t i = moving.following.leader[part];
        if (i == LooseFollowing::none)
            continue;
        const MovingSurface::Place place = moving.At(i);
        Frame frame = place.region ? place.region->surface.frame : moving.frame;
        if (!place.region) {
            frame.origin = frame.ToWorld(moving.leaderRest[part]);
            frame.scale = 1;
        }
        Eigen::Matrix4d given = Eigen::Matrix4d::Identity();
        if (place.region &&
            place.region->surface.tag[place.node] == 1) { // by the surface's motion there, not the patch's
            Eigen::Matrix3f linear;
            const Eigen::Vector3d at = (*mapped[place.number])(place.node, moving.leaderRest[part], &linear);
            given.topLeftCorner<3, 3>() = linear.cast<double>();
            given.topRightCorner<3, 1>() = at - given.topLeftCorner<3, 3>() * moving.leaderRest[part];
        } else {
            given = GivenAt(i);
        }
        if (given.isIdentity(0))
            continue;
        const Eigen::Vector3d p = frame.ToFrame(moving.leaderRest[part]);
        const Eigen::Affine3d moved = frame.ToFrame(given);
        Eigen::Affine3d there;
        const bool isAffine = place.region && pose.region[place.number].graph.affine;
        there.linear() = isAffine ? Eigen::Matrix3d(moved.linear()) : detail::RotationOf(moved.linear());
        there.translation() = moved * p - there.linear() * p;
        result[part] = frame.FromFrame(there);
        result[part].row(3) << 0, 0, 0, 1;
    }
    return result;
}

// A place's motion is affine in the point that it moves, so four points determine it.
std::vector<Eigen::Affine3d> Carrier::PlaceMotions(unsigned threads) const {
    const std::vector<std::size_t> &place = moving.following.place;
    std::vector<Eigen::Affine3d> result(place.size(), Eigen::Affine3d::Identity());
    if (!pose.Moves())
        return result;
    Eigen::Matrix3Xd corner(3, 4); // the place, and a frame unit from it along each axis
    corner << Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity();
    ParallelForEach(threads, place.size(), 1 << 8, [&](std::size_t i) {
        const MovingSurface::Place there = moving.At(place[i]);
        if (!there.region) {
            result[i] = Eigen::Affine3d(GivenAt(place[i]));
            return;
        }
        const SurfaceGraph &surface = there.region->surface;
        const Eigen::Vector3d own = surface.graph.position.col(there.node).cast<double>();
        Eigen::Vector3d rest[4], moved[4];
        for (int k = 0; k < 4; ++k) {
            rest[k] = surface.frame.FromFrame(Eigen::Vector3d(own + corner.col(k)));
            moved[k] = (*mapped[there.number])(there.node, rest[k]);
        }
        Eigen::Matrix3d from, to;
        const double unit = detail::UnitOf(surface.frame.scale);
        for (int k = 0; k < 3; ++k) {
            from.col(k) = (rest[k + 1] - rest[0]) / unit;
            to.col(k) = (moved[k + 1] - moved[0]) / unit;
        }
        result[i].linear() = to * from.inverse();
        result[i].translation() = moved[0] - result[i].linear() * rest[0];
    });
    return result;
}

Eigen::Vector3d Carrier::Followed(const LooseFollowing::Vertex &vertex, const Eigen::Vector3d &p) const {
    Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
    for (int i = 0; i < LooseFollowing::several; ++i)
        if (vertex.weight[i] > 0)
            displacement += double(vertex.weight[i]) * (placeMotion[std::size_t(vertex.place[i])] * p - p);
    return displacement.isZero(0) ? p : p + displacement;
}

} // namespace vcg::fcd
