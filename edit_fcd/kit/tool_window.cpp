// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/kit/tool_window.h"

#include "edit_fcd/view/trace.h"

#include <layer_fcd/layer_labels.h>

#include <algorithm>

#include <QCoreApplication>
#include <QFileDialog>
#include <QFileInfo>
#include <QMainWindow>
#include <QMdiArea>
#include <QMdiSubWindow>
#include <QMessageBox>
#include <QRegularExpression>
#include <QStringList>
#include <QTimer>

Camera viewNow() {
    double place[16], projection[16];
    int port[4];
    glGetDoublev(GL_MODELVIEW_MATRIX, place);
    glGetDoublev(GL_PROJECTION_MATRIX, projection);
    glGetIntegerv(GL_VIEWPORT, port);
    Camera seen;
    seen.toClip = Eigen::Map<Eigen::Matrix4d>(projection) * Eigen::Map<Eigen::Matrix4d>(place);
    seen.fromClip = seen.toClip.inverse();
    seen.width = std::max(1, port[2]);
    seen.height = std::max(1, port[3]);
    return seen;
}

Eigen::Vector3d windowOf(const GLArea &view, const Camera &seen, const QPointF &place) {
    const double ratio = view.devicePixelRatioF();
    return {(place.x() + 0.5) * ratio, seen.height - (place.y() + 0.5) * ratio, 0};
}

void toHost(GLArea &view, QEvent *event) {
    view.suspendedEditor = true;
    QCoreApplication::sendEvent(&view, event);
    view.suspendedEditor = false;
}

void toCamera(GLArea &view, QMouseEvent *event) {
    const auto asLeft = [](Qt::MouseButtons buttons) {
        return (buttons & Qt::RightButton) != 0 ? (buttons & ~Qt::RightButton) | Qt::LeftButton : buttons;
    };
    QMouseEvent copy(event->type(), event->localPos(), event->windowPos(), event->screenPos(),
                     event->button() == Qt::RightButton ? Qt::LeftButton : event->button(), asLeft(event->buttons()),
                     event->modifiers() & ~Qt::AltModifier);
    toHost(view, &copy);
}

void dockPanel(GLArea &view, QDockWidget &panel) {
    if (auto *window = qobject_cast<QMainWindow *>(view.window()))
        window->addDockWidget(Qt::LeftDockWidgetArea, &panel);
    panel.show();
    QMdiArea *area = nullptr;
    QMdiSubWindow *own = nullptr;
    for (QWidget *each = &view; each && !area; each = each->parentWidget()) {
        own = own ? own : qobject_cast<QMdiSubWindow *>(each);
        area = qobject_cast<QMdiArea *>(each);
    }
    if (area && own)
        QObject::connect(area, &QMdiArea::subWindowActivated, &panel,
                         [area, own, &panel] { panel.setVisible(area->currentSubWindow() == own); });
}

/// The endings in a text as "Tables (*.csv *.txt)".
static QStringList endingsOf(const QString &kinds) {
    static const QRegularExpression ending("\\*(\\.\\w+)");
    QStringList endings;
    for (auto each = ending.globalMatch(kinds); each.hasNext();)
        endings << each.next().captured(1);
    return endings;
}

QString fileToSave(GLArea &view, const QString &title, const QString &kinds, const MeshModel &layer) {
    const QStringList endings = endingsOf(kinds);
    const QString offered = QFileInfo(layer.fullName()).dir().filePath(nameOf(layer) + endings.first());
    QString file = offered, kind;
    for (;;) { // until the name with its ending is confirmed
        file =
            QFileDialog::getSaveFileName(view.window(), title, file, kinds, &kind, QFileDialog::DontConfirmOverwrite);
        const bool isNamed = std::any_of(endings.begin(), endings.end(),
                                         [&](const QString &each) { return file.endsWith(each, Qt::CaseInsensitive); });
        const QString ending = endingsOf(kind.isEmpty() ? kinds : kind).first();
        if (file == offered) // not all systems' dialogs change the ending with the kind
            file = offered.chopped(endings.first().size()) + ending;
        else if (!file.isEmpty() && !isNamed)
            file += ending;
        if (!QFileInfo::exists(file) ||
            QMessageBox::question(view.window(), title, file + " exists already. Replace it?",
                                  QMessageBox::Yes | QMessageBox::No, QMessageBox::No) == QMessageBox::Yes)
            return file;
    }
}

void tracePlaces(QWidget &panel) {
    if (!qEnvironmentVariableIsSet("FCD_TRACE"))
        return;
    QTimer::singleShot(200, &panel, [&panel] {
        for (const QWidget *each : panel.findChildren<QWidget *>())
            if (!each->objectName().isEmpty() && !each->objectName().startsWith("qt_") && each->isVisible()) {
                const QPoint place = each->mapToGlobal(QPoint(0, 0));
                trace("place: %s %d %d %d %d", qPrintable(each->objectName()), place.x(), place.y(), each->width(),
                      each->height());
            }
    });
}
