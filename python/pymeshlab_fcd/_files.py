# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written completely or not at all."""
from __future__ import annotations

import contextlib
import os
import re
import shutil
import sys
import unicodedata
import uuid
from collections.abc import Iterable, Iterator, Sequence
from typing import BinaryIO


def marks(path: str | os.PathLike[str]) -> set[object]:
    """Marks of a path. Two paths that may lead to the same file share at least one: through links, also if the file does not exist yet, or if
    the names differ in case only, which some systems ignore."""
    def known(real: str) -> object:
        with contextlib.suppress(OSError):  # it does not exist yet
            about = os.stat(real)
            return about.st_dev, about.st_ino
        return real

    real = os.path.realpath(os.fsdecode(path))
    folder, name = os.path.split(real)
    return {known(real), (known(folder), unicodedata.normalize("NFC", name).casefold())}


def same_file(a: str | os.PathLike[str], b: str | os.PathLike[str]) -> bool:
    """Whether both paths may lead to the same file."""
    return not marks(a).isdisjoint(marks(b))


@contextlib.contextmanager
def alone(folder: str | os.PathLike[str]) -> Iterator[bool]:
    """Locks a folder. Yields whether no other process has the lock. It ends with this context or the process. If the file system has no locks,
    yields True."""
    opened: int | None = None
    is_alone = True
    try:
        if sys.platform == "win32":  # a file that vanishes with the process
            opened = os.open(os.path.join(folder, ".pymeshlab_fcd.lock"), os.O_CREAT | os.O_EXCL | os.O_TEMPORARY)
        else:
            import fcntl

            opened = os.open(folder, os.O_RDONLY)
            fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, FileExistsError):
        is_alone = False
    except OSError:  # some network file systems
        pass
    try:
        yield is_alone
    finally:
        if opened is not None:
            os.close(opened)


class _Replacement:
    """A new file beside the one that it replaces."""

    def __init__(self, name: str | os.PathLike[str]) -> None:
        self.name = os.fsdecode(name)
        self.path = os.path.realpath(self.name)
        self.beside = f"{self.path}.{os.getpid()}.{uuid.uuid4().hex}.part"
        self.kept = ""  # name of the old file while several files are replaced
        self.begun = False
        if os.path.exists(self.path) and not os.path.isfile(self.path):  # a pipe or a device: written directly
            self.path, self.beside = self.name, ""
        self.file: BinaryIO = open(self.beside or self.path, "xb" if self.beside else "wb")

    def complete(self) -> None:
        """Writes the whole content to the disk."""
        with self.file:
            if self.beside:
                self.file.flush()
                os.fsync(self.file.fileno())
        if self.beside and os.path.exists(self.path):
            shutil.copymode(self.path, self.beside)

    def keep(self) -> None:
        if self.beside and os.path.exists(self.path):
            self.kept = self.beside[:-len("part")] + "kept"
            try:
                os.link(self.path, self.kept)
            except (OSError, NotImplementedError):  # a file system without links
                shutil.copy2(self.path, self.kept)

    def replace(self) -> None:
        self.begun = True
        if self.beside:
            os.replace(self.beside, self.path)

    def undo(self) -> None:
        if self.begun and self.kept:
            os.replace(self.kept, self.path)
        elif self.begun and self.beside:
            os.unlink(self.path)

    def tidy(self) -> None:
        with contextlib.suppress(OSError):  # flushes again what could not be written
            self.file.close()
        for path in (self.beside, self.kept):
            with contextlib.suppress(OSError):
                if path:
                    os.unlink(path)


@contextlib.contextmanager
def written(paths: Sequence[str | os.PathLike[str]]) -> Iterator[list[BinaryIO]]:
    """New files for these names (or where links lead). They replace existing ones together, once all are on the disk. After an exception, each
    is as it was."""
    made: list[_Replacement] = []
    name: str | os.PathLike[str] | None = None  # of the present file, for errors
    try:
        for name in paths:
            made.append(_Replacement(name))
        name = None
        yield [each.file for each in made]
        for step in (_Replacement.complete, _Replacement.keep, _Replacement.replace):
            for each in made:
                name = each.name
                if step is not _Replacement.keep or len(made) > 1:  # a single file is replaced at once
                    step(each)
    except BaseException as error:
        for each in made if len(made) > 1 else []:
            with contextlib.suppress(OSError):
                each.undo()
        if isinstance(error, OSError) and error.errno is not None and name is not None:
            raise OSError(error.errno, error.strerror, os.fsdecode(name)) from error
        raise
    finally:
        for each in made:
            each.tidy()


def sweep(paths: Iterable[str | os.PathLike[str]]) -> None:
    """Removes what killed processes left of unfinished files for these names. Nobody else may write them meanwhile."""
    names: dict[str, set[str]] = {}
    for path in paths:
        folder, name = os.path.split(os.path.realpath(os.fsdecode(path)))
        names.setdefault(folder, set()).add(name)
    for folder, own in names.items():
        with contextlib.suppress(OSError):  # there is no such folder
            for each in os.listdir(folder):
                unfinished = re.fullmatch(r"(.*)\.\d+\.[0-9a-f]{32}\.part", each, re.DOTALL)
                if unfinished and unfinished[1] in own:
                    with contextlib.suppress(OSError):
                        os.unlink(os.path.join(folder, each))


def write(path: str | os.PathLike[str], content: bytes) -> None:
    """Writes a file. If that fails, an existing one stays."""
    with written([path]) as files:
        files[0].write(content)
