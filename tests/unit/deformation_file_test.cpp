// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/field/deformation_file.h>
#include <vcg_ext/handles/handle_file.h>
#include "test_support.h"

#include <filesystem>

using namespace vcg::fcd;
using namespace fcd_test;

static FieldSamples RandomSamples(Index vertices, Index faces) {
    std::mt19937 random(1);
    FieldSamples samples;
    samples.position.resize(3, vertices);
    samples.displacement.resize(3, vertices);
    for (Index i = 0; i < vertices; ++i) {
        samples.position.col(i) = RandomVector(random);
        samples.displacement.col(i) = 1e50 * RandomVector(random);
        samples.gradient.emplace_back(RandomRotation(random).cast<float>());
    }
    for (Index f = 0; f < faces; ++f)
        samples.triangle.push_back({Index(random() % unsigned(vertices)), Index(random() % unsigned(vertices)),
                                    Index(random() % unsigned(vertices))});
    return samples;
}

static std::string Refusal(const std::string &text) {
    const std::string message = MessageOf<Error>([&] { ReadDeformationText(text, "file.ply"); });
    EXPECT_EQ(message.find("'file.ply' "), 0u) << message;
    EXPECT_EQ(message.back(), '.') << message;
    return message;
}

static std::string Replaced(std::string text, const std::string &from, const std::string &to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos);
    return text.replace(at, from.size(), to);
}

/// A file of version 1, without largest difference and checksum.
static std::string OfVersion1(std::string text) {
    const std::size_t from = text.find("comment largest"), to = text.find("element vertex");
    return Replaced(text.erase(from, to - from), "version 2", "version 1");
}

#define EXPECT_SAYS(message, words) EXPECT_NE((message).find(words), std::string::npos) << (message)

TEST(DeformationFile, ReadsWhatItWritesToTheBit) {
    for (Index faces : {0, 7}) {
        const FieldSamples samples = RandomSamples(5, faces);
        const std::string text = DeformationText(samples);
        const FieldSamples read = ReadDeformationText(text, "text");
        EXPECT_TRUE(SameBits(read.position, samples.position));
        EXPECT_TRUE(SameBits(read.displacement, samples.displacement));
        EXPECT_EQ(read.gradient, samples.gradient);
        EXPECT_EQ(read.triangle, samples.triangle);
        EXPECT_EQ(DeformationText(read), text);
    }
}

TEST(DeformationFile, KeepsTheLargestDifference) {
    FieldSamples samples = RandomSamples(5, 7);
    EXPECT_TRUE(std::isnan(ReadDeformationText(DeformationText(samples), "text").largestDifference));
    for (double largest : {0.0, 1e-300, 0.1, 12345.678901234567}) {
        samples.largestDifference = largest;
        EXPECT_EQ(ReadDeformationText(DeformationText(samples), "text").largestDifference, largest);
    }
}

TEST(DeformationFile, OfVersion1IsRead) {
    const FieldSamples samples = RandomSamples(5, 7);
    const FieldSamples read = ReadDeformationText(OfVersion1(DeformationText(samples)), "text");
    EXPECT_TRUE(SameBits(read.position, samples.position));
    EXPECT_EQ(read.triangle, samples.triangle);
    EXPECT_TRUE(std::isnan(read.largestDifference));
}

TEST(DeformationFile, RefusesEveryBitThatIsChanged) {
    FieldSamples samples = RandomSamples(4, 3);
    samples.largestDifference = 0.25;
    const std::string text = DeformationText(samples);
    for (std::size_t bit = 0; bit < 8 * text.size(); ++bit) {
        std::string other = text;
        other[bit / 8] = char(other[bit / 8] ^ (1 << bit % 8));
        Refusal(other);
    }
    std::string other = text;
    other[other.size() - 100] = char(other[other.size() - 100] ^ 1);
    EXPECT_SAYS(Refusal(other), "was changed since it was written: its checksum does not fit. Copy or save it again");
    EXPECT_SAYS(Refusal(Replaced(text, "difference 0.25", "difference 0.250")), "its largest difference is '0.250'");
}

TEST(DeformationFile, IsPly) {
    FieldSamples samples = RandomSamples(2, 1);
    samples.largestDifference = 0.125;
    const std::string text = DeformationText(samples);
    EXPECT_EQ(text.find("ply\nformat binary_little_endian 1.0\ncomment FCD deformation, version 2\ncomment largest "
                        "difference 0.125\ncomment CRC-32 without this line "),
              0u);
    EXPECT_SAYS(text,
                "\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\nproperty double ux\n");
    const std::size_t data = text.find("property list uchar int vertex_indices\nend_header\n") + 50;
    EXPECT_EQ(text.size(), data + 2 * 84 + 13);
    double x;
    std::memcpy(&x, text.data() + data, sizeof x);
    EXPECT_EQ(x, RandomSamples(2, 1).position(0, 0));
    float uxy;
    std::memcpy(&uxy, text.data() + data + 48 + 4, sizeof uxy);
    EXPECT_EQ(uxy, RandomSamples(2, 1).gradient[0](0, 1));
}

TEST(DeformationFile, RefusesWhatIsNoDeformation) {
    const std::string text = DeformationText(RandomSamples(4, 2));
    for (const std::string &other :
         {std::string(), std::string("ply"), std::string("solid\n"), text.substr(0, 40),
          Replaced(text, "little", "big"), Replaced(text, "FCD", "MeshLab"), Replaced(text, "version 2", "version two"),
          Replaced(text, "version 2", "version 2 "), Replaced(text, "ply\n", "ply\r\n")})
        EXPECT_SAYS(Refusal(other), "is no saved deformation. Give an unchanged file of 'FCD: Save Deformation'");
    for (const char *other : {"version 0", "version 3"})
        EXPECT_SAYS(Refusal(Replaced(text, "version 2", other)), "; only versions 1 to 2 are known here. Update");
}

TEST(DeformationFile, RefusesAnotherHeader) {
    const std::string text = DeformationText(RandomSamples(4, 2));
    EXPECT_SAYS(Refusal(Replaced(text, "double uy", "float uy")),
                "line 11: expected 'property double uy', found 'property float uy'");
    EXPECT_SAYS(Refusal(Replaced(text, "vertex 4", "vertex four")),
                "line 6: expected 'element vertex *', found 'element vertex four'");
    EXPECT_SAYS(Refusal(Replaced(text, "face 2", "face -2")), "line 22");
    EXPECT_SAYS(Refusal(Replaced(text, "face 2", "face 02")), "line 22");
    EXPECT_SAYS(Refusal(Replaced(text, "property float uzz\n", "")), "line 21: expected 'property float uzz'");
    EXPECT_SAYS(Refusal(text.substr(0, text.find("end_header") + 10)), "line 24: expected 'end_header'");
    EXPECT_SAYS(Refusal(text.substr(0, text.find("uzz"))), "line 21");
}

TEST(DeformationFile, RefusesSizesThatDoNotFitBeforeItReserves) {
    const std::string text = DeformationText(RandomSamples(4, 2));
    EXPECT_SAYS(Refusal(Replaced(text, "vertex 4", "vertex 0")), "has 0 vertices and 2 faces, by its header");
    EXPECT_SAYS(Refusal(Replaced(text, "vertex 4", "vertex 2147483648")), "expected 1 to 2147483647 vertices");
    EXPECT_SAYS(Refusal(Replaced(text, "face 2", "face 18446744073709551615")), "expected 1 to 2147483647 vertices");
    for (const std::string &other :
         {Replaced(text, "vertex 4", "vertex 2147483647"), Replaced(text, "vertex 4", "vertex 3"),
          Replaced(text, "face 2", "face 3"), text + " ", text.substr(0, text.size() - 1)})
        EXPECT_SAYS(Refusal(other), "it is incomplete, or was changed. Copy or save it again");
}

TEST(DeformationFile, RefusesNumbersThatMakeNoSense) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    for (double bad : {nan, inf, -inf, 1.1e100}) {
        FieldSamples samples = RandomSamples(4, 2);
        samples.position(1, 2) = bad;
        EXPECT_SAYS(Refusal(DeformationText(samples)), "beyond 1e100, at vertex 2:");
        samples = RandomSamples(4, 2);
        samples.displacement(2, 3) = bad;
        EXPECT_SAYS(Refusal(DeformationText(samples)), "beyond 1e100, at vertex 3:");
        samples = RandomSamples(4, 2);
        samples.gradient[0](2, 1) = float(bad);
        EXPECT_SAYS(Refusal(DeformationText(samples)), "at vertex 0:");
    }
    for (Index bad : {-1, 4, 2147483647}) {
        FieldSamples samples = RandomSamples(4, 2);
        samples.triangle[1][2] = bad;
        EXPECT_SAYS(Refusal(DeformationText(samples)), "has a face that is no triangle of its vertices, face 1:");
    }
    std::string text = OfVersion1(DeformationText(RandomSamples(4, 2)));
    text[text.size() - 26] = 4;
    EXPECT_SAYS(Refusal(text), "face 0:");
}

TEST(DeformationFile, IsReadFromAFile) {
    const std::string path =
        (std::filesystem::temp_directory_path() / ("fcd_" + std::to_string(std::random_device()()) + ".ply")).string();
    std::ofstream(path, std::ios::binary) << DeformationText(RandomSamples(3, 1));
    EXPECT_EQ(ReadDeformationFile(path).Size(), 3);
    std::filesystem::remove(path);
    EXPECT_SAYS(MessageOf<Error>([&] { ReadDeformationFile(path); }), "Cannot open '" + path + "'.");
}
