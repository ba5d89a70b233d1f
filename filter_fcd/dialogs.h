// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DIALOGS_H
#define FCD_DIALOGS_H

#include <layer_fcd/meshlab_host.h>

#include <functional>
#include <map>

/// \file
/// What is done with the dialogs of MeshLab's window, for a person and not for a script (see host::inWindow).

/// What the dialogs said when their filters ran, while the program runs.
class LastValues {
  public:
    /// \param meant the layer that \p filter is about
    void keep(int filter, const RichParameterList &used, const MeshDocument &document, const MeshModel &meant);
    /// Gives \p list, of a filter, the values that it was last used with. Of layers, only the one that the handles move
    /// like is among them, while there is one of its name.
    void recall(int filter, RichParameterList &list, const MeshDocument &document) const;
    void forget(int filter) { lists.erase(filter); }

  private:
    std::map<int, RichParameterList> lists;
    std::map<int, QString> handleLayers; ///< their names, empty where they were not used
};

/// Where the parameter "handles" of \p layer most likely comes from: its tags, or else its selection. \p last is what
/// was chosen last.
int likelySource(const MeshModel &layer, int last);

/// Prepares the dialog of the filter with \p title once the host has built it. It scrolls, where the host's does not,
/// so that its buttons stay on the screen; what it lists as layers follows these; and its button Default opens it anew
/// by \p openWithDefaults.
void prepareDialog(const QString &title, MeshDocument &document, const std::function<void()> &openWithDefaults);

#endif
