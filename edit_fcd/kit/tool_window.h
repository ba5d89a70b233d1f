// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TOOL_WINDOW_H
#define FCD_TOOL_WINDOW_H

#include "edit_fcd/view/camera.h" // before Qt

#include <layer_fcd/edit_host.h>

#include <QDockWidget>
#include <QString>

/// \file
/// What the tools have to do with the window that they are in.

/// How the world is seen. \pre the context of the view is current, and has the transformation of the world
Camera viewNow();
/// Where the middle of a pixel of the view is, in pixels of the device, y up; depth 0.
Eigen::Vector3d windowOf(const GLArea &view, const Camera &seen, const QPointF &place);

/// Hands an event on to the view, past the tool.
void toHost(GLArea &view, QEvent *event);
/// Hands an event of the mouse on to the camera, as one of the left button where it is of the right one.
void toCamera(GLArea &view, QMouseEvent *event);

/// Shows a panel at the left of the window of a view, as long as the view's document is seen: its buttons act on that.
void dockPanel(GLArea &view, QDockWidget &panel);

/// Asks for a file to write. A name that has the ending of no kind gets the first one of the kind that was chosen.
/// Where the file exists, asks whether to replace it. \param kinds as QFileDialog takes them \return empty where it is
/// cancelled
QString fileToSave(GLArea &view, const QString &title, const QString &kinds);

/// Tells where things of a panel are, for tests that drive it by a script.
void tracePlaces(QWidget &panel);

#endif
