# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What tests/run, tests/matrix and blend_samples/render share: the packages, the build and Blender's folders. Sourced.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build
# What is costly to make and the same for every clone; computed here, since use_built_addon changes XDG_CACHE_HOME.
cache=${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/sfumato

# The one list of packages, the same for Debian 12, 13 and sid. libopenvdb-dev and libblosc-dev are for tests, and
# libboost-dev is for OpenVDB 10's headers; python3-cattr and python3-requests are what the scripts of Debian's Blender
# 5.2 import and its package does not ask for.
# shellcheck disable=SC2034 # read by the scripts that source this file
packages=(
    blender xvfb xauth libgl1-mesa-dri libegl1
    g++ cmake ninja-build pybind11-dev python3-dev
    libglm-dev libxsimd-dev libxxhash-dev libtbb-dev libembree-dev
    zlib1g-dev liblz4-dev libopenimageio-dev libopenvdb-dev libblosc-dev libboost-dev
    libgtest-dev python3-pytest python3-numpy python3-cattr python3-requests
)

say() { printf '\n== %s\n' "$*"; }

# Print the text at the head of the calling script: every line up to the first that is no comment.
usage() { sed -nE '3,/^[^#]|^$/s/^# ?//p' "$0"; }

install_missing() {
    local package missing=() size log=$build/logs/packages.log
    for package in "$@"; do
        [[ $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) == installed ]] || missing+=("$package")
    done
    ((${#missing[@]})) || return 0
    if ((EUID)); then
        echo "Only root can install packages. Run: apt-get install --no-install-recommends ${missing[*]}" >&2
        return 1
    fi
    apt-get update -qq
    size=$(LC_ALL=C apt-get install --assume-no --no-install-recommends "${missing[@]}" 2>/dev/null |
        sed -nE 's/^Need to get ([0-9.,]+ .?B).*/\1/p') || true # it says no, as it is told to
    say "Installing ${missing[*]} and what they need: ${size:-?} to fetch, a few minutes; messages in $log"
    mkdir -p "$build/logs"
    DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "${missing[@]}" >"$log" 2>&1 ||
        { tail -n 20 "$log" >&2 && return 1; }
}

# build_targets NAME...: `addon`, test programs, or `all`.
build_targets() {
    say "Building in $build"
    (cd "$root" && cmake --preset dev)
    cmake --build "$build" --target "$@"
}

# place_of NAME RECIPE: where `cached` keeps what is made so.
place_of() { echo "$cache/$1-$(sha256sum <<<"$2" | head -c 12)"; }

# cached NAME RECIPE COMMAND...: set `cached` to a folder that COMMAND FOLDER has filled, once for all clones: its place
# is named by the hash of RECIPE. It is made beside its place and moved there when it is complete, so that one that is
# there is whole; whoever comes while it is made waits.
cached() {
    local part place
    place=$(place_of "$1" "$2")
    part=$place.part
    shift 2
    mkdir -p "$cache"
    if [[ ! -e $place ]]; then
        # shellcheck disable=SC2094 # the lock is no file that is read
        (
            flock 9
            [[ ! -e $place ]] || exit 0
            rm -rf --one-file-system "$part" && mkdir "$part" && "$@" "$part" 9>&- && mv "$part" "$place"
        ) 9>"$place.lock" || return 1
    fi
    # shellcheck disable=SC2034 # read by the caller
    cached=$place
}

# From here on Blender keeps its preferences, caches and temporary files in build/, and finds the built add-on there.
# Blender is the one that the PATH shows first; but /usr/bin is first for it, since Debian's Blender takes the folders of
# the first python3.11 (its own version) there, and finds no NumPy where that is another one's, such as conda's.
use_built_addon() {
    # shellcheck disable=SC2034 # read by the scripts that source this file
    blender=$(type -P blender)
    export PATH=/usr/bin:$PATH
    local home=$build/blender
    mkdir -p "$home"/{config,scripts/addons,datafiles,extensions,cache,tmp}
    ln -sfn "$build/addon/sfumato" "$home/scripts/addons/sfumato"
    export BLENDER_USER_RESOURCES=$home BLENDER_USER_CONFIG=$home/config BLENDER_USER_SCRIPTS=$home/scripts
    export BLENDER_USER_DATAFILES=$home/datafiles BLENDER_USER_EXTENSIONS=$home/extensions
    export XDG_CACHE_HOME=$home/cache TMPDIR=$home/tmp
}

# Counts, added up over everything that ran.
passed=0 failed=0 skipped=0
# What failed, and the lines that say why: repeated before the totals, since the beginning of a long log is seldom read.
failures=

# number WHAT LINE: the number before WHAT. count LINE: add what the line says passed, failed and was skipped. A failure
# that pytest expected, by its size, is a test passed.
number() { { grep -oE "[0-9]+ ($1)" <<<"$2" || echo 0; } | awk '{ n += $1 } END { print n }'; }
count() {
    passed=$((passed + $(number 'passed|xfailed' "$1")))
    failed=$((failed + $(number 'failed|error' "$1")))
    skipped=$((skipped + $(number skipped "$1")))
}

# Tests run in a process group of their own, which Ctrl-C does not reach, so pass the wish to stop on.
running=
trap '[[ ! $running ]] || kill "$running" 2>/dev/null; exit 130' INT TERM

# run_counted NAME SECONDS COMMAND...: run a test program, show and keep its output, and count what it says it ran.
# A program that fails without naming a failed test, or that names no test at all, is itself one failure.
run_counted() {
    local name=$1 limit=$2 log=$build/logs/$1.log line output tee status=0
    shift 2
    say "$name"
    mkdir -p "$build/logs"
    exec {output}> >(tee "$log")
    tee=$!
    timeout --kill-after 10 "$limit" "$@" >&"$output" 2>&1 {output}>&- &
    running=$!
    exec {output}>&-
    wait "$running" || status=$?
    running=
    wait "$tee"
    line=$(result_line "$log")
    local before=$failed
    count "$line"
    if [[ ! $line =~ [1-9][0-9]*\ (passed|xfailed|failed|skipped|error) ]] || ((status && $(number 'failed|error' "$line") == 0)); then
        ((status != 124)) || echo "$name: stopped after $limit s"
        echo "$name: ended with status $status; this counts as one failure"
        failed=$((failed + 1))
    fi
    ((failed == before)) || failures+=$'\n'"In $name:"$'\n'$(failures_in "$log")$'\n'
}

# Of a log, what its own summary repeats of failed tests; else the lines that name them, and those before.
failures_in() {
    sed -n '1,/^== failed$/d; /^[0-9]* passed, /d; /./p' "$1" | grep . && return
    grep -aE -B 9 '^(failed test_|FAILED |\[  FAILED  \] \w+\.)' "$1" | cut -c 1-200 | tail -n 60 || true
}

# The totals in a log: our own last line, or GoogleTest's "[  PASSED  ] 3 tests." as "3 passed", or pytest's last line.
result_line() {
    local ours='^[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$' google
    tail -n 1 "$1" | grep -E "$ours" && return
    google=$(sed -nE 's/^\[ +(PASSED|FAILED|SKIPPED) +\] ([0-9]+) tests?[.,].*/\2 \L\1/p' "$1" | paste -sd ' ')
    [[ ! $google ]] || { echo "$google" && return; }
    grep -E '[0-9]+ (passed|xfailed|failed|skipped|errors?)' "$1" | tail -n 1 || true
}

# The last lines of every script that tests, and its exit status.
summary() {
    [[ ! $failures ]] || printf '\n== failed\n%s' "$failures"
    printf '\n%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
    ((failed == 0 && passed > 0))
}
