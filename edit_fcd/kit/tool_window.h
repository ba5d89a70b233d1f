// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TOOL_WINDOW_H
#define FCD_TOOL_WINDOW_H

#include "edit_fcd/view/camera.h" // before Qt

#include <layer_fcd/edit_host.h>

#include <QDockWidget>
#include <QString>

/// \file
/// The tools' dealings with the host's window.

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
/// one of the chosen kind. \param kinds as of QFileDialog \param layer gives folder and name of the offered file
/// \return empty if it was cancelled
QString fileToSave(GLArea &view, const QString &title, const QString &kinds, const MeshModel &layer);

/// Traces the places of a panel's widgets, for tests that drive it by a script.
void tracePlaces(QWidget &panel);

#endif
