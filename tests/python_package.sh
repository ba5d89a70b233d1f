#!/usr/bin/env bash
# Builds the wheel of the Python package, installs it where nothing else of this repository is, and tests it there: with
# pymeshlab 2025.7, with what examples/ need, and in short with pymeshlab 2022.2. Needs what tests/setup.sh makes.
#
#   bash tests/python_package.sh [JUNIT-FILE]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/python
mkdir -p "$build"
rm -rf "$build/dist" "$build/site-2022"
cd "$build" # where no folder is called as the package is

nice "$root/build/venv-wheel/bin/pip" wheel --disable-pip-version-check --quiet \
    --no-build-isolation --no-deps --wheel-dir dist --config-settings=cmake.define.CMAKE_CXX_COMPILER_LAUNCHER=ccache \
    "--config-settings=cmake.define.FCD_PLUGINS=$root/build/plugins" "$root"
wheel=$(echo dist/pymeshlab_fcd-*.whl)
echo "built $(du -k "$wheel" | cut -f1) kB after $SECONDS s: $(basename "$wheel")"
"$root/build/venv-wheel/bin/python" -m twine check --strict "$wheel"

# The environment has what the tests need; the package is laid anew.
python=$root/build/venv-python/bin/python
"$python" -m pip install --disable-pip-version-check --quiet --no-deps --force-reinstall "$wheel"
"$python" -m pip check

"$root/build/venv-2022/bin/pip" install --disable-pip-version-check --quiet --no-deps --target site-2022 "$wheel"
PYTHONPATH=$build/site-2022 "$root/build/venv-2022/bin/python" -c '
import numpy as np, pymeshlab_fcd
x, y = np.meshgrid(np.arange(30.0), np.arange(9.0))
points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1)
tags = np.where(points[:, 0] < 3, 0, np.where(points[:, 0] > 26, 2, 1))
lift = np.eye(4)
lift[2, 3] = 5
moved = pymeshlab_fcd.deform(points, None, tags, {2: lift})
assert (moved[tags == 0] == points[tags == 0]).all() and abs(moved[tags == 2, 2] - 5).max() < 1e-9
bend = pymeshlab_fcd.deformation(points, None, tags, {2: lift})
assert abs(bend(points) - moved).max() < 1e-2
print("with pymeshlab 2022.2:", *pymeshlab_fcd._plugin.METHODS)'

"$python" -m pytest -q -ra -p no:cacheprovider ${1:+--junitxml="$1"} "$root/tests/python"
