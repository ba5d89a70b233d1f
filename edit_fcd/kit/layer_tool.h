// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_TOOL_H
#define FCD_LAYER_TOOL_H

#include <layer_fcd/edit_host.h> // these before Qt
#include <layer_fcd/parameters.h>

#include "edit_fcd/view/display_state.h"
#include "edit_fcd/kit/tool_window.h"
#include "edit_fcd/view/layer_drawing.h"

#include <functional>
#include <map>
#include <memory>

#include <QDockWidget>
#include <QPointF>
#include <QPointer>
#include <QTimer>

struct SessionContents;

/// A tool with a panel that works on the current layer of a view.
class LayerTool : public HostEditTool {
    Q_OBJECT

  public:
    explicit LayerTool(QAction *action) : action(action) {}
    void end() override { close(); }
    /// Writes to the log; a warning is also the panel's hint.
    void say(const std::string &text, bool warning = false) final;
    /// Takes keys before the host's shortcuts do.
    bool eventFilter(QObject *object, QEvent *event) final;

  protected:
    // An exception in the host's event loop ends the program: connect by when(), and work later by later() or every().

    /// Connects \p signal of \p sender with \p slot.
    template <class Sender, class Signal, class Slot>
    void when(const Sender *sender, Signal signal, Slot slot) {
        connect(sender, signal, this, [this, slot](auto... what) { this->guarded([&] { slot(what...); }); });
    }
    /// Does \p work in the next turn of the event loop, or so many milliseconds later.
    void later(const std::function<void()> &work, int milliseconds = 0);
    /// Does \p work, and nothing else, at each timeout of \p timer. The timer stops if it fails.
    void every(QTimer &timer, const std::function<void()> &work);

    /// Tells what was done: in the panel, and, with more, in the log.
    void tell(const std::string &what, const std::string &more = {});
    void showHint();
    void refreshAll(); ///< updates panel and view
    Remark toLog() {
        return [this](const std::string &line) { say(line); };
    }

    /// Gets the view's events while the tool has a layer. \return whether the view must not get the event
    virtual bool takesEvent(QEvent &event) = 0;
    /// Ends what was begun, and calls leaveView().
    virtual void close() = 0;
    virtual void showVertices(bool full) = 0;
    virtual void refresh() = 0;               ///< updates the panel
    virtual ToolPanel *toolPanel() const = 0; ///< may be null
    /// Whether there is a layer to work on. If something else changed it, begins anew.
    virtual bool isReady() = 0;
    virtual void keepShown() = 0; ///< makes the shown shape the one that filters and files find
    /// Takes the state of the layer from a file. \throw vcg::fcd::Error nothing has changed
    virtual SessionContents takeSession(const QString &file) = 0;
    virtual void forgetDocument() = 0; ///< the document is gone: forgets its layers
    /// Makes a step of what follows the mouse. Called once for each painted frame, since the mouse moves more often.
    virtual void step() = 0;
    void requestStep();
    void takeStep();
    /// Call as painting begins: takes the camera, and marks the shown shape as painted.
    void beginDraw();

    /// From now on the tool gets the view's events, and ends with the view. \pre it has entered a layer
    void enterView();
    /// Deletes the panel, too.
    void leaveView();
    void enterLayer(MeshModel &newModel);
    MeshModel *presentLayer() const; ///< the entered one; null if it is gone
    /// Calls \p apply, which adds layers, and ends the tool. \param goesOn begin anew with the new layer
    void applyToNewLayer(const std::function<void()> &apply, bool goesOn);

    // Both ask for a file. \return empty if there is none, or no layer to work on any more
    QString fileToLoad(const QString &title, const QString &kinds);
    QString fileToSave(const QString &title, const QString &kinds);
    /// Asks for a file, and saves the state of the layer to it, or loads it.
    void chooseSession(bool load);

    /// Takes a view of a document, and forgets another document.
    void enterDocument(MeshDocument &newDocument, GLArea *area);
    /// Erases the sessions of layers that are gone. \param left by the number of the layer
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
    MeshModel *model = nullptr; ///< of the session; may be deleted already
    std::unique_ptr<DisplayState> display;
    std::unique_ptr<LayerOverlay> overlay;
    bool isEnding = false; ///< the tool is done, and the host will end it
    Camera seen;
    QPointF mouse;
    QString hint;             ///< what could not be done; shown until the next press or key
    bool isSuspended = false; ///< the mouse moves the camera until Esc
    bool isCamera = false;    ///< a pressed button moves the camera
    bool isPainted = true;    ///< the shown shape was painted
    bool isStepWanted = false;
};

#endif
