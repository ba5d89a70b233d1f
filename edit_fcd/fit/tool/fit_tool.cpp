// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/tool/fit_tool.h"

#include "edit_fcd/view/trace.h"

#include <cmath>

// What the tool shows: layers, and the shape of the fitted one.

FitTool::FitTool(QAction *action) : LayerTool(action) {
    every(progressTimer, [this] { refresh(); });
    optionsTimer.setSingleShot(true);
    every(optionsTimer, [this] { reshape(true); });
}

// --- what is seen ---

/// Whether the last pair lacks its place on the target.
bool FitTool::isTurnOfTarget() const {
    return session && !session->state().pairs.empty() && !session->state().pairs.back().place;
}

FitMarks FitTool::marks() const {
    FitMarks marks;
    const FitPanel::Seen which = panel ? panel->seen() : FitPanel::Both;
    marks.showsSource = which == FitPanel::Both || which == FitPanel::Source ||
                        (which == FitPanel::InTurn && (!isTurnOfTarget() || !target()));
    marks.showsTarget =
        which == FitPanel::Both || which == FitPanel::Target || (which == FitPanel::InTurn && !marks.showsSource);
    marks.selected = selected;
    return marks;
}

void FitTool::setSeen(FitPanel::Seen which) {
    panel->setSeen(which);
    showLayers();
}

void FitTool::showLayers() {
    if (!layer())
        return;
    const FitMarks shown = marks();
    bool isChanged = false;
    const auto set = [&](MeshModel *each, bool visible) {
        const bool before = each->isVisible();
        wasVisible.emplace(each->id(), before);
        if (before != visible) {
            host::setVisible(*each, visible);
            isChanged = true;
        }
    };
    set(model, shown.showsSource);
    if (MeshModel *other = target())
        set(other, shown.showsTarget);
    if (isChanged)
        host::showChanges(*view->md());
    view->update();
}

void FitTool::showVertices(bool full) {
    if (!layer())
        return;
    display->updateShape(full || display->showsFaces());
    overlay->move();
    isPainted = false;
}

void FitTool::draw() {
    beginDraw();
    if (!layer())
        return;
    if (marks().showsSource)
        overlay->draw(model->cm);
    if (isPainting() && marks().showsTarget && target())
        targetOverlay->draw(target()->cm);
    drawCurves(*session, marks());
    drawPairs(*session, marks());
    if (isPainting() && !isSuspended && !isCamera) {
        const QPointF at = stroke ? mouse : QPointF(view->mapFromGlobal(QCursor::pos()));
        drawBrush(seen, windowOf(*view, seen, at).head<2>(), panel->brushSize() * view->devicePixelRatioF());
    }
}

QString FitTool::stateText() const {
    if (isSuspended)
        return "Camera mode. Esc: back to fitting.";
    if (!hint.isEmpty())
        return hint;
    if (!target())
        return "Open a scan as another layer: you lay this layer onto it.";
    const auto bold = [](const MeshModel &each, const char *color) {
        return QString("<b style='color: %1'>%2</b>").arg(color, each.label().toHtmlEscaped());
    };
    if (isPainting())
        return panel->brush() == FitPanel::Carried
                   ? "Paint over either layer: these parts go along and are not matched. The wheel sets the brush's "
                     "size; X: paint what counts; B: back to pairs."
                   : "Paint over either layer: these parts count. The wheel sets the brush's size; X: paint what goes "
                     "along; B: back to pairs.";
    QString text = isTurnOfTarget() ? "Click the same point on " + bold(*target(), "#d0700a") + "."
                                    : "Click a point on " + bold(*model, "#2d6eeb") + ", then the same one on " +
                                          bold(*target(), "#d0700a") + ". Drag a point to move it.";
    if (work)
        return text + (isFollowWanted ? "<br>Preparing the layer ..." : "<br>Pulling ...");
    if (const FittedSurface *fitted = session->pulled(*target()))
        text += QString("<br>%1 % lie on the target, off by %2 (rms)%3.")
                    .arg(std::floor(1000 * fitted->report.matched) / 10, 0, 'g',
                         3) // rounded down: 100 % only if all matched
                    .arg(fitted->report.rms, 0, 'g', 2)
                    .arg(fitted->curves.curve.empty()
                             ? QString()
                             : QString("; curves are off by at most %1").arg(fitted->report.curves, 0, 'g', 2));
    return text;
}

void FitTool::refresh() {
    if (!panel || !session)
        return;
    panel->showProgress(work ? work.percent() : -1);
    panel->showState(stateText());
    panel->showShape(session->state().shape);
    const auto &lines = session->state().lines;
    panel->showCurves(lines ? QString::fromStdString(lines->file) : QString());
    if (layer())
        session->keep(target());
    panel->showPairs(session->state().pairs, selected);
}

// --- work in the background ---

void FitTool::begin(JobRunner::Work what, std::function<void()> done) {
    stopWork();
    work.begin(std::move(what), [this, done = std::move(done)](const std::exception_ptr &thrown) {
        progressTimer.stop();
        guarded([&] {
            try {
                if (thrown)
                    std::rethrow_exception(thrown);
                done();                             // it may begin other work
            } catch (const vcg::fcd::Cancelled &) { // nothing has changed
            }
        });
        guarded([&] { refresh(); });
    });
    progressTimer.start(100);
    refresh();
}

void FitTool::stopWork() {
    work.stop(); // waits for it
    progressTimer.stop();
    isFollowWanted = false;
}

// --- the shape ---

/// Shows the shape of the state. \param full false: during a drag
void FitTool::reshape(bool full) {
    if (!layer())
        return;
    stopWork();
    switch (full ? session->state().shape : FitShape::Landmarks) {
    case FitShape::Rest:
        session->restore();
        showVertices(true);
        showColors();
        break;
    case FitShape::Landmarks: follow(full); break;
    case FitShape::Pulled: {
        const MeshModel &onto = expectedTarget();
        if (session->pulled(onto)) {
            session->showPulled();
            showVertices(true);
            showColors();
            break;
        }
        const auto fit = session->beginPull(onto);
        const auto fitted = std::make_shared<FittedSurface>();
        begin([fit, fitted](const vcg::fcd::Progress &progress) { *fitted = std::move(*fit).solve(true, progress); },
              [this, fit, fitted] { whenPulled(fit, fitted); });
        break;
    }
    }
}

void FitTool::whenPulled(const std::shared_ptr<const LayerFit> &fit, const std::shared_ptr<FittedSurface> &fitted) {
    if (!layer() || !target())
        return;
    session->finishPull(*target(),
                        std::shared_ptr<const FittedSurface>(
                            fitted.get(), [fit, fitted](const FittedSurface *) {})); // keeps alive what it refers to
    session->showPulled();
    showVertices(true);
    showColors();
    if (fitted->report.matched < 0.3) // most of the shape is a guess
        say("Only a small part of the layer has a counterpart on the target: place pairs first, or raise the largest "
            "distance.",
            true);
    for (const std::string &remark : fitted->report.Remarks())
        say(remark, true);
    trace("pulled: %d vertices, rms %g, matched %g", model->cm.vn, fitted->report.rms, fitted->report.matched);
}

void FitTool::follow(bool full) {
    if (const auto fit = session->beginPreparing()) {
        const auto fitter = std::make_shared<std::shared_ptr<const vcg::fcd::Fitter>>();
        begin([fit, fitter](const vcg::fcd::Progress &progress) { *fitter = fit->prepare(progress); },
              [this, fit, fitter] {
                  isFollowWanted = false;
                  if (!layer())
                      return;
                  session->finishPreparing(fit, *fitter);
                  follow(!dragged);
              });
        isFollowWanted = true;
        return;
    }
    const vcg::fcd::Stopwatch watch;
    session->follow(full);
    const double solved = 1000 * watch.Seconds();
    showVertices(full);
    showColors();
    trace("follow: %d vertices, solve and write %.1f, in all %.1f ms", model->cm.vn, solved, 1000 * watch.Seconds());
}

#include "edit_fcd/fit/tool/moc_fit_tool.cpp" // NOLINT(bugprone-suspicious-include)
