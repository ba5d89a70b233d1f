# SPDX-License-Identifier: GPL-3.0-or-later
"""What a fit takes of large surfaces: prints a table of seconds, memory beside the arrays, and distance from the truth.

    build/venv-python/bin/python tests/fit_sizes.py [MILLIONS...]

An egg with bumps, and the same one bent along an arc, each of so many million vertices (1, 4 and 10) or of 180 thousand. Each fit is a
process of its own."""
import resource
import subprocess
import sys
import time

import numpy as np

SMALL = 180_000


def egg(count):
    """An egg with bumps of about so many vertices: (vertices, faces)."""
    rings = int(np.sqrt(count / 2))
    around = count // rings
    down, along = np.meshgrid(np.linspace(0, np.pi, rings + 2)[1:-1], np.linspace(0, 2 * np.pi, around, endpoint=False), indexing="ij")
    x, y, z = (np.sin(down) * np.cos(along)).ravel(), (np.sin(down) * np.sin(along)).ravel(), np.cos(down).ravel()
    radius = 1 + 0.1 * np.sin(4 * x + 3 * y) + 0.1 * np.sin(5 * y - 3 * z + 1) + 0.03 * np.sin(11 * z + 9 * x)
    row, here = np.arange(rings - 1)[:, None] * around, np.arange(around)
    beside = (here + 1) % around
    faces = [np.stack(corners, -1).reshape(-1, 3) for corners in (
        (row + here, row + around + here, row + beside), (row + beside, row + around + here, row + around + beside))]
    return np.stack([1.3 * radius * x, radius * y, 0.9 * radius * z], 1), np.concatenate(faces).astype(np.int32)


def bent(points, radius=6.0):
    """Along an arc of that radius: 12 degrees to each side."""
    turn = points[:, 0] / radius
    return np.stack([(radius + points[:, 2]) * np.sin(turn), points[:, 1], (radius + points[:, 2]) * np.cos(turn) - radius], 1)


def peak():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def one(source, target, cloud):
    """Prints the cells of a row."""
    import pymeshlab_fcd  # only here: the parent needs none

    points, faces = egg(source)
    goal, corners = egg(target)
    goal = bent(goal)
    before = peak()
    start = time.perf_counter()
    fitted = pymeshlab_fcd.fit(points, faces, goal, None if cloud else corners)
    seconds, most = time.perf_counter() - start, peak()
    truth = bent(points)
    off = np.sqrt(((fitted.vertices - truth) ** 2).sum(1).mean()) / np.linalg.norm(np.ptp(truth, axis=0))
    print(f"{len(points):,} | {len(goal):,}{' points' if cloud else ''} | {seconds:.1f} | {(most - before) / max(len(points), len(goal)):.0f} | "
          f"{100 * off:.2f}")


def main():
    if sys.argv[1:2] == ["one"]:
        one(int(sys.argv[2]), int(sys.argv[3]), sys.argv[4] == "cloud")
        return
    print("| vertices | of the target | s | bytes for each vertex of the larger one, beside the arrays | off by, % of the diagonal |")
    print("|---|---|---|---|---|")
    for millions in sys.argv[1:] or ("1", "4", "10"):
        large = round(float(millions) * 1e6)
        for source, target, kind in ((SMALL, large, "mesh"), (SMALL, large, "cloud"), (large, SMALL, "mesh"), (large, large, "mesh")):
            done = subprocess.run([sys.executable, __file__, "one", str(source), str(target), kind], check=True, capture_output=True, text=True)
            print("|", done.stdout.strip(), "|", flush=True)


if __name__ == "__main__":
    main()
