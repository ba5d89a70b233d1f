// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h> // before Qt

#include "edit_fcd/kit/tool_window.h"
#include "edit_fcd/view/trace.h"

#include <layer_fcd/layer_labels.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <QCoreApplication>
#include <QFileDialog>
#include <QFileInfo>
#include <QMainWindow>
#include <QMdiArea>
#include <QMdiSubWindow>
#include <QMenu>
#include <QMessageBox>
#include <QStringList>
#include <QStyle>
#include <QTimer>
#include <QToolButton>

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

std::optional<double> typedNumber(const QString &text) {
    const std::string word = text.trimmed().replace(',', '.').toStdString();
    double number = 0;
    if (!vcg::fcd::detail::ToNumber(word.data(), word.data() + word.size(), number) || !std::isfinite(number))
        return {};
    return number;
}

NumberBox *numberBox(const QString &name, const QString &tip, double least, double most, int decimals, double value) {
    auto *box = named(new NumberBox, name, tip);
    box->setDecimals(decimals);
    box->setRange(least, most);
    box->setValue(value);
    return box;
}

/// An area that scrolls vertically only.
static QScrollArea *scrolled(QWidget *content) {
    auto *area = named(new QScrollArea, "", "");
    area->setWidget(content);
    area->setWidgetResizable(true);
    area->setFrameShape(QFrame::NoFrame);
    area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    return area;
}

ToolPanel::ToolPanel(const QString &title, const char *name, int margin, int spacing, QWidget *parent)
    : QDockWidget(title, parent), head(new QVBoxLayout(new QWidget)), content(new QVBoxLayout(new QWidget)),
      scroll(scrolled(content->parentWidget())), text(new QLabel) {
    setObjectName(name);
    setFeatures(QDockWidget::DockWidgetMovable | QDockWidget::DockWidgetFloatable);
    for (QVBoxLayout *each : {head, content}) {
        each->setContentsMargins(6, margin, 6, margin);
        each->setSpacing(spacing);
    }
    auto *all = new QWidget;
    auto *column = new QVBoxLayout(all);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    column->addWidget(head->parentWidget());
    column->addWidget(scroll, 1);
    setWidget(all);
    text->setWordWrap(true);
    text->setAlignment(Qt::AlignTop | Qt::AlignLeft);
}

void ToolPanel::finish(int height) {
    QScrollArea *state = scrolled(text);
    state->setObjectName("state");
    state->setFixedHeight(height);
    head->addWidget(state);
    content->addStretch();
    scroll->setMinimumWidth(content->parentWidget()->minimumSizeHint().width() +
                            scroll->style()->pixelMetric(QStyle::PM_ScrollBarExtent));
    tracePlaces(*this);
}

void ToolPanel::showState(const QString &said) {
    if (said == text->text())
        return;
    trace("says: %s", qPrintable(said));
    text->setText(said);
    const QWidget &room = *text->parentWidget();
    trace("text: %d of %d pixels", text->heightForWidth(room.width()), room.height());
}

QButtonGroup *addButtons(QBoxLayout &row, QWidget &panel, const std::vector<std::array<QString, 3>> &namesTextsTips) {
    auto *group = new QButtonGroup(&panel);
    for (const auto &[name, text, tip] : namesTextsTips) {
        auto *made = named(new QToolButton, name, tip);
        made->setText(text);
        made->setCheckable(true);
        group->addButton(made, group->buttons().size());
        row.addWidget(made);
    }
    row.addStretch();
    group->button(0)->setChecked(true);
    return group;
}

void connectSlider(QSlider &slider, const std::function<void()> &begins, const std::function<void(int)> &changes) {
    QObject::connect(&slider, &QSlider::sliderPressed, begins);
    QObject::connect(&slider, &QSlider::valueChanged, [&slider, begins, changes](int value) {
        if (!slider.isSliderDown())
            begins();
        changes(value);
    });
}

QPushButton *sessionButton(const QString &what, const std::function<void(bool load)> &chosen) {
    auto *button = named(new QPushButton("Session"), "session",
                         "A file (.fcd) with what no mesh file keeps of the layer: " + what);
    auto *files = new QMenu(button);
    QObject::connect(files->addAction("&Save session ..."), &QAction::triggered, [chosen] { chosen(false); });
    QObject::connect(files->addAction("&Load session ..."), &QAction::triggered, [chosen] { chosen(true); });
    button->setMenu(files);
    return button;
}
