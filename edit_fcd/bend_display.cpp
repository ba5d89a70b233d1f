// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_display.h"

using Names = MLRenderingData::ATT_NAMES;

namespace {

/// Lets nothing hide the colours of vertices.
void showVertexColors(MLPerViewGLOptions &options) {
    options._persolid_mesh_color_enabled = options._persolid_fixed_color_enabled = false;
    options._perpoint_mesh_color_enabled = options._perpoint_fixed_color_enabled = false;
}

} // namespace

BendDisplay::BendDisplay(GLArea &view, const MeshModel &layer, bool isColored)
    : view(view), layer(layer), primitive(layer.cm.fn > 0 ? MLRenderingData::PR_SOLID : MLRenderingData::PR_POINTS),
      isColored(isColored), isBare(isColored) {
    view.getSceneGLSharedContext()->getRenderInfoPerMeshView(layer.id(), view.context(), before);
    show();
}

void BendDisplay::show() {
    MLRenderingData data;
    MLPerViewGLOptions options;
    before.get(options);
    MLRenderingData::RendAtts had, atts;
    before.get(primitive, had);
    atts[Names::ATT_VERTPOSITION] = true;
    atts[Names::ATT_VERTNORMAL] = true;
    atts[Names::ATT_VERTCOLOR] = layer.hasDataMask(MeshModel::MM_VERTCOLOR) && (isColored || had[Names::ATT_VERTCOLOR]);
    if (!isBare && !isColored)
        for (const auto name : {Names::ATT_WEDGETEXTURE, Names::ATT_VERTTEXTURE})
            atts[name] = had[name];
    if (isColored)
        showVertexColors(options);
    data.set(primitive, atts);
    data.set(options);
    MLSceneGLSharedDataContext *shared = view.getSceneGLSharedContext();
    shared->setRenderingDataPerMeshView(layer.id(), view.context(), data);
    shared->manageBuffers(layer.id());
    view.updateAllSiblingsGLAreas();
}

void BendDisplay::update(std::initializer_list<Names> names) {
    MLSceneGLSharedDataContext *shared = view.getSceneGLSharedContext();
    if (!shared)
        return;
    MLRenderingData::RendAtts all;
    for (const Names name : names)
        all[name] = true;
    shared->meshAttributesUpdated(layer.id(), false, all);
    shared->manageBuffers(layer.id());
    view.updateAllSiblingsGLAreas();
}

void BendDisplay::bare() {
    if (isBare)
        return;
    isBare = true;
    show();
}

void BendDisplay::setColored(bool colored) {
    if (isColored == colored)
        return;
    isColored = colored;
    show();
}

void BendDisplay::updateColors(bool colored) {
    isColored = colored;
    show();
    update({Names::ATT_VERTCOLOR});
}

void BendDisplay::updateShape(bool full, bool recolored) {
    if (full)
        update({Names::ATT_VERTPOSITION, Names::ATT_VERTNORMAL, Names::ATT_FACENORMAL, Names::ATT_VERTCOLOR});
    else if (recolored)
        update({Names::ATT_VERTPOSITION, Names::ATT_VERTNORMAL, Names::ATT_VERTCOLOR});
    else
        update({Names::ATT_VERTPOSITION, Names::ATT_VERTNORMAL});
}

void BendDisplay::end(bool colored) {
    MLRenderingData::RendAtts atts;
    if (colored && before.get(primitive, atts)) {
        atts[Names::ATT_VERTCOLOR] = true;
        atts[Names::ATT_FACECOLOR] = false;
        before.set(primitive, atts);
        MLPerViewGLOptions options;
        before.get(options);
        showVertexColors(options);
        before.set(options);
    }
    view.getSceneGLSharedContext()->setRenderingDataPerMeshView(layer.id(), view.context(), before);
    updateShape(true, true);
}
