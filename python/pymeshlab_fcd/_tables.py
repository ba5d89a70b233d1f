# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables that users write, by hand or by a spreadsheet: with commas, semicolons or tabs, UTF-8 with or without a byte order mark."""
from __future__ import annotations

import csv
import math
import os
from collections.abc import Iterator

import numpy as np

from ._inputs import Points
from ._numbers import shown

Path = str | os.PathLike[str]


def rows(path: Path) -> Iterator[tuple[str, list[str]]]:
    """The name of each row for messages, and its cells, without empty ones at the end. Lines that begin with # are comments."""
    with open(path, newline="", encoding="utf-8-sig", errors="replace") as file:  # broken characters are no numbers anyway
        lines = file.read().replace("\0", "?").splitlines()
    for number, line in enumerate(lines, 1):
        if line.lstrip().startswith("#"):
            continue
        separator = next((each for each in ";," if each in line), "\t")  # with semicolons, commas belong to numbers
        cells = [each.strip() for each in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])]
        while cells and not cells[-1]:
            cells.pop()
        if cells:
            yield f"line {number} of {shown(path)}", cells


def numbers(path: Path, columns: int, what: str) -> Points:
    """Reads a table of numbers, n x columns.

    Raises
    ------
    OSError
        It cannot be read.
    ValueError
        A row is wrong; the message names it, and what is expected.
    """
    found: list[list[float]] = []
    for where, cells in rows(path):
        try:
            found.append([float(each.split("#")[0]) for each in cells])  # as "3 # the nose"
        except ValueError:
            found.append([])
        if len(found[-1]) != columns or not all(map(math.isfinite, found[-1])):
            raise ValueError(f"{where} must have {columns} numbers, {what}, with points for decimals and commas or semicolons between them; it is "
                             f"{', '.join(cells)}")
    if not found:
        raise ValueError(f"{shown(path)} has no line with {columns} numbers, {what}")
    return np.array(found)
