#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How near symmetrize and compensate come to the truth, on shapes made by formula, as tests/measured.py records it.

    build/venv-python/bin/python tests/restored.py symmetry|compensation"""
import sys
import warnings
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests/python"), str(ROOT / "examples")]
import test_compensate as part
import test_symmetrize as skulls
from pymeshlab_fcd import compensate, symmetrize

SEEDS = (1, 3, 4, 5, 6)


def between(values):
    return f"{min(values):.2g} to {max(values):.2g}"


def pairs_of(seed, shear, bend):
    """14 pairs of places, left and right, evenly spread: one half of a spiral of Fibonacci."""
    z, a = 1 - (2 * np.arange(28) + 1) / 28, np.pi * (3 - np.sqrt(5)) * np.arange(28)
    around = np.sqrt(1 - z**2)
    spiral = np.stack([around * np.cos(a), around * np.sin(a), z], 1)
    side = spiral[np.argsort(-spiral[:, 0])[:14]]
    return np.stack([skulls.buried(skulls.skull(at, seed), shear, bend) for at in (side, side * skulls.MIRROR)], 1)


def symmetry():
    print("| deformed by | before | after | with 14 pairs |\n|---|---|---|---|")
    for shear, bend in ((0.08, 0.12), (0.14, 0.32)):
        before, after, by_pairs, turns = [], [], [], []
        for seed in SEEDS:
            truth = skulls.skull(skulls.AT, seed)
            bent = skulls.buried(truth, shear, bend)
            turns.append(np.degrees(bend * np.ptp(truth[:, 1])))
            before.append(skulls.off(bent, truth))
            after.append(skulls.off(symmetrize(bent, skulls.FACES).vertices, truth))
            by_pairs.append(skulls.off(symmetrize(bent, skulls.FACES, pairs=pairs_of(seed, shear, bend)).vertices, truth))
        print(f"| a shear of {100 * shear:.0f} percent and a bend of {np.mean(turns):.0f} degrees | {between(before)} | {between(after)} | {between(by_pairs)} |")


def compensation():
    nominal, faces, holes = part.plate()
    made = compensate(nominal, faces, *part.scan())

    def off(points):
        return part.rms(part.placed(part.warped(points), nominal) - nominal)
    print("| print of | off, mm (rms) | holes of the shape to print, out of round by mm |\n|---|---|---|")
    print(f"| the nominal part | {off(nominal):.2g} | 0 |")
    print(f"| the compensated part | {off(made.vertices):.2g} | {part.out_of_round(made.vertices, holes):.2g} |")
    right = 2 * nominal - part.placed(part.warped(nominal), nominal)
    print(f"| the nominal part minus its warp, which no scan tells | {off(right):.2g} | {part.out_of_round(right, holes):.2g} |")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    {"symmetry": symmetry, "compensation": compensation}[sys.argv[1]]()
