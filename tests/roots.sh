# shellcheck shell=bash disable=SC2016,SC2154 # the single quotes are meant; setup.sh sets root, build and packages
# SPDX-License-Identifier: GPL-3.0-or-later
# What tests/matrix and tests/official share: roots of newer Debians. Sourced, after setup.sh.

# What follows runs with mounts and processes of its own, which the kernel takes away when it ends, however it ends. So
# no mount ever shows in a root from outside, and deleting a root cannot reach through one.
apart=(unshare --mount --propagation private --pid --fork --kill-child)

# "${inside[@]}" TOP TREE COMMAND...: run it inside the root, with TREE as /sfumato, a /tmp of its own, and the host's
# network settings and certificates.
inside=("${apart[@]}" bash -euc '
    mkdir -p "$0/etc/ssl/certs"
    cp -L /etc/ssl/certs/ca-certificates.crt "$0/etc/ssl/certs/"
    cp -L /etc/resolv.conf /etc/hosts "$0/etc/"
    mkdir -p "$0/sfumato"
    mount --rbind "$1" "$0/sfumato"
    shift
    mount -t tmpfs tmp "$0/tmp"
    mount --rbind /dev "$0/dev"
    mount -t proc proc "$0/proc"
    mount -t sysfs sys "$0/sys"
    exec chroot "$0" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 \
        DEBIAN_FRONTEND=noninteractive ${http_proxy+http_proxy="$http_proxy"} ${https_proxy+https_proxy="$https_proxy"} \
        ${CMAKE_BUILD_PARALLEL_LEVEL+CMAKE_BUILD_PARALLEL_LEVEL="$CMAKE_BUILD_PARALLEL_LEVEL"} "$@"')

# quietly NAME COMMAND...: its thousands of lines go to a log, and the last of them here only when it fails.
quietly() {
    local log=$build/logs/$1.log
    shift
    mkdir -p "$build/logs"
    "$@" >"$log" 2>&1 || { tail -n 20 "$log" && return 1; }
}

# make_root NAME TOP: Debian and our packages, from the host's mirror, in the folder TOP.
make_root() {
    local name=$1 top=$2 mirror
    say "$name: making the root, about half a minute" &&
        mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Label: Debian' | sed -n 1p) &&
        quietly "$name-base" "${apart[@]}" debootstrap --variant=minbase "$name" "$top" "$mirror" &&
        cp -r /etc/apt/apt.conf.d /etc/apt/auth.conf.d "$top/etc/apt/" &&
        say "$name: installing ${#packages[@]} packages and what they need, about two minutes" &&
        "${inside[@]}" "$top" "$top/mnt" apt-get update -qq &&
        quietly "$name-packages" "${inside[@]}" "$top" "$top/mnt" \
            apt-get install -qq -y --no-install-recommends -o Dpkg::Options::=--force-unsafe-io "${packages[@]}"
}

# copy_sources TREE: the files of the working tree, tracked or new but not ignored, in place of the last copy's. What was
# built there stays, and times are kept, so that only changes are built again.
copy_sources() {
    local tree=$1
    mkdir -p "$tree"
    find "$tree" -mindepth 1 -maxdepth 1 ! -name build -exec rm -rf --one-file-system {} +
    git -C "$root" -c safe.directory='*' ls-files -z --cached --others --exclude-standard |
        tar -C "$root" --null --files-from - --ignore-failed-read -c | tar -C "$tree" -x
}

root_recipe() { echo "${packages[*]} $(declare -f make_root) ${inside[*]}"; }

# use_root NAME: set `cached` to the root of trixie (Debian 13) or sid, made if it is not there.
use_root() {
    install_missing debootstrap debian-archive-keyring
    "${apart[@]}" true || { echo "$(basename "$0") needs root and the right to mount" >&2 && return 1; }
    cached "$1" "$(root_recipe)" make_root "$1"
}
