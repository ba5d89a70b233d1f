# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written, all or none."""
from __future__ import annotations

import contextlib
import os
import shutil
import sys
import unicodedata
import uuid
from collections.abc import Iterator, Sequence
from typing import BinaryIO


def marks(path: str | os.PathLike[str]) -> set[object]:
    """What two names have in common, at least one of these, if what is written to both ends in one file: by links, also to where nothing is
    yet, and, on any system, where the names differ in case alone, which not all of them tell apart."""
    def known(real: str) -> object:
        with contextlib.suppress(OSError):  # it is not there yet
            about = os.stat(real)
            return about.st_dev, about.st_ino
        return real

    real = os.path.realpath(os.fsdecode(path))
    folder, name = os.path.split(real)
    return {known(real), (known(folder), unicodedata.normalize("NFC", name).casefold())}


def same_file(a: str | os.PathLike[str], b: str | os.PathLike[str]) -> bool:
    """Whether what is written to both ends in one file."""
    return not marks(a).isdisjoint(marks(b))


@contextlib.contextmanager
def alone(folder: str | os.PathLike[str]) -> Iterator[bool]:
    """Whether no other process is in here with this folder, which it then is while this lasts, however it ends. Where the file system
    cannot tell, none is."""
    opened: int | None = None
    is_alone = True
    try:
        if sys.platform == "win32":  # a file that goes with the process
            opened = os.open(os.path.join(folder, ".pymeshlab_fcd.lock"), os.O_CREAT | os.O_EXCL | os.O_TEMPORARY)
        else:
            import fcntl

            opened = os.open(folder, os.O_RDONLY)
            fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, FileExistsError):
        is_alone = False
    except OSError:  # as of some networks
        pass
    try:
        yield is_alone
    finally:
        if opened is not None:
            os.close(opened)


class _Replacement:
    """A file that is written beside the one that it replaces."""

    def __init__(self, name: str | os.PathLike[str]) -> None:
        self.name = os.fsdecode(name)
        self.path = os.path.realpath(self.name)
        self.beside = f"{self.path}.{os.getpid()}.{uuid.uuid4().hex}.part"
        self.kept = ""  # what was there, by another name, while several files are replaced
        self.begun = False
        if os.path.exists(self.path) and not os.path.isfile(self.path):  # a pipe, a device: nothing of it is replaced
            self.path, self.beside = self.name, ""
        self.file: BinaryIO = open(self.beside or self.path, "xb" if self.beside else "wb")

    def complete(self) -> None:
        """Puts the whole content on the disk."""
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
        with contextlib.suppress(OSError):  # what could not be written is still to be flushed
            self.file.close()
        for path in (self.beside, self.kept):
            with contextlib.suppress(OSError):
                if path:
                    os.unlink(path)


@contextlib.contextmanager
def written(paths: Sequence[str | os.PathLike[str]]) -> Iterator[list[BinaryIO]]:
    """Files that take the places of those of these names, or that the names lead to, together, when all are on the disk. After an
    exception each is as it was."""
    made: list[_Replacement] = []
    name: str | os.PathLike[str] | None = None  # of the file that it is about
    try:
        for name in paths:
            made.append(_Replacement(name))
        name = None
        yield [each.file for each in made]
        for step in (_Replacement.complete, _Replacement.keep, _Replacement.replace):
            for each in made:
                name = each.name
                if step is not _Replacement.keep or len(made) > 1:  # one is replaced or not
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


def write(path: str | os.PathLike[str], content: bytes) -> None:
    """Writes a file, or leaves what is there as it is."""
    with written([path]) as files:
        files[0].write(content)
