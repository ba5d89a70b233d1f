// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Makes the four test cases of
///     M. Botsch, O. Sorkine: On Linear Variational Surface Deformation Methods.
///     IEEE Transactions on Visualization and Computer Graphics 14(1), 2008:
/// a twisted bar, a bent cactus, a bent cylinder and a lifted bumpy plane, at any resolution. For each case it writes
/// the mesh, one tag per vertex (`.sel`: 0 fixed, 1 free, 2 handle) and the motion of the handle (`.def`: a 4x4
/// matrix). Shapes, tagged regions and motions follow the published cases; the vertices are new.

#include "benchmark_shapes.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

namespace {

using namespace benchmark;

/// A file that is written through a large buffer and whose errors are exceptions.
class Output {
  public:
    explicit Output(const std::filesystem::path &path) : name(path.string()), file(std::fopen(name.c_str(), "wb")) {
        if (!file)
            throw std::runtime_error("cannot write " + name);
        buffer.reserve(bufferSize);
    }
    void Write(const void *data, std::size_t size) {
        if (buffer.size() + size > bufferSize)
            Flush();
        const char *bytes = static_cast<const char *>(data);
        buffer.insert(buffer.end(), bytes, bytes + size);
    }
    void Write(const std::string &text) { Write(text.data(), text.size()); }
    template <class... Values>
    void Print(const char *format, Values... values) {
        char line[256];
        Write(line, std::snprintf(line, sizeof line, format, values...));
    }
    void Close() {
        Flush();
        if (std::fclose(file.release()) != 0)
            throw std::runtime_error("cannot write " + name);
    }

  private:
    struct Closer {
        void operator()(std::FILE *f) const { std::fclose(f); }
    };
    void Flush() {
        if (std::fwrite(buffer.data(), 1, buffer.size(), file.get()) != buffer.size())
            throw std::runtime_error("cannot write " + name);
        buffer.clear();
    }
    static constexpr std::size_t bufferSize = 1 << 20;
    std::string name;
    std::unique_ptr<std::FILE, Closer> file;
    std::vector<char> buffer;
};

/// Writes PLY (binary, little-endian, float) or, if the extension says so, OFF (text).
void WriteMesh(const std::filesystem::path &path, const Shape &shape) {
    Output out(path);
    const long long nv = shape.Surface().VertexCount(), nf = 2 * shape.Surface().CellCount();
    if (path.extension() == ".off") {
        out.Print("OFF\n%lld %lld 0\n", nv, nf);
        shape.ForEachPosition([&](const Vector3d &p) { out.Print("%.9g %.9g %.9g\n", p.x(), p.y(), p.z()); });
        ForEachTriangle(shape, [&](Index a, Index b, Index c) { out.Print("3 %d %d %d\n", a, b, c); });
    } else {
        out.Print("ply\nformat binary_little_endian 1.0\nelement vertex %lld\nproperty float x\nproperty float y\n"
                  "property float z\nelement face %lld\nproperty list uchar int vertex_indices\nend_header\n",
                  nv, nf);
        shape.ForEachPosition([&](const Vector3d &p) {
            const float xyz[3] = {float(p.x()), float(p.y()), float(p.z())};
            out.Write(xyz, sizeof xyz);
        });
        ForEachTriangle(shape, [&](Index a, Index b, Index c) {
            char record[13] = {3};
            const Index abc[3] = {a, b, c};
            std::copy_n(reinterpret_cast<const char *>(abc), sizeof abc, record + 1);
            out.Write(record, sizeof record);
        });
    }
    out.Close();
}

/// Writes the tags and returns how many vertices have each.
std::array<long long, 3> WriteTags(const std::filesystem::path &path, const Shape &shape) {
    Output out(path);
    std::array<long long, 3> count{};
    out.Write("# one tag per vertex: 0 = fixed, 1 = free, 2 = handle\n");
    shape.ForEachPosition([&](const Vector3d &p) {
        const int tag = shape.Tag(p);
        ++count[tag];
        out.Print("%d\n", tag);
    });
    out.Close();
    return count;
}

void WriteMotion(const std::filesystem::path &path, const Matrix4d &m) {
    Output out(path);
    out.Write("# 4x4 matrix that moves the handle\n");
    for (int r = 0; r < 4; ++r)
        out.Print("%.12f %.12f %.12f %.12f\n", m(r, 0), m(r, 1), m(r, 2), m(r, 3));
    out.Close();
}

} // namespace

int main(int argc, char **argv) {
    CLI::App app{
        "Makes the test cases of Botsch and Sorkine 2008 at any resolution: FILE, and beside it the tags of the "
        "vertices (.sel) and the motion of the handle (.def)."};
    std::string name;
    std::filesystem::path path;
    std::int64_t count = 2000;
    app.add_option("shape", name, "bar, cactus, cylinder or plane")
        ->required()
        ->check(CLI::IsMember({"bar", "cactus", "cylinder", "plane"}));
    app.add_option("file", path, "mesh to write, .ply or .off")->required();
    app.add_option("-n,--vertices", count, "vertices wanted; the nearest possible number is used")
        ->capture_default_str()
        ->check(CLI::Range(std::int64_t(200), std::int64_t(500000000)));
    CLI11_PARSE(app, argc, argv);

    try {
        if (path.extension() != ".ply" && path.extension() != ".off")
            throw std::runtime_error(path.string() + ": the name must end in .ply or .off");
        const std::map<std::string, std::function<std::unique_ptr<Shape>()>> make = {
            {"bar", [] { return std::make_unique<Bar>(); }},
            {"cactus", [] { return std::make_unique<Cactus>(); }},
            {"cylinder", [] { return std::make_unique<Cylinder>(); }},
            {"plane", [] { return std::make_unique<Plane>(); }}};
        const std::unique_ptr<Shape> shape = make.at(name)();
        shape->Resolve(count);
        WriteMesh(path, *shape);
        const auto tags = WriteTags(std::filesystem::path(path).replace_extension(".sel"), *shape);
        WriteMotion(std::filesystem::path(path).replace_extension(".def"), shape->Motions().front());
        std::printf("%s: %lld vertices (%lld fixed, %lld free, %lld handle), %lld triangles\n", path.string().c_str(),
                    static_cast<long long>(shape->Surface().VertexCount()), tags[0], tags[1], tags[2],
                    static_cast<long long>(2 * shape->Surface().CellCount()));
    } catch (const std::exception &e) {
        std::fprintf(stderr, "make_benchmark: %s\n", e.what());
        return 1;
    }
    return 0;
}
