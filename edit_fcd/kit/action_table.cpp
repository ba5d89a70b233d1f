// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/kit/action_table.h"

#include <QKeySequence>
#include <QStringList>

static QString keyText(const ActionTable::Row &row) {
    return QString(row.keys).section('|', 0, 0).replace("Return", "Enter");
}

const ActionTable::Row *ActionTable::of(const QKeyEvent &event) const {
    const QKeySequence pressed(event.key() | int(event.modifiers() & ~Qt::KeypadModifier));
    for (const Row &each : rows)
        for (const QString &keys : QString(each.keys).split('|'))
            if (pressed == QKeySequence(keys))
                return &each;
    return nullptr;
}

QString ActionTable::withKeys(const QString &tip, int action) const {
    for (const Row &each : rows)
        if (each.action == action)
            return tip + " (" + keyText(each) + ")";
    return tip;
}

QString ActionTable::page(const std::vector<std::pair<QString, QString>> &more) const {
    QStringList lines;
    const auto add = [&](const QString &keys, const QString &text) {
        lines += "<tr><td><b>" + keys + "</b>&nbsp;&nbsp;</td><td>" + text + "</td></tr>";
    };
    for (const Row &each : rows)
        add(keyText(each), each.text);
    for (const auto &[keys, text] : more)
        add(keys, text);
    // Side by side, since small screens are wide and not high.
    const auto column = [&](int begin, int count) {
        return "<td width='50%'><table>" + lines.mid(begin, count).join("") + "</table></td>";
    };
    const int left = (lines.size() + 1) / 2;
    return "<p>A key acts on what is under the mouse. These are the keys of the view.</p><table width='100%'><tr>" +
           column(0, left) + column(left, -1) + "</tr></table>";
}
