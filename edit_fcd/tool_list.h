// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TOOL_LIST_H
#define FCD_TOOL_LIST_H

#include <functional>
#include <initializer_list>
#include <utility>

#include <QDockWidget>
#include <QSlider>
#include <QTableWidget>

/// \file
/// What the panels of the tools, and the lists in them, have in common.

/// Gives a list its looks: a row is selected at a click and edited at a double one. \param stretched the column that
/// takes what is left by those of \p widths (column, pixels)
void setUpList(QTableWidget &list, int stretched, std::initializer_list<std::pair<int, int>> widths);

/// Calls \p begins before a slider changes what it is for, once for each way of it, and \p changes with each value.
void connectSlider(QSlider &slider, const std::function<void()> &begins, const std::function<void(int)> &changes);

/// Puts what a panel shows into an area that scrolls up and down alone.
void setScrolled(QDockWidget &panel, QWidget &content);

#endif
