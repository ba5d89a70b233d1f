// SPDX-License-Identifier: GPL-3.0-or-later
// What libFuzzer comes up with goes through every reader: each returns a valid value, or throws an Error that says
// where.
//   build/fuzz/tests/fcd_fuzz -dict=tests/fuzz/words.dict FOLDER tests/fuzz/corpus    (FOLDER keeps what is found)
#include "../../layer_fcd/bend_state.h"
#include "../../layer_fcd/picked_points.h"
#include <vcg_ext/base/words.h>
#include <vcg_ext/field/deformation_file.h>
#include <vcg_ext/fit/curve_file.h>
#include <vcg_ext/handles/handle_file.h>
#include <vcg_ext/handles/motion_text.h>
#include <vcg_ext/line/line_points.h>
#include <vcg_ext/sequence/pose_sequence.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

using namespace vcg::fcd;

static void Require(bool holds, const char *what) {
    if (!holds) {
        std::fprintf(stderr, "not so: %s\n", what);
        std::abort();
    }
}
#define REQUIRE(condition) Require(condition, #condition)

/// Calls \p read; where it throws, the message must be one printable line that begins with \p begin.
template <class Read>
static void Try(const std::string &begin, const Read &read) {
    try {
        read();
    } catch (const Error &e) {
        const std::string message = e.what();
        REQUIRE(message.compare(0, begin.size(), begin) == 0);
        REQUIRE(message.size() < 300 && message.back() == '.');
        REQUIRE(vcg::fcd::detail::Printable(message, message.size()) == message);
    }
}

static void Tags(const std::string &text) {
    const std::vector<int> tag = ReadTagText(text, "input");
    REQUIRE(!tag.empty());
    std::string written;
    for (int t : tag)
        written += detail::ToText(t) + "\n";
    REQUIRE(ReadTagText(written, "written") == tag);
}

static void Transforms(const std::string &text) {
    const std::vector<Eigen::Matrix4d> matrix = ReadTransformText(text, "input");
    REQUIRE(!matrix.empty());
    std::string written;
    for (const Eigen::Matrix4d &m : matrix) {
        REQUIRE(m.allFinite());
        for (int i = 0; i < 16; ++i)
            written += detail::ToText(m(i / 4, i % 4)) + " ";
    }
    const std::vector<Eigen::Matrix4d> again = ReadTransformText(written, "written");
    REQUIRE(again.size() == matrix.size());
    for (std::size_t i = 0; i < matrix.size(); ++i)
        REQUIRE(std::memcmp(again[i].data(), matrix[i].data(), sizeof matrix[i]) == 0);
}

static void Points(const std::vector<PointPair> &pairs) {
    REQUIRE(!pairs.empty());
    for (const PointPair &pair : pairs) {
        REQUIRE(pair.vertex >= -1);
        REQUIRE(pair.start.allFinite() && pair.target.allFinite());
    }
}

static void Motions(const std::string &text) {
    const Eigen::Vector3d barycenter(3, -1, 2);
    for (const auto &[tag, steps] : ReadMotionText(text, "input")) {
        REQUIRE(tag >= 2 && !steps.empty());
        Try("A transform ", [&steps = steps, &barycenter] {
            const Motion motion = ToMotion(steps, barycenter);
            REQUIRE(motion.matrix.allFinite() && motion.turn.allFinite() && motion.pivot.allFinite());
            motion.At(50, barycenter);
        });
    }
}

static void SavedDeformation(const std::string &text) {
    FieldSamples samples = ReadDeformationText(text, "input");
    REQUIRE(samples.Size() >= 1 && samples.displacement.cols() == samples.Size());
    if (text.find("version 1\n") > 100) // that is read, and written as the next one
        REQUIRE(DeformationText(samples) == text);
    const DeformationField field(std::move(samples));
    for (double x : {0.0, 1.0, -1e10}) {
        Eigen::Matrix3f linear;
        REQUIRE(field(Eigen::Vector3d(x, 2, 3), &linear).allFinite());
    }
}

static void Line(const std::string &text) {
    const Eigen::Matrix3Xd points = ReadLineText(text, "input");
    REQUIRE(points.cols() > 0 && points.allFinite());
}

static void Curves(const std::string &text) {
    const std::vector<CurvePair> curves = ReadCurveText(text, "input");
    REQUIRE(!curves.empty());
    std::string written = "curve,surface,x,y,z\n";
    for (const CurvePair &curve : curves) {
        REQUIRE(!curve.name.empty() && curve.source.size() == curve.sourceLine.size());
        for (const auto *side : {&curve.source, &curve.target}) {
            REQUIRE(side->size() >= 2);
            for (const Eigen::Vector3d &corner : *side) {
                written += detail::ToText(&curve - curves.data()) + (side == &curve.source ? ",source" : ",target");
                for (int d = 0; d < 3; ++d)
                    written += "," + detail::ToText(corner[d]);
                written += "\n";
            }
        }
    }
    const std::vector<CurvePair> again = ReadCurveText(written, "written");
    REQUIRE(again.size() == curves.size());
    for (std::size_t c = 0; c < curves.size(); ++c)
        REQUIRE(again[c].source == curves[c].source && again[c].target == curves[c].target);
}

static void Poses(const std::string &text) {
    const PoseSequence sequence = ReadPoseSequence(text, "input");
    REQUIRE(!sequence.pose.empty() && !sequence.key.empty());
    const std::string written = PoseSequenceText(sequence);
    REQUIRE(PoseSequenceText(ReadPoseSequence(written, "written")) == written);
    REQUIRE(sequence.WeightsAt(sequence.key.back().time) == sequence.key.back().weight);
}

static void Tool(const std::string &text) {
    const std::vector<std::size_t> live = {0, 1, 3, 4}; // 2 is deleted
    const auto [state, options] = readBendText(text, "input", live, 5);
    for (const auto &[tag, point] : state.points)
        REQUIRE(tag >= 2 && std::find(live.begin(), live.end(), point.slot) != live.end());
    REQUIRE(!state.marks || state.marks->size() == 5);
    const std::string written = bendText(state, options, live);
    const auto [again, sameOptions] = readBendText(written, "written", live, 5);
    REQUIRE(bendText(again, sameOptions, live) == written);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    const std::string text(reinterpret_cast<const char *>(data), size);
    Try("'input', line ", [&] { Tags(text); });
    Try("'input', line ", [&] { Transforms(text); });
    Try("'input', line ", [&] { Points(ReadPointHandleText(text, "input")); });
    Try("'input'", [&] { Points(readPickedPoints(QByteArray::fromStdString(text), "'input'")); });
    Try("'input', line ", [&] { Line(text); });
    Try("'input', line ", [&] { Curves(text); });
    Try("'input'", [&] { Poses(text); });
    Try("input, character ", [&] { Motions(text); });
    Try("'input', line ", [&] { Tool(text); });
    Try("'input' ", [&] { SavedDeformation(text); });
    return 0;
}
