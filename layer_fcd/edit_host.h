// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_EDIT_HOST_H
#define FCD_EDIT_HOST_H

/// \file
/// Base classes of plugins with editing tools, for any host; see meshlab_host.h.

#include "meshlab_host.h"

#ifndef FCD_MESHLAB_2020
#include <common/plugins/interfaces/edit_plugin.h>
#endif
#include <meshlab/glarea.h>

#include <exception>
#include <string>

#include <QAction>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>

#ifdef FCD_MESHLAB_2020
#define FCD_EDIT_INTERFACE MeshEditInterface
#define FCD_EDIT_PLUGIN_INTERFACE MeshEditInterfaceFactory
#define FCD_EDIT_METADATA Q_PLUGIN_METADATA(IID MESH_EDIT_INTERFACE_FACTORY_IID)
#define FCD_EDIT_METHOD(name2020, name2022) name2020
#else
#define FCD_EDIT_INTERFACE EditTool
#define FCD_EDIT_PLUGIN_INTERFACE EditPlugin
#define FCD_EDIT_METADATA Q_PLUGIN_METADATA(IID EDIT_PLUGIN_IID)
#define FCD_EDIT_METHOD(name2020, name2022) name2022
#endif

namespace host {

/// Loads the textures of a layer into the graphics card, as the host does for layers of filters and files.
inline void showTextures(GLArea &view, const MeshModel &layer) {
    if (!layer.cm.textures.empty())
        QMetaObject::invokeMethod(view.window(), "updateTexture", Qt::DirectConnection, Q_ARG(int, layer.id()));
}

/// Gives the mouse to the camera, or takes it back, as the host's Esc.
inline void suspendEditing(GLArea &view) {
    QMetaObject::invokeMethod(view.window(), "suspendEditMode", Qt::DirectConnection);
}

/// Updates the list of layers, which shows what has changed since it was saved.
inline void showLayers(GLArea &view) {
    QMetaObject::invokeMethod(view.window(), "updateLayerDialog", Qt::QueuedConnection);
}

} // namespace host

/// Base class of an editing tool for any host. The host makes one for each of its views, and never deletes it. An
/// exception would end the program, so all are caught, and their texts go to the log.
class HostEditTool : public QObject, public FCD_EDIT_INTERFACE {
    Q_OBJECT

  public:
    /// Begins with the current layer. \return whether it can be edited
    virtual bool start(MeshDocument &document, GLArea *view) = 0;
    /// Ends; may be called several times, and for a layer that is not the tool's.
    virtual void end() = 0;
    /// The current layer may have changed: it may be another one, the same, or none.
    virtual void changeLayer(MeshDocument &document, GLArea *view) = 0;
    virtual void draw() = 0;
    virtual void press(QMouseEvent *event) = 0;
    virtual void move(QMouseEvent *event) = 0;
    virtual void release(QMouseEvent *event) = 0;
    virtual void turnWheel(QWheelEvent *event) = 0;
    virtual void pressKey(QKeyEvent *event) = 0;

    /// Writes to the log, which renders HTML.
    virtual void say(const std::string &text, bool warning = false) = 0;

    /// Runs \p work; the text of an exception goes to the log. \return whether there was none
    template <class Work>
    bool guarded(const Work &work) {
        try {
            work();
            return true;
        } catch (const std::bad_alloc &) {
            say("Out of memory: this needs more than is free.", true);
        } catch (const std::exception &e) {
            say(e.what(), true);
        } catch (...) {
            say("Something that is not a standard exception was thrown.", true);
        }
        return false;
    }

    // --- what the host calls ---

    bool FCD_EDIT_METHOD(StartEdit, startEdit)(MeshDocument &document, GLArea *view,
                                               MLSceneGLSharedDataContext *) override {
        bool started = false;
        return guarded([&] { started = start(document, view); }) && started;
    }
    bool FCD_EDIT_METHOD(StartEdit, startEdit)(MeshModel &, GLArea *, MLSceneGLSharedDataContext *) override {
        return false; // the host calls the other one
    }
    void FCD_EDIT_METHOD(EndEdit, endEdit)(MeshModel &, GLArea *, MLSceneGLSharedDataContext *) override {
        guarded([&] { end(); });
    }
    void FCD_EDIT_METHOD(EndEdit, endEdit)(MeshDocument &, GLArea *, MLSceneGLSharedDataContext *) override {
        guarded([&] { end(); });
    }
    void FCD_EDIT_METHOD(LayerChanged, layerChanged)(MeshDocument &document, MeshModel &, GLArea *view,
                                                     MLSceneGLSharedDataContext *) override {
        guarded([&] { changeLayer(document, view); });
    }
    void FCD_EDIT_METHOD(Decorate, decorate)(MeshModel &, GLArea *, QPainter *) override {
        guarded([&] { draw(); });
    }
    void FCD_EDIT_METHOD(Decorate, decorate)(MeshModel &, GLArea *) override {}
    void mousePressEvent(QMouseEvent *event, MeshModel &, GLArea *) override {
        guarded([&] { press(event); });
    }
    void mouseMoveEvent(QMouseEvent *event, MeshModel &, GLArea *) override {
        guarded([&] { move(event); });
    }
    void mouseReleaseEvent(QMouseEvent *event, MeshModel &, GLArea *) override {
        guarded([&] { release(event); });
    }
    void wheelEvent(QWheelEvent *event, MeshModel &, GLArea *) override {
        guarded([&] { turnWheel(event); });
    }
    void keyPressEvent(QKeyEvent *event, MeshModel &, GLArea *) override {
        guarded([&] { pressKey(event); });
    }
};

/// Base class of a plugin with editing tools, each with an action, for any host.
class HostEditPlugin : public QObject, public FCD_EDIT_PLUGIN_INTERFACE {
    Q_OBJECT
    Q_INTERFACES(FCD_EDIT_PLUGIN_INTERFACE)

  public:
    virtual QString help(const QAction *action) const = 0;
    virtual HostEditTool *makeTool(QAction *action) const = 0;

#ifdef FCD_MESHLAB_2020
    QList<QAction *> actions() const override { return announced; }
    MeshEditInterface *getMeshEditInterface(QAction *action) override { return makeTool(action); }
    QString getEditToolDescription(QAction *action) override { return help(action); }
#else
    QString pluginName() const override { return "EditFCD"; }
    QString vendor() const override { return "FCD"; }
    std::pair<std::string, bool> getMLVersion() const override {
        return {meshlab::meshlabVersion(), meshlab::builtWithDoublePrecision()};
    }
    EditTool *getEditTool(const QAction *action) override { return makeTool(const_cast<QAction *>(action)); }
    QString getEditToolDescription(const QAction *action) override { return help(action); }
#endif

  protected:
    /// Announces a tool; to be called in the constructor. An action without an icon is not in the tool bar.
    QAction *announce(const QIcon &icon, const QString &text) {
        auto *action = new QAction(icon, text, this);
        action->setCheckable(true);
#ifdef FCD_MESHLAB_2020
        announced.push_back(action);
#else
        actionList.push_back(action);
#endif
        return action;
    }

#ifdef FCD_MESHLAB_2020
  private:
    QList<QAction *> announced;
#endif
};

#endif
