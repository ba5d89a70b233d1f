#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes all that is published, in dist/, and proves each by installing it where nothing else of this repository is:
#
#   fcd-VERSION-HOST-linux-x86-64.zip   the plugins for a MeshLab, or for pymeshlab
#   pymeshlab_fcd*.whl, *.tar.gz        the Python packages, by the commands of .github/workflows/wheels.yml
#   fcd-VERSION-source.tar.gz           what is committed
#   fcd-VERSION-manual.zip              docs/ as pages
#   SHA256SUMS
#
#   bash tests/release.sh            sets up, builds, makes and proves all of it
#   bash tests/release.sh --built    takes plugins and packages as build/ has them, and leaves out what is not there
#
# At the end it says what could not be proved on this machine, and what a person has to press.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build
dist=$root/dist
work=$build/release
cd "$root"
fail() {
    echo "error: $1" >&2
    exit 1
}
built() { echo "made    $(basename "$1"), $(du -k "$1" | cut -f1) kB"; }
proved() { echo "proved  $1"; }
left=() # what is not proved here
left_out() {
    left+=("$1")
    echo "not     $1"
}

# One version, everywhere.
version=$(sed -n 's/^project(fcd VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
for file in pyproject.toml python/plugin/pyproject.toml; do
    grep -q "^version = \"$version\"$" "$file" || fail "$file has another version than CMakeLists.txt, $version"
done
grep -q "pymeshlab-fcd == $version\"" python/plugin/pyproject.toml || fail "python/plugin/pyproject.toml needs another version of pymeshlab-fcd"
grep -q "^## $version" CHANGELOG.md || fail "CHANGELOG.md has no section $version"
[ -z "$(git status --porcelain)" ] || left_out "a release of what is committed: there are changes that are not (git status)"

if [ "${1:-}" != --built ]; then
    [ $# = 0 ] || fail "usage: bash tests/release.sh [--built]"
    bash tests/setup.sh all
    bash tests/python_package.sh
    bash tests/python_package.sh release
fi
rm -rf "$dist" "$work"
mkdir -p "$dist" "$work"

# --- sources: what is committed, whose library builds and is found -----------------------------------------------------------
source=$dist/fcd-$version-source.tar.gz
git archive --format=tar.gz --prefix="fcd-$version/" -o "$source" HEAD
built "$source"
tar -xf "$source" -C "$work"
fresh=$work/fcd-$version
cmake -G Ninja -S "$fresh" -B "$work/method" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER=clang++ >"$work/source.log"
nice ninja -C "$work/method" -j "${FCD_JOBS:-$(nproc)}" >>"$work/source.log" || fail "the sources do not build (log: $work/source.log)"
cmake --install "$work/method" --prefix "$work/prefix" >>"$work/source.log"
# bends PREFIX: the program of examples/bend_arrays finds the library there, and bends.
bends() {
    rm -rf "$work/bend_arrays"
    cmake -G Ninja -S "$fresh/examples/bend_arrays" -B "$work/bend_arrays" -DCMAKE_PREFIX_PATH="$1" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache >>"$work/source.log"
    nice ninja -C "$work/bend_arrays" >>"$work/source.log"
    "$work/bend_arrays/bend_arrays" | grep -q 'moved by up to 3.162'
}
bends "$work/prefix" || fail "a program does not find, or bend with, the library that is built from the sources"
proved "the sources: built, installed, and found by a program"

# --- the manual ------------------------------------------------------------------------------------------------------------
"$build/venv-tools/bin/mkdocs" build --strict --quiet --config-file "$fresh/mkdocs.yml" --site-dir "$work/manual" 2>"$work/manual.log" ||
    fail "the manual does not build: $(tail -n 1 "$work/manual.log")"
manual=$dist/fcd-$version-manual.zip
(cd "$work" && python3 -m zipfile -c "$manual" manual)
built "$manual"
rm -rf "$work/read"
python3 -m zipfile -e "$manual" "$work/read"
[ "$(find "$work/read/manual" -name index.html | wc -l)" -gt 30 ] || fail "the manual lacks pages"
proved "the manual: built from the sources, its links checked"

# --- plugins ---------------------------------------------------------------------------------------------------------------
script='
import sys, pymeshlab
pymeshlab.load_plugin(sys.argv[1])
ms = pymeshlab.MeshSet()
ms.load_new_mesh(sys.argv[2])
result = ms.apply_filter("generate_fcd_deformed_mesh", handles=3, tag_file=sys.argv[3], transforms="2: translate 3 0 0")
assert result["converged"] and abs(ms.current_mesh().vertex_matrix() - ms.mesh(0).vertex_matrix()).max() > 2.9'
for host in pymeshlab-2025.7 pymeshlab-2022.2 meshlab-2020.09 meshlab-2022.02 meshlab-2025.07; do
    plugins=("$build/plugins/$host"/lib*_fcd.so)
    if [ ! -e "${plugins[0]}" ]; then
        left_out "the plugins for $host: build/plugins/$host is not there"
        continue
    fi
    archive=$dist/fcd-$version-$host-linux-x86-64.zip
    folder=$work/$host
    mkdir -p "$folder"
    cp "${plugins[@]}" "$folder"
    cp LICENSE "$folder/LICENSE.txt"
    (cd "$folder" && python3 -m zipfile -c "$archive" ./*)
    built "$archive"
    rm -rf "$folder"
    python3 -m zipfile -e "$archive" "$folder"
    case $host in
    pymeshlab-*)
        environment=$build/venv
        [ "$host" = pymeshlab-2025.7 ] || environment=$build/venv-2022
        (cd "$folder" && "$environment/bin/python" -c "$script" "$folder/libfilter_fcd.so" "$fresh/meshes/cylinder.ply" "$fresh/meshes/cylinder.sel") ||
            fail "the plugin of $archive does not bend in $host"
        proved "$host: loaded from the zip, and bends a mesh"
        ;;
    meshlab-2020.09)
        # A folder beside a copy of the program, with the system's plugins and these two.
        system=/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)/meshlab
        mkdir -p "$folder/plugins"
        ln -s "$system"/plugins/*.so "$folder/plugins"
        ln -sf "$folder"/lib*_fcd.so "$folder/plugins"
        cp /usr/bin/meshlabserver "$folder/meshlabserver"
        printf '%s\n' '<!DOCTYPE FilterScript>' '<FilterScript><filter name="FCD: Build Deformation Graph">' \
            '<Param type="RichAbsPerc" name="target_radius" value="0" min="0" max="100"/>' '<Param type="RichInt" name="initial_patches" value="100"/>' \
            '<Param type="RichInt" name="max_iterations" value="100"/>' '<Param type="RichInt" name="random_seed" value="1"/>' \
            '<Param type="RichBool" name="patches_layer" value="true"/>' '</filter></FilterScript>' >"$folder/script.mlx"
        (cd "$folder" && LD_LIBRARY_PATH=$system xvfb-run -a ./meshlabserver -i "$fresh/meshes/cylinder.ply" -s script.mlx -o out.ply) >"$folder/log" 2>&1 || true
        [ -s "$folder/out.ply" ] || fail "the plugin of $archive makes no graph in $host (log: $folder/log)"
        proved "$host: loaded from the zip by meshlabserver, and makes a graph of a mesh"
        ;;
    *) left_out "$host in its window: run bash tests/windows.sh" ;;
    esac
done

# --- Python packages ---------------------------------------------------------------------------------------------------------
for wheel in "$build"/python/dist/pymeshlab_fcd*.whl "$build"/python/dist/*.tar.gz; do
    if [ ! -e "$wheel" ]; then
        left_out "$(basename "$wheel"): build/python/dist has none (bash tests/python_package.sh, then the same with release)"
        continue
    fi
    cp "$wheel" "$dist"
    built "$dist/$(basename "$wheel")"
done
for wheel in "$dist"/pymeshlab_fcd-*.whl; do
    [ -e "$wheel" ] || continue
    rm -rf "$work/venv"
    /usr/bin/python3 -m venv "$work/venv"
    "$work/venv/bin/pip" install --disable-pip-version-check --quiet "$wheel"
    (cd "$work" && venv/bin/python -c '
from pymeshlab_fcd import Deformer, Motion, __version__
from pymeshlab_fcd.samples import strip
pose = Deformer(*strip()).pose({2: Motion.translate([0, 0, 3])})
assert pose.info.converged and __version__ == "'"$version"'"') || fail "$wheel does not bend"
    bends "$(cd "$work" && venv/bin/python -m pymeshlab_fcd.cmake)" || fail "$wheel has no library that a program finds"
    proved "$(basename "$wheel"): installed into a fresh environment, bends, and a C++ program finds its library"
done
for wheel in "$dist"/pymeshlab_fcd_plugin-*.whl; do
    { [ -e "$wheel" ] && [ -e "$work/venv" ]; } || continue
    "$work/venv/bin/pip" install --disable-pip-version-check --quiet --no-deps "$wheel"
    "$build/venv/bin/python" -c 'import site; print(site.getsitepackages()[0])' >"$(echo "$work"/venv/lib/python*/site-packages)/venv.pth" # pymeshlab
    (cd "$work" && venv/bin/python -c '
import pymeshlab, pymeshlab_fcd_plugin
from pymeshlab_fcd.samples import strip
vertices, faces, tags = strip()
ms = pymeshlab.MeshSet()
ms.add_mesh(pymeshlab.Mesh(vertices, faces, v_scalar_array=tags.astype(float)))
ms.generate_fcd_deformed_mesh(translation=[0, 0, 3])
assert abs(ms.current_mesh().vertex_matrix() - vertices).max() > 2.9') || fail "$wheel does not bend in pymeshlab"
    proved "$(basename "$wheel"): installed beside it, its filters are methods of pymeshlab"
done
[ "${1:-}" != --built ] || left_out "the source distribution: bash tests/python_package.sh release installs and tests it"

# --- sums ----------------------------------------------------------------------------------------------------------------------
(cd "$dist" && sha256sum -- * >"$work/SHA256SUMS" && mv "$work/SHA256SUMS" . && sha256sum --check --quiet SHA256SUMS)
echo "made    SHA256SUMS of $(wc -l <"$dist/SHA256SUMS") files"

cat <<EOT

Not proved on this machine:
$(printf -- '- %s\n' "${left[@]}")
- wheels for ARM, macOS and Windows, and the zips for the MeshLab of Windows, macOS and the AppImage: the workflows make them

What a person has to do:
1. Once: on pypi.org, name this repository, the workflow wheels.yml and the environment pypi as a trusted publisher of
   pymeshlab-fcd and of pymeshlab-fcd-plugin.
2. In CHANGELOG.md, write the date instead of "not released" at $version, and commit.
3. git tag v$version && git push origin v$version: wheels.yml publishes the packages, plugins.yml makes a release with its zips.
4. Add what is in dist/ to that release: gh release upload v$version dist/*
5. For MeshLab's own tree: bash tests/pull_request.sh CHECKOUT, and what that says at its end.
EOT
