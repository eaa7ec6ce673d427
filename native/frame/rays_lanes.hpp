// SPDX-License-Identifier: GPL-3.0-or-later
// The camera's rays, for the stages that follow them.
#pragma once

#include "frame/layers.hpp"
#include "text/camera_text.hpp"
#include "text/lanes.hpp"

namespace sfumato::SFUMATO_ISA {
namespace {

using CameraText = text::CameraText<Real, Isa>;
using Ray = CameraText::Ray;

inline Ray ray_through(const FrameView &frame, Real u, Real v) {
    const auto &c = frame.camera;
    return CameraText().camera_ray(broadcast(c[0]), broadcast(c[1]), broadcast(c[2]), broadcast(c[3]), broadcast(c[4]),
                                   broadcast(c[5]), u, v);
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
