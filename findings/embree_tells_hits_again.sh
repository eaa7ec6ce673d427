#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/embree_tells_hits_again.sh
#
# Embree 3.13.5 (Debian 12): a filter of a packet of rays that ask for occlusion, and that are said to be coherent, is
# called once for each hit where all of them go into the same octant; else, for the same hit, once for every octant that
# any of them goes into, though it refuses the hit each time. So a product over all hits, as of what transparent meshes let
# through, comes out too dark, and only where rays diverge. Rays that are said to be incoherent, and rays that ask for the
# first hit, have each hit once.
#
# Seen, for eight rays into four octants through two triangles:
#   first hit, incoherent: 16 hits, told of one at most 1 times
#   first hit, coherent: 16 hits, told of one at most 1 times
#   occlusion, incoherent: 16 hits, told of one at most 1 times
#   occlusion, coherent: 16 hits, told of one at most 4 times
#
# Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get -qq -o APT::Sandbox::User=root download libembree-dev=3.13.5+dfsg-2 libembree3-3=3.13.5+dfsg-2 libtbb12
for package in "$folder"/*.deb; do
    dpkg -x "$package" "$folder"
done
cat >"$folder/hits.cpp" <<'CPP'
#include <embree3/rtcore.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

using Calls = std::map<std::pair<unsigned, unsigned>, int>; // by ray and triangle

struct Asking {
    RTCIntersectContext context;
    Calls *calls;
};

void refuse(const RTCFilterFunctionNArguments *a) {
    for (unsigned i = 0; i < a->N; ++i) {
        if (a->valid[i] != 0) {
            ++(*reinterpret_cast<const Asking *>(a->context)->calls)[{RTCRayN_id(a->ray, a->N, i),
                                                                     RTCHitN_primID(a->hit, a->N, i)}];
            a->valid[i] = 0;
        }
    }
}

int main() {
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    RTCGeometry triangles = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const float corners[] = {-9, -9, 0, 9, -9, 0, 0, 9, 0, -9, -9, 1, 9, -9, 1, 0, 9, 1};
    std::copy_n(corners, 18, static_cast<float *>(rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0,
                                                                          RTC_FORMAT_FLOAT3, 12, 7)));
    const unsigned numbers[] = {0, 1, 2, 3, 4, 5};
    std::copy_n(numbers, 6, static_cast<unsigned *>(rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0,
                                                                            RTC_FORMAT_UINT3, 12, 2)));
    rtcCommitGeometry(triangles);
    rtcAttachGeometry(scene, triangles);
    rtcCommitScene(scene);
    for (int kind = 0; kind < 4; ++kind) {
        const bool occlusion = kind >= 2, coherent = kind % 2 == 1;
        RTCRayHit8 rays{};
        alignas(32) int valid[8];
        for (int i = 0; i < 8; ++i) {
            valid[i] = -1;
            rays.ray.org_z[i] = -5.0F;
            rays.ray.dir_x[i] = i % 2 == 0 ? 0.1F : -0.1F; // into four octants
            rays.ray.dir_y[i] = i % 4 < 2 ? 0.1F : -0.1F;
            rays.ray.dir_z[i] = 1.0F;
            rays.ray.tfar[i] = 100.0F;
            rays.ray.mask[i] = ~0U;
            rays.ray.id[i] = static_cast<unsigned>(i);
            rays.hit.geomID[i] = rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        Calls calls;
        Asking asking{};
        rtcInitIntersectContext(&asking.context);
        asking.calls = &calls;
        asking.context.filter = refuse;
        asking.context.flags =
            coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
        occlusion ? rtcOccluded8(valid, scene, &asking.context, &rays.ray)
                  : rtcIntersect8(valid, scene, &asking.context, &rays);
        int most = 0;
        for (const auto &[hit, count] : calls) {
            most = std::max(most, count);
        }
        std::printf("%s, %s: %zu hits, told of one at most %d times\n", occlusion ? "occlusion" : "first hit",
                    coherent ? "coherent" : "incoherent", calls.size(), most);
    }
}
CPP
libraries=$folder/usr/lib/$(gcc -print-multiarch)
g++ -std=c++17 -O1 -I"$folder/usr/include" "$folder/hits.cpp" -o "$folder/hits" -L"$libraries" -l:libembree3.so.3
LD_LIBRARY_PATH=$libraries "$folder/hits" | tee "$folder/seen"
diff "$folder/seen" - <<'SEEN'
first hit, incoherent: 16 hits, told of one at most 1 times
first hit, coherent: 16 hits, told of one at most 1 times
occlusion, incoherent: 16 hits, told of one at most 1 times
occlusion, coherent: 16 hits, told of one at most 4 times
SEEN
