// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/map/carrier.h>

namespace vcg {
namespace fcd {

Carrier::Carrier(const MovingSurface &surface, const SurfacePose &pose, unsigned threads)
    : moving(surface), pose(pose), mapped(moving.mapping->At(pose.graph, pose.motion, moving.surface.frame, threads)),
      looseMotion(LooseMotions()), placeMotion(PlaceMotions(threads)), moves(pose.Moves()) {}

Eigen::Vector3d Carrier::operator()(std::size_t slot, const Eigen::Vector3d &p, Eigen::Matrix3f &linear) const {
    const Index node = moving.surface.nodeOf[slot];
    linear.setIdentity();
    if (!moves || moving.slotTag[slot] == noVertex)
        return p;
    if (node >= 0 && moving.held.tag[node] == 1) {
        if (moving.weights == MappingWeights::Surface && pose.graph.rests[moving.patches.patchOf[node]])
            return p;
        return mapped(node, p, &linear);
    }
    if (node >= 0 && moving.held.IsFixed(moving.held.tag[node]))
        return p;
    const auto told = pose.given.pointMotion.find(slot);
    const auto &follows = moving.following.vertex;
    const auto follower =
        std::lower_bound(follows.begin(), follows.end(), slot,
                         [](const LooseFollowing::Vertex &vertex, std::size_t s) { return vertex.slot < s; });
    const Eigen::Matrix4d &matrix = node >= 0 ? pose.given.motion.at(moving.held.tag[node]) : MatrixAt(slot);
    linear = matrix.topLeftCorner<3, 3>().cast<float>();
    if (told != pose.given.pointMotion.end())
        return p + told->second.topRightCorner<3, 1>();
    if (follower != follows.end() && follower->slot == slot)
        return Followed(*follower, p);
    return matrix.isIdentity(0) ? p : Eigen::Vector3d((matrix * p.homogeneous()).head<3>());
}

Eigen::Vector3d Carrier::Displacement(const SurfacePlace &place, const Eigen::Vector3d &p,
                                      Eigen::Matrix3f &linear) const {
    Eigen::Vector3d way = Eigen::Vector3d::Zero();
    Eigen::Matrix3f each;
    linear.setZero();
    for (int k = 0; k < place.count; ++k) {
        way += place.weight[k] * ((*this)(std::size_t(place.slot[k]), p, each) - p);
        linear += float(place.weight[k]) * each;
    }
    return way;
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
    const Index node = moving.surface.nodeOf[slot];
    if (node >= 0)
        return pose.given.motion.at(moving.held.tag[node]);
    return moving.slotTag[slot] == 1 ? pose.given.pointMotion.at(slot)
                                     : pose.given.motion.at(std::max(0, moving.slotTag[slot]));
}

std::vector<Eigen::Matrix4d> Carrier::LooseMotions() const {
    std::vector<Eigen::Matrix4d> result(moving.loose.parts, Eigen::Matrix4d::Identity());
    for (Index part = 0; part < moving.loose.parts; ++part) {
        const std::size_t i = moving.following.leader[part];
        if (i == LooseFollowing::none)
            continue;
        const Index node = moving.surface.nodeOf[i];
        Eigen::Matrix4d given = Eigen::Matrix4d::Identity();
        if (node >= 0 && moving.surface.tag[node] == 1) { // as the surface there turns, not the patch it is in
            Eigen::Matrix3f linear;
            const Eigen::Vector3d at = mapped(node, moving.leaderRest[part], &linear);
            given.topLeftCorner<3, 3>() = linear.cast<double>();
            given.topRightCorner<3, 1>() = at - given.topLeftCorner<3, 3>() * moving.leaderRest[part];
        } else {
            given = GivenAt(i);
        }
        if (given.isIdentity(0))
            continue;
        const Eigen::Vector3d p = moving.surface.frame.ToFrame(moving.leaderRest[part]);
        const Eigen::Affine3d moved = moving.surface.frame.ToFrame(given);
        Eigen::Affine3d there;
        there.linear() = detail::RotationOf(moved.linear());
        there.translation() = moved * p - there.linear() * p;
        result[part] = moving.surface.frame.FromFrame(there);
        result[part].row(3) << 0, 0, 0, 1;
    }
    return result;
}

/// Where a place of the surface leads is affine in what lies beside it: four points tell it.
std::vector<Eigen::Affine3d> Carrier::PlaceMotions(unsigned threads) const {
    const std::vector<std::size_t> &place = moving.following.place;
    std::vector<Eigen::Affine3d> result(place.size(), Eigen::Affine3d::Identity());
    if (!pose.Moves())
        return result;
    Eigen::Matrix3Xd corner(3, 4); // the place, and as far from it as the frame is wide
    corner << Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity();
    ParallelFor(threads, place.size(), 1 << 8, [&](std::size_t first, std::size_t last) {
        GraphMapping::Posed::Scratch scratch;
        detail::Vertices &at = scratch.vertices;
        for (std::size_t i = first; i < last; ++i) {
            const Index node = moving.surface.nodeOf[place[i]];
            if (node < 0) {
                result[i] = Eigen::Affine3d(GivenAt(place[i]));
                continue;
            }
            const Eigen::Vector3d own = moving.surface.graph.position.col(node).cast<double>();
            for (int k = 0; k < 4; ++k)
                at.SetRest(k, moving.surface.frame.FromFrame(Eigen::Vector3d(own + corner.col(k))));
            const Index same[] = {node, node, node, node};
            if (moving.held.tag[node] == 1)
                mapped.Map(same, 4, false, scratch);
            else
                for (int k = 0; k < 4; ++k)
                    at.SetMoved(k, mapped(node, at.Rest(k)));
            Eigen::Matrix3d from, to;
            for (int k = 0; k < 3; ++k) {
                from.col(k) = at.Rest(k + 1) - at.Rest(0);
                to.col(k) = at.Moved(k + 1) - at.Moved(0);
            }
            result[i].linear() = to * from.inverse();
            result[i].translation() = at.Moved(0) - result[i].linear() * at.Rest(0);
        }
    });
    return result;
}

Eigen::Vector3d Carrier::Followed(const LooseFollowing::Vertex &vertex, const Eigen::Vector3d &p) const {
    Eigen::Vector3d way = Eigen::Vector3d::Zero();
    for (int i = 0; i < LooseFollowing::several; ++i)
        if (vertex.weight[i] > 0)
            way += double(vertex.weight[i]) * (placeMotion[std::size_t(vertex.place[i])] * p - p);
    return way.isZero(0) ? p : p + way;
}

} // namespace fcd
} // namespace vcg
