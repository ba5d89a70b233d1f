// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FILTER_HOST_H
#define FCD_FILTER_HOST_H

/// \file
/// Base class of plugins with filters, for any host; see meshlab_host.h.

#include "meshlab_host.h"

#ifdef FCD_MESHLAB_2020
#include <common/filterscript.h>
#include <common/mlexception.h>
#else
#include <common/plugins/interfaces/filter_plugin.h>
#endif

#include <algorithm>
#include <exception>
#include <functional>
#include <iterator>
#include <map>
#include <new>
#include <string>

#include <QObject>
#include <QRegularExpression>
#include <QVariant>

#ifdef FCD_MESHLAB_2020
#define FCD_PLUGIN_METADATA Q_PLUGIN_METADATA(IID MESH_FILTER_INTERFACE_IID)
#else
#define FCD_PLUGIN_METADATA Q_PLUGIN_METADATA(IID FILTER_PLUGIN_IID)
#endif

/// Lets Ctrl-C (SIGINT) cancel a filter of a script while this object exists: Python only notes the signal, and looks
/// again when the filter is done. The former handler still gets the signal; without one, the signal ends the program,
/// as ever. There may be one object at a time.
class Interruptible {
  public:
    explicit Interruptible(vcg::CallBackPos *callback);
    ~Interruptible();
    Interruptible(const Interruptible &) = delete;
    Interruptible &operator=(const Interruptible &) = delete;

    /// The host's callback, if any, that also returns false once a signal has come.
    vcg::CallBackPos *callback() const;

  private:
    bool isSet = false; ///< a handler that notes the signal
};

/// Base class of a filter plugin for any host: a plugin implements the pure functions below. Any exception that the
/// host does not expect would end the program, so all are caught; errors reach the user as one message.
class HostFilterPlugin : public QObject,
#ifdef FCD_MESHLAB_2020
                         public MeshFilterInterface
#else
                         public FilterPlugin
#endif
{
    Q_OBJECT
#ifdef FCD_MESHLAB_2020
    Q_INTERFACES(MeshFilterInterface)
#else
    Q_INTERFACES(FilterPlugin)
#endif

  public:
    /// Names and values (int, double, float or bool: scripts get no other types).
    using ReturnedValues = std::map<std::string, QVariant>;

    /// The parameters of filter \p id with their defaults. Cheap, and valid on a document without any layer.
    virtual RichParameterList parameters(int id, const MeshDocument &document) const = 0;

    /// Runs filter \p id. \throw any std::exception: its text is for the user, and the document is as it was
    virtual ReturnedValues run(int id, const RichParameterList &parameters, MeshDocument &document,
                               vcg::CallBackPos *callback) = 0;

    /// Name of filter \p id in scripts.
    virtual QString scriptName(int id) const = 0;

    /// Bits of FilterClass: the menus that show filter \p id.
    virtual FilterClass menus(int id) const = 0;

    /// Bits of MeshModel::MeshElement: what filter \p id changes in the current layer; MM_NONE: nothing.
    virtual int changes(int id) const = 0;

    /// Name of the plugin.
    virtual QString name() const = 0;

  protected:
    /// Announces the filters 0 to \p count - 1; to be called once, in the constructor.
    void announce(int count) {
        for (int id = 0; id < count; ++id) {
            typeList.push_back(id);
            actionList.push_back(new QAction(filterName(id), this));
        }
    }

    /// The action that opens the dialog of filter \p id.
    QAction *action(int id) const {
        const auto type = std::find(typeList.begin(), typeList.end(), id);
        return *std::next(actionList.begin(), std::distance(typeList.begin(), type));
    }

    /// Writes a line to the host's log.
    void logLine(const std::string &line, GLLogStream::Levels level = GLLogStream::FILTER) const {
#ifdef FCD_MESHLAB_2020
        const_cast<HostFilterPlugin *>(this)->Log(level, host::plainForLog(line).c_str());
#else
        log(level, host::plainForLog(line));
#endif
    }

  private:
    /// Runs \p work. \return an empty text, or the error
    static QString errorOf(const std::function<void()> &work) {
        QString error;
        try {
            work();
            return error;
        } catch (const std::bad_alloc &) {
            error =
                "Out of memory: this mesh needs more memory than is free. Nothing was changed. Close other layers or "
                "programs, or simplify the mesh first.";
        } catch (const std::exception &e) {
            error = QString::fromUtf8(e.what());
        } catch (...) {
            error = "Something that is not a standard exception was thrown.";
        }
        return error.isEmpty() ? QString("Unknown error.") : error;
    }

    /// A message as HTML for the window: parameters have their labels instead of their names in scripts.
    static QString forWindow(const QString &message, const RichParameterList &list) {
        QString text = message.toHtmlEscaped();
        text.remove(QRegularExpression(" \\((generate|compute|apply|save|clear)_[a-z_]+\\)"));
        bool isFileNamed = false;
        for (const RichParameter &parameter : list) {
            const QString label = "<i>" + parameter.fieldDescription() + "</i>";
            text.replace("'" + parameter.name() + "'", label);
            // Other names may be words of the sentence.
            if (!parameter.name().contains('_') && parameter.name() != "transforms" &&
                parameter.name() != "TransformMatrix")
                continue;
            const QString before = text;
            text.replace(QRegularExpression("\\b" + parameter.name() + "\\b"), label);
            isFileNamed = isFileNamed || (text != before && parameter.name().endsWith("_file"));
        }
#ifdef FCD_MESHLAB_2020
        if (isFileNamed)
            text += "<br>Choose files with the ... button: this MeshLab does not take a path that is typed.";
#else
        (void)isFileNamed;
#endif
        return text;
    }

#ifdef FCD_MESHLAB_2020
    /// Corrects the layers in the window's script: the window writes the dialog's first ones, not the chosen ones.
    static void nameLayersInScript(FilterScript &script, const MeshDocument &document, const QString &filter) {
        if (script.isEmpty() || script.last().first != filter)
            return;
        for (RichParameter &parameter : script.last().second)
            if (host::isLayerParameter(parameter))
                if (const int i = document.meshList.indexOf(parameter.value().getMesh()); i >= 0)
                    dynamic_cast<RichMesh &>(parameter).meshindex = i;
    }
#endif

  public: // what the host calls
#ifdef FCD_MESHLAB_2020
    QString pluginName() const override { return name(); }
    FilterClass getClass(QAction *action) override { return menus(ID(action)); }
    FILTER_ARITY filterArity(QAction *) const override { return SINGLE_MESH; }
    int getPreConditions(QAction *) const override { return MeshModel::MM_NONE; }
    int postCondition(QAction *action) const override { return changes(ID(action)); }

    void initParameterSet(QAction *action, MeshDocument &document, RichParameterList &list) override {
        list.join(parameters(ID(action), document));
    }

    bool applyFilter(QAction *action, MeshDocument &document, const RichParameterList &list,
                     vcg::CallBackPos *callback) override {
        if (document.filterHistory)
            nameLayersInScript(*document.filterHistory, document, action->text());
        ReturnedValues values;
        const Interruptible interruptible(callback);
        errorMessage = errorOf([&] { values = run(ID(action), list, document, interruptible.callback()); });
        if (host::inWindow()) {
            if (!errorMessage.isEmpty()) {
                errorMessage = forWindow(errorMessage, parameters(ID(action), document));
                host::endProgress();
            }
            return errorMessage.isEmpty();
        }
        // This host does not return values, and meshlabserver does not print error messages: log both.
        for (const auto &value : values)
            logLine(value.first + " = " + value.second.toString().toStdString());
        if (!errorMessage.isEmpty())
            logLine(errorMessage.toStdString(), GLLogStream::WARNING);
        return errorMessage.isEmpty();
    }
#else
    QString pluginName() const override { return name(); }
    QString vendor() const override { return "FCD"; }
    std::pair<std::string, bool> getMLVersion() const override {
        return {meshlab::meshlabVersion(), meshlab::builtWithDoublePrecision()};
    }
    QString pythonFilterName(ActionIDType id) const override { return scriptName(id); }
    FilterClass getClass(const QAction *action) const override { return menus(ID(action)); }
    FilterArity filterArity(const QAction *) const override { return SINGLE_MESH; }
    int getPreConditions(const QAction *) const override { return MeshModel::MM_NONE; }
    int postCondition(const QAction *action) const override { return changes(ID(action)); }

    RichParameterList initParameterList(const QAction *action, const MeshDocument &document) override {
        return parameters(ID(action), document);
    }

    ReturnedValues applyFilter(const QAction *action, const RichParameterList &list, MeshDocument &document,
                               unsigned int &, vcg::CallBackPos *callback) override {
        ReturnedValues values;
        const Interruptible interruptible(callback);
        const QString error = errorOf([&] { values = run(ID(action), list, document, interruptible.callback()); });
        if (!error.isEmpty())
            throw MLException(host::inWindow() ? forWindow(error, parameters(ID(action), document)) : error);
        return values;
    }
#endif
};

#endif
