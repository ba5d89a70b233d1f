// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/panel/panel.h"
#include "edit_fcd/view/colors.h"

#include <cmath>

#include <QFileInfo>
#include <QFormLayout>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QSignalBlocker>

// The slider is logarithmic: 100 steps are a factor of 10.
static double stiffnessAt(int place) { return std::pow(10, place / 100.0); }
static int sliderPlace(double stiffness) { return int(std::lround(100 * std::log10(stiffness))); }

FitPanel::FitPanel(QWidget *parent) : ToolPanel("FCD: Fit", "fcdFitPanel", 4, 5, parent) {
    addLayers(*head);
    addPairs(*content);
    addShape(*content);
    addCommands(*content);
    finish(72); // four lines
    showProgress(-1);
    showLegend(0);
}

QPushButton *FitPanel::button(const char *name, const QString &text, const QString &tip, FitAction::Id which) {
    auto *made = named(new QPushButton(text), name, fitActions().withKeys(tip, which));
    connect(made, &QPushButton::clicked, this, [this, which] { emit command(which); });
    return made;
}

static QButtonGroup *choiceOf(FitPanel &panel, void (FitPanel::*chosen)(), QBoxLayout &row,
                              const std::vector<std::array<QString, 3>> &namesTextsTips) {
    QButtonGroup *group = addButtons(row, panel, namesTextsTips);
    QObject::connect(group, QOverload<QAbstractButton *>::of(&QButtonGroup::buttonClicked), &panel, chosen);
    return group;
}

void FitPanel::addLayers(QBoxLayout &column) {
    auto *form = new QFormLayout;
    form->setVerticalSpacing(3);
    targets = named(new QComboBox, "target", "The layer to lie on");
    connect(targets, QOverload<int>::of(&QComboBox::activated), this, &FitPanel::targetChosen);
    form->addRow("Target", targets);
    auto *row = new QHBoxLayout;
    seenButtons = choiceOf(*this, &FitPanel::seenChosen, *row,
                           {{"inturn", "In turn", "Shows the layer that you click next (1)"},
                            {"both", "Both", "Shows this layer and the target (2)"},
                            {"source", "This", "Shows this layer alone (3)"},
                            {"other", "Target", "Shows the target alone (4)"}});
    form->addRow("Show", row);
    column.addLayout(form);
}

void FitPanel::addPairs(QBoxLayout &column) {
    const int height = 88; // three pairs: the whole panel fits 768 pixels
    list = new CellList({{"Pair", "Click selects, double click: its name", 0},
                         {"this", "Whether its place on this layer is given", 44},
                         {"target", "Whether its place on the target is given", 52},
                         {"", "Removes the pair", 22}},
                        height, this);
    list->setObjectName("pairs");
    connect(list, &CellList::cellEdited, this,
            [this](int row, int, const QString &text) { emit pairRenamed(row, text); });
    connect(list, &CellList::cellClicked, this, [this](int row, int clicked) {
        if (clicked == 3)
            emit pairRemoved(row);
        else
            emit pairSelected(row);
    });
    column.addWidget(list);
    auto *row = new QHBoxLayout;
    row->setSpacing(3);
    row->addWidget(button("load", "Load pairs ...",
                          "A list (.csv) or picked points (.pp) with both ends of each pair, or the picked points of "
                          "both layers with the same names: choose two files",
                          FitAction::Load));
    row->addWidget(button("save", "Save pairs ...",
                          "As a list (.csv) or picked points (.pp), as 'FCD: Fit to Layer' reads them",
                          FitAction::Save));
    row->addWidget(button("clear", "Clear", "Removes all pairs", FitAction::Clear));
    column.addLayout(row);
}

QComboBox *FitPanel::choice(const char *name, const QStringList &texts, const QString &tip) const {
    auto *made = named(new QComboBox, name, tip);
    made->addItems(texts);
    connect(made, QOverload<int>::of(&QComboBox::activated), this, &FitPanel::optionsChanged);
    return made;
}

void FitPanel::addShape(QBoxLayout &column) {
    auto *row = new QHBoxLayout;
    shapes = choiceOf(*this, &FitPanel::shapeChosen, *row,
                      {{"rest", "As it was", "This layer as it is without a fit (Backspace)"},
                       {"follow", "By the pairs", "This layer bent by the pairs alone, as rigidly as possible"},
                       {"pull", "Pull onto the target", "Lays this layer onto the target and keeps the pairs (P)"}});
    column.addLayout(row);
    auto *working = new QHBoxLayout;
    progress = new QProgressBar;
    progress->setTextVisible(false);
    progress->setFixedHeight(14);
    cancel = button("cancel", "Cancel", "Stops the pull", FitAction::Cancel);
    working->addWidget(progress);
    working->addWidget(cancel);
    column.addLayout(working);
    auto *form = new QFormLayout;
    form->setVerticalSpacing(3);
    auto *stiff = new QHBoxLayout;
    stiffness =
        named(new QSlider(Qt::Horizontal), "stiffness",
              "How rigid the surface is in a pull: softer follows finer detail, stiffer smooths over noise and holes");
    stiffness->setRange(sliderPlace(FitOptions::leastStiffness), sliderPlace(FitOptions::mostStiffness));
    stiffnessText = new QLabel("1");
    stiffnessText->setMinimumWidth(36);
    stiff->addWidget(stiffness);
    stiff->addWidget(stiffnessText);
    form->addRow("Stiffness", stiff);
    connect(stiffness, &QSlider::valueChanged, this, [this](int place) {
        stiffnessText->setText(QString::number(stiffnessAt(place), 'g', 3));
        emit optionsChanged();
    });
    start =
        choice("start", {"As the layers lie", "Moved by the pairs", "Moved and scaled by the pairs", "Axes tried out"},
               "How the whole layer first moves. By the pairs: needs three that are not on a line. Axes: at the pull");
    start->setCurrentIndex(int(FitOptions().start));
    form->addRow("Start", start);
    auto *counts = new QHBoxLayout; // in the order of Weights
    weights = choice("weights", {"This: all", "This: quality", "This: selected", "This: painted"},
                     "Which parts of this layer are pulled: all; as much as the vertex quality says, from 0 to 1; the "
                     "selection; or what you paint. The rest goes along, such as the gum of a dental scan");
    targetWeights = choice("targetweights", {"Target: all", "Target: quality", "Target: selected", "Target: painted"},
                           "Which parts of the target pull. The rest is ignored");
    for (QComboBox *each : {weights, targetWeights}) {
        each->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon); // no wider than the others
        each->setMinimumContentsLength(6);
        counts->addWidget(each);
    }
    form->addRow("Counts", counts);
    auto *painting = new QHBoxLayout;
    brushButtons =
        choiceOf(*this, &FitPanel::brushChosen, *painting,
                 {{"brushpairs", "Off", "Clicks place pairs (B)"},
                  {"brushcounts", "Counts", "Paints the parts to match, on either layer (B; X: the other paint)"},
                  {"brushcarried", "Carried",
                   "Paints the parts that go along unmatched, on either layer (B; X: the other paint)"}});
    brushPixels = named(new CountBox, "brush", "How far the brush paints around the mouse (wheel)");
    brushPixels->setRange(2, 500);
    brushPixels->setValue(20);
    brushPixels->setSuffix(" px");
    painting->addWidget(brushPixels);
    form->addRow("Brush", painting);
    largest = numberBox("largest", "Parts farther than this from the target have no counterpart there", 0,
                        FitOptions::mostDistance, 4, 0);
    largest->setSpecialValueText("no limit");
    connect(largest, &QDoubleSpinBox::editingFinished, this, &FitPanel::optionsChanged);
    form->addRow("Largest distance", largest);
    auto *lines = new QHBoxLayout;
    curves = button("curves", "", "", FitAction::LoadCurves);
    noCurves = button("nocurves", "Without", "Removes the curves", FitAction::ClearCurves);
    lines->addWidget(curves, 1);
    lines->addWidget(noCurves);
    form->addRow("Curves", lines);
    showCurves(QString());
    column.addLayout(form);
    distance = named(
        new QCheckBox("Show distance"), "distance",
        "Colours this layer, after a pull, by its distance from the target; grey parts have no counterpart there");
    connect(distance, &QCheckBox::toggled, this, &FitPanel::distanceToggled);
    column.addWidget(distance);
    legend = new QLabel;
    legend->setObjectName("legend");
    column.addWidget(legend);
}

void FitPanel::addCommands(QBoxLayout &column) {
    auto *grid = new QGridLayout;
    grid->setSpacing(3);
    grid->addWidget(button("undo", "Undo", "Undo, also over applies in place", FitAction::Undo), 0, 0);
    grid->addWidget(button("redo", "Redo", "Redo", FitAction::Redo), 0, 1);
    grid->addWidget(button("inplace", "Apply in place", "This layer keeps the shape, and the next fit begins from it",
                           FitAction::ApplyInPlace),
                    1, 0);
    grid->addWidget(button("newlayer", "Apply to new layer", "A new layer gets the shape, and this one is as it was",
                           FitAction::ApplyToNew),
                    1, 1);
    grid->addWidget(
        sessionButton("pairs, options, target, curves, what is painted, the fit and the rest shape",
                      [this](bool load) { emit command(load ? FitAction::LoadSession : FitAction::SaveSession); }),
        2, 0);
    graphs = named(new QCheckBox("with graph layers"), "graphs",
                   "'Apply to new layer' also adds the deformation graph at rest and deformed");
    grid->addWidget(graphs, 2, 1);
    column.addLayout(grid);
}

void FitPanel::showTargets(const std::vector<std::pair<int, QString>> &layers, int chosen) {
    const QSignalBlocker blocked(targets);
    targets->clear();
    for (const auto &[number, label] : layers)
        targets->addItem(label, number);
    targets->setCurrentIndex(targets->findData(chosen));
}

int FitPanel::target() const { return targets->currentIndex() < 0 ? -1 : targets->currentData().toInt(); }

FitOptions FitPanel::options() const {
    FitOptions options;
    options.stiffness = stiffnessAt(stiffness->value());
    options.start = vcg::fcd::FitStart(start->currentIndex());
    options.largestDistance = largest->value();
    options.weights = FitMeshParam::Weights(weights->currentIndex());
    options.targetWeights = FitMeshParam::Weights(targetWeights->currentIndex());
    return options;
}

void FitPanel::showOptions(const FitOptions &options) {
    const QSignalBlocker blocked(this);
    stiffness->setValue(sliderPlace(options.stiffness));
    start->setCurrentIndex(int(options.start));
    largest->setValue(options.largestDistance);
    weights->setCurrentIndex(int(options.weights));
    targetWeights->setCurrentIndex(int(options.targetWeights));
}

void FitPanel::showLegend(double most) {
    QString text;
    for (int i = 0; i < 5 && most > 0; ++i) {
        const vcg::Color4b color = colorOfDistance(i / 4.0);
        text += QString("<span style='background: rgb(%1, %2, %3); color: %4'>&nbsp;%5&nbsp;</span>")
                    .arg(color[0])
                    .arg(color[1])
                    .arg(color[2])
                    .arg(i == 0 || i == 4 ? "white" : "black", QString::number(most * i / 4, 'g', 2));
    }
    if (most > 0)
        text += "<span style='background: rgb(150, 150, 150); color: black'>&nbsp;none&nbsp;</span>";
    legend->setText(text);
}

void FitPanel::showCurves(const QString &file) {
    const QString name = QFileInfo(file).fileName();
    curves->setText(name.isEmpty() ? QString("Load ...")
                                   : curves->fontMetrics().elidedText(name, Qt::ElideMiddle, 120));
    curves->setToolTip((file.isEmpty() ? QString() : file.toHtmlEscaped() + "<br>") +
                       "Lines on both layers that slide along each other in a pull: lips, a ridge, a tooth's margin. A "
                       "table (.csv) as 'FCD: Fit to Layer' reads it");
    noCurves->setEnabled(!file.isEmpty());
}

void FitPanel::showPairs(const std::vector<FitPair> &pairs, int selected) {
    std::vector<CellList::Row> rows;
    rows.reserve(pairs.size());
    const auto centered = [](const QString &text) { return ListCell{text, {}, {}, {}, {}, true}; };
    for (const FitPair &each : pairs)
        rows.push_back({ListCell::edited(QString::fromStdString(each.name)), centered(each.slot ? "\u2713" : ""),
                        centered(each.place ? "\u2713" : ""), centered("\u2715")});
    list->showRows(std::move(rows), selected);
}

void FitPanel::showProgress(int percent) {
    progress->setEnabled(percent >= 0);
    cancel->setEnabled(percent >= 0);
    progress->setValue(std::max(0, percent));
}

const ActionTable &fitActions() {
    static const ActionTable all = {
        {FitAction::Undo, "Ctrl+Z"},
        {FitAction::Redo, "Ctrl+Shift+Z"},
        {FitAction::Remove, "Del"},
        {FitAction::Reset, "Backspace"},
        {FitAction::Pull, "P"},
        {FitAction::Cancel, "Esc"},
        {FitAction::InTurn, "1"},
        {FitAction::Both, "2"},
        {FitAction::Source, "3"},
        {FitAction::Target, "4"},
        {FitAction::Brush, "B"},
        {FitAction::OtherBrush, "X"},
        {FitAction::ApplyInPlace, "Ctrl+Return|Ctrl+Enter"},
        {FitAction::ApplyToNew, "Ctrl+Shift+Return|Ctrl+Shift+Enter"},
    };
    return all;
}

#include "edit_fcd/fit/panel/moc_panel.cpp" // NOLINT(bugprone-suspicious-include)
