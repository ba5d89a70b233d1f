// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h>
#include <vcg_ext/handles/handle_file.h>

#include <filesystem>
#include <fstream>

namespace vcg::fcd {

std::string ReadFile(const std::string &path, std::size_t most) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        throw BadInput("Cannot read '" + path + "'.");
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw BadInput("Cannot open '" + path + "'.");
    std::string text;
    std::vector<char> buffer(1 << 16);
    while (file.read(buffer.data(), std::streamsize(buffer.size())) || file.gcount() > 0) {
        text.append(buffer.data(), std::size_t(file.gcount()));
        if (text.size() > most)
            throw BadInput("'" + path + "' is larger than " + std::to_string(most / 1000000) +
                           " MB, which is more than this mesh can need. Give the file that belongs to it.");
    }
    if (file.bad())
        throw BadInput("Cannot read '" + path + "'.");
    return text;
}

std::vector<int> ReadTagText(const std::string &text, const std::string &name) {
    detail::WordReader reader(text, name);
    std::vector<int> tag;
    while (reader.Next())
        tag.push_back(reader.As<int>("a tag (a whole number)"));
    if (tag.empty())
        reader.Fail("the file holds no tags; expected one whole number per vertex");
    return tag;
}

std::vector<int> ReadTagFile(const std::string &path, std::size_t most) {
    return ReadTagText(ReadFile(path, most), path);
}

std::vector<Eigen::Matrix4d> ReadTransformText(const std::string &text, const std::string &name) {
    detail::WordReader reader(text, name);
    std::vector<double> number;
    while (reader.Next())
        number.push_back(reader.As<double>("a number"));
    if (number.empty() || number.size() % 16)
        reader.Fail("the file ends after " + std::to_string(number.size()) +
                    " numbers; expected 16 for each 4 x 4 matrix");
    std::vector<Eigen::Matrix4d> matrix;
    for (std::size_t i = 0; i < number.size(); i += 16)
        matrix.emplace_back(Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(&number[i]));
    return matrix;
}

std::vector<Eigen::Matrix4d> ReadTransformFile(const std::string &path, std::size_t most) {
    return ReadTransformText(ReadFile(path, most), path);
}

std::vector<PointPair> ReadPointHandleText(const std::string &text, const std::string &name) {
    detail::WordReader reader(text, name, ",;");
    std::vector<PointPair> pairs;
    for (std::vector<double> number; reader.NextRow(number);) {
        PointPair pair;
        if (number.size() != 4 && number.size() != 6)
            reader.Fail("found " + std::to_string(number.size()) +
                        " numbers; expected 4 (vertex and target) or 6 (start and target), with a point for decimals");
        if (number.size() == 6)
            pair.start << number[0], number[1], number[2];
        else
            pair.vertex = reader.IndexOfRow();
        if (number.size() == 4 && pair.vertex < 0)
            reader.Fail("expected the number of a vertex (0 or more) as the first of 4 numbers");
        pair.target = Eigen::Map<const Eigen::Vector3d>(number.data() + number.size() - 3);
        pairs.push_back(pair);
    }
    if (pairs.empty())
        reader.Fail("the file holds no points; expected a line with start and target for each");
    return pairs;
}

std::vector<PointPair> ReadPointHandleFile(const std::string &path, std::size_t most) {
    return ReadPointHandleText(ReadFile(path, most), path);
}

std::string TagText(const std::vector<int> &tag) {
    std::string text =
        "# one tag per vertex: 0 fixed, 1 free, 2 and up handles, negative outside the region of influence\n";
    for (int t : tag)
        text.append(detail::ToText(t)).push_back('\n');
    return text;
}

std::string TransformText(const std::vector<Eigen::Matrix4d> &matrix) {
    std::string text = "# a 4 x 4 matrix per handle, for tags 2, 3, ... in order\n";
    for (const Eigen::Matrix4d &m : matrix)
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c)
                text.append(detail::ToText(m(r, c))).push_back(c < 3 ? ' ' : '\n');
    return text;
}

} // namespace vcg::fcd
