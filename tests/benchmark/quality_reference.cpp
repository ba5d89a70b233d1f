// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_reference.h"

#include "cgal_deformation.h"

#include <cstdint>
#include <fstream>
#include <limits>
#include <queue>

namespace benchmark {
namespace {

/// Changed when references of the same problem become others.
const std::string version = "2, CGAL " CGAL_VERSION_STR;

/// It has converged when this is left, fraction of the diagonal: a twentieth of our best distances to a reference.
constexpr double enough = 5e-5;

/// What cgalAlpha is in our weights, on equilateral triangles (SolverParam::smoothness).
constexpr double alpha = 0.0058;

/// The rate at which steps shrink is measured over so many of them; one alone may be anything.
constexpr int lookBack = 100;

/// FNV-1a.
class Hash {
  public:
    void Add(const void *data, std::size_t size) {
        for (const unsigned char *byte = static_cast<const unsigned char *>(data); size > 0; --size)
            value = (value ^ *byte++) * 0x100000001b3;
    }
    template <class Number>
    void Add(Number number) {
        Add(&number, sizeof number);
    }
    std::string Text() const {
        char text[17];
        std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
        return text;
    }

  private:
    std::uint64_t value = 0xcbf29ce484222325;
};

std::string HashOf(const Problem &problem) {
    Hash hash;
    hash.Add(version.data(), version.size());
    hash.Add(enough);
    for (const Vertex &v : problem.mesh.vert)
        for (int d = 0; d < 3; ++d)
            hash.Add(v.cP()[d]);
    for (const Face &f : problem.mesh.face)
        for (int corner = 0; corner < 3; ++corner)
            hash.Add(std::uint32_t(vcg::tri::Index(problem.mesh, f.cV(corner))));
    for (int tag : problem.handles.tag)
        hash.Add(tag);
    for (const auto &[tag, motion] : problem.handles.motion) {
        hash.Add(tag);
        hash.Add(motion.matrix.data(), 16 * sizeof(double));
    }
    return hash.Text();
}

/// Per vertex: how far it is from the nearest free one, along edges.
std::vector<double> DistanceToFree(const Problem &problem) {
    const Mesh &mesh = problem.mesh;
    std::vector<std::vector<std::pair<std::size_t, double>>> neighbours(mesh.vert.size());
    for (const Face &f : mesh.face)
        for (int corner = 0; corner < 3; ++corner) {
            const std::size_t a = vcg::tri::Index(mesh, f.cV(corner)),
                              b = vcg::tri::Index(mesh, f.cV((corner + 1) % 3));
            const double length = vcg::Distance(f.cP(corner), f.cP((corner + 1) % 3));
            neighbours[a].emplace_back(b, length);
            neighbours[b].emplace_back(a, length);
        }
    std::vector<double> distance(mesh.vert.size(), std::numeric_limits<double>::infinity());
    using Reached = std::pair<double, std::size_t>;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<Reached>> next;
    for (std::size_t i = 0; i < distance.size(); ++i)
        if (problem.handles.tag[i] == 1) {
            distance[i] = 0;
            next.emplace(0, i);
        }
    while (!next.empty()) {
        const auto [reached, i] = next.top();
        next.pop();
        if (reached > distance[i])
            continue;
        for (const auto &[j, length] : neighbours[i])
            if (reached + length < distance[j]) {
                distance[j] = reached + length;
                next.emplace(distance[j], j);
            }
    }
    return distance;
}

/// The region that CGAL is given: the free surface, and what is held within reach of it. The rotations of held vertices
/// are unknowns, too: they give way to a depth of L, the square root of 0.75 alpha A, over which what they turn by
/// falls to 1/e (ShapeConstants::heldDepth says why). At 5 L less than 1 % of it is left, so that more surface changes
/// nothing; less of it holds the border more loosely than all of it does. Two rings at least: the rotation of a free
/// vertex's held neighbour is fitted to all of that one's edges.
std::vector<bool> NearFree(const Problem &problem, double freeArea) {
    const Mesh &mesh = problem.mesh;
    const double reach = 5 * std::sqrt(0.75 * alpha * freeArea);
    const std::vector<double> distance = DistanceToFree(problem);
    std::vector<bool> near(mesh.vert.size());
    for (std::size_t i = 0; i < near.size(); ++i)
        near[i] = problem.handles.tag[i] == 1;
    for (int ring = 0; ring < 2; ++ring) {
        const std::vector<bool> inner = near;
        for (const Face &f : mesh.face)
            for (int corner = 0; corner < 3; ++corner)
                if (inner[vcg::tri::Index(mesh, f.cV(corner))])
                    for (int other = 0; other < 3; ++other)
                        near[vcg::tri::Index(mesh, f.cV(other))] = true;
    }
    for (std::size_t i = 0; i < near.size(); ++i)
        if (distance[i] <= reach)
            near[i] = true;
    return near;
}

/// Of the faces with a free vertex.
double FreeArea(const Problem &problem) {
    double area = 0;
    for (const Face &f : problem.mesh.face)
        for (int corner = 0; corner < 3; ++corner)
            if (problem.handles.tag[vcg::tri::Index(problem.mesh, f.cV(corner))] == 1) {
                area += vcg::DoubleArea(f) / 2;
                break;
            }
    return area;
}

Reference Compute(const Problem &problem) {
    const Mesh &mesh = problem.mesh;
    const double freeArea = FreeArea(problem);
    const std::vector<bool> near = NearFree(problem, freeArea);
    Problem part;
    std::vector<int> inPart(mesh.vert.size(), -1), inWhole;
    for (std::size_t i = 0; i < near.size(); ++i)
        if (near[i]) {
            inPart[i] = int(inWhole.size());
            inWhole.push_back(int(i));
            vcg::tri::Allocator<Mesh>::AddVertex(part.mesh, mesh.vert[i].cP());
            part.handles.tag.push_back(problem.handles.tag[i]);
        }
    part.handles.motion = problem.handles.motion;
    double area = 0;
    for (const Face &f : mesh.face) {
        int corner[3];
        for (int c = 0; c < 3; ++c)
            corner[c] = inPart[vcg::tri::Index(mesh, f.cV(c))];
        if (std::min({corner[0], corner[1], corner[2]}) < 0)
            continue;
        vcg::tri::Allocator<Mesh>::AddFace(part.mesh, corner[0], corner[1], corner[2]);
        area += vcg::DoubleArea(f) / 2;
    }
    vcg::tri::UpdateBounding<Mesh>::Box(part.mesh);

    std::vector<double> moved;
    double remaining = 0;
    const CgalResult result = DeformWithCgal<CGAL::SRE_ARAP>(
        part.mesh, part.handles,
        [&](const Positions &, double step) {
            moved.push_back(step);
            if (int(moved.size()) <= lookBack + 1) // the first iteration moves the vertices from nowhere
                return false;
            const double rate = std::pow(step / moved[moved.size() - 1 - lookBack], 1.0 / lookBack);
            remaining = rate < 1 ? step * rate / (1 - rate) : 1; // of a geometric series
            return remaining <= enough;
        },
        cgalAlpha * freeArea / area);

    Reference reference;
    reference.position.resize(3, mesh.vert.size());
    for (std::size_t i = 0; i < mesh.vert.size(); ++i) {
        const vcg::Point3d &p = mesh.vert[i].cP();
        const auto motion = problem.handles.motion.find(problem.handles.tag[i]);
        if (inPart[i] >= 0)
            reference.position.col(i) = result.position.col(inPart[i]);
        else if (motion != problem.handles.motion.end())
            reference.position.col(i) =
                (motion->second.matrix * Eigen::Vector4d(p[0], p[1], p[2], 1)).template head<3>();
        else
            reference.position.col(i) = Eigen::Vector3d(p[0], p[1], p[2]);
    }
    reference.iterations = result.Iterations();
    reference.moved = moved.back();
    reference.remaining = remaining;
    reference.seconds = result.seconds;
    return reference;
}

template <class Stream, class Access>
void ForEachField(Stream &stream, Reference &reference, const Access &access) {
    access(stream, reference.iterations);
    access(stream, reference.moved);
    access(stream, reference.remaining);
    access(stream, reference.seconds);
    for (double &coordinate : reference.position.reshaped())
        access(stream, coordinate);
}

} // namespace

Reference MakeReference(const Problem &problem, const std::filesystem::path &cache) {
    const std::filesystem::path path = cache / (HashOf(problem) + ".bin");
    Reference reference;
    reference.position.resize(3, problem.mesh.vert.size());
    if (std::ifstream file(path, std::ios::binary); file) {
        ForEachField(file, reference, [](std::ifstream &from, auto &value) {
            from.read(reinterpret_cast<char *>(&value), sizeof value);
        });
        if (file)
            return reference;
    }
    reference = Compute(problem);
    std::filesystem::create_directories(cache);
    const std::filesystem::path unfinished = path.string() + ".part";
    std::ofstream file(unfinished, std::ios::binary);
    ForEachField(file, reference, [](std::ofstream &to, auto &value) {
        to.write(reinterpret_cast<const char *>(&value), sizeof value);
    });
    file.close();
    if (!file)
        throw vcg::fcd::Error("cannot write '" + unfinished.string() + "'");
    std::filesystem::rename(unfinished, path);
    return reference;
}

} // namespace benchmark
