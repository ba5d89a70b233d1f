#!/usr/bin/env bash
# The library as others take it: installed into a folder of its own, found there by find_package, and compiled along in the
# project of somebody else. Each way, examples/bend_mesh is built and bends a mesh, to the same bits. Says how long a program of
# thirty lines takes to compile. Needs what `bash tests/setup.sh sources` makes.
#
#   bash tests/package.sh [FOLDER]      where it is built; build/package by default
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/package}
vcglib=${XDG_CACHE_HOME:-$HOME/.cache}/fcd/vcglib
common=(-G Ninja -DCMAKE_CXX_COMPILER=g++ -DCMAKE_CXX_COMPILER_LAUNCHER=ccache "-DFCD_VCGLIB=$vcglib")
rm -rf "$build/installed" "$build/found" "$build/along"

# As the window's plugin has it, so that the compiler cache has most of it.
cmake -S "$root" -B "$build/method" "${common[@]}" >/dev/null
ninja -C "$build/method" -j 1 --quiet
cmake --install "$build/method" --prefix "$build/installed" >/dev/null
for file in include/fcd/vcg_ext/deformer.h include/fcd/vcg_ext/base/graph.h; do
    [ -e "$build/installed/$file" ] || { echo "error: $file is not installed"; exit 1; }
done
(cd "$build/installed" && ! grep -rlE "$root" --include='*.cmake' .) || { echo "error: the package names the folder it was built in"; exit 1; }

# CPU seconds of the compiler alone, without a cache.
cat >"$build/timed" <<'EOT'
#!/usr/bin/env bash
TIMEFORMAT='a program of thirty lines compiles in %U CPU seconds'
case $* in *bend_mesh.cpp) time "$@" ;; *) "$@" ;; esac
EOT
chmod +x "$build/timed"
cmake -S "$root/examples/bend_mesh" -B "$build/found" "${common[@]}" "-DCMAKE_CXX_COMPILER_LAUNCHER=$build/timed" \
    "-DCMAKE_PREFIX_PATH=$build/installed" >/dev/null
ninja -C "$build/found" -j 1
cmake -S "$root/examples/bend_mesh" -B "$build/along" "${common[@]}" "-DFCD_SOURCE=$root" >/dev/null
ninja -C "$build/along" -j 1 --quiet
for way in found along; do
    "$build/$way/bend_mesh" "$root/meshes/cylinder.ply" "$build/$way/bent.ply"
done
cmp "$build/found/bent.ply" "$build/along/bent.ply"
if cmp -s "$build/found/bent.ply" "$root/meshes/cylinder.ply"; then
    echo "error: nothing is bent"
    exit 1
fi
