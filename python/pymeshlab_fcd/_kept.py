# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that do not change, and arrays that are checked for changes before each use."""
from __future__ import annotations

import numpy as np

from . import _core
from ._inputs import Points


class Unchanging:
    """Base of classes whose public names can neither be assigned nor deleted."""

    def __setattr__(self, name: str, value: object) -> None:
        self._expect_own(name)
        super().__setattr__(name, value)

    def __delattr__(self, name: str) -> None:
        self._expect_own(name)
        super().__delattr__(name)

    def _expect_own(self, name: str) -> None:
        if not name.startswith("_"):
            raise AttributeError(f"{name} cannot be changed: a {type(self).__name__} does not change")


class Kept:
    """Rows of three doubles, shown read-only. lent: the error if a caller's own array has changed; None for an array of our own"""

    def __init__(self, array: Points, lent: str | None = None, threads: int = 0) -> None:
        self._array, self._lent, self._threads = array, lent, threads
        if lent is None:
            array.flags.writeable = False  # views are shown: their flag cannot be set back
        else:
            self._mark = self._mark_now()
        self._view = self._show()

    def _show(self) -> Points:
        view = self._array.view()
        view.flags.writeable = False
        return view

    def _mark_now(self) -> tuple[int, tuple[int, ...], int]:
        array = self._array
        address: int = array.__array_interface__["data"][0]
        if array.shape[1:] != (3,) or array.dtype != np.float64 or not array.flags.c_contiguous:
            return address, array.shape, 0
        return address, array.shape, _core.checksum(array, self._threads)

    def look(self) -> Points:
        """The array, read-only. Raises ValueError if the caller has changed it."""
        if self._lent is None:
            return self._view
        if self._mark_now() != self._mark:
            raise ValueError(self._lent)
        return self._view

    def given_away(self) -> Points:
        """Our own array, given to the caller, who may write to it."""
        self._array.flags.writeable = True
        return self._array
