// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h>
#include <vcg_ext/handles/motion_text.h>
#include <vcg_ext/sequence/gltf_file.h>
#include <vcg_ext/sequence/sequence_frames.h>
#include <vcg_ext/surface/face_normals.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3Xd;
using Eigen::Matrix4d;
using Eigen::Vector3d;

namespace {

const Vector3d handleCenter(3, -1, 2);

Motion Told(const std::string &steps) { return ToMotion(ReadMotionText("2: " + steps).at(2), handleCenter); }

Matrix4d Blended(const std::vector<std::pair<std::string, double>> &parts) {
    std::vector<std::pair<Motion, double>> motions;
    for (const auto &[steps, percent] : parts)
        motions.emplace_back(Told(steps), percent);
    return Blend(motions, handleCenter).matrix;
}

/// A file in memory.
struct Bytes {
    std::string content;
    WriteAt Write() {
        return [this](std::uint64_t at, const char *data, std::size_t size) {
            content.resize(std::max(content.size(), std::size_t(at) + size));
            std::copy(data, data + size, content.begin() + std::ptrdiff_t(at));
        };
    }
    template <class Number>
    Number At(std::size_t place) const {
        Number number;
        std::memcpy(&number, content.data() + place, sizeof number);
        return number;
    }
};

const char *const table = "# a comment, with, commas\n"
                          "time,easing,bent,\"the other, \"\"2\"\"\"\n"
                          "surface,,\"5 vertices from -1 0 0.5 to 1 2 3\"\n"
                          "motions,,2: rotate 0 1 0 90,\"2: translate 0 0 5; 3: scale 1, 2, 3\"\n"
                          "0,smooth\n"
                          "1.5,hold,100,-50\n"
                          "2,,20.5,1e2\n";

/// A tube with a handle at each end, prepared.
struct SequenceRig {
    Shape shape = Tube(24, 40);
    MeshD mesh{shape};
    Arrays arrays = Read(mesh);
    Handles handles;
    DeformationParam param;
    std::unique_ptr<Deformer> deformer;
    PoseSequence sequence;
    std::vector<std::map<int, Motion>> motions;

    SequenceRig() {
        handles.tag = TagsOf(shape, [](const Vector3d &p) { return p[2] < 0.7 ? 3 : p[2] > 5.2 ? 2 : 1; });
        param.graph.initialPatches = 40;
        deformer = PrepareDeformer(arrays, handles, param);
        for (const char *text : {"2: rotate 0 1 0 80 translate 1 0 0", "2: rotate 0 0 1 200; 3: translate 0 0 -1"}) {
            sequence.pose.push_back({sequence.pose.empty() ? "bent" : "turned", text});
            motions.emplace_back();
            for (const auto &[tag, steps] : ReadMotionText(text))
                motions.back()[tag] = ToMotion(steps, deformer->center.at(tag));
        }
    }
    Matrix3Xd Carried(const Deformer::Pose &pose) const {
        Matrix3Xd position = SurfaceView(arrays).Copy();
        Carrier(*deformer, pose).Apply(position);
        return position;
    }
};

} // namespace

TEST(Blend, OfOneMotionIsThatMotion) {
    for (const char *steps : {"rotate 1 2 3 70 about 0 0 0", "rotate 0 0 1 400 translate 1 2 3", "scale 1 2 3",
                              "matrix 1 0.2 0 4  0 1 0.1 5  0 0 2 6  0 0 0 1"})
        for (double percent : {100.0, 30.0, -20.0, 250.0}) {
            const Motion motion = Told(steps), blended = Blend({{Told("scale 3"), 0}, {motion, percent}}, handleCenter);
            EXPECT_TRUE(SameBits(blended.matrix, motion.At(percent, handleCenter))) << steps;
            const Vector3d turn = motion.Rotation() * (percent / 100);
            if (turn.norm() < M_PI || !motion.turn.isZero(0)) {
                EXPECT_LT((blended.Rotation() - turn).norm(), 1e-9) << steps << percent;
            }
        }
    EXPECT_TRUE(SameBits(Blend({}, handleCenter).matrix, Matrix4d(Matrix4d::Identity())));
}

TEST(Blend, AddsUp) {
    const auto near = [](const Matrix4d &a, const Matrix4d &b) { return (a - b).norm() < 1e-12; };
    EXPECT_TRUE(
        near(Blended({{"translate 1 2 3", 50}, {"translate 0 0 -8", 25}}), Told("translate 0.5 1 -0.5").matrix));
    EXPECT_TRUE(near(Blended({{"rotate 0 1 0 270", 100}, {"rotate 0 -1 0 200", 50}}), Told("rotate 0 1 0 170").matrix));
    EXPECT_NEAR(Blend({{Told("rotate 0 0 2 300"), 100}, {Told("rotate 0 0 1 200"), 50}}, handleCenter).turn[2],
                400 * M_PI / 180, 1e-12);
    EXPECT_TRUE(near(Blended({{"scale 4", 50}, {"scale 1 2 3", 100}}), Told("scale 2 4 6").matrix));
    // Translation and turn add, in any order: the handle's middle moves up, and turns in place.
    const Matrix4d both = Blended({{"translate 0 0 10", 50}, {"rotate 0 1 0 90", 50}});
    EXPECT_TRUE(near(both, Told("rotate 0 1 0 45 translate 0 0 5").matrix));
    EXPECT_TRUE(near(both, Blended({{"rotate 0 1 0 90", 50}, {"translate 0 0 10", 50}})));
    // Half-way from one pose to another is between them.
    EXPECT_TRUE(
        near(Blended({{"rotate 0 1 0 40 about 0 0 0", 0}, {"rotate 0 1 0 80", 100}}), Told("rotate 0 1 0 80").matrix));
    MessageOf<BadInput>([] { Blended({{"scale 1e100", 1e5}, {"scale 1e100", 1e5}}); });
}

TEST(Blend, OfTurnsAboutOneJointStaysOnTheArc) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-1, 1);
    for (int trial = 0; trial < 200; ++trial) {
        const Vector3d pivot = 5 * RandomVector(random), axis = RandomVector(random), arm = handleCenter - pivot;
        std::vector<std::pair<Motion, double>> aboutAxis, across;
        double degrees = 0;
        for (int i = 0; i < 2 + trial % 3; ++i) {
            MotionStep step = MotionStep::Rotate(axis, (trial % 2 ? 170 : 500) * number(random));
            step.about = pivot + number(random) * axis;
            const double percent = 100 * number(random);
            aboutAxis.emplace_back(ToMotion({step}, handleCenter), percent);
            degrees += step.degrees * percent / 100;
            step.vector = arm.cross(RandomVector(random));
            step.about = pivot;
            across.emplace_back(ToMotion({step}, handleCenter), percent);
        }
        MotionStep sum = MotionStep::Rotate(axis, degrees);
        sum.about = pivot;
        ASSERT_LT((Blend(aboutAxis, handleCenter).matrix - ToMotion({sum}, handleCenter).matrix).norm(), 1e-9) << trial;
        const Vector3d middle = Affine3d(Blend(across, handleCenter).matrix) * handleCenter;
        ASSERT_NEAR((middle - pivot).norm(), arm.norm(), 1e-9) << trial;
        // A turn about itself does not move the middle.
        MotionStep itself = MotionStep::Rotate(RandomVector(random), 300 * number(random));
        across.emplace_back(ToMotion({itself}, handleCenter), 70);
        ASSERT_LT((Affine3d(Blend(across, handleCenter).matrix) * handleCenter - middle).norm(), 1e-9) << trial;
    }
}

TEST(Blend, IsContinuous) {
    const std::string bent = "rotate 0 1 0 90 about 0 0 0", other = "rotate 1 0 1 120 about 9 9 9";
    const auto with = [&](const MotionStep &step, double percent) {
        return Blend({{Told(bent), 50}, {ToMotion({step, MotionStep::Translate({1, 2, 3})}, handleCenter), percent}},
                     handleCenter)
            .matrix;
    };
    for (const double least : {1e-1, 1e-3, 1e-5, 1e-7, 1e-9}) {
        // A turn with a shift, a weight, a far pivot, and turns that cancel in part.
        EXPECT_LT(
            (with(MotionStep::Rotate({1, 0, 0}, least), 70) - Blended({{bent, 50}, {"translate 1 2 3", 70}})).norm(),
            least);
        EXPECT_LT((Blended({{bent, 50}, {other, least}}) - Blended({{bent, 50}})).norm(), least);
        MotionStep beside = MotionStep::Rotate({1, 2, 0}, 80);
        const Matrix4d itself = with(beside, 70);
        beside.about = handleCenter + Vector3d(least, 0, -least);
        EXPECT_LT((with(beside, 70) - itself).norm(), 10 * least);
        const std::string back = "rotate 0 1 0 -90 about 2 0 0";
        EXPECT_LT((Blended({{bent, 50}, {back, 50 + least}}) - Blended({{bent, 50}, {back, 50}})).norm(), least);
    }
}

TEST(Easing, IsWhatItIsCalled) {
    for (double t : {0.0, 0.25, 0.5, 1.0})
        EXPECT_EQ(Eased(Easing::Linear, t), t);
    EXPECT_EQ(Eased(Easing::Smooth, 0.25), 0.15625);
    EXPECT_EQ(Eased(Easing::Smooth, 1), 1);
    EXPECT_EQ(Eased(Easing::Hold, 0.999), 0);
    EXPECT_EQ(Eased(Easing::Hold, 1), 1);
}

TEST(PoseSequence, IsReadAndWritten) {
    const PoseSequence read = ReadPoseSequence(table, "t.csv");
    ASSERT_EQ(read.pose.size(), 2u);
    EXPECT_EQ(read.pose[0].name, "bent");
    EXPECT_EQ(read.pose[1].name, "the other, \"2\"");
    EXPECT_EQ(read.pose[1].motions, "2: translate 0 0 5; 3: scale 1, 2, 3");
    ASSERT_EQ(read.key.size(), 3u);
    EXPECT_EQ(read.key[0].weight, std::vector<double>(2, 0));
    EXPECT_EQ(read.key[1].weight, (std::vector<double>{100, -50}));
    EXPECT_EQ(read.key[1].easing, Easing::Hold);
    EXPECT_EQ(read.key[2].easing, Easing::Linear);
    EXPECT_EQ(read.key[2].time, 2);
    ASSERT_TRUE(read.surface);
    EXPECT_EQ(read.surface->vertices, 5u);
    EXPECT_EQ(read.surface->box.min(), Vector3d(-1, 0, 0.5));

    const std::string text = PoseSequenceText(read);
    EXPECT_EQ(PoseSequenceText(ReadPoseSequence(text, "again")), text);
    std::string other = "\xEF\xBB\xBF" + text; // as spreadsheets write it
    for (std::size_t at = 0; (at = other.find('\n', at)) != std::string::npos; at += 2)
        other.replace(at, 1, "\r\n");
    EXPECT_EQ(PoseSequenceText(ReadPoseSequence(other, "again")), text);
    EXPECT_EQ(PoseSequenceText(ReadPoseSequence("time;easing;a;;\nmotions;;2: scale 1, 2, 3;;\n;;;;\n0;;5;;", "again")),
              "time,easing,a\nmotions,,\"2: scale 1, 2, 3\"\n0,linear,5\n");
    const CommaLocale locale;
    EXPECT_EQ(PoseSequenceText(ReadPoseSequence(text, "again")), text);
}

TEST(PoseSequence, WithoutKeyFramesIsThePosesInTheirOrder) {
    const PoseSequence read = ReadPoseSequence("time\teasing\ta\tb\nmotions\t\t2: scale 2\n", "t.csv");
    ASSERT_EQ(read.key.size(), 3u);
    EXPECT_EQ(read.key[2].time, 2);
    EXPECT_EQ(read.key[2].weight, (std::vector<double>{0, 100}));
    EXPECT_EQ(read.key[0].easing, Easing::Smooth);
    EXPECT_EQ(read.pose[1].motions, "");
}

TEST(PoseSequence, SaysWhatIsWrong) {
    const auto of = [](const std::string &text) {
        return MessageOf<BadInput>([&] { ReadPoseSequence(text, "t.csv"); });
    };
    const std::string head = "time,easing,a,b\n", two = head + "motions,,2: scale 2,2: scale 3\n";
    for (const auto &[text, expected] : std::vector<std::pair<std::string, std::string>>{
             {"", "line 1: expected a first row 'time, easing'"},
             {"a,b\n", "expected a first row 'time, easing'"},
             {"time,easing\n", "with the name of a pose in each further cell"},
             {std::string("\xFF\xFEt\0i\0", 6), "expected plain text (ASCII or UTF-8), found UTF-16"},
             {head, "there is no row 'motions'"},
             {"time,easing" + std::string(20004, ',') + "z", "line 1: found 20004 poses, where 10000 are the most"},
             {two + "motions,,,\n", "line 3: found a second row 'motions'"},
             {two + "0,,1,2,3\n", "line 3: found 5 cells, where the first row has 4; put quotation marks"},
             {two + "soon,,1,2\n", "line 3: expected a time in seconds, 'motions' or 'surface', found 'soon'"},
             {two + "0,bouncy,1,2\n", "line 3: expected linear, smooth or hold, found 'bouncy'"},
             {two + "0,,1,much\n", "line 3: expected the percent of a pose, found 'much'"},
             {two + "0,,1,nan\n", "expected the percent of a pose, found 'nan'"},
             {two + "surface,,a cow\n", "line 3: expected 'N vertices from x y z to x y z'"},
             {two + "0,,\"1,2\n", "a quotation mark has no end"},
             {two + "0,,\"1\"2,3\n", "expected the end of a cell after its quotation marks"},
             {two + "1,,1\n1,,2\n", "A key frame at 1 s comes after one at 1 s. Their times must ascend."},
             {two + "-1,,1\n", "A key frame is at -1 s. Times are finite numbers from 0."},
             {"time,easing,a,a\nmotions\n", "Two poses are called 'a'."},
             {"time,easing,,a\nmotions\n", "A pose has no name. Give it one."}})
        EXPECT_NE(of(text).find(expected), std::string::npos) << of(text);
    PoseSequence none;
    EXPECT_NE(MessageOf<BadInput>([&] { none.Validate(); }).find("There is no pose."), std::string::npos);
    PoseSequence short_ = ReadPoseSequence(two, "t.csv");
    short_.key[1].weight.pop_back();
    EXPECT_NE(MessageOf<BadInput>([&] { short_.Validate(); }).find("for each pose"), std::string::npos);
    const PoseSequence good = ReadPoseSequence(two, "t.csv");
    EXPECT_NE(MessageOf<BadInput>([&] { FrameTimes(good, 0); }).find("must be a positive number"), std::string::npos);
    EXPECT_NE(MessageOf<BadInput>([&] { FrameTimes(good, 1e9); }).find("more than a million frames"),
              std::string::npos);
}

TEST(PoseSequence, IsOfOneSurface) {
    const Shape shape = Tube(5, 8);
    MeshD mesh(shape);
    const Arrays arrays = Read(mesh);
    PoseSequence sequence = ReadPoseSequence("time,easing,a\nmotions,,2: scale 2\n", "t.csv");
    const SurfaceMark mark = SurfaceMark::Of(arrays, Affine3d::Identity());
    sequence.ExpectSurface(mark); // any surface: it is not known
    sequence.surface = mark;
    sequence = ReadPoseSequence(PoseSequenceText(sequence), "t.csv");
    sequence.ExpectSurface(mark);
    const auto fails = [&](const SurfaceMark &other) {
        return MessageOf<BadInput>([&] { sequence.ExpectSurface(other); }).find("The poses are of another surface") ==
               0;
    };
    EXPECT_TRUE(fails(SurfaceMark::Of(arrays, Affine3d(Eigen::Translation3d(0, 0.1, 0)))));
    MeshD fewer(Tube(5, 9));
    EXPECT_TRUE(fails(SurfaceMark::Of(Read(fewer), Affine3d::Identity())));
}

TEST(PoseSequence, HasWeightsAndFramesInTime) {
    PoseSequence sequence = ReadPoseSequence(table, "t.csv");
    EXPECT_EQ(sequence.WeightsAt(-1), sequence.key[0].weight);
    EXPECT_EQ(sequence.WeightsAt(0.75), (std::vector<double>{50, -25}));
    EXPECT_EQ(sequence.WeightsAt(1.99), sequence.key[1].weight);
    EXPECT_EQ(sequence.WeightsAt(2), sequence.key[2].weight);
    EXPECT_EQ(sequence.WeightsAt(7), sequence.key[2].weight);
    EXPECT_EQ(FrameTimes(sequence, 24).size(), 49u);
    EXPECT_EQ(FrameTimes(sequence, 24).back(), 2);
    EXPECT_EQ(FrameTimes(sequence, 0.9), (std::vector<double>{0, 1 / 0.9, 2 / 0.9}));
    sequence.key.resize(1);
    EXPECT_EQ(FrameTimes(sequence, 24), std::vector<double>(1, 0));
    sequence.key.clear();
    EXPECT_TRUE(FrameTimes(sequence, 24).empty());
    EXPECT_EQ(sequence.WeightsAt(1), (std::vector<double>{0, 0}));
}

TEST(SequenceSolver, OfOnePoseIsThatPoseAndOfNoneIsRest) {
    SequenceRig rig;
    SequenceSolver solver(*rig.deformer, rig.handles.world, rig.motions, rig.param);
    for (std::size_t k = 0; k < 2; ++k) {
        Handles handles = rig.handles;
        handles.motion = rig.motions[k];
        std::vector<double> weight(2, 0);
        weight[k] = 100;
        solver.Rest();
        const Matrix3Xd first = rig.Carried(solver.Go(weight));
        EXPECT_TRUE(SameBits(first, rig.Carried(rig.deformer->Solve(handles, rig.param))));
        solver.Go({30, 40});
        EXPECT_LT((rig.Carried(solver.Go(weight)) - first).cwiseAbs().maxCoeff(), 1e-3); // on another path
    }
    EXPECT_TRUE(SameBits(rig.Carried(solver.Go({0, 0})), SurfaceView(rig.arrays).Copy()));
}

/// A pose by a blend reports the same as any pose; a blend of one pose has the same figures.
TEST(SequenceSolver, PosesASurfaceWithAllReports) {
    SequenceRig rig;
    const SurfaceView view(rig.arrays);
    const auto posed = [&](const PoseSolver &solve) {
        DeformationResult result;
        result.position = view.Copy();
        PoseSurface(view, {}, rig.handles, *rig.deformer, solve, rig.param, {}, result);
        return result;
    };
    const auto blended = [&](const std::vector<double> &weight) {
        return posed([&, weight](const Progress &progress) {
            return SequenceSolver(*rig.deformer, rig.handles.world, rig.motions, rig.param).Go(weight, progress);
        });
    };
    Handles handles = rig.handles;
    handles.motion = rig.motions[1];
    const DeformationResult own =
        posed([&](const Progress &progress) { return rig.deformer->Solve(handles, rig.param, progress); });
    const DeformationResult one = blended({0, 100});
    EXPECT_TRUE(SameBits(one.position, own.position));
    EXPECT_GT(own.iterations, 0);
    EXPECT_EQ(one.iterations, own.iterations);
    EXPECT_EQ(one.converged, own.converged);
    EXPECT_EQ(one.energy, own.energy);
    EXPECT_EQ(one.discretisationError, own.discretisationError);
    const DeformationResult two = blended({30, 40});
    EXPECT_GT(two.iterations, 0);
    EXPECT_TRUE(two.converged);
    EXPECT_GT(two.energy, 0);
    EXPECT_GT(two.discretisationError, 0);
}

TEST(SequenceSolver, HasNoPoints) {
    SequenceRig rig;
    rig.handles.point.push_back({std::size_t(rig.shape.Size() / 2), Vector3d(0, 0, 9)});
    rig.deformer = PrepareDeformer(rig.arrays, rig.handles, rig.param);
    EXPECT_NE(MessageOf<BadInput>([&] {
                  SequenceSolver(*rig.deformer, rig.handles.world, rig.motions, rig.param);
              }).find("this surface is prepared with points"),
              std::string::npos);
}

/// A single vertex turns with the surface if no pose turns it. If one does, it does not jump when that begins.
TEST(SequenceSolver, BeginsToTurnAHandleOfOneVertexWithoutAJump) {
    SequenceRig rig;
    for (std::size_t i = 0; i < rig.handles.tag.size(); ++i)
        if (rig.handles.tag[i] == 2)
            rig.handles.tag[i] = i + 1 == rig.handles.tag.size() ? 2 : 1;
    ASSERT_EQ(std::count(rig.handles.tag.begin(), rig.handles.tag.end(), 2), 1);
    rig.deformer = PrepareDeformer(rig.arrays, rig.handles, rig.param);
    Motion up, turn;
    up.matrix.topRightCorner<3, 1>() << 2, 0, 0;
    const Vector3d at = rig.shape.position.back();
    turn = Motion(
        (Eigen::Translation3d(at) * Eigen::AngleAxisd(1, Vector3d::UnitY()) * Eigen::Translation3d(-at)).matrix());
    SequenceSolver solver(*rig.deformer, rig.handles.world, {{{2, up}}, {{2, turn}}}, rig.param);
    const Matrix3Xd none = rig.Carried(solver.Go({100, 0}));
    EXPECT_LT((rig.Carried(solver.Go({100, 1e-6})) - none).cwiseAbs().maxCoeff(), 1e-4);
    SequenceSolver alone(*rig.deformer, rig.handles.world, {{{2, up}}}, rig.param);
    EXPECT_GT((rig.Carried(alone.Go({100})) - none).cwiseAbs().maxCoeff(), 1e-2); // it turns freely
}

TEST(SequenceFrames, AreWrittenAndTaken) {
    SequenceRig rig;
    rig.sequence.key = {{0, Easing::Linear, {0, 0}}, {0.5, Easing::Smooth, {100, 0}}, {1.1, Easing::Linear, {0, 100}}};
    const std::size_t n = rig.shape.position.size(), f = rig.shape.face.size();
    const auto run = [&](SequenceOutput output, unsigned threads = 0) {
        return WriteFrames(rig.arrays, rig.handles, *rig.deformer, rig.sequence, rig.motions, rig.param, output,
                           Threads(threads));
    };
    SequenceOutput output;
    output.rate = 4;
    std::vector<Matrix3Xd> frames;
    std::vector<std::size_t> keys;
    double most = -1, error = 0; // of the frame that is bent most
    const auto look = [&](const Deformer::Pose &pose) {
        if (pose.energy > most) {
            most = pose.energy;
            error = rig.deformer->DiscretisationError(pose, rig.param);
        }
    };
    output.frame = [&](std::size_t number, const Deformer::Pose &pose, const Matrix3Xd &position) {
        EXPECT_EQ(number, frames.size());
        frames.push_back(position);
        look(pose);
    };
    output.keyFrame = [&](std::size_t number, const Deformer::Pose &pose, const Matrix3Xd &) {
        keys.push_back(number);
        look(pose);
    };
    Bytes cache, mdd, gltf, again;
    output.pc2 = cache.Write();
    output.mdd = mdd.Write();
    output.gltf = gltf.Write();
    const SequenceReport report = run(output);
    EXPECT_EQ(frames.size(), 6u); // at 0, 0.25, 0.5, 0.75, 1, 1.25 s
    EXPECT_EQ(report.frames, 7u); // and the last key frame
    EXPECT_EQ(keys, (std::vector<std::size_t>{0, 1, 2}));
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.difference, 0);
    EXPECT_EQ(report.discretisationError, error);
    EXPECT_GT(error, 0);
    EXPECT_TRUE(SameBits(frames[0], SurfaceView(rig.arrays).Copy()));

    ASSERT_EQ(cache.content.size(), 32 + 6 * n * 12);
    EXPECT_EQ(cache.content.compare(0, 12, std::string("POINTCACHE2\0", 12)), 0);
    EXPECT_EQ(cache.At<std::int32_t>(12), 1);
    EXPECT_EQ(cache.At<std::int32_t>(16), std::int32_t(n));
    EXPECT_EQ(cache.At<float>(20), 0.f);
    EXPECT_EQ(cache.At<float>(24), 1.f);
    EXPECT_EQ(cache.At<std::int32_t>(28), 6);
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t v = 0; v < n; ++v)
            for (std::size_t d = 0; d < 3; ++d)
                ASSERT_EQ(cache.At<float>(32 + 12 * (i * n + v) + 4 * d),
                          float(frames[i](Eigen::Index(d), Eigen::Index(v))));

    std::string words = mdd.content; // from big-endian
    ASSERT_EQ(words.size(), 8 + 6 * 4 + 6 * n * 12);
    for (std::size_t at = 0; at < words.size(); at += 4)
        std::reverse(words.begin() + std::ptrdiff_t(at), words.begin() + std::ptrdiff_t(at + 4));
    const Bytes read{words};
    EXPECT_EQ(read.At<std::int32_t>(0), 6);
    EXPECT_EQ(read.At<std::int32_t>(4), std::int32_t(n));
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(read.At<float>(8 + 4 * i), 0.25F * float(i));
    EXPECT_EQ(words.substr(8 + 6 * 4), cache.content.substr(32));

    EXPECT_EQ(gltf.content.compare(0, 4, "glTF"), 0);
    EXPECT_EQ(gltf.At<std::uint32_t>(8), gltf.content.size());
    const std::size_t json = gltf.At<std::uint32_t>(12), buffer = 20 + json + 8;
    EXPECT_EQ(json % 4, 0u);
    EXPECT_EQ(gltf.content.size(), buffer + 6 * 4 + 36 * 4 + f * 12 + 7 * n * 24);
    const std::size_t rest = buffer + 6 * 4 + 36 * 4 + f * 12;
    Eigen::AlignedBox3d box;
    for (const Vector3d &p : rig.shape.position)
        box.extend(p);
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t v = 0; v < n; ++v)
            for (std::size_t d = 0; d < 3; ++d) {
                const auto number = [&](std::size_t shape) {
                    return double(gltf.At<float>(rest + shape * n * 24 + 12 * v + 4 * d));
                };
                ASSERT_NEAR(box.center()[Eigen::Index(d)] + number(0) + number(i + 1),
                            frames[i](Eigen::Index(d), Eigen::Index(v)), 1e-6 * box.diagonal().norm());
            }
    output.frame = output.keyFrame = nullptr;
    output.pc2 = output.mdd = nullptr;
    output.gltf = again.Write();
    run(output, 1);
    EXPECT_TRUE(gltf.content == again.content); // with other outputs, and any number of threads
    Bytes alone;
    output.gltf = nullptr;
    output.mdd = alone.Write();
    run(output, 1);
    EXPECT_TRUE(mdd.content == alone.content);
    output.mdd = nullptr;

    Bytes poses;
    output.gltf = poses.Write();
    output.shapes = SequenceOutput::EachPose;
    output.name = "a \"tube\"\n";
    const SequenceReport mixed = run(output);
    EXPECT_GT(mixed.difference, 0.01); // they turn by a lot
    EXPECT_NE(poses.content.find("\"a \\\"tube\\\"\\u000a\""), std::string::npos);
    EXPECT_NE(poses.content.find("\"targetNames\":[\"bent\",\"turned\"]"), std::string::npos);

    output.gltf = nullptr;
    EXPECT_NE(MessageOf<BadInput>([&] { run(output); }).find("There is nothing to make from the poses"),
              std::string::npos);
}

TEST(SequenceFrames, TakeOtherSurfacesAlong) {
    SequenceRig rig;
    rig.sequence.key = {{0, Easing::Linear, {0, 0}}, {1, Easing::Linear, {100, 0}}};
    MeshD quad(Quad());
    Arrays arrays = Read(quad);
    SequenceOutput output;
    output.rate = 4;
    int calls = 0;
    Companion eye;
    eye.surface = arrays;
    eye.world = Affine3d(Eigen::Translation3d(0, 0, 7));
    eye.name = "eye";
    eye.carry = [&](const Carrier &, Matrix3Xd &position) {
        EXPECT_TRUE(SameBits(position, SurfaceView(arrays).Copy())); // at rest, each time
        position.row(0).array() += ++calls;
    };
    output.companions.push_back(eye);
    Bytes gltf, cache;
    const auto run = [&] {
        return WriteFrames(rig.arrays, rig.handles, *rig.deformer, rig.sequence, rig.motions, rig.param, output);
    };
    output.pc2 = cache.Write();
    run();
    EXPECT_EQ(calls, 0); // a point cache only has the surface
    output.gltf = gltf.Write();
    EXPECT_EQ(run().frames, 5u);
    EXPECT_EQ(calls, 5);
    EXPECT_NE(gltf.content.find("\"name\":\"eye\",\"translation\":[0.5,0.5,7]"), std::string::npos);
    for (std::size_t i = 0; i < 5; ++i) { // the file ends with the last frame's positions, then its normals
        const std::size_t n = quad.vert.size(), at = gltf.content.size() - (2 * (5 - i)) * 12 * n;
        EXPECT_EQ(gltf.At<float>(at), float(i + 1));
        EXPECT_EQ(gltf.At<float>(at + 4), 0.f);
    }
    output.shapes = SequenceOutput::EachPose;
    calls = 0;
    EXPECT_GT(run().difference, 0.9); // also of the eye, which moves differently
    EXPECT_EQ(calls, 2 + 5);

    quad.vert[2].P()[1] = std::numeric_limits<double>::quiet_NaN();
    arrays = Read(quad);
    output.companions[0].surface = arrays;
    EXPECT_NE(
        MessageOf<BadInput>(run).find("Vertex 2 of 'eye' has a coordinate that is not a finite number. Remove it"),
        std::string::npos);
    output.companions[0].surface.vertexSlots = 0;
    EXPECT_EQ(MessageOf<BadInput>(run), "'eye' has no vertices. Leave it out.");
}

/// An animation with a shape for each frame.
static MorphAnimation FramesOf(int frames) {
    MorphAnimation animation;
    for (int i = 0; i < frames; ++i) {
        animation.time.push_back(i);
        animation.target.push_back("frame");
    }
    return animation;
}

TEST(GltfFile, DoesNotGrowBeyondItsFormat) {
    MeshD mesh(Points(Grid(100, 101)));
    const Arrays arrays = Read(mesh);
    const PackedSurface packed{SurfaceView(arrays)};
    const SurfaceLook look;
    const Matrix3Xd position = SurfaceView(arrays).Copy();
    Bytes file;
    const auto message = [&](int frames) {
        return MessageOf<BadInput>([&] {
            GltfFile(file.Write(), {{"many", packed, look, position, position}}, FramesOf(frames));
        });
    };
    EXPECT_NE(message(40000).find("A .glb file holds 4 GB, and this one would take "), std::string::npos);
    EXPECT_EQ(message(65537),
              "A .glb file holds 65536 frames with a shape each, and this one would have 65537. Write fewer "
              "frames, a shape for each pose instead of each frame, or a .pc2 or .mdd file.");
    EXPECT_TRUE(file.content.empty());
}

TEST(FrameFiles, RefuseWhatSinglePrecisionCannotHold) {
    MeshD mesh(Points(Quad()));
    const Arrays arrays = Read(mesh);
    const PackedSurface packed{SurfaceView(arrays)};
    const SurfaceLook look;
    Matrix3Xd position = SurfaceView(arrays).Copy();
    Bytes file;
    const std::string tooFar = "A vertex is farther away than single precision allows in this file (3e38). Scale the "
                               "scene, or leave that mesh out.";
    MorphAnimation late = FramesOf(2);
    late.time = {1e9, 1e9 + 1};
    EXPECT_EQ(MessageOf<BadInput>([&] {
                  GltfFile(file.Write(), {{"late", packed, look, position, position}}, late);
              }),
              "A .glb file has single-precision times, in which some frames would be at the same time. Move the "
              "first key frame nearer to 0 s.");
    EXPECT_EQ(MessageOf<BadInput>([&] { PointCacheFile(file.Write(), packed, late.time, 1, PointCacheFile::Mdd); }),
              "A .mdd file has single-precision times, in which some frames would be at the same time. Move the "
              "first key frame nearer to 0 s.");
    position *= 1e200;
    EXPECT_EQ(MessageOf<BadInput>([&] {
                  GltfFile(file.Write(), {{"far", packed, look, position, position}}, FramesOf(2));
              }),
              tooFar);
    for (const PointCacheFile::Format format : {PointCacheFile::Pc2, PointCacheFile::Mdd})
        EXPECT_EQ(MessageOf<BadInput>([&] { PointCacheFile(file.Write(), packed, {0}, 1, format).Add(position); }),
                  tooFar);
}

TEST(GltfFile, OfManyFramesHoldsOnlyTheWeightsThatAreNotZero) {
    MeshD mesh(Points(Quad()));
    const Arrays arrays = Read(mesh);
    const PackedSurface packed{SurfaceView(arrays)};
    const SurfaceLook look;
    Matrix3Xd position = SurfaceView(arrays).Copy();
    for (const int frames : {1024, 1025, 3000}) {
        Bytes file;
        GltfFile gltf(file.Write(), {{"many", packed, look, position, position}}, FramesOf(frames));
        for (int i = 0; i < frames; ++i)
            gltf.Add(0, position, position);
        gltf.Finish();
        EXPECT_EQ(file.At<std::uint32_t>(8), file.content.size());
        const std::size_t json = file.At<std::uint32_t>(12), buffer = 20 + json + 8, n = std::size_t(frames);
        const std::size_t shapes = 4 * 12 * (n + 1);
        const bool isSparse = frames > 1024;
        const std::string sparse = "{\"sparse\":{\"count\":" + std::to_string(n) +
                                   ",\"indices\":{\"bufferView\":" + std::to_string(3 + n) +
                                   ",\"componentType\":5125},\"values\":{\"bufferView\":1}},\"componentType\":5126,"
                                   "\"count\":" +
                                   std::to_string(n * n) + ",\"type\":\"SCALAR\"}";
        EXPECT_EQ(file.content.find(sparse) != std::string::npos, isSparse);
        ASSERT_EQ(file.content.size(), buffer + 4 * n + (isSparse ? 8 * n : 4 * n * n) + shapes);
        for (std::size_t i = 0; i < n; i += 7)
            if (isSparse) {
                ASSERT_EQ(file.At<float>(buffer + 4 * n + 4 * i), 1.f);
                ASSERT_EQ(file.At<std::uint32_t>(file.content.size() - 4 * n + 4 * i), i * n + i);
            } else {
                ASSERT_EQ(file.At<float>(buffer + 4 * n + 4 * (i * n + i)), 1.f);
            }
    }
}

TEST(FaceNormals, AreThoseOfTheFacesThatAreThere) {
    MeshD mesh(Sphere(12, 24));
    mesh.face[5].SetD();
    --mesh.fn;
    const Arrays arrays = Read(mesh);
    const SurfaceView view = arrays;
    Matrix3Xd normal(3, view.vertexSlots), again = normal;
    FaceNormals(view, view.position, normal.data(), 1);
    FaceNormals(view, view.position, again.data(), 3);
    EXPECT_TRUE(SameBits(normal, again));
    for (std::size_t i = 0; i < view.vertexSlots; ++i)
        EXPECT_GT(normal.col(Eigen::Index(i)).dot(view.At(i).normalized()), 0.97);
}
