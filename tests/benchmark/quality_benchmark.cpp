// SPDX-License-Identifier: GPL-3.0-or-later
//
// quality_benchmark [OPTION...] [STEM...]
//
// How near the shapes that we make are to those of CGAL's SR-ARAP of the mesh itself, run to convergence, and what
// moves them. Half of the cases are for choosing the constants that shape the result (training), the others are only
// shown (held out); STEM.off or STEM.ply, STEM.sel and STEM.def are further ones. Each result is a median and the worst
// over some seeds of the patches:
//   rms, max      distance to the reference, % of the diagonal of the free vertices' bounding box
//   bend          |change of a dihedral angle|, 99th percentile and maximum, over the reference's own
//   volume        enclosed volume over the reference's, difference from 1 in %; closed meshes only
//   spoiled       triangles that look away from where they do in the reference, or have lost 99 % of their area
//   to limit      as rms, but to our own result with a node at every vertex (--limit)
// Means are geometric; of volume they are those of its size, of spoiled the sum.
#include "quality_reference.h"

#include "case_files.h"

#include <vcg_ext/centroidal_deformation.h>

#include <CLI/CLI.hpp>

#include <cstdio>
#include <fstream>
#include <optional>

namespace {

using namespace benchmark;
using Eigen::Vector3d;
using Positions = Eigen::Matrix3Xd; // a column per vertex
using vcg::fcd::DeformationParam;

// ---------------------------------------------------------------------------------------------------------- measures
// --

enum Measure { Rms, Max, Bend99, BendMax, Volume, Spoiled, ToLimit, measures };
using Measures = std::array<double, measures>;

Positions PositionsOf(const Mesh &mesh) {
    Positions p(3, mesh.vert.size());
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        p.col(i) = Vector3d(mesh.vert[i].cP()[0], mesh.vert[i].cP()[1], mesh.vert[i].cP()[2]);
    return p;
}

/// Measures deformed positions of a problem's mesh.
class Yardstick {
  public:
    Yardstick(const Problem &problem, const Positions &reference) : reference(reference) {
        const Mesh &mesh = problem.mesh;
        const std::vector<int> &tag = problem.handles.tag;
        const Positions rest = PositionsOf(mesh);
        Eigen::AlignedBox3d box;
        for (std::size_t i = 0; i < tag.size(); ++i)
            if (tag[i] == 1) {
                free.push_back(int(i));
                box.extend(rest.col(i));
            }
        diagonal = box.diagonal().norm();
        for (const Face &f : mesh.face)
            face.push_back({int(vcg::tri::Index(mesh, f.cV(0))), int(vcg::tri::Index(mesh, f.cV(1))),
                            int(vcg::tri::Index(mesh, f.cV(2)))});
        const auto isFree = [&](int f) {
            return std::any_of(face[f].begin(), face[f].end(), [&](int v) { return tag[v] == 1; });
        };
        std::map<std::pair<int, int>, std::vector<int>> facesAt;
        for (int f = 0; f < int(face.size()); ++f) {
            if (isFree(f))
                freeFace.push_back(f);
            for (int corner = 0; corner < 3; ++corner)
                facesAt[std::minmax(face[f][corner], face[f][(corner + 1) % 3])].push_back(f);
        }
        for (const auto &[ends, at] : facesAt) {
            closed &= at.size() == 2;
            if (at.size() == 2 && (isFree(at[0]) || isFree(at[1])))
                edge.push_back({ends.first, ends.second, at[0], at[1]});
        }
        restNormal = NormalsOf(rest);
        restAngle = AnglesOf(rest, restNormal);
        restVolume = VolumeOf(rest);
        referenceNormal = NormalsOf(reference);
        referenceBend = BendOf(reference, referenceNormal);
        referenceVolume = VolumeOf(reference);
    }

    Measures Of(const Positions &p, const std::optional<Positions> &limit = {}) const {
        Measures m;
        const auto normal = NormalsOf(p);
        const auto bend = BendOf(p, normal);
        m[Rms] = Distance(p, reference);
        m[Max] = 0;
        for (int v : free)
            m[Max] = std::max(m[Max], 100 / diagonal * (p.col(v) - reference.col(v)).norm());
        m[Bend99] = bend.first / referenceBend.first;
        m[BendMax] = bend.second / referenceBend.second;
        m[Volume] = closed ? 100 * (VolumeOf(p) / referenceVolume - 1) : std::nan("");
        m[Spoiled] = SpoiledIn(normal);
        m[ToLimit] = limit ? Distance(p, *limit) : std::nan("");
        return m;
    }

    /// Root mean square over the free vertices, % of the diagonal.
    double Distance(const Positions &a, const Positions &b) const {
        double sum = 0;
        for (int v : free)
            sum += (a.col(v) - b.col(v)).squaredNorm();
        return 100 / diagonal * std::sqrt(sum / double(free.size()));
    }

    int FreeVertices() const { return int(free.size()); }
    std::pair<double, double> ReferenceBend() const { return referenceBend; } ///< degrees
    double ReferenceVolume() const {
        return closed ? referenceVolume / restVolume : std::nan("");
    } ///< over that at rest
    double ReferenceSpoiled() const { return SpoiledIn(referenceNormal); }

  private:
    /// A column per face, twice its area long.
    Positions NormalsOf(const Positions &p) const {
        Positions normal(3, face.size());
        for (std::size_t f = 0; f < face.size(); ++f) {
            const Vector3d a = p.col(face[f][0]), b = p.col(face[f][1]), c = p.col(face[f][2]);
            normal.col(f) = (b - a).cross(c - a);
        }
        return normal;
    }

    /// Signed, of the edges, in degrees.
    std::vector<double> AnglesOf(const Positions &p, const Positions &normal) const {
        std::vector<double> angle;
        for (const auto &[a, b, f, g] : edge) {
            const Vector3d along = (p.col(b) - p.col(a)).normalized();
            const Vector3d m = normal.col(f).normalized(), n = normal.col(g).normalized();
            angle.push_back(std::atan2(m.cross(n).dot(along), m.dot(n)) * 180 / M_PI);
        }
        return angle;
    }

    /// 99th percentile and maximum of what the angles changed by, in degrees.
    std::pair<double, double> BendOf(const Positions &p, const Positions &normal) const {
        std::vector<double> bend = AnglesOf(p, normal);
        for (std::size_t e = 0; e < bend.size(); ++e)
            bend[e] = std::abs(std::remainder(bend[e] - restAngle[e], 360));
        const auto at99 = bend.begin() + std::ptrdiff_t(0.99 * double(bend.size() - 1));
        std::nth_element(bend.begin(), at99, bend.end());
        return {*at99, *std::max_element(at99, bend.end())};
    }

    double SpoiledIn(const Positions &normal) const {
        return double(std::count_if(freeFace.begin(), freeFace.end(), [&](int f) {
            return normal.col(f).dot(referenceNormal.col(f)) < 0 ||
                   normal.col(f).norm() < 0.01 * restNormal.col(f).norm();
        }));
    }

    double VolumeOf(const Positions &p) const {
        double sum = 0;
        for (const auto &[a, b, c] : face)
            sum += p.col(a).dot(p.col(b).cross(p.col(c))) / 6;
        return sum;
    }

    Positions reference;
    std::vector<int> free, freeFace;
    std::vector<std::array<int, 3>> face;
    std::vector<std::array<int, 4>> edge; // ends and faces of those with two faces, one of them free
    double diagonal = 0;
    bool closed = true;
    Positions restNormal, referenceNormal;
    std::vector<double> restAngle;
    std::pair<double, double> referenceBend;
    double restVolume = 0, referenceVolume = 0;
};

// -------------------------------------------------------------------------------------------------------------- runs
// --

/// What shapes the result. \c at gives the place of its value.
struct Constant {
    const char *name;
    double &(*at)(DeformationParam &);
};
const Constant constants[] = {
    {"smoothness", [](DeformationParam &p) -> double & { return p.smoothness; }},
    {"influence", [](DeformationParam &p) -> double & { return p.influence; }},
    {"patchRadius", [](DeformationParam &p) -> double & { return p.shape.patchRadius; }},
    {"heldDepth", [](DeformationParam &p) -> double & { return p.shape.heldDepth; }},
    {"leastWeight", [](DeformationParam &p) -> double & { return p.shape.leastWeight; }},
    {"tensorRidge", [](DeformationParam &p) -> double & { return p.shape.tensorRidge; }},
    {"mostTensorChange", [](DeformationParam &p) -> double & { return p.shape.mostTensorChange; }},
    {"smallHeldPart", [](DeformationParam &p) -> double & { return p.shape.smallHeldPart; }},
    {"surrounded", [](DeformationParam &p) -> double & { return p.shape.surrounded; }},
    {"blendWidth", [](DeformationParam &p) -> double & { return p.shape.blendWidth; }},
    {"smallBlendWidth", [](DeformationParam &p) -> double & { return p.shape.smallBlendWidth; }},
    {"openness", [](DeformationParam &p) -> double & { return p.shape.openness; }},
    {"detour", [](DeformationParam &p) -> double & { return p.shape.detour; }},
    {"longDetour", [](DeformationParam &p) -> double & { return p.shape.longDetour; }},
    {"nearby", [](DeformationParam &p) -> double & { return p.shape.nearby; }},
    {"shareBall", [](DeformationParam &p) -> double & { return p.shape.shareBall; }},
};

/// From the paper to what is here, one step after the other.
struct Step {
    const char *name;
    void (*take)(DeformationParam &);
};
const Step steps[] = {
    {"the paper to the letter",
     [](DeformationParam &p) {
         p.graphWeights = vcg::fcd::GraphWeights::Printed;
         p.graph.measure = vcg::fcd::PatchMeasure::Vertices;
         p.weights = vcg::fcd::MappingWeights::Euclidean;
     }},
    {"mapping, held parts that give way, end",
     [](DeformationParam &p) { p.graphWeights = vcg::fcd::GraphWeights::Uniform; }},
    {"patches by area", [](DeformationParam &p) { p.graph.measure = vcg::fcd::PatchMeasure::Area; }},
    {"weights from borders", [](DeformationParam &p) { p.graphWeights = vcg::fcd::GraphWeights::Border; }},
    {"along the surface: the defaults", [](DeformationParam &p) { p.weights = vcg::fcd::MappingWeights::Surface; }},
};

struct Loaded {
    Case of;
    Instance instance;
    Reference reference;
    Yardstick yardstick;
    std::optional<Positions> limit;
};

Positions Deform(const Problem &problem, const DeformationParam &param, int &nodes) {
    const auto result = vcg::tri::DeformCentroidal(problem.mesh, problem.handles, param);
    nodes = int(result.rest.position.cols());
    return result.position;
}

Loaded Load(const Case &of, const std::filesystem::path &cache) {
    Instance instance = of.make();
    Reference reference = MakeReference(instance.fine ? *instance.fine : *instance.problem, cache);
    if (instance.fine)
        reference.position = Positions(reference.position(Eigen::all, instance.inFine));
    Yardstick yardstick(*instance.problem, reference.position);
    return {of, std::move(instance), reference, yardstick, {}};
}

/// Over the seeds.
struct Outcome {
    int nodes = 0; ///< most
    Measures median{}, worst{};
};

Outcome Evaluate(const Loaded &loaded, DeformationParam param, int patches, int seeds) {
    Outcome outcome;
    std::vector<Measures> runs;
    param.graph.initialPatches = patches;
    for (int seed = 1; seed <= seeds; ++seed) {
        param.graph.randomSeed = unsigned(seed);
        int nodes = 0;
        runs.push_back(loaded.yardstick.Of(Deform(*loaded.instance.problem, param, nodes), loaded.limit));
        outcome.nodes = std::max(outcome.nodes, nodes);
    }
    for (int m = 0; m < measures; ++m) {
        std::vector<double> values;
        for (const Measures &run : runs)
            values.push_back(run[m]);
        const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
        std::sort(values.begin(), values.end(), smaller);
        outcome.median[m] = values[values.size() / 2];
        outcome.worst[m] = values.back();
    }
    return outcome;
}

/// Over cases; of the same number of patches.
Outcome MeanOf(const std::vector<Outcome> &outcomes) {
    const auto mean = [&](Measures Outcome::*which, int m) {
        double sum = 0, logarithms = 0, count = 0;
        for (const Outcome &o : outcomes)
            if (const double value = std::abs((o.*which)[m]); !std::isnan(value)) {
                sum += value;
                logarithms += std::log(std::max(value, 1e-9)); // a result may be the reference
                ++count;
            }
        return count == 0 ? std::nan("") : m == Spoiled ? sum : std::exp(logarithms / count);
    };
    Outcome result;
    for (int m = 0; m < measures; ++m) {
        result.median[m] = mean(&Outcome::median, m);
        result.worst[m] = mean(&Outcome::worst, m);
    }
    return result;
}

// ------------------------------------------------------------------------------------------------------------ tables
// --

enum class Format { Text, Csv, Markdown };

struct Column {
    std::string title;
    int width; ///< of text; negative: to the left
};

/// Prints its rows as they come.
class Table {
  public:
    Table(Format format, std::vector<Column> columns) : format(format), columns(std::move(columns)) {
        std::printf("\n");
        std::vector<std::string> titles, rules;
        for (const Column &c : this->columns) {
            titles.push_back(c.title);
            rules.push_back(c.width < 0 ? "---" : "---:");
        }
        Row(titles);
        if (format == Format::Markdown)
            Row(rules);
    }
    void Row(const std::vector<std::string> &cells) const {
        std::string line;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (format == Format::Text) {
                const std::string space(std::size_t(std::max(0, std::abs(columns[i].width) - int(cells[i].size()))),
                                        ' ');
                line += (i > 0 ? " " : "") + (columns[i].width < 0 ? cells[i] + space : space + cells[i]);
            } else if (format == Format::Csv)
                line +=
                    (i > 0 ? "," : "") + (cells[i].find(',') == std::string::npos ? cells[i] : '"' + cells[i] + '"');
            else
                line += (i > 0 ? " | " : "| ") + cells[i] + (i + 1 == cells.size() ? " |" : "");
        }
        line.erase(line.find_last_not_of(' ') + 1);
        std::printf("%s\n", line.c_str());
        std::fflush(stdout);
    }

  private:
    Format format;
    std::vector<Column> columns;
};

std::string Text(double value, int decimals) {
    if (std::isnan(value))
        return "-";
    char text[400]; // the longest double has 309 digits
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    return text;
}

const std::pair<Half, std::string> halves[] = {
    {Half::Training, "training"}, {Half::HeldOut, "held out"}, {Half::Buckles, "buckles"}, {Half::Given, "given"}};

std::string NameOf(Half half) {
    return std::find_if(std::begin(halves), std::end(halves), [&](const auto &h) { return h.first == half; })->second;
}

struct Shown {
    Measure measure;
    std::string title;
    int decimals;
};

std::vector<std::string> Cells(const std::string &name, const std::string &half, int patches, const Outcome &outcome,
                               const std::vector<Shown> &shown) {
    std::vector<std::string> cells = {name, half, std::to_string(patches),
                                      outcome.nodes > 0 ? std::to_string(outcome.nodes) : ""};
    for (const Shown &s : shown)
        for (const Measures *m : {&outcome.median, &outcome.worst})
            cells.push_back(Text((*m)[s.measure], s.decimals));
    return cells;
}

void Save(Loaded &loaded, const Positions &deformed, const std::filesystem::path &directory) {
    const std::string stem = directory / loaded.of.name;
    Problem &problem = *loaded.instance.problem;
    const Positions rest = PositionsOf(problem.mesh);
    WriteOff(problem.mesh, loaded.reference.position, stem + "_reference.off");
    WriteOff(problem.mesh, deformed, stem + "_fcd.off");
    WriteOff(problem.mesh, rest, stem + ".off");
    std::ofstream(stem + ".sel", std::ios::binary) << vcg::fcd::TagText(problem.handles.tag);
}

} // namespace

int main(int argc, char **argv) {
    CLI::App app{"Compares our shapes with CGAL's converged SR-ARAP: rms and largest distance (% of the free region's "
                 "diagonal), bends over the reference's, volume (%), spoiled triangles; median and worst over seeds."};
    std::vector<std::string> stems, only, set;
    std::vector<int> patches = {300, 1000, 3000};
    std::filesystem::path directory;
    int seeds = 5;
    bool training = false, heldOut = false, csv = false, markdown = false, withLimit = false, sensitivity = false,
         withSteps = false;
    app.add_option("stem", stems, "cases from files instead: STEM.off or STEM.ply, STEM.sel, STEM.def");
    app.add_flag("--training", training, "only the cases that constants are chosen on");
    app.add_flag("--held-out", heldOut, "only the others");
    app.add_option("--cases", only, "only the cases of these names")->delimiter(',');
    app.add_option("--patches", patches, "initial patches")
        ->delimiter(',')
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--seeds", seeds, "1 up to this")->check(CLI::PositiveNumber)->capture_default_str();
    app.add_flag("--limit", withLimit, "also the distance to our result with a node at every vertex");
    app.add_flag("--sensitivity", sensitivity, "also what halving and doubling each constant does");
    app.add_flag("--steps", withSteps, "also what each step from the paper to this program does");
    app.add_option("--set", set, "other values of constants: NAME=VALUE,...")->delimiter(',');
    app.add_option("--save", directory, "folder for the meshes: NAME.off, NAME_reference.off, NAME_fcd.off, NAME.sel");
    app.add_flag("--csv", csv);
    app.add_flag("--markdown", markdown)->excludes("--csv");
    CLI11_PARSE(app, argc, argv);
    const Format format = csv ? Format::Csv : markdown ? Format::Markdown : Format::Text;

    try {
        DeformationParam param;
        for (const std::string &assignment : set) {
            const std::size_t equals = assignment.find('=');
            const auto found = std::find_if(std::begin(constants), std::end(constants),
                                            [&](const Constant &c) { return c.name == assignment.substr(0, equals); });
            if (found == std::end(constants) || equals == std::string::npos)
                throw vcg::fcd::Error("'" + assignment + "' gives no constant a value: NAME=VALUE");
            found->at(param) = std::stod(assignment.substr(equals + 1));
        }
        const char *cacheHome = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
        const std::filesystem::path cache =
            (cacheHome ? std::filesystem::path(cacheHome) : std::filesystem::path(home ? home : ".") / ".cache") /
            "fcd/references";
        std::vector<Case> cases;
        for (const std::string &stem : stems)
            cases.push_back(CaseOfFiles(stem));
        if (stems.empty())
            for (const Case &c : MakeCases())
                if ((c.half == Half::Training ? training || !heldOut : heldOut || !training) &&
                    (only.empty() || std::count(only.begin(), only.end(), c.name)))
                    cases.push_back(c);

        std::vector<Loaded> loaded;
        const Table references(format, {{"case", -16},
                                        {"half", -8},
                                        {"vertices", 8},
                                        {"free", 6},
                                        {"iterations", 10},
                                        {"last step %", 11},
                                        {"left %", 7},
                                        {"seconds", 7},
                                        {"bend p99", 8},
                                        {"bend max", 8},
                                        {"volume", 6},
                                        {"spoiled", 7},
                                        {"limit rms %", 11},
                                        {"what", -1}});
        for (const Case &c : cases) {
            loaded.push_back(Load(c, cache));
            Loaded &l = loaded.back();
            if (withLimit) {
                DeformationParam every = param; // a node at every vertex, and converged
                every.graph.initialPatches = 10 * int(l.instance.problem->mesh.vert.size());
                every.tolerance = 1e-6;
                every.maxIterations = 10000;
                int nodes;
                l.limit = Deform(*l.instance.problem, every, nodes);
            }
            const Yardstick &y = l.yardstick;
            references.Row({c.name, NameOf(c.half), std::to_string(l.instance.problem->mesh.vert.size()),
                            std::to_string(y.FreeVertices()), std::to_string(l.reference.iterations),
                            Text(100 * l.reference.moved, 6), Text(100 * l.reference.remaining, 4),
                            Text(l.reference.seconds, 1), Text(y.ReferenceBend().first, 1),
                            Text(y.ReferenceBend().second, 1), Text(y.ReferenceVolume(), 3),
                            Text(y.ReferenceSpoiled(), 0),
                            Text(l.limit ? y.Distance(*l.limit, l.reference.position) : std::nan(""), 3), c.what});
        }

        std::vector<Shown> shown = {{Rms, "rms %", 3},        {Max, "max %", 2},     {Bend99, "bend p99", 2},
                                    {BendMax, "bend max", 2}, {Volume, "volume", 2}, {Spoiled, "spoiled", 0}};
        if (withLimit)
            shown.push_back({ToLimit, "to limit", 3});
        std::vector<Column> columns = {{"case", -16}, {"half", -8}, {"patches", 7}, {"nodes", 6}};
        for (const Shown &s : shown) {
            columns.push_back({s.title, 8});
            columns.push_back({"worst", 6});
        }
        const Table results(format, columns);
        using Outcomes = std::map<Half, std::map<int, std::vector<Outcome>>>;
        Outcomes outcomes;
        for (Loaded &l : loaded) {
            for (int k : patches) {
                const Outcome outcome = Evaluate(l, param, k, seeds);
                outcomes[l.of.half][k].push_back(outcome);
                results.Row(Cells(l.of.name, NameOf(l.of.half), k, outcome, shown));
            }
            if (!directory.empty()) {
                int nodes;
                param.graph.initialPatches = patches.front();
                Save(l, Deform(*l.instance.problem, param, nodes), directory);
            }
        }
        for (const auto &[half, of] : outcomes)
            for (int k : patches)
                results.Row(Cells("mean", NameOf(half), k, MeanOf(of.at(k)), shown));

        if (sensitivity || withSteps) {
            columns = {{sensitivity ? "constant" : "step", -40}, {"value", 9}, {"half", -8}};
            const std::vector<std::pair<Measure, std::string>> moving = {
                {Rms, "rms %"}, {Bend99, "bend p99"}, {BendMax, "bend max"}};
            const auto inOne = [&](const auto &cellOf) { // of all numbers of patches
                std::string cell;
                for (int k : patches)
                    cell += (cell.empty() ? "" : " / ") + cellOf(k);
                return cell;
            };
            for (const auto &[measure, title] : moving)
                columns.push_back({title + ", " + inOne([](int k) { return std::to_string(k); }), 30});
            const Table table(format, columns);
            const auto row = [&](const std::string &name, const std::string &value, const Outcomes &all) {
                for (const auto &[half, of] : all) {
                    std::vector<std::string> cells = {name, value, NameOf(half)};
                    for (const auto &[measure, title] : moving)
                        cells.push_back(inOne([&, m = measure](int k) { return Text(MeanOf(of.at(k)).median[m], 2); }));
                    table.Row(cells);
                }
            };
            const auto show = [&](const std::string &name, const std::string &value, const DeformationParam &other) {
                Outcomes changed;
                for (const Loaded &l : loaded)
                    for (int k : patches)
                        changed[l.of.half][k].push_back(Evaluate(l, other, k, seeds));
                row(name, value, changed);
            };
            row("as it is", "", outcomes);
            if (sensitivity)
                for (const Constant &constant : constants)
                    for (double factor : {0.5, 2.0}) {
                        DeformationParam other = param;
                        constant.at(other) *= factor;
                        show(constant.name, Text(constant.at(other), 5), other);
                    }
            if (withSteps) {
                DeformationParam other = param;
                for (const Step &step : steps) {
                    step.take(other);
                    show(step.name, "", other);
                }
            }
        }
    } catch (const std::exception &e) {
        std::fprintf(stderr, "quality_benchmark: %s\n", e.what());
        return 1;
    }
    return 0;
}
