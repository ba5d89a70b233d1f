// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MESHLAB_HOST_H
#define FCD_MESHLAB_HOST_H

/// \file
/// The only place that knows which MeshLab the plugin is built for. The rest of the plugin derives from
/// HostFilterPlugin and calls the functions in namespace host; both look the same for every host.
///
/// FCD_MESHLAB_2020 is defined (by CMake) for MeshLab 2020.09, whose filters are MeshFilterInterface; later hosts have
/// FilterPlugin. (A define, since moc does not evaluate __has_include.)

#ifdef FCD_MESHLAB_2020
#include <common/filterscript.h>
#include <common/interfaces.h>
#include <common/mlexception.h>
#else
#include <common/plugins/interfaces/filter_plugin.h>
#endif

#include <algorithm>
#include <exception>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <map>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include <QApplication>
#include <QDir>
#include <QFileInfo>
#include <QObject>
#include <QRegularExpression>
#include <QVariant>
#include <QWidget>

namespace host {

/// Whether a person sits at MeshLab's window. Otherwise a script runs, which wants the same whatever was done before.
inline bool inWindow() {
    const QWidgetList windows = QApplication::topLevelWidgets();
    return std::any_of(windows.begin(), windows.end(),
                       [](const QWidget *window) { return window->inherits("MainWindow"); });
}

// --- parameters ---

#if defined(FCD_MESHLAB_2020)
using RichPositionParam = RichPoint3f;
using RichDirectionParam = RichPoint3f;
#else
using RichPositionParam = RichPosition;
using RichDirectionParam = RichDirection;
#endif

#if __has_include(<common/parameters/rich_parameter.h>) || defined(FCD_MESHLAB_2020) // their names up to 2022.02
using RichPercentageParam = RichAbsPerc;
using RichMatrixParam = RichMatrix44f;
using RichFileParam = RichOpenFile;
using RichSaveFileParam = RichSaveFile;
#else
using RichPercentageParam = RichPercentage;
using RichMatrixParam = RichMatrix44;
using RichFileParam = RichFileOpen;
using RichSaveFileParam = RichFileSave;
#endif

/// Where the dialog shows a parameter, where the host makes the difference (2022.02 on).
enum class Shown { Always, Advanced };

/// Appends a Rich parameter made from \p arguments: all of the constructor's up to the tool tip.
template <class Rich, class... Arguments>
void addParameter(RichParameterList &list, Shown shown, const Arguments &...arguments) {
#ifdef FCD_MESHLAB_2020
    (void)shown;
    list.addParam(Rich(arguments...));
#else
    list.addParam(Rich(arguments..., shown == Shown::Advanced));
#endif
}

/// Appends a parameter that names a layer; \p layer is the default, null for none (a document without layers).
inline void addLayerParameter(RichParameterList &list, Shown shown, const QString &name, const MeshModel *layer,
                              const MeshDocument &document, const QString &label, const QString &tip) {
#ifdef FCD_MESHLAB_2020
    (void)shown;
    auto *owner = layer ? const_cast<MeshDocument *>(&document) : nullptr;
    list.addParam(RichMesh(name, const_cast<MeshModel *>(layer), owner, label, tip));
#else
    list.addParam(RichMesh(name, layer ? layer->id() : 0, &document, label, tip, shown == Shown::Advanced));
#endif
}

/// Sets an enum parameter.
inline void setEnum(RichParameterList &list, const QString &name, int value) {
#ifdef FCD_MESHLAB_2020
    list.setValue(name, EnumValue(value));
#else
    list.setValue(name, IntValue(value));
#endif
}

/// Sets a layer parameter.
inline void setLayer(RichParameterList &list, const QString &name, const MeshModel &layer) {
#ifdef FCD_MESHLAB_2020
    list.setValue(name, RichMesh(name, const_cast<MeshModel *>(&layer), nullptr, QString(), QString()).value());
#else
    list.setValue(name, IntValue(layer.id()));
#endif
}

/// Whether a parameter names a layer.
inline bool isLayerParameter(const RichParameter &parameter) {
    return dynamic_cast<const RichMesh *>(&parameter) != nullptr;
}

/// The layer that a layer parameter names, null when there is none.
inline MeshModel *layerParameter(const RichParameterList &list, const QString &name, const MeshDocument &document) {
#ifdef FCD_MESHLAB_2020
    MeshModel *layer = list.getMesh(name); // maybe deleted since the dialog was opened
    return document.meshList.contains(layer) ? layer : nullptr;
#else
    return const_cast<MeshDocument &>(document).getMesh(list.getMeshId(name)); // which is not changed
#endif
}

/// The value of a 4x4 matrix parameter.
inline Matrix44m matrixParameter(const RichParameterList &list, const QString &name) {
#ifdef FCD_MESHLAB_2020
    return list.getMatrix44m(name);
#else
    return list.getMatrix44(name);
#endif
}

/// Whether a script may lack parameters, which then have their defaults. Where it may not, a filter keeps the
/// parameters that it has, so that scripts written for it go on running.
#ifdef FCD_MESHLAB_2020
constexpr bool scriptsMayLackParameters = false;
#else
constexpr bool scriptsMayLackParameters = true;
#endif

/// Whether a script may lack the first parameter only: a new one, which stands elsewhere in the window, stands there.
inline bool firstMayBeLacking() { return !scriptsMayLackParameters && !inWindow(); }

/// Whether a dialog that is taller than the screen scrolls, and folds advanced parameters. Where it does not, a long
/// one has its buttons below the screen.
#ifdef FCD_MESHLAB_2020
constexpr bool dialogsFold = false;
#else
constexpr bool dialogsFold = true;
#endif

// --- layers ---

/// The values of the vertex attribute of a name and a type, one per slot, null where there is none.
template <class T>
T *vertexAttribute(const CMeshO &mesh, const char *name) {
    for (const vcg::PointerToAttribute &attribute : mesh.vert_attr)
        if (attribute._name == name && attribute._type == typeid(T))
            return mesh.vert.empty() ? nullptr : static_cast<T *>(attribute._handle->DataBegin());
    return nullptr;
}

/// The same, made where there is none. One of that name and another type goes.
template <class T>
T *madeVertexAttribute(CMeshO &mesh, const char *name) {
    using Allocator = vcg::tri::Allocator<CMeshO>;
    if (!vertexAttribute<T>(mesh, name)) {
        if (vcg::tri::HasPerVertexAttribute(mesh, name))
            Allocator::DeletePerVertexAttribute(mesh, name);
        Allocator::AddPerVertexAttribute<T>(mesh, name);
    }
    return vertexAttribute<T>(mesh, name);
}

/// The mesh attribute of a name and a type, null where there is none. vcg's own functions read a counter that 2020.09
/// does not initialise, and know types by their size only.
template <class T>
T *meshAttribute(const CMeshO &mesh, const char *name) {
    for (const vcg::PointerToAttribute &attribute : mesh.mesh_attr)
        if (attribute._name == name && attribute._type == typeid(T))
            return static_cast<T *>(attribute._handle->DataBegin());
    return nullptr;
}

/// The same, made where there is none.
template <class T>
T &madeMeshAttribute(CMeshO &mesh, const char *name) {
    if (!meshAttribute<T>(mesh, name))
        vcg::tri::Allocator<CMeshO>::AddPerMeshAttribute<T>(mesh, name);
    return *meshAttribute<T>(mesh, name);
}

/// All layers, in the document's order.
inline std::vector<const MeshModel *> layers(const MeshDocument &document) {
    std::vector<const MeshModel *> all;
#ifdef FCD_MESHLAB_2020
    for (const MeshModel *layer : document.meshList)
        all.push_back(layer);
#else
    for (const MeshModel &layer : document.meshIterator())
        all.push_back(&layer);
#endif
    return all;
}

/// Shows a layer in the window, or hides it, once showChanges() is called.
inline void setVisible(MeshModel &layer, bool visible) {
#ifdef FCD_MESHLAB_2020
    layer.visible = visible;
#else
    layer.setVisible(visible);
#endif
}

/// Lets the window know which layers are visible: it asks when layers come and go.
inline void showChanges(MeshDocument &document) { emit document.meshSetChanged(); }

/// Deletes a layer. The current layer may change.
inline void removeLayer(MeshDocument &document, MeshModel *layer) {
#ifdef FCD_MESHLAB_2020
    document.delMesh(layer);
#else
    document.delMesh(layer->id());
#endif
}

/// Gives \p to the texture images of \p from. In 2020.09 a layer has names of files only.
inline void copyTextures(MeshModel &to, const MeshModel &from) {
#ifdef FCD_MESHLAB_2020
    // The window reads the files of a new layer from the current directory.
    (void)to;
    if (!inWindow() || from.cm.textures.empty())
        return;
    const QDir folder = QFileInfo(from.fullName()).absoluteDir();
    if (folder.exists(QString::fromStdString(from.cm.textures.front())))
        QDir::setCurrent(folder.path());
#else
    for (const auto &texture : from.getTextures())
        to.addTexture(texture.first, texture.second);
#endif
}

} // namespace host

// --- the filter interface ---

#ifdef FCD_MESHLAB_2020
#define FCD_PLUGIN_METADATA Q_PLUGIN_METADATA(IID MESH_FILTER_INTERFACE_IID)
#else
#define FCD_PLUGIN_METADATA Q_PLUGIN_METADATA(IID FILTER_PLUGIN_IID)
#endif

/// Base class of a filter plugin for any host: the pure functions below are all that a plugin has to give.
///
/// Nothing but what the host expects leaves a filter, since any other exception would end the program: errors reach the
/// user as one message.
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
    /// Name and value (int, double, float or bool; other types are lost on the way to a script).
    using ReturnedValues = std::map<std::string, QVariant>;

    /// The parameters of filter \p id with their defaults. Cheap, and valid on a document without any layer.
    virtual RichParameterList parameters(int id, const MeshDocument &document) const = 0;

    /// Runs filter \p id. \throw any exception derived from std::exception; its text is the message for the user.
    /// Leaves the document as it was when it throws.
    virtual ReturnedValues run(int id, const RichParameterList &parameters, MeshDocument &document,
                               vcg::CallBackPos *callback) = 0;

    /// Name of filter \p id in scripts.
    virtual QString scriptName(int id) const = 0;

    /// Bits of FilterClass: the menus that show filter \p id.
    virtual FilterClass menus(int id) const = 0;

    /// Bits of MeshModel::MeshElement: what filter \p id changes in the current layer, MM_NONE where it does not.
    virtual int changes(int id) const = 0;

    /// Name of the plugin.
    virtual QString name() const = 0;

  protected:
    /// Announces the filters; a plugin calls this once, in its constructor.
    void announce(std::initializer_list<int> ids) {
        for (int id : ids) {
            typeList.push_back(id);
            actionList.push_back(new QAction(filterName(id), this));
        }
    }

    /// The action that opens the dialog of filter \p id.
    QAction *action(int id) const {
        const auto type = std::find(typeList.begin(), typeList.end(), id);
        return *std::next(actionList.begin(), std::distance(typeList.begin(), type));
    }

    /// Writes a line to the host's log. The log pane renders HTML, hence no '<' reaches it as such.
    void logLine(std::string line, GLLogStream::Levels level = GLLogStream::FILTER) const {
        for (char &c : line)
            c = c == '<' ? '[' : c == '>' ? ']' : c;
#ifdef FCD_MESHLAB_2020
        const_cast<HostFilterPlugin *>(this)->Log(level, line.c_str());
#else
        log(level, line);
#endif
    }

  private:
    /// Runs \p work. Returns an empty text, or what went wrong.
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

    /// A message as the window shows it, which is HTML: parameters by the names that they have there, scripts' names
    /// left out.
    static QString forWindow(const QString &message, const RichParameterList &list) {
        QString text = message.toHtmlEscaped();
        text.remove(QRegularExpression(" \\((generate|compute|apply|save|clear)_[a-z_]+\\)"));
        bool isFileNamed = false;
        for (const RichParameter &parameter : list) {
            const QString label = "<i>" + parameter.fieldDescription() + "</i>";
            text.replace("'" + parameter.name() + "'", label);
            // Other names are words that a sentence may hold.
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
    /// The window writes to its script the layers that a dialog had when it opened: here, those that were chosen.
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
        errorMessage = errorOf([&] { values = run(ID(action), list, document, callback); });
        if (host::inWindow()) {
            if (!errorMessage.isEmpty())
                errorMessage = forWindow(errorMessage, parameters(ID(action), document));
            return errorMessage.isEmpty();
        }
        // This host does not return values, and meshlabserver does not print error messages: tell both.
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
        const QString error = errorOf([&] { values = run(ID(action), list, document, callback); });
        if (!error.isEmpty())
            throw MLException(host::inWindow() ? forWindow(error, parameters(ID(action), document)) : error);
        return values;
    }
#endif
};

#endif
