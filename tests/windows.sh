#!/usr/bin/env bash
# The scripted mouse of tests/host_edit*.py in the windows of MeshLab 2022.02 and 2025.07, which this Debian does not have: they run
# in chroots of the suites that have them, made by debootstrap and kept in FCD_CHROOTS
# (${XDG_CACHE_HOME:-~/.cache}/fcd/chroots). Needs root; the chroots take two minutes and 1.6 GB, the tests eleven minutes a window.
#
#   bash tests/windows.sh [2022.02|2025.07]
set -Eeuo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build
chroots=${FCD_CHROOTS:-${XDG_CACHE_HOME:-$HOME/.cache}/fcd/chroots}
[ "$(id -u)" = 0 ] || {
    echo "only root can make a chroot and start a program in it" >&2
    exit 1
}
FCD_PACKAGES="debootstrap debian-archive-keyring fonts-dejavu-core" bash "$root/tests/setup.sh"
mkdir -p "$chroots" "$build/windows"
log=$build/windows/chroot.log
trap 'tail -n 5 "$log" >&2' ERR

# The archive this machine itself gets bookworm from.
archive() {
    apt-get indextargets --format '$(REPO_URI) $(CODENAME)' 'Created-By: Packages' | awk '$2 == "bookworm" { print $1; exit }'
}

# within FOLDER COMMAND...: runs a program in a chroot that has this machine's devices and /tmp, with the X sockets and the tests' folders.
# The mounts are the program's own, and go with it; it keeps the number of the process.
within() {
    exec unshare --mount bash -ec 'mount --bind /dev "$0/dev"
        mount --bind /tmp "$0/tmp"
        mount -t proc proc "$0/proc"
        exec chroot "$0" "$@"' "$@"
}

# suite NAME: a chroot with MeshLab. Its recommended packages are the libraries of its plugins; one that lacks them stops with a message.
suite() {
    local folder=$chroots/$1 part=$chroots/$1.part uri
    [ ! -d "$folder" ] || return 0
    uri=$(archive)
    if [ -z "$uri" ]; then
        apt-get update -o Acquire::Retries=3
        uri=$(archive)
    fi
    rm -rf --one-file-system "$part"
    debootstrap --variant=minbase "$1" "$part" "$uri"
    (within "$part" env DEBIAN_FRONTEND=noninteractive bash -ec '
        options="-o APT::Sandbox::User=root -o Acquire::Check-Valid-Until=false -o Acquire::Languages=none -o Acquire::Retries=3"
        apt-get $options update
        libraries=$(apt-cache depends meshlab | awk "/Recommends:/ && !other { print \$2 } { other = /^ \|/ }")
        apt-get $options install -y --no-install-recommends meshlab libgl1-mesa-dri fonts-dejavu-core $libraries
        apt-get clean')
    mv "$part" "$folder"
}

failed=0
for version in ${1:-2022.02 2025.07}; do
    case $version in
    2022.02) name=trixie ;;
    2025.07) name=sid ;;
    *)
        echo "there is no window for $version: 2022.02 or 2025.07" >&2
        exit 1
        ;;
    esac
    echo "== MeshLab $version"
    suite "$name" >"$log" 2>&1
    found=$(chroot "$chroots/$name" dpkg-query -W -f '${Version}' meshlab)
    [[ $found == "$version"* ]] || {
        echo "$name has MeshLab $found" >&2
        exit 1
    }
    DESTDIR=$chroots/$name cmake --install "$build/cmake/meshlab-$version" >"$log"

    program=$build/windows/meshlab-$version
    {
        echo '#!/usr/bin/env bash'
        declare -f within
        printf 'within %q meshlab "$@"\n' "$chroots/$name"
    } >"$program"
    chmod +x "$program"
    FCD_MESHLABSERVER=$build/meshlab-2020.09/meshlabserver FCD_MESHLAB=$program FCD_MESHLAB_VERSION=$version TMPDIR=/tmp \
        LIBGL_ALWAYS_SOFTWARE=1 "$build/venv/bin/python" -m pytest -q -ra -p no:cacheprovider "$root"/tests/host_edit*.py || failed=1
done
exit "$failed"
