#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The main job on real meshes, through pymeshlab and through a filter script in meshlabserver. Layers and pictures go to
# build/demo/. Arguments (names of cases, see tests/demo.py --help) choose what to run.
#
#   bash tests/demo.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bash tests/setup.sh demo
PYTHONDONTWRITEBYTECODE=1 exec build/venv/bin/python tests/demo.py "$@"
