// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include <layer_fcd/session_file.h>

#include <QFileDialog>

// What is known of the layer, in a file.

namespace {

const char *const sessionKinds = "Sessions (*.fcd)";

} // namespace

void BendTool::saveLayerSession() {
    const QString file = fileToSave(*view, "Save session", sessionKinds, {".fcd"});
    if (file.isEmpty() || !isReady())
        return;
    keepShown(); // as one that goes finds it
    showVertices(true);
    saveSession(*model, file);
    say("Saved the session as " + file.toStdString() + ". Save the layer, too.");
}

void BendTool::loadLayerSession() {
    const QString file = QFileDialog::getOpenFileName(view->window(), "Load session", QString(), sessionKinds);
    if (file.isEmpty() || !isReady())
        return;
    session->restore(); // a session is of that shape, or of its own pose
    try {
        loadSession(*document, *model, file);
    } catch (...) {
        solve(true);
        throw;
    }
    const std::unique_ptr<BendSession> before = std::move(session);
    open(*model);
    session->follow(std::move(*before));
    showOptions();
    showVertices(true);
    showChanged();
    showOverlay();
    say("Loaded the session " + file.toStdString() + ".");
}
