// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_TOOL_H
#define FCD_LAYER_TOOL_H

#include <layer_fcd/edit_host.h> // before Qt

#include "edit_fcd/view/display_state.h"
#include "edit_fcd/kit/tool_window.h"
#include "edit_fcd/view/layer_overlay.h"

#include <functional>
#include <map>
#include <memory>

#include <QDockWidget>
#include <QPointF>
#include <QPointer>
#include <QTimer>

struct SessionContents;

/// A tool with a panel that works on the current layer of a view: how it begins and ends there.
class LayerTool : public HostEditTool {
    Q_OBJECT

  public:
    explicit LayerTool(QAction *action) : action(action) {}
    void end() override { close(); }
    /// What is a warning is the panel's hint, too.
    void say(const std::string &text, bool warning = false) final;
    /// Takes keys before the host's shortcuts do.
    bool eventFilter(QObject *object, QEvent *event) final;

  protected:
    // What the host's loop calls is guarded, since what it throws would end the program: all slots of a tool are
    // connected by when(), and what is done in another turn of the loop begins by later() or every().

    /// Does \p slot whenever \p sender says \p signal, with all that it says.
    template <class Sender, class Signal, class Slot>
    void when(const Sender *sender, Signal signal, Slot slot) {
        connect(sender, signal, this, [this, slot](auto... what) { this->guarded([&] { slot(what...); }); });
    }
    /// Does \p work once what is going on is done.
    void later(const std::function<void()> &work);
    /// Does \p work each time that \p timer ends, in the place of what it did; the timer stops where that fails.
    void every(QTimer &timer, const std::function<void()> &work);

    /// What is sent to the view while the tool has a layer. \return whether it is taken, which the view does not get
    virtual bool takesEvent(QEvent &event) = 0;
    /// What was begun is taken back or kept, as the tool has it, and leaveView() called.
    virtual void close() = 0;
    virtual void showVertices(bool full) = 0;
    virtual void refresh() = 0; ///< the panel shows what there is
    virtual void showHint() = 0;
    /// Whether there is a layer to work on; begins anew with one that something else has changed.
    virtual bool isReady() = 0;
    virtual void keepShown() = 0; ///< what the layer shows is what a filter, and a file, finds
    /// What is known of the layer is that of a file. \throw vcg::fcd::Error; all is then as it was
    virtual SessionContents takeSession(const QString &file) = 0;
    virtual void forgetDocument() = 0; ///< which is gone, with all that was left of its layers
    /// A step of what moves with the mouse: one a painted frame, since the mouse moves more often.
    virtual void step() = 0;
    void requestStep();
    void takeStep();
    /// What is shown is painted, and seen as it is now.
    void beginDraw();

    /// The tool gets what happens to the view, and ends with it. \pre it has entered a layer
    void enterView();
    /// \param panel goes; may be null
    void leaveView(QDockWidget *panel);
    void enterLayer(MeshModel &newModel);
    /// Calls \p apply, which adds layers, and ends. \param goesOn with the new layer
    void applyToNewLayer(const std::function<void()> &apply, bool goesOn);

    /// Asks for a file, and saves what is known of the layer, or loads it.
    void chooseSession(bool load);

    /// The tool has a view of a document, and lets go of what it had of another one.
    void enterDocument(MeshDocument &newDocument, GLArea *area);
    /// Of layers that were left, by their number, those that are gone take what was done to them along.
    template <class Session>
    void forgetGone(std::map<int, Session> &left) const {
        for (auto each = left.begin(); each != left.end();)
            each = document->getMesh(each->first) ? std::next(each) : left.erase(each);
    }
    Eigen::Vector3d windowOfMouse() const { return windowOf(*view, seen, mouse); }

    QAction *action;
    QPointer<MeshDocument> document;
    QPointer<GLArea> view;
    int layerId = -1;
    MeshModel *model = nullptr; ///< of the session; may be gone
    std::unique_ptr<DisplayState> display;
    std::unique_ptr<LayerOverlay> overlay;
    bool isEnding = false; ///< done, and about to be told so
    Camera seen;
    QPointF mouse;
    QString hint;             ///< what could not be done, until the next press or key
    bool isSuspended = false; ///< the mouse is the camera's until Esc
    bool isCamera = false;    ///< a button is held that is the camera's
    bool isPainted = true;    ///< what the layer shows
    bool isStepWanted = false;
};

#endif
