# SPDX-License-Identifier: GPL-3.0-or-later
"""Many files at a time: `python -m pymeshlab_fcd fit template.ply scans/*.ply --out fitted`."""
import sys

from ._batch import main

if __name__ == "__main__":  # not in the processes that it spawns
    sys.exit(main())
