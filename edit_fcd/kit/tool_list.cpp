// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h> // before Qt

#include "edit_fcd/kit/tool_list.h"

#include "edit_fcd/kit/tool_window.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <QResizeEvent>
#include <QScrollArea>

std::optional<double> typedNumber(const QString &text) {
    const std::string word = text.trimmed().replace(',', '.').toStdString();
    double number = 0;
    if (!vcg::fcd::detail::ToNumber(word.data(), word.data() + word.size(), number) || !std::isfinite(number))
        return {};
    return number;
}

PanelState::PanelState(int height) : least(height) {
    setObjectName("state");
    setWordWrap(true);
    setMinimumHeight(least);
    setAlignment(Qt::AlignTop | Qt::AlignLeft);
}

void PanelState::say(const QString &said) {
    if (std::getenv("FCD_TRACE") && said != text())
        std::fprintf(stderr, "FCD trace: says: %s\n", qPrintable(said));
    setText(said);
    if (isVisible())
        grow();
}

void PanelState::resizeEvent(QResizeEvent *event) {
    QLabel::resizeEvent(event);
    if (event->size().width() == event->oldSize().width())
        return;
    setMinimumHeight(least); // a wider one needs less
    grow();
}

void PanelState::grow() {
    const int height = heightForWidth(width());
    if (height <= minimumHeight())
        return;
    setMinimumHeight(height);
    tracePlaces(*parentWidget());
}

void connectSlider(QSlider &slider, const std::function<void()> &begins, const std::function<void(int)> &changes) {
    QObject::connect(&slider, &QSlider::sliderPressed, begins);
    QObject::connect(&slider, &QSlider::valueChanged, [&slider, begins, changes](int value) {
        if (!slider.isSliderDown())
            begins();
        changes(value);
    });
}

void setScrolled(QDockWidget &panel, QWidget &content) {
    auto *scroll = new QScrollArea;
    scroll->setWidget(&content);
    scroll->setWidgetResizable(true);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    scroll->setMinimumWidth(content.minimumSizeHint().width() + 20);
    scroll->setFocusPolicy(Qt::NoFocus);
    panel.setWidget(scroll);
}
