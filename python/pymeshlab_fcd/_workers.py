# SPDX-License-Identifier: GPL-3.0-or-later
"""Worker processes that end with this one, however it ends."""
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

_GRACE: Final = 2.0  # seconds, for running jobs to remove unfinished files

_is_ending = False
_is_busy = False


class Terminated(KeyboardInterrupt):
    """Raised by SIGTERM, like KeyboardInterrupt by Ctrl-C."""


@contextlib.contextmanager
def terminable() -> Iterator[None]:
    """Within this context, SIGTERM raises Terminated, once."""
    def end(*_: object) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        raise Terminated

    if threading.current_thread() is not threading.main_thread():  # only the main thread gets signals
        yield
        return
    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before or signal.SIG_DFL)


def _interrupt(*_: object) -> None:
    if _is_ending and _is_busy:  # ignores Ctrl-C itself: the parent gets it, too, and ends this
        raise KeyboardInterrupt


class _End(Protocol):
    """An end of a pipe; its class differs on Windows."""

    def poll(self, timeout: float | None = ...) -> bool: ...


def _watch(parent: _End) -> None:
    def wait() -> None:
        global _is_ending
        with contextlib.suppress(OSError):
            parent.poll(None)  # waits until the parent closes it
        _is_ending = True
        _thread.interrupt_main()
        time.sleep(_GRACE)
        os._exit(1)

    signal.signal(signal.SIGINT, _interrupt)
    threading.Thread(target=wait, daemon=True).start()


def run(call: Callable[..., Result], *arguments: Any) -> Result:
    """Runs a call in a worker."""
    global _is_busy
    _is_busy = True
    try:
        _interrupt()
        return call(*arguments)
    finally:
        _is_busy = False


@contextlib.contextmanager
def pool(processes: int) -> Iterator[ProcessPoolExecutor]:
    """Worker processes for `run`. They are spawned, not forked, since this process may have threads. After an exception, or when this process
    ends, they end at once."""
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
