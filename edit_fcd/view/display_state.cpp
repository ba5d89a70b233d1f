// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/display_state.h"

using Names = MLRenderingData::ATT_NAMES;

// Normals and buffers of so many faces take about 3 ms, a quarter of a step (two cores; 270 000 take 16 ms).
const int mostFaces = 50000;

void DisplayState::set(const MLRenderingData &data) {
    MLSceneGLSharedDataContext *shared = view.getSceneGLSharedContext();
    if (!shared)
        return;
    shared->setRenderingDataPerMeshView(layer.id(), view.context(), data);
    shared->manageBuffers(layer.id());
}

bool DisplayState::showsFaces() const {
    MLSceneGLSharedDataContext *shared = view.getSceneGLSharedContext();
    if (!shared)
        return false;
    MLRenderingData data;
    MLRenderingData::RendAtts atts;
    shared->getRenderInfoPerMeshView(layer.id(), view.context(), data);
    return data.get(MLRenderingData::PR_SOLID, atts) && atts[Names::ATT_FACENORMAL];
}

void DisplayState::move() {
    if (atRest || layer.cm.fn <= mostFaces || !showsFaces())
        return;
    MLRenderingData data;
    view.getSceneGLSharedContext()->getRenderInfoPerMeshView(layer.id(), view.context(), data);
    atRest = data;
    MLRenderingData::RendAtts atts;
    data.get(MLRenderingData::PR_SOLID, atts);
    atts[Names::ATT_FACENORMAL] = false;
    atts[Names::ATT_VERTNORMAL] = true;
    data.set(MLRenderingData::PR_SOLID, atts);
    set(data);
}

void DisplayState::rest() {
    if (atRest)
        set(*atRest);
    atRest.reset();
}

void DisplayState::updateShape(bool faces) {
    MLSceneGLSharedDataContext *shared = view.getSceneGLSharedContext();
    if (!shared)
        return;
    MLRenderingData::RendAtts changed;
    for (const Names name : {Names::ATT_VERTPOSITION, Names::ATT_VERTNORMAL})
        changed[name] = true;
    changed[Names::ATT_FACENORMAL] = faces;
    shared->meshAttributesUpdated(layer.id(), false, changed);
    shared->manageBuffers(layer.id());
    view.updateAllSiblingsGLAreas();
}
