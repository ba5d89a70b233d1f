// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_EXPORT_DIALOG_H
#define FCD_BEND_EXPORT_DIALOG_H

#include "edit_fcd/bend/model/animation_export.h" // before Qt

#include <QComboBox>
#include <QDialog>
#include <QDoubleSpinBox>

/// Asks how to export an animation; for a file, the tool then asks for its name.
class BendExportDialog : public QDialog {
  public:
    /// \param first,last times of the first and last key frame, seconds
    BendExportDialog(double first, double last, QWidget *parent);
    /// The answers, without the file. The whole range is first and last, to the bit.
    AnimationExport asked() const;

  private:
    const double first, last;
    QDoubleSpinBox *rate, *from, *to;
    QComboBox *what, *shapes;
};

#endif
