// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/sequence/gltf_file.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <utility>

namespace vcg::fcd {

namespace {

constexpr std::size_t headBytes = 20; // headers of the file and of the JSON chunk
// Up to so many frames with a shape each, all weights are written, since every reader reads them: 4 MB, nearly all 0.
constexpr std::size_t mostDense = 1024;
// Beyond, only those other than 0 (sparse accessors), with 32-bit indices.
constexpr std::size_t mostFrames = 65536;
constexpr int vertices = 34962, indices = 34963, unsignedShort = 5123, unsignedInt = 5125, real = 5126;

} // namespace

GltfFile::GltfFile(WriteAt write, const std::vector<GltfMesh> &given, MorphAnimation animation)
    : write(std::move(write)), animation(std::move(animation)),
      isSparse(this->animation.weight.empty() && this->animation.time.size() > mostDense) {
    const std::size_t times = this->animation.time.size(), numbers = times * this->animation.target.size();
    AddPart(times, real, "SCALAR", 4 * times, 0, 1);
    if (isSparse && times > mostFrames)
        throw BadInput("A .glb file holds " + std::to_string(mostFrames) + " frames with a shape each, and this one " +
                       "would have " + std::to_string(times) +
                       ". Write fewer frames, a shape for each pose instead of each frame, or a .pc2 or .mdd file.");
    AddPart(numbers, real, "SCALAR", 4 * (isSparse ? times : numbers), 0, 0);
    for (const GltfMesh &mesh : given)
        AddMesh(mesh);
    accessors = parts.size();
    if (isSparse)
        AddPart(times, unsignedInt, "SCALAR", 4 * times, 0, 0); // indices of the weights other than 0
    for (const TextureImage *image : images)
        AddPart(0, 0, "", image->content.size(), 0, 0);
    jsonBytes = (Json(true).size() + 3) / 4 * 4;
    if (headBytes + jsonBytes + 8 + bufferBytes > std::numeric_limits<std::uint32_t>::max())
        throw BadInput("A .glb file holds 4 GB, and this one would take " + std::to_string(bufferBytes / 1000000 + 1) +
                       " MB. Write fewer frames, a shape for each pose instead of each frame, or a .pc2 or .mdd file.");
    WriteTimes();
    for (Placed &each : meshes)
        WriteRest(each);
    for (std::size_t i = 0; i < images.size(); ++i) {
        std::string padded = images[i]->content;
        padded.resize((padded.size() + 3) / 4 * 4, '\0'); // the last image ends the file
        this->write(headBytes + jsonBytes + 8 + parts[accessors + isSparse + i].at, padded.data(), padded.size());
    }
}

void GltfFile::AddPart(std::size_t count, int component, const char *type, std::size_t bytes, int target, int numbers) {
    const Eigen::Array3f most = Eigen::Array3f::Constant(std::numeric_limits<float>::max());
    parts.push_back({bufferBytes, bytes, count, component, type, target, most, -most, numbers});
    bufferBytes += (bytes + 3) / 4 * 4;
}

std::size_t GltfFile::MaterialOf(const TextureImage *image) {
    const auto isSame = [&](const TextureImage *other) {
        return image && other ? image->name == other->name && image->content == other->content : image == other;
    };
    const auto found = std::find_if(materials.begin(), materials.end(), isSame);
    if (found != materials.end())
        return std::size_t(found - materials.begin());
    materials.push_back(image);
    if (image && image->Kind())
        images.push_back(image);
    return materials.size() - 1;
}

void GltfFile::AddMesh(const GltfMesh &mesh) {
    Placed placed(mesh);
    Eigen::AlignedBox3d box;
    for (std::uint32_t slot : mesh.surface.slot)
        box.extend(mesh.position.col(slot));
    placed.origin = box.center();
    const std::size_t n = mesh.surface.slot.size();
    bool isColored = placed.isCloud;
    placed.corners = parts.size();
    for (const PackedSurface::Range &range : mesh.surface.range) {
        AddPart(range.count, unsignedInt, "SCALAR", 4 * range.count, indices, 0);
        const bool isShown = mesh.look.IsShown(range.texture);
        isColored = isColored || !isShown;
        placed.material.push_back(
            MaterialOf(range.texture < 0 ? nullptr : &mesh.look.image[std::size_t(range.texture)]));
    }
    placed.rest = placed.next = parts.size();
    for (std::size_t target = 0; target <= animation.target.size(); ++target) { // the first is the shape at rest
        AddPart(n, real, "VEC3", 12 * n, vertices, 3);
        if (!placed.isCloud)
            AddPart(n, real, "VEC3", 12 * n, vertices, 0);
    }
    if (!placed.isCloud && !mesh.look.place.empty()) {
        placed.places = parts.size();
        AddPart(n, real, "VEC2", 8 * n, vertices, 0);
    }
    if (isColored && (placed.isCloud ? !mesh.look.color.empty() : mesh.look.HasColors())) {
        placed.colors = parts.size();
        AddPart(n, unsignedShort, "VEC4", 8 * n, vertices, 0);
    }
    meshes.push_back(std::move(placed));
}

void GltfFile::WritePart(std::size_t part, const void *data) {
    write(headBytes + jsonBytes + 8 + parts[part].at, static_cast<const char *>(data), std::size_t(parts[part].bytes));
}

void GltfFile::WriteTimes() {
    const std::size_t targets = animation.target.size(), times = animation.time.size();
    std::vector<float> weights;
    for (const std::vector<double> &each : animation.weight)
        for (double weight : each)
            weights.push_back(float(weight));
    if (isSparse) {
        weights.assign(times, 1);
        std::vector<std::uint32_t> at(times);
        for (std::size_t i = 0; i < times; ++i)
            at[i] = std::uint32_t(i * targets + i);
        WritePart(accessors, at.data());
    } else if (weights.empty()) {
        weights.assign(times * targets, 0);
        for (std::size_t i = 0; i < times; ++i)
            weights[i * targets + i] = 1;
    }
    const std::vector<float> seconds = detail::SingleTimes(animation.time, ".glb");
    parts[0].low[0] = seconds.front();
    parts[0].high[0] = seconds.back();
    assert(parts[0].bytes == 4 * seconds.size() && parts[1].bytes == 4 * weights.size());
    WritePart(0, seconds.data());
    WritePart(1, weights.data());
}

void GltfFile::WriteRest(Placed &placed) {
    const GltfMesh &mesh = placed.mesh;
    for (std::size_t i = 0; i < mesh.surface.range.size(); ++i)
        WritePart(placed.corners + i, &mesh.surface.corner[mesh.surface.range[i].first]);
    WriteVectors(placed, [&](std::size_t slot) {
        return Eigen::Vector3f((mesh.position.col(Eigen::Index(slot)) - placed.origin).cast<float>());
    });
    if (!placed.isCloud)
        WriteVectors(placed, [&](std::size_t slot) { // glTF wants length 1, also for vertices without a face
            const Eigen::Vector3f unit = mesh.normal.col(Eigen::Index(slot)).cast<float>();
            return unit.isZero(0) ? Eigen::Vector3f::UnitZ().eval() : unit;
        });
    if (placed.places != none)
        WritePlaces(placed);
    if (placed.colors != none)
        WriteColors(placed);
}

void GltfFile::WritePlaces(const Placed &placed) {
    const GltfMesh &mesh = placed.mesh;
    std::vector<float> all(2 * mesh.surface.slot.size(), 0); // 0 for vertices without a face
    for (std::size_t i = 0; i < mesh.surface.slot.size(); ++i) {
        if (mesh.surface.wedge[i] == SurfaceView::none)
            continue;
        const float *place = &mesh.look.place[2 * std::size_t(mesh.surface.wedge[i])];
        if (std::isfinite(place[0]) && std::isfinite(place[1])) {
            all[2 * i] = place[0];
            all[2 * i + 1] = float(1 - double(place[1])); // glTF counts down from the upper left corner
        }
    }
    WritePart(placed.places, all.data());
}

void GltfFile::WriteColors(const Placed &placed) {
    std::array<std::uint16_t, 256> linear;
    for (std::size_t i = 0; i < linear.size(); ++i) { // IEC 61966-2-1
        const double c = double(i) / 255;
        linear[i] =
            std::uint16_t(std::lround(65535 * (c <= 0.04045 ? c / 12.92 : detail::Power((c + 0.055) / 1.055, 2.4))));
    }
    const PackedSurface &surface = placed.mesh.surface;
    const SurfaceLook &look = placed.mesh.look;
    std::vector<std::uint16_t> all;
    all.reserve(4 * surface.slot.size());
    for (std::size_t i = 0; i < surface.slot.size(); ++i) {
        std::array<std::uint8_t, 4> color{255, 255, 255, 255}; // for vertices without a face
        if (!look.color.empty())
            color = look.color[surface.slot[i]];
        else if (surface.wedge[i] != SurfaceView::none)
            color = look.faceColor[surface.wedge[i] / 3];
        for (std::size_t k = 0; k < 3; ++k)
            all.push_back(linear[color[k]]);
        all.push_back(std::uint16_t(257 * color[3])); // opacity is linear
    }
    WritePart(placed.colors, all.data());
}

void GltfFile::WriteVectors(Placed &placed, const std::function<Eigen::Vector3f(std::size_t slot)> &row) {
    Part &part = parts[placed.next++];
    detail::WriteRows(
        [&](std::uint64_t at, const char *data, std::size_t size) {
            for (std::size_t i = 0; part.numbers > 0 && i < size; i += 12) {
                Eigen::Array3f numbers;
                std::memcpy(numbers.data(), data + i, 12);
                part.low = part.low.min(numbers);
                part.high = part.high.max(numbers);
            }
            write(at, data, size);
        },
        headBytes + jsonBytes + 8 + part.at, placed.mesh.surface, row);
}

void GltfFile::Add(std::size_t mesh, const Eigen::Matrix3Xd &position, const Eigen::Matrix3Xd &normal) {
    Placed &placed = meshes[mesh];
    assert(placed.next < placed.rest + placed.PartsOfShape() * (1 + animation.target.size()));
    const auto change = [](const Eigen::Matrix3Xd &after, const Eigen::Matrix3Xd &before, std::size_t slot) {
        return Eigen::Vector3f((after.col(Eigen::Index(slot)) - before.col(Eigen::Index(slot))).cast<float>());
    };
    WriteVectors(placed, [&](std::size_t slot) { return change(position, placed.mesh.position, slot); });
    if (!placed.isCloud)
        WriteVectors(placed, [&](std::size_t slot) { // 0 without a face, which keeps its normal
            const auto at = Eigen::Index(slot);
            const bool isNone = normal.col(at).isZero(0) || placed.mesh.normal.col(at).isZero(0);
            return isNone ? Eigen::Vector3f::Zero().eval() : change(normal, placed.mesh.normal, slot);
        });
}

void GltfFile::Finish() {
    assert(std::all_of(meshes.begin(), meshes.end(), [&](const Placed &each) {
        return each.next == each.rest + each.PartsOfShape() * (1 + animation.target.size());
    }));
    std::string json = Json(false);
    json.resize(jsonBytes, ' ');
    std::uint32_t head[] = {0x46546C67u, // "glTF"
                            2, std::uint32_t(headBytes + jsonBytes + 8 + bufferBytes), std::uint32_t(jsonBytes),
                            0x4E4F534Au};                                    // "JSON"
    const std::uint32_t chunk[] = {std::uint32_t(bufferBytes), 0x004E4942u}; // "BIN"
    json.insert(0, reinterpret_cast<const char *>(head), sizeof head);
    json.append(reinterpret_cast<const char *>(chunk), sizeof chunk);
    write(0, json.data(), json.size());
}

} // namespace vcg::fcd
