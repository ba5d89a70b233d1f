// SPDX-License-Identifier: GPL-3.0-or-later
#include <layer_fcd/parameters.h> // before Qt

#include "dialogs.h"
#include "filter_parameters.h"

#include <layer_fcd/kept_tool.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <string>

#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QDockWidget>
#include <QGridLayout>
#include <QLabel>
#include <QPointer>
#include <QPushButton>
#include <QScreen>
#include <QScrollArea>
#include <QScrollBar>
#include <QSignalBlocker>
#include <QTimer>

void LastValues::keep(int filter, const RichParameterList &used, const MeshDocument &document, const MeshModel &meant) {
    lists[filter] = used;
    const MeshModel *like =
        used.hasParameter(handleLayer) ? host::layerParameter(used, handleLayer, document) : nullptr;
    handleLayers[filter] = like && like != &meant ? like->label() : QString();
}

void LastValues::recall(int filter, RichParameterList &list, const MeshDocument &document) const {
    const auto last = lists.find(filter);
    if (last == lists.end())
        return;
    // Parameters that overwrite files, or undo the work of something else, are never remembered.
    const QStringList guards{"to", "keep_shape"};
    for (const RichParameter &parameter : list)
        if (!host::isLayerParameter(parameter) && !host::isSaveFile(parameter) && !guards.contains(parameter.name()) &&
            last->second.hasParameter(parameter.name()))
            list.setValue(parameter.name(), last->second.getParameterByName(parameter.name()).value());
    const QString &like = handleLayers.at(filter);
    for (const MeshModel *layer : host::layers(document))
        if (!like.isEmpty() && layer->label() == like)
            host::setLayer(list, handleLayer, *layer);
}

int likelySource(const MeshModel &layer, int last) {
    if (last > 1) // an attribute or files
        return last;
    const CMeshO &mesh = layer.cm;
    const auto isSelected = [](const auto &element) { return !element.IsD() && element.IsS(); };
    const bool isAnySelected = std::any_of(mesh.vert.begin(), mesh.vert.end(), isSelected) ||
                               std::any_of(mesh.face.begin(), mesh.face.end(), isSelected);
    return isAnySelected && !hasTags(layer) ? 1 : 0;
}

namespace {

/// Guards calls from the host's event loop: an exception, which would end the program, goes to the document's log.
class Guard {
  public:
    explicit Guard(MeshDocument &document) : document(&document) {}

    void later(const QObject *context, const std::function<void()> &work) const {
        QTimer::singleShot(0, context, [guard = *this, work] { guard.run(work); });
    }
    template <class Sender, class Signal>
    void when(const Sender *sender, Signal signal, const QObject *context, const std::function<void()> &work) const {
        QObject::connect(sender, signal, context, [guard = *this, work] { guard.run(work); });
    }

  private:
    void run(const std::function<void()> &work) const {
        try {
            work();
        } catch (const std::exception &e) {
            if (document)
                host::log(*document, std::string("FCD: the dialog: ") + e.what());
        }
    }
    QPointer<MeshDocument> document;
};

const int highest = 630; // of a dialog: fits the smallest screen that is common, with room for a panel

/// Gives the help texts of parameters their full height, which the host does not allow for.
void showWhole(const QWidget &parameters) {
    for (QLabel *label : parameters.findChildren<QLabel *>())
        if (label->wordWrap() && label->isVisible())
            label->setMinimumHeight(label->heightForWidth(label->width()));
}

QCheckBox *previewOf(const QWidget &content) {
    const QList<QCheckBox *> boxes = content.findChildren<QCheckBox *>(QString(), Qt::FindDirectChildrenOnly);
    const auto found =
        std::find_if(boxes.begin(), boxes.end(), [](const QCheckBox *box) { return box->text() == "Preview"; });
    return found == boxes.end() || (*found)->isHidden() ? nullptr : *found;
}

/// Moves a dialog onto the screen; with a preview, to the right edge, over the list of layers, to leave that visible.
void put(QDockWidget &dialog, const QRect &all) {
    QRect place = dialog.frameGeometry();
    // Qt's frame geometry may be out of date while the window manager works, and even be empty.
    place.setSize(place.size().expandedTo(dialog.size()));
    if (previewOf(*dialog.widget()))
        place.moveRight(all.right());
    place.moveLeft(std::max(all.left(), std::min(place.left(), all.right() - place.width())));
    place.moveTop(std::max(all.top(), std::min(place.top(), all.bottom() - place.height())));
    dialog.move(place.topLeft());
}

/// Sets size and position of a dialog that scrolls. \param least its least size \param rest size of all around the area
void fit(const Guard &guard, QDockWidget &dialog, QScrollArea &area, const QSize &least, const QSize &rest) {
    const QScreen *screen = QApplication::screens().value(0);
    if (!screen)
        return;
    const QRect all = screen->availableGeometry();
    const QSize wanted = (area.widget()->minimumSizeHint() + rest).expandedTo(least);
    const bool isHigh = wanted.height() > highest;
    const int bar = isHigh ? area.verticalScrollBar()->sizeHint().width() : 0;
    dialog.setMinimumSize(0, 0);
    dialog.resize(std::min(wanted.width() + bar, all.width()),
                  std::min(isHigh ? highest : wanted.height(), all.height()));
    put(dialog, all);
    // Texts may have more lines now than in the host's size; that is known after the layout.
    guard.later(&area, [guard, &dialog, &area, all] {
        showWhole(*area.widget());
        guard.later(&area, [&dialog, &area, all] {
            const int height = std::min(dialog.height() + area.verticalScrollBar()->maximum(), highest);
            dialog.resize(dialog.width(), height);
            put(dialog, all);
        });
    });
}

/// The same for the dialog of a host that lets its parameters scroll.
void fit(const Guard &guard, QDockWidget &dialog) {
    if (auto *area = dialog.widget()->findChild<QScrollArea *>()) {
        const auto again = [guard, &dialog, area] { fit(guard, dialog, *area, QSize(), dialog.size() - area->size()); };
        again();
        for (QPushButton *button : dialog.widget()->findChildren<QPushButton *>())
            if (button->text() == "Help")
                guard.when(button, &QPushButton::clicked, area, [guard, area, again] { guard.later(area, again); });
    }
}

/// Puts the parameters of a dialog into an area that scrolls.
void letScroll(const Guard &guard, QDockWidget &dialog) {
    QWidget *content = dialog.widget();
    auto *grid = content ? qobject_cast<QGridLayout *>(content->layout()) : nullptr;
    QLayoutItem *item = grid ? grid->itemAtPosition(1, 0) : nullptr;
    auto *parameters = item ? qobject_cast<QFrame *>(item->widget()) : nullptr;
    if (!parameters)
        return;
    const QSize first = dialog.size(), rest = first - parameters->size();
    grid->removeWidget(parameters);
    auto *area = new QScrollArea(content);
    area->setFrameShape(QFrame::NoFrame);
    area->setWidgetResizable(true);
    area->setWidget(parameters);
    grid->addWidget(area, 1, 0, 1, 2);
    grid->setRowStretch(1, 1);
    const auto again = [guard, &dialog, area, first, rest] { fit(guard, dialog, *area, first, rest); };
    again();
    // The host changes the size if Help is shown or hidden.
    for (QPushButton *button : content->findChildren<QPushButton *>(QString(), Qt::FindDirectChildrenOnly))
        guard.when(button, &QPushButton::clicked, area, [guard, area, again] { guard.later(area, again); });
}

/// Updates the lists of layers in a dialog when layers change: the host goes by the index when the dialog was opened.
void followLayers(const Guard &guard, QWidget &content, MeshDocument &document) {
    struct Layers {
        QStringList labels;
        std::vector<int> ids;
    };
    const auto present = [&document] {
        Layers layers;
        for (const MeshModel *layer : host::layers(document)) {
            layers.labels << layer->label();
            layers.ids.push_back(layer->id());
        }
        return layers;
    };
    const Layers shown = present();
    std::vector<QComboBox *> choosers;
    for (QComboBox *box : content.findChildren<QComboBox *>()) {
        QStringList items;
        for (int i = 0; i < box->count(); ++i)
            items << box->itemText(i);
        if (items == shown.labels)
            choosers.push_back(box);
    }
    guard.when(&document, &MeshDocument::meshSetChanged, &content,
               [&document, present, choosers, shown = std::make_shared<Layers>(shown)] {
                   const Layers layers = present();
                   const auto placeOf = [&layers](int id) {
                       return int(std::find(layers.ids.begin(), layers.ids.end(), id) - layers.ids.begin());
                   };
                   for (QComboBox *box : choosers) {
                       const int chosen = box->currentIndex(); // -1: there was no layer
                       int place = chosen < 0 ? layers.labels.size() : placeOf(shown->ids.at(std::size_t(chosen)));
                       if (place == layers.labels.size() && document.mm()) // it is gone
                           place = placeOf(document.mm()->id());
                       const QSignalBlocker quiet(box);
                       box->clear();
                       box->addItems(layers.labels);
                       box->setCurrentIndex(place);
                   }
                   *shown = layers;
               });
}

/// Makes the button Default open the dialog with defaults. (The host's restores its first, remembered, values.)
void letDefaultBeDefaults(const Guard &guard, QWidget &content, const std::function<void()> &openWithDefaults) {
    for (QPushButton *button : content.findChildren<QPushButton *>())
        if (button->text() == "Default")
            guard.when(button, &QPushButton::clicked, &content, [guard, &content, openWithDefaults] {
                if (QCheckBox *preview = previewOf(content))
                    preview->setChecked(false);          // gives the layer its shape back
                guard.later(&content, openWithDefaults); // later, since it deletes the button
            });
}

} // namespace

void prepareDialog(const QString &title, MeshDocument &document, const std::function<void()> &openWithDefaults) {
    const Guard guard(document);
    guard.later(&document, [guard, title, &document, openWithDefaults] {
        static const char *const prepared = "fcd_prepared";
        for (QWidget *window : QApplication::topLevelWidgets())
            for (QDockWidget *dialog : window->findChildren<QDockWidget *>()) {
                QWidget *content = dialog->widget();
                if (dialog->windowTitle() != title || !content || content->property(prepared).isValid())
                    continue;
                content->setProperty(prepared, true);
                if (host::dialogsFold)
                    fit(guard, *dialog);
                else
                    letScroll(guard, *dialog);
                followLayers(guard, *content, document);
                letDefaultBeDefaults(guard, *content, openWithDefaults);
            }
    });
}
