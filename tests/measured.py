#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps what was measured as data, docs/measured/*.json, and makes the tables of the manual's comparison pages of it.

    python3 tests/measured.py                 writes the tables into the pages
    python3 tests/measured.py check           tells of pages that differ from the data
    PROGRAM | python3 tests/measured.py record NAME --command 'PROGRAM' --runs 'five seeds'

The last one keeps the Markdown table that PROGRAM prints, with the machine, the compiler, the date and the commit. A page says where a
table stands: <!-- measured: NAME --> and <!-- end --> are around it; <!-- measured: NAME where COLUMN is VALUE with COLUMN | COLUMN --> is
a part of it."""
import argparse
import json
import platform
import re
import subprocess
import sys
from datetime import date
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
PLACE = re.compile(r"(<!-- measured: (\w+)(?: where (.+?) is (.+?))?(?: with (.+?))? -->\n).*?(<!-- end -->)", re.S)


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def table_of(text):
    """Columns and rows of the one Markdown table in text."""
    lines = [line for line in text.splitlines() if line.lstrip().startswith("|")]
    if len(lines) < 3 or not re.fullmatch(r"[|\s:-]+", lines[1]):
        raise SystemExit("measured: there is no Markdown table in what was read; record one table at a time")
    columns, rows = cells(lines[0]), [cells(line) for line in lines[2:]]
    if any(len(row) != len(columns) for row in rows):
        raise SystemExit("measured: rows differ in their number of cells; record one table at a time")
    return columns, rows


def markdown(data, where, value, columns):
    """The table, or the rows whose cell in where is value and some columns of it, and a line that tells how it was measured."""
    chosen = [data["columns"].index(name) for name in cells(columns)] if columns else range(len(data["columns"]))
    rows = [row for row in data["rows"] if not where or row[data["columns"].index(where)] == value]
    lines = ["| " + " | ".join(row) + " |" for row in [[row[i] for i in chosen] for row in [data["columns"], *rows]]]
    lines.insert(1, "|" + "---|" * len(chosen))
    told = [f"`{data['command']}`"] if data["command"] else []
    told += [data[key] for key in ("runs", "machine", "compiler", "date") if data[key]]
    return "\n".join(["", *lines, "", f"<small>{'; '.join(told)}</small>", ""]) + "\n"


def processor():
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines() if Path("/proc/cpuinfo").exists() else []:
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def output(*command):
    done = subprocess.run(command, cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    return done.stdout.strip().splitlines()[0] if done.returncode == 0 and done.stdout.strip() else ""


def record(arguments):
    columns, rows = table_of(sys.stdin.read())
    data = {
        "command": arguments.command, "runs": arguments.runs,
        "machine": f"{processor()}, {len(__import__('os').sched_getaffinity(0))} cores, {platform.system()}",
        "compiler": output("clang++", "--version"), "date": date.today().isoformat(), "commit": output("git", "rev-parse", "HEAD"),
        "columns": columns, "rows": rows}
    (DOCS / "measured" / f"{arguments.name}.json").write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def pages():
    """Each page that has tables, as it is and as it has to be; and the names of the tables."""
    used = set()
    for path in [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]:
        text = path.read_text(encoding="utf-8")

        def filled(match):
            used.add(match[2])
            data = json.loads((DOCS / "measured" / f"{match[2]}.json").read_text(encoding="utf-8"))
            return match[1] + markdown(data, *match.groups()[2:5]) + match[6]

        if (new := PLACE.sub(filled, text)) != text or PLACE.search(text):
            yield path, text, new
    unused = {path.stem for path in (DOCS / "measured").glob("*.json")} - used
    if unused:
        raise SystemExit(f"measured: no page has {', '.join(sorted(unused))}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="what")
    commands.add_parser("check")
    one = commands.add_parser("record")
    one.add_argument("name")
    one.add_argument("--command", required=True)
    one.add_argument("--runs", default="")
    arguments = parser.parse_args()
    if arguments.what == "record":
        record(arguments)
    stale = [path for path, text, new in pages() if text != new]
    if arguments.what == "check" and stale:
        raise SystemExit("measured: " + ", ".join(path.name for path in stale) + " differ from the data; run python3 tests/measured.py")
    for path, _, new in list(pages()):
        path.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    main()
