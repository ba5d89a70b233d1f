// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_parameters.h"
#include "filter_fcd.h"

#include <layer_fcd/session_file.h>

// FCD: Save Session and FCD: Load Session.

using host::Shown;
using vcg::fcd::Error;

void ask(Fields &fields, SaveSessionParam &param) {
    fields.saveFile("session_file", param.file, Shown::Always, "*.fcd", "Write session to (.fcd)",
                    "The file to write. An existing file is replaced.");
    if (fields.areRead() && param.file.isEmpty())
        throw Error("session_file is empty. Give the .fcd file to write the session to.");
}

void ask(Fields &fields, LoadSessionParam &param) {
    fields.openFile("session_file", param.file, Shown::Always, {"*.fcd"}, "Session (.fcd)",
                    "A file of 'FCD: Save Session' for this very layer.");
    if (fields.areRead() && param.file.isEmpty())
        throw Error("session_file is empty. Give the .fcd file with the session.");
}

namespace {

/// What a session has. \param saved it was saved; otherwise, loaded
std::string describe(const SessionContents &contents, bool saved) {
    std::string has;
    const auto add = [&has](const std::string &what) { has += (has.empty() ? "" : ", ") + what; };
    if (contents.marks)
        add("marks");
    if (contents.colors)
        add("what tags stand in the place of");
    if (contents.rest)
        add(contents.earlier == 0   ? std::string("the rest shape")
            : contents.earlier == 1 ? std::string("the rest shape and the one before it")
                                    : "the rest shape and the " + std::to_string(contents.earlier) + " before it");
    if (contents.poses > 0)
        add(contents.poses == 1 ? std::string("a pose") : std::to_string(contents.poses) + " poses");
    if (contents.tool)
        add("handles and motions of 'FCD: Bend'");
    if (contents.pairs > 0)
        add("pairs of 'FCD: Fit': " + std::to_string(contents.pairs));
    if (contents.fitOptions)
        add("options of 'FCD: Fit'");
    if (contents.fitted)
        add("the fit that the layer shows");
    std::string line = (saved ? "Saved: " : "Loaded: ") + has + ".";
    if (contents.moved > 0)
        line += " The layer was at rest; it has the saved pose now.";
    if (contents.hasMatrix)
        line += " It has the saved matrix now.";
    if (!contents.unfit.empty())
        line += " Of 'FCD: Fit': " + contents.unfit + ".";
    return line;
}

} // namespace

HostFilterPlugin::ReturnedValues FilterFcd::session(int id, const RichParameterList &parameters,
                                                    const MeshDocument &document, MeshModel &layer) const {
    const QString file = id == SaveSession ? read<SaveSessionParam>(parameters, document).file
                                           : read<LoadSessionParam>(parameters, document).file;
    const SessionContents contents = id == SaveSession ? saveSession(layer, file) : loadSession(document, layer, file);
    logLine(describe(contents, id == SaveSession));
    return {{"marks", contents.marks},     {"colors", contents.colors},
            {"rest_shape", contents.rest}, {"earlier", contents.earlier},
            {"poses", contents.poses},     {"tool", contents.tool},
            {"pairs", contents.pairs},     {"fit_options", contents.fitOptions},
            {"fitted", contents.fitted},   {"moved_vertices", contents.moved}};
}
