// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_GRAPH_H
#define VCG_FCD_SURFACE_GRAPH_H

#include <vcg_ext/base/frame.h>
#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/surface/free_region.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <array>
#include <cstdint>
#include <vector>

namespace vcg::fcd {

/// The distance within which vertices on open borders are welded, frame units: ten times what rounding to single
/// precision moves them by, and a hundredth of the distance between vertices of the largest scans.
constexpr double defaultWeldDistance = 1e-6;

/// What was found in the part of a mesh that was read.
struct SurfaceReport {
    Index vertices = 0;         ///< vertices that were read
    Index welded = 0;           ///< vertices that share the node of another one
    Index isolated = 0;         ///< nodes without a neighbour
    Index components = 0;       ///< connected components, isolated nodes included
    Index nonManifoldEdges = 0; ///< edges of more than two faces
    Index repeatedFaces = 0;    ///< faces with the same three nodes as another one; such faces count once
    Index degenerateFaces = 0;  ///< faces with a repeated position
    Index seams = 0;            ///< nodes on open borders that are welded to one of another border
    Index gaps = 0;             ///< nodes on open borders, not welded, within a tenth of an edge of another border
    Index oneSided = 0;         ///< points of a cloud with neighbours along a line alone, as in lines far apart
    Index together = 0;         ///< the number of smallest regions that share a graph (SurfaceRegions::most)
    Index limited = 0;          ///< regions with fewer patches than their estimate asks for, since there are so many
    Index unenclosed = 0;       ///< parts that should keep their volume (DeformerParam::elastic), but enclose none
    bool pointCloud = false;    ///< no faces and no edges: neighbours are the nearest points on all sides
};

/// Whether it is a cloud of scan lines so dense along that many points have neighbours on their own line alone.
inline bool IsInLines(const SurfaceReport &surface) {
    return 100 * std::int64_t(surface.oneSided) > surface.vertices; // evenly random points: far fewer
}

/// The graph of a mesh's vertices, or of its free surface and the held vertices beside it: a node per position, in
/// Morton order, so that near nodes are near in memory.
struct SurfaceGraph {
    Graph graph;                      ///< n nodes, frame units
    Frame frame;                      ///< from mesh units
    std::vector<Index> nodeOf;        ///< node of each vertex slot; -1: deleted, or not read
    std::vector<std::uint32_t> slots; ///< the slots that were read, near ones together; a few may have no node
    std::vector<std::uint32_t> faces; ///< indices of faces with a free vertex; empty without a region
    std::vector<std::array<std::uint32_t, 2>> apart; ///< ends (slots) of edges between vertices held by different tags
    std::vector<Index> tag;      ///< n: 0 fixed or outside, 1 free, from 2 handles; empty without a region
    std::vector<float> nodeArea; ///< n, surface around each node, frame units^2
    double area = 0;             ///< sum of nodeArea
    double averageEdge = 0;      ///< mean length of the graph's edges, frame units
    double reach = 0;            ///< as in Region
    SurfaceReport report;        ///< components is left 0

    bool IsHeld(Index u) const { return !tag.empty() && tag[u] != 1; }
};

/// Reads the graph of a mesh, or of a region of it. What is not in the region changes no bit of the result.
///
/// Vertices at one position (floats of the frame) share a node, which is held if one of them is. So do vertices on open
/// borders a hair apart. Neighbours share a face or an edge element; faces with the same three nodes count once. In a
/// cloud, neighbours are the 12 nearest points or, if these lie along a line, chosen from more around
/// (CloudNeighbourhood); there, any points a hair apart share a node.
///
/// \param region nullptr: all of the mesh \param tag one per vertex slot, read if there is a region
/// \param metric as in Frame \param weldDistance a hair, frame units, [0, 1e-3]
/// \throw BadInput no vertices, a coordinate that is not finite, or too many edges \throw Cancelled
SurfaceGraph BuildSurfaceGraph(const SurfaceView &mesh, const Region *region, const std::vector<int> &tag,
                               const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(),
                               const Progress &progress = {}, double weldDistance = defaultWeldDistance);

/// All of the mesh.
SurfaceGraph BuildSurfaceGraph(const SurfaceView &mesh, const Progress &progress = {});

} // namespace vcg::fcd

#endif
