# SPDX-License-Identifier: GPL-3.0-or-later
"""Every text of an error in vcg_ext, layer_fcd, filter_fcd and edit_fcd must have been seen while the tests ran.

    python3 tests/messages.py MESSAGES

MESSAGES is the file that the tests wrote all messages to (their environment variable FCD_MESSAGES)."""
import ast
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

# What no test can bring about, by the beginning of the text, and why.
UNSEEN = {
    "The mesh has more than two thousand million edges": "takes more memory than the machines that run the tests have",
    "The deformation graph's system cannot be factorised.": "the system is positive definite; a guard for rounding",
    "Half of the way to the mirror image cannot be found": "the system is positive definite; a guard for rounding",
    " has no vertices, so there is nothing to bend": "MeshLab opens no layer without vertices",
    "Unknown filter": "a host only asks for the filters that it was told about",
    "Unknown source of tags": "parameters with other numbers are refused before",
    "Something that is not a standard exception": "nothing throws one",
}

LITERAL = r'"(?:[^"\\\n]|\\.)*"'
BEGIN = re.compile(r"\bthrow\b|\b(?:Fail|Expected|ReadNumbers|As<\w+>)\(|\berror =|\bmessage <<")
TOKEN = re.compile(rf"(?P<text>{LITERAL}(?:\s*{LITERAL})*)|'(?:[^'\\]|\\.)+'|//[^\n]*|(?P<end>;)")


def texts(source):
    """The line and the text of each piece of a message, where adjacent literals are one."""
    for begin in BEGIN.finditer(source):
        if source[:begin.start()].rpartition("\n")[2].lstrip().startswith("//"):
            continue
        for token in TOKEN.finditer(source, begin.end()):
            if token["end"]:
                break
            if token["text"]:
                piece = "".join(map(ast.literal_eval, re.findall(LITERAL, token["text"])))
                yield source.count("\n", 0, token.start()) + 1, piece


def main():
    seen = Path(sys.argv[1]).read_text(errors="replace")
    missing, unused, number = [], set(UNSEEN), 0
    folders = ("vcg_ext", "layer_fcd", "filter_fcd", "edit_fcd")
    for path in sorted(path for folder in folders for ending in ("h", "cpp") for path in ROOT.glob(f"{folder}/**/*.{ending}")):
        for line, text in texts(path.read_text()):
            number += 1
            excused = {begin for begin in UNSEEN if text.startswith(begin)}
            unused -= excused
            if text not in seen and not excused:
                missing.append(f"{path.relative_to(ROOT)}:{line}: error: no test sees {text!r}")
            if text in seen and excused:
                missing.append(f"{path.relative_to(ROOT)}:{line}: error: tests/messages.py excuses {text!r}, which a test sees")
    missing += [f"tests/messages.py: error: excuses {begin!r}, which is nowhere" for begin in sorted(unused)]
    print("\n".join(missing) or f"all {number} pieces of messages were seen")
    return 1 if missing or not number else 0


if __name__ == "__main__":
    sys.exit(main())
