// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GLTF_FILE_H
#define VCG_FCD_GLTF_FILE_H

#include <vcg_ext/sequence/frame_files.h>

#include <string>
#include <vector>

namespace vcg::fcd {

/// How the shapes of a mesh (morph targets, shape keys) are mixed in the course of time.
struct MorphAnimation {
    std::vector<std::string> target; ///< names, UTF-8
    std::vector<double> time;        ///< ascending, seconds from 0
    /// At each time, of each target; 1 is all of it. Empty: each time has one target alone, in their order.
    std::vector<std::vector<double>> weight;
};

/// A surface or a cloud with morph targets and their animation, as binary glTF 2.0 (`.glb`): positions and, of a
/// surface, normals in single precision, from the middle of the box at rest, which the node is moved to. Between its
/// times the weights are interpolated linearly. Vertices go straight to the file.
class GltfFile {
  public:
    /// \param position, normal 3 x vertex slots, at rest; the normals are not read for a cloud
    /// \param color which the format holds linear, in 16 bits, so that dark ones stay apart
    /// \throw BadInput a file of 4 GB or more, or of more than 65536 frames with a shape each, which the format
    /// cannot hold
    GltfFile(WriteAt write, std::string name, const PackedSurface &surface, const Eigen::Matrix3Xd &position,
             const Eigen::Matrix3Xd &normal, MorphAnimation animation, const VertexColors &color = {});

    /// The next target. \param position, normal as those at rest
    void Add(const Eigen::Matrix3Xd &position, const Eigen::Matrix3Xd &normal);

    /// To be called when all targets were added: before, there is no file yet.
    void Finish();

  private:
    /// Numbers of the buffer, in the order of the buffer's parts.
    struct Part {
        std::uint64_t at = 0, bytes = 0; ///< in the buffer
        std::size_t count = 0;
        int component = 5126; ///< float
        const char *type = "VEC3";
        int target = 0; ///< of the graphics card
        Eigen::Array3f low, high;
        int numbers = 0; ///< of low and high; 0: not told
    };

    void AddPart(std::size_t count, int component, const char *type, std::size_t bytes, int target, int numbers);
    std::string Json(bool longest) const;
    void WriteColors(const VertexColors &color);
    void WriteVectors(const std::function<Eigen::Vector3f(std::size_t slot)> &row);

    const WriteAt write;
    const std::string name;
    const PackedSurface &surface;
    const Eigen::Matrix3Xd &rest, &restNormal;
    const MorphAnimation animation;
    const bool isCloud;
    const bool hasColors; ///< behind the shapes
    const bool isSparse;  ///< only weights that are not 0 are written, and the last part tells where they are
    Eigen::Vector3d origin;
    std::vector<Part> parts;
    std::size_t next = 0;      ///< part to write
    std::size_t jsonBytes = 0; ///< there is room for
    std::uint64_t bufferBytes = 0;
};

} // namespace vcg::fcd

#endif
