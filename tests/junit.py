# SPDX-License-Identifier: GPL-3.0-or-later
"""What the JUnit files of ctest, GoogleTest and pytest say.

    python3 tests/junit.py count FILE...       passed, failed and skipped tests
    python3 tests/junit.py slowest FILE...     the ten tests that took longest"""
import sys
import xml.etree.ElementTree
from pathlib import Path


def cases(path):
    return list(xml.etree.ElementTree.parse(path).iter("testcase"))


def count(*paths):
    every = [case for path in paths for case in cases(path)]
    failed = [c for c in every if c.find("failure") is not None or c.find("error") is not None]
    skipped = [c for c in every if c not in failed and (c.find("skipped") is not None or c.get("status") in ("notrun", "disabled") or c.get("result") == "skipped")]
    print(len(every) - len(failed) - len(skipped), len(failed), len(skipped))


def slowest(*paths):
    times = [(float(c.get("time", 0)), Path(path).stem, c.get("name")) for path in paths for c in cases(path)]
    for seconds, suite, name in sorted(times, reverse=True)[:10]:
        print(f"{seconds:8.1f} s  {suite}  {name}")


{"count": count, "slowest": slowest}[sys.argv[1]](*sys.argv[2:])
