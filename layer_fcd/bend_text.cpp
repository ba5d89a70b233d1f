// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_state.h"

#include <vcg_ext/base/words.h>

#include <algorithm>
#include <limits>
#include <set>

using vcg::fcd::detail::ToText;

namespace {

const char *const firstLine = "FCD bend 1";

// Users give handles one rank after another: this leaves room.
const int mostRank = 1000000;

/// Reads a text of bend_state.h, and checks all of it.
class BendTextReader : public vcg::fcd::detail::TextReader {
  public:
    BendTextReader(const std::string &text, const std::string &name, const std::vector<std::size_t> &live,
                   std::size_t vertexSlots)
        : TextReader(text, name), live(live), vertexSlots(vertexSlots) {}

    std::pair<BendState, BendOptions> read() {
        if (rest() != firstLine)
            Fail(std::string("expected '") + firstLine + "': this is of another version of the tool");
        while (NextLine()) {
            const std::string key = word();
            if (!key.empty() && !readOption(key) && !readHandle(key))
                expected("an option, or what is known of a handle", key);
            if (const std::string more = word(); !more.empty())
                expected("the end of the line", more);
        }
        if (!marks.empty())
            state.marks = std::make_shared<const BendTags>(std::move(marks));
        if (!rims.empty())
            state.rims = std::make_shared<const BendRims>(std::move(rims));
        return {std::move(state), options};
    }

  private:
    bool readOption(const std::string &key) {
        if (key == "smoothness") // numbers are as the panel has them
            options.smoothness = number("a smoothness from 0 to 10", 0, 10);
        else if (key == "falloff")
            options.falloff = vcg::fcd::Falloff(whole("0, 1, 2 or 3", 0, 3));
        else if (key == "elastic")
            options.elastic = whole("0 or 1", 0, 1) == 1;
        else if (key == "rigidity")
            options.rigidity = number("a rigidity from 0 to 1", 0, 1);
        else if (key == "detail")
            options.initialPatches = whole("a number of patches from 0 to 20000", 0, 20000);
        else if (key == "distances")
            options.weights = vcg::fcd::MappingWeights(whole("0 or 1", 0, 1));
        else if (key == "symmetry")
            options.mirror = whole("-1, 0, 1 or 2", -1, 2);
        else if (key == "axes")
            options.axes = BendAxes(whole("0, 1, 2 or 3", 0, 3));
        else if (key == "pose")
            state.pose = options.pose = number("a percentage from 0 to 200", 0, 200);
        else
            return false;
        return true;
    }

    bool readHandle(const std::string &key) {
        if (key == "point")
            readPoint(state.points[tag()]);
        else if (key == "rank")
            readRank(state.rank[tag()]);
        else if (key == "name" || key == "hidden" || key == "locked" || key == "pivot")
            readSaid(key, state.handles[tag()]);
        else if (key == "motions")
            readMotions();
        else if (key == "mark")
            readRanges(marks, whole("a tag", std::numeric_limits<int>::lowest(), std::numeric_limits<int>::max()), 1);
        else if (key == "rim")
            readRanges(rims, radius<float>(), 0.f);
        else if (key == "weights")
            while (!isAtEnd())
                state.weights.push_back(number("a percentage"));
        else if (key == "line")
            readLinePoint();
        else
            return false;
        return true;
    }

    void readRank(int &rank) { rank = whole("a rank from 1 to 1000000", 1, mostRank); }

    void readSaid(const std::string &key, BendHandle &handle) {
        if (key == "name")
            handle.name = rest();
        else if (key == "pivot")
            handle.pivot = vector("a number of a place");
        else
            (key == "hidden" ? handle.isHidden : handle.isLocked) = true;
    }

    void readPoint(BendPoint &point) {
        point.slot = live[vertex()];
        if (!taken.insert(point.slot).second)
            Fail("the vertex has another handle already");
        point.radius = radius<double>();
        point.isGrip = !isAtEnd();
        if (const std::string last = word(); point.isGrip && last != "grip")
            expected("'grip'", last);
    }

    void readMotions() {
        try {
            state.motion = vcg::fcd::ReadMotionText(rest(), "The motions");
            for (const auto &each : state.motion)
                vcg::fcd::ToMotion(each.second, Eigen::Vector3d::Zero()); // throws if it is wrong
        } catch (const vcg::fcd::BadInput &error) {
            std::string what = error.what();
            what.erase(what.find_last_not_of('.') + 1); // expected() adds it
            Fail("motions that cannot be: " + what);
        }
    }

    /// Gives vertices a value, which none may have yet. \param none the value of others
    template <class Value>
    void readRanges(std::vector<Value> &values, Value value, Value none) {
        if (value == none) // or each line could repeat it for all vertices
            Fail("vertices of tag 1 have no mark");
        values.resize(vertexSlots, none);
        while (!isAtEnd()) {
            const std::size_t first = vertex(), last = vertex(first);
            for (std::size_t i = first; i <= last; ++i)
                if (std::exchange(values[live[i]], value) != none)
                    Fail("vertex " + ToText(i) + " has a mark, or a rim, already");
        }
    }

    void readLinePoint() {
        BendLinePoint point;
        for (std::size_t &corner : point.corner)
            corner = live[vertex()];
        point.weight = vector("a weight");
        point.place = vector("a number of a place");
        state.line.push_back(point);
    }

    // --- words ---

    [[noreturn]] void expected(const std::string &what, const std::string &found) const {
        Fail("expected " + what + ", found " + vcg::fcd::detail::Excerpt(found, 0, found.size()));
    }

    bool isAtEnd() {
        at = std::min(text.find_first_not_of(" \t", at), text.size());
        return at == text.size() || text[at] == '\n' || text[at] == '\r';
    }
    std::string until(const char *ends) {
        isAtEnd();
        const std::size_t begin = std::exchange(at, std::min(text.find_first_of(ends, at), text.size()));
        return text.substr(begin, at - begin);
    }
    std::string word() { return until(" \t\r\n"); }
    std::string rest() { return until("\r\n"); } ///< of the line

    template <class Number>
    Number read(const char *what, double least, double most) {
        const std::string here = word();
        Number value{};
        if (!vcg::fcd::detail::ToNumber(here.data(), here.data() + here.size(), value) ||
            !(double(value) >= least && double(value) <= most)) // also for NaN
            expected(what, here);
        return value;
    }
    double number(const char *what, double least = -std::numeric_limits<double>::max(),
                  double most = std::numeric_limits<double>::max()) {
        return read<double>(what, least, most);
    }
    int whole(const char *what, int least, int most) { return read<int>(what, least, most); }
    int tag() { return whole("the tag of a handle, from 2", 2, std::numeric_limits<int>::max()); }
    template <class Number>
    Number radius() {
        return read<Number>("a radius greater than 0", double(std::numeric_limits<Number>::min()),
                            double(std::numeric_limits<Number>::max()));
    }
    std::size_t vertex(std::size_t least = 0) { ///< its number
        return read<std::size_t>("a vertex of the layer", double(least), double(live.size()) - 1);
    }
    Eigen::Vector3d vector(const char *what) {
        Eigen::Vector3d v;
        for (double &x : v)
            x = number(what);
        return v;
    }

    const std::vector<std::size_t> &live;
    const std::size_t vertexSlots;
    BendState state;
    BendOptions options;
    BendTags marks;
    BendRims rims;
    std::set<std::size_t> taken; ///< slots of points
};

std::string textOf(const Eigen::Vector3d &v) { return ToText(v[0]) + " " + ToText(v[1]) + " " + ToText(v[2]); }

/// The vertices of each value, a line each. \param none the value that is left out
template <class Value>
std::string rangesText(const std::string &key, const std::vector<Value> &values, Value none,
                       const std::vector<std::size_t> &live) {
    std::map<Value, std::string> lines;
    for (std::size_t first = 0, last = 0; first < live.size(); first = last + 1) {
        const Value value = values[live[first]];
        for (last = first; last + 1 < live.size() && values[live[last + 1]] == value;)
            ++last;
        if (value != none)
            lines[value] += " " + ToText(first) + " " + ToText(last);
    }
    std::string text;
    for (const auto &[value, ranges] : lines)
        text += key + " " + ToText(value) + ranges + "\n";
    return text;
}

std::string handleText(int tag, const BendHandle &handle) {
    const std::string ofTag = " " + ToText(tag);
    std::string text, name = handle.name;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '\n' || c == '\r' || c == '\0'; }, ' ');
    if (!name.empty())
        text += "name" + ofTag + " " + name + "\n";
    if (handle.isHidden)
        text += "hidden" + ofTag + "\n";
    if (handle.isLocked)
        text += "locked" + ofTag + "\n";
    if (handle.pivot)
        text += "pivot" + ofTag + " " + textOf(*handle.pivot) + "\n";
    return text;
}

} // namespace

std::string bendText(const BendState &state, const BendOptions &options, const std::vector<std::size_t> &live) {
    const auto liveNumber = [&](std::size_t slot) { // corners of weight 0 may be deleted
        const auto found = std::lower_bound(live.begin(), live.end(), slot);
        return ToText(std::min(std::size_t(found - live.begin()), live.size() - 1));
    };
    std::string text = std::string(firstLine) + "\nsmoothness " + ToText(options.smoothness) + "\ndetail " +
                       ToText(options.initialPatches) + "\ndistances " + ToText(int(options.weights)) + "\nsymmetry " +
                       ToText(options.mirror) + "\naxes " + ToText(int(options.axes)) + "\npose " + ToText(state.pose) +
                       "\n";
    if (options.falloff != vcg::fcd::Falloff::Smooth) // so that older versions can read it
        text += "falloff " + ToText(int(options.falloff)) + "\n";
    if (options.elastic) // as above
        text += "elastic 1\n";
    if (options.rigidity != BendOptions().rigidity) // as above
        text += "rigidity " + ToText(options.rigidity) + "\n";
    for (const auto &[tag, point] : state.points)
        text += "point " + ToText(tag) + " " + liveNumber(point.slot) + " " + ToText(point.radius) +
                (point.isGrip ? " grip\n" : "\n");
    for (const auto &[tag, rank] : state.rank)
        text += "rank " + ToText(tag) + " " + ToText(rank) + "\n";
    for (const auto &[tag, handle] : state.handles)
        text += handleText(tag, handle);
    if (const std::string motions = vcg::fcd::WriteMotionText(state.motion); !motions.empty())
        text += "motions " + motions + "\n";
    if (state.marks)
        text += rangesText("mark", *state.marks, 1, live);
    if (state.rims)
        text += rangesText("rim", *state.rims, 0.f, live);
    if (!state.weights.empty()) {
        text += "weights";
        for (const double percent : state.weights)
            text += " " + ToText(percent);
        text += '\n';
    }
    for (const BendLinePoint &each : state.line) {
        text += "line";
        for (const std::size_t corner : each.corner)
            text += " " + liveNumber(corner);
        text += " " + textOf(each.weight) + " " + textOf(each.place) + "\n";
    }
    return text;
}

std::pair<BendState, BendOptions> readBendText(const std::string &text, const std::string &name,
                                               const std::vector<std::size_t> &live, std::size_t vertexSlots) {
    return BendTextReader(text, name, live, vertexSlots).read();
}
