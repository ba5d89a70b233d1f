// SPDX-License-Identifier: GPL-3.0-or-later
#include "tool_list.h"

#include <QHeaderView>
#include <QScrollArea>

void setUpList(QTableWidget &list, int stretched, std::initializer_list<std::pair<int, int>> widths) {
    list.verticalHeader()->hide();
    list.verticalHeader()->setDefaultSectionSize(22);
    list.setSelectionBehavior(QTableWidget::SelectRows);
    list.setSelectionMode(QTableWidget::SingleSelection);
    list.setEditTriggers(QTableWidget::DoubleClicked);
    list.setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    QHeaderView &header = *list.horizontalHeader();
    header.setMinimumSectionSize(16);
    header.setSectionResizeMode(stretched, QHeaderView::Stretch);
    for (const auto &[column, width] : widths) {
        header.setSectionResizeMode(column, QHeaderView::Fixed);
        list.setColumnWidth(column, width);
    }
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
