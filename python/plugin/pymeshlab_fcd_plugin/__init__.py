# SPDX-License-Identifier: GPL-3.0-or-later
"""Plugins for pymeshlab, a folder for each version. Importing this makes the filters methods of pymeshlab.MeshSet."""
from pymeshlab_fcd import enable_pymeshlab

enable_pymeshlab()
