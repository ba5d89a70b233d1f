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
rm -rf "$build"/{built,dist,site-2022,fresh,from-source}
cd "$build" # where no folder is called as the package is

# wheel COMPILER OPTION... SOURCE: builds one.
wheel() {
    nice "$tools/pip" wheel --disable-pip-version-check --quiet --no-build-isolation --no-deps \
        --config-settings=cmake.define.CMAKE_CXX_COMPILER_LAUNCHER=ccache "--config-settings=cmake.define.CMAKE_CXX_COMPILER=$1" "${@:2}"
}
# With the method as the plugin for MeshLab's window has it; that from the source distribution, below, compiles all of it.
wheel g++ --wheel-dir built "--config-settings=cmake.define.FCD_METHOD=$root/build/cmake/meshlab-2020.09" "$root"
wheel g++ --wheel-dir built "--config-settings=cmake.define.FCD_PLUGINS=$root/build/plugins" "$root/python/plugin"
# What else it runs on; the libraries of the plugins are those that pymeshlab has loaded.
PATH=$tools:$PATH
auditwheel repair --wheel-dir dist built/pymeshlab_fcd-*.whl >auditwheel.log 2>&1 || { cat auditwheel.log; exit 1; }
auditwheel repair --wheel-dir dist --exclude 'lib*' built/pymeshlab_fcd_plugin-*.whl >>auditwheel.log 2>&1 || { cat auditwheel.log; exit 1; }
package=$(echo dist/pymeshlab_fcd-*manylinux*.whl)
plugin=$(echo dist/pymeshlab_fcd_plugin-*.whl)
size=$(du -k "$package" | cut -f1)
echo "built $size kB after $SECONDS s: $(basename "$package")"
[ "$size" -le 3072 ] || { echo "error: the wheel has $size kB, where 3072 are the most"; exit 1; }
(cd "$root" && "$tools/python" -m build --no-isolation --sdist --outdir "$build/dist" >"$build/sdist.log" 2>&1) || { tail -n 20 sdist.log; exit 1; }
rm -rf "$root/python/third_party" # what it has collected
source=$(echo dist/*.tar.gz)
"$tools/python" -m twine check --strict dist/*
if "$tools/python" -m zipfile -l "$package" | grep 'pymeshlab_fcd.libs'; then
    echo "error: the wheel carries libraries of this system"
    exit 1
fi

# With numpy alone, as a newcomer has it.
/usr/bin/python3 -m venv fresh
fresh/bin/pip install --disable-pip-version-check --quiet --no-compile "$package" # what is not imported is not compiled
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
print(bend, pymeshlab_fcd.__version__)'
fresh/bin/python -c "$bend"
fresh/bin/python "$root/tests/python/build_types.py" write optimised.npy
fresh/bin/pip list --disable-pip-version-check --format=freeze | grep -vE '^(numpy|pip|setuptools|pymeshlab-fcd)=' && { echo "error: it brought more than numpy"; exit 1; }

# From the source distribution, which has all that it needs; by the other compiler and without optimisation, with which its results
# agree. What a debugger reads would take a third of the time.
tar -xf "$source"
caches=$(ccache --get-config cache_dir)
mv "$(basename "$source" .tar.gz)" from-source
HOME=$build/from-source XDG_CACHE_HOME=$build/from-source CCACHE_DIR=$caches \
    wheel clang++ --config-settings=cmake.build-type=Debug --config-settings=cmake.define.CMAKE_CXX_FLAGS_DEBUG= --wheel-dir from-source/dist ./from-source
fresh/bin/pip install --disable-pip-version-check --quiet --no-deps --force-reinstall from-source/dist/*.whl
fresh/bin/python -c "$bend"
extension=$(fresh/bin/python -c 'import pymeshlab_fcd._core as core; print(core.__file__)')
nm -D "$extension" | grep __assert_fail >assertions.log || { echo "error: $extension has no assertions, so it is no build without optimisation"; exit 1; }
fresh/bin/python "$root/tests/python/build_types.py" compare optimised.npy

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
