// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef EDIT_FCD_H
#define EDIT_FCD_H

#include <layer_fcd/edit_host.h>

/// Fast Centroidal Deformation by hand: the plugin with the tools "FCD: Bend" and "FCD: Fit".
class EditFcd : public HostEditPlugin {
    Q_OBJECT
    FCD_EDIT_METADATA

  public:
    EditFcd();

    QString help(const QAction *action) const override;
    HostEditTool *makeTool(QAction *action) const override;

  private:
    QAction *bend, *fit;
};

#endif
