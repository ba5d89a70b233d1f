# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of a command, beside its results: the source of each, and its hash."""
from __future__ import annotations

import csv
import hashlib
import io
import os
from collections.abc import Sequence
from pathlib import Path

from . import _files
from ._numbers import shown

Row = dict[str, object]
_LAST = ("seconds", "warnings", "error", "source", "result", "key")


def state(*paths: Path) -> str:
    """Hashes of the content of files; empty if one cannot be read."""
    def of(path: Path) -> str:
        found = hashlib.blake2b(digest_size=10)
        with open(path, "rb") as file:
            while part := file.read(1 << 20):
                found.update(part)
        return found.hexdigest()

    try:
        return " ".join(map(of, paths))
    except OSError:
        return ""


class Table:
    """The rows of files that are done. Each is appended to the table as it comes; the last row of a file counts."""

    def __init__(self, path: Path, files: Sequence[Path] = ()) -> None:
        """Raises ValueError if the file is another table, OSError if it cannot be read."""
        self.path = path
        self._folder = os.path.abspath(path.parent)
        self.rows: dict[str, Row] = {}
        if path.exists():
            with open(path, newline="", encoding="utf-8-sig", errors="replace") as file:
                reader = csv.DictReader(line.replace("\0", "") for line in file)
                if not {"file", "key"} <= set(reader.fieldnames or ["file", "key"]):
                    raise ValueError(f"{shown(path)} would be written over, but is no table of results: rename it, or give another folder")
                self.rows = {row["source"]: dict(row) for row in reader if row.get("key") and row.get("source")}  # the last row may be incomplete
        self.order = list(dict.fromkeys([*map(self.source, files), *self.rows]))
        self.names: list[str] = []
        self._results: dict[str, list[Row]] | None = None

    def source(self, path: Path) -> str:
        """The source of a row, relative to the table: it stays valid wherever the command is called, and if both are moved."""
        full = os.path.abspath(path)
        try:
            return shown(Path(os.path.relpath(full, self._folder)).as_posix())
        except ValueError:  # on another drive
            return shown(full)

    def place(self, row: Row) -> str:
        """The path of a row's source."""
        return os.path.normpath(os.path.join(self._folder, f"{row['source']}"))

    def rename(self, row: Row, path: Path) -> None:
        """Changes a row's source to a moved file."""
        was, now = f"{row['source']}", self.source(path)
        self.rows.pop(now, None)
        row["file"], row["source"] = shown(path), now
        self.rows = {f"{each['source']}": each for each in self.rows.values()}
        self.order = [name for name in self.order if name != was]
        if now not in self.order:
            self.order.append(now)

    def owners(self, out: Path) -> list[Row]:
        """The rows whose unchanged result a file is."""
        if self._results is None:
            self._results = {}
            for row in self.rows.values():
                self._results.setdefault(Path(f"{row['source']}").stem.casefold(), []).append(row)
        now = state(out)
        return [row for row in self._results.get(shown(out.stem).casefold(), []) if now and f"{row['result']}".split(" ")[0] == now]

    def write(self) -> None:
        """Writes the table anew, in the order of the files."""
        self.names = list(dict.fromkeys(["file", *(name for row in self.rows.values() for name in row if name not in _LAST), *_LAST]))
        text = io.StringIO(newline="")
        writer = csv.DictWriter(text, self.names, restval="")
        writer.writeheader()
        writer.writerows(self.rows[name] for name in self.order if name in self.rows)
        _files.write(self.path, text.getvalue().encode("utf-8", "backslashreplace"))

    def add(self, path: Path, row: Row) -> None:
        name = self.source(path)
        row = {"file": shown(path), **row, "source": name}
        self.rows[name] = row
        if name not in self.order:
            self.order.append(name)
        if not set(row) <= set(self.names):  # it has new columns
            self.write()
            return
        with open(self.path, "a", newline="", encoding="utf-8", errors="backslashreplace") as file:
            csv.DictWriter(file, self.names, restval="").writerow(row)
