// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/base/words.h>
#include <vcg_ext/handles/motion_text.h>

#include <cctype>
#include <cmath>
#include <limits>

namespace vcg::fcd {

namespace {

/// Reads a motion text by words: ':', ';', ',' and what these and white space separate.
class MotionTextReader {
  public:
    MotionTextReader(const std::string &text, const std::string &name) : text(text), name(name) { Next(); }

    std::map<int, std::vector<MotionStep>> Read() {
        std::map<int, std::vector<MotionStep>> motion;
        while (!AtEnd()) {
            int tag = 0;
            if (!detail::ToNumber(text.data() + begin, text.data() + end, tag) || tag < 2)
                Expected("the tag of a handle (a whole number from 2 to 2147483647)");
            std::vector<MotionStep> &steps = motion[tag];
            if (!steps.empty())
                Fail("handle " + std::to_string(tag) +
                     " is there for the second time; put all steps of a handle after one colon");
            Next();
            if (!Is(":"))
                Expected("':' after the tag " + std::to_string(tag));
            Next();
            do
                steps.push_back(ReadStep(steps.empty()));
            while (!AtEnd() && !Is(";"));
            Next();
        }
        return motion;
    }

  private:
    MotionStep ReadStep(bool first) {
        MotionStep step;
        const std::size_t keyword = begin;
        if (IsKeyword("translate")) {
            Next();
            ReadNumbers("x y z of 'translate'", 3, step.vector.data());
        } else if (IsKeyword("rotate")) {
            Next();
            double number[4];
            ReadNumbers("ax ay az degrees of 'rotate'", 4, number);
            step = MotionStep::Rotate(Eigen::Vector3d(number[0], number[1], number[2]), number[3]);
            if ((step.vector.array() == 0).all())
                Fail("the axis of 'rotate' is 0 0 0, which is no direction", keyword);
            step.about = ReadAbout();
        } else if (IsKeyword("scale")) {
            Next();
            step = MotionStep::Scale(Eigen::Vector3d::Zero());
            ReadNumbers("s, or sx sy sz, of 'scale'", 1, step.vector.data());
            if (Is(",") || detail::LooksLikeNumber(text.data() + begin, text.data() + end))
                ReadNumbers("sx sy sz of 'scale'", 3, step.vector.data(), 1);
            else
                step.vector.setConstant(step.vector[0]);
            if (!(step.vector.array() > 0).all())
                Fail("a factor of 'scale' is 0 or less; it must be greater than 0", keyword);
            step.about = ReadAbout();
        } else if (IsKeyword("matrix")) {
            Next();
            Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix;
            ReadNumbers("m11 m12 ... m44 of 'matrix'", 16, matrix.data());
            step = MotionStep::Affine(matrix);
            if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
                Fail("the matrix is not affine: its last row (numbers 13 to 16) must be 0 0 0 1", keyword);
        } else {
            Expected(first ? "'translate', 'rotate', 'scale' or 'matrix'"
                           : "'translate', 'rotate', 'scale', 'matrix', ';' or the end");
        }
        return step;
    }

    std::optional<Eigen::Vector3d> ReadAbout() {
        if (!IsKeyword("about"))
            return {};
        Next();
        Eigen::Vector3d point;
        ReadNumbers("x y z of 'about'", 3, point.data());
        return point;
    }

    /// Reads the numbers [from, count). \param what names all of them, for messages
    void ReadNumbers(const char *what, int count, double *number, int from = 0) {
        for (int i = from; i < count; ++i) {
            while (i > 0 && Is(","))
                Next();
            if (!detail::ToNumber(text.data() + begin, text.data() + end, number[i]))
                Expected("number " + std::to_string(i + 1) + " of " + std::to_string(count) + " (" + what + ")");
            if (!std::isfinite(number[i]))
                Expected("a finite number");
            Next();
        }
    }

    bool AtEnd() const { return begin == end; }

    bool Is(const char *word) const { return text.compare(begin, end - begin, word) == 0; }

    bool IsKeyword(const std::string &keyword) const {
        if (end - begin != keyword.size())
            return false;
        for (std::size_t i = 0; i < keyword.size(); ++i) {
            const char c = text[begin + i];
            if ((c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c) != keyword[i])
                return false;
        }
        return true;
    }

    static bool IsMark(char c) { return c == ':' || c == ';' || c == ','; }

    /// Goes to the next word; an empty one is the end.
    void Next() {
        begin = end;
        while (begin < text.size() && detail::IsSpace(text[begin]))
            ++begin;
        end = begin;
        if (end < text.size() && IsMark(text[end]))
            ++end;
        else
            while (end < text.size() && !detail::IsSpace(text[end]) && !IsMark(text[end]))
                ++end;
    }

    /// Whether a number is missing or too many after a comma between two digits, which may stand for a decimal point.
    bool FollowsDecimalComma() const {
        const auto isDigit = [this](std::size_t at) { return at < text.size() && text[at] >= '0' && text[at] <= '9'; };
        if (!AtEnd() && !IsMark(text[begin]) && !detail::LooksLikeNumber(text.data() + begin, text.data() + end))
            return false;
        for (std::size_t at = end; at > 1 && !std::isalpha(static_cast<unsigned char>(text[at - 1])); --at)
            if (text[at - 1] == ',' && isDigit(at) && isDigit(at - 2))
                return true;
        return false;
    }

    [[noreturn]] void Expected(const std::string &what) const {
        Fail("expected " + what + ", found " + (AtEnd() ? "the end" : detail::Excerpt(text, begin, end)) +
             (FollowsDecimalComma() ? ". Commas separate numbers: write decimals with a point, as in 0.5" : ""));
    }

    [[noreturn]] void Fail(const std::string &what) const { Fail(what, begin); }

    [[noreturn]] void Fail(const std::string &what, std::size_t at) const {
        std::size_t character = 1; // continuation bytes of UTF-8 do not count
        for (std::size_t i = 0; i < at; ++i)
            character += (text[i] & 0xC0) != 0x80;
        throw BadInput(name + ", character " + std::to_string(character) + ": " + what + ".");
    }

    const std::string &text;
    const std::string name;
    std::size_t begin = 0, end = 0; ///< of the current word
};

} // namespace

std::map<int, std::vector<MotionStep>> ReadMotionText(const std::string &text, const std::string &name) {
    return MotionTextReader(text, name).Read();
}

std::string WriteMotionText(const std::map<int, std::vector<MotionStep>> &motion) {
    std::string text;
    const auto add = [&text](const double *number, int count) {
        for (int i = 0; i < count; ++i)
            text += ' ' + detail::ToText(number[i]);
    };
    for (const auto &[tag, steps] : motion) {
        if (steps.empty())
            continue;
        text += (text.empty() ? "" : "; ") + std::to_string(tag) + ":";
        for (const MotionStep &step : steps) {
            switch (step.kind) {
            case MotionStep::Translation: text += " translate"; break;
            case MotionStep::Rotation: text += " rotate"; break;
            case MotionStep::Scaling: text += " scale"; break;
            case MotionStep::Matrix: text += " matrix"; break;
            }
            if (step.kind == MotionStep::Matrix)
                add(Eigen::Matrix<double, 4, 4, Eigen::RowMajor>(step.matrix).data(), 16);
            else
                add(step.vector.data(), 3);
            if (step.kind == MotionStep::Rotation)
                add(&step.degrees, 1);
            if (step.about) {
                text += " about";
                add(step.about->data(), 3);
            }
        }
    }
    return text;
}

Motion ToMotion(const std::vector<MotionStep> &steps, const Eigen::Vector3d &barycenter) {
    const double radian = detail::pi / 180;
    Eigen::Affine3d motion = Eigen::Affine3d::Identity();
    Eigen::Vector3d axis = Eigen::Vector3d::Zero(), pivot = Eigen::Vector3d::Zero(); // of the turn
    double degrees = 0;
    for (const MotionStep &step : steps) {
        const Eigen::Vector3d center = step.about ? *step.about : motion * barycenter;
        const Eigen::Translation3d there(center), back(-center);
        Eigen::Affine3d change = Eigen::Affine3d::Identity();
        switch (step.kind) {
        case MotionStep::Translation: change.translation() = step.vector; break;
        case MotionStep::Matrix: change = step.matrix; break;
        case MotionStep::Scaling: change = there * Eigen::Affine3d(Eigen::Scaling(step.vector)) * back; break;
        case MotionStep::Rotation: {
            const Eigen::Vector3d axisNow = step.vector.stableNormalized();
            if (axis.isZero(0)) {
                axis = axisNow;
                pivot = motion.inverse() * center;
            }
            const bool parallel = axis.cross(axisNow).norm() <= 1e-9;
            degrees += !parallel               ? std::numeric_limits<double>::quiet_NaN()
                       : axis.dot(axisNow) < 0 ? -step.degrees
                                               : step.degrees;
            // Without full turns, exactly.
            change.linear() = detail::RotationBy(std::remainder(step.degrees, 360) * radian, axisNow);
            change = there * change * back;
            break;
        }
        }
        motion = change * motion;
    }
    return Motion(motion.matrix(), degrees * radian * axis, pivot);
}

} // namespace vcg::fcd
