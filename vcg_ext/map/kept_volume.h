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

/// Keeps the volume that each connected part of a free surface encloses: that of its faces with a free node, and of a
/// cap over each loop that bounds these, a fan from the middle of the loop. A cap over a held loop moves rigidly with
/// what holds it, so one motion of all changes no volume.
///
/// It is measured on some nodes of each patch, each of which stands for those around it: a face is one of what its
/// corners stand for. What is closed is closed by these, too.
class KeptVolume {
  public:
    using Face = std::array<Index, 3>;

    /// \param faces with a free node, as nodes of \p surface \param tag of each node, as of HeldNodes
    KeptVolume(const std::vector<Face> &faces, const Graph &surface, const std::vector<Index> &tag,
               const Patches &patches);

    /// How many parts enclose no volume: what has no faces, and where caps over loops with free nodes are more than a
    /// quarter of the area, as over an open sheet.
    Index Open() const { return open; }

    /// Moves the free nodes of \p pose along the surface's normal until each part's volume is that at rest, within a
    /// thousandth: out of what is strained, as an even pressure moves a plate there, so that it fades towards what is
    /// held, and what goes along unstrained is as it was. Where that is too far, or does not help, it goes as far as it
    /// helps.
    /// \param parts of the graph \param mapping of the surface \param motion of each held tag, in the frame
    /// \param fit makes of a pose what is mapped \param pose with rotations \return the share of its volume that a
    /// part is off in the end, the largest
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
        std::vector<Face> face;              // of places
        std::vector<std::vector<Face>> caps; // of each loop: two places, and -1 for its middle
        double area = 0, rest = 0;           // of the faces; its volume
    };

    /// Chooses places. \return that of each node, -1 for none
    std::vector<Index> FindPlaces(const Graph &surface, const std::vector<Index> &tag, const Patches &patches);
    /// Caps a body. \return whether it encloses a volume then
    bool Close(Body &body) const;
    Eigen::MatrixXd Evened(const DeformationGraph &graph, Eigen::MatrixXd column, int times) const;
    /// Which way nodes go for more volume; up to its size. \param push 3 x k, by what each node moves the volume
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
