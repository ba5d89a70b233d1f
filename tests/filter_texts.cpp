// SPDX-License-Identifier: GPL-3.0-or-later
//
// Prints what the filters tell their users as a page of the manual, docs/filters.md:
//   filter_texts libfilter_fcd.so
#include <layer_fcd/filter_host.h>
#include "load_plugin.h"

#include <QCoreApplication>

#include <iostream>

/// In a cell of a table, which is one line.
static QString cell(QString text) { return text.simplified().replace("|", "\\|"); }

static QString defaultOf(const RichParameter &parameter) {
    if (const auto *choice = dynamic_cast<const RichEnum *>(&parameter))
        return "`'" + choice->enumvalues[choice->value().getInt()] + "'`";
    if (parameter.isOfType<RichBool>())
        return parameter.value().getBool() ? "`True`" : "`False`";
    if (parameter.isOfType<RichInt>())
        return "`" + QString::number(parameter.value().getInt()) + "`";
    if (parameter.isOfType<RichFloat>())
        return "`" + QString::number(double(parameter.value().getFloat()), 'g', 6) + "`";
    return ""; // empty, a place, or of the layers at hand: the text says it
}

int main(int argc, char **argv) {
    QCoreApplication application(argc, argv);
    FilterPlugin *plugin = loadPlugin<FilterPlugin>(argc > 1 ? argv[1] : "");
    if (!plugin)
        return 2;
    MeshDocument document;
    document.addNewMesh("", "layer");
    std::cout
        << "# The filters\n\n"
           "What MeshLab's window and pymeshlab 2025.7 say of each filter and parameter. MeshLab 2020.09 lacks the "
           "parameters `pose_steps`, `weld_distance`, `surface_layer`, `accuracy` and `inverse`.\n";
    for (QAction *action : plugin->actions()) {
        const auto id = plugin->ID(action);
        QString text = plugin->filterInfo(id);
        text.replace("<br>", "\n\n");
        std::cout << "\n## " << action->text().toStdString() << "\n\nIn scripts `"
                  << plugin->pythonFilterName(id).toStdString() << "`.\n\n"
                  << text.toStdString() << "\n";
        const RichParameterList parameters = plugin->initParameterList(action, document);
        if (parameters.size() > 0)
            std::cout << "\n| in the window | in scripts | default | what it does |\n|---|---|---|---|\n";
        for (const RichParameter &parameter : parameters)
            std::cout << "| " << cell(parameter.fieldDescription()).toStdString() << " | `"
                      << parameter.pythonName().toStdString() << "` | " << defaultOf(parameter).toStdString() << " | "
                      << cell(parameter.toolTip()).toStdString() << " |\n";
    }
}
