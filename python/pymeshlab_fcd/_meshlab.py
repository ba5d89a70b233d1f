# SPDX-License-Identifier: GPL-3.0-or-later
"""The filters in pymeshlab. They need pymeshlab and the package pymeshlab_fcd_plugin, which has the plugins."""
from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import re
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from numpy.typing import ArrayLike

from . import _inputs
from ._deformer import Transforms

_INSTALL: Final = "pip install . ./python/plugin, in a clone of the repository after bash tests/setup.sh"


def _plugins() -> Mapping[str, Path]:
    """The plugin for each version of pymeshlab. Only looks for files."""
    try:
        found = importlib.util.find_spec("pymeshlab_fcd_plugin")
    except (ImportError, ValueError, AttributeError):  # another module has its name
        return {}
    folders = [Path(each) for each in found.submodule_search_locations or []] if found else []
    return {each.parent.name: each for folder in folders for each in sorted(folder.glob("*/libfilter_fcd.so"))}


PLUGINS = _plugins()
VERSIONS = sorted(PLUGINS, key=lambda name: [int(part) for part in name.split(".")])
"""The versions of pymeshlab with a plugin."""


def enable_pymeshlab() -> list[str]:
    """Loads the plugin into pymeshlab, and makes its filters methods of `pymeshlab.MeshSet`. `import pymeshlab_fcd_plugin` does the same. It
    may be called any number of times.

    Returns
    -------
    list[str]
        The names of the filters.

    Raises
    ------
    RuntimeError
        pymeshlab is not installed, or has no plugin for its version, or cannot load it; the text says why.
    """
    without = "deform and Deformer work without."
    if not PLUGINS:
        raise RuntimeError(f"MeshLab's filters are not installed: {_INSTALL}. {without}")
    known = " and ".join(VERSIONS)
    try:
        pymeshlab = importlib.import_module("pymeshlab")
        found = importlib.metadata.version("pymeshlab")
    except Exception as error:  # of another library, whatever it is
        raise RuntimeError(f"pymeshlab cannot be imported ({error}); there are filters for {known}. {without}") from error
    version = ".".join(re.findall(r"\d+", found)[:2])
    if version not in VERSIONS:
        raise RuntimeError(f"pymeshlab {found} is installed, and there are filters for {known}: install one of them. {without}")

    def ours() -> list[str]:
        return [name for name in pymeshlab.filter_list() if "fcd" in name.split("_")[1:]]  # 2022.2 lists titles, too

    try:
        if not ours():  # it may have been loaded before
            pymeshlab.load_plugin(str(PLUGINS[version]))
        methods = {name: pymeshlab.bind_function(name) for name in ours()}
    except Exception as error:  # of another library
        raise RuntimeError(f"pymeshlab {found} cannot load the filters ({error}). {without}") from error
    for name, method in methods.items():
        setattr(pymeshlab.MeshSet, name, method)
    return list(methods)


def deform_layer(ms: Any, tags: ArrayLike | None, transforms: Transforms | None = None, **parameters: Any) -> dict[str, Any]:
    """Deforms the current layer of a MeshSet. The results are new layers, with colours, textures and all else; the last one is then the
    current layer. It calls `enable_pymeshlab` for the filters.

    Parameters
    ----------
    ms : Any
        A pymeshlab.MeshSet.
    tags : array_like
        n whole numbers: 0 fixed, 1 free, 2 and up handles, negative outside. None: the layer has them as vertex quality.
    transforms : Transforms, optional
        `{tag: 4 x 4 matrix or Motion}`, world coordinates.
    parameters : any
        Those of the filter `generate_fcd_deformed_mesh`.

    Returns
    -------
    dict[str, Any]
        What the filter returns.

    Raises
    ------
    RuntimeError
        As in [enable_pymeshlab][pymeshlab_fcd.enable_pymeshlab].
    ValueError
        An argument has the wrong shape, or is out of range.
    pymeshlab.PyMeshLabException
        It cannot be deformed; the message says why. The MeshSet is then as it was.
    """
    enable_pymeshlab()
    text = "; ".join(f"{tag}: {steps}" for tag, steps in _inputs.transforms(transforms, None))
    if tags is None:
        return ms.apply_filter("generate_fcd_deformed_mesh", transforms=text, **parameters)  # type: ignore[no-any-return]
    whole = _inputs.tags(tags, ms.current_mesh().vertex_number())
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "tags.sel"
        file.write_text("\n".join(map(str, whole.tolist())) + "\n")
        return ms.apply_filter("generate_fcd_deformed_mesh", handles=3, tag_file=str(file), transforms=text,  # type: ignore[no-any-return]
                               **parameters)
