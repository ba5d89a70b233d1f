// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_reach.h"

#include <vcg_ext/surface/read_surface.h>
#include <vcg_ext/surface/surface_reach.h>

void BendReach::read(const MeshModel &layer, const Eigen::Matrix3d &metric) {
    surface = std::make_unique<vcg::fcd::SurfaceGraph>(
        vcg::fcd::BuildSurfaceGraph(vcg::tri::ReadSurface(layer.cm).View(), nullptr, {}, metric));
}

void BendReach::clear() {
    surface.reset();
    from.clear();
}

const std::vector<std::size_t> &BendReach::of(const std::vector<std::size_t> &vertices, double radius) {
    if (knows(vertices, radius))
        return reached;
    reached.clear();
    std::vector<vcg::fcd::Index> seeds;
    for (const std::size_t slot : vertices)
        if (surface->nodeOf[slot] >= 0)
            seeds.push_back(surface->nodeOf[slot]);
    if (!seeds.empty()) {
        std::vector<char> isIn(std::size_t(surface->graph.Size()), 0);
        for (vcg::fcd::Index node : vcg::fcd::NodesWithin(surface->graph, seeds, radius / surface->frame.scale))
            isIn[std::size_t(node)] = 1;
        for (std::size_t i = 0; i < surface->nodeOf.size(); ++i)
            if (surface->nodeOf[i] >= 0 && isIn[std::size_t(surface->nodeOf[i])])
                reached.push_back(i);
    }
    from = vertices;
    within = radius;
    return reached;
}
