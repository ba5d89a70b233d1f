// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h>
#include <vcg_ext/handles/handle_file.h>
#include "test_support.h"

#include <filesystem>
#include <iterator>
#include <limits>
#include <locale>
#include <sstream>

using namespace vcg::fcd;
using namespace fcd_test;

/// A temporary file for each test.
class HandleFile : public testing::Test {
  protected:
    const std::string path = (std::filesystem::temp_directory_path() /
                              (std::string("fcd_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
                               "_" + std::to_string(std::random_device()()) + ".txt"))
                                 .string();

    void TearDown() override { std::filesystem::remove(path); }

    const std::string &Written(const std::string &text) const {
        std::ofstream(path, std::ios::binary) << text;
        return path;
    }
    std::vector<int> Tags(const std::string &text) const { return ReadTagFile(Written(text)); }
    std::string TagError(const std::string &text) const {
        return MessageOf<Error>([&] { Tags(text); });
    }
    std::string TransformError(const std::string &text) const {
        return MessageOf<Error>([&] { ReadTransformFile(Written(text)); });
    }
    std::string PointError(const std::string &text) const {
        return MessageOf<Error>([&] { ReadPointHandleFile(Written(text)); });
    }
    void ExpectNames(const std::string &message, int line, const std::string &word = {}) const {
        EXPECT_EQ(message.find("'" + path + "', line " + std::to_string(line) + ": "), 0u) << message;
        EXPECT_NE(message.find("expected"), std::string::npos) << message;
        EXPECT_NE(message.find(word), std::string::npos) << message;
    }
    /// Each reader must refuse the text with such a message.
    void ExpectAllRefuse(const std::string &text, int line, const std::string &word) const {
        ExpectNames(TagError(text), line, word);
        ExpectNames(TransformError(text), line, word);
        ExpectNames(PointError(text), line, word);
    }
};

static const std::string identity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

static std::vector<Eigen::Matrix4d> RandomMatrices(int n) {
    std::mt19937_64 random(1);
    std::vector<Eigen::Matrix4d> matrices(n);
    for (Eigen::Matrix4d &m : matrices)
        for (int i = 0; i < 16; ++i)
            do { // any bits that are a normal number
                const std::uint64_t bits = random();
                std::memcpy(&m(i), &bits, sizeof bits);
            } while (!std::isnormal(m(i)));
    return matrices;
}

TEST_F(HandleFile, TagsComeBack) {
    const std::vector<int> tag{
        0, 1, 2, -1, 7, 12345, std::numeric_limits<int>::max(), std::numeric_limits<int>::min(), 1000, 1};
    EXPECT_EQ(Tags(TagText(tag)), tag);
}

TEST_F(HandleFile, TransformsComeBackToTheBit) {
    std::vector<Eigen::Matrix4d> written = RandomMatrices(100);
    written[0](0) = -0.0;
    written[0](1) = std::numeric_limits<double>::max();
    written[0](2) = std::numeric_limits<double>::denorm_min();
    written[0](3) = 1e22;
    const std::vector<Eigen::Matrix4d> read = ReadTransformFile(Written(TransformText(written)));
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t i = 0; i < read.size(); ++i)
        EXPECT_TRUE(SameBits(read[i], written[i]));
}

TEST_F(HandleFile, TransformsAreRowByRow) {
    const auto m = ReadTransformFile(Written("1 2 3 4\n5 6 7 8\n9 10 11 12\n13 14 15 16\n" + identity));
    ASSERT_EQ(m.size(), 2u);
    EXPECT_EQ(m[0](0, 3), 4);
    EXPECT_EQ(m[0](3, 0), 13);
    EXPECT_EQ(m[1], Eigen::Matrix4d::Identity());
}

TEST_F(HandleFile, TakesAnyWhitespaceAndComments) {
    const std::vector<int> expected{0, 1, 2, -1};
    for (const char *text : {"0\n1\n2\n-1\n", "0 1 2 -1", "0\r\n1\r\n2\r\n-1\r\n", "\n\n0\t1 \t 2\n\n-1\n\n",
                             "# tags\n0 1 # two of them\n#\n2 -1#", "0#x\n1#1 1 1\n2\n-1 # end",
                             "\xEF\xBB\xBF"
                             "0 1 2 -1",
                             "\xEF\xBB\xBF# with a mark\r\n0 1\r\n2 -1", "+0 +1 +2 -1", "0\f1\v2\n-1"})
        EXPECT_EQ(Tags(text), expected) << text;
}

TEST_F(HandleFile, TakesNumbersOfAnyForm) {
    const auto m = ReadTransformFile(Written("+1 1e0 1.0e+0 1E-2 .5 5. -0 1e-310 " + std::string("0 0 0 0 0 0 0 1")));
    ASSERT_EQ(m.size(), 1u);
    const Eigen::Matrix<double, 1, 8> expected =
        (Eigen::Matrix<double, 1, 8>() << 1, 1, 1, 0.01, 0.5, 5, 0, 1e-310).finished();
    for (int i = 0; i < 8; ++i)
        EXPECT_EQ(m[0](i / 4, i % 4), expected[i]);
}

TEST_F(HandleFile, NamesTheFileThatIsMissing) {
    for (const auto &message :
         {MessageOf<Error>([&] { ReadTagFile(path); }), MessageOf<Error>([&] { ReadTransformFile(path); }),
          MessageOf<Error>([&] { ReadPointHandleFile(path); })})
        EXPECT_EQ(message, "Cannot open '" + path + "'.");
}

TEST_F(HandleFile, RefusesAFolder) {
    const std::string folder = std::filesystem::temp_directory_path().string();
    for (const auto &message :
         {MessageOf<Error>([&] { ReadTagFile(folder); }), MessageOf<Error>([&] { ReadTransformFile(folder); }),
          MessageOf<Error>([&] { ReadPointHandleFile(folder); })})
        EXPECT_EQ(message, "Cannot read '" + folder + "'.");
}

TEST_F(HandleFile, RefusesAnEmptyFile) {
    for (const char *text : {"", "# nothing", "\xEF\xBB\xBF", "#"}) {
        ExpectNames(TagError(text), 1, "holds no tags");
        ExpectNames(TransformError(text), 1, "0 numbers");
        ExpectNames(PointError(text), 1, "holds no points");
    }
    ExpectNames(TagError("\n\n"), 3);
    ExpectNames(TransformError("# nothing\n"), 2);
}

TEST_F(HandleFile, NamesTheLineOfAWordThatIsNoTag) {
    ExpectNames(TagError("0 1\n\n# x\n2 two\n"), 4, "'two'");
    ExpectNames(TagError("nonsense"), 1, "'nonsense'");
    ExpectNames(TagError("1\r\n1.5\r\n"), 2, "'1.5'");
    ExpectNames(TagError("1\n99999999999\n"), 2, "'99999999999'");
    for (const char *bad : {"1x", "0x1", "+", "-", "--1", "+-1", "++1", "1,2", "nan", "1e3"})
        ExpectNames(TagError(std::string("1 1\n1 ") + bad + " 1\n"), 2, bad);
    ExpectNames(TagError("1\nzw\xC3\xB6lf \x1B[31m"), 2, "'zw\xC3\xB6lf'");
}

TEST_F(HandleFile, NamesTheLineOfAWordThatIsNoNumber) {
    ExpectNames(TransformError("1 0 0 0\n0 one 0 0\n"), 2, "'one'");
    for (const char *bad : {"1,5", "0x1p3", "1e", "1e999", "-1e999", "1.2.3", "+-1", "--1"})
        ExpectNames(TransformError(std::string("1 0 0 0\n") + bad + " 0 0 0\n"), 2, bad);
    for (const char *bad : {"nan", "-nan", "inf", "-INF", "+infinity", "nan(1)"})
        ExpectNames(TransformError(std::string("1 0 0 0\n") + bad + " 0 0 0\n"), 2, "finite");
}

TEST_F(HandleFile, CutsALongWordShort) { EXPECT_LT(TagError(std::string(100000, 'x')).size(), path.size() + 200); }

TEST_F(HandleFile, LinesEndWithLfCrLfOrCr) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        EXPECT_EQ(Tags("# a comment" + end + "1" + end + "2 # another" + end + end + "-1"),
                  (std::vector<int>{1, 2, -1}));
        EXPECT_EQ(ReadTransformFile(Written("#" + end + identity)).size(), 1u);
        const std::vector<PointPair> pairs =
            ReadPointHandleFile(Written("vertex,x,y,z" + end + "7,1,2,3" + end + "8,4,5,6" + end));
        ASSERT_EQ(pairs.size(), 2u);
        EXPECT_EQ(pairs[1].vertex, 8);
        ExpectNames(TagError("1" + end + end + "two" + end), 3, "'two'");
        ExpectNames(TransformError("# 1" + end + "0 # 2" + end + "one" + end), 3, "'one'");
        ExpectNames(PointError("x" + end + "1 2 3 4 5" + end), 2, "5 numbers");
    }
    ExpectNames(TagError("1\n\r\n\r\r\n\rx"), 6, "'x'");
}

TEST_F(HandleFile, RefusesUtf16) {
    const std::string tags = "# tags\n0 1 2\n";
    std::string little, big;
    for (char c : tags) {
        little += {c, '\0'};
        big += {'\0', c};
    }
    ExpectAllRefuse("\xFF\xFE" + little, 1, "UTF-16");
    ExpectAllRefuse("\xFE\xFF" + big, 1, "UTF-16");
    ExpectAllRefuse(little, 1, "zero byte");
    ExpectAllRefuse(big, 1, "zero byte");
}

TEST_F(HandleFile, RefusesBinaryData) {
    ExpectAllRefuse("1 2 3\r4 5 6\n1 2\r\n" + std::string(1, '\0'), 4, "zero byte");
    std::mt19937 random(1);
    for (int i = 0; i < 100; ++i) {
        std::string text(std::size_t(100 << i % 8), '\0');
        for (char &c : text)
            c = char(random());
        for (const std::string &message : {TagError(text), TransformError(text), PointError(text)}) {
            EXPECT_EQ(message.find("'" + path + "', line "), 0u) << message;
            EXPECT_NE(message.find("expected"), std::string::npos) << message;
            EXPECT_EQ(detail::Printable(message, message.size()), message);
        }
    }
}

TEST_F(HandleFile, RefusesWhatIsCutOff) {
    const std::string text = "# a matrix\n" + identity;
    for (std::size_t length = 0; length + 1 < text.size(); ++length) // but for the last line break
        EXPECT_EQ(TransformError(text.substr(0, length)).find("'" + path + "', line "), 0u) << length;
    const std::string points = "1 2 3 40 50 60";
    for (std::size_t length = 0; length < points.size(); ++length) {
        std::istringstream words(points.substr(0, length));
        const auto count = std::distance(std::istream_iterator<std::string>(words), {});
        if (count == 4 || count == 6) // a prefix that is valid itself
            EXPECT_EQ(ReadPointHandleFile(Written(words.str())).size(), 1u);
        else
            ExpectNames(PointError(words.str()), 1);
    }
}

TEST_F(HandleFile, ReadsTenMillionTags) {
    const std::size_t n = sanitized ? 1000000 : 10000000;
    std::string text;
    for (std::size_t i = 0; i < n; ++i)
        text += i % 3 ? "0\n" : "12 ";
    const std::vector<int> tag = Tags(text);
    ASSERT_EQ(tag.size(), n);
    EXPECT_EQ(std::count(tag.begin(), tag.end(), 12), std::ptrdiff_t(n / 3 + 1));
    ExpectNames(TagError(text + "x"), int(n - n / 3), "'x'");
}

TEST_F(HandleFile, ReadsNumbersOfThousandsOfDigits) {
    const std::string zeros(5000, '0'), nines(5000, '9');
    EXPECT_EQ(Tags(zeros + "7 -" + zeros + "1"), (std::vector<int>{7, -1}));
    ExpectNames(TagError("1\n" + nines), 2, "'9999");
    const std::string rest = " 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0";
    for (const auto &[text, value] : std::vector<std::pair<std::string, double>>{{zeros + "1.5" + zeros, 1.5},
                                                                                 {"0." + nines, 1},
                                                                                 {"1" + zeros + "e-5000", 1},
                                                                                 {"0." + zeros + "25e5001", 2.5}}) {
        const std::vector<Eigen::Matrix4d> m = ReadTransformFile(Written(text + rest));
        ASSERT_EQ(m.size(), 1u);
        EXPECT_EQ(m[0](0, 0), value) << text;
    }
    ExpectNames(TransformError("\n" + nines + rest), 2, "'9999");
    ExpectNames(TransformError("1e" + nines + rest), 1, "'1e9999");
    ExpectNames(TransformError("1e-" + nines + rest), 1, "'1e-9999");
    ExpectNames(PointError("0 0 0 " + nines), 1, "'9999");
    ExpectNames(PointError(nines + " 0 0 0"), 1, "'9999");
}

TEST_F(HandleFile, ReadsNoFurtherThanItNeeds) {
    Written(std::string(999999, ' ') + "7");
    EXPECT_EQ(ReadTagFile(path, 1000000), std::vector<int>{7});
#ifdef _WIN32 // no sparse files
    const std::uintmax_t large = std::uintmax_t(1) << 24;
#else
    const std::uintmax_t large = std::uintmax_t(1) << 36; // most of it a hole
#endif
    for (std::uintmax_t size : {std::uintmax_t(1000001), large}) {
        std::filesystem::resize_file(path, size);
        for (const std::string &message : {MessageOf<Error>([&] { ReadTagFile(path, 1000000); }),
                                           MessageOf<Error>([&] { ReadTransformFile(path, 1000000); }),
                                           MessageOf<Error>([&] { ReadPointHandleFile(path, 1000000); })})
            EXPECT_EQ(message.find("'" + path + "' is larger than 1 MB"), 0u) << message;
    }
}

TEST_F(HandleFile, NamesTheEndOfATruncatedMatrix) {
    ExpectNames(TransformError("1 0 0 0\n0 1 0 0\n0 0 1 0\n"), 4, "12 numbers");
    ExpectNames(TransformError(identity + "1 0 0"), 5, "19 numbers");
}

TEST_F(HandleFile, ReadsPointPairs) {
    for (const char *text : {"vertex,x,y,z\n7, 1.5,-2,3e1\n\n1,2,3,4,5,6 # as coordinates\n",
                             "7 1.5 -2 3e1\r\n1 2 3 4 5 6", "\xEF\xBB\xBF# points\n7;1.5;-2;30\n1\t2\t3\t4\t5\t6\n"}) {
        const std::vector<PointPair> pairs = ReadPointHandleFile(Written(text));
        ASSERT_EQ(pairs.size(), 2u) << text;
        EXPECT_EQ(pairs[0].vertex, 7);
        EXPECT_EQ(pairs[0].target, Eigen::Vector3d(1.5, -2, 30));
        EXPECT_EQ(pairs[1].vertex, -1);
        EXPECT_EQ(pairs[1].start, Eigen::Vector3d(1, 2, 3));
        EXPECT_EQ(pairs[1].target, Eigen::Vector3d(4, 5, 6));
    }
}

TEST_F(HandleFile, RefusesWhatIsNoListOfPoints) {
    ExpectNames(PointError("1 2 3\n"), 1, "3 numbers");
    ExpectNames(PointError("0 1 2 3\n1 2 3 4 5 6 7\n"), 2, "7 numbers");
    ExpectNames(PointError("vertex x y z\nname 1 2 3\n"), 2, "'name'");
    ExpectNames(PointError("0 1 2 3\n0 1 zwei 3\n"), 2, "'zwei'");
    ExpectNames(PointError("-1 1 2 3\n"), 1, "number of a vertex");
    ExpectNames(PointError("0.5 1 2 3\n"), 1, "number of a vertex");
    ExpectNames(PointError("0 1 inf 3\n"), 1, "finite");
    ExpectNames(PointError("1,5;2,5;3,5;4,5\n"), 1, "point for decimals");
    ExpectNames(PointError("# nothing\n\n"), 3, "no points");
    ExpectNames(PointError("vertex,x,y,z\n"), 2, "no points");
    ExpectNames(PointError("9223372036854775808 1 2 3\n"), 1, "number of a vertex");
    ExpectNames(PointError("1e3 1 2 3\n"), 1, "number of a vertex");
    for (const char *bad : {"1,,4,5,6", "1,2,3,,5,6,7", ",1,2,3,4", "0 ; ; 1 2 3", "1,;2,3,4", "x,,z\n;1,2,3,4"})
        ExpectNames(PointError(std::string("\n") + bad), 2 + (*bad == 'x'), "one is missing");
    EXPECT_EQ(ReadPointHandleFile(Written("vertex,,x,y,z\n1, 2 ,3;4\n1;2;3;4;;\n1,2,3,4,5,6,")).size(), 3u);
    for (const char *bad : {"1e999", "0x10", "1.2.3", "-", "+-1"}) // not a line that names the columns
        ExpectNames(PointError(bad + std::string(" 1 2 3\n4 5 6 7\n")), 1, bad);
}

static void ExpectExact() {
    const std::vector<int> tag{1, 12345678, -1};
    EXPECT_EQ(ReadTagText(TagText(tag), "tags"), tag);
    const std::vector<Eigen::Matrix4d> written = RandomMatrices(3);
    const std::vector<Eigen::Matrix4d> read = ReadTransformText(TransformText(written), "motions");
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t i = 0; i < read.size(); ++i)
        EXPECT_TRUE(SameBits(read[i], written[i]));
}

TEST_F(HandleFile, DoesNotDependOnTheLocaleOfTheStreams) {
    struct Comma : std::numpunct<char> {
        char do_decimal_point() const override { return ','; }
        char do_thousands_sep() const override { return '.'; }
        std::string do_grouping() const override { return "\3"; }
    };
    const std::locale before = std::locale::global(std::locale(std::locale(), new Comma));
    ExpectExact();
    std::locale::global(before);
}

TEST_F(HandleFile, DoesNotDependOnTheLocaleOfTheProgram) {
    const CommaLocale locale;
    if (!locale.set)
        GTEST_SKIP() << CommaLocale::missing;
    ExpectExact();
    ASSERT_EQ(ReadPointHandleFile(Written("1 2.5 3,5\n"))[0].target, Eigen::Vector3d(2.5, 3, 5));
    ExpectNames(PointError("1,5;2,5;3,5;4,5\n"), 1, "point for decimals");
    ExpectNames(TransformError("1,5" + identity), 1, "'1,51'");
}
