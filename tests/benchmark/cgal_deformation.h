// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_CGAL_DEFORMATION_H
#define FCD_CGAL_DEFORMATION_H

#include "benchmark_mesh.h"

#include <vcg_ext/handles/handles.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>

namespace benchmark {

using Positions = Eigen::Matrix3Xd; ///< a column per vertex
using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

/// The same vertices and faces. \throw vcg::fcd::Error when it is not manifold
inline Surface ToCgal(const Mesh &mesh) {
    Surface surface;
    for (const Vertex &v : mesh.vert)
        surface.add_vertex(Kernel::Point_3(v.cP()[0], v.cP()[1], v.cP()[2]));
    const auto vertex = [&](const Face &f, int corner) {
        return Surface::Vertex_index(Surface::size_type(vcg::tri::Index(mesh, f.cV(corner))));
    };
    for (const Face &f : mesh.face)
        if (surface.add_face(vertex(f, 0), vertex(f, 1), vertex(f, 2)) == Surface::null_face())
            throw vcg::fcd::Error("CGAL deforms manifold, oriented meshes only.");
    return surface;
}

struct CgalResult {
    Positions position;
    double seconds = 0;
    std::vector<double> moved; ///< by how much the vertex that moved most did in each iteration, over the diagonal

    int Iterations() const { return int(moved.size()); }
};

/// CGAL's alpha unless told otherwise; its Eq. 2 multiplies it by the area of the whole mesh.
constexpr double cgalAlpha = 0.02;

/// Deforms a mesh by CGAL until done(positions, what moved most in the iteration over the diagonal).
template <CGAL::Deformation_algorithm_tag algorithm, class Done>
CgalResult DeformWithCgal(const Mesh &mesh, const vcg::fcd::Handles &handles, const Done &done,
                          double alpha = cgalAlpha) {
    Surface surface = ToCgal(mesh);
    const vcg::fcd::Stopwatch watch;
    CGAL::Surface_mesh_deformation<Surface, CGAL::Default, CGAL::Default, algorithm> deformation(surface);
    deformation.set_sre_arap_alpha(alpha);
    for (Surface::Vertex_index v : vertices(surface))
        deformation.insert_roi_vertex(v);
    for (Surface::Vertex_index v : vertices(surface))
        if (handles.tag[v] != 1)
            deformation.insert_control_vertex(v);
    if (!deformation.preprocess())
        throw vcg::fcd::Error("CGAL cannot factorise the matrix.");
    for (Surface::Vertex_index v : vertices(surface))
        if (const auto motion = handles.motion.find(handles.tag[v]); motion != handles.motion.end()) {
            const Kernel::Point_3 p = surface.point(v);
            const Eigen::Vector4d q = motion->second.matrix * Eigen::Vector4d(p.x(), p.y(), p.z(), 1);
            deformation.set_target_position(v, Kernel::Point_3(q[0], q[1], q[2]));
        }
    CgalResult result;
    result.position.setConstant(3, mesh.vert.size(), 1e300);
    do {
        deformation.deform(1, 0);
        double moved = 0;
        for (Surface::Vertex_index v : vertices(surface)) {
            const Eigen::Vector3d p(surface.point(v).x(), surface.point(v).y(), surface.point(v).z());
            moved = std::max(moved, (p - result.position.col(v)).norm() / mesh.bbox.Diag());
            result.position.col(v) = p;
        }
        result.moved.push_back(moved);
    } while (result.Iterations() < 100000 && !done(result.position, result.moved.back()));
    result.seconds = watch.Seconds();
    return result;
}

} // namespace benchmark

#endif
