// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GLTF_FILE_H
#define VCG_FCD_GLTF_FILE_H

#include <vcg_ext/sequence/frame_files.h>

#include <string>
#include <vector>

namespace vcg::fcd {

/// How the shapes of meshes (morph targets, shape keys) are mixed in the course of time.
struct MorphAnimation {
    std::vector<std::string> target; ///< names, UTF-8
    std::vector<double> time;        ///< ascending, seconds from 0
    /// At each time, of each target; 1 is all of it. Empty: each time has one target alone, in their order.
    std::vector<std::vector<double>> weight;
};

/// A surface or a cloud of a file, which refers to all of this.
struct GltfMesh {
    std::string name;             ///< UTF-8
    const PackedSurface &surface; ///< made with \p look
    const SurfaceLook &look;
    const Eigen::Matrix3Xd &position, &normal; ///< 3 x vertex slots, at rest; the normals are not read for a cloud
};

/// Surfaces and clouds with morph targets and one animation of all, as binary glTF 2.0 (`.glb`): each a node with a
/// mesh, positions and, of a surface, normals in single precision, from the middle of the box at rest, which the node
/// is moved to. Between its times the weights are interpolated linearly. Vertices go straight to the file.
///
/// Colours are linear in the format, in 16 bits, so that dark ones stay apart. A texture is a material, matt and seen
/// from both sides, with the image as it is; the format would multiply it by the colours of vertices, which are
/// therefore those of triangles without an image alone.
class GltfFile {
  public:
    /// \throw BadInput a file of 4 GB or more, or of more than 65536 frames with a shape each, which the format
    /// cannot hold
    GltfFile(WriteAt write, const std::vector<GltfMesh> &meshes, MorphAnimation animation);

    /// The next target of a mesh. \param position, normal as those at rest
    void Add(std::size_t mesh, const Eigen::Matrix3Xd &position, const Eigen::Matrix3Xd &normal);

    /// To be called when all targets of all meshes were added: before, there is no file yet.
    void Finish();

  private:
    static constexpr std::size_t none = std::size_t(-1);

    /// A part of the buffer, with numbers or an image.
    struct Part {
        std::uint64_t at, bytes; ///< in the buffer
        std::size_t count;
        int component;
        const char *type;
        int target; ///< of the graphics card
        Eigen::Array3f low, high;
        int numbers; ///< of low and high; 0: not told
    };

    /// A mesh, and the numbers of its parts; none: there is no such.
    struct Placed {
        explicit Placed(const GltfMesh &mesh) : mesh(mesh), isCloud(mesh.surface.corner.empty()) {}

        GltfMesh mesh;
        bool isCloud;
        Eigen::Vector3d origin;
        std::size_t corners = none, rest = none, places = none, colors = none;
        std::size_t next = none;           ///< part of shapes to write
        std::vector<std::size_t> material; ///< of each range of triangles
        std::size_t PartsOfShape() const { return isCloud ? 1 : 2; }
    };

    void AddPart(std::size_t count, int component, const char *type, std::size_t bytes, int target, int numbers);
    void AddMesh(const GltfMesh &mesh);
    std::size_t MaterialOf(const TextureImage *image);
    std::string Json(bool longest) const;
    std::string MeshJson(const Placed &placed) const;
    std::string MaterialsJson() const;
    void WritePart(std::size_t part, const void *data);
    void WriteTimes();
    void WriteRest(Placed &placed);
    void WriteColors(const Placed &placed);
    void WritePlaces(const Placed &placed);
    void WriteVectors(Placed &placed, const std::function<Eigen::Vector3f(std::size_t slot)> &row);

    const WriteAt write;
    const MorphAnimation animation;
    const bool isSparse; ///< only weights that are not 0 are written, and a part tells where they are
    std::vector<Placed> meshes;
    std::vector<const TextureImage *> materials; ///< null: without a texture
    std::vector<const TextureImage *> images;
    std::vector<Part> parts;   ///< numbers, each an accessor; where weights are that are not 0; images
    std::size_t accessors = 0; ///< how many of them are
    std::size_t jsonBytes = 0; ///< there is room for
    std::uint64_t bufferBytes = 0;
};

} // namespace vcg::fcd

#endif
