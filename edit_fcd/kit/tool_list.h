// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TOOL_LIST_H
#define FCD_TOOL_LIST_H

#include <array>
#include <functional>
#include <optional>
#include <type_traits>
#include <vector>

#include <QButtonGroup>
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
/// Parts of the tools' panels.

/// A typed number, with a decimal point or comma; none if it is no number.
std::optional<double> typedNumber(const QString &text);

/// A field for a number, with a decimal point or comma.
class NumberBox : public QDoubleSpinBox {
  public:
    NumberBox() { setLocale(QLocale::c()); }
    QValidator::State validate(QString &input, int &place) const override {
        return QDoubleSpinBox::validate(input.replace(',', '.'), place);
    }
};

/// A field for a whole number. If decimals are typed, it keeps its value. (QSpinBox makes 15 of 1,5.)
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

/// The panel of a tool: a fixed head, which ends with the tool's state, and below it a content that scrolls vertically.
class ToolPanel : public QDockWidget {
  public:
    /// \param margin above and below \param spacing between widgets, both in pixels
    ToolPanel(const QString &title, const char *name, int margin, int spacing, QWidget *parent);
    /// Shows the state, in a fixed height, so that nothing moves under the mouse. A longer text scrolls.
    void showState(const QString &said);

  protected:
    /// Call once head and content are complete. \param height of the state's text, pixels
    void finish(int height);

    QVBoxLayout *head, *content;
    QScrollArea *scroll; ///< of the content

  private:
    QLabel *text;
};

/// Adds a row of buttons of which one is pressed; the first at the begin. Each is numbered by its place.
QButtonGroup *addButtons(QBoxLayout &row, QWidget &panel, const std::vector<std::array<QString, 3>> &namesTextsTips);

/// Calls \p begins once before a slider is moved, and \p changes with each value.
void connectSlider(QSlider &slider, const std::function<void()> &begins, const std::function<void(int)> &changes);

/// A button with a menu, to save or load the state of a layer. \param what its contents, for the tip
QPushButton *sessionButton(const QString &what, const std::function<void(bool load)> &chosen);

#endif
