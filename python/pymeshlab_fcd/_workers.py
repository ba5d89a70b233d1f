# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that work for this one, and end with it, however it ends."""
from __future__ import annotations

import _thread
import contextlib
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import Any, Final, Protocol, TypeVar

Result = TypeVar("Result")

_GRACE: Final = 2.0  # seconds, for what is begun to remove its unfinished files

_is_ending = False
_is_busy = False


class Terminated(KeyboardInterrupt):
    """By SIGTERM, as KeyboardInterrupt is by Ctrl-C."""


@contextlib.contextmanager
def terminable() -> Iterator[None]:
    """SIGTERM raises Terminated in here, once."""
    def end(*_: object) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        raise Terminated

    if threading.current_thread() is not threading.main_thread():  # which alone has signals
        yield
        return
    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before or signal.SIG_DFL)


def _interrupt(*_: object) -> None:
    if _is_ending and _is_busy:  # not by Ctrl-C itself: the parent has it, too
        raise KeyboardInterrupt


class _End(Protocol):
    """Of a pipe, whose class is another one on Windows."""

    def poll(self, timeout: float | None = ...) -> bool: ...


def _watch(parent: _End) -> None:
    def wait() -> None:
        global _is_ending
        with contextlib.suppress(OSError):
            parent.poll(None)  # nothing ever comes, until it is closed
        _is_ending = True
        _thread.interrupt_main()
        time.sleep(_GRACE)
        os._exit(1)

    signal.signal(signal.SIGINT, _interrupt)
    threading.Thread(target=wait, daemon=True).start()


def run(call: Callable[..., Result], *arguments: Any) -> Result:
    """A call in one of the processes."""
    global _is_busy
    _is_busy = True
    try:
        _interrupt()
        return call(*arguments)
    finally:
        _is_busy = False


@contextlib.contextmanager
def pool(processes: int) -> Iterator[ProcessPoolExecutor]:
    """Processes for `run`; no copies of this one, which may have threads. After an exception, or when this one is gone, they end at once."""
    context = multiprocessing.get_context("spawn")
    theirs, ours = context.Pipe(duplex=False)
    made = ProcessPoolExecutor(processes, mp_context=context, initializer=_watch, initargs=(theirs,))
    try:
        yield made
    except BaseException:
        ours.close()
        raise
    finally:
        made.shutdown(cancel_futures=True)
        ours.close()
        theirs.close()
