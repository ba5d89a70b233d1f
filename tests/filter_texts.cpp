// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writes what the filters tell their users as pages of the manual, FOLDER/filters.md and one for each filter in
// FOLDER/filters:
//   filter_texts libfilter_fcd.so FOLDER
#include <layer_fcd/filter_host.h>
#include "load_plugin.h"

#include <QCoreApplication>
#include <QDir>
#include <QRegularExpression>

#include <fstream>
#include <sstream>

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

static const char *const head = "\n| in the window | in scripts | default | what it does |\n|---|---|---|---|\n";

/// The rows of the parameters that a dialog folds, or of the others.
static std::string rows(const RichParameterList &parameters, bool folded) {
    std::ostringstream out;
    for (const RichParameter &parameter : parameters)
        if (parameter.isAdvanced() == folded)
            out << "| " << cell(parameter.fieldDescription()).toStdString() << " | `"
                << parameter.pythonName().toStdString() << "` | " << defaultOf(parameter).toStdString() << " | "
                << cell(parameter.toolTip()).toStdString() << " |\n";
    return out.str();
}

int main(int argc, char **argv) {
    QCoreApplication application(argc, argv);
    FilterPlugin *plugin = loadPlugin<FilterPlugin>(argc > 1 ? argv[1] : "");
    const QString folder = argc > 2 ? argv[2] : "";
    if (!plugin || folder.isEmpty() || !QDir().mkpath(folder + "/filters"))
        return 2;
    MeshDocument document;
    document.addNewMesh("", "layer");
    std::ofstream list((folder + "/filters.md").toStdString());
    list << "# The filters\n\n"
            "What MeshLab's window and pymeshlab 2025.7 say of each filter. Its page has the parameters. MeshLab "
            "2020.09 "
            "lacks some of the newer parameters.\n\n"
            "| filter | in scripts | |\n|---|---|---|\n";
    for (QAction *action : plugin->actions()) {
        const auto id = plugin->ID(action);
        const QString name = plugin->pythonFilterName(id);
        QString text = plugin->filterInfo(id);
        const QString plain = QString(text).replace("<br>", " ").remove(QRegularExpression("<[^>]*>"));
        const QString first = plain.section(QRegularExpression("[.] "), 0, 0);
        list << "| [" << action->text().toStdString() << "](filters/" << name.toStdString() << ".md) | `"
             << name.toStdString() << "` | " << cell(first).toStdString() << " |\n";
        std::ofstream page((folder + "/filters/" + name + ".md").toStdString());
        page << "# " << action->text().toStdString() << "\n\nIn scripts `" << name.toStdString() << "`.\n\n"
             << text.replace("<br>", "\n\n").toStdString() << "\n";
        const RichParameterList parameters = plugin->initParameterList(action, document);
        if (const std::string first = rows(parameters, false); !first.empty())
            page << "\n## What you need"
                 << "\n"
                 << head << first;
        if (const std::string folded = rows(parameters, true); !folded.empty())
            page << "\n## The rest\n\nNewer MeshLabs fold these.\n" << head << folded;
        if (!page.good())
            return 2;
    }
    return list.good() ? 0 : 2;
}
