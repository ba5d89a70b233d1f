// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_KEPT_VOLUME_H
#define VCG_FCD_KEPT_VOLUME_H

#include <vcg_ext/map/graph_mapping.h>
#include <vcg_ext/solve/graph_parts.h>
#include <vcg_ext/solve/graph_pose.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <map>
#include <vector>

namespace vcg::fcd {

/// Keeps the volume that each connected part of a free surface encloses. The part is its faces with a free node, closed
/// by a cap over each boundary loop: a fan from the loop's middle. A cap over a held loop moves rigidly with it, so one
/// motion of all changes no volume.
///
/// The volume is measured on some nodes of each patch (places). Each stands for the nodes around it. Faces between
/// these are faces between places, and a closed surface stays closed.
class KeptVolume {
  public:
    using Face = std::array<Index, 3>;

    /// \param faces with a free node, as nodes of \p surface \param tag of each node, as in HeldNodes
    KeptVolume(const std::vector<Face> &faces, const Graph &surface, const std::vector<Index> &tag,
               const Patches &patches);

    /// Number of parts that enclose no volume: those without faces, and those where caps over loops with free nodes
    /// have more than a quarter of the area, as over an open sheet.
    Index Open() const { return open; }

    /// Moves the free nodes of \p pose along the surface's normals until each part has its volume at rest, within a
    /// thousandth. Strained nodes move most, unstrained ones stay, and the move fades towards held ones, like that of a
    /// plate under even pressure. It stops at limits, and after three steps keeps the best one.
    /// \param parts of the graph \param mapping of the surface \param motion of each held tag, frame units \param fit
    /// turns a pose into the one that is mapped \param pose in, out; with rotations \return the largest error of a
    /// part's volume that is left, over that volume
    double Keep(const DeformationGraph &graph, const PartsDeformer &parts, const GraphMapping &mapping,
                const std::map<Index, Eigen::Affine3d> &motion, const std::function<void(GraphPose &)> &fit,
                GraphPose &pose) const;

  private:
    struct Place {
        Index node, patch, tag;
        Eigen::Vector3d rest;
    };
    /// A connected part.
    struct Body {
        std::vector<Face> face;              // numbers of places
        std::vector<std::vector<Face>> caps; // of each loop: two places, and -1 for its middle
        double area = 0, rest = 0;           // of the faces; volume at rest, < 0: inside out
    };

    /// Chooses places. \return the place of each node, -1 for none
    std::vector<Index> FindPlaces(const Graph &surface, const std::vector<Index> &tag, const Patches &patches);
    /// Caps a body. \return whether it is closed enough for a volume
    bool Close(Body &body) const;
    Eigen::MatrixXd Evened(const DeformationGraph &graph, Eigen::MatrixXd column, int times) const;
    /// The direction in which nodes move for more volume, 3 x k, of any scale. \param push 3 x k, gradient of the
    /// volume
    Eigen::Matrix3Xd Bulge(const DeformationGraph &graph, const PartsDeformer &parts, const GraphPose &pose,
                           const Eigen::Matrix3Xd &push) const;
    /// \param at 3 x places, deformed
    void Map(const GraphMapping::Posed &mapped, Eigen::Matrix3Xd &at) const;

    std::vector<Place> place; // those of a patch one after the other
    std::vector<Body> bodies;
    std::vector<Index> bodyOf; // of each patch, -1 for none
    Index open = 0;
};

} // namespace vcg::fcd

#endif
