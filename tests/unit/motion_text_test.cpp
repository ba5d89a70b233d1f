// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/handles/motion_text.h>
#include <vcg_ext/base/words.h>
#include "test_support.h"

#include <limits>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Matrix4d;
using Eigen::Vector3d;

static const Vector3d barycenter(3, -1, 2);

static Matrix4d Shift(double x, double y, double z) {
    Matrix4d m = Matrix4d::Identity();
    m.topRightCorner<3, 1>() << x, y, z;
    return m;
}

static Matrix4d About(const Vector3d &point, const Eigen::Matrix3d &linear) {
    Matrix4d m = Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = linear;
    m.topRightCorner<3, 1>() = point - linear * point;
    return m;
}

static Eigen::Matrix3d Rotated(const Vector3d &axis, double degrees) {
    return Eigen::AngleAxisd(degrees * M_PI / 180, axis.normalized()).toRotationMatrix();
}

static Eigen::Matrix3d Scaled(double x, double y, double z) { return Vector3d(x, y, z).asDiagonal(); }

/// The motion of handle 2, which the text must be about.
static Motion MotionOf(const std::string &steps) {
    const auto read = ReadMotionText("2: " + steps);
    EXPECT_EQ(read.size(), 1u);
    return ToMotion(read.at(2), barycenter);
}

static void ExpectMatrix(const std::string &steps, const Matrix4d &wanted) {
    const Matrix4d m = MotionOf(steps).matrix;
    EXPECT_LE((m - wanted).norm(), 1e-12 * wanted.norm()) << steps << "\n" << m;
}

TEST(MotionText, ReadsEachStep) {
    ExpectMatrix("translate 1 2.5 -3e1", Shift(1, 2.5, -30));
    ExpectMatrix("rotate 0 0 2 90", About(barycenter, Rotated(Vector3d(0, 0, 1), 90)));
    ExpectMatrix("rotate 1 2 3 -30 about 4 5 6", About(Vector3d(4, 5, 6), Rotated(Vector3d(1, 2, 3), -30)));
    ExpectMatrix("scale 2", About(barycenter, Scaled(2, 2, 2)));
    ExpectMatrix("scale 2 about 1 1 1", About(Vector3d(1, 1, 1), Scaled(2, 2, 2)));
    ExpectMatrix("scale 2 0.5 1", About(barycenter, Scaled(2, 0.5, 1)));
    ExpectMatrix("scale 2 0.5 1 about 0 0 0", About(Vector3d(0, 0, 0), Scaled(2, 0.5, 1)));
    Matrix4d m;
    m << 1, 2, 3, 4, 0, 6, 7, 8, 0, 0, 11, 12, 0, 0, 0, 1;
    ExpectMatrix("matrix 1 2 3 4  0 6 7 8  0 0 11 12  0 0 0 1", m);
}

TEST(MotionText, ReadsWhatStepsAreMadeOf) {
    const Vector3d v(1, 2.5, 30);
    Matrix4d m = Matrix4d::Identity();
    m(0, 1) = 0.5;
    for (const auto &[steps, step] : std::vector<std::pair<std::string, MotionStep>>{
             {"translate 1 2.5 30", MotionStep::Translate(v)},
             {"rotate 1 2.5 30 40", MotionStep::Rotate(v, 40)},
             {"scale 1 2.5 30", MotionStep::Scale(v)},
             {"matrix 1 0.5 0 0 0 1 0 0 0 0 1 0 0 0 0 1", MotionStep::Affine(m)}})
        EXPECT_TRUE(SameBits(MotionOf(steps).matrix, ToMotion({step}, barycenter).matrix)) << steps;
}

TEST(MotionText, RotatesCounterclockwiseWhenTheAxisPointsAtYou) {
    const Motion motion = MotionOf("rotate 0 0 1 90 about 0 0 0");
    EXPECT_LE((motion.matrix * Eigen::Vector4d(1, 0, 0, 1) - Eigen::Vector4d(0, 1, 0, 1)).norm(), 1e-15);
}

TEST(MotionText, AppliesStepsInTheOrderWritten) {
    const Eigen::Matrix3d r = Rotated(Vector3d(0, 0, 1), 90);
    const Vector3d o(0, 0, 0), moved = barycenter + Vector3d(5, 0, 0);
    ExpectMatrix("translate 5 0 0 rotate 0 0 1 90 about 0 0 0", About(o, r) * Shift(5, 0, 0));
    ExpectMatrix("rotate 0 0 1 90 about 0 0 0 translate 5 0 0", Shift(5, 0, 0) * About(o, r));
    // Earlier steps have moved the barycentre.
    ExpectMatrix("translate 5 0 0 rotate 0 0 1 90", About(moved, r) * Shift(5, 0, 0));
    ExpectMatrix("translate 5 0 0 scale 2 rotate 0 0 1 90",
                 About(moved, r) * About(moved, Scaled(2, 2, 2)) * Shift(5, 0, 0));
    ExpectMatrix("scale 2 about 0 0 0 scale 3", About(2 * barycenter, Scaled(3, 3, 3)) * About(o, Scaled(2, 2, 2)));
}

TEST(MotionText, ReadsAClauseForEachHandle) {
    const auto read = ReadMotionText("2: rotate 0 0 1 135 about 0 0 0 translate 0 0 5; 3: translate 1 0 0");
    ASSERT_EQ(read.size(), 2u);
    ASSERT_EQ(read.at(2).size(), 2u);
    EXPECT_EQ(read.at(2)[0].kind, MotionStep::Rotation);
    EXPECT_EQ(read.at(2)[0].degrees, 135);
    EXPECT_EQ(*read.at(2)[0].about, Vector3d(0, 0, 0));
    EXPECT_EQ(read.at(2)[1].kind, MotionStep::Translation);
    ASSERT_EQ(read.at(3).size(), 1u);
    EXPECT_EQ(read.at(3)[0].vector, Vector3d(1, 0, 0));
    EXPECT_FALSE(read.at(3)[0].about);
}

TEST(MotionText, IsFreeInWhitespaceCaseAndCommas) {
    for (const char *text : {"2:translate 1 2 3;7:scale 2;", "  2 :\n\tTRANSLATE\r\n1,2 ,3\n;\f7: Scale\v2 ; ",
                             "2:translate 1, 2,\n 3 ;7:scale +2", "7:sCaLe 2.0;2:translate 1e0 .2e1 30e-1"}) {
        const auto read = ReadMotionText(text);
        ASSERT_EQ(read.size(), 2u) << text;
        EXPECT_EQ(read.at(2).at(0).vector, Vector3d(1, 2, 3));
        EXPECT_EQ(read.at(7).at(0).vector, Vector3d(2, 2, 2));
    }
}

TEST(MotionText, MayBeEmpty) {
    EXPECT_TRUE(ReadMotionText("").empty());
    EXPECT_TRUE(ReadMotionText(" \n\t ").empty());
}

TEST(MotionText, NumbersComeBackToTheBit) {
    std::mt19937_64 random(1);
    std::string text = "2147483647:";
    std::vector<Vector3d> written;
    for (int i = 0; i < 3000; ++i) {
        Vector3d v;
        for (double &x : v)
            do { // any bits that are a normal number
                const std::uint64_t bits = random();
                std::memcpy(&x, &bits, sizeof bits);
            } while (!std::isnormal(x));
        if (i == 0)
            v << -0.0, std::numeric_limits<double>::max(), std::numeric_limits<double>::denorm_min();
        text += " translate";
        for (double x : v)
            text += " " + detail::ToText(x);
        written.push_back(v);
    }
    const auto read = ReadMotionText(text);
    ASSERT_EQ(read.begin()->second.size(), written.size());
    for (std::size_t i = 0; i < written.size(); ++i)
        EXPECT_TRUE(SameBits(read.begin()->second[i].vector, written[i]));
}

TEST(MotionText, TranslationsAreExact) {
    const Matrix4d m = MotionOf("translate 0.25 -1.5 1024").matrix;
    EXPECT_TRUE(SameBits(m, Shift(0.25, -1.5, 1024)));
}

TEST(MotionText, DoesNotDependOnTheLocale) {
    const CommaLocale locale;
    if (!locale.set)
        GTEST_SKIP() << CommaLocale::missing;
    ExpectMatrix("translate 1.5 2,5 ", Shift(1.5, 2, 5));
}

TEST(MotionText, ReadsNumbersOfThousandsOfDigits) {
    const std::string zeros(5000, '0'), nines(5000, '9');
    ExpectMatrix("translate " + zeros + "1." + nines + " 1" + zeros + "e-5000 0", Shift(2, 1, 0));
    for (const std::string &text :
         {"2: scale " + nines, "2: scale 1e" + nines, "2: scale 1e-" + nines, nines + ": scale 1"})
        EXPECT_NE(MessageOf<Error>([&] { ReadMotionText(text); }).find("expected"), std::string::npos);
}

// --- errors ---

TEST(MotionText, TellsOfDecimalCommas) {
    const auto isTold = [](const std::string &steps) {
        const std::string message = MessageOf<Error>([&] { ReadMotionText("2: " + steps); });
        EXPECT_NE(message.find("expected"), std::string::npos) << steps;
        return message.find("write decimals with a point, as in 0.5.") != std::string::npos;
    };
    for (const char *meant : {"translate 0,5 0 1", "rotate 0 0 1 22,5", "scale 1,5", "scale 1 1 1,5; 3: scale 2",
                              "rotate 1 0 0 30 about 0,5 0 1", "rotate 0 0 1 30 about 0 0 0,5,5"})
        EXPECT_TRUE(isTold(meant)) << meant;
    for (const char *other : {"translate 0,0,1 about", "translate 0 5", "translate 0, 5 0 1", "rotate 0,0,1 30 foo",
                              "translate 0,0,1 scale 1 2"})
        EXPECT_FALSE(isTold(other)) << other;
}

TEST(MotionText, SaysWhereWhatWasFoundAndWhatExpected) {
    struct Case {
        std::string text;
        int character;
        std::vector<const char *> words;
    };
    const std::string nul("2: trans\0late 1 0 0", 19);
    for (const Case &c : std::vector<Case>{
             {";", 1, {"tag", "';'"}},
             {"nonsense", 1, {"tag", "'nonsense'"}},
             {"translate 1 0 0", 1, {"tag", "'translate'"}},
             {"2 translate 1 0 0", 3, {"':'", "'translate'", "tag 2"}},
             {"2", 2, {"':'", "the end"}},
             {"2:", 3, {"'translate'", "'matrix'", "the end"}},
             {"2:;", 3, {"'translate'", "';'"}},
             {"2: ; 3: translate 1 0 0", 4, {"'translate'", "';'"}},
             {"2: move 1 0 0", 4, {"'translate'", "'rotate'", "'scale'", "'matrix'", "'move'"}},
             {"2: about 0 0 0", 4, {"'about'"}},
             {"2: translate 1 0 0 about 0 0 0", 20, {"'about'"}},
             {"2: translate", 13, {"number 1 of 3", "the end", "'translate'"}},
             {"2: translate 1 0", 17, {"number 3 of 3", "the end"}},
             {"2: translate 1 0; 3: scale 2", 17, {"number 3 of 3", "';'"}},
             {"2: translate 1 0 rotate 0 0 1 5", 18, {"number 3 of 3", "'rotate'"}},
             {"2: translate 1 zero 0", 16, {"number 2 of 3", "'zero'"}},
             {"2: translate 1 0 0 0", 20, {"';'", "'0'"}},
             {"2: translate 1 0 0,", 19, {"','"}},
             {"2: translate ,1 0 0", 14, {"number 1 of 3", "','"}},
             {"2: translate 1 0x1 0", 16, {"'0x1'"}},
             {"2: translate 1 1.2.3 0", 16, {"'1.2.3'"}},
             {"2: translate 1e999 0 0", 14, {"'1e999'"}},
             {"2: translate nan 0 0", 14, {"finite", "'nan'"}},
             {"2: translate 0 inf 0", 16, {"finite", "'inf'"}},
             {"2: scale nan", 10, {"finite", "'nan'"}},
             {"2: scale -infinity", 10, {"finite", "'-infinity'"}},
             {"2: scale 0", 4, {"greater than 0"}},
             {"2: scale -1", 4, {"greater than 0"}},
             {"2: scale 1 1 -0.5", 4, {"greater than 0"}},
             {"2: scale", 9, {"number 1 of 1", "s, or sx sy sz"}},
             {"2: scale 1 2", 13, {"number 3 of 3", "the end"}},
             {"2: scale 1 2 3 4", 16, {"'4'"}},
             {"2: scale 1,5", 13, {"number 3 of 3"}},
             {"2: scale 1, about 0 0 0", 13, {"number 2 of 3", "'about'"}},
             {"2: scale 1 about 0 0", 21, {"number 3 of 3", "'about'"}},
             {"2: rotate 0 0 0 90", 4, {"axis", "0 0 0"}},
             {"2: rotate 0 0 -0 90", 4, {"axis"}},
             {"2: rotate 0 0 1 about 0 0 0", 17, {"number 4 of 4", "degrees", "'about'"}},
             {"2: rotate 0 0 1 90 about 0 0 0 about 0 0 0", 32, {"'about'"}},
             {"2: matrix 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0", 40, {"number 16 of 16", "the end"}},
             {"2: matrix 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0.5 1", 4, {"affine", "0 0 0 1"}},
             {"2: matrix 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 7", 43, {"'7'"}},
             {"2: scale 2; 2: scale 3", 13, {"handle 2", "second time"}},
             {"1: scale 2", 1, {"from 2", "'1'"}},
             {"0: scale 2", 1, {"from 2"}},
             {"-2: scale 2", 1, {"from 2", "'-2'"}},
             {"2.5: scale 2", 1, {"whole", "'2.5'"}},
             {"2147483648: scale 2", 1, {"'2147483648'"}},
             {"2: scale 2;; 3: scale 2", 12, {"tag", "';'"}},
             {"2: scale 2: 3", 11, {"':'"}},
             {"2: scale 2 3: scale 3", 13, {"number 3 of 3", "':'"}},
             {"2: translate 1 0 0 3: scale 3", 20, {"';'", "'3'"}},
             {"2: scale 2 trailing", 12, {"'trailing'"}},
             {"2: scale 2; garbage", 13, {"tag", "'garbage'"}},
             {nul, 4, {"'trans?late'"}},
             {"2: \xC3\xA4\xC3\xB6 x", 4, {"'\xC3\xA4\xC3\xB6'"}},
             {"2: scale 1 \xE2\x82\xAC", 12, {"'\xE2\x82\xAC'"}},
             {"2: a\xFF\xE2\x82 x", 4, {"'a?\?\?'"}},
             {"\xFF\xFE\x00", 1, {"tag"}},
         }) {
        const std::string message = MessageOf<Error>([&] { ReadMotionText(c.text); });
        EXPECT_EQ(message.find("transforms, character " + std::to_string(c.character) + ": "), 0u) << c.text << "\n"
                                                                                                   << message;
        for (const char *word : c.words)
            EXPECT_NE(message.find(word), std::string::npos) << c.text << "\n" << message;
    }
}

TEST(MotionText, CountsCharactersNotBytes) {
    // Only messages about a bad word can follow such a character.
    const std::string message = MessageOf<Error>([] { ReadMotionText("2: scale 1 about \xC3\xA4 0 0", "Motions"); });
    EXPECT_EQ(message.find("Motions, character 18: "), 0u) << message;
}

TEST(Words, AreShownAsTheyAreWhereTheyArePrintable) {
    using detail::Printable;
    for (const char *good : {"plain ~", "\xC3\xA9", "\xE2\x82\xAC", "\xE0\xA4\x85", "\xED\x9F\xBF", "\xF0\x9F\x98\x80",
                             "\xF4\x8F\xBF\xBF"})
        EXPECT_EQ(Printable(good, 40), good);
    for (const char *bad : {"\x01", "\x7F", "\x80", "\xC3", "\xC1\xA9", "\xC2\x85", "\xE0\x9F\xBF", "\xED\xA0\x80",
                            "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xE2\x82", "\xFF"})
        EXPECT_EQ(Printable(bad, 40), std::string(std::strlen(bad), '?'));
    EXPECT_EQ(Printable("12\xE2\x82\xAC", 4), "12"); // no half of a character
    EXPECT_EQ(Printable("12\xE2\x82\xAC", 5), "12\xE2\x82\xAC");
}

TEST(MotionText, CutsALongWordShort) {
    EXPECT_LT(MessageOf<Error>([] { ReadMotionText("2: " + std::string(1000000, 'x')); }).size(), 300u);
}

TEST(MotionText, ReadsALongText) {
    std::string text;
    for (int tag = 2; tag < 100000; ++tag)
        text += std::to_string(tag) + ": translate 1 2 3 scale 2 about 0 0 0;\n";
    EXPECT_EQ(ReadMotionText(text).size(), 99998u);
}

TEST(MotionText, RefusesWhatIsNoMotion) {
    for (const char *steps : {"matrix -1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "matrix 1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1",
                              "scale 1e300 scale 1e300", "translate 1e308 0 0 translate 1e308 0 0", "scale 1 1 1e-20"})
        EXPECT_FALSE(MessageOf<Error>([&] { MotionOf(steps); }).empty()) << steps;
    EXPECT_NO_THROW(MotionOf("rotate 1e-300 0 0 90"));
    ExpectMatrix("rotate 1e200 1e200 0 90", About(barycenter, Rotated(Vector3d(1, 1, 0), 90)));
}

TEST(MotionText, AnyBytesAreReadOrRefused) {
    const std::vector<std::string> seeds{
        "2: rotate 0 0 1 135 about 0 0 0 translate 0 0 5; 3: translate 1 0 0",
        "2: scale 2 about 1 2 3 scale 1, 2, 3; 4: matrix 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1;",
        "2:rotate 1 1 1 720 rotate 1 1 1 -1e3;3:translate +1 -.5 1e-3", ""};
    const std::vector<std::string> words{"translate ", "rotate ", "scale ", "matrix ", "about ", ":",   ";",     ",",
                                         " ",          "1",       "-1e308", "0",       "2:",     "nan", "1e999", "\n"};
    std::mt19937 random(1);
    auto pick = [&](std::size_t n) { return std::size_t(random() % n); };
    const int texts = sanitized ? 10000 : 300000; // the fuzzer has its own sanitizers
    int read = 0, refused = 0;
    for (int i = 0; i < texts; ++i) {
        std::string text = seeds[pick(seeds.size())];
        for (std::size_t changes = pick(6); changes-- > 0;) {
            const std::size_t at = pick(text.size() + 1);
            switch (random() % 5) {
            case 0: text.insert(at, 1, char(random())); break;
            case 1: text.insert(at, words[pick(words.size())]); break;
            case 2: text.erase(at, pick(10)); break;
            case 3: text.insert(at, text.substr(pick(text.size() + 1), pick(30))); break;
            case 4:
                if (at < text.size())
                    text[at] = char(random());
                break;
            }
        }
        try {
            for (const auto &clause : ReadMotionText(text)) {
                ASSERT_GE(clause.first, 2);
                ASSERT_FALSE(clause.second.empty());
                const Motion motion = ToMotion(clause.second, barycenter);
                ASSERT_TRUE(motion.matrix.allFinite()) << text;
                if (i % 16 == 0)
                    motion.At(50, barycenter);
            }
            ++read;
        } catch (const Error &) {
            ++refused;
        }
    }
    EXPECT_GT(read, texts / 30);
    EXPECT_GT(refused, texts / 30);
}

// --- turns ---

/// The angle about z, degrees, at pose 50, of a motion that must rotate about it.
static double HalfWay(const std::string &steps) {
    const Matrix4d m = MotionOf(steps).At(50, barycenter);
    EXPECT_LE(m.block(0, 2, 2, 1).norm() + m.block(2, 0, 1, 2).norm(), 1e-9) << steps;
    return std::atan2(m(1, 0), m(0, 0)) * 180 / M_PI;
}

TEST(MotionText, HonoursTheAngleThatIsGiven) {
    EXPECT_NEAR(HalfWay("rotate 0 0 1 90"), 45, 1e-9);
    EXPECT_NEAR(HalfWay("rotate 0 0 1 270"), 135, 1e-9);
    EXPECT_NEAR(HalfWay("rotate 0 0 1 -270"), -135, 1e-9);
    EXPECT_NEAR(HalfWay("rotate 0 0 -3 270"), -135, 1e-9);
    EXPECT_NEAR(std::abs(HalfWay("rotate 0 0 1 360")), 180, 1e-9);
    EXPECT_NEAR(HalfWay("rotate 0 0 1 180"), 90, 1e-9);
    EXPECT_NEAR(HalfWay("rotate 0 0 1 -180"), -90, 1e-9);
    EXPECT_NEAR(HalfWay("rotate 0 0 1 900"), 90, 1e-9);
    // Angles about one axis add up, whatever steps without rotation lie between.
    EXPECT_NEAR(HalfWay("rotate 0 0 1 200 rotate 0 0 2 70"), 135, 1e-9);
    EXPECT_NEAR(HalfWay("rotate 0 0 1 300 translate 1 2 3 rotate 0 0 -1 30 about 0 0 0"), 135, 1e-9);
    EXPECT_NEAR(HalfWay("scale 2 rotate 0 0 1 270 translate 1 2 3"), 135, 1e-9);
    EXPECT_NEAR(HalfWay("matrix 1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1 rotate 0 0 1 270"), 135, 1e-9);
    // Two axes, or a matrix that rotates: the shortest way.
    EXPECT_NEAR(HalfWay("rotate 1 0 0 360 rotate 0 0 1 270"), -45, 1e-9);
    EXPECT_NEAR(HalfWay("matrix 0 -1 0 0 1 0 0 0 0 0 1 0 0 0 0 1 rotate 0 0 1 200"), -35, 1e-9);
    EXPECT_NEAR(HalfWay("matrix 0 -1 0 0 1 0 0 0 0 0 1 0 0 0 0 1"), 45, 1e-9);
}

TEST(MotionText, TurnsAboutThePointThatIsGiven) {
    const Vector3d point(10, 0, 0);
    for (double degrees : {200.0, 270.0, 360.0, -720.0})
        for (double percent : {10.0, 50.0, 90.0}) {
            const Matrix4d m =
                MotionOf("rotate 0 0 1 " + detail::ToText(degrees) + " about 10 0 0").At(percent, barycenter);
            const Matrix4d wanted = About(point, Rotated(Vector3d(0, 0, 1), degrees * percent / 100));
            EXPECT_LE((m - wanted).norm(), 1e-10) << degrees;
        }
}

TEST(MotionText, TurnsInPlaceWhileItIsShifted) {
    for (const char *steps :
         {"rotate 0 0 1 360 translate 4 0 2", "translate 4 0 2 rotate 0 0 1 360", "translate 4 0 2 rotate 0 0 1 270"}) {
        const Vector3d p = (MotionOf(steps).At(50, barycenter) * barycenter.homogeneous()).head<3>();
        EXPECT_LE((p - barycenter - Vector3d(2, 0, 1)).norm(), 1e-12) << steps;
    }
}

TEST(MotionText, AFullTurnIsTheIdentityToTheBit) {
    for (const char *steps : {"rotate 1 2 3 360 about 0 0 0", "rotate 1 2 3 -720 about 0 0 0"})
        EXPECT_EQ(MotionOf(steps).matrix, Matrix4d::Identity());
}

TEST(MotionText, IsReadAsItWasWrittenToTheBit) {
    const double third = 1.0 / 3, tiny = std::numeric_limits<double>::denorm_min();
    std::map<int, std::vector<MotionStep>> motion;
    motion[2] = {MotionStep::Translate(Vector3d(third, -1e300, tiny)),
                 MotionStep::Rotate(Vector3d(1, 2, third), -1234.1)};
    motion[2].back().about = Vector3d(0.1, 0.2, 0.3);
    motion[3] = {};
    Matrix4d m = Matrix4d::Identity();
    m(0, 1) = third;
    m(2, 3) = 1e-7;
    motion[70] = {MotionStep::Scale(Vector3d(third, 1, 3)), MotionStep::Affine(m)};
    const auto read = ReadMotionText(WriteMotionText(motion));
    ASSERT_EQ(read.size(), 2u); // 3 has no step
    for (int tag : {2, 70}) {
        ASSERT_EQ(read.at(tag).size(), motion[tag].size());
        for (std::size_t i = 0; i < motion[tag].size(); ++i) {
            const MotionStep &a = motion[tag][i], &b = read.at(tag)[i];
            EXPECT_EQ(a.kind, b.kind);
            EXPECT_EQ(a.vector, b.vector);
            EXPECT_EQ(a.degrees, b.degrees);
            EXPECT_EQ(a.about, b.about);
            EXPECT_EQ(a.matrix, b.matrix);
        }
    }
    EXPECT_EQ(WriteMotionText({}), "");
    EXPECT_EQ(WriteMotionText({{2, {MotionStep::Translate(Vector3d(0.5, 0, -2))}}}), "2: translate 0.5 0 -2");
}
