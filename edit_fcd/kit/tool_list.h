// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TOOL_LIST_H
#define FCD_TOOL_LIST_H

#include <functional>
#include <optional>
#include <type_traits>

#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QPushButton>
#include <QRegularExpression>
#include <QScrollArea>
#include <QSlider>
#include <QSpinBox>
#include <QString>
#include <QVBoxLayout>

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

/// A field for a whole number: one with decimals is what it was before. (QSpinBox makes 15 of 1,5.)
class CountBox : public QSpinBox {
  public:
    CountBox() { setKeyboardTracking(false); }
    QValidator::State validate(QString &input, int &place) const override {
        return input.contains(QRegularExpression("[.,]")) ? QValidator::Intermediate : QSpinBox::validate(input, place);
    }
    void fixup(QString &) const override {}
};

/// Gives a widget of a panel its name and its tip. Keys stay with the view, except those typed into it.
template <class Widget>
Widget *named(Widget *widget, const QString &name, const QString &tip) {
    widget->setObjectName(name);
    widget->setToolTip(tip);
    if (!std::is_base_of<QAbstractSpinBox, Widget>::value && !std::is_same<QLineEdit, Widget>::value)
        widget->setFocusPolicy(Qt::NoFocus);
    return widget;
}

/// The panel of a tool: a head that stays, which ends with what is said of the tool's state, and below it a content
/// that is scrolled up and down alone.
class ToolPanel : public QDockWidget {
  public:
    /// \param margin above and below, \param spacing between things: pixels
    ToolPanel(const QString &title, const char *name, int margin, int spacing, QWidget *parent);
    /// What is said has a height of its own, so that nothing moves under the mouse while the text changes; a longer
    /// text is scrolled.
    void showState(const QString &said);

  protected:
    /// Once head and content are there. \param height of what is said of the state, pixels
    void finish(int height);

    QVBoxLayout *head, *content;
    QScrollArea *scroll; ///< of the content

  private:
    QLabel *text;
};

/// Calls \p begins before a slider changes what it is for, once for each way of it, and \p changes with each value.
void connectSlider(QSlider &slider, const std::function<void()> &begins, const std::function<void(int)> &changes);

/// A button with a menu: what is known of a layer is saved to a file, or loaded. \param what that is, for the tip
QPushButton *sessionButton(const QString &what, const std::function<void(bool load)> &chosen);

#endif
