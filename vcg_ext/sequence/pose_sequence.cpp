// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/table_reader.h>
#include <vcg_ext/base/words.h>
#include <vcg_ext/sequence/pose_sequence.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <set>
#include <sstream>

namespace vcg::fcd {

namespace {

const std::array<const char *, 3> easingNames = {"linear", "smooth", "hold"}; // in the order of Easing

SurfaceMark ReadMark(const detail::TableReader &reader, const std::string &text) {
    std::istringstream words(text);
    words.imbue(std::locale::classic());
    SurfaceMark mark;
    std::string vertices, from, to;
    Eigen::Vector3d low, high;
    words >> mark.vertices >> vertices >> from >> low[0] >> low[1] >> low[2] >> to >> high[0] >> high[1] >> high[2];
    if (!words || vertices != "vertices" || from != "from" || to != "to")
        reader.Fail("expected 'N vertices from x y z to x y z' for the surface; leave the row out where it is not "
                    "known");
    mark.box = Eigen::AlignedBox3d(low, high);
    return mark;
}

std::string MarkText(const SurfaceMark &mark) {
    std::string text = std::to_string(mark.vertices) + " vertices from";
    for (int i = 0; i < 6; ++i)
        text += (i == 3 ? " to " : " ") + detail::ToText(i < 3 ? mark.box.min()[i] : mark.box.max()[i - 3]);
    return text;
}

/// A cell of a table, quoted if needed.
std::string Cell(const std::string &text) {
    const bool isPlain = text.find_first_of(",;\t\"\r\n#") == std::string::npos;
    if (isPlain && (text.empty() || (text.front() != ' ' && text.back() != ' ')))
        return text;
    std::string quoted = "\"";
    for (char c : text)
        quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

} // namespace

double Eased(Easing easing, double t) {
    switch (easing) {
    case Easing::Linear: break;
    case Easing::Smooth: return t * t * (3 - 2 * t);
    case Easing::Hold: return t < 1 ? 0 : 1;
    }
    return t;
}

SurfaceMark SurfaceMark::Of(const SurfaceView &surface, const Eigen::Affine3d &world) {
    SurfaceMark mark;
    for (std::size_t i = 0; i < surface.vertexSlots; ++i)
        if (!surface.IsDeleted(i)) {
            ++mark.vertices;
            mark.box.extend(world * Eigen::Vector3d(surface.At(i)));
        }
    return mark;
}

bool SurfaceMark::IsSame(const SurfaceMark &other) const {
    const double near =
        1e-4 * std::max(box.diagonal().stableNorm(), other.box.diagonal().stableNorm()); // some files have six digits
    return vertices == other.vertices && (box.min() - other.box.min()).stableNorm() <= near &&
           (box.max() - other.box.max()).stableNorm() <= near;
}

std::vector<double> PoseSequence::WeightsAt(double time) const {
    std::vector<double> weight(pose.size(), 0);
    if (key.empty())
        return weight;
    const auto after = std::find_if(key.begin(), key.end(), [&](const KeyFrame &each) { return each.time > time; });
    if (after == key.begin() || after == key.end())
        return after == key.begin() ? key.front().weight : key.back().weight;
    const KeyFrame &from = *(after - 1), &to = *after;
    const double t = Eased(from.easing, (time - from.time) / (to.time - from.time));
    for (std::size_t i = 0; i < weight.size(); ++i)
        weight[i] = from.weight[i] + t * (to.weight[i] - from.weight[i]);
    return weight;
}

void PoseSequence::Validate() const {
    if (pose.empty())
        throw BadInput("There is no pose. Give each a name and the motions of its handles.");
    std::set<std::string> names;
    for (const NamedPose &each : pose) {
        if (each.name.empty())
            throw BadInput("A pose has no name. Give it one.");
        if (!names.insert(each.name).second)
            throw BadInput("Two poses are called " + detail::Excerpt(each.name, 0, each.name.size()) +
                           ". Give each a name of its own.");
    }
    double before = -1;
    for (const KeyFrame &each : key) {
        if (!(each.time >= 0) || !std::isfinite(each.time))
            throw BadInput("A key frame is at " + detail::ToText(each.time) + " s. Times are finite numbers from 0.");
        if (each.time <= before)
            throw BadInput("A key frame at " + detail::ToText(each.time) + " s comes after one at " +
                           detail::ToText(before) + " s. Their times must ascend.");
        before = each.time;
        if (each.weight.size() != pose.size() ||
            !std::all_of(each.weight.begin(), each.weight.end(), [](double w) { return std::isfinite(w); }))
            throw BadInput("The key frame at " + detail::ToText(each.time) +
                           " s must have a finite number, percent, for each pose.");
    }
}

void PoseSequence::ExpectSurface(const SurfaceMark &other, const std::string &remedy) const {
    if (surface && !surface->IsSame(other))
        throw BadInput("The poses are of another surface, or of this one at another place: of " + MarkText(*surface) +
                       ", while this one has " + MarkText(other) + ". " + remedy);
}

PoseSequence ReadPoseSequence(const std::string &text, const std::string &name) {
    detail::TableReader reader(text, name);
    PoseSequence sequence;
    if (!reader.Next() || reader.cell[0] != "time" || reader.cell.size() < 3 || reader.cell[1] != "easing")
        reader.Fail("expected a first row 'time, easing' with the name of a pose in each further cell");
    for (std::size_t i = 2; i < reader.cell.size(); ++i)
        sequence.pose.push_back({reader.cell[i], {}});
    const std::size_t cells = reader.cell.size();
    const std::size_t most = 10000; // default key frames have the square of it as weights
    if (sequence.pose.size() > most)
        reader.Fail("found " + std::to_string(sequence.pose.size()) + " poses, where " + std::to_string(most) +
                    " are the most");
    bool hasMotions = false;
    while (reader.Next()) {
        if (reader.cell.size() > cells)
            reader.Fail("found " + std::to_string(reader.cell.size()) + " cells, where the first row has " +
                        std::to_string(cells) + "; put quotation marks around what holds a separator");
        reader.cell.resize(cells);
        const std::string &what = reader.cell[0];
        if (what == "surface") {
            sequence.surface = ReadMark(reader, reader.cell[2]);
        } else if (what == "motions") {
            if (hasMotions)
                reader.Fail("found a second row 'motions'");
            hasMotions = true;
            for (std::size_t i = 2; i < cells; ++i)
                sequence.pose[i - 2].motions = reader.cell[i];
        } else {
            KeyFrame key;
            key.time = reader.Number(0, "a time in seconds, 'motions' or 'surface'");
            const auto found = std::find(easingNames.begin(), easingNames.end(), reader.cell[1]);
            if (found == easingNames.end() && !reader.cell[1].empty())
                reader.Fail("expected linear, smooth or hold, found " +
                            detail::Excerpt(reader.cell[1], 0, reader.cell[1].size()));
            if (found != easingNames.end())
                key.easing = Easing(found - easingNames.begin());
            for (std::size_t i = 2; i < cells; ++i)
                key.weight.push_back(reader.cell[i].empty() ? 0 : reader.Number(i, "the percent of a pose"));
            sequence.key.push_back(std::move(key));
        }
    }
    if (!hasMotions)
        reader.Fail("there is no row 'motions', with the motions of each pose");
    try {
        sequence.Validate();
    } catch (const BadInput &error) {
        throw BadInput("'" + name + "': " + error.what());
    }
    if (sequence.key.empty())
        for (std::size_t i = 0; i <= sequence.pose.size(); ++i) {
            sequence.key.push_back({double(i), Easing::Smooth, std::vector<double>(sequence.pose.size(), 0)});
            if (i > 0)
                sequence.key.back().weight[i - 1] = 100;
        }
    return sequence;
}

std::string PoseSequenceText(const PoseSequence &sequence) {
    std::string text = "time,easing";
    for (const NamedPose &each : sequence.pose)
        text += "," + Cell(each.name);
    if (sequence.surface)
        text += "\nsurface,," + Cell(MarkText(*sequence.surface));
    text += "\nmotions,";
    for (const NamedPose &each : sequence.pose)
        text += "," + Cell(each.motions);
    for (const KeyFrame &each : sequence.key) {
        text += "\n" + detail::ToText(each.time) + "," + easingNames[std::size_t(each.easing)];
        for (double weight : each.weight)
            text += "," + detail::ToText(weight);
    }
    return text + "\n";
}

std::vector<double> FrameTimes(const PoseSequence &sequence, double rate) {
    if (!(rate > 0) || std::isinf(rate))
        throw BadInput("The frames per second must be a positive number.");
    std::vector<double> time;
    if (sequence.key.empty())
        return time;
    const double begin = sequence.key.front().time, length = sequence.key.back().time - begin;
    const double steps = std::ceil(length * rate - 1e-6); // no frame by rounding
    if (!(steps < 1e6))
        throw BadInput("These would be more than a million frames. Give fewer frames per second, or times in seconds.");
    for (std::size_t i = 0; i <= std::size_t(std::max(steps, 0.)); ++i)
        time.push_back(begin + double(i) / rate);
    return time;
}

} // namespace vcg::fcd
