// SPDX-License-Identifier: GPL-3.0-or-later
// The extension of pymeshlab_fcd: the method on numpy's arrays. Python has checked the arguments: kinds, shapes,
// layout.
#include "compensated.h"
#include "field.h"
#include "fitted.h"
#include "posed.h"
#include "prepared.h"
#include "sequenced.h"
#include "straightened.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <exception>

namespace {

/// Turns errors of the method into those of Python.
void translate(const std::exception_ptr &thrown, void *) {
    try {
        std::rethrow_exception(thrown);
    } catch (const vcg::fcd::BadInput &error) {
        PyErr_SetString(PyExc_ValueError, error.what());
    } catch (const vcg::fcd::Error &error) {
        PyErr_SetString(PyExc_RuntimeError, error.what());
    }
}

/// \param given parameters by name
vcg::fcd::DeformationParam paramOf(const nb::dict &given) {
    using namespace vcg::fcd;
    DeformationParam param;
    const auto number = [&](const char *name) { return nb::cast<double>(given[name]); };
    const auto whole = [&](const char *name) { return nb::cast<int>(given[name]); };
    param.graph.initialPatches = whole("patches");
    param.graph.targetRadius = number("target_radius");
    param.graph.randomSeed = nb::cast<unsigned>(given["seed"]);
    param.graph.measure = nb::cast<bool>(given["by_vertices"]) ? PatchMeasure::Vertices : PatchMeasure::Area;
    param.graphWeights = GraphWeights(whole("graph_weights"));
    if (given.contains("falloff")) // absent without handles, and in older pickles
        param.falloff = Falloff(whole("falloff"));
    if (given.contains("elastic"))
        param.elastic = nb::cast<bool>(given["elastic"]);
    if (given.contains("rigidity"))
        param.rigidity = number("rigidity");
    param.weights = MappingWeights(whole("weights"));
    param.looseParts = LooseParts(whole("loose_parts"));
    param.influence = number("influence");
    param.weldDistance = number("weld_distance");
    param.smoothness = number("smoothness");
    param.maxIterations = whole("max_iterations");
    param.tolerance = number("tolerance");
    if (!given["nodes"].is_none()) {
        const auto nodes = nb::cast<Rows>(given["nodes"]);
        param.nodes = Eigen::Map<const Eigen::Matrix3Xd>(nodes.data(), 3, Eigen::Index(nodes.shape(0)));
    }
    return param;
}

std::shared_ptr<Prepared> prepare(const Rows &vertices, const std::optional<Corners> &faces,
                                  const Given<std::int32_t, nb::ndim<1>> &tags,
                                  const Given<std::int64_t, nb::ndim<1>> &points, const nb::dict &param,
                                  unsigned threads, const nb::object &report, const std::shared_ptr<Prepared> &kept) {
    return std::make_shared<Prepared>(vertices, faces, tags, points, paramOf(param), threads, report, kept.get());
}

std::unique_ptr<Posed> solve(const std::shared_ptr<Prepared> &prepared,
                             std::vector<std::pair<int, std::string>> motions, const std::optional<Rows> &targets,
                             double percent, int steps, const Posed *start, const nb::object &report) {
    return std::make_unique<Posed>(prepared, PoseParam{std::move(motions), targets, percent, steps}, start, report);
}

std::shared_ptr<Prepared> prepareFree(const Rows &vertices, const std::optional<Corners> &faces, const nb::dict &given,
                                      unsigned threads, const nb::object &report) {
    vcg::fcd::DeformationParam param = paramOf(given);
    param.bendsUnheld = true;
    return std::make_shared<Prepared>(vertices, faces, param, threads, report);
}

} // namespace

NB_MODULE(_core, module) {
    using nb::arg;
    nb::register_exception_translator(translate);
    module.attr("__version__") = FCD_VERSION;
    nb::class_<Field>(module, "Field")
        .def_static("read", &Field::read, arg("content"), arg("name"), arg("threads"))
        .def("content", &Field::content)
        .def_prop_ro("samples", &Field::samples)
        .def_prop_ro("largest_difference", &Field::largestDifference)
        .def("positions", &Field::positions)
        .def("space_remark", &Field::spaceRemark, arg("xyz"))
        .def("apply", &Field::apply, arg("xyz"), arg("normals").none(), arg("threads"), arg("report").none())
        .def("linear", &Field::linear, arg("xyz"), arg("threads"), arg("report").none());
    nb::class_<Prepared>(module, "Prepared")
        .def("graph", &Prepared::graph)
        .def("patch_of", &Prepared::patchOf)
        .def("weights", &Prepared::weights, arg("report").none())
        .def("report", &Prepared::report)
        .def("centers", &Prepared::centers)
        .def("normals_of", &Prepared::normalsOf, arg("positions"), arg("out"));
    nb::class_<Posed>(module, "Posed")
        .def("write", &Posed::write, arg("vertices"), arg("normals").none(), arg("turned").none(), arg("report").none())
        .def("check", &Posed::check, arg("vertices"), arg("report").none())
        .def("contact", &Posed::contact, arg("vertices"), arg("report").none())
        .def("stretch", &Posed::stretch, arg("vertices"), arg("report").none())
        .def("map", &Posed::map, arg("points"), arg("normals").none(), arg("report").none())
        .def("field", &Posed::field, arg("inverse"), arg("accuracy"), arg("report").none())
        .def("nodes", &Posed::nodes)
        .def("info", &Posed::info)
        .def("discretisation_error", &Posed::discretisationError, arg("report").none())
        .def("state", &Posed::state);
    module.def("prepare", &prepare, arg("vertices"), arg("faces").none(), arg("tags"), arg("points"), arg("param"),
               arg("threads"), arg("report").none(), arg("kept").none());
    module.def("solve", &solve, arg("prepared"), arg("motions"), arg("targets").none(), arg("percent"), arg("steps"),
               arg("start").none(), arg("report").none());
    module.def(
        "restore",
        [](const std::shared_ptr<Prepared> &prepared, const nb::bytes &state) {
            return std::make_unique<Posed>(prepared, state);
        },
        arg("prepared"), arg("state"));
    module.def("prepare_free", &prepareFree, arg("vertices"), arg("faces").none(), arg("param"), arg("threads"),
               arg("report").none());
    module.def("straighten", &straighten, arg("prepared"), arg("goal"), arg("report").none());
    nb::class_<Fitting>(module, "Fitting")
        .def(nb::init<const Rows &, const std::optional<Corners> &, const Given<std::int32_t, nb::ndim<1>> &,
                      const std::vector<std::pair<int, std::string>> &, const std::optional<Rows> &, const nb::dict &,
                      unsigned, const nb::object &>(),
             arg("vertices"), arg("faces").none(), arg("tags"), arg("motions"), arg("normals").none(), arg("param"),
             arg("threads"), arg("report").none())
        .def_ro("prepared", &Fitting::prepared)
        .def("fit", &Fitting::fit, arg("goal"), arg("landmarks"), arg("leave_one_out"), arg("report").none())
        .def("along", &Fitting::along, arg("curves"), arg("report").none())
        .def("symmetrize", &Fitting::symmetrize, arg("goal"), arg("normals").none(), arg("weights").none(),
             arg("report").none())
        .def("put", &Fitting::put, arg("landmarks"), arg("vertices"))
        .def("residuals", &Fitting::residuals, arg("posed"), arg("checks"), arg("vertices"));
    nb::class_<Compensating>(module, "Compensating")
        .def(nb::init<const Rows &, const std::optional<Corners> &, const Rows &, const std::optional<Corners> &,
                      const std::optional<Rows> &, const nb::dict &, unsigned, const nb::object &>(),
             arg("vertices"), arg("faces").none(), arg("scan"), arg("scan_faces").none(), arg("scan_normals").none(),
             arg("param"), arg("threads"), arg("report").none())
        .def(nb::init<const nb::bytes &>(), arg("state"))
        .def("state", &Compensating::state)
        .def("told", &Compensating::told)
        .def("warnings", &Compensating::warnings)
        .def("made", &Compensating::made)
        .def("apply", &Compensating::apply, arg("points"), arg("predicted"), arg("report").none());
    nb::class_<Sequence>(module, "Sequence")
        .def(nb::init<const std::vector<std::pair<std::string, std::string>> &, const std::vector<Sequence::Key> &>(),
             arg("poses"), arg("keys"))
        .def_static(
            "parse", [](const std::string &text, const std::string &name) { return Sequence(text, name); }, arg("text"),
            arg("name"))
        .def("text", &Sequence::text, arg("prepared").none())
        .def("state", &Sequence::state)
        .def("poses", &Sequence::poses)
        .def("keys", &Sequence::keys)
        .def("weights_at", &Sequence::weightsAt, arg("time"))
        .def("times", &Sequence::times, arg("rate"))
        .def("write", &Sequence::write, arg("prepared"), arg("rate"), arg("gltf").none(), arg("shapes"),
             arg("pc2").none(), arg("mdd").none(), arg("look"), arg("others"), arg("report").none());
    nb::class_<Sequencer>(module, "Sequencer")
        .def(nb::init<std::shared_ptr<Prepared>, const Sequence &>(), arg("prepared"), arg("sequence"))
        .def("go", &Sequencer::go, arg("weights"), arg("report").none());
    module.def("read_curves", &readCurves, arg("content"), arg("name"));
    module.def("nearest_vertices", &nearestVertices, arg("vertices"), arg("points"), arg("threads"),
               arg("report").none());
    module.def("checksum", &checksum, arg("rows"), arg("threads"));
}
