# SPDX-License-Identifier: GPL-3.0-or-later
"""Plugins for pymeshlab, a folder for each version. pymeshlab_fcd finds and loads the one that fits."""
