// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TOOL_WINDOW_H
#define FCD_TOOL_WINDOW_H

#include "edit_fcd/view/camera.h" // before Qt

#include <layer_fcd/edit_host.h>

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
/// The tools' dealings with the host's window, and parts of their panels.

/// The present camera. \pre the context of the view is current, and has the transformation of the world
Camera viewNow();
/// The middle of a pixel of the view, in pixels of the device, y up; depth 0.
Eigen::Vector3d windowOf(const GLArea &view, const Camera &seen, const QPointF &place);

/// Passes an event to the view, past the tool.
void toHost(GLArea &view, QEvent *event);
/// Passes an event of the mouse to the camera; the right button counts as the left one.
void toCamera(GLArea &view, QMouseEvent *event);

/// Docks a panel at the left of a view's window. It is shown while the view's document is, on which its buttons act.
void dockPanel(GLArea &view, QDockWidget &panel);

/// Asks for a file to write, and whether to replace it if it exists. A name with the ending of no kind gets the first
/// one of the chosen kind. \param kinds as in QFileDialog \param layer gives folder and name of the offered file
/// \return empty if it was cancelled
QString fileToSave(GLArea &view, const QString &title, const QString &kinds, const MeshModel &layer);

/// Traces the places of a panel's widgets, for tests that drive it by a script.
void tracePlaces(QWidget &panel);

// --- parts of the tools' panels ---

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

/// Makes such a field, with its name and tip.
NumberBox *numberBox(const QString &name, const QString &tip, double least, double most, int decimals, double value);

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
