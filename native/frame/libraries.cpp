// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/libraries.hpp"

#include "scene/scene.hpp"
#include "solids/surfaces.hpp"

#include <cmath>
#include <new>
#include <span>
#include <stdexcept>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/version.h>

namespace sfumato {
namespace {

// Newer ones of the same major version keep their promises to what was compiled for an older one.
std::string version_problem(const std::string &library, long compiled, long running, long major) {
    if (running >= compiled && running / major == compiled / major) {
        return {};
    }
    return library + " answers as version " + std::to_string(running) + ", but this was made for " +
           std::to_string(compiled) + ": another program's library has taken the place of its own";
}

// One ray against one triangle.
std::string ray_problem() {
    constexpr float DISTANCE = 3.0F;
    Instances triangle;
    Shape shape;
    shape.vertices = {{0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
    shape.triangles = {{0U, 1U, 2U}};
    triangle.shape = std::make_shared<const Shape>(std::move(shape));
    triangle.to_world = {glm::mat4(1.0F)};
    Solids solids(1);
    const std::shared_ptr<const Places> places =
        solids.places(Divided(std::span(&triangle, 1), solids.parts()), {true});
    const float hit = first_hit(places->scene.get(), {0.25F, 0.25F, DISTANCE}, {0.0F, 0.0F, -1.0F});
    if (std::abs(hit - DISTANCE) < 1e-5F) {
        return {};
    }
    return "Embree meets a triangle that is " + std::to_string(DISTANCE) + " m away at " + std::to_string(hit) + " m";
}

} // namespace

std::string library_problem() {
    std::string problem = version_problem("oneTBB", TBB_INTERFACE_VERSION, TBB_runtime_interface_version(), 1000);
    if (problem.empty()) {
        const EmbreeDevice device(rtcNewDevice(nullptr));
        if (!device) {
            return "Embree does not start";
        }
        const auto running = static_cast<long>(rtcGetDeviceProperty(device.get(), RTC_DEVICE_PROPERTY_VERSION));
        problem = version_problem("Embree", RTC_VERSION, running, 10000);
        if (problem.empty() && rtcGetDeviceProperty(device.get(), RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED) == 0) {
            return "this Embree was built without filters, by which all hits of a ray are found";
        }
    }
    if (!problem.empty()) {
        return problem;
    }
    try {
        return ray_problem();
    } catch (const std::runtime_error &error) {
        return error.what();
    }
}

bool end_threads() {
    oneapi::tbb::task_scheduler_handle threads{oneapi::tbb::attach{}};
    return oneapi::tbb::finalize(threads, std::nothrow);
}

} // namespace sfumato
