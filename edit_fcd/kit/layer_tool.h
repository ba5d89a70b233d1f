// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_TOOL_H
#define FCD_LAYER_TOOL_H

#include <layer_fcd/edit_host.h> // before Qt

#include "edit_fcd/view/display_state.h"
#include "edit_fcd/view/layer_overlay.h"

#include <functional>
#include <memory>

#include <QDockWidget>
#include <QPointer>
#include <QTimer>

/// A tool with a panel that works on the current layer of a view: how it begins and ends there.
class LayerTool : public HostEditTool {
    Q_OBJECT

  public:
    explicit LayerTool(QAction *action) : action(action) {}
    void end() override { close(); }
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

    /// The tool gets what happens to the view, and ends with it. \pre it has entered a layer
    void enterView();
    /// \param panel goes; may be null
    void leaveView(QDockWidget *panel);
    void enterLayer(MeshModel &newModel);
    /// Calls \p apply, which adds layers, and ends. \param goesOn with the new layer
    void applyToNewLayer(const std::function<void()> &apply, bool goesOn);

    QAction *action;
    QPointer<GLArea> view;
    int layerId = -1;
    MeshModel *model = nullptr; ///< of the session; may be gone
    std::unique_ptr<DisplayState> display;
    std::unique_ptr<LayerOverlay> overlay;
    bool isEnding = false; ///< done, and about to be told so
};

#endif
