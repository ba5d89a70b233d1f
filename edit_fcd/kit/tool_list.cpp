// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h> // before Qt

#include "edit_fcd/kit/tool_list.h"

#include "edit_fcd/view/trace.h"

#include <cmath>
#include <string>

#include <QMenu>
#include <QStyle>
#include <QVBoxLayout>

std::optional<double> typedNumber(const QString &text) {
    const std::string word = text.trimmed().replace(',', '.').toStdString();
    double number = 0;
    if (!vcg::fcd::detail::ToNumber(word.data(), word.data() + word.size(), number) || !std::isfinite(number))
        return {};
    return number;
}

PanelState::PanelState(int height) : text(new QLabel) {
    setObjectName("state");
    text->setWordWrap(true);
    text->setAlignment(Qt::AlignTop | Qt::AlignLeft);
    setWidget(text);
    setWidgetResizable(true);
    setFrameShape(QFrame::NoFrame);
    setFocusPolicy(Qt::NoFocus);
    setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    setFixedHeight(height);
}

void PanelState::say(const QString &said) {
    if (said == text->text())
        return;
    trace("says: %s", qPrintable(said));
    text->setText(said);
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

QScrollArea *setScrolled(QDockWidget &panel, QWidget &head, QWidget &content) {
    auto *scroll = new QScrollArea;
    scroll->setWidget(&content);
    scroll->setWidgetResizable(true);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    scroll->setMinimumWidth(content.minimumSizeHint().width() +
                            scroll->style()->pixelMetric(QStyle::PM_ScrollBarExtent));
    scroll->setFocusPolicy(Qt::NoFocus);
    scroll->setFrameShape(QFrame::NoFrame);
    auto *all = new QWidget;
    auto *column = new QVBoxLayout(all);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    column->addWidget(&head);
    column->addWidget(scroll, 1);
    panel.setWidget(all);
    return scroll;
}
