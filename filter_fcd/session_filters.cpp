// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_parameters.h"
#include "filter_fcd.h"

#include <layer_fcd/inherited.h>
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

HostFilterPlugin::ReturnedValues FilterFcd::session(int id, const RichParameterList &parameters,
                                                    const MeshDocument &document, MeshModel &layer) const {
    const QString file = id == SaveSession ? read<SaveSessionParam>(parameters, document).file
                                           : read<LoadSessionParam>(parameters, document).file;
    if (id == SaveSession)
        inheritState(document, layer);
    const SessionContents contents = id == SaveSession ? saveSession(layer, file) : loadSession(document, layer, file);
    logLine((id == SaveSession ? "Saved: " : "Loaded: ") + describe(contents));
    return {{"marks", contents.marks},     {"colors", contents.colors},
            {"rest_shape", contents.rest}, {"earlier", contents.earlier},
            {"poses", contents.poses},     {"tool", contents.tool},
            {"pairs", contents.pairs},     {"fit_options", contents.fitOptions},
            {"fitted", contents.fitted},   {"moved_vertices", contents.moved}};
}
