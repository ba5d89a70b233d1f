// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MAPPING_KERNEL_H
#define VCG_FCD_MAPPING_KERNEL_H

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace vcg::fcd {

namespace detail {

constexpr int lanes = 16; ///< vertices at a time
constexpr int terms = 16; ///< numbers that are blended

/// Weight of a node: u^3 at u = 1 - (distance / radius)^2. Like Eq. 8 of the paper it falls from 1 at the node to 0 at
/// its reach, but without the cone's tip that (1 - r)^2 has at the node and the jump in curvature at its end: both show
/// as ripples.
struct Ball {
    float center[3];
    float inverse; ///< 1 / radius^2
    int node;      ///< at the centre
};

/// A linear combination for each of some vertices: of terms of candidates, by weights that fall with the distance.
struct Blending {
    const Ball *ball;           ///< n, of the candidates
    const float (*term)[terms]; ///< n
    std::size_t n;              ///< candidates
    std::size_t whole;          ///< the first so many keep all of their weight, the others a share, ...
    const Ball *shareBall;      ///< m: ... which is known at their centres
    const float *share;         ///< (n - whole) x m
    std::size_t m;
    alignas(64) float x[3][lanes]; ///< the vertices
    /// Rows for n, out: the weights of candidates active[0], ... active[used - 1], ascending. Those that are left out
    /// weigh nothing at any of the vertices.
    float (*weight)[lanes];
    std::uint32_t *active;
    std::size_t used;
    float (*shareWeight)[lanes];         ///< m, scratch
    std::uint32_t *shareActive;          ///< m, scratch
    alignas(64) float sum[terms][lanes]; ///< out: the terms times the weights
};

/// How a patch's node moves: x by shift + turn (x - center).
struct PatchMotion {
    double center[3], shift[3], turn[9]; ///< mesh units; columns of the linear map minus the identity
};

/// From mesh units to those of the blended terms, the frame's, and back.
struct Space {
    double toFrame[9], fromFrame[9];    ///< of ways; columns
    bool isSame;                        ///< directions are the same in both, ...
    double metric[9], inverseMetric[9]; ///< ... or turned and stretched so
};

/// Some vertices of one patch that are mapped together.
struct Vertices {
    alignas(64) double rest[3][lanes];  ///< mesh units
    alignas(64) double moved[3][lanes]; ///< out
    alignas(64) float linear[9][lanes]; ///< out: how the surface turns and stretches around each; columns
    alignas(64) float normal[3][lanes]; ///< in: at rest; out: turned
    float turns[lanes];                 ///< out: 0 where the normal keeps its bits

    Eigen::Vector3d Rest(int l) const { return {rest[0][l], rest[1][l], rest[2][l]}; }
    Eigen::Vector3d Moved(int l) const { return {moved[0][l], moved[1][l], moved[2][l]}; }
    Eigen::Matrix3f Linear(int l) const {
        Eigen::Matrix3f map;
        for (int d = 0; d < 9; ++d)
            map.data()[d] = linear[d][l];
        return map;
    }
    Eigen::Vector3d Normal(int l) const { return {normal[0][l], normal[1][l], normal[2][l]}; }
    void SetNormal(int l, const Eigen::Vector3d &n) {
        for (int d = 0; d < 3; ++d)
            normal[d][l] = float(n[d]);
    }
    void SetRest(int l, const Eigen::Vector3d &p) {
        for (int d = 0; d < 3; ++d)
            rest[d][l] = p[d];
    }
    void SetMoved(int l, const Eigen::Vector3d &p) {
        for (int d = 0; d < 3; ++d)
            moved[d][l] = p[d];
    }
    void SetLinear(int l, const Eigen::Matrix3f &map) {
        for (int d = 0; d < 9; ++d)
            linear[d][l] = map.data()[d];
    }
    /// Lets lanes from \p count on be like the first.
    void Fill(int count) {
        for (int l = count; l < lanes; ++l)
            SetRest(l, Rest(0));
    }
    /// Lets all stay where they are.
    void Stay() {
        std::memcpy(moved, rest, sizeof moved);
        for (int d = 0; d < 9; ++d)
            for (float &entry : linear[d])
                entry = d % 4 == 0 ? 1 : 0;
    }
};

/// Weighs the candidates at each vertex, and sums up their terms.
void Blend(Blending &b);

/// Sums up other terms of the same candidates by the same weights. \param sum terms x lanes
void SumTerms(const Blending &b, const float (*term)[terms], float (*sum)[lanes]);

/// Moves vertices as the blend of their patch's candidates does.
/// \param linear whether to give their linear maps, too
void Carry(const Blending &b, const PatchMotion &own, const Space &space, bool linear, Vertices &v);

/// Turns their normals with the surface; each keeps its length.
void TurnNormals(Vertices &v);

} // namespace detail
} // namespace vcg::fcd

#endif
