#!/usr/bin/env bash
# Builds the wheels of the Python package and of its plugins, and the source distribution; installs them where nothing else of this
# repository is, and tests them there: with numpy alone, with pymeshlab 2025.7 and what examples/ need, in short with pymeshlab 2022.2, and
# from the source distribution. Needs what tests/setup.sh makes.
#
#   bash tests/python_package.sh [JUNIT-FILE]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/python
tools=$root/build/venv-wheel/bin
mkdir -p "$build"
rm -rf "$build"/{dist,site-2022,fresh,from-source}
cd "$build" # where no folder is called as the package is

# wheel OPTION... SOURCE: builds one.
wheel() {
    nice "$tools/pip" wheel --disable-pip-version-check --quiet --no-build-isolation --no-deps \
        --config-settings=cmake.define.CMAKE_CXX_COMPILER_LAUNCHER=ccache "$@"
}
wheel --wheel-dir dist "$root"
wheel --wheel-dir dist "--config-settings=cmake.define.FCD_PLUGINS=$root/build/plugins" "$root/python/plugin"
package=$(echo dist/pymeshlab_fcd-*.whl)
plugin=$(echo dist/pymeshlab_fcd_plugin-*.whl)
size=$(du -k "$package" | cut -f1)
echo "built $size kB after $SECONDS s: $(basename "$package")"
[ "$size" -le 3072 ] || { echo "error: the wheel has $size kB, where 3072 are the most"; exit 1; }
(cd "$root" && "$tools/python" -m build --no-isolation --sdist --outdir "$build/dist" >"$build/sdist.log" 2>&1) || { tail -n 20 sdist.log; exit 1; }
rm -rf "$root/python/third_party" # what it has collected
source=$(echo dist/*.tar.gz)
"$tools/python" -m twine check --strict dist/*
"$tools/python" -m auditwheel show "$package" >auditwheel.log
cat auditwheel.log
grep -qE '"manylinux_2_[0-9]+_' auditwheel.log || { echo "error: it would not run on other Linux systems"; exit 1; }

# With numpy alone, as a newcomer has it.
/usr/bin/python3 -m venv fresh
fresh/bin/pip install --disable-pip-version-check --quiet "$package"
SECONDS=0
bend='
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
print(bend, *pymeshlab_fcd._meshlab.METHODS)'
fresh/bin/python -c "$bend"
fresh/bin/pip list --disable-pip-version-check --format=freeze | grep -vE '^(numpy|pip|setuptools|pymeshlab-fcd)=' && { echo "error: it brought more than numpy"; exit 1; }

# From the source distribution, which has all that it needs.
tar -xf "$source"
rm -rf from-source && mv "$(basename "$source" .tar.gz)" from-source
HOME=$build/from-source XDG_CACHE_HOME=$build/from-source CCACHE_DIR=${CCACHE_DIR:-$HOME/.cache/ccache} wheel --wheel-dir from-source/dist ./from-source
fresh/bin/pip install --disable-pip-version-check --quiet --no-deps --force-reinstall from-source/dist/*.whl
fresh/bin/python -c "$bend"

# The environment has what the tests need; the packages are laid anew.
python=$root/build/venv-python/bin/python
"$python" -m pip install --disable-pip-version-check --quiet --no-deps --force-reinstall "$package" "$plugin"
"$python" -m pip check

"$root/build/venv-2022/bin/pip" install --disable-pip-version-check --quiet --no-deps --target site-2022 "$package" "$plugin"
PYTHONPATH=$build/site-2022 "$root/build/venv-2022/bin/python" -c "$bend
import pymeshlab
ms = pymeshlab.MeshSet()
ms.add_mesh(pymeshlab.Mesh(points))
pymeshlab_fcd.deform_layer(ms, tags, {2: lift}, graph_layers=False)
assert (ms.current_mesh().vertex_matrix() == moved).all()"

"$python" -m pytest -q -ra -p no:cacheprovider ${1:+--junitxml="$1"} "$root/tests/python"
