// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_LINE_BOX_H
#define FCD_BEND_LINE_BOX_H

#include <layer_fcd/parameters.h> // before Qt

#include <utility>
#include <vector>

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLineEdit>
#include <QWidget>

/// The part of the panel for the line that a layer is straightened along.
class BendLineBox : public QWidget {
    Q_OBJECT

  public:
    enum Command { Load, Save, Clear, Straighten };
    using Layers = std::vector<std::pair<int, QString>>; ///< numbers and names

    explicit BendLineBox(QWidget *parent = nullptr);
    /// Offers layers that are lines; keeps the chosen ones.
    void showLayers(const Layers &layers);
    int lineLayer() const { return source->currentData().toInt(); }   ///< -1: the line is drawn
    int targetLayer() const { return target->currentData().toInt(); } ///< -1: none
    bool isMiddle() const { return middle->isChecked(); }
    /// All other parameters, in the host's precision. \throw vcg::fcd::Error a direction that cannot be read
    StraightenMeshParam param() const;

  signals:
    void command(int which);
    void changed();

  private:
    void showWhatCounts();

    QComboBox *source, *shape, *target;
    QCheckBox *middle, *reverse, *untwist;
    QDoubleSpinBox *angle, *length;
    QLineEdit *direction, *towards; ///< three numbers each
    Layers shown;
};

#endif
