#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/streamed_grids_have_no_plain_name.sh
#
# OpenVDB (10.0.1 of Debian 12): in a file with two grids of one name that was written by io::Stream, File::hasGrid(name)
# is true and File::readGrid(name) throws KeyError. Written by io::File, the same two grids are found, and the first is
# read. "name[0]" is read of both. So a program that asks hasGrid first, as ours did, still fails on some valid files.
#
# Seen:
#   File: hasGrid true, readGrid reads 1
#   Stream: hasGrid true, readGrid throws KeyError, readGrid of [0] reads 1
#
# Needs g++ and libopenvdb-dev. Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat >"$folder/names.cpp" <<'CPP'
#include <cassert>
#include <fstream>
#include <iostream>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

static float read(openvdb::io::File &file, const char *name) {
    return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name))->tree().getValue({0, 0, 0});
}

int main(int, char **arguments) {
    openvdb::initialize();
    openvdb::GridPtrVec grids;
    for (const float value : {1.0F, 2.0F}) {
        const auto grid = openvdb::FloatGrid::create();
        grid->setName("density");
        grid->tree().setValue({0, 0, 0}, value);
        grids.push_back(grid);
    }
    const std::string seekable = std::string(arguments[1]) + "/file.vdb", streamed = seekable + ".streamed";
    openvdb::io::File(seekable).write(grids);
    {
        std::ofstream stream(streamed, std::ios::binary);
        openvdb::io::Stream(stream).write(grids);
    }
    openvdb::io::File first(seekable), second(streamed);
    first.open();
    second.open();
    assert(first.hasGrid("density") && second.hasGrid("density"));
    const float one = read(first, "density"), other = read(second, "density[0]");
    std::cout << "File: hasGrid true, readGrid reads " << one << '\n';
    bool threw = false;
    try {
        read(second, "density");
    } catch (const openvdb::KeyError &) {
        threw = true;
    }
    assert(threw);
    std::cout << "Stream: hasGrid true, readGrid throws KeyError, readGrid of [0] reads " << other << '\n';
}
CPP
g++ -std=c++17 "$folder/names.cpp" -o "$folder/names" -lopenvdb -ltbb -lImath-3_1
"$folder/names" "$folder" | sed -E 's/\x1b\[[0-9;]*m//g; / WARN: /d' # it warns of the name that there is twice
