// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h> // before Qt

#include "edit_fcd/kit/tool_list.h"

#include "edit_fcd/kit/tool_window.h"
#include "edit_fcd/view/trace.h"

#include <cmath>
#include <string>

#include <QMenu>
#include <QStyle>
#include <QToolButton>

std::optional<double> typedNumber(const QString &text) {
    const std::string word = text.trimmed().replace(',', '.').toStdString();
    double number = 0;
    if (!vcg::fcd::detail::ToNumber(word.data(), word.data() + word.size(), number) || !std::isfinite(number))
        return {};
    return number;
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
