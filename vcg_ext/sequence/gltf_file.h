// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GLTF_FILE_H
#define VCG_FCD_GLTF_FILE_H

#include <vcg_ext/sequence/frame_files.h>

#include <string>
#include <vector>

namespace vcg::fcd {

/// The weights of morph targets (shape keys) over time.
struct MorphAnimation {
    std::vector<std::string> target; ///< names, UTF-8
    std::vector<double> time;        ///< ascending, seconds from 0
    /// Of each target, at each time; 1 is the whole target. Empty: at time i, only target i.
    std::vector<std::vector<double>> weight;
};

/// A surface or a cloud of a file. The file keeps the references.
struct GltfMesh {
    std::string name;             ///< UTF-8
    const PackedSurface &surface; ///< made with \p look
    const SurfaceLook &look;
    const Eigen::Matrix3Xd &position, &normal; ///< 3 x vertex slots, at rest; the normals are not read for a cloud
};

/// Writes surfaces and clouds with morph targets and one animation as binary glTF 2.0 (`.glb`). Each is a node with a
/// mesh. Positions, and normals of surfaces, are in single precision; the node is at the middle of the box at rest, and
/// positions are relative to it. Weights are interpolated linearly between times. Vertices are written as they come.
///
/// Colours are linear, as glTF has them, with 16 bits, so that dark ones stay distinct. A texture is a matt material,
/// seen from both sides, with the image as it is. glTF multiplies textures by vertex colours, so only triangles without
/// an image have these.
class GltfFile {
  public:
    /// \throw BadInput a file of 4 GB or more, or of more than 65536 frames with a shape each, which the format
    /// cannot hold
    GltfFile(WriteAt write, const std::vector<GltfMesh> &meshes, MorphAnimation animation);

    /// Writes the next target of a mesh. \param position, normal 3 x vertex slots, as at rest
    void Add(std::size_t mesh, const Eigen::Matrix3Xd &position, const Eigen::Matrix3Xd &normal);

    /// Completes the file. Call it after all targets of all meshes were added.
    void Finish();

  private:
    static constexpr std::size_t none = std::size_t(-1);

    /// A part of the buffer: numbers or an image.
    struct Part {
        std::uint64_t at, bytes; ///< in the buffer
        std::size_t count;
        int component;
        const char *type;
        int target; ///< bufferView.target of glTF; 0: none
        Eigen::Array3f low, high;
        int numbers; ///< how many of low and high are written; 0: no range
    };

    /// A mesh, and the numbers of its parts; `none` if it has no such part.
    struct Placed {
        explicit Placed(const GltfMesh &mesh) : mesh(mesh), isCloud(mesh.surface.corner.empty()) {}

        GltfMesh mesh;
        bool isCloud;
        Eigen::Vector3d origin;
        std::size_t corners = none, rest = none, places = none, colors = none;
        std::size_t next = none;           ///< part of the shapes that is written next
        std::vector<std::size_t> material; ///< of each PackedSurface::range
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
    const bool isSparse; ///< only weights other than 0 are written, with a part for their indices
    std::vector<Placed> meshes;
    std::vector<const TextureImage *> materials; ///< texture of each; null: none
    std::vector<const TextureImage *> images;
    std::vector<Part> parts;   ///< accessors; indices of sparse weights; images
    std::size_t accessors = 0; ///< number of accessors
    std::size_t jsonBytes = 0; ///< room for the JSON
    std::uint64_t bufferBytes = 0;
};

} // namespace vcg::fcd

#endif
