// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // before Qt

#include "fcd_layers.h"
#include "fcd_rest.h"
#include "fcd_window.h"

#include <vcg/complex/allocate.h>

#include <cstdint>
#include <string>

#include <QApplication>
#include <QDockWidget>
#include <QGridLayout>
#include <QPushButton>
#include <QScreen>
#include <QScrollArea>
#include <QScrollBar>
#include <QTimer>

void LastValues::recall(int filter, RichParameterList &list) const {
    const auto last = lists.find(filter);
    if (last == lists.end())
        return;
    for (const RichParameter &parameter : list)
        if (!host::isLayerParameter(parameter) && last->second.hasParameter(parameter.name()))
            list.setValue(parameter.name(), last->second.getParameterByName(parameter.name()).value());
}

int likelySource(const MeshModel &layer, int last) {
    if (last > 1) // an attribute or files
        return last;
    const CMeshO &mesh = layer.cm;
    const auto isSelected = [](const auto &element) { return !element.IsD() && element.IsS(); };
    const bool isAnySelected = std::any_of(mesh.vert.begin(), mesh.vert.end(), isSelected) ||
                               std::any_of(mesh.face.begin(), mesh.face.end(), isSelected);
    return isAnySelected && !mayHaveTags(layer) ? 1 : 0;
}

namespace {

const int highest = 630; // of a dialog: fits the smallest screen that is common, with room for a panel

/// Gives a dialog that scrolls its size, and a place on the screen. \param first its size as the host
/// made it \param rest that of what is around the area
void fit(QDockWidget &dialog, QScrollArea &area, const QSize &first, const QSize &rest) {
    const QScreen *screen = QApplication::screens().value(0);
    if (!screen)
        return;
    const QRect all = screen->availableGeometry();
    const QSize wanted = (area.widget()->minimumSizeHint() + rest).expandedTo(first);
    const bool isHigh = wanted.height() > highest;
    const int bar = isHigh ? area.verticalScrollBar()->sizeHint().width() : 0;
    dialog.setMinimumSize(0, 0);
    dialog.resize(std::min(wanted.width() + bar, all.width()),
                  std::min(isHigh ? highest : wanted.height(), all.height()));
    QRect place = dialog.frameGeometry();
    place.moveLeft(std::max(all.left(), std::min(place.left(), all.right() - place.width())));
    place.moveTop(std::max(all.top(), std::min(place.top(), all.bottom() - place.height())));
    dialog.move(place.topLeft());
}

/// Puts the parameters of a filter's dialog into an area that scrolls.
void letScroll(QDockWidget &dialog) {
    QWidget *content = dialog.widget();
    auto *grid = content ? qobject_cast<QGridLayout *>(content->layout()) : nullptr;
    QLayoutItem *item = grid ? grid->itemAtPosition(1, 0) : nullptr;
    auto *parameters = item ? qobject_cast<QFrame *>(item->widget()) : nullptr;
    if (!parameters || qobject_cast<QScrollArea *>(parameters))
        return;
    const QSize first = dialog.size(), rest = first - parameters->size();
    grid->removeWidget(parameters);
    auto *area = new QScrollArea(content);
    area->setFrameShape(QFrame::NoFrame);
    area->setWidgetResizable(true);
    area->setWidget(parameters);
    grid->addWidget(area, 1, 0, 1, 2);
    grid->setRowStretch(1, 1);
    fit(dialog, *area, first, rest);
    // The host gives it another size when Help comes or goes.
    const auto later = [&dialog, area, first, rest] {
        QTimer::singleShot(0, area, [&dialog, area, first, rest] { fit(dialog, *area, first, rest); });
    };
    for (QPushButton *button : content->findChildren<QPushButton *>(QString(), Qt::FindDirectChildrenOnly))
        QObject::connect(button, &QPushButton::clicked, area, later);
}

} // namespace

void letDialogScroll(const QString &title) {
    if (host::dialogsFold)
        return;
    QTimer::singleShot(0, qApp, [title] {
        for (QWidget *window : QApplication::topLevelWidgets())
            for (QDockWidget *dialog : window->findChildren<QDockWidget *>())
                if (dialog->windowTitle() == title)
                    letScroll(*dialog);
    });
}

// --- results ---

namespace {

const char *const resultName = "fcd_result";

/// What a result is made from, and how it was then.
struct Result {
    int source = 0;
    std::uint64_t shape = 0;
    QString label;
};

const Result *resultOf(const MeshModel &layer) { return host::meshAttribute<Result>(layer.cm, resultName); }

} // namespace

void showResult(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results) {
    for (MeshModel *result : results) {
        host::madeMeshAttribute<Result>(result->cm, resultName) = {source.id(), shapeOf(result->cm), result->label()};
        host::setVisible(*result, result == results.back());
    }
    host::setVisible(source, false);
    host::showChanges(document);
}

MeshModel &sourceOf(MeshDocument &document, MeshModel &layer) {
    const Result *result = resultOf(layer);
    if (!result || result->shape != shapeOf(layer.cm))
        return layer;
    for (const MeshModel *other : host::layers(document))
        if (other->id() == result->source && other->cm.vn > 0)
            return const_cast<MeshModel &>(*other);
    return layer;
}

std::vector<MeshModel *> earlierResults(MeshDocument &document, const MeshModel &source) {
    std::vector<MeshModel *> results;
    for (const MeshModel *layer : host::layers(document)) {
        const Result *result = resultOf(*layer);
        if (result && result->source == source.id() && layer->label() == result->label &&
            shapeOf(layer->cm) == result->shape)
            results.push_back(const_cast<MeshModel *>(layer));
    }
    return results;
}
