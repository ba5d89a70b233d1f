// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QPluginLoader>

#include <iostream>

/// The plugin in a file; null, with the reason on the error output, where there is none.
template <class Plugin>
Plugin *loadPlugin(const char *path) {
    QPluginLoader loader(path);
    Plugin *plugin = qobject_cast<Plugin *>(loader.instance());
    if (!plugin)
        std::cerr << loader.errorString().toStdString() << "\n";
    return plugin;
}
