// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_tool.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <QApplication>
#include <QCursor>
#include <QMainWindow>
#include <QPolygonF>

using vcg::fcd::Error;
using vcg::fcd::MotionStep;

namespace {

const double degree = std::acos(-1.0) / 180;
const int arrowPixels = 80, ringPixels = 60;

/// A number in few digits, as people would write it; what is kept is what is written.
double rounded(double x) {
    char text[32];
    const char *end = std::to_chars(text, text + sizeof text, x, std::chars_format::general, 6).ptr;
    double y = x;
    vcg::fcd::detail::ToNumber(text, end, y);
    return y == 0 ? 0 : y; // no -0
}

/// The steps and one more, joined with the last where that makes the same motion.
std::vector<MotionStep> joined(std::vector<MotionStep> steps, const MotionStep &step) {
    if (!steps.empty() && steps.back().kind == step.kind && !steps.back().about && !step.about) {
        MotionStep &last = steps.back();
        switch (step.kind) {
        case MotionStep::Translation:
            for (int d = 0; d < 3; ++d)
                last.vector[d] = rounded(last.vector[d] + step.vector[d]);
            return steps;
        case MotionStep::Rotation:
            if (last.vector == step.vector) {
                last.degrees = rounded(last.degrees + step.degrees);
                return steps;
            }
            break;
        case MotionStep::Scaling:
            for (int d = 0; d < 3; ++d)
                last.vector[d] = rounded(last.vector[d] * step.vector[d]);
            return steps;
        case MotionStep::Matrix: break;
        }
    }
    steps.push_back(step);
    return steps;
}

double distanceToSegment(const Eigen::Vector2d &p, const Eigen::Vector2d &a, const Eigen::Vector2d &b) {
    const Eigen::Vector2d way = b - a;
    const double square = way.squaredNorm();
    const double t = square > 0 ? std::min(1.0, std::max(0.0, (p - a).dot(way) / square)) : 0;
    return (a + t * way - p).norm();
}

/// A point of the ring of the gizmo that turns about an axis.
Eigen::Vector3d onRing(const Eigen::Vector3d &center, int axis, double radius, double angle) {
    Eigen::Vector3d p = center;
    p[(axis + 1) % 3] += radius * std::cos(angle);
    p[(axis + 2) % 3] += radius * std::sin(angle);
    return p;
}

/// Lets nothing hide the colours of vertices.
void showVertexColors(MLPerViewGLOptions &options) {
    options._persolid_mesh_color_enabled = options._persolid_fixed_color_enabled = false;
    options._perpoint_mesh_color_enabled = options._perpoint_fixed_color_enabled = false;
}

MLRenderingData::RendAtts attributes(std::initializer_list<MLRenderingData::ATT_NAMES> names) {
    MLRenderingData::RendAtts all;
    for (MLRenderingData::ATT_NAMES name : names)
        all[name] = true;
    return all;
}

} // namespace

// --- the view ---

Eigen::Vector3d BendView::toWindow(const Eigen::Vector3d &world) const {
    const Eigen::Vector4d clip = toClip * world.homogeneous();
    if (!(clip[3] > 0))
        return {-1e6, -1e6, 2};
    const Eigen::Vector3d ndc = clip.hnormalized();
    return {(ndc[0] + 1) / 2 * width, (ndc[1] + 1) / 2 * height, (ndc[2] + 1) / 2};
}

Eigen::Vector3d BendView::toWorld(const Eigen::Vector3d &window) const {
    const Eigen::Vector4d ndc(2 * window[0] / width - 1, 2 * window[1] / height - 1, 2 * window[2] - 1, 1);
    return (fromClip * ndc).hnormalized();
}

Eigen::Vector3d BendView::towardsEye(const Eigen::Vector3d &at) const {
    const Eigen::Vector3d window = toWindow(at);
    return (toWorld({window[0], window[1], window[2] - 1e-3}) - at).normalized();
}

double BendView::pixelAt(const Eigen::Vector3d &at) const {
    const Eigen::Vector3d window = toWindow(at);
    return (toWorld({window[0] + 1, window[1], window[2]}) - at).norm();
}

// --- beginning and end ---

void BendTool::say(const std::string &text, bool warning) {
    if (!view)
        return;
    std::string line = "FCD: Bend: " + text;
    std::replace(line.begin(), line.end(), '<', '[');
    std::replace(line.begin(), line.end(), '>', ']');
    view->Log(warning ? GLLogStream::WARNING : GLLogStream::FILTER, line.c_str());
    if (panel && warning)
        panel->showState(QString::fromStdString(text));
}

MeshModel *BendTool::layer() const {
    if (!view || !view->md() || !session)
        return nullptr;
    MeshModel *found = view->md()->getMesh(layerId);
    return found == model && session->fits() ? found : nullptr;
}

bool BendTool::start(MeshDocument &document, GLArea *area) {
    close();
    isEnding = false;
    view = area;
    if (!document.mm())
        return false;
    try {
        open(*document.mm());
    } catch (...) {
        refused = document.mm()->id();
        close();
        throw;
    }
    makePanel();
    view->installEventFilter(this);
    connect(view, &QObject::destroyed, this, [this] { guarded([&] { close(); }); });
    view->setFocus();
    refresh();
    return true;
}

void BendTool::end() { close(); }

void BendTool::changeLayer(MeshDocument &document, GLArea *area) {
    if (isEnding || (document.mm() && document.mm()->id() == layerId && layer()))
        return;
    refused = -1;
    close();
    view = area;
    if (document.mm() && document.mm()->cm.vn > 0) // a file that is being opened is empty at first: see draw()
        start(document, area);
}

void BendTool::open(MeshModel &newModel) {
    session = std::make_unique<BendSession>(newModel);
    model = &newModel;
    layerId = newModel.id();
    before = MLRenderingData();
    view->getSceneGLSharedContext()->getRenderInfoPerMeshView(layerId, view->context(), before);
    isBare = session->isMarked();
    if (isBare && !newModel.hasDataMask(MeshModel::MM_VERTCOLOR))
        session->showTags();
    active = 0;
    isLive = false;
    showLayer();
}

void BendTool::close() {
    drag.reset();
    marking.reset();
    isStepWanted = false;
    if (const MeshModel *shown = layer()) {
        if (isLive || session->isUpToDate())
            session->restore();
        MLSceneGLSharedDataContext *shared = view->getSceneGLSharedContext();
        if (session->isMarked()) {
            MLRenderingData::RendAtts atts;
            const auto solid = shown->cm.fn > 0 ? MLRenderingData::PR_SOLID : MLRenderingData::PR_POINTS;
            if (before.get(solid, atts)) {
                atts[MLRenderingData::ATT_NAMES::ATT_VERTCOLOR] = true;
                atts[MLRenderingData::ATT_NAMES::ATT_FACECOLOR] = false;
                before.set(solid, atts);
                MLPerViewGLOptions options;
                before.get(options);
                showVertexColors(options);
                before.set(options);
            }
        }
        shared->setRenderingDataPerMeshView(layerId, view->context(), before);
        showVertices(true);
    }
    session.reset();
    model = nullptr;
    layerId = -1;
    if (panel)
        panel->deleteLater();
    panel = nullptr;
    if (view) {
        view->removeEventFilter(this);
        disconnect(view, &QObject::destroyed, this, nullptr);
        view->setMouseTracking(false);
        view->unsetCursor();
    }
}

/// Whether there is a layer to work on; begins anew with one that something else has changed.
bool BendTool::isReady() {
    if (!view || !view->md())
        return false;
    MeshModel *current = view->md()->getMesh(layerId);
    if (!current || !session) {
        session.reset(); // it was deleted
        return false;
    }
    if (current == model && (isLive || session->isUpToDate()))
        return true;
    session.reset();
    open(*current);
    refresh();
    return true;
}

/// Shows the layer smooth, so that its buffers are indexed and only positions and normals change.
void BendTool::showLayer() {
    const MeshModel *shown = layer();
    if (!shown)
        return;
    MLRenderingData data;
    MLPerViewGLOptions options;
    before.get(options);
    const auto primitive = shown->cm.fn > 0 ? MLRenderingData::PR_SOLID : MLRenderingData::PR_POINTS;
    MLRenderingData::RendAtts had, atts;
    before.get(primitive, had);
    atts[MLRenderingData::ATT_NAMES::ATT_VERTPOSITION] = true;
    atts[MLRenderingData::ATT_NAMES::ATT_VERTNORMAL] = true;
    const bool marked = session->isMarked() || marking;
    atts[MLRenderingData::ATT_NAMES::ATT_VERTCOLOR] =
        shown->hasDataMask(MeshModel::MM_VERTCOLOR) && (marked || had[MLRenderingData::ATT_NAMES::ATT_VERTCOLOR]);
    if (!isBare)
        for (const auto name :
             {MLRenderingData::ATT_NAMES::ATT_WEDGETEXTURE, MLRenderingData::ATT_NAMES::ATT_VERTTEXTURE})
            atts[name] = had[name];
    if (marked)
        showVertexColors(options);
    data.set(primitive, atts);
    data.set(options);
    MLSceneGLSharedDataContext *shared = view->getSceneGLSharedContext();
    shared->setRenderingDataPerMeshView(layerId, view->context(), data);
    shared->manageBuffers(layerId);
    view->updateAllSiblingsGLAreas();
}

void BendTool::makePanel() {
    if (panel)
        return;
    auto *window = qobject_cast<QMainWindow *>(view->window());
    panel = new BendPanel(view->window());
    connect(panel, &BendPanel::optionsChanged, this, [this] { guarded([&] { onOptions(); }); });
    connect(panel, &BendPanel::command, this, [this](int which) { guarded([&] { onCommand(which); }); });
    if (window)
        window->addDockWidget(Qt::LeftDockWidgetArea, panel);
    panel->show();
    if (session->isMarked())
        panel->setRole(BendPanel::Handle, session->unusedTag());
}

// --- the panel ---

void BendTool::onOptions() {
    if (!isReady() || drag)
        return;
    if (panel->mode() != BendPanel::Polyline)
        marking.reset();
    BendOptions options = session->options;
    options.smoothness = panel->smoothness();
    options.initialPatches = panel->patches();
    options.mirror = panel->mirror();
    options.pose = panel->pose();
    const bool same = options.smoothness == session->options.smoothness && options.pose == session->options.pose &&
                      options.initialPatches == session->options.initialPatches;
    session->options = options;
    if (!same)
        solve(true);
    refresh();
    view->update();
}

void BendTool::onCommand(int which) {
    if (!isReady() || drag)
        return;
    const Remark remark = [this](const std::string &line) { say(line); };
    switch (which) {
    case BendPanel::MarkSelection: {
        std::vector<char> selected = onSelectedFaces(*model);
        std::vector<std::size_t> all;
        for (std::size_t i = 0; i < selected.size(); ++i)
            if (!model->cm.vert[i].IsD() && (selected[i] || model->cm.vert[i].IsS()))
                all.push_back(i);
        if (all.empty())
            throw Error("Nothing is selected.");
        session->change();
        session->mark(all, panel->tag());
        session->endMarks();
        showColors();
        solve(true);
        break;
    }
    case BendPanel::ClearMarks:
        session->change();
        session->clearMarks();
        showColors();
        solve(true);
        break;
    case BendPanel::TakeMotions:
        session->change();
        session->setMotions(panel->motions().toStdString());
        solve(true);
        view->setFocus();
        break;
    case BendPanel::Undo:
    case BendPanel::Redo:
        if (which == BendPanel::Undo)
            session->undo();
        else
            session->redo();
        showColors();
        solve(true);
        break;
    case BendPanel::Reset:
        session->change();
        session->reset();
        solve(true);
        break;
    case BendPanel::ApplyInPlace:
        if (!session->moves())
            throw Error("Nothing was moved, so there is nothing to apply.");
        try {
            say(session->applyInPlace(*view->md(), remark));
        } catch (...) {
            showVertices(true);
            throw;
        }
        active = 0;
        showVertices(true);
        break;
    case BendPanel::ApplyToNewLayer: {
        if (!session->moves())
            throw Error("Nothing was moved, so there is nothing to apply.");
        try {
            say(session->applyToNewLayer(*view->md(), panel->graphLayers(), remark));
        } catch (...) {
            showVertices(true);
            throw;
        }
        // The host shows new layers when a tool ends, and they have no buffers before that.
        close();
        isEnding = true;
        QTimer::singleShot(0, action, &QAction::trigger);
        return;
    }
    }
    refresh();
    view->update();
}

void BendTool::refresh() {
    if (!panel || !session)
        return;
    panel->showMotions(QString::fromStdString(session->motionText()));
    QString text;
    if (session->handleTags().empty()) {
        text = session->isMarked() ? "Mark a handle (red), then drag it."
                                   : "Drag a point of the surface, or mark what is fixed and what is a handle.";
    } else if (session->nodes() == 0) {
        text = "Drag a handle (red).";
    } else {
        const double least = std::max(0.1, milliseconds);
        text = QString("%1 nodes, %2 ms, %3 frames/s")
                   .arg(session->nodes())
                   .arg(least, 0, 'f', 1)
                   .arg(1000 / least, 0, 'f', 0);
    }
    if (drag && !drag->typed.isEmpty())
        text += "\n" + QString(drag->kind == Move ? "move " : drag->kind == Turn ? "turn " : "scale ") + drag->typed;
    panel->showState(text);
}

// --- mouse and keys ---

Eigen::Vector3d BendTool::windowOf(const QPointF &place) const {
    const double ratio = view->devicePixelRatioF();
    return {(place.x() + 0.5) * ratio, seen.height - (place.y() + 0.5) * ratio, 0};
}

std::optional<Eigen::Vector3d> BendTool::pick(const QPointF &place) const {
    Eigen::Vector3d window = windowOf(place);
    float depth = 1;
    view->makeCurrent();
    glReadPixels(int(window[0]), int(window[1]), 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    if (!(depth < 1))
        return {};
    window[2] = depth;
    return seen.toWorld(window);
}

/// Hands an event on to the camera, as one of the left button where it is of the right one.
void BendTool::toCamera(QMouseEvent *event) {
    isCamera = event->type() != QEvent::MouseButtonRelease;
    const auto left = [](Qt::MouseButtons buttons) {
        return (buttons & Qt::RightButton) != 0 ? (buttons & ~Qt::RightButton) | Qt::LeftButton : buttons;
    };
    QMouseEvent copy(event->type(), event->localPos(), event->windowPos(), event->screenPos(),
                     event->button() == Qt::RightButton ? Qt::LeftButton : event->button(), left(event->buttons()),
                     event->modifiers() & ~Qt::AltModifier);
    view->suspendedEditor = true;
    QCoreApplication::sendEvent(view, &copy);
    view->suspendedEditor = false;
}

void BendTool::press(QMouseEvent *event) {
    sinceEvent.start();
    mouse = event->localPos();
    if (drag) {
        endDrag(event->button() == Qt::LeftButton);
        return;
    }
    const bool plain = event->button() == Qt::LeftButton && event->modifiers() == Qt::NoModifier && !isCamera;
    if (!isReady() || !plain) {
        if (marking && event->button() == Qt::RightButton && panel->mode() == BendPanel::Polyline)
            markPolygon();
        else
            toCamera(event);
        return;
    }
    switch (panel->mode()) {
    case BendPanel::Bend:
        if (!grab(event))
            toCamera(event);
        break;
    case BendPanel::Brush:
        if (!pick(mouse)) {
            toCamera(event);
            break;
        }
        beginMarking();
        brushAt(windowOf(mouse));
        break;
    case BendPanel::Rectangle:
        beginMarking();
        marking->corners = {mouse, mouse};
        break;
    case BendPanel::Polyline:
        if (!marking)
            beginMarking();
        marking->corners.push_back(mouse);
        break;
    }
    refresh();
    view->update();
}

/// Whether the mouse, which has moved or was released, is for the layer, and not for the camera.
bool BendTool::isForLayer(QMouseEvent *event) {
    mouse = event->localPos();
    const bool isForCamera = isCamera; // a release ends that
    if (isForCamera)
        toCamera(event);
    return !isForCamera && layer();
}

void BendTool::move(QMouseEvent *event) {
    sinceEvent.start();
    if (!isForLayer(event))
        return;
    if (drag) {
        dragTo(windowOf(mouse));
    } else if (marking && panel->mode() == BendPanel::Brush) {
        brushAt(windowOf(mouse));
    } else if (marking && !marking->corners.empty() && (event->buttons() & Qt::LeftButton)) {
        marking->corners.back() = mouse;
    }
}

void BendTool::release(QMouseEvent *event) {
    if (!isForLayer(event))
        return;
    if (drag && !drag->modal)
        endDrag(true);
    else if (marking && panel->mode() == BendPanel::Rectangle)
        markPolygon();
    else if (marking && panel->mode() == BendPanel::Brush) {
        marking.reset();
        session->endMarks();
        showColors();
        solve(true);
        refresh();
    }
}

void BendTool::turnWheel(QWheelEvent *event) {
    const double steps = event->angleDelta().y() / 120.0;
    if (drag && session && session->state().points.count(drag->tag) && !session->isMarked()) {
        panel->setRadius(panel->radius() * std::pow(1.1, steps));
        session->setRadius(drag->tag, panel->radius() * session->diagonal());
        requestStep();
        return;
    }
    if (panel && panel->mode() == BendPanel::Brush && event->modifiers() == Qt::NoModifier) {
        panel->setBrush(int(std::lround(panel->brush() * std::pow(1.15, steps) + (steps > 0 ? 0.5 : -0.5))));
        view->update();
        return;
    }
    view->suspendedEditor = true;
    QCoreApplication::sendEvent(view, event);
    view->suspendedEditor = false;
}

bool BendTool::eventFilter(QObject *object, QEvent *event) {
    if (object == view && view && !view->suspendedEditor && session) {
        if (event->type() == QEvent::ShortcutOverride) {
            const auto *key = static_cast<QKeyEvent *>(event);
            const bool isUndo = key->key() == Qt::Key_Z && (key->modifiers() & Qt::ControlModifier);
            if (isUndo || (key->key() == Qt::Key_Escape && (drag || marking))) {
                event->accept();
                return true;
            }
        }
        if (event->type() == QEvent::MouseButtonDblClick && panel && panel->mode() != BendPanel::Bend) {
            guarded([&] {
                if (marking && panel->mode() == BendPanel::Polyline)
                    markPolygon();
                else
                    press(static_cast<QMouseEvent *>(event));
            });
            return true;
        }
    }
    return HostEditTool::eventFilter(object, event);
}

void BendTool::pressKey(QKeyEvent *event) {
    if (!layer() || !panel)
        return;
    const int key = event->key();
    const bool shift = event->modifiers() & Qt::ShiftModifier, control = event->modifiers() & Qt::ControlModifier;
    event->accept();
    if (drag) {
        const QString text = event->text();
        if (key == Qt::Key_Escape || key == Qt::Key_Return || key == Qt::Key_Enter) {
            endDrag(key != Qt::Key_Escape);
            return;
        }
        if (key == Qt::Key_X || key == Qt::Key_Y || key == Qt::Key_Z)
            drag->axis = drag->axis == key - Qt::Key_X ? -1 : key - Qt::Key_X;
        else if (key == Qt::Key_G || key == Qt::Key_R || key == Qt::Key_S)
            drag->kind = key == Qt::Key_G ? Move : key == Qt::Key_R ? Turn : Scale;
        else if (key == Qt::Key_Backspace)
            drag->typed.chop(1);
        else if (text.size() == 1 && QString("0123456789.-").contains(text))
            drag->typed += text;
        requestStep();
        return;
    }
    if (control && key == Qt::Key_Z) {
        onCommand(shift ? BendPanel::Redo : BendPanel::Undo);
        return;
    }
    switch (key) {
    case Qt::Key_G:
    case Qt::Key_R:
    case Qt::Key_S: {
        if (!isReady())
            return;
        const std::vector<int> handles = session->handleTags();
        if (handles.empty())
            throw Error("There is no handle yet: mark one, or drag a point of the surface.");
        if (!std::count(handles.begin(), handles.end(), active))
            active = handles.front();
        mouse = view->mapFromGlobal(QCursor::pos());
        session->change();
        beginDrag(active, key == Qt::Key_G ? Move : key == Qt::Key_R ? Turn : Scale, -1, true, windowOf(mouse));
        break;
    }
    case Qt::Key_M: panel->setMode(BendPanel::Bend); break;
    case Qt::Key_B: panel->setMode(BendPanel::Brush); break;
    case Qt::Key_V: panel->setMode(BendPanel::Rectangle); break;
    case Qt::Key_L: panel->setMode(BendPanel::Polyline); break;
    case Qt::Key_F: panel->setRole(BendPanel::Fixed, 2); break;
    case Qt::Key_U: panel->setRole(BendPanel::Free, 2); break;
    case Qt::Key_O: panel->setRole(BendPanel::Outside, 2); break;
    case Qt::Key_H:
        panel->setRole(BendPanel::Handle, shift || session->handleTags().empty() ? session->unusedTag() : 2);
        break;
    case Qt::Key_T: panel->toggleThrough(); break;
    case Qt::Key_Backspace: onCommand(BendPanel::Reset); break;
    case Qt::Key_Escape:
        if (marking) {
            marking.reset();
            session->cancel();
            showColors();
        }
        break;
    case Qt::Key_Return:
    case Qt::Key_Enter:
        if (marking && panel->mode() == BendPanel::Polyline)
            markPolygon();
        else
            onCommand(shift ? BendPanel::ApplyToNewLayer : BendPanel::ApplyInPlace);
        break;
    default: event->ignore();
    }
    refresh();
    view->update();
}

// --- handles ---

bool BendTool::isGizmoHit(const Eigen::Vector3d &window, Kind &kind, int &hitAxis) const {
    if (!active || session->handleTags().empty())
        return false;
    const Eigen::Vector3d center = session->centerOf(active);
    const double pixel = seen.pixelAt(center);
    const Eigen::Vector2d at = window.head<2>();
    kind = Move;
    hitAxis = -1;
    if ((seen.toWindow(center).head<2>() - at).norm() < 15) // rings that are seen from the side go through it
        return true;
    double least = 8;
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d tip = center + arrowPixels * pixel * Eigen::Vector3d::Unit(axis);
        const Eigen::Vector2d a = seen.toWindow(center + (tip - center) * 0.3).head<2>(),
                              b = seen.toWindow(tip).head<2>();
        if (const double d = distanceToSegment(at, a, b); d < least && (b - a).norm() > 10) {
            least = d;
            kind = Move;
            hitAxis = axis;
        }
        for (int i = 0; i < 48; ++i) {
            const double part = 360 / 48.0 * degree;
            const Eigen::Vector2d p = seen.toWindow(onRing(center, axis, ringPixels * pixel, i * part)).head<2>(),
                                  q = seen.toWindow(onRing(center, axis, ringPixels * pixel, (i + 1) * part)).head<2>();
            if (const double d = distanceToSegment(at, p, q); d < least) {
                least = d;
                kind = Turn;
                hitAxis = axis;
            }
        }
    }
    return least < 8;
}

/// Begins to drag what is under the mouse. \return false where there is nothing to drag
bool BendTool::grab(QMouseEvent *event) {
    const Eigen::Vector3d window = windowOf(event->localPos());
    const std::vector<int> handles = session->handleTags();
    Kind kind = Move;
    int axis = -1;
    if (std::count(handles.begin(), handles.end(), active) && isGizmoHit(window, kind, axis)) {
        session->change();
        beginDrag(active, kind, axis, false, window);
        return true;
    }
    double least = 12;
    int tag = 0;
    for (const auto &point : session->state().points) {
        const double d = (seen.toWindow(session->centerOf(point.first)) - window).head<2>().norm();
        if (d < least) {
            least = d;
            tag = point.first;
        }
    }
    if (!tag) {
        const std::optional<Eigen::Vector3d> place = pick(event->localPos());
        double distance = 0;
        const std::optional<std::size_t> slot = place ? session->nearest(*place, distance) : std::nullopt;
        if (!slot || distance > 0.02 * session->diagonal())
            return false; // nothing, or another layer
        const int there = session->tags()[*slot];
        if (there < 2) {
            if (session->isMarked() && there != 1) {
                panel->showState("This part is fixed. Mark it as free first, or clear the marks.");
                return false;
            }
            session->change();
            tag = session->addPoint(*slot, panel->radius() * session->diagonal());
            beginDrag(tag, Move, -1, false, window);
            return true;
        }
        tag = there;
    }
    session->change();
    beginDrag(tag, Move, -1, false, window);
    return true;
}

/// \pre session->change()
void BendTool::beginDrag(int tag, Kind kind, int axis, bool modal, const Eigen::Vector3d &from) {
    if (session->options.pose != 100) { // a drag says where 100 percent is
        session->options.pose = 100;
        panel->setPose(100);
    }
    if (!isBare) {
        isBare = true;
        showLayer();
    }
    active = tag;
    Drag begun;
    begun.tag = tag;
    begun.kind = kind;
    begun.axis = axis;
    begun.modal = modal;
    begun.pivot = session->centerOf(tag);
    begun.from = begun.last = from;
    const auto steps = session->state().motion.find(tag);
    if (steps != session->state().motion.end())
        begun.begin = steps->second;
    drag = std::make_unique<Drag>(begun);
    if (modal)
        view->setMouseTracking(true);
    try {
        const double took = session->prepare();
        if (took > 0 && session->moves())
            solve(false);
        if (std::getenv("FCD_TRACE"))
            std::fprintf(stderr, "FCD trace: press: %d vertices, prepare %.1f ms, since the event %.1f ms\n",
                         model->cm.vn, took, double(sinceEvent.nsecsElapsed()) / 1e6);
    } catch (...) {
        endDrag(false);
        throw;
    }
}

/// What the drag adds to the motion.
std::optional<MotionStep> BendTool::dragStep() const {
    const Eigen::Vector3d center = seen.toWindow(drag->pivot);
    const Eigen::Vector2d from = drag->from.head<2>(), to = drag->last.head<2>(), middle = center.head<2>();
    bool isTyped = false;
    const double typed = drag->typed.toDouble(&isTyped);
    const int axis = drag->axis;
    switch (drag->kind) {
    case Move: {
        Eigen::Vector3d way = seen.toWorld({to[0], to[1], center[2]}) - seen.toWorld({from[0], from[1], center[2]});
        if (isTyped) {
            way = typed * Eigen::Vector3d::Unit(axis < 0 ? 0 : axis);
        } else if (axis >= 0) {
            const double unit = 100 * seen.pixelAt(drag->pivot);
            const Eigen::Vector2d along =
                seen.toWindow(drag->pivot + unit * Eigen::Vector3d::Unit(axis)).head<2>() - middle;
            const double square = std::max(along.squaredNorm(), 100.0); // seen from its end, an axis leads nowhere
            way = (to - from).dot(along) / square * unit * Eigen::Vector3d::Unit(axis);
        }
        for (int d = 0; d < 3; ++d)
            way[d] = rounded(way[d]);
        if (way.isZero(0))
            return {};
        return MotionStep::Translate(way);
    }
    case Turn: {
        const Eigen::Vector3d eye = seen.towardsEye(drag->pivot);
        Eigen::Vector3d about = axis < 0 ? eye : Eigen::Vector3d::Unit(axis);
        for (int d = 0; d < 3; ++d)
            about[d] = rounded(about[d]);
        const double angle = rounded(isTyped ? typed : about.dot(eye) < 0 ? -drag->angle : drag->angle);
        if (angle == 0)
            return {};
        return MotionStep::Rotate(about, angle);
    }
    case Scale: {
        const double length = std::max(20.0, (from - middle).norm());
        double factor = isTyped ? typed : std::max(0.01, 1 + ((to - middle).norm() - (from - middle).norm()) / length);
        factor = rounded(factor);
        if (factor == 1 || !(factor > 0))
            return {};
        Eigen::Vector3d factors = Eigen::Vector3d::Constant(axis < 0 ? factor : 1);
        if (axis >= 0)
            factors[axis] = factor;
        return MotionStep::Scale(factors);
    }
    }
    return {};
}

void BendTool::dragTo(const Eigen::Vector3d &window) {
    const Eigen::Vector2d middle = seen.toWindow(drag->pivot).head<2>();
    const Eigen::Vector2d a = drag->last.head<2>() - middle, b = window.head<2>() - middle;
    if (a.norm() > 1 && b.norm() > 1)
        drag->angle += std::remainder(std::atan2(b[1], b[0]) - std::atan2(a[1], a[0]), 360 * degree) / degree;
    drag->last = window;
    requestStep();
}

void BendTool::endDrag(bool keep) {
    if (!drag)
        return;
    if (keep)
        step();
    else
        session->cancel();
    drag.reset();
    isStepWanted = false;
    view->setMouseTracking(false);
    sinceEvent.start();
    if (!keep)
        showColors();
    solve(true);
    refresh();
    view->update();
}

/// One step a painted frame: the mouse moves more often.
void BendTool::requestStep() {
    isStepWanted = true;
    if (isPainted)
        step();
}

void BendTool::step() {
    isStepWanted = false;
    if (!drag || !layer())
        return;
    const std::optional<MotionStep> added = dragStep();
    session->setMotion(drag->tag, added ? joined(drag->begin, *added) : drag->begin);
    solve(false);
    refresh();
}

void BendTool::solve(bool full) {
    QElapsedTimer watch;
    watch.start();
    BendSession::Times times;
    try {
        times = session->pose(full);
    } catch (...) {
        session->restore();
        isLive = false;
        showVertices(true);
        throw;
    }
    isLive = !full;
    const double solved = double(watch.nsecsElapsed()) / 1e6;
    showVertices(full);
    milliseconds = double(watch.nsecsElapsed()) / 1e6;
    if (std::getenv("FCD_TRACE"))
        std::fprintf(
            stderr,
            "FCD trace: %s: %d vertices, %d nodes, prepare %.1f, solve %.1f, write %.1f, buffers %.1f, in all %.1f, "
            "since the event %.1f ms\n",
            full ? "full" : "drag", model->cm.vn, session->nodes(), times.prepare, times.solve, times.write,
            milliseconds - solved, milliseconds, sinceEvent.isValid() ? double(sinceEvent.nsecsElapsed()) / 1e6 : 0.0);
}

// --- marks ---

void BendTool::beginMarking() {
    session->change();
    isBare = true;
    marking = std::make_unique<Marking>();
    if (!panel->isThrough()) {
        marking->depth.resize(std::size_t(seen.width) * std::size_t(seen.height), 1);
        view->makeCurrent();
        glPixelStorei(GL_PACK_ALIGNMENT, 1);
        glReadPixels(0, 0, seen.width, seen.height, GL_DEPTH_COMPONENT, GL_FLOAT, marking->depth.data());
    }
}

/// The vertices with isIn(x, y) in the window that are seen, or all of them where marks go through, and those on the
/// other side of the mirror.
template <class IsIn>
std::vector<std::size_t> BendTool::verticesIn(const IsIn &isIn) const {
    const CMeshO &mesh = model->cm;
    const Eigen::Affine3d mirror = session->mirror();
    const double hair = 0.005 * session->diagonal();
    const auto isMarked = [&](const Eigen::Vector3d &p) {
        const Eigen::Vector3d window = seen.toWindow(p);
        if (!(window[2] <= 1) || !isIn(window[0], window[1]))
            return false;
        if (marking->depth.empty())
            return true;
        const Eigen::Vector3d eye = seen.towardsEye(p);
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const int x = int(window[0]) + dx, y = int(window[1]) + dy;
                if (x < 0 || y < 0 || x >= seen.width || y >= seen.height)
                    continue;
                const double depth = marking->depth[std::size_t(y) * std::size_t(seen.width) + std::size_t(x)];
                if (depth < 1 && (seen.toWorld({x + 0.5, y + 0.5, depth}) - p).dot(eye) < hair)
                    return true;
            }
        return false;
    };
    return vcg::fcd::CollectInOrder<std::size_t>(vcg::fcd::Progress(), "Marking", vcg::fcd::Index(mesh.vert.size()),
                                                 [&](vcg::fcd::Index i, std::vector<std::size_t> &found) {
                                                     if (mesh.vert[std::size_t(i)].IsD())
                                                         return;
                                                     const Eigen::Vector3d p = session->positionOf(std::size_t(i));
                                                     if (isMarked(p) ||
                                                         (session->options.mirror >= 0 && isMarked(mirror * p)))
                                                         found.push_back(std::size_t(i));
                                                 });
}

void BendTool::brushAt(const Eigen::Vector3d &window) {
    if (marking->corners.empty())
        marking->corners.push_back(mouse);
    const Eigen::Vector2d a = windowOf(marking->corners.back()).head<2>(), b = window.head<2>();
    marking->corners.back() = mouse;
    const double radius = panel->brush() * view->devicePixelRatioF();
    const bool wasMarked = session->isMarked();
    session->mark(verticesIn([&](double x, double y) {
                      return distanceToSegment({x, y}, a, b) <= radius;
                  }),
                  panel->tag());
    if (!wasMarked)
        showLayer();
    showColors();
}

void BendTool::markPolygon() {
    QPolygonF area;
    for (const QPointF &corner : marking->corners) {
        const Eigen::Vector3d window = windowOf(corner);
        area << QPointF(window[0], window[1]);
    }
    if (panel->mode() == BendPanel::Rectangle && area.size() == 2)
        area = QPolygonF(QRectF(area[0], area[1]).normalized());
    const std::vector<std::size_t> found =
        verticesIn([&](double x, double y) { return area.containsPoint(QPointF(x, y), Qt::OddEvenFill); });
    if (!found.empty()) {
        session->mark(found, panel->tag());
        session->endMarks();
    }
    showLayer();
    marking.reset();
    showColors();
    solve(true);
    refresh();
}

// --- what is shown ---

void BendTool::showVertices(bool full) {
    MLSceneGLSharedDataContext *shared = view->getSceneGLSharedContext();
    if (!shared)
        return;
    using Names = MLRenderingData::ATT_NAMES;
    shared->meshAttributesUpdated(
        layerId, false,
        full ? attributes({Names::ATT_VERTPOSITION, Names::ATT_VERTNORMAL, Names::ATT_FACENORMAL, Names::ATT_VERTCOLOR})
             : attributes({Names::ATT_VERTPOSITION, Names::ATT_VERTNORMAL}));
    shared->manageBuffers(layerId);
    isPainted = false;
    view->updateAllSiblingsGLAreas();
}

void BendTool::showColors() {
    showLayer();
    MLSceneGLSharedDataContext *shared = view->getSceneGLSharedContext();
    shared->meshAttributesUpdated(layerId, false, attributes({MLRenderingData::ATT_NAMES::ATT_VERTCOLOR}));
    shared->manageBuffers(layerId);
    view->updateAllSiblingsGLAreas();
}

void BendTool::draw() {
    isPainted = true;
    double place[16], projection[16];
    int port[4];
    glGetDoublev(GL_MODELVIEW_MATRIX, place);
    glGetDoublev(GL_PROJECTION_MATRIX, projection);
    glGetIntegerv(GL_VIEWPORT, port);
    seen.toClip = Eigen::Map<Eigen::Matrix4d>(projection) * Eigen::Map<Eigen::Matrix4d>(place);
    seen.fromClip = seen.toClip.inverse();
    seen.width = std::max(1, port[2]);
    seen.height = std::max(1, port[3]);
    if (isStepWanted)
        QTimer::singleShot(0, this, [this] {
            guarded([&] {
                if (isStepWanted)
                    step();
            });
        });
    if (layer())
        drawOverlay();
    else if (!session && !isEnding && view)
        QTimer::singleShot(0, this, [this] {
            guarded([&] {
                if (session || isEnding || !view || !view->md() || !view->md()->mm())
                    return;
                const MeshModel &current = *view->md()->mm();
                if (current.cm.vn > 0 && current.id() != refused)
                    start(*view->md(), view);
            });
        });
}

void BendTool::drawOverlay() const {
    glPushAttrib(GL_ALL_ATTRIB_BITS);
    glDisable(GL_LIGHTING);
    glDisable(GL_TEXTURE_2D);
    glDisable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    const auto put = [](const Eigen::Vector3d &p) { glVertex3d(p[0], p[1], p[2]); };

    // Where a point reaches: some of the vertices.
    if (!session->isMarked() && drag) {
        const BendTags &tags = session->tags();
        glPointSize(2);
        glColor3ub(240, 197, 60);
        glBegin(GL_POINTS);
        const std::size_t some = tags.size() / 20000 + 1;
        for (std::size_t i = 0; i < tags.size(); i += some)
            if (tags[i] == 1)
                put(session->positionOf(i));
        glEnd();
    }
    for (const auto &point : session->state().points) {
        glPointSize(9);
        glColor3ub(210, 60, 50);
        glBegin(GL_POINTS);
        put(session->positionOf(point.second.slot));
        glEnd();
    }

    const std::vector<int> handles = session->handleTags();
    if (panel && panel->mode() == BendPanel::Bend && std::count(handles.begin(), handles.end(), active)) {
        const Eigen::Vector3d center = session->centerOf(active);
        const double pixel = seen.pixelAt(center);
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis) * pixel;
            const bool used = drag && drag->axis == axis;
            glLineWidth(used ? 4 : 2);
            glColor3ub(axis == 0 ? 230 : 40, axis == 1 ? 190 : 40, axis == 2 ? 240 : 40);
            glBegin(GL_LINES);
            put(used && drag->kind == Move ? center - 2000 * along : center);
            put(center + (used && drag->kind == Move ? 2000 : arrowPixels) * along);
            glEnd();
            glPointSize(8);
            glBegin(GL_POINTS);
            put(center + arrowPixels * along);
            glEnd();
            glBegin(GL_LINE_LOOP);
            for (int i = 0; i < 48; ++i)
                put(onRing(center, axis, ringPixels * pixel, i * 360 / 48.0 * degree));
            glEnd();
        }
        glPointSize(14);
        glColor3ub(250, 250, 250);
        glBegin(GL_POINTS);
        put(center);
        glEnd();
    }

    // What is flat in the window.
    QPolygonF outline;
    if (panel && panel->mode() == BendPanel::Brush) {
        const QPointF place = marking ? mouse : QPointF(view->mapFromGlobal(QCursor::pos()));
        for (int i = 0; i < 40; ++i)
            outline << place + panel->brush() * QPointF(std::cos(i * 9 * degree), std::sin(i * 9 * degree));
    } else if (marking && panel && panel->mode() == BendPanel::Rectangle && marking->corners.size() == 2) {
        outline = QPolygonF(QRectF(marking->corners[0], marking->corners[1]));
    } else if (marking) {
        outline = QPolygonF(marking->corners);
    }
    glMatrixMode(GL_PROJECTION);
    glPushMatrix();
    glLoadIdentity();
    glOrtho(0, seen.width, 0, seen.height, -1, 1);
    glMatrixMode(GL_MODELVIEW);
    glPushMatrix();
    glLoadIdentity();
    glLineWidth(2);
    glColor3ub(20, 20, 20);
    glBegin(GL_LINE_LOOP);
    for (const QPointF &corner : outline)
        put(windowOf(corner));
    glEnd();
    glPopMatrix();
    glMatrixMode(GL_PROJECTION);
    glPopMatrix();
    glMatrixMode(GL_MODELVIEW);
    glPopAttrib();
}

#include "moc_bend_tool.cpp" // NOLINT(bugprone-suspicious-include)
