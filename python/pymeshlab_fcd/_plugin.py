# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin that fits the pymeshlab that is installed."""
from __future__ import annotations

import importlib.metadata
import re
import warnings
from pathlib import Path

PLUGINS = Path(__file__).parent / "plugins"
# Of pymeshlab, that there is a plugin for.
VERSIONS = sorted((folder.name for folder in PLUGINS.iterdir()), key=lambda name: [int(part) for part in name.split(".")])
METHODS: list[str] = []  # filters that became methods of MeshSet

missing = ""  # why there is no plugin


def _load() -> str:
    known = " and ".join(VERSIONS)
    try:
        import pymeshlab
    except ImportError as error:
        return (f"pymeshlab cannot be imported ({error}). This package knows pymeshlab {known}: install one of them to deform "
                "meshes. Saved deformations work without it.")
    found = importlib.metadata.version("pymeshlab")
    version = ".".join(re.findall(r"\d+", found)[:2])
    if version not in VERSIONS:
        reason = (f"pymeshlab {found} is installed, and pymeshlab_fcd has plugins for {known}: install one of them to deform "
                  "meshes. Saved deformations work without it.")
        warnings.warn(reason, stacklevel=4)
        return reason
    def ours():
        return [name for name in pymeshlab.filter_list() if "fcd" in name.split("_")[1:]]  # 2022.2 lists titles, too
    if not ours():  # someone may have loaded one before
        pymeshlab.load_plugin(str(PLUGINS / version / "libfilter_fcd.so"))
    for name in ours():
        setattr(pymeshlab.MeshSet, name, pymeshlab.bind_function(name))
        METHODS.append(name)
    return ""


missing = _load()
