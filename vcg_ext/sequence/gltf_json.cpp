// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h>
#include <vcg_ext/sequence/gltf_file.h>

#include <algorithm>

namespace vcg::fcd {

namespace {

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

std::string Number(std::size_t i) { return std::to_string(i); }

} // namespace

std::string GltfFile::MeshJson(const Placed &placed) const {
    const GltfMesh &mesh = placed.mesh;
    const auto shape = [&](std::size_t part) {
        return "\"POSITION\":" + Number(part) + (placed.isCloud ? "" : ",\"NORMAL\":" + Number(part + 1));
    };
    const std::size_t targets = animation.target.size();
    const std::string shapes = ",\"targets\":" + List(targets, [&](std::size_t i) {
                                   return "{" + shape(placed.rest + placed.PartsOfShape() * (i + 1)) + "}";
                               });
    const auto primitive = [&](std::size_t i) {
        const bool isColored = placed.isCloud || !mesh.look.IsShown(mesh.surface.range[i].texture);
        return "{\"attributes\":{" + shape(placed.rest) +
               (placed.places == none ? "" : ",\"TEXCOORD_0\":" + Number(placed.places)) +
               (isColored && placed.colors != none ? ",\"COLOR_0\":" + Number(placed.colors) : "") + "}" +
               (placed.isCloud
                    ? ",\"mode\":0"
                    : ",\"indices\":" + Number(placed.corners + i) + ",\"material\":" + Number(placed.material[i])) +
               shapes + "}";
    };
    return "{\"name\":" + Quoted(mesh.name) +
           ",\"primitives\":" + List(placed.isCloud ? 1 : mesh.surface.range.size(), primitive) +
           ",\"weights\":" + List(targets, [](std::size_t) { return std::string("0"); }) +
           ",\"extras\":{\"targetNames\":" + List(targets, [&](std::size_t i) { return Quoted(animation.target[i]); }) +
           "}}";
}

std::string GltfFile::MaterialsJson() const {
    if (materials.empty())
        return {};
    const auto material = [&](std::size_t i) {
        const auto image = std::find(images.begin(), images.end(), materials[i]);
        return "{" + (materials[i] ? "\"name\":" + Quoted(materials[i]->name) + "," : std::string()) +
               "\"pbrMetallicRoughness\":{" +
               (image == images.end()
                    ? std::string()
                    : "\"baseColorTexture\":{\"index\":" + Number(std::size_t(image - images.begin())) + "},") +
               "\"metallicFactor\":0},\"doubleSided\":true}";
    };
    std::string json = ",\"materials\":" + List(materials.size(), material);
    if (images.empty())
        return json;
    const std::size_t first = accessors + isSparse;
    return json +
           ",\"textures\":" + List(images.size(), [](std::size_t i) { return "{\"source\":" + Number(i) + "}"; }) +
           ",\"images\":" + List(images.size(), [&](std::size_t i) {
               return "{\"name\":" + Quoted(images[i]->name) + ",\"mimeType\":\"" + images[i]->Kind() +
                      "\",\"bufferView\":" + Number(first + i) + "}";
           });
}

/// \param longest with the longest possible numbers, to know the room
std::string GltfFile::Json(bool longest) const {
    const std::size_t count = meshes.size();
    std::string json =
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"FCD\"},\"scene\":0,\"scenes\":[{\"nodes\":" +
        List(count, Number) + "}],\"nodes\":" +
        List(count,
             [&](std::size_t m) {
                 const Eigen::Vector3d &origin = meshes[m].origin;
                 return "{\"mesh\":" + Number(m) + ",\"name\":" + Quoted(meshes[m].mesh.name) + ",\"translation\":" +
                        List(3, [&](std::size_t i) { return detail::ToText(origin[Eigen::Index(i)]); }) + "}";
             }) +
        ",\"meshes\":" + List(count, [&](std::size_t m) { return MeshJson(meshes[m]); }) + MaterialsJson() +
        ",\"animations\":[{\"name\":" + Quoted(meshes.front().mesh.name) +
        ",\"samplers\":[{\"input\":0,\"output\":1,\"interpolation\":\"LINEAR\"}],\"channels\":" +
        List(count,
             [](std::size_t m) {
                 return "{\"sampler\":0,\"target\":{\"node\":" + Number(m) + ",\"path\":\"weights\"}}";
             }) +
        "}],\"accessors\":";
    const auto extreme = [&](const Part &part, const Eigen::Array3f &values) {
        return List(std::size_t(part.numbers), [&](std::size_t i) {
            return longest ? std::string("-1.2345678901e-38") : detail::ToText(values[Eigen::Index(i)]);
        });
    };
    json += List(accessors, [&](std::size_t i) {
        const Part &part = parts[i];
        const std::string sparse = "{\"sparse\":{\"count\":" + Number(animation.time.size()) +
                                   ",\"indices\":{\"bufferView\":" + Number(accessors) +
                                   ",\"componentType\":5125},\"values\":{\"bufferView\":1}}";
        return (isSparse && i == 1 ? sparse : "{\"bufferView\":" + Number(i)) +
               ",\"componentType\":" + std::to_string(part.component) + ",\"count\":" + Number(part.count) +
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

} // namespace vcg::fcd
