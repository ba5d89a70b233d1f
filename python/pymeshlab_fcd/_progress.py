# SPDX-License-Identifier: GPL-3.0-or-later
"""Reports of progress."""
from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, Union

Report = Callable[[int, str], object]


class Bar(Protocol):
    """A progress bar like those of tqdm."""

    def update(self, n: float = 1, /) -> object:
        """Adds to the progress."""


Progress = Union[Report, Bar, None]
"""A callable that gets the percent done (0 to 100) and the present stage, about every 0.03 s; or a bar of tqdm, or the class `tqdm` itself. An
exception that it raises ends the work, and nothing is half done."""


class _BarReport:
    def __init__(self, bar: Any) -> None:
        self.bar, self.done = bar, 0
        self.share = (getattr(bar, "total", None) or 100) / 100

    def __call__(self, percent: int, stage: str) -> None:
        if hasattr(self.bar, "set_description"):
            self.bar.set_description(stage, refresh=False)
        if percent > self.done:
            self.bar.update((percent - self.done) * self.share)
            self.done = percent


def report(progress: Progress, begin: int = 0, end: int = 100) -> Report | None:
    """The callable for the extension, for the part of the work from begin to end percent."""
    if progress is None:
        return None
    told: Report
    if isinstance(progress, _BarReport):
        told = progress
    elif isinstance(progress, type) and hasattr(progress, "update"):
        told = _BarReport(progress(total=100))
    elif callable(progress):
        told = progress
    elif hasattr(progress, "update"):
        told = _BarReport(progress)
    else:
        raise TypeError(f"progress must be callable with (percent, stage), or a bar of tqdm; it is a {type(progress).__name__}")
    if (begin, end) == (0, 100):
        return told
    return lambda percent, stage: told(begin + percent * (end - begin) // 100, stage)


def shared(progress: Progress) -> Progress:
    """One report for several parts of the work, so that they share a bar."""
    return report(progress)
