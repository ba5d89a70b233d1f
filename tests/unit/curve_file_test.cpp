// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/fit/curve_file.h>
#include "test_support.h"

#include <filesystem>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Vector3d;

namespace {

const std::string head = "curve,surface,x,y,z\n", lips = "lips,source,1,2,3\nlips,source,2,2,3\n",
                  there = "lips,target,1,2,4\nlips,target,2,2,4\n";

void ExpectRefused(const std::string &text, int line, const std::string &what) {
    const std::string message = MessageOf<BadInput>([&] { ReadCurveText(text, "my.csv"); });
    EXPECT_EQ(message.find("'my.csv', line " + std::to_string(line) + ": "), 0u) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message;
}

} // namespace

TEST(CurveFile, ReadsWhatATableHas) {
    const std::vector<std::string> texts = {
        "# drawn by hand\r\ncurve,surface,x,y,z\r\n\"lips, upper\",source,1,2,3\r\nridge,target,0,0,1e1\r\n,,,,\r\n"
        "ridge,target,0,0,-.5\r\n\"lips, upper\",target,7,8,9\r\nridge,source,0,0,0\r\nridge,source,0,0,1\r\n"
        "\"lips, upper\",source,4,5,6\r\n\"lips, upper\",source,1,2,3\r\n\"lips, upper\",target,1,2,4\r\n",
        "\xEF\xBB\xBF# drawn by hand\ncurve;surface;x;y;z\n\"lips, upper\";source;1;2;3\nridge;target;0;0;+10;\n\n"
        "ridge;target;0;0;-0.5\nlips, upper;target;7;8;9\nridge;source;0;0;0\nridge;source;0;0;1\n"
        "lips, upper; source;4; 5;6 \nlips, upper;source;1;2;3\nlips, upper;target;1;2;4"};
    for (const std::string &text : texts) {
        const std::vector<CurvePair> curves = ReadCurveText(text, "my.csv");
        ASSERT_EQ(curves.size(), 2u) << text;
        EXPECT_EQ(curves[0].name, "lips, upper");
        EXPECT_EQ(curves[0].source, (std::vector<Vector3d>{{1, 2, 3}, {4, 5, 6}, {1, 2, 3}})) << "closed";
        EXPECT_EQ(curves[0].target, (std::vector<Vector3d>{{7, 8, 9}, {1, 2, 4}}));
        EXPECT_EQ(curves[0].sourceLine, (std::vector<std::size_t>{3, 10, 11}));
        EXPECT_EQ(curves[1].name, "ridge");
        EXPECT_EQ(curves[1].source, (std::vector<Vector3d>{{0, 0, 0}, {0, 0, 1}}));
        EXPECT_EQ(curves[1].target, (std::vector<Vector3d>{{0, 0, 10}, {0, 0, -0.5}}));
    }
}

TEST(CurveFile, SaysWhatIsWrongAndInWhichLine) {
    ExpectRefused("", 1, "expected the first row 'curve,surface,x,y,z'");
    ExpectRefused(lips + there, 1, "expected the first row");
    ExpectRefused(head, 1, "the file holds no curves; expected a row for each corner of one");
    ExpectRefused(head + lips + "lips,target,1,2\n", 4, "found 4 cells; expected the name of a curve");
    ExpectRefused(head + lips + "lips,target,1,5,2,0,4,0\n", 4, "with a point for decimals");
    ExpectRefused(head + lips + "\n,target,1,2,3\n", 5, "expected the name of a curve in the first cell");
    ExpectRefused(head + lips + "lips,sorce,1,2,3\n", 4, "expected source or target as the surface, found 'sorce'");
    for (const char *bad : {"", "one", "1 5", "0x1", "nan", "inf", "1e999"})
        ExpectRefused(head + "lips,source,1," + bad + ",3\n", 2,
                      "expected a finite number, with a point for decimals, found '" + std::string(bad) + "'");
    ExpectRefused("curve;surface;x;y;z\nlips;source;1,5;2;3\n", 2, "with a point for decimals, found '1,5'");
    ExpectRefused(head + "\"lips,source,1,2,3\n", 2, "a quotation mark has no end");
}

TEST(CurveFile, ACurveHasTwoEndsOnEachSurface) {
    const std::string ridge = "ridge,source,0,0,0\nridge,target,0,0,0\nridge,source,0,0,1\nridge,target,0,0,1\n";
    ExpectRefused(head + ridge + lips, 6,
                  "the curve 'lips' needs corners at two places of the target at least, in rows with 'target'; it has "
                  "none");
    ExpectRefused(head + ridge + there, 6, "of the source at least, in rows with 'source'; it has none");
    ExpectRefused(head + there + "lips,source,1,2,3\n" + ridge, 2, "with 'source'; it has one");
    ExpectRefused(head + lips + "lips,target,1,2,3\nlips,target,1,2,3\n" + ridge, 2, "with 'target'; it has one");
    ExpectRefused(head + ridge + "Ridge,source,0,0,0\n", 6, "the curve 'Ridge'");
}

TEST(CurveFile, HasALimit) {
    std::string text = head + there;
    for (int i = 0; i < 99998; ++i)
        text += "lips,source,1,2," + std::to_string(i) + "\n";
    EXPECT_EQ(ReadCurveText(text, "my.csv")[0].source.size(), 99998u);
    ExpectRefused(text + "lips,source,1,2,3\n", 100002, "found more than 100000 corners");
}

TEST(CurveFile, ComesFromAFile) {
    const std::string path =
        (std::filesystem::temp_directory_path() / ("fcd_curves_" + std::to_string(std::random_device()()))).string();
    EXPECT_EQ(MessageOf<Error>([&] { ReadCurveFile(path); }), "Cannot open '" + path + "'.");
    std::ofstream(path) << head << lips << there;
    EXPECT_EQ(ReadCurveFile(path).size(), 1u);
    std::filesystem::resize_file(path, 21000000);
    EXPECT_EQ(MessageOf<Error>([&] { ReadCurveFile(path); }).find("'" + path + "' is larger than 20 MB"), 0u);
    std::filesystem::remove(path);
}
