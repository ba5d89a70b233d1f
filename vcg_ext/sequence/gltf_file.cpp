// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/words.h>
#include <vcg_ext/sequence/gltf_file.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>
#include <utility>

namespace vcg::fcd {

namespace {

constexpr std::size_t headBytes = 20; // of the file and of the chunk with the JSON
// Frames with a shape each whose weights, 0 but for one a frame, are all written, as every reader reads them: 4 MB.
constexpr std::size_t mostDense = 1024;
// Of more, only those that are not 0 (sparse accessors), at numbers of 32 bits.
constexpr std::size_t mostFrames = 65536;

std::string Quoted(const std::string &text) {
    std::string quoted = "\"";
    for (char c : text) {
        if (static_cast<unsigned char>(c) < ' ') {
            quoted += "\\u00";
            quoted += "0123456789abcdef"[c >> 4];
            quoted += "0123456789abcdef"[c & 15];
        } else {
            quoted += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
        }
    }
    return quoted + "\"";
}

/// "[a,b,...]"
template <class Item>
std::string List(std::size_t count, const Item &item) {
    std::string list = "[";
    for (std::size_t i = 0; i < count; ++i)
        list += (i > 0 ? "," : "") + item(i);
    return list + "]";
}

} // namespace

GltfFile::GltfFile(WriteAt write, std::string name, const PackedSurface &surface, const Eigen::Matrix3Xd &position,
                   const Eigen::Matrix3Xd &normal, MorphAnimation animation, const VertexColors &color)
    : write(std::move(write)), name(std::move(name)), surface(surface), rest(position), restNormal(normal),
      animation(std::move(animation)), isCloud(surface.corner.empty()), hasColors(!color.empty()),
      isSparse(this->animation.weight.empty() && this->animation.time.size() > mostDense) {
    Eigen::AlignedBox3d box;
    for (std::uint32_t slot : surface.slot)
        box.extend(position.col(slot));
    origin = box.center();
    const std::size_t n = surface.slot.size(), targets = this->animation.target.size(),
                      times = this->animation.time.size(), numbers = times * targets;
    const int vertices = 34962, indices = 34963, unsignedShort = 5123, unsignedInt = 5125, real = 5126;
    AddPart(times, real, "SCALAR", 4 * times, 0, 1);
    if (isSparse && times > mostFrames)
        throw BadInput("A .glb file holds " + std::to_string(mostFrames) + " frames with a shape each, and this one " +
                       "would have " + std::to_string(times) +
                       ". Write fewer frames, a shape for each pose instead of each frame, or a .pc2 file.");
    AddPart(numbers, real, "SCALAR", 4 * (isSparse ? times : numbers), 0, 0);
    if (!isCloud)
        AddPart(surface.corner.size(), unsignedInt, "SCALAR", 4 * surface.corner.size(), indices, 0);
    for (std::size_t target = 0; target <= targets; ++target) { // the first is the shape at rest
        AddPart(n, real, "VEC3", 12 * n, vertices, 3);
        if (!isCloud)
            AddPart(n, real, "VEC3", 12 * n, vertices, 0);
    }
    if (hasColors)
        AddPart(n, unsignedShort, "VEC4", 8 * n, vertices, 0);
    if (isSparse)
        AddPart(times, unsignedInt, "SCALAR", 4 * times, 0, 0); // where the weights are that are not 0
    jsonBytes = (Json(true).size() + 3) / 4 * 4;
    if (headBytes + jsonBytes + 8 + bufferBytes > std::numeric_limits<std::uint32_t>::max())
        throw BadInput("A .glb file holds 4 GB, and this one would take " + std::to_string(bufferBytes / 1000000 + 1) +
                       " MB. Write fewer frames, a shape for each pose instead of each frame, or a .pc2 file.");

    std::vector<float> weights;
    for (const std::vector<double> &each : this->animation.weight)
        for (double weight : each)
            weights.push_back(float(weight));
    if (isSparse) {
        weights.assign(times, 1);
    } else if (weights.empty()) {
        weights.assign(numbers, 0);
        for (std::size_t i = 0; i < times; ++i)
            weights[i * targets + i] = 1;
    }
    std::vector<float> seconds(times);
    std::transform(this->animation.time.begin(), this->animation.time.end(), seconds.begin(),
                   [](double time) { return float(time); });
    parts[0].low[0] = seconds.front();
    parts[0].high[0] = seconds.back();
    const auto writePart = [&](const Part &part, const auto &values) {
        assert(part.bytes == 4 * values.size());
        this->write(headBytes + jsonBytes + 8 + part.at, reinterpret_cast<const char *>(values.data()), part.bytes);
    };
    const auto writeNext = [&](const auto &values) { writePart(parts[next++], values); };
    if (isSparse) {
        std::vector<std::uint32_t> at(times);
        for (std::size_t i = 0; i < times; ++i)
            at[i] = std::uint32_t(i * targets + i);
        writePart(parts.back(), at);
    }
    if (hasColors)
        WriteColors(color);
    writeNext(seconds);
    writeNext(weights);
    if (!isCloud)
        writeNext(surface.corner);
    const auto at = [](std::size_t slot) { return Eigen::Index(slot); };
    WriteVectors([&](std::size_t slot) { return Eigen::Vector3f((position.col(at(slot)) - origin).cast<float>()); });
    if (!isCloud)
        WriteVectors([&](std::size_t slot) { // of length 1, also without a face
            const Eigen::Vector3f unit = normal.col(at(slot)).cast<float>();
            return unit.isZero(0) ? Eigen::Vector3f::UnitZ().eval() : unit;
        });
}

void GltfFile::AddPart(std::size_t count, int component, const char *type, std::size_t bytes, int target, int numbers) {
    Part part;
    part.at = bufferBytes;
    part.bytes = bytes;
    part.count = count;
    part.component = component;
    part.type = type;
    part.target = target;
    part.numbers = numbers;
    part.low.setConstant(std::numeric_limits<float>::max());
    part.high = -part.low;
    parts.push_back(part);
    bufferBytes += bytes;
}

void GltfFile::WriteColors(const VertexColors &color) {
    std::array<std::uint16_t, 256> linear;
    for (std::size_t i = 0; i < linear.size(); ++i) { // IEC 61966-2-1
        const double c = double(i) / 255;
        linear[i] =
            std::uint16_t(std::lround(65535 * (c <= 0.04045 ? c / 12.92 : detail::Power((c + 0.055) / 1.055, 2.4))));
    }
    std::vector<std::uint16_t> all;
    all.reserve(4 * surface.slot.size());
    for (std::uint32_t slot : surface.slot) {
        for (std::size_t k = 0; k < 3; ++k)
            all.push_back(linear[color[slot][k]]);
        all.push_back(std::uint16_t(257 * color[slot][3])); // opacity is linear
    }
    write(headBytes + jsonBytes + 8 + parts[parts.size() - 1 - isSparse].at, reinterpret_cast<const char *>(all.data()),
          2 * all.size());
}

void GltfFile::WriteVectors(const std::function<Eigen::Vector3f(std::size_t slot)> &row) {
    Part &part = parts[next++];
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
        headBytes + jsonBytes + 8 + part.at, surface, row);
}

void GltfFile::Add(const Eigen::Matrix3Xd &position, const Eigen::Matrix3Xd &normal) {
    assert(next + hasColors + isSparse < parts.size());
    const auto change = [](const Eigen::Matrix3Xd &after, const Eigen::Matrix3Xd &before, std::size_t slot) {
        return Eigen::Vector3f((after.col(Eigen::Index(slot)) - before.col(Eigen::Index(slot))).cast<float>());
    };
    WriteVectors([&](std::size_t slot) { return change(position, rest, slot); });
    if (!isCloud)
        WriteVectors([&](std::size_t slot) { // 0 without a face, which stays what it is in the file
            const auto at = Eigen::Index(slot);
            const bool isNone = normal.col(at).isZero(0) || restNormal.col(at).isZero(0);
            return isNone ? Eigen::Vector3f::Zero().eval() : change(normal, restNormal, slot);
        });
}

std::string GltfFile::Json(bool longest) const {
    const auto number = [](std::size_t i) { return std::to_string(i); };
    const std::size_t each = isCloud ? 1 : 2, first = isCloud ? 2 : 3; // parts of a shape, and that of the one at rest
    const auto shape = [&](std::size_t part) {
        return "{\"POSITION\":" + number(part) + (isCloud ? "" : ",\"NORMAL\":" + number(part + 1)) + "}";
    };
    const std::size_t targets = animation.target.size(), accessors = parts.size() - isSparse;
    std::string atRest = shape(first);
    if (hasColors)
        atRest.insert(atRest.size() - 1, ",\"COLOR_0\":" + number(accessors - 1));
    std::string json =
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"FCD\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
        "\"nodes\":[{\"mesh\":0,\"name\":" +
        Quoted(name) + ",\"translation\":" + List(3, [&](std::size_t i) { return detail::ToText(origin[i]); }) +
        "}],\"meshes\":[{\"name\":" + Quoted(name) + ",\"primitives\":[{\"attributes\":" + atRest +
        (isCloud ? ",\"mode\":0" : ",\"indices\":2") +
        ",\"targets\":" + List(targets, [&](std::size_t i) { return shape(first + each * (i + 1)); }) +
        "}],\"weights\":" + List(targets, [](std::size_t) { return std::string("0"); }) +
        ",\"extras\":{\"targetNames\":" + List(targets, [&](std::size_t i) { return Quoted(animation.target[i]); }) +
        "}}],\"animations\":[{\"name\":" + Quoted(name) +
        ",\"samplers\":[{\"input\":0,\"output\":1,\"interpolation\":\"LINEAR\"}],"
        "\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"weights\"}}]}],\"accessors\":";
    const auto extreme = [&](const Part &part, const Eigen::Array3f &values) {
        return List(std::size_t(part.numbers), [&](std::size_t i) {
            return longest ? std::string("-1.2345678901e-38") : detail::ToText(values[Eigen::Index(i)]);
        });
    };
    json += List(accessors, [&](std::size_t i) {
        const Part &part = parts[i];
        const std::string sparse = "{\"sparse\":{\"count\":" + number(animation.time.size()) +
                                   ",\"indices\":{\"bufferView\":" + number(accessors) +
                                   ",\"componentType\":5125},\"values\":{\"bufferView\":1}}";
        return (isSparse && i == 1 ? sparse : "{\"bufferView\":" + number(i)) +
               ",\"componentType\":" + std::to_string(part.component) + ",\"count\":" + number(part.count) +
               ",\"type\":\"" + part.type + "\"" + (part.component == 5123 ? ",\"normalized\":true" : "") +
               (part.numbers > 0 ? ",\"min\":" + extreme(part, part.low) + ",\"max\":" + extreme(part, part.high)
                                 : "") +
               "}";
    });
    json += ",\"bufferViews\":" + List(parts.size(), [&](std::size_t i) {
                const Part &part = parts[i];
                return "{\"buffer\":0,\"byteOffset\":" + std::to_string(part.at) +
                       ",\"byteLength\":" + std::to_string(part.bytes) +
                       (part.target > 0 ? ",\"target\":" + std::to_string(part.target) : "") + "}";
            });
    return json + ",\"buffers\":[{\"byteLength\":" + std::to_string(bufferBytes) + "}]}";
}

void GltfFile::Finish() {
    assert(next + hasColors + isSparse == parts.size());
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
