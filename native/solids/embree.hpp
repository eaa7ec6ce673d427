// SPDX-License-Identifier: GPL-3.0-or-later
// Embree 3 (Debian 12) and 4 (later): one spelling for the calls that changed between them.
#pragma once

#include <limits>

#include <glm/vec3.hpp>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace sfumato {

// What Embree calls a filter with, for each hit: who asks is known by where its context lies.
struct Asking {
#if RTC_VERSION_MAJOR >= 4
    RTCRayQueryContext context;
#else
    RTCIntersectContext context;
#endif
    void *who = nullptr;
};

// Scenes in which filters are heard, and in which no ray slips through between two triangles.
#if RTC_VERSION_MAJOR >= 4
constexpr int HEARD = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
#else
constexpr int HEARD = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
#endif
constexpr auto FILTERED = static_cast<RTCSceneFlags>(HEARD | static_cast<int>(RTC_SCENE_FLAG_ROBUST));

// One packet of rays, `Lanes` wide, against a scene: the first hit, or whether anything is hit at all; or, by a filter
// that refuses them, all hits in any order. Coherent rays are faster; but among instances Embree 3.13 never comes back
// from coherent packets that ask for occlusion, and tells a filter of each hit again for each octant they go into.
template <int Lanes>
struct Rays;

#if RTC_VERSION_MAJOR >= 4
#define SFUMATO_RAYS(LANES)                                                                                            \
    template <>                                                                                                        \
    struct Rays<LANES> {                                                                                               \
        using RayHit = RTCRayHit##LANES;                                                                               \
        using Ray = RTCRay##LANES;                                                                                     \
        static void intersect(const int *valid, RTCScene scene, bool, RayHit &rays) {                                  \
            rtcIntersect##LANES(valid, scene, &rays, nullptr);                                                         \
        }                                                                                                              \
        static void occluded(const int *valid, RTCScene scene, bool, Ray &rays) {                                      \
            rtcOccluded##LANES(valid, scene, &rays, nullptr);                                                          \
        }                                                                                                              \
        static void filtered(const int *valid, RTCScene scene, Ray &rays, RTCFilterFunctionN filter, void *who) {      \
            Asking asking;                                                                                             \
            rtcInitRayQueryContext(&asking.context);                                                                   \
            asking.who = who;                                                                                          \
            RTCOccludedArguments arguments;                                                                            \
            rtcInitOccludedArguments(&arguments);                                                                      \
            arguments.context = &asking.context;                                                                       \
            arguments.filter = filter;                                                                                 \
            arguments.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;                                               \
            rtcOccluded##LANES(valid, scene, &rays, &arguments);                                                       \
        }                                                                                                              \
    };
#else
#define SFUMATO_RAYS(LANES)                                                                                            \
    template <>                                                                                                        \
    struct Rays<LANES> {                                                                                               \
        using RayHit = RTCRayHit##LANES;                                                                               \
        using Ray = RTCRay##LANES;                                                                                     \
        static void intersect(const int *valid, RTCScene scene, bool coherent, RayHit &rays) {                         \
            RTCIntersectContext context;                                                                               \
            rtcInitIntersectContext(&context);                                                                         \
            context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;    \
            rtcIntersect##LANES(valid, scene, &context, &rays);                                                        \
        }                                                                                                              \
        static void occluded(const int *valid, RTCScene scene, bool coherent, Ray &rays) {                             \
            RTCIntersectContext context;                                                                               \
            rtcInitIntersectContext(&context);                                                                         \
            context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;    \
            rtcOccluded##LANES(valid, scene, &context, &rays);                                                         \
        }                                                                                                              \
        static void filtered(const int *valid, RTCScene scene, Ray &rays, RTCFilterFunctionN filter, void *who) {      \
            Asking asking;                                                                                             \
            rtcInitIntersectContext(&asking.context);                                                                  \
            asking.who = who;                                                                                          \
            asking.context.filter = filter;                                                                            \
            asking.context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;                                              \
            rtcOccluded##LANES(valid, scene, &asking.context, &rays);                                                  \
        }                                                                                                              \
    };
#endif

// The distance to the first hit of one ray, infinite where there is none.
inline float first_hit(RTCScene scene, const glm::vec3 &origin, const glm::vec3 &direction) {
    constexpr float INFINITE = std::numeric_limits<float>::infinity();
    RTCRayHit ray{};
    ray.ray.org_x = origin.x;
    ray.ray.org_y = origin.y;
    ray.ray.org_z = origin.z;
    ray.ray.dir_x = direction.x;
    ray.ray.dir_y = direction.y;
    ray.ray.dir_z = direction.z;
    ray.ray.tfar = INFINITE;
    ray.ray.mask = 0xFFFFFFFFU;
    ray.ray.time = 0.5F; // the shutter's middle
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(scene, &ray, nullptr);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &ray);
#endif
    return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? INFINITE : ray.ray.tfar;
}

SFUMATO_RAYS(4)
SFUMATO_RAYS(8)
SFUMATO_RAYS(16)
#undef SFUMATO_RAYS

} // namespace sfumato
