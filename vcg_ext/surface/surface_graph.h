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

/// Vertices on open borders at most so far apart are one, frame units: what rounding to single precision moves by (1e-7
/// of the coordinates), some times over, and a hundredth of what lies between the vertices of the largest scans.
constexpr double defaultWeldDistance = 1e-6;

/// What was met in the part of a mesh that was read.
struct SurfaceReport {
    Index vertices = 0;         ///< live vertices
    Index welded = 0;           ///< vertices that share the position of another one and hence its node
    Index isolated = 0;         ///< nodes without a neighbour
    Index components = 0;       ///< connected components, isolated nodes included
    Index nonManifoldEdges = 0; ///< edges of more than two faces, those at the same nodes counted once
    Index repeatedFaces = 0;    ///< faces at the same three nodes as another one; they count once
    Index degenerateFaces = 0;  ///< faces with a repeated position
    Index seams = 0;            ///< nodes on open borders that are joined with one of another, a hair apart
    Index gaps = 0;             ///< nodes on open borders nearer to another than a tenth of their edges, not joined
    Index oneSided = 0;         ///< points of a cloud that see others along a line alone, as in lines far apart
    Index together = 0;         ///< regions, the smallest, that share a graph, as there are so many (SurfaceRegions)
    Index limited = 0;          ///< regions that have fewer patches than they are worth, as there are so many
    Index unenclosed = 0;       ///< parts that were to keep their volume (DeformerParam::elastic) and enclose none
    bool pointCloud = false;    ///< no faces, no edges: neighbours are the nearest points on all sides
};

/// Whether what was read is a cloud of lines so dense that many points do not see the next one.
inline bool IsInLines(const SurfaceReport &surface) {
    return 100 * std::int64_t(surface.oneSided) > surface.vertices; // by chance, far fewer
}

/// The connectivity of a mesh, or of its free part and the held vertices beside that: a node per position, in Morton
/// order, so that what is near on the surface is near in memory.
struct SurfaceGraph {
    Graph graph;                      ///< n nodes, positions in the frame
    Frame frame;                      ///< from mesh units
    std::vector<Index> nodeOf;        ///< node of each vertex slot, -1 for one that is deleted or not part of it
    std::vector<std::uint32_t> slots; ///< the slots that have a node (some may have lost it), in an order in which
                                      ///< neighbours are close
    std::vector<std::uint32_t> faces; ///< of the mesh: those with a free vertex; empty where no tags were given
    std::vector<std::array<std::uint32_t, 2>> apart; ///< slots at the ends of edges that join vertices held otherwise
    std::vector<Index> tag;      ///< n: 0 fixed or outside, 1 free, from 2 handles; empty where no tags were given
    std::vector<float> nodeArea; ///< n, of the surface around each node, frame units^2
    double area = 0;             ///< sum of nodeArea
    double averageEdge = 0;      ///< mean length of the graph's edges, frame units
    double reach = 0;            ///< as of Region
    SurfaceReport report;        ///< components is left 0

    bool IsHeld(Index u) const { return !tag.empty() && tag[u] != 1; }
};

/// Reads the connectivity of a mesh, or of a region of it. Neighbours are the vertices that share a face or an edge
/// element; in a mesh that has neither, the 12 nearest points, or, where these lie on a line, those around that are
/// nearest to the line on both sides, too; points a hair apart are one there. Vertices at the same position (float
/// precision of the frame) share a node, and so do those on open borders a hair apart, so that seams hold together; it
/// is held where one of them is. Faces at the same three nodes are one. Deleted elements are skipped; the mesh is only
/// read. What is not in the region changes no bit of the result.
///
/// \param region nullptr for all of the mesh \param tag one per vertex slot, read where there is a region
/// \param metric as of Frame \param weldDistance a hair, frame units, [0, 1e-3]
/// \throw BadInput no vertices, or a coordinate that is not finite
SurfaceGraph BuildSurfaceGraph(const SurfaceView &mesh, const Region *region, const std::vector<int> &tag,
                               const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(),
                               const Progress &progress = {}, double weldDistance = defaultWeldDistance);

/// All of the mesh.
SurfaceGraph BuildSurfaceGraph(const SurfaceView &mesh, const Progress &progress = {});

} // namespace vcg::fcd

#endif
