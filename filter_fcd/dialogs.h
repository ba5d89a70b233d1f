// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DIALOGS_H
#define FCD_DIALOGS_H

#include <layer_fcd/meshlab_host.h>

#include <functional>
#include <map>

/// \file
/// Improves the dialogs of MeshLab's window (not for scripts; see host::inWindow).

/// Remembers the parameters that filters last ran with, while the program runs.
class LastValues {
  public:
    /// \param meant the layer that \p filter ran on
    void keep(int filter, const RichParameterList &used, const MeshDocument &document, const MeshModel &meant);
    /// Sets \p list, of a filter, to its last values. Of layers, only handleLayer, if there is a layer of its name.
    void recall(int filter, RichParameterList &list, const MeshDocument &document) const;
    void forget(int filter) { lists.erase(filter); }

  private:
    std::map<int, RichParameterList> lists;
    std::map<int, QString> handleLayers; ///< their names; empty: not used
};

/// The default of the parameter "handles" for \p layer: its tags, or else its selection. \param last the last choice
int likelySource(const MeshModel &layer, int last);

/// Improves the dialog of the filter with \p title once the host has built it: it scrolls (if the host's does not), so
/// that its buttons stay on the screen; its lists of layers are updated; and its button Default calls
/// \p openWithDefaults.
void prepareDialog(const QString &title, MeshDocument &document, const std::function<void()> &openWithDefaults);

#endif
