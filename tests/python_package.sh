#!/usr/bin/env bash
# Builds the wheels of the Python package and of its plugins, installs them where nothing else of this repository is, and tests them
# there: with numpy alone, and with pymeshlab 2025.7 and what examples/ need. Needs what `bash tests/setup.sh tests` makes.
#
#   bash tests/python_package.sh [test [JUNIT-FILE]]
#   bash tests/python_package.sh release              then what is released: the source distribution, the package as it is built from
#                                                     that by the other compiler, with UndefinedBehaviorSanitizer and the assertions
#                                                     of the standard library, and, in short, the wheels with pymeshlab 2022.2
set -euo pipefail
what=${1:-test}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/python
tools=$root/build/venv-wheel/bin
python=$root/build/venv-python/bin/python # which has what the tests need
mkdir -p "$build"
cd "$build" # where no folder is called as the package is

# The method as a plugin has it, and by what compiler.
method=$root/build/cmake/meshlab-2020.09
[ -e "$method/arguments" ] || method=$root/build/cmake/pymeshlab-2025.7
compiler=$(sed -n 's/^-DCMAKE_CXX_COMPILER=//p' "$method/arguments")
other=$([ "$compiler" = clang++ ] && echo g++ || echo clang++)

# wheel COMPILER OPTION... SOURCE: builds one.
wheel() {
    nice "$tools/pip" wheel --disable-pip-version-check --quiet --no-build-isolation --no-deps \
        --config-settings=cmake.define.CMAKE_CXX_COMPILER_LAUNCHER=ccache "--config-settings=cmake.define.CMAKE_CXX_COMPILER=$1" "${@:2}"
}
# pip PYTHON ARGUMENT...: installs. What is not imported need not be compiled.
pip() {
    "$1" -m pip install --disable-pip-version-check --quiet --no-compile "${@:2}"
}
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

if [ "$what" = test ]; then
    rm -rf built dist fresh
    # That from the source distribution compiles all of the method.
    # In a folder of the compiler's own: CMake forgets its variables when that changes.
    wheel "$compiler" --wheel-dir built "--config-settings=cmake.define.FCD_METHOD=$method" "--config-settings=build-dir=build/python/{wheel_tag}-$compiler" "$root"
    wheel "$compiler" --wheel-dir built "--config-settings=cmake.define.FCD_PLUGINS=$root/build/plugins" "$root/python/plugin"
    # What else it runs on; the libraries of the plugins are those that pymeshlab has loaded.
    PATH=$tools:$PATH
    auditwheel repair --wheel-dir dist built/pymeshlab_fcd-*.whl >auditwheel.log 2>&1 || { cat auditwheel.log; exit 1; }
    auditwheel repair --wheel-dir dist --exclude 'lib*' built/pymeshlab_fcd_plugin-*.whl >>auditwheel.log 2>&1 || { cat auditwheel.log; exit 1; }
    package=$(echo dist/pymeshlab_fcd-*manylinux*.whl)
    plugin=$(echo dist/pymeshlab_fcd_plugin-*.whl)
    size=$(du -k "$package" | cut -f1)
    echo "built $size kB after $SECONDS s: $(basename "$package")"
    # Half of it is the library for programs in C++.
    [ "$size" -le 4096 ] || { echo "error: the wheel has $size kB, where 4096 are the most"; exit 1; }
    if "$tools/python" -m zipfile -l "$package" | grep 'pymeshlab_fcd.libs'; then
        echo "error: the wheel carries libraries of this system"
        exit 1
    fi

    # With numpy alone, as a newcomer has it.
    /usr/bin/python3 -m venv fresh
    pip fresh/bin/python "$package"
    fresh/bin/python -c "$bend"
    fresh/bin/pip list --disable-pip-version-check --format=freeze | grep -vE '^(numpy|pip|setuptools|pymeshlab-fcd)=' && { echo "error: it brought more than numpy"; exit 1; }

    # The packages are laid anew.
    pip "$python" --no-deps --force-reinstall "$package" "$plugin"
    "$python" -m pip check
    "$python" -m pytest -q -ra -p no:cacheprovider ${2:+--junitxml="$2"} "$root/tests/python"
    exit
fi

rm -rf from-source checked site-2022 dist/*.tar.gz
(cd "$root" && "$tools/python" -m build --no-isolation --sdist --outdir "$build/dist" >"$build/sdist.log" 2>&1) || { tail -n 20 sdist.log; exit 1; }
rm -rf "$root/python/third_party" # what it has collected
source=$(echo dist/*.tar.gz)
"$tools/python" -m twine check --strict dist/*

# It has all that it needs; by the other compiler, hardly optimised, with which its results agree. What is undefined, or out of a
# container's range, ends Python there.
trap=-fsanitize-trap=undefined
[ "$other" = clang++ ] || trap=-fsanitize-undefined-trap-on-error
fresh/bin/python "$root/tests/python/build_types.py" write optimised.npy
tar -xf "$source"
caches=$(ccache --get-config cache_dir)
mv "$(basename "$source" .tar.gz)" from-source
HOME=$build/from-source XDG_CACHE_HOME=$build/from-source CCACHE_DIR=$caches \
    wheel "$other" --config-settings=cmake.build-type=Debug "--config-settings=cmake.define.CMAKE_CXX_FLAGS_DEBUG=-O1 -fsanitize=undefined -fno-sanitize=vptr $trap -D_GLIBCXX_ASSERTIONS" \
    --wheel-dir from-source/dist ./from-source
pip fresh/bin/python --no-deps --force-reinstall from-source/dist/*.whl
fresh/bin/python -c "$bend"
extension=$(fresh/bin/python -c 'import pymeshlab_fcd._core as core; print(core.__file__)')
nm -D "$extension" | grep __assert_fail >assertions.log || { echo "error: $extension has no assertions"; exit 1; }
fresh/bin/python "$root/tests/python/build_types.py" compare optimised.npy
pip fresh/bin/python --no-deps --target checked from-source/dist/*.whl
PYTHONPATH=$build/checked "$python" -m pytest -q -ra -p no:cacheprovider \
    "$root"/tests/python/test_{memory,inputs,pickle,deformer,sequence,fit,straighten}.py -k "not example and not filter"

"$root/build/venv-2022/bin/pip" install --disable-pip-version-check --quiet --no-deps --target site-2022 dist/pymeshlab_fcd-*manylinux*.whl dist/pymeshlab_fcd_plugin-*.whl
PYTHONPATH=$build/site-2022 "$root/build/venv-2022/bin/python" -c "$bend
import pymeshlab
ms = pymeshlab.MeshSet()
ms.add_mesh(pymeshlab.Mesh(points))
pymeshlab_fcd.deform_layer(ms, tags, {2: lift}, graph_layers=False)
assert (ms.current_mesh().vertex_matrix() == moved).all()"
