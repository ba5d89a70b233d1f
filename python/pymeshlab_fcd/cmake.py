# SPDX-License-Identifier: GPL-3.0-or-later
"""Tells where CMake finds the C++ library of this package: headers, fcd::vcg_ext, and find_package(fcd).

    cmake -S . -B build -DCMAKE_PREFIX_PATH=$(python -m pymeshlab_fcd.cmake)"""
import sys
from pathlib import Path


def prefix() -> Path:
    """The folder for CMAKE_PREFIX_PATH.

    Returns
    -------
    pathlib.Path
        It has include, lib and lib/cmake/fcd.

    Raises
    ------
    FileNotFoundError
        This installation has no library.
    """
    folder = Path(__file__).resolve().parent / "cpp"
    if not (folder / "lib" / "cmake" / "fcd" / "fcdConfig.cmake").exists():
        raise FileNotFoundError(f"{folder} is not there: this is no installed package. Install one with pip, and ask that.")
    return folder


if __name__ == "__main__":
    try:
        print(prefix())
    except FileNotFoundError as why:
        sys.exit(str(why))
