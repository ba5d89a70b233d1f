// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MESHLAB_HOST_H
#define FCD_MESHLAB_HOST_H

/// \file
/// Parameters, attributes and layers, with one interface for every version of MeshLab. Only this file, filter_host.h
/// and edit_host.h know the version.
///
/// CMake defines FCD_MESHLAB_2020 for MeshLab 2020.09, whose filters are MeshFilterInterface; later versions have
/// FilterPlugin. (A define, since moc does not evaluate __has_include.)

#include <vcg_ext/centroidal_deformation.h> // before Qt, whose macros (slots, emit, ...) are common words

#ifdef FCD_MESHLAB_2020
#include <common/interfaces.h>
#else
#include <common/plugins/interfaces/filter_plugin.h>
#endif

#include <vcg/complex/allocate.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <typeinfo>
#include <vector>

#include <QApplication>
#include <QDir>
#include <QFileInfo>
#include <QImage>
#include <QProgressBar>
#include <QWidget>

namespace host {

/// Whether MeshLab's window is open. Otherwise a script runs, and results must not depend on earlier runs.
inline bool inWindow() {
    const QWidgetList windows = QApplication::topLevelWidgets();
    return std::any_of(windows.begin(), windows.end(),
                       [](const QWidget *window) { return window->inherits("MainWindow"); });
}

#ifdef FCD_MESHLAB_2020
/// Clears the progress in the window, which does not do so itself after a filter that failed.
inline void endProgress() {
    for (QWidget *window : QApplication::topLevelWidgets())
        for (QProgressBar *bar : window->findChildren<QProgressBar *>())
            bar->reset();
}
#endif

/// A text for a log, which renders HTML.
inline std::string plainForLog(std::string text) {
    for (char &c : text)
        c = c == '<' ? '[' : c == '>' ? ']' : c;
    return text;
}

/// Writes a warning to the log of a document.
inline void log(MeshDocument &document, const std::string &text) {
    const std::string line = plainForLog(text);
#ifdef FCD_MESHLAB_2020
    document.Log.Log(GLLogStream::WARNING, line);
#else
    document.Log.log(GLLogStream::WARNING, line);
#endif
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

/// Where the dialog shows a parameter (from 2022.02 on).
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

/// Appends a parameter that names a layer. \param layer the default; null: the document has no layers
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

/// Whether a parameter names a file that is written.
inline bool isSaveFile(const RichParameter &parameter) {
    const QString type = parameter.stringType(); // 2020.09 does not export the class
    return type == "RichSaveFile" || type == "RichFileSave";
}

/// The layer that a layer parameter names; null: none.
inline MeshModel *layerParameter(const RichParameterList &list, const QString &name, const MeshDocument &document) {
#ifdef FCD_MESHLAB_2020
    MeshModel *layer = list.getMesh(name); // maybe deleted since the dialog was opened
    return document.meshList.contains(layer) ? layer : nullptr;
#else
    return const_cast<MeshDocument &>(document).getMesh(list.getMeshId(name)); // does not change the document
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

/// Whether a script may lack parameters, which have defaults then. If not, filters get no new ones: old scripts run on.
#ifdef FCD_MESHLAB_2020
constexpr bool scriptsMayLackParameters = false;
#else
constexpr bool scriptsMayLackParameters = true;
#endif

/// Whether a script may lack the first parameter only. A new parameter is then the first, unlike in the window.
inline bool firstMayBeLacking() { return !scriptsMayLackParameters && !inWindow(); }

/// Whether dialogs scroll and fold advanced parameters. If not, a long dialog has its buttons below the screen.
#ifdef FCD_MESHLAB_2020
constexpr bool dialogsFold = false;
#else
constexpr bool dialogsFold = true;
#endif

// --- attributes ---

// Filters and tool, two libraries, find each other's attributes: types are compared by name, not by the name's address.

/// Whether the type of an attribute has the name of T.
template <class T>
bool isCalled(const vcg::PointerToAttribute &attribute) {
    return std::strcmp(attribute._type.name(), typeid(T).name()) == 0;
}

/// Whether the values of an attribute are of a type.
template <class T>
bool isOfType(const vcg::PointerToAttribute &attribute) {
    return attribute._sizeof == int(sizeof(T)) && attribute._padding == 0 && isCalled<T>(attribute);
}

/// An attribute without values: the host tells it, as any attribute, how many elements there are, and where they move.
class Follower : public vcg::SimpleTempDataBase {
  public:
    std::size_t SizeOf() const override { return 0; }
    void *DataBegin() override { return nullptr; }
#ifndef FCD_MESHLAB_2020
    const void *DataBegin() const override { return nullptr; }
#endif
    void *At(std::size_t) override { return nullptr; }
    const void *At(std::size_t) const override { return nullptr; }
    void CopyValue(std::size_t, std::size_t, const vcg::SimpleTempDataBase *) override {}
};

// --- layers ---

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

/// Makes the window show which layers are visible now.
inline void showChanges(MeshDocument &document) { emit document.meshSetChanged(); }

/// Deletes a layer. The current layer may change.
inline void removeLayer(MeshDocument &document, MeshModel *layer) {
#ifdef FCD_MESHLAB_2020
    document.delMesh(layer);
#else
    document.delMesh(layer->id());
#endif
}

/// Copies the texture images of \p from to \p to. (In 2020.09 a layer has only the names of files.)
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

/// The image that \p layer holds of a texture; null: none, as in 2020.09, or only MeshLab's substitute for a missing
/// file. \param isFile whether there is a file of this name
inline QImage textureImage(const MeshModel &layer, const std::string &name, bool isFile) {
#ifdef FCD_MESHLAB_2020
    (void)layer, (void)name, (void)isFile;
    return {};
#else
    return name == "dummy.png" && !isFile ? QImage() : layer.getTexture(name);
#endif
}

} // namespace host

#endif
