// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TOOL_LIST_H
#define FCD_TOOL_LIST_H

#include <functional>
#include <optional>

#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLocale>
#include <QSlider>
#include <QString>

/// \file
/// What the panels of the tools have in common.

/// A number that a person has typed, with a point or a comma before its decimals; none where it is not one.
std::optional<double> typedNumber(const QString &text);

/// A field for a number that takes a comma before its decimals as a point.
class NumberBox : public QDoubleSpinBox {
  public:
    NumberBox() { setLocale(QLocale::c()); } // whose comma would stand between thousands
    QValidator::State validate(QString &input, int &place) const override {
        return QDoubleSpinBox::validate(input.replace(',', '.'), place);
    }
};

/// What a panel says of its tool's state. It keeps the height of the longest text that it had, so that what stands
/// below it does not move under the mouse while the text changes.
class PanelState : public QLabel {
  public:
    /// \param height of each text at least, pixels
    explicit PanelState(int height);
    void say(const QString &said);

  protected:
    void resizeEvent(QResizeEvent *event) override;

  private:
    void grow();
    int least;
};

/// Calls \p begins before a slider changes what it is for, once for each way of it, and \p changes with each value.
void connectSlider(QSlider &slider, const std::function<void()> &begins, const std::function<void(int)> &changes);

/// Puts what a panel shows into an area that scrolls up and down alone.
void setScrolled(QDockWidget &panel, QWidget &content);

#endif
