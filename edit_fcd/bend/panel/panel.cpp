// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/panel.h"

#include "edit_fcd/view/colors.h"

#include <layer_fcd/bend_state.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <QFormLayout>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QScreen>
#include <QSettings>
#include <QWindow>

const char *const brushSetting = "fcd/bend/brush", *const radiusSetting = "fcd/bend/radius";

BendPanel::BendPanel(QWidget *parent) : ToolPanel("FCD: Bend", "fcdBendPanel", 2, 3, parent) {
    addModes(*head);
    marking = new QWidget;
    addMarking(*marking);
    content->addWidget(marking);
    lineBox = new BendLineBox;
    content->addWidget(lineBox);
    list = new BendHandleList;
    content->addWidget(list);
    poseBox = new BendPoseBox;
    moreOptions = new QWidget;
    addCommands(*content);
    content->addWidget(poseBox);
    addMore(*content);
    addFolds(*head);
    finish(62); // four lines; the width is that of all
    lineBox->hide();
    showParts();
    connectOptions();
}

void BendPanel::addModes(QBoxLayout &column) {
    auto *row = new QHBoxLayout;
    row->setSpacing(1); // one choice, no wider than the panel
    std::vector<std::array<QString, 3>> buttons;
    const std::pair<const char *, const char *> textsAndTips[] = {
        // in the order of Mode, and of BendAction
        {"Drag", "Drag a point of a limb: the limb turns at its joint so that the point follows. Drag any other point, "
                 "or a handle, to pull it"},
        {"Pull", "Drag a handle, or a point of the surface, to pull it"},
        {"Brush", "Mark with a brush; size on the wheel"},
        {"Box", "Mark all in a rectangle"},
        {"Lasso", "Mark all in a polygon: click its corners, double-click the last"},
        {"Straighten", "Straighten the layer along a line, or bend it along one: click points, or choose a layer"}};
    for (const auto &[text, tip] : textsAndTips) {
        const int which = int(buttons.size());
        buttons.push_back({QString("mode%1").arg(which), text, bendActions().withKeys(tip, which)});
    }
    modes = addButtons(*row, *this, buttons);
    column.addLayout(row);
}

void BendPanel::addMarking(QWidget &place) {
    auto *form = new QFormLayout(&place);
    form->setContentsMargins(0, 0, 0, 0);
    form->setVerticalSpacing(2);
    auto *row = new QHBoxLayout;
    row->setSpacing(3);
    role = named(new QComboBox, "role", "Marks become this (F, U, H, O)");
    role->addItems({"Fixed", "Free", "Handle", "Ignore"});
    role->setCurrentIndex(Handle);
    role->setMaximumWidth(78);
    number = named(new CountBox, "number",
                   bendActions().withKeys("Number of the handle; the next one", BendAction::NextHandle));
    number->setRange(2, 1000000);
    number->setMaximumWidth(44); // keeps the panel narrow
    through = named(new QCheckBox("through the mesh"), "through",
                    bendActions().withKeys("Also what is hidden", BendAction::Through));
    row->addWidget(role);
    row->addWidget(number);
    row->addWidget(through);
    form->addRow("Mark", row);
    brushPixels = named(new CountBox, "brush", "How far the brush marks around the mouse (wheel)");
    brushPixels->setRange(2, 500);
    brushPixels->setValue(QSettings().value(brushSetting, 20).toInt());
    brushPixels->setSuffix(" px");
    radiusPercent =
        numberBox("reach",
                  "How far from a handle the surface bends while nothing is fixed, in percent of the diagonal; "
                  "a fifth of it stays free around marks (wheel while dragging)",
                  0.5, 400, 2, QSettings().value(radiusSetting, 100 * usualRadius).toDouble());
    radiusPercent->setSuffix(" %");
    auto *sizes = new QHBoxLayout;
    sizes->addWidget(brushPixels);
    sizes->addWidget(new QLabel("Reach"));
    sizes->addWidget(radiusPercent);
    form->addRow("Brush", sizes);
    auto *frame = new QHBoxLayout;
    mirrorAxis = named(new QComboBox, "mirror", "Marks and moves on both sides of the middle of the layer");
    mirrorAxis->addItems({"none", "x", "y", "z"});
    axesChoice = named(new QComboBox, "axes",
                       "What the gizmo and X, Y, Z move along and turn about: the axes of the world, of the layer, "
                       "of the view, or of the surface under the handle (z is its normal)");
    axesChoice->addItems({"World", "Layer", "View", "Surface"});
    frame->addWidget(mirrorAxis);
    frame->addWidget(new QLabel("Axes"));
    frame->addWidget(axesChoice);
    form->addRow("Symmetry", frame);
    auto *poseRow = new QHBoxLayout;
    poseSlider = named(new QSlider(Qt::Horizontal), "pose", "How much of the motions you see and apply");
    poseSlider->setRange(0, 200);
    poseSlider->setValue(100);
    poseLabel = new QLabel("100 %");
    poseRow->addWidget(poseSlider);
    poseRow->addWidget(poseLabel);
    form->addRow("Pose", poseRow);
    auto *stretched = new QHBoxLayout;
    stretch = named(new QCheckBox("Show stretch"), "stretch", ""); // see allowStretch()
    QString legend;
    const std::pair<double, const char *> values[] = {{-1, "1/2"}, {-0.5, "0.7"}, {0, "1"}, {0.5, "1.4"}, {1, "2"}};
    for (const auto &[exponent, text] : values) {
        const vcg::Color4b color = colorOfStretch(exponent);
        legend += QString("<span style='background: rgb(%1, %2, %3); color: %4'>&nbsp;%5&nbsp;</span>")
                      .arg(color[0])
                      .arg(color[1])
                      .arg(color[2])
                      .arg(std::abs(exponent) > 0.7 ? "white" : "black", text);
    }
    stretched->addWidget(stretch);
    stretched->addWidget(
        named(new QLabel(legend), "legend", "Length of the surface, in multiples of its length at rest"));
    stretched->addStretch();
    form->addRow(stretched);
}

void BendPanel::connectOptions() {
    connectSlider(
        *poseSlider, [this] { emit poseBegins(); },
        [this](int value) {
            poseLabel->setText(QString("%1 %").arg(value));
            emit optionsChanged();
        });
    for (const QDoubleSpinBox *box : {smoothnessValue, rigidityValue})
        connect(box, &QDoubleSpinBox::editingFinished, this, &BendPanel::optionsChanged);
    connect(patchCount, &QSpinBox::editingFinished, this, &BendPanel::optionsChanged);
    for (const QComboBox *choice : {mirrorAxis, axesChoice, falloffChoice, weightsChoice})
        connect(choice, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &BendPanel::optionsChanged);
    for (const QCheckBox *box : {elastic, stretch, onion})
        connect(box, &QCheckBox::toggled, this, &BendPanel::optionsChanged);
    connect(role, QOverload<int>::of(&QComboBox::activated), this, &BendPanel::roleChanged);
    connect(number, QOverload<int>::of(&QSpinBox::valueChanged), this, &BendPanel::roleChanged);
    connect(through, &QCheckBox::clicked, this, &BendPanel::roleChanged);
    connect(modes, QOverload<QAbstractButton *, bool>::of(&QButtonGroup::buttonToggled), this, [this] {
        const bool isLine = mode() == Line;
        if (lineBox->isHidden() == isLine)
            showParts();
    });
    connect(modes, QOverload<QAbstractButton *>::of(&QButtonGroup::buttonClicked), this, [this] {
        emit optionsChanged();
        emit modeChosen();
    });
}

void BendPanel::showKeys() {
    if (page) {
        page->close();
        return;
    }
    auto *text = new QLabel(bendKeyPage());
    text->setObjectName("page_text");
    text->setTextFormat(Qt::RichText);
    text->setWordWrap(true);
    text->setMargin(8);
    page = new QScrollArea(this);
    page->setWindowFlags(Qt::Tool);
    page->setObjectName("page");
    page->setAttribute(Qt::WA_DeleteOnClose);
    page->setAttribute(Qt::WA_ShowWithoutActivating);
    page->setWindowTitle("FCD: Bend, keys");
    const QSize room = window()->windowHandle()->screen()->availableSize() * 0.9; // leaves room for the window's frame
    const int edge = 2 * page->frameWidth(), width = std::min(900, room.width() - edge);
    text->resize(width, text->heightForWidth(width));
    page->setWidget(text);
    page->resize(width + edge, std::min(text->height() + edge, room.height()));
    page->show();
    tracePlaces(*this);
}

/// Esc in a field leaves the field, and does not reach the host.
bool BendPanel::event(QEvent *event) {
    const bool isKey = event->type() == QEvent::ShortcutOverride || event->type() == QEvent::KeyPress;
    if (!isKey || static_cast<QKeyEvent *>(event)->key() != Qt::Key_Escape)
        return ToolPanel::event(event);
    event->accept();
    if (event->type() == QEvent::KeyPress)
        emit left();
    return true;
}

int BendPanel::tag() const {
    switch (role->currentIndex()) {
    case Fixed: return 0;
    case Free: return 1;
    case Outside: return -1;
    }
    return number->value();
}

void BendPanel::setRole(Role which, int handle) {
    role->setCurrentIndex(which);
    if (which == Handle)
        number->setValue(handle);
}

void BendPanel::keepSizes() const {
    QSettings settings;
    settings.setValue(brushSetting, brushPixels->value());
    settings.setValue(radiusSetting, radiusPercent->value());
}

void BendPanel::setPose(int percent) {
    const QSignalBlocker blocked(poseSlider);
    poseSlider->setValue(percent);
    poseLabel->setText(QString("%1 %").arg(percent));
}

BendOptions BendPanel::options(const BendOptions &before) const {
    BendOptions options = before;
    options.smoothness = smoothnessValue->value();
    options.falloff = vcg::fcd::Falloff(falloffChoice->currentIndex());
    options.elastic = elastic->isChecked();
    options.rigidity = rigidityValue->value();
    options.initialPatches = patchCount->value();
    options.weights = vcg::fcd::MappingWeights(weightsChoice->currentIndex());
    options.mirror = mirrorAxis->currentIndex() - 1; // -1: none
    options.axes = BendAxes(axesChoice->currentIndex());
    return options;
}

void BendPanel::showOptions(const BendOptions &options) {
    const QSignalBlocker blocked(this);
    smoothnessValue->setValue(options.smoothness);
    falloffChoice->setCurrentIndex(int(options.falloff));
    elastic->setChecked(options.elastic);
    rigidityValue->setValue(options.rigidity);
    patchCount->setValue(options.initialPatches);
    weightsChoice->setCurrentIndex(int(options.weights));
    mirrorAxis->setCurrentIndex(options.mirror + 1);
    axesChoice->setCurrentIndex(int(options.axes));
    setPose(int(options.pose));
    setStretch(options.stretch);
}

void BendPanel::setStretch(bool shown) {
    const QSignalBlocker blocked(stretch);
    stretch->setChecked(shown);
}

void BendPanel::allowStretch(bool allowed) {
    stretch->setEnabled(allowed);
    stretch->setToolTip(allowed
                            ? "Colours the layer by its stretch from the rest shape: red is twice as long or more, "
                              "blue half as long or less, grey as long as before. While you mark, you see the marks."
                            : "A layer without faces has no surface that could stretch.");
}

void BendPanel::showMotions(const QString &text) {
    if (!motionText->hasFocus() && motionText->toPlainText() != text)
        motionText->setPlainText(text);
}

#include "edit_fcd/bend/panel/moc_panel.cpp" // NOLINT(bugprone-suspicious-include)
